/* base/file.h - reads whole files, and writes files that are either complete or absent. Reading
 * rejects directories, devices and files above a size limit; the message names the file. Writing
 * uses a temporary file beside the target, which is synced and renamed at the end, so that a
 * failure or a crash keeps the previous file. The temporary file is locked while it is written. If
 * its program is killed, the next writer of that target removes it. [main], or any thread that may
 * block. */
#ifndef MAROTTE_BASE_FILE_H
#define MAROTTE_BASE_FILE_H
#include "base/error.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

typedef struct file_bytes {
    unsigned char *data; /* size bytes, then one 0 byte that size does not count; owned */
    size_t size;
} file_bytes;

/* Reads a regular file of 1..size_cap bytes. An empty file is an error. */
CHECKED mrt_result file_read(file_bytes *out, const char *path, size_t size_cap, error *err);
void file_bytes_finish(file_bytes *bytes);

/* Finds the next bytes at or after `from` that are not a hole; false: none. A sparse file may claim
 * any length without using disk space, so code that budgets for a file or scans it uses only its
 * stored parts. If the file system does not support holes, the whole file counts. */
bool file_next_data(int fd, uint64_t from, uint64_t *out_begin, uint64_t *out_end);
/* Returns about how many bytes of the file are stored; the whole size if the file system does not
 * report that. 0: not a regular file. Does not open the file: closing it would release the locks of
 * this process on it, those of SQLite. */
uint64_t file_data_size(const char *path);

typedef struct file_writer {
    FILE *stream; /* write to it; file_writer_commit reports its errors */
    char *path, *temporary_path;
} file_writer;

/* Creates the missing folders of the path. On failure no file is left, and `out` is zeroed. */
CHECKED mrt_result file_writer_open(file_writer *out, const char *path, error *err);
/* Flushes, syncs and renames. The writer is finished, whatever the result. */
CHECKED mrt_result file_writer_commit(file_writer *writer, error *err);
/* Removes the temporary file; accepts a zeroed or finished writer. */
void file_writer_abandon(file_writer *writer);

/* Writes `size` bytes as a complete file, with the functions above. */
CHECKED mrt_result file_write(const char *path, const void *data, size_t size, error *err);

/* Locks the folder of `path`, so that programs that replace or remove files in it take turns. The
 * folder itself is locked: no lock file is left, and the lock ends with the process. Waits up to
 * patience_ms. Release it by close(*out_fd), which is -1 if it is not held. */
typedef enum file_lock {
    FILE_LOCK_HELD = 0,
    FILE_LOCK_BUSY,
    FILE_LOCK_UNSUPPORTED /* no such folder, or a file system without locks of folders (NFS) */
} file_lock;
file_lock file_lock_folder(int *out_fd, const char *path, int patience_ms);

/* Checks that the target of `path`, with links followed, is in `folder` ("": the working directory)
 * or below it, or in a folder of $MAROTTE_FILE_FOLDERS (separated by ':'). A file from an untrusted
 * source may only name files that came with it. A path without a target is checked by its text. The
 * error explains what to do. */
CHECKED mrt_result file_check_below(const char *folder, const char *path, error *err);

/* Reads a file that another file names, from the folder of that file (with final '/', or "") or
 * below, checked by file_check_below. folder NULL: data without a folder, so nothing can be
 * read. */
CHECKED mrt_result file_read_below(file_bytes *out, const char *folder, const char *name,
                                   size_t size_cap, error *err);

/* Returns the path of the user's own files: $XDG_CONFIG_HOME/marotte/REST, or without the variable
 * ~/.config/marotte/REST; data and cache likewise. Documents: marotte/REST in $XDG_DOCUMENTS_DIR,
 * else in the folder that the desktop's user-dirs.dirs names, else in the home folder. Fails if
 * neither variable nor home is known. */
typedef enum file_home {
    FILE_HOME_CONFIG = 0,
    FILE_HOME_DATA,
    FILE_HOME_CACHE,
    FILE_HOME_DOCUMENTS
} file_home;
CHECKED mrt_result file_home_path(char *out, size_t capacity, file_home which, const char *rest,
                                  error *err);
/* Creates all missing folders of the path, from the top. */
CHECKED mrt_result file_make_folders(const char *path, error *err);
/* Creates the missing folders above a file or folder that will be written. file_writer_open does
 * this itself; use this for other ways of writing. */
CHECKED mrt_result file_make_parent(const char *path, error *err);

/* Returns the part after the last '/' of path: "puppet.rig.json". */
const char *file_name_of(const char *path);
/* Returns the directory part of path with its final '/', or "": a copy that the caller frees; NULL:
 * no memory. */
char *file_directory(const char *path);
/* The extension in lower case without its dot ("glb"); "" if there is none; at most 15 letters. */
typedef struct file_extension {
    char text[16];
} file_extension;
file_extension file_extension_of(const char *path);

#endif
