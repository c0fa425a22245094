/* show/writer.h - everything that is measured, into a show, while it happens. The recording thread
 * hands over and never waits; a thread of the writer's commits it, at most 40 ms later; another one
 * sees to it that it reaches the disk, at most 1 s later. So a program that is killed loses what
 * it did in the last 100 ms, but no sample that has arrived; a power cut the last seconds; and
 * neither damages what was there before.
 *
 * A disk that is full, or gone for a while, loses nothing as long as memory lasts: what is not
 * written is held (options.memory_bytes, which is hours of two gloves) and written when it can be.
 *
 * Times given to the writer are of the host's clock, as in mrt_sample; the show keeps them as UTC
 * (take.h). What a thread says takes effect in the order in which it is said.
 * [main] one thread; [frame] no allocation and no lock, so any thread may; samples, events and
 * checkpoints are given by one thread; [any] at any time. */
#ifndef MAROTTE_TAKE_WRITER_H
#define MAROTTE_TAKE_WRITER_H
#include "show/show.h"

typedef struct writer writer;

enum { WRITER_CHECKPOINTS = 4 };

typedef struct writer_options {
    int64_t utc_ns, monotonic_ns; /* both clocks, read together */
    const char *program;          /* "marotte 0.1.0" */
    int64_t journal_ns;           /* how far back what no take holds on to is kept; 0: 30 min */
    size_t memory_bytes;          /* to hold while the disk is full; 0: 64 MiB */
    size_t checkpoint_bytes;      /* of the largest checkpoint; 0: there will be none */
} writer_options;

/* Starts a session. The show must be writable, and outlive the writer; it may be used meanwhile. */
CHECKED mrt_result writer_start(writer **out, show *s, const writer_options *options, error *err);
/* Writes what is left, ends what is being recorded at its last sample, and frees the writer
 * whatever comes back. < 0: some of it could not be written; writer_flush() first to be asked
 * before. */
CHECKED mrt_result writer_stop(writer *self, error *err);

int64_t writer_show_ns(const writer *self, int64_t time_ns); /* [any] host clock to show time */

/* ---- [main]: copies what it is given ---- */

/* Fills in the id of the track. */
CHECKED mrt_result writer_add_track(writer *self, take_track *track, error *err);

/* Ends the one before, if any: one performance goes on at a time. Its tracks have been added. Fills
 * in its id. Takes that are being recorded show it from time_ns on. */
CHECKED mrt_result writer_begin_performance(writer *self, take_performance *performance,
                                            int64_t time_ns, error *err);
CHECKED mrt_result writer_end_performance(writer *self, int64_t time_ns, error *err);

/* ---- [frame]: what happens now and then ---- */

/* So many of these wait for the writer's thread at most, which looks every 40 ms; < 0: it does not
 * keep up, and this one was not taken. */
enum { WRITER_WAITING_MAX = 512, WRITER_WAITING_TEXTS_MAX = 32 };

/* As writer_add_track; the texts of the track are these: they were made ready before. */
CHECKED mrt_result writer_follow_track(writer *self, take_track *track, take_texts *texts,
                                       error *err);
CHECKED mrt_result writer_end_track(writer *self, int64_t track, error *err);
/* As writer_begin_performance; the texts of the performance are these, but for its mapping, which
 * may be another one, of at most TAKE_IDENTITY. */
CHECKED mrt_result writer_follow_performance(writer *self, take_performance *performance,
                                             take_texts *texts, int64_t time_ns, error *err);

typedef struct writer_slate {
    const char *scene, *shot; /* NULL: "" */
    uint32_t number;          /* 0: the next one of scene and shot */
    int64_t over, over_at_ns; /* the take that it is performed over, and where; 0: none */
    double fps;               /* of the time code that it begins at; 0: none */
    int64_t timecode_frame;
    bool is_drop_frame;
} writer_slate;
/* A take exists from here on: it is one even if the program is killed now. */
CHECKED mrt_result writer_take_begin(writer *self, int64_t time_ns, const writer_slate *slate,
                                     int64_t *out_take, error *err);
CHECKED mrt_result writer_take_end(writer *self, int64_t take, int64_t time_ns, error *err);
/* Makes a take of what nobody recorded: as far back as the journal goes. */
CHECKED mrt_result writer_keep(writer *self, int64_t from_ns, int64_t to_ns,
                               const writer_slate *slate, int64_t *out_take, error *err);
CHECKED mrt_result writer_mark(writer *self, int64_t time_ns, const char *text, error *err);

/* ---- any thread but [frame] ---- */

/* A piece of the audio that show_audio_create() made; one thread for an audio. */
CHECKED mrt_result writer_audio(writer *self, int64_t audio, int64_t time_ns, const void *frames,
                                size_t size, error *err);
/* Waits until all that was given before this call is committed; < 0: why it is not, for now. */
CHECKED mrt_result writer_flush(writer *self, error *err);

/* ---- [frame]: all the time; one thread ---- */

/* The time is the step's, values are as measured; times are not descending within a track, finite.
 * A sample that cannot be taken is counted as lost. */
void writer_sample(writer *self, int64_t track, const mrt_sample *sample);
void writer_event(writer *self, const take_event *event);
/* A buffer of checkpoint_bytes to fill, NULL: none is free now, leave this one out. */
void *writer_checkpoint_buffer(writer *self);
/* Hands the buffer over. */
void writer_checkpoint(writer *self, int64_t performance, int64_t time_ns, uint32_t version,
                       void *buffer, size_t size);

/* ---- what arrives, and waits to be performed: a kill does not lose it. Each input has a place for
 * its newest samples; who opens the show next records those that were not performed, in steps as
 * the frame thread would have made (step_rule.h) ---- */

/* [main] A place for one input; WRITER_NO_PLACE: all are taken, and a kill may lose some. */
enum { WRITER_NO_PLACE = UINT32_MAX };
uint32_t writer_arrivals_open(writer *self);
/* [main] Nobody gives any more. */
void writer_arrivals_close(writer *self, uint32_t place);
/* [the input's thread] number: of the input's samples, +1 each; version: of its channels. Never
 * waits. */
void writer_arrived(writer *self, uint32_t place, uint32_t number, uint32_t version,
                    const mrt_sample *sample);
/* [frame] Samples of that version are of this track. Before writer_sample. */
void writer_arrivals_follow(writer *self, uint32_t place, int64_t track, uint32_t version);
/* [frame] Samples up to this number, without it, were given by writer_sample. */
void writer_arrivals_performed(writer *self, uint32_t place, uint32_t number);

/* ---- [any] ---- */

typedef enum writer_state {
    WRITER_OK = 0,
    WRITER_WAITING, /* the disk is full or does not answer: held in memory, tried again and again */
    WRITER_FAILED /* the file is damaged or cannot be written any more: the same, but somebody must
                     see to it: show_rescue(), another show */
} writer_state;
typedef struct writer_status {
    writer_state state;
    bool is_missing;           /* show_is_missing() */
    uint32_t backlog;          /* samples that are not committed */
    uint64_t committed_count;  /* samples since writer_start that are in the show */
    uint64_t lost_count;       /* samples since then that were lost: memory ran out too */
    uint64_t lost_event_count; /* events, changes of parameters above all */
    size_t held_bytes;         /* of memory, waiting to be written */
    int64_t committed_ns;      /* host clock of the newest sample that is committed */
} writer_status;
writer_status writer_status_of(const writer *self);
/* [main] What is wrong, in one line for the person in front of it; "" when nothing is. */
void writer_message(writer *self, char *out, size_t capacity);

#endif
