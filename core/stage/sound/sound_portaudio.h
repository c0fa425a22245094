/* stage/sound/sound_portaudio.h - the sound devices of this computer, by PortAudio. Times are of
 * the host's clock whatever clock PortAudio's own are of. What ALSA and JACK have to say on their
 * way is not printed. Any thread; openers wait for each other. */
#ifndef MAROTTE_STAGE_SOUND_PORTAUDIO_H
#define MAROTTE_STAGE_SOUND_PORTAUDIO_H
#include "stage/sound/sound_device.h"

CHECKED mrt_result sound_portaudio_create(sound_backend *out, error *err);
void sound_portaudio_destroy(sound_backend *backend); /* accepts zeroed; its streams first */

#endif
