#include "face/frame/strain.h"

#include "base/isa.h"

#define STRAIN_TABLE(variant)                                                                      \
    STRAIN_DECLARE(variant);                                                                       \
    static const strain_loops loops_##variant = {.add = STRAIN_OF(add, variant),                   \
                                                 .frames = STRAIN_OF(frames, variant),             \
                                                 .turned = STRAIN_OF(turned, variant),             \
                                                 .turns = STRAIN_OF(turns, variant),               \
                                                 .steepest = STRAIN_OF(steepest, variant),         \
                                                 .strains = STRAIN_OF(strains, variant)}

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

float strain_fold(const float e[2][3], const float d[2][3], const float n[3])
{
    float whole[3], by[3], along[3], square[3];
    cross(whole, e[0], e[1]);
    cross(by, e[0], d[1]);
    cross(along, d[0], e[1]);
    cross(square, d[0], d[1]);
    float nn = dot(n, n), area = dot(n, whole), slope = dot(n, by) + dot(n, along);
    float bend = dot(n, square), room = STRAIN_FOLD_ROOM * nn;
    if (!(nn > 1e-30f) || !(area > 1e-3f * nn))
        return 0.0f;
    float least = slope + bend < 0.0f ? slope + bend : 0.0f; /* at 1, beyond the area */
    if (bend > 0.0f && slope < 0.0f && -slope < 2.0f * bend)
        least = -slope * slope / (4.0f * bend);
    return -least / (area - (room < 0.5f * area ? room : 0.5f * area));
}
