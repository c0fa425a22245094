/* marotte take export --all: exports every take of a show to files named by a pattern. Each take is
 * exported in a separate process, so that an error affects only that take; --jobs sets how many run
 * at a time. Complete and current files are skipped: a list beside the files records the sources of
 * each. */
#include "base/cancel.h"
#include "base/clock.h"
#include "base/file.h"
#include "base/program.h"
#include "base/text.h"
#include "cli/take.h"
#include "show/edit_store.h"
#include "show/export_name.h"
#include "show/hash.h"
#include "show/pack.h"

#include <jansson.h>

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

enum { JOBS_MAX = 64, FILES_MAX = EXPORTS_MAX + 1, LIST_BYTES_MAX = 64 << 20 };
static const char list_name[] = "marotte_exports.json";

typedef struct job { /* one take */
    char id[24], slate[TAKE_NAME * 2 + 32];
    char *path[FILES_MAX]; /* paths in the order of call->exports, then that of --export NAME.wav;
                              owned */
    uint32_t path_count;
    char made_from[TAKE_HASH]; /* hash of the sources; "": unknown, always export */
    pid_t pid;                 /* 0: not running */
    FILE *child_stderr;        /* stderr of the process */
} job;

typedef struct batch {
    take_call *call;
    job *job;
    size_t count;
    char folder[PATH_MAX]; /* folder of the list, ends with '/', or "" */
    json_t *list;          /* for each file: hash of its sources, size and time */
    uint32_t jobs, running, done, kept, failed, unread_count;
} batch;

/* ---- names ---- */

/* "out/{slate}.glb" */
static mrt_result name_file(char **out, const char *pattern, const take *t, take_call *call,
                            error *err)
{
    char text[PATH_MAX];
    error why;
    const export_name_of of = {call->word[0], t->id, t->scene, t->shot, t->name, t->number};
    if (export_name(text, sizeof text, pattern, &of, &why) < 0)
        return take_misused(call, err, "%s", why.text);
    *out = strdup(text);
    return *out ? MRT_OK : error_set(err, MRT_ERR_MEMORY, "no memory");
}

/* ---- hash of the sources ---- */

static void add_text(hash_sum *sum, const char *text)
{
    hash_add(sum, text ? text : "", text ? strlen(text) + 1 : 1);
}

static bool add_face(hash_sum *sum, take_call *call, const take_performance *p)
{
    char packed[PATH_MAX], files[TAKE_HASH];
    error ignored;
    const char *path = call->text[TAKE_FACE] ? call->text[TAKE_FACE] : p->rig;
    if (!call->text[TAKE_FACE] && pack_find(packed, call->word[0], p, &ignored) == MRT_OK)
        path = packed;
    add_text(sum, p->mapping);
    if (pack_sum(files, path, &ignored) < 0)
        return false;
    add_text(sum, files);
    return true;
}

/* Returns the default scene if it cannot be read. */
static scenery scenery_of(show *of)
{
    scenery out;
    error ignored;
    (void)!scenery_read(&out, of, &ignored);
    return out;
}

/* Computes the hash of everything that determines the files: the edits, the face and the options.
 * Samples never change. */
static void sum_up(char out[TAKE_HASH], take_call *call, const show_take *row, const take *t)
{
    show_edits edits;
    error ignored;
    hash_sum *sum = hash_begin();
    bool is_known = sum != NULL;
    out[0] = '\0';
    if (is_known)
        add_text(sum, MAROTTE_VERSION);
    for (int i = 0; is_known && i < TAKE_OPTION_COUNT; ++i)
        if (i != TAKE_JOBS && i != TAKE_JSON && i != TAKE_ALL)
            add_text(sum, call->text[i]);
    const scenery scene = scenery_of(call->show);
    if (is_known)
        hash_add(sum, &scene, sizeof scene);
    const int64_t made[] = {row->id, row->created_ns, row->start_ns, row->end_ns, row->edit_head};
    if (is_known)
        hash_add(sum, made, sizeof made);
    is_known = is_known && show_edits_of(call->show, row, &edits, &ignored) >= 0;
    if (is_known) {
        for (uint32_t i = 0; i < edits.count; ++i)
            add_text(sum, edits.edit[i].json);
        show_edits_finish(&edits);
    }
    for (uint32_t i = 0; is_known && i < t->layer_count; ++i)
        for (uint32_t k = 0; is_known && k < t->layer[i].clip_count; ++k) {
            show_performance of;
            is_known = show_performance_read(call->show, t->layer[i].clip[k].performance, &of,
                                             &ignored) >= 0;
            if (!is_known)
                break;
            is_known = add_face(sum, call, &of.performance);
            show_performance_finish(&of);
        }
    hash_end(out, sum);
    if (!is_known)
        out[0] = '\0';
}

/* ---- the list of complete files ---- */

static const char *key_of(const batch *self, const char *path)
{
    size_t length = strlen(self->folder);
    return strncmp(path, self->folder, length) == 0 ? path + length : path;
}

/* Reads size and time of a file. For a folder of pictures, uses its frames.json, which is written
 * last. */
static bool look_at(const char *path, json_int_t *out_bytes, json_int_t *out_time_ns)
{
    char file[PATH_MAX];
    struct stat status;
    size_t length = strlen(path);
    (void)snprintf(file, sizeof file, "%s%s", path,
                   length > 0 && path[length - 1] == '/' ? "frames.json" : "");
    if (stat(file, &status) != 0 || !S_ISREG(status.st_mode))
        return false;
    *out_bytes = (json_int_t)status.st_size;
    *out_time_ns = (json_int_t)status.st_mtim.tv_sec * NS_PER_S + status.st_mtim.tv_nsec;
    return true;
}

static bool is_complete(const batch *self, const job *of)
{
    bool is_so = of->made_from[0] != '\0';
    for (uint32_t i = 0; i < of->path_count && is_so; ++i) {
        json_int_t bytes, time_ns;
        const json_t *told = json_object_get(self->list, key_of(self, of->path[i]));
        const char *made_from = json_string_value(json_object_get(told, "made_from"));
        is_so = made_from && strcmp(made_from, of->made_from) == 0 &&
                look_at(of->path[i], &bytes, &time_ns) &&
                json_integer_value(json_object_get(told, "bytes")) == bytes &&
                json_integer_value(json_object_get(told, "time_ns")) == time_ns;
    }
    return is_so;
}

static mrt_result read_list(batch *self, error *err)
{
    char path[PATH_MAX + 32];
    file_bytes bytes;
    (void)snprintf(path, sizeof path, "%s%s", self->folder, list_name);
    self->list = NULL;
    if (access(path, F_OK) == 0) {
        mrt_result result = file_read(&bytes, path, LIST_BYTES_MAX, err);
        if (result < 0)
            return result;
        json_t *root = json_loadb((const char *)bytes.data, bytes.size, 0, NULL);
        file_bytes_finish(&bytes);
        if (json_integer_value(json_object_get(root, "marotte_exports")) == 1)
            self->list = json_incref(json_object_get(root, "files"));
        json_decref(root);
        if (!json_is_object(self->list))
            return error_set(err, MRT_ERR_FORMAT,
                             "%s: not a list of marotte's exports. Move it away", path);
    }
    self->list = self->list ? self->list : json_object();
    return self->list ? MRT_OK : error_set(err, MRT_ERR_MEMORY, "no memory");
}

static mrt_result write_list(const batch *self, error *err)
{
    char path[PATH_MAX + 32];
    (void)snprintf(path, sizeof path, "%s%s", self->folder, list_name);
    json_t *root = json_pack("{si,sO}", "marotte_exports", 1, "files", self->list);
    char *text = root ? json_dumps(root, JSON_INDENT(1) | JSON_SORT_KEYS) : NULL;
    json_decref(root);
    mrt_result result = text ? file_write(path, text, strlen(text), err)
                             : error_set(err, MRT_ERR_MEMORY, "no memory");
    free(text);
    return result;
}

static mrt_result note_complete(batch *self, const job *of, error *err)
{
    for (uint32_t i = 0; i < of->path_count; ++i) {
        json_int_t bytes, time_ns;
        if (look_at(of->path[i], &bytes, &time_ns))
            (void)json_object_set_new(self->list, key_of(self, of->path[i]),
                                      json_pack("{ss,sI,sI}", "made_from", of->made_from, "bytes",
                                                bytes, "time_ns", time_ns));
        facts_file(self->call->told, of->path[i], exports_opener(exports_format_of(of->path[i])));
    }
    return write_list(self, err);
}

/* ---- choosing the takes ---- */

static mrt_result check_names(const batch *self, error *err)
{
    for (size_t i = 0; i < self->count; ++i)
        for (size_t k = 0; k < i; ++k)
            for (uint32_t a = 0; a < self->job[i].path_count; ++a)
                for (uint32_t b = 0; b < self->job[k].path_count; ++b)
                    if (strcmp(self->job[i].path[a], self->job[k].path[b]) == 0)
                        return take_misused(
                            self->call, err,
                            "takes %s and %s have the same file name, %s. Use {take} in the name",
                            self->job[k].id, self->job[i].id, self->job[i].path[a]);
    return MRT_OK;
}

static mrt_result add_take(batch *self, const show_take *row, error *err)
{
    take t;
    error why = {""};
    take_call *call = self->call;
    job *out = &self->job[self->count];
    mrt_result result = edit_store_take_of(&t, call->show, row, &why);
    (void)snprintf(out->id, sizeof out->id, "%lld", (long long)row->id);
    if (result < 0) {
        fprintf(stderr, "warning: take %s: %s: not exported\n", out->id, why.text);
        self->unread_count += 1;
    }
    bool is_wanted = result >= 0 && !t.is_deleted && !t.is_recording && t.duration_ns > 0;
    result = MRT_OK;
    if (is_wanted) {
        (void)snprintf(out->slate, sizeof out->slate, "%s",
                       take_slate_text(t.scene, t.shot, t.number).text);
        self->count += 1;
        for (uint32_t i = 0; i < call->export_count && result >= 0; ++i)
            result = name_file(&out->path[out->path_count++], call->exports[i].path, &t, call, err);
        if (result >= 0 && call->wav)
            result = name_file(&out->path[out->path_count++], call->wav, &t, call, err);
        if (result >= 0)
            sum_up(out->made_from, call, row, &t);
    }
    take_finish(&t);
    return result;
}

static mrt_result list_takes(batch *self, error *err)
{
    show_take *rows;
    size_t count;
    mrt_result result = show_takes(self->call->show, &rows, &count, err);
    if (result < 0)
        return result;
    self->job = calloc(count + 1, sizeof *self->job);
    if (!self->job)
        result = error_set(err, MRT_ERR_MEMORY, "no memory for %zu takes", count);
    for (size_t i = 0; i < count && result >= 0 && !cancel_is_requested(); ++i)
        result = add_take(self, &rows[i], err);
    free(rows);
    return result < 0 ? result : check_names(self, err);
}

/* ---- running the processes ---- */

typedef struct words { /* words of a command line */
    char *word[8 + 2 * (FILES_MAX + TAKE_OPTION_COUNT)];
    char option[TAKE_OPTION_COUNT][32];
    uint32_t count;
} words;

static void add(words *out, const char *word)
{
    out->word[out->count++] = program_argument(word);
    out->word[out->count] = NULL;
}

/* Builds the command line of marotte take export for one take. */
static void list_words(words *out, const batch *self, const job *of)
{
    const take_call *call = self->call;
    out->count = 0;
    add(out, "marotte");
    add(out, "take");
    add(out, "export");
    for (uint32_t i = 0; i < of->path_count; ++i) {
        add(out, "--export");
        add(out, of->path[i]);
    }
    for (int i = 0; i < TAKE_OPTION_COUNT; ++i) {
        if (!call->text[i] || i == TAKE_ALL || i == TAKE_JOBS || i == TAKE_JSON)
            continue;
        (void)snprintf(out->option[i], sizeof out->option[i], "--%s",
                       take_option_name((take_option)i));
        add(out, out->option[i]);
        if (call->text[i][0])
            add(out, call->text[i]);
    }
    add(out, "--");
    add(out, call->word[0]);
    add(out, of->id);
}

static mrt_result start(batch *self, job *of, error *err)
{
    words with;
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; i < of->path_count && result >= 0; ++i)
        result = file_make_parent(of->path[i], err);
    if (result < 0)
        return result;
    list_words(&with, self, of);
    of->child_stderr = tmpfile();
    const program_start how = {.program = "/proc/self/exe",
                               .words = with.word,
                               .in = -1,
                               .out = -1,
                               .err = of->child_stderr ? fileno(of->child_stderr) : -1,
                               /* Only this process receives Ctrl-C, and forwards it once. */
                               .signals = PROGRAM_OWN_GROUP};
    const int failed = of->child_stderr ? program_spawn(&of->pid, &how) : errno;
    if (failed) {
        of->pid = 0;
        return error_set(err, MRT_ERR_IO, "take %s: cannot start a process: %s", of->id,
                         strerror(failed));
    }
    self->running += 1;
    return MRT_OK;
}

static void report_stderr(job *of)
{
    char line[1200];
    rewind(of->child_stderr);
    while (fgets(line, sizeof line, of->child_stderr)) {
        line[strcspn(line, "\r\n")] = '\0';
        fprintf(stderr, "take %s (%s): %s\n", of->id, of->slate, line);
    }
}

static mrt_result finish(batch *self, job *of, int status, error *err)
{
    bool is_done = WIFEXITED(status) && WEXITSTATUS(status) == COMMAND_DONE;
    of->pid = 0;
    self->running -= 1;
    report_stderr(of);
    (void)fclose(of->child_stderr);
    of->child_stderr = NULL;
    self->done += is_done;
    self->failed += !is_done;
    return is_done ? note_complete(self, of, err) : MRT_OK;
}

/* Collects the processes that have ended. After the user's request to stop, ends the others
 * once. */
static mrt_result look_after(batch *self, bool *is_asked, error *err)
{
    mrt_result result = MRT_OK;
    bool asks = cancel_is_requested() && !*is_asked;
    *is_asked |= asks;
    for (size_t i = 0; i < self->count; ++i) {
        int status;
        job *of = &self->job[i];
        if (of->pid == 0)
            continue;
        if (asks)
            (void)kill(of->pid, SIGTERM);
        if (waitpid(of->pid, &status, WNOHANG) == of->pid) {
            error why;
            mrt_result noted = finish(self, of, status, result < 0 ? &why : err);
            result = result < 0 ? result : noted;
        }
    }
    return result;
}

static mrt_result run_jobs(batch *self, error *err)
{
    size_t next = 0;
    bool is_asked = false;
    mrt_result result = MRT_OK;
    progress_start(&self->call->shown, "exporting");
    while (self->running > 0 || (next < self->count && result >= 0 && !cancel_is_requested())) {
        while (result >= 0 && next < self->count && self->running < self->jobs &&
               !cancel_is_requested()) {
            job *of = &self->job[next++];
            if (is_complete(self, of))
                self->kept += 1;
            else
                result = start(self, of, err);
        }
        error why;
        mrt_result ended = look_after(self, &is_asked, result < 0 ? &why : err);
        result = result < 0 ? result : ended;
        progress_show(&self->call->shown, (double)next / (double)(self->count + 1), "");
        if (self->running > 0)
            clock_sleep_until_ns(clock_now_ns() + 20 * NS_PER_MS);
    }
    progress_end(&self->call->shown);
    return result;
}

static mrt_result report(batch *self, error *err)
{
    facts *told = self->call->told;
    facts_number(told, "exported", "takes exported", self->done, 0, "");
    facts_number(told, "kept", "complete already", self->kept, 0, "");
    self->call->is_told = true;
    if (cancel_is_requested())
        return error_set(err, MRT_ERR_IO, "stopped. Run the same command again to continue");
    if (self->failed + self->unread_count == 0)
        return MRT_OK;
    return error_set(err, MRT_ERR_IO, "%u of %zu takes could not be exported",
                     self->failed + self->unread_count, self->count + self->unread_count);
}

mrt_result take_export_all(take_call *call, error *err)
{
    batch self = {.call = call};
    double jobs = 1.0;
    mrt_result result = take_number(call, TAKE_JOBS, 1, JOBS_MAX, &jobs, err);
    self.jobs = (uint32_t)jobs;
    const char *first = call->export_count ? call->exports[0].path : call->wav;
    const char *brace = strchr(first, '{'), *slash = first;
    for (const char *at = first; brace && (at = strchr(at, '/')) && at < brace;)
        slash = ++at;
    if (result >= 0 && !brace)
        result = take_misused(call, err, "\"%s\": with --all a file name needs {take} or {slate}",
                              first);
    char list[PATH_MAX];
    (void)snprintf(self.folder, sizeof self.folder, "%.*s", (int)(slash - first), first);
    (void)snprintf(list, sizeof list, "%.*s%s", (int)(slash - first), first, list_name);
    cancel_on_signals(CANCEL_WAITS, NULL);
    if (result >= 0)
        result = file_make_parent(list, err);
    if (result >= 0)
        result = read_list(&self, err);
    if (result >= 0)
        result = list_takes(&self, err);
    show_close(call->show); /* each process opens the show itself */
    call->show = NULL;
    if (result >= 0)
        result = run_jobs(&self, err);
    if (result >= 0)
        result = report(&self, err);
    for (size_t i = 0; i < self.count; ++i)
        for (uint32_t k = 0; k < self.job[i].path_count; ++k)
            free(self.job[i].path[k]);
    free(self.job);
    json_decref(self.list);
    return result;
}
