#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "rig_stand.h"

#include "base/clock.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

static rig_stand *here;
static app *const a_studio = (app *)(void *)&here;

/* ---- the application, beside what the viewport's stand has ---- */

const char *app_face_path(const app *self)
{
    (void)self;
    return here->face_path;
}

viewport *app_viewport(app *self)
{
    (void)self;
    return here->of.viewport;
}

void app_add_change(app *self, const undo_change *step)
{
    (void)self;
    assert_true(here->step_count < RIG_STAND_STEPS);
    here->step[here->step_count++] = *step;
}

void app_forget_changes(app *self, const void *owner)
{
    (void)self;
    (void)owner;
    for (uint32_t i = 0; i < here->step_count; ++i) {
        free(here->step[i].before);
        free(here->step[i].after);
    }
    here->step_count = 0;
}

void app_clear_pulls(app *self)
{
    (void)self;
}

bool app_take_call(app *self, app_call of)
{
    (void)self, (void)of;
    return false;
}

void app_set_rig_saver(app *self, const app_rig_saver *saver)
{
    (void)self;
    (void)saver;
}

void app_set_unsaved(app *self, const app_unsaved *unsaved)
{
    (void)self;
    here->has_unsaved = unsaved != NULL;
    if (unsaved)
        here->unsaved = *unsaved;
}

static void make_stage(viewport_stand *s)
{
    error err = {{0}};
    const csrbf_settings solver = {.kernel = CSRBF_WENDLAND_C2};
    if (composer_create(&s->composer, &s->file, &solver, &err) < 0)
        fail_msg("%s", err.text);
    s->view.about = composer_about(s->composer);
    s->view.contact_count = s->view.about->contact_count;
    stand_perform(s);
}

mrt_result app_change_face(app *self, face_file *file)
{
    (void)self;
    composer_destroy(here->of.composer);
    face_file_destroy(&here->of.file);
    here->of.file = *file;
    *file = (face_file){0};
    make_stage(&here->of);
    here->change_count += 1;
    return MRT_OK;
}

mrt_result app_open_face(app *self, const char *path)
{
    (void)self;
    (void)snprintf(here->opened, sizeof here->opened, "%s", path);
    return MRT_OK;
}

/* ---- opened and closed ---- */

static const char *below_source(const char *path)
{
    size_t length = strlen(SOURCE_DIR);
    assert_true(strncmp(path, SOURCE_DIR "/", length + 1) == 0);
    return path + length + 1;
}

void rig_stand_open(rig_stand *s, const char *face_path, const char *settings_path, uint32_t width,
                    uint32_t height, float scale)
{
    error err = {{0}};
    char note[256];
    memset(s, 0, sizeof *s);
    here = s;
    stand_open(&s->of, below_source(face_path), width, height, scale);
    settings_close(s->of.settings);
    assert_int_equal(settings_open(&s->of.settings, settings_path, note, sizeof note, &err),
                     MRT_OK);
    (void)snprintf(s->face_path, sizeof s->face_path, "%s", face_path);
    float wide = (float)width / scale, high = (float)height / scale;
    s->of.where = (ui_rectangle){0, 52, wide - 330, high - 52};
    s->dock = (ui_rectangle){wide - 330, 52, 330, high - 52};
    s->is_panel_seen = true;
    ui_note_words(s->of.ui, true);
    s->panel = panel_rig.create(a_studio);
    assert_non_null(s->panel);
    rig_stand_frames(s, 3);
}

void rig_stand_close(rig_stand *s)
{
    panel_rig.destroy(s->panel);
    stand_close(&s->of);
}

/* ---- frames and events ---- */

/* Of this thread alone: the machine may be busy. */
static double cpu_ms(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec * 1e3 + (double)now.tv_nsec * 1e-6;
}

static void frame(rig_stand *s)
{
    ui_screen screen;
    assert_true(window_begin(s->of.window, s->of.ui, &screen));
    ui_begin(s->of.ui, &screen);
    double start_ms = cpu_ms();
    panel_rig.update(s->panel, screen.dt_s);
    s->update_ms = fmax(s->update_ms, cpu_ms() - start_ms);
    viewport_update(s->of.viewport, s->of.ui, NULL, screen.dt_s);
    viewport_draw(s->of.viewport, s->of.ui, s->of.where, screen.scale);
    start_ms = cpu_ms();
    if (s->is_panel_seen)
        panel_rig.draw(s->panel, s->of.ui, s->dock);
    s->draw_ms = fmax(s->draw_ms, cpu_ms() - start_ms);
    ui_end(s->of.ui);
    window_end(s->of.window, s->of.ui);
}

void rig_stand_frames(rig_stand *s, uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i)
        frame(s);
}

void rig_stand_wait_for_change(rig_stand *s, uint32_t change_count)
{
    int64_t end_ns = clock_now_ns() + 600 * NS_PER_S;
    while (s->change_count < change_count && clock_now_ns() < end_ns) {
        frame(s);
        clock_sleep_until_ns(clock_now_ns() + 4 * NS_PER_MS); /* the worker has the processor */
    }
    assert_int_equal(s->change_count, change_count);
}

static void push(rig_stand *s, ui_event event)
{
    ui_push(s->of.ui, &event);
    for (int i = 0; i < 8 && (i == 0 || !ui_is_idle(s->of.ui)); ++i)
        frame(s);
}

void rig_stand_move(rig_stand *s, float x, float y)
{
    push(s, (ui_event){.kind = UI_EVENT_MOVE, .x = x, .y = y});
}

void rig_stand_button(rig_stand *s, bool is_down)
{
    push(s, (ui_event){.kind = UI_EVENT_BUTTON, .code = 0, .is_down = is_down});
}

void rig_stand_click(rig_stand *s, float x, float y)
{
    rig_stand_move(s, x, y);
    rig_stand_button(s, true);
    rig_stand_button(s, false);
    rig_stand_frames(s, 2);
}

void rig_stand_key(rig_stand *s, uint32_t key, bool is_down)
{
    push(s, (ui_event){.kind = UI_EVENT_KEY, .code = key, .is_down = is_down});
}

static bool is_in_dock(const rig_stand *s, const ui_word *word)
{
    return word->where.x >= s->dock.x && word->where.y >= s->dock.y;
}

static const ui_word *find_word(const rig_stand *s, const char *text)
{
    const ui_word *words;
    uint32_t count = ui_words(s->of.ui, &words);
    for (uint32_t i = 0; i < count; ++i)
        if (is_in_dock(s, &words[i]) && strncmp(words[i].text, text, strlen(text)) == 0)
            return &words[i];
    return NULL;
}

bool rig_stand_says(rig_stand *s, const char *text)
{
    frame(s);
    return find_word(s, text) != NULL;
}

void rig_stand_click_on(rig_stand *s, const char *text)
{
    frame(s);
    const ui_word *word = find_word(s, text);
    if (!word)
        fail_msg("\"%s\" is not to be seen", text);
    rig_stand_click(s, word->where.x + 0.5f * word->where.width,
                    word->where.y + 0.5f * word->where.height);
}

void rig_stand_place_at(const rig_stand *s, vec3 at, float *out_x, float *out_y)
{
    const float place[3] = {(float)at.x, (float)at.y, (float)at.z};
    stand_place(&s->of, place, out_x, out_y);
}

void rig_stand_place(const rig_stand *s, uint32_t vertex, float *out_x, float *out_y)
{
    stand_place(&s->of, s->of.file.mesh.position + (size_t)vertex * 3, out_x, out_y);
}

/* ---- looked at ---- */

void rig_stand_picture(rig_stand *s, const char *name)
{
    error err = {{0}};
    char path[1024];
    rig_stand_frames(s, 1);
    if (!getenv("MAROTTE_PICTURES"))
        return;
    window_hidden_put_away(s->of.window, false);
    rig_stand_frames(s, 1);
    window_hidden_put_away(s->of.window, true);
    (void)snprintf(path, sizeof path, "%s/out", BUILD_DIR);
    (void)mkdir(path, 0777);
    (void)snprintf(path, sizeof path, "%s/out/%s.png", BUILD_DIR, name);
    if (window_picture(s->of.window, path, &err) < 0)
        fail_msg("%s", err.text);
}

static bool overlap(const ui_rectangle *a, const ui_rectangle *b)
{
    return a->x + 1.0f < b->x + b->width && b->x + 1.0f < a->x + a->width &&
           a->y + 1.0f < b->y + b->height && b->y + 1.0f < a->y + a->height;
}

static bool is_seen(const ui_word *word)
{
    return word->where.y + word->where.height > word->clip.y &&
           word->where.y < word->clip.y + word->clip.height;
}

void rig_stand_check_words(rig_stand *s)
{
    const ui_word *words;
    frame(s);
    uint32_t count = ui_words(s->of.ui, &words);
    for (uint32_t i = 0; i < count; ++i) {
        if (!is_in_dock(s, &words[i]) || !is_seen(&words[i]))
            continue;
        if (words[i].is_cut)
            fail_msg("\"%s\" is cut", words[i].text);
        if (words[i].where.x + words[i].where.width > s->dock.x + s->dock.width)
            fail_msg("\"%s\" leaves the panel", words[i].text);
        for (uint32_t k = 0; k < i; ++k)
            if (is_in_dock(s, &words[k]) && is_seen(&words[k]) &&
                overlap(&words[i].where, &words[k].where))
                fail_msg("\"%s\" lies over \"%s\"", words[i].text, words[k].text);
    }
}
