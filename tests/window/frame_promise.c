/* The frame thread of a live stage keeps its promise while it is recorded: no allocation, lock,
 * file or process, from the first sample on, through takes, marks, changes of the mapping and a
 * device that comes back with other channels. Over a take it asks no other process either.
 * Functions of this program stand in front of libc's. */
#include "base/program.h"
#include "stage/mapping/isolate_process.h"
#include "stage/playback/sequencer.h"
#include "window/live_fixture.h"

#include <marotte/plugin.h>

#include <dlfcn.h>
#include <execinfo.h>
#include <fcntl.h>
#include <pthread.h>
#include <spawn.h>
#include <stdarg.h>
#include <stdatomic.h>

#if !PROGRAM_IS_SANITIZED

enum { NOTES = 12, STACK = 24 };

typedef struct broken_promise {
    const char *what;
    void *stack[STACK];
    int depth;
} broken_promise;

static struct {
    pthread_t frame;
    _Atomic bool is_watched;
    _Atomic bool asks_nobody; /* what is performed live runs here */
    bool is_noting;           /* the frame thread's own */
    _Atomic uint32_t count;
    broken_promise note[NOTES];
} watched;

static void note(const char *what)
{
    if (!atomic_load(&watched.is_watched) || !pthread_equal(pthread_self(), watched.frame) ||
        watched.is_noting)
        return;
    watched.is_noting = true;
    const uint32_t n = atomic_fetch_add(&watched.count, 1);
    if (n < NOTES) {
        watched.note[n].what = what;
        watched.note[n].depth = backtrace(watched.note[n].stack, STACK);
    }
    watched.is_noting = false;
}

/* ---- in front of libc ---- */

/* libc's headers name their parameters __file and the like.
 * NOLINTBEGIN(readability-inconsistent-declaration-parameter-name,bugprone-macro-parentheses) */

#define NEXT_LIBRARIES ((void *)-1L) /* RTLD_NEXT, which glibc shows to GNU C only */

void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *old, size_t size);
void *__libc_memalign(size_t alignment, size_t size);
void __libc_free(void *memory);

MRT_EXPORT void *malloc(size_t size)
{
    note("malloc");
    return __libc_malloc(size);
}

MRT_EXPORT void *calloc(size_t count, size_t size)
{
    note("calloc");
    return __libc_calloc(count, size);
}

MRT_EXPORT void *realloc(void *old, size_t size)
{
    note("realloc");
    return __libc_realloc(old, size);
}

MRT_EXPORT void *aligned_alloc(size_t alignment, size_t size)
{
    note("aligned_alloc");
    return __libc_memalign(alignment, size);
}

MRT_EXPORT void free(void *memory)
{
    if (memory)
        note("free");
    __libc_free(memory);
}

static void find_real(const char *name, void *out_function, size_t size)
{
    void *address = dlsym(NEXT_LIBRARIES, name);
    if (!address)
        abort(); /* not glibc */
    memcpy(out_function, &address, size);
}

#define CATCH(type, name, params, arguments)                                                       \
    MRT_EXPORT type name params                                                                    \
    {                                                                                              \
        static type(*_Atomic real) params;                                                         \
        if (!real) {                                                                               \
            type(*found) params;                                                                   \
            find_real(#name, &found, sizeof found);                                                \
            real = found;                                                                          \
        }                                                                                          \
        note(#name);                                                                               \
        return real arguments;                                                                     \
    }                                                                                              \
    extern type name params

#define CATCH_OPEN(name, params, arguments)                                                        \
    MRT_EXPORT int name params                                                                     \
    {                                                                                              \
        static int(*_Atomic real) params;                                                          \
        if (!real) {                                                                               \
            int(*found) params;                                                                    \
            find_real(#name, &found, sizeof found);                                                \
            real = found;                                                                          \
        }                                                                                          \
        va_list last;                                                                              \
        va_start(last, flags);                                                                     \
        mode_t mode = flags & O_CREAT ? (mode_t)va_arg(last, int) : 0;                             \
        va_end(last);                                                                              \
        note(#name);                                                                               \
        return real arguments;                                                                     \
    }                                                                                              \
    extern int name params

int open64(const char *path, int flags, ...);
int openat64(int folder, const char *path, int flags, ...);
FILE *fopen64(const char *path, const char *mode);
CATCH(int, pthread_mutex_lock, (pthread_mutex_t * mutex), (mutex));
CATCH_OPEN(open, (const char *path, int flags, ...), (path, flags, mode));
CATCH_OPEN(open64, (const char *path, int flags, ...), (path, flags, mode));
CATCH_OPEN(openat, (int folder, const char *path, int flags, ...), (folder, path, flags, mode));
CATCH_OPEN(openat64, (int folder, const char *path, int flags, ...), (folder, path, flags, mode));
CATCH(FILE *, fopen, (const char *restrict path, const char *restrict mode), (path, mode));
CATCH(FILE *, fopen64, (const char *path, const char *mode), (path, mode));
CATCH(ssize_t, read, (int file, void *out, size_t size), (file, out, size));
CATCH(ssize_t, write, (int file, const void *in, size_t size), (file, in, size));
CATCH(pid_t, fork, (void), ());
CATCH(int, posix_spawn,
      (pid_t *restrict out, const char *restrict path, const posix_spawn_file_actions_t *actions,
       const posix_spawnattr_t *restrict how, char *const words[restrict],
       char *const environment[restrict]),
      (out, path, actions, how, words, environment));

/* NOLINTEND(readability-inconsistent-declaration-parameter-name,bugprone-macro-parentheses) */

/* The linker's --wrap puts it in front of the program's own.
 * NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming) */
void __real_isolate_process_send(isolate_process *self, uint32_t kind);
void __wrap_isolate_process_send(isolate_process *self, uint32_t kind);

void __wrap_isolate_process_send(isolate_process *self, uint32_t kind)
{
    if (atomic_load(&watched.asks_nobody))
        note("isolate_process_send");
    __real_isolate_process_send(self, kind);
}
/* NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming) */

/* ---- watching ---- */

static void watch(const live_fixture *d)
{
    void *stack[STACK];
    (void)backtrace(stack, STACK); /* it loads a library the first time */
    watched.frame = d->live->thread;
    atomic_store(&watched.count, 0);
    atomic_store(&watched.is_watched, true);
}

/* What came before keeps the promise. */
static void is_kept(const char *what)
{
    const uint32_t count = atomic_load(&watched.count);
    if (count == 0)
        return;
    atomic_store(&watched.is_watched, false);
    for (uint32_t n = 0; n < count && n < NOTES; ++n) {
        print_message("%s: the frame thread called %s:\n", what, watched.note[n].what);
        (void)fflush(NULL);
        backtrace_symbols_fd(watched.note[n].stack, watched.note[n].depth, STDERR_FILENO);
    }
    fail_msg("%s: %u calls that the frame thread may not make", what, count);
}

/* ---- a session ---- */

static const writer_slate slate = {.scene = "1", .shot = "a"};

static void pull(live_fixture *d)
{
    fixture_drag(d, POINTER_PULLS, fixture_contact(d, "chin"), (vec3){0, -3, 0}, false);
    fixture_perform(d, 0.3);
}

static void open_device(live_fixture *d, const char *text)
{
    error err = {""};
    char path[FIXTURE_PATH];
    snprintf(path, sizeof path, "%s/tests/plugin/flaky.so", BUILD_DIR);
    fixture_must(plugin_list_add(&d->plugins, path, &err), &err);
    fixture_must(fixture_add_input(d, text, &err), &err);
}

static bool has_two_tracks(live_fixture *d, void *data)
{
    const int64_t *before = data;
    return recorder_performance(d->live->recorder) > *before;
}

static void begin_session(live_fixture *d)
{
    error err = {""};
    atomic_store(&watched.asks_nobody, false);
    fixture_start(d, "puppet", "one_hand", FIXTURE_NO_SHOW);
    snprintf(d->show_path, sizeof d->show_path, "%s/fixture.marotte", d->folder);
    fixture_must(show_create(&d->show, d->show_path, &err), &err);
    watch(d);
    fixture_must(live_set_show(d->live, d->show, &err), &err);
    pull(d);
    is_kept("the first samples");
}

static void end_session(live_fixture *d)
{
    atomic_store(&watched.is_watched, false);
    assert_string_equal(recorder_problem(d->live->recorder), "");
    fixture_finish(d);
}

static int64_t record(live_fixture *d)
{
    error err = {""};
    live_status status;
    fixture_must(live_record(d->live, &slate, &err), &err);
    pull(d);
    fixture_must(live_mark(d->live, "here", &err), &err);
    fixture_must(live_record_end(d->live, &err), &err);
    live_status_of(d->live, &status);
    return status.take;
}

static void takes_marks_and_changes_of_the_mapping(void **state)
{
    (void)state;
    live_fixture d;
    error err = {""};
    int64_t kept;
    begin_session(&d);
    (void)record(&d);
    is_kept("a take with a mark in it");
    const int64_t now_ns = clock_now_ns();
    fixture_must(live_keep(d.live, now_ns - NS_PER_S / 10, now_ns, &slate, &kept, &err), &err);
    fixture_perform(&d, 0.1);
    is_kept("a take that is kept");
    fixture_must(live_set_mapping(d.live, "anchored", &err), &err);
    fixture_perform(&d, 0.6);
    is_kept("another mapping");
    const patch turned = {.count = 0};
    fixture_must(live_set_patch(d.live, &turned, &err), &err);
    fixture_perform(&d, 0.3);
    is_kept("another patch");
    end_session(&d);
}

static void a_device_that_comes_back_with_other_channels(void **state)
{
    (void)state;
    live_fixture d;
    error err = {""};
    take t = {0};
    begin_session(&d);
    open_device(&d, "flaky:,restart=1");
    fixture_perform(&d, 0.3);
    is_kept("another device");
    int64_t before = recorder_performance(d.live->recorder);
    fixture_must(live_record(d.live, &slate, &err), &err);
    assert_true(fixture_until(&d, has_two_tracks, &before));
    fixture_perform(&d, 0.3);
    fixture_must(live_record_end(d.live, &err), &err);
    is_kept("a device that is restarted with other channels");
    /* from here on its newest channels are the ones that a performance begins with */
    before = recorder_performance(d.live->recorder);
    fixture_must(live_set_mapping(d.live, "anchored", &err), &err);
    fixture_perform(&d, 0.6);
    assert_int_equal(recorder_performance(d.live->recorder), before + 1);
    is_kept("a mapping after it");
    writer_status status = writer_status_of(recorder_writer(d.live->recorder));
    assert_int_equal(status.lost_count, 0);
    fixture_take(&d, recorder_take(d.live->recorder), &t);
    assert_true(t.layer_count > 0 &&
                t.layer[0].clip_count >= 2); /* one performance with each of its channels */
    take_finish(&t);
    end_session(&d);
}

static bool is_on_the_stage(live_fixture *d, void *data)
{
    (void)data;
    return d->view->mode == LIVE_SHOWS;
}

static void throw_away_what_was_performed(live_fixture *d)
{
    error err = {""};
    edit *edits;
    uint32_t count;
    if (!live_overdub_edits(d->live, &edits, &count, &err))
        fail_msg("nothing was performed: %s", err.text);
    for (uint32_t i = 0; i < count; ++i)
        edit_finish(&edits[i]);
    free(edits);
}

static void a_take_is_performed_over(void **state)
{
    (void)state;
    live_fixture d;
    error err = {""};
    take t = {0};
    begin_session(&d);
    const int64_t id = record(&d);
    fixture_let_go(&d);
    fixture_take(&d, id, &t);
    fixture_must(live_show_take(d.live, &t, &err), &err);
    assert_true(fixture_until(&d, is_on_the_stage, NULL));
    is_kept("a take on the stage");
    const overdub_plan over = {.passes = 1};
    fixture_must(live_overdub_start(d.live, &over, &err), &err);
    pull(&d);
    is_kept("performing over a take");
    fixture_must(live_record_end(d.live, &err), &err);
    fixture_let_go(&d);
    is_kept("the end of it");
    throw_away_what_was_performed(&d);
    take_finish(&t);
    end_session(&d);
}

/* ---- over a take whose mapping runs in a process of its own ---- */

enum { SEEN_MAX = 4096 };

typedef struct seen { /* faces of the take alone */
    uint32_t count, passes;
    int64_t at_ns[SEEN_MAX];
    uint64_t hash[SEEN_MAX];
} seen;

static uint64_t hash_of(const live_fixture *d, const float *rows)
{
    return fixture_hash(rows, (size_t)d->view->vertex_count * 3);
}

/* What is performed over it is seen from in_ns on. */
static void look(live_fixture *d, int64_t in_ns, seen *s)
{
    fixture_frame(d);
    const live_view *v = d->view;
    bool is_new = s->count == 0 || s->at_ns[s->count - 1] != v->at_ns;
    if (v->mode != LIVE_OVERDUBS || v->at_ns >= in_ns || !is_new || s->count == SEEN_MAX)
        return;
    s->passes = v->pass + 1;
    s->at_ns[s->count] = v->at_ns;
    s->hash[s->count++] = hash_of(d, v->position);
}

/* The take, played by somebody else, shows the same faces. */
static void are_of_the_take(live_fixture *d, const take *t, int64_t until_ns, const seen *s)
{
    error err = {""};
    sequencer *plays;
    show *reading;
    uint32_t compared = 0;
    fixture_must(show_open(&reading, d->show_path, SHOW_READ, &err), &err);
    const sequencer_settings settings = {
        .show = reading, .plugins = &d->plugins, .log = d->log, .face = &d->face};
    fixture_must(sequencer_create(&plays, &settings, t, &err), &err);
    composer *shown = sequencer_performer(plays)->composer;
    float *rows = malloc((size_t)d->view->vertex_count * 3 * sizeof *rows);
    for (uint32_t i = 0; i < s->count; ++i) {
        if (s->at_ns[i] >= until_ns)
            continue;
        fixture_must(sequencer_play_to(plays, s->at_ns[i], &err), &err);
        composer_draw(shown);
        points_to_rows(rows, face_shown(composer_face(shown)), face_order(composer_face(shown)));
        if (hash_of(d, rows) != s->hash[i])
            fail_msg("face %u of %u, at %.4f s, is not the take's", i, s->count,
                     (double)s->at_ns[i] / 1e9);
        compared += 1;
    }
    assert_true(compared > 1);
    free(rows);
    sequencer_destroy(plays);
    show_close(reading);
}

static void set_trouble(live_fixture *d, const char *kind)
{
    error err = {""};
    fixture_must(instance_set_text(live_mapping(d->live), "trouble", kind, &err), &err);
}

typedef struct wrong_span { /* on the timeline */
    int64_t not_before_ns, by_ns;
} wrong_span;

/* The mapping goes wrong in the middle; returns when it begins to. */
static wrong_span record_trouble(live_fixture *d, const char *kind, take *out)
{
    error err = {""};
    live_status status;
    char hand[FIXTURE_PATH];
    fixture_must(plugin_list_add(&d->plugins, BUILD_DIR "/tests/plugin/troubled.so", &err), &err);
    fixture_must(live_set_mapping(d->live, "troubled", &err), &err);
    snprintf(hand, sizeof hand, "log:%s/plugins/log/demo_hand.csv,loop=1", SOURCE_DIR);
    fixture_must(fixture_add_input(d, hand, &err), &err);
    fixture_perform(d, 0.3);
    fixture_must(live_record(d->live, &slate, &err), &err);
    fixture_perform(d, 0.4);
    /* On a busy machine what was measured before is performed after. */
    wrong_span wrong = {.not_before_ns = d->view->sample_ns - d->live->take_begun_ns};
    set_trouble(d, kind);
    wrong.by_ns = clock_now_ns() - d->live->take_begun_ns + 50 * NS_PER_MS;
    fixture_perform(d, 0.3);
    set_trouble(d, "None");
    fixture_perform(d, 0.2);
    fixture_must(live_record_end(d->live, &err), &err);
    live_status_of(d->live, &status);
    fixture_take(d, status.take, out);
    return wrong;
}

static void perform_over(live_fixture *d, const take *t, seen *s)
{
    error err = {""};
    fixture_must(live_set_mapping(d->live, "anchored", &err), &err);
    fixture_must(live_show_take(d->live, t, &err), &err);
    assert_true(fixture_until(d, is_on_the_stage, NULL));
    fixture_pass(d, 0.5); /* what was seen before has faded */
    const int64_t in_ns = t->duration_ns - 50 * NS_PER_MS;
    const overdub_plan over = {
        .in_ns = in_ns, .out_ns = t->duration_ns, .preroll_ns = in_ns, .passes = 3};
    atomic_store(&watched.asks_nobody, true);
    watch(d);
    fixture_must(live_overdub_start(d->live, &over, &err), &err);
    while (d->live->is_over)
        look(d, in_ns, s);
    is_kept("performing over what another process performed");
    assert_int_equal(s->passes, 3);
    atomic_store(&watched.is_watched, false);
    atomic_store(&watched.asks_nobody, false);
}

static void over_a_mapping_that_goes_wrong(const char *kind, seen *out, wrong_span *out_wrong)
{
    live_fixture d;
    take t = {0};
    memset(out, 0, sizeof *out);
    fixture_start(&d, "puppet", NULL, FIXTURE_SHOW);
    *out_wrong = record_trouble(&d, kind, &t);
    perform_over(&d, &t, out);
    const bool is_slow = strcmp(kind, "Sleep") == 0;
    are_of_the_take(&d, &t, is_slow ? INT64_MAX : out_wrong->not_before_ns, out);
    throw_away_what_was_performed(&d);
    take_finish(&t);
    fixture_finish(&d);
}

static void a_take_of_a_slow_process_is_performed_over(void **state)
{
    (void)state;
    static seen s;
    wrong_span wrong;
    over_a_mapping_that_goes_wrong("Sleep", &s, &wrong);
}

/* Where it hangs the face is held. */
static void a_take_of_a_process_that_hangs_is_performed_over(void **state)
{
    (void)state;
    static seen s;
    wrong_span wrong;
    uint32_t held = 0;
    uint64_t last = 0;
    over_a_mapping_that_goes_wrong("Hang", &s, &wrong);
    for (uint32_t i = 0; i < s.count; ++i) {
        if (s.at_ns[i] < wrong.by_ns)
            continue;
        if (held++ > 0)
            assert_true(s.hash[i] == last);
        last = s.hash[i];
    }
    assert_true(held > 1);
}

static void copy_file(const char *from, const char *to)
{
    char part[FIXTURE_PATH + 8], bytes[4096];
    size_t size;
    snprintf(part, sizeof part, "%s.part", to);
    FILE *in = fopen(from, "rb"), *out = fopen(part, "wb");
    assert_non_null(in);
    assert_non_null(out);
    while ((size = fread(bytes, 1, sizeof bytes, in)) > 0)
        assert_int_equal(fwrite(bytes, 1, size, out), size);
    assert_int_equal(fclose(in), 0);
    assert_int_equal(fclose(out), 0);
    assert_int_equal(rename(part, to), 0);
}

static bool is_rebuilt(live_fixture *d, void *data)
{
    live_status status;
    (void)data;
    live_status_of(d->live, &status);
    return status.reload_taken > 0 || status.reload_refused > 0;
}

/* One that did not come with the program, in a process of its own. */
static void a_mapping_is_rebuilt(void **state)
{
    (void)state;
    live_fixture d;
    error err = {""};
    live_status status;
    char built[FIXTURE_PATH], own[FIXTURE_PATH];
    begin_session(&d);
    snprintf(built, sizeof built, "%s/plugins/poses.so", BUILD_DIR);
    snprintf(own, sizeof own, "%s/poses.so", d.folder);
    copy_file(built, own);
    fixture_must(plugin_list_add(&d.plugins, own, &err), &err);
    fixture_must(live_set_mapping(d.live, "poses", &err), &err);
    fixture_point(&d, POINTER_PULLS, fixture_rest(&d, 0), fixture_rest(&d, 0), false);
    fixture_perform(&d, 0.6);
    is_kept("a mapping in a process of its own");
    const int64_t before = recorder_performance(d.live->recorder);
    copy_file(built, own);
    assert_true(fixture_until(&d, is_rebuilt, NULL));
    fixture_perform(&d, 0.6);
    live_status_of(d.live, &status);
    is_kept("a mapping that is rebuilt");
    if (status.reload_taken > 0) /* on a busy machine it may answer too late, and is refused */
        assert_int_equal(recorder_performance(d.live->recorder), before + 1);
    (void)unlink(own);
    end_session(&d);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(takes_marks_and_changes_of_the_mapping),
        cmocka_unit_test(a_device_that_comes_back_with_other_channels),
        cmocka_unit_test(a_take_is_performed_over),
        cmocka_unit_test(a_take_of_a_slow_process_is_performed_over),
        cmocka_unit_test(a_take_of_a_process_that_hangs_is_performed_over),
        cmocka_unit_test(a_mapping_is_rebuilt),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

#else

int main(void)
{
    (void)puts("SKIPPED: a sanitizer has a heap and locks of its own");
    return 77;
}

#endif
