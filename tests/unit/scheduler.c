/* stage/perform/scheduler.h: which samples are one step. Sources here are lists of times, of which
 * as many have come as the test says. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/clock.h"
#include "stage/perform/scheduler.h"

#include <string.h>

enum { TIMES = 400, SIDES = 2 };
static const int64_t MS = NS_PER_MS;

typedef struct hand_source {
    int64_t time_ns[TIMES];
    uint32_t count, come, at; /* come: so many are there by now */
    bool is_over_then;        /* behind them is the end */
    mrt_channel channel;
} hand_source;

static mrt_result peek(void *data, mrt_sample *out, uint32_t *out_version, error *err)
{
    (void)err;
    hand_source *self = data;
    *out_version = 0;
    if (self->at < self->come) {
        *out = (mrt_sample){
            .time_ns = self->time_ns[self->at], .sequence = self->at, .count = 1, .value = {0.1f}};
        return MRT_OK;
    }
    return self->is_over_then && self->at == self->count ? MRT_END : MRT_TIMEOUT;
}

static void take_sample(void *data)
{
    ((hand_source *)data)->at += 1;
}

static const mrt_channel *channels(void *data, uint32_t version, uint32_t *out_count)
{
    (void)version;
    *out_count = 1;
    return &((hand_source *)data)->channel;
}

/* `count` samples from first_ns on, period_ns apart; all have come. */
static void fill(hand_source *out, uint32_t side, uint32_t count, int64_t first_ns,
                 int64_t period_ns)
{
    *out = (hand_source){.count = count, .come = count, .is_over_then = true};
    out->channel = (mrt_channel){"index", "rad", MRT_CH_ANGLE + 4, side, -2, 2};
    for (uint32_t i = 0; i < count; ++i)
        out->time_ns[i] = first_ns + (int64_t)i * period_ns;
}

static void listen(scheduler *out, scheduler_rule rule, hand_source *of, uint32_t count)
{
    static scheduler_entry entry[STEP_SAMPLES_MAX];
    static channel_route route[STEP_SAMPLES_MAX];
    scheduler_init(out, rule, entry, route, STEP_SAMPLES_MAX);
    for (uint32_t i = 0; i < count; ++i) {
        const sample_source source = {
            .self = &of[i], .peek = peek, .take = take_sample, .channels = channels};
        scheduler_add(out, &source, NULL);
    }
}

/* MRT_OK: a step was taken. */
static mrt_result go_on(scheduler *self, int64_t now_ns, sample_step *out, int64_t *out_until_ns)
{
    error err = {""};
    mrt_result result = scheduler_next(self, now_ns, out, out_until_ns, &err);
    if (result == MRT_OK)
        scheduler_consume(self, out);
    return result;
}

static uint32_t count_steps(scheduler *self, uint32_t *out_samples)
{
    uint32_t steps = 0;
    int64_t until_ns, last_ns = INT64_MIN;
    sample_step s;
    *out_samples = 0;
    while (go_on(self, 0, &s, &until_ns) == MRT_OK) {
        assert_true(s.time_ns > last_ns);
        for (uint32_t i = 0; i < s.count; ++i)
            assert_true(s.of[i].sample.time_ns == s.time_ns);
        last_ns = s.time_ns;
        steps += 1;
        *out_samples += s.count;
    }
    return steps;
}

/* ---- recordings ---- */

static void two_hands_of_one_rate_are_one_step_a_tick(void **state)
{
    (void)state;
    static const int64_t apart_ms[] = {0, 1, 4, 5, 6, 9};
    for (size_t i = 0; i < sizeof apart_ms / sizeof apart_ms[0]; ++i) {
        hand_source of[SIDES];
        scheduler s;
        uint32_t samples;
        fill(&of[0], MRT_LEFT, 300, 0, 10 * MS);
        fill(&of[1], MRT_RIGHT, 300, apart_ms[i] * MS, 10 * MS);
        listen(&s, SCHEDULE_MEASURED, of, SIDES);
        uint32_t steps = count_steps(&s, &samples);
        assert_int_equal(samples, 600);
        if (steps > 303) /* before their rates are known they go alone */
            fail_msg("%u steps for 300 ticks, %lld ms apart", steps, (long long)apart_ms[i]);
    }
}

/* Clocks drift through each other: 300 ppm, and half a millisecond of noise. */
static void hands_whose_clocks_drift_stay_together(void **state)
{
    (void)state;
    hand_source of[SIDES];
    scheduler s;
    uint32_t samples, noise = 1;
    fill(&of[0], MRT_LEFT, 400, 0, 10 * MS);
    fill(&of[1], MRT_RIGHT, 400, 4 * MS, 10 * MS + 3 * MS / 100);
    for (uint32_t i = 0; i < 400; ++i) {
        noise = noise * 1664525u + 1013904223u;
        of[1].time_ns[i] += (int64_t)(noise >> 12) % (MS / 2);
    }
    listen(&s, SCHEDULE_MEASURED, of, SIDES);
    uint32_t steps = count_steps(&s, &samples);
    if (steps > 406)
        fail_msg("%u steps for 400 ticks", steps);
}

static void of_two_rates_the_faster_one_sets_the_pace(void **state)
{
    (void)state;
    hand_source of[SIDES];
    scheduler s;
    uint32_t samples;
    fill(&of[0], MRT_LEFT, 300, 0, 20 * MS / 3);
    fill(&of[1], MRT_RIGHT, 200, 1 * MS, 10 * MS);
    listen(&s, SCHEDULE_MEASURED, of, SIDES);
    uint32_t steps = count_steps(&s, &samples);
    assert_int_equal(samples, 500);
    if (steps > 304)
        fail_msg("%u steps for 300 samples of the faster one", steps);
}

static void what_measures_the_same_hand_is_never_one_step(void **state)
{
    (void)state;
    hand_source of[SIDES];
    scheduler s;
    uint32_t samples;
    fill(&of[0], MRT_RIGHT, 100, 0, 10 * MS);
    fill(&of[1], MRT_RIGHT, 100, 1 * MS, 10 * MS);
    listen(&s, SCHEDULE_MEASURED, of, SIDES);
    assert_int_equal(count_steps(&s, &samples), 200);
}

/* A press between the two samples of a step goes with them, and comes no earlier than it was. */
static void a_pedal_in_between_goes_with_them(void **state)
{
    (void)state;
    hand_source of[3];
    scheduler s;
    uint32_t samples;
    fill(&of[0], MRT_LEFT, 100, 0, 10 * MS);
    fill(&of[1], MRT_RIGHT, 100, 4 * MS, 10 * MS);
    fill(&of[2], MRT_NO_HAND, 1, 502 * MS, 10 * MS);
    of[2].channel.semantic = MRT_CH_PEDAL;
    listen(&s, SCHEDULE_MEASURED, of, 3);
    uint32_t steps = count_steps(&s, &samples);
    assert_int_equal(samples, 201);
    assert_true(steps <= 102);
}

/* What was one step when it was measured is one when it is performed again, and nothing else is. */
static void recorded_times_are_the_steps(void **state)
{
    (void)state;
    hand_source of[SIDES], again[SIDES];
    scheduler s;
    sample_step step;
    int64_t until_ns, at_ns[TIMES * SIDES];
    uint32_t size[TIMES * SIDES], steps = 0, n = 0;
    fill(&of[0], MRT_LEFT, 300, 0, 20 * MS / 3);
    fill(&of[1], MRT_RIGHT, 200, 1 * MS, 10 * MS);
    fill(&again[0], MRT_LEFT, 0, 0, 0);
    fill(&again[1], MRT_RIGHT, 0, 0, 0);
    listen(&s, SCHEDULE_MEASURED, of, SIDES);
    while (go_on(&s, 0, &step, &until_ns) == MRT_OK) {
        at_ns[steps] = step.time_ns;
        size[steps++] = step.count;
        for (uint32_t i = 0; i < step.count; ++i) {
            hand_source *to = &again[step.of[i].input];
            to->time_ns[to->count++] = step.of[i].sample.time_ns;
            to->come = to->count;
        }
    }
    listen(&s, SCHEDULE_RECORDED, again, SIDES);
    for (; go_on(&s, 0, &step, &until_ns) == MRT_OK; ++n) {
        assert_true(step.time_ns == at_ns[n]);
        assert_int_equal(step.count, size[n]);
    }
    assert_int_equal(n, steps);
}

/* Before there were steps, samples of one instant were recorded a nanosecond apart. */
static void what_was_recorded_a_nanosecond_apart_stays_apart(void **state)
{
    (void)state;
    hand_source of[SIDES];
    scheduler s;
    uint32_t samples;
    fill(&of[0], MRT_LEFT, 100, 0, 10 * MS);
    fill(&of[1], MRT_RIGHT, 100, 1, 10 * MS);
    listen(&s, SCHEDULE_RECORDED, of, SIDES);
    assert_int_equal(count_steps(&s, &samples), 200);
}

/* ---- live ---- */

/* Both have given ten samples at 100 Hz, 2 ms apart; then sample ten of the left one has come. */
static void begin_live(scheduler *s, hand_source of[SIDES])
{
    sample_step step;
    int64_t until_ns;
    fill(&of[0], MRT_LEFT, 100, 0, 10 * MS);
    fill(&of[1], MRT_RIGHT, 100, 2 * MS, 10 * MS);
    of[0].come = of[1].come = 10;
    listen(s, SCHEDULE_LIVE, of, SIDES);
    while (go_on(s, 93 * MS, &step, &until_ns) == MRT_OK)
        continue;
    assert_int_equal(s->sample_count, 20);
    of[0].come = 11;
}

static void a_late_hand_is_waited_for(void **state)
{
    (void)state;
    hand_source of[SIDES];
    scheduler s;
    sample_step step;
    int64_t until_ns;
    begin_live(&s, of);
    assert_int_equal(go_on(&s, 101 * MS, &step, &until_ns), MRT_TIMEOUT);
    assert_true(until_ns == 111 * MS); /* no longer than a sample's time */
    assert_int_equal(go_on(&s, 105 * MS, &step, &until_ns), MRT_TIMEOUT);
    assert_true(until_ns == 111 * MS);
    of[1].come = 11;
    assert_int_equal(go_on(&s, 106 * MS, &step, &until_ns), MRT_OK);
    assert_int_equal(step.count, 2);
    assert_true(step.time_ns == 102 * MS);
}

static void a_hand_that_does_not_come_is_waited_for_once(void **state)
{
    (void)state;
    hand_source of[SIDES];
    scheduler s;
    sample_step step;
    int64_t until_ns;
    begin_live(&s, of);
    assert_int_equal(go_on(&s, 101 * MS, &step, &until_ns), MRT_TIMEOUT);
    assert_int_equal(go_on(&s, 111 * MS, &step, &until_ns), MRT_OK);
    assert_int_equal(step.count, 1);
    for (uint32_t i = 12; i < 20; ++i) { /* nobody is slowed down by who is away */
        of[0].come = i;
        assert_int_equal(go_on(&s, (int64_t)i * 10 * MS + MS, &step, &until_ns), MRT_OK);
        assert_int_equal(step.count, 1);
    }
    of[1].come = 11; /* far too late: it comes behind what was performed */
    int64_t last_ns = step.time_ns;
    assert_int_equal(go_on(&s, 195 * MS, &step, &until_ns), MRT_OK);
    assert_int_equal(step.count, 1);
    assert_true(step.time_ns == last_ns + 1);
}

/* A hand that went away and is back has no rhythm yet; then they go together again. */
static void a_hand_that_is_back_is_waited_for_again(void **state)
{
    (void)state;
    hand_source of[SIDES];
    scheduler s;
    sample_step step;
    int64_t until_ns;
    begin_live(&s, of);
    for (uint32_t i = 10; i < 100; ++i)
        of[1].time_ns[i] += 400 * MS;
    for (uint32_t i = 11; i < 50; ++i) {
        of[0].come = i;
        (void)go_on(&s, (int64_t)i * 10 * MS + 20 * MS, &step, &until_ns);
        (void)go_on(&s, (int64_t)i * 10 * MS + 31 * MS, &step, &until_ns);
    }
    uint64_t before = s.step_count;
    for (uint32_t i = 50; i < 100; ++i) {
        of[0].come = i + 1;
        int64_t now_ns = (int64_t)i * 10 * MS + MS;
        while (go_on(&s, now_ns, &step, &until_ns) == MRT_OK)
            continue;
        of[1].come = i - 40 + 1;
        while (go_on(&s, now_ns + 3 * MS, &step, &until_ns) == MRT_OK)
            continue;
    }
    assert_true(s.step_count - before <= 54);
    assert_int_equal(s.sample_count, 160);
}

static void the_end_is_told_when_all_are_over(void **state)
{
    (void)state;
    hand_source of[SIDES];
    scheduler s;
    sample_step step;
    int64_t until_ns;
    fill(&of[0], MRT_LEFT, 1, 0, MS);
    fill(&of[1], MRT_RIGHT, 0, 0, MS);
    of[1].is_over_then = false;
    listen(&s, SCHEDULE_LIVE, of, SIDES);
    assert_int_equal(go_on(&s, 0, &step, &until_ns), MRT_OK);
    assert_int_equal(go_on(&s, 0, &step, &until_ns), MRT_TIMEOUT);
    of[1].is_over_then = true;
    assert_int_equal(go_on(&s, 0, &step, &until_ns), MRT_END);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(two_hands_of_one_rate_are_one_step_a_tick),
        cmocka_unit_test(hands_whose_clocks_drift_stay_together),
        cmocka_unit_test(of_two_rates_the_faster_one_sets_the_pace),
        cmocka_unit_test(what_measures_the_same_hand_is_never_one_step),
        cmocka_unit_test(a_pedal_in_between_goes_with_them),
        cmocka_unit_test(recorded_times_are_the_steps),
        cmocka_unit_test(what_was_recorded_a_nanosecond_apart_stays_apart),
        cmocka_unit_test(a_late_hand_is_waited_for),
        cmocka_unit_test(a_hand_that_does_not_come_is_waited_for_once),
        cmocka_unit_test(a_hand_that_is_back_is_waited_for_again),
        cmocka_unit_test(the_end_is_told_when_all_are_over),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
