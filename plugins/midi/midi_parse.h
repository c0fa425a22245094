/* midi/midi_parse.h - parser of MIDI 1.0 bytes, from any sender and split at any place: running
 * status, real-time bytes inside other messages, 14-bit controllers, NRPN, time code. Leaves out
 * the sender and the use of an event. Pure functions on one struct; no allocation. */
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
    MIDI_NOTE,          /* number 0..127; velocity 0..1, 0 at release */
    MIDI_PRESSURE,      /* of the whole channel; 0..1 */
    MIDI_KEY_PRESSURE,  /* number 0..127; 0..1 */
    MIDI_NRPN,          /* number 0..16383; 0..1 */
    MIDI_PROGRAM,       /* 0..127 */
    MIDI_TIMECODE,      /* frames counted from 00:00:00:00, below 2592000 */
    MIDI_TIMECODE_RATE, /* its frames per second, negative for drop-frame */
    MIDI_RELEASE,       /* all notes off and pedals up, of `channel` or MIDI_ALL_CHANNELS */
    MIDI_SENSING /* active sensing: after the first one, the sender repeats it every 300 ms */
} midi_kind;

typedef struct midi_event {
    midi_kind kind;
    uint8_t channel; /* 0..15; 0 for MIDI_TIMECODE and MIDI_SENSING */
    uint16_t number;
    float value;
    float rate; /* with MIDI_TIMECODE: the value of MIDI_TIMECODE_RATE, which is not sent as an
                   event */
} midi_event;

/* The parameter that a channel's controllers 6 and 38 set. */
typedef struct midi_entry {
    enum { MIDI_ENTRY_NONE = 0, MIDI_ENTRY_RPN, MIDI_ENTRY_NRPN } kind;
    uint8_t high, low; /* of the number */
    uint8_t coarse;    /* of the value */
    bool has_low;      /* this channel sends the low seven bits too */
} midi_entry;

typedef struct midi_parser {
    bool is_fine;          /* controllers 32..63 are the low seven bits of 0..31 */
    uint8_t status;        /* 0: none; data bytes are then skipped */
    uint8_t data[2], have; /* of the incomplete message */
    uint8_t coarse[MIDI_CHANNELS][32];
    uint32_t has_low[MIDI_CHANNELS]; /* bit n: controller n has sent low bits */
    midi_entry entry[MIDI_CHANNELS];
    uint8_t quarter[8], next_quarter;      /* of a time code */
    uint8_t exclusive[8], exclusive_count; /* first bytes of a system exclusive message */
} midi_parser;

/* Values 0..127 of the controllers 0..31 are coarse when `is_fine` is set. */
void midi_parser_init(midi_parser *self, bool is_fine);
/* Adds a byte. Returns true if it completes a message with an event. */
bool midi_parser_add_byte(midi_parser *self, uint8_t byte, midi_event *out);

#endif
