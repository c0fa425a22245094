/* The output panel: each open output with its state, rate and latency, and a form to add an output.
 */
#include "window/panels/panels.h"

#include "window/gui/theme.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ADDRESS = 200, PLUGINS_MAX = 32 };
#define LABEL  62.0f /* x of the widgets in a row, points */
#define INDENT 18.0f

struct panel {
    app *app;
    const char *name[PLUGINS_MAX]; /* short names of the output plugins */
    const mrt_plugin_type *type[PLUGINS_MAX];
    uint32_t count, chosen;
    char address[ADDRESS], settings[ADDRESS];
};

/* ---- open outputs ---- */

static void describe(char out[256], ui_style *style, const output_status *s)
{
    *style = UI_STYLE_DIM;
    if (s->state == OUTPUT_FAILED) {
        *style = UI_STYLE_BAD;
        (void)snprintf(out, 256, "%s. Retrying.", s->trouble);
    } else if (s->state == OUTPUT_NO_RECEIVER) {
        *style = UI_STYLE_WARNING;
        (void)snprintf(out, 256, "No program answers at this address. The face is still sent.");
    } else if (s->state == OUTPUT_OPENS || s->sent == 0) {
        (void)snprintf(out, 256, "Opening ...");
    } else {
        (void)snprintf(out, 256, "%.0f per second, %.1f ms after the hand%s", s->rate_hz, s->p50_ms,
                       s->is_isolated ? ", in a separate process" : "");
    }
}

static uint32_t light_of(output_state state)
{
    static const uint32_t colours[] = {[OUTPUT_OPENS] = THEME_DIM,
                                       [OUTPUT_SENDS] = THEME_GOOD,
                                       [OUTPUT_NO_RECEIVER] = THEME_WARNING,
                                       [OUTPUT_FAILED] = THEME_BAD};
    return colours[state];
}

/* Returns false if the user closes the output. */
static bool draw_output(panel *self, ui *on, uint32_t index)
{
    output_status s;
    char text[256];
    ui_style style;
    ui_canvas light;
    outputs_status(live_outputs(app_live(self->app)), index, &s);
    ui_canvas_begin(on, "light", 12.0f, ui_row_height(on), &light);
    ui_draw_disc(on, light.where.x + 6.0f, light.where.y + 0.5f * light.where.height, 4.5f,
                 light_of(s.state));
    ui_canvas_end(on);
    ui_same_line(on);
    ui_at(on, INDENT);
    ui_label(on, "text", ui_available_width(on) - 66.0f, THEME_TEXT, s.text);
    ui_hint(on, s.name);
    ui_same_line(on);
    bool is_removed = ui_button(on, "Close", UI_QUIET);
    describe(text, &style, &s);
    ui_text_wrapped(on, style, text);
    return !is_removed;
}

static void draw_outputs(panel *self, ui *on)
{
    const outputs *of = live_outputs(app_live(self->app));
    uint32_t removed = UINT32_MAX;
    for (uint32_t i = 0; i < outputs_count(of); ++i) {
        char id[32];
        (void)snprintf(id, sizeof id, "output %u", i);
        ui_id_begin(on, id);
        if (!draw_output(self, on, i))
            removed = i;
        ui_id_end(on);
        ui_space(on, 2.0f);
        ui_rule(on);
        ui_space(on, 2.0f);
    }
    if (outputs_count(of) == 0)
        ui_text_wrapped(on, UI_STYLE_DIM,
                        "No output is open. Outputs send the face to other programs, live and "
                        "while a take plays.");
    if (removed != UINT32_MAX)
        app_remove_output(self->app, removed);
}

/* Draws the error of the approximation by the 52 ARKit weights. */
static void draw_residual(const panel *self, ui *on)
{
    char text[32];
    outputs *of = live_outputs(app_live(self->app));
    double residual_mm = outputs_residual_mm(of);
    if (outputs_count(of) == 0 || !(residual_mm > 0.0))
        return;
    (void)snprintf(text, sizeof text, "%.2f mm off", residual_mm);
    ui_fact(on, "In ARKit's 52", 110.0f, UI_STYLE_NUMBER, text);
    ui_hint(on, "Distance between the face and its approximation by the ARKit weights.");
}

/* ---- new output ---- */

static void list_plugins(panel *self)
{
    const plugin_list *all = app_plugins(self->app);
    self->count = 0;
    for (uint32_t i = 0; i < all->entry_count && self->count < PLUGINS_MAX; ++i) {
        const mrt_plugin_type *type = all->entry[i].type;
        if (!plugin_interface(type, MRT_FACE_OUTPUT))
            continue;
        self->type[self->count] = type;
        self->name[self->count++] = plugin_short_name(type);
    }
    if (self->chosen >= self->count)
        self->chosen = 0;
}

static void send(panel *self)
{
    char text[3 * ADDRESS];
    (void)snprintf(text, sizeof text, "%s%s%s%s%s", self->type[self->chosen]->id,
                   self->address[0] ? ":" : "", self->address, self->settings[0] ? "," : "",
                   self->settings);
    if (app_add_output(self->app, text) >= 0)
        self->address[0] = self->settings[0] = '\0';
}

static void draw_new(panel *self, ui *on)
{
    list_plugins(self);
    ui_text(on, UI_STYLE_TITLE, "Send the face");
    if (self->count == 0) {
        ui_text_wrapped(on, UI_STYLE_DIM, "No output plugin was found.");
        return;
    }
    (void)ui_choice(on, "Plugin", LABEL, self->name, self->count, &self->chosen);
    ui_hint(on, self->type[self->chosen]->about);
    ui_text(on, UI_STYLE_DIM, "Address");
    ui_same_line(on);
    ui_at(on, LABEL);
    ui_width(on, 0.0f);
    (void)ui_input(on, "##address", "HOST:PORT, or empty for this computer", self->address,
                   sizeof self->address);
    bool is_entered = ui_input_is_entered(on);
    ui_text(on, UI_STYLE_DIM, "Settings");
    ui_same_line(on);
    ui_at(on, LABEL);
    ui_width(on, 0.0f);
    (void)ui_input(on, "##settings", "names=arkit,rate=60", self->settings, sizeof self->settings);
    ui_hint(on, "Set parameters of the plugin. \"marotte plugin list --params\" lists them.");
    is_entered |= ui_input_is_entered(on);
    ui_space(on, 2.0f);
    bool is_full = outputs_count(live_outputs(app_live(self->app))) == OUTPUTS_MAX;
    ui_disabled_begin(on, is_full);
    if (ui_button(on, "Add", UI_ACCENT) || (is_entered && !is_full))
        send(self);
    ui_hint(on, is_full ? "The maximum number of outputs is open. Close one first."
                        : "Send the face to this address, now and at each start of marotte.");
    ui_disabled_end(on);
    if (app_output_trouble(self->app)[0])
        ui_text_wrapped(on, UI_STYLE_BAD, app_output_trouble(self->app));
}

/* ---- the panel ---- */

static void draw(panel *self, ui *on, ui_rectangle where)
{
    ui_panel_begin(on, "output", where, UI_GROUND_PANEL);
    ui_scroll_begin(on, "scroll", 0.0f, 0.0f);
    draw_outputs(self, on);
    draw_residual(self, on);
    ui_space(on, 6.0f);
    draw_new(self, on);
    ui_scroll_end(on);
    ui_panel_end(on);
}

static void destroy(panel *self)
{
    free(self);
}

static panel *create(app *of)
{
    panel *self = calloc(1, sizeof *self);
    if (self)
        self->app = of;
    return self;
}

const panel_type panel_output = {create, destroy, draw, NULL};
