/* base/condition.h - condition variables whose waits end by the clock of base/clock.h. Any thread
 * but the frame thread. */
#ifndef MAROTTE_BASE_CONDITION_H
#define MAROTTE_BASE_CONDITION_H
#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>

/* Ended with pthread_cond_destroy. */
void condition_init(pthread_cond_t *out);

/* With the mutex locked. False: it is until_ns; true: signalled, or woken for no reason. */
bool condition_wait(pthread_cond_t *condition, pthread_mutex_t *mutex, int64_t until_ns);

#endif
