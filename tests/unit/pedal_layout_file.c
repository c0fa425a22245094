/* pedal/layouts.h: a layout comes back as it was written; what is not one is
 * refused with its line. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "layouts.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define FOLDER    BUILD_DIR "/tests/unit/pedal_layout.tmp"
#define FILE_PATH FOLDER "/marotte/pedals/1234_0001.layout"

static const layout TAUGHT = {
    .source = LAYOUT_OF_LEARNING,
    .vendor = 0x1234,
    .product = 0x0001,
    .name = "Fu\xc3\x9ftaster 2",
    .interface_number = 1,
    .endpoint = 0x83,
    .key_report_id = 1,
    .key_at = 3,
    .key_count = 5,
    .switch_count = 3,
    .switches = {{.name = "switch 1", .kind = LAYOUT_KEY, .key = {0x3a}},
                 {.name = "the middle one", .bit = 8191, .width = 1, .up = 1, .down = 0},
                 {.name = "3",
                  .report_id = 255,
                  .bit = 16,
                  .width = 32,
                  .is_signed = true,
                  .up = INT32_MIN,
                  .down = INT32_MAX}}};

static void assert_same(const layout *a, const layout *b)
{
    char left[LAYOUT_TEXT_BYTES], right[LAYOUT_TEXT_BYTES];
    layout_text_print(left, a);
    layout_text_print(right, b);
    assert_string_equal(left, right);
    assert_int_equal(a->source, b->source);
    assert_int_equal(a->switch_count, b->switch_count);
    for (uint32_t i = 0; i < a->switch_count; ++i) {
        assert_int_equal(a->switches[i].kind, b->switches[i].kind);
        assert_int_equal(a->switches[i].up, b->switches[i].up);
        assert_int_equal(a->switches[i].is_signed, b->switches[i].is_signed);
        assert_int_equal(a->switches[i].key[0], b->switches[i].key[0]);
    }
}

static void a_layout_survives_its_text(void **state)
{
    (void)state;
    char text[LAYOUT_TEXT_BYTES], reason[LAYOUT_TEXT_REASON] = "";
    layout back;
    size_t size = layout_text_print(text, &TAUGHT);
    assert_int_equal(size, strlen(text));
    assert_int_equal(layout_text_parse(&back, text, size, reason), MRT_OK);
    assert_same(&back, &TAUGHT);
}

#define HEAD "marotte pedal layout 1\ndevice 1234:0001 thing\ninterface any\nendpoint any\n"

static void refused(const char *text, const char *part)
{
    char reason[LAYOUT_TEXT_REASON] = "";
    layout out = {.vendor = 7};
    assert_int_equal(layout_text_parse(&out, text, strlen(text), reason), MRT_ERR_FORMAT);
    if (!strstr(reason, part))
        fail_msg("expected \"%s\" in \"%s\" for:\n%s", part, reason, text);
    assert_int_equal(out.vendor, 0);
}

static void comments_and_empty_lines_are_allowed(void **state)
{
    (void)state;
    char reason[LAYOUT_TEXT_REASON] = "";
    layout out;
    const char *text = "# mine\n\n" HEAD "# first\nfield 0 3 1 unsigned 0 1 left\n";
    assert_int_equal(layout_text_parse(&out, text, strlen(text), reason), MRT_OK);
    assert_int_equal(out.interface_number, LAYOUT_ANY);
    assert_int_equal(out.endpoint, 0);
    assert_string_equal(out.switches[0].name, "left");
    assert_int_equal(out.switches[0].bit, 3);
}

static void what_is_no_layout_is_refused_with_its_line(void **state)
{
    (void)state;
    refused("", "line is missing");
    refused("{}", "line 1: expected \"marotte pedal layout 1\"");
    refused("marotte pedal layout 2\n", "line 1");
    refused(HEAD, "no switches");
    refused("marotte pedal layout 1\nfield 0 0 1 unsigned 0 1 a\n", "line is missing");
    refused(HEAD "pedal 1\n", "line 5: expected device");
    refused(HEAD "device 1234:0001 again\n", "one line");
    refused(HEAD "interface 1\n", "one line");
    refused(HEAD "endpoint 0x81\n", "one line");
    refused("marotte pedal layout 1\ndevice 12345:001 thing\n", "line 2");
    refused("marotte pedal layout 1\ndevice 123g:0001 thing\n", "hex");
    refused("marotte pedal layout 1\ndevice 1234:0001\n", "name");
    refused("marotte pedal layout 1\ninterface 255\n", "interface");
    refused("marotte pedal layout 1\ninterface 1 2\n", "interface");
    refused("marotte pedal layout 1\nendpoint 0x01\n", "endpoint");
    refused("marotte pedal layout 1\nendpoint 129\n", "endpoint");
    refused(HEAD "field 0 0 0 unsigned 0 1 a\n", "field");
    refused(HEAD "field 0 0 33 unsigned 0 1 a\n", "field");
    refused(HEAD "field 0 8192 1 unsigned 0 1 a\n", "field");
    refused(HEAD "field 256 0 1 unsigned 0 1 a\n", "field");
    refused(HEAD "field -1 0 1 unsigned 0 1 a\n", "field");
    refused(HEAD "field 0 0 1 perhaps 0 1 a\n", "signed");
    refused(HEAD "field 0 0 1 unsigned 1 1 a\n", "different");
    refused(HEAD "field 0 0 1 unsigned 0 2147483648 a\n", "different");
    refused(HEAD "field 0 0 1 unsigned 0 99999999999999999999 a\n", "different");
    refused(HEAD "field 0 0 1 unsigned 0 1\n", "name");
    refused(HEAD "field 0 0 1 unsigned 0 1 a name of more than 23 bytes\n", "name");
    refused(HEAD "field 0 0 1\n", "signed");
    refused(HEAD "key 4 a\n", "keys line");
    refused(HEAD "keys 0 2 6\nfield 0 0 1 unsigned 0 1 a\n", "keys line");
    refused(HEAD "keys 0 2 0\n", "keys");
    refused(HEAD "keys 0 2 6\nkey 0 a\n", "key");
    refused(HEAD "key 0x4 a\n", "key");
    refused(HEAD "field\t0 0 1 unsigned 0 1 a\n", "control");
    refused(HEAD "field 0 0 1 unsigned 0 1 a\r\n", "control");
    refused(HEAD "field 0 0 1 unsigned 0 1 a\nfield 0 1 1 unsigned 0 1 b\nfield 0 2 1 unsigned 0 "
                 "1 c\nfield 0 3 1 unsigned 0 1 d\nfield 0 4 1 unsigned 0 1 e\n",
            "line 9: more than 4");
    char longest[400];
    memset(longest, 'a', sizeof longest);
    longest[sizeof longest - 1] = '\0';
    refused(longest, "longer than 159");
}

/* ---- the file ---- */

static int set_up(void **state)
{
    (void)state;
    setenv("XDG_CONFIG_HOME", FOLDER, 1);
    remove(FILE_PATH);
    return 0;
}

static int tear_down(void **state)
{
    remove(FILE_PATH);
    rmdir(FOLDER "/marotte/pedals");
    rmdir(FOLDER "/marotte");
    rmdir(FOLDER);
    (void)state;
    return 0;
}

static void write_file(const char *text)
{
    FILE *file = fopen(FILE_PATH, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(text, 1, strlen(text), file), strlen(text));
    assert_int_equal(fclose(file), 0);
}

static void what_is_stored_is_loaded(void **state)
{
    (void)state;
    char reason[LAYOUT_FILE_REASON] = "";
    layout back;
    assert_int_equal(layout_file_load(&back, 0x1234, 1, reason), MRT_END);
    if (layout_file_store(&TAUGHT, reason) < 0)
        fail_msg("%s", reason);
    assert_int_equal(layout_file_store(&TAUGHT, reason), MRT_OK); /* over the old one */
    assert_int_equal(layout_file_load(&back, 0x1234, 1, reason), MRT_OK);
    assert_same(&back, &TAUGHT);
    struct stat status;
    assert_int_equal(stat(FILE_PATH, &status), 0);
}

static void a_damaged_file_is_named_with_what_to_do(void **state)
{
    (void)state;
    char reason[LAYOUT_FILE_REASON] = "";
    layout back;
    assert_int_equal(layout_file_store(&TAUGHT, reason), MRT_OK);
    write_file(HEAD "nonsense\n");
    assert_int_equal(layout_file_load(&back, 0x1234, 1, reason), MRT_ERR_FORMAT);
    assert_non_null(strstr(reason, "1234_0001.layout: line 5"));
    assert_non_null(strstr(reason, "remove it"));
    write_file("marotte pedal layout 1\ndevice 1234:0002 b\ninterface any\nendpoint any\n"
               "field 0 0 1 unsigned 0 1 a\n");
    assert_int_equal(layout_file_load(&back, 0x1234, 1, reason), MRT_ERR_FORMAT);
    assert_non_null(strstr(reason, "is for device 1234:0002"));
    static char endless[LAYOUT_TEXT_BYTES + 2];
    memset(endless, '\n', sizeof endless - 1);
    write_file(endless);
    assert_int_equal(layout_file_load(&back, 0x1234, 1, reason), MRT_ERR_FORMAT);
    assert_non_null(strstr(reason, "longer than 4096"));
}

static void a_folder_or_a_pipe_in_its_place_holds_nobody_up(void **state)
{
    (void)state;
    char reason[LAYOUT_FILE_REASON] = "";
    layout back;
    assert_int_equal(layout_file_store(&TAUGHT, reason), MRT_OK);
    remove(FILE_PATH);
    assert_int_equal(mkfifo(FILE_PATH, 0600), 0);
    assert_int_equal(layout_file_load(&back, 0x1234, 1, reason), MRT_ERR_IO);
    remove(FILE_PATH);
    assert_int_equal(mkdir(FILE_PATH, 0700), 0);
    assert_int_equal(layout_file_load(&back, 0x1234, 1, reason), MRT_ERR_IO);
    assert_int_equal(layout_file_store(&TAUGHT, reason), MRT_ERR_IO);
    assert_non_null(strstr(reason, "cannot write"));
    rmdir(FILE_PATH);
}

static void without_a_home_there_is_nothing_to_load(void **state)
{
    (void)state;
    char reason[LAYOUT_FILE_REASON] = "", path[LAYOUT_FILE_PATH];
    layout back;
    char *home = getenv("HOME");
    char kept[512];
    snprintf(kept, sizeof kept, "%s", home ? home : "/");
    setenv("XDG_CONFIG_HOME", "relative", 1);
    setenv("HOME", "/nowhere", 1);
    assert_true(layout_file_path(path, 0x1234, 1));
    assert_string_equal(path, "/nowhere/.config/marotte/pedals/1234_0001.layout");
    unsetenv("HOME");
    assert_false(layout_file_path(path, 0x1234, 1));
    assert_int_equal(layout_file_load(&back, 0x1234, 1, reason), MRT_END);
    assert_int_equal(layout_file_store(&TAUGHT, reason), MRT_ERR_IO);
    setenv("HOME", kept, 1);
}

int main(void)
{
#define IN_FOLDER(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_layout_survives_its_text),
        cmocka_unit_test(comments_and_empty_lines_are_allowed),
        cmocka_unit_test(what_is_no_layout_is_refused_with_its_line),
        IN_FOLDER(what_is_stored_is_loaded),
        IN_FOLDER(a_damaged_file_is_named_with_what_to_do),
        IN_FOLDER(a_folder_or_a_pipe_in_its_place_holds_nobody_up),
        IN_FOLDER(without_a_home_there_is_nothing_to_load),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
