#include "take/show_schema.h"

#include "base/text.h"
#include "take/show_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { OBJECTS_MAX = 1000 }; /* tables and indexes of any show, older or newer */

/* step[v] makes version v + 1 of version v. A step that was released is never changed: what is new
 * becomes a new step, and what older programs cannot read raises meta.oldest_reader. */
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

    /* How many chunks a finished track has: what is lost at its end is noticed too. How tracks are
     * performed anew. */
    "ALTER TABLE track ADD COLUMN chunk_count INTEGER;"
    "CREATE TABLE IF NOT EXISTS again("
    "  performance INTEGER PRIMARY KEY REFERENCES performance, of INTEGER NOT NULL,"
    "  ignores_params INTEGER NOT NULL, left_calibration TEXT, right_calibration TEXT,"
    "  min_cutoff_hz REAL NOT NULL, beta REAL NOT NULL);",
};

const show_table show_tables[SHOW_TABLES] = {
    {"meta", "key", false, "t*", "*"},
    {"session", "id", true, "iiiItti", "*"},
    {"rig", "id", true, "itttfT", "*"},
    {"plugin", "id", true, "it", "*"},
    {"calibration", "hash", false, "tt", "*"},
    {"track", "id", true, "iiittTTI", "*"},
    {"channel", "track, n", false, "iittiidd", "*"},
    {"performance", "id", true, "iiiifiiI", "*"},
    {"performance_track", "performance, n", false, "iii", "*"},
    {"performance_param", "performance, n", false, "iiif", "*"},
    {"again", "performance", true, "iiiTTff", "*"},
    {"take", "id", true, "iiiIittiti", "*"},
    {"span", "take, n", false, "iiIiiiI", "*"},
    {"edit", "take, branch, n", false, "iiiiit", "*"},
    {"event", "id", true, "iiiiiidt", "*"},
    {"chunk", "id", true, "iiiib", "id, track, from_ns, to_ns"},
    {"checkpoint", "id", true, "iiiiiib", "id, performance, time_ns, version, size, crc"},
    {"audio", "id", true, "itiiit", "*"},
    {"audio_chunk", "id", true, "iiiiiib", "id, audio, first_frame, frame_count, time_ns, crc"},
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
    /* What is deleted from the journal can be given back to the disk in small steps. */
    mrt_result result = sqlite_run(db, "PRAGMA auto_vacuum = INCREMENTAL", err);
    return result < 0 ? result : show_schema_migrate(db, 0, err);
}

/* ---- whether a file's tables are ours ---- */

typedef struct object { /* a table or an index */
    char *name, *sql;   /* owned */
} object;

typedef struct objects { /* by name */
    object *at;
    size_t count;
} objects;

static void finish_objects(objects *list)
{
    for (size_t i = 0; i < list->count; ++i) {
        free(list->at[i].name);
        free(list->at[i].sql);
    }
    free(list->at);
    *list = (objects){0};
}

/* What SQLite makes by itself for a key has no text. */
static mrt_result read_objects(objects *out, sqlite *db, error *err)
{
    sqlite_statement *rows;
    *out = (objects){0};
    mrt_result result = sqlite_query(db, &rows, err,
                                     "SELECT name, sql FROM sqlite_schema WHERE sql IS NOT NULL"
                                     " ORDER BY name LIMIT ?",
                                     "tt", "i", (int64_t)OBJECTS_MAX);
    if (result < 0)
        return result;
    while ((result = sqlite_step(rows, err)) == MRT_OK) {
        void *list = out->at;
        result = show_grow(&list, out->count, sizeof *out->at, err);
        out->at = list;
        if (result < 0)
            break;
        object *one = &out->at[out->count++];
        *one = (object){strdup(sqlite_exact_text(rows, 0)), strdup(sqlite_exact_text(rows, 1))};
        if (!one->name || !one->sql) {
            result = error_set(err, MRT_ERR_MEMORY, "no memory for a show's tables");
            break;
        }
    }
    sqlite_finish(rows);
    return result < 0 ? result : MRT_OK;
}

/* As a new file of that version has them. */
static mrt_result expect_objects(objects *out, int64_t version, error *err)
{
    sqlite *fresh;
    *out = (objects){0};
    mrt_result result = sqlite_open_memory(&fresh, err);
    if (result < 0)
        return result;
    for (int64_t v = 0; v < version && result >= 0; ++v)
        result = sqlite_run(fresh, step[v], err);
    if (result >= 0)
        result = read_objects(out, fresh, err);
    sqlite_close(fresh);
    return result;
}

static const object *find_object(const objects *list, const char *name)
{
    for (size_t i = 0; i < list->count; ++i)
        if (strcmp(list->at[i].name, name) == 0)
            return &list->at[i];
    return NULL;
}

/* Names of columns and kinds, with nothing between `at` and `end` that could be an expression. */
static bool is_plain(const char *at, const char *end)
{
    for (; at < end; ++at)
        if (!strchr("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789, ", *at))
            return false;
    return true;
}

static bool has_only_grown(const char *sql, const char *expected)
{
    const size_t kept = strlen(expected) - 1, length = strlen(sql); /* without its ')' */
    return expected[kept] == ')' && length > kept + 1 && sql[length - 1] == ')' &&
           strncmp(sql, expected, kept) == 0 && sql[kept] == ',' &&
           is_plain(sql + kept, sql + length - 1);
}

static bool is_new_table_or_index(const char *sql)
{
    const char *columns = strchr(sql, '(');
    const size_t length = strlen(sql);
    return strncmp(sql, "CREATE TABLE ", 13) == 0 ||
           (strncmp(sql, "CREATE INDEX ", 13) == 0 && columns && sql[length - 1] == ')' &&
            is_plain(columns + 1, sql + length - 1));
}

/* Version 1 may have a table of version 2 already: it was made by hand for tests of that time. */
static mrt_result compare(const objects *there, const objects *expected, const objects *latest,
                          bool is_newer, error *err)
{
    for (size_t i = 0; i < expected->count; ++i)
        if (!find_object(there, expected->at[i].name))
            return error_set(err, MRT_ERR_FORMAT, "it has no \"%s\"", expected->at[i].name);
    for (size_t i = 0; i < there->count; ++i) {
        const object *one = &there->at[i], *same = find_object(expected, one->name);
        const object *later = same ? same : find_object(latest, one->name);
        bool is_ours = later ? strcmp(one->sql, later->sql) == 0 ||
                                   (is_newer && has_only_grown(one->sql, later->sql))
                             : is_newer && is_new_table_or_index(one->sql);
        char name[64];
        text_copy(name, sizeof name, text_view_of(one->name, strlen(one->name)));
        if (!is_ours)
            return error_set(err, MRT_ERR_FORMAT, "\"%s\" is not as marotte makes it", name);
    }
    return MRT_OK;
}

mrt_result show_schema_check(sqlite *db, int64_t version, error *err)
{
    objects there, expected = {0}, latest = {0};
    int64_t other_count = 0;
    const bool is_newer = version > SHOW_VERSION;
    mrt_result result = read_objects(&there, db, err);
    if (result >= 0)
        result = expect_objects(&expected, is_newer ? SHOW_VERSION : version, err);
    if (result >= 0 && version < SHOW_VERSION)
        result = expect_objects(&latest, SHOW_VERSION, err);
    if (result >= 0)
        result = sqlite_number(db,
                               "SELECT COUNT(*) FROM sqlite_schema"
                               " WHERE type NOT IN ('table', 'index') OR typeof(name) <> 'text'"
                               " OR typeof(sql) NOT IN ('text', 'null')",
                               0, &other_count, err);
    error why = {""};
    if (result >= 0 && other_count > 0)
        result = error_set(&why, MRT_ERR_FORMAT, "it has views or triggers, which no show has");
    else if (result >= 0)
        result = compare(&there, &expected, &latest, is_newer, &why);
    if (why.text[0])
        (void)error_set(err, result,
                        "%s: is no show of marotte, or damaged: %s; what can be read "
                        "of it: marotte take recover",
                        sqlite_path(db), why.text);
    finish_objects(&there);
    finish_objects(&expected);
    finish_objects(&latest);
    return result;
}
