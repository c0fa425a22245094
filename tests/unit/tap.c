/* stage/input/tap.h: every sample of one input, for somebody who may be slower than it. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "stage/input/tap.h"

#include <pthread.h>
#include <stdatomic.h>

static mrt_sample numbered(uint32_t sequence)
{
    return (mrt_sample){.time_ns = 1000 * (int64_t)sequence, .sequence = sequence, .count = 1};
}

static void offer(tap *self, uint32_t input, uint32_t sequence)
{
    const mrt_sample sample = numbered(sequence);
    tap_push(self, input, &sample);
}

static void only_the_input_that_is_wanted_is_heard_in_order(void **state)
{
    (void)state;
    mrt_sample out;
    tap *self = tap_create();
    offer(self, 0, 1); /* nobody listens yet */
    tap_select(self, 1);
    offer(self, 0, 2);
    offer(self, 1, 3);
    offer(self, 1, 4);
    assert_true(tap_pop(self, &out));
    assert_int_equal(out.sequence, 3);
    assert_true(tap_pop(self, &out));
    assert_int_equal(out.sequence, 4);
    assert_false(tap_pop(self, &out));
    tap_select(self, UINT32_MAX);
    offer(self, 1, 5);
    offer(self, UINT32_MAX, 6);
    assert_false(tap_pop(self, &out));
    tap_destroy(self);
}

static void what_was_kept_of_another_is_not_given(void **state)
{
    (void)state;
    mrt_sample out;
    tap *self = tap_create();
    tap_select(self, 0);
    offer(self, 0, 1);
    tap_select(self, 1);
    tap_select(self, 0); /* begins anew */
    assert_false(tap_pop(self, &out));
    offer(self, 0, 2);
    assert_true(tap_pop(self, &out));
    assert_int_equal(out.sequence, 2);
    tap_destroy(self);
}

static void a_full_tap_leaves_the_newest_out_and_goes_on(void **state)
{
    (void)state;
    mrt_sample out;
    tap *self = tap_create();
    tap_select(self, 0);
    for (uint32_t i = 0; i < TAP_SAMPLES + 100; ++i)
        offer(self, 0, i);
    for (uint32_t i = 0; i < TAP_SAMPLES; ++i) {
        assert_true(tap_pop(self, &out));
        assert_int_equal(out.sequence, i);
    }
    assert_false(tap_pop(self, &out));
    offer(self, 0, 9999);
    assert_true(tap_pop(self, &out));
    assert_int_equal(out.sequence, 9999);
    tap_destroy(self);
}

typedef struct giver {
    tap *tap;
    _Atomic bool is_done;
} giver;

static void *give(void *data)
{
    giver *self = data;
    for (uint32_t i = 1; i <= 20000; ++i)
        offer(self->tap, i % 3, i);
    atomic_store(&self->is_done, true);
    return NULL;
}

static void another_thread_offers_while_it_is_changed(void **state)
{
    (void)state;
    giver giving = {.tap = tap_create()};
    pthread_t thread;
    mrt_sample out;
    uint32_t wanted = 0, last = 0;
    tap_select(giving.tap, 0);
    assert_int_equal(pthread_create(&thread, NULL, give, &giving), 0);
    for (uint32_t i = 0; !atomic_load(&giving.is_done); ++i) {
        if (i % 50 == 0) {
            wanted = (wanted + 1) % 3;
            tap_select(giving.tap, wanted);
        }
        while (tap_pop(giving.tap, &out)) {
            assert_int_equal(out.sequence % 3, wanted);
            assert_true(out.sequence > last);
            last = out.sequence;
        }
    }
    pthread_join(thread, NULL);
    tap_destroy(giving.tap);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(only_the_input_that_is_wanted_is_heard_in_order),
        cmocka_unit_test(what_was_kept_of_another_is_not_given),
        cmocka_unit_test(a_full_tap_leaves_the_newest_out_and_goes_on),
        cmocka_unit_test(another_thread_offers_while_it_is_changed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
