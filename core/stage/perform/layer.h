/* stage/perform/layer.h - an active mapping with its hands, its patch, its last pull and the
 * cross-fade to the mapping that replaces it. Does not cover the phases of a step (frame.c) or the
 * effect of a pull on the face (composer.h). The result depends only on the samples and the times
 * of parameter changes. This folder may read the fields; only the functions below change them.
 * [frame] after create; no allocation then. */
#ifndef MAROTTE_STAGE_LAYER_H
#define MAROTTE_STAGE_LAYER_H
#include "stage/mapping/answers.h"
#include "stage/mapping/guard.h"
#include "stage/mapping/isolate.h"
#include "stage/perform/frame_inputs.h"
#include "stage/perform/hands.h"
#include "stage/perform/life.h"
#include "stage/perform/palette.h"
#include "stage/perform/patch_bay.h"
#include "stage/perform/pointer.h"

/* ---- cross-fade between mappings, so that the face does not jump ---- */

#define LAYER_FADE_S 0.25

/* All transitions are made by enter() in layer.c.
 *
 *   another version, a reset     first pull            after LAYER_FADE_S
 *   any ----> WAITS -------------> IN, OVER ---------------> NONE
 *   any ----> WAITS_OTHER -------> IN, OVER ---------------> NONE
 *             another mapping  `-> HOME -------------------> WAITS
 *   any ----> HOME: the last hand was removed
 */
typedef enum crossfade_state {
    CROSSFADE_NONE = 0,    /* only the pull of the mapping is shown */
    CROSSFADE_WAITS,       /* waits for the first pull of a newer build, or after a reset */
    CROSSFADE_WAITS_OTHER, /* waits for the first pull of another mapping */
    CROSSFADE_IN,          /* the new pull fades in, nothing fades out: the shape is kept */
    CROSSFADE_OVER,        /* the new pull fades in while `leaving` fades out */
    CROSSFADE_HOME         /* `leaving` eases to rest, then the new mapping begins */
} crossfade_state;

typedef struct crossfade {
    crossfade_state state;
    double fade_s;
    uint32_t side;             /* slot of layer_pull, 0 or 1; `leaving` has the other one */
    uint32_t anchor_shift;     /* added to the mapping's anchors */
    float posed[MRT_MAX_DOFS]; /* WAITS_OTHER: the degrees of freedom at the switch */
    mrt_pull leaving;
    mrt_pull shown; /* result of layer_pull instead of `good`, in HOME or with an anchor_shift */
} crossfade;

typedef struct layer_settings {
    hands_settings hands;
    double reach_mm; /* guard: the largest distance of a vector from `centre` */
    vec3 centre;
    /* Taught values outlive a reset. False for takes of versions in which they did not. */
    bool keeps_taught;
} layer_settings;

/* Memory that depends on the mapping. */
typedef struct layer_room {
    double *last_params;   /* of the previous sample */
    double *stored_params; /* used while a state is loaded */
    double *patched_params;
    unsigned char *taught; /* TAUGHT_BYTES_MAX bytes, used while the mapping is reset; NULL: the
                              mapping does not learn */
} layer_room;

/* Called in a step when a parameter has another value than in the previous step. */
typedef void layer_on_param(void *data, int64_t time_ns, uint32_t param_id, double value);

typedef struct layer {
    instance *mapping;
    const mrt_mapping *functions;
    const mrt_resume *resume;         /* NULL: none */
    const isolate_takeover *takeover; /* NULL: the mapping runs in this process */
    /* Records the answers of the mapping, or replays them. In replay the mapping is not called, and
     * layer_save skips its state. NULL: neither. */
    answers *answers;
    const mrt_face *about;
    guard guard;
    layer_settings settings;
    hands *hands;
    frame_inputs inputs;
    patch_bay bay;        /* pulls and parameters from the patch, on top of the mapping */
    pointer pointer;      /* pulls of the mouse on the face */
    palette palette;      /* poses that are played */
    life life;            /* blinks, gaze, breath, lean */
    bool resets;          /* a reset of the mapping is pending until its state is known */
    uint32_t reset_waits; /* steps that the reset has waited for the taught values */
    bool has_time;
    mrt_frame frame; /* hands, pedals and time of the last step */
    mrt_pull pull;   /* output of the mapping, which finds its last values in it */
    mrt_pull good;   /* last pull that passed the guard */
    crossfade crossfade;
    layer_room *room;
    layer_on_param *on_param; /* NULL: changes are not recorded */
    void *on_param_data;
} layer;

/* [main] The mapping and the face must outlive it. The mapping is activated and reset. */
CHECKED mrt_result layer_create(layer **out, instance *mapping, const mapped_face *mapped,
                                const layer_settings *settings, error *err);
void layer_destroy(layer *self); /* [main] deactivates the mapping; accepts NULL */

void layer_reset(layer *self); /* restores the state after create; parameters are kept */
/* [frame] The same, but the taught values of the mapping are kept (MRT_STATE). */
void layer_reset_keep_taught(layer *self);

/* ---- for frame.c ---- */

/* Call once per step, before the mapping. Advances a cross-fade, and resets the mapping if the
 * pointer requested it. */
void layer_advance(layer *self);
/* Makes `pull`, which passed the guard, the pull of the layer. */
void layer_use_pull(layer *self);
/* Drops `pull`. The mapping gets the last good pull at its next call. */
void layer_keep_good(layer *self);
/* Returns whether recorded answers replace the mapping. */
bool layer_is_answered(const layer *self);

/* ---- pulls ---- */

/* Returns the pull after the guard; idle before the first one. */
const mrt_pull *layer_pull(const layer *self);
/* layer_weight returns the weight of layer_pull, 0..1, below 1 while it fades in. layer_leaving
 * returns the pull that fades out, which has the weight 1 - layer_weight. NULL: none. */
double layer_weight(const layer *self);
const mrt_pull *layer_leaving(const layer *self);
/* Restores the bytes of pointer_save, but keeps the current time. Returns false on error; then
 * nothing has changed. */
bool layer_set_pointer(layer *self, const void *bytes, size_t size);

/* ---- replace the mapping ---- */

/* Call between two steps, not while layer_is_fading, if the next pulls of the mapping are unrelated
 * to the last one. The last pull fades out while the new one fades in, over LAYER_FADE_S of sample
 * time. An anchored pull with other free points is baked into the shape instead, as when a mapping
 * re-anchors. */
void layer_crossfade(layer *self);
layer_room *layer_room_create(const instance *mapping); /* [main] NULL: no memory */
void layer_room_destroy(layer_room *room);              /* [main] accepts NULL */
/* [frame] The same for another instance. The instance must be active on the same face, reset, and
 * have the state of the old one. `*room` must be created for it; afterwards `*room` is the room of
 * the old one. Returns the old instance, which is still active. */
instance *layer_switch(layer *self, instance *mapping, layer_room **room);
/* [frame] The same for another mapping without the state of the old one. posed: the current degrees
 * of freedom of the bones. If the new mapping does not drive a bone that the old one drove, the
 * face eases to rest first. keeps_clay false: the base returns to rest, too. */
instance *layer_replace(layer *self, instance *mapping, layer_room **room, const float *posed,
                        bool keeps_clay);
/* [frame] Removes the hands of an input that has these channels. A hand that another input also has
 * comes back with its next sample. If no hand remains, the pull of the mapping eases to rest, and
 * the mapping is reset. Its taught values are kept. keeps_clay: as for layer_replace. */
void layer_remove_hands(layer *self, const mrt_channel *channels, uint32_t count, bool keeps_clay);
/* Returns true from the first pull of the new mapping until the end of the cross-fade. */
bool layer_is_fading(const layer *self);

/* ---- save and load ---- */

/* Serializes everything that later pulls depend on, parameters included. Writes at most `capacity`
 * bytes; bytes may be NULL. Returns the size of the state. 0: the mapping has no state (no
 * MRT_RESUME, or its save returns 0). */
size_t layer_save(layer *self, void *bytes, size_t capacity);
/* [main] On error the layer is reset to its state after create. */
CHECKED mrt_result layer_load(layer *self, const void *bytes, size_t size, error *err);
/* Shifts all times of the layer, for a state that was saved with another clock. */
void layer_shift_time(layer *self, int64_t by_ns);

#endif
