/* The whole frame of a puppet that is performed: from a sample to positions and normals in the
 * file's order, step by step. */
#include "base/clock.h"
#include "bench/bench.h"
#include "base/installed.h"
#include "stage/live/live_board.h"
#include "stage/perform/performer.h"
#include "stage/mapping/plugins.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { STEP_MAP, STEP_CONSTRAIN, STEP_DEFORM, STEP_PUBLISH, STEP_FRAME, STEP_ALL, STEPS };
static const char *const step_name[STEPS] = {
    "3-5 hands, mapping, guard", "6 constrain", "7 deform, normals", "8 publish", "3-7", "3-8"};

typedef struct scene {
    bench *of;
    face_file face;
    log_queue *log;
    plugin_list plugins;
    instance mapping;
    performer *performer;
    channel_route route;
    live_board board;
    double *took_ms[STEPS];
    uint32_t frame;
    stamps_reader written, shaded;
    uint64_t written_count, shaded_count; /* blocks, since they were set to 0 */
} scene;

/* A hand that talks, smiles and nods, 100 times a second. */
static mrt_sample sample_of(uint32_t frame)
{
    mrt_sample out = {
        .time_ns = (int64_t)frame * NS_PER_S / 100, .sequence = frame, .count = MRT_ANGLES};
    double t = (double)frame / 100.0;
    for (int i = 0; i < MRT_ANGLES; ++i)
        out.value[i] = (float)(0.3 + 0.28 * sin(t * (1.1 + 0.37 * i) + i));
    return out;
}

static void route_hand(channel_route *out)
{
    mrt_channel channel[MRT_ANGLES];
    for (uint32_t i = 0; i < MRT_ANGLES; ++i)
        channel[i] = (mrt_channel){.name = "angle",
                                   .unit = "rad",
                                   .semantic = MRT_CH_ANGLE + i,
                                   .hand = MRT_RIGHT,
                                   .min = -3.0f,
                                   .max = 3.0f};
    channel_route_init(out, channel, MRT_ANGLES);
}

static double lap_ms(int64_t *from_ns)
{
    int64_t now_ns = clock_now_ns();
    double took_ms = (double)(now_ns - *from_ns) * 1e-6;
    *from_ns = now_ns;
    return took_ms;
}

/* As a stage does, for a window that takes each face. */
static void publish(scene *self)
{
    const live_view *taken;
    (void)live_board_fill(&self->board, performer_composer(self->performer), 0);
    live_board_publish(&self->board);
    (void)live_board_look(&self->board, &taken);
}

static uint32_t count_new(stamps_reader *seen, const stamps *written)
{
    uint32_t count = 0;
    for (uint32_t block = 0; block < written->count; ++block)
        count += stamps_is_new(seen, written, block);
    stamps_read(seen, written);
    return count;
}

static void count_blocks(scene *self)
{
    composer *shown = performer_composer(self->performer);
    self->written_count += count_new(&self->written, face_written(composer_face(shown)));
    self->shaded_count += count_new(&self->shaded, shading_written(composer_shading(shown)));
}

static void run_frame(scene *self, uint32_t round, bool is_cold)
{
    mrt_sample sample = sample_of(self->frame++);
    if (is_cold)
        bench_roof_flush(&self->of->roof);
    double took_ms[STEPS] = {0};
    int64_t at_ns = clock_now_ns();
    const sample_step next = sample_step_of(&self->route, &sample);
    performer_map(self->performer, &next);
    took_ms[STEP_MAP] = lap_ms(&at_ns);
    performer_constrain(self->performer, next.voice, next.due_ns);
    took_ms[STEP_CONSTRAIN] = lap_ms(&at_ns);
    performer_draw(self->performer);
    took_ms[STEP_DEFORM] = lap_ms(&at_ns);
    publish(self);
    took_ms[STEP_PUBLISH] = lap_ms(&at_ns);
    took_ms[STEP_FRAME] = took_ms[STEP_MAP] + took_ms[STEP_CONSTRAIN] + took_ms[STEP_DEFORM];
    took_ms[STEP_ALL] = took_ms[STEP_FRAME] + took_ms[STEP_PUBLISH];
    for (int i = 0; i < STEPS; ++i)
        self->took_ms[i][round] = took_ms[i];
    count_blocks(self);
}

static void tell(scene *self, const char *mapping, const char *caches, uint32_t count)
{
    for (int i = 0; i < STEPS; ++i) {
        char label[48], line[128];
        double p50 = bench_quantile(self->took_ms[i], count, 0.5);
        double p99 = bench_quantile(self->took_ms[i], count, 0.99);
        snprintf(label, sizeof label, "%s %s", mapping, caches);
        snprintf(line, sizeof line, "%-26s p50 %7.3f ms   p99 %7.3f ms", step_name[i], p50, p99);
        const facts_cell cells[] = {
            {"mapping", mapping, 0.0, 0},   {"caches", caches, 0.0, 0},
            {"step", step_name[i], 0.0, 0}, {"vertices", NULL, self->face.mesh.vertex_count, 0},
            {"p50_ms", NULL, p50, 4},       {"p99_ms", NULL, p99, 4},
        };
        facts_row(self->of->told, "frame", label, line, cells, sizeof cells / sizeof cells[0]);
    }
}

/* What the frames of a mapping wrote. */
static void tell_blocks(scene *self, const char *mapping, uint32_t count)
{
    char line[128];
    const face *f = composer_face(performer_composer(self->performer));
    double all = face_shown(f)->block_count, written = (double)self->written_count / count,
           shaded = (double)self->shaded_count / count;
    snprintf(line, sizeof line, "of %.0f blocks %.0f moved, %.0f with other normals, in the mean",
             all, written, shaded);
    const facts_cell cells[] = {
        {"mapping", mapping, 0.0, 0},
        {"blocks", NULL, all, 0},
        {"moved", NULL, written, 1},
        {"shaded", NULL, shaded, 1},
    };
    facts_row(self->of->told, "blocks", mapping, line, cells, sizeof cells / sizeof cells[0]);
}

static void promise(const scene *self, const char *mapping, uint32_t count)
{
    double p99_ms = bench_quantile(self->took_ms[STEP_FRAME], count, 0.99);
    if (strcmp(mapping, "anchored") == 0)
        bench_at_most_ms(self->of, "whole frame, anchored, 99 %", p99_ms, 0.25);
    if (strcmp(mapping, "unanchored") == 0)
        bench_at_most_ms(self->of, "whole frame, unanchored, 99 %", p99_ms, 1.0);
}

typedef enum limit_state { LIMITED = 0, NOT_LIMITED } limit_state;

/* Performed until it is hot. */
static mrt_result begin(scene *self, const char *mapping, limit_state limit, error *err)
{
    performer_settings settings = {.solver.radius = 0.0};
    const mrt_plugin_type *type = NULL;
    mrt_result result = plugin_list_find(&self->plugins, mapping, MRT_MAPPING, &type, err);
    if (result >= 0)
        result = instance_create(&self->mapping, type, CLOCK_VIRTUAL, self->log, err);
    if (limit == NOT_LIMITED) { /* of mappings that say nothing of it, and of those that do */
        settings.solver = self->face.rig->solver;
        settings.solver.stretch_most = -1.0;
    }
    if (result >= 0 && limit == NOT_LIMITED && strcmp(mapping, "one_hand") != 0)
        result = instance_set_text(&self->mapping, "stretch", "0", err);
    if (result >= 0)
        result = performer_create(&self->performer, &self->face, &self->mapping, &settings, err);
    if (result >= 0)
        result = live_board_create(&self->board, performer_composer(self->performer), err);
    self->frame = 0;
    for (uint32_t i = 0; i < 50 && result >= 0; ++i)
        run_frame(self, 0, false);
    self->written_count = self->shaded_count = 0;
    return result;
}

static void end(scene *self)
{
    live_board_destroy(&self->board);
    performer_destroy(self->performer);
    self->performer = NULL;
    instance_destroy(&self->mapping);
    self->mapping = (instance){0};
}

/* What the limit of folds and tears costs: the same frames once more without it. */
static mrt_result measure_limit(scene *self, const char *mapping, uint32_t count, double with_ms,
                                double with_99_ms, error *err)
{
    char line[128];
    mrt_result result = begin(self, mapping, NOT_LIMITED, err);
    for (uint32_t i = 0; i < count && result >= 0; ++i)
        run_frame(self, i, false);
    end(self);
    if (result < 0)
        return result;
    double plain_ms = bench_quantile(self->took_ms[STEP_FRAME], count, 0.5);
    double plain_99_ms = bench_quantile(self->took_ms[STEP_FRAME], count, 0.99);
    snprintf(line, sizeof line, "%-26s p50 %7.3f ms   p99 %7.3f ms, with it %.2f and %.2f x",
             "3-7 without the limit", plain_ms, plain_99_ms, with_ms / plain_ms,
             with_99_ms / plain_99_ms);
    const facts_cell cells[] = {
        {"mapping", mapping, 0.0, 0},
        {"p50_ms", NULL, plain_ms, 4},
        {"p99_ms", NULL, plain_99_ms, 4},
        {"p50_over", NULL, with_ms / plain_ms, 3},
        {"p99_over", NULL, with_99_ms / plain_99_ms, 3},
    };
    facts_row(self->of->told, "limit", mapping, line, cells, sizeof cells / sizeof cells[0]);
    return MRT_OK;
}

static mrt_result measure(scene *self, const char *mapping, error *err)
{
    uint32_t hot = self->of->is_quick ? 300 : 2000, cold = self->of->is_quick ? 40 : 300;
    double p50_ms = 0.0, p99_ms = 0.0;
    mrt_result result = begin(self, mapping, LIMITED, err);
    for (uint32_t i = 0; i < hot && result >= 0; ++i)
        run_frame(self, i, false);
    if (result >= 0) {
        tell(self, mapping, "hot", hot);
        tell_blocks(self, mapping, hot);
        promise(self, mapping, hot);
        p50_ms = bench_quantile(self->took_ms[STEP_FRAME], hot, 0.5);
        p99_ms = bench_quantile(self->took_ms[STEP_FRAME], hot, 0.99);
    }
    for (uint32_t i = 0; i < cold && result >= 0; ++i)
        run_frame(self, i, true);
    if (result >= 0)
        tell(self, mapping, "cold", cold);
    end(self);
    return result < 0 ? result : measure_limit(self, mapping, hot, p50_ms, p99_ms, err);
}

static mrt_result prepare(scene *self, error *err)
{
    char *path = installed_face("puppet");
    mrt_result result = path ? MRT_OK : error_set(err, MRT_ERR_MEMORY, "no memory");
    if (result >= 0)
        result = face_file_read(&self->face, path, NULL, FACE_FILE_USABLE, err);
    free(path);
    if (result >= 0)
        result = plugin_list_load(&self->plugins, err);
    if (result < 0)
        return result;
    self->log = log_queue_create();
    bool is_there = self->log != NULL;
    for (int i = 0; i < STEPS; ++i) {
        self->took_ms[i] = calloc(2000, sizeof(double));
        is_there = is_there && self->took_ms[i];
    }
    route_hand(&self->route);
    return is_there ? MRT_OK : error_set(err, MRT_ERR_MEMORY, "no memory for the bench's frame");
}

mrt_result bench_frame(bench *self, error *err)
{
    static const char *const mappings[] = {"one_hand", "anchored", "unanchored"};
    scene s = {.of = self};
    bench_title(self, "The whole frame on the puppet, one thread; cold: after other work");
    mrt_result result = prepare(&s, err);
    for (size_t i = 0; i < sizeof mappings / sizeof mappings[0] && result >= 0; ++i)
        result = measure(&s, mappings[i], err);
    for (int i = 0; i < STEPS; ++i)
        free(s.took_ms[i]);
    plugin_list_destroy(&s.plugins);
    log_queue_destroy(s.log);
    face_file_destroy(&s.face);
    return result;
}
