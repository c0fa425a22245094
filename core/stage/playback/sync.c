#include "stage/playback/sync.h"
#include "base/clock.h"
#include "show/own.h"
#include "show/sound_file.h"
#include "stage/input/input.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- the offset of two curves ---- */

enum { LAGS = 40, LEAST = 200 }; /* values: of the largest offset each way; of the shortest curve */
/* A peak counts if it is this high, and this much above all peaks that are apart from it. */
static const double peak_least = 0.3, peak_above = 0.04;
enum { APART = 12 };
/* A curve that varies less than this is still. */
static const double still = 0.01;

/* Writes the curve without its slow part, and how fast it rises, each scaled to a deviation of 1.
 * Returns false if the curve is still. */
static bool prepare(double *level, double *rise, const float *curve, uint32_t count)
{
    enum { SLOW = SYNC_RATE / 2 };
    double level_square = 0.0, rise_square = 0.0, least = 1e9, most = -1e9;
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t from = i > SLOW ? i - SLOW : 0, to = i + SLOW < count ? i + SLOW : count - 1;
        double sum = 0.0;
        for (uint32_t k = from; k <= to; ++k)
            sum += (double)curve[k];
        level[i] = (double)curve[i] - sum / (to - from + 1);
        const uint32_t last = i > 0 ? i - 1 : 0, next = i + 1 < count ? i + 1 : i;
        rise[i] = (double)curve[next] - (double)curve[last];
        level_square += level[i] * level[i];
        rise_square += rise[i] * rise[i];
        least = fmin(least, (double)curve[i]);
        most = fmax(most, (double)curve[i]);
    }
    if (!(most - least > still) || !(rise_square > 0.0))
        return false;
    const double level_by = 1.0 / sqrt(level_square), rise_by = 1.0 / sqrt(rise_square);
    for (uint32_t i = 0; i < count; ++i) {
        level[i] *= level_by;
        rise[i] *= rise_by;
    }
    return true;
}

/* Returns the correlation of mouth(t + lag) with voice(t). */
static double correlate(const double *mouth, const double *voice, uint32_t count, int lag)
{
    double sum = 0.0;
    for (int64_t i = lag < 0 ? -lag : 0; i < count && i + lag < count; ++i)
        sum += mouth[i + lag] * voice[i];
    return sum;
}

void sync_find(sync_offset *out, const float *mouth, const float *voice, uint32_t count)
{
    double at[2 * LAGS + 1], *curve = count >= LEAST ? malloc(sizeof(double) * 4 * count) : NULL;
    *out = (sync_offset){.late_ns = 0};
    if (!curve)
        return;
    double *m = curve, *m_rise = m + count, *v = m_rise + count, *v_rise = v + count;
    const bool moves = prepare(m, m_rise, mouth, count) && prepare(v, v_rise, voice, count);
    int best = 0;
    for (int i = 0; moves && i <= 2 * LAGS; ++i) {
        at[i] =
            0.5 * (correlate(m, v, count, i - LAGS) + correlate(m_rise, v_rise, count, i - LAGS));
        best = at[i] > at[best] ? i : best;
    }
    free(curve);
    if (!moves)
        return;
    double other = -1.0;
    for (int i = 1; i < 2 * LAGS; ++i)
        if (abs(i - best) >= APART && at[i] >= at[i - 1] && at[i] >= at[i + 1])
            other = fmax(other, at[i]);
    out->correlation = at[best];
    out->is_clear =
        at[best] >= peak_least && at[best] >= other + peak_above && best > 0 && best < 2 * LAGS;
    if (!out->is_clear)
        return;
    /* the peak of the parabola through three values */
    const double a = at[best - 1], b = at[best], c = at[best + 1];
    const double shift = 0.5 * (a - c) / (a - 2.0 * b + c);
    out->late_ns = llround((best - LAGS + shift) * 1e9 / SYNC_RATE);
}

sync_words sync_describe(const sync_offset *of)
{
    sync_words out;
    const long long late_ms = llround((double)of->late_ns / 1e6);
    if (!of->is_clear)
        (void)snprintf(out.text, sizeof out.text,
                       "No clear offset: the mouth does not follow the sound");
    else if (late_ms == 0)
        (void)snprintf(out.text, sizeof out.text, "The mouth is on time");
    else
        (void)snprintf(out.text, sizeof out.text, "The mouth is %lld ms %s", llabs(late_ms),
                       late_ms > 0 ? "late" : "early");
    return out;
}

uint32_t sync_edits(edit *out, uint32_t capacity, const take *t, int64_t late_ns)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < t->layer_count; ++i) {
        const take_layer *of = &t->layer[i];
        if (!own_layer_is_active(t, i) || of->clip_count == 0 || !own_layer_owns(of, "jaw.open"))
            continue;
        if (count < capacity) {
            edit_init(&out[count], EDIT_LAYER_OFFSET);
            out[count].layer = of->id;
            out[count].offset_ns = of->offset_ns - late_ns;
        }
        count += 1;
    }
    return count;
}

/* ---- the curves of a take ---- */

static const char voice_id[] = "org.marotte.voice";
/* The channel `openness` follows the sound by this time (tests/bench/voice_truth measures it). */
static const int64_t voice_delay_ns = 15 * NS_PER_MS;
static const double voice_least = 0.1; /* openness that a voice reaches */

static bool goes_on(const sync_source *from, double part)
{
    return !from->goes_on || from->goes_on(from->data, part);
}

static uint32_t find_jaw(const mrt_face *about)
{
    uint32_t i = 0;
    while (i < about->dof_count && strcmp(about->dofs[i].name, "jaw.open") != 0)
        i += 1;
    return i;
}

static mrt_result read_mouth(sync_curves *out, const sync_source *from, error *err)
{
    composer *shown = sequencer_performer(from->sequencer)->composer;
    const mrt_face *about = composer_about(shown);
    const uint32_t jaw = find_jaw(about);
    float least = INFINITY, most = -INFINITY;
    if (jaw == about->dof_count)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "The face has no jaw.open, so its mouth cannot be measured. Perform the "
                         "take on a face with a jaw");
    for (uint32_t i = 0; i < out->count; ++i) {
        const int64_t at_ns = out->from_ns + (int64_t)i * (NS_PER_S / SYNC_RATE);
        mrt_result result = sequencer_play_to(from->sequencer, at_ns, err);
        if (result >= 0)
            result = sequencer_check(from->sequencer, err);
        if (result < 0)
            return result;
        composer_draw(shown);
        out->mouth[i] = face_metered(composer_face(shown))->dof[jaw] / about->dofs[jaw].max;
        least = fminf(least, out->mouth[i]);
        most = fmaxf(most, out->mouth[i]);
        if (i % SYNC_RATE == 0 && !goes_on(from, 0.8 * i / out->count))
            return MRT_END;
    }
    if ((double)(most - least) < still)
        return error_set(
            err, MRT_ERR_ARGUMENT,
            "The jaw never moves in this take, so it has no offset. Choose a take or a "
            "range in which the mouth speaks");
    return MRT_OK;
}

/* Reads the samples of the input until the end of the curve. */
static mrt_result read_openness(sync_curves *out, const sync_source *from, input *voice, error *err)
{
    mrt_sample sample;
    uint32_t count, channel = 0;
    float most = 0.0f;
    const mrt_channel *channels = input_channels(voice, &count);
    while (channel < count && strcmp(channels[channel].name, "openness") != 0)
        channel += 1;
    if (channel == count)
        return error_set(err, MRT_ERR_UNSUPPORTED, "%s has no channel openness", voice_id);
    /* sample k is complete (k + 1) / SYNC_RATE after the start, and late by voice_delay_ns */
    const int64_t ahead = 1 - voice_delay_ns * SYNC_RATE / NS_PER_S;
    const double share = (double)(voice_delay_ns * SYNC_RATE % NS_PER_S) / NS_PER_S;
    float before = 0.0f;
    for (int64_t k = 0; k < (int64_t)out->count + SYNC_RATE && input_peek(voice, &sample); ++k) {
        const float now = sample.value[channel];
        const int64_t i = k + ahead;
        if (i >= 1 && i - 1 < out->count) /* between the two samples around it */
            out->voice[i - 1] = before + (float)share * (now - before);
        before = now;
        most = fmaxf(most, now);
        input_pop(voice);
        if (k % SYNC_RATE == 0 && !goes_on(from, 0.9 + 0.1 * (double)k / out->count))
            return MRT_END;
    }
    if (input_state_of(voice) == INPUT_FAILED)
        return error_set(err, MRT_ERR_IO, "the input voice failed on the sound of the take");
    if ((double)most < voice_least)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "The sound of the take has no voice that opens a mouth. Attach the sound "
                         "in which someone speaks");
    return MRT_OK;
}

static mrt_result write_sound(const char *path, const sync_curves *of, const sync_source *from,
                              error *err)
{
    sound_file_report ignored;
    const sound_file_export what = {.take = from->take,
                                    .from_ns = of->from_ns,
                                    .to_ns =
                                        of->from_ns + (int64_t)of->count * NS_PER_S / SYNC_RATE,
                                    .rate_hz = 0};
    return sound_file_write(&ignored, from->show, &what, path, NULL, err);
}

static mrt_result read_voice(sync_curves *out, const sync_source *from, error *err)
{
    const char *folder = getenv("TMPDIR");
    const mrt_plugin_type *type;
    char path[512];
    input *voice = NULL;
    const int length = snprintf(path, sizeof path, "%s/marotte_sync_XXXXXX.wav",
                                folder && folder[0] ? folder : "/tmp");
    const int made = length > 0 && (size_t)length < sizeof path ? mkstemps(path, 4) : -1;
    if (made < 0)
        return error_set(err, MRT_ERR_IO,
                         "cannot make a temporary file for the sound: set TMPDIR to a folder that "
                         "you may write to");
    close(made);
    mrt_result result = plugin_list_find(from->plugins, voice_id, MRT_INPUT, &type, err);
    if (result >= 0)
        result = write_sound(path, out, from, err);
    if (result >= 0)
        result = input_create(&voice, type, path, "", CLOCK_VIRTUAL, from->log, err);
    if (result >= 0)
        result = input_start(voice, err);
    if (result >= 0)
        result = read_openness(out, from, voice, err);
    input_destroy(voice);
    unlink(path);
    return result;
}

mrt_result sync_read(sync_curves *out, const sync_source *from, error *err)
{
    const int64_t span_ns = from->to_ns - from->from_ns;
    *out = (sync_curves){.from_ns = from->from_ns};
    if (from->take->audio.audio == 0)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "The take has no sound to compare the mouth with. Add one: marotte take "
                         "audio attach SHOW TAKE FILE");
    out->count =
        (uint32_t)((span_ns < SYNC_SPAN_NS ? span_ns : SYNC_SPAN_NS) * SYNC_RATE / NS_PER_S);
    if (span_ns <= 0 || out->count < LEAST)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "The span is too short to find an offset. Choose at least %d s",
                         LEAST / SYNC_RATE);
    out->mouth = calloc(out->count, sizeof *out->mouth);
    out->voice = calloc(out->count, sizeof *out->voice);
    if (!out->mouth || !out->voice)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the curves of a take");
    mrt_result result = read_mouth(out, from, err);
    return result == MRT_OK ? read_voice(out, from, err) : result;
}

void sync_curves_finish(sync_curves *self)
{
    free(self->mouth);
    free(self->voice);
    *self = (sync_curves){0};
}
