#include "window/panels/engine.h"
#include "window/panels/engine_state.h"
#include "window/gui/theme.h"
#include "window/gui/ui.h"
#include "window/panels/panels.h"

#include "base/isa.h"
#include "base/memory.h"
#include "base/pool.h"
#include "stage/live/live.h"
#include "stage/playback/kept_solver.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- text ---- */

static const double nearly = 0.15;

/* Returns "nothing folds", "nearly folds" or "folds", with its style. */
static const char *engine_fold_words(double min_determinant, ui_style *out_style)
{
    if (!(min_determinant > 0.0)) {
        *out_style = UI_STYLE_BAD;
        return "folds";
    }
    *out_style = min_determinant < nearly ? UI_STYLE_WARNING : UI_STYLE_GOOD;
    return min_determinant < nearly ? "nearly folds" : "nothing folds";
}

void engine_ms(char out[ENGINE_MS], double ms)
{
    int digits = ms < 9.995 ? 2 : ms < 99.95 ? 1 : 0;
    if (ms < 99999.0)
        (void)snprintf(out, ENGINE_MS, "%.*f ms", digits, ms);
    else
        (void)snprintf(out, ENGINE_MS, "minutes");
}

static uint32_t add(engine_counter *out, uint32_t count, uint64_t value, bool is_odd,
                    const char *label, const char *help)
{
    if (value > 0)
        out[count] = (engine_counter){label, help, value, is_odd};
    return count + (value > 0);
}

uint32_t engine_counters(const live_status *status, engine_counter out[ENGINE_COUNTERS_MAX])
{
    const composer_counts *of = &status->counts;
    uint32_t n = 0;
    n = add(out, n, of->bad_pulls, true, "Bad pulls",
            "The mapping returned invalid values. The last valid pull was kept.");
    n = add(out, n, of->held_pulls, true, "Held pulls",
            "The engine could not apply a pull. The shape was kept.");
    n = add(out, n, of->folded_steps, true, "Folded steps",
            "Clay: steps in which the shape folded.");
    n = add(out, n, of->limited_steps, false, "Limited steps",
            "Clay: steps in which the fingertips moved faster than the substeps allow.");
    n = add(out, n, status->isolated.failed, true, "Mapping failed",
            "Times that the process of the mapping crashed, hung or returned invalid values.");
    n = add(out, n, status->isolated.late, true, "Mapping late",
            "Samples for which the face was held because the process of the mapping was late.");
    n = add(out, n, status->reload_refused, true, "Refused versions",
            "New versions of the mapping that could not be loaded. See the log for the reason.");
    n = add(out, n, of->engagements, false, "Engagements",
            "Number of times that a new pull grabbed the face.");
    n = add(out, n, of->commits, false, "Commits",
            "Number of times that the current shape became the new base.");
    n = add(out, n, of->substeps, false, "Substeps",
            "Clay: number of parts into which the steps were divided.");
    return n;
}

/* ---- the time of the last frames ---- */

static const float text_height = 15.0f;

static float height_of(const ui_rectangle *at, double ms, double top_ms)
{
    return at->y + at->height * (1.0f - (float)fmin(fmax(ms / top_ms, 0.0), 1.0));
}

static void draw_level(ui *on, const ui_rectangle *at, double ms, double top_ms, uint32_t colour)
{
    float y = height_of(at, ms, top_ms);
    ui_draw_line(on, at->x, y, at->x + at->width, y, colour, 1.0f);
}

static void draw_frames(ui *on, const ui_rectangle *at, const live_status *status, double top_ms,
                        double period_ms)
{
    float wide = at->width / (float)LIVE_HISTORY;
    uint32_t count = status->frame_count < LIVE_HISTORY ? status->frame_count : LIVE_HISTORY;
    for (uint32_t i = 0; i < count; ++i) {
        double ms = (double)status->frame_ms[i];
        float y = height_of(at, ms, top_ms);
        ui_rectangle bar = {at->x + wide * (float)(LIVE_HISTORY - count + i), y, fmaxf(wide, 0.75f),
                            at->y + at->height - y};
        ui_draw_box(on, bar, ms > period_ms ? THEME_BAD : THEME_GOOD, 0.0f);
    }
}

static void draw_legend(ui *on, const ui_rectangle *at, const live_status *status, double period_ms)
{
    static const char *const label[3] = {"p50", "p99", "of"};
    const double ms[3] = {status->frame_p50_ms, status->frame_p99_ms, period_ms};
    const uint32_t colour[3] = {THEME_TEXT, THEME_ACCENT, THEME_DIM};
    float x = at->x;
    for (int i = 0; i < 3; ++i) {
        char value[ENGINE_MS], words[ENGINE_MS + 8];
        engine_ms(value, ms[i]);
        (void)snprintf(words, sizeof words, "%s %s", label[i], value);
        ui_draw_text(on, x, at->y, UI_STYLE_BODY, colour[i], 0.0f, words);
        x += ui_text_width(on, UI_STYLE_BODY, words) + 14.0f;
    }
}

/* Draws the frame times. The frame period is at 4/5 of the height, unless frames take longer. */
static void engine_plot_draw(ui *on, const live_status *status, double period_ms, float height)
{
    ui_canvas at;
    double top_ms = fmax(1.25 * period_ms, 1.1 * status->frame_p99_ms);
    ui_canvas_begin(on, "frames", 0.0f, height + text_height + 6.0f, &at);
    const ui_rectangle plot = {at.where.x, at.where.y, at.where.width, height};
    const ui_rectangle legend = {at.where.x, at.where.y + height + 4.0f, at.where.width,
                                 text_height};
    ui_draw_box(on, plot, THEME_WELL, 2.0f);
    draw_frames(on, &plot, status, top_ms, period_ms);
    draw_level(on, &plot, period_ms, top_ms, THEME_DIM);
    draw_level(on, &plot, status->frame_p99_ms, top_ms, THEME_ACCENT);
    draw_level(on, &plot, status->frame_p50_ms, top_ms, THEME_TEXT);
    draw_legend(on, &legend, status, period_ms);
    ui_canvas_end(on);
}

/* ---- the panel ---- */

static const float column = 112.0f, p50_right = 212.0f, p99_right = 296.0f;
static const double period_ms = 1000.0 / 60.0;
static const char *const kernels[] = {"Wendland C2", "Wendland C0", "Wendland C4", "Wendland C6"};
static const char *const polynomials[] = {"none (local)", "constant", "linear (as in the paper)",
                                          "windowed"};
static const char *const phase_name[LIVE_PHASES] = {"Map", "Constrain", "Deform", "Publish"};
static const char *const phase_help[LIVE_PHASES] = {
    "Time for hands, mapping and guard.", "Time for bones and control vectors.",
    "Time for vertices, skull and normals.", "Time to hand the face to the window."};

struct panel {
    app *app;
    csrbf_settings wanted; /* of this frame; radius 0: use the radius of the rig */
    double radius_mm;      /* while the slider is dragged */
    bool is_held;
    error trouble; /* why the solver could not be changed; may be "" */
    uint64_t memory;
    double memory_s; /* since the last reading */
};

/* ---- the solver ---- */

static bool set_solver(panel *self, const kept_solver *to)
{
    self->trouble = (error){""};
    return app_set_solver(self->app, to->is_kept ? &to->as : NULL, &self->trouble) >= 0;
}

static kept_solver choice_now(const panel *self)
{
    const csrbf_settings *own = app_solver(self->app);
    return own ? (kept_solver){true, *own} : (kept_solver){.is_kept = false};
}

static mrt_result set(void *owner, const void *value)
{
    (void)set_solver(owner, value); /* shows the error in the panel */
    return MRT_OK;
}

static void choose(panel *self, const csrbf_settings *solver, const char *words)
{
    const kept_solver before = choice_now(self), after = {true, *solver};
    if (!set_solver(self, &after))
        return;
    undo_change made = {.owner = self, .set = set};
    (void)snprintf(made.words, sizeof made.words, "engine: %.120s", words);
    app_add_copied_change(self->app, &made, &before, &after, sizeof after);
}

static void draw_radius(panel *self, ui *on, const live_view *view)
{
    csrbf_settings next = self->wanted;
    char words[64];
    bool is_rigs = !(self->wanted.radius > 0.0);
    if (ui_check(on, "Use the radius of the rig", &is_rigs)) {
        next.radius = is_rigs ? 0.0 : view->solver.radius;
        choose(self, &next, is_rigs ? "radius of the rig" : "custom radius");
    }
    ui_hint(on, "Radius of a pull, unless the mapping sets one.");
    double height = view->about ? (double)(view->about->high.y - view->about->low.y) : 300.0;
    const ui_range range = {.min = 1.0,
                            .max = fmax(height, 2.0),
                            .unit = "mm",
                            .digits = 0,
                            .initial = fmin(fmax(0.25 * height, 1.0), fmax(height, 2.0))};
    if (!self->is_held)
        self->radius_mm = is_rigs ? view->solver.radius : self->wanted.radius;
    ui_disabled_begin(on, is_rigs);
    bool has_changed = ui_slider(on, "Radius", column, &range, &self->radius_mm);
    ui_hint(on, "Distance from a control vector up to which the face moves with it.");
    bool was_held = self->is_held;
    self->is_held = ui_slider_is_held(on);
    ui_disabled_end(on);
    bool is_let_go = was_held && !self->is_held;
    if (is_rigs || self->is_held || !(is_let_go || has_changed))
        return;
    next.radius = self->radius_mm;
    (void)snprintf(words, sizeof words, "radius %.0f mm", next.radius);
    choose(self, &next, words);
}

static void draw_solver(panel *self, ui *on, const live_view *view)
{
    csrbf_settings next = self->wanted;
    uint32_t kernel = (uint32_t)next.kernel, polynomial = (uint32_t)next.polynomial;
    if (ui_choice(on, "Kernel", column, kernels, 4, &kernel)) {
        next.kernel = (csrbf_kernel)kernel;
        choose(self, &next, kernels[kernel]);
    }
    ui_hint(on, "How a pull fades with distance: C0 is pointed, C6 is broad and smooth.");
    next = self->wanted;
    if (ui_choice(on, "Polynomial", column, polynomials, 4, &polynomial)) {
        next.polynomial = (csrbf_polynomial)polynomial;
        choose(self, &next, polynomials[polynomial]);
    }
    ui_hint(on, "Part of the movement that applies to the whole face. Linear also moves the back "
                "of the head.");
    draw_radius(self, on, view);
    if (self->trouble.text[0])
        ui_text_wrapped(on, UI_STYLE_BAD, self->trouble.text);
}

/* ---- meters ---- */

static void draw_meters(ui *on, const live_view *view)
{
    char words[64];
    ui_style style;
    const char *fold = engine_fold_words(view->min_determinant, &style);
    ui_text(on, UI_STYLE_DIM, "Fold meter");
    ui_same_line(on);
    ui_at(on, column);
    ui_text(on, style, fold);
    ui_bar(on, (float)fmin(fmax(view->min_determinant, 0.0), 1.0), 0.0f, 8.0f, style);
    ui_hint(on, "Remaining area of the most compressed skin. At 0 and below, the skin folds.");
    (void)snprintf(words, sizeof words, "%.2f of 1", view->min_determinant);
    ui_fact(on, "Least area", column, UI_STYLE_BODY, words);
    const surface_state *skin = &view->skin;
    (void)snprintf(words, sizeof words, "%.2f times", skin->stretch);
    ui_fact(on, "Stretch", column, UI_STYLE_BODY, words);
    ui_hint(on, "Length of the most stretched edge, relative to the neutral face or to a shape of "
                "the mesh.");
    (void)snprintf(words, sizeof words, "%.0f degrees", skin->bend_deg);
    ui_fact(on, "Bend", column, skin->bent_count > 0 ? UI_STYLE_WARNING : UI_STYLE_BODY, words);
    ui_hint(on, "Angle of the most bent edge, relative to the neutral face.");
    if (skin->inside_out_count > 0) {
        (void)snprintf(words, sizeof words, "%u triangles", skin->inside_out_count);
        ui_fact(on, "Inside out", column, UI_STYLE_BAD, words);
    }
    if (view->meter.held_back_mm > 0.0) {
        (void)snprintf(words, sizeof words, "by %.1f mm", view->meter.held_back_mm);
        ui_fact(on, "Limited", column, UI_STYLE_WARNING, words);
        ui_hint(on, "The pull is reduced where the skin would fold or tear.");
    }
    (void)snprintf(words, sizeof words, "%.2f mm", view->penetration_mm);
    ui_fact(on, "Skin in the skull", column,
            view->penetration_mm > 1.0 ? UI_STYLE_WARNING : UI_STYLE_BODY, words);
    ui_hint(on,
            "Depth of the deepest vertex below the skull surface, before the skin is moved out.");
    if (view->meter.dropped_count > 0) {
        (void)snprintf(words, sizeof words, "%u pull an immobile point", view->meter.dropped_count);
        ui_fact(on, "Controls", column, UI_STYLE_WARNING, words);
    }
}

/* Draws a figure, right-aligned. */
static void draw_figure(ui *on, float right, double ms)
{
    char words[ENGINE_MS] = "\xe2\x80\x94";
    if (ms > 0.0)
        engine_ms(words, ms);
    ui_same_line(on);
    ui_at(on, right - ui_text_width(on, UI_STYLE_NUMBER, words));
    ui_text(on, UI_STYLE_NUMBER, words);
}

static void draw_pair(ui *on, const char *label, double p50_ms, double p99_ms, const char *help)
{
    ui_text(on, UI_STYLE_DIM, label);
    ui_hint(on, help);
    draw_figure(on, p50_right, p50_ms);
    draw_figure(on, p99_right, p99_ms);
}

static void draw_heading(ui *on, float right, const char *words)
{
    ui_at(on, right - ui_text_width(on, UI_STYLE_DIM, words));
    ui_text(on, UI_STYLE_DIM, words);
}

static void draw_times(const panel *self, ui *on, const live_status *status)
{
    const app_figures *figures = &app_notes_of(self->app)->figures;
    engine_plot_draw(on, status, period_ms, 72.0f);
    ui_space(on, 2.0f);
    ui_text(on, UI_STYLE_DIM, "");
    draw_heading(on, p50_right, "p50");
    ui_same_line(on);
    draw_heading(on, p99_right, "p99");
    for (int i = 0; i < LIVE_PHASES; ++i)
        draw_pair(on, phase_name[i], status->phase_p50_ms[i], status->phase_p99_ms[i],
                  phase_help[i]);
    draw_pair(on, "Hand to picture", figures->latency_p50_ms, figures->latency_p99_ms,
              "Time from the measurement of a sample to the display of its face.");
    draw_pair(on, "Window", figures->interval_p50_ms, figures->interval_p99_ms,
              "Time from one drawn frame to the next.");
    draw_pair(on, "Drawing", figures->draw_p50_ms, figures->draw_p99_ms,
              "Time to draw a frame and hand it to the screen.");
    draw_pair(on, "Panels", figures->panels_p50_ms, figures->panels_p99_ms,
              "Time to draw all panels, without the face.");
    ui_text(on, UI_STYLE_DIM, "Sample performed");
    ui_hint(on, "Time from the measurement of a sample to its performance, over the last seconds.");
    draw_figure(on, p99_right, status->lag_p99_ms);
}

static void draw_machine(ui *on)
{
    char words[64];
    const isa used = isa_now();
    (void)snprintf(words, sizeof words, "%s%s", used == ISA_GENERIC ? "" : "x86-64-",
                   isa_name(used));
    ui_fact(on, "Instructions", 148.0f, UI_STYLE_BODY, words);
    ui_hint(on, "Instruction set of the engine: the best of this computer, or MAROTTE_ISA. It does "
                "not change the face.");
    (void)snprintf(words, sizeof words, "%u", pool_threads());
    ui_fact(on, "Threads", 148.0f, UI_STYLE_BODY, words);
    ui_hint(on, "Maximum number of threads for a large task. MAROTTE_THREADS overrides it. It does "
                "not change the face.");
}

static void draw_counters(const panel *self, ui *on, const live_status *status)
{
    engine_counter counter[ENGINE_COUNTERS_MAX];
    char words[64];
    uint32_t count = engine_counters(status, counter);
    (void)snprintf(words, sizeof words, "%llu", (unsigned long long)status->sample_count);
    ui_fact(on, "Samples", 148.0f, UI_STYLE_BODY, words);
    for (uint32_t i = 0; i < count; ++i) {
        (void)snprintf(words, sizeof words, "%llu", (unsigned long long)counter[i].value);
        ui_fact(on, counter[i].label, 148.0f, counter[i].is_odd ? UI_STYLE_WARNING : UI_STYLE_BODY,
                words);
        ui_hint(on, counter[i].help);
    }
    if (status->counts.first_problem.text[0])
        ui_text_wrapped(on, UI_STYLE_DIM, status->counts.first_problem.text);
    draw_machine(on);
    if (self->memory > 0) {
        (void)snprintf(words, sizeof words, "%.0f MB", (double)self->memory / 1e6);
        ui_fact(on, "Memory", 148.0f, UI_STYLE_BODY, words);
        ui_hint(on, "Memory of the whole program.");
    }
}

/* ---- the panel ---- */

static void draw(panel *self, ui *on, ui_rectangle where)
{
    const live_view *view = app_view(self->app);
    const live_status *status = app_status(self->app);
    const kept_solver now = choice_now(self);
    self->wanted = now.is_kept ? now.as : view->solver;
    if (!now.is_kept)
        self->wanted.radius = 0.0;
    ui_panel_begin(on, "engine", where, UI_GROUND_PANEL);
    ui_scroll_begin(on, "scroll", 0.0f, 0.0f);
    if (ui_section(on, "Face", true))
        draw_meters(on, view);
    if (ui_section(on, "Frame time", true))
        draw_times(self, on, status);
    if (ui_section(on, "Counters", true))
        draw_counters(self, on, status);
    if (ui_section(on, "Solver", true))
        draw_solver(self, on, view);
    if (ui_section(on, "State", false))
        engine_state_draw(on, status, view);
    ui_scroll_end(on);
    ui_panel_end(on);
}

static void update(panel *self, double dt_s)
{
    self->memory_s += dt_s;
    if (self->memory > 0 && self->memory_s < 1.0)
        return;
    self->memory = memory_resident();
    self->memory_s = 0.0;
}

static void destroy(panel *self)
{
    if (!self)
        return;
    app_forget_changes(self->app, self);
    free(self);
}

static panel *create(app *of)
{
    panel *self = calloc(1, sizeof *self);
    if (self)
        self->app = of;
    return self;
}

const panel_type panel_engine = {create, destroy, draw, update};
