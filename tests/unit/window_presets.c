/* ui/window/presets.h: values of parameters under a name. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "window/app/presets.h"

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
        cmocka_unit_test(a_text_names_what_is_changed_alone),
        cmocka_unit_test(a_text_gives_its_values_and_initial_ones_for_the_rest),
        cmocka_unit_test(what_no_longer_fits_is_noted_and_left_out),
        cmocka_unit_test(presets_are_kept_listed_and_removed),
        cmocka_unit_test(a_preset_of_initial_values_is_one_too),
        cmocka_unit_test(odd_names_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
