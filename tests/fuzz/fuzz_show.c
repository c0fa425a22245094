/* Any file is a show or is refused with a reason; whatever it says, everything in it can be asked
 * for and ends, it can be checked, and recovered or not; no other file is touched. The bytes say
 * how a whole show is changed, step by step: bits of it, values of its rows, rows that multiply,
 * pages in the place of others, what lies beside it. */
#include "base/file.h"
#include "show/writer.h"
#include "show/show.h"

#include <assert.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

enum { PAGE = 4096, CALLS_MAX = 4000000 /* more than any file of this size has samples */ };

static void write_file(const char *path, const uint8_t *bytes, size_t size)
{
    FILE *file = fopen(path, "wb");
    if (!file || fwrite(bytes, 1, size, file) != size)
        abort();
    fclose(file);
}

static void read_track(show *s, int64_t id)
{
    error err;
    show_track track;
    show_reader *reader;
    mrt_sample sample;
    if (show_track_read(s, id, &track, &err) >= 0)
        show_track_finish(&track);
    if (show_reader_open(&reader, s, id, INT64_MIN, INT64_MAX, &err) < 0)
        return;
    for (int calls = 0; show_reader_next(reader, &sample, &err) != MRT_END; ++calls)
        if (calls == CALLS_MAX)
            abort(); /* it goes round and round */
    show_reader_close(reader);
}

static void read_take(show *s, int64_t id)
{
    error err;
    take base;
    show_edits edits;
    show_span *spans;
    size_t count;
    if (show_take_base(s, id, &base, &err) >= 0)
        take_finish(&base);
    if (show_edits_read(s, id, &edits, &err) >= 0)
        show_edits_finish(&edits);
    if (show_take_spans(s, id, &spans, &count, &err) >= 0)
        free(spans);
}

static void read_performance(show *s, int64_t id)
{
    error err;
    show_performance performance;
    show_checkpoint checkpoint;
    if (show_performance_read(s, id, &performance, &err) >= 0)
        show_performance_finish(&performance);
    if (show_checkpoint_before(s, id, INT64_MAX, 0, &checkpoint, &err) >= 0)
        show_checkpoint_finish(&checkpoint);
}

static void read_audio(show *s, int64_t id)
{
    static uint8_t sound[1 << 16];
    error err;
    size_t size;
    if (show_audio_read(s, id, 0, sound, sizeof sound, &size, &err) >= 0)
        assert(size <= sizeof sound);
}

static void each(show *s, mrt_result (*list)(show *, int64_t **, size_t *, error *),
                 void (*read)(show *, int64_t))
{
    error err;
    int64_t *ids;
    size_t count;
    if (list(s, &ids, &count, &err) < 0)
        return;
    for (size_t i = 0; i < count && i < 64; ++i)
        read(s, ids[i]);
    free(ids);
}

static void read_all(show *s)
{
    error err;
    show_take *takes;
    take_event *events;
    size_t count;
    each(s, show_track_ids, read_track);
    each(s, show_performance_ids, read_performance);
    each(s, show_audio_ids, read_audio);
    if (show_takes(s, &takes, &count, &err) >= 0) {
        for (size_t i = 0; i < count && i < 64; ++i)
            read_take(s, takes[i].id);
        free(takes);
    }
    if (show_events(s, INT64_MIN, INT64_MAX, &events, &count, &err) >= 0)
        free(events);
}

static char path[64], out_path[64], victim[64];
static file_bytes whole;

static void must(mrt_result result)
{
    if (result < 0)
        abort();
}

static void record(writer *w)
{
    char input[] = "input";
    take_track track = {.input = input, .channel_count = 3};
    must(writer_add_track(w, &track, NULL));
    take_performance performance = {.mapping = input, .rig = input, .track_count = 1};
    performance.track[0] = track.id;
    must(writer_begin_performance(w, &performance, 0, NULL));
    int64_t id;
    must(writer_take_begin(w, 0, &(writer_slate){.scene = "1"}, &id, NULL));
    for (uint32_t n = 0; n < 700; ++n) {
        mrt_sample sample = {.time_ns = n * 6666667, .sequence = n, .count = 3};
        sample.value[1] = (float)(n % 17);
        sample.value[2] = 0.1f * (float)n;
        writer_sample(w, track.id, &sample);
    }
    must(writer_mark(w, 5, "mark", NULL));
    uint8_t *buffer = writer_checkpoint_buffer(w);
    memset(buffer, 7, 5000);
    writer_checkpoint(w, performance.id, 3, 1, buffer, 5000);
}

static void make_whole(void)
{
    show *s;
    writer *w;
    int64_t audio_id;
    const char *folder = access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp";
    snprintf(path, sizeof path, "%s/fuzz_show_%ld.marotte", folder, (long)getpid());
    snprintf(out_path, sizeof out_path, "%s/fuzz_show_%ld_out.marotte", folder, (long)getpid());
    snprintf(victim, sizeof victim, "%s/fuzz_show_%ld.victim", folder, (long)getpid());
    (void)unlink(path);
    must(show_create(&s, path, NULL));
    must(writer_start(&w, s, &(writer_options){.program = "fuzz", .checkpoint_bytes = 5000}, NULL));
    record(w);
    must(writer_stop(w, NULL));
    for (int i = 0; i < 3; ++i)
        must(show_edit_append(s, 1, "{\"op\":\"take.rate\",\"rating\":3}", i, NULL, 0, NULL));
    show_audio audio = {.name = "a", .rate_hz = 48000, .channel_count = 1, .format = "s16"};
    must(show_audio_create(s, &audio, &audio_id, NULL));
    must(show_audio_write(s, audio_id, 0, "12345678", 8, NULL));
    show_close(s);
    must(file_read(&whole, path, 1 << 24, NULL));
}

/* ---- how it is changed ---- */

typedef struct steps {
    const uint8_t *at, *end;
} steps;

static uint32_t next(steps *from, int count)
{
    uint32_t value = 0;
    for (int i = 0; i < count; ++i)
        value = value << 8 | (from->at < from->end ? *from->at++ : 0);
    return value;
}

static const char *const columns[][10] = {
    {"meta", "key", "value"},
    {"session", "id", "utc_ns", "monotonic_ns", "ended_ns", "program", "host", "process"},
    {"rig", "path", "hash", "mesh_hash", "unit_mm", "json"},
    {"plugin", "identity"},
    {"calibration", "hash", "json"},
    {"track", "session", "plugin", "input", "device", "left_calibration", "chunk_count"},
    {"channel", "track", "n", "name", "unit", "semantic", "hand", "min", "max"},
    {"performance", "session", "plugin", "rig", "hand_length_mm", "rezero_pedal", "from_ns",
     "to_ns"},
    {"performance_track", "performance", "n", "track"},
    {"performance_param", "performance", "n", "param", "value"},
    {"again", "performance", "of", "ignores_params", "left_calibration", "min_cutoff_hz", "beta"},
    {"take", "created_ns", "start_ns", "end_ns", "scene", "shot", "number", "origin", "edit_head"},
    {"span", "take", "n", "performance", "is_shown", "need_ns", "from_ns", "to_ns"},
    {"edit", "take", "branch", "n", "utc_ms", "crc", "json"},
    {"event", "time_ns", "kind", "track", "param", "hand", "value", "text"},
    {"chunk", "id", "track", "from_ns", "to_ns", "bytes"},
    {"checkpoint", "performance", "time_ns", "version", "size", "crc", "bytes"},
    {"audio", "name", "start_ns", "rate_hz", "channel_count", "format"},
    {"audio_chunk", "audio", "first_frame", "frame_count", "time_ns", "crc", "bytes"},
};

/* Another value, of another kind mostly, in all rows or some. */
static void change_value(sqlite3 *db, steps *from)
{
    static const char *const values[] = {
        "NULL",
        "x''",
        "x'00ff'",
        "''",
        "'t'",
        "char(27, 93, 7, 10, 155, 8238)",
        "0",
        "-1",
        "9223372036854775807",
        "-9223372036854775808",
        "1e308",
        "9e999",
        "zeroblob(70000)",
        "CAST(%s AS TEXT)",
        "CAST(%s AS BLOB)",
        "%s + 1",
        "-%s",
        "%s * 3",
        "id",
        "1",
        "2",
        "1000000",
    };
    static const char *const where[] = {"", " WHERE rowid % 2", " WHERE rowid = 1",
                                        " WHERE rowid > 2"};
    const char *const *table = columns[next(from, 1) % (sizeof columns / sizeof columns[0])];
    int count = 1;
    while (count < 10 && table[count])
        ++count;
    const char *column = table[1 + next(from, 1) % (uint32_t)(count - 1)];
    const char *value = values[next(from, 1) % (sizeof values / sizeof values[0])];
    const char *hole = strstr(value, "%s");
    char sql[300];
    (void)snprintf(sql, sizeof sql, "UPDATE OR IGNORE %s SET %s = %.*s%s%s%s", table[0], column,
                   hole ? (int)(hole - value) : (int)strlen(value), value, hole ? column : "",
                   hole ? hole + 2 : "", where[next(from, 1) % 4]);
    (void)sqlite3_exec(db, sql, NULL, NULL, NULL);
}

static void add_rows(sqlite3 *db, steps *from)
{
    static const char *const rows[] = {
        "take SELECT i, 0, 0, NULL, 0, '', '', i, '', 0 FROM n",
        "span SELECT 1, i, 1, 1, 0, 0, NULL FROM n",
        "performance_track SELECT 1, i, 1 FROM n",
        "edit SELECT 1, 0, i - 96, 0, 0, '{}' FROM n",
        "event SELECT i, i, 1, 1, 1, 0, 0, '' FROM n",
        "checkpoint SELECT i, 1, i, 1, 200000000, 0, zeroblob(20) FROM n",
        "audio_chunk SELECT i, 1, i * 4, 4, 0, 0, x'0000000000000000' FROM n",
        "chunk SELECT i, track, from_ns + i, to_ns + i, bytes FROM n, chunk WHERE id = 1",
    };
    char sql[300];
    (void)snprintf(sql, sizeof sql,
                   "WITH RECURSIVE n(i) AS (SELECT 100 UNION ALL SELECT i + 1 FROM n WHERE i < %u)"
                   " INSERT OR IGNORE INTO %s",
                   100 + next(from, 1) * 4, rows[next(from, 1) % (sizeof rows / sizeof rows[0])]);
    (void)sqlite3_exec(db, sql, NULL, NULL, NULL);
}

static void change_tables(sqlite3 *db, steps *from)
{
    static const char *const sql[] = {
        "CREATE TRIGGER evil AFTER INSERT ON take BEGIN DELETE FROM chunk; END",
        "ALTER TABLE take RENAME TO kept; CREATE VIEW take AS SELECT * FROM kept",
        "CREATE INDEX evil ON take(abs(id))",
        "DROP INDEX chunk_time",
        "DROP TABLE edit",
        "PRAGMA user_version = 1",
        "PRAGMA user_version = 3",
        "PRAGMA writable_schema = ON; UPDATE sqlite_schema SET rootpage = 3 WHERE name = 'chunk'",
        "PRAGMA writable_schema = ON; UPDATE sqlite_schema SET sql = replace(sql, 'TEXT', 'REAL')",
    };
    (void)sqlite3_exec(db, sql[next(from, 1) % (sizeof sql / sizeof sql[0])], NULL, NULL, NULL);
}

static void with_sql(void (*change)(sqlite3 *db, steps *from), steps *from)
{
    sqlite3 *db;
    if (sqlite3_open(path, &db) == SQLITE_OK)
        change(db, from);
    (void)sqlite3_close(db);
}

static void change_pages(steps *from)
{
    file_bytes now;
    if (file_read(&now, path, 1 << 26, NULL) < 0)
        return;
    const uint32_t what = next(from, 1) % 3;
    const size_t a = next(from, 1) * (size_t)PAGE, b = next(from, 1) * (size_t)PAGE;
    size_t size = now.size;
    if (what == 0 && a + PAGE <= size && b + PAGE <= size)
        memmove(now.data + a, now.data + b, PAGE);
    else if (what == 1 && a > 0 && a < size)
        size = a;
    else if (what == 2)
        for (uint32_t i = next(from, 1) % 32; i-- > 0;) {
            size_t at = next(from, 3) % size;
            now.data[at] ^= (uint8_t)next(from, 1);
        }
    write_file(path, now.data, size);
    file_bytes_finish(&now);
}

/* Beside it, when all else is done: SQLite itself would use it. */
static void put_beside(steps *from)
{
    static const char *const endings[] = {"-wal", "-shm", "-journal"};
    uint8_t bytes[2048] = {0xd9, 0xd5, 0x05, 0xf9, 0x20, 0xa1, 0x63, 0xd7};
    char name[80];
    (void)snprintf(name, sizeof name, "%s%s", path, endings[next(from, 1) % 3]);
    (void)unlink(name);
    const uint32_t what = next(from, 1) % 3;
    size_t size = 8;
    if (what == 0) {
        if (symlink(victim, name) != 0)
            abort();
        return;
    }
    if (what ==
        1) { /* the name of a file that SQLite would delete; sqlite.org/fileformat2.html, 3 */
        const size_t length = strlen(victim);
        uint32_t sum = 0;
        bytes[19] = 1, bytes[22] = 2, bytes[26] = 16;
        bytes[515] = 2;
        memcpy(bytes + 516, victim, length);
        for (size_t i = 0; i < length; ++i)
            sum += (uint8_t)victim[i];
        for (size_t i = 0; i < 4; ++i) {
            bytes[516 + length + i] = (uint8_t)(length >> (24 - 8 * i));
            bytes[520 + length + i] = (uint8_t)(sum >> (24 - 8 * i));
        }
        memcpy(bytes + 524 + length, bytes, 8);
        size = 532 + length;
    }
    while (what == 2 && from->at < from->end && size < sizeof bytes)
        bytes[size++] = (uint8_t)next(from, 1);
    write_file(name, bytes, size);
}

static void clear_beside(void)
{
    static const char *const endings[] = {"", "-wal", "-shm", "-journal", "-lock"};
    for (size_t i = 0; i < sizeof endings / sizeof endings[0]; ++i) {
        char name[80];
        (void)snprintf(name, sizeof name, "%s%s", path, endings[i]);
        (void)unlink(name);
    }
}

static void make(const uint8_t *bytes, size_t size)
{
    steps from = {bytes, bytes + size};
    clear_beside();
    write_file(path, whole.data, whole.size);
    for (int steps_left = 40; steps_left > 0 && from.at < from.end; --steps_left) {
        switch (next(&from, 1) % 6) {
        case 0:
            with_sql(change_value, &from);
            break;
        case 1:
            with_sql(add_rows, &from);
            break;
        case 2:
            with_sql(change_tables, &from);
            break;
        case 3:
            put_beside(&from);
            return;
        default:
            change_pages(&from);
        }
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    error err;
    if (!whole.data)
        make_whole();
    write_file(victim, (const uint8_t *)"precious", 8);
    for (int mode = SHOW_READ; mode <= SHOW_WRITE; ++mode) {
        show *s;
        err.text[0] = '\0';
        make(bytes, size);
        if (show_open(&s, path, (show_mode)mode, &err) < 0) {
            assert(strlen(err.text) > 0 && !s);
            continue;
        }
        show_limit_work(s);
        read_all(s);
        if (show_check(s, &err) < 0)
            assert(strlen(err.text) > 0);
        show_close(s);
    }
    show_recovery got;
    err.text[0] = '\0';
    make(bytes, size);
    if (show_recover(&got, path, out_path, &err) < 0) {
        assert(strlen(err.text) > 0);
    } else { /* what was saved is a show */
        show *saved;
        must(show_open(&saved, out_path, SHOW_READ, &err));
        read_all(saved);
        show_close(saved);
    }
    file_bytes kept;
    if (file_read(&kept, victim, 100, &err) < 0 || kept.size != 8)
        abort(); /* another file was touched */
    file_bytes_finish(&kept);
    (void)unlink(out_path);
    (void)unlink(victim);
    clear_beside();
    return 0;
}
