/* The input that `marotte plugin new` writes keeps the rules of read(): deadlines, order, an end.
 */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include <dlfcn.h>
#include <marotte/plugin.h>
#include <stdio.h>
#include <string.h>

static const int64_t MS = 1000000;

static const mrt_plugin_type *type;
static const mrt_input *input;

static int load_library(void **state)
{
    (void)state;
    void *library = dlopen(BUILD_DIR "/tests/plugin/input_template.so", RTLD_NOW);
    const mrt_plugin_type *const *types = library ? dlsym(library, "marotte_plugins") : NULL;
    if (!types) {
        fprintf(stderr, "%s\n", dlerror());
        return -1;
    }
    type = types[0];
    input = type->interfaces[0].functions;
    return 0;
}

/* ---- a host whose clock moves when it is waited for ---- */

typedef struct clock_host {
    mrt_host host;
    int64_t now_ns, furthest_wait_ns;
    bool is_stopping;
    char said[128];
} clock_host;

static void host_log(const mrt_host *host, int32_t level, const char *text)
{
    clock_host *self = host->data;
    assert_int_equal(level, MRT_LOG_ERROR);
    snprintf(self->said, sizeof self->said, "%s", text);
}

static int64_t host_now_ns(const mrt_host *host)
{
    const clock_host *self = host->data;
    return self->now_ns;
}

static int64_t host_wait_until_ns(const mrt_host *host, int64_t time_ns)
{
    clock_host *self = host->data;
    if (time_ns > self->furthest_wait_ns)
        self->furthest_wait_ns = time_ns;
    if (!self->is_stopping && time_ns > self->now_ns)
        self->now_ns = time_ns;
    return self->now_ns;
}

static mrt_plugin *opened(clock_host *out, const double *params)
{
    *out = (clock_host){.now_ns = 5000 * MS};
    out->host = (mrt_host){
        .data = out, .log = host_log, .now_ns = host_now_ns, .wait_until_ns = host_wait_until_ns};
    mrt_plugin *plugin = type->create(&out->host);
    assert_non_null(plugin);
    assert_int_equal(input->open(plugin, "", params), MRT_OK);
    return plugin;
}

static void closed(mrt_plugin *plugin)
{
    input->close(plugin);
    type->destroy(plugin);
}

static const double two_seconds_right[] = {2, MRT_RIGHT}, two_seconds_left[] = {2, MRT_LEFT};

/* ---- tests ---- */

static void samples_come_in_order_at_their_times_until_the_end(void **state)
{
    (void)state;
    clock_host host;
    mrt_plugin *plugin = opened(&host, two_seconds_right);
    mrt_sample sample;
    uint32_t count = 0;
    while (input->read(plugin, two_seconds_right, INT64_MAX, &sample) == MRT_OK) {
        assert_int_equal(sample.sequence, count);
        assert_int_equal(sample.time_ns, (5000 + 10 * (int64_t)count) * MS);
        assert_true(sample.time_ns <= host.now_ns);
        assert_int_equal(sample.count, 8);
        count += 1;
    }
    assert_int_equal(count, 201);
    assert_int_equal(input->read(plugin, two_seconds_right, INT64_MAX, &sample), MRT_END);
    closed(plugin);
}

static void no_wait_is_past_the_deadline(void **state)
{
    (void)state;
    clock_host host;
    mrt_plugin *plugin = opened(&host, two_seconds_right);
    mrt_sample sample;
    uint32_t given = 0, nothing = 0;
    mrt_result result = MRT_OK;
    while (result != MRT_END) {
        int64_t deadline_ns = host.now_ns + 3 * MS;
        host.furthest_wait_ns = 0;
        result = input->read(plugin, two_seconds_right, deadline_ns, &sample);
        assert_true(host.furthest_wait_ns <= deadline_ns);
        given += result == MRT_OK;
        nothing += result == MRT_TIMEOUT;
    }
    assert_int_equal(given, 201);
    assert_true(nothing > given);
    closed(plugin);
}

static void a_host_that_stops_is_given_nothing_and_nothing_is_lost(void **state)
{
    (void)state;
    clock_host host;
    mrt_plugin *plugin = opened(&host, two_seconds_right);
    mrt_sample sample;
    assert_int_equal(input->read(plugin, two_seconds_right, INT64_MAX, &sample), MRT_OK);
    host.is_stopping = true;
    assert_int_equal(input->read(plugin, two_seconds_right, INT64_MAX, &sample), MRT_TIMEOUT);
    host.is_stopping = false;
    assert_int_equal(input->read(plugin, two_seconds_right, INT64_MAX, &sample), MRT_OK);
    assert_int_equal(sample.sequence, 1);
    closed(plugin);
}

static void the_hand_closes_and_opens(void **state)
{
    (void)state;
    clock_host host;
    mrt_plugin *plugin = opened(&host, two_seconds_right);
    mrt_sample sample;
    for (int i = 0; i <= 200; ++i) {
        assert_int_equal(input->read(plugin, two_seconds_right, INT64_MAX, &sample), MRT_OK);
        if (i == 0 || i == 200)
            assert_float_equal(sample.value[0], 0.0f, 0.0f);
        if (i == 100)
            assert_float_equal(sample.value[0], 1.2f, 1e-6f); /* rad */
    }
    closed(plugin);
}

static void channels_are_joints_of_the_hand_that_was_asked_for(void **state)
{
    (void)state;
    static const uint32_t sensors[] = {4, 5, 7, 8, 11, 12, 15, 16};
    const double *const asked[] = {two_seconds_left, two_seconds_right};
    for (uint32_t hand = MRT_LEFT; hand <= MRT_RIGHT; ++hand) {
        clock_host host;
        uint32_t count = 0;
        mrt_plugin *plugin = opened(&host, asked[hand]);
        const mrt_channel *channel = input->channels(plugin, &count);
        assert_int_equal(count, 8);
        for (uint32_t i = 0; i < count; ++i) {
            assert_int_equal(channel[i].semantic, MRT_CH_ANGLE + sensors[i]);
            assert_int_equal(channel[i].hand, hand);
            assert_string_equal(channel[i].unit, "rad");
        }
        closed(plugin);
    }
}

static void opened_again_it_begins_again(void **state)
{
    (void)state;
    clock_host host;
    mrt_plugin *plugin = opened(&host, two_seconds_right);
    mrt_sample sample;
    for (int i = 0; i < 5; ++i)
        assert_int_equal(input->read(plugin, two_seconds_right, INT64_MAX, &sample), MRT_OK);
    input->close(plugin);
    assert_int_equal(input->open(plugin, "", two_seconds_right), MRT_OK);
    assert_int_equal(input->read(plugin, two_seconds_right, INT64_MAX, &sample), MRT_OK);
    assert_int_equal(sample.sequence, 0);
    assert_int_equal(sample.time_ns, host.now_ns);
    closed(plugin);
}

static void an_address_is_refused_with_a_word(void **state)
{
    (void)state;
    clock_host host;
    mrt_plugin *plugin = opened(&host, two_seconds_right);
    assert_int_equal(input->open(plugin, "/dev/ttyUSB0", two_seconds_right), MRT_ERR_ARGUMENT);
    assert_non_null(strstr(host.said, "takes no address"));
    closed(plugin);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(samples_come_in_order_at_their_times_until_the_end),
        cmocka_unit_test(no_wait_is_past_the_deadline),
        cmocka_unit_test(a_host_that_stops_is_given_nothing_and_nothing_is_lost),
        cmocka_unit_test(the_hand_closes_and_opens),
        cmocka_unit_test(channels_are_joints_of_the_hand_that_was_asked_for),
        cmocka_unit_test(opened_again_it_begins_again),
        cmocka_unit_test(an_address_is_refused_with_a_word),
    };
    return cmocka_run_group_tests(tests, load_library, NULL);
}
