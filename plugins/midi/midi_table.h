/* midi/midi_table.h - table of the controls of a MIDI device that are channels, with their names. A
 * device does not report its controls, so the table holds the usual controls and those received so
 * far, which are stored as text between sessions. Pure functions on one struct; no allocation. */
#ifndef PLUGINS_MIDI_TABLE_H
#define PLUGINS_MIDI_TABLE_H
#include "midi_parse.h"

#include <marotte/plugin.h>

/* A control: its kind, channel and number. Also the sort key of controls. */
typedef uint32_t midi_control;
enum { MIDI_NAME = 24, MIDI_TABLE_TEXT = MRT_MAX_CHANNELS * MIDI_NAME };

midi_control midi_control_of(const midi_event *event);
/* Writes "cc.7", or "ch2.cc.7" for a MIDI channel other than the first; "bend.3" is always of
 * channel 3. */
void midi_control_name(midi_control control, char out[MIDI_NAME]);
/* Returns false if the text is not such a name. */
bool midi_control_parse(midi_control *out, const char *text, size_t length);

typedef struct midi_table {
    uint32_t count; /* of the channels */
    midi_control control[MRT_MAX_CHANNELS];
    char name[MRT_MAX_CHANNELS][MIDI_NAME];
    mrt_channel channel[MRT_MAX_CHANNELS];
    uint32_t heard_count; /* number of controls to store, sorted */
    midi_control heard[MRT_MAX_CHANNELS];
} midi_table;

/* Adds a control. Returns false if it is known already or the table is full. Does not change the
 * channels: see midi_table_build. */
bool midi_table_add(midi_table *self, midi_control control);
/* Builds the channels of all received controls and, while there is space, of the usual ones:
 * controllers 0 to 31 and the bends of the first nine channels. has_pedals: sustain, sostenuto and
 * soft pedal are pedals 1 to 3. */
void midi_table_build(midi_table *self, bool has_pedals);
/* Returns the channel's index; -1: not a channel. */
int midi_table_find(const midi_table *self, midi_control control);
/* Returns the index in `heard`; -1: not received so far. */
int midi_table_find_received(const midi_table *self, midi_control control);

/* Write and read the received controls as text, one name per line. Reading ignores other bytes. */
size_t midi_table_write(const midi_table *self, char *out, size_t capacity);
void midi_table_read(midi_table *self, const char *text, size_t size);

#endif
