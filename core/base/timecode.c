#include "base/timecode.h"

#include "base/text.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { NTSC_DEN = 1001, DECIMALS = 1000, NUM_MAX = 1000000, HOURS_MAX = 999 };
static const int64_t second_ns = 1000000000;

static uint32_t common_divisor(uint32_t a, uint32_t b)
{
    while (b) {
        uint32_t rest = a % b;
        a = b;
        b = rest;
    }
    return a;
}

static timecode_rate lowest_terms(uint32_t num, uint32_t den)
{
    uint32_t divisor = common_divisor(num, den);
    return (timecode_rate){.num = num / divisor, .den = den / divisor};
}

/* ---- rates ---- */

/* Finds 24000/1001 and similar rates in the form that people write: rounded or cut to two or more
 * decimals. */
static bool find_ntsc(timecode_rate *out, double fps)
{
    static const uint32_t nominal[] = {24, 30, 48, 60, 120, 240};
    for (size_t i = 0; i < sizeof nominal / sizeof nominal[0]; ++i) {
        double exact = nominal[i] * 1000.0 / NTSC_DEN;
        double nearest = floor(exact * 100.0 + 0.5) / 100.0, cut = floor(exact * 100.0) / 100.0;
        if (fabs(fps - exact) > 0.001 && fps != nearest && fps != cut)
            continue;
        *out = (timecode_rate){.num = nominal[i] * 1000, .den = NTSC_DEN};
        return true;
    }
    return false;
}

mrt_result timecode_rate_of(timecode_rate *out, double fps, error *err)
{
    if (!(fps >= TIMECODE_FPS_MIN && fps <= TIMECODE_FPS_MAX))
        return error_set(err, MRT_ERR_ARGUMENT,
                         "%.9g frames a second: expected %g to %g, such as 24, 25, 29.97, 30, 60",
                         fps, TIMECODE_FPS_MIN, TIMECODE_FPS_MAX);
    if (!find_ntsc(out, fps))
        *out = lowest_terms((uint32_t)floor(fps * DECIMALS + 0.5), DECIMALS);
    return MRT_OK;
}

static mrt_result unreadable_rate(const char *text, error *err)
{
    char word[48];
    text_copy(word, sizeof word, text_view_of(text, strlen(text)));
    return error_set(err, MRT_ERR_ARGUMENT,
                     "frame rate \"%s\": expected a number or a fraction from %g to %g, such as "
                     "25, 29.97, 30000/1001, 29.97df",
                     word, TIMECODE_FPS_MIN, TIMECODE_FPS_MAX);
}

static mrt_result parse_fraction(timecode_rate *out, text_view num, text_view den, const char *text,
                                 error *err)
{
    int64_t above, below;
    if (!text_int(num, &above) || !text_int(den, &below) || below < 1 || below > NTSC_DEN ||
        above < below || above > below * (int64_t)TIMECODE_FPS_MAX || above > NUM_MAX)
        return unreadable_rate(text, err);
    *out = lowest_terms((uint32_t)above, (uint32_t)below);
    return MRT_OK;
}

mrt_result timecode_rate_parse(timecode_rate *out, const char *text, error *err)
{
    text_view whole = text_trim(text_view_of(text, strlen(text)));
    bool is_drop = whole.end - whole.at > 2 && memcmp(whole.end - 2, "df", 2) == 0;
    if (is_drop)
        whole.end -= 2;
    text_view rest = whole, num;
    mrt_result result;
    double fps;
    if (memchr(whole.at, '/', (size_t)(whole.end - whole.at)) && text_next_field(&rest, '/', &num))
        result = parse_fraction(out, num, rest, text, err);
    else
        result = text_double(whole, &fps) && fps >= TIMECODE_FPS_MIN && fps <= TIMECODE_FPS_MAX
                     ? timecode_rate_of(out, fps, err)
                     : unreadable_rate(text, err);
    if (result < 0)
        return result;
    if (is_drop && !timecode_can_drop(*out))
        return error_set(err, MRT_ERR_ARGUMENT,
                         "frame rate \"%.40s\": only 29.97 and 59.94 have drop-frame time code. "
                         "Remove the \"df\"",
                         text);
    out->is_drop = is_drop;
    return MRT_OK;
}

double timecode_fps(timecode_rate rate)
{
    return (double)rate.num / rate.den;
}

bool timecode_can_drop(timecode_rate rate)
{
    return rate.den == NTSC_DEN && (rate.num == 30000 || rate.num == 60000);
}

/* ---- frames and times ---- */

static int64_t floor_divide(int64_t a, int64_t b)
{
    return a / b - (a % b < 0);
}

/* Whole runs of `num` frames last den seconds. Only the rest is multiplied: below 2^63, because num
 * <= 1e6 and den <= 1001. */
int64_t timecode_time_ns(timecode_rate rate, int64_t frame)
{
    int64_t run = floor_divide(frame, rate.num), rest = frame - run * rate.num;
    int64_t run_ns = rate.den * second_ns;
    return run * run_ns + (rest * run_ns + rate.num - 1) / rate.num;
}

int64_t timecode_frame(timecode_rate rate, int64_t time_ns)
{
    int64_t run_ns = rate.den * second_ns;
    int64_t run = floor_divide(time_ns, run_ns), rest = time_ns - run * run_ns;
    return run * rate.num + rest * rate.num / run_ns;
}

int64_t timecode_nearest_frame(timecode_rate rate, int64_t time_ns)
{
    int64_t frame = timecode_frame(rate, time_ns);
    int64_t after_ns = time_ns - timecode_time_ns(rate, frame);
    int64_t before_ns = timecode_time_ns(rate, frame + 1) - time_ns;
    return before_ns < after_ns ? frame + 1 : frame;
}

/* ---- labels ---- */

/* Number of labels per second: 30 for 29.97. */
static int64_t label_rate(timecode_rate rate)
{
    return (rate.num + rate.den - 1) / rate.den;
}

/* Number of labels that are skipped at the start of each minute, except each tenth. */
static int64_t dropped_labels(timecode_rate rate)
{
    return rate.is_drop ? label_rate(rate) / 15 : 0;
}

static int64_t label_of_frame(timecode_rate rate, int64_t frame)
{
    int64_t dropped = dropped_labels(rate), minute = 60 * label_rate(rate);
    int64_t tens = 10 * minute - 9 * dropped;
    int64_t ten = frame / tens, rest = frame % tens;
    int64_t minutes = rest < minute ? 0 : 1 + (rest - minute) / (minute - dropped);
    return frame + dropped * (9 * ten + minutes);
}

void timecode_write(char out[TIMECODE_TEXT], timecode_rate rate, int64_t frame)
{
    int64_t label = label_of_frame(rate, frame < 0 ? -frame : frame), fps = label_rate(rate);
    int64_t second = label / fps;
    (void)snprintf(out, TIMECODE_TEXT, "%s%02lld:%02d:%02d%c%0*d", frame < 0 ? "-" : "",
                   (long long)(second / 3600), (int)(second / 60 % 60), (int)(second % 60),
                   rate.is_drop ? ';' : ':', fps > 100 ? 3 : 2, (int)(label % fps));
}

static mrt_result unreadable_label(timecode_rate rate, const char *text, const char *why,
                                   error *err)
{
    char word[48];
    text_copy(word, sizeof word, text_view_of(text, strlen(text)));
    return error_set(err, MRT_ERR_ARGUMENT, "time code \"%s\": %s; at %.6g%s it reads like %s",
                     word, why, timecode_fps(rate), rate.is_drop ? " drop-frame" : "",
                     rate.is_drop ? "01:02:03;04" : "01:02:03:04");
}

/* Reads a number of 1 to 3 digits, below `limit`. */
static bool read_field(text_view *rest, char separator, int64_t limit, int64_t *out)
{
    text_view field = {rest->at, rest->at};
    while (field.end < rest->end && *field.end >= '0' && *field.end <= '9')
        ++field.end;
    bool is_last = separator == '\0';
    if (field.end == field.at || field.end - field.at > 3 || is_last != (field.end == rest->end) ||
        (!is_last && *field.end != separator))
        return false;
    rest->at = field.end + (is_last ? 0 : 1);
    return text_int(field, out) && *out < limit;
}

mrt_result timecode_parse(int64_t *out_frame, timecode_rate rate, const char *text, error *err)
{
    text_view rest = text_trim(text_view_of(text, strlen(text)));
    bool is_negative = rest.at < rest.end && *rest.at == '-';
    rest.at += is_negative;
    int64_t hour, minute, second, part, fps = label_rate(rate), dropped = dropped_labels(rate);
    if (!read_field(&rest, ':', HOURS_MAX + 1, &hour) || !read_field(&rest, ':', 60, &minute) ||
        !read_field(&rest, rate.is_drop ? ';' : ':', 60, &second) ||
        !read_field(&rest, '\0', fps, &part))
        return unreadable_label(rate, text, "expected hours, minutes, seconds and frames", err);
    if (second == 0 && part < dropped && minute % 10 != 0)
        return unreadable_label(rate, text, "drop-frame skips this label", err);
    int64_t minutes = hour * 60 + minute;
    int64_t frame = (minutes * 60 + second) * fps + part - dropped * (minutes - minutes / 10);
    *out_frame = is_negative ? -frame : frame;
    return MRT_OK;
}
