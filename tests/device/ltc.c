/* Linear time code: what is sounded is counted, at each rate of the trade, loud and soft, upside
 * down, with noise, fast and slow; the plugin on a pipe. */
#define _XOPEN_SOURCE 700
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "input_host.h"
#include "ltc_sound.h"
#include "voice/ltc_decode.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

enum { RATE = 48000 };
static const int64_t s_ns = 1000000000;

typedef struct heard {
    ltc_frame first, last;
    uint32_t count, broken; /* frames that do not follow the one before */
    double worst;           /* samples off a steady pace */
} heard;

static heard hear(ltc_sound *of, ltc_decoder *by, double seconds, double gain, double offset,
                  double noise)
{
    heard out = {.count = 0};
    uint32_t seed = 7;
    for (int64_t i = 0; i < (int64_t)(seconds * of->rate_hz); ++i) {
        ltc_frame frame;
        seed = seed * 1664525 + 1013904223;
        const double hiss = noise * ((double)(seed >> 8) / (1 << 23) - 1.0);
        if (!ltc_decoder_add_sample(by, gain * ltc_sound_next(of) + offset + hiss, &frame))
            continue;
        if (out.count == 0) {
            out.first = frame;
        } else {
            const double length = of->rate_hz / (of->fps * of->speed);
            const double steady =
                out.first.start_sample + (double)(frame.frame - out.first.frame) * length;
            out.broken += frame.frame != out.last.frame + 1;
            out.worst = fmax(out.worst, fabs(frame.start_sample - steady));
        }
        out.last = frame;
        out.count += 1;
    }
    return out;
}

static void every_rate_is_counted_from_the_label(void **state)
{
    (void)state;
    static const struct {
        double fps, rate_hz;
        bool is_drop;
        int32_t frame; /* of 01:00:59:10 */
    } all[] = {{24000.0 / 1001.0, 48000, false, 3659 * 24 + 10},
               {24.0, 44100, false, 3659 * 24 + 10},
               {25.0, 48000, false, 3659 * 25 + 10},
               {30000.0 / 1001.0, 48000, false, 3659 * 30 + 10},
               {30000.0 / 1001.0, 96000, true, 3659 * 30 + 10 - 2 * 54},
               {30.0, 48000, false, 3659 * 30 + 10}};
    for (size_t k = 0; k < sizeof all / sizeof *all; ++k) {
        ltc_decoder decoder;
        ltc_sound sound = ltc_sound_make(all[k].rate_hz, all[k].fps, all[k].is_drop, 1, 0, 59, 10);
        ltc_decoder_init(&decoder, all[k].rate_hz);
        const heard got = hear(&sound, &decoder, 5.0, 0.5, 0.0, 0.0);
        assert_true(got.count > 5 * 23 - 12);
        assert_int_equal(got.broken, 0);
        assert_int_equal(got.first.is_drop, all[k].is_drop);
        assert_true(fabs(got.last.rate - all[k].fps) < 1e-9);
        /* The first frame began with the first sample. */
        const double length = all[k].rate_hz / all[k].fps;
        const double began = (double)(got.last.frame - all[k].frame) * length;
        if (fabs(got.last.start_sample - began) > 3.0)
            fail_msg("%g a second: %.1f samples off", all[k].fps, got.last.start_sample - began);
        if (got.worst > 1.0)
            fail_msg("%g a second: %.2f samples unsteady", all[k].fps, got.worst);
    }
}

static void level_polarity_offset_and_noise_do_not_matter(void **state)
{
    (void)state;
    static const double gain[] = {0.9, 0.01, -0.3, 0.3, 0.3}, offset[] = {0, 0, 0, 0.4, 0},
                        noise[] = {0, 0, 0, 0, 0.05};
    for (int k = 0; k < 5; ++k) {
        ltc_decoder decoder;
        ltc_sound sound = ltc_sound_make(RATE, 25.0, false, 10, 0, 0, 0);
        ltc_decoder_init(&decoder, RATE);
        (void)hear(&sound, &decoder, 1.0, gain[k], offset[k], noise[k]); /* an offset settles */
        const heard got = hear(&sound, &decoder, 4.0, gain[k], offset[k], noise[k]);
        if (got.count < 99 || got.broken || got.last.rate != 25.0)
            fail_msg("case %d: %u frames, %u broken, %g a second", k, got.count, got.broken,
                     got.last.rate);
    }
}

static void a_tape_may_run_fast_and_slow_and_jump(void **state)
{
    (void)state;
    ltc_decoder decoder;
    ltc_sound sound = ltc_sound_make(RATE, 25.0, false, 0, 0, 0, 0);
    ltc_decoder_init(&decoder, RATE);
    (void)hear(&sound, &decoder, 2.0, 0.5, 0, 0);
    sound.speed = 1.4;
    heard got = hear(&sound, &decoder, 3.0, 0.5, 0, 0);
    assert_true(got.count > 80 && got.last.frame > 110);
    sound.speed = 1.0;
    sound.hour = 7;
    sound.minute = sound.second = sound.frame = 0;
    sound.into = 0.0;
    ltc_sound_fill(&sound);
    got = hear(&sound, &decoder, 3.0, 0.5, 0, 0);
    assert_true(got.last.frame >= 7 * 3600 * 25 + 70 && got.last.frame <= 7 * 3600 * 25 + 75);
}

static void what_is_no_time_code_says_nothing(void **state)
{
    (void)state;
    ltc_decoder decoder;
    ltc_frame frame;
    uint32_t seed = 3;
    ltc_decoder_init(&decoder, RATE);
    for (int64_t i = 0; i < 60 * RATE; ++i) {
        seed = seed * 1664525 + 1013904223;
        const double hiss = (double)(seed >> 8) / (1 << 23) - 1.0;
        const double tone = sin((double)i * 0.26);
        assert_false(ltc_decoder_add_sample(&decoder,
                                            i < 20 * RATE   ? hiss
                                            : i < 40 * RATE ? tone
                                                            : 0.0,
                                            &frame));
    }
}

/* ---- the plugin, on a pipe ---- */

static void frames_come_out_of_a_pipe_when_they_began(void **state)
{
    (void)state;
    char folder[64] = "/tmp/marotte_ltc_XXXXXX", path[96];
    int16_t block[480];
    mrt_sample sample = {0};
    uint32_t count = 0;
    int64_t last_ns = 0;
    float last = 0.0f;
    assert_non_null(mkdtemp(folder));
    (void)snprintf(path, sizeof path, "%s/pipe", folder);
    assert_int_equal(mkfifo(path, 0600), 0);
    const int writer = open(path, O_RDWR | O_NONBLOCK);
    input_host *host = input_host_create(BUILD_DIR "/plugins/ltc.so");
    assert_int_equal(input_host_open(host, path), MRT_OK);
    ltc_sound sound = ltc_sound_make(RATE, 30000.0 / 1001.0, true, 23, 59, 0, 0);
    for (int i = 0; i < 300; ++i) {
        for (int k = 0; k < 480; ++k)
            block[k] = (int16_t)lrint(20000.0 * ltc_sound_next(&sound));
        assert_int_equal(write(writer, block, sizeof block), sizeof block);
        while (input_host_read(host, 0, &sample) == MRT_OK) {
            assert_int_equal(sample.count, 2);
            assert_true(fabs((double)sample.value[1] + 30000.0 / 1001.0) < 1e-4);
            assert_true(count == 0 || fabs((double)(sample.value[0] - last) - 1.0) < 0.5);
            assert_true(sample.time_ns >= last_ns);
            assert_true(sample.time_ns <= input_host_now_ns(&host->host));
            last = sample.value[0];
            last_ns = sample.time_ns;
            count += 1;
        }
    }
    assert_true(count > 75);
    /* 23:59:00:00, counted: two labels are left out in each minute but the tenth. */
    const double expected = (23 * 60 + 59) * 1800.0 - 2.0 * (1439 - 143) + 3.0 * 30000.0 / 1001.0;
    assert_true(fabs((double)last - expected) < 1.5);
    assert_int_equal(input_host_read(host, s_ns / 100, &sample), MRT_TIMEOUT);
    input_host_destroy(host);
    close(writer);
    unlink(path);
    rmdir(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_rate_is_counted_from_the_label),
        cmocka_unit_test(level_polarity_offset_and_noise_do_not_matter),
        cmocka_unit_test(a_tape_may_run_fast_and_slow_and_jump),
        cmocka_unit_test(what_is_no_time_code_says_nothing),
        cmocka_unit_test(frames_come_out_of_a_pipe_when_they_began),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
