#include "descriptor.h"

#include <stdio.h>
#include <string.h>

/* ---- report descriptors ---- */

enum { STACK = 4, USAGES = 64, LONG_ITEM = 0xfe };

/* Item tags with their type, without the two size bits. */
enum {
    MAIN_INPUT = 0x80,
    MAIN_OUTPUT = 0x90,
    MAIN_FEATURE = 0xb0,
    MAIN_COLLECTION = 0xa0,
    MAIN_END_COLLECTION = 0xc0,
    GLOBAL_USAGE_PAGE = 0x04,
    GLOBAL_LOGICAL_LOW = 0x14,
    GLOBAL_LOGICAL_HIGH = 0x24,
    GLOBAL_REPORT_SIZE = 0x74,
    GLOBAL_REPORT_ID = 0x84,
    GLOBAL_REPORT_COUNT = 0x94,
    GLOBAL_PUSH = 0xa4,
    GLOBAL_POP = 0xb4,
    LOCAL_USAGE = 0x08,
    LOCAL_USAGE_LOW = 0x18,
    LOCAL_USAGE_HIGH = 0x28
};
enum { INPUT_CONSTANT = 1, INPUT_VARIABLE = 2, INPUT_RELATIVE = 4 };

typedef struct item {
    uint8_t tag;
    uint32_t size; /* 0, 1, 2 or 4 */
    uint32_t number;
    int32_t signed_number;
} item;

typedef struct globals {
    uint32_t page, size_bits, count, report_id;
    int32_t low;
    int32_t high_signed;
    uint32_t high_unsigned;
} globals;

typedef struct usage_range {
    uint16_t page, first, last;
} usage_range;

typedef struct parser {
    descriptor *out;
    char *reason;
    size_t at; /* of the item, for messages */
    globals now, stack[STACK];
    uint32_t stack_count, collection_count;
    usage_range usage[USAGES];
    uint32_t usage_count;
    uint32_t usage_low, usage_high;
    bool has_usage_low, has_usage_high, has_report_ids, has_fields;
    uint32_t used_bits[256]; /* per report number */
} parser;

static mrt_result refuse(const parser *self, const char *what)
{
    snprintf(self->reason, DESCRIPTOR_REASON, "byte %zu of the report descriptor: %s", self->at,
             what);
    return MRT_ERR_FORMAT;
}

/* ---- items ---- */

/* Reads the item at *at and moves after it. Skips long items, which are undefined. */
static mrt_result next_item(parser *self, const uint8_t *bytes, size_t size, size_t *at, item *out)
{
    static const uint32_t sizes[] = {0, 1, 2, 4};
    *out = (item){0};
    uint8_t head = bytes[*at];
    if (head == LONG_ITEM) {
        if (size - *at < 3 || size - *at - 3 < bytes[*at + 1])
            return refuse(self, "a long item is longer than the descriptor");
        *at += 3 + (size_t)bytes[*at + 1];
        return MRT_OK;
    }
    out->tag = head & 0xfc;
    out->size = sizes[head & 3];
    if (size - *at - 1 < out->size)
        return refuse(self, "an item is longer than the descriptor");
    for (uint32_t i = 0; i < out->size; ++i)
        out->number |= (uint32_t)bytes[*at + 1 + i] << (8 * i);
    uint32_t sign = out->size > 0 && out->size < 4 ? 1u << (8 * out->size - 1) : 0;
    int64_t value = out->number;
    if (out->size == 4 && out->number > INT32_MAX)
        value -= (int64_t)1 << 32;
    else if (out->number & sign)
        value -= (int64_t)sign * 2;
    out->signed_number = (int32_t)value;
    *at += 1 + out->size;
    return MRT_OK;
}

/* ---- usages ---- */

static uint16_t page_of(const parser *self, uint32_t usage)
{
    return (uint16_t)(usage > UINT16_MAX ? usage >> 16 : self->now.page);
}

/* Ignores usages beyond the capacity: they are not of a pedal's switch. */
static void add_usages(parser *self, uint32_t first, uint32_t last)
{
    if (self->usage_count < USAGES && (uint16_t)first <= (uint16_t)last)
        self->usage[self->usage_count++] =
            (usage_range){page_of(self, first), (uint16_t)first, (uint16_t)last};
}

static void take_usage_limit(parser *self, const item *it)
{
    bool is_low = it->tag == LOCAL_USAGE_LOW;
    *(is_low ? &self->usage_low : &self->usage_high) = it->number;
    *(is_low ? &self->has_usage_low : &self->has_usage_high) = true;
    if (!self->has_usage_low || !self->has_usage_high)
        return;
    add_usages(self, self->usage_low, self->usage_high);
    self->has_usage_low = self->has_usage_high = false;
}

static void forget_locals(parser *self)
{
    self->usage_count = 0;
    self->has_usage_low = self->has_usage_high = false;
}

/* Finds the usage of the n-th number of a field: the last usage applies to all numbers after it. */
static void name_field(const parser *self, uint32_t n, descriptor_field *field)
{
    field->page = (uint16_t)self->now.page;
    for (uint32_t i = 0; i < self->usage_count; ++i) {
        const usage_range *range = &self->usage[i];
        uint32_t length = (uint32_t)(range->last - range->first) + 1;
        field->page = range->page;
        field->usage = n < length ? (uint16_t)(range->first + n) : range->last;
        if (n < length)
            return;
        n -= length;
    }
}

/* ---- fields ---- */

/* Many descriptors write a maximum of 255 in one byte, which is -1 in the specification. */
static int64_t high_of(const globals *now)
{
    return now->high_signed < now->low && now->low >= 0 ? (int64_t)now->high_unsigned
                                                        : (int64_t)now->high_signed;
}

static void add_field(parser *self, uint32_t flags, uint32_t n, uint32_t bit)
{
    const globals *now = &self->now;
    bool is_array = !(flags & INPUT_VARIABLE);
    int64_t high = high_of(now);
    if (self->out->field_count == DESCRIPTOR_FIELDS || high <= now->low || high > INT32_MAX)
        return;
    descriptor_field *field = &self->out->field[self->out->field_count++];
    *field = (descriptor_field){.report_id = (uint8_t)now->report_id,
                                .bit = (uint16_t)bit,
                                .width = (uint8_t)now->size_bits,
                                .count = (uint16_t)(is_array ? now->count : 1),
                                .is_array = is_array,
                                .is_relative = (flags & INPUT_RELATIVE) != 0,
                                .is_signed = now->low < 0,
                                .low = now->low,
                                .high = (int32_t)high};
    name_field(self, n, field);
}

static mrt_result take_input(parser *self, uint32_t flags)
{
    const globals *now = &self->now;
    uint64_t bits = (uint64_t)now->size_bits * now->count;
    uint32_t *used = &self->used_bits[now->report_id];
    uint32_t first = *used + (now->report_id != 0 ? 8 : 0);
    if (bits > DESCRIPTOR_REPORT_BYTES * 8 || first + bits > DESCRIPTOR_REPORT_BYTES * 8)
        return refuse(self, "a report is longer than USB allows");
    *used += (uint32_t)bits;
    self->has_fields = true;
    if ((flags & INPUT_CONSTANT) || now->size_bits < 1 || now->size_bits > 32 || now->count < 1)
        return MRT_OK;
    uint32_t numbers = flags & INPUT_VARIABLE ? now->count : 1;
    for (uint32_t i = 0; i < numbers && self->out->field_count < DESCRIPTOR_FIELDS; ++i)
        add_field(self, flags, i, first + i * now->size_bits);
    return MRT_OK;
}

/* ---- main, global and local items ---- */

static mrt_result take_main(parser *self, const item *it)
{
    mrt_result result = MRT_OK;
    if (it->tag == MAIN_INPUT) {
        result = take_input(self, it->number);
    } else if (it->tag == MAIN_COLLECTION) {
        self->collection_count += 1;
    } else if (it->tag == MAIN_END_COLLECTION) {
        if (self->collection_count == 0)
            return refuse(self, "a collection ends without a beginning");
        self->collection_count -= 1;
    } else if (it->tag != MAIN_OUTPUT && it->tag != MAIN_FEATURE) {
        return refuse(self, "an item that HID does not define");
    }
    forget_locals(self);
    return result;
}

static mrt_result take_report_id(parser *self, uint32_t number)
{
    if (number < 1 || number > 255)
        return refuse(self, "a report number is outside 1..255");
    if (self->has_fields && !self->has_report_ids)
        return refuse(self, "the first fields have no report number, but later ones do");
    self->has_report_ids = true;
    self->now.report_id = number;
    return MRT_OK;
}

static mrt_result push(parser *self)
{
    if (self->stack_count == STACK)
        return refuse(self, "more than 4 nested push items");
    self->stack[self->stack_count++] = self->now;
    return MRT_OK;
}

static mrt_result pop(parser *self)
{
    if (self->stack_count == 0)
        return refuse(self, "a pop item without a push item");
    self->now = self->stack[--self->stack_count];
    return MRT_OK;
}

static mrt_result take_global(parser *self, const item *it)
{
    switch (it->tag) {
    case GLOBAL_USAGE_PAGE:
        self->now.page = it->number & UINT16_MAX;
        return MRT_OK;
    case GLOBAL_LOGICAL_LOW:
        self->now.low = it->signed_number;
        return MRT_OK;
    case GLOBAL_LOGICAL_HIGH:
        self->now.high_signed = it->signed_number;
        self->now.high_unsigned = it->number;
        return MRT_OK;
    case GLOBAL_REPORT_SIZE:
        self->now.size_bits = it->number;
        return MRT_OK;
    case GLOBAL_REPORT_COUNT:
        self->now.count = it->number;
        return MRT_OK;
    case GLOBAL_REPORT_ID:
        return take_report_id(self, it->number);
    case GLOBAL_PUSH:
        return push(self);
    case GLOBAL_POP:
        return pop(self);
    default: /* physical range, exponent, unit: do not affect the bits */
        return MRT_OK;
    }
}

static void take_local(parser *self, const item *it)
{
    if (it->tag == LOCAL_USAGE)
        add_usages(self, it->number, it->number);
    else if (it->tag == LOCAL_USAGE_LOW || it->tag == LOCAL_USAGE_HIGH)
        take_usage_limit(self, it);
}

static mrt_result take_item(parser *self, const item *it)
{
    switch (it->tag & 0x0c) {
    case 0x00:
        return take_main(self, it);
    case 0x04:
        return take_global(self, it);
    case 0x08:
        take_local(self, it);
        return MRT_OK;
    default:
        return refuse(self, "an item of a type that HID does not define");
    }
}

static mrt_result parse(parser *self, const uint8_t *bytes, size_t size)
{
    if (size > DESCRIPTOR_BYTES)
        return refuse(self, "longer than 4096 bytes");
    for (size_t at = 0; at < size;) {
        item it;
        self->at = at;
        bool is_long = bytes[at] == LONG_ITEM;
        mrt_result result = next_item(self, bytes, size, &at, &it);
        if (result >= 0 && !is_long)
            result = take_item(self, &it);
        if (result < 0)
            return result;
    }
    self->at = size;
    return self->collection_count == 0 ? MRT_OK : refuse(self, "the last collection has no end");
}

mrt_result descriptor_parse(descriptor *out, const uint8_t *bytes, size_t size,
                            char reason[DESCRIPTOR_REASON])
{
    memset(out, 0, sizeof *out);
    parser self = {.out = out};
    self.reason = reason;
    mrt_result result = parse(&self, bytes, size);
    if (result < 0)
        memset(out, 0, sizeof *out);
    return result;
}

/* ---- the pedals among them ---- */

/* HID usage tables 1.3 */
enum {
    PAGE_DESKTOP = 0x01,
    PAGE_SIMULATION = 0x02,
    PAGE_KEYBOARD = 0x07,
    PAGE_BUTTON = 0x09,
    DESKTOP_X = 0x30,
    DESKTOP_WHEEL = 0x38,
    SIMULATION_RUDDER = 0xba,
    SIMULATION_THROTTLE = 0xbb,
    SIMULATION_ACCELERATOR = 0xc4,
    SIMULATION_BRAKE = 0xc5,
    SIMULATION_CLUTCH = 0xc6
};

static bool is_button(const descriptor_field *field)
{
    return field->page == PAGE_BUTTON && !field->is_array && field->width == 1;
}

static bool is_foot_axis(const descriptor_field *field)
{
    return field->page == PAGE_SIMULATION && !field->is_array &&
           (field->usage == SIMULATION_ACCELERATOR || field->usage == SIMULATION_BRAKE ||
            field->usage == SIMULATION_CLUTCH);
}

bool describe_is_axis(const descriptor_field *field)
{
    if (field->is_array || field->is_relative || field->width < 4)
        return false;
    return is_foot_axis(field) ||
           (field->page == PAGE_DESKTOP && field->usage >= DESKTOP_X &&
            field->usage <= DESKTOP_WHEEL) ||
           (field->page == PAGE_SIMULATION &&
            (field->usage == SIMULATION_RUDDER || field->usage == SIMULATION_THROTTLE));
}

static const char *axis_name(const descriptor_field *field)
{
    static const char *const desktop[] = {"axis x",  "axis y", "axis z", "axis rx", "axis ry",
                                          "axis rz", "slider", "dial",   "wheel"};
    if (field->page == PAGE_DESKTOP)
        return desktop[field->usage - DESKTOP_X];
    switch (field->usage) {
    case SIMULATION_RUDDER:
        return "rudder";
    case SIMULATION_THROTTLE:
        return "throttle";
    case SIMULATION_ACCELERATOR:
        return "accelerator";
    case SIMULATION_BRAKE:
        return "brake";
    default:
        return "clutch";
    }
}

static void add_switch(layout *out, const descriptor_field *field)
{
    if (out->switch_count == LAYOUT_SWITCHES)
        return;
    layout_switch *s = &out->switches[out->switch_count++];
    *s = (layout_switch){.report_id = field->report_id,
                         .bit = field->bit,
                         .width = field->width,
                         .is_signed = field->is_signed,
                         .up = field->low,
                         .down = field->high};
    if (is_button(field))
        snprintf(s->name, sizeof s->name, "button %u", field->usage);
    else
        snprintf(s->name, sizeof s->name, "%s", axis_name(field));
}

static void add_buttons(layout *out, const descriptor *from)
{
    for (uint32_t i = 0; i < from->field_count; ++i)
        if (is_button(&from->field[i]))
            add_switch(out, &from->field[i]);
}

/* Adds the axes of pedals, if the descriptor names any; else all axes except the skipped ones. */
static void add_axes(layout *out, const descriptor *from, bool has_foot_axes)
{
    uint32_t passed = 0;
    for (uint32_t i = 0; i < from->field_count; ++i) {
        const descriptor_field *field = &from->field[i];
        if (has_foot_axes ? is_foot_axis(field)
                          : describe_is_axis(field) && passed++ >= out->axis_skip)
            add_switch(out, field);
    }
}

static bool has_any(const descriptor *from, bool (*is)(const descriptor_field *))
{
    for (uint32_t i = 0; i < from->field_count; ++i)
        if (is(&from->field[i]))
            return true;
    return false;
}

bool describe_switches(layout *out, const descriptor *from)
{
    out->switch_count = 0;
    bool has_foot_axes = has_any(from, is_foot_axis);
    bool axes_first = has_foot_axes || out->axis_skip > 0;
    if (axes_first)
        add_axes(out, from, has_foot_axes);
    add_buttons(out, from);
    if (!axes_first)
        add_axes(out, from, false);
    return out->switch_count > 0;
}

bool describe_keys(layout *out, const descriptor *from)
{
    for (uint32_t i = 0; i < from->field_count; ++i) {
        const descriptor_field *field = &from->field[i];
        if (!field->is_array || field->page != PAGE_KEYBOARD || field->width != 8 ||
            field->bit % 8 != 0 || field->count > UINT8_MAX || field->bit / 8 > UINT8_MAX)
            continue;
        out->key_report_id = field->report_id;
        out->key_at = (uint8_t)(field->bit / 8);
        out->key_count = (uint8_t)field->count;
        return true;
    }
    return false;
}

bool describe_may_be_pedal(const descriptor *from)
{
    for (uint32_t i = 0; i < from->field_count; ++i) {
        const descriptor_field *field = &from->field[i];
        bool is_of_mouse = field->page == PAGE_DESKTOP && field->is_relative;
        if (is_of_mouse || field->page == PAGE_KEYBOARD)
            return false;
    }
    return has_any(from, is_button) || has_any(from, describe_is_axis);
}

/* ---- reports ---- */

enum { KEY_ERROR_ROLL_OVER = 1 };

bool decode_number(const uint8_t *bytes, size_t size, uint32_t bit, uint32_t width, bool is_signed,
                   int64_t *out)
{
    if (width < 1 || width > 32 || (uint64_t)bit + width > (uint64_t)size * 8)
        return false;
    uint64_t number = 0;
    for (uint32_t i = 0; i < width; ++i) {
        uint64_t byte = bytes[(bit + i) / 8];
        number |= (byte >> ((bit + i) % 8) & 1u) << i;
    }
    *out = (int64_t)number;
    if (is_signed && (number >> (width - 1) & 1u))
        *out -= (int64_t)1 << width;
    return true;
}

static bool is_of_report(uint8_t report_id, const uint8_t *bytes, size_t size)
{
    return report_id == 0 || (size > 0 && bytes[0] == report_id);
}

static bool decode_field(const layout_switch *s, const uint8_t *bytes, size_t size, float *out)
{
    int64_t number;
    if (!is_of_report(s->report_id, bytes, size) || s->up == s->down ||
        !decode_number(bytes, size, s->bit, s->width, s->is_signed, &number))
        return false;
    double way = (double)(number - s->up) / ((double)s->down - (double)s->up);
    *out = (float)(way > 0.0 ? (way < 1.0 ? way : 1.0) : 0.0);
    return true;
}

/* Returns the list of pressed keys, if the report has one: the part that was received. */
static const uint8_t *keys_of(const layout *of, const uint8_t *bytes, size_t size,
                              size_t *out_count)
{
    if (of->key_count == 0 || size <= of->key_at || !is_of_report(of->key_report_id, bytes, size))
        return NULL;
    size_t count = size - of->key_at;
    *out_count = count < of->key_count ? count : of->key_count;
    return bytes + of->key_at;
}

/* A keyboard that reports too many keys sends one code in every slot. */
static bool is_roll_over(const uint8_t *keys, size_t count)
{
    for (size_t i = 0; i < count; ++i)
        if (keys[i] != KEY_ERROR_ROLL_OVER)
            return false;
    return count > 1;
}

static bool holds(const uint8_t *keys, size_t count, uint8_t key)
{
    return key != 0 && memchr(keys, key, count) != NULL;
}

static bool holds_any(const uint8_t *keys, size_t count)
{
    for (size_t i = 0; i < count; ++i)
        if (keys[i] != 0)
            return true;
    return false;
}

static bool is_key_down(const layout *of, uint32_t index, const uint8_t *keys, size_t count)
{
    if (of->any_key && index == 0)
        return holds_any(keys, count);
    for (int k = 0; k < LAYOUT_KEYS; ++k)
        if (holds(keys, count, of->switches[index].key[k]))
            return true;
    return false;
}

bool decode_report(const layout *of, const uint8_t *bytes, size_t size,
                   float value[LAYOUT_SWITCHES])
{
    if (size < of->head_count || memcmp(bytes, of->head, of->head_count) != 0)
        return false;
    size_t key_count = 0;
    const uint8_t *keys = keys_of(of, bytes, size, &key_count);
    if (keys && is_roll_over(keys, key_count))
        keys = NULL;
    bool spoke = false;
    for (uint32_t i = 0; i < of->switch_count; ++i) {
        const layout_switch *s = &of->switches[i];
        if (s->kind == LAYOUT_FIELD) {
            spoke = decode_field(s, bytes, size, &value[i]) || spoke;
        } else if (keys) {
            value[i] = is_key_down(of, i, keys, key_count) ? 1.0f : 0.0f;
            spoke = true;
        }
    }
    return spoke;
}
