/* stage/perform/life.h - life: a face that no hand moves blinks, looks around, breathes, and leans
 * into its turns. The input of life (life_input.h) ticks about sixty times a second. Each tick has
 * the strengths, the seed, and what the rest of the performance did to lids, eyes and head in the
 * step before. The stage writes these last values once, before the tick is recorded (life_watch).
 * So life depends only on its own samples: a take can perform it alone, as a layer of its own
 * (take_part), with the same bits. It adds one pull above all others of its voice. Leaves out who
 * sets the strengths. [frame] no allocation. No libm function moves the face.
 *
 * Figures: research/peers.md. Blinks: 11 to 19 a minute, closing in 78 ms (Sforza 2008). Saccades:
 * duration 21 ms + 2.2 ms per degree (Bahill 1975). Breaths: 14 a minute. */
#ifndef MAROTTE_STAGE_LIFE_H
#define MAROTTE_STAGE_LIFE_H
#include "stage/mapping/guard.h"
#include "stage/mapping/instance.h"
#include "stage/perform/hands.h"
#include "show/take.h"

/* Semantic of the channels of life, all of them MRT_NO_HAND, outside the range for plugins. */
enum { LIFE_SEMANTIC = 113 };
/* Id of the plugin type of this input, by which a track is recognised. */
#define LIFE_ID TAKE_LIFE_ID

typedef enum life_kind {
    LIFE_BLINK = 0, /* strength 0..1: 11 to 19 blinks a minute; 0: none */
    LIFE_GAZE,      /* strength 0..1: size of the saccades */
    LIFE_BREATH,    /* strength 0..1: size of the nod */
    LIFE_LEAN,      /* strength 0..1: how far eyes lead and the head leans */
    LIFE_KINDS
} life_kind;

/* The channels, in this order. */
typedef enum life_channel {
    LIFE_SEED = LIFE_KINDS, /* whole number, 0..LIFE_SEED_MOST */
    LIFE_LIDS,     /* -1..1: how far the rest of the performance closes a lid, or raises it */
    LIFE_EYES_YAW, /* rad: where it turns the eyes and the head */
    LIFE_EYES_PITCH,
    LIFE_TURN,
    LIFE_CHANNELS
} life_channel;
#define LIFE_SEED_MOST 16777215.0 /* exact as a float */
#define LIFE_RATE_HZ   60.0
/* No blink begins before the lids have been left alone for this time, nor a saccade before the
 * eyes have. */
#define LIFE_LIDS_QUIET_S 2.0
#define LIFE_EYES_QUIET_S 1.0

/* What a person sets. */
typedef struct life_settings {
    bool is_on[LIFE_KINDS];
    double strength[LIFE_KINDS]; /* 0..1 */
    uint32_t seed;               /* 0..LIFE_SEED_MOST */
} life_settings;

/* Writes the LIFE_CHANNELS channels. Valid as long as the process. */
const mrt_channel *life_channels(void);
bool life_is_route(const channel_route *route);

/* What a face offers to life. */
enum { LIFE_NO_DOF = UINT32_MAX, LIFE_POSES = 10 };
typedef struct life_body {
    uint32_t lid[2][2], eye_yaw[2], eye_pitch[2]; /* degrees of freedom; [left, right] [upper,
                                                     lower]; LIFE_NO_DOF: none */
    float closed[2][2];                           /* rad: value of a closed lid */
    uint32_t turn, nod, tilt;                     /* of the head */
    uint32_t pose[LIFE_POSES]; /* poses instead of missing degrees of freedom; LIFE_NO_DOF: none */
} life_body;
life_body life_body_of(const mapped_face *mapped);
/* Why a face has no life of this kind, as a sentence; NULL: it has. */
const char *life_missing(const life_body *body, life_kind kind);

/* How much the hand has moved something, and when. */
typedef struct life_watch_state {
    double slow;    /* the value, followed slowly */
    double quiet_s; /* since it was moved last */
} life_watch_state;

typedef struct life {
    const mapped_face *mapped;
    life_body body;
    mrt_pull pull; /* anchored, or idle: nothing moves */
    bool is_known; /* has had a tick */
    int64_t time_ns;
    uint32_t seed, random;
    double wanted[LIFE_KINDS], amount[LIFE_KINDS]; /* 0..1; a change of strength eases in */
    life_watch_state lids, yaw, pitch;
    double seen_lids; /* -1..1 */
    /* blinks */
    double blink_s; /* since the running blink began; below 0: none runs */
    double closing_s, closed_s, opening_s, next_blink_s;
    bool is_double; /* the running blink is the second of two */
    /* gaze, rad: yaw to the subject's left, pitch up */
    double gaze_from[2], gaze_to[2], gaze[2];
    double saccade_s, saccade_took_s, fixation_s;
    /* breath, in turns 0..1; slow drift of the head, s */
    double breath, breath_hz, drift_s;
    /* lean: the head's turn, followed by a critically damped spring; rad, rad/s */
    double turn, turn_per_s;
} life;

/* The face must outlive it. */
void life_init(life *out, const mapped_face *mapped);
void life_reset(life *self);
/* Call for every step, in time order. Returns true if the step has a tick. reach: a pull that leads
 * out of it is dropped. */
bool life_read(life *self, const guard *reach, const sample_step *s);
/* Writes into a tick that is performed for the first time what the rest of the performance does.
 * dof: its degrees of freedom (composer_watched). */
void life_watch(sample_step *s, const life_body *body, const float *dof);
/* Closure of the lids by the running blink, 0..1. */
double life_closure(const life *self);

/* Serialises everything that later steps depend on. Same contract as hands_save. */
size_t life_save(const life *self, void *bytes, size_t capacity);
bool life_load(life *self, const guard *reach, const void *bytes, size_t size);
void life_shift_time(life *self, int64_t by_ns);

#endif
