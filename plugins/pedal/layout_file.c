#include "layout_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static bool folder_path(char out[LAYOUT_FILE_PATH])
{
    const char *config = getenv("XDG_CONFIG_HOME");
    const char *home = getenv("HOME");
    int length = -1;
    if (config && config[0] == '/') /* relative ones are to be ignored, says the specification */
        length = snprintf(out, LAYOUT_FILE_PATH, "%s/marotte/pedals", config);
    else if (home && home[0] == '/')
        length = snprintf(out, LAYOUT_FILE_PATH, "%s/.config/marotte/pedals", home);
    return length > 0 && length < LAYOUT_FILE_PATH - 32; /* room for a file's name */
}

bool layout_file_path(char out[LAYOUT_FILE_PATH], uint16_t vendor, uint16_t product)
{
    if (!folder_path(out))
        return false;
    size_t used = strlen(out);
    snprintf(out + used, LAYOUT_FILE_PATH - used, "/%04x_%04x.layout", vendor, product);
    return true;
}

/* ---- reading ---- */

/* Reads up to a byte more than is allowed, so that a file that is too long is seen. */
static ssize_t read_bounded(int file, char out[LAYOUT_TEXT_BYTES + 1])
{
    size_t used = 0;
    while (used <= LAYOUT_TEXT_BYTES) {
        ssize_t got = read(file, out + used, LAYOUT_TEXT_BYTES + 1 - used);
        if (got < 0 && errno == EINTR)
            continue;
        if (got < 0)
            return -1;
        if (got == 0)
            break;
        used += (size_t)got;
    }
    return (ssize_t)used;
}

/* O_NONBLOCK: a pipe that somebody put there does not hold us up. */
static mrt_result read_file(const char *path, char *bytes, size_t *out_size, char *reason)
{
    int file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
    if (file < 0 && (errno == ENOENT || errno == ENOTDIR))
        return MRT_END;
    struct stat status;
    ssize_t size = -1;
    if (file >= 0 && fstat(file, &status) == 0) {
        if (S_ISREG(status.st_mode))
            size = read_bounded(file, bytes);
        else
            errno = EINVAL;
    }
    int why = errno;
    if (file >= 0)
        close(file);
    if (size < 0) {
        snprintf(reason, LAYOUT_FILE_REASON, "%s: %s: let it be read, or remove it", path,
                 strerror(why));
        return MRT_ERR_IO;
    }
    if (size > LAYOUT_TEXT_BYTES) {
        snprintf(reason, LAYOUT_FILE_REASON, "%s: longer than 4096 bytes: no layout: remove it",
                 path);
        return MRT_ERR_FORMAT;
    }
    *out_size = (size_t)size;
    return MRT_OK;
}

mrt_result layout_file_load(layout *out, uint16_t vendor, uint16_t product,
                            char reason[LAYOUT_FILE_REASON])
{
    char path[LAYOUT_FILE_PATH], bytes[LAYOUT_TEXT_BYTES + 1], why[LAYOUT_TEXT_REASON];
    size_t size = 0;
    if (!layout_file_path(path, vendor, product))
        return MRT_END;
    mrt_result result = read_file(path, bytes, &size, reason);
    if (result != MRT_OK)
        return result;
    result = layout_text_parse(out, bytes, size, why);
    if (result >= 0 && (out->vendor != vendor || out->product != product)) {
        snprintf(why, sizeof why, "is of device %04x:%04x", out->vendor, out->product);
        result = MRT_ERR_FORMAT;
    }
    if (result < 0)
        snprintf(reason, LAYOUT_FILE_REASON,
                 "%s: %s: mend it, or remove it and teach the pedal again", path, why);
    return result;
}

/* ---- writing ---- */

static bool make_folders(char *path)
{
    for (char *c = path + 1; *c; ++c) {
        if (*c != '/')
            continue;
        *c = '\0';
        bool is_made = mkdir(path, 0755) == 0 || errno == EEXIST;
        *c = '/';
        if (!is_made)
            return false;
    }
    return true;
}

static bool write_all(int file, const char *bytes, size_t size)
{
    while (size > 0) {
        ssize_t done = write(file, bytes, size);
        if (done < 0 && errno == EINTR)
            continue;
        if (done <= 0)
            return false;
        bytes += done;
        size -= (size_t)done;
    }
    return fsync(file) == 0;
}

static bool write_file(const char *path, const char *bytes, size_t size)
{
    char temporary[LAYOUT_FILE_PATH + 16];
    snprintf(temporary, sizeof temporary, "%s.XXXXXX", path);
    int file = mkstemp(temporary);
    if (file < 0)
        return false;
    bool is_good = write_all(file, bytes, size);
    int why = errno;
    is_good = close(file) == 0 && is_good;
    if (is_good && rename(temporary, path) == 0)
        return true;
    why = is_good ? errno : why;
    unlink(temporary);
    errno = why;
    return false;
}

mrt_result layout_file_store(const layout *from, char reason[LAYOUT_FILE_REASON])
{
    char path[LAYOUT_FILE_PATH], bytes[LAYOUT_TEXT_BYTES];
    if (!layout_file_path(path, from->vendor, from->product)) {
        snprintf(reason, LAYOUT_FILE_REASON,
                 "the layout has nowhere to go: set HOME or XDG_CONFIG_HOME");
        return MRT_ERR_IO;
    }
    size_t size = layout_text_print(bytes, from);
    if (make_folders(path) && write_file(path, bytes, size))
        return MRT_OK;
    snprintf(reason, LAYOUT_FILE_REASON, "%s cannot be written: %s", path, strerror(errno));
    return MRT_ERR_IO;
}
