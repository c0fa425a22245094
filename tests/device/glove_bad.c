/* plugins/cyberglove against whatever else can be at the end of a cable: each ends in bounded time,
 * with an error that a person can read, and without a spin. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "glove_session.h"

#include <fcntl.h>
#include <pthread.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static const double OPEN_MAX_S = 9.0; /* about 6 s, and a busy machine */
static const double LOSS_MAX_S = 6.0; /* until a silent stream counts as lost */
static const double STOP_MAX_S = 0.5;
static const double CPU_MAX = 0.10; /* of a core, while waiting; a spin takes all of it */

enum { NOBODY = 65534, OPTION_WORDS = 5 };

static double seconds_since(int64_t start_ns)
{
    return (double)(clock_now_ns() - start_ns) * 1e-9;
}

static double thread_cpu_s(void)
{
    struct timespec time;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return (double)time.tv_sec + (double)time.tv_nsec * 1e-9;
}

static double process_cpu_s(void)
{
    struct rusage use;
    getrusage(RUSAGE_SELF, &use);
    return (double)(use.ru_utime.tv_sec + use.ru_stime.tv_sec) +
           (double)(use.ru_utime.tv_usec + use.ru_stime.tv_usec) * 1e-6;
}

/* ---- what does not open ---- */

typedef struct attempt {
    const char *const option[OPTION_WORDS];
    glove_session session;
    mrt_result result;
    error err;
    double time_s, cpu_s;
} attempt;

static void *try_open(void *data)
{
    attempt *self = data;
    int64_t start_ns = clock_now_ns();
    double cpu_s = thread_cpu_s();
    self->result = session_try_open(&self->session, "", &self->err);
    self->time_s = seconds_since(start_ns);
    self->cpu_s = thread_cpu_s() - cpu_s;
    return NULL;
}

static void check_refusal(const attempt *self)
{
    print_message("  %s %s: %.1f s, CPU %.0f ms: %s\n", self->option[0], self->option[1],
                  self->time_s, self->cpu_s * 1e3, self->err.text);
    assert_true(self->result < 0);
    assert_true(self->time_s < OPEN_MAX_S);
    assert_true(self->cpu_s < 0.05 + CPU_MAX * self->time_s);
    assert_non_null(strstr(self->err.text, self->session.child.link)); /* names the thing */
    assert_true(strlen(self->err.text) > strlen(self->session.child.link) + 20);
    assert_null(strchr(self->err.text, '\n'));
}

static void what_is_no_sound_glove_is_refused(void **state)
{
    (void)state;
    static attempt attempts[] = {
        {.option = {"--nature", "modem"}},
        {.option = {"--nature", "echo"}},
        {.option = {"--nature", "noise"}},
        {.option = {"--nature", "mute"}},
        {.option = {"--mute-from-command", "2"}},
        {.option = {"--mute-from-command", "3"}},
        {.option = {"--mute-from-command", "5"}},
        {.option = {"--die-at-command", "1"}},
        {.option = {"--die-at-command", "2"}},
        {.option = {"--die-at-command", "3"}},
        {.option = {"--die-at-command", "4"}},
        {.option = {"--die-at-command", "5"}},
        {.option = {"--die-at-command", "6"}},
        {.option = {"--die-at-command", "7"}},
        {.option = {"--baud", "9600", "--minds-baud"}},
        {.option = {"--unplugged-every", "1", "--unplugged-run", "1"}},
    };
    enum { COUNT = sizeof attempts / sizeof *attempts };
    pthread_t thread[COUNT];
    for (int i = 0; i < COUNT; ++i)
        session_begin(&attempts[i].session, attempts[i].option);
    for (int i = 0; i < COUNT; ++i)
        assert_int_equal(pthread_create(&thread[i], NULL, try_open, &attempts[i]), 0);
    for (int i = 0; i < COUNT; ++i)
        pthread_join(thread[i], NULL);
    for (int i = 0; i < COUNT; ++i) {
        check_refusal(&attempts[i]);
        session_end(&attempts[i].session);
    }
}

/* Ctrl-C, while a port is asked that does not answer. */
static void opening_is_given_up_when_the_person_says_so(void **state)
{
    (void)state;
    glove_session s;
    error err = {""};
    _Atomic bool stop = true;
    session_begin(&s, OPTIONS("--nature", "mute"));
    int64_t start_ns = clock_now_ns();
    assert_true(input_create_stoppable(&s.input, s.type, s.child.address, "", CLOCK_REAL, s.log,
                                       &stop, &err) < 0);
    assert_true(seconds_since(start_ns) < STOP_MAX_S);
    assert_non_null(strstr(err.text, "given up"));
    session_end(&s);
}

static void a_port_that_this_user_may_not_open(void **state)
{
    (void)state;
    attempt self = {.option = {"--nature", "glove"}};
    session_begin(&self.session, self.option);
    bool is_root = geteuid() == 0;
    assert_int_equal(chmod(self.session.child.folder, 0755), 0);
    assert_int_equal(chmod(self.session.child.link, 0), 0);
    if (is_root)
        assert_int_equal(seteuid(NOBODY), 0);
    (void)try_open(&self);
    if (is_root)
        assert_int_equal(seteuid(0), 0);
    check_refusal(&self);
    session_end(&self.session);
}

static void a_port_that_another_input_holds(void **state)
{
    (void)state;
    attempt self = {.option = {"--numbered", NULL}};
    session_begin(&self.session, self.option);
    session_open(&self.session, "");
    input *first = self.session.input;
    (void)try_open(&self);
    check_refusal(&self);
    /* The one that has it is not disturbed. */
    self.session.input = first;
    assert_true(session_take(&self.session, 30, 5));
    session_end(&self.session);
}

/* Holds the terminal as a careful program does, until the pipe closes. */
static pid_t hold_elsewhere(const char *link, int *out_pipe)
{
    int ready[2], end[2];
    char byte = 0;
    assert_int_equal(pipe(ready), 0);
    assert_int_equal(pipe(end), 0);
    pid_t pid = fork();
    assert_true(pid >= 0);
    if (pid == 0) {
        int file = open(link, O_RDWR | O_NOCTTY | O_NONBLOCK);
        close(end[1]);
        if (file < 0 || flock(file, LOCK_EX | LOCK_NB) != 0 || ioctl(file, TIOCEXCL) != 0 ||
            write(ready[1], &byte, 1) != 1)
            _exit(1);
        _exit(read(end[0], &byte, 1) != 0);
    }
    assert_int_equal(read(ready[0], &byte, 1), 1);
    close(ready[0]);
    close(ready[1]);
    close(end[0]);
    *out_pipe = end[1];
    return pid;
}

static void a_port_that_another_program_holds(void **state)
{
    (void)state;
    attempt self = {.option = {"--numbered", NULL}};
    int status, end;
    session_begin(&self.session, self.option);
    pid_t pid = hold_elsewhere(self.session.child.link, &end);
    (void)try_open(&self);
    close(end);
    assert_int_equal(waitpid(pid, &status, 0), pid);
    assert_int_equal(status, 0);
    check_refusal(&self);
    char holder[32];
    snprintf(holder, sizeof holder, "(process %d)", (int)pid);
    assert_non_null(strstr(self.err.text, holder)); /* not the emulator, which has it open too */
    session_end(&self.session);
}

static void a_port_that_is_not_there(void **state)
{
    (void)state;
    attempt self = {.option = {"--numbered", NULL}};
    session_begin(&self.session, self.option);
    glove_child_say(&self.session.child, "unplug");
    for (int i = 0; i < 500 && access(self.session.child.link, F_OK) == 0; ++i)
        clock_sleep_until_ns(clock_now_ns() + 2 * NS_PER_MS);
    (void)try_open(&self);
    check_refusal(&self);
    session_end(&self.session);
}

/* ---- what stops while it runs ---- */

static bool is_lost(const input *in)
{
    return input_state_of(in) == INPUT_LOST || input_state_of(in) == INPUT_FAILED;
}

static void streams_that_break_are_noticed(void **state)
{
    (void)state;
    static attempt attempts[] = {
        {.option = {"--cut-after", "100"}},
        {.option = {"--silent-after", "100"}},
        {.option = {"--noise-after", "100"}},
        {.option = {"--die-after", "100"}},
    };
    enum { COUNT = sizeof attempts / sizeof *attempts };
    for (int i = 0; i < COUNT; ++i) {
        session_begin(&attempts[i].session, attempts[i].option);
        session_open(&attempts[i].session, "");
    }
    for (int i = 0; i < COUNT; ++i)
        assert_true(session_take(&attempts[i].session, 60, 10));
    int64_t start_ns = clock_now_ns();
    double cpu_s = process_cpu_s();
    for (int i = 0; i < COUNT; ++i) {
        while (!is_lost(attempts[i].session.input) && seconds_since(start_ns) < LOSS_MAX_S)
            clock_sleep_until_ns(clock_now_ns() + 20 * NS_PER_MS);
        print_message("  %s: noticed within %.1f s\n", attempts[i].option[0],
                      seconds_since(start_ns));
        assert_true(is_lost(attempts[i].session.input));
    }
    /* Lost, it is sought again and again, at leisure. */
    clock_sleep_until_ns(clock_now_ns() + NS_PER_S);
    double cpu = (process_cpu_s() - cpu_s) / seconds_since(start_ns);
    print_message("  CPU of four of them: %.1f %%\n", 100 * cpu);
    assert_true(cpu < COUNT * CPU_MAX);
    for (int i = 0; i < COUNT; ++i) {
        start_ns = clock_now_ns();
        session_close(&attempts[i].session);
        print_message("  %s: stopped in %.2f s\n", attempts[i].option[0], seconds_since(start_ns));
        assert_true(seconds_since(start_ns) < STOP_MAX_S);
        session_end(&attempts[i].session);
    }
}

/* A loose contact: the box starts anew, without the settings that it was told. */
static void a_glove_that_forgets_is_told_again(void **state)
{
    (void)state;
    glove_session s;
    glove_truth truth;
    session_begin(&s, OPTIONS("--numbered", "--reset-after", "100", "--fault-lives", "1"));
    session_open(&s, "");
    assert_true(session_take(&s, 200, 15));
    session_read_truth(&s, &truth);
    for (uint32_t i = 0; i < s.count; ++i) {
        int32_t number = glove_motion_number_in(s.channel, &s.sample[i]);
        const glove_truth_row *row = glove_truth_find(&truth, (uint32_t)number);
        assert_non_null(row);
        for (uint32_t k = 0; k < GLOVE_SENSORS; ++k)
            assert_int_equal((int)s.sample[i].value[k], row->record[1 + k]);
    }
    glove_truth_finish(&truth);
    session_end(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_no_sound_glove_is_refused),
        cmocka_unit_test(opening_is_given_up_when_the_person_says_so),
        cmocka_unit_test(a_port_that_this_user_may_not_open),
        cmocka_unit_test(a_port_that_another_input_holds),
        cmocka_unit_test(a_port_that_another_program_holds),
        cmocka_unit_test(a_port_that_is_not_there),
        cmocka_unit_test(streams_that_break_are_noticed),
        cmocka_unit_test(a_glove_that_forgets_is_told_again),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
