#include "recogniser.h"

#include <math.h>
#include <string.h>

/* What is taught is the mean of the last 0.3 s: samples at least 5 ms apart. */
static const double window_s = 0.3, apart_s = 0.005;
/* Thumb, palm and spreading move less far than fingers bend; what is estimated (the distal joints)
 * and the wrist do not count. */
static const double weight[MRT_ANGLES] = {1, 1.5, 1.5, 1.5, 1, 1, 0, 1,   1, 0, 1.5,
                                          1, 1,   0,   1.5, 1, 1, 0, 1.5, 1, 0, 0};
enum { COUNTED = 16 };
static const double deg_per_rad = 57.295779513082321;

/* Until another is taught: a fist, a pointing index finger, a flat spread hand, a hand whose ring
 * and little fingers alone are stretched. */
const centroid recogniser_shipped[GESTURES] = {
    {{1.90f, 0.19f, 0.59f, 0.66f,  1.26f, 1.68f, 0, 1.35f,  1.75f, 0, -0.04f,
      1.39f, 1.81f, 0,     -0.04f, 1.36f, 1.75f, 0, -0.05f, 0.13f, 0, 0}},
    {{1.44f, 0.15f, 0.20f, 0.35f,  0.0f,  0.16f, 0, 0.59f,  0.54f, 0, -0.04f,
      0.69f, 0.63f, 0,     -0.06f, 0.70f, 0.60f, 0, -0.04f, 0.12f, 0, 0}},
    {{0.74f, 0.15f, 0.20f, 0.63f, -0.05f, 0.06f, 0, 0.02f, 0.13f, 0, 0.26f,
      0.05f, 0.18f, 0,     0.21f, 0.03f,  0.15f, 0, 0.36f, 0.13f, 0, 0}},
    {{1.70f, 0.15f, 0.20f, 0.55f,  0.60f, 0.52f, 0, 0.50f,  0.45f, 0, -0.05f,
      0.09f, 0.18f, 0,     -0.05f, 0.12f, 0.15f, 0, -0.05f, 0.30f, 0, 0}},
};

void recogniser_reset(recogniser *self, const centroid taught[GESTURES])
{
    memset(self, 0, sizeof *self);
    memcpy(self->taught, taught, sizeof self->taught);
    self->current = self->candidate = NO_GESTURE;
}

/* ---- teaching ---- */

/* How the hand was held lately; false: it was not there. */
static bool find_mean(const recogniser *self, centroid *out)
{
    double sum[MRT_ANGLES] = {0.0}, count = 0.0;
    for (unsigned k = 1; k <= self->filled; ++k) {
        unsigned i = (self->at + RECOGNISER_WINDOW - k) % RECOGNISER_WINDOW;
        if (self->now_s - self->past_s[i] > window_s)
            break;
        for (int a = 0; a < MRT_ANGLES; ++a)
            sum[a] += (double)self->past[i][a];
        count += 1.0;
    }
    for (int a = 0; a < MRT_ANGLES && count > 0.0; ++a)
        out->angle[a] = (float)(sum[a] / count);
    return count > 0.0;
}

void recogniser_watch(recogniser *self, const mrt_hand *hand, double dt_s)
{
    self->now_s += dt_s;
    unsigned last = (self->at + RECOGNISER_WINDOW - 1) % RECOGNISER_WINDOW;
    if (!hand)
        self->filled = 0;
    else if (self->filled == 0 || self->now_s - self->past_s[last] >= apart_s) {
        memcpy(self->past[self->at], hand->angle, sizeof self->past[0]);
        self->past_s[self->at] = self->now_s;
        self->at = (self->at + 1) % RECOGNISER_WINDOW;
        self->filled += self->filled < RECOGNISER_WINDOW;
    }
}

bool recogniser_teach(recogniser *self, unsigned gesture)
{
    centroid now;
    if (!find_mean(self, &now))
        return false;
    self->taught[gesture] = now;
    self->current = gesture;
    return true;
}

/* ---- recognising ---- */

/* Root mean square over the joints, deg. */
static double distance_deg(const centroid *to, const mrt_hand *hand)
{
    double sum = 0.0;
    for (int a = 0; a < MRT_ANGLES; ++a) {
        double d = weight[a] * ((double)hand->angle[a] - (double)to->angle[a]);
        sum += d * d;
    }
    return deg_per_rad * sqrt(sum / COUNTED);
}

unsigned recogniser_step(recogniser *self, const mrt_hand *hand, double dt_s,
                         const recogniser_limits *limits)
{
    unsigned nearest = NO_GESTURE;
    double least = limits->reject_deg, most = fmax(limits->leave_deg, limits->reject_deg);
    for (unsigned g = 0; g < GESTURES && hand; ++g) {
        double d = distance_deg(&self->taught[g], hand);
        if (d < least) {
            least = d;
            nearest = g;
        }
        if (g == self->current && d > most)
            self->current = NO_GESTURE;
    }
    if (!hand)
        self->current = NO_GESTURE;
    self->candidate_s = nearest == self->candidate ? self->candidate_s + dt_s : 0.0;
    self->candidate = nearest;
    if (nearest == NO_GESTURE || nearest == self->current || self->candidate_s < limits->dwell_s)
        return NO_GESTURE;
    self->current = nearest;
    return nearest;
}
