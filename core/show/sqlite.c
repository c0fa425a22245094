#include "show/sqlite.h"

#include "base/os.h"
#include "base/budget.h"
#include "base/cancel.h"
#include "base/file.h"
#include "base/text.h"

#include <ctype.h>
#include <limits.h>
#include <math.h>
#include <sqlite3.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum {
    BUSY_MS = 5000,
    VALUE_BYTES_MAX = 256 * 1024 * 1024, /* maximum columns of a row; more columns are damage */
    SQL_BYTES_MAX = 100000,
    IDLE_MAX = 32,         /* cached statements */
    OPCODES_A_LOOK = 1000, /* opcodes of SQLite between two checks of the limits */
    STEPS_A_LOOK = 2500,   /* budget steps per opcode (base/budget.h): an opcode takes 25 ns */
    TIDY_PATIENCE_MS = 5000,
    HEADER_BYTES = 100,
    HEADER_APPLICATION = 68
};

/* A file system for SQLite that allows access only to the files of one connection. */
typedef struct guard {
    sqlite3_vfs vfs, *base;
    char name[32];
    char *path;      /* path of the opened file; owned */
    bool is_fresh;   /* the file is being created */
    bool is_show;    /* by its header */
    bool is_foreign; /* the file is the database of another program */
} guard;

struct sqlite {
    guard files;
    sqlite3 *handle;
    char *path;
    bool is_reader, had_index; /* had_index: a -shm existed before */
    bool must_be_still;        /* read without locks, and no program wrote it at the start */
    int code;                  /* extended code of the last failure */
    uint64_t file_size;
    budget left;
    error over_budget; /* error of the exhausted budget; "" */
    bool ignores_cancel, limits_each;
    sqlite_statement *idle[IDLE_MAX]; /* the oldest first */
    uint32_t idle_count;
};

struct sqlite_statement {
    sqlite *owner;
    sqlite3_stmt *handle;
    const char *columns; /* types of its columns */
    int bind_code;       /* code of the first failed bind */
};

/* ---- failures ---- */

static bool is_reading(int code)
{
    return code == SQLITE_IOERR_READ || code == SQLITE_IOERR_SHORT_READ ||
           code == SQLITE_IOERR_DATA || code == SQLITE_IOERR_CORRUPTFS;
}

sqlite_trouble sqlite_trouble_of(const sqlite *self)
{
    switch (self->code & 255) {
    case SQLITE_OK:
        return SQLITE_TROUBLE_NONE;
    case SQLITE_FULL:
        return SQLITE_TROUBLE_FULL;
    case SQLITE_IOERR:
        return is_reading(self->code) ? SQLITE_TROUBLE_DAMAGED : SQLITE_TROUBLE_FULL;
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
    case SQLITE_PROTOCOL:
        return SQLITE_TROUBLE_BUSY;
    case SQLITE_READONLY:
    case SQLITE_PERM:
        return SQLITE_TROUBLE_READONLY;
    case SQLITE_CANTOPEN:
        return SQLITE_TROUBLE_OPEN;
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB:
        return SQLITE_TROUBLE_DAMAGED;
    default:
        return SQLITE_TROUBLE_OTHER;
    }
}

static const char *advice(sqlite_trouble trouble)
{
    switch (trouble) {
    case SQLITE_TROUBLE_FULL:
        return ": free space on the disk";
    case SQLITE_TROUBLE_BUSY:
        return ": another program uses it; close that program";
    case SQLITE_TROUBLE_READONLY:
        return ": copy it to a place where you may write";
    case SQLITE_TROUBLE_DAMAGED:
        return ": it is not a show or it is damaged; recover it with marotte take recover";
    default:
        return "";
    }
}

static mrt_result failed(sqlite *self, int code, error *err)
{
    self->code = code;
    if ((code & 255) == SQLITE_INTERRUPT && self->over_budget.text[0])
        return error_set(err, MRT_ERR_FORMAT, "%s: %s", self->path, self->over_budget.text);
    if ((code & 255) == SQLITE_INTERRUPT)
        return error_set(err, MRT_ERR_IO, "%s: stopped", self->path);
    if (self->files.is_foreign)
        return error_set(err, MRT_ERR_FORMAT, "%s: is an SQLite file, but not a marotte show",
                         self->path);
    sqlite_trouble trouble = sqlite_trouble_of(self);
    const char *text = self->handle && sqlite3_errcode(self->handle) == (code & 255)
                           ? sqlite3_errmsg(self->handle)
                           : sqlite3_errstr(code);
    mrt_result result = (code & 255) == SQLITE_NOMEM         ? MRT_ERR_MEMORY
                        : trouble == SQLITE_TROUBLE_DAMAGED  ? MRT_ERR_FORMAT
                        : trouble == SQLITE_TROUBLE_READONLY ? MRT_ERR_UNSUPPORTED
                        : (code & 255) == SQLITE_TOOBIG      ? MRT_ERR_ARGUMENT
                        : (code & 255) == SQLITE_CONSTRAINT  ? MRT_ERR_ARGUMENT
                        : trouble == SQLITE_TROUBLE_OTHER    ? MRT_ERR_FORMAT
                                                             : MRT_ERR_IO;
    return error_set(err, result, "%s: %s%s", self->path, text, advice(trouble));
}

static mrt_result result_of(sqlite *self, int code, error *err)
{
    if (code == SQLITE_OK) {
        self->code = SQLITE_OK;
        return MRT_OK;
    }
    return failed(self, code, err);
}

/* ---- the files that SQLite may access ---- */

static guard *guard_of(sqlite3_vfs *vfs)
{
    return vfs->pAppData;
}

/* Returns true for the file itself ("") and for the files that SQLite keeps beside it. */
static bool is_own(const guard *self, const char *path, bool is_itself_too)
{
    size_t length = self->path ? strlen(self->path) : 0;
    if (length == 0 || !path || strncmp(path, self->path, length) != 0)
        return false;
    const char *rest = path + length;
    return (is_itself_too && !rest[0]) || strcmp(rest, "-journal") == 0 ||
           strcmp(rest, "-wal") == 0;
}

/* Only regular files may be opened: opening a pipe could block forever. */
static bool may_be_opened(const char *path)
{
    struct stat status;
    return os_stat_link(path, &status) != 0 || S_ISREG(status.st_mode);
}

/* Checks that the file is a show before any file beside it is opened. */
static int check_header(guard *self, sqlite3_file *file)
{
    static const char magic[16] = "SQLite format 3";
    unsigned char header[HEADER_BYTES];
    if (self->is_fresh)
        return SQLITE_OK;
    if (file->pMethods->xRead(file, header, HEADER_BYTES, 0) != SQLITE_OK ||
        memcmp(header, magic, sizeof magic) != 0)
        return SQLITE_NOTADB;
    const unsigned char *id = header + HEADER_APPLICATION;
    self->is_foreign = ((uint32_t)id[0] << 24 | (uint32_t)id[1] << 16 | (uint32_t)id[2] << 8 |
                        id[3]) != SQLITE_APPLICATION;
    self->is_show = !self->is_foreign;
    return self->is_show ? SQLITE_OK : SQLITE_NOTADB;
}

static int open_main(guard *self, const char *path, sqlite3_file *file, int flags, int *out_flags)
{
    if (self->path) /* one is enough */
        return SQLITE_CANTOPEN;
    self->path = strdup(path);
    int code =
        self->path ? self->base->xOpen(self->base, path, file, flags, out_flags) : SQLITE_NOMEM;
    if (code == SQLITE_OK)
        code = check_header(self, file);
    if (code != SQLITE_OK && file->pMethods) {
        (void)file->pMethods->xClose(file);
        file->pMethods = NULL;
    }
    return code;
}

/* Opens a file for SQLite. A file without a name is a temporary file, which SQLite creates in a
 * private place. A journal could name a super-journal, which SQLite would read and delete; that is
 * refused. */
static int guard_open(sqlite3_vfs *vfs, const char *path, sqlite3_file *file, int flags,
                      int *out_flags)
{
    guard *self = guard_of(vfs);
    file->pMethods = NULL;
    if (path && !may_be_opened(path))
        return SQLITE_CANTOPEN;
    if (path && flags & SQLITE_OPEN_MAIN_DB)
        return open_main(self, path, file, flags, out_flags);
    const int beside = SQLITE_OPEN_MAIN_JOURNAL | SQLITE_OPEN_WAL;
    if (path && !(flags & beside && is_own(self, path, false)))
        return SQLITE_CANTOPEN;
    return self->base->xOpen(self->base, path, file, flags, out_flags);
}

static int guard_delete(sqlite3_vfs *vfs, const char *path, int sync_folder)
{
    guard *self = guard_of(vfs);
    return is_own(self, path, false) ? self->base->xDelete(self->base, path, sync_folder)
                                     : SQLITE_IOERR_DELETE;
}

static int guard_access(sqlite3_vfs *vfs, const char *path, int flags, int *out)
{
    guard *self = guard_of(vfs);
    *out = 0;
    return is_own(self, path, true) ? self->base->xAccess(self->base, path, flags, out) : SQLITE_OK;
}

static int guard_full_path(sqlite3_vfs *vfs, const char *path, int capacity, char *out)
{
    guard *self = guard_of(vfs);
    return self->base->xFullPathname(self->base, path, capacity, out);
}

static void *guard_library(sqlite3_vfs *vfs, const char *path)
{
    (void)vfs, (void)path;
    return NULL;
}

static int guard_randomness(sqlite3_vfs *vfs, int size, char *out)
{
    guard *self = guard_of(vfs);
    return self->base->xRandomness(self->base, size, out);
}

static int guard_sleep(sqlite3_vfs *vfs, int time_us)
{
    guard *self = guard_of(vfs);
    return self->base->xSleep(self->base, time_us);
}

static int guard_time(sqlite3_vfs *vfs, double *out)
{
    guard *self = guard_of(vfs);
    return self->base->xCurrentTime(self->base, out);
}

static int guard_time_ms(sqlite3_vfs *vfs, sqlite3_int64 *out)
{
    guard *self = guard_of(vfs);
    return self->base->xCurrentTimeInt64(self->base, out);
}

static int guard_last_error(sqlite3_vfs *vfs, int capacity, char *out)
{
    guard *self = guard_of(vfs);
    return self->base->xGetLastError(self->base, capacity, out);
}

/* SQLite finds the file system by its name while it opens the file, and never afterwards. */
static int guard_init(guard *self, bool is_fresh)
{
    sqlite3_vfs *base = sqlite3_vfs_find(NULL);
    if (!base)
        return SQLITE_ERROR;
    *self = (guard){.base = base, .is_fresh = is_fresh};
    (void)snprintf(self->name, sizeof self->name, "show-%p", (void *)self);
    self->vfs = (sqlite3_vfs){.iVersion = 2,
                              .szOsFile = base->szOsFile,
                              .mxPathname = base->mxPathname,
                              .zName = self->name,
                              .pAppData = self,
                              .xOpen = guard_open,
                              .xDelete = guard_delete,
                              .xAccess = guard_access,
                              .xFullPathname = guard_full_path,
                              .xDlOpen = guard_library,
                              .xRandomness = guard_randomness,
                              .xSleep = guard_sleep,
                              .xCurrentTime = guard_time,
                              .xGetLastError = guard_last_error,
                              .xCurrentTimeInt64 = guard_time_ms};
    return sqlite3_vfs_register(&self->vfs, 0);
}

/* ---- the budget ---- */

static bool is_cancelled(const sqlite *self)
{
    return !self->ignores_cancel && cancel_is_requested();
}

static int look(void *data)
{
    sqlite *self = data;
    if (is_cancelled(self))
        return 1;
    return budget_spend_work(&self->left, STEPS_A_LOOK, &self->over_budget) < 0;
}

static void refill(sqlite *self)
{
    self->left = budget_of(BUDGET_SHOW, self->file_size);
    self->over_budget.text[0] = '\0';
}

void sqlite_limit_each(sqlite *self)
{
    self->limits_each = true;
    refill(self);
}

void sqlite_limit_all(sqlite *self)
{
    self->limits_each = false;
    refill(self);
}

void sqlite_expect(sqlite *self, uint64_t file_size)
{
    self->file_size = file_size;
    refill(self);
}

void sqlite_ignore_cancel(sqlite *self)
{
    self->ignores_cancel = true;
}

mrt_result sqlite_spend(sqlite *self, uint64_t steps, error *err)
{
    if (budget_spend_work(&self->left, steps, &self->over_budget) >= 0)
        return MRT_OK;
    return error_set(err, MRT_ERR_FORMAT, "%s: %s", self->path, self->over_budget.text);
}

const char *sqlite_path(const sqlite *self)
{
    return self->path;
}

uint64_t sqlite_file_size(const sqlite *self)
{
    return self->file_size;
}

/* ---- opening ---- */

/* Returns "file:" and the path, with each special byte of a URI as %xx. */
static char *uri_of(const char *path, bool frozen)
{
    size_t length = strlen(path);
    char *uri = malloc(3 * length + 32);
    if (!uri)
        return NULL;
    char *at = uri + sprintf(uri, path[0] == '/' ? "file://" : "file:");
    for (const char *c = path; *c; ++c) {
        if (strchr("?#%", *c))
            at += sprintf(at, "%%%02X", (unsigned char)*c);
        else
            *at++ = *c;
    }
    (void)sprintf(at, "%s", frozen ? "?immutable=1" : "");
    return uri;
}

static int configure(sqlite *self)
{
    static const struct setting {
        int option, value;
    } settings[] =
        {
            {SQLITE_DBCONFIG_DEFENSIVE, 1},      {SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0},
            {SQLITE_DBCONFIG_ENABLE_TRIGGER, 0}, {SQLITE_DBCONFIG_ENABLE_VIEW, 0},
            {SQLITE_DBCONFIG_ENABLE_FKEY, 1},    {SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 0},
            {SQLITE_DBCONFIG_DQS_DDL, 0},        {SQLITE_DBCONFIG_DQS_DML, 0},
        },
      limits[] = {
          {SQLITE_LIMIT_LENGTH, VALUE_BYTES_MAX},
          {SQLITE_LIMIT_SQL_LENGTH, SQL_BYTES_MAX},
          {SQLITE_LIMIT_ATTACHED, 0},
          {SQLITE_LIMIT_COLUMN, 100},
          {SQLITE_LIMIT_EXPR_DEPTH, 100},
          {SQLITE_LIMIT_COMPOUND_SELECT, 10},
          {SQLITE_LIMIT_VDBE_OP, 25000},
          {SQLITE_LIMIT_FUNCTION_ARG, 10},
          {SQLITE_LIMIT_LIKE_PATTERN_LENGTH, 50},
          {SQLITE_LIMIT_VARIABLE_NUMBER, 32},
          {SQLITE_LIMIT_TRIGGER_DEPTH, 1},
      };
    for (size_t i = 0; i < sizeof settings / sizeof settings[0]; ++i) {
        int code = sqlite3_db_config(self->handle, settings[i].option, settings[i].value, NULL);
        if (code != SQLITE_OK)
            return code;
    }
    for (size_t i = 0; i < sizeof limits / sizeof limits[0]; ++i)
        sqlite3_limit(self->handle, limits[i].option, limits[i].value);
    sqlite3_progress_handler(self->handle, OPCODES_A_LOOK, look, self);
    int code = sqlite3_exec(self->handle, "PRAGMA cell_size_check = ON", NULL, NULL, NULL);
    return code == SQLITE_OK ? sqlite3_busy_timeout(self->handle, BUSY_MS) : code;
}

/* Returns the bytes of the file and its log, which set the budget. Holes of a sparse file do not
 * count. */
static uint64_t measure(const char *path)
{
    char log[4096];
    (void)snprintf(log, sizeof log, "%s-wal", path);
    return file_data_size(path) + file_data_size(log);
}

static bool is_there(const char *path, const char *suffix, struct stat *out)
{
    char beside[PATH_MAX];
    const int length = snprintf(beside, sizeof beside, "%s%s", path, suffix);
    return length < (int)sizeof beside && os_stat_link(beside, out) == 0;
}

static int open_handle(sqlite *self, sqlite_mode mode)
{
    struct stat ignored;
    static const int mode_flags[] = {
        [SQLITE_MODE_READ] = SQLITE_OPEN_READONLY,
        [SQLITE_MODE_READ_FROZEN] = SQLITE_OPEN_READONLY,
        [SQLITE_MODE_WRITE] = SQLITE_OPEN_READWRITE,
        [SQLITE_MODE_MAKE] = SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE,
    };
    char *uri = uri_of(self->path, mode == SQLITE_MODE_READ_FROZEN);
    if (!uri)
        return SQLITE_NOMEM;
    int flags = mode_flags[mode] | SQLITE_OPEN_URI | SQLITE_OPEN_FULLMUTEX;
    int code = guard_init(&self->files, mode == SQLITE_MODE_MAKE);
    self->is_reader = mode == SQLITE_MODE_READ;
    self->had_index = is_there(self->path, "-shm", &ignored);
    self->must_be_still =
        mode == SQLITE_MODE_READ_FROZEN && !is_there(self->path, "-lock", &ignored);
    if (code == SQLITE_OK) {
        code = sqlite3_open_v2(uri, &self->handle, flags, self->files.name);
        if (code != SQLITE_OK && self->handle)
            code = sqlite3_extended_errcode(self->handle);
        if (self->handle)
            (void)sqlite3_extended_result_codes(self->handle, 1);
        (void)sqlite3_vfs_unregister(&self->files.vfs);
    }
    free(uri);
    self->file_size = measure(self->path);
    refill(self);
    return code == SQLITE_OK ? configure(self) : code;
}

static mrt_result allocate(sqlite **out, const char *path, error *err)
{
    *out = calloc(1, sizeof **out);
    if (*out)
        (*out)->path = strdup(path);
    if (*out && (*out)->path)
        return MRT_OK;
    free(*out);
    *out = NULL;
    return error_set(err, MRT_ERR_MEMORY, "%s: no memory", path);
}

static mrt_result opened(sqlite **out, int code, error *err)
{
    mrt_result result = result_of(*out, code, err);
    if (result < 0) {
        sqlite_close(*out);
        *out = NULL;
    }
    return result;
}

mrt_result sqlite_open(sqlite **out, const char *path, sqlite_mode mode, error *err)
{
    mrt_result result = allocate(out, path, err);
    return result < 0 ? result : opened(out, open_handle(*out, mode), err);
}

static void destroy(sqlite_statement *statement)
{
    (void)sqlite3_finalize(statement->handle);
    free(statement);
}

/* ---- files that a reader leaves ---- */

static void remove_beside(const char *path, const char *suffix)
{
    char beside[PATH_MAX];
    struct stat status;
    if (is_there(path, suffix, &status) && S_ISREG(status.st_mode) &&
        snprintf(beside, sizeof beside, "%s%s", path, suffix) < (int)sizeof beside)
        (void)unlink(beside);
}

/* Removes the -wal and -shm. With the exclusive lock of the file no connection is open, and none
 * can open, because each holds a shared lock from its first read of the log to its end. An empty
 * log holds no data, and the index can be rebuilt. A log with content is not removed. A -lock is
 * created before a connection that writes: if it exists, a program is writing or was killed. */
static void remove_left(const sqlite *self)
{
    const char *path = self->files.path;
    struct stat status;
    if (is_there(path, "-lock", &status))
        return;
    const bool has_log = is_there(path, "-wal", &status) && status.st_size > 0;
    if (!has_log)
        remove_beside(path, "-wal");
    if (!has_log || !self->had_index)
        remove_beside(path, "-shm");
}

/* Removes the files of a connection that only reads. SQLite creates a -wal and a -shm for it, but
 * cannot remove them, because the lock for that requires write access. The lock is requested
 * through SQLite's own file system, because a lock of ours would be lost with any descriptor that
 * this process closes. A file without write access keeps them. Readers that end together do this
 * one after the other, so that none blocks the last one. */
static void tidy(const sqlite *self)
{
    sqlite3_vfs *base = self->files.base;
    struct stat status;
    int flags = SQLITE_OPEN_MAIN_DB | SQLITE_OPEN_READWRITE;
    if (!self->is_reader || !self->files.is_show || is_there(self->files.path, "-lock", &status) ||
        !(is_there(self->files.path, "-wal", &status) ||
          is_there(self->files.path, "-shm", &status)) ||
        !may_be_opened(self->files.path))
        return;
    int folder;
    if (file_lock_folder(&folder, self->files.path, TIDY_PATIENCE_MS) == FILE_LOCK_BUSY)
        return;
    sqlite3_file *file = calloc(1, (size_t)base->szOsFile);
    const char *name = sqlite3_create_filename(self->files.path, "", "", 0, NULL);
    if (file && name && base->xOpen(base, name, file, flags, &flags) == SQLITE_OK) {
        if (file->pMethods->xLock(file, SQLITE_LOCK_SHARED) == SQLITE_OK &&
            file->pMethods->xLock(file, SQLITE_LOCK_EXCLUSIVE) == SQLITE_OK)
            remove_left(self);
        (void)file->pMethods->xUnlock(file, SQLITE_LOCK_NONE);
        (void)file->pMethods->xClose(file);
    }
    sqlite3_free_filename(name);
    free(file);
    if (folder >= 0)
        close(folder);
}

void sqlite_close(sqlite *self)
{
    if (!self)
        return;
    for (uint32_t i = 0; i < self->idle_count; ++i)
        destroy(self->idle[i]);
    sqlite3_close(self->handle);
    tidy(self);
    free(self->files.path);
    free(self->path);
    free(self);
}

/* ---- statements ---- */

mrt_result sqlite_run(sqlite *self, const char *sql, error *err)
{
    return result_of(self, sqlite3_exec(self->handle, sql, NULL, NULL, NULL), err);
}

mrt_result sqlite_begin(sqlite *self, error *err)
{
    return sqlite_run(self, "BEGIN IMMEDIATE", err);
}

mrt_result sqlite_end(sqlite *self, mrt_result result, error *err)
{
    if (result >= 0)
        result = sqlite_run(self, "COMMIT", err);
    if (result < 0 && !sqlite3_get_autocommit(self->handle))
        (void)sqlite3_exec(self->handle, "ROLLBACK", NULL, NULL, NULL);
    return result;
}

/* Returns a cached statement with the same text. */
static sqlite_statement *pop_idle(sqlite *self, const char *sql)
{
    for (uint32_t i = self->idle_count; i-- > 0;) {
        sqlite_statement *found = self->idle[i];
        if (strcmp(sqlite3_sql(found->handle), sql) != 0)
            continue;
        memmove(self->idle + i, self->idle + i + 1,
                (--self->idle_count - i) * sizeof self->idle[0]);
        return found;
    }
    return NULL;
}

/* Prepares a statement. If its handle is NULL, bind_code gives the reason. NULL: no memory. */
static sqlite_statement *prepare(sqlite *self, const char *sql, const char *columns)
{
    sqlite_statement *out = pop_idle(self, sql);
    if (!out) {
        out = calloc(1, sizeof *out);
        if (!out)
            return NULL;
        out->owner = self;
        out->bind_code = sqlite3_prepare_v3(self->handle, sql, -1, SQLITE_PREPARE_PERSISTENT,
                                            &out->handle, NULL);
    }
    out->columns = columns;
    return out;
}

static mrt_result no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory to read or write a show");
}

mrt_result sqlite_prepare(sqlite *self, sqlite_statement **out, const char *sql,
                          const char *columns, error *err)
{
    *out = prepare(self, sql, columns);
    if (!*out)
        return no_memory(err);
    if ((*out)->bind_code == SQLITE_OK)
        return MRT_OK;
    mrt_result result = failed(self, (*out)->bind_code, err);
    destroy(*out);
    *out = NULL;
    return result;
}

/* Returns the statement to the cache. */
void sqlite_finish(sqlite_statement *statement)
{
    if (!statement)
        return;
    sqlite *self = statement->owner;
    if (!statement->handle) {
        destroy(statement);
        return;
    }
    (void)sqlite3_reset(statement->handle);
    (void)sqlite3_clear_bindings(statement->handle);
    statement->bind_code = SQLITE_OK;
    if (self->idle_count == IDLE_MAX) {
        destroy(self->idle[0]);
        memmove(self->idle, self->idle + 1, --self->idle_count * sizeof self->idle[0]);
    }
    self->idle[self->idle_count++] = statement;
}

static int bind_one(sqlite3_stmt *handle, int index, char kind, va_list *arguments)
{
    switch (kind) {
    case 'i':
        return sqlite3_bind_int64(handle, index, va_arg(*arguments, int64_t));
    case 'd':
        return sqlite3_bind_double(handle, index, va_arg(*arguments, double));
    case 't':
        return sqlite3_bind_text(handle, index, va_arg(*arguments, const char *), -1,
                                 SQLITE_STATIC);
    case 'b': {
        const void *bytes = va_arg(*arguments, const void *);
        size_t size = va_arg(*arguments, size_t);
        return sqlite3_bind_blob64(handle, index, bytes, size, SQLITE_STATIC);
    }
    case 'o': {
        const int64_t *value = va_arg(*arguments, const int64_t *);
        return value ? sqlite3_bind_int64(handle, index, *value) : sqlite3_bind_null(handle, index);
    }
    default:
        return SQLITE_MISUSE;
    }
}

static void bind_all(sqlite_statement *statement, const char *format, va_list *arguments)
{
    sqlite_reset(statement);
    if (statement->owner->limits_each)
        refill(statement->owner);
    statement->bind_code = SQLITE_OK;
    for (int i = 0; format[i] && statement->bind_code == SQLITE_OK; ++i)
        statement->bind_code = bind_one(statement->handle, i + 1, format[i], arguments);
}

void sqlite_bind(sqlite_statement *statement, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    bind_all(statement, format, &arguments);
    va_end(arguments);
}

static bool is_of_kind(sqlite3_stmt *row, int column, char kind)
{
    const int type = sqlite3_column_type(row, column);
    if (kind == '*' || (type == SQLITE_NULL && isupper((unsigned char)kind)))
        return true;
    switch (tolower((unsigned char)kind)) {
    case 'i':
    case 'u':
    case 'w':
    case 'z':
    case 'n':
        return type == SQLITE_INTEGER;
    case 'f':
        return (type == SQLITE_FLOAT || type == SQLITE_INTEGER) &&
               isfinite(sqlite3_column_double(row, column));
    case 'd':
        return type == SQLITE_FLOAT || type == SQLITE_INTEGER;
    case 't':
    case 's':
    case 'x':
        return type == SQLITE_TEXT;
    case 'b':
        return type == SQLITE_BLOB;
    default:
        return false;
    }
}

/* Checks the types of a row. SQLite stores any value in any column, whatever its declared type is.
 * */
static mrt_result check_row(sqlite_statement *statement, error *err)
{
    sqlite3_stmt *row = statement->handle;
    const int count = sqlite3_column_count(row);
    for (int i = 0; i < count; ++i) {
        const char kind = statement->columns[0] == '*' ? '*' : statement->columns[i];
        if (is_of_kind(row, i, kind))
            continue;
        statement->owner->code = SQLITE_CORRUPT;
        mrt_result result =
            error_set(err, MRT_ERR_FORMAT, "%s: is damaged: a value of \"%.60s\" is no %s",
                      statement->owner->path, sqlite3_column_name(row, i),
                      strchr("tTsSxX", kind) ? "text"
                      : strchr("bB", kind)   ? "blob"
                                             : "number");
        (void)sqlite3_reset(row);
        return result;
    }
    return MRT_OK;
}

mrt_result sqlite_step(sqlite_statement *statement, error *err)
{
    if (!statement)
        return no_memory(err);
    sqlite *self = statement->owner;
    struct stat ignored;
    int code = statement->bind_code;
    if (self->must_be_still && is_there(self->path, "-lock", &ignored))
        return error_set(err, MRT_ERR_IO, "%s: another program began to write it: open it again",
                         self->path);
    if (code == SQLITE_OK && is_cancelled(self))
        code = SQLITE_INTERRUPT;
    if (code == SQLITE_OK)
        code = sqlite3_step(statement->handle);
    if (code == SQLITE_ROW || code == SQLITE_DONE) {
        self->code = SQLITE_OK;
        return code == SQLITE_DONE ? MRT_END : check_row(statement, err);
    }
    mrt_result result = failed(self, code, err);
    (void)sqlite3_reset(statement->handle);
    return result;
}

mrt_result sqlite_execute(sqlite_statement *statement, error *err)
{
    mrt_result result = sqlite_step(statement, err);
    sqlite_reset(statement);
    return result < 0 ? result : MRT_OK;
}

void sqlite_reset(sqlite_statement *statement)
{
    if (statement)
        (void)sqlite3_reset(statement->handle);
}

static sqlite_statement *query(sqlite *self, const char *sql, const char *columns,
                               const char *format, va_list *arguments)
{
    sqlite_statement *out = prepare(self, sql, columns);
    if (out && out->handle)
        bind_all(out, format, arguments);
    return out;
}

sqlite_statement *sqlite_query(sqlite *self, const char *sql, const char *columns,
                               const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    sqlite_statement *out = query(self, sql, columns, format, &arguments);
    va_end(arguments);
    return out;
}

mrt_result sqlite_change(sqlite *self, error *err, const char *sql, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    sqlite_statement *statement = query(self, sql, "", format, &arguments);
    va_end(arguments);
    return sqlite_finish_rows(statement, sqlite_step(statement, err));
}

mrt_result sqlite_step_one(sqlite_statement *statement, const char *what, int64_t id, error *err)
{
    mrt_result result = sqlite_step(statement, err);
    if (result != MRT_END)
        return result;
    return error_set(err, MRT_ERR_ARGUMENT, "%s: has no %s %lld", statement->owner->path, what,
                     (long long)id);
}

mrt_result sqlite_finish_rows(sqlite_statement *statement, mrt_result result)
{
    sqlite_finish(statement);
    return result < 0 ? result : MRT_OK;
}

int64_t sqlite_int(sqlite_statement *statement, int column)
{
    return sqlite3_column_int64(statement->handle, column);
}

int64_t sqlite_time(sqlite_statement *statement, int column)
{
    int64_t time_ns = sqlite_int(statement, column);
    return time_ns > INT64_MAX / 2    ? INT64_MAX / 2
           : time_ns < -INT64_MAX / 2 ? -INT64_MAX / 2
                                      : time_ns;
}

static text_view text_of(sqlite_statement *statement, int column)
{
    const unsigned char *text = sqlite3_column_text(statement->handle, column);
    int size = text ? sqlite3_column_bytes(statement->handle, column) : 0;
    return text_view_of(text ? (const char *)text : "", size > 0 ? (size_t)size : 0);
}

void sqlite_text(sqlite_statement *statement, int column, char *out, size_t capacity)
{
    text_copy(out, capacity, text_of(statement, column));
}

const char *sqlite_exact_text(sqlite_statement *statement, int column)
{
    const unsigned char *text = sqlite3_column_text(statement->handle, column);
    return text ? (const char *)text : "";
}

/* Copies a text. kind: s or x. NULL: no memory. */
static char *copy_text(sqlite_statement *statement, int column, char kind)
{
    if (kind == 'x')
        return strdup(sqlite_exact_text(statement, column));
    text_view text = text_of(statement, column);
    size_t capacity = (size_t)(text.end - text.at) + 1;
    char *out = malloc(capacity);
    if (out)
        text_copy(out, capacity, text);
    return out;
}

/* Reads one column; false: no memory. */
static bool get_one(sqlite_statement *statement, int column, va_list *arguments)
{
    const char letter = statement->columns[column];
    char *text, **copy;
    switch (tolower((unsigned char)letter)) {
    case 'i':
        *va_arg(*arguments, int64_t *) = sqlite_int(statement, column);
        return true;
    case 'u':
        *va_arg(*arguments, uint32_t *) = (uint32_t)sqlite_int(statement, column);
        return true;
    case 'w':
        *va_arg(*arguments, int32_t *) = (int32_t)sqlite_int(statement, column);
        return true;
    case 'z':
        *va_arg(*arguments, bool *) = sqlite_int(statement, column) != 0;
        return true;
    case 'n':
        *va_arg(*arguments, int64_t *) = sqlite_time(statement, column);
        return true;
    case 'f':
    case 'd':
        *va_arg(*arguments, double *) = sqlite3_column_double(statement->handle, column);
        return true;
    case 't':
        text = va_arg(*arguments, char *);
        sqlite_text(statement, column, text, va_arg(*arguments, size_t));
        return true;
    case 's':
    case 'x':
        copy = va_arg(*arguments, char **);
        *copy = NULL;
        if (letter == 'X' && sqlite_is_null(statement, column))
            return true;
        *copy = copy_text(statement, column, (char)tolower((unsigned char)letter));
        return *copy != NULL;
    default:
        return true;
    }
}

mrt_result sqlite_get(sqlite_statement *statement, error *err, ...)
{
    bool is_complete = true;
    va_list arguments;
    va_start(arguments, err);
    for (int column = 0; statement->columns[column]; ++column)
        is_complete = get_one(statement, column, &arguments) && is_complete;
    va_end(arguments);
    return is_complete ? MRT_OK : no_memory(err);
}

const uint8_t *sqlite_blob(sqlite_statement *statement, int column, size_t *out_size)
{
    static const uint8_t nothing[1] = {0};
    const uint8_t *bytes = sqlite3_column_blob(statement->handle, column);
    *out_size = bytes ? (size_t)sqlite3_column_bytes(statement->handle, column) : 0;
    return bytes ? bytes : nothing;
}

bool sqlite_is(sqlite_statement *statement, int column, char kind)
{
    return is_of_kind(statement->handle, column, kind);
}

bool sqlite_is_null(sqlite_statement *statement, int column)
{
    return sqlite3_column_type(statement->handle, column) == SQLITE_NULL;
}

int64_t sqlite_changes(const sqlite *self)
{
    return sqlite3_changes(self->handle);
}

int64_t sqlite_last_id(const sqlite *self)
{
    return sqlite3_last_insert_rowid(self->handle);
}

mrt_result sqlite_number(sqlite *self, const char *sql, int64_t fallback, int64_t *out, error *err)
{
    sqlite_statement *row = sqlite_query(self, sql, "I", "");
    *out = fallback;
    mrt_result result = sqlite_step(row, err);
    if (result == MRT_OK && !sqlite_is_null(row, 0))
        *out = sqlite_int(row, 0);
    return sqlite_finish_rows(row, result);
}

void sqlite_bind_row(sqlite_statement *to, sqlite_statement *from)
{
    int column_count = sqlite3_column_count(from->handle);
    int parameter_count = sqlite3_bind_parameter_count(to->handle);
    sqlite_reset(to);
    (void)sqlite3_clear_bindings(to->handle);
    to->bind_code = SQLITE_OK;
    for (int i = 0; i < column_count && i < parameter_count && to->bind_code == SQLITE_OK; ++i)
        to->bind_code =
            sqlite3_bind_value(to->handle, i + 1, sqlite3_column_value(from->handle, i));
}

mrt_result sqlite_copy(sqlite *self, const char *out_path, error *err)
{
    sqlite *out;
    mrt_result result = sqlite_open(&out, out_path, SQLITE_MODE_MAKE, err);
    if (result < 0)
        return result;
    sqlite3_backup *copy = sqlite3_backup_init(out->handle, "main", self->handle, "main");
    if (copy) {
        (void)sqlite3_backup_step(copy, -1);
        result = result_of(out, sqlite3_backup_finish(copy), err);
    } else {
        result = failed(out, sqlite3_extended_errcode(out->handle), err);
    }
    sqlite_close(out);
    return result;
}

mrt_result sqlite_checkpoint(sqlite *self, error *err)
{
    int code = sqlite3_wal_checkpoint_v2(self->handle, NULL, SQLITE_CHECKPOINT_PASSIVE, NULL, NULL);
    return (code & 255) == SQLITE_BUSY ? MRT_OK : result_of(self, code, err);
}
