/* A loudspeaker's clock is not the samples' clock: what is heard keeps to the latter all the same.
 * Each frame of the sound is its own number, so that what is heard says which frame it is, and a
 * second channel is constant, so that it says how loudly. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "sound_help.h"
#include "stage/sound/sound_follow.h"

enum { RATE = 48000, PERIOD = 1 << 19 };
static const int64_t start_ns = 7000000000000;

typedef struct bench {
    fake_clock clock;
    sound_board board;
    ring *packets;
    sound_follow follow;
    sound_motion motion;
    int64_t fed; /* frames of the stream */
    unsigned char record[sizeof(sound_packet) + SOUND_PACKET_FRAMES * 2 * sizeof(float)];
    int64_t frame; /* of the device */
    float out[FAKE_BLOCK * 2];
    double worst_ms; /* of what was heard since it was set to 0 */
    int64_t heard, silent;
    float steepest; /* step from one frame heard to the next */
    float last;
} bench;

static void bench_start(bench *b, double ppm, int64_t jitter_ns)
{
    error err = {""};
    *b = (bench){
        .clock = {.start_ns = start_ns, .rate_hz = RATE, .ppm = ppm, .jitter_ns = jitter_ns}};
    assert_int_equal(sound_follow_record_size(2), sizeof b->record);
    b->packets = ring_create(sizeof b->record, SOUND_PACKETS);
    assert_non_null(b->packets);
    assert_int_equal(sound_follow_init(&b->follow, RATE, 2, b->packets, &b->board, &err), MRT_OK);
}

static void bench_end(bench *b)
{
    sound_follow_finish(&b->follow);
    ring_destroy(b->packets);
}

static void move(bench *b, double speed, int64_t host_ns)
{
    b->motion.revision += 1;
    b->motion.host_ns = host_ns;
    b->motion.speed = speed;
    sound_board_post(&b->board, &b->motion);
    b->fed = 0;
}

/* As full as the ring gets, like the thread that reads from the show. */
static void feed(bench *b)
{
    for (;;) {
        sound_packet packet = {.revision = b->motion.revision,
                               .first = b->fed,
                               .count = SOUND_PACKET_FRAMES,
                               .rate_hz = RATE};
        float *samples = (float *)(void *)(b->record + sizeof packet);
        for (int i = 0; i < SOUND_PACKET_FRAMES; ++i) {
            samples[2 * i] = (float)((b->fed + i) % PERIOD) / (float)(2 * PERIOD);
            samples[2 * i + 1] = 0.5f;
        }
        memcpy(b->record, &packet, sizeof packet);
        if (!ring_push(b->packets, b->record))
            return;
        b->fed += SOUND_PACKET_FRAMES;
    }
}

static double now_ns(const bench *b)
{
    return (double)b->clock.start_ns + fake_time_ns(&b->clock, b->frame);
}

/* How late frame i of the block is; false near where the numbers begin anew, and while it fades in
 * or out. */
static bool lateness(const bench *b, int64_t i, double *out_frames)
{
    double heard_ns =
        fake_time_ns(&b->clock, b->frame + i) + (double)(b->clock.start_ns - b->motion.host_ns);
    double part = fmod(heard_ns * RATE / 1e9, PERIOD);
    double number = (double)b->out[2 * i] * 2 * PERIOD;
    if (part < 1000 || part > PERIOD - 1000 || fabsf(b->out[2 * i + 1] - 0.5f) > 1e-5f)
        return false;
    *out_frames = part - number;
    if (*out_frames < -PERIOD / 2)
        *out_frames += PERIOD;
    if (*out_frames > PERIOD / 2)
        *out_frames -= PERIOD;
    return true;
}

static void judge(bench *b)
{
    for (int i = 0; i < FAKE_BLOCK; ++i) {
        double frames;
        float step = fabsf(b->out[2 * i] - b->last);
        bool is_whole = lateness(b, i, &frames);
        b->silent += b->out[2 * i + 1] == 0.0f;
        b->heard += b->out[2 * i + 1] != 0.0f;
        if (is_whole)
            b->worst_ms = fmax(b->worst_ms, fabs(frames) * 1000.0 / RATE);
        if (is_whole && step < 0.2f)
            b->steepest = fmaxf(b->steepest, step);
        b->last = b->out[2 * i];
    }
}

static void run_block(bench *b, sound_break is_broken)
{
    feed(b);
    sound_follow_fill(&b->follow, b->out, FAKE_BLOCK, 2, fake_told_ns(&b->clock, b->frame),
                      is_broken);
    judge(b);
    b->frame += FAKE_BLOCK;
}

static void run_s(bench *b, double seconds)
{
    int64_t until = b->frame + (int64_t)(seconds * RATE);
    while (b->frame < until)
        run_block(b, SOUND_GOES_ON);
}

static void ten_minutes(bench *b, double ppm, int64_t jitter_ns)
{
    bench_start(b, ppm, jitter_ns);
    run_s(b, 1.0); /* the device was opened before */
    move(b, 1.0, (int64_t)now_ns(b));
    run_s(b, 600.0);
    print_message(
        "%+4.0f ppm, blocks told %.0f ms wrong: worst %.3f ms, drift seen %+.1f ppm, %llu "
        "frames spliced, %u jumps\n",
        ppm, (double)jitter_ns / 1e6, b->worst_ms, (double)b->follow.count.drift_ppb / 1000.0,
        (unsigned long long)b->follow.count.spliced, b->follow.count.jumped);
}

static void sound_keeps_within_a_millisecond_of_a_clock_200_ppm_off(void **state)
{
    static const struct kind {
        double ppm;
        int64_t jitter_ns;
    } kinds[] = {{200, 0}, {200, 2000000}, {-200, 2000000}, {37, 2000000}, {0, 2000000}};
    (void)state;
    const size_t step = getenv("MAROTTE_TEST_LONG") ? 1 : 2;
    for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k += step) {
        bench b;
        ten_minutes(&b, kinds[k].ppm, kinds[k].jitter_ns);
        assert_true(b.worst_ms < 1.0);
        assert_true(fabs((double)b.follow.count.drift_ppb / 1000.0 - kinds[k].ppm) < 5.0);
        assert_int_equal(b.follow.count.jumped, 0);
        assert_int_equal(b.follow.count.starved, 0);
        assert_true(b.heard > 599 * RATE);
        /* 200 ppm of ten minutes are 5760 frames; what jitter moves to and fro is little. */
        double needed = fabs(kinds[k].ppm) * 1e-6 * 600 * RATE;
        assert_true((double)b.follow.count.spliced > needed - 60.0);
        assert_true((double)b.follow.count.spliced < needed + 600.0);
        bench_end(&b);
    }
}

static void without_correction_it_would_be_off_by_a_tenth_of_a_second(void **state)
{
    bench b;
    (void)state;
    bench_start(&b, 200, 0);
    b.follow.band_frames = b.follow.jump_frames = 1e12;
    run_s(&b, 1.0);
    move(&b, 1.0, (int64_t)now_ns(&b));
    run_s(&b, 600.0);
    assert_true(b.worst_ms > 110.0);
    assert_true(b.worst_ms < 125.0);
    assert_int_equal(b.follow.count.spliced, 0);
    bench_end(&b);
}

static void a_splice_is_no_click(void **state)
{
    bench b;
    (void)state;
    bench_start(&b, 200, 0);
    run_s(&b, 2.0);
    move(&b, 1.0, (int64_t)now_ns(&b));
    run_s(&b, 1.0);
    b.steepest = 0.0f;
    run_s(&b, 5.0);
    /* From frame to frame the numbers grow by 1, in a splice by 1 + 1 / 241 at most. */
    assert_true(b.follow.count.spliced > 40);
    assert_true(b.steepest * (2 * PERIOD) < 1.3f);
    bench_end(&b);
}

static void sound_begins_when_the_transport_does_and_pauses_with_it(void **state)
{
    bench b;
    (void)state;
    bench_start(&b, -80, 500000);
    run_s(&b, 2.0);
    assert_int_equal(b.heard, 0);
    move(&b, 1.0, (int64_t)now_ns(&b) + 250000000); /* in a quarter of a second */
    b.silent = 0;
    run_s(&b, 1.0);
    assert_true(llabs(b.silent - RATE / 4) < FAKE_BLOCK);
    move(&b, 0.0, 0);
    run_block(&b, SOUND_GOES_ON);
    b.heard = 0;
    run_s(&b, 1.0);
    assert_int_equal(b.heard, 0);
    assert_true(b.worst_ms < 1.0);
    bench_end(&b);
}

static void other_speeds_are_silent(void **state)
{
    bench b;
    (void)state;
    bench_start(&b, 0, 0);
    run_s(&b, 1.0);
    move(&b, 0.5, (int64_t)now_ns(&b));
    run_s(&b, 1.0);
    move(&b, 2.0, (int64_t)now_ns(&b));
    run_s(&b, 1.0);
    assert_int_equal(b.heard, 0);
    move(&b, 1.0, (int64_t)now_ns(&b));
    run_s(&b, 1.0);
    assert_true(b.heard > RATE * 9 / 10);
    bench_end(&b);
}

static void a_seek_is_followed_at_once(void **state)
{
    bench b;
    (void)state;
    bench_start(&b, 100, 0);
    run_s(&b, 5.0);
    move(&b, 1.0, (int64_t)now_ns(&b));
    run_s(&b, 3.0);
    move(&b, 1.0, (int64_t)now_ns(&b) - 100000000000); /* to 100 s of the timeline */
    b.fed = 4800000;                                   /* who feeds it begins where it is needed */
    run_block(&b, SOUND_GOES_ON);
    b.silent = 0;
    b.worst_ms = 0;
    run_s(&b, 3.0);
    assert_true(b.silent < RATE / 100);
    assert_true(b.worst_ms < 1.0);
    bench_end(&b);
}

static void a_device_that_ran_dry_is_caught_up_with(void **state)
{
    bench b;
    (void)state;
    bench_start(&b, 50, 300000);
    run_s(&b, 5.0);
    move(&b, 1.0, (int64_t)now_ns(&b));
    run_s(&b, 5.0);
    b.clock.start_ns += 40000000; /* 40 ms of silence that nobody asked for */
    run_block(&b, SOUND_BROKEN);
    assert_int_equal(b.follow.count.broken, 1);
    run_s(&b, 1.0);
    assert_true(b.follow.count.jumped >= 1);
    b.worst_ms = 0;
    run_s(&b, 5.0);
    assert_true(b.worst_ms < 1.0);
    bench_end(&b);
}

/* The same without a word from the device. */
static void a_device_that_stood_still_in_silence_is_caught_up_with(void **state)
{
    bench b;
    (void)state;
    bench_start(&b, 50, 300000);
    run_s(&b, 5.0);
    move(&b, 1.0, (int64_t)now_ns(&b));
    run_s(&b, 5.0);
    b.clock.start_ns += 40000000;
    run_s(&b, 1.0);
    b.worst_ms = 0;
    run_s(&b, 5.0);
    assert_int_equal(b.follow.clock.jump_count, 1);
    assert_true(b.worst_ms < 1.0);
    bench_end(&b);
}

static void frames_that_come_too_late_are_a_gap_that_is_counted(void **state)
{
    bench b;
    (void)state;
    bench_start(&b, 0, 0);
    run_s(&b, 1.0);
    move(&b, 1.0, (int64_t)now_ns(&b));
    run_s(&b, 1.0);
    b.silent = 0;
    for (int i = 0; i < 94; ++i) { /* a second in which nothing is fed */
        sound_follow_fill(&b.follow, b.out, FAKE_BLOCK, 2, fake_told_ns(&b.clock, b.frame),
                          SOUND_GOES_ON);
        judge(&b);
        b.frame += FAKE_BLOCK;
    }
    assert_int_equal(b.follow.count.starved, 1);
    assert_true(b.silent > RATE / 3);
    b.fed = b.follow.wanted;
    b.worst_ms = 0;
    b.silent = 0;
    run_s(&b, 2.0);
    assert_true(b.silent < RATE / 50);
    assert_true(b.worst_ms < 1.0);
    bench_end(&b);
}

static void absurd_times_of_a_device_do_no_harm(void **state)
{
    static const int64_t absurd[] = {0, INT64_MAX / 2, INT64_MIN / 2, 1, -1};
    bench b;
    (void)state;
    bench_start(&b, 0, 0);
    run_s(&b, 1.0);
    move(&b, 1.0, (int64_t)now_ns(&b));
    for (int i = 0; i < 200; ++i) {
        feed(&b);
        sound_follow_fill(&b.follow, b.out, FAKE_BLOCK, 2, absurd[i % 5], (sound_break)(i % 2));
        for (int k = 0; k < 2 * FAKE_BLOCK; ++k)
            assert_true(isfinite(b.out[k]) && fabsf(b.out[k]) <= 1.0f);
        b.frame += FAKE_BLOCK;
    }
    move(&b, 1.0, (int64_t)now_ns(&b));
    run_s(&b, 12.0);
    b.worst_ms = 0;
    run_s(&b, 2.0);
    assert_true(b.worst_ms < 1.0);
    assert_true(b.follow.count.is_heard);
    bench_end(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sound_keeps_within_a_millisecond_of_a_clock_200_ppm_off),
        cmocka_unit_test(without_correction_it_would_be_off_by_a_tenth_of_a_second),
        cmocka_unit_test(a_splice_is_no_click),
        cmocka_unit_test(sound_begins_when_the_transport_does_and_pauses_with_it),
        cmocka_unit_test(other_speeds_are_silent),
        cmocka_unit_test(a_seek_is_followed_at_once),
        cmocka_unit_test(a_device_that_ran_dry_is_caught_up_with),
        cmocka_unit_test(a_device_that_stood_still_in_silence_is_caught_up_with),
        cmocka_unit_test(frames_that_come_too_late_are_a_gap_that_is_counted),
        cmocka_unit_test(absurd_times_of_a_device_do_no_harm),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
