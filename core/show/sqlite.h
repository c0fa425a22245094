/* show/sqlite.h - the adapter to SQLite: connections, statements, and errors as marotte's. Only
 * sqlite.c uses SQLite itself. Leaves out the tables (show_schema.h). A connection belongs to one
 * thread at a time.
 *
 * Every file is untrusted. SQLite opens a file only if its header has marotte's application id. It
 * can access only that file and its -wal, -shm and -journal. Code in the file never runs. Each
 * value of a row must have the type that the query declares, else the row is damaged. The work of a
 * query is limited by the size of the file (base/budget.h). */
#ifndef MAROTTE_TAKE_SQLITE_H
#define MAROTTE_TAKE_SQLITE_H
#include "base/error.h"

enum { SQLITE_APPLICATION = 0x4d615254 }; /* "MaRT" in the header: the application id */

typedef struct sqlite sqlite;
typedef struct sqlite_statement sqlite_statement;

typedef enum sqlite_mode {
    SQLITE_MODE_READ = 0,
    SQLITE_MODE_READ_FROZEN, /* only the file, without lock or side files. Statements fail as soon
                                as a program begins to write the show */
    SQLITE_MODE_WRITE,       /* the file must exist */
    SQLITE_MODE_MAKE         /* the file must be empty or missing */
} sqlite_mode;

/* The kind of failure of the last call on a connection. */
typedef enum sqlite_trouble {
    SQLITE_TROUBLE_NONE = 0,
    SQLITE_TROUBLE_FULL,     /* no space, or a failed write; a retry may succeed later */
    SQLITE_TROUBLE_BUSY,     /* another connection is writing */
    SQLITE_TROUBLE_READONLY, /* the file or folder cannot be written */
    SQLITE_TROUBLE_OPEN,     /* the file or a file beside it cannot be opened */
    SQLITE_TROUBLE_DAMAGED,  /* not a database, or damaged */
    SQLITE_TROUBLE_OTHER
} sqlite_trouble;

/* Opens a connection, which waits up to 5 s for other writers. Errors name the path. Statements end
 * if the user cancels (base/cancel.h). All statements share one budget. */
CHECKED mrt_result sqlite_open(sqlite **out, const char *path, sqlite_mode mode, error *err);
void sqlite_close(sqlite *self); /* finish its statements first; accepts NULL */
sqlite_trouble sqlite_trouble_of(const sqlite *self);

/* Gives each further statement a separate budget, for a connection that is used for hours. */
void sqlite_limit_each(sqlite *self);
/* Gives all further statements one common budget, for a command. */
void sqlite_limit_all(sqlite *self);
/* Makes further statements ignore cancelling, because they save what was recorded. */
void sqlite_ignore_cancel(sqlite *self);
/* Sets the expected size of the file, which sets the budget of its statements. */
void sqlite_expect(sqlite *self, uint64_t file_size);
/* Pays for work on data that was read; steps as in base/budget.h. */
CHECKED mrt_result sqlite_spend(sqlite *self, uint64_t steps, error *err);
const char *sqlite_path(const sqlite *self);
/* Returns the size of the file when it was opened, in bytes, including its write-ahead log. */
uint64_t sqlite_file_size(const sqlite *self);

/* Runs statements without results, separated by ';'. */
CHECKED mrt_result sqlite_run(sqlite *self, const char *sql, error *err);
/* Reads a number from the first column of the first row of a query without parameters. `fallback`
 * if there is no row or it is NULL. */
CHECKED mrt_result sqlite_number(sqlite *self, const char *sql, int64_t fallback, int64_t *out,
                                 error *err);
/* Begin and end a transaction. sqlite_end with `result` < 0 rolls it back and returns `result`. */
CHECKED mrt_result sqlite_begin(sqlite *self, error *err);
CHECKED mrt_result sqlite_end(sqlite *self, mrt_result result, error *err);

/* Prepares a query. `columns` declares the type of each column by one letter. If a row holds
 * another type, the step fails with "is damaged". sqlite_get uses the same letters:
 *   i  whole number: int64_t *       u, w  the same: uint32_t *, int32_t *
 *   z  the same: bool *, true if not 0
 *   n  the same, a time: int64_t *, see sqlite_time
 *   f  finite number: double *               d  any number: double *
 *   t  text: char * and size_t, see sqlite_text
 *   s  complete printable text: char **, which the caller frees
 *   x  unchanged text: char **, which the caller frees
 *   b  blob   *  any type; sqlite_get skips both
 * A capital letter also allows NULL, which is read as 0 or ""; X reads it as NULL. */
CHECKED mrt_result sqlite_prepare(sqlite *self, sqlite_statement **out, const char *sql,
                                  const char *columns, error *err);
void sqlite_finish(sqlite_statement *statement); /* accepts NULL */

/* Resets the statement and binds its parameters in order, one letter each:
 *   i int64_t, o const int64_t * (NULL: NULL), d double, t const char * (NULL: NULL),
 *   b const void * and size_t
 * Texts and blobs must stay valid until the last step. The next step reports a failure. */
void sqlite_bind(sqlite_statement *statement, const char *format, ...);

/* Steps to the next row. MRT_OK: a row; MRT_END: no more rows; < 0: failed. */
CHECKED mrt_result sqlite_step(sqlite_statement *statement, error *err);
/* Runs a statement without rows. */
CHECKED mrt_result sqlite_execute(sqlite_statement *statement, error *err);
void sqlite_reset(sqlite_statement *statement); /* releases the row and its read lock */

/* Prepares, binds, executes and finishes a statement. */
CHECKED mrt_result sqlite_change(sqlite *self, error *err, const char *sql, const char *format,
                                 ...);
/* Prepares and binds a query; the caller steps and finishes it. The first step reports a failure.
 */
sqlite_statement *sqlite_query(sqlite *self, const char *sql, const char *columns,
                               const char *format, ...);
/* Steps a query that must find one row. Without a row the error is "PATH: has no WHAT ID". */
CHECKED mrt_result sqlite_step_one(sqlite_statement *statement, const char *what, int64_t id,
                                   error *err);
/* Finishes a query after its rows were read. `result`: of the last step or of the reader. Returns a
 * failure unchanged, and MRT_OK for any other result. */
CHECKED mrt_result sqlite_finish_rows(sqlite_statement *statement, mrt_result result);

/* Reads the columns of the row in order, according to their letters, into the arguments after
 * `err`. Fails only if memory runs out; texts that were not copied are then NULL. */
CHECKED mrt_result sqlite_get(sqlite_statement *statement, error *err, ...);
/* Read one column of the row, numbered from 0. Pointers are valid until the next step or reset. */
int64_t sqlite_int(sqlite_statement *statement, int column);
/* Returns a time of the file in ns, clamped to half of the 64-bit range, so that the difference of
 * two times never overflows. No recorded time is outside that range. */
int64_t sqlite_time(sqlite_statement *statement, int column);
/* Copies text in printable form (base/text.h), cut to the capacity; NULL becomes "". */
void sqlite_text(sqlite_statement *statement, int column, char *out, size_t capacity);
/* Returns the unchanged text for parsing or hashing, never for display. "" if NULL or out of
 * memory. */
const char *sqlite_exact_text(sqlite_statement *statement, int column);
/* Never returns NULL; the size is 0 if the column is NULL. */
const uint8_t *sqlite_blob(sqlite_statement *statement, int column, size_t *out_size);
/* Returns true if the column has the type of the letter, for columns declared as '*'. */
bool sqlite_is(sqlite_statement *statement, int column, char kind);
bool sqlite_is_null(sqlite_statement *statement, int column);
int64_t sqlite_changes(const sqlite *self); /* rows changed by the last execute */
int64_t sqlite_last_id(const sqlite *self); /* id of the last row inserted by this connection */

/* Binds the columns of the current row of `from` to the parameters of `to`, one to one. Missing
 * columns are NULL. The next step of `to` reads them. */
void sqlite_bind_row(sqlite_statement *to, sqlite_statement *from);
/* Copies the committed data page by page, while other connections may write. The file at out_path
 * must be empty. */
CHECKED mrt_result sqlite_copy(sqlite *self, const char *out_path, error *err);

/* Moves the write-ahead log into the file, as far as no reader prevents it. Never waits. */
CHECKED mrt_result sqlite_checkpoint(sqlite *self, error *err);

#endif
