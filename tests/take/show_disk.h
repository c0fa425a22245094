/* A disk for SQLite that is full when a test says so: every file that is opened after
 * disk_install() goes through it. */
#ifndef MAROTTE_TESTS_SHOW_DISK_H
#define MAROTTE_TESTS_SHOW_DISK_H
#include <sqlite3.h>
#include <stdatomic.h>
#include <string.h>

static _Atomic int disk_answer;        /* to writes: SQLITE_OK, SQLITE_FULL, SQLITE_IOERR_WRITE */
static _Atomic int disk_refused_count; /* writes that got that answer */

typedef struct disk_file {
    sqlite3_file base;
    sqlite3_file *real; /* behind this struct */
} disk_file;

static sqlite3_file *disk_real(sqlite3_file *file)
{
    return ((disk_file *)file)->real;
}

static int disk_close(sqlite3_file *f)
{
    return disk_real(f)->pMethods->xClose(disk_real(f));
}

static int disk_read(sqlite3_file *f, void *out, int size, sqlite3_int64 at)
{
    return disk_real(f)->pMethods->xRead(disk_real(f), out, size, at);
}

static int disk_write(sqlite3_file *f, const void *bytes, int size, sqlite3_int64 at)
{
    int answer = atomic_load(&disk_answer);
    if (answer != SQLITE_OK) {
        atomic_fetch_add(&disk_refused_count, 1);
        return answer;
    }
    return disk_real(f)->pMethods->xWrite(disk_real(f), bytes, size, at);
}

static int disk_truncate(sqlite3_file *f, sqlite3_int64 size)
{
    return disk_real(f)->pMethods->xTruncate(disk_real(f), size);
}

static int disk_sync(sqlite3_file *f, int flags)
{
    return disk_real(f)->pMethods->xSync(disk_real(f), flags);
}

static int disk_size(sqlite3_file *f, sqlite3_int64 *out)
{
    return disk_real(f)->pMethods->xFileSize(disk_real(f), out);
}

static int disk_lock(sqlite3_file *f, int lock)
{
    return disk_real(f)->pMethods->xLock(disk_real(f), lock);
}

static int disk_unlock(sqlite3_file *f, int lock)
{
    return disk_real(f)->pMethods->xUnlock(disk_real(f), lock);
}

static int disk_check_lock(sqlite3_file *f, int *out)
{
    return disk_real(f)->pMethods->xCheckReservedLock(disk_real(f), out);
}

static int disk_control(sqlite3_file *f, int what, void *argument)
{
    return disk_real(f)->pMethods->xFileControl(disk_real(f), what, argument);
}

static int disk_sector(sqlite3_file *f)
{
    return disk_real(f)->pMethods->xSectorSize(disk_real(f));
}

static int disk_character(sqlite3_file *f)
{
    return disk_real(f)->pMethods->xDeviceCharacteristics(disk_real(f));
}

static int disk_map(sqlite3_file *f, int page, int size, int extend, void volatile **out)
{
    return disk_real(f)->pMethods->xShmMap(disk_real(f), page, size, extend, out);
}

static int disk_shm_lock(sqlite3_file *f, int offset, int count, int flags)
{
    return disk_real(f)->pMethods->xShmLock(disk_real(f), offset, count, flags);
}

static void disk_barrier(sqlite3_file *f)
{
    disk_real(f)->pMethods->xShmBarrier(disk_real(f));
}

static int disk_unmap(sqlite3_file *f, int remove)
{
    return disk_real(f)->pMethods->xShmUnmap(disk_real(f), remove);
}

static const sqlite3_io_methods disk_methods = {
    .iVersion = 2,
    .xClose = disk_close,
    .xRead = disk_read,
    .xWrite = disk_write,
    .xTruncate = disk_truncate,
    .xSync = disk_sync,
    .xFileSize = disk_size,
    .xLock = disk_lock,
    .xUnlock = disk_unlock,
    .xCheckReservedLock = disk_check_lock,
    .xFileControl = disk_control,
    .xSectorSize = disk_sector,
    .xDeviceCharacteristics = disk_character,
    .xShmMap = disk_map,
    .xShmLock = disk_shm_lock,
    .xShmBarrier = disk_barrier,
    .xShmUnmap = disk_unmap,
};

static sqlite3_vfs *disk_under;
static sqlite3_vfs disk_vfs;

static int disk_open(sqlite3_vfs *vfs, const char *name, sqlite3_file *file, int flags, int *out)
{
    (void)vfs;
    disk_file *self = (disk_file *)file;
    self->real = (sqlite3_file *)(self + 1);
    int code = disk_under->xOpen(disk_under, name, self->real, flags, out);
    self->base.pMethods = self->real->pMethods ? &disk_methods : NULL;
    return code;
}

static void disk_install(void)
{
    disk_under = sqlite3_vfs_find(NULL);
    disk_vfs = *disk_under;
    disk_vfs.zName = "disk";
    disk_vfs.pNext = NULL;
    disk_vfs.szOsFile = (int)sizeof(disk_file) + disk_under->szOsFile;
    disk_vfs.xOpen = disk_open;
    sqlite3_vfs_register(&disk_vfs, 1);
}

#endif
