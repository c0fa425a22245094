/* stage/perform/composer.h - phases 8 and 9 of a frame: the pulls of all voices become one face.
 * Anchored pulls are joined in one solve; unanchored pulls drag the shape one after the other.
 * Leaves out the source of the pulls (layer.h) and the times (player.h, sequencer.h).
 *
 * At each contact and degree of freedom the layers lie over each other, bottom first:
 *   value = sum of weight gain offset over the parts of the layer that pull it
 *           + (1 - sum of their weights) value below           (an additive layer: + value below)
 * A free point belongs to its part alone. One part of weight and gain 1 gives exactly its pull. A
 * part that commits, or that anchors anew, bakes its own pull into the base and no other. A part
 * that comes or goes leaves nothing behind.
 *
 * A pointer (pointer.h) takes hold of the face as it is: where no other part pulls, its offset
 * counts from the place that the other parts had given the point. [frame] after create; no
 * allocation then; the same calls give the same bits. */
#ifndef MAROTTE_STAGE_COMPOSER_H
#define MAROTTE_STAGE_COMPOSER_H
#include "face/face.h"
#include "mesh/shading.h"
#include "stage/mapping/instance.h"
#include "stage/perform/face_file.h"

enum { COMPOSER_PARTS_MAX = 128 };

typedef struct composer composer;

/* [main] The face file must outlive it. The radius of `solver` is for pulls without one. 0: the
 * radius of the rig, or a quarter of the height. */
CHECKED mrt_result composer_create(composer **out, const face_file *file,
                                   const csrbf_settings *solver, error *err);
void composer_destroy(composer *self); /* accepts NULL */

/* The face as mappings see it, with and without poses, valid until destroy; and the reach of the
 * guard around its centre. */
const mapped_face *composer_mapped(const composer *self);
const mrt_face *composer_about(const composer *self);
/* The rig of the face file with completed poses (rig_poses_complete). NULL: a mesh alone. */
const rig *composer_rig(const composer *self);
double composer_reach_mm(const composer *self, vec3 *out_centre);

typedef struct composer_part {
    uint32_t slot;  /* 0..COMPOSER_PARTS_MAX - 1, the same in every step */
    uint32_t layer; /* parts come ordered by layer, bottom first */
    bool is_additive;
    bool is_pointer; /* its vectors come and go; the start of a free point is its place on the rest
                       face, and end - start its offset */
    double restore;  /* 0..1: moves the base by that share towards the rest shape */
    bool is_fresh;   /* the pull is of this step, and drags; false: of an earlier one */
    double weight;   /* 0..1 */
    double gain;
    const mrt_pull *pull;
    const float *shapes; /* least weight of each shape of the head, 0..1; NaN: not set. NULL: none.
                            Blended as degrees of freedom, owned as free points; only for this
                            step */
    const uint8_t *owns; /* for each contact, each degree of freedom, and all free points: 0 where
                            the part must not pull. NULL: it may pull all */
} composer_part;

/* Phase 8: one step with all parts that pull. At most MRT_MAX_VECTORS vectors are joined; more are
 * left out and counted. dt_s: time since the step before, for leaks. */
void composer_move(composer *self, const composer_part *part, uint32_t count, double dt_s);
/* For mrt_frame.near of the next step. It uses shapes that do not depend on drawing: the base while
 * engaged, and the result of unanchored steps. */
bool composer_is_near(const composer *self, const mrt_pull *pull);
/* Phase 9: the shape shown and its normals. */
void composer_draw(composer *self);
/* Back to the rest shape without any part. */
void composer_reset(composer *self);

/* The face. Its shape is that of the last composer_draw, in the order of the engine. */
face *composer_face(composer *self);
const shading *composer_shading(const composer *self); /* normals, in the order of the engine */
/* The pulls of all parts in the last step, weighted but not blended; for exports. */
const mrt_pull *composer_pull(const composer *self);
/* The targets of the last anchored step for each control, all layers blended. Returns their number.
 * 0: not anchored. */
typedef struct composer_asked {
    uint32_t contact; /* 1 + index; 0: a free point */
    vec3 start, end;  /* mm: where it took hold; its target */
    vec3 way;         /* mm: its offset with all bones at rest, derived ones too */
} composer_asked;
uint32_t composer_asks(const composer *self, composer_asked out[MRT_MAX_VECTORS]);
csrbf_settings composer_solver(const composer *self); /* radius > 0 */
/* The same with the settings of the pull. */
csrbf_settings composer_solver_of(const composer *self, const mrt_pull *pull);
/* Radius for pulls without one on that face, mm: of its rig, or a quarter of its height. */
double composer_radius_of(const face_file *file);
/* True while the face is anchored: then face_columns_now gives it exactly. */
bool composer_is_anchored(const composer *self);

/* Everything that later steps depend on, as face_save. */
size_t composer_save(composer *self, void *bytes, size_t capacity);
CHECKED mrt_result composer_load(composer *self, const void *bytes, size_t size, error *err);

typedef struct composer_counts {
    uint64_t samples, steps; /* performed: frame.c */
    uint64_t bad_pulls;      /* the guard dropped a pull: frame.c */
    uint64_t held_pulls;     /* the engine refused a pull: the shape stayed */
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
