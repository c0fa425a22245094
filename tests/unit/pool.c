/* The pool: how many threads, that every part is done once, when it works alone, its life. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "base/clock.h"
#include "base/cpu.h"
#include "base/pool.h"

#include <errno.h>
#include <fenv.h>
#include <math.h>
#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

enum { PARTS_MAX = 1000, PATIENCE_S = 60 };

static void use_threads(const char *word)
{
    if (word)
        assert_int_equal(setenv("MAROTTE_THREADS", word, 1), 0);
    else
        assert_int_equal(unsetenv("MAROTTE_THREADS"), 0);
}

/* ---- how many ---- */

static void a_number_from_1_to_16_is_taken(void **state)
{
    (void)state;
    for (uint32_t wanted = 1; wanted <= POOL_THREADS_MAX; ++wanted) {
        char word[16];
        uint32_t count = 99;
        error err = {""};
        snprintf(word, sizeof word, "%u", wanted);
        assert_int_equal(pool_choose(&count, word, &err), MRT_OK);
        assert_int_equal(count, wanted);
    }
}

static void anything_else_is_refused_and_said(void **state)
{
    (void)state;
    static const char *const words[] = {"0",
                                        "17",
                                        "-1",
                                        "+2",
                                        "two",
                                        "2 ",
                                        " 2",
                                        "2.0",
                                        "1e1",
                                        "0x2",
                                        "all",
                                        "4294967297",
                                        "99999999999999999999999999",
                                        "-"};
    for (size_t i = 0; i < sizeof words / sizeof *words; ++i) {
        uint32_t count = 99;
        error err = {""};
        assert_int_equal(pool_choose(&count, words[i], &err), MRT_ERR_ARGUMENT);
        assert_non_null(strstr(err.text, "MAROTTE_THREADS="));
        assert_non_null(strstr(err.text, words[i]));
        assert_non_null(strstr(err.text, "from 1 to 16"));
        assert_in_range(count, 1, 4);
    }
}

static void nothing_is_one_for_each_cpu_at_most_4(void **state)
{
    (void)state;
    uint32_t unset = 0, empty = 0, cpus = cpu_count();
    assert_int_equal(pool_choose(&unset, NULL, NULL), MRT_OK);
    assert_int_equal(pool_choose(&empty, "", NULL), MRT_OK);
    assert_int_equal(unset, cpus < 4 ? cpus : 4);
    assert_int_equal(empty, unset);
}

static void the_environment_is_heard(void **state)
{
    (void)state;
    error err = {""};
    use_threads("3");
    assert_int_equal(pool_threads(), 3);
    assert_int_equal(pool_check(&err), MRT_OK);
    use_threads("many");
    assert_int_equal(pool_check(&err), MRT_ERR_ARGUMENT);
    assert_in_range(pool_threads(), 1, 4);
    use_threads(NULL);
    assert_int_equal(pool_check(&err), MRT_OK);
}

/* ---- work ---- */

typedef struct tally {
    _Atomic uint32_t done[PARTS_MAX]; /* how often */
    _Atomic uint32_t call_count, widest, stranger_count;
    pthread_t caller;
} tally;

static void count_parts(void *data, uint32_t first, uint32_t end)
{
    tally *t = data;
    uint32_t wide = end - first, widest = atomic_load(&t->widest);
    atomic_fetch_add(&t->call_count, 1);
    if (!pthread_equal(pthread_self(), t->caller))
        atomic_fetch_add(&t->stranger_count, 1);
    while (wide > widest && !atomic_compare_exchange_weak(&t->widest, &widest, wide))
        continue;
    for (uint32_t part = first; part < end; ++part)
        atomic_fetch_add(&t->done[part], 1);
}

static void run_tally(tally *t, uint32_t part_count, uint32_t grain, double cost_ns)
{
    memset(t, 0, sizeof *t);
    t->caller = pthread_self();
    const pool_work work = {.run = count_parts,
                            .data = t,
                            .part_count = part_count,
                            .grain = grain,
                            .cost_ns = cost_ns};
    pool_run(&work);
}

static void expect_each_part_once(const tally *t, uint32_t part_count)
{
    for (uint32_t part = 0; part < PARTS_MAX; ++part)
        assert_int_equal(t->done[part], part < part_count);
}

static void every_part_is_done_once(void **state)
{
    (void)state;
    static const char *const threads[] = {"1", "2", "3", "16"};
    static const uint32_t counts[] = {0, 1, 2, 3, 7, 8, 9, 63, 64, 65, 997, PARTS_MAX};
    static const uint32_t grains[] = {1, 2, 7, 64, 2000};
    static tally t;
    for (size_t i = 0; i < sizeof threads / sizeof *threads; ++i) {
        use_threads(threads[i]);
        pool_hold();
        for (size_t c = 0; c < sizeof counts / sizeof *counts; ++c)
            for (size_t g = 0; g < sizeof grains / sizeof *grains; ++g)
                for (int again = 0; again < 3; ++again) {
                    run_tally(&t, counts[c], grains[g], INFINITY);
                    expect_each_part_once(&t, counts[c]);
                }
        pool_release();
    }
}

/* Parts that wait until somebody else is at work too. */
static void wait_for_company(void *data, uint32_t first, uint32_t end)
{
    tally *t = data;
    int64_t end_ns = clock_now_ns() + PATIENCE_S * NS_PER_S;
    count_parts(data, first, end);
    while (atomic_load(&t->stranger_count) == 0 && clock_now_ns() < end_ns)
        sched_yield();
}

static void work_that_is_worth_it_is_shared(void **state)
{
    (void)state;
    static tally t;
    use_threads("2");
    pool_hold();
    const uint64_t before = pool_state_now().shared_count;
    for (int again = 0; again < 20; ++again) {
        memset(&t, 0, sizeof t);
        t.caller = pthread_self();
        const pool_work work = {.run = wait_for_company,
                                .data = &t,
                                .part_count = 10,
                                .grain = 1,
                                .cost_ns = POOL_WORTH_NS};
        pool_run(&work);
        assert_true(t.stranger_count > 0);
        assert_int_equal(t.widest, 1);
        expect_each_part_once(&t, 10);
    }
    assert_int_equal(pool_state_now().shared_count, before + 20);
    pool_release();
}

static void small_work_is_done_by_the_caller_in_one_go(void **state)
{
    (void)state;
    static tally t;
    use_threads("3");
    pool_hold();
    const uint64_t before = pool_state_now().shared_count;
    run_tally(&t, 100, 1, POOL_WORTH_NS * 0.99);
    assert_int_equal(t.call_count, 1);
    assert_int_equal(t.stranger_count, 0);
    expect_each_part_once(&t, 100);
    run_tally(&t, 100, 1, (double)NAN);
    assert_int_equal(t.call_count, 1);
    assert_int_equal(pool_state_now().shared_count, before);
    pool_release();
}

static void with_one_thread_nothing_is_shared(void **state)
{
    (void)state;
    static tally t;
    use_threads("1");
    pool_hold();
    assert_int_equal(pool_state_now().worker_count, 0);
    run_tally(&t, 100, 1, INFINITY);
    assert_int_equal(t.call_count, 1);
    pool_release();
}

static void nobody_holds_it_and_the_caller_works_alone(void **state)
{
    (void)state;
    static tally t;
    use_threads("4");
    run_tally(&t, 100, 1, INFINITY);
    assert_int_equal(t.call_count, 1);
    expect_each_part_once(&t, 100);
}

typedef struct nest {
    tally inner[8];
} nest;

static void run_inner(void *data, uint32_t first, uint32_t end)
{
    nest *n = data;
    for (uint32_t part = first; part < end; ++part)
        run_tally(&n->inner[part], 100, 1, INFINITY);
}

static void a_piece_within_a_piece_is_done_alone(void **state)
{
    (void)state;
    static nest n;
    use_threads("3");
    pool_hold();
    const pool_work work = {
        .run = run_inner, .data = &n, .part_count = 8, .grain = 1, .cost_ns = INFINITY};
    pool_run(&work);
    for (int i = 0; i < 8; ++i) {
        assert_int_equal(n.inner[i].call_count, 1);
        expect_each_part_once(&n.inner[i], 100);
    }
    pool_release();
}

enum { USERS = 4, PIECES = 400 };

typedef struct user {
    pthread_t thread;
    tally t;
    uint32_t wrong_count;
} user;

static void *use_pool(void *data)
{
    user *self = data;
    for (uint32_t i = 0; i < PIECES; ++i) {
        uint32_t count = 1 + i * 7 % PARTS_MAX;
        run_tally(&self->t, count, 1 + i % 5, INFINITY);
        for (uint32_t part = 0; part < PARTS_MAX; ++part)
            self->wrong_count += self->t.done[part] != (part < count);
    }
    return NULL;
}

static void several_users_at_once_get_their_own_work_done(void **state)
{
    (void)state;
    static user users[USERS];
    use_threads("3");
    pool_hold();
    for (int i = 0; i < USERS; ++i)
        assert_int_equal(pthread_create(&users[i].thread, NULL, use_pool, &users[i]), 0);
    for (int i = 0; i < USERS; ++i) {
        assert_int_equal(pthread_join(users[i].thread, NULL), 0);
        assert_int_equal(users[i].wrong_count, 0);
    }
    pool_release();
}

static void round_up(void *data, uint32_t first, uint32_t end)
{
    double *out = data;
    for (uint32_t part = first; part < end; ++part) {
        volatile double one = 1.0, little = 0x1p-60;
        out[part] = one + little;
        sched_yield(); /* the others come to take some */
    }
}

static void workers_compute_in_the_callers_environment(void **state)
{
    (void)state;
    static double out[PARTS_MAX];
    use_threads("3");
    pool_hold();
    static const int directions[] = {FE_UPWARD, FE_TONEAREST, FE_UPWARD};
    for (size_t i = 0; i < sizeof directions / sizeof *directions; ++i) {
        const pool_work work = {
            .run = round_up, .data = out, .part_count = PARTS_MAX, .grain = 1, .cost_ns = INFINITY};
        assert_int_equal(fesetround(directions[i]), 0);
        pool_run(&work);
        assert_int_equal(fesetround(FE_TONEAREST), 0);
        double expected = directions[i] == FE_UPWARD ? 1.0 + 0x1p-52 : 1.0;
        for (int part = 0; part < PARTS_MAX; ++part)
            assert_true(out[part] >= expected && out[part] <= expected);
    }
    pool_release();
}

/* ---- its life ---- */

static void wait_until_all_sleep(void)
{
    int64_t end_ns = clock_now_ns() + PATIENCE_S * NS_PER_S;
    pool_state now = pool_state_now();
    while (now.asleep_count < now.worker_count && clock_now_ns() < end_ns) {
        sched_yield();
        now = pool_state_now();
    }
    assert_int_equal(now.asleep_count, now.worker_count);
}

static void workers_sleep_when_there_is_nothing_to_do_and_wake_again(void **state)
{
    (void)state;
    static tally t;
    use_threads("3");
    pool_hold();
    assert_int_equal(pool_state_now().worker_count, 2);
    for (int again = 0; again < 20; ++again) {
        wait_until_all_sleep();
        memset(&t, 0, sizeof t);
        t.caller = pthread_self();
        const pool_work work = {
            .run = wait_for_company, .data = &t, .part_count = 50, .grain = 1, .cost_ns = INFINITY};
        pool_run(&work);
        assert_true(t.stranger_count > 0);
        expect_each_part_once(&t, 50);
    }
    pool_release();
}

static void the_first_hold_starts_workers_and_the_last_release_ends_them(void **state)
{
    (void)state;
    use_threads("4");
    pool_hold();
    assert_int_equal(pool_state_now().worker_count, 3);
    use_threads("2");
    pool_hold(); /* it is there already */
    assert_int_equal(pool_state_now().worker_count, 3);
    pool_release();
    assert_int_equal(pool_state_now().worker_count, 3);
    pool_release();
    assert_int_equal(pool_state_now().worker_count, 0);
    pool_hold();
    assert_int_equal(pool_state_now().worker_count, 1);
    pool_release();
}

static void it_may_begin_and_end_at_any_moment(void **state)
{
    (void)state;
    static tally t;
    static const char *const threads[] = {"2", "3", "5"};
    for (uint32_t i = 0; i < 300; ++i) {
        use_threads(threads[i % 3]);
        pool_hold();
        for (uint32_t piece = 0; piece < i % 4; ++piece) {
            run_tally(&t, PARTS_MAX - i, 3, INFINITY);
            expect_each_part_once(&t, PARTS_MAX - i);
        }
        if (i % 50 == 7)
            wait_until_all_sleep();
        pool_release();
    }
    assert_int_equal(pool_state_now().worker_count, 0);
}

/* What the child finds wrong, as its exit code. */
static int work_in_child(void)
{
    static tally t;
    if (pool_state_now().worker_count != 0)
        return 1;
    run_tally(&t, PARTS_MAX, 1, INFINITY);
    if (t.call_count != 1 || t.stranger_count != 0)
        return 2;
    for (uint32_t part = 0; part < PARTS_MAX; ++part)
        if (t.done[part] != 1)
            return 3;
    pool_hold();
    run_tally(&t, PARTS_MAX, 1, INFINITY);
    pool_release();
    pool_release(); /* the parent's */
    return 0;
}

static int exit_code_of(pid_t child)
{
    int status = 0;
    while (waitpid(child, &status, 0) < 0)
        if (errno != EINTR)
            return -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static void a_forked_child_works_alone_and_the_parent_goes_on(void **state)
{
    (void)state;
    static tally t;
    use_threads("3");
    pool_hold();
    for (int again = 0; again < 5; ++again) {
        run_tally(&t, PARTS_MAX, 1, INFINITY);
        pid_t child = fork();
        assert_true(child >= 0);
        if (child == 0)
            _exit(work_in_child());
        run_tally(&t, PARTS_MAX, 1, INFINITY);
        expect_each_part_once(&t, PARTS_MAX);
        assert_int_equal(exit_code_of(child), 0);
    }
    assert_int_equal(pool_state_now().worker_count, 2);
    pool_release();
}

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define MEMORY_CAN_BE_LIMITED 0
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define MEMORY_CAN_BE_LIMITED 0
#endif
#endif
#ifndef MEMORY_CAN_BE_LIMITED
#define MEMORY_CAN_BE_LIMITED 1
#endif

static int work_with_little_memory(void)
{
    static tally t;
    const struct rlimit none = {.rlim_cur = 0, .rlim_max = 0};
    if (setrlimit(RLIMIT_AS, &none) != 0) /* no stacks but those of threads that have ended */
        return 1;
    pool_hold();
    if (pool_state_now().worker_count >= POOL_THREADS_MAX - 1)
        return 2;
    run_tally(&t, PARTS_MAX, 1, INFINITY);
    pool_release();
    for (uint32_t part = 0; part < PARTS_MAX; ++part)
        if (t.done[part] != 1)
            return 3;
    return 0;
}

static void where_threads_cannot_be_had_there_are_fewer(void **state)
{
    (void)state;
    if (!MEMORY_CAN_BE_LIMITED) {
        print_message("SKIPPED: the sanitizer needs memory of its own\n");
        skip();
    }
    if (getenv("QEMU_LD_PREFIX")) {
        print_message("SKIPPED: qemu-user has memory of its own\n");
        skip();
    }
    use_threads("16");
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0)
        _exit(work_with_little_memory());
    assert_int_equal(exit_code_of(child), 0);
}

static int restore(void **state)
{
    (void)state;
    return unsetenv("MAROTTE_THREADS");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_number_from_1_to_16_is_taken),
        cmocka_unit_test(anything_else_is_refused_and_said),
        cmocka_unit_test(nothing_is_one_for_each_cpu_at_most_4),
        cmocka_unit_test(the_environment_is_heard),
        cmocka_unit_test(every_part_is_done_once),
        cmocka_unit_test(work_that_is_worth_it_is_shared),
        cmocka_unit_test(small_work_is_done_by_the_caller_in_one_go),
        cmocka_unit_test(with_one_thread_nothing_is_shared),
        cmocka_unit_test(nobody_holds_it_and_the_caller_works_alone),
        cmocka_unit_test(a_piece_within_a_piece_is_done_alone),
        cmocka_unit_test(several_users_at_once_get_their_own_work_done),
        cmocka_unit_test(workers_compute_in_the_callers_environment),
        cmocka_unit_test(workers_sleep_when_there_is_nothing_to_do_and_wake_again),
        cmocka_unit_test(the_first_hold_starts_workers_and_the_last_release_ends_them),
        cmocka_unit_test(it_may_begin_and_end_at_any_moment),
        cmocka_unit_test(a_forked_child_works_alone_and_the_parent_goes_on),
        cmocka_unit_test(where_threads_cannot_be_had_there_are_fewer),
    };
    return cmocka_run_group_tests(tests, NULL, restore);
}
