/* What a show names is looked up among what is loaded: no id in it is the path of a library, for
 * performing again as for drawing the timeline. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "unit/sequencer_scene.h"

#include "stage/playback/activity.h"

#include <dlfcn.h>
#include <sqlite3.h>

static const scene_play play = {.mapping = "anchored", .face = "moai", .params = ""};
static const char library[] = BUILD_DIR "/tests/plugin/troubled.so";

static bool is_loaded(void)
{
    return dlopen(library, RTLD_LAZY | RTLD_NOLOAD) != NULL;
}

static void store_identity(const film *f, const char *identity)
{
    sqlite3 *db;
    sqlite3_stmt *change;
    assert_int_equal(sqlite3_open(f->path, &db), SQLITE_OK);
    assert_int_equal(
        sqlite3_prepare_v2(db,
                           "UPDATE plugin SET identity = ? WHERE id IN (SELECT plugin FROM "
                           "performance)",
                           -1, &change, NULL),
        SQLITE_OK);
    assert_int_equal(sqlite3_bind_text(change, 1, identity, -1, SQLITE_STATIC), SQLITE_OK);
    assert_int_equal(sqlite3_step(change), SQLITE_DONE);
    assert_int_equal(sqlite3_changes(db), 1);
    sqlite3_finalize(change);
    assert_int_equal(sqlite3_close(db), SQLITE_OK);
}

static void no_stored_id_is_a_path(void **state)
{
    (void)state;
    static const char *const before[] = {"", "", "org.marotte.anchored", "./"};
    static const char *const behind[] = {" 1.0 0", "/troubled 1.0 0", " 1.0 0", ""};
    film *f = film_shoot(&play, FILM_DEMO, "start=3,end=5", 0.0);
    performer *scratch;
    const performer_settings of_rig = {.rezero_pedal = 0};
    error err = {""};
    scene_must(performer_create(&scratch, &f->file, NULL, &of_rig, &err), &err);
    const uint32_t refusals = f->plugins.refusal_count, entries = f->plugins.entry_count;
    for (size_t i = 0; i < sizeof before / sizeof *before; ++i) {
        char identity[FILM_PATH * 2];
        replay *again = NULL;
        activity *drawn = NULL;
        (void)snprintf(identity, sizeof identity, "%s%s%s", before[i], library, behind[i]);
        store_identity(f, identity);
        const replay_world world = {
            .show = f->show, .plugins = &f->plugins, .log = f->log, .scratch = scratch};
        assert_true(replay_open(&again, &world, f->performance, TAKE_WHOLE, &err) < 0);
        assert_null(again);
        assert_non_null(strstr(err.text, "there is no mapping plugin"));
        assert_true(activity_create(&drawn, &world, f->performance, TAKE_WHOLE, &err) < 0);
        assert_false(is_loaded());
    }
    assert_int_equal(f->plugins.refusal_count, refusals);
    assert_int_equal(f->plugins.entry_count, entries);
    performer_destroy(scratch);
    film_burn(f);
}

/* The command line is the person's word: there a path is one, and one of several types is named. */
static void chosen_words_may_be_a_path(void **state)
{
    (void)state;
    plugin_list list = {0};
    const mrt_plugin_type *type;
    error err = {""};
    char *spec;
    assert_true(plugin_list_find(&list, library, MRT_MAPPING, &type, &err) < 0);
    assert_false(is_loaded());
    scene_must(plugin_list_choose(&list, library, MRT_MAPPING, &type, &err), &err);
    assert_string_equal(type->id, "org.example.troubled");
    assert_string_equal(plugin_list_path_of(&list, type), library);
    scene_must(plugin_list_find(&list, "troubled", MRT_MAPPING, &type, &err), &err);
    assert_true(plugin_list_choose(&list, library, MRT_INPUT, &type, &err) < 0);
    assert_non_null(strstr(err.text, "has no input"));
    scene_must(plugin_list_choose_spec(&list, BUILD_DIR "/tests/plugin/troubled.so,trouble=crash",
                                       MRT_MAPPING, &spec, &err),
               &err);
    assert_string_equal(spec, "org.example.troubled,trouble=crash");
    free(spec);
    plugin_list_destroy(&list);
}

static void one_of_several_types_is_named(void **state)
{
    (void)state;
    static const char two[] = BUILD_DIR "/tests/plugin/two_types.so";
    plugin_list list = {0};
    const mrt_plugin_type *type;
    error err = {""};
    char words[sizeof two + 32];
    assert_true(plugin_list_choose(&list, two, MRT_MAPPING, &type, &err) < 0);
    assert_non_null(strstr(err.text, "two_types.so/first, "));
    assert_non_null(strstr(err.text, "two_types.so/second"));
    static const char *const names[] = {"first", "second", "org.example.second"};
    for (size_t i = 0; i < 3; ++i) {
        (void)snprintf(words, sizeof words, "%s/%s", two, names[i]);
        scene_must(plugin_list_choose(&list, words, MRT_MAPPING, &type, &err), &err);
        assert_string_equal(type->id, i == 0 ? "org.example.first" : "org.example.second");
    }
    (void)snprintf(words, sizeof words, "%s/third", two);
    assert_true(plugin_list_choose(&list, words, MRT_MAPPING, &type, &err) < 0);
    plugin_list_destroy(&list);
}

/* Other threads look at the list while the person names further libraries. */
static void what_is_in_a_list_never_moves(void **state)
{
    (void)state;
    static const char *const more[] = {
        "tests/plugin/two_types.so", "tests/plugin/sound.so",  "tests/plugin/nan.so",
        "tests/plugin/many.so",      "tests/plugin/reach.so",  "plugins/log.so",
        "plugins/one_hand.so",       "plugins/anchored.so",    "plugins/unanchored.so",
        "tests/plugin/param.so",     "tests/plugin/symbol.so", "tests/plugin/abi.so"};
    plugin_list list = {0};
    const mrt_plugin_type *type;
    error err = {""};
    scene_must(plugin_list_add(&list, library, &err), &err);
    scene_must(plugin_list_find(&list, "troubled", MRT_MAPPING, &type, &err), &err);
    const plugin_entry *first = &list.entry[0];
    const plugin_refusal *refused = list.refusal;
    const char *path = plugin_list_path_of(&list, type);
    for (size_t i = 0; i < sizeof more / sizeof *more; ++i) {
        char name[FILM_PATH];
        (void)snprintf(name, sizeof name, "%s/%s", BUILD_DIR, more[i]);
        (void)!plugin_list_add(&list, name, &err);
        (void)!plugin_list_add(&list, name, &err); /* again: it is there once */
    }
    assert_ptr_equal(&list.entry[0], first);
    assert_ptr_equal(list.refusal, refused);
    assert_ptr_equal(plugin_list_path_of(&list, type), path);
    assert_int_equal(list.entry_count, 8);
    for (uint32_t i = 0; i < list.hidden_count; ++i) /* of those with the id of sound.so */
        assert_string_equal(list.hidden[i].type->id, "org.example.broken");
    plugin_list_destroy(&list);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(no_stored_id_is_a_path),

                                       cmocka_unit_test(chosen_words_may_be_a_path),
                                       cmocka_unit_test(one_of_several_types_is_named),
                                       cmocka_unit_test(what_is_in_a_list_never_moves)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
