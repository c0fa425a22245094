/* The engine panel: how the face is solved, how near it is to a fold, and what time it takes. */
#include "base/isa.h"
#include "base/memory.h"
#include "base/pool.h"
#include "window/engine_panel_plot.h"
#include "window/engine_panel_words.h"
#include "window/panels.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const float column = 112.0f, p50_right = 212.0f, p99_right = 296.0f;
static const double period_ms = 1000.0 / 60.0;
static const char *const kernels[] = {"Wendland C2", "Wendland C0", "Wendland C4", "Wendland C6"};
static const char *const polynomials[] = {"none: local", "constant", "linear: the paper's",
                                          "windowed"};
static const char *const step_name[LIVE_STEPS] = {"Map", "Constrain", "Deform", "Publish"};
static const char *const step_help[LIVE_STEPS] = {
    "Hands, mapping, guard.", "Bones and control vectors.", "Every vertex, skull, normals.",
    "The face is handed to the window."};

typedef struct solver_choice {
    bool is_own; /* false: all of it is the rig's */
    csrbf_settings as;
} solver_choice;

typedef struct solver_step {
    solver_choice side[2]; /* before, after */
} solver_step;

struct panel {
    studio *studio;
    csrbf_settings wanted; /* of this frame; radius 0: the rig's */
    double radius_mm;      /* while it is dragged */
    bool is_held;
    char trouble[1024];
    solver_step *steps;
    uint32_t step_count;
    uint64_t memory;
    double memory_s; /* since it was read */
};

/* ---- the solver ---- */

static bool set_solver(panel *self, const solver_choice *to)
{
    error err = {""};
    self->trouble[0] = '\0';
    if (studio_set_solver(self->studio, to->is_own ? &to->as : NULL, &err) >= 0)
        return true;
    (void)snprintf(self->trouble, sizeof self->trouble, "%s", err.text);
    return false;
}

static solver_choice choice_now(const panel *self)
{
    const csrbf_settings *own = studio_solver(self->studio);
    return own ? (solver_choice){true, *own} : (solver_choice){.is_own = false};
}

static void go_to(panel *self, uint64_t number, int side)
{
    if (number < self->step_count)
        (void)set_solver(self, &self->steps[number].side[side]);
}

static void undo(void *owner, uint64_t number)
{
    go_to(owner, number, 0);
}

static void redo(void *owner, uint64_t number)
{
    go_to(owner, number, 1);
}

/* Without memory it is done, but cannot be undone. */
static void choose(panel *self, const csrbf_settings *solver, const char *words)
{
    const solver_choice before = choice_now(self), after = {true, *solver};
    if (!set_solver(self, &after))
        return;
    solver_step *grown = realloc(self->steps, (self->step_count + 1) * sizeof *grown);
    if (!grown)
        return;
    self->steps = grown;
    self->steps[self->step_count] = (solver_step){{before, after}};
    studio_step step = {.owner = self, .undo = undo, .redo = redo, .number = self->step_count};
    (void)snprintf(step.words, sizeof step.words, "engine: %.120s", words);
    self->step_count += 1;
    studio_did(self->studio, &step);
}

static void draw_radius(panel *self, ui *on, const live_view *view)
{
    csrbf_settings next = self->wanted;
    char words[64];
    bool is_rigs = !(self->wanted.radius > 0.0);
    if (ui_check(on, "Radius as the rig says", &is_rigs)) {
        next.radius = is_rigs ? 0.0 : view->solver.radius;
        choose(self, &next, is_rigs ? "radius as the rig says" : "a radius of its own");
    }
    ui_hint(on, "How far a pull is felt, where the mapping does not say.");
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
    ui_hint(on, "How a pull fades with the distance: C0 pointed, C6 broad and smooth.");
    next = self->wanted;
    if (ui_choice(on, "Polynomial", column, polynomials, 4, &polynomial)) {
        next.polynomial = (csrbf_polynomial)polynomial;
        choose(self, &next, polynomials[polynomial]);
    }
    ui_hint(on, "What moves the whole face beside the local pulls. Linear, as in the paper, moves "
                "the back of the head too.");
    draw_radius(self, on, view);
    if (self->trouble[0])
        ui_text_wrapped(on, UI_STYLE_BAD, self->trouble);
}

/* ---- how it does ---- */

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
    ui_hint(on, "The skin that is squeezed most: what is left of its area. 0 and below: it folds.");
    (void)snprintf(words, sizeof words, "%.2f of 1", view->min_determinant);
    ui_fact(on, "Least area", column, UI_STYLE_BODY, words);
    const surface_state *skin = &view->skin;
    (void)snprintf(words, sizeof words, "%.2f times", skin->stretch);
    ui_fact(on, "Stretch", column, UI_STYLE_BODY, words);
    ui_hint(on, "The edge that is stretched most: its length over that at rest.");
    (void)snprintf(words, sizeof words, "%.0f degrees", skin->bend_deg);
    ui_fact(on, "Bend", column, skin->bent_count > 0 ? UI_STYLE_WARNING : UI_STYLE_BODY, words);
    ui_hint(on, "The edge that is bent most, beyond what it is at rest.");
    if (skin->inside_out_count > 0) {
        (void)snprintf(words, sizeof words, "%u triangles", skin->inside_out_count);
        ui_fact(on, "Inside out", column, UI_STYLE_BAD, words);
    }
    if (view->meter.held_back_mm > 0.0) {
        (void)snprintf(words, sizeof words, "by %.1f mm", view->meter.held_back_mm);
        ui_fact(on, "Held back", column, UI_STYLE_WARNING, words);
        ui_hint(on, "Where the skin would fold or tear it is given less than the hand asks for.");
    }
    (void)snprintf(words, sizeof words, "%.2f mm", view->penetration_mm);
    ui_fact(on, "Skin in the skull", column,
            view->penetration_mm > 1.0 ? UI_STYLE_WARNING : UI_STYLE_BODY, words);
    ui_hint(on, "How deep the deepest vertex lies beneath the skull's surface.");
    if (view->meter.dropped_count > 0) {
        (void)snprintf(words, sizeof words, "%u pull at what cannot move",
                       view->meter.dropped_count);
        ui_fact(on, "Controls", column, UI_STYLE_WARNING, words);
    }
}

/* Figures end at the same place. */
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
    const studio_figures *figures = studio_figures_of(self->studio);
    engine_plot_draw(on, status, period_ms, 72.0f);
    ui_space(on, 2.0f);
    ui_text(on, UI_STYLE_DIM, "");
    draw_heading(on, p50_right, "p50");
    ui_same_line(on);
    draw_heading(on, p99_right, "p99");
    for (int i = 0; i < LIVE_STEPS; ++i)
        draw_pair(on, step_name[i], status->step_p50_ms[i], status->step_p99_ms[i], step_help[i]);
    draw_pair(on, "Hand to picture", figures->latency_p50_ms, figures->latency_p99_ms,
              "From a sample measured to its face handed to the screen.");
    draw_pair(on, "Window", figures->interval_p50_ms, figures->interval_p99_ms,
              "From one drawn frame to the next.");
    draw_pair(on, "Drawing", figures->draw_p50_ms, figures->draw_p99_ms,
              "A drawn frame, until it is handed to the screen.");
    draw_pair(on, "Panels", figures->panels_p50_ms, figures->panels_p99_ms,
              "All panels of a drawn frame, without the face.");
    ui_text(on, UI_STYLE_DIM, "Sample performed");
    ui_hint(on, "From a sample measured to performed, over the last seconds.");
    draw_figure(on, p99_right, status->lag_p99_ms);
}

static void draw_machine(ui *on)
{
    char words[64];
    const isa used = isa_now();
    (void)snprintf(words, sizeof words, "%s%s", used == ISA_GENERIC ? "" : "x86-64-",
                   isa_name(used));
    ui_fact(on, "Instructions", 148.0f, UI_STYLE_BODY, words);
    ui_hint(on,
            "What the engine's loops are compiled for: the best that this computer has, or what "
            "MAROTTE_ISA names. Faces are the same with each.");
    (void)snprintf(words, sizeof words, "%u", pool_threads());
    ui_fact(on, "Threads", 148.0f, UI_STYLE_BODY, words);
    ui_hint(on, "At most so many share a large piece of work; MAROTTE_THREADS says another number. "
                "Faces are the same with each.");
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
        ui_hint(on, "Of the whole program.");
    }
}

/* ---- the panel ---- */

static void draw(panel *self, ui *on, ui_rectangle where)
{
    const live_view *view = studio_view(self->studio);
    const live_status *status = studio_status(self->studio);
    const solver_choice now = choice_now(self);
    self->wanted = now.is_own ? now.as : view->solver;
    if (!now.is_own)
        self->wanted.radius = 0.0;
    ui_panel_begin(on, "engine", where, UI_GROUND_PANEL);
    ui_scroll_begin(on, "scroll", 0.0f, 0.0f);
    if (ui_section(on, "Face", true))
        draw_meters(on, view);
    if (ui_section(on, "Time of a frame", true))
        draw_times(self, on, status);
    if (ui_section(on, "Counters", true))
        draw_counters(self, on, status);
    if (ui_section(on, "Solver", true))
        draw_solver(self, on, view);
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
    studio_forget_steps(self->studio, self);
    free(self->steps);
    free(self);
}

static panel *create(studio *of)
{
    panel *self = calloc(1, sizeof *self);
    if (self)
        self->studio = of;
    return self;
}

const panel_type panel_engine = {create, destroy, draw, update};
