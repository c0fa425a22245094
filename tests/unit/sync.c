/* How late a mouth is: sync_find on curves whose offset is known. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "stage/playback/sync.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { COUNT = 10 * SYNC_RATE, SYLLABLES = 40 };

static double random_share(uint32_t *state)
{
    *state = *state * 1664525u + 1013904223u;
    return (double)*state / 4294967296.0;
}

/* Writes a mouth that speaks about four syllables a second, `late_s` later. */
static void speak(float out[COUNT], double late_s, uint32_t seed)
{
    double at_s = 0.4, peak_s[SYLLABLES], size[SYLLABLES];
    for (int i = 0; i < SYLLABLES; ++i) {
        at_s += 0.16 + 0.14 * random_share(&seed) + (random_share(&seed) > 0.85 ? 0.5 : 0.0);
        peak_s[i] = at_s;
        size[i] = 0.3 + 0.7 * random_share(&seed);
    }
    for (int i = 0; i < COUNT; ++i) {
        out[i] = 0.0f;
        for (int k = 0; k < SYLLABLES; ++k) {
            const double x = ((double)i / SYNC_RATE - late_s - peak_s[k]) / 0.06;
            out[i] += (float)(size[k] * exp(-x * x));
        }
    }
}

static void an_offset_is_found_within_10_ms(void **state)
{
    static float mouth[COUNT], voice[COUNT];
    double worst_ms = 0.0;
    uint32_t seed = 7;
    (void)state;
    speak(voice, 0.0, 3);
    for (int late_ms = -200; late_ms <= 200; late_ms += 13) {
        sync_offset found;
        speak(mouth, 1e-3 * late_ms, 3);
        for (int i = 0; i < COUNT; ++i) /* a noisy hand, which has a range of its own */
            mouth[i] = 0.2f + 0.3f * mouth[i] + 0.05f * (float)(random_share(&seed) - 0.5);
        sync_find(&found, mouth, voice, COUNT);
        assert_true(found.is_clear);
        worst_ms = fmax(worst_ms, fabs((double)found.late_ns / 1e6 - late_ms));
    }
    print_message("offset: %.1f ms off at most between -200 and 200 ms\n", worst_ms);
    assert_true(worst_ms <= 10.0);
}

static void curves_that_have_nothing_in_common_have_no_clear_offset(void **state)
{
    static float mouth[COUNT], voice[COUNT], still[COUNT];
    sync_offset found;
    (void)state;
    speak(voice, 0.0, 3);
    for (uint32_t other = 20; other < 30; ++other) {
        speak(mouth, 0.0, other);
        sync_find(&found, mouth, voice, COUNT);
        assert_false(found.is_clear);
    }
    sync_find(&found, still, voice, COUNT);
    assert_false(found.is_clear);
    sync_find(&found, voice, still, COUNT);
    assert_false(found.is_clear);
    sync_find(&found, voice, voice, 20); /* too short */
    assert_false(found.is_clear);
}

static void the_words_name_the_direction(void **state)
{
    sync_offset of = {.is_clear = true, .late_ns = 34000000};
    (void)state;
    assert_string_equal(sync_describe(&of).text, "The mouth is 34 ms late");
    of.late_ns = -12400000;
    assert_string_equal(sync_describe(&of).text, "The mouth is 12 ms early");
    of.late_ns = 0;
    assert_string_equal(sync_describe(&of).text, "The mouth is on time");
    of.is_clear = false;
    assert_non_null(strstr(sync_describe(&of).text, "No clear offset"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_offset_is_found_within_10_ms),
        cmocka_unit_test(curves_that_have_nothing_in_common_have_no_clear_offset),
        cmocka_unit_test(the_words_name_the_direction),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
