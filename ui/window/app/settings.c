#include "window/app/settings.h"

#include "base/file.h"
#include "base/text.h"

#include <errno.h>
#include <jansson.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { SIZE_CAP = 4 << 20, KEY_MAX = 256, DUMP_FLAGS = JSON_INDENT(2) | JSON_SORT_KEYS };

struct settings {
    char *path, *folder; /* "": nothing is written */
    json_t *root;
    bool has_changed;
};

/* ---- the file ---- */

static char *default_path(void)
{
    char path[PATH_MAX];
    error ignored; /* "": nothing is kept */
    (void)!file_home_path(path, sizeof path, FILE_HOME_CONFIG, "window.json", &ignored);
    return strdup(path);
}

static void set_aside(settings *self, const char *why, char *out_note, size_t capacity)
{
    char aside[PATH_MAX];
    const int length = snprintf(aside, sizeof aside, "%s.damaged", self->path);
    const bool is_aside = length < (int)sizeof aside && rename(self->path, aside) == 0;
    (void)snprintf(out_note, capacity,
                   is_aside ? "the settings made no sense (%s): they are in %s now, and the "
                              "window starts as new"
                            : "the settings make no sense (%s): %s is not used, and the window "
                              "starts as new",
                   why, is_aside ? aside : self->path);
    text_make_printable(out_note); /* why: with words of the file */
}

/* Reads the file. One that is no JSON object is renamed (set_aside); one without permission to read
 * is left alone, and nothing is kept then. */
static void read_file(settings *self, char *out_note, size_t capacity)
{
    file_bytes bytes;
    error err = {0};
    json_error_t where;
    struct stat info;
    if (!self->path[0] || (stat(self->path, &info) != 0 && (errno == ENOENT || errno == ENOTDIR)))
        return;
    if (access(self->path, R_OK) != 0) {
        (void)snprintf(out_note, capacity, "%s cannot be read: %s; nothing is kept between runs",
                       self->path, strerror(errno));
        self->path[0] = '\0';
        return;
    }
    if (file_read(&bytes, self->path, SIZE_CAP, &err) < 0) {
        set_aside(self, err.text, out_note, capacity);
        return;
    }
    json_t *root = json_loadb((const char *)bytes.data, bytes.size, 0, &where);
    file_bytes_finish(&bytes);
    if (!json_is_object(root)) {
        char why[200];
        (void)snprintf(why, sizeof why, "line %d: %s", root ? 1 : where.line,
                       root ? "an object was expected" : where.text);
        set_aside(self, why, out_note, capacity);
        json_decref(root);
        return;
    }
    json_decref(self->root);
    self->root = root;
}

mrt_result settings_open(settings **out, const char *path, char *out_note, size_t capacity,
                         error *err)
{
    *out = NULL;
    if (capacity)
        out_note[0] = '\0';
    settings *self = calloc(1, sizeof *self);
    if (self) {
        self->path = path ? strdup(path) : default_path();
        self->folder = self->path ? file_directory(self->path) : NULL;
        self->root = json_object();
    }
    if (!self || !self->path || !self->folder || !self->root) {
        settings_close(self);
        return error_set(err, MRT_ERR_MEMORY, "no memory for the settings");
    }
    read_file(self, out_note, capacity);
    *out = self;
    return MRT_OK;
}

mrt_result settings_write(settings *self, error *err)
{
    if (!self->has_changed || !self->path[0])
        return MRT_OK;
    char *text = json_dumps(self->root, DUMP_FLAGS);
    if (!text)
        return error_set(err, MRT_ERR_MEMORY, "%s: no memory to write it", self->path);
    mrt_result result = self->folder[0] ? file_make_folders(self->folder, err) : MRT_OK;
    if (result >= 0)
        result = file_write(self->path, text, strlen(text), err);
    free(text);
    self->has_changed = result < 0;
    return result;
}

void settings_close(settings *self)
{
    if (!self)
        return;
    json_decref(self->root);
    free(self->folder);
    free(self->path);
    free(self);
}

const char *settings_folder(const settings *self)
{
    return self->path[0] ? self->folder : "";
}

/* ---- values ---- */

/* The next part of a path of keys; false: that was all. */
static bool next_part(const char **key, char out[KEY_MAX])
{
    const char *dot = strchr(*key, '.');
    const size_t length = dot ? (size_t)(dot - *key) : strlen(*key);
    if (length == 0 || length >= KEY_MAX)
        return false;
    memcpy(out, *key, length);
    out[length] = '\0';
    *key += length + (dot ? 1 : 0);
    return true;
}

static json_t *find(const settings *self, const char *key)
{
    char part[KEY_MAX];
    json_t *at = self->root;
    while (at && next_part(&key, part))
        at = json_object_get(at, part);
    return at;
}

double settings_number(const settings *self, const char *key, double otherwise)
{
    const json_t *value = find(self, key);
    return json_is_number(value) ? json_number_value(value) : otherwise;
}

const char *settings_text(const settings *self, const char *key, const char *otherwise)
{
    const json_t *value = find(self, key);
    return json_is_string(value) ? json_string_value(value) : otherwise;
}

/* Takes the value over; NULL removes the key. Values on the path that are no objects are replaced.
 */
static void put(settings *self, const char *key, json_t *value)
{
    char part[KEY_MAX], next[KEY_MAX];
    json_t *at = self->root;
    if (!next_part(&key, part)) {
        json_decref(value);
        return;
    }
    while (next_part(&key, next)) {
        json_t *below = json_object_get(at, part);
        if (!json_is_object(below)) {
            below = json_object();
            if (json_object_set_new(at, part, below) != 0)
                break;
        }
        at = below;
        memcpy(part, next, sizeof part);
    }
    if (value ? json_object_set_new(at, part, value) == 0 : json_object_del(at, part) == 0)
        self->has_changed = true;
}

void settings_set_number(settings *self, const char *key, double value)
{
    const json_t *before = find(self, key);
    if (!isfinite(value) || (json_is_number(before) && json_number_value(before) == value))
        return;
    const bool is_whole = value == floor(value) && fabs(value) < 1e15;
    put(self, key, is_whole ? json_integer((json_int_t)value) : json_real(value));
}

void settings_set_text(settings *self, const char *key, const char *value)
{
    const json_t *before = find(self, key);
    if (!value && !before)
        return;
    if (value && json_is_string(before) && strcmp(json_string_value(before), value) == 0)
        return;
    if (!value) {
        put(self, key, NULL);
        return;
    }
    json_t *text = json_string(value); /* NULL: it is no UTF-8, as paths may be */
    if (text)
        put(self, key, text);
}

uint32_t settings_list(const settings *self, const char *key, const char **out, uint32_t most)
{
    const json_t *list = find(self, key);
    uint32_t count = 0;
    for (uint32_t i = 0; i < most; ++i) {
        char index[16];
        (void)snprintf(index, sizeof index, "%u", i);
        const char *text = json_string_value(json_object_get(list, index));
        if (text && text[0])
            out[count++] = text;
    }
    return count;
}

void settings_set_list(settings *self, const char *key, const char *const *texts, uint32_t count,
                       uint32_t most)
{
    json_t *before = find(self, key);
    json_t *list = json_is_object(before) ? json_copy(before) : json_object();
    for (uint32_t i = 0; list && i < most; ++i) {
        char index[16];
        (void)snprintf(index, sizeof index, "%u", i);
        if (i < count)
            (void)json_object_set_new(list, index, json_string(texts[i]));
        else
            (void)json_object_del(list, index);
    }
    if (list && (before || json_object_size(list) > 0) && !json_equal(list, before))
        put(self, key, list);
    else
        json_decref(list);
}

uint32_t settings_keys(const settings *self, const char *key, char ***out)
{
    json_t *object = find(self, key), *value;
    const char *name;
    size_t count = json_object_size(object), size = count * sizeof(char *);
    *out = NULL;
    json_object_foreach(object, name, value) size += strlen(name) + 1;
    char **list = count ? malloc(size) : NULL;
    if (!list)
        return 0;
    char *at = (char *)(list + count);
    uint32_t index = 0;
    json_object_foreach(object, name, value)
    {
        const size_t length = strlen(name) + 1;
        list[index++] = memcpy(at, name, length);
        at += length;
    }
    *out = list;
    return index;
}
