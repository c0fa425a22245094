/* ui/window/app/presets.h: values of parameters under a name. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "window/app/presets.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const off_on[] = {"Off", "On", NULL};
static const mrt_param params[] = {
    {1, 0, "Gain", "Jaw", "", "", 0, 4, 1, NULL},
    {2, 0, "Gain", "Brows", "", "", 0, 4, 1, NULL},
    {3, MRT_PARAM_STEPPED, "Palm", "Points", "", "", 0, 1, 0, off_on},
    {4, MRT_PARAM_TRIGGER, "Engage", "Clutch", "", "", 0, 1, 0, NULL},
    {5, 0, "Dead zone", "Jaw", "deg", "", -10, 10, 0, NULL},
};
enum { COUNT = sizeof params / sizeof params[0] };

static mrt_plugin *make(const mrt_host *host)
{
    return (mrt_plugin *)(uintptr_t)host;
}

static void unmake(mrt_plugin *self)
{
    (void)self;
}

static const mrt_plugin_type type = {.abi = MRT_ABI,
                                     .param_count = COUNT,
                                     .params = params,
                                     .id = "org.example.wave",
                                     .name = "Wave",
                                     .create = make,
                                     .destroy = unmake};

typedef struct bench {
    instance mapping;
    settings *settings;
} bench;

static void set_up(bench *b)
{
    error err = {""};
    char note[256];
    assert_int_equal(instance_create(&b->mapping, &type, CLOCK_REAL, NULL, &err), MRT_OK);
    assert_int_equal(settings_open(&b->settings, "", note, sizeof note, &err), MRT_OK);
}

static void tear_down(bench *b)
{
    instance_destroy(&b->mapping);
    settings_close(b->settings);
}

/* ---- what was taught ---- */

static void a_preset_has_values_and_what_was_taught(void **state)
{
    (void)state;
    bench b;
    static const unsigned char taught[] = {0x00, 0x7f, 0xff, ',', '='};
    unsigned char *found;
    size_t size;
    double values[COUNT];
    error err = {""};
    set_up(&b);
    char *text = presets_make(&b.mapping, taught, sizeof taught);
    assert_string_equal(text, "taught:007fff2c3d");
    assert_true(presets_has_values(text, ""));
    free(text);
    instance_set_value(&b.mapping, 1, 2.5);
    text = presets_make(&b.mapping, taught, sizeof taught);
    assert_string_equal(text, "brows.gain=2.5,taught:007fff2c3d");
    assert_true(presets_has_values(text, "brows.gain=2.5"));
    assert_false(presets_has_values(text, "brows.gain=2"));
    assert_false(presets_has_values(text, ""));
    presets_values(&type, text, values, &err);
    assert_string_equal(err.text, "");
    assert_float_equal(values[1], 2.5, 0.0);
    assert_int_equal(presets_taught(text, &found, &size, &err), MRT_OK);
    assert_int_equal(size, sizeof taught);
    assert_memory_equal(found, taught, size);
    free(found);
    free(text);
    text = presets_make(&b.mapping, NULL, 0); /* of a mapping that cannot be taught */
    assert_string_equal(text, "brows.gain=2.5");
    assert_int_equal(presets_taught(text, &found, &size, &err), MRT_OK);
    assert_null(found);
    free(text);
    tear_down(&b);
}

static void damaged_lessons_are_refused_and_values_stay(void **state)
{
    (void)state;
    static const char *const odd[] = {"taught:",           "taught:0",   "taught:zz",
                                      "taught:00 1",       "taught:0g",  "taught:00,palm=1",
                                      "taught:00\xff\xfe", "taught:AB00"};
    size_t size, length = strlen("palm=1,taught:");
    double values[COUNT];
    for (size_t i = 0; i <= sizeof odd / sizeof odd[0]; ++i) {
        unsigned char *found = NULL;
        error err = {""};
        char *text = calloc(1, length + 2 * PRESET_TAUGHT_MAX + 64);
        assert_non_null(text);
        (void)sprintf(text, "palm=1,%s", i < sizeof odd / sizeof odd[0] ? odd[i] : "taught:");
        if (i == sizeof odd / sizeof odd[0]) /* longer than any */
            memset(text + length, '0', 2 * PRESET_TAUGHT_MAX + 2);
        assert_true(presets_taught(text, &found, &size, &err) < 0);
        assert_null(found);
        assert_non_null(strstr(err.text, "damaged"));
        presets_values(&type, text, values, &err);
        assert_float_equal(values[2], 1.0, 0.0);
        free(text);
    }
}

static void a_text_names_what_is_changed_alone(void **state)
{
    (void)state;
    bench b;
    char text[PRESET_TEXT];
    set_up(&b);
    presets_text(&b.mapping, text, sizeof text);
    assert_string_equal(text, "");
    instance_set_value(&b.mapping, 1, 2.5);
    instance_set_value(&b.mapping, 2, 1);
    instance_set_value(&b.mapping, 4, -3.25);
    instance_trigger(&b.mapping, 3);
    presets_text(&b.mapping, text, sizeof text);
    assert_string_equal(text, "brows.gain=2.5,palm=1,dead_zone=-3.25");
    char small[20];
    presets_text(&b.mapping, small, sizeof small);
    assert_string_equal(small, "brows.gain=2.5");
    tear_down(&b);
}

static void a_text_gives_its_values_and_initial_ones_for_the_rest(void **state)
{
    (void)state;
    double values[COUNT];
    error note = {""};
    presets_values(&type, "brows.gain=2.5,palm=1", values, &note);
    assert_string_equal(note.text, "");
    static const double expected[COUNT] = {1, 2.5, 1, 0, 0};
    for (int i = 0; i < COUNT; ++i)
        assert_float_equal(values[i], expected[i], 1e-12);
    presets_values(&type, "", values, &note);
    assert_float_equal(values[1], 1.0, 1e-12);
}

static void what_no_longer_fits_is_noted_and_left_out(void **state)
{
    (void)state;
    static const char *const odd[] = {
        "gone=3,palm=1",   "dead_zone=99,palm=1",  "palm=1,=,",
        "engage=1,palm=1", "palm=1,dead_zone=nan", "palm=1,dead_zone"};
    for (size_t i = 0; i < sizeof odd / sizeof odd[0]; ++i) {
        double values[COUNT];
        error note = {""};
        presets_values(&type, odd[i], values, &note);
        assert_true(note.text[0]);
        assert_float_equal(values[2], 1.0, 1e-12);
        assert_float_equal(values[3], 0.0, 1e-12);
        assert_float_equal(values[4], 0.0, 1e-12);
    }
}

/* As the mapping panel does; a name that is none is not kept. */
static void save(bench *b, const char *name)
{
    char key[PRESET_KEY], text[PRESET_TEXT], clean[PRESET_NAME];
    if (!presets_clean_name(clean, name))
        return;
    presets_text(&b->mapping, text, sizeof text);
    presets_key(key, &type, clean);
    settings_set_text(b->settings, key, text);
}

static void presets_are_kept_listed_and_removed(void **state)
{
    (void)state;
    bench b;
    char **names;
    set_up(&b);
    assert_int_equal(presets_list(b.settings, &type, &names), 0);
    free(names);
    instance_set_value(&b.mapping, 0, 3);
    save(&b, " soft 1.5 ");
    instance_set_value(&b.mapping, 0, 4);
    save(&b, "hard");
    assert_int_equal(presets_list(b.settings, &type, &names), 2);
    free(names);
    assert_string_equal(presets_kept(b.settings, &type, "soft 1-5"), "jaw.gain=3");
    assert_string_equal(presets_kept(b.settings, &type, "hard"), "jaw.gain=4");
    char key[PRESET_KEY];
    presets_key(key, &type, "soft 1-5");
    settings_set_text(b.settings, key, NULL);
    assert_null(presets_kept(b.settings, &type, "soft 1-5"));
    assert_int_equal(presets_list(b.settings, &type, &names), 1);
    assert_string_equal(names[0], "hard");
    free(names);
    tear_down(&b);
}

static void a_preset_of_initial_values_is_one_too(void **state)
{
    (void)state;
    bench b;
    set_up(&b);
    save(&b, "plain");
    assert_string_equal(presets_kept(b.settings, &type, "plain"), "");
    tear_down(&b);
}

static void odd_names_are_refused(void **state)
{
    (void)state;
    char out[PRESET_NAME], longest[PRESET_NAME + 1];
    memset(longest, 'a', sizeof longest - 1);
    longest[sizeof longest - 1] = '\0';
    assert_false(presets_clean_name(out, ""));
    assert_false(presets_clean_name(out, "  "));
    assert_false(presets_clean_name(out, "a\nb"));
    assert_false(presets_clean_name(out, longest));
    assert_true(presets_clean_name(out, "Night ride \xc3\xa9"));
    assert_string_equal(out, "Night ride \xc3\xa9");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_preset_has_values_and_what_was_taught),
        cmocka_unit_test(damaged_lessons_are_refused_and_values_stay),
        cmocka_unit_test(a_text_names_what_is_changed_alone),
        cmocka_unit_test(a_text_gives_its_values_and_initial_ones_for_the_rest),
        cmocka_unit_test(what_no_longer_fits_is_noted_and_left_out),
        cmocka_unit_test(presets_are_kept_listed_and_removed),
        cmocka_unit_test(a_preset_of_initial_values_is_one_too),
        cmocka_unit_test(odd_names_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
