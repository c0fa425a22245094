/* The puppet performed: the whole frame, step by step, and the stage with its threads. */
#include "base/clock.h"
#include "base/installed.h"
#include "base/percentile.h"
#include "bench/bench.h"
#include "draw/draw.h"
#include "stage/input/feed.h"
#include "stage/live/live.h"
#include "stage/live/live_board.h"
#include "stage/mapping/plugins.h"
#include "stage/perform/performer.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct puppet {
    char *path;
    face_file face;
    log_queue *log;
    plugin_list plugins;
} puppet;

/* To be closed whatever the result. */
static mrt_result open_puppet(puppet *out, error *err)
{
    *out = (puppet){.path = installed_path(INSTALLED_FACE, "puppet"), .log = log_queue_create()};
    if (!out->path || !out->log)
        return error_set(err, MRT_ERR_MEMORY, "no memory");
    mrt_result result = face_file_read(&out->face, out->path, NULL, FACE_FILE_USABLE, err);
    return result < 0 ? result : plugin_list_load(&out->plugins, err);
}

static void close_puppet(puppet *self)
{
    plugin_list_destroy(&self->plugins);
    log_queue_destroy(self->log);
    face_file_destroy(&self->face);
    free(self->path);
}

/* Those of the hand that performs it. */
static void list_channels(mrt_channel out[MRT_ANGLES])
{
    for (uint32_t i = 0; i < MRT_ANGLES; ++i)
        out[i] = (mrt_channel){.name = "angle",
                               .unit = "rad",
                               .semantic = MRT_CH_ANGLE + i,
                               .hand = MRT_RIGHT,
                               .min = -3.0f,
                               .max = 3.0f};
}

/* ---- from a sample to positions and normals in the file's order, step by step ---- */

enum { STEP_MAP, STEP_CONSTRAIN, STEP_DEFORM, STEP_PUBLISH, STEP_FRAME, STEP_ALL, STEPS };
static const char *const step_name[STEPS] = {
    "3-5 hands, mapping, guard", "6 constrain", "7 deform, normals", "8 publish", "3-7", "3-8"};

typedef struct frame_scene {
    bench *of;
    puppet puppet;
    instance mapping;
    performer *performer;
    channel_route route;
    live_board board;
    double *took_ms[STEPS];
    uint32_t frame;
    stamps_reader written, shaded;
    uint64_t written_count, shaded_count; /* blocks, since they were set to 0 */
} frame_scene;

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

static double lap_ms(int64_t *from_ns)
{
    int64_t now_ns = clock_now_ns();
    double took_ms = (double)(now_ns - *from_ns) * 1e-6;
    *from_ns = now_ns;
    return took_ms;
}

/* As a stage does, for a window that takes each face. */
static void publish(frame_scene *self)
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

static void count_blocks(frame_scene *self)
{
    composer *shown = performer_composer(self->performer);
    self->written_count += count_new(&self->written, face_written(composer_face(shown)));
    self->shaded_count += count_new(&self->shaded, shading_written(composer_shading(shown)));
}

static void run_frame(frame_scene *self, uint32_t round, bool is_cold)
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

static void tell_frame(frame_scene *self, const char *mapping, const char *caches, uint32_t count)
{
    for (int i = 0; i < STEPS; ++i) {
        char label[48], line[128];
        double p50 = percentile(self->took_ms[i], count, 0.5);
        double p99 = percentile(self->took_ms[i], count, 0.99);
        snprintf(label, sizeof label, "%s %s", mapping, caches);
        snprintf(line, sizeof line, "%-26s p50 %7.3f ms   p99 %7.3f ms", step_name[i], p50, p99);
        const facts_cell cells[] = {
            {"mapping", mapping, 0.0, 0},
            {"caches", caches, 0.0, 0},
            {"step", step_name[i], 0.0, 0},
            {"vertices", NULL, self->puppet.face.mesh.vertex_count, 0},
            {"p50_ms", NULL, p50, 4},
            {"p99_ms", NULL, p99, 4},
        };
        facts_row(self->of->told, "frame", label, line, cells, sizeof cells / sizeof cells[0]);
    }
}

/* What the frames of a mapping wrote. */
static void tell_blocks(frame_scene *self, const char *mapping, uint32_t count)
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

static void promise(const frame_scene *self, const char *mapping, uint32_t count)
{
    double p99_ms = percentile(self->took_ms[STEP_FRAME], count, 0.99);
    if (strcmp(mapping, "anchored") == 0)
        bench_at_most_ms(self->of, "whole frame, anchored, 99 %", p99_ms, 0.25);
    if (strcmp(mapping, "unanchored") == 0)
        bench_at_most_ms(self->of, "whole frame, unanchored, 99 %", p99_ms, 1.0);
}

typedef enum limit_state { LIMITED = 0, NOT_LIMITED } limit_state;

/* Performed until it is hot. */
static mrt_result begin_frames(frame_scene *self, const char *mapping, limit_state limit,
                               error *err)
{
    performer_settings settings = {.solver.radius = 0.0};
    const mrt_plugin_type *type = NULL;
    mrt_result result = plugin_list_find(&self->puppet.plugins, mapping, MRT_MAPPING, &type, err);
    if (result >= 0)
        result = instance_create(&self->mapping, type, CLOCK_VIRTUAL, self->puppet.log, err);
    if (limit == NOT_LIMITED) { /* of mappings that say nothing of it, and of those that do */
        settings.solver = self->puppet.face.rig->solver;
        settings.solver.stretch_most = -1.0;
    }
    if (result >= 0 && limit == NOT_LIMITED && strcmp(mapping, "one_hand") != 0)
        result = instance_set_text(&self->mapping, "stretch", "0", err);
    if (result >= 0)
        result =
            performer_create(&self->performer, &self->puppet.face, &self->mapping, &settings, err);
    if (result >= 0)
        result = live_board_create(&self->board, performer_composer(self->performer), err);
    self->frame = 0;
    for (uint32_t i = 0; i < 50 && result >= 0; ++i)
        run_frame(self, 0, false);
    self->written_count = self->shaded_count = 0;
    return result;
}

static void end_frames(frame_scene *self)
{
    live_board_destroy(&self->board);
    performer_destroy(self->performer);
    self->performer = NULL;
    instance_destroy(&self->mapping);
    self->mapping = (instance){0};
}

/* What the limit of folds and tears costs: the same frames once more without it. */
static mrt_result measure_limit(frame_scene *self, const char *mapping, uint32_t count,
                                double with_ms, double with_99_ms, error *err)
{
    char line[128];
    mrt_result result = begin_frames(self, mapping, NOT_LIMITED, err);
    for (uint32_t i = 0; i < count && result >= 0; ++i)
        run_frame(self, i, false);
    end_frames(self);
    if (result < 0)
        return result;
    double plain_ms = percentile(self->took_ms[STEP_FRAME], count, 0.5);
    double plain_99_ms = percentile(self->took_ms[STEP_FRAME], count, 0.99);
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

static mrt_result measure(frame_scene *self, const char *mapping, error *err)
{
    uint32_t hot = self->of->is_quick ? 300 : 2000, cold = self->of->is_quick ? 40 : 300;
    double p50_ms = 0.0, p99_ms = 0.0;
    mrt_result result = begin_frames(self, mapping, LIMITED, err);
    for (uint32_t i = 0; i < hot && result >= 0; ++i)
        run_frame(self, i, false);
    if (result >= 0) {
        tell_frame(self, mapping, "hot", hot);
        tell_blocks(self, mapping, hot);
        promise(self, mapping, hot);
        p50_ms = percentile(self->took_ms[STEP_FRAME], hot, 0.5);
        p99_ms = percentile(self->took_ms[STEP_FRAME], hot, 0.99);
    }
    for (uint32_t i = 0; i < cold && result >= 0; ++i)
        run_frame(self, i, true);
    if (result >= 0)
        tell_frame(self, mapping, "cold", cold);
    end_frames(self);
    return result < 0 ? result : measure_limit(self, mapping, hot, p50_ms, p99_ms, err);
}

static mrt_result prepare(frame_scene *self, error *err)
{
    mrt_channel channel[MRT_ANGLES];
    mrt_result result = open_puppet(&self->puppet, err);
    bool is_there = true;
    for (int i = 0; i < STEPS; ++i) {
        self->took_ms[i] = calloc(2000, sizeof(double));
        is_there = is_there && self->took_ms[i];
    }
    list_channels(channel);
    channel_route_init(&self->route, channel, MRT_ANGLES);
    if (result >= 0 && !is_there)
        result = error_set(err, MRT_ERR_MEMORY, "no memory for the bench's frame");
    return result;
}

mrt_result bench_frame(bench *self, error *err)
{
    static const char *const mappings[] = {"one_hand", "anchored", "unanchored"};
    frame_scene s = {.of = self};
    bench_title(self, "The whole frame on the puppet, one thread; cold: after other work");
    mrt_result result = prepare(&s, err);
    for (size_t i = 0; i < sizeof mappings / sizeof mappings[0] && result >= 0; ++i)
        result = measure(&s, mappings[i], err);
    for (int i = 0; i < STEPS; ++i)
        free(s.took_ms[i]);
    close_puppet(&s.puppet);
    return result;
}

/* ---- from a sample to the face published, through the threads of the stage, and to the graphics
 * card, where there is one: what a window adds to is when it draws ---- */

enum { SAMPLES_MAX = 1500 };
static const double rate_hz = 150.0;

typedef struct stage_scene {
    puppet puppet;
    feed *hand;
    live *live;
    draw_context *context; /* NULL: nothing can be drawn here */
    draw_face *drawn;
    double took_ms[SAMPLES_MAX], ready_ms[SAMPLES_MAX], sent_ms[SAMPLES_MAX];
    uint32_t count;
} stage_scene;

static mrt_result open_hand(stage_scene *self, error *err)
{
    mrt_channel channel[MRT_ANGLES];
    list_channels(channel);
    const feed_settings settings = {.id = "org.marotte.bench",
                                    .name = "A hand of the bench",
                                    .channels = channel,
                                    .channel_count = MRT_ANGLES,
                                    .rate_hz = 125.0};
    input *made = NULL;
    mrt_result result = feed_create(&self->hand, &settings, err);
    if (result >= 0)
        result =
            input_create(&made, feed_type(self->hand), "", "", CLOCK_REAL, self->puppet.log, err);
    if (result >= 0)
        result = live_add_input(self->live, made, "bench", err);
    return result;
}

/* What a window does with a new face before it draws. */
static void take_over(stage_scene *self, const live_view *view)
{
    int64_t at_ns = clock_now_ns();
    if (self->drawn)
        draw_face_follow(self->drawn, view->position, view->normal, view->changed);
    int64_t ready_ns = clock_now_ns();
    self->took_ms[self->count] = (double)(view->published_ns - view->sample_ns) * 1e-6;
    self->ready_ms[self->count] = (double)(ready_ns - view->sample_ns) * 1e-6;
    self->sent_ms[self->count] = (double)(ready_ns - at_ns) * 1e-6;
    self->count += 1;
}

/* Looks as often as a window could at most, and gives the hand a new pose at its rate. */
static void perform_samples(stage_scene *self, uint32_t samples)
{
    int64_t start_ns = clock_now_ns(), newest_ns = 0;
    for (uint32_t i = 0; i < samples; ++i) {
        float value[MRT_ANGLES];
        int64_t due_ns = start_ns + (int64_t)((double)(i + 1) * 1e9 / rate_hz);
        for (int k = 0; k < MRT_ANGLES; ++k)
            value[k] = (float)(0.3 + 0.25 * sin((double)i / rate_hz * (2.0 + 0.3 * k)));
        feed_give(self->hand, value, FEED_RESTS);
        for (int64_t at_ns = clock_now_ns(); at_ns < due_ns; at_ns = clock_now_ns()) {
            const live_view *view = NULL;
            bool is_new = live_look(self->live, &view) && view->sample_ns > newest_ns;
            if (is_new && self->count < SAMPLES_MAX) {
                newest_ns = view->sample_ns;
                take_over(self, view);
            }
            clock_sleep_until_ns(at_ns + NS_PER_MS / 4);
        }
        live_update(self->live);
    }
}

static void tell_stage(bench *self, stage_scene *s, const char *what, double *took_ms,
                       const char *note)
{
    char line[160];
    double p50 = percentile(took_ms, s->count, 0.5);
    double p99 = percentile(took_ms, s->count, 0.99);
    snprintf(line, sizeof line, "p50 %6.3f ms   p99 %6.3f ms%s", p50, p99, note);
    const facts_cell cells[] = {
        {"rate_hz", NULL, rate_hz, 1},
        {"faces", NULL, s->count, 0},
        {"p50_ms", NULL, p50, 4},
        {"p99_ms", NULL, p99, 4},
    };
    facts_row(self->told, "stage", what, line, cells, sizeof cells / sizeof cells[0]);
}

static void tell_all(bench *self, stage_scene *s, uint32_t samples)
{
    char note[96];
    live_status status;
    live_status_of(s->live, &status);
    snprintf(note, sizeof note, "   of %u samples given, %ju performed", samples,
             (uintmax_t)status.sample_count);
    tell_stage(self, s, "sample to face", s->took_ms, note);
    if (!s->drawn)
        return;
    tell_stage(self, s, "sent to graphics", s->sent_ms, "");
    tell_stage(self, s, "sample to draw", s->ready_ms, "   looked for each 0.25 ms");
}

/* Without a context there is nothing to say of drawing, and the rest is measured. */
static void open_drawing(stage_scene *self)
{
    error ignored = {""};
    self->context = draw_context_create(&ignored);
    if (self->context)
        self->drawn = draw_face_create(&self->puppet.face.mesh, &ignored);
}

static mrt_result start_stage(stage_scene *self, error *err)
{
    mrt_result result = open_puppet(&self->puppet, err);
    const live_settings settings = {.plugins = &self->puppet.plugins,
                                    .log = self->puppet.log,
                                    .face = &self->puppet.face,
                                    .face_path = self->puppet.path,
                                    .mapping = "one_hand",
                                    .fps = 60.0};
    if (result >= 0)
        result = live_start(&self->live, &settings, err);
    return result >= 0 ? open_hand(self, err) : result;
}

mrt_result bench_stage(bench *self, error *err)
{
    stage_scene *s = calloc(1, sizeof *s);
    error ignored = {""};
    uint32_t samples = self->is_quick ? 150 : 600;
    if (!s)
        return error_set(err, MRT_ERR_MEMORY, "no memory");
    bench_title(self,
                "The stage: from a sample at 150 Hz to the face published (puppet, one_hand)");
    mrt_result result = start_stage(s, err);
    if (result >= 0) {
        open_drawing(s);
        perform_samples(s, samples);
        tell_all(self, s, samples);
    }
    if (s->live && live_stop(s->live, &ignored) < 0 && result >= 0)
        result = error_set(err, MRT_ERR_IO, "%s", ignored.text);
    draw_face_destroy(s->drawn);
    draw_context_destroy(s->context);
    feed_destroy(s->hand);
    close_puppet(&s->puppet);
    free(s);
    return result;
}
