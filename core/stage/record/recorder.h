/* stage/record/recorder.h - a performance into a show while it happens: its inputs as tracks, its
 * mapping and parameters as a performance, its samples before anything looks at them, and now and
 * then a state from which it can be taken up again. Leaves out how bytes reach the disk
 * (show/writer.h) and who drives it: whoever performs a step.
 * [main] unless marked; [frame] is the one thread that performs. */
#ifndef MAROTTE_STAGE_RECORDER_H
#define MAROTTE_STAGE_RECORDER_H
#include "stage/input/input.h"
#include "stage/mapping/plugins.h"
#include "stage/perform/performer.h"
#include "show/writer.h"

typedef struct recorder recorder;

typedef struct recorder_settings {
    show *show; /* writable; outlives it */
    const plugin_list *plugins;
    log_queue *log;
    instance_clock
        clock;          /* of the inputs; virtual: it waits for the writer, never loses a sample */
    int64_t journal_ns; /* 0: 30 min */
    /* what is performed */
    input *const *inputs;
    const char *const *input_text; /* as they were opened: "log:demo.csv,end=8" */
    uint32_t input_count;
    const char *calibration[2]; /* left, right: JSON; NULL: none */
    layer *layer;               /* who performs, its parameters set */
    const patch *patch;         /* of the layer, as it is set; NULL: none */
    instance *mapping;          /* of the layer; NULL: it is asked, no thread performs yet */
    performer *performer;       /* that layer and a face that it alone moves: states are kept, from
                                   which it can be taken up; NULL: others move the face too */
    const char *face_path;
    const face_file *face;
    double unit_mm;        /* of a mesh alone; 0: guessed */
    double hand_length_mm; /* of both hands; 0: as their calibrations say */
    uint32_t rezero_pedal;
    size_t state_bytes; /* at least so much room for a state: a larger face may come; 0 */
} recorder_settings;

/* Starts a session: from here on everything is recorded, as far back as the journal goes. */
CHECKED mrt_result recorder_start(recorder **out, const recorder_settings *settings, error *err);
/* Writes what is left. The inputs are still there. < 0: what could not be written; it is freed all
 * the same. */
CHECKED mrt_result recorder_stop(recorder *self, error *err);

/* ---- what is performed changes ---- */

/* Others perform from some sample on: what `now` says of them (its show, log and clock do not
 * count). Inputs that stay keep their tracks while the calibrations are the same. */
typedef struct recorder_cast recorder_cast;
CHECKED mrt_result recorder_prepare(recorder *self, const recorder_settings *now,
                                    recorder_cast **out, error *err);
/* [frame] With the next sample another performance begins, of that cast; gives the one back that
 * ends. A take that is being recorded shows both. */
recorder_cast *recorder_change(recorder *self, recorder_cast *cast);
/* [frame] No sample comes any more: what it watches may go. */
void recorder_leave(recorder *self);
/* One that was given back, or never used. Its inputs are still there. */
void recorder_dismiss(recorder *self, recorder_cast *cast);

/* ---- time code from outside: the newest MRT_CH_TIMECODE of an input ---- */

typedef struct recorder_code {
    int64_t time_ns;  /* of the samples' clock, when it was that frame; 0: none was heard */
    int64_t since_ns; /* it has run without a break */
    double frame;     /* counted from 00:00:00:00 */
    double fps;
    bool is_drop;
} recorder_code;
recorder_code recorder_code_heard(const recorder *self);
/* < 0: it does not run then, half a second after it was heard or before it ran. */
double recorder_code_at(const recorder_code *self, int64_t time_ns);

/* ---- takes: each begins on a frame of the time code, if one runs, and has it from there on ----
 */

/* [frame] A take from the next sample on, or from from_ns of the samples' clock, which is past by
 * then: all that is performed is recorded. 0: no such instant. */
void recorder_take_next(recorder *self, const writer_slate *slate, int64_t from_ns);
/* [frame] Ends the take behind the last sample. */
CHECKED mrt_result recorder_take_end(recorder *self, error *err);
/* [frame] Of what was performed between two instants of the samples' clock, up to the last sample.
 */
CHECKED mrt_result recorder_keep(recorder *self, int64_t from_ns, int64_t to_ns,
                                 const writer_slate *slate, int64_t *out_take, error *err);
int64_t recorder_take(const recorder *self); /* that is being, or was last, recorded; 0: none */
int64_t recorder_performance(const recorder *self); /* that goes on; 0: before the first sample */
bool recorder_take_is_open(const recorder *self);   /* a sample of it was recorded */
int64_t recorder_show_ns(const recorder *self, int64_t time_ns);
/* [any] The first thing that went wrong since the start, in one line; "" nothing did. */
const char *recorder_problem(const recorder *self);
writer *recorder_writer(recorder *self); /* for marks, sound and its status */

/* [frame] Before a step is performed, and after. */
void recorder_step(recorder *self, const sample_step *s);
void recorder_performed(recorder *self, const sample_step *s);
/* [frame] Before the next sample: a re-zero was asked for and granted. */
void recorder_rezero(recorder *self, uint32_t side);
/* [frame] Before the next sample: another version of the mapping performs from it on. identity: as
 * recorder_plugin_identity. */
void recorder_change_mapping(recorder *self, const char *identity);
/* [frame] A device went or came. */
void recorder_incident(recorder *self, uint32_t from, const input_incident *what);

/* ---- what a show remembers of plugins and faces, so that a change is noticed later: names,
 * versions, and the SHA-256 of files; for whoever makes performances without a recorder, too ----
 */

/* "id version sha256": see take.h; "-" for a library that cannot be read. To be freed; NULL: no
 * memory. */
char *recorder_plugin_identity(const plugin_list *plugins, const mrt_plugin_type *type);
/* Into rig, rig_hash, mesh_hash, rig_json and unit_mm; what was there is freed. */
CHECKED mrt_result recorder_face_identity(take_performance *out, const face_file *file,
                                          const char *path, double unit_mm, error *err);
/* The values that a mapping's parameters have now. */
void recorder_param_values(take_performance *out, const instance *mapping);

#endif
