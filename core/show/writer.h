/* show/writer.h - records samples into a show while they are performed. The recording thread only
 * queues data and never waits. A thread of the writer commits the queue within 40 ms, and another
 * one syncs it to the disk within 1 s. A kill loses the commands of the last 100 ms, but no sample
 * that has arrived. A power cut loses the last seconds. Neither damages older data. Leaves out the
 * format of the file (show.h, writer_store.h).
 *
 * While the disk is full or missing, unwritten data is held in memory (options.memory_bytes, hours
 * of two gloves) and written later.
 *
 * Times for the writer are of the host clock, as in mrt_sample; the show stores them as UTC
 * (take.h). The calls of one thread take effect in order. [main] one thread; [frame] any thread,
 * since these functions neither allocate nor lock, but samples, events and checkpoints must come
 * from one thread; [any] any thread at any time. */
#ifndef MAROTTE_TAKE_WRITER_H
#define MAROTTE_TAKE_WRITER_H
#include "show/show.h"

typedef struct writer writer;

enum { WRITER_CHECKPOINTS = 4 };

typedef struct writer_options {
    int64_t utc_ns, monotonic_ns; /* both clocks, read together */
    const char *program;          /* "marotte 0.2.0" */
    int64_t journal_ns;           /* how long data is kept that no take needs; 0: 30 min */
    size_t memory_bytes;     /* limit of memory that holds data while the disk is full; 0: 64 MiB */
    size_t checkpoint_bytes; /* size of the largest checkpoint; 0: no checkpoints */
} writer_options;

/* Starts a session. The show must be writable and outlive the writer, and may be used meanwhile. */
CHECKED mrt_result writer_start(writer **out, show *s, const writer_options *options, error *err);
/* Writes all remaining data, ends everything that is being recorded at its last sample, and always
 * frees the writer. < 0: some data could not be written. Call writer_flush() first if the user
 * should decide before. */
CHECKED mrt_result writer_stop(writer *self, error *err);

int64_t writer_show_ns(const writer *self, int64_t time_ns); /* [any] host clock to show time */

/* ---- [main]: arguments are copied ---- */

/* Adds a track and sets its id. */
CHECKED mrt_result writer_add_track(writer *self, take_track *track, error *err);

/* Begins a performance and ends the previous one, since only one runs at a time. Sets its id. Its
 * tracks must have been added. Takes that are being recorded show it from time_ns on. */
CHECKED mrt_result writer_begin_performance(writer *self, take_performance *performance,
                                            int64_t time_ns, error *err);
CHECKED mrt_result writer_end_performance(writer *self, int64_t time_ns, error *err);

/* ---- [frame]: occasional calls ---- */

/* Maximum number of these calls in the queue; the writer's thread empties it every 40 ms. < 0: the
 * queue is full, and the call had no effect. */
enum { WRITER_WAITING_MAX = 512, WRITER_WAITING_TEXTS_MAX = 32 };

/* As writer_add_track, with texts that were prepared before. */
CHECKED mrt_result writer_follow_track(writer *self, take_track *track, take_texts *texts,
                                       error *err);
CHECKED mrt_result writer_end_track(writer *self, int64_t track, error *err);
/* As writer_begin_performance, with texts that were prepared before. The mapping may differ from
 * that of the texts, and has at most TAKE_IDENTITY bytes. */
CHECKED mrt_result writer_follow_performance(writer *self, take_performance *performance,
                                             take_texts *texts, int64_t time_ns, error *err);

typedef struct writer_slate {
    const char *scene, *shot; /* NULL: "" */
    uint32_t number;          /* 0: the next number of scene and shot */
    int64_t over, over_at_ns; /* the take that it is performed over, and the time there; 0: none */
    double fps;               /* frame rate of its start time code; 0: none */
    int64_t timecode_frame;
    bool is_drop_frame;
} writer_slate;
/* Begins a take. The take is kept even if the program is killed immediately afterwards. */
CHECKED mrt_result writer_take_begin(writer *self, int64_t time_ns, const writer_slate *slate,
                                     int64_t *out_take, error *err);
CHECKED mrt_result writer_take_end(writer *self, int64_t take, int64_t time_ns, error *err);
/* Creates a take from the journal, as far back as the journal reaches. */
CHECKED mrt_result writer_keep(writer *self, int64_t from_ns, int64_t to_ns,
                               const writer_slate *slate, int64_t *out_take, error *err);
CHECKED mrt_result writer_mark(writer *self, int64_t time_ns, const char *text, error *err);

/* ---- any thread but [frame] ---- */

/* Appends a piece of the audio that show_audio_create() created. One thread per audio. */
CHECKED mrt_result writer_audio(writer *self, int64_t audio, int64_t time_ns, const void *frames,
                                size_t size, error *err);
/* Waits until all earlier calls are committed. < 0: the reason why they are not committed yet. */
CHECKED mrt_result writer_flush(writer *self, error *err);

/* ---- [frame]: frequent calls; one thread ---- */

/* Records a sample. Its time is that of the step, its values are the measured ones. Times do not
 * descend within a track, and values are finite. A sample that does not fit is counted as lost. */
void writer_sample(writer *self, int64_t track, const mrt_sample *sample);
void writer_event(writer *self, const take_event *event);
/* Returns a buffer of checkpoint_bytes to fill. NULL: no buffer is free, so skip this checkpoint.
 */
void *writer_checkpoint_buffer(writer *self);
/* Queues the filled buffer. */
void writer_checkpoint(writer *self, int64_t performance, int64_t time_ns, uint32_t version,
                       void *buffer, size_t size);

/* ---- arrivals: samples that wait to be performed survive a kill. Each input has a place for its
 * newest samples. The next program that opens the show records those that were not performed, in
 * the steps that the frame thread would have made (step_rule.h) ---- */

/* [main] Opens a place for one input. WRITER_NO_PLACE: all places are in use, and a kill may lose
 * its samples. */
enum { WRITER_NO_PLACE = UINT32_MAX };
uint32_t writer_arrivals_open(writer *self);
/* [main] Closes a place after the last call of writer_arrived. */
void writer_arrivals_close(writer *self, uint32_t place);
/* [input] Stores a sample that has arrived. number: of the input's samples, +1 each; version: of
 * its channels. Never waits. */
void writer_arrived(writer *self, uint32_t place, uint32_t number, uint32_t version,
                    const mrt_sample *sample);
/* [frame] Assigns the samples of that version to a track. Call it before writer_sample. */
void writer_arrivals_follow(writer *self, uint32_t place, int64_t track, uint32_t version);
/* [frame] Marks the samples below this number as recorded by writer_sample. */
void writer_arrivals_performed(writer *self, uint32_t place, uint32_t number);

/* ---- [any] ---- */

typedef enum writer_state {
    WRITER_OK = 0,
    WRITER_WAITING, /* the disk is full or does not respond: data is held in memory, and writing is
                       retried */
    WRITER_FAILED /* the file is damaged or cannot be written: as WRITER_WAITING, but the user must
                     act: show_rescue(), another show */
} writer_state;
typedef struct writer_status {
    writer_state state;
    bool is_missing;          /* show_is_missing() */
    uint32_t backlog;         /* samples that are not committed yet */
    uint64_t committed_count; /* samples since writer_start that are in the show */
    uint64_t lost_count;      /* samples since writer_start that were lost because memory ran out */
    uint64_t lost_event_count; /* lost events, mostly changes of parameters */
    size_t held_bytes;         /* memory that waits to be written */
    int64_t committed_ns;      /* host clock of the newest sample that is committed */
} writer_status;
writer_status writer_status_of(const writer *self);
/* [main] Describes the problem in one line for the user; "" if there is none. */
void writer_message(writer *self, char *out, size_t capacity);

#endif
