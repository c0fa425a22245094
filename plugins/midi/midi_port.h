/* midi/midi_port.h - source and destination of MIDI bytes: a port of the ALSA sequencer, or a
 * kernel device (/dev/snd/midiC1D0, /dev/midi1), a serial line or a pipe. Several programs can
 * share a sequencer port, and its ports belong to devices or programs, which can appear and
 * disappear. The only file that uses libasound's sequencer. If marotte was built without it, or the
 * system has no sequencer, only the other sources are available. Leaves out the meaning of the
 * bytes. One thread at a time. */
#ifndef PLUGINS_MIDI_PORT_H
#define PLUGINS_MIDI_PORT_H
#include <marotte/plugin.h>

enum { MIDI_REASON = 320, MIDI_PORT_NAME = 64 };

typedef struct midi_port {
    int descriptor;       /* to poll; -1: closed */
    struct midi_seq *seq; /* NULL: not a sequencer port */
    bool can_write;       /* motors can be driven */
} midi_port;

void midi_port_init(midi_port *self); /* closed */
/* Opens a port. wanted: with a '/' a path; else a port's name ("nanoKONTROL2", or a part of it) or
 * its numbers ("20:0"). "": the first device; if none exists, any source that the user connects to
 * the port "marotte". Returns false on failure, with the reason in out_reason. out_name: the port's
 * name, "" for a pipe and while no device is connected. */
bool midi_port_open(midi_port *self, const char *wanted, char out_name[MIDI_PORT_NAME],
                    char out_reason[MIDI_REASON]);
void midi_port_close(midi_port *self); /* can be called twice */
/* Reads the available bytes without waiting. Returns their number, or -1 if the port was lost. */
int midi_port_read(midi_port *self, uint8_t *out, size_t capacity);
/* Returns false if the bytes cannot all be written now. */
bool midi_port_write(midi_port *self, const uint8_t *bytes, size_t size);

/* Like mrt_devices.list. */
uint32_t midi_port_list(mrt_device *out, uint32_t capacity);

#endif
