/* The stage with its threads: from a sample to the published and drawn face. */
#include "base/clock.h"
#include "base/installed.h"
#include "base/percentile.h"
#include "bench/bench.h"
#include "draw/draw.h"
#include "stage/input/feed.h"
#include "stage/live/live.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

mrt_result bench_face_open(bench_face *out, const char *path, error *err)
{
    *out = (bench_face){.path = path ? strdup(path) : installed_path(INSTALLED_FACE, "puppet"),
                        .log = log_queue_create()};
    if (!out->path || !out->log)
        return error_set(err, MRT_ERR_MEMORY, "no memory");
    mrt_result result = face_file_read(&out->file, out->path, NULL, FACE_FILE_USABLE, err);
    return result < 0 ? result : plugin_list_load(&out->plugins, err);
}

void bench_face_close(bench_face *self)
{
    plugin_list_destroy(&self->plugins);
    log_queue_destroy(self->log);
    face_file_destroy(&self->file);
    free(self->path);
}

/* Lists the channels of the hand. */
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

/* With a graphics card the upload is timed too. The time until the window draws is not included. */

enum { SAMPLES_MAX = 1500 };
static const double rate_hz = 150.0;

typedef struct stage_scene {
    bench_face puppet;
    feed *hand;
    live *live;
    draw_context *context; /* NULL: drawing is not possible */
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

/* Reads a new face as a window does before it draws. */
static void receive_face(stage_scene *self, const live_view *view)
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

/* Polls at the highest rate of a window, and moves the hand at the rate of its samples. */
static void perform_samples(stage_scene *self, uint32_t samples)
{
    int64_t start_ns = clock_now_ns(), newest_ns = 0;
    for (uint32_t i = 0; i < samples; ++i) {
        float value[MRT_ANGLES];
        int64_t due_ns = start_ns + (int64_t)((double)(i + 1) * 1e9 / rate_hz);
        for (int k = 0; k < MRT_ANGLES; ++k)
            value[k] = (float)(0.3 + 0.25 * sin((double)i / rate_hz * (2.0 + 0.3 * k)));
        feed_push(self->hand, value, FEED_RESTS);
        for (int64_t at_ns = clock_now_ns(); at_ns < due_ns; at_ns = clock_now_ns()) {
            const live_view *view = NULL;
            bool is_new = live_read_view(self->live, &view) && view->sample_ns > newest_ns;
            if (is_new && self->count < SAMPLES_MAX) {
                newest_ns = view->sample_ns;
                receive_face(self, view);
            }
            clock_sleep_until_ns(at_ns + NS_PER_MS / 4);
        }
        live_update(self->live);
    }
}

static void report_stage(bench *self, stage_scene *s, const char *what, double *took_ms,
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

static void report_all(bench *self, stage_scene *s, uint32_t samples)
{
    char note[96];
    live_status status;
    live_status_of(s->live, &status);
    snprintf(note, sizeof note, "   of %u samples given, %ju performed", samples,
             (uintmax_t)status.sample_count);
    report_stage(self, s, "sample to face", s->took_ms, note);
    if (!s->drawn)
        return;
    report_stage(self, s, "sent to graphics", s->sent_ms, "");
    report_stage(self, s, "sample to draw", s->ready_ms, "   looked for each 0.25 ms");
}

/* Opens a context for drawing. If there is none, only the rest is measured. */
static void open_drawing(stage_scene *self)
{
    error ignored = {""};
    self->context = draw_context_create(&ignored);
    if (self->context)
        self->drawn = draw_face_create(&self->puppet.file.mesh, &ignored);
}

static mrt_result start_stage(stage_scene *self, error *err)
{
    mrt_result result = bench_face_open(&self->puppet, NULL, err);
    const live_settings settings = {.plugins = &self->puppet.plugins,
                                    .log = self->puppet.log,
                                    .face = &self->puppet.file,
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
        report_all(self, s, samples);
    }
    if (s->live && live_stop(s->live, &ignored) < 0 && result >= 0)
        result = error_set(err, MRT_ERR_IO, "%s", ignored.text);
    draw_face_destroy(s->drawn);
    draw_context_destroy(s->context);
    feed_destroy(s->hand);
    bench_face_close(&s->puppet);
    free(s);
    return result;
}
