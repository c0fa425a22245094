#include "take/sqlite.h"

#include <limits.h>
#include <sqlite3.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    BUSY_MS = 5000,
    VALUE_BYTES_MAX = 256 * 1024 * 1024, /* of a row: more is damage */
    SQL_BYTES_MAX = 100000
};

struct sqlite {
    sqlite3 *handle;
    char *path;
    int code; /* of the last failure, extended */
};

struct sqlite_statement {
    sqlite *owner;
    sqlite3_stmt *handle;
    int bind_code; /* of the first bind that failed */
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
        return ": make space on the disk";
    case SQLITE_TROUBLE_BUSY:
        return ": another program holds it; close that one";
    case SQLITE_TROUBLE_READONLY:
        return ": copy it to a place where you may write";
    case SQLITE_TROUBLE_DAMAGED:
        return ": it is not a show or it is damaged; what can be read of it: marotte take recover";
    default:
        return "";
    }
}

static mrt_result failed(sqlite *self, int code, error *err)
{
    self->code = code;
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

/* ---- opening ---- */

/* "file:" and the path with every byte that means something in a URI as %xx. */
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

static int configure(sqlite3 *handle)
{
    static const struct setting {
        int option, value;
    } settings[] = {
        {SQLITE_DBCONFIG_DEFENSIVE, 1},      {SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0},
        {SQLITE_DBCONFIG_ENABLE_TRIGGER, 0}, {SQLITE_DBCONFIG_ENABLE_VIEW, 0},
        {SQLITE_DBCONFIG_ENABLE_FKEY, 1},    {SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 0},
    };
    for (size_t i = 0; i < sizeof settings / sizeof settings[0]; ++i) {
        int code = sqlite3_db_config(handle, settings[i].option, settings[i].value, NULL);
        if (code != SQLITE_OK)
            return code;
    }
    sqlite3_limit(handle, SQLITE_LIMIT_LENGTH, VALUE_BYTES_MAX);
    sqlite3_limit(handle, SQLITE_LIMIT_SQL_LENGTH, SQL_BYTES_MAX);
    sqlite3_limit(handle, SQLITE_LIMIT_ATTACHED, 1);
    return sqlite3_busy_timeout(handle, BUSY_MS);
}

static int open_handle(sqlite *self, sqlite_mode mode)
{
    static const int mode_flags[] = {
        [SQLITE_MODE_READ] = SQLITE_OPEN_READONLY,
        [SQLITE_MODE_READ_FROZEN] = SQLITE_OPEN_READONLY,
        [SQLITE_MODE_WRITE] = SQLITE_OPEN_READWRITE,
        [SQLITE_MODE_MAKE] = SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE,
    };
    char *uri = uri_of(self->path, mode == SQLITE_MODE_READ_FROZEN);
    if (!uri)
        return SQLITE_NOMEM;
    int flags = mode_flags[mode] | SQLITE_OPEN_URI | SQLITE_OPEN_FULLMUTEX | SQLITE_OPEN_EXRESCODE;
    int code = sqlite3_open_v2(uri, &self->handle, flags, NULL);
    free(uri);
    return code == SQLITE_OK ? configure(self->handle) : code;
}

mrt_result sqlite_open(sqlite **out, const char *path, sqlite_mode mode, error *err)
{
    *out = NULL;
    sqlite *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "%s: no memory", path);
    self->path = strdup(path);
    if (!self->path) {
        free(self);
        return error_set(err, MRT_ERR_MEMORY, "%s: no memory", path);
    }
    mrt_result result = result_of(self, open_handle(self, mode), err);
    if (result < 0) {
        sqlite_close(self);
        return result;
    }
    *out = self;
    return MRT_OK;
}

void sqlite_close(sqlite *self)
{
    if (!self)
        return;
    sqlite3_close(self->handle);
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

mrt_result sqlite_prepare(sqlite *self, sqlite_statement **out, const char *sql, error *err)
{
    *out = calloc(1, sizeof **out);
    if (!*out)
        return error_set(err, MRT_ERR_MEMORY, "%s: no memory", self->path);
    (*out)->owner = self;
    int code =
        sqlite3_prepare_v3(self->handle, sql, -1, SQLITE_PREPARE_PERSISTENT, &(*out)->handle, NULL);
    if (code == SQLITE_OK)
        return MRT_OK;
    sqlite_finish(*out);
    *out = NULL;
    return failed(self, code, err);
}

void sqlite_finish(sqlite_statement *statement)
{
    if (!statement)
        return;
    (void)sqlite3_finalize(statement->handle);
    free(statement);
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

mrt_result sqlite_step(sqlite_statement *statement, error *err)
{
    int code = statement->bind_code;
    if (code == SQLITE_OK)
        code = sqlite3_step(statement->handle);
    if (code == SQLITE_ROW || code == SQLITE_DONE) {
        statement->owner->code = SQLITE_OK;
        return code == SQLITE_ROW ? MRT_OK : MRT_END;
    }
    mrt_result result = failed(statement->owner, code, err);
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

mrt_result sqlite_query(sqlite *self, sqlite_statement **out, error *err, const char *sql,
                        const char *format, ...)
{
    mrt_result result = sqlite_prepare(self, out, sql, err);
    if (result < 0)
        return result;
    va_list arguments;
    va_start(arguments, format);
    bind_all(*out, format, &arguments);
    va_end(arguments);
    return MRT_OK;
}

mrt_result sqlite_change(sqlite *self, error *err, const char *sql, const char *format, ...)
{
    sqlite_statement *statement;
    mrt_result result = sqlite_prepare(self, &statement, sql, err);
    if (result < 0)
        return result;
    va_list arguments;
    va_start(arguments, format);
    bind_all(statement, format, &arguments);
    va_end(arguments);
    result = sqlite_execute(statement, err);
    sqlite_finish(statement);
    return result;
}

int64_t sqlite_int(sqlite_statement *statement, int column)
{
    return sqlite3_column_int64(statement->handle, column);
}

double sqlite_double(sqlite_statement *statement, int column)
{
    return sqlite3_column_double(statement->handle, column);
}

const char *sqlite_text(sqlite_statement *statement, int column)
{
    const unsigned char *text = sqlite3_column_text(statement->handle, column);
    return text ? (const char *)text : "";
}

const uint8_t *sqlite_blob(sqlite_statement *statement, int column, size_t *out_size)
{
    static const uint8_t nothing[1] = {0};
    const uint8_t *bytes = sqlite3_column_blob(statement->handle, column);
    *out_size = bytes ? (size_t)sqlite3_column_bytes(statement->handle, column) : 0;
    return bytes ? bytes : nothing;
}

bool sqlite_is_null(sqlite_statement *statement, int column)
{
    return sqlite3_column_type(statement->handle, column) == SQLITE_NULL;
}

int64_t sqlite_changes(const sqlite *self)
{
    return sqlite3_changes64(self->handle);
}

int64_t sqlite_last_id(const sqlite *self)
{
    return sqlite3_last_insert_rowid(self->handle);
}

mrt_result sqlite_number(sqlite *self, const char *sql, int64_t fallback, int64_t *out, error *err)
{
    sqlite_statement *statement;
    *out = fallback;
    mrt_result result = sqlite_prepare(self, &statement, sql, err);
    if (result < 0)
        return result;
    result = sqlite_step(statement, err);
    if (result == MRT_OK && !sqlite_is_null(statement, 0))
        *out = sqlite_int(statement, 0);
    sqlite_finish(statement);
    return result < 0 ? result : MRT_OK;
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
