/* Where the labels of a rig's picture stand, and its colours. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "rig_help.h"
#include "rigpicture.h"

#include <math.h>

static void labels_stay_where_they_fit(void **state)
{
    (void)state;
    static const float wanted[] = {20, 60, 100};
    float y[3];
    rigpicture_spread(y, wanted, 3, 15, 0, 200);
    for (int i = 0; i < 3; ++i)
        assert_true(fabsf(y[i] - wanted[i]) < 1e-6f);
}

static void labels_never_overlap_and_stay_inside(void **state)
{
    (void)state;
    static const float wanted[] = {5, 50, 50, 51, 52, 180, 199, 199, 199};
    enum { COUNT = sizeof wanted / sizeof *wanted };
    float y[COUNT];
    rigpicture_spread(y, wanted, COUNT, 15, 10, 190);
    assert_true(y[0] >= 10.0f && y[COUNT - 1] <= 190.0f);
    for (int i = 1; i < COUNT; ++i)
        assert_true(y[i] - y[i - 1] >= 15.0f - 1e-4f);
}

static void too_many_labels_keep_their_distance(void **state)
{
    (void)state;
    float wanted[30], y[30];
    for (int i = 0; i < 30; ++i)
        wanted[i] = 100.0f;
    rigpicture_spread(y, wanted, 30, 15, 0, 200);
    assert_true(fabsf(y[0]) < 1e-6f);
    for (int i = 1; i < 30; ++i)
        assert_true(fabsf(y[i] - y[i - 1] - 15.0f) < 1e-3f);
}

static void bones_of_a_puppet_have_different_colours(void **state)
{
    (void)state;
    rig r;
    error err = {""};
    assert_int_equal(
        rig_with(&r,
                 "\"bones\": [{\"name\": \"skull\"}, {\"name\": \"jaw\", \"hinge\": {\"left\": "
                 "[9,0,0], \"right\": [-9,0,0]}}, {\"name\": \"a\"}, {\"name\": \"b\"}, "
                 "{\"name\": \"c\"}, {\"name\": \"d\"}, {\"name\": \"e\"}, {\"name\": \"f\"}]",
                 &err),
        MRT_OK);
    for (uint32_t i = 0; i < r.bone_count; ++i)
        for (uint32_t k = 0; k < i; ++k) {
            rigpicture_colour a = rigpicture_bone_colour(&r, i), b = rigpicture_bone_colour(&r, k);
            float apart = 0.0f;
            for (int c = 0; c < 3; ++c)
                apart += fabsf(a.rgb[c] - b.rgb[c]);
            assert_true(apart > 0.1f);
        }
    rig_destroy(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(labels_stay_where_they_fit),
        cmocka_unit_test(labels_never_overlap_and_stay_inside),
        cmocka_unit_test(too_many_labels_keep_their_distance),
        cmocka_unit_test(bones_of_a_puppet_have_different_colours),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
