/* What keeping the state of a performance costs the frame thread, and what it costs to bring a take
 * to an instant: for each mapping on the puppet, with the demo hand; processor time. Prints; gates
 * nothing. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "unit/sequencer_scene.h"

#include <time.h>

enum { SEEKS = 200 };

static int compare(const void *a, const void *b)
{
    const double *x = a, *y = b;
    return (*x > *y) - (*x < *y);
}

static void report(const char *what, double *cost, size_t count, const char *unit)
{
    qsort(cost, count, sizeof *cost, compare);
    print_message("  %-34s p50 %8.1f   p99 %8.1f   max %8.1f %s\n", what, cost[count / 2],
                  cost[count * 99 / 100], cost[count - 1], unit);
}

/* Of this thread: what others do on the machine does not count. */
static int64_t worked_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (int64_t)now.tv_sec * NS_PER_S + now.tv_nsec;
}

static double since_us(int64_t begin_ns)
{
    return (double)(worked_ns() - begin_ns) / 1e3;
}

static const scene_play plays[] = {
    {.mapping = "anchored", .face = "puppet", .params = "gate=off"},
    {.mapping = "unanchored", .face = "puppet", .params = "gate=off"},
    {.mapping = "one_hand", .face = "puppet", .params = ""}};

static void print_saves(const scene_play *play, const face_file *file)
{
    enum { SAMPLES = 600 };
    static double cost[SAMPLES];
    scene_stand s;
    unsigned char *bytes = malloc(8 << 20);
    size_t size = 0;
    assert_non_null(bytes);
    scene_stand_up(&s, play, file);
    for (uint32_t n = 0; n < SAMPLES; ++n) {
        scene_step(&s, play, n % 200);
        int64_t begin_ns = worked_ns();
        size = performer_save(s.performer, bytes, 8 << 20);
        cost[n] = since_us(begin_ns);
    }
    print_message("%s on the %s: %zu bytes\n", play->mapping, play->face, size);
    report("performer_save", cost, SAMPLES, "us");
    scene_lay_down(&s);
    free(bytes);
}

/* Over the whole take, as somebody who scrubs: each as far from the last as can be. */
static void print_seeks(film *f, size_t checkpoint_bytes, const char *what)
{
    static double cost[SEEKS];
    error err = {""};
    take t = {0};
    film_take(f, &t);
    sequencer *s = film_project(f, &t, checkpoint_bytes);
    if (checkpoint_bytes == 0) { /* played once: instants are kept */
        int64_t begin_ns = worked_ns();
        (void)film_play_to(s, t.duration_ns - 1);
        print_message("  %-34s %12.1f us a sample\n", "played",
                      since_us(begin_ns) / (double)sequencer_sample_count(s));
    }
    for (int i = 0; i < SEEKS; ++i) {
        uint64_t random = (uint64_t)(i + 1) * UINT64_C(0x9e3779b97f4a7c15);
        int64_t at_ns = (int64_t)(random % (uint64_t)t.duration_ns);
        int64_t begin_ns = worked_ns();
        scene_must(sequencer_seek(s, at_ns, &err), &err);
        composer_draw(sequencer_performer(s)->composer);
        cost[i] = since_us(begin_ns) / 1e3;
    }
    report(what, cost, SEEKS, "ms");
    sequencer_destroy(s);
    take_finish(&t);
}

static void print_costs(void **state)
{
    (void)state;
    for (int i = 0; i < 3; ++i) {
        film *f = film_shoot(&plays[i], FILM_DEMO, "", 1.0);
        print_saves(&plays[i], &f->file);
        print_seeks(f, 1, "seek, states of the show alone");
        print_seeks(f, 0, "seek, after it was played once");
        film_burn(f);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(print_costs)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
