/* Tracks: what one input gave, described. */
#include "take/show_file.h"

#include "take/hash.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- rows in ---- */

static const char *or_empty(const char *text)
{
    return text ? text : "";
}

static mrt_result insert_calibration(sqlite *db, const char *json, char out_hash[TAKE_HASH],
                                     error *err)
{
    hash_bytes(out_hash, json, strlen(json));
    return sqlite_change(db, err, "INSERT OR IGNORE INTO calibration(hash, json) VALUES(?, ?)",
                         "tt", out_hash, json);
}

static mrt_result insert_channels(sqlite *db, const take_track *track, error *err)
{
    mrt_result result = MRT_OK;
    for (uint32_t n = 0; n < track->channel_count && result >= 0; ++n) {
        const take_channel *channel = &track->channel[n];
        result = sqlite_change(db, err,
                               "INSERT INTO channel(track, n, name, unit, semantic, hand, min, max)"
                               "VALUES(?, ?, ?, ?, ?, ?, ?, ?)",
                               "iittiidd", track->id, (int64_t)n, channel->name, channel->unit,
                               (int64_t)channel->semantic, (int64_t)channel->hand,
                               (double)channel->min, (double)channel->max);
    }
    return result;
}

mrt_result show_plugin_insert(sqlite *db, const char *identity, error *err)
{
    return sqlite_change(db, err, "INSERT OR IGNORE INTO plugin(identity) VALUES(?)", "t",
                         or_empty(identity));
}

mrt_result show_track_insert(sqlite *db, int64_t session, const take_track *track, error *err)
{
    char hash[2][TAKE_HASH];
    mrt_result result = show_plugin_insert(db, track->plugin, err);
    for (int side = 0; side < 2 && result >= 0; ++side)
        if (track->calibration[side])
            result = insert_calibration(db, track->calibration[side], hash[side], err);
    if (result >= 0)
        result = sqlite_change(
            db, err,
            "INSERT INTO track(id, session, plugin, input, device, left_calibration,"
            "  right_calibration)"
            "VALUES(?, ?, (SELECT id FROM plugin WHERE identity = ?), ?, ?, ?, ?)",
            "iittttt", track->id, session, or_empty(track->plugin), or_empty(track->input),
            or_empty(track->device), track->calibration[0] ? hash[0] : NULL,
            track->calibration[1] ? hash[1] : NULL);
    return result < 0 ? result : insert_channels(db, track, err);
}

/* ---- rows out ---- */

static char *exact_or_null(sqlite_statement *row, int column, bool *out_failed)
{
    if (sqlite_is_null(row, column))
        return NULL;
    char *text = strdup(sqlite_exact_text(row, column));
    *out_failed |= !text;
    return text;
}

static char *text_of(sqlite_statement *row, int column, bool *out_failed)
{
    char *text = sqlite_text_copy(row, column);
    *out_failed |= !text;
    return text;
}

static mrt_result read_channels(sqlite *db, take_track *out, error *err)
{
    sqlite_statement *rows;
    mrt_result result = sqlite_query(db, &rows, err,
                                     "SELECT n, name, unit, semantic, hand, min, max FROM channel "
                                     "WHERE track = ? ORDER BY n",
                                     "ittiidd", "i", out->id);
    if (result < 0)
        return result;
    while ((result = sqlite_step(rows, err)) == MRT_OK) {
        if (out->channel_count == MRT_MAX_CHANNELS || sqlite_int(rows, 0) != out->channel_count) {
            result = error_set(err, MRT_ERR_FORMAT, "track %lld is damaged: channel %lld",
                               (long long)out->id, (long long)sqlite_int(rows, 0));
            break;
        }
        take_channel *channel = &out->channel[out->channel_count++];
        channel->semantic = (uint32_t)sqlite_int(rows, 3);
        channel->hand = (uint32_t)sqlite_int(rows, 4);
        channel->min = (float)sqlite_double(rows, 5);
        channel->max = (float)sqlite_double(rows, 6);
        sqlite_text(rows, 1, channel->name, sizeof channel->name);
        sqlite_text(rows, 2, channel->unit, sizeof channel->unit);
    }
    sqlite_finish(rows);
    return result < 0 ? result : MRT_OK;
}

#define TRACK_QUERY                                                                                \
    "SELECT input, device, identity,"                                                              \
    "  (SELECT json FROM calibration WHERE hash = left_calibration),"                              \
    "  (SELECT json FROM calibration WHERE hash = right_calibration),"                             \
    "  (SELECT from_ns FROM chunk WHERE track = t.id ORDER BY from_ns LIMIT 1),"                   \
    "  (SELECT to_ns FROM chunk WHERE track = t.id ORDER BY from_ns DESC, chunk.id DESC LIMIT 1)"  \
    " FROM track t JOIN plugin ON plugin.id = t.plugin WHERE t.id = ?"

mrt_result show_track_read(show *self, int64_t id, show_track *out, error *err)
{
    *out = (show_track){.track.id = id};
    sqlite_statement *rows;
    mrt_result result = sqlite_query(self->db, &rows, err, TRACK_QUERY, "tttTTII", "i", id);
    if (result < 0)
        return result;
    result = sqlite_step(rows, err);
    if (result == MRT_OK) {
        bool no_memory = false;
        out->track.input = text_of(rows, 0, &no_memory);
        out->track.device = text_of(rows, 1, &no_memory);
        out->track.plugin = text_of(rows, 2, &no_memory);
        out->track.calibration[0] = exact_or_null(rows, 3, &no_memory);
        out->track.calibration[1] = exact_or_null(rows, 4, &no_memory);
        out->from_ns = sqlite_int(rows, 5);
        out->to_ns = sqlite_int(rows, 6);
        if (no_memory)
            result = error_set(err, MRT_ERR_MEMORY, "no memory for track %lld", (long long)id);
    } else if (result == MRT_END) {
        result =
            error_set(err, MRT_ERR_ARGUMENT, "%s: has no track %lld", self->path, (long long)id);
    }
    sqlite_finish(rows);
    if (result >= 0)
        result = read_channels(self->db, &out->track, err);
    if (result < 0)
        show_track_finish(out);
    return result;
}

void show_track_finish(show_track *track)
{
    if (!track)
        return;
    take_track_finish(&track->track);
    *track = (show_track){0};
}

mrt_result show_track_ids(show *self, int64_t **out, size_t *out_count, error *err)
{
    return show_read_ids(self, "SELECT id FROM track ORDER BY id", out, out_count, err);
}
