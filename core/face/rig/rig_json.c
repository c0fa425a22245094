#include "face/rig/rig_json.h"

#include "base/text.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NOTE_CAP = 8192, LINE_TEXT = 512 };
static const double coordinate_cap = 1e6;

rig_word rig_word_of(const char *text)
{
    rig_word out;
    text_copy(out.text, sizeof out.text, text_view_of(text, strlen(text)));
    return out;
}

size_t rig_json_memory(const void *data, size_t size)
{
    enum { OBJECT_BYTES = 256, ARRAY_BYTES = 128, VALUE_BYTES = 64 }; /* of jansson 2.14 */
    const char *text = data;
    size_t out = VALUE_BYTES;
    bool is_quoted = false;
    for (size_t i = 0; i < size; ++i) {
        if (is_quoted && text[i] == '\\')
            ++i;
        else if (text[i] == '"')
            is_quoted = !is_quoted;
        else if (!is_quoted)
            out += text[i] == '{'   ? OBJECT_BYTES
                   : text[i] == '[' ? ARRAY_BYTES
                   : text[i] == ',' ? VALUE_BYTES
                                    : 0;
    }
    return out;
}

rig_node rig_json_member(const rig_node *of, const char *key)
{
    rig_node out = {.value = json_object_get(of->value, key)};
    rig_word word = rig_word_of(key);
    (void)snprintf(out.place.text, sizeof out.place.text, "%.190s.%s", of->place.text, word.text);
    return out;
}

rig_node rig_json_item(const rig_node *of, size_t index)
{
    rig_node out = {.value = json_array_get(of->value, index)};
    (void)snprintf(out.place.text, sizeof out.place.text, "%.230s[%zu]", of->place.text, index);
    return out;
}

/* What a value is, for messages: "[1,2,3]" is "an array of 3". */
static void describe(char out[LINE_TEXT], const json_t *value)
{
    switch (value ? (int)json_typeof(value) : -1) {
    case JSON_OBJECT:
        (void)snprintf(out, LINE_TEXT, "an object");
        break;
    case JSON_ARRAY:
        (void)snprintf(out, LINE_TEXT, "an array of %zu", json_array_size(value));
        break;
    case JSON_STRING: {
        rig_word word = rig_word_of(json_string_value(value));
        (void)snprintf(out, LINE_TEXT, "\"%s\"", word.text);
        break;
    }
    case JSON_INTEGER:
    case JSON_REAL:
        (void)snprintf(out, LINE_TEXT, "%.9g", json_number_value(value));
        break;
    case JSON_TRUE:
        (void)snprintf(out, LINE_TEXT, "true");
        break;
    case JSON_FALSE:
        (void)snprintf(out, LINE_TEXT, "false");
        break;
    case JSON_NULL:
        (void)snprintf(out, LINE_TEXT, "null");
        break;
    default:
        (void)snprintf(out, LINE_TEXT, "nothing");
        break;
    }
}

mrt_result rig_json_unexpected(error *err, const rig_node *at, const char *expected)
{
    char found[LINE_TEXT];
    describe(found, at->value);
    return error_set(err, MRT_ERR_FORMAT, "%s: expected %s, found %s", at->place.text, expected,
                     found);
}

mrt_result rig_json_object(const rig_node *at, const char *expected, error *err)
{
    return json_is_object(at->value) ? MRT_OK : rig_json_unexpected(err, at, expected);
}

mrt_result rig_json_array(const rig_node *at, const char *expected, size_t item_cap, error *err)
{
    if (!json_is_array(at->value))
        return rig_json_unexpected(err, at, expected);
    if (json_array_size(at->value) > item_cap)
        return error_set(err, MRT_ERR_UNSUPPORTED, "%s: %zu entries are too many, at most %zu",
                         at->place.text, json_array_size(at->value), item_cap);
    return MRT_OK;
}

mrt_result rig_json_number(double *out, const rig_node *at, double low, double high, error *err)
{
    double value = json_number_value(at->value);
    if (!json_is_number(at->value) || !(value >= low && value <= high)) {
        char expected[LINE_TEXT];
        (void)snprintf(expected, sizeof expected, "a number from %g to %g", low, high);
        return rig_json_unexpected(err, at, expected);
    }
    *out = value;
    return MRT_OK;
}

mrt_result rig_json_flag(bool *out, const rig_node *at, error *err)
{
    if (!json_is_boolean(at->value))
        return rig_json_unexpected(err, at, "true or false");
    *out = json_is_true(at->value);
    return MRT_OK;
}

mrt_result rig_json_index(uint32_t *out, const rig_node *at, error *err)
{
    json_int_t value = json_integer_value(at->value);
    if (!json_is_integer(at->value) || value < 0 || value >= INT32_MAX)
        return rig_json_unexpected(err, at, "a vertex number of the mesh file, from 0");
    *out = (uint32_t)value;
    return MRT_OK;
}

mrt_result rig_json_point(vec3 *out, const rig_node *at, double scale, error *err)
{
    double *axis[3] = {&out->x, &out->y, &out->z};
    if (!json_is_array(at->value) || json_array_size(at->value) != 3)
        return rig_json_unexpected(err, at, "three numbers [x, y, z]");
    for (size_t i = 0; i < 3; ++i) {
        rig_node item = rig_json_item(at, i);
        mrt_result result = rig_json_number(axis[i], &item, -coordinate_cap, coordinate_cap, err);
        if (result < 0)
            return result;
        *axis[i] *= scale;
    }
    return MRT_OK;
}

mrt_result rig_json_text(char **out, const rig_node *at, const char *expected, size_t length_max,
                         error *err)
{
    const char *text = json_string_value(at->value);
    size_t length = json_string_length(at->value);
    if (!text || length == 0)
        return rig_json_unexpected(err, at, expected);
    if (length > length_max || !text_is_printable(text_view_of(text, length)))
        return error_set(err, MRT_ERR_FORMAT,
                         "%s: expected at most %zu letters and no control characters",
                         at->place.text, length_max);
    *out = strdup(text);
    return *out ? MRT_OK : error_set(err, MRT_ERR_MEMORY, "no memory for the rig");
}

mrt_result rig_json_optional_number(double *out, const rig_node *of, const char *key, double low,
                                    double high, error *err)
{
    rig_node at = rig_json_member(of, key);
    return at.value ? rig_json_number(out, &at, low, high, err) : MRT_OK;
}

mrt_result rig_json_optional_point(vec3 *out, bool *out_has, const rig_node *of, const char *key,
                                   double scale, error *err)
{
    rig_node at = rig_json_member(of, key);
    *out_has = at.value != NULL;
    return at.value ? rig_json_point(out, &at, scale, err) : MRT_OK;
}

void rig_json_note_unknown(char **note, const rig_node *object, const char *const *known)
{
    json_t *value = (json_t *)(uintptr_t)object->value;
    for (void *at = json_object_iter(value); at; at = json_object_iter_next(value, at)) {
        const char *key = json_object_iter_key(at);
        const char *const *entry = known;
        while (*entry && strcmp(*entry, key) != 0)
            ++entry;
        if (*entry)
            continue;
        rig_node member = rig_json_member(object, key);
        rig_note(note, "%s: a key that this version does not know; it is kept", member.place.text);
    }
}

void rig_note(char **note, const char *format, ...)
{
    char line[LINE_TEXT];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    size_t old = *note ? strlen(*note) : 0, added = strlen(line);
    if (old > NOTE_CAP)
        return;
    char *grown = realloc(*note, old + added + 2);
    if (!grown)
        return; /* a note is never worth a failure */
    memcpy(grown + old, line, added);
    memcpy(grown + old + added, "\n", 2);
    *note = grown;
}
