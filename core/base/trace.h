/* base/trace.h - lines on stderr that show what a room does, for debugging. The environment
 * variable MAROTTE_LOG chooses the rooms: MAROTTE_LOG=input,show, or MAROTTE_LOG=all. Unset, a
 * trace costs one load. Messages for the user go through base/log.h. */
#ifndef MAROTTE_BASE_TRACE_H
#define MAROTTE_BASE_TRACE_H
#include "base/error.h"

#include <stdbool.h>

typedef enum trace_room {
    TRACE_INPUT,    /* devices open, fail, return; gaps of samples */
    TRACE_MAPPING,  /* plugins load; child processes start, are late, end */
    TRACE_PLAYBACK, /* seeks, checkpoints, voices of a take */
    TRACE_RECORD,   /* performances and takes begin and end */
    TRACE_SHOW,     /* commits, files */
    TRACE_OUTPUT,   /* outputs open, send, fail */
    TRACE_SOUND,    /* sound devices */
    TRACE_IO,       /* files that are read and written, child processes that decode them */
    TRACE_ROOM_COUNT
} trace_room;

/* [main] Reads MAROTTE_LOG; before other threads start. MRT_ERR_ARGUMENT: an unknown room; the
 * error lists them, and the known rooms are on. */
CHECKED mrt_result trace_start(error *err);
/* [any] */
bool trace_is_on(trace_room room);
/* [any] Prints "SECONDS THREAD ROOM: TEXT" in one write; cut at 400 bytes, unprintable bytes are
 * replaced. It blocks as long as stderr does: where tracing is on, the frame thread may be late. */
__attribute__((format(printf, 2, 3))) void trace_print(trace_room room, const char *format, ...);

/* The arguments are evaluated only where the room is on. */
#define TRACE(room, ...)                                                                           \
    do {                                                                                           \
        if (trace_is_on(room))                                                                     \
            trace_print(room, __VA_ARGS__);                                                        \
    } while (0)

#endif
