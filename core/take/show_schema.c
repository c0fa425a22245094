#include "take/show_schema.h"

#include <stdio.h>

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

static mrt_result run_steps(sqlite *db, int64_t version, error *err)
{
    mrt_result result = MRT_OK;
    for (int64_t v = version; v < SHOW_VERSION && result >= 0; ++v)
        result = sqlite_run(db, step[v], err);
    if (result < 0)
        return result;
    char sql[96];
    snprintf(sql, sizeof sql, "PRAGMA application_id = %d; PRAGMA user_version = %d",
             SHOW_APPLICATION, SHOW_VERSION);
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
