/* The panel Poses: thumbnails of the poses of the face, in groups, favourites first. A click plays
 * a pose. "Learn" connects a key, a pad, a button or a fader to it. The thumbnails are computed in
 * the background, and each is drawn once. */
#include "window/panels/panels.h"

#include "window/app/kept_life.h"
#include "window/app/pose_palette.h"
#include "window/gui/theme.h"
#include "window/viewport/posed_shape.h"
#include "window/viewport/viewport.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NOBODY UINT32_MAX
#define LABEL  74.0f

enum { THUMBNAIL_PIXELS = 176, LABEL_TEXT = 64 };
static const float cell_least = 84.0f, line = 17.0f, gap = 4.0f;

struct panel {
    app *app;
    posed_shape *shapes;
    const mrt_rig_pose *poses; /* of the thumbnails; only to be compared */
    const face_file *file;     /* likewise */
    theme theme;
    uint32_t thumbnail[PALETTE_POSES_MAX]; /* textures; 0: not drawn yet */
    uint32_t next;                         /* first pose without a thumbnail; NOBODY */
    pose_settings work; /* as drawn; newer than the settings while a slider is dragged */
    bool is_held, is_learning;
    life_settings life; /* as drawn, likewise */
    bool is_life_held;
    uint32_t played; /* by the mouse; NOBODY: none */
    bool is_drawn;   /* in this frame */
    ui_rectangle where;
    char search[32];
};

/* ---- names ---- */

/* "jawOpen" becomes "Jaw open", "viseme_PP" "Viseme PP". */
static void write_label(const char *name, char out[LABEL_TEXT])
{
    size_t used = 0;
    for (size_t i = 0; name[i] && used + 2 < LABEL_TEXT; ++i) {
        const bool is_upper = isupper((unsigned char)name[i]) != 0,
                   was_lower = i > 0 && islower((unsigned char)name[i - 1]) != 0,
                   is_word = is_upper && name[i + 1] && islower((unsigned char)name[i + 1]) != 0;
        if (name[i] == '_' || name[i] == '.') {
            out[used++] = ' ';
            continue;
        }
        if (is_upper && was_lower)
            out[used++] = ' ';
        out[used] = is_word && used > 0 ? (char)tolower((unsigned char)name[i]) : name[i];
        used += 1;
    }
    out[used] = '\0';
    out[0] = (char)toupper((unsigned char)out[0]);
}

static bool has_text(const char *in, const char *wanted)
{
    const size_t size = strlen(wanted);
    for (size_t at = 0; strlen(in + at) >= size; ++at) {
        size_t same = 0;
        while (same < size &&
               tolower((unsigned char)in[at + same]) == tolower((unsigned char)wanted[same]))
            same += 1;
        if (same == size)
            return true;
    }
    return false;
}

static bool is_sought(const panel *self, const char *name)
{
    char label[LABEL_TEXT];
    write_label(name, label);
    return has_text(label, self->search) || has_text(name, self->search);
}

static uint32_t favourite_of(const pose_settings *s, const char *name)
{
    for (uint32_t i = 0; i < s->favourite_count; ++i)
        if (strcmp(s->favourite[i], name) == 0)
            return i;
    return NOBODY;
}

/* ---- thumbnails ---- */

static void forget_thumbnails(panel *self)
{
    for (uint32_t i = 0; i < PALETTE_POSES_MAX; ++i) {
        draw_texture_destroy(self->thumbnail[i]);
        self->thumbnail[i] = 0;
    }
}

static void ground_of(const panel *self, float out[4])
{
    const uint32_t colour = theme_colour(app_looks_of(self->app)->theme, THEME_WELL);
    for (int i = 0; i < 3; ++i)
        out[i] = (float)(colour >> (24 - 8 * i) & 255u) / 255.0f;
    out[3] = 1.0f;
}

/* Finds the box of the contacts, with a margin: the part of the head that poses move. Returns false
 * if the face has none. */
static bool find_frame(const panel *self, float out[6])
{
    static const float margin = 0.18f;
    const mrt_face *about = app_view(self->app)->about;
    if (!about || about->contact_count == 0)
        return false;
    for (uint32_t i = 0; i < about->contact_count; ++i) {
        const mrt_vec3 rest = about->contacts[i].rest;
        const float at[3] = {rest.x, rest.y, rest.z};
        for (int k = 0; k < 3; ++k) {
            out[k] = i ? fminf(out[k], at[k]) : at[k];
            out[3 + k] = i ? fmaxf(out[3 + k], at[k]) : at[k];
        }
    }
    const float more = margin * (out[4] - out[1]);
    for (int k = 0; k < 3; ++k) {
        out[k] -= more;
        out[3 + k] += more;
    }
    return true;
}

/* Draws at most one thumbnail a frame, after the thread has computed its shape. */
static void draw_thumbnail(panel *self, ui *on)
{
    viewport *view = app_viewport(self->app);
    const uint32_t pose = self->next;
    uint32_t vertex_count = 0;
    float ground[4], frame[6];
    if (pose == NOBODY || !view || ui_is_hidden(on))
        return;
    const char *const wanted[POSED_TOGETHER] = {pose_palette_name(app_poses(self->app), pose),
                                                NULL};
    const float *position = posed_shape_of(self->shapes, wanted, &vertex_count);
    ui_want_frame(on, position ? 0.0 : 0.05);
    if (!position)
        return;
    ground_of(self, ground);
    const bool has_frame = find_frame(self, frame);
    if (viewport_portrait(view, position, vertex_count, ground, has_frame ? frame : NULL,
                          THUMBNAIL_PIXELS, THUMBNAIL_PIXELS))
        self->thumbnail[pose] = viewport_copy_portrait(view);
}

static void follow_face(panel *self)
{
    uint32_t count;
    const mrt_rig_pose *poses = live_poses(app_live(self->app), &count);
    const face_file *file = app_face(self->app);
    const theme now = app_looks_of(self->app)->theme;
    posed_shape_follow(self->shapes, file);
    if (poses == self->poses && file == self->file && memcmp(&now, &self->theme, sizeof now) == 0)
        return;
    forget_thumbnails(self);
    self->poses = poses;
    self->file = file;
    self->theme = now;
    self->played = NOBODY;
}

/* ---- one pose ---- */

static void toggle_favourite(panel *self, const char *name)
{
    pose_settings to = self->work;
    const uint32_t at = favourite_of(&to, name);
    if (at != NOBODY) {
        to.favourite_count -= 1;
        memmove(to.favourite[at], to.favourite[at + 1],
                (to.favourite_count - at) * sizeof *to.favourite);
    } else if (to.favourite_count < POSE_FAVOURITES_MAX) {
        (void)snprintf(to.favourite[to.favourite_count++], POSE_NAME, "%s", name);
    }
    pose_palette_change(app_poses(self->app), &to,
                        at != NOBODY ? "favourite removed" : "favourite added");
    self->work = to;
}

static void forget_controls(panel *self, const char *name)
{
    pose_settings to = self->work;
    uint32_t kept = 0;
    for (uint32_t i = 0; i < to.trigger_count; ++i)
        if (strcmp(to.trigger[i].pose, name) != 0)
            to.trigger[kept++] = to.trigger[i];
    to.trigger_count = kept;
    pose_palette_change(app_poses(self->app), &to, "controls forgotten");
    self->work = to;
}

static void draw_menu(panel *self, ui *on, uint32_t pose, const char *name, bool has_controls)
{
    if (!ui_menu_begin(on, "menu"))
        return;
    const bool is_favourite = favourite_of(&self->work, name) != NOBODY;
    if (ui_menu_item(on, is_favourite ? "Remove from favourites" : "Add to favourites", "", true))
        toggle_favourite(self, name);
    if (ui_menu_item(on, "Learn a key, pad or fader", "", true))
        pose_palette_learn(app_poses(self->app), pose);
    if (ui_menu_item(on, "Forget its controls", "", has_controls))
        forget_controls(self, name);
    ui_menu_end(on);
}

static void press(panel *self, uint32_t pose)
{
    pose_palette *of = app_poses(self->app);
    if (self->is_learning) {
        pose_palette_learn(of, pose);
        return;
    }
    self->played = pose;
    pose_palette_press(of, pose);
}

/* Draws a label in one or two lines. */
static void draw_label(ui *on, float x, float y, float width, const char *label)
{
    char first[LABEL_TEXT];
    (void)snprintf(first, sizeof first, "%s", label);
    for (char *space; ui_text_width(on, UI_STYLE_BODY, first) > width;) {
        space = strrchr(first, ' ');
        if (!space)
            break;
        *space = '\0';
    }
    ui_draw_text(on, x, y, UI_STYLE_BODY, THEME_TEXT, width, first);
    if (label[strlen(first)] == ' ')
        ui_draw_text(on, x, y + line, UI_STYLE_BODY, THEME_TEXT, width, label + strlen(first) + 1);
}

static void draw_cell(panel *self, ui *on, uint32_t pose, float size, float caption)
{
    pose_palette *of = app_poses(self->app);
    const char *name = pose_palette_name(of, pose);
    char label[LABEL_TEXT], controls[96], hint[256];
    const float strength = (float)pose_palette_wanted(of, pose);
    const bool is_learnt = pose_palette_learns(of) == pose;
    ui_canvas at;
    if (!self->thumbnail[pose] && self->next == NOBODY)
        self->next = pose;
    ui_id_begin(on, name);
    ui_canvas_begin(on, "cell", size, size + caption, &at);
    if (!ui_rectangles_meet(at.where, self->where) && self->played != pose) {
        ui_canvas_end(on); /* scrolled away */
        ui_id_end(on);
        return;
    }
    write_label(name, label);
    pose_palette_describe(of, name, controls, sizeof controls);
    const ui_rectangle picture = {at.where.x, at.where.y, size, size};
    if (at.is_pressed && at.button == 0)
        press(self, pose);
    if (self->played == pose && (at.is_released || !at.is_dragging) && !at.is_pressed) {
        self->played = NOBODY;
        pose_palette_release(of);
    }
    ui_draw_box(on, picture, THEME_WELL, 4.0f);
    if (self->thumbnail[pose])
        ui_draw_image(on, picture, self->thumbnail[pose], 1, app_looks_of(self->app)->is_mirrored);
    if (strength > 0.0f)
        ui_draw_box(on, (ui_rectangle){picture.x, picture.y + size - 4.0f, size * strength, 4.0f},
                    THEME_ACCENT, 1.0f);
    if (is_learnt || strength > 0.0f || at.is_hovered)
        ui_draw_frame(on, picture,
                      is_learnt         ? THEME_WARNING
                      : strength > 0.0f ? THEME_ACCENT
                                        : THEME_RULE,
                      4.0f, is_learnt || strength > 0.0f ? 2.0f : 1.0f);
    if (controls[0]) {
        const float width = fminf(ui_text_width(on, UI_STYLE_BODY, controls) + 8.0f, size - 4.0f);
        const ui_rectangle badge = {picture.x + 2.0f, picture.y + 2.0f, width, 18.0f};
        ui_draw_box(on, badge, THEME_RAISED, 3.0f);
        ui_draw_text(on, badge.x + 4.0f, badge.y + 1.0f, UI_STYLE_BODY, THEME_TEXT, width - 6.0f,
                     controls);
    }
    draw_label(on, at.where.x, at.where.y + size, size, label);
    ui_canvas_end(on);
    (void)snprintf(hint, sizeof hint, "%s.%s%s%s", label, controls[0] ? " Played by " : "",
                   controls, controls[0] ? "." : "");
    ui_hint(on, hint);
    draw_menu(self, on, pose, name, controls[0] != '\0');
    ui_id_end(on);
}

/* ---- groups ---- */

typedef enum group { FAVOURITES = 0, MOUTHS, UPPER_HALVES, WHOLE_FACES, GROUPS } group;

static bool is_in(const panel *self, uint32_t pose, group of)
{
    static const uint32_t part[GROUPS] = {
        [MOUTHS] = MRT_POSE_MOUTH, [UPPER_HALVES] = MRT_POSE_UPPER, [WHOLE_FACES] = MRT_POSE_WHOLE};
    const char *name = self->poses[pose].name;
    const bool is_favourite = favourite_of(&self->work, name) != NOBODY;
    if (!is_sought(self, name) || is_favourite != (of == FAVOURITES))
        return false;
    return of == FAVOURITES || self->poses[pose].part == part[of];
}

static void draw_group(panel *self, ui *on, group of)
{
    static const char *const title[GROUPS] = {"Favourites", "Mouths", "Upper halves",
                                              "Whole faces"};
    const uint32_t count = pose_palette_count(app_poses(self->app));
    uint32_t list[PALETTE_POSES_MAX], found = 0;
    for (uint32_t i = 0; i < count; ++i)
        if (is_in(self, i, of))
            list[found++] = i;
    if (found == 0 || !ui_section(on, title[of], true))
        return;
    const float room = ui_available_width(on);
    const uint32_t column_count = (uint32_t)fmaxf(floorf((room + gap) / (cell_least + gap)), 1.0f);
    const float size = floorf((room + gap) / (float)column_count - gap);
    float caption = line + 1.0f;
    for (uint32_t i = 0; i < found; ++i) {
        char label[LABEL_TEXT];
        write_label(self->poses[list[i]].name, label);
        if (ui_text_width(on, UI_STYLE_BODY, label) > size) {
            caption = 2.0f * line + 1.0f;
            break;
        }
    }
    ui_id_begin(on, title[of]);
    for (uint32_t i = 0; i < found; ++i) {
        const uint32_t column = i % column_count;
        if (column > 0) {
            ui_same_line(on);
            ui_at(on, (float)column * (size + gap));
        }
        draw_cell(self, on, list[i], size, caption);
    }
    ui_id_end(on);
}

/* ---- the head of the panel ---- */

static void commit(panel *self, const char *words)
{
    pose_palette_change(app_poses(self->app), &self->work, words);
}

/* One slider: its changes are one step of undo. */
static void draw_number(panel *self, ui *on, const char *label, const char *hint,
                        const ui_range *range, double *value, double now)
{
    (void)ui_slider(on, label, LABEL, range, value);
    const bool is_held = ui_slider_is_held(on);
    ui_hint(on, hint);
    self->is_held |= is_held;
    if (!is_held && (*value < now || *value > now))
        commit(self, label);
}

static void draw_head(panel *self, ui *on)
{
    static const char *const modes[] = {"Hold", "Latch"};
    static const ui_range fade = {0.0, POSE_FADE_MOST_S, "s", 2, false, 0.2};
    static const ui_range strength = {0.0, 1.0, "", 2, false, 1.0};
    pose_palette *of = app_poses(self->app);
    const pose_settings *now = pose_palette_settings(of);
    uint32_t mode = (uint32_t)self->work.mode;
    if (ui_choice(on, "Mode", LABEL, modes, 2, &mode)) {
        self->work.mode = (pose_mode)mode;
        commit(self, modes[mode]);
    }
    ui_hint(on, "Hold: a pose stays while its key is down. Latch: the next press ends it.");
    draw_number(self, on, "Fade in", "Time in which a pose appears.", &fade, &self->work.fade_in_s,
                now->fade_in_s);
    draw_number(self, on, "Fade out", "Time in which a pose ends.", &fade, &self->work.fade_out_s,
                now->fade_out_s);
    draw_number(self, on, "Strength",
                "Strength of clicks and keys. Pads play as hard as they are hit.", &strength,
                &self->work.strength, now->strength);
    if (ui_button(on, self->is_learning ? "Stop learning" : "Learn",
                  self->is_learning ? UI_ACCENT : UI_PLAIN)) {
        self->is_learning = !self->is_learning;
        pose_palette_learn(of, NOBODY);
    }
    ui_hint(on, "Connect keys, pads, buttons and faders to poses.");
    ui_same_line(on);
    if (ui_button(on, "Release all", UI_PLAIN))
        pose_palette_release_all(of, self->work.fade_out_s);
    ui_hint(on, "Fade out all poses that are latched.");
}

static void draw_search(panel *self, ui *on)
{
    ui_width(on, 0.0f);
    (void)ui_input(on, "##search", "Search", self->search, sizeof self->search);
}

static void draw_learning(panel *self, ui *on)
{
    pose_palette *of = app_poses(self->app);
    const uint32_t pose = pose_palette_learns(of);
    char label[LABEL_TEXT], words[LABEL_TEXT + 80];
    if (pose != NOBODY) {
        write_label(pose_palette_name(of, pose), label);
        (void)snprintf(words, sizeof words, "%s: press a key, a pad or a button, or move a fader.",
                       label);
        ui_text_wrapped(on, UI_STYLE_STRONG, words);
    } else if (self->is_learning) {
        ui_text_wrapped(on, UI_STYLE_STRONG, "Click a pose.");
    }
    if ((pose != NOBODY || self->is_learning) && ui_pressed(on, UI_KEY_ESCAPE, 0)) {
        self->is_learning = false;
        pose_palette_learn(of, NOBODY);
    }
}

/* ---- life ---- */

/* One kind: its switch, and its strength. */
static void draw_life_of(panel *self, ui *on, life_kind kind)
{
    static const ui_range strength = {0.0, 1.0, "", 2, false, 0.5};
    static const struct {
        const char *name, *hint, *strength_hint;
    } about[LIFE_KINDS] = {
        [LIFE_BLINK] = {"Blinks", "Close both lids now and then, but not soon after the hand did.",
                        "How often: 11 to 19 times a minute."},
        [LIFE_GAZE] = {"Gaze", "Let the eyes dart, and come back to the camera.",
                       "How far the eyes dart."},
        [LIFE_BREATH] = {"Breath", "Let the head rise and sink with the breath.",
                         "How far the head moves."},
        [LIFE_LEAN] = {"Lean", "Let eyes and head lean into each turn of the head.",
                       "How far they lean."}};
    kept_life *of = app_life(self->app);
    life_settings *work = &self->life;
    const life_settings *now = kept_life_now(of);
    const char *missing = live_life_missing(app_live(self->app), kind);
    ui_id_begin(on, about[kind].name);
    ui_disabled_begin(on, missing != NULL);
    char words[64];
    if (ui_check(on, about[kind].name, &work->is_on[kind])) {
        (void)snprintf(words, sizeof words, "%s %s", about[kind].name,
                       work->is_on[kind] ? "on" : "off");
        kept_life_change(of, work, words);
    }
    ui_hint(on, about[kind].hint);
    ui_same_line(on);
    ui_at(on, LABEL);
    (void)ui_slider(on, "##strength", 0.0f, &strength, &work->strength[kind]);
    const bool is_held = ui_slider_is_held(on);
    ui_hint(on, about[kind].strength_hint);
    self->is_life_held |= is_held;
    if (!is_held && (work->strength[kind] < now->strength[kind] ||
                     work->strength[kind] > now->strength[kind])) {
        (void)snprintf(words, sizeof words, "%s %.2f", about[kind].name, work->strength[kind]);
        kept_life_change(of, work, words);
    }
    ui_disabled_end(on);
    if (missing)
        ui_text_wrapped(on, UI_STYLE_DIM, missing);
    ui_id_end(on);
}

static void draw_life(panel *self, ui *on)
{
    if (!self->is_life_held)
        self->life = *kept_life_now(app_life(self->app));
    self->is_life_held = false;
    if (!ui_section(on, "Life", false))
        return;
    for (int kind = 0; kind < LIFE_KINDS; ++kind)
        draw_life_of(self, on, (life_kind)kind);
    const char *trouble = live_life_trouble(app_live(self->app));
    if (trouble[0])
        ui_text_wrapped(on, UI_STYLE_WARNING, trouble);
}

/* ---- the panel ---- */

#define LOW_POINTS 420.0f /* below this height, all but the search scrolls */

static void draw(panel *self, ui *on, ui_rectangle where)
{
    pose_palette *of = app_poses(self->app);
    self->where = where;
    pose_palette_want(of);
    follow_face(self);
    if (!self->is_held)
        self->work = *pose_palette_settings(of);
    self->is_held = false;
    self->is_drawn = true;
    self->next = NOBODY;
    const bool is_low = where.height < LOW_POINTS;
    ui_panel_begin(on, "poses", where, UI_GROUND_PANEL);
    if (!is_low) {
        draw_life(self, on);
        draw_head(self, on);
    }
    draw_search(self, on);
    draw_learning(self, on);
    const char *trouble = pose_palette_trouble(of);
    if (trouble[0])
        ui_text_wrapped(on, UI_STYLE_WARNING, trouble);
    ui_scroll_begin(on, "scroll", 0.0f, 0.0f);
    if (is_low) {
        draw_life(self, on);
        draw_head(self, on);
    }
    bool has_any = false;
    for (uint32_t i = 0; i < pose_palette_count(of); ++i)
        has_any |= is_sought(self, self->poses[i].name);
    if (!has_any && !trouble[0] && self->search[0])
        ui_text_wrapped(on, UI_STYLE_DIM, "No pose has this name.");
    for (group g = FAVOURITES; g < GROUPS; ++g)
        draw_group(self, on, g);
    ui_scroll_end(on);
    ui_panel_end(on);
    draw_thumbnail(self, on);
}

/* A pose that the mouse holds ends with the panel. */
static void update(panel *self, double dt_s)
{
    (void)dt_s;
    if (!self->is_drawn && (self->played != NOBODY || self->is_learning)) {
        self->played = NOBODY;
        self->is_learning = false;
        pose_palette_release(app_poses(self->app));
        pose_palette_learn(app_poses(self->app), NOBODY);
    }
    self->is_drawn = false;
}

static void destroy(panel *self)
{
    if (!self)
        return;
    forget_thumbnails(self);
    posed_shape_destroy(self->shapes);
    free(self);
}

static panel *create(app *of)
{
    panel *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->app = of;
    self->played = NOBODY;
    self->shapes = posed_shape_create();
    if (self->shapes)
        return self;
    free(self);
    return NULL;
}

const panel_type panel_poses = {create, destroy, draw, update};
