/* The scene panel: look presets, three movable lights, the wall or a background picture, and camera
 * views. The show stores all of them. */
#include "window/panels/panels.h"
#include "window/app/kept_scenery.h"
#include "window/gui/theme.h"
#include "window/viewport/viewport.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LABEL     70.0f
#define PAD       184.0f
#define LAMP_SIZE 9.0f

struct panel {
    app *app;
    int held;         /* dragged lamp; -1: none */
    bool has_changed; /* since the last save */
};

static const char *const lamp_names[LIGHTING_LAMPS] = {"Key", "Fill", "Rim"};
static const char *const lamp_hints[LIGHTING_LAMPS] = {
    "Main light. It casts the shadow.", "Brightens the side that the key light leaves dark.",
    "Light from behind. It separates the head from the wall."};

/* ---- looks ---- */

static uint32_t look_now(const lighting *light)
{
    for (uint32_t i = 0; i < LIGHTING_LOOKS; ++i)
        if (memcmp(light, &lighting_looks[i].light, sizeof *light) == 0)
            return i;
    return LIGHTING_LOOKS;
}

static bool draw_looks(ui *on, scenery *scene)
{
    const uint32_t now = look_now(&scene->light);
    bool has_changed = false;
    for (uint32_t i = 0; i < LIGHTING_LOOKS; ++i) {
        if (i > 0)
            ui_same_line(on);
        if (ui_button(on, lighting_looks[i].name, i == now ? UI_ACCENT : UI_PLAIN)) {
            scene->light = lighting_looks[i].light;
            has_changed = true;
        }
        ui_hint(on, lighting_looks[i].about);
    }
    return has_changed;
}

/* ---- lights ---- */

static void lamp_position(const ui_canvas *pad, const lighting_lamp *lamp, float out[2])
{
    const float radius = 0.5f * PAD - LAMP_SIZE - 2.0f;
    out[0] = pad->where.x + 0.5f * PAD + radius * lamp->direction[0];
    out[1] = pad->where.y + 0.5f * PAD - radius * lamp->direction[1];
}

/* Returns the nearest lamp under the pointer, or -1. */
static int lamp_at(const ui_canvas *pad, const lighting *light)
{
    const float x = pad->where.x + pad->x, y = pad->where.y + pad->y;
    float nearest = 2.0f * LAMP_SIZE;
    int found = -1;
    for (int i = 0; i < LIGHTING_LAMPS; ++i) {
        float at[2];
        lamp_position(pad, &light->lamp[i], at);
        const float far = hypotf(at[0] - x, at[1] - y);
        if (far < nearest) {
            nearest = far;
            found = i;
        }
    }
    return found;
}

static void paint_lamp(ui *on, const ui_canvas *pad, const lighting_lamp *lamp, const char *name,
                       bool is_lit)
{
    float at[2];
    lamp_position(pad, lamp, at);
    const bool is_behind = lamp->direction[2] < 0.0f;
    const uint32_t colour = is_lit ? THEME_ACCENT : THEME_TEXT;
    const ui_rectangle disc = {at[0] - LAMP_SIZE, at[1] - LAMP_SIZE, 2.0f * LAMP_SIZE,
                               2.0f * LAMP_SIZE};
    ui_draw_box(on, disc, is_behind ? THEME_WELL : colour, LAMP_SIZE);
    ui_draw_ring(on, at[0], at[1], LAMP_SIZE, colour, 2.0f);
    char letter[2] = {name[0], '\0'};
    const float width = ui_text_width(on, UI_STYLE_STRONG, letter);
    ui_draw_text(on, at[0] - 0.5f * width, at[1] - 0.5f * ui_text_height(on, UI_STYLE_STRONG),
                 UI_STYLE_STRONG, is_behind ? colour : THEME_STAGE, 0.0f, letter);
}

/* Draws a sphere as seen by the camera, with the lamps in front of the head (filled) and behind it
 * (hollow). */
static bool draw_pad(panel *self, ui *on, lighting *light)
{
    ui_canvas pad;
    bool has_changed = false;
    ui_canvas_begin(on, "lights", PAD, PAD, &pad);
    const float x = pad.where.x + 0.5f * PAD, y = pad.where.y + 0.5f * PAD;
    const int over = pad.is_hovered ? lamp_at(&pad, light) : -1;
    if (pad.is_pressed)
        self->held = over;
    if (self->held >= 0 && (pad.is_dragging || pad.is_released)) {
        const float radius = 0.5f * PAD - LAMP_SIZE - 2.0f;
        if (pad.moved_x != 0.0f || pad.moved_y != 0.0f) {
            lighting_move(&light->lamp[self->held], (pad.x - 0.5f * PAD) / radius,
                          (0.5f * PAD - pad.y) / radius);
            has_changed = true;
        }
        if (pad.is_released)
            self->held = -1;
    }
    if (pad.is_double_clicked && over >= 0) {
        lighting_turn_behind(&light->lamp[over]);
        has_changed = true;
    }
    ui_draw_disc(on, x, y, 0.5f * PAD - 2.0f, THEME_WELL);
    ui_draw_ring(on, x, y, 0.5f * PAD - 2.0f, THEME_RULE, 1.0f);
    ui_draw_ring(on, x, y, 0.20f * PAD, THEME_RULE, 1.5f); /* the head */
    for (int i = LIGHTING_LAMPS - 1; i >= 0; --i)
        paint_lamp(on, &pad, &light->lamp[i], lamp_names[i], i == over || i == self->held);
    if (over >= 0)
        ui_set_cursor(on, UI_CURSOR_MOVE);
    ui_canvas_end(on);
    ui_hint(on, "Drag a light to move it. Double-click it to switch between front and behind the "
                "head (hollow).");
    return has_changed;
}

static bool draw_power(ui *on, const char *label, const char *hint, float *power, float most)
{
    const ui_range range = {0.0, (double)most * 100.0, "%", 0, true, 100.0};
    double value = 100.0 * (double)*power;
    const bool has_changed = ui_slider(on, label, LABEL, &range, &value);
    ui_hint(on, hint);
    if (has_changed)
        *power = (float)(0.01 * value);
    return has_changed;
}

/* ---- the wall ---- */

typedef struct wall {
    const char *name;
    float edge[3], light[3];
} wall;
static const wall walls[] = {{"From the look", {0}, {0}},
                             {"Black", {0.0f, 0.0f, 0.0f}, {0.0f, 0.0f, 0.0f}},
                             {"Grey", {0.33f, 0.33f, 0.34f}, {0.50f, 0.50f, 0.51f}},
                             {"White", {0.93f, 0.93f, 0.93f}, {1.0f, 1.0f, 1.0f}},
                             {"Sky", {0.34f, 0.52f, 0.72f}, {0.66f, 0.80f, 0.92f}},
                             {"Rose", {0.52f, 0.24f, 0.28f}, {0.80f, 0.50f, 0.50f}},
                             {"Green to key", {0.0f, 0.694f, 0.251f}, {0.0f, 0.694f, 0.251f}}};
enum { WALLS = sizeof walls / sizeof walls[0] };

static bool draw_wall(ui *on, lighting *light)
{
    const char *names[WALLS];
    uint32_t now = 0;
    for (uint32_t i = 0; i < WALLS; ++i) {
        names[i] = walls[i].name;
        if (i > 0 && memcmp(light->wall_edge, walls[i].edge, sizeof light->wall_edge) == 0 &&
            memcmp(light->wall_light, walls[i].light, sizeof light->wall_light) == 0)
            now = i;
    }
    const bool has_changed = ui_choice(on, "Wall", LABEL, names, WALLS, &now);
    ui_hint(on, "Set the background of the face in the window, in streams and in exports.");
    if (!has_changed)
        return false;
    const uint32_t look = look_now(light);
    const lighting *own = &lighting_looks[look < LIGHTING_LOOKS ? look : 0].light;
    memcpy(light->wall_edge, now ? walls[now].edge : own->wall_edge, sizeof light->wall_edge);
    memcpy(light->wall_light, now ? walls[now].light : own->wall_light, sizeof light->wall_light);
    return true;
}

/* ---- background picture ---- */

static bool draw_picture(panel *self, ui *on, scenery *scene)
{
    static const char *const fits[] = {[DRAW_COVER] = "Fill", [DRAW_CONTAIN] = "Whole picture"};
    const bool is_reading = kept_scenery_is_reading(app_scenery(self->app));
    show *of = app_show(self->app);
    const bool can_be_kept = of && show_is_writable(of);
    bool has_changed = false;
    ui_disabled_begin(on, is_reading || !can_be_kept);
    if (ui_button(on,
                  is_reading ? "Loading the picture##picture" : "Background picture...##picture",
                  UI_PLAIN))
        app_ask(self->app, APP_CALL_PICTURE);
    ui_hint(on, can_be_kept ? "Choose a PNG or JPEG for the background, or drop one on the window. "
                              "The show stores it."
                            : "The picture is stored in the show. Open a writable show first.");
    ui_disabled_end(on);
    if (!scene->picture[0])
        return false;
    ui_same_line(on);
    if (ui_button(on, "Remove##picture_removed", UI_QUIET)) {
        memset(scene->picture, 0, sizeof scene->picture);
        memset(scene->picture_name, 0, sizeof scene->picture_name);
        scene->fit = DRAW_COVER;
        return true;
    }
    ui_hint(on, "Remove the picture and show the wall.");
    ui_text(on, UI_STYLE_DIM, scene->picture_name);
    uint32_t fit = scene->fit;
    has_changed = ui_choice(on, "Fit", LABEL, fits, 2, &fit);
    ui_hint(on, "Choose how the picture fits a window or video of another aspect ratio.");
    scene->fit = (draw_fit)fit;
    return has_changed;
}

/* ---- views ---- */

static bool draw_views(panel *self, ui *on, scenery *scene)
{
    viewport *view = app_viewport(self->app);
    bool has_changed = false;
    ui_text(on, UI_STYLE_TITLE, "Camera views");
    for (uint32_t i = 0; i < scene->view_count; ++i) {
        char name[32], id[16];
        (void)snprintf(name, sizeof name, "View %u", i + 1);
        (void)snprintf(id, sizeof id, "view%u", i);
        ui_id_begin(on, id);
        ui_width(on, -70.0f);
        if (ui_row(on, name, false) != UI_ROW_NONE && view)
            viewport_go_to(view, &scene->view[i]);
        ui_hint(on, "Move the camera to this view.");
        ui_same_line(on);
        if (ui_button(on, "Remove", UI_QUIET)) {
            scene->view_count -= 1;
            memmove(&scene->view[i], &scene->view[i + 1],
                    (scene->view_count - i) * sizeof scene->view[0]);
            memset(&scene->view[scene->view_count], 0, sizeof scene->view[0]);
            has_changed = true;
        }
        ui_id_end(on);
    }
    ui_disabled_begin(on, scene->view_count == SCENERY_VIEWS || !view);
    if (ui_button(on, "Save view", UI_PLAIN) && view) {
        scene->view[scene->view_count++] = viewport_view(view);
        has_changed = true;
    }
    ui_hint(on, scene->view_count == SCENERY_VIEWS ? "Six views are saved. Remove one first."
                                                   : "Save the current camera view in the show.");
    ui_disabled_end(on);
    return has_changed;
}

/* ---- the panel ---- */

static void draw(panel *self, ui *on, ui_rectangle where)
{
    kept_scenery *kept = app_scenery(self->app);
    scenery scene = *kept_scenery_now(kept);
    bool has_changed = false, is_held = false;
    ui_panel_begin(on, "scene", where, UI_GROUND_PANEL);
    ui_scroll_begin(on, "scroll", 0.0f, 0.0f);
    ui_text(on, UI_STYLE_TITLE, "Look");
    has_changed |= draw_looks(on, &scene);
    ui_space(on, 6.0f);
    ui_text(on, UI_STYLE_TITLE, "Lights");
    has_changed |= draw_pad(self, on, &scene.light);
    for (int i = 0; i < LIGHTING_LAMPS; ++i) {
        has_changed |=
            draw_power(on, lamp_names[i], lamp_hints[i], &scene.light.lamp[i].power, 3.0f);
        is_held |= ui_slider_is_held(on);
    }
    has_changed |= draw_power(on, "Room", "Ambient light. Less light gives harder shadows.",
                              &scene.light.room, 3.0f);
    is_held |= ui_slider_is_held(on) || self->held >= 0;
    ui_space(on, 6.0f);
    has_changed |= draw_wall(on, &scene.light);
    has_changed |= draw_picture(self, on, &scene);
    ui_space(on, 6.0f);
    has_changed |= draw_views(self, on, &scene);
    ui_scroll_end(on);
    ui_panel_end(on);
    if (has_changed)
        kept_scenery_set(kept, &scene);
    self->has_changed |= has_changed;
    if (!self->has_changed || is_held)
        return;
    kept_scenery_keep(kept);
    self->has_changed = false;
}

static void destroy(panel *self)
{
    free(self);
}

static panel *create(app *of)
{
    panel *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->app = of;
    self->held = -1;
    return self;
}

const panel_type panel_scene = {create, destroy, draw, NULL};
