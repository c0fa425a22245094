/* ui/cli/perform_session.h - what `perform` and `take record` share: the inputs, whose hands perform,
 * through which mapping, with the face sent where. [main] */
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
    const plugin_spec *spec; /* borrowed: what was asked for */
    input *input[PERFORM_INPUTS_MAX];
    uint32_t count;       /* that are open */
    instance_clock clock; /* the host's as soon as one of them is a device */
} perform_inputs;

/* clock: when all are recordings. To be closed whatever the result. */
CHECKED mrt_result perform_inputs_open(perform_inputs *out, const plugin_spec *spec, uint32_t count,
                                       plugin_list *plugins, log_queue *log, instance_clock clock,
                                       error *err);
/* Until the last of them ends; 0: not known, as one is a device or plays for ever. */
double perform_inputs_duration_s(const perform_inputs *self);
void perform_inputs_close(perform_inputs *self); /* zeroed is fine */
/* Says that one went away or came back; into: the recorder that is told too, or NULL. */
void perform_inputs_incident(const perform_inputs *self, recorder *into, const input *from,
                             const input_incident *what, double time_s);

/* ---- hands: which calibration each gets, and the keys of a live performance ---- */

typedef struct perform_hands {
    char *path[2]; /* left, right: of the calibration in use; NULL: none */
    double length_mm[2];
    hand_calibration use[2];
} perform_hands;

/* The calibrations at these paths (one "none": shipped defaults), else for every hand that comes in
 * counts the newest of the user's folder. Says on stderr what is used, and what an uncalibrated
 * hand can do. Owned by `out`, which can be finished whatever the result. */
CHECKED mrt_result perform_hands_choose(perform_hands *out, const char *const *path, uint32_t count,
                                        const perform_inputs *from, error *err);
void perform_hands_finish(perform_hands *self); /* zeroed is fine */

/* NULL: shipped defaults. */
const hand_calibration *perform_hands_calibration(const perform_hands *self, uint32_t side);

/* A calibration's file as text, to be freed: in place of what was there of its hand, left or right.
 */
CHECKED mrt_result perform_hands_text(char *out[2], const char *path, error *err);

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
/* From here on rebuilt libraries are taken. */
CHECKED mrt_result perform_mapping_watch(perform_mapping *self, performer *of, log_queue *log,
                                         error *err);
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

/* ---- a show that is recorded into ---- */

/* Now and then: says that the disk does not take it now, and when it does again. */
void perform_record_watch_writer(writer *of, bool *is_told);
/* When the show's file was deleted, moved or replaced while it was open: a whole copy beside it,
 * and says where. An error where the copy lies elsewhere or could not be made; `so_far` is what
 * failed before. When nothing is recorded any more. NULL is fine. */
CHECKED mrt_result perform_record_rescue(show *of, mrt_result so_far, error *err);

#endif
