/* stage/perform/composer.h - phases 8 and 9 of a frame: the pulls of all layers become one face.
 * Anchored pulls are joined in one solve; unanchored ones knead the shape one after the other.
 * Leaves out where pulls come from (layer.h) and when (player.h, sequencer.h).
 *
 * At each contact and degree of freedom the layers are laid over each other, bottom first:
 *   value = sum of weight gain offset over the layer's parts that speak of it
 *           + (1 - sum of their weights) value below           (an additive layer: + value below)
 * A free point belongs to its part alone. With one part of weight and gain 1 this is that pull.
 * What a part commits, or leaves behind when it anchors anew, is baked into the base; what the
 * others pull is not, and what comes or goes with a part leaves nothing behind.
 *
 * A pointer (pointer.h) takes hold of the face as it is: where nobody else speaks, its offset
 * counts from where the others had the place when it came. [frame] after create; no allocation
 * then; same calls, same bits. */
#ifndef MAROTTE_STAGE_COMPOSER_H
#define MAROTTE_STAGE_COMPOSER_H
#include "face/face.h"
#include "mesh/shading.h"
#include "stage/mapping/instance.h"
#include "stage/perform/face_file.h"

enum { COMPOSER_PARTS_MAX = 128 };

typedef struct composer composer;

/* [main] The face file must outlive it. solver: its radius is used when a pull names none; 0: the
 * rig's, or a quarter of the height. */
CHECKED mrt_result composer_create(composer **out, const face_file *file,
                                   const csrbf_settings *solver, error *err);
void composer_destroy(composer *self); /* NULL is fine */

/* The face as mappings see it, and that without the poses; until destroy. And the guard's reach
 * around its centre. */
const mapped_face *composer_mapped(const composer *self);
const mrt_face *composer_about(const composer *self);
/* The face file's, with poses that are complete (rig_poses_complete); NULL: a mesh alone. */
const rig *composer_rig(const composer *self);
double composer_reach_mm(const composer *self, vec3 *out_centre);

typedef struct composer_part {
    uint32_t slot;  /* 0..COMPOSER_PARTS_MAX - 1, the same in each step that it is there */
    uint32_t layer; /* parts come ordered by layer, bottom first */
    bool is_additive;
    bool is_pointer; /* its vectors come and go; a free point's start is its place on the rest face,
                       and end - start how far it is pulled */
    double restore;  /* 0..1: moves the base by that share towards the rest shape */
    bool is_fresh;   /* the pull is of this step, and drags; false: of an earlier one */
    double weight;   /* 0..1 */
    double gain;
    const mrt_pull *pull;
    const float *shapes; /* of the head's own, by their index: at least so much of each, 0..1; NaN:
                            not spoken of. NULL: of none. As degrees of freedom, owned as free
                            points; for as long as it is given */
    const uint8_t *owns; /* one for each contact, each degree of freedom, and free points: 0 where
                            it must not speak; NULL: it may everywhere */
} composer_part;

/* One step, with all parts that pull. At most 64 vectors are joined; more are left out and
 * counted. dt_s: since the step before, for leaks. */
void composer_move(composer *self, const composer_part *part, uint32_t count, double dt_s);
/* For mrt_frame.near of the next frame. Asked of shapes that do not depend on when frames are
 * drawn: the base while engaged, and what unanchored samples left. */
bool composer_is_near(const composer *self, const mrt_pull *pull);
/* Phase 9: the shape shown and its normals. */
void composer_draw(composer *self);
/* The rest shape, nobody speaking. */
void composer_reset(composer *self);

/* The face; its shape is that of composer_draw, in the engine's order. */
face *composer_face(composer *self);
const shading *composer_shading(const composer *self); /* its normals, in the engine's order */
/* The pulls of all parts in the last step, weighted but not blended; for exports. */
const mrt_pull *composer_pull(const composer *self);
/* What the last anchored step asked of the face, all layers blended, for each control that holds
 * it. Returns how many; 0: not anchored. */
typedef struct composer_asked {
    uint32_t contact; /* 1 + index; 0: a free point */
    vec3 start, end;  /* mm: where it took hold; where it is to land */
    vec3 way;         /* mm: how far it is pulled with all bones at rest, derived ones too */
} composer_asked;
uint32_t composer_asks(const composer *self, composer_asked out[MRT_MAX_VECTORS]);
csrbf_settings composer_solver(const composer *self); /* radius > 0 */
/* The same, and what the pull itself says of it. */
csrbf_settings composer_solver_of(const composer *self, const mrt_pull *pull);
/* The radius of pulls that name none on that face, mm: its rig's, or a quarter of its height. */
double composer_radius_of(const face_file *file);
/* True while the frames are anchored: face_columns_now tells them exactly. */
bool composer_is_anchored(const composer *self);

/* All that steps to come depend on, as face_save. */
size_t composer_save(composer *self, void *bytes, size_t capacity);
CHECKED mrt_result composer_load(composer *self, const void *bytes, size_t size, error *err);

typedef struct composer_counts {
    uint64_t samples, steps; /* performed: frame.c */
    uint64_t bad_pulls;      /* the guard dropped a pull: frame.c */
    uint64_t held_pulls;     /* the engine could not use a pull: the shape was held */
    uint64_t limited_steps;  /* unanchored: the tips were faster than the substeps allow */
    uint64_t folded_steps;   /* unanchored: steps with a determinant <= 0 */
    uint64_t left_out;       /* vectors beyond MRT_MAX_VECTORS */
    uint64_t solves;         /* of the engine: for an anchored step of all layers, or for a drag */
    uint64_t substeps;
    uint64_t engagements, commits;
    double min_determinant; /* unanchored: the smallest seen, 1 before any */
    error first_problem;    /* of the guard or the engine; "": none */
} composer_counts;
composer_counts *composer_counted(composer *self);

#endif
