/* voice_truth [--fit] - voices of espeak-ng through plugins/voice/mouth.h, against the phonemes
 * that espeak-ng says it spoke. Prints the correlation of openness with that of the vowels, and how
 * many of m, b, p close the lips. Exits with 1 if a figure misses its goal. --fit: prints the rows
 * of plugins/voice/mouth_weights.h, by least squares over the sentences of fitting, which are
 * others than those of measuring, and other voices. */
#include "voice/mouth.h"

#include <espeak-ng/speak_lib.h>

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LAGS = 8, SOUND_MAX = 22050 * 60, PHONEMES_MAX = 2000, HOPS_MAX = 6000, LEAD = 8000 };

typedef struct truth {
    const char *phoneme;
    double open, wide, round, closed, hiss;
} truth;
/* Openness after the vowel height of the IPA chart; others by their place of articulation. */
static const truth table[] = {
    {"A:", 1.0, 0, 0.1, 0, 0},    {"A@", 1.0, 0, 0.1, 0, 0},   {"a", 0.9, 0.2, 0, 0, 0},
    {"aa", 0.9, 0.2, 0, 0, 0},    {"a:", 1.0, 0.1, 0, 0, 0},   {"aI", 0.8, 0.3, 0, 0, 0},
    {"aU", 0.8, 0, 0.3, 0, 0},    {"aU@", 0.8, 0, 0.3, 0, 0},  {"aI@", 0.8, 0.3, 0, 0, 0},
    {"0", 0.75, 0, 0.4, 0, 0},    {"V", 0.75, 0, 0, 0, 0},     {"E", 0.6, 0.5, 0, 0, 0},
    {"e@", 0.55, 0.5, 0, 0, 0},   {"eI", 0.5, 0.6, 0, 0, 0},   {"3:", 0.45, 0, 0.3, 0, 0},
    {"3", 0.4, 0, 0.2, 0, 0},     {"@", 0.35, 0.1, 0.1, 0, 0}, {"@2", 0.35, 0.1, 0.1, 0, 0},
    {"@5", 0.35, 0.1, 0.1, 0, 0}, {"@L", 0.3, 0, 0.3, 0, 0},   {"a#", 0.4, 0.1, 0, 0, 0},
    {"I", 0.25, 0.7, 0, 0, 0},    {"I2", 0.25, 0.7, 0, 0, 0},  {"I#", 0.25, 0.7, 0, 0, 0},
    {"i", 0.2, 0.9, 0, 0, 0},     {"i:", 0.15, 1.0, 0, 0, 0},  {"i@", 0.25, 0.7, 0, 0, 0},
    {"i@3", 0.25, 0.7, 0, 0, 0},  {"u:", 0.15, 0, 1.0, 0, 0},  {"u", 0.15, 0, 1.0, 0, 0},
    {"U", 0.25, 0, 0.8, 0, 0},    {"U@", 0.3, 0, 0.8, 0, 0},   {"O:", 0.55, 0, 0.8, 0, 0},
    {"O", 0.55, 0, 0.8, 0, 0},    {"O@", 0.55, 0, 0.8, 0, 0},  {"o@", 0.55, 0, 0.8, 0, 0},
    {"OI", 0.5, 0.2, 0.5, 0, 0},  {"oU", 0.45, 0, 0.8, 0, 0},  {"m", 0, 0, 0, 1, 0},
    {"b", 0, 0, 0, 1, 0},         {"p", 0, 0, 0, 1, 0},        {"w", 0.1, 0, 1.0, 0, 0},
    {"s", 0.05, 0.2, 0, 0, 1.0},  {"z", 0.05, 0.2, 0, 0, 0.7}, {"S", 0.05, 0, 0.3, 0, 1.0},
    {"Z", 0.05, 0, 0.3, 0, 0.7},  {"f", 0, 0, 0, 0, 0.8},      {"v", 0, 0, 0, 0, 0.3},
    {"T", 0.1, 0, 0, 0, 0.6},     {"D", 0.1, 0, 0, 0, 0.1},    {"tS", 0.05, 0, 0.3, 0, 1.0},
    {"dZ", 0.05, 0, 0.3, 0, 0.6}, {"t", 0.05, 0, 0, 0, 0.3},   {"r", 0.2, 0, 0.3, 0, 0},
    {"l", 0.2, 0.1, 0, 0, 0},     {"n", 0.1, 0.1, 0, 0, 0},    {"N", 0.15, 0, 0, 0, 0},
    {"j", 0.15, 0.7, 0, 0, 0},    {"k", 0.15, 0, 0, 0, 0.1},   {"g", 0.15, 0, 0, 0, 0},
    {"d", 0.05, 0, 0, 0, 0},      {"h", 0.3, 0, 0, 0, 0.1},
};

static const char *const fit_voices[] = {"en-gb-x-rp",        "en-gb-x-rp+m1", "en-gb-scotland+f2",
                                         "en-gb-x-gbclan+m7", "en-gb-x-rp+f4", "en-029+f1",
                                         "en-gb-scotland+m4"};
static const char *const fit_sentences[] = {
    "The big brown fox jumped over my lazy lamb. Papa made a pumpkin pie, and mama ate most of it.",
    "We saw a huge shoe in the zoo. Far from the park, a calm farmer feeds three sheep.",
    "Bob and Tom amble home by moonlight. You may keep the cheap ship, but give me the bigger map.",
    "No one knows how long the king sang. Please put the blue book upon the table before noon.",
    "He thought all of us ought to be at work early. Easy rules keep people happy and warm.",
    "I am a member of the members club, and I remember number nine. Perhaps my pet rabbit is "
    "asleep.",
};
static const char *const voices[] = {"en-gb-x-rp+m3", "en-gb-x-gbclan+f3", "en-029+m2"};
static const char *const sentences[] = {
    "My mother bought a pound of apples.",     "Peter Piper picked a peck of pickled peppers.",
    "She sells sea shells by the sea shore.",  "A happy baby bear may be warm in bed.",
    "Who would move the moon above the pool?", "We were away a year ago, in a far harbour.",
};
enum { CHANNELS = MOUTH_CHANNELS };
#define COUNT(a) ((int)(sizeof(a) / sizeof *(a)))

static struct {
    short sound[SOUND_MAX];
    int count, phoneme_count;
    struct {
        double at_s;
        char name[9];
    } phoneme[PHONEMES_MAX];
} said;

static int on_sound(short *sound, int count, espeak_EVENT *events)
{
    for (; events->type != espeakEVENT_LIST_TERMINATED; ++events)
        if (events->type == espeakEVENT_PHONEME && said.phoneme_count < PHONEMES_MAX) {
            said.phoneme[said.phoneme_count].at_s = 1e-3 * events->audio_position;
            snprintf(said.phoneme[said.phoneme_count++].name, 9, "%.8s", events->id.string);
        }
    for (int i = 0; sound && i < count && said.count < SOUND_MAX; ++i)
        said.sound[said.count++] = sound[i];
    return 0;
}

static bool speak(const char *voice, const char *text)
{
    said.count = said.phoneme_count = 0;
    return espeak_SetVoiceByName(voice) == EE_OK &&
           espeak_Synth(text, strlen(text) + 1, 0, POS_CHARACTER, 0, espeakCHARS_UTF8, NULL,
                        NULL) == EE_OK &&
           said.count > 0;
}

static const truth *truth_of(const char *name)
{
    static const truth nothing = {"", 0, 0, 0, 0, 0};
    for (int i = 0; i < COUNT(table); ++i)
        if (strcmp(table[i].phoneme, name) == 0)
            return &table[i];
    return &nothing;
}

static int phoneme_at(double at_s)
{
    int i = -1;
    while (i + 1 < said.phoneme_count && said.phoneme[i + 1].at_s <= at_s)
        i += 1;
    return i;
}

/* ---- hops of one utterance ---- */

static double feature[HOPS_MAX][MOUTH_FEATURES], value[HOPS_MAX][CHANNELS],
    goal[HOPS_MAX][CHANNELS];
static double hop_at_s[HOPS_MAX];
static int hop_count;

static void run_mouth(double gain)
{
    static mouth of;
    uint32_t seed = 1;
    mouth_init(&of, 22050.0);
    hop_count = 0;
    for (int i = -LEAD; i < said.count + LEAD; ++i) {
        double frame = i >= 0 && i < said.count ? gain * said.sound[i] / 32768.0 : 0.0;
        seed = seed * 1664525u + 1013904223u;
        frame += 6e-4 * ((double)seed / 4294967296.0 - 0.5); /* the noise of a quiet room */
        if (!mouth_add(&of, (float)frame) || hop_count == HOPS_MAX)
            continue;
        hop_at_s[hop_count] = i / 22050.0;
        memcpy(feature[hop_count], of.feature, sizeof of.feature);
        memcpy(value[hop_count++], of.value, sizeof of.value);
    }
    for (int i = 0; i < hop_count; ++i) {
        const int now = phoneme_at(hop_at_s[i] - 0.0125); /* the middle of the window */
        const truth *t = truth_of(now >= 0 ? said.phoneme[now].name : "");
        const double all[CHANNELS] = {t->open, t->wide, t->round, t->closed, t->hiss};
        memcpy(goal[i], all, sizeof all);
    }
}

/* ---- fitting ---- */

static double normal[MOUTH_FEATURES][MOUTH_FEATURES], right[MOUTH_FEATURES][CHANNELS];

static void add_hops(void)
{
    for (int h = 0; h < hop_count; ++h) {
        const double heard = feature[h][MOUTH_BANDS];
        if (hop_at_s[h] < 0.0 || phoneme_at(hop_at_s[h]) < 0 || heard < 0.02)
            continue;
        for (int i = 0; i < MOUTH_FEATURES; ++i) {
            for (int j = 0; j < MOUTH_FEATURES; ++j)
                normal[i][j] += feature[h][i] * feature[h][j];
            for (int c = 0; c < CHANNELS; ++c)
                right[i][c] += feature[h][i] * goal[h][c];
        }
    }
}

static void solve(void)
{
    for (int i = 0; i < MOUTH_FEATURES; ++i)
        normal[i][i] += 5.0;
    for (int p = 0; p < MOUTH_FEATURES; ++p)
        for (int i = 0; i < MOUTH_FEATURES; ++i) {
            if (i == p)
                continue;
            const double by = normal[i][p] / normal[p][p];
            for (int j = 0; j < MOUTH_FEATURES; ++j)
                normal[i][j] -= by * normal[p][j];
            for (int c = 0; c < CHANNELS; ++c)
                right[i][c] -= by * right[p][c];
        }
}

static int fit(void)
{
    for (int v = 0; v < COUNT(fit_voices); ++v)
        for (int s = 0; s < COUNT(fit_sentences); ++s) {
            if (!speak(fit_voices[v], fit_sentences[s])) {
                fprintf(stderr, "espeak-ng has no voice %s\n", fit_voices[v]);
                return 1;
            }
            run_mouth(s % 2 ? 0.8 : 0.2);
            add_hops();
        }
    solve();
    for (int c = 0; c < CHANNELS; ++c) {
        printf("    {");
        for (int i = 0; i < MOUTH_FEATURES; ++i)
            printf("%s%.4f", i ? ", " : "", right[i][c] / normal[i][i]);
        printf("},\n");
    }
    return 0;
}

/* ---- measuring ---- */

typedef struct sums {
    double n, x, y, xx, yy, xy;
} sums;

static void add(sums *s, double x, double y)
{
    s->n += 1, s->x += x, s->y += y, s->xx += x * x, s->yy += y * y, s->xy += x * y;
}

static double correlation(const sums *s)
{
    return (s->n * s->xy - s->x * s->y) /
           sqrt((s->n * s->xx - s->x * s->x) * (s->n * s->yy - s->y * s->y));
}

int main(int argc, char **argv)
{
    int found = 0, closures = 0, false_ones = 0, others = 0;
    sums vowels = {0}, hops = {0}, wide = {0}, hiss = {0}, lag[LAGS] = {0};
    if (espeak_Initialize(AUDIO_OUTPUT_SYNCHRONOUS, 0, NULL,
                          espeakINITIALIZE_PHONEME_EVENTS | espeakINITIALIZE_DONT_EXIT) != 22050) {
        puts("SKIPPED: espeak-ng has no voices of 22 050 Hz");
        return 77;
    }
    espeak_SetSynthCallback(on_sound);
    if (argc > 1 && strcmp(argv[1], "--fit") == 0)
        return fit();
    for (int v = 0; v < COUNT(voices); ++v)
        for (int s = 0; s < COUNT(sentences); ++s) {
            if (!speak(voices[v], sentences[s])) {
                printf("SKIPPED: espeak-ng has no voice %s\n", voices[v]);
                return 77;
            }
            run_mouth(0.5);
            for (int p = 0; p + 1 < said.phoneme_count; ++p) {
                const truth *t = truth_of(said.phoneme[p].name);
                const double from_s = said.phoneme[p].at_s, to_s = said.phoneme[p + 1].at_s;
                double most = 0.0, mean = 0.0, width = 0.0;
                int count = 0;
                for (int h = 0; h < hop_count; ++h) {
                    if (hop_at_s[h] < from_s + 0.02 || hop_at_s[h] > to_s + 0.05)
                        continue;
                    most = fmax(most, value[h][MOUTH_CLOSURE]);
                    mean += value[h][MOUTH_OPENNESS];
                    width += value[h][MOUTH_WIDE] - value[h][MOUTH_ROUND];
                    count += 1;
                }
                if (t->closed > 0.0) {
                    closures += 1;
                    found += most > 0.5;
                    if (argc > 1 && most <= 0.5)
                        printf("  %s missed %s at %.2f s: %.2f\n", voices[v], t->phoneme, from_s,
                               most);
                } else if (t->open >= 0.15 && count > 0) { /* vowels */
                    add(&vowels, t->open, mean / count);
                    add(&wide, t->wide - t->round, width / count);
                    others += 1;
                    false_ones += most > 0.5 &&
                                  strchr("mbp", said.phoneme[p + 1].name[0]) == NULL && p > 0 &&
                                  strchr("mbp", said.phoneme[p - 1].name[0]) == NULL;
                }
            }
            for (int h = 3; h < hop_count; ++h)
                if (hop_at_s[h] > 0.0 && phoneme_at(hop_at_s[h]) >= 0) {
                    for (int k = 0; k < LAGS && k <= h; ++k)
                        add(&lag[k], goal[h - k][MOUTH_OPENNESS], value[h][MOUTH_OPENNESS]);
                    add(&hops, goal[h - 2][MOUTH_OPENNESS], value[h][MOUTH_OPENNESS]);
                    add(&hiss, goal[h - 2][MOUTH_HISS], value[h][MOUTH_HISS]);
                }
        }
    int delay = 0;
    for (int k = 1; k < LAGS; ++k)
        delay = correlation(&lag[k]) > correlation(&lag[delay]) ? k : delay;
    printf("openness follows the phonemes by %.1f ms\n", 12.5 + 10.0 * delay);
    printf("openness: correlation %.2f over %.0f vowels, %.2f over all 10 ms\n",
           correlation(&vowels), vowels.n, correlation(&hops));
    printf("wide less round: correlation %.2f over the vowels; hiss %.2f over all 10 ms\n",
           correlation(&wide), correlation(&hiss));
    printf("closures: %d of %d of m b p (%.0f %%); %d of %d vowels without one beside them close\n",
           found, closures, 100.0 * found / closures, false_ones, others);
    return correlation(&vowels) >= 0.6 && found >= 0.85 * closures ? 0 : 1;
}
