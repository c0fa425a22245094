/* A performance whose devices go away and come back: it goes on, nothing leaks, no pedal stays
 * down, nothing jumps, it ends as it should. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "unit/player_run.h"
#include "unit/allocation_count.h"
#include "unit/input_help.h"

#include <math.h>

/* ---- a flat face, and a mapping that pulls it by the thumb and keeps what it saw ---- */

enum { GRID = 9, DELAYS_MAX = 20000 };

typedef struct seen {
    uint32_t samples, presses, releases;
    float first_rad, last_rad, largest_step_rad, pedal;
    float release_step_rad; /* of the sample in which the pedal went up */
    int64_t last_ns;
    double longest_gap_s;
    int64_t delay_ns[DELAYS_MAX]; /* from the sample's time to process() */
} seen;

static seen saw; /* by the mapping: one test at a time */

struct mrt_plugin {
    uint32_t anchor;
};

static mrt_plugin *create(const mrt_host *host)
{
    (void)host;
    return calloc(1, sizeof(mrt_plugin));
}

static void destroy(mrt_plugin *self)
{
    free(self);
}

static mrt_result activate(mrt_plugin *self, const mrt_face *about)
{
    (void)self;
    (void)about;
    return MRT_OK;
}

static void deactivate(mrt_plugin *self)
{
    (void)self;
}

static void reset(mrt_plugin *self)
{
    self->anchor = 1;
}

static mrt_result follow(mrt_plugin *self, const mrt_frame *frame, mrt_pull *pull)
{
    float rad = frame->hand[MRT_RIGHT].angle[1];
    if (saw.samples < DELAYS_MAX)
        saw.delay_ns[saw.samples] = clock_now_ns() - frame->time_ns;
    if (saw.samples++ == 0) {
        saw.first_rad = saw.last_rad = rad;
        saw.last_ns = frame->time_ns;
    }
    saw.largest_step_rad = fmaxf(saw.largest_step_rad, fabsf(rad - saw.last_rad));
    saw.longest_gap_s = fmax(saw.longest_gap_s, (double)(frame->time_ns - saw.last_ns) / 1e9);
    saw.presses += frame->pedal[0] > 0.5f && saw.pedal < 0.5f;
    if (frame->pedal[0] < 0.5f && saw.pedal > 0.5f) {
        saw.releases += 1;
        saw.release_step_rad = fabsf(rad - saw.last_rad);
    }
    saw.last_rad = rad;
    saw.last_ns = frame->time_ns;
    saw.pedal = frame->pedal[0];
    pull->mode = MRT_ANCHORED;
    pull->anchor = self->anchor;
    pull->radius_mm = 35.0f;
    pull->count = 1;
    pull->vector[0] = (mrt_vector){{40, 40, 0}, {40, 40, 10.0f * rad}, 0};
    return MRT_OK;
}

static const mrt_mapping mapping_functions = {activate, deactivate, reset, follow};
static const mrt_interface interfaces[] = {{MRT_MAPPING, &mapping_functions}, {NULL, NULL}};
static const mrt_plugin_type follow_type = {MRT_ABI,  0,   NULL, interfaces, "test.follow",
                                            "Follow", "1", "",   create,     destroy};

static void make_face(face_file *file)
{
    error err;
    mesh *out = &file->mesh;
    *file = (face_file){0};
    assert_int_equal(mesh_create(out, GRID * GRID, 2 * (GRID - 1) * (GRID - 1), &err), MRT_OK);
    for (uint32_t i = 0; i < GRID * GRID; ++i) {
        out->position[3 * i] = (float)(i % GRID) * 10.0f;
        out->position[3 * i + 1] = (float)(i / GRID) * 10.0f;
    }
    uint32_t *t = out->triangle;
    for (uint32_t y = 0; y + 1 < GRID; ++y)
        for (uint32_t x = 0; x + 1 < GRID; ++x, t += 6) {
            uint32_t a = y * GRID + x;
            const uint32_t quad[6] = {a, a + 1, a + GRID + 1, a, a + GRID + 1, a + GRID};
            memcpy(t, quad, sizeof quad);
        }
}

/* ---- one performance ---- */

typedef struct outcome {
    player_report report;
    uint64_t allocations; /* between the first and the last frame, of all threads */
    uint64_t first_count;
    uint32_t went, came, frames_away;
    bool is_told_twice;
    _Atomic bool is_enough; /* ends the performance */
} outcome;

enum { FRAMES_AWAY = 30 };

static mrt_result on_frame(void *data, uint32_t index, double time_s, int64_t work_ns, error *err)
{
    (void)time_s;
    (void)work_ns;
    (void)err;
    outcome *out = data;
    uint64_t count = atomic_load(&allocation_count);
    if (index == 0)
        out->first_count = count;
    out->allocations = count - out->first_count;
    out->frames_away += out->went > out->came;
    out->is_enough = out->frames_away >= FRAMES_AWAY;
    return MRT_OK;
}

static void on_incident(void *data, const input *from, const input_incident *what, double time_s)
{
    outcome *out = data;
    assert_non_null(strstr(input_name(from), "flaky"));
    assert_true(time_s > -1.0 && time_s < 100.0);
    out->went += what->kind == INPUT_WAS_LOST;
    out->came += what->kind == INPUT_IS_BACK;
    out->is_told_twice |= out->came > out->went;
}

/* seconds: at most; 0: until the devices end. */
static void perform(const flaky_library *library, outcome *out, const char *const *params,
                    uint32_t input_count, double seconds)
{
    error err = {""};
    face_file file;
    instance mapping;
    performer *p;
    input *inputs[2];
    saw = (seen){.samples = 0};
    *out = (outcome){.went = 0};
    make_face(&file);
    for (uint32_t i = 0; i < input_count; ++i)
        inputs[i] = flaky_input(library, i ? "second" : "first", params[i]);
    assert_int_equal(instance_create(&mapping, &follow_type, CLOCK_REAL, library->log, &err),
                     MRT_OK);
    performer_settings settings = {.hand_length_mm = 0};
    assert_int_equal(performer_create(&p, &file, &mapping, &settings, &err), MRT_OK);
    player_settings player = {.fps = 100, .seconds = seconds, .clock = CLOCK_REAL};
    if (seconds > 0)
        player.stop = &out->is_enough;
    player_events events = {.frame = on_frame, .incident = on_incident, .data = out};
    assert_int_equal(player_run(p, inputs, input_count, &player, &events, &out->report, &err),
                     MRT_OK);
    assert_int_equal(p->counts->bad_pulls, 0);
    performer_destroy(p);
    instance_destroy(&mapping);
    for (uint32_t i = 0; i < input_count; ++i)
        input_destroy(inputs[i]);
    face_file_destroy(&file);
}

static int compare_ns(const void *a, const void *b)
{
    const int64_t *x = a, *y = b;
    return (*x > *y) - (*x < *y);
}

static void print_delays(void)
{
    uint32_t count = saw.samples < DELAYS_MAX ? saw.samples : DELAYS_MAX;
    qsort(saw.delay_ns, count, sizeof *saw.delay_ns, compare_ns);
    print_message("%u samples, from their time to the mapping: median %.3f ms, 99 %% %.3f ms\n",
                  saw.samples, (double)saw.delay_ns[count / 2] / 1e6,
                  (double)saw.delay_ns[count * 99 / 100] / 1e6);
}

static void a_hundred_losses_in_a_row_leave_no_trace(void **state)
{
    const char *params[] = {"rate=1000,pedal=1,run=0.008,away=0.003,losses=100,after=0.02"};
    outcome out;
    int files = file_count();
    perform(*state, &out, params, 1, 0);
    print_delays();
    assert_int_equal(out.report.went_count, 100);
    assert_int_equal(out.report.returned_count, 100);
    assert_int_equal(out.went, 100);
    assert_int_equal(out.came, 100);
    assert_false(out.is_told_twice);
    assert_false(out.report.input_failed);
    assert_int_equal(out.report.dropped + out.report.refused, 0);
    assert_true(out.report.away_s >= 0.3);
    assert_true(saw.samples >= 200);
    /* No pedal is stuck: what was pressed was let go. (The device itself never lets go.) */
    print_message("%u presses, largest step %.4f rad, %ju allocations\n", saw.presses,
                  (double)saw.largest_step_rad, (uintmax_t)out.allocations);
    assert_true(saw.presses >= 20);
    assert_true(saw.presses - saw.releases <= 1);
    /* No jump: the hand moves by 0.004 rad a sample, and the filter catches up. */
    assert_true(saw.largest_step_rad < 0.1f);
    assert_int_equal(file_count(), files);
    if (ALLOCATIONS_ARE_COUNTED)
        assert_int_equal(out.allocations, 0);
}

static void two_devices_may_go_at_once(void **state)
{
    const char *params[] = {"rate=500,run=0.01,away=0.004,losses=30,after=0.02",
                            "rate=500,run=0.009,away=0.003,losses=30,after=0.02"};
    outcome out;
    int files = file_count();
    perform(*state, &out, params, 2, 0);
    assert_int_equal(out.report.went_count, 60);
    assert_int_equal(out.report.returned_count, 60);
    assert_false(out.report.input_failed);
    assert_int_equal(file_count(), files);
}

static void while_a_device_is_away_the_pose_is_held_and_frames_go_on(void **state)
{
    const char *params[] = {"rate=200,pedal=1,run=0.1,away=100"};
    outcome out;
    perform(*state, &out, params, 1, 60);
    assert_int_equal(out.report.went_count, 1);
    assert_int_equal(out.report.returned_count, 0);
    assert_false(out.report.input_failed); /* away is no failure */
    assert_true(out.frames_away >= FRAMES_AWAY);
    assert_true(saw.presses == 1 && saw.releases == 1 && saw.pedal < 0.5f);
    assert_true(saw.release_step_rad < 0.1f); /* the filter catches up */
}

static void a_device_that_never_gives_anything_ends_with_the_time(void **state)
{
    const char *params[] = {"lie=silent"};
    outcome out;
    perform(*state, &out, params, 1, 0.1);
    assert_int_equal(out.report.sample_count, 0);
}

static void a_hand_that_moved_meanwhile_is_eased_to(void **state)
{
    /* 1 rad further after a third of a second away. Eased over 250 ms with at most 1.5 times the
     * mean speed: 0.03 rad in 5 ms; and the hand's own 0.004. */
    const char *params[] = {"rate=200,run=0.2,away=0.35,losses=1,after=0.6,leap=1"};
    outcome out;
    perform(*state, &out, params, 1, 0);
    assert_int_equal(out.report.returned_count, 1);
    assert_true(saw.longest_gap_s > 0.3);
    print_message("largest step %.4f rad, to %.3f rad\n", (double)saw.largest_step_rad,
                  (double)saw.last_rad);
    assert_true(saw.largest_step_rad < 0.1f);
    assert_true(saw.last_rad > 0.9f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_hundred_losses_in_a_row_leave_no_trace),
        cmocka_unit_test(two_devices_may_go_at_once),
        cmocka_unit_test(while_a_device_is_away_the_pose_is_held_and_frames_go_on),
        cmocka_unit_test(a_device_that_never_gives_anything_ends_with_the_time),
        cmocka_unit_test(a_hand_that_moved_meanwhile_is_eased_to),
    };
    return cmocka_run_group_tests(tests, flaky_load, flaky_unload);
}
