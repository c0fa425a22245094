/* What the tests of the show share: a folder of their own, and made-up hands whose every sample is
 * known from its number. */
#ifndef MAROTTE_TESTS_SHOW_SCENE_H
#define MAROTTE_TESTS_SHOW_SCENE_H
#include "base/clock.h"
#include "show/show.h"
#include "show/writer.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { SCENE_PATH = 512, SCENE_CHANNELS = 22 };
/* The session's clocks: host clock 0 is this UTC. */
static const int64_t scene_utc_ns = 1780000000000000000;
static const int64_t scene_step_ns = 6666667; /* 150 Hz */

typedef struct scene {
    char folder[SCENE_PATH / 2], path[SCENE_PATH];
} scene;

static inline void scene_make(scene *out)
{
    const char *temporary = getenv("TMPDIR");
    if (!temporary) /* what waits for a disk need not wait here */
        temporary = access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp";
    snprintf(out->folder, sizeof out->folder, "%s/marotte_show_XXXXXX", temporary);
    assert_non_null(mkdtemp(out->folder));
    snprintf(out->path, sizeof out->path, "%s/test.marotte", out->folder);
}

/* With all that it holds, one level of folders after the other. */
static inline void scene_remove_folder(const char *folder)
{
    char path[2 * SCENE_PATH];
    DIR *list = opendir(folder);
    for (const struct dirent *e; list && (e = readdir(list));) {
        if (strcmp(e->d_name, ".") == 0 || strcmp(e->d_name, "..") == 0)
            continue;
        assert_true(snprintf(path, sizeof path, "%s/%s", folder, e->d_name) < (int)sizeof path);
        if (unlink(path) != 0 && (chmod(path, 0700) != 0 || unlink(path) != 0))
            scene_remove_folder(path);
    }
    if (list)
        closedir(list);
    assert_true(rmdir(folder) == 0 || errno == ENOENT);
}

static inline void scene_remove(scene *s)
{
    scene_remove_folder(s->folder);
}

/* Of a test with a folder of its own: its state is the scene. */
static inline int scene_set_up(void **state)
{
    scene *s = calloc(1, sizeof *s);
    scene_make(s);
    *state = s;
    return 0;
}

static inline int scene_tear_down(void **state)
{
    scene_remove(*state);
    free(*state);
    return 0;
}

static inline void scene_must(mrt_result result, const error *err)
{
    if (result < 0)
        fail_msg("%s", err->text);
}

static inline show *scene_create(const scene *s)
{
    error err = {""};
    show *out;
    scene_must(show_create(&out, s->path, &err), &err);
    return out;
}

static inline show *scene_open(const scene *s, show_mode mode)
{
    error err = {""};
    show *out;
    scene_must(show_open(&out, s->path, mode, &err), &err);
    return out;
}

/* SplitMix64 of a number. */
static inline uint64_t scene_random(uint64_t n)
{
    n += 0x9e3779b97f4a7c15u;
    n = (n ^ (n >> 30)) * 0xbf58476d1ce4e5b9u;
    n = (n ^ (n >> 27)) * 0x94d049bb133111ebu;
    return n ^ (n >> 31);
}

/* Sample `n` of a track: counts that wander, times with jitter, a gap in the numbers now and then.
 */
static inline mrt_sample scene_sample(int64_t track, int64_t n)
{
    mrt_sample out = {.count = SCENE_CHANNELS};
    uint64_t random = scene_random((uint64_t)(n * 64 + track));
    out.time_ns = n * scene_step_ns + (int64_t)(random % 1000000);
    out.sequence = (uint32_t)(n + n / 97);
    for (uint32_t c = 0; c < SCENE_CHANNELS; ++c) {
        int64_t wave = (n / 7 + 13 * c + 5 * (uint32_t)track) % 160;
        out.value[c] = (float)(40 + (wave < 80 ? wave : 160 - wave) + (int64_t)(random >> c & 1));
    }
    return out;
}

static inline mrt_sample scene_shown(int64_t track, int64_t n) /* as the show gives it */
{
    mrt_sample out = scene_sample(track, n);
    out.time_ns += scene_utc_ns;
    return out;
}

static inline int scene_is_same(const mrt_sample *a, const mrt_sample *b)
{
    return a->time_ns == b->time_ns && a->sequence == b->sequence && a->count == b->count &&
           memcmp(a->value, b->value, sizeof a->value) == 0;
}

static inline take_track scene_track(char *input)
{
    static char device[] = "CyberGlove 22, right, port 1-2", plugin[] = "org.marotte.test 1.0 00ff";
    static char calibration[] = "{\"marotte_calibration\":1}";
    take_track out = {.input = input,
                      .device = device,
                      .plugin = plugin,
                      .channel_count = SCENE_CHANNELS,
                      .calibration = {NULL, calibration}};
    for (uint32_t c = 0; c < SCENE_CHANNELS; ++c) {
        snprintf(out.channel[c].name, sizeof out.channel[c].name, "sensor %u", c);
        snprintf(out.channel[c].unit, sizeof out.channel[c].unit, "count");
        out.channel[c].semantic = MRT_CH_ANGLE + c;
        out.channel[c].hand = MRT_RIGHT;
        out.channel[c].min = 1;
        out.channel[c].max = 255;
    }
    return out;
}

static inline take_performance scene_performance(int64_t track)
{
    static char mapping[] = "org.marotte.anchored 0.1.0 abcd", rig[] = "rigs/moai/moai.glb";
    take_performance out = {.mapping = mapping,
                            .rig = rig,
                            .rig_hash = "11",
                            .mesh_hash = "22",
                            .unit_mm = 1.5,
                            .hand_length_mm = 190,
                            .rezero_pedal = 2,
                            .track_count = 1,
                            .param_count = 2};
    out.track[0] = track;
    out.param[0] = (take_param){.id = 3, .value = 0.25};
    out.param[1] = (take_param){.id = 9, .value = -1e300};
    return out;
}

static inline writer_options scene_options(void)
{
    return (writer_options){
        .utc_ns = scene_utc_ns, .program = "test 1", .checkpoint_bytes = 100000};
}

/* A show that is recorded: a writer with a track and a performance of it. */
typedef struct scene_recording {
    show *show;
    writer *writer;
    int64_t track, performance;
} scene_recording;

static inline void scene_record(scene_recording *out, show *s, const writer_options *options)
{
    error err = {""};
    out->show = s;
    scene_must(writer_start(&out->writer, s, options, &err), &err);
    take_track track = scene_track("test:");
    scene_must(writer_add_track(out->writer, &track, &err), &err);
    take_performance performance = scene_performance(track.id);
    scene_must(writer_begin_performance(out->writer, &performance, 0, &err), &err);
    out->track = track.id;
    out->performance = performance.id;
}

static inline void scene_give(scene_recording *r, int64_t from_n, int64_t to_n)
{
    for (int64_t n = from_n; n < to_n; ++n) {
        mrt_sample sample = scene_sample(r->track, n);
        writer_sample(r->writer, r->track, &sample);
    }
}

static inline void scene_flush(scene_recording *r)
{
    error err = {""};
    scene_must(writer_flush(r->writer, &err), &err);
}

static inline void scene_stop(scene_recording *r)
{
    error err = {""};
    scene_must(writer_stop(r->writer, &err), &err);
    r->writer = NULL;
}

/* Samples from_n..to_n - 1 of the track, and no others, are in the reader. */
static inline void scene_expect(show *s, int64_t track, int64_t from_n, int64_t to_n)
{
    error err = {""};
    show_reader *reader;
    mrt_sample got;
    scene_must(show_reader_open(&reader, s, track, INT64_MIN, INT64_MAX, &err), &err);
    for (int64_t n = from_n; n < to_n; ++n) {
        mrt_sample expected = scene_shown(track, n);
        mrt_result result = show_reader_next(reader, &got, &err);
        if (result != MRT_OK)
            fail_msg("sample %lld: %d %s", (long long)n, result, err.text);
        if (!scene_is_same(&got, &expected))
            fail_msg("sample %lld differs: %lld ns number %u instead of %lld ns number %u",
                     (long long)n, (long long)got.time_ns, got.sequence,
                     (long long)expected.time_ns, expected.sequence);
    }
    assert_int_equal(show_reader_next(reader, &got, &err), MRT_END);
    show_reader_close(reader);
}

#endif
