#include "take/edit.h"

#include "base/text.h"
#include "take/edit_parts.h"

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FOUND_TEXT = 96 };

static mrt_result no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory for an edit");
}

/* ---- reading ---- */

/* What a value is, for messages. */
static void describe_value(char out[FOUND_TEXT], const json_t *value)
{
    char word[64];
    switch (json_typeof(value)) {
    case JSON_STRING:
        text_copy(word, sizeof word,
                  text_view_of(json_string_value(value), json_string_length(value)));
        (void)snprintf(out, FOUND_TEXT, "\"%s\"", word);
        break;
    case JSON_INTEGER:
        (void)snprintf(out, FOUND_TEXT, "%lld", (long long)json_integer_value(value));
        break;
    case JSON_REAL:
        (void)snprintf(out, FOUND_TEXT, "%.9g", json_real_value(value));
        break;
    case JSON_ARRAY:
        (void)snprintf(out, FOUND_TEXT, "an array of %zu", json_array_size(value));
        break;
    case JSON_OBJECT:
        (void)snprintf(out, FOUND_TEXT, "an object");
        break;
    default:
        (void)snprintf(out, FOUND_TEXT, "%s",
                       json_is_true(value)    ? "true"
                       : json_is_false(value) ? "false"
                                              : "null");
        break;
    }
}

static mrt_result unexpected(error *err, const edit_argument *argument, const json_t *value)
{
    char found[FOUND_TEXT];
    describe_value(found, value);
    return edit_unexpected(err, argument, found);
}

static mrt_result read_scalar(char *at, const edit_argument *argument, const json_t *value,
                              error *err)
{
    int64_t integer = json_integer_value(value);
    uint32_t count = (uint32_t)integer;
    double number = json_number_value(value);
    bool flag = json_is_true(value), fits;
    if (argument->kind == EDIT_NUMBER)
        fits = json_is_number(value);
    else if (argument->kind == EDIT_FLAG)
        fits = json_is_boolean(value);
    else
        fits = json_is_integer(value) && integer >= argument->low && integer <= argument->high;
    if (!fits)
        return unexpected(err, argument, value);
    const void *from = argument->kind == EDIT_NUMBER  ? (const void *)&number
                       : argument->kind == EDIT_FLAG  ? (const void *)&flag
                       : argument->kind == EDIT_COUNT ? (const void *)&count
                                                      : (const void *)&integer;
    memcpy(at, from, argument->size);
    return MRT_OK;
}

static mrt_result read_text(char *at, const edit_argument *argument, const json_t *value,
                            error *err)
{
    if (!json_is_string(value) || json_string_length(value) >= argument->size)
        return unexpected(err, argument, value);
    memcpy(at, json_string_value(value), json_string_length(value));
    return MRT_OK;
}

static mrt_result read_own(edit *e, const edit_argument *argument, const json_t *value, error *err)
{
    size_t count = json_array_size(value);
    if (!json_is_array(value) || count > EDIT_OWN_MAX)
        return unexpected(err, argument, value);
    e->own = calloc(count + 1, sizeof *e->own);
    if (!e->own)
        return no_memory(err);
    for (size_t i = 0; i < count; ++i) {
        const json_t *item = json_array_get(value, i);
        if (!json_is_string(item) || json_string_length(item) >= TAKE_NAME)
            return unexpected(err, argument, item);
        memcpy(e->own[i], json_string_value(item), json_string_length(item));
    }
    e->own_count = (uint32_t)count;
    return MRT_OK;
}

static mrt_result read_layers(edit *e, const edit_argument *argument, const json_t *value,
                              error *err)
{
    size_t count = json_array_size(value);
    if (count < 1 || count > EDIT_LAYERS_MAX)
        return unexpected(err, argument, value);
    for (size_t i = 0; i < count; ++i) {
        const json_t *item = json_array_get(value, i);
        int64_t id = json_integer_value(item);
        if (!json_is_integer(item) || id < 1 || id >= UINT32_MAX)
            return unexpected(err, argument, item);
        e->layers[i] = (uint32_t)id;
    }
    e->layer_count = (uint32_t)count;
    return MRT_OK;
}

static mrt_result read_regions(edit *e, const edit_argument *argument, const json_t *value,
                               error *err)
{
    size_t count = json_array_size(value);
    if (count < 1 || count > OWN_REGION_COUNT)
        return unexpected(err, argument, value);
    for (size_t i = 0; i < count; ++i) {
        const json_t *item = json_array_get(value, i);
        own_region region = OWN_MOUTH;
        if (!json_is_string(item) || !own_region_named(json_string_value(item), &region) ||
            (e->regions & 1u << region))
            return unexpected(err, argument, item);
        e->regions |= 1u << region;
    }
    return MRT_OK;
}

static mrt_result read_warp(edit *e, const edit_argument *argument, const json_t *value, error *err)
{
    size_t count = json_array_size(value);
    if (count < 1 || count > EDIT_WARP_MAX)
        return unexpected(err, argument, value);
    e->warp = calloc(count, sizeof *e->warp);
    if (!e->warp)
        return no_memory(err);
    for (size_t i = 0; i < count; ++i) {
        const json_t *item = json_array_get(value, i);
        const json_t *at = json_array_get(item, 0), *source = json_array_get(item, 1);
        if (json_array_size(item) != 2 || !json_is_integer(at) || !json_is_integer(source))
            return unexpected(err, argument, item);
        e->warp[i] = (take_warp_point){json_integer_value(at), json_integer_value(source)};
    }
    e->warp_count = (uint32_t)count;
    return MRT_OK;
}

static mrt_result read_argument(edit *e, const edit_argument *argument, const json_t *value,
                                error *err)
{
    switch (argument->kind) {
    case EDIT_LINE:
    case EDIT_PROSE:
        return read_text((char *)e + argument->offset, argument, value, err);
    case EDIT_OWN:
        return read_own(e, argument, value, err);
    case EDIT_LAYERS:
        return read_layers(e, argument, value, err);
    case EDIT_REGIONS:
        return read_regions(e, argument, value, err);
    case EDIT_WARP:
        return read_warp(e, argument, value, err);
    default:
        return read_scalar((char *)e + argument->offset, argument, value, err);
    }
}

static mrt_result read_kind(edit_kind *out, const json_t *object, error *err)
{
    const json_t *op = json_object_get(object, "op");
    if (!json_is_string(op))
        return error_set(err, MRT_ERR_FORMAT,
                         "$.op: expected the name of an operation, such as \"clip.trim\"");
    *out = edit_kind_named(json_string_value(op));
    if (*out != EDIT_NONE)
        return MRT_OK;
    char found[FOUND_TEXT];
    describe_value(found, op);
    return error_set(err, MRT_ERR_UNSUPPORTED,
                     "$.op: this version knows no edit %s; a newer marotte may have made it",
                     found);
}

static bool is_used(const edit_use *use, uint32_t count, const char *key)
{
    for (uint32_t i = 0; i < count; ++i)
        if (strcmp(use[i].argument->key, key) == 0)
            return true;
    return false;
}

static mrt_result refuse_unknown_keys(const edit_use *use, uint32_t count, edit_kind kind,
                                      json_t *object, error *err)
{
    const char *key;
    json_t *value;
    json_object_foreach(object, key, value)
    {
        if (strcmp(key, "op") == 0 || is_used(use, count, key))
            continue;
        char word[64];
        text_copy(word, sizeof word, text_view_of(key, strlen(key)));
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "$.%s: this version knows no such argument of %s; a newer marotte may "
                         "have made it",
                         word, edit_name(kind));
    }
    return MRT_OK;
}

static mrt_result read_edit(edit *e, json_t *object, error *err)
{
    edit_kind kind = EDIT_NONE;
    edit_use use[EDIT_ARGUMENTS_MAX];
    mrt_result result = read_kind(&kind, object, err);
    if (result < 0)
        return result;
    uint32_t count = edit_uses(use, kind);
    edit_init(e, kind);
    result = refuse_unknown_keys(use, count, kind, object, err);
    for (uint32_t i = 0; result >= 0 && i < count; ++i) {
        const json_t *value = json_object_get(object, use[i].argument->key);
        if (value)
            result = read_argument(e, use[i].argument, value, err);
        else if (!use[i].is_optional)
            result = edit_unexpected(err, use[i].argument, "nothing");
    }
    return result < 0 ? result : edit_check_arguments(e, err);
}

mrt_result edit_parse(edit *out, const char *text, size_t size, error *err)
{
    *out = (edit){0};
    if (size > EDIT_BYTES_MAX)
        return error_set(err, MRT_ERR_FORMAT, "$: an edit of %zu bytes; expected at most %d", size,
                         EDIT_BYTES_MAX);
    json_error_t where;
    json_t *object = json_loadb(text, size, JSON_REJECT_DUPLICATES, &where);
    if (!object) {
        char why[JSON_ERROR_TEXT_LENGTH];
        text_copy(why, sizeof why, text_view_of(where.text, strlen(where.text)));
        return error_set(err, MRT_ERR_FORMAT, "$: byte %d is not JSON: %s", where.position, why);
    }
    mrt_result result =
        json_is_object(object)
            ? read_edit(out, object, err)
            : error_set(err, MRT_ERR_FORMAT, "$: expected an object such as {\"op\":\"...\"}");
    json_decref(object);
    if (result < 0)
        edit_finish(out);
    return result;
}

/* ---- writing ---- */

static json_t *number_array(const uint32_t *number, uint32_t count)
{
    json_t *array = json_array();
    for (uint32_t i = 0; array && i < count; ++i)
        if (json_array_append_new(array, json_integer(number[i])) < 0) {
            json_decref(array);
            return NULL;
        }
    return array;
}

static json_t *own_array(const edit *e)
{
    json_t *array = json_array();
    for (uint32_t i = 0; array && i < e->own_count; ++i)
        if (json_array_append_new(array, json_string(e->own[i])) < 0) {
            json_decref(array);
            return NULL;
        }
    return array;
}

static json_t *region_array(const edit *e)
{
    json_t *array = json_array();
    for (uint32_t i = 0; array && i < OWN_REGION_COUNT; ++i)
        if ((e->regions & 1u << i) &&
            json_array_append_new(array, json_string(own_part_of((own_region)i)->name)) < 0) {
            json_decref(array);
            return NULL;
        }
    return array;
}

static json_t *warp_array(const edit *e)
{
    json_t *array = json_array();
    for (uint32_t i = 0; array && i < e->warp_count; ++i)
        if (json_array_append_new(array, json_pack("[I,I]", (json_int_t)e->warp[i].at_ns,
                                                   (json_int_t)e->warp[i].source_ns)) < 0) {
            json_decref(array);
            return NULL;
        }
    return array;
}

static json_t *written(const edit *e, const edit_argument *argument)
{
    const char *at = (const char *)e + argument->offset;
    uint32_t count;
    int64_t integer;
    double number;
    bool flag;
    switch (argument->kind) {
    case EDIT_COUNT:
        memcpy(&count, at, sizeof count);
        return json_integer(count);
    case EDIT_INTEGER:
        memcpy(&integer, at, sizeof integer);
        return json_integer(integer);
    case EDIT_NUMBER:
        memcpy(&number, at, sizeof number);
        return json_real(number);
    case EDIT_FLAG:
        memcpy(&flag, at, sizeof flag);
        return json_boolean(flag);
    case EDIT_LINE:
    case EDIT_PROSE:
        return json_string(at); /* NULL: not UTF-8 */
    case EDIT_OWN:
        return own_array(e);
    case EDIT_LAYERS:
        return number_array(e->layers, e->layer_count);
    case EDIT_REGIONS:
        return region_array(e);
    case EDIT_WARP:
        return warp_array(e);
    }
    return NULL;
}

mrt_result edit_write(char **out, const edit *e, error *err)
{
    *out = NULL;
    mrt_result result = edit_check_arguments(e, err);
    if (result < 0)
        return result;
    edit_use use[EDIT_ARGUMENTS_MAX];
    uint32_t count = edit_uses(use, e->kind);
    json_t *object = json_pack("{s:s}", "op", edit_name(e->kind));
    for (uint32_t i = 0; object && i < count; ++i) {
        const edit_argument *argument = use[i].argument;
        if (use[i].is_optional && !edit_says(e, argument))
            continue;
        if (json_object_set_new(object, argument->key, written(e, argument)) < 0) {
            json_decref(object);
            return edit_unexpected(err, argument, "a text that is not UTF-8, or no memory");
        }
    }
    *out = object ? json_dumps(object, JSON_COMPACT) : NULL;
    json_decref(object);
    return *out ? MRT_OK : no_memory(err);
}
