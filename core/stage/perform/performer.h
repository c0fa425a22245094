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

typedef struct performer_settings {
    csrbf_settings solver; /* radius: used when a pull names none; 0: the rig's, or a quarter of the
                              height */
    double hand_length_mm; /* of both hands; 0: the next */
    double side_length_mm[2]; /* left, right; 0: HAND_LENGTH_MM */
    uint32_t rezero_pedal;    /* hands.h; 0: none */
    const patch *patch;       /* copied; NULL: none */
} performer_settings;

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

typedef struct performer_counts { /* of both: layer.h and composer.h say what each is */
    uint64_t samples, steps, solves, bad_pulls;
    uint64_t held_pulls, limited_steps, folded_steps, substeps, engagements, commits;
    double min_determinant;
    error first_problem;
} performer_counts;

typedef struct performer {
    composer *composer;
    performer_voice voice[PERFORMER_VOICES_MAX]; /* the caller may change them between steps */
    layer *own; /* made with the performer; voice 0 at first; NULL: none */
    performer_counts counts;
} performer;

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

/* ---- for frame.c: what of the voices reaches the face ---- */

typedef struct performer_parts {
    composer_part part[COMPOSER_PARTS_MAX];
    uint32_t count;
} performer_parts;
/* The parts of all voices that are seen, bottom first, at now_ns of the clock of whoever performs.
 * fresh: the voice that performed in this step; PERFORMER_NOBODY: none has. */
void performer_compose(performer *self, uint32_t fresh, int64_t now_ns, performer_parts *out);
/* Takes the counts of the composer over. */
void performer_count(performer *self);

/* ---- kept: of voice 0 ---- */

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
