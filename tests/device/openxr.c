/* The plugin org.marotte.openxr with a runtime (openxr_runtime.c) that does what runtimes and their
 * drivers do: nobody who reads notices, but by a sentence. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "input_host.h"
#include "stage/mapping/services.h"

#include <math.h>

static const int64_t ms_ns = 1000000, s_ns = 1000000000;
static const int64_t patience_ns = 60000000000; /* of a machine with other work */
enum { INDEX_MPJ = 4, MIDDLE_MPJ = 7 };

static services_reader reader;

static void read_landmarks(const mrt_host *host, const mrt_landmarks *seen, mrt_hand_reading *out)
{
    (void)host;
    services_read_landmarks(&reader, seen, out);
}
static const mrt_landmark_reader landmarks = {read_landmarks};

/* Those of the test that runs: the process with the runtime in it is one for all of them, so none
 * may outlive its test, whatever happens. */
static input_host *open_host[2];

static input_host *create_host(void)
{
    const int slot = open_host[0] ? 1 : 0;
    assert_null(open_host[slot]);
    return open_host[slot] = input_host_create(BUILD_DIR "/plugins/openxr.so");
}

static void destroy_host(input_host *self)
{
    open_host[self == open_host[0] ? 0 : 1] = NULL;
    input_host_destroy(self);
}

static int begin_test(void **state)
{
    (void)state;
    return setenv("MAROTTE_OPENXR_HANDS", BUILD_DIR "/marotte-openxr-hands", 1) != 0 ||
           setenv("XR_RUNTIME_JSON", BUILD_DIR "/tests/device/openxr_runtime.json", 1) != 0;
}

static int end_test(void **state)
{
    (void)state;
    for (int i = 0; i < 2; ++i)
        if (open_host[i])
            destroy_host(open_host[i]);
    return 0;
}

static input_host *begin(const char *mode)
{
    assert_int_equal(setenv("MAROTTE_TEST_OPENXR", mode, 1), 0);
    input_host *self = create_host();
    assert_int_equal(input_host_open(self, ""), MRT_OK);
    return self;
}

/* How much older the frame is than the sample says, from -0.5 to 0.5 s: the frame tells its time
 * by two fingers. Neither depends on when anything ran. */
static int64_t age_ns(const mrt_sample *sample)
{
    const double sine = ((double)sample->value[INDEX_MPJ] - 0.6) / 0.4;
    const double cosine = ((double)sample->value[MIDDLE_MPJ] - 0.6) / 0.4;
    assert_float_equal(sqrt(sine * sine + cosine * cosine), 1.0, 0.1); /* of one frame, both */
    const double frame_s = atan2(sine, cosine) / 6.283185307179586;
    const double sample_s = (double)((sample->time_ns - input_host_epoch_ns) % s_ns) / 1e9;
    return (int64_t)(1e9 * (sample_s - frame_s - round(sample_s - frame_s)));
}

/* A frame is up to 17 ms old, and its fingers are read to 10 ms. */
static bool is_of_then(const mrt_sample *sample)
{
    return age_ns(sample) > -15 * ms_ns && age_ns(sample) < 40 * ms_ns;
}

static void expect_sound(input_host *self, const mrt_sample *sample, int64_t *last_ns)
{
    assert_true(sample->time_ns > *last_ns);
    assert_true(sample->time_ns <= input_host_now_ns(&self->host));
    *last_ns = sample->time_ns;
    for (uint32_t i = 0; i < sample->count; ++i)
        assert_true(isfinite(sample->value[i]));
    assert_float_equal(sample->value[8], 0.2, 0.03);
}

/* Waits for so many samples that are the hand as it was at their time. Until one has come here
 * without delay nobody can tell that time; after it only a machine that stands still may miss. */
static void expect_hand(input_host *self, int wanted)
{
    const int64_t until_ns = input_host_now_ns(&self->host) + patience_ns;
    int64_t last_ns = 0;
    int right = 0, wrong = 0;
    while (right < wanted) {
        mrt_sample sample;
        mrt_result result = input_host_read(self, 20 * ms_ns, &sample);
        assert_true(result == MRT_OK || result == MRT_TIMEOUT);
        if (input_host_now_ns(&self->host) > until_ns)
            fail_msg("%d of %d samples are the hand of their time, %d are not", right, wanted,
                     wrong);
        if (result != MRT_OK)
            continue;
        expect_sound(self, &sample, &last_ns);
        const bool is_right = is_of_then(&sample);
        right += is_right;
        wrong += right > 0 && !is_right;
    }
    assert_true(wrong <= wanted / 10);
}

static int count_samples(input_host *self, int64_t span_ns)
{
    const int64_t until_ns = input_host_now_ns(&self->host) + span_ns;
    int count = 0;
    while (input_host_now_ns(&self->host) < until_ns) {
        mrt_sample sample;
        mrt_result result = input_host_read(self, 20 * ms_ns, &sample);
        assert_true(result == MRT_OK || result == MRT_TIMEOUT);
        count += result == MRT_OK;
    }
    return count;
}

static void await_hand(input_host *self)
{
    const int64_t until_ns = input_host_now_ns(&self->host) + patience_ns;
    mrt_sample sample;
    while (input_host_read(self, 20 * ms_ns, &sample) != MRT_OK)
        assert_true(input_host_now_ns(&self->host) < until_ns);
}

static void await_text(input_host *self, const char *text)
{
    const int64_t until_ns = input_host_now_ns(&self->host) + patience_ns;
    mrt_sample sample;
    while (!strstr(self->last_text, text)) {
        assert_true(input_host_read(self, 20 * ms_ns, &sample) >= 0);
        if (input_host_now_ns(&self->host) > until_ns)
            fail_msg("\"%s\" instead of \"%s\"", self->last_text, text);
    }
}

static void a_hand_arrives_once_a_frame(void **state)
{
    (void)state;
    input_host *self = begin("good");
    await_hand(self);
    expect_hand(self, 100);
    const int64_t began_ns = input_host_now_ns(&self->host);
    const int count = count_samples(self, s_ns);
    const int64_t span_ns = input_host_now_ns(&self->host) - began_ns;
    /* 60 a second, though 200 are asked for; the first may have waited already. */
    assert_in_range(count, 1, 60 * span_ns / s_ns + 18);
    assert_string_equal(self->last_text,
                        "hands come from the OpenXR runtime \"marotte's?[31m double\"");
    assert_int_equal(self->said[MRT_LOG_WARNING] + self->said[MRT_LOG_ERROR], 0);
    destroy_host(self);
}

static void two_hands_are_two_inputs_of_one_process(void **state)
{
    (void)state;
    input_host *left = begin("good");
    input_host *right = create_host();
    uint32_t count;
    input_host_set(left, "hand", MRT_LEFT);
    input_host_set(right, "hand", MRT_RIGHT);
    assert_int_equal(input_host_open(left, ""), MRT_OK);
    assert_int_equal(input_host_open(right, ""), MRT_OK);
    assert_int_equal(left->input->channels(left->plugin, &count)[0].hand, MRT_LEFT);
    assert_int_equal(right->input->channels(right->plugin, &count)[0].hand, MRT_RIGHT);
    await_hand(left);
    await_hand(right);
    left->input->close(left->plugin);
    expect_hand(right, 20);
    destroy_host(right);
    destroy_host(left);
}

static void what_is_damaged_is_left_out(void **state)
{
    (void)state;
    static const char *const mode[] = {"nan", "back", "no_clock", "far"};
    for (int i = 0; i < 4; ++i) {
        input_host *self = begin(mode[i]);
        await_hand(self);
        expect_hand(self, 40);
        assert_int_equal(self->said[MRT_LOG_WARNING] + self->said[MRT_LOG_ERROR], 0);
        destroy_host(self);
    }
}

static void a_hand_that_is_not_there_gives_nothing(void **state)
{
    (void)state;
    static const char *const mode[] = {"inactive", "untracked"};
    for (int i = 0; i < 2; ++i) {
        input_host *self = begin(mode[i]);
        await_text(self, "hands come from");
        assert_int_equal(count_samples(self, s_ns), 0);
        assert_int_equal(self->said[MRT_LOG_WARNING] + self->said[MRT_LOG_ERROR], 0);
        destroy_host(self);
    }
    input_host *frozen = begin("freeze");
    await_hand(frozen);
    for (int i = 0; i < 60 && count_samples(frozen, s_ns) > 0; ++i) {
    }
    assert_int_equal(count_samples(frozen, 2500 * ms_ns), 0); /* and is no runtime that hangs */
    assert_int_equal(frozen->said[MRT_LOG_WARNING], 0);
    destroy_host(frozen);
}

static void a_runtime_that_fails_is_started_again(void **state)
{
    (void)state;
    static const struct {
        const char *mode, *text;
    } row[] = {{"loss", "ended the session"},
               {"crash", "crashed (Segmentation fault)"},
               {"end", "(code 7)"},
               {"hang", "hangs"}};
    for (int i = 0; i < 4; ++i) {
        input_host *self = begin(row[i].mode);
        await_hand(self);
        await_text(self, row[i].text);
        await_hand(self); /* back */
        expect_hand(self, 6);
        assert_int_equal(self->said[MRT_LOG_WARNING], 1);
        assert_int_equal(self->said[MRT_LOG_ERROR], 0);
        destroy_host(self);
    }
}

static void what_is_missing_is_said_once(void **state)
{
    (void)state;
    static const struct {
        const char *mode, *text;
    } row[] = {{"no_hands", "tracks no hands"},
               {"no_headless", "lacks XR_MND_headless"},
               {"no_headset", "has no headset yet"}};
    for (int i = 0; i < 3; ++i) {
        input_host *self = begin(row[i].mode);
        await_text(self, row[i].text);
        assert_int_equal(count_samples(self, 1200 * ms_ns), 0); /* two more tries */
        assert_int_equal(self->said[MRT_LOG_WARNING], 1);
        destroy_host(self);
    }
    const char *manifest = getenv("XR_RUNTIME_JSON");
    assert_int_equal(setenv("XR_RUNTIME_JSON", "/nowhere.json", 1), 0);
    input_host *self = begin("good");
    mrt_device device;
    assert_int_equal(self->devices->list(self->plugin, &device, 1), 0);
    await_text(self, "no active OpenXR runtime");
    assert_int_equal(setenv("XR_RUNTIME_JSON", manifest, 1), 0);
    await_hand(self); /* it was started meanwhile */
    assert_int_equal(self->devices->list(self->plugin, &device, 1), 1);
    destroy_host(self);
}

static void what_is_no_helper_is_refused(void **state)
{
    (void)state;
    static const char variable[] = "MAROTTE_OPENXR_HANDS";
    input_host *self = create_host();
    assert_int_equal(input_host_open(self, "elsewhere"), MRT_ERR_ARGUMENT);
    assert_int_equal(setenv(variable, "/nowhere", 1), 0);
    assert_int_equal(input_host_open(self, ""), MRT_ERR_IO);
    assert_non_null(strstr(self->last_text, "libopenxr-dev"));
    assert_int_equal(setenv(variable, "/bin/true", 1), 0); /* ends at once, says nothing */
    assert_int_equal(input_host_open(self, ""), MRT_OK);
    await_text(self, "(code 0)");
    destroy_host(self);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_hand_arrives_once_a_frame, begin_test, end_test),
        cmocka_unit_test_setup_teardown(two_hands_are_two_inputs_of_one_process, begin_test,
                                        end_test),
        cmocka_unit_test_setup_teardown(what_is_damaged_is_left_out, begin_test, end_test),
        cmocka_unit_test_setup_teardown(a_hand_that_is_not_there_gives_nothing, begin_test,
                                        end_test),
        cmocka_unit_test_setup_teardown(a_runtime_that_fails_is_started_again, begin_test,
                                        end_test),
        cmocka_unit_test_setup_teardown(what_is_missing_is_said_once, begin_test, end_test),
        cmocka_unit_test_setup_teardown(what_is_no_helper_is_refused, begin_test, end_test),
    };
    if (!services_reader_init(&reader))
        return 1;
    input_host_landmarks = &landmarks;
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    services_reader_finish(&reader);
    return failed;
}
