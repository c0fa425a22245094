/* plugins/openxr/openxr_helper.h - the process that OpenXR is loaded into, kept alive: started,
 * read, ended when it is silent, started again ever more rarely. One for all instances of this
 * program (most runtimes know one application at a time), watched by a thread of its own.
 * Leaves out what the points mean. [main] [input] */
#ifndef MAROTTE_OPENXR_HELPER_H
#define MAROTTE_OPENXR_HELPER_H
#include "openxr_record.h"

#include <stdbool.h>
#include <stddef.h>

enum { OPENXR_REASON = 384 };

typedef struct openxr_frame {
    int64_t time_ns; /* device_clock_ns; later than that of every frame before */
    uint32_t lost;   /* frames before this one that were not waited for in time */
    openxr_hand hand[2];
} openxr_frame;

typedef struct openxr_listener { /* what an instance has heard */
    uint64_t frame_count, text_count;
} openxr_listener;

/* Where the program is; false: nowhere, and out_reason says what to do. */
bool openxr_helper_find(char *out, size_t capacity, char out_reason[OPENXR_REASON]);
bool openxr_helper_join(openxr_listener *out, char out_reason[OPENXR_REASON]);
void openxr_helper_leave(void); /* the last one ends the process */

enum { OPENXR_HEARD_NOTHING, OPENXR_HEARD_FRAME, OPENXR_HEARD_NEWS, OPENXR_HEARD_TROUBLE };
/* Waits until until_ns (device_clock_ns). NEWS and TROUBLE: a line for the person in out_text. */
int openxr_helper_wait(openxr_listener *self, openxr_frame *out, char out_text[OPENXR_REASON],
                       int64_t until_ns);

#endif
