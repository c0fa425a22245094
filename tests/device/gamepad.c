/* The plugin org.marotte.gamepad with pads that libumockdev makes of /sys, /dev/input and what a
 * driver answers. (/dev/uinput would do too, and is on few machines that run tests.) */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "input_host.h"
#include "pedal_double.h" /* how to get into the mock environment */

#include <errno.h>
#include <fcntl.h>
#include <linux/input.h>
#include <math.h>
#include <stdarg.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <umockdev.h>
#include <unistd.h>

static const int64_t ms_ns = 1000000, s_ns = 1000000000;

/* ---- the double ---- */

typedef struct fake_pad {
    UMockdevTestbed *testbed;
    UMockdevIoctlBase *handler;
    char node[32], file[320], folder[96];
    int fifo;
    struct input_absinfo axis[ABS_CNT]; /* read by umockdev's thread while nobody writes */
    uint8_t key[KEY_CNT / 8];
} fake_pad;

static void copy_out(UMockdevIoctlClient *client, const void *bytes, size_t size)
{
    UMockdevIoctlData *out =
        umockdev_ioctl_data_resolve(umockdev_ioctl_client_get_arg(client), 0, size, NULL);
    assert_non_null(out);
    umockdev_ioctl_data_update(out, 0, (guint8 *)(uintptr_t)bytes, (gint)size);
    umockdev_ioctl_data_unref(out);
}

static gboolean answer(UMockdevIoctlBase *handler, UMockdevIoctlClient *client, gpointer data)
{
    (void)handler;
    fake_pad *pad = data;
    const gulong request = umockdev_ioctl_client_get_request(client);
    const size_t size = _IOC_SIZE(request), number = _IOC_NR(request);
    if (request == EVIOCSCLOCKID) {
        umockdev_ioctl_client_complete(client, 0, 0);
    } else if (number >= 0x40 && number < 0x40 + ABS_CNT) {
        copy_out(client, &pad->axis[number - 0x40], size);
        umockdev_ioctl_client_complete(client, 0, 0);
    } else if (number == 0x18) {
        copy_out(client, pad->key, size < sizeof pad->key ? size : sizeof pad->key);
        umockdev_ioctl_client_complete(client, (glong)size, 0);
    } else {
        umockdev_ioctl_client_complete(client, -1, ENOTTY);
    }
    return TRUE;
}

static const uint16_t xbox_keys[] = {BTN_SOUTH,  BTN_EAST,  BTN_X,    BTN_Y,      BTN_TL,    BTN_TR,
                                     BTN_SELECT, BTN_START, BTN_MODE, BTN_THUMBL, BTN_THUMBR};

/* An Xbox pad, as xpad has it: sticks of 16 bits, triggers of 10 on Z and RZ, the cross as a hat.
 */
static fake_pad *plug_xbox(UMockdevTestbed *testbed, uint32_t number, const char *place)
{
    fake_pad *pad = calloc(1, sizeof *pad);
    char *root = umockdev_testbed_get_root_dir(testbed);
    char keys[256] = "", stanza[2048];
    GError *error = NULL;
    uint64_t word[KEY_CNT / 64] = {0};
    for (size_t i = 0; i < sizeof xbox_keys / sizeof *xbox_keys; ++i)
        word[xbox_keys[i] / 64] |= UINT64_C(1) << xbox_keys[i] % 64;
    for (int i = BTN_MODE / 64; i >= 0; --i)
        snprintf(keys + strlen(keys), sizeof keys - strlen(keys), "%llx%s",
                 (unsigned long long)word[i], i > 0 ? " " : "");
    pad->testbed = testbed;
    for (int i = ABS_X; i <= ABS_RZ; ++i)
        pad->axis[i] = i == ABS_Z || i == ABS_RZ
                           ? (struct input_absinfo){.maximum = 1023}
                           : (struct input_absinfo){.minimum = -32768, .maximum = 32767};
    pad->axis[ABS_HAT0X] = pad->axis[ABS_HAT0Y] =
        (struct input_absinfo){.minimum = -1, .maximum = 1};
    snprintf(pad->folder, sizeof pad->folder, "/devices/pad%u", number);
    snprintf(pad->node, sizeof pad->node, "/dev/input/event%u", number);
    snprintf(pad->file, sizeof pad->file, "%s%s", root, pad->node);
    g_free(root);
    snprintf(stanza, sizeof stanza,
             "P: %s\nE: SUBSYSTEM=input\nA: name=Microsoft X-Box 360 pad\\n\nA: phys=%s\\n\nA: "
             "uniq=\\n\n"
             "A: id/vendor=045e\\n\nA: capabilities/key=%s\\n\nA: capabilities/abs=3003f\\n\n\n"
             "P: %s/event%u\nN: input/event%u\nE: SUBSYSTEM=input\nE: DEVNAME=%s\nL: device=..\n\n",
             pad->folder, place, keys, pad->folder, number, number, pad->node);
    pad->handler = umockdev_ioctl_base_new();
    g_signal_connect(pad->handler, "handle-ioctl", G_CALLBACK(answer), pad);
    if (!umockdev_testbed_attach_ioctl(testbed, pad->node, pad->handler, &error) ||
        !umockdev_testbed_add_from_string(testbed, stanza, &error)) {
        fprintf(stderr, "%s\n", error->message);
        abort();
    }
    /* events come through a pipe; the system is asked itself, umockdev stands before the library */
    unlink(pad->file);
    assert_int_equal(mkfifo(pad->file, 0666), 0);
    pad->fifo = (int)syscall(SYS_openat, AT_FDCWD, pad->file, O_RDWR | O_NONBLOCK | O_CLOEXEC);
    assert_true(pad->fifo >= 0);
    return pad;
}

static void unplug(fake_pad *pad)
{
    char path[160];
    umockdev_testbed_detach_ioctl(pad->testbed, pad->node, NULL);
    snprintf(path, sizeof path, "/sys%s/%s", pad->folder, strrchr(pad->node, '/') + 1);
    umockdev_testbed_remove_device(pad->testbed, path);
    snprintf(path, sizeof path, "/sys%s", pad->folder);
    umockdev_testbed_remove_device(pad->testbed, path);
    unlink(pad->file);
    (void)syscall(SYS_close, pad->fifo);
    g_object_unref(pad->handler);
    free(pad);
}

static void put_event(fake_pad *pad, uint16_t type, uint16_t code, int32_t value)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    struct input_event event = {.type = type, .code = code, .value = value};
    event.input_event_sec = now.tv_sec;
    event.input_event_usec = now.tv_nsec / 1000;
    assert_int_equal(syscall(SYS_write, pad->fifo, &event, sizeof event), sizeof event);
}

static void report(fake_pad *pad)
{
    put_event(pad, EV_SYN, SYN_REPORT, 0);
}

/* ---- a room ---- */

typedef struct room {
    UMockdevTestbed *testbed;
    input_host *host;
    mrt_sample last;
} room;

static int set_up(void **state)
{
    room *r = calloc(1, sizeof *r);
    r->testbed = umockdev_testbed_new();
    r->host = input_host_create(BUILD_DIR "/plugins/gamepad.so");
    *state = r;
    return 0;
}

static int tear_down(void **state)
{
    room *r = *state;
    input_host_destroy(r->host);
    g_object_unref(r->testbed);
    free(r);
    return 0;
}

static float value_of(input_host *host, const mrt_sample *sample, const char *name)
{
    int channel = input_host_channel(host, name);
    if (channel < 0)
        fail_msg("there is no channel %s", name);
    return sample->value[channel];
}

static float value(room *r, const char *name)
{
    return value_of(r->host, &r->last, name);
}

static mrt_result read_one(room *r, int64_t within_ns)
{
    return input_host_read(r->host, within_ns, &r->last);
}

static void a_pad_has_sticks_triggers_and_buttons(void **state)
{
    room *r = *state;
    fake_pad *pad = plug_xbox(r->testbed, 5, "usb-0000:00:14.0-2/input0");
    uint32_t count;
    pad->axis[ABS_RX].value = 32767; /* held as it is opened */
    pad->key[BTN_SOUTH / 8] |= 1u << BTN_SOUTH % 8;
    assert_int_equal(input_host_open(r->host, ""), MRT_OK);
    const mrt_channel *channel = r->host->input->channels(r->host->plugin, &count);
    assert_int_equal(count, 19);
    assert_int_equal(channel[input_host_channel(r->host, "south")].semantic, MRT_CH_BUTTON);
    assert_int_equal(read_one(r, s_ns), MRT_OK);
    assert_float_equal(value(r, "right.x"), 1, 1e-4f);
    assert_float_equal(value(r, "south"), 1, 0);
    assert_float_equal(value(r, "left.x"), 0, 0);
    int64_t before_ns = input_host_now_ns(NULL);
    put_event(pad, EV_ABS, ABS_Y, -32768); /* up */
    put_event(pad, EV_ABS, ABS_Z, 1023);
    put_event(pad, EV_ABS, ABS_HAT0Y, -1);
    put_event(pad, EV_KEY, BTN_X, 1);
    assert_int_equal(read_one(r, 20 * ms_ns), MRT_TIMEOUT); /* not whole yet */
    report(pad);
    assert_int_equal(read_one(r, s_ns), MRT_OK);
    assert_float_equal(value(r, "left.y"), 1, 1e-4f);
    assert_float_equal(value(r, "left.trigger"), 1, 0);
    assert_float_equal(value(r, "right.trigger"), 0, 0);
    assert_float_equal(value(r, "cross.y"), 1, 0);
    assert_float_equal(value(r, "west"), 1, 0); /* X of an Xbox */
    assert_float_equal(value(r, "north"), 0, 0);
    assert_true(r->last.time_ns >= before_ns && r->last.time_ns <= input_host_now_ns(NULL));
    unplug(pad);
}

static void a_stick_rests_within_its_dead_zone(void **state)
{
    room *r = *state;
    fake_pad *pad = plug_xbox(r->testbed, 5, "here");
    input_host_set(r->host, "dead", 20);
    assert_int_equal(input_host_open(r->host, "1"), MRT_OK);
    assert_int_equal(read_one(r, s_ns), MRT_OK);
    float before = 0;
    for (int x = 0; x <= 32767; x += 151) {
        put_event(pad, EV_ABS, ABS_X, x);
        report(pad);
        assert_int_equal(read_one(r, s_ns), MRT_OK);
        float now = value(r, "left.x");
        assert_true(x >= 6553 || now == 0);
        assert_true(now >= before && now - before < 0.01f); /* no jump at its edge */
        before = now;
    }
    assert_true(before > 0.99f);
    put_event(pad, EV_ABS, ABS_X, 2000000000); /* nonsense of a broken pad */
    put_event(pad, EV_ABS, ABS_Y, -2000000000);
    put_event(pad, EV_ABS, 0x7fff, 1);
    put_event(pad, EV_KEY, 0x7fff, 1);
    put_event(pad, 0x7fff, 0x7fff, 1);
    report(pad);
    assert_int_equal(read_one(r, s_ns), MRT_OK);
    for (uint32_t i = 0; i < r->last.count; ++i)
        assert_true(r->last.value[i] >= -1 && r->last.value[i] <= 1);
    unplug(pad);
}

static void two_pads_are_two_inputs(void **state)
{
    room *r = *state;
    fake_pad *first = plug_xbox(r->testbed, 5, "usb-1/input0");
    fake_pad *second = plug_xbox(r->testbed, 12, "usb-2/input0");
    input_host *other = input_host_create(BUILD_DIR "/plugins/gamepad.so");
    mrt_sample of_other;
    mrt_device found[4];
    assert_int_equal(r->host->devices->list(r->host->plugin, found, 4), 2);
    assert_string_equal(found[0].address, "usb-1.input0");
    assert_string_equal(found[1].address, "usb-2.input0");
    assert_int_equal(found[0].state, MRT_DEVICE_READY);
    assert_int_equal(input_host_open(r->host, ""), MRT_OK);
    assert_int_equal(input_host_open(other, "2"), MRT_OK);
    assert_int_equal(read_one(r, s_ns), MRT_OK);
    assert_int_equal(input_host_read(other, s_ns, &of_other), MRT_OK);
    put_event(first, EV_KEY, BTN_SOUTH, 1);
    report(first);
    put_event(second, EV_KEY, BTN_EAST, 1);
    report(second);
    assert_int_equal(read_one(r, s_ns), MRT_OK);
    assert_int_equal(input_host_read(other, s_ns, &of_other), MRT_OK);
    assert_float_equal(value(r, "south"), 1, 0);
    assert_float_equal(value(r, "east"), 0, 0);
    assert_float_equal(value_of(other, &of_other, "east"), 1, 0);
    assert_float_equal(value_of(other, &of_other, "south"), 0, 0);
    input_host_destroy(other);
    unplug(first);
    unplug(second);
}

/* Pulled out with a button down, and plugged in again as another event: the same place. */
static void a_pad_that_goes_is_found_again_where_it_was(void **state)
{
    room *r = *state;
    fake_pad *first = plug_xbox(r->testbed, 5, "usb-1/input0");
    fake_pad *second = plug_xbox(r->testbed, 6, "usb-2/input0");
    assert_int_equal(input_host_open(r->host, "2"), MRT_OK);
    assert_int_equal(read_one(r, s_ns), MRT_OK);
    put_event(second, EV_KEY, BTN_SOUTH, 1);
    put_event(second, EV_ABS, ABS_X, 32767);
    report(second);
    assert_int_equal(read_one(r, s_ns), MRT_OK);
    unplug(second);
    assert_int_equal(read_one(r, s_ns), MRT_OK);
    assert_float_equal(value(r, "south"), 0, 0);
    assert_float_equal(value(r, "left.x"), 1, 1e-4f); /* held */
    assert_int_equal(read_one(r, s_ns), MRT_ERR_IO);
    assert_int_equal(read_one(r, s_ns), MRT_ERR_IO);
    assert_int_equal(r->host->said[MRT_LOG_ERROR], 1);
    r->host->input->close(r->host->plugin);
    assert_int_equal(input_host_open(r->host, "2"), MRT_ERR_IO);
    unplug(first);
    fake_pad *third = plug_xbox(r->testbed, 7, "usb-3/input0");
    second = plug_xbox(r->testbed, 9, "usb-2/input0");
    assert_int_equal(input_host_open(r->host, "2"), MRT_OK);
    mrt_device current;
    assert_true(r->host->devices->current(r->host->plugin, &current));
    assert_string_equal(current.address, "usb-2.input0");
    unplug(second);
    unplug(third);
}

static void events_that_the_system_dropped_are_made_up_for(void **state)
{
    room *r = *state;
    fake_pad *pad = plug_xbox(r->testbed, 5, "here");
    assert_int_equal(input_host_open(r->host, ""), MRT_OK);
    assert_int_equal(read_one(r, s_ns), MRT_OK);
    pad->key[BTN_EAST / 8] |= 1u << BTN_EAST % 8;
    put_event(pad, EV_SYN, SYN_DROPPED, 0);
    put_event(pad, EV_KEY, BTN_SOUTH, 1); /* of a report whose beginning is lost */
    report(pad);
    assert_int_equal(read_one(r, s_ns), MRT_OK);
    assert_float_equal(value(r, "east"), 1, 0);
    assert_float_equal(value(r, "south"), 0, 0);
    unplug(pad);
}

/* 1 000 reports a second of a wired pad, in bunches; a clock that goes back. */
static void every_report_is_a_sample_in_order(void **state)
{
    room *r = *state;
    fake_pad *pad = plug_xbox(r->testbed, 5, "here");
    input_host_set(r->host, "dead", 0);
    assert_int_equal(input_host_open(r->host, ""), MRT_OK);
    assert_int_equal(read_one(r, s_ns), MRT_OK);
    uint32_t sequence = r->last.sequence;
    int64_t last_ns = r->last.time_ns;
    for (int i = 0; i < 1000; ++i) {
        for (int k = 0; k < 10; ++k) {
            put_event(pad, EV_ABS, ABS_X, 10 * i + k);
            report(pad);
        }
        if (i == 500) { /* time goes back: a report of the year 1970 */
            struct input_event old = {.type = EV_SYN, .code = SYN_REPORT};
            (void)!syscall(SYS_write, pad->fifo, &old, sizeof old);
        }
        for (int k = 0; k < 10 + (i == 500); ++k) {
            assert_int_equal(read_one(r, s_ns), MRT_OK);
            assert_int_equal(r->last.sequence, ++sequence);
            assert_true(r->last.time_ns >= last_ns);
            last_ns = r->last.time_ns;
        }
        assert_float_equal(value(r, "left.x"), (float)(10 * i + 9 + 32768) / 65535 * 2 - 1, 1e-4f);
    }
    unplug(pad);
}

static void no_pad_is_said_calmly(void **state)
{
    room *r = *state;
    mrt_device none[1];
    assert_int_equal(r->host->devices->list(r->host->plugin, none, 1), 0);
    static const char *const absent[] = {"", "1", "7", "/nowhere", "usb-9.input0", "-1", "x"};
    for (size_t i = 0; i < sizeof absent / sizeof *absent; ++i) {
        assert_int_equal(input_host_open(r->host, absent[i]), MRT_ERR_IO);
        assert_int_equal(r->host->said[MRT_LOG_ERROR], i + 1);
        assert_non_null(strstr(r->host->last_text, "plug"));
    }
}

/* ---- a performance ---- */

static int marotte(const char *format, ...)
{
    char words[1024], command[1400];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(words, sizeof words, format, arguments);
    va_end(arguments);
    (void)snprintf(command, sizeof command, "exec '%s/marotte' %s >/dev/null 2>&1", BUILD_DIR,
                   words);
    return system(command);
}

static void write_patch(const char *folder, const char *name, const char *most)
{
    char path[128];
    (void)snprintf(path, sizeof path, "%s/%s.json", folder, name);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file,
            "{\"marotte_patch\": 1, \"name\": \"test\", \"connections\": [{\"from\": "
            "{\"input\": \"gamepad\", \"channel\": \"left.y\"}, \"to\": {\"dof\": "
            "\"jaw.open\"}, \"out\": [0, %s]}]}\n",
            most);
    assert_int_equal(fclose(file), 0);
}

static bool is_same_file(const char *folder, const char *a, const char *b)
{
    char command[256];
    (void)snprintf(command, sizeof command, "cmp -s %s/%s %s/%s", folder, a, folder, b);
    return system(command) == 0;
}

static void a_take_of_a_pad_performs_again_and_its_patch_is_changed_afterwards(void **state)
{
    room *r = *state;
    char folder[] = "/tmp/marotte_gamepad_XXXXXX", command[128];
    fake_pad *pad = plug_xbox(r->testbed, 5, "usb-0000:00:14.0-2/input0");
    assert_non_null(mkdtemp(folder));
    write_patch(folder, "full", "0.5");
    write_patch(folder, "half", "0.25");
    pid_t performing = fork();
    assert_true(performing >= 0);
    if (performing == 0)
        _exit(marotte("perform --face moai --seconds 1 --input gamepad --map anchored --patch "
                      "%s/full.json --record %s/pad.marotte",
                      folder, folder) != 0);
    int status = -1;
    for (int i = 0; waitpid(performing, &status, WNOHANG) == 0; ++i) { /* however long it takes */
        put_event(pad, EV_ABS, ABS_Y, (int32_t)(30000 * sin(0.3 * i)));
        report(pad);
        (void)usleep(20000);
        uint8_t unread[4096]; /* what nobody reads yet */
        if (i % 100 == 99)
            (void)!syscall(SYS_read, pad->fifo, unread, sizeof unread);
    }
    assert_int_equal(status, 0);
    assert_int_equal(marotte("take export %s/pad.marotte last --export %s/1.pc2", folder, folder),
                     0);
    assert_int_equal(marotte("take export %s/pad.marotte last --export %s/2.pc2", folder, folder),
                     0);
    assert_true(is_same_file(folder, "1.pc2", "2.pc2"));
    assert_int_equal(marotte("take remap %s/pad.marotte last --patch %s/half.json", folder, folder),
                     0);
    assert_int_equal(marotte("take export %s/pad.marotte last --export %s/3.pc2", folder, folder),
                     0);
    assert_false(is_same_file(folder, "1.pc2", "3.pc2"));
    unplug(pad);
    (void)snprintf(command, sizeof command, "rm -r %s", folder);
    assert_int_equal(system(command), 0);
}

#define ROOM_TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(int count, char **arguments)
{
    (void)count;
    int entered = pedal_double_enter(arguments);
    if (entered != 0)
        return entered;
    const struct CMUnitTest tests[] = {
        ROOM_TEST(a_pad_has_sticks_triggers_and_buttons),
        ROOM_TEST(a_stick_rests_within_its_dead_zone),
        ROOM_TEST(a_take_of_a_pad_performs_again_and_its_patch_is_changed_afterwards),
        ROOM_TEST(two_pads_are_two_inputs),
        ROOM_TEST(a_pad_that_goes_is_found_again_where_it_was),
        ROOM_TEST(events_that_the_system_dropped_are_made_up_for),
        ROOM_TEST(every_report_is_a_sample_in_order),
        ROOM_TEST(no_pad_is_said_calmly),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
