#include "base/trace.h"

#include "base/clock.h"
#include "base/os.h"
#include "base/text.h"

#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TRACE_LINE = 400 };

static const char *const room_names[TRACE_ROOM_COUNT] = {"input", "mapping", "playback", "record",
                                                         "show",  "output",  "sound",    "io"};
static atomic_uint rooms_on; /* a bit for each room */

bool trace_is_on(trace_room room)
{
    return (atomic_load_explicit(&rooms_on, memory_order_relaxed) >> room & 1u) != 0;
}

/* The bits of the rooms that `name` chooses; 0: an unknown name. */
static unsigned rooms_named(const char *name, size_t length)
{
    if (length == strlen("all") && strncmp(name, "all", length) == 0)
        return (1u << TRACE_ROOM_COUNT) - 1u;
    for (unsigned room = 0; room < TRACE_ROOM_COUNT; ++room)
        if (length == strlen(room_names[room]) && strncmp(name, room_names[room], length) == 0)
            return 1u << room;
    return 0;
}

mrt_result trace_start(error *err)
{
    const char *list = getenv("MAROTTE_LOG");
    char known[120] = "all";
    mrt_result result = MRT_OK;
    for (int room = 0; room < TRACE_ROOM_COUNT; ++room)
        (void)snprintf(known + strlen(known), sizeof known - strlen(known), ", %s",
                       room_names[room]);
    unsigned on = 0;
    while (list && *list) {
        const size_t length = strcspn(list, ",");
        const unsigned named = rooms_named(list, length);
        if (!named && length > 0)
            result = error_set(err, MRT_ERR_ARGUMENT,
                               "MAROTTE_LOG: unknown room \"%.*s\"; choose among %s",
                               (int)(length < 40 ? length : 40), list, known);
        on |= named;
        list += length + (list[length] == ',');
    }
    atomic_store_explicit(&rooms_on, on, memory_order_relaxed);
    return result;
}

void trace_print(trace_room room, const char *format, ...)
{
    char text[TRACE_LINE], line[TRACE_LINE + 64];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    text_make_printable(text);
    (void)snprintf(line, sizeof line, "%.6f %ld %s: %s\n", 1e-9 * (double)clock_now_ns(),
                   os_thread_id(), room_names[room], text);
    (void)fputs(line, stderr); /* unbuffered, so lines of several threads stay whole */
}
