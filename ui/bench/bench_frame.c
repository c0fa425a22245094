/* The whole frame of a face, by phases, with and without each step around the engine. A recording
 * is performed several times. The shortest time of each frame counts, in processor time of the
 * thread: other programs can only make a frame slower. */
#include "base/percentile.h"
#include "bench/bench.h"
#include "face/bones.h"
#include "stage/input/input.h"
#include "stage/live/live_board.h"
#include "base/clock.h"
#include "stage/perform/frame.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* ---- the performed recording ---- */

enum { FRAMES_MAX = 2000, FRAMES_QUICK = 400, PASSES = 5, PASSES_QUICK = 3, TURN = 100 };

typedef struct frame_hand {
    mrt_sample sample[FRAMES_MAX];
    uint32_t count;
    int64_t length_ns; /* time after which it repeats */
    channel_route route;
    mrt_channel channel[MRT_MAX_CHANNELS];
} frame_hand;

typedef struct frame_part {
    const char *mapping, *recording;
} frame_part;
static const frame_part parts[] = {
    {"one_hand", "demo"},
    {"anchored", "demo_hand.csv"},
    {"unanchored", "demo_hand.csv"},
};

static mrt_result take_samples(frame_hand *out, input *from, const char *recording, error *err)
{
    uint32_t channels = 0;
    const mrt_channel *channel = input_channels(from, &channels);
    memcpy(out->channel, channel, channels * sizeof *channel);
    channel_route_init(&out->route, out->channel, channels);
    channel_route_call(&out->route, input_name(from));
    for (out->count = 0; out->count < FRAMES_MAX; ++out->count) {
        if (!input_peek(from, &out->sample[out->count]))
            break;
        input_pop(from);
    }
    if (out->count < 2)
        return error_set(err, MRT_ERR_FORMAT, "log:%s has no two samples", recording);
    const int64_t first_ns = out->sample[0].time_ns, last_ns = out->sample[out->count - 1].time_ns;
    out->length_ns = last_ns - first_ns + (last_ns - first_ns) / (out->count - 1);
    return MRT_OK;
}

static mrt_result read_hand(frame_hand *out, bench_face *on, const char *recording, error *err)
{
    const mrt_plugin_type *type = NULL;
    input *from = NULL;
    mrt_result result = plugin_list_find(&on->plugins, "log", MRT_INPUT, &type, err);
    if (result >= 0)
        result = input_create(&from, type, recording, "", CLOCK_VIRTUAL, on->log, err);
    if (result >= 0)
        result = take_samples(out, from, recording, err);
    input_destroy(from);
    return result;
}

/* Returns sample `frame` of the recording. Each pass plays the recording once more. */
static mrt_sample sample_of(const frame_hand *hand, uint32_t pass, uint32_t frame)
{
    mrt_sample out = hand->sample[frame];
    out.time_ns += pass * hand->length_ns;
    out.sequence = pass * hand->count + frame;
    return out;
}

/* ---- a face with all steps, and without one of them ---- */

typedef enum frame_kind { WHOLE, NO_LIMIT, NO_SEAL, NO_SKULL, NO_SHAPES, BARE, KINDS } frame_kind;
static const char *const kind_name[KINDS] = {
    "everything",
    "without the limit of folds",
    "without the seal of the lips",
    "without skull and teeth",
    "without the head's own shapes",
    "bones and pulls alone",
};

enum { STEP_MAP, STEP_CONSTRAIN, STEP_DEFORM, STEP_PUBLISH, STEP_FRAME, STEPS };

typedef struct frame_scene {
    rig rig;        /* copy of the face's rig without that step; shares its arrays */
    face_file file; /* likewise */
    instance mapping;
    performer *performer;
    live_board board;
    double *took_ms[STEPS]; /* times of each frame */
    uint32_t frames;
} frame_scene;

static bool leaves_out(frame_kind kind, frame_kind what)
{
    return kind == what || kind == BARE;
}

/* Returns whether the face has that step. */
static bool has_kind(const bench_face *on, frame_kind kind)
{
    const rig *r = on->file.rig;
    switch (kind) {
    case NO_SEAL:
        return r && r->mouth.upper;
    case NO_SKULL:
        return r && r->proxy_count > 0;
    case NO_SHAPES:
        return on->file.mesh.target_count > 0;
    default:
        return true;
    }
}

static mrt_result create_performer(frame_scene *out, bench_face *on, const char *mapping,
                                   frame_kind kind, error *err)
{
    performer_settings settings = {.solver.radius = 0.0};
    const mrt_plugin_type *type = NULL;
    out->file = on->file;
    if (on->file.rig) {
        out->rig = *on->file.rig;
        out->file.rig = &out->rig;
        out->rig.solver.stretch_most =
            leaves_out(kind, NO_LIMIT) ? -1.0 : out->rig.solver.stretch_most;
        settings.solver = out->rig.solver;
        if (leaves_out(kind, NO_SEAL))
            out->rig.mouth = (rig_mouth){0};
        if (leaves_out(kind, NO_SKULL))
            out->rig.proxy_count = 0;
    }
    mrt_result result = plugin_list_find(&on->plugins, mapping, MRT_MAPPING, &type, err);
    if (result >= 0)
        result = instance_create(&out->mapping, type, CLOCK_VIRTUAL, on->log, err);
    if (result >= 0 && leaves_out(kind, NO_LIMIT) && strcmp(mapping, "one_hand") != 0)
        result = instance_set_text(&out->mapping, "stretch", "0",
                                   err); /* these mappings set it in each pull */
    if (result >= 0)
        result = performer_create(&out->performer, &out->file, &out->mapping, &settings, err);
    if (result >= 0 && leaves_out(kind, NO_SHAPES))
        face_set_shapes(composer_face(out->performer->composer), 0.0);
    return result < 0 ? result : live_board_create(&out->board, out->performer->composer, err);
}

static mrt_result open_scene(frame_scene *out, bench_face *on, const char *mapping, frame_kind kind,
                             error *err)
{
    mrt_result result = create_performer(out, on, mapping, kind, err);
    for (int i = 0; i < STEPS && result >= 0; ++i) {
        out->took_ms[i] = calloc(FRAMES_MAX, sizeof(double));
        if (!out->took_ms[i])
            result = error_set(err, MRT_ERR_MEMORY, "no memory for the bench's frames");
    }
    return result;
}

static void close_scene(frame_scene *self)
{
    live_board_destroy(&self->board);
    performer_destroy(self->performer);
    instance_destroy(&self->mapping);
    for (int i = 0; i < STEPS; ++i)
        free(self->took_ms[i]);
    *self = (frame_scene){.frames = 0};
}

/* ---- frames ---- */

static int64_t processor_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (int64_t)now.tv_sec * NS_PER_S + now.tv_nsec;
}

static double took_ms(const stage_frame *f, frame_phase first, frame_phase last)
{
    int64_t took_ns = 0;
    for (int i = (int)first; i <= (int)last; ++i)
        took_ns += f->took_ns[i];
    return (double)took_ns * 1e-6;
}

/* Publishes as a stage does for a window that reads each face. */
static mrt_result publish(void *data, const stage_frame *f, error *err)
{
    (void)f, (void)err;
    frame_scene *self = data;
    const live_view *taken;
    (void)live_board_fill(&self->board, self->performer->composer, 0);
    live_board_publish(&self->board);
    (void)live_board_look(&self->board, &taken);
    return MRT_OK;
}

static void run_frame(frame_scene *self, const frame_hand *hand, uint32_t pass, uint32_t at)
{
    error ignored = {""};
    mrt_sample sample = sample_of(hand, pass, at);
    stage_frame f = {.performer = self->performer,
                     .step = sample_step_of(&hand->route, &sample),
                     .self = self,
                     .publish = publish,
                     .now_ns = processor_ns};
    if (frame_step(&f, &ignored) < 0 || frame_draw(&f, f.step.time_ns, &ignored) < 0)
        return; /* without a sink nothing fails */
    const double took[STEPS] = {[STEP_MAP] = took_ms(&f, FRAME_SCHEDULE, FRAME_GUARD),
                                [STEP_CONSTRAIN] = took_ms(&f, FRAME_COMPOSE, FRAME_SOLVE),
                                [STEP_DEFORM] = took_ms(&f, FRAME_DEFORM, FRAME_DEFORM),
                                [STEP_PUBLISH] = took_ms(&f, FRAME_PUBLISH, FRAME_PUBLISH),
                                [STEP_FRAME] = took_ms(&f, FRAME_SCHEDULE, FRAME_DEFORM)};
    for (int i = 0; i < STEPS; ++i)
        if (pass == 0 || took[i] < self->took_ms[i][at])
            self->took_ms[i][at] = took[i];
}

/* Runs all kinds in turns, so that a processor that slows down affects all of them. */
static void run_turns(frame_scene scene[KINDS], const frame_hand *hand, uint32_t passes,
                      uint32_t frames)
{
    for (uint32_t pass = 0; pass < passes; ++pass)
        for (uint32_t first = 0; first < frames; first += TURN)
            for (int kind = 0; kind < KINDS; ++kind)
                for (uint32_t i = first; i < first + TURN && i < frames; ++i)
                    if (scene[kind].performer)
                        run_frame(&scene[kind], hand, pass, i);
    for (int kind = 0; kind < KINDS; ++kind)
        scene[kind].frames = frames;
}

/* ---- results ---- */

typedef struct frame_times {
    double p50_ms, p99_ms, worst_ms;
} frame_times;

static frame_times times_of(const frame_scene *self, int step)
{
    double *ms = self->took_ms[step];
    return (frame_times){percentile(ms, self->frames, 0.5), percentile(ms, self->frames, 0.99),
                         percentile(ms, self->frames, 1.0)};
}

static void report_kind(bench *self, const frame_part *part, const frame_scene *scene, int kind,
                        const frame_times *whole)
{
    const frame_times frame = times_of(scene, STEP_FRAME);
    const double map = times_of(scene, STEP_MAP).p50_ms,
                 constrain = times_of(scene, STEP_CONSTRAIN).p50_ms,
                 deform = times_of(scene, STEP_DEFORM).p50_ms,
                 publishing = times_of(scene, STEP_PUBLISH).p50_ms;
    char line[192], label[48];
    int length =
        snprintf(line, sizeof line, "%6.3f %6.3f %6.3f %6.3f  %6.3f %6.3f %6.3f", map, constrain,
                 deform, publishing, frame.p50_ms, frame.p99_ms, frame.worst_ms);
    if (kind != WHOLE)
        snprintf(line + length, sizeof line - (size_t)length, "  %6.2f %6.2f",
                 whole->p50_ms / frame.p50_ms, whole->p99_ms / frame.p99_ms);
    const facts_cell cells[] = {
        {"mapping", part->mapping, 0.0, 0},
        {"recording", part->recording, 0.0, 0},
        {"what", kind_name[kind], 0.0, 0},
        {"frames", NULL, scene->frames, 0},
        {"map_ms", NULL, map, 4},
        {"constrain_ms", NULL, constrain, 4},
        {"deform_ms", NULL, deform, 4},
        {"publish_ms", NULL, publishing, 4},
        {"p50_ms", NULL, frame.p50_ms, 4},
        {"p99_ms", NULL, frame.p99_ms, 4},
        {"worst_ms", NULL, frame.worst_ms, 4},
        {"p50_over", NULL, whole->p50_ms / frame.p50_ms, 3},
        {"p99_over", NULL, whole->p99_ms / frame.p99_ms, 3},
    };
    snprintf(label, sizeof label, "%s", kind_name[kind]);
    facts_row(self->told, "frame", label, line, cells, sizeof cells / sizeof cells[0]);
}

static void promise(bench *self, const frame_part *part, const frame_times *whole,
                    const frame_times *free)
{
    const double p50 = whole->p50_ms / free->p50_ms, p99 = whole->p99_ms / free->p99_ms;
    if (strcmp(part->mapping, "one_hand") == 0) {
        bench_at_most(self, "frame with and without limit, one_hand", p50, 1.55);
        bench_at_most(self, "the same, 99 %", p99, 2.0);
        bench_at_most_ms(self, "worst frame, one_hand", whole->worst_ms, 2.0);
    } else if (strcmp(part->mapping, "unanchored") == 0) {
        bench_at_most(self, "frame with and without limit, unanchored", p50, 1.8);
        bench_at_most(self, "the same, 99 %", p99, 2.5);
    }
}

static void report_part(bench *self, bench_face *on, const frame_part *part, frame_scene *scene)
{
    char title[160];
    const frame_times whole = times_of(&scene[WHOLE], STEP_FRAME),
                      free = times_of(&scene[NO_LIMIT], STEP_FRAME);
    snprintf(title, sizeof title, "%s, log:%s, %u vertices, ms of processor time", part->mapping,
             part->recording, on->file.mesh.vertex_count);
    bench_title(self, title);
    if (!self->is_json)
        printf("%-30s %6s %6s %6s %6s  %20s  %13s\n", "", "hands", "limits", "shape", "publish",
               "frame: p50  p99  worst", "everything over it");
    for (int kind = 0; kind < KINDS; ++kind)
        if (scene[kind].performer)
            report_kind(self, part, &scene[kind], kind, &whole);
    promise(self, part, &whole, &free);
}

static mrt_result measure(bench *self, bench_face *on, const frame_part *part, frame_hand *hand,
                          error *err)
{
    frame_scene scene[KINDS] = {{.frames = 0}};
    mrt_result result = read_hand(hand, on, part->recording, err);
    for (int kind = 0; kind < KINDS && result >= 0; ++kind)
        if (has_kind(on, kind))
            result = open_scene(&scene[kind], on, part->mapping, kind, err);
    if (result >= 0) {
        const uint32_t most = self->is_quick ? FRAMES_QUICK : FRAMES_MAX;
        run_turns(scene, hand, self->is_quick ? PASSES_QUICK : PASSES,
                  hand->count < most ? hand->count : most);
        report_part(self, on, part, scene);
    }
    for (int kind = 0; kind < KINDS; ++kind)
        close_scene(&scene[kind]);
    return result;
}

mrt_result bench_frame(bench *self, error *err)
{
    bench_face on;
    frame_hand *hand = calloc(1, sizeof *hand);
    mrt_result result = bench_face_open(&on, self->face, err);
    if (result >= 0 && !hand)
        result = error_set(err, MRT_ERR_MEMORY, "no memory for a recording");
    bench_title(self, "The whole frame, one thread, warm caches");
    for (size_t i = 0; i < sizeof parts / sizeof parts[0] && result >= 0; ++i)
        result = measure(self, &on, &parts[i], hand, err);
    bench_face_close(&on);
    free(hand);
    return result;
}
