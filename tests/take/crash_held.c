/* A program that is killed while its frame thread is held up (a machine that is busy with something
 * else): every sample that had arrived is in the show, as it would have been recorded.
 *
 * A child performs two hands whose samples a plugin of ours gives. It holds its frame thread, lets
 * samples arrive that nobody performs, and is killed: there is no clock in that, and no luck. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "window/live_fixture.h"

#include <signal.h>
#include <stdatomic.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>

enum { PERFORMED = 60, ARRIVED = 400, HANDS = 2 };
/* Longer than anything here takes on a machine that is busy. */
static const int64_t patience_ns = 60 * NS_PER_S;
/* Ahead of the pointer's samples, so that times are ours: 125 Hz, the right hand a little later. */
static const int64_t ahead_ns = 1000 * NS_PER_S, step_ns = 8 * NS_PER_MS, later_ns = 1500000;

typedef struct shared {
    char folder[FIXTURE_PATH], show_path[FIXTURE_PATH];
    _Atomic int64_t start_ns;
    _Atomic uint32_t may_arrive, arrived[HANDS]; /* samples */
    _Atomic bool is_held, is_to_go_on, is_ready;
} shared;

static shared *with; /* both processes' */

/* ---- two hands ---- */

struct mrt_plugin {
    const mrt_host *host;
    mrt_channel channel[2];
    uint32_t side, count;
};

static mrt_plugin *create(const mrt_host *host)
{
    mrt_plugin *self = calloc(1, sizeof *self);
    if (self)
        self->host = host;
    return self;
}

static void destroy(mrt_plugin *self)
{
    free(self);
}

static mrt_result open_hand(mrt_plugin *self, const char *address, const double *params)
{
    (void)params;
    self->side = strcmp(address, "left") == 0 ? MRT_LEFT : MRT_RIGHT;
    for (uint32_t i = 0; i < 2; ++i)
        self->channel[i] = (mrt_channel){
            i ? "index" : "thumb", "rad", MRT_CH_ANGLE + 1 + 3 * i, self->side, -3.0f, 3.0f};
    return MRT_OK;
}

static const mrt_channel *channels_of(mrt_plugin *self, uint32_t *out_count)
{
    *out_count = 2;
    return self->channel;
}

static mrt_sample sample_of(uint32_t side, uint32_t n)
{
    mrt_sample out = {.time_ns = (int64_t)n * step_ns, .sequence = n, .count = 2};
    if (side == MRT_RIGHT)
        out.time_ns += later_ns + (int64_t)(n * 7919 % 1000) * 1000;
    out.value[0] = (float)(n % 100) * 0.01f;
    out.value[1] = (float)(side + 1) * 0.25f;
    return out;
}

/* Whoever asks for another one has delivered those before. */
static mrt_result read_hand(mrt_plugin *self, const double *params, int64_t deadline_ns,
                            mrt_sample *out)
{
    (void)params;
    atomic_store(&with->arrived[self->side], self->count);
    if (self->count >= atomic_load(&with->may_arrive)) {
        const int64_t soon_ns = self->host->now_ns(self->host) + NS_PER_MS;
        self->host->wait_until_ns(self->host, soon_ns < deadline_ns ? soon_ns : deadline_ns);
        return MRT_TIMEOUT;
    }
    *out = sample_of(self->side, self->count++);
    out->time_ns += atomic_load(&with->start_ns);
    return MRT_OK;
}

static void close_hand(mrt_plugin *self)
{
    (void)self;
}

static const mrt_input functions = {open_hand, channels_of, read_hand, close_hand,
                                    MRT_INPUT_RECORDED};
static const mrt_interface interfaces[] = {{MRT_INPUT, &functions}, {NULL, NULL}};
static const mrt_plugin_type hand_type = {MRT_ABI, 0,   NULL,        interfaces, "org.example.hand",
                                          "Hand",  "1", "Of a test", create,     destroy};

/* ---- the child ---- */

/* [frame] */
static mrt_result stand_still(live_stage *stage, void *data, error *err)
{
    (void)stage, (void)data, (void)err;
    atomic_store(&with->is_held, true);
    while (!atomic_load(&with->is_to_go_on))
        clock_sleep_until_ns(clock_now_ns() + NS_PER_MS);
    atomic_store(&with->is_held, false);
    return MRT_OK;
}

static void *hold_frame_thread(void *data)
{
    error ignored;
    live_fixture *d = data;
    (void)!live_run_command(d->live, stand_still, NULL, &ignored);
    return NULL;
}

static void await(const _Atomic uint32_t *what, uint32_t wanted)
{
    const int64_t end_ns = clock_now_ns() + patience_ns;
    while (atomic_load(what) != wanted) {
        assert_true(clock_now_ns() < end_ns);
        clock_sleep_until_ns(clock_now_ns() + NS_PER_MS);
    }
}

static pthread_t hold(live_fixture *d)
{
    pthread_t thread;
    atomic_store(&with->is_to_go_on, false);
    assert_int_equal(pthread_create(&thread, NULL, hold_frame_thread, d), 0);
    while (!atomic_load(&with->is_held))
        clock_sleep_until_ns(clock_now_ns() + NS_PER_MS);
    return thread;
}

/* What has arrived is performed, and recorded. */
static void let_go(live_fixture *d, pthread_t thread, uint32_t count)
{
    error err = {""};
    const int64_t end_ns = clock_now_ns() + patience_ns;
    mrt_sample newest;
    atomic_store(&with->is_to_go_on, true);
    pthread_join(thread, NULL);
    for (uint32_t i = 0; i < HANDS; ++i)
        while (!live_input_sample(d->live, i, &newest) || newest.sequence + 1 < count) {
            assert_true(clock_now_ns() < end_ns);
            clock_sleep_until_ns(clock_now_ns() + NS_PER_MS);
        }
    fixture_must(writer_flush(recorder_writer(d->live->recorder), &err), &err);
}

static void arrive(uint32_t count)
{
    atomic_store(&with->may_arrive, count);
    for (uint32_t i = 0; i < HANDS; ++i)
        await(&with->arrived[i], count);
}

static void add_hand(live_fixture *d, const char *side)
{
    error err = {""};
    input *made;
    fixture_must(input_create(&made, &hand_type, side, "", CLOCK_REAL, d->log, &err), &err);
    fixture_must(live_add_input(d->live, made, side, &err), &err);
}

static void perform_until_killed(bool is_performed)
{
    live_fixture d;
    error err = {""};
    fixture_start(&d, "puppet", "one_hand", FIXTURE_SHOW);
    snprintf(with->folder, sizeof with->folder, "%s", d.folder);
    snprintf(with->show_path, sizeof with->show_path, "%s", d.show_path);
    add_hand(&d, "left");
    add_hand(&d, "right");
    fixture_must(live_record(d.live, &(writer_slate){.scene = "1"}, &err), &err);
    atomic_store(&with->start_ns, clock_now_ns() + ahead_ns);
    pthread_t thread = hold(&d);
    arrive(PERFORMED);
    let_go(&d, thread, PERFORMED);
    thread = hold(&d);
    arrive(ARRIVED);
    if (is_performed)
        let_go(&d, thread, ARRIVED);
    atomic_store(&with->is_ready, true);
    for (;;)
        (void)pause();
}

/* ---- what it left ---- */

typedef struct left_track {
    mrt_sample sample[ARRIVED];
    uint32_t count;
} left_track;

typedef struct left_show {
    left_track hand[HANDS];
} left_show;

/* The times of its samples are of the first one's on. */
static void read_track(show *s, int64_t id, int64_t first_ns, left_track *out)
{
    error err = {""};
    show_reader *reader;
    mrt_sample sample;
    mrt_result result;
    fixture_must(show_reader_open(&reader, s, id, INT64_MIN, INT64_MAX, &err), &err);
    while ((result = show_reader_next(reader, &sample, &err)) == MRT_OK) {
        assert_true(out->count < ARRIVED);
        sample.time_ns -= first_ns;
        out->sample[out->count++] = sample;
    }
    fixture_must(result, &err);
    show_reader_close(reader);
}

/* The one that the input recorded last. */
static int64_t track_of(show *s, const char *text, show_track *out)
{
    error err = {""};
    int64_t *ids, found = 0;
    size_t count;
    fixture_must(show_track_ids(s, &ids, &count, &err), &err);
    for (size_t i = 0; i < count; ++i) {
        show_track track;
        fixture_must(show_track_read(s, ids[i], &track, &err), &err);
        if (strcmp(track.track.input, text) == 0 && track.to_ns > 0) {
            *out = track;
            found = ids[i];
        }
        show_track_finish(&track);
    }
    free(ids);
    assert_true(found > 0);
    return found;
}

/* It shows all of them: up to the last one, which ended it. */
static void check_take(show *s, int64_t last_ns)
{
    error err = {""};
    show_take *takes;
    size_t count;
    fixture_must(show_takes(s, &takes, &count, &err), &err);
    assert_int_equal(count, 1);
    assert_true(takes[0].is_recovered);
    assert_true(takes[0].end_ns >= last_ns);
    free(takes);
}

static void read_left(left_show *out)
{
    error err = {""};
    show *s;
    show_track left, right;
    memset(out, 0, sizeof *out);
    fixture_must(show_open(&s, with->show_path, SHOW_WRITE, &err), &err);
    assert_true(show_is_writable(s));
    const int64_t ids[HANDS] = {track_of(s, "left", &left), track_of(s, "right", &right)};
    for (int i = 0; i < HANDS; ++i)
        read_track(s, ids[i], left.from_ns, &out->hand[i]);
    check_take(s, left.to_ns);
    show_close(s);
}

/* A child that is killed with everything performed, or with the most part waiting. */
static void kill_one(bool is_performed, left_show *out)
{
    int status;
    memset(with, 0, sizeof *with);
    pid_t child = fork();
    if (child == 0) {
        perform_until_killed(is_performed);
        _exit(3);
    }
    const int64_t end_ns = clock_now_ns() + 3 * patience_ns;
    while (!atomic_load(&with->is_ready)) {
        assert_int_equal(waitpid(child, &status, WNOHANG), 0);
        assert_true(clock_now_ns() < end_ns);
        clock_sleep_until_ns(clock_now_ns() + NS_PER_MS);
    }
    assert_int_equal(kill(child, SIGKILL), 0);
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFSIGNALED(status));
    read_left(out);
    char command[2 * FIXTURE_PATH];
    snprintf(command, sizeof command, "rm -rf '%s'", with->folder);
    assert_int_equal(system(command), 0);
}

static void what_arrived_before_a_kill_is_recorded_as_if_it_had_been_performed(void **state)
{
    (void)state;
    left_show *performed = calloc(1, sizeof *performed), *killed = calloc(1, sizeof *killed);
    assert_true(performed && killed);
    if (access("/dev/shm", W_OK) != 0)
        skip();
    kill_one(true, performed);
    kill_one(false, killed);
    for (uint32_t side = 0; side < HANDS; ++side) {
        assert_int_equal(performed->hand[side].count, ARRIVED);
        if (killed->hand[side].count != ARRIVED)
            fail_msg("%u of %d samples are lost", ARRIVED - killed->hand[side].count, ARRIVED);
        for (uint32_t n = 0; n < ARRIVED; ++n) {
            const mrt_sample *a = &performed->hand[side].sample[n],
                             *b = &killed->hand[side].sample[n], given = sample_of(side, n);
            assert_int_equal(a->time_ns, b->time_ns);
            assert_int_equal(b->sequence, n);
            assert_memory_equal(a->value, given.value, sizeof given.value);
            assert_memory_equal(b->value, given.value, sizeof given.value);
        }
    }
    /* the two hands were one step each time, in what was not performed too */
    for (uint32_t n = PERFORMED; n < ARRIVED; ++n)
        assert_int_equal(killed->hand[MRT_LEFT].sample[n].time_ns,
                         killed->hand[MRT_RIGHT].sample[n].time_ns);
    free(performed);
    free(killed);
}

int main(void)
{
    with = mmap(NULL, sizeof *with, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_arrived_before_a_kill_is_recorded_as_if_it_had_been_performed),
    };
    return with == MAP_FAILED ? 1 : cmocka_run_group_tests(tests, NULL, NULL);
}
