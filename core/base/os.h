/* base/os.h - what the other parts of base, csrbf, hand, mesh, face and show need from the
 * operating system beyond C and POSIX threads. Each function exists once for each system:
 * os_linux.c, os_windows.c. Files are descriptors, for read, close and fdopen. Processes, serial
 * ports and libraries of plugins are not here: their rooms exist for Linux only. [any] */
#ifndef MAROTTE_BASE_OS_H
#define MAROTTE_BASE_OS_H
#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <time.h>

/* ---- files: -1 or false, and errno, on failure ---- */

typedef enum os_open_mode {
    OS_READ = 0,
    OS_READ_NO_LINK,   /* not through a link */
    OS_EDIT,           /* reads and writes an existing file, not through a link */
    OS_EDIT_OR_CREATE, /* the same; creates an absent file */
    OS_CREATE,         /* reads and writes a new file; an existing one is an error */
    OS_CREATE_PRIVATE, /* the same; only the user may read it */
    OS_FOLDER          /* a folder, for os_lock */
} os_open_mode;
/* Never waits for the other end of a pipe. Other programs do not inherit the descriptor. The file
 * can be renamed and removed while it is open. */
int os_open(const char *path, os_open_mode mode);

typedef enum os_lock_state {
    OS_LOCK_HELD = 0,
    OS_LOCK_OTHERS, /* another program or descriptor holds it */
    OS_LOCK_REFUSED /* errno: the reason */
} os_lock_state;
/* Locks the whole file against others that call this, until close or the end of the process. Never
 * waits. */
os_lock_state os_lock(int fd);

ssize_t os_read_at(int fd, void *out, size_t size, int64_t at);
ssize_t os_write_at(int fd, const void *bytes, size_t size, int64_t at);
/* Finds the next bytes at or after `from` that are not a hole of a sparse file. */
bool os_next_data(int fd, uint64_t from, uint64_t *out_begin, uint64_t *out_end);
uint64_t os_stored_bytes(const struct stat *status);  /* on the disk; 0: unknown */
int os_sync(int fd);                                  /* to the disk: data and size */
int os_duplicate(int fd);                             /* keeps the lock; not inherited */
int os_rename(const char *from, const char *to);      /* replaces an existing file */
int os_stat_link(const char *path, struct stat *out); /* of the link itself */
uint64_t os_user(void); /* a number of the user; 0 where files of others are elsewhere */
bool os_is_mine(const struct stat *status);    /* the user owns it */
bool os_is_private(const struct stat *status); /* the user owns it, and others have no access */

/* Identifies a file while it exists, whatever its names are. */
typedef struct os_file_id {
    uint64_t device, number;
} os_file_id;
bool os_id_of_path(const char *path, os_file_id *out); /* follows links */

bool os_is_at(int fd, const char *path); /* the open file has this path, and it is no link */

int os_make_folder(const char *path);
int os_make_new_folder(char *path);   /* replaces the XXXXXX at its end; only the user may enter */
char *os_real_path(const char *path); /* absolute, without links, with '/'; the caller frees it */

/* ---- memory ---- */

void *os_aligned_alloc(size_t alignment, size_t size); /* free it with os_aligned_free */
void os_aligned_free(void *memory);
void os_use_large_pages(void *memory, size_t size); /* if possible */
uint64_t os_resident_bytes(void);                   /* of this process; 0: unknown */

/* A folder whose files are in memory, if possible, with its final '/'. Valid until the end. */
const char *os_memory_folder(void);
void *os_map_new(
    int fd,
    size_t size); /* shared; sets the size of the file, and allocates all of it. NULL: failed */
void *os_map_read(int fd, size_t size); /* private */
void os_unmap(void *map, size_t size);

/* ---- threads ---- */

/* Sleeps while *word == value, at most until this time of base/clock.h (INT64_MAX: no limit). May
 * return early. */
void os_wait_word(const _Atomic uint32_t *word, uint32_t value, int64_t until_ns);
void os_wake_word(const _Atomic uint32_t *word); /* all threads of this process that wait for it */
/* Starts a thread that receives no signals. Returns 0, or an errno value. */
int os_start_thread(pthread_t *out, void *(*run)(void *data), void *data);
long os_thread_id(void);
/* The time that pthread_cond_timedwait expects for a time of base/clock.h. */
struct timespec os_condition_time(int64_t time_ns);
/* Registers functions that run when this process is copied. Does nothing where that is impossible.
 */
void os_on_fork(void (*before)(void), void (*in_parent)(void), void (*in_child)(void));

/* ---- this program ---- */

bool os_program_path(char *out, size_t capacity); /* of the running program, with '/' */
void os_host_name(char *out, size_t capacity);    /* "this computer" if it is unknown */
/* Calls `stop` at the first Ctrl-C, or when the system asks the program to end. The second one ends
 * the program with exit_code. `stop` may only set atomics and call os_end_after. */
void os_on_stop(void (*stop)(void), int exit_code);
void os_end_after(unsigned seconds); /* ends the program with the exit_code of os_on_stop */

#endif
