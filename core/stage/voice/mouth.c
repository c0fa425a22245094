#include "stage/voice/mouth.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const mouth_pose_name[MOUTH_VISEMES] = {
    "viseme_PP", "viseme_FF", "viseme_TH", "viseme_DD", "viseme_kk", "viseme_CH", "viseme_SS",
    "viseme_nn", "viseme_RR", "viseme_aa", "viseme_E",  "viseme_I",  "viseme_O",  "viseme_U"};

/* ---- sounds ---- */

typedef enum manner { VOWEL = 0, CONSONANT, CLOSURE, GLIDE } manner;

/* `then`: the end of a diphthong; `from` where there is none. `none` closes nothing: h. */
typedef struct look {
    mouth_viseme from, then;
    manner manner;
    double share, firmness;
} look;

static const look looks[PHONE_COUNT] = {
    [PHONE_AA] = {MOUTH_AA, MOUTH_AA, VOWEL, 1.0, 0.9},
    [PHONE_AE] = {MOUTH_AA, MOUTH_AA, VOWEL, 0.9, 0.85},
    [PHONE_AH] = {MOUTH_AA, MOUTH_AA, VOWEL, 0.7, 0.65},
    [PHONE_AO] = {MOUTH_O, MOUTH_O, VOWEL, 1.0, 0.95},
    [PHONE_AW] = {MOUTH_AA, MOUTH_U, VOWEL, 1.0, 0.9},
    [PHONE_AY] = {MOUTH_AA, MOUTH_I, VOWEL, 1.0, 0.9},
    [PHONE_B] = {MOUTH_PP, MOUTH_PP, CLOSURE, 1.0, 1.0},
    [PHONE_CH] = {MOUTH_CH, MOUTH_CH, CONSONANT, 1.0, 0.9},
    [PHONE_D] = {MOUTH_DD, MOUTH_DD, CONSONANT, 0.9, 0.5},
    [PHONE_DH] = {MOUTH_TH, MOUTH_TH, CONSONANT, 0.9, 0.7},
    [PHONE_EH] = {MOUTH_E, MOUTH_E, VOWEL, 1.0, 0.85},
    [PHONE_ER] = {MOUTH_RR, MOUTH_RR, VOWEL, 0.8, 0.7},
    [PHONE_EY] = {MOUTH_E, MOUTH_I, VOWEL, 1.0, 0.9},
    [PHONE_F] = {MOUTH_FF, MOUTH_FF, CLOSURE, 1.0, 1.0},
    [PHONE_G] = {MOUTH_KK, MOUTH_KK, CONSONANT, 0.9, 0.4},
    [PHONE_HH] = {MOUTH_E, MOUTH_E, GLIDE, 0.6, 0.0},
    [PHONE_IH] = {MOUTH_I, MOUTH_I, VOWEL, 0.85, 0.65},
    [PHONE_IY] = {MOUTH_I, MOUTH_I, VOWEL, 1.0, 0.9},
    [PHONE_JH] = {MOUTH_CH, MOUTH_CH, CONSONANT, 1.0, 0.9},
    [PHONE_K] = {MOUTH_KK, MOUTH_KK, CONSONANT, 0.9, 0.4},
    [PHONE_L] = {MOUTH_NN, MOUTH_NN, CONSONANT, 1.0, 0.5},
    [PHONE_M] = {MOUTH_PP, MOUTH_PP, CLOSURE, 1.0, 1.0},
    [PHONE_N] = {MOUTH_NN, MOUTH_NN, CONSONANT, 1.0, 0.5},
    [PHONE_NG] = {MOUTH_KK, MOUTH_KK, CONSONANT, 0.7, 0.4},
    [PHONE_OW] = {MOUTH_O, MOUTH_U, VOWEL, 1.0, 0.95},
    [PHONE_OY] = {MOUTH_O, MOUTH_I, VOWEL, 1.0, 0.95},
    [PHONE_P] = {MOUTH_PP, MOUTH_PP, CLOSURE, 1.0, 1.0},
    [PHONE_R] = {MOUTH_RR, MOUTH_RR, GLIDE, 0.9, 0.7},
    [PHONE_S] = {MOUTH_SS, MOUTH_SS, CONSONANT, 1.0, 0.8},
    [PHONE_SH] = {MOUTH_CH, MOUTH_CH, CONSONANT, 1.0, 0.9},
    [PHONE_T] = {MOUTH_DD, MOUTH_DD, CONSONANT, 0.9, 0.5},
    [PHONE_TH] = {MOUTH_TH, MOUTH_TH, CONSONANT, 1.0, 0.9},
    [PHONE_UH] = {MOUTH_U, MOUTH_U, VOWEL, 0.85, 0.8},
    [PHONE_UW] = {MOUTH_U, MOUTH_U, VOWEL, 1.0, 0.95},
    [PHONE_V] = {MOUTH_FF, MOUTH_FF, CLOSURE, 1.0, 1.0},
    [PHONE_W] = {MOUTH_U, MOUTH_U, GLIDE, 1.0, 0.95},
    [PHONE_Y] = {MOUTH_I, MOUTH_I, GLIDE, 0.8, 0.5},
    [PHONE_Z] = {MOUTH_SS, MOUTH_SS, CONSONANT, 1.0, 0.8},
    [PHONE_ZH] = {MOUTH_CH, MOUTH_CH, CONSONANT, 1.0, 0.9},
};

/* ---- keys ---- */

/* The mouth is ahead of the sound by this time. */
static const double lead_s = 0.05, closure_lead_s = 0.045;
static const double pause_least_s = 0.2, to_rest_s = 0.15, from_rest_s = 0.2;
static const double short_vowel_s = 0.07, weak_share = 0.75;
static const double effort_of_jaw = 0.35;

static double within(double value, double least, double most)
{
    return fmin(fmax(value, least), most);
}

static void add_key(mouth *self, const phone *p, mouth_viseme viseme, double share,
                    double reached_s, double left_s)
{
    const look *of = &looks[p->sound];
    mouth_key *key = &self->key[self->count++];
    *key = (mouth_key){.reached_s = reached_s,
                       .left_s = fmax(left_s, reached_s),
                       .firmness = of->firmness,
                       .is_closure = of->manner == CLOSURE,
                       .jaw = 1.0};
    if (of->manner == VOWEL) {
        const bool is_short = p->end_s - p->start_s < short_vowel_s;
        share *= is_short ? weak_share : 1.0;
        share *= within(1.0 + 0.3 * p->effort, 0.7, 1.0);
        key->jaw = within(1.0 + effort_of_jaw * p->effort, 0.6, 1.35);
    }
    key->amount[viseme] = share;
}

static void add_rest(mouth *self, double reached_s, double left_s)
{
    self->key[self->count++] = (mouth_key){
        .reached_s = reached_s, .left_s = fmax(left_s, reached_s), .firmness = 1.0, .jaw = 1.0};
}

static void add_sound(mouth *self, const phone *p)
{
    const look *of = &looks[p->sound];
    const double s = p->start_s - lead_s, d = p->end_s - p->start_s, e = s + d;
    switch (of->manner) {
    case CLOSURE:
        add_key(self, p, of->from, of->share, p->start_s - closure_lead_s,
                fmax(p->end_s - 0.02, p->start_s + 0.02));
        return;
    case CONSONANT:
        add_key(self, p, of->from, of->share, s + 0.25 * d, e - 0.25 * d);
        return;
    case GLIDE:
        add_key(self, p, of->from, of->share, s + 0.4 * d, e - 0.4 * d);
        return;
    case VOWEL:
        break;
    }
    if (of->from == of->then) {
        add_key(self, p, of->from, of->share, s + 0.4 * d, e - 0.3 * d);
        return;
    }
    add_key(self, p, of->from, of->share, s + 0.35 * d, s + 0.45 * d);
    add_key(self, p, of->then, 0.85 * of->share, s + 0.9 * d, e);
}

static void add_pause(mouth *self, const phone *p, bool is_first, bool is_last)
{
    const double length_s = p->end_s - p->start_s;
    if (length_s < pause_least_s && !is_first && !is_last)
        return;
    const double reached_s = is_first ? p->start_s : p->start_s + to_rest_s;
    const double left_s = is_last ? p->end_s : p->end_s - from_rest_s;
    const double middle_s = 0.5 * (p->start_s + p->end_s);
    add_rest(self, reached_s <= left_s ? reached_s : middle_s,
             reached_s <= left_s ? left_s : middle_s);
}

/* ---- neighbours ---- */

static void mix(mouth_key *now, const double *own, const double *before, const double *after,
                double way)
{
    for (int v = 0; v < MOUTH_VISEMES; ++v) {
        const double around = before[v] + way * (after[v] - before[v]);
        now->amount[v] = now->firmness * own[v] + (1.0 - now->firmness) * around;
    }
}

/* Blends each weak key with the nearest firm keys around it, by their distance in time. Closures
 * do not spread: a weak sound beside them keeps its own lips. */
static mrt_result coarticulate(mouth *self, error *err)
{
    static const double firm = 0.65;
    mouth_key *own = malloc((self->count + 1) * sizeof *own);
    if (!own)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the mouth");
    memcpy(own, self->key, self->count * sizeof *own);
    for (uint32_t k = 1; k + 1 < self->count; ++k) {
        mouth_key *now = &self->key[k];
        uint32_t before = k - 1, after = k + 1;
        if (now->firmness >= 1.0)
            continue;
        while (before > 0 && (own[before].firmness < firm || own[before].is_closure))
            before -= 1;
        while (after + 1 < self->count && (own[after].firmness < firm || own[after].is_closure))
            after += 1;
        const double from_s = own[before].left_s, to_s = own[after].reached_s;
        const double middle_s = 0.5 * (now->reached_s + now->left_s);
        const double way =
            to_s > from_s ? within((middle_s - from_s) / (to_s - from_s), 0, 1) : 0.5;
        mix(now, own[k].amount, own[before].amount, own[after].amount, way);
    }
    free(own);
    return MRT_OK;
}

/* Leaves at least `gap_s` between two keys: what is held gives way first, a closure last. */
static void keep_apart(mouth *self)
{
    static const double gap_s = 0.045, hold_s = 0.04;
    for (uint32_t k = 0; k + 1 < self->count; ++k) {
        mouth_key *a = &self->key[k], *b = &self->key[k + 1];
        double lacks_s = gap_s - (b->reached_s - a->left_s);
        if (lacks_s <= 0.0)
            continue;
        const double spare_a = fmax(a->left_s - a->reached_s - (a->is_closure ? hold_s : 0.0), 0.0);
        const double give_a = fmin(b->is_closure ? lacks_s : 0.5 * lacks_s, spare_a);
        a->left_s -= give_a;
        lacks_s -= give_a;
        b->reached_s += lacks_s;
        b->left_s = fmax(b->left_s, b->reached_s + (b->is_closure ? hold_s : 0.0));
    }
}

mrt_result mouth_create(mouth *out, const phone_list *sounds, error *err)
{
    *out = (mouth){.key = calloc(2 * (size_t)sounds->count + 2, sizeof *out->key)};
    if (!out->key)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the mouth");
    for (uint32_t i = 0; i < sounds->count; ++i) {
        const phone *p = &sounds->phone[i];
        if (i == 0 && p->sound != PHONE_REST)
            add_rest(out, p->start_s - from_rest_s, p->start_s - from_rest_s);
        if (p->sound == PHONE_REST)
            add_pause(out, p, i == 0, i + 1 == sounds->count);
        else
            add_sound(out, p);
        if (i + 1 == sounds->count && p->sound != PHONE_REST)
            add_rest(out, p->end_s + to_rest_s, p->end_s + to_rest_s);
    }
    const mrt_result result = coarticulate(out, err);
    keep_apart(out);
    if (result < 0)
        mouth_finish(out);
    return result;
}

void mouth_finish(mouth *self)
{
    free(self->key);
    *self = (mouth){0};
}

/* ---- at a time ---- */

/* Returns the last key that is reached at or before a time. */
static uint32_t key_at(const mouth *self, double time_s)
{
    uint32_t low = 0, high = self->count;
    while (high - low > 1) {
        const uint32_t middle = low + (high - low) / 2;
        if (self->key[middle].reached_s <= time_s)
            low = middle;
        else
            high = middle;
    }
    return low;
}

mouth_shape mouth_at(const mouth *self, double time_s, double jaw, double lips)
{
    mouth_shape out = {.jaw = jaw, .lips = lips};
    if (self->count == 0)
        return out;
    const uint32_t at = key_at(self, time_s);
    const mouth_key *a = &self->key[at];
    const mouth_key *b = at + 1 < self->count ? a + 1 : a;
    const double span_s = b->reached_s - a->left_s;
    const double way = span_s > 0.0 ? within((time_s - a->left_s) / span_s, 0.0, 1.0)
                                    : (time_s > a->left_s ? 1.0 : 0.0);
    const double eased = way * way * (3.0 - 2.0 * way);
    for (int v = 0; v < MOUTH_VISEMES; ++v)
        out.amount[v] = within(a->amount[v] + eased * (b->amount[v] - a->amount[v]), 0.0, 1.0);
    out.jaw = within(jaw * (a->jaw + eased * (b->jaw - a->jaw)), 0.0, 2.0);
    const double closed = out.amount[MOUTH_PP] + out.amount[MOUTH_FF];
    out.lips = within(lips + closed * (fmax(lips, 1.0) - lips), 0.0, 2.0);
    return out;
}
