/* What lies over a face in space. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "draw/gl.h"
#include "draw/overlay.h"
#include "draw_help.h"

#include <stdio.h>
#include <string.h>

enum { SIDE = 200, PIXELS = SIDE * SIDE };

static draw_renderer *renderer;
static draw_target *target;
static draw_face *face; /* a ball of 60 mm around 0 */
static uint8_t bare[PIXELS * 4], picture[PIXELS * 4];
static const draw_camera front = {{0, 0, 0}, 800, 0, 0, 0.5f};
static const uint32_t whole[4] = {0, 0, SIDE, SIDE};

static void draw_items(const overlay_item *item, uint32_t count)
{
    error err;
    draw_render(renderer, target, face, &front, 0, 0, SIDE, SIDE);
    draw_overlay(renderer, target, face, &front, whole, item, count);
    draw_read(target, picture);
    assert_int_equal(gl_check_error("overlays", &err), MRT_OK);
}

typedef struct change {
    int count, left, right, top, bottom, greatest;
} change;

static change find_change(int least)
{
    change c = {0, SIDE, -1, SIDE, -1, 0};
    for (int y = 0; y < SIDE; ++y)
        for (int x = 0; x < SIDE; ++x) {
            int sum = 0;
            for (int i = 0; i < 3; ++i)
                sum += abs(picture[(y * SIDE + x) * 4 + i] - bare[(y * SIDE + x) * 4 + i]);
            if (sum < least)
                continue;
            ++c.count;
            c.left = x < c.left ? x : c.left;
            c.right = x > c.right ? x : c.right;
            c.top = y < c.top ? y : c.top;
            c.bottom = y > c.bottom ? y : c.bottom;
            c.greatest = sum > c.greatest ? sum : c.greatest;
        }
    return c;
}

static overlay_item green(overlay_kind kind, float x, float y, float z)
{
    return (overlay_item){.kind = kind,
                          .from = {x, y, z},
                          .to = {x, y, z},
                          .radius_mm = 20,
                          .width_px = 8,
                          .rgba = {0, 1, 0, 1}};
}

static void nothing_is_drawn_for_no_items(void **state)
{
    (void)state;
    draw_items(NULL, 0);
    assert_memory_equal(picture, bare, sizeof bare);
}

static void a_dot_is_round_and_where_it_is(void **state)
{
    (void)state;
    overlay_item dot = green(OVERLAY_DOT, 100, 0, 0);
    float pixel[2];
    draw_items(&dot, 1);
    change c = find_change(120);
    assert_true(draw_project(pixel, &front, whole, dot.from));
    assert_near((c.left + c.right + 1) * 0.5, pixel[0], 1.0);
    assert_near((c.top + c.bottom + 1) * 0.5, pixel[1], 1.0);
    assert_in_range(c.right - c.left + 1, 7, 9);
    assert_in_range(c.bottom - c.top + 1, 7, 9);
    assert_in_range(c.count, 40, 62); /* 50 is a disc, 64 a square */
}

static void a_dot_on_the_skin_is_whole(void **state)
{
    (void)state;
    overlay_item dot = green(OVERLAY_DOT, 0, 0, 60);
    draw_items(&dot, 1);
    change c = find_change(120);
    assert_in_range(c.count, 40, 62);
}

static void what_the_face_hides_is_faint_and_still_seen(void **state)
{
    (void)state;
    overlay_item dot = green(OVERLAY_DOT, 0, 0, 90);
    draw_items(&dot, 1);
    int before = find_change(6).greatest;
    dot.from[2] = dot.to[2] = -90.0f;
    draw_items(&dot, 1);
    int behind = find_change(6).greatest;
    assert_true(behind > 15);
    assert_true(behind < before / 2);
}

static void a_ball_is_as_large_as_its_radius(void **state)
{
    (void)state;
    overlay_item solid = green(OVERLAY_BALL, 0, 110, 0);
    draw_items(&solid, 1);
    change c = find_change(40);
    double px_per_mm = SIDE / 2 / tan(0.25) / 800.0;
    assert_near(c.right - c.left + 1, 40.0 * px_per_mm, 2.0);
    assert_near(c.bottom - c.top + 1, 40.0 * px_per_mm, 2.0);
}

static void a_bone_reaches_from_end_to_end_and_tapers(void **state)
{
    (void)state;
    overlay_item bone = green(OVERLAY_BONE, -80, 110, 0);
    bone.to[0] = 80.0f;
    draw_items(&bone, 1);
    change c = find_change(40);
    double px_per_mm = SIDE / 2 / tan(0.25) / 800.0;
    assert_near(c.right - c.left + 1, (160.0 + 20.0 + 14.0) * px_per_mm, 2.5);
    assert_near(c.bottom - c.top + 1, 40.0 * px_per_mm, 2.0);
}

static void an_arrow_has_its_head_at_its_end(void **state)
{
    (void)state;
    overlay_item arrow = green(OVERLAY_ARROW, -90, 100, 0);
    arrow.to[0] = 90.0f;
    arrow.width_px = 3.0f;
    draw_items(&arrow, 1);
    int widest = 0, widest_x = 0;
    change c = find_change(100);
    for (int x = c.left; x <= c.right; ++x) {
        int high = 0;
        for (int y = 0; y < SIDE; ++y)
            high += picture[(y * SIDE + x) * 4 + 1] > bare[(y * SIDE + x) * 4 + 1] + 60;
        if (high > widest) {
            widest = high;
            widest_x = x;
        }
    }
    assert_in_range(widest, 7, 13);
    assert_true(widest_x > c.left + (c.right - c.left) * 3 / 4);
}

static void a_sphere_lets_the_face_through(void **state)
{
    (void)state;
    overlay_item sphere = green(OVERLAY_SPHERE, 0, 0, 0);
    sphere.radius_mm = 80.0f;
    sphere.width_px = 1.5f;
    sphere.rgba[3] = 0.5f;
    draw_items(&sphere, 1);
    change seen = find_change(6);
    double px_per_mm = SIDE / 2 / tan(0.25) / 800.0;
    assert_near(seen.right - seen.left + 1, 161.0 * px_per_mm, 3.0);
    int quiet = 0; /* off the rings, within the outline */
    for (int y = SIDE / 2 - 30; y < SIDE / 2 - 8; ++y)
        for (int x = SIDE / 2 + 8; x < SIDE / 2 + 30; ++x)
            quiet += abs(picture[(y * SIDE + x) * 4] - bare[(y * SIDE + x) * 4]) < 24;
    assert_true(quiet > 22 * 22 * 8 / 10);
}

static void only_the_rectangle_is_drawn_on(void **state)
{
    (void)state;
    const uint32_t part[4] = {50, 60, 80, 70};
    overlay_item line = green(OVERLAY_LINE, -500, 0, 100);
    line.to[0] = 500.0f;
    draw_render(renderer, target, face, &front, 0, 0, SIDE, SIDE);
    draw_overlay(renderer, target, face, &front, part, &line, 1);
    draw_read(target, picture);
    change c = find_change(60);
    assert_int_equal(c.left, 50);
    assert_int_equal(c.right, 129);
    assert_in_range(c.top, 60, 129);
    assert_in_range(c.bottom, 60, 129);
}

static void what_is_behind_the_eye_does_no_harm(void **state)
{
    (void)state;
    overlay_item item[3] = {green(OVERLAY_LINE, 0, 0, 2000), green(OVERLAY_ARROW, NAN, 0, 0),
                            green(OVERLAY_BONE, 0, 0, 795)};
    item[0].to[2] = -2000.0f;
    item[2].to[1] = INFINITY;
    draw_items(item, 3);
}

static int set_up(void **state)
{
    error err;
    draw_context *context = draw_context_create(&err);
    if (!context) {
        printf("SKIPPED: %s\n", err.text);
        exit(77);
    }
    *state = context;
    renderer = draw_renderer_create(&err);
    target = draw_target_create(SIDE, SIDE, &err);
    mesh m = shapes_balls(&(ball){{0, 0, 0}, 60}, 1);
    face = renderer && target ? draw_face_create(&m, &err) : NULL;
    mesh_destroy(&m);
    if (!face)
        return -1;
    draw_render(renderer, target, face, &front, 0, 0, SIDE, SIDE);
    draw_read(target, bare);
    return 0;
}

static int tear_down(void **state)
{
    draw_face_destroy(face);
    draw_target_destroy(target);
    draw_renderer_destroy(renderer);
    draw_context_destroy(*state);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_is_drawn_for_no_items),
        cmocka_unit_test(a_dot_is_round_and_where_it_is),
        cmocka_unit_test(a_dot_on_the_skin_is_whole),
        cmocka_unit_test(what_the_face_hides_is_faint_and_still_seen),
        cmocka_unit_test(a_ball_is_as_large_as_its_radius),
        cmocka_unit_test(a_bone_reaches_from_end_to_end_and_tapers),
        cmocka_unit_test(an_arrow_has_its_head_at_its_end),
        cmocka_unit_test(a_sphere_lets_the_face_through),
        cmocka_unit_test(only_the_rectangle_is_drawn_on),
        cmocka_unit_test(what_is_behind_the_eye_does_no_harm),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
