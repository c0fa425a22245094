#include "show/show_schema.h"

#include "base/text.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

enum { OBJECTS_MAX = 40 }; /* maximum number of tables and indexes of a show */

/* step[v] migrates version v to v + 1. A released step never changes: each change is a new step. A
 * change that older programs cannot read raises meta.oldest_reader. */
static const char *const step[SHOW_VERSION] = {
    "CREATE TABLE meta(key TEXT PRIMARY KEY, value) WITHOUT ROWID;"
    "INSERT INTO meta VALUES('oldest_reader', 1);"
    "CREATE TABLE session("
    "  id INTEGER PRIMARY KEY, utc_ns INTEGER NOT NULL, monotonic_ns INTEGER NOT NULL,"
    "  ended_ns INTEGER, program TEXT NOT NULL, host TEXT NOT NULL, process INTEGER NOT NULL);"
    "CREATE TABLE rig("
    "  id INTEGER PRIMARY KEY, path TEXT NOT NULL, hash TEXT NOT NULL, mesh_hash TEXT NOT NULL,"
    "  unit_mm REAL NOT NULL, json TEXT, UNIQUE(path, hash, mesh_hash, unit_mm));"
    "CREATE TABLE plugin(id INTEGER PRIMARY KEY, identity TEXT NOT NULL UNIQUE);"
    "CREATE TABLE calibration(hash TEXT PRIMARY KEY, json TEXT NOT NULL) WITHOUT ROWID;"
    "CREATE TABLE track("
    "  id INTEGER PRIMARY KEY, session INTEGER NOT NULL REFERENCES session,"
    "  plugin INTEGER NOT NULL REFERENCES plugin, input TEXT NOT NULL, device TEXT NOT NULL,"
    "  left_calibration TEXT REFERENCES calibration,"
    "  right_calibration TEXT REFERENCES calibration);"
    "CREATE TABLE channel("
    "  track INTEGER NOT NULL REFERENCES track, n INTEGER NOT NULL, name TEXT NOT NULL,"
    "  unit TEXT NOT NULL, semantic INTEGER NOT NULL, hand INTEGER NOT NULL, min REAL NOT NULL,"
    "  max REAL NOT NULL, PRIMARY KEY(track, n)) WITHOUT ROWID;"
    "CREATE TABLE chunk("
    "  id INTEGER PRIMARY KEY, track INTEGER NOT NULL REFERENCES track,"
    "  from_ns INTEGER NOT NULL, to_ns INTEGER NOT NULL, bytes BLOB NOT NULL);"
    "CREATE INDEX chunk_time ON chunk(track, from_ns);"
    "CREATE TABLE performance("
    "  id INTEGER PRIMARY KEY, session INTEGER NOT NULL REFERENCES session,"
    "  plugin INTEGER NOT NULL REFERENCES plugin, rig INTEGER NOT NULL REFERENCES rig,"
    "  hand_length_mm REAL NOT NULL, rezero_pedal INTEGER NOT NULL, from_ns INTEGER NOT NULL,"
    "  to_ns INTEGER);"
    "CREATE TABLE performance_track("
    "  performance INTEGER NOT NULL REFERENCES performance, n INTEGER NOT NULL,"
    "  track INTEGER NOT NULL REFERENCES track, PRIMARY KEY(performance, n)) WITHOUT ROWID;"
    "CREATE INDEX performance_track_track ON performance_track(track);"
    "CREATE TABLE performance_param("
    "  performance INTEGER NOT NULL REFERENCES performance, n INTEGER NOT NULL,"
    "  param INTEGER NOT NULL, value REAL NOT NULL, PRIMARY KEY(performance, n)) WITHOUT ROWID;"
    "CREATE TABLE event("
    "  id INTEGER PRIMARY KEY, time_ns INTEGER NOT NULL, kind INTEGER NOT NULL,"
    "  track INTEGER NOT NULL, param INTEGER NOT NULL, hand INTEGER NOT NULL, value REAL NOT NULL,"
    "  text TEXT NOT NULL);"
    "CREATE INDEX event_time ON event(time_ns);"
    "CREATE TABLE checkpoint("
    "  id INTEGER PRIMARY KEY, performance INTEGER NOT NULL REFERENCES performance,"
    "  time_ns INTEGER NOT NULL, version INTEGER NOT NULL, size INTEGER NOT NULL,"
    "  crc INTEGER NOT NULL, bytes BLOB NOT NULL);"
    "CREATE INDEX checkpoint_time ON checkpoint(performance, time_ns);"
    "CREATE TABLE take("
    "  id INTEGER PRIMARY KEY, created_ns INTEGER NOT NULL, start_ns INTEGER NOT NULL,"
    "  end_ns INTEGER, is_recovered INTEGER NOT NULL DEFAULT 0, scene TEXT NOT NULL,"
    "  shot TEXT NOT NULL, number INTEGER NOT NULL, origin TEXT NOT NULL,"
    "  edit_head INTEGER NOT NULL DEFAULT 0);"
    "CREATE INDEX take_slate ON take(scene, shot, number);"
    "CREATE TABLE span("
    "  take INTEGER NOT NULL REFERENCES take, n INTEGER NOT NULL,"
    "  performance INTEGER REFERENCES performance, is_shown INTEGER NOT NULL,"
    "  need_ns INTEGER NOT NULL, from_ns INTEGER NOT NULL, to_ns INTEGER,"
    "  PRIMARY KEY(take, n)) WITHOUT ROWID;"
    "CREATE INDEX span_performance ON span(performance);"
    "CREATE TABLE edit("
    "  take INTEGER NOT NULL REFERENCES take, branch INTEGER NOT NULL, n INTEGER NOT NULL,"
    "  utc_ms INTEGER NOT NULL, crc INTEGER NOT NULL, json TEXT NOT NULL,"
    "  PRIMARY KEY(take, branch, n)) WITHOUT ROWID;"
    "CREATE TABLE audio("
    "  id INTEGER PRIMARY KEY, name TEXT NOT NULL, start_ns INTEGER NOT NULL,"
    "  rate_hz INTEGER NOT NULL, channel_count INTEGER NOT NULL, format TEXT NOT NULL);"
    "CREATE TABLE audio_chunk("
    "  id INTEGER PRIMARY KEY, audio INTEGER NOT NULL REFERENCES audio,"
    "  first_frame INTEGER NOT NULL, frame_count INTEGER NOT NULL, time_ns INTEGER NOT NULL,"
    "  crc INTEGER NOT NULL, bytes BLOB NOT NULL);"
    "CREATE UNIQUE INDEX audio_chunk_frame ON audio_chunk(audio, first_frame);",

    /* The number of chunks of a finished track, so that a loss at its end is detected. The settings
       of performances of recorded tracks. */
    "ALTER TABLE track ADD COLUMN chunk_count INTEGER;"
    "CREATE TABLE IF NOT EXISTS again("
    "  performance INTEGER PRIMARY KEY REFERENCES performance, of INTEGER NOT NULL,"
    "  ignores_params INTEGER NOT NULL, left_calibration TEXT, right_calibration TEXT,"
    "  min_cutoff_hz REAL NOT NULL, beta REAL NOT NULL);",

    /* The patch of a performance. */
    "CREATE TABLE IF NOT EXISTS patch("
    "  performance INTEGER PRIMARY KEY REFERENCES performance, json TEXT NOT NULL);",
};

const show_table show_tables[SHOW_TABLES] = {
    {"meta", "key", false, "t*", "*", 1},
    {"session", "id", true, "iiiItti", "*", 1},
    {"rig", "id", true, "itttfT", "*", 1},
    {"plugin", "id", true, "it", "*", 1},
    {"calibration", "hash", false, "tt", "*", 1},
    {"track", "id", true, "iiittTTI", "*", 1},
    {"channel", "track, n", false, "iittiidd", "*", 1},
    {"performance", "id", true, "iiiifiiI", "*", 1},
    {"performance_track", "performance, n", false, "iii", "*", 1},
    {"performance_param", "performance, n", false, "iiif", "*", 1},
    {"again", "performance", true, "iiiTTff", "*", 2},
    {"patch", "performance", true, "it", "*", 3},
    {"take", "id", true, "iiiIittiti", "*", 1},
    {"span", "take, n", false, "iiIiiiI", "*", 1},
    {"edit", "take, branch, n", false, "iiiiit", "*", 1},
    {"event", "id", true, "iiiiiidt", "*", 1},
    {"chunk", "id", true, "iiiib", "id, track, from_ns, to_ns", 1},
    {"checkpoint", "id", true, "iiiiiib", "id, performance, time_ns, version, size, crc", 1},
    {"audio", "id", true, "itiiit", "*", 1},
    {"audio_chunk", "id", true, "iiiiiib", "id, audio, first_frame, frame_count, time_ns, crc", 1},
};

static mrt_result run_steps(sqlite *db, int64_t version, error *err)
{
    mrt_result result = MRT_OK;
    for (int64_t v = version; v < SHOW_VERSION && result >= 0; ++v)
        result = sqlite_run(db, step[v], err);
    if (result < 0)
        return result;
    char sql[96];
    snprintf(sql, sizeof sql, "PRAGMA application_id = %d; PRAGMA user_version = %d",
             SQLITE_APPLICATION, SHOW_VERSION);
    return sqlite_run(db, sql, err);
}

mrt_result show_schema_migrate(sqlite *db, int64_t version, error *err)
{
    if (version == SHOW_VERSION)
        return MRT_OK;
    mrt_result result = sqlite_begin(db, err);
    if (result < 0)
        return result;
    return sqlite_end(db, run_steps(db, version, err), err);
}

mrt_result show_schema_create(sqlite *db, error *err)
{
    /* Lets the journal return deleted pages to the disk in small steps. */
    mrt_result result = sqlite_run(db, "PRAGMA auto_vacuum = INCREMENTAL", err);
    return result < 0 ? result : show_schema_migrate(db, 0, err);
}

/* ---- checking the tables of a file ---- */

typedef struct object {         /* a table or an index, with the SQL text that SQLite stores */
    text_view name, kind, rest; /* text after "CREATE TABLE " */
    text_view added;            /* a column; empty: none */
    bool is_found;
} object;

typedef struct objects {
    object at[OBJECTS_MAX];
    size_t count;
} objects;

static text_view view_of(const char *text)
{
    return text_view_of(text, strlen(text));
}

static bool is_same(text_view a, text_view b)
{
    const size_t length = (size_t)(a.end - a.at);
    return (size_t)(b.end - b.at) == length && memcmp(a.at, b.at, length) == 0;
}

static bool take_off(text_view *text, text_view start)
{
    const size_t length = (size_t)(start.end - start.at);
    if ((size_t)(text->end - text->at) < length || memcmp(text->at, start.at, length) != 0)
        return false;
    text->at += length;
    return true;
}

static object *find_object(objects *list, text_view name)
{
    for (size_t i = 0; i < list->count; ++i)
        if (is_same(list->at[i].name, name))
            return &list->at[i];
    return NULL;
}

/* Adds the object that a statement of the steps creates. A statement that changes rows creates
 * none. */
static void expect_statement(objects *out, text_view sql)
{
    static const char *const kinds[] = {"CREATE TABLE ", "CREATE INDEX ", "CREATE UNIQUE INDEX "};
    if (take_off(&sql, view_of("ALTER TABLE "))) {
        const text_view name = {sql.at, sql.at + strcspn(sql.at, " ")};
        object *of = find_object(out, name);
        sql.at = name.end;
        const bool is_column = take_off(&sql, view_of(" ADD COLUMN "));
        assert(of && is_column);
        if (of && is_column)
            of->added = sql;
        return;
    }
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; ++i) {
        if (!take_off(&sql, view_of(kinds[i])))
            continue;
        (void)take_off(&sql, view_of("IF NOT EXISTS "));
        assert(out->count < OBJECTS_MAX);
        out->at[out->count++] = (object){.name = {sql.at, sql.at + strcspn(sql.at, "( ")},
                                         .kind = view_of(kinds[i]),
                                         .rest = sql,
                                         .added = {sql.end, sql.end}};
        return;
    }
}

/* Collects the objects of a new file of that version. */
static void expect_objects(objects *out, int64_t version)
{
    out->count = 0;
    for (int64_t v = 0; v < version; ++v)
        for (const char *sql = step[v]; *sql;) {
            const size_t length = strcspn(sql, ";");
            expect_statement(out, text_view_of(sql, length));
            sql += length + (sql[length] == ';');
        }
}

/* Returns true if the text has only names of columns and types, and nothing that could be an
 * expression. */
static bool is_plain(text_view text)
{
    for (; text.at < text.end; ++text.at)
        if (!strchr("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789, ", *text.at))
            return false;
    return true;
}

/* may_grow: further columns of plain values may follow the known ones. */
static bool is_as_expected(const object *of, text_view sql, bool may_grow)
{
    text_view closing = view_of(")"), known = of->rest;
    --known.end;
    if (!take_off(&sql, of->kind) || !take_off(&sql, known))
        return false;
    if (of->added.at < of->added.end &&
        (!take_off(&sql, view_of(", ")) || !take_off(&sql, of->added)))
        return false;
    const text_view rest = {known.end, of->rest.end}; /* its last character, usually ')' */
    if (is_same(sql, of->added.at < of->added.end ? closing : rest))
        return true;
    return may_grow && sql.end > sql.at && *sql.at == ',' && sql.end[-1] == ')' &&
           is_plain((text_view){sql.at, sql.end - 1});
}

static bool is_new_table_or_index(text_view sql)
{
    if (take_off(&sql, view_of("CREATE TABLE ")))
        return true;
    const char *columns = memchr(sql.at, '(', (size_t)(sql.end - sql.at));
    return take_off(&sql, view_of("CREATE INDEX ")) && columns && sql.end[-1] == ')' &&
           is_plain((text_view){columns + 1, sql.end - 1});
}

typedef struct schema_check {
    objects expected, latest;
    bool is_newer;
    int64_t oldest_reader;
} schema_check;

/* A file of version 1 may already have a table of version 2: the step creates it only if it is
 * missing. */
static mrt_result check_object(schema_check *self, sqlite_statement *row, error *why)
{
    if (!sqlite_is_null(row, 3))
        self->oldest_reader = sqlite_int(row, 3);
    const text_view type = view_of(sqlite_exact_text(row, 0));
    const text_view name = view_of(sqlite_exact_text(row, 1));
    const text_view sql = view_of(sqlite_exact_text(row, 2));
    if (!text_equals(type, "table") && !text_equals(type, "index"))
        return error_set(why, MRT_ERR_FORMAT, "it has views or triggers, which a show never has");
    if (sqlite_is_null(row, 2)) /* an index that SQLite creates for a key */
        return MRT_OK;
    object *of = find_object(&self->expected, name);
    of = of ? of : find_object(&self->latest, name);
    const bool is_ours = of ? !of->is_found && is_as_expected(of, sql, self->is_newer)
                            : self->is_newer && is_new_table_or_index(sql);
    if (of)
        of->is_found = true;
    if (is_ours)
        return MRT_OK;
    char shown[64];
    text_copy(shown, sizeof shown, name);
    return error_set(why, MRT_ERR_FORMAT, "\"%s\" differs from the table of a show", shown);
}

static mrt_result check_objects(schema_check *self, sqlite *db, bool *out_is_unread, error *why)
{
    mrt_result result = MRT_OK, step_result = MRT_OK;
    sqlite_statement *rows = sqlite_query(db,
                                          "SELECT type, name, sql, (SELECT value FROM meta WHERE "
                                          "key = 'oldest_reader') FROM sqlite_schema",
                                          "ttTI", "");
    while (result >= 0 && (step_result = sqlite_step(rows, why)) == MRT_OK)
        result = check_object(self, rows, why);
    *out_is_unread = step_result < 0;
    sqlite_finish(rows);
    for (size_t i = 0; i < self->expected.count && result >= 0 && step_result >= 0; ++i) {
        const object *of = &self->expected.at[i];
        if (!of->is_found)
            result = error_set(why, MRT_ERR_FORMAT, "it has no \"%.*s\"",
                               (int)(of->name.end - of->name.at), of->name.at);
    }
    return step_result < 0 ? step_result : result;
}

mrt_result show_schema_check(sqlite *db, int64_t version, int64_t *out_oldest_reader, error *err)
{
    error why = {""};
    bool is_unread = false;
    schema_check self;
    self.is_newer = version > SHOW_VERSION;
    self.oldest_reader = INT64_MAX;
    expect_objects(&self.expected, self.is_newer ? SHOW_VERSION : version);
    expect_objects(&self.latest, version < SHOW_VERSION ? SHOW_VERSION : 0);
    mrt_result result = check_objects(&self, db, &is_unread, &why);
    if (result >= 0 && version < 1)
        result = error_set(&why, MRT_ERR_FORMAT, "it has no version");
    *out_oldest_reader = self.oldest_reader;
    if (result >= 0)
        return MRT_OK;
    if (is_unread) /* SQLite gives the reason */
        return error_set(err, result, "%s", why.text);
    return error_set(
        err, result,
        "%s: is not a marotte show, or is damaged: %s; recover it with marotte take recover",
        sqlite_path(db), why.text);
}
