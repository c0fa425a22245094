/* stage/live/live.h - the stage while somebody is on it: a thread of its own performs what the
 * inputs give, sample by sample, always recorded, and publishes the newest face; beside it a take
 * can be played, scrubbed, performed over. The window asks and looks; nothing that it does or fails
 * to do makes the frame thread wait. Leaves out edits of takes (show/edit_store.h) and everything
 * drawn.
 *
 * One thread [main] calls all of this. What it asks takes effect within a drawn frame of the frame
 * thread; nothing that is asked makes the face jump, loses a sample, or ends a take that is being
 * recorded, unless it says so. */
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

typedef struct live_settings { /* all must outlive it */
    const plugin_list *plugins;
    log_queue *log;
    show *show; /* writable, [main]'s; NULL, or one that can only be read: nothing is recorded, and
                   live_look says why */
    const face_file *face;
    const char *face_path;
    double unit_mm;               /* of a mesh alone; 0: guessed */
    const csrbf_settings *solver; /* as live_set_solver */
    const char *mapping;          /* "one_hand,smile=8"; NULL or "": none, only the pointer */
    const sound_backend *sound;   /* NULL: PortAudio */
    double fps;                   /* of frames while nothing is measured; 60 */
    double journal_s;             /* 0: 30 min */
    wake *changed; /* signalled when there is something new to show; NULL: not needed */
} live_settings;

CHECKED mrt_result live_start(live **out, const live_settings *settings, error *err);
/* Whether a mapping of that text is there and takes those parameters: what live_start refuses then,
 * it refuses for the face. */
CHECKED mrt_result live_check_mapping(const live_settings *settings, const char *text, error *err);
/* A take that is being recorded ends at its last sample and is kept. < 0: what could not be
 * written. Freed all the same. */
CHECKED mrt_result live_stop(live *self, error *err);
/* Call it with every drawn frame of the window: sound, reload, news; frees what ended. */
void live_update(live *self);
/* It waits for something that comes without a face: call live_update soon. */
bool live_is_busy(const live *self);

/* ---- what is seen ---- */

/* The newest; *out stays valid until the next call. True: it is newer than the last. */
bool live_look(live *self, const live_view **out);

/* ---- how it does ---- */

enum { LIVE_PHASES = 4, LIVE_HISTORY = 240 };
typedef enum live_phase { /* phases of frame.h that the panel shows as one line */
                          LIVE_PHASE_MAP = 0,   /* 1 to 6 */
                          LIVE_PHASE_CONSTRAIN, /* 7 and 8 */
                          LIVE_PHASE_DEFORM,    /* 9 */
                          LIVE_PHASE_PUBLISH    /* 10 */
} live_phase;
typedef struct live_status {
    bool can_record;
    char why_not[256]; /* one line; "" */
    char problem[256]; /* the disk, the writer: one calm line; "" */
    writer_status writer;
    bool is_recording;   /* a take (live or over one) */
    int64_t take;        /* that is being, or was last, recorded; 0: none */
    int64_t recorded_ns; /* how long it is by now */
    recorder_code code;  /* time code from outside, while everything is recorded */
    int64_t journal_ns;  /* how far back live_keep reaches now */
    size_t kept_bytes;   /* of the take on the stage, to scrub from: at most 64 MiB */
    uint64_t sample_count;
    performer_counts counts;
    rezero_counts rezeros;
    uint64_t patch_speaks;                 /* bits: connections that were heard and picked up */
    uint32_t patch_pressed[PATCH_ACTIONS]; /* so often, on this face */
    double frame_p50_ms, frame_p99_ms;     /* phases 3 to 8, of the last LIVE_HISTORY published */
    double phase_p50_ms[LIVE_PHASES], phase_p99_ms[LIVE_PHASES];
    float frame_ms[LIVE_HISTORY]; /* the oldest first */
    uint32_t frame_count;         /* of frame_ms */
    double lag_p99_ms;            /* sample measured to performed, over the last seconds */
    isolate_counts isolated;
    uint32_t reload_taken, reload_refused;
    bool is_sound_armed;
    sound_play_status playing;
    sound_in_status listening;
} live_status;
void live_status_of(live *self, live_status *out);

/* ---- inputs: at most 7, and the pointer, which is always there ---- */

/* It becomes live's, also when it is refused; `text` names it in the show, as it was opened. The
 * others go on. Refused while a take is recorded. */
CHECKED mrt_result live_add_input(live *self, input *made, const char *text, error *err);
CHECKED mrt_result live_remove_input(live *self, uint32_t index, error *err);
uint32_t live_input_count(const live *self);
input *live_input(live *self, uint32_t index); /* for its name, health, channels, input_set */
const char *live_input_text(const live *self, uint32_t index);
/* The newest sample of it, for live bars; false: none yet. */
bool live_input_sample(live *self, uint32_t index, mrt_sample *out);
/* For whoever must see every sample of one input (a calibration): from now on what it gives is kept
 * until it is taken, some seconds of it; live_take_tapped gives the oldest, false: none now.
 * Another index begins anew; one that is no input ends it. (tap.h) */
void live_tap(live *self, uint32_t index);
bool live_take_tapped(live *self, mrt_sample *out);
/* From the next sample on; path NULL: shipped defaults. */
CHECKED mrt_result live_calibrate(live *self, uint32_t side, const char *path, error *err);
const char *live_calibration(const live *self, uint32_t side); /* the path; NULL */
void live_rezero(live *self); /* both hands, those that are still; status.rezeros says */
/* A pedal whose press re-zeroes, 1..4; 0: none. */
void live_set_rezero_pedal(live *self, uint32_t pedal);

/* ---- outputs: what is seen on the stage is sent, live hands and takes alike ---- */

outputs *live_outputs(live *self); /* to add, remove and look at; until live_stop */

/* ---- the pointer: rest and at in mm, as pointer.h ---- */

void live_point(live *self, pointer_grip grip, const float rest[3], const float at[3], bool stays,
                double radius_mm);
/* What the pointer has made of the live face, as bytes, to be freed: for undo. */
CHECKED mrt_result live_save_pulled(live *self, void **out, size_t *out_size, error *err);
/* The face is that again, whatever hands and mapping do; what is recorded is another performance
 * from there on. Refused while a take is recorded. */
CHECKED mrt_result live_load_pulled(live *self, const void *bytes, size_t size, error *err);

/* ---- the mapping ---- */

/* The face goes over to it without a jump. "" none. Refused while a take is recorded. */
CHECKED mrt_result live_set_mapping(live *self, const char *text, error *err);
/* What the one that performs was taught (MRT_STATE), as bytes: TAUGHT_BYTES_MAX at most. 0: it
 * cannot be taught. */
size_t live_taught(live *self, void *bytes, size_t capacity);
/* It is taught that instead, and the face goes over without a jump; what is recorded is another
 * performance from there on. Refused while a take is recorded, and by a mapping that does not know
 * such bytes: it is as before then. */
CHECKED mrt_result live_teach(live *self, const void *bytes, size_t size, error *err);
/* The names of those that take the face on the stage, "anchored, magnet"; makes each of them once.
 */
void live_list_fitting(live *self, char *out, size_t capacity);
/* Until the mapping changes: parameters are read (params) and set (instance_set_text). NULL: none
 * performs. */
instance *live_mapping(live *self);
/* Everything eases back to rest: the mapping is reset, the pointer lets go, the base is the rest
 * shape again, over 250 ms. */
void live_neutral(live *self);

/* ---- the patch, over whatever mapping performs ---- */

/* From the next sample on, without a jump; count 0: none. What is recorded is another performance
 * from there on. MRT_HOLD: the change before still comes: later, nothing has changed. Refused while
 * a take is recorded. */
CHECKED mrt_result live_set_patch(live *self, const patch *p, error *err);
/* What of it the face and the mapping do not have, in lines; "". */
const char *live_patch_note(const live *self);

/* ---- another face; the inputs stay open. Refused while a take is recorded. ---- */

CHECKED mrt_result live_set_face(live *self, const face_file *face, const char *path,
                                 double unit_mm, error *err);
/* radius 0: the rig's, whatever the face; NULL: all of it is the rig's. Takes do not keep it:
 * whoever plays one elsewhere does so with its rig's. */
CHECKED mrt_result live_set_solver(live *self, const csrbf_settings *solver, error *err);

/* ---- recording ---- */

/* A take is going to begin at that instant of the host's clock, and the beats count towards it; a
 * live_record() after it begins the take right there. 0: it is given up. */
void live_count_in(live *self, int64_t begin_ns);
/* slate NULL: none is said. */
CHECKED mrt_result live_record(live *self, const writer_slate *slate, error *err);
CHECKED mrt_result live_record_end(live *self, error *err); /* of either kind */
/* A take of what was performed between two instants of the host's clock. It is in the show once the
 * writer has got to it. */
CHECKED mrt_result live_keep(live *self, int64_t from_ns, int64_t to_ns, const writer_slate *slate,
                             int64_t *out_take, error *err);
CHECKED mrt_result live_mark(live *self, const char *text, error *err);
/* A click on the beats of a take's timeline, from its start on, heard by whoever performs: it is in
 * no take and no export. */
typedef enum live_click_when {
    LIVE_CLICK_OFF = 0,
    LIVE_CLICK_COUNT_IN,  /* before a recording */
    LIVE_CLICK_RECORDING, /* and while it goes on */
    LIVE_CLICK_ALWAYS     /* and when a take is played */
} live_click_when;
enum { LIVE_CLICK_BPM_MIN = 20, LIVE_CLICK_BPM_MAX = 400, LIVE_CLICK_BAR_MAX = 16 };
typedef struct live_click {
    live_click_when when;
    double bpm;   /* LIVE_CLICK_BPM_MIN..LIVE_CLICK_BPM_MAX */
    uint32_t bar; /* beats, 1..LIVE_CLICK_BAR_MAX: the first is higher */
} live_click;
CHECKED mrt_result live_set_click(live *self, const live_click *click, error *err);
CHECKED mrt_result live_arm_sound(live *self, uint32_t channel_count, error *err);
void live_disarm_sound(live *self);
/* A take that live itself has edited since the last call (its sound was attached): whoever shows it
 * reads it anew. 0: none. */
int64_t live_take_edited(live *self);
/* Another show: what is being recorded ends, and the mapping goes over, without a jump, to what
 * this show's last session taught it; NULL: none, and it knows what it knew. */
CHECKED mrt_result live_set_show(live *self, show *s, error *err);

/* ---- a take on the stage ---- */

/* Shown from now on, at the instant where it stood if it was shown before; after each edit again.
 * Its own face must be the one on stage, or one like it: else an error that says which. */
CHECKED mrt_result live_show_take(live *self, const take *t, error *err);
void live_show_hands(live *self);             /* back to LIVE_PERFORMS */
int64_t live_shown_take(const live *self);    /* 0: none */
const char *live_take_note(const live *self); /* what is not as it was recorded; "" */

/* [main]'s idea of the transport, at once. */
transport_position live_position(const live *self);
const transport *live_transport(const live *self);
void live_play(live *self);
void live_pause(live *self);
void live_seek(live *self, int64_t at_ns);
void live_set_speed(live *self, double speed);
void live_set_loop(live *self, int64_t in_ns, int64_t out_ns); /* in >= out: none */
void live_step_frames(live *self, int64_t frames);

/* Over the take that is shown, from where in_ns says. The patterns are copied; passes 0: until it
 * is ended; the speed is the transport's, whatever the plan says. */
CHECKED mrt_result live_record_over(live *self, const overdub_plan *plan, error *err);
/* Once after it has ended (by live_record_end or by itself): the edits to make of the take, which
 * [main] makes (they are one step of undo). False: nothing to take. */
bool live_take_over(live *self, edit **out_edits, uint32_t *out_count, error *err);

#endif
