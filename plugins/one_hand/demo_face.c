/* demo_face demo PHONEMES.csv [FILE], demo_face emotions [FILE] - writes the hand recordings in
 * which one right hand performs a face with the mapping one_hand: the sentence synthesised by
 * espeak-ng (demo_voice.c), and eight expressions. The hand poses are those of the mapping's table
 * (faces.h). The mouth moves from viseme to viseme by minimum jerk. Weak visemes are influenced by
 * their neighbours, and movements that a hand cannot reach in time are weakened. Lips of p, b and m
 * are never weakened. The output has the same bytes on every machine: + - * / and a built-in random
 * generator. */
#include "faces.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { RATE_HZ = 100, KEYS_MAX = 512, STROKES_MAX = 256, WRIST_MAX = 128, PHONES_MAX = 400 };
static const double speed_most =
    370.0; /* deg/s at a joint; below the limit of a hand, 400, because of its tremor */

/* ---- small ---- */

/* Flash and Hogan 1985: the smoothest movement from 0 to 1. Its maximum speed is 1.875. */
static double minimum_jerk(double s)
{
    if (s <= 0.0)
        return 0.0;
    if (s >= 1.0)
        return 1.0;
    return s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
}
static const double peak_of_minimum_jerk = 1.875;

static double magnitude(double x)
{
    return x < 0.0 ? -x : x;
}

static double larger(double a, double b)
{
    return a > b ? a : b;
}

static double smaller(double a, double b)
{
    return a < b ? a : b;
}

/* Steele, Lea, Flood 2014: SplitMix64. Uniform in -1 .. 1. */
static double next_random(uint64_t *state)
{
    uint64_t z = *state += UINT64_C(0x9E3779B97F4A7C15);
    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    return (double)((z ^ (z >> 31)) >> 11) * (2.0 / 9007199254740992.0) - 1.0;
}

/* ---- a performance ---- */

/* A pose of the mouth in speech, held from reached_s to left_s. */
typedef struct key {
    double reached_s, left_s;
    double firmness; /* 0: the mouth takes the shape of its neighbours; 1: its own shape */
    double deg[JOINT_COUNT];
} key;

/* A face that is reached, held and left. Later strokes override earlier ones. */
typedef struct stroke {
    double start_s, rise_s, hold_s, fall_s;
    face_half half;
    double deg[JOINT_COUNT];
} stroke;

typedef struct wrist_key {
    double time_s, pitch_deg, yaw_deg;
} wrist_key;

typedef struct performance {
    key keys[KEYS_MAX];
    int key_count;
    stroke strokes[STROKES_MAX];
    int stroke_count;
    wrist_key wrist[WRIST_MAX];
    int wrist_count;
    double length_s;
    uint64_t random;
} performance;

static _Noreturn void refuse(const char *what, const char *name)
{
    fprintf(stderr, "demo_face: %s: %s\n", what, name);
    exit(1);
}

/* Returns the weakened hand pose of a face of that half. */
static void hand_of(double out[JOINT_COUNT], const char *name, face_half half, double share)
{
    for (int f = 0; f < FACE_COUNT; ++f)
        if (face_recipes[f].half == half && strcmp(face_recipes[f].name, name) == 0) {
            for (int i = 0; i < JOINT_COUNT; ++i)
                out[i] = share * posed_hands[DEVICE_JOINTS][f].deg[i];
            return;
        }
    refuse("no such face", name);
}

typedef struct timing {
    double start_s, rise_s, hold_s, fall_s;
} timing;

static void add_stroke(performance *p, const char *face, face_half half, double share, timing t)
{
    double furthest = 0.0;
    if (p->stroke_count == STROKES_MAX)
        refuse("too many strokes", face);
    stroke *s = &p->strokes[p->stroke_count++];
    *s = (stroke){t.start_s, t.rise_s, t.hold_s, t.fall_s, half, {0}};
    hand_of(s->deg, face, half, share);
    for (int i = 0; i < JOINT_COUNT; ++i)
        furthest = larger(furthest, magnitude(s->deg[i]));
    s->rise_s = larger(s->rise_s, furthest * peak_of_minimum_jerk / speed_most);
    s->fall_s = larger(s->fall_s, furthest * peak_of_minimum_jerk / speed_most);
}

static void add_blink(performance *p, double closed_s)
{
    add_stroke(p, "eyes closed", HALF_UPPER, 1.0, (timing){closed_s - 0.16, 0.16, 0.04, 0.20});
}

static void add_wrist(performance *p, double time_s, double pitch_deg, double yaw_deg)
{
    if (p->wrist_count == WRIST_MAX)
        refuse("too many movements", "wrist");
    p->wrist[p->wrist_count++] = (wrist_key){time_s, pitch_deg, yaw_deg};
}

/* ---- speech: phonemes ---- */

typedef struct phone {
    double start_s, end_s;
    char name[9], word[32];
    bool is_pause, is_stressed;
} phone;

typedef struct speech {
    phone phones[PHONES_MAX];
    int count;
} speech;

static void read_speech(speech *out, const char *path)
{
    char line[128];
    FILE *in = fopen(path, "rb");
    if (!in)
        refuse("cannot read", path);
    while (fgets(line, sizeof line, in)) {
        int seconds, thousandths, used = 0;
        char name[9] = "", word[32] = "";
        if (sscanf(line, "%4d.%3d,%8[^,],%n%30[^\n]", &seconds, &thousandths, name, &used, word) <
                3 ||
            used == 0)
            continue;
        if (out->count == PHONES_MAX)
            refuse("too many phonemes", path);
        phone *now = &out->phones[out->count++];
        *now = (phone){.start_s = seconds + 0.001 * thousandths, .is_pause = name[0] == '_'};
        now->end_s = now->start_s;
        memcpy(now->name, name, sizeof name);
        memcpy(now->word, word, sizeof word);
        now->is_stressed = strchr(word, '*') != NULL;
        if (out->count > 1)
            now[-1].end_s = now->start_s;
    }
    fclose(in);
    if (out->count < 2)
        refuse("no phonemes", path);
}

/* ---- speech: visemes ---- */

typedef enum manner { VOWEL = 0, CONSONANT, CLOSURE, GLIDE } manner;

/* English phonemes with their names in espeak-ng. `then`: end of a diphthong. */
static const struct sound {
    const char *name, *viseme, *then;
    manner manner;
    double share, firmness;
} sounds[] = {
    {"p", "PP", NULL, CLOSURE, 1.0, 1.0},    {"b", "PP", NULL, CLOSURE, 1.0, 1.0},
    {"m", "PP", NULL, CLOSURE, 1.0, 1.0},    {"f", "FF", NULL, CONSONANT, 1.0, 0.95},
    {"v", "FF", NULL, CONSONANT, 1.0, 0.95}, {"T", "TH", NULL, CONSONANT, 1.0, 0.9},
    {"D", "TH", NULL, CONSONANT, 1.0, 0.9},  {"t", "DD", NULL, CONSONANT, 0.9, 0.5},
    {"d", "DD", NULL, CONSONANT, 0.9, 0.5},  {"n", "nn", NULL, CONSONANT, 1.0, 0.5},
    {"l", "nn", NULL, CONSONANT, 1.0, 0.5},  {"l#", "nn", NULL, CONSONANT, 1.0, 0.5},
    {"k", "kk", NULL, CONSONANT, 0.9, 0.4},  {"g", "kk", NULL, CONSONANT, 0.9, 0.4},
    {"N", "kk", NULL, CONSONANT, 0.7, 0.4},  {"s", "SS", NULL, CONSONANT, 1.0, 0.8},
    {"z", "SS", NULL, CONSONANT, 1.0, 0.8},  {"S", "CH", NULL, CONSONANT, 1.0, 0.9},
    {"Z", "CH", NULL, CONSONANT, 1.0, 0.9},  {"tS", "CH", NULL, CONSONANT, 1.0, 0.9},
    {"dZ", "CH", NULL, CONSONANT, 1.0, 0.9}, {"r", "RR", NULL, GLIDE, 0.9, 0.7},
    {"r-", "RR", NULL, GLIDE, 0.7, 0.5},     {"w", "U", NULL, GLIDE, 1.0, 0.95},
    {"j", "I", NULL, GLIDE, 0.8, 0.5},       {"h", "E", NULL, GLIDE, 0.8, 0.0},
    {"a", "aa", NULL, VOWEL, 0.95, 0.9},     {"A:", "aa", NULL, VOWEL, 1.0, 0.9},
    {"A@", "aa", NULL, VOWEL, 1.0, 0.9},     {"V", "aa", NULL, VOWEL, 0.8, 0.8},
    {"0", "O", NULL, VOWEL, 1.0, 0.9},       {"O:", "O", NULL, VOWEL, 1.0, 0.95},
    {"o@", "O", NULL, VOWEL, 1.0, 0.95},     {"O@", "O", NULL, VOWEL, 1.0, 0.95},
    {"U", "U", NULL, VOWEL, 0.85, 0.8},      {"u:", "U", NULL, VOWEL, 1.0, 0.95},
    {"i:", "I", NULL, VOWEL, 1.0, 0.9},      {"i", "I", NULL, VOWEL, 0.9, 0.7},
    {"I", "I", NULL, VOWEL, 0.9, 0.7},       {"I2", "I", NULL, VOWEL, 0.8, 0.5},
    {"E", "E", NULL, VOWEL, 1.0, 0.85},      {"3:", "E", NULL, VOWEL, 0.9, 0.7},
    {"@", "E", NULL, VOWEL, 0.7, 0.4},       {"@L", "nn", NULL, VOWEL, 0.8, 0.5},
    {"a#", "E", NULL, VOWEL, 0.7, 0.4},      {"e@", "E", "E", VOWEL, 1.0, 0.8},
    {"i@", "I", "E", VOWEL, 0.9, 0.7},       {"U@", "U", "E", VOWEL, 0.9, 0.8},
    {"aI", "aa", "I", VOWEL, 1.0, 0.9},      {"eI", "E", "I", VOWEL, 1.0, 0.9},
    {"OI", "O", "I", VOWEL, 1.0, 0.95},      {"aU", "aa", "U", VOWEL, 1.0, 0.9},
    {"oU", "O", "U", VOWEL, 1.0, 0.95},
};

static const struct sound *sound_named(const char *name)
{
    for (size_t i = 0; i < sizeof sounds / sizeof *sounds; ++i)
        if (strcmp(sounds[i].name, name) == 0)
            return &sounds[i];
    refuse("add a viseme for the phoneme to demo_face.c", name);
}

static key *add_key(performance *p, const char *face, double share, double firmness,
                    double reached_s, double left_s)
{
    if (p->key_count == KEYS_MAX)
        refuse("too many keys", face ? face : "rest");
    key *out = &p->keys[p->key_count++];
    *out = (key){reached_s, larger(left_s, reached_s), firmness, {0}};
    if (face)
        hand_of(out->deg, face, HALF_MOUTH, share);
    return out;
}

static const double lead_s = 0.05; /* time before the sound at which the mouth has its shape */
static const double pause_least_s = 0.2;

/* A closure is reached earlier, because the lips need 60 ms to close after the thumb presses. */
static void add_sound_keys(performance *p, const phone *now)
{
    const struct sound *is = sound_named(now->name);
    const double s = now->start_s - lead_s, d = now->end_s - now->start_s, e = s + d;
    switch (is->manner) {
    case CLOSURE:
        (void)add_key(p, is->viseme, is->share, is->firmness, now->start_s - 0.045,
                      larger(now->end_s - 0.01, now->start_s + 0.02));
        return;
    case CONSONANT:
        (void)add_key(p, is->viseme, is->share, is->firmness, s + 0.25 * d, e - 0.25 * d);
        return;
    case GLIDE:
        (void)add_key(p, is->viseme, is->share, is->firmness, s + 0.4 * d, e - 0.4 * d);
        return;
    case VOWEL:
        break;
    }
    if (!is->then) {
        (void)add_key(p, is->viseme, is->share, is->firmness, s + 0.4 * d, e - 0.3 * d);
        return;
    }
    (void)add_key(p, is->viseme, is->share, is->firmness, s + 0.35 * d, s + 0.45 * d);
    (void)add_key(p, is->then, 0.9, 0.7, s + 0.9 * d, e);
}

/* The mouth in a pause, from the end of the sound before it to the preparation of the next
 * mouth. */
static void add_pause_keys(performance *p, double start_s, double end_s)
{
    if (end_s - start_s < pause_least_s)
        return;
    const double reached_s = start_s + 0.14, left_s = end_s - 0.22;
    (void)add_key(p, "smile", 0.8, 0.9, smaller(reached_s, left_s), left_s);
}

/* Only the thumb closes the lips, in any shape of the mouth. */
static double firmness_of(const key *k, int joint)
{
    static const double of_shape = 0.6;
    return k->firmness >= 1.0 && joint > JOINT_THUMB_TIP ? of_shape : k->firmness;
}

/* Blends the weak key with the nearest firm keys before and after it, weighted by their distance in
 * time. */
static void coarticulate(performance *p)
{
    static double own[KEYS_MAX][JOINT_COUNT];
    for (int k = 0; k < p->key_count; ++k)
        memcpy(own[k], p->keys[k].deg, sizeof own[k]);
    for (int k = 1; k + 1 < p->key_count; ++k) {
        key *now = &p->keys[k];
        int before = k - 1, after = k + 1;
        while (before > 0 && p->keys[before].firmness < 0.65)
            before -= 1;
        while (after + 1 < p->key_count && p->keys[after].firmness < 0.65)
            after += 1;
        const double from_s = p->keys[before].left_s, to_s = p->keys[after].reached_s;
        const double middle_s = 0.5 * (now->reached_s + now->left_s);
        const double w = to_s > from_s ? (middle_s - from_s) / (to_s - from_s) : 0.5;
        const double way = smaller(larger(w, 0.0), 1.0);
        for (int i = 0; i < JOINT_COUNT; ++i)
            now->deg[i] = firmness_of(now, i) * own[k][i] +
                          (1.0 - firmness_of(now, i)) *
                              (own[before][i] + way * (own[after][i] - own[before][i]));
    }
}

static double needed_s(const key *a, const key *b)
{
    double furthest = 0.0;
    for (int i = 0; i < JOINT_COUNT; ++i)
        furthest = larger(furthest, magnitude(b->deg[i] - a->deg[i]));
    return furthest * peak_of_minimum_jerk / speed_most;
}

/* Limits the speed: shortens holds first, then moves the weaker of two keys nearer to the other. */
static void keep_speed(performance *p)
{
    static const double gap_least_s = 0.04, hold_of_closure_s = 0.08;
    for (int pass = 0; pass < 200; ++pass)
        for (int k = 0; k + 1 < p->key_count; ++k) {
            key *a = &p->keys[k], *b = &p->keys[k + 1];
            double lacks_s = larger(needed_s(a, b), gap_least_s) - (b->reached_s - a->left_s);
            if (lacks_s <= 1e-6)
                continue;
            const double hold_a = a->firmness >= 1.0 ? hold_of_closure_s : 0.0;
            const double hold_b = b->firmness >= 1.0 ? hold_of_closure_s : 0.0;
            const double from_a =
                smaller(lacks_s * 0.5, larger(a->left_s - a->reached_s - hold_a, 0.0));
            a->left_s -= from_a;
            const double from_b =
                b->firmness >= 1.0
                    ? 0.0
                    : smaller(lacks_s - from_a, larger(b->left_s - b->reached_s - hold_b, 0.0));
            b->reached_s += from_b;
            lacks_s -= from_a + from_b;
            if (lacks_s <= 1e-6)
                continue;
            const double gap_s = larger(b->reached_s - a->left_s, 0.01);
            const double most_deg = gap_s * speed_most / peak_of_minimum_jerk;
            for (int i = 0; i < JOINT_COUNT; ++i) {
                const double way = b->deg[i] - a->deg[i];
                const double over = magnitude(way) - most_deg;
                if (over <= 0.0)
                    continue;
                const double give = way < 0.0 ? -over : over;
                const double firm_a = firmness_of(a, i), firm_b = firmness_of(b, i);
                if (firm_a < firm_b)
                    a->deg[i] += give;
                else if (firm_a > firm_b)
                    b->deg[i] -= give;
                else {
                    a->deg[i] += 0.5 * give;
                    b->deg[i] -= 0.5 * give;
                }
            }
        }
}

static void author_mouth(performance *p, const speech *said)
{
    const phone *last = &said->phones[said->count - 1];
    (void)add_key(p, NULL, 0.0, 1.0, 0.0, said->phones[0].start_s - 0.32);
    for (int i = 0; i < said->count; ++i) {
        const phone *now = &said->phones[i];
        if (!now->is_pause) {
            add_sound_keys(p, now);
            continue;
        }
        const double start_s = now->start_s;
        while (i + 1 < said->count && said->phones[i + 1].is_pause)
            i += 1;
        if (i + 1 < said->count)
            add_pause_keys(p, start_s, said->phones[i].end_s);
    }
    (void)add_key(p, NULL, 0.0, 0.6, last->start_s + 0.25, last->start_s + 100.0);
    coarticulate(p);
    keep_speed(p);
}

/* ---- speech: the upper half and the head ---- */

/* Finds the start and the length of pause number i; adjacent pauses are merged. */
static int find_pauses(double start_s[PHONES_MAX], double length_s[PHONES_MAX], const speech *said)
{
    int count = 0;
    for (int i = 0; i < said->count; ++i) {
        if (!said->phones[i].is_pause)
            continue;
        const double from_s = said->phones[i].start_s;
        while (i + 1 < said->count && said->phones[i + 1].is_pause)
            i += 1;
        if (said->phones[i].end_s - from_s < pause_least_s)
            continue;
        start_s[count] = from_s;
        length_s[count++] = said->phones[i].end_s - from_s;
    }
    return count;
}

/* The performer wakes, looks at the viewer, looks aside in every other pause, blinks in the others,
 * lifts the brows on stressed words, and ends with a wink. */
static void author_upper(performance *p, const speech *said)
{
    double pause_s[PHONES_MAX], length_s[PHONES_MAX];
    const int pause_count = find_pauses(pause_s, length_s, said);
    add_stroke(p, "look right", HALF_UPPER, 1.0, (timing){0.55, 0.16, 0.12, 0.2});
    add_blink(p, 1.05);
    add_stroke(p, "surprise", HALF_UPPER, 0.85,
               (timing){said->phones[0].start_s - 0.2, 0.2, 0.3, 0.35});
    for (int i = 0; i < said->count; ++i) {
        if (!said->phones[i].is_stressed)
            continue;
        double end_s = said->phones[i].end_s;
        for (int k = i + 1;
             k < said->count && !said->phones[k].word[0] && !said->phones[k].is_pause; ++k)
            end_s = said->phones[k].end_s;
        add_stroke(p, "surprise", HALF_UPPER, 0.9,
                   (timing){said->phones[i].start_s - 0.12, 0.18,
                            0.55 * (end_s - said->phones[i].start_s), 0.3});
    }
    for (int i = 0; i < pause_count; ++i) {
        if (i % 4 == 2)
            add_stroke(p, "look left", HALF_UPPER, 1.0,
                       (timing){pause_s[i] - 0.1, 0.18, length_s[i] + 0.25, 0.22});
        else if (i % 4 == 0)
            add_stroke(p, "look right", HALF_UPPER, 1.0,
                       (timing){pause_s[i] - 0.05, 0.18, length_s[i] - 0.15, 0.2});
        if (i % 2 == 1)
            add_blink(p, pause_s[i] + 0.12);
    }
    const double end_s = said->phones[said->count - 1].start_s;
    add_stroke(p, "wink left", HALF_UPPER, 1.0, (timing){end_s + 0.02, 0.2, 0.3, 0.25});
    add_stroke(p, "joy", HALF_MOUTH, 1.0, (timing){end_s - 0.02, 0.3, 0.5, 0.35});
}

/* The head is never still: it drifts, and nods on stressed words. */
static void author_head(performance *p, const speech *said)
{
    double time_s = 0.55;
    add_wrist(p, 0.0, 0.0, 0.0);
    add_wrist(p, 0.5, 0.0, 0.0);
    for (int i = 0; i < said->count; ++i) {
        const phone *now = &said->phones[i];
        if (!now->word[0] || now->start_s < time_s + 0.42)
            continue;
        time_s = now->start_s + 0.06;
        const double yaw_deg = 9.0 * next_random(&p->random);
        add_wrist(p, time_s - 0.3, -5.0 + 2.0 * next_random(&p->random), 0.6 * yaw_deg);
        add_wrist(p, time_s, now->is_stressed ? 9.0 : 4.0 * next_random(&p->random),
                  now->is_stressed ? 0.3 * yaw_deg : yaw_deg);
    }
    const double end_s = said->phones[said->count - 1].start_s;
    add_wrist(p, larger(end_s, time_s + 0.3), -2.0, 10.0);
    add_wrist(p, end_s + 0.6, -2.0, 10.0);
    add_wrist(p, end_s + 0.9, 0.0, 0.0);
}

static void author_demo(performance *p, const char *phonemes)
{
    static speech said;
    read_speech(&said, phonemes);
    p->random = 20261125;
    p->length_s = said.phones[said.count - 1].start_s + 1.2;
    author_mouth(p, &said);
    author_upper(p, &said);
    author_head(p, &said);
}

/* ---- emotions ---- */

typedef struct emotion {
    const char *face;
    const char *before; /* preparation with the upper half; NULL: none */
    double rise_s, fall_s, mouth_late_s, pitch_deg, yaw_deg;
} emotion;

static const emotion emotions[] = {
    {"joy", "brows down", 0.30, 0.30, 0.06, -9.0, 6.0},
    {"surprise", "eyes closed", 0.22, 0.34, 0.05, -12.0, 0.0},
    {"sadness", "look down", 0.48, 0.36, 0.14, 15.0, -9.0},
    {"anger", "eyes closed", 0.28, 0.30, 0.10, 12.0, 0.0},
    {"wink left", "brows up", 0.22, 0.24, -0.08, -3.0, 14.0},
    {"contempt", "look right", 0.34, 0.34, 0.12, -10.0, -13.0},
    {"fear", "eyes wide", 0.24, 0.36, 0.08, -9.0, 12.0},
    {"sleepy", "brows up", 0.60, 0.30, 0.16, 17.0, 6.0},
};
enum { EMOTIONS = sizeof emotions / sizeof *emotions };
static const double emotion_s = 1.7, first_emotion_s = 0.6, held_until_s = 1.08;

/* Each expression starts with a small opposite movement, then the upper half, then the mouth. It
 * overshoots the face and returns to it. At the end the mouth leaves first. */
static void author_emotions(performance *p)
{
    p->random = 20261126;
    p->length_s = first_emotion_s + EMOTIONS * emotion_s - 0.35;
    (void)add_key(p, NULL, 0.0, 1.0, 0.0, p->length_s);
    add_wrist(p, 0.0, 0.0, 0.0);
    add_wrist(p, 0.5, 0.0, 0.0);
    for (int i = 0; i < EMOTIONS; ++i) {
        const emotion *e = &emotions[i];
        const double start_s = first_emotion_s + emotion_s * i;
        const double end_s = start_s + held_until_s;
        const double upper_s = start_s + e->rise_s, mouth_s = start_s + e->mouth_late_s;
        add_stroke(p, e->before, HALF_UPPER, 0.8, (timing){start_s - 0.16, 0.14, 0.02, e->rise_s});
        add_stroke(p, e->face, HALF_UPPER, 1.0,
                   (timing){start_s, e->rise_s, end_s + 0.1 - upper_s, e->fall_s});
        add_stroke(p, e->face, HALF_MOUTH, 1.0,
                   (timing){mouth_s, e->rise_s, end_s - mouth_s - e->rise_s, e->fall_s});
        add_wrist(p, start_s - 0.02, -0.3 * e->pitch_deg, -0.2 * e->yaw_deg);
        add_wrist(p, start_s + 1.3 * e->rise_s, 1.15 * e->pitch_deg, 1.15 * e->yaw_deg);
        add_wrist(p, start_s + 1.3 * e->rise_s + 0.3, e->pitch_deg, e->yaw_deg);
        add_wrist(p, end_s + 0.04, 0.9 * e->pitch_deg, e->yaw_deg);
    }
    add_wrist(p, p->length_s, 0.0, 0.0);
}

/* ---- interpolation ---- */

static double weight_of(const stroke *s, double time_s)
{
    const double fall_start_s = s->start_s + s->rise_s + larger(s->hold_s, 0.0);
    return smaller(minimum_jerk((time_s - s->start_s) / s->rise_s),
                   1.0 - minimum_jerk((time_s - fall_start_s) / s->fall_s));
}

static void joints_at(const performance *p, double time_s, double out_deg[JOINT_COUNT])
{
    int k = 0;
    while (k + 1 < p->key_count && time_s >= p->keys[k + 1].reached_s)
        k += 1;
    memcpy(out_deg, p->keys[k].deg, sizeof p->keys[k].deg);
    if (k + 1 < p->key_count) {
        const key *a = &p->keys[k], *b = &p->keys[k + 1];
        const double gap_s = larger(b->reached_s - a->left_s, 0.001);
        const double way = minimum_jerk((time_s - a->left_s) / gap_s);
        for (int i = 0; i < JOINT_COUNT; ++i)
            out_deg[i] += way * (b->deg[i] - a->deg[i]);
    }
    for (int s = 0; s < p->stroke_count; ++s) {
        const stroke *now = &p->strokes[s];
        const double weight = weight_of(now, time_s);
        for (int i = half_first_joint[now->half]; i < half_first_joint[now->half + 1]; ++i)
            out_deg[i] += weight * (now->deg[i] - out_deg[i]);
    }
}

static void wrist_at(const performance *p, double time_s, double out_deg[2])
{
    int k = 0;
    while (k + 1 < p->wrist_count && time_s >= p->wrist[k + 1].time_s)
        k += 1;
    const wrist_key *a = &p->wrist[k], *b = k + 1 < p->wrist_count ? a + 1 : a;
    const double way = b == a ? 0.0 : minimum_jerk((time_s - a->time_s) / (b->time_s - a->time_s));
    out_deg[0] = a->pitch_deg + way * (b->pitch_deg - a->pitch_deg);
    out_deg[1] = a->yaw_deg + way * (b->yaw_deg - a->yaw_deg);
}

/* ---- the sensors ---- */

/* The neutral pose: a relaxed hand with a little curl and spread. */
static const struct sensor {
    const char *name;
    double neutral_deg;
    int joint; /* joint that it follows; JOINT_COUNT and above: wrist */
} sensors[] = {
    {"thumb.roll", 66, JOINT_THUMB_ROLL},     {"thumb.mpj", 12, JOINT_THUMB_MIDDLE},
    {"thumb.ij", 26, JOINT_THUMB_TIP},        {"thumb.abd", 20, JOINT_THUMB_DROP},
    {"index.mpj", 34, JOINT_INDEX_KNUCKLE},   {"index.pij", 36, JOINT_INDEX_CURL},
    {"middle.mpj", 36, JOINT_MIDDLE_KNUCKLE}, {"middle.pij", 38, JOINT_MIDDLE_CURL},
    {"middle.abd", 5, JOINT_SPREAD},          {"ring.mpj", 36, JOINT_RING_KNUCKLE},
    {"ring.pij", 38, JOINT_RING_CURL},        {"ring.abd", 5, JOINT_SPREAD},
    {"little.mpj", 34, JOINT_LITTLE_KNUCKLE}, {"little.pij", 36, JOINT_LITTLE_CURL},
    {"little.abd", 6, JOINT_SPREAD},          {"palm.arch", 8, JOINT_ARCH},
    {"wrist.pitch", -5, JOINT_COUNT},         {"wrist.yaw", 0, JOINT_COUNT + 1},
};
enum { SENSORS = sizeof sensors / sizeof *sensors };

/* Random knots and a smooth curve through them. */
typedef struct wander {
    double from, to;
    int knot;
} wander;

static double wander_at(wander *w, double time_s, double period_s, uint64_t *random)
{
    const double knots = time_s / period_s;
    while (w->knot <= (int)knots) {
        w->knot += 1;
        w->from = w->to;
        w->to = next_random(random);
    }
    return w->from + minimum_jerk(knots - (int)knots) * (w->to - w->from);
}

static const double drift_deg = 0.5, drift_period_s = 1.3;
static const double tremor_deg = 0.12, tremor_period_s = 0.06; /* 8 to 10 per second */

/* Uses integers, because the rounding of printf differs between libraries. */
static void write_angle(FILE *out, double deg)
{
    const double hundredths = 100.0 * deg;
    const int32_t whole = (int32_t)(hundredths < 0.0 ? hundredths - 0.5 : hundredths + 0.5);
    const int32_t size = whole < 0 ? -whole : whole;
    fprintf(out, ",%s%d.%02d", whole < 0 ? "-" : "", size / 100, size % 100);
}

/* Limits the speed of a joint where strokes cross. */
static void keep_pace(double deg[JOINT_COUNT], double before_deg[JOINT_COUNT])
{
    const double most_deg = 1.02 * speed_most / RATE_HZ;
    for (int i = 0; i < JOINT_COUNT; ++i) {
        const double way = smaller(larger(deg[i] - before_deg[i], -most_deg), most_deg);
        deg[i] = before_deg[i] += way;
    }
}

static void write_records(FILE *out, performance *p)
{
    double before_deg[JOINT_COUNT] = {0};
    wander drift[SENSORS] = {{0}}, tremor[SENSORS] = {{0}};
    const int count = (int)(p->length_s * RATE_HZ + 0.5);
    for (int k = 0; k < count; ++k) {
        const double time_s = (double)k / RATE_HZ;
        double deg[JOINT_COUNT + 2];
        joints_at(p, time_s, deg);
        keep_pace(deg, before_deg);
        wrist_at(p, time_s, deg + JOINT_COUNT);
        fprintf(out, "%d.%02d", k / RATE_HZ, k % RATE_HZ);
        for (int i = 0; i < SENSORS; ++i) {
            const double unrest =
                drift_deg * wander_at(&drift[i], time_s, drift_period_s, &p->random) +
                tremor_deg * wander_at(&tremor[i], time_s, tremor_period_s, &p->random);
            write_angle(out, sensors[i].neutral_deg + deg[sensors[i].joint] + unrest);
        }
        fputc('\n', out);
    }
}

static void write_header(FILE *out, const char *about)
{
    fprintf(out,
            "# marotte log: %s\n# Written by plugins/one_hand/demo_face.c. The neutral pose first. "
            "Distal joints are not measured: they are estimated.\ntime_s",
            about);
    for (int i = 0; i < SENSORS; ++i)
        fprintf(out, ",right.%s", sensors[i].name);
    fputs("\nunit", out);
    for (int i = 0; i < SENSORS; ++i)
        fputs(",deg", out);
    fputc('\n', out);
}

int main(int argument_count, char **arguments)
{
    static performance p;
    const bool is_demo = argument_count >= 3 && strcmp(arguments[1], "demo") == 0;
    const bool is_emotions = argument_count >= 2 && strcmp(arguments[1], "emotions") == 0;
    const int file = is_demo ? 3 : 2;
    if ((!is_demo && !is_emotions) || argument_count > file + 1) {
        fputs("usage: demo_face demo PHONEMES.csv [FILE]\n"
              "       demo_face emotions [FILE]\n",
              stderr);
        return 2;
    }
    if (is_demo)
        author_demo(&p, arguments[2]);
    else
        author_emotions(&p);
    FILE *out = argument_count > file ? fopen(arguments[file], "wb") : stdout;
    if (!out)
        refuse("cannot write", arguments[file]);
    write_header(out, is_demo ? "one right hand says what demo.txt has and demo.ogg sounds."
                              : "one right hand performs eight expressions.");
    write_records(out, &p);
    const int failed = ferror(out);
    if (fclose(out) != 0 || failed)
        refuse("the file is not complete", argument_count > file ? arguments[file] : "output");
    return 0;
}
