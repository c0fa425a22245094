/* plugins/pedal: what the device reports arrives as it was, and when it was. */
#include "pedal_bench.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>

/* Debouncing would hold back what follows within the window: silence lets it end. */
static void expect_and_settle(pedal_bench *bench, float first, float second, float third)
{
    bench_expect(bench, first, second, third);
    bench_expect_silence(bench);
}

static void a_vec_pedal_is_found_without_an_address(void **state)
{
    pedal_bench bench;
    pedal_unit *unit = pedal_double_plug(*state, "1-2", 2, &VEC);
    bench_create(&bench);
    assert_int_equal(bench_open(&bench, ""), MRT_OK);
    uint32_t count;
    const mrt_channel *channels = bench.input->channels(bench.plugin, &count);
    assert_int_equal(count, 3);
    assert_string_equal(channels[0].name, "left");
    assert_int_equal(channels[0].semantic, MRT_CH_PEDAL);
    assert_int_equal(channels[2].semantic, MRT_CH_PEDAL + 2);
    assert_int_equal(channels[0].hand, MRT_NO_HAND);
    bench_expect(&bench, 0, 0, 0);
    REPORT(unit, 1, 0);
    expect_and_settle(&bench, 1, 0, 0);
    REPORT(unit, 0, 0);
    expect_and_settle(&bench, 0, 0, 0);
    bench_destroy(&bench);
}

static void combinations_are_told_apart(void **state)
{
    pedal_bench bench;
    pedal_unit *unit = pedal_double_plug(*state, "1-2", 2, &VEC);
    bench_create(&bench);
    assert_int_equal(bench_open(&bench, "usb:05f3:00ff"), MRT_OK);
    bench_expect(&bench, 0, 0, 0);
    for (uint8_t held = 1; held < 8; ++held) {
        REPORT(unit, held, 0);
        expect_and_settle(&bench, held & 1, held >> 1 & 1, held >> 2 & 1);
        REPORT(unit, 0, 0);
        expect_and_settle(&bench, 0, 0, 0);
    }
    bench_destroy(&bench);
}

static void a_keyboard_pedal_speaks_in_keys(void **state)
{
    pedal_bench bench;
    pedal_unit *unit = pedal_double_plug(*state, "1-2", 2, &PCSENSOR);
    bench_create(&bench);
    assert_int_equal(bench_open(&bench, "usb:1-2"), MRT_OK);
    bench_expect(&bench, 0, 0, 0);
    REPORT(unit, 1, 0, 0, 5, 0, 0, 0, 0);
    expect_and_settle(&bench, 0, 1, 0);
    REPORT(unit, 1, 0, 0, 0, 0, 0, 0, 0);
    expect_and_settle(&bench, 0, 0, 0);
    bench_destroy(&bench);
}

static void reports_of_no_bytes_and_of_other_kinds_say_nothing(void **state)
{
    pedal_bench bench;
    pedal_model narrow = VEC;
    narrow.packet_bytes = 2;
    pedal_unit *unit = pedal_double_plug(*state, "1-2", 2, &narrow);
    bench_create(&bench);
    assert_int_equal(bench_open(&bench, ""), MRT_OK);
    bench_expect(&bench, 0, 0, 0);
    REPORT(unit, 4, 0);
    pedal_unit_report(unit, NULL, 0);
    expect_and_settle(&bench, 0, 0, 1);
    pedal_unit_report(unit, NULL, 0);
    bench_expect_silence(&bench);
    bench_destroy(&bench);
}

/* However long the double takes to deliver them: edges are a window apart, and the last is right.
 */
static void edges_are_a_window_apart(void **state)
{
    pedal_bench bench;
    mrt_sample sample;
    int64_t last_edge_ns = 0;
    float shown = 0;
    pedal_unit *unit = pedal_double_plug(*state, "1-2", 2, &VEC);
    bench_create(&bench);
    bench.params[BENCH_DEBOUNCE] = 15;
    assert_int_equal(bench_open(&bench, ""), MRT_OK);
    bench_expect(&bench, 0, 0, 0);
    for (int i = 0; i < 10; ++i) {
        REPORT(unit, 1, 0);
        REPORT(unit, 0, 0);
    }
    REPORT(unit, 1, 0);
    uint32_t edges = 0;
    while (bench_read(&bench, 200 * BENCH_MS, &sample) == MRT_OK) {
        if (sample.value[0] == shown)
            continue;
        assert_true(edges == 0 || sample.time_ns - last_edge_ns >= 15 * BENCH_MS);
        shown = sample.value[0];
        last_edge_ns = sample.time_ns;
        edges += 1;
    }
    assert_float_equal(shown, 1, 0);
    printf("21 reports of chatter made %u edge(s)\n", edges);
    assert_in_range(edges, 1, 9);
    bench_destroy(&bench);
}

static int compare_times(const void *a, const void *b)
{
    int64_t left = *(const int64_t *)a, right = *(const int64_t *)b;
    return (left > right) - (left < right);
}

/* At 125 reports a second, as the pedal is polled: sample times against the moment at which the
 * double let the report go. */
static void samples_have_the_time_of_their_reports(void **state)
{
    enum { COUNT = 250 };
    static int64_t late_ns[COUNT];
    pedal_bench bench;
    mrt_sample sample;
    pedal_unit *unit = pedal_double_plug(*state, "1-2", 2, &VEC);
    bench_create(&bench);
    bench.params[BENCH_DEBOUNCE] = 5;
    assert_int_equal(bench_open(&bench, ""), MRT_OK);
    bench_expect(&bench, 0, 0, 0);
    int64_t due_ns = bench_now_ns();
    uint32_t sequence = 1;
    for (int i = 0; i < COUNT; ++i) {
        while (bench_read(&bench, due_ns - bench_now_ns(), &sample) == MRT_OK)
            sequence += 1; /* a repeated state */
        int64_t let_go_ns = bench_now_ns();
        REPORT(unit, i % 2 == 0, 0);
        assert_int_equal(bench_read(&bench, BENCH_PATIENCE, &sample), MRT_OK);
        assert_int_equal(sample.sequence, sequence++);
        assert_float_equal(sample.value[0], (float)(i % 2 == 0), 0);
        late_ns[i] =
            sample.time_ns - let_go_ns; /* bench_read: and none is of later than its read */
        due_ns = let_go_ns + 8 * BENCH_MS;
    }
    qsort(late_ns, COUNT, sizeof *late_ns, compare_times);
    printf("report to sample: median %.3f ms, 99 %% %.3f ms, of %d\n",
           (double)late_ns[COUNT / 2] / 1e6, (double)late_ns[COUNT * 99 / 100] / 1e6, COUNT);
    assert_true(late_ns[0] >= 0);
    bench_destroy(&bench);
}

static void a_state_that_lasts_is_repeated_each_second(void **state)
{
    pedal_bench bench;
    mrt_sample sample;
    pedal_unit *unit = bench_begin(&bench, *state);
    REPORT(unit, 2, 0);
    assert_int_equal(bench_read(&bench, BENCH_PATIENCE, &sample), MRT_OK);
    int64_t first_ns = sample.time_ns;
    assert_int_equal(bench_read(&bench, BENCH_PATIENCE, &sample), MRT_OK);
    assert_float_equal(sample.value[1], 1, 0);
    assert_true(sample.time_ns - first_ns >= 1000 * BENCH_MS);
    bench_destroy(&bench);
}

static void a_second_pedal_begins_where_the_first_ends(void **state)
{
    pedal_bench bench;
    pedal_double_plug(*state, "1-2", 2, &VEC);
    bench_create(&bench);
    bench.params[BENCH_FIRST] = 3;
    bench.params[BENCH_SWITCH_1] = 4;
    assert_int_equal(bench_open(&bench, ""), MRT_OK);
    uint32_t count;
    const mrt_channel *channels = bench.input->channels(bench.plugin, &count);
    assert_int_equal(channels[0].semantic, MRT_CH_PEDAL + 3);
    assert_int_equal(channels[1].semantic, MRT_CH_OTHER); /* 4 is taken */
    assert_int_equal(channels[2].semantic, MRT_CH_OTHER); /* 5 does not exist */
    assert_true(bench_has_said(&bench, "Set switch_2"));
    bench.params[BENCH_FIRST] = 1;
    bench_expect(&bench, 0, 0, 0);
    assert_int_equal(bench.restart_count, 1);
    bench_destroy(&bench);
}

static void an_idle_pedal_costs_nothing(void **state)
{
    pedal_bench bench;
    mrt_sample sample;
    pedal_unit *unit = bench_begin(&bench, *state);
    uint32_t asked = pedal_unit_state(unit).asked;
    int64_t from_ns = bench_now_ns(), cpu_ns = bench_cpu_ns();
    for (int i = 0; i < 20; ++i)
        (void)bench_read(&bench, 100 * BENCH_MS, &sample);
    double share = (double)(bench_cpu_ns() - cpu_ns) / (double)(bench_now_ns() - from_ns);
    printf("idle: %.3f %% of a core, %u requests in 2 s\n", share * 100,
           pedal_unit_state(unit).asked - asked);
    assert_true(share < 0.02);
    assert_true(pedal_unit_state(unit).asked - asked < 10);
    bench_destroy(&bench);
}

static const struct CMUnitTest tests[] = {
    TEST(a_vec_pedal_is_found_without_an_address),
    TEST(combinations_are_told_apart),
    TEST(a_keyboard_pedal_speaks_in_keys),
    TEST(reports_of_no_bytes_and_of_other_kinds_say_nothing),
    TEST(edges_are_a_window_apart),
    TEST(samples_have_the_time_of_their_reports),
    TEST(a_state_that_lasts_is_repeated_each_second),
    TEST(a_second_pedal_begins_where_the_first_ends),
    TEST(an_idle_pedal_costs_nothing),
};
BENCH_MAIN(tests)
