/* stage/live/live.h - the live stage. One thread performs the samples of the inputs, records all of
 * them, and publishes the newest face. A take can be played, scrubbed or overdubbed at the same
 * time. The window calls these functions and reads the newest view. It can never block the frame
 * thread. Leaves out edits of takes (show/edit_store.h) and all drawing. All functions are [main],
 * called by one thread. A change takes effect within one displayed frame. A change does not make
 * the face jump, lose a sample or end the current recording, except where a comment states this. */
#ifndef MAROTTE_STAGE_LIVE_H
#define MAROTTE_STAGE_LIVE_H
#include "stage/input/input.h"
#include "stage/live/live_view.h"
#include "stage/mapping/isolate.h"
#include "stage/output/outputs.h"
#include "stage/perform/face_file.h"
#include "stage/perform/performer.h"
#include "stage/perform/pointer.h"
#include "stage/sound/sound.h"
#include "stage/record/overdub.h"

typedef struct live live;

typedef struct live_settings { /* everything they point to must outlive the stage */
    const plugin_list *plugins;
    log_queue *log;
    show *show; /* writable, owned by [main]; NULL or read-only: recording is off, and
                   live_status.why_not has the reason */
    const face_file *face;
    const char *face_path;
    double unit_mm;               /* for a mesh without a rig; 0: guessed */
    const csrbf_settings *solver; /* see live_set_solver */
    const char *mapping;          /* such as "one_hand,smile=8"; NULL or "": only the pointer */
    const sound_backend *sound;   /* NULL: PortAudio */
    bool keeps_clay;              /* see live_keep_clay */
    double fps;                   /* frame rate while no samples arrive; default 60 */
    double journal_s;             /* 0: 30 min */
    wake *changed;                /* signalled after each new view; NULL: not used */
} live_settings;

CHECKED mrt_result live_start(live **out, const live_settings *settings, error *err);
/* Checks that the mapping exists and accepts the parameters. If this succeeds and live_start fails,
 * the reason is the face. */
CHECKED mrt_result live_check_mapping(const live_settings *settings, const char *text, error *err);
/* Ends the current recording at its last sample and frees the stage. Returns < 0 if something could
 * not be written; the stage is freed then too. */
CHECKED mrt_result live_stop(live *self, error *err);
/* Call with every displayed frame of the window. Updates sound, reload and status, and frees unused
 * objects. */
void live_update(live *self);
/* Returns whether an event without a new face is pending. If so, call live_update again soon. */
bool live_is_busy(const live *self);

/* ---- newest view ---- */

/* Sets *out to the newest view, valid until the next call. Returns whether it is newer than the
 * last one. */
bool live_read_view(live *self, const live_view **out);

/* ---- status and statistics ---- */

enum { LIVE_PHASES = 4, LIVE_HISTORY = 240 };
/* Lines of the panel Engine. Each is the sum of some phases of frame.h. */
typedef enum live_phase {
    LIVE_PHASE_MAP = 0,   /* FRAME_SCHEDULE to FRAME_GUARD */
    LIVE_PHASE_CONSTRAIN, /* FRAME_COMPOSE and FRAME_SOLVE */
    LIVE_PHASE_DEFORM,
    LIVE_PHASE_PUBLISH
} live_phase;
typedef struct live_status {
    bool can_record;
    char why_not[256]; /* reason why recording is off, one line; "": none */
    char problem[256]; /* error of the disk or the writer, one line; "": none */
    writer_status writer;
    bool is_recording;   /* a take or an overdub */
    int64_t take;        /* current or last recorded take; 0: none */
    int64_t recorded_ns; /* length so far */
    recorder_code code;  /* external time code while recording is on */
    int64_t journal_ns;  /* time before now that live_keep can save */
    size_t kept_bytes;   /* size of the checkpoints of the shown take, at most 64 MiB */
    uint64_t sample_count;
    composer_counts counts;
    rezero_counts rezeros;
    uint64_t patch_speaks; /* one bit per connection: set after it has taken effect */
    uint32_t patch_pressed[PATCH_ACTIONS]; /* number of presses on this face */
    double frame_p50_ms, frame_p99_ms; /* all phases of the last LIVE_HISTORY published frames */
    double phase_p50_ms[LIVE_PHASES], phase_p99_ms[LIVE_PHASES];
    float frame_ms[LIVE_HISTORY]; /* oldest first */
    uint32_t frame_count;         /* number of elements of frame_ms */
    double lag_p99_ms; /* time from measurement to performance of a sample, over the last LIVE_LAGS
                          steps */
    isolate_counts isolated;
    uint32_t reload_taken, reload_refused;
    bool is_sound_armed;
    sound_play_status playing;
    sound_in_status listening;
} live_status;
void live_status_of(live *self, live_status *out);

/* ---- inputs: at most 7, and the pointer, which is always present ---- */

/* Adds an input and takes ownership of it, also after an error. `text` (plugin, address and
 * parameters) names it in the show. The other inputs continue. Refused while a take is recorded. */
CHECKED mrt_result live_add_input(live *self, input *made, const char *text, error *err);
CHECKED mrt_result live_remove_input(live *self, uint32_t index, error *err);
uint32_t live_input_count(const live *self);
/* Whether an input is of the stage itself: the palette or life. The others were opened by a person.
 */
bool live_input_is_own(const live *self, uint32_t index);
input *live_input(live *self, uint32_t index); /* for its name, health, channels and input_set */
const char *live_input_text(const live *self, uint32_t index);
/* Copies the newest sample of an input, for live bars. False: none yet. */
bool live_input_sample(live *self, uint32_t index, mrt_sample *out);
/* Returns the channels that rose from 0 since the last call, one bit each: a pad that was hit and
 * released between two calls, too. For one reader. */
uint64_t live_input_presses(live *self, uint32_t index);
/* Buffers every sample of one input for a slower reader such as a calibration, for some seconds at
 * most. live_pop_tapped returns the oldest buffered sample; false: none now. Another index
 * discards the buffer. An index without an input stops it. See tap.h. */
void live_tap(live *self, uint32_t index);
bool live_pop_tapped(live *self, mrt_sample *out);
/* Takes effect with the next sample. path NULL: default calibration. */
CHECKED mrt_result live_calibrate(live *self, uint32_t side, const char *path, error *err);
const char *live_calibration(const live *self, uint32_t side); /* path; NULL: default */
/* Re-zeroes each hand that is still; the result is in status.rezeros. */
void live_rezero(live *self);
/* Sets the pedal that re-zeroes, 1..4. 0: none. */
void live_set_rezero_pedal(live *self, uint32_t pedal);

/* ---- outputs: receive the face that is shown, from live hands and from takes ---- */

outputs *live_outputs(live *self); /* to add, remove and inspect them; valid until live_stop */

/* ---- pointer: rest and at in mm, see pointer.h ---- */

void live_point(live *self, pointer_grip grip, const float rest[3], const float at[3], bool stays,
                double radius_mm);
/* Saves the changes that the pointer made to the live face, for undo. The caller frees *out. */
CHECKED mrt_result live_save_pulled(live *self, void **out, size_t *out_size, error *err);
/* Restores such changes, independent of hands and mapping. Begins a new performance. Refused while
 * a take is recorded. */
CHECKED mrt_result live_load_pulled(live *self, const void *bytes, size_t size, error *err);

/* Lists the poses of the face: those of its rig, and those with the names of ARKit and of visemes
 * that its own shapes make. They are the channels of a palette (palette.h), the targets of a patch
 * and what a mapping can choose. Valid until another face. */
const mrt_rig_pose *live_poses(const live *self, uint32_t *out_count);

/* ---- the palette: poses that are played above the mapping, see palette.h ---- */

/* Adds the inputs of the palette, one for each PALETTE_INPUT_POSES poses, which stay and follow the
 * face from then on. Does nothing while they are there. Refused while a take is recorded, and where
 * too many inputs are open. */
CHECKED mrt_result live_palette_open(live *self, error *err);
/* Number of poses that can be played; pose i is live_poses()[i]. 0: the palette is not open, or the
 * face has no poses. */
uint32_t live_palette_count(const live *self);
/* live_palette_set sets the wanted strength of a pose, 0..1. live_palette_send sends what was set
 * since; these strengths fade there within fade_s. */
void live_palette_set(live *self, uint32_t pose, double strength);
void live_palette_send(live *self, double fade_s);

/* ---- life: what the face does by itself, see life.h ---- */

/* Follows soon, but a first input not before the end of a take that is recorded. The face lives
 * while hands perform it; over a take it does where the take has no life of its own. */
void live_set_life(live *self, const life_settings *to);
/* Why the face does not live though it should; "": it does. */
const char *live_life_trouble(const live *self);
/* Why this face cannot; NULL: it can. Valid as long as the process. */
const char *live_life_missing(const live *self, life_kind kind);

/* ---- the mapping ---- */

/* Crossfades to another mapping. "": none. The shape that hands kneaded eases to rest, unless the
 * clay is kept. Refused while a take is recorded. */
CHECKED mrt_result live_set_mapping(live *self, const char *text, error *err);
/* Whether the kneaded shape stays when the mapping changes and when the last hand is removed. */
void live_keep_clay(live *self, bool keeps);
bool live_keeps_clay(const live *self);
/* Writes the taught values of the mapping (MRT_STATE), at most TAUGHT_BYTES_MAX, and returns their
 * size. 0: it cannot be taught. */
size_t live_taught(live *self, void *bytes, size_t capacity);
/* Replaces the taught values and crossfades. Begins a new performance. Refused while a take is
 * recorded, and by a mapping that cannot read the bytes; nothing changes then. */
CHECKED mrt_result live_teach(live *self, const void *bytes, size_t size, error *err);
/* Lists the mappings that accept the current face, such as "anchored, magnet". Creates each of them
 * once. */
void live_list_fitting(live *self, char *out, size_t capacity);
/* Returns the mapping for reading (params) and setting (instance_set_text) parameters. Valid until
 * the mapping changes. NULL: no mapping. */
instance *live_mapping(live *self);
/* Eases the face to neutral over 250 ms: resets the mapping, releases the pointer, and makes
 * neutral the base shape. */
void live_neutral(live *self);

/* ---- the patch; works with every mapping ---- */

/* Sets the patch with the next sample, without a jump. count 0: none. Begins a new performance.
 * MRT_HOLD: the previous change is still running and nothing has changed; try again later. Refused
 * while a take is recorded. */
CHECKED mrt_result live_set_patch(live *self, const patch *p, error *err);
/* Lists what the patch uses but the face and the mapping do not have, one per line. "": nothing. */
const char *live_patch_note(const live *self);

/* ---- another face; inputs stay open. Refused while a take is recorded ---- */

CHECKED mrt_result live_set_face(live *self, const face_file *face, const char *path,
                                 double unit_mm, error *err);
/* Sets the solver. radius 0: the rig's radius on every face. NULL: the rig's solver. Takes do not
 * store it: on another stage they use the solver of the show or the rig. */
CHECKED mrt_result live_set_solver(live *self, const csrbf_settings *solver, error *err);

/* ---- recording ---- */

/* Sets the start of the next take in host time, for the beats of the count-in. The next
 * live_record() begins the take exactly there. 0: cancels it. */
void live_count_in(live *self, int64_t begin_ns);
/* slate NULL: empty. */
CHECKED mrt_result live_record(live *self, const writer_slate *slate, error *err);
CHECKED mrt_result live_record_end(live *self, error *err); /* also ends an overdub */
/* Makes a take of a past span in host time. The take is in the show after the writer has processed
 * it. */
CHECKED mrt_result live_keep(live *self, int64_t from_ns, int64_t to_ns, const writer_slate *slate,
                             int64_t *out_take, error *err);
CHECKED mrt_result live_mark(live *self, const char *text, error *err);
/* A click on the beats of a take's timeline, from its start. Only the performer hears it: it is not
 * part of takes and exports. */
typedef enum live_click_when {
    LIVE_CLICK_OFF = 0,
    LIVE_CLICK_COUNT_IN,  /* before a recording */
    LIVE_CLICK_RECORDING, /* and during a recording */
    LIVE_CLICK_ALWAYS     /* and during playback of a take */
} live_click_when;
enum { LIVE_CLICK_BPM_MIN = 20, LIVE_CLICK_BPM_MAX = 400, LIVE_CLICK_BAR_MAX = 16 };
typedef struct live_click {
    live_click_when when;
    double bpm;   /* LIVE_CLICK_BPM_MIN..LIVE_CLICK_BPM_MAX */
    uint32_t bar; /* beats, 1..LIVE_CLICK_BAR_MAX; the first one has a higher pitch */
} live_click;
CHECKED mrt_result live_set_click(live *self, const live_click *click, error *err);
CHECKED mrt_result live_arm_sound(live *self, uint32_t channel_count, error *err);
void live_disarm_sound(live *self);
/* Returns the take that the stage itself has edited since the last call, by attaching its sound.
 * Read it again from the show. 0: none. */
int64_t live_take_edited(live *self);
/* Changes the show. Ends the current recording and crossfades the mapping to the taught values of
 * the new show. NULL: no show; the taught values stay. */
CHECKED mrt_result live_set_show(live *self, show *s, error *err);

/* ---- a take on the stage ---- */

/* Shows a take, at its last position if it was shown before. Call it again after each edit. The
 * take must belong to the current face or a similar one. Otherwise it returns an error that names
 * the face. */
CHECKED mrt_result live_show_take(live *self, const take *t, error *err);
/* Shows another version of the shown take, such as one with an edit that is still being dragged, at
 * the same instant and in motion as before. The next live_show_take ends it. MRT_HOLD: the stage is
 * still on its way to the last one and nothing has changed; try again later. */
CHECKED mrt_result live_preview_take(live *self, const take *t, error *err);
void live_show_hands(live *self);             /* returns to LIVE_PERFORMS */
int64_t live_shown_take(const live *self);    /* 0: none */
const char *live_take_note(const live *self); /* what changed since the recording; "": nothing */

/* Position from the transport of [main], without waiting for the frame thread. */
transport_position live_position(const live *self);
const transport *live_transport(const live *self);
void live_play(live *self);
void live_pause(live *self);
void live_seek(live *self, int64_t at_ns);
void live_set_speed(live *self, double speed);
void live_set_loop(live *self, int64_t in_ns, int64_t out_ns); /* in >= out: no loop */
void live_step_frames(live *self, int64_t frames);

/* Starts an overdub of the shown take. Copies the patterns of the plan. passes 0: until
 * live_record_end. The transport sets the speed, not the plan. */
CHECKED mrt_result live_overdub_start(live *self, const overdub_plan *plan, error *err);
/* Call once after an overdub has ended. Returns the edits for [main] to apply to the take as one
 * undo step. False: no edits. */
bool live_overdub_edits(live *self, edit **out_edits, uint32_t *out_count, error *err);

#endif
