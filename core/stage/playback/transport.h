/* stage/playback/transport.h - where on a timeline one is at a time of the clock: playing at 0.1 to 4
 * times life, or standing; a range that is played again and again. Pure: a struct and the clock's
 * time; positions are exact at every speed, and changing something never makes them jump. */
#ifndef MAROTTE_STAGE_TRANSPORT_H
#define MAROTTE_STAGE_TRANSPORT_H
#include "base/timecode.h"

#define TRANSPORT_SPEED_MIN 0.1
#define TRANSPORT_SPEED_MAX 4.0

typedef struct transport {
    bool is_playing, is_looping;
    bool stops_at_end; /* false: time goes on beyond it, as while recording */
    double speed;
    int64_t end_ns;                  /* of the timeline */
    int64_t loop_in_ns, loop_out_ns; /* in < out */
    int64_t clock_ns, at_ns;         /* at clock_ns it was at at_ns */
    uint32_t passes;                 /* of the loop, done before clock_ns */
} transport;

void transport_init(transport *out, int64_t end_ns); /* stands at 0, speed 1 */

typedef struct transport_position {
    int64_t at_ns;
    uint32_t pass;    /* of the loop: how often it has gone back to its start */
    bool has_stopped; /* it plays, but the end was reached */
} transport_position;
/* clock_ns: not before the last change; earlier counts as then. */
transport_position transport_at(const transport *self, int64_t clock_ns);

/* At the end: from the start; behind a loop: from the loop's. */
void transport_play(transport *self, int64_t clock_ns);
void transport_pause(transport *self, int64_t clock_ns);
void transport_seek(transport *self, int64_t clock_ns, int64_t at_ns); /* into 0..end */
/* False, and nothing changes: not TRANSPORT_SPEED_MIN..MAX. */
bool transport_set_speed(transport *self, int64_t clock_ns, double speed);
/* False: not 0 <= in < out. */
bool transport_set_loop(transport *self, int64_t clock_ns, int64_t in_ns, int64_t out_ns);
void transport_end_loop(transport *self, int64_t clock_ns);
/* Stands, on the start of the frame that is `frames` further. */
void transport_step_frames(transport *self, int64_t clock_ns, timecode_rate rate, int64_t frames);

#endif
