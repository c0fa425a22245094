/* The rig panel on the face. Handles the pointer: brush strokes, dragged contacts and jaw handles.
 * Draws the rig: tints, dots, the axis, and the neutral face or a tried jaw position. */
#include "window/rig/panel.h"

#include "base/angle.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- the pointer ---- */

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

static void say_ink(const panel *self, char *out, size_t capacity)
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

static rig_stroke_ink ink_now(const panel *self, uint32_t modifiers)
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

static void begin_stroke(panel *self, const viewport_stroke *s)
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
    rig_panel_report(self, result < 0 ? err.text : "");
    if (result >= 0)
        brush_begin(rig_model_brush(self->model), &painting->shape);
}

static void move_stroke(panel *self, const viewport_stroke *s)
{
    error err = {""};
    brush *b = rig_model_brush(self->model);
    if (brush_move(b, s->vertex, s->rest, &err) < 0)
        rig_panel_report(self, err.text);
    rig_stroke_update(self->painting.stroke, b);
    self->shown.is_tint_new = true;
}

void rig_panel_end_stroke(panel *self)
{
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
    mrt_result result = r ? rig_stroke_end(stroke, r, &changed, &self->err) : MRT_ERR_MEMORY;
    if (r && result >= 0 && changed == 0)
        rig_model_abandon(self->model);
    else if (r)
        (void)rig_panel_finish(self, result, words);
    rig_stroke_destroy(stroke);
    self->shown.is_tint_new = true;
}

static void paint(panel *self, viewport *view)
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

static vec3 contact_position(const panel *self, uint32_t contact)
{
    const mesh *m = rig_model_mesh(self->model);
    const rig_placing *placing = &self->placing;
    uint32_t vertex = rig_model_rig(self->model)->contact[contact].vertex;
    if (placing->is_moving && contact == self->contact)
        vertex = placing->vertex;
    return vertex < m->vertex_count ? vec3_of(m->position + (size_t)vertex * 3) : (vec3){0, 0, 0};
}

/* Returns the contact under the pointer, on the visible side of the face. */
static uint32_t contact_at(const panel *self, const viewport_stroke *s)
{
    const rig *r = rig_model_rig(self->model);
    const float *normal = brush_normals(rig_model_brush(self->model));
    rig_ray ray = ray_of(s);
    uint32_t best = RIG_NONE;
    double reach = reach_points;
    for (uint32_t i = 0; i < r->contact_count; ++i) {
        vec3 at = contact_position(self, i);
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

/* Writes the first free name, such as "contact 3". */
static void new_name(const rig *r, char *out, size_t capacity)
{
    uint32_t number = r->contact_count;
    do
        (void)snprintf(out, capacity, "contact.%u", ++number);
    while (rig_find_contact(r, out) != RIG_NONE);
}

static void add_contact(panel *self, uint32_t vertex)
{
    char name[RIG_PANEL_NAME];
    uint32_t index;
    rig *r = rig_panel_begin(self);
    self->placing.is_adding = false;
    if (!r)
        return;
    new_name(r, name, sizeof name);
    mrt_result result = rig_edit_add_contact(r, name, vertex, &index, &self->err);
    if (rig_panel_finish(self, result, "add a contact"))
        rig_panel_choose(self, RIG_TAB_CONTACTS, index);
}

/* Moves the contact together with its mirror. */
static void put_contact(panel *self, uint32_t vertex)
{
    rig *r = rig_panel_begin(self);
    if (!r)
        return;
    mrt_result result = rig_edit_move_contact(r, self->contact, vertex, &self->err);
    uint32_t mirror = r->contact[self->contact].mirror;
    uint32_t image = brush_mirror_of(rig_model_brush(self->model), vertex);
    if (result >= 0 && self->is_even && mirror != RIG_NONE && image != UINT32_MAX)
        result = rig_edit_move_contact(r, mirror, image, &self->err);
    (void)rig_panel_finish(self, result, "move a contact");
}

static void press_contact(panel *self, const viewport_stroke *s)
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

static void drag_contact(panel *self, const viewport_stroke *s)
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

static void set_contact_positions(panel *self, viewport *view)
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

void rig_panel_commit_jaw(panel *self)
{
    rig *r = rig_panel_begin(self);
    self->jawing.is_changing = false;
    if (!r)
        return;
    mrt_result result = rig_edit_set_jaw(r, rig_find_jaw(r), &self->jawing.jaw, &self->err);
    (void)rig_panel_finish(self, result, "change the jaw");
}

static void take_handle(panel *self, const rig_ray *ray)
{
    rig_jawing *jawing = &self->jawing;
    vec3 at[RIG_HANDLES], on_plane;
    rig_gizmo_positions(at, &jawing->jaw);
    uint32_t count = jawing->jaw.has_incisor ? RIG_HANDLES : RIG_HANDLE_INCISOR;
    uint32_t found = rig_gizmo_nearest(ray, at, count, handle_points);
    if (found == RIG_NONE || !rig_gizmo_reach(&on_plane, ray, at[found]))
        return;
    jawing->held = (rig_handle)found;
    jawing->grip = vec3_sub(at[found], on_plane);
    jawing->is_changing = true;
}

static void drag_handle(panel *self, const rig_ray *ray)
{
    rig_jawing *jawing = &self->jawing;
    vec3 at[RIG_HANDLES], to;
    rig_gizmo_positions(at, &jawing->jaw);
    if (!rig_gizmo_reach(&to, ray, at[jawing->held]))
        return;
    to = vec3_add(to, jawing->grip);
    rig_gizmo_move(&jawing->jaw, jawing->held, to, self->is_even,
                   brush_middle_mm(rig_model_brush(self->model)));
}

static void turn_jaw(panel *self, viewport *view)
{
    const rig *r = rig_model_rig(self->model);
    const viewport_stroke *s = viewport_stroke_now(view);
    rig_jawing *jawing = &self->jawing;
    uint32_t jaw = rig_find_jaw(r);
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
    rig_panel_commit_jaw(self);
}

/* ---- display of the rig ---- */

enum { ITEMS_MAX = 900 };
static const float dot_rgba[4] = {0.96f, 0.94f, 0.88f, 0.95f};
static const float rim_rgba[4] = {0.06f, 0.06f, 0.07f, 0.8f};
static const float chosen_rgba[4] = {0.98f, 0.74f, 0.28f, 1.0f};

/* ---- memory ---- */

static bool allocate(rig_shown *shown, uint32_t vertex_count)
{
    size_t count = (size_t)vertex_count + 1;
    if (shown->rgb && shown->vertex_count == vertex_count)
        return true;
    rig_panel_shown_finish(shown);
    shown->vertex_count = vertex_count;
    shown->is_tint_new = shown->is_shape_new = true;
    shown->rgb = calloc(count * 3, sizeof *shown->rgb);
    shown->share = calloc(count, sizeof *shown->share);
    shown->position = calloc(count * 3, sizeof *shown->position);
    shown->normal = calloc(count * 3, sizeof *shown->normal);
    shown->scratch = calloc(count * 6, sizeof *shown->scratch);
    if (shown->rgb && shown->share && shown->position && shown->normal && shown->scratch)
        return true;
    rig_panel_shown_finish(shown);
    return false;
}

void rig_panel_shown_finish(rig_shown *shown)
{
    free(shown->rgb);
    free(shown->share);
    free(shown->position);
    free(shown->normal);
    free(shown->scratch);
    bool is_released = shown->is_released;
    *shown = (rig_shown){.is_released = is_released};
}

/* ---- tints ---- */

static bool is_of_mobility(const panel *self)
{
    return self->painting.ink.ink == RIG_INK_FREE || self->painting.ink.ink == RIG_INK_STILL;
}

static void tint_all(panel *self)
{
    const rig_work *work = rig_model_work(self->model);
    float *rgb = self->shown.rgb;
    if (!work || !work->face)
        rig_tint_plain(rgb, rig_model_mesh(self->model)->vertex_count);
    else if (self->painting.is_on && is_of_mobility(self))
        rig_tint_mobility(rgb, face_binding(work->face));
    else
        rig_tint_bones(rgb, &work->rig, face_binding(work->face));
}

static void tint_region(panel *self, const rig *r)
{
    float colour[3];
    const rig_region *region = &r->region[self->region];
    const mesh *m = rig_model_mesh(self->model);
    if (bind_select(self->shown.share, &region->select, m, rig_model_topology(self->model), NULL) <
        0)
        memset(self->shown.share, 0, m->vertex_count * sizeof *self->shown.share);
    rig_tint_of_bone(colour, r, region->bone);
    rig_tint_share(self->shown.rgb, self->shown.share, m->vertex_count, colour);
}

/* Tints the current stroke over the known binding. */
static void tint_stroke(panel *self, const rig *r)
{
    static const float erased[3] = {0.34f, 0.33f, 0.32f};
    const rig_stroke *stroke = self->painting.stroke;
    const brush *b = rig_model_brush(self->model);
    const float *touch[2] = {brush_touch(b, BRUSH_HERE), brush_touch(b, BRUSH_THERE)};
    uint32_t count;
    const uint32_t *touched = brush_touched(b, &count);
    bool paints = rig_stroke_bone(stroke, BRUSH_HERE) != RIG_NONE || is_of_mobility(self);
    for (uint32_t i = 0; i < count; ++i) {
        float colour[3], *rgb = self->shown.rgb + (size_t)touched[i] * 3;
        uint32_t side = touch[1][touched[i]] > touch[0][touched[i]] ? BRUSH_THERE : BRUSH_HERE;
        rig_tint_of_bone(colour, r, rig_stroke_bone(stroke, side));
        float share = (float)rig_stroke_value(stroke, touched[i]) / 255.0f;
        if (paints && self->painting.ink.ink != RIG_INK_STILL)
            rig_tint_mix(rgb, colour, share);
        else
            rig_tint_mix(rgb, erased, touch[side][touched[i]]);
    }
}

static void tell_tint(panel *self, viewport *view, const rig *r)
{
    rig_shown *shown = &self->shown;
    bool is_tinted = self->tab == RIG_TAB_REGIONS;
    if (!shown->is_tint_new && is_tinted == shown->is_tinted)
        return;
    shown->is_tint_new = false;
    shown->is_tinted = is_tinted;
    if (!is_tinted) {
        viewport_paint(view, NULL);
        return;
    }
    bool is_region_ink = self->painting.ink.ink == RIG_INK_REGION;
    if (self->region != RIG_NONE && (!self->painting.is_on || is_region_ink))
        tint_region(self, r);
    else
        tint_all(self);
    if (self->painting.stroke)
        tint_stroke(self, r);
    viewport_paint(view, shown->rgb);
}

/* ---- the shape ---- */

static void find_normals(panel *self)
{
    rig_shown *shown = &self->shown;
    brush_find_normals(shown->normal, rig_model_mesh(self->model), shown->position, shown->scratch);
}

static void set_dof(float *dof, const bones *b, const char *name, double value)
{
    for (uint32_t i = 0; i < b->dof_count; ++i)
        if (strcmp(b->dof[i].name, name) == 0)
            dof[i] = (float)value;
}

static double way_of_teeth(const bones *b, const float *dof)
{
    rigid pose[RIG_BONES_MAX];
    bones_pose(pose, b, dof);
    return b->jaw == RIG_NONE
               ? 0.0
               : vec3_length(vec3_sub(rigid_apply(&pose[b->jaw], b->incisor), b->incisor));
}

static double tried_open(float *dof, const bones *b, const rig *r, const rig_jawing *jawing,
                         double sealed)
{
    static const char *const motion[3] = {"open", "lateral", "forward"};
    const double value[3] = {jawing->open_deg * ANGLE_PI / 180.0, jawing->aside_mm,
                             jawing->forward_mm};
    for (int i = 0; i < 3; ++i) {
        char name[80];
        (void)snprintf(name, sizeof name, "%.60s.%s", r->bone[rig_find_jaw(r)].name, motion[i]);
        set_dof(dof, b, name, value[i]);
    }
    set_dof(dof, b, RIG_LIPS_SEAL, sealed);
    return way_of_teeth(b, dof);
}

/* Applies the tried turns to the bound face, whose names can be older than those of the rig. */
static void try_turns(float *dof, const bones *b, const rig *now, const rig_parting *parting)
{
    const rig_bone *ball = &now->bone[parting->bone];
    for (uint32_t i = 0; i < ball->turn_count; ++i) {
        char name[2 * RIG_PANEL_NAME];
        (void)snprintf(name, sizeof name, "%.60s.%.60s", ball->name, ball->turn[i].name);
        set_dof(dof, b, name, parting->tried_rad[i]);
    }
}

static bool tries_turns(const panel *self)
{
    const rig *r = rig_model_rig(self->model);
    const uint32_t bone = self->parting.bone;
    return self->tab == RIG_TAB_PARTS && bone != RIG_NONE && bone < r->bone_count &&
           r->bone[bone].kind == BONE_BALL;
}

/* Poses the jaw or the selected ball. Returns false if nothing can be tried. */
static bool pose_face(panel *self)
{
    const rig_work *work = rig_model_work(self->model);
    const bool is_jaw = self->tab == RIG_TAB_JAW;
    if (!work || !work->face || (is_jaw && rig_find_jaw(&work->rig) == RIG_NONE))
        return false;
    const bones *b = face_bones(work->face);
    float dof[MRT_MAX_DOFS] = {0.0f};
    if (is_jaw)
        self->jawing.gap_mm =
            tried_open(dof, b, &work->rig, &self->jawing, self->mouthing.sealed_percent / 100.0);
    else
        try_turns(dof, b, rig_model_rig(self->model), &self->parting);
    error err;
    if (face_pull(work->face, NULL, dof, &err) < 0)
        return false;
    points_to_rows(self->shown.position, face_shown(work->face), face_order(work->face));
    find_normals(self);
    return true;
}

static void tell_shape(panel *self, viewport *view)
{
    rig_shown *shown = &self->shown;
    bool paints = self->tab == RIG_TAB_REGIONS && self->painting.is_on;
    bool has_part = self->parting.bone != RIG_NONE || self->parting.proxy != RIG_NONE ||
                    self->parting.pose != RIG_NONE;
    bool stands_in = paints || self->tab == RIG_TAB_CONTACTS || self->tab == RIG_TAB_JAW ||
                     (self->tab == RIG_TAB_PARTS && has_part);
    if (!shown->is_shape_new && stands_in == shown->stands_in)
        return;
    shown->is_shape_new = false;
    shown->stands_in = stands_in;
    if (!stands_in)
        viewport_stand_in(view, NULL, NULL);
    else if ((self->tab == RIG_TAB_JAW || tries_turns(self)) && pose_face(self))
        viewport_stand_in(view, shown->position, shown->normal);
    else if (self->tab == RIG_TAB_PARTS && rig_panel_show_pose(self)) {
        find_normals(self);
        viewport_stand_in(view, shown->position, shown->normal);
    } else
        viewport_stand_in(view, rig_model_mesh(self->model)->position,
                          brush_normals(rig_model_brush(self->model)));
}

/* ---- things in space ---- */

/* Adds the contacts twice, because hidden items are drawn faintly. */
static uint32_t add_contacts(const panel *self, overlay_item *out)
{
    uint32_t contacts = rig_model_rig(self->model)->contact_count, count = 0;
    for (uint32_t i = 0; i < contacts && count + 4 <= ITEMS_MAX; ++i) {
        bool is_chosen = i == self->contact;
        vec3 at = contact_position(self, i);
        float width_px = is_chosen ? 12.0f : 8.0f;
        out[count++] = overlay_dot(at, width_px + 2.0f, rim_rgba);
        out[count++] = overlay_dot(at, width_px, is_chosen ? chosen_rgba : dot_rgba);
        out[count++] = overlay_dot(at, width_px, is_chosen ? chosen_rgba : dot_rgba);
    }
    return count;
}

/* Adds the rims of the mouth on the tried face: upper bright, lower amber. */
static uint32_t add_rims(const panel *self, overlay_item *out, uint32_t capacity)
{
    const rig_work *work = rig_model_work(self->model);
    const bind_lips *lips = work && work->face ? &face_binding(work->face)->lips : NULL;
    uint32_t count = 0;
    for (int lip = 0; lips && lip < 2; ++lip) {
        vec3 before = {0, 0, 0};
        for (uint32_t i = 0; i < lips->station_count && count < capacity; ++i) {
            const bind_station *s = lip == 0 ? &lips->upper[i] : &lips->lower[i];
            const uint32_t *slot = face_order(work->face)->slot_of_file;
            vec3 a = points_position(face_shown(work->face), slot[s->vertex[0]]);
            vec3 b = points_position(face_shown(work->face), slot[s->vertex[1]]);
            vec3 at = vec3_add(vec3_scale(a, 1.0 - s->along), vec3_scale(b, s->along));
            if (i > 0)
                out[count++] = overlay_line(before, at, 2.5f, lip == 0 ? dot_rgba : chosen_rgba);
            before = at;
        }
    }
    return count;
}

static void tell_items(const panel *self, viewport *view)
{
    overlay_item item[ITEMS_MAX];
    uint32_t count = 0;
    if (self->tab == RIG_TAB_CONTACTS)
        count = add_contacts(self, item);
    if (self->tab == RIG_TAB_JAW && rig_find_jaw(rig_model_rig(self->model)) != RIG_NONE)
        count = rig_gizmo_draw(item, &self->jawing.jaw, self->jawing.held);
    if (self->tab == RIG_TAB_JAW)
        count += add_rims(self, item + count, ITEMS_MAX - count);
    if (self->tab == RIG_TAB_PARTS)
        count = rig_panel_part_items(self, item, ITEMS_MAX);
    viewport_add(view, item, count);
}

/* ---- */

static void show_rig(panel *self, viewport *view)
{
    const rig *r = rig_model_rig(self->model);
    if (!r || !allocate(&self->shown, rig_model_mesh(self->model)->vertex_count)) {
        rig_panel_release(self, view);
        return;
    }
    self->shown.is_released = false;
    app_looks_of(self->of)->is_painting = self->tab == RIG_TAB_REGIONS && self->painting.is_on;
    tell_tint(self, view, r);
    tell_shape(self, view);
    tell_items(self, view);
}

void rig_panel_face(panel *self, viewport *view)
{
    bool has_rig = rig_model_rig(self->model) != NULL;
    bool paints = has_rig && self->tab == RIG_TAB_REGIONS && self->painting.is_on;
    if (!paints)
        rig_panel_end_stroke(self);
    if (paints)
        paint(self, view);
    else if (has_rig && self->tab == RIG_TAB_CONTACTS)
        set_contact_positions(self, view);
    else if (has_rig && self->tab == RIG_TAB_JAW)
        turn_jaw(self, view);
    else
        viewport_set_use(view, VIEWPORT_PERFORMS, 0.0f);
    show_rig(self, view);
}

void rig_panel_release(panel *self, viewport *view)
{
    if (self->shown.is_released)
        return;
    rig_panel_end_stroke(self);
    app_looks_of(self->of)->is_painting = false;
    viewport_set_use(view, VIEWPORT_PERFORMS, 0.0f);
    viewport_paint(view, NULL);
    viewport_stand_in(view, NULL, NULL);
    viewport_add(view, NULL, 0);
    self->shown.is_released = true;
    self->shown.is_tinted = self->shown.stands_in = false;
    self->shown.is_tint_new = self->shown.is_shape_new = true;
}
