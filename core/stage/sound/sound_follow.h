/* stage/sound/sound_follow.h - the sound of a take onto a device whose clock is not the host's:
 * each block that the device asks for is filled with what belongs to the instant at which it is
 * heard. Frames come through a ring, in a stream of the timeline's frames from where the transport
 * set out; single ones are left out or repeated, cross-faded over 5 ms, once the two are more than
 * a fifth of a millisecond apart; a jump of more than 5 ms is made at once, cross-faded likewise.
 * Never waits, allocates or calls the system. Everything on the device's thread [device] unless
 * marked. */
#ifndef MAROTTE_STAGE_SOUND_FOLLOW_H
#define MAROTTE_STAGE_SOUND_FOLLOW_H
#include "base/error.h"
#include "base/ring.h"
#include "stage/sound/sound_clock.h"

#include <stdatomic.h>
#include <stdbool.h>

enum { SOUND_PACKET_FRAMES = 256, SOUND_PACKETS = 64, SOUND_WINDOW = 16384, SOUND_BOARD_WORDS = 8 };

/* Where the transport is: the host's clock shows host_ns when the timeline shows at_ns. Speed 1 is
 * heard; 0 is a pause; at any other it is silent. Revisions are counted up with each change. */
typedef struct sound_motion {
    uint32_t revision; /* 0: it has never moved */
    uint32_t edition;  /* of the sound: counted up with each change of what is played */
    int64_t host_ns, at_ns;
    double speed;
    int64_t loop_from_ns, loop_to_ns; /* equal: no loop; else it goes from loop_to to loop_from */
    bool is_mute;                     /* only its beats are heard */
    double beat_ns;                   /* beats of the timeline are so far apart; 0: none */
    uint32_t bar, beats;              /* beats of a bar; which are heard: SOUND_BEATS_* */
} sound_motion;
/* Before host_ns, which is a count-in; from host_ns on. */
enum { SOUND_BEATS_BEFORE = 1, SOUND_BEATS_AFTER = 2 };
bool sound_motion_is_heard(const sound_motion *self); /* the sound, not its beats */

/* The newest motion, for any number of readers; nobody waits. */
typedef struct sound_board {
    _Atomic uint32_t sequence; /* odd: being written */
    _Atomic uint32_t edition;  /* [main] */
    _Atomic uint64_t word[SOUND_BOARD_WORDS];
} sound_board;
void sound_board_post(sound_board *self, const sound_motion *motion); /* [one thread] */
/* False: it is being written just now. */
bool sound_board_read(const sound_board *self, sound_motion *out);

/* Frames first.. of the stream of one revision and edition: frame 0 is at the motion's at_ns, loops
 * unrolled. The samples follow it in the ring's record: interleaved, of as many channels as the
 * sound has. */
typedef struct sound_packet {
    uint32_t revision, edition;
    int64_t first;
    uint32_t count, rate_hz;
} sound_packet;

typedef struct sound_count {   /* [any] since it was made */
    _Atomic uint64_t spliced;  /* single frames left out or repeated */
    _Atomic uint32_t jumped;   /* over 5 ms at once */
    _Atomic uint32_t starved;  /* times that frames came too late: a gap was heard */
    _Atomic uint32_t broken;   /* times that the device said that it ran dry */
    _Atomic int32_t drift_ppb; /* of the device's clock: + it runs fast */
    _Atomic uint32_t is_heard; /* the last block had sound in it */
} sound_count;

typedef struct sound_follow {
    _Atomic uint32_t rate_hz; /* [any] the device's, and of the frames that it wants */
    uint32_t channel_count;   /* of the sound */
    ring *packets;            /* not owned */
    unsigned char *record;    /* of the ring's */
    float *window;            /* SOUND_WINDOW frames, frame k at k modulo that */
    int64_t window_first, window_end;
    const sound_board *board; /* not owned */
    sound_motion motion, newest;
    bool is_ending; /* fading out: the newest motion waits */
    sound_clock clock;
    int64_t device_frame;
    int64_t cursor, cursor_before; /* next frame of the stream; the one that fades out */
    int32_t fade_left, fade_frames;
    float gain; /* 0..1, of starts and ends */
    bool is_sounding, is_correcting;
    bool is_leaving;                 /* fading out: it has lost its place */
    double band_frames, jump_frames; /* as above; for tests to widen */
    _Atomic uint64_t wanted_key;     /* [any] sound_follow_key() of the motion of which .. */
    _Atomic int64_t wanted;          /* .. this frame is needed next */
    sound_count count;
} sound_follow;

/* [main] Before the device starts. A ring of sound_follow_record_size() for it. */
size_t sound_follow_record_size(uint32_t channel_count);
CHECKED mrt_result sound_follow_init(sound_follow *self, uint32_t rate_hz, uint32_t channel_count,
                                     ring *packets, const sound_board *board, error *err);
void sound_follow_finish(sound_follow *self); /* accepts zeroed */
/* [main] or the device's opener: it runs anew from here, at this rate. */
void sound_follow_reset(sound_follow *self, uint32_t rate_hz);
uint64_t sound_follow_key(const sound_motion *motion);

/* Fills count frames of out_channels each, the first of which is heard at time_ns. `is_broken`: the
 * device ran dry before. */
typedef enum sound_break { SOUND_GOES_ON = 0, SOUND_BROKEN } sound_break;
void sound_follow_fill(sound_follow *self, float *out, uint32_t count, uint32_t out_channels,
                       int64_t time_ns, sound_break is_broken);

/* ---- a click on each beat of the timeline, added to the blocks of a loudspeaker: each begins with
 * the frame that is heard at that instant, the first of a bar higher. Beats count from 0 of the
 * timeline on, and back from there: so a count-in falls on them too ---- */

typedef struct sound_click {
    const sound_board *board; /* not owned */
    sound_motion motion;
    sound_clock clock;
    int64_t device_frame, beat; /* the last frame's beat; INT64_MIN: none */
    double at_ns;               /* on the timeline: of the last frame */
    uint32_t rate_hz, left;     /* frames of the click that is heard */
    double phase, step;         /* of its sine, radians */
    _Atomic uint64_t count;     /* [any] clicks since it was made */
} sound_click;

/* [opener] Before the first block of each opening. */
void sound_click_reset(sound_click *self, uint32_t rate_hz);
/* Adds what is heard to count frames of channels each, the first of which is heard at time_ns. */
void sound_click_add(sound_click *self, float *out, uint32_t count, uint32_t channels,
                     int64_t time_ns, sound_break is_broken);

#endif
