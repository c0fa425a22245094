/* property/csrbf_scene.h - random scenes for the properties of the engine: spread tips, radii,
 * displacements and points, from a seeded generator. Coordinates are multiples of 2^-10 within
 * +-2.5, so that they are exact in float, and so are sums and products with small numbers. */
#ifndef MAROTTE_TESTS_CSRBF_SCENE_H
#define MAROTTE_TESTS_CSRBF_SCENE_H
#include "csrbf/csrbf.h"

#include <math.h>
#include <string.h>

enum { SCENE_COUNT = 200, SCENE_TIPS = 16, SCENE_POINTS = 80 };

typedef struct scene {
    csrbf_settings settings;
    uint32_t tip_count;
    double tip[SCENE_TIPS][3], g[SCENE_TIPS][3];
    double point[SCENE_POINTS][3]; /* half of them near a tip */
    double largest_g;
} scene;

/* SplitMix64 (Steele, Lea, Flood 2014). */
static inline uint64_t scene_next(uint64_t *seed)
{
    uint64_t z = (*seed += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

/* A multiple of 2^-10 within +-size. */
static inline double scene_number(uint64_t *seed, double size)
{
    double unit = (double)(scene_next(seed) >> 11) * 0x1p-53;
    return floor((2.0 * unit - 1.0) * size * 1024.0) / 1024.0;
}

static inline double scene_distance(const double a[3], const double b[3])
{
    double dx = a[0] - b[0], dy = a[1] - b[1], dz = a[2] - b[2];
    return sqrt(dx * dx + dy * dy + dz * dz);
}

static inline bool scene_is_spread(const scene *s, uint32_t tip)
{
    for (uint32_t i = 0; i < tip; ++i)
        if (scene_distance(s->tip[i], s->tip[tip]) < 0.25)
            return false;
    return true;
}

/* Scene `number` of a kernel and a polynomial: the same on every machine. */
static inline scene scene_make(uint32_t number, csrbf_kernel kernel, csrbf_polynomial polynomial)
{
    static const double radii[] = {0.5, 0.75, 1.0, 1.5, 2.0};
    uint64_t seed = 1000u + number;
    scene s;
    memset(&s, 0, sizeof s);
    s.settings =
        (csrbf_settings){.kernel = kernel, .polynomial = polynomial, .radius = radii[number % 5]};
    s.tip_count = 6 + (uint32_t)(scene_next(&seed) % 7);
    for (uint32_t i = 0; i < s.tip_count; ++i) {
        do
            for (int axis = 0; axis < 3; ++axis)
                s.tip[i][axis] = scene_number(&seed, 1.25);
        while (!scene_is_spread(&s, i));
        for (int axis = 0; axis < 3; ++axis) {
            s.g[i][axis] = scene_number(&seed, 0.25);
            s.largest_g = fabs(s.g[i][axis]) > s.largest_g ? fabs(s.g[i][axis]) : s.largest_g;
        }
    }
    for (uint32_t i = 0; i < SCENE_POINTS; ++i)
        for (int axis = 0; axis < 3; ++axis)
            s.point[i][axis] = i % 2 ? s.tip[i % s.tip_count][axis] + scene_number(&seed, 0.5)
                                     : scene_number(&seed, 2.5);
    return s;
}

static const csrbf_kernel scene_kernels[] = {CSRBF_WENDLAND_C2, CSRBF_WENDLAND_C0,
                                             CSRBF_WENDLAND_C4, CSRBF_WENDLAND_C6};
static const csrbf_polynomial scene_polynomials[] = {CSRBF_NONE, CSRBF_CONSTANT, CSRBF_LINEAR,
                                                     CSRBF_WINDOWED};

#endif
