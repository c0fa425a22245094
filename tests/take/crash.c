/* A program that is killed while it records, and a computer that loses power: every show opens, and
 * nothing that was there 100 ms before is missing or different. What had arrived and was not
 * performed: crash_held.c.
 *
 *   test_take_crash               20 kills and 200 power cuts
 *   test_take_crash --long        300 kills, 2000 power cuts
 *   test_take_crash KILLS CUTS [SEED]
 *
 * A child records two tracks at 150 Hz in real time and writes down, in memory that it shares with
 * us, how many samples it gave and when. We kill it at a random instant and open what it left. On a
 * busy machine its threads wait for their turns, which it measures by one that only sleeps: so much
 * more may be missing. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/file.h"
#include "take/show_scene.h"

#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <sys/mman.h>
#include <sys/wait.h>

enum {
    TRACKS = 2,
    SAMPLES_MAX = 3000,
    AT_A_TIME = 4, /* children, which are asleep most of the time */
    SHORTEST_MS = 60,
    LONGEST_MS = 1400,
    LOSS_MS = 100,
    BEATS = 256,
    BEAT_MS = 4
};

static int kill_count = 20, cut_count = 200;
static uint64_t seed = 1;

typedef struct shared {
    _Atomic int64_t given[TRACKS];                 /* samples */
    _Atomic int64_t given_ns[TRACKS][SAMPLES_MAX]; /* when, on our clock */
    _Atomic int64_t take_ns;                       /* when the take was begun; 0: not yet */
    _Atomic bool is_ready;
    _Atomic int64_t beat_ns[BEATS]; /* when the thread that only sleeps had its turns, in a ring */
    _Atomic uint32_t beats;
} shared;

/* ---- the child ---- */

static void *beat(void *data)
{
    shared *with = data;
    for (;;) {
        uint32_t n = atomic_load(&with->beats);
        atomic_store(&with->beat_ns[n % BEATS], clock_now_ns());
        atomic_store(&with->beats, n + 1);
        clock_sleep_until_ns(clock_now_ns() + BEAT_MS * NS_PER_MS);
    }
    return NULL;
}

static mrt_result start(writer **out, show *s, int64_t track[TRACKS], error *err)
{
    writer_options options = scene_options();
    mrt_result result = writer_start(out, s, &options, err);
    take_performance performance = scene_performance(0);
    performance.track_count = TRACKS;
    for (int i = 0; i < TRACKS && result >= 0; ++i) {
        take_track made = scene_track("test:");
        result = writer_add_track(*out, &made, err);
        track[i] = performance.track[i] = made.id;
    }
    return result < 0 ? result : writer_begin_performance(*out, &performance, 0, err);
}

static void give(writer *w, const int64_t track[TRACKS], int64_t n, shared *with)
{
    for (int i = 0; i < TRACKS; ++i) {
        mrt_sample sample = scene_sample(track[i], n);
        writer_sample(w, track[i], &sample);
        atomic_store(&with->given_ns[i][n], clock_now_ns());
        atomic_store(&with->given[i], n + 1);
    }
}

static void record_until_killed(const char *path, shared *with)
{
    error err;
    show *s;
    writer *w;
    int64_t track[TRACKS], take_id;
    pthread_t beating;
    if (pthread_create(&beating, NULL, beat, with) != 0)
        _exit(3);
    if (show_create(&s, path, &err) < 0 || start(&w, s, track, &err) < 0 ||
        writer_flush(w, &err) < 0)
        _exit(3);
    int64_t begun_ns = clock_now_ns();
    atomic_store(&with->is_ready, true);
    for (int64_t n = 0; n < SAMPLES_MAX; ++n) {
        clock_sleep_until_ns(begun_ns + n * scene_step_ns);
        give(w, track, n, with);
        if (n == 5) {
            if (writer_take_begin(w, 5 * scene_step_ns, &(writer_slate){0}, &take_id, &err) < 0)
                _exit(3);
            atomic_store(&with->take_ns, clock_now_ns());
        }
        void *buffer = n % 100 == 50 ? writer_checkpoint_buffer(w) : NULL;
        if (buffer) {
            memset(buffer, (int)n, 50000);
            writer_checkpoint(w, 1, n * scene_step_ns, 1, buffer, 50000);
        }
    }
    _exit(4); /* nobody killed us */
}

/* ---- what it left ---- */

/* Samples of the track in the show; each is compared with what was given. */
static int64_t count_right(show *s, int64_t track)
{
    error err = {""};
    show_reader *reader;
    mrt_sample got;
    mrt_result result;
    int64_t n = 0;
    scene_must(show_reader_open(&reader, s, track, INT64_MIN, INT64_MAX, &err), &err);
    while ((result = show_reader_next(reader, &got, &err)) == MRT_OK) {
        mrt_sample expected = scene_shown(track, n++);
        if (!scene_is_same(&got, &expected))
            fail_msg("track %lld: sample %lld differs", (long long)track, (long long)n - 1);
    }
    if (result < 0)
        fail_msg("%s", err.text);
    show_reader_close(reader);
    return n;
}

/* What may be lost: 100 ms, and thrice the longest that a thread has waited for its turn shortly
 * before: to hand samples over, to wake up, to write. */
static double may_lose_ms(const shared *with, int64_t killed_ns)
{
    uint32_t beats = atomic_load(&with->beats);
    int64_t longest_ns = 0, next_ns = killed_ns;
    for (uint32_t back = 1; back <= beats && back < BEATS; ++back) {
        int64_t beat_ns = atomic_load(&with->beat_ns[(beats - back) % BEATS]);
        int64_t late_ns = next_ns - beat_ns - BEAT_MS * NS_PER_MS;
        longest_ns = late_ns > longest_ns ? late_ns : longest_ns;
        next_ns = beat_ns;
    }
    return LOSS_MS + 3 * (double)longest_ns * 1e-6;
}

static void check_take(show *s, const shared *with, int64_t killed_ns)
{
    error err = {""};
    show_take *takes;
    size_t count;
    scene_must(show_takes(s, &takes, &count, &err), &err);
    int64_t take_ns = atomic_load(&with->take_ns);
    if (take_ns > 0 && (double)(killed_ns - take_ns) * 1e-6 > may_lose_ms(with, killed_ns))
        assert_int_equal(count, 1);
    for (size_t i = 0; i < count; ++i)
        assert_true(takes[i].is_recovered && !takes[i].is_recording);
    free(takes);
}

/* The age of the oldest sample that is missing, in ms. */
static double check_after_kill(const char *path, const shared *with, int64_t killed_ns)
{
    error err = {""};
    show *s;
    double lost_ms = 0;
    scene_must(show_open(&s, path, SHOW_WRITE, &err), &err);
    assert_true(show_is_writable(s));
    for (int i = 0; i < TRACKS; ++i) {
        int64_t right = count_right(s, i + 1), given = atomic_load(&with->given[i]);
        if (right < given) {
            double ms = (double)(killed_ns - atomic_load(&with->given_ns[i][right])) * 1e-6;
            lost_ms = ms > lost_ms ? ms : lost_ms;
        }
    }
    check_take(s, with, killed_ns);
    show_close(s);
    double may_ms = may_lose_ms(with, killed_ns);
    if (lost_ms > may_ms)
        fail_msg("%.1f ms are lost, of at most %.1f", lost_ms, may_ms);
    return lost_ms;
}

typedef struct victim {
    pid_t child;
    char path[SCENE_PATH + 32];
    shared *with;
    int64_t kill_ns;
} victim;

static void begin(victim *out, const scene *s, int number)
{
    snprintf(out->path, sizeof out->path, "%s/kill_%d.marotte", s->folder, number);
    out->with =
        mmap(NULL, sizeof *out->with, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    assert_ptr_not_equal(out->with, MAP_FAILED);
    out->child = fork();
    if (out->child == 0)
        record_until_killed(out->path, out->with);
    assert_true(out->child > 0);
    while (!atomic_load(&out->with->is_ready))
        clock_sleep_until_ns(clock_now_ns() + NS_PER_MS);
    uint64_t random = scene_random(seed * 100003 + (uint64_t)number);
    out->kill_ns = clock_now_ns() + SHORTEST_MS * NS_PER_MS +
                   (int64_t)(random % ((LONGEST_MS - SHORTEST_MS) * (uint64_t)NS_PER_MS));
}

static double end(victim *v)
{
    int status;
    clock_sleep_until_ns(v->kill_ns);
    assert_int_equal(kill(v->child, SIGKILL), 0);
    int64_t killed_ns = clock_now_ns();
    assert_int_equal(waitpid(v->child, &status, 0), v->child);
    assert_true(WIFSIGNALED(status));
    double lost_ms = check_after_kill(v->path, v->with, killed_ns);
    munmap(v->with, sizeof *v->with);
    return lost_ms;
}

static int by_kill_time(const void *a, const void *b)
{
    int64_t x = ((const victim *)a)->kill_ns, y = ((const victim *)b)->kill_ns;
    return (x > y) - (x < y);
}

static void a_kill_loses_at_most_100_ms(void **state)
{
    (void)state;
    scene s;
    double worst_ms = 0, sum_ms = 0;
    scene_make(&s);
    for (int done = 0; done < kill_count; done += AT_A_TIME) {
        victim victims[AT_A_TIME];
        int count = kill_count - done < AT_A_TIME ? kill_count - done : AT_A_TIME;
        for (int i = 0; i < count; ++i)
            begin(&victims[i], &s, done + i);
        qsort(victims, (size_t)count, sizeof victims[0], by_kill_time);
        for (int i = 0; i < count; ++i) {
            double lost_ms = end(&victims[i]);
            worst_ms = lost_ms > worst_ms ? lost_ms : worst_ms;
            sum_ms += lost_ms;
        }
    }
    print_message("%d kills: %.1f ms lost at most, %.1f ms in the mean\n", kill_count, worst_ms,
                  sum_ms / kill_count);
    scene_remove(&s);
}

/* ---- power cuts: what had not reached the disk is gone ---- */

/* The state of the files at some instants of a recording; what a file system may leave of them. */
enum { STATES = 12 };
typedef struct disk_state {
    file_bytes show, log;
    int64_t committed; /* samples a track in it */
} disk_state;

static void copy_state(disk_state *out, const scene *s, int64_t committed)
{
    char log[SCENE_PATH + 8];
    error err = {""};
    snprintf(log, sizeof log, "%s-wal", s->path);
    scene_must(file_read(&out->show, s->path, 1 << 28, &err), &err);
    scene_must(file_read(&out->log, log, 1 << 28, &err), &err);
    out->committed = committed;
}

static void record_states(disk_state states[STATES], const scene *s, int64_t track[TRACKS])
{
    error err = {""};
    show *made;
    writer *w;
    static shared unused;
    scene_must(show_create(&made, s->path, &err), &err);
    scene_must(start(&w, made, track, &err), &err);
    for (int64_t i = 0; i < STATES; ++i) {
        for (int64_t n = i * 240; n < (i + 1) * 240; ++n) {
            give(w, track, n, &unused);
            if (n % 8 == 7)
                scene_must(writer_flush(w, &err), &err);
        }
        copy_state(&states[i], s, (i + 1) * 240);
    }
    scene_must(writer_stop(w, &err), &err);
    show_close(made);
}

static void write_bytes(const char *path, const uint8_t *bytes, size_t size)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

/* The log ends anywhere, or some of its last blocks never arrived: zeros, or what was there before.
 */
static void cut_power(const disk_state *at, const char *path, uint64_t random)
{
    char log_path[SCENE_PATH + 40];
    snprintf(log_path, sizeof log_path, "%s-wal", path);
    uint8_t *log = malloc(at->log.size);
    assert_non_null(log);
    memcpy(log, at->log.data, at->log.size);
    size_t size = at->log.size;
    if (random % 3 == 0) {
        size = (size_t)(random >> 8) % (size + 1);
    } else {
        size_t first = (size_t)(random >> 8) % size / 512 * 512;
        for (size_t block = first; block < size; block += 512) {
            uint64_t fate = scene_random(random + block);
            size_t length = size - block < 512 ? size - block : 512;
            if (fate % 4 == 0)
                memset(log + block, 0, length);
            else if (fate % 4 == 1 && block >= 4096 + 512)
                memmove(log + block, log + block - 4096 - 24, length);
        }
    }
    write_bytes(path, at->show.data, at->show.size);
    write_bytes(log_path, log, size);
    free(log);
}

static void a_power_cut_leaves_a_consistent_beginning(void **state)
{
    (void)state;
    scene s;
    static disk_state states[STATES];
    int64_t track[TRACKS], least = INT64_MAX, most = 0;
    scene_make(&s);
    record_states(states, &s, track);
    for (int i = 0; i < cut_count; ++i) {
        char path[SCENE_PATH + 32];
        error err = {""};
        show *opened;
        uint64_t random = scene_random(seed * 1000003 + (uint64_t)i);
        const disk_state *at = &states[random % STATES];
        snprintf(path, sizeof path, "%s/cut.marotte", s.folder);
        cut_power(at, path, random >> 5);
        scene_must(show_open(&opened, path, SHOW_WRITE, &err), &err);
        assert_true(show_is_writable(opened));
        int64_t right = INT64_MAX;
        int64_t *ids;
        size_t count;
        scene_must(show_track_ids(opened, &ids, &count, &err), &err);
        for (size_t k = 0; k < count; ++k) {
            int64_t n = count_right(opened, ids[k]);
            right = n < right ? n : right;
            assert_true(n <= at->committed);
        }
        free(ids);
        right = count ? right : 0;
        least = right < least ? right : least;
        most = right > most ? right : most;
        show_close(opened);
        unlink(path);
    }
    print_message("%d power cuts: every show opened; %lld to %lld samples a track\n", cut_count,
                  (long long)least, (long long)most);
    assert_true(most > least);
    for (int i = 0; i < STATES; ++i) {
        file_bytes_finish(&states[i].show);
        file_bytes_finish(&states[i].log);
    }
    scene_remove(&s);
}

int main(int count, char **arguments)
{
    if (count == 2 && strcmp(arguments[1], "--long") == 0) {
        kill_count = 300;
        cut_count = 2000;
    } else if (count >= 3) {
        kill_count = (int)strtol(arguments[1], NULL, 10);
        cut_count = (int)strtol(arguments[2], NULL, 10);
        seed = count > 3 ? strtoull(arguments[3], NULL, 10) : 1;
    }
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_kill_loses_at_most_100_ms),
        cmocka_unit_test(a_power_cut_leaves_a_consistent_beginning),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
