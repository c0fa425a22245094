#include "face/rig/rig_document.h"

#include "base/text.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LINE_VALUES = 64, LINE_TEXT = 32 + 2 * LINE_VALUES, SAME_MIN = 6 };

static const char expected_text[] = "vertices and their values like \"120-180:ff\" or "
                                    "\"204:0c1f33\", ascending";

/* ---- ranges ---- */

static mrt_result allocate(rig_select *out, size_t capacity, error *err)
{
    out->first = calloc(capacity + 1, sizeof *out->first);
    out->last = calloc(capacity + 1, sizeof *out->last);
    out->value = calloc(capacity + 1, sizeof *out->value);
    out->range_count = 0;
    return out->first && out->last && out->value ? MRT_OK : rig_no_memory(err);
}

/* Appends a range, or extends the last one if it is adjacent and has the same value. */
static void add_range(rig_select *out, uint32_t first, uint32_t last, uint8_t value)
{
    uint32_t count = out->range_count;
    if (value == 0)
        return;
    if (count > 0 && out->value[count - 1] == value && out->last[count - 1] + 1 == first) {
        out->last[count - 1] = last;
        return;
    }
    out->first[count] = first;
    out->last[count] = last;
    out->value[count] = value;
    out->range_count = count + 1;
}

mrt_result rig_paint_set(rig_select *out, const uint8_t *value, uint32_t vertex_count, error *err)
{
    size_t capacity = 0;
    for (uint32_t v = 0; v < vertex_count; ++v)
        capacity += v == 0 || value[v] != value[v - 1];
    rig_select made = {0};
    mrt_result result = allocate(&made, capacity, err);
    if (result < 0) {
        rig_select_free_ranges(&made);
        return result;
    }
    for (uint32_t v = 0; v < vertex_count; ++v)
        add_range(&made, v, v, value[v]);
    rig_select_free_ranges(out);
    out->first = made.first;
    out->last = made.last;
    out->value = made.value;
    out->range_count = made.range_count;
    return MRT_OK;
}

bool rig_paint_equals(const rig_select *a, const rig_select *b)
{
    size_t count = a->range_count;
    return count == b->range_count &&
           (count == 0 || (memcmp(a->first, b->first, count * sizeof *a->first) == 0 &&
                           memcmp(a->last, b->last, count * sizeof *a->last) == 0 &&
                           memcmp(a->value, b->value, count * sizeof *a->value) == 0));
}

/* ---- from JSON ---- */

static int digit_of(char letter)
{
    return letter >= '0' && letter <= '9'   ? letter - '0'
           : letter >= 'a' && letter <= 'f' ? letter - 'a' + 10
                                            : -1;
}

static bool read_value(uint8_t *out, const char *digits)
{
    int high = digit_of(digits[0]), low = digit_of(digits[1]);
    *out = (uint8_t)(high * 16 + low);
    return high >= 0 && low >= 0;
}

typedef struct paint_line { /* one string of the list */
    uint32_t first, last;
    const char *digits;
    bool is_same; /* one value for the whole range */
} paint_line;

static bool read_vertices(paint_line *out, text_view words)
{
    text_view word[2], more;
    int64_t number[2];
    if (!text_next_field(&words, '-', &word[0]) || !text_int(word[0], &number[0]) || number[0] < 0)
        return false;
    number[1] = number[0];
    out->is_same = text_next_field(&words, '-', &word[1]);
    if (out->is_same && (!text_int(word[1], &number[1]) || text_next_field(&words, '-', &more)))
        return false;
    out->first = (uint32_t)number[0];
    out->last = (uint32_t)number[1];
    return number[1] >= number[0] && number[1] < INT32_MAX;
}

static bool read_line(paint_line *out, const char *text)
{
    const char *colon = text ? strchr(text, ':') : NULL;
    if (!colon || !read_vertices(out, text_view_of(text, (size_t)(colon - text))))
        return false;
    out->digits = colon + 1;
    size_t count = strlen(out->digits);
    if (count < 2 || count % 2 != 0 || (out->is_same && count != 2) ||
        count / 2 > (size_t)(INT32_MAX - (int32_t)out->first))
        return false;
    if (!out->is_same)
        out->last = out->first + (uint32_t)(count / 2) - 1;
    return true;
}

static size_t most_ranges(const json_t *list)
{
    size_t count = 0;
    for (size_t i = 0; i < json_array_size(list); ++i)
        count += 1 + json_string_length(json_array_get(list, i)) / 2;
    return count;
}

static bool add_line(rig_select *out, const paint_line *line)
{
    uint8_t value;
    if (line->is_same) {
        bool is_read = read_value(&value, line->digits);
        if (is_read)
            add_range(out, line->first, line->last, value);
        return is_read;
    }
    for (uint32_t v = line->first; v <= line->last; ++v) {
        if (!read_value(&value, line->digits + 2 * (size_t)(v - line->first)))
            return false;
        add_range(out, v, v, value);
    }
    return true;
}

static mrt_result charge_budget(budget *b, size_t range_count, const json_node *at, error *err)
{
    enum { RANGE_BYTES = 9 };
    mrt_result result = budget_spend_work(b, range_count, err);
    if (result >= 0)
        result = budget_spend_bytes(b, range_count * RANGE_BYTES, err);
    if (result < 0)
        error_prefix(err, at->path.text);
    return result;
}

mrt_result rig_paint_parse(rig_select *out, const json_node *at, budget *b, error *err)
{
    mrt_result result = json_node_array(at, "a list of vertices and values", UINT32_MAX / 2, err);
    if (result < 0)
        return result;
    size_t most = most_ranges(at->value);
    if (b)
        result = charge_budget(b, most, at, err);
    if (result >= 0)
        result = allocate(out, most, err);
    int64_t last = -1;
    for (size_t i = 0; result >= 0 && i < json_array_size(at->value); ++i) {
        json_node item = json_node_item(at, i);
        paint_line line = {0};
        if (!read_line(&line, json_string_value(item.value)) || (int64_t)line.first <= last ||
            !add_line(out, &line))
            return json_node_unexpected(err, &item, expected_text);
        last = line.last;
    }
    return result;
}

/* ---- to JSON ---- */

typedef struct paint_text { /* consecutive values that are not in the list yet */
    json_t *list;
    char digits[2 * LINE_VALUES + 1];
    uint32_t first, count;
    int failed;
} paint_text;

static void append_text(paint_text *t)
{
    char text[LINE_TEXT];
    if (t->count == 0)
        return;
    (void)snprintf(text, sizeof text, "%u:%s", t->first, t->digits);
    t->failed |= json_array_append_new(t->list, json_string(text));
    t->count = 0;
}

static void append_value(paint_text *t, uint32_t vertex, uint8_t value)
{
    if (t->count == LINE_VALUES || (t->count > 0 && t->first + t->count != vertex))
        append_text(t);
    if (t->count == 0)
        t->first = vertex;
    (void)snprintf(t->digits + 2 * (size_t)t->count, 3, "%02x", value);
    t->count += 1;
}

static void append_range(paint_text *t, uint32_t first, uint32_t last, uint8_t value)
{
    char text[LINE_TEXT];
    append_text(t);
    (void)snprintf(text, sizeof text, "%u-%u:%02x", first, last, value);
    t->failed |= json_array_append_new(t->list, json_string(text));
}

json_t *rig_paint_to_json(const rig_select *select)
{
    paint_text t = {.list = json_array()};
    for (uint32_t i = 0; i < select->range_count; ++i) {
        uint32_t first = select->first[i], last = select->last[i];
        if (last - first + 1 >= SAME_MIN)
            append_range(&t, first, last, select->value[i]);
        else
            for (uint32_t v = first; v <= last; ++v)
                append_value(&t, v, select->value[i]);
    }
    append_text(&t);
    if (t.list && !t.failed)
        return t.list;
    json_decref(t.list);
    return NULL;
}
