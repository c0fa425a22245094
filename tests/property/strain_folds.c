/* How near a group of triangles is to a fold: each instruction set has the bits of the triangles
 * taken one by one. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "base/isa.h"
#include "face/frame/strain.h"

#include <stdlib.h>
#include <string.h>

enum { ROUNDS = 500, VERTICES = 24 };

static float next_part(uint64_t *seed) /* -1..1 */
{
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (float)((double)(*seed >> 11) * 0x1p-52 - 1.0);
}

/* Some triangles are squashed, some are seen from behind, some do not move. */
static void fill(float (*row)[4], uint64_t *seed, float size)
{
    for (int v = 0; v < VERTICES; ++v)
        for (int axis = 0; axis < 3; ++axis)
            row[v][axis] = v % 7 == 3 ? row[v > 0 ? v - 1 : 0][axis] : size * next_part(seed);
}

static float edge_gain(const float (*by)[4], const float (*was)[4], uint32_t a, uint32_t b)
{
    float gained = 0.0f, length = 0.0f;
    for (int axis = 0; axis < 3; ++axis) {
        float d = by[b][axis] - by[a][axis], p = was[b][axis] - was[a][axis];
        gained += d * d;
        length += p * p;
    }
    return gained - length;
}

static void check_group(const strain_loops *loops, uint64_t *seed, size_t count)
{
    static float posed[VERTICES][4], added[VERTICES][4];
    uint32_t corner[3 * STRAIN_GROUP];
    float rest[3][STRAIN_GROUP] = {{0}}, along[3][STRAIN_GROUP], share[STRAIN_GROUP] = {0}, turn[9];
    strain_folds found;
    fill(posed, seed, 8.0f);
    fill(added, seed, 6.0f);
    for (size_t i = 0; i < 3 * STRAIN_GROUP; ++i)
        corner[i] = (uint32_t)((next_part(seed) + 1.0f) * 0.4999f * VERTICES);
    for (size_t i = 0; i < 9; ++i)
        turn[i] = 0.3f * next_part(seed);
    for (size_t i = 0; i < count; ++i) {
        share[i] = next_part(seed);
        for (int axis = 0; axis < 3; ++axis)
            rest[axis][i] = 40.0f * next_part(seed);
    }
    memcpy(along, rest, sizeof along);
    loops->turn_normals(along, (const float(*)[STRAIN_GROUP])rest, share, turn);
    const strain_corners was = {(const float(*)[4])posed, corner, count};
    const strain_corners by = {(const float(*)[4])added, corner, count};
    loops->folds(&found, &was, &by, (const float(*)[STRAIN_GROUP])along);
    for (size_t i = 0; i < count; ++i) {
        const uint32_t *c = corner + 3 * i;
        float e[2][3], d[2][3], n[3];
        for (int axis = 0; axis < 3; ++axis) {
            n[axis] = rest[axis][i] +
                      share[i] * (turn[3 * axis] * rest[0][i] + turn[3 * axis + 1] * rest[1][i] +
                                  turn[3 * axis + 2] * rest[2][i]);
            for (int k = 0; k < 2; ++k) {
                e[k][axis] = posed[c[1 + k]][axis] - posed[c[0]][axis];
                d[k][axis] = added[c[1 + k]][axis] - added[c[0]][axis];
            }
            assert_memory_equal(&n[axis], &along[axis][i], sizeof n[axis]);
        }
        float fold = strain_fold((const float(*)[3])e, (const float(*)[3])d, n);
        if (fold != found.fold[i]) /* -0 is 0 */
            fail_msg("triangle %zu: %g, alone %g", i, (double)found.fold[i], (double)fold);
        float gain = -1e30f;
        for (int k = 0; k < 3; ++k) {
            float one = edge_gain(by.row, was.row, c[k], c[(k + 1) % 3]);
            gain = one > gain ? one : gain;
        }
        if (gain > 0.0f) {
            if (!(found.drawn[i] > 0.0f))
                fail_msg("triangle %zu is drawn out, and that is not seen", i);
        } else if (found.drawn[i] > 0.0f) {
            fail_msg("triangle %zu is not drawn out", i);
        }
    }
}

static void a_group_has_the_bits_of_its_triangles(void **state)
{
    (void)state;
    uint64_t seed = 11;
    uint32_t known = 0;
    for (int which = 0; which < ISA_COUNT; ++which) {
        if (!isa_is_here((isa)which))
            continue;
        assert_int_equal(setenv("MAROTTE_ISA", isa_name((isa)which), 1), 0);
        known += 1;
        for (int i = 0; i < ROUNDS; ++i)
            check_group(strain_loops_now(), &seed, 1 + (size_t)i % STRAIN_GROUP);
    }
    assert_true(known > 0);
    unsetenv("MAROTTE_ISA");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_group_has_the_bits_of_its_triangles),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
