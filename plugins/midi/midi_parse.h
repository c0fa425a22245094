/* midi/midi_parse.h - MIDI 1.0 bytes, from anybody and cut anywhere, become events: running status,
 * real-time bytes inside of other messages, 14-bit controllers, NRPN, time code. Leaves out who
 * sends and what an event is for. Pure functions on one struct; no allocation. */
#ifndef PLUGINS_MIDI_PARSE_H
#define PLUGINS_MIDI_PARSE_H
#include <stdbool.h>
#include <stdint.h>

enum {
    MIDI_CHANNELS = 16,
    MIDI_CONTROLLERS = 120,
    MIDI_NUMBERS = 1 << 14,
    MIDI_ALL_CHANNELS = 255
};

typedef enum midi_kind {
    MIDI_NONE = 0,
    MIDI_CONTROLLER,    /* number 0..119; 0..1 */
    MIDI_BEND,          /* -1..1 */
    MIDI_NOTE,          /* number 0..127; velocity 0..1, 0 when it is let go */
    MIDI_PRESSURE,      /* of the whole channel; 0..1 */
    MIDI_KEY_PRESSURE,  /* number 0..127; 0..1 */
    MIDI_NRPN,          /* number 0..16383; 0..1 */
    MIDI_PROGRAM,       /* 0..127 */
    MIDI_TIMECODE,      /* frames from 00:00:00:00, counted, below 2592000 */
    MIDI_TIMECODE_RATE, /* its frames a second, negative for drop-frame */
    MIDI_RELEASE,       /* of `channel`, or MIDI_ALL_CHANNELS: notes are off, pedals up */
    MIDI_SENSING        /* the sender is there; from now on it says so every 300 ms */
} midi_kind;

typedef struct midi_event {
    midi_kind kind;
    uint8_t channel; /* 0..15; 0 of MIDI_TIMECODE and MIDI_SENSING */
    uint16_t number;
    float value;
    float rate; /* of MIDI_TIMECODE: the value of MIDI_TIMECODE_RATE, which is no event */
} midi_event;

/* What a channel's controllers 6 and 38 are about. */
typedef struct midi_entry {
    enum { MIDI_ENTRY_NONE = 0, MIDI_ENTRY_RPN, MIDI_ENTRY_NRPN } kind;
    uint8_t high, low; /* of the number */
    uint8_t coarse;    /* of the value */
    bool has_low;      /* this channel sends the low seven bits too */
} midi_entry;

typedef struct midi_parser {
    bool is_fine;          /* controllers 32..63 are the low seven bits of 0..31 */
    uint8_t status;        /* 0: none; data bytes are then skipped */
    uint8_t data[2], have; /* of the message that is coming */
    uint8_t coarse[MIDI_CHANNELS][32];
    uint32_t has_low[MIDI_CHANNELS]; /* bit n: controller n has sent low bits */
    midi_entry entry[MIDI_CHANNELS];
    uint8_t quarter[8], next_quarter;      /* of a time code */
    uint8_t exclusive[8], exclusive_count; /* how a system exclusive message begins */
} midi_parser;

/* Values 0..127 of the controllers 0..31 are coarse when `is_fine` is set. */
void midi_parser_init(midi_parser *self, bool is_fine);
/* True: the byte ends a message that says something. */
bool midi_take(midi_parser *self, uint8_t byte, midi_event *out);

#endif
