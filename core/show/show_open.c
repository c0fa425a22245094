/* Opens, creates, rescues and checks shows. Uses the other files of the show. */
#include "base/file.h"
#include "base/trace.h"
#include "show/show_file.h"
#include "show/show_schema.h"
#include "show/writer_store.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { RESCUE_NAMES = 100 };

/* ---- what kind of file it is ---- */

typedef struct identity {
    int64_t version, oldest_reader;
} identity;

/* The header had the right application id. The log may contain another one, so it is checked again.
 * */
static mrt_result read_identity(sqlite *db, const char *path, identity *out, error *err)
{
    *out = (identity){0};
    mrt_result result = sqlite_number(db, "PRAGMA user_version", 0, &out->version, err);
    if (result >= 0)
        result = show_schema_check(db, out->version, &out->oldest_reader, err);
    if (result >= 0 && out->oldest_reader > SHOW_VERSION)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "%s: was made by a newer marotte (format %lld, this one reads up to %d): "
                         "update marotte",
                         path, (long long)out->version, SHOW_VERSION);
    return result;
}

static mrt_result check_regular(const char *path, error *err)
{
    struct stat status;
    if (stat(path, &status) != 0)
        return error_set(err, MRT_ERR_IO, "%s: %s", path, strerror(errno));
    if (!S_ISREG(status.st_mode))
        return error_set(err, MRT_ERR_IO, "%s: is not a file; a show was expected", path);
    if (status.st_size == 0)
        return error_set(err, MRT_ERR_FORMAT, "%s: is empty; a show was expected", path);
    return MRT_OK;
}

/* ---- connections ---- */

/* Connects, and reads the file once, so that an unreadable file fails here. */
static mrt_result connect_and_look(sqlite **out, identity *out_identity, const char *path,
                                   sqlite_mode mode, sqlite_trouble *out_trouble, error *err)
{
    *out_trouble = SQLITE_TROUBLE_NONE;
    mrt_result result = sqlite_open(out, path, mode, err);
    if (result < 0)
        return result;
    result = sqlite_run(*out, "BEGIN", err); /* one read transaction instead of four */
    if (result >= 0)
        result = sqlite_end(*out, read_identity(*out, path, out_identity, err), err);
    if (result < 0) {
        *out_trouble = sqlite_trouble_of(*out);
        sqlite_close(*out);
        *out = NULL;
    }
    return result;
}

static bool has_beside(const char *path, const char *suffix, off_t size_min)
{
    char *beside = show_beside(path, suffix);
    struct stat status;
    bool has = beside && stat(beside, &status) == 0 && status.st_size >= size_min;
    free(beside);
    return has;
}

static bool has_log(const char *path)
{
    return has_beside(path, "-wal", 1);
}

/* Returns true if this user or no user may write the show, and no program is writing it. The index
 * of a reader would stay beside the show, and could lock out its owner. */
static bool is_still(const char *path)
{
    struct stat status;
    return stat(path, &status) == 0 && ((status.st_mode & 0222) == 0 || access(path, W_OK) != 0) &&
           !has_log(path) && !has_beside(path, "-lock", 0);
}

static void add_notice(show *self, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void add_notice(show *self, const char *format, ...)
{
    size_t used = strlen(self->notice);
    if (used > 0 && used + 2 < sizeof self->notice) {
        memcpy(self->notice + used, "; ", 3);
        used += 2;
    }
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(self->notice + used, sizeof self->notice - used, format, arguments);
    va_end(arguments);
}

/* Connects read-only. In a read-only folder SQLite cannot create its files beside the show. If the
 * show itself is read-only, it cannot remove them. */
static mrt_result connect_for_reading(show *self, identity *out, error *err)
{
    const sqlite_mode mode = is_still(self->path) ? SQLITE_MODE_READ_FROZEN : SQLITE_MODE_READ;
    sqlite_trouble trouble;
    mrt_result result = connect_and_look(&self->db, out, self->path, mode, &trouble, err);
    if (result >= 0 || (trouble != SQLITE_TROUBLE_OPEN && trouble != SQLITE_TROUBLE_READONLY))
        return result;
    result = connect_and_look(&self->db, out, self->path, SQLITE_MODE_READ_FROZEN, &trouble, err);
    if (result >= 0 && has_log(self->path))
        add_notice(self,
                   "%s: the last changes are in %s-wal and cannot be read here: copy both files "
                   "to a folder where you may write",
                   self->path, self->path);
    return result;
}

static mrt_result use_log(sqlite *db, const char *path, error *err)
{
    sqlite_statement *row = sqlite_query(db, "PRAGMA journal_mode = WAL", "t", "");
    mrt_result result = sqlite_step(row, err);
    if (result == MRT_OK && strcmp(sqlite_exact_text(row, 0), "wal") != 0)
        result = error_set(err, MRT_ERR_UNSUPPORTED,
                           "%s: this disk cannot be used for recording: use another disk", path);
    return sqlite_finish_rows(row, result);
}

static mrt_result read_last_ids(show *self, error *err)
{
    static const char *const sql[SHOW_ID_COUNT] = {
        [SHOW_ID_TRACK] = "SELECT MAX(id) FROM track",
        [SHOW_ID_PERFORMANCE] = "SELECT MAX(id) FROM performance",
        [SHOW_ID_TAKE] = "SELECT MAX(id) FROM take",
        [SHOW_ID_CHUNK] = "SELECT MAX(id) FROM chunk",
    };
    mrt_result result = MRT_OK;
    for (int i = 0; i < SHOW_ID_COUNT && result >= 0; ++i) {
        int64_t last_id = 0;
        result = sqlite_number(self->db, sql[i], 0, &last_id, err);
        if (result >= 0 && (last_id < 0 || last_id > INT64_MAX / 2))
            result = error_set(err, MRT_ERR_FORMAT, "%s: is damaged: invalid id %lld", self->path,
                               (long long)last_id);
        self->last_id[i] = last_id;
    }
    return result;
}

/* ---- opening ---- */

static void remember_file(show *self)
{
    (void)os_id_of_path(self->path, &self->file);
}

static mrt_result show_alloc(show **out, const char *path, error *err)
{
    *out = calloc(1, sizeof **out);
    if (*out)
        (*out)->path = strdup(path);
    if (*out && (*out)->path) {
        (*out)->lock.fd = -1;
        return MRT_OK;
    }
    free(*out);
    *out = NULL;
    return error_set(err, MRT_ERR_MEMORY, "%s: no memory", path);
}

/* Returns true if the file may be written. If not, the notice gives the reason. */
static bool may_write(show *self)
{
    char who[256];
    if (access(self->path, W_OK) != 0) {
        add_notice(self, "%s: opened read-only, because it cannot be written (%s)", self->path,
                   strerror(errno));
        return false;
    }
    switch (show_lock_acquire(&self->lock, self->path, who)) {
    case SHOW_LOCK_HELD:
        return true;
    case SHOW_LOCK_OTHERS:
        add_notice(self, "%s: opened read-only, because %s writes it", self->path, who);
        return false;
    case SHOW_LOCK_REFUSED:
    default:
        add_notice(self, "%s: opened read-only, because its folder cannot be written (%s)",
                   self->path, who);
        return false;
    }
}

static mrt_result open_for_writing(show *self, error *err)
{
    identity id;
    sqlite_trouble trouble;
    int64_t recovered_count = 0;
    mrt_result result =
        connect_and_look(&self->db, &id, self->path, SQLITE_MODE_WRITE, &trouble, err);
    if (result < 0)
        return result;
    if (id.version > SHOW_VERSION) {
        add_notice(
            self,
            "%s: opened read-only, because it was made by a newer marotte (format %lld, this "
            "one writes %d): update marotte to record into it",
            self->path, (long long)id.version, SHOW_VERSION);
        sqlite_close(self->db);
        self->db = NULL;
        return MRT_ERR_UNSUPPORTED;
    }
    result = use_log(self->db, self->path, err);
    if (result >= 0)
        result = show_configure(self->db, err);
    if (result >= 0)
        result = show_schema_migrate(self->db, id.version, err);
    if (result >= 0)
        result = writer_leftover_commit(self, err);
    if (result >= 0)
        result = show_close_open_ends(self->db, &recovered_count, err);
    if (result >= 0)
        result = read_last_ids(self, err);
    if (result < 0 && sqlite_trouble_of(self->db) == SQLITE_TROUBLE_READONLY) {
        add_notice(self, "%s: opened read-only, because it cannot be written", self->path);
        result = MRT_ERR_UNSUPPORTED;
    }
    if (result < 0) {
        sqlite_close(self->db);
        self->db = NULL;
        return result;
    }
    self->is_writable = true;
    if (recovered_count > 0)
        add_notice(self,
                   "%s: marotte ended while it recorded %lld take(s): they are kept up to their "
                   "last sample",
                   self->path, (long long)recovered_count);
    return MRT_OK;
}

static mrt_result open_any_way(show *self, show_mode mode, error *err)
{
    if (mode != SHOW_READ && may_write(self)) {
        mrt_result result = open_for_writing(self, err);
        if (result >= 0 || !self->notice[0])
            return result;
        show_lock_release(&self->lock);
    }
    identity id;
    mrt_result result = connect_for_reading(self, &id, err);
    if (result >= 0)
        self->version = id.version;
    return result;
}

mrt_result show_open(show **out, const char *path, show_mode mode, error *err)
{
    *out = NULL;
    show *self;
    mrt_result result = check_regular(path, err);
    if (result >= 0)
        result = show_alloc(&self, path, err);
    if (result < 0)
        return result;
    self->version = SHOW_VERSION;
    remember_file(self);
    result = open_any_way(self, mode, err);
    if (result < 0) {
        show_close(self);
        return result;
    }
    sqlite_limit_each(self->db);
    if (mode == SHOW_RECORD)
        sqlite_ignore_cancel(self->db);
    TRACE(TRACE_SHOW, "%s: open, format %d", path, (int)self->version);
    *out = self;
    return MRT_OK;
}

/* Creates the file. It may contain voices, so only the owner may read it, until the owner changes
 * its mode. */
static mrt_result make_file(const char *path, error *err)
{
    int fd = os_open(path, OS_CREATE_PRIVATE);
    if (fd < 0)
        return error_set(err, MRT_ERR_IO, "%s: cannot create the show: %s", path, strerror(errno));
    close(fd);
    return MRT_OK;
}

static mrt_result fill_new(show *self, error *err)
{
    char who[256];
    if (show_lock_acquire(&self->lock, self->path, who) != SHOW_LOCK_HELD)
        return error_set(err, MRT_ERR_IO, "%s: cannot create the show: %s", self->path, who);
    mrt_result result = sqlite_open(&self->db, self->path, SQLITE_MODE_MAKE, err);
    if (result >= 0)
        result = show_schema_create(self->db, err);
    if (result >= 0)
        result = use_log(self->db, self->path, err);
    return result < 0 ? result : show_configure(self->db, err);
}

mrt_result show_create(show **out, const char *path, error *err)
{
    *out = NULL;
    show *self;
    mrt_result result = make_file(path, err);
    if (result < 0)
        return result;
    result = show_alloc(&self, path, err);
    if (result >= 0)
        result = fill_new(self, err);
    if (result < 0) {
        show_close(self);
        (void)unlink(path);
        return result;
    }
    sqlite_limit_each(self->db);
    sqlite_ignore_cancel(self->db);
    self->version = SHOW_VERSION;
    self->is_writable = true;
    remember_file(self);
    *out = self;
    return MRT_OK;
}

mrt_result show_join(show **out, show *owner, error *err)
{
    *out = NULL;
    show *self;
    mrt_result result = show_check_writable(owner, err);
    if (result >= 0)
        result = show_alloc(&self, owner->path, err);
    if (result < 0)
        return result;
    self->owner = owner;
    self->version = owner->version;
    self->is_writable = true;
    self->file = owner->file;
    result = show_connect(owner, &self->db, err);
    if (result < 0) {
        show_close(self);
        return result;
    }
    *out = self;
    return MRT_OK;
}

void show_close(show *self)
{
    if (!self)
        return;
    sqlite_close(self->db);
    show_lock_release(&self->lock);
    free(self->path);
    free(self);
}

mrt_result show_rescue(show *self, const char *out_path, error *err)
{
    struct stat status;
    if (stat(out_path, &status) == 0)
        return error_set(err, MRT_ERR_ARGUMENT, "%s: already exists; choose another name",
                         out_path);
    mrt_result result = make_file(out_path, err);
    if (result < 0)
        return result;
    result = sqlite_copy(self->db, out_path, err);
    if (result < 0)
        (void)unlink(out_path);
    return result;
}

/* Copies to the first unused name: STEM.rescued.marotte, STEM.rescued-2.marotte. */
static mrt_result rescue_as(show *self, const char *stem, char out_path[PATH_MAX], error *err)
{
    for (int n = 1; n <= RESCUE_NAMES; ++n) {
        const int length = n > 1 ? snprintf(out_path, PATH_MAX, "%s.rescued-%d.marotte", stem, n)
                                 : snprintf(out_path, PATH_MAX, "%s.rescued.marotte", stem);
        if (length >= PATH_MAX)
            return error_set(err, MRT_ERR_ARGUMENT, "%s: the name of its copy is too long", stem);
        if (access(out_path, F_OK) != 0)
            return show_rescue(self, out_path, err);
    }
    return error_set(err, MRT_ERR_IO, "%s: too many copies are beside it; move them away", stem);
}

enum { NAME_LENGTH = 255 }; /* of a file, on all systems */

static mrt_result rescue_home(show *self, const char *name, char out_path[PATH_MAX], error *err)
{
    char stem[PATH_MAX], rest[NAME_LENGTH + 16];
    (void)snprintf(rest, sizeof rest, "rescued/%.*s", NAME_LENGTH, name);
    mrt_result result = file_home_path(stem, sizeof stem, FILE_HOME_DATA, rest, err);
    char *folder = result >= 0 ? file_directory(stem) : NULL;
    if (result >= 0)
        result = folder ? file_make_folders(folder, err)
                        : error_set(err, MRT_ERR_MEMORY, "%s: no memory", stem);
    free(folder);
    return result < 0 ? result : rescue_as(self, stem, out_path, err);
}

show_rescue_state show_rescue_missing(show *self, error *out_sentence)
{
    static const char gone[] = "was deleted, moved or replaced";
    char stem[PATH_MAX], path[PATH_MAX];
    error beside = {""}, home = {""};
    out_sentence->text[0] = '\0';
    if (!show_is_missing(self))
        return SHOW_RESCUE_NONE;
    const char *name = show_path(self);
    const size_t extension = strlen(file_extension_of(name).text);
    (void)snprintf(stem, sizeof stem, "%.*s", (int)(strlen(name) - (extension ? extension + 1 : 0)),
                   name);
    if (rescue_as(self, stem, path, &beside) >= 0) {
        (void)error_set(out_sentence, MRT_OK, "%s %s: all of it is in %s", name, gone, path);
        return SHOW_RESCUE_BESIDE;
    }
    if (rescue_home(self, file_name_of(stem), path, &home) >= 0) {
        (void)error_set(out_sentence, MRT_OK,
                        "%s %s, and no copy can be made beside it: all of it is in %s", name, gone,
                        path);
        return SHOW_RESCUE_HOME;
    }
    (void)error_set(out_sentence, MRT_OK, "%s %s, and is lost. No copy could be made: %s; %s", name,
                    gone, beside.text, home.text);
    return SHOW_RESCUE_LOST;
}

/* ---- checking for damage ---- */

/* Runs SQLite's checks of pages and foreign keys. */
static mrt_result check_pages(show *self, error *err)
{
    sqlite_statement *row = sqlite_query(self->db, "PRAGMA integrity_check(1)", "t", "");
    mrt_result result = sqlite_step(row, err);
    char what[200] = "ok";
    if (result == MRT_OK)
        sqlite_text(row, 0, what, sizeof what);
    if (result == MRT_OK && strcmp(what, "ok") != 0)
        result = error_set(err, MRT_ERR_FORMAT, "%s: is damaged: %s", self->path, what);
    return sqlite_finish_rows(row, result);
}

static mrt_result check_references(show *self, error *err)
{
    sqlite_statement *row = sqlite_query(self->db, "PRAGMA foreign_key_check", "*", "");
    mrt_result result = sqlite_step(row, err);
    if (result == MRT_OK) {
        char from[64], to[64];
        sqlite_text(row, 0, from, sizeof from);
        sqlite_text(row, 2, to, sizeof to);
        result = error_set(err, MRT_ERR_FORMAT,
                           "%s: is damaged: a row of table %s refers to one of %s that is missing",
                           self->path, from, to);
    }
    return sqlite_finish_rows(row, result);
}

/* Checks that each value has the type of its column. The readers of blobs check their content. */
static mrt_result check_kinds(show *self, const show_table *of, error *err)
{
    char sql[128];
    (void)snprintf(sql, sizeof sql, "SELECT %s FROM %s", of->light, of->name);
    sqlite_statement *rows = sqlite_query(self->db, sql, of->kinds, "");
    mrt_result result;
    while ((result = sqlite_step(rows, err)) == MRT_OK)
        ;
    if (result < 0)
        error_prefix(err, of->name);
    return sqlite_finish_rows(rows, result);
}

static mrt_result check_all_kinds(show *self, error *err)
{
    mrt_result result = MRT_OK;
    for (int i = 0; i < SHOW_TABLES && result >= 0; ++i)
        if (self->version >= show_tables[i].since)
            result = check_kinds(self, &show_tables[i], err);
    return result;
}

static mrt_result check_track(show *self, int64_t id, error *err)
{
    show_reader *reader;
    mrt_sample sample;
    mrt_result result = show_reader_open(&reader, self, id, INT64_MIN, INT64_MAX, err);
    if (result < 0)
        return result;
    while ((result = show_reader_next(reader, &sample, err)) == MRT_OK)
        ;
    show_reader_close(reader);
    return result < 0 ? result : MRT_OK;
}

static mrt_result check_edits(show *self, int64_t take_id, error *err)
{
    show_edits edits;
    mrt_result result = show_edits_read(self, take_id, &edits, err);
    if (result >= 0)
        show_edits_finish(&edits);
    return result;
}

/* Checks all checkpoints, from the last to the first. */
static mrt_result check_checkpoints(show *self, int64_t performance, error *err)
{
    int64_t before_ns = INT64_MAX;
    for (;;) {
        show_checkpoint got;
        mrt_result result = show_checkpoint_before(self, performance, before_ns, 0, &got, err);
        if (result < 0 || !got.bytes)
            return result;
        bool is_first = got.time_ns == INT64_MIN;
        before_ns = is_first ? INT64_MIN : got.time_ns - 1;
        show_checkpoint_finish(&got);
        if (is_first)
            return MRT_OK;
    }
}

static mrt_result check_each(show *self, const char *ids_sql,
                             mrt_result (*check)(show *self, int64_t id, error *err), error *err)
{
    int64_t *ids;
    size_t count;
    mrt_result result = show_read_ids(self, ids_sql, &ids, &count, err);
    for (size_t i = 0; i < count && result >= 0; ++i)
        result = check(self, ids[i], err);
    free(ids);
    return result;
}

mrt_result show_check(show *self, error *err)
{
    mrt_result result = check_pages(self, err);
    if (result >= 0)
        result = check_references(self, err);
    if (result >= 0)
        result = check_all_kinds(self, err);
    if (result >= 0)
        result = check_each(self, "SELECT id FROM track", check_track, err);
    if (result >= 0)
        result = check_each(
            self, "SELECT id FROM take WHERE edit_head <> 0 OR id IN (SELECT take FROM edit)",
            check_edits, err);
    if (result >= 0)
        result = check_each(self, "SELECT id FROM performance", check_checkpoints, err);
    if (result >= 0)
        result = check_each(self, "SELECT id FROM audio", show_audio_check, err);
    return result;
}
