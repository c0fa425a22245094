/* stage/sound/sound.h - the sound of a take: played in time with the transport, and recorded from
 * the microphone when armed. What is played keeps to the samples' clock (the host's monotonic one),
 * not to the device's: see sound_follow.h. No device, a busy one, or one that is unplugged stops
 * nothing: the status has a sentence. Nothing here waits for a device, but sound_destroy(), 3 s at
 * most. Leaves out which take has which sound: that is an edit (edit.h). [main] unless marked. */
#ifndef MAROTTE_STAGE_SOUND_H
#define MAROTTE_STAGE_SOUND_H
#include "stage/sound/sound_device.h"
#include "stage/sound/sound_follow.h"
#include "stage/sound/sound_record.h"
#include "stage/playback/transport.h"
#include "show/take.h"

typedef struct sound sound;

typedef struct sound_settings {
    show *show;                   /* of the takes; for recording it must be writable; outlives it */
    log_queue *log;               /* may be NULL */
    const sound_backend *backend; /* NULL: PortAudio; else it outlives it */
    const char *out_name, *in_name; /* a part of a device's name; NULL: the default one */
    sound_threads threads;
} sound_settings;

CHECKED mrt_result sound_create(sound **out, const sound_settings *settings, error *err);
void sound_destroy(sound *self); /* NULL is fine */
/* Call it some times a second: looks after what only [main] may do. */
void sound_update(sound *self);
/* With SOUND_BY_CALLER: one round of each of its threads. */
void sound_work(sound *self, int64_t now_ns);

/* ---- playing ---- */

/* What is to be heard from now on, also after an edit of it; audio 0, or NULL: nothing. */
CHECKED mrt_result sound_load(sound *self, const take_audio *audio, error *err);

/* From now on a loudspeaker is there for the beats of what moves, also where no sound is loaded. */
void sound_want_beats(sound *self);

/* [frame] Call it with every frame, or with every change: only changes of more than half a
 * millisecond are changes. The motion's revision and edition do not matter.
 * Never waits. */
void sound_move(sound *self, const sound_motion *motion);
/* What a transport does from clock_ns on; it need not be told again when a loop begins anew. */
sound_motion sound_motion_of(const transport *t, int64_t clock_ns);
/* So long before it is heard a frame must be given to the device: a transport that sets out this
 * far in the future loses nothing of the beginning. */
int64_t sound_lead_ns(sound *self);

/* What is counted here tests alone ask for. */
typedef struct sound_play_status {
    sound_device_status device;
    bool is_loaded, is_heard;
    double drift_ppm;                     /* of the device: + it runs fast */
    uint64_t click_count;                 /* beats that were heard */
    uint64_t spliced_count;               /* single frames left out or repeated */
    uint32_t jumped_count;                /* corrections of more than 5 ms at once */
    uint32_t starved_count, broken_count; /* gaps: the disk was late; the device ran dry */
    char text[256]; /* why it is silent though something is loaded, or what is damaged; or "" */
} sound_play_status;
void sound_play_look(sound *self, sound_play_status *out);

/* ---- recording ---- */

/* From now on the microphone is recorded into the writer's show; channel_count 0: one. */
CHECKED mrt_result sound_arm(sound *self, writer *w, uint32_t channel_count, error *err);
/* Ends it; what was recorded is with the writer once sound_is_armed() is false. */
void sound_disarm(sound *self);
bool sound_is_armed(const sound *self); /* until all of it is with the writer */

typedef struct sound_in_status {
    sound_device_status device;
    sound_record_status record; /* of the newest recording */
} sound_in_status;
void sound_in_look(sound *self, sound_in_status *out);

#endif
