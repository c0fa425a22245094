/* stage/perform/performer.h - a face and its voices. Like a synthesizer, a performer has several
 * voices, up to PERFORMER_VOICES_MAX. A voice is a layer with a weight; one composer blends the
 * pulls of all voices. Live hands are one voice, each visible clip of a take is one, and an overdub
 * is one more. Does not cover the phases of a step (frame.h) or the choice of the next samples
 * (scheduler.h). [frame] after create; no allocation then. */
#ifndef MAROTTE_STAGE_PERFORMER_H
#define MAROTTE_STAGE_PERFORMER_H
#include "stage/perform/composer.h"
#include "stage/perform/layer.h"

typedef struct performer_settings {
    csrbf_settings solver; /* radius: default for pulls that set none; 0: the rig's, or a quarter of
                              the height */
    double hand_length_mm; /* of both hands; 0: side_length_mm applies */
    double side_length_mm[2]; /* left, right; 0: HAND_LENGTH_MM */
    uint32_t rezero_pedal;    /* hands.h; 0: none */
    const patch *patch;       /* copied; NULL: none */
} performer_settings;

/* ---- voices ---- */

enum {
    PERFORMER_PARTS_MAX = 10, /* maximum number of parts of one voice */
    PERFORMER_VOICES_MAX = COMPOSER_PARTS_MAX / PERFORMER_PARTS_MAX,
    PERFORMER_NO_VOICE = PERFORMER_VOICES_MAX
};
typedef struct performer_voice {
    layer *layer;        /* NULL: unused */
    bool is_seen;        /* false: the voice runs, but its pulls do not reach the face */
    uint32_t lane, rank; /* lanes are stacked, bottom first; voices of one lane are cross-faded in
                            the order of their ranks */
    bool is_additive;    /* for this field to `owns` see composer_part */
    double weight, gain;
    const uint8_t *owns;
    double smooth_s; /* time constant that smooths anchored pulls; 0: off */
    bool has_smooth; /* `smooth` is valid */
    int64_t smooth_ns;
    mrt_pull smooth;
} performer_voice;

typedef struct performer {
    composer *composer;
    performer_voice voice[PERFORMER_VOICES_MAX]; /* the caller may change voices between steps */
    layer *own;              /* created with the performer; voice 0 at first; NULL: none */
    composer_counts *counts; /* of the composer; frame.c also updates them */
} performer;

/* [main] The face file and the mapping must outlive it. The mapping is activated and reset, and its
 * layer becomes voice 0. mapping NULL: no voice yet. */
CHECKED mrt_result performer_create(performer **out, const face_file *file, instance *mapping,
                                    const performer_settings *settings, error *err);
void performer_destroy(performer *self); /* deactivates the mapping; accepts NULL */
/* [main] Creates a layer for a voice of this performer. Free it with layer_destroy before the
 * performer is destroyed. */
CHECKED mrt_result performer_make_layer(const performer *self, instance *mapping,
                                        const performer_settings *as, layer **out, error *err);

/* [main] Creates a patch on the face of this performer, for patch_bay_set. */
CHECKED mrt_result performer_make_patch(const performer *self, const patch *p, patch_plan **out,
                                        error *err);

/* ---- for frame.c: the parts of the voices ---- */

typedef struct performer_parts {
    composer_part part[COMPOSER_PARTS_MAX];
    uint32_t count;
} performer_parts;
/* Lists the parts of all visible voices, bottom first. now_ns: time in the clock of the performer
 * (sample_step.due_ns). fresh: the voice that performed in this step; PERFORMER_NO_VOICE: none. */
void performer_compose(performer *self, uint32_t fresh, int64_t now_ns, performer_parts *out);

/* ---- save and load voice 0 ---- */

/* Serializes everything that later frames depend on while voice 0 performs alone. Writes at most
 * `capacity` bytes; bytes may be NULL. Returns the size of the state. 0: the mapping has no state.
 */
size_t performer_save(performer *self, void *bytes, size_t capacity);
/* [main] Restores that state, parameters included. On error the layer and the composer are reset.
 */
CHECKED mrt_result performer_load(performer *self, const void *bytes, size_t size, error *err);
/* The same for the pulls of the pointer and the shape of the face. Hands and mapping are not
 * changed. [frame] without allocation. On error either nothing has changed or the face is at rest.
 */
size_t performer_save_pointer(performer *self, void *bytes, size_t capacity);
CHECKED mrt_result performer_load_pointer(performer *self, const void *bytes, size_t size,
                                          error *err);

#endif
