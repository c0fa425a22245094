/* stage/sound/sound_record.h - the microphone into a show: blocks go through a ring to a thread
 * that writes them in pieces of some 30 ms, 24 bits each sample, with the time of each piece's
 * first frame as the device's clock is known by then (sound_clock.h). What is lost on the way is
 * counted, and the times behind it say how long it was. Leaves out the device (sound_device.h) and
 * which take gets the sound. [main] unless marked. */
#ifndef MAROTTE_STAGE_SOUND_RECORD_H
#define MAROTTE_STAGE_SOUND_RECORD_H
#include "stage/sound/sound_device.h"
#include "show/writer.h"

typedef struct sound_record sound_record;

typedef struct sound_record_status {
    int64_t audio;        /* 0: nothing has come yet */
    int64_t frame_count;  /* given to the writer */
    uint64_t lost_frames; /* of which no one knows what they were */
    uint32_t gap_count;
    double drift_ppm; /* + the device runs fast */
    float peak;       /* 0..1, since the last look */
    char text[256];   /* what went wrong, or "" */
} sound_record_status;

/* The show is the writer's; both outlive it. */
CHECKED mrt_result sound_record_create(sound_record **out, show *s, writer *w,
                                       sound_threads threads, error *err);
/* No block comes any more: writes what is left. NULL is fine. */
void sound_record_destroy(sound_record *self);
/* Makes the sound's row in the show once something has come, and marks in it where something is
 * lost. Call it often: the ring holds some ten seconds. */
void sound_record_update(sound_record *self);
void sound_record_look(sound_record *self, sound_record_status *out);
/* Writes what has come by now. No block must come meanwhile or later. */
void sound_record_end(sound_record *self);

/* [opener] and [device]: for sound_user. A device that comes back must be as it was. */
mrt_result sound_record_opened(void *data, const sound_stream *stream, error *err);
void sound_record_block(void *data, const sound_block *block);

/* [recorder] One round of the thread. */
void sound_record_work(sound_record *self);

#endif
