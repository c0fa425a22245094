/* plugins/cyberglove/glove_clock.h: the times of records, by stamps and by rate. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "glove_clock.h"

#include <math.h>
#include <stdlib.h>

static const int64_t MS = 1000000, ORIGIN_NS = 5000000000;
static const double TICK_NS = 1e9 / 115200;

/* At the next multiple of 16 ms, as a USB serial adapter delivers. */
static int64_t bunched(int64_t time_ns)
{
    return (time_ns / (16 * MS) + 1) * (16 * MS);
}

typedef struct spread {
    double mean_ms, sd_ms, least_ms, most_ms;
} spread;

typedef struct tally {
    double sum, squares, least, most;
    int count;
} tally;

static void add(tally *self, double error_ms)
{
    self->sum += error_ms;
    self->squares += error_ms * error_ms;
    self->least = self->count && self->least < error_ms ? self->least : error_ms;
    self->most = self->count && self->most > error_ms ? self->most : error_ms;
    self->count += 1;
}

static spread spread_of(const tally *self)
{
    double mean = self->sum / self->count;
    return (spread){mean, sqrt(fmax(self->squares / self->count - mean * mean, 0)), self->least,
                    self->most};
}

/* Records every period_ns, told_ns what the clock is told; those of the first `skip` do not count.
 * lose: of so many one is lost; 0: none. */
static spread by_rate(double period_ns, int64_t told_ns, int skip, int lose)
{
    glove_clock clock;
    glove_clock_init(&clock, GLOVE_BY_RATE, told_ns);
    tally errors = {0};
    int64_t last_ns = 0;
    uint32_t lost = 0;
    for (int i = 0; i < 3000; ++i) {
        if (lose && i % lose == lose / 2) {
            lost = 1;
            continue;
        }
        int64_t true_ns = ORIGIN_NS + (int64_t)(i * period_ns);
        int64_t arrival_ns = bunched(true_ns);
        glove_record record = {.lost = lost};
        int64_t time_ns = glove_clock_time(&clock, &record, arrival_ns);
        lost = 0;
        assert_true(time_ns <= arrival_ns && time_ns >= last_ns);
        last_ns = time_ns;
        if (i >= skip)
            add(&errors, (double)(time_ns - true_ns) / 1e6);
    }
    return spread_of(&errors);
}

static void bunches_are_spread_by_a_rate_that_was_told(void **state)
{
    (void)state;
    spread s = by_rate(1e9 / 150, 6666667, 0, 0);
    assert_true(s.sd_ms < 1.5);
    assert_true(s.mean_ms > -1 && s.mean_ms < 3);
}

static void a_rate_that_nobody_told_is_learnt(void **state)
{
    (void)state;
    static const double hz[] = {60, 90, 112, 120, 150, 350};
    for (int i = 0; i < 6; ++i) {
        spread s = by_rate(1e9 / hz[i], 0, (int)hz[i], 0);
        assert_true(s.sd_ms < 2.5); /* 60 Hz beats slowly with 16 ms */
        assert_true(s.least_ms > -8 && s.most_ms < 17);
    }
}

/* In the first three seconds, but for the first half. */
static void a_rate_that_nobody_told_is_known_soon(void **state)
{
    (void)state;
    static const double hz[] = {60, 90, 100, 112, 120, 150, 350};
    for (int i = 0; i < 7; ++i) {
        glove_clock clock;
        glove_clock_init(&clock, GLOVE_BY_RATE, 0);
        const glove_record record = {0};
        tally errors = {0};
        for (int k = 0; k < (int)(3 * hz[i]); ++k) {
            int64_t true_ns = ORIGIN_NS + (int64_t)(k * 1e9 / hz[i]);
            int64_t time_ns = glove_clock_time(&clock, &record, bunched(true_ns));
            if (k > (int)(hz[i] / 2))
                add(&errors, (double)(time_ns - true_ns) / 1e6);
        }
        spread s = spread_of(&errors);
        assert_true(s.sd_ms < 1.3);
        assert_true(s.least_ms > -1 && s.most_ms < 6);
    }
}

static void a_rate_is_learnt_past_losses_pauses_and_clocks_that_turn_back(void **state)
{
    (void)state;
    glove_rate rate = {.count = 0};
    double period_ns = 0, due_ns = 0;
    for (int k = 0; k < 300; ++k)
        if (k % 5 != 4)
            glove_rate_add(&rate, k > 0 && k % 5 == 0, ORIGIN_NS + k * 10 * MS, &period_ns,
                           &due_ns);
    assert_true(fabs(period_ns - 1e7) < 1 && glove_rate_is_known(&rate));
    assert_false(glove_rate_add(&rate, 0, ORIGIN_NS + 60000 * MS, &period_ns, &due_ns));
    assert_false(glove_rate_is_known(&rate));
    for (int k = 1; k < 300; ++k)
        glove_rate_add(&rate, 0, ORIGIN_NS + 60000 * MS + k * 5 * MS, &period_ns, &due_ns);
    assert_true(fabs(period_ns - 5e6) < 1);
    assert_false(glove_rate_add(&rate, 0, ORIGIN_NS, &period_ns, &due_ns));
}

static void a_rate_has_room_for_any_arrivals(void **state)
{
    (void)state;
    glove_rate rate = {.count = 0};
    double period_ns = 0, due_ns = 0;
    for (int64_t k = 0; k < 1000; ++k) { /* ever slower: every arrival is a corner */
        int64_t arrival_ns = ORIGIN_NS + k * MS + k * k * 500;
        if (glove_rate_add(&rate, 0, arrival_ns, &period_ns, &due_ns))
            assert_true(due_ns <= (double)arrival_ns && period_ns > 0);
        assert_true(rate.corner_count <= GLOVE_RATE_CORNERS);
    }
}

static void a_rate_that_was_told_wrong_is_found_out(void **state)
{
    (void)state;
    static const double hz[] = {128, 140, 149, 151, 160, 200};
    for (int i = 0; i < 6; ++i) {
        spread s = by_rate(1e9 / hz[i], 6666667, 400, 0);
        assert_true(s.sd_ms < 2);
        assert_true(s.least_ms > -6 && s.most_ms < 10);
    }
}

static void lost_records_leave_their_room(void **state)
{
    (void)state;
    spread s = by_rate(1e9 / 150, 6666667, 0, 10);
    assert_true(s.sd_ms < 1.5);
}

static void a_pause_is_not_caught_up_with(void **state)
{
    (void)state;
    glove_clock clock;
    glove_clock_init(&clock, GLOVE_BY_RATE, 10 * MS);
    const glove_record record = {0};
    for (int64_t i = 0; i < 100; ++i)
        glove_clock_time(&clock, &record, ORIGIN_NS + i * 10 * MS);
    int64_t after_ns = ORIGIN_NS + 5000 * MS;
    assert_int_equal(glove_clock_time(&clock, &record, after_ns), after_ns);
    assert_int_equal(glove_clock_time(&clock, &record, after_ns + 10 * MS), after_ns + 10 * MS);
}

static void polled_records_are_of_when_they_came(void **state)
{
    (void)state;
    glove_clock clock;
    glove_clock_init(&clock, GLOVE_BY_ARRIVAL, 0);
    const glove_record record = {.lost = 3};
    assert_int_equal(glove_clock_time(&clock, &record, ORIGIN_NS), ORIGIN_NS);
    assert_int_equal(glove_clock_time(&clock, &record, ORIGIN_NS + 7), ORIGIN_NS + 7);
    assert_int_equal(glove_clock_time(&clock, &record, ORIGIN_NS), ORIGIN_NS + 7);
}

/* ---- stamps ---- */

typedef struct stamps {
    double drift;       /* of the glove's clock */
    uint32_t first;     /* ticks */
    int harm_every;     /* of so many stamps one is damaged; 0: none */
    uint32_t harm_bits; /* what is turned round in it */
} stamps;

static spread by_stamp(stamps how)
{
    glove_clock clock;
    glove_clock_init(&clock, GLOVE_BY_STAMP, 6666667);
    tally errors = {0};
    int64_t last_ns = 0;
    for (int i = 0; i < 9000; ++i) {
        int64_t true_ns = ORIGIN_NS + (int64_t)(i * 1e9 / 150);
        double device_ns = (double)(true_ns - ORIGIN_NS) * (1 + how.drift);
        glove_record record = {.ticks = how.first + (uint32_t)(int64_t)(device_ns / TICK_NS)};
        if (how.harm_every && i % how.harm_every == how.harm_every - 1)
            record.ticks ^= how.harm_bits;
        int64_t arrival_ns = bunched(true_ns);
        int64_t time_ns = glove_clock_time(&clock, &record, arrival_ns);
        assert_true(time_ns <= arrival_ns && time_ns >= last_ns);
        last_ns = time_ns;
        if (i >= 300)
            add(&errors, (double)(time_ns - true_ns) / 1e6);
    }
    assert_false(clock.distrusts_stamps);
    return spread_of(&errors);
}

static void stamps_show_the_gloves_own_rhythm(void **state)
{
    (void)state;
    spread s = by_stamp((stamps){0});
    assert_true(s.sd_ms < 0.1 && s.mean_ms > -0.1 && s.mean_ms < 1.5);
    s = by_stamp((stamps){.drift = 80e-6});
    assert_true(s.sd_ms < 0.5);
}

static void stamps_wrap_round(void **state)
{
    (void)state;
    spread s = by_stamp((stamps){.first = UINT32_MAX - 115200 * 10});
    assert_true(s.sd_ms < 0.1);
}

static void one_damaged_stamp_misleads_nobody(void **state)
{
    (void)state;
    static const uint32_t bits[] = {0x300, 0x4000, 0x8000, 0x10000, 0x1000000, 0x80000000};
    for (int i = 0; i < 6; ++i) {
        spread s = by_stamp((stamps){.harm_every = 50, .harm_bits = bits[i]});
        assert_true(s.sd_ms < 1.5);
        assert_true(s.least_ms > -20 && s.most_ms < 20);
    }
}

static void stamps_that_stand_still_or_race_are_not_believed(void **state)
{
    (void)state;
    static const uint32_t step[] = {0, 10, 768 * 4};
    for (int k = 0; k < 3; ++k) {
        glove_clock clock;
        glove_clock_init(&clock, GLOVE_BY_STAMP, 6666667);
        int64_t time_ns = 0, arrival_ns = 0;
        for (uint32_t i = 0; i < 900; ++i) {
            const glove_record record = {.ticks = 1000 + step[k] * i};
            arrival_ns = ORIGIN_NS + (int64_t)(i * 1e9 / 150);
            time_ns = glove_clock_time(&clock, &record, arrival_ns);
        }
        assert_true(clock.distrusts_stamps);
        assert_true(arrival_ns - time_ns < 5 * MS);
    }
}

/* A machine so busy that what came in 0.7 s is read at once, every 2.1 s. */
static void a_reader_that_stalls_does_not_blame_the_stamps(void **state)
{
    (void)state;
    glove_clock clock;
    glove_clock_init(&clock, GLOVE_BY_STAMP, 6666667);
    for (int64_t i = 0; i < 6000; ++i) {
        int64_t true_ns = ORIGIN_NS + i * 20000000 / 3;
        int64_t phase_ns = (true_ns - ORIGIN_NS) % (2100 * MS);
        int64_t arrival_ns = phase_ns < 700 * MS ? true_ns + 700 * MS - phase_ns : true_ns;
        glove_record record = {.ticks = (uint32_t)((double)i * 768)};
        int64_t time_ns = glove_clock_time(&clock, &record, arrival_ns);
        assert_false(clock.distrusts_stamps);
        if (i > 300) /* from the first arrival in time on */
            assert_true(llabs(time_ns - true_ns) < MS);
    }
}

static void a_glove_that_starts_again_starts_its_clock(void **state)
{
    (void)state;
    glove_clock clock;
    glove_clock_init(&clock, GLOVE_BY_STAMP, 6666667);
    int64_t time_ns = 0, arrival_ns = 0;
    for (uint32_t i = 0; i < 900; ++i) {
        const glove_record record = {.ticks = i < 450 ? 90000000 + 768 * i : 768 * i};
        arrival_ns = ORIGIN_NS + (int64_t)(i * 1e9 / 150);
        time_ns = glove_clock_time(&clock, &record, arrival_ns);
        assert_true(arrival_ns - time_ns < 20 * MS);
    }
    assert_true(arrival_ns - time_ns < 1 * MS);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bunches_are_spread_by_a_rate_that_was_told),
        cmocka_unit_test(a_rate_that_nobody_told_is_known_soon),
        cmocka_unit_test(a_rate_is_learnt_past_losses_pauses_and_clocks_that_turn_back),
        cmocka_unit_test(a_rate_has_room_for_any_arrivals),
        cmocka_unit_test(a_rate_that_nobody_told_is_learnt),
        cmocka_unit_test(a_rate_that_was_told_wrong_is_found_out),
        cmocka_unit_test(lost_records_leave_their_room),
        cmocka_unit_test(a_pause_is_not_caught_up_with),
        cmocka_unit_test(polled_records_are_of_when_they_came),
        cmocka_unit_test(stamps_show_the_gloves_own_rhythm),
        cmocka_unit_test(stamps_wrap_round),
        cmocka_unit_test(one_damaged_stamp_misleads_nobody),
        cmocka_unit_test(stamps_that_stand_still_or_race_are_not_believed),
        cmocka_unit_test(a_reader_that_stalls_does_not_blame_the_stamps),
        cmocka_unit_test(a_glove_that_starts_again_starts_its_clock),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
