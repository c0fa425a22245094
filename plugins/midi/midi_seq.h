/* midi/midi_seq.h - the one place that knows libasound: ports of ALSA's sequencer, which several
 * programs share, which come and go, and which programs make as well as devices. Bytes in and out;
 * leaves out what they mean. Where marotte was built without libasound, or the system has no
 * sequencer, nothing is there. One thread at a time. */
#ifndef PLUGINS_MIDI_SEQ_H
#define PLUGINS_MIDI_SEQ_H
#include <marotte/plugin.h>

enum { MIDI_REASON = 320, MIDI_PORT_NAME = 64 };

typedef struct midi_seq midi_seq;

bool midi_seq_is_there(void);
/* Joins as the port "marotte" and takes what the wanted port sends: its name ("nanoKONTROL2", or a
 * part of it) or numbers ("20:0"). "": the first device; while there is none, whatever the person
 * connects. NULL: out_reason says why. out_name: of the port, "" when there is none yet. */
midi_seq *midi_seq_open(const char *wanted, char out_name[MIDI_PORT_NAME],
                        char out_reason[MIDI_REASON]);
void midi_seq_close(midi_seq *self); /* NULL is fine */
int midi_seq_descriptor(const midi_seq *self);
/* How many bytes have come, without waiting: 0 none; -1: the port is gone. */
int midi_seq_read(midi_seq *self, uint8_t *out, size_t capacity);
/* Back to the port, if it listens. False: not now. */
bool midi_seq_write(midi_seq *self, const uint8_t *bytes, size_t size);

/* As mrt_devices.list. */
uint32_t midi_seq_list(mrt_device *out, uint32_t capacity);

#endif
