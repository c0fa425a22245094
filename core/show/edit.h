/* show/edit.h - the edits of a take: each is one operation with its arguments, as a struct and as a
 * line of JSON. An edit changes which recordings a take shows, and when; it never changes recorded
 * data. Leaves out the list of edits and undo (history.h) and their storage (show.h). edit.c lists
 * all operations with their arguments and ranges.
 *
 * TIMES  Times are on the timeline of the take, including the offsets of its layers. Only from_ns
 * and to_ns are show time. Layers and clips are identified by their ids. edit_apply assigns ids in
 * order, so the same list of edits always gives the same ids. Pure data and pure functions; any
 * thread. */
#ifndef MAROTTE_TAKE_EDIT_H
#define MAROTTE_TAKE_EDIT_H
#include "show/take.h"

enum {
    EDIT_LAYERS_MAX = 16,
    EDIT_CLIPS_MAX = 4096, /* per layer */
    EDIT_OWN_MAX = 64,     /* patterns per layer */
    EDIT_WARP_MAX = 1024,  /* points per clip */
    EDIT_MARKERS_MAX = 4096,
    EDIT_BYTES_MAX = 1 << 18, /* size of an edit as JSON */
    EDIT_TEXT = 160           /* size of the description of an edit */
};
#define EDIT_TIME_MAX_NS INT64_C(1000000000000000) /* 11 days before or after timeline 0 */
#define EDIT_CLIP_MAX_NS (4 * EDIT_TIME_MAX_NS)    /* limit of times after several edits */
#define EDIT_UNSAID      INT64_MIN                 /* value of an optional time that is not set */

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
    EDIT_LAYER_REMOVE,   /* layer, as the next ones */
    EDIT_LAYER_RENAME,   /* name */
    EDIT_LAYER_ORDER,    /* place */
    EDIT_LAYER_MUTE,     /* muted */
    EDIT_LAYER_SOLO,     /* solo */
    EDIT_LAYER_ADDITIVE, /* additive */
    EDIT_LAYER_GAIN,     /* gain */
    EDIT_LAYER_OFFSET,   /* offset_ns */
    EDIT_LAYER_COLOUR,   /* colour: a take_colour */
    EDIT_LAYER_OWN,      /* own */
    EDIT_CLIP_ADD, /* layer, material, start_ns, end_ns; without times, at the time of the recording
                    */
    EDIT_CLIP_REMOVE,  /* clip, as the next ones; ripple, see below */
    EDIT_CLIP_TRIM,    /* start_ns, end_ns: one or both; ripple */
    EDIT_CLIP_SPLIT,   /* at_ns: the part after it becomes a new clip */
    EDIT_CLIP_MOVE,    /* start_ns, layer: one or both; ripple */
    EDIT_CLIP_SPEED,   /* speed (a factor), at_ns: the fixed instant; default: the start; ripple */
    EDIT_CLIP_CURVE,   /* warp */
    EDIT_CLIP_SMOOTH,  /* smooth_s */
    EDIT_CLIP_GAIN,    /* gain */
    EDIT_CLIP_FADE,    /* fade_in_ns, fade_out_ns: one or both */
    EDIT_CLIP_MUTE,    /* muted */
    EDIT_CLIP_COLOUR,  /* colour: a take_colour */
    EDIT_CLIP_PERFORM, /* performance: another one of the same tracks */
    EDIT_RANGE_KEEP,   /* in_ns, out_ns: the take becomes that range */
    EDIT_RANGE_CUT,    /* in_ns, out_ns, layers, ripple (close the gap) */
    EDIT_RANGE_INSERT, /* at_ns, length_ns, layers */
    EDIT_PUNCH,        /* layer, material, in_ns, out_ns, fade_ns: replaces a span of the layer */
    EDIT_COMP,  /* regions or own and name, material, in_ns, out_ns, fade_ns: adds a layer for each
                   region */
    EDIT_MOUTH, /* name, material, start_ns, end_ns: adds poses of a voice as the lowest layer, and
                   makes the others additive, so that a hand at rest does not hold the mouth shut.
                   With a layer it replaces the clips of that one, and the others stay */
    EDIT_AUDIO_ATTACH, /* audio, offset_ns, gain */
    EDIT_AUDIO_OFFSET, /* offset_ns */
    EDIT_AUDIO_TRIM,   /* start_ns, end_ns on the timeline: one or both */
    EDIT_AUDIO_GAIN,   /* gain */
    EDIT_AUDIO_DETACH,
    EDIT_KIND_COUNT
} edit_kind;

/* With ripple, everything that begins at or after the end of the clip (of a move: its start) moves
 * along, so that gaps keep their length: clips of all layers, markers, the sound, and the end of
 * the take. The clip itself then starts where it did, except after a move. A clip of another layer
 * that began before stays whole. Sound that began before would lose sync: the edit is refused.
 *
 * Material is a span of a performance, or of a part of it: performance, from_ns .. to_ns, part.
 * source_ns is the instant that is shown at the start. If the material does not run at its recorded
 * speed, warp replaces source_ns. */
typedef struct edit {
    edit_kind kind;
    uint32_t layer, clip;   /* ids */
    uint32_t marker, place; /* marker: index from 0, by time; place: index of a layer from the
                               bottom, UINT32_MAX: on top */
    uint32_t number, rating, colour;
    uint32_t regions; /* bit set of 1 << own_region */
    uint32_t part;    /* take_part; 0: the whole performance */
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
    char (*own)[TAKE_NAME]; /* own_count; allocated, owned by the edit */
    uint32_t warp_count;
    take_warp_point *warp; /* owned */
} edit;

/* Initialises an edit; all optional arguments are unset. */
void edit_init(edit *out, edit_kind kind);
void edit_finish(edit *e); /* accepts zeroed */

/* Returns the name in JSON, such as "clip.trim"; "" for an invalid kind. */
const char *edit_name(edit_kind kind);

/* Parses {"op":"clip.trim","clip":3,"start_ns":0}. Errors give the JSON path of the fault
 * ("$.clip"). An unknown operation or argument, such as one of a newer version, returns
 * MRT_ERR_UNSUPPORTED, and the error names it. On failure `out` is zeroed. */
CHECKED mrt_result edit_parse(edit *out, const char *text, size_t size, error *err);
/* Writes one line without a newline, which the caller frees. edit_parse reads it as an equal edit.
 */
CHECKED mrt_result edit_write(char **out, const edit *e, error *err);

/* Checks that each argument that the operation uses is within its range. */
CHECKED mrt_result edit_check_arguments(const edit *e, error *err);
/* Returns true if the points ascend strictly, the speed is within its limits, and all times are
 * within +-limit_ns. */
bool edit_is_warp(const take_warp_point *warp, uint32_t count, int64_t limit_ns);

/* ---- applying an edit to a take (edit_apply.c, edit_describe.c) ---- */

/* Applies the edit to a take that passes edit_check; the take passes it afterwards too. On failure
 * the take is unchanged. The error names the layer, clip or range and the possible values. */
CHECKED mrt_result edit_apply(take *t, const edit *e, error *err);
/* As edit_apply, but on failure the take may be half changed. For callers that discard the take
 * then. */
CHECKED mrt_result edit_apply_onto(take *t, const edit *e, error *err);

/* The recording that an edit adds to a take, so that the journal can keep it. edit_refers returns
 * false if the edit adds none. `before`: the take before the edit. */
typedef struct edit_reference {
    int64_t performance;
    int64_t from_ns, to_ns; /* show time */
} edit_reference;
bool edit_refers(edit_reference *out, const edit *e, const take *before);

/* Checks the invariants of every take. Ids are unique, and sizes are within the limits above.
 * Numbers are finite and within the ranges of their edits. Clips are sorted, and at most two clips
 * of a layer overlap at an instant. A clip ends after its start, shows only instants from 0 to
 * to_ns - from_ns, and has room for its fades. Warps ascend strictly, and run at 1/1000 to 1000
 * times the recorded speed. */
CHECKED mrt_result edit_check(const take *t, error *err);

/* Describes the edit for the user: "trim 'mouth' to 2.1 .. 8 s". `before`: the take before the
 * edit. Objects that the take does not have are named by their ids. */
void edit_describe(char out[EDIT_TEXT], const edit *e, const take *before);

#endif
