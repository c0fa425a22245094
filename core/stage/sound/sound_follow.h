/* stage/sound/sound_follow.h - plays the sound of a take on a device whose clock differs from the
 * host's clock. Each block of the device gets the frames that belong to the time at which it is
 * heard. Frames arrive through a ring, as a stream of timeline frames from the start position of
 * the transport. If the two clocks differ by more than a fifth of a millisecond, single frames are
 * removed or repeated with a crossfade of 5 ms. A difference of more than 5 ms is corrected by one
 * jump, also with a crossfade. Never waits, allocates or makes system calls. All functions on the
 * thread of the device [device] unless marked. */
#ifndef MAROTTE_STAGE_SOUND_FOLLOW_H
#define MAROTTE_STAGE_SOUND_FOLLOW_H
#include "base/error.h"
#include "base/ring.h"
#include "stage/sound/sound_clock.h"

#include <stdatomic.h>
#include <stdbool.h>

enum { SOUND_PACKET_FRAMES = 256, SOUND_PACKETS = 64, SOUND_WINDOW = 16384, SOUND_BOARD_WORDS = 8 };

/* Position of the transport: at host_ns of the host's clock, the timeline is at at_ns. Sound is
 * played only at speed 1; 0 is a pause. The revision increases with each change. */
typedef struct sound_motion {
    uint32_t revision; /* 0: no motion yet */
    uint32_t edition;  /* of the sound: increases with each change of the sound */
    int64_t host_ns, at_ns;
    double speed;
    /* equal: no loop; otherwise playback jumps from loop_to to loop_from */
    int64_t loop_from_ns, loop_to_ns;
    bool is_mute;        /* only the click is played */
    double beat_ns;      /* interval between beats of the timeline; 0: none */
    uint32_t bar, beats; /* beats per bar; which beats click: SOUND_BEATS_* */
} sound_motion;
/* Before host_ns (count-in); from host_ns on. */
enum { SOUND_BEATS_BEFORE = 1, SOUND_BEATS_AFTER = 2 };
/* Whether the sound is played, without the click. */
bool sound_motion_is_heard(const sound_motion *self);

/* The newest motion, for any number of readers. Readers and writer never wait. */
typedef struct sound_board {
    _Atomic uint32_t sequence; /* odd: a write is in progress */
    _Atomic uint32_t edition;  /* [main] */
    _Atomic uint64_t word[SOUND_BOARD_WORDS];
} sound_board;
void sound_board_post(sound_board *self, const sound_motion *motion); /* [one thread] */
/* Returns false while a write is in progress. */
bool sound_board_read(const sound_board *self, sound_motion *out);

/* Consecutive frames of the stream of one revision and edition. Frame 0 is at at_ns of the motion,
 * and loops are unrolled. In the ring, the samples follow the packet: interleaved, with the
 * channels of the sound. */
typedef struct sound_packet {
    uint32_t revision, edition;
    int64_t first;
    uint32_t count, rate_hz;
} sound_packet;

typedef struct sound_count {   /* [any] since init */
    _Atomic uint64_t spliced;  /* single frames that were removed or repeated */
    _Atomic uint32_t jumped;   /* corrections of more than 5 ms */
    _Atomic uint32_t starved;  /* gaps because frames arrived too late */
    _Atomic uint32_t broken;   /* underruns that the device reported */
    _Atomic int32_t drift_ppb; /* of the device's clock; > 0: it runs fast */
    _Atomic uint32_t is_heard; /* the last block contained sound */
} sound_count;

typedef struct sound_follow {
    _Atomic uint32_t rate_hz; /* [any] rate of the device and of the frames in the ring */
    uint32_t channel_count;   /* of the sound */
    ring *packets;            /* borrowed */
    unsigned char *record;    /* one record of the ring */
    float *window;            /* SOUND_WINDOW frames; frame k is at index k modulo SOUND_WINDOW */
    int64_t window_first, window_end;
    const sound_board *board; /* borrowed */
    sound_motion motion, newest;
    bool is_ending; /* fading out, then `newest` becomes the motion */
    sound_clock clock;
    int64_t device_frame;
    int64_t cursor, cursor_before; /* next frame of the stream; frame that fades out */
    int32_t fade_left, fade_frames;
    float gain; /* 0..1, for starts and ends */
    bool is_sounding, is_correcting;
    bool is_leaving;                 /* fading out because its position is lost */
    double band_frames, jump_frames; /* limits, see above; tests may widen them */
    _Atomic uint64_t wanted_key;     /* [any] sound_motion_key() of the motion .. */
    _Atomic int64_t wanted;          /* .. that needs this frame next */
    sound_count count;
} sound_follow;

/* [main] Call before the device starts. The records of the ring have the size
 * sound_follow_record_size(). */
size_t sound_follow_record_size(uint32_t channel_count);
CHECKED mrt_result sound_follow_init(sound_follow *self, uint32_t rate_hz, uint32_t channel_count,
                                     ring *packets, const sound_board *board, error *err);
void sound_follow_finish(sound_follow *self); /* accepts zeroed */
/* [main] or the device's opener: restarts at this rate. */
void sound_follow_reset(sound_follow *self, uint32_t rate_hz);
uint64_t sound_motion_key(const sound_motion *motion);

/* Fills `count` frames with out_channels channels. The first frame is heard at time_ns. is_broken:
 * an underrun happened before the block. */
typedef enum sound_break { SOUND_GOES_ON = 0, SOUND_BROKEN } sound_break;
void sound_follow_fill(sound_follow *self, float *out, uint32_t count, uint32_t out_channels,
                       int64_t time_ns, sound_break is_broken);

/* ---- click on each beat of the timeline, added to the blocks of a loudspeaker. A click starts
 * with the frame that is heard at the beat. The first beat of a bar has a higher pitch. Beats are
 * counted from time 0 in both directions, so a count-in is on the beat too ---- */

typedef struct sound_click {
    const sound_board *board; /* borrowed */
    sound_motion motion;
    sound_clock clock;
    int64_t device_frame, beat; /* beat of the last frame; INT64_MIN: none */
    double at_ns;               /* position of the last frame on the timeline */
    uint32_t rate_hz, left;     /* left: remaining frames of the current click */
    double phase, step;         /* of its sine, radians */
    _Atomic uint64_t count;     /* [any] number of clicks since it was created */
} sound_click;

/* [opener] Call before the first block of each opening. */
void sound_click_reset(sound_click *self, uint32_t rate_hz);
/* Adds the clicks to `count` frames with `channels` channels. The first frame is heard at
 * time_ns. */
void sound_click_add(sound_click *self, float *out, uint32_t count, uint32_t channels,
                     int64_t time_ns, sound_break is_broken);

#endif
