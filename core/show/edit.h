/* show/edit.h - what can be done to a take after it was recorded: one operation with its arguments,
 * as a struct and as a line of JSON, and what it makes of a take. An edit changes what a take shows
 * and when, never what was recorded. Leaves out the list of edits and undo (history.h) and where it
 * is stored (show.h). edit.c lists every operation with its arguments and their ranges.
 *
 * TIMES  All times are on the timeline of the take as it is shown, the offsets of its layers
 *        included; only from_ns and to_ns are show time. Layers and clips are named by their ids,
 *        which edit_apply gives in order: the same list of edits gives the same ids.
 * Pure data and pure functions; any thread. */
#ifndef MAROTTE_TAKE_EDIT_H
#define MAROTTE_TAKE_EDIT_H
#include "show/take.h"

enum {
    EDIT_LAYERS_MAX = 16,
    EDIT_CLIPS_MAX = 4096, /* of a layer */
    EDIT_OWN_MAX = 64,     /* patterns of a layer */
    EDIT_WARP_MAX = 1024,  /* points of a clip */
    EDIT_MARKERS_MAX = 4096,
    EDIT_BYTES_MAX = 1 << 18, /* of an edit as JSON */
    EDIT_TEXT = 160           /* of an edit in words */
};
#define EDIT_TIME_MAX_NS INT64_C(1000000000000000) /* 11 days, either way of timeline 0 */
#define EDIT_CLIP_MAX_NS                                                                           \
    (4 * EDIT_TIME_MAX_NS)    /* of times that edits lead to, in several steps                     \
                               */
#define EDIT_UNSAID INT64_MIN /* of a time that may be left out */

typedef enum edit_kind {
    EDIT_NONE = 0,
    EDIT_TAKE_SLATE,    /* scene, shot, number */
    EDIT_TAKE_RENAME,   /* name */
    EDIT_TAKE_NOTE,     /* note */
    EDIT_TAKE_RATE,     /* rating */
    EDIT_TAKE_FPS,      /* fps */
    EDIT_TAKE_TIMECODE, /* frame of timeline 0, drop */
    EDIT_TAKE_DELETE,
    EDIT_TAKE_RESTORE,
    EDIT_MARKER_ADD,     /* at_ns, text */
    EDIT_MARKER_MOVE,    /* marker, at_ns */
    EDIT_MARKER_RENAME,  /* marker, text */
    EDIT_MARKER_REMOVE,  /* marker */
    EDIT_LAYER_ADD,      /* name, own, place */
    EDIT_LAYER_REMOVE,   /* layer; this and the next ones too */
    EDIT_LAYER_RENAME,   /* name */
    EDIT_LAYER_ORDER,    /* place */
    EDIT_LAYER_MUTE,     /* muted */
    EDIT_LAYER_SOLO,     /* solo */
    EDIT_LAYER_ADDITIVE, /* additive */
    EDIT_LAYER_GAIN,     /* gain */
    EDIT_LAYER_OFFSET,   /* offset_ns */
    EDIT_LAYER_OWN,      /* own */
    EDIT_CLIP_ADD,       /* layer, material, start_ns, end_ns: left out, where it happened */
    EDIT_CLIP_REMOVE,    /* clip; this and the next ones too */
    EDIT_CLIP_TRIM,      /* start_ns, end_ns: one or both */
    EDIT_CLIP_SPLIT,     /* at_ns: what is after it becomes a new clip */
    EDIT_CLIP_MOVE,      /* start_ns, layer: one or both */
    EDIT_CLIP_SPEED,     /* speed, at_ns: so many times as fast, about an instant or its start */
    EDIT_CLIP_CURVE,     /* warp */
    EDIT_CLIP_SMOOTH,    /* smooth_s */
    EDIT_CLIP_GAIN,      /* gain */
    EDIT_CLIP_FADE,      /* fade_in_ns, fade_out_ns: one or both */
    EDIT_CLIP_MUTE,      /* muted */
    EDIT_CLIP_PERFORM,   /* performance: the same tracks, performed anew */
    EDIT_RANGE_KEEP,     /* in_ns, out_ns: the take becomes that range */
    EDIT_RANGE_CUT,      /* in_ns, out_ns, layers, ripple: what is later moves up, or a gap stays */
    EDIT_RANGE_INSERT,   /* at_ns, length_ns, layers */
    EDIT_PUNCH, /* layer, material, in_ns, out_ns, fade_ns: a span of the layer shows other material
                 */
    EDIT_COMP,  /* regions or own and name, material, in_ns, out_ns, fade_ns: a layer each */
    EDIT_AUDIO_ATTACH, /* audio, offset_ns, gain */
    EDIT_AUDIO_OFFSET, /* offset_ns */
    EDIT_AUDIO_TRIM,   /* start_ns, end_ns on the timeline: one or both */
    EDIT_AUDIO_GAIN,   /* gain */
    EDIT_AUDIO_DETACH,
    EDIT_KIND_COUNT
} edit_kind;

/* Material is a span of a performance: performance, from_ns .. to_ns, and which of its instants is
 * shown at the start: source_ns; or, if it is not to run at its own speed, warp. */
typedef struct edit {
    edit_kind kind;
    uint32_t layer, clip;   /* ids */
    uint32_t marker, place; /* from 0, by time, from the bottom; place UINT32_MAX: on top */
    uint32_t number, rating;
    uint32_t regions; /* bits, 1 << own_region */
    bool is_muted, is_solo, is_additive, is_drop, is_ripple;
    int64_t performance, audio;
    int64_t from_ns, to_ns, source_ns;
    int64_t start_ns, end_ns, at_ns, in_ns, out_ns;
    int64_t fade_ns, fade_in_ns, fade_out_ns, length_ns, offset_ns;
    int64_t frame;
    double fps, gain, speed, smooth_s;
    char name[TAKE_NAME], scene[TAKE_NAME], shot[TAKE_NAME];
    char text[96];
    char note[512];
    uint32_t layer_count; /* 0: all layers */
    uint32_t layers[EDIT_LAYERS_MAX];
    uint32_t own_count;
    char (*own)[TAKE_NAME]; /* owned */
    uint32_t warp_count;
    take_warp_point *warp; /* owned */
} edit;

/* Whatever may be left out is left out. */
void edit_init(edit *out, edit_kind kind);
void edit_finish(edit *e); /* accepts zeroed */

/* "clip.trim", as in JSON; "" for what is none. */
const char *edit_name(edit_kind kind);

/* {"op":"clip.trim","clip":3,"start_ns":0}. Errors name the place in it ("$.clip"). An operation or
 * an argument of a newer version is refused by its name: MRT_ERR_UNSUPPORTED. On failure `out` is
 * zeroed. */
CHECKED mrt_result edit_parse(edit *out, const char *text, size_t size, error *err);
/* One line without a newline, to be freed. What edit_parse reads as an equal edit. */
CHECKED mrt_result edit_write(char **out, const edit *e, error *err);

/* Every argument that the operation uses is within its range. */
CHECKED mrt_result edit_check_arguments(const edit *e, error *err);
/* Strictly ascending, neither too slow nor too fast, and within +-limit_ns. */
bool edit_is_warp(const take_warp_point *warp, uint32_t count, int64_t limit_ns);

/* ---- what it makes of a take (edit_apply.c, edit_describe.c) ---- */

/* What the edit makes of a take for which edit_check holds; it holds afterwards. On failure the
 * take is unchanged, and the text says which layer, clip or range is concerned and what is
 * possible. */
CHECKED mrt_result edit_apply(take *t, const edit *e, error *err);
/* As edit_apply for somebody who throws the take away when it fails: it may be half changed then.
 */
CHECKED mrt_result edit_apply_onto(take *t, const edit *e, error *err);

/* Which recording the edit shows that the take may not have shown before, so that it can be kept;
 * false: none. `before`: the take as it was before the edit. */
typedef struct edit_reference {
    int64_t performance;
    int64_t from_ns, to_ns; /* show time */
} edit_reference;
bool edit_refers(edit_reference *out, const edit *e, const take *before);

/* What holds for every take: ids are unique; sizes are within the limits above; numbers are finite
 * and within the ranges of their edits; clips are in order, and no three of a layer overlap at an
 * instant; they end after their start, show instants from 0 to to_ns - from_ns only, and their
 * fades fit into them; warps ascend strictly, between 1/1000 and 1000 times as fast. */
CHECKED mrt_result edit_check(const take *t, error *err);

/* What the edit does, in words for a person, given the take before it: "trim 'mouth' to 2.1 .. 8
 * s". Things that the take does not have are named by their ids. */
void edit_describe(char out[EDIT_TEXT], const edit *e, const take *before);

#endif
