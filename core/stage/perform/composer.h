/* stage/perform/composer.h - phases 8 and 9 of a frame: the pulls of all voices are combined into
 * one face. Anchored pulls are joined in one solve; unanchored pulls drag the shape one after the
 * other. Does not cover where pulls come from (layer.h) or when steps happen (player.h,
 * sequencer.h).
 *
 * At each contact and degree of freedom the layers are stacked, bottom first:
 *   value = sum of weight gain offset over the parts of the layer that pull it
 *           + (1 - sum of their weights) value below           (an additive layer: + value below)
 * A free point is pulled by one part only. A single part of weight and gain 1 gives exactly its
 * pull. A part that commits or re-anchors bakes only its own pull into the base. A part that
 * appears or disappears leaves no trace in the base.
 *
 * A pointer (pointer.h) grips the face in its current shape. Its offset starts from where the other
 * parts had moved the point, while no other part pulls it. [frame] after create, without
 * allocation. The same calls give the same bits. */
#ifndef MAROTTE_STAGE_COMPOSER_H
#define MAROTTE_STAGE_COMPOSER_H
#include "face/face.h"
#include "mesh/shading.h"
#include "stage/mapping/instance.h"
#include "stage/perform/face_file.h"

enum { COMPOSER_PARTS_MAX = 160 };

typedef struct composer composer;

/* [main] The face file must outlive the composer. The radius of `solver` is the default of pulls
 * that set none. 0: the radius of the rig, or a quarter of the height. */
CHECKED mrt_result composer_create(composer **out, const face_file *file,
                                   const csrbf_settings *solver, error *err);
void composer_destroy(composer *self); /* accepts NULL */

/* The description of the face that mappings get, with and without poses, and the reach of the guard
 * around its centre. Valid until destroy. */
const mapped_face *composer_mapped(const composer *self);
const mrt_face *composer_about(const composer *self);
/* The rig of the face file with completed poses (rig_poses_complete). NULL: a mesh alone. */
const rig *composer_rig(const composer *self);
double composer_reach_mm(const composer *self, vec3 *out_centre);

typedef struct composer_part {
    uint32_t slot;  /* 0..COMPOSER_PARTS_MAX - 1, the same in every step */
    uint32_t layer; /* parts come ordered by layer, bottom first */
    bool is_additive;
    bool is_life;    /* of life.h, which does not watch itself */
    bool is_pointer; /* vectors may be added and removed. The start of a free point is its position
                        on the rest face; end - start is its offset */
    double restore;  /* 0..1: share by which the base moves towards the rest shape */
    bool is_fresh;   /* the pull belongs to this step, so an unanchored one drags; false: it is from
                        an earlier step */
    double weight;   /* 0..1 */
    double gain;
    const mrt_pull *pull;
    /* Minimum weight of each shape of the head, 0..1; NaN: not set. NULL: none. Blended like
     * degrees of freedom, owned like free points. Valid in this step only. */
    const float *shapes;
    const uint8_t *owns; /* one byte for each contact, one for each degree of freedom, one for all
                            free points; 0: the part must not pull it. NULL: it may pull all */
} composer_part;

/* Phase 8: performs one step with all parts that pull. Joins at most MRT_MAX_VECTORS vectors; skips
 * and counts the others. dt_s: time since the previous step, for leaks. */
void composer_move(composer *self, const composer_part *part, uint32_t count, double dt_s);
/* The begin and the end of phase 8: loose parts swing up to this time (face_swing_begin,
 * face_swing), in the clock of the steps. */
void composer_swing_begin(composer *self, int64_t time_ns);
void composer_swing(composer *self, int64_t time_ns);
/* Moves the time of the last step to another clock. Call after composer_load of a state from it. */
void composer_shift_time(composer *self, int64_t by_ns);
/* Returns mrt_frame.near for the next step. Uses shapes that do not depend on drawing: the base
 * while engaged, and the result of unanchored steps. */
bool composer_is_near(const composer *self, const mrt_pull *pull);
/* Phase 9: updates the drawn shape and its normals. */
void composer_draw(composer *self);
/* Returns to the rest shape and removes all parts. */
void composer_reset(composer *self);

/* Returns the face. Its shape is that of the last composer_draw, in the order of the engine. */
face *composer_face(composer *self);
const shading *composer_shading(const composer *self); /* normals, in the order of the engine */
/* The pulls of all parts in the last step, weighted but not blended; for exports. */
const mrt_pull *composer_pull(const composer *self);
/* The degrees of freedom that the parts of the last step gave, blended, without those of life. NaN:
 * not driven. Valid until the next step. */
const float *composer_watched(const composer *self);
/* Copies the targets of the last anchored step, one for each control, all layers blended. Returns
 * their number. 0: not anchored. */
typedef struct composer_target {
    uint32_t contact; /* 1 + index; 0: a free point */
    vec3 start, end;  /* mm: position when it was gripped; target */
    vec3 way;         /* mm: offset with all bones at rest, derived ones included */
} composer_target;
uint32_t composer_targets(const composer *self, composer_target out[MRT_MAX_VECTORS]);
csrbf_settings composer_solver(const composer *self); /* radius > 0 */
/* The same, with the settings of the pull applied. */
csrbf_settings composer_solver_of(const composer *self, const mrt_pull *pull);
/* Returns the default radius of pulls on that face, mm: that of its rig, or a quarter of its
 * height. */
double composer_radius_of(const face_file *file);
/* Returns true while the face is anchored. Then face_columns_now describes it exactly. */
bool composer_is_anchored(const composer *self);

/* Save and restore everything that later steps depend on. Same contract as face_save. */
size_t composer_save(composer *self, void *bytes, size_t capacity);
CHECKED mrt_result composer_load(composer *self, const void *bytes, size_t size, error *err);

typedef struct composer_counts {
    uint64_t samples, steps; /* performed: frame.c */
    uint64_t bad_pulls;      /* the guard dropped a pull: frame.c */
    uint64_t held_pulls;     /* the engine refused a pull: the shape stayed */
    uint64_t limited_steps;  /* unanchored: the tips were faster than the substeps allow */
    uint64_t folded_steps;   /* unanchored: steps with a determinant <= 0 */
    uint64_t left_out;       /* vectors skipped beyond MRT_MAX_VECTORS */
    uint64_t solves; /* by the engine: one for an anchored step of all layers, or one for a drag */
    uint64_t substeps;
    uint64_t engagements, commits;
    double min_determinant; /* unanchored: smallest determinant so far, 1 at first */
    error first_problem;    /* of the guard or the engine; "": none */
} composer_counts;
composer_counts *composer_get_counts(composer *self);

#endif
