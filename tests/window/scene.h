/* scene.h - the whole window in a test, with no display: a fresh show in a folder of its own, the
 * puppet (or another face), no settings, no inputs but those that are asked for; frames, events,
 * words and pictures. Include after cmocka.h; link marotte_window and depend on the plugins:
 *
 *     static void space_plays_the_take(void **state)
 *     {
 *         scene s;
 *         (void)state;
 *         scene_open(&s, 1280, 720, 1.0f);    skips the test where nothing can be drawn
 *         scene_key(&s, 'R', 0);              keys, clicks, drags: whole, frames included
 *         scene_click_word(&s, "Mapping");
 *         assert_true(scene_until(&s, is_recording, NULL)); a condition of yours; bounded
 *         scene_check_words(&s);              none overlaps, is cut, is hard to read
 *         scene_look(&s, "playing");          draws a frame; with MAROTTE_PICTURES set it is kept:
 *                                             BUILD_DIR/out/playing.png
 *         scene_close(&s);
 *     }
 *
 *     marotte_test(NAME USES marotte_window)
 *     add_dependencies(test_window_NAME plugin_log plugin_one_hand plugin_anchored)
 *
 * s.app, s.workspace, s.ui and s.window are there for the rest. Units are points. */
#ifndef TESTS_WINDOW_SCENE_H
#define TESTS_WINDOW_SCENE_H
#include "base/clock.h"
#include "window/workspace.h"
#include "window/gui/window.h"
#include "window/app/app.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { SCENE_PATIENCE_S = 600, SCENE_LET_CUT = 8 };

typedef struct scene {
    char folder[64], show[96];
    window *window;
    app *app;
    workspace *workspace;
    ui *ui;
    float width, height; /* points */
    bool is_over;        /* the workspace wants to be closed */
    bool is_drawn;       /* each frame is drawn, not only those of pictures */
    const char *let_cut[SCENE_LET_CUT];
} scene;

typedef struct scene_options {
    uint32_t width_px, height_px;
    float scale;
    const char *face;    /* NULL: the puppet; "moai", or a path */
    const char *mapping; /* NULL: one_hand; "": as last time */
    const char *const *inputs;
    uint32_t input_count;
    const char *settings_path; /* NULL: none */
    const char *show_path;     /* NULL: a new one in the folder */
    bool lives;                /* the face lives in a new show; false: it keeps still */
    bool is_drawn;             /* each frame, not only those of pictures */
    bool has_bus;              /* the session bus that the test says is used */
    bool waits;                /* frames come when they are due, as in a real window */
} scene_options;

/* ---- life ---- */

static inline void scene_face_path(char out[512], const char *name)
{
    if (strchr(name, '/'))
        (void)snprintf(out, 512, "%s", name);
    else
        (void)snprintf(out, 512, "%s/rigs/%s/%s.rig.json", SOURCE_DIR, name, name);
}

static inline void scene_frame(scene *s)
{
    if (!workspace_frame(s->workspace))
        s->is_over = true;
}

/* Many of them are to take a while, in which the stage's threads go on: undrawn frames are quick.
 */
static inline void scene_frames(scene *s, uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i) {
        scene_frame(s);
        if (count >= 20)
            clock_sleep_until_ns(clock_now_ns() + 4 * NS_PER_MS);
    }
}

/* Until all events have been handed over, and what they opened has its size. */
static inline void scene_settle(scene *s)
{
    for (uint32_t i = 0; i < 1000 && !ui_is_idle(s->ui); ++i)
        scene_frame(s);
    scene_frames(s, 3);
}

typedef bool scene_condition(scene *s, void *data);
/* Draws until the condition holds; false: it did not within SCENE_PATIENCE_S. */
static inline bool scene_until(scene *s, scene_condition *holds, void *data)
{
    const int64_t end_ns = clock_now_ns() + SCENE_PATIENCE_S * NS_PER_S;
    do {
        const int64_t began_ns = clock_now_ns();
        scene_frame(s);
        if (holds(s, data))
            return true;
        clock_sleep_until_ns(began_ns + NS_PER_S / 60); /* what is waited for has the processor */
    } while (clock_now_ns() < end_ns);
    return false;
}

typedef struct scene_stillness { /* zeroed; data of scene_is_still */
    uint64_t number;             /* of the face that is shown */
    uint32_t frames;             /* that it has been for */
} scene_stillness;

/* For a second: what springs back has come to rest. */
static inline bool scene_is_still(scene *s, void *data)
{
    scene_stillness *now = data;
    const uint64_t number = app_view(s->app)->number;
    now->frames = number == now->number ? now->frames + 1 : 0;
    now->number = number;
    return now->frames > 60;
}

static inline bool scene_has_face(scene *s, void *data)
{
    (void)data;
    return app_view(s->app)->number > 0;
}

/* The program ends; the window and what is in the folder stay. */
static inline void scene_end(scene *s)
{
    workspace_destroy(s->workspace);
    app_destroy(s->app);
    s->workspace = NULL;
    s->app = NULL;
}

static inline void scene_close(scene *s)
{
    char command[96];
    scene_end(s);
    window_close(s->window);
    (void)snprintf(command, sizeof command, "rm -rf %s", s->folder);
    if (system(command) != 0)
        print_message("%s stays\n", s->folder);
}

/* The program begins, after it has ended if it runs: what is in the folder is what it finds. */
static inline void scene_open_again(scene *s, const scene_options *options)
{
    static const char *const none[] = {NULL};
    char path[512];
    error err = {0};
    scene_end(s);
    scene_face_path(path, options->face ? options->face : "puppet");
    const app_options with = {
        .show_path = options->show_path ? options->show_path : s->show,
        .face_path = path,
        .mapping = !options->mapping     ? "one_hand"
                   : options->mapping[0] ? options->mapping
                                         : NULL,
        .inputs = options->inputs ? options->inputs : none,
        .input_count = options->input_count,
        .settings_path = options->settings_path ? options->settings_path : "",
        .lives = options->lives,
        .changed = window_signal(s->window),
    };
    if (app_create(&s->app, &with, &err) < 0)
        fail_msg("%s", err.text);
    if (workspace_create(&s->workspace, s->app, s->window, &err) < 0)
        fail_msg("%s", err.text);
    s->ui = workspace_ui(s->workspace);
    s->is_over = false;
    ui_note_words(s->ui, true);
    window_hidden_put_away(s->window, !s->is_drawn);
    if (!scene_until(s, scene_has_face, NULL))
        fail_msg("no face was drawn within %d s", SCENE_PATIENCE_S);
    scene_frames(s, 3);
}

/* A window and a folder with nothing in it; scene_open_again goes on. */
static inline void scene_prepare(scene *s, const scene_options *options)
{
    error err = {0};
    *s = (scene){.is_drawn = options->is_drawn,
                 .width = (float)options->width_px / options->scale,
                 .height = (float)options->height_px / options->scale};
    (void)unsetenv("MAROTTE_PLUGIN_PATH"); /* they lie beside the test, as beside the program */
    (void)snprintf(s->folder, sizeof s->folder, "/tmp/marotte_scene_XXXXXX");
    if (window_open_hidden(&s->window, options->width_px, options->height_px, options->scale,
                           options->waits ? 0.0 : 1.0 / 60.0, &err) < 0) {
        print_message("SKIPPED: %s\n", err.text);
        skip();
    }
    assert_non_null(mkdtemp(s->folder));
    (void)setenv("XDG_DATA_HOME", s->folder, 1); /* of whoever runs the test nothing is used */
    if (!options->has_bus)
        (void)setenv("DBUS_SESSION_BUS_ADDRESS", "unix:path=/nonexistent", 1);
    (void)snprintf(s->show, sizeof s->show, "%s/night.marotte", s->folder);
}

static inline void scene_open_with(scene *s, const scene_options *options)
{
    scene_prepare(s, options);
    scene_open_again(s, options);
}

static inline void scene_open(scene *s, uint32_t width_px, uint32_t height_px, float scale)
{
    const scene_options options = {.width_px = width_px, .height_px = height_px, .scale = scale};
    scene_open_with(s, &options);
}

/* ---- events ---- */

static inline void scene_push(scene *s, ui_event event)
{
    ui_push(s->ui, &event);
}

static inline void scene_move(scene *s, float x, float y)
{
    scene_push(s, (ui_event){.kind = UI_EVENT_MOVE, .x = x, .y = y});
}

static inline void scene_button(scene *s, uint32_t button, bool is_down)
{
    scene_push(s, (ui_event){.kind = UI_EVENT_BUTTON, .code = button, .is_down = is_down});
}

static inline void scene_hold_key(scene *s, uint32_t key, bool is_down)
{
    scene_push(s, (ui_event){.kind = UI_EVENT_KEY, .code = key, .is_down = is_down});
}

static inline void scene_modifiers(scene *s, uint32_t modifiers, bool is_down)
{
    static const uint32_t keys[][2] = {
        {UI_SHIFT, UI_KEY_SHIFT}, {UI_CONTROL, UI_KEY_CONTROL}, {UI_ALT, UI_KEY_ALT}};
    for (size_t i = 0; i < 3; ++i)
        if (modifiers & keys[i][0])
            scene_hold_key(s, keys[i][1], is_down);
}

static inline void scene_key(scene *s, uint32_t key, uint32_t modifiers)
{
    scene_modifiers(s, modifiers, true);
    scene_hold_key(s, key, true);
    scene_hold_key(s, key, false);
    scene_modifiers(s, modifiers, false);
    scene_settle(s);
}

static inline void scene_do(scene *s, action of)
{
    scene_key(s, action_of(of)->key, action_of(of)->modifiers);
}

static inline void scene_type(scene *s, const char *ascii)
{
    for (; *ascii; ++ascii)
        scene_push(s, (ui_event){.kind = UI_EVENT_TEXT, .code = (uint32_t)(unsigned char)*ascii});
    scene_settle(s);
}

static inline void scene_click_with(scene *s, float x, float y, uint32_t button)
{
    scene_move(s, x, y);
    scene_settle(s); /* what is hovered shows itself first, as to a person */
    scene_button(s, button, true);
    scene_button(s, button, false);
    scene_settle(s);
}

static inline void scene_click(scene *s, float x, float y)
{
    scene_click_with(s, x, y, 0);
}

static inline void scene_drag(scene *s, float x0, float y0, float x1, float y1, uint32_t steps)
{
    scene_move(s, x0, y0);
    scene_settle(s);
    scene_button(s, 0, true);
    for (uint32_t i = 1; i <= steps; ++i) {
        const float share = (float)i / (float)steps;
        scene_move(s, x0 + share * (x1 - x0), y0 + share * (y1 - y0));
        scene_frame(s);
    }
    scene_button(s, 0, false);
    scene_settle(s);
}

/* ---- words ---- */

/* The first of that text; NULL: it is not on the screen. Until the next frame. */
static inline const ui_word *scene_word(scene *s, const char *text)
{
    const ui_word *words;
    const uint32_t count = ui_words(s->ui, &words);
    for (uint32_t i = 0; i < count; ++i)
        if (strcmp(words[i].text, text) == 0)
            return &words[i];
    return NULL;
}

/* Some word that contains it. */
static inline const ui_word *scene_word_with(scene *s, const char *part)
{
    const ui_word *words;
    const uint32_t count = ui_words(s->ui, &words);
    for (uint32_t i = 0; i < count; ++i)
        if (strstr(words[i].text, part))
            return &words[i];
    return NULL;
}

static inline void scene_click_word(scene *s, const char *text)
{
    const ui_word *word = scene_word(s, text);
    if (!word)
        fail_msg("\"%s\" is not on the screen", text);
    else
        scene_click(s, word->where.x + 0.5f * word->where.width,
                    word->where.y + 0.5f * word->where.height);
}

/* Words with this in them may end with an ellipsis: names and paths. The text must live on. */
static inline void scene_let_cut(scene *s, const char *part)
{
    for (size_t i = 0; i < SCENE_LET_CUT; ++i)
        if (!s->let_cut[i]) {
            s->let_cut[i] = part;
            return;
        }
}

static inline float scene_channel(uint32_t colour, uint32_t shift)
{
    const float part = (float)(colour >> shift & 0xffu) / 255.0f;
    return part <= 0.04045f ? part / 12.92f : powf((part + 0.055f) / 1.055f, 2.4f);
}

/* As WCAG 2 counts it. */
static inline float scene_contrast(uint32_t a, uint32_t b)
{
    float light[2];
    const uint32_t both[2] = {a, b};
    for (size_t i = 0; i < 2; ++i)
        light[i] = 0.2126f * scene_channel(both[i], 24) + 0.7152f * scene_channel(both[i], 16) +
                   0.0722f * scene_channel(both[i], 8);
    return (fmaxf(light[0], light[1]) + 0.05f) / (fminf(light[0], light[1]) + 0.05f);
}

static inline ui_rectangle scene_seen(const ui_word *word)
{
    const ui_rectangle a = word->where, b = word->clip;
    const float x0 = fmaxf(a.x, b.x), y0 = fmaxf(a.y, b.y);
    const float x1 = fminf(a.x + a.width, b.x + b.width),
                y1 = fminf(a.y + a.height, b.y + b.height);
    return (ui_rectangle){x0, y0, fmaxf(x1 - x0, 0.0f), fmaxf(y1 - y0, 0.0f)};
}

/* Of two words that touch by less than half a point nobody speaks. */
static inline bool scene_overlap(ui_rectangle a, ui_rectangle b)
{
    return a.x + 0.5f < b.x + b.width && b.x + 0.5f < a.x + a.width &&
           a.y + 0.5f < b.y + b.height && b.y + 0.5f < a.y + a.height;
}

static inline bool scene_may_be_cut(const scene *s, const ui_word *word)
{
    for (size_t i = 0; i < SCENE_LET_CUT && s->let_cut[i]; ++i)
        if (strstr(word->text, s->let_cut[i]))
            return true;
    return false;
}

/* Each fault is told; returns how many there are. */
static inline uint32_t scene_word_faults(scene *s)
{
    const ui_word *words;
    const uint32_t count = ui_words(s->ui, &words);
    uint32_t faults = 0;
    for (uint32_t i = 0; i < count; ++i) {
        const ui_word *word = &words[i];
        const ui_rectangle seen = scene_seen(word);
        if (word->is_cut && seen.width <= 0.0f && seen.height > 0.0f) {
            print_message("out of reach: \"%s\"\n", word->text);
            faults += 1;
        }
        if (seen.width <= 0.0f || seen.height <= 0.0f)
            continue;
        if (word->is_cut && !scene_may_be_cut(s, word)) {
            print_message("cut: \"%s\"\n", word->text);
            faults += 1;
        }
        if (seen.width + 0.6f < word->where.width && !scene_may_be_cut(s, word)) {
            print_message("beyond its panel: \"%s\"\n", word->text);
            faults += 1;
        }
        if (word->ground && scene_contrast(word->colour, word->ground) < 4.5f) {
            print_message("contrast %.2f: \"%s\", #%08x on #%08x\n",
                          (double)scene_contrast(word->colour, word->ground), word->text,
                          word->colour, word->ground);
            faults += 1;
        }
        for (uint32_t k = 0; k < i; ++k)
            if (scene_overlap(seen, scene_seen(&words[k]))) {
                print_message("\"%s\" overlaps \"%s\" at %.0f, %.0f\n", word->text, words[k].text,
                              (double)seen.x, (double)seen.y);
                faults += 1;
            }
    }
    return faults;
}

static inline void scene_check_words(scene *s)
{
    const uint32_t faults = scene_word_faults(s);
    if (faults)
        fail_msg("%u faults of words", faults);
}

/* ---- pictures ---- */

/* A frame that is drawn whole. */
static inline void scene_draw(scene *s)
{
    window_hidden_put_away(s->window, false);
    scene_frame(s);
    window_hidden_put_away(s->window, !s->is_drawn);
}

/* The same, as BUILD_DIR/out/NAME.png. */
static inline void scene_picture(scene *s, const char *name)
{
    char path[512];
    error err = {0};
    (void)mkdir(BUILD_DIR "/out", 0777);
    (void)snprintf(path, sizeof path, "%s/out/%s.png", BUILD_DIR, name);
    scene_draw(s);
    if (window_picture(s->window, path, &err) < 0)
        fail_msg("%s", err.text);
}

/* For people who look at pictures of the tests. */
static inline void scene_look(scene *s, const char *name)
{
    if (getenv("MAROTTE_PICTURES"))
        scene_picture(s, name);
    else
        scene_frame(s);
}

#endif
