#include "hand/calibration_json.h"

#include "base/text.h"

#include <stdio.h>
#include <string.h>

enum { WORD_TEXT = 64, FOUND_TEXT = 128, EXPECTED_TEXT = 256 };

/* Bytes from somebody else, for a message. */
typedef struct word {
    char text[WORD_TEXT];
} word;

static word word_of(const char *text)
{
    word out;
    text_copy(out.text, sizeof out.text, text_view_of(text, strlen(text)));
    return out;
}

json_place json_place_root(const json_t *value, const char *name)
{
    json_place out = {.value = value};
    (void)snprintf(out.text, sizeof out.text, "%.120s: $", name);
    return out;
}

/* Sensor names have a dot in them, so such keys are quoted. */
json_place json_place_member(const json_place *of, const char *key)
{
    json_place out = {.value = json_object_get(of->value, key)};
    word shown = word_of(key);
    bool is_quoted = strchr(key, '.') != NULL;
    (void)snprintf(out.text, sizeof out.text, "%.240s%s%s%s", of->text, is_quoted ? "[\"" : ".",
                   shown.text, is_quoted ? "\"]" : "");
    return out;
}

json_place json_place_item(const json_place *of, size_t index)
{
    json_place out = {.value = json_array_get(of->value, index)};
    (void)snprintf(out.text, sizeof out.text, "%.290s[%zu]", of->text, index);
    return out;
}

static void describe(char out[FOUND_TEXT], const json_t *value)
{
    switch (value ? (int)json_typeof(value) : -1) {
    case JSON_OBJECT:
        (void)snprintf(out, FOUND_TEXT, "an object");
        break;
    case JSON_ARRAY:
        (void)snprintf(out, FOUND_TEXT, "an array of %zu", json_array_size(value));
        break;
    case JSON_STRING:
        (void)snprintf(out, FOUND_TEXT, "\"%s\"", word_of(json_string_value(value)).text);
        break;
    case JSON_INTEGER:
    case JSON_REAL:
        (void)snprintf(out, FOUND_TEXT, "%.9g", json_number_value(value));
        break;
    case JSON_TRUE:
    case JSON_FALSE:
        (void)snprintf(out, FOUND_TEXT, "%s", json_is_true(value) ? "true" : "false");
        break;
    case JSON_NULL:
        (void)snprintf(out, FOUND_TEXT, "null");
        break;
    default:
        (void)snprintf(out, FOUND_TEXT, "nothing");
        break;
    }
}

mrt_result json_place_unexpected(error *err, const json_place *at, const char *expected)
{
    char found[FOUND_TEXT];
    describe(found, at->value);
    return error_set(err, MRT_ERR_FORMAT, "%s: expected %s, found %s", at->text, expected, found);
}

mrt_result json_place_object(const json_place *at, const char *expected, error *err)
{
    return json_is_object(at->value) ? MRT_OK : json_place_unexpected(err, at, expected);
}

mrt_result json_place_number(double *out, const json_place *at, double low, double high, error *err)
{
    double value = json_number_value(at->value);
    if (!json_is_number(at->value) || !(value >= low && value <= high)) {
        char expected[EXPECTED_TEXT];
        (void)snprintf(expected, sizeof expected, "a number from %g to %g", low, high);
        return json_place_unexpected(err, at, expected);
    }
    *out = value;
    return MRT_OK;
}

mrt_result json_place_pair(double out[2], const json_place *at, double low, double high, error *err)
{
    if (!json_is_array(at->value) || json_array_size(at->value) != 2)
        return json_place_unexpected(err, at, "two numbers [a, b]");
    mrt_result result = MRT_OK;
    for (size_t i = 0; i < 2 && result >= 0; ++i) {
        json_place item = json_place_item(at, i);
        result = json_place_number(&out[i], &item, low, high, err);
    }
    return result;
}

mrt_result json_place_text(char *out, size_t capacity, const json_place *at, error *err)
{
    const char *text = json_string_value(at->value);
    size_t length = json_string_length(at->value);
    if (!text || length >= capacity || !text_is_printable(text_view_of(text, length))) {
        char expected[EXPECTED_TEXT];
        (void)snprintf(expected, sizeof expected,
                       "a text of at most %zu bytes without control characters", capacity - 1);
        return json_place_unexpected(err, at, expected);
    }
    memcpy(out, text, length + 1);
    return MRT_OK;
}

mrt_result json_place_choice(uint32_t *out, const json_place *at, const char *const *words,
                             uint32_t count, error *err)
{
    const char *text = json_string_value(at->value);
    for (uint32_t i = 0; text && i < count; ++i) {
        if (strcmp(text, words[i]) != 0)
            continue;
        *out = i;
        return MRT_OK;
    }
    char expected[EXPECTED_TEXT];
    size_t used = 0;
    for (uint32_t i = 0; i < count && used < sizeof expected; ++i) {
        const char *joint = i == 0 ? "" : i + 1 == count ? " or " : ", ";
        int added = snprintf(expected + used, sizeof expected - used, "%s\"%s\"", joint, words[i]);
        used += added > 0 ? (size_t)added : 0;
    }
    return json_place_unexpected(err, at, expected);
}
