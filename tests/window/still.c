/* While nothing moves, nothing is drawn: the stage counts its frames, and why each of them was due
 * (gui/pace.h). By a clock of the test's own, so that no machine is too busy. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include "window/scene.h"

enum { TEXT = 512, HAND_S = 100 };

typedef struct counts {
    uint64_t frames, drawn, faces, signals;
} counts;

static counts counted(const scene *s)
{
    workspace_counts now;
    workspace_counted(s->workspace, &now);
    return (counts){now.frame_count, now.drawn_count, now.face_count,
                    window_pace(s->window)->count[PACE_SIGNAL]};
}

static void pass(scene *s, double seconds)
{
    const int64_t end_ns = clock_now_ns() + (int64_t)(seconds * (double)NS_PER_S);
    while (clock_now_ns() < end_ns)
        scene_frame(s);
}

/* What happens in that time. */
static counts during(scene *s, double seconds)
{
    const counts before = counted(s);
    pass(s, seconds);
    const counts after = counted(s);
    return (counts){after.frames - before.frames, after.drawn - before.drawn,
                    after.faces - before.faces, after.signals - before.signals};
}

static void open_still(scene *s, const char *const *inputs, uint32_t input_count)
{
    const scene_options options = {.width_px = 800,
                                   .height_px = 500,
                                   .scale = 1.0f,
                                   .inputs = inputs,
                                   .input_count = input_count,
                                   .is_drawn = true,
                                   .waits = true};
    scene_open_with(s, &options);
    pass(s, 35.0); /* news of the start go away; "K keeps the last 30 s" */
}

/* A hand as in the demo's first record, which trembles by +-share of a degree. */
static void write_hand(char text[TEXT], const char *folder, double degrees)
{
    char path[TEXT - 16], line[TEXT] = "", rest[TEXT] = "";
    uint32_t seed = 7;
    (void)snprintf(path, sizeof path, "%s/plugins/log/demo_hand.csv", SOURCE_DIR);
    FILE *from = fopen(path, "r");
    (void)snprintf(path, sizeof path, "%s/still_hand_%.0f.csv", folder, 100.0 * degrees);
    FILE *to = fopen(path, "w");
    assert_non_null(from);
    assert_non_null(to);
    while (!rest[0] && fgets(line, sizeof line, from)) {
        if (line[0] >= '0' && line[0] <= '9')
            (void)snprintf(rest, sizeof rest, "%s", strchr(line, ',') + 1);
        else
            fputs(line, to);
    }
    (void)fclose(from);
    for (int i = 0; i < 100 * HAND_S; ++i) {
        (void)fprintf(to, "%.2f", 0.01 * i);
        char *at = rest;
        for (char *end; *at && *at != '\n'; at = *end == ',' ? end + 1 : end) {
            seed = seed * 1664525u + 1013904223u;
            const double noise = ((double)(seed >> 8) / 16777216.0 - 0.5) * 2.0 * degrees / 57.2958;
            (void)fprintf(to, ",%.5f", strtod(at, &end) + noise);
        }
        fputc('\n', to);
    }
    (void)fclose(to);
    (void)snprintf(text, TEXT, "log:%s,loop=1", path);
}

/* ---- what is to be ---- */

static void with_nobody_the_window_only_looks_twice_a_second(void **state)
{
    (void)state;
    scene s;
    open_still(&s, NULL, 0);
    const counts now = during(&s, 20.0);
    print_message("nobody, 20 s: %d frames, %d drawn, %d faces\n", (int)now.frames, (int)now.drawn,
                  (int)now.faces);
    assert_in_range(now.frames, 35, 50);
    assert_int_equal(now.drawn, 0);
    assert_int_equal(now.faces, 0);
    assert_int_equal(now.signals, 0);
    scene_close(&s);
}

static void a_hand_at_rest_draws_numbers_a_few_times_a_second_and_no_face(void **state)
{
    (void)state;
    static const double trembles[] = {0.0, 0.3};
    for (size_t i = 0; i < 2; ++i) {
        char text[TEXT], folder[] = "/tmp/marotte_still_XXXXXX";
        scene s;
        assert_non_null(mkdtemp(folder));
        write_hand(text, folder, trembles[i]);
        const char *const inputs[] = {text};
        open_still(&s, inputs, 1);
        const uint64_t samples = app_status(s.app)->sample_count;
        const counts now = during(&s, 20.0);
        print_message("a hand that trembles by %.1f deg, 20 s: %d frames, %d drawn, %d faces\n",
                      trembles[i], (int)now.frames, (int)now.drawn, (int)now.faces);
        assert_true(app_status(s.app)->sample_count > samples + 1500);
        assert_in_range(now.frames, 1, 200);
        assert_in_range(now.drawn, 0, 160);
        assert_int_equal(now.faces, 0);
        scene_close(&s);
        (void)snprintf(text, sizeof text, "rm -rf %s", folder);
        assert_int_equal(system(text), 0);
    }
}

static void a_face_that_moves_is_drawn_at_once(void **state)
{
    (void)state;
    scene s;
    open_still(&s, NULL, 0);
    const counts before = counted(&s);
    const uint64_t number = app_view(s.app)->number;
    scene_move(&s, 235.0f, 180.0f); /* the nose */
    scene_settle(&s);
    scene_button(&s, 0, true);
    scene_settle(&s);
    scene_move(&s, 235.0f, 150.0f);
    const int64_t asked_ns = clock_now_ns();
    while (app_view(s.app)->number == number && clock_now_ns() < asked_ns + NS_PER_S)
        scene_frame(&s);
    assert_true(clock_now_ns() - asked_ns < 100 * NS_PER_MS); /* not at the next look */
    pass(&s, 0.5);
    scene_button(&s, 0, false);
    scene_move(&s, -10000.0f, -10000.0f);
    pass(&s, 2.0);
    const counts after = counted(&s);
    print_message("a pull: %d frames, %d drawn, %d faces, %d signals\n",
                  (int)(after.frames - before.frames), (int)(after.drawn - before.drawn),
                  (int)(after.faces - before.faces), (int)(after.signals - before.signals));
    assert_true(after.signals > before.signals);
    assert_true(after.faces > before.faces);
    /* And then it is still again. */
    const counts now = during(&s, 5.0);
    assert_int_equal(now.faces, 0);
    assert_int_equal(now.drawn, 0);
    scene_close(&s);
}

static void a_glide_of_the_camera_asks_for_its_frames(void **state)
{
    (void)state;
    scene s;
    open_still(&s, NULL, 0);
    scene_do(&s, ACTION_VIEW_SIDE);
    const counts moving = during(&s, 1.5);
    print_message("glide: %d frames %d drawn %d faces\n", (int)moving.frames, (int)moving.drawn,
                  (int)moving.faces);
    assert_true(moving.faces > 5);
    pass(&s, 2.0);
    assert_int_equal(during(&s, 5.0).drawn, 0);
    scene_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(with_nobody_the_window_only_looks_twice_a_second),
        cmocka_unit_test(a_hand_at_rest_draws_numbers_a_few_times_a_second_and_no_face),
        cmocka_unit_test(a_face_that_moves_is_drawn_at_once),
        cmocka_unit_test(a_glide_of_the_camera_asks_for_its_frames),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
