/* The stage's input with the plugin org.marotte.midi: a control that moves for the first time as
 * the cable is pulled is a channel when the device is back. A pseudo terminal is the device. */
#define _XOPEN_SOURCE 700
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/clock.h"
#include "stage/input/input.h"
#include "stage/mapping/plugins.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Longer than anything here takes on a machine that is busy. */
static const int64_t patience_ns = 20 * NS_PER_S;

/* Our end of a device that is called `path`; there was none. */
static int plug_in(const char *path)
{
    const int device = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
    assert_true(device >= 0 && grantpt(device) == 0 && unlockpt(device) == 0);
    (void)unlink(path);
    assert_int_equal(symlink(ptsname(device), path), 0);
    return device;
}

/* Moves the controller until a sample of a table with it says so. */
static void move(int device, input *in, uint8_t number, const char *name)
{
    const int64_t end_ns = clock_now_ns() + patience_ns;
    uint8_t value = 1;
    for (bool is_found = false; !is_found; value = value < 127 ? value + 1 : 1) {
        const uint8_t bytes[] = {0xb0, number, value};
        mrt_sample sample;
        uint32_t count;
        (void)!write(device, bytes, sizeof bytes); /* nothing where it is not read */
        clock_sleep_until_ns(clock_now_ns() + 5 * NS_PER_MS);
        for (; input_peek(in, &sample); input_pop(in)) {
            const mrt_channel *channel = input_channels_of(in, input_version(in), &count);
            assert_int_equal(sample.count, count);
            for (uint32_t i = 0; i < count; ++i)
                is_found |= strcmp(channel[i].name, name) == 0 && sample.value[i] > 0.0f;
        }
        if (clock_now_ns() > end_ns)
            fail_msg("no sample with %s: the input is %s", name,
                     input_state_name(input_state_of(in)));
    }
}

static void await(const input *in, input_state state)
{
    const int64_t end_ns = clock_now_ns() + patience_ns;
    while (input_state_of(in) != state) {
        assert_true(clock_now_ns() < end_ns);
        clock_sleep_until_ns(clock_now_ns() + 5 * NS_PER_MS);
    }
}

static void a_control_that_moves_first_as_the_cable_is_pulled_is_there_again(void **state)
{
    (void)state;
    char folder[] = "/tmp/marotte_midi_XXXXXX", path[64], command[64];
    error err = {""};
    plugin_list list = {0};
    const mrt_plugin_type *type;
    input *in;
    assert_non_null(mkdtemp(folder));
    assert_int_equal(setenv("XDG_CONFIG_HOME", folder, 1), 0);
    (void)snprintf(path, sizeof path, "%s/device", folder);
    log_queue *log = log_queue_create();
    assert_int_equal(plugin_list_add(&list, BUILD_DIR "/plugins/midi.so", &err), MRT_OK);
    assert_int_equal(plugin_list_find(&list, "midi", MRT_INPUT, &type, &err), MRT_OK);
    int device = plug_in(path);
    assert_int_equal(input_create(&in, type, path, "", CLOCK_REAL, log, &err), MRT_OK);
    input_set_patience_ns(in, 5 * NS_PER_MS, 5 * NS_PER_MS);
    assert_int_equal(input_start(in, &err), MRT_OK);
    move(device, in, 7, "cc.7");
    const uint8_t bytes[] = {0xb0, 81, 64}; /* a new control takes 300 ms to become a channel */
    assert_int_equal(write(device, bytes, sizeof bytes), sizeof bytes);
    clock_sleep_until_ns(clock_now_ns() + 50 * NS_PER_MS); /* closed, a terminal forgets bytes */
    close(device);
    await(in, INPUT_LOST);
    device = plug_in(path);
    move(device, in, 7, "cc.7");
    assert_int_equal(input_state_of(in), INPUT_RUNNING);
    move(device, in, 81, "cc.81");
    input_destroy(in);
    close(device);
    plugin_list_destroy(&list);
    log_queue_destroy(log);
    (void)snprintf(command, sizeof command, "rm -rf '%s'", folder);
    assert_int_equal(system(command), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_control_that_moves_first_as_the_cable_is_pulled_is_there_again),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
