#include "window/folder.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

bool folder_name_ends(const char *name, const char *const *endings)
{
    const size_t length = strlen(name);
    for (; *endings; ++endings) {
        const size_t ending = strlen(*endings);
        if (length > ending && strcasecmp(name + length - ending, *endings) == 0)
            return true;
    }
    return false;
}

bool folder_join(const folder *self, const char *name, char out[FOLDER_PATH])
{
    const char *home = getenv("HOME");
    int length;
    if (name[0] == '/')
        length = snprintf(out, FOLDER_PATH, "%s", name);
    else if (name[0] == '~' && name[1] == '/' && home)
        length = snprintf(out, FOLDER_PATH, "%s%s", home, name + 1);
    else
        length = snprintf(out, FOLDER_PATH, "%s/%s", strcmp(self->path, "/") == 0 ? "" : self->path,
                          name);
    return length > 0 && length < FOLDER_PATH;
}

/* Folders first, ".." before all, then by name. */
static int by_name(const void *a, const void *b)
{
    const folder_entry *x = a, *y = b;
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
static bool read_entry(folder_entry *out, DIR *dir, const struct dirent *found,
                       const char *const *endings)
{
    struct stat info;
    const char *name = found->d_name;
    if ((name[0] == '.' && strcmp(name, "..") != 0) || strlen(name) >= FOLDER_NAME ||
        !is_printable(name) || fstatat(dirfd(dir), name, &info, 0) != 0)
        return false;
    (void)snprintf(out->name, sizeof out->name, "%s", name);
    out->is_folder = S_ISDIR(info.st_mode);
    out->bytes = (uint64_t)info.st_size;
    out->changed_s = info.st_mtime;
    return out->is_folder || (S_ISREG(info.st_mode) && folder_name_ends(name, endings));
}

static void read_entries(folder *out, DIR *dir, const char *const *endings)
{
    const struct dirent *found;
    while ((found = readdir(dir)) != NULL) {
        folder_entry entry;
        if (!read_entry(&entry, dir, found, endings))
            continue;
        if (strcmp(found->d_name, "..") == 0 && strcmp(out->path, "/") == 0)
            continue;
        if (out->count == FOLDER_ENTRIES) {
            out->has_more = true;
            break;
        }
        out->entry[out->count++] = entry;
    }
    qsort(out->entry, out->count, sizeof *out->entry, by_name);
}

mrt_result folder_go(folder *self, const char *path, const char *const *endings, error *err)
{
    folder next = {.count = 0};
    char *real = realpath(path, NULL);
    DIR *dir = real && strlen(real) < FOLDER_PATH ? opendir(real) : NULL;
    if (!dir) {
        const int why = real && strlen(real) >= FOLDER_PATH ? ENAMETOOLONG : errno;
        free(real);
        return error_set(err, MRT_ERR_IO, "%s: the folder cannot be opened: %s", path,
                         strerror(why));
    }
    (void)snprintf(next.path, sizeof next.path, "%s", real);
    free(real);
    next.entry = calloc(FOLDER_ENTRIES, sizeof *next.entry);
    if (next.entry)
        read_entries(&next, dir, endings);
    (void)closedir(dir);
    if (!next.entry)
        return error_set(err, MRT_ERR_MEMORY, "%s: no memory to list it", path);
    folder_finish(self);
    *self = next;
    return MRT_OK;
}

void folder_finish(folder *self)
{
    free(self->entry);
    *self = (folder){.count = 0};
}
