/* show/take.h - what a show is made of, as plain data. Leaves out where it is stored (show.h), how
 * it gets there while it happens (writer.h) and how it is changed afterwards (edit.h).
 *
 * Everything that is measured is always recorded: a *track* is what one input gave, as it came. A
 * *performance* is how tracks were performed: through which mapping, with which parameters, on
 * which rig. A *take* is a span of time that somebody wanted to keep; it shows performances in
 * *layers*. So "record" and "keep the last 30 s" differ only in when they are said, and raw data is
 * written once and never changed: an edit changes only what a take shows of it, and when.
 *
 * TIME  time_ns in a show is UTC in ns as the session's monotonic clock tells it: its offset to UTC
 *       is read once, when the session starts, so time never jumps within a session. Times within a
 *       take count from its start: 0 is its first instant.
 * Pure data and pure functions; any thread. */
#ifndef MAROTTE_TAKE_TAKE_H
#define MAROTTE_TAKE_TAKE_H
#include "base/error.h"

enum { TAKE_TRACKS_MAX = 8, TAKE_PARAMS_MAX = 128, TAKE_NAME = 64, TAKE_HASH = 65 };
enum { TAKE_IDENTITY = 160 + 64 + TAKE_HASH }; /* of a plugin: id, version and SHA-256 */

typedef struct take_channel { /* as mrt_channel, owning its texts */
    char name[48], unit[16];
    uint32_t semantic, hand;
    float min, max;
} take_channel;

/* ---- raw: written while it happens, never changed ---- */

typedef struct take_track {
    int64_t id;
    char *input;  /* how it was opened: "cyberglove:serial:/dev/ttyUSB0,rate=150" */
    char *device; /* what it was: "CyberGlove 22, right, port 1-2"; or "" */
    char *plugin; /* type id, version and SHA-256 of the library, blanks between */
    uint32_t channel_count;
    take_channel channel[MRT_MAX_CHANNELS];
    char *calibration[2]; /* left, right: JSON (hand/calibration_file.h); NULL: none */
} take_track;

typedef enum take_event_kind {                        /* numbers are stored: never reused */
                               TAKE_EVENT_PARAM = 1,  /* a parameter got a value: param, value */
                               TAKE_EVENT_REZERO = 2, /* hand: a quick re-zero was asked for */
                               TAKE_EVENT_WENT = 3,   /* track: its device went away */
                               TAKE_EVENT_CAME = 4,   /* track: it came back */
                               TAKE_EVENT_LOST = 5, /* value: so many samples of the track could not
                                                       be recorded; text "events": so many events */
                               TAKE_EVENT_MARK = 6  /* text: somebody marked this instant */
} take_event_kind;
typedef struct take_event {
    int64_t time_ns;
    uint32_t kind; /* TAKE_EVENT_* */
    uint32_t param, hand;
    int64_t track;
    double value;
    char text[96];
} take_event;

typedef struct take_param {
    uint32_t id; /* mrt_param.id */
    double value;
} take_param;

typedef struct take_again { /* how tracks are performed anew, in place of what was said live */
    int64_t of;             /* the performance whose tracks they are; 0: this one was live */
    bool ignores_params;    /* the parameter changes of then were another mapping's */
    char *calibration[2];   /* left, right: JSON; NULL: as the tracks say */
    double min_cutoff_hz;   /* of a One-Euro filter of all angles; 0: the usual filters */
    bool has_beta;
    double beta; /* Hz per deg/s */
} take_again;

typedef struct take_performance {
    int64_t id;
    char *mapping;             /* type id, version and SHA-256 of the library, blanks between */
    char *rig;                 /* path as given */
    char rig_hash[TAKE_HASH];  /* SHA-256 of the rig file, hex */
    char mesh_hash[TAKE_HASH]; /* of the mesh */
    char *rig_json;            /* the rig's text; NULL: a mesh alone */
    double unit_mm;            /* of a mesh alone: mm a unit; 0: guessed */
    double hand_length_mm;
    uint32_t rezero_pedal; /* 1..4: the pedal whose press re-zeroes; 0: none */
    uint32_t track_count, param_count;
    int64_t track[TAKE_TRACKS_MAX];    /* in the order of the inputs */
    take_param param[TAKE_PARAMS_MAX]; /* as it started */
    char *patch; /* which channels moved what: JSON (stage/perform/patch_file.h); NULL: none did */
    take_again again;
} take_performance;

/* The texts of a track or a performance, shared by all who hold them: made where memory may be had,
 * unchanged from then on, freed by the last who drops them. */
typedef struct take_texts take_texts;
/* What was the description's; it may be used as long as they are held. NULL: no memory, and the
 * description has them still. */
take_texts *take_track_texts(const take_track *track);
take_texts *take_performance_texts(const take_performance *performance);
take_texts *take_texts_hold(take_texts *self); /* [any] gives it back */
void take_texts_drop(take_texts *self);        /* any but [frame]; NULL is fine */

/* ---- what a take shows: the result of its edits, see edit.h ---- */

/* Timeline to source, piecewise linear, both strictly ascending; beyond its ends at the end slopes.
 * Times within the take and within the performance's own span (0: its from_ns). */
typedef struct take_warp_point {
    int64_t at_ns, source_ns;
} take_warp_point;

typedef struct take_clip { /* a span of the timeline that shows a span of a performance */
    uint32_t id;           /* unique in the take, stable through edits */
    int64_t performance;
    int64_t from_ns, to_ns; /* show time: the span of the raw data behind it; source 0 is from_ns */
    int64_t start_ns, end_ns; /* on the timeline of the take */
    uint32_t warp_count;      /* >= 1 */
    take_warp_point *warp;
    int64_t fade_in_ns, fade_out_ns; /* in control space */
    double gain;                     /* of the control vectors; 1 */
    double smooth_s;                 /* time constant of additional smoothing; 0: none */
    bool is_muted;
} take_clip;

typedef struct take_layer {
    uint32_t id; /* unique in the take */
    char name[TAKE_NAME];
    bool is_muted, is_solo;
    bool is_additive; /* false: where it shows a clip it takes what it owns from the layers below;
                         true: it adds to them */
    double gain;
    int64_t offset_ns;  /* its clips are shown so much later (> 0) or earlier */
    uint32_t own_count; /* contacts, bones and degrees of freedom that it owns, with '*' at the end
                           ("mouth.*", "jaw.open"); 0: all. */
    char (*own)[TAKE_NAME];
    uint32_t clip_count;
    take_clip *clip; /* by start; they may overlap: then they cross-fade */
} take_layer;

typedef struct take_marker {
    int64_t at_ns;
    char text[96];
} take_marker;

typedef struct take_audio {
    int64_t audio;     /* id in the show; 0: none */
    int64_t offset_ns; /* where it starts on the timeline */
    /* Of its own time, what of it is heard; out_ns 0: to its end, which may come before out_ns. */
    int64_t in_ns, out_ns;
    double gain;
} take_audio;

typedef struct take {
    int64_t id;
    int64_t created_ns; /* UTC */
    int64_t start_ns;   /* show time of timeline 0 */
    int64_t duration_ns;
    bool is_recording; /* its end was never written: the program is recording it, or was killed */
    bool is_deleted;
    char scene[TAKE_NAME], shot[TAKE_NAME];
    uint32_t number; /* of scene and shot, from 1 */
    char name[TAKE_NAME];
    char note[512];
    uint32_t rating;        /* 0..5 stars */
    double fps;             /* of its frames and time code; 0: not said */
    int64_t timecode_frame; /* of timeline 0, counted from 00:00:00:00 */
    bool is_drop_frame;     /* how its time code is written: see timecode.h */
    char origin[96];        /* "recorded", "kept from the journal", "take 3 through anchored" */
    uint32_t layer_count, marker_count;
    take_layer *layer; /* bottom first */
    take_marker *marker;
    take_audio audio;
    uint32_t id_count; /* the last id given to a layer or clip: ids are not used again */
} take;

void take_finish(take *t); /* frees what it owns; accepts zeroed */
CHECKED mrt_result take_copy(take *out, const take *t, error *err);
void take_track_finish(take_track *t);
void take_performance_finish(take_performance *p);

/* The source time shown at at_ns, rounded down; and the first instant at which that source time has
 * been reached: so a sample at s is shown from take_warp_to_timeline(s) on, exactly. */
int64_t take_warp_to_source(const take_clip *clip, int64_t at_ns);
int64_t take_warp_to_timeline(const take_clip *clip, int64_t source_ns);

/* Which clips of a layer speak at an instant, how loudly, and from which instant of their source.
 * Where two clips overlap, their weights are linear and sum to 1; where a clip ends alone, it fades
 * by its fades, to the rest pose or to what earlier layers show there (own.h). Spans are half open:
 * a clip speaks from its start until before its end. Weights are without the gains of clip and
 * layer. A muted clip counts as absent; whether the layer is muted is own.h's. */
typedef struct take_voice {
    const take_clip *clip; /* of the layer */
    int64_t source_ns;
    double weight; /* 0..1 */
} take_voice;
uint32_t take_at(take_voice out[2], const take_layer *layer, int64_t at_ns); /* 0, 1 or 2 */

#endif
