/* stage/perform/performer.h - performs a face. A performer has up to PERFORMER_VOICES_MAX voices,
 * as a synthesizer has: each is a layer (phases 3 to 5) with the weight at which it shows; one
 * composer (phases 6 and 7) blends what all of them pull. Live hands are one voice; of a take each
 * clip that is shown is one, and what is performed over it is one more. Phases 3 to 6 run once per
 * step of samples, in time order; phase 7 per step while unanchored and once per drawn frame while
 * anchored: a performance is a function of its samples alone. Leaves out whose samples come next
 * (scheduler.h). [frame] after create; no allocation then. */
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
    const patch *patch;       /* copied; NULL: none */
} performer_settings;

/* [main] The face file and the mapping must outlive it; the mapping is activated and reset, and
 * voice 0 is its layer's. mapping: NULL: nobody performs yet. */
CHECKED mrt_result performer_create(performer **out, const face_file *file, instance *mapping,
                                    const performer_settings *settings, error *err);
void performer_destroy(performer *self); /* deactivates the mapping; NULL is fine */
/* [main] A layer for a voice of this performer, which must outlive it: layer_destroy it. */
CHECKED mrt_result performer_make_layer(const performer *self, instance *mapping,
                                        const performer_settings *as, layer **out, error *err);

/* [main] A patch on the face of this performer, for layer_set_patch. */
CHECKED mrt_result performer_make_patch(const performer *self, const patch *p, patch_plan **out,
                                        error *err);

/* ---- voices ---- */

enum {
    PERFORMER_PARTS_MAX = 8, /* of the composer, for a voice */
    PERFORMER_VOICES_MAX = COMPOSER_PARTS_MAX / PERFORMER_PARTS_MAX,
    PERFORMER_NOBODY = PERFORMER_VOICES_MAX
};
typedef struct performer_voice {
    layer *layer;        /* NULL: unused */
    bool is_seen;        /* false: it performs, but nothing of it reaches the face */
    uint32_t lane, rank; /* lanes are laid over each other, bottom first; the voices of one lane are
                            cross-faded, in the order of their ranks */
    bool is_additive;    /* composer_part says what each is */
    double weight, gain;
    const uint8_t *owns;
    double smooth_s; /* anchored pulls are eased with this time constant; 0: not */
    bool has_smooth; /* so far */
    int64_t smooth_ns;
    mrt_pull smooth;
} performer_voice;
/* The caller may change it between steps; zeroed: an unused one. */
performer_voice *performer_voice_of(performer *self, uint32_t voice);

/* performer_step in two: phases 3 to 5 of the voice s->voice; and phase 6 for all of them, after
 * that voice has performed, at now_ns by its clock. PERFORMER_NOBODY: none has, but the voices were
 * changed. */
void performer_map(performer *self, const sample_step *s);
void performer_constrain(performer *self, uint32_t voice, int64_t now_ns);
/* Phases 3 to 6, and 7 while unanchored. A step older than the last one of its voice counts as
 * simultaneous. */
void performer_step(performer *self, const sample_step *s);
/* Phase 7 for drawing: the shape shown and its normals. */
void performer_draw(performer *self);

/* ---- seen ---- */

composer *performer_composer(performer *self);
/* The face; its shape is that of performer_draw, in the engine's order. */
face *performer_face(performer *self);
/* How the last pull's fields are solved: as it says, else as the face's rig has it; radius > 0. */
csrbf_settings performer_solver(const performer *self);
/* True while the frames are anchored: face_columns_now tells them exactly. */
bool performer_is_anchored(const performer *self);

typedef struct performer_counts { /* of both: layer.h and composer.h say what each is */
    uint64_t samples, steps, solves, bad_pulls;
    uint64_t held_pulls, limited_steps, folded_steps, substeps, engagements, commits;
    double min_determinant;
    error first_problem;
} performer_counts;
const performer_counts *performer_counted(const performer *self);

/* ---- voice 0 ---- */

layer *performer_layer(performer *self);
/* What its mapping pulls, after the guard. */
const mrt_pull *performer_pull(const performer *self);
/* Between samples: the pose held now becomes the neutral one, as hands_rezero says. */
CHECKED mrt_result performer_rezero(performer *self, uint32_t side, error *why);
const rezero_counts *performer_rezeros(const performer *self);

/* All that frames to come depend on while it performs alone, as bytes (at most `capacity` are
 * written; NULL: none); returns the size that it takes. 0: the mapping cannot say. */
size_t performer_save(performer *self, void *bytes, size_t capacity);
/* [main] On error its layer is reset, and so is the composer. Parameters are as they were then. */
CHECKED mrt_result performer_load(performer *self, const void *bytes, size_t size, error *err);
/* The same of what the pointer made of the face alone: hands and mapping go on as they are. [frame]
 * no allocation. On error nothing has changed, or the face is at rest. */
size_t performer_save_pulled(performer *self, void *bytes, size_t capacity);
CHECKED mrt_result performer_load_pulled(performer *self, const void *bytes, size_t size,
                                         error *err);

#endif
