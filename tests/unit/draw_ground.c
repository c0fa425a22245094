/* What is behind a face: a colour, or nothing. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "draw/draw.h"
#include "draw_help.h"

#include <stdio.h>
#include <string.h>

enum { SIDE = 600, PIXELS = SIDE * SIDE, MIDDLE = (SIDE / 2 * SIDE + SIDE / 2) * 4 };

static draw_context *context;
static draw_renderer *renderer;
static draw_target *target;
static uint8_t on_wall[PIXELS * 4], picture[PIXELS * 4];

static void draw_ball(const float *ground, uint8_t *out)
{
    error err;
    const draw_camera camera = {{0, 0, 0}, 800, 0, 0, 0.5f};
    mesh m = shapes_balls(&(ball){{0, 0, 0}, 100}, 1);
    draw_face *face = draw_face_create(&m, &err);
    assert_non_null(face);
    draw_ground(renderer, ground);
    draw_render(renderer, target, face, &camera, 0, 0, SIDE, SIDE);
    draw_read(target, out);
    draw_face_destroy(face);
    mesh_destroy(&m);
}

static void a_colour_is_behind_the_face_exactly(void **state)
{
    (void)state;
    static const float green[4] = {0.0f, 177 / 255.0f, 64 / 255.0f, 1.0f};
    static const uint8_t bytes[4] = {0, 177, 64, 255};
    draw_ball(NULL, on_wall);
    draw_ball(green, picture);
    assert_memory_equal(picture, bytes, 4);
    assert_memory_equal(picture + (PIXELS - 1) * 4, bytes, 4);
    assert_memory_equal(picture + MIDDLE, on_wall + MIDDLE, 4);
}

static void nothing_behind_the_face_is_no_alpha(void **state)
{
    (void)state;
    static const float nothing[4] = {0};
    uint32_t part = 0, whole = 0;
    draw_ball(NULL, on_wall);
    draw_ball(nothing, picture);
    for (uint32_t i = 0; i < PIXELS; ++i) {
        whole += picture[i * 4 + 3] == 255;
        part += picture[i * 4 + 3] > 0 && picture[i * 4 + 3] < 255;
        if (picture[i * 4 + 3] == 255)
            assert_memory_equal(picture + i * 4, on_wall + i * 4, 4);
    }
    double radius_px = SIDE / 2 * 100.0 / sqrt(800.0 * 800.0 - 1e4) / tan(0.25);
    assert_near(whole + part / 2, 3.141593 * radius_px * radius_px, 0.03 * PIXELS);
    assert_true(part > 100); /* the edge is smooth */
}

/* An edge that is laid over something else must not bring the dark of nothing with it. */
static void edges_have_the_colour_of_the_face(void **state)
{
    (void)state;
    static const float nothing[4] = {0};
    draw_ball(nothing, picture);
    for (uint32_t i = 0; i < PIXELS; ++i) {
        const uint8_t *p = picture + i * 4;
        if (p[3] > 0)
            assert_true(p[0] + p[1] + p[2] > 40);
    }
}

/* A ball of felt, `right_mm` beside the middle; the sum of its alpha in pixels. */
static double draw_felt(const char *material, float right_mm, const float *ground, uint8_t *out)
{
    error err;
    const draw_camera camera = {{-right_mm, 0, 0}, 800, 0, 0, 0.5f};
    mesh m = shapes_balls(&(ball){{0, 0, 0}, 100}, 1);
    m.material[0].name = strdup(material);
    m.material[0].roughness = 0.9f;
    m.material[0].has_roughness = true;
    draw_face *face = draw_face_create(&m, &err);
    assert_non_null(face);
    draw_ground(renderer, ground);
    draw_render(renderer, target, face, &camera, 0, 0, SIDE, SIDE);
    draw_read(target, out);
    draw_face_destroy(face);
    mesh_destroy(&m);
    double sum = 0.0;
    for (uint32_t i = 0; i < PIXELS; ++i)
        sum += out[i * 4 + 3] / 255.0;
    return sum;
}

static void fibres_stand_out_of_thick_felt(void **state)
{
    (void)state;
    static const float nothing[4] = {0};
    const double shorn = draw_felt("lid", 0.0f, nothing, on_wall);
    const double felt = draw_felt("felt", 0.0f, nothing, picture);
    assert_true(felt > shorn + 60.0 && felt < 1.06 * shorn);
    for (uint32_t i = 0; i < PIXELS; ++i) {
        const uint8_t *p = picture + i * 4;
        if (p[3] > 0)
            assert_true(p[0] + p[1] + p[2] > 40);
        assert_true(p[3] >= on_wall[i * 4 + 3]);
    }
}

static void fibres_leave_no_trace_where_the_face_was(void **state)
{
    (void)state;
    error err;
    draw_felt("felt", 0.0f, NULL, picture);
    draw_felt("felt", 14.0f, NULL, picture);
    draw_target_destroy(target);
    target = draw_target_create(SIDE, SIDE, &err);
    assert_non_null(target);
    draw_felt("felt", 14.0f, NULL, on_wall);
    assert_memory_equal(picture, on_wall, sizeof picture);
}

static void the_wall_is_back_and_opaque(void **state)
{
    (void)state;
    static const float nothing[4] = {0};
    draw_ball(NULL, on_wall);
    draw_ball(nothing, picture);
    draw_ball(NULL, picture);
    assert_memory_equal(picture, on_wall, sizeof picture);
    for (uint32_t i = 0; i < PIXELS; ++i)
        assert_int_equal(picture[i * 4 + 3], 255);
}

static int set_up(void **state)
{
    (void)state;
    error err = {""};
    target = draw_target_create(SIDE, SIDE, &err);
    renderer = target ? draw_renderer_create(&err) : NULL;
    return renderer ? 0 : -1;
}

static int tear_down(void **state)
{
    (void)state;
    draw_renderer_destroy(renderer);
    draw_target_destroy(target);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_colour_is_behind_the_face_exactly),
        cmocka_unit_test(nothing_behind_the_face_is_no_alpha),
        cmocka_unit_test(edges_have_the_colour_of_the_face),
        cmocka_unit_test(fibres_stand_out_of_thick_felt),
        cmocka_unit_test(fibres_leave_no_trace_where_the_face_was),
        cmocka_unit_test(the_wall_is_back_and_opaque),
    };
    error err;
    context = draw_context_create(&err);
    if (!context) {
        printf("SKIPPED: %s\n", err.text);
        return 77;
    }
    int failed = cmocka_run_group_tests(tests, set_up, tear_down);
    draw_context_destroy(context);
    return failed;
}
