/* Loaded before the program (LD_PRELOAD): every few times that a thread of Mesa's software renderer
 * signals, it is held up for a moment, with what it signals still locked; what is freed meanwhile
 * although somebody is in it is counted. At the end: "held up N, freed while locked M". */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { EVERY = 7, HOLD_US = 1000, THREADS = 16, OBJECT_SIZE_MAX = 96 };

typedef int signal_function(pthread_cond_t *);
typedef void free_function(void *);

static signal_function *next_signal, *next_broadcast;
static free_function *next_free;
static _Atomic(uintptr_t) held[THREADS]; /* the conditions that are being signalled; 0: none */
static _Atomic uint32_t signals, held_up, freed_while_locked;

static void *next(const char *name)
{
    return dlsym(RTLD_NEXT, name);
}

__attribute__((constructor)) static void begin(void)
{
    void *found[] = {next("pthread_cond_signal"), next("pthread_cond_broadcast"), next("free")};
    memcpy(&next_signal, &found[0], sizeof next_signal);
    memcpy(&next_broadcast, &found[1], sizeof next_broadcast);
    memcpy(&next_free, &found[2], sizeof next_free);
}

__attribute__((destructor)) static void end(void)
{
    fprintf(stderr, "held up %u, freed while locked %u\n", held_up, freed_while_locked);
}

static int is_renderer(void)
{
    char name[16] = "";
    pthread_getname_np(pthread_self(), name, sizeof name);
    return strncmp(name, "llvmpipe", 8) == 0;
}

static void hold_up(const pthread_cond_t *condition)
{
    if (!is_renderer() || atomic_fetch_add(&signals, 1) % EVERY != 0)
        return;
    for (uint32_t i = 0; i < THREADS; ++i) {
        uintptr_t none = 0;
        if (!atomic_compare_exchange_strong(&held[i], &none, (uintptr_t)condition))
            continue;
        atomic_fetch_add(&held_up, 1);
        nanosleep(&(struct timespec){.tv_nsec = HOLD_US * 1000L}, NULL);
        atomic_store(&held[i], 0);
        return;
    }
}

int pthread_cond_signal(pthread_cond_t *condition)
{
    const int result = next_signal(condition);
    hold_up(condition);
    return result;
}

int pthread_cond_broadcast(pthread_cond_t *condition)
{
    const int result = next_broadcast(condition);
    hold_up(condition);
    return result;
}

void free(void *object)
{
    for (uint32_t i = 0; object && i < THREADS; ++i) {
        const uintptr_t condition = atomic_load(&held[i]), at = (uintptr_t)object;
        if (condition >= at && condition - at < OBJECT_SIZE_MAX)
            atomic_fetch_add(&freed_while_locked, 1);
    }
    if (next_free)
        next_free(object);
}
