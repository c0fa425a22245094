/* midi/midi_raw.h - a MIDI device of the kernel (/dev/snd/midiC1D0, /dev/midi1), a serial line or a
 * pipe: bytes as they come. Leaves out what they mean. One thread at a time. */
#ifndef PLUGINS_MIDI_RAW_H
#define PLUGINS_MIDI_RAW_H
#include <marotte/plugin.h>

enum { MIDI_RAW_REASON = 320, MIDI_RAW_NAME = 64 };

/* -1: out_reason says why. out_name: the device's, "" of a pipe. out_can_write: motors can be
 * driven. A pipe goes on when its writer ends and another one comes. */
int midi_raw_open(const char *path, char out_name[MIDI_RAW_NAME], bool *out_can_write,
                  char out_reason[MIDI_RAW_REASON]);
void midi_raw_close(int descriptor);
/* How many bytes have come, without waiting: 0 none; -1: the device is gone. */
int midi_raw_read(int descriptor, uint8_t *out, size_t capacity);
/* False: not now, or not all. */
bool midi_raw_write(int descriptor, const uint8_t *bytes, size_t size);

/* The n-th device of this computer, from 0; false: there are not so many. */
bool midi_raw_find(uint32_t n, char out_path[32]);
/* As mrt_devices.list. */
uint32_t midi_raw_list(mrt_device *out, uint32_t capacity);

#endif
