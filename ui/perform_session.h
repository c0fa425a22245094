/* ui/perform_session.h - what `perform` and `take record` share: whose hands perform, through which
 * mapping, recorded into which show, with which sound. [main] */
#ifndef MAROTTE_UI_PERFORM_SESSION_H
#define MAROTTE_UI_PERFORM_SESSION_H
#include "facts.h"
#include "hand/calibration_file.h"
#include "perform_options.h"
#include "stage/mapping/plugins.h"
#include "stage/output/outputs.h"
#include "stage/perform/performer.h"
#include "stage/perform/player.h"
#include "stage/perform/reload.h"
#include "stage/sound/sound.h"
#include "stage/take/recorder.h"
#include "terminal.h"

/* ---- hands: which calibration each gets, and the keys of a live performance ---- */

typedef struct perform_hands {
    char *path[2]; /* left, right: of the calibration in use; NULL: none */
    double length_mm[2];
    hand_calibration use[2];
} perform_hands;

/* The calibrations asked for, else for every hand that comes in counts the newest of the user's
 * folder. Says on stderr what is used, and what an uncalibrated hand can do. Owned by `out`, which
 * can be finished whatever the result. */
CHECKED mrt_result perform_hands_choose(perform_hands *out, const perform_options *options,
                                        input *const *inputs, uint32_t input_count, error *err);
void perform_hands_finish(perform_hands *self); /* zeroed is fine */

/* NULL: shipped defaults. */
const hand_calibration *perform_hands_calibration(const perform_hands *self, uint32_t side);

/* A calibration's file as text, to be freed. */
CHECKED mrt_result perform_hands_text(char **out, const char *path, error *err);

void perform_hands_report(const perform_hands *self, const performer *p, facts *told);

/* Takes the keys that were pressed: z re-zeroes the hands, q sets *stop. Returns which hands were
 * re-zeroed: bits by side. Says what it did. */
uint32_t perform_hands_keys(performer *p, _Atomic bool *stop, progress *shown);

/* ---- the patch ---- */

/* What of the layer's patch its face and mapping do not have, on stderr. */
void perform_patch_tell(const layer *of);

/* ---- the mapping: in a process of its own or not, reloaded when its library is rebuilt ---- */

typedef struct perform_mapping {
    instance instance; /* the first; a rebuilt one is performer's */
    isolate *isolate;  /* NULL: it runs in this process */
    isolate_settings settings;
    const char *library;
    reload *reload;          /* NULL: nobody watches */
    const instance *current; /* the one that performs */
} perform_mapping;

typedef struct perform_mapping_settings {
    plugin_list *plugins;
    log_queue *log;
    instance_clock clock;
    isolate_which isolation;
} perform_mapping_settings;

/* Must not move; the spec must outlive it. To be closed whatever the result. */
CHECKED mrt_result perform_mapping_open(perform_mapping *out, const plugin_spec *spec,
                                        const perform_mapping_settings *with, error *err);
/* If the options say so: from here on rebuilt libraries are taken. */
CHECKED mrt_result perform_mapping_watch(perform_mapping *self, const perform_options *options,
                                         performer *of, log_queue *log, error *err);
/* [frame] Before a sample. recorder: NULL: nothing is recorded. */
void perform_mapping_step(perform_mapping *self, performer *of, recorder *into);
/* A process that has failed: on stage the face was held; an offline performance fails. */
CHECKED mrt_result perform_mapping_check(const perform_mapping *self, error *err);
void perform_mapping_report(const perform_mapping *self, facts *told);
void perform_mapping_close(perform_mapping *self); /* after the performer; zeroed is fine */

/* ---- outputs: the face is sent on while it is performed ---- */

typedef struct perform_outputs { /* zeroed: none */
    outputs *outputs;
    face_board *board;         /* of the face that is performed */
    int64_t drawn_ns, draw_ns; /* when it was drawn last; how long that took */
    int64_t step_ns;           /* of the newest step's sample */
    bool is_behind;            /* that step was not shown yet */
} perform_outputs;

/* text: as --output says them, which may name libraries. To be closed whatever the result. */
CHECKED mrt_result perform_outputs_open(perform_outputs *out, const char *const *text,
                                        uint32_t count, const perform_mapping_settings *with,
                                        composer *of, const face_file *file, error *err);
/* Live, after each step: the face is drawn and shown, unless that is too soon after the last. */
void perform_outputs_step(perform_outputs *self, performer *p, int64_t sample_ns);
/* Live, after a frame was drawn: what is not shown yet is, and what an output asked for again. */
void perform_outputs_frame(perform_outputs *self, performer *p);
/* The face that is drawn; time_ns and take_ns as in mrt_face_sample. */
void perform_outputs_show(perform_outputs *self, performer *p, int64_t time_ns, int64_t take_ns);
void perform_outputs_report(outputs *of, facts *told); /* NULL is fine */
void perform_outputs_close(perform_outputs *self);

/* ---- the microphone beside a performance: what was said becomes the sound of its take; one that
 * is missing or fails stops nothing ---- */

typedef struct perform_sound {
    sound *sound; /* NULL: nothing is recorded */
    show *show;
    char told[256]; /* the last thing that was said of it */
} perform_sound;

/* The take's sound from its start on as a WAV beside a file, for exports_video_sound_remove; NULL:
 * it has none. */
CHECKED mrt_result perform_sound_write(perform_sound *self, int64_t take_id, double length_s,
                                       const char *beside, char **out_path, progress *shown,
                                       error *err);

/* ---- recording into a show ---- */

typedef struct perform_record {
    show *show;
    recorder *recorder;   /* NULL: nothing is recorded */
    performer *performer; /* that is recorded */
    log_queue *log;
    perform_sound sound;
    char *input_text[PERFORM_INPUTS_MAX];
    char *calibration[2];
    int64_t take;
    bool is_waiting_told; /* that the disk does not take it now */
} perform_record;

typedef struct perform_record_of { /* what is recorded: of perform.c */
    const plugin_list *plugins;
    log_queue *log;
    instance_clock clock;
    input *const *inputs;
    uint32_t input_count;
    const perform_hands *hands;
    performer *performer;
    const face_file *face;
    const patch *patch; /* NULL: none */
} perform_record_of;

/* How the show solves into which it is recorded, so that the take shows what is performed now:
 * radius 0: as the rig says. One that cannot be read is told of by perform_record_start. */
csrbf_settings perform_record_solver(const perform_options *options, const face_file *on,
                                     log_queue *log);
/* Opens the show, or makes it; a take begins with the first sample. Does nothing without --record.
 * To be finished whatever the result. */
CHECKED mrt_result perform_record_start(perform_record *out, const perform_options *options,
                                        const perform_record_of *of, error *err);
/* Now and then: says what the person should know: the disk is full, the file was deleted. */
void perform_record_watch(perform_record *self);
void perform_record_watch_writer(writer *of, bool *is_told); /* the same, for any writer */
/* The take ends, and all is written. */
CHECKED mrt_result perform_record_end(perform_record *self, facts *told, error *err);
void perform_record_finish(perform_record *self); /* zeroed is fine */
/* When the show's file was deleted, moved or replaced while it was open: a whole copy beside it,
 * and says where. When nothing is recorded any more. NULL is fine. */
void perform_record_rescue(show *of);

#endif
