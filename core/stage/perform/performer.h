/* stage/perform/performer.h - one mapping on one face: a layer (steps 3 to 5) whose pull is all
 * that the composer (steps 6 and 7) hears. Steps 3 to 6 run once per step of samples, in time
 * order; step 7 runs per step while unanchored and once per drawn frame while anchored: a
 * performance is a function of its samples alone. [frame] after create; no allocation then. */
#ifndef MAROTTE_STAGE_PERFORMER_H
#define MAROTTE_STAGE_PERFORMER_H
#include "stage/perform/composer.h"
#include "stage/perform/layer.h"

typedef struct performer performer;

typedef struct performer_settings {
    csrbf_settings solver; /* radius: used when a pull names none; 0: the rig's, or a quarter of the
                              height */
    double hand_length_mm; /* of both hands; 0: the next */
    double side_length_mm[2]; /* left, right; 0: HAND_LENGTH_MM */
    uint32_t rezero_pedal;    /* hands.h; 0: none */
} performer_settings;

/* [main] The face file and the mapping must outlive it; the mapping is activated and reset. */
CHECKED mrt_result performer_create(performer **out, const face_file *file, instance *mapping,
                                    const performer_settings *settings, error *err);
void performer_destroy(performer *self); /* deactivates the mapping; NULL is fine */

/* Steps 3 to 5, and then 6, of the next. */
void performer_map(performer *self, const sample_step *s);
void performer_constrain(performer *self);
/* Steps 3 to 6, and 7 while unanchored. A step older than the last one counts as simultaneous. */
void performer_step(performer *self, const sample_step *s);
/* Between samples: the pose held now becomes the neutral one, as hands_rezero says. */
CHECKED mrt_result performer_rezero(performer *self, uint32_t side, error *why);
const rezero_counts *performer_rezeros(const performer *self);
/* Step 7 for drawing: the shape shown and its normals. */
void performer_draw(performer *self);

composer *performer_composer(performer *self);
layer *performer_layer(performer *self);

/* All that frames to come depend on, as bytes (at most `capacity` are written; NULL: none); returns
 * the size that it takes. 0: the mapping cannot say. */
size_t performer_save(performer *self, void *bytes, size_t capacity);
/* [main] On error it is as after create. Parameters stay as they were then. */
CHECKED mrt_result performer_load(performer *self, const void *bytes, size_t size, error *err);

/* The same for a layer and a composer that are used apart: the layer's pull is all that the
 * composer hears. */
void performer_move(layer *of, composer *shown);
/* A layer as parts of a step, as `as` says of all: what it pulls, what is leaving it, and what its
 * pointer adds, to contacts and to places. Slots are as->slot, below PERFORMER_SLOTS, and so much
 * more; layers are twice as->layer, and one more. Returns how many: 1 to PERFORMER_PARTS_MAX. */
enum { PERFORMER_PARTS_MAX = 4, PERFORMER_SLOTS = COMPOSER_PARTS_MAX / PERFORMER_PARTS_MAX };
uint32_t performer_parts(const layer *of, const composer_part *as,
                         composer_part out[PERFORMER_PARTS_MAX]);
CHECKED mrt_result performer_load_into(layer *of, composer *shown, const void *bytes, size_t size,
                                       error *err);

/* The face; its shape is that of performer_draw, in the engine's order. */
face *performer_face(performer *self);
/* How the last pull's fields are solved: as it says, else as the face's rig has it; radius > 0. */
csrbf_settings performer_solver(const performer *self);
/* What the mapping pulls, after the guard. */
const mrt_pull *performer_pull(const performer *self);
/* True while the frames are anchored: face_columns_now tells them exactly. */
bool performer_is_anchored(const performer *self);

typedef struct performer_counts { /* of both: layer.h and composer.h say what each is */
    uint64_t samples, steps, solves, bad_pulls;
    uint64_t held_pulls, limited_steps, folded_steps, substeps, engagements, commits;
    double min_determinant;
    error first_problem;
} performer_counts;
const performer_counts *performer_counted(const performer *self);

#endif
