#include "show/show_file.h"

#include "base/os.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* ---- the lock of the writing program ---- */

enum { WHO = 256, TRIES = 8 };

static void describe_self(char *out, size_t capacity)
{
    char host[64] = "", since[32] = "";
    time_t now = time(NULL);
    struct tm utc;
    os_host_name(host, sizeof host);
    if (gmtime_r(&now, &utc))
        (void)strftime(since, sizeof since, "%Y-%m-%d %H:%M:%S UTC", &utc);
    snprintf(out, capacity, "process %ld on %s since %s", (long)getpid(), host, since);
}

static void read_other(int fd, char who[WHO])
{
    ssize_t got = os_read_at(fd, who, WHO - 1, 0);
    who[got > 0 ? got : 0] = '\0';
    for (char *c = who; *c; ++c)
        if (*c < 32 || *c > 126)
            *c = *c == '\n' ? '\0' : '?';
    if (!who[0])
        snprintf(who, WHO, "another program");
}

static show_lock_state try_once(show_lock *out, char who[WHO])
{
    out->fd = os_open(out->path, OS_EDIT_OR_CREATE);
    if (out->fd < 0) {
        snprintf(who, WHO, "%s", strerror(errno));
        return SHOW_LOCK_REFUSED;
    }
    const os_lock_state state = os_lock(out->fd);
    if (state == OS_LOCK_HELD)
        return SHOW_LOCK_HELD;
    if (state == OS_LOCK_OTHERS)
        read_other(out->fd, who);
    else
        snprintf(who, WHO, "%s", strerror(errno));
    close(out->fd);
    out->fd = -1;
    return state == OS_LOCK_OTHERS ? SHOW_LOCK_OTHERS : SHOW_LOCK_REFUSED;
}

static void sign(int fd)
{
    char text[WHO];
    describe_self(text, sizeof text);
    if (ftruncate(fd, 0) != 0 || os_write_at(fd, text, strlen(text), 0) < 0)
        return; /* the lock still works; only the name of its holder is missing */
}

/* Returns the path of the lock, beside the real file, also if `path` is a link. */
static char *lock_path(const char *show_path)
{
    char *real = os_real_path(show_path);
    char *path = real ? show_beside(real, "-lock") : NULL;
    free(real);
    return path;
}

show_lock_state show_lock_acquire(show_lock *out, const char *show_path, char who[WHO])
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
        /* else the last holder removed the file between our open and our lock */
        if (os_is_at(out->fd, out->path)) {
            sign(out->fd);
            return SHOW_LOCK_HELD;
        }
        close(out->fd);
        out->fd = -1;
    }
    snprintf(who, WHO, "another program");
    return SHOW_LOCK_OTHERS;
}

void show_lock_release(show_lock *lock)
{
    if (lock->path && lock->fd >= 0) {
        if (os_is_at(lock->fd, lock->path))
            (void)unlink(lock->path);
        close(lock->fd);
    }
    free(lock->path);
    *lock = (show_lock){.fd = -1};
}

/* ---- connections ---- */

/* Synchronous is FULL here: when a call returns, its edit or new take has reached the disk. The
 * writer's own connection does not wait: see writer.c. */
mrt_result show_configure(sqlite *db, error *err)
{
    return sqlite_run(db,
                      "PRAGMA synchronous = FULL; PRAGMA foreign_keys = ON;"
                      "PRAGMA secure_delete = OFF;"
                      "PRAGMA wal_autocheckpoint = 4000; PRAGMA journal_size_limit = 1048576;"
                      "PRAGMA cache_size = -8000",
                      err);
}

mrt_result show_connect(const show *self, sqlite **out, error *err)
{
    mrt_result result = sqlite_open(out, self->path, SQLITE_MODE_WRITE, err);
    if (result >= 0)
        result = show_configure(*out, err);
    if (result < 0) {
        sqlite_close(*out);
        *out = NULL;
        return result;
    }
    sqlite_ignore_cancel(*out);
    sqlite_limit_each(*out);
    return result;
}

void show_limit_work(show *self)
{
    sqlite_limit_all(self->db);
}

mrt_result show_spend(show *self, uint64_t steps, error *err)
{
    return sqlite_spend(self->db, steps, err);
}

mrt_result show_read_begin(show *self, error *err)
{
    return sqlite_run(self->db, "BEGIN", err);
}

void show_read_end(show *self)
{
    (void)!sqlite_run(self->db, "COMMIT", NULL);
}

/* ---- rows ---- */

mrt_result show_grow(void **list, size_t count, size_t item_size, error *err)
{
    if (count & (count - 1)) /* the list has space for a power of two items */
        return MRT_OK;
    void *larger = realloc(*list, (count ? 2 * count : 1) * item_size);
    if (!larger)
        return error_set(err, MRT_ERR_MEMORY, "no memory for a list of %zu", count + 1);
    *list = larger;
    return MRT_OK;
}

mrt_result show_read_rows(show_rows *out, sqlite_statement *rows, size_t item_size,
                          mrt_result (*read)(void *item, sqlite_statement *row, error *err),
                          error *err)
{
    mrt_result result;
    *out = (show_rows){0};
    while ((result = sqlite_step(rows, err)) == MRT_OK) {
        result = show_grow(&out->item, out->count, item_size, err);
        if (result >= 0)
            result = read((char *)out->item + out->count * item_size, rows, err);
        if (result < 0)
            break;
        ++out->count;
    }
    result = sqlite_finish_rows(rows, result);
    if (result < 0) {
        free(out->item);
        *out = (show_rows){0};
    }
    return result;
}

static mrt_result read_id(void *item, sqlite_statement *row, error *err)
{
    return sqlite_get(row, err, (int64_t *)item);
}

mrt_result show_read_ids(show *self, const char *sql, int64_t **out, size_t *out_count, error *err)
{
    show_rows rows;
    mrt_result result =
        show_read_rows(&rows, sqlite_query(self->db, sql, "i", ""), sizeof **out, read_id, err);
    *out = rows.item;
    *out_count = rows.count;
    return result;
}

int64_t show_next_id(show *self, show_id of)
{
    return ++(self->owner ? self->owner : self)->last_id[of];
}

/* ---- about the file ---- */

const char *show_path(const show *self)
{
    return self->path;
}

uint64_t show_file_size(const show *self)
{
    return sqlite_file_size(self->db);
}

bool show_is_writable(const show *self)
{
    return self->is_writable;
}

const char *show_notice(const show *self)
{
    return self->notice;
}

bool show_is_file(const show *self, const char *path)
{
    os_file_id there;
    return os_id_of_path(path, &there) && there.device == self->file.device &&
           there.number == self->file.number;
}

bool show_is_missing(const show *self)
{
    return !show_is_file(self, self->path);
}

char *show_beside(const char *path, const char *suffix)
{
    size_t path_length = strlen(path), suffix_size = strlen(suffix) + 1;
    char *out = malloc(path_length + suffix_size);
    if (!out)
        return NULL;
    memcpy(out, path, path_length);
    memcpy(out + path_length, suffix, suffix_size);
    return out;
}

mrt_result show_check_writable(const show *self, error *err)
{
    if (self->is_writable)
        return MRT_OK;
    return error_set(err, MRT_ERR_UNSUPPORTED, "%s: is open read-only%s%s", self->path,
                     self->notice[0] ? ": " : "", self->notice);
}
