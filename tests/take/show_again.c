/* Tracks performed anew: what a show keeps of it. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "show_scene.h"
#include "show/hash.h"

static int make(void **state)
{
    scene *s = calloc(1, sizeof *s);
    scene_make(s);
    *state = s;
    return 0;
}

static int clean(void **state)
{
    scene_remove(*state);
    free(*state);
    return 0;
}

/* A show with one performance of 40 samples. */
static int64_t record(const scene *s)
{
    error err = {""};
    show *of;
    scene_recording r;
    writer_options options = scene_options();
    scene_must(show_create(&of, s->path, &err), &err);
    scene_record(&r, of, &options);
    scene_give(&r, 0, 40);
    scene_stop(&r);
    show_close(of);
    return r.performance;
}

static show *reopen(const scene *s, show_mode mode)
{
    error err = {""};
    show *out;
    scene_must(show_open(&out, s->path, mode, &err), &err);
    return out;
}

static take_performance anew(int64_t of, int64_t track)
{
    static char calibration[] = "{\"marotte_calibration\":1,\"hand\":\"right\"}";
    take_performance out = scene_performance(track);
    out.again = (take_again){.of = of,
                             .ignores_params = true,
                             .calibration = {NULL, calibration},
                             .min_cutoff_hz = 0.8,
                             .has_beta = true,
                             .beta = 0.0};
    return out;
}

static void what_is_different_comes_back_with_the_span_of_then(void **state)
{
    const scene *s = *state;
    error err = {""};
    int64_t first = record(s);
    show *of = reopen(s, SHOW_WRITE);
    show_performance then, now;
    scene_must(show_performance_read(of, first, &then, &err), &err);
    take_performance p = anew(first, then.performance.track[0]);
    scene_must(show_performance_create(of, &p, &err), &err);
    assert_true(p.id > first);
    show_close(of);
    of = reopen(s, SHOW_READ);
    scene_must(show_performance_read(of, p.id, &now, &err), &err);
    assert_true(now.from_ns == then.from_ns && now.to_ns == then.to_ns);
    assert_true(now.to_ns > now.from_ns);
    assert_true(now.performance.again.of == first && now.performance.again.ignores_params);
    assert_null(now.performance.again.calibration[0]);
    assert_string_equal(now.performance.again.calibration[1], p.again.calibration[1]);
    assert_true(now.performance.again.min_cutoff_hz > 0.79 &&
                now.performance.again.min_cutoff_hz < 0.81);
    assert_true(now.performance.again.has_beta);
    assert_true(now.performance.track_count == 1);
    assert_true(then.performance.again.of == 0 && !then.performance.again.has_beta);
    show_performance_finish(&then);
    show_performance_finish(&now);
    show_close(of);
}

static void a_performance_that_is_not_there_cannot_be_performed_anew(void **state)
{
    const scene *s = *state;
    error err = {""};
    size_t count;
    int64_t first = record(s), *ids;
    show *of = reopen(s, SHOW_WRITE);
    take_performance p = anew(first + 7, 1);
    assert_true(show_performance_create(of, &p, &err) < 0);
    assert_non_null(strstr(err.text, "has no performance"));
    scene_must(show_performance_ids(of, &ids, &count, &err), &err);
    assert_int_equal(count, 1);
    free(ids);
    show_close(of);
}

static void a_show_that_can_only_be_read_refuses(void **state)
{
    const scene *s = *state;
    error err = {""};
    int64_t first = record(s);
    show *of = reopen(s, SHOW_READ);
    take_performance p = anew(first, 1);
    assert_int_equal(show_performance_create(of, &p, &err), MRT_ERR_UNSUPPORTED);
    show_close(of);
}

static void a_recovered_show_still_has_it(void **state)
{
    const scene *s = *state;
    error err = {""};
    char path[SCENE_PATH];
    show_recovery report;
    show_performance now;
    int64_t first = record(s);
    show *of = reopen(s, SHOW_WRITE);
    take_performance p = anew(first, 1);
    scene_must(show_performance_create(of, &p, &err), &err);
    show_close(of);
    snprintf(path, sizeof path, "%s/recovered.marotte", s->folder);
    scene_must(show_recover(&report, s->path, path, &err), &err);
    scene_must(show_open(&of, path, SHOW_READ, &err), &err);
    scene_must(show_performance_read(of, p.id, &now, &err), &err);
    assert_true(now.performance.again.of == first && now.performance.again.ignores_params);
    show_performance_finish(&now);
    show_close(of);
}

static void a_sum_of_pieces_is_that_of_the_whole(void **state)
{
    (void)state;
    char whole[TAKE_HASH], pieces[TAKE_HASH];
    hash_bytes(whole, "abcdefgh", 8);
    hash_sum *sum = hash_begin();
    assert_non_null(sum);
    hash_add(sum, "abc", 3);
    hash_add(sum, "", 0);
    hash_add(sum, "defgh", 5);
    hash_end(pieces, sum);
    assert_string_equal(pieces, whole);
    hash_end(pieces, NULL);
    assert_string_equal(pieces, "");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(what_is_different_comes_back_with_the_span_of_then, make,
                                        clean),
        cmocka_unit_test_setup_teardown(a_performance_that_is_not_there_cannot_be_performed_anew,
                                        make, clean),
        cmocka_unit_test_setup_teardown(a_show_that_can_only_be_read_refuses, make, clean),
        cmocka_unit_test_setup_teardown(a_recovered_show_still_has_it, make, clean),
        cmocka_unit_test(a_sum_of_pieces_is_that_of_the_whole),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
