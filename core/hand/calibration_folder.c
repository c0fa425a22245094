#include "hand/calibration_folder.h"

#include "base/file.h"
#include "base/text.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { FILES_CAP = 4096 }; /* a folder with more files is not read */

static char *joined(const char *a, const char *b, const char *c)
{
    size_t size = strlen(a) + strlen(b) + strlen(c) + 1;
    char *out = malloc(size);
    if (out)
        (void)snprintf(out, size, "%s%s%s", a, b, c);
    return out;
}

/* Returns $XDG_CONFIG_HOME/marotte/calibrations, or ~/.config/marotte/calibrations, without a final
 * '/'. The caller frees it. NULL: no memory, or neither variable is an absolute path. */
static char *calibration_folder_path(void)
{
    const char *config = getenv("XDG_CONFIG_HOME"), *home = getenv("HOME");
    if (config && config[0] == '/')
        return joined(config, "/marotte/calibrations", "");
    if (home && home[0] == '/')
        return joined(home, "/.config/marotte/calibrations", "");
    return NULL;
}

static bool is_file_name(const char *name)
{
    size_t length = strlen(name);
    if (length == 0 || length >= CALIBRATION_NAME || name[0] == '.')
        return false;
    for (const char *at = name; *at; ++at)
        if (*at == '/' || (unsigned char)*at < 0x20 || *at == 0x7f)
            return false;
    return true;
}

mrt_result calibration_folder_place(char **out_path, const char *name, const char *input,
                                    error *err)
{
    *out_path = NULL;
    if (!is_file_name(name))
        return error_set(err, MRT_ERR_ARGUMENT,
                         "the name of a calibration is 1 to %d letters, without '/' and not "
                         "beginning with '.'",
                         CALIBRATION_NAME - 1);
    char *folder = calibration_folder_path();
    if (!folder)
        return error_set(err, MRT_ERR_IO,
                         "cannot find the folder of calibrations: set XDG_CONFIG_HOME or HOME");
    mrt_result result = file_make_folders(folder, err);
    char *base = joined(folder, "/", name);
    *out_path = base ? joined(base, input[0] ? ", " : "", input[0] ? input : "") : NULL;
    free(base);
    base = *out_path;
    *out_path = base ? joined(base, ".json", "") : NULL;
    if (result >= 0 && !*out_path)
        result = error_set(err, MRT_ERR_MEMORY, "no memory");
    if (result < 0) {
        free(*out_path);
        *out_path = NULL;
    }
    free(base);
    free(folder);
    return result;
}

static bool is_json(const char *name)
{
    size_t length = strlen(name);
    return length > 5 && name[0] != '.' && strcmp(name + length - 5, ".json") == 0;
}

/* Compares by date, then by path, so that the result does not depend on the order of the folder. */
static bool is_newer(const calibration_file *a, const char *a_path, const calibration_file *b,
                     const char *b_path)
{
    int order = strcmp(a->date, b->date);
    return order != 0 ? order > 0 : strcmp(a_path, b_path) > 0;
}

typedef struct found {
    calibration_file *file; /* the newest so far; finished when it is replaced */
    char *path;             /* NULL: none yet */
} found;

/* Takes ownership of `path`. */
static mrt_result consider(found *best, char *path, uint32_t side, const char *input,
                           error *out_note, error *err)
{
    calibration_file *file = malloc(sizeof *file);
    if (!file) {
        free(path);
        return error_set(err, MRT_ERR_MEMORY, "no memory for a calibration");
    }
    error why = {""};
    if (calibration_file_read(file, path, &why) < 0) {
        if (!out_note->text[0])
            *out_note = why;
        free(path);
    } else if (file->side == side && strcmp(file->input, input) == 0 &&
               (!best->path || is_newer(file, path, best->file, best->path))) {
        if (best->path)
            calibration_file_finish(best->file);
        free(best->path);
        *best->file = *file;
        best->path = path;
    } else {
        calibration_file_finish(file);
        free(path);
    }
    free(file);
    return MRT_OK;
}

mrt_result calibration_folder_newest(calibration_file *out, char **out_path, uint32_t side,
                                     const char *input, error *out_note, error *err)
{
    *out_path = NULL;
    out_note->text[0] = '\0';
    calibration_file_init(out, side);
    char *folder = calibration_folder_path();
    DIR *directory = folder ? opendir(folder) : NULL;
    if (!directory) {
        free(folder);
        return MRT_END;
    }
    found best = {.file = out};
    mrt_result result = MRT_OK;
    for (uint32_t file_count = 0; result >= 0 && file_count < FILES_CAP; ++file_count) {
        const struct dirent *entry = readdir(directory);
        if (!entry)
            break;
        if (!is_json(entry->d_name))
            continue;
        char *path = joined(folder, "/", entry->d_name);
        result = path ? consider(&best, path, side, input, out_note, err)
                      : error_set(err, MRT_ERR_MEMORY, "no memory for a calibration");
    }
    closedir(directory);
    free(folder);
    if (result < 0) {
        if (best.path)
            calibration_file_finish(out);
        free(best.path);
        return result;
    }
    *out_path = best.path;
    return best.path ? MRT_OK : MRT_END;
}

/* ---- listing all calibrations ---- */

/* Uses the name of the person, or the name of the file if it is empty. */
static void describe(calibration_entry *out, const calibration_file *file, const char *path)
{
    char name[CALIBRATION_NAME];
    (void)snprintf(name, sizeof name, "%s", file->name);
    if (!name[0]) {
        const char *own = file_name_of(path);
        size_t length = strlen(own) - strlen(".json");
        text_copy(name, sizeof name, text_view_of(own, length));
    }
    (void)snprintf(out->date, sizeof out->date, "%s", file->date);
    (void)snprintf(out->label, sizeof out->label, "%s%s%.10s", name, file->date[0] ? ", " : "",
                   file->date);
    out->side = file->side;
    memcpy(out->input, file->input, sizeof out->input);
}

/* Takes ownership of `path`. */
static mrt_result list_file(calibration_list *out, char *path, error *out_note, error *err)
{
    calibration_file *file = malloc(sizeof *file);
    calibration_entry *grown = realloc(out->entry, (out->count + 1) * sizeof *grown);
    if (grown)
        out->entry = grown;
    error why = {""};
    mrt_result result = MRT_OK;
    if (!file || !grown) {
        result = error_set(err, MRT_ERR_MEMORY, "no memory for the list of calibrations");
    } else if (calibration_file_read(file, path, &why) < 0) {
        if (!out_note->text[0])
            *out_note = why;
    } else {
        calibration_entry *entry = &out->entry[out->count++];
        describe(entry, file, path);
        entry->path = path;
        path = NULL;
        calibration_file_finish(file);
    }
    free(file);
    free(path);
    return result;
}

static int newest_first(const void *a, const void *b)
{
    const calibration_entry *one = a, *other = b;
    int order = strcmp(other->date, one->date);
    return order != 0 ? order : strcmp(one->path, other->path);
}

mrt_result calibration_folder_list(calibration_list *out, error *out_note, error *err)
{
    *out = (calibration_list){.count = 0};
    out_note->text[0] = '\0';
    char *folder = calibration_folder_path();
    DIR *directory = folder ? opendir(folder) : NULL;
    mrt_result result = MRT_OK;
    for (uint32_t file_count = 0; directory && result >= 0 && file_count < FILES_CAP;
         ++file_count) {
        const struct dirent *entry = readdir(directory);
        if (!entry)
            break;
        if (!is_json(entry->d_name))
            continue;
        char *path = joined(folder, "/", entry->d_name);
        result = path ? list_file(out, path, out_note, err)
                      : error_set(err, MRT_ERR_MEMORY, "no memory for a calibration");
    }
    if (directory)
        closedir(directory);
    free(folder);
    if (result < 0)
        calibration_list_finish(out);
    else if (out->count > 0)
        qsort(out->entry, out->count, sizeof *out->entry, newest_first);
    return result;
}

void calibration_list_finish(calibration_list *list)
{
    for (uint32_t i = 0; i < list->count; ++i)
        free(list->entry[i].path);
    free(list->entry);
    *list = (calibration_list){.count = 0};
}

/* ---- replacing a calibration ---- */

mrt_result calibration_keep_old(calibration_file *out, const char *path, error *err)
{
    calibration_file_init(out, MRT_RIGHT);
    if (access(path, F_OK) != 0)
        return MRT_OK;
    mrt_result result = calibration_file_read(out, path, err);
    if (result < 0)
        error_prefix(err, "not overwritten, because it is not a calibration. Choose another name");
    return result;
}

mrt_result calibration_keep_fits(const calibration_file *made, const calibration_file *old,
                                 const char *path, error *err)
{
    if (calibration_file_sensor_count(old) == 0)
        return MRT_OK;
    if (old->side != made->side)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "%s: is a calibration of the other hand. Choose another name", path);
    if (strcmp(old->input, made->input) != 0)
        return error_set(err, MRT_ERR_ARGUMENT, "%s: is a calibration of %s. Choose another name",
                         path, old->input[0] ? old->input : "a glove");
    return MRT_OK;
}

void calibration_keep_sign(calibration_file *made, const calibration_file *old, const char *name,
                           double hand_length_mm)
{
    bool has_name = name && name[0];
    (void)snprintf(made->name, sizeof made->name, "%s", has_name ? name : old->name);
    if (hand_length_mm > 0)
        made->hand_length_mm = hand_length_mm;
    else if (!(made->hand_length_mm > 0))
        made->hand_length_mm = old->hand_length_mm;
    time_t now = time(NULL);
    struct tm utc;
    if (gmtime_r(&now, &utc))
        (void)strftime(made->date, sizeof made->date, "%Y-%m-%dT%H:%M:%SZ", &utc);
}

mrt_result calibration_keep_write(calibration_file *made, const calibration_file *old,
                                  const char *path, error *err)
{
    void *own = made->document;
    made->document = old->document;
    mrt_result result = calibration_file_write(made, path, err);
    made->document = own;
    return result;
}
