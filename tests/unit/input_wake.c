/* core/stage/wake: no signal is lost, whenever it comes; waits end at their time; signal handlers
 * may signal. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/clock.h"
#include "base/ring.h"
#include "stage/input/wake.h"

#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>

/* A signal that is lost costs a whole wait: the tests allow less than one. */
static const int64_t long_wait_ns = 60 * NS_PER_S;

enum { PRODUCERS = 3, RECORDS = 5000 };

typedef struct producer {
    pthread_t thread;
    ring *records;
    wake *signal;
} producer;

static void *produce(void *data)
{
    producer *self = data;
    for (uint32_t i = 0; i < RECORDS;) {
        if (ring_push(self->records, &i)) {
            wake_signal(self->signal);
            i += 1;
        } else {
            sched_yield();
        }
    }
    return NULL;
}

static void no_signal_of_many_threads_is_lost(void **state)
{
    (void)state;
    wake signal;
    producer all[PRODUCERS];
    uint32_t next[PRODUCERS] = {0};
    uint32_t taken = 0;
    wake_init(&signal);
    int64_t before_ns = clock_now_ns();
    for (int i = 0; i < PRODUCERS; ++i) {
        all[i] = (producer){.records = ring_create(sizeof(uint32_t), 64), .signal = &signal};
        assert_int_equal(pthread_create(&all[i].thread, NULL, produce, &all[i]), 0);
    }
    while (taken < PRODUCERS * RECORDS) {
        uint32_t seen = wake_seen(&signal), value;
        bool any = false;
        for (int i = 0; i < PRODUCERS; ++i)
            while (ring_pop(all[i].records, &value)) {
                assert_int_equal(value, next[i]++);
                taken += 1;
                any = true;
            }
        if (!any)
            wake_wait_until_ns(&signal, seen, clock_now_ns() + long_wait_ns);
    }
    int64_t took_ns = clock_now_ns() - before_ns;
    for (int i = 0; i < PRODUCERS; ++i) {
        pthread_join(all[i].thread, NULL);
        ring_destroy(all[i].records);
    }
    assert_true(took_ns < long_wait_ns);
}

/* Strictly in turns: every record is waited for, and every wait ends by its signal alone. */
typedef struct table_tennis {
    wake here, there;
    _Atomic uint32_t ball;
} table_tennis;

enum { STROKES = 4000 };

static void *play_back(void *data)
{
    table_tennis *self = data;
    for (uint32_t i = 0; i < STROKES;) {
        uint32_t seen = wake_seen(&self->there);
        if (atomic_load(&self->ball) != 2 * i + 1) {
            wake_wait_until_ns(&self->there, seen, clock_now_ns() + long_wait_ns);
            continue;
        }
        atomic_store(&self->ball, 2 * i + 2);
        wake_signal(&self->here);
        i += 1;
    }
    return NULL;
}

static void two_threads_take_turns_without_a_time_out(void **state)
{
    (void)state;
    static table_tennis game;
    pthread_t other;
    wake_init(&game.here);
    wake_init(&game.there);
    int64_t before_ns = clock_now_ns();
    assert_int_equal(pthread_create(&other, NULL, play_back, &game), 0);
    for (uint32_t i = 0; i < STROKES; ++i) {
        atomic_store(&game.ball, 2 * i + 1);
        wake_signal(&game.there);
        for (;;) {
            uint32_t seen = wake_seen(&game.here);
            if (atomic_load(&game.ball) == 2 * i + 2)
                break;
            wake_wait_until_ns(&game.here, seen, clock_now_ns() + long_wait_ns);
        }
    }
    pthread_join(other, NULL);
    int64_t took_ns = clock_now_ns() - before_ns;
    print_message("%.1f us there and back\n", (double)took_ns / 1e3 / STROKES);
    assert_true(took_ns < long_wait_ns);
}

static void a_wait_ends_at_its_time_and_a_signal_that_came_before_ends_it_at_once(void **state)
{
    (void)state;
    wake signal;
    wake_init(&signal);
    int64_t before_ns = clock_now_ns();
    wake_wait_until_ns(&signal, wake_seen(&signal), before_ns + 20 * NS_PER_MS);
    assert_true(clock_now_ns() - before_ns >= 20 * NS_PER_MS);
    uint32_t seen = wake_seen(&signal);
    wake_signal(&signal);
    before_ns = clock_now_ns();
    wake_wait_until_ns(&signal, seen, before_ns + long_wait_ns);
    wake_wait_until_ns(&signal, wake_seen(&signal), 0); /* long past */
    wake_wait_until_ns(&signal, wake_seen(&signal), INT64_MIN);
    assert_true(clock_now_ns() - before_ns < long_wait_ns);
}

static wake of_handler;

static void on_alarm(int number)
{
    (void)number;
    wake_signal(&of_handler);
}

static void a_signal_handler_ends_the_wait(void **state)
{
    (void)state;
    wake_init(&of_handler);
    struct sigaction action = {.sa_handler = on_alarm};
    sigemptyset(&action.sa_mask);
    sigaction(SIGUSR1, &action, NULL);
    uint32_t seen = wake_seen(&of_handler);
    int64_t before_ns = clock_now_ns();
    raise(SIGUSR1);
    wake_wait_until_ns(&of_handler, seen, before_ns + long_wait_ns);
    assert_true(clock_now_ns() - before_ns < long_wait_ns);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_signal_of_many_threads_is_lost),
        cmocka_unit_test(two_threads_take_turns_without_a_time_out),
        cmocka_unit_test(a_wait_ends_at_its_time_and_a_signal_that_came_before_ends_it_at_once),
        cmocka_unit_test(a_signal_handler_ends_the_wait),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
