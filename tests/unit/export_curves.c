#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "export_gltf_reader.h"
#include "export_scene.h"

enum { FRAMES = 40, OPEN = 0, ASIDE, NUMBER, CURVES };

static char folder[256], path[300];
static mesh sheet;

static int set_up(void **state)
{
    (void)state;
    scene_folder(folder, sizeof folder);
    scene_path(path, sizeof path, folder, "curves.glb");
    sheet = scene_sheet(20);
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    mesh_destroy(&sheet);
    (void)unlink(path);
    return rmdir(folder);
}

/* mm at a vertex, for the whole of a curve: "jaw.open" down to 0.5 rad, "jaw.lateral" to either
 * side, not alike. */
static void moves(float out[3], size_t v, int curve, double sign)
{
    const float *at = sheet.position + v * 3;
    out[0] = curve == ASIDE ? (float)(sign * 7.0 * scene_bump(at, 0.0, -60.0, 60.0)) : 0.0f;
    out[1] = curve == OPEN ? (float)(-20.0 * scene_bump(at, 0.0, -50.0, 70.0)) : 0.0f;
    out[2] = curve == ASIDE && sign < 0.0 ? (float)(3.0 * scene_bump(at, 9.0, -60.0, 40.0)) : 0.0f;
}

static float *whole(int curve, double sign)
{
    float *out = malloc((size_t)sheet.vertex_count * 3 * sizeof *out);
    for (size_t v = 0; v < sheet.vertex_count; ++v)
        moves(out + v * 3, v, curve, sign);
    return out;
}

static void add_curves(clip *c)
{
    error err;
    char open[] = "jaw.open", aside[] = "jaw.lateral", number[] = "chin.x", rad[] = "rad",
         mm[] = "mm";
    clip_curve curve[CURVES] = {
        {open, rad, 0.0, 0.5, NULL, whole(OPEN, 1.0), false},
        {aside, mm, -4.0, 8.0, whole(ASIDE, -1.0), whole(ASIDE, 1.0), false},
        {number, mm, 0.0, 0.0, NULL, NULL, false}};
    for (int i = 0; i < CURVES; ++i) {
        assert_int_equal(clip_add_curve(c, &curve[i], &err), MRT_OK);
        free(curve[i].at_min);
        free(curve[i].at_max);
    }
}

/* An engagement of a corner of the mouth on the face's left, and of the chin in its middle. */
static void begin_pulls(clip *c)
{
    error err;
    char corner[] = "corner.l", chin[] = "chin";
    clip_pull pull[2] = {{corner, {40.0, -20.0, 0.0}, calloc(sheet.vertex_count, sizeof(float))},
                         {chin, {0.5, -80.0, 0.0}, calloc(sheet.vertex_count, sizeof(float))}};
    for (int k = 0; k < 2; ++k)
        for (size_t v = 0; v < sheet.vertex_count; ++v)
            pull[k].response[v] = (float)scene_bump(sheet.position + v * 3, pull[k].place_mm[0],
                                                    pull[k].place_mm[1], 50.0);
    assert_int_equal(clip_begin_segment(c, sheet.position, NULL, NULL, 0, &err), MRT_OK);
    assert_int_equal(clip_set_pulls(c, pull, 2, &err), MRT_OK);
    for (int k = 0; k < 2; ++k)
        free(pull[k].response);
}

static double opened(int frame)
{
    return 0.25 + 0.25 * sin(0.3 * frame);
}

static double aside(int frame)
{
    return 4.0 * sin(0.2 * frame);
}

static void add_part(float *shape, double part, int curve, double sign)
{
    float *moved = whole(curve, sign);
    for (size_t i = 0; i < (size_t)sheet.vertex_count * 3; ++i)
        shape[i] += (float)part * moved[i];
    free(moved);
}

/* What the curves and pulls of a frame say, and a bump that none of them has. */
static void shape_of(float *shape, int frame, const double pulled[6], double bent_mm)
{
    memcpy(shape, sheet.position, (size_t)sheet.vertex_count * 3 * sizeof *shape);
    add_part(shape, opened(frame) / 0.5, OPEN, 1.0);
    add_part(shape, aside(frame) / (aside(frame) < 0.0 ? -4.0 : 8.0), ASIDE,
             copysign(1.0, aside(frame)));
    for (size_t v = 0; v < sheet.vertex_count; ++v) {
        const float *at = sheet.position + v * 3;
        double corner = scene_bump(at, 40.0, -20.0, 50.0), chin = scene_bump(at, 0.5, -80.0, 50.0);
        for (size_t axis = 0; axis < 3; ++axis)
            shape[v * 3 + axis] += (float)(corner * pulled[axis] + chin * pulled[3 + axis]);
        shape[v * 3 + 2] += (float)(bent_mm * opened(frame) * opened(frame) / 0.25 *
                                    scene_bump(at, -30.0, 30.0, 50.0));
    }
}

static clip *performed(double bent_mm)
{
    error err;
    clip *c = clip_create(&sheet, 30.0, NULL, &err);
    float *shape = malloc((size_t)sheet.vertex_count * 3 * sizeof *shape);
    add_curves(c);
    begin_pulls(c);
    for (int frame = 0; frame < FRAMES; ++frame) {
        const double value[CURVES] = {opened(frame), aside(frame), 1.5},
                     pulled[6] = {6.0 * sin(0.5 * frame), 2.0, 0.0, -3.0, 0.0, 1.0};
        if (frame == FRAMES / 2)
            begin_pulls(c); /* taken hold of anew, the same */
        shape_of(shape, frame, pulled, bent_mm);
        assert_int_equal(clip_add_free(c, shape, &err), MRT_OK);
        assert_int_equal(clip_add_named(c, value, pulled, &err), MRT_OK);
    }
    free(shape);
    return c;
}

static gltf_report write_clip(const clip *c, gltf_options options)
{
    error err = {""};
    gltf_report report;
    if (gltf_write(path, c, &options, NULL, &report, &err) != MRT_OK)
        fail_msg("%s", err.text);
    return report;
}

static double greatest_error_mm(const clip *c, const glb_face *face)
{
    error err;
    double greatest = 0.0;
    float *shape = malloc((size_t)sheet.vertex_count * 3 * sizeof *shape);
    for (uint32_t frame = 0; frame < FRAMES; ++frame) {
        assert_int_equal(clip_read(c, frame, shape, &err), MRT_OK);
        greatest = fmax(greatest, glb_key_error_mm(face, frame, shape));
    }
    free(shape);
    return greatest;
}

static void named_targets_carry_what_is_straight(void **state)
{
    (void)state;
    clip *c = performed(0.0);
    gltf_report report = write_clip(c, (gltf_options){0});
    assert_true(report.remainder_mm < 1e-3);
    assert_int_equal(report.component_count, 0);
    glb g = glb_open(path);
    glb_face face = glb_read_face(&g);
    assert_int_equal(face.target_count, 8);
    assert_true(greatest_error_mm(c, &face) < 1e-3);
    size_t open = glb_target_index(&g, "jaw.open"), left = glb_target_index(&g, "jaw.lateral +"),
           right = glb_target_index(&g, "jaw.lateral -"),
           out = glb_target_index(&g, "corner.l out"), in = glb_target_index(&g, "corner.l in");
    (void)glb_target_index(&g, "corner.l up");
    (void)glb_target_index(&g, "chin right");
    for (size_t frame = 0; frame < FRAMES; ++frame) {
        const float *weight = face.weight + frame * face.target_count;
        double to = aside((int)frame), pulled_mm = 6.0 * sin(0.5 * (double)frame);
        assert_true(fabs((double)weight[open] - opened((int)frame) / 0.5) < 1e-6);
        assert_true(fabs((double)weight[left] - fmax(to, 0.0) / 8.0) < 1e-6);
        assert_true(fabs((double)weight[right] - fmax(-to, 0.0) / 4.0) < 1e-6);
        assert_true(fabs((double)(weight[out] - weight[in]) - pulled_mm / 31.25) < 1e-6);
    }
    glb_face_finish(&face);
    glb_close(&g);
    clip_destroy(c);
}

static void what_is_not_is_a_small_remainder_that_is_told(void **state)
{
    (void)state;
    clip *c = performed(4.0);
    gltf_report report = write_clip(c, (gltf_options){0});
    assert_true(report.remainder_mm > 3.0 && report.remainder_mm < 4.01);
    assert_true(report.mean_remainder_mm > 0.5 && report.mean_remainder_mm < 3.0);
    assert_float_equal(report.tolerance_mm, 0.02, 1e-6); /* 0.01 % of 200 mm */
    assert_true(report.max_error_mm <= report.tolerance_mm);
    assert_true(report.component_count > 0 && report.component_count < 4);
    glb g = glb_open(path);
    glb_face face = glb_read_face(&g);
    assert_true(greatest_error_mm(c, &face) <= report.tolerance_mm + 1e-4);
    (void)glb_target_index(&g, "remainder 1");
    glb_face_finish(&face);
    glb_close(&g);
    clip_destroy(c);
}

/* Clay is all remainder, and as exact as ever: no finer. */
static void clay_is_a_remainder_within_the_usual_tolerance(void **state)
{
    (void)state;
    error err;
    const double still[CURVES] = {0.0, NAN, 0.0};
    clip *clay = scene_clay(&sheet, FRAMES, FRAMES / 2);
    clip *c = clip_create(&sheet, 30.0, NULL, &err);
    float *shape = malloc((size_t)sheet.vertex_count * 3 * sizeof *shape);
    add_curves(c);
    for (uint32_t frame = 0; frame < FRAMES; ++frame) {
        assert_int_equal(clip_read(clay, frame, shape, &err), MRT_OK);
        assert_int_equal(clip_add_free(c, shape, &err), MRT_OK);
        assert_int_equal(clip_add_named(c, still, NULL, &err), MRT_OK);
    }
    gltf_report report = write_clip(c, (gltf_options){0});
    assert_float_equal(report.tolerance_mm, 0.2, 1e-6);
    assert_int_equal(report.exact_target_count, 0);
    glb g = glb_open(path);
    glb_face face = glb_read_face(&g);
    assert_true(greatest_error_mm(c, &face) <= 0.2);
    glb_face_finish(&face);
    glb_close(&g);
    clip_destroy(clay);
    clip_destroy(c);
    free(shape);
}

static void a_curve_has_limits_around_rest(void **state)
{
    (void)state;
    error err = {""};
    char name[] = "jaw.open", unit[] = "rad";
    clip *c = clip_create(&sheet, 30.0, NULL, &err);
    clip_curve curve = {name, unit, 0.1, 0.5, NULL, sheet.position, false};
    assert_int_equal(clip_add_curve(c, &curve, &err), MRT_ERR_ARGUMENT);
    assert_non_null(strstr(err.text, "jaw.open"));
    curve = (clip_curve){name, unit, 0.0, 0.0, NULL, sheet.position, false};
    assert_int_equal(clip_add_curve(c, &curve, &err), MRT_ERR_ARGUMENT);
    assert_int_equal(clip_curve_count(c), 0);
    clip_destroy(c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(named_targets_carry_what_is_straight),
        cmocka_unit_test(what_is_not_is_a_small_remainder_that_is_told),
        cmocka_unit_test(clay_is_a_remainder_within_the_usual_tolerance),
        cmocka_unit_test(a_curve_has_limits_around_rest)};
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
