/* perform_mapping.h - the mapping of a performance: in a process of its own or not, and reloaded
 * when its library is rebuilt. [main] */
#ifndef MAROTTE_UI_PERFORM_MAPPING_H
#define MAROTTE_UI_PERFORM_MAPPING_H
#include "facts.h"
#include "perform_options.h"
#include "stage/perform/performer.h"
#include "stage/mapping/plugins.h"
#include "stage/take/recorder.h"
#include "stage/perform/reload.h"

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
    perform_isolation isolation;
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

#endif
