/* show/show_file.h - the open show, and what its files, its writer and its journal share; for this
 * room. Calls nothing of those files. */
#ifndef MAROTTE_TAKE_SHOW_FILE_H
#define MAROTTE_TAKE_SHOW_FILE_H
#include "show/show.h"
#include "show/sqlite.h"

#include <sys/types.h>

/* ---- who may write ---- */

/* An advisory lock on NAME.marotte-lock, which says who holds it. The system lets go of it when the
 * holder ends, however it ends, so it is never stale. */
typedef struct show_lock {
    int fd; /* -1: not held */
    char *path;
} show_lock;

typedef enum show_lock_state {
    SHOW_LOCK_HELD = 0,
    SHOW_LOCK_OTHERS, /* `who` says whose: "process 4711 on studio since 2026-11-21 18:54:23 UTC" */
    SHOW_LOCK_REFUSED, /* the lock file cannot be made here: `who` says why */
} show_lock_state;

/* Never waits. `out` is to be let go whatever comes back. */
show_lock_state show_lock_take(show_lock *out, const char *show_path, char who[256]);
void show_lock_let_go(show_lock *lock); /* accepts one that was never taken, zeroed or with fd -1 */

/* ---- the open show ---- */

typedef enum show_id { SHOW_ID_TRACK, SHOW_ID_PERFORMANCE, SHOW_ID_TAKE, SHOW_ID_COUNT } show_id;

struct show {
    sqlite *db;
    char *path;
    int64_t version; /* of its tables */
    bool is_writable;
    char notice[1024];
    show_lock lock;
    dev_t device; /* and inode: of the file that is open */
    ino_t inode;
    struct show *owner;                     /* whose ids it gives out; NULL: its own */
    _Atomic int64_t last_id[SHOW_ID_COUNT]; /* given out, so that a row can be named before it is
                                               written; by the writer's callers too */
};

/* Connection of its own to the file, for the writer. */
CHECKED mrt_result show_connect(const show *self, sqlite **out, error *err);
/* As every connection that writes is set. */
CHECKED mrt_result show_configure(sqlite *db, error *err);
int64_t show_next_id(show *self, show_id of);
/* The path with the suffix, to be freed; NULL: no memory. */
char *show_beside(const char *path, const char *suffix);
/* MRT_ERR_UNSUPPORTED with the reason when the show can only be read. */
CHECKED mrt_result show_check_writable(const show *self, error *err);

/* A list of what the rows of a query say; finishes the query. On failure there is no list: items
 * own nothing. */
typedef struct show_rows {
    void *item; /* owned */
    size_t count;
} show_rows;
CHECKED mrt_result show_read_rows(show_rows *out, sqlite_statement *rows, size_t item_size,
                                  mrt_result (*read)(void *item, sqlite_statement *row, error *err),
                                  error *err);
/* What is stored of an edit beside its text: an edit that moved or changed is noticed. */
int64_t show_edit_crc(int64_t take, int32_t n, const char *json);
/* n <= 0: part of how the take was made. In somebody's transaction. */
CHECKED mrt_result show_edit_insert(sqlite *db, int64_t take_id, int32_t n, int64_t utc_ms,
                                    const char *json, error *err);
/* The first column of all rows. */
CHECKED mrt_result show_read_ids(show *self, const char *sql, int64_t **out, size_t *out_count,
                                 error *err);
/* Room for one more item than `count`; items are to be added one by one. */
CHECKED mrt_result show_grow(void **list, size_t count, size_t item_size, error *err);

/* Rows of a take, in somebody's transaction. `end_ns` NULL of a take or a span: it goes on. */
typedef struct show_take_row {
    int64_t id, created_ns, start_ns;
    const int64_t *end_ns;
    const char *scene, *shot, *origin;
    uint32_t number; /* 0: the slate's next one */
} show_take_row;
CHECKED mrt_result show_take_insert(sqlite *db, const show_take_row *row, error *err);
CHECKED mrt_result show_span_insert(sqlite *db, int64_t take, int64_t performance, int64_t from_ns,
                                    const int64_t *to_ns, bool is_shown, error *err);

/* What is recorded, in the writer's transaction; times are show time. */
CHECKED mrt_result show_track_insert(sqlite *db, int64_t session, const take_track *track,
                                     error *err);
CHECKED mrt_result show_performance_insert(sqlite *db, int64_t session,
                                           const take_performance *performance, int64_t from_ns,
                                           error *err);
CHECKED mrt_result show_event_insert(sqlite *db, const take_event *event, error *err);
/* A checkpoint's bytes as they are stored. */
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

/* Ends what a killed program left open, at its last sample; *out_take_count takes among it. */
CHECKED mrt_result show_close_open_ends(sqlite *db, int64_t *out_take_count, error *err);

#endif
