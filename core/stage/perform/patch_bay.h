/* stage/perform/patch_bay.h - a patch on a face, while it performs: step by step what its
 * connections make of the channels (patch.h) becomes parameters of the mapping, pulls of contacts
 * and bones, and presses of the transport. Leaves out how pulls are laid over each other
 * (composer.h) and what a press does (live.h). A function of the samples alone.
 * [frame] unless marked; no allocation.
 *
 * PULLS  Two: one takes its contacts and degrees of freedom from the mapping, one adds to them. The
 * head's own shapes go beside each; what bones do of a shape is in its degrees of freedom.
 * Whenever another set of connections speaks - an input is heard first, a fader is picked up, the
 * patch is another - what was pulled leaves while the new comes, over PATCH_FADE_S: nothing jumps.
 */
#ifndef MAROTTE_STAGE_PATCH_BAY_H
#define MAROTTE_STAGE_PATCH_BAY_H
#include "face/face.h"
#include "stage/mapping/guard.h"
#include "stage/perform/patch.h"

/* ---- on a face ---- */

typedef struct patch_plan patch_plan;

/* [main] r: for poses; NULL: a face without a rig. own: for its shapes; may be NULL. What the face
 * has not is left out; patch_plan_note says so, in lines that end with \n; "" nothing. The patch is
 * copied. */
CHECKED mrt_result patch_plan_create(patch_plan **out, const patch *p, const mrt_face *about,
                                     const rig *r, const face *own, error *err);
void patch_plan_destroy(patch_plan *self); /* NULL is fine */
/* Adds to the note which parameters a mapping does not have. */
void patch_plan_check_params(patch_plan *self, const mrt_plugin_type *mapping);
const char *patch_plan_note(const patch_plan *self);

/* ---- while it performs ---- */

#define PATCH_FADE_S 0.25 /* of the samples' time */

enum { PATCH_INSTEAD = 0, PATCH_ADDED, PATCH_PULLS };

typedef struct patch_bay {
    patch_plan *plan; /* owned; NULL: nothing is patched */
    guard guard;
    const mrt_plugin_type *mapping;        /* whose parameters these are */
    uint32_t param[PATCH_CONNECTIONS_MAX]; /* in its table; UINT32_MAX: it has none such */
    patch_course course[PATCH_CONNECTIONS_MAX];
    bool may_speak[PATCH_CONNECTIONS_MAX];            /* heard, and picked up */
    bool speaks[PATCH_CONNECTIONS_MAX];               /* and in the pulls */
    bool presses[PATCH_CONNECTIONS_MAX];              /* in this step */
    uint32_t pressed[PATCH_ACTIONS];                  /* how often, since create */
    mrt_pull pull[PATCH_PULLS], leaving[PATCH_PULLS]; /* idle: nothing */
    float shape[PATCH_PULLS][FACE_SHAPES_MAX], leaving_shape[PATCH_PULLS][FACE_SHAPES_MAX];
    uint32_t shape_count; /* of them in use; 0: no patch has spoken of any. NaN: not this one */
    bool is_fading;
    uint32_t side; /* the slot of `pull`; the other is that of `leaving` */
    double fade_s;
} patch_bay;

void patch_bay_init(patch_bay *out, const guard *as);
void patch_bay_finish(patch_bay *self); /* [main] */
void patch_bay_reset(patch_bay *self);  /* nothing was heard; the plan stays */

/* Another plan, NULL: none; becomes the bay's, and the old one is the caller's. False: what was
 * changed before is still coming, and nothing has changed. */
bool patch_bay_set(patch_bay *self, patch_plan *plan, patch_plan **out_old);

/* A step. own: the mapping's parameters as they are set by hand, which it knows anew when `mapping`
 * is another; below: what it pulled last. */
void patch_bay_step(patch_bay *self, const mrt_frame *frame, const mrt_plugin_type *mapping,
                    const double *own, const mrt_pull *below);
/* The same, patched. */
void patch_bay_params(const patch_bay *self, const double *own, double *out);
/* What is seen of pull, 0..1; the rest is leaving's. */
double patch_bay_weight(const patch_bay *self);

/* Nothing fades and no filter is on its way: samples that say the same move nothing. */
bool patch_bay_is_settled(const patch_bay *self);

/* As hands_save and hands_load, of the patch that is set: another's bytes are refused. */
size_t patch_bay_save(const patch_bay *self, void *bytes, size_t capacity);
bool patch_bay_load(patch_bay *self, const void *bytes, size_t size);

#endif
