#include "window/panels/simon.h"

#include <math.h>
#include <string.h>

static const double deg_per_rad = 57.29577951308232;

enum { WRIST_ANGLES_FROM = 20, ORDER_STEP = 5 };

void simon_begin(simon *self, uint32_t face_count, const mrt_card_line *line, uint32_t line_count)
{
    memset(self, 0, sizeof *self);
    self->face_count = face_count < SIMON_FACES_MAX ? face_count : SIMON_FACES_MAX;
    for (uint32_t k = 0; k < line_count; ++k)
        for (int i = 0; i < WRIST_ANGLES_FROM; ++i)
            self->counts[i] =
                self->counts[i] || line[k].per_rad[i] > 0.0f || line[k].per_rad[i] < 0.0f;
}

static uint32_t face_at(const simon *self, uint32_t place)
{
    return (place + self->round * ORDER_STEP) % self->face_count;
}

uint32_t simon_asked(const simon *self)
{
    return self->place < self->face_count ? face_at(self, self->place) : self->face_count;
}

/* Returns whether a round asks for this face. */
static bool is_asked(const simon *self, uint32_t round, uint32_t face)
{
    return self->answered[face] < SIMON_ROUNDS_MAX &&
           (round < SIMON_ROUNDS || self->answered[face] == 0 ||
            simon_spread_deg(self, face) > SIMON_SPREAD_DEG);
}

static void skip_settled(simon *self)
{
    while (self->place < self->face_count &&
           !is_asked(self, self->round, face_at(self, self->place)))
        self->place += 1;
}

void simon_answer(simon *self, const float angle_rad[MRT_ANGLES])
{
    const uint32_t face = simon_asked(self);
    if (face >= self->face_count)
        return;
    if (self->answered[face] < SIMON_ROUNDS_MAX)
        memcpy(self->angle_rad[face][self->answered[face]++], angle_rad,
               sizeof self->angle_rad[face][0]);
    self->place += 1;
    skip_settled(self);
}

void simon_skip(simon *self)
{
    if (self->place >= self->face_count)
        return;
    self->place += 1;
    skip_settled(self);
}

void simon_forget(simon *self, uint32_t face)
{
    self->answered[face] = 0;
}

void simon_forget_all(simon *self)
{
    memset(self->answered, 0, sizeof self->answered);
}

uint32_t simon_left(const simon *self)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < self->face_count; ++i)
        count += is_asked(self, self->round + 1, i);
    return count;
}

void simon_next_round(simon *self)
{
    self->round += 1;
    self->place = 0;
    skip_settled(self);
}

/* ---- distance of hand poses ---- */

static double apart_deg(const simon *self, const float *a, const float *b)
{
    double sum = 0.0;
    uint32_t count = 0;
    for (int i = 0; i < MRT_ANGLES; ++i) {
        if (!self->counts[i])
            continue;
        const double by = (double)a[i] - (double)b[i];
        sum += by * by;
        count += 1;
    }
    return count > 0 ? deg_per_rad * sqrt(sum / count) : 0.0;
}

double simon_spread_deg(const simon *self, uint32_t face)
{
    double most = 0.0;
    for (uint32_t i = 0; i < self->answered[face]; ++i)
        for (uint32_t k = 0; k < i; ++k)
            most = fmax(most, apart_deg(self, self->angle_rad[face][i], self->angle_rad[face][k]));
    return most;
}

static void mean_of(const simon *self, uint32_t face, float out[MRT_ANGLES])
{
    for (int i = 0; i < MRT_ANGLES; ++i) {
        out[i] = 0.0f;
        for (uint32_t k = 0; k < self->answered[face]; ++k)
            out[i] += self->angle_rad[face][k][i] / (float)self->answered[face];
    }
}

uint32_t simon_twins(const simon *self, simon_pair out[SIMON_PAIRS_MAX])
{
    uint32_t count = 0;
    float a[MRT_ANGLES], b[MRT_ANGLES];
    for (uint32_t i = 0; i < self->face_count; ++i)
        for (uint32_t k = i + 1; k < self->face_count; ++k) {
            if (self->answered[i] == 0 || self->answered[k] == 0)
                continue;
            mean_of(self, i, a);
            mean_of(self, k, b);
            const simon_pair pair = {i, k, apart_deg(self, a, b)};
            if (!(pair.deg < SIMON_TWINS_DEG))
                continue;
            uint32_t at = count < SIMON_PAIRS_MAX ? count++ : SIMON_PAIRS_MAX;
            if (at == SIMON_PAIRS_MAX && pair.deg >= out[at - 1].deg)
                continue;
            at = at == SIMON_PAIRS_MAX ? at - 1 : at;
            for (; at > 0 && out[at - 1].deg > pair.deg; --at)
                out[at] = out[at - 1];
            out[at] = pair;
        }
    return count;
}
