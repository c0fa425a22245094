/* A show is only data, whoever made it: whatever is in it or lies beside it, nothing else is
 * touched, nothing in it runs, everything ends, and nothing of it steers a terminal. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/text.h"
#include "show/edit_store.h"
#include "show/show_file.h"
#include "take/show_disk.h"
#include "take/show_scene.h"

#include <fcntl.h>

static int tear_down(void **state)
{
    atomic_store(&disk_answer, SQLITE_OK);
    return scene_tear_down(state);
}

static void run_sql(const char *path, const char *sql)
{
    sqlite3 *db;
    char *message = NULL;
    assert_int_equal(sqlite3_open(path, &db), SQLITE_OK);
    if (sqlite3_exec(db, sql, NULL, NULL, &message) != SQLITE_OK)
        fail_msg("%s", message);
    assert_int_equal(sqlite3_close(db), SQLITE_OK);
}

static void write_file(const char *path, const void *bytes, size_t size)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

static void expect_file(const char *path, const char *text)
{
    char found[64] = "";
    FILE *file = fopen(path, "rb");
    if (!file)
        fail_msg("%s is gone", path);
    (void)!fread(found, 1, sizeof found - 1, file);
    assert_int_equal(fclose(file), 0);
    assert_string_equal(found, text);
}

static void beside(const scene *s, const char *name, char out[SCENE_PATH])
{
    snprintf(out, SCENE_PATH, "%s/%s", s->folder, name);
}

/* A closed show with 2000 samples of one track, a checkpoint, a mark, and a take of them. */
static int64_t record_some(const char *path)
{
    error err = {""};
    show *s;
    scene_recording r;
    int64_t take_id;
    writer_options options = scene_options();
    scene_must(show_create(&s, path, &err), &err);
    scene_record(&r, s, &options);
    scene_must(writer_take_begin(r.writer, 0, &(writer_slate){.scene = "1"}, &take_id, &err), &err);
    scene_give(&r, 0, 2000);
    void *state = writer_checkpoint_buffer(r.writer);
    memset(state, 7, 5000);
    writer_checkpoint(r.writer, r.performance, 3, 1, state, 5000);
    scene_must(writer_mark(r.writer, 5, "mark", &err), &err);
    scene_stop(&r);
    show_close(s);
    return r.track;
}

/* ---- files ---- */

/* A journal of a transaction over several files names the file that lists them, at its end:
 * sqlite.org/fileformat2.html, section 3. When that one is deleted the transaction is done. */
static void write_journal(const char *path, const char *super)
{
    unsigned char bytes[512 + SCENE_PATH + 20] = {0xd9, 0xd5, 0x05, 0xf9, 0x20, 0xa1, 0x63, 0xd7};
    bytes[22] = 2, bytes[26] = 16; /* pages of 512 before, sectors of 4096 */
    bytes[19] = 1;
    size_t at = 512, length = strlen(super);
    uint32_t sum = 0;
    bytes[at + 3] = 2; /* no page's number */
    memcpy(bytes + at + 4, super, length);
    for (size_t i = 0; i < length; ++i)
        sum += (unsigned char)super[i];
    at += 4 + length;
    for (int i = 0; i < 4; ++i) {
        bytes[at + (size_t)i] = (unsigned char)(length >> (24 - 8 * i));
        bytes[at + 4 + (size_t)i] = (unsigned char)(sum >> (24 - 8 * i));
    }
    memcpy(bytes + at + 8, bytes, 8);
    write_file(path, bytes, at + 16);
}

static void a_forged_journal_deletes_no_other_file(void **state)
{
    scene *s = *state;
    char victim[SCENE_PATH], journal[SCENE_PATH];
    int64_t track = record_some(s->path);
    beside(s, "victim", victim);
    beside(s, "test.marotte-journal", journal);
    for (int mode = SHOW_READ; mode <= SHOW_RECORD; ++mode) {
        error err = {""};
        show *got;
        write_file(victim, "precious", 8);
        write_journal(journal, victim);
        scene_must(show_open(&got, s->path, (show_mode)mode, &err), &err);
        scene_expect(got, track, 0, 2000);
        show_close(got);
        expect_file(victim, "precious");
    }
}

static void another_programs_database_is_left_alone(void **state)
{
    scene *s = *state;
    char journal[SCENE_PATH];
    beside(s, "test.marotte-journal", journal);
    run_sql(s->path, "PRAGMA page_size = 512; CREATE TABLE t(a); INSERT INTO t VALUES(1)");
    for (int mode = SHOW_READ; mode <= SHOW_RECORD; ++mode) {
        error err = {""};
        show *got;
        write_file(journal, "theirs", 6);
        assert_int_equal(show_open(&got, s->path, (show_mode)mode, &err), MRT_ERR_FORMAT);
        assert_non_null(strstr(err.text, "not a marotte show"));
        expect_file(journal, "theirs");
    }
}

static void links_and_pipes_beside_a_show_lead_nowhere(void **state)
{
    static const char *const endings[] = {"-wal", "-shm", "-journal"};
    scene *s = *state;
    char victim[SCENE_PATH], name[SCENE_PATH];
    record_some(s->path);
    beside(s, "victim", victim);
    for (size_t i = 0; i < 2 * sizeof endings / sizeof endings[0]; ++i) {
        error err = {""};
        show *got = NULL;
        write_file(victim, "precious", 8);
        snprintf(name, sizeof name, "%s%s", s->path, endings[i / 2]);
        assert_int_equal(i % 2 ? mkfifo(name, 0600) : symlink(victim, name), 0);
        for (int mode = SHOW_READ; mode <= SHOW_RECORD; ++mode) {
            if (show_open(&got, s->path, (show_mode)mode, &err) >= 0)
                show_close(got);
            expect_file(victim, "precious");
        }
        (void)unlink(name);
    }
}

static void recovering_follows_no_planted_link(void **state)
{
    scene *s = *state;
    char victim[SCENE_PATH], out[SCENE_PATH], planted[SCENE_PATH];
    error err = {""};
    show_recovery got;
    record_some(s->path);
    FILE *file = fopen(s->path, "rb+");
    assert_non_null(file);
    assert_int_equal(fwrite("not what it was", 1, 15, file), 15);
    assert_int_equal(fclose(file), 0);
    beside(s, "victim", victim);
    beside(s, "out.marotte", out);
    beside(s, "out.marotte.damaged.tmp", planted);
    write_file(victim, "precious", 8);
    assert_int_equal(symlink(victim, planted), 0);
    scene_must(show_recover(&got, s->path, out, &err), &err);
    assert_true(got.row_count > 0 && !got.is_cut);
    expect_file(victim, "precious");
}

static void expect_private(const char *path)
{
    struct stat status;
    assert_int_equal(stat(path, &status), 0);
    assert_int_equal(status.st_mode & 077, 0);
}

/* Voices are recorded into it. */
static void a_show_is_its_owners_alone(void **state)
{
    scene *s = *state;
    char copy[SCENE_PATH];
    error err = {""};
    show *got;
    record_some(s->path);
    expect_private(s->path);
    beside(s, "copy.marotte", copy);
    scene_must(show_open(&got, s->path, SHOW_WRITE, &err), &err);
    scene_must(show_rescue(got, copy, &err), &err);
    show_close(got);
    expect_private(copy);
}

/* ---- tables ---- */

static void tables_that_are_not_ours_are_refused(void **state)
{
    static const char *const sql[] = {
        "CREATE TRIGGER evil AFTER INSERT ON track BEGIN DELETE FROM chunk; END",
        "ALTER TABLE take RENAME TO kept; CREATE VIEW take AS SELECT * FROM kept",
        "CREATE INDEX evil ON take(abs(id))",
        "CREATE TABLE extra(a)",
        "ALTER TABLE take ADD COLUMN evil AS (length(scene))",
        "DROP TABLE event; CREATE TABLE event(id INTEGER PRIMARY KEY, time_ns, kind, track, param,"
        "  hand, value, text AS (hex(zeroblob(100000000))))",
        "DROP TABLE edit",
        "CREATE VIRTUAL TABLE evil USING fts5(a)",
        "PRAGMA user_version = 4; CREATE INDEX evil ON take(abs(id))",
        "PRAGMA user_version = 4; ALTER TABLE take ADD COLUMN evil AS (length(scene))",
    };
    scene *s = *state;
    for (size_t i = 0; i < sizeof sql / sizeof sql[0]; ++i) {
        (void)unlink(s->path);
        record_some(s->path);
        run_sql(s->path, sql[i]);
        for (int mode = SHOW_READ; mode <= SHOW_RECORD; ++mode) {
            error err = {""};
            show *got;
            if (show_open(&got, s->path, (show_mode)mode, &err) >= 0)
                fail_msg("opens: %s", sql[i]);
            if (!strstr(err.text, "not a marotte show, or is damaged"))
                fail_msg("%s: %s", sql[i], err.text);
        }
    }
}

static void a_newer_show_may_have_more_columns_and_tables(void **state)
{
    scene *s = *state;
    error err = {""};
    show *got;
    int64_t track = record_some(s->path);
    run_sql(s->path, "PRAGMA user_version = 4; ALTER TABLE take ADD COLUMN more INTEGER;"
                     "CREATE TABLE later(id INTEGER PRIMARY KEY, a TEXT);"
                     "CREATE INDEX later_a ON later(a, id)");
    scene_must(show_open(&got, s->path, SHOW_WRITE, &err), &err);
    assert_false(show_is_writable(got));
    scene_expect(got, track, 0, 2000);
    show_close(got);
}

/* ---- values ---- */

static uint64_t count_calls(show *s, int64_t track, uint64_t most)
{
    error err = {""};
    show_reader *reader;
    mrt_sample sample;
    uint64_t count = 0;
    if (show_reader_open(&reader, s, track, INT64_MIN, INT64_MAX, &err) < 0)
        return 0;
    while (count < most && show_reader_next(reader, &sample, &err) != MRT_END)
        ++count;
    show_reader_close(reader);
    return count;
}

static void read_all(show *s)
{
    error err = {""};
    show_take *takes;
    take_event *events;
    show_checkpoint checkpoint;
    show_performance performance;
    take base;
    size_t count;
    if (show_takes(s, &takes, &count, &err) >= 0)
        free(takes);
    if (show_events(s, INT64_MIN, INT64_MAX, &events, &count, &err) >= 0)
        free(events);
    if (show_performance_read(s, 1, &performance, &err) >= 0)
        show_performance_finish(&performance);
    if (show_checkpoint_before(s, 1, INT64_MAX, 0, &checkpoint, &err) >= 0)
        show_checkpoint_finish(&checkpoint);
    if (show_take_base(s, 1, &base, &err) >= 0)
        take_finish(&base);
}

/* SQLite keeps any value in any column. */
static void values_of_another_kind_are_damage_and_everything_ends(void **state)
{
    static const char *const sql[] = {
        "UPDATE chunk SET bytes = CAST(bytes AS TEXT)",
        "UPDATE chunk SET from_ns = x''",
        "UPDATE chunk SET from_ns = x'' WHERE id % 2",
        "UPDATE chunk SET to_ns = 'late'",
        "UPDATE chunk SET from_ns = 'never' WHERE id > 1",
        "UPDATE take SET start_ns = x'00'",
        "UPDATE take SET scene = x'00'",
        "UPDATE take SET edit_head = 'all'",
        "UPDATE event SET time_ns = 'now'",
        "UPDATE event SET value = 'much'",
        "UPDATE performance SET from_ns = x''",
        "UPDATE performance SET hand_length_mm = 9e999",
        "UPDATE performance_track SET track = x''",
        "UPDATE checkpoint SET time_ns = x''",
        "UPDATE checkpoint SET bytes = CAST(bytes AS TEXT)",
        "UPDATE checkpoint SET size = 'large'",
        "UPDATE checkpoint SET time_ns = -9223372036854775808",
        "UPDATE span SET from_ns = 'x'",
        "UPDATE channel SET min = 'x'",
        "UPDATE track SET device = x'41'",
        "UPDATE rig SET path = x'41'",
    };
    enum { CALLS_MAX = 4000 };
    scene *s = *state;
    for (size_t i = 0; i < sizeof sql / sizeof sql[0]; ++i) {
        (void)unlink(s->path);
        int64_t track = record_some(s->path);
        run_sql(s->path, sql[i]);
        bool is_found = false;
        for (int mode = SHOW_READ; mode <= SHOW_RECORD; ++mode) {
            error err = {""};
            show *got;
            if (show_open(&got, s->path, (show_mode)mode, &err) < 0) {
                assert_true(err.text[0] != '\0');
                is_found = true;
                continue;
            }
            if (count_calls(got, track, CALLS_MAX) == CALLS_MAX)
                fail_msg("the samples never end: %s", sql[i]);
            read_all(got);
            is_found |= show_check(got, &err) < 0;
            show_close(got);
        }
        if (!is_found && !strstr(sql[i], "-9223372036854775808"))
            fail_msg("is not noticed: %s", sql[i]);
    }
}

/* What is saved of such a show is a good one. */
static void recovering_leaves_values_of_another_kind_out(void **state)
{
    scene *s = *state;
    char out[SCENE_PATH];
    error err = {""};
    show_recovery got;
    show *saved;
    record_some(s->path);
    run_sql(s->path, "UPDATE event SET value = 'much'; UPDATE chunk SET bytes = CAST(bytes AS TEXT)"
                     " WHERE id = 2; UPDATE take SET number = 'one'");
    beside(s, "out.marotte", out);
    scene_must(show_recover(&got, s->path, out, &err), &err);
    assert_true(got.damaged_count >= 3);
    scene_must(show_open(&saved, out, SHOW_READ, &err), &err);
    if (show_check(saved, &err) < 0)
        assert_non_null(strstr(err.text, "missing")); /* the chunk; all else is in order */
    show_close(saved);
}

/* The table of contents leads to another table's rows: each that is not of its kind is counted once
 * and left out, those of the table that nothing leads to are gone unseen, and all else is there. */
static void recovering_counts_rows_under_another_tables_name(void **state)
{
    scene *s = *state;
    char out[SCENE_PATH];
    error err = {""};
    show_recovery whole, got;
    sqlite3 *db;
    sqlite3_stmt *counted;
    int64_t channels, params;
    record_some(s->path);
    beside(s, "whole.marotte", out);
    scene_must(show_recover(&whole, s->path, out, &err), &err);
    assert_int_equal(whole.damaged_count, 0);
    assert_int_equal(sqlite3_open(s->path, &db), SQLITE_OK);
    assert_int_equal(sqlite3_prepare_v2(db,
                                        "SELECT (SELECT count(*) FROM channel),"
                                        " (SELECT count(*) FROM performance_param)",
                                        -1, &counted, NULL),
                     SQLITE_OK);
    assert_int_equal(sqlite3_step(counted), SQLITE_ROW);
    channels = sqlite3_column_int64(counted, 0);
    params = sqlite3_column_int64(counted, 1);
    sqlite3_finalize(counted);
    assert_int_equal(sqlite3_close(db), SQLITE_OK);
    assert_true(channels > 0);
    run_sql(s->path,
            "PRAGMA writable_schema = ON; UPDATE sqlite_master SET rootpage = (SELECT rootpage"
            " FROM sqlite_master WHERE name = 'channel') WHERE name = 'performance_param'");
    beside(s, "out.marotte", out);
    scene_must(show_recover(&got, s->path, out, &err), &err);
    assert_int_equal(got.damaged_count, channels);
    assert_int_equal(got.row_count, whole.row_count - params);
}

/* ---- work ---- */

/* Leaf pages full of rows that go on in a page that goes on in itself. */
static void recovering_ends_on_chains_that_lead_in_circles(void **state)
{
    enum { PAGE = 4096, PAGES = 200, CELLS = (PAGE - 8 - 16) / 2 };
    scene *s = *state;
    char out[SCENE_PATH];
    error err = {""};
    show_recovery got;
    struct stat status;
    record_some(s->path);
    assert_int_equal(stat(s->path, &status), 0);
    FILE *file = fopen(s->path, "rb+");
    assert_non_null(file);
    assert_int_equal(fwrite("not what it was", 1, 15, file), 15);
    assert_int_equal(fseek(file, 0, SEEK_END), 0);
    uint32_t circle = (uint32_t)(status.st_size / PAGE) + 1;
    for (uint32_t n = 0; n < PAGES; ++n) {
        unsigned char page[PAGE] = {0};
        if (n == 0) {
            for (int i = 0; i < 4; ++i)
                page[i] = (unsigned char)(circle >> (24 - 8 * i));
        } else {
            page[0] = 13;
            page[3] = CELLS >> 8, page[4] = CELLS & 255;
            for (int c = 0; c < CELLS; ++c)
                page[8 + 2 * c] = (PAGE - 600) >> 8, page[9 + 2 * c] = (PAGE - 600) & 255;
            unsigned char *cell = page + PAGE - 600;
            const unsigned char size[] = {0x9f, 0xff, 0xff, 0x00}; /* 64 MiB less 128 */
            memcpy(cell, size, sizeof size);
            cell[4] = 1;
            for (int at = 5; at < 600; at += 4) /* wherever the rest of the cell ends */
                for (int i = 0; i < 4 && at + i < 600; ++i)
                    cell[at + i] = (unsigned char)(circle >> (24 - 8 * i));
        }
        assert_int_equal(fwrite(page, 1, PAGE, file), PAGE);
    }
    assert_int_equal(fclose(file), 0);
    beside(s, "out.marotte", out);
    scene_must(show_recover(&got, s->path, out, &err), &err);
    assert_true(got.row_count > 0);
}

/* One call of instr() takes hours, and nothing interrupts it. */
static void recovering_computes_no_column(void **state)
{
    scene *s = *state;
    error err = {""};
    show_recovery got;
    char out[SCENE_PATH];
    record_some(s->path);
    run_sql(
        s->path,
        "PRAGMA writable_schema = ON; UPDATE sqlite_schema SET sql = replace(sql, 'bytes BLOB NOT "
        "NULL', 'bytes BLOB NOT NULL, evil AS (instr(zeroblob(100000000), zeroblob(50000000) ||"
        " x''01''))') WHERE name = 'chunk'");
    beside(s, "out.marotte", out);
    scene_must(show_recover(&got, s->path, out, &err), &err);
    assert_true(got.row_count > 0);
    assert_int_equal(got.damaged_count, 0);
}

/* A terabyte that is not there is neither read nor copied. */
static void recovering_leaves_holes_out(void **state)
{
    enum { DAMAGED_PAGES = 4 };
    scene *s = *state;
    error err = {""};
    show_recovery got;
    char out[SCENE_PATH];
    record_some(s->path);
    FILE *file = fopen(s->path, "rb+");
    assert_non_null(file);
    assert_int_equal(fseek(file, 3 * 4096, SEEK_SET), 0);
    for (int i = 0; i < DAMAGED_PAGES * 4096; ++i)
        assert_int_equal(fputc(0xff, file), 0xff);
    assert_int_equal(fclose(file), 0);
    assert_int_equal(truncate(s->path, (off_t)1 << 40), 0);
    beside(s, "out.marotte", out);
    scene_must(show_recover(&got, s->path, out, &err), &err);
    assert_true(got.row_count > 0);
    assert_false(got.is_cut);
}

/* Small tables that multiply each other. */
static void a_question_costs_no_more_than_the_file_allows(void **state)
{
    scene *s = *state;
    error err = {""};
    show *got;
    show_take *takes;
    size_t count;
    record_some(s->path);
    run_sql(s->path,
            "WITH RECURSIVE n(i) AS (SELECT 10 UNION ALL SELECT i + 1 FROM n WHERE i < 30000)"
            " INSERT INTO performance_track SELECT 1, i, 1 FROM n;"
            "WITH RECURSIVE n(i) AS (SELECT 10 UNION ALL SELECT i + 1 FROM n WHERE i < 30000)"
            " INSERT INTO span SELECT 1, i, 1, 1, 0, 0, NULL FROM n;"
            "UPDATE take SET end_ns = NULL");
    assert_int_equal(truncate(s->path, (off_t)1 << 40), 0); /* it is no larger for it */
    scene_must(show_open(&got, s->path, SHOW_READ, &err), &err);
    assert_int_equal(show_takes(got, &takes, &count, &err), MRT_ERR_FORMAT);
    assert_non_null(strstr(err.text, "steps of work"));
    show_close(got);
}

static void insert_edit(sqlite3_stmt *insert, int64_t take_id, int n, const char *json)
{
    sqlite3_bind_int64(insert, 1, take_id);
    sqlite3_bind_int(insert, 2, n);
    sqlite3_bind_int64(insert, 3, show_edit_crc(take_id, n, json));
    sqlite3_bind_text(insert, 4, json, -1, SQLITE_TRANSIENT);
    assert_int_equal(sqlite3_step(insert), SQLITE_DONE);
    sqlite3_reset(insert);
}

/* Each of many edits looks at each of many clips. */
static void edits_cost_no_more_than_the_file_allows(void **state)
{
    enum { SPLITS = 3000, INSERTS = 20000 };
    scene *s = *state;
    error err = {""};
    char json[96];
    sqlite3 *db;
    sqlite3_stmt *insert;
    show *got;
    take t;
    record_some(s->path);
    assert_int_equal(sqlite3_open(s->path, &db), SQLITE_OK);
    assert_int_equal(sqlite3_exec(db, "BEGIN; UPDATE take SET edit_head = 23000", NULL, NULL, NULL),
                     SQLITE_OK);
    assert_int_equal(
        sqlite3_prepare_v2(db, "INSERT INTO edit VALUES(?, 0, ?, 0, ?, ?)", -1, &insert, NULL),
        SQLITE_OK);
    for (int i = 1; i <= SPLITS + INSERTS; ++i) {
        if (i <= SPLITS)
            snprintf(json, sizeof json, "{\"op\":\"clip.split\",\"clip\":%d,\"at_ns\":%d}", i + 1,
                     i * 500000);
        else
            snprintf(json, sizeof json, "{\"op\":\"range.insert\",\"at_ns\":0,\"length_ns\":1}");
        insert_edit(insert, 1, i, json);
    }
    sqlite3_finalize(insert);
    assert_int_equal(sqlite3_exec(db, "COMMIT", NULL, NULL, NULL), SQLITE_OK);
    assert_int_equal(sqlite3_close(db), SQLITE_OK);
    scene_must(show_open(&got, s->path, SHOW_READ, &err), &err);
    if (edit_store_take(&t, got, 1, &err) >= 0 || !strstr(err.text, "steps of work"))
        fail_msg("\"%s\" does not speak of work", err.text);
    take_finish(&t);
    show_close(got);
}

static void a_state_larger_than_its_reader_wants_is_not_unpacked(void **state)
{
    scene *s = *state;
    error err = {""};
    show *got;
    show_checkpoint kept;
    record_some(s->path);
    scene_must(show_open(&got, s->path, SHOW_READ, &err), &err);
    assert_int_equal(show_checkpoint_before(got, 1, INT64_MAX, 4999, &kept, &err), MRT_ERR_FORMAT);
    assert_null(kept.bytes);
    scene_must(show_checkpoint_before(got, 1, INT64_MAX, 5000, &kept, &err), &err);
    assert_int_equal(kept.size, 5000);
    show_checkpoint_finish(&kept);
    show_close(got);
}

/* ---- text ---- */

static void expect_printable(const char *text)
{
    if (!text_is_printable(text_view_of(text, strlen(text))))
        fail_msg("\"%s\" would steer a terminal", text);
}

static void texts_of_a_show_are_printable(void **state)
{
#define EVIL "char(27) || ']0;owned' || char(7) || char(10) || char(155) || char(8238) || '\xff'"
    scene *s = *state;
    error err = {""};
    show *got;
    show_take *takes;
    take_event *events;
    show_track track;
    show_performance performance;
    size_t count;
    int64_t track_id = record_some(s->path);
    run_sql(s->path, "UPDATE take SET scene = " EVIL ", shot = " EVIL ", origin = " EVIL ";"
                     "UPDATE track SET input = " EVIL ", device = " EVIL ";"
                     "UPDATE plugin SET identity = " EVIL " || id;"
                     "UPDATE rig SET path = " EVIL ", hash = " EVIL ", mesh_hash = " EVIL ";"
                     "UPDATE event SET text = " EVIL ";"
                     "UPDATE channel SET name = " EVIL ", unit = " EVIL);
    scene_must(show_open(&got, s->path, SHOW_READ, &err), &err);
    scene_must(show_takes(got, &takes, &count, &err), &err);
    expect_printable(takes[0].scene);
    expect_printable(takes[0].shot);
    expect_printable(takes[0].origin);
    assert_non_null(strstr(takes[0].scene, "?]0;owned?"));
    free(takes);
    scene_must(show_events(got, INT64_MIN, INT64_MAX, &events, &count, &err), &err);
    assert_true(count > 0);
    expect_printable(events[0].text);
    free(events);
    scene_must(show_track_read(got, track_id, &track, &err), &err);
    expect_printable(track.track.input);
    expect_printable(track.track.device);
    expect_printable(track.track.plugin);
    expect_printable(track.track.channel[0].name);
    expect_printable(track.track.channel[0].unit);
    show_track_finish(&track);
    scene_must(show_performance_read(got, 1, &performance, &err), &err);
    expect_printable(performance.performance.mapping);
    expect_printable(performance.performance.rig);
    expect_printable(performance.performance.rig_hash);
    expect_printable(performance.performance.mesh_hash);
    show_performance_finish(&performance);
    show_close(got);
}

/* ---- while it is recorded ---- */

/* The row of one of two tracks is gone: the other one's samples are kept all the same. */
static void a_refused_track_takes_no_other_with_it(void **state)
{
    scene *s = *state;
    error err = {""};
    show *got;
    scene_recording r;
    writer_options options = scene_options();
    scene_must(show_create(&got, s->path, &err), &err);
    scene_record(&r, got, &options);
    take_track other = scene_track("other:");
    scene_must(writer_add_track(r.writer, &other, &err), &err);
    scene_flush(&r);
    char sql[64];
    snprintf(sql, sizeof sql, "DELETE FROM track WHERE id = %lld", (long long)other.id);
    run_sql(s->path, sql);
    for (int64_t n = 0; n < 500; ++n) {
        mrt_sample sample = scene_sample(other.id, n);
        writer_sample(r.writer, other.id, &sample);
        sample = scene_sample(r.track, n);
        writer_sample(r.writer, r.track, &sample);
    }
    (void)!writer_flush(r.writer, &err);
    assert_int_equal(writer_status_of(r.writer).lost_count, 500);
    (void)!writer_stop(r.writer, &err);
    scene_expect(got, r.track, 0, 500);
    show_close(got);
}

/* What follows a lost change of a parameter is performed otherwise than it was seen. */
static void lost_parameter_changes_are_told(void **state)
{
    scene *s = *state;
    error err = {""};
    char message[600];
    show *got;
    scene_recording r;
    take_event *events;
    size_t count;
    writer_options options = scene_options();
    options.memory_bytes = 1; /* none is held while the disk is full */
    scene_must(show_create(&got, s->path, &err), &err);
    scene_record(&r, got, &options);
    scene_flush(&r);
    atomic_store(&disk_answer, SQLITE_FULL);
    scene_give(&r, 0, 10);
    (void)!writer_flush(r.writer, &err);
    const take_event change = {
        .kind = TAKE_EVENT_PARAM, .time_ns = 5, .track = r.track, .param = 1};
    for (int i = 0; i < 7; ++i) {
        writer_event(r.writer, &change);
        (void)!writer_flush(r.writer, &err);
    }
    uint64_t lost = writer_status_of(r.writer).lost_event_count;
    assert_true(lost > 0);
    atomic_store(&disk_answer, SQLITE_OK);
    scene_flush(&r);
    writer_message(r.writer, message, sizeof message);
    assert_non_null(strstr(message, "changes of parameters were lost"));
    scene_stop(&r);
    scene_must(show_events(got, INT64_MIN, INT64_MAX, &events, &count, &err), &err);
    double told = 0.0;
    for (size_t i = 0; i < count; ++i)
        if (events[i].kind == TAKE_EVENT_LOST && strcmp(events[i].text, "events") == 0)
            told += events[i].value;
    assert_true(told >= (double)lost && told <= (double)lost);
    free(events);
    show_close(got);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, scene_set_up, tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(a_forged_journal_deletes_no_other_file),
        TEST(another_programs_database_is_left_alone),
        TEST(links_and_pipes_beside_a_show_lead_nowhere),
        TEST(recovering_follows_no_planted_link),
        TEST(a_show_is_its_owners_alone),
        TEST(tables_that_are_not_ours_are_refused),
        TEST(a_newer_show_may_have_more_columns_and_tables),
        TEST(values_of_another_kind_are_damage_and_everything_ends),
        TEST(recovering_leaves_values_of_another_kind_out),
        TEST(recovering_counts_rows_under_another_tables_name),
        TEST(recovering_ends_on_chains_that_lead_in_circles),
        TEST(recovering_computes_no_column),
        TEST(recovering_leaves_holes_out),
        TEST(a_question_costs_no_more_than_the_file_allows),
        TEST(edits_cost_no_more_than_the_file_allows),
        TEST(a_state_larger_than_its_reader_wants_is_not_unpacked),
        TEST(texts_of_a_show_are_printable),
        TEST(a_refused_track_takes_no_other_with_it),
        TEST(lost_parameter_changes_are_told),
    };
    disk_install();
    return cmocka_run_group_tests(tests, NULL, NULL);
}
