#include "window/desk_state.h"

#include "base/clock.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define EDGE            5.0f /* of a part that is dragged */
#define TIMELINE_LEAST  120.0f
#define DOCK_LEAST      300.0f
#define DOCK_MOST       560.0f
#define FACE_LEAST      160.0f
#define STRIP_LEAST     900.0f /* what the timeline's transport needs */
#define FIGURES_EVERY_S 0.5

static const panel_type *const dock_types[STUDIO_PANELS] = {
    [STUDIO_DEVICES] = &panel_devices, [STUDIO_MAPPING] = &panel_mapping, [STUDIO_RIG] = &panel_rig,
    [STUDIO_ENGINE] = &panel_engine,   [STUDIO_LOG] = &panel_log,
};
static const char *const dock_names[STUDIO_PANELS] = {"Devices", "Mapping", "Rig", "Engine", "Log"};

/* ---- life ---- */

static mrt_result create_parts(desk *self, error *err)
{
    mrt_result result = ui_create(&self->ui, err);
    if (result < 0)
        return result;
    self->viewport = viewport_create(self->studio, err);
    if (!self->viewport)
        return MRT_ERR_UNSUPPORTED;
    studio_set_viewport(self->studio, self->viewport);
    self->timeline = panel_timeline.create(self->studio);
    bool is_whole = self->timeline != NULL;
    for (uint32_t i = 0; i < STUDIO_PANELS; ++i) {
        self->dock[i] = dock_types[i]->create(self->studio);
        is_whole &= self->dock[i] != NULL;
    }
    return is_whole ? MRT_OK : error_set(err, MRT_ERR_MEMORY, "no memory for the panels");
}

mrt_result desk_create(desk **out, studio *of, front *on, error *err)
{
    *out = NULL;
    desk *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the desk");
    self->studio = of;
    self->front = on;
    mrt_result result = create_parts(self, err);
    if (result < 0) {
        desk_destroy(self);
        return result;
    }
    *out = self;
    return MRT_OK;
}

void desk_destroy(desk *self)
{
    if (!self)
        return;
    for (uint32_t i = 0; i < STUDIO_PANELS; ++i)
        if (self->dock[i])
            dock_types[i]->destroy(self->dock[i]);
    if (self->timeline)
        panel_timeline.destroy(self->timeline);
    studio_set_viewport(self->studio, NULL);
    viewport_destroy(self->viewport);
    front_close_output(self->front);
    ui_destroy(self->ui);
    for (uint32_t i = 0; i < DESK_OPENS_KINDS; ++i)
        folder_finish(&self->opening.at[i]);
    free(self);
}

ui *desk_ui(desk *self)
{
    return self->ui;
}

float desk_scale(const desk *self)
{
    return self->screen.scale > 0.0f ? self->screen.scale : 1.0f;
}

/* ---- where things are ---- */

typedef struct desk_places {
    ui_rectangle bar, face, dock, timeline;
    bool has_bar, has_dock, has_timeline;
} desk_places;

static float clamped(float value, float least, float most)
{
    if (most < least)
        most = least;
    return value < least ? least : value > most ? most : value;
}

static desk_places lay_out(const desk *self)
{
    const studio_looks *looks = studio_looks_of(self->studio);
    const float width = self->screen.width, height = self->screen.height;
    desk_places out = {.face = {0.0f, 0.0f, width, height}};
    if (looks->is_face_only)
        return out;
    const float bar = THEME_BAR_HEIGHT, below = height - bar;
    const float dock =
        clamped(looks->dock_width, DOCK_LEAST, clamped(0.45f * width, 0.0f, DOCK_MOST));
    const float timeline = looks->has_timeline
                               ? clamped(looks->timeline_height, TIMELINE_LEAST, below - FACE_LEAST)
                               : 0.0f;
    out.has_bar = out.has_dock = true;
    out.has_timeline = looks->has_timeline;
    out.bar = (ui_rectangle){0.0f, 0.0f, width, bar};
    /* The dock is as high as the window; in a narrow one the timeline goes below it. */
    const bool is_narrow = width - dock < STRIP_LEAST;
    out.dock = (ui_rectangle){width - dock, bar, dock, is_narrow ? below - timeline : below};
    out.face = (ui_rectangle){0.0f, bar, width - dock, below - timeline};
    out.timeline =
        (ui_rectangle){0.0f, height - timeline, is_narrow ? width : width - dock, timeline};
    return out;
}

/* The edge between two parts: returns how far it was dragged. */
static float drag_edge(desk *self, const char *id, ui_rectangle where, ui_cursor cursor)
{
    ui_canvas canvas;
    const bool is_upright = where.height > where.width;
    ui_panel_begin(self->ui, id, where, UI_GROUND_NONE);
    ui_canvas_begin(self->ui, "edge", 0.0f, 0.0f, &canvas);
    if (canvas.is_hovered || canvas.is_dragging) {
        ui_set_cursor(self->ui, cursor);
        ui_draw_box(self->ui, where, canvas.is_dragging ? THEME_ACCENT : THEME_RULE, 0.0f);
    }
    ui_canvas_end(self->ui);
    ui_panel_end(self->ui);
    if (!canvas.is_dragging && !canvas.is_released)
        return 0.0f;
    return is_upright ? canvas.moved_x : canvas.moved_y;
}

static void draw_edges(desk *self, const desk_places *at)
{
    studio_looks *looks = studio_looks_of(self->studio);
    if (at->has_timeline) {
        const ui_rectangle line = {0.0f, at->timeline.y - 0.5f * EDGE, at->timeline.width, EDGE};
        const float moved = drag_edge(self, "edge_timeline", line, UI_CURSOR_DOWN);
        if (moved != 0.0f)
            looks->timeline_height = at->timeline.height - moved;
    }
    if (at->has_dock) {
        const ui_rectangle line = {at->dock.x - 0.5f * EDGE, at->dock.y, EDGE, at->dock.height};
        const float moved = drag_edge(self, "edge_dock", line, UI_CURSOR_ACROSS);
        if (moved != 0.0f)
            looks->dock_width = clamped(at->dock.width - moved, DOCK_LEAST, DOCK_MOST);
    }
}

/* ---- parts ---- */

static void draw_dock(desk *self, ui_rectangle where)
{
    const float tabs = 38.0f;
    studio_looks *looks = studio_looks_of(self->studio);
    uint32_t chosen = (uint32_t)looks->panel;
    const ui_rectangle head = {where.x, where.y, where.width, tabs};
    ui_panel_begin(self->ui, "dock", head, UI_GROUND_PANEL);
    if (ui_tabs(self->ui, "tabs", dock_names, STUDIO_PANELS, &chosen))
        looks->panel = (studio_panel)chosen;
    ui_draw_box(self->ui, (ui_rectangle){where.x, where.y + tabs - 1.0f, where.width, 1.0f},
                THEME_RULE, 0.0f);
    ui_panel_end(self->ui);
    const ui_rectangle rest = {where.x, where.y + tabs, where.width, where.height - tabs};
    dock_types[looks->panel]->draw(self->dock[looks->panel], self->ui, rest);
}

static void draw_rule(desk *self, const char *id, ui_rectangle where)
{
    ui_panel_begin(self->ui, id, where, UI_GROUND_NONE);
    ui_draw_box(self->ui, where, THEME_RULE, 0.0f);
    ui_panel_end(self->ui);
}

static void draw_panels(desk *self, const desk_places *at)
{
    if (at->has_timeline) {
        panel_timeline.draw(self->timeline, self->ui, at->timeline);
        draw_rule(self, "rule_timeline",
                  (ui_rectangle){0.0f, at->timeline.y, at->timeline.width, 1.0f});
    }
    if (at->has_dock) {
        draw_dock(self, at->dock);
        draw_rule(self, "rule_dock", (ui_rectangle){at->dock.x, at->dock.y, 1.0f, at->dock.height});
    }
    if (at->has_bar)
        bar_draw(self, at->bar);
    else
        bar_draw_alone(self, at->face);
    draw_edges(self, at);
    desk_draw_news(self, at->face);
    if (studio_looks_of(self->studio)->is_helping)
        help_draw(self, (ui_rectangle){0.0f, 0.0f, self->screen.width, self->screen.height});
    desk_open_draw(self);
    desk_export_draw(self);
    desk_leave_draw(self);
}

static void update_panels(desk *self, double dt_s)
{
    for (uint32_t i = 0; i < STUDIO_PANELS; ++i)
        if (dock_types[i]->update)
            dock_types[i]->update(self->dock[i], dt_s);
    if (panel_timeline.update)
        panel_timeline.update(self->timeline, dt_s);
}

static void hear_wishes(desk *self)
{
    if (studio_asked(self->studio, ACTION_OPEN))
        desk_open_ask(self, self->opening.kind);
    if (studio_asked(self->studio, ACTION_EXPORT))
        desk_export_ask(self);
    if (studio_wants_to_quit(self->studio))
        desk_quit(self);
}

/* ---- the second window ---- */

static void show_output(desk *self)
{
    studio_looks *looks = studio_looks_of(self->studio);
    uint32_t width = 0, height = 0;
    error err = {0};
    if (!looks->has_output) {
        front_close_output(self->front);
        return;
    }
    if (!front_has_output(self->front) && front_open_output(self->front, &err) < 0) {
        news_list_add(studio_news(self->studio), MRT_LOG_ERROR, "output", err.text);
        looks->has_output = false;
        return;
    }
    front_output_size(self->front, &width, &height);
    const uint32_t texture = width && height ? viewport_output(self->viewport, width, height) : 0;
    if (texture)
        front_show_output(self->front, texture, looks->is_output_mirrored);
    looks->has_output = front_has_output(self->front); /* the person may have closed it */
}

/* ---- figures ---- */

static double ms_between(int64_t from_ns, int64_t to_ns)
{
    return 1e-6 * (double)(to_ns - from_ns);
}

static int64_t cpu_now_ns(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (int64_t)now.tv_sec * NS_PER_S + now.tv_nsec;
}

/* Since the program was started, as the system knows it. */
static double running_s(void)
{
    char text[1024];
    unsigned long long ticks = 0;
    struct timespec now;
    FILE *file = fopen("/proc/self/stat", "r");
    const size_t length = file ? fread(text, 1, sizeof text - 1, file) : 0;
    if (file)
        (void)fclose(file);
    text[length] = '\0';
    const char *at = strrchr(text, ')'); /* the name may have blanks; "starttime" is field 22 */
    for (int field = 2; at && field < 22; ++field)
        at = strchr(at + 1, ' ');
    if (!at || clock_gettime(CLOCK_BOOTTIME, &now) != 0)
        return 0.0;
    ticks = strtoull(at, NULL, 10);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec -
           (double)ticks / (double)sysconf(_SC_CLK_TCK);
}

static void note_face(desk *self)
{
    const live_view *view = studio_view(self->studio);
    if (view->number == 0 || view->number == self->face_shown)
        return;
    if (self->face_shown == 0)
        self->first_face_s = running_s();
    else if (view->sample_ns > 0 && view->mode != LIVE_SHOWS)
        figures_add(&self->latency_ms, ms_between(view->sample_ns, clock_now_ns()));
    self->face_shown = view->number;
}

/* "night, puppet \u2022" */
static void tell_title(desk *self)
{
    char title[600];
    show *s = studio_show(self->studio);
    const char *show_name = s ? strrchr(show_path(s), '/') : NULL;
    const char *face_name = strrchr(studio_face_path(self->studio), '/');
    (void)snprintf(title, sizeof title, "%.200s, %.200s%s - marotte",
                   show_name ? show_name + 1 : "no show", face_name ? face_name + 1 : "a face",
                   studio_unsaved_now(self->studio) ? " \xe2\x80\xa2" : "");
    if (strcmp(title, self->title) == 0)
        return;
    (void)snprintf(self->title, sizeof self->title, "%s", title);
    front_set_title(self->front, title);
}

static void keep_size(const desk *self)
{
    settings *kept = studio_settings(self->studio);
    settings_set_number(kept, "window.width", floor((double)self->screen.width));
    settings_set_number(kept, "window.height", floor((double)self->screen.height));
}

static void look_at_figures(const desk *self, studio_figures *out)
{
    figures_look(&self->panels_ms, &out->panels_p50_ms, &out->panels_p99_ms);
    figures_look(&self->interval_ms, &out->interval_p50_ms, &out->interval_p99_ms);
    figures_look(&self->draw_ms, &out->draw_p50_ms, &out->draw_p99_ms);
    figures_look(&self->latency_ms, &out->latency_p50_ms, &out->latency_p99_ms);
}

static void tell_figures(desk *self)
{
    studio_figures out;
    self->figures_wait_s -= self->screen.dt_s;
    if (self->figures_wait_s > 0.0)
        return;
    self->figures_wait_s = FIGURES_EVERY_S;
    look_at_figures(self, &out);
    studio_note_figures(self->studio, &out);
    tell_title(self);
    keep_size(self);
}

void desk_counted(const desk *self, desk_counts *out)
{
    *out = (desk_counts){.frame_count = self->frame_count, .first_face_s = self->first_face_s};
    look_at_figures(self, &out->fast);
}

/* ---- a frame ---- */

static void draw(desk *self)
{
    const desk_places at = lay_out(self);
    const int64_t began_ns = cpu_now_ns();
    update_panels(self, self->screen.dt_s);
    const int64_t updated_ns = cpu_now_ns();
    viewport_draw(self->viewport, self->ui, at.face, self->screen.scale);
    const int64_t face_ns = cpu_now_ns();
    draw_panels(self, &at);
    if (self->frame_count > 1)
        figures_add(&self->panels_ms,
                    ms_between(began_ns, updated_ns) + ms_between(face_ns, cpu_now_ns()));
}

bool desk_frame(desk *self)
{
    front_gamepad pad;
    if (!front_begin(self->front, self->ui, &self->screen))
        studio_do(self->studio, ACTION_QUIT);
    const int64_t began_ns = clock_now_ns();
    ui_begin(self->ui, &self->screen);
    studio_update(self->studio, self->screen.dt_s);
    desk_dispatch_keys(self);
    hear_wishes(self);
    desk_update_news(self, self->screen.dt_s);
    const bool has_pad = front_read_gamepad(self->front, &pad);
    viewport_update(self->viewport, self->ui, has_pad ? &pad : NULL, self->screen.dt_s);
    draw(self);
    ui_end(self->ui);
    note_face(self);
    if (self->frame_count > 1) { /* the first ones make what all use */
        figures_add(&self->draw_ms, ms_between(began_ns, clock_now_ns()));
        figures_add(&self->interval_ms, ms_between(self->began_ns, began_ns));
    }
    self->began_ns = began_ns;
    front_end(self->front, self->ui);
    show_output(self);
    tell_figures(self);
    self->frame_count += 1;
    return !self->is_over;
}
