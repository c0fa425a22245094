/* stage/playback/transport.h - the position on a timeline at a time of the clock: playing at 0.1 to
 * 4 times normal speed, looping, or paused. Pure: the result depends only on the struct and the
 * time. Positions are exact at every speed, and no change except a seek or a step makes the
 * position jump. */
#ifndef MAROTTE_STAGE_TRANSPORT_H
#define MAROTTE_STAGE_TRANSPORT_H
#include "base/timecode.h"

#define TRANSPORT_SPEED_MIN 0.1
#define TRANSPORT_SPEED_MAX 4.0

typedef struct transport {
    bool is_playing, is_looping;
    bool stops_at_end; /* false: playback continues after end_ns, for recording */
    double speed;
    int64_t end_ns;                  /* of the timeline */
    int64_t loop_in_ns, loop_out_ns; /* in < out */
    int64_t clock_ns, at_ns;         /* the position at clock_ns is at_ns */
    uint32_t passes;                 /* loops that were completed before clock_ns */
} transport;

void transport_init(transport *out, int64_t end_ns); /* paused at 0, speed 1 */

typedef struct transport_position {
    int64_t at_ns;
    uint32_t pass;    /* number of completed loops */
    bool has_stopped; /* playback has reached the end */
} transport_position;
/* A clock_ns before the last change counts as the time of that change. */
transport_position transport_at(const transport *self, int64_t clock_ns);

/* At the end, playback starts at 0. After the end of the loop, it starts at loop_in_ns. */
void transport_play(transport *self, int64_t clock_ns);
void transport_pause(transport *self, int64_t clock_ns);
void transport_seek(transport *self, int64_t clock_ns, int64_t at_ns); /* limited to 0..end_ns */
/* Returns false without a change if the speed is outside
 * TRANSPORT_SPEED_MIN..TRANSPORT_SPEED_MAX. */
bool transport_set_speed(transport *self, int64_t clock_ns, double speed);
/* Returns false unless 0 <= in < out. */
bool transport_set_loop(transport *self, int64_t clock_ns, int64_t in_ns, int64_t out_ns);
void transport_end_loop(transport *self, int64_t clock_ns);
/* Pauses at the start of the frame that is `frames` frames later. */
void transport_step_frames(transport *self, int64_t clock_ns, timecode_rate rate, int64_t frames);

#endif
