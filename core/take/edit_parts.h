/* take/edit_parts.h - what the operations of edit.h are made of: arguments as a table, things found
 * by their ids, and clips put into a layer in order. Inside the room. Pure; any thread. */
#ifndef MAROTTE_TAKE_EDIT_PARTS_H
#define MAROTTE_TAKE_EDIT_PARTS_H
#include "take/edit.h"
#include "take/own.h"

#include <stddef.h>

/* Of times that edits lead to, be it in several steps. */
#define EDIT_CLIP_MAX_NS (4 * EDIT_TIME_MAX_NS)

/* ---- arguments (edit_table.c) ---- */

typedef enum edit_argument_kind {
    EDIT_COUNT,   /* uint32_t, low..high */
    EDIT_INTEGER, /* int64_t, low..high */
    EDIT_NUMBER,  /* double, low_number..high_number */
    EDIT_FLAG,
    EDIT_LINE,  /* char[size], no control characters */
    EDIT_PROSE, /* char[size], newlines too */
    EDIT_OWN,
    EDIT_LAYERS,
    EDIT_REGIONS,
    EDIT_WARP
} edit_argument_kind;

typedef struct edit_argument {
    const char *key;
    edit_argument_kind kind;
    size_t offset, size; /* in struct edit */
    int64_t low, high;
    double low_number, high_number;
} edit_argument;

enum { EDIT_ARGUMENTS_MAX = 12 };
typedef struct edit_use { /* of an argument by an operation */
    const edit_argument *argument;
    bool is_optional;
} edit_use;

/* The arguments of an operation, in the order in which they are written. */
uint32_t edit_uses(edit_use out[EDIT_ARGUMENTS_MAX], edit_kind kind);
edit_kind edit_kind_named(const char *name); /* EDIT_NONE */
/* False for an optional argument that is as edit_init leaves it. */
bool edit_says(const edit *e, const edit_argument *argument);
/* "$.gain: expected a number from 0 to 10, found FOUND". */
mrt_result edit_unexpected(error *err, const edit_argument *argument, const char *found);
/* Every argument that the operation uses is within its range. */
CHECKED mrt_result edit_check_arguments(const edit *e, error *err);

/* ---- operations, by subject ---- */

CHECKED mrt_result edit_apply_take(take *t, const edit *e, error *err);
CHECKED mrt_result edit_apply_marker(take *t, const edit *e, error *err);
CHECKED mrt_result edit_apply_audio(take *t, const edit *e, error *err);
CHECKED mrt_result edit_apply_layer(take *t, const edit *e, error *err);
CHECKED mrt_result edit_apply_clip(take *t, const edit *e, error *err);
CHECKED mrt_result edit_apply_range(take *t, const edit *e, error *err);
CHECKED mrt_result edit_apply_punch(take *t, const edit *e, error *err);

/* ---- words (edit_words.c) ---- */

typedef struct edit_words {
    char text[112];
} edit_words;
edit_words edit_seconds(int64_t time_ns);                      /* "-2.05": exact */
edit_words edit_layer_words(const take_layer *layer);          /* "layer 2 'mouth'" */
edit_words edit_span_words(int64_t from_ns, int64_t until_ns); /* "2.1 .. 8 s" */
/* "clip 3 of layer 2 'mouth' (2.1 .. 8 s)", in shown time. */
edit_words edit_clip_words(const take_layer *layer, const take_clip *clip);

/* ---- things in a take (edit_find.c) ---- */

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

/* ---- clips in a layer (edit_lay.c); times in the layer's own, without its offset ---- */

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
/* Strictly ascending, neither too slow nor too fast, and within +-limit_ns. */
bool edit_is_warp(const take_warp_point *warp, uint32_t count, int64_t limit_ns);
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
