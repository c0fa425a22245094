#include "decode.h"

#include <string.h>

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

/* The list of keys that are down, if the report has one: the part of it that did arrive. */
static const uint8_t *keys_of(const layout *of, const uint8_t *bytes, size_t size,
                              size_t *out_count)
{
    if (of->key_count == 0 || size <= of->key_at || !is_of_report(of->key_report_id, bytes, size))
        return NULL;
    size_t count = size - of->key_at;
    *out_count = count < of->key_count ? count : of->key_count;
    return bytes + of->key_at;
}

/* A keyboard that has lost count says so with one code in every place. */
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
