/* What keeps a port from being used: who has it open, and whose it is. */
#include "glove_find.h"

#include <ctype.h>
#include <dirent.h>
#include <fcntl.h>
#include <grp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { GROUP_TEXT = 2048 };

/* Whether one of the process's descriptors, but `own` (-1: none is excepted), is this file. */
static bool has_open(const char *process, const char *real, int own)
{
    char folder[64], target[PATH_CAPACITY];
    snprintf(folder, sizeof folder, "/proc/%.20s/fd", process);
    DIR *files = opendir(folder);
    if (!files)
        return false;
    bool found = false;
    const struct dirent *entry;
    while (!found && (entry = readdir(files)) != NULL) {
        if (!isdigit((unsigned char)entry->d_name[0]) ||
            (own >= 0 && strtol(entry->d_name, NULL, 10) == own))
            continue;
        ssize_t length = readlinkat(dirfd(files), entry->d_name, target, sizeof target - 1);
        if (length <= 0)
            continue;
        target[length] = '\0';
        found = strcmp(target, real) == 0;
    }
    closedir(files);
    return found;
}

static void name_process(const char *process, char *out, size_t capacity)
{
    char path[64], name[32] = "";
    snprintf(path, sizeof path, "/proc/%.20s/comm", process);
    int file = open(path, O_RDONLY | O_CLOEXEC);
    if (file >= 0) {
        ssize_t got = read(file, name, sizeof name - 1);
        name[got > 0 ? (size_t)got : 0] = '\0';
        name[strcspn(name, "\n")] = '\0';
        close(file);
    }
    snprintf(out, capacity, "%s (process %.20s)", name[0] ? name : "a program", process);
}

/* What made a pseudo terminal holds both its ends; who uses it is another. */
static bool may_have_made(const char *process, const char *real)
{
    return strncmp(real, "/dev/pts/", 9) == 0 &&
           (has_open(process, "/dev/ptmx", -1) || has_open(process, "/dev/pts/ptmx", -1));
}

bool glove_find_other_holder(const char *path, int own, char *out, size_t capacity)
{
    char real[PATH_CAPACITY], self[24];
    out[0] = '\0';
    glove_find_real(path, real, sizeof real);
    snprintf(self, sizeof self, "%ld", (long)getpid());
    DIR *processes = opendir("/proc");
    if (!processes)
        return false;
    bool found = false, is_sure = false;
    const struct dirent *entry;
    while (!is_sure && (entry = readdir(processes)) != NULL) {
        bool is_self = strcmp(entry->d_name, self) == 0;
        if (!isdigit((unsigned char)entry->d_name[0]) ||
            !has_open(entry->d_name, real, is_self ? own : -1))
            continue;
        found = true;
        is_sure = !may_have_made(entry->d_name, real);
        if (is_self)
            snprintf(out, capacity, "marotte itself, as another input");
        else
            name_process(entry->d_name, out, capacity);
    }
    closedir(processes);
    return found;
}

bool glove_find_holder(const char *path, char *out, size_t capacity)
{
    return glove_find_other_holder(path, -1, out, capacity);
}

bool glove_find_may_open(const char *path)
{
    return access(path, R_OK | W_OK) == 0;
}

void glove_find_advice(const char *path, char *out, size_t capacity)
{
    struct stat about;
    struct group entry, *group = NULL;
    char text[GROUP_TEXT];
    if (stat(path, &about) != 0 || getgrgid_r(about.st_gid, &entry, text, sizeof text, &group) != 0)
        group = NULL;
    if (group && (about.st_mode & S_IRGRP) && (about.st_mode & S_IWGRP) && about.st_gid != 0)
        snprintf(out, capacity,
                 "it belongs to the group \"%.32s\": run \"sudo usermod -aG %.32s $USER\" and log "
                 "in again",
                 group->gr_name, group->gr_name);
    else
        snprintf(out, capacity,
                 "only its owner may open it: run \"sudo chmod a+rw %.96s\", or add a udev rule",
                 path);
}
