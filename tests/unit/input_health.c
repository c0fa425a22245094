/* core/stage/health: what the meters say of streams that are known. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/clock.h"
#include "stage/input/health.h"

#include <math.h>
#include <pthread.h>
#include <string.h>

static const int64_t start_ns = 5000 * NS_PER_S;

static const mrt_channel channels[3] = {
    {"thumb MPJ", "count", MRT_CH_ANGLE + 1, MRT_RIGHT, 1, 255},
    {"note", "", MRT_CH_OTHER, MRT_NO_HAND, 0, 0}, /* no range */
    {"switch", "", MRT_CH_PEDAL, MRT_NO_HAND, 0, 1},
};

/* Numbers that look random, from a stated seed: 0 .. 1. */
typedef struct noise {
    uint64_t state;
} noise;

static double next(noise *self)
{
    self->state = self->state * 6364136223846793005u + 1442695040888963407u;
    return (double)(self->state >> 11) / 9007199254740992.0;
}

/* A stream of `rate_hz` for `seconds`, whose samples are measured up to wobble_ms off their beat,
 * arrive late_ms later and up to late_ms_more after that; its clock runs drift_ppm fast; one in
 * drop_one_in is lost (0: none). */
typedef struct stream {
    double rate_hz, seconds, wobble_ms, late_ms, late_ms_more, drift_ppm;
    uint32_t drop_one_in;
    double bunch_ms; /* arrivals only at multiples of this; 0: any time */
} stream;

static int64_t play(health_meter *meter, const stream *what, noise *random)
{
    int64_t arrival_ns = start_ns;
    uint32_t count = (uint32_t)(what->rate_hz * what->seconds);
    for (uint32_t i = 0; i < count; ++i) {
        double true_s = i / what->rate_hz + (next(random) - 0.5) * what->wobble_ms / 500.0;
        double arrive_s = true_s + (what->late_ms + next(random) * what->late_ms_more) / 1000.0;
        if (what->bunch_ms > 0)
            arrive_s = ceil(arrive_s * 1000.0 / what->bunch_ms) * what->bunch_ms / 1000.0;
        int64_t at_ns = start_ns + (int64_t)(arrive_s * 1e9);
        arrival_ns = at_ns > arrival_ns ? at_ns : arrival_ns;
        mrt_sample sample = {.time_ns = start_ns +
                                        (int64_t)(true_s * (1.0 + what->drift_ppm * 1e-6) * 1e9),
                             .sequence = i,
                             .count = 3,
                             .value = {i % 10 == 0 ? 255.0f : 100.0f, 7.0f, 0.0f}};
        if (what->drop_one_in == 0 || i % what->drop_one_in != what->drop_one_in - 1)
            health_sample(meter, &sample, arrival_ns);
    }
    return arrival_ns;
}

static health_report measured(const stream *what, uint64_t seed)
{
    health_meter meter;
    health_report out;
    noise random = {seed};
    health_init(&meter, channels, 3, start_ns);
    int64_t end_ns = play(&meter, what, &random);
    health_measure(&meter, end_ns, &out);
    return out;
}

static void rate_is_right_within_one_percent(void **state)
{
    (void)state;
    static const double rates[] = {20, 60, 100, 149.7, 1000};
    for (int i = 0; i < 5; ++i) {
        stream s = {.rate_hz = rates[i], .seconds = 5, .wobble_ms = 0.2, .late_ms_more = 1};
        health_report r = measured(&s, 1);
        assert_true(fabs(r.rate_hz - rates[i]) < 0.01 * rates[i]);
        assert_int_equal(r.sample_count, (uint32_t)(rates[i] * 5));
        assert_int_equal(r.gap_count, 0);
    }
}

static void jitter_is_the_deviation_of_intervals(void **state)
{
    (void)state;
    /* Each sample is off by up to +-w, evenly: an interval's deviation is w sqrt(2/3). */
    static const double wobble_ms[] = {0, 0.5, 2};
    for (int i = 0; i < 3; ++i) {
        stream s = {.rate_hz = 150, .seconds = 4, .wobble_ms = wobble_ms[i], .late_ms = 1};
        health_report r = measured(&s, 2);
        double expected_ms = wobble_ms[i] * sqrt(2.0 / 3.0);
        assert_true(fabs(r.jitter_ms - expected_ms) < 0.12 * expected_ms + 1e-4);
    }
}

static void lateness_is_the_way_from_measured_to_arrived(void **state)
{
    (void)state;
    stream s = {.rate_hz = 150, .seconds = 4, .late_ms = 3, .late_ms_more = 4};
    health_report r = measured(&s, 3);
    assert_true(fabs(r.lateness_ms - 5.0) < 0.3);
    assert_true(r.lateness_worst_ms > 6.8 && r.lateness_worst_ms < 8.0);
    /* Bunched by 16 ms: late on average by half of that, at worst by all of it. */
    stream bunched = {.rate_hz = 150, .seconds = 4, .bunch_ms = 16};
    r = measured(&bunched, 3);
    assert_true(fabs(r.lateness_ms - 8.0) < 1.0);
    assert_true(r.lateness_worst_ms > 14.0 && r.lateness_worst_ms <= 16.01);
    assert_true(fabs(r.rate_hz - 150) < 2);
    assert_true(r.jitter_ms < 1e-3); /* the samples' own times are even */
}

static void what_is_lost_on_the_way_is_counted(void **state)
{
    (void)state;
    stream s = {.rate_hz = 150, .seconds = 4, .drop_one_in = 10};
    health_meter meter;
    health_report r;
    noise random = {4};
    health_init(&meter, channels, 3, start_ns);
    int64_t end_ns = play(&meter, &s, &random);
    health_refused(&meter);
    health_dropped(&meter);
    health_dropped(&meter);
    health_measure(&meter, end_ns, &r);
    assert_int_equal(r.gap_count, 59); /* the sixtieth is the last one: nothing came after it */
    assert_int_equal(r.sample_count, 540);
    assert_int_equal(r.refused_count, 1);
    assert_int_equal(r.dropped_count, 2);
    assert_true(fabs(r.rate_hz - 135) < 2); /* of what came */
    assert_true(r.jitter_ms < 1e-3);        /* gaps are no jitter */
    /* A device that starts to count anew has lost nothing. */
    health_reopened(&meter, channels, 3);
    play(&meter, &s, &random);
    health_measure(&meter, end_ns, &r);
    assert_int_equal(r.gap_count, 118);
}

static void sequence_that_leaps_is_no_loss_of_billions(void **state)
{
    (void)state;
    static const uint32_t sequence[] = {5, 6, 4000000000u, 4000000001u, 3, 3, UINT32_MAX, 0, 2};
    health_meter meter;
    health_report r;
    health_init(&meter, channels, 3, start_ns);
    for (uint32_t i = 0; i < 9; ++i) {
        mrt_sample sample = {
            .time_ns = start_ns + i * NS_PER_MS, .sequence = sequence[i], .count = 3};
        health_sample(&meter, &sample, sample.time_ns);
    }
    health_measure(&meter, start_ns + 9 * NS_PER_MS, &r);
    assert_int_equal(r.gap_count, 1);
}

static void channels_at_their_ends_are_named(void **state)
{
    (void)state;
    stream s = {.rate_hz = 150, .seconds = 4};
    health_report r = measured(&s, 5);
    assert_int_equal(r.channel_count, 3);
    assert_true(fabsf(r.saturated[0] - 0.1f) < 0.01f); /* every tenth sample is at 255 */
    assert_true(r.saturated[1] < 1e-6f);               /* no range */
    assert_true(r.saturated[2] < 1e-6f);               /* a pedal is always at an end */
}

static void silence_is_told_and_what_was_fades_within_two_seconds(void **state)
{
    (void)state;
    health_meter meter;
    health_report r;
    noise random = {6};
    stream s = {.rate_hz = 100, .seconds = 4};
    health_init(&meter, channels, 3, start_ns);
    health_measure(&meter, start_ns + 3 * NS_PER_S, &r);
    assert_true(fabs(r.silence_s - 3.0) < 1e-9 && r.rate_hz < 1e-9);
    int64_t end_ns = play(&meter, &s, &random);
    health_measure(&meter, end_ns + NS_PER_S / 2, &r);
    assert_true(fabs(r.silence_s - 0.5) < 1e-9);
    assert_true(r.rate_hz > 60 && r.rate_hz < 85);
    health_measure(&meter, end_ns + 5 * NS_PER_S / 2, &r);
    assert_true(r.rate_hz < 1e-9 && r.jitter_ms < 1e-9 && r.saturated[0] < 1e-6f);
    health_age(&r, end_ns + 4 * NS_PER_S);
    assert_true(fabs(r.silence_s - 4.0) < 1e-9);
}

static void drift_is_right_within_five_ppm_though_arrivals_are_late(void **state)
{
    (void)state;
    static const double ppm[] = {0, 50, -80, 300};
    for (int i = 0; i < 4; ++i) {
        stream s = {
            .rate_hz = 150, .seconds = 40, .late_ms = 1, .late_ms_more = 4, .drift_ppm = ppm[i]};
        health_report r = measured(&s, 7);
        assert_true(r.has_drift);
        assert_true(fabs(r.drift_ppm - ppm[i]) < 5.0);
    }
    stream bunched = {.rate_hz = 149.3, .seconds = 40, .bunch_ms = 16, .drift_ppm = 50};
    health_report r = measured(&bunched, 7);
    assert_true(fabs(r.drift_ppm - 50) < 25.0); /* the envelope touches in steps */
    stream brief = {.rate_hz = 150, .seconds = 8};
    assert_false(measured(&brief, 7).has_drift);
}

static void state_lasts_since_it_changed(void **state)
{
    (void)state;
    health_meter meter;
    health_report r;
    health_init(&meter, channels, 3, start_ns);
    health_state(&meter, 3, "the cable was pulled", start_ns + NS_PER_S);
    health_state(&meter, 3, "no such device", start_ns + 2 * NS_PER_S);
    health_lost(&meter);
    health_measure(&meter, start_ns + 5 * NS_PER_S, &r);
    assert_int_equal(r.state, 3);
    assert_int_equal(r.loss_count, 1);
    assert_true(fabs(r.state_s - 4.0) < 1e-9);
    assert_string_equal(r.words, "no such device");
    char words[1000];
    memset(words, 'x', sizeof words - 1);
    words[sizeof words - 1] = '\0';
    health_state(&meter, 3, words, start_ns);
    health_measure(&meter, start_ns, &r);
    assert_int_equal(strlen(r.words), HEALTH_WORDS_LENGTH - 1);
}

enum { POSTS = 20000 };

static void *post(void *data)
{
    health_board *board = data;
    health_report report = {0};
    for (uint32_t i = 1; i <= POSTS; ++i) {
        report.sample_count = report.gap_count = report.refused_count = i;
        report.saturated[MRT_MAX_CHANNELS - 1] = (float)i;
        health_post(board, &report);
    }
    return NULL;
}

static void a_report_is_never_half_of_two(void **state)
{
    (void)state;
    static health_board board;
    pthread_t poster;
    health_report r = {0};
    health_board_init(&board);
    assert_int_equal(pthread_create(&poster, NULL, post, &board), 0);
    while (r.sample_count < POSTS) {
        uint64_t last = r.sample_count;
        health_read(&board, &r);
        assert_true(r.sample_count >= last);
        assert_int_equal(r.gap_count, r.sample_count);
        assert_int_equal(r.refused_count, r.sample_count);
        assert_int_equal((uint64_t)r.saturated[MRT_MAX_CHANNELS - 1], r.sample_count);
    }
    pthread_join(poster, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rate_is_right_within_one_percent),
        cmocka_unit_test(jitter_is_the_deviation_of_intervals),
        cmocka_unit_test(lateness_is_the_way_from_measured_to_arrived),
        cmocka_unit_test(what_is_lost_on_the_way_is_counted),
        cmocka_unit_test(sequence_that_leaps_is_no_loss_of_billions),
        cmocka_unit_test(channels_at_their_ends_are_named),
        cmocka_unit_test(silence_is_told_and_what_was_fades_within_two_seconds),
        cmocka_unit_test(drift_is_right_within_five_ppm_though_arrivals_are_late),
        cmocka_unit_test(state_lasts_since_it_changed),
        cmocka_unit_test(a_report_is_never_half_of_two),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
