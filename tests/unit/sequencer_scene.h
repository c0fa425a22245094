/* What the tests of played takes share: shows recorded as `marotte perform --record` does, with the
 * face of every sample remembered, takes of them, and edits as short JSON. */
#ifndef MAROTTE_TESTS_SEQUENCER_SCENE_H
#define MAROTTE_TESTS_SEQUENCER_SCENE_H
/* first: its names are types elsewhere */
#include "take/edit_help.h"

#include "stage/perform/player.h"
#include "stage/record/recorder.h"
#include "stage/playback/sequencer.h"
#include "unit/resume_scene.h"

#include <unistd.h>

enum { FILM_SAMPLES = 4096, FILM_PATH = 256 };

typedef struct film { /* a recorded performance */
    char folder[FILM_PATH / 2], path[FILM_PATH], left[FILM_PATH];
    plugin_list plugins;
    log_queue *log;
    face_file file;
    show *show;
    int64_t take_id, performance;
    const scene_play *play;
    performer *performer; /* while it is recorded */
    recorder *recorder;
    uint32_t count; /* of steps */
    uint32_t sample_count;
    uint64_t solves;             /* of the engine */
    int64_t at_ns[FILM_SAMPLES]; /* from the first step on */
    uint64_t hash[FILM_SAMPLES]; /* of the face after it */
    rezero_counts rezeros;
} film;

/* ---- recorded ---- */

/* The left hand and its pedals, for `seconds`. */
static inline void film_write_left(const film *f, double rate_hz, double first_s, double seconds)
{
    static const char *const sensors[] = {"thumb.roll", "thumb.mpj", "index.mpj",
                                          "middle.mpj", "ring.mpj",  "little.mpj"};
    static const uint32_t index[] = {0, 1, 4, 7, 11, 15};
    FILE *out = fopen(f->left, "w");
    assert_non_null(out);
    fprintf(out, "time_s");
    for (int i = 0; i < 6; ++i)
        fprintf(out, ",left.%s", sensors[i]);
    fprintf(out, ",pedal.1,pedal.2,pedal.3\nunit,rad,rad,rad,rad,rad,rad,1,1,1\n");
    for (uint32_t n = 0; (double)n / rate_hz < seconds; ++n) {
        fprintf(out, "%.6f", first_s + (double)n / rate_hz);
        for (int i = 0; i < 6; ++i)
            fprintf(out, ",%.5f", (double)scene_angle(n, index[i], 3.0f));
        for (uint32_t i = 0; i < 3; ++i)
            fprintf(out, ",%d", n / 20 % 5 == i);
        fprintf(out, "\n");
    }
    assert_int_equal(fclose(out), 0);
}

static inline mrt_result film_no_frame(void *data, uint32_t index, double time_s, int64_t work_ns,
                                       error *err)
{
    (void)data, (void)index, (void)time_s, (void)work_ns, (void)err;
    return MRT_OK;
}

static inline mrt_result film_record(void *data, stage_frame *at, error *err)
{
    (void)err;
    film *f = data;
    uint32_t rezeroed = scene_act_on(f->performer, f->play, f->count);
    for (uint32_t side = 0; side < 2; ++side)
        if (rezeroed & (1u << side))
            recorder_rezero(f->recorder, side);
    recorder_step(f->recorder, &at->step);
    return MRT_OK;
}

static inline void film_performed(void *data, const stage_frame *at)
{
    film *f = data;
    const sample_step *s = &at->step;
    recorder_performed(f->recorder, s);
    assert_true(f->count < FILM_SAMPLES);
    composer_draw(f->performer->composer);
    f->at_ns[f->count] = s->time_ns;
    f->hash[f->count] = scene_hash(composer_face(f->performer->composer));
    f->count += 1;
    f->sample_count += s->count;
}

/* Inputs of what is recorded: the demo hand (100 Hz); a left hand of 37 Hz beside it; one of 100
 * Hz, 3 ms later. */
typedef enum film_inputs { FILM_DEMO = 0, FILM_BOTH, FILM_PAIR } film_inputs;

static inline void film_perform(film *f, film_inputs which, const char *span, double seconds)
{
    char demo[FILM_PATH], text[2][FILM_PATH * 2];
    const char *texts[2] = {text[0], text[1]};
    error err = {""};
    input *inputs[2] = {NULL, NULL};
    instance mapping;
    const mrt_plugin_type *type;
    uint32_t count = which == FILM_DEMO ? 1 : 2;
    const mrt_plugin_type *log;
    scene_must(plugin_list_find(&f->plugins, "log", MRT_INPUT, &log, &err), &err);
    scene_must(plugin_list_find(&f->plugins, f->play->mapping, MRT_MAPPING, &type, &err), &err);
    snprintf(demo, sizeof demo, "%s/plugins/log/demo_hand.csv", SOURCE_DIR);
    film_write_left(f, which == FILM_PAIR ? 100.0 : 37.0, which == FILM_PAIR ? 0.003 : 0.0,
                    seconds);
    for (uint32_t i = 0; i < count; ++i) {
        const char *address = i == 0 ? demo : f->left;
        snprintf(text[i], sizeof text[i], "log:%s", address);
        scene_must(
            input_create(&inputs[i], log, address, i == 0 ? span : "", CLOCK_VIRTUAL, f->log, &err),
            &err);
    }
    scene_must(instance_create(&mapping, type, CLOCK_VIRTUAL, f->log, &err), &err);
    scene_must(instance_set_list(&mapping, f->play->params, &err), &err);
    performer_settings settings = {.rezero_pedal = f->play->rezero_pedal};
    scene_must(performer_create(&f->performer, &f->file, &mapping, &settings, &err), &err);
    char face_path[FILM_PATH * 2];
    snprintf(face_path, sizeof face_path, "%s/rigs/moai/moai.glb", SOURCE_DIR); /* for its hash */
    recorder_settings recording = {.show = f->show,
                                   .plugins = &f->plugins,
                                   .log = f->log,
                                   .clock = CLOCK_VIRTUAL,
                                   .inputs = inputs,
                                   .input_text = texts,
                                   .input_count = count,
                                   .layer = f->performer->voice[0].layer,
                                   .performer = f->performer,
                                   .face_path = face_path,
                                   .face = &f->file,
                                   .rezero_pedal = f->play->rezero_pedal};
    if (f->file.rig)
        snprintf(face_path, sizeof face_path, "%s/rigs/%s/%s.rig.json", SOURCE_DIR, f->play->face,
                 f->play->face);
    scene_must(recorder_start(&f->recorder, &recording, &err), &err);
    const writer_slate slate = {.scene = "1", .shot = "a"};
    recorder_take_next(f->recorder, &slate, 0);
    player_settings playing = {.fps = 1.0, .clock = CLOCK_VIRTUAL};
    player_events events = {.frame = film_no_frame, .data = f};
    stage_frame with = {
        .performer = f->performer, .self = f, .record = film_record, .performed = film_performed};
    player_report report;
    scene_must(player_run_stage(&with, inputs, count, &playing, &events, &report, &err), &err);
    scene_must(recorder_take_end(f->recorder, &err), &err);
    f->take_id = recorder_take(f->recorder);
    f->rezeros = *hands_rezeros(f->performer->voice[0].layer->hands);
    assert_string_equal(recorder_problem(f->recorder), "");
    assert_int_equal(f->performer->counts->bad_pulls, 0);
    scene_must(recorder_stop(f->recorder, &err), &err);
    f->solves = f->performer->counts->solves;
    performer_destroy(f->performer);
    f->performer = NULL;
    f->recorder = NULL;
    instance_destroy(&mapping);
    for (uint32_t i = 0; i < count; ++i)
        input_destroy(inputs[i]);
}

static inline void film_take(const film *f, take *out)
{
    error err = {""};
    scene_must(show_take_base(f->show, f->take_id, out, &err), &err);
}

/* `span`: of the demo hand, "start=3,end=9"; seconds: of the left one. */
static inline film *film_shoot(const scene_play *play, film_inputs which, const char *span,
                               double seconds)
{
    const char *temporary = getenv("TMPDIR");
    error err = {""};
    film *f = calloc(1, sizeof *f);
    assert_non_null(f);
    f->play = play;
    f->log = log_queue_create();
    snprintf(f->folder, sizeof f->folder, "%s/marotte_film_XXXXXX", temporary ? temporary : "/tmp");
    assert_non_null(mkdtemp(f->folder));
    snprintf(f->path, sizeof f->path, "%s/film.marotte", f->folder);
    snprintf(f->left, sizeof f->left, "%s/left.csv", f->folder);
    static const char *const libraries[] = {"log", "anchored", "unanchored", "one_hand"};
    for (int i = 0; i < 4; ++i) {
        char path[1024];
        snprintf(path, sizeof path, "%s/plugins/%s.so", BUILD_DIR, libraries[i]);
        scene_must(plugin_list_add(&f->plugins, path, &err), &err);
    }
    scene_face(&f->file, play->face);
    scene_must(show_create(&f->show, f->path, &err), &err);
    film_perform(f, which, span, seconds);
    assert_true(f->count > 100);
    for (uint32_t i = f->count; i-- > 0;)
        f->at_ns[i] -= f->at_ns[0];
    take t = {0};
    film_take(f, &t);
    assert_int_equal(t.layer_count, 1);
    assert_int_equal(t.layer[0].clip_count, 1);
    assert_int_equal(t.duration_ns, f->at_ns[f->count - 1] + 1);
    f->performance = t.layer[0].clip[0].performance;
    take_finish(&t);
    return f;
}

static inline void film_burn(film *f)
{
    char command[FILM_PATH];
    show_close(f->show);
    plugin_list_destroy(&f->plugins);
    log_queue_destroy(f->log);
    face_file_destroy(&f->file);
    snprintf(command, sizeof command, "rm -rf '%s'", f->folder);
    assert_int_equal(system(command), 0);
    free(f);
}

/* The last sample at or before an instant of the timeline. */
static inline uint32_t film_sample_at(const film *f, int64_t at_ns)
{
    uint32_t n = 0;
    while (n + 1 < f->count && f->at_ns[n + 1] <= at_ns)
        n += 1;
    return n;
}

/* ---- played ---- */

static inline sequencer *film_project(film *f, const take *t, size_t checkpoint_bytes)
{
    error err = {""};
    sequencer *out;
    sequencer_settings settings = {.show = f->show,
                                   .plugins = &f->plugins,
                                   .log = f->log,
                                   .face = &f->file,
                                   .checkpoint_bytes = checkpoint_bytes};
    scene_must(sequencer_create(&out, &settings, t, &err), &err);
    return out;
}

static inline uint64_t film_face_of(sequencer *s)
{
    composer_draw(sequencer_performer(s)->composer);
    return scene_hash(composer_face(sequencer_performer(s)->composer));
}

static inline uint64_t film_seek(sequencer *s, int64_t at_ns)
{
    error err = {""};
    scene_must(sequencer_seek(s, at_ns, &err), &err);
    assert_int_equal(sequencer_now_ns(s), at_ns);
    return film_face_of(s);
}

static inline uint64_t film_play_to(sequencer *s, int64_t at_ns)
{
    error err = {""};
    scene_must(sequencer_play_to(s, at_ns, &err), &err);
    return film_face_of(s);
}

#endif
