/* show/edit_layers.h - helpers for the layers and clips of a take: describe them, find them by id,
 * insert them into a layer. Leaves out the operations: for edit_apply.c and edit_describe.c. Pure;
 * any thread. */
#ifndef MAROTTE_TAKE_EDIT_LAYERS_H
#define MAROTTE_TAKE_EDIT_LAYERS_H
#include "show/edit.h"

#include <stddef.h>

/* ---- descriptions ---- */

typedef struct edit_words {
    char text[112];
} edit_words;
edit_words edit_seconds(int64_t time_ns);                      /* "-2.05": exact */
edit_words edit_layer_words(const take_layer *layer);          /* "layer 2 'mouth'" */
edit_words edit_span_words(int64_t from_ns, int64_t until_ns); /* "2.1 .. 8 s" */
/* "clip 3 of layer 2 'mouth' (2.1 .. 8 s)", in shown time. */
edit_words edit_clip_words(const take_layer *layer, const take_clip *clip);

/* ---- objects of a take ---- */

typedef struct edit_spot { /* valid until the take's arrays change */
    take_layer *layer;
    uint32_t index; /* of the clip */
    take_clip *clip;
} edit_spot;

CHECKED mrt_result edit_find_layer(take_layer **out, take *t, uint32_t id, error *err);
CHECKED mrt_result edit_find_clip(edit_spot *out, take *t, uint32_t id, error *err);
/* Sets id_count to the highest id in use, so that ++id_count is a new id. */
void edit_count_ids(take *t);
/* Return the earliest start and the latest end of a clip, limited by its source, in shown time. */
int64_t edit_earliest_ns(const take_clip *clip);
int64_t edit_latest_ns(const take_clip *clip);

/* Makes room for one more element. `what` names the elements in the error if there are too many. */
CHECKED mrt_result edit_reserve(void **array, size_t element, uint32_t count, uint32_t cap,
                                const char *what, error *err);

/* Returns e with its material complete: values that are not set come from the take. */
edit edit_with_defaults(const edit *e, const take *t);

/* ---- clips in a layer; times in the layer's own, without its offset ---- */

/* Creates a clip of the material of e, from start_ns until end_ns. If these are EDIT_UNSAID, the
 * clip is at the time of the recording and has its length. The clip owns its warp. */
CHECKED mrt_result edit_material(take_clip *out, take *t, const take_layer *layer, const edit *e,
                                 int64_t start_ns, int64_t end_ns, error *err);
/* Inserts the clip into the layer, sorted by start, and takes ownership of it. Frees it on failure.
 */
CHECKED mrt_result edit_insert_clip(take_layer *layer, take_clip clip, error *err);
/* Removes the clip from its layer. The caller inserts it elsewhere or frees it. */
take_clip edit_remove_clip(edit_spot spot);
void edit_clip_finish(take_clip *clip);
CHECKED mrt_result edit_clip_copy(take_clip *out, const take_clip *clip, uint32_t id, error *err);
void edit_shift(take_clip *clip, int64_t by_ns);
/* Shortens the fades so that they fit into the clip. The fade-in keeps its length as far as
 * possible. */
void edit_fit_fades(take_clip *clip);
/* Cuts in_ns .. out_ns from the layer, and moves all later clips by later_ns. A clip that contains
 * the range is split into two. With in_ns == out_ns this only opens a gap. */
CHECKED mrt_result edit_cut(take *t, take_layer *layer, int64_t in_ns, int64_t out_ns,
                            int64_t later_ns, error *err);
/* Extends the take to the end of the clip if necessary. */
void edit_grow(take *t, const take_layer *layer, const take_clip *clip);

#endif
