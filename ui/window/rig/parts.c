/* The tabs Parts and Jaw of the rig panel: bones, collision ellipsoids, poses, turns of a ball, jaw
 * and mouth. */
#include "window/rig/panel.h"

#include "face/rig_draft.h"
#include "face/rig/rig_poses.h"

#include "base/angle.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- turns of a ball: name, axis and limits, tried on the face ---- */

enum { UNDO_WORDS = 160, WAYS = 6, OWN_WAY = WAYS };
static const double degree = ANGLE_PI / 180.0;
static const char unit[] = "\xc2\xb0";

/* Effect of a positive angle, as mappings expect it (rigs/rig_format.md). */
static const struct {
    const char *words, *name;
    vec3 axis;
} ways[WAYS] = {{"to the subject's left", "yaw", {0, 1, 0}},
                {"to the subject's right", "turn", {0, -1, 0}},
                {"up", "pitch", {-1, 0, 0}},
                {"down", "close", {1, 0, 0}},
                {"rolls, its left side up", "roll", {0, 0, 1}},
                {"rolls, its left side down", "tilt", {0, 0, -1}}};
static const ui_range part_range = {-1.0, 1.0, "", 3, false, 0.0};

static bool is_same(vec3 a, vec3 b)
{
    return !(vec3_length(vec3_sub(a, b)) > 1e-9);
}

static uint32_t way_of(vec3 axis)
{
    for (uint32_t i = 0; i < WAYS; ++i)
        if (is_same(axis, ways[i].axis))
            return i;
    return OWN_WAY;
}

/* ---- changes ---- */

static void set_turn(panel *self, const rig_turn *to, const char *words)
{
    rig *r = rig_panel_begin(self);
    if (r)
        (void)rig_panel_finish(
            self, rig_edit_set_turn(r, self->parting.bone, self->parting.turn, to, &self->err),
            words);
}

static void choose_turn(panel *self, uint32_t turn)
{
    rig_parting *parting = &self->parting;
    parting->turn = turn;
    parting->is_turn_held = parting->has_own_axis = false;
    parting->turn_name.of = RIG_NONE;
    memset(parting->tried_rad, 0, sizeof parting->tried_rad);
    self->shown.is_shape_new = true;
}

static void remove_turn(panel *self)
{
    rig *r = rig_panel_begin(self);
    if (r && rig_panel_finish(
                 self, rig_edit_remove_turn(r, self->parting.bone, self->parting.turn, &self->err),
                 "remove a turn"))
        choose_turn(self, RIG_NONE);
}

static bool has_turn(const rig_bone *ball, const char *name)
{
    for (uint32_t i = 0; i < ball->turn_count; ++i)
        if (strcmp(ball->turn[i].name, name) == 0)
            return true;
    return false;
}

static bool has_axis(const rig_bone *ball, vec3 axis)
{
    for (uint32_t i = 0; i < ball->turn_count; ++i)
        if (is_same(ball->turn[i].axis, axis) || is_same(ball->turn[i].axis, vec3_scale(axis, -1)))
            return true;
    return false;
}

/* Adds the first turn of the list that the ball does not have. */
static void add_turn(panel *self, const rig_bone *ball)
{
    char name[RIG_PANEL_NAME];
    uint32_t way = 0, index = RIG_NONE;
    while (way < WAYS - 1 && has_axis(ball, ways[way].axis))
        way += 1;
    (void)snprintf(name, sizeof name, "%s", ways[way].name);
    for (uint32_t number = 2; has_turn(ball, name); ++number)
        (void)snprintf(name, sizeof name, "%s %u", ways[way].name, number);
    const rig_turn made = {name, ways[way].axis, -15.0 * degree, 15.0 * degree, {0}};
    rig *r = rig_panel_begin(self);
    if (r &&
        rig_panel_finish(self, rig_edit_add_turn(r, self->parting.bone, &made, &index, &self->err),
                         "add a turn"))
        choose_turn(self, index);
}

/* ---- one turn ---- */

static bool draw_angle(ui *on, const char *label, double low_deg, double high_deg, double usual_deg,
                       double *value_rad)
{
    const ui_range range = {low_deg, high_deg, unit, 0, false, usual_deg};
    double value_deg = *value_rad / degree;
    if (ui_slider(on, label, RIG_PANEL_LABEL, &range, &value_deg))
        *value_rad = value_deg * degree;
    return ui_slider_is_held(on);
}

/* Returns true while a slider is held. */
static bool draw_own_axis(ui *on, vec3 *axis)
{
    bool is_held = false;
    double *const part[3] = {&axis->x, &axis->y, &axis->z};
    static const char *const label[3] = {"Across##axis", "Up##axis", "Forward##axis"};
    for (int i = 0; i < 3; ++i) {
        (void)ui_slider(on, label[i], RIG_PANEL_LABEL, &part_range, part[i]);
        is_held = ui_slider_is_held(on) || is_held;
    }
    ui_hint(on, "Set the axis of the turn. Positive angles follow the right-hand rule.");
    return is_held;
}

static void draw_turn_try(panel *self, ui *on, const rig_turn *turn)
{
    double *tried_rad = &self->parting.tried_rad[self->parting.turn];
    const double before_rad = *tried_rad;
    *tried_rad = fmin(fmax(*tried_rad, turn->min_rad), turn->max_rad);
    (void)draw_angle(on, "Try", turn->min_rad / degree, turn->max_rad / degree, 0.0, tried_rad);
    ui_hint(on, "Try the turn on the face without changing the rig. Double-click to reset.");
    if (fabs(*tried_rad - before_rad) > 0.0)
        self->shown.is_shape_new = true;
}

static bool is_changed(const rig_turn *a, const rig_turn *b)
{
    return !is_same(a->axis, b->axis) || fabs(a->min_rad - b->min_rad) > 1e-9 ||
           fabs(a->max_rad - b->max_rad) > 1e-9;
}

/* Draws the axis: one of the list, or custom. Returns true while a slider is held. */
static bool draw_turn_axis(panel *self, ui *on, rig_turn *now)
{
    rig_parting *parting = &self->parting;
    const char *items[WAYS + 1];
    for (uint32_t i = 0; i < WAYS; ++i)
        items[i] = ways[i].words;
    items[OWN_WAY] = "about a custom axis";
    uint32_t way = parting->has_own_axis ? OWN_WAY : way_of(now->axis);
    if (ui_choice(on, "Turns", RIG_PANEL_LABEL, items, WAYS + 1, &way)) {
        parting->has_own_axis = way == OWN_WAY;
        if (way < WAYS)
            now->axis = ways[way].axis;
    }
    ui_hint(on, "Choose the effect of a positive angle. Mappings expect \"yaw\" to the left, "
                "\"pitch\" up and \"close\" to close a lid.");
    return way == OWN_WAY && draw_own_axis(on, &now->axis);
}

static void draw_turn(panel *self, ui *on, const rig_bone *ball)
{
    rig_parting *parting = &self->parting;
    const rig_turn *turn = &ball->turn[parting->turn];
    const uint64_t number = rig_model_number(self->model);
    rig_turn *now = &parting->turn_now;
    if (!parting->is_turn_held)
        *now = *turn;
    now->name = turn->name;
    ui_id_begin(on, "turn");
    if (rig_panel_draw_name(self, on, "name", &parting->turn_name,
                            parting->bone * RIG_TURNS_MAX + parting->turn, turn->name)) {
        rig_turn named = *turn;
        named.name = parting->turn_name.text;
        set_turn(self, &named, "name a turn");
    }
    if (number == rig_model_number(self->model)) {
        bool is_held = draw_turn_axis(self, on, now);
        is_held = draw_angle(on, "Minimum", -180.0, 0.0, 0.0, &now->min_rad) || is_held;
        is_held = draw_angle(on, "Maximum", 0.0, 180.0, 0.0, &now->max_rad) || is_held;
        parting->is_turn_held = is_held;
        draw_turn_try(self, on, now);
        if (!is_held && is_changed(now, turn))
            set_turn(self, now, "change a turn");
    }
    ui_disabled_begin(on, ball->turn_count == 1);
    if (number == rig_model_number(self->model) && ui_button(on, "Remove the turn", UI_PLAIN))
        remove_turn(self);
    ui_disabled_end(on);
    ui_id_end(on);
}

/* Draws the turns of a ball. */
static void draw_turns(panel *self, ui *on, uint32_t bone)
{
    const uint64_t number = rig_model_number(self->model);
    const rig_bone *ball = &rig_model_rig(self->model)->bone[bone];
    rig_parting *parting = &self->parting;
    if (parting->turn != RIG_NONE && parting->turn >= ball->turn_count)
        choose_turn(self, RIG_NONE);
    for (uint32_t i = 0; i < ball->turn_count; ++i) {
        char label[UNDO_WORDS];
        const rig_turn *turn = &ball->turn[i];
        (void)snprintf(label, sizeof label, "%.60s, %.4g%s to %.4g%s##turn%u", turn->name,
                       turn->min_rad / degree, unit, turn->max_rad / degree, unit, i);
        if (ui_row(on, label, i == parting->turn) != UI_ROW_NONE)
            choose_turn(self, i == parting->turn ? RIG_NONE : i);
    }
    if (parting->turn != RIG_NONE)
        draw_turn(self, on, ball);
    if (number != rig_model_number(self->model) || ball->turn_count >= RIG_TURNS_MAX)
        return;
    if (ui_button(on, "Add a turn", UI_PLAIN))
        add_turn(self, ball);
    ui_hint(on, "Add a turn to the bone. The first turn in the list is applied last.");
}

/* ---- poses: list, display, creation from the current shape ---- */

/* ---- display ---- */

bool rig_panel_show_pose(panel *self)
{
    error err;
    const rig_work *work = rig_model_work(self->model);
    const uint32_t pose = self->parting.pose;
    const csrbf_settings solver = app_view(self->of)->solver;
    if (pose == RIG_NONE || !work || !work->face || pose >= work->rig.pose_count ||
        !rig_model_is_laid(self->model) || !(solver.radius > 0.0))
        return false;
    if (rig_poses_show_on(work->face, &work->rig, pose, &solver, &err) < 0)
        return false;
    points_to_rows(self->shown.position, face_shown(work->face), face_order(work->face));
    face_reset(work->face); /* other users of the face expect neutral */
    return true;
}

/* ---- creation ---- */

static const char *free_pose_name(const rig *r, char out[RIG_PANEL_NAME])
{
    for (uint32_t number = 1;; ++number) {
        bool is_taken = false;
        (void)snprintf(out, RIG_PANEL_NAME, "pose %u", number);
        for (uint32_t i = 0; i < r->pose_count; ++i)
            is_taken = is_taken || strcmp(r->pose[i].name, out) == 0;
        if (!is_taken)
            return out;
    }
}

/* Returns why no pose can be added, or NULL. */
static const char *why_not(const panel *self)
{
    const rig_work *work = rig_model_work(self->model);
    const live_view *view = app_view(self->of);
    if (!work || !work->face || !rig_model_is_laid(self->model))
        return "Wait until the rig is applied to the face.";
    if (!view->about || view->contact_count != work->rig.contact_count)
        return "Wait until the stage uses this rig.";
    return NULL;
}

static void add_pose(panel *self)
{
    rig_pose made;
    char name[RIG_PANEL_NAME];
    uint32_t index = RIG_NONE;
    const rig_work *work = rig_model_work(self->model);
    const live_view *view = app_view(self->of);
    const csrbf_settings solver = app_view(self->of)->solver;
    mrt_result result = rig_poses_of(&made, free_pose_name(rig_model_rig(self->model), name),
                                     work->face, MRT_MAX_VECTORS, &work->rig, &solver,
                                     view->contact, view->meter.driven, &self->err);
    if (result < 0) {
        rig_panel_report(self, self->err.text);
        return;
    }
    rig *r = rig_panel_begin(self);
    if (r && rig_panel_finish(self, rig_edit_add_pose(r, &made, &index, &self->err), "add a pose"))
        rig_panel_choose_part(self, RIG_NONE, RIG_NONE, index);
    rig_pose_finish(&made);
}

static void remove_pose(panel *self)
{
    rig *r = rig_panel_begin(self);
    if (r && rig_panel_finish(self, rig_edit_remove_pose(r, self->parting.pose, &self->err),
                              "remove a pose"))
        rig_panel_choose_part(self, RIG_NONE, RIG_NONE, RIG_NONE);
}

static void name_pose(panel *self)
{
    rig *r = rig_panel_begin(self);
    if (r)
        (void)rig_panel_finish(
            self,
            rig_edit_name_pose(r, self->parting.pose, self->parting.pose_name.text, &self->err),
            "name a pose");
}

/* ---- drawing ---- */

static void draw_chosen(panel *self, ui *on, const rig *r)
{
    char words[UNDO_WORDS];
    const uint32_t index = self->parting.pose;
    const rig_pose *pose = &r->pose[index];
    const uint64_t number = rig_model_number(self->model);
    ui_id_begin(on, "pose");
    const char *part = rig_pose_part_name[pose->part];
    (void)snprintf(words, sizeof words, "%s%s%u pulls, %u turns", part ? part : "",
                   part ? ": " : "", pose->pull_count, pose->dof_count);
    if (rig_panel_draw_name(self, on, "name", &self->parting.pose_name, index, pose->name))
        name_pose(self);
    ui_fact(on, "Contents", RIG_PANEL_LABEL, UI_STYLE_BODY, words);
    if (number == rig_model_number(self->model) && ui_button(on, "Remove", UI_PLAIN))
        remove_pose(self);
    ui_id_end(on);
}

static void draw_poses(panel *self, ui *on)
{
    const char *why = why_not(self);
    ui_disabled_begin(on, why != NULL);
    if (ui_button(on, "Add current shape", UI_PLAIN))
        add_pose(self);
    ui_disabled_end(on);
    ui_hint(on, why ? why : "Save the current bones and contacts of the stage as a pose.");
    if (self->parting.pose != RIG_NONE)
        draw_chosen(self, on, rig_model_rig(self->model));
    const rig *r = rig_model_rig(self->model);
    for (uint32_t i = 0; i < r->pose_count; ++i) {
        char label[UNDO_WORDS];
        (void)snprintf(label, sizeof label, "%s##pose%u", r->pose[i].name, i);
        if (ui_row(on, label, i == self->parting.pose) != UI_ROW_NONE)
            rig_panel_choose_part(self, RIG_NONE, RIG_NONE, i == self->parting.pose ? RIG_NONE : i);
    }
    if (r->pose_count == 0)
        ui_text_wrapped(on, UI_STYLE_DIM, "No poses yet.");
}

/* ---- bones, ellipsoids, poses: the tab ---- */

enum { RING_STEPS = 32 };
static const float removes_at = 238.0f;
static const float ring_rgba[4] = {0.95f, 0.75f, 0.45f, 0.95f};
static const float rim_rgba[4] = {0.06f, 0.06f, 0.07f, 0.9f};
static const char *const kind_words[] = {
    [BONE_FIXED] = "rigid part", [BONE_JAW] = "jaw", [BONE_BALL] = "ball"};
static const char *const kind_items[] = {"a rigid part", "a jaw, with a hinge",
                                         "a ball, like an eye"};

/* ---- selection ---- */

void rig_panel_choose_part(panel *self, uint32_t bone, uint32_t proxy, uint32_t pose)
{
    rig_parting *parting = &self->parting;
    parting->bone = bone;
    parting->proxy = proxy;
    parting->pose = pose;
    parting->is_held = false;
    parting->bone_name.of = parting->pose_name.of = RIG_NONE;
    choose_turn(self, RIG_NONE);
    self->shown.is_shape_new = true;
}

void rig_panel_keep_part(panel *self)
{
    const rig *r = rig_model_rig(self->model);
    const rig_parting *now = &self->parting;
    const uint32_t bone = r && now->bone < r->bone_count ? now->bone : RIG_NONE,
                   proxy = r && now->proxy < r->proxy_count ? now->proxy : RIG_NONE,
                   pose = r && now->pose < r->pose_count ? now->pose : RIG_NONE;
    if (bone != now->bone || proxy != now->proxy || pose != now->pose)
        rig_panel_choose_part(self, bone, proxy, pose);
}

/* ---- positions: sliders that make an undo step when released ---- */

typedef struct bounds {
    vec3 low, high;
} bounds;

static bounds bounds_of(const panel *self)
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

static bool draw_position(const panel *self, ui *on, vec3 *at)
{
    const bounds b = bounds_of(self);
    bool is_held = draw_mm(on, "Across", b.low.x, b.high.x, &at->x);
    is_held = draw_mm(on, "Up", b.low.y, b.high.y, &at->y) || is_held;
    return draw_mm(on, "Forward", b.low.z, b.high.z, &at->z) || is_held;
}

static double size_of(const panel *self)
{
    const bounds b = bounds_of(self);
    return vec3_length(vec3_sub(b.high, b.low));
}

/* ---- bones ---- */

static void list_bones(panel *self, ui *on, const rig *r)
{
    for (uint32_t i = 0; i < r->bone_count; ++i) {
        char label[UNDO_WORDS];
        (void)snprintf(label, sizeof label, "%s##bone%u", r->bone[i].name, i);
        ui_width(on, -96.0f);
        if (ui_row(on, label, i == self->parting.bone) != UI_ROW_NONE)
            rig_panel_choose_part(self, i == self->parting.bone ? RIG_NONE : i, RIG_NONE, RIG_NONE);
        rig_panel_write_right(on, kind_words[r->bone[i].kind]);
    }
}

static const char *free_bone_name(const rig *r, rig_bone_kind kind, char out[RIG_PANEL_NAME])
{
    static const char *const base[] = {
        [BONE_FIXED] = "part", [BONE_JAW] = "jaw", [BONE_BALL] = "eye"};
    (void)snprintf(out, RIG_PANEL_NAME, "%s", base[kind]);
    for (uint32_t number = 2; rig_find_bone(r, out) != RIG_NONE; ++number)
        (void)snprintf(out, RIG_PANEL_NAME, "%s %u", base[kind], number);
    return out;
}

/* Adds a bone where it can be seen and dragged: a jaw in front of the ears, a ball in the middle.
 */
static void add_bone(panel *self)
{
    char name[RIG_PANEL_NAME];
    uint32_t index = RIG_NONE;
    const bounds b = bounds_of(self);
    const rig_bone_kind kind = (rig_bone_kind)self->parting.kind;
    const double wide = b.high.x - b.low.x;
    const double half_mm = kind == BONE_JAW ? 0.35 * wide : 0.08 * wide;
    rig *r = rig_panel_begin(self);
    if (!r)
        return;
    mrt_result result = rig_edit_add_bone(r, free_bone_name(r, kind, name), kind, middle_of(&b),
                                          fmax(half_mm, 1.0), &index, &self->err);
    if (rig_panel_finish(self, result, "add a bone"))
        rig_panel_choose_part(self, index, RIG_NONE, RIG_NONE);
}

static void remove_bone(panel *self)
{
    rig *r = rig_panel_begin(self);
    if (r && rig_panel_finish(self, rig_edit_remove_bone(r, self->parting.bone, &self->err),
                              "remove a bone"))
        rig_panel_choose_part(self, RIG_NONE, RIG_NONE, RIG_NONE);
}

static void name_bone(panel *self)
{
    rig *r = rig_panel_begin(self);
    if (r)
        (void)rig_panel_finish(
            self,
            rig_edit_name_bone(r, self->parting.bone, self->parting.bone_name.text, &self->err),
            "name a bone");
}

static void draw_ball(panel *self, ui *on, const rig_bone *bone)
{
    rig_parting *parting = &self->parting;
    if (!parting->is_held) {
        parting->centre = bone->centre;
        parting->radii = (vec3){bone->radius_mm, 0.0, 0.0};
    }
    bool is_held = draw_position(self, on, &parting->centre);
    is_held = draw_mm(on, "Radius", 1.0, 0.3 * size_of(self), &parting->radii.x) || is_held;
    const vec3 radius = {bone->radius_mm, 0.0, 0.0};
    parting->is_held = is_held;
    if (is_held || (is_same(parting->centre, bone->centre) && is_same(parting->radii, radius)))
        return;
    rig *r = rig_panel_begin(self);
    if (r)
        (void)rig_panel_finish(
            self,
            rig_edit_set_ball(r, parting->bone, parting->centre, parting->radii.x, &self->err),
            "move a ball");
}

/* ---- springs of loose parts ---- */

static const ui_range frequency_range = {RIG_SPRING_LEAST_HZ, 10.0, "Hz", 1, false, RIG_SPRING_HZ};
static const ui_range damping_range = {RIG_SPRING_LEAST_DAMPED, 2.0, "", 2, false,
                                       RIG_SPRING_DAMPING};
static const ui_range inertia_range = {0.0, 100.0, "%", 0, false, 50.0};
static const ui_range weight_range = {0.0, 100.0, "%", 0, false, 0.0};

static void set_spring(panel *self, const rig_spring *to, const char *words)
{
    rig *r = rig_panel_begin(self);
    if (r)
        (void)rig_panel_finish(self, rig_edit_set_spring(r, self->parting.bone, to, &self->err),
                               words);
}

static bool is_same_spring(const rig_spring *a, const rig_spring *b)
{
    return is_same(a->tip, b->tip) && !(fabs(a->frequency_hz - b->frequency_hz) > 1e-9) &&
           !(fabs(a->damping - b->damping) > 1e-9) && !(fabs(a->inertia - b->inertia) > 1e-9) &&
           !(fabs(a->gravity - b->gravity) > 1e-9) && !(fabs(a->radius_mm - b->radius_mm) > 1e-9);
}

static bool draw_spring_number(ui *on, const char *label, const ui_range *range, double *value)
{
    (void)ui_slider(on, label, RIG_PANEL_LABEL, range, value);
    return ui_slider_is_held(on);
}

static void draw_spring_values(panel *self, ui *on, const rig_bone *bone)
{
    rig_parting *parting = &self->parting;
    if (!parting->is_spring_held)
        parting->spring = bone->spring;
    rig_spring *now = &parting->spring;
    double inertia = 100.0 * now->inertia, weight = 100.0 * now->gravity;
    bool is_held = draw_spring_number(on, "Frequency", &frequency_range, &now->frequency_hz);
    ui_hint(on, "Set how often the part swings a second. A higher value is stiffer.");
    is_held = draw_spring_number(on, "Damping", &damping_range, &now->damping) || is_held;
    ui_hint(on, "Set how soon the swing ends. At 1 the part returns without swinging on.");
    is_held = draw_spring_number(on, "Inertia", &inertia_range, &inertia) || is_held;
    ui_hint(on, "Set how far the part stays behind when the head moves.");
    is_held = draw_spring_number(on, "Gravity", &weight_range, &weight) || is_held;
    ui_hint(on, "Set how far the part hangs down when the head tilts.");
    ui_text(on, UI_STYLE_DIM, "Middle of its mass");
    ui_id_begin(on, "tip");
    is_held = draw_position(self, on, &now->tip) || is_held;
    is_held = draw_mm(on, "Thickness", 0.0, 0.1 * size_of(self), &now->radius_mm) || is_held;
    ui_hint(on, "Set the distance that the part keeps from collision shapes.");
    ui_id_end(on);
    now->inertia = inertia / 100.0;
    now->gravity = weight / 100.0;
    parting->is_spring_held = is_held;
    if (!is_held && !is_same_spring(now, &bone->spring))
        set_spring(self, now, "change a spring");
}

static void draw_spring(panel *self, ui *on, const rig_bone *bone)
{
    const uint64_t number = rig_model_number(self->model);
    bool swings = bone->spring.frequency_hz > 0.0;
    ui_id_begin(on, "spring");
    if (ui_check(on, "Swings", &swings)) {
        const rig_spring made = {.tip =
                                     vec3_add(bone->centre, (vec3){0.0, 0.1 * size_of(self), 0.0}),
                                 .frequency_hz = RIG_SPRING_HZ,
                                 .damping = RIG_SPRING_DAMPING,
                                 .inertia = 0.5};
        const rig_spring none = {.frequency_hz = 0.0};
        self->parting.is_spring_held = false;
        set_spring(self, swings ? &made : &none, swings ? "let a part swing" : "hold a part still");
    }
    ui_hint(on, "Let this part swing when the head moves. Its turns set how far.");
    if (number == rig_model_number(self->model) && bone->spring.frequency_hz > 0.0)
        draw_spring_values(self, on, bone);
    ui_id_end(on);
}

/* Draws the switch that holds all loose parts still. */
static void draw_still(panel *self, ui *on, const rig *r)
{
    bool any = false, is_still = !(r->springs > 0.0);
    for (uint32_t i = 0; i < r->bone_count; ++i)
        any |= r->bone[i].spring.frequency_hz > 0.0;
    if (!any)
        return;
    if (ui_check(on, "Hold loose parts still", &is_still)) {
        rig *to = rig_panel_begin(self);
        if (to)
            (void)rig_panel_finish(self, rig_edit_set_springs(to, is_still ? 0.0 : 1.0, &self->err),
                                   is_still ? "hold loose parts still" : "let loose parts swing");
    }
    ui_hint(on, "Stop all loose parts of this rig from swinging.");
}

static bool has_region(const rig *r, uint32_t bone)
{
    for (uint32_t i = 0; i < r->region_count; ++i)
        if (r->region[i].bone == bone)
            return true;
    return false;
}

static void add_region(panel *self)
{
    uint32_t index = RIG_NONE;
    const rig_edit_region_values says = {self->parting.bone, false, 1.0, (double)NAN};
    rig *r = rig_panel_begin(self);
    if (r && rig_panel_finish(self, rig_edit_add_region(r, NULL, &says, &index, &self->err),
                              "add a region"))
        rig_panel_choose(self, RIG_TAB_REGIONS, index);
}

static void draw_what_rides(panel *self, ui *on)
{
    ui_text_wrapped(
        on, UI_STYLE_WARNING,
        "No region moves with this bone. The stage uses the previous rig until one does.");
    if (ui_button(on, "Add a region for it", UI_ACCENT))
        add_region(self);
    ui_hint(on, "Add a region for this bone, then paint it in the tab \"Regions\".");
}

/* Draws the choice of the parent, which must be listed before the bone. */
static void draw_parent(panel *self, ui *on, const rig *r)
{
    const char *items[RIG_BONES_MAX + 1];
    const uint32_t index = self->parting.bone, nothing = index;
    const uint32_t before = r->bone[index].parent == RIG_NONE ? nothing : r->bone[index].parent;
    uint32_t chosen = before;
    for (uint32_t i = 0; i < index; ++i)
        items[i] = r->bone[i].name;
    items[nothing] = "nothing";
    if (!ui_choice(on, "Parent", RIG_PANEL_LABEL, items, index + 1, &chosen) || chosen == before)
        return;
    rig *to = rig_panel_begin(self);
    if (to)
        (void)rig_panel_finish(
            self, rig_edit_set_parent(to, index, chosen == nothing ? RIG_NONE : chosen, &self->err),
            "change the parent of a bone");
}

static void draw_bone(panel *self, ui *on, const rig *r)
{
    const uint32_t index = self->parting.bone;
    const rig_bone *bone = &r->bone[index];
    const uint64_t number = rig_model_number(self->model);
    const bool stays = index == 0 || strcmp(bone->name, "skull") == 0;
    ui_id_begin(on, "bone");
    ui_disabled_begin(on, stays);
    if (rig_panel_draw_name(self, on, "name", &self->parting.bone_name, index, bone->name))
        name_bone(self);
    ui_disabled_end(on);
    if (number == rig_model_number(self->model) && !stays)
        draw_parent(self, on, r);
    if (number == rig_model_number(self->model) && !has_region(r, index))
        draw_what_rides(self, on);
    if (number == rig_model_number(self->model) && bone->kind == BONE_BALL)
        draw_ball(self, on, bone);
    if (number == rig_model_number(self->model) && bone->kind == BONE_BALL)
        draw_turns(self, on, index);
    if (number == rig_model_number(self->model) && bone->kind == BONE_BALL && !stays)
        draw_spring(self, on, bone);
    if (number == rig_model_number(self->model) && bone->kind == BONE_JAW)
        ui_text_wrapped(on, UI_STYLE_DIM, "Drag the axis of this bone in the tab \"Jaw\".");
    ui_disabled_begin(on, stays);
    if (number == rig_model_number(self->model) && ui_button(on, "Remove", UI_PLAIN))
        remove_bone(self);
    ui_disabled_end(on);
    ui_hint(on, stays ? "This bone carries the face and cannot be removed."
                      : "Remove the bone. Its parts move with its parent bone.");
    ui_id_end(on);
}

static void draw_bones(panel *self, ui *on)
{
    list_bones(self, on, rig_model_rig(self->model));
    if (self->parting.bone != RIG_NONE)
        draw_bone(self, on, rig_model_rig(self->model));
    draw_still(self, on, rig_model_rig(self->model));
    ui_width(on, -(RIG_PANEL_RIGHT - removes_at + 16.0f));
    (void)ui_choice(on, "New", RIG_PANEL_LABEL, kind_items, 3, &self->parting.kind);
    ui_hint(on, "Choose the kind of bone to add.");
    ui_same_line(on);
    ui_at(on, removes_at);
    if (ui_button(on, "Add##bone", UI_PLAIN))
        add_bone(self);
    ui_hint(on, "Add a bone. Regions define which vertices move with it.");
}

/* ---- ellipsoids ---- */

static void add_proxy(panel *self)
{
    uint32_t index = RIG_NONE;
    const bounds b = bounds_of(self);
    const vec3 half = vec3_scale(vec3_sub(b.high, b.low), 0.5);
    const rig_proxy made = {
        .bone = 0,
        .centre = middle_of(&b),
        .radii = {fmax(0.6 * half.x, 1.0), fmax(0.6 * half.y, 1.0), fmax(0.6 * half.z, 1.0)}};
    rig *r = rig_panel_begin(self);
    if (r && rig_panel_finish(self, rig_edit_add_proxy(r, &made, &index, &self->err),
                              "add an ellipsoid"))
        rig_panel_choose_part(self, RIG_NONE, index, RIG_NONE);
}

static void remove_proxy(panel *self)
{
    rig *r = rig_panel_begin(self);
    if (r && rig_panel_finish(self, rig_edit_remove_proxy(r, self->parting.proxy, &self->err),
                              "remove an ellipsoid"))
        rig_panel_choose_part(self, RIG_NONE, RIG_NONE, RIG_NONE);
}

static void set_proxy(panel *self, const rig_proxy *to, const char *words)
{
    rig *r = rig_panel_begin(self);
    if (r)
        (void)rig_panel_finish(self, rig_edit_set_proxy(r, self->parting.proxy, to, &self->err),
                               words);
}

static void draw_proxy(panel *self, ui *on, const rig *r)
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
    bool is_held = draw_position(self, on, &parting->centre);
    is_held = draw_mm(on, "Width", 1.0, most, &parting->radii.x) || is_held;
    is_held = draw_mm(on, "Height", 1.0, most, &parting->radii.y) || is_held;
    is_held = draw_mm(on, "Depth", 1.0, most, &parting->radii.z) || is_held;
    parting->is_held = is_held;
    if (!is_held &&
        (!is_same(parting->centre, proxy.centre) || !is_same(parting->radii, proxy.radii))) {
        proxy.centre = parting->centre;
        proxy.radii = parting->radii;
        set_proxy(self, &proxy, "change an ellipsoid");
    } else if (ui_choice(on, "Bone", RIG_PANEL_LABEL, items, r->bone_count, &proxy.bone)) {
        set_proxy(self, &proxy, "change the bone of an ellipsoid");
    }
    if (number == rig_model_number(self->model) && ui_button(on, "Remove", UI_PLAIN))
        remove_proxy(self);
    ui_id_end(on);
}

static void draw_proxies(panel *self, ui *on)
{
    const rig *r = rig_model_rig(self->model);
    for (uint32_t i = 0; i < r->proxy_count; ++i) {
        char label[UNDO_WORDS];
        const rig_proxy *proxy = &r->proxy[i];
        (void)snprintf(label, sizeof label, "%.60s%s, %.0f \u00d7 %.0f \u00d7 %.0f mm##proxy%u",
                       r->bone[proxy->bone].name, proxy->kind == PROXY_TEETH ? ", teeth" : "",
                       2.0 * proxy->radii.x, 2.0 * proxy->radii.y, 2.0 * proxy->radii.z, i);
        if (ui_row(on, label, i == self->parting.proxy) != UI_ROW_NONE)
            rig_panel_choose_part(self, RIG_NONE, i == self->parting.proxy ? RIG_NONE : i,
                                  RIG_NONE);
    }
    if (r->proxy_count == 0)
        ui_text_wrapped(on, UI_STYLE_DIM, "No collision shapes. Skin can enter the skull.");
    if (self->parting.proxy != RIG_NONE)
        draw_proxy(self, on, r);
    if (ui_button(on, "Add an ellipsoid", UI_PLAIN))
        add_proxy(self);
    ui_hint(on, "Add an ellipsoid that the skin slides over and cannot enter.");
}

/* ---- on the face ---- */

static uint32_t put_ring(overlay_item *out, vec3 centre, vec3 a, vec3 b)
{
    vec3 from = vec3_add(centre, a);
    for (uint32_t i = 0; i < RING_STEPS; ++i) {
        const double turn = 2.0 * ANGLE_PI * (double)(i + 1) / RING_STEPS;
        const vec3 to =
            vec3_add(centre, vec3_add(vec3_scale(a, cos(turn)), vec3_scale(b, sin(turn))));
        out[i] = overlay_line(from, to, 1.5f, ring_rgba);
        from = to;
    }
    return RING_STEPS;
}

static uint32_t put_ellipsoid(overlay_item *out, vec3 centre, vec3 radii)
{
    const vec3 x = {radii.x, 0, 0}, y = {0, radii.y, 0}, z = {0, 0, radii.z};
    uint32_t count = put_ring(out, centre, x, y);
    count += put_ring(out + count, centre, y, z);
    count += put_ring(out + count, centre, z, x);
    out[count++] = overlay_dot(centre, 11.0f, rim_rgba); /* the rim is drawn first */
    out[count++] = overlay_dot(centre, 8.0f, ring_rgba);
    return count;
}

uint32_t rig_panel_part_items(const panel *self, overlay_item *out, uint32_t capacity)
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

void rig_panel_draw_parts(panel *self, ui *on)
{
    if (ui_section(on, "Bones", true))
        draw_bones(self, on);
    if (ui_section(on, "Collision shapes", true))
        draw_proxies(self, on);
    if (ui_section(on, "Poses", true))
        draw_poses(self, on);
}

/* ---- the jaw: its axis and limits, tried on the face ---- */

static const ui_range close_range = {-20.0, 0.0, "\xc2\xb0", 0, false, 0.0};
static const ui_range open_range = {5.0, 60.0, "\xc2\xb0", 0, false, 32.0};
static const ui_range lateral_range = {0.0, 30.0, "mm", 1, false, 10.0};
static const ui_range forward_range = {0.0, 30.0, "mm", 1, false, 8.0};
static const ui_range percent_range = {0.0, 100.0, "%", 0, false, 0.0};
static const ui_range sticky_range = {0.0, RIG_STICKINESS_MOST_MM, "mm", 1, false, 0.0};
static const ui_range slide_range = {0.0, 30.0, "mm", 1, false, 12.0};

/* Returns true while the slider is held or was changed in this frame. */
static bool draw_number(ui *on, const char *label, const ui_range *range, double *value)
{
    bool has_changed = ui_slider(on, label, RIG_PANEL_LABEL, range, value);
    return has_changed || ui_slider_is_held(on);
}

static void draw_limits(panel *self, ui *on)
{
    rig_jawing *jawing = &self->jawing;
    double open_deg = jawing->jaw.open_max_rad / degree;
    double close_deg = jawing->jaw.open_min_rad / degree;
    bool was_changing = jawing->is_changing, is_held = false;
    ui_text(on, UI_STYLE_TITLE, "Limits");
    if (draw_number(on, "Opens", &open_range, &open_deg)) {
        jawing->jaw.open_max_rad = open_deg * degree;
        is_held = true;
    }
    if (draw_number(on, "Closes", &close_range, &close_deg)) {
        jawing->jaw.open_min_rad = close_deg * degree;
        is_held = true;
    }
    ui_hint(on, "Set how far the jaw closes beyond the mesh. Use it if the mouth of the mesh is "
                "slightly open.");
    is_held = draw_number(on, "Sideways", &lateral_range, &jawing->jaw.lateral_mm) || is_held;
    is_held = draw_number(on, "Forward", &forward_range, &jawing->jaw.forward_mm) || is_held;
    is_held = draw_number(on, "Slides", &slide_range, &jawing->jaw.slide_mm) || is_held;
    ui_hint(on, "Set how far the jaw joints move forward and down while the jaw opens.");
    if (jawing->held != RIG_HANDLES)
        return;
    jawing->is_changing = is_held;
    if (was_changing && !is_held)
        rig_panel_commit_jaw(self);
}

static void draw_jaw_point(ui *on, const char *label, vec3 at)
{
    char text[64];
    (void)snprintf(text, sizeof text, "%.1f  %.1f  %.1f mm", at.x, at.y, at.z);
    ui_fact(on, label, RIG_PANEL_LABEL, UI_STYLE_NUMBER, text);
}

static void draw_jaw_axis(panel *self, ui *on)
{
    rig_edit_jaw *jaw = &self->jawing.jaw;
    bool has_incisor = jaw->has_incisor;
    ui_text(on, UI_STYLE_TITLE, "Axis");
    ui_text_wrapped(on, UI_STYLE_DIM,
                    "Drag the balls on the face: the two joints in front of the ears, and the edge "
                    "of the lower front teeth.");
    draw_jaw_point(on, "Left", jaw->left);
    draw_jaw_point(on, "Right", jaw->right);
    if (jaw->has_incisor)
        draw_jaw_point(on, "Teeth", jaw->incisor);
    (void)ui_check(on, "Both sides##jaw", &self->is_even);
    if (!ui_check(on, "Place the teeth by hand", &has_incisor))
        return;
    if (has_incisor) {
        const rig_work *work = rig_model_work(self->model);
        jaw->incisor = work && work->face ? face_bones(work->face)->incisor : jaw->incisor;
    }
    jaw->has_incisor = has_incisor;
    rig_panel_commit_jaw(self);
}

static void draw_jaw_try(panel *self, ui *on)
{
    rig_jawing *jawing = &self->jawing;
    ui_range open = {jawing->jaw.open_min_rad / degree,
                     jawing->jaw.open_max_rad / degree,
                     "\xc2\xb0",
                     0,
                     false,
                     0.0};
    ui_range aside = {-jawing->jaw.lateral_mm, jawing->jaw.lateral_mm, "mm", 1, false, 0.0};
    ui_range forward = {0.0, jawing->jaw.forward_mm, "mm", 1, false, 0.0};
    char text[64];
    bool is_new = false;
    ui_text(on, UI_STYLE_TITLE, "Try");
    is_new = ui_slider(on, "Open##try", RIG_PANEL_LABEL, &open, &jawing->open_deg) || is_new;
    if (aside.max > 0.0)
        is_new =
            ui_slider(on, "Sideways##try", RIG_PANEL_LABEL, &aside, &jawing->aside_mm) || is_new;
    if (forward.max > 0.0)
        is_new =
            ui_slider(on, "Forward##try", RIG_PANEL_LABEL, &forward, &jawing->forward_mm) || is_new;
    if (rig_model_rig(self->model)->mouth.upper)
        is_new = ui_slider(on, "Sealed##try", RIG_PANEL_LABEL, &percent_range,
                           &self->mouthing.sealed_percent) ||
                 is_new;
    (void)snprintf(text, sizeof text, "%.0f mm", jawing->gap_mm);
    ui_fact(on, "Gap", RIG_PANEL_LABEL, UI_STYLE_NUMBER, text);
    if (ui_button(on, "Reset##try", UI_PLAIN)) {
        jawing->open_deg = jawing->aside_mm = jawing->forward_mm = 0.0;
        self->mouthing.sealed_percent = 0.0;
        is_new = true;
    }
    if (is_new)
        self->shown.is_shape_new = true;
}

/* ---- the mouth ---- */

static void set_mouth(panel *self, const rig_mouth *mouth, const char *words)
{
    rig *r = rig_panel_begin(self);
    if (r)
        (void)rig_panel_finish(self, rig_edit_set_mouth(r, mouth, &self->err), words);
}

/* Finds the rims of the mouth and keeps the seal settings. */
static void find_rims(panel *self)
{
    char why_not[BIND_FAULT], words[sizeof(error) + 64];
    error err = {""};
    rig_mouth found, next = rig_model_rig(self->model)->mouth;
    mrt_result result = rig_draft_rims(&found, why_not, rig_model_mesh(self->model),
                                       rig_model_topology(self->model), &err);
    if (result < 0 || !found.upper) {
        (void)snprintf(words, sizeof words, "Cannot find the rims of the mouth: %s.",
                       result < 0 ? err.text : why_not);
        rig_panel_report(self, words);
        return;
    }
    if (!next.upper || next.fault)
        next = (rig_mouth){.upper_share = RIG_UPPER_SHARE};
    next.upper = found.upper;
    next.lower = found.lower;
    next.upper_count = found.upper_count;
    next.lower_count = found.lower_count;
    set_mouth(self, &next, "find the rims of the mouth");
    free(found.upper);
    free(found.lower);
}

static void remove_mouth(panel *self)
{
    rig *r = rig_panel_begin(self);
    if (!r)
        return;
    rig_edit_remove_mouth(r);
    (void)rig_panel_finish(self, MRT_OK, "remove the mouth");
}

/* Draws the seal settings. A slider makes an undo step when released. */
static void draw_sealing(panel *self, ui *on, const rig_mouth *mouth)
{
    static const char *const from_items[] = {"the corners", "the middle"};
    rig_mouthing *shown = &self->mouthing;
    rig_mouth next = *mouth;
    uint32_t from = (uint32_t)mouth->seal_from;
    if (!shown->is_held) {
        shown->upper_percent = 100.0 * mouth->upper_share;
        shown->stickiness_mm = mouth->stickiness_mm;
    }
    const double upper_percent = shown->upper_percent, stickiness_mm = shown->stickiness_mm;
    const bool was_held = shown->is_held;
    bool is_held = draw_number(on, "Upper lip", &percent_range, &shown->upper_percent);
    ui_hint(on, "Set the share of the closing movement that the upper lip makes.");
    is_held = draw_number(on, "Stickiness", &sticky_range, &shown->stickiness_mm) || is_held;
    ui_hint(on, "Set the distance below which the lips stick together.");
    bool is_changed = was_held || shown->upper_percent < upper_percent ||
                      shown->upper_percent > upper_percent ||
                      shown->stickiness_mm < stickiness_mm || shown->stickiness_mm > stickiness_mm;
    shown->is_held = is_held;
    next.upper_share = shown->upper_percent / 100.0;
    next.stickiness_mm = shown->stickiness_mm;
    if (is_changed && !is_held) {
        set_mouth(self, &next, "change the closing of the lips");
    } else if (!is_held && ui_choice(on, "Starts at", RIG_PANEL_LABEL, from_items, 2, &from)) {
        next.seal_from = (rig_seal_from)from;
        set_mouth(self, &next, "change where the lips close first");
    }
}

static void draw_mouth(panel *self, ui *on)
{
    const rig_mouth *mouth = &rig_model_rig(self->model)->mouth;
    const rig_work *work = rig_model_work(self->model);
    const bool is_declared = mouth->upper != NULL;
    char text[96];
    ui_text(on, UI_STYLE_TITLE, "Mouth");
    if (!is_declared)
        ui_text_wrapped(on, UI_STYLE_DIM, "The mouth has no rims, so the lips cannot be sealed.");
    if (is_declared && !mouth->fault) {
        (void)snprintf(text, sizeof text, "%u and %u vertices", mouth->upper_count,
                       mouth->lower_count);
        ui_fact(on, "Rims", RIG_PANEL_LABEL, UI_STYLE_NUMBER, text);
    }
    if (is_declared && work && work->face && face_binding(work->face)->lips.why_not[0])
        ui_text_wrapped(on, UI_STYLE_WARNING, face_binding(work->face)->lips.why_not);
    const uint64_t number = rig_model_number(self->model);
    if (is_declared && !mouth->fault)
        draw_sealing(self, on, mouth);
    if (number != rig_model_number(self->model))
        return;
    if (ui_button(on, "Find the rims", UI_PLAIN)) {
        find_rims(self);
        return;
    }
    ui_hint(on, "Find the slit between the lips on the neutral face.");
    ui_same_line(on);
    ui_disabled_begin(on, !is_declared);
    if (ui_button(on, "Remove##mouth", UI_PLAIN))
        remove_mouth(self);
    ui_disabled_end(on);
}

/* ---- */

void rig_panel_draw_jaw(panel *self, ui *on)
{
    const rig *r = rig_model_rig(self->model);
    uint32_t jaw = rig_find_jaw(r);
    if (jaw == RIG_NONE) {
        ui_text_wrapped(on, UI_STYLE_DIM, "This rig has no jaw. None of its bones has a hinge.");
        ui_rule(on);
        draw_mouth(self, on);
        return;
    }
    if (!self->jawing.is_changing)
        rig_edit_jaw_of(&self->jawing.jaw, r, jaw);
    draw_jaw_try(self, on);
    ui_rule(on);
    draw_limits(self, on);
    ui_rule(on);
    draw_jaw_axis(self, on);
    ui_rule(on);
    draw_mouth(self, on);
}
