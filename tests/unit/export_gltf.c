#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "export_gltf_reader.h"
#include "export_scene.h"

static char folder[256], path[300];

/* What is exported exactly is so to float32's rounding. */
static const double EXACT_MM = 0.001;
/* The test sums in float64, the writer measures in float32: they differ by rounding. */
static const double ROUNDING_MM = 1e-4;

static int set_up(void **state)
{
    (void)state;
    scene_folder(folder, sizeof folder);
    scene_path(path, sizeof path, folder, "face.glb");
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    (void)unlink(path);
    return rmdir(folder); /* fails when the writer left anything else behind */
}

static gltf_report write_clip(const clip *c, gltf_options options)
{
    error err = {""};
    gltf_report report;
    if (gltf_write(path, c, &options, NULL, &report, &err) != MRT_OK)
        fail_msg("%s", err.text);
    struct stat status;
    assert_int_equal(stat(path, &status), 0);
    assert_int_equal(report.byte_count, status.st_size);
    return report;
}

/* Reads the file back and returns the greatest error of its frames in mm, of exact or free ones. */
static double greatest_error_mm(const clip *c, const glb_face *face, int wanted_free)
{
    error err;
    double greatest = 0.0;
    float *shape = malloc(face->vertex_count * 3 * sizeof *shape);
    assert_non_null(shape);
    assert_int_equal(face->key_count, clip_frame_count(c));
    for (uint32_t frame = 0; frame < clip_frame_count(c); ++frame) {
        assert_true(face->time_s[frame] == (float)((double)frame / clip_fps(c)));
        if ((clip_frame_segment(c, frame) < 0) != wanted_free)
            continue;
        assert_int_equal(clip_read(c, frame, shape, &err), MRT_OK);
        greatest = fmax(greatest, glb_key_error_mm(face, frame, shape));
    }
    free(shape);
    return greatest;
}

static void anchored_frames_are_exact(void **state)
{
    (void)state;
    error err;
    mesh m = scene_sheet(24);
    clip *c = clip_create(&m, 60.0, NULL, &err);
    scene_begin_segment(c, m.position, &err);
    scene_add_anchored(c, 50, 0.4);
    gltf_report report = write_clip(c, (gltf_options){0});
    assert_int_equal(report.target_count, 2 * SCENE_CONTROLS * 3); /* each axis goes both ways */
    assert_int_equal(report.exact_target_count, 2 * SCENE_CONTROLS * 3);
    assert_int_equal(report.component_count, 0);
    assert_true(report.max_error_mm == 0.0);
    glb g = glb_open(path);
    glb_face face = glb_read_face(&g);
    assert_int_equal(face.primitive_count, 2);
    assert_true(greatest_error_mm(c, &face, 0) <= EXACT_MM);
    /* The weights are the displacements in metres over a power of two, one way or the other. */
    size_t plus = glb_target_index(&g, "s1.control2.y+");
    size_t minus = glb_target_index(&g, "s1.control2.y-");
    float displacement_m = (float)(clip_vector(c, 7)[4] * 0.001);
    float along =
        face.weight[7 * face.target_count + plus] - face.weight[7 * face.target_count + minus];
    int exponent, other;
    assert_true(frexpf(along, &other) == frexpf(displacement_m, &exponent) && along != 0.0f);
    glb_face_finish(&face);
    glb_close(&g);
    clip_destroy(c);
    mesh_destroy(&m);
}

static void committed_segments_show_their_own_shapes(void **state)
{
    (void)state;
    error err;
    mesh m = scene_sheet(20);
    float *base = malloc((size_t)m.vertex_count * 3 * sizeof *base);
    clip *c = clip_create(&m, 25.0, NULL, &err);
    scene_begin_segment(c, m.position, &err);
    scene_begin_segment(c, m.position, &err); /* engaged anew before any frame */
    scene_add_anchored(c, 9, 0.0);
    for (int commit = 0; commit < 3; ++commit) {
        assert_int_equal(clip_read(c, clip_frame_count(c) - 1, base, &err), MRT_OK);
        scene_begin_segment(c, base, &err);
        scene_add_anchored(c, 7, commit + 1.0);
    }
    gltf_report report = write_clip(c, (gltf_options){0});
    assert_in_range(report.target_count, 4 * SCENE_CONTROLS * 3 + 3,
                    2 * 4 * SCENE_CONTROLS * 3 + 3);
    glb g = glb_open(path);
    glb_face face = glb_read_face(&g);
    assert_true(greatest_error_mm(c, &face, 0) <= EXACT_MM);
    size_t third = glb_target_index(&g, "s3.base");
    assert_true(face.weight[8 * face.target_count + third] == 0.0f);
    assert_true(face.weight[9 * face.target_count + third] == 1.0f);
    assert_true(face.weight[16 * face.target_count + third] == 0.0f);
    glb_face_finish(&face);
    glb_close(&g);
    clip_destroy(c);
    mesh_destroy(&m);
    free(base);
}

static void free_frames_hold_the_default_tolerance(void **state)
{
    (void)state;
    error err;
    mesh m = scene_sheet(24);
    clip *c = clip_create(&m, 60.0, NULL, &err);
    scene_add_free(c, 500, 0.0, 3);
    gltf_report report = write_clip(c, (gltf_options){0});
    assert_float_equal(report.tolerance_mm, 0.2, 1e-6); /* 0.1 % of 200 mm */
    assert_true(report.component_count > 3 && report.component_count < 100);
    assert_int_equal(report.exact_target_count, 0);
    glb g = glb_open(path);
    glb_face face = glb_read_face(&g);
    double error_mm = greatest_error_mm(c, &face, 1);
    assert_true(error_mm <= report.tolerance_mm);
    assert_float_equal(error_mm, report.max_error_mm, ROUNDING_MM);
    glb_face_finish(&face);
    glb_close(&g);
    clip_destroy(c);
    mesh_destroy(&m);
}

static void one_component_less_misses_the_tolerance(void **state)
{
    (void)state;
    error err;
    mesh m = scene_sheet(16);
    clip *c = clip_create(&m, 60.0, NULL, &err);
    scene_add_free(c, 300, 2.0, 2);
    gltf_report enough = write_clip(c, (gltf_options){.tolerance_mm = 0.5});
    assert_true(enough.max_error_mm <= 0.5);
    gltf_report fewer = write_clip(
        c, (gltf_options){.tolerance_mm = 0.5, .max_targets = enough.component_count - 1});
    assert_int_equal(fewer.component_count, enough.component_count - 1);
    assert_true(fewer.max_error_mm > 0.5);
    clip_destroy(c);
    mesh_destroy(&m);
}

static void a_cap_on_targets_reports_the_true_error(void **state)
{
    (void)state;
    error err;
    mesh m = scene_sheet(16);
    clip *c = clip_create(&m, 60.0, NULL, &err);
    scene_add_free(c, 200, 0.0, 4);
    gltf_report report = write_clip(c, (gltf_options){.tolerance_mm = 0.01, .max_targets = 8});
    assert_int_equal(report.component_count, 8);
    assert_true(report.max_error_mm > report.tolerance_mm);
    glb g = glb_open(path);
    glb_face face = glb_read_face(&g);
    assert_float_equal(greatest_error_mm(c, &face, 1), report.max_error_mm, ROUNDING_MM);
    glb_face_finish(&face);
    glb_close(&g);
    clip_destroy(c);
    mesh_destroy(&m);
}

/* One frame of 900 that is like no other, between the frames that are looked at. */
static void a_single_odd_frame_holds_the_tolerance_too(void **state)
{
    (void)state;
    error err;
    mesh m = scene_sheet(16);
    clip *c = clip_create(&m, 60.0, NULL, &err);
    scene_add_free(c, 430, 0.0, 1);
    float *odd = malloc((size_t)m.vertex_count * 3 * sizeof *odd);
    memcpy(odd, m.position, (size_t)m.vertex_count * 3 * sizeof *odd);
    odd[5 * 3 + 1] += 30.0f;
    odd[(size_t)m.vertex_count * 3 - 1] -= 31.0f;
    assert_int_equal(clip_add_free(c, odd, &err), MRT_OK);
    scene_add_free(c, 469, 7.0, 1);
    gltf_report report = write_clip(c, (gltf_options){0});
    glb g = glb_open(path);
    glb_face face = glb_read_face(&g);
    assert_true(greatest_error_mm(c, &face, 1) <= report.tolerance_mm);
    glb_face_finish(&face);
    glb_close(&g);
    clip_destroy(c);
    mesh_destroy(&m);
    free(odd);
}

static void mixed_frames_keep_both_promises(void **state)
{
    (void)state;
    error err;
    mesh m = scene_sheet(20);
    float *base = malloc((size_t)m.vertex_count * 3 * sizeof *base);
    clip *c = clip_create(&m, 30.0, NULL, &err);
    scene_begin_segment(c, m.position, &err);
    scene_add_anchored(c, 20, 0.2);
    scene_add_free(c, 61, 1.0, 3);
    assert_int_equal(clip_read(c, clip_frame_count(c) - 1, base, &err), MRT_OK);
    scene_begin_segment(c, base, &err);
    scene_add_anchored(c, 15, 0.9);
    scene_add_free(c, 1, 9.0, 3);
    scene_add_anchored(c, 3, 2.9);
    gltf_report report = write_clip(c, (gltf_options){.tolerance_mm = 0.1});
    glb g = glb_open(path);
    glb_face face = glb_read_face(&g);
    assert_int_equal(report.target_count, report.exact_target_count + report.component_count);
    assert_true(greatest_error_mm(c, &face, 0) <= EXACT_MM);
    double error_mm = greatest_error_mm(c, &face, 1);
    assert_true(error_mm <= 0.1);
    assert_float_equal(error_mm, report.max_error_mm, ROUNDING_MM);
    glb_face_finish(&face);
    glb_close(&g);
    clip_destroy(c);
    mesh_destroy(&m);
    free(base);
}

static void narrow_targets_are_sparse(void **state)
{
    (void)state;
    error err;
    mesh m = scene_sheet(40);
    clip *c = clip_create(&m, 60.0, NULL, &err);
    scene_begin_segment(c, m.position, &err);
    scene_add_anchored(c, 2, 1.0);
    gltf_report report = write_clip(c, (gltf_options){0});
    /* 9 targets with normals would be 345 600 bytes if all were written out. */
    assert_true(report.byte_count < 250000);
    clip_destroy(c);
    mesh_destroy(&m);
}

static void a_clip_at_rest_is_a_plain_mesh(void **state)
{
    (void)state;
    error err;
    mesh m = scene_sheet(8);
    clip *c = clip_create(&m, 60.0, NULL, &err);
    gltf_report report = write_clip(c, (gltf_options){0});
    assert_int_equal(report.target_count, 0);
    assert_int_equal(clip_add_free(c, m.position, &err), MRT_OK);
    report = write_clip(c, (gltf_options){0});
    assert_int_equal(report.target_count, 0);
    glb g = glb_open(path);
    assert_null(json_object_get(g.root, "animations"));
    glb_close(&g);
    clip_destroy(c);
    mesh_destroy(&m);
}

static void the_same_clip_gives_the_same_bytes(void **state)
{
    (void)state;
    error err;
    mesh m = scene_sheet(16);
    unsigned char *first = NULL;
    size_t first_size = 0;
    for (int i = 0; i < 2; ++i) {
        clip *c = clip_create(&m, 60.0, NULL, &err);
        scene_begin_segment(c, m.position, &err);
        scene_add_anchored(c, 5, 0.0);
        scene_add_free(c, 90, 0.0, 3);
        (void)write_clip(c, (gltf_options){0});
        glb g = glb_open(path);
        if (i == 0) {
            first = g.file;
            first_size = g.size;
            json_decref(g.root);
        } else {
            assert_int_equal(g.size, first_size);
            assert_memory_equal(g.file, first, first_size);
            glb_close(&g);
        }
        clip_destroy(c);
    }
    free(first);
    mesh_destroy(&m);
}

static const char *text_at(const json_t *object, const char *key)
{
    const char *text = json_string_value(json_object_get(object, key));
    return text ? text : "(none)";
}

static void a_mesh_keeps_its_parts_materials_attributes_and_targets(void **state)
{
    (void)state;
    error err = {""};
    mesh m = scene_sheet(6);
    m.attribute = calloc(2, sizeof *m.attribute);
    m.attribute_count = 2;
    for (uint32_t i = 0; i < 2; ++i) {
        scene_name(&m.attribute[i].name, i ? "_UV2" : "_SKULL");
        m.attribute[i].component_count = i + 1;
        m.attribute[i].value = calloc((size_t)m.vertex_count * (i + 1), sizeof(float));
        m.attribute[i].value[7] = 0.75f;
    }
    m.target = calloc(1, sizeof *m.target);
    m.target_count = 1;
    scene_name(&m.target[0].name, "sm\xC3\xAFle \xFF");
    m.target[0].offset = calloc((size_t)m.vertex_count * 3, sizeof(float));
    m.target[0].offset[4] = 12.5f;
    m.material[0].base_colour[0] = 0.25f;
    if (gltf_write_mesh(path, &m, &err) != MRT_OK)
        fail_msg("%s", err.text);
    glb g = glb_open(path);
    glb_face face = glb_read_face(&g);
    assert_int_equal(face.vertex_count, m.vertex_count);
    for (size_t i = 0; i < (size_t)m.vertex_count * 3; ++i)
        assert_true(fabs((double)face.position[i] * 1000.0 - (double)m.position[i]) < 1e-4);
    assert_true(face.target[0][4] == 0.0125f);
    (void)glb_target_index(&g, "sm\xC3\xAFle ?");
    const json_t *brow = glb_primitive(&g, 0), *mouth = glb_primitive(&g, 1);
    assert_string_equal(text_at(json_object_get(brow, "extras"), "name"), "brow");
    assert_string_equal(text_at(json_object_get(mouth, "extras"), "name"), "mouth");
    const json_t *index =
        glb_at(json_object_get(g.root, "accessors"), glb_number(mouth, "indices", 1u << 30));
    assert_int_equal(glb_number(index, "count", 0), m.part[1].triangle_count * 3);
    const unsigned char *at =
        glb_view(&g, glb_number(index, "bufferView", 0), glb_number(index, "byteOffset", 0),
                 (size_t)m.part[1].triangle_count * 12);
    for (size_t i = 0; i < (size_t)m.part[1].triangle_count * 3; ++i)
        assert_int_equal(glb_u32(at + i * 4), m.triangle[(size_t)m.part[1].first_triangle * 3 + i]);
    size_t count;
    const json_t *attributes = json_object_get(brow, "attributes");
    float *uv = glb_floats(&g, glb_number(attributes, "_UV2", 1u << 30), &count, 2);
    assert_true(count == m.vertex_count && uv[7] == 0.75f);
    free(uv);
    const json_t *material = glb_at(json_object_get(g.root, "materials"), 0);
    assert_string_equal(text_at(material, "name"), "skin");
    const json_t *asset = json_object_get(g.root, "asset");
    assert_string_equal(text_at(asset, "generator"), "marotte 0.1.0"); /* in every version */
    assert_string_equal(text_at(asset, "copyright"), "(none)");
    glb_face_finish(&face);
    glb_close(&g);
    mesh_destroy(&m);
}

static void shapes_that_are_not_finite_are_refused(void **state)
{
    (void)state;
    error err = {""};
    mesh m = scene_sheet(6);
    (void)unlink(path);
    clip *c = clip_create(&m, 60.0, NULL, &err);
    scene_begin_segment(c, m.position, &err);
    double displacement[SCENE_CONTROLS * 3] = {1e300};
    assert_int_equal(clip_add_anchored(c, displacement, &err), MRT_OK);
    assert_int_equal(gltf_write(path, c, NULL, NULL, NULL, &err), MRT_ERR_ARGUMENT);
    assert_non_null(strstr(err.text, "not finite"));
    assert_memory_equal(err.text, path, strlen(path));
    clip_destroy(c);
    m.position[10] = NAN;
    assert_int_equal(gltf_write_mesh(path, &m, &err), MRT_ERR_FORMAT);
    assert_int_equal(access(path, F_OK), -1);
    gltf_options options = {.tolerance_mm = -1.0};
    c = clip_create(&m, 60.0, NULL, &err);
    assert_int_equal(gltf_write(path, c, &options, NULL, NULL, &err), MRT_ERR_ARGUMENT);
    clip_destroy(c);
    mesh_destroy(&m);
}

static void shapes_beyond_float32_squares_are_refused(void **state)
{
    (void)state;
    error err = {""};
    mesh m = scene_sheet(6);
    float *shape = calloc((size_t)m.vertex_count * 3, sizeof *shape);
    clip *c = clip_create(&m, 60.0, NULL, &err);
    shape[9] = 3e38f;
    assert_int_equal(clip_add_free(c, shape, &err), MRT_OK);
    assert_int_equal(gltf_write(path, c, NULL, NULL, NULL, &err), MRT_ERR_UNSUPPORTED);
    assert_non_null(strstr(err.text, "frame 0: vertex 3"));
    clip_destroy(c);
    mesh_destroy(&m);
    free(shape);
}

static void remember(void *data, double done)
{
    double *last = data;
    assert_true(done >= *last && done <= 1.0);
    *last = done;
}

static void progress_rises_to_one(void **state)
{
    (void)state;
    error err;
    mesh m = scene_sheet(10);
    clip *c = clip_create(&m, 60.0, NULL, &err);
    scene_add_free(c, 100, 0.0, 2);
    double last = 0.0;
    export_progress progress = {remember, &last};
    assert_int_equal(gltf_write(path, c, NULL, &progress, NULL, &err), MRT_OK);
    assert_true(last == 1.0);
    clip_destroy(c);
    mesh_destroy(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(anchored_frames_are_exact),
        cmocka_unit_test(committed_segments_show_their_own_shapes),
        cmocka_unit_test(free_frames_hold_the_default_tolerance),
        cmocka_unit_test(one_component_less_misses_the_tolerance),
        cmocka_unit_test(a_cap_on_targets_reports_the_true_error),
        cmocka_unit_test(a_single_odd_frame_holds_the_tolerance_too),
        cmocka_unit_test(mixed_frames_keep_both_promises),
        cmocka_unit_test(narrow_targets_are_sparse),
        cmocka_unit_test(a_clip_at_rest_is_a_plain_mesh),
        cmocka_unit_test(the_same_clip_gives_the_same_bytes),
        cmocka_unit_test(a_mesh_keeps_its_parts_materials_attributes_and_targets),
        cmocka_unit_test(shapes_that_are_not_finite_are_refused),
        cmocka_unit_test(shapes_beyond_float32_squares_are_refused),
        cmocka_unit_test(progress_rises_to_one)};
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
