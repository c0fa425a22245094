/* What the renderer draws, pixel by pixel. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "draw/draw.h"
#include "draw/gl.h"
#include "draw/face.h"
#include "draw_help.h"

#include <stdio.h>
#include <string.h>

enum { SIDE = 240, PIXELS = SIDE * SIDE };

static draw_renderer *renderer;
static draw_target *target;
static uint8_t picture[PIXELS * 4], other[PIXELS * 4];

static const draw_camera front = {{0, 0, 0}, 800, 0, 0, 0.5f};

static void draw_mesh(const mesh *m, const draw_camera *camera, uint8_t *out)
{
    error err;
    draw_face *face = draw_face_create(m, &err);
    assert_non_null(face);
    draw_render(renderer, target, face, camera, 0, 0, SIDE, SIDE);
    draw_read(target, out);
    draw_face_destroy(face);
}

static void draw_ball(const ball *b, const draw_camera *camera, uint8_t *out)
{
    mesh m = shapes_balls(b, 1);
    draw_mesh(&m, camera, out);
    mesh_destroy(&m);
}

/* What is behind every face. */
static void draw_wall_alone(uint8_t *out)
{
    draw_camera away = front;
    away.target[0] = 1e6f;
    draw_ball(&(ball){{0, 0, 0}, 1}, &away, out);
}

static int brightness(const uint8_t *rgba, int x, int y)
{
    const uint8_t *p = rgba + (y * SIDE + x) * 4;
    return p[0] + p[1] + p[2];
}

static double mean_brightness(const uint8_t *rgba, int x, int y, int width, int height)
{
    double sum = 0.0;
    for (int row = y; row < y + height; ++row)
        for (int column = x; column < x + width; ++column)
            sum += brightness(rgba, column, row);
    return sum / (width * height);
}

typedef struct outline {
    int count, left, right, top, bottom; /* inclusive */
    double x, y;                         /* the middle of the pixels */
} outline;

/* Where the picture differs clearly from the wall. */
static outline find_outline(const uint8_t *rgba)
{
    static uint8_t wall[PIXELS * 4];
    draw_wall_alone(wall);
    outline o = {0, SIDE, -1, SIDE, -1, 0.0, 0.0};
    for (int y = 0; y < SIDE; ++y)
        for (int x = 0; x < SIDE; ++x) {
            if (abs(brightness(rgba, x, y) - brightness(wall, x, y)) < 30)
                continue;
            ++o.count;
            o.left = x < o.left ? x : o.left;
            o.right = x > o.right ? x : o.right;
            o.top = y < o.top ? y : o.top;
            o.bottom = y > o.bottom ? y : o.bottom;
            o.x += x + 0.5;
            o.y += y + 0.5;
        }
    if (o.count) {
        o.x /= o.count;
        o.y /= o.count;
    }
    return o;
}

static void same_scene_twice_is_the_same_bytes(void **state)
{
    (void)state;
    mesh m = shapes_balls((const ball[]){{{0, 0, 0}, 80}, {{60, 60, 60}, 30}}, 2);
    m.material[0].roughness = 0.95f;
    draw_camera camera = front;
    camera.yaw_rad = 0.6f;
    draw_mesh(&m, &camera, picture);
    draw_mesh(&m, &camera, other);
    assert_memory_equal(picture, other, sizeof picture);
    mesh_destroy(&m);
}

static void ball_is_lit_from_the_upper_left(void **state)
{
    (void)state;
    for (int turn = 0; turn < 3; ++turn) { /* the lights turn with the camera */
        draw_camera camera = front;
        camera.yaw_rad = (float)turn * 2.0f;
        draw_ball(&(ball){{0, 0, 0}, 100}, &camera, picture);
        double lit = mean_brightness(picture, 95, 90, 10, 10);
        double middle = mean_brightness(picture, 115, 115, 10, 10);
        double dark = mean_brightness(picture, 140, 145, 10, 10);
        assert_true(lit > middle + 20.0);
        assert_true(middle > dark + 60.0);
        assert_true(dark > 60.0); /* never black: the form stays readable */
        assert_true(lit < 3 * 250.0);
    }
}

static void outline_is_where_the_camera_says(void **state)
{
    (void)state;
    /* A ball of radius r at distance d shows a disc of r / sqrt(d^2 - r^2) / tan(fov / 2). */
    draw_ball(&(ball){{0, 0, 0}, 100}, &front, picture);
    outline o = find_outline(picture);
    double radius_px = SIDE / 2 * 100.0 / sqrt(800.0 * 800.0 - 1e4) / tan(0.25);
    assert_near(o.x, SIDE / 2, 0.7);
    assert_near(o.y, SIDE / 2, 0.7);
    assert_near((o.right - o.left + 1) / 2.0, radius_px, 1.0);
    assert_near((o.bottom - o.top + 1) / 2.0, radius_px, 1.0);
    assert_near(o.count, 3.141593 * radius_px * radius_px, 0.03 * o.count);
}

static void directions_are_those_of_the_face(void **state)
{
    (void)state;
    double px_per_mm = SIDE / 2 / tan(0.25) / 800.0;
    draw_ball(&(ball){{80, 0, 0}, 20}, &front, picture); /* the subject's left: right of picture */
    outline o = find_outline(picture);
    assert_near(o.x, SIDE / 2 + 80.0 * px_per_mm, 1.5);
    assert_near(o.y, SIDE / 2, 1.0);
    draw_ball(&(ball){{0, 80, 0}, 20}, &front, picture);
    o = find_outline(picture);
    assert_near(o.y, SIDE / 2 - 80.0 * px_per_mm, 1.5);
    draw_camera camera = front;
    camera.yaw_rad = 1.5707963f; /* from the subject's left */
    draw_ball(&(ball){{0, 0, 80}, 20}, &camera, picture);
    o = find_outline(picture);
    assert_near(o.x, SIDE / 2 - 80.0 * px_per_mm, 1.5);
    camera.yaw_rad = 0.0f;
    camera.pitch_rad = 1.5707963f; /* from above */
    draw_ball(&(ball){{0, 0, 80}, 20}, &camera, picture);
    o = find_outline(picture);
    assert_near(o.y, SIDE / 2 + 80.0 * px_per_mm, 1.5);
}

static void only_the_rectangle_is_drawn(void **state)
{
    (void)state;
    error err;
    mesh m = shapes_balls(&(ball){{0, 0, 0}, 100}, 1);
    draw_face *face = draw_face_create(&m, &err);
    draw_target *fresh = draw_target_create(SIDE, SIDE, &err);
    assert_non_null(fresh);
    draw_read(fresh, other);
    draw_render(renderer, fresh, face, &front, 40, 20, 100, 60);
    draw_render(renderer, fresh, face, &front, SIDE, 0, 10, 10); /* beside the target */
    draw_render(renderer, fresh, face, &front, 0, 0, 0, 10);
    draw_read(fresh, picture);
    int drawn = 0;
    for (int y = 0; y < SIDE; ++y)
        for (int x = 0; x < SIDE; ++x) {
            bool inside = x >= 40 && x < 140 && y >= 20 && y < 80;
            bool differs = brightness(picture, x, y) != brightness(other, x, y);
            assert_true(inside || !differs);
            drawn += differs;
        }
    assert_true(drawn > 100 * 60 * 8 / 10); /* the wall may have the page's colour here and there */
    assert_true(brightness(picture, 90, 50) > 200); /* the ball, in the middle of it */
    draw_render(renderer, fresh, face, &front, SIDE - 50, SIDE - 50, 200, 200); /* sticks out */
    draw_target_destroy(fresh);
    draw_face_destroy(face);
    mesh_destroy(&m);
}

static void update_moves_the_shape(void **state)
{
    (void)state;
    error err;
    mesh m = shapes_balls(&(ball){{0, 0, 0}, 40}, 1);
    draw_face *face = draw_face_create(&m, &err);
    for (uint32_t v = 0; v < m.vertex_count; ++v)
        m.position[v * 3] += 60.0f;
    draw_face_update(face, m.position, NULL);
    draw_render(renderer, target, face, &front, 0, 0, SIDE, SIDE);
    draw_read(target, picture);
    outline o = find_outline(picture);
    assert_near(o.x, SIDE / 2 + 60.0 * SIDE / 2 / tan(0.25) / 800.0, 1.5);
    draw_ball(&(ball){{60, 0, 0}, 40}, &front, other); /* and is shaded like a face made there */
    int64_t difference = 0;
    for (int i = 0; i < PIXELS * 4; ++i)
        difference += abs(picture[i] - other[i]);
    assert_true((double)difference / (PIXELS * 4) < 0.1);
    for (uint32_t v = 0; v < m.vertex_count; v += 7)
        m.position[v * 3 + v % 3] = v % 2 ? NAN : INFINITY;
    draw_face_update(face, m.position, NULL); /* a broken plugin must not end the show */
    draw_render(renderer, target, face, &front, 0, 0, SIDE, SIDE);
    draw_face_destroy(face);
    mesh_destroy(&m);
}

static void draw_both(const draw_face *followed, const draw_face *updated)
{
    draw_render(renderer, target, followed, &front, 0, 0, SIDE, SIDE);
    draw_read(target, picture);
    draw_render(renderer, target, updated, &front, 0, 0, SIDE, SIDE);
    draw_read(target, other);
}

static void a_face_that_follows_what_changed_is_the_whole_one(void **state)
{
    (void)state;
    error err = {""};
    mesh m = shapes_balls(&(ball){{0, 0, 0}, 60}, 1);
    uint32_t parts = (m.vertex_count + DRAW_ROWS - 1) / DRAW_ROWS;
    float *normal = malloc((size_t)m.vertex_count * 3 * sizeof *normal);
    draw_face *followed = draw_face_create(&m, &err), *updated = draw_face_create(&m, &err);
    stamps changed;
    assert_true(parts > 4 && normal);
    assert_int_equal(stamps_create(&changed, parts, &err), MRT_OK);
    for (uint32_t v = 0; v < m.vertex_count * 3; ++v)
        normal[v] = m.position[v] / 60.0f;
    assert_true(draw_face_follow(followed, m.position, normal, &changed));
    assert_false(draw_face_follow(followed, m.position, normal, &changed));
    for (uint32_t round = 0; round < 6; ++round) {
        stamps_begin(&changed);
        for (uint32_t part = round; part < parts; part += round == 5 ? 1 : 2 + round) {
            stamps_mark(&changed, part);
            uint32_t end = (part + 1) * DRAW_ROWS;
            for (uint32_t v = part * DRAW_ROWS; v < end && v < m.vertex_count; ++v)
                m.position[v * 3] += 9.0f;
        }
        assert_true(draw_face_follow(followed, m.position, normal, &changed));
        draw_face_update(updated, m.position, normal);
        draw_both(followed, updated);
        assert_memory_equal(picture, other, sizeof picture);
    }
    stamps_begin(&changed); /* somebody else's shape comes between */
    draw_face_update(followed, m.position, NULL);
    assert_true(draw_face_follow(followed, m.position, normal, &changed));
    draw_both(followed, updated);
    assert_memory_equal(picture, other, sizeof picture);
    stamps_destroy(&changed);
    draw_face_destroy(followed);
    draw_face_destroy(updated);
    mesh_destroy(&m);
    free(normal);
}

/* A target keeps the wall around a face that moves, but no stroke, and no wall of another light. */
static void a_target_drawn_again_is_as_a_new_one(void **state)
{
    (void)state;
    static const ball balls[] = {{{-60, 0, 0}, 50},   {{70, 40, 20}, 30}, {{0, 0, 0}, 90},
                                 {{150, -90, 0}, 60}, {{0, 0, 0}, 5},     {{40, 0, 700}, 90},
                                 {{-20, 10, 0}, 40}};
    const draw_stroke stroke = {{10, 10}, {200, 30}, 6, {1, 0, 0, 1}};
    const float clear[4] = {0, 0, 0, 0};
    draw_target *kept = target;
    error err;
    for (uint32_t i = 0; i < 14; ++i) {
        if (i == 4)
            draw_light(renderer, &lighting_looks[1].light);
        if (i == 9)
            draw_ground(renderer, clear);
        mesh m = shapes_balls(&balls[i % 7], 1);
        draw_mesh(&m, &front, picture);
        draw_target *fresh = draw_target_create(SIDE, SIDE, &err);
        assert_non_null(fresh);
        target = fresh;
        draw_mesh(&m, &front, other);
        target = kept;
        draw_target_destroy(fresh);
        mesh_destroy(&m);
        assert_memory_equal(picture, other, sizeof picture);
        if (i == 2)
            draw_strokes(renderer, target, &stroke, 1);
    }
    draw_light(renderer, NULL);
    draw_ground(renderer, NULL);
}

static void a_ball_before_a_wall_throws_a_shadow(void **state)
{
    (void)state;
    error err;
    mesh m;
    mesh balls = shapes_balls(&(ball){{-67, 72, -81}, 25}, 1); /* 120 mm towards the key light */
    assert_int_equal(mesh_create(&m, balls.vertex_count + 4, balls.triangle_count + 2, &err),
                     MRT_OK);
    mesh wall = shapes_wall(150, -150);
    memcpy(m.position, balls.position, balls.vertex_count * 3 * sizeof(float));
    memcpy(m.position + balls.vertex_count * 3, wall.position, 12 * sizeof(float));
    memcpy(m.triangle, balls.triangle, balls.triangle_count * 3 * sizeof(uint32_t));
    for (uint32_t i = 0; i < 6; ++i)
        m.triangle[balls.triangle_count * 3 + i] = wall.triangle[i] + balls.vertex_count;
    draw_mesh(&m, &front, picture);
    double shadow = mean_brightness(picture, 117, 117, 6, 6);
    double left = mean_brightness(picture, 70, 150, 6, 6);
    double right = mean_brightness(picture, 165, 90, 6, 6);
    assert_true(shadow < 0.75 * left);
    assert_true(shadow < 0.75 * right);
    mesh_destroy(&m);
    mesh_destroy(&balls);
    mesh_destroy(&wall);
}

static void a_lit_wall_has_no_speckles(void **state)
{
    (void)state;
    mesh m = shapes_wall(400, 0); /* fills the picture; any speckle is the shadow map's */
    for (int turn = -1; turn <= 1; ++turn) {
        draw_camera camera = front;
        camera.yaw_rad = 0.9f * (float)turn;
        draw_mesh(&m, &camera, picture);
        for (int y = 80; y < 160; ++y)
            for (int x = 80; x < 160; ++x) {
                int step = brightness(picture, x, y) - brightness(picture, x - 1, y);
                assert_true(abs(step) <= 12); /* of 765: dither and the gradient */
            }
    }
    mesh_destroy(&m);
}

static void grain_is_fixed_to_the_stone(void **state)
{
    (void)state;
    error err;
    mesh m = shapes_wall(150, 0);
    m.material[0].roughness = 0.95f;
    free(m.material[0].name);
    m.material[0].name = strdup("stone");
    assert_non_null(m.material[0].name);
    draw_face *face = draw_face_create(&m, &err);
    draw_render(renderer, target, face, &front, 0, 0, SIDE, SIDE);
    draw_read(target, picture);
    int low = 765, high = 0;
    for (int i = 100; i < 140; ++i) {
        int b = brightness(picture, i, 120);
        low = b < low ? b : low;
        high = b > high ? b : high;
    }
    assert_true(high - low > 15); /* there is grain */
    draw_camera moved = front;
    for (uint32_t v = 0; v < m.vertex_count; ++v)
        m.position[v * 3] += 64.0f;
    moved.target[0] += 64.0f;
    draw_face_update(face, m.position, NULL);
    draw_render(renderer, target, face, &moved, 0, 0, SIDE, SIDE);
    draw_read(target, other);
    int differing = 0;
    for (int i = 0; i < PIXELS * 4; ++i)
        differing += abs(picture[i] - other[i]) > 2;
    assert_true(differing < PIXELS * 4 / 200); /* it went along */
    draw_face_destroy(face);
    mesh_destroy(&m);
}

/* Of a ball, and of one in it. */
static void bake_enclosed(float out_openness[2 * BALL_VERTICES], const char *material)
{
    error err;
    mesh m = shapes_balls((const ball[]){{{0, 0, 0}, 100}, {{0, 0, 0}, 40}}, 2);
    free(m.material[0].name);
    m.material[0].name = strdup(material);
    draw_face *face = draw_face_create(&m, &err);
    gl_state before;
    gl_state_enter(&before);
    assert_int_equal(occlusion_bake(out_openness, face, m.position, &err), MRT_OK);
    gl_state_leave(&before);
    draw_face_destroy(face);
    mesh_destroy(&m);
}

static void what_is_enclosed_is_dark(void **state)
{
    (void)state;
    float openness[2 * BALL_VERTICES];
    bake_enclosed(openness, "head");
    for (uint32_t v = 0; v < BALL_VERTICES; ++v) {
        assert_true(openness[v] > 0.97f);
        assert_true(openness[BALL_VERTICES + v] < 0.03f);
    }
}

/* They are seen only when the mouth is open. */
static void teeth_behind_closed_lips_are_not_dark(void **state)
{
    (void)state;
    float openness[2 * BALL_VERTICES];
    bake_enclosed(openness, "teeth_upper");
    for (uint32_t v = 0; v < BALL_VERTICES; ++v) {
        assert_true(openness[v] > 0.97f);
        assert_true(openness[BALL_VERTICES + v] > 0.5f);
    }
}

static void materials_show_their_colours(void **state)
{
    (void)state;
    error err;
    mesh m = shapes_balls((const ball[]){{{-60, 0, 0}, 40}, {{60, 0, 0}, 40}}, 2);
    mesh_material *material = realloc(m.material, 2 * sizeof *material);
    mesh_part *part = realloc(m.part, 2 * sizeof *part);
    assert_true(material && part);
    m.material = material;
    m.part = part;
    m.material_count = m.part_count = 2;
    material[1] = (mesh_material){.base_colour = {0.02f, 0.05f, 0.6f, 1.0f}, .roughness = 0.6f};
    material[0].base_colour[0] = 0.6f;
    material[0].base_colour[1] = material[0].base_colour[2] = 0.03f;
    part[0].material = 1; /* the parts' order is not the materials' */
    part[0].triangle_count = m.triangle_count / 2;
    part[1] = (mesh_part){NULL, 0, m.triangle_count / 2, m.triangle_count / 2, 0, 0};
    draw_mesh(&m, &front, picture);
    const uint8_t *blue = picture + (116 * SIDE + 80) * 4, *red = picture + (116 * SIDE + 152) * 4;
    assert_true(blue[2] > 120 && blue[2] > 2 * blue[0] && blue[2] > 2 * blue[1]);
    assert_true(red[0] > 120 && red[0] > 2 * red[1] && red[0] > 2 * red[2]);
    material[0].base_colour[3] = 0.2f; /* glass */
    draw_mesh(&m, &front, other);
    assert_true(other[(116 * SIDE + 152) * 4] < red[0] - 40);
    material[0].base_colour[3] = 1.0f;
    (void)err;
    mesh_destroy(&m);
}

static void meshes_without_triangles_are_points(void **state)
{
    (void)state;
    error err;
    mesh m;
    assert_int_equal(mesh_create(&m, 1, 0, &err), MRT_OK);
    draw_mesh(&m, &front, picture);
    outline o = find_outline(picture);
    assert_true(o.count >= 4 && o.count <= 36);
    assert_near(o.x, SIDE / 2, 1.0);
    mesh_destroy(&m);
}

static void wild_meshes_and_cameras_are_survived(void **state)
{
    (void)state;
    error err;
    mesh m;
    assert_int_equal(mesh_create(&m, 3, 1, &err), MRT_OK); /* all at one place */
    m.triangle[1] = 1;
    m.triangle[2] = 2;
    draw_mesh(&m, &front, picture);
    m.position[0] = 3e38f;
    m.position[4] = -3e38f;
    draw_mesh(&m, &front, picture);
    draw_mesh(&m, &(draw_camera){{NAN, 0, 0}, -1, NAN, 0, 100}, picture);
    m.triangle[2] = 3;
    assert_null(draw_face_create(&m, &err));
    assert_non_null(strstr(err.text, "vertex 3 of 3"));
    mesh_destroy(&m);
}

static void pictures_of_no_or_huge_size_are_refused(void **state)
{
    (void)state;
    static const uint32_t sizes[][2] = {{0, 0},        {0, 10},      {10, 0},
                                        {1u << 20, 1}, {8000, 8000}, {UINT32_MAX, UINT32_MAX}};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; ++i) {
        error err = {{0}};
        assert_null(draw_target_create(sizes[i][0], sizes[i][1], &err));
        assert_non_null(strstr(err.text, "a picture of"));
    }
}

/* A state that a window could have, nothing of it the default. */
static void set_odd_state(GLuint framebuffer, GLuint buffer, GLuint vertex_array, GLuint texture)
{
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer);
    glBindVertexArray(vertex_array);
    glBindBuffer(GL_ARRAY_BUFFER, buffer);
    glActiveTexture(GL_TEXTURE1);
    glBindTexture(GL_TEXTURE_2D, texture);
    glViewport(1, 2, 30, 40);
    glScissor(3, 4, 50, 60);
    glEnable(GL_SCISSOR_TEST);
    glEnable(GL_BLEND);
    glEnable(GL_CULL_FACE);
    glBlendFuncSeparate(GL_ONE, GL_DST_COLOR, GL_ZERO, GL_ONE);
    glBlendEquationSeparate(GL_MAX, GL_MIN);
    glColorMask(GL_TRUE, GL_FALSE, GL_TRUE, GL_FALSE);
    glDepthMask(GL_FALSE);
    glDepthFunc(GL_GREATER);
    glClearColor(0.25f, 0.5f, 0.75f, 1.0f);
    glPixelStorei(GL_PACK_ROW_LENGTH, 777);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 8);
    glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
    glFrontFace(GL_CW);
}

/* Whatever a window left, the picture is the same, and the window draws where it drew before. */
static void a_windows_state_changes_no_picture_and_its_framebuffer_stays(void **state)
{
    (void)state;
    mesh m = shapes_balls(&(ball){{0, 0, 0}, 100}, 1);
    draw_mesh(&m, &front, picture);
    GLuint framebuffer, buffer, vertex_array, texture;
    glGenFramebuffers(1, &framebuffer);
    glGenBuffers(1, &buffer);
    glGenVertexArrays(1, &vertex_array);
    glGenTextures(1, &texture);
    gl_state before, after;
    set_odd_state(framebuffer, buffer, vertex_array, texture);
    gl_state_enter(&before);
    gl_state_leave(&before);
    set_odd_state(framebuffer, buffer, vertex_array, texture);
    draw_mesh(&m, &front, other);
    set_odd_state(framebuffer, buffer, vertex_array, texture);
    draw_text(renderer, target, "x", 0, 0, 20, (const float[4]){1, 1, 1, 1});
    assert_true(draw_target_texture(target) != 0);
    assert_false(glIsEnabled(GL_SCISSOR_TEST));
    gl_state_enter(&after);
    assert_memory_equal(&before, &after, sizeof before);
    assert_int_equal(before.draw_framebuffer, framebuffer);
    assert_int_equal(before.viewport[3], 40);
    assert_memory_equal(picture, other, sizeof picture);
    assert_int_equal(glGetError(), GL_NO_ERROR);
    glDeleteFramebuffers(1, &framebuffer);
    glDeleteBuffers(1, &buffer);
    glDeleteVertexArrays(1, &vertex_array);
    glDeleteTextures(1, &texture);
    mesh_destroy(&m);
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
        cmocka_unit_test(same_scene_twice_is_the_same_bytes),
        cmocka_unit_test(ball_is_lit_from_the_upper_left),
        cmocka_unit_test(outline_is_where_the_camera_says),
        cmocka_unit_test(directions_are_those_of_the_face),
        cmocka_unit_test(only_the_rectangle_is_drawn),
        cmocka_unit_test(update_moves_the_shape),
        cmocka_unit_test(a_face_that_follows_what_changed_is_the_whole_one),
        cmocka_unit_test(a_target_drawn_again_is_as_a_new_one),
        cmocka_unit_test(a_ball_before_a_wall_throws_a_shadow),
        cmocka_unit_test(a_lit_wall_has_no_speckles),
        cmocka_unit_test(grain_is_fixed_to_the_stone),
        cmocka_unit_test(what_is_enclosed_is_dark),
        cmocka_unit_test(teeth_behind_closed_lips_are_not_dark),
        cmocka_unit_test(materials_show_their_colours),
        cmocka_unit_test(meshes_without_triangles_are_points),
        cmocka_unit_test(wild_meshes_and_cameras_are_survived),
        cmocka_unit_test(pictures_of_no_or_huge_size_are_refused),
        cmocka_unit_test(a_windows_state_changes_no_picture_and_its_framebuffer_stays),
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
