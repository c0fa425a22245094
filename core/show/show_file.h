/* show/show_file.h - the open show, and the functions that its files, its writer and its journal
 * share. Leaves out their code: it calls no function of those files. For core/show only. A show
 * belongs to one thread at a time, except show_next_id: any thread. */
#ifndef MAROTTE_TAKE_SHOW_FILE_H
#define MAROTTE_TAKE_SHOW_FILE_H
#include "base/os.h"
#include "show/show.h"
#include "show/sqlite.h"

/* ---- the lock of the writing program ---- */

/* An advisory lock on NAME.marotte-lock, which names its holder. The system releases it when the
 * holder ends for any reason, so it is never stale. */
typedef struct show_lock {
    int fd; /* -1: not held */
    char *path;
} show_lock;

typedef enum show_lock_state {
    SHOW_LOCK_HELD = 0,
    SHOW_LOCK_OTHERS,  /* `who` names the holder: "process 4711 on studio since 2026-11-21 18:54:23
                          UTC" */
    SHOW_LOCK_REFUSED, /* the lock file cannot be created; `who` gives the reason */
} show_lock_state;

/* Never waits. Release `out` with show_lock_release after any result. */
show_lock_state show_lock_acquire(show_lock *out, const char *show_path, char who[256]);
void show_lock_release(show_lock *lock); /* accepts a lock that is not held, zeroed or with fd -1 */

/* ---- the open show ---- */

typedef enum show_id {
    SHOW_ID_TRACK,
    SHOW_ID_PERFORMANCE,
    SHOW_ID_TAKE,
    SHOW_ID_CHUNK,
    SHOW_ID_COUNT
} show_id;

struct show {
    sqlite *db;
    char *path;
    int64_t version; /* version of its tables */
    bool is_writable;
    char notice[1024];
    show_lock lock;
    os_file_id file;                        /* the open file */
    struct show *owner;                     /* the show that assigns its ids; NULL: itself */
    _Atomic int64_t last_id[SHOW_ID_COUNT]; /* last assigned ids. A row gets its id before it is
                                               written, also from callers of the writer */
};

/* Opens a separate connection to the file, for the writer. */
CHECKED mrt_result show_connect(const show *self, sqlite **out, error *err);
/* Configures a connection that writes. */
CHECKED mrt_result show_configure(sqlite *db, error *err);
int64_t show_next_id(show *self, show_id of);
/* Returns the path with the suffix, which the caller frees; NULL: no memory. */
char *show_beside(const char *path, const char *suffix);
/* Returns MRT_ERR_UNSUPPORTED with the reason if the show is read-only. */
CHECKED mrt_result show_check_writable(const show *self, error *err);

/* Reads the rows of a query into a list, and finishes the query. On failure there is no list. Items
 * must not own memory. */
typedef struct show_rows {
    void *item; /* owned */
    size_t count;
} show_rows;
CHECKED mrt_result show_read_rows(show_rows *out, sqlite_statement *rows, size_t item_size,
                                  mrt_result (*read)(void *item, sqlite_statement *row, error *err),
                                  error *err);
/* Returns the checksum that is stored with an edit, so that a moved or changed edit is detected. */
int64_t show_edit_crc(int64_t take, int32_t n, const char *json);
/* Inserts an edit in the caller's transaction. n <= 0: an edit that created the take. */
CHECKED mrt_result show_edit_insert(sqlite *db, int64_t take_id, int32_t n, int64_t utc_ms,
                                    const char *json, error *err);
/* Returns the first column of all rows. */
CHECKED mrt_result show_read_ids(show *self, const char *sql, int64_t **out, size_t *out_count,
                                 error *err);
/* Makes room for item number `count`. Call it for each item that is added. */
CHECKED mrt_result show_grow(void **list, size_t count, size_t item_size, error *err);

/* Insert the rows of a take in the caller's transaction. `end_ns` NULL: the take or span is not
 * ended. */
typedef struct show_take_row {
    int64_t id, created_ns, start_ns;
    const int64_t *end_ns;
    const char *scene, *shot, *origin;
    uint32_t number; /* 0: the next number of the slate */
} show_take_row;
CHECKED mrt_result show_take_insert(sqlite *db, const show_take_row *row, error *err);
CHECKED mrt_result show_span_insert(sqlite *db, int64_t take, int64_t performance, int64_t from_ns,
                                    const int64_t *to_ns, bool is_shown, error *err);

/* Insert recorded data in the writer's transaction. Times are show time. */
CHECKED mrt_result show_track_insert(sqlite *db, int64_t session, const take_track *track,
                                     error *err);
CHECKED mrt_result show_performance_insert(sqlite *db, int64_t session,
                                           const take_performance *performance, int64_t from_ns,
                                           error *err);
CHECKED mrt_result show_event_insert(sqlite *db, const take_event *event, error *err);
/* A checkpoint with its compressed bytes. */
typedef struct show_packed {
    int64_t performance, time_ns;
    uint32_t version;
    size_t plain_size, size;
    uint8_t *bytes; /* owned */
} show_packed;
CHECKED mrt_result show_checkpoint_pack(show_packed *out, const void *bytes, size_t size,
                                        error *err);
CHECKED mrt_result show_checkpoint_insert(sqlite *db, const show_packed *packed, error *err);
CHECKED mrt_result show_audio_append(sqlite *db, int64_t audio, int64_t time_ns, const void *frames,
                                     size_t size, error *err);

CHECKED mrt_result show_audio_check(show *self, int64_t audio, error *err);

/* Ends the tracks, performances and takes that a killed program left open, each at its last sample.
 * *out_take_count: number of these takes. */
CHECKED mrt_result show_close_open_ends(sqlite *db, int64_t *out_take_count, error *err);

#endif
