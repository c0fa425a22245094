/* What was asked for, as numbers, times and rates. */
#include "base/text.h"
#include "take.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

mrt_result take_misused(take_call *call, error *err, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(err->text, sizeof err->text, format, arguments);
    va_end(arguments);
    call->is_usage = true;
    return MRT_ERR_ARGUMENT;
}

mrt_result take_need(take_call *call, take_option option, error *err)
{
    if (call->text[option])
        return MRT_OK;
    return take_misused(call, err, "--%s is missing", take_option_name(option));
}

mrt_result take_number_of(take_call *call, const char *what, const char *text, double least,
                          double most, double *out, error *err)
{
    if (text_double(text_view_of(text, strlen(text)), out) && *out >= least && *out <= most)
        return MRT_OK;
    return take_misused(call, err, "%s \"%s\" is not a number from %g to %g", what, text, least,
                        most);
}

mrt_result take_number(take_call *call, take_option option, double least, double most, double *out,
                       error *err)
{
    char what[32];
    if (!call->text[option])
        return MRT_OK;
    (void)snprintf(what, sizeof what, "--%s", take_option_name(option));
    return take_number_of(call, what, call->text[option], least, most, out, err);
}

/* ---- rates ---- */

mrt_result take_rate(take_call *call, const take *t, timecode_rate *out, error *err)
{
    const char *text = call->text[TAKE_FPS];
    double fps = t && t->fps > 0.0 ? t->fps : 30.0;
    if (!text) {
        mrt_result result = timecode_rate_of(out, fps, err);
        if (result >= 0)
            out->is_drop = t && t->is_drop_frame && timecode_can_drop(*out);
        return result;
    }
    if (timecode_rate_parse(out, text, err) >= 0)
        return MRT_OK;
    char why[sizeof err->text / 2];
    (void)snprintf(why, sizeof why, "%.500s", err->text);
    return take_misused(call, err, "--fps: %s", why);
}

/* Frames in a second of labels. */
static int64_t nominal(timecode_rate rate)
{
    return ((int64_t)rate.num + rate.den - 1) / rate.den;
}

/* The same hours, minutes and seconds, and as much of the second, at another rate. */
static int64_t relabel(timecode_rate from, timecode_rate to, int64_t frame)
{
    char text[TIMECODE_TEXT + 32];
    long long hours, minutes, seconds, frames;
    int64_t out;
    error ignored = {""};
    timecode_write(text, from, frame);
    if (sscanf(text, "%lld:%lld:%lld%*[:;]%lld", &hours, &minutes, &seconds, &frames) != 4)
        return frame;
    frames = frames * nominal(to) / nominal(from);
    for (; frames < nominal(to); ++frames) { /* drop-frame leaves labels out */
        (void)snprintf(text, sizeof text, "%02lld:%02lld:%02lld%c%02lld", hours, minutes, seconds,
                       to.is_drop ? ';' : ':', frames);
        if (timecode_parse(&out, to, text, &ignored) >= 0)
            return out;
    }
    return frame;
}

int64_t take_label_frame(const take *t, timecode_rate rate, int64_t frame)
{
    timecode_rate own = rate;
    error ignored = {""};
    if (t->timecode_frame == 0 || !(t->fps > 0.0) || timecode_rate_of(&own, t->fps, &ignored) < 0)
        return t->timecode_frame + frame;
    own.is_drop = t->is_drop_frame && timecode_can_drop(own);
    bool is_same = own.num == rate.num && own.den == rate.den && own.is_drop == rate.is_drop;
    return (is_same ? t->timecode_frame : relabel(own, rate, t->timecode_frame)) + frame;
}

/* ---- times ---- */

static mrt_result time_of_label(take_call *call, const char *text, const take *t, int64_t *out,
                                error *err)
{
    timecode_rate rate;
    int64_t frame;
    if (!call->text[TAKE_FPS] && !(t->fps > 0.0))
        return take_misused(call, err,
                            "\"%s\" is time code, and the take has no frame rate: --fps N, or "
                            "first marotte take timecode SHOW TAKE --fps N",
                            text);
    mrt_result result = take_rate(call, t, &rate, err);
    if (result < 0)
        return result;
    rate.is_drop = strchr(text, ';') != NULL && timecode_can_drop(rate);
    if (timecode_parse(&frame, rate, text, err) < 0) {
        call->is_usage = true;
        return MRT_ERR_ARGUMENT;
    }
    *out = timecode_time_ns(rate, frame - take_label_frame(t, rate, 0));
    return MRT_OK;
}

mrt_result take_time_of(take_call *call, const char *what, const char *text, const take *t,
                        int64_t *out, error *err)
{
    double seconds;
    if (strchr(text, ':') || strchr(text, ';'))
        return time_of_label(call, text, t, out, err);
    mrt_result result = take_number_of(call, what, text, -1e6, 1e6, &seconds, err);
    if (result >= 0)
        *out = llround(seconds * 1e9);
    return result;
}

mrt_result take_time(take_call *call, take_option option, const take *t, int64_t *out, error *err)
{
    char what[32];
    if (!call->text[option])
        return MRT_OK;
    (void)snprintf(what, sizeof what, "--%s", take_option_name(option));
    return take_time_of(call, what, call->text[option], t, out, err);
}
