/* Audio: interleaved frames in pieces. */
#include "take/show_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

enum { RATE_MAX = 768000, CHANNELS_MAX = 64, PIECE_BYTES_MAX = 1024 * 1024 };

/* 0: no such format. */
static uint32_t sample_bytes(const char *format)
{
    static const struct format {
        const char *name;
        uint32_t bytes;
    } formats[] = {{"s16", 2}, {"s24", 3}, {"f32", 4}};
    for (size_t i = 0; i < sizeof formats / sizeof formats[0]; ++i)
        if (strcmp(format, formats[i].name) == 0)
            return formats[i].bytes;
    return 0;
}

/* *out_frame_bytes is not 0 when it is sound. */
static mrt_result check(const show_audio *audio, uint32_t *out_frame_bytes, mrt_result code,
                        error *err)
{
    *out_frame_bytes = sample_bytes(audio->format) * (audio->channel_count % (CHANNELS_MAX + 1));
    if (audio->rate_hz == 0 || audio->rate_hz > RATE_MAX || audio->channel_count > CHANNELS_MAX ||
        *out_frame_bytes == 0)
        return error_set(err, code, "audio '%s': %u Hz, %u channels of '%s' cannot be kept",
                         audio->name, audio->rate_hz, audio->channel_count, audio->format);
    return MRT_OK;
}

mrt_result show_audio_create(show *self, const show_audio *audio, int64_t *out_id, error *err)
{
    uint32_t frame_size;
    *out_id = 0;
    mrt_result result = show_check_writable(self, err);
    if (result >= 0)
        result = check(audio, &frame_size, MRT_ERR_ARGUMENT, err);
    if (result >= 0)
        result = sqlite_change(self->db, err,
                               "INSERT INTO audio(name, start_ns, rate_hz, channel_count, format)"
                               "VALUES(?, ?, ?, ?, ?)",
                               "tiiit", audio->name, audio->start_ns, (int64_t)audio->rate_hz,
                               (int64_t)audio->channel_count, audio->format);
    if (result >= 0)
        *out_id = sqlite_last_id(self->db);
    return result;
}

static mrt_result read_info(sqlite *db, const char *path, int64_t id, show_audio *out,
                            uint32_t *out_frame_bytes, error *err)
{
    *out = (show_audio){0};
    *out_frame_bytes = 1;
    sqlite_statement *row;
    mrt_result result =
        sqlite_query(db, &row, err,
                     "SELECT id, name, start_ns, rate_hz, channel_count, format, COALESCE("
                     "  (SELECT first_frame + frame_count FROM audio_chunk WHERE audio = audio.id"
                     "   ORDER BY first_frame DESC LIMIT 1), 0)"
                     " FROM audio WHERE id = ?",
                     "itiiiti", "i", id);
    if (result < 0)
        return result;
    result = sqlite_step(row, err);
    if (result == MRT_OK) {
        out->id = sqlite_int(row, 0);
        sqlite_text(row, 1, out->name, sizeof out->name);
        out->start_ns = sqlite_int(row, 2);
        out->rate_hz = (uint32_t)sqlite_int(row, 3);
        out->channel_count = (uint32_t)sqlite_int(row, 4);
        sqlite_text(row, 5, out->format, sizeof out->format);
        out->frame_count = sqlite_int(row, 6);
        result = check(out, out_frame_bytes, MRT_ERR_FORMAT, err);
    } else if (result == MRT_END) {
        result = error_set(err, MRT_ERR_ARGUMENT, "%s: has no audio %lld", path, (long long)id);
    }
    sqlite_finish(row);
    return result;
}

mrt_result show_audio_info(show *self, int64_t id, show_audio *out, error *err)
{
    uint32_t frame_size;
    return read_info(self->db, self->path, id, out, &frame_size, err);
}

mrt_result show_audio_append(sqlite *db, const char *path, int64_t id, int64_t time_ns,
                             const void *frames, size_t size, error *err)
{
    show_audio audio;
    uint32_t frame_size;
    mrt_result result = read_info(db, path, id, &audio, &frame_size, err);
    if (result < 0)
        return result;
    if (size == 0 || size > PIECE_BYTES_MAX || size % frame_size != 0)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "audio %lld: a piece of %zu bytes, 1 to %d in frames of %u are possible",
                         (long long)id, size, PIECE_BYTES_MAX, frame_size);
    return sqlite_change(
        db, err,
        "INSERT INTO audio_chunk(audio, first_frame, frame_count, time_ns, crc, bytes)"
        "VALUES(?, ?, ?, ?, ?, ?)",
        "iiiiib", id, audio.frame_count, (int64_t)(size / frame_size), time_ns,
        (int64_t)crc32_z(0, frames, size), frames, size);
}

mrt_result show_audio_write(show *self, int64_t id, int64_t time_ns, const void *frames,
                            size_t size, error *err)
{
    mrt_result result = show_check_writable(self, err);
    if (result >= 0)
        result = sqlite_begin(self->db, err);
    if (result < 0)
        return result;
    result = show_audio_append(self->db, self->path, id, time_ns, frames, size, err);
    return sqlite_end(self->db, result, err);
}

mrt_result show_audio_ids(show *self, int64_t **out, size_t *out_count, error *err)
{
    return show_read_ids(self, "SELECT id FROM audio ORDER BY id", out, out_count, err);
}

/* Copies what the piece holds from `frame` on; 0 at its end. */
static mrt_result copy_piece(sqlite_statement *row, int64_t id, int64_t frame, uint32_t frame_size,
                             uint8_t *out, size_t capacity, size_t *out_size, error *err)
{
    size_t size;
    const uint8_t *bytes = sqlite_blob(row, 3, &size);
    int64_t first = sqlite_int(row, 0), count = sqlite_int(row, 1);
    if (size > PIECE_BYTES_MAX || first > frame || count < 0 || first > INT64_MAX - count ||
        first + count <= frame || (uint64_t)count != size / frame_size || size % frame_size != 0 ||
        (int64_t)crc32_z(0, bytes, size) != sqlite_int(row, 2))
        return error_set(err, MRT_ERR_FORMAT, "audio %lld is damaged or missing at frame %lld",
                         (long long)id, (long long)frame);
    size_t skipped = (size_t)(frame - first) * frame_size;
    size_t left = capacity / frame_size * frame_size;
    *out_size = size - skipped < left ? size - skipped : left;
    memcpy(out, bytes + skipped, *out_size);
    return MRT_OK;
}

mrt_result show_audio_read(show *self, int64_t id, int64_t first_frame, void *out, size_t capacity,
                           size_t *out_size, error *err)
{
    *out_size = 0;
    show_audio audio;
    uint32_t frame_size;
    sqlite_statement *rows;
    mrt_result result = read_info(self->db, self->path, id, &audio, &frame_size, err);
    if (result < 0)
        return result;
    int64_t frame = first_frame < 0 ? 0 : first_frame;
    result = sqlite_query(self->db, &rows, err,
                          "SELECT first_frame, frame_count, crc, bytes FROM audio_chunk "
                          "WHERE audio = ?1 AND first_frame >= COALESCE("
                          "  (SELECT MAX(first_frame) FROM audio_chunk"
                          "   WHERE audio = ?1 AND first_frame <= ?2), 0) ORDER BY first_frame",
                          "iiib", "ii", id, frame);
    if (result < 0)
        return result;
    while (frame < audio.frame_count && capacity - *out_size >= frame_size &&
           (result = sqlite_step(rows, err)) == MRT_OK) {
        size_t got = 0;
        result = copy_piece(rows, id, frame, frame_size, (uint8_t *)out + *out_size,
                            capacity - *out_size, &got, err);
        if (result < 0)
            break;
        *out_size += got;
        frame += (int64_t)(got / frame_size);
    }
    sqlite_finish(rows);
    return result < 0 ? result : MRT_OK;
}

mrt_result show_audio_check(show *self, int64_t id, error *err)
{
    enum { PIECE_BYTES = 65536 };
    show_audio audio;
    uint8_t *piece = malloc(PIECE_BYTES);
    if (!piece)
        return error_set(err, MRT_ERR_MEMORY, "%s: no memory to check it", self->path);
    uint32_t frame_size;
    mrt_result result = read_info(self->db, self->path, id, &audio, &frame_size, err);
    size_t size = 1;
    for (int64_t frame = 0; result >= 0 && size > 0; frame += (int64_t)(size / frame_size))
        result = show_audio_read(self, id, frame, piece, PIECE_BYTES, &size, err);
    free(piece);
    return result;
}

static void read_anchor(void *item, sqlite_statement *row)
{
    *(show_audio_anchor *)item =
        (show_audio_anchor){.frame = sqlite_int(row, 0), .time_ns = sqlite_int(row, 1)};
}

mrt_result show_audio_anchors(show *self, int64_t id, show_audio_anchor **out, size_t *out_count,
                              error *err)
{
    sqlite_statement *query;
    show_rows rows = {0};
    mrt_result result = sqlite_query(self->db, &query, err,
                                     "SELECT first_frame, time_ns FROM audio_chunk "
                                     "WHERE audio = ? AND time_ns <> 0 ORDER BY first_frame",
                                     "ii", "i", id);
    if (result >= 0)
        result = show_read_rows(&rows, query, sizeof **out, read_anchor, err);
    *out = rows.item;
    *out_count = rows.count;
    return result;
}
