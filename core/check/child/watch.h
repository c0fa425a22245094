/* check/child/watch.h - what happens when a call into the plugin does not come back: a crash, an
 * endless loop, a wait without end, exit(). The parent is told where, and the process ends. */
#ifndef MAROTTE_CHECK_CHILD_WATCH_H
#define MAROTTE_CHECK_CHILD_WATCH_H

/* From now on. The case may take `limit_s` of wall time, a single call 10 s of CPU time, and a call
 * on the frame thread 1 s. */
void watch_begin(unsigned limit_s);
/* The case came to its end. */
void watch_end(void);

/* Around each call on the frame thread. */
void watch_frame_enter(void);
void watch_frame_leave(void);
/* Before any other call. */
void watch_next(void);

#endif
