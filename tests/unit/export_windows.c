#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "export_gltf_reader.h"
#include "export_scene.h"

enum { FRAMES = 480, LEFT_FRAMES = 240 };

static char folder[256], path[300];
static mesh sheet;
static clip *clay;
/* The clay with the default options, as it is read back. */
static gltf_report report;
static glb file;
static glb_face face;

/* The test sums in float64, the writer measures in float32: they differ by rounding. */
static const double ROUNDING_MM = 1e-4;

static gltf_report write_clip(const clip *c, gltf_options options)
{
    error err = {""};
    gltf_report out;
    if (gltf_write(path, c, &options, NULL, &out, &err) != MRT_OK)
        fail_msg("%s", err.text);
    return out;
}

static int set_up(void **state)
{
    (void)state;
    scene_folder(folder, sizeof folder);
    scene_path(path, sizeof path, folder, "clay.glb");
    sheet = scene_sheet(16);
    clay = scene_clay(&sheet, FRAMES, LEFT_FRAMES);
    report = write_clip(clay, (gltf_options){0});
    file = glb_open(path);
    face = glb_read_face(&file);
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    glb_face_finish(&face);
    glb_close(&file);
    clip_destroy(clay);
    mesh_destroy(&sheet);
    (void)unlink(path);
    return rmdir(folder); /* fails when the writer left anything else behind */
}

static float *shape_of(const clip *c, uint32_t frame)
{
    error err;
    float *shape = malloc((size_t)clip_mesh(c)->vertex_count * 3 * sizeof *shape);
    assert_int_equal(clip_read(c, frame, shape, &err), MRT_OK);
    return shape;
}

static double greatest_error_mm(const clip *c, const glb_face *shown)
{
    double greatest = 0.0;
    assert_int_equal(shown->key_count, clip_frame_count(c));
    for (uint32_t frame = 0; frame < clip_frame_count(c); ++frame) {
        float *shape = shape_of(c, frame);
        greatest = fmax(greatest, glb_key_error_mm(shown, frame, shape));
        free(shape);
    }
    return greatest;
}

/* ---- the targets of a window ---- */

static const char *target_name(size_t index)
{
    const json_t *extras = json_object_get(glb_mesh(&file), "extras");
    return json_string_value(json_array_get(json_object_get(extras, "targetNames"), index));
}

static size_t window_of(size_t target)
{
    unsigned window;
    assert_int_equal(sscanf(target_name(target), "w%u.", &window), 1);
    return window;
}

static size_t base_of(size_t window)
{
    char name[32];
    (void)snprintf(name, sizeof name, "w%zu.base", window);
    return glb_target_index(&file, name);
}

/* The window whose base is shown at a key: that of every weight that is not 0. */
static size_t window_at(size_t key)
{
    const float *weight = face.weight + key * face.target_count;
    size_t window = 0;
    for (size_t i = 0; i < face.target_count; ++i) {
        if (weight[i] == 0.0f)
            continue;
        assert_true(window == 0 || window_of(i) == window);
        window = window_of(i);
    }
    assert_true(window > 0);
    assert_true(weight[base_of(window)] == 1.0f);
    return window;
}

static void every_frame_of_every_window_holds_the_tolerance(void **state)
{
    (void)state;
    assert_true(report.window_count >= 2);
    assert_int_equal(report.target_count, report.component_count);
    assert_int_equal(face.target_count, report.target_count);
    double error_mm = greatest_error_mm(clay, &face);
    assert_true(error_mm <= report.tolerance_mm);
    assert_float_equal(error_mm, report.max_error_mm, ROUNDING_MM);
}

static void windows_follow_one_another_and_never_mix(void **state)
{
    (void)state;
    size_t window = 1;
    assert_int_equal(window_at(0), 1);
    for (size_t key = 1; key < face.key_count; ++key) {
        size_t next = window_at(key);
        assert_true(next == window || next == window + 1);
        window = next;
    }
    assert_int_equal(window, report.window_count);
}

/* What a LINEAR sampler makes of two keys, a quarter of the way. */
static double error_between_mm(uint32_t key)
{
    size_t count = face.target_count, length = face.vertex_count * 3;
    float *before = shape_of(clay, key), *after = shape_of(clay, key + 1);
    glb_face between = face;
    between.weight = malloc(count * sizeof *between.weight);
    for (size_t i = 0; i < count; ++i)
        between.weight[i] =
            0.75f * face.weight[key * count + i] + 0.25f * face.weight[(key + 1) * count + i];
    for (size_t i = 0; i < length; ++i)
        before[i] = 0.75f * before[i] + 0.25f * after[i];
    double error_mm = glb_key_error_mm(&between, 0, before);
    free(between.weight);
    free(before);
    free(after);
    return error_mm;
}

static void between_two_windows_the_shape_goes_straight(void **state)
{
    (void)state;
    uint32_t borders = 0;
    for (uint32_t key = 0; key + 1 < face.key_count; ++key) {
        if (window_at(key) == window_at(key + 1))
            continue;
        ++borders;
        assert_true(error_between_mm(key) <= report.tolerance_mm + ROUNDING_MM);
    }
    assert_int_equal(borders, report.window_count - 1);
}

static void what_a_window_does_not_touch_is_not_stored(void **state)
{
    (void)state;
    size_t last = window_at(FRAMES - 1);
    /* Both lie wholly on their side of the change. */
    assert_true(window_at(LEFT_FRAMES) > 1 && window_at(LEFT_FRAMES) < last);
    for (size_t i = 0; i < face.target_count; ++i) {
        size_t window = window_of(i);
        if ((window != 1 && window != last) || i == base_of(window))
            continue;
        double side = window == 1 ? 1.0 : -1.0; /* that the window leaves alone */
        for (size_t v = 0; v < face.vertex_count; ++v)
            if ((double)face.position[v * 3] * side > 0.0)
                for (size_t axis = 0; axis < 3; ++axis)
                    assert_true(face.target[i][v * 3 + axis] == 0.0f);
    }
}

/* However long it is: the same few shapes come again and again. */
static void a_long_motion_of_few_shapes_is_one_window(void **state)
{
    (void)state;
    error err;
    clip *c = clip_create(&sheet, 60.0, NULL, &err);
    scene_add_free(c, 1200, 0.0, 2);
    gltf_report other = write_clip(c, (gltf_options){0});
    assert_int_equal(other.window_count, 1);
    glb g = glb_open(path);
    assert_int_equal(glb_target_index(&g, "base"), 0);
    assert_int_equal(glb_target_index(&g, "component1"), 1);
    glb_close(&g);
    clip_destroy(c);
}

static void a_cap_on_targets_makes_few_windows(void **state)
{
    (void)state;
    static const uint32_t cap[] = {8, 20, 40, 60, 80};
    double before_mm = (double)INFINITY;
    for (size_t i = 0; i < sizeof cap / sizeof *cap; ++i) {
        gltf_report other = write_clip(clay, (gltf_options){.max_targets = cap[i]});
        assert_true(other.component_count <= cap[i]);
        assert_true(other.window_count == 1 || cap[i] >= 32 * other.window_count);
        assert_true(other.max_error_mm < before_mm);
        before_mm = other.max_error_mm;
        glb g = glb_open(path);
        glb_face shown = glb_read_face(&g);
        assert_float_equal(greatest_error_mm(clay, &shown), other.max_error_mm, ROUNDING_MM);
        glb_face_finish(&shown);
        glb_close(&g);
    }
}

static void anchored_frames_between_windows_stay_exact(void **state)
{
    (void)state;
    error err;
    clip *c = scene_clay(&sheet, FRAMES, LEFT_FRAMES);
    float *shape = shape_of(c, FRAMES - 1);
    scene_begin_segment(c, shape, &err);
    scene_add_anchored(c, 30, 0.3);
    scene_knead(c, shape, 150, 0);
    gltf_report other = write_clip(c, (gltf_options){0});
    assert_true(other.window_count >= 2);
    assert_int_equal(other.target_count, other.exact_target_count + other.component_count);
    glb g = glb_open(path);
    glb_face shown = glb_read_face(&g);
    assert_true(greatest_error_mm(c, &shown) <= other.tolerance_mm);
    for (uint32_t key = FRAMES; key < FRAMES + 30; ++key) {
        float *exact = shape_of(c, key);
        assert_true(glb_key_error_mm(&shown, key, exact) <= 0.001);
        free(exact);
    }
    glb_face_finish(&shown);
    glb_close(&g);
    clip_destroy(c);
    free(shape);
}

static void the_same_clay_gives_the_same_bytes(void **state)
{
    (void)state;
    clip *again = scene_clay(&sheet, FRAMES, LEFT_FRAMES);
    (void)write_clip(again, (gltf_options){0});
    glb second = glb_open(path);
    assert_int_equal(file.size, second.size);
    assert_memory_equal(file.file, second.file, file.size);
    glb_close(&second);
    clip_destroy(again);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_frame_of_every_window_holds_the_tolerance),
        cmocka_unit_test(windows_follow_one_another_and_never_mix),
        cmocka_unit_test(between_two_windows_the_shape_goes_straight),
        cmocka_unit_test(what_a_window_does_not_touch_is_not_stored),
        cmocka_unit_test(a_long_motion_of_few_shapes_is_one_window),
        cmocka_unit_test(a_cap_on_targets_makes_few_windows),
        cmocka_unit_test(anchored_frames_between_windows_stay_exact),
        cmocka_unit_test(the_same_clay_gives_the_same_bytes)};
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
