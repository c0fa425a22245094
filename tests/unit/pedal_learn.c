/* pedal/learn.h: which part of a report is which switch, from presses alone. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "descriptor.h"
#include "learn.h"

#include <string.h>

static const int64_t MS = 1000000, SECOND = 1000000000;
static const layout UNKNOWN = {.vendor = 1, .product = 2, .name = "thing", .endpoint = 0x81};

typedef struct lesson {
    learn learn;
    int64_t now_ns;
} lesson;

static void start(lesson *self, const descriptor *fields)
{
    self->now_ns = 5 * SECOND;
    learn_start(&self->learn, &UNKNOWN, fields, self->now_ns);
}

static void report(lesson *self, const uint8_t *bytes, size_t size)
{
    self->now_ns += 10 * MS;
    (void)learn_report(&self->learn, bytes, size, self->now_ns);
}
#define REPORT(lesson, ...)                                                                        \
    report(lesson, (const uint8_t[]){__VA_ARGS__}, sizeof((const uint8_t[]){__VA_ARGS__}))

static void end_rest(lesson *self)
{
    assert_int_equal(self->learn.stage, LEARN_REST);
    self->now_ns = self->learn.until_ns;
    assert_true(learn_tick(&self->learn, self->now_ns));
    assert_int_equal(self->learn.stage, LEARN_WAIT);
}

static void bits_are_learnt_from_a_device_that_speaks_of_changes_only(void **state)
{
    (void)state;
    static lesson l;
    start(&l, NULL);
    end_rest(&l);
    REPORT(&l, 0, 4);
    assert_int_equal(l.learn.found.switch_count, 0);
    REPORT(&l, 0, 0);
    assert_int_equal(l.learn.found.switch_count, 1);
    REPORT(&l, 0, 1);
    REPORT(&l, 0, 0);
    assert_int_equal(l.learn.found.switch_count, 2);
    REPORT(&l, 0, 4);
    REPORT(&l, 0, 0);
    assert_int_equal(l.learn.stage, LEARN_DONE);
    assert_int_equal(l.learn.found.switch_count, 2);
    assert_int_equal(l.learn.found.switches[0].bit, 10);
    assert_int_equal(l.learn.found.switches[1].bit, 8);
    assert_int_equal(l.learn.found.vendor, 1);
    assert_int_equal(l.learn.found.endpoint, 0x81);
    assert_int_equal(l.learn.found.source, LAYOUT_OF_LEARNING);
}

static void bits_that_are_set_at_rest_are_learnt_too(void **state)
{
    (void)state;
    static lesson l;
    start(&l, NULL);
    REPORT(&l, 0xff, 7);
    end_rest(&l);
    REPORT(&l, 0xfd, 7);
    REPORT(&l, 0xff, 7);
    assert_int_equal(l.learn.found.switch_count, 1);
    const layout_switch *s = &l.learn.found.switches[0];
    assert_int_equal(s->bit, 1);
    assert_int_equal(s->up, 1);
    assert_int_equal(s->down, 0);
}

static void what_moves_by_itself_is_no_switch(void **state)
{
    (void)state;
    static lesson l;
    start(&l, NULL);
    for (uint8_t i = 0; i < 32; ++i)
        REPORT(&l, i, 0); /* a counter in the low five bits */
    end_rest(&l);
    for (uint8_t i = 0; i < 32; ++i)
        REPORT(&l, (uint8_t)(i * 7 % 32), 0);
    assert_int_equal(l.learn.stage, LEARN_WAIT);
    REPORT(&l, 3, 0x20);
    REPORT(&l, 9, 0);
    assert_int_equal(l.learn.found.switch_count, 1);
    assert_int_equal(l.learn.found.switches[0].bit, 13);
}

/* Two axes of ten bits with noise: the second moves along a little, as linked pedals do. */
static void an_axis_is_learnt_with_its_way(void **state)
{
    (void)state;
    static lesson l;
    descriptor fields = {
        .field_count = 2,
        .field = {{.bit = 0, .width = 16, .count = 1, .high = 1023, .page = 1, .usage = 0x30},
                  {.bit = 16, .width = 16, .count = 1, .high = 1023, .page = 1, .usage = 0x31}}};
    start(&l, &fields);
    for (uint8_t i = 0; i < 50; ++i)
        REPORT(&l, 100 + i % 5, 0, 30 + i % 3, 0);
    end_rest(&l);
    for (uint16_t i = 0; i <= 80; ++i) /* down and up */
        REPORT(&l, 100, 0, (uint8_t)((30 + (i < 40 ? i : 80 - i) * 20) & 255),
               (uint8_t)((30 + (i < 40 ? i : 80 - i) * 20) >> 8));
    assert_int_equal(l.learn.found.switch_count, 1);
    const layout_switch *s = &l.learn.found.switches[0];
    assert_int_equal(s->bit, 16);
    assert_in_range(s->up, 30, 33);
    assert_int_equal(s->down, 830);
    assert_true(layout_is_analogue(s));
    float value[LAYOUT_SWITCHES] = {0};
    const uint8_t half[] = {100, 0, 430 & 255, 430 >> 8};
    assert_true(decode_report(&l.learn.found, half, sizeof half, value));
    assert_float_equal(value[0], 0.5f, 0.005f);
}

static void the_two_ways_of_a_rudder_are_two_switches(void **state)
{
    (void)state;
    static lesson l;
    descriptor fields = {.field_count = 1,
                         .field = {{.bit = 0,
                                    .width = 8,
                                    .count = 1,
                                    .is_signed = true,
                                    .low = -127,
                                    .high = 127,
                                    .page = 2,
                                    .usage = 0xba}}};
    start(&l, &fields);
    REPORT(&l, 0);
    end_rest(&l);
    REPORT(&l, 0x90); /* -112 */
    REPORT(&l, 0);
    REPORT(&l, 0x7f);
    REPORT(&l, 0);
    assert_int_equal(l.learn.found.switch_count, 2);
    assert_int_equal(l.learn.found.switches[0].down, -112);
    assert_int_equal(l.learn.found.switches[1].down, 127);
}

static void nobody_pressing_anything_ends_it(void **state)
{
    (void)state;
    static lesson l;
    start(&l, NULL);
    assert_false(learn_tick(&l.learn, l.now_ns));
    end_rest(&l);
    assert_false(learn_tick(&l.learn, l.learn.until_ns - 1));
    assert_true(learn_tick(&l.learn, l.learn.until_ns));
    assert_int_equal(l.learn.stage, LEARN_FAILED);
    assert_false(learn_is_running(&l.learn));
    REPORT(&l, 1);
    assert_int_equal(l.learn.found.switch_count, 0);
}

static void silence_after_a_switch_is_the_end_of_the_lesson(void **state)
{
    (void)state;
    static lesson l;
    start(&l, NULL);
    end_rest(&l);
    REPORT(&l, 1);
    REPORT(&l, 0);
    assert_true(learn_tick(&l.learn, l.learn.until_ns));
    assert_int_equal(l.learn.stage, LEARN_DONE);
}

static void a_switch_that_is_never_let_go_fails(void **state)
{
    (void)state;
    static lesson l;
    start(&l, NULL);
    REPORT(&l, 0);
    end_rest(&l);
    REPORT(&l, 1);
    assert_int_equal(l.learn.stage, LEARN_DOWN);
    assert_true(learn_tick(&l.learn, l.learn.until_ns));
    assert_int_equal(l.learn.stage, LEARN_FAILED);
}

static void four_switches_are_all_there_can_be(void **state)
{
    (void)state;
    static lesson l;
    start(&l, NULL);
    end_rest(&l);
    for (uint8_t i = 0; i < 6; ++i) {
        REPORT(&l, (uint8_t)(1u << i));
        REPORT(&l, 0);
    }
    assert_int_equal(l.learn.stage, LEARN_DONE);
    assert_int_equal(l.learn.found.switch_count, 4);
    assert_string_equal(l.learn.found.switches[3].name, "switch 4");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bits_are_learnt_from_a_device_that_speaks_of_changes_only),
        cmocka_unit_test(bits_that_are_set_at_rest_are_learnt_too),
        cmocka_unit_test(what_moves_by_itself_is_no_switch),
        cmocka_unit_test(an_axis_is_learnt_with_its_way),
        cmocka_unit_test(the_two_ways_of_a_rudder_are_two_switches),
        cmocka_unit_test(nobody_pressing_anything_ends_it),
        cmocka_unit_test(silence_after_a_switch_is_the_end_of_the_lesson),
        cmocka_unit_test(a_switch_that_is_never_let_go_fails),
        cmocka_unit_test(four_switches_are_all_there_can_be),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
