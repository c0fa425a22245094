/* The parts of a rig: its bones, the ellipsoids that skin does not enter, its poses. */
#include "base/angle.h"
#include "window/rig_panel_inside.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { WORDS = 160, RING_STEPS = 32 };
static const float removes_at = 238.0f;
static const float ring_rgba[4] = {0.95f, 0.75f, 0.45f, 0.95f};
static const float rim_rgba[4] = {0.06f, 0.06f, 0.07f, 0.9f};
static const char *const kind_words[] = {
    [BONE_FIXED] = "rigid part", [BONE_JAW] = "jaw", [BONE_BALL] = "ball"};
static const char *const kind_items[] = {"a rigid part", "a jaw, with a hinge",
                                         "a ball, like an eye"};

/* ---- what is chosen ---- */

void rig_panel_choose_part(rig_panel *self, uint32_t bone, uint32_t proxy, uint32_t pose)
{
    rig_parting *parting = &self->parting;
    parting->bone = bone;
    parting->proxy = proxy;
    parting->pose = pose;
    parting->is_held = false;
    parting->bone_name.of = parting->pose_name.of = RIG_NONE;
    rig_panel_choose_turn(self, RIG_NONE);
    self->shown.is_shape_new = true;
}

void rig_panel_keep_part(rig_panel *self)
{
    const rig *r = rig_model_rig(self->model);
    const rig_parting *now = &self->parting;
    const uint32_t bone = r && now->bone < r->bone_count ? now->bone : RIG_NONE,
                   proxy = r && now->proxy < r->proxy_count ? now->proxy : RIG_NONE,
                   pose = r && now->pose < r->pose_count ? now->pose : RIG_NONE;
    if (bone != now->bone || proxy != now->proxy || pose != now->pose)
        rig_panel_choose_part(self, bone, proxy, pose);
}

bool rig_panel_draw_name(const rig_panel *self, ui *on, rig_naming *naming, uint32_t of,
                         const char *name)
{
    const uint32_t number = (uint32_t)rig_model_number(self->model);
    if (naming->of != of || naming->number != number) {
        (void)snprintf(naming->text, sizeof naming->text, "%s", name);
        naming->of = of;
        naming->number = number;
    }
    ui_width(on, -1.0f);
    if (!ui_input(on, "name", "name", naming->text, sizeof naming->text))
        return false;
    naming->of = RIG_NONE;
    return strcmp(naming->text, name) != 0;
}

/* ---- where something lies: sliders that are a step of undo once they are let go ---- */

typedef struct bounds {
    vec3 low, high;
} bounds;

static bounds bounds_of(const rig_panel *self)
{
    float low[3], high[3];
    mesh_bounds(rig_model_mesh(self->model), low, high);
    return (bounds){{(double)low[0], (double)low[1], (double)low[2]},
                    {(double)high[0], (double)high[1], (double)high[2]}};
}

static vec3 middle_of(const bounds *b)
{
    return vec3_scale(vec3_add(b->low, b->high), 0.5);
}

static bool draw_mm(ui *on, const char *label, double low, double high, double *value)
{
    const ui_range range = {low, fmax(high, low + 1.0), "mm", 1, false, 0.5 * (low + high)};
    (void)ui_slider(on, label, RIG_PANEL_LABEL, &range, value);
    return ui_slider_is_held(on);
}

static bool draw_place(const rig_panel *self, ui *on, vec3 *at)
{
    const bounds b = bounds_of(self);
    bool is_held = draw_mm(on, "Across", b.low.x, b.high.x, &at->x);
    is_held = draw_mm(on, "Up", b.low.y, b.high.y, &at->y) || is_held;
    return draw_mm(on, "Forward", b.low.z, b.high.z, &at->z) || is_held;
}

static bool is_same(vec3 a, vec3 b)
{
    return !(vec3_length(vec3_sub(a, b)) > 1e-9);
}

static double size_of(const rig_panel *self)
{
    const bounds b = bounds_of(self);
    return vec3_length(vec3_sub(b.high, b.low));
}

/* ---- bones ---- */

static void list_bones(rig_panel *self, ui *on, const rig *r)
{
    for (uint32_t i = 0; i < r->bone_count; ++i) {
        char label[WORDS];
        (void)snprintf(label, sizeof label, "%s##bone%u", r->bone[i].name, i);
        ui_width(on, -96.0f);
        if (ui_row(on, label, i == self->parting.bone) != UI_ROW_NONE)
            rig_panel_choose_part(self, i == self->parting.bone ? RIG_NONE : i, RIG_NONE, RIG_NONE);
        const char *words = kind_words[r->bone[i].kind];
        ui_same_line(on);
        ui_at(on, 292.0f - ui_text_width(on, UI_STYLE_DIM, words));
        ui_text(on, UI_STYLE_DIM, words);
    }
}

static const char *free_name(const rig *r, rig_bone_kind kind, char out[RIG_PANEL_NAME])
{
    static const char *const base[] = {
        [BONE_FIXED] = "part", [BONE_JAW] = "jaw", [BONE_BALL] = "eye"};
    (void)snprintf(out, RIG_PANEL_NAME, "%s", base[kind]);
    for (uint32_t number = 2; rig_find_bone(r, out) != RIG_NONE; ++number)
        (void)snprintf(out, RIG_PANEL_NAME, "%s %u", base[kind], number);
    return out;
}

/* Where it can be seen and taken hold of: a jaw before the ears, a ball in the middle. */
static void add_bone(rig_panel *self)
{
    error err = {""};
    char name[RIG_PANEL_NAME];
    uint32_t index = RIG_NONE;
    const bounds b = bounds_of(self);
    const rig_bone_kind kind = (rig_bone_kind)self->parting.kind;
    const double wide = b.high.x - b.low.x;
    const double half_mm = kind == BONE_JAW ? 0.35 * wide : 0.08 * wide;
    rig *r = rig_panel_begin(self);
    if (!r)
        return;
    mrt_result result = rig_edit_add_bone(r, free_name(r, kind, name), kind, middle_of(&b),
                                          fmax(half_mm, 1.0), &index, &err);
    if (rig_panel_finish(self, result, &err, "add a bone"))
        rig_panel_choose_part(self, index, RIG_NONE, RIG_NONE);
}

static void remove_bone(rig_panel *self)
{
    error err = {""};
    rig *r = rig_panel_begin(self);
    if (r && rig_panel_finish(self, rig_edit_remove_bone(r, self->parting.bone, &err), &err,
                              "take out a bone"))
        rig_panel_choose_part(self, RIG_NONE, RIG_NONE, RIG_NONE);
}

static void name_bone(rig_panel *self)
{
    error err = {""};
    rig *r = rig_panel_begin(self);
    if (r)
        (void)rig_panel_finish(
            self, rig_edit_name_bone(r, self->parting.bone, self->parting.bone_name.text, &err),
            &err, "name a bone");
}

static void draw_ball(rig_panel *self, ui *on, const rig_bone *bone)
{
    error err = {""};
    rig_parting *parting = &self->parting;
    if (!parting->is_held) {
        parting->centre = bone->centre;
        parting->radii = (vec3){bone->radius_mm, 0.0, 0.0};
    }
    bool is_held = draw_place(self, on, &parting->centre);
    is_held = draw_mm(on, "Radius", 1.0, 0.3 * size_of(self), &parting->radii.x) || is_held;
    const vec3 radius = {bone->radius_mm, 0.0, 0.0};
    parting->is_held = is_held;
    if (is_held || (is_same(parting->centre, bone->centre) && is_same(parting->radii, radius)))
        return;
    rig *r = rig_panel_begin(self);
    if (r)
        (void)rig_panel_finish(
            self, rig_edit_set_ball(r, parting->bone, parting->centre, parting->radii.x, &err),
            &err, "move a ball");
}

static bool has_region(const rig *r, uint32_t bone)
{
    for (uint32_t i = 0; i < r->region_count; ++i)
        if (r->region[i].bone == bone)
            return true;
    return false;
}

static void add_region(rig_panel *self)
{
    error err = {""};
    uint32_t index = RIG_NONE;
    const rig_edit_says says = {self->parting.bone, false, 1.0, (double)NAN};
    rig *r = rig_panel_begin(self);
    if (r && rig_panel_finish(self, rig_edit_add_region(r, NULL, &says, &index, &err), &err,
                              "add a region"))
        rig_panel_choose(self, RIG_TAB_REGIONS, index);
}

static void draw_what_rides(rig_panel *self, ui *on)
{
    ui_text_wrapped(on, UI_STYLE_WARNING,
                    "No region says what rides on it: until then the stage has the rig as it was "
                    "before.");
    if (ui_button(on, "Add a region for it", UI_ACCENT))
        add_region(self);
    ui_hint(on, "It is painted where \"Regions\" is open.");
}

/* On one that is listed before it. */
static void draw_parent(rig_panel *self, ui *on, const rig *r)
{
    error err = {""};
    const char *items[RIG_BONES_MAX + 1];
    const uint32_t index = self->parting.bone, nothing = index;
    const uint32_t before = r->bone[index].parent == RIG_NONE ? nothing : r->bone[index].parent;
    uint32_t chosen = before;
    for (uint32_t i = 0; i < index; ++i)
        items[i] = r->bone[i].name;
    items[nothing] = "nothing";
    if (!ui_choice(on, "Rides on", RIG_PANEL_LABEL, items, index + 1, &chosen) || chosen == before)
        return;
    rig *to = rig_panel_begin(self);
    if (to)
        (void)rig_panel_finish(
            self, rig_edit_ride_bone(to, index, chosen == nothing ? RIG_NONE : chosen, &err), &err,
            "change what a bone rides on");
}

static void draw_bone(rig_panel *self, ui *on, const rig *r)
{
    const uint32_t index = self->parting.bone;
    const rig_bone *bone = &r->bone[index];
    const uint64_t number = rig_model_number(self->model);
    const bool stays = index == 0 || strcmp(bone->name, "skull") == 0;
    ui_id_begin(on, "bone");
    ui_disabled_begin(on, stays);
    if (rig_panel_draw_name(self, on, &self->parting.bone_name, index, bone->name))
        name_bone(self);
    ui_disabled_end(on);
    if (number == rig_model_number(self->model) && !stays)
        draw_parent(self, on, r);
    if (number == rig_model_number(self->model) && !has_region(r, index))
        draw_what_rides(self, on);
    if (number == rig_model_number(self->model) && bone->kind == BONE_BALL)
        draw_ball(self, on, bone);
    if (number == rig_model_number(self->model) && bone->kind == BONE_BALL)
        rig_panel_draw_turns(self, on, index);
    if (number == rig_model_number(self->model) && bone->kind == BONE_JAW)
        ui_text_wrapped(on, UI_STYLE_DIM, "Its axis is dragged where \"Jaw\" is open.");
    ui_disabled_begin(on, stays);
    if (number == rig_model_number(self->model) && ui_button(on, "Take out", UI_PLAIN))
        remove_bone(self);
    ui_disabled_end(on);
    ui_hint(on, stays ? "It carries the face." : "What rides on it rides on its own bone then.");
    ui_id_end(on);
}

static void draw_bones(rig_panel *self, ui *on)
{
    list_bones(self, on, rig_model_rig(self->model));
    if (self->parting.bone != RIG_NONE)
        draw_bone(self, on, rig_model_rig(self->model));
    ui_width(on, -(292.0f - removes_at + 16.0f));
    (void)ui_choice(on, "New", RIG_PANEL_LABEL, kind_items, 3, &self->parting.kind);
    ui_same_line(on);
    ui_at(on, removes_at);
    if (ui_button(on, "Add##bone", UI_PLAIN))
        add_bone(self);
    ui_hint(on, "Regions say which vertices ride on it.");
}

/* ---- ellipsoids ---- */

static void add_proxy(rig_panel *self)
{
    error err = {""};
    uint32_t index = RIG_NONE;
    const bounds b = bounds_of(self);
    const vec3 half = vec3_scale(vec3_sub(b.high, b.low), 0.5);
    const rig_proxy made = {
        .bone = 0,
        .centre = middle_of(&b),
        .radii = {fmax(0.6 * half.x, 1.0), fmax(0.6 * half.y, 1.0), fmax(0.6 * half.z, 1.0)}};
    rig *r = rig_panel_begin(self);
    if (r && rig_panel_finish(self, rig_edit_add_proxy(r, &made, &index, &err), &err,
                              "add an ellipsoid"))
        rig_panel_choose_part(self, RIG_NONE, index, RIG_NONE);
}

static void remove_proxy(rig_panel *self)
{
    error err = {""};
    rig *r = rig_panel_begin(self);
    if (r && rig_panel_finish(self, rig_edit_remove_proxy(r, self->parting.proxy, &err), &err,
                              "take out an ellipsoid"))
        rig_panel_choose_part(self, RIG_NONE, RIG_NONE, RIG_NONE);
}

static void set_proxy(rig_panel *self, const rig_proxy *to, const char *words)
{
    error err = {""};
    rig *r = rig_panel_begin(self);
    if (r)
        (void)rig_panel_finish(self, rig_edit_set_proxy(r, self->parting.proxy, to, &err), &err,
                               words);
}

static void draw_proxy(rig_panel *self, ui *on, const rig *r)
{
    rig_parting *parting = &self->parting;
    rig_proxy proxy = r->proxy[parting->proxy];
    const char *items[RIG_BONES_MAX];
    const double most = 0.5 * size_of(self);
    const uint64_t number = rig_model_number(self->model);
    for (uint32_t i = 0; i < r->bone_count; ++i)
        items[i] = r->bone[i].name;
    if (!parting->is_held) {
        parting->centre = proxy.centre;
        parting->radii = proxy.radii;
    }
    ui_id_begin(on, "proxy");
    bool is_held = draw_place(self, on, &parting->centre);
    is_held = draw_mm(on, "Wide", 1.0, most, &parting->radii.x) || is_held;
    is_held = draw_mm(on, "High", 1.0, most, &parting->radii.y) || is_held;
    is_held = draw_mm(on, "Deep", 1.0, most, &parting->radii.z) || is_held;
    parting->is_held = is_held;
    if (!is_held &&
        (!is_same(parting->centre, proxy.centre) || !is_same(parting->radii, proxy.radii))) {
        proxy.centre = parting->centre;
        proxy.radii = parting->radii;
        set_proxy(self, &proxy, "change an ellipsoid");
    } else if (ui_choice(on, "Rides on", RIG_PANEL_LABEL, items, r->bone_count, &proxy.bone)) {
        set_proxy(self, &proxy, "change what an ellipsoid rides on");
    }
    if (number == rig_model_number(self->model) && ui_button(on, "Take out", UI_PLAIN))
        remove_proxy(self);
    ui_id_end(on);
}

static void draw_proxies(rig_panel *self, ui *on)
{
    const rig *r = rig_model_rig(self->model);
    for (uint32_t i = 0; i < r->proxy_count; ++i) {
        char label[WORDS];
        const rig_proxy *proxy = &r->proxy[i];
        (void)snprintf(label, sizeof label, "%.60s, %.0f \u00d7 %.0f \u00d7 %.0f mm##proxy%u",
                       r->bone[proxy->bone].name, 2.0 * proxy->radii.x, 2.0 * proxy->radii.y,
                       2.0 * proxy->radii.z, i);
        if (ui_row(on, label, i == self->parting.proxy) != UI_ROW_NONE)
            rig_panel_choose_part(self, RIG_NONE, i == self->parting.proxy ? RIG_NONE : i,
                                  RIG_NONE);
    }
    if (r->proxy_count == 0)
        ui_text_wrapped(on, UI_STYLE_DIM, "None: skin may go into the skull.");
    if (self->parting.proxy != RIG_NONE)
        draw_proxy(self, on, r);
    if (ui_button(on, "Add an ellipsoid", UI_PLAIN))
        add_proxy(self);
    ui_hint(on, "Skin slides over it and does not enter it.");
}

/* ---- on the face ---- */

static uint32_t put_ring(overlay_item *out, vec3 centre, vec3 a, vec3 b)
{
    for (uint32_t i = 0; i < RING_STEPS; ++i) {
        overlay_item *line = &out[i];
        *line = (overlay_item){.kind = OVERLAY_LINE, .width_px = 1.5f};
        memcpy(line->rgba, ring_rgba, sizeof line->rgba);
        for (uint32_t end = 0; end < 2; ++end) {
            const double turn = 2.0 * ANGLE_PI * (double)(i + end) / RING_STEPS;
            const vec3 at =
                vec3_add(centre, vec3_add(vec3_scale(a, cos(turn)), vec3_scale(b, sin(turn))));
            float *to = end == 0 ? line->from : line->to;
            to[0] = (float)at.x;
            to[1] = (float)at.y;
            to[2] = (float)at.z;
        }
    }
    return RING_STEPS;
}

static uint32_t put_ellipsoid(overlay_item *out, vec3 centre, vec3 radii)
{
    const vec3 x = {radii.x, 0, 0}, y = {0, radii.y, 0}, z = {0, 0, radii.z};
    uint32_t count = put_ring(out, centre, x, y);
    count += put_ring(out + count, centre, y, z);
    count += put_ring(out + count, centre, z, x);
    for (uint32_t i = 0; i < 2; ++i) { /* the rim first */
        overlay_item dot = {.kind = OVERLAY_DOT, .width_px = i == 0 ? 11.0f : 8.0f};
        memcpy(dot.rgba, i == 0 ? rim_rgba : ring_rgba, sizeof dot.rgba);
        dot.from[0] = (float)centre.x;
        dot.from[1] = (float)centre.y;
        dot.from[2] = (float)centre.z;
        out[count++] = dot;
    }
    return count;
}

uint32_t rig_panel_part_items(const rig_panel *self, overlay_item *out, uint32_t capacity)
{
    const rig *r = rig_model_rig(self->model);
    const rig_parting *parting = &self->parting;
    const bool is_ball = parting->bone != RIG_NONE && parting->bone < r->bone_count &&
                         r->bone[parting->bone].kind == BONE_BALL;
    if (capacity < 3 * RING_STEPS + 2)
        return 0;
    if (is_ball) {
        const double radius = fmax(parting->radii.x, 1.0);
        return put_ellipsoid(out, parting->centre, (vec3){radius, radius, radius});
    }
    return parting->proxy != RIG_NONE && parting->proxy < r->proxy_count
               ? put_ellipsoid(out, parting->centre, parting->radii)
               : 0;
}

/* ---- */

void rig_panel_draw_parts(rig_panel *self, ui *on)
{
    if (ui_section(on, "Bones", true))
        draw_bones(self, on);
    if (ui_section(on, "What skin does not enter", true))
        draw_proxies(self, on);
    if (ui_section(on, "Poses", true))
        rig_panel_draw_poses(self, on);
}
