/* stage/perform/layer.h - a mapping that performs: its hands, its patch, what it pulled last, and
 * the cross-fade to the mapping that replaces it. Leaves out the phases of a step (frame.c) and
 * what a pull does to the face (composer.h). A function of its samples and of when its parameters
 * change. The fields are for this room to read; the functions below change them. [frame] after
 * create; no allocation then. */
#ifndef MAROTTE_STAGE_LAYER_H
#define MAROTTE_STAGE_LAYER_H
#include "stage/mapping/answers.h"
#include "stage/mapping/guard.h"
#include "stage/mapping/isolate.h"
#include "stage/perform/frame_inputs.h"
#include "stage/perform/hands.h"
#include "stage/perform/patch_bay.h"
#include "stage/perform/pointer.h"

/* ---- cross-fade between mappings: no jump where another takes over ---- */

#define LAYER_FADE_S 0.25

/* layer.c: enter() makes all transitions.
 *
 *   another version, a reset     first pull            after LAYER_FADE_S
 *   any ----> WAITS -------------> IN, OVER ---------------> NONE
 *   any ----> WAITS_OTHER -------> IN, OVER ---------------> NONE
 *             another mapping  `-> HOME -------------------> WAITS
 */
typedef enum crossfade_state {
    CROSSFADE_NONE = 0,    /* the mapping's own pull is all that is seen */
    CROSSFADE_WAITS,       /* for the first pull of a newer build, or after a reset */
    CROSSFADE_WAITS_OTHER, /* for the first pull of another mapping */
    CROSSFADE_IN,          /* the new pull comes, nothing leaves: the shape stays as it is */
    CROSSFADE_OVER,        /* the new pull comes while `leaving` leaves */
    CROSSFADE_HOME         /* `leaving` eases to rest; the new mapping begins after that */
} crossfade_state;

typedef struct crossfade {
    crossfade_state state;
    double fade_s;
    uint32_t side;             /* of layer_pull; `leaving` has the other one */
    uint32_t anchor_shift;     /* added to the mapping's anchors */
    float posed[MRT_MAX_DOFS]; /* WAITS_OTHER: the degrees of freedom at the switch */
    mrt_pull leaving;
    mrt_pull shown; /* what layer_pull gives instead of `good`, in HOME or with an anchor_shift */
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
    double *last_params;   /* of the sample before */
    double *stored_params; /* while a state is loaded */
    double *patched_params;
    unsigned char
        *taught; /* TAUGHT_BYTES_MAX, while the mapping is reset; NULL: it learns nothing */
} layer_room;

/* Called in a step when a parameter has another value than in the step before. */
typedef void layer_on_param(void *data, int64_t time_ns, uint32_t param_id, double value);

typedef struct layer {
    instance *mapping;
    const mrt_mapping *functions;
    const mrt_resume *resume;         /* NULL: it has none */
    const isolate_takeover *takeover; /* NULL: it runs here */
    /* The mapping's answers are written down there, or given from there: then the mapping is not
     * asked, and layer_save leaves out its state. NULL: neither. */
    answers *answers;
    const mrt_face *about;
    guard guard;
    layer_settings settings;
    hands *hands;
    frame_inputs inputs;
    patch_bay bay;        /* what its patch makes of the channels, over the mapping */
    pointer pointer;      /* what the mouse on the face adds */
    bool resets;          /* the mapping is to be reset as soon as its state is known */
    uint32_t reset_waits; /* steps, for what it was taught */
    bool has_time;
    mrt_frame frame; /* hands, pedals and time of the last step */
    mrt_pull pull;   /* what the mapping fills; it sees its own last values */
    mrt_pull good;   /* the last that passed the guard */
    crossfade crossfade;
    layer_room *room;
    layer_on_param *on_param; /* NULL: nobody records */
    void *on_param_data;
} layer;

/* [main] The mapping and the face must outlive it. The mapping is activated and reset. */
CHECKED mrt_result layer_create(layer **out, instance *mapping, const mapped_face *mapped,
                                const layer_settings *settings, error *err);
void layer_destroy(layer *self); /* [main] deactivates the mapping; accepts NULL */

void layer_reset(layer *self); /* as after create; parameters stay */
/* [frame] The same, but the taught values of the mapping stay (MRT_STATE). */
void layer_begin_anew(layer *self);

/* ---- for frame.c ---- */

/* Once a step, before the mapping: advances a cross-fade, and resets the mapping if the pointer
 * requested it. */
void layer_go_on(layer *self);
/* `pull` passed the guard: it becomes the pull of the layer. */
void layer_use_pull(layer *self);
/* Drops `pull`: the mapping sees the last good pull on its next call. */
void layer_keep_good(layer *self);
/* Returns whether stored answers replace the mapping. */
bool layer_is_answered(const layer *self);

/* ---- what is seen ---- */

/* The pull after the guard. Idle before the first. */
const mrt_pull *layer_pull(const layer *self);
/* The weight of layer_pull, 0..1, below 1 while it fades in; and the pull that fades out, with the
 * rest of 1. NULL: none. */
double layer_weight(const layer *self);
const mrt_pull *layer_leaving(const layer *self);
/* Restores the bytes of pointer_save with the current time. False: nothing has changed. */
bool layer_set_pointer(layer *self, const void *bytes, size_t size);

/* ---- another mapping ---- */

/* Between two steps, not while layer_is_fading: the next pulls of the mapping have no relation to
 * the last one. The last pull fades out while the new one fades in, over LAYER_FADE_S of sample
 * time. An anchored pull with free points elsewhere stays in the shape instead, as when a mapping
 * takes hold anew. */
void layer_crossfade(layer *self);
layer_room *layer_room_create(const instance *mapping); /* [main] NULL: no memory */
void layer_room_destroy(layer_room *room);              /* [main] NULL is fine */
/* [frame] The same for another instance. It must be active on the same face, reset, and have the
 * state of the old one; `*room` must be made for it. Afterwards `*room` is the room of the old one.
 * Returns the old instance, which is still active. */
instance *layer_switch(layer *self, instance *mapping, layer_room **room);
/* [frame] The same for another mapping without the state of the old one. posed: the current degrees
 * of freedom of the bones. If the new mapping does not drive a bone that the old one drove, the
 * face eases to rest first. */
instance *layer_replace(layer *self, instance *mapping, layer_room **room, const float *posed);
/* True from the first pull of the new mapping until the end of the cross-fade. */
bool layer_is_fading(const layer *self);

/* ---- kept ---- */

/* Serializes everything that later pulls depend on, parameters included. Writes at most `capacity`
 * bytes; bytes may be NULL. Returns the size of the state. 0: the mapping has no state (no
 * MRT_RESUME, or its save returns 0). */
size_t layer_save(layer *self, void *bytes, size_t capacity);
/* [main] On error the layer is as after create. */
CHECKED mrt_result layer_load(layer *self, const void *bytes, size_t size, error *err);
/* Moves all times of the layer: for a state that was stored by another clock. */
void layer_shift_time(layer *self, int64_t by_ns);

#endif
