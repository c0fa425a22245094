/* midi/midi_port.h - where MIDI bytes come from and go to: a port of ALSA's sequencer, which
 * several programs share, which come and go, and which programs make as well as devices; or a
 * device of the kernel (/dev/snd/midiC1D0, /dev/midi1), a serial line or a pipe. The one place that
 * knows libasound's sequencer; where marotte was built without it, or the system has none, only the
 * others are there. Leaves out what the bytes mean. One thread at a time. */
#ifndef PLUGINS_MIDI_PORT_H
#define PLUGINS_MIDI_PORT_H
#include <marotte/plugin.h>

enum { MIDI_REASON = 320, MIDI_PORT_NAME = 64 };

typedef struct midi_port {
    int descriptor;       /* to wait for; -1: closed */
    struct midi_seq *seq; /* NULL: none of the sequencer's */
    bool can_write;       /* motors can be driven */
} midi_port;

void midi_port_init(midi_port *self); /* closed */
/* wanted: with a '/' a path; else a port's name ("nanoKONTROL2", or a part of it) or its numbers
 * ("20:0"). "": the first device; while there is none, whatever the person connects to the port
 * "marotte". False: out_reason says why. out_name: of the port, "" of a pipe and when there is none
 * yet. */
bool midi_port_open(midi_port *self, const char *wanted, char out_name[MIDI_PORT_NAME],
                    char out_reason[MIDI_REASON]);
void midi_port_close(midi_port *self); /* again is fine */
/* How many bytes have come, without waiting: 0 none; -1: it is gone. */
int midi_port_read(midi_port *self, uint8_t *out, size_t capacity);
/* False: not now, or not all. */
bool midi_port_write(midi_port *self, const uint8_t *bytes, size_t size);

/* As mrt_devices.list. */
uint32_t midi_port_list(mrt_device *out, uint32_t capacity);

#endif
