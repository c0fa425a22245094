/* Programs beside the running one, and what of others' words reaches the terminal. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/clock.h"
#include "base/file.h"
#include "base/log.h"
#include "base/program.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static const char hostile[] = "a\x1b]0;own\a\nb\xe2\x80\xae c\xff";

static bool steers(const char *text)
{
    return strpbrk(text, "\x1b\a\n\xff") || strstr(text, "\xe2\x80\xae");
}

static void an_error_is_one_printable_line(void **state)
{
    (void)state;
    error err = {""};
    (void)error_set(&err, MRT_ERR_IO, "%s: cannot be read", hostile);
    assert_false(steers(err.text));
    assert_non_null(strstr(err.text, ": cannot be read"));
    error_prefix(&err, hostile);
    assert_false(steers(err.text));
    (void)error_set(&err, MRT_ERR_IO, "%s", "Größe 3 µm");
    assert_string_equal(err.text, "Größe 3 µm");
}

static void a_line_of_the_log_is_printable(void **state)
{
    (void)state;
    log_queue *log = log_queue_create();
    log_record line;
    log_push(log, MRT_LOG_INFO, hostile, hostile);
    assert_true(log_pop(log, &line));
    assert_false(steers(line.source) || steers(line.text));
    log_queue_destroy(log);
}

/* What a shell makes of it again. */
static void unquote(char *out, size_t capacity, const char *quoted)
{
    char command[512];
    (void)snprintf(command, sizeof command, "printf %%s %s", quoted);
    int end[2], status;
    pid_t pid;
    error err = {""};
    assert_int_equal(program_pipe(end, &err), MRT_OK);
    posix_spawn_file_actions_t actions;
    assert_int_equal(posix_spawn_file_actions_init(&actions), 0);
    assert_int_equal(posix_spawn_file_actions_adddup2(&actions, end[1], STDOUT_FILENO), 0);
    char shell[] = "/bin/bash", option[] = "-c", *words[] = {shell, option, command, NULL};
    assert_int_equal(posix_spawn(&pid, shell, &actions, NULL, words, NULL), 0);
    posix_spawn_file_actions_destroy(&actions);
    close(end[1]);
    size_t used = 0;
    ssize_t got;
    while ((got = read(end[0], out + used, capacity - 1 - used)) > 0)
        used += (size_t)got;
    out[used] = '\0';
    close(end[0]);
    assert_true(program_wait(pid, &status, 60 * NS_PER_S));
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

static void a_quoted_word_is_read_back_by_a_shell(void **state)
{
    (void)state;
    if (access("/bin/bash", X_OK) != 0)
        skip();
    static const char *const words[] = {"/plain/a.so", "",  "some where", "it's", "$(reboot);`x`&",
                                        "back\\slash", "*", "-x",         hostile};
    for (size_t i = 0; i < sizeof words / sizeof *words; ++i) {
        char quoted[256], back[256];
        program_quote(quoted, sizeof quoted, words[i]);
        assert_false(steers(quoted));
        unquote(back, sizeof back, quoted);
        assert_string_equal(back, words[i]);
    }
    char small[4];
    program_quote(small, sizeof small, "some where");
    assert_string_equal(small, "");
    program_quote(small, sizeof small, "abc");
    assert_string_equal(small, "abc");
}

static void a_pipe_is_closed_in_programs_that_start_meanwhile(void **state)
{
    (void)state;
    int end[2];
    error err = {""};
    assert_int_equal(program_pipe(end, &err), MRT_OK);
    for (int i = 0; i < 2; ++i) {
        assert_true(fcntl(end[i], F_GETFD) & FD_CLOEXEC);
        close(end[i]);
    }
}

static void a_child_that_does_not_end_is_ended(void **state)
{
    (void)state;
    char shell[] = "/bin/sh", option[] = "-c", command[] = "exec sleep 100";
    char *words[] = {shell, option, command, NULL};
    pid_t pid;
    int status;
    assert_int_equal(posix_spawn(&pid, shell, NULL, NULL, words, NULL), 0);
    assert_false(program_wait(pid, &status, NS_PER_S / 10));
    assert_true(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
    char good[] = "exit 3";
    words[2] = good;
    assert_int_equal(posix_spawn(&pid, shell, NULL, NULL, words, NULL), 0);
    assert_true(program_wait(pid, &status, 60 * NS_PER_S));
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 3);
}

static void a_program_is_looked_for_where_this_one_runs(void **state)
{
    (void)state;
    char found[PATH_MAX];
    error err = {""};
    /* A file that this test finds only at the top of its build folder. */
    assert_int_equal(program_find(found, "marotte-pluginhost", "MAROTTE_TEST_UNSET", "", &err),
                     MRT_OK);
    assert_string_equal(found, BUILD_DIR "/marotte-pluginhost");
    assert_true(program_find(found, "sh", "MAROTTE_TEST_UNSET", "", &err) < 0);
    assert_non_null(strstr(err.text, "not beside the program"));
    /* One that is named without a path lies here: what is started looks in $PATH for such. */
    char here[PATH_MAX];
    assert_non_null(getcwd(here, sizeof here));
    assert_int_equal(chdir(BUILD_DIR), 0);
    assert_int_equal(setenv("MAROTTE_TEST_SET", "marotte-pluginhost", 1), 0);
    assert_int_equal(program_find(found, "x", "MAROTTE_TEST_SET", "", &err), MRT_OK);
    assert_string_equal(found, "./marotte-pluginhost");
    assert_int_equal(chdir(here), 0);
}

static void a_written_file_has_the_mode_that_the_umask_gives(void **state)
{
    (void)state;
    char folder[] = "/tmp/marotte-program-XXXXXX", path[64];
    struct stat made;
    error err = {""};
    assert_non_null(mkdtemp(folder));
    (void)snprintf(path, sizeof path, "%s/a", folder);
    mode_t before = umask(027);
    assert_int_equal(file_write(path, "x", 1, &err), MRT_OK);
    assert_int_equal(umask(before), 027); /* it never was another one */
    assert_int_equal(stat(path, &made), 0);
    assert_int_equal(made.st_mode & 0777, 0640);
    assert_int_equal(unlink(path), 0);
    assert_int_equal(rmdir(folder), 0);
}

static void folders_of_the_person_are_made(void **state)
{
    (void)state;
    char folder[] = "/tmp/marotte-program-XXXXXX", path[128], made[256];
    struct stat status;
    error err = {""};
    assert_non_null(mkdtemp(folder));
    assert_int_equal(setenv("XDG_CACHE_HOME", folder, 1), 0);
    assert_int_equal(file_home_path(made, sizeof made, FILE_HOME_CACHE, "plugins/a.b", &err), 0);
    (void)snprintf(path, sizeof path, "%s/marotte/plugins/a.b", folder);
    assert_string_equal(made, path);
    for (int twice = 0; twice < 2; ++twice)
        assert_int_equal(file_make_folders(made, &err), MRT_OK);
    assert_true(stat(made, &status) == 0 && S_ISDIR(status.st_mode));
    assert_int_equal(setenv("XDG_CACHE_HOME", "relative", 1), 0);
    assert_int_equal(unsetenv("HOME"), 0);
    assert_int_equal(unsetenv("XDG_DOCUMENTS_DIR"), 0);
    assert_true(file_home_path(made, sizeof made, FILE_HOME_DOCUMENTS, "x", &err) < 0);
    assert_true(file_home_path(made, sizeof made, FILE_HOME_CACHE, "x", &err) < 0);
    for (char *slash = path + strlen(path); slash > path + strlen(folder) - 1;) {
        assert_int_equal(rmdir(path), 0);
        slash = strrchr(path, '/');
        *slash = '\0';
        if (strcmp(path, folder) == 0)
            break;
    }
    assert_int_equal(rmdir(folder), 0);
}

static void documents_are_where_the_desktop_says(void **state)
{
    (void)state;
    static const struct {
        const char *lines, *documents; /* NULL: no file */
    } cases[] = {
        {NULL, "/home/ada"},
        {"# a comment\nXDG_MUSIC_DIR=\"$HOME/Musik\"\nXDG_DOCUMENTS_DIR=\"$HOME/Dokumente\"\n",
         "/home/ada/Dokumente"},
        {"  XDG_DOCUMENTS_DIR=\"/mnt/my \\\"own\\\" files\"", "/mnt/my \"own\" files"},
        {"XDG_DOCUMENTS_DIR=\"/first\"\nXDG_DOCUMENTS_DIR=\"/second\"\n", "/second"},
        {"XDG_DOCUMENTS_DIR=\"relative\"\n", "/home/ada"},
        {"XDG_DOCUMENTS_DIR=\"/has no end\nXDG_MUSIC_DIR=\"/x\"\n", "/home/ada"},
        {"#XDG_DOCUMENTS_DIR=\"/commented\"\n", "/home/ada"},
    };
    char folder[] = "/tmp/marotte-program-XXXXXX", path[128], made[256], expected[256];
    error err = {""};
    assert_non_null(mkdtemp(folder));
    (void)snprintf(path, sizeof path, "%s/user-dirs.dirs", folder);
    assert_int_equal(setenv("XDG_CONFIG_HOME", folder, 1), 0);
    assert_int_equal(setenv("HOME", "/home/ada", 1), 0);
    assert_int_equal(unsetenv("XDG_DOCUMENTS_DIR"), 0);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        const char *lines = cases[i].lines;
        if (lines)
            assert_int_equal(file_write(path, lines, strlen(lines), &err), MRT_OK);
        assert_int_equal(file_home_path(made, sizeof made, FILE_HOME_DOCUMENTS, "a", &err), MRT_OK);
        (void)snprintf(expected, sizeof expected, "%s/marotte/a", cases[i].documents);
        assert_string_equal(made, expected);
    }
    assert_int_equal(setenv("XDG_DOCUMENTS_DIR", "/chosen", 1), 0);
    assert_int_equal(file_home_path(made, sizeof made, FILE_HOME_DOCUMENTS, "a", &err), MRT_OK);
    assert_string_equal(made, "/chosen/marotte/a");
    assert_int_equal(unlink(path), 0);
    assert_int_equal(rmdir(folder), 0);
}

/* What `how` passes, pipes of this process, is written to by a shell as descriptor 7. */
static void check_passed(int reading, int writing)
{
    char *words[] = {program_argument("sh"), program_argument("-c"),
                     program_argument("echo here >&7"), NULL};
    const program_start how = {.program = "sh",
                               .words = words,
                               .in = -1,
                               .out = -1,
                               .err = -1,
                               .passed = writing,
                               .passed_as = 7,
                               .signals = PROGRAM_USUAL_SIGNALS};
    pid_t pid;
    int status;
    char said[8] = "";
    assert_int_equal(program_spawn(&pid, &how), 0);
    assert_int_equal(read(reading, said, sizeof said - 1), 5);
    assert_string_equal(said, "here\n");
    assert_true(program_wait(pid, &status, 60 * NS_PER_S));
    assert_int_equal(status, 0);
}

static void a_descriptor_is_passed_under_its_number(void **state)
{
    (void)state;
    int end[2];
    error err = {""};
    assert_int_equal(program_pipe(end, &err), MRT_OK);
    check_passed(end[0], end[1]);
    if (end[1] != 7)
        assert_int_equal(dup2(end[1], 7), 7);
    assert_int_equal(fcntl(7, F_SETFD, FD_CLOEXEC), 0); /* as if it had that number here too */
    check_passed(end[0], 7);
    close(7);
    close(end[0]);
    if (end[1] != 7)
        close(end[1]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_error_is_one_printable_line),
        cmocka_unit_test(a_line_of_the_log_is_printable),
        cmocka_unit_test(a_quoted_word_is_read_back_by_a_shell),
        cmocka_unit_test(a_pipe_is_closed_in_programs_that_start_meanwhile),
        cmocka_unit_test(a_descriptor_is_passed_under_its_number),
        cmocka_unit_test(a_child_that_does_not_end_is_ended),
        cmocka_unit_test(a_program_is_looked_for_where_this_one_runs),
        cmocka_unit_test(a_written_file_has_the_mode_that_the_umask_gives),
        cmocka_unit_test(folders_of_the_person_are_made),
        cmocka_unit_test(documents_are_where_the_desktop_says),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
