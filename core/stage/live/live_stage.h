/* live/live_stage.h - private structs and functions of the live stage, for the files of this
 * folder. live_stage is the state of the frame thread, struct live the state of [main]. [main]
 * sends commands to the frame thread. At the end of this header the files are listed in order: each
 * file calls only files that are listed before it. */
#ifndef MAROTTE_STAGE_LIVE_STAGE_H
#define MAROTTE_STAGE_LIVE_STAGE_H
#include "stage/input/feed.h"
#include "stage/input/tap.h"
#include "stage/live/live.h"
#include "stage/live/live_board.h"
#include "stage/mapping/taught.h"
#include "stage/output/outputs.h"
#include "stage/perform/life_input.h"
#include "stage/perform/player.h"
#include "stage/perform/reload.h"
#include "stage/record/recorder.h"
#include "stage/playback/sequencer.h"

#include <pthread.h>

/* time for which the last face of an overdub stays before the take is shown again */
#define LIVE_HOLD_NS INT64_C(500000000)

enum {
    LIVE_INPUTS_MAX = TAKE_TRACKS_MAX - 1, /* without the pointer, which is input 0 of the player */
    LIVE_LAGS = 512,
    LIVE_POSITIONS = 64 /* takes whose last position is remembered */
};

/* [main] A mapping that performs: its instance, its own process if it is not built in, and a file
 * watch that reloads it after a build. */
typedef struct live_mapping_role {
    char *text;          /* such as "one_hand,smile=8"; "": none */
    const char *library; /* NULL: no mapping */
    instance instance;
    isolate_settings isolation;
    isolate *isolate;
    reload *reload;
    /* true: its taught values are a note of the open show. False: they belong to another show, and
     * this mapping is used only until its replacement is ready. */
    bool is_of_show;
    uint64_t noted_hash; /* hash of that note; 0: not read yet */
    int64_t noted_ns;    /* time of the last check of the note */
} live_mapping_role;

/* A face and its performer. Created on [main], used by the frame thread. */
typedef struct live_scene {
    const face_file *file;
    face_file ready; /* `file` with its binding already computed */
    char *path;
    double unit_mm;
    csrbf_settings solver; /* radius 0: the rig's solver settings */
    performer *performer;
    live_board board;
    face_board *outgoing;  /* for the outputs */
    take_performance face; /* hashes under which the face is recorded */
    struct live_scene *before;
} live_scene;

/* Owner of the sequencer of a take. live_timeline_move makes all transitions.
 *
 *   frame thread:  HERE, ARRIVED --send--> AWAY    BACK --receive--> ARRIVED --publish--> HERE
 *   take's thread: AWAY --done--> BACK             RECALLED --done--> HELD
 *   [main]:        AWAY --hold--> RECALLED         HERE, BACK, ARRIVED --hold--> HELD
 *                  RECALLED --release--> AWAY      HELD --release--> HERE
 */
typedef enum live_timeline_state {
    LIVE_TIMELINE_HERE = 0, /* the frame thread owns it */
    LIVE_TIMELINE_AWAY,     /* the timeline's thread owns it and moves it to to_ns */
    LIVE_TIMELINE_BACK,    /* the timeline's thread has finished; the frame thread has not looked */
    LIVE_TIMELINE_ARRIVED, /* the frame thread owns it; that instant is not published yet */
    LIVE_TIMELINE_RECALLED, /* the timeline's thread owns it; [main] gets it afterwards */
    LIVE_TIMELINE_HELD      /* [main] owns it */
} live_timeline_state;

typedef enum live_timeline_event {
    LIVE_TIMELINE_SEND, /* frame thread */
    LIVE_TIMELINE_RECEIVE,
    LIVE_TIMELINE_PUBLISH,
    LIVE_TIMELINE_HOLD,    /* frame thread, in a command of [main] */
    LIVE_TIMELINE_RELEASE, /* likewise */
    LIVE_TIMELINE_DONE     /* the timeline's thread */
} live_timeline_event;

/* A take on the stage. A seek reads files, allocates memory and runs processes, so the timeline has
 * its own thread for it. */
typedef struct live_timeline {
    show *show; /* own handle */
    sequencer *sequencer;
    int64_t take;
    pthread_t thread;
    bool has_thread;
    wake work, *done; /* of the timeline's thread; of the frame thread */
    _Atomic bool stop;
    _Atomic uint32_t state; /* live_timeline_state */
    int64_t to_ns;
    bool is_seek; /* true: sequencer_seek; false: sequencer_play_to */
    error failed; /* "": the last request succeeded */
} live_timeline;

/* The newest sample of an input. */
typedef struct live_sample_board {
    publish_slot slot;
    mrt_sample sample[3];
    float last[MRT_MAX_CHANNELS]; /* [frame] */
    _Atomic uint64_t presses;     /* see live_input_presses */
} live_sample_board;

typedef struct live_pulse { /* statistics of the frame thread */
    uint64_t sample_count;
    composer_counts counts;
    rezero_counts rezeros;
    uint64_t patch_speaks;
    bool is_patch_moving; /* a filter or a fade is still running */
    uint32_t patch_pressed[PATCH_ACTIONS];
    uint32_t frame_count, lag_count;
    float frame_ms[LIVE_HISTORY], phase_ms[LIVE_PHASES][LIVE_HISTORY]; /* rings */
    float lag_ms[LIVE_LAGS];                                           /* a ring */
    int64_t last_ns; /* host clock: time of the newest performed sample */
    live_mode mode;
    int64_t take;
    recorder_code code;
    uint64_t overdub_count; /* number of overdubs */
    size_t kept_bytes;      /* size of the checkpoints of the shown take */
} live_pulse;

typedef struct live_stage { /* owned by the frame thread; by [main] while a command runs or after
                               the thread has ended */
    player_loop *loop;
    stage_frame frame; /* of each step and of each published face; its phase times are summed since
                          the last published face */
    live_scene *scene;
    live_mapping_role *role;
    reload *reload;     /* of the role; NULL: the file is not watched */
    recorder *recorder; /* NULL: recording is off */
    log_queue *log;
    outputs *outputs;
    live_sample_board *heard[PLAYER_INPUTS_MAX]; /* by input index of the player; entry 0 is NULL */
    uint32_t input_count;
    mrt_sample pointed; /* last sample of the pointer */

    live_mode mode;
    live_timeline *timeline;
    publish_slot motion_slot; /* transports from [main] */
    transport motion[3];
    bool has_pending_seek; /* the transport has changed: seek to the next instant instead of playing
                              to it */
    int64_t hold_until_ns; /* LIVE_SHOWS: the published face stays until then */
    sound *sound;          /* NULL: none */
    live_click click;
    int64_t count_ns;  /* LIVE_PERFORMS, host clock: time 0 of the current or next recorded take; 0:
                          none */
    overdub_run *over; /* running, or finished and not fetched yet */
    uint8_t *owned;    /* contacts and degrees of freedom that the overdub owns */

    bool is_dirty;                     /* a step was performed since the last drawn face */
    bool is_metered;                   /* the current face is measured */
    wake *changed;                     /* wakes [main]; NULL: [main] does not wait */
    mrt_vec3 hand_from[2][MRT_JOINTS]; /* mm: joints at the last movement of each hand */
    int64_t hand_until_ns[2];          /* the hand counts as moving until then */
    int64_t drawn_ns, published_ns;    /* begin and end of drawing the last face */
    int64_t sample_ns;
    double min_determinant, penetration_mm;
    surface_state skin;
    int64_t metered_ns;

    live_pulse now; /* counted now, published by live_frame_pulse */
    publish_slot pulse_slot;
    live_pulse pulse[3];
} live_stage;

/* A command from [main]. The frame thread runs it between two steps while [main] waits. */
typedef mrt_result live_command_run(live_stage *stage, void *data, error *err);
typedef struct live_command {
    live_command_run *run;
    void *data;
    error *err;
    mrt_result result;
} live_command;

/* Data of a command that changes the performing parts, in both directions. */
typedef struct live_change {
    recorder_cast *cast; /* NULL: recording is off */
    live_scene *scene;
    live_mapping_role *role;
    layer_room *room; /* of the new performer; after the change, of the old one */
    instance *old;
    bool keeps_clay; /* the base does not return to rest */
    input *add;
    live_sample_board *heard;
    uint32_t remove, side;
    const hand_calibration *calibration;
    hand_skeleton *skeleton;
    uint32_t pedal;
    const void *taught;
    size_t taught_size;
    patch_plan *plan; /* the new plan; after the change, the old one */
} live_change;

typedef struct live_input_entry {
    input *input;
    char *text;
    live_sample_board *heard;
} live_input_entry;

/* [main] The inputs that play poses, see palette.h. */
typedef struct live_palette {
    bool is_open;
    const live_scene *scene; /* that the strengths were sent to; only compared */
    feed *feed[PALETTE_INPUTS];
    input *input[PALETTE_INPUTS]; /* owned by `entry`, where they may be missing; only compared */
    uint32_t input_count, pose_count;
    char name[PALETTE_POSES_MAX][CHANNEL_NAME];
    float value[PALETTE_INPUTS][MRT_MAX_CHANNELS];
    bool is_marked[PALETTE_INPUTS];      /* a strength was set and not sent */
    int64_t rests_at_ns[PALETTE_INPUTS]; /* time after which the feed rests; 0: it does */
} live_palette;

/* [main] The input of life, see life.h. */
typedef struct live_life {
    life_settings wanted;
    double sent[LIFE_KINDS]; /* to the input */
    uint32_t sent_seed;
    error trouble;       /* why there is no input; "": there is, or none was wanted */
    uint32_t refused_at; /* number of inputs when it was refused */
} live_life;

typedef struct live_measured { /* a calibration that was loaded; zeroed: none */
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

    csrbf_settings own_solver; /* radius 0: the rig's settings */
    bool has_own_solver;       /* false: the rig's settings are used */
    outputs *outputs;
    tap *tap; /* by input index of the stage, without the pointer */
    feed *pointer_feed;
    input *pointer;
    float pointed[POINTER_CHANNELS];
    bool is_pointing; /* the pointer pulls or holds a contact */
    bool moves;       /* its feed repeats samples */
    bool patch_moves; /* the feed repeats because the patch is still moving, although its fader is
                         at rest */
    int64_t rests_at_ns; /* time after which the feed may stop; 0: not set */
    live_input_entry entry[LIVE_INPUTS_MAX];
    input *cast_input[PLAYER_INPUTS_MAX]; /* pointer, then `entry`: for the recorder */
    const char *cast_text[PLAYER_INPUTS_MAX];
    uint32_t entry_count;
    live_palette palette;
    live_life life;
    live_measured hand[2];
    uint32_t rezero_pedal, rezero_wanted;
    patch patch; /* count 0: no patch */

    live_scene *scene, *old_scene; /* old_scene: an earlier scene whose views may still be read */
    live_mapping_role *role, *coming; /* coming: replaces `role` between two steps */

    show *show; /* show for recordings; NULL: none */
    char why_not[256];
    recorder *recorder;
    int64_t session_ns, take_begun_ns, take_ended_ns;

    live_timeline *timeline;
    transport transport;
    timecode_rate rate; /* frame rate of the take */
    bool is_shown;
    take shown;        /* own copy */
    bool is_over;      /* an overdub is running */
    bool is_over_done; /* an overdub has ended and its edits are not fetched yet */
    char note[1024];
    struct {
        int64_t take, at_ns;
    } position[LIVE_POSITIONS];
    uint32_t position_count;

    sound *sound;
    live_click click;
    bool wants_sound; /* the sound stays armed while it is set */
    uint32_t sound_channels;
    int64_t attach_take; /* take whose sound is still being written; 0: none */
    int64_t edited_take; /* take that the stage itself edited, see live_take_edited */
    uint64_t overdub_count;

    live_status status;
    int64_t measured_ns; /* time of the last computation of the percentiles */
};

/* ---- live_frame.c: the frame thread ---- */

/* Runs a command on the frame thread and waits for its result. Runs it directly while the thread
 * does not exist. */
CHECKED mrt_result live_run_command(live *self, live_command_run *run, void *data, error *err);
/* live_frame_start creates the player, live_frame_run its thread. */
CHECKED mrt_result live_frame_start(live *self, error *err);
CHECKED mrt_result live_frame_run(live *self, error *err);
void live_frame_stop(live *self);
/* [frame, in a command] Performs the pointer's current sample again with the current time. */
CHECKED mrt_result live_frame_tick(live_stage *stage, error *err);
void live_frame_publish(live_stage *stage); /* publishes the current face */
void live_frame_pulse(live_stage *stage);

/* [main] Start and stop the thread of a timeline. */
CHECKED mrt_result live_timeline_start(live_timeline *self, wake *done, error *err);
void live_timeline_stop(live_timeline *self);
/* Returns the new state. An event that does not fit the state changes nothing. */
live_timeline_state live_timeline_move(live_timeline *self, live_timeline_event event);
/* [frame] Ends the overdub. */
void live_time_end_over(live_stage *stage, int64_t now_ns, error *err);
/* [frame] Sends the current motion of the timeline to the sound. Call it after each change. */
void live_time_update_sound(live_stage *stage, int64_t now_ns);
/* Returns the instant that is shown at a position. At its end a take shows its last instant, not
 * the neutral face after it. */
int64_t live_time_shown_at(const transport *motion, int64_t at_ns);

/* ---- live_cast.c: face, mapping and recorder settings that perform ---- */

/* Creates the first face and the first mapping. */
CHECKED mrt_result live_cast_start(live *self, error *err);
void live_cast_finish(live *self);
void live_cast_update(live *self);
/* Opens another face for the same mapping. */
CHECKED mrt_result live_cast_set_scene(live *self, const face_file *file, const char *path,
                                       double unit_mm, error *err);
void live_scene_destroy(live_scene *scene); /* also destroys the scenes before it */
/* Sets the solver of later scenes. NULL: the settings of the rigs. */
void live_own_solver(live *self, const csrbf_settings *solver);
isolate_counts live_mapping_isolated(live_mapping_role *self);
/* Stores the taught values of the mapping as a note of the show. live_cast_update also does this
 * soon after a change. */
void live_cast_keep_taught(live *self);
/* Call after another show was opened. Replaces a mapping that can be taught by a new instance with
 * the same values and the taught values of this show. */
CHECKED mrt_result live_cast_follow_show(live *self, error *err);

/* Returns the recorder settings of the current cast. moves_face false: for a layer over a take. */
recorder_settings live_cast_settings(live *self, bool moves_face);
/* Refuses while a take is recorded. `what` names the refused action. */
CHECKED mrt_result live_check_free(const live *self, const char *what, error *err);

/* Every change of the cast ends the current performance and begins a new one. live_cast_prepare
 * allocates on [main]. live_cast_begin makes the change on the frame thread, inside a command.
 * live_cast_dismiss frees what is no longer needed, also after an error. */
CHECKED mrt_result live_cast_prepare(live *self, live_change *c, error *err);
CHECKED mrt_result live_cast_begin(live_stage *stage, live_change *c, error *err); /* [frame] */
void live_cast_dismiss(live *self, live_change *c);
/* Does all three. The data of `run` is a struct whose first member is the live_change. */
CHECKED mrt_result live_cast_change(live *self, live_command_run *run, live_change *c, error *err);
/* Begins a new performance with the current cast. */
CHECKED mrt_result live_cast_restart(live *self, error *err);

/* ---- live_inputs.c: the pointer, inputs, hands ---- */

CHECKED mrt_result live_pointer_open(live *self, error *err);
void live_inputs_finish(live *self);
void live_inputs_update(live *self);
/* Supplies the steps in which something eases that no hand moves any more. */
void live_ease(live *self);

/* ---- live_palette.c: poses that are played ---- */

void live_palette_update(live *self);
bool live_palette_is_moving(const live *self); /* its inputs do not rest yet */
/* Sends the strengths of poses that are held again, to a layer that was reset. */
void live_palette_repeat(live *self);
void live_palette_finish(live *self); /* after the inputs */

/* ---- live_life.c: the life of the face ---- */

void live_life_update(live *self);

/* ---- live_record.c: recording, sound ---- */

CHECKED mrt_result live_record_start(live *self, error *err);
CHECKED mrt_result live_record_stop(live *self, error *err);
void live_record_update(live *self);
CHECKED mrt_result live_sound_need(live *self, error *err);
void live_sound_drop(live *self);
void live_sound_update(live *self);

/* ---- live_take.c: the timeline and the overdub ---- */

void live_take_drop(live *self);   /* removes the take from the stage */
void live_take_finish(live *self); /* frees the rest after all threads have ended */
void live_over_update(live *self);

#endif
