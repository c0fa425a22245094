#define _WIN32_WINNT 0x0602 /* Windows 8: WaitOnAddress */
#include "base/os.h"

#include "base/clock.h"

#include <errno.h>
#include <fcntl.h>
#include <io.h>
#include <malloc.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <windows.h>

#include <psapi.h>

enum { PATH_LETTERS = 1024, FILETIME_PER_S = 10000000 };

/* ---- files ---- */

/* Sets errno, and returns -1. */
static int failed(void)
{
    switch (GetLastError()) {
    case ERROR_FILE_NOT_FOUND:
    case ERROR_PATH_NOT_FOUND:
    case ERROR_INVALID_NAME:
        errno = ENOENT;
        break;
    case ERROR_FILE_EXISTS:
    case ERROR_ALREADY_EXISTS:
        errno = EEXIST;
        break;
    case ERROR_ACCESS_DENIED:
    case ERROR_SHARING_VIOLATION:
    case ERROR_WRITE_PROTECT:
        errno = EACCES;
        break;
    case ERROR_DISK_FULL:
    case ERROR_HANDLE_DISK_FULL:
        errno = ENOSPC;
        break;
    case ERROR_NOT_ENOUGH_MEMORY:
        errno = ENOMEM;
        break;
    default:
        errno = EIO;
    }
    return -1;
}

static HANDLE handle_of(int fd)
{
    return (HANDLE)_get_osfhandle(fd);
}

int os_open(const char *path, os_open_mode mode)
{
    static const struct {
        DWORD access, creation, flags;
        int descriptor;
    } how[] = {
        [OS_READ] = {GENERIC_READ, OPEN_EXISTING, 0, O_RDONLY},
        [OS_READ_NO_LINK] = {GENERIC_READ, OPEN_EXISTING, FILE_FLAG_OPEN_REPARSE_POINT, O_RDONLY},
        [OS_EDIT] = {GENERIC_READ | GENERIC_WRITE, OPEN_EXISTING, FILE_FLAG_OPEN_REPARSE_POINT,
                     O_RDWR},
        [OS_EDIT_OR_CREATE] = {GENERIC_READ | GENERIC_WRITE, OPEN_ALWAYS,
                               FILE_FLAG_OPEN_REPARSE_POINT, O_RDWR},
        [OS_CREATE] = {GENERIC_READ | GENERIC_WRITE, CREATE_NEW, 0, O_RDWR},
        [OS_CREATE_PRIVATE] = {GENERIC_READ | GENERIC_WRITE, CREATE_NEW, 0, O_RDWR},
    };
    const DWORD attributes = GetFileAttributesA(path);
    if (mode == OS_FOLDER ||
        (attributes != INVALID_FILE_ATTRIBUTES && (attributes & FILE_ATTRIBUTE_DIRECTORY))) {
        errno = mode == OS_FOLDER ? ENOTSUP : EISDIR; /* folders cannot be locked */
        return -1;
    }
    HANDLE file =
        CreateFileA(path, how[mode].access, FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE,
                    NULL, how[mode].creation, how[mode].flags | FILE_ATTRIBUTE_NORMAL, NULL);
    if (file == INVALID_HANDLE_VALUE)
        return failed();
    const int fd = _open_osfhandle((intptr_t)file, how[mode].descriptor | O_BINARY | O_NOINHERIT);
    if (fd < 0)
        CloseHandle(file);
    return fd;
}

/* Locks a byte far behind the end: on Windows nobody else could read the bytes that are locked. */
os_lock_state os_lock(int fd)
{
    OVERLAPPED at = {.OffsetHigh = 0x7fffffff};
    if (LockFileEx(handle_of(fd), LOCKFILE_EXCLUSIVE_LOCK | LOCKFILE_FAIL_IMMEDIATELY, 0, 1, 0,
                   &at))
        return OS_LOCK_HELD;
    if (GetLastError() == ERROR_LOCK_VIOLATION)
        return OS_LOCK_OTHERS;
    (void)failed();
    return OS_LOCK_REFUSED;
}

static OVERLAPPED offset_of(int64_t at)
{
    return (OVERLAPPED){.Offset = (DWORD)(uint64_t)at, .OffsetHigh = (DWORD)((uint64_t)at >> 32)};
}

ssize_t os_read_at(int fd, void *out, size_t size, int64_t at)
{
    OVERLAPPED from = offset_of(at);
    DWORD got = 0;
    if (ReadFile(handle_of(fd), out, (DWORD)(size < INT32_MAX ? size : INT32_MAX), &got, &from))
        return (ssize_t)got;
    return GetLastError() == ERROR_HANDLE_EOF ? 0 : failed();
}

ssize_t os_write_at(int fd, const void *bytes, size_t size, int64_t at)
{
    OVERLAPPED from = offset_of(at);
    DWORD done = 0;
    if (WriteFile(handle_of(fd), bytes, (DWORD)(size < INT32_MAX ? size : INT32_MAX), &done, &from))
        return (ssize_t)done;
    return failed();
}

bool os_next_data(int fd, uint64_t from, uint64_t *out_begin, uint64_t *out_end)
{
    const int64_t size = _filelengthi64(fd);
    *out_begin = *out_end = 0;
    if (size < 0 || from >= (uint64_t)size)
        return false;
    *out_begin = from;
    *out_end = (uint64_t)size;
    return true;
}

uint64_t os_stored_bytes(const struct stat *status)
{
    (void)status;
    return 0;
}

int os_sync(int fd)
{
    return _commit(fd);
}

int os_duplicate(int fd)
{
    return _dup(fd);
}

int os_rename(const char *from, const char *to)
{
    return MoveFileExA(from, to, MOVEFILE_REPLACE_EXISTING) ? 0 : failed();
}

int os_stat_link(const char *path, struct stat *out)
{
    return stat(path, out);
}

uint64_t os_user(void)
{
    return 0;
}

bool os_is_mine(const struct stat *status)
{
    (void)status;
    return true;
}

bool os_is_private(const struct stat *status)
{
    return os_is_mine(status);
}

static bool id_of(HANDLE file, os_file_id *out)
{
    BY_HANDLE_FILE_INFORMATION info;
    if (!GetFileInformationByHandle(file, &info)) {
        (void)failed();
        return false;
    }
    *out = (os_file_id){info.dwVolumeSerialNumber,
                        (uint64_t)info.nFileIndexHigh << 32 | info.nFileIndexLow};
    return true;
}

/* Opens a file or folder only to ask about it. */
static HANDLE open_to_ask(const char *path)
{
    return CreateFileA(path, 0, FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE, NULL,
                       OPEN_EXISTING, FILE_FLAG_BACKUP_SEMANTICS, NULL);
}

bool os_id_of_path(const char *path, os_file_id *out)
{
    HANDLE file = open_to_ask(path);
    if (file == INVALID_HANDLE_VALUE) {
        (void)failed();
        return false;
    }
    const bool is_known = id_of(file, out);
    CloseHandle(file);
    return is_known;
}

bool os_is_at(int fd, const char *path)
{
    os_file_id open_file, there;
    return id_of(handle_of(fd), &open_file) && os_id_of_path(path, &there) &&
           there.device == open_file.device && there.number == open_file.number;
}

int os_make_folder(const char *path)
{
    return CreateDirectoryA(path, NULL) ? 0 : failed();
}

int os_make_new_folder(char *path)
{
    enum { LETTERS = 6, TRIES = 100 };
    char *end = path + strlen(path) - LETTERS;
    for (unsigned i = 0; i < TRIES; ++i) {
        const unsigned number = ((unsigned)GetTickCount() * 2654435761u + i) % 1000000u;
        (void)snprintf(end, LETTERS + 1, "%06u", number);
        if (os_make_folder(path) == 0)
            return 0;
        if (errno != EEXIST)
            break;
    }
    return -1;
}

static void use_slashes(char *path)
{
    for (; *path; ++path)
        *path = *path == '\\' ? '/' : *path;
}

char *os_real_path(const char *path)
{
    static const char prefix[] = "\\\\?\\";
    char *out = malloc(PATH_LETTERS);
    HANDLE file = out ? open_to_ask(path) : INVALID_HANDLE_VALUE;
    const DWORD length = file == INVALID_HANDLE_VALUE
                             ? 0
                             : GetFinalPathNameByHandleA(file, out, PATH_LETTERS, VOLUME_NAME_DOS);
    if (length == 0 || length >= PATH_LETTERS) {
        (void)failed();
        free(out);
        out = NULL;
    }
    if (file != INVALID_HANDLE_VALUE)
        CloseHandle(file);
    if (!out)
        return NULL;
    if (strncmp(out, prefix, strlen(prefix)) == 0)
        memmove(out, out + strlen(prefix), length - strlen(prefix) + 1);
    use_slashes(out);
    return out;
}

/* ---- memory ---- */

void *os_aligned_alloc(size_t alignment, size_t size)
{
    return _aligned_malloc(size, alignment);
}

void os_aligned_free(void *memory)
{
    _aligned_free(memory);
}

void os_use_large_pages(void *memory, size_t size)
{
    (void)memory; /* only for programs with a privilege */
    (void)size;
}

uint64_t os_resident_bytes(void)
{
    PROCESS_MEMORY_COUNTERS now;
    return GetProcessMemoryInfo(GetCurrentProcess(), &now, sizeof now) ? now.WorkingSetSize : 0;
}

const char *os_memory_folder(void)
{
    static char folder[MAX_PATH + 1];
    if (!folder[0] && GetTempPathA(sizeof folder, folder) > 0)
        use_slashes(folder);
    return folder;
}

static void *map_file(int fd, size_t size, DWORD protection, DWORD access)
{
    HANDLE section = CreateFileMappingA(handle_of(fd), NULL, protection,
                                        (DWORD)((uint64_t)size >> 32), (DWORD)size, NULL);
    void *map = section ? MapViewOfFile(section, access, 0, 0, size) : NULL;
    if (section)
        CloseHandle(section); /* the view keeps it */
    return map;
}

void *os_map_new(int fd, size_t size)
{
    void *map = map_file(fd, size, PAGE_READWRITE, FILE_MAP_WRITE);
    if (map)
        memset(map, 0, size); /* touches all pages */
    return map;
}

void *os_map_read(int fd, size_t size)
{
    return map_file(fd, size, PAGE_READONLY, FILE_MAP_READ);
}

void os_unmap(void *map, size_t size)
{
    (void)size;
    UnmapViewOfFile(map);
}

/* ---- threads ---- */

void os_wait_word(const _Atomic uint32_t *word, uint32_t value, int64_t until_ns)
{
    const int64_t left_ns = until_ns == INT64_MAX ? 0 : until_ns - clock_now_ns();
    const int64_t left_ms = (left_ns + NS_PER_MS - 1) / NS_PER_MS;
    if (left_ns < 0)
        return;
    (void)WaitOnAddress((volatile void *)(uintptr_t)word, &value, sizeof value,
                        until_ns == INT64_MAX ? INFINITE
                                              : (DWORD)(left_ms < 60000 ? left_ms : 60000));
}

void os_wake_word(const _Atomic uint32_t *word)
{
    WakeByAddressAll((void *)(uintptr_t)word);
}

int os_start_thread(pthread_t *out, void *(*run)(void *data), void *data)
{
    return pthread_create(out, NULL, run, data);
}

long os_thread_id(void)
{
    return (long)GetCurrentThreadId();
}

/* pthread_cond_timedwait of mingw-w64 knows the time of day only. */
struct timespec os_condition_time(int64_t time_ns)
{
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    const int64_t left_ns = time_ns - clock_now_ns();
    const int64_t at_ns =
        (int64_t)now.tv_sec * NS_PER_S + now.tv_nsec + (left_ns > 0 ? left_ns : 0);
    return (struct timespec){.tv_sec = (time_t)(at_ns / NS_PER_S),
                             .tv_nsec = (long)(at_ns % NS_PER_S)};
}

void os_on_fork(void (*before)(void), void (*in_parent)(void), void (*in_child)(void))
{
    (void)before;
    (void)in_parent;
    (void)in_child;
}

/* ---- this program ---- */

bool os_program_path(char *out, size_t capacity)
{
    const DWORD length = GetModuleFileNameA(NULL, out, (DWORD)capacity);
    out[length < capacity ? length : 0] = '\0';
    use_slashes(out);
    return length > 0 && length < capacity;
}

void os_host_name(char *out, size_t capacity)
{
    DWORD size = (DWORD)capacity;
    if (!GetComputerNameA(out, &size))
        (void)snprintf(out, capacity, "this computer");
}

static void (*stop_now)(void);
static int exit_code_now;
static atomic_int stop_count;

static BOOL WINAPI on_event(DWORD event)
{
    (void)event;
    if (atomic_fetch_add(&stop_count, 1) > 0)
        _exit(exit_code_now);
    stop_now();
    return TRUE;
}

void os_on_stop(void (*stop)(void), int exit_code)
{
    stop_now = stop;
    exit_code_now = exit_code;
    SetConsoleCtrlHandler(on_event, TRUE);
}

static DWORD WINAPI end_later(void *data)
{
    Sleep((DWORD)(uintptr_t)data);
    _exit(exit_code_now);
}

void os_end_after(unsigned seconds)
{
    HANDLE thread = CreateThread(NULL, 0, end_later, (void *)((uintptr_t)seconds * 1000), 0, NULL);
    if (thread)
        CloseHandle(thread);
}
