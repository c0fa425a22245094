/* Which normals are joined; no graphics needed. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "draw/face.h"
#include "draw_help.h"

static void seam_vertices_share_one_normal(void **state)
{
    (void)state;
    error err;
    seams s;
    /* 1 and 3 are one point of a smooth surface. */
    const float position[] = {0, 0, 0, 5, 5, 5, 9, 0, 0, 5, 5, 5};
    const float normal[] = {0, 0, 1, 0, 0, 1, 0, 0, 1, 0.6f, 0, 0.8f};
    assert_int_equal(seams_init(&s, position, normal, 4, 0.5f, &err), MRT_OK);
    assert_int_equal(s.pair_count, 1);
    float nx[] = {0, 0, 0, 0.6f}, ny[] = {0, 0, 0, 0}, nz[] = {1, 1, 1, 0.8f};
    seams_join(&s, nx, ny, nz);
    assert_true(nx[1] == nx[3] && nz[1] == nz[3]);
    assert_near(nx[1], 0.316228, 1e-5);
    assert_near(nz[1], 0.948683, 1e-5);
    assert_true(nx[0] == 0.0f && nz[2] == 1.0f);
    seams_finish(&s);
}

static void closed_lips_stay_apart(void **state)
{
    (void)state;
    error err;
    seams s;
    const float position[] = {1, 2, 3, 1, 2, 3};
    const float normal[] = {0, -1, 0, 0, 1, 0};
    assert_int_equal(seams_init(&s, position, normal, 2, 0.5f, &err), MRT_OK);
    assert_int_equal(s.pair_count, 0);
    seams_finish(&s);
}

static void four_copies_of_a_point_share_one_normal(void **state)
{
    (void)state;
    error err;
    seams s;
    const float position[12] = {0};
    const float normal[] = {0, 0, 1, 0.1f, 0, 0.995f, -0.1f, 0, 0.995f, 0, 0.1f, 0.995f};
    assert_int_equal(seams_init(&s, position, normal, 4, 0.9f, &err), MRT_OK);
    assert_int_equal(s.pair_count, 3);
    float nx[] = {0, 0.1f, -0.1f, 0}, ny[] = {0, 0, 0, 0.1f}, nz[] = {1, 0.995f, 0.995f, 0.995f};
    seams_join(&s, nx, ny, nz);
    for (int i = 1; i < 4; ++i)
        assert_true(nx[i] == nx[0] && ny[i] == ny[0] && nz[i] == nz[0]);
    assert_near(nx[0] * nx[0] + ny[0] * ny[0] + nz[0] * nz[0], 1.0, 1e-5);
    seams_finish(&s);
}

static void a_crowd_at_one_point_is_handled(void **state)
{
    (void)state;
    error err;
    seams s;
    enum { CROWD = 20000 };
    static float position[CROWD * 3], normal[CROWD * 3];
    for (int i = 0; i < CROWD; ++i)
        normal[i * 3 + i % 3] = i % 2 ? 1.0f : -1.0f;
    assert_int_equal(seams_init(&s, position, normal, CROWD, 0.5f, &err), MRT_OK);
    assert_int_equal(s.pair_count, CROWD - 6);
    seams_finish(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(seam_vertices_share_one_normal),
        cmocka_unit_test(closed_lips_stay_apart),
        cmocka_unit_test(four_copies_of_a_point_share_one_normal),
        cmocka_unit_test(a_crowd_at_one_point_is_handled),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
