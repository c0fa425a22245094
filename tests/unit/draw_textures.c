/* A head's own colours: textures where their coordinates say, alpha in its three modes, one side or
 * both, unlit and toon, vertex colours, emission, a normal map that turns the light. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "draw/draw.h"
#include "draw_help.h"

#include <stdio.h>
#include <string.h>

enum { SIDE = 120, PIXELS = SIDE * SIDE };

static draw_renderer *renderer;
static draw_target *target;
static uint8_t picture[PIXELS * 4], other[PIXELS * 4];

static const draw_camera front = {{0, 0, 0}, 800, 0, 0, 0.5f};

static void draw_mesh(const mesh *m, const draw_camera *camera, uint8_t *out)
{
    error err = {""};
    draw_face *face = draw_face_create(m, &err);
    if (!face)
        fail_msg("%s", err.text);
    draw_render(renderer, target, face, camera, 0, 0, SIDE, SIDE);
    draw_read(target, out);
    draw_face_destroy(face);
}

static const uint8_t *pixel(const uint8_t *rgba, int x, int y)
{
    return rgba + (y * SIDE + x) * 4;
}

static void assert_colour(const uint8_t *at, int red, int green, int blue)
{
    if (abs(at[0] - red) > 3 || abs(at[1] - green) > 3 || abs(at[2] - blue) > 3)
        fail_msg("(%d %d %d) instead of (%d %d %d)", at[0], at[1], at[2], red, green, blue);
}

static void add_image(mesh *m, const uint8_t *rgba, uint32_t width, uint32_t height)
{
    m->image = realloc(m->image, (m->image_count + 1) * sizeof *m->image);
    assert_non_null(m->image);
    mesh_image *image = &m->image[m->image_count++];
    *image = (mesh_image){.width = width, .height = height, .rgba = malloc(width * height * 4)};
    assert_non_null(image->rgba);
    memcpy(image->rgba, rgba, (size_t)width * height * 4);
}

/* Upper left red, upper right green, lower left blue, lower right half seen through. */
static const uint8_t FOUR[16] = {255, 0, 0,   255, 0,   255, 0,   255,
                                 0,   0, 255, 255, 255, 255, 255, 102};

/* The wall with a picture of four pixels all over it, unlit, so that its colours come out as they
 * are; clamped, so that the middle of each quarter is one pixel's. */
static mesh painted_wall(void)
{
    mesh m = shapes_wall(150, 0);
    static const float uv[8] = {0, 1, 1, 1, 1, 0, 0, 0};
    add_image(&m, FOUR, 2, 2);
    m.uv = malloc(sizeof uv);
    assert_non_null(m.uv);
    memcpy(m.uv, uv, sizeof uv);
    mesh_material *look = &m.material[0];
    for (int i = 0; i < 3; ++i)
        look->base_colour[i] = 1.0f;
    look->base.image = 1;
    look->base.wrap[0] = look->base.wrap[1] = MESH_WRAP_CLAMP;
    look->lighting = MESH_LIGHTING_NONE;
    return m;
}

enum { LOW = 35, HIGH = 85 }; /* pixels well within the quarters, near their outer corners */

static void a_picture_lies_where_its_coordinates_say(void **state)
{
    (void)state;
    mesh m = painted_wall();
    draw_mesh(&m, &front, picture);
    assert_colour(pixel(picture, LOW, LOW), 255, 0, 0);
    assert_colour(pixel(picture, HIGH, LOW), 0, 255, 0);
    assert_colour(pixel(picture, LOW, HIGH), 0, 0, 255);
    assert_colour(pixel(picture, HIGH, HIGH), 255, 255, 255); /* opaque: alpha says nothing */
    static const float turned[6] = {-1, 0, 1, 0, 1, 0};       /* u -> 1 - u */
    memcpy(m.material[0].base.uv_transform, turned, sizeof turned);
    draw_mesh(&m, &front, picture);
    assert_colour(pixel(picture, LOW, LOW), 0, 255, 0);
    mesh_destroy(&m);
}

static void a_picture_that_is_missing_leaves_the_base_colour(void **state)
{
    (void)state;
    mesh m = painted_wall();
    free(m.image[0].rgba);
    m.image[0].rgba = NULL;
    m.material[0].base_colour[1] = 0.0f;
    draw_mesh(&m, &front, picture);
    assert_colour(pixel(picture, LOW, LOW), 255, 0, 255);
    mesh_destroy(&m);
}

static void alpha_masks_and_blends(void **state)
{
    (void)state;
    draw_ground(renderer, (const float[4]){0, 0, 0, 1});
    mesh m = painted_wall();
    m.material[0].alpha = MESH_ALPHA_MASK;
    m.material[0].alpha_cutoff = 0.5f;
    draw_mesh(&m, &front, picture);
    assert_colour(pixel(picture, HIGH, HIGH), 0, 0, 0); /* 0.4: not there */
    assert_colour(pixel(picture, LOW, LOW), 255, 0, 0);
    m.material[0].alpha = MESH_ALPHA_BLEND;
    draw_mesh(&m, &front, picture);
    assert_colour(pixel(picture, HIGH, HIGH), 102, 102, 102); /* 0.4 of white over black */
    assert_colour(pixel(picture, LOW, LOW), 255, 0, 0);
    draw_ground(renderer, NULL);
    mesh_destroy(&m);
}

/* Two panes at z 0 and z 50, each a material; `near_first`: the order in the file. */
static mesh two_panes(int near_first)
{
    mesh far = shapes_wall(150, 0), near = shapes_wall(150, 50), m;
    error err;
    assert_int_equal(mesh_create(&m, 8, 4, &err), MRT_OK);
    const mesh *pane[2] = {near_first ? &near : &far, near_first ? &far : &near};
    m.material = realloc(m.material, 2 * sizeof *m.material);
    m.part = realloc(m.part, 2 * sizeof *m.part);
    assert_true(m.material && m.part);
    m.part_count = m.material_count = 2;
    for (uint32_t p = 0; p < 2; ++p) {
        memcpy(m.position + p * 12, pane[p]->position, 12 * sizeof(float));
        for (uint32_t i = 0; i < 6; ++i)
            m.triangle[p * 6 + i] = pane[p]->triangle[i] + p * 4;
        char *name = p == 0 ? m.part[0].name : NULL, *look = p == 0 ? m.material[0].name : NULL;
        m.part[p] = (mesh_part){.name = name ? name : calloc(1, 1),
                                .material = p,
                                .first_triangle = p * 2,
                                .triangle_count = 2,
                                .first_vertex = p * 4,
                                .vertex_count = 4};
        m.material[p] = mesh_material_grey();
        m.material[p].name = look ? look : calloc(1, 1);
        m.material[p].alpha = MESH_ALPHA_BLEND;
        m.material[p].lighting = MESH_LIGHTING_NONE;
        bool is_red = (p == 0) == (near_first == 1); /* the near one */
        const float colour[4] = {is_red ? 1.0f : 0.0f, is_red ? 0.0f : 1.0f, 0.0f, 0.5f};
        memcpy(m.material[p].base_colour, colour, sizeof colour);
    }
    mesh_destroy(&far);
    mesh_destroy(&near);
    return m;
}

static void the_farther_pane_is_drawn_first(void **state)
{
    (void)state;
    draw_ground(renderer, (const float[4]){0, 0, 0, 1});
    for (int near_first = 0; near_first < 2; ++near_first) {
        mesh m = two_panes(near_first);
        draw_mesh(&m, &front, picture);
        assert_colour(pixel(picture, SIDE / 2, SIDE / 2), 128, 64, 0);
        draw_camera back = front;
        back.yaw_rad = 3.14159265f;
        draw_mesh(&m, &back, picture);
        assert_colour(pixel(picture, SIDE / 2, SIDE / 2), 64, 128, 0);
        mesh_destroy(&m);
    }
    draw_ground(renderer, NULL);
}

static void one_side_or_both(void **state)
{
    (void)state;
    draw_ground(renderer, (const float[4]){0, 0, 0, 1});
    mesh m = painted_wall();
    draw_camera back = front;
    back.yaw_rad = 3.14159265f;
    draw_mesh(&m, &back, picture);
    assert_colour(pixel(picture, HIGH, LOW), 255, 0, 0); /* seen from behind: right is left */
    m.material[0].is_single_sided = true;
    draw_mesh(&m, &back, picture);
    assert_colour(pixel(picture, HIGH, LOW), 0, 0, 0);
    draw_mesh(&m, &front, picture);
    assert_colour(pixel(picture, LOW, LOW), 255, 0, 0);
    draw_ground(renderer, NULL);
    mesh_destroy(&m);
}

static void vertices_have_colours(void **state)
{
    (void)state;
    mesh m = shapes_wall(150, 0);
    m.colour = malloc(4 * 4 * sizeof *m.colour);
    assert_non_null(m.colour);
    for (int v = 0; v < 4; ++v) {
        const float green[4] = {0, 1, 0, 1};
        memcpy(m.colour + v * 4, green, sizeof green);
    }
    m.material[0].lighting = MESH_LIGHTING_NONE;
    m.material[0].base_colour[1] = 1.0f;
    draw_mesh(&m, &front, picture);
    assert_colour(pixel(picture, SIDE / 2, SIDE / 2), 0, 255, 0);
    m.material[0].lighting = MESH_LIGHTING_FULL;
    draw_mesh(&m, &front, picture);
    const uint8_t *lit = pixel(picture, SIDE / 2, SIDE / 2);
    assert_true(lit[1] > 100 && lit[0] < lit[1] / 2 && lit[2] < lit[1] / 2);
    mesh_destroy(&m);
}

static void what_glows_is_not_dark(void **state)
{
    (void)state;
    mesh m = shapes_wall(150, 0);
    for (int i = 0; i < 3; ++i)
        m.material[0].base_colour[i] = 0.0f;
    m.material[0].emission_colour[2] = 1.0f;
    m.material[0].lighting = MESH_LIGHTING_NONE;
    draw_mesh(&m, &front, picture);
    assert_colour(pixel(picture, SIDE / 2, SIDE / 2), 0, 0, 255);
    mesh_destroy(&m);
}

static void toon_has_two_tones(void **state)
{
    (void)state;
    mesh m = shapes_balls((const ball[]){{{0, 0, 0}, 100}}, 1);
    mesh_material *look = &m.material[0];
    look->lighting = MESH_LIGHTING_TOON;
    look->shade_toony = 1.0f;
    for (int i = 0; i < 3; ++i)
        look->base_colour[i] = 1.0f;
    look->shade_colour[0] = 1.0f;
    draw_mesh(&m, &front, picture);
    assert_colour(pixel(picture, 50, 48), 255, 255, 255); /* towards the key light */
    assert_colour(pixel(picture, 74, 74), 255, 0, 0);
    mesh_destroy(&m);
}

/* The normals of the picture look to the left, where the key light is; turned by half, away. */
static void a_normal_map_turns_the_light(void **state)
{
    (void)state;
    static const uint8_t left[4] = {40, 128, 220, 255}, right[4] = {216, 128, 220, 255};
    double sum[3];
    for (int i = 0; i < 3; ++i) {
        mesh m = painted_wall();
        m.material[0].base.image = 0;
        m.material[0].lighting = MESH_LIGHTING_FULL;
        for (int c = 0; c < 3; ++c)
            m.material[0].base_colour[c] = 0.3f;
        if (i > 0) {
            add_image(&m, i == 1 ? left : right, 1, 1);
            m.material[0].normal.image = 2;
        }
        draw_mesh(&m, &front, picture);
        const uint8_t *at = pixel(picture, SIDE / 2, SIDE / 2);
        sum[i] = at[0] + at[1] + at[2];
        mesh_destroy(&m);
    }
    assert_true(sum[1] > sum[0] + 10 && sum[2] < sum[0] - 10);
}

/* Green up is towards smaller v: the way glTF has it. */
static void a_normal_map_knows_up(void **state)
{
    (void)state;
    static const uint8_t up[4] = {128, 216, 220, 255}, down[4] = {128, 40, 220, 255};
    double sum[2];
    for (int i = 0; i < 2; ++i) {
        mesh m = painted_wall();
        m.material[0].lighting = MESH_LIGHTING_FULL;
        m.material[0].base.image = 0;
        add_image(&m, i == 0 ? up : down, 1, 1);
        m.material[0].normal.image = 2;
        draw_mesh(&m, &front, picture);
        const uint8_t *at = pixel(picture, SIDE / 2, SIDE / 2);
        sum[i] = at[0] + at[1] + at[2];
        mesh_destroy(&m);
    }
    assert_true(sum[0] > sum[1] + 10); /* the key light is above */
}

static void a_painted_face_twice_is_the_same_bytes(void **state)
{
    (void)state;
    mesh m = painted_wall();
    m.material[0].lighting = MESH_LIGHTING_FULL;
    m.material[0].alpha = MESH_ALPHA_BLEND;
    draw_mesh(&m, &front, picture);
    draw_mesh(&m, &front, other);
    assert_memory_equal(picture, other, sizeof picture);
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
        cmocka_unit_test(a_picture_lies_where_its_coordinates_say),
        cmocka_unit_test(a_picture_that_is_missing_leaves_the_base_colour),
        cmocka_unit_test(alpha_masks_and_blends),
        cmocka_unit_test(the_farther_pane_is_drawn_first),
        cmocka_unit_test(one_side_or_both),
        cmocka_unit_test(vertices_have_colours),
        cmocka_unit_test(what_glows_is_not_dark),
        cmocka_unit_test(toon_has_two_tones),
        cmocka_unit_test(a_normal_map_turns_the_light),
        cmocka_unit_test(a_normal_map_knows_up),
        cmocka_unit_test(a_painted_face_twice_is_the_same_bytes),
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
