/* plugins/pedal: whatever a device, its rights or another program do, opening and reading end in
 * bounded time, with a sentence that says what to do. */
#include "pedal_bench.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/types.h>
#include <unistd.h>

static void open_fails(pedal_bench *bench, const char *address, mrt_result expected,
                       const char *part)
{
    bench_forget(bench);
    int64_t from_ns = bench_now_ns(), cpu_ns = bench_cpu_ns();
    assert_int_equal(bench_open(bench, address), expected);
    assert_true(bench_now_ns() - from_ns < BENCH_PATIENCE);
    assert_true(bench_cpu_ns() - cpu_ns < 200 * BENCH_MS);
    if (!bench_has_said(bench, part))
        fail_msg("expected \"%s\" in: %s", part, bench->text[0]);
    assert_int_equal(bench->level[0], MRT_LOG_ERROR);
    assert_null(strchr(bench->text[0], '\n'));
}

static void the_kernels_driver_is_detached_and_given_back(void **state)
{
    pedal_bench bench;
    pedal_unit *unit = pedal_double_plug(*state, "1-2", 2, &VEC);
    bench_create(&bench);
    assert_true(pedal_unit_state(unit).has_kernel_driver);
    for (int i = 0; i < 3; ++i) {
        assert_int_equal(bench_open(&bench, ""), MRT_OK);
        assert_false(pedal_unit_state(unit).has_kernel_driver);
        assert_true(pedal_unit_state(unit).is_claimed);
        bench_expect(&bench, 0, 0, 0);
        bench_close(&bench);
        assert_true(pedal_unit_state(unit).has_kernel_driver);
        assert_false(pedal_unit_state(unit).is_claimed);
        assert_int_equal(pedal_unit_state(unit).flying, 0);
    }
    bench_destroy(&bench);
}

static void a_pedal_that_another_program_holds_is_busy(void **state)
{
    pedal_bench bench;
    pedal_model held = VEC;
    held.is_held = true;
    pedal_double_plug(*state, "1-2", 2, &held);
    bench_create(&bench);
    open_fails(&bench, "", MRT_ERR_IO, "in use by");
    bench_destroy(&bench);
}

static void a_pedal_that_this_program_holds_is_named(void **state)
{
    pedal_bench first, second;
    pedal_double_plug(*state, "1-2", 2, &VEC);
    bench_create(&first);
    bench_create(&second);
    assert_int_equal(bench_open(&first, ""), MRT_OK);
    char process[64];
    snprintf(process, sizeof process, "(process %ld)", (long)getpid());
    open_fails(&second, "usb:1-2", MRT_ERR_IO, process);
    bench_expect(&first, 0, 0, 0); /* and it goes on */
    bench_destroy(&first);
    bench_destroy(&second);
}

/* The saved user stays root, so that there is a way back. */
static void become_nobody(void)
{
    assert_int_equal(setreuid(65534, 0), 0);
    assert_int_equal(seteuid(65534), 0);
}

static void become_root(void)
{
    assert_int_equal(seteuid(0), 0);
    assert_int_equal(setreuid(0, 0), 0);
}

static void without_rights_it_says_how_to_get_them(void **state)
{
    pedal_bench bench;
    pedal_unit *unit = pedal_double_plug(*state, "1-2", 2, &VEC);
    pedal_unit_set_mode(unit, 0600);
    bench_create(&bench);
    if (geteuid() != 0)
        skip();
    mrt_device device;
    assert_int_equal(bench.devices->list(bench.plugin, &device, 1), 1);
    become_nobody();
    mrt_result result = bench_open(&bench, "");
    uint32_t count = bench.devices->list(bench.plugin, &device, 1);
    become_root();
    assert_int_equal(result, MRT_ERR_IO);
    assert_true(bench_has_said(&bench, "70-marotte.rules"));
    assert_int_equal(count, 1);
    assert_int_equal(device.state, MRT_DEVICE_DENIED);
    assert_non_null(strstr(device.advice, "sudo udevadm control --reload"));
    assert_non_null(strstr(device.advice, "/dev/bus/usb/001/002"));
    bench_destroy(&bench);
}

/* As nobody, until a device that has just come is seen and refused; returns how long that took.
 * Each refusal costs umockdev a place in a small table, so this is not done often. */
static int64_t be_refused(pedal_bench *bench)
{
    int64_t took_ns = 0;
    become_nobody();
    for (int64_t until_ns = bench_now_ns() + BENCH_PATIENCE; bench_now_ns() < until_ns;) {
        bench->wait_count = 0;
        int64_t from_ns = bench_now_ns();
        (void)bench_open(bench, "");
        took_ns = bench_now_ns() - from_ns;
        if (bench_has_said(bench, "you have no permission to use"))
            break;
    }
    become_root();
    assert_true(bench_has_said(bench, "you have no permission to use"));
    return took_ns;
}

/* Rights come a moment after the device: udev sets them. */
static void rights_that_come_late_are_waited_for(void **state)
{
    pedal_bench bench;
    bench_create(&bench);
    if (geteuid() != 0)
        skip();
    open_fails(&bench, "", MRT_ERR_IO, "no known pedal found");
    pedal_unit *unit = pedal_double_plug(*state, "1-2", 2, &VEC);
    pedal_unit_set_mode(unit, 0600);
    assert_true(be_refused(&bench) >= 300 * BENCH_MS);
    pedal_unit_set_mode(unit, 0666);
    bench_reopen(&bench, "");
    bench_destroy(&bench);
}

static void a_host_that_stops_is_not_kept_waiting(void **state)
{
    pedal_bench bench;
    bench_create(&bench);
    if (geteuid() != 0)
        skip();
    open_fails(&bench, "", MRT_ERR_IO, "no known pedal found");
    pedal_unit *unit = pedal_double_plug(*state, "1-2", 2, &VEC);
    pedal_unit_set_mode(unit, 0600);
    bench.is_stopping = true;
    (void)be_refused(&bench);
    assert_int_equal(bench.wait_count, 1); /* and then gives up */
    bench_destroy(&bench);
}

static void a_device_that_dies_while_it_is_opened_is_an_error(void **state)
{
    static const pedal_death deaths[] = {PEDAL_DIES_AT_OPEN, PEDAL_DIES_AT_DETACH,
                                         PEDAL_DIES_AT_CLAIM, PEDAL_DIES_AT_SUBMIT};
    pedal_bench bench;
    bench_create(&bench);
    for (uint32_t i = 0; i < sizeof deaths / sizeof *deaths; ++i) {
        pedal_unit *unit = pedal_double_plug(*state, "1-2", 2 + i, &VEC);
        pedal_unit_dies_at(unit, deaths[i]);
        for (int k = 0; k < 400 && pedal_unit_state(unit).asked == 0; ++k) {
            bench_close(&bench);
            if (bench_open(&bench, "") == MRT_OK) /* the death was not noticed yet */
                bench_expect(&bench, 0, 0, 0);
            else
                bench.host.wait_until_ns(&bench.host, bench_now_ns() + 5 * BENCH_MS);
        }
        assert_true(pedal_unit_state(unit).asked > 0);
        open_fails(&bench, "", MRT_ERR_IO, "plug it in");
        assert_int_equal(pedal_unit_state(unit).flying, 0);
        pedal_unit_unplug(unit, ESHUTDOWN);
    }
    bench_destroy(&bench);
}

/* It is known without its report descriptor, so that is no error yet: the loss is. */
static void a_device_that_dies_at_the_last_question_is_lost_at_once(void **state)
{
    pedal_bench bench;
    mrt_sample sample;
    pedal_model model = VEC;
    model.is_unread = true;
    pedal_unit *unit = pedal_double_plug(*state, "1-2", 2, &model);
    pedal_unit_dies_at(unit, PEDAL_DIES_AT_CONTROL);
    bench_create(&bench);
    assert_int_equal(bench_open(&bench, ""), MRT_OK);
    assert_int_equal(bench_read(&bench, BENCH_PATIENCE, &sample), MRT_OK);
    assert_int_equal(bench_read(&bench, BENCH_PATIENCE, &sample), MRT_ERR_IO);
    bench_destroy(&bench);
}

static void a_device_that_never_answers_is_opened_in_time(void **state)
{
    pedal_bench bench;
    pedal_model model = VEC;
    model.is_unread = model.is_mute_to_control = true;
    pedal_unit *unit = pedal_double_plug(*state, "1-2", 2, &model);
    bench_create(&bench);
    assert_int_equal(bench_open(&bench, ""), MRT_OK);
    bench_expect(&bench, 0, 0, 0);
    REPORT(unit, 1, 0);
    bench_expect(&bench, 1, 0, 0);
    bench_destroy(&bench);
}

static void lies_about_sizes_are_not_believed(void **state)
{
    static const struct {
        uint16_t packet_bytes, told_bytes;
    } lies[] = {
        {.packet_bytes = 0}, {.packet_bytes = 0xffff}, {.packet_bytes = 8, .told_bytes = 9000}};
    pedal_bench bench;
    bench_create(&bench);
    for (uint32_t i = 0; i < sizeof lies / sizeof *lies; ++i) {
        pedal_model model = VEC;
        model.packet_bytes = lies[i].packet_bytes;
        model.told_bytes = lies[i].told_bytes;
        pedal_unit *unit = pedal_double_plug(*state, "1-2", 2 + i, &model);
        bench_reopen(&bench, "");
        bench_expect(&bench, 0, 0, 0);
        REPORT(unit, 1, 0);
        bench_expect(&bench, 1, 0, 0);
        bench_close(&bench);
        pedal_unit_unplug(unit, ESHUTDOWN);
    }
    bench_destroy(&bench);
}

static void endpoints_that_are_not_there_make_no_pedal(void **state)
{
    static const uint8_t told[] = {2, 30, 200};
    pedal_bench bench;
    for (uint32_t i = 0; i < sizeof told; ++i) {
        pedal_model model = VEC;
        model.told_endpoints = told[i];
        pedal_unit *unit = pedal_double_plug(*state, "1-2", 2 + i, &model);
        bench_create(&bench);
        open_fails(&bench, "", MRT_ERR_UNSUPPORTED, "no HID interface with reports");
        bench_destroy(&bench);
        pedal_unit_unplug(unit, ESHUTDOWN);
    }
}

static void descriptors_that_are_cut_off_are_no_pedal(void **state)
{
    static const uint16_t cuts[] = {1, 7, 8, 17, 25, 33};
    pedal_bench bench;
    bench_create(&bench);
    for (uint32_t i = 0; i < sizeof cuts / sizeof *cuts; ++i) {
        pedal_model model = VEC;
        model.cut_bytes = cuts[i];
        pedal_unit *unit = pedal_double_plug(*state, "1-2", 2 + i, &model);
        mrt_sample sample;
        for (int k = 0; k < 20; ++k)
            if (bench_open(&bench, "usb:1-2") == MRT_OK)
                (void)bench_read(&bench, 5 * BENCH_MS, &sample);
        bench_close(&bench);
        assert_int_equal(pedal_unit_state(unit).flying, 0);
        pedal_unit_unplug(unit, ESHUTDOWN);
    }
    bench_destroy(&bench);
}

static void reports_longer_than_their_packets_are_a_loss(void **state)
{
    pedal_bench bench;
    mrt_sample sample;
    pedal_model model = VEC;
    model.packet_bytes = 2;
    pedal_unit *unit = pedal_double_plug(*state, "1-2", 2, &model);
    bench_create(&bench);
    assert_int_equal(bench_open(&bench, ""), MRT_OK);
    bench_expect(&bench, 0, 0, 0);
    REPORT(unit, 1, 0, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12);
    bench_expect(&bench, 0, 0, 0);
    assert_int_equal(bench_read(&bench, BENCH_PATIENCE, &sample), MRT_ERR_IO);
    bench_reopen(&bench, "");
    bench_destroy(&bench);
}

/* A device that reports without pause, nothing new: read ends at its deadline all the same. */
static void a_flood_of_reports_does_not_hold_read_up(void **state)
{
    pedal_bench bench;
    mrt_sample sample;
    pedal_unit *unit = bench_begin(&bench, *state);
    for (int i = 0; i < 60; ++i)
        REPORT(unit, 0, 0);
    assert_int_equal(bench_read(&bench, 2 * BENCH_MS, &sample), MRT_TIMEOUT);
    REPORT(unit, 1, 0);
    bench_expect(&bench, 1, 0, 0);
    bench_destroy(&bench);
}

static void addresses_that_name_nothing_are_refused(void **state)
{
    (void)state;
    pedal_bench bench;
    bench_create(&bench);
    open_fails(&bench, "", MRT_ERR_IO, "no known pedal found");
    open_fails(&bench, "usb:1-7", MRT_ERR_IO, "found at usb:1-7");
    open_fails(&bench, "usb:05f3:00ff", MRT_ERR_IO, "no device usb:05f3:00ff");
    open_fails(&bench, "/dev/hidraw0", MRT_ERR_ARGUMENT, "usb:1-2.3");
    mrt_sample sample;
    assert_int_equal(bench_read(&bench, 0, &sample), MRT_ERR_IO);
    bench_close(&bench);
    bench_destroy(&bench);
}

static const struct CMUnitTest tests[] = {
    TEST(the_kernels_driver_is_detached_and_given_back),
    TEST(a_pedal_that_another_program_holds_is_busy),
    TEST(a_pedal_that_this_program_holds_is_named),
    TEST(without_rights_it_says_how_to_get_them),
    TEST(rights_that_come_late_are_waited_for),
    TEST(a_host_that_stops_is_not_kept_waiting),
    TEST(a_device_that_dies_while_it_is_opened_is_an_error),
    TEST(a_device_that_dies_at_the_last_question_is_lost_at_once),
    TEST(a_device_that_never_answers_is_opened_in_time),
    TEST(lies_about_sizes_are_not_believed),
    TEST(endpoints_that_are_not_there_make_no_pedal),
    TEST(descriptors_that_are_cut_off_are_no_pedal),
    TEST(reports_longer_than_their_packets_are_a_loss),
    TEST(a_flood_of_reports_does_not_hold_read_up),
    TEST(addresses_that_name_nothing_are_refused),
};
BENCH_MAIN(tests)
