/* ui/cli/take.h - shared by the subcommands of `marotte take`: their table, their command line,
 * the show and the take, and times as a person writes them. take_edit.c edits takes, take_show.c
 * reads shows, and take_stage.c performs takes for take_export.c, take_record.c and take_diff.c.
 * [main] */
#ifndef MAROTTE_UI_TAKE_H
#define MAROTTE_UI_TAKE_H
#include "cli/command.h"
#include "cli/exports.h"
#include "cli/perform_session.h"
#include "stage/playback/sequencer.h"
#include "show/export_name.h"
#include "show/history.h"
#include "show/show.h"
#include "base/timecode.h"

/* All options of all subcommands; take.c has their names. */
typedef enum take_option {
    TAKE_JSON = 0,
    TAKE_IN,
    TAKE_OUT, /* a time; a file for `log` and `recover` */
    TAKE_AT,
    TAKE_CLIP,
    TAKE_LAYER,
    TAKE_TO,
    TAKE_SPEED,
    TAKE_POINTS,
    TAKE_OFF,
    TAKE_FADE,
    TAKE_FADE_IN,
    TAKE_FADE_OUT,
    TAKE_GAIN,
    TAKE_OFFSET,
    TAKE_LENGTH,
    TAKE_RIPPLE,
    TAKE_OWN,
    TAKE_PLACE,
    TAKE_REGION,
    TAKE_FROM,
    TAKE_SOURCE,
    TAKE_SCENE,
    TAKE_SHOT,
    TAKE_NUMBER,
    TAKE_START,
    TAKE_FPS,
    TAKE_LAST,
    TAKE_FACE,
    TAKE_MAP,
    TAKE_PATCH,
    TAKE_CALIBRATION,
    TAKE_HAND_LENGTH,
    TAKE_FILTER,
    TAKE_EXPORT,
    TAKE_WAV,
    TAKE_TOLERANCE,
    TAKE_MAX_TARGETS,
    TAKE_BARE,
    TAKE_UNIT,
    TAKE_BY_PART,
    TAKE_CSV,
    TAKE_TRACK,
    TAKE_HASH_OPTION,
    TAKE_STEPS,
    TAKE_INPUT,
    TAKE_PREROLL,
    TAKE_COUNT_IN,
    TAKE_PASSES,
    TAKE_NAME_OPTION,
    TAKE_REALTIME,
    TAKE_REZERO_PEDAL,
    TAKE_SIZE,
    TAKE_VIEW,
    TAKE_MIRROR,
    TAKE_BACKGROUND,
    TAKE_LOOK,
    TAKE_FRAMES,
    TAKE_ALL,
    TAKE_JOBS,
    TAKE_OUTPUT,
    TAKE_MOVE,
    TAKE_WORDS,
    TAKE_WORDS_FILE,
    TAKE_JAW,
    TAKE_LIPS,
    TAKE_SOUND,
    TAKE_OPTION_COUNT
} take_option;

enum { TAKE_WORDS_MAX = 4 };

enum { TAKE_CHANGE_MAX = 8 };
typedef struct take_change { /* edits of one subcommand */
    edit edit[TAKE_CHANGE_MAX];
    uint32_t count;
} take_change;

struct take_verb;
typedef struct take_call { /* one run of a subcommand */
    const struct take_verb *verb;
    char name[32];                    /* "take trim" */
    command self;                     /* for messages about wrong usage */
    const char *word[TAKE_WORDS_MAX]; /* in the order of the verb's words: SHOW, TAKE ... */
    uint32_t word_count;
    const char *text[TAKE_OPTION_COUNT]; /* NULL: not given; "" for options without a value */
    exports_file exports[EXPORTS_MAX];
    uint32_t export_count;
    const char *wav; /* --export NAME.wav; NULL: not given */
    const char *calibration[PERFORM_CALIBRATIONS_MAX];
    uint32_t calibration_count;
    const char *input[PERFORM_INPUTS_MAX];
    uint32_t input_count;
    const char *output[PERFORM_OUTPUTS_MAX];
    uint32_t output_count;
    show *show;
    facts *told;
    progress shown;
    int64_t late_ns; /* of `sync`: the offset that it found */
    bool is_usage;   /* the error is wrong usage */
    bool is_told;    /* print the facts although it failed */
} take_call;

typedef enum take_use { /* access to the show */
                        TAKE_READS = 0,
                        TAKE_WRITES,
                        TAKE_MOVES,   /* writes with --move, else reads */
                        TAKE_RECORDS, /* writes, and keeps the performance even after an error */
                        TAKE_OPENS_ITSELF
} take_use;

typedef struct take_verb {
    const char *name;  /* "trim", "layer add" */
    const char *words; /* "SHOW TAKE": required words; those in "[..]" are optional */
    const char *options_text, *summary;
    const char *options; /* option names, separated by blanks; --json is always accepted */
    take_use use;
    CHECKED mrt_result (*run)(take_call *call, error *err);
    /* Returns the edits for the take on the command line, for take_change_run; used if run is NULL.
     */
    CHECKED mrt_result (*ask)(take_call *call, const take *t, take_change *out, error *err);
    edit_kind kind;       /* for an `ask` that several subcommands share */
    const char *examples; /* for command_print_examples */
} take_verb;

typedef struct take_verbs {
    const char *title;
    const take_verb *verb;
    uint32_t count;
} take_verbs;
extern const take_verbs take_edit_verbs, take_layer_verbs, take_file_verbs, take_audio_verbs;

/* ---- the command line ---- */

const char *take_option_name(take_option option); /* "in" */

/* ---- values of options as numbers ---- */

/* Sets the error and marks it as wrong usage: exit code 2. */
__attribute__((format(printf, 3, 4))) mrt_result take_misused(take_call *call, error *err,
                                                              const char *format, ...);
CHECKED mrt_result take_need(take_call *call, take_option option, error *err);
/* Leaves *out unchanged if the option is not given. */
CHECKED mrt_result take_number(take_call *call, take_option option, double least, double most,
                               double *out, error *err);
CHECKED mrt_result take_number_of(take_call *call, const char *what, const char *text, double least,
                                  double most, double *out, error *err);
/* Reads seconds ("2.1") or, with a ':', time code at --fps or the take's rate. */
CHECKED mrt_result take_time(take_call *call, take_option option, const take *t, int64_t *out,
                             error *err);
/* Returns the rate of --fps, else of the take, else 30. */
CHECKED mrt_result take_rate(take_call *call, const take *t, timecode_rate *out, error *err);
/* Returns the time code of a frame, counted from the start of the take. At another rate than the
 * take's, the start keeps its hours, minutes and seconds. */
int64_t take_label_frame(const take *t, timecode_rate rate, int64_t frame);

/* ---- the show and what is in it ---- */

/* Accepts "3", "last", "scene/shot/2". */
CHECKED mrt_result take_find(take_call *call, const char *text, int64_t *out_id, error *err);
/* Reads the take with its edits. If an edit cannot be applied, prints a warning, and returns the
 * take with the edits before it. */
CHECKED mrt_result take_read(take_call *call, const char *text, take *out, error *err);
/* Finds the clip of --clip, else the only one. Only clips at at_ns count, unless it is
 * EDIT_UNSAID. */
CHECKED mrt_result take_find_clip(take_call *call, const take *t, int64_t at_ns, uint32_t *out,
                                  error *err);
/* Finds the layer of --layer, by number or name, else the only one. */
CHECKED mrt_result take_find_layer(take_call *call, const take *t, uint32_t *out, error *err);

/* ---- take_edit.c ---- */

/* Gets the edits of the subcommand and applies them to the take. */
CHECKED mrt_result take_change_run(take_call *call, error *err);
/* Reads patterns or names of regions, separated by commas, into `own` of the edit. */
CHECKED mrt_result take_read_own(take_call *call, const char *text, edit *out, error *err);
/* Reads names of regions, separated by commas, as bits by own_region. */
CHECKED mrt_result take_read_regions(take_call *call, const char *text, uint32_t *out, error *err);

/* ---- take_stage.c: performs a take without a window: its face, its sequencer, and its frames
 * ---- */

typedef struct take_stage {
    log_queue *log;
    plugin_list plugins;
    face_file face;
    char *face_path; /* owned */
    sequencer *sequencer;
    take take; /* with its edits; owned */
} take_stage;

/* Opens the take that `text` names, on the face `other` or (NULL) on its own face. That face must
 * exist; a note reports if it has changed. Finish it, whatever the result. */
CHECKED mrt_result take_stage_open(take_stage *out, take_call *call, const char *text,
                                   const char *other, error *err);
void take_stage_finish(take_stage *self); /* accepts a zeroed struct */
/* Reports what changed since the recording, and the messages of plugins. */
void take_stage_report(take_stage *self);

/* Reads the face of the first audible clip of a take. */
CHECKED mrt_result take_face_read(face_file *out, char **out_path, take_call *call, const take *t,
                                  const char *other, error *err);

typedef struct take_frames { /* frame `first` + i begins at timecode_time_ns(rate, first + i) */
    timecode_rate rate;
    int64_t first, count;
} take_frames;
/* Computes the frames that begin between --in and --out, at --fps; without them, all frames of the
 * take. */
CHECKED mrt_result take_frames_of(take_frames *out, take_call *call, const take *t, error *err);

/* Moves the face to each frame, draws it, and publishes it through frame.publish with `data`. */
CHECKED mrt_result take_stage_play(take_stage *self, take_call *call, const take_frames *frames,
                                   mrt_result (*publish)(void *data, const stage_frame *f,
                                                         error *err),
                                   void *data, error *err);

/* ---- subcommands in the table of take.c ---- */

CHECKED mrt_result take_diff_run(take_call *call, error *err);
CHECKED mrt_result take_sync_run(take_call *call, error *err);
CHECKED mrt_result take_sync_edits(take_call *call, const take *t, take_change *out, error *err);
CHECKED mrt_result take_export_run(take_call *call, error *err);
CHECKED mrt_result take_export_all(take_call *call, error *err);
CHECKED mrt_result take_play_run(take_call *call, error *err);
CHECKED mrt_result take_record_run(take_call *call, error *err);
CHECKED mrt_result take_log_run(take_call *call, error *err);
CHECKED mrt_result take_remap_run(take_call *call, error *err);
CHECKED mrt_result take_mouth_run(take_call *call, error *err);

/* Reports the difference between two takes, by region, and its worst moment. */
CHECKED mrt_result take_diff_report(take_call *call, const char *a, const char *b, error *err);

#endif
