/* base/file.h - whole files in, and files out that are either complete or absent.
 * Reading refuses directories, devices and files over a cap with a message that names the file.
 * Writing goes to a temporary file beside the target, which is synced and renamed at the end:
 * a failure or a crash leaves what was there before. The temporary file is locked while it is
 * written: one that a killed program left is removed by the next writer of that target. [main], or
 * any thread that may block. */
#ifndef MAROTTE_BASE_FILE_H
#define MAROTTE_BASE_FILE_H
#include "base/error.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

typedef struct file_bytes {
    unsigned char *data; /* size bytes, then one 0 byte that is not counted; owned */
    size_t size;
} file_bytes;

/* Reads a regular file of 1..size_cap bytes; an empty file is an error. */
CHECKED mrt_result file_read(file_bytes *out, const char *path, size_t size_cap, error *err);
void file_bytes_finish(file_bytes *bytes);

/* A sparse file is as long as it says, and costs nobody anything: who asks what a file may cost, or
 * goes over all of it, looks at what is there. The next bytes at or after `from` that are not a
 * hole; false: none. Where the file system knows no holes, that is all of it. */
bool file_next_data(int fd, uint64_t from, uint64_t *out_begin, uint64_t *out_end);
/* How much of it is stored, about; all of it where the file system does not say. 0: no regular
 * file. The file is not opened: closing it would drop the locks that this process has on it,
 * SQLite's. */
uint64_t file_data_size(const char *path);

typedef struct file_writer {
    FILE *stream; /* write here; errors are found by file_writer_commit */
    char *path, *temporary_path;
} file_writer;

/* Creates the missing folders of the path. On failure no file is left behind and `out` is zeroed.
 */
CHECKED mrt_result file_writer_open(file_writer *out, const char *path, error *err);
/* Flushes, syncs, renames. Whatever it returns, the writer is finished. */
CHECKED mrt_result file_writer_commit(file_writer *writer, error *err);
/* Removes the temporary file; accepts a zeroed or finished writer. */
void file_writer_abandon(file_writer *writer);

/* Writes `size` bytes as a whole file, by the above. */
CHECKED mrt_result file_write(const char *path, const void *data, size_t size, error *err);

/* Orders programs that replace or remove files in the folder of `path`: only one of them holds its
 * lock. The folder itself is locked, so no lock file is left behind, and a kill releases it. Waits
 * for others up to patience_ms. To be released by close(*out_fd), which is -1 where it is not
 * held. */
typedef enum file_lock {
    FILE_LOCK_HELD = 0,
    FILE_LOCK_BUSY,
    FILE_LOCK_UNSUPPORTED /* no such folder, or its file system locks no folders (NFS) */
} file_lock;
file_lock file_lock_folder(int *out_fd, const char *path, int patience_ms);

/* Whether what `path` leads to, links followed, is in `folder` ("": the working directory) or below
 * it, or in a folder that the person names in $MAROTTE_FILE_FOLDERS (with ':' between them): a file
 * that somebody else made names only what came with it. A path that leads nowhere is judged by its
 * words. The message says what to do. */
CHECKED mrt_result file_check_below(const char *folder, const char *path, error *err);

/* Reads a file that another one names, from the folder (with its last '/', or "") of that: in it or
 * below, by file_check_below. NULL: of bytes, which have no folder. */
CHECKED mrt_result file_read_below(file_bytes *out, const char *folder, const char *name,
                                   size_t size_cap, error *err);

/* Where the person's own files of marotte lie: $XDG_CONFIG_HOME/marotte/REST, or without the
 * variable ~/.config/marotte/REST; data and cache likewise. An error when neither is known. */
typedef enum file_home { FILE_HOME_CONFIG = 0, FILE_HOME_DATA, FILE_HOME_CACHE } file_home;
CHECKED mrt_result file_home_path(char *out, size_t capacity, file_home which, const char *rest,
                                  error *err);
/* Creates every missing folder of the path, from the top. */
CHECKED mrt_result file_make_folders(const char *path, error *err);
/* Creates the missing folders above a file or folder that is about to be written. file_writer_open
 * does so itself; for whatever is written by other means. */
CHECKED mrt_result file_make_parent(const char *path, error *err);

/* Behind the last '/' of path: "puppet.rig.json". */
const char *file_name_of(const char *path);
/* Directory part of path with its final '/', or "" : a copy for the caller to free; NULL: no
 * memory. */
char *file_directory(const char *path);
/* The extension in lower case without its dot ("glb"), "" if there is none; at most 15 letters. */
typedef struct file_extension {
    char text[16];
} file_extension;
file_extension file_extension_of(const char *path);

#endif
