/* show/sqlite.h - the only files that see SQLite: opening, statements, errors as ours. Leaves out
 * what is in the tables (show_schema.h). A connection belongs to one thread at a time.
 *
 * A file is only data, whoever made it. SQLite is opened on nothing but a file with our mark in its
 * header; it can touch no other files than that one and its -wal, -shm and -journal; nothing in the
 * file runs; every row's values are of the kind that the query says, or the row is damage; and what
 * a query may cost is bounded by the size of the file (base/budget.h). */
#ifndef MAROTTE_TAKE_SQLITE_H
#define MAROTTE_TAKE_SQLITE_H
#include "base/error.h"

enum { SQLITE_APPLICATION = 0x4d615254 }; /* "MaRT" in the header: the application's id */

typedef struct sqlite sqlite;
typedef struct sqlite_statement sqlite_statement;

typedef enum sqlite_mode {
    SQLITE_MODE_READ = 0,
    SQLITE_MODE_READ_FROZEN, /* the file alone, as it is: no lock, no side files; it must not change
                              */
    SQLITE_MODE_WRITE,       /* it must exist */
    SQLITE_MODE_MAKE         /* it must be empty, or not there */
} sqlite_mode;

/* What kind of failure the last call on this connection was. */
typedef enum sqlite_trouble {
    SQLITE_TROUBLE_NONE = 0,
    SQLITE_TROUBLE_FULL,     /* no space, or the disk refuses to write: it may work again later */
    SQLITE_TROUBLE_BUSY,     /* somebody else writes */
    SQLITE_TROUBLE_READONLY, /* this file or folder cannot be written */
    SQLITE_TROUBLE_OPEN,     /* it or a file beside it cannot be opened */
    SQLITE_TROUBLE_DAMAGED,  /* not a database, or damaged */
    SQLITE_TROUBLE_OTHER
} sqlite_trouble;

/* The connection waits up to 5 s for others that write. Failures name the path. Its statements end
 * when the person cancels (base/cancel.h), and all of them are paid out of one budget. */
CHECKED mrt_result sqlite_open(sqlite **out, const char *path, sqlite_mode mode, error *err);
void sqlite_close(sqlite *self); /* its statements first; NULL is fine */
sqlite_trouble sqlite_trouble_of(const sqlite *self);

/* From now on each statement has a budget of its own: for a connection that is used for hours. */
void sqlite_limit_each(sqlite *self);
/* From now on all statements together have one budget: for a command. */
void sqlite_limit_all(sqlite *self);
/* From now on cancelling does not end its statements: they keep what was recorded. */
void sqlite_ignore_cancel(sqlite *self);
/* The file will become about so large: its statements may cost as much. */
void sqlite_expect(sqlite *self, uint64_t file_size);
/* Pays for work that is done with what was read; steps as in base/budget.h. */
CHECKED mrt_result sqlite_spend(sqlite *self, uint64_t steps, error *err);
const char *sqlite_path(const sqlite *self);
/* Bytes of the file when it was opened, its log too. */
uint64_t sqlite_file_size(const sqlite *self);

/* Statements separated by ';', without results. */
CHECKED mrt_result sqlite_run(sqlite *self, const char *sql, error *err);
/* The first column, a number, of the first row of a query without parameters; `fallback` when there
 * is no row or it is NULL. */
CHECKED mrt_result sqlite_number(sqlite *self, const char *sql, int64_t fallback, int64_t *out,
                                 error *err);
/* A transaction: begin, what the caller does, end; `result` < 0 rolls it back and is returned. */
CHECKED mrt_result sqlite_begin(sqlite *self, error *err);
CHECKED mrt_result sqlite_end(sqlite *self, mrt_result result, error *err);

/* columns: what each column of a row holds, one letter each; a row that holds something else is a
 * failure of the step, "is damaged". sqlite_get reads them by the same letters:
 *   i  whole number: int64_t *       u, w  the same: uint32_t *, int32_t *
 *   z  the same: bool *, not 0
 *   n  the same, a time: int64_t *, as sqlite_time has it
 *   f  finite number: double *               d  any number: double *
 *   t  text: char * and size_t, as sqlite_text has it
 *   s  text as a person may see it, all of it: char **, to be freed
 *   x  text, the very bytes: char **, to be freed
 *   b  blob   *  anything; neither is read by sqlite_get
 * A capital letter: the same, or NULL, which is read as 0, "" or, as X, NULL. */
CHECKED mrt_result sqlite_prepare(sqlite *self, sqlite_statement **out, const char *sql,
                                  const char *columns, error *err);
void sqlite_finish(sqlite_statement *statement); /* NULL is fine */

/* Resets the statement and sets its parameters in order, one letter each:
 *   i int64_t, o const int64_t * (NULL: NULL), d double, t const char * (NULL: NULL),
 *   b const void * and size_t
 * Texts and blobs must live until the last step. A failure is reported by the next step. */
void sqlite_bind(sqlite_statement *statement, const char *format, ...);

/* MRT_OK: there is a row; MRT_END: there is none left; < 0: failed. */
CHECKED mrt_result sqlite_step(sqlite_statement *statement, error *err);
/* For statements without rows. */
CHECKED mrt_result sqlite_execute(sqlite_statement *statement, error *err);
void sqlite_reset(sqlite_statement *statement); /* lets go of the row: others may go on */

/* The above in one: prepare, bind, execute, finish. */
CHECKED mrt_result sqlite_change(sqlite *self, error *err, const char *sql, const char *format,
                                 ...);
/* Prepared and bound, to be stepped and finished. A failure is reported by the first step. */
sqlite_statement *sqlite_query(sqlite *self, const char *sql, const char *columns,
                               const char *format, ...);
/* As sqlite_step of a query that finds one row; without one: "PATH: has no WHAT ID". */
CHECKED mrt_result sqlite_step_one(sqlite_statement *statement, const char *what, int64_t id,
                                   error *err);
/* Finishes a query whose rows were read; `result`: of the last step or of who read them. A failure
 * is given back, all else is MRT_OK. */
CHECKED mrt_result sqlite_finish_rows(sqlite_statement *statement, mrt_result result);

/* The columns of the row in order, as their letters say, each into what follows `err`. It fails
 * for want of memory alone; texts that were not copied are NULL then. */
CHECKED mrt_result sqlite_get(sqlite_statement *statement, error *err, ...);
/* Of the row; columns from 0; pointers until the next step or reset. */
int64_t sqlite_int(sqlite_statement *statement, int column);
/* A time that the file says, ns: within half of what 64 bits hold, so that the difference of two
 * never overflows. What lies beyond is no time of anything that was recorded. */
int64_t sqlite_time(sqlite_statement *statement, int column);
/* Text as a person may see it (base/text.h), cut to the capacity; "" when NULL. */
void sqlite_text(sqlite_statement *statement, int column, char *out, size_t capacity);
/* The very bytes, to be parsed or hashed: they are never shown. "" when NULL or no memory. */
const char *sqlite_exact_text(sqlite_statement *statement, int column);
/* Never NULL; of size 0 when the column is. */
const uint8_t *sqlite_blob(sqlite_statement *statement, int column, size_t *out_size);
/* Whether the column holds what the letter says: for those of '*'. */
bool sqlite_is(sqlite_statement *statement, int column, char kind);
bool sqlite_is_null(sqlite_statement *statement, int column);
int64_t sqlite_changes(const sqlite *self); /* rows that the last execute changed */
int64_t sqlite_last_id(const sqlite *self); /* of the last row that this connection inserted */

/* Binds the columns of the row that `from` stands on to the parameters of `to`, one to one; those
 * that the row has not are NULL. They are read by the next step of `to`. */
void sqlite_bind_row(sqlite_statement *to, sqlite_statement *from);
/* A copy of what is committed, page by page, while others write. The file must be empty. */
CHECKED mrt_result sqlite_copy(sqlite *self, const char *out_path, error *err);

/* Moves what the write-ahead log holds into the file, as far as nobody reads it; waits for nobody.
 */
CHECKED mrt_result sqlite_checkpoint(sqlite *self, error *err);

#endif
