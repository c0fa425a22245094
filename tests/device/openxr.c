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
enum { INDEX_MPJ = 4 };

static services_reader reader;

static void read_landmarks(const mrt_host *host, const mrt_landmarks *seen, mrt_hand_reading *out)
{
    (void)host;
    services_read_landmarks(&reader, seen, out);
}
static const mrt_landmark_reader landmarks = {read_landmarks};

static input_host *begin(const char *mode)
{
    assert_int_equal(setenv("MAROTTE_TEST_OPENXR", mode, 1), 0);
    input_host *self = input_host_create(BUILD_DIR "/plugins/openxr.so");
    assert_int_equal(input_host_open(self, ""), MRT_OK);
    return self;
}

/* Each sample is later than the one before, finite, and the hand as it was then. */
static void expect_hand_of_then(const mrt_sample *sample, int64_t *last_ns)
{
    assert_true(sample->time_ns > *last_ns);
    *last_ns = sample->time_ns;
    double then_s = (double)((sample->time_ns - input_host_epoch_ns) % s_ns) / 1e9;
    float expected = (float)(0.6 + 0.4 * sin(6.283185307179586 * then_s));
    /* A frame is up to 17 ms old, in which the finger moves 0.042. */
    assert_float_equal(sample->value[INDEX_MPJ], expected, 0.1);
    assert_float_equal(sample->value[7], 0.3, 0.03);
    for (uint32_t i = 0; i < sample->count; ++i)
        assert_true(isfinite(sample->value[i]));
}

/* How many samples in that time; each is as it should be, and no read is later than it may. */
static int watch(input_host *self, int64_t span_ns)
{
    int64_t until_ns = input_host_now_ns(&self->host) + span_ns, last_ns = 0;
    int count = 0;
    while (input_host_now_ns(&self->host) < until_ns) {
        mrt_sample sample;
        mrt_result result = input_host_read(self, 20 * ms_ns, &sample);
        assert_true(result == MRT_OK || result == MRT_TIMEOUT);
        if (result == MRT_OK) {
            expect_hand_of_then(&sample, &last_ns);
            ++count;
        }
    }
    return count;
}

/* Until it has given a sample: runtimes take their time to start. */
static void await_hand(input_host *self)
{
    int64_t until_ns = input_host_now_ns(&self->host) + 20 * s_ns;
    mrt_sample sample;
    while (input_host_read(self, 20 * ms_ns, &sample) != MRT_OK)
        assert_true(input_host_now_ns(&self->host) < until_ns);
}

static void await_text(input_host *self, int64_t within_ns, const char *text)
{
    int64_t until_ns = input_host_now_ns(&self->host) + within_ns;
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
    int count = watch(self, 2 * s_ns);
    assert_in_range(count, 40, 122); /* 60 a second, though 200 are asked for */
    assert_string_equal(self->last_text,
                        "hands come from the OpenXR runtime \"marotte's?[31m double\"");
    assert_int_equal(self->said[MRT_LOG_WARNING] + self->said[MRT_LOG_ERROR], 0);
    input_host_destroy(self);
}

static void two_hands_are_two_inputs_of_one_process(void **state)
{
    (void)state;
    input_host *left = begin("good");
    input_host *right = input_host_create(BUILD_DIR "/plugins/openxr.so");
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
    assert_true(watch(right, s_ns) > 20);
    input_host_destroy(right);
    input_host_destroy(left);
}

static void what_is_damaged_is_left_out(void **state)
{
    (void)state;
    static const char *const mode[] = {"nan", "back", "no_clock"};
    for (int i = 0; i < 3; ++i) {
        input_host *self = begin(mode[i]);
        await_hand(self);
        assert_true(watch(self, 1500 * ms_ns) > 20);
        assert_int_equal(self->said[MRT_LOG_WARNING] + self->said[MRT_LOG_ERROR], 0);
        input_host_destroy(self);
    }
}

static void a_hand_that_is_not_there_gives_nothing(void **state)
{
    (void)state;
    static const char *const mode[] = {"inactive", "untracked"};
    for (int i = 0; i < 2; ++i) {
        input_host *self = begin(mode[i]);
        await_text(self, 20 * s_ns, "hands come from");
        assert_int_equal(watch(self, s_ns), 0);
        assert_int_equal(self->said[MRT_LOG_WARNING] + self->said[MRT_LOG_ERROR], 0);
        input_host_destroy(self);
    }
    input_host *frozen = begin("freeze");
    await_hand(frozen);
    (void)watch(frozen, s_ns);
    assert_int_equal(watch(frozen, 2500 * ms_ns), 0); /* and is no runtime that hangs */
    assert_int_equal(frozen->said[MRT_LOG_WARNING], 0);
    input_host_destroy(frozen);
}

static void a_runtime_that_fails_is_started_again(void **state)
{
    (void)state;
    static const struct {
        const char *mode, *text;
    } row[] = {{"loss", "has ended the session"},
               {"crash", "has crashed (Segmentation fault)"},
               {"end", "(code 7)"},
               {"hang", "hangs"}};
    for (int i = 0; i < 4; ++i) {
        input_host *self = begin(row[i].mode);
        await_hand(self);
        await_text(self, 10 * s_ns, row[i].text);
        await_hand(self); /* back */
        assert_true(watch(self, 300 * ms_ns) > 5);
        assert_int_equal(self->said[MRT_LOG_WARNING], 1);
        assert_int_equal(self->said[MRT_LOG_ERROR], 0);
        input_host_destroy(self);
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
        await_text(self, 10 * s_ns, row[i].text);
        assert_int_equal(watch(self, 1200 * ms_ns), 0); /* two more tries */
        assert_int_equal(self->said[MRT_LOG_WARNING], 1);
        input_host_destroy(self);
    }
    const char *manifest = getenv("XR_RUNTIME_JSON");
    assert_int_equal(setenv("XR_RUNTIME_JSON", "/nowhere.json", 1), 0);
    input_host *self = begin("good");
    mrt_device device;
    assert_int_equal(self->devices->list(self->plugin, &device, 1), 0);
    await_text(self, 10 * s_ns, "no OpenXR runtime is active");
    assert_int_equal(setenv("XR_RUNTIME_JSON", manifest, 1), 0);
    await_hand(self); /* it was started meanwhile */
    assert_int_equal(self->devices->list(self->plugin, &device, 1), 1);
    input_host_destroy(self);
}

static void what_is_no_helper_is_refused(void **state)
{
    (void)state;
    static const char variable[] = "MAROTTE_OPENXR_HANDS";
    input_host *self = input_host_create(BUILD_DIR "/plugins/openxr.so");
    assert_int_equal(input_host_open(self, "elsewhere"), MRT_ERR_ARGUMENT);
    assert_int_equal(setenv(variable, "/nowhere", 1), 0);
    assert_int_equal(input_host_open(self, ""), MRT_ERR_IO);
    assert_non_null(strstr(self->last_text, "libopenxr-dev"));
    assert_int_equal(setenv(variable, "/bin/true", 1), 0); /* ends at once, says nothing */
    assert_int_equal(input_host_open(self, ""), MRT_OK);
    await_text(self, 10 * s_ns, "(code 0)");
    assert_int_equal(setenv(variable, BUILD_DIR "/marotte-openxr-hands", 1), 0);
    input_host_destroy(self);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_hand_arrives_once_a_frame),
        cmocka_unit_test(two_hands_are_two_inputs_of_one_process),
        cmocka_unit_test(what_is_damaged_is_left_out),
        cmocka_unit_test(a_hand_that_is_not_there_gives_nothing),
        cmocka_unit_test(a_runtime_that_fails_is_started_again),
        cmocka_unit_test(what_is_missing_is_said_once),
        cmocka_unit_test(what_is_no_helper_is_refused),
    };
    if (!services_reader_init(&reader))
        return 1;
    input_host_landmarks = &landmarks;
    (void)setenv("MAROTTE_OPENXR_HANDS", BUILD_DIR "/marotte-openxr-hands", 1);
    (void)setenv("XR_RUNTIME_JSON", BUILD_DIR "/tests/device/openxr_runtime.json", 1);
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    services_reader_finish(&reader);
    return failed;
}
