/* show/edit_layers.h - the layers and clips of a take as edits handle them: named in words, found
 * by their ids, put into a layer in order. For edit_apply.c and edit_describe.c. Pure; any thread.
 */
#ifndef MAROTTE_TAKE_EDIT_LAYERS_H
#define MAROTTE_TAKE_EDIT_LAYERS_H
#include "show/edit.h"

#include <stddef.h>

/* ---- words ---- */

typedef struct edit_words {
    char text[112];
} edit_words;
edit_words edit_seconds(int64_t time_ns);                      /* "-2.05": exact */
edit_words edit_layer_words(const take_layer *layer);          /* "layer 2 'mouth'" */
edit_words edit_span_words(int64_t from_ns, int64_t until_ns); /* "2.1 .. 8 s" */
/* "clip 3 of layer 2 'mouth' (2.1 .. 8 s)", in shown time. */
edit_words edit_clip_words(const take_layer *layer, const take_clip *clip);

/* ---- things in a take ---- */

typedef struct edit_spot { /* until the take's arrays change */
    take_layer *layer;
    uint32_t index; /* of the clip */
    take_clip *clip;
} edit_spot;

CHECKED mrt_result edit_find_layer(take_layer **out, take *t, uint32_t id, error *err);
CHECKED mrt_result edit_find_clip(edit_spot *out, take *t, uint32_t id, error *err);
/* So that ++id_count is a new id, whoever gave those that are there. */
void edit_count_ids(take *t);
/* The shown times at which a clip can start and end: where its source has something. */
int64_t edit_earliest_ns(const take_clip *clip);
int64_t edit_latest_ns(const take_clip *clip);

/* Room for one more element; the text names what there are too many of. */
CHECKED mrt_result edit_reserve(void **array, size_t element, uint32_t count, uint32_t cap,
                                const char *what, error *err);

/* e with its material in full: what was left out is as in the take. */
edit edit_with_defaults(const edit *e, const take *t);

/* ---- clips in a layer; times in the layer's own, without its offset ---- */

/* What e says, as a clip from start_ns until end_ns, or, where these are EDIT_UNSAID, where it
 * happened and as long as it lasts. Owns its warp. */
CHECKED mrt_result edit_material(take_clip *out, take *t, const take_layer *layer, const edit *e,
                                 int64_t start_ns, int64_t end_ns, error *err);
/* Takes the clip over, in order; on failure frees it. */
CHECKED mrt_result edit_lay(take_layer *layer, take_clip clip, error *err);
/* Takes the clip off its layer, to be laid elsewhere or freed. */
take_clip edit_lift(edit_spot spot);
void edit_clip_finish(take_clip *clip);
CHECKED mrt_result edit_clip_copy(take_clip *out, const take_clip *clip, uint32_t id, error *err);
void edit_shift(take_clip *clip, int64_t by_ns);
/* Shortens fades to what fits: first the one at the start has its length. */
void edit_fit_fades(take_clip *clip);
/* Takes in_ns .. out_ns out of the layer and moves what comes after by later_ns. Clips that reach
 * over it become two; with in_ns == out_ns this opens the layer there. */
CHECKED mrt_result edit_cut(take *t, take_layer *layer, int64_t in_ns, int64_t out_ns,
                            int64_t later_ns, error *err);
/* The take is at least as long as what it shows. */
void edit_grow(take *t, const take_layer *layer, const take_clip *clip);

#endif
