#include "log_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const size_t SIZE_MAX_BYTES = (size_t)LOG_FILE_MAX_MIB << 20;

static mrt_result refuse(char *out_reason, mrt_result code, const char *reason)
{
    snprintf(out_reason, LOG_REASON, "%s", reason);
    return code;
}

/* The size is a hint only: the file may shrink or grow while it is read. */
static mrt_result read_all(log_file *out, int descriptor, size_t size, char *out_reason)
{
    out->data = malloc(size + 1);
    if (!out->data)
        return refuse(out_reason, MRT_ERR_MEMORY, "there is no memory for it");
    while (out->size < size) {
        ssize_t count = read(descriptor, out->data + out->size, size - out->size);
        if (count < 0 && errno == EINTR)
            continue;
        if (count < 0)
            return refuse(out_reason, MRT_ERR_IO, strerror(errno));
        if (count == 0)
            break;
        out->size += (size_t)count;
    }
    return MRT_OK;
}

static mrt_result read_regular(log_file *out, int descriptor, char *out_reason)
{
    struct stat status;
    if (fstat(descriptor, &status) < 0)
        return refuse(out_reason, MRT_ERR_IO, strerror(errno));
    if (S_ISDIR(status.st_mode))
        return refuse(out_reason, MRT_ERR_IO, "it is a directory, a log is a file");
    if (!S_ISREG(status.st_mode))
        return refuse(out_reason, MRT_ERR_IO, "it is a device or a pipe, a log is a file");
    if (status.st_size < 0 || (uint64_t)status.st_size > SIZE_MAX_BYTES) {
        snprintf(out_reason, LOG_REASON, "it is larger than %d MiB: split it", LOG_FILE_MAX_MIB);
        return MRT_ERR_UNSUPPORTED;
    }
    return read_all(out, descriptor, (size_t)status.st_size, out_reason);
}

mrt_result log_file_read(log_file *out, const char *path, char *out_reason)
{
    *out = (log_file){NULL, 0};
    int descriptor = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (descriptor < 0)
        return refuse(out_reason, MRT_ERR_IO, strerror(errno));
    mrt_result result = read_regular(out, descriptor, out_reason);
    close(descriptor);
    if (result < 0) {
        free(out->data);
        *out = (log_file){NULL, 0};
    }
    return result;
}
