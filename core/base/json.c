#include "base/json.h"

#include "base/text.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

json_words json_describe(const json_t *value)
{
    json_words out = {"nothing"};
    switch (value ? (int)json_typeof(value) : -1) {
    case JSON_OBJECT:
        (void)snprintf(out.text, sizeof out.text, "an object");
        break;
    case JSON_ARRAY:
        (void)snprintf(out.text, sizeof out.text, "an array of %zu", json_array_size(value));
        break;
    case JSON_STRING:
        (void)snprintf(out.text, sizeof out.text, "\"%.90s\"",
                       json_shown(json_string_value(value)).text);
        break;
    case JSON_INTEGER:
        (void)snprintf(out.text, sizeof out.text, "%lld", (long long)json_integer_value(value));
        break;
    case JSON_REAL:
        (void)snprintf(out.text, sizeof out.text, "%.9g", json_real_value(value));
        break;
    case JSON_TRUE:
    case JSON_FALSE:
        (void)snprintf(out.text, sizeof out.text, "%s", json_is_true(value) ? "true" : "false");
        break;
    case JSON_NULL:
        (void)snprintf(out.text, sizeof out.text, "null");
        break;
    default:
        break;
    }
    return out;
}

json_words json_shown(const char *text)
{
    enum { SHOWN_BYTES = 64 };
    json_words out;
    text_copy(out.text, SHOWN_BYTES, text_view_of(text, strlen(text)));
    return out;
}

json_t *json_text(const char *text)
{
    char *shown = malloc(strlen(text) + 1), *out = shown;
    while (shown) {
        size_t length = strcspn(text, "\n\t");
        text_copy(out, length + 1, text_view_of(text, length));
        out += strlen(out);
        text += length;
        if (*text == '\0')
            break;
        *out++ = *text++;
    }
    if (!shown)
        return NULL;
    *out = '\0';
    json_t *value = json_string(shown);
    free(shown);
    return value;
}

/* ---- values and their paths ---- */

mrt_result json_parse(json_t **out, const void *data, size_t size, error *err)
{
    json_error_t reason;
    *out = json_loadb(data, size, JSON_REJECT_DUPLICATES, &reason);
    if (*out)
        return MRT_OK;
    return error_set(err, MRT_ERR_FORMAT, "line %d, column %d: is not JSON: %s", reason.line,
                     reason.column, json_shown(reason.text).text);
}

json_node json_node_root(const json_t *value, const char *name)
{
    json_node out = {value, {"$"}};
    if (name)
        (void)snprintf(out.path.text, sizeof out.path.text, "%.120s: $", name);
    return out;
}

json_node json_node_member(const json_node *of, const char *key)
{
    json_node out = {.value = json_object_get(of->value, key)};
    bool is_quoted = strchr(key, '.') != NULL;
    (void)snprintf(out.path.text, sizeof out.path.text, "%.220s%s%s%s", of->path.text,
                   is_quoted ? "[\"" : ".", json_shown(key).text, is_quoted ? "\"]" : "");
    return out;
}

json_node json_node_item(const json_node *of, size_t index)
{
    json_node out = {.value = json_array_get(of->value, index)};
    (void)snprintf(out.path.text, sizeof out.path.text, "%.290s[%zu]", of->path.text, index);
    return out;
}

const char *json_node_unknown(const json_node *object, const char *const *known, void **at)
{
    json_t *value = (json_t *)(uintptr_t)object->value;
    *at = *at ? json_object_iter_next(value, *at) : json_object_iter(value);
    for (; *at; *at = json_object_iter_next(value, *at)) {
        const char *key = json_object_iter_key(*at);
        const char *const *entry = known;
        while (*entry && strcmp(*entry, key) != 0)
            ++entry;
        if (!*entry)
            return key;
    }
    return NULL;
}

mrt_result json_node_unexpected(error *err, const json_node *at, const char *expected)
{
    return error_set(err, MRT_ERR_FORMAT, "%s: expected %s, found %s", at->path.text, expected,
                     json_describe(at->value).text);
}

mrt_result json_node_version(const json_node *root, const char *key, error *err)
{
    const json_node version = json_node_member(root, key);
    const json_int_t number = json_integer_value(version.value); /* 0: not a whole number */
    if (number == 1)
        return MRT_OK;
    if (number < 1)
        return json_node_unexpected(err, &version, "1, the version of the format");
    return error_set(err, MRT_ERR_UNSUPPORTED,
                     "%s: was made by a newer marotte (version %" JSON_INTEGER_FORMAT
                     ", this one reads 1): update marotte",
                     version.path.text, number);
}

mrt_result json_node_object(const json_node *at, const char *expected, error *err)
{
    return json_is_object(at->value) ? MRT_OK : json_node_unexpected(err, at, expected);
}

mrt_result json_node_array(const json_node *at, const char *expected, size_t item_cap, error *err)
{
    if (!json_is_array(at->value))
        return json_node_unexpected(err, at, expected);
    if (json_array_size(at->value) > item_cap)
        return error_set(err, MRT_ERR_UNSUPPORTED, "%s: %zu entries are too many, at most %zu",
                         at->path.text, json_array_size(at->value), item_cap);
    return MRT_OK;
}

mrt_result json_node_number(double *out, const json_node *at, double low, double high, error *err)
{
    double value = json_number_value(at->value);
    if (!json_is_number(at->value) || !(value >= low && value <= high)) {
        char expected[80];
        (void)snprintf(expected, sizeof expected, "a number from %g to %g", low, high);
        return json_node_unexpected(err, at, expected);
    }
    *out = value;
    return MRT_OK;
}

mrt_result json_node_numbers(double *out, size_t count, const json_node *at, double low,
                             double high, const char *expected, error *err)
{
    if (!json_is_array(at->value) || json_array_size(at->value) != count)
        return json_node_unexpected(err, at, expected);
    mrt_result result = MRT_OK;
    for (size_t i = 0; i < count && result >= 0; ++i) {
        json_node item = json_node_item(at, i);
        result = json_node_number(&out[i], &item, low, high, err);
    }
    return result;
}

mrt_result json_node_flag(bool *out, const json_node *at, error *err)
{
    if (!json_is_boolean(at->value))
        return json_node_unexpected(err, at, "true or false");
    *out = json_is_true(at->value);
    return MRT_OK;
}
