/* plugins/cyberglove as a performance has it: read by an input's thread, the emulated glove another
 * process, the clock the system's. What needs just that is here, and nothing says how long it
 * takes; all else has a clock of its own (glove_session.h). */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/clock.h"
#include "glove_child.h"
#include "glove_motion.h"
#include "glove_truth.h"
#include "stage/input/input.h"
#include "stage/mapping/plugins.h"

#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <unistd.h>

#define OPTIONS(...) ((const char *const[]){__VA_ARGS__, NULL})

enum { PATIENCE_S = 60, TAKEN = 60 };

typedef struct live {
    glove_child child;
    plugin_list plugins;
    const mrt_plugin_type *type;
    log_queue *log;
    input *input;
} live;

static void begin(live *self, const char *const *options)
{
    error err = {""};
    *self = (live){0};
    mrt_result result =
        glove_child_start(&self->child, BUILD_DIR "/tests/device/glove_emulator", options, &err);
    if (result == MRT_ERR_UNSUPPORTED) {
        print_message("SKIPPED: there are no pseudo terminals here\n");
        skip();
    }
    if (result < 0 ||
        plugin_list_add(&self->plugins, BUILD_DIR "/plugins/cyberglove.so", &err) < 0 ||
        plugin_list_find(&self->plugins, "cyberglove", MRT_INPUT, &self->type, &err) < 0)
        fail_msg("%s", err.text);
    self->log = log_queue_create();
    assert_non_null(self->log);
}

static mrt_result try_open(live *self, error *err)
{
    return input_create(&self->input, self->type, self->child.address, "", CLOCK_REAL, self->log,
                        err);
}

static void start(live *self)
{
    error err = {""};
    if (try_open(self, &err) < 0 || input_start(self->input, &err) < 0)
        fail_msg("%s", err.text);
}

static void close_input(live *self)
{
    input_destroy(self->input);
    self->input = NULL;
}

static void end(live *self)
{
    close_input(self);
    log_queue_destroy(self->log);
    plugin_list_destroy(&self->plugins);
    glove_child_finish(&self->child);
}

static bool take(live *self, mrt_sample *out)
{
    int64_t end_ns = clock_now_ns() + PATIENCE_S * NS_PER_S;
    while (!input_peek(self->input, out)) {
        if (clock_now_ns() > end_ns)
            return false;
        clock_sleep_until_ns(clock_now_ns() + 2 * NS_PER_MS);
    }
    input_pop(self->input);
    return true;
}

/* Its terminal echoes, so what it streams would go back to it as orders. */
static void a_glove_that_was_left_streaming(void **state)
{
    (void)state;
    static mrt_sample sample[TAKEN];
    live self;
    glove_truth truth;
    error err = {""};
    mrt_channel channel[MRT_MAX_CHANNELS];
    uint32_t count;
    begin(&self, OPTIONS("--numbered", "--streaming", "--cooked"));
    start(&self);
    memcpy(channel, input_channels(self.input, &count), sizeof *channel * GLOVE_SENSORS);
    assert_int_equal(count, GLOVE_SENSORS);
    for (int i = 0; i < TAKEN; ++i)
        assert_true(take(&self, &sample[i]));
    close_input(&self);
    assert_true(glove_child_stop(&self.child));
    if (glove_truth_read(&truth, self.child.truth, &err) < 0)
        fail_msg("%s", err.text);
    for (int i = 0; i < TAKEN; ++i) {
        int32_t number = glove_motion_number_in(channel, &sample[i]);
        const glove_truth_row *row = glove_truth_find(&truth, (uint32_t)number);
        assert_non_null(row);
        for (uint32_t k = 0; k < GLOVE_SENSORS; ++k)
            assert_int_equal((int)sample[i].value[k], row->record[1 + k]);
    }
    glove_truth_finish(&truth);
    end(&self);
}

/* Ctrl-C, while a port is asked that does not answer. */
static void opening_is_given_up_when_the_person_says_so(void **state)
{
    (void)state;
    live self;
    error err = {""};
    _Atomic bool stop = true;
    begin(&self, OPTIONS("--nature", "mute"));
    assert_true(input_create_stoppable(&self.input, self.type, self.child.address, "", CLOCK_REAL,
                                       self.log, &stop, &err) < 0);
    assert_non_null(strstr(err.text, "cancelled"));
    end(&self);
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
    live self;
    error err = {""};
    int status, pipe_end;
    char holder[32];
    begin(&self, OPTIONS("--numbered"));
    pid_t pid = hold_elsewhere(self.child.link, &pipe_end);
    mrt_result result = try_open(&self, &err);
    close(pipe_end);
    assert_int_equal(waitpid(pid, &status, 0), pid);
    assert_int_equal(status, 0);
    assert_true(result < 0);
    assert_non_null(strstr(err.text, self.child.link));
    snprintf(holder, sizeof holder, "(process %d)", (int)pid);
    assert_non_null(strstr(err.text, holder)); /* not the emulator, which has it open too */
    end(&self);
}

/* Lost, it is sought again and again; the input stops all the same. */
static void a_glove_that_died_is_lost_and_its_input_stops(void **state)
{
    (void)state;
    live self;
    begin(&self, OPTIONS("--die-after", "100"));
    start(&self);
    int64_t end_ns = clock_now_ns() + PATIENCE_S * NS_PER_S;
    mrt_sample sample;
    while (input_state_of(self.input) != INPUT_LOST && clock_now_ns() < end_ns)
        if (input_peek(self.input, &sample))
            input_pop(self.input);
        else
            clock_sleep_until_ns(clock_now_ns() + 2 * NS_PER_MS);
    assert_int_equal(input_state_of(self.input), INPUT_LOST);
    end(&self);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_glove_that_was_left_streaming),
        cmocka_unit_test(opening_is_given_up_when_the_person_says_so),
        cmocka_unit_test(a_port_that_another_program_holds),
        cmocka_unit_test(a_glove_that_died_is_lost_and_its_input_stops),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
