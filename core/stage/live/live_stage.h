/* live/live_stage.h - what a live stage is made of: what the frame thread has (live_stage), what
 * [main] has (struct live), and how [main] gives orders. For the files of this folder, each of
 * which calls only those that stand before it at the end of this header. */
#ifndef MAROTTE_STAGE_LIVE_STAGE_H
#define MAROTTE_STAGE_LIVE_STAGE_H
#include "stage/input/feed.h"
#include "stage/input/tap.h"
#include "stage/live/live.h"
#include "stage/live/live_board.h"
#include "stage/mapping/taught.h"
#include "stage/output/outputs.h"
#include "stage/perform/player.h"
#include "stage/perform/reload.h"
#include "stage/record/recorder.h"
#include "stage/playback/sequencer.h"

#include <pthread.h>

/* How long the last face of an overdub stays before the take is shown without it. */
#define LIVE_HOLD_NS INT64_C(500000000)

enum {
    LIVE_INPUTS_MAX = TAKE_TRACKS_MAX - 1, /* beside the pointer, which is the player's input 0 */
    LIVE_LAGS = 512,
    LIVE_POSITIONS = 64 /* takes whose last instant is remembered */
};

/* A mapping that performs: its instance, in a process of its own where it did not come with the
 * program, and watched for being rebuilt. [main] */
typedef struct live_mapping_role {
    char *text;          /* "one_hand,smile=8"; "" none */
    const char *library; /* NULL: none */
    instance instance;
    isolate_settings isolation;
    isolate *isolate;
    reload *reload;
    /* What it is taught is a note of the show that is open. False: it was taught in another one,
     * and stays until its follower has come. */
    bool is_of_show;
    uint64_t noted_hash; /* of what that note says; 0: not looked at yet */
    int64_t noted_ns;    /* when it was looked at last */
} live_mapping_role;

/* A face and who moves it: made on [main], used by the frame thread. */
typedef struct live_scene {
    const face_file *file;
    face_file ready; /* the same with the performer's binding: others need not find it again */
    char *path;
    double unit_mm;
    csrbf_settings solver; /* radius 0: all of it is the rig's */
    performer *performer;
    live_board board;
    face_board *outgoing;  /* to the outputs */
    take_performance face; /* what it is recorded as: for its hashes */
    struct live_scene *before;
} live_scene;

/* Who has the sequencer of a take. live_timeline_move makes all transitions.
 *
 *   frame thread:  HERE, ARRIVED --send--> AWAY    BACK --receive--> ARRIVED --publish--> HERE
 *   take's thread: AWAY --done--> BACK             RECALLED --done--> HELD
 *   [main]:        AWAY --hold--> RECALLED         HERE, BACK, ARRIVED --hold--> HELD
 *                  RECALLED --release--> AWAY      HELD --release--> HERE
 */
typedef enum live_timeline_state {
    LIVE_TIMELINE_HERE = 0, /* the frame thread has it */
    LIVE_TIMELINE_AWAY,     /* its own thread has it and brings it to to_ns */
    LIVE_TIMELINE_BACK,     /* its thread has brought it; the frame thread has not looked yet */
    LIVE_TIMELINE_ARRIVED,  /* the frame thread has it; that instant has not been published yet */
    LIVE_TIMELINE_RECALLED, /* its thread still has it, then [main] */
    LIVE_TIMELINE_HELD      /* [main] has it */
} live_timeline_state;

typedef enum live_timeline_event {
    LIVE_TIMELINE_SEND, /* frame thread */
    LIVE_TIMELINE_RECEIVE,
    LIVE_TIMELINE_PUBLISH,
    LIVE_TIMELINE_HOLD,    /* frame thread, in a command of [main] */
    LIVE_TIMELINE_RELEASE, /* likewise */
    LIVE_TIMELINE_DONE     /* its thread */
} live_timeline_event;

/* A take on the stage. Bringing it to an instant takes files, memory and processes, so a thread of
 * its own does that. */
typedef struct live_timeline {
    show *show; /* its own handle */
    sequencer *sequencer;
    int64_t take;
    pthread_t thread;
    bool has_thread;
    wake work, *done; /* of its thread; of the frame thread */
    _Atomic bool stop;
    _Atomic uint32_t state; /* live_timeline_state */
    int64_t to_ns;
    bool is_seek; /* sequencer_seek, not sequencer_play_to */
    error failed; /* "" it was brought there */
} live_timeline;

/* The newest sample of an input. */
typedef struct live_sample_board {
    publish_slot slot;
    mrt_sample sample[3];
} live_sample_board;

typedef struct live_pulse { /* how the frame thread does */
    uint64_t sample_count;
    performer_counts counts;
    rezero_counts rezeros;
    uint64_t patch_speaks;
    bool is_patch_moving; /* a filter or a fade is on its way */
    uint32_t patch_pressed[PATCH_ACTIONS];
    uint32_t frame_count, lag_count;
    float frame_ms[LIVE_HISTORY], phase_ms[LIVE_PHASES][LIVE_HISTORY]; /* rings */
    float lag_ms[LIVE_LAGS];                                           /* a ring */
    int64_t last_ns; /* host clock: of the newest sample performed */
    live_mode mode;
    int64_t take;
    recorder_code code;
    uint64_t overdub_count; /* how often a take was performed over */
    size_t kept_bytes;      /* of the take on the stage, to scrub from */
} live_pulse;

typedef struct live_stage { /* the frame thread's; [main]'s while it runs a command or has ended */
    player_loop *loop;
    stage_frame frame; /* of each step and of each published face; its time until the last face */
    live_scene *scene;
    live_mapping_role *role;
    reload *reload;     /* of the role; NULL: it is not watched */
    recorder *recorder; /* NULL: nothing is recorded */
    log_queue *log;
    outputs *outputs;
    live_sample_board *heard[PLAYER_INPUTS_MAX]; /* by the player's index; 0: NULL */
    uint32_t input_count;
    mrt_sample pointed; /* the pointer's last sample */

    live_mode mode;
    live_timeline *timeline;
    publish_slot motion_slot; /* transports from [main] */
    transport motion[3];
    bool
        has_pending_seek; /* the transport has changed: the next instant is sought, not played to */
    int64_t hold_until_ns; /* LIVE_SHOWS: what was shown stays until then */
    sound *sound;          /* NULL: none */
    live_click click;
    int64_t count_ns;  /* LIVE_PERFORMS, host clock: 0 of a take that is or will be recorded */
    overdub_run *over; /* performed now, or not yet fetched */
    uint8_t *owned;    /* of it */

    bool is_dirty;                     /* something was performed since it was drawn */
    bool is_metered;                   /* the face as it is was */
    wake *changed;                     /* of [main]; NULL: it does not wait */
    mrt_vec3 hand_from[2][MRT_JOINTS]; /* mm: where each hand was as it moved last */
    int64_t hand_until_ns[2];          /* it counts as moving until then */
    int64_t drawn_ns, published_ns;    /* the last face: when drawing it began and ended */
    int64_t sample_ns;
    double min_determinant, penetration_mm;
    surface_state skin;
    int64_t metered_ns;

    live_pulse now; /* as counted */
    publish_slot pulse_slot;
    live_pulse pulse[3];
} live_stage;

/* Something that [main] asks of the frame thread, which runs it between two steps while [main]
 * waits. */
typedef mrt_result live_command_run(live_stage *stage, void *data, error *err);
typedef struct live_command {
    live_command_run *run;
    void *data;
    error *err;
    mrt_result result;
} live_command;

/* What goes to the frame thread with a change, and what comes back. */
typedef struct live_change {
    recorder_cast *cast; /* NULL: nothing is recorded */
    live_scene *scene;
    live_mapping_role *role;
    layer_room *room; /* of who comes; then of who went */
    instance *old;
    input *add;
    live_sample_board *heard;
    uint32_t remove, side;
    const hand_calibration *calibration;
    hand_skeleton *skeleton;
    uint32_t pedal;
    const void *taught;
    size_t taught_size;
    patch_plan *plan; /* that comes; then the one that was */
} live_change;

typedef struct live_input_entry {
    input *input;
    char *text;
    live_sample_board *heard;
} live_input_entry;

typedef struct live_measured { /* a calibration that was read; zeroed: none */
    char *path, *text;
    hand_calibration *use;
    double length_mm;
} live_measured;

struct live {
    live_settings settings;
    live_stage stage;
    pthread_t thread;
    bool has_thread;
    _Atomic bool stop;
    _Atomic(live_command *) command;
    wake answered;

    csrbf_settings own_solver; /* radius 0: the rig's */
    bool has_own_solver;       /* false: all of it is the rig's */
    outputs *outputs;
    tap *tap; /* by live's index of inputs */
    feed *pointer_feed;
    input *pointer;
    float pointed[POINTER_CHANNELS];
    bool is_pointing;    /* it holds something */
    bool moves;          /* its feed repeats */
    bool patch_moves;    /* so it does, for what a fader that rests by now has set going */
    int64_t rests_at_ns; /* when it may rest again; 0: not yet */
    live_input_entry entry[LIVE_INPUTS_MAX];
    input *cast_input[PLAYER_INPUTS_MAX]; /* the pointer and those: for the recorder */
    const char *cast_text[PLAYER_INPUTS_MAX];
    uint32_t entry_count;
    live_measured hand[2];
    uint32_t rezero_pedal, rezero_wanted;
    patch patch; /* count 0: none */

    live_scene *scene, *old_scene;    /* old: its views, and those before, may be looked at */
    live_mapping_role *role, *coming; /* coming: takes over as soon as nothing is between */

    show *show; /* that is recorded into; NULL: none */
    char why_not[256];
    recorder *recorder;
    int64_t session_ns, take_begun_ns, take_ended_ns;

    live_timeline *timeline;
    transport transport;
    timecode_rate rate; /* of the take's frames */
    bool is_shown;
    take shown;        /* a copy */
    bool is_over;      /* recording over the take */
    bool is_over_done; /* its edits have not been taken */
    char note[1024];
    struct {
        int64_t take, at_ns;
    } position[LIVE_POSITIONS];
    uint32_t position_count;

    sound *sound;
    live_click click;
    bool wants_sound; /* armed as long as it is wanted */
    uint32_t sound_channels;
    int64_t attach_take; /* its sound is on the way; 0: none */
    int64_t edited_take; /* by the stage itself: live_take_edited */
    uint64_t overdub_count;

    live_status status;
    int64_t measured_ns; /* percentiles */
};

/* ---- live_frame.c: the frame thread ---- */

/* Waits until the frame thread has run it; before there is one, runs it itself. */
CHECKED mrt_result live_ask(live *self, live_command_run *run, void *data, error *err);
/* Its player, and then its thread. */
CHECKED mrt_result live_frame_start(live *self, error *err);
CHECKED mrt_result live_frame_run(live *self, error *err);
void live_frame_stop(live *self);
/* [frame, in a command] A sample of the pointer as it is, now: time goes on. */
CHECKED mrt_result live_frame_tick(live_stage *stage, error *err);
void live_frame_publish(live_stage *stage); /* the face as it is */
void live_frame_pulse(live_stage *stage);

/* [main] The thread of a timeline. */
CHECKED mrt_result live_timeline_start(live_timeline *self, wake *done, error *err);
void live_timeline_stop(live_timeline *self);
/* Returns the new state. An event that does not fit the state changes nothing. */
live_timeline_state live_timeline_move(live_timeline *self, live_timeline_event event);
/* [frame] What is performed over the take ends here. */
void live_time_end_over(live_stage *stage, int64_t now_ns, error *err);
/* [frame] What the sound does from now on: it is told of each change. */
void live_time_tell_sound(live_stage *stage, int64_t now_ns);
/* What is shown when it stands there: at its end a take shows its last instant, not the rest behind
 * it. */
int64_t live_time_shown_at(const transport *motion, int64_t at_ns);

/* ---- live_cast.c: who performs ---- */

/* The first face and the first mapping. */
CHECKED mrt_result live_cast_start(live *self, error *err);
void live_cast_finish(live *self);
void live_cast_update(live *self);
/* Another face for the same mapping. */
CHECKED mrt_result live_cast_set_scene(live *self, const face_file *file, const char *path,
                                       double unit_mm, error *err);
void live_scene_destroy(live_scene *scene);                     /* and those before it */
void live_own_solver(live *self, const csrbf_settings *solver); /* of scenes to come; NULL: rigs' */
isolate_counts live_mapping_isolated(live_mapping_role *self);
/* What the mapping was taught becomes a note of the show, for another session; so it does by itself
 * soon after it has changed. */
void live_cast_keep_taught(live *self);
/* Another show is open: a mapping that can be taught makes way for one of its kind, with its
 * values, that knows what this show says. */
CHECKED mrt_result live_cast_follow_show(live *self, error *err);

/* Who performs now, for the recorder; the layer alone: others move the face. */
recorder_settings live_cast_settings(live *self, bool moves_face);
/* Refuses while a take is recorded, with what cannot be done. */
CHECKED mrt_result live_check_free(const live *self, const char *what, error *err);

/* Every change of who performs ends the performance that is recorded and begins another one. As
 * things are then is prepared here; a command makes the change, and begins with it on the frame
 * thread; what has ended, or was not needed, is dismissed, whatever came of it. */
CHECKED mrt_result live_cast_prepare(live *self, live_change *c, error *err);
CHECKED mrt_result live_cast_begin(live_stage *stage, live_change *c, error *err); /* [frame] */
void live_cast_dismiss(live *self, live_change *c);
/* All three: `run` begins with a live_change that is its data. */
CHECKED mrt_result live_cast_change(live *self, live_command_run *run, live_change *c, error *err);
CHECKED mrt_result live_cast_anew(live *self, error *err); /* as things are now */

/* ---- live_inputs.c: the pointer, inputs, hands ---- */

CHECKED mrt_result live_pointer_open(live *self, error *err);
void live_inputs_finish(live *self);
void live_inputs_update(live *self);

/* ---- live_record.c: recording, sound ---- */

CHECKED mrt_result live_record_start(live *self, error *err);
CHECKED mrt_result live_record_stop(live *self, error *err);
void live_record_update(live *self);
CHECKED mrt_result live_sound_need(live *self, error *err);
void live_sound_drop(live *self);
void live_sound_update(live *self);

/* ---- live_take.c: the timeline, and what is performed over it ---- */

void live_take_drop(live *self);   /* none is shown any more */
void live_take_finish(live *self); /* what is left of it, when nothing runs any more */
void live_over_update(live *self);

#endif
