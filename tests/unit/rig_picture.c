/* Where the labels of a rig's picture stand, its colours, and how portraits of poses are framed. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "rig_help.h"
#include "cli/rigpicture.h"

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

static void crowded_labels_give_way_to_both_sides(void **state)
{
    (void)state;
    static const float wanted[] = {20, 100, 100, 100, 180};
    static const float expected[] = {20, 85, 100, 115, 180};
    float y[5];
    rigpicture_spread(y, wanted, 5, 15, 0, 200);
    for (int i = 0; i < 5; ++i)
        assert_true(fabsf(y[i] - expected[i]) < 1e-4f);
}

/* Corners of a block that is wide, far from the origin, and seen from aside. mm. */
static const float block[8][3] = {{900, -40, 60}, {1400, -40, 60}, {900, 90, 60},
                                  {1400, 90, 60}, {900, -40, 380}, {1400, -40, 380},
                                  {900, 90, 380}, {1400, 90, 380}};
static const uint32_t panel[4] = {RIGPORTRAITS_WIDTH, 30, RIGPORTRAITS_WIDTH, RIGPORTRAITS_HEIGHT};

/* Low and high in shares of the panel: across, then down. */
static void share_of_panel(float low[2], float high[2], const draw_camera *camera)
{
    for (int axis = 0; axis < 2; ++axis) {
        low[axis] = 2.0f;
        high[axis] = -1.0f;
    }
    for (int i = 0; i < 8; ++i) {
        float px[2];
        assert_true(draw_project(px, camera, panel, block[i]));
        for (int axis = 0; axis < 2; ++axis) {
            float share = (px[axis] - (float)panel[axis]) / (float)panel[2 + axis];
            low[axis] = fminf(low[axis], share);
            high[axis] = fmaxf(high[axis], share);
        }
    }
}

static void a_portrait_shows_all_as_large_as_it_can(void **state)
{
    (void)state;
    const float air = 0.025f; /* of the panel, at each edge */
    const rigpicture_view views[] = {rigportraits_default_view(), {0.0f, 0.0f}, {-1.2f, 0.5f}};
    for (int i = 0; i < 3; ++i) {
        rigportraits_frame frame = rigportraits_frame_empty(views[i]);
        rigportraits_frame_add(&frame, block[0], 4); /* two halves are one whole */
        rigportraits_frame_add(&frame, block[4], 4);
        draw_camera camera = rigportraits_frame_camera(&frame);
        float low[2], high[2];
        share_of_panel(low, high, &camera);
        for (int axis = 0; axis < 2; ++axis)
            assert_true(low[axis] > air - 1e-3f && high[axis] < 1.0f - air + 1e-3f);
        int tight = high[0] - low[0] > high[1] - low[1] ? 0 : 1;
        assert_true(fabsf(low[tight] - air) < 1e-3f && fabsf(1.0f - high[tight] - air) < 1e-3f);
    }
}

static void a_portrait_of_nothing_has_a_camera(void **state)
{
    (void)state;
    rigportraits_frame frame = rigportraits_frame_empty(rigportraits_default_view());
    draw_camera camera = rigportraits_frame_camera(&frame);
    assert_true(camera.distance_mm > 0.0f && isfinite(camera.target[0] + camera.target[1]));
}

static void portraits_stay_inside_at_any_size(void **state)
{
    (void)state;
    static const uint32_t side[] = {160, 333, 640, 1080, 1920, 8192};
    enum { SIDES = sizeof side / sizeof side[0] };
    for (uint32_t count = 1; count <= RIGPORTRAITS_MAX; ++count)
        for (int i = 0; i < SIDES * SIDES; ++i) {
            const uint32_t width = side[i % SIDES], height = side[i / SIDES];
            rigportraits_grid g = rigportraits_lay_out(count, width, height);
            assert_true(g.columns * g.rows >= count && g.columns * (g.rows - 1) < count);
            assert_true(g.left + g.columns * g.panel_width <= width && g.top >= g.header);
            assert_true(g.top + g.rows * (g.panel_height + g.caption) <= height);
        }
    rigportraits_grid usual = rigportraits_lay_out(6, 0, 0);
    assert_int_equal(usual.columns, RIGPORTRAITS_COLUMNS);
    assert_int_equal(usual.panel_width, RIGPORTRAITS_WIDTH);
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
        cmocka_unit_test(crowded_labels_give_way_to_both_sides),
        cmocka_unit_test(a_portrait_shows_all_as_large_as_it_can),
        cmocka_unit_test(a_portrait_of_nothing_has_a_camera),
        cmocka_unit_test(portraits_stay_inside_at_any_size),
        cmocka_unit_test(bones_of_a_puppet_have_different_colours),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
