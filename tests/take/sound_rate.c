/* Sound at another rate, by what is in it: a tone keeps its frequency, level and phase, what is
 * added lies below hearing, and where one begins to ask makes no difference. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <string.h>

#include "show/sound_rate.h"

static const double level = 0.5, two_pi = 6.283185307179586;
enum { COUNT = 48000, PIECE = 777 };
static float got[COUNT], again[COUNT];

typedef struct tone {
    double hz, rate_hz;
} tone;

/* Left the tone, right nothing. */
static void tone_frames(void *data, int64_t first, float *out, size_t count)
{
    const tone *self = data;
    for (size_t i = 0; i < count; ++i) {
        double cycles = fmod((double)(first + (int64_t)i) * self->hz, self->rate_hz);
        out[2 * i] = (float)(level * sin(two_pi * cycles / self->rate_hz));
        out[2 * i + 1] = 0.0f;
    }
}

static sound_rate *rate_of(tone *source, uint32_t to_hz)
{
    error err = {""};
    sound_rate *self;
    assert_int_equal(
        sound_rate_create(&self, (uint32_t)source->rate_hz, to_hz, 2, tone_frames, source, &err),
        MRT_OK);
    return self;
}

static void read_left(sound_rate *self, int64_t first, float *out, size_t count)
{
    static float piece[2 * PIECE];
    for (size_t at = 0; at < count; at += PIECE) {
        size_t length = count - at < PIECE ? count - at : PIECE;
        sound_rate_frames(self, first + (int64_t)at, piece, length);
        for (size_t i = 0; i < length; ++i) {
            out[at + i] = piece[2 * i];
            assert_true(piece[2 * i + 1] == 0.0f);
        }
    }
}

/* What of `out` is this frequency, by correlation over whole periods; what is left is written back.
 */
static double take_away(float *out, int64_t first, size_t count, double hz, double rate_hz,
                        double *out_late_frames)
{
    double with_sin = 0, with_cos = 0;
    for (size_t i = 0; i < count; ++i) {
        double angle = two_pi * fmod((double)(first + (int64_t)i) * hz, rate_hz) / rate_hz;
        with_sin += (double)out[i] * sin(angle) * 2.0 / (double)count;
        with_cos += (double)out[i] * cos(angle) * 2.0 / (double)count;
    }
    for (size_t i = 0; i < count; ++i) {
        double angle = two_pi * fmod((double)(first + (int64_t)i) * hz, rate_hz) / rate_hz;
        out[i] -= (float)(with_sin * sin(angle) + with_cos * cos(angle));
    }
    *out_late_frames = -atan2(with_cos, with_sin) / two_pi * rate_hz / hz;
    return hypot(with_sin, with_cos);
}

static double db(double value, double of)
{
    return 20.0 * log10(fmax(value, 1e-12) / of);
}

static void check_tone(double hz, double from_hz, double to_hz, int64_t first, double level_db,
                       double rest_db)
{
    tone source = {hz, from_hz};
    sound_rate *self = rate_of(&source, (uint32_t)to_hz);
    size_t count = (size_t)to_hz;
    double late, worst = 0;
    read_left(self, first, got, count);
    double left = take_away(got, first, count, hz, to_hz, &late);
    for (size_t i = 0; i < count; ++i)
        worst = fmax(worst, fabs((double)got[i]));
    print_message(
        "%5.0f Hz from %.0f to %.0f Hz at frame %lld: level %+.4f dB, %+.1e frames late, the "
        "rest below %.0f dB\n",
        hz, from_hz, to_hz, (long long)first, db(left, level), late, db(worst, level));
    assert_true(fabs(db(left, level)) < level_db);
    assert_true(fabs(late) < 1e-3);
    assert_true(db(worst, level) < rest_db);
    sound_rate_destroy(self);
}

static void a_tone_keeps_frequency_level_and_phase(void **state)
{
    (void)state;
    check_tone(1000, 44100, 48000, 0, 0.1, -80);
    check_tone(1000, 48000, 44100, 0, 0.1, -80);
    check_tone(17000, 44100, 48000, 0, 0.1, -80);
    check_tone(17000, 48000, 44100, 0, 0.1, -80);
    check_tone(1000, 8000, 48000, 0, 0.1, -80);
    check_tone(1000, 48000, 8000, 0, 0.1, -80);
    check_tone(1000, 47999, 48000, -100000, 0.1, -80);
    /* after an hour, and a day before the timeline begins */
    check_tone(1000, 44100, 48000, (int64_t)3600 * 48000 + 11, 0.1, -80);
    check_tone(1000, 44100, 48000, (int64_t)-86400 * 48000 - 7, 0.1, -80);
}

static void what_the_lower_rate_cannot_hold_goes(void **state)
{
    (void)state;
    tone source = {23000, 48000};
    double worst = 0;
    sound_rate *self = rate_of(&source, 44100);
    read_left(self, 0, got, 44100);
    for (int i = 0; i < 44100; ++i)
        worst = fmax(worst, fabs((double)got[i]));
    print_message("23 kHz to 44.1 kHz: %.0f dB\n", db(worst, level));
    assert_true(db(worst, level) < -80);
    sound_rate_destroy(self);
}

/* A minute without a break is where asking for its last second alone has it: over an hour less than
 * a thousandth of a frame would be missing. */
static void it_does_not_drift(void **state)
{
    (void)state;
    static float piece[2 * PIECE];
    tone source = {1000, 44100};
    sound_rate *self = rate_of(&source, 48000);
    enum { LAST = 60 * COUNT };
    double late, worst = 0;
    int64_t at = 0;
    for (; at + PIECE <= LAST; at += PIECE)
        sound_rate_frames(self, at, piece, PIECE);
    read_left(self, at, got, COUNT);
    sound_rate_frames(self, 12345, piece, PIECE);
    read_left(self, at, again, COUNT);
    for (int i = 0; i < COUNT; ++i)
        worst = fmax(worst, fabs((double)got[i] - (double)again[i]));
    (void)take_away(got, at, COUNT, 1000, 48000, &late);
    print_message("after a minute: %+.1e frames late, off by %.1e from begun anew\n", late, worst);
    assert_true(fabs(late) < 1e-3 / 60.0);
    assert_true(worst < 1e-6);
    sound_rate_destroy(self);
}

static void rates_that_cannot_be_are_refused(void **state)
{
    (void)state;
    error err = {""};
    tone source = {1000, 44100};
    sound_rate *self;
    assert_true(sound_rate_create(&self, 0, 48000, 2, tone_frames, &source, &err) < 0);
    assert_true(sound_rate_create(&self, 44100, 0, 2, tone_frames, &source, &err) < 0);
    assert_true(sound_rate_create(&self, 100, 48000, 2, tone_frames, &source, &err) < 0);
    assert_null(self);
    assert_non_null(strstr(err.text, "100 Hz to 48000 Hz"));
    sound_rate_destroy(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_tone_keeps_frequency_level_and_phase),
        cmocka_unit_test(what_the_lower_rate_cannot_hold_goes),
        cmocka_unit_test(it_does_not_drift),
        cmocka_unit_test(rates_that_cannot_be_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
