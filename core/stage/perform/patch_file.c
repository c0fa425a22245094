#include "stage/perform/patch_file.h"
#include "base/file.h"
#include "base/installed.h"
#include "base/json.h"
#include "base/text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { JSON_PATH_LENGTH = 96 };

/* ---- read ---- */

static mrt_result unexpected(error *err, const char *json_path, const char *key,
                             const char *expected, const json_t *found)
{
    return error_set(err, MRT_ERR_FORMAT, "%s.%s: expected %s, found %s", json_path, key, expected,
                     json_describe(found).text);
}

/* An object that has none but these keys. */
static mrt_result check_keys(const json_t *object, const char *json_path, const char *const *keys,
                             error *err)
{
    const char *key;
    json_t *value;
    json_object_foreach((json_t *)(uintptr_t)object, key, value)
    {
        const char *const *known = keys;
        while (*known && strcmp(*known, key) != 0)
            ++known;
        char shown[48];
        text_copy(shown, sizeof shown, text_view_of(key, strlen(key)));
        if (!*known)
            return error_set(err, MRT_ERR_FORMAT, "%s: \"%s\" is not known here", json_path, shown);
    }
    return MRT_OK;
}

/* What is left out leaves *out as it is. */
static mrt_result read_text(const json_t *object, const char *json_path, const char *key,
                            char out[PATCH_NAME], error *err)
{
    const json_t *value = json_object_get(object, key);
    const char *text = json_string_value(value);
    size_t length = json_string_length(value);
    if (!value)
        return MRT_OK;
    if (!text || length == 0 || length >= PATCH_NAME || strlen(text) != length ||
        !text_is_printable(text_view_of(text, length)))
        return unexpected(err, json_path, key, "a text of 1 to 63 bytes", value);
    memcpy(out, text, length + 1);
    return MRT_OK;
}

static mrt_result read_number(const json_t *object, const char *json_path, const char *key,
                              double *out, error *err)
{
    const json_t *value = json_object_get(object, key);
    if (!value)
        return MRT_OK;
    if (!json_is_number(value) || !isfinite(json_number_value(value)))
        return unexpected(err, json_path, key, "a number", value);
    *out = json_number_value(value);
    return MRT_OK;
}

static mrt_result read_numbers(const json_t *object, const char *json_path, const char *key,
                               double *out, size_t count, error *err)
{
    const json_t *value = json_object_get(object, key);
    if (!value)
        return MRT_OK;
    bool is_good = json_array_size(value) == count;
    for (size_t i = 0; i < count && is_good; ++i) {
        const json_t *item = json_array_get(value, i);
        is_good = json_is_number(item) && isfinite(json_number_value(item));
        out[i] = json_number_value(item);
    }
    return is_good ? MRT_OK
                   : unexpected(err, json_path, key, count == 2 ? "two numbers" : "three numbers",
                                value);
}

static mrt_result read_flag(const json_t *object, const char *json_path, const char *key, bool *out,
                            error *err)
{
    const json_t *value = json_object_get(object, key);
    if (value && !json_is_boolean(value))
        return unexpected(err, json_path, key, "true or false", value);
    if (value)
        *out = json_is_true(value);
    return MRT_OK;
}

static mrt_result read_from(patch_connection *out, const json_t *item, const char *json_path,
                            error *err)
{
    static const char *const keys[] = {"input", "channel", NULL};
    const json_t *from = json_object_get(item, "from");
    char inside[JSON_PATH_LENGTH + 8];
    if (!json_is_object(from))
        return unexpected(err, json_path, "from", "an object", from);
    (void)snprintf(inside, sizeof inside, "%s.from", json_path);
    mrt_result result = check_keys(from, inside, keys, err);
    if (result >= 0)
        result = read_text(from, inside, "input", out->input, err);
    return result < 0 ? result : read_text(from, inside, "channel", out->channel, err);
}

/* A direction of any length. */
static mrt_result read_way(patch_connection *out, const json_t *to, const char *json_path,
                           error *err)
{
    double way[3] = {0.0, 1.0, 0.0};
    mrt_result result = read_numbers(to, json_path, "way", way, 3, err);
    double length = sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2]);
    if (result >= 0 && !(length > 1e-6 && length < 1e6))
        return unexpected(err, json_path, "way", "a direction", json_object_get(to, "way"));
    double unit = fabs(length - 1.0) < 1e-6 ? 1.0 : 1.0 / length; /* one that was written stays */
    for (int axis = 0; axis < 3 && result >= 0; ++axis)
        out->way[axis] = (float)(way[axis] * unit);
    return result;
}

static mrt_result read_to(patch_connection *out, const json_t *item, const char *json_path,
                          error *err)
{
    static const char *const keys[] = {"param",  "dof",   "contact", "pose",
                                       "action", "shape", "way",     NULL};
    const json_t *to = json_object_get(item, "to");
    char inside[JSON_PATH_LENGTH + 8];
    if (!json_is_object(to))
        return unexpected(err, json_path, "to", "an object", to);
    (void)snprintf(inside, sizeof inside, "%s.to", json_path);
    mrt_result result = check_keys(to, inside, keys, err);
    uint32_t kind_count = 0;
    for (int kind = PATCH_PARAM; kind < PATCH_KINDS && result >= 0; ++kind) {
        if (!json_object_get(to, patch_kind_names[kind]))
            continue;
        kind_count += 1;
        *out = patch_connection_of((patch_kind)kind);
        result = read_text(to, inside, patch_kind_names[kind], out->target, err);
    }
    if (result >= 0 && kind_count != 1)
        return unexpected(err, json_path, "to",
                          "one of param, dof, contact, pose, shape and action", to);
    if (result < 0 || out->kind == PATCH_CONTACT)
        return result < 0 ? result : read_way(out, to, inside, err);
    return json_object_get(to, "way") ? unexpected(err, inside, "way", "it with a contact alone",
                                                   json_object_get(to, "way"))
                                      : MRT_OK;
}

static mrt_result read_mode(patch_connection *out, const json_t *item, const char *json_path,
                            error *err)
{
    const json_t *mode = json_object_get(item, "mode");
    const char *text = json_string_value(mode);
    if (!mode)
        return MRT_OK;
    out->adds = text && strcmp(text, "add") == 0;
    return out->adds || (text && strcmp(text, "instead") == 0)
               ? MRT_OK
               : unexpected(err, json_path, "mode", "\"add\" or \"instead\"", mode);
}

static mrt_result read_connection(patch_connection *out, const json_t *item, const char *json_path,
                                  error *err)
{
    static const char *const keys[] = {"from",     "to",   "in",     "out",   "bend", "ease",
                                       "smooth_s", "mode", "pickup", "muted", NULL};
    if (!json_is_object(item))
        return error_set(err, MRT_ERR_FORMAT, "%s: expected an object, found %s", json_path,
                         json_describe(item).text);
    mrt_result result = check_keys(item, json_path, keys, err);
    if (result >= 0)
        result = read_to(out, item, json_path, err); /* first: it sets the usual values */
    if (result >= 0)
        result = read_from(out, item, json_path, err);
    if (result >= 0)
        result = read_numbers(item, json_path, "in", out->in, 2, err);
    if (result >= 0)
        result = read_numbers(item, json_path, "out", out->out, 2, err);
    if (result >= 0)
        result = read_number(item, json_path, "bend", &out->bend, err);
    if (result >= 0)
        result = read_number(item, json_path, "ease", &out->ease, err);
    if (result >= 0)
        result = read_number(item, json_path, "smooth_s", &out->smooth_s, err);
    if (result >= 0)
        result = read_mode(out, item, json_path, err);
    if (result >= 0)
        result = read_flag(item, json_path, "pickup", &out->picks_up, err);
    return result < 0 ? result : read_flag(item, json_path, "muted", &out->is_muted, err);
}

static mrt_result read_connections(patch *out, const json_t *root, error *err)
{
    const json_t *list = json_object_get(root, "connections");
    if (!json_is_array(list) || json_array_size(list) > PATCH_CONNECTIONS_MAX)
        return unexpected(err, "$", "connections", "an array of at most 64", list);
    out->count = (uint32_t)json_array_size(list);
    for (uint32_t i = 0; i < out->count; ++i) {
        char json_path[JSON_PATH_LENGTH];
        (void)snprintf(json_path, sizeof json_path, "$.connections[%u]", i);
        mrt_result result =
            read_connection(&out->connection[i], json_array_get(list, i), json_path, err);
        if (result < 0)
            return result;
    }
    return MRT_OK;
}

static mrt_result read_patch(patch *out, const json_t *root, error *err)
{
    static const char *const keys[] = {"marotte_patch", "name", "about", "connections", NULL};
    if (!json_is_object(root))
        return error_set(err, MRT_ERR_FORMAT, "$: expected an object, found %s",
                         json_describe(root).text);
    const json_t *version = json_object_get(root, "marotte_patch");
    if (!json_is_integer(version) || json_integer_value(version) != 1)
        return unexpected(err, "$", "marotte_patch", "1", version);
    mrt_result result = check_keys(root, "$", keys, err);
    const json_t *about = json_object_get(root, "about");
    if (result >= 0 && about && !json_is_string(about))
        return unexpected(err, "$", "about", "a text", about);
    if (result >= 0)
        result = read_text(root, "$", "name", out->name, err);
    if (result >= 0)
        result = read_connections(out, root, err);
    return result < 0 ? result : patch_check(out, err);
}

mrt_result patch_file_parse(patch *out, const char *text, size_t size, const char *name, error *err)
{
    json_error_t reason;
    *out = (patch){.name = ""};
    if (size > PATCH_FILE_BYTES_MAX)
        return error_set(err, MRT_ERR_FORMAT, "%s: is larger than a patch can be", name);
    json_t *root = json_loadb(text, size, JSON_REJECT_DUPLICATES, &reason);
    if (!root) {
        char why[JSON_ERROR_TEXT_LENGTH];
        text_copy(why, sizeof why, text_view_of(reason.text, strlen(reason.text)));
        return error_set(err, MRT_ERR_FORMAT, "%s:%d:%d: no JSON: %s", name, reason.line,
                         reason.column, why);
    }
    mrt_result result = read_patch(out, root, err);
    json_decref(root);
    if (result < 0) {
        error_prefix(err, name);
        *out = (patch){.name = ""};
    }
    return result;
}

mrt_result patch_file_read(patch *out, const char *path, error *err)
{
    file_bytes bytes;
    *out = (patch){.name = ""};
    mrt_result result = file_read(&bytes, path, PATCH_FILE_BYTES_MAX, err);
    if (result < 0)
        return result;
    result = patch_file_parse(out, (const char *)bytes.data, bytes.size, path, err);
    file_bytes_finish(&bytes);
    return result;
}

mrt_result patch_file_find(patch *out, const char *given, error *err)
{
    char *path = installed_patch(given);
    *out = (patch){.name = ""};
    if (!path)
        return error_set(err, MRT_ERR_MEMORY, "no memory for a patch");
    mrt_result result = patch_file_read(out, path, err);
    free(path);
    return result;
}

/* ---- written ---- */

static json_t *numbers(const double *value, size_t count)
{
    json_t *out = json_array();
    for (size_t i = 0; out && i < count; ++i)
        (void)json_array_append_new(out, json_real(value[i]));
    return out;
}

static json_t *write_connection(const patch_connection *c)
{
    json_t *from = json_object(), *to = json_object(), *out = json_object();
    if (c->input[0])
        (void)json_object_set_new(from, "input", json_string(c->input));
    (void)json_object_set_new(from, "channel", json_string(c->channel));
    (void)json_object_set_new(to, patch_kind_names[c->kind], json_string(c->target));
    const double way[3] = {(double)c->way[0], (double)c->way[1], (double)c->way[2]};
    if (c->kind == PATCH_CONTACT)
        (void)json_object_set_new(to, "way", numbers(way, 3));
    (void)json_object_set_new(out, "from", from);
    (void)json_object_set_new(out, "to", to);
    if (!isnan(c->in[0]))
        (void)json_object_set_new(out, "in", numbers(c->in, 2));
    if (!isnan(c->out[0]))
        (void)json_object_set_new(out, "out", numbers(c->out, 2));
    if (fabs(c->bend) > 0.0)
        (void)json_object_set_new(out, "bend", json_real(c->bend));
    if (fabs(c->ease) > 0.0)
        (void)json_object_set_new(out, "ease", json_real(c->ease));
    if (c->smooth_s > 0.0)
        (void)json_object_set_new(out, "smooth_s", json_real(c->smooth_s));
    if (c->adds)
        (void)json_object_set_new(out, "mode", json_string("add"));
    if (c->picks_up)
        (void)json_object_set_new(out, "pickup", json_true());
    if (c->is_muted)
        (void)json_object_set_new(out, "muted", json_true());
    return out;
}

static bool reads_equal(const char *text, const patch *p)
{
    error ignored = {""};
    patch *again = malloc(sizeof *again);
    bool is_equal = again && text &&
                    patch_file_parse(again, text, strlen(text), "", &ignored) >= 0 &&
                    patch_equal(again, p);
    free(again);
    return is_equal;
}

/* Digits that people can read, where they say the same. */
mrt_result patch_file_write(char **out, const patch *p, error *err)
{
    json_t *root = json_object(), *list = json_array();
    *out = NULL;
    (void)json_object_set_new(root, "marotte_patch", json_integer(1));
    if (p->name[0])
        (void)json_object_set_new(root, "name", json_string(p->name));
    for (uint32_t i = 0; i < p->count; ++i)
        (void)json_array_append_new(list, write_connection(&p->connection[i]));
    (void)json_object_set_new(root, "connections", list);
    bool is_whole = root && json_array_size(list) == p->count &&
                    json_object_size(root) == (p->name[0] ? 3u : 2u);
    if (is_whole)
        *out = json_dumps(root, JSON_INDENT(2) | JSON_REAL_PRECISION(7));
    if (*out && !reads_equal(*out, p)) {
        free(*out);
        *out = json_dumps(root, JSON_INDENT(2) | JSON_REAL_PRECISION(17));
    }
    json_decref(root);
    return *out ? MRT_OK : error_set(err, MRT_ERR_MEMORY, "no memory to write a patch");
}
