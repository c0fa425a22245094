#include "web.h"

#include <ctype.h>
#include <nettle/base64.h>
#include <nettle/sha1.h>
#include <stdint.h>
#include <string.h>
#include <strings.h>

/* ---- HTTP ---- */

typedef struct span {
    const char *at;
    size_t size;
} span;

static bool span_is(span s, const char *word)
{
    return s.size == strlen(word) && strncasecmp(s.at, word, s.size) == 0;
}

static span span_trimmed(span s)
{
    while (s.size > 0 && (*s.at == ' ' || *s.at == '\t')) {
        ++s.at;
        --s.size;
    }
    while (s.size > 0 && (s.at[s.size - 1] == ' ' || s.at[s.size - 1] == '\t'))
        --s.size;
    return s;
}

/* Returns true if the word is in the comma-separated list. */
static bool span_lists(span s, const char *word, bool is_exact)
{
    while (s.size > 0) {
        const char *comma = memchr(s.at, ',', s.size);
        size_t size = comma ? (size_t)(comma - s.at) : s.size;
        span one = span_trimmed((span){s.at, size});
        if (is_exact ? one.size == strlen(word) && memcmp(one.at, word, one.size) == 0
                     : span_is(one, word))
            return true;
        size += comma != NULL;
        s = (span){s.at + size, s.size - size};
    }
    return false;
}

static bool span_copy(span s, char *out, size_t capacity)
{
    if (s.size >= capacity)
        return false;
    memcpy(out, s.at, s.size);
    out[s.size] = '\0';
    return true;
}

/* Returns true if the text is 16 bytes in base64, the key of a client. */
static bool is_key(span s)
{
    struct base64_decode_ctx context;
    uint8_t bytes[BASE64_DECODE_LENGTH(24)];
    size_t size = sizeof bytes;
    base64_decode_init(&context);
    return s.size == 24 && base64_decode_update(&context, &size, bytes, s.size, s.at) &&
           base64_decode_final(&context) && size == 16;
}

typedef struct upgrade {
    const char *wanted; /* protocol; NULL: any */
    bool connection, websocket, version, protocol;
} upgrade;

/* Returns 0, or minus the status. */
static int take_field(web_request *out, upgrade *up, span name, span value)
{
    if (span_is(name, "Host")) {
        if (out->has_host || !span_copy(value, out->host, sizeof out->host))
            return -400;
        out->has_host = true;
    } else if (span_is(name, "Origin")) {
        if (out->has_origin || !span_copy(value, out->origin, sizeof out->origin))
            return -400;
        out->has_origin = true;
    } else if (span_is(name, "Connection")) {
        up->connection |= span_lists(value, "upgrade", false);
    } else if (span_is(name, "Upgrade")) {
        up->websocket |= span_is(value, "websocket");
    } else if (span_is(name, "Sec-WebSocket-Version")) {
        up->version |= span_is(value, "13");
    } else if (span_is(name, "Sec-WebSocket-Protocol")) {
        up->protocol |= up->wanted && span_lists(value, up->wanted, true);
    } else if (span_is(name, "Sec-WebSocket-Key")) {
        if (out->key[0] || !is_key(value) || !span_copy(value, out->key, sizeof out->key))
            return -400;
    } else if (span_is(name, "Transfer-Encoding") ||
               (span_is(name, "Content-Length") && !span_is(value, "0"))) {
        return -400; /* reject a request with a body */
    }
    return 0;
}

static int take_request_line(web_request *out, span line)
{
    const char *first = memchr(line.at, ' ', line.size);
    if (!first)
        return -400;
    span method = {line.at, (size_t)(first - line.at)};
    span rest = {first + 1, line.size - method.size - 1};
    const char *second = memchr(rest.at, ' ', rest.size);
    if (!second)
        return -400;
    span path = {rest.at, (size_t)(second - rest.at)};
    span version = {second + 1, rest.size - path.size - 1};
    if (!span_is(version, "HTTP/1.1"))
        return -400;
    if (!span_is(method, "GET"))
        return -405;
    if (path.size == 0 || path.at[0] != '/')
        return -400;
    return span_copy(path, out->path, sizeof out->path) ? 0 : -404;
}

static int take_line(web_request *out, upgrade *up, span line)
{
    const char *colon = memchr(line.at, ':', line.size);
    if (!colon || colon == line.at)
        return -400;
    span name = {line.at, (size_t)(colon - line.at)};
    for (size_t i = 0; i < name.size; ++i)
        if (!isalnum((unsigned char)name.at[i]) && !strchr("!#$%&'*+-.^_`|~", name.at[i]))
            return -400;
    span value = {colon + 1, line.size - name.size - 1};
    return take_field(out, up, name, span_trimmed(value));
}

int web_request_parse(web_request *out, const void *bytes, size_t size, const char *protocol)
{
    const char *at = bytes, *end = at + size;
    upgrade up = {.wanted = protocol, .protocol = protocol == NULL};
    *out = (web_request){.is_socket = false};
    for (bool is_first = true;; is_first = false) {
        const char *stop = memchr(at, '\n', (size_t)(end - at));
        for (const char *c = at; c < (stop ? stop : end); ++c)
            if (((unsigned char)*c < ' ' && *c != '\t' && *c != '\r') || *c == 0x7f)
                return -400;
        if (!stop)
            return size >= WEB_HEAD_MAX ? -431 : 0;
        if (stop == at || stop[-1] != '\r' || memchr(at, '\r', (size_t)(stop - at - 1)))
            return -400;
        span line = {at, (size_t)(stop - at - 1)};
        at = stop + 1;
        if (line.size == 0) {
            if (is_first)
                return -400;
            break;
        }
        int result = is_first ? take_request_line(out, line) : take_line(out, &up, line);
        if (result < 0)
            return result;
    }
    out->is_socket = up.connection && up.websocket && up.version && up.protocol && out->key[0];
    return (int)(at - (const char *)bytes);
}

void web_accept_key(const char *key, char out[WEB_ACCEPT])
{
    static const char salt[] = "258EAFA5-E914-47DA-95CA-C5AB0DC85B11";
    struct sha1_ctx context;
    uint8_t digest[SHA1_DIGEST_SIZE];
    sha1_init(&context);
    sha1_update(&context, strlen(key), (const uint8_t *)key);
    sha1_update(&context, sizeof salt - 1, (const uint8_t *)salt);
    sha1_digest(&context, sizeof digest, digest);
    base64_encode_raw(out, sizeof digest, digest);
    out[WEB_ACCEPT - 1] = '\0';
}

/* ---- WebSocket ---- */

int web_frame_parse(web_frame *out, void *bytes, size_t size)
{
    unsigned char *at = bytes;
    *out = (web_frame){.opcode = 0};
    if (size < 2)
        return 0;
    const int opcode = at[0] & 15;
    const bool is_known =
        (opcode >= WEB_TEXT && opcode <= WEB_BINARY) || (opcode >= WEB_CLOSE && opcode <= WEB_PONG);
    if ((at[0] & 0xf0) != 0x80 || !is_known || !(at[1] & 0x80))
        return -1002;
    size_t length = at[1] & 0x7fu, head = 2;
    if (length > 125 && opcode >= WEB_CLOSE)
        return -1002;
    if (length == 127)
        return -1009;
    if (length == 126) {
        if (size < 4)
            return 0;
        length = (size_t)at[2] << 8 | at[3];
        head = 4;
        if (length < 126)
            return -1002;
    }
    if (length > WEB_MESSAGE_MAX)
        return -1009;
    if (size < head + 4 + length)
        return 0;
    const unsigned char *mask = at + head;
    unsigned char *payload = at + head + 4;
    for (size_t i = 0; i < length; ++i)
        payload[i] ^= mask[i % 4];
    *out = (web_frame){opcode, payload, length};
    return (int)(head + 4 + length);
}

size_t web_frame_write(unsigned char *out, int opcode, const void *payload, size_t size)
{
    size_t head = 2;
    out[0] = (unsigned char)(0x80 | opcode);
    out[1] = (unsigned char)(size < 126 ? size : 126);
    if (size >= 126) {
        out[2] = (unsigned char)(size >> 8);
        out[3] = (unsigned char)size;
        head = 4;
    }
    memcpy(out + head, payload, size);
    return head + size;
}
