#include "stage/voice/hearing.h"
#include "stage/voice/hearing_weights.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

_Static_assert(sizeof hearing_first == sizeof(int16_t[HEARING_HIDDEN][HEARING_INPUTS + 1]) &&
                   sizeof hearing_second == sizeof(int16_t[HEARING_GROUPS][HEARING_HIDDEN + 1]),
               "run voice_fit");

static const phone_sound sound_of[HEARING_GROUPS] = {
    [HEARING_REST] = PHONE_REST, [HEARING_LIPS] = PHONE_B, [HEARING_TEETH] = PHONE_F,
    [HEARING_TONGUE] = PHONE_TH, [HEARING_TIP] = PHONE_D,  [HEARING_BACK] = PHONE_K,
    [HEARING_HUSH] = PHONE_SH,   [HEARING_HISS] = PHONE_S, [HEARING_NASAL] = PHONE_N,
    [HEARING_R] = PHONE_R,       [HEARING_A] = PHONE_AA,   [HEARING_SCHWA] = PHONE_AH,
    [HEARING_E] = PHONE_EH,      [HEARING_I] = PHONE_IY,   [HEARING_O] = PHONE_OW,
    [HEARING_U] = PHONE_UW,
};

hearing_group hearing_group_of(phone_sound sound, double length_s)
{
    static const hearing_group group[PHONE_COUNT] = {
        [PHONE_AA] = HEARING_A,      [PHONE_AE] = HEARING_A,      [PHONE_AH] = HEARING_A,
        [PHONE_AO] = HEARING_O,      [PHONE_AW] = HEARING_A,      [PHONE_AY] = HEARING_A,
        [PHONE_B] = HEARING_LIPS,    [PHONE_CH] = HEARING_HUSH,   [PHONE_D] = HEARING_TIP,
        [PHONE_DH] = HEARING_TONGUE, [PHONE_EH] = HEARING_E,      [PHONE_ER] = HEARING_R,
        [PHONE_EY] = HEARING_E,      [PHONE_F] = HEARING_TEETH,   [PHONE_G] = HEARING_BACK,
        [PHONE_HH] = HEARING_BACK,   [PHONE_IH] = HEARING_I,      [PHONE_IY] = HEARING_I,
        [PHONE_JH] = HEARING_HUSH,   [PHONE_K] = HEARING_BACK,    [PHONE_L] = HEARING_NASAL,
        [PHONE_M] = HEARING_LIPS,    [PHONE_N] = HEARING_NASAL,   [PHONE_NG] = HEARING_BACK,
        [PHONE_OW] = HEARING_O,      [PHONE_OY] = HEARING_O,      [PHONE_P] = HEARING_LIPS,
        [PHONE_R] = HEARING_R,       [PHONE_S] = HEARING_HISS,    [PHONE_SH] = HEARING_HUSH,
        [PHONE_T] = HEARING_TIP,     [PHONE_TH] = HEARING_TONGUE, [PHONE_UH] = HEARING_U,
        [PHONE_UW] = HEARING_U,      [PHONE_V] = HEARING_TEETH,   [PHONE_W] = HEARING_U,
        [PHONE_Y] = HEARING_I,       [PHONE_Z] = HEARING_HISS,    [PHONE_ZH] = HEARING_HUSH,
    };
    static const double schwa_s = 0.075;
    return sound == PHONE_AH && length_s < schwa_s ? HEARING_SCHWA : group[sound];
}

/* ---- the spectrum ---- */

enum { SPECTRUM = 512 };
static const double tau = 6.283185307179586;
/* About equal steps of hearing. */
static const double edge_hz[HEARING_BANDS + 1] = {80.0,   200.0,  320.0,  450.0,  600.0,
                                                  800.0,  1050.0, 1350.0, 1700.0, 2150.0,
                                                  2700.0, 3400.0, 4300.0, 5500.0, 7800.0};

/* Cooley and Tukey, in place, radix 2. */
static void transform(double re[SPECTRUM], double im[SPECTRUM])
{
    for (uint32_t i = 1, j = 0; i < SPECTRUM; ++i) {
        uint32_t bit = SPECTRUM / 2;
        for (; j & bit; bit /= 2)
            j ^= bit;
        j ^= bit;
        if (i < j) {
            const double a = re[i];
            re[i] = re[j], re[j] = a;
        }
    }
    for (uint32_t size = 2; size <= SPECTRUM; size *= 2)
        for (uint32_t k = 0; k < size / 2; ++k) {
            const double c = cos(tau * k / size), s = -sin(tau * k / size);
            for (uint32_t a = k; a < SPECTRUM; a += size) {
                const uint32_t b = a + size / 2;
                const double x = re[b] * c - im[b] * s, y = re[b] * s + im[b] * c;
                re[b] = re[a] - x, im[b] = im[a] - y;
                re[a] += x, im[a] += y;
            }
        }
}

void hearing_measure(hearing_frame *out, const float sound[HEARING_WINDOW])
{
    double re[SPECTRUM] = {0}, im[SPECTRUM] = {0}, power[HEARING_BANDS] = {0};
    for (int i = 0; i < HEARING_WINDOW; ++i)
        re[i] = (double)sound[i] * (0.5 - 0.5 * cos(tau * (i + 0.5) / HEARING_WINDOW));
    transform(re, im);
    for (int i = 0, band = 0; i < SPECTRUM / 2 && band < HEARING_BANDS; ++i) {
        const double hz = (double)i * PHONES_RATE_HZ / SPECTRUM;
        band += hz >= edge_hz[band + 1];
        if (hz >= edge_hz[0] && band < HEARING_BANDS)
            power[band] += re[i] * re[i] + im[i] * im[i];
    }
    for (int band = 0; band < HEARING_BANDS; ++band)
        out->band[band] = (float)(10.0 * log10(power[band] + 1e-9));
}

/* ---- relative to the voice ---- */

static const double below_loudest_db = 60.0, speech_db = 25.0, unit_db = 20.0;

static float loudest_of(const hearing_frame *frame)
{
    float most = frame->band[0];
    for (int band = 1; band < HEARING_BANDS; ++band)
        most = frame->band[band] > most ? frame->band[band] : most;
    return most;
}

void hearing_level(hearing_frame *frame, size_t count)
{
    enum { COUNTS = 240 }; /* of 1 dB, from -120 dB on */
    size_t counts[COUNTS] = {0}, above = 0, speech = 0;
    double mean[HEARING_BANDS] = {0};
    for (size_t i = 0; i < count; ++i)
        counts[(int)fmin(fmax((double)loudest_of(&frame[i]) + 120.0, 0.0), COUNTS - 1.0)] += 1;
    int loud = COUNTS - 1;
    while (loud > 0 && (above += counts[loud]) * 20 < count)
        loud -= 1;
    const double least_db = loud - 120.0 - below_loudest_db,
                 speech_least_db = loud - 120.0 - speech_db;
    for (size_t i = 0; i < count; ++i) {
        const bool is_speech = (double)loudest_of(&frame[i]) > speech_least_db;
        speech += is_speech;
        for (int band = 0; band < HEARING_BANDS; ++band) {
            float *value = &frame[i].band[band];
            *value = (float)fmax((double)*value, least_db);
            mean[band] += is_speech ? (double)*value : 0.0;
        }
    }
    for (size_t i = 0; i < count; ++i)
        for (int band = 0; band < HEARING_BANDS; ++band) {
            const double usual_db = speech > 0 ? mean[band] / (double)speech : 0.0;
            frame[i].band[band] = (float)(((double)frame[i].band[band] - usual_db) / unit_db);
        }
}

/* ---- the network ---- */

void hearing_look(float out[HEARING_INPUTS], const hearing_frame *frame, size_t count, size_t at)
{
    static const int moment[HEARING_MOMENTS] = {-15, -11, -8, -5, -3, -2, -1, 0,
                                                1,   2,   3,  5,  8,  11, 15};
    for (int m = 0; m < HEARING_MOMENTS; ++m) {
        const int64_t i = (int64_t)at + moment[m];
        for (int band = 0; band < HEARING_BANDS; ++band)
            out[m * HEARING_BANDS + band] =
                i >= 0 && i < (int64_t)count ? frame[i].band[band] : -2.0f;
    }
}

/* Without exponentials, so that every build hears the same. */
static void score(float out[HEARING_GROUPS], const float in[HEARING_INPUTS])
{
    float hidden[HEARING_HIDDEN];
    for (int h = 0; h < HEARING_HIDDEN; ++h) {
        float sum = (float)hearing_first[h][HEARING_INPUTS];
        for (int i = 0; i < HEARING_INPUTS; ++i)
            sum += (float)hearing_first[h][i] * in[i];
        sum /= HEARING_WEIGHT_UNIT;
        hidden[h] = sum / (1.0f + fabsf(sum));
    }
    for (int g = 0; g < HEARING_GROUPS; ++g) {
        float sum = (float)hearing_second[g][HEARING_HIDDEN];
        for (int h = 0; h < HEARING_HIDDEN; ++h)
            sum += (float)hearing_second[g][h] * hidden[h];
        out[g] = sum / HEARING_WEIGHT_UNIT;
    }
}

/* ---- what another recogniser heard ---- */

typedef struct hint {
    hearing_group group;
    phone_sound sound;
} hint;

/* Returns what was heard at a frame; *at moves on through the list. */
static hint hint_at(const phone_list *hints, size_t frame, uint32_t *at)
{
    const double time_s = ((double)frame + 0.5) / 100.0;
    while (*at + 1 < hints->count && hints->phone[*at].end_s <= time_s)
        *at += 1;
    if (hints->count == 0)
        return (hint){HEARING_GROUPS, PHONE_REST};
    const phone *p = &hints->phone[*at];
    return (hint){hearing_group_of(p->sound, p->end_s - p->start_s), p->sound};
}

/* ---- the likeliest sequence (Viterbi 1967) ---- */

/* Logarithms of likelihoods: of another sound; of closed lips, which are missed more than others;
 * of what another recogniser heard. */
static const float change_cost = 3.0f, lips_gain = 0.8f, hint_gain = 3.0f;

/* Fills the group of each frame. */
static void decode(uint8_t (*before)[HEARING_GROUPS], const hearing_frame *frame, size_t count,
                   size_t from, size_t end, const phone_list *hints)
{
    float best[HEARING_GROUPS] = {0};
    int first = 0;
    uint32_t at = 0;
    for (size_t i = from; i < end; ++i) {
        float in[HEARING_INPUTS], now[HEARING_GROUPS];
        const hint heard = hint_at(hints, i, &at);
        hearing_look(in, frame, count, i);
        score(now, in);
        now[HEARING_LIPS] += lips_gain;
        if (heard.group < HEARING_GROUPS)
            now[heard.group] += hint_gain;
        const float top = best[first];
        int next = 0;
        for (int g = 0; g < HEARING_GROUPS; ++g) {
            const bool stays = best[g] >= top - change_cost;
            before[i - from][g] = (uint8_t)(stays ? g : first);
            now[g] += (stays ? best[g] : top - change_cost) - top;
            next = now[g] > now[next] ? g : next;
        }
        memcpy(best, now, sizeof best);
        first = next;
    }
    for (size_t i = end; i > from; --i) {
        const int group = first;
        first = before[i - 1 - from][group];
        before[i - 1 - from][0] = (uint8_t)group;
    }
}

mrt_result hearing_listen(phone_list *out, const hearing_frame *frame, size_t count, size_t from,
                          size_t end, const phone_list *hints, error *err)
{
    uint8_t(*group)[HEARING_GROUPS] = malloc((end - from + 1) * sizeof *group);
    if (!group)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the voice");
    decode(group, frame, count, from, end, hints);
    mrt_result result = MRT_OK;
    uint32_t at = 0;
    for (size_t i = from, since = from; i < end && result >= 0; ++i) {
        const hearing_group now = group[since - from][0];
        if (i + 1 < end && group[i + 1 - from][0] == now)
            continue;
        const hint heard = hint_at(hints, (since + i) / 2, &at);
        result = phone_list_add(out, heard.group == now ? heard.sound : sound_of[now],
                                (double)since / 100.0, (double)(i + 1) / 100.0, err);
        since = i + 1;
    }
    free(group);
    return result;
}
