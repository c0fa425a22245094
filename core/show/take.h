/* show/take.h - the contents of a show as plain data. Leaves out how they are stored (show.h),
 * recorded (writer.h) and edited (edit.h).
 *
 * Every input is always recorded. A *track* holds the unchanged samples of one input. A
 * *performance* describes how tracks were performed: the mapping, its parameters and the rig. A
 * *take* is a span of time that the user keeps; it shows performances in *layers*. So "record" and
 * "keep the last 30 s" differ only in when the user chooses the span. Raw data is written once and
 * never changed. An edit changes only which part a take shows, and when.
 *
 * TIME  time_ns in a show is UTC in ns, counted by the session's monotonic clock. Its offset to UTC
 * is read once, when the session starts, so time never jumps within a session. Times within a take
 * are relative to its start: 0 is its first instant. Pure data and pure functions; any thread. */
#ifndef MAROTTE_TAKE_TAKE_H
#define MAROTTE_TAKE_TAKE_H
#include "base/error.h"

enum { TAKE_TRACKS_MAX = 8, TAKE_PARAMS_MAX = 128, TAKE_NAME = 64, TAKE_HASH = 65 };
enum { TAKE_IDENTITY = 160 + 64 + TAKE_HASH }; /* size of a plugin's id, version and SHA-256 */

typedef struct take_channel { /* as mrt_channel, but owns its texts */
    char name[48], unit[16];
    uint32_t semantic, hand;
    float min, max;
} take_channel;

/* ---- raw data: written while it is recorded, never changed ---- */

typedef struct take_track {
    int64_t id;
    char *input;  /* how the input was opened: "cyberglove:serial:/dev/ttyUSB0,rate=150" */
    char *device; /* description of the device: "CyberGlove 22, right, port 1-2"; or "" */
    char *plugin; /* type id, version and SHA-256 of the library, separated by spaces */
    uint32_t channel_count;
    take_channel channel[MRT_MAX_CHANNELS];
    char *calibration[2]; /* left, right: JSON (hand/calibration_file.h); NULL: none */
} take_track;

typedef enum take_event_kind {                        /* numbers are stored: never reused */
                               TAKE_EVENT_PARAM = 1,  /* a parameter changed: param, value */
                               TAKE_EVENT_REZERO = 2, /* a quick re-zero was requested: hand */
                               TAKE_EVENT_WENT = 3,   /* a device disconnected: track */
                               TAKE_EVENT_CAME = 4,   /* the device reconnected: track */
                               TAKE_EVENT_LOST =
                                   5, /* value: number of samples of the track that could not be
                                         recorded; with text "events": number of events */
                               TAKE_EVENT_MARK = 6 /* the user marked this instant: text */
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

typedef struct take_again { /* settings of a performance that performs recorded tracks again */
    int64_t of;             /* the performance that owns the tracks; 0: this performance was live */
    bool ignores_params;    /* true if the recorded parameter changes belong to another mapping */
    char *calibration[2];   /* left, right: JSON; NULL: that of the track */
    double min_cutoff_hz;   /* minimum cutoff of a One-Euro filter of all angles; 0: the default
                               filters */
    bool has_beta;
    double beta; /* Hz per deg/s */
} take_again;

typedef struct take_performance {
    int64_t id;
    char *mapping;            /* type id, version and SHA-256 of the library, separated by spaces */
    char *rig;                /* path as the user specified it */
    char rig_hash[TAKE_HASH]; /* SHA-256 of the rig file, hex */
    char mesh_hash[TAKE_HASH]; /* SHA-256 of the mesh, hex */
    char *rig_json;            /* text of the rig; NULL: a mesh without a rig */
    double unit_mm;            /* of a mesh without a rig: millimetres per unit; 0: guessed */
    double hand_length_mm;
    uint32_t rezero_pedal; /* 1..4: the pedal whose press re-zeroes; 0: none */
    uint32_t track_count, param_count;
    int64_t track[TAKE_TRACKS_MAX];    /* in the order of the inputs */
    take_param param[TAKE_PARAMS_MAX]; /* values at the start */
    char *patch; /* the active patch: JSON (stage/perform/patch_file.h); NULL: none */
    take_again again;
} take_performance;

/* The texts of a track or a performance, with a reference count. They are created on a thread that
 * may allocate, never change afterwards, and are freed when the last reference is dropped. */
typedef struct take_texts take_texts;
/* Moves the texts out of the description, which may be used while the texts are held. Returns NULL
 * if memory runs out; the description then still owns them. */
take_texts *take_track_texts(const take_track *track);
take_texts *take_performance_texts(const take_performance *performance);
take_texts *take_texts_hold(take_texts *self); /* [any] adds a reference; returns self */
void take_texts_drop(
    take_texts *self); /* drops a reference; any thread except [frame]; accepts NULL */

/* ---- contents of a take after its edits, see edit.h ---- */

/* A point of the map from timeline to source. The map is piecewise linear and both times ascend
 * strictly. Beyond its ends the slopes of the end pieces continue. at_ns is a time in the take;
 * source_ns is a time in the performance's span (0: its from_ns). */
typedef struct take_warp_point {
    int64_t at_ns, source_ns;
} take_warp_point;

/* What a clip shows of its performance. The poses that were played on the palette
 * (stage/perform/palette.h) and the life of the face (stage/perform/life.h) have samples of their
 * own, so each can be a layer of its own. Takes store these numbers. */
#define TAKE_PALETTE_ID    "org.marotte.palette" /* type ids of their inputs */
#define TAKE_LIFE_ID       "org.marotte.life"
#define TAKE_PALETTE_LAYER "palette" /* names of their layers */
#define TAKE_LIFE_LAYER    "life"
typedef enum take_part {
    TAKE_WHOLE = 0,
    TAKE_HANDS,   /* hands, patch and mapping: all that has no part of its own below */
    TAKE_PALETTE, /* the palette alone */
    TAKE_LIFE,    /* life alone */
    TAKE_PARTS
} take_part;

/* The parts that have an input and an additive layer of their own, bottom layer first. */
typedef struct take_own_part {
    take_part part;
    const char *plugin; /* type id of the input */
    const char *layer;
} take_own_part;
enum { TAKE_OWN_PARTS = TAKE_PARTS - TAKE_PALETTE };
extern const take_own_part take_own_part_of[TAKE_OWN_PARTS];

/* Colours that tell clips and layers apart on the timeline; they change nothing that is shown on
 * the face. Takes store these numbers. */
typedef enum take_colour {
    TAKE_COLOUR_NONE = 0, /* of a clip: that of its layer; of a layer: the usual one */
    TAKE_COLOUR_RED,
    TAKE_COLOUR_ORANGE,
    TAKE_COLOUR_YELLOW,
    TAKE_COLOUR_GREEN,
    TAKE_COLOUR_TEAL,
    TAKE_COLOUR_BLUE,
    TAKE_COLOUR_VIOLET,
    TAKE_COLOURS
} take_colour;

typedef struct take_clip { /* a span of the timeline that shows a span of a performance */
    uint32_t id;           /* unique in the take, stable through edits */
    int64_t performance;
    take_part part;
    int64_t from_ns, to_ns;   /* show time of the raw data behind the clip; source 0 is from_ns */
    int64_t start_ns, end_ns; /* on the timeline of the take */
    uint32_t warp_count;      /* >= 1 */
    take_warp_point *warp;
    int64_t fade_in_ns, fade_out_ns; /* the fades blend in control space */
    double gain;                     /* factor of the control vectors; default 1 */
    double smooth_s;                 /* time constant of additional smoothing; 0: none */
    bool is_muted;
    uint32_t colour; /* take_colour */
} take_clip;

typedef struct take_layer {
    uint32_t id; /* unique in the take */
    char name[TAKE_NAME];
    bool is_muted, is_solo;
    uint32_t colour;  /* take_colour */
    bool is_additive; /* false: where it shows a clip, it replaces the layers below in the parts
                         that it owns. true: it adds to them */
    double gain;
    int64_t offset_ns; /* shift of its clips on the timeline: later (> 0) or earlier */
    uint32_t
        own_count; /* number of patterns of the contacts, bones and degrees of freedom that it owns;
                      a pattern may end with '*' ("mouth.*", "jaw.open"). 0: it owns all */
    char (*own)[TAKE_NAME];
    uint32_t clip_count;
    take_clip *clip; /* sorted by start; clips that overlap are cross-faded */
} take_layer;

typedef struct take_marker {
    int64_t at_ns;
    char text[96];
} take_marker;

typedef struct take_audio {
    int64_t audio;     /* id in the show; 0: none */
    int64_t offset_ns; /* where it starts on the timeline */
    /* The part that is played, in time of the sound. out_ns 0: up to its end. The sound may end
     * before out_ns. */
    int64_t in_ns, out_ns;
    double gain;
} take_audio;

typedef struct take {
    int64_t id;
    int64_t created_ns; /* UTC */
    int64_t start_ns;   /* show time of timeline 0 */
    int64_t duration_ns;
    bool is_recording; /* its end is not written: a program is recording it, or was killed */
    bool is_deleted;
    char scene[TAKE_NAME], shot[TAKE_NAME];
    uint32_t number; /* number within scene and shot, from 1 */
    char name[TAKE_NAME];
    char note[512];
    uint32_t rating;        /* 0..5 stars */
    double fps;             /* frame rate of the take and its time code; 0: not set */
    int64_t timecode_frame; /* time code of timeline 0, in frames from 00:00:00:00 */
    bool is_drop_frame;     /* drop-frame notation of the time code, see timecode.h */
    char origin[96];        /* "recorded", "kept from the journal", "take 3 through anchored" */
    uint32_t layer_count, marker_count;
    take_layer *layer; /* bottom first */
    take_marker *marker;
    take_audio audio;
    uint32_t id_count; /* last id of a layer or clip; ids are never reused */
} take;

void take_finish(take *t); /* frees what it owns; accepts zeroed */
CHECKED mrt_result take_copy(take *out, const take *t, error *err);
void take_track_finish(take_track *t);
void take_performance_finish(take_performance *p);

/* take_warp_to_source returns the source time at at_ns, rounded down. take_warp_to_timeline returns
 * the first instant at which source_ns has been reached. So a sample at s is shown exactly from
 * take_warp_to_timeline(s) on. */
int64_t take_warp_to_source(const take_clip *clip, int64_t at_ns);
int64_t take_warp_to_timeline(const take_clip *clip, int64_t source_ns);

/* An active clip of a layer at one instant, with its weight and its source time. Where two clips
 * overlap, their weights are linear and sum to 1. Where only one clip ends, its fade leads to the
 * rest pose, or to what the layers below show there (own.h). Spans are half open: a clip is active
 * from its start until just before its end. Weights do not include the gains of clip and layer. A
 * muted clip is ignored. own.h handles muted layers. */
typedef struct take_voice {
    const take_clip *clip; /* of the layer */
    int64_t source_ns;
    double weight; /* 0..1 */
} take_voice;
uint32_t take_at(take_voice out[2], const take_layer *layer,
                 int64_t at_ns); /* returns their number, 0..2 */

#endif
