/* stage/perform/patch_bay.h - a patch that is active on a face. At each step the values of its
 * connections (patch.h) become parameters of the mapping, pulls of contacts and bones, and
 * transport actions. Does not cover the blending of pulls (composer.h) or the effect of an action
 * (live.h). The result depends only on the samples. [frame] unless marked; no allocation.
 *
 * PULLS  A patch has two pulls. One replaces the mapping at its contacts and degrees of freedom,
 * the other adds to the mapping. Each also has weights for the head's own shapes; the bone part of
 * a shape is in the degrees of freedom. The set of active connections changes when an input
 * delivers its first sample, a fader is picked up or the patch is replaced. Then the old pull fades
 * out while the new one fades in, over PATCH_FADE_S, so that nothing jumps. */
#ifndef MAROTTE_STAGE_PATCH_BAY_H
#define MAROTTE_STAGE_PATCH_BAY_H
#include "face/face.h"
#include "stage/mapping/guard.h"
#include "stage/perform/patch.h"

/* ---- a patch prepared for a face ---- */

typedef struct patch_plan patch_plan;

/* [main] r: provides the poses; NULL: a face without a rig. own: provides the shapes; may be NULL.
 * Skips targets that the face lacks. patch_plan_note lists them in lines that end with \n; "":
 * none. The patch is copied. */
CHECKED mrt_result patch_plan_create(patch_plan **out, const patch *p, const mrt_face *about,
                                     const rig *r, const face *own, error *err);
void patch_plan_destroy(patch_plan *self); /* accepts NULL */
/* Adds to the note the parameters that a mapping lacks. */
void patch_plan_check_params(patch_plan *self, const mrt_plugin_type *mapping);
const char *patch_plan_note(const patch_plan *self);

/* ---- the active patch ---- */

#define PATCH_FADE_S 0.25 /* in sample time */

enum { PATCH_INSTEAD = 0, PATCH_ADDED, PATCH_PULLS };

typedef struct patch_bay {
    patch_plan *plan; /* owned; NULL: no patch */
    guard guard;
    const mrt_plugin_type *mapping;        /* owner of the parameters */
    uint32_t param[PATCH_CONNECTIONS_MAX]; /* index in its table; UINT32_MAX: no such parameter */
    patch_course course[PATCH_CONNECTIONS_MAX];
    bool may_pull[PATCH_CONNECTIONS_MAX];             /* has a sample and is picked up */
    bool speaks[PATCH_CONNECTIONS_MAX];               /* also included in the pulls */
    bool presses[PATCH_CONNECTIONS_MAX];              /* pressed in this step */
    uint32_t pressed[PATCH_ACTIONS];                  /* number of presses since create */
    mrt_pull pull[PATCH_PULLS], leaving[PATCH_PULLS]; /* idle: no pull */
    float shape[PATCH_PULLS][FACE_SHAPES_MAX], leaving_shape[PATCH_PULLS][FACE_SHAPES_MAX];
    uint32_t shape_count; /* number of shapes in use; 0: no patch has used any. NaN in an array:
                             that shape is not set */
    bool is_fading;
    uint32_t side; /* slot of `pull`, 0 or 1; `leaving` has the other one */
    double fade_s;
} patch_bay;

void patch_bay_init(patch_bay *out, const guard *as);
void patch_bay_finish(patch_bay *self); /* [main] */
void patch_bay_reset(patch_bay *self);  /* forgets all samples; the plan is kept */

/* Replaces the plan; NULL: none. The bay then owns the new plan, and the caller owns the old one.
 * Returns false and changes nothing while the previous change still fades. */
bool patch_bay_set(patch_bay *self, patch_plan *plan, patch_plan **out_old);

/* Performs one step. own: the parameters of the mapping that the user set. If `mapping` differs
 * from the last one, the parameters are looked up again. below: the last pull of the mapping. */
void patch_bay_step(patch_bay *self, const mrt_frame *frame, const mrt_plugin_type *mapping,
                    const double *own, const mrt_pull *below);
/* Applies the patch to the parameters `own` and writes the result to `out`. */
void patch_bay_params(const patch_bay *self, const double *own, double *out);
/* Returns the weight of `pull`, 0..1; `leaving` has the rest. */
double patch_bay_weight(const patch_bay *self);

/* Returns true if nothing fades and all filters have settled, so that equal samples cause no
 * motion. */
bool patch_bay_is_settled(const patch_bay *self);

/* Same contracts as hands_save and hands_load, for the current patch. The state of another patch is
 * refused. */
size_t patch_bay_save(const patch_bay *self, void *bytes, size_t capacity);
bool patch_bay_load(patch_bay *self, const void *bytes, size_t size);

#endif
