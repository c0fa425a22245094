#include "window/docks.h"

#include "window/gui/theme.h"

#include <stdio.h>
#include <stdlib.h>

#define EDGE          5.0f  /* of a part that is dragged */
#define HEAD          30.0f /* of a panel that floats */
#define SIDE          40.0f /* of the window: a panel that is dropped there docks */
#define GRIP          14.0f /* the corner that resizes */
#define SWITCH_HEIGHT 30.0f

static const panel_type *const types[APP_PANELS] = {
    [APP_DEVICES] = &panel_devices, [APP_MAPPING] = &panel_mapping, [APP_RIG] = &panel_rig,
    [APP_ENGINE] = &panel_engine,   [APP_LOG] = &panel_log,         [APP_PATCH] = &panel_patch,
    [APP_OUTPUT] = &panel_output,   [APP_SCENE] = &panel_scene,     [APP_HAND] = &panel_hand,
    [APP_POSES] = &panel_poses,
};

typedef struct placed_tab {
    app_panel panel;
    panel_place place;
    ui_rectangle where;
} placed_tab;

struct docks {
    app *app;
    panel *panel[APP_PANELS], *timeline;
    placed_tab tab[APP_PANELS]; /* of this frame */
    uint32_t tab_count;
    app_panel dragged; /* by its tab or its head; APP_PANELS: none */
    float x, y;        /* of the pointer that drags */
    bool is_dropped;
};

/* ---- life ---- */

docks *docks_create(app *of)
{
    docks *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->app = of;
    self->timeline = panel_timeline.create(of);
    bool is_whole = self->timeline != NULL;
    for (uint32_t i = 0; i < APP_PANELS; ++i) {
        self->panel[i] = types[i]->create(of);
        is_whole &= self->panel[i] != NULL;
    }
    if (is_whole)
        return self;
    docks_destroy(self);
    return NULL;
}

void docks_destroy(docks *self)
{
    if (!self)
        return;
    for (uint32_t i = 0; i < APP_PANELS; ++i)
        if (self->panel[i])
            types[i]->destroy(self->panel[i]);
    if (self->timeline)
        panel_timeline.destroy(self->timeline);
    free(self);
}

panel *docks_panel(docks *self, app_panel of)
{
    return self->panel[of];
}

void docks_update(docks *self, double dt_s)
{
    for (uint32_t i = 0; i < APP_PANELS; ++i)
        if (types[i]->update)
            types[i]->update(self->panel[i], dt_s);
    if (panel_timeline.update)
        panel_timeline.update(self->timeline, dt_s);
}

/* ---- parts ---- */

static arrangement *now(const docks *self)
{
    return &app_looks_of(self->app)->layouts.now;
}

static const char *title_of(app_panel of)
{
    return action_of((action)(ACTION_PANEL_DEVICES + (int)of))->title;
}

static void draw_box(ui *on, const char *id, ui_rectangle where, uint32_t colour)
{
    ui_panel_begin(on, id, where, UI_GROUND_NONE);
    ui_draw_box(on, where, colour, 0.0f);
    ui_panel_end(on);
}

static void menu_actions(docks *self, ui *on, const action *list, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        char keys[KEY_WORDS];
        key_map_words(&app_looks_of(self->app)->keys, list[i], keys);
        if (ui_menu_item(on, action_of(list[i])->title, keys, app_can(self->app, list[i], NULL)))
            app_do(self->app, list[i]);
    }
}

/* The menu of the last widget, which stands for the panel. */
static void draw_menu(docks *self, ui *on, app_panel of)
{
    static const action list[] = {ACTION_PANEL_LEFT, ACTION_PANEL_RIGHT, ACTION_PANEL_FLOAT,
                                  ACTION_PANEL_HIDE};
    char id[24];
    (void)snprintf(id, sizeof id, "place_%u", (unsigned)of);
    if (!ui_menu_begin(on, id))
        return;
    if (now(self)->current != of)
        arrangement_show(now(self), of); /* the actions are about the panel that was shown last */
    menu_actions(self, on, list, sizeof list / sizeof list[0]);
    ui_menu_end(on);
}

static void follow_drag(docks *self, ui *on, app_panel of)
{
    const ui_drag last = ui_last_drag(on);
    if (last.state == UI_DRAG_NONE)
        return;
    self->dragged = of;
    self->x = last.x;
    self->y = last.y;
    self->is_dropped = last.state == UI_DRAG_DROPPED;
}

/* ---- a dock ---- */

typedef struct tabs_of_dock {
    docks *docks;
    ui *on;
    const arrangement_dock *dock;
} tabs_of_dock;

static void follow_tab(void *data, uint32_t index)
{
    tabs_of_dock *tabs = data;
    docks *self = tabs->docks;
    const app_panel of = tabs->dock->panel[index];
    self->tab[self->tab_count++] =
        (placed_tab){of, now(self)->panel[of].place, ui_last_drag(tabs->on).where};
    draw_menu(self, tabs->on, of);
    follow_drag(self, tabs->on, of);
}

static void draw_dock(docks *self, ui *on, const char *id, const arrangement_dock *dock)
{
    const char *names[APP_PANELS];
    const ui_rectangle where = dock->where;
    uint32_t chosen = 0;
    for (uint32_t i = 0; i < dock->count; ++i) {
        names[i] = title_of(dock->panel[i]);
        if (dock->panel[i] == dock->front)
            chosen = i;
    }
    const float tabs =
        THEME_PADDING + ui_tabs_height(on, names, dock->count, where.width - 2.0f * THEME_PADDING);
    const ui_rectangle head = {where.x, where.y, where.width, tabs};
    tabs_of_dock all = {self, on, dock};
    ui_panel_begin(on, id, head, UI_GROUND_PANEL);
    if (ui_tabs_each(on, "tabs", names, dock->count, &chosen, follow_tab, &all))
        arrangement_show(now(self), dock->panel[chosen]);
    ui_draw_box(on, (ui_rectangle){where.x, where.y + tabs - 1.0f, where.width, 1.0f}, THEME_RULE,
                0.0f);
    ui_panel_end(on);
    const app_panel shown = dock->panel[chosen];
    types[shown]->draw(self->panel[shown], on,
                       (ui_rectangle){where.x, where.y + tabs, where.width, where.height - tabs});
}

void docks_draw(docks *self, ui *on, const arrangement_rectangles *at)
{
    self->tab_count = 0;
    self->dragged = APP_PANELS;
    if (at->timeline.width > 0.0f) {
        draw_box(on, "ground_timeline", at->timeline, THEME_STAGE); /* between its parts */
        panel_timeline.draw(self->timeline, on, at->timeline);
        draw_box(on, "rule_timeline",
                 (ui_rectangle){at->timeline.x, at->timeline.y, at->timeline.width, 1.0f},
                 THEME_RULE);
    }
    if (at->left.where.width > 0.0f) {
        const ui_rectangle *dock = &at->left.where;
        draw_dock(self, on, "dock_left", &at->left);
        draw_box(on, "rule_left",
                 (ui_rectangle){dock->x + dock->width - 1.0f, dock->y, 1.0f, dock->height},
                 THEME_RULE);
    }
    if (at->right.where.width > 0.0f) {
        const ui_rectangle *dock = &at->right.where;
        draw_dock(self, on, "dock", &at->right);
        draw_box(on, "rule_dock", (ui_rectangle){dock->x, dock->y, 1.0f, dock->height}, THEME_RULE);
    }
}

/* ---- the edges between the parts ---- */

static void drag_dock_edge(docks *self, ui *on, const char *id, ui_rectangle dock, float x,
                           panel_place place)
{
    const ui_rectangle line = {x - 0.5f * EDGE, dock.y, EDGE, dock.height};
    const float moved = ui_drag_edge(on, id, line, UI_CURSOR_ACROSS);
    if (dock.width > 0.0f && moved != 0.0f)
        now(self)->width[place] =
            arrangement_dock_width(dock.width + (place == PLACE_LEFT ? moved : -moved));
}

static void draw_edges(docks *self, ui *on, const arrangement_rectangles *at)
{
    if (at->timeline.width > 0.0f) {
        const ui_rectangle line = {at->timeline.x, at->timeline.y - 0.5f * EDGE, at->timeline.width,
                                   EDGE};
        const float moved = ui_drag_edge(on, "edge_timeline", line, UI_CURSOR_DOWN);
        if (moved != 0.0f)
            now(self)->timeline_height = at->timeline.height - moved;
    }
    if (at->right.where.width > 0.0f)
        drag_dock_edge(self, on, "edge_dock", at->right.where, at->right.where.x, PLACE_RIGHT);
    if (at->left.where.width > 0.0f)
        drag_dock_edge(self, on, "edge_left", at->left.where,
                       at->left.where.x + at->left.where.width, PLACE_LEFT);
}

/* ---- panels that float ---- */

static void draw_grip(docks *self, ui *on, app_panel of, ui_rectangle where)
{
    char id[24];
    ui_canvas canvas;
    const float right = where.x + where.width, low = where.y + where.height;
    (void)snprintf(id, sizeof id, "grip_%u", (unsigned)of);
    ui_panel_begin(on, id, (ui_rectangle){right - GRIP, low - GRIP, GRIP, GRIP}, UI_GROUND_NONE);
    ui_canvas_begin(on, "grip", 0.0f, 0.0f, &canvas);
    for (float inset = 4.0f; inset < GRIP - 2.0f; inset += 4.0f)
        ui_draw_line(on, right - inset - 2.0f, low - 3.0f, right - 3.0f, low - inset - 2.0f,
                     canvas.is_hovered ? THEME_TEXT : THEME_DIM, 1.0f);
    if (canvas.is_hovered || canvas.is_dragging)
        ui_set_cursor(on, UI_CURSOR_MOVE);
    if (canvas.is_dragging || canvas.is_released)
        now(self)->panel[of].floated = (ui_rectangle){
            where.x, where.y, where.width + canvas.moved_x, where.height + canvas.moved_y};
    ui_canvas_end(on);
    ui_panel_end(on);
}

static void draw_head(docks *self, ui *on, app_panel of, ui_rectangle where)
{
    char id[24];
    ui_canvas canvas;
    const ui_rectangle head = {where.x, where.y, where.width, HEAD};
    const float x = head.x + head.width - 16.0f, y = head.y + 0.5f * HEAD;
    const ui_rectangle cross = {x - 11.0f, y - 11.0f, 22.0f, 22.0f};
    (void)snprintf(id, sizeof id, "head_%u", (unsigned)of);
    ui_panel_begin(on, id, head, UI_GROUND_NONE);
    ui_canvas_begin(on, "head", 0.0f, 0.0f, &canvas);
    const bool is_on_cross = ui_canvas_is_over(&canvas, cross);
    ui_draw_box(on, head, THEME_BAR, 0.0f);
    if (is_on_cross)
        ui_draw_box(on, cross, THEME_HOVER, 4.0f);
    ui_draw_text(on, head.x + THEME_PADDING, y - 0.5f * ui_text_height(on, UI_STYLE_STRONG),
                 UI_STYLE_STRONG, THEME_TEXT, head.width - 48.0f, title_of(of));
    ui_draw_line(on, x - 4.0f, y - 4.0f, x + 4.0f, y + 4.0f, THEME_DIM, 1.5f);
    ui_draw_line(on, x - 4.0f, y + 4.0f, x + 4.0f, y - 4.0f, THEME_DIM, 1.5f);
    if (canvas.is_pressed && canvas.button == 0 && is_on_cross)
        arrangement_move(now(self), of, PLACE_HIDDEN, APP_PANELS);
    else if (canvas.is_double_clicked)
        arrangement_move(now(self), of, PLACE_RIGHT, APP_PANELS);
    else if (canvas.is_pressed)
        arrangement_show(now(self), of);
    if ((canvas.is_dragging || canvas.is_released) && canvas.button == 0 &&
        now(self)->panel[of].place == PLACE_FLOATING) {
        now(self)->panel[of].floated = (ui_rectangle){
            where.x + canvas.moved_x, where.y + canvas.moved_y, where.width, where.height};
        self->dragged = of;
        self->x = canvas.where.x + canvas.x;
        self->y = canvas.where.y + canvas.y;
        self->is_dropped = canvas.is_released;
    }
    ui_canvas_end(on);
    ui_hint(on, is_on_cross ? "Hide the panel. Its key shows it again."
                            : "Drag to move, to the side of the window to dock. Right-click for "
                              "more.");
    draw_menu(self, on, of);
    ui_panel_end(on);
}

static void draw_floating(docks *self, ui *on, app_panel of, ui_rectangle where)
{
    char id[24];
    const ui_rectangle rim = {where.x - 1.0f, where.y - 1.0f, where.width + 2.0f,
                              where.height + 2.0f};
    (void)snprintf(id, sizeof id, "rim_%u", (unsigned)of);
    draw_box(on, id, rim, THEME_RULE);
    draw_head(self, on, of, where);
    types[of]->draw(self->panel[of], on,
                    (ui_rectangle){where.x, where.y + HEAD, where.width, where.height - HEAD});
    draw_grip(self, on, of, where);
}

/* ---- a panel that is dragged ---- */

static const placed_tab *tab_under(const docks *self)
{
    for (uint32_t i = 0; i < self->tab_count; ++i)
        if (ui_rectangle_has(self->tab[i].where, self->x, self->y))
            return &self->tab[i];
    return NULL;
}

static bool is_over_dock(const docks *self, ui_rectangle dock)
{
    return dock.width > 0.0f && ui_rectangle_has(dock, self->x, self->y);
}

static panel_place place_under(const docks *self, const arrangement_rectangles *at)
{
    const placed_tab *tab = tab_under(self);
    if (tab)
        return tab->place;
    if (self->x < SIDE || is_over_dock(self, at->left.where))
        return PLACE_LEFT;
    if (self->x > at->bar.width - SIDE || is_over_dock(self, at->right.where))
        return PLACE_RIGHT;
    return PLACE_FLOATING;
}

/* Where it would be dropped, and its name at the pointer. */
static void draw_drop(docks *self, ui *on, const arrangement_rectangles *at, panel_place to)
{
    const placed_tab *tab = tab_under(self);
    const char *title = title_of(self->dragged);
    ui_rectangle zone = to == PLACE_LEFT ? at->left.where : at->right.where;
    if (zone.width <= 0.0f)
        zone = (ui_rectangle){to == PLACE_LEFT ? 0.0f : at->bar.width - SIDE, at->face.y, SIDE,
                              at->face.height};
    if (tab)
        zone = (ui_rectangle){tab->where.x - 1.0f, tab->where.y, 3.0f, tab->where.height};
    if (to != PLACE_FLOATING) {
        ui_panel_begin(on, "drop", zone, UI_GROUND_NONE);
        if (tab)
            ui_draw_box(on, zone, THEME_ACCENT, 0.0f);
        else
            ui_draw_frame(on, zone, THEME_ACCENT, 0.0f, 2.0f);
        ui_panel_end(on);
    }
    if (now(self)->panel[self->dragged].place == PLACE_FLOATING)
        return; /* it moves itself */
    const ui_rectangle ghost = {self->x + 10.0f, self->y + 6.0f,
                                ui_text_width(on, UI_STYLE_BODY, title) + 20.0f, 26.0f};
    ui_panel_begin(on, "ghost", ghost, UI_GROUND_NONE);
    ui_draw_box(on, ghost, THEME_RAISED, 4.0f);
    ui_draw_text(on, ghost.x + 10.0f,
                 ghost.y + 0.5f * (ghost.height - ui_text_height(on, UI_STYLE_BODY)), UI_STYLE_BODY,
                 THEME_TEXT, 0.0f, title);
    ui_panel_end(on);
}

static void follow_dragged(docks *self, ui *on, const arrangement_rectangles *at)
{
    if (self->dragged == APP_PANELS)
        return;
    const panel_place to = place_under(self, at);
    panel_spot *spot = &now(self)->panel[self->dragged];
    ui_want_frame(on, 0.0);
    if (!self->is_dropped) {
        draw_drop(self, on, at, to);
        return;
    }
    const placed_tab *tab = tab_under(self);
    if (to == PLACE_FLOATING && spot->place != PLACE_FLOATING)
        spot->floated = (ui_rectangle){self->x - 0.5f * THEME_DOCK_WIDTH, self->y - 0.5f * HEAD,
                                       THEME_DOCK_WIDTH, 0.6f * at->face.height};
    if (to != spot->place || tab)
        arrangement_move(now(self), self->dragged, to, tab ? tab->panel : APP_PANELS);
}

/* ---- the switch of the layouts ---- */

static void draw_layout_menu(void *data, uint32_t index)
{
    tabs_of_dock *tabs = data;
    docks *self = tabs->docks;
    ui *on = tabs->on;
    static const action list[] = {ACTION_LAYOUT_RESET, ACTION_LAYOUT_KEEP};
    const action of = (action)(ACTION_LAYOUT_PERFORM + (int)index);
    char keys[KEY_WORDS + 4], hint[256], id[24];
    app_panel hidden[APP_PANELS];
    key_map_after(&app_looks_of(self->app)->keys, of, keys);
    (void)snprintf(hint, sizeof hint, "%s%s\n%s Right-click for more.", action_of(of)->title, keys,
                   action_of(of)->help);
    ui_hint(on, hint);
    (void)snprintf(id, sizeof id, "layout_%u", index);
    if (!ui_menu_begin(on, id))
        return;
    if (app_looks_of(self->app)->layouts.of != (app_layout)index)
        app_do(self->app, of);
    menu_actions(self, on, list, sizeof list / sizeof list[0]);
    const uint32_t count = arrangement_panels(now(self), PLACE_HIDDEN, hidden);
    if (count > 0)
        ui_rule(on);
    for (uint32_t i = 0; i < count; ++i) {
        char label[48];
        (void)snprintf(label, sizeof label, "Show %s", title_of(hidden[i]));
        key_map_words(&app_looks_of(self->app)->keys,
                      (action)(ACTION_PANEL_DEVICES + (int)hidden[i]), keys);
        if (ui_menu_item(on, label, keys, true))
            arrangement_show(now(self), hidden[i]);
    }
    ui_menu_end(on);
}

static void draw_switch(docks *self, ui *on, ui_rectangle over)
{
    static const char *const names[LAYOUTS] = {
        [LAYOUT_PERFORM] = "Perform", [LAYOUT_EDIT] = "Edit", [LAYOUT_RIG] = "Rig"};
    uint32_t chosen = (uint32_t)app_looks_of(self->app)->layouts.of;
    tabs_of_dock tabs = {self, on, NULL};
    float width = 16.0f * (float)LAYOUTS;
    for (uint32_t i = 0; i < LAYOUTS; ++i)
        width += ui_text_width(on, UI_STYLE_STRONG, names[i]);
    const ui_rectangle where = {over.x + over.width - width - 10.0f, over.y + 6.0f, width,
                                SWITCH_HEIGHT};
    if (where.x < over.x || app_has_hand_keys(self->app)) /* then the keys are there */
        return;
    ui_on_face_begin(on);
    ui_panel_begin(on, "layouts", where, UI_GROUND_NONE);
    if (ui_tabs_each(on, "layouts", names, LAYOUTS, &chosen, draw_layout_menu, &tabs))
        app_do(self->app, (action)(ACTION_LAYOUT_PERFORM + (int)chosen));
    ui_panel_end(on);
    ui_on_face_end(on);
}

void docks_draw_over(docks *self, ui *on, const arrangement_rectangles *at)
{
    draw_edges(self, on, at);
    draw_switch(self, on, at->face);
    for (uint32_t i = 0; i < at->floating_count; ++i)
        draw_floating(self, on, at->floating[i].panel, at->floating[i].where);
    follow_dragged(self, on, at);
}
