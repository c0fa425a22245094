/* Time code from outside in the window: seen on the clock, laid under a take, played after. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "device/ltc_sound.h"
#include "scene.h"
#include "stage/live/live_stage.h"
#include "show/take.h"

#include <fcntl.h>
#include <pthread.h>
#include <stdatomic.h>
#include <sys/stat.h>
#include <unistd.h>

enum { RATE_HZ = 48000, BLOCK = 480, FPS = 25 };

typedef struct tape { /* that runs into a pipe, as sound does */
    pthread_t thread;
    _Atomic bool is_ending, is_paused;
    _Atomic int64_t wanted_frame; /* >= 0: it is wound to there */
    _Atomic int64_t zero_ns;      /* host clock: when frame 0 would have begun */
    int pipe;
} tape;

static ltc_sound wound_to(int64_t frame)
{
    const uint32_t second = (uint32_t)(frame / FPS);
    return ltc_sound_make(RATE_HZ, FPS, false, second / 3600, second / 60 % 60, second % 60,
                          (uint32_t)(frame % FPS));
}

static void *run_tape(void *data)
{
    tape *self = data;
    int64_t from_ns = clock_now_ns(), done = 0;
    ltc_sound tone = wound_to(0);
    while (!atomic_load(&self->is_ending)) {
        int16_t block[BLOCK];
        const int64_t frame = atomic_exchange(&self->wanted_frame, -1);
        if (frame >= 0) {
            tone = wound_to(frame);
            from_ns = clock_now_ns();
            done = 0;
            atomic_store(&self->zero_ns, from_ns - frame * NS_PER_S / FPS);
        }
        for (int i = 0; i < BLOCK; ++i)
            block[i] = (int16_t)lrint(16000.0 * ltc_sound_next(&tone));
        done += BLOCK;
        clock_sleep_until_ns(from_ns + done * NS_PER_S / RATE_HZ);
        if (!atomic_load(&self->is_paused) && write(self->pipe, block, sizeof block) < 0)
            continue; /* nobody reads */
    }
    return NULL;
}

static bool has_code(scene *s, void *data)
{
    timecode_rate rate;
    int64_t frame;
    (void)data;
    return app_outside_code(s->app, &rate, &frame);
}

static bool has_recorded(scene *s, void *data)
{
    (void)data;
    return app_status(s->app)->recorded_ns > NS_PER_S;
}

static bool has_take(scene *s, void *data)
{
    (void)data;
    return app_take(s->app) != NULL && !app_status(s->app)->is_recording;
}

static bool plays(scene *s, void *data)
{
    return live_transport(app_live(s->app))->is_playing == *(bool *)data;
}

static bool is_with_the_code(scene *s, void *data)
{
    tape *of = data;
    const take *t = app_take(s->app);
    const int64_t at_ns = live_position(app_live(s->app)).at_ns;
    const int64_t code_ns =
        clock_now_ns() - atomic_load(&of->zero_ns) - t->timecode_frame * NS_PER_S / FPS;
    if (code_ns > t->duration_ns) /* too short for a slow machine: once more */
        atomic_store(&of->wanted_frame, t->timecode_frame - FPS);
    return live_transport(app_live(s->app))->is_playing && at_ns > 0 && code_ns > 0 &&
           llabs(at_ns - code_ns) < 50 * NS_PER_MS;
}

static void a_take_has_the_time_code_and_plays_after_it(void **state)
{
    (void)state;
    scene s;
    static char hand[512], code[300], folder[] = "/tmp/marotte_tape_XXXXXX", path[64];
    static const char *const inputs[] = {hand, code};
    bool is_playing = true;
    static tape t = {.wanted_frame = 3600 * FPS}; /* its thread outlives a test that fails */
    assert_non_null(mkdtemp(folder));
    (void)snprintf(path, sizeof path, "%s/pipe", folder);
    assert_int_equal(mkfifo(path, 0600), 0);
    t.pipe = open(path, O_RDWR | O_NONBLOCK);
    (void)snprintf(code, sizeof code, "ltc:%s", path);
    (void)snprintf(hand, sizeof hand, "log:%s/plugins/log/demo_hand.csv,loop=1", SOURCE_DIR);
    const scene_options options = {
        .width_px = 1280, .height_px = 720, .scale = 1.0f, .inputs = inputs, .input_count = 2};
    scene_open_with(&s, &options);
    scene_let_cut(&s, "/tmp/");
    scene_let_cut(&s, "demo_hand");
    assert_int_equal(pthread_create(&t.thread, NULL, run_tape, &t), 0);
    assert_true(scene_until(&s, has_code, NULL));
    assert_non_null(scene_word_with(&s, "01:00:"));
    scene_look(&s, "timecode_live");
    scene_check_words(&s);
    scene_do(&s, ACTION_RECORD);
    assert_true(scene_until(&s, has_recorded, NULL));
    scene_do(&s, ACTION_RECORD);
    assert_true(scene_until(&s, has_take, NULL));
    const take *made = app_take(s.app);
    assert_true(made->fps == (double)FPS && made->timecode_frame > 3600 * FPS);
    const int64_t began_ns = atomic_load(&t.zero_ns) + made->timecode_frame * NS_PER_S / FPS;
    const int64_t off_ns = made->start_ns - recorder_show_ns(app_live(s.app)->recorder, began_ns);
    print_message("the take begins %.1f ms off its frame\n", 1e-6 * (double)off_ns);
    assert_true(llabs(off_ns) < 20 * NS_PER_MS);
    scene_do(&s, ACTION_UNDO); /* it is how the take was made */
    assert_true(app_take(s.app)->timecode_frame == made->timecode_frame);

    app_set_chases(s.app, true);
    scene_frames(&s, 20);
    assert_false(live_transport(app_live(s.app))->is_playing); /* the code is past its end */
    atomic_store(&t.wanted_frame, made->timecode_frame - FPS);
    assert_true(scene_until(&s, plays, &is_playing));
    assert_true(scene_until(&s, is_with_the_code, &t));
    is_playing = false;
    atomic_store(&t.is_paused, true); /* the tape stops, or has gone past the end */
    assert_true(scene_until(&s, plays, &is_playing));
    atomic_store(&t.is_ending, true);
    (void)pthread_join(t.thread, NULL);
    scene_close(&s);
    close(t.pipe);
    unlink(path);
    rmdir(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_take_has_the_time_code_and_plays_after_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
