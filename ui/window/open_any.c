#include "window/open_any.h"
#include "window/app/kept_scenery.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

/* ---- what a folder has ---- */

bool open_name_ends(const char *name, const char *const *endings)
{
    const size_t length = strlen(name);
    for (; *endings; ++endings) {
        const size_t ending = strlen(*endings);
        if (length > ending && strcasecmp(name + length - ending, *endings) == 0)
            return true;
    }
    return false;
}

bool open_folder_join(const open_folder *self, const char *name, char out[OPEN_PATH])
{
    const char *home = getenv("HOME");
    int length;
    if (name[0] == '/')
        length = snprintf(out, OPEN_PATH, "%s", name);
    else if (name[0] == '~' && name[1] == '/' && home)
        length = snprintf(out, OPEN_PATH, "%s%s", home, name + 1);
    else
        length =
            snprintf(out, OPEN_PATH, "%s/%s", strcmp(self->path, "/") == 0 ? "" : self->path, name);
    return length > 0 && length < OPEN_PATH;
}

/* Folders first, ".." before all, then by name. */
static int by_name(const void *a, const void *b)
{
    const open_entry *x = a, *y = b;
    const bool x_is_up = strcmp(x->name, "..") == 0, y_is_up = strcmp(y->name, "..") == 0;
    if (x_is_up != y_is_up)
        return x_is_up ? -1 : 1;
    if (x->is_folder != y->is_folder)
        return x->is_folder ? -1 : 1;
    const int order = strcasecmp(x->name, y->name);
    return order ? order : strcmp(x->name, y->name);
}

static bool is_printable(const char *name)
{
    for (; *name; ++name)
        if ((unsigned char)*name < 0x20 || *name == 0x7f)
            return false;
    return true;
}

/* False: nobody wants it. */
static bool read_entry(open_entry *out, DIR *dir, const struct dirent *found,
                       const char *const *endings)
{
    struct stat info;
    const char *name = found->d_name;
    if ((name[0] == '.' && strcmp(name, "..") != 0) || strlen(name) >= OPEN_NAME ||
        !is_printable(name) || fstatat(dirfd(dir), name, &info, 0) != 0)
        return false;
    (void)snprintf(out->name, sizeof out->name, "%s", name);
    out->is_folder = S_ISDIR(info.st_mode);
    out->bytes = (uint64_t)info.st_size;
    out->changed_s = info.st_mtime;
    return out->is_folder || (S_ISREG(info.st_mode) && open_name_ends(name, endings));
}

static void read_entries(open_folder *out, DIR *dir, const char *const *endings)
{
    const struct dirent *found;
    while ((found = readdir(dir)) != NULL) {
        open_entry entry;
        if (!read_entry(&entry, dir, found, endings))
            continue;
        if (strcmp(found->d_name, "..") == 0 && strcmp(out->path, "/") == 0)
            continue;
        if (out->count == OPEN_ENTRIES) {
            out->has_more = true;
            break;
        }
        out->entry[out->count++] = entry;
    }
    qsort(out->entry, out->count, sizeof *out->entry, by_name);
}

mrt_result open_folder_go(open_folder *self, const char *path, const char *const *endings,
                          error *err)
{
    open_folder next = {.count = 0};
    char *real = realpath(path, NULL);
    DIR *dir = real && strlen(real) < OPEN_PATH ? opendir(real) : NULL;
    if (!dir) {
        const int why = real && strlen(real) >= OPEN_PATH ? ENAMETOOLONG : errno;
        free(real);
        return error_set(err, MRT_ERR_IO, "%s: the folder cannot be opened: %s", path,
                         strerror(why));
    }
    (void)snprintf(next.path, sizeof next.path, "%s", real);
    free(real);
    next.entry = calloc(OPEN_ENTRIES, sizeof *next.entry);
    if (next.entry)
        read_entries(&next, dir, endings);
    (void)closedir(dir);
    if (!next.entry)
        return error_set(err, MRT_ERR_MEMORY, "%s: no memory to list it", path);
    open_folder_finish(self);
    *self = next;
    return MRT_OK;
}

void open_folder_finish(open_folder *self)
{
    free(self->entry);
    *self = (open_folder){.count = 0};
}

/* ---- what it is ---- */

#define FACES    ".rig.json", ".glb", ".gltf", ".vrm", ".obj", ".ply", ".off", ".stl"
#define HANDS    ".csv", ".log"
#define VOICES   ".wav", ".flac", ".ogg", ".oga", ".opus", ".aif", ".aiff", ".mp3", ".au", ".snd"
#define PICTURES ".png", ".jpg", ".jpeg"

static const char *const endings[OPEN_KINDS][32] = {
    [OPEN_ANY] = {".marotte", FACES, HANDS, VOICES, PICTURES, NULL},
    [OPEN_SHOW] = {".marotte", NULL},
    [OPEN_FACE] = {FACES, NULL},
    [OPEN_HANDS] = {HANDS, NULL},
    [OPEN_VOICE] = {VOICES, NULL},
    [OPEN_PICTURE] = {PICTURES, NULL},
};

const char *const *open_endings(open_kind kind)
{
    return endings[kind < OPEN_KINDS ? kind : OPEN_ANY];
}

typedef struct beginning {
    const char *bytes;
    open_kind kind;
} beginning;

/* Kind of a file by its first bytes, if its name does not tell. */
static open_kind kind_of_content(const char *path)
{
    static const beginning known[] = {{"SQLite format 3", OPEN_SHOW},
                                      {"glTF", OPEN_FACE},
                                      {"ply", OPEN_FACE},
                                      {"OFF", OPEN_FACE},
                                      {"time_s,", OPEN_HANDS},
                                      {"time_ns,", OPEN_HANDS},
                                      {"RIFF", OPEN_VOICE},
                                      {"fLaC", OPEN_VOICE},
                                      {"OggS", OPEN_VOICE},
                                      {"FORM", OPEN_VOICE},
                                      {".snd", OPEN_VOICE},
                                      {"\x89PNG", OPEN_PICTURE},
                                      {"\xff\xd8\xff", OPEN_PICTURE}};
    char first[16] = "";
    FILE *file = fopen(path, "rb");
    if (!file)
        return OPEN_ANY;
    const size_t length = fread(first, 1, sizeof first, file);
    (void)fclose(file);
    for (size_t i = 0; i < sizeof known / sizeof known[0]; ++i) {
        const size_t wanted = strlen(known[i].bytes);
        if (length >= wanted && memcmp(first, known[i].bytes, wanted) == 0)
            return known[i].kind;
    }
    return OPEN_ANY;
}

open_kind open_kind_of(const char *path)
{
    for (open_kind kind = OPEN_SHOW; kind < OPEN_KINDS; ++kind)
        if (open_name_ends(path, endings[kind]))
            return kind;
    return kind_of_content(path);
}

/* ---- opened ---- */

static mrt_result open_hands(app *of, const char *path)
{
    char text[OPEN_PATH + 16];
    (void)snprintf(text, sizeof text, "log:%s,loop=1", path);
    return app_open_input(of, text);
}

mrt_result open_any(app *of, const char *path)
{
    error err = {0};
    mrt_result result;
    switch (open_kind_of(path)) {
    case OPEN_SHOW:
        result = app_open_show(of, path);
        break;
    case OPEN_FACE:
        result = app_open_face(of, path);
        break;
    case OPEN_HANDS:
        result = open_hands(of, path);
        break;
    case OPEN_VOICE:
        result = app_attach_voice(of, path);
        break;
    case OPEN_PICTURE:
        result = app_report(of, kept_scenery_choose(app_scenery(of), path, &err), &err);
        break;
    default:
        return app_report(of,
                          error_set(&err, MRT_ERR_FORMAT,
                                    "%s is not a show, face, recorded hand, sound or picture",
                                    path),
                          &err);
    }
    if (result >= 0)
        open_recent_add(app_settings(of), path);
    return result;
}
