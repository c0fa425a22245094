/* What any program of this computer may send to the camera's port. The first byte says which parser
 * gets the rest: 'h' the head of a request, 'f' WebSocket frames one after the other, anything else
 * a message of the page. */
#include "camera_wire.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void check(bool is_true)
{
    if (!is_true)
        abort();
}

static void take_request(const unsigned char *bytes, size_t size)
{
    static const char token[] = "0123456789abcdef0123456789abcdef";
    web_request request;
    const char *name;
    char accept[WEB_ACCEPT];
    int used = web_request_parse(&request, bytes, size, CAMERA_PROTOCOL);
    check(used <= (int)size && (used > 0 || used > -600));
    if (used <= 0)
        return;
    int status = camera_request_judge(&request, 9130, token, &name);
    check(status == 101 || status == 200 || status == 403 || status == 404);
    check(status >= 400 || strcmp(request.host, "127.0.0.1:9130") == 0);
    check(status != 101 || strcmp(request.origin, "http://127.0.0.1:9130") == 0);
    check(name >= request.path || name[0] == '\0');
    web_accept_key(request.key, accept);
    check(strlen(accept) == WEB_ACCEPT - 1);
}

static void take_message(const unsigned char *bytes, size_t size)
{
    camera_message message;
    unsigned char answer[CAMERA_ANSWER_SIZE];
    if (!camera_message_parse(&message, bytes, size))
        return;
    check(message.hand_count <= CAMERA_HANDS_MAX);
    for (uint32_t i = 0; i < message.hand_count; ++i)
        for (int j = 0; j < MRT_JOINTS; ++j) {
            const mrt_vec3 *at = &message.hand[i].seen.at[j];
            check(isfinite(at->x) && isfinite(at->y) && isfinite(at->z));
        }
    camera_answer_write(answer, message.time_ms, message.time_ns);
}

static void take_frames(unsigned char *bytes, size_t size)
{
    web_frame frame;
    int used;
    while ((used = web_frame_parse(&frame, bytes, size)) > 0) {
        check((size_t)used <= size && frame.size <= WEB_MESSAGE_MAX);
        check(frame.payload + frame.size <= bytes + used);
        take_message(frame.payload, frame.size);
        bytes += used;
        size -= (size_t)used;
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size == 0)
        return 0;
    unsigned char *copy = malloc(size); /* its end is watched */
    if (!copy)
        return 0;
    memcpy(copy, data + 1, size - 1);
    if (data[0] == 'h')
        take_request(copy, size - 1);
    else if (data[0] == 'f')
        take_frames(copy, size - 1);
    else
        take_message(copy, size - 1);
    free(copy);
    return 0;
}
