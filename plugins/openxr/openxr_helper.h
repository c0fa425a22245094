/* plugins/openxr/openxr_helper.h - supervisor of the process that loads OpenXR: starts it, reads
 * its frames, ends it when it is silent, and restarts it with increasing delays. One process for
 * all instances of this program, because most runtimes support only one application at a time. A
 * separate thread watches it. Leaves out the meaning of the points. [main] [input] */
#ifndef MAROTTE_OPENXR_HELPER_H
#define MAROTTE_OPENXR_HELPER_H
#include "openxr_record.h"

#include <stdbool.h>
#include <stddef.h>

enum { OPENXR_REASON = 384 };

typedef struct openxr_frame {
    int64_t time_ns; /* device_clock_ns; increases from frame to frame */
    uint32_t lost;   /* frames before this one that were not read in time */
    openxr_hand hand[2];
} openxr_frame;

typedef struct openxr_listener { /* what an instance has received */
    uint64_t frame_count, text_count;
} openxr_listener;

/* Finds the program. Returns false if it is missing, with the advice in out_reason. */
bool openxr_helper_find(char *out, size_t capacity, char out_reason[OPENXR_REASON]);
bool openxr_helper_join(openxr_listener *out, char out_reason[OPENXR_REASON]);
void openxr_helper_leave(void); /* the last user ends the process */

enum { OPENXR_HEARD_NOTHING, OPENXR_HEARD_FRAME, OPENXR_HEARD_NEWS, OPENXR_HEARD_TROUBLE };
/* Waits until until_ns (device_clock_ns). For NEWS and TROUBLE out_text is a line for the user. */
int openxr_helper_wait(openxr_listener *self, openxr_frame *out, char out_text[OPENXR_REASON],
                       int64_t until_ns);

#endif
