#include "window/portal.h"

#ifdef MAROTTE_HAS_SDBUS
#include "base/clock.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <systemd/sd-bus.h>
#include <unistd.h>

#define DESKTOP     "org.freedesktop.portal.Desktop"
#define DESKTOP_AT  "/org/freedesktop/portal/desktop"
#define REQUEST     "org.freedesktop.portal.Request"
#define REQUESTS_AT "/org/freedesktop/portal/desktop/request"

/* largest number of messages in one frame; the rest is read in the next */
enum { MESSAGES_MAX = 64 };

struct portal {
    sd_bus *bus;
    char token[48];    /* the request's path ends with it */
    char request[512]; /* its path, once the desktop has said it; "" */
    int64_t patience_end_ns;
    portal_answer answer;
    char path[PORTAL_PATH];
};

/* ---- what is asked ---- */

/* ".wav" -> "*.[wW][aA][vV]": patterns of a portal tell cases apart. */
static int append_pattern(sd_bus_message *to, const char *ending)
{
    char pattern[128] = "*";
    size_t length = 1;
    for (; *ending && length + 5 < sizeof pattern; ++ending) {
        const int lower = tolower((unsigned char)*ending), upper = toupper((unsigned char)*ending);
        length += (size_t)(lower == upper
                               ? snprintf(pattern + length, sizeof pattern - length, "%c", lower)
                               : snprintf(pattern + length, sizeof pattern - length, "[%c%c]",
                                          lower, upper));
    }
    return sd_bus_message_append(to, "(us)", 0u, pattern);
}

/* sd-bus keeps the first error of a message, and gives it back when it is sent. */
static void append_filter(sd_bus_message *to, const portal_filter *filter)
{
    (void)sd_bus_message_open_container(to, 'r', "sa(us)");
    (void)sd_bus_message_append(to, "s", filter->name);
    (void)sd_bus_message_open_container(to, 'a', "(us)");
    for (const char *const *ending = filter->endings; *ending; ++ending)
        (void)append_pattern(to, *ending);
    (void)sd_bus_message_close_container(to);
    (void)sd_bus_message_close_container(to);
}

static void append_filters(sd_bus_message *to, const portal_question *question)
{
    (void)sd_bus_message_open_container(to, 'e', "sv");
    (void)sd_bus_message_append(to, "s", "filters");
    (void)sd_bus_message_open_container(to, 'v', "a(sa(us))");
    (void)sd_bus_message_open_container(to, 'a', "(sa(us))");
    for (uint32_t i = 0; i < question->filter_count; ++i)
        append_filter(to, &question->filter[i]);
    (void)sd_bus_message_close_container(to);
    (void)sd_bus_message_close_container(to);
    (void)sd_bus_message_close_container(to);
}

/* A path is bytes, with the 0 at its end: names of files need not be UTF-8. */
static void append_folder(sd_bus_message *to, const char *folder)
{
    (void)sd_bus_message_open_container(to, 'e', "sv");
    (void)sd_bus_message_append(to, "s", "current_folder");
    (void)sd_bus_message_open_container(to, 'v', "ay");
    (void)sd_bus_message_append_array(to, 'y', folder, strlen(folder) + 1);
    (void)sd_bus_message_close_container(to);
    (void)sd_bus_message_close_container(to);
}

static void append_options(sd_bus_message *to, const portal *self, const portal_question *question)
{
    (void)sd_bus_message_open_container(to, 'a', "{sv}");
    (void)sd_bus_message_append(to, "{sv}", "handle_token", "s", self->token);
    (void)sd_bus_message_append(to, "{sv}", "modal", "b", 1);
    if (question->is_saving && question->name[0])
        (void)sd_bus_message_append(to, "{sv}", "current_name", "s", question->name);
    if (question->folder[0])
        append_folder(to, question->folder);
    if (question->filter_count)
        append_filters(to, question);
    (void)sd_bus_message_close_container(to);
}

/* ---- what is answered ---- */

static void now(portal *self, portal_answer answer)
{
    if (self->answer <= PORTAL_ASKS)
        self->answer = answer;
}

/* Converts "file:///home/me/a%20b" to /home/me/a b. False: not a file of this computer. */
static bool path_of_uri(char out[PORTAL_PATH], const char *uri)
{
    size_t length = 0;
    if (strncmp(uri, "file://", 7) != 0)
        return false;
    uri += strncmp(uri + 7, "localhost/", 10) == 0 ? 16 : 7;
    if (*uri != '/')
        return false;
    while (*uri && length + 1 < PORTAL_PATH) {
        char byte = *uri++;
        if (byte == '%') {
            const char digits[3] = {uri[0], uri[0] ? uri[1] : '\0', '\0'};
            if (!isxdigit((unsigned char)digits[0]) || !isxdigit((unsigned char)digits[1]))
                return false;
            byte = (char)strtoul(digits, NULL, 16);
            uri += 2;
        }
        if (!byte)
            return false;
        out[length++] = byte;
    }
    out[length] = '\0';
    return *uri == '\0';
}

static bool read_uris(portal *self, sd_bus_message *from)
{
    const char *uri = NULL;
    bool found = false;
    if (sd_bus_message_enter_container(from, 'v', "as") < 0 ||
        sd_bus_message_enter_container(from, 'a', "s") < 0)
        return false;
    while (sd_bus_message_read(from, "s", &uri) > 0)
        found = found || path_of_uri(self->path, uri);
    return found;
}

static portal_answer read_response(portal *self, sd_bus_message *from)
{
    uint32_t how = 0;
    const char *key = NULL;
    if (sd_bus_message_read(from, "u", &how) < 0)
        return PORTAL_ABSENT;
    if (how != 0)
        return how == 1 ? PORTAL_CANCELLED : PORTAL_ABSENT;
    if (sd_bus_message_enter_container(from, 'a', "{sv}") < 0)
        return PORTAL_ABSENT;
    while (sd_bus_message_enter_container(from, 'e', "sv") > 0) {
        if (sd_bus_message_read(from, "s", &key) <= 0)
            return PORTAL_ABSENT;
        if (strcmp(key, "uris") == 0)
            return read_uris(self, from) ? PORTAL_CHOSEN : PORTAL_ABSENT;
        if (sd_bus_message_skip(from, "v") < 0 || sd_bus_message_exit_container(from) < 0)
            return PORTAL_ABSENT;
    }
    return PORTAL_ABSENT;
}

static int on_response(sd_bus_message *from, void *data, sd_bus_error *err)
{
    portal *self = data;
    const char *path = sd_bus_message_get_path(from), *name = path ? strrchr(path, '/') : NULL;
    (void)err;
    if (name && strcmp(name + 1, self->token) == 0)
        now(self, read_response(self, from));
    return 0;
}

static int on_reply(sd_bus_message *from, void *data, sd_bus_error *err)
{
    portal *self = data;
    const char *request = NULL;
    (void)err;
    if (sd_bus_message_is_method_error(from, NULL) || sd_bus_message_read(from, "o", &request) < 0)
        now(self, PORTAL_ABSENT);
    else {
        (void)snprintf(self->request, sizeof self->request, "%s", request);
        now(self, PORTAL_ASKS);
    }
    return 0;
}

/* The process that showed the dialog has ended. */
static int on_owner(sd_bus_message *from, void *data, sd_bus_error *err)
{
    portal *self = data;
    const char *name = NULL, *before = NULL, *after = NULL;
    (void)err;
    if (sd_bus_message_read(from, "sss", &name, &before, &after) > 0 && before[0] && !after[0])
        now(self, PORTAL_ABSENT);
    return 0;
}

/* ---- life ---- */

/* Its answer is listened for before it is asked. */
static int send(portal *self, const portal_question *question)
{
    sd_bus_message *call = NULL;
    int result = sd_bus_add_match_async(self->bus, NULL,
                                        "type='signal',interface='" REQUEST
                                        "',member='Response',path_namespace='" REQUESTS_AT "'",
                                        on_response, NULL, self);
    if (result >= 0)
        result = sd_bus_add_match_async(self->bus, NULL,
                                        "type='signal',sender='org.freedesktop.DBus',"
                                        "member='NameOwnerChanged',arg0='" DESKTOP "'",
                                        on_owner, NULL, self);
    if (result >= 0)
        result = sd_bus_message_new_method_call(self->bus, &call, DESKTOP, DESKTOP_AT,
                                                "org.freedesktop.portal.FileChooser",
                                                question->is_saving ? "SaveFile" : "OpenFile");
    if (result >= 0) {
        (void)sd_bus_message_append(call, "ss", "", question->title);
        append_options(call, self, question);
        result = sd_bus_call_async(self->bus, NULL, call, on_reply, self, 0);
    }
    sd_bus_message_unref(call);
    return result;
}

portal *portal_ask(const portal_question *question)
{
    portal *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    const int64_t now_ns = clock_now_ns();
    self->patience_end_ns = now_ns + (int64_t)(question->patience_s * 1e9);
    (void)snprintf(self->token, sizeof self->token, "marotte%ld_%lld", (long)getpid(),
                   (long long)now_ns);
    if (sd_bus_open_user(&self->bus) >= 0 && send(self, question) >= 0)
        return self;
    portal_close(self);
    return NULL;
}

portal_answer portal_look(portal *self, char out_path[PORTAL_PATH])
{
    int result = 1;
    for (int i = 0; i < MESSAGES_MAX && result > 0; ++i)
        result = sd_bus_process(self->bus, NULL);
    if (result < 0 || (self->answer == PORTAL_WAITS && clock_now_ns() > self->patience_end_ns))
        now(self, PORTAL_ABSENT);
    (void)snprintf(out_path, PORTAL_PATH, "%s", self->path);
    return self->answer;
}

void portal_close(portal *self)
{
    if (!self)
        return;
    if (self->answer == PORTAL_ASKS &&
        self->request[0]) /* sent immediately; if the bus has no space for it, the request ends with
                             the client */
        (void)sd_bus_call_method_async(self->bus, NULL, DESKTOP, self->request, REQUEST, "Close",
                                       NULL, NULL, "");
    sd_bus_close(self->bus);
    sd_bus_unref(self->bus);
    free(self);
}

#else

#include <stddef.h>

portal *portal_ask(const portal_question *question)
{
    (void)question;
    return NULL;
}

portal_answer portal_look(portal *self, char out_path[PORTAL_PATH])
{
    (void)self;
    out_path[0] = '\0';
    return PORTAL_ABSENT;
}

void portal_close(portal *self)
{
    (void)self;
}

#endif
