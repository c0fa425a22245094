/* Notes: short texts about the show as a whole. */
#include "take/show_file.h"

#include <stdio.h>
#include <string.h>

mrt_result show_note_read(show *self, const char *key, char *out, size_t capacity, error *err)
{
    sqlite_statement *rows;
    out[0] = '\0';
    mrt_result result = sqlite_query(
        self->db, &rows, err, "SELECT value FROM meta WHERE key = 'note.' || ?", "t", "t", key);
    if (result < 0)
        return result;
    result = sqlite_step(rows, err);
    if (result == MRT_OK && strlen(sqlite_exact_text(rows, 0)) >= capacity)
        result = error_set(err, MRT_ERR_FORMAT, "%s: the note '%s' is longer than any is",
                           self->path, key);
    else if (result == MRT_OK)
        sqlite_text(rows, 0, out, capacity);
    sqlite_finish(rows);
    return result < 0 ? result : MRT_OK;
}

mrt_result show_note_write(show *self, const char *key, const char *text, error *err)
{
    mrt_result result = show_check_writable(self, err);
    if (result < 0)
        return result;
    if (!text[0])
        return sqlite_change(self->db, err, "DELETE FROM meta WHERE key = 'note.' || ?", "t", key);
    return sqlite_change(self->db, err,
                         "INSERT INTO meta(key, value) VALUES('note.' || ?, ?)"
                         "ON CONFLICT(key) DO UPDATE SET value = excluded.value",
                         "tt", key, text);
}
