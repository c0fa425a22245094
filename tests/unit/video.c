/* Moving pictures: what a look is, folders of pictures, and a thread that draws what comes. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "base/clock.h"
#include "base/file.h"
#include "draw_help.h"
#include "stream/video.h"

#include <dirent.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { SIDE = 64, PICTURE = SIDE * SIDE * 4 };

static const timecode_rate film = {24, 1, false};
static const video_folder_about about = {SIDE, SIDE, false, {24, 1, false}, ""};
static char scratch[64], frames[128], movie[128], usual_path[2048];
static bool can_draw;

static int set_up(void **state)
{
    (void)state;
    (void)snprintf(scratch, sizeof scratch, "/tmp/marotte-video-XXXXXX");
    if (!mkdtemp(scratch))
        return -1;
    (void)snprintf(frames, sizeof frames, "%s/frames/", scratch);
    (void)snprintf(movie, sizeof movie, "%s/movie.mp4", scratch);
    return 0;
}

static const char *in_folder(const char *folder, const char *name)
{
    static char path[2][512];
    static int which;
    which = !which;
    (void)snprintf(path[which], sizeof path[which], "%s%s", folder, name);
    return path[which];
}

static bool is_there(const char *folder, const char *name)
{
    return access(in_folder(folder, name), F_OK) == 0;
}

/* How much is in a folder, which is removed. */
static uint32_t empty(const char *folder)
{
    uint32_t count = 0;
    DIR *at = opendir(folder);
    const struct dirent *entry;
    while (at && (entry = readdir(at))) {
        if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0)
            continue;
        count += 1;
        char path[600];
        (void)snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        struct stat status;
        if (stat(path, &status) == 0 && S_ISDIR(status.st_mode))
            (void)empty(path);
        else
            (void)remove(path);
    }
    if (at)
        closedir(at);
    (void)rmdir(folder);
    return count;
}

static int tear_down(void **state)
{
    (void)state;
    return empty(scratch) == 0 ? 0 : -1; /* nothing lies about */
}

/* ---- looks ---- */

static void sizes_are_two_numbers(void **state)
{
    (void)state;
    video_look look = video_look_default();
    static const char *const wrong[] = {"",        "640",      "640x",     "x480",      "640x480x2",
                                        "640 480", "8x8",      "-640x480", "640x99999", "640.5x480",
                                        "0x10x20", "1e3x1000", "640X480"};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; ++i)
        assert_false(video_look_size(&look, wrong[i]));
    assert_int_equal(look.width, 1280);
    assert_int_equal(look.height, 720);
    assert_true(video_look_size(&look, "1920x1080"));
    assert_int_equal(look.width, 1920);
    assert_int_equal(look.height, 1080);
}

static void grounds_are_colours_or_nothing(void **state)
{
    (void)state;
    video_look look = video_look_default();
    static const char *const wrong[] = {"",       "green",    "#fff",   "00b140",
                                        "#00b14", "#00b1400", "#00b14g"};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; ++i)
        assert_false(video_look_ground(&look, wrong[i]));
    assert_int_equal(look.ground, VIDEO_SCENE);
    assert_true(video_look_ground(&look, "#00B1ff"));
    assert_int_equal(look.ground, VIDEO_COLOUR);
    assert_near(look.rgba[0], 0, 0);
    assert_near(look.rgba[1], 177 / 255.0, 1e-6);
    assert_near(look.rgba[2], 1, 0);
    assert_near(look.rgba[3], 1, 0);
    assert_true(video_look_ground(&look, "transparent"));
    assert_near(look.rgba[3], 0, 0);
}

static void an_mp4_is_even_and_opaque(void **state)
{
    (void)state;
    error err = {""};
    video_look look = video_look_default();
    assert_int_equal(video_look_check_mp4(&look, "a.mp4", &err), MRT_OK);
    look.height = 721;
    assert_int_equal(video_look_check_mp4(&look, "a.mp4", &err), MRT_ERR_ARGUMENT);
    assert_non_null(strstr(err.text, "--size 1280x722"));
    look = video_look_default();
    assert_true(video_look_ground(&look, "transparent"));
    assert_int_equal(video_look_check_mp4(&look, "a.mp4", &err), MRT_ERR_ARGUMENT);
    assert_non_null(strstr(err.text, "cannot be transparent"));
}

static void every_view_shows_the_whole_head(void **state)
{
    (void)state;
    static const char *const views[] = {"front", "side", "three-quarter"};
    static const uint32_t sizes[][2] = {{1280, 720}, {720, 1280}, {500, 500}};
    const float low[3] = {-90, -150, -110}, high[3] = {90, 150, 100};
    for (int i = 0; i < 9; ++i) {
        video_look look = video_look_default();
        assert_true(video_look_view(&look, views[i % 3]));
        look.width = sizes[i / 3][0];
        look.height = sizes[i / 3][1];
        draw_camera camera = video_look_camera(&look, low, high);
        const uint32_t whole[4] = {0, 0, look.width, look.height};
        float at[2];
        for (int side = 0; side < 6; ++side) { /* the middles of the box's sides: heads are round */
            float point[3] = {0, 0, 0};
            point[side % 3] = side < 3 ? low[side % 3] : high[side % 3];
            assert_true(draw_project(at, &camera, whole, point));
            assert_true(at[0] > 0 && at[0] < (float)look.width);
            assert_true(at[1] > 0 && at[1] < (float)look.height);
        }
    }
    video_look look = video_look_default();
    assert_false(video_look_view(&look, "back"));
}

static void a_mirror_changes_sides(void **state)
{
    (void)state;
    uint8_t row[2][3 * 4] = {{1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3},
                             {4, 4, 4, 4, 5, 5, 5, 5, 6, 6, 6, 6}};
    static const uint8_t turned[2][3 * 4] = {{3, 3, 3, 3, 2, 2, 2, 2, 1, 1, 1, 1},
                                             {6, 6, 6, 6, 5, 5, 5, 5, 4, 4, 4, 4}};
    video_look_mirror(row[0], 3, 2);
    assert_memory_equal(row, turned, sizeof row);
}

/* ---- folders ---- */

static const uint8_t picture[PICTURE];

static mrt_result write_folder(uint32_t count, error *err)
{
    video_folder *folder = NULL;
    mrt_result result = video_folder_open(&folder, frames, &about, err);
    for (uint32_t i = 0; i < count && result >= 0; ++i)
        result = video_folder_add(folder, picture, err);
    if (result >= 0)
        return video_folder_commit(folder, err);
    video_folder_abandon(folder);
    return result;
}

static void pictures_come_when_all_are_there(void **state)
{
    (void)state;
    error err = {""};
    video_folder *folder = NULL;
    assert_int_equal(video_folder_open(&folder, frames, &about, &err), MRT_OK);
    for (int i = 0; i < 3; ++i)
        assert_int_equal(video_folder_add(folder, picture, &err), MRT_OK);
    assert_false(is_there(frames, "00001.png"));
    assert_int_equal(video_folder_commit(folder, &err), MRT_OK);
    assert_true(is_there(frames, "00001.png"));
    assert_true(is_there(frames, "00003.png"));
    assert_true(is_there(frames, "frames.json"));
    assert_int_equal(empty(frames), 4);
}

static void what_is_given_up_leaves_nothing(void **state)
{
    (void)state;
    error err = {""};
    video_folder *folder = NULL;
    assert_int_equal(video_folder_open(&folder, frames, &about, &err), MRT_OK);
    assert_int_equal(video_folder_add(folder, picture, &err), MRT_OK);
    video_folder_abandon(folder);
    assert_false(is_there(frames, ""));
}

static void a_shorter_sequence_replaces_a_longer_one(void **state)
{
    (void)state;
    error err = {""};
    assert_int_equal(write_folder(5, &err), MRT_OK);
    assert_int_equal(write_folder(2, &err), MRT_OK);
    assert_true(is_there(frames, "00002.png"));
    assert_int_equal(empty(frames), 3);
}

static void pictures_of_others_are_never_touched(void **state)
{
    (void)state;
    error err = {""};
    assert_int_equal(mkdir(frames, 0777), 0);
    assert_int_equal(file_write(in_folder(frames, "00001.png"), "theirs", 6, &err), MRT_OK);
    assert_int_equal(video_folder_check(frames, &err), MRT_ERR_IO);
    assert_int_equal(write_folder(2, &err), MRT_ERR_IO);
    assert_non_null(strstr(err.text, "00001.png"));
    static const char *const notes[] = {"{}",
                                        "[1]",
                                        "{\"marotte_frames\":2,\"count\":9}",
                                        "{\"marotte_frames\":1,\"count\":-1}",
                                        "{\"marotte_frames\":1,\"count\":1e99}",
                                        "{\"marotte_frames\":1"};
    for (size_t i = 0; i < sizeof notes / sizeof *notes; ++i) {
        assert_int_equal(
            file_write(in_folder(frames, "frames.json"), notes[i], strlen(notes[i]), &err), MRT_OK);
        assert_int_equal(video_folder_check(frames, &err), MRT_ERR_IO);
    }
    assert_int_equal(empty(frames), 2);
}

/* Killed midway: what is in the folder is known to be ours, whatever has been moved by then. */
static void a_move_that_ended_midway_can_be_done_again(void **state)
{
    (void)state;
    error err = {""};
    static const char note[] = "{\"marotte_frames\":1,\"count\":7}";
    assert_int_equal(write_folder(3, &err), MRT_OK);
    assert_int_equal(file_write(in_folder(frames, "frames.json"), note, strlen(note), &err),
                     MRT_OK);
    assert_int_equal(file_write(in_folder(frames, "00007.png"), "half", 4, &err), MRT_OK);
    assert_int_equal(write_folder(4, &err), MRT_OK);
    assert_int_equal(empty(frames), 5);
}

static void places_where_no_folder_can_be_are_said(void **state)
{
    (void)state;
    error err = {""};
    char path[256];
    (void)snprintf(path, sizeof path, "%s/nowhere/frames/", scratch);
    assert_int_equal(video_folder_check(path, &err), MRT_ERR_IO);
    assert_non_null(strstr(err.text, "nowhere/: No such file"));
    assert_int_equal(file_write(movie, "a file", 6, &err), MRT_OK);
    (void)snprintf(path, sizeof path, "%s/", movie);
    assert_int_equal(video_folder_check(path, &err), MRT_ERR_IO);
    assert_int_equal(unlink(movie), 0);
}

/* ---- the thread that draws ---- */

typedef struct stage {
    mesh mesh;
    points_order order;
    points shape;
    video *video;
} stage;

static void open_stage(stage *s, const video_file *file, uint32_t count, video_pace pace,
                       uint32_t side)
{
    error err = {""};
    if (!can_draw)
        skip();
    s->mesh = shapes_balls(&(ball){{0, 0, 0}, 100}, 1);
    assert_int_equal(points_order_create(&s->order, s->mesh.position, s->mesh.vertex_count, &err),
                     MRT_OK);
    assert_int_equal(points_create(&s->shape, &s->order, s->mesh.position, &err), MRT_OK);
    video_settings settings = {
        .mesh = &s->mesh, .look = video_look_default(), .pace = pace, .rate = film, .timecode = ""};
    settings.look.width = settings.look.height = side;
    if (video_create(&s->video, file, count, &settings, &err) != MRT_OK)
        fail_msg("%s", err.text);
}

static void close_stage(stage *s)
{
    video_destroy(s->video);
    points_destroy(&s->shape);
    points_order_destroy(&s->order);
    mesh_destroy(&s->mesh);
}

static void every_frame_becomes_a_picture(void **state)
{
    (void)state;
    stage s;
    error err = {""};
    const video_file file = {frames, true};
    open_stage(&s, &file, 1, VIDEO_EVERY_FRAME, SIDE);
    for (int i = 0; i < 20; ++i)
        assert_int_equal(video_add(s.video, &s.shape, &s.order, &err), MRT_OK);
    assert_int_equal(video_finish(s.video, &err), MRT_OK);
    assert_int_equal(video_reported(s.video).picture_count, 20);
    assert_int_equal(video_reported(s.video).repeated_count, 0);
    close_stage(&s);
    assert_true(is_there(frames, "00020.png"));
    assert_int_equal(empty(frames), 21);
}

/* Live, frames come faster than they can be drawn: time goes on all the same. */
static void a_live_video_keeps_time(void **state)
{
    (void)state;
    stage s;
    error err = {""};
    const video_file file = {frames, true};
    open_stage(&s, &file, 1, VIDEO_LIVE, 512);
    for (int i = 0; i < 60; ++i)
        assert_int_equal(video_add(s.video, &s.shape, &s.order, &err), MRT_OK);
    assert_int_equal(video_finish(s.video, &err), MRT_OK);
    video_report report = video_reported(s.video);
    assert_int_equal(report.picture_count, 60);
    assert_true(report.repeated_count > 0 && report.repeated_count < 60);
    close_stage(&s);
    assert_int_equal(empty(frames), 61);
}

/* The folder goes away beneath it. */
static void lose_folder(stage *s)
{
    const int64_t until_ns = clock_now_ns() + 60 * NS_PER_S;
    error err = {""};
    (void)empty(frames);
    assert_false(is_there(frames, ""));
    while (!video_has_failed(s->video, &err) && clock_now_ns() < until_ns)
        if (video_add(s->video, &s->shape, &s->order, &err) < 0)
            break;
    assert_true(video_has_failed(s->video, &err));
    assert_non_null(strstr(err.text, "frames/00001.png: cannot write"));
}

static void a_failure_ends_what_waits_for_pictures(void **state)
{
    (void)state;
    stage s;
    error err = {""};
    const video_file file = {frames, true};
    open_stage(&s, &file, 1, VIDEO_EVERY_FRAME, SIDE);
    lose_folder(&s);
    assert_int_equal(video_add(s.video, &s.shape, &s.order, &err), MRT_ERR_IO);
    assert_non_null(strstr(err.text, "cannot write"));
    close_stage(&s);
}

static void a_failure_does_not_end_what_is_live(void **state)
{
    (void)state;
    stage s;
    error err = {""};
    const video_file file = {frames, true};
    open_stage(&s, &file, 1, VIDEO_LIVE, SIDE);
    lose_folder(&s);
    for (int i = 0; i < 10; ++i)
        assert_int_equal(video_add(s.video, &s.shape, &s.order, &err), MRT_OK);
    assert_int_equal(video_finish(s.video, &err), MRT_ERR_IO);
    assert_non_null(strstr(err.text, "cannot write"));
    close_stage(&s);
}

static void no_frame_is_no_video(void **state)
{
    (void)state;
    stage s;
    error err = {""};
    const video_file file = {frames, true};
    open_stage(&s, &file, 1, VIDEO_EVERY_FRAME, SIDE);
    assert_int_equal(video_finish(s.video, &err), MRT_ERR_FORMAT);
    assert_non_null(strstr(err.text, "no frame"));
    close_stage(&s);
    assert_false(is_there(frames, ""));
}

static void a_video_that_is_not_finished_is_removed(void **state)
{
    (void)state;
    stage s;
    error err = {""};
    const video_file file = {frames, true};
    open_stage(&s, &file, 1, VIDEO_EVERY_FRAME, SIDE);
    for (int i = 0; i < 9; ++i)
        assert_int_equal(video_add(s.video, &s.shape, &s.order, &err), MRT_OK);
    close_stage(&s);
    assert_false(is_there(frames, ""));
}

/* ---- ffmpeg ---- */

static void write_movie(const char *timecode, timecode_rate rate)
{
    error err = {""};
    video_ffmpeg *encoder = NULL;
    const video_ffmpeg_about of = {
        .width = SIDE, .height = SIDE, .rate = rate, .timecode = timecode};
    if (video_ffmpeg_check(movie, &err) != MRT_OK)
        skip();
    assert_int_equal(video_ffmpeg_open(&encoder, movie, &of, &err), MRT_OK);
    for (int i = 0; i < 12; ++i)
        assert_int_equal(video_ffmpeg_add(encoder, picture, &err), MRT_OK);
    if (video_ffmpeg_commit(encoder, &err) != MRT_OK)
        fail_msg("%s", err.text);
}

static bool movie_has(const char *word)
{
    file_bytes bytes;
    error err;
    bool has = false;
    assert_int_equal(file_read(&bytes, movie, 1 << 24, &err), MRT_OK);
    for (size_t i = 0; i + 4 <= bytes.size; ++i)
        has = has || memcmp(bytes.data + i, word, 4) == 0;
    file_bytes_finish(&bytes);
    return has;
}

/* Rates that have no time code are no reason to fail. */
static void every_rate_can_be_written(void **state)
{
    (void)state;
    static const timecode_rate odd[] = {
        {1, 1, false}, {12, 1, false}, {25, 2, false}, {1000, 1, false}, {1000, 7, false}};
    static const timecode_rate coded[] = {
        {24, 1, false}, {24000, 1001, false}, {60, 1, false}, {120, 1, false}};
    for (size_t i = 0; i < sizeof odd / sizeof *odd; ++i)
        write_movie("01:00:00:00", odd[i]);
    for (size_t i = 0; i < sizeof coded / sizeof *coded; ++i) {
        write_movie("01:00:00:00", coded[i]);
        assert_true(movie_has("tmcd"));
    }
    write_movie("01:00:00;00", (timecode_rate){30000, 1001, true});
    assert_true(movie_has("tmcd"));
    write_movie("-00:00:01:00", film);
    write_movie("99:00:00:00", film);
    assert_int_equal(unlink(movie), 0);
}

static void sound_comes_to_a_movie_that_is_there(void **state)
{
    (void)state;
    error err = {""};
    static uint8_t sound[44 + 24000];
    static const uint8_t header[44] =
        "RIFF\xe4\x5d\0\0WAVEfmt \x10\0\0\0\1\0\1\0\x80\xbb\0\0\0\x77\1\0"
        "\2\0\x10\0data\xc0\x5d\0";
    char wav[128];
    (void)snprintf(wav, sizeof wav, "%s/-voice: 1.wav", scratch);
    memcpy(sound, header, sizeof header);
    for (size_t i = sizeof header; i < sizeof sound; ++i)
        sound[i] = (uint8_t)(i * 37 % 16);
    assert_int_equal(file_write(wav, sound, sizeof sound, &err), MRT_OK);
    write_movie("", film);
    assert_false(movie_has("mp4a"));
    if (video_ffmpeg_add_sound(movie, wav, &err) != MRT_OK)
        fail_msg("%s", err.text);
    assert_true(movie_has("mp4a"));
    assert_true(movie_has("avc1"));
    (void)unlink(wav);
    assert_int_equal(video_ffmpeg_add_sound(movie, wav, &err), MRT_ERR_IO);
    assert_true(movie_has("mp4a")); /* it is as it was */
    assert_int_equal(unlink(movie), 0);
}

/* ---- stand-ins for ffmpeg: what an encoder may do ---- */

/* Programs of this name come first from now on. `script` has the file to write as $out. */
static void begin_stand_in(const char *script)
{
    char folder[128], path[160], text[1024], search[4096];
    error err = {""};
    (void)snprintf(folder, sizeof folder, "%s/bin", scratch);
    (void)snprintf(path, sizeof path, "%s/ffmpeg", folder);
    (void)snprintf(text, sizeof text, "#!/bin/sh\nfor out; do :; done\nout=${out#file:}\n%s\n",
                   script);
    (void)snprintf(search, sizeof search, "%s:%s", folder, usual_path);
    assert_int_equal(mkdir(folder, 0777), 0);
    assert_int_equal(file_write(path, text, strlen(text), &err), MRT_OK);
    assert_int_equal(chmod(path, 0755), 0);
    assert_int_equal(setenv("PATH", search, 1), 0);
}

/* Nothing but the stand-in is left. */
static void end_stand_in(void)
{
    assert_int_equal(setenv("PATH", usual_path, 1), 0);
    assert_int_equal(empty(in_folder(scratch, "/bin")), 1);
    assert_int_equal(empty(scratch), 0);
    assert_int_equal(mkdir(scratch, 0700), 0);
}

static const video_ffmpeg_about small_film = {
    .width = SIDE, .height = SIDE, .rate = {24, 1, false}, .timecode = ""};

/* The result of an export of so many pictures. */
static mrt_result encode_to(const char *path, const video_ffmpeg_about *of, uint32_t count,
                            error *err)
{
    video_ffmpeg *encoder = NULL;
    mrt_result result = video_ffmpeg_open(&encoder, path, of, err);
    for (uint32_t i = 0; i < count && result >= 0; ++i)
        result = video_ffmpeg_add(encoder, picture, err);
    if (result >= 0)
        return video_ffmpeg_commit(encoder, err);
    video_ffmpeg_abandon(encoder);
    return result;
}

static mrt_result encode(const video_ffmpeg_about *of, uint32_t count, error *err)
{
    return encode_to(movie, of, count, err);
}

static void half_a_file_is_none_whatever_the_encoder_returns(void **state)
{
    (void)state;
    error err = {""};
    begin_stand_in("cat >/dev/null; head -c 9999 /dev/zero >\"$out\"; exit 0");
    assert_int_equal(encode(&small_film, 5, &err), MRT_ERR_IO);
    assert_non_null(strstr(err.text, movie));
    assert_non_null(strstr(err.text, "ffmpeg did not finish the file"));
    assert_false(is_there(scratch, "/movie.mp4"));
    end_stand_in();
}

static void a_full_disk_is_named_by_its_folder(void **state)
{
    (void)state;
    error err = {""};
    char words[256];
    (void)snprintf(words, sizeof words, "%s: no space is left in %s/", movie, scratch);
    begin_stand_in("cat >/dev/null; head -c 9999 /dev/zero >\"$out\"\n"
                   "echo \"Error writing trailer of file:$out: No space left on device\" >&2\n"
                   "echo \"Error closing file\" >&2\n"
                   "exit 0");
    assert_int_equal(encode(&small_film, 5, &err), MRT_ERR_IO);
    assert_non_null(strstr(err.text, words));
    assert_non_null(strstr(err.text, "another folder"));
    assert_false(is_there(scratch, "/movie.mp4"));
    end_stand_in();
}

/* It takes nothing, or everything and does not end. */
static void an_encoder_that_stands_still_is_ended(void **state)
{
    (void)state;
    static const char *const scripts[] = {"exec sleep 1000", "cat >/dev/null; exec sleep 1000"};
    video_ffmpeg_about impatient = small_film;
    impatient.patience_ns = 200 * NS_PER_MS;
    for (size_t i = 0; i < sizeof scripts / sizeof *scripts; ++i) {
        error err = {""};
        begin_stand_in(scripts[i]);
        assert_int_equal(encode(&impatient, 30, &err), MRT_ERR_IO);
        assert_non_null(strstr(err.text, movie));
        assert_non_null(strstr(err.text, "ffmpeg stood still"));
        end_stand_in();
    }
}

/* A picture may take longer than the patience, as long as the encoder computes. */
static void an_encoder_that_computes_does_not_stand_still(void **state)
{
    (void)state;
    error err = {""};
    video_ffmpeg_about impatient = small_film;
    impatient.patience_ns = 600 * NS_PER_MS;
    begin_stand_in("end=$(($(date +%s%N) + 1500000000))\n"
                   "while [ $(date +%s%N) -lt $end ]; do i=0; while [ $i -lt 9999 ]; do "
                   "i=$((i+1)); done; done\n"
                   "cat >/dev/null; echo bored >&2; exit 3");
    assert_int_equal(encode(&impatient, 30, &err), MRT_ERR_IO);
    assert_non_null(strstr(err.text, "ffmpeg failed after 30 frames: bored"));
    end_stand_in();
}

static void a_receiver_that_does_not_come_ends_an_export(void **state)
{
    (void)state;
    error err = {""};
    video_ffmpeg_about impatient = small_film;
    impatient.patience_ns = 200 * NS_PER_MS;
    begin_stand_in("while :; do :; done"); /* whatever it computes while it waits */
    assert_int_equal(encode_to("srt://127.0.0.1:9?mode=listener", &impatient, 30, &err),
                     MRT_ERR_IO);
    assert_non_null(strstr(err.text, "srt://127.0.0.1:9?mode=listener: ffmpeg stood still"));
    assert_non_null(strstr(err.text, "start the receiver"));
    end_stand_in();
}

static void a_caller_that_gives_up_does_not_wait_for_the_encoder(void **state)
{
    (void)state;
    static const char *const scripts[] = {"exec sleep 1000", "cat >/dev/null; exec sleep 1000"};
    static const _Atomic bool gives_up = true;
    video_ffmpeg_about given_up = small_film; /* with the usual patience */
    given_up.gives_up = &gives_up;
    for (size_t i = 0; i < sizeof scripts / sizeof *scripts; ++i) {
        error err = {""};
        begin_stand_in(scripts[i]);
        assert_int_equal(encode(&given_up, 30, &err), MRT_ERR_IO);
        assert_non_null(strstr(err.text, "stopped at frame"));
        end_stand_in();
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sizes_are_two_numbers),
        cmocka_unit_test(grounds_are_colours_or_nothing),
        cmocka_unit_test(an_mp4_is_even_and_opaque),
        cmocka_unit_test(every_view_shows_the_whole_head),
        cmocka_unit_test(a_mirror_changes_sides),
        cmocka_unit_test(pictures_come_when_all_are_there),
        cmocka_unit_test(what_is_given_up_leaves_nothing),
        cmocka_unit_test(a_shorter_sequence_replaces_a_longer_one),
        cmocka_unit_test(pictures_of_others_are_never_touched),
        cmocka_unit_test(a_move_that_ended_midway_can_be_done_again),
        cmocka_unit_test(places_where_no_folder_can_be_are_said),
        cmocka_unit_test(every_frame_becomes_a_picture),
        cmocka_unit_test(a_live_video_keeps_time),
        cmocka_unit_test(a_failure_ends_what_waits_for_pictures),
        cmocka_unit_test(a_failure_does_not_end_what_is_live),
        cmocka_unit_test(no_frame_is_no_video),
        cmocka_unit_test(a_video_that_is_not_finished_is_removed),
        cmocka_unit_test(every_rate_can_be_written),
        cmocka_unit_test(sound_comes_to_a_movie_that_is_there),
        cmocka_unit_test(half_a_file_is_none_whatever_the_encoder_returns),
        cmocka_unit_test(a_full_disk_is_named_by_its_folder),
        cmocka_unit_test(an_encoder_that_stands_still_is_ended),
        cmocka_unit_test(an_encoder_that_computes_does_not_stand_still),
        cmocka_unit_test(a_receiver_that_does_not_come_ends_an_export),
        cmocka_unit_test(a_caller_that_gives_up_does_not_wait_for_the_encoder),
    };
    const char *search = getenv("PATH");
    (void)snprintf(usual_path, sizeof usual_path, "%s", search ? search : "/usr/bin:/bin");
    (void)signal(SIGPIPE, SIG_IGN); /* as the program does */
    error err;
    draw_context *context = draw_context_create(&err);
    can_draw = context != NULL;
    if (!can_draw)
        printf("SKIPPED: what draws: %s\n", err.text);
    draw_context_destroy(context);
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
