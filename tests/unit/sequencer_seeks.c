/* A take is brought to any instant as if it had been played from its start, bit for bit: from
 * instants that were kept while it was played, from states that were kept while it was recorded,
 * from neither, from damaged ones. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "stage/mapping/isolate_process.h"
#include "unit/sequencer_scene.h"

#include <sqlite3.h>
#include <unistd.h>

/* Of each kind. */
static uint64_t count_seeks(void)
{
    return getenv("MAROTTE_TEST_LONG") ? 50 : 20;
}

/* SplitMix64. */
static uint64_t random_of(uint64_t n)
{
    n += 0x9e3779b97f4a7c15u;
    n = (n ^ (n >> 30)) * 0xbf58476d1ce4e5b9u;
    n = (n ^ (n >> 27)) * 0x94d049bb133111ebu;
    return n ^ (n >> 31);
}

static void check_seeks(film *f, sequencer *s, uint64_t seed, const char *how)
{
    int64_t end_ns = f->at_ns[f->count - 1];
    for (uint64_t i = 0; i < count_seeks(); ++i) {
        uint64_t random = random_of(seed * 1000 + i);
        int64_t at_ns = (int64_t)(random % (uint64_t)end_ns);
        if (i % 5 == 4) /* exactly at a sample, and just before it */
            at_ns = f->at_ns[random % f->count] - (int64_t)(random >> 40 & 1);
        if (at_ns < 0)
            at_ns = 0;
        if (film_seek(s, at_ns) != f->hash[film_sample_at(f, at_ns)])
            fail_msg("%s on the %s, %s: seek %d, to %lld ns, gives another face", f->play->mapping,
                     f->play->face, how, (int)i, (long long)at_ns);
        if (i % 7 == 3) { /* and it goes on from there */
            at_ns = at_ns + 300 * help_ms < end_ns ? at_ns + 300 * help_ms : end_ns;
            assert_true(film_play_to(s, at_ns) == f->hash[film_sample_at(f, at_ns)]);
        }
    }
}

static void change_show(const film *f, const char *sql)
{
    sqlite3 *db;
    char *message = NULL;
    assert_int_equal(sqlite3_open(f->path, &db), SQLITE_OK);
    if (sqlite3_exec(db, sql, NULL, NULL, &message) != SQLITE_OK)
        fail_msg("%s", message);
    assert_true(sqlite3_changes(db) > 0);
    assert_int_equal(sqlite3_close(db), SQLITE_OK);
}

/* The library's type without the interface by which it is taken up. */
static mrt_interface plain_interfaces[8];
static mrt_plugin_type plain_type;

static void forget_resume(film *f)
{
    for (uint32_t i = 0; i < f->plugins.entry_count; ++i) {
        plugin_entry *entry = &f->plugins.entry[i];
        if (!strstr(entry->type->id, f->play->mapping) ||
            strlen(strrchr(entry->type->id, '.') + 1) != strlen(f->play->mapping))
            continue;
        plain_type = *entry->type;
        size_t count = 0;
        for (const mrt_interface *one = entry->type->interfaces; one->id; ++one)
            if (strcmp(one->id, MRT_RESUME) != 0 &&
                count + 1 < sizeof plain_interfaces / sizeof *plain_interfaces)
                plain_interfaces[count++] = *one;
        plain_interfaces[count] = (mrt_interface){NULL, NULL};
        plain_type.interfaces = plain_interfaces;
        entry->type = &plain_type;
    }
    assert_non_null(plain_type.id);
}

static sequencer *project(film *f, size_t checkpoint_bytes)
{
    take t = {0};
    film_take(f, &t);
    sequencer *s = film_project(f, &t, checkpoint_bytes);
    take_finish(&t);
    return s;
}

typedef struct way { /* to find an instant */
    const char *name;
    size_t checkpoint_bytes; /* 1: one instant is kept at most; 200000: they are thinned out */
    uint64_t seed;
} way;

/* How many samples had to be performed for it. */
static uint64_t seek_in(film *f, const way *w)
{
    sequencer *s = project(f, w->checkpoint_bytes);
    check_seeks(f, s, w->seed, w->name);
    uint64_t count = sequencer_sample_count(s);
    sequencer_destroy(s);
    return count;
}

static void seek_in_all_ways(const scene_play *play, film_inputs which)
{
    film *f = film_shoot(play, which, "start=2,end=14", 12.0);
    uint64_t by_both = seek_in(f, &(way){"both kinds of states", 0, 1});
    uint64_t by_show = seek_in(f, &(way){"states of the show", 1, 1});
    change_show(f, "DELETE FROM checkpoint");
    uint64_t by_memory = seek_in(f, &(way){"states in memory", 0, 1});
    (void)seek_in(f, &(way){"few states in memory", 200000, 2});
    forget_resume(f);
    uint64_t by_none = seek_in(f, &(way){"no states", 0, 1});
    assert_true(by_both * 2 < by_none && by_show * 4 < by_none * 3 && by_memory * 2 < by_none);
    film_burn(f);
}

static void anchored_is_the_same_from_wherever_it_is_sought(void **state)
{
    (void)state;
    seek_in_all_ways(&(scene_play){.mapping = "anchored",
                                   .face = "plane",
                                   .params = "gate=on,on_release=spring_back,release_time=1.5",
                                   .act = {{.at = 190, .set = "gain=0.9"},
                                           {.at = 350, .press = "Commit"},
                                           {.at = 490, .press = "Release"},
                                           {.at = 720, .press = "Engage"}}},
                     FILM_DEMO);
}

static void unanchored_is_the_same_from_wherever_it_is_sought(void **state)
{
    (void)state;
    seek_in_all_ways(&(scene_play){.mapping = "unanchored",
                                   .face = "plane",
                                   .params = "gate=on,gain=0.5",
                                   .act = {{.at = 190, .set = "leak=30"},
                                           {.at = 350, .press = "Commit"},
                                           {.at = 490, .press = "Release"},
                                           {.at = 520, .press = "Engage"}}},
                     FILM_DEMO);
}

static void one_hand_is_the_same_from_wherever_it_is_sought(void **state)
{
    (void)state;
    seek_in_all_ways(&(scene_play){.mapping = "one_hand",
                                   .face = "moai",
                                   .params = "samples=150",
                                   .act = {{.at = 250, .press = "Anchor"},
                                           {.at = 490, .press = "Blink"},
                                           {.at = 700, .set = "intensity=120"}}},
                     FILM_DEMO);
}

/* The head of the puppet turns, so its tuft and ears swing. */
static void loose_parts_are_the_same_from_wherever_they_are_sought(void **state)
{
    (void)state;
    seek_in_all_ways(&(scene_play){.mapping = "one_hand", .face = "puppet", .params = "samples=20"},
                     FILM_DEMO);
}

static void two_inputs_are_the_same_from_wherever_they_are_sought(void **state)
{
    (void)state;
    seek_in_all_ways(&(scene_play){.mapping = "anchored",
                                   .face = "plane",
                                   .params = "gate=off,commit_pedal=1,engage_pedal=2"},
                     FILM_BOTH);
}

/* What is kept may be damaged in the file, or by a version that keeps otherwise: it costs time. */
static void damaged_states_are_left_aside(void **state)
{
    (void)state;
    static const char *const damages[] = {"UPDATE checkpoint SET crc = crc + 1",
                                          "UPDATE checkpoint SET version = version + 1",
                                          "UPDATE checkpoint SET bytes = substr(bytes, 1, 10)",
                                          "UPDATE checkpoint SET performance = performance + 7"};
    const scene_play play = {
        .mapping = "unanchored", .face = "plane", .params = "gate=off,gain=0.5"};
    for (int i = 0; i < 4; ++i) {
        film *f = film_shoot(&play, FILM_DEMO, "start=3,end=9", 1.0);
        change_show(f, damages[i]);
        sequencer *s = project(f, 0);
        check_seeks(f, s, 20, damages[i]);
        sequencer_destroy(s);
        film_burn(f);
    }
}

/* What is performed over a take may wait for no file: here all samples and states are gone from the
 * show by the time that they are played. */
static void what_was_prepared_needs_no_file(void **state)
{
    (void)state;
    error err = {""};
    take t = {0};
    const scene_play play = {.mapping = "one_hand", .face = "moai", .params = "samples=20"};
    film *f = film_shoot(&play, FILM_BOTH, "start=3,end=14", 11.0);
    film_take(f, &t);
    sequencer *s = film_project(f, &t, 0);
    scene_must(sequencer_seek(s, 100 * help_ms, &err), &err);
    scene_must(sequencer_prepare(s, 0, t.duration_ns, &err), &err);
    change_show(f, "DELETE FROM checkpoint");
    change_show(f, "DELETE FROM chunk");
    check_seeks(f, s, 41, "from what was read ahead");
    sequencer_destroy(s);
    take_finish(&t);
    film_burn(f);
}

/* Where memory ends the face is held, until nobody performs over the take any more. */
static void what_does_not_fit_in_memory_is_held(void **state)
{
    (void)state;
    enum { FIT = 100 };
    error err = {""};
    take t = {0};
    sequencer *s;
    const scene_play play = {
        .mapping = "anchored", .face = "plane", .params = "gate=off,commit_pedal=1"};
    film *f = film_shoot(&play, FILM_DEMO, "start=3,end=9", 6.0);
    film_take(f, &t);
    const sequencer_settings settings = {.show = f->show,
                                         .plugins = &f->plugins,
                                         .log = f->log,
                                         .face = &f->file,
                                         .ahead_bytes = FIT * sizeof(mrt_sample)};
    scene_must(sequencer_create(&s, &settings, &t, &err), &err);
    scene_must(sequencer_seek(s, 0, &err), &err);
    scene_must(sequencer_prepare(s, 0, t.duration_ns, &err), &err);
    assert_non_null(strstr(sequencer_note(s), "keeps its last pose after"));
    for (int pass = 0; pass < 2; ++pass) {
        assert_true(film_seek(s, 0) == f->hash[0]);
        assert_true(film_play_to(s, f->at_ns[FIT / 2]) == f->hash[FIT / 2]);
        assert_true(film_play_to(s, f->at_ns[f->count - 1]) == f->hash[FIT - 1]);
    }
    sequencer_set_live(s, NULL, NULL, false);
    check_seeks(f, s, 43, "after it was held");
    sequencer_destroy(s);
    take_finish(&t);
    film_burn(f);
}

/* A take kept afterwards starts in the middle of a performance; its pre-roll was kept too. */
static void a_take_of_the_last_seconds_shows_what_was_shown(void **state)
{
    (void)state;
    static const char *const mappings[] = {"anchored", "unanchored", "one_hand"};
    for (int i = 0; i < 3; ++i) {
        const scene_play play = {.mapping = mappings[i],
                                 .face = i == 2 ? "moai" : "plane",
                                 .params = i == 2 ? "" : "gate=off,gain=0.5"};
        film *f = film_shoot(&play, FILM_DEMO, "start=2,end=12", 1.0);
        error err = {""};
        take t = {0}, whole = {0};
        int64_t id;
        film_take(f, &whole);
        int64_t from_ns = 6123456789;
        const show_span span = {f->performance, whole.start_ns + from_ns,
                                whole.start_ns + whole.duration_ns - 1, true};
        const show_new_take made = {.created_ns = 1,
                                    .start_ns = span.from_ns,
                                    .end_ns = span.to_ns + 1,
                                    .scene = "1",
                                    .shot = "b",
                                    .origin = "kept",
                                    .spans = &span,
                                    .span_count = 1};
        scene_must(show_take_create(f->show, &made, &id, &err), &err);
        scene_must(show_take_base(f->show, id, &t, &err), &err);
        sequencer *s = film_project(f, &t, 0);
        for (uint64_t k = 0; k < count_seeks(); ++k) {
            int64_t at_ns = (int64_t)(random_of(k) % (uint64_t)(t.duration_ns));
            if (film_seek(s, at_ns) != f->hash[film_sample_at(f, at_ns + from_ns)])
                fail_msg("%s: the face at %lld ns differs", mappings[i], (long long)at_ns);
        }
        sequencer_destroy(s);
        take_finish(&t);
        take_finish(&whole);
        film_burn(f);
    }
}

static void edit_in_many_ways(film *f, take *t)
{
    char add[256];
    film_take(f, t);
    help_do(t, "{'op':'clip.split','clip':2,'at_ns':5000m}");
    help_do(t, "{'op':'clip.speed','clip':3,'speed':1.5}");
    help_do(t, "{'op':'clip.fade','clip':2,'fade_in_ns':700m,'fade_out_ns':300m}");
    help_do(t, "{'op':'layer.add','name':'over'}");
    snprintf(add, sizeof add,
             "{'op':'clip.add','layer':4,'performance':%lld,'from_ns':%lld,'to_ns':%lld,"
             "'source_ns':3000m,'start_ns':2000m,'end_ns':8000m}",
             (long long)f->performance, (long long)t->layer[0].clip[0].from_ns,
             (long long)t->layer[0].clip[0].to_ns);
    help_do(t, add);
    help_do(t, "{'op':'layer.additive','layer':4,'additive':true}");
    help_do(t, "{'op':'clip.smooth','clip':5,'smooth_s':0.1}");
}

/* With several clips, layers, fades and smoothing there are only the instants that were kept while
 * it was played. */
static void edited_takes_are_the_same_from_wherever_they_are_sought(void **state)
{
    (void)state;
    static const char *const mappings[] = {"anchored", "unanchored"};
    for (int i = 0; i < 2; ++i) {
        const scene_play play = {
            .mapping = mappings[i], .face = "plane", .params = "gate=off,gain=0.4"};
        film *f = film_shoot(&play, FILM_DEMO, "start=2,end=14", 1.0);
        error err = {""};
        take t = {0};
        edit_in_many_ways(f, &t);
        sequencer *straight = film_project(f, &t, 0), *sought = film_project(f, &t, 0);
        uint64_t hash[100];
        int64_t at_ns[100];
        for (int k = 0; k < 100; ++k) {
            at_ns[k] = (int64_t)k * 110000000;
            hash[k] = film_play_to(straight, at_ns[k]);
        }
        scene_must(sequencer_seek(sought, at_ns[99], &err), &err); /* keeps instants */
        for (uint64_t k = 0; k < count_seeks(); ++k) {
            int n = (int)(random_of(k) % 100);
            if (film_seek(sought, at_ns[n]) != hash[n])
                fail_msg("%s: the face at %lld ns differs", mappings[i], (long long)at_ns[n]);
        }
        sequencer_destroy(straight);
        sequencer_destroy(sought);
        take_finish(&t);
        film_burn(f);
    }
}

static uint64_t asked_count; /* requests to processes */

/* The linker's --wrap puts it in front of the program's own.
 * NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming) */
void __real_isolate_process_send(isolate_process *self, uint32_t kind);
void __wrap_isolate_process_send(isolate_process *self, uint32_t kind);

void __wrap_isolate_process_send(isolate_process *self, uint32_t kind)
{
    asked_count += 1;
    __real_isolate_process_send(self, kind);
}
/* NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming) */

/* Of a library that did not come with the program. */
static void copy_library(const film *f, char to[FILM_PATH])
{
    char from[FILM_PATH], bytes[4096];
    size_t size;
    snprintf(from, sizeof from, "%s/plugins/%s.so", BUILD_DIR, f->play->mapping);
    snprintf(to, FILM_PATH, "%s/%s.so", f->folder, f->play->mapping);
    FILE *in = fopen(from, "rb"), *out = fopen(to, "wb");
    assert_non_null(in);
    assert_non_null(out);
    while ((size = fread(bytes, 1, sizeof bytes, in)) > 0)
        assert_int_equal(fwrite(bytes, 1, size, out), size);
    assert_int_equal(fclose(in), 0);
    assert_int_equal(fclose(out), 0);
}

/* From there on, as often as one likes, it is as with the mapping here. change: of its type. */
static void play_apart(film *f, void (*change)(film *f))
{
    enum { FACES = 60 };
    const int64_t from_ns = 2500 * help_ms, apart_ns = 97 * help_ms;
    error err = {""};
    char library[FILM_PATH];
    plugin_list here = f->plugins, apart = {0};
    take t = {0};
    uint64_t hash[FACES];
    edit_in_many_ways(f, &t);
    sequencer *s = film_project(f, &t, 0);
    for (int k = 0; k < FACES; ++k)
        hash[k] = film_play_to(s, from_ns + k * apart_ns);
    sequencer_destroy(s);
    copy_library(f, library);
    scene_must(plugin_list_add(&apart, library, &err), &err);
    f->plugins = apart;
    if (change)
        change(f);
    s = film_project(f, &t, 0);
    scene_must(sequencer_seek(s, from_ns, &err), &err);
    scene_must(sequencer_prepare(s, from_ns, t.duration_ns, &err), &err);
    const uint64_t before = asked_count;
    assert_true(before > 0);
    for (int n = 0; n < 3 * FACES; ++n)
        if (film_play_to(s, from_ns + n % FACES * apart_ns) != hash[n % FACES])
            fail_msg("face %d differs where its mapping is not asked", n);
    assert_true(asked_count == before);
    assert_string_equal(sequencer_note(s), "");
    sequencer_set_live(s, NULL, NULL, false);
    assert_true(film_play_to(s, from_ns + apart_ns) == hash[1]); /* by its process again */
    assert_true(asked_count > before);
    sequencer_destroy(s);
    f->plugins = here;
    plugin_list_destroy(&apart);
    assert_int_equal(unlink(library), 0);
    take_finish(&t);
}

static void what_was_prepared_asks_no_process(void **state)
{
    (void)state;
    const scene_play play = {
        .mapping = "unanchored", .face = "plane", .params = "gate=off,gain=0.4"};
    film *f = film_shoot(&play, FILM_DEMO, "start=2,end=14", 1.0);
    play_apart(f, NULL);
    play_apart(f, forget_resume);
    film_burn(f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(anchored_is_the_same_from_wherever_it_is_sought),
        cmocka_unit_test(unanchored_is_the_same_from_wherever_it_is_sought),
        cmocka_unit_test(one_hand_is_the_same_from_wherever_it_is_sought),
        cmocka_unit_test(loose_parts_are_the_same_from_wherever_they_are_sought),
        cmocka_unit_test(two_inputs_are_the_same_from_wherever_they_are_sought),
        cmocka_unit_test(damaged_states_are_left_aside),
        cmocka_unit_test(what_was_prepared_needs_no_file),
        cmocka_unit_test(what_does_not_fit_in_memory_is_held),
        cmocka_unit_test(what_was_prepared_asks_no_process),
        cmocka_unit_test(a_take_of_the_last_seconds_shows_what_was_shown),
        cmocka_unit_test(edited_takes_are_the_same_from_wherever_they_are_sought),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
