/* stage/sound/sound.h - the sound of a take: playback in time with the transport, and recording of
 * the microphone while it is armed. Playback follows the clock of the samples (the host's monotonic
 * clock), not the clock of the device; see sound_follow.h. A missing, busy or unplugged device
 * stops nothing: the status has an explanation. Only sound_destroy() waits for a device, at most 3
 * s. Leaves out which sound a take has, which is an edit (edit.h). [main] unless marked. */
#ifndef MAROTTE_STAGE_SOUND_H
#define MAROTTE_STAGE_SOUND_H
#include "stage/sound/sound_device.h"
#include "stage/sound/sound_follow.h"
#include "stage/sound/sound_record.h"
#include "stage/playback/transport.h"
#include "show/take.h"

typedef struct sound sound;

typedef struct sound_settings {
    show *show;     /* show of the takes, which must outlive the sound; writable for recording */
    log_queue *log; /* may be NULL */
    const sound_backend *backend;   /* NULL: PortAudio; otherwise it must outlive the sound */
    const char *out_name, *in_name; /* part of a device's name; NULL: the default device */
    sound_threads threads;
} sound_settings;

CHECKED mrt_result sound_create(sound **out, const sound_settings *settings, error *err);
void sound_destroy(sound *self); /* accepts NULL */
/* Call some times per second: does the work that is allowed only on [main]. */
void sound_update(sound *self);
/* With SOUND_BY_CALLER: does one round of each thread. */
void sound_work(sound *self, int64_t now_ns);

/* ---- playback ---- */

/* Sets the sound to play. Call it again after an edit. audio 0 or NULL: none. */
CHECKED mrt_result sound_load(sound *self, const take_audio *audio, error *err);

/* Keeps a loudspeaker open for the click, even without a sound. */
void sound_want_beats(sound *self);

/* [frame] Call with every frame or after every change. Ignores changes of less than half a
 * millisecond, and the revision and edition of the motion. Never waits. */
void sound_move(sound *self, const sound_motion *motion);
/* Returns the motion of a transport from clock_ns on. It stays valid when a loop repeats. */
sound_motion sound_motion_of(const transport *t, int64_t clock_ns);
/* Returns the time that a frame needs from the device to the loudspeaker. If a transport starts
 * this far in the future, the beginning is complete. */
int64_t sound_lead_ns(sound *self);

/* The counters are for tests. */
typedef struct sound_play_status {
    sound_device_status device;
    bool is_loaded, is_heard;
    double drift_ppm;       /* of the device; > 0: it runs fast */
    uint64_t click_count;   /* number of clicks */
    uint64_t spliced_count; /* single frames that were removed or repeated */
    uint32_t jumped_count;  /* corrections of more than 5 ms */
    /* gaps: the disk was too slow; the device ran out of data */
    uint32_t starved_count, broken_count;
    char text[256]; /* reason why a loaded sound is silent, or which part is damaged; "": none */
} sound_play_status;
void sound_play_read_status(sound *self, sound_play_status *out);

/* ---- recording ---- */

/* Starts to record the microphone into the show of the writer. channel_count 0: one channel. */
CHECKED mrt_result sound_arm(sound *self, writer *w, uint32_t channel_count, error *err);
/* Ends the recording. The writer has all of it when sound_is_armed() returns false. */
void sound_disarm(sound *self);
bool sound_is_armed(const sound *self); /* until the writer has all of the recording */

typedef struct sound_in_status {
    sound_device_status device;
    sound_record_status record; /* of the newest recording */
} sound_in_status;
void sound_in_read_status(sound *self, sound_in_status *out);

#endif
