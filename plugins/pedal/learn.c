#include "learn.h"

#include <stdio.h>
#include <string.h>

/* ---- debouncing ---- */

void debounce_reset(debounce *self)
{
    *self = (debounce){0};
    for (int i = 0; i < DEBOUNCE_SWITCHES; ++i)
        self->quiet_until_ns[i] = INT64_MIN;
}

int64_t debounce_due_ns(const debounce *self)
{
    int64_t due_ns = INT64_MAX;
    for (int i = 0; i < DEBOUNCE_SWITCHES; ++i)
        if (self->raw[i] != self->shown[i] && self->quiet_until_ns[i] < due_ns)
            due_ns = self->quiet_until_ns[i];
    return due_ns;
}

bool debounce_settle(debounce *self, int64_t time_ns, int64_t window_ns)
{
    bool changed = false;
    for (int i = 0; i < DEBOUNCE_SWITCHES; ++i) {
        if (self->raw[i] == self->shown[i] || time_ns < self->quiet_until_ns[i])
            continue;
        self->shown[i] = self->raw[i];
        self->quiet_until_ns[i] = time_ns + window_ns;
        changed = true;
    }
    return changed;
}

bool debounce_update(debounce *self, const float value[DEBOUNCE_SWITCHES], uint32_t analogue,
                     int64_t time_ns, int64_t window_ns)
{
    bool changed = false;
    for (int i = 0; i < DEBOUNCE_SWITCHES; ++i) {
        self->raw[i] = value[i];
        if (!(analogue >> i & 1u) || self->shown[i] == value[i])
            continue;
        self->shown[i] = value[i];
        changed = true;
    }
    return debounce_settle(self, time_ns, window_ns) || changed;
}

/* ---- learning ---- */

static const int64_t rest_ns = 1000000000;
static const int64_t patience_ns = 15000000000;
/* Shares of a number's range, in addition to its movement at rest. */
static const double down_way = 0.2, up_way = 0.1;

bool learn_is_running(const learn *self)
{
    return self->stage == LEARN_REST || self->stage == LEARN_WAIT || self->stage == LEARN_DOWN;
}

static void enter(learn *self, learn_stage stage, int64_t until_ns)
{
    self->stage = stage;
    self->until_ns = until_ns;
}

/* ---- watched fields ---- */

static void watch(learn *self, const descriptor_field *where)
{
    if (self->field_count < LEARN_FIELDS)
        self->field[self->field_count++].where = *where;
}

static void watch_bits(learn *self, uint8_t report_id, uint32_t first, uint32_t count)
{
    for (uint32_t bit = first; bit < first + count; ++bit)
        watch(self,
              &(descriptor_field){
                  .report_id = report_id, .bit = (uint16_t)bit, .width = 1, .count = 1, .high = 1});
}

/* Watches axes as they are. In all other fields each bit may be a switch, whatever number they
 * form. */
static void watch_fields(learn *self, const descriptor *fields)
{
    for (uint32_t i = 0; i < fields->field_count; ++i) {
        const descriptor_field *field = &fields->field[i];
        if (describe_is_axis(field))
            watch(self, field);
        else if (!field->is_array && !field->is_relative)
            watch_bits(self, field->report_id, field->bit, field->width);
    }
}

void learn_start(learn *self, const layout *of, const descriptor *fields, int64_t now_ns)
{
    memset(self, 0, sizeof *self);
    self->found = (layout){.source = LAYOUT_OF_LEARNING,
                           .vendor = of->vendor,
                           .product = of->product,
                           .interface_number = of->interface_number,
                           .endpoint = of->endpoint};
    memcpy(self->found.name, of->name, sizeof self->found.name);
    if (fields && fields->field_count > 0) {
        (void)describe_keys(&self->found, fields); /* found.key_count is 0 if it has none */
        watch_fields(self, fields);
    } else {
        watch_bits(self, 0, 0, LEARN_REPORT * 8);
    }
    enter(self, LEARN_REST, now_ns + rest_ns);
}

/* ---- one report ---- */

/* Values outside of the range in the descriptor count as its end. */
static bool value_of(const learn_field *field, const uint8_t *bytes, size_t size, int64_t *out)
{
    const descriptor_field *where = &field->where;
    if ((where->report_id != 0 && (size == 0 || bytes[0] != where->report_id)) ||
        !decode_number(bytes, size, where->bit, where->width, where->is_signed, out))
        return false;
    if (*out < where->low)
        *out = where->low;
    if (*out > where->high)
        *out = where->high;
    return true;
}

static void rest(learn *self, const uint8_t *bytes, size_t size)
{
    for (uint32_t i = 0; i < self->field_count; ++i) {
        learn_field *field = &self->field[i];
        int64_t value;
        if (!value_of(field, bytes, size, &value))
            continue;
        if (!field->has_rest || value < field->rest_low)
            field->rest_low = value;
        if (!field->has_rest || value > field->rest_high)
            field->rest_high = value;
        field->has_rest = true;
    }
}

/* Returns the distance of the value from its value at rest. */
static double way_of(const learn_field *field, int64_t value)
{
    int64_t beyond = 0;
    if (value > field->rest_high)
        beyond = value - field->rest_high;
    else if (value < field->rest_low)
        beyond = field->rest_low - value;
    return (double)beyond / ((double)field->where.high - (double)field->where.low);
}

/* Returns the key that is down; 0: none. Codes up to 3 are a keyboard's errors. If they are alone,
 * the user has programmed them. */
static uint8_t key_of(const learn *self, const uint8_t *bytes, size_t size)
{
    layout probe = self->found;
    float value[LAYOUT_SWITCHES] = {0};
    probe.switch_count = 1;
    for (uint32_t at = probe.key_at; at < size && at < (uint32_t)probe.key_at + probe.key_count;
         ++at) {
        probe.switches[0] = (layout_switch){.kind = LAYOUT_KEY, .key = {bytes[at]}};
        if (decode_report(&probe, bytes, size, value) && value[0] > 0.5f)
            return bytes[at];
    }
    return 0;
}

/* Updates the largest distance of each field; returns the largest current distance. */
static double follow(learn *self, const uint8_t *bytes, size_t size)
{
    double furthest = 0.0;
    uint8_t key = self->found.key_count > 0 ? key_of(self, bytes, size) : 0;
    if (key != 0) {
        self->key = self->key ? self->key : key;
        furthest = 1.0;
    }
    for (uint32_t i = 0; i < self->field_count; ++i) {
        learn_field *field = &self->field[i];
        int64_t value;
        if (!field->has_rest || !value_of(field, bytes, size, &value))
            continue;
        double way = way_of(field, value);
        if (way > field->peak_way) {
            field->peak_way = way;
            field->peak = value;
        }
        furthest = way > furthest ? way : furthest;
    }
    return furthest;
}

/* ---- one switch ---- */

static void forget_press(learn *self)
{
    self->key = 0;
    for (uint32_t i = 0; i < self->field_count; ++i)
        self->field[i].peak_way = 0.0;
}

static layout_switch field_switch(const learn_field *field)
{
    const descriptor_field *where = &field->where;
    int64_t up = field->peak > field->rest_high ? field->rest_high : field->rest_low;
    return (layout_switch){.kind = LAYOUT_FIELD,
                           .report_id = where->report_id,
                           .bit = where->bit,
                           .width = where->width,
                           .is_signed = where->is_signed,
                           .up = (int32_t)up,
                           .down = (int32_t)field->peak};
}

/* Returns the pressed switch: a key is preferred to a shift key pressed with it, else the field
 * that moved furthest. */
static layout_switch pressed(const learn *self)
{
    const learn_field *best = &self->field[0];
    if (self->key != 0)
        return (layout_switch){.kind = LAYOUT_KEY, .key = {self->key}};
    for (uint32_t i = 1; i < self->field_count; ++i)
        if (self->field[i].peak_way > best->peak_way)
            best = &self->field[i];
    return field_switch(best);
}

/* The two directions of one axis are two switches. */
static bool is_same(const layout_switch *a, const layout_switch *b)
{
    if (a->kind != b->kind)
        return false;
    if (a->kind == LAYOUT_KEY)
        return a->key[0] == b->key[0];
    return a->report_id == b->report_id && a->bit == b->bit && a->width == b->width &&
           (a->down > a->up) == (b->down > b->up);
}

static bool is_known(const learn *self, const layout_switch *s)
{
    for (uint32_t i = 0; i < self->found.switch_count; ++i)
        if (is_same(&self->found.switches[i], s))
            return true;
    return false;
}

static void add_pressed(learn *self, int64_t time_ns)
{
    layout_switch s = pressed(self);
    forget_press(self);
    if (is_known(self, &s)) {
        enter(self, LEARN_DONE, INT64_MAX);
        return;
    }
    uint32_t n = self->found.switch_count++;
    snprintf(s.name, sizeof s.name, "switch %u", n + 1);
    self->found.switches[n] = s;
    if (self->found.switch_count == LAYOUT_SWITCHES)
        enter(self, LEARN_DONE, INT64_MAX);
    else
        enter(self, LEARN_WAIT, time_ns + patience_ns);
}

/* ---- time ---- */

static bool knows_rest(const learn *self, const uint8_t *bytes, size_t size)
{
    for (uint32_t i = 0; i < self->field_count; ++i) {
        int64_t value;
        if (!self->field[i].has_rest && value_of(&self->field[i], bytes, size, &value))
            return false;
    }
    return true;
}

/* A device that only sends changes sends nothing while no foot is on it. Its first report is a
 * press, and the next different one is the rest state. */
static bool is_first_press(learn *self, const uint8_t *bytes, size_t size)
{
    if (knows_rest(self, bytes, size))
        return false;
    size_t kept = size < LEARN_REPORT ? size : LEARN_REPORT;
    bool is_other = self->first_size > 0 &&
                    (self->first_size != kept || memcmp(self->first_report, bytes, kept) != 0);
    if (is_other)
        rest(self, bytes, size);
    else
        memcpy(self->first_report, bytes, self->first_size = kept);
    return !is_other;
}

static bool watch_press(learn *self, const uint8_t *bytes, size_t size, int64_t time_ns)
{
    double way = follow(self, bytes, size);
    if (self->stage == LEARN_WAIT && way >= down_way) {
        enter(self, LEARN_DOWN, time_ns + patience_ns);
        return true;
    }
    if (self->stage == LEARN_DOWN && way < up_way) {
        add_pressed(self, time_ns);
        return true;
    }
    if (self->stage == LEARN_WAIT)
        forget_press(self);
    return false;
}

bool learn_report(learn *self, const uint8_t *bytes, size_t size, int64_t time_ns)
{
    if (!learn_is_running(self) || size == 0)
        return false;
    if (self->stage == LEARN_REST) {
        rest(self, bytes, size);
        return false;
    }
    if (self->stage == LEARN_WAIT && is_first_press(self, bytes, size))
        return false;
    bool has_kept = self->first_size > 0;
    if (has_kept) {
        size_t kept = self->first_size;
        self->first_size = 0;
        (void)watch_press(self, self->first_report, kept, time_ns);
    }
    return watch_press(self, bytes, size, time_ns) || has_kept;
}

bool learn_tick(learn *self, int64_t now_ns)
{
    if (!learn_is_running(self) || now_ns < self->until_ns)
        return false;
    if (self->stage == LEARN_REST)
        enter(self, LEARN_WAIT, now_ns + patience_ns);
    else if (self->stage == LEARN_WAIT && self->found.switch_count > 0)
        enter(self, LEARN_DONE, INT64_MAX);
    else
        enter(self, LEARN_FAILED, INT64_MAX);
    return true;
}
