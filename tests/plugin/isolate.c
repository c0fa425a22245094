/* Mappings in processes of their own: the same bits, and what happens when they crash, hang, are
 * slow or give nonsense. --long: more kills. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/file.h"
#include "plugin/stand.h"
#include "stage/mapping/isolate_process.h"

#include <dirent.h>
#include <signal.h>
#include <unistd.h>

#define TROUBLED BUILD_DIR "/tests/plugin/troubled.so"
#define POSER    BUILD_DIR "/tests/plugin/poser.so"

static bool is_long;
static char reports[] = "/tmp/marotte-isolate-XXXXXX";

/* As in the other tests of the scene: real hands, acts, gaps and re-zeros, on a virtual clock. */
static void check_same_bits(const char *name, const char *params)
{
    char path[1024];
    error err = {""};
    const scene_play play = {
        .mapping = name, .face = "puppet", .params = params, .act = {{.at = 110, .rezero = 2}}};
    face_file file;
    scene_stand here;
    scene_face(&file, play.face);
    scene_stand_up(&here, &play, &file);

    scene_stand there = {.log = log_queue_create()};
    isolate *apart;
    const isolate_settings settings = {.clock = CLOCK_VIRTUAL};
    (void)snprintf(path, sizeof path, "%s/plugins/%s.so", BUILD_DIR, name);
    const mrt_plugin_type *type = scene_type(&there.plugins, name);
    scene_must(isolate_create_mapping(&apart, type, path, &settings, &err), &err);
    assert_ptr_equal(isolate_inner(isolate_type(apart)), type);
    scene_must(instance_create(&there.mapping, isolate_type(apart), CLOCK_VIRTUAL, there.log, &err),
               &err);
    scene_must(instance_set_list(&there.mapping, params, &err), &err);
    const performer_settings as = {0};
    scene_must(performer_create(&there.performer, &file, &there.mapping, &as, &err), &err);
    memcpy(there.route, here.route, sizeof there.route);

    for (uint32_t n = 0; n < 260; ++n) {
        scene_step(&here, &play, n);
        scene_step(&there, &play, n);
        if (memcmp(layer_pull(here.performer->voice[0].layer),
                   layer_pull(there.performer->voice[0].layer), sizeof(mrt_pull)) != 0)
            fail_msg("%s: the pull of sample %u differs", name, n);
    }
    composer_draw(here.performer->composer);
    composer_draw(there.performer->composer);
    assert_true(scene_hash(composer_face(here.performer->composer)) ==
                scene_hash(composer_face(there.performer->composer)));
    size_t size = performer_save(here.performer, NULL, 0);
    assert_int_equal(performer_save(there.performer, NULL, 0), size);
    unsigned char *a = malloc(size + 1), *b = malloc(size + 1);
    assert_int_equal(performer_save(here.performer, a, size), size);
    assert_int_equal(performer_save(there.performer, b, size), size);
    assert_memory_equal(a, b, size);
    scene_must(performer_load(there.performer, a, size, &err), &err);
    scene_step(&here, &play, 260);
    scene_step(&there, &play, 260);
    assert_memory_equal(layer_pull(here.performer->voice[0].layer),
                        layer_pull(there.performer->voice[0].layer), sizeof(mrt_pull));
    free(a);
    free(b);
    isolate_counts counts = isolate_counted(there.mapping.self);
    assert_int_equal(counts.failed, 0);
    scene_lay_down(&here);
    scene_lay_down(&there);
    isolate_destroy(apart);
    face_file_destroy(&file);
}

/* How long a frame waits for an answer, whatever it was told: no answer is late because the machine
 * is busy. 0: as it was told. */
static int64_t frame_waits_ns = 60 * NS_PER_S;

mrt_result __real_isolate_process_wait_until_ns(isolate_process *self, int64_t time_ns);
mrt_result __wrap_isolate_process_wait_until_ns(isolate_process *self, int64_t time_ns);
mrt_result __wrap_isolate_process_wait_until_ns(isolate_process *self, int64_t time_ns)
{
    bool is_longer = frame_waits_ns > 0 && time_ns > 0; /* 0: it only looks */
    return __real_isolate_process_wait_until_ns(self, is_longer ? clock_now_ns() + frame_waits_ns
                                                                : time_ns);
}

static void every_shipped_mapping_gives_the_same_bits(void **state)
{
    (void)state;
    uint32_t count = 0;
    plugin_list list = {0};
    struct dirent **entry = NULL;
    char folder[1024], path[2048];
    (void)snprintf(folder, sizeof folder, "%s/plugins", BUILD_DIR);
    int entries = scandir(folder, &entry, NULL, alphasort);
    assert_true(entries > 0);
    for (int i = 0; i < entries; ++i) {
        error err = {""};
        char *dot = strrchr(entry[i]->d_name, '.');
        (void)snprintf(path, sizeof path, "%s/%s", folder, entry[i]->d_name);
        if (dot && strcmp(dot, ".so") == 0 && plugin_list_add(&list, path, &err) >= 0) {
            const mrt_plugin_type *type = list.entry[list.entry_count - 1].type;
            *dot = '\0';
            if (plugin_interface(type, MRT_MAPPING)) {
                check_same_bits(entry[i]->d_name, "");
                count += 1;
            }
        }
        free(entry[i]);
    }
    free(entry);
    assert_true(count >= 3);
    plugin_list_destroy(&list);
}

static void its_words_and_its_parameters_come_through(void **state)
{
    (void)state;
    stand s;
    const isolate_settings settings = {.clock = CLOCK_REAL, .deadline_ns = NS_PER_S};
    stand_up(&s, TROUBLED, "gain=1", &settings);
    assert_true(stand_hears(&s, "active on 0 contacts"));
    for (uint32_t n = 0; n <= 40; ++n)
        stand_step(&s, n);
    mrt_pull once = *layer_pull(s.performer->voice[0].layer);
    stand_set(&s, "gain=2");
    stand_step(&s, 40);
    const mrt_pull *twice = layer_pull(s.performer->voice[0].layer);
    float furthest = 0;
    for (int i = 0; i < 5; ++i) {
        float way = once.vector[i].end.z - once.vector[i].start.z;
        furthest = fmaxf(furthest, fabsf(way));
        assert_float_equal(twice->vector[i].end.z - twice->vector[i].start.z, 2 * way, 0.05);
    }
    assert_true(furthest > 0.5f);
    stand_lie_down(&s);
}

/* ---- poses of the rig ---- */

static void check_same_pull(stand *s, stand *other, uint32_t n)
{
    const mrt_pull *a = layer_pull(s->performer->voice[0].layer),
                   *b = layer_pull(other->performer->voice[0].layer);
    if (a->count == 0 || memcmp(a, b, sizeof *a) != 0)
        fail_msg("the pull of sample %u differs", n);
}

/* Beside one in this process; the child is killed in between, and the new one has the poses too. */
static void a_pose_of_the_rig_is_the_same_in_a_process_of_its_own(void **state)
{
    (void)state;
    stand s, other;
    const isolate_settings settings = {.clock = CLOCK_REAL, .deadline_ns = NS_PER_S};
    stand_up_on(&s, "puppet", POSER, "pose=2", &settings);
    stand_up_on(&other, "puppet", POSER, "pose=2", NULL);
    uint32_t n = 0;
    for (; n < 40; ++n) {
        if (n == 20) {
            stand_set(&s, "pose=5");
            stand_set(&other, "pose=5");
        }
        stand_step(&s, n);
        stand_step(&other, n);
        check_same_pull(&s, &other, n);
    }
    assert_int_equal(kill(isolate_pid(s.mapping.self), SIGKILL), 0);
    int64_t end_ns = clock_now_ns() + stand_patience_ns;
    for (; stand_counts(&s).failed == 0 && clock_now_ns() < end_ns; ++n) {
        stand_step(&s, n);
        stand_step(&other, n);
    }
    stand_wait_for(&s, 1);
    for (uint32_t end = n + 60; n < end; ++n) {
        stand_step(&s, n);
        stand_step(&other, n);
    }
    for (uint32_t end = n + 20; n < end; ++n) {
        stand_step(&s, n);
        stand_step(&other, n);
        check_same_pull(&s, &other, n);
    }
    stand_lie_down(&s);
    stand_lie_down(&other);
}

static void a_mesh_without_a_rig_has_no_poses_there_either(void **state)
{
    (void)state;
    stand s;
    const isolate_settings settings = {.clock = CLOCK_REAL, .deadline_ns = NS_PER_S};
    stand_up_on(&s, "plane", POSER, "", &settings);
    for (uint32_t n = 0; n < 5; ++n)
        stand_step(&s, n);
    assert_int_equal(layer_pull(s.performer->voice[0].layer)->count, 0);
    assert_int_equal(stand_counts(&s).failed, 0);
    stand_lie_down(&s);
}

static void more_poses_than_the_block_holds_are_refused_in_words(void **state)
{
    (void)state;
    enum { CONTACTS = 64, POSES = 2000 };
    static const mrt_vec3 pulls[CONTACTS];
    static mrt_contact contacts[CONTACTS];
    static mrt_rig_pose poses[POSES];
    stand s = {.log = log_queue_create()};
    error err = {""};
    const isolate_settings settings = {.clock = CLOCK_REAL, .deadline_ns = NS_PER_S};
    for (int i = 0; i < CONTACTS; ++i)
        contacts[i] = (mrt_contact){"contact", "skull", {0, (float)i, 0}, {0, 0, 1}};
    for (int i = 0; i < POSES; ++i)
        poses[i] = (mrt_rig_pose){"pose", pulls, NULL, MRT_POSE_WHOLE};
    mapped_face mapped = {.about = {.contacts = contacts,
                                    .contact_count = CONTACTS,
                                    .low = {-80, 0, -80},
                                    .high = {80, 200, 80}},
                          .pose = poses,
                          .pose_count = POSES};
    const mrt_plugin_type *type = stand_load(&s, POSER);
    scene_must(isolate_create_mapping(&s.isolate, type, POSER, &settings, &err), &err);
    scene_must(instance_create(&s.mapping, isolate_type(s.isolate), CLOCK_REAL, s.log, &err), &err);
    assert_true(instance_activate(&s.mapping, &mapped, &err) < 0);
    assert_non_null(strstr(err.text, "the rig has too many poses for an isolated mapping"));
    mapped.pose_count = 100;
    scene_must(instance_activate(&s.mapping, &mapped, &err), &err);
    instance_deactivate(&s.mapping);
    instance_destroy(&s.mapping);
    isolate_destroy(s.isolate);
    plugin_list_destroy(&s.plugins);
    log_queue_destroy(s.log);
}

static void a_plugin_that_cannot_be_created_says_why(void **state)
{
    (void)state;
    error err = {""};
    plugin_list list = {0};
    const mrt_plugin_type *type;
    const char *path = BUILD_DIR "/tests/plugin/troubled_refuses.so";
    const isolate_settings settings = {.clock = CLOCK_REAL};
    isolate *apart;
    instance made;
    scene_must(plugin_list_choose(&list, path, MRT_MAPPING, &type, &err), &err);
    scene_must(isolate_create_mapping(&apart, type, path, &settings, &err), &err);
    assert_true(instance_create(&made, isolate_type(apart), CLOCK_REAL, NULL, &err) < 0);
    assert_non_null(strstr(err.text, "no licence for this machine"));
    isolate_destroy(apart);
    plugin_list_destroy(&list);
}

/* ---- trouble ---- */

/* From sample 40 on it is in trouble; after the failure the trouble is over. */
static void check_trouble(const char *trouble, const char *reason)
{
    stand s, other;
    stand_watch watch = {0};
    char set[64];
    bool is_silent = strcmp(trouble, "hang") == 0 || strcmp(trouble, "stuck") == 0;
    const isolate_settings settings = {
        .clock = CLOCK_REAL, .deadline_ns = NS_PER_S, .writes_reports = true};
    stand_up(&s, TROUBLED, "", &settings);
    stand_up(&other, TROUBLED, "", NULL);
    stand_watch_begin(&watch, stand_furthest_step(TROUBLED, "", 500));
    (void)snprintf(set, sizeof set, "trouble=%s", trouble);
    uint32_t n = 0;
    for (; n < 40; ++n) {
        stand_step(&s, n);
        stand_step(&other, n);
        stand_watch_step(&watch, &s, &other);
    }
    assert_false(stand_counts(&s).is_away);
    mrt_pull before = *layer_pull(s.performer->voice[0].layer);
    stand_set(&s, set);
    frame_waits_ns = is_silent ? 0 : frame_waits_ns;
    stand_step(&s, n);
    assert_memory_equal(layer_pull(s.performer->voice[0].layer), &before, sizeof before); /* held */
    stand_step(&other, n++);
    stand_watch_step(&watch, &s, &other);
    for (; !stand_counts(&s).is_away && n < 450; ++n) { /* it hangs only after a while */
        clock_sleep_until_ns(clock_now_ns() + 20 * NS_PER_MS);
        stand_step(&s, n);
        stand_step(&other, n);
        stand_watch_step(&watch, &s, &other);
    }
    assert_true(stand_counts(&s).is_away);
    frame_waits_ns = stand_patience_ns;
    stand_set(&s, "trouble=none");
    stand_wait_for(&s, 1);
    assert_true(stand_hears(&s, reason));
    assert_true(stand_hears(&s, "its last inputs are saved in "));
    for (uint32_t end = n + 60; n < end; ++n) {
        stand_step(&s, n);
        stand_step(&other, n);
        stand_watch_step(&watch, &s, &other);
    }
    assert_false(stand_counts(&s).is_away);
    /* It has its anchor of before: it pulls as if nothing had happened. */
    assert_memory_equal(layer_pull(s.performer->voice[0].layer)->vector,
                        layer_pull(other.performer->voice[0].layer)->vector,
                        sizeof(mrt_vector) * 5);
    assert_true(stand_distance(&watch.before, &watch.ought_before) < 1e-3);
    if (watch.worst_excess_mm > 0)
        fail_msg("%s: the face jumped by %.3f mm more than it may", trouble, watch.worst_excess_mm);
    stand_watch_finish(&watch);
    stand_lie_down(&s);
    stand_lie_down(&other);
}

static void a_crash_is_held_and_restarted(void **state)
{
    (void)state;
    check_trouble("crash", "was ended by signal 11");
}

static void a_hang_is_held_and_restarted(void **state)
{
    (void)state;
    check_trouble("hang", "did not answer for ");
}

static void one_that_is_stuck_is_held_and_restarted(void **state)
{
    (void)state;
    check_trouble("stuck", "did not answer for ");
}

static void nonsense_is_held_and_restarted(void **state)
{
    (void)state;
    check_trouble("nonsense", "gave a control vector that is not finite");
}

static void one_that_leaves_is_held_and_restarted(void **state)
{
    (void)state;
    check_trouble("leave", "ended its process with code 3");
}

static void one_that_refuses_frames_is_held_and_restarted(void **state)
{
    (void)state;
    check_trouble("refuse", "returned -2");
}

/* ---- late ---- */

/* At most so many samples, by which it has recovered or will not. */
enum { LATE_SAMPLES = 4000 };

static bool pull_is(const stand *s, const mrt_pull *pull)
{
    return memcmp(layer_pull(s->performer->voice[0].layer)->vector, pull->vector,
                  sizeof(mrt_vector) * 5) == 0;
}

static void step_both(stand *s, stand *other, stand_watch *watch, uint32_t n)
{
    clock_sleep_until_ns(clock_now_ns() + 4 * NS_PER_MS);
    stand_step(s, n);
    stand_step(other, n);
    stand_watch_step(watch, s, other);
}

/* From sample 40 on each answer is late; the face follows all the same, in its way. */
static void check_late(const char *trouble)
{
    stand s, other;
    stand_watch watch = {0};
    uint32_t n = 0, changes = 0;
    const isolate_settings settings = {.clock = CLOCK_REAL, .deadline_ns = 5 * NS_PER_MS};
    stand_up(&s, TROUBLED, "", &settings);
    stand_up(&other, TROUBLED, "", NULL);
    bool is_told = false;
    stand_watch_begin(&watch, stand_furthest_step(TROUBLED, "", 500));
    for (; n < 40; ++n)
        step_both(&s, &other, &watch, n);
    stand_set(&s, trouble);
    frame_waits_ns = 0;
    for (; n < LATE_SAMPLES && !(is_told && changes >= 8); ++n) {
        mrt_pull before = *layer_pull(s.performer->voice[0].layer);
        step_both(&s, &other, &watch, n);
        changes += !pull_is(&s, &before);
        is_told = is_told || stand_has_heard(&s, "often answers late");
    }
    frame_waits_ns = stand_patience_ns;
    assert_true(is_told && changes >= 8);
    assert_true(stand_counts(&s).late > 8);
    stand_set(&s, "trouble=none");
    bool is_there = false;
    for (uint32_t end = n + LATE_SAMPLES; !is_there && n < end; ++n) {
        step_both(&s, &other, &watch, n);
        is_there = pull_is(&s, layer_pull(other.performer->voice[0].layer));
    }
    assert_true(is_there);
    assert_int_equal(stand_counts(&s).failed, 0);
    assert_false(stand_counts(&s).is_away);
    if (watch.worst_excess_mm > 0)
        fail_msg("%s: the face jumped by %.3f mm more than it may", trouble, watch.worst_excess_mm);
    stand_watch_finish(&watch);
    stand_lie_down(&s);
    stand_lie_down(&other);
}

static void a_slow_one_is_held_and_followed(void **state)
{
    (void)state;
    check_late("trouble=slow");
}

static void one_that_sleeps_is_held_and_followed(void **state)
{
    (void)state;
    check_late("trouble=sleep");
}

static void a_reset_of_one_that_is_late_forgets(void **state)
{
    (void)state;
    stand s;
    const isolate_settings settings = {.clock = CLOCK_REAL, .deadline_ns = 5 * NS_PER_MS};
    uint32_t n = 0;
    stand_up(&s, TROUBLED, "", &settings);
    for (; n < 40; ++n)
        stand_step(&s, n);
    stand_set(&s, "trouble=sleep");
    frame_waits_ns = 0;
    stand_step(&s, n++);
    frame_waits_ns = stand_patience_ns;
    stand_set(&s, "trouble=none");
    layer_reset(s.performer->voice[0].layer);
    const mrt_vector *v = layer_pull(s.performer->voice[0].layer)->vector;
    bool is_anew = false;
    int64_t end_ns = clock_now_ns() + stand_patience_ns;
    while (!is_anew && clock_now_ns() < end_ns) {
        clock_sleep_until_ns(clock_now_ns() + 2 * NS_PER_MS);
        stand_step(&s, n++);
        is_anew = layer_pull(s.performer->voice[0].layer)->count == 5 &&
                  memcmp(&v[1].start, &v[1].end, sizeof v[1].end) == 0;
    }
    assert_true(is_anew); /* it has taken hold anew, and never gave what was owed from before */
    assert_int_equal(stand_counts(&s).failed, 0);
    stand_lie_down(&s);
}

/* ---- what becomes of it ---- */

static void a_second_failure_within_a_minute_leaves_the_face_held(void **state)
{
    (void)state;
    stand s;
    const isolate_settings settings = {.clock = CLOCK_REAL, .deadline_ns = NS_PER_S};
    uint32_t n = 0;
    stand_up(&s, TROUBLED, "", &settings);
    for (; n < 10; ++n)
        stand_step(&s, n);
    stand_set(&s, "trouble=crash");
    stand_step(&s, n++);
    stand_wait_for(&s, 1); /* and crashes again */
    for (; n < 60; ++n)
        stand_step(&s, n);
    assert_true(stand_hears(&s, "twice within a minute"));
    assert_int_equal(stand_counts(&s).failed, 2);
    assert_int_equal(stand_counts(&s).restarted, 1);
    stand_set(&s, "trouble=none");
    mrt_pull before = *layer_pull(s.performer->voice[0].layer);
    for (; n < 100; ++n)
        stand_step(&s, n);
    assert_true(stand_counts(&s).is_away);
    assert_int_equal(layer_pull(s.performer->voice[0].layer)->mode, MRT_ANCHORED);
    assert_memory_equal(layer_pull(s.performer->voice[0].layer), &before, sizeof before);
    assert_int_equal(performer_save(s.performer, NULL, 0), 0); /* nothing to take up */
    stand_lie_down(&s);
}

static void a_reset_while_it_is_away_forgets(void **state)
{
    (void)state;
    stand s;
    const isolate_settings settings = {.clock = CLOCK_REAL, .deadline_ns = NS_PER_S};
    uint32_t n = 0;
    stand_up(&s, TROUBLED, "", &settings);
    for (; n < 40; ++n)
        stand_step(&s, n);
    stand_set(&s, "trouble=crash");
    stand_step(&s, n);
    stand_set(&s, "trouble=none");
    stand_wait_for(&s, 1);
    layer_reset(s.performer->voice[0].layer);
    stand_step(&s, n++);
    const mrt_vector *v = layer_pull(s.performer->voice[0].layer)->vector;
    assert_int_equal(layer_pull(s.performer->voice[0].layer)->count, 5);
    assert_memory_equal(&v[1].start, &v[1].end, sizeof v[1].end); /* it takes hold anew */
    stand_lie_down(&s);
}

/* Of the reports that the tests above have left. */
static void the_report_has_what_it_saw_and_why(void **state)
{
    (void)state;
    error err = {""};
    struct dirent **entry = NULL;
    uint32_t crashes = 0;
    char path[4096];
    (void)snprintf(path, sizeof path, "%s/marotte/reports", reports);
    int count = scandir(path, &entry, NULL, alphasort);
    for (int i = 0; i < count; ++i) {
        file_bytes words = {0}, hand = {0};
        if (entry[i]->d_name[0] == '.')
            continue;
        (void)snprintf(path, sizeof path, "%s/marotte/reports/%s/report.txt", reports,
                       entry[i]->d_name);
        scene_must(file_read(&words, path, 1 << 20, &err), &err);
        (void)snprintf(path, sizeof path, "%s/marotte/reports/%s/right.csv", reports,
                       entry[i]->d_name);
        scene_must(file_read(&hand, path, 1 << 20, &err), &err);
        const char *text = (const char *)words.data;
        assert_non_null(strstr(text, "plugin: org.example.troubled 1\n"));
        assert_non_null(strstr(text, "parameter: Pull/Gain = 0.40000000000000002"));
        crashes += strstr(text, "reason: was ended by signal 11") != NULL;
        const char *line = (const char *)hand.data;
        assert_memory_equal(line, "time_ns,right.thumb.roll,", 25);
        uint32_t lines = 0;
        for (; (line = strchr(line, '\n')) != NULL; ++line)
            lines += 1;
        if (lines < 42 || lines > 200)
            fail_msg("%s: %u lines", path, lines);
        /* 40 samples, the one it failed in, a head */
        file_bytes_finish(&words);
        file_bytes_finish(&hand);
    }
    for (int i = 0; i < count; ++i)
        free(entry[i]);
    free(entry);
    assert_int_equal(crashes, 1);
}

/* ---- killed at random instants ---- */

static void kills_never_make_the_face_jump(void **state)
{
    (void)state;
    uint32_t kills = is_long ? 200 : 10, seed = 20261121, held = 0;
    stand_watch watch = {0};
    double worst_ms = 0, furthest_mm = stand_furthest_step(TROUBLED, "", 120);
    for (uint32_t kill_at = 0; kill_at < kills; ++kill_at) {
        stand s, other;
        const isolate_settings settings = {.clock = CLOCK_REAL};
        stand_up(&s, TROUBLED, "", &settings);
        stand_up(&other, TROUBLED, "", NULL);
        seed = seed * 1664525u + 1013904223u;
        uint32_t at = 5 + (seed >> 8) % 60;
        int64_t within_ns = (int64_t)((seed >> 4) % 2000) * 1000; /* of the period of that sample */
        stand_watch_begin(&watch, furthest_mm);
        int64_t start_ns = clock_now_ns();
        uint32_t n = 0;
        bool is_killed = false;
        for (; n < 120 ||
               (stand_counts(&s).failed == 0 && clock_now_ns() < start_ns + stand_patience_ns);
             ++n) {
            clock_sleep_until_ns(start_ns + (int64_t)n * 2 * NS_PER_MS);
            if (n == at && within_ns % 2) /* between two samples, or just before one */
                clock_sleep_until_ns(clock_now_ns() + within_ns);
            if (n >= at && !is_killed && isolate_pid(s.mapping.self) > 0)
                is_killed = kill(isolate_pid(s.mapping.self), SIGKILL) == 0;
            int64_t before_ns = clock_now_ns();
            stand_step(&s, n);
            worst_ms = fmax(worst_ms, (double)(clock_now_ns() - before_ns) * 1e-6);
            stand_step(&other, n);
            stand_watch_step(&watch, &s, &other);
        }
        held += stand_counts(&s).failed;
        assert_true(stand_counts(&s).failed >= 1);
        assert_int_equal(s.performer->counts->samples, n);
        if (watch.worst_excess_mm > 0)
            fail_msg("kill %u at sample %u: the face jumped by %.3f mm more than it may", kill_at,
                     at, watch.worst_excess_mm);
        stand_lie_down(&s);
        stand_lie_down(&other);
    }
    print_message("%u kills, %u failures, worst sample %.2f ms, furthest step of the hand's own "
                  "%.3f mm\n",
                  kills, held, worst_ms, watch.furthest_step_mm);
    stand_watch_finish(&watch);
}

int main(int argc, char **argv)
{
    is_long = argc > 1 && strcmp(argv[1], "--long") == 0;
    if (!mkdtemp(reports) || setenv("XDG_DATA_HOME", reports, 1) != 0)
        return 1;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_shipped_mapping_gives_the_same_bits),
        cmocka_unit_test(its_words_and_its_parameters_come_through),
        cmocka_unit_test(a_pose_of_the_rig_is_the_same_in_a_process_of_its_own),
        cmocka_unit_test(a_mesh_without_a_rig_has_no_poses_there_either),
        cmocka_unit_test(more_poses_than_the_block_holds_are_refused_in_words),
        cmocka_unit_test(a_plugin_that_cannot_be_created_says_why),
        cmocka_unit_test(a_crash_is_held_and_restarted),
        cmocka_unit_test(a_hang_is_held_and_restarted),
        cmocka_unit_test(one_that_is_stuck_is_held_and_restarted),
        cmocka_unit_test(a_slow_one_is_held_and_followed),
        cmocka_unit_test(one_that_sleeps_is_held_and_followed),
        cmocka_unit_test(a_reset_of_one_that_is_late_forgets),
        cmocka_unit_test(nonsense_is_held_and_restarted),
        cmocka_unit_test(one_that_leaves_is_held_and_restarted),
        cmocka_unit_test(one_that_refuses_frames_is_held_and_restarted),
        cmocka_unit_test(a_second_failure_within_a_minute_leaves_the_face_held),
        cmocka_unit_test(a_reset_while_it_is_away_forgets),
        cmocka_unit_test(the_report_has_what_it_saw_and_why),
        cmocka_unit_test(kills_never_make_the_face_jump),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
