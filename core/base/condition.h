/* base/condition.h - condition variables with timeouts on the clock of base/clock.h. [any thread
 * but the frame thread] */
#ifndef MAROTTE_BASE_CONDITION_H
#define MAROTTE_BASE_CONDITION_H
#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>

/* End it with pthread_cond_destroy. */
void condition_init(pthread_cond_t *out);

/* Call it with the mutex locked. Returns false after until_ns; true if it was signalled, or for a
 * spurious wake-up. */
bool condition_wait(pthread_cond_t *condition, pthread_mutex_t *mutex, int64_t until_ns);

#endif
