/* clock_map of devices/device_io.h: bunched and late arrivals do not show in the times of samples.
 */
#include "device_io.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>

static const int64_t period_ns = 6666667; /* 150 Hz */
static const int64_t ms_ns = 1000000;

/* Arrivals at the next multiple of 16 ms, as a USB serial adapter gives them. */
static int64_t bunched(int64_t time_ns)
{
    int64_t latency_ns = 16 * ms_ns;
    return (time_ns / latency_ns + 1) * latency_ns;
}

static void bunched_arrivals_keep_the_devices_own_rhythm(void **state)
{
    (void)state;
    clock_map map;
    clock_map_reset(&map);
    double sum = 0, squares = 0;
    int count = 0;
    for (int64_t i = 0; i < 9000; ++i) {
        int64_t true_ns = 5 * ms_ns + i * period_ns;
        int64_t host_ns = clock_map_to_host(&map, 77 * ms_ns + i * period_ns, bunched(true_ns));
        if (i < 300)
            continue; /* the first two seconds find the offset */
        double error_ms = (double)(host_ns - true_ns) / 1e6;
        sum += error_ms;
        squares += error_ms * error_ms;
        ++count;
    }
    double mean = sum / count;
    assert_true(sqrt(fmax(squares / count - mean * mean, 0)) < 0.5);
    assert_true(mean >= 0 && mean < 1.0);
}

static void clocks_that_drift_apart_are_followed(void **state)
{
    (void)state;
    static const double ppm[] = {-100, 100};
    for (int k = 0; k < 2; ++k) {
        clock_map map;
        clock_map_reset(&map);
        for (int64_t i = 0; i < 90000; ++i) { /* ten minutes */
            int64_t true_ns = i * period_ns;
            int64_t device_ns = (int64_t)((double)true_ns * (1.0 + ppm[k] * 1e-6));
            int64_t host_ns = clock_map_to_host(&map, device_ns, bunched(true_ns));
            if (i > 3000)
                assert_true(host_ns - true_ns > -2 * ms_ns && host_ns - true_ns < 3 * ms_ns);
        }
    }
}

static void times_never_run_backwards_or_ahead(void **state)
{
    (void)state;
    clock_map map;
    clock_map_reset(&map);
    uint32_t seed = 1;
    int64_t last_ns = 0;
    for (int64_t i = 0; i < 5000; ++i) {
        seed = seed * 1664525u + 1013904223u;
        int64_t late_ns = (int64_t)(seed >> 8) % (40 * ms_ns);
        int64_t arrival_ns = i * period_ns + late_ns;
        int64_t host_ns = clock_map_to_host(&map, i * period_ns, arrival_ns);
        assert_true(host_ns <= arrival_ns || host_ns == last_ns);
        assert_true(host_ns >= last_ns);
        last_ns = host_ns;
    }
}

static void a_device_clock_that_starts_again_is_taken_as_it_is(void **state)
{
    (void)state;
    clock_map map;
    clock_map_reset(&map);
    for (int64_t i = 0; i < 100; ++i)
        clock_map_to_host(&map, 1000 * ms_ns * 1000 + i * period_ns, i * period_ns);
    int64_t host_ns = clock_map_to_host(&map, 0, 5000 * ms_ns);
    assert_int_equal(host_ns, 5000 * ms_ns);
}

/* A program that is not ours says the time (OpenXR runtimes): the sanitizers see the sums. */
static void times_that_no_clock_has_are_mapped_to_the_arrival(void **state)
{
    (void)state;
    static const int64_t odd_ns[] = {INT64_MAX, INT64_MIN,     0, INT64_MIN,    INT64_MAX,
                                     -1,        INT64_MAX - 1, 1, INT64_MIN + 1};
    const int64_t start_ns = 1000 * 1000 * ms_ns;
    clock_map map;
    clock_map_reset(&map);
    for (int64_t i = 0; i < 90; ++i) {
        const int64_t arrival_ns = start_ns + i * period_ns;
        assert_int_equal(clock_map_to_host(&map, odd_ns[i % 9], arrival_ns), arrival_ns);
    }
    for (int64_t i = 90; i < 200; ++i) { /* and the clock comes to its senses */
        const int64_t arrival_ns = start_ns + i * period_ns;
        assert_int_equal(clock_map_to_host(&map, i * period_ns, arrival_ns), arrival_ns);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bunched_arrivals_keep_the_devices_own_rhythm),
        cmocka_unit_test(clocks_that_drift_apart_are_followed),
        cmocka_unit_test(times_never_run_backwards_or_ahead),
        cmocka_unit_test(a_device_clock_that_starts_again_is_taken_as_it_is),
        cmocka_unit_test(times_that_no_clock_has_are_mapped_to_the_arrival),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
