/* What the pointer does on the face for the rig panel: strokes of the brush, contacts that are
 * chosen and put elsewhere, the handles of the jaw. */
#include "window/rig_panel_inside.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double reach_points = 14.0, drag_points = 5.0, handle_points = 18.0;

static vec3 vec3_of(const float at[3])
{
    return (vec3){(double)at[0], (double)at[1], (double)at[2]};
}

static rig_ray ray_of(const viewport_stroke *s)
{
    return (rig_ray){vec3_of(s->eye), vec3_of(s->ray), vec3_of(s->forward), (double)s->point_rad};
}

/* ---- the brush ---- */

static void say_ink(const rig_panel *self, char *out, size_t capacity)
{
    const rig *r = rig_model_rig(self->model);
    const rig_stroke_ink *ink = &self->painting.ink;
    static const char *const words[RIG_INKS] = {
        [RIG_INK_RIDES] = "",          [RIG_INK_RIGID] = "",
        [RIG_INK_FREE] = "mobility",   [RIG_INK_STILL] = "what cannot move",
        [RIG_INK_REGION] = "a region", [RIG_INK_ERASER] = ""};
    if (ink->ink == RIG_INK_RIDES || ink->ink == RIG_INK_RIGID)
        (void)snprintf(out, capacity, "paint %.60s", r->bone[ink->bone].name);
    else
        (void)snprintf(out, capacity, "paint %s", words[ink->ink]);
}

static rig_stroke_ink ink_now(const rig_panel *self, uint32_t modifiers)
{
    rig_stroke_ink ink = self->painting.ink;
    ink.region = self->region;
    if (!(modifiers & UI_SHIFT))
        return ink;
    if (ink.ink == RIG_INK_REGION)
        ink.takes_away = true;
    else
        ink.ink = RIG_INK_ERASER;
    return ink;
}

static void begin_stroke(rig_panel *self, const viewport_stroke *s)
{
    error err = {""};
    rig_painting *painting = &self->painting;
    rig_stroke_ink ink = ink_now(self, s->modifiers);
    painting->shape.sides = self->is_even ? BRUSH_BOTH_SIDES : BRUSH_ONE_SIDE;
    const rig_work *work = rig_model_work(self->model);
    const binding *filled = work && work->face ? face_binding(work->face) : NULL;
    mrt_result result =
        rig_stroke_begin(&painting->stroke, rig_model_rig(self->model),
                         rig_model_mesh(self->model)->vertex_count, &ink, filled, &err);
    rig_panel_say(self, result < 0 ? err.text : "");
    if (result >= 0)
        brush_begin(rig_model_brush(self->model), &painting->shape);
}

static void move_stroke(rig_panel *self, const viewport_stroke *s)
{
    error err = {""};
    brush *b = rig_model_brush(self->model);
    if (brush_move(b, s->vertex, s->rest, &err) < 0)
        rig_panel_say(self, err.text);
    rig_stroke_update(self->painting.stroke, b);
    self->shown.is_tint_new = true;
}

void rig_panel_end_stroke(rig_panel *self)
{
    error err = {""};
    char words[96];
    uint32_t changed = 0;
    rig_stroke *stroke = self->painting.stroke;
    self->painting.stroke = NULL;
    if (!stroke)
        return;
    say_ink(self, words, sizeof words);
    if (rig_stroke_bone(stroke, BRUSH_HERE) == RIG_NONE && self->painting.ink.ink != RIG_INK_REGION)
        (void)snprintf(words, sizeof words, "erase paint");
    rig *r = rig_panel_begin(self);
    mrt_result result = r ? rig_stroke_end(stroke, r, &changed, &err) : MRT_ERR_MEMORY;
    if (r && result >= 0 && changed == 0)
        rig_model_abandon(self->model);
    else if (r)
        (void)rig_panel_finish(self, result, &err, words);
    rig_stroke_destroy(stroke);
    self->shown.is_tint_new = true;
}

static void paint(rig_panel *self, viewport *view)
{
    const viewport_stroke *s = viewport_stroke_now(view);
    rig_painting *painting = &self->painting;
    viewport_set_use(view, VIEWPORT_PAINTS, (float)painting->shape.radius_mm);
    if (s->is_pressed && s->is_on_face && !painting->stroke)
        begin_stroke(self, s);
    bool is_on = s->is_pressed || s->is_dragging || s->is_released;
    if (painting->stroke && is_on && s->is_on_face)
        move_stroke(self, s);
    if (painting->stroke && (s->is_released || !is_on))
        rig_panel_end_stroke(self);
}

/* ---- contacts ---- */

vec3 rig_panel_contact_at(const rig_panel *self, uint32_t contact)
{
    const mesh *m = rig_model_mesh(self->model);
    const rig_placing *placing = &self->placing;
    uint32_t vertex = rig_model_rig(self->model)->contact[contact].vertex;
    if (placing->is_moving && contact == self->contact)
        vertex = placing->vertex;
    return vertex < m->vertex_count ? vec3_of(m->position + (size_t)vertex * 3) : (vec3){0, 0, 0};
}

/* The contact whose dot the pointer is at, on the side of the face that is seen. */
static uint32_t contact_at(const rig_panel *self, const viewport_stroke *s)
{
    const rig *r = rig_model_rig(self->model);
    const float *normal = brush_normals(rig_model_brush((rig_model *)(uintptr_t)self->model));
    rig_ray ray = ray_of(s);
    uint32_t best = RIG_NONE;
    double reach = reach_points;
    for (uint32_t i = 0; i < r->contact_count; ++i) {
        vec3 at = rig_panel_contact_at(self, i);
        if (r->contact[i].vertex >= rig_model_mesh(self->model)->vertex_count ||
            vec3_dot(vec3_of(normal + (size_t)r->contact[i].vertex * 3), vec3_sub(ray.eye, at)) <
                0.0 ||
            rig_gizmo_nearest(&ray, &at, 1, reach) == RIG_NONE)
            continue;
        vec3 way = vec3_normalised(vec3_sub(at, ray.eye), ray.ray);
        rig_ray other = {.ray = way, .point_rad = ray.point_rad};
        reach = fmin(reach, rig_gizmo_points_between(&ray, &other));
        best = i;
    }
    return best;
}

/* "contact 3": the first that is free. */
static void new_name(const rig *r, char *out, size_t capacity)
{
    uint32_t number = r->contact_count;
    do
        (void)snprintf(out, capacity, "contact.%u", ++number);
    while (rig_find_contact(r, out) != RIG_NONE);
}

static void add_contact(rig_panel *self, uint32_t vertex)
{
    error err = {""};
    char name[RIG_PANEL_NAME];
    uint32_t index;
    rig *r = rig_panel_begin(self);
    self->placing.is_adding = false;
    if (!r)
        return;
    new_name(r, name, sizeof name);
    mrt_result result = rig_edit_add_contact(r, name, vertex, &index, &err);
    if (rig_panel_finish(self, result, &err, "add a contact"))
        rig_panel_choose(self, RIG_TAB_CONTACTS, index);
}

/* Its mirror goes with it. */
static void put_contact(rig_panel *self, uint32_t vertex)
{
    error err = {""};
    rig *r = rig_panel_begin(self);
    if (!r)
        return;
    mrt_result result = rig_edit_move_contact(r, self->contact, vertex, &err);
    uint32_t mirror = r->contact[self->contact].mirror;
    uint32_t image = brush_mirror_of(rig_model_brush(self->model), vertex);
    if (result >= 0 && self->is_even && mirror != RIG_NONE && image != UINT32_MAX)
        result = rig_edit_move_contact(r, mirror, image, &err);
    (void)rig_panel_finish(self, result, &err, "put a contact elsewhere");
}

static void press_contact(rig_panel *self, const viewport_stroke *s)
{
    rig_placing *placing = &self->placing;
    uint32_t contact = contact_at(self, s);
    if (placing->is_adding && s->is_on_face) {
        add_contact(self, s->vertex);
        return;
    }
    rig_panel_choose(self, RIG_TAB_CONTACTS, contact);
    placing->is_pressed = contact != RIG_NONE;
    placing->pressed = ray_of(s);
}

static void drag_contact(rig_panel *self, const viewport_stroke *s)
{
    rig_placing *placing = &self->placing;
    rig_ray now = ray_of(s);
    if (!placing->is_moving && rig_gizmo_points_between(&placing->pressed, &now) < drag_points)
        return;
    if (s->is_on_face) {
        placing->is_moving = true;
        placing->vertex = s->vertex;
    }
}

static void place(rig_panel *self, viewport *view)
{
    const viewport_stroke *s = viewport_stroke_now(view);
    rig_placing *placing = &self->placing;
    viewport_set_use(view, VIEWPORT_PICKS, 0.0f);
    if (s->is_pressed)
        press_contact(self, s);
    else if (placing->is_pressed && (s->is_dragging || s->is_released))
        drag_contact(self, s);
    if (!placing->is_pressed || s->is_pressed || s->is_dragging)
        return;
    if (placing->is_moving &&
        placing->vertex != rig_model_rig(self->model)->contact[self->contact].vertex)
        put_contact(self, placing->vertex);
    placing->is_pressed = placing->is_moving = false;
}

/* ---- the jaw ---- */

void rig_panel_put_jaw(rig_panel *self)
{
    error err = {""};
    rig *r = rig_panel_begin(self);
    self->jawing.is_changing = false;
    if (!r)
        return;
    mrt_result result = rig_edit_set_jaw(r, rig_panel_jaw(r), &self->jawing.jaw, &err);
    (void)rig_panel_finish(self, result, &err, "change the jaw");
}

static void take_handle(rig_panel *self, const rig_ray *ray)
{
    rig_jawing *jawing = &self->jawing;
    vec3 at[RIG_HANDLES], on_plane;
    rig_gizmo_places(at, &jawing->jaw);
    uint32_t count = jawing->jaw.has_incisor ? RIG_HANDLES : RIG_HANDLE_INCISOR;
    uint32_t found = rig_gizmo_nearest(ray, at, count, handle_points);
    if (found == RIG_NONE || !rig_gizmo_reach(&on_plane, ray, at[found]))
        return;
    jawing->held = (rig_handle)found;
    jawing->grip = vec3_sub(at[found], on_plane);
    jawing->is_changing = true;
}

static void drag_handle(rig_panel *self, const rig_ray *ray)
{
    rig_jawing *jawing = &self->jawing;
    vec3 at[RIG_HANDLES], to;
    rig_gizmo_places(at, &jawing->jaw);
    if (!rig_gizmo_reach(&to, ray, at[jawing->held]))
        return;
    to = vec3_add(to, jawing->grip);
    rig_gizmo_put(&jawing->jaw, jawing->held, to, self->is_even,
                  brush_middle_mm(rig_model_brush(self->model)));
}

static void turn_jaw(rig_panel *self, viewport *view)
{
    const rig *r = rig_model_rig(self->model);
    const viewport_stroke *s = viewport_stroke_now(view);
    rig_jawing *jawing = &self->jawing;
    uint32_t jaw = rig_panel_jaw(r);
    rig_ray ray = ray_of(s);
    viewport_set_use(view, VIEWPORT_PICKS, 0.0f);
    if (jaw == RIG_NONE)
        return;
    if (!jawing->is_changing)
        rig_edit_jaw_of(&jawing->jaw, r, jaw);
    if (s->is_pressed)
        take_handle(self, &ray);
    else if (jawing->held != RIG_HANDLES)
        drag_handle(self, &ray);
    if (jawing->held == RIG_HANDLES || s->is_pressed || s->is_dragging)
        return;
    jawing->held = RIG_HANDLES;
    rig_panel_put_jaw(self);
}

/* ---- */

void rig_panel_face(rig_panel *self, viewport *view)
{
    bool has_rig = rig_model_rig(self->model) != NULL;
    bool paints = has_rig && self->tab == RIG_TAB_REGIONS && self->painting.is_on;
    if (!paints)
        rig_panel_end_stroke(self);
    if (paints)
        paint(self, view);
    else if (has_rig && self->tab == RIG_TAB_CONTACTS)
        place(self, view);
    else if (has_rig && self->tab == RIG_TAB_JAW)
        turn_jaw(self, view);
    else
        viewport_set_use(view, VIEWPORT_PERFORMS, 0.0f);
    rig_panel_show(self, view);
}
