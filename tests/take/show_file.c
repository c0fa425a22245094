/* core/show/show.h: which files open, how, and what is said where they do not. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/clock.h"
#include "show/edit_store.h"
#include "take/show_scene.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sqlite3.h>
#include <sys/wait.h>

static void run_sql(const char *path, const char *sql)
{
    sqlite3 *db;
    char *message = NULL;
    assert_int_equal(sqlite3_open(path, &db), SQLITE_OK);
    if (sqlite3_exec(db, sql, NULL, NULL, &message) != SQLITE_OK)
        fail_msg("%s", message);
    sqlite3_close(db);
}

static void write_file(const char *path, const void *bytes, size_t size)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

/* A closed show with samples 0..n-1 of one track and a take of them; the track's id. */
static int64_t record_some(const char *path, int64_t n)
{
    error err = {""};
    show *s;
    scene_recording r;
    int64_t take_id;
    writer_options options = scene_options();
    scene_must(show_create(&s, path, &err), &err);
    scene_record(&r, s, &options);
    scene_must(writer_take_begin(r.writer, 0, &(writer_slate){.scene = "1"}, &take_id, &err), &err);
    scene_give(&r, 0, n);
    scene_stop(&r);
    show_close(s);
    return r.track;
}

static bool is_there(const char *path, const char *suffix)
{
    char full[2 * SCENE_PATH];
    struct stat status;
    snprintf(full, sizeof full, "%s%s", path, suffix);
    return stat(full, &status) == 0;
}

static void a_closed_show_is_one_file(void **state)
{
    scene *s = *state;
    record_some(s->path, 100);
    assert_true(is_there(s->path, ""));
    assert_false(is_there(s->path, "-wal"));
    assert_false(is_there(s->path, "-shm"));
    assert_false(is_there(s->path, "-lock"));
}

static void a_show_is_not_made_over_a_file(void **state)
{
    scene *s = *state;
    error err = {""};
    show *got;
    write_file(s->path, "precious", 8);
    assert_int_equal(show_create(&got, s->path, &err), MRT_ERR_IO);
    assert_null(got);
    char text[9] = "";
    FILE *file = fopen(s->path, "rb");
    assert_int_equal(fread(text, 1, 8, file), 8);
    fclose(file);
    assert_string_equal(text, "precious");
}

static void what_is_no_show_is_refused_by_name(void **state)
{
    scene *s = *state;
    error err = {""};
    show *got;
    show_mode modes[] = {SHOW_READ, SHOW_WRITE};
    char text[3000];
    memset(text, 'x', sizeof text);
    for (int i = 0; i < 2; ++i) {
        unlink(s->path);
        assert_int_equal(show_open(&got, s->path, modes[i], &err), MRT_ERR_IO);
        assert_non_null(strstr(err.text, s->path));
        write_file(s->path, "", 0);
        assert_int_equal(show_open(&got, s->path, modes[i], &err), MRT_ERR_FORMAT);
        assert_non_null(strstr(err.text, "empty"));
        write_file(s->path, text, sizeof text);
        assert_int_equal(show_open(&got, s->path, modes[i], &err), MRT_ERR_FORMAT);
        assert_non_null(strstr(err.text, s->path));
        unlink(s->path);
        run_sql(s->path, "CREATE TABLE other(a)");
        assert_int_equal(show_open(&got, s->path, modes[i], &err), MRT_ERR_FORMAT);
        assert_non_null(strstr(err.text, "not a marotte show"));
        assert_int_equal(show_open(&got, s->folder, modes[i], &err), MRT_ERR_IO);
        assert_false(is_there(s->path, "-lock"));
    }
}

/* ---- who only reads ---- */

enum { LISTING = 4096 };

/* Names, sizes and bytes of what is in the folder, but for the bytes of -shm, which are SQLite's.
 */
static void list_folder(const scene *s, char out[LISTING])
{
    char command[SCENE_PATH + 200];
    snprintf(command, sizeof command,
             "cd '%s' && stat -c '%%n %%a %%s' -- * && cat $(ls | grep -v shm$) | cksum",
             s->folder);
    FILE *from = popen(command, "r");
    assert_non_null(from);
    out[fread(out, 1, LISTING - 1, from)] = '\0';
    assert_int_equal(pclose(from), 0);
}

static void expect_unchanged(const scene *s, const char before[LISTING])
{
    char after[LISTING];
    list_folder(s, after);
    assert_string_equal(before, after);
}

static void who_only_reads_leaves_the_folder_as_it_was(void **state)
{
    scene *s = *state;
    char before[LISTING];
    const int64_t track = record_some(s->path, 100);
    static const mode_t modes[] = {0600, 0444};
    for (size_t i = 0; i < 2; ++i) {
        assert_int_equal(chmod(s->path, modes[i]), 0);
        list_folder(s, before);
        show *one = scene_open(s, SHOW_READ);
        scene_expect(one, track, 0, 100);
        show *two = scene_open(s, SHOW_READ);
        scene_expect(two, track, 0, 100);
        show_close(one);
        scene_expect(two, track, 0, 100);
        show_close(two);
        expect_unchanged(s, before);
    }
}

static void who_reads_beside_a_writer_takes_nothing_from_it(void **state)
{
    scene *s = *state;
    error err = {""};
    show *got;
    writer_options options = scene_options();
    scene_recording r;
    scene_must(show_create(&got, s->path, &err), &err);
    scene_record(&r, got, &options);
    for (int i = 0; i < 5; ++i) {
        scene_give(&r, 100 * i, 100 * (i + 1));
        scene_flush(&r);
        const pid_t child = fork();
        if (child == 0) {
            show *read;
            if (show_open(&read, s->path, SHOW_READ, &err) < 0)
                _exit(1);
            scene_expect(read, r.track, 0, 100 * (i + 1));
            show_close(read);
            _exit(0);
        }
        int status;
        assert_int_equal(waitpid(child, &status, 0), child);
        assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 0);
        assert_true(is_there(s->path, "-wal") && is_there(s->path, "-shm"));
    }
    scene_stop(&r);
    show_close(got);
    got = scene_open(s, SHOW_READ);
    scene_expect(got, r.track, 0, 500);
    show_close(got);
    assert_false(is_there(s->path, "-wal") || is_there(s->path, "-shm"));
}

/* What a killed program left is there for the next one that writes. */
static void who_reads_after_a_kill_leaves_the_log(void **state)
{
    scene *s = *state;
    char before[LISTING], beside[SCENE_PATH + 8];
    error err = {""};
    const pid_t child = fork();
    if (child == 0) {
        show *got;
        scene_recording r;
        writer_options options = scene_options();
        scene_must(show_create(&got, s->path, &err), &err);
        scene_record(&r, got, &options);
        scene_give(&r, 0, 300);
        scene_flush(&r);
        (void)raise(SIGKILL);
    }
    assert_int_equal(waitpid(child, NULL, 0), child);
    for (int is_copied = 0; is_copied < 2; ++is_copied) {
        if (is_copied) { /* the show and its log alone */
            (void)snprintf(beside, sizeof beside, "%s-shm", s->path);
            assert_int_equal(unlink(beside), 0);
            (void)snprintf(beside, sizeof beside, "%s-lock", s->path);
            assert_int_equal(unlink(beside), 0);
        }
        list_folder(s, before);
        show *got = scene_open(s, SHOW_READ);
        scene_expect(got, 1, 0, 300);
        show_close(got);
        expect_unchanged(s, before);
    }
    show *got = scene_open(s, SHOW_WRITE);
    scene_expect(got, 1, 0, 300);
    show_close(got);
}

/* Each may be the last one. */
static void readers_that_end_at_once_leave_nothing(void **state)
{
    scene *s = *state;
    error err = {""};
    pid_t reader[4];
    const int64_t track = record_some(s->path, 20);
    for (int i = 0; i < 4; ++i) {
        reader[i] = fork();
        assert_true(reader[i] >= 0);
        for (int n = 0; reader[i] == 0; ++n) {
            show *read;
            if (n == 50)
                _exit(0);
            if (show_open(&read, s->path, SHOW_READ, &err) < 0)
                _exit(1);
            scene_expect(read, track, 0, 20);
            show_close(read);
        }
    }
    for (int i = 0; i < 4; ++i) {
        int status;
        assert_int_equal(waitpid(reader[i], &status, 0), reader[i]);
        assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    }
    assert_false(is_there(s->path, "-wal") || is_there(s->path, "-shm"));
}

/* Readers come and go while the show is opened, written and closed: nothing is lost. The log of a
 * writer that closes while somebody reads stays for the next one. */
static void readers_and_writers_meet_at_any_moment(void **state)
{
    scene *s = *state;
    error err = {""};
    int stop[2];
    pid_t reader[2];
    const int64_t track = record_some(s->path, 100);
    assert_int_equal(pipe(stop), 0);
    for (int i = 0; i < 2; ++i) {
        reader[i] = fork();
        assert_true(reader[i] >= 0);
        if (reader[i] > 0)
            continue;
        close(stop[1]);
        struct pollfd until = {.fd = stop[0], .events = POLLIN};
        while (poll(&until, 1, 0) == 0) {
            show *read;
            if (show_open(&read, s->path, SHOW_READ, &err) < 0)
                _exit(1);
            scene_expect(read, track, 0, 100);
            show_close(read);
        }
        _exit(0);
    }
    close(stop[0]);
    for (int i = 0; i < 40; ++i) {
        show *got = scene_open(s, SHOW_WRITE);
        assert_true(show_is_writable(got));
        char text[16], back[16];
        (void)snprintf(text, sizeof text, "%d", i);
        scene_must(show_note_write(got, "test", text, &err), &err);
        scene_must(show_note_read(got, "test", back, sizeof back, &err), &err);
        assert_string_equal(back, text);
        show_close(got);
    }
    close(stop[1]);
    for (int i = 0; i < 2; ++i) {
        int status;
        assert_int_equal(waitpid(reader[i], &status, 0), reader[i]);
        assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    }
    for (int i = 0; i < 3; ++i) {
        show *got = scene_open(s, i == 1 ? SHOW_WRITE : SHOW_READ);
        char back[16];
        scene_must(show_note_read(got, "test", back, sizeof back, &err), &err);
        assert_string_equal(back, "39");
        show_close(got);
    }
    assert_false(is_there(s->path, "-wal") || is_there(s->path, "-shm"));
}

/* POSIX drops a process's locks on a file whenever it closes any descriptor of it: SQLite's lock of
 * an open show, which keeps others from removing its log, must survive what else is opened. */
static void a_second_connection_does_not_drop_the_locks_of_the_first(void **state)
{
    scene *s = *state;
    error err = {""};
    show *joined;
    record_some(s->path, 100);
    show *got = scene_open(s, SHOW_WRITE);
    scene_must(show_join(&joined, got, &err), &err);
    show *read = scene_open(s, SHOW_READ);
    const pid_t child = fork();
    if (child == 0) {
        struct flock lock = {
            .l_type = F_WRLCK, .l_whence = SEEK_SET, .l_start = 0x40000002, .l_len = 510};
        int fd = open(s->path, O_RDWR | O_CLOEXEC);
        _exit(fd >= 0 && fcntl(fd, F_GETLK, &lock) == 0 && lock.l_type != F_UNLCK ? 0 : 1);
    }
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    show_close(read);
    show_close(joined);
    show_close(got);
}

static void names_with_special_letters_work(void **state)
{
    scene *s = *state;
    char path[SCENE_PATH + 64];
    error err = {""};
    show *got;
    snprintf(path, sizeof path, "%s/a %%20?mode=ro#1 'b' \xc3\xa9.marotte", s->folder);
    int64_t track = record_some(path, 50);
    assert_true(is_there(path, ""));
    scene_must(show_open(&got, path, SHOW_WRITE, &err), &err);
    assert_true(show_is_writable(got));
    scene_expect(got, track, 0, 50);
    show_close(got);
}

/* ---- two programs ---- */

static void the_second_one_reads_and_says_who_writes(void **state)
{
    scene *s = *state;
    error err = {""};
    show *first, *second;
    writer_options options = scene_options();
    scene_recording r;
    scene_must(show_create(&first, s->path, &err), &err);
    scene_record(&r, first, &options);
    scene_give(&r, 0, 100);
    scene_flush(&r);
    scene_must(show_open(&second, s->path, SHOW_WRITE, &err), &err);
    assert_false(show_is_writable(second));
    char process[32], alias[SCENE_PATH];
    snprintf(process, sizeof process, "process %ld on ", (long)getpid());
    assert_non_null(strstr(show_notice(second), process));
    scene_expect(second, r.track, 0, 100);
    scene_give(&r, 100, 200);
    scene_flush(&r);
    scene_expect(second, r.track, 0, 200); /* it sees what is committed since */
    int64_t id;
    assert_int_equal(show_take_create(second, &(show_new_take){0}, &id, &err), MRT_ERR_UNSUPPORTED);
    assert_non_null(strstr(err.text, process));
    writer *none;
    assert_int_equal(writer_start(&none, second, &options, &err), MRT_ERR_UNSUPPORTED);
    show_close(second);

    snprintf(alias, sizeof alias, "%s/alias.marotte", s->folder);
    assert_int_equal(symlink(s->path, alias), 0);
    scene_must(show_open(&second, alias, SHOW_WRITE, &err), &err);
    assert_false(show_is_writable(second));
    show_close(second);
    scene_stop(&r);
    show_close(first);
    scene_must(show_open(&second, s->path, SHOW_WRITE, &err), &err);
    assert_true(show_is_writable(second));
    assert_string_equal(show_notice(second), "");
    show_close(second);
}

/* In a child: what goes wrong there is its exit status. */
static int status_of_child(pid_t child)
{
    int status;
    assert_int_equal(waitpid(child, &status, 0), child);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
}

static void a_killed_program_leaves_no_lock_and_its_take(void **state)
{
    scene *s = *state;
    error err = {""};
    int ready[2];
    assert_int_equal(pipe(ready), 0);
    pid_t child = fork();
    if (child == 0) {
        show *got;
        scene_recording r;
        int64_t take_id;
        writer_options options = scene_options();
        if (show_create(&got, s->path, &err) < 0)
            _exit(1);
        scene_record(&r, got, &options);
        (void)!writer_take_begin(r.writer, 500, &(writer_slate){.scene = "9"}, &take_id, &err);
        scene_give(&r, 0, 500);
        (void)!writer_mark(r.writer, 100 * scene_step_ns, "cue", &err);
        scene_flush(&r);
        (void)!write(ready[1], "x", 1);
        pause();
        _exit(2);
    }
    char byte;
    assert_int_equal(read(ready[0], &byte, 1), 1);
    show *other;
    scene_must(show_open(&other, s->path, SHOW_WRITE, &err), &err);
    assert_false(show_is_writable(other));
    show_close(other);
    kill(child, SIGKILL);
    assert_int_equal(status_of_child(child), 128);
    assert_true(is_there(s->path, "-lock"));
    scene_must(show_open(&other, s->path, SHOW_WRITE, &err), &err);
    assert_true(show_is_writable(other));
    assert_non_null(strstr(show_notice(other), "recorded 1 take"));
    scene_expect(other, 1, 0, 500);
    show_take *takes;
    size_t count;
    scene_must(show_takes(other, &takes, &count, &err), &err);
    assert_int_equal(count, 1);
    assert_true(takes[0].is_recovered && !takes[0].is_recording);
    assert_string_equal(takes[0].scene, "9");
    assert_int_equal(takes[0].start_ns, scene_utc_ns + 500);
    assert_int_equal(takes[0].end_ns, scene_shown(1, 499).time_ns);
    take base;
    scene_must(show_take_base(other, takes[0].id, &base, &err), &err);
    assert_string_equal(base.origin, "recorded, recovered");
    assert_int_equal(base.layer[0].clip[0].to_ns, takes[0].end_ns);
    take_finish(&base);
    for (int i = 0; i < 2; ++i) { /* its mark is a marker, once */
        scene_must(edit_store_add_recovered_marks(other, clock_utc_ms, &err), &err);
        scene_must(edit_store_take(&base, other, takes[0].id, &err), &err);
        assert_int_equal(base.marker_count, 1);
        assert_string_equal(base.marker[0].text, "cue");
        assert_int_equal(base.marker[0].at_ns, 100 * scene_step_ns - 500);
        take_finish(&base);
    }
    free(takes);
    show_close(other);
    scene_must(show_open(&other, s->path, SHOW_WRITE, &err), &err);
    assert_string_equal(show_notice(other), ""); /* said once */
    show_close(other);
    close(ready[0]);
    close(ready[1]);
}

/* ---- where one may not write: root may everywhere, so a child becomes somebody else ---- */

enum { NOBODY = 65534 };

typedef int (*task)(const scene *s, int64_t track);

static int as_nobody(const scene *s, int64_t track, task run)
{
    pid_t child = fork();
    if (child == 0) {
        if (geteuid() == 0 && (setgid(NOBODY) != 0 || setuid(NOBODY) != 0))
            _exit(77);
        _exit(run(s, track));
    }
    return status_of_child(child);
}

static int reads_all(show *got, int64_t track, int64_t count)
{
    error err;
    show_reader *reader;
    mrt_sample sample;
    int64_t n = 0;
    mrt_result result;
    if (show_reader_open(&reader, got, track, INT64_MIN, INT64_MAX, &err) < 0)
        return 10;
    while ((result = show_reader_next(reader, &sample, &err)) == MRT_OK) {
        mrt_sample expected = scene_shown(track, n++);
        if (!scene_is_same(&sample, &expected))
            return 11;
    }
    show_reader_close(reader);
    return result == MRT_END && n == count ? 0 : 12;
}

static int opens_for_reading_and_says_so(const scene *s, int64_t track)
{
    error err = {""};
    show *got;
    if (show_open(&got, s->path, SHOW_WRITE, &err) < 0) {
        fprintf(stderr, "%s\n", err.text);
        return 2;
    }
    if (show_is_writable(got) || !strstr(show_notice(got), "opened read-only"))
        return 3;
    int status = reads_all(got, track, 100);
    show_close(got);
    return status;
}

static void a_folder_that_cannot_be_written_opens_for_reading(void **state)
{
    scene *s = *state;
    int64_t track = record_some(s->path, 100);
    assert_int_equal(chmod(s->path, 0666), 0);
    assert_int_equal(chmod(s->folder, 0555), 0);
    int status = as_nobody(s, track, opens_for_reading_and_says_so);
    assert_int_equal(chmod(s->folder, 0755), 0);
    assert_int_equal(status, 0);
}

static void a_file_that_cannot_be_written_opens_for_reading(void **state)
{
    scene *s = *state;
    char before[LISTING];
    int64_t track = record_some(s->path, 100);
    assert_int_equal(chmod(s->folder, 0777), 0);
    for (mode_t mode = 0444; mode <= 0644; mode += 0200) {
        if (mode != 0444 && geteuid() != 0)
            continue; /* the owner may write it */
        assert_int_equal(chmod(s->path, mode), 0);
        list_folder(s, before);
        assert_int_equal(as_nobody(s, track, opens_for_reading_and_says_so), 0);
        expect_unchanged(s, before);
    }
}

/* Nobody reads, then its owner writes: what was read without locks is read no further. */
static int stops_reading_when_another_writes(const scene *s, int64_t track)
{
    error err = {""};
    char lock[SCENE_PATH + 8];
    show *got;
    show_performance performed;
    if (show_open(&got, s->path, SHOW_READ, &err) < 0 || reads_all(got, track, 100) != 0)
        return 2;
    (void)snprintf(lock, sizeof lock, "%s-lock", s->path);
    write_file(lock, "", 0);
    if (show_performance_read(got, 1, &performed, &err) >= 0)
        return 3;
    show_close(got);
    return strstr(err.text, "another program began to write it") ? 0 : 4;
}

static void who_may_not_write_stops_reading_when_another_writes(void **state)
{
    scene *s = *state;
    int64_t track = record_some(s->path, 100);
    assert_int_equal(chmod(s->folder, 0777), 0);
    assert_int_equal(chmod(s->path, 0444), 0);
    assert_int_equal(as_nobody(s, track, stops_reading_when_another_writes), 0);
}

static int says_what_is_missing(const scene *s, int64_t track)
{
    (void)track;
    error err = {""};
    show *got;
    if (show_open(&got, s->path, SHOW_READ, &err) < 0)
        return 2;
    int status = strstr(show_notice(got), "-wal and cannot be read here") ? 0 : 3;
    show_close(got);
    return status;
}

/* A killed recording on a medium that cannot be written: the log beside it is not read in silence.
 */
static void a_log_that_cannot_be_read_is_said(void **state)
{
    scene *s = *state;
    record_some(s->path, 100);
    assert_int_equal(chmod(s->path, 0644), 0);
    char log[SCENE_PATH + 8];
    snprintf(log, sizeof log, "%s-wal", s->path);
    write_file(log, "x", 1);
    assert_int_equal(chmod(log, 0), 0);
    assert_int_equal(chmod(s->folder, 0555), 0);
    int status = as_nobody(s, 1, says_what_is_missing);
    assert_int_equal(chmod(s->folder, 0755), 0);
    assert_int_equal(status, 0);
}

/* ---- versions ---- */

static void an_older_show_becomes_todays(void **state)
{
    scene *s = *state;
    error err = {""};
    show *got;
    show_performance performed;
    int64_t track = record_some(s->path, 400);
    run_sql(s->path, "DROP TABLE patch; PRAGMA user_version = 2");
    scene_must(show_open(&got, s->path, SHOW_READ, &err), &err);
    scene_must(show_check(got, &err), &err);
    scene_must(show_performance_read(got, 1, &performed, &err), &err);
    assert_null(performed.performance.patch);
    show_performance_finish(&performed);
    show_close(got);
    run_sql(s->path, "ALTER TABLE track DROP COLUMN chunk_count; PRAGMA user_version = 1");
    scene_must(show_open(&got, s->path, SHOW_READ, &err), &err);
    scene_expect(got, track, 0, 400); /* read as it is */
    show_close(got);
    scene_must(show_open(&got, s->path, SHOW_WRITE, &err), &err);
    assert_true(show_is_writable(got));
    scene_expect(got, track, 0, 400);
    writer_options options = scene_options();
    scene_recording r;
    scene_record(&r, got, &options);
    scene_give(&r, 0, 10);
    scene_stop(&r);
    show_close(got);
    sqlite3 *db;
    sqlite3_stmt *row;
    assert_int_equal(sqlite3_open(s->path, &db), SQLITE_OK);
    assert_int_equal(sqlite3_prepare_v2(db, "SELECT MIN(chunk_count), MAX(chunk_count) FROM track",
                                        -1, &row, NULL),
                     SQLITE_OK);
    assert_int_equal(sqlite3_step(row), SQLITE_ROW);
    assert_int_equal(sqlite3_column_int(row, 0), 1);
    assert_int_equal(sqlite3_column_int(row, 1), 3); /* 400 samples are 2.7 s */
    sqlite3_finalize(row);
    sqlite3_close(db);
}

static void a_newer_show_opens_for_reading_if_it_can_be_read(void **state)
{
    scene *s = *state;
    error err = {""};
    show *got;
    int64_t track = record_some(s->path, 100);
    run_sql(s->path, "ALTER TABLE take ADD COLUMN mood TEXT; PRAGMA user_version = 99");
    scene_must(show_open(&got, s->path, SHOW_WRITE, &err), &err);
    assert_false(show_is_writable(got));
    assert_non_null(strstr(show_notice(got), "newer marotte (format 99"));
    scene_expect(got, track, 0, 100);
    show_close(got);
    assert_false(is_there(s->path, "-lock"));
    run_sql(s->path, "UPDATE meta SET value = 98 WHERE key = 'oldest_reader'");
    show_mode modes[] = {SHOW_READ, SHOW_WRITE};
    for (int i = 0; i < 2; ++i) {
        assert_int_equal(show_open(&got, s->path, modes[i], &err), MRT_ERR_UNSUPPORTED);
        assert_non_null(strstr(err.text, "update marotte"));
    }
}

/* ---- the file goes away ---- */

static void recording_goes_on_into_a_deleted_file_and_can_be_rescued(void **state)
{
    scene *s = *state;
    char copy[SCENE_PATH];
    error err = {""};
    show *got, *rescued;
    writer_options options = scene_options();
    scene_recording r;
    snprintf(copy, sizeof copy, "%s/copy.marotte", s->folder);
    scene_must(show_create(&got, s->path, &err), &err);
    scene_record(&r, got, &options);
    scene_give(&r, 0, 100);
    scene_flush(&r);
    assert_false(show_is_missing(got));
    assert_int_equal(unlink(s->path), 0);
    assert_true(show_is_missing(got));
    scene_give(&r, 100, 200);
    scene_flush(&r);
    assert_int_equal(writer_status_of(r.writer).state, WRITER_OK);
    scene_must(show_rescue(got, copy, &err), &err);
    assert_int_equal(show_rescue(got, copy, &err), MRT_ERR_ARGUMENT);
    scene_give(&r, 200, 300);
    scene_flush(&r);
    scene_expect(got, r.track, 0, 300);
    scene_stop(&r);
    char beside[2][SCENE_PATH + 32];
    for (int i = 0; i < 2; ++i) {
        (void)snprintf(beside[i], sizeof beside[i], "%s/test.rescued%s.marotte", s->folder,
                       i ? "-2" : "");
        assert_int_equal(show_rescue_missing(got, &err), SHOW_RESCUE_BESIDE);
        assert_non_null(strstr(err.text, beside[i]));
        assert_int_equal(access(beside[i], F_OK), 0);
    }
    show_close(got);
    scene_must(show_open(&rescued, beside[1], SHOW_WRITE, &err), &err);
    scene_expect(rescued, r.track, 0, 300);
    show_close(rescued);
    scene_must(show_open(&rescued, copy, SHOW_WRITE, &err), &err);
    scene_expect(rescued, r.track, 0, 200);
    show_close(rescued);
}

static void without_its_folder_the_copy_lies_with_the_persons_data(void **state)
{
    scene *s = *state;
    char path[SCENE_PATH + 64], home[SCENE_PATH], copy[SCENE_PATH + 64];
    error err = {""};
    show *got, *rescued;
    writer_options options = scene_options();
    scene_recording r;
    (void)snprintf(path, sizeof path, "%s/gone", s->folder);
    (void)snprintf(home, sizeof home, "%s/home", s->folder);
    assert_int_equal(mkdir(path, 0700), 0);
    (void)snprintf(path, sizeof path, "%s/gone/test.marotte", s->folder);
    (void)snprintf(copy, sizeof copy, "%s/marotte/rescued/test.rescued.marotte", home);
    assert_int_equal(setenv("XDG_DATA_HOME", home, 1), 0);
    scene_must(show_create(&got, path, &err), &err);
    assert_int_equal(show_rescue_missing(got, &err), SHOW_RESCUE_NONE);
    assert_string_equal(err.text, "");
    scene_record(&r, got, &options);
    scene_give(&r, 0, 100);
    char command[2 * SCENE_PATH];
    (void)snprintf(command, sizeof command, "rm -rf '%s/gone'", s->folder);
    assert_int_equal(system(command), 0);
    scene_give(&r, 100, 200);
    scene_stop(&r);
    assert_int_equal(setenv("XDG_DATA_HOME", "/dev/null", 1), 0);
    assert_int_equal(show_rescue_missing(got, &err), SHOW_RESCUE_LOST);
    assert_non_null(strstr(err.text, path));
    assert_int_equal(setenv("XDG_DATA_HOME", home, 1), 0);
    assert_int_equal(show_rescue_missing(got, &err), SHOW_RESCUE_HOME);
    assert_non_null(strstr(err.text, path));
    assert_non_null(strstr(err.text, copy));
    show_close(got);
    scene_must(show_open(&rescued, copy, SHOW_READ, &err), &err);
    scene_expect(rescued, r.track, 0, 200);
    show_close(rescued);
}

static void a_replaced_file_is_noticed(void **state)
{
    scene *s = *state;
    char other[SCENE_PATH];
    error err = {""};
    show *got;
    snprintf(other, sizeof other, "%s/other.marotte", s->folder);
    scene_must(show_create(&got, s->path, &err), &err);
    write_file(other, "x", 1);
    assert_true(show_is_file(got, s->path));
    assert_false(show_is_file(got, other));
    assert_int_equal(rename(other, s->path), 0);
    assert_true(show_is_missing(got));
    assert_false(show_is_file(got, s->path));
    show_close(got);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, scene_set_up, scene_tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(a_closed_show_is_one_file),
        TEST(who_only_reads_leaves_the_folder_as_it_was),
        TEST(who_reads_beside_a_writer_takes_nothing_from_it),
        TEST(who_reads_after_a_kill_leaves_the_log),
        TEST(readers_that_end_at_once_leave_nothing),
        TEST(readers_and_writers_meet_at_any_moment),
        TEST(a_second_connection_does_not_drop_the_locks_of_the_first),
        TEST(a_show_is_not_made_over_a_file),
        TEST(what_is_no_show_is_refused_by_name),
        TEST(names_with_special_letters_work),
        TEST(the_second_one_reads_and_says_who_writes),
        TEST(a_killed_program_leaves_no_lock_and_its_take),
        TEST(a_folder_that_cannot_be_written_opens_for_reading),
        TEST(a_file_that_cannot_be_written_opens_for_reading),
        TEST(who_may_not_write_stops_reading_when_another_writes),
        TEST(a_log_that_cannot_be_read_is_said),
        TEST(an_older_show_becomes_todays),
        TEST(a_newer_show_opens_for_reading_if_it_can_be_read),
        TEST(recording_goes_on_into_a_deleted_file_and_can_be_rescued),
        TEST(without_its_folder_the_copy_lies_with_the_persons_data),
        TEST(a_replaced_file_is_noticed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
