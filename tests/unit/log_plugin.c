/* plugins/log as the host sees it: loaded by its one symbol, paced by a clock of the test's own. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include <marotte/plugin.h>

#include <dlfcn.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define LOG_PATH BUILD_DIR "/tests/unit/log_plugin.tmp"

enum { SPEED, LOOP, START, END, HAND, MIRROR, PARAM_COUNT };
enum { TEXT = 512 };
static const int64_t MS = 1000000, ORIGIN_NS = 5000000000;

/* ---- a host whose clock moves only when it is waited for ---- */

typedef struct fake_host {
    mrt_host host;
    int64_t now_ns, last_wait_ns;
    int wait_count, restart_count, log_count[4];
    char last_text[TEXT];
} fake_host;

static void fake_log(const mrt_host *host, int32_t level, const char *text)
{
    fake_host *self = host->data;
    self->log_count[level] += 1;
    snprintf(self->last_text, TEXT, "%s", text);
}

static int64_t fake_now_ns(const mrt_host *host)
{
    const fake_host *self = host->data;
    return self->now_ns;
}

static int64_t fake_wait_until_ns(const mrt_host *host, int64_t time_ns)
{
    fake_host *self = host->data;
    self->wait_count += 1;
    self->last_wait_ns = time_ns;
    if (time_ns > self->now_ns)
        self->now_ns = time_ns;
    return self->now_ns;
}

static void fake_request_restart(const mrt_host *host)
{
    fake_host *self = host->data;
    self->restart_count += 1;
}

static const void *fake_service(const mrt_host *host, const char *id)
{
    (void)host;
    (void)id;
    return NULL;
}

typedef struct player {
    fake_host host;
    const mrt_plugin_type *type;
    const mrt_input *input;
    const mrt_duration *duration;
    mrt_plugin *plugin;
    double params[PARAM_COUNT];
} player;

static const mrt_plugin_type *log_type(void)
{
    void *library = dlopen(BUILD_DIR "/plugins/log.so", RTLD_NOW | RTLD_LOCAL);
    if (!library)
        fail_msg("%s", dlerror());
    const mrt_plugin_type *const *types = dlsym(library, "marotte_plugins");
    assert_non_null(types);
    assert_non_null(types[0]);
    assert_null(types[1]);
    return types[0];
}

static int set_up(void **state)
{
    player *p = calloc(1, sizeof *p);
    assert_non_null(p);
    p->host.now_ns = ORIGIN_NS;
    p->host.host = (mrt_host){
        &p->host, fake_log, fake_now_ns, fake_wait_until_ns, fake_request_restart, fake_service};
    p->type = log_type();
    assert_string_equal(p->type->interfaces[0].id, MRT_INPUT);
    p->input = p->type->interfaces[0].functions;
    assert_string_equal(p->type->interfaces[1].id, MRT_DURATION);
    p->duration = p->type->interfaces[1].functions;
    p->plugin = p->type->create(&p->host.host);
    assert_non_null(p->plugin);
    for (int i = 0; i < PARAM_COUNT; ++i)
        p->params[i] = p->type->params[i].initial;
    *state = p;
    return 0;
}

static int tear_down(void **state)
{
    player *p = *state;
    p->type->destroy(p->plugin);
    free(p);
    remove(LOG_PATH);
    return 0;
}

static void write_log(const char *text)
{
    FILE *file = fopen(LOG_PATH, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(text, 1, strlen(text), file), strlen(text));
    assert_int_equal(fclose(file), 0);
}

static void open_log(player *p, const char *text)
{
    write_log(text);
    assert_int_equal(p->input->open(p->plugin, LOG_PATH, p->params), MRT_OK);
}

static mrt_result read_before(player *p, int64_t deadline_ns, mrt_sample *out)
{
    return p->input->read(p->plugin, p->params, deadline_ns, out);
}

/* The next sample must be due `ms` after the origin and have this first value. */
static void assert_sample(player *p, double ms, float value)
{
    mrt_sample sample;
    assert_int_equal(read_before(p, INT64_MAX, &sample), MRT_OK);
    assert_int_equal(sample.time_ns, ORIGIN_NS + (int64_t)(ms * 1e6));
    assert_float_equal(sample.value[0], value, 1e-6f);
    assert_true(p->host.now_ns >= sample.time_ns);
}

static void assert_end(player *p)
{
    mrt_sample sample;
    assert_int_equal(read_before(p, INT64_MAX, &sample), MRT_END);
}

static const char three[] = "time_s,pedal.1,right.index.mpj\n"
                            "7.00,0,0.5\n"
                            "7.01,0.25,0.5\n"
                            "7.03,1,0.5\n";

/* ---- what it says about itself ---- */

static void type_is_well_formed(void **state)
{
    player *p = *state;
    assert_int_equal(p->type->abi, MRT_ABI);
    assert_string_equal(p->type->id, "org.marotte.log");
    assert_int_equal(p->type->param_count, PARAM_COUNT);
    assert_null(p->type->interfaces[2].id);
    assert_true(p->input->flags & MRT_INPUT_RECORDED);
    static const char *const names[PARAM_COUNT] = {"speed", "loop", "start",
                                                   "end",   "hand", "mirror"};
    for (int i = 0; i < PARAM_COUNT; ++i) {
        const mrt_param *q = &p->type->params[i];
        assert_string_equal(q->name, names[i]);
        assert_true(q->min < q->max && q->min <= q->initial && q->initial <= q->max);
        for (int k = 0; k < i; ++k)
            assert_int_not_equal(q->id, p->type->params[k].id);
    }
    p->type->destroy(NULL);
}

static void reading_what_is_not_open_is_the_end(void **state)
{
    player *p = *state;
    assert_end(p);
    p->input->close(p->plugin);
    assert_end(p);
}

/* ---- opening ---- */

static void assert_open_fails(player *p, const char *address, const char *part)
{
    int errors = p->host.log_count[MRT_LOG_ERROR];
    assert_true(p->input->open(p->plugin, address, p->params) < 0);
    assert_int_equal(p->host.log_count[MRT_LOG_ERROR], errors + 1);
    if (!strstr(p->host.last_text, part))
        fail_msg("expected \"%s\" in \"%s\"", part, p->host.last_text);
    if (address[0] && !strstr(p->host.last_text, address))
        fail_msg("expected \"%s\" in \"%s\"", address, p->host.last_text);
    assert_end(p);
}

static void what_cannot_be_played_is_refused_with_a_reason(void **state)
{
    player *p = *state;
    assert_open_fails(p, "", "path of a log");
    assert_open_fails(p, "no/such/file.csv", "No such file");
    assert_open_fails(p, ".", "directory");
    assert_open_fails(p, "/dev/zero", "device");
    write_log("");
    assert_open_fails(p, LOG_PATH, "empty");
    write_log("Lorem ipsum\ndolor sit amet\n");
    assert_open_fails(p, LOG_PATH, "expected a log");
    remove(LOG_PATH);
    assert_int_equal(mkfifo(LOG_PATH, 0600), 0); /* must not wait for a writer */
    assert_open_fails(p, LOG_PATH, "pipe");
}

static void damage_is_told_once_with_its_line(void **state)
{
    player *p = *state;
    open_log(p, "time_s,pedal.1\n0,0\n1,x\n2,0\n3,y\n4,1\n");
    assert_int_equal(p->host.log_count[MRT_LOG_WARNING], 1);
    assert_non_null(strstr(p->host.last_text, "2 of 5 records"));
    assert_non_null(strstr(p->host.last_text, "line 3"));
    assert_non_null(strstr(p->host.last_text, LOG_PATH));
    for (int i = 0; i < 3; ++i) {
        mrt_sample sample;
        assert_int_equal(read_before(p, INT64_MAX, &sample), MRT_OK);
    }
    assert_end(p);
    assert_int_equal(p->host.log_count[MRT_LOG_WARNING], 1);
}

static void channels_are_as_the_log_says(void **state)
{
    player *p = *state;
    open_log(p, three);
    uint32_t count;
    const mrt_channel *channel = p->input->channels(p->plugin, &count);
    assert_int_equal(count, 2);
    assert_string_equal(channel[1].name, "right.index.mpj");
    assert_int_equal(channel[1].semantic, MRT_CH_ANGLE + 4);
}

/* ---- pacing ---- */

static void samples_come_when_they_are_due(void **state)
{
    player *p = *state;
    open_log(p, three);
    p->host.now_ns = ORIGIN_NS; /* the origin is the first read, not the opening */
    assert_sample(p, 0, 0.0f);
    assert_sample(p, 10, 0.25f);
    assert_sample(p, 30, 1.0f);
    assert_int_equal(p->host.now_ns, ORIGIN_NS + 30 * MS);
    assert_end(p);
    assert_end(p);
}

static void sequence_and_count_are_filled(void **state)
{
    player *p = *state;
    open_log(p, three);
    mrt_sample sample;
    for (uint32_t i = 0; i < 3; ++i) {
        assert_int_equal(read_before(p, INT64_MAX, &sample), MRT_OK);
        assert_int_equal(sample.sequence, i);
        assert_int_equal(sample.count, 2);
        assert_float_equal(sample.value[1], 0.5f, 0.0f);
    }
}

static void deadline_is_honoured_and_nothing_is_lost(void **state)
{
    player *p = *state;
    open_log(p, three);
    assert_sample(p, 0, 0.0f);
    mrt_sample sample;
    assert_int_equal(read_before(p, ORIGIN_NS + 4 * MS, &sample), MRT_TIMEOUT);
    assert_int_equal(p->host.last_wait_ns, ORIGIN_NS + 4 * MS);
    assert_int_equal(read_before(p, ORIGIN_NS + 10 * MS - 1, &sample), MRT_TIMEOUT);
    assert_int_equal(p->host.now_ns, ORIGIN_NS + 10 * MS - 1);
    assert_int_equal(read_before(p, ORIGIN_NS + 10 * MS, &sample), MRT_OK);
    assert_int_equal(sample.time_ns, ORIGIN_NS + 10 * MS);
    assert_int_equal(sample.sequence, 1);
}

/* A host that comes late gets what was due, with the times at which it was due. */
static void late_reads_keep_the_due_times(void **state)
{
    player *p = *state;
    open_log(p, three);
    assert_sample(p, 0, 0.0f);
    p->host.now_ns = ORIGIN_NS + 500 * MS;
    assert_sample(p, 10, 0.25f);
    assert_sample(p, 30, 1.0f);
    assert_int_equal(p->host.now_ns, ORIGIN_NS + 500 * MS);
}

static void speed_divides_the_times(void **state)
{
    player *p = *state;
    open_log(p, three);
    p->params[SPEED] = 4.0;
    assert_sample(p, 0, 0.0f);
    assert_sample(p, 2.5, 0.25f);
    assert_sample(p, 7.5, 1.0f);
}

static void the_duration_is_that_of_what_is_played(void **state)
{
    player *p = *state;
    open_log(p, three); /* 0, 10 and 30 ms */
    const mrt_duration *duration = p->duration;
    assert_int_equal(duration->get_ns(p->plugin, p->params), 30 * MS);
    p->params[SPEED] = 2.0;
    assert_int_equal(duration->get_ns(p->plugin, p->params), 15 * MS);
    p->params[SPEED] = 1.0, p->params[START] = 0.005, p->params[END] = 0.01;
    assert_int_equal(duration->get_ns(p->plugin, p->params), 5 * MS);
    p->params[START] = 1.0, p->params[END] = 0.0; /* behind its end */
    assert_int_equal(duration->get_ns(p->plugin, p->params), 0);
    p->params[LOOP] = 1.0;
    assert_true(duration->get_ns(p->plugin, p->params) < 0);
}

static void speed_changes_without_a_jump(void **state)
{
    player *p = *state;
    open_log(p, "time_s,pedal.1\n0,0\n0.1,0.1\n0.2,0.2\n0.3,0.3\n0.4,0.4\n");
    assert_sample(p, 0, 0.0f);
    assert_sample(p, 100, 0.1f);
    p->params[SPEED] = 2.0;
    assert_sample(p, 150, 0.2f);
    p->params[SPEED] = 0.5;
    assert_sample(p, 350, 0.3f);
    p->params[SPEED] = 1.0;
    assert_sample(p, 450, 0.4f);
    assert_end(p);
}

static void speed_out_of_range_is_held_in_it(void **state)
{
    player *p = *state;
    open_log(p, three);
    p->params[SPEED] = 1000.0;
    assert_sample(p, 0, 0.0f);
    assert_sample(p, 1.25, 0.25f); /* 8 times as fast */
    p->params[SPEED] = (double)NAN;
    assert_sample(p, 201.25, 1.0f); /* a tenth as fast */
}

static void equal_times_keep_order_and_stamp(void **state)
{
    player *p = *state;
    open_log(p, "time_s,pedal.1\n0,0\n0.01,0.1\n0.01,0.2\n0.01,0.2\n0.02,0.3\n");
    assert_sample(p, 0, 0.0f);
    assert_sample(p, 10, 0.1f);
    assert_sample(p, 10, 0.2f);
    assert_sample(p, 10, 0.2f);
    assert_sample(p, 20, 0.3f);
}

/* ---- which part, how often ---- */

static void start_and_end_cut_the_log(void **state)
{
    player *p = *state;
    open_log(p, "time_s,pedal.1\n10,0\n10.1,0.1\n10.2,0.2\n10.3,0.3\n10.4,0.4\n");
    p->params[START] = 0.15;
    p->params[END] = 0.3;
    assert_sample(p, 50, 0.2f); /* 0.15 s is the origin */
    assert_sample(p, 150, 0.3f);
    assert_end(p);
}

static void nothing_between_start_and_end_is_said_once(void **state)
{
    player *p = *state;
    open_log(p, three);
    p->params[START] = 3.0;
    p->params[LOOP] = 1.0;
    assert_end(p);
    assert_end(p);
    assert_int_equal(p->host.log_count[MRT_LOG_WARNING], 1);
    assert_non_null(strstr(p->host.last_text, "between start and end"));
}

/* 30 ms in two intervals: the mean of 15 ms separates the passes. */
static void loop_goes_on_one_interval_later(void **state)
{
    player *p = *state;
    open_log(p, three);
    p->params[LOOP] = 1.0;
    for (int pass = 0; pass < 3; ++pass) {
        assert_sample(p, 45 * pass, 0.0f);
        assert_sample(p, 45 * pass + 10, 0.25f);
        assert_sample(p, 45 * pass + 30, 1.0f);
    }
    p->params[LOOP] = 0.0;
    assert_end(p);
}

static void loop_over_one_record_still_takes_time(void **state)
{
    player *p = *state;
    open_log(p, "time_s,pedal.1\n0,0.5\n");
    p->params[LOOP] = 1.0;
    p->params[SPEED] = 8.0;
    mrt_sample sample;
    int64_t last_ns = ORIGIN_NS - 1;
    for (int i = 0; i < 5; ++i) {
        assert_int_equal(read_before(p, INT64_MAX, &sample), MRT_OK);
        assert_true(sample.time_ns > last_ns);
        last_ns = sample.time_ns;
    }
}

static void opening_again_starts_anew(void **state)
{
    player *p = *state;
    open_log(p, three);
    assert_sample(p, 0, 0.0f);
    p->host.now_ns = ORIGIN_NS;
    open_log(p, "time_s,pedal.1\n3,0.75\n");
    mrt_sample sample;
    assert_int_equal(read_before(p, INT64_MAX, &sample), MRT_OK);
    assert_int_equal(sample.sequence, 0);
    assert_int_equal(sample.count, 1);
    assert_float_equal(sample.value[0], 0.75f, 0.0f);
}

/* ---- whose hand ---- */

static const char recording[] =
    "2014 11 28 08 33 09.9 1 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0\n"
    "2014 11 28 08 33 10.0 1 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0\n";

static uint32_t hand_of(player *p)
{
    uint32_t count;
    return p->input->channels(p->plugin, &count)[0].hand;
}

static void recording_is_a_right_hand_unless_told_otherwise(void **state)
{
    player *p = *state;
    open_log(p, recording);
    assert_int_equal(hand_of(p), MRT_RIGHT);
    p->params[HAND] = MRT_LEFT;
    open_log(p, recording);
    assert_int_equal(hand_of(p), MRT_LEFT);
    mrt_sample sample;
    assert_int_equal(read_before(p, INT64_MAX, &sample), MRT_OK);
    assert_int_equal(p->host.restart_count, 0);
}

static void hand_parameter_asks_once_to_be_opened_again(void **state)
{
    player *p = *state;
    open_log(p, recording);
    p->params[HAND] = MRT_LEFT;
    mrt_sample sample;
    assert_int_equal(read_before(p, INT64_MAX, &sample), MRT_OK);
    assert_int_equal(read_before(p, INT64_MAX, &sample), MRT_OK);
    assert_int_equal(p->host.restart_count, 1);
    assert_int_equal(hand_of(p), MRT_RIGHT); /* channels stay until closed */
    assert_int_equal(p->input->open(p->plugin, LOG_PATH, p->params), MRT_OK);
    assert_int_equal(hand_of(p), MRT_LEFT);
    assert_int_equal(read_before(p, INT64_MAX, &sample), MRT_OK);
    assert_int_equal(p->host.restart_count, 1);
}

static void hand_parameter_leaves_tables_alone(void **state)
{
    player *p = *state;
    open_log(p, "time_s,right.index.mpj\n0,0\n");
    p->params[HAND] = MRT_LEFT;
    mrt_sample sample;
    assert_int_equal(read_before(p, INT64_MAX, &sample), MRT_OK);
    assert_int_equal(p->host.restart_count, 0);
}

/* ---- in a mirror ---- */

static void a_mirrored_hand_keeps_its_angles(void **state)
{
    player *p = *state;
    p->params[MIRROR] = 1.0;
    open_log(p, "time_s,right.index.mpj,left.thumb.roll,pedal.1,right.mood,weather\n"
                "0,0.5,-0.25,1,7,8\n");
    static const char *const names[5] = {"left.index.mpj", "right.thumb.roll", "pedal.1",
                                         "left.mood", "weather"};
    static const uint32_t hands[5] = {MRT_LEFT, MRT_RIGHT, MRT_NO_HAND, MRT_LEFT, MRT_NO_HAND};
    static const float values[5] = {0.5f, -0.25f, 1.0f, 7.0f, 8.0f};
    uint32_t count;
    const mrt_channel *channel = p->input->channels(p->plugin, &count);
    mrt_sample sample;
    assert_int_equal(read_before(p, INT64_MAX, &sample), MRT_OK);
    assert_int_equal(count, 5);
    for (int i = 0; i < 5; ++i) {
        assert_string_equal(channel[i].name, names[i]);
        assert_int_equal(channel[i].hand, hands[i]);
        assert_float_equal(sample.value[i], values[i], 0.0f);
    }
    assert_int_equal(channel[0].semantic, MRT_CH_ANGLE + 4);
    assert_int_equal(p->host.log_count[MRT_LOG_WARNING], 0);
}

static void cross(const float *a, const float *b, float *out)
{
    for (int i = 0; i < 3; ++i)
        out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

/* A point of a hand that a tracked wrist moves: turned by its quaternion, then shifted. */
static void moved(const float *wrist, const float *point, float *out)
{
    const float *axis = wrist + 3;
    float once[3], twice[3];
    cross(axis, point, once);
    cross(axis, once, twice);
    for (int i = 0; i < 3; ++i)
        out[i] = point[i] + 2.0f * (wrist[6] * once[i] + twice[i]) + wrist[i];
}

static void a_mirrored_wrist_moves_the_mirrored_hand(void **state)
{
    player *p = *state;
    static const char tracked[] =
        "time_s,right.wrist.x,right.wrist.y,right.wrist.z,right.wrist.qx,right.wrist.qy,"
        "right.wrist.qz,right.wrist.qw\n"
        "0,10,20,30,0.1,0.5,0.7,0.5\n";
    static const float point[3] = {1, 2, 3}, in_mirror[3] = {-1, 2, 3};
    float plain[3], mirrored[3];
    mrt_sample sample;
    open_log(p, tracked);
    assert_int_equal(read_before(p, INT64_MAX, &sample), MRT_OK);
    moved(sample.value, point, plain);
    p->params[MIRROR] = 1.0;
    open_log(p, tracked);
    assert_int_equal(hand_of(p), MRT_LEFT);
    assert_int_equal(read_before(p, INT64_MAX, &sample), MRT_OK);
    moved(sample.value, in_mirror, mirrored);
    assert_float_equal(mirrored[0], -plain[0], 1e-5f);
    assert_float_equal(mirrored[1], plain[1], 1e-5f);
    assert_float_equal(mirrored[2], plain[2], 1e-5f);
}

static void a_mirrored_recording_is_the_other_hand(void **state)
{
    player *p = *state;
    mrt_sample sample;
    p->params[MIRROR] = 1.0;
    open_log(p, recording);
    assert_int_equal(hand_of(p), MRT_LEFT);
    assert_int_equal(read_before(p, INT64_MAX, &sample), MRT_OK);
    assert_int_equal(p->host.restart_count, 0);
    p->params[HAND] = MRT_LEFT;
    open_log(p, recording);
    assert_int_equal(hand_of(p), MRT_RIGHT);
    assert_int_equal(read_before(p, INT64_MAX, &sample), MRT_OK);
    assert_int_equal(p->host.restart_count, 0);
}

static void mirror_parameter_asks_once_to_be_opened_again(void **state)
{
    player *p = *state;
    open_log(p, three);
    p->params[MIRROR] = 1.0;
    mrt_sample sample;
    assert_int_equal(read_before(p, INT64_MAX, &sample), MRT_OK);
    assert_int_equal(read_before(p, INT64_MAX, &sample), MRT_OK);
    assert_int_equal(p->host.restart_count, 1);
    assert_int_equal(p->input->open(p->plugin, LOG_PATH, p->params), MRT_OK);
    assert_int_equal(read_before(p, INT64_MAX, &sample), MRT_OK);
    assert_int_equal(p->host.restart_count, 1);
}

static void mirrored_counts_are_told_of(void **state)
{
    player *p = *state;
    p->params[MIRROR] = 1.0;
    open_log(p, "time_s,right.index.mpj,right.index.pij\nunit,count,count\n0,127,90\n");
    assert_int_equal(p->host.log_count[MRT_LOG_WARNING], 1);
    assert_non_null(strstr(p->host.last_text, "calibration"));
    assert_int_equal(hand_of(p), MRT_LEFT);
}

static void a_long_name_is_mirrored_whole(void **state)
{
    player *p = *state;
    p->params[MIRROR] = 1.0;
    open_log(p, "time_s,left.abcdefghijklmnopqrstuvwxyz01234567\n0,1\n");
    uint32_t count;
    assert_string_equal(p->input->channels(p->plugin, &count)[0].name,
                        "right.abcdefghijklmnopqrstuvwxyz01234567");
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(type_is_well_formed),
        TEST(reading_what_is_not_open_is_the_end),
        TEST(what_cannot_be_played_is_refused_with_a_reason),
        TEST(damage_is_told_once_with_its_line),
        TEST(channels_are_as_the_log_says),
        TEST(samples_come_when_they_are_due),
        TEST(sequence_and_count_are_filled),
        TEST(deadline_is_honoured_and_nothing_is_lost),
        TEST(late_reads_keep_the_due_times),
        TEST(speed_divides_the_times),
        TEST(the_duration_is_that_of_what_is_played),
        TEST(speed_changes_without_a_jump),
        TEST(speed_out_of_range_is_held_in_it),
        TEST(equal_times_keep_order_and_stamp),
        TEST(start_and_end_cut_the_log),
        TEST(nothing_between_start_and_end_is_said_once),
        TEST(loop_goes_on_one_interval_later),
        TEST(loop_over_one_record_still_takes_time),
        TEST(opening_again_starts_anew),
        TEST(recording_is_a_right_hand_unless_told_otherwise),
        TEST(hand_parameter_asks_once_to_be_opened_again),
        TEST(hand_parameter_leaves_tables_alone),
        TEST(a_mirrored_hand_keeps_its_angles),
        TEST(a_mirrored_wrist_moves_the_mirrored_hand),
        TEST(a_mirrored_recording_is_the_other_hand),
        TEST(mirror_parameter_asks_once_to_be_opened_again),
        TEST(mirrored_counts_are_told_of),
        TEST(a_long_name_is_mirrored_whole),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
