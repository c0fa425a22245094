/* Bytes that change on the disk: a message or the right data, never wrong samples, never a crash;
 * and what can be read is brought into a new show. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/file.h"
#include "take/show_scene.h"

enum { SAMPLES = 6000, PAGE_BYTES = 4096, FLIPS_A_PAGE = 2, FLIPS_A_PAGE_LONG = 4 };

typedef struct whole { /* a show with something in every table, closed */
    scene scene;
    char copy[SCENE_PATH], out[SCENE_PATH];
    file_bytes file;
    int64_t track, performance, take, audio;
} whole;

static void record_everything(whole *w)
{
    error err = {""};
    scene_recording r;
    show *s;
    writer_options options = scene_options();
    scene_must(show_create(&s, w->scene.path, &err), &err);
    scene_record(&r, s, &options);
    w->track = r.track;
    w->performance = r.performance;
    scene_must(writer_take_begin(r.writer, 0, &(writer_slate){.scene = "1"}, &w->take, &err), &err);
    for (int64_t n = 0; n < SAMPLES; n += 500) {
        scene_give(&r, n, n + 500);
        scene_must(writer_mark(r.writer, n * scene_step_ns, "a mark", &err), &err);
        uint8_t *buffer = writer_checkpoint_buffer(r.writer);
        assert_non_null(buffer);
        for (size_t i = 0; i < 20000; ++i)
            buffer[i] = (uint8_t)scene_random(i);
        writer_checkpoint(r.writer, r.performance, n * scene_step_ns, 1, buffer, 20000);
        scene_flush(&r);
    }
    scene_stop(&r);
    for (int i = 0; i < 200; ++i)
        scene_must(show_edit_append(s, w->take, "{\"op\":\"take.rename\",\"name\":\"again\"}", i,
                                    NULL, 0, &err),
                   &err);
    show_audio audio = {.name = "voice", .rate_hz = 48000, .channel_count = 1, .format = "s16"};
    scene_must(show_audio_create(s, &audio, &w->audio, &err), &err);
    uint8_t sound[9000];
    for (size_t i = 0; i < sizeof sound; ++i)
        sound[i] = (uint8_t)scene_random(i);
    for (int i = 0; i < 4; ++i)
        scene_must(show_audio_write(s, w->audio, 1, sound, sizeof sound, &err), &err);
    show_close(s);
}

static int set_up(void **state)
{
    error err = {""};
    whole *w = calloc(1, sizeof *w);
    scene_make(&w->scene);
    snprintf(w->copy, sizeof w->copy, "%s/copy.marotte", w->scene.folder);
    snprintf(w->out, sizeof w->out, "%s/out.marotte", w->scene.folder);
    record_everything(w);
    scene_must(file_read(&w->file, w->scene.path, 1 << 26, &err), &err);
    *state = w;
    return 0;
}

static int tear_down(void **state)
{
    whole *w = *state;
    file_bytes_finish(&w->file);
    scene_remove(&w->scene);
    free(w);
    return 0;
}

static void write_copy(const whole *w, size_t size)
{
    FILE *file = fopen(w->copy, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(w->file.data, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

/* What was read of a damaged show. */
typedef struct outcome {
    int64_t right; /* samples */
    int messages;
} outcome;

static void note(outcome *out, mrt_result result, error *err)
{
    if (result < 0) {
        assert_true(strlen(err->text) > 0);
        ++out->messages;
        err->text[0] = '\0';
    }
}

/* Samples come in order, each as it was given; what is left out is said. */
static void read_samples(const whole *w, show *s, outcome *out)
{
    error err = {""};
    show_reader *reader;
    mrt_sample got;
    mrt_result result = show_reader_open(&reader, s, w->track, INT64_MIN, INT64_MAX, &err);
    note(out, result, &err);
    if (result < 0)
        return;
    int64_t n = 0;
    for (int step = 0; step < SAMPLES + 1000; ++step) {
        result = show_reader_next(reader, &got, &err);
        if (result == MRT_END)
            break;
        note(out, result, &err);
        if (result < 0)
            continue;
        while (n < SAMPLES && scene_shown(w->track, n).time_ns < got.time_ns)
            ++n;
        mrt_sample expected = scene_shown(w->track, n++);
        if (!scene_is_same(&got, &expected))
            fail_msg("sample %lld is wrong", (long long)n - 1);
        ++out->right;
    }
    assert_int_equal(result, MRT_END);
    show_reader_close(reader);
    if (out->right < SAMPLES && out->messages == 0)
        fail_msg("%lld samples are missing in silence", (long long)(SAMPLES - out->right));
}

static void read_the_rest(const whole *w, show *s, outcome *out)
{
    error err = {""};
    size_t count;
    show_take *takes;
    note(out, show_takes(s, &takes, &count, &err), &err);
    for (size_t i = 0; i < count; ++i) {
        take base;
        show_edits edits;
        mrt_result result = show_take_base(s, takes[i].id, &base, &err);
        note(out, result, &err);
        if (result >= 0)
            take_finish(&base);
        result = show_edits_read(s, takes[i].id, &edits, &err);
        note(out, result, &err);
        if (result >= 0)
            show_edits_finish(&edits);
    }
    free(takes);
    take_event *events;
    note(out, show_events(s, INT64_MIN, INT64_MAX, &events, &count, &err), &err);
    free(events);
    show_track track;
    mrt_result result = show_track_read(s, w->track, &track, &err);
    note(out, result, &err);
    show_track_finish(&track);
    show_performance performance;
    result = show_performance_read(s, w->performance, &performance, &err);
    note(out, result, &err);
    show_performance_finish(&performance);
    for (int64_t n = 0; n < SAMPLES; n += 500) {
        show_checkpoint checkpoint;
        result = show_checkpoint_before(s, w->performance, scene_utc_ns + n * scene_step_ns, 0,
                                        &checkpoint, &err);
        note(out, result, &err);
        if (result >= 0 && checkpoint.bytes) {
            assert_int_equal(checkpoint.size, 20000);
            for (size_t i = 0; i < checkpoint.size; ++i)
                assert_int_equal(((uint8_t *)checkpoint.bytes)[i], (uint8_t)scene_random(i));
        }
        show_checkpoint_finish(&checkpoint);
    }
    static uint8_t sound[40000];
    size_t size;
    note(out, show_audio_read(s, w->audio, 0, sound, sizeof sound, &size, &err), &err);
    for (size_t i = 0; i < size; ++i)
        assert_int_equal(sound[i], (uint8_t)scene_random(i % 9000));
}

/* A check finds whatever reading finds. */
static void check_finds_it_too(show *s, const outcome *read)
{
    error err = {""};
    mrt_result result = show_check(s, &err);
    if (read->messages > 0)
        assert_true(result < 0 && strlen(err.text) > 0);
}

static outcome read_copy(const whole *w, show_mode mode)
{
    error err = {""};
    show *s;
    outcome out = {0};
    mrt_result result = show_open(&s, w->copy, mode, &err);
    note(&out, result, &err);
    if (result < 0)
        return out;
    read_samples(w, s, &out);
    read_the_rest(w, s, &out);
    check_finds_it_too(s, &out);
    show_close(s);
    return out;
}

static size_t flipped_byte(size_t page, uint64_t flip)
{
    static const size_t first[] = {0, 5}; /* the kind of the page; how many cells it has */
    size_t within = flip < 2 ? first[flip] : scene_random(page * 64 + flip) % PAGE_BYTES;
    return page * PAGE_BYTES + within + (page == 0 && within < 100 && flip == 1 ? 100 : 0);
}

static void flip(whole *w, size_t page, uint64_t which)
{
    w->file.data[flipped_byte(page, which)] ^= (uint8_t)(1u << (page + which) % 8);
}

static void an_undamaged_show_reads_without_a_word(void **state)
{
    whole *w = *state;
    write_copy(w, w->file.size);
    outcome out = read_copy(w, SHOW_READ);
    assert_int_equal(out.messages, 0);
    assert_int_equal(out.right, SAMPLES);
    error err = {""};
    show *s;
    scene_must(show_open(&s, w->copy, SHOW_READ, &err), &err);
    scene_must(show_check(s, &err), &err);
    show_close(s);
    assert_true(w->file.size / PAGE_BYTES > 60);
}

static void any_flipped_byte_gives_a_message_or_the_right_samples(void **state)
{
    whole *w = *state;
    const uint64_t flips = getenv("MAROTTE_TEST_LONG") ? FLIPS_A_PAGE_LONG : FLIPS_A_PAGE;
    int64_t said = 0, count = 0;
    for (size_t page = 0; page < w->file.size / PAGE_BYTES; ++page)
        for (uint64_t which = 0; which < flips; ++which) {
            flip(w, page, which);
            write_copy(w, w->file.size);
            said += read_copy(w, which & 1 ? SHOW_WRITE : SHOW_READ).messages > 0;
            ++count;
            flip(w, page, which);
        }
    assert_true(said > count / 4);
}

static void any_cut_gives_a_message_or_the_right_samples(void **state)
{
    whole *w = *state;
    for (int i = 0; i < 60; ++i) {
        size_t size = 1 + (size_t)(scene_random((uint64_t)i) % (w->file.size - 1));
        write_copy(w, i % 3 ? size : size / PAGE_BYTES * PAGE_BYTES);
        outcome out = read_copy(w, i & 1 ? SHOW_WRITE : SHOW_READ);
        assert_true(out.messages > 0);
    }
}

/* ---- recovery ---- */

static int64_t recovered_samples(const whole *w, int *out_messages)
{
    error err = {""};
    show *s;
    outcome out = {0};
    scene_must(show_open(&s, w->out, SHOW_WRITE, &err), &err);
    assert_true(show_is_writable(s));
    read_samples(w, s, &out);
    read_the_rest(w, s, &out);
    show_close(s);
    *out_messages = out.messages;
    return out.right;
}

static bool is_unchanged(const whole *w)
{
    error err = {""};
    file_bytes now;
    scene_must(file_read(&now, w->copy, 1 << 26, &err), &err);
    bool same = now.size == w->file.size && memcmp(now.data, w->file.data, now.size) == 0;
    file_bytes_finish(&now);
    return same;
}

static void a_whole_show_recovers_whole(void **state)
{
    whole *w = *state;
    error err = {""};
    show_recovery got;
    int messages;
    write_copy(w, w->file.size);
    scene_must(show_recover(&got, w->copy, w->out, &err), &err);
    assert_int_equal(got.damaged_count, 0);
    assert_true(got.row_count > 250);
    assert_int_equal(recovered_samples(w, &messages), SAMPLES);
    assert_int_equal(messages, 0);
    assert_int_equal(show_recover(&got, w->copy, w->out, &err), MRT_ERR_IO); /* it is there */
    assert_true(is_unchanged(w));
}

/* One page of zeros, anywhere: nearly all samples come back, and the damaged file stays as it is.
 */
static void a_lost_page_costs_little(void **state)
{
    whole *w = *state;
    error err = {""};
    uint8_t page[PAGE_BYTES];
    for (size_t at = 0; at < w->file.size; at += PAGE_BYTES) {
        show_recovery got;
        int messages;
        memcpy(page, w->file.data + at, PAGE_BYTES);
        memset(w->file.data + at, 0, PAGE_BYTES);
        write_copy(w, w->file.size);
        mrt_result result = show_recover(&got, w->copy, w->out, &err);
        if (result < 0)
            fail_msg("page %zu: %s", at / PAGE_BYTES + 1, err.text);
        int64_t right = recovered_samples(w, &messages);
        if (right < SAMPLES - 6 * 150)
            fail_msg("page %zu: only %lld samples", at / PAGE_BYTES + 1, (long long)right);
        assert_true(is_unchanged(w));
        unlink(w->out);
        memcpy(w->file.data + at, page, PAGE_BYTES);
    }
}

static void half_a_show_recovers_by_half(void **state)
{
    whole *w = *state;
    error err = {""};
    show_recovery got;
    int messages;
    write_copy(w, w->file.size * 2 / 3 / PAGE_BYTES * PAGE_BYTES);
    scene_must(show_recover(&got, w->copy, w->out, &err), &err);
    assert_true(recovered_samples(w, &messages) > SAMPLES / 4);
    assert_true(messages > 0);
}

static void what_is_no_show_does_not_recover(void **state)
{
    whole *w = *state;
    error err = {""};
    show_recovery got;
    struct stat status;
    for (size_t i = 0; i < w->file.size; ++i)
        w->file.data[i] = (uint8_t)scene_random(i);
    write_copy(w, w->file.size);
    assert_true(show_recover(&got, w->copy, w->out, &err) < 0);
    assert_true(strlen(err.text) > 0);
    assert_int_equal(stat(w->out, &status), -1);
    assert_int_equal(show_recover(&got, w->scene.folder, w->out, &err), MRT_ERR_IO);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(an_undamaged_show_reads_without_a_word),
        TEST(any_flipped_byte_gives_a_message_or_the_right_samples),
        TEST(any_cut_gives_a_message_or_the_right_samples),
        TEST(a_whole_show_recovers_whole),
        TEST(a_lost_page_costs_little),
        TEST(half_a_show_recovers_by_half),
        TEST(what_is_no_show_does_not_recover),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
