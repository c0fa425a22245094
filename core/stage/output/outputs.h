/* stage/output/outputs.h - the running face outputs: each new face is sent to up to OUTPUTS_MAX
 * plugins. One thread reads the newest face from the slot of the frame thread. Each output has its
 * own thread, which runs the plugin or waits for its process (isolate_output.h). Only the newest
 * face counts everywhere, and the frame thread never waits. An output that fails is opened again
 * every second, and its error is logged once. Leaves out the data formats (plugins). */
#ifndef MAROTTE_STAGE_OUTPUT_OUTPUTS_H
#define MAROTTE_STAGE_OUTPUT_OUTPUTS_H
#include "base/log.h"
#include "stage/mapping/isolate.h"
#include "stage/mapping/plugins.h"
#include "stage/output/board.h"

typedef struct outputs outputs;
enum { OUTPUTS_MAX = 8 };

typedef struct outputs_settings { /* everything they point to must outlive the outputs */
    const plugin_list *plugins;
    log_queue *log;
    isolate_which isolation;
} outputs_settings;

/* ---- [main] ---- */

CHECKED mrt_result outputs_create(outputs **out, const outputs_settings *settings, error *err);
void outputs_destroy(outputs *self); /* accepts NULL */
/* Adds an output: "PLUGIN[:ADDRESS][,key=value]...", where PLUGIN is an id or a short name. It is
 * opened on its own thread, so a receiver that does not exist yet is not an error. An isolated
 * output is opened again after its library was rebuilt. */
CHECKED mrt_result outputs_add(outputs *self, const char *text, error *err);
void outputs_remove(outputs *self, uint32_t index); /* later outputs move down by one index */
uint32_t outputs_count(const outputs *self);
/* Sets the face to send. NULL: none. Holds a reference to the board, and no other code may read
 * from it. Afterwards the file of the previous board is no longer needed. */
void outputs_show(outputs *self, face_board *board);
/* Returns the distance between the face and its 52 weights, see face_channels. 0: unknown. */
double outputs_residual_mm(outputs *self);

typedef enum output_state {
    OUTPUT_OPENS = 0,
    OUTPUT_SENDS,
    OUTPUT_NO_RECEIVER, /* running, but nobody receives the face */
    OUTPUT_FAILED       /* opened again every second */
} output_state;

typedef struct output_status {
    output_state state;
    const char *text; /* text of outputs_add; valid until it is removed */
    const char *name; /* name of the plugin */
    bool is_isolated;
    char trouble[200];     /* error as one line; "": none */
    uint64_t sent;         /* number of sent faces, including repeated ones */
    uint64_t replaced;     /* number of new faces that were replaced before they were sent */
    double rate_hz;        /* over about the last second; 0: none sent */
    double p50_ms, p99_ms; /* from the time of a sample to the end of send, over the last 4 096 new
                              faces; 0: none yet */
} output_status;
void outputs_status(outputs *self, uint32_t index, output_status *out);

/* ---- [frame], or [main] without a frame thread ---- */

/* Returns whether at least one output exists. If not, do not publish. */
bool outputs_are_wanted(const outputs *self); /* NULL: false */
/* Returns true once after an output was added that needs the current face, although the face has
 * not changed. */
bool outputs_pop_request(outputs *self); /* NULL: false */
/* Copies the face that the composer has drawn to the board. */
void outputs_publish(outputs *self, face_board *board, composer *of, int64_t time_ns,
                     int64_t take_ns);

#endif
