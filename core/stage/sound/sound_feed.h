/* stage/sound/sound_feed.h - reads the sound of a take ahead of its time, into the ring from which
 * sound_follow plays it: from where the transport set out, around loops, anew when either changes.
 * It has a show of its own to read, and a thread. [main] unless marked. */
#ifndef MAROTTE_STAGE_SOUND_FEED_H
#define MAROTTE_STAGE_SOUND_FEED_H
#include "stage/sound/sound_device.h"
#include "stage/sound/sound_follow.h"
#include "show/take.h"

typedef struct sound_feed sound_feed;

/* `follow` and the board outlive it. */
CHECKED mrt_result sound_feed_create(sound_feed **out, const char *show_path, ring *packets,
                                     const sound_board *board, const sound_follow *follow,
                                     sound_threads threads, error *err);
void sound_feed_destroy(sound_feed *self); /* NULL is fine */
/* From now on this, of the same channels: to be said as `edition` of the board. */
void sound_feed_load(sound_feed *self, const take_audio *audio, uint32_t edition);
/* What went wrong with the newest load, or ""; until the next call. */
void sound_feed_trouble(sound_feed *self, error *out);
/* [feeder] Fills the ring as far as there is room. */
void sound_feed_work(sound_feed *self);

#endif
