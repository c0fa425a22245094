#include "stage/perform/patch_file.h"
#include "base/file.h"
#include "base/installed.h"
#include "base/json.h"
#include "base/text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- reading ---- */

static const double number_cap = 1e300; /* finite */

/* Checks that an object has only these keys. */
static mrt_result check_keys(const json_node *object, const char *const *keys, error *err)
{
    void *at = NULL;
    const char *key = json_node_unknown(object, keys, &at);
    return key ? error_set(err, MRT_ERR_FORMAT, "%s: unknown key \"%s\"", object->path.text,
                           json_shown(key).text)
               : MRT_OK;
}

/* Reads an optional text. A missing key does not change *out. */
static mrt_result read_text(const json_node *object, const char *key, char out[PATCH_NAME],
                            error *err)
{
    json_node at = json_node_member(object, key);
    const char *text = json_string_value(at.value);
    size_t length = json_string_length(at.value);
    if (!at.value)
        return MRT_OK;
    if (!text || length == 0 || length >= PATCH_NAME ||
        !text_is_printable(text_view_of(text, length)))
        return json_node_unexpected(err, &at, "a text of 1 to 63 bytes");
    memcpy(out, text, length + 1);
    return MRT_OK;
}

static mrt_result read_number(const json_node *object, const char *key, double *out, error *err)
{
    json_node at = json_node_member(object, key);
    return at.value ? json_node_number(out, &at, -number_cap, number_cap, err) : MRT_OK;
}

static mrt_result read_numbers(const json_node *object, const char *key, double *out, size_t count,
                               error *err)
{
    json_node at = json_node_member(object, key);
    return at.value ? json_node_numbers(out, count, &at, -number_cap, number_cap,
                                        count == 2 ? "two numbers" : "three numbers", err)
                    : MRT_OK;
}

static mrt_result read_flag(const json_node *object, const char *key, bool *out, error *err)
{
    json_node at = json_node_member(object, key);
    return at.value ? json_node_flag(out, &at, err) : MRT_OK;
}

static mrt_result read_from(patch_connection *out, const json_node *item, error *err)
{
    static const char *const keys[] = {"input", "channel", NULL};
    json_node from = json_node_member(item, "from");
    mrt_result result = json_node_object(&from, "an object", err);
    if (result >= 0)
        result = check_keys(&from, keys, err);
    if (result >= 0)
        result = read_text(&from, "input", out->input, err);
    return result < 0 ? result : read_text(&from, "channel", out->channel, err);
}

/* Reads a direction of any length and normalises it. */
static mrt_result read_way(patch_connection *out, const json_node *to, error *err)
{
    double way[3] = {0.0, 1.0, 0.0};
    json_node at = json_node_member(to, "way");
    mrt_result result = read_numbers(to, "way", way, 3, err);
    double length = sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2]);
    if (result >= 0 && !(length > 1e-6 && length < 1e6))
        return json_node_unexpected(err, &at, "a direction");
    double unit = fabs(length - 1.0) < 1e-6 ? 1.0 : 1.0 / length; /* a unit vector keeps its bits */
    for (int axis = 0; axis < 3 && result >= 0; ++axis)
        out->way[axis] = (float)(way[axis] * unit);
    return result;
}

static mrt_result read_to(patch_connection *out, const json_node *item, error *err)
{
    static const char *const keys[] = {"param",  "dof",   "contact", "pose",
                                       "action", "shape", "way",     NULL};
    json_node to = json_node_member(item, "to"), way = json_node_member(&to, "way");
    mrt_result result = json_node_object(&to, "an object", err);
    if (result >= 0)
        result = check_keys(&to, keys, err);
    uint32_t kind_count = 0;
    for (int kind = PATCH_PARAM; kind < PATCH_KINDS && result >= 0; ++kind) {
        if (!json_object_get(to.value, patch_kind_names[kind]))
            continue;
        kind_count += 1;
        *out = patch_connection_of((patch_kind)kind);
        result = read_text(&to, patch_kind_names[kind], out->target, err);
    }
    if (result >= 0 && kind_count != 1)
        return json_node_unexpected(err, &to, "one of param, dof, contact, pose, shape and action");
    if (result < 0 || out->kind == PATCH_CONTACT)
        return result < 0 ? result : read_way(out, &to, err);
    return way.value ? json_node_unexpected(err, &way, "it with a contact alone") : MRT_OK;
}

static mrt_result read_mode(patch_connection *out, const json_node *item, error *err)
{
    json_node mode = json_node_member(item, "mode");
    const char *text = json_string_value(mode.value);
    if (!mode.value)
        return MRT_OK;
    out->adds = text && strcmp(text, "add") == 0;
    return out->adds || (text && strcmp(text, "instead") == 0)
               ? MRT_OK
               : json_node_unexpected(err, &mode, "\"add\" or \"instead\"");
}

static mrt_result read_connection(patch_connection *out, const json_node *item, error *err)
{
    static const char *const keys[] = {"from",     "to",   "in",     "out",   "bend", "ease",
                                       "smooth_s", "mode", "pickup", "muted", NULL};
    mrt_result result = json_node_object(item, "an object", err);
    if (result >= 0)
        result = check_keys(item, keys, err);
    if (result >= 0)
        result = read_to(out, item, err); /* first: it sets the default values */
    if (result >= 0)
        result = read_from(out, item, err);
    if (result >= 0)
        result = read_numbers(item, "in", out->in, 2, err);
    if (result >= 0)
        result = read_numbers(item, "out", out->out, 2, err);
    if (result >= 0)
        result = read_number(item, "bend", &out->bend, err);
    if (result >= 0)
        result = read_number(item, "ease", &out->ease, err);
    if (result >= 0)
        result = read_number(item, "smooth_s", &out->smooth_s, err);
    if (result >= 0)
        result = read_mode(out, item, err);
    if (result >= 0)
        result = read_flag(item, "pickup", &out->picks_up, err);
    return result < 0 ? result : read_flag(item, "muted", &out->is_muted, err);
}

static mrt_result read_connections(patch *out, const json_node *root, error *err)
{
    json_node list = json_node_member(root, "connections");
    if (!json_is_array(list.value) || json_array_size(list.value) > PATCH_CONNECTIONS_MAX)
        return json_node_unexpected(err, &list, "an array of at most 64");
    out->count = (uint32_t)json_array_size(list.value);
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; i < out->count && result >= 0; ++i) {
        json_node item = json_node_item(&list, i);
        result = read_connection(&out->connection[i], &item, err);
    }
    return result;
}

static mrt_result read_patch(patch *out, const json_node *root, error *err)
{
    static const char *const keys[] = {"marotte_patch", "name", "about", "connections", NULL};
    json_node about = json_node_member(root, "about");
    mrt_result result = json_node_object(root, "an object", err);
    if (result < 0)
        return result;
    result = json_node_version(root, "marotte_patch", err);
    if (result >= 0)
        result = check_keys(root, keys, err);
    if (result >= 0 && about.value && !json_is_string(about.value))
        return json_node_unexpected(err, &about, "a text");
    if (result >= 0)
        result = read_text(root, "name", out->name, err);
    if (result >= 0)
        result = read_connections(out, root, err);
    return result < 0 ? result : patch_check(out, err);
}

mrt_result patch_file_parse(patch *out, const char *text, size_t size, const char *name, error *err)
{
    json_t *value;
    *out = (patch){.name = ""};
    if (size > PATCH_FILE_BYTES_MAX)
        return error_set(err, MRT_ERR_FORMAT, "%s: the file is too large for a patch", name);
    mrt_result result = json_parse(&value, text, size, err);
    if (result >= 0) {
        json_node root = json_node_root(value, NULL);
        result = read_patch(out, &root, err);
        json_decref(value);
    }
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
    char *path = installed_path(INSTALLED_PATCH, given);
    *out = (patch){.name = ""};
    if (!path)
        return error_set(err, MRT_ERR_MEMORY, "no memory for a patch");
    mrt_result result = installed_check(INSTALLED_PATCH, path, err);
    if (result >= 0)
        result = patch_file_read(out, path, err);
    free(path);
    return result;
}

/* ---- writing ---- */

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

/* Writes 7 digits, which are easy to read, or 17 if 7 do not give an equal patch. */
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
