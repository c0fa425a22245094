#include "midi_parse.h"

#include <string.h>

/* Status bytes, with the channel in the low four bits. */
enum {
    NOTE_OFF = 0x80,
    NOTE_ON = 0x90,
    KEY_PRESSURE = 0xa0,
    CONTROLLER = 0xb0,
    PROGRAM = 0xc0,
    PRESSURE = 0xd0,
    BEND = 0xe0,
    EXCLUSIVE = 0xf0,
    QUARTER_FRAME = 0xf1,
    SONG_POSITION = 0xf2,
    SONG_SELECT = 0xf3,
    EXCLUSIVE_END = 0xf7,
    REAL_TIME = 0xf8,
    SENSING = 0xfe,
    RESET = 0xff
};

/* Controllers with a special meaning. */
enum {
    DATA_ENTRY = 6,
    DATA_ENTRY_LOW = 38,
    NRPN_LOW = 98,
    NRPN_HIGH = 99,
    RPN_LOW = 100,
    RPN_HIGH = 101,
    ALL_SOUND_OFF = 120,
    RESET_CONTROLLERS = 121,
    ALL_NOTES_OFF = 123
};

void midi_parser_init(midi_parser *self, bool is_fine)
{
    memset(self, 0, sizeof *self);
    self->is_fine = is_fine;
}

static float of_7_bits(uint8_t value)
{
    return (float)value / 127.0f;
}

static float of_14_bits(uint8_t high, uint8_t low)
{
    return (float)(high << 7 | low) / 16383.0f;
}

static bool give(midi_event *out, midi_kind kind, uint8_t channel, uint16_t number, float value)
{
    *out = (midi_event){kind, channel, number, value, 0.0f};
    return true;
}

/* ---- time code ---- */

/* The rate is in bits 5 and 6 of hour. */
static bool give_time(uint8_t hour, uint8_t minute, uint8_t second, uint8_t frame, float ahead,
                      midi_event *out)
{
    static const int32_t rates[4] = {24, 25, 30, 30};
    const uint8_t kind = hour >> 5 & 3;
    const int32_t rate = rates[kind], hours = hour & 31;
    if (hours > 23 || minute > 59 || second > 59 || frame >= rate)
        return false;
    const bool is_drop = kind == 2;
    const int32_t minutes = hours * 60 + minute, dropped = 2 * (minutes - minutes / 10);
    const int32_t frames = (minutes * 60 + second) * rate + frame - (is_drop ? dropped : 0);
    const int32_t day = 86400 * rate - (is_drop ? 2 * (1440 - 144) : 0);
    const float now = (float)frames + ahead;
    (void)give(out, MIDI_TIMECODE, 0, 0, now < (float)day ? now : now - (float)day);
    out->rate = is_drop ? (float)(-30000.0 / 1001.0) : (float)rate;
    return true;
}

/* Eight messages in order, a quarter of a frame apart, make one time: the time of the first
 * message. */
static bool take_quarter(midi_parser *self, uint8_t data, midi_event *out)
{
    const uint8_t piece = data >> 4;
    const uint8_t *q = self->quarter;
    if (piece != self->next_quarter && piece != 0) {
        self->next_quarter = 0;
        return false;
    }
    self->quarter[piece] = data & 15;
    self->next_quarter = (uint8_t)((piece + 1) % 8);
    return piece == 7 &&
           give_time((uint8_t)(q[7] << 4 | q[6]), (uint8_t)(q[5] << 4 | q[4]),
                     (uint8_t)(q[3] << 4 | q[2]), (uint8_t)(q[1] << 4 | q[0]), 1.75f, out);
}

/* f0 7f DEVICE 01 01 HOUR MINUTE SECOND FRAME f7 */
static bool end_exclusive(const midi_parser *self, midi_event *out)
{
    const uint8_t *e = self->exclusive;
    return self->exclusive_count == 8 && e[0] == 0x7f && e[2] == 1 && e[3] == 1 &&
           give_time(e[4], e[5], e[6], e[7], 0.0f, out);
}

/* ---- controllers ---- */

static bool take_entry(midi_parser *self, uint8_t channel, uint8_t number, uint8_t value,
                       midi_event *out)
{
    midi_entry *entry = &self->entry[channel];
    const uint16_t parameter = (uint16_t)(entry->high << 7 | entry->low);
    if (entry->kind != MIDI_ENTRY_NRPN)
        return false;
    if (number == DATA_ENTRY) {
        entry->coarse = value;
        return give(out, MIDI_NRPN, channel, parameter,
                    entry->has_low ? of_14_bits(value, 0) : of_7_bits(value));
    }
    entry->has_low = true;
    return give(out, MIDI_NRPN, channel, parameter, of_14_bits(entry->coarse, value));
}

/* 7f 7f: no parameter selected. */
static void choose_entry(midi_entry *entry, uint8_t number, uint8_t value)
{
    const bool is_nrpn = number == NRPN_LOW || number == NRPN_HIGH;
    entry->kind = is_nrpn ? MIDI_ENTRY_NRPN : MIDI_ENTRY_RPN;
    if (number == NRPN_HIGH || number == RPN_HIGH)
        entry->high = value;
    else
        entry->low = value;
    entry->coarse = 0;
    if (entry->high == 127 && entry->low == 127)
        entry->kind = MIDI_ENTRY_NONE;
}

static bool take_fine(midi_parser *self, uint8_t channel, uint8_t number, uint8_t value,
                      midi_event *out)
{
    uint8_t *coarse = self->coarse[channel];
    const uint32_t bit = 1u << (number & 31);
    if (number < 32) {
        coarse[number] = value;
        return give(out, MIDI_CONTROLLER, channel, number,
                    self->has_low[channel] & bit ? of_14_bits(value, 0) : of_7_bits(value));
    }
    self->has_low[channel] |= bit;
    number -= 32;
    return give(out, MIDI_CONTROLLER, channel, number, of_14_bits(coarse[number], value));
}

static bool take_controller(midi_parser *self, uint8_t channel, uint8_t number, uint8_t value,
                            midi_event *out)
{
    if (number >= NRPN_LOW && number <= RPN_HIGH) {
        choose_entry(&self->entry[channel], number, value);
        return false;
    }
    if ((number == DATA_ENTRY || number == DATA_ENTRY_LOW) &&
        self->entry[channel].kind != MIDI_ENTRY_NONE)
        return take_entry(self, channel, number, value, out);
    if (number == ALL_SOUND_OFF || number == RESET_CONTROLLERS || number >= ALL_NOTES_OFF)
        return give(out, MIDI_RELEASE, channel, 0, 0);
    if (number >= MIDI_CONTROLLERS)
        return false;
    if (self->is_fine && number < 64)
        return take_fine(self, channel, number, value, out);
    return give(out, MIDI_CONTROLLER, channel, number, of_7_bits(value));
}

/* ---- messages ---- */

static uint8_t data_count(uint8_t status)
{
    if (status < EXCLUSIVE)
        return (status & 0xf0) == PROGRAM || (status & 0xf0) == PRESSURE ? 1 : 2;
    return status == SONG_POSITION ? 2 : status == QUARTER_FRAME || status == SONG_SELECT ? 1 : 0;
}

static bool take_message(midi_parser *self, midi_event *out)
{
    const uint8_t channel = self->status & 15, a = self->data[0], b = self->data[1];
    switch (self->status & 0xf0) {
    case NOTE_OFF:
        return give(out, MIDI_NOTE, channel, a, 0);
    case NOTE_ON:
        return give(out, MIDI_NOTE, channel, a, of_7_bits(b));
    case KEY_PRESSURE:
        return give(out, MIDI_KEY_PRESSURE, channel, a, of_7_bits(b));
    case CONTROLLER:
        return take_controller(self, channel, a, b, out);
    case PROGRAM:
        return give(out, MIDI_PROGRAM, channel, 0, (float)a);
    case PRESSURE:
        return give(out, MIDI_PRESSURE, channel, 0, of_7_bits(a));
    case BEND:
        return give(out, MIDI_BEND, channel, 0, 2.0f * of_14_bits(b, a) - 1.0f);
    default:
        return self->status == QUARTER_FRAME && take_quarter(self, a, out);
    }
}

static bool take_data(midi_parser *self, uint8_t byte, midi_event *out)
{
    if (self->status == EXCLUSIVE) {
        if (self->exclusive_count < sizeof self->exclusive)
            self->exclusive[self->exclusive_count] = byte;
        if (self->exclusive_count <= sizeof self->exclusive)
            ++self->exclusive_count;
        return false;
    }
    if (self->status == 0)
        return false;
    self->data[self->have++] = byte;
    if (self->have < data_count(self->status))
        return false;
    self->have = 0;
    bool says = take_message(self, out);
    if (self->status >= EXCLUSIVE) /* running status applies only to channel messages */
        self->status = 0;
    return says;
}

static bool take_status(midi_parser *self, uint8_t byte, midi_event *out)
{
    const bool ends = byte == EXCLUSIVE_END && self->status == EXCLUSIVE;
    bool says = ends && end_exclusive(self, out);
    self->have = self->exclusive_count = 0;
    self->status = byte == EXCLUSIVE || data_count(byte) > 0 ? byte : 0;
    return says;
}

bool midi_parser_add_byte(midi_parser *self, uint8_t byte, midi_event *out)
{
    if (byte == SENSING)
        return give(out, MIDI_SENSING, 0, 0, 0);
    if (byte == RESET) {
        midi_parser_init(self, self->is_fine);
        return give(out, MIDI_RELEASE, MIDI_ALL_CHANNELS, 0, 0);
    }
    if (byte >= REAL_TIME)
        return false;
    return byte >= NOTE_OFF ? take_status(self, byte, out) : take_data(self, byte, out);
}
