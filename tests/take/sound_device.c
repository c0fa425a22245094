/* Devices as they are: PortAudio on whatever computer this is, threads, and a backend that never
 * answers. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/clock.h"
#include "show_scene.h"
#include "sound_help.h"
#include "stage/sound/sound.h"

#include <fcntl.h>
#include <pthread.h>

static void ignore_block(void *data, const sound_block *block)
{
    (void)data;
    if (block->out)
        memset(block->out, 0, block->frame_count * 2 * sizeof *block->out);
}

/* Whatever is printed on stderr goes into a file meanwhile. */
typedef struct hushed {
    int saved, file;
} hushed;

static hushed catch_stderr(void)
{
    char path[] = "/tmp/marotte_sound_XXXXXX";
    hushed out = {dup(2), mkstemp(path)};
    assert_true(out.saved >= 0 && out.file >= 0);
    unlink(path);
    fflush(stderr);
    dup2(out.file, 2);
    return out;
}

static off_t give_stderr_back(hushed *caught, char *text, size_t capacity)
{
    fflush(stderr);
    dup2(caught->saved, 2);
    close(caught->saved);
    off_t size = lseek(caught->file, 0, SEEK_END);
    ssize_t got = pread(caught->file, text, capacity - 1, 0);
    text[got > 0 ? got : 0] = '\0';
    close(caught->file);
    return size;
}

static void portaudio_opens_or_says_why_and_prints_nothing(void **state)
{
    char printed[2000];
    (void)state;
    for (int direction = SOUND_OUT; direction <= SOUND_IN; ++direction) {
        error err = {""};
        sound_backend backend;
        sound_stream stream = {0};
        sound_request request = {.rate_hz = direction == SOUND_OUT ? 48000 : 0, .channel_count = 2};
        scene_must(sound_portaudio_create(&backend, &err), &err);
        hushed caught = catch_stderr();
        mrt_result result = backend.open(backend.self, (sound_direction)direction, &request,
                                         ignore_block, NULL, &stream, &err);
        if (result >= 0)
            backend.close(backend.self, stream.handle);
        if (give_stderr_back(&caught, printed, sizeof printed) > 0)
            fail_msg("printed: %s", printed);
        if (result >= 0) {
            print_message("there is a device: %s\n", stream.name);
            assert_true(stream.rate_hz > 0 && stream.channel_count > 0);
        } else {
            print_message("%s\n", err.text);
            assert_memory_equal(err.text, "sound: ", 7);
            assert_null(strchr(err.text, '\n'));
        }
        sound_portaudio_destroy(&backend);
    }
}

static void a_device_of_no_such_name_is_said_so(void **state)
{
    error err = {""};
    sound_backend backend;
    sound_stream stream;
    sound_request request = {.channel_count = 2, .name = "no such thing"};
    (void)state;
    scene_must(sound_portaudio_create(&backend, &err), &err);
    assert_true(backend.open(backend.self, SOUND_OUT, &request, ignore_block, NULL, &stream, &err) <
                0);
    assert_string_equal(err.text,
                        "sound: no loudspeaker is called 'no such thing': choose another one");
    sound_portaudio_destroy(&backend);
}

/* Until the condition holds; a machine that is busy gets its time. */
#define WAIT_UNTIL(condition)                                                                      \
    do {                                                                                           \
        int64_t until_ns = clock_now_ns() + 60 * NS_PER_S;                                         \
        while (!(condition) && clock_now_ns() < until_ns)                                          \
            clock_sleep_until_ns(clock_now_ns() + NS_PER_MS);                                      \
        assert_true(condition);                                                                    \
    } while (0)

static sound_device_state state_of(sound *of)
{
    sound_play_status status;
    sound_update(of);
    sound_play_read_status(of, &status);
    return status.device.state;
}

static void whatever_devices_there_are_a_show_goes_on(void **state)
{
    error err = {""};
    scene place;
    show *s;
    sound *heard;
    int64_t id;
    int16_t silence[4800] = {0};
    sound_play_status status;
    (void)state;
    scene_make(&place);
    scene_must(show_create(&s, place.path, &err), &err);
    show_audio audio = {.rate_hz = 48000, .channel_count = 1, .format = "s16"};
    scene_must(show_audio_create(s, &audio, &id, &err), &err);
    scene_must(show_audio_write(s, id, 0, silence, sizeof silence, &err), &err);
    sound_settings settings = {.show = s};
    scene_must(sound_create(&heard, &settings, &err), &err);
    take_audio what = {.audio = id, .gain = 1.0};
    scene_must(sound_load(heard, &what, &err), &err);
    sound_motion motion = {.host_ns = clock_now_ns(), .speed = 1.0};
    sound_move(heard, &motion);
    WAIT_UNTIL(state_of(heard) != SOUND_DEVICE_OFF);
    sound_play_read_status(heard, &status);
    assert_true(status.device.state == SOUND_DEVICE_RUNNING || status.text[0]);
    sound_destroy(heard);
    show_close(s);
    scene_remove(&place);
}

/* Threads of its own, and a device of another thread's; for the thread sanitizer. */
typedef struct player {
    fake_device *device;
    _Atomic bool stop, may_run;
    _Atomic uint32_t blocks;
    pthread_mutex_t lock; /* opening and closing against blocks, as a backend does it */
} player;
static player playing;

static void *play(void *data)
{
    player *self = data;
    while (!atomic_load(&self->stop)) {
        pthread_mutex_lock(&self->lock);
        fake_run(self->device, SOUND_OUT);
        pthread_mutex_unlock(&self->lock);
        atomic_fetch_add(&self->blocks, 1);
        clock_sleep_until_ns(clock_now_ns() + NS_PER_MS);
    }
    return NULL;
}

static mrt_result locked_open(void *self, sound_direction direction, const sound_request *request,
                              sound_callback *callback, void *data, sound_stream *out, error *err)
{
    pthread_mutex_lock(&playing.lock);
    mrt_result result = fake_open(self, direction, request, callback, data, out, err);
    pthread_mutex_unlock(&playing.lock);
    return result;
}

static mrt_result locked_start(void *self, void *handle, error *err)
{
    pthread_mutex_lock(&playing.lock);
    mrt_result result = fake_start(self, handle, err);
    pthread_mutex_unlock(&playing.lock);
    return result;
}

static bool locked_is_alive(void *self, void *handle)
{
    pthread_mutex_lock(&playing.lock);
    bool is = fake_is_alive(self, handle);
    pthread_mutex_unlock(&playing.lock);
    return is;
}

static void locked_close(void *self, void *handle)
{
    pthread_mutex_lock(&playing.lock);
    fake_close(self, handle);
    pthread_mutex_unlock(&playing.lock);
}

static bool is_heard(sound *of)
{
    sound_play_status status;
    sound_update(of);
    sound_play_read_status(of, &status);
    return status.is_heard;
}

static void threads_play_together(void **state)
{
    static fake_host host;
    error err = {""};
    scene place;
    show *s;
    sound *heard;
    int64_t id, other;
    static int16_t tone[480000];
    pthread_t thread;
    (void)state;
    host.device[SOUND_OUT] = (fake_device){
        .is_there = true, .channel_count = 2, .clock = {.start_ns = 1000, .rate_hz = 48000}};
    playing.device = &host.device[SOUND_OUT];
    pthread_mutex_init(&playing.lock, NULL);
    sound_backend backend = {&host, locked_open, locked_start, locked_is_alive, locked_close};
    scene_make(&place);
    scene_must(show_create(&s, place.path, &err), &err);
    for (int i = 0; i < 480000; ++i)
        tone[i] = (int16_t)(1000 + i % 100);
    show_audio audio = {.rate_hz = 48000, .channel_count = 1, .format = "s16"};
    scene_must(show_audio_create(s, &audio, &id, &err), &err);
    for (int i = 0; i < 10; ++i)
        scene_must(show_audio_write(s, id, 0, tone, sizeof tone, &err), &err);
    audio.rate_hz = 44100;
    scene_must(show_audio_create(s, &audio, &other, &err), &err);
    for (int i = 0; i < 10; ++i)
        scene_must(show_audio_write(s, other, 0, tone, sizeof tone, &err), &err);
    sound_settings settings = {.show = s, .backend = &backend};
    scene_must(sound_create(&heard, &settings, &err), &err);
    assert_int_equal(pthread_create(&thread, NULL, play, &playing), 0);
    for (int round = 0; round < 4; ++round) {
        take_audio what = {.audio = round % 2 ? other : id, .gain = 1.0};
        scene_must(sound_load(heard, &what, &err), &err);
        sound_motion motion = {.host_ns = 1000, .speed = 1.0, .loop_to_ns = 5 * NS_PER_S};
        sound_move(heard, &motion);
        WAIT_UNTIL(is_heard(heard));
        what.offset_ns = -NS_PER_S;
        scene_must(sound_load(heard, &what, &err), &err);
        motion.speed = 0.0;
        sound_move(heard, &motion);
        WAIT_UNTIL(!is_heard(heard));
    }
    sound_destroy(heard);
    atomic_store(&playing.stop, true);
    pthread_join(thread, NULL);
    pthread_mutex_destroy(&playing.lock);
    show_close(s);
    scene_remove(&place);
}

/* ---- a device that never answers ---- */

static pthread_mutex_t never_lock = PTHREAD_MUTEX_INITIALIZER;
static pthread_cond_t never = PTHREAD_COND_INITIALIZER;
static _Atomic bool has_asked;

static mrt_result open_never(void *self, sound_direction direction, const sound_request *request,
                             sound_callback *callback, void *data, sound_stream *out, error *err)
{
    (void)self, (void)direction, (void)request, (void)callback, (void)data, (void)out, (void)err;
    pthread_mutex_lock(&never_lock);
    atomic_store(&has_asked, true);
    for (;;)
        pthread_cond_wait(&never, &never_lock);
    return MRT_OK;
}

static mrt_result opened_never(void *data, const sound_stream *stream, error *err)
{
    (void)data, (void)stream, (void)err;
    return MRT_OK;
}

static void a_device_that_never_answers_is_left_behind(void **state)
{
    static const sound_backend backend = {.open = open_never};
    const sound_user user = {.opened = opened_never, .block = ignore_block};
    error err = {""};
    sound_device *device;
    sound_request request = {.rate_hz = 48000, .channel_count = 2};
    (void)state;
    scene_must(
        sound_device_create(&device, SOUND_OUT, &backend, &user, NULL, SOUND_OWN_THREADS, &err),
        &err);
    sound_device_want(device, &request);
    WAIT_UNTIL(atomic_load(&has_asked));
    assert_int_equal(sound_device_read_status(device)->state, SOUND_DEVICE_OFF);
    int64_t from_ns = clock_now_ns();
    assert_false(sound_device_destroy(device));
    assert_true(clock_now_ns() - from_ns < 30 * NS_PER_S);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(portaudio_opens_or_says_why_and_prints_nothing),
        cmocka_unit_test(a_device_of_no_such_name_is_said_so),
        cmocka_unit_test(whatever_devices_there_are_a_show_goes_on),
        cmocka_unit_test(threads_play_together),
        cmocka_unit_test(a_device_that_never_answers_is_left_behind),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
