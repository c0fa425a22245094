/* Scripts: what is written is done, in order; what makes no sense is named by its line. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "base/file.h"
#include "window/open_any.h"
#include "window/scene.h"
#include "window/script.h"

static char folder_path[] = "/tmp/marotte_script_XXXXXX", path[128];

static int make_folder(void **state)
{
    (void)state;
    if (!mkdtemp(folder_path))
        return -1;
    (void)snprintf(path, sizeof path, "%s/script.txt", folder_path);
    return 0;
}

static int remove_folder(void **state)
{
    char command[160];
    (void)state;
    (void)snprintf(command, sizeof command, "rm -rf %s", folder_path);
    return system(command) == 0 ? 0 : -1;
}

static mrt_result read_text(script **out, const char *text, error *err)
{
    if (file_write(path, text, strlen(text), err) < 0)
        return MRT_ERR_IO;
    return script_read(out, path, err);
}

/* ---- reading ---- */

static void what_makes_no_sense_is_named_by_its_line(void **state)
{
    static const struct {
        const char *text, *line, *said;
    } wrong[] = {
        {"frames 1\nfly 3\n", ":2:", "fly"}, {"# nothing\n\nmove 1\n", ":3:", "move X Y"},
        {"click 1 two\n", ":1:", "click"},   {"down up\n", ":1:", "left, right or middle"},
        {"key Hyper+X\n", ":1:", "Hyper+X"}, {"do nothing_at_all\n", ":1:", "nothing_at_all"},
        {"type\n", ":1:", "type TEXT"},      {"frames 2 3\n", ":1:", "frames N"},
        {"wait nan\n", ":1:", "wait"},
    };
    (void)state;
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        script *s = NULL;
        error err = {0};
        assert_true(read_text(&s, wrong[i].text, &err) < 0);
        assert_null(s);
        assert_non_null(strstr(err.text, path));
        assert_non_null(strstr(err.text, wrong[i].line));
        assert_non_null(strstr(err.text, wrong[i].said));
    }
}

static void every_command_is_in_the_help(void **state)
{
    static const char *const names[] = {"move",    "down",   "up",   "click",   "drag", "wheel",
                                        "key",     "type",   "do",   "press",   "wait", "frames",
                                        "picture", "random", "hold", "release", "calm", "memory"};
    (void)state;
    for (size_t i = 0; i < sizeof names / sizeof names[0]; ++i)
        assert_non_null(strstr(script_help(), names[i]));
}

static void keys_have_the_names_that_the_help_shows(void **state)
{
    static const key_map brought; /* zeroed */
    key_chord chord;
    (void)state;
    for (uint32_t i = 1; i < ACTION_COUNT; ++i) {
        char name[KEY_WORDS];
        const action_entry *entry = action_of((action)i);
        key_map_words(&brought, (action)i, name);
        if (!entry->key)
            continue;
        if (!key_chord_parse(&chord, name))
            fail_msg("%s", name);
        assert_int_equal(chord.key, entry->key);
        assert_int_equal(chord.modifiers, entry->modifiers);
    }
    assert_true(key_chord_parse(&chord, "alt+ctrl+x"));
    assert_int_equal(chord.key, 'X');
    assert_int_equal(chord.modifiers, UI_ALT | UI_CONTROL);
    assert_true(key_chord_parse(&chord, "Ctrl++"));
    assert_int_equal(chord.key, '+');
    assert_true(key_chord_parse(&chord, "PageUp"));
    assert_int_equal(chord.key, UI_KEY_PAGE_UP);
    assert_false(key_chord_parse(&chord, "F13"));
    assert_false(key_chord_parse(&chord, ""));
}

/* ---- doing ---- */

static void run_script(scene *s, const char *text)
{
    script *written = NULL;
    error err = {0};
    if (read_text(&written, text, &err) < 0)
        fail_msg("%s", err.text);
    mrt_result result = MRT_OK;
    const int64_t end_ns = clock_now_ns() + SCENE_PATIENCE_S * NS_PER_S;
    while (result == MRT_OK && clock_now_ns() < end_ns) {
        const script_stage on = {
            s->ui, s->app, s->window, {.width = s->width, .height = s->height, .scale = 1.0f}};
        result = script_step(written, &on, &err);
        scene_frame(s);
    }
    if (result != MRT_END)
        fail_msg("it has not ended: %s", err.text);
    script_destroy(written);
    scene_settle(s);
}

static void a_script_does_what_a_person_would(void **state)
{
    scene s;
    char text[512];
    (void)state;
    scene_open(&s, 800, 600, 1.0f);
    (void)snprintf(text, sizeof text,
                   "press Engine\n"
                   "key F7            \n"
                   "# the view\n"
                   "do show_contacts\n"
                   "drag 300 200 340 220 5 right\n"
                   "key Shift+F11\n"
                   "frames 2\n"
                   "wait 0.01\n"
                   "picture %s/picture.png\n"
                   "random 7 0.2\n",
                   folder_path);
    app_looks *looks = app_looks_of(s.app);
    const bool had_timeline = looks->layouts.now.has_timeline,
               was_mirrored = looks->is_output_mirrored;
    char *random = strstr(text, "random");
    *random = '\0';
    run_script(&s, text);
    assert_int_equal(looks->layouts.now.current, APP_ENGINE);
    assert_int_not_equal(looks->layouts.now.has_timeline, had_timeline);
    assert_int_not_equal(looks->is_output_mirrored, was_mirrored);
    assert_true(looks->shows_contacts);
    (void)snprintf(text, sizeof text, "%s/picture.png", folder_path);
    assert_int_equal(access(text, R_OK), 0);
    run_script(&s, "random 7 1.5\n");
    assert_false(app_wants_to_quit(s.app));
    assert_false(s.is_over);
    scene_close(&s);
}

static void words_that_are_not_there_end_the_script(void **state)
{
    scene s;
    script *written = NULL;
    error err = {0};
    (void)state;
    scene_open(&s, 800, 600, 1.0f);
    assert_int_equal(read_text(&written, "press No such word\n", &err), MRT_OK);
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; i < 1000 && result == MRT_OK; ++i) {
        const script_stage on = {s.ui, s.app, s.window, {.scale = 1.0f}};
        result = script_step(written, &on, &err);
    }
    assert_true(result < 0);
    assert_non_null(strstr(err.text, "No such word"));
    script_destroy(written);
    scene_close(&s);
}

/* Behind a question nothing else is reached: a person gives up some time. */
static void whoever_clicks_at_random_does_not_stay_with_a_question(void **state)
{
    enum { SEEDS = 6, STEPS = 250 };
    scene s;
    (void)state;
    scene_open(&s, 800, 600, 1.0f);
    for (uint64_t seed = 1; seed <= SEEDS; ++seed) {
        script_random random;
        uint32_t steps = 0;
        scene_key(&s, UI_KEY_ESCAPE, 0);
        scene_do(&s, ACTION_OPEN);
        assert_true(ui_has_dialog(s.ui));
        script_random_begin(&random, seed);
        for (; steps < STEPS && ui_has_dialog(s.ui); ++steps) {
            script_random_step(&random, s.ui, s.width, s.height);
            scene_settle(&s);
        }
        script_random_end(&random, s.ui);
        scene_settle(&s);
        assert_true(steps < STEPS);
    }
    scene_close(&s);
}

/* ---- folders, of the dialog that opens ---- */

static void put(const char *name)
{
    char file[256];
    error err = {0};
    (void)snprintf(file, sizeof file, "%s/%s", folder_path, name);
    assert_int_equal(file_write(file, "x", 1, &err), MRT_OK);
}

static void a_folder_lists_folders_and_what_is_wanted(void **state)
{
    static const char *const endings[] = {".marotte", NULL};
    open_folder at = {.count = 0};
    error err = {0};
    char inner[256], joined[OPEN_PATH];
    (void)state;
    put("b.marotte");
    put("A.MAROTTE");
    put("c.txt");
    put(".hidden.marotte");
    put("d\n.marotte");
    (void)snprintf(inner, sizeof inner, "%s/zoo", folder_path);
    assert_int_equal(mkdir(inner, 0755), 0);
    assert_int_equal(open_folder_go(&at, folder_path, endings, &err), MRT_OK);
    assert_int_equal(at.count, 4);
    assert_string_equal(at.entry[0].name, "..");
    assert_string_equal(at.entry[1].name, "zoo");
    assert_true(at.entry[1].is_folder);
    assert_string_equal(at.entry[2].name, "A.MAROTTE");
    assert_string_equal(at.entry[3].name, "b.marotte");
    assert_true(open_folder_go(&at, "/no/such/folder", endings, &err) < 0);
    assert_int_equal(at.count, 4);
    assert_true(open_folder_join(&at, "b.marotte", joined));
    assert_non_null(strstr(joined, "/b.marotte"));
    assert_true(open_folder_join(&at, "/etc", joined));
    assert_string_equal(joined, "/etc");
    assert_int_equal(open_folder_go(&at, "/", endings, &err), MRT_OK);
    assert_string_not_equal(at.entry[0].name, "..");
    assert_true(open_folder_join(&at, "tmp", joined));
    assert_string_equal(joined, "/tmp");
    open_folder_finish(&at);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_makes_no_sense_is_named_by_its_line),
        cmocka_unit_test(every_command_is_in_the_help),
        cmocka_unit_test(keys_have_the_names_that_the_help_shows),
        cmocka_unit_test(a_script_does_what_a_person_would),
        cmocka_unit_test(words_that_are_not_there_end_the_script),
        cmocka_unit_test(whoever_clicks_at_random_does_not_stay_with_a_question),
        cmocka_unit_test(a_folder_lists_folders_and_what_is_wanted),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
