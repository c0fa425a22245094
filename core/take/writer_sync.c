#include "take/writer_sync.h"

#include "base/clock.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { LOG_BYTES_LONG = 8 * 1024 * 1024 };

struct writer_sync {
    const show *of;
    sqlite *db;
    char *log_path;
    int log_fd; /* -1: not there yet */
    pthread_t thread;
    pthread_mutex_t lock;
    pthread_cond_t wake;
    bool is_stopping; /* GUARDED_BY(lock) */
    _Atomic bool is_missing;
};

/* The log is one file for as long as somebody has the show open. It is not locked, so that closing
 * it takes no lock away from SQLite, as it would with the show itself. */
static off_t log_size(writer_sync *self)
{
    struct stat status;
    if (self->log_fd < 0)
        self->log_fd = open(self->log_path, O_RDONLY | O_CLOEXEC);
    return self->log_fd >= 0 && fstat(self->log_fd, &status) == 0 ? status.st_size : 0;
}

/* Failures are the writer's to meet: it writes to the same disk. */
static void bring_to_disk(writer_sync *self)
{
    off_t size = log_size(self);
    if (size > 0)
        (void)fdatasync(self->log_fd);
    if (size > LOG_BYTES_LONG && sqlite_checkpoint(self->db, NULL) < 0)
        return;
}

static bool wait_a_second(writer_sync *self)
{
    struct timespec until;
    clock_gettime(CLOCK_MONOTONIC, &until);
    until.tv_sec += 1;
    pthread_mutex_lock(&self->lock);
    int woken = 0;
    while (!self->is_stopping && woken != ETIMEDOUT)
        woken = pthread_cond_timedwait(&self->wake, &self->lock, &until);
    bool goes_on = !self->is_stopping;
    pthread_mutex_unlock(&self->lock);
    return goes_on;
}

static void *run(void *data)
{
    writer_sync *self = data;
    while (wait_a_second(self)) {
        bring_to_disk(self);
        atomic_store(&self->is_missing, show_is_missing(self->of));
    }
    return NULL;
}

static void destroy(writer_sync *self)
{
    sqlite_close(self->db);
    if (self->log_fd >= 0)
        close(self->log_fd);
    pthread_cond_destroy(&self->wake);
    pthread_mutex_destroy(&self->lock);
    free(self->log_path);
    free(self);
}

static void init_wait(writer_sync *self)
{
    pthread_condattr_t monotonic;
    pthread_condattr_init(&monotonic);
    pthread_condattr_setclock(&monotonic, CLOCK_MONOTONIC);
    pthread_cond_init(&self->wake, &monotonic);
    pthread_condattr_destroy(&monotonic);
    pthread_mutex_init(&self->lock, NULL);
}

mrt_result writer_sync_start(writer_sync **out, const show *s, error *err)
{
    *out = NULL;
    writer_sync *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "%s: no memory", show_path(s));
    self->of = s;
    self->log_fd = -1;
    init_wait(self);
    mrt_result result = show_connect(s, &self->db, err);
    self->log_path = show_beside(show_path(s), "-wal");
    if (result >= 0 && !self->log_path)
        result = error_set(err, MRT_ERR_MEMORY, "%s: no memory", show_path(s));
    if (result >= 0 && pthread_create(&self->thread, NULL, run, self) != 0)
        result = error_set(err, MRT_ERR_MEMORY, "%s: no thread to record with", show_path(s));
    if (result < 0) {
        destroy(self);
        return result;
    }
    *out = self;
    return MRT_OK;
}

void writer_sync_stop(writer_sync *self)
{
    if (!self)
        return;
    pthread_mutex_lock(&self->lock);
    self->is_stopping = true;
    pthread_cond_signal(&self->wake);
    pthread_mutex_unlock(&self->lock);
    pthread_join(self->thread, NULL);
    destroy(self);
}

bool writer_sync_is_missing(const writer_sync *self)
{
    return atomic_load(&self->is_missing);
}
