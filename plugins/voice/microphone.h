/* voice/microphone.h - where sound comes from: a microphone of ALSA's, by name, or a pipe with
 * samples in it. 16 bit, one channel, MICROPHONE_RATE frames a second. The one place that knows
 * libasound's PCM; where marotte was built without it only pipes are there. Leaves out what is done
 * with the sound. One thread at a time. */
#ifndef PLUGINS_VOICE_MICROPHONE_H
#define PLUGINS_VOICE_MICROPHONE_H
#include <marotte/plugin.h>

enum { MICROPHONE_RATE = 48000, MICROPHONE_REASON = 320 };

typedef struct microphone microphone;

/* "": what the system calls default; with a '/' a pipe (mkfifo), else a name of ALSA's ("hw:1"),
 * of which others may hold what is not shared. NULL: out_reason says why. */
microphone *microphone_open(const char *address, char out_reason[MICROPHONE_REASON]);
void microphone_close(microphone *self); /* NULL is fine */
/* Waits until there is something to read, or span_ns have passed; false: it is gone. */
bool microphone_wait(microphone *self, int64_t span_ns);
/* How many frames have come, without waiting: 0 none; -1: it is gone. */
int microphone_read(microphone *self, int16_t *out, uint32_t capacity);

/* As mrt_devices.list. */
uint32_t microphone_list(mrt_device *out, uint32_t capacity);

#endif
