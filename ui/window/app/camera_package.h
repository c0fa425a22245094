/* window/app/camera_package.h - the hand tracker of the camera's page: an npm package, where it
 * lies, and its download. Each file is checked by its SHA-256, which is pinned here; a partial or
 * wrong download is never used. Functions block: call them in a command or on a worker thread. */
#ifndef MAROTTE_UI_CAMERA_PACKAGE_H
#define MAROTTE_UI_CAMERA_PACKAGE_H
#include "base/error.h"

#include <limits.h>
#include <stdatomic.h>

typedef struct camera_package_file {
    const char *name, *sha256;
} camera_package_file;

typedef struct camera_package {
    const char *name, *version;
    const char *archive; /* its path in the registry */
    const char *archive_sha256;
    uint64_t archive_size, installed_size; /* bytes */
    const camera_package_file *file;       /* files that the page loads */
    uint32_t file_count;
} camera_package;
/* The package that is used: MediaPipe Hands. Tests set a small one, before they use it. */
extern const camera_package *camera_package_used;

/* Finds the folder of the package, below which npm has node_modules. */
CHECKED mrt_result camera_package_folder(char out[PATH_MAX], error *err);
/* Returns whether the package is there, without a check of its files. $MAROTTE_CAMERA_PACKAGE is
 * another folder with the same files. */
bool camera_package_is_there(void);

/* A download that goes on. Zeroed at first. */
typedef struct camera_fetch {
    bool is_shown;                /* what the programs say goes to standard error */
    _Atomic bool is_cancelled;    /* [any] ends it soon */
    _Atomic uint64_t done, whole; /* [any] bytes; whole 0: nothing is being downloaded yet */
} camera_fetch;
/* Does nothing if all files are there and right. Else downloads them: with npm, or where it is
 * missing or fails with curl and tar. The error is one sentence for the user. */
CHECKED mrt_result camera_package_fetch(camera_fetch *going, error *err);

#endif
