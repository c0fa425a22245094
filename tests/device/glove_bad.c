/* plugins/cyberglove against whatever else can be at the end of a cable: each ends in bounded time,
 * with an error that a person can read, and without a spin. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "glove_session.h"

#include <sys/stat.h>
#include <unistd.h>

static const double OPEN_MAX_S = 7.0;   /* of the virtual clock, as all times here */
static const double LOSS_MAX_S = 6.0;   /* until a silent stream counts as lost */
static const double WAITS_MAX_HZ = 600; /* a program that spins asks without end */

enum { NOBODY = 65534, OPTION_WORDS = 5 };

static double seconds_since(int64_t start_ns)
{
    return (double)(clock_now_ns() - start_ns) * 1e-9;
}

/* ---- what does not open ---- */

typedef struct attempt {
    const char *const option[OPTION_WORDS];
    glove_session session;
    mrt_result result;
    error err;
    double time_s, wait_count;
} attempt;

static void try_open(attempt *self, instance *plugin)
{
    int64_t start_ns = clock_now_ns();
    uint64_t before = virtual_clock_wait_count();
    self->result = session_open_instance(&self->session, plugin, "", &self->err);
    self->time_s = seconds_since(start_ns);
    self->wait_count = (double)(virtual_clock_wait_count() - before);
}

static void check_refusal(const attempt *self)
{
    const char *link = self->session.place.link;
    print_message("  %s %s: %.2f s, %.0f waits: %s\n", self->option[0], self->option[1],
                  self->time_s, self->wait_count, self->err.text);
    assert_true(self->result < 0);
    assert_true(self->time_s < OPEN_MAX_S);
    assert_true(self->wait_count < 60 + WAITS_MAX_HZ * self->time_s);
    assert_non_null(strstr(self->err.text, link)); /* names the thing */
    assert_true(strlen(self->err.text) > strlen(link) + 20);
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
    for (size_t i = 0; i < sizeof attempts / sizeof *attempts; ++i) {
        session_begin(&attempts[i].session, attempts[i].option);
        try_open(&attempts[i], &attempts[i].session.plugin);
        check_refusal(&attempts[i]);
        session_end(&attempts[i].session);
    }
}

static void a_port_that_this_user_may_not_open(void **state)
{
    (void)state;
    attempt self = {.option = {"--nature", "glove"}};
    session_begin(&self.session, self.option);
    bool is_root = geteuid() == 0;
    assert_int_equal(chmod(self.session.place.folder, 0755), 0);
    assert_int_equal(chmod(self.session.place.link, 0), 0);
    if (is_root)
        assert_int_equal(seteuid(NOBODY), 0);
    try_open(&self, &self.session.plugin);
    if (is_root)
        assert_int_equal(seteuid(0), 0);
    check_refusal(&self);
    session_end(&self.session);
}

static void a_port_that_another_input_holds(void **state)
{
    (void)state;
    attempt self = {.option = {"--numbered", NULL}};
    instance second;
    session_begin(&self.session, self.option);
    session_open(&self.session, "");
    try_open(&self, &second);
    check_refusal(&self);
    instance_destroy(&second);
    /* The one that has it is not disturbed. */
    assert_true(session_take(&self.session, 30, 5));
    session_end(&self.session);
}

static void a_port_that_is_not_there(void **state)
{
    (void)state;
    attempt self = {.option = {"--numbered", NULL}};
    session_begin(&self.session, self.option);
    glove_emulator_obey(self.session.emulator, "unplug", clock_now_ns());
    try_open(&self, &self.session.plugin);
    check_refusal(&self);
    session_end(&self.session);
}

/* ---- what stops while it runs ---- */

static void streams_that_break_are_noticed(void **state)
{
    (void)state;
    static attempt attempts[] = {
        {.option = {"--cut-after", "100"}},
        {.option = {"--silent-after", "100"}},
        {.option = {"--noise-after", "100"}},
        {.option = {"--die-after", "100"}},
    };
    for (size_t i = 0; i < sizeof attempts / sizeof *attempts; ++i) {
        attempt *self = &attempts[i];
        session_begin(&self->session, self->option);
        session_open(&self->session, "");
        assert_true(session_take(&self->session, 60, 10));
        int64_t start_ns = clock_now_ns();
        uint64_t before = virtual_clock_wait_count();
        self->result = session_read(&self->session, SESSION_SAMPLES, 60, &self->err);
        self->time_s = seconds_since(start_ns);
        self->wait_count = (double)(virtual_clock_wait_count() - before);
        print_message("  %s: noticed within %.2f s, %.0f waits: %s\n", self->option[0],
                      self->time_s, self->wait_count, self->err.text);
        assert_int_equal(self->result, MRT_ERR_IO);
        assert_true(self->time_s < LOSS_MAX_S);
        assert_true(self->wait_count < 60 + WAITS_MAX_HZ * self->time_s);
        session_end(&self->session);
    }
}

/* A loose contact: the box starts anew, without the settings that it was told; the host opens what
 * was lost again. */
static void a_glove_that_forgets_is_told_again(void **state)
{
    (void)state;
    glove_session s;
    glove_truth truth;
    session_begin(&s, OPTIONS("--numbered", "--reset-after", "100", "--fault-lives", "1"));
    session_open(&s, "");
    error lost = {""};
    assert_int_equal(session_read(&s, 200, 15, &lost), MRT_ERR_IO);
    assert_true(s.count < 200);
    s.functions->close(s.plugin.self);
    assert_int_equal(s.functions->open(s.plugin.self, s.place.address, s.plugin.params), MRT_OK);
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
        cmocka_unit_test(a_port_that_this_user_may_not_open),
        cmocka_unit_test(a_port_that_another_input_holds),
        cmocka_unit_test(a_port_that_is_not_there),
        cmocka_unit_test(streams_that_break_are_noticed),
        cmocka_unit_test(a_glove_that_forgets_is_told_again),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
