/* plugins/cyberglove/glove_find.h and glove_drive.h in a /sys and /dev of the test's own: which
 * ports there are, and that a glove is found again where it is plugged in. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "device_io.h"
#include "glove_drive.h"
#include "glove_talker.h"

#include <errno.h>
#include <sys/stat.h>

enum { PATH_LENGTH = 256, FULL_LENGTH = 512 };

typedef struct tree {
    char root[64];
    mrt_host host;
    glove_drive drive;
    glove_memory memory;
    talker talker[2];
    int talker_count;
    virtual_device device;
} tree;

/* ---- folders ---- */

static void make_folders(const char *path)
{
    char part[FULL_LENGTH];
    snprintf(part, sizeof part, "%s", path);
    for (char *slash = strchr(part + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
        *slash = '\0';
        assert_true(mkdir(part, 0755) == 0 || errno == EEXIST);
        *slash = '/';
    }
}

static void make_link(const tree *t, const char *path, const char *target)
{
    char from[FULL_LENGTH], to[FULL_LENGTH];
    snprintf(from, sizeof from, "%s%s", t->root, path);
    snprintf(to, sizeof to, "%s%s", target[0] == '@' ? "" : t->root,
             target[0] == '@' ? target + 1 : target);
    make_folders(from);
    assert_int_equal(symlink(to, from), 0);
}

static void make_file(const tree *t, const char *path, const char *text)
{
    char full[FULL_LENGTH];
    snprintf(full, sizeof full, "%s%s", t->root, path);
    make_folders(full);
    FILE *file = fopen(full, "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
}

static void unlink_in(const tree *t, const char *path)
{
    char full[FULL_LENGTH];
    snprintf(full, sizeof full, "%s%s", t->root, path);
    assert_int_equal(unlink(full), 0);
}

/* An adapter at USB port `port`, as ttyUSB<number>, whose node is `node`. */
static void plug_in(const tree *t, const char *port, int number, const char *node)
{
    char path[PATH_LENGTH], target[PATH_LENGTH];
    snprintf(path, sizeof path, "/sys/devices/usb1/%s/%s:1.0/ttyUSB%d/port_number", port, port,
             number);
    make_file(t, path, "0\n");
    snprintf(path, sizeof path, "/sys/devices/usb1/%s/product", port);
    make_file(t, path, "FT232R USB UART\n");
    snprintf(path, sizeof path, "/sys/devices/usb1/%s/idVendor", port);
    make_file(t, path, "0403\n");
    snprintf(path, sizeof path, "/sys/class/tty/ttyUSB%d/device", number);
    snprintf(target, sizeof target, "/sys/devices/usb1/%s/%s:1.0/ttyUSB%d", port, port, number);
    make_link(t, path, target);
    snprintf(path, sizeof path, "/dev/ttyUSB%d", number);
    snprintf(target, sizeof target, "@%s", node);
    make_link(t, path, target);
}

static void pull_out(const tree *t, int number)
{
    char path[PATH_LENGTH];
    snprintf(path, sizeof path, "/sys/class/tty/ttyUSB%d/device", number);
    unlink_in(t, path);
    snprintf(path, sizeof path, "%s/sys/class/tty/ttyUSB%d", t->root, number);
    assert_int_equal(rmdir(path), 0);
    snprintf(path, sizeof path, "/dev/ttyUSB%d", number);
    unlink_in(t, path);
}

/* ---- a host ---- */

static void host_log(const mrt_host *host, int32_t level, const char *text)
{
    (void)host;
    (void)level;
    (void)text;
}

static int64_t host_now_ns(const mrt_host *host)
{
    (void)host;
    return device_clock_ns();
}

static int64_t host_wait_until_ns(const mrt_host *host, int64_t time_ns)
{
    (void)host;
    const struct timespec until = {(time_t)(time_ns / 1000000000), (long)(time_ns % 1000000000)};
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, NULL);
    return device_clock_ns();
}

/* The talkers, as the virtual clock calls them. */
static int64_t tree_due_ns(void *data)
{
    const tree *t = data;
    int64_t due_ns = INT64_MAX;
    for (int i = 0; i < t->talker_count; ++i)
        due_ns = device_earlier_ns(due_ns, talker_due_ns(&t->talker[i]));
    return due_ns;
}

static void tree_run(void *data, int64_t now_ns)
{
    tree *t = data;
    for (int i = 0; i < t->talker_count; ++i)
        talker_run(&t->talker[i], now_ns);
}

static void tree_written(void *data, int64_t now_ns, int file, size_t size)
{
    tree *t = data;
    for (int i = 0; i < t->talker_count; ++i)
        talker_written(&t->talker[i], now_ns, file, size);
}

static int set_up(void **state)
{
    tree *t = calloc(1, sizeof *t);
    assert_non_null(t);
    snprintf(t->root, sizeof t->root, "/tmp/glove_find.XXXXXX");
    assert_non_null(mkdtemp(t->root));
    t->device = (virtual_device){tree_due_ns, tree_run, tree_written, t};
    virtual_clock_take(&t->device, 1000000000000);
    t->host = (mrt_host){t, host_log, host_now_ns, host_wait_until_ns, NULL, NULL};
    t->drive = (glove_drive){.host = &t->host, .port = {.file = -1}, .trace = {.file = -1}};
    t->drive.settings = (glove_settings){.baud = 115200, .rate_hz = 150, .patience = 0.1};
    *state = t;
    return 0;
}

static int tear_down(void **state)
{
    tree *t = *state;
    char command[128];
    glove_drive_end(&t->drive);
    for (int i = 0; i < t->talker_count; ++i)
        talker_stop(&t->talker[i]);
    snprintf(command, sizeof command, "rm -rf -- '%s'", t->root);
    int removed = system(command);
    virtual_clock_give_back();
    free(t);
    return removed;
}

static const char *talk(tree *t, talker how)
{
    talker *self = &t->talker[t->talker_count++];
    *self = how;
    talker_start(self);
    return self->path;
}

/* ---- looking ---- */

static void ports_are_found_with_place_and_name(void **state)
{
    tree *t = *state;
    glove_found found[4];
    assert_int_equal(glove_find_ports(t->root, found, 4), 0);
    plug_in(t, "1-1.4", 3, "/dev/null");
    make_file(t, "/sys/class/tty/ttyS0/uevent", "");
    assert_int_equal(glove_find_ports(t->root, found, 4), 1);
    assert_string_equal(found[0].usb_path, "1-1.4:1.0/0");
    assert_string_equal(found[0].product, "FT232R USB UART");
    assert_string_equal(found[0].link, "");
    assert_string_equal(found[0].path + strlen(t->root), "/dev/ttyUSB3");
    char address[192];
    glove_drive_address(&found[0], address, sizeof address);
    assert_string_equal(address, "usb:1-1.4:1.0/0");
    make_link(t, "/dev/serial/by-path/pci-usb-0:1.4:1.0-port0", "/dev/ttyUSB3");
    assert_int_equal(glove_find_ports(t->root, found, 4), 1);
    assert_non_null(strstr(found[0].link, "/by-path/pci-usb-0:1.4:1.0-port0"));
}

static void likelier_ports_come_first(void **state)
{
    tree *t = *state;
    plug_in(t, "1-1", 0, "/dev/null");
    plug_in(t, "1-2", 1, "/dev/null");
    plug_in(t, "1-3", 2, "/dev/null");
    make_file(t, "/sys/devices/usb1/1-1/idVendor", "2341\n");
    make_file(t, "/sys/devices/usb1/1-3/product", "Wired CyberGlove\n");
    make_file(t, "/sys/devices/usb1/1-3/manufacturer", "CyberGlove Systems\n");
    glove_found found[4];
    assert_int_equal(glove_find_ports(t->root, found, 4), 3);
    assert_string_equal(found[0].usb_path, "1-3:1.0/0");
    assert_string_equal(found[1].usb_path, "1-2:1.0/0");
    assert_int_equal(glove_find_ports(t->root, found, 2), 2);
}

static void who_has_a_file_open_is_found(void **state)
{
    tree *t = *state;
    char path[PATH_LENGTH], holder[96];
    make_file(t, "/held", "");
    snprintf(path, sizeof path, "%s/held", t->root);
    assert_false(glove_find_holder(path, holder, sizeof holder));
    int file = open(path, O_RDONLY);
    assert_true(file >= 0);
    assert_true(glove_find_holder(path, holder, sizeof holder));
    assert_non_null(strstr(holder, "marotte itself"));
    assert_false(glove_find_other_holder(path, file, holder, sizeof holder));
    close(file);
}

static void advice_names_the_group_or_the_command(void **state)
{
    tree *t = *state;
    char path[PATH_LENGTH], advice[384];
    make_file(t, "/port", "");
    snprintf(path, sizeof path, "%s/port", t->root);
    glove_find_advice(path, advice, sizeof advice);
    assert_non_null(strstr(advice, "chmod"));
    if (geteuid() != 0)
        return;
    assert_int_equal(chown(path, 0, 20), 0); /* dialout, on Debian */
    assert_int_equal(chmod(path, 0660), 0);
    glove_find_advice(path, advice, sizeof advice);
    assert_non_null(strstr(advice, "usermod -aG"));
}

/* ---- opening ---- */

static mrt_result open_any(tree *t, glove_error *why)
{
    return glove_drive_open(&t->drive, "", t->root, &t->memory, why);
}

static void nothing_plugged_in_is_said(void **state)
{
    tree *t = *state;
    glove_error why;
    assert_int_equal(open_any(t, &why), MRT_ERR_IO);
    assert_non_null(strstr(why.text, "no USB serial port"));
}

/* The pty's other end is held by this very process, so a port counts as held: what is not named
 * must not be asked. */
static void a_port_that_is_held_is_not_asked(void **state)
{
    tree *t = *state;
    glove_error why;
    plug_in(t, "1-1", 0, talk(t, (talker){.sensors = 22}));
    assert_int_equal(open_any(t, &why), MRT_ERR_IO);
    assert_non_null(strstr(why.text, "in use by marotte itself"));
}

static void let_go(talker *self)
{
    close(self->slave);
    self->slave = -1;
}

static void the_first_port_with_a_glove_is_found(void **state)
{
    tree *t = *state;
    glove_error why = {""};
    plug_in(t, "1-1", 0, talk(t, (talker){.habit = TALKER_OTHER_DEVICE}));
    plug_in(t, "1-2", 1, talk(t, (talker){.sensors = 18, .is_left = true}));
    let_go(&t->talker[0]);
    let_go(&t->talker[1]);
    if (open_any(t, &why) < 0)
        fail_msg("%s", why.text);
    assert_string_equal(t->memory.port.usb_path, "1-2:1.0/0");
    assert_int_equal(t->drive.unit.sensors.count, 18);
}

static void the_hand_that_is_wished_decides(void **state)
{
    tree *t = *state;
    glove_error why = {""};
    plug_in(t, "1-1", 0, talk(t, (talker){.sensors = 22}));
    plug_in(t, "1-2", 1, talk(t, (talker){.sensors = 22, .is_left = true}));
    let_go(&t->talker[0]);
    let_go(&t->talker[1]);
    t->drive.settings.hand = GLOVE_HAND_LEFT;
    if (open_any(t, &why) < 0)
        fail_msg("%s", why.text);
    assert_string_equal(t->memory.port.usb_path, "1-2:1.0/0");
}

static void a_glove_is_found_again_where_it_is_plugged_in(void **state)
{
    tree *t = *state;
    glove_error why = {""};
    plug_in(t, "1-2", 0, talk(t, (talker){.sensors = 18}));
    let_go(&t->talker[0]);
    assert_int_equal(open_any(t, &why), MRT_OK);
    glove_drive_end(&t->drive);
    pull_out(t, 0);
    plug_in(t, "1-1", 0, talk(t, (talker){.sensors = 22})); /* another glove, its old name */
    assert_int_equal(open_any(t, &why), MRT_ERR_IO);
    assert_non_null(strstr(why.text, "1-2:1.0/0"));
    plug_in(t, "1-2", 5, t->talker[0].path);
    if (open_any(t, &why) < 0)
        fail_msg("%s", why.text);
    assert_int_equal(t->drive.unit.sensors.count, 18);
    assert_non_null(strstr(t->memory.port.path, "ttyUSB5"));
}

static void a_named_port_that_comes_back_under_another_name_is_found(void **state)
{
    tree *t = *state;
    glove_error why = {""};
    char address[PATH_LENGTH];
    plug_in(t, "1-2", 0, talk(t, (talker){.sensors = 18}));
    let_go(&t->talker[0]);
    snprintf(address, sizeof address, "serial:%s/dev/ttyUSB0", t->root);
    assert_int_equal(glove_drive_open(&t->drive, address, t->root, &t->memory, &why), MRT_OK);
    glove_drive_end(&t->drive);
    pull_out(t, 0);
    plug_in(t, "1-2", 1, t->talker[0].path);
    if (glove_drive_open(&t->drive, address, t->root, &t->memory, &why) < 0)
        fail_msg("%s", why.text);
    assert_non_null(strstr(t->memory.port.path, "ttyUSB1"));
}

static void a_place_is_an_address(void **state)
{
    tree *t = *state;
    glove_error why = {""};
    plug_in(t, "1-2", 0, talk(t, (talker){.sensors = 22}));
    assert_int_equal(glove_drive_open(&t->drive, "usb:1-3:1.0/0", t->root, &t->memory, &why),
                     MRT_ERR_IO);
    if (glove_drive_open(&t->drive, "usb:1-2:1.0/0", t->root, &t->memory, &why) < 0)
        fail_msg("%s", why.text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
        TEST(ports_are_found_with_place_and_name),
        TEST(likelier_ports_come_first),
        TEST(who_has_a_file_open_is_found),
        TEST(advice_names_the_group_or_the_command),
        TEST(nothing_plugged_in_is_said),
        TEST(a_port_that_is_held_is_not_asked),
        TEST(the_first_port_with_a_glove_is_found),
        TEST(the_hand_that_is_wished_decides),
        TEST(a_glove_is_found_again_where_it_is_plugged_in),
        TEST(a_named_port_that_comes_back_under_another_name_is_found),
        TEST(a_place_is_an_address),
#undef TEST
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
