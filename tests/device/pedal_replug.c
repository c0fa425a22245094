/* plugins/pedal: a pedal that is pulled out is let go of first, and is found again in its socket.
 */
#include "pedal_bench.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include <errno.h>
#include <stdio.h>
#include <string.h>

static void expect_loss(pedal_bench *bench)
{
    mrt_sample sample;
    assert_int_equal(bench_read(bench, 2000 * BENCH_MS, &sample), MRT_ERR_IO);
    assert_true(bench_has_said(bench, "was disconnected"));
    assert_true(bench_has_said(bench, "plug it in again"));
}

static void expect_current(pedal_bench *bench, const char *address)
{
    mrt_device device;
    assert_true(bench->devices->current(bench->plugin, &device));
    assert_string_equal(device.address, address);
}

static void a_held_pedal_is_released_before_its_loss_is_told(void **state)
{
    static const int errors[] = {EPROTO, ESHUTDOWN, EILSEQ, EPIPE};
    pedal_bench bench;
    mrt_sample sample;
    bench_create(&bench);
    for (uint32_t i = 0; i < sizeof errors / sizeof *errors; ++i) {
        pedal_unit *unit = pedal_double_plug(*state, "1-2", 2 + i, &VEC);
        bench_reopen(&bench, "");
        bench_expect(&bench, 0, 0, 0);
        REPORT(unit, 5, 0);
        bench_expect(&bench, 1, 0, 1);
        bench_forget(&bench);
        pedal_unit_unplug(unit, errors[i]);
        assert_int_equal(bench_read(&bench, BENCH_PATIENCE, &sample), MRT_OK);
        for (int k = 0; k < 3; ++k)
            assert_float_equal(sample.value[k], 0, 0);
        expect_loss(&bench);
        mrt_device none;
        assert_false(bench.devices->current(bench.plugin, &none));
        assert_int_equal(bench_read(&bench, 0, &sample), MRT_ERR_IO);
        bench_close(&bench);
    }
    bench_destroy(&bench);
}

/* Reports that came before the end are not lost with the device. */
static void what_was_reported_before_the_loss_comes_before_it(void **state)
{
    pedal_bench bench;
    pedal_unit *unit = bench_begin(&bench, *state);
    REPORT(unit, 2, 0);
    bench_expect(&bench, 0, 1, 0);
    pedal_unit_fail(unit, EPROTO); /* the cable, not the news */
    bench_expect(&bench, 0, 0, 0);
    expect_loss(&bench);
    bench_destroy(&bench);
}

static void the_news_of_leaving_alone_is_a_loss(void **state)
{
    pedal_bench bench;
    pedal_unit *unit = bench_begin(&bench, *state);
    pedal_unit_unplug(unit, ESHUTDOWN);
    bench_expect(&bench, 0, 0, 0);
    expect_loss(&bench);
    bench_destroy(&bench);
}

static void a_pedal_comes_back_under_another_number(void **state)
{
    pedal_bench bench;
    mrt_sample sample;
    bench_create(&bench);
    pedal_double_plug_hub(*state, "1-4", 9);
    pedal_unit *unit = pedal_double_plug(*state, "1-4.3", 10, &VEC);
    assert_int_equal(bench_open(&bench, ""), MRT_OK);
    expect_current(&bench, "usb:1-4.3");
    bench_expect(&bench, 0, 0, 0);
    pedal_unit_unplug(unit, EPROTO);
    bench_expect(&bench, 0, 0, 0);
    expect_loss(&bench);
    unit = pedal_double_plug(*state, "1-4.3", 77, &VEC);
    bench_reopen(&bench, "");
    expect_current(&bench, "usb:1-4.3");
    assert_int_equal(bench_read(&bench, BENCH_PATIENCE, &sample), MRT_OK);
    REPORT(unit, 4, 0);
    bench_expect(&bench, 0, 0, 1);
    bench_destroy(&bench);
}

/* Two of the same maker without serial numbers: only their sockets tell them apart. */
static void twins_keep_their_places_in_whatever_order_they_return(void **state)
{
    pedal_bench first, second;
    pedal_unit *left = pedal_double_plug(*state, "1-2", 2, &VEC);
    pedal_unit *right = pedal_double_plug(*state, "1-10", 3, &VEC);
    bench_create(&first);
    bench_create(&second);
    assert_int_equal(bench_open(&first, ""), MRT_OK);
    assert_int_equal(bench_open(&second, ""), MRT_OK);
    expect_current(&first, "usb:1-2");
    expect_current(&second, "usb:1-10"); /* the first is taken */
    bench_expect(&first, 0, 0, 0);
    bench_expect(&second, 0, 0, 0);
    pedal_unit_unplug(left, EPROTO);
    pedal_unit_unplug(right, EPROTO);
    bench_expect(&first, 0, 0, 0);
    bench_expect(&second, 0, 0, 0);
    expect_loss(&first);
    expect_loss(&second);
    right = pedal_double_plug(*state, "1-10", 4, &VEC);
    bench_close(&first);
    bench_forget(&first);
    assert_int_equal(bench_open(&first, ""), MRT_ERR_IO); /* it does not take its twin */
    assert_true(bench_has_said(&first, "usb:1-2: plug it in there again"));
    bench_reopen(&second, "");
    left = pedal_double_plug(*state, "1-2", 5, &VEC);
    bench_reopen(&first, "");
    expect_current(&first, "usb:1-2");
    expect_current(&second, "usb:1-10");
    bench_expect(&first, 0, 0, 0);
    bench_expect(&second, 0, 0, 0);
    REPORT(left, 1, 0);
    bench_expect(&first, 1, 0, 0);
    REPORT(right, 2, 0);
    bench_expect(&second, 0, 1, 0);
    bench_destroy(&first);
    bench_destroy(&second);
}

static void another_device_in_the_socket_is_not_taken_for_it(void **state)
{
    pedal_bench bench;
    pedal_unit *unit = pedal_double_plug(*state, "1-2", 2, &VEC);
    bench_create(&bench);
    assert_int_equal(bench_open(&bench, "usb:1-2"), MRT_OK);
    bench_expect(&bench, 0, 0, 0);
    pedal_unit_unplug(unit, EPROTO);
    bench_expect(&bench, 0, 0, 0);
    expect_loss(&bench);
    unit = pedal_double_plug(*state, "1-2", 3, &PCSENSOR);
    pedal_bench other; /* which shows that the system has seen it */
    bench_create(&other);
    bench_reopen(&other, "");
    bench_close(&other);
    bench_destroy(&other);
    bench_close(&bench);
    assert_int_equal(bench_open(&bench, "usb:1-2"), MRT_ERR_IO);
    assert_true(pedal_unit_state(unit).has_kernel_driver);
    bench_destroy(&bench);
}

static void a_hundred_times_out_and_in_leaves_nothing_behind(void **state)
{
    pedal_bench bench;
    uint32_t files = 0;
    int64_t longest_ns = 0;
    bench_create(&bench);
    for (uint32_t i = 0; i < 100; ++i) {
        pedal_unit *unit = pedal_double_plug(*state, "1-2", 2 + i, &VEC);
        int64_t back_ns = bench_now_ns();
        bench_reopen(&bench, "");
        if (bench_now_ns() - back_ns > longest_ns)
            longest_ns = bench_now_ns() - back_ns;
        bench_expect(&bench, 0, 0, 0);
        REPORT(unit, 7, 0);
        bench_expect(&bench, 1, 1, 1);
        if (i % 2 == 0)
            pedal_unit_unplug(unit, i % 4 == 0 ? EPROTO : ESHUTDOWN);
        else
            pedal_unit_die(unit, EPROTO); /* gone before the news of it */
        bench_expect(&bench, 0, 0, 0);
        expect_loss(&bench);
        bench_close(&bench);
        assert_int_equal(pedal_unit_state(unit).flying, 0);
        if (i % 2 != 0)
            pedal_unit_unplug(unit, EPROTO);
        if (i == 9)
            files = bench_open_files();
    }
    printf("back after %.1f ms at the latest, %u files open before, %u after\n",
           (double)longest_ns / 1e6, files, bench_open_files());
    assert_true(bench_has_open_files(files + 2));
    bench_destroy(&bench);
}

static const struct CMUnitTest tests[] = {
    TEST(a_held_pedal_is_released_before_its_loss_is_told),
    TEST(what_was_reported_before_the_loss_comes_before_it),
    TEST(the_news_of_leaving_alone_is_a_loss),
    TEST(a_pedal_comes_back_under_another_number),
    TEST(twins_keep_their_places_in_whatever_order_they_return),
    TEST(another_device_in_the_socket_is_not_taken_for_it),
    TEST(a_hundred_times_out_and_in_leaves_nothing_behind),
};
BENCH_MAIN(tests)
