/* core/base/timecode.h: frames, times and labels convert exactly. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/timecode.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const int64_t second_ns = 1000000000;

static timecode_rate rate_of(const char *text)
{
    timecode_rate rate = {1, 1, false};
    error err;
    if (timecode_rate_parse(&rate, text, &err) < 0)
        fail_msg("%s", err.text);
    return rate;
}

typedef struct named_rate {
    const char *text;
    uint32_t num, den;
    bool is_drop;
} named_rate;

static void rates_are_what_people_mean(void **state)
{
    (void)state;
    static const named_rate rates[] = {
        {"24", 24, 1, false},
        {"25", 25, 1, false},
        {"29.97", 30000, 1001, false},
        {"29.97df", 30000, 1001, true},
        {"30", 30, 1, false},
        {"50", 50, 1, false},
        {"60", 60, 1, false},
        {"30000/1001", 30000, 1001, false},
        {"59.94df", 60000, 1001, true},
        {"23.976", 24000, 1001, false},
        {"23.98", 24000, 1001, false},
        {"23.97", 24000, 1001, false},
        {"119.88", 120000, 1001, false},
        {"12.5", 25, 2, false},
        {"50/2", 25, 1, false},
        {"1", 1, 1, false},
        {"1000", 1000, 1, false},
        {"29.5", 59, 2, false},
        {" 48 ", 48, 1, false},
        {"15.625", 125, 8, false},
    };
    for (size_t i = 0; i < sizeof rates / sizeof rates[0]; ++i) {
        timecode_rate rate = rate_of(rates[i].text);
        assert_int_equal(rate.num, rates[i].num);
        assert_int_equal(rate.den, rates[i].den);
        assert_int_equal(rate.is_drop, rates[i].is_drop);
    }
}

static void a_rate_survives_being_kept_as_a_number(void **state)
{
    (void)state;
    static const char *const texts[] = {"24", "25", "29.97", "30", "23.976", "59.94", "12.5"};
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; ++i) {
        timecode_rate rate = rate_of(texts[i]), back;
        error err;
        assert_int_equal(timecode_rate_of(&back, timecode_fps(rate), &err), MRT_OK);
        assert_int_equal(back.num, rate.num);
        assert_int_equal(back.den, rate.den);
    }
}

static void other_rates_are_refused(void **state)
{
    (void)state;
    static const char *const texts[] = {"",     "0",   "-25",  "1001",   "fast",      "25fps",
                                        "1e99", "nan", "30/0", "30/",    "/1001",     "1/30",
                                        "30df", "df",  "0x19", "30/1/1", "30000/1002"};
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; ++i) {
        timecode_rate rate;
        error err = {""};
        if (timecode_rate_parse(&rate, texts[i], &err) != MRT_ERR_ARGUMENT)
            fail_msg("\"%s\" was not refused", texts[i]);
        assert_true(err.text[0] && !strchr(err.text, '\n'));
    }
    timecode_rate rate;
    assert_int_equal(timecode_rate_of(&rate, (double)NAN, NULL), MRT_ERR_ARGUMENT);
}

static const char *const eight[] = {"24", "25", "29.97", "30", "50", "60", "23.976", "119.88"};

static void frames_and_times_agree_for_days_without_drift(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof eight / sizeof eight[0]; ++i) {
        timecode_rate rate = rate_of(eight[i]);
        int64_t last_ns = 0, last = timecode_frame(rate, 11 * 24 * 3600 * second_ns);
        for (int64_t frame = -100000; frame <= last; frame += frame < 100000 ? 1 : 7919) {
            int64_t time_ns = timecode_time_ns(rate, frame);
            assert_true(timecode_frame(rate, time_ns) == frame);
            assert_true(timecode_frame(rate, time_ns - 1) == frame - 1);
            assert_true(timecode_nearest_frame(rate, time_ns + 3) == frame);
            assert_true(timecode_nearest_frame(rate, time_ns - 3) == frame);
            assert_true(frame == -100000 || time_ns > last_ns);
            last_ns = time_ns;
        }
    }
}

static void whole_runs_of_frames_are_whole_seconds(void **state)
{
    (void)state;
    const int64_t eight_h = 8 * 3600;
    assert_true(timecode_time_ns(rate_of("25"), 25 * eight_h) == eight_h * second_ns);
    assert_true(timecode_time_ns(rate_of("29.97"), 30000 * 28) == 1001 * 28 * second_ns);
    assert_true(timecode_frame(rate_of("29.97"), 1001 * 28 * second_ns) == 30000 * 28);
    assert_true(timecode_time_ns(rate_of("60"), 1) == 16666667);
    assert_true(timecode_time_ns(rate_of("60"), -1) == -16666666);
    assert_true(timecode_time_ns(rate_of("29.97"), 1) == 33366667);
}

typedef struct label {
    const char *rate, *text;
    int64_t frame;
} label;

static void labels_are_those_of_the_standard(void **state)
{
    (void)state;
    static const label labels[] = {
        {"25", "00:00:00:00", 0},
        {"25", "01:02:03:04", ((3600 + 2 * 60 + 3) * 25) + 4},
        {"24", "23:59:59:23", 24 * 86400 - 1},
        {"30", "100:00:00:00", 30 * 360000},
        {"25", "-00:00:00:01", -1},
        {"29.97", "00:01:00:00", 1800},
        {"29.97df", "00:00:59;29", 1799},
        {"29.97df", "00:01:00;02", 1800},
        {"29.97df", "00:09:59;29", 17981},
        {"29.97df", "00:10:00;00", 17982},
        {"29.97df", "00:11:00;02", 17982 + 1800},
        {"29.97df", "01:00:00;00", 107892},
        {"29.97df", "24:00:00;00", 2589408},
        {"59.94df", "00:01:00;04", 3600},
        {"59.94df", "01:00:00;00", 215784},
        {"119.88", "00:00:01:000", 120},
        {"12.5", "00:00:01:00", 13},
    };
    for (size_t i = 0; i < sizeof labels / sizeof labels[0]; ++i) {
        timecode_rate rate = rate_of(labels[i].rate);
        char text[TIMECODE_TEXT];
        int64_t frame = -7;
        error err = {""};
        timecode_write(text, rate, labels[i].frame);
        assert_string_equal(text, labels[i].text);
        assert_int_equal(timecode_parse(&frame, rate, labels[i].text, &err), MRT_OK);
        assert_true(frame == labels[i].frame);
    }
}

static void every_label_of_a_day_reads_back(void **state)
{
    (void)state;
    static const char *const texts[] = {"29.97df", "59.94df", "29.97", "24"};
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; ++i) {
        timecode_rate rate = rate_of(texts[i]);
        int64_t day = timecode_frame(rate, 86400 * second_ns);
        for (int64_t frame = -40000; frame < day; frame += frame < 40000 ? 1 : 61) {
            char text[TIMECODE_TEXT];
            int64_t back;
            timecode_write(text, rate, frame);
            if (timecode_parse(&back, rate, text, NULL) < 0 || back != frame)
                fail_msg("%s at %s is not frame %lld", text, texts[i], (long long)frame);
        }
    }
}

static void drop_frame_labels_stay_with_the_clock(void **state)
{
    (void)state;
    timecode_rate rate = rate_of("29.97df");
    for (int64_t hour = 0; hour <= 8; ++hour) {
        char text[TIMECODE_TEXT];
        int64_t frame;
        (void)snprintf(text, sizeof text, "%02d:00:00;00", (int)hour);
        assert_int_equal(timecode_parse(&frame, rate, text, NULL), MRT_OK);
        int64_t off_ns = timecode_time_ns(rate, frame) - hour * 3600 * second_ns;
        assert_true(off_ns <= 0 && off_ns > -30000000); /* 3.6 ms an hour, by the standard */
    }
}

static void other_labels_are_refused(void **state)
{
    (void)state;
    static const label labels[] = {
        {"25", "", 0},
        {"25", "01:02:03", 0},
        {"25", "01:02:03:25", 0},
        {"25", "01:02:60:00", 0},
        {"25", "01:60:00:00", 0},
        {"25", "01:02:03;04", 0},
        {"25", "01:02:03:04:05", 0},
        {"25", "01:02:03:", 0},
        {"25", "01:02:-3:04", 0},
        {"25", "1000:00:00:00", 0},
        {"25", "--01:02:03:04", 0},
        {"29.97df", "01:02:03:04", 0},
        {"29.97df", "00:01:00;00", 0},
        {"29.97df", "00:01:00;01", 0},
        {"59.94df", "00:59:00;03", 0},
    };
    for (size_t i = 0; i < sizeof labels / sizeof labels[0]; ++i) {
        int64_t frame;
        error err = {""};
        if (timecode_parse(&frame, rate_of(labels[i].rate), labels[i].text, &err) !=
            MRT_ERR_ARGUMENT)
            fail_msg("\"%s\" at %s was not refused", labels[i].text, labels[i].rate);
        assert_non_null(strstr(err.text, "it reads like 01:02:03"));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rates_are_what_people_mean),
        cmocka_unit_test(a_rate_survives_being_kept_as_a_number),
        cmocka_unit_test(other_rates_are_refused),
        cmocka_unit_test(frames_and_times_agree_for_days_without_drift),
        cmocka_unit_test(whole_runs_of_frames_are_whole_seconds),
        cmocka_unit_test(labels_are_those_of_the_standard),
        cmocka_unit_test(every_label_of_a_day_reads_back),
        cmocka_unit_test(drop_frame_labels_stay_with_the_clock),
        cmocka_unit_test(other_labels_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
