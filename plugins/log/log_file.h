/* log_file.h - the bytes of a regular file, or a reason why not. [main] */
#ifndef MAROTTE_LOG_FILE_H
#define MAROTTE_LOG_FILE_H
#include <marotte/plugin.h>

#include "log_text.h"

enum { LOG_FILE_MAX_MIB = 128 };

typedef struct log_file {
    unsigned char *data; /* owned: free() it */
    size_t size;
} log_file;

/* Never waits for a pipe or a device: what is no regular file is refused. out_reason:
 * LOG_REASON bytes. */
mrt_result log_file_read(log_file *out, const char *path, char *out_reason);

#endif
