#include "take/show_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* ---- who may write ---- */

enum { WHO = 256, TRIES = 8 };

static void describe_self(char *out, size_t capacity)
{
    char host[64] = "", since[32] = "";
    time_t now = time(NULL);
    struct tm utc;
    if (gethostname(host, sizeof host - 1) != 0)
        snprintf(host, sizeof host, "this computer");
    if (gmtime_r(&now, &utc))
        (void)strftime(since, sizeof since, "%Y-%m-%d %H:%M:%S UTC", &utc);
    snprintf(out, capacity, "process %ld on %s since %s", (long)getpid(), host, since);
}

static void read_other(int fd, char who[WHO])
{
    ssize_t got = pread(fd, who, WHO - 1, 0);
    who[got > 0 ? got : 0] = '\0';
    for (char *c = who; *c; ++c)
        if (*c < 32 || *c > 126)
            *c = *c == '\n' ? '\0' : '?';
    if (!who[0])
        snprintf(who, WHO, "another program");
}

/* The lock file was removed by its last holder between our opening and locking it. */
static bool is_still_there(int fd, const char *path)
{
    struct stat ours, there;
    return fstat(fd, &ours) == 0 && stat(path, &there) == 0 && ours.st_ino == there.st_ino &&
           ours.st_dev == there.st_dev;
}

static show_lock_state try_once(show_lock *out, char who[WHO])
{
    out->fd = open(out->path, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);
    if (out->fd < 0) {
        snprintf(who, WHO, "%s", strerror(errno));
        return SHOW_LOCK_REFUSED;
    }
    if (flock(out->fd, LOCK_EX | LOCK_NB) == 0)
        return SHOW_LOCK_HELD;
    int reason = errno;
    if (reason == EWOULDBLOCK)
        read_other(out->fd, who);
    else
        snprintf(who, WHO, "%s", strerror(reason));
    close(out->fd);
    out->fd = -1;
    return reason == EWOULDBLOCK ? SHOW_LOCK_OTHERS : SHOW_LOCK_REFUSED;
}

static void sign(int fd)
{
    char text[WHO];
    describe_self(text, sizeof text);
    if (ftruncate(fd, 0) != 0 || pwrite(fd, text, strlen(text), 0) < 0)
        return; /* the lock holds all the same; only its name is missing */
}

/* Beside the file itself, whatever names lead to it. */
static char *lock_path(const char *show_path)
{
    char *real = realpath(show_path, NULL);
    char *path = real ? show_beside(real, "-lock") : NULL;
    free(real);
    return path;
}

show_lock_state show_lock_take(show_lock *out, const char *show_path, char who[WHO])
{
    *out = (show_lock){.fd = -1, .path = lock_path(show_path)};
    if (!out->path) {
        snprintf(who, WHO, "%s", strerror(errno));
        return SHOW_LOCK_REFUSED;
    }
    for (int i = 0; i < TRIES; ++i) {
        show_lock_state state = try_once(out, who);
        if (state != SHOW_LOCK_HELD)
            return state;
        if (is_still_there(out->fd, out->path)) {
            sign(out->fd);
            return SHOW_LOCK_HELD;
        }
        close(out->fd);
        out->fd = -1;
    }
    snprintf(who, WHO, "another program");
    return SHOW_LOCK_OTHERS;
}

void show_lock_let_go(show_lock *lock)
{
    if (lock->path && lock->fd >= 0) {
        if (is_still_there(lock->fd, lock->path))
            (void)unlink(lock->path);
        close(lock->fd);
    }
    free(lock->path);
    *lock = (show_lock){.fd = -1};
}
