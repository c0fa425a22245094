/* stage/input/input_inside.h - what an input is made of, for the two files that make it: input.c
 * (made, asked, destroyed) and input_run.c (opened, read, lost and opened again). No other file
 * includes it. */
#ifndef MAROTTE_STAGE_INPUT_INSIDE_H
#define MAROTTE_STAGE_INPUT_INSIDE_H
#include "base/ring.h"
#include "stage/input/channel_table.h"
#include "stage/input.h"

enum { INPUT_VERSIONS = 8, INPUT_RING = 1024, INPUT_INCIDENTS = 64 };

typedef struct input_record {
    mrt_sample sample;
    uint32_t version;
} input_record;

/* A device that is away. The reading thread's. */
typedef struct input_outage {
    int64_t went_ns, next_try_ns;
    uint32_t tries;
    log_once logged; /* every text about it once */
} input_outage;

struct input {
    instance plugin;
    const mrt_input *functions;
    char *address, name[INPUT_NAME];
    bool open; /* the plugin is: [main] until input_start and after input_stop, else the thread's */
    bool has_thread;
    pthread_t thread;
    ring *samples, *incidents; /* input_record, input_incident */
    wake *signal;
    channel_table table[INPUT_VERSIONS]; /* those below version_count never change */
    uint32_t version_count;              /* the reading thread's */
    _Atomic uint32_t version;            /* of the newest samples */
    _Atomic int32_t state;
    _Atomic bool stopping;
    _Atomic uint32_t refused, dropped;
    /* The frame thread's. */
    bool has_pending; /* virtual clock: read ahead by one */
    input_record pending;
    uint32_t peeked_version;
    /* The reading thread's (on a virtual clock: the frame thread's). */
    bool has_last, has_owed, told_time;
    mrt_sample last;   /* delivered since the device was opened */
    input_record owed; /* found no room in the ring: the newest one is never lost */
    int64_t opened_ns, posted_ns;
    int64_t patience_first_ns, patience_later_ns;
    uint32_t hasty_reads; /* in a row that gave nothing and did not wait */
    input_outage outage;
    health_meter meter;
    health_board board;
};

/* [main] before the thread starts, then the reading thread: opens the plugin and takes its channels
 * over as the newest version. */
CHECKED mrt_result input_run_open(input *self, error *err);
/* The thread; data: the input. */
void *input_run(void *data);
/* [frame] Virtual clock: reads until there is a sample or the input is over; false: it is over. */
bool input_run_virtual(input *self, input_record *out);

#endif
