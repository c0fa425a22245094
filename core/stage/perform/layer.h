/* stage/perform/layer.h - phases 3 to 5 of the frame for one mapping: samples become hands, hands
 * become a pull, the guard keeps nonsense out. What the pull does to the face is composer.h's. A
 * function of its samples and of when its parameters change. [frame] after create; no allocation
 * then. */
#ifndef MAROTTE_STAGE_LAYER_H
#define MAROTTE_STAGE_LAYER_H
#include "stage/mapping/answers.h"
#include "stage/mapping/instance.h"
#include "stage/perform/hands.h"
#include "stage/perform/patch_bay.h"
#include "stage/perform/pointer.h"

typedef struct layer layer;

typedef struct layer_settings {
    hands_settings hands;
    double reach_mm; /* the guard: no vector leads further from `centre` */
    vec3 centre;
    /* What the mapping was taught outlives a reset; false for takes of versions in which it did
     * not. */
    bool keeps_taught;
} layer_settings;

/* [main] The mapping and the face must outlive it; the mapping is activated and reset. */
CHECKED mrt_result layer_create(layer **out, instance *mapping, const mapped_face *mapped,
                                const layer_settings *settings, error *err);
void layer_destroy(layer *self); /* [main] deactivates the mapping; NULL is fine */

void layer_reset(layer *self); /* as after create; parameters stay */
/* [frame] The same; what the mapping was taught stays (MRT_STATE). */
void layer_begin_anew(layer *self);

/* The hands of all samples of the step, then the mapping, once. A step older than the last one
 * counts as simultaneous. `near`: of mrt_frame, what the last pull asked for. */
void layer_step(layer *self, const sample_step *s, bool near);
/* What the mapping pulls, after the guard; what it was at first: idle. */
const mrt_pull *layer_pull(const layer *self);
/* The hands, pedals and time of the last step. */
const mrt_frame *layer_frame(const layer *self);
instance *layer_mapping(layer *self);
/* What the mouse on the face adds to it. */
const pointer *layer_pointer(const layer *self);
/* What pointer_save gave: it holds that again, by today's time. False: it holds what it held. */
bool layer_set_pointer(layer *self, const void *bytes, size_t size);
hands *layer_hands(layer *self);
/* What its patch makes of the channels, over the mapping; plan NULL: none. */
const patch_bay *layer_bay(const layer *self);
/* [frame] Before a sample, as patch_bay_set. What the layer has at its end is destroyed with it. */
bool layer_set_patch(layer *self, patch_plan *plan, patch_plan **out_old);

/* ---- cross-fade between mappings: no jump where another takes over ---- */

#define LAYER_FADE_S 0.25

/* Before a sample, not while is_fading: what the mapping gives from its first pull on is another's
 * than before. What was pulled last leaves while the new comes, over LAYER_FADE_S of the samples'
 * time; an anchored pull with free points elsewhere stays in the shape instead, as when a mapping
 * takes hold anew. */
void layer_crossfade(layer *self);
/* [frame] The same, to another instance: its mapping is active on the same face and reset, has the
 * old one's state, and `*room` was made for it; the room of the old one is there then. Returns the
 * old one, which is still active. */
typedef struct layer_room layer_room;
layer_room *layer_room_create(const instance *mapping); /* [main] NULL: no memory */
void layer_room_destroy(layer_room *room);              /* [main] NULL is fine */
instance *layer_switch(layer *self, instance *mapping, layer_room **room);
/* [frame] The same, to another mapping, which knows nothing of the old one. posed: the degrees of
 * freedom as the bones are now. Where the new one says nothing of what the old one drove, the face
 * first eases to rest. */
instance *layer_replace(layer *self, instance *mapping, layer_room **room, const float *posed);
/* The new one comes while the old one leaves; until its first pull it does not fade yet, and
 * another may be switched to. */
bool layer_is_fading(const layer *self);

/* What is seen of layer_pull: 0..1, below 1 while it comes. And what leaves, with what is left of
 * 1; NULL: nothing. They speak from two sides, 0 and 1: layer_side is layer_pull's. */
double layer_weight(const layer *self);
const mrt_pull *layer_leaving(const layer *self);
uint32_t layer_side(const layer *self);

/* Called from within layer_step when a parameter has another value than in the step before. */
typedef void layer_on_param(void *data, int64_t time_ns, uint32_t param_id, double value);
void layer_watch_params(layer *self, layer_on_param *on_param, void *data);

/* ---- kept ---- */

/* All that pulls to come depend on, parameters included, as bytes (at most `capacity` are written;
 * NULL: none); returns the size that it takes. 0: the mapping cannot say (no MRT_RESUME, or its
 * save gives 0). */
size_t layer_save(layer *self, void *bytes, size_t capacity);
/* [main] On error the layer is as after create. */
CHECKED mrt_result layer_load(layer *self, const void *bytes, size_t size, error *err);
/* As if all samples so far had been so much later: for a state that was kept by another clock. */
void layer_shift_time(layer *self, int64_t by_ns);

/* Its mapping's answers are written down there from now on, or given from there: then it is not
 * asked for anything, and layer_save leaves out what it says of itself. NULL: neither. */
void layer_set_answers(layer *self, answers *of);

typedef struct layer_counts {
    uint64_t samples, steps;
    uint64_t bad_pulls;  /* the guard held the last good pull */
    error first_problem; /* what the guard said first; "" none */
} layer_counts;
const layer_counts *layer_counted(const layer *self);

#endif
