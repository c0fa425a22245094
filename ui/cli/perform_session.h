/* ui/cli/perform_session.h - shared by `perform` and `take record`: the inputs, the calibrations of
 * the hands, the mapping and the outputs. [main] */
#ifndef MAROTTE_UI_PERFORM_SESSION_H
#define MAROTTE_UI_PERFORM_SESSION_H
#include "cli/facts.h"
#include "hand/calibration_file.h"
#include "stage/mapping/plugins.h"
#include "stage/mapping/isolate.h"
#include "stage/output/outputs.h"
#include "stage/perform/performer.h"
#include "stage/perform/player.h"
#include "stage/perform/reload.h"
#include "stage/record/recorder.h"
#include "cli/terminal.h"

enum { PERFORM_INPUTS_MAX = 8, PERFORM_OUTPUTS_MAX = 8, PERFORM_CALIBRATIONS_MAX = 2 };

/* ---- inputs ---- */

typedef struct perform_inputs {
    const plugin_spec *spec; /* borrowed: inputs to open */
    input *input[PERFORM_INPUTS_MAX];
    uint32_t count;       /* number of open inputs */
    instance_clock clock; /* CLOCK_REAL if at least one input is a device */
} perform_inputs;

/* clock: used if all inputs are recordings. Close it, whatever the result. */
CHECKED mrt_result perform_inputs_open(perform_inputs *out, const plugin_spec *spec, uint32_t count,
                                       plugin_list *plugins, log_queue *log, instance_clock clock,
                                       error *err);
/* Adds life (life_input.h) with the parameters "key=value,...", for `seconds`; 0: endless. It lives
 * on the clock of the other inputs. Reports on stderr what the face lacks for it. */
CHECKED mrt_result perform_inputs_add_life(perform_inputs *self, const char *params, double seconds,
                                           const mapped_face *mapped, log_queue *log, error *err);
/* Time until the last input ends; 0: unknown, because one is a device or repeats. */
double perform_inputs_duration_s(const perform_inputs *self);
void perform_inputs_close(perform_inputs *self); /* accepts a zeroed struct */
/* Reports that an input was disconnected or came back. into: recorder that also receives the
 * incident, or NULL. */
void perform_inputs_incident(const perform_inputs *self, recorder *into, const input *from,
                             const input_incident *what, double time_s);

/* ---- hands: their calibrations, and the keys of a live performance ---- */

typedef struct perform_hands {
    char *path[2]; /* left, right: path of the calibration in use; NULL: none */
    double length_mm[2];
    hand_calibration use[2];
} perform_hands;

/* Loads the calibrations at these paths; one "none": the shipped defaults. Without a path, each
 * hand in counts gets the newest calibration of the user's folder. Reports on stderr which is used,
 * and what to do for an uncalibrated hand. `out` owns them; finish it whatever the result. */
CHECKED mrt_result perform_hands_choose(perform_hands *out, const char *const *path, uint32_t count,
                                        const perform_inputs *from, error *err);
void perform_hands_finish(perform_hands *self); /* accepts a zeroed struct */

/* NULL: the shipped defaults. */
const hand_calibration *perform_hands_calibration(const perform_hands *self, uint32_t side);

/* Reads the text of a calibration file, and replaces the text in `out` for the same hand, left or
 * right. The caller frees it. */
CHECKED mrt_result perform_hands_text(char *out[2], const char *path, error *err);

void perform_hands_report(const perform_hands *self, const performer *p, facts *told);

/* Handles the pressed keys: z re-zeroes the hands, q sets *stop. Reports what it did. Returns the
 * hands that were re-zeroed, as bits by side. */
uint32_t perform_hands_keys(performer *p, _Atomic bool *stop, progress *shown);

/* ---- the patch ---- */

/* Reports on stderr the targets of the layer's patch that its face and mapping do not have. */
void perform_patch_report(const layer *of);

/* ---- the mapping: in this process or in a separate one, reloaded when its library is rebuilt
 * ---- */

typedef struct perform_mapping {
    instance instance; /* the first one; the performer owns rebuilt ones */
    isolate *isolate;  /* NULL: it runs in this process */
    isolate_settings settings;
    const char *library;
    reload *reload;          /* NULL: not reloaded */
    const instance *current; /* the one in use */
} perform_mapping;

typedef struct perform_mapping_settings {
    plugin_list *plugins;
    log_queue *log;
    instance_clock clock;
    isolate_which isolation;
} perform_mapping_settings;

/* spec.plugin NULL: no mapping. Must not move; the spec must outlive it. Close it, whatever the
 * result. */
CHECKED mrt_result perform_mapping_open(perform_mapping *out, const plugin_spec *spec,
                                        const perform_mapping_settings *with, error *err);
/* Starts to reload rebuilt libraries. */
CHECKED mrt_result perform_mapping_watch(perform_mapping *self, performer *of, log_queue *log,
                                         error *err);
/* [frame] Call it before each sample. recorder: NULL: not recorded. */
void perform_mapping_step(perform_mapping *self, performer *of, recorder *into);
/* Checks a separate process. If it has failed, the face is held on stage, and an offline
 * performance fails. */
CHECKED mrt_result perform_mapping_check(const perform_mapping *self, error *err);
void perform_mapping_report(const perform_mapping *self, facts *told);
void perform_mapping_close(perform_mapping *self); /* after the performer; accepts zeroed */

/* ---- outputs: send the face during the performance ---- */

typedef struct perform_outputs { /* zeroed: none */
    outputs *outputs;
    face_board *board;         /* for the performed face */
    int64_t drawn_ns, draw_ns; /* time of the last drawing, and its duration */
    int64_t step_ns;           /* time of the newest step's sample */
    bool is_behind;            /* the newest step is not shown yet */
} perform_outputs;

/* text: values of --output; may name library files. Close `out`, whatever the result. */
CHECKED mrt_result perform_outputs_open(perform_outputs *out, const char *const *text,
                                        uint32_t count, const perform_mapping_settings *with,
                                        composer *of, const face_file *file, error *err);
/* Live, after each step: draws and sends the face, unless the last one was too recent. */
void perform_outputs_step(perform_outputs *self, performer *p, int64_t sample_ns);
/* Live, after each frame: sends a face that is not sent yet, or that an output requested again. */
void perform_outputs_frame(perform_outputs *self, performer *p);
/* Sends the drawn face; time_ns and take_ns as in mrt_face_sample. */
void perform_outputs_show(perform_outputs *self, performer *p, int64_t time_ns, int64_t take_ns);
void perform_outputs_report(outputs *of, facts *told); /* accepts NULL */
void perform_outputs_close(perform_outputs *self);

/* ---- the show that is recorded into ---- */

/* Reports when the disk becomes unwritable, and when it is writable again. Called repeatedly. */
void perform_record_watch_writer(writer *of, bool *is_told);
/* If the show's file was deleted, moved or replaced while it was open, saves a complete copy beside
 * it and reports its path. Returns an error if the copy is elsewhere or could not be made. so_far:
 * result until now. Call it when recording has ended; accepts NULL. */
CHECKED mrt_result perform_record_rescue(show *of, mrt_result so_far, error *err);

#endif
