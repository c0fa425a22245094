#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "export_scene.h"

#include <dirent.h>
#include <signal.h>
#include <sys/resource.h>

static void anchored_frames_are_base_plus_responses_in_order(void **state)
{
    (void)state;
    error err;
    mesh m;
    assert_int_equal(mesh_create(&m, 2, 0, &err), MRT_OK);
    clip *c = clip_create(&m, 60.0, NULL, &err);
    const float base[6] = {1.0f, 2.0f, 3.0f, 4.0f, 5.0f, 6.0f};
    const float response[4] = {0.1f, 0.7f, 0.3f, 0.9f}; /* 2 controls by 2 vertices */
    const double displacement[6] = {1.1, -2.2, 3.3, 0.7, 0.77, 1e-3};
    assert_int_equal(clip_begin_segment(c, base, response, NULL, 2, &err), MRT_OK);
    assert_int_equal(clip_add_anchored(c, displacement, &err), MRT_OK);
    float shape[6];
    assert_int_equal(clip_read(c, 0, shape, &err), MRT_OK);
    for (size_t i = 0; i < 6; ++i) {
        volatile float wanted = base[i]; /* each step rounded to float32 */
        for (size_t k = 0; k < 2; ++k) {
            volatile float step = response[k * 2 + i / 3] * (float)displacement[k * 3 + i % 3];
            wanted = wanted + step;
        }
        assert_true(shape[i] == wanted);
    }
    clip_destroy(c);
    mesh_destroy(&m);
}

static void frames_come_back_as_they_were_added(void **state)
{
    (void)state;
    error err;
    mesh m = scene_sheet(5);
    clip *c = clip_create(&m, 24.0, NULL, &err);
    size_t bytes = (size_t)m.vertex_count * 3 * sizeof(float);
    float *wanted = malloc(bytes), *shape = malloc(bytes);
    scene_begin_segment(c, m.position, &err);
    scene_add_free(c, 3, 0.0, 2);
    scene_add_anchored(c, 2, 0.5);
    scene_begin_segment(c, m.position, &err);
    scene_add_free(c, 200, 5.0, 2);
    scene_add_anchored(c, 100, 0.5);
    assert_int_equal(clip_frame_count(c), 305);
    assert_int_equal(clip_segment_count(c), 2);
    assert_int_equal(clip_segment_at(c, 0)->frame_count, 2);
    assert_int_equal(clip_segment_at(c, 1)->frame_count, 100);
    assert_int_equal(clip_frame_segment(c, 2), -1);
    assert_int_equal(clip_frame_segment(c, 4), 0);
    assert_int_equal(clip_frame_segment(c, 205), 1);
    assert_true(clip_mesh(c) == &m);
    assert_true(clip_fps(c) == 24.0);
    for (uint32_t i = 0; i < 200; i += 50) {
        uint32_t count;
        double time = 5.0 + i / 60.0;
        scene_free_shape(wanted, &m, time, 2);
        assert_int_equal(clip_read(c, 5 + i, shape, &err), MRT_OK);
        assert_memory_equal(shape, wanted, bytes);
        const double *control = clip_controls(c, 5 + i, &count);
        assert_int_equal(count, 2);
        assert_true(control[0] == time && control[3] == -time && control[5] == 1e-3);
    }
    uint32_t none;
    (void)clip_controls(c, 4, &none);
    assert_int_equal(none, SCENE_CONTROLS);
    assert_null(clip_vector(c, 0));
    assert_true(clip_vector(c, 205)[1] == 12.0 * sin(0.5));
    clip_destroy(c);
    mesh_destroy(&m);
    free(wanted);
    free(shape);
}

static void values_that_make_no_sense_are_refused(void **state)
{
    (void)state;
    error err;
    mesh m = scene_sheet(4);
    assert_null(clip_create(&m, 0.0, NULL, &err));
    assert_null(clip_create(&m, (double)NAN, NULL, &err));
    assert_null(clip_create(&m, -5.0, NULL, &err));
    clip *c = clip_create(&m, 60.0, NULL, &err);
    const double displacement[SCENE_CONTROLS * 3] = {0.0, (double)INFINITY};
    assert_int_equal(clip_add_anchored(c, displacement, &err), MRT_ERR_ARGUMENT);
    scene_begin_segment(c, m.position, &err);
    assert_int_equal(clip_add_anchored(c, displacement, &err), MRT_ERR_ARGUMENT);
    assert_non_null(strstr(err.text, "column 1"));
    float *shape = calloc((size_t)m.vertex_count * 3, sizeof *shape);
    shape[7] = NAN;
    assert_int_equal(clip_add_free(c, shape, &err), MRT_ERR_ARGUMENT);
    assert_non_null(strstr(err.text, "vertex 2"));
    assert_int_equal(clip_begin_segment(c, shape, shape, NULL, 0, &err), MRT_ERR_ARGUMENT);
    assert_int_equal(clip_frame_count(c), 0);
    clip_destroy(c);
    clip_destroy(NULL);
    mesh_destroy(&m);
    free(shape);
}

static size_t entry_count(const char *folder)
{
    DIR *directory = opendir(folder);
    assert_non_null(directory);
    size_t count = 0;
    while (readdir(directory))
        ++count;
    (void)closedir(directory);
    return count;
}

static void the_temporary_file_has_no_name(void **state)
{
    (void)state;
    error err;
    char folder[256];
    scene_folder(folder, sizeof folder);
    mesh m = scene_sheet(4);
    clip *c = clip_create(&m, 60.0, folder, &err);
    scene_add_free(c, 2, 0.0, 1);
    assert_int_equal(entry_count(folder), 2); /* . and .. */
    clip_destroy(c);
    assert_int_equal(rmdir(folder), 0);
    mesh_destroy(&m);
}

static void a_folder_that_is_not_there_is_named(void **state)
{
    (void)state;
    error err = {""};
    mesh m = scene_sheet(4);
    clip *c = clip_create(&m, 60.0, "/no/such/folder", &err);
    assert_non_null(c);
    assert_int_equal(clip_add_free(c, m.position, &err), MRT_ERR_IO);
    assert_non_null(strstr(err.text, "/no/such/folder"));
    assert_int_equal(clip_frame_count(c), 0);
    clip_destroy(c);
    mesh_destroy(&m);
}

/* A limit on the size of files stands for a full disk. */
static void a_full_disk_is_reported_and_the_frames_before_stay(void **state)
{
    (void)state;
    error err = {""};
    struct rlimit kept, small;
    mesh m = scene_sheet(16);
    clip *c = clip_create(&m, 60.0, NULL, &err);
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &kept), 0);
    small = (struct rlimit){.rlim_cur = 10000, .rlim_max = kept.rlim_max};
    (void)signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
    mrt_result results[5];
    for (int i = 0; i < 5; ++i) /* 3072 bytes each */
        results[i] = clip_add_free(c, m.position, &err);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &kept), 0);
    assert_int_equal(results[2], MRT_OK);
    assert_int_equal(results[3], MRT_ERR_IO);
    assert_int_equal(results[4], MRT_ERR_IO);
    assert_non_null(strstr(err.text, "TMPDIR"));
    assert_int_equal(clip_frame_count(c), 3);
    float *shape = malloc((size_t)m.vertex_count * 3 * sizeof *shape);
    assert_int_equal(clip_read(c, 2, shape, &err), MRT_OK);
    assert_memory_equal(shape, m.position, (size_t)m.vertex_count * 3 * sizeof *shape);
    assert_int_equal(clip_add_free(c, m.position, &err), MRT_OK);
    assert_int_equal(clip_read(c, 3, shape, &err), MRT_OK);
    clip_destroy(c);
    mesh_destroy(&m);
    free(shape);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(anchored_frames_are_base_plus_responses_in_order),
        cmocka_unit_test(frames_come_back_as_they_were_added),
        cmocka_unit_test(values_that_make_no_sense_are_refused),
        cmocka_unit_test(the_temporary_file_has_no_name),
        cmocka_unit_test(a_folder_that_is_not_there_is_named),
        cmocka_unit_test(a_full_disk_is_reported_and_the_frames_before_stay)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
