/* stage/perform/palette.h - the palette: poses of the rig that a person plays like the notes of a
 * keyboard. Its inputs are recorded like those of any device. A sample has the wanted strength of
 * each pose, and the time in which strengths that change reach it. The palette eases the strengths
 * and adds the poses to one pull, above the pull of the mapping. A take can perform the palette of
 * a performance alone, as a layer of its own (take_part). Leaves out who plays the poses (the
 * window). The result depends only on the samples of the palette. [frame] no allocation.
 *
 *   strength = from + (wanted - from) s^2 (3 - 2 s)    s = time since the change / fade, 0..1
 *   pull     = sum of strength pull(pose)              at each contact and degree of freedom
 *
 * Each strength is within 0..1. A sum that leads out of reach is shortened. A sample may also say
 * how much of the sum the jaw and the lips make, each on an axis of its own (JALI): `jaw` scales
 * the degrees of freedom of the jaw, `lips` the pulls of contacts, which ride on the jaw. */
#ifndef MAROTTE_STAGE_PALETTE_H
#define MAROTTE_STAGE_PALETTE_H
#include "stage/mapping/guard.h"
#include "stage/mapping/instance.h"
#include "stage/perform/hands.h"
#include "show/take.h"

/* Semantics of the channels of a palette, all of them MRT_NO_HAND. The first one is the fade in s.
 * PALETTE_JAW and PALETTE_LIPS are in 0..PALETTE_SHARE_MOST, and 1 where a track lacks them. The
 * others have the names of poses, and are in 0..1. They are outside the range for plugins. */
enum { PALETTE_SEMANTIC = 112, PALETTE_JAW = 113, PALETTE_LIPS = 114 };
#define PALETTE_SHARE_MOST 2.0
enum { PALETTE_INPUT_POSES = MRT_MAX_CHANNELS - 1, PALETTE_INPUTS = 2 };
enum { PALETTE_POSES_MAX = PALETTE_INPUTS * PALETTE_INPUT_POSES };
/* Id of the plugin type of these inputs, by which a track is recognised. */
#define PALETTE_ID          TAKE_PALETTE_ID
#define PALETTE_FADE_MOST_S 10.0

typedef struct palette_pose {
    double wanted, from, strength; /* 0..1 */
    double since_s, fade_s;        /* since `wanted` changed; until it is reached */
} palette_pose;

typedef struct palette {
    const mapped_face *mapped; /* names and pulls of the poses, in the order of `pose` */
    uint32_t count;
    bool is_known; /* has had a sample */
    int64_t time_ns;
    double dt_s;      /* from the sample before to the last one, at most 0.1 */
    double jaw, lips; /* shares of the sum, 0..PALETTE_SHARE_MOST; 1: as the poses are */
    mrt_pull pull; /* anchored, or idle: no pose has any strength. The contacts that poses move come
                      first */
    uint32_t moved_count, contact_count; /* of these, and of all in `pull` */
    palette_pose pose[PALETTE_POSES_MAX];
} palette;

/* The face must outlive it. Poses beyond PALETTE_POSES_MAX cannot be played. */
void palette_init(palette *out, const mapped_face *mapped);
void palette_reset(palette *self);
bool palette_is_route(const channel_route *route);
/* Call for every step, in time order. Reads the samples of palettes. Returns true if the step has
 * one. reach: shortens the pull to it. */
bool palette_read(palette *self, const guard *reach, const sample_step *s);
/* Holds the contacts and degrees of freedom that no pose moves at neutral, so that a pose is the
 * one face of the rig; or releases them, so that it does not disturb the pulls of others. */
void palette_hold_rest(palette *self, bool is_held);
/* Whether no strength changes any more. */
bool palette_is_settled(const palette *self);

/* Serialises everything that later steps depend on. Same contract as hands_save. The state of a
 * face with other poses is refused. */
size_t palette_save(const palette *self, void *bytes, size_t capacity);
bool palette_load(palette *self, const guard *reach, const void *bytes, size_t size);
void palette_shift_time(palette *self, int64_t by_ns);

#endif
