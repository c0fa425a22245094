#include "show/spool.h"

#include "base/file.h"

#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { PATH_BYTES = 96, RECORDS_MAX = 1 << 20, RECORDS_AT = 8192, KEPT_S = 3600 };
static const uint64_t magic = 0x33304c4f4f50534d; /* "MSPOOL03" */
static const char ending[] = ".spool";

typedef struct lane_head {
    _Atomic int64_t whose;
    _Atomic uint32_t written, done;
} lane_head;

typedef struct head { /* size of the file; the records start at RECORDS_AT, and those of the lanes
                         follow */
    uint64_t magic;
    uint64_t device, inode; /* of the show */
    int64_t context;
    uint32_t record_size, record_count;
    _Atomic uint32_t written, taken, settled;
    uint32_t lane_record_size, lane_record_count;
    lane_head lane[SPOOL_LANES];
    _Atomic int64_t used_s;   /* UTC of the last spool_settle */
    char show_path[PATH_MAX]; /* canonical path; "": unknown */
} head;
_Static_assert(sizeof(head) <= RECORDS_AT, "the head has room before the records");

struct spool {
    head *head;
    uint8_t *records, *lanes;
    int fd; /* locked while in use; -1: plain memory, or a found spool */
    spool_shape shape;
    size_t map_size; /* 0: plain memory */
    uint32_t mask;
    uint32_t next; /* index of the next pop of a found spool */
    bool is_found;
    char path[PATH_BYTES];
    _Atomic uint32_t loss_count;
};

static void begin_name(char out[PATH_BYTES])
{
    (void)snprintf(out, PATH_BYTES, "marotte-%ju-", (uintmax_t)os_user());
}

static void path_of(char out[PATH_BYTES], const os_file_id *of)
{
    char begin[PATH_BYTES];
    begin_name(begin);
    (void)snprintf(out, PATH_BYTES, "%s%.40s%jx-%ju%s", os_memory_folder(), begin,
                   (uintmax_t)of->device, (uintmax_t)of->number, ending);
}

/* Maps a new file. All its pages are allocated before use, so no access waits or fails. The file
 * gets its name only when it is locked and complete, so an unlocked spool is never one under
 * construction. */
static void *map_new_file(int *out_fd, const char *path, size_t size)
{
    char made[PATH_BYTES + 8];
    (void)snprintf(made, sizeof made, "%s.new", path);
    (void)unlink(made);
    *out_fd = -1;
    int fd = os_open(made, OS_CREATE_PRIVATE);
    if (fd < 0)
        return NULL;
    void *map = os_lock(fd) == OS_LOCK_HELD ? os_map_new(fd, size) : NULL;
    if (!map) {
        close(fd);
        (void)unlink(made);
        return NULL;
    }
    if (os_rename(made, path) != 0) {
        os_unmap(map, size);
        close(fd);
        (void)unlink(made);
        return NULL;
    }
    *out_fd = fd;
    return map;
}

static size_t size_of(const spool_shape *shape)
{
    return RECORDS_AT + shape->record_size * shape->record_count +
           SPOOL_LANES * shape->lane_record_size * shape->lane_record_count;
}

static void use_map(spool *self, void *map, const spool_shape *shape)
{
    self->head = map;
    self->records = (uint8_t *)map + RECORDS_AT;
    self->lanes = self->records + shape->record_size * shape->record_count;
    self->shape = *shape;
    self->mask = shape->record_count - 1;
}

spool *spool_create(const os_file_id *of, const char *path, const spool_shape *shape,
                    int64_t context)
{
    spool *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    spool_remove_abandoned(time(NULL));
    const size_t size = size_of(shape);
    path_of(self->path, of);
    void *map = map_new_file(&self->fd, self->path, size);
    self->map_size = map ? size : 0;
    if (!map)
        map = calloc(1, size);
    if (!map) {
        free(self);
        return NULL;
    }
    use_map(self, map, shape);
    self->head->device = of->device;
    self->head->inode = of->number;
    self->head->context = context;
    self->head->record_size = (uint32_t)shape->record_size;
    self->head->record_count = shape->record_count;
    self->head->lane_record_size = (uint32_t)shape->lane_record_size;
    self->head->lane_record_count = shape->lane_record_count;
    char *real = os_real_path(path);
    if (real && strlen(real) < sizeof self->head->show_path)
        (void)snprintf(self->head->show_path, sizeof self->head->show_path, "%s", real);
    free(real);
    atomic_store(&self->head->used_s, (int64_t)time(NULL));
    self->head->magic = magic;
    return self;
}

static void release_memory(spool *self)
{
    if (self->map_size > 0)
        os_unmap(self->head, self->map_size);
    else
        free(self->head);
}

static void release(spool *self)
{
    if (self->fd >= 0)
        close(self->fd);
    free(self);
}

void spool_abandon(spool *self)
{
    if (!self)
        return;
    release_memory(self);
    release(self);
}

/* Removes the file while it is still locked. */
void spool_destroy(spool *self)
{
    if (!self)
        return;
    release_memory(self);
    if (self->map_size > 0)
        (void)unlink(self->path);
    release(self);
}

bool spool_push(spool *self, const void *record)
{
    uint32_t written = atomic_load_explicit(&self->head->written, memory_order_relaxed);
    uint32_t taken = atomic_load_explicit(&self->head->taken, memory_order_acquire);
    if (written - taken > self->mask) {
        atomic_fetch_add_explicit(&self->loss_count, 1, memory_order_relaxed);
        return false;
    }
    memcpy(self->records + (written & self->mask) * self->shape.record_size, record,
           self->shape.record_size);
    atomic_store_explicit(&self->head->written, written + 1, memory_order_release);
    return true;
}

bool spool_pop(spool *self, void *out_record)
{
    uint32_t at = self->is_found ? self->next
                                 : atomic_load_explicit(&self->head->taken, memory_order_relaxed);
    if (at == atomic_load_explicit(&self->head->written, memory_order_acquire))
        return false;
    memcpy(out_record, self->records + (at & self->mask) * self->shape.record_size,
           self->shape.record_size);
    if (self->is_found)
        self->next = at + 1;
    else
        atomic_store_explicit(&self->head->taken, at + 1, memory_order_release);
    return true;
}

void spool_settle(spool *self)
{
    atomic_store_explicit(&self->head->settled,
                          atomic_load_explicit(&self->head->taken, memory_order_relaxed),
                          memory_order_release);
    atomic_store_explicit(&self->head->used_s, (int64_t)time(NULL), memory_order_relaxed);
}

/* The producer may have wrapped around since the last spool_settle. */
static uint32_t left_count(const spool *self)
{
    uint32_t count = atomic_load(&self->head->written) - atomic_load(&self->head->settled);
    return count <= self->mask ? count : self->mask + 1;
}

uint32_t spool_left_count(const spool *self)
{
    return self->map_size > 0 ? left_count(self) : 0;
}

uint32_t spool_loss_count(const spool *self)
{
    return atomic_load_explicit(&self->loss_count, memory_order_relaxed);
}

/* ---- lanes ---- */

static uint8_t *lane_record(const spool *self, uint32_t lane, uint32_t at)
{
    const size_t index =
        (size_t)lane * self->shape.lane_record_count + (at & (self->shape.lane_record_count - 1));
    return self->lanes + index * self->shape.lane_record_size;
}

void spool_lane_clear(spool *self, uint32_t lane)
{
    lane_head *h = &self->head->lane[lane];
    atomic_store(&h->whose, 0);
    atomic_store(&h->written, 0);
    atomic_store(&h->done, 0);
}

void spool_lane_push(spool *self, uint32_t lane, const void *record)
{
    lane_head *h = &self->head->lane[lane];
    uint32_t written = atomic_load_explicit(&h->written, memory_order_relaxed);
    memcpy(lane_record(self, lane, written), record, self->shape.lane_record_size);
    atomic_store_explicit(&h->written, written + 1, memory_order_release);
}

void spool_lane_mark(spool *self, uint32_t lane, int64_t whose)
{
    atomic_store_explicit(&self->head->lane[lane].whose, whose, memory_order_release);
}

void spool_lane_done(spool *self, uint32_t lane, uint32_t done)
{
    atomic_store_explicit(&self->head->lane[lane].done, done, memory_order_release);
}

/* The oldest record of a full lane may be half overwritten, so it is skipped. */
spool_lane spool_lane_of(const spool *self, uint32_t lane)
{
    const lane_head *h = &self->head->lane[lane];
    const uint32_t written = atomic_load(&h->written), capacity = self->shape.lane_record_count;
    return (spool_lane){.whose = atomic_load(&h->whose),
                        .done = atomic_load(&h->done),
                        .count = written < capacity ? written
                                 : capacity         ? capacity - 1
                                                    : 0};
}

void spool_lane_read(const spool *self, uint32_t lane, uint32_t index, void *out_record)
{
    const spool_lane all = spool_lane_of(self, lane);
    const uint32_t written = atomic_load(&self->head->lane[lane].written);
    memcpy(out_record, lane_record(self, lane, written - all.count + index),
           self->shape.lane_record_size);
}

/* ---- spools that a program left ---- */

static void *map_old_file(const char *path, size_t *out_size)
{
    struct stat status;
    void *map = NULL;
    int fd = os_open(path, OS_READ_NO_LINK);
    if (fd < 0)
        return NULL;
    if (fstat(fd, &status) == 0 && S_ISREG(status.st_mode) && os_is_private(&status) &&
        status.st_size > RECORDS_AT) {
        *out_size = (size_t)status.st_size;
        map = os_map_read(fd, *out_size);
    }
    close(fd);
    return map;
}

/* Checks that the values of the head are possible. */
static bool has_shape(const head *h, const spool_shape *shape)
{
    return h->record_size == shape->record_size && h->record_count > 0 &&
           h->record_count <= RECORDS_MAX && (h->record_count & (h->record_count - 1)) == 0 &&
           h->lane_record_size == shape->lane_record_size && h->lane_record_count <= RECORDS_MAX &&
           (h->lane_record_count & (h->lane_record_count - 1)) == 0;
}

static bool is_of(const head *h, size_t size, const os_file_id *of, const spool_shape *shape)
{
    return h->magic == magic && h->device == of->device && h->inode == of->number &&
           size == size_of(shape);
}

spool *spool_find(const os_file_id *of, const spool_shape *shape, int64_t *out_context)
{
    spool *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->fd = -1;
    path_of(self->path, of);
    void *map = map_old_file(self->path, &self->map_size);
    if (!map) {
        free(self);
        return NULL;
    }
    self->head = map;
    spool_shape found = *shape;
    found.record_count = self->head->record_count;
    found.lane_record_count = self->head->lane_record_count;
    if (!has_shape(map, shape) || !is_of(map, self->map_size, of, &found)) {
        spool_destroy(self);
        return NULL;
    }
    use_map(self, map, &found);
    *out_context = self->head->context;
    self->is_found = true;
    self->next = atomic_load(&self->head->written) - left_count(self);
    return self;
}

/* ---- abandoned spools ---- */

static bool is_in_folder(const char *show_path, uint64_t inode)
{
    char *name = file_directory(show_path);
    DIR *list = name ? opendir(name) : NULL;
    bool is_found = false;
    for (struct dirent *e; list && !is_found && (e = readdir(list));)
        is_found = (uint64_t)e->d_ino == inode;
    if (list)
        closedir(list);
    free(name);
    return is_found;
}

/* Returns true if the show was deleted. The nearest existing folder must be on the disk of the
 * show: then the disk is mounted, and only the show is missing. */
static bool is_deleted(const head *of)
{
    char path[PATH_MAX];
    os_file_id there;
    (void)snprintf(path, sizeof path, "%.*s", PATH_MAX - 1, of->show_path);
    if (path[0] != '/' || is_in_folder(path, of->inode))
        return false;
    while (!os_id_of_path(path, &there)) {
        char *slash = strrchr(path, '/');
        if ((errno != ENOENT && errno != ENOTDIR) || !slash)
            return false;
        slash[slash == path] = '\0';
    }
    return there.device == of->device;
}

/* Returns true if all its records are in the show. */
static bool is_settled(const head *of)
{
    for (uint32_t i = 0; i < SPOOL_LANES; ++i)
        if (atomic_load(&of->lane[i].whose) != 0 && atomic_load(&of->lane[i].written) > 0)
            return false;
    return atomic_load(&of->written) == atomic_load(&of->settled);
}

static void remove_one(const char *path, int64_t now_s)
{
    head of;
    struct stat status;
    const int fd = os_open(path, OS_READ_NO_LINK);
    if (fd < 0)
        return;
    if (fstat(fd, &status) == 0 && S_ISREG(status.st_mode) && os_is_mine(&status) &&
        os_lock(fd) == OS_LOCK_HELD && os_read_at(fd, &of, sizeof of, 0) == (ssize_t)sizeof of &&
        of.magic == magic && memchr(of.show_path, 0, sizeof of.show_path)) {
        const bool is_old = now_s - atomic_load(&of.used_s) > KEPT_S;
        if ((is_settled(&of) || (is_old && is_deleted(&of))) && os_is_at(fd, path))
            (void)unlink(path);
    }
    close(fd);
}

void spool_remove_abandoned(int64_t now_s)
{
    char begin[PATH_BYTES], path[PATH_BYTES];
    begin_name(begin);
    DIR *list = opendir(os_memory_folder());
    if (!list)
        return;
    for (struct dirent *e; (e = readdir(list));) {
        const size_t length = strlen(e->d_name);
        if (length > sizeof ending && strncmp(e->d_name, begin, strlen(begin)) == 0 &&
            strcmp(e->d_name + length - (sizeof ending - 1), ending) == 0 &&
            snprintf(path, sizeof path, "%s%s", os_memory_folder(), e->d_name) < (int)sizeof path)
            remove_one(path, now_s);
    }
    closedir(list);
}
