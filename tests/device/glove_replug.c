/* A glove that is unplugged and plugged in again, 25 times in a row (in ./test --long 100:
 * MAROTTE_REPLUGS), while it performs the puppet: nothing crashes, leaks or jumps. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/clock.h"
#include "glove_child.h"
#include "glove_watch.h"
#include "unit/player_run.h"

#include <dirent.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { REPLUGS = 25, WARM_UP = 5, PATIENCE_S = 60 };
enum { RESIDENT_ONCE_KB = 512, RESIDENT_EACH_KB = 36 }; /* what replugs may add: 4 MB in 100 */
/* Every fifth life is long enough for the whole ease: 250 ms, and 50 records at 150 Hz. */
enum { SHORT_LIFE = 10, LONG_LIFE = 50, LONG_EVERY = 5, EASED_AFTER = 45 };

#define PUPPET SOURCE_DIR "/rigs/puppet/puppet.rig.json"

/* The sweep moves a sensor by at most 0.63 counts a millisecond, 4.2 a record, and a count is at
 * most 0.02 rad. A way of up to 5 rad is eased over 250 ms, at most 1.5 times as fast as evenly. */
static const double STEP_MAX_RAD = 4.2 * 0.02 + 5.0 * 1.5 * 6.7 / 250.0 + 0.02;
static const double WAY_MIN_RAD = 1.0; /* what would be seen without an ease, at least once */
static const int64_t away_ns = 260 * NS_PER_MS; /* a shorter gap is none to ease over */

typedef struct seen {
    _Atomic uint64_t pull_count;
    _Atomic uint32_t went_count, returned_count;
    bool has_last;
    mrt_frame last, before_gap;
    uint32_t since_gap, still_count; /* still_count: records of one time */
    double worst_way_rad;
    double worst_step_rad;
} seen;

/* The greatest difference between two poses of the hand. */
static double way_between(const mrt_frame *a, const mrt_frame *b)
{
    double way_rad = 0;
    for (int i = 0; i < MRT_ANGLES; ++i)
        way_rad = fmax(way_rad,
                       fabs((double)(a->hand[MRT_RIGHT].angle[i] - b->hand[MRT_RIGHT].angle[i])));
    return way_rad;
}

/* A step after a gap is a step from the pose that was held. Records may be missing within a life:
 * the hand has then gone on for longer; so it has while time stood still, as after a first record
 * that came late on a busy machine: a filter goes by time. */
static void see_step(seen *self, const mrt_frame *frame)
{
    int64_t gap_ns = frame->time_ns - self->last.time_ns;
    double record_count = gap_ns < away_ns ? fmax(1.0, (double)gap_ns / 6.7e6) : 1.0;
    record_count += self->still_count;
    self->still_count = gap_ns < NS_PER_MS ? self->still_count + 1 : 0;
    double step_rad = way_between(frame, &self->last) / record_count;
    self->worst_step_rad = fmax(self->worst_step_rad, step_rad);
    if (gap_ns >= away_ns) {
        self->before_gap = self->last;
        self->since_gap = 0;
    }
    if (++self->since_gap == EASED_AFTER)
        self->worst_way_rad = fmax(self->worst_way_rad, way_between(frame, &self->before_gap));
}

static void see_pull(void *data, const mrt_frame *frame, const mrt_pull *pull, int64_t done_ns)
{
    (void)pull;
    (void)done_ns;
    seen *self = data;
    if (self->has_last)
        see_step(self, frame);
    self->last = *frame;
    self->has_last = true;
    atomic_fetch_add(&self->pull_count, 1);
}

static mrt_result see_frame(void *data, uint32_t index, double time_s, int64_t work_ns, error *err)
{
    (void)data;
    (void)index;
    (void)time_s;
    (void)work_ns;
    (void)err;
    return MRT_OK;
}

static void see_incident(void *data, const input *from, const input_incident *what, double time_s)
{
    (void)from;
    (void)time_s;
    seen *self = data;
    if (what->kind == INPUT_WAS_LOST)
        atomic_fetch_add(&self->went_count, 1);
    else if (what->kind == INPUT_IS_BACK)
        atomic_fetch_add(&self->returned_count, 1);
}

typedef struct performance {
    glove_stage stage;
    seen seen;
    _Atomic bool stop;
    player_report report;
    mrt_result result;
    error err;
} performance;

static void *perform(void *data)
{
    performance *self = data;
    player_settings settings = {.fps = 60, .clock = CLOCK_REAL, .stop = &self->stop};
    player_events events = {.frame = see_frame, .incident = see_incident, .data = &self->seen};
    self->result = player_run(self->stage.performer, &self->stage.input, 1, &settings, &events,
                              &self->report, &self->err);
    return NULL;
}

static bool wait_until(const _Atomic uint32_t *count, uint32_t wanted)
{
    int64_t end_ns = clock_now_ns() + PATIENCE_S * NS_PER_S;
    while (atomic_load(count) < wanted && clock_now_ns() < end_ns)
        clock_sleep_until_ns(clock_now_ns() + 5 * NS_PER_MS);
    return atomic_load(count) >= wanted;
}

static bool wait_for_samples(const seen *self, uint32_t count)
{
    uint64_t wanted = atomic_load(&self->pull_count) + count;
    int64_t end_ns = clock_now_ns() + PATIENCE_S * NS_PER_S;
    while (atomic_load(&self->pull_count) < wanted && clock_now_ns() < end_ns)
        clock_sleep_until_ns(clock_now_ns() + 5 * NS_PER_MS);
    return atomic_load(&self->pull_count) >= wanted;
}

static int open_files(void)
{
    int count = 0;
    DIR *folder = opendir("/proc/self/fd");
    assert_non_null(folder);
    while (readdir(folder))
        ++count;
    closedir(folder);
    return count;
}

static long resident_kb(void)
{
    long pages = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    assert_non_null(file);
    assert_int_equal(fscanf(file, "%*s %ld", &pages), 1);
    fclose(file);
    return pages * (sysconf(_SC_PAGESIZE) / 1024);
}

static void replug(glove_child *child, seen *self, uint32_t turn)
{
    error err = {""};
    glove_child_say(child, "unplug");
    if (!wait_until(&self->went_count, turn))
        fail_msg("loss %u was not noticed", turn);
    clock_sleep_until_ns(clock_now_ns() + away_ns);
    glove_child_say(child, "plug");
    if (glove_child_wait_ready(child, &err) < 0)
        fail_msg("%s", err.text);
    if (!wait_until(&self->returned_count, turn))
        fail_msg("return %u was not noticed", turn);
    if (!wait_for_samples(self, turn % LONG_EVERY == 0 ? LONG_LIFE : SHORT_LIFE))
        fail_msg("no samples after return %u", turn);
}

static void a_glove_comes_back_each_time(void **state)
{
    (void)state;
    static performance p;
    const char *more = getenv("MAROTTE_REPLUGS");
    const uint32_t replugs = more ? (uint32_t)strtoul(more, NULL, 10) : REPLUGS;
    glove_child child;
    error err = {""};
    pthread_t thread;
    glove_watch watch = {.pull = see_pull, .data = &p.seen};
    mrt_result result = glove_child_start(&child, BUILD_DIR "/tests/device/glove_emulator",
                                          (const char *const[]){"--motion", "sweep", NULL}, &err);
    if (result == MRT_ERR_UNSUPPORTED) {
        print_message("SKIPPED: there are no pseudo terminals here\n");
        skip();
    }
    if (result < 0 ||
        glove_stage_create(&p.stage, BUILD_DIR, PUPPET, child.address, &watch, &err) < 0)
        fail_msg("%s", err.text);
    input_set_patience_ns(p.stage.input, 50 * NS_PER_MS, 50 * NS_PER_MS);
    assert_int_equal(pthread_create(&thread, NULL, perform, &p), 0);
    assert_true(wait_for_samples(&p.seen, LONG_LIFE));

    int files = 0;
    long resident = 0;
    int64_t start_ns = clock_now_ns();
    for (uint32_t turn = 1; turn <= replugs; ++turn) {
        if (turn == WARM_UP + 1) {
            files = open_files();
            resident = resident_kb();
        }
        replug(&child, &p.seen, turn);
    }
    int files_after = open_files();
    long resident_after = resident_kb();
    double turn_s = (double)(clock_now_ns() - start_ns) * 1e-9 / replugs;
    atomic_store(&p.stop, true);
    pthread_join(thread, NULL);
    print_message("  %u replugs, %.0f ms each; files %d -> %d, memory %ld -> %ld kB; greatest step "
                  "%.3f rad, way %.1f rad\n",
                  replugs, turn_s * 1e3, files, files_after, resident, resident_after,
                  p.seen.worst_step_rad, p.seen.worst_way_rad);

    if (p.result < 0)
        fail_msg("%s", p.err.text);
    assert_int_equal(p.report.went_count, replugs);
    assert_int_equal(p.report.returned_count, replugs);
    assert_false(p.report.input_failed);
    assert_int_equal(p.report.refused, 0);
    assert_int_equal(p.stage.performer->counts->bad_pulls, 0);
    assert_int_equal(files_after, files);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) /* they keep what was freed */
    assert_true(resident_after - resident < RESIDENT_ONCE_KB + RESIDENT_EACH_KB * (long)replugs);
#endif
    assert_true(p.seen.worst_step_rad < STEP_MAX_RAD);
    assert_true(p.seen.worst_way_rad > WAY_MIN_RAD);
    glove_stage_destroy(&p.stage);
    assert_true(glove_child_stop(&child));
    glove_child_finish(&child);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_glove_comes_back_each_time),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
