/* core/stage: plugins found and refused, the frame in sample order, the guard, the player. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/clock.h"
#include "unit/player_run.h"
#include "stage/mapping/plugins.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- a flat face, an input that plays a table, a mapping that follows the thumb ---- */

enum { GRID = 9, TABLE_MAX = 64 };

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
            uint32_t a = y * GRID + x, b = a + 1, c = a + GRID, d = c + 1;
            const uint32_t quad[6] = {a, b, d, a, d, c};
            memcpy(t, quad, sizeof quad);
        }
}

typedef struct table {
    mrt_sample sample[TABLE_MAX];
    uint32_t count;
    uint32_t hand;
    bool is_index_in_counts; /* instead of the thumb in rad */
} table;

struct mrt_plugin {
    const table *table;
    const mrt_host *host;
    uint32_t at;
    mrt_channel channel;
    uint32_t anchor;
};

static const table *next_table; /* given to the next instance */

static mrt_plugin *create(const mrt_host *host)
{
    mrt_plugin *self = calloc(1, sizeof *self);
    self->host = host;
    self->table = next_table;
    return self;
}

static void destroy(mrt_plugin *self)
{
    free(self);
}

static mrt_result open_table(mrt_plugin *self, const char *address, const double *params)
{
    (void)params;
    if (strcmp(address, "gone") != 0)
        return MRT_OK;
    self->host->log(self->host, MRT_LOG_ERROR, "gone: the cable is not there");
    return MRT_ERR_IO;
}

static const mrt_channel *channels(mrt_plugin *self, uint32_t *out_count)
{
    self->channel = (mrt_channel){"thumb", "rad", MRT_CH_ANGLE + 1, self->table->hand, -2, 2};
    if (self->table->is_index_in_counts)
        self->channel =
            (mrt_channel){"index", "count", MRT_CH_ANGLE + 4, self->table->hand, 0, 255};
    *out_count = 1;
    return &self->channel;
}

static mrt_result read_table(mrt_plugin *self, const double *params, int64_t deadline_ns,
                             mrt_sample *out)
{
    (void)params;
    if (self->at == self->table->count)
        return MRT_END;
    const mrt_sample *next = &self->table->sample[self->at];
    if (next->time_ns > deadline_ns)
        return MRT_TIMEOUT;
    self->at += 1;
    *out = *next;
    return MRT_OK;
}

static void close_table(mrt_plugin *self)
{
    (void)self;
}

static mrt_result activate(mrt_plugin *self, const mrt_face *about)
{
    (void)self;
    return about->high.x > 0 ? MRT_OK : MRT_ERR_UNSUPPORTED;
}

static void deactivate(mrt_plugin *self)
{
    (void)self;
}

static void reset(mrt_plugin *self)
{
    self->anchor = 1;
}

/* Pulls the middle of the face out by 10 mm per radian of either thumb. "Mode" picks how;
 * "Nonsense" spoils the pull from the tenth sample on. */
enum { PARAM_MODE, PARAM_NONSENSE };

static float last_thumb_rad; /* of the right hand */

static mrt_result follow(mrt_plugin *self, const mrt_frame *frame, mrt_pull *pull)
{
    self->at += 1;
    float z = 10.0f * (frame->hand[MRT_LEFT].angle[1] + frame->hand[MRT_RIGHT].angle[1]);
    last_thumb_rad = frame->hand[MRT_RIGHT].angle[1];
    mrt_vec3 start = {40, 40, 0}, end = {40, 40, z};
    pull->mode = frame->params[PARAM_MODE] > 0.5 ? MRT_UNANCHORED : MRT_ANCHORED;
    if (pull->mode == MRT_UNANCHORED && self->at > 1)
        start = pull->vector[0].end;
    pull->anchor = self->anchor;
    pull->radius_mm = 35.0f;
    pull->count = 1;
    pull->vector[0] = (mrt_vector){start, end, 0};
    if (frame->params[PARAM_NONSENSE] > 0.5 && self->at >= 10)
        pull->vector[0].end.z = NAN;
    return MRT_OK;
}

static const mrt_input input_functions = {open_table, channels, read_table, close_table,
                                          MRT_INPUT_RECORDED};
static const mrt_mapping mapping_functions = {activate, deactivate, reset, follow};
static const mrt_interface input_interfaces[] = {{MRT_INPUT, &input_functions}, {NULL, NULL}};
static const mrt_interface mapping_interfaces[] = {{MRT_MAPPING, &mapping_functions}, {NULL, NULL}};
static const char *const modes[] = {"Anchored", "Clay form", NULL};
static const mrt_param mapping_params[] = {
    {1, MRT_PARAM_STEPPED, "Mode", "Pull", "", "", 0, 1, 0, modes},
    {2, MRT_PARAM_STEPPED, "Nonsense", "Pull", "", "", 0, 1, 0, NULL},
};
static const mrt_plugin_type table_type = {MRT_ABI, 0,   NULL, input_interfaces, "test.table",
                                           "Table", "1", "",   create,           destroy};
static const mrt_plugin_type follow_type = {
    MRT_ABI, 2,      mapping_params, mapping_interfaces, "test.follow", "Follow", "1",
    "",      create, destroy};

static void fill_table(table *out, uint32_t hand, uint32_t count, int64_t first_ns, int64_t step_ns)
{
    *out = (table){.count = count, .hand = hand};
    for (uint32_t i = 0; i < count; ++i)
        out->sample[i] = (mrt_sample){.time_ns = first_ns + (int64_t)i * step_ns,
                                      .sequence = i,
                                      .count = 1,
                                      .value = {0.02f * (float)(i % 23)}};
}

/* ---- one performance ---- */

typedef struct outcome {
    player_report report;
    composer_counts counts;
    uint64_t hash; /* of the shape at the end, in file order */
    double first_time_s, last_time_s;
    int64_t work_ns;
} outcome;

static mrt_result on_frame(void *data, uint32_t index, double time_s, int64_t work_ns, error *err)
{
    (void)err;
    outcome *out = data;
    if (index == 0)
        out->first_time_s = time_s;
    assert_true(work_ns >= 0);
    out->last_time_s = time_s;
    return MRT_OK;
}

static uint64_t hash_of(const face *f)
{
    float rows[GRID * GRID * 3];
    points_to_rows(rows, face_shown(f), face_order(f));
    const unsigned char *bytes = (const unsigned char *)rows;
    uint64_t hash = 14695981039346656037u;
    for (size_t i = 0; i < sizeof rows; ++i)
        hash = (hash ^ bytes[i]) * 1099511628211u;
    return hash;
}

static void play(outcome *out, const table *const *tables, uint32_t table_count, const char *params,
                 double fps, instance_clock clock)
{
    error err = {""};
    face_file file;
    instance mapping;
    performer *p;
    input *inputs[4];
    log_queue *log = log_queue_create();
    *out = (outcome){.hash = 0};
    make_face(&file);
    for (uint32_t i = 0; i < table_count; ++i) {
        next_table = tables[i];
        assert_int_equal(input_create(&inputs[i], &table_type, "", "", clock, log, &err), MRT_OK);
    }
    assert_int_equal(instance_create(&mapping, &follow_type, clock, log, &err), MRT_OK);
    assert_int_equal(instance_set_list(&mapping, params, &err), MRT_OK);
    performer_settings settings = {.hand_length_mm = 0};
    assert_int_equal(performer_create(&p, &file, &mapping, &settings, &err), MRT_OK);
    player_settings player = {.fps = fps, .clock = clock};
    player_events events = {.frame = on_frame, .data = out};
    assert_int_equal(player_run(p, inputs, table_count, &player, &events, &out->report, &err),
                     MRT_OK);
    composer_draw(p->composer);
    out->hash = hash_of(composer_face(p->composer));
    out->counts = *p->counts;
    performer_destroy(p);
    instance_destroy(&mapping);
    for (uint32_t i = 0; i < table_count; ++i)
        input_destroy(inputs[i]);
    log_queue_destroy(log);
    face_file_destroy(&file);
}

static void performance_is_a_function_of_its_samples_whatever_the_frame_rate(void **state)
{
    (void)state;
    table t;
    fill_table(&t, MRT_RIGHT, 50, 0, 7 * NS_PER_MS);
    const table *tables[] = {&t};
    static const char *const params[] = {"mode=anchored", "mode=clay_form"};
    for (int mode = 0; mode < 2; ++mode) {
        outcome slow, fast;
        play(&slow, tables, 1, params[mode], 5, CLOCK_VIRTUAL);
        play(&fast, tables, 1, params[mode], 240, CLOCK_VIRTUAL);
        assert_int_equal(slow.report.sample_count, 50);
        assert_int_equal(fast.report.sample_count, 50);
        assert_true(fast.report.frame_count > 10 * slow.report.frame_count);
        assert_true(slow.hash == fast.hash);
        assert_int_equal(slow.counts.bad_pulls, 0);
    }
}

static void frames_cover_the_performance_evenly(void **state)
{
    (void)state;
    table t;
    fill_table(&t, MRT_RIGHT, 51, 5 * NS_PER_S, 10 * NS_PER_MS); /* half a second, from 5 s on */
    const table *tables[] = {&t};
    outcome out;
    play(&out, tables, 1, "", 60, CLOCK_VIRTUAL);
    assert_int_equal(out.report.frame_count, 31); /* 0, 1/60 ... 30/60 s */
    assert_true(fabs(out.first_time_s) < 1e-12 && fabs(out.last_time_s - 0.5) < 1e-9);
    assert_true(fabs(out.report.duration_s - 0.5) < 1e-9);
}

static void two_inputs_are_merged_in_time_order(void **state)
{
    (void)state;
    /* The same samples through one table, or dealt out to two: the same performance. */
    table all, even, odd;
    fill_table(&all, MRT_RIGHT, 40, 0, 5 * NS_PER_MS);
    even = odd = (table){.hand = MRT_RIGHT};
    for (uint32_t i = 0; i < all.count; ++i) {
        table *part = i % 2 ? &odd : &even;
        part->sample[part->count++] = all.sample[i];
    }
    const table *one[] = {&all}, *two[] = {&odd, &even};
    outcome together, apart;
    play(&together, one, 1, "mode=clay_form", 30, CLOCK_VIRTUAL);
    play(&apart, two, 2, "mode=clay_form", 30, CLOCK_VIRTUAL);
    assert_int_equal(apart.report.sample_count, 40);
    assert_true(together.hash == apart.hash);
}

static void real_time_plays_every_sample_through_a_thread(void **state)
{
    (void)state;
    table t;
    fill_table(&t, MRT_LEFT, 30, clock_now_ns(), 2 * NS_PER_MS);
    const table *tables[] = {&t};
    outcome real, replay;
    play(&real, tables, 1, "mode=clay_form", 60, CLOCK_REAL);
    play(&replay, tables, 1, "mode=clay_form", 60, CLOCK_VIRTUAL);
    assert_int_equal(real.report.sample_count, 30);
    assert_int_equal(real.report.dropped, 0);
    assert_true(real.hash == replay.hash);
}

static void guard_holds_the_last_good_pull_and_counts(void **state)
{
    (void)state;
    table t, first_nine;
    fill_table(&t, MRT_RIGHT, 30, 0, 10 * NS_PER_MS);
    first_nine = t;
    first_nine.count = 9;
    const table *whole[] = {&t}, *part[] = {&first_nine};
    outcome spoilt, good;
    play(&spoilt, whole, 1, "nonsense=1", 30, CLOCK_VIRTUAL);
    play(&good, part, 1, "", 30, CLOCK_VIRTUAL);
    assert_int_equal(spoilt.counts.bad_pulls, 21);
    assert_non_null(strstr(spoilt.counts.first_problem.text, "test.follow"));
    assert_true(spoilt.hash == good.hash);
}

static void samples_that_are_not_finite_are_refused_and_counted(void **state)
{
    (void)state;
    table t;
    fill_table(&t, MRT_RIGHT, 10, 0, 10 * NS_PER_MS);
    t.sample[3].value[0] = INFINITY;
    t.sample[5].count = 7;
    const table *tables[] = {&t};
    outcome out;
    play(&out, tables, 1, "", 30, CLOCK_VIRTUAL);
    assert_int_equal(out.report.sample_count, 8);
    assert_int_equal(out.report.refused, 2);
}

static void sensors_that_a_glove_lacks_stay_in_the_middle(void **state)
{
    (void)state;
    table t;
    fill_table(&t, MRT_RIGHT, 10, 0, 10 * NS_PER_MS);
    t.is_index_in_counts = true;
    const table *tables[] = {&t};
    outcome out;
    play(&out, tables, 1, "", 30, CLOCK_VIRTUAL);
    assert_true(fabsf(last_thumb_rad - 0.6816f) < 1e-4f); /* 0.0142 rad/count, (128 - 80) counts */
}

static void time_that_runs_backwards_counts_as_simultaneous(void **state)
{
    (void)state;
    table t;
    fill_table(&t, MRT_RIGHT, 10, 0, 10 * NS_PER_MS);
    t.sample[5].time_ns = 0;
    const table *tables[] = {&t};
    outcome out;
    play(&out, tables, 1, "mode=clay_form", 30, CLOCK_VIRTUAL);
    assert_int_equal(out.report.sample_count, 10);
    assert_true(fabs(out.report.duration_s - 0.09) < 1e-9);
}

static void a_gap_of_hours_is_an_error_not_hours_of_frames(void **state)
{
    (void)state;
    error err = {""};
    face_file file;
    instance mapping;
    performer *p;
    input *in;
    table t;
    log_queue *log = log_queue_create();
    make_face(&file);
    fill_table(&t, MRT_RIGHT, 3, 0, 7200 * NS_PER_S);
    next_table = &t;
    assert_int_equal(input_create(&in, &table_type, "", "", CLOCK_VIRTUAL, log, &err), MRT_OK);
    assert_int_equal(instance_create(&mapping, &follow_type, CLOCK_VIRTUAL, log, &err), MRT_OK);
    performer_settings settings = {.hand_length_mm = 0};
    assert_int_equal(performer_create(&p, &file, &mapping, &settings, &err), MRT_OK);
    outcome out = {.hash = 0};
    player_settings player = {.fps = 30, .clock = CLOCK_VIRTUAL};
    player_events events = {.frame = on_frame, .data = &out};
    assert_true(player_run(p, &in, 1, &player, &events, &out.report, &err) < 0);
    assert_non_null(strstr(err.text, "gap of 7200 s"));
    performer_destroy(p);
    instance_destroy(&mapping);
    input_destroy(in);
    log_queue_destroy(log);
    face_file_destroy(&file);
}

/* ---- plugins ---- */

static void an_input_that_cannot_be_opened_says_why_in_its_own_words(void **state)
{
    (void)state;
    error err = {""};
    input *in;
    table t = {.count = 0};
    log_queue *log = log_queue_create();
    next_table = &t;
    assert_true(input_create(&in, &table_type, "gone", "", CLOCK_VIRTUAL, log, &err) < 0);
    assert_string_equal(err.text, "gone: the cable is not there");
    assert_null(in);
    log_queue_destroy(log);
}

static void parameters_are_set_by_name_within_their_range(void **state)
{
    (void)state;
    error err = {""};
    instance i;
    assert_int_equal(instance_create(&i, &follow_type, CLOCK_VIRTUAL, NULL, &err), MRT_OK);
    assert_int_equal(instance_set_list(&i, "", &err), MRT_OK);
    assert_int_equal(instance_set_list(&i, "pull.mode=Clay form,nonsense=1", &err), MRT_OK);
    instance_latch(&i);
    assert_true(i.params[PARAM_MODE] > 0.5 && i.params[PARAM_NONSENSE] > 0.5);
    static const char *const bad[][2] = {{"speed=1", "no parameter \"speed\""},
                                         {"mode=2", "not one of its choices: "},
                                         {"mode=0.5", "whole"},
                                         {"mode=often", "clay_form"},
                                         {"mode", "not key=value"},
                                         {"mode=nan", "not one of its choices"}};
    for (size_t k = 0; k < sizeof bad / sizeof bad[0]; ++k) {
        assert_true(instance_set_list(&i, bad[k][0], &err) < 0);
        assert_non_null(strstr(err.text, bad[k][1]));
    }
    instance_destroy(&i);
}

static void broken_plugins_are_refused_by_name_and_reason(void **state)
{
    (void)state;
    static const struct {
        const char *name, *reason;
    } cases[] = {{"abi", "ABI 7, but this program uses ABI 1"},
                 {"symbol", "marotte_plugins"},
                 {"param", "min < max"}};
    plugin_list list = {0};
    error err = {""};
    char path[1024];
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        snprintf(path, sizeof path, "%s/tests/plugin/%s.so", BUILD_DIR, cases[i].name);
        assert_true(plugin_list_add(&list, path, &err) < 0);
        assert_non_null(strstr(err.text, path));
        assert_non_null(strstr(err.text, cases[i].reason));
        assert_int_equal(list.refusal_count, i + 1);
    }
    assert_int_equal(list.entry_count, 0);
    snprintf(path, sizeof path, "%s/tests/plugin/sound.so", BUILD_DIR);
    assert_int_equal(plugin_list_add(&list, path, &err), MRT_OK);
    const mrt_plugin_type *type;
    assert_int_equal(plugin_list_find(&list, "broken", MRT_MAPPING, &type, &err), MRT_OK);
    assert_string_equal(type->id, "org.example.broken");
    assert_true(plugin_list_find(&list, "waldo", MRT_INPUT, &type, &err) < 0);
    assert_non_null(strstr(err.text, "Loaded: broken"));
    plugin_list_destroy(&list);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(performance_is_a_function_of_its_samples_whatever_the_frame_rate),
        cmocka_unit_test(frames_cover_the_performance_evenly),
        cmocka_unit_test(two_inputs_are_merged_in_time_order),
        cmocka_unit_test(real_time_plays_every_sample_through_a_thread),
        cmocka_unit_test(guard_holds_the_last_good_pull_and_counts),
        cmocka_unit_test(samples_that_are_not_finite_are_refused_and_counted),
        cmocka_unit_test(sensors_that_a_glove_lacks_stay_in_the_middle),
        cmocka_unit_test(time_that_runs_backwards_counts_as_simultaneous),
        cmocka_unit_test(a_gap_of_hours_is_an_error_not_hours_of_frames),
        cmocka_unit_test(an_input_that_cannot_be_opened_says_why_in_its_own_words),
        cmocka_unit_test(parameters_are_set_by_name_within_their_range),
        cmocka_unit_test(broken_plugins_are_refused_by_name_and_reason),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
