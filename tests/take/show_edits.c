/* core/show/show.h: takes that were made, their edits as rows, and audio. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "show/hash.h"
#include "take/show_scene.h"

#include "show/edit_store.h"

#include <sqlite3.h>

typedef struct opened {
    scene scene;
    show *show;
    int64_t take;
} opened;

static int set_up(void **state)
{
    error err = {""};
    opened *o = calloc(1, sizeof *o);
    scene_make(&o->scene);
    scene_must(show_create(&o->show, o->scene.path, &err), &err);
    const char *base[] = {"{\"base\":1}", "{\"base\":2}"};
    show_new_take made = {.created_ns = 5,
                          .start_ns = 100,
                          .end_ns = 900,
                          .scene = "4",
                          .shot = "C",
                          .origin = "take 3 through anchored",
                          .number = 12,
                          .base_edits = base,
                          .base_edit_count = 2,
                          .utc_ms = 77};
    scene_must(show_take_create(o->show, &made, &o->take, &err), &err);
    *state = o;
    return 0;
}

static int tear_down(void **state)
{
    opened *o = *state;
    show_close(o->show);
    scene_remove(&o->scene);
    free(o);
    return 0;
}

static void reopen(opened *o)
{
    error err = {""};
    show_close(o->show);
    scene_must(show_open(&o->show, o->scene.path, SHOW_WRITE, &err), &err);
}

static void append(opened *o, const char *json)
{
    error err = {""};
    scene_must(show_edit_append(o->show, o->take, json, 1000, NULL, 0, &err), &err);
}

/* The edits' texts, joined, and the head. */
static void expect_edits(opened *o, const char *texts, int32_t head)
{
    error err = {""};
    show_edits edits;
    char joined[200] = "";
    scene_must(show_edits_read(o->show, o->take, &edits, &err), &err);
    for (size_t i = 0; i < edits.count; ++i) {
        assert_int_equal(edits.edit[i].n, (int32_t)i - 1); /* two base edits: -1, 0 */
        strcat(joined, edits.edit[i].json);
    }
    assert_string_equal(joined, texts);
    assert_int_equal(edits.head, head);
    show_edits_finish(&edits);
}

static void a_take_that_was_made_comes_back(void **state)
{
    opened *o = *state;
    error err = {""};
    show_take got;
    reopen(o);
    scene_must(show_take_read(o->show, o->take, &got, &err), &err);
    assert_int_equal(got.created_ns, 5);
    assert_int_equal(got.start_ns, 100);
    assert_int_equal(got.end_ns, 900);
    assert_int_equal(got.number, 12);
    assert_string_equal(got.origin, "take 3 through anchored");
    assert_int_equal(got.base_edit_count, 2);
    assert_int_equal(got.edit_count, 0);
    assert_false(got.is_recording || got.is_recovered);
    expect_edits(o, "{\"base\":1}{\"base\":2}", 0);
    take base;
    scene_must(show_take_base(o->show, o->take, &base, &err), &err);
    assert_int_equal(base.layer_count, 0); /* its base edits make the layers */
    assert_int_equal(base.duration_ns, 800);
    take_finish(&base);
    assert_int_equal(show_take_read(o->show, 99, &got, &err), MRT_ERR_ARGUMENT);
    assert_non_null(strstr(err.text, "no take 99"));
}

static void undo_and_redo_survive_closing(void **state)
{
    opened *o = *state;
    error err = {""};
    append(o, "a");
    append(o, "b");
    append(o, "c");
    expect_edits(o, "{\"base\":1}{\"base\":2}abc", 3);
    scene_must(show_edit_head(o->show, o->take, 1, &err), &err);
    reopen(o);
    expect_edits(o, "{\"base\":1}{\"base\":2}abc", 1);
    scene_must(show_edit_head(o->show, o->take, 3, &err), &err);
    reopen(o);
    expect_edits(o, "{\"base\":1}{\"base\":2}abc", 3);
    assert_int_equal(show_edit_head(o->show, o->take, 4, &err), MRT_ERR_ARGUMENT);
    assert_int_equal(show_edit_head(o->show, o->take, -1, &err), MRT_ERR_ARGUMENT);
    assert_int_equal(show_edit_head(o->show, 99, 0, &err), MRT_ERR_ARGUMENT);
}

/* By another connection: what is really in the file. */
static int64_t count_rows(opened *o, const char *sql)
{
    sqlite3 *db;
    sqlite3_stmt *row;
    assert_int_equal(sqlite3_open(o->scene.path, &db), SQLITE_OK);
    assert_int_equal(sqlite3_prepare_v2(db, sql, -1, &row, NULL), SQLITE_OK);
    assert_int_equal(sqlite3_step(row), SQLITE_ROW);
    int64_t out = sqlite3_column_int64(row, 0);
    while (sqlite3_step(row) == SQLITE_ROW)
        ;
    sqlite3_finalize(row);
    sqlite3_close(db);
    return out;
}

static void abandoned_edits_stay_as_rows(void **state)
{
    opened *o = *state;
    error err = {""};
    append(o, "a");
    append(o, "b");
    append(o, "c");
    scene_must(show_edit_head(o->show, o->take, 1, &err), &err);
    append(o, "d");
    expect_edits(o, "{\"base\":1}{\"base\":2}ad", 2);
    scene_must(show_edit_head(o->show, o->take, 0, &err), &err);
    append(o, "e");
    expect_edits(o, "{\"base\":1}{\"base\":2}e", 1);
    assert_int_equal(count_rows(o, "SELECT COUNT(*) FROM edit WHERE branch = 0"), 3);
    assert_int_equal(count_rows(o, "SELECT COUNT(*) FROM edit WHERE branch = 1 AND n IN (2, 3)"),
                     2);
    assert_int_equal(count_rows(o, "SELECT COUNT(*) FROM edit WHERE branch = 2 AND n IN (1, 2)"),
                     2);
}

static void an_edit_that_changed_on_the_disk_is_noticed(void **state)
{
    opened *o = *state;
    error err = {""};
    show_edits edits;
    append(o, "abc");
    (void)count_rows(o, "UPDATE edit SET json = 'abd' WHERE n = 1 RETURNING 1");
    assert_int_equal(show_edits_read(o->show, o->take, &edits, &err), MRT_ERR_FORMAT);
    assert_non_null(strstr(err.text, "edit 1 of take 1 is damaged"));
    (void)count_rows(o, "UPDATE edit SET json = 'abc' WHERE n = 1 RETURNING 1");
    (void)count_rows(o, "DELETE FROM edit WHERE n = 0 RETURNING 1");
    assert_int_equal(show_edits_read(o->show, o->take, &edits, &err), MRT_ERR_FORMAT);
    assert_non_null(strstr(err.text, "missing"));
}

/* A file that is damaged may give the second edit without the first. */
static void edits_without_the_first_are_damage(void **state)
{
    opened *o = *state;
    error err = {""};
    show_edits edits;
    take t;
    append(o, "abc");
    append(o, "def");
    (void)count_rows(o, "DELETE FROM edit WHERE n < 2 RETURNING 1");
    assert_int_equal(show_edits_read(o->show, o->take, &edits, &err), MRT_ERR_FORMAT);
    assert_non_null(strstr(err.text, "missing"));
    assert_int_equal(edit_store_take(&t, o->show, o->take, &err), MRT_ERR_FORMAT);
    assert_non_null(strstr(err.text, "missing"));
}

/* ---- audio ---- */

static int64_t create_audio(opened *o, const char *format, uint32_t channels)
{
    error err = {""};
    int64_t id;
    show_audio audio = {
        .name = "voice.wav", .start_ns = 123, .rate_hz = 48000, .channel_count = channels};
    snprintf(audio.format, sizeof audio.format, "%s", format);
    scene_must(show_audio_create(o->show, &audio, &id, &err), &err);
    return id;
}

static void audio_comes_back_in_any_pieces(void **state)
{
    opened *o = *state;
    error err = {""};
    int64_t id = create_audio(o, "s24", 2);
    uint8_t bytes[6000], got[6000];
    for (size_t i = 0; i < sizeof bytes; ++i)
        bytes[i] = (uint8_t)scene_random(i);
    for (size_t at = 0, piece = 6; at < sizeof bytes; at += piece, piece = 6 + piece * 2) {
        if (piece > sizeof bytes - at)
            piece = sizeof bytes - at;
        scene_must(show_audio_write(o->show, id, (int64_t)at, bytes + at, piece, &err), &err);
    }
    show_audio info;
    scene_must(show_audio_info(o->show, id, &info, &err), &err);
    assert_int_equal(info.frame_count, 1000);
    assert_int_equal(info.start_ns, 123);
    assert_string_equal(info.format, "s24");
    assert_string_equal(info.name, "voice.wav");
    for (size_t capacity = 6; capacity <= sizeof got; capacity += 791)
        for (int64_t frame = 0; frame < 1000; frame += 97) {
            size_t size, whole = capacity / 6 * 6, left = (size_t)(1000 - frame) * 6;
            scene_must(show_audio_read(o->show, id, frame, got, capacity, &size, &err), &err);
            assert_int_equal(size, whole < left ? whole : left);
            assert_memory_equal(got, bytes + frame * 6, size);
        }
    size_t size;
    scene_must(show_audio_read(o->show, id, 1000, got, sizeof got, &size, &err), &err);
    assert_int_equal(size, 0);
    show_audio_anchor *anchors;
    size_t count;
    scene_must(show_audio_anchors(o->show, id, &anchors, &count, &err), &err);
    assert_true(count > 3);
    for (size_t i = 0; i < count; ++i)
        assert_int_equal(anchors[i].time_ns, anchors[i].frame * 6);
    free(anchors);
    int64_t *ids;
    scene_must(show_audio_ids(o->show, &ids, &count, &err), &err);
    assert_int_equal(count, 1);
    assert_int_equal(ids[0], id);
    free(ids);
}

static void audio_that_makes_no_sense_is_refused(void **state)
{
    opened *o = *state;
    error err = {""};
    int64_t id;
    show_audio bad[] = {{.rate_hz = 0, .channel_count = 1, .format = "s16"},
                        {.rate_hz = 48000, .channel_count = 0, .format = "s16"},
                        {.rate_hz = 48000, .channel_count = 1, .format = "mp3"}};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; ++i)
        assert_int_equal(show_audio_create(o->show, &bad[i], &id, &err), MRT_ERR_ARGUMENT);
    id = create_audio(o, "f32", 1);
    assert_int_equal(show_audio_write(o->show, id, 0, "12345", 5, &err), MRT_ERR_ARGUMENT);
    assert_int_equal(show_audio_write(o->show, id + 1, 0, "1234", 4, &err), MRT_ERR_ARGUMENT);
}

static void audio_that_changed_on_the_disk_is_noticed(void **state)
{
    opened *o = *state;
    error err = {""};
    uint8_t got[64];
    size_t size;
    int64_t id = create_audio(o, "s16", 1);
    for (int i = 0; i < 3; ++i)
        scene_must(show_audio_write(o->show, id, 0, "12345678", 8, &err), &err);
    (void)count_rows(o, "UPDATE audio_chunk SET bytes = x'00' WHERE first_frame = 4 RETURNING 1");
    assert_int_equal(show_audio_read(o->show, id, 0, got, sizeof got, &size, &err), MRT_ERR_FORMAT);
    assert_non_null(strstr(err.text, "frame 4"));
    assert_int_equal(size, 8); /* what came before */
    (void)count_rows(o, "DELETE FROM audio_chunk WHERE first_frame = 4 RETURNING 1");
    assert_int_equal(show_audio_read(o->show, id, 0, got, sizeof got, &size, &err), MRT_ERR_FORMAT);
}

/* ---- hashes ---- */

static void hashes_are_sha_256(void **state)
{
    opened *o = *state;
    error err = {""};
    char hash[TAKE_HASH], path[SCENE_PATH];
    hash_bytes(hash, "abc", 3); /* FIPS 180-4, example */
    assert_string_equal(hash, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    hash_bytes(hash, "", 0);
    assert_string_equal(hash, "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    snprintf(path, sizeof path, "%s/abc", o->scene.folder);
    FILE *file = fopen(path, "wb");
    fputs("abc", file);
    fclose(file);
    scene_must(hash_file(hash, path, &err), &err);
    assert_string_equal(hash, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    assert_int_equal(hash_file(hash, o->scene.folder, &err), MRT_ERR_IO);
    assert_int_equal(hash_file(hash, "/nowhere/at/all", &err), MRT_ERR_IO);
    assert_non_null(strstr(err.text, "/nowhere/at/all"));
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(a_take_that_was_made_comes_back),
        TEST(undo_and_redo_survive_closing),
        TEST(abandoned_edits_stay_as_rows),
        TEST(an_edit_that_changed_on_the_disk_is_noticed),
        TEST(edits_without_the_first_are_damage),
        TEST(audio_comes_back_in_any_pieces),
        TEST(audio_that_makes_no_sense_is_refused),
        TEST(audio_that_changed_on_the_disk_is_noticed),
        TEST(hashes_are_sha_256),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
