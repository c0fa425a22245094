#define _GNU_SOURCE /* for SEEK_DATA, gettid */
#include "base/os.h"

#include "base/clock.h"

#include <fcntl.h>
#include <limits.h>
#include <linux/futex.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <errno.h>

_Static_assert(sizeof(_Atomic uint32_t) == sizeof(uint32_t), "a futex is a plain 32-bit word");

/* ---- files ---- */

int os_open(const char *path, os_open_mode mode)
{
    static const int flags[] = {
        [OS_READ] = O_RDONLY | O_NONBLOCK,
        [OS_READ_NO_LINK] = O_RDONLY | O_NONBLOCK | O_NOFOLLOW,
        [OS_EDIT] = O_RDWR | O_NONBLOCK | O_NOFOLLOW,
        [OS_EDIT_OR_CREATE] = O_RDWR | O_NONBLOCK | O_NOFOLLOW | O_CREAT,
        [OS_CREATE] = O_RDWR | O_NOFOLLOW | O_CREAT | O_EXCL,
        [OS_CREATE_PRIVATE] = O_RDWR | O_NOFOLLOW | O_CREAT | O_EXCL,
        [OS_FOLDER] = O_RDONLY | O_DIRECTORY,
    };
    return open(path, flags[mode] | O_CLOEXEC, mode == OS_CREATE_PRIVATE ? 0600 : 0666);
}

os_lock_state os_lock(int fd)
{
    if (flock(fd, LOCK_EX | LOCK_NB) == 0)
        return OS_LOCK_HELD;
    return errno == EWOULDBLOCK ? OS_LOCK_OTHERS : OS_LOCK_REFUSED;
}

ssize_t os_read_at(int fd, void *out, size_t size, int64_t at)
{
    return pread(fd, out, size, at);
}

ssize_t os_write_at(int fd, const void *bytes, size_t size, int64_t at)
{
    return pwrite(fd, bytes, size, at);
}

bool os_next_data(int fd, uint64_t from, uint64_t *out_begin, uint64_t *out_end)
{
    const off_t begin = lseek(fd, (off_t)from, SEEK_DATA);
    const off_t end = begin < 0 ? -1 : lseek(fd, begin, SEEK_HOLE);
    *out_begin = *out_end = 0;
    if (end <= begin)
        return false;
    *out_begin = (uint64_t)begin;
    *out_end = (uint64_t)end;
    return true;
}

uint64_t os_stored_bytes(const struct stat *status)
{
    return 512 * (uint64_t)status->st_blocks;
}

int os_sync(int fd)
{
    return fsync(fd);
}

int os_duplicate(int fd)
{
    return fcntl(fd, F_DUPFD_CLOEXEC, 0);
}

int os_rename(const char *from, const char *to)
{
    return rename(from, to);
}

int os_stat_link(const char *path, struct stat *out)
{
    return lstat(path, out);
}

uint64_t os_user(void)
{
    return geteuid();
}

bool os_is_mine(const struct stat *status)
{
    return status->st_uid == geteuid();
}

bool os_is_private(const struct stat *status)
{
    return os_is_mine(status) && (status->st_mode & 077) == 0;
}

bool os_id_of_path(const char *path, os_file_id *out)
{
    struct stat status;
    if (stat(path, &status) != 0)
        return false;
    *out = (os_file_id){(uint64_t)status.st_dev, (uint64_t)status.st_ino};
    return true;
}

bool os_is_at(int fd, const char *path)
{
    struct stat open_file, there;
    return fstat(fd, &open_file) == 0 && lstat(path, &there) == 0 &&
           there.st_dev == open_file.st_dev && there.st_ino == open_file.st_ino;
}

int os_make_folder(const char *path)
{
    return mkdir(path, 0777);
}

int os_make_new_folder(char *path)
{
    return mkdtemp(path) ? 0 : -1;
}

char *os_real_path(const char *path)
{
    return realpath(path, NULL);
}

/* ---- memory ---- */

void *os_aligned_alloc(size_t alignment, size_t size)
{
    return aligned_alloc(alignment, size);
}

void os_aligned_free(void *memory)
{
    free(memory);
}

void os_use_large_pages(void *memory, size_t size)
{
    (void)madvise(memory, size, MADV_HUGEPAGE);
}

uint64_t os_resident_bytes(void)
{
    unsigned long long total = 0, resident = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (!file)
        return 0;
    int read = fscanf(file, "%llu %llu", &total, &resident);
    fclose(file);
    long page = sysconf(_SC_PAGESIZE);
    return read == 2 && page > 0 ? resident * (unsigned long long)page : 0;
}

const char *os_memory_folder(void)
{
    return "/dev/shm/";
}

/* Allocates all pages of a new file in one call. Each page fault would cost 7 microseconds. */
static void fault_in(void *map, size_t size)
{
#ifdef MADV_POPULATE_WRITE
    if (madvise(map, size, MADV_POPULATE_WRITE) == 0)
        return;
#endif
    memset(map, 0, size);
}

void *os_map_new(int fd, size_t size)
{
    if (posix_fallocate(fd, 0, (off_t)size) != 0)
        return NULL;
    void *map = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
    if (map == MAP_FAILED)
        return NULL;
    fault_in(map, size);
    return map;
}

void *os_map_read(int fd, size_t size)
{
    void *map = mmap(NULL, size, PROT_READ, MAP_PRIVATE, fd, 0);
    return map == MAP_FAILED ? NULL : map;
}

void os_unmap(void *map, size_t size)
{
    (void)munmap(map, size);
}

/* ---- threads ---- */

void os_wait_word(const _Atomic uint32_t *word, uint32_t value, int64_t until_ns)
{
    const struct timespec until = {.tv_sec = (time_t)(until_ns / NS_PER_S),
                                   .tv_nsec = (long)(until_ns % NS_PER_S)};
    syscall(SYS_futex, word, FUTEX_WAIT_BITSET_PRIVATE, value,
            until_ns == INT64_MAX ? NULL : &until, NULL, FUTEX_BITSET_MATCH_ANY);
}

void os_wake_word(const _Atomic uint32_t *word)
{
    syscall(SYS_futex, word, FUTEX_WAKE_PRIVATE, INT_MAX, NULL, NULL, 0);
}

int os_start_thread(pthread_t *out, void *(*run)(void *data), void *data)
{
    sigset_t all, old;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &old);
    const int failed = pthread_create(out, NULL, run, data);
    pthread_sigmask(SIG_SETMASK, &old, NULL);
    return failed;
}

long os_thread_id(void)
{
    return (long)syscall(SYS_gettid);
}

struct timespec os_condition_time(int64_t time_ns)
{
    return (struct timespec){.tv_sec = (time_t)(time_ns / NS_PER_S),
                             .tv_nsec = (long)(time_ns % NS_PER_S)};
}

void os_on_fork(void (*before)(void), void (*in_parent)(void), void (*in_child)(void))
{
    (void)pthread_atfork(before, in_parent, in_child);
}

/* ---- this program ---- */

bool os_program_path(char *out, size_t capacity)
{
    ssize_t length = readlink("/proc/self/exe", out, capacity - 1);
    out[length > 0 ? length : 0] = '\0';
    return length > 0 && (size_t)length < capacity - 1;
}

void os_host_name(char *out, size_t capacity)
{
    if (gethostname(out, capacity) != 0)
        (void)snprintf(out, capacity, "this computer");
    out[capacity - 1] = '\0';
}

static void (*stop_now)(void);
static int exit_code_now;

static void force(int number)
{
    (void)number;
    _exit(exit_code_now);
}

static void on_signal(int number)
{
    (void)number;
    stop_now();
}

void os_on_stop(void (*stop)(void), int exit_code)
{
    static const int signals[] = {SIGINT, SIGTERM, SIGHUP};
    struct sigaction ask = {.sa_handler = on_signal}, before;
    stop_now = stop;
    exit_code_now = exit_code;
    sigemptyset(&ask.sa_mask);
    ask.sa_flags = (int)SA_RESETHAND;
    for (size_t i = 0; i < sizeof signals / sizeof signals[0]; ++i)
        if (signals[i] != SIGHUP || /* with nohup the program outlives the terminal */
            (sigaction(SIGHUP, NULL, &before) == 0 && before.sa_handler != SIG_IGN))
            sigaction(signals[i], &ask, NULL);
}

void os_end_after(unsigned seconds)
{
    struct sigaction late = {.sa_handler = force};
    sigemptyset(&late.sa_mask);
    sigaction(SIGALRM, &late, NULL);
    (void)alarm(seconds);
}
