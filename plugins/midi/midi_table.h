/* midi/midi_table.h - which controls of a MIDI device are channels, under which names. A device
 * does not say what it has, so the table holds the usual controls and those that were heard, which
 * are kept as text from one time to the next. Pure functions on one struct; no allocation. */
#ifndef PLUGINS_MIDI_TABLE_H
#define PLUGINS_MIDI_TABLE_H
#include "midi_parse.h"

#include <marotte/plugin.h>

/* A control by its kind, channel and number; what orders controls. */
typedef uint32_t midi_control;
enum { MIDI_NAME = 24, MIDI_TABLE_TEXT = MRT_MAX_CHANNELS * MIDI_NAME };

midi_control midi_control_of(const midi_event *event);
/* "cc.7", of another MIDI channel than the first "ch2.cc.7"; "bend.3" is always channel 3's. */
void midi_control_name(midi_control control, char out[MIDI_NAME]);
/* False: it is no such name. */
bool midi_control_parse(midi_control *out, const char *text, size_t length);

typedef struct midi_table {
    uint32_t count; /* of the channels */
    midi_control control[MRT_MAX_CHANNELS];
    char name[MRT_MAX_CHANNELS][MIDI_NAME];
    mrt_channel channel[MRT_MAX_CHANNELS];
    uint32_t heard_count; /* of what is to be kept, in order */
    midi_control heard[MRT_MAX_CHANNELS];
} midi_table;

/* False: it is known already, or there is no room. The channels change with midi_table_build. */
bool midi_table_hear(midi_table *self, midi_control control);
/* Channels of all that was heard and, as far as there is room, of the usual controls: controllers
 * 0 to 31 and the bends of the first nine channels. `pedals`: sustain, sostenuto and soft pedal are
 * pedals 1 to 3. */
void midi_table_build(midi_table *self, bool has_pedals);
/* -1: it is no channel. */
int midi_table_find(const midi_table *self, midi_control control);
/* Its index in `heard`; -1: it was not heard. */
int midi_table_heard(const midi_table *self, midi_control control);

/* What was heard, a name a line; bytes that are no such text are passed over. */
size_t midi_table_write(const midi_table *self, char *out, size_t capacity);
void midi_table_read(midi_table *self, const char *text, size_t size);

#endif
