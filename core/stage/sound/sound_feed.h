/* stage/sound/sound_feed.h - reads the sound of a take ahead of time into the ring from which
 * sound_follow plays it. It starts at the position of the transport, follows loops, and restarts
 * when the sound or the motion changes. It opens the show with an own handle and has its own
 * thread. [main] unless marked. */
#ifndef MAROTTE_STAGE_SOUND_FEED_H
#define MAROTTE_STAGE_SOUND_FEED_H
#include "stage/sound/sound_device.h"
#include "stage/sound/sound_follow.h"
#include "show/take.h"

typedef struct sound_feed sound_feed;

/* `follow` and the board must outlive it. */
CHECKED mrt_result sound_feed_create(sound_feed **out, const char *show_path, ring *packets,
                                     const sound_board *board, const sound_follow *follow,
                                     sound_threads threads, error *err);
void sound_feed_destroy(sound_feed *self); /* accepts NULL */
/* Sets the sound, which must have the same channels. Then set the edition of the board to
 * `edition`. */
void sound_feed_load(sound_feed *self, const take_audio *audio, uint32_t edition);
/* Copies the error of the newest load; "": none. */
void sound_feed_trouble(sound_feed *self, error *out);
/* [feeder] Fills the free part of the ring. */
void sound_feed_work(sound_feed *self);

#endif
