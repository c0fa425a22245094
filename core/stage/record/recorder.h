/* stage/record/recorder.h - records a performance into a show while it happens. Its inputs become
 * tracks; its mapping and parameters become a performance. Samples are recorded before any other
 * code reads them. From time to time the recorder stores a state, from which the performance can be
 * continued later. Leaves out how bytes reach the disk (show/writer.h) and the code that performs
 * the steps. [main] unless marked; [frame] is the one thread that performs. */
#ifndef MAROTTE_STAGE_RECORDER_H
#define MAROTTE_STAGE_RECORDER_H
#include "stage/input/input.h"
#include "stage/mapping/plugins.h"
#include "stage/perform/performer.h"
#include "show/writer.h"

typedef struct recorder recorder;

typedef struct recorder_settings {
    show *show; /* writable; must outlive the recorder */
    const plugin_list *plugins;
    log_queue *log;
    instance_clock clock; /* clock of the inputs; CLOCK_VIRTUAL: the recorder waits for the writer
                             and never drops a sample */
    int64_t journal_ns;   /* 0: 30 min */
    /* the performance */
    input *const *inputs;
    const char *const *input_text; /* such as "log:demo.csv,end=8" */
    uint32_t input_count;
    const char *calibration[2]; /* left, right: JSON; NULL: none */
    layer *layer;               /* layer that performs; its parameters are set */
    const patch *patch;         /* current patch of the layer; NULL: none */
    instance *mapping;    /* mapping of the layer; NULL: read from the layer, allowed only before a
                             thread performs */
    performer *performer; /* performer whose face only this layer moves, for stored states. NULL:
                             other layers move the face too, and no states are stored. */
    const char *face_path;
    const face_file *face;
    double unit_mm;        /* for a mesh without a rig; 0: guessed */
    double hand_length_mm; /* of both hands; 0: from their calibrations */
    uint32_t rezero_pedal;
    /* minimum size of the buffer for a state, for a larger face later; 0: none */
    size_t state_bytes;
} recorder_settings;

/* Starts a session. It records everything, limited by the length of the journal. */
CHECKED mrt_result recorder_start(recorder **out, const recorder_settings *settings, error *err);
/* Writes the rest and frees the recorder. The inputs must still exist. Returns < 0 if something
 * could not be written; the recorder is freed then too. */
CHECKED mrt_result recorder_stop(recorder *self, error *err);

/* ---- changes of the performance ---- */

/* Prepares another cast: the members of `now` that describe the performance (show, log and clock
 * are ignored). An input that stays keeps its track if the calibrations are the same. */
typedef struct recorder_cast recorder_cast;
CHECKED mrt_result recorder_prepare(recorder *self, const recorder_settings *now,
                                    recorder_cast **out, error *err);
/* [frame] Begins another performance of that cast with the next sample. Returns the old cast for
 * recorder_dismiss. A take that is being recorded contains both performances. */
recorder_cast *recorder_change(recorder *self, recorder_cast *cast);
/* [frame] Call after the last sample. Stops watching the layer's parameters, so that the layer can
 * be destroyed. */
void recorder_unwatch(recorder *self);
/* Frees a cast that recorder_change returned or that was never used. Its inputs must still
 * exist. */
void recorder_dismiss(recorder *self, recorder_cast *cast);

/* ---- external time code: the newest MRT_CH_TIMECODE of an input ---- */

typedef struct recorder_code {
    int64_t time_ns; /* time of that frame, in the clock of the samples; 0: no time code received */
    int64_t since_ns; /* start of the current run without a break */
    double frame;     /* frames since 00:00:00:00 */
    double fps;
    bool is_drop;
} recorder_code;
recorder_code recorder_latest_code(const recorder *self);
/* Returns the frame of the time code at a time. < 0: the time code does not run then. It counts as
 * stopped half a second after its last sample, and before its start. */
double recorder_code_at(const recorder_code *self, int64_t time_ns);

/* ---- takes: each begins on a frame of the time code if one runs, and stores that time code
 * ---- */

/* [frame] Begins a take with the next sample. from_ns (clock of the samples) may set an earlier
 * start, because everything is recorded. 0: no earlier start. */
void recorder_take_next(recorder *self, const writer_slate *slate, int64_t from_ns);
/* [frame] Ends the take after the last sample. */
CHECKED mrt_result recorder_take_end(recorder *self, error *err);
/* [frame] Makes a take of a past span in the clock of the samples, up to the last sample. */
CHECKED mrt_result recorder_keep(recorder *self, int64_t from_ns, int64_t to_ns,
                                 const writer_slate *slate, int64_t *out_take, error *err);
int64_t recorder_take(const recorder *self); /* current or last recorded take; 0: none */
int64_t
recorder_performance(const recorder *self); /* current performance; 0: before the first sample */
bool recorder_take_is_open(const recorder *self); /* true: at least one sample is recorded */
int64_t recorder_show_ns(const recorder *self, int64_t time_ns);
/* [any] Returns the first error since the start as one line. "": none. */
const char *recorder_problem(const recorder *self);
writer *recorder_writer(recorder *self); /* for marks, sound and its status */

/* [frame] Call recorder_step before a step is performed and recorder_performed after it. */
void recorder_step(recorder *self, const sample_step *s);
void recorder_performed(recorder *self, const sample_step *s);
/* [frame] Call before the next sample: records that a re-zero was granted. */
void recorder_rezero(recorder *self, uint32_t side);
/* [frame] Call before the next sample: another version of the mapping performs from that sample.
 * identity: see recorder_plugin_identity. */
void recorder_change_mapping(recorder *self, const char *identity);
/* [frame] Records that a device was lost or is connected again. */
void recorder_incident(recorder *self, uint32_t from, const input_incident *what);

/* ---- identity of plugins and faces, stored in a show so that later changes are detected:
 * names, versions and the SHA-256 of files. Also for code that writes performances without a
 * recorder ---- */

/* Returns "id version sha256" (see take.h), with "-" for a library that cannot be read. The caller
 * frees it. NULL: out of memory. */
char *recorder_plugin_identity(const plugin_list *plugins, const mrt_plugin_type *type);
/* Sets rig, rig_hash, mesh_hash, rig_json and unit_mm. Frees their old values. */
CHECKED mrt_result recorder_face_identity(take_performance *out, const face_file *file,
                                          const char *path, double unit_mm, error *err);
/* Stores the current parameter values of a mapping. */
void recorder_param_values(take_performance *out, const instance *mapping);

#endif
