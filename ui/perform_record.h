/* perform_record.h - a performance without a window, recorded into a show. [main] */
#ifndef MAROTTE_UI_PERFORM_RECORD_H
#define MAROTTE_UI_PERFORM_RECORD_H
#include "facts.h"
#include "perform_hands.h"
#include "perform_sound.h"
#include "stage/take/recorder.h"

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
