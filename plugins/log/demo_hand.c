/* demo_hand right|left [FILE] - writes the demo recordings of marotte, 20 s at 100 Hz, as log
 * tables. The right hand talks (two sentences on the thumb), lifts the index finger, spreads, makes
 * a fist, moves slowly and rests. The left hand performs together with it, with its own movements:
 * it talks with other syllables, answers the lift, and reaches out while the other hand makes a
 * fist. Movements are minimum-jerk, and neighbouring fingers follow a moving finger. Sensors have
 * the steps and ranges that measure_log found in real recordings (README.md). The output has the
 * same bytes on every machine: integers, + - * / and a built-in random generator. */
#include <stdint.h>
#include <stdio.h>
#include <string.h>

enum { RATE_HZ = 100, RECORD_COUNT = 20 * RATE_HZ, MOVE_MAX = 512 };

/* ---- the sensors, in the order of their columns ---- */

enum {
    ROLL,
    THUMB_MPJ,
    THUMB_IJ,
    THUMB_ABD,
    INDEX_MPJ,
    INDEX_PIJ,
    MIDDLE_MPJ,
    MIDDLE_PIJ,
    MIDDLE_ABD,
    RING_MPJ,
    RING_PIJ,
    RING_ABD,
    LITTLE_MPJ,
    LITTLE_PIJ,
    LITTLE_ABD,
    ARCH,
    PITCH,
    YAW,
    SENSOR_COUNT
};

static const struct sensor {
    const char *name;
    int32_t step; /* measured, in 1e-5 rad */
    double low, high,
        talk; /* rad: 1st and 99th percentile of the measurements; relaxed pose while talking */
} sensors[SENSOR_COUNT] = {
    {"thumb.roll", 1584, 0.27, 2.09, 1.45},   {"thumb.mpj", 1459, -0.47, 0.55, 0.15},
    {"thumb.ij", 1427, -0.14, 0.78, 0.20},    {"thumb.abd", 502, -0.10, 0.70, 0.34},
    {"index.mpj", 1616, -0.16, 1.68, 0.62},   {"index.pij", 1459, -0.01, 2.35, 0.52},
    {"middle.mpj", 1725, -0.45, 1.78, 0.68},  {"middle.pij", 1804, -0.51, 2.36, 0.60},
    {"middle.abd", 449, -0.18, 0.33, -0.04},  {"ring.mpj", 1757, -0.39, 1.55, 0.72},
    {"ring.pij", 1788, -0.41, 2.40, 0.64},    {"ring.abd", 612, -0.18, 0.75, -0.05},
    {"little.mpj", 1663, -0.12, 1.66, 0.70},  {"little.pij", 1820, -0.25, 2.77, 0.60},
    {"little.abd", 596, -0.19, 0.46, -0.04},  {"palm.arch", 910, -0.19, 0.58, 0.12},
    {"wrist.pitch", 863, -0.29, 0.15, -0.08}, {"wrist.yaw", 392, -0.16, 0.12, 0.0},
};

/* Share of a finger's movement that the others follow, index to little: nobody can move only the
 * ring finger. */
static const double enslaved[4][4] = {
    {1.00, 0.16, 0.06, 0.02},
    {0.12, 1.00, 0.34, 0.10},
    {0.05, 0.26, 1.00, 0.40},
    {0.02, 0.10, 0.46, 1.00},
};
static const int finger_mpj[4] = {INDEX_MPJ, MIDDLE_MPJ, RING_MPJ, LITTLE_MPJ};

/* ---- movements ---- */

typedef struct move {
    int sensor;
    double start_s, duration_s, amount_rad;
} move;

typedef struct performance {
    move moves[MOVE_MAX];
    int count;
} performance;

typedef struct timing {
    double start_s, rise_s, hold_s, fall_s;
} timing;

static void add_move(performance *p, int sensor, double start_s, double duration_s,
                     double amount_rad)
{
    if (p->count < MOVE_MAX)
        p->moves[p->count++] = (move){sensor, start_s, duration_s, amount_rad};
}

/* Moves there, holds, and moves back. */
static void add_stroke(performance *p, int sensor, timing t, double amount_rad)
{
    add_move(p, sensor, t.start_s, t.rise_s, amount_rad);
    add_move(p, sensor, t.start_s + t.rise_s + t.hold_s, t.fall_s, -amount_rad);
}

/* Moves one finger (0 index .. 3 little); its neighbours follow a little later and in part. */
static void add_finger_stroke(performance *p, int finger, timing t, double mpj_rad, double pij_rad)
{
    for (int other = 0; other < 4; ++other) {
        double share = enslaved[finger][other];
        timing late = t;
        if (other != finger)
            late.start_s += 0.03;
        add_stroke(p, finger_mpj[other], late, share * mpj_rad);
        add_stroke(p, finger_mpj[other] + 1, late, share * pij_rad);
    }
}

/* Moves all fingers, the little finger first, like a real hand. */
static void add_hand_stroke(performance *p, timing t, double mpj_rad, double pij_rad)
{
    for (int finger = 0; finger < 4; ++finger) {
        timing own = t;
        own.start_s += 0.025 * (3 - finger);
        add_stroke(p, finger_mpj[finger], own, mpj_rad);
        add_stroke(p, finger_mpj[finger] + 1, own, pij_rad);
    }
}

/* ---- the right hand's performance ---- */

typedef struct syllable {
    double duration_s, opening; /* 3 to 5 per second; 0 .. 1 */
} syllable;

static const syllable first_sentence[] = {
    {0.24, 0.80}, {0.21, 0.50}, {0.30, 1.00}, {0.22, 0.45}, {0.26, 0.70}, {0.33, 0.95},
    {0.20, 0.40}, {0.25, 0.80}, {0.28, 0.60}, {0.23, 0.90}, {0.31, 0.75},
};
static const syllable second_sentence[] = {
    {0.22, 0.60}, {0.27, 0.95}, {0.20, 0.40}, {0.24, 0.70}, {0.21, 0.50}, {0.32, 1.00},
    {0.25, 0.65}, {0.20, 0.45}, {0.29, 0.85}, {0.23, 0.55}, {0.22, 0.70}, {0.33, 0.90},
};

/* The thumb is the jaw: it opens faster than it closes. The fingers follow a little. */
static void add_sentence(performance *p, double start_s, const syllable *syllables, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        double duration_s = syllables[i].duration_s, opening = syllables[i].opening;
        timing t = {start_s, 0.44 * duration_s, 0.04 * duration_s, 0.52 * duration_s};
        add_stroke(p, THUMB_ABD, t, 0.30 * opening);
        add_stroke(p, THUMB_MPJ, t, -0.22 * opening);
        add_stroke(p, THUMB_IJ, t, -0.10 * opening);
        for (int finger = 0; finger < 4; ++finger)
            add_stroke(p, finger_mpj[finger], t, (-0.09 + 0.015 * finger) * opening);
        start_s += duration_s;
    }
}

static void add_brow_lifts(performance *p)
{
    add_finger_stroke(p, 0, (timing){8.45, 0.20, 0.22, 0.30}, -0.62, -0.36);
    add_finger_stroke(p, 0, (timing){9.35, 0.16, 0.10, 0.26}, -0.48, -0.28);
}

static void add_spread(performance *p)
{
    timing t = {10.35, 0.46, 0.62, 0.60};
    add_hand_stroke(p, t, -0.66, -0.46);
    add_stroke(p, MIDDLE_ABD, t, 0.30);
    add_stroke(p, RING_ABD, t, 0.26);
    add_stroke(p, LITTLE_ABD, t, 0.40);
    add_stroke(p, THUMB_ABD, t, 0.30);
    add_stroke(p, ROLL, t, -0.70);
    add_stroke(p, PITCH, t, 0.16);
}

static void add_fist(performance *p)
{
    timing t = {12.40, 0.52, 0.66, 0.70};
    add_hand_stroke(p, t, 0.66, 1.15);
    timing late = {12.52, 0.46, 0.50, 0.62};
    add_stroke(p, ROLL, late, 0.45);
    add_stroke(p, THUMB_ABD, late, 0.32);
    add_stroke(p, THUMB_MPJ, late, 0.04);
    add_stroke(p, THUMB_IJ, late, 0.38);
    add_stroke(p, PITCH, t, -0.16);
    add_stroke(p, YAW, t, -0.09);
}

/* A slow wave through the fingers, the palm and the wrist. */
static void add_slow_moves(performance *p)
{
    add_finger_stroke(p, 3, (timing){14.60, 0.80, 0.30, 1.00}, -0.50, -0.40);
    add_finger_stroke(p, 2, (timing){15.00, 0.85, 0.25, 1.00}, -0.34, -0.24);
    add_finger_stroke(p, 1, (timing){15.55, 0.80, 0.35, 0.95}, -0.52, -0.40);
    add_finger_stroke(p, 0, (timing){15.95, 0.85, 0.45, 0.90}, -0.50, -0.34);
    add_stroke(p, ARCH, (timing){14.70, 1.10, 0.30, 1.30}, 0.34);
    add_stroke(p, THUMB_ABD, (timing){15.30, 0.95, 0.50, 1.10}, 0.24);
    add_stroke(p, ROLL, (timing){15.10, 1.10, 0.40, 1.30}, 0.34);
    add_stroke(p, YAW, (timing){14.80, 1.30, 0.20, 1.60}, 0.10);
    add_stroke(p, PITCH, (timing){16.10, 0.90, 0.20, 1.10}, -0.14);
}

static void author_right(performance *p)
{
    add_sentence(p, 1.30, first_sentence, sizeof first_sentence / sizeof first_sentence[0]);
    add_sentence(p, 4.95, second_sentence, sizeof second_sentence / sizeof second_sentence[0]);
    add_brow_lifts(p);
    add_spread(p);
    add_fist(p);
    add_slow_moves(p);
}

/* ---- the left hand's ---- */

static const syllable first_answer[] = {
    {0.31, 0.70}, {0.24, 0.95}, {0.22, 0.50}, {0.34, 0.85}, {0.21, 0.40},
    {0.27, 0.75}, {0.29, 1.00}, {0.23, 0.55}, {0.36, 0.80},
};
static const syllable second_answer[] = {
    {0.26, 0.85}, {0.21, 0.45}, {0.30, 0.70}, {0.24, 0.95}, {0.22, 0.60},
    {0.28, 0.80}, {0.20, 0.40}, {0.33, 1.00}, {0.25, 0.50}, {0.35, 0.90},
};

static void add_answering_lifts(performance *p)
{
    add_finger_stroke(p, 2, (timing){4.20, 0.26, 0.20, 0.34}, -0.40, -0.30);
    add_finger_stroke(p, 0, (timing){8.95, 0.24, 0.30, 0.34}, -0.54, -0.30);
}

/* All fingers stretch, the little finger furthest, and stay while the other hand closes. */
static void add_reach(performance *p)
{
    timing t = {10.60, 0.62, 2.35, 0.85};
    add_hand_stroke(p, t, -0.44, -0.34);
    add_finger_stroke(p, 3, (timing){12.55, 0.40, 0.40, 0.55}, -0.26, -0.20);
    add_stroke(p, LITTLE_ABD, t, 0.24);
    add_stroke(p, RING_ABD, t, 0.14);
    add_stroke(p, THUMB_ABD, (timing){12.30, 0.50, 0.55, 0.60}, 0.24);
    add_stroke(p, ROLL, t, -0.40);
    add_stroke(p, PITCH, t, 0.10);
}

/* A wave from the index finger outwards, ending in a last stretch. */
static void add_slow_answer(performance *p)
{
    add_finger_stroke(p, 0, (timing){14.75, 0.85, 0.30, 0.90}, -0.46, -0.30);
    add_finger_stroke(p, 1, (timing){15.20, 0.80, 0.25, 0.90}, -0.36, -0.28);
    add_finger_stroke(p, 2, (timing){15.60, 0.80, 0.25, 0.85}, -0.30, -0.22);
    add_finger_stroke(p, 3, (timing){15.95, 0.75, 0.30, 0.80}, -0.44, -0.36);
    add_hand_stroke(p, (timing){17.10, 0.50, 0.30, 0.60}, -0.26, -0.20);
    add_stroke(p, THUMB_ABD, (timing){15.00, 0.90, 0.40, 1.00}, 0.20);
    add_stroke(p, YAW, (timing){15.10, 1.20, 0.20, 1.40}, -0.08);
}

static void author_left(performance *p)
{
    add_sentence(p, 1.44, first_answer, sizeof first_answer / sizeof first_answer[0]);
    add_sentence(p, 5.12, second_answer, sizeof second_answer / sizeof second_answer[0]);
    add_answering_lifts(p);
    add_reach(p);
    add_slow_answer(p);
}

/* ---- interpolation ---- */

/* Flash and Hogan 1985: the smoothest way from 0 to 1. */
static double minimum_jerk(double s)
{
    if (s <= 0.0)
        return 0.0;
    if (s >= 1.0)
        return 1.0;
    return s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
}

static void pose_at(const performance *p, double time_s, double *out_rad)
{
    for (int i = 0; i < SENSOR_COUNT; ++i)
        out_rad[i] = sensors[i].talk;
    for (int i = 0; i < p->count; ++i) {
        const move *m = &p->moves[i];
        out_rad[m->sensor] += m->amount_rad * minimum_jerk((time_s - m->start_s) / m->duration_s);
    }
}

/* ---- simulation of the sensors ---- */

/* Steele, Lea, Flood 2014: SplitMix64. */
static uint64_t next_random(uint64_t *state)
{
    uint64_t z = *state += UINT64_C(0x9E3779B97F4A7C15);
    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    return z ^ (z >> 31);
}

/* Approximates a normal distribution of rms 1: sum of twelve uniform numbers of variance 1/12. */
static double next_normal(uint64_t *state)
{
    double sum = -6.0;
    for (int i = 0; i < 12; ++i)
        sum += (double)(next_random(state) >> 11) * (1.0 / 9007199254740992.0);
    return sum;
}

static const double NOISE_STEPS = 0.1; /* rms; measured: 0 to 0.2 */
static const double DRIFT_RAD = 0.006; /* a resting hand is never completely still */
static const double DRIFT_PERIOD_S = 1.6;

typedef struct drift {
    double from_rad, to_rad;
    int knot;
} drift;

static double drift_at(drift *d, double time_s, uint64_t *random)
{
    double knots = time_s / DRIFT_PERIOD_S;
    while (d->knot <= (int)knots) {
        d->knot += 1;
        d->from_rad = d->to_rad;
        d->to_rad = DRIFT_RAD * next_normal(random);
    }
    double s = minimum_jerk(knots - (int)knots);
    return d->from_rad + s * (d->to_rad - d->from_rad);
}

/* Returns the nearest level, but the old one while the angle is within three quarters of a step of
 * it. */
static int32_t level_of(double steps, int32_t old)
{
    double distance = steps - old;
    if (distance > -0.75 && distance < 0.75)
        return old;
    return (int32_t)(steps < 0.0 ? steps - 0.5 : steps + 0.5);
}

static double within(double value, double low, double high)
{
    return value < low ? low : value > high ? high : value;
}

typedef struct glove {
    uint64_t random;
    drift drifts[SENSOR_COUNT];
    int32_t level[SENSOR_COUNT];
} glove;

static void sense(glove *g, double time_s, const double *angle_rad)
{
    for (int i = 0; i < SENSOR_COUNT; ++i) {
        const struct sensor *s = &sensors[i];
        double rad = angle_rad[i] + drift_at(&g->drifts[i], time_s, &g->random);
        double step_rad = s->step * 1e-5;
        double steps =
            within(rad, s->low, s->high) / step_rad + NOISE_STEPS * next_normal(&g->random);
        g->level[i] = level_of(steps, g->level[i]);
    }
}

/* ---- the file ---- */

/* Writes hundred_thousandths * 1e-5 in decimal with integers, because the rounding of printf
 * differs between libraries. */
static void write_angle(FILE *out, int32_t hundred_thousandths)
{
    const char *sign = hundred_thousandths < 0 ? "-" : "";
    int32_t magnitude = hundred_thousandths < 0 ? -hundred_thousandths : hundred_thousandths;
    if (magnitude == 0)
        fputs(",0", out);
    else
        fprintf(out, ",%s%d.%05d", sign, magnitude / 100000, magnitude % 100000);
}

typedef struct part {
    const char *side, *about;
    uint64_t seed;
    void (*author)(performance *p);
} part;

static const part parts[2] = {
    {"right",
     "# Rests, talks in two sentences, lifts the index finger twice, spreads, makes a fist,\n"
     "# moves slowly, rests.",
     20141128, author_right},
    {"left",
     "# Rests, talks along in its own words, lifts the ring and the index finger, reaches out,\n"
     "# moves slowly, stretches once more, rests.",
     20141129, author_left},
};

static void write_header(FILE *out, const part *hand)
{
    fprintf(out,
            "# marotte log: a %s hand performs for 20 s. Written by plugins/log/demo_hand.c.\n"
            "%s Distal joints are not measured: they are estimated.\n"
            "time_s",
            hand->side, hand->about);
    for (int i = 0; i < SENSOR_COUNT; ++i)
        fprintf(out, ",%s.%s", hand->side, sensors[i].name);
    fputs("\nunit", out);
    for (int i = 0; i < SENSOR_COUNT; ++i)
        fputs(",rad", out);
    fputc('\n', out);
}

static void write_records(FILE *out, const part *hand)
{
    performance p = {.count = 0};
    glove g;
    memset(&g, 0, sizeof g);
    g.random = hand->seed;
    hand->author(&p);
    for (int k = 0; k < RECORD_COUNT; ++k) {
        double time_s = (double)k / RATE_HZ, angle_rad[SENSOR_COUNT];
        pose_at(&p, time_s, angle_rad);
        sense(&g, time_s, angle_rad);
        fprintf(out, "%d.%02d", k / RATE_HZ, k % RATE_HZ);
        for (int i = 0; i < SENSOR_COUNT; ++i)
            write_angle(out, g.level[i] * sensors[i].step);
        fputc('\n', out);
    }
}

int main(int argument_count, char **arguments)
{
    FILE *out = stdout;
    const part *hand = NULL;
    for (int i = 0; i < 2 && argument_count > 1; ++i)
        if (strcmp(arguments[1], parts[i].side) == 0)
            hand = &parts[i];
    if (!hand || argument_count > 3) {
        fputs("usage: demo_hand right|left [FILE]\n", stderr);
        return 2;
    }
    if (argument_count == 3 && !(out = fopen(arguments[2], "wb"))) {
        fprintf(stderr, "demo_hand: cannot write %s\n", arguments[2]);
        return 1;
    }
    write_header(out, hand);
    write_records(out, hand);
    int failed = ferror(out);
    if (fclose(out) != 0 || failed) {
        fputs("demo_hand: the file is not complete\n", stderr);
        return 1;
    }
    return 0;
}
