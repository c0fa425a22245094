/* stage/output/outputs.h - face outputs at work: the face that is performed goes, each time that it
 * is new, to up to OUTPUTS_MAX plugins that send it on. A thread takes the newest face from
 * the frame thread's slot; each output has a thread of its own, on which its plugin runs, or waits
 * for its own process (isolate_output.h). Newest wins everywhere and the frame thread never waits.
 * An output that fails is opened again each second; it says why once. Leaves out what is sent
 * (plugins). */
#ifndef MAROTTE_STAGE_OUTPUT_OUTPUTS_H
#define MAROTTE_STAGE_OUTPUT_OUTPUTS_H
#include "base/log.h"
#include "stage/mapping/isolate.h"
#include "stage/mapping/plugins.h"
#include "stage/output/board.h"

typedef struct outputs outputs;
enum { OUTPUTS_MAX = 8 };

typedef struct outputs_settings { /* all must outlive it */
    const plugin_list *plugins;
    log_queue *log;
    isolate_which isolation;
} outputs_settings;

/* ---- [main] ---- */

CHECKED mrt_result outputs_create(outputs **out, const outputs_settings *settings, error *err);
void outputs_destroy(outputs *self); /* NULL is fine */
/* "PLUGIN[:ADDRESS][,key=value]...", PLUGIN by id or short name. What it opens is opened on its own
 * thread: that it is not there yet is no error. One in a process of its own is taken anew when its
 * library has been built. */
CHECKED mrt_result outputs_add(outputs *self, const char *text, error *err);
void outputs_remove(outputs *self, uint32_t index); /* those behind it move up */
uint32_t outputs_count(const outputs *self);
/* What is sent from now on; NULL: nothing. The board is kept, and nobody else may take from it; the
 * file of the one before is not needed any more. */
void outputs_show(outputs *self, face_board *board);
/* How far the face is from what the 52 weights say of it, face_channels; 0: nothing is known. */
double outputs_residual_mm(outputs *self);

typedef enum output_state {
    OUTPUT_OPENS = 0,
    OUTPUT_SENDS,
    OUTPUT_UNHEARD, /* nobody is there who takes it */
    OUTPUT_FAILED   /* it is tried again each second */
} output_state;

typedef struct output_status {
    output_state state;
    const char *text; /* as it was added; until it is removed */
    const char *name; /* of its plugin */
    bool is_isolated;
    char trouble[200];     /* one line, why it has failed; "" */
    uint64_t sent;         /* faces, the repeated ones too */
    uint64_t replaced;     /* that were new, and replaced by a newer one before they were sent */
    double rate_hz;        /* over the last second or so; 0: nothing */
    double p50_ms, p99_ms; /* from a sample's time to the end of send, of the last 4 096 that were
                              new; 0: none yet */
} output_status;
void outputs_status(outputs *self, uint32_t index, output_status *out);

/* ---- [frame], or [main] where there is no frame thread ---- */

/* Whether there is any: else publishing costs nothing. */
bool outputs_are_wanted(const outputs *self); /* NULL: false */
/* True once after one came that is to have the face that is shown, although it stays as it is. */
bool outputs_ask_again(outputs *self); /* NULL: false */
/* The face that the composer shows, drawn, as put into the board that is shown. */
void outputs_publish(outputs *self, face_board *board, composer *of, int64_t time_ns,
                     int64_t take_ns);

#endif
