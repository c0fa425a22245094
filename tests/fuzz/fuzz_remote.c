/* What anybody may send to the remote control's port. The first byte says which parser gets the
 * rest: 'j' the JSON of a WebSocket message, 'h' the head of a request, anything else a datagram.
 */
#include "window/app/remote_wire.h"

#include <stdlib.h>
#include <string.h>

static const char code[] = "k7m2p9qx";

static void check(bool is_true)
{
    if (!is_true)
        abort();
}

static void check_command(bool is_good, const remote_command *c, const char *why)
{
    check(is_good || (why[0] && !strchr(why, '\n')));
    check(!is_good || (c->amount >= 0.0 && c->amount <= 1.0 && c->fade_s >= 0.0 &&
                       c->fade_s <= REMOTE_FADE_MOST_S));
    check(!is_good || c->verb != REMOTE_ACTION || action_of(c->of)->group != ACTION_PROGRAM);
}

static void take_message(void *context, const osc_message *message)
{
    remote_command command;
    char why[REMOTE_WHY] = "";
    (void)context;
    check_command(remote_command_of_osc(&command, message, "", why), &command, why);
    const bool is_paired = remote_command_of_osc(&command, message, code, why);
    check_command(is_paired, &command, why);
    check(!is_paired || strstr(message->address, code));
}

static void take_request(const void *bytes, size_t size)
{
    web_request request;
    if (web_request_parse(&request, bytes, size, NULL) <= 0)
        return;
    const int paired = remote_request_judge(&request, 9110, code);
    check((paired != 101 && paired != 200) || strstr(request.path, code));
    const int status = remote_request_judge(&request, 9110, "");
    check(status == 101 || status == 200 || status == 403 || status == 404);
    check(status >= 400 || strcmp(request.host, "127.0.0.1:9110") == 0 ||
          strcmp(request.host, "localhost:9110") == 0 || strcmp(request.host, "[::1]:9110") == 0);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    remote_command command;
    char why[REMOTE_WHY] = "";
    if (size == 0)
        return 0;
    unsigned char *copy = malloc(size); /* its end is watched */
    if (!copy)
        return 0;
    memcpy(copy, data + 1, size - 1);
    if (data[0] == 'j')
        check_command(remote_command_of_json(&command, (const char *)copy, size - 1, why), &command,
                      why);
    else if (data[0] == 'h')
        take_request(copy, size - 1);
    else
        (void)osc_wire_read(copy, size - 1, take_message, NULL);
    free(copy);
    return 0;
}
