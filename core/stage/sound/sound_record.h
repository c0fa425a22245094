/* stage/sound/sound_record.h - records the microphone into a show. Blocks go through a ring to a
 * thread that writes pieces of about 30 ms with 24 bits per sample. Each piece has the time of its
 * first frame, from the clock of the device (sound_clock.h). Lost frames are counted, and the times
 * of the later pieces show the length of the gap. Leaves out the device (sound_device.h) and which
 * take gets the sound. [main] unless marked. */
#ifndef MAROTTE_STAGE_SOUND_RECORD_H
#define MAROTTE_STAGE_SOUND_RECORD_H
#include "stage/sound/sound_device.h"
#include "show/writer.h"

typedef struct sound_record sound_record;

typedef struct sound_record_status {
    int64_t audio;        /* 0: no sound received yet */
    int64_t frame_count;  /* frames passed to the writer */
    uint64_t lost_frames; /* number of missing frames */
    uint32_t gap_count;
    double drift_ppm; /* > 0: the device runs fast */
    float peak;       /* 0..1, since the last sound_record_read_status */
    char text[256];   /* error; "": none */
} sound_record_status;

/* `s` must be the show of the writer. Both must outlive the recording. */
CHECKED mrt_result sound_record_create(sound_record **out, show *s, writer *w,
                                       sound_threads threads, error *err);
/* Call after the last block: writes the rest. Accepts NULL. */
void sound_record_destroy(sound_record *self);
/* Creates the row of the sound in the show after the first block, and sets a mark at each gap. Call
 * it often: the ring holds about ten seconds. */
void sound_record_update(sound_record *self);
void sound_record_read_status(sound_record *self, sound_record_status *out);
/* Writes everything received so far. Blocks must not arrive during or after this call. */
void sound_record_end(sound_record *self);

/* [opener] and [device]: for sound_user. A reconnected device must have the same rate and
 * channels. */
mrt_result sound_record_opened(void *data, const sound_stream *stream, error *err);
void sound_record_block(void *data, const sound_block *block);

/* [recorder] Does one round of the thread. */
void sound_record_work(sound_record *self);

#endif
