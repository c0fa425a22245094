#include "face/frame/strain.h"

#include "base/isa.h"

#include <math.h>

#define STRAIN_TABLE(variant)                                                                      \
    STRAIN_DECLARE(variant);                                                                       \
    static const strain_loops loops_##variant = {.add = STRAIN_OF(add, variant),                   \
                                                 .frames = STRAIN_OF(frames, variant),             \
                                                 .turned = STRAIN_OF(turned, variant),             \
                                                 .turns = STRAIN_OF(turns, variant),               \
                                                 .steepest = STRAIN_OF(steepest, variant),         \
                                                 .strains = STRAIN_OF(strains, variant),           \
                                                 .stretches = STRAIN_OF(stretches, variant),       \
                                                 .may_strain = STRAIN_OF(may_strain, variant),     \
                                                 .turn_normals = STRAIN_OF(turn_normals, variant), \
                                                 .seen = STRAIN_OF(seen, variant),                 \
                                                 .blends = STRAIN_OF(blends, variant),             \
                                                 .rooms = STRAIN_OF(rooms, variant),               \
                                                 .folds = STRAIN_OF(folds, variant)}

STRAIN_TABLE(generic);
#ifdef MAROTTE_LANES_X86
STRAIN_TABLE(v2);
STRAIN_TABLE(v3);
STRAIN_TABLE(v4);
static const strain_loops *const tables[ISA_COUNT] = {&loops_generic, &loops_v2, &loops_v3,
                                                      &loops_v4};
#else
static const strain_loops *const tables[ISA_COUNT] = {&loops_generic};
#endif

const strain_loops *strain_loops_now(void)
{
    const strain_loops *found = tables[isa_now()];
    return found ? found : &loops_generic;
}

static void cross(float out[3], const float *a, const float *b)
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static float dot(const float *a, const float *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Coefficients of (e1 + s d1) x (e2 + s d2) . n = area + slope s + bend s^2. */
typedef struct fold_way {
    float area, slope, bend;
    float room; /* part of the area that may be lost; not above 0 if already turned over */
} fold_way;

static fold_way way_of(const float e[2][3], const float d[2][3], const float n[3])
{
    float whole[3], by[3], along[3], square[3];
    cross(whole, e[0], e[1]);
    cross(by, e[0], d[1]);
    cross(along, d[0], e[1]);
    cross(square, d[0], d[1]);
    float nn = dot(n, n), left = STRAIN_FOLD_ROOM * nn;
    fold_way way = {dot(n, whole), dot(n, by) + dot(n, along), dot(n, square), 0.0f};
    if (nn > 1e-30f && way.area > 1e-3f * nn)
        way.room = way.area - (left < 0.5f * way.area ? left : 0.5f * way.area);
    return way;
}

float strain_fold(const float e[2][3], const float d[2][3], const float n[3])
{
    const fold_way way = way_of(e, d, n);
    if (!(way.room > 0.0f))
        return 0.0f;
    float least = way.slope + way.bend < 0.0f ? way.slope + way.bend : 0.0f; /* value at s = 1 */
    if (way.bend > 0.0f && way.slope < 0.0f && -way.slope < 2.0f * way.bend)
        least = -way.slope * way.slope / (4.0f * way.bend);
    return -least / way.room;
}

float strain_flip(const float e[2][3], const float d[2][3], const float n[3])
{
    const fold_way way = way_of(e, d, n);
    if (!(way.room > 0.0f))
        return INFINITY;
    float bend = way.bend < 0.0f ? -way.bend : 0.0f;
    return (sqrtf(way.slope * way.slope + 4.0f * way.room * bend) - way.slope) / (2.0f * way.room);
}
