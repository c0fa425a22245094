/* core/stage/input: a device that goes away, what is said of it, what may come back, and that
 * stopping never waits for it. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "unit/input_help.h"

/* Longer than anything here takes on a machine that is busy: a test that waits so long fails. */
static const int64_t patience_ns = 60 * NS_PER_S;

typedef struct story {
    uint32_t went, came, samples, pedal_edges;
    int64_t away_ns;
    char first_words[LOG_TEXT];
    bool pedal_down; /* in the newest sample */
} story;

/* Follows the input until `is_done`, or fails. */
static void follow(input *in, wake *signal, story *out, bool (*is_done)(const input *, story *))
{
    int64_t end_ns = clock_now_ns() + patience_ns;
    for (;;) {
        uint32_t seen = wake_seen(signal);
        bool done = is_done(in, out);
        mrt_sample sample;
        input_incident incident;
        while (input_peek(in, &sample)) {
            uint32_t count;
            input_channels_of(in, input_version(in), &count);
            assert_int_equal(sample.count, count);
            bool is_down = sample.count == 3 && sample.value[2] > 0.5f;
            out->pedal_edges += is_down && !out->pedal_down;
            out->pedal_down = is_down;
            out->samples += 1;
            input_pop(in);
        }
        while (input_pop_incident(in, &incident)) {
            if (incident.kind == INPUT_WAS_LOST && out->went++ == 0)
                snprintf(out->first_words, sizeof out->first_words, "%s", incident.text);
            out->came += incident.kind == INPUT_IS_BACK;
            out->away_ns += incident.away_ns;
        }
        if (done)
            return;
        assert_true(clock_now_ns() < end_ns);
        wake_wait_until_ns(signal, seen, clock_now_ns() + 10 * NS_PER_MS);
    }
}

static void start(input *in, wake *signal)
{
    error err = {""};
    wake_init(signal);
    input_set_wake(in, signal);
    assert_int_equal(input_start(in, &err), MRT_OK);
}

static bool is_over(const input *in, story *so_far)
{
    (void)so_far;
    return input_state_of(in) == INPUT_ENDED || input_state_of(in) == INPUT_FAILED;
}

static bool is_lost(const input *in, story *so_far)
{
    (void)so_far;
    return input_state_of(in) == INPUT_LOST;
}

/* Lines of the log that contain `text`; drains it. */
static uint32_t lines_with(log_queue *log, const char *text)
{
    uint32_t count = 0;
    log_record record;
    while (log_pop(log, &record))
        count += strstr(record.text, text) != NULL;
    return count;
}

static void a_lost_device_is_opened_again_and_says_so(void **state)
{
    flaky_library *library = *state;
    wake signal;
    story told = {0};
    input *in = flaky_input(library, "port:7", "run=0.2,away=0.05,losses=1,after=0.2");
    start(in, &signal);
    follow(in, &signal, &told, is_over);
    assert_int_equal(input_state_of(in), INPUT_ENDED);
    assert_int_equal(told.went, 1);
    assert_int_equal(told.came, 1);
    assert_string_equal(told.first_words, "flaky port:7: the cable was pulled");
    assert_true(told.away_ns >= 50 * NS_PER_MS);
    assert_true(told.samples >= 6);
    health_report health;
    input_health(in, &health);
    assert_int_equal(health.loss_count, 1);
    assert_int_equal(health.state, INPUT_ENDED);
    input_destroy(in);
}

static void what_repeats_while_it_is_away_is_said_once(void **state)
{
    flaky_library *library = *state;
    wake signal;
    story told = {0};
    log_record record;
    while (log_pop(library->log, &record))
        continue;
    input *in = flaky_input(library, "port:8", "run=0.01,tries=100,losses=1,after=0.01");
    start(in, &signal);
    follow(in, &signal, &told, is_over);
    input_destroy(in);
    uint32_t refusals = 0, chatter = 0, pulled = 0;
    while (log_pop(library->log, &record)) {
        refusals += strcmp(record.text, "flaky port:8: no such device") == 0;
        chatter += strcmp(record.text, "looking") == 0;
        pulled += strstr(record.text, "cable was pulled") != NULL;
    }
    assert_int_equal(refusals, 1); /* of a hundred attempts */
    assert_int_equal(chatter, 2);  /* at first, and once while it was away */
    assert_int_equal(pulled, 0);   /* that is the incident's text */
}

static void pedals_of_a_lost_device_are_let_go(void **state)
{
    flaky_library *library = *state;
    wake signal;
    story told = {0};
    input *in =
        flaky_input(library, "", "rate=1000,pedal=1,run=0.02,away=0.005,losses=20,after=0.005");
    start(in, &signal);
    follow(in, &signal, &told, is_over);
    assert_int_equal(told.went, 20);
    assert_int_equal(told.came, 20);
    /* The device never lets go by itself, so that every press was let go by the host. (At the end
     * it goes before it would press.) */
    assert_true(told.pedal_edges >= 18 && told.pedal_edges <= 20);
    assert_false(told.pedal_down);
    input_destroy(in);
}

static void a_pedal_is_let_go_even_when_nobody_takes_samples(void **state)
{
    flaky_library *library = *state;
    wake signal;
    story told = {0};
    input *in = flaky_input(library, "", "rate=2000,pedal=1,run=0.8,away=100,losses=1");
    start(in, &signal);
    int64_t end_ns = clock_now_ns() + patience_ns;
    while (input_state_of(in) != INPUT_LOST) { /* 1600 samples into a ring of 1024 */
        uint32_t seen = wake_seen(&signal);
        assert_true(clock_now_ns() < end_ns);
        if (input_state_of(in) != INPUT_LOST)
            wake_wait_until_ns(&signal, seen, clock_now_ns() + 10 * NS_PER_MS);
    }
    assert_true(input_dropped(in) > 300);
    follow(in, &signal, &told, is_lost);
    end_ns = clock_now_ns() + patience_ns;
    while (told.pedal_down || told.samples < 1025) {
        assert_true(clock_now_ns() < end_ns);
        follow(in, &signal, &told, is_lost);
    }
    assert_int_equal(told.samples, 1025);
    input_destroy(in);
}

static void a_device_that_comes_back_with_other_channels_goes_on_with_those(void **state)
{
    static const struct {
        const char *back, *words;
        uint32_t count, hand;
    } cases[] = {{"fewer", "flaky glove: reconnected with 1 channels instead of 2", 1, MRT_RIGHT},
                 {"left",
                  "reconnected with channel 0 as \"thumb MPJ\" (left hand, \"rad\") instead of", 2,
                  MRT_LEFT}};
    flaky_library *library = *state;
    for (int i = 0; i < 2; ++i) {
        char params[96];
        wake signal;
        story told = {0};
        uint32_t count;
        snprintf(params, sizeof params, "rate=1000,run=0.01,away=0.01,losses=1,after=0.02,back=%s",
                 cases[i].back);
        (void)lines_with(library->log, "");
        input *in = flaky_input(library, "glove", params);
        start(in, &signal);
        follow(in, &signal, &told, is_over);
        assert_int_equal(told.went, 1);
        assert_int_equal(told.came, 1);
        assert_int_equal(input_version(in), 1); /* of the newest sample */
        assert_int_equal(input_channels_of(in, 0, &count)[0].hand, MRT_RIGHT);
        assert_int_equal(count, 2);
        assert_int_equal(input_channels(in, &count)[0].hand, cases[i].hand);
        assert_int_equal(count, cases[i].count);
        assert_int_equal(lines_with(library->log, cases[i].words), 1);
        input_destroy(in);
    }
}

static void a_device_that_opens_but_does_not_answer_is_not_back(void **state)
{
    flaky_library *library = *state;
    wake signal;
    story told = {0};
    health_report health = {.words = ""};
    (void)lines_with(library->log, "");
    input *in = flaky_input(library, "glove", "run=0.01,losses=1,lie=dead");
    start(in, &signal);
    follow(in, &signal, &told, is_lost);
    int64_t end_ns = clock_now_ns() + patience_ns;
    while (!strstr(health.words, "does not answer")) {
        assert_true(clock_now_ns() < end_ns);
        wake_wait_until_ns(&signal, wake_seen(&signal), clock_now_ns() + 20 * NS_PER_MS);
        input_health(in, &health);
    }
    follow(in, &signal, &told, is_lost);
    assert_int_equal(told.went, 1);
    assert_int_equal(told.came, 0);
    assert_int_equal(lines_with(library->log, "does not answer"), 1);
    input_destroy(in);
}

static void stopping_does_not_wait_for_a_device_that_takes_long_to_open(void **state)
{
    flaky_library *library = *state;
    wake signal;
    story told = {0};
    int files = file_count();
    input *in = flaky_input(library, "", "run=0.01,losses=1,open=100");
    start(in, &signal);
    follow(in, &signal, &told, is_lost);
    wake_wait_until_ns(&signal, wake_seen(&signal), clock_now_ns() + 50 * NS_PER_MS);
    (void)lines_with(library->log, "");
    int64_t before_ns = clock_now_ns();
    input_stop(in);
    int64_t took_ns = clock_now_ns() - before_ns;
    print_message("stopped within %.1f ms\n", (double)took_ns / 1e6);
    assert_true(took_ns < patience_ns); /* the device takes longer */
    assert_int_equal(input_state_of(in), INPUT_LOST);
    assert_int_equal(lines_with(library->log, "host is stopping"), 0); /* no news to anybody */
    input_destroy(in);
    assert_int_equal(file_count(), files);
}

static void a_device_that_is_not_there_at_first_is_an_error(void **state)
{
    flaky_library *library = *state;
    error err = {""};
    input *in = NULL;
    assert_int_equal(
        input_create(&in, library->type, "port:3", "fail=1", CLOCK_REAL, library->log, &err),
        MRT_ERR_IO);
    assert_null(in);
    assert_string_equal(err.text, "flaky port:3: no such device: plug it in");
}

static void on_a_virtual_clock_a_loss_is_the_end(void **state)
{
    flaky_library *library = *state;
    error err = {""};
    input *in = NULL;
    mrt_sample sample;
    uint32_t samples = 0;
    assert_int_equal(
        input_create(&in, library->type, "", "rate=100,run=0.1", CLOCK_VIRTUAL, library->log, &err),
        MRT_OK);
    (void)lines_with(library->log, "");
    for (; input_peek(in, &sample); input_pop(in))
        samples += 1;
    assert_int_equal(samples, 10);
    assert_int_equal(input_state_of(in), INPUT_FAILED);
    assert_int_equal(lines_with(library->log, "the cable was pulled"), 1);
    input_destroy(in);
}

static void a_plugin_that_asks_is_opened_again_and_may_have_other_channels(void **state)
{
    flaky_library *library = *state;
    wake signal;
    story told = {0};
    input *in = flaky_input(library, "",
                            "rate=1000,pedal=1,run=0.02,losses=1,restart=0.005,"
                            "after=0.02");
    uint32_t count;
    assert_int_equal(input_channels(in, &count)[0].hand, MRT_RIGHT);
    start(in, &signal);
    follow(in, &signal, &told, is_over);
    assert_int_equal(input_channels_of(in, 0, &count)[0].hand, MRT_RIGHT);
    assert_int_equal(input_channels(in, &count)[0].hand, MRT_LEFT);
    assert_int_equal(input_channels_of(in, 1, &count)[0].hand, MRT_LEFT);
    assert_int_equal(input_version(in), 1);
    assert_int_equal(told.went, 1); /* the restart is none; the loss is */
    assert_int_equal(told.came, 1);
    input_destroy(in);
    /* Without a thread of its own it is opened again between two reads. */
    error err = {""};
    mrt_sample sample;
    assert_int_equal(input_create(&in, library->type, "", "rate=100,restart=0.1", CLOCK_VIRTUAL,
                                  library->log, &err),
                     MRT_OK);
    for (uint32_t i = 0; i < 30; ++i, input_pop(in)) {
        assert_true(input_peek(in, &sample));
        assert_int_equal(input_version(in), i <= 10 ? 0 : 1);
    }
    input_destroy(in);
}

static void a_device_that_lies_is_refused_and_the_machine_stays_cool(void **state)
{
    static const char *const lies[] = {"nan", "future", "hasty", "silent"};
    flaky_library *library = *state;
    for (int i = 0; i < 4; ++i) {
        char params[64];
        wake signal;
        mrt_sample sample;
        struct timespec cpu_before, cpu_after;
        snprintf(params, sizeof params, "rate=1000,lie=%s", lies[i]);
        (void)lines_with(library->log, "");
        input *in = flaky_input(library, "", params);
        clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &cpu_before);
        start(in, &signal);
        int64_t begun_ns = clock_now_ns(), until_ns = begun_ns + 200 * NS_PER_MS;
        while (clock_now_ns() < until_ns)
            wake_wait_until_ns(&signal, wake_seen(&signal), until_ns);
        while (i < 2 && input_refused(in) <= 10 && clock_now_ns() < begun_ns + patience_ns)
            clock_sleep_until_ns(clock_now_ns() + 2 * NS_PER_MS);
        clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &cpu_after);
        double share = 1e9 / (double)(clock_now_ns() - begun_ns);
        assert_false(input_peek(in, &sample));
        assert_int_equal(input_state_of(in), INPUT_RUNNING);
        input_stop(in);
        assert_int_equal(lines_with(library->log, "away from now"), i == 1);
        if (i < 2)
            assert_true(input_refused(in) > 10);
        double cpu_s = (double)(cpu_after.tv_sec - cpu_before.tv_sec) +
                       (double)(cpu_after.tv_nsec - cpu_before.tv_nsec) / 1e9;
        print_message("%s: %.1f %% of a core\n", lies[i], 100.0 * cpu_s * share);
        assert_true(cpu_s * share < 0.5); /* a loop without a pause takes all of it */
        input_destroy(in);
    }
}

static void an_input_that_was_found_is_named_by_where_it_is(void **state)
{
    flaky_library *library = *state;
    input *found = flaky_input(library, "", "");
    input *named = flaky_input(library, "serial:/dev/ttyUSB3", "");
    assert_string_equal(input_name(found), "flaky port:1-2");
    assert_string_equal(input_name(named), "flaky ttyUSB3");
    input_destroy(found);
    input_destroy(named);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_lost_device_is_opened_again_and_says_so),
        cmocka_unit_test(what_repeats_while_it_is_away_is_said_once),
        cmocka_unit_test(pedals_of_a_lost_device_are_let_go),
        cmocka_unit_test(a_pedal_is_let_go_even_when_nobody_takes_samples),
        cmocka_unit_test(a_device_that_comes_back_with_other_channels_goes_on_with_those),
        cmocka_unit_test(a_device_that_opens_but_does_not_answer_is_not_back),
        cmocka_unit_test(stopping_does_not_wait_for_a_device_that_takes_long_to_open),
        cmocka_unit_test(a_device_that_is_not_there_at_first_is_an_error),
        cmocka_unit_test(on_a_virtual_clock_a_loss_is_the_end),
        cmocka_unit_test(a_plugin_that_asks_is_opened_again_and_may_have_other_channels),
        cmocka_unit_test(a_device_that_lies_is_refused_and_the_machine_stays_cool),
        cmocka_unit_test(an_input_that_was_found_is_named_by_where_it_is),
    };
    return cmocka_run_group_tests(tests, flaky_load, flaky_unload);
}
