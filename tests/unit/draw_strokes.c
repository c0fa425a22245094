/* Strokes over pictures, colours per vertex, and where points land. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "draw/draw.h"
#include "draw_help.h"

#include <stdio.h>
#include <string.h>

enum { SIDE = 200, PIXELS = SIDE * SIDE };

static draw_renderer *renderer;
static draw_target *target;
static uint8_t picture[PIXELS * 4];
static const draw_camera front = {{0, 0, 0}, 800, 0, 0, 0.5f};
static const uint32_t whole[4] = {0, 0, SIDE, SIDE};

static const uint8_t *pixel(int x, int y)
{
    return picture + (y * SIDE + x) * 4;
}

static void draw_ball(const draw_camera *camera, const float *rgb)
{
    error err;
    mesh m = shapes_balls(&(ball){{0, 0, 0}, 100}, 1);
    draw_face *face = draw_face_create(&m, &err);
    assert_non_null(face);
    if (rgb)
        draw_face_colour(face, rgb);
    draw_render(renderer, target, face, camera, 0, 0, SIDE, SIDE);
    draw_face_destroy(face);
    mesh_destroy(&m);
}

static void own_colours_are_shown_until_they_are_taken_away(void **state)
{
    (void)state;
    static float rgb[BALL_VERTICES * 3];
    static uint8_t grey[PIXELS * 4];
    for (int v = 0; v < BALL_VERTICES; ++v)
        rgb[v * 3 + (v / BALL_RINGS < BALL_SIDES / 2 ? 0 : 2)] = 0.8f; /* +x red, -x blue */
    draw_ball(&front, rgb);
    draw_read(target, picture);
    assert_true(pixel(125, 100)[0] > pixel(125, 100)[2] + 100);
    assert_true(pixel(75, 100)[2] > pixel(75, 100)[0] + 100);
    draw_ball(&front, NULL);
    draw_read(target, grey);

    error err;
    mesh m = shapes_balls(&(ball){{0, 0, 0}, 100}, 1);
    draw_face *face = draw_face_create(&m, &err);
    assert_non_null(face);
    draw_face_colour(face, rgb);
    draw_face_colour(face, NULL);
    draw_render(renderer, target, face, &front, 0, 0, SIDE, SIDE);
    draw_read(target, picture);
    assert_memory_equal(picture, grey, sizeof picture);
    draw_face_destroy(face);
    mesh_destroy(&m);
}

static void strokes_cover_their_width_and_no_more(void **state)
{
    (void)state;
    static const draw_stroke strokes[] = {
        {{40, 60}, {160, 60}, 8, {1, 0, 0, 1}},    /* a line */
        {{100, 120}, {100, 120}, 20, {0, 1, 0, 1}} /* a dot */
    };
    draw_ball(&front, NULL);
    draw_strokes(renderer, target, strokes, 2);
    draw_strokes(renderer, target, strokes, 0);
    draw_read(target, picture);
    assert_true(pixel(100, 57)[0] > 240 && pixel(100, 57)[1] < 10);
    assert_true(pixel(100, 62)[0] > 240 && pixel(100, 62)[1] < 10);
    assert_true(pixel(100, 66)[0] < 240);
    assert_true(pixel(37, 60)[0] > 200); /* its ends are round */
    assert_true(pixel(33, 60)[0] < 100);
    assert_true(pixel(100, 112)[1] > 240 && pixel(108, 120)[1] > 240);
    assert_true(pixel(108, 112)[1] < 240);
}

static void strokes_mix_by_their_alpha(void **state)
{
    (void)state;
    static const draw_stroke base = {{20, 100}, {180, 100}, 30, {0, 0, 0, 1}};
    static const draw_stroke veil = {{20, 100}, {180, 100}, 30, {1, 1, 1, 0.5f}};
    draw_strokes(renderer, target, &base, 1);
    draw_strokes(renderer, target, &veil, 1);
    draw_read(target, picture);
    assert_near(pixel(100, 100)[0], 127.5, 1.0);
}

static void points_land_where_they_are_drawn(void **state)
{
    (void)state;
    draw_camera camera = front;
    camera.yaw_rad = 0.6f;
    camera.pitch_rad = 0.3f;
    camera.target[1] = 20.0f;
    /* A ball's silhouette is around its centre, but for perspective: a small ball is near it. */
    static const float centre[3] = {60, -30, 45};
    error err;
    mesh m = shapes_balls(&(ball){{60, -30, 45}, 6}, 1);
    draw_face *face = draw_face_create(&m, &err);
    static float red[BALL_VERTICES * 3];
    for (int v = 0; v < BALL_VERTICES; ++v)
        red[v * 3] = 1.0f;
    draw_face_colour(face, red);
    draw_render(renderer, target, face, &camera, 0, 0, SIDE, SIDE);
    draw_read(target, picture);
    double x = 0.0, y = 0.0, count = 0.0;
    for (int row = 0; row < SIDE; ++row)
        for (int column = 0; column < SIDE; ++column) {
            const uint8_t *p = pixel(column, row);
            if (p[0] < p[2] + 60)
                continue;
            x += column + 0.5;
            y += row + 0.5;
            count += 1.0;
        }
    assert_true(count > 5.0);
    float px[2];
    assert_true(draw_project(px, &camera, whole, centre));
    assert_near(px[0], x / count, 0.6);
    assert_near(px[1], y / count, 0.6);
    draw_face_destroy(face);
    mesh_destroy(&m);
}

static void projection_follows_the_rectangle(void **state)
{
    (void)state;
    static const uint32_t corner[4] = {100, 50, 60, 40};
    static const uint32_t none[4] = {0, 0, 0, 40};
    float px[2];
    assert_true(draw_project(px, &front, corner, (const float[3]){0, 0, 0}));
    assert_near(px[0], 130.0, 1e-3);
    assert_near(px[1], 70.0, 1e-3);
    assert_false(draw_project(px, &front, whole, (const float[3]){0, 0, 900}));
    assert_false(draw_project(px, &front, none, (const float[3]){0, 0, 0}));
}

int main(void)
{
    error err = {{0}};
    draw_context *context = draw_context_create(&err);
    if (!context) {
        printf("SKIPPED: %s\n", err.text);
        return 77;
    }
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(own_colours_are_shown_until_they_are_taken_away),
        cmocka_unit_test(strokes_cover_their_width_and_no_more),
        cmocka_unit_test(strokes_mix_by_their_alpha),
        cmocka_unit_test(points_land_where_they_are_drawn),
        cmocka_unit_test(projection_follows_the_rectangle),
    };
    renderer = draw_renderer_create(&err);
    target = renderer ? draw_target_create(SIDE, SIDE, &err) : NULL;
    if (!target)
        printf("%s\n", err.text);
    int failed = target ? cmocka_run_group_tests(tests, NULL, NULL) : 1;
    draw_target_destroy(target);
    draw_renderer_destroy(renderer);
    draw_context_destroy(context);
    return failed;
}
