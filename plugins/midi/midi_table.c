#include "midi_table.h"

#include <stdio.h>
#include <string.h>

enum { USUAL_CONTROLLERS = 32, USUAL_BENDS = 9 };
enum { SUSTAIN = 64, SOSTENUTO = 66, SOFT = 67 };

/* ---- one control ---- */

static const struct {
    const char *name;
    bool is_numbered;
    uint16_t most; /* of the number */
    float low, high;
} kinds[] = {
    [MIDI_CONTROLLER] = {"cc", true, MIDI_CONTROLLERS - 1, 0, 1},
    [MIDI_BEND] = {"bend", false, 0, -1, 1},
    [MIDI_NOTE] = {"note", true, 127, 0, 1},
    [MIDI_PRESSURE] = {"pressure", false, 0, 0, 1},
    [MIDI_KEY_PRESSURE] = {"key_pressure", true, 127, 0, 1},
    [MIDI_NRPN] = {"nrpn", true, MIDI_NUMBERS - 1, 0, 1},
    [MIDI_PROGRAM] = {"program", false, 0, 0, 127},
    [MIDI_TIMECODE] = {"timecode", false, 0, 0, 2592000},
    [MIDI_TIMECODE_RATE] = {"timecode_rate", false, 0, -30, 30},
};

static midi_control control_of(midi_kind kind, uint32_t channel, uint32_t number)
{
    return (midi_control)kind << 24 | channel << 16 | number;
}

static midi_kind kind_of(midi_control control)
{
    return (midi_kind)(control >> 24);
}

midi_control midi_control_of(const midi_event *event)
{
    return control_of(event->kind, event->channel, event->number);
}

void midi_control_name(midi_control control, char out[MIDI_NAME])
{
    const midi_kind kind = kind_of(control);
    const uint32_t channel = control >> 16 & 15, number = control & 0xffff;
    const char *name = kinds[kind].name;
    char prefix[sizeof "ch16."] = "";
    if (channel > 0)
        (void)snprintf(prefix, sizeof prefix, "ch%u.", channel + 1);
    if (kind == MIDI_BEND)
        (void)snprintf(out, MIDI_NAME, "%s.%u", name, channel + 1);
    else if (kinds[kind].is_numbered)
        (void)snprintf(out, MIDI_NAME, "%s%.12s.%u", prefix, name, number);
    else
        (void)snprintf(out, MIDI_NAME, "%s%s", prefix, name);
}

/* Removes a number of at most five digits from the text. */
static bool take_number(const char **text, const char *end, uint32_t *out)
{
    const char *begin = *text;
    for (*out = 0; *text < end && **text >= '0' && **text <= '9' && *text - begin < 5; ++*text)
        *out = *out * 10 + (uint32_t)(**text - '0');
    return *text > begin;
}

static bool take_channel(const char **text, const char *end, uint32_t *out)
{
    const char *at = *text + 2;
    *out = 0;
    if (end - *text < 4 || strncmp(*text, "ch", 2) != 0)
        return true;
    if (!take_number(&at, end, out) || *out < 1 || *out > MIDI_CHANNELS || at == end || *at != '.')
        return false;
    *out -= 1;
    *text = at + 1;
    return true;
}

bool midi_control_parse(midi_control *out, const char *text, size_t length)
{
    const char *end = text + length;
    uint32_t channel, number = 0;
    if (!take_channel(&text, end, &channel))
        return false;
    for (midi_kind kind = MIDI_CONTROLLER; kind <= MIDI_TIMECODE_RATE; ++kind) {
        const size_t size = strlen(kinds[kind].name);
        const char *at = text + size;
        const bool wants_number = kinds[kind].is_numbered || kind == MIDI_BEND;
        if ((size_t)(end - text) < size || strncmp(text, kinds[kind].name, size) != 0 ||
            (wants_number && (at == end || *at++ != '.' || !take_number(&at, end, &number))) ||
            at != end)
            continue;
        if (kind == MIDI_BEND && number >= 1 && number <= MIDI_CHANNELS && channel == 0)
            *out = control_of(kind, number - 1, 0);
        else if (kind != MIDI_BEND && number <= kinds[kind].most)
            *out = control_of(kind, channel, number);
        else
            return false;
        return kind < MIDI_TIMECODE || channel == 0;
    }
    return false;
}

/* ---- the table ---- */

/* Returns the index; -1: not found. */
static int index_of(const midi_control *controls, uint32_t count, midi_control control)
{
    for (uint32_t i = 0; i < count; ++i)
        if (controls[i] == control)
            return (int)i;
    return -1;
}

int midi_table_find(const midi_table *self, midi_control control)
{
    return index_of(self->control, self->count, control);
}

int midi_table_find_received(const midi_table *self, midi_control control)
{
    return index_of(self->heard, self->heard_count, control);
}

bool midi_table_add(midi_table *self, midi_control control)
{
    if (self->heard_count == MRT_MAX_CHANNELS || midi_table_find_received(self, control) >= 0)
        return false;
    self->heard[self->heard_count++] = control;
    return true;
}

static void add(midi_table *self, midi_control control)
{
    if (self->count == MRT_MAX_CHANNELS || midi_table_find(self, control) >= 0)
        return;
    uint32_t at = self->count++;
    for (; at > 0 && self->control[at - 1] > control; --at)
        self->control[at] = self->control[at - 1];
    self->control[at] = control;
}

static uint32_t semantic_of(midi_control control, bool has_pedals)
{
    static const uint32_t pedal[] = {SUSTAIN, SOSTENUTO, SOFT};
    for (uint32_t i = 0; has_pedals && i < 3; ++i)
        if (control == control_of(MIDI_CONTROLLER, 0, pedal[i]))
            return MRT_CH_PEDAL + i;
    if (kind_of(control) >= MIDI_TIMECODE)
        return MRT_CH_TIMECODE + (kind_of(control) - MIDI_TIMECODE);
    return MRT_CH_OTHER;
}

void midi_table_build(midi_table *self, bool has_pedals)
{
    self->count = 0;
    for (uint32_t i = 0; i < self->heard_count; ++i)
        add(self, self->heard[i]);
    for (uint32_t i = 0; has_pedals && i < 4; ++i)
        if (semantic_of(control_of(MIDI_CONTROLLER, 0, SUSTAIN + i), true) != MRT_CH_OTHER)
            add(self, control_of(MIDI_CONTROLLER, 0, SUSTAIN + i));
    for (uint32_t i = 0; i < USUAL_BENDS; ++i)
        add(self, control_of(MIDI_BEND, i, 0));
    for (uint32_t i = 0; i < USUAL_CONTROLLERS; ++i)
        add(self, control_of(MIDI_CONTROLLER, 0, i));
    for (uint32_t i = 0; i < self->count; ++i) {
        const midi_kind kind = kind_of(self->control[i]);
        midi_control_name(self->control[i], self->name[i]);
        self->channel[i] = (mrt_channel){self->name[i],
                                         kind == MIDI_TIMECODE        ? "frames"
                                         : kind == MIDI_TIMECODE_RATE ? "1/s"
                                                                      : "",
                                         semantic_of(self->control[i], has_pedals),
                                         MRT_NO_HAND,
                                         kinds[kind].low,
                                         kinds[kind].high};
    }
}

/* ---- as text ---- */

size_t midi_table_write(const midi_table *self, char *out, size_t capacity)
{
    size_t used = 0;
    for (uint32_t i = 0; i < self->heard_count; ++i) {
        char name[MIDI_NAME];
        midi_control_name(self->heard[i], name);
        int size = snprintf(out + used, capacity - used, "%s\n", name);
        if (size < 0 || (size_t)size >= capacity - used)
            break;
        used += (size_t)size;
    }
    return used;
}

void midi_table_read(midi_table *self, const char *text, size_t size)
{
    for (const char *end = text + size; text < end;) {
        const char *line = text;
        const char *stop = memchr(text, '\n', (size_t)(end - text));
        text = stop ? stop + 1 : end;
        midi_control control;
        if (midi_control_parse(&control, line, (size_t)((stop ? stop : end) - line)))
            (void)midi_table_add(self, control);
    }
}
