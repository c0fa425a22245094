#include "mouth.h"
#include "mouth_weights.h"

#include <math.h>
#include <string.h>

enum { SPECTRUM = 512 };
_Static_assert(sizeof mouth_weight == sizeof(double[MOUTH_CHANNELS][MOUTH_FEATURES]),
               "run voice_truth --fit");
static const double pi = 3.14159265358979323846;

/* Edges of the bands, Hz: about equal steps of hearing. */
static const double edge_hz[MOUTH_BANDS + 1] = {80.0,   250.0,  400.0,  600.0,  850.0,  1150.0,
                                                1500.0, 2000.0, 2700.0, 3700.0, 5200.0, 7800.0};

/* ---- to the rate of analysis ---- */

/* A sinc of 8 zero crossings a side under a Hann window, which ends below both rates' limits. */
static const double crossings = 8.0, pass = 0.92;

void mouth_init(mouth *self, double rate_hz)
{
    memset(self, 0, sizeof *self);
    self->rate_hz = rate_hz;
    const double slower_hz = rate_hz < MOUTH_RATE ? rate_hz : MOUTH_RATE;
    self->reach = crossings / pass * rate_hz / slower_hz;
    if (self->reach > MOUTH_TAPS / 2 - 2)
        self->reach = MOUTH_TAPS / 2 - 2;
    for (int i = 0; i <= MOUTH_KERNEL; ++i) {
        const double x = crossings * i / MOUTH_KERNEL;
        const double sinc = i > 0 ? sin(pi * x) / (pi * x) : 1.0;
        self->kernel[i] = (float)(sinc * 0.5 * (1.0 + cos(pi * i / MOUTH_KERNEL)));
    }
    for (int i = 0; i < MOUTH_WINDOW; ++i)
        self->shape[i] = (float)(0.5 - 0.5 * cos(2.0 * pi * (i + 0.5) / MOUTH_WINDOW));
    for (int i = 0; i <= SPECTRUM / 2; ++i) {
        self->cosine[i] = (float)cos(2.0 * pi * i / SPECTRUM);
        self->sine[i] = (float)sin(2.0 * pi * i / SPECTRUM);
    }
    self->floor_db = -60.0;
    self->peak_db = -30.0;
    self->quiet_s = 10.0;
    for (int i = 0; i < MOUTH_RECENT; ++i)
        self->recent_db[i] = -90.0;
}

/* Returns the sound at a time in frames since the beginning, which the filter can reach. */
static float sound_at(const mouth *self, double at)
{
    const double step = MOUTH_KERNEL / self->reach;
    double sum = 0.0, weight = 0.0;
    for (int64_t i = (int64_t)ceil(at - self->reach); (double)i < at + self->reach; ++i) {
        const double x = fabs((double)i - at) * step;
        const int cell = (int)x;
        const double share = x - cell;
        const double w =
            (1.0 - share) * (double)self->kernel[cell] + share * (double)self->kernel[cell + 1];
        weight += w;
        if (i >= 0)
            sum += w * (double)self->past[i % MOUTH_TAPS];
    }
    return (float)(sum / weight);
}

/* ---- the spectrum ---- */

/* Cooley and Tukey, in place, radix 2. */
static void transform(const mouth *self, float re[SPECTRUM], float im[SPECTRUM])
{
    for (uint32_t i = 1, j = 0; i < SPECTRUM; ++i) {
        uint32_t bit = SPECTRUM / 2;
        for (; j & bit; bit /= 2)
            j ^= bit;
        j ^= bit;
        if (i < j) {
            const float a = re[i], b = im[i];
            re[i] = re[j], im[i] = im[j];
            re[j] = a, im[j] = b;
        }
    }
    for (uint32_t size = 2; size <= SPECTRUM; size *= 2)
        for (uint32_t first = 0; first < SPECTRUM; first += size)
            for (uint32_t k = 0; k < size / 2; ++k) {
                const uint32_t a = first + k, b = a + size / 2, turn = k * (SPECTRUM / size);
                const float c = self->cosine[turn], s = self->sine[turn];
                const float x = re[b] * c + im[b] * s, y = im[b] * c - re[b] * s;
                re[b] = re[a] - x, im[b] = im[a] - y;
                re[a] += x, im[a] += y;
            }
}

static double db_of(double power)
{
    return 10.0 * log10(power + 1e-9);
}

/* Returns how periodic the sound is, 0..1: the highest autocorrelation between 75 and 400 Hz,
 * corrected for the window's (Boersma 1993). re: the autocorrelation. */
static double voicing_of(const float re[SPECTRUM])
{
    double best = 0.0;
    for (int lag = MOUTH_RATE / 400; lag <= MOUTH_RATE / 75; ++lag) {
        const double x = (double)lag / MOUTH_WINDOW;
        const double own =
            (1.0 - x) * (2.0 / 3.0 + cos(2.0 * pi * x) / 3.0) + sin(2.0 * pi * x) / (2.0 * pi);
        const double r = (double)re[lag] / ((double)re[0] + 1e-9) / own;
        best = r > best ? r : best;
    }
    return best < 1.0 ? best : 1.0;
}

typedef struct sound_facts {
    double db;                /* re full scale */
    double band[MOUTH_BANDS]; /* dB */
    double voicing;           /* 0..1 */
} sound_facts;

static void measure(const mouth *self, sound_facts *out)
{
    float re[SPECTRUM] = {0}, im[SPECTRUM] = {0};
    double sum = 0.0, bands[MOUTH_BANDS] = {0};
    for (int i = 0; i < MOUTH_WINDOW; ++i)
        re[i] = self->window[(self->analysed + i) % MOUTH_WINDOW] * self->shape[i];
    transform(self, re, im);
    /* sum of the squared window: 3/8 of its length; both halves of the spectrum */
    const double scale = 2.0 / (SPECTRUM * 0.375 * MOUTH_WINDOW);
    for (int i = 0; i < SPECTRUM; ++i) {
        const double hz = (double)i * MOUTH_RATE / SPECTRUM;
        const double power = (double)re[i] * (double)re[i] + (double)im[i] * (double)im[i];
        if (i <= SPECTRUM / 2)
            for (int band = 0; band < MOUTH_BANDS; ++band)
                if (hz >= edge_hz[band] && hz < edge_hz[band + 1]) {
                    bands[band] += power * scale;
                    sum += power * scale;
                }
        /* below the rumble and above speech nothing counts as periodic */
        const double folded_hz = i <= SPECTRUM / 2 ? hz : MOUTH_RATE - hz;
        re[i] = folded_hz >= 70.0 && folded_hz < 1500.0 ? (float)power : 0.0f;
        im[i] = 0.0f;
    }
    out->db = db_of(sum);
    for (int band = 0; band < MOUTH_BANDS; ++band)
        out->band[band] = db_of(bands[band]);
    transform(self, re, im);
    out->voicing = voicing_of(re);
}

/* ---- from the spectrum to the mouth ---- */

static const double hop_s = 0.01;
/* The noise floor rises slowly and falls at once. The level of speech rises within 50 ms and falls
 * within a second. */
static const double floor_rise_db = 6.0 * 0.01, peak_fall_db = 24.0 * 0.01, speech_least_db = 18.0;
/* Closed lips hold no longer than this in silence: then the mouth rests. */
static const double closure_hold_s = 0.25;
/* Likelihood of a murmur that begins to close the lips, and that closes them. */
static const double closure_least = 0.25, closure_most = 0.45;
/* Drop below the loudest of the last hops: of the dip before a burst; the most that counts. */
static const double dip_least_db = 9.0, dip_most_db = 16.0, drop_most_db = 30.0;
/* Features after those of the bands. */
enum { LOUDNESS = MOUTH_BANDS, VOICING, DROP, CONSTANT };

static double limit(double value)
{
    return value > 0.0 ? value < 1.0 ? value : 1.0 : 0.0;
}

/* 0 below low, 1 above high. */
static double between(double value, double low, double high)
{
    return limit((value - low) / (high - low));
}

static void follow_levels(mouth *self, double db)
{
    self->floor_db = db < self->floor_db ? db : self->floor_db + floor_rise_db;
    self->floor_db = self->floor_db > -70.0 ? self->floor_db : -70.0;
    if (db > self->peak_db)
        self->peak_db += 0.3 * (db - self->peak_db);
    else
        self->peak_db -= peak_fall_db;
    const double least_db = self->floor_db + speech_least_db;
    self->peak_db = self->peak_db > least_db ? self->peak_db : least_db;
}

static void describe(mouth *self, const sound_facts *now)
{
    double *f = self->feature, highest_db = now->db;
    for (int i = 0; i < MOUTH_RECENT; ++i)
        highest_db = self->recent_db[i] > highest_db ? self->recent_db[i] : highest_db;
    for (int band = 0; band < MOUTH_BANDS; ++band) {
        const double below = (now->band[band] - now->db) / 20.0;
        f[band] = below > -2.5 ? below : -2.5;
    }
    f[LOUDNESS] = between(now->db, self->floor_db, self->peak_db);
    f[VOICING] = now->voicing;
    f[DROP] = between(highest_db - now->db, 0.0, drop_most_db);
    f[CONSTANT] = 1.0;
    self->recent_db[self->hop % MOUTH_RECENT] = now->db;
    self->hop += 1;
}

/* Moves a value towards what is wanted: up and down with time constants of their own. */
static void ease(double *value, double wanted, double up_s, double down_s)
{
    *value += hop_s / (hop_s + (wanted > *value ? up_s : down_s)) * (wanted - *value);
}

static void analyse(mouth *self)
{
    sound_facts now;
    measure(self, &now);
    follow_levels(self, now.db);
    describe(self, &now);
    double wanted[MOUTH_CHANNELS];
    for (int c = 0; c < MOUTH_CHANNELS; ++c) {
        double sum = 0.0;
        for (int i = 0; i < MOUTH_FEATURES; ++i)
            sum += mouth_weight[c][i] * self->feature[i];
        wanted[c] = limit(sum);
    }
    const double heard = between(now.db, self->floor_db + 5.0, self->floor_db + 12.0) *
                         between(now.db, -62.0, -54.0);
    const double voiced = heard * between(now.voicing, 0.55, 0.75);
    self->quiet_s = voiced > 0.5 ? 0.0 : self->quiet_s + hop_s;
    wanted[MOUTH_OPENNESS] *= voiced;
    wanted[MOUTH_WIDE] *= voiced;
    wanted[MOUTH_ROUND] *= voiced;
    wanted[MOUTH_HISS] *= heard;
    /* a murmur, or the dip before a burst, which hiss does not fill */
    const double murmur = heard * between(wanted[MOUTH_CLOSURE], closure_least, closure_most);
    const double dip = between(self->feature[DROP] * drop_most_db, dip_least_db, dip_most_db) *
                       (1.0 - between(wanted[MOUTH_HISS], 0.2, 0.5));
    wanted[MOUTH_CLOSURE] = self->quiet_s < closure_hold_s ? fmax(murmur, dip) : 0.0;
    wanted[MOUTH_OPENNESS] *= 1.0 - 0.8 * wanted[MOUTH_CLOSURE];
    ease(&self->value[MOUTH_OPENNESS], wanted[MOUTH_OPENNESS], 0.010, 0.025);
    ease(&self->value[MOUTH_WIDE], wanted[MOUTH_WIDE], 0.020, 0.040);
    ease(&self->value[MOUTH_ROUND], wanted[MOUTH_ROUND], 0.020, 0.040);
    ease(&self->value[MOUTH_CLOSURE], wanted[MOUTH_CLOSURE], 0.005, 0.025);
    ease(&self->value[MOUTH_HISS], wanted[MOUTH_HISS], 0.010, 0.025);
}

bool mouth_add(mouth *self, float frame)
{
    bool has_changed = false;
    self->past[self->frames % MOUTH_TAPS] = frame;
    self->frames += 1;
    for (;;) {
        const double last = (double)self->analysed * self->rate_hz / MOUTH_RATE;
        if (last > (double)(self->frames - 1))
            return has_changed;
        self->window[self->analysed % MOUTH_WINDOW] = sound_at(self, last - self->reach);
        self->analysed += 1;
        if (self->analysed % MOUTH_HOP == 0) {
            analyse(self);
            has_changed = true;
        }
    }
}
