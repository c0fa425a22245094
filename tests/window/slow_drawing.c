/* The performance does not depend on the picture: with drawing at five frames a second, every
 * sample of a device with 150 a second is performed and recorded, as it comes. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "base/file.h"
#include "scene.h"

enum { SAMPLES = 900, RATE_HZ = 150, FACES_A_PICTURE = 3, PATIENCE_S = 100 };
static const int64_t drawing_ns = NS_PER_S / 5;

static double angle_at(int sample)
{
    return 0.4 + 0.4 * sin((double)sample / RATE_HZ * 6.0);
}

/* A jaw that opens and closes. */
static void write_log(const char *path)
{
    error err = {""};
    file_writer table;
    assert_int_equal(file_writer_open(&table, path, &err), MRT_OK);
    fputs("time_s,right.thumb.mpj,right.index.mpj\nunit,rad,rad\n", table.stream);
    for (int i = 0; i < SAMPLES; ++i) {
        fprintf(table.stream, "%.6f,%.5f,%.5f\n", (double)i / RATE_HZ, angle_at(i),
                0.5 * angle_at(i));
    }
    assert_int_equal(file_writer_commit(&table, &err), MRT_OK);
}

static void draw_slowly(scene *s)
{
    const int64_t end_ns = clock_now_ns() + drawing_ns;
    scene_frame(s);
    clock_sleep_until_ns(end_ns);
}

static bool is_over(scene *s)
{
    live *l = app_live(s->app);
    return live_input_count(l) == 0 || input_state_of(live_input(l, 0)) == INPUT_ENDED;
}

/* What the show has of the log: all of it, in order. */
static void check_recorded(const char *path)
{
    error err = {""};
    show *recorded = NULL;
    show_reader *reader = NULL;
    int64_t *ids;
    size_t count;
    mrt_sample sample;
    int samples = 0;
    assert_int_equal(show_open(&recorded, path, SHOW_READ, &err), MRT_OK);
    assert_int_equal(show_track_ids(recorded, &ids, &count, &err), MRT_OK);
    for (size_t i = 0; i < count; ++i) {
        show_track track;
        assert_int_equal(show_track_read(recorded, ids[i], &track, &err), MRT_OK);
        if (strncmp(track.track.input, "log:", 4) == 0)
            assert_int_equal(
                show_reader_open(&reader, recorded, ids[i], track.from_ns, track.to_ns, &err),
                MRT_OK);
        show_track_finish(&track);
    }
    assert_non_null(reader);
    for (; show_reader_next(reader, &sample, &err) == MRT_OK; ++samples)
        assert_true(fabs((double)sample.value[0] - angle_at(samples)) < 1e-4);
    assert_int_equal(samples, SAMPLES);
    show_reader_close(reader);
    free(ids);
    show_close(recorded);
}

static void at_five_pictures_a_second_every_sample_is_performed(void **state)
{
    (void)state;
    scene s;
    char path[64] = "/tmp/marotte_slow_XXXXXX.csv", spec[80];
    int fd = mkstemps(path, 4);
    assert_true(fd >= 0);
    close(fd);
    write_log(path);
    (void)snprintf(spec, sizeof spec, "log:%s", path);
    const char *const inputs[] = {spec};
    const scene_options options = {.width_px = 640,
                                   .height_px = 360,
                                   .scale = 1.0f,
                                   .face = SOURCE_DIR "/rigs/moai/moai.glb",
                                   .mapping = "anchored",
                                   .inputs = inputs,
                                   .input_count = 1};
    scene_open_with(&s, &options);

    uint64_t first_face = app_view(s.app)->number, pictures = 0;
    const int64_t end_ns = clock_now_ns() + PATIENCE_S * NS_PER_S;
    live_status status;
    do {
        draw_slowly(&s);
        pictures += 1;
        live_status_of(app_live(s.app), &status);
    } while ((!is_over(&s) || status.sample_count < SAMPLES) && clock_now_ns() < end_ns);
    uint64_t faces = app_view(s.app)->number - first_face;
    print_message("%ju samples, %ju faces for %ju pictures; lag p99 %.2f ms\n",
                  (uintmax_t)status.sample_count, (uintmax_t)faces, (uintmax_t)pictures,
                  status.lag_p99_ms);
    assert_true(status.sample_count >= SAMPLES); /* and a few of the mouse */
    /* They were performed while the window drew, not between its frames. */
    assert_true(faces >= FACES_A_PICTURE * pictures);
    scene_end(&s);
    check_recorded(s.show);
    scene_close(&s);
    (void)unlink(path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(at_five_pictures_a_second_every_sample_is_performed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
