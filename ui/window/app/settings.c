#define _GNU_SOURCE /* renameat2 */
#include "window/app/settings.h"

#include "base/file.h"
#include "base/text.h"

#include <errno.h>
#include <fcntl.h>
#include <jansson.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum {
    SIZE_CAP = 4 << 20,
    KEY_MAX = 256,
    DUMP_FLAGS = JSON_INDENT(2) | JSON_SORT_KEYS,
    ASIDE_NAMES = 100,
    VERSION = 1, /* of the file; raised when an older program would spoil it */
    LAST_PATIENCE_MS = 5000
};

/* A key that every settings file of marotte has: by it a file is known as one. */
static const char own_key[] = "looks";
static const char version_key[] = "version";

struct settings {
    char *path, *folder; /* path "": no file */
    bool is_named;       /* by the person, not the default path */
    json_t *root;        /* values as this program sees them */
    json_t *changes;     /* since the last write: key to value in their order; null: removed */
};

/* ---- the file ---- */

typedef enum content {
    CONTENT_NONE = 0, /* no file yet */
    CONTENT_SETTINGS,
    CONTENT_NEWER,     /* settings that a newer marotte wrote: read, never written */
    CONTENT_FOREIGN,   /* a file with other content, or damaged */
    CONTENT_UNREADABLE /* no permission, a folder, a device, a link that leads nowhere */
} content;

static char *default_path(void)
{
    char path[PATH_MAX];
    error ignored; /* "": nothing is saved */
    (void)!file_home_path(path, sizeof path, FILE_HOME_CONFIG, "window.json", &ignored);
    return strdup(path);
}

/* In the default place any JSON object counts. A file that the person names must be empty of keys
 * or have own_key, because other programs write JSON too. */
static bool is_settings(const settings *self, const json_t *root)
{
    return json_is_object(root) &&
           (!self->is_named || json_object_size(root) == 0 || json_object_get(root, own_key));
}

/* out_root: only with CONTENT_SETTINGS and CONTENT_NEWER. why: a sentence with the path, unless it
 * is CONTENT_SETTINGS or absent. */
static content read_content(const settings *self, json_t **out_root, error *why)
{
    file_bytes bytes;
    json_error_t where = {.line = 1};
    struct stat info;
    *out_root = NULL;
    if (lstat(self->path, &info) != 0 && (errno == ENOENT || errno == ENOTDIR))
        return CONTENT_NONE;
    const mrt_result result = file_read(&bytes, self->path, SIZE_CAP, why);
    if (result < 0)
        return result == MRT_ERR_FORMAT || result == MRT_ERR_UNSUPPORTED ? CONTENT_FOREIGN
                                                                         : CONTENT_UNREADABLE;
    json_t *root = json_loadb((const char *)bytes.data, bytes.size, 0, &where);
    file_bytes_finish(&bytes);
    if (is_settings(self, root)) {
        *out_root = root;
        if (json_integer_value(json_object_get(root, version_key)) <= VERSION)
            return CONTENT_SETTINGS;
        (void)error_set(why, MRT_ERR_UNSUPPORTED,
                        "%s: was written by a newer marotte, so this one does not change it",
                        self->path);
        return CONTENT_NEWER;
    }
    (void)error_set(why, MRT_ERR_FORMAT, "%s: is not a settings file of marotte (line %d: %s)",
                    self->path, root ? 1 : where.line,
                    !root                  ? where.text
                    : json_is_object(root) ? "the key \"looks\" is missing"
                                           : "an object was expected");
    json_decref(root);
    return CONTENT_FOREIGN;
}

/* Never over another file. The damaged file is the default one. */
static bool set_aside(const settings *self, char aside[PATH_MAX])
{
    for (int n = 1; n <= ASIDE_NAMES; ++n) {
        const int length = n > 1 ? snprintf(aside, PATH_MAX, "%s.damaged-%d", self->path, n)
                                 : snprintf(aside, PATH_MAX, "%s.damaged", self->path);
        if (length >= PATH_MAX)
            return false;
        if (renameat2(AT_FDCWD, self->path, AT_FDCWD, aside, RENAME_NOREPLACE) == 0)
            return true;
        if (errno != EEXIST)
            return false;
    }
    return false;
}

static mrt_result refuse(const error *why, error *err)
{
    return error_set(err, MRT_ERR_FORMAT,
                     "%s. It is unchanged: choose another file for the settings", why->text);
}

/* Reads the file. A damaged default file is not an error: the note reports it. */
static mrt_result read_file(settings *self, char *out_note, size_t capacity, error *err)
{
    char aside[PATH_MAX];
    error why = {""};
    json_t *root;
    const content found = self->path[0] ? read_content(self, &root, &why) : CONTENT_NONE;
    if (found == CONTENT_NONE)
        return MRT_OK;
    if (root) {
        json_decref(self->root);
        self->root = root;
    }
    if (found == CONTENT_SETTINGS)
        return MRT_OK;
    if (found == CONTENT_NEWER) {
        (void)snprintf(out_note, capacity, "%s. Changes of the settings are lost at the end",
                       why.text);
        text_make_printable(out_note);
        self->path[0] = '\0';
        return MRT_OK;
    }
    if (self->is_named)
        return refuse(&why, err);
    if (found == CONTENT_FOREIGN && set_aside(self, aside)) {
        (void)snprintf(out_note, capacity,
                       "%s. The file is now %s, and the window starts with default settings",
                       why.text, aside);
    } else {
        (void)snprintf(out_note, capacity, "%s. No settings are kept between runs", why.text);
        self->path[0] = '\0';
    }
    text_make_printable(out_note); /* why: with words of the file */
    return MRT_OK;
}

mrt_result settings_open(settings **out, const char *path, char *out_note, size_t capacity,
                         error *err)
{
    *out = NULL;
    if (capacity)
        out_note[0] = '\0';
    settings *self = calloc(1, sizeof *self);
    if (self) {
        self->is_named = path != NULL;
        self->path = path ? strdup(path) : default_path();
        self->folder = self->path ? file_directory(self->path) : NULL;
        self->root = json_object();
        self->changes = json_object();
    }
    mrt_result result = MRT_OK;
    if (!self || !self->path || !self->folder || !self->root || !self->changes)
        result = error_set(err, MRT_ERR_MEMORY, "no memory for the settings");
    if (result >= 0)
        result = read_file(self, out_note, capacity, err);
    if (result < 0) {
        settings_close(self);
        return result;
    }
    *out = self;
    return MRT_OK;
}

static void write_value(json_t *root, const char *key, json_t *value);

/* The new content of the file: its current values with the changes of this program. NULL: see err.
 */
static json_t *merge(const settings *self, error *err)
{
    char aside[PATH_MAX];
    const char *key;
    error why = {""};
    json_t *root, *value;
    const content found = read_content(self, &root, &why);
    if (found == CONTENT_NEWER) {
        json_decref(root);
        (void)error_set(err, MRT_ERR_UNSUPPORTED, "%s", why.text);
        return NULL;
    }
    if (found == CONTENT_UNREADABLE ||
        (found == CONTENT_FOREIGN && (self->is_named || !set_aside(self, aside)))) {
        (void)refuse(&why, err);
        return NULL;
    }
    if (!root)
        root = json_deep_copy(self->root); /* the file was removed or damaged in the meantime */
    json_object_foreach(self->changes, key, value)
        write_value(root, key, json_is_null(value) ? NULL : json_incref(value));
    if (root && !json_object_get(root, own_key))
        (void)json_object_set_new(root, own_key, json_object());
    if (root)
        (void)json_object_set_new(root, version_key, json_integer(VERSION));
    if (!root)
        (void)error_set(err, MRT_ERR_MEMORY, "%s: no memory to write it", self->path);
    return root;
}

static mrt_result write_merged(settings *self, const char *real, error *err)
{
    json_t *root = merge(self, err);
    if (!root)
        return MRT_ERR_IO;
    char *text = json_dumps(root, DUMP_FLAGS);
    json_decref(root);
    if (!text)
        return error_set(err, MRT_ERR_MEMORY, "%s: no memory to write it", self->path);
    const mrt_result result = file_write(real, text, strlen(text), err);
    free(text);
    return result;
}

/* Only one program at a time reads, merges and writes. */
static mrt_result write_waiting(settings *self, int patience_ms, error *err)
{
    int lock = -1;
    if (json_object_size(self->changes) == 0 || !self->path[0])
        return MRT_OK;
    mrt_result result = self->folder[0] ? file_make_folders(self->folder, err) : MRT_OK;
    if (result < 0)
        return result;
    char *real = realpath(self->path, NULL); /* a link stays a link */
    if (!real)
        real = strdup(self->path);
    if (!real)
        return error_set(err, MRT_ERR_MEMORY, "%s: no memory to write it", self->path);
    if (file_lock_folder(&lock, real, patience_ms) == FILE_LOCK_BUSY)
        result = MRT_END;
    else
        result = write_merged(self, real, err);
    if (lock >= 0)
        close(lock);
    free(real);
    if (result == MRT_OK)
        (void)json_object_clear(self->changes);
    return result;
}

mrt_result settings_write(settings *self, error *err)
{
    return write_waiting(self, 0, err);
}

mrt_result settings_write_last(settings *self, error *err)
{
    const mrt_result result = write_waiting(self, LAST_PATIENCE_MS, err);
    if (result != MRT_END)
        return result;
    return error_set(err, MRT_ERR_IO,
                     "%s: the last changes were not written: another program locks its folder",
                     self->path);
}

void settings_close(settings *self)
{
    if (!self)
        return;
    json_decref(self->changes);
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

/* Takes ownership of the value; NULL removes the key. Replaces values on the path that are not
 * objects. */
static void write_value(json_t *root, const char *key, json_t *value)
{
    char part[KEY_MAX], next[KEY_MAX];
    json_t *at = root;
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
    if (value)
        (void)json_object_set_new(at, part, value);
    else
        (void)json_object_del(at, part);
}

/* As write_value; the change is written to the file later. */
static void put(settings *self, const char *key, json_t *value)
{
    (void)json_object_del(self->changes, key); /* the last change comes last */
    (void)json_object_set_new(self->changes, key, value ? json_deep_copy(value) : json_null());
    write_value(self->root, key, value);
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
