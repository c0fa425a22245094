#include "window/app/remote_wire.h"

#include "base/text.h"

#include <arpa/inet.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static const double usual_fade_s = 0.3;

/* ---- commands ---- */

static const struct {
    const char *word;
    remote_verb verb;
} verbs[] = {{"record", REMOTE_RECORD}, {"stop", REMOTE_STOP},
             {"mark", REMOTE_MARK},     {"expression", REMOTE_EXPRESSION},
             {"preset", REMOTE_PRESET}, {"status", REMOTE_STATUS}};

static bool is_fit(action of)
{
    const action_group group = of == ACTION_NONE ? ACTION_GROUPS : action_of(of)->group;
    return group == ACTION_PERFORMANCE || group == ACTION_TRANSPORT || group == ACTION_VIEW;
}

static bool take_verb(remote_command *out, const char *word, char why[REMOTE_WHY])
{
    *out = (remote_command){.amount = 1.0, .fade_s = usual_fade_s};
    for (size_t i = 0; i < sizeof verbs / sizeof verbs[0]; ++i)
        if (strcmp(verbs[i].word, word) == 0)
            out->verb = verbs[i].verb;
    if (out->verb == REMOTE_NOTHING) {
        out->of = action_named(word);
        out->verb = REMOTE_ACTION;
    }
    if (strlen(word) < sizeof out->word && (out->verb != REMOTE_ACTION || is_fit(out->of))) {
        (void)snprintf(out->word, sizeof out->word, "%s", word);
        return true;
    }
    char shown[48];
    text_copy(shown, sizeof shown, text_view_of(word, strlen(word)));
    (void)snprintf(why, REMOTE_WHY,
                   "\"%s\" is not a remote command: use record, stop, mark, keep, neutral, preset, "
                   "expression, status ...",
                   shown);
    return false;
}

static bool take_name(remote_command *out, const char *name, char why[REMOTE_WHY])
{
    if (out->verb != REMOTE_EXPRESSION && out->verb != REMOTE_PRESET) {
        (void)snprintf(why, REMOTE_WHY, "%s takes no name", out->word);
        return false;
    }
    if (strlen(name) >= sizeof out->name ||
        (name[0] && !text_is_printable(text_view_of(name, strlen(name))))) {
        (void)snprintf(why, REMOTE_WHY, "%s: not a name", out->word);
        return false;
    }
    (void)snprintf(out->name, sizeof out->name, "%s", name);
    return true;
}

static bool take_number(double *out, double value, double most, const char *what,
                        char why[REMOTE_WHY])
{
    if (!(value >= 0.0 && value <= most)) {
        (void)snprintf(why, REMOTE_WHY, "%s: expected a number from 0 to %g", what, most);
        return false;
    }
    *out = value;
    return true;
}

/* ---- the code ---- */

bool remote_is_code(const char *text)
{
    return strlen(text) == REMOTE_CODE && strspn(text, REMOTE_CODE_LETTERS) == REMOTE_CODE;
}

/* Whether the text begins with the code and a '/'. */
static bool has_code(const char *text, const char *code)
{
    unsigned char differs = 0;
    if (strlen(text) <= REMOTE_CODE)
        return false;
    for (int i = 0; i < REMOTE_CODE; ++i)
        differs |= (unsigned char)text[i] ^ (unsigned char)code[i];
    return !differs && text[REMOTE_CODE] == '/';
}

/* ---- OSC ---- */

static const char *behind_prefix(const char *address)
{
    const size_t prefix = sizeof REMOTE_OSC_PREFIX - 1;
    return strncmp(address, REMOTE_OSC_PREFIX, prefix) == 0 ? address + prefix : NULL;
}

bool remote_osc_has_code(const char *address, const char *code)
{
    const char *rest = behind_prefix(address);
    return !code[0] || (rest && has_code(rest, code));
}

static bool take_arguments(remote_command *out, const osc_message *message, uint32_t from,
                           char why[REMOTE_WHY])
{
    double number[2];
    const uint32_t count = message->count - from;
    const uint32_t most = out->verb == REMOTE_EXPRESSION ? 2 : 1;
    for (uint32_t i = 0; i < count; ++i)
        if (count > most || !osc_message_number(message, from + i, &number[i]) ||
            !isfinite(number[i])) {
            (void)snprintf(why, REMOTE_WHY, "%s: expected %s", out->word,
                           most == 2 ? "a name, an amount and a fade in s"
                                     : "at most one number: 0 is a released button");
            return false;
        }
    if (out->verb == REMOTE_EXPRESSION)
        return (count < 1 || take_number(&out->amount, number[0], 1.0, "amount", why)) &&
               (count < 2 || take_number(&out->fade_s, number[1], REMOTE_FADE_MOST_S, "fade", why));
    if (count > 0 && fabs(number[0]) < 1e-6)
        out->verb = REMOTE_NOTHING;
    return true;
}

bool remote_command_of_osc(remote_command *out, const osc_message *message, const char *code,
                           char why[REMOTE_WHY])
{
    char word[64];
    *out = (remote_command){.verb = REMOTE_NOTHING};
    const char *verb = behind_prefix(message->address);
    if (!verb || !remote_osc_has_code(message->address, code)) {
        (void)snprintf(why, REMOTE_WHY, "an address begins with " REMOTE_OSC_PREFIX "%s",
                       code[0] ? "CODE/" : "");
        return false;
    }
    verb += code[0] ? REMOTE_CODE + 1 : 0;
    const size_t length = strcspn(verb, "/");
    (void)snprintf(word, sizeof word, "%.*s", (int)(length < 60 ? length : 60), verb);
    if (!take_verb(out, word, why))
        return false;
    uint32_t from = 0;
    const char *name = verb[length] ? verb + length + 1 : NULL;
    if (!name && message->count > 0 && (name = osc_message_text(message, 0)))
        from = 1;
    return (!name || take_name(out, name, why)) && take_arguments(out, message, from, why);
}

/* ---- JSON ---- */

static bool take_member(remote_command *out, const char *key, const json_t *value,
                        char why[REMOTE_WHY])
{
    if (strcmp(key, "do") == 0)
        return true;
    if (strcmp(key, "name") == 0 && json_is_string(value) &&
        strlen(json_string_value(value)) == json_string_length(value))
        return take_name(out, json_string_value(value), why);
    if (strcmp(key, "amount") == 0 && json_is_number(value))
        return take_number(&out->amount, json_number_value(value), 1.0, key, why);
    if (strcmp(key, "fade_s") == 0 && json_is_number(value))
        return take_number(&out->fade_s, json_number_value(value), REMOTE_FADE_MOST_S, key, why);
    if (strcmp(key, "id") == 0 && json_is_integer(value)) {
        out->id = json_integer_value(value);
        out->has_id = true;
        return true;
    }
    char shown[48];
    text_copy(shown, sizeof shown, text_view_of(key, strlen(key)));
    (void)snprintf(why, REMOTE_WHY,
                   "\"%s\" is not understood: expected do, name, amount, fade_s, id", shown);
    return false;
}

bool remote_command_of_json(remote_command *out, const char *text, size_t size,
                            char why[REMOTE_WHY])
{
    json_error_t where;
    const char *key;
    json_t *value, *root = json_loadb(text, size, JSON_REJECT_DUPLICATES, &where);
    const json_t *verb = json_object_get(root, "do");
    *out = (remote_command){.verb = REMOTE_NOTHING};
    bool is_good = json_is_string(verb);
    if (!is_good)
        (void)snprintf(why, REMOTE_WHY,
                       "expected JSON such as {\"do\": \"record\"} or {\"do\": \"expression\", "
                       "\"name\": \"smile\"}");
    is_good = is_good && take_verb(out, json_string_value(verb), why);
    json_object_foreach(root, key, value) is_good = is_good && take_member(out, key, value, why);
    json_decref(root);
    return is_good;
}

/* ---- allowed requests ---- */

static bool is_in_numbers(const char *host, size_t size)
{
    unsigned char bytes[16];
    char copy[64];
    const bool is_six = size > 2 && host[0] == '[' && host[size - 1] == ']';
    const size_t inside = is_six ? size - 2 : size;
    if (inside == 0 || inside >= sizeof copy)
        return false;
    memcpy(copy, host + is_six, inside);
    copy[inside] = '\0';
    return inet_pton(is_six ? AF_INET6 : AF_INET, copy, bytes) == 1;
}

int remote_request_judge(const web_request *request, uint16_t port, const char *code)
{
    static const char *const own[] = {"127.0.0.1", "localhost", "[::1]"};
    char wanted[16], origin[sizeof request->host + 8];
    const size_t length = strlen(request->host);
    const size_t tail =
        (size_t)snprintf(wanted, sizeof wanted, ":%u", (unsigned)port); /* a short one */
    if (!request->has_host || length <= tail || strcmp(request->host + length - tail, wanted) != 0)
        return 403;
    bool is_ours = code[0] && is_in_numbers(request->host, length - tail);
    for (size_t i = 0; i < sizeof own / sizeof own[0]; ++i)
        is_ours |=
            strlen(own[i]) == length - tail && memcmp(own[i], request->host, length - tail) == 0;
    (void)snprintf(origin, sizeof origin, "http://%s", request->host);
    if (!is_ours || (request->has_origin && strcmp(request->origin, origin) != 0))
        return 403;
    const char *path = request->path;
    if (code[0] && (path[0] != '/' || !has_code(path + 1, code)))
        return 403;
    path += code[0] ? 1 + REMOTE_CODE : 0;
    if (strcmp(path, "/") != 0)
        return 404;
    return request->is_socket ? 101 : 200;
}
