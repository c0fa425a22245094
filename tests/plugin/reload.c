/* A mapping's library is rebuilt while it performs. --long: a thousand times. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/file.h"
#include "plugin/stand.h"
#include "stage/perform/reload.h"

#include <dirent.h>
#include <unistd.h>

#define EARLY  BUILD_DIR "/tests/plugin/troubled.so"
#define LATER  BUILD_DIR "/tests/plugin/troubled_later.so"
#define ALWAYS BUILD_DIR "/tests/plugin/troubled_always.so"

static bool is_long;
static char folder[] = "/tmp/marotte-reload-XXXXXX";
static char library[64];

/* As a linker does: the name is taken away from the old file at once. */
static void build(const char *from)
{
    error err = {""};
    file_bytes bytes;
    scene_must(file_read(&bytes, from, (size_t)64 << 20, &err), &err);
    scene_must(file_write(library, bytes.data, bytes.size, &err), &err);
    file_bytes_finish(&bytes);
}

typedef struct watched {
    stand stand;
    stand other; /* the same hand, never reloaded */
    stand_watch watch;
    reload *reload;
    uint32_t n, refused;
    double worst_ms;
} watched;

static void begin(watched *w, const char *params, const isolate_settings *apart)
{
    error err = {""};
    *w = (watched){.n = 0};
    build(EARLY);
    stand_watch_begin(&w->watch, stand_furthest_step(EARLY, params, 500));
    stand_up(&w->stand, library, params, apart);
    stand_up(&w->other, EARLY, params, NULL);
    const reload_settings settings = {.library = library,
                                      .mapping = &w->stand.mapping,
                                      .mapped = composer_mapped(w->stand.performer->composer),
                                      .log = w->stand.log,
                                      .clock = CLOCK_REAL,
                                      .isolate = apart};
    scene_must(reload_start(&w->reload, &settings, &err), &err);
}

static void end(watched *w)
{
    performer_destroy(w->stand.performer);
    w->stand.performer = NULL;
    reload_stop(w->reload);
    stand_lie_down(&w->stand);
    stand_lie_down(&w->other);
    stand_watch_finish(&w->watch);
}

static bool step(watched *w)
{
    int64_t before_ns = clock_now_ns();
    bool is_taken = reload_step(w->reload, w->stand.performer->voice[0].layer);
    stand_step(&w->stand, w->n);
    w->worst_ms = fmax(w->worst_ms, (double)(clock_now_ns() - before_ns) * 1e-6);
    stand_step(&w->other, w->n++);
    stand_watch_step(&w->watch, &w->stand, &w->other);
    return is_taken;
}

static void steps(watched *w, uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i)
        assert_false(step(w));
}

static void fail_with_news(watched *w)
{
    log_record line;
    while (log_pop(w->stand.log, &line))
        print_message("%s\n", line.text);
    fail_msg("a version was refused");
}

/* Samples every 2 ms for at least a minute, until another version pulls. */
static void until_taken(watched *w)
{
    for (int i = 0; i < 30000; ++i) {
        if (step(w))
            return;
        if (reload_get_counts(w->reload).refused > w->refused)
            fail_with_news(w);
        clock_sleep_until_ns(clock_now_ns() + 2 * NS_PER_MS);
    }
    fail_msg("the rebuilt version was not taken");
}

static void until_counted(watched *w, uint32_t taken, uint32_t refused)
{
    for (int i = 0; i < 30000; ++i) {
        reload_counts now = reload_get_counts(w->reload);
        if (now.taken == taken && now.refused == refused)
            return;
        (void)step(w);
        clock_sleep_until_ns(clock_now_ns() + 2 * NS_PER_MS);
    }
    fail_msg("neither taken nor refused");
}

static void check_continuity(const watched *w)
{
    if (w->watch.worst_excess_mm > 0)
        fail_msg("the face jumped by %.3f mm more than it may", w->watch.worst_excess_mm);
}

static double param_of(watched *w, const char *name)
{
    const instance *mapping = w->stand.performer->voice[0].layer->mapping;
    for (uint32_t i = 0; i < mapping->type->param_count; ++i)
        if (strcmp(mapping->type->params[i].name, name) == 0)
            return atomic_load(&mapping->wanted[i]);
    fail_msg("there is no %s", name);
    return 0;
}

static void check_take_over(const isolate_settings *apart)
{
    watched w;
    begin(&w, "gain=0.7", apart);
    steps(&w, 40);
    stand_set(&w.stand, "early=0.9");
    build(LATER);
    until_taken(&w);
    assert_string_equal(w.stand.performer->voice[0].layer->mapping->type->version, "2");
    assert_memory_equal(reload_identity(w.reload), "org.example.troubled 2 ", 23);
    assert_float_equal(param_of(&w, "Gain"), 0.7, 0);  /* carried over */
    assert_float_equal(param_of(&w, "Later"), 0.5, 0); /* its own initial value */
    until_counted(&w, 1, 0);
    steps(&w, 60);
    /* It has the old one's anchor: it pulls as if nothing had happened. */
    assert_memory_equal(layer_pull(w.stand.performer->voice[0].layer)->vector,
                        layer_pull(w.other.performer->voice[0].layer)->vector,
                        sizeof(mrt_vector) * 5);
    check_continuity(&w);
    assert_true(stand_hears(&w.stand, "version 2 has taken over"));
    end(&w);
}

static void a_rebuilt_version_takes_over_without_a_jump(void **state)
{
    (void)state;
    check_take_over(NULL);
}

static void a_rebuilt_version_takes_over_in_a_process_of_its_own(void **state)
{
    (void)state;
    const isolate_settings settings = {.clock = CLOCK_REAL, .deadline_ns = NS_PER_S};
    check_take_over(&settings);
}

static void check_refused(const char *from, const char *reason)
{
    watched w;
    error err = {""};
    begin(&w, "", NULL);
    steps(&w, 40);
    if (from)
        build(from);
    else
        scene_must(file_write(library, "no library at all", 17, &err), &err);
    until_counted(&w, 0, 1);
    w.refused = 1;
    assert_true(stand_hears(&w.stand, reason));
    steps(&w, 20);
    assert_memory_equal(layer_pull(w.stand.performer->voice[0].layer),
                        layer_pull(w.other.performer->voice[0].layer), sizeof(mrt_pull));
    build(LATER); /* the next one is taken all the same */
    until_taken(&w);
    until_counted(&w, 1, 1);
    check_continuity(&w);
    end(&w);
}

static void a_version_that_breaks_a_rule_is_refused(void **state)
{
    (void)state;
    check_refused(ALWAYS, "mapping.finite");
}

static void a_version_that_cannot_be_created_is_refused(void **state)
{
    (void)state;
    check_refused(BUILD_DIR "/tests/plugin/troubled_refuses.so", "no licence for this machine");
}

static void what_is_no_library_is_refused(void **state)
{
    (void)state;
    check_refused(NULL, "is refused: ");
}

static void half_a_library_is_waited_for(void **state)
{
    (void)state;
    error err = {""};
    file_bytes bytes;
    watched w;
    begin(&w, "", NULL);
    scene_must(file_read(&bytes, LATER, (size_t)64 << 20, &err), &err);
    /* within what is loaded: more than half of the file may be for debuggers */
    scene_must(file_write(library, bytes.data, bytes.size < 8192 ? bytes.size / 2 : 8192, &err),
               &err);
    for (int i = 0; i < 100; ++i) {
        assert_false(step(&w));
        clock_sleep_until_ns(clock_now_ns() + 2 * NS_PER_MS);
    }
    reload_counts now = reload_get_counts(w.reload);
    assert_int_equal(now.taken + now.refused, 0);
    file_bytes_finish(&bytes);
    build(LATER);
    until_taken(&w);
    check_continuity(&w);
    end(&w);
}

static void a_state_with_a_leaving_pull_is_kept(void **state)
{
    (void)state;
    error err = {""};
    watched w;
    begin(&w, "", NULL);
    steps(&w, 40);
    build(LATER);
    until_taken(&w);
    steps(&w, 5); /* amid the fade */
    assert_true(layer_is_fading(w.stand.performer->voice[0].layer));
    assert_non_null(layer_leaving(w.stand.performer->voice[0].layer));
    size_t size = performer_save(w.stand.performer, NULL, 0);
    unsigned char *bytes = malloc(size);
    assert_int_equal(performer_save(w.stand.performer, bytes, size), size);
    uint32_t n = w.n;
    uint64_t hash[30];
    for (int i = 0; i < 30; ++i) {
        stand_step(&w.stand, n + (uint32_t)i);
        composer_draw(w.stand.performer->composer);
        hash[i] = scene_hash(composer_face(w.stand.performer->composer));
    }
    scene_must(performer_load(w.stand.performer, bytes, size, &err), &err);
    for (int i = 0; i < 30; ++i) {
        stand_step(&w.stand, n + (uint32_t)i);
        composer_draw(w.stand.performer->composer);
        assert_true(hash[i] == scene_hash(composer_face(w.stand.performer->composer)));
    }
    bytes[20] ^= 0x40; /* damage is refused or harmless */
    if (performer_load(w.stand.performer, bytes, size, &err) < 0)
        assert_true(err.text[0] != '\0');
    free(bytes);
    end(&w);
}

static long heap_pages(void)
{
    long size = 0, resident = 0, shared = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    assert_non_null(file);
    assert_int_equal(fscanf(file, "%ld %ld %ld", &size, &resident, &shared), 3);
    (void)fclose(file);
    return resident - shared;
}

static uint32_t open_files(void)
{
    uint32_t count = 0;
    DIR *open = opendir("/proc/self/fd");
    assert_non_null(open);
    while (readdir(open))
        count += 1;
    (void)closedir(open);
    return count;
}

static int by_size(const void *a, const void *b)
{
    const int64_t *x = a, *y = b;
    return (*x > *y) - (*x < *y);
}

static void many_reloads_leak_nothing_and_miss_no_sample(void **state)
{
    (void)state;
    enum { MOST = 1000, WARM = 10 };
    static int64_t took_ns[MOST];
    uint32_t count = is_long ? MOST : 50;
    watched w;
    begin(&w, "", NULL);
    steps(&w, 20);
    long pages = 0;
    uint32_t files = 0;
    for (uint32_t i = 0; i < count; ++i) {
        build(i % 2 ? EARLY : LATER);
        int64_t complete_ns = clock_now_ns();
        until_taken(&w);
        took_ns[i] = clock_now_ns() - complete_ns;
        until_counted(&w, i + 1, 0);
        if (i == WARM) {
            pages = heap_pages();
            files = open_files();
        }
    }
    assert_int_equal(open_files(), files);
    assert_int_equal(w.stand.performer->counts->samples, w.n);
    assert_int_equal(w.stand.performer->counts->bad_pulls, 0);
    check_continuity(&w);
    qsort(took_ns, count, sizeof *took_ns, by_size);
    double median_ms = (double)took_ns[count / 2] * 1e-6;
    double page_kib = (double)sysconf(_SC_PAGESIZE) / 1024.0;
    double kib = (double)(heap_pages() - pages) * page_kib / (double)(count - WARM);
    print_message("%u reloads: median %.0f ms, worst %.0f ms from the file being complete; %.1f "
                  "KiB each; %u samples, worst %.2f ms\n",
                  count, median_ms, (double)took_ns[count - 1] * 1e-6, kib, w.n, w.worst_ms);
#if !defined(__SANITIZE_ADDRESS__)
    assert_true(kib < 64); /* a mapped library: its written pages and what ld.so knows of it */
#endif
    end(&w);
}

int main(int argc, char **argv)
{
    is_long = argc > 1 && strcmp(argv[1], "--long") == 0;
    if (!mkdtemp(folder))
        return 1;
    (void)snprintf(library, sizeof library, "%s/mine.so", folder);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_rebuilt_version_takes_over_without_a_jump),
        cmocka_unit_test(a_rebuilt_version_takes_over_in_a_process_of_its_own),
        cmocka_unit_test(a_version_that_breaks_a_rule_is_refused),
        cmocka_unit_test(a_version_that_cannot_be_created_is_refused),
        cmocka_unit_test(what_is_no_library_is_refused),
        cmocka_unit_test(half_a_library_is_waited_for),
        cmocka_unit_test(a_state_with_a_leaving_pull_is_kept),
        cmocka_unit_test(many_reloads_leak_nothing_and_miss_no_sample),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    (void)unlink(library);
    (void)rmdir(folder);
    return failed;
}
