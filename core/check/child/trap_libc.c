/* The functions of libc that are caught (trap.h): each records its call and calls the function of
 * libc. */
#include "check/child/trap.h"

#include "base/program.h"

#include <marotte/plugin.h>

#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <netdb.h>
#include <poll.h>
#include <pthread.h>
#include <sched.h>
#include <semaphore.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/mman.h>
#include <sys/select.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* The headers of libc name their parameters __file and the like.
 * NOLINTBEGIN(readability-inconsistent-declaration-parameter-name,bugprone-macro-parentheses) */

/* RTLD_NEXT, which glibc defines only for GNU C: the libraries after this program. */
#define NEXT_LIBRARIES ((void *)-1L)

/* Stores libc's function of that name (or that of a sanitizer) in a function pointer. */
static void find_real(const char *name, void *out_function, size_t size)
{
    void *address = dlsym(NEXT_LIBRARIES, name);
    if (!address)
        abort(); /* not glibc: calls cannot be caught */
    memcpy(out_function, &address, size);
}

#define REAL(type, name, params)                                                                   \
    static type(*real) params;                                                                     \
    if (!real)                                                                                     \
    find_real(#name, &real, sizeof real)

#define CATCH(kind, type, name, params, arguments)                                                 \
    MRT_EXPORT type name params                                                                    \
    {                                                                                              \
        REAL(type, name, params);                                                                  \
        trap_note(kind, #name);                                                                    \
        return real arguments;                                                                     \
    }                                                                                              \
    extern type name params

/* A waiting function returns `instead` while it is caught. */
#define CATCH_WAIT(type, name, params, arguments, waits, instead)                                  \
    MRT_EXPORT type name params                                                                    \
    {                                                                                              \
        REAL(type, name, params);                                                                  \
        if (trap_catches(TRAP_SLEEP) && (waits)) {                                                 \
            trap_note(TRAP_SLEEP, #name);                                                          \
            return instead;                                                                        \
        }                                                                                          \
        return real arguments;                                                                     \
    }                                                                                              \
    extern type name params

/* ---- memory ---- */

#if PROGRAM_IS_SANITIZED
int __sanitizer_install_malloc_and_free_hooks(void (*on_malloc)(const volatile void *, size_t),
                                              void (*on_free)(const volatile void *));

static void on_malloc(const volatile void *memory, size_t size)
{
    (void)memory;
    (void)size;
    trap_note(TRAP_ALLOCATION, "malloc");
}

static void on_free(const volatile void *memory)
{
    if (memory)
        trap_note(TRAP_ALLOCATION, "free");
}

__attribute__((constructor)) static void hook_heap(void)
{
    (void)__sanitizer_install_malloc_and_free_hooks(on_malloc, on_free);
}
#else
void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *old, size_t size);
void *__libc_memalign(size_t alignment, size_t size);
void __libc_free(void *memory);

MRT_EXPORT void *malloc(size_t size)
{
    trap_note(TRAP_ALLOCATION, "malloc");
    return __libc_malloc(size);
}

MRT_EXPORT void *calloc(size_t count, size_t size)
{
    trap_note(TRAP_ALLOCATION, "calloc");
    return __libc_calloc(count, size);
}

MRT_EXPORT void *realloc(void *old, size_t size)
{
    trap_note(TRAP_ALLOCATION, "realloc");
    return __libc_realloc(old, size);
}

MRT_EXPORT void *aligned_alloc(size_t alignment, size_t size)
{
    trap_note(TRAP_ALLOCATION, "aligned_alloc");
    return __libc_memalign(alignment, size);
}

MRT_EXPORT int posix_memalign(void **out, size_t alignment, size_t size)
{
    trap_note(TRAP_ALLOCATION, "posix_memalign");
    *out = __libc_memalign(alignment, size);
    return *out ? 0 : ENOMEM;
}

MRT_EXPORT void free(void *memory)
{
    if (!memory)
        return;
    trap_note(TRAP_ALLOCATION, "free");
    __libc_free(memory);
}
#endif

CATCH(TRAP_ALLOCATION, void *, mmap,
      (void *at, size_t size, int protection, int flags, int file, off_t offset),
      (at, size, protection, flags, file, offset));
CATCH(TRAP_ALLOCATION, int, munmap, (void *at, size_t size), (at, size));

/* ---- locks ---- */

MRT_EXPORT int pthread_mutex_lock(pthread_mutex_t *mutex)
{
    REAL(int, pthread_mutex_lock, (pthread_mutex_t *));
    trap_note(TRAP_LOCK, "pthread_mutex_lock");
    if (!trap_catches(TRAP_LOCK))
        return real(mutex);
    (void)pthread_mutex_trylock(mutex); /* a deadlock would hide the findings */
    return 0;
}

CATCH(TRAP_LOCK, int, pthread_rwlock_rdlock, (pthread_rwlock_t * lock), (lock));
CATCH(TRAP_LOCK, int, pthread_rwlock_wrlock, (pthread_rwlock_t * lock), (lock));

/* ---- waiting ---- */

CATCH_WAIT(int, nanosleep, (const struct timespec *span, struct timespec *left), (span, left), true,
           0);
CATCH_WAIT(int, clock_nanosleep,
           (clockid_t clock, int flags, const struct timespec *span, struct timespec *left),
           (clock, flags, span, left), true, 0);
CATCH_WAIT(int, usleep, (useconds_t span), (span), true, 0);
CATCH_WAIT(unsigned, sleep, (unsigned span), (span), true, 0);
CATCH_WAIT(int, sched_yield, (void), (), true, 0);
CATCH_WAIT(int, poll, (struct pollfd * files, nfds_t count, int span), (files, count, span),
           span != 0, 0);
CATCH_WAIT(int, select,
           (int count, fd_set *restrict in, fd_set *restrict out, fd_set *restrict odd,
            struct timeval *restrict span),
           (count, in, out, odd, span), !span || span->tv_sec || span->tv_usec, 0);
CATCH_WAIT(int, epoll_wait, (int file, struct epoll_event *out, int count, int span),
           (file, out, count, span), span != 0, 0);
CATCH_WAIT(int, pthread_cond_wait,
           (pthread_cond_t *restrict condition, pthread_mutex_t *restrict mutex),
           (condition, mutex), true, 0);
CATCH_WAIT(int, pthread_cond_timedwait,
           (pthread_cond_t *restrict condition, pthread_mutex_t *restrict mutex,
            const struct timespec *restrict until),
           (condition, mutex, until), true, ETIMEDOUT);
CATCH_WAIT(int, sem_wait, (sem_t * semaphore), (semaphore), true, 0);
CATCH_WAIT(int, pthread_join, (pthread_t thread, void **out), (thread, out), true, EINVAL);
CATCH_WAIT(pid_t, waitpid, (pid_t process, int *out, int options), (process, out, options), true,
           -1);

/* ---- clocks ---- */

CATCH(TRAP_CLOCK, int, clock_gettime, (clockid_t clock, struct timespec *out), (clock, out));
CATCH(TRAP_CLOCK, int, gettimeofday, (struct timeval *restrict out, void *restrict zone),
      (out, zone));
CATCH(TRAP_CLOCK, time_t, time, (time_t * out), (out));

/* ---- files ---- */

static mode_t mode_of(int flags, va_list arguments)
{
    const int nameless = 020000000; /* the flag of O_TMPFILE itself */
    return flags & (O_CREAT | nameless) ? (mode_t)va_arg(arguments, int) : 0;
}

#define CATCH_OPEN(name, params, arguments)                                                        \
    MRT_EXPORT int name params                                                                     \
    {                                                                                              \
        REAL(int, name, params);                                                                   \
        va_list last;                                                                              \
        va_start(last, flags);                                                                     \
        mode_t mode = mode_of(flags, last);                                                        \
        va_end(last);                                                                              \
        trap_note(TRAP_FILE, #name);                                                               \
        return real arguments;                                                                     \
    }                                                                                              \
    extern int name params

/* Programs with large file support call these. */
int open64(const char *path, int flags, ...);
int openat64(int folder, const char *path, int flags, ...);
FILE *fopen64(const char *path, const char *mode);
CATCH_OPEN(open, (const char *path, int flags, ...), (path, flags, mode));
CATCH_OPEN(open64, (const char *path, int flags, ...), (path, flags, mode));
CATCH_OPEN(openat, (int folder, const char *path, int flags, ...), (folder, path, flags, mode));
CATCH_OPEN(openat64, (int folder, const char *path, int flags, ...), (folder, path, flags, mode));
CATCH(TRAP_FILE, FILE *, fopen, (const char *restrict path, const char *restrict mode),
      (path, mode));
CATCH(TRAP_FILE, FILE *, fopen64, (const char *path, const char *mode), (path, mode));
CATCH(TRAP_FILE, int, fclose, (FILE * stream), (stream));
CATCH(TRAP_FILE, int, fflush, (FILE * stream), (stream));
CATCH(TRAP_FILE, size_t, fread,
      (void *restrict out, size_t size, size_t count, FILE *restrict stream),
      (out, size, count, stream));
CATCH(TRAP_FILE, size_t, fwrite,
      (const void *restrict in, size_t size, size_t count, FILE *restrict stream),
      (in, size, count, stream));
CATCH(TRAP_FILE, char *, fgets, (char *restrict out, int size, FILE *restrict stream),
      (out, size, stream));
CATCH(TRAP_FILE, int, fputs, (const char *restrict text, FILE *restrict stream), (text, stream));
CATCH(TRAP_FILE, int, fputc, (int letter, FILE *stream), (letter, stream));
CATCH(TRAP_FILE, int, puts, (const char *text), (text));
CATCH(TRAP_FILE, int, putchar, (int letter), (letter));
CATCH(TRAP_FILE, ssize_t, read, (int file, void *out, size_t size), (file, out, size));
CATCH(TRAP_FILE, ssize_t, pread, (int file, void *out, size_t size, off_t at),
      (file, out, size, at));
CATCH(TRAP_FILE, ssize_t, write, (int file, const void *in, size_t size), (file, in, size));
CATCH(TRAP_FILE, int, close, (int file), (file));
CATCH(TRAP_FILE, int, fsync, (int file), (file));
CATCH(TRAP_FILE, int, access, (const char *path, int mode), (path, mode));
CATCH(TRAP_FILE, int, stat, (const char *restrict path, struct stat *restrict out), (path, out));
CATCH(TRAP_FILE, int, unlink, (const char *path), (path));
CATCH(TRAP_FILE, int, rename, (const char *from, const char *to), (from, to));
CATCH(TRAP_FILE, int, mkdir, (const char *path, mode_t mode), (path, mode));
CATCH(TRAP_FILE, DIR *, opendir, (const char *path), (path));

/* Calls of printf are compiled to these, or to puts and similar functions above. */
int __printf_chk(int flag, const char *format, ...);
int __fprintf_chk(FILE *stream, int flag, const char *format, ...);

#define CATCH_PRINT(name, first, last, stream)                                                     \
    MRT_EXPORT int name first                                                                      \
    {                                                                                              \
        va_list arguments;                                                                         \
        trap_note(TRAP_FILE, #name);                                                               \
        va_start(arguments, last);                                                                 \
        int length = vfprintf(stream, format, arguments);                                          \
        va_end(arguments);                                                                         \
        return length;                                                                             \
    }                                                                                              \
    extern int name first

__attribute__((format(printf, 1, 0)))
CATCH_PRINT(printf, (const char *restrict format, ...), format, stdout);

__attribute__((format(printf, 2, 0)))
CATCH_PRINT(fprintf, (FILE *restrict stream, const char *restrict format, ...), format, stream);

__attribute__((format(printf, 2, 0)))
CATCH_PRINT(__printf_chk, (int flag __attribute__((unused)), const char *format, ...), format,
            stdout);
__attribute__((format(printf, 3, 0)))
CATCH_PRINT(__fprintf_chk,
            (FILE * stream, int flag __attribute__((unused)), const char *format, ...), format,
            stream);

/* ---- the network ---- */

CATCH(TRAP_NETWORK, int, socket, (int domain, int type, int protocol), (domain, type, protocol));
CATCH(TRAP_NETWORK, int, connect, (int file, const struct sockaddr *to, socklen_t size),
      (file, to, size));
CATCH(TRAP_NETWORK, ssize_t, send, (int file, const void *in, size_t size, int flags),
      (file, in, size, flags));
CATCH(TRAP_NETWORK, ssize_t, sendto,
      (int file, const void *in, size_t size, int flags, const struct sockaddr *to,
       socklen_t to_size),
      (file, in, size, flags, to, to_size));
CATCH(TRAP_NETWORK, ssize_t, recv, (int file, void *out, size_t size, int flags),
      (file, out, size, flags));
CATCH(TRAP_NETWORK, ssize_t, recvfrom,
      (int file, void *restrict out, size_t size, int flags, struct sockaddr *restrict from,
       socklen_t *restrict from_size),
      (file, out, size, flags, from, from_size));
CATCH(TRAP_NETWORK, int, getaddrinfo,
      (const char *restrict node, const char *restrict service,
       const struct addrinfo *restrict hints, struct addrinfo **restrict out),
      (node, service, hints, out));

/* ---- processes, threads ---- */

CATCH(TRAP_PROCESS, pid_t, fork, (void), ());
CATCH(TRAP_PROCESS, int, execve, (const char *path, char *const *words, char *const *environment),
      (path, words, environment));
CATCH(TRAP_PROCESS, int, system, (const char *line), (line));
CATCH(TRAP_PROCESS, FILE *, popen, (const char *line, const char *mode), (line, mode));
CATCH(TRAP_PROCESS, int, pthread_create,
      (pthread_t *restrict out, const pthread_attr_t *restrict attributes, void *(*run)(void *),
       void *restrict data),
      (out, attributes, run, data));

/* NOLINTEND(readability-inconsistent-declaration-parameter-name,bugprone-macro-parentheses) */
