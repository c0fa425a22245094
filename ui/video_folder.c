#include "video_folder.h"

#include "base/file.h"
#include "io/export.h"

#include <dirent.h>
#include <errno.h>
#include <jansson.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { DIGITS = 5, NOTE_BYTES_MAX = 1 << 16, FRAMES_MAX = 99999999 };
static const char note_name[] = "frames.json";

struct video_folder {
    char path[PATH_MAX];      /* ends in '/' */
    char meanwhile[PATH_MAX]; /* a folder within it, ends in '/'; "" none */
    bool was_made;            /* the folder is ours to remove */
    uint32_t earlier_count;   /* pictures of the sequence that is replaced */
    uint32_t count;
    video_folder_about about;
    char timecode[TIMECODE_TEXT];
};

static mrt_result name_in(char out[PATH_MAX], const char *folder, const char *name, error *err)
{
    int length = snprintf(out, PATH_MAX, "%s%s", folder, name);
    if (length > 0 && length < PATH_MAX)
        return MRT_OK;
    return error_set(err, MRT_ERR_ARGUMENT, "%.200s...: the path is too long", folder);
}

static mrt_result picture_in(char out[PATH_MAX], const char *folder, uint32_t number, error *err)
{
    char name[32];
    (void)snprintf(name, sizeof name, "%0*u.png", DIGITS, number);
    return name_in(out, folder, name, err);
}

/* The number of a picture of a sequence, 0: it is called otherwise. */
static uint32_t number_of(const char *name)
{
    char *end;
    if (strlen(name) < DIGITS + 4 || name[0] < '0' || name[0] > '9')
        return 0;
    unsigned long number = strtoul(name, &end, 10);
    return strcmp(end, ".png") == 0 && number <= FRAMES_MAX ? (uint32_t)number : 0;
}

/* ---- what is there ---- */

/* Pictures that our note speaks of; 0: no note of ours. */
static uint32_t noted_count(const char *folder)
{
    char path[PATH_MAX];
    file_bytes bytes;
    error ignored;
    if (name_in(path, folder, note_name, &ignored) < 0 ||
        file_read(&bytes, path, NOTE_BYTES_MAX, &ignored) < 0)
        return 0;
    json_t *note = json_loadb((const char *)bytes.data, bytes.size, 0, NULL);
    file_bytes_finish(&bytes);
    json_int_t version = json_integer_value(json_object_get(note, "marotte_frames"));
    json_int_t count = json_integer_value(json_object_get(note, "count"));
    json_decref(note);
    return version == 1 && count > 0 && count <= FRAMES_MAX ? (uint32_t)count : 0;
}

static mrt_result check_entry(const char *path, const char *name, uint32_t earlier_count,
                              error *err)
{
    uint32_t number = number_of(name);
    if (name[0] == '.')
        return MRT_OK;
    if (earlier_count == 0)
        return error_set(err, MRT_ERR_IO,
                         "%s: has %s in it and no pictures that marotte wrote there: name a folder "
                         "that is empty or not there yet",
                         path, name);
    if (number > earlier_count)
        return error_set(err, MRT_ERR_IO,
                         "%s: %s is not of the %u pictures that marotte wrote there: move it away, "
                         "or name another folder",
                         path, name, earlier_count);
    return MRT_OK;
}

static mrt_result check_entries(const char *path, uint32_t earlier_count, error *err)
{
    DIR *folder = opendir(path);
    if (!folder)
        return error_set(err, MRT_ERR_IO, "%s: %s", path, strerror(errno));
    mrt_result result = MRT_OK;
    const struct dirent *entry;
    while (result >= 0 && (entry = readdir(folder)))
        result = check_entry(path, entry->d_name, earlier_count, err);
    closedir(folder);
    return result;
}

static mrt_result check_parent(const char *path, error *err)
{
    char parent[PATH_MAX];
    struct stat status;
    size_t length = strlen(path);
    while (length > 0 && path[length - 1] == '/')
        --length;
    while (length > 0 && path[length - 1] != '/')
        --length;
    (void)snprintf(parent, sizeof parent, "%.*s", (int)length, path);
    const char *folder = parent[0] ? parent : ".";
    if (stat(folder, &status) != 0)
        return error_set(err, MRT_ERR_IO, "%s: the folder %s: %s", path, folder, strerror(errno));
    if (!S_ISDIR(status.st_mode) || access(folder, W_OK | X_OK) != 0)
        return error_set(err, MRT_ERR_IO, "%s: no folder can be made in %s", path, folder);
    return MRT_OK;
}

mrt_result video_folder_check(const char *path, error *err)
{
    struct stat status;
    if (strlen(path) > PATH_MAX - 64)
        return error_set(err, MRT_ERR_ARGUMENT, "%.200s...: the path is too long", path);
    if (stat(path, &status) != 0)
        return errno == ENOENT ? check_parent(path, err)
                               : error_set(err, MRT_ERR_IO, "%s: %s", path, strerror(errno));
    if (access(path, R_OK | W_OK | X_OK) != 0)
        return error_set(err, MRT_ERR_IO, "%s: no pictures can be written into it: %s", path,
                         strerror(errno));
    return check_entries(path, noted_count(path), err);
}

/* ---- written ---- */

static mrt_result make_folders(video_folder *self, error *err)
{
    self->was_made = mkdir(self->path, 0777) == 0;
    if (!self->was_made && errno != EEXIST)
        return error_set(err, MRT_ERR_IO, "%s: cannot be made: %s", self->path, strerror(errno));
    char meanwhile[PATH_MAX];
    mrt_result result = name_in(meanwhile, self->path, "unfinished.XXXXXX", err);
    if (result < 0)
        return result;
    if (!mkdtemp(meanwhile))
        return error_set(err, MRT_ERR_IO, "%s: cannot write: %s", self->path, strerror(errno));
    return name_in(self->meanwhile, meanwhile, "/", err);
}

mrt_result video_folder_open(video_folder **out, const char *path, const video_folder_about *about,
                             error *err)
{
    *out = NULL;
    mrt_result result = video_folder_check(path, err);
    video_folder *self = result >= 0 ? calloc(1, sizeof *self) : NULL;
    if (!self)
        return result < 0 ? result : error_set(err, MRT_ERR_MEMORY, "no memory for pictures");
    size_t length = strlen(path);
    (void)snprintf(self->path, sizeof self->path, "%s%s", path,
                   length > 0 && path[length - 1] == '/' ? "" : "/");
    self->earlier_count = noted_count(self->path);
    self->about = *about;
    (void)snprintf(self->timecode, sizeof self->timecode, "%s", about->timecode);
    result = make_folders(self, err);
    if (result < 0)
        video_folder_abandon(self);
    else
        *out = self;
    return result;
}

mrt_result video_folder_add(video_folder *self, const uint8_t *rgba, error *err)
{
    char path[PATH_MAX];
    error why = {""};
    if (self->count == FRAMES_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED, "%s: at most %d pictures", self->path,
                         FRAMES_MAX);
    mrt_result result = picture_in(path, self->meanwhile, self->count + 1, err);
    if (result < 0)
        return result;
    result = png_write_as(path, rgba, self->about.width, self->about.height,
                          self->about.has_alpha ? PNG_WITH_ALPHA : PNG_OPAQUE, &why);
    if (result < 0) { /* where it lies meanwhile is nobody's concern */
        const char *reason = strstr(why.text, "cannot write: ");
        return error_set(err, result, "%s%0*u.png: %s", self->path, DIGITS, self->count + 1,
                         reason ? reason : why.text);
    }
    self->count += 1;
    return MRT_OK;
}

static mrt_result write_note(const video_folder *self, uint32_t count, error *err)
{
    char path[PATH_MAX], rate[32];
    (void)snprintf(rate, sizeof rate, "%u/%u", self->about.rate.num, self->about.rate.den);
    mrt_result result = name_in(path, self->path, note_name, err);
    json_t *note =
        json_pack("{si,sI,ss,si,si}", "marotte_frames", 1, "count", (json_int_t)count, "rate", rate,
                  "width", (int)self->about.width, "height", (int)self->about.height);
    if (note && self->timecode[0])
        (void)json_object_set_new(note, "timecode", json_string(self->timecode));
    char *text = note ? json_dumps(note, JSON_INDENT(2)) : NULL;
    json_decref(note);
    if (result >= 0 && !text)
        result = error_set(err, MRT_ERR_MEMORY, "no memory for %s", path);
    if (result >= 0)
        result = file_write(path, text, strlen(text), err);
    free(text);
    return result;
}

static mrt_result move_picture(const video_folder *self, uint32_t number, error *err)
{
    char from[PATH_MAX], to[PATH_MAX];
    mrt_result result = picture_in(from, self->meanwhile, number, err);
    if (result >= 0)
        result = picture_in(to, self->path, number, err);
    if (result >= 0 && rename(from, to) != 0)
        result = error_set(err, MRT_ERR_IO, "%s: cannot write: %s", to, strerror(errno));
    return result;
}

static void remove_pictures(const char *folder, uint32_t first, uint32_t last)
{
    char path[PATH_MAX];
    error ignored;
    for (uint32_t i = first; i <= last; ++i)
        if (picture_in(path, folder, i, &ignored) >= 0)
            (void)unlink(path);
}

mrt_result video_folder_commit(video_folder *self, error *err)
{
    /* Should it end midway, all that is there is known to be ours. */
    uint32_t moved = 0,
             most = self->count > self->earlier_count ? self->count : self->earlier_count;
    mrt_result result = write_note(self, most, err);
    for (; moved < self->count && result >= 0; moved += result >= 0)
        result = move_picture(self, moved + 1, err);
    if (result >= 0) {
        remove_pictures(self->path, self->count + 1, self->earlier_count);
        result = write_note(self, self->count, err);
    }
    self->was_made = self->was_made && result < 0 && moved == 0;
    video_folder_abandon(self);
    return result;
}

void video_folder_abandon(video_folder *self)
{
    if (!self)
        return;
    if (self->meanwhile[0]) {
        remove_pictures(self->meanwhile, 1, self->count + 1);
        (void)rmdir(self->meanwhile);
    }
    if (self->was_made)
        (void)rmdir(self->path);
    free(self);
}
