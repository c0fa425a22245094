/* The picture for other programs: what comes out of a PipeWire camera, read by a client of our own
 * under a daemon of our own; what a video device gets; what is said when nobody is there. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "base/clock.h"
#include "stream/stream.h"

#include <errno.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

enum { WIDTH = 64, HEIGHT = 48, PATIENCE_S = 600 };
static const stream_look small = {WIDTH, HEIGHT, 30};

/* ---- what is no place, and who is not there ---- */

static void what_is_no_place_is_an_error_of_one_line(void **state)
{
    static const char *const bad[] = {"",
                                      "pipewires",
                                      "http://x",
                                      "/dev/null",
                                      "srt:x",
                                      "/dev/video",
                                      "/dev/videofoo",
                                      "/dev/video1x",
                                      "/dev/video/../null",
                                      "/dev/video../../etc/passwd",
                                      "/dev/video0/../null",
                                      "/dev/video 1",
                                      "/dev/video-1"};
    (void)state;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; ++i) {
        stream_target *made = NULL;
        error err = {""};
        assert_true(stream_open(&made, bad[i], &small, &err) < 0);
        assert_null(made);
        assert_true(err.text[0] && !strchr(err.text, '\n'));
    }
}

static stream_status give_until(stream_target *to, bool is_open, bool is_wrong)
{
    const int64_t end_ns = clock_now_ns() + PATIENCE_S * NS_PER_S;
    stream_status now = stream_status_of(to);
    while (clock_now_ns() < end_ns && !(now.is_open == is_open && (now.says[0] != 0) == is_wrong)) {
        stream_give(to);
        clock_sleep_until_ns(clock_now_ns() + 10 * NS_PER_MS);
        now = stream_status_of(to);
    }
    return now;
}

static void a_device_that_is_none_is_one_calm_line(void **state)
{
    stream_target *to = NULL;
    error err = {""};
    (void)state;
    assert_int_equal(stream_open(&to, "/dev/video987654", &small, &err), MRT_OK);
    const stream_status now = give_until(to, false, true);
    assert_non_null(strstr(now.says, "/dev/video987654"));
    assert_null(strchr(now.says, '\n'));
    assert_int_equal(now.given, 0);
    stream_close(to);
}

/* ---- a stand-in for ffmpeg ---- */

typedef struct stand_in {
    char folder[64], path[96], pid[96];
    char search[4096]; /* $PATH as it was */
} stand_in;

static const stream_look large = {640, 480, 30}; /* a picture is more than a pipe holds */

static void begin_stand_in(stand_in *s, const char *script)
{
    const char *search = getenv("PATH");
    char joined[sizeof s->search + sizeof s->folder];
    (void)snprintf(s->search, sizeof s->search, "%s", search ? search : "/usr/bin:/bin");
    (void)snprintf(s->folder, sizeof s->folder, "/tmp/marotte_stream_XXXXXX");
    assert_non_null(mkdtemp(s->folder));
    (void)snprintf(s->path, sizeof s->path, "%s/ffmpeg", s->folder);
    (void)snprintf(s->pid, sizeof s->pid, "%s/pid", s->folder);
    (void)snprintf(joined, sizeof joined, "%s:%s", s->folder, s->search);
    FILE *file = fopen(s->path, "w");
    assert_non_null(file);
    fprintf(file, "#!/bin/sh\necho $$ >\"%s.new\"; mv \"%s.new\" \"%s\"\n%s\n", s->pid, s->pid,
            s->pid, script);
    assert_int_equal(fclose(file), 0);
    assert_int_equal(chmod(s->path, 0755), 0);
    assert_int_equal(setenv("PATH", joined, 1), 0);
}

static void end_stand_in(stand_in *s)
{
    assert_int_equal(setenv("PATH", s->search, 1), 0);
    (void)unlink(s->pid);
    (void)unlink(s->path);
    assert_int_equal(rmdir(s->folder), 0);
}

/* The process that runs the script, once it does. */
static pid_t stand_in_pid(const stand_in *s, stream_target *to)
{
    const int64_t end_ns = clock_now_ns() + PATIENCE_S * NS_PER_S;
    int pid = 0;
    while (pid == 0 && clock_now_ns() < end_ns) {
        FILE *file = fopen(s->pid, "r");
        stream_give(to);
        if (file && fscanf(file, "%d", &pid) != 1)
            pid = 0;
        if (file)
            (void)fclose(file);
        clock_sleep_until_ns(clock_now_ns() + 10 * NS_PER_MS);
    }
    assert_true(pid > 0);
    return pid;
}

static stream_status ended(stream_target *to)
{
    const int64_t end_ns = clock_now_ns() + PATIENCE_S * NS_PER_S;
    stream_stop(to);
    while (!stream_status_of(to).has_ended && clock_now_ns() < end_ns)
        clock_sleep_until_ns(clock_now_ns() + 10 * NS_PER_MS);
    assert_true(stream_status_of(to).has_ended);
    return stream_status_of(to);
}

/* It takes nothing and does not end when it is asked to. */
static void an_encoder_that_takes_nothing_does_not_hold_the_stream(void **state)
{
    stand_in s;
    stream_target *to = NULL;
    error err = {""};
    (void)state;
    begin_stand_in(&s, "trap '' TERM; exec sleep 1000");
    assert_int_equal(stream_open(&to, "srt://127.0.0.1:9?mode=listener", &large, &err), MRT_OK);
    const pid_t pid = stand_in_pid(&s, to);
    stream_status now = give_until(to, false, true);
    assert_non_null(strstr(now.says, "127.0.0.1:9"));
    assert_non_null(strstr(now.says, "no picture was taken"));
    assert_int_equal(now.given, 0);
    assert_int_equal(kill(pid, 0), 0); /* a listener may wait for hours */
    now = ended(to);
    assert_non_null(strstr(now.says, "was killed"));
    assert_int_equal(kill(pid, 0), -1); /* and reaped */
    assert_int_equal(errno, ESRCH);
    stream_close(to);
    end_stand_in(&s);
}

static void an_encoder_that_ends_when_it_is_asked_to_is_no_news(void **state)
{
    stand_in s;
    stream_target *to = NULL;
    error err = {""};
    (void)state;
    begin_stand_in(&s, "exec cat >/dev/null");
    assert_int_equal(stream_open(&to, "udp://127.0.0.1:9", &large, &err), MRT_OK);
    const pid_t pid = stand_in_pid(&s, to);
    assert_true(give_until(to, true, false).given > 0);
    assert_string_equal(ended(to).says, "");
    assert_int_equal(kill(pid, 0), -1);
    stream_close(to);
    end_stand_in(&s);
}

/* ---- a video device: pixels ---- */

static void pixels_lie_over_green_as_yuyv(void **state)
{
    static const uint8_t rgba[16] = {255, 255, 255, 255, 0, 0, 0, 255, 255, 0, 0, 0, 9, 9, 9, 0};
    uint8_t out[8];
    (void)state;
    stream_yuyv(out, rgba, 4);
    assert_int_equal(out[0], 235); /* white and black, BT.601: no colour between them */
    assert_int_equal(out[2], 16);
    assert_in_range(out[1], 127, 129);
    assert_in_range(out[3], 127, 129);
    assert_int_equal(out[4], out[6]); /* what is clear is the key, whatever it was: #00b140 */
    assert_in_range(out[4], 110, 113);
    assert_in_range(out[5], 104, 107);
    assert_in_range(out[7], 57, 60);
}

/* ---- PipeWire ---- */

#ifdef MAROTTE_HAS_PIPEWIRE
#include <pipewire/pipewire.h>
#include <spa/param/video/format-utils.h>

typedef struct daemon_room {
    char folder[64];
    pid_t pid;
} daemon_room;

extern char **environ;

static void begin_daemon(daemon_room *r)
{
    char *const words[] = {(char[]){"pipewire"}, NULL};
    posix_spawn_file_actions_t quiet;
    posix_spawn_file_actions_init(&quiet);
    posix_spawn_file_actions_addopen(&quiet, STDERR_FILENO, "/dev/null", 1, 0);
    if (posix_spawnp(&r->pid, "pipewire", &quiet, NULL, words, environ) != 0)
        r->pid = 0;
    posix_spawn_file_actions_destroy(&quiet);
}

static void end_daemon(daemon_room *r)
{
    (void)kill(r->pid, SIGKILL);
    (void)waitpid(r->pid, NULL, 0);
    r->pid = 0;
}

static void open_daemon(daemon_room *r)
{
    (void)snprintf(r->folder, sizeof r->folder, "/tmp/marotte_pipewire_XXXXXX");
    assert_non_null(mkdtemp(r->folder));
    (void)setenv("XDG_RUNTIME_DIR", r->folder, 1);
    (void)setenv("PIPEWIRE_RUNTIME_DIR", r->folder, 1);
    begin_daemon(r);
}

static void close_daemon(daemon_room *r)
{
    char command[96];
    end_daemon(r);
    (void)snprintf(command, sizeof command, "rm -rf %s", r->folder);
    assert_int_equal(system(command), 0);
}

static bool has_program(const char *name)
{
    char command[64];
    (void)snprintf(command, sizeof command, "command -v %s >/dev/null", name);
    return system(command) == 0;
}

typedef struct reader { /* a client that takes what the camera gives */
    struct pw_thread_loop *loop;
    struct pw_context *context;
    struct pw_core *core;
    struct pw_stream *stream;
    struct spa_hook listener;
    uint32_t frames; /* with the loop's lock, as what follows */
    uint8_t newest[WIDTH * HEIGHT * 4];
} reader;

static void read_param(void *data, uint32_t id, const struct spa_pod *param)
{
    reader *self = data;
    uint8_t bytes[512];
    struct spa_pod_builder builder = SPA_POD_BUILDER_INIT(bytes, sizeof bytes);
    if (!param || id != SPA_PARAM_Format)
        return;
    const struct spa_pod *wanted[1] = {spa_pod_builder_add_object(
        &builder, SPA_TYPE_OBJECT_ParamBuffers, SPA_PARAM_Buffers, SPA_PARAM_BUFFERS_dataType,
        SPA_POD_CHOICE_FLAGS_Int((1 << SPA_DATA_MemPtr) | (1 << SPA_DATA_MemFd)))};
    (void)pw_stream_update_params(self->stream, wanted, 1);
}

static void read_frame(void *data)
{
    reader *self = data;
    struct pw_buffer *from = pw_stream_dequeue_buffer(self->stream);
    if (!from)
        return;
    const struct spa_data *at = &from->buffer->datas[0];
    if (at->data && at->chunk->size == sizeof self->newest) {
        memcpy(self->newest, at->data, sizeof self->newest);
        self->frames += 1;
    }
    (void)pw_stream_queue_buffer(self->stream, from);
}

static const struct pw_stream_events read_events = {
    .version = PW_VERSION_STREAM_EVENTS, .param_changed = read_param, .process = read_frame};

static bool open_reader(reader *self)
{
    uint8_t bytes[512];
    struct spa_pod_builder builder = SPA_POD_BUILDER_INIT(bytes, sizeof bytes);
    const struct spa_pod *format[1] = {
        spa_pod_builder_add_object(&builder, SPA_TYPE_OBJECT_Format, SPA_PARAM_EnumFormat,
                                   SPA_FORMAT_mediaType, SPA_POD_Id(SPA_MEDIA_TYPE_video),
                                   SPA_FORMAT_mediaSubtype, SPA_POD_Id(SPA_MEDIA_SUBTYPE_raw),
                                   SPA_FORMAT_VIDEO_format, SPA_POD_Id(SPA_VIDEO_FORMAT_RGBA))};
    memset(self, 0, sizeof *self);
    self->loop = pw_thread_loop_new("reader", NULL);
    self->context = pw_context_new(pw_thread_loop_get_loop(self->loop), NULL, 0);
    self->core = pw_context_connect(self->context, NULL, 0);
    if (!self->core)
        return false;
    self->stream =
        pw_stream_new(self->core, "reader",
                      pw_properties_new(PW_KEY_MEDIA_TYPE, "Video", PW_KEY_MEDIA_CATEGORY,
                                        "Capture", PW_KEY_NODE_NAME, "reader", NULL));
    pw_stream_add_listener(self->stream, &self->listener, &read_events, self);
    return pw_stream_connect(self->stream, PW_DIRECTION_INPUT, PW_ID_ANY,
                             PW_STREAM_FLAG_MAP_BUFFERS, format, 1) >= 0 &&
           pw_thread_loop_start(self->loop) >= 0;
}

static void close_reader(reader *self)
{
    pw_thread_loop_stop(self->loop);
    if (self->stream)
        pw_stream_destroy(self->stream);
    if (self->core)
        pw_core_disconnect(self->core);
    pw_context_destroy(self->context);
    pw_thread_loop_destroy(self->loop);
}

/* The camera's picture: a ramp of colours, and of alpha from the left to the right. */
static void paint(uint8_t *rgba, uint8_t shade)
{
    for (uint32_t y = 0; y < HEIGHT; ++y)
        for (uint32_t x = 0; x < WIDTH; ++x) {
            const uint8_t pixel[4] = {(uint8_t)(4 * x), (uint8_t)(5 * y), shade, (uint8_t)(4 * x)};
            memcpy(rgba + 4 * (y * WIDTH + x), pixel, 4);
        }
}

/* Gives pictures until the reader has seen one like it; links them until they are linked. */
static bool is_read(stream_target *camera, reader *by, uint8_t shade)
{
    static uint8_t wanted[WIDTH * HEIGHT * 4];
    const int64_t end_ns = clock_now_ns() + PATIENCE_S * NS_PER_S;
    bool is_same = false;
    paint(wanted, shade);
    for (uint32_t i = 0; clock_now_ns() < end_ns && !is_same; ++i) {
        memcpy(stream_picture(camera), wanted, sizeof wanted);
        stream_give(camera);
        pw_thread_loop_lock(by->loop);
        is_same = by->frames > 0 && memcmp(by->newest, wanted, sizeof wanted) == 0;
        const bool is_linked = by->frames > 0;
        pw_thread_loop_unlock(by->loop);
        if (!is_linked && i % 20 == 5)
            (void)!system("pw-link marotte reader >/dev/null 2>&1");
        clock_sleep_until_ns(clock_now_ns() + 20 * NS_PER_MS);
    }
    return is_same;
}

static void frames_come_out_of_a_pipewire_camera_with_their_alpha(void **state)
{
    daemon_room room;
    stream_target *camera = NULL;
    error err = {""};
    reader by;
    (void)state;
    if (!has_program("pipewire") || !has_program("pw-link")) {
        print_message("skipped: pipewire and pipewire-bin are not installed\n");
        skip();
    }
    pw_init(NULL, NULL);
    open_daemon(&room);
    assert_int_equal(stream_open(&camera, "pipewire", &small, &err), MRT_OK);
    stream_status now = give_until(camera, true, false); /* tried again until the daemon is there */
    assert_string_equal(now.says, "");
    assert_true(now.is_open);
    assert_true(open_reader(&by));
    assert_true(is_read(camera, &by, 17));
    assert_true(is_read(camera, &by, 200)); /* and what comes after it */
    close_reader(&by);
    end_daemon(&room); /* it is restarted: one line, and the camera is back */
    now = give_until(camera, false, true);
    assert_non_null(strstr(now.says, "PipeWire"));
    begin_daemon(&room);
    now = give_until(camera, true, false);
    assert_true(now.is_open);
    assert_true(open_reader(&by));
    assert_true(is_read(camera, &by, 99));
    close_reader(&by);
    assert_int_equal(kill(room.pid, SIGSTOP), 0); /* it takes nothing more: nobody waits for it */
    for (uint8_t i = 0; i < 20; ++i) {
        paint(stream_picture(camera), i);
        stream_give(camera);
        clock_sleep_until_ns(clock_now_ns() + 5 * NS_PER_MS);
    }
    stream_close(camera);
    assert_int_equal(stream_open(&camera, "pipewire", &small, &err), MRT_OK);
    stream_give(camera);
    stream_close(camera);
    close_daemon(&room);
    pw_deinit();
}
#else
static void frames_come_out_of_a_pipewire_camera_with_their_alpha(void **state)
{
    (void)state;
    print_message("skipped: built without libpipewire-0.3-dev\n");
    skip();
}
#endif

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_no_place_is_an_error_of_one_line),
        cmocka_unit_test(a_device_that_is_none_is_one_calm_line),
        cmocka_unit_test(an_encoder_that_takes_nothing_does_not_hold_the_stream),
        cmocka_unit_test(an_encoder_that_ends_when_it_is_asked_to_is_no_news),
        cmocka_unit_test(pixels_lie_over_green_as_yuyv),
        cmocka_unit_test(frames_come_out_of_a_pipewire_camera_with_their_alpha),
    };
    (void)signal(SIGPIPE, SIG_IGN); /* as the program does */
    return cmocka_run_group_tests(tests, NULL, NULL);
}
