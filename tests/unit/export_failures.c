#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "export_scene.h"
#include "io/curves.h"

#include <dirent.h>
#include <errno.h>
#include <signal.h>
#include <sys/resource.h>

/* Every exporter behind one signature; the clip is the same for all. */
typedef mrt_result write_function(const char *path, const clip *c, error *err);

static mrt_result write_gltf(const char *path, const clip *c, error *err)
{
    return gltf_write(path, c, NULL, NULL, NULL, err);
}

static mrt_result write_gltf_mesh(const char *path, const clip *c, error *err)
{
    return gltf_write_mesh(path, clip_mesh(c), err);
}

static mrt_result write_pc2(const char *path, const clip *c, error *err)
{
    return pc2_write(path, c, NULL, NULL, err);
}

static mrt_result write_mdd(const char *path, const clip *c, error *err)
{
    return mdd_write(path, c, NULL, NULL, err);
}

static mrt_result write_csv(const char *path, const clip *c, error *err)
{
    return csv_write(path, c, NULL, err);
}

static mrt_result write_png(const char *path, const clip *c, error *err)
{
    (void)c;
    enum { SIDE = 64 };
    static uint8_t rgba[SIDE * SIDE * 4];
    uint32_t noise = 1;
    for (size_t i = 0; i < sizeof rgba; ++i) {
        noise = noise * 1664525u + 1013904223u;
        rgba[i] = (uint8_t)(noise >> 24);
    }
    return png_write(path, rgba, SIDE, SIDE, err);
}

static write_function *const WRITERS[] = {write_gltf, write_gltf_mesh, write_pc2,
                                          write_mdd,  write_csv,       write_png};
enum { WRITER_COUNT = sizeof WRITERS / sizeof *WRITERS };

static char folder[256];
static mesh sheet;
static clip *performance;

static int set_up(void **state)
{
    (void)state;
    error err;
    scene_folder(folder, sizeof folder);
    sheet = scene_sheet(24);
    performance = clip_create(&sheet, 60.0, NULL, &err);
    scene_begin_segment(performance, sheet.position, &err);
    scene_add_anchored(performance, 150, 0.1);
    scene_add_free(performance, 20, 1.0, 2);
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    clip_destroy(performance);
    mesh_destroy(&sheet);
    return rmdir(folder);
}

static void expect_empty_folder(void)
{
    DIR *directory = opendir(folder);
    assert_non_null(directory);
    for (struct dirent *entry; (entry = readdir(directory)) != NULL;)
        if (entry->d_name[0] != '.')
            fail_msg("%s was left behind", entry->d_name);
    (void)closedir(directory);
}

static void a_folder_instead_of_a_file_is_refused(void **state)
{
    (void)state;
    for (size_t i = 0; i < WRITER_COUNT; ++i) {
        error err = {""};
        assert_int_equal(WRITERS[i](folder, performance, &err), MRT_ERR_IO);
        assert_non_null(strstr(err.text, folder));
        assert_non_null(strstr(err.text, "directory"));
    }
    expect_empty_folder();
}

static void a_file_in_the_place_of_a_folder_is_named(void **state)
{
    (void)state;
    char path[300], below[320];
    scene_path(path, sizeof path, folder, "file");
    (void)snprintf(below, sizeof below, "%s/below", path);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    (void)fclose(file);
    for (size_t i = 0; i < WRITER_COUNT; ++i) {
        error err = {""};
        assert_int_equal(WRITERS[i](below, performance, &err), MRT_ERR_IO);
        assert_non_null(strstr(err.text, path));
    }
    assert_int_equal(unlink(path), 0);
    expect_empty_folder();
}

static void a_read_only_folder_is_named(void **state)
{
    (void)state;
    char path[300];
    if (geteuid() == 0) {
        print_message("SKIPPED: root may write anywhere\n");
        skip();
    }
    scene_path(path, sizeof path, folder, "file");
    assert_int_equal(chmod(folder, 0555), 0);
    for (size_t i = 0; i < WRITER_COUNT; ++i) {
        error err = {""};
        mrt_result result = WRITERS[i](path, performance, &err);
        if (result != MRT_ERR_IO || !strstr(err.text, path)) {
            (void)chmod(folder, 0755);
            fail_msg("writer %zu: %d %s", i, result, err.text);
        }
    }
    assert_int_equal(chmod(folder, 0755), 0);
    expect_empty_folder();
}

/* A limit on the size of files stands for a full disk. At 6 000 bytes every writer fails on the
 * way, at 0 even the first byte does. */
static void a_full_disk_leaves_nothing_behind(void **state)
{
    (void)state;
    char path[300];
    struct rlimit kept;
    scene_path(path, sizeof path, folder, "file");
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &kept), 0);
    (void)signal(SIGXFSZ, SIG_IGN);
    static const rlim_t limits[] = {0, 6000};
    for (size_t i = 0; i < WRITER_COUNT * 2; ++i) {
        error err = {""};
        struct rlimit small = {.rlim_cur = limits[i % 2], .rlim_max = kept.rlim_max};
        assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
        mrt_result result = WRITERS[i / 2](path, performance, &err);
        assert_int_equal(setrlimit(RLIMIT_FSIZE, &kept), 0);
        if (result != MRT_ERR_IO || !strstr(err.text, path) || !strstr(err.text, strerror(EFBIG)))
            fail_msg("writer %zu: %d %s", i / 2, result, err.text);
        expect_empty_folder();
    }
}

static void a_failed_export_keeps_the_file_before(void **state)
{
    (void)state;
    char path[300];
    scene_path(path, sizeof path, folder, "file");
    struct rlimit kept;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &kept), 0);
    (void)signal(SIGXFSZ, SIG_IGN);
    for (size_t i = 0; i < WRITER_COUNT; ++i) {
        error err = {""};
        struct stat before, after;
        assert_int_equal(WRITERS[i](path, performance, &err), MRT_OK);
        assert_int_equal(stat(path, &before), 0);
        struct rlimit small = {.rlim_cur = 6000, .rlim_max = kept.rlim_max};
        assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
        mrt_result result = WRITERS[i](path, performance, &err);
        assert_int_equal(setrlimit(RLIMIT_FSIZE, &kept), 0);
        assert_int_equal(result, MRT_ERR_IO);
        assert_int_equal(stat(path, &after), 0);
        assert_true(before.st_ino == after.st_ino && before.st_size == after.st_size);
        assert_int_equal(unlink(path), 0);
    }
    expect_empty_folder();
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_folder_instead_of_a_file_is_refused),
                                       cmocka_unit_test(a_file_in_the_place_of_a_folder_is_named),
                                       cmocka_unit_test(a_read_only_folder_is_named),
                                       cmocka_unit_test(a_full_disk_leaves_nothing_behind),
                                       cmocka_unit_test(a_failed_export_keeps_the_file_before)};
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
