#include "window/viewport_inside.h"

#include <math.h>
#include <string.h>

static const float reach_points = 14.0f;        /* of the pointer around a contact's dot */
static const float notch_share = 1.0f / 120.0f; /* of the face's height: towards the viewer */
static const double radius_step = 1.12, radius_least_mm = 4.0, radius_most_share = 0.8;
static const double radius_shown_for_s = 1.5;
static const char radius_key[] = "viewport.pointer_radius_mm";

static const live_view *view_of(const viewport *self)
{
    return studio_view(self->of);
}

static bool is_mirrored(const viewport *self)
{
    return studio_looks_of(self->of)->is_mirrored;
}

static float face_height(const viewport *self)
{
    return fmaxf(self->high[1] - self->low[1], 1.0f);
}

double viewport_radius_mm(const viewport *self)
{
    double rigs = view_of(self)->solver.radius;
    return self->radius_mm > 0.0 ? self->radius_mm
           : rigs > 0.0          ? rigs
                                 : 0.25 * (double)face_height(self);
}

/* ---- places ---- */

bool viewport_to_points(const viewport *self, const float at[3], float *out_x, float *out_y)
{
    float px[2];
    if (!draw_project(px, &self->camera.now, self->rectangle, at))
        return false;
    float x = px[0] / self->px_per_point;
    *out_x = is_mirrored(self) ? self->where.width - x : x;
    *out_y = px[1] / self->px_per_point;
    return true;
}

static void take_pixel(viewport *self, const ui_canvas *canvas)
{
    float x = is_mirrored(self) ? self->where.width - canvas->x : canvas->x;
    self->pointer_px[0] = x * self->px_per_point;
    self->pointer_px[1] = canvas->y * self->px_per_point;
}

static uint32_t contact_count(const viewport *self)
{
    const live_view *view = view_of(self);
    uint32_t of_rig = self->face.rig ? self->face.rig->contact_count : 0;
    return view->about && view->contact_count < of_rig ? view->contact_count : of_rig;
}

void viewport_contact_at(const viewport *self, uint32_t contact, float out[3])
{
    memcpy(out, self->shape + (size_t)self->face.rig->contact[contact].vertex * 3, 3 * sizeof *out);
}

static void eye_of(const viewport *self, float out[3], float out_forward[3])
{
    const draw_camera *c = &self->camera.now;
    float sy = sinf(c->yaw_rad), cy = cosf(c->yaw_rad);
    float sp = sinf(c->pitch_rad), cp = cosf(c->pitch_rad);
    const float back[3] = {sy * cp, sp, cy * cp};
    for (int i = 0; i < 3; ++i) {
        out[i] = c->target[i] + c->distance_mm * back[i];
        out_forward[i] = -back[i];
    }
}

bool viewport_contact_is_seen(const viewport *self, uint32_t contact)
{
    const float *normal = self->normal + (size_t)self->face.rig->contact[contact].vertex * 3;
    float eye[3], forward[3], at[3], facing = 0.0f;
    eye_of(self, eye, forward);
    viewport_contact_at(self, contact, at);
    for (int i = 0; i < 3; ++i)
        facing += normal[i] * (eye[i] - at[i]);
    return facing > 0.0f;
}

/* ---- what is under the pointer ---- */

static uint32_t find_contact(const viewport *self, const ui_canvas *canvas)
{
    uint32_t best = 0;
    float nearest = reach_points;
    for (uint32_t i = 0; i < contact_count(self); ++i) {
        float at[3], x, y;
        viewport_contact_at(self, i, at);
        if (!viewport_to_points(self, at, &x, &y))
            continue;
        float away = hypotf(x - canvas->x, y - canvas->y);
        if (away > nearest || !viewport_contact_is_seen(self, i))
            continue;
        nearest = away;
        best = i + 1;
    }
    return best;
}

static void find(viewport *self, const ui_canvas *canvas)
{
    self->is_over = canvas->is_hovered || self->drag != VIEWPORT_DRAGS_NOTHING;
    self->is_on_face = false;
    self->contact = 0;
    if (!self->has_face || !self->is_over)
        return;
    const mesh *m = &self->face.file->mesh;
    self->is_on_face =
        draw_pick(&self->hit, m, self->shape, &self->camera.now, self->rectangle, self->pointer_px);
    self->contact = find_contact(self, canvas);
}

static uint32_t nearest_corner(const draw_hit *hit)
{
    int best = 0;
    for (int i = 1; i < 3; ++i)
        best = hit->share[i] > hit->share[best] ? i : best;
    return hit->vertex[best];
}

static void rest_of_hit(const viewport *self, float out[3])
{
    const float *position = self->face.position;
    for (int i = 0; i < 3; ++i) {
        out[i] = 0.0f;
        for (int corner = 0; corner < 3; ++corner)
            out[i] += self->hit.share[corner] *
                      position[(size_t)self->hit.vertex[corner] * 3 + (size_t)i];
    }
}

static void tell_ray(viewport *self, viewport_stroke *out)
{
    float through[3], squared = 0.0f;
    eye_of(self, out->eye, out->forward);
    memcpy(through, self->camera.now.target, sizeof through);
    bool is_seen =
        draw_unproject(out->ray, &self->camera.now, self->rectangle, self->pointer_px, through);
    for (int i = 0; i < 3; ++i) {
        out->ray[i] = is_seen ? out->ray[i] - out->eye[i] : out->forward[i];
        squared += out->ray[i] * out->ray[i];
    }
    for (int i = 0; i < 3; ++i)
        out->ray[i] /= squared > 0.0f ? sqrtf(squared) : 1.0f;
    out->point_rad =
        self->where.height > 0.0f ? self->camera.now.field_of_view_rad / self->where.height : 0.0f;
}

static void tell_stroke(viewport *self, const ui_canvas *canvas)
{
    viewport_stroke *out = &self->stroke;
    *out = (viewport_stroke){.is_on_face = self->is_on_face && self->is_over,
                             .modifiers = canvas->modifiers,
                             .contact = self->contact};
    bool is_given = self->drag == VIEWPORT_GIVES;
    out->is_pressed = is_given && canvas->is_pressed;
    out->is_dragging = is_given && canvas->is_dragging;
    out->is_released = is_given && canvas->is_released;
    tell_ray(self, out);
    if (!out->is_on_face)
        return;
    out->vertex = nearest_corner(&self->hit);
    rest_of_hit(self, out->rest);
    memcpy(out->at, self->hit.at, sizeof out->at);
}

/* ---- the face is pulled ---- */

static viewport_grip_view grip_view(const viewport *self)
{
    return (viewport_grip_view){
        &self->camera.now, self->rectangle, {self->pointer_px[0], self->pointer_px[1]}};
}

static void tell_stage(const viewport *self, pointer_grip how, bool stays)
{
    live_point(studio_live(self->of), how, self->grip.rest, self->grip.at, stays, self->radius_mm);
}

static void take_hold(viewport *self, const ui_canvas *canvas)
{
    float rest[3], shown[3];
    if (self->contact > 0) {
        const mrt_contact *contact = &view_of(self)->about->contacts[self->contact - 1];
        const float exactly[3] = {contact->rest.x, contact->rest.y, contact->rest.z};
        memcpy(rest, exactly, sizeof rest);
        viewport_contact_at(self, self->contact - 1, shown);
    } else {
        rest_of_hit(self, rest);
        memcpy(shown, self->hit.at, sizeof shown);
    }
    viewport_grip_view view = grip_view(self);
    bool kneads = (canvas->modifiers & UI_CONTROL) != 0;
    viewport_grip_take(&self->grip, kneads ? POINTER_KNEADS : POINTER_PULLS, rest, shown, &view);
    self->drag = VIEWPORT_HOLDS;
    tell_stage(self, self->grip.how, false);
}

static void drag_hold(viewport *self, const ui_canvas *canvas)
{
    viewport_grip_view view = grip_view(self);
    viewport_grip_drag(&self->grip, &view);
    if (canvas->wheel_y != 0.0f && !(canvas->modifiers & UI_ALT))
        viewport_grip_lift(&self->grip, canvas->wheel_y * notch_share * face_height(self), &view);
    bool stays = (canvas->modifiers & UI_SHIFT) != 0;
    if (canvas->is_released) {
        tell_stage(self, POINTER_AWAY, stays);
        viewport_grip_let_go(&self->grip);
    } else {
        tell_stage(self, self->grip.how, stays);
    }
}

void viewport_let_go(viewport *self)
{
    if (self->drag == VIEWPORT_HOLDS && studio_live(self->of))
        tell_stage(self, POINTER_AWAY, false);
    viewport_grip_let_go(&self->grip);
    self->drag = VIEWPORT_DRAGS_NOTHING;
}

/* All that stays goes back to rest. */
static void let_go_of_all(viewport *self)
{
    const mrt_contact *contact = &view_of(self)->about->contacts[self->contact - 1];
    const float rest[3] = {contact->rest.x, contact->rest.y, contact->rest.z};
    float at[3];
    viewport_contact_at(self, self->contact - 1, at);
    live_point(studio_live(self->of), POINTER_LETS_GO, rest, at, false, 0.0);
}

static bool can_pull(const viewport *self)
{
    return studio_live(self->of) && view_of(self)->about && !self->stands_in && !self->is_off_stage;
}

static void press_left(viewport *self, const ui_canvas *canvas)
{
    if (self->use != VIEWPORT_PERFORMS) {
        self->drag = self->is_on_face || self->contact ? VIEWPORT_GIVES : VIEWPORT_ORBITS;
        return;
    }
    if (!self->is_on_face && !self->contact) {
        self->drag = VIEWPORT_ORBITS;
        return;
    }
    if (!can_pull(self))
        return;
    if (canvas->is_double_clicked && self->contact)
        let_go_of_all(self);
    else
        take_hold(self, canvas);
}

/* ---- buttons and the wheel ---- */

static void press(viewport *self, const ui_canvas *canvas)
{
    if (canvas->button == 2 || (canvas->button == 1 && (canvas->modifiers & UI_SHIFT)))
        self->drag = VIEWPORT_PANS;
    else if (canvas->button == 1)
        self->drag = VIEWPORT_ORBITS;
    else
        press_left(self, canvas);
}

static void move(viewport *self, const ui_canvas *canvas)
{
    float right = is_mirrored(self) ? -canvas->moved_x : canvas->moved_x;
    if (self->drag == VIEWPORT_ORBITS && (right != 0.0f || canvas->moved_y != 0.0f))
        viewport_camera_orbit(&self->camera, right, canvas->moved_y);
    else if (self->drag == VIEWPORT_PANS)
        viewport_camera_pan(&self->camera, right, canvas->moved_y, self->where.height);
    else if (self->drag == VIEWPORT_HOLDS)
        drag_hold(self, canvas);
}

static void change_radius(viewport *self, float notches)
{
    double most = radius_most_share * (double)face_height(self);
    double radius = viewport_radius_mm(self) * pow(radius_step, (double)notches);
    self->radius_mm = fmin(fmax(radius, radius_least_mm), most);
    self->radius_shown_s = radius_shown_for_s;
    settings_set_number(studio_settings(self->of), radius_key, self->radius_mm);
}

static void turn_wheel(viewport *self, const ui_canvas *canvas)
{
    if (canvas->wheel_y == 0.0f)
        return;
    if (canvas->modifiers & UI_ALT)
        change_radius(self, canvas->wheel_y);
    else if (self->drag == VIEWPORT_DRAGS_NOTHING)
        viewport_camera_zoom(&self->camera, canvas->wheel_y, self->rectangle, self->pointer_px);
}

void viewport_point(viewport *self, const ui_canvas *canvas)
{
    self->is_off_stage = view_of(self)->mode == LIVE_SHOWS;
    take_pixel(self, canvas);
    if (canvas->button < 0)
        viewport_let_go(self); /* somebody else has the pointer now */
    turn_wheel(self, canvas);
    if (self->drag != VIEWPORT_HOLDS)
        find(self, canvas);
    if (canvas->is_pressed)
        press(self, canvas);
    if (canvas->is_dragging || canvas->is_released)
        move(self, canvas);
    tell_stroke(self, canvas);
    if (canvas->is_released)
        self->drag = VIEWPORT_DRAGS_NOTHING;
}
