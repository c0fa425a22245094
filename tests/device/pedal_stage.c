/* plugins/pedal behind core/stage/input/input.h: read by the stage's own thread, pulled out while
 * it is held, and back in its socket by itself. */
#include "pedal_bench.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "base/clock.h"
#include "stage/input/input.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

enum { REPLUGS = 100 };
static const int64_t patience_ns = 60 * NS_PER_S;

typedef struct pedal_room {
    pedal_bench bench; /* for the type alone */
    log_queue *log;
    wake signal;
    input *input;
    mrt_sample last;
} pedal_room;

static void enter_room(pedal_room *self, const char *address)
{
    error err = {""};
    *self = (pedal_room){.log = log_queue_create()};
    wake_init(&self->signal);
    bench_create(&self->bench);
    if (input_create(&self->input, self->bench.type, address, "debounce=5", CLOCK_REAL, self->log,
                     &err) < 0)
        fail_msg("%s", err.text);
    input_set_wake(self->input, &self->signal);
    input_set_patience_ns(self->input, 20 * NS_PER_MS, 20 * NS_PER_MS);
    assert_int_equal(input_start(self->input, &err), MRT_OK);
}

static void leave_room(pedal_room *self)
{
    input_destroy(self->input);
    log_queue_destroy(self->log);
    bench_destroy(&self->bench);
}

/* Takes samples until the first switch is as wanted. */
static void wait_for_switch(pedal_room *self, float wanted)
{
    int64_t until_ns = clock_now_ns() + patience_ns;
    for (;;) {
        uint32_t seen = wake_seen(&self->signal);
        while (input_peek(self->input, &self->last)) {
            input_pop(self->input);
            if (self->last.value[0] == wanted)
                return;
        }
        if (clock_now_ns() > until_ns)
            fail_msg("the switch is %g, wanted %g", (double)self->last.value[0], (double)wanted);
        wake_wait_until_ns(&self->signal, seen, clock_now_ns() + 100 * NS_PER_MS);
    }
}

static input_incident wait_for_incident(pedal_room *self, input_incident_kind kind)
{
    input_incident incident = {0};
    int64_t until_ns = clock_now_ns() + patience_ns;
    for (;;) {
        uint32_t seen = wake_seen(&self->signal);
        while (input_pop_incident(self->input, &incident))
            if (incident.kind == kind)
                return incident;
        if (clock_now_ns() > until_ns)
            fail_msg("no incident of kind %d", (int)kind);
        wake_wait_until_ns(&self->signal, seen, clock_now_ns() + 100 * NS_PER_MS);
    }
}

static void a_pedal_comes_back_by_itself(void **state)
{
    pedal_room room;
    pedal_unit *unit = pedal_double_plug(*state, "1-2", 2, &VEC);
    enter_room(&room, "");
    REPORT(unit, 1, 0);
    wait_for_switch(&room, 1);
    pedal_unit_unplug(unit, EPROTO);
    wait_for_switch(&room, 0);
    input_incident went = wait_for_incident(&room, INPUT_WAS_LOST);
    assert_non_null(strstr(went.text, "was disconnected"));
    unit = pedal_double_plug(*state, "1-2", 3, &VEC);
    wait_for_incident(&room, INPUT_IS_BACK);
    REPORT(unit, 1, 0); /* umockdev may lose it once more: it mistakes files of two threads */
    wait_for_switch(&room, 1);
    leave_room(&room);
    assert_true(pedal_unit_state(unit).has_kernel_driver);
}

static void no_pedal_sticks_in_a_hundred_losses(void **state)
{
    pedal_room room;
    uint32_t files = 0;
    int64_t longest_ns = 0;
    pedal_unit *unit = pedal_double_plug(*state, "1-2", 2, &VEC);
    enter_room(&room, "");
    for (uint32_t i = 0; i < REPLUGS; ++i) {
        REPORT(unit, 1, 0);
        wait_for_switch(&room, 1);
        pedal_unit_unplug(unit, i % 2 ? EPROTO : ESHUTDOWN);
        wait_for_switch(&room, 0);
        wait_for_incident(&room, INPUT_WAS_LOST);
        int64_t back_ns = clock_now_ns();
        unit = pedal_double_plug(*state, "1-2", 3 + i, &VEC);
        wait_for_incident(&room, INPUT_IS_BACK);
        if (clock_now_ns() - back_ns > longest_ns)
            longest_ns = clock_now_ns() - back_ns;
        if (i == 9)
            files = bench_open_files();
    }
    printf("back after %.0f ms at the latest, of %d times, looking every 20 ms; %u files open "
           "before, %u after\n",
           (double)longest_ns / 1e6, REPLUGS, files, bench_open_files());
    assert_true(bench_has_open_files(files + 2));
    assert_int_equal(input_refused(room.input), 0);
    leave_room(&room);
}

static void a_lost_pedal_does_not_hold_up_the_end(void **state)
{
    pedal_room room;
    pedal_unit *unit = pedal_double_plug(*state, "1-2", 2, &VEC);
    enter_room(&room, "usb:1-2");
    pedal_unit_unplug(unit, EPROTO);
    wait_for_incident(&room, INPUT_WAS_LOST);
    leave_room(&room);
}

static const struct CMUnitTest tests[] = {
    TEST(a_pedal_comes_back_by_itself),
    TEST(no_pedal_sticks_in_a_hundred_losses),
    TEST(a_lost_pedal_does_not_hold_up_the_end),
};
BENCH_MAIN(tests)
