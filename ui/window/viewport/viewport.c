#include "window/viewport/viewport.h"
#include "base/hash.h"
#include "window/app/kept_scenery.h"
#include "draw/camera.h"
#include "draw/overlay.h"
#include "window/gui/theme.h"
#include "window/viewport/camera.h"
#include "window/viewport/heat.h"
#include "window/viewport/picture.h"
#include "window/viewport/virtual_hand.h"

#include "stage/perform/pointer.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct viewport_grip {
    bool holds;
    pointer_grip how;
    float rest[3];   /* held point on the neutral face, mm */
    float begin[3];  /* held point as shown at the grab, mm */
    float offset[3]; /* from the point under the pointer to the held point, mm */
    float depth_mm;  /* offset towards the viewer, set with the wheel */
    float at[3];     /* current target, mm */
} viewport_grip;

typedef enum viewport_drag { /* action of the pressed button */
                             VIEWPORT_DRAGS_NOTHING = 0,
                             VIEWPORT_ORBITS,
                             VIEWPORT_PANS,
                             VIEWPORT_HOLDS, /* holds the face at the grip */
                             VIEWPORT_GIVES  /* passes the pointer to the panel that requested it */
} viewport_drag;

typedef struct viewport_face { /* identity of the shown face: each field counts */
    const face_file *file;
    const rig *rig;
    const float *position;
    const uint32_t *triangle;
    uint32_t vertex_count;
} viewport_face;

typedef struct viewport_quality { /* reduces the resolution while a slow renderer must redraw */
    uint32_t level;               /* index of quality_scale; 0: full resolution */
    double slow_s, fast_s, still_s;
    uint64_t count; /* draw count of the picture one frame ago */
    bool was_drawn; /* drawn in that frame */
} viewport_quality;

struct viewport {
    app *of;
    draw_renderer *renderer;
    viewport_picture *picture;
    viewport_picture
        *output[VIEWPORT_TAKERS]; /* the face without overlays; NULL: not requested yet */
    bool has_ground;
    float ground[4];
    viewport_face face;
    uint64_t surface; /* hash of the drawn mesh */
    bool has_face, output_has_face[VIEWPORT_TAKERS];
    float low[3], high[3]; /* bounds of the neutral face, mm */
    virtual_hand *hand;
    double dt_s;

    float *shape, *normal; /* vertex_count by 3; as shown */
    float *stand_in;       /* 2 by vertex_count by 3; used if stands_in */
    bool stands_in;
    viewport_heat *heat; /* NULL: not requested yet */
    float *rgb, *paint;  /* vertex_count by 3 */
    bool has_paint, is_painted_anew;
    app_heat heat_shown;
    uint64_t colours_of; /* shape of the colours */
    bool has_colours, has_failed;
    overlay_item *extra;
    uint32_t extra_count, extra_capacity;

    viewport_camera camera;
    bool has_camera;
    draw_camera_view camera_kept;
    draw_backdrop *backdrop; /* NULL: the wall */
    uint64_t backdrop_number;

    viewport_scene scene;
    viewport_quality quality;
    ui_rectangle where; /* position on the screen, points */
    float px_per_point;
    uint32_t rectangle[4]; /* 0, 0, width, height of the whole picture, pixels */

    viewport_use use;
    float brush_mm;
    viewport_drag drag;
    viewport_grip grip;
    double radius_mm; /* radius of pulls with the pointer; 0: radius of the rig */
    double radius_shown_s;
    ui_rectangle chip;        /* the button that clears held pulls, as drawn; width 0: hidden */
    ui_rectangle mirrored;    /* likewise for "Mirrored" */
    bool is_over, is_on_face; /* pointer is over the viewport; on the face */
    float pointer_px[2];
    draw_hit hit;      /* while it is on the face */
    uint32_t contact;  /* 1 + index of the contact near the pointer; 0: none */
    bool is_off_stage; /* a take is shown instead of the live face */
    viewport_stroke stroke;
};

/* ---- shared functions ---- */

static void say(const viewport *self, int32_t level, const char *text)
{
    news_list_add(app_news(self->of), level, "picture", text);
}

static const char *const camera_key[DRAW_VIEW_NUMBERS] = {
    "viewport.camera.yaw_rad",  "viewport.camera.pitch_rad", "viewport.camera.distance",
    "viewport.camera.target_x", "viewport.camera.target_y",  "viewport.camera.target_z"};

static void keep_camera(viewport *self)
{
    const draw_camera_view now = viewport_camera_keep(&self->camera);
    if (memcmp(&now, &self->camera_kept, sizeof now) == 0)
        return;
    self->camera_kept = now;
    for (int i = 0; i < DRAW_VIEW_NUMBERS; ++i)
        settings_set_number(app_settings(self->of), camera_key[i], now.number[i]);
}

static float aspect_of(const viewport *self)
{
    return (float)self->rectangle[2] / (float)self->rectangle[3];
}

/* ---- names beside dots ---- */

static const float label_gap = 4.0f; /* between a dot and its name */

static ui_rectangle name_of(const viewport_label *l)
{
    return (ui_rectangle){l->at_x, l->at_y, l->width, l->height};
}

static ui_rectangle dot_of(const viewport_label *l, float dot)
{
    return (ui_rectangle){l->x - dot, l->y - dot, 2.0f * dot, 2.0f * dot};
}

/* Possible sides of a name: right, left, above, below. */
enum { SIDES = 4 };
static void put(viewport_label *l, int side, float dot)
{
    float middle_x = l->x - 0.5f * l->width, middle_y = l->y - 0.5f * l->height;
    float away = dot + label_gap;
    l->at_x = side == 0 ? l->x + away : side == 1 ? l->x - away - l->width : middle_x;
    l->at_y = side == 2 ? l->y - away - l->height : side == 3 ? l->y + away : middle_y;
}

static bool is_free(const viewport_label *label, uint32_t count, uint32_t self, ui_rectangle within,
                    float dot)
{
    ui_rectangle name = name_of(&label[self]);
    if (!ui_rectangle_is_within(name, within))
        return false;
    for (uint32_t i = 0; i < count; ++i) {
        ui_rectangle other_dot = dot_of(&label[i], dot), other = name_of(&label[i]);
        if (i != self && ui_rectangles_meet(name, other_dot))
            return false;
        if (i < self && label[i].is_placed && ui_rectangles_meet(name, other))
            return false;
    }
    return true;
}

void viewport_labels_place(viewport_label *label, uint32_t count, ui_rectangle within, float dot)
{
    for (uint32_t i = 0; i < count; ++i) {
        label[i].is_placed = false;
        for (int side = 0; side < SIDES && !label[i].is_placed; ++side) {
            put(&label[i], side, dot);
            label[i].is_placed = is_free(label, count, i, within, dot);
        }
    }
}

/* ---- grip of the pointer on the face ---- */

/* Maximum lift of a held point towards the camera, share of the camera distance. */
static const float most_lift = 0.5f;

/* Computes the point under the pointer in the lifted plane of the held point. */
static bool point_under_pointer(float out[3], const viewport *self)
{
    const draw_camera *camera = &self->camera.now;
    float right[3], up[3], back[3];
    if (!draw_unproject(out, camera, self->rectangle, self->pointer_px, self->grip.begin))
        return false;
    camera_axes_of(camera, right, up, back);
    for (int i = 0; i < 3; ++i)
        out[i] += self->grip.depth_mm * back[i];
    return true;
}

/* Grabs the point `rest`, which is shown at `shown`, without a jump. */
static void take_grip(viewport *self, pointer_grip how, const float rest[3], const float shown[3])
{
    viewport_grip *grip = &self->grip;
    *grip = (viewport_grip){.holds = true, .how = how};
    memcpy(grip->rest, rest, sizeof grip->rest);
    memcpy(grip->begin, shown, sizeof grip->begin);
    memcpy(grip->at, shown, sizeof grip->at);
    float under[3];
    if (!point_under_pointer(under, self))
        return;
    for (int i = 0; i < 3; ++i)
        grip->offset[i] = shown[i] - under[i];
}

/* Drags the held point in the plane that faces the camera. towards_mm: additional movement towards
 * the viewer. */
static void drag_grip(viewport *self, float towards_mm)
{
    viewport_grip *grip = &self->grip;
    const float most = most_lift * self->camera.now.distance_mm;
    float under[3];
    if (!grip->holds)
        return;
    if (towards_mm != 0.0f)
        grip->depth_mm = fminf(fmaxf(grip->depth_mm + towards_mm, -most), most);
    if (!point_under_pointer(under, self))
        return;
    for (int i = 0; i < 3; ++i)
        grip->at[i] = under[i] + grip->offset[i];
}

/* ---- the pointer ---- */

static const float reach_points = 14.0f; /* distance of the pointer from a contact's dot */
static const float notch_share =
    1.0f / 120.0f; /* movement towards the viewer per notch, share of the face height */
static const double radius_step = 1.12, radius_least_mm = 4.0, radius_most_share = 0.8;
static const double radius_shown_for_s = 1.5;
static const char radius_key[] = "viewport.pointer_radius_mm";

static const live_view *view_of(const viewport *self)
{
    return app_view(self->of);
}

static bool is_mirrored(const viewport *self)
{
    return app_looks_of(self->of)->is_mirrored;
}

static float face_height(const viewport *self)
{
    return fmaxf(self->high[1] - self->low[1], 1.0f);
}

/* Returns the support radius of a pull with the pointer. */
static double reach_mm(const viewport *self)
{
    double rigs = view_of(self)->solver.radius;
    return self->radius_mm > 0.0 ? self->radius_mm
           : rigs > 0.0          ? rigs
                                 : 0.25 * (double)face_height(self);
}

/* ---- positions ---- */

/* Projects a point to points from the top left of the canvas. Returns false if it is behind the
 * eye. */
static bool to_points(const viewport *self, const float at[3], float *out_x, float *out_y)
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

/* Computes the position of a contact in the shown shape. */
static void contact_position(const viewport *self, uint32_t contact, float out[3])
{
    memcpy(out, self->shape + (size_t)self->face.rig->contact[contact].vertex * 3, 3 * sizeof *out);
}

static bool contact_is_seen(const viewport *self, uint32_t contact)
{
    const float *normal = self->normal + (size_t)self->face.rig->contact[contact].vertex * 3;
    float eye[3], at[3], facing = 0.0f;
    camera_eye(&self->camera.now, eye);
    contact_position(self, contact, at);
    for (int i = 0; i < 3; ++i)
        facing += normal[i] * (eye[i] - at[i]);
    return facing > 0.0f;
}

/* ---- hit test ---- */

static uint32_t find_contact(const viewport *self, const ui_canvas *canvas)
{
    uint32_t best = 0;
    float nearest = reach_points;
    for (uint32_t i = 0; i < contact_count(self); ++i) {
        float at[3], x, y;
        contact_position(self, i, at);
        if (!to_points(self, at, &x, &y))
            continue;
        float away = hypotf(x - canvas->x, y - canvas->y);
        if (away > nearest || !contact_is_seen(self, i))
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
    const draw_camera *camera = &self->camera.now;
    float right[3], up[3], back[3], squared = 0.0f;
    camera_eye(camera, out->eye);
    camera_axes_of(camera, right, up, back);
    bool is_under =
        draw_unproject(out->ray, camera, self->rectangle, self->pointer_px, camera->target);
    for (int i = 0; i < 3; ++i) {
        out->forward[i] = -back[i];
        out->ray[i] = is_under ? out->ray[i] - out->eye[i] : out->forward[i];
        squared += out->ray[i] * out->ray[i];
    }
    for (int i = 0; i < 3; ++i)
        out->ray[i] /= squared > 0.0f ? sqrtf(squared) : 1.0f;
    out->point_rad =
        self->where.height > 0.0f ? camera->field_of_view_rad / self->where.height : 0.0f;
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

/* ---- pulls ---- */

static void send_pointer(const viewport *self, pointer_grip how, bool stays)
{
    live_point(app_live(self->of), how, self->grip.rest, self->grip.at, stays, self->radius_mm);
}

static void take_hold(viewport *self, const ui_canvas *canvas)
{
    float rest[3], shown[3];
    if (self->contact > 0) {
        const mrt_contact *contact = &view_of(self)->about->contacts[self->contact - 1];
        const float exactly[3] = {contact->rest.x, contact->rest.y, contact->rest.z};
        memcpy(rest, exactly, sizeof rest);
        contact_position(self, self->contact - 1, shown);
    } else {
        rest_of_hit(self, rest);
        memcpy(shown, self->hit.at, sizeof shown);
    }
    bool kneads = (canvas->modifiers & UI_CONTROL) != 0;
    take_grip(self, kneads ? POINTER_KNEADS : POINTER_PULLS, rest, shown);
    self->drag = VIEWPORT_HOLDS;
    app_begin_pull(self->of);
    send_pointer(self, self->grip.how, false);
}

static void hold_pull(viewport *self)
{
    char words[EDIT_TEXT];
    (void)snprintf(words, sizeof words, "pull of %.80s",
                   self->contact ? view_of(self)->about->contacts[self->contact - 1].name
                                 : "the skin");
    app_hold(self->of, words);
}

static void drag_hold(viewport *self, const ui_canvas *canvas)
{
    const bool lifts = !(canvas->modifiers & UI_ALT);
    drag_grip(self, lifts ? canvas->wheel_y * notch_share * face_height(self) : 0.0f);
    bool stays = (canvas->modifiers & UI_SHIFT) != 0;
    if (canvas->is_released) {
        send_pointer(self, POINTER_AWAY, stays);
        if (self->grip.how == POINTER_KNEADS)
            app_hold(self->of, "clay");
        else if (stays)
            hold_pull(self);
        self->grip.holds = false;
    } else {
        send_pointer(self, self->grip.how, stays);
    }
}

/* Releases the held point or camera drag. */
static void release_grip(viewport *self)
{
    if (self->drag == VIEWPORT_HOLDS && app_live(self->of))
        send_pointer(self, POINTER_AWAY, false);
    self->grip.holds = false;
    self->drag = VIEWPORT_DRAGS_NOTHING;
}

/* Releases all remaining pulls. */
static void release_all_pulls(viewport *self)
{
    const mrt_contact *contact = &view_of(self)->about->contacts[self->contact - 1];
    const float rest[3] = {contact->rest.x, contact->rest.y, contact->rest.z};
    float at[3];
    contact_position(self, self->contact - 1, at);
    if (app_is_held(self->of))
        app_begin_pull(self->of);
    live_point(app_live(self->of), POINTER_RELEASE_ALL, rest, at, false, 0.0);
    if (app_is_held(self->of))
        app_hold(self->of, "release all contacts");
}

static bool can_pull(const viewport *self)
{
    return app_live(self->of) && view_of(self)->about && !self->stands_in && !self->is_off_stage &&
           !app_notes_of(self->of)->is_rig_pending;
}

static void press_left(viewport *self, const ui_canvas *canvas)
{
    if (ui_canvas_is_over(canvas, self->chip)) {
        app_do(self->of, ACTION_NEUTRAL);
        return;
    }
    if (ui_canvas_is_over(canvas, self->mirrored)) {
        app_do(self->of, ACTION_VIEW_MIRROR);
        return;
    }
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
        release_all_pulls(self);
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
    double radius = reach_mm(self) * pow(radius_step, (double)notches);
    self->radius_mm = fmin(fmax(radius, radius_least_mm), most);
    self->radius_shown_s = radius_shown_for_s;
    settings_set_number(app_settings(self->of), radius_key, self->radius_mm);
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

static void follow_pointer(viewport *self, const ui_canvas *canvas)
{
    self->is_off_stage = view_of(self)->mode == LIVE_SHOWS;
    take_pixel(self, canvas);
    if (canvas->button < 0)
        release_grip(self); /* another panel uses the pointer now */
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

/* ---- current face ---- */

static bool is_same_face(const viewport_face *a, const viewport_face *b)
{
    return a->file == b->file && a->rig == b->rig && a->position == b->position &&
           a->triangle == b->triangle && a->vertex_count == b->vertex_count;
}

static uint64_t surface_of(const mesh *m)
{
    uint64_t hash = HASH_START;
    size_t places = (size_t)m->vertex_count * 3, corners = (size_t)m->triangle_count * 3;
    hash = hash_bytes(hash, m->position, places * sizeof *m->position);
    hash = hash_bytes(hash, m->triangle, corners * sizeof *m->triangle);
    if (m->normal)
        hash = hash_bytes(hash, m->normal, places * sizeof *m->normal);
    for (uint32_t i = 0; i < m->material_count; ++i)
        hash = hash_bytes(hash, m->material[i].base_colour, sizeof m->material[i].base_colour);
    for (uint32_t i = 0; i < m->part_count; ++i)
        hash = hash_bytes(hash, &m->part[i].first_triangle, 2 * sizeof(uint32_t));
    return hash;
}

static void drop_face(viewport *self)
{
    release_grip(self);
    float **arrays[] = {&self->shape, &self->normal, &self->stand_in, &self->rgb, &self->paint};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; ++i) {
        free(*arrays[i]);
        *arrays[i] = NULL;
    }
    viewport_heat_destroy(self->heat);
    self->heat = NULL;
    self->has_face = self->has_paint = self->stands_in = false;
    for (int i = 0; i < VIEWPORT_TAKERS; ++i)
        self->output_has_face[i] = false;
    self->has_colours = self->is_on_face = false;
    self->heat_shown = APP_HEAT_NONE;
    self->contact = 0;
}

static bool take_face(viewport *self, const viewport_face *now, error *err)
{
    drop_face(self);
    self->face = *now;
    const mesh *m = &now->file->mesh;
    size_t size = (size_t)m->vertex_count * 3 * sizeof(float);
    self->shape = malloc(size + 1);
    self->normal = calloc(1, size + 1);
    self->stand_in = malloc(2 * size + 1);
    self->rgb = malloc(size + 1);
    self->paint = malloc(size + 1);
    if (!self->shape || !self->normal || !self->stand_in || !self->rgb || !self->paint) {
        error_set(err, MRT_ERR_MEMORY, "no memory to show the face");
        return false;
    }
    if (viewport_picture_face(self->picture, m, err) < 0)
        return false;
    memcpy(self->shape, m->position, size);
    if (m->normal)
        memcpy(self->normal, m->normal, size);
    mesh_focus(m, self->low, self->high);
    return true;
}

/* Adopts another rig on the same surface. The picture and the camera stay, unless the rig has
 * another head. */
static void take_rig(viewport *self, const viewport_face *now)
{
    float low[3], high[3];
    mesh_focus(&now->file->mesh, low, high);
    if (memcmp(low, self->low, sizeof low) != 0 || memcmp(high, self->high, sizeof high) != 0) {
        memcpy(self->low, low, sizeof low);
        memcpy(self->high, high, sizeof high);
        viewport_camera_init(&self->camera, low, high, aspect_of(self));
    }
    self->face = *now;
    self->contact = 0;
    viewport_heat_destroy(self->heat);
    self->heat = NULL;
    self->heat_shown = APP_HEAT_NONE;
}

static void follow_face(viewport *self)
{
    const face_file *file = app_face(self->of);
    viewport_face now = {file, NULL, NULL, NULL, 0};
    if (file)
        now = (viewport_face){file, file->rig, file->mesh.position, file->mesh.triangle,
                              file->mesh.vertex_count};
    if (is_same_face(&now, &self->face))
        return;
    error err = {{0}};
    uint64_t surface = file ? surface_of(&file->mesh) : 0;
    if (file && self->has_face && surface == self->surface) {
        take_rig(self, &now);
        return;
    }
    if (!file)
        drop_face(self);
    self->face = now;
    self->surface = surface;
    self->has_face = file && take_face(self, &now, &err);
    if (file && !self->has_face)
        say(self, MRT_LOG_ERROR, err.text);
    if (!self->has_face)
        return;
    if (self->has_camera)
        keep_camera(self);
    viewport_camera_init(&self->camera, self->low, self->high, aspect_of(self));
    if (!self->has_camera) /* the first face uses the saved camera; another head is shown as a whole
                            */
        viewport_camera_recall(&self->camera, &self->camera_kept);
    self->has_camera = true;
}

/* ---- current shape ---- */

static void follow_shape(viewport *self)
{
    const live_view *view = app_view(self->of);
    size_t count = (size_t)self->face.vertex_count * 3;
    const float *position = view->position, *normal = view->normal;
    if (self->stands_in) {
        position = self->stand_in;
        normal = self->stand_in + count;
    } else if (view->vertex_count != self->face.vertex_count) {
        return; /* the stage does not use this face yet */
    }
    if (!position)
        return;
    if (self->stands_in)
        viewport_picture_shape(self->picture, position, normal);
    else
        viewport_picture_follow(self->picture, view);
    memcpy(self->shape, position, count * sizeof *position);
    if (normal)
        memcpy(self->normal, normal, count * sizeof *normal);
}

void viewport_stand_in(viewport *self, const float *position, const float *normal)
{
    self->stands_in = position && self->has_face;
    if (!self->stands_in)
        return;
    size_t count = (size_t)self->face.vertex_count * 3;
    memcpy(self->stand_in, position, count * sizeof *position);
    memcpy(self->stand_in + count, normal, count * sizeof *position);
}

/* ---- current colours ---- */

static bool has_heat(viewport *self)
{
    if (self->heat)
        return true;
    error err = {{0}};
    if (viewport_heat_create(&self->heat, self->face.file, &err) >= 0)
        return true;
    say(self, MRT_LOG_ERROR, err.text);
    app_looks_of(self->of)->heat = APP_HEAT_NONE;
    return false;
}

static void show_paint(viewport *self)
{
    if (self->is_painted_anew)
        viewport_picture_colour(self->picture, self->paint);
    self->is_painted_anew = false;
    self->has_colours = true;
    self->heat_shown = APP_HEAT_NONE;
}

static void show_heat(viewport *self, app_heat kind)
{
    uint64_t shown = viewport_picture_shapes(self->picture);
    bool depends = !viewport_heat_is_fixed(kind);
    if (kind == self->heat_shown && !(depends && shown != self->colours_of))
        return;
    viewport_heat_colour(self->heat, self->rgb, kind, self->shape, app_view(self->of)->bone);
    viewport_picture_colour(self->picture, self->rgb);
    self->heat_shown = kind;
    self->colours_of = shown;
    self->has_colours = true;
}

static void follow_colours(viewport *self)
{
    app_heat kind = app_looks_of(self->of)->heat;
    if (self->has_paint) {
        show_paint(self);
    } else if (kind != APP_HEAT_NONE && kind < APP_HEATS && has_heat(self)) {
        show_heat(self, kind);
    } else if (self->has_colours) {
        viewport_picture_colour(self->picture, NULL);
        self->has_colours = false;
        self->heat_shown = APP_HEAT_NONE;
    }
}

void viewport_paint(viewport *self, const float *rgb)
{
    self->has_paint = rgb && self->has_face;
    if (!self->has_paint)
        return;
    memcpy(self->paint, rgb, (size_t)self->face.vertex_count * 3 * sizeof *rgb);
    self->is_painted_anew = true;
}

/* ---- overlay text ---- */

static const float margin = 12.0f, dot_radius = 5.0f;
static const uint32_t plate = 0x101113c8u; /* background of text over the face */

static void write_on_plate(ui *on, float x, float y, uint32_t colour, const char *text)
{
    float width = ui_text_width(on, UI_STYLE_BODY, text);
    float height = ui_text_height(on, UI_STYLE_BODY);
    ui_draw_box(on, (ui_rectangle){x - 4.0f, y - 1.0f, width + 8.0f, height + 2.0f}, plate, 3.0f);
    ui_draw_text(on, x, y, UI_STYLE_BODY, colour, 0.0f, text);
}

/* ---- contacts ---- */

static const char *contact_name(const viewport *self, uint32_t contact)
{
    return app_view(self->of)->about->contacts[contact].name;
}

static bool add_label(const viewport *self, const ui *on, uint32_t contact, viewport_label *out)
{
    float at[3];
    contact_position(self, contact, at);
    if (!contact_is_seen(self, contact) || !to_points(self, at, &out->x, &out->y))
        return false;
    out->width = ui_text_width(on, UI_STYLE_BODY, contact_name(self, contact)) + 8.0f;
    out->height = ui_text_height(on, UI_STYLE_BODY) + 2.0f;
    return true;
}

/* Draws the names of contacts. The name under the pointer is placed first, so that it always has
 * space. */
static void ink_contacts(const viewport *self, ui *on)
{
    const live_view *view = app_view(self->of);
    bool shows = app_looks_of(self->of)->shows_contacts;
    if (!self->has_face || !self->face.rig || !view->about || (!shows && !self->contact))
        return;
    viewport_label label[VIEWPORT_LABELS_MAX];
    uint32_t contact[VIEWPORT_LABELS_MAX], count = 0;
    if (self->contact && add_label(self, on, self->contact - 1, &label[count]))
        contact[count++] = self->contact - 1;
    for (uint32_t i = 0; shows && i < contact_count(self) && count < VIEWPORT_LABELS_MAX; ++i)
        if (i + 1 != self->contact && add_label(self, on, i, &label[count]))
            contact[count++] = i;
    const ui_rectangle within = {4.0f, 4.0f, self->where.width - 8.0f, self->where.height - 8.0f};
    viewport_labels_place(label, count, within, dot_radius);
    for (uint32_t i = 0; i < count; ++i) {
        bool is_pointed_at = contact[i] + 1 == self->contact;
        if (label[i].is_placed)
            write_on_plate(
                on, self->where.x + label[i].at_x + 4.0f, self->where.y + label[i].at_y + 1.0f,
                is_pointed_at ? THEME_ACCENT : THEME_DIM, contact_name(self, contact[i]));
        if (is_pointed_at)
            ui_draw_ring(on, self->where.x + label[i].x, self->where.y + label[i].y, 7.5f,
                         THEME_ACCENT, 2.0f);
    }
}

/* ---- the pointer on the skin ---- */

enum { RING_POINTS = 48 };

static void smooth_normal(const viewport *self, float out[3])
{
    float squared = 0.0f;
    for (int i = 0; i < 3; ++i) {
        out[i] = 0.0f;
        for (int corner = 0; corner < 3; ++corner)
            out[i] += self->hit.share[corner] *
                      self->normal[(size_t)self->hit.vertex[corner] * 3 + (size_t)i];
        squared += out[i] * out[i];
    }
    for (int i = 0; i < 3; ++i)
        out[i] = squared > 1e-8f ? out[i] / sqrtf(squared) : self->hit.normal[i];
}

/* Draws a circle on the skin, in the tangent plane. */
static void ink_ring(const viewport *self, ui *on, float radius_mm, uint32_t colour)
{
    float normal[3], side[3], other[3], xy[2 * (RING_POINTS + 1)], squared = 0.0f;
    smooth_normal(self, normal);
    int least = fabsf(normal[0]) < fabsf(normal[1]) ? 0 : 1;
    for (int i = 0; i < 3; ++i) {
        side[i] = (i == least ? 1.0f : 0.0f) - normal[least] * normal[i];
        squared += side[i] * side[i];
    }
    for (int i = 0; i < 3; ++i)
        side[i] /= sqrtf(squared);
    for (int i = 0; i < 3; ++i)
        other[i] =
            normal[(i + 1) % 3] * side[(i + 2) % 3] - normal[(i + 2) % 3] * side[(i + 1) % 3];
    for (int p = 0; p <= RING_POINTS; ++p) {
        float around = 6.2831853f * (float)p / RING_POINTS, at[3], x, y;
        for (int i = 0; i < 3; ++i)
            at[i] =
                self->hit.at[i] + radius_mm * (cosf(around) * side[i] + sinf(around) * other[i]);
        if (!to_points(self, at, &x, &y))
            return;
        xy[2 * p] = self->where.x + x;
        xy[2 * p + 1] = self->where.y + y;
    }
    ui_draw_lines(on, xy, RING_POINTS + 1, colour, 1.5f);
}

/* Writes text near the pointer, within the picture. */
static void write_beside(const viewport *self, ui *on, const float at[3], const char *text)
{
    float x, y;
    if (!to_points(self, at, &x, &y))
        return;
    float width = ui_text_width(on, UI_STYLE_BODY, text);
    float height = ui_text_height(on, UI_STYLE_BODY);
    x = fminf(x + 18.0f, self->where.width - width - 8.0f);
    y = fminf(y + 18.0f, self->where.height - height - 8.0f);
    write_on_plate(on, self->where.x + fmaxf(x, 8.0f), self->where.y + fmaxf(y, 8.0f), THEME_TEXT,
                   text);
}

/* Writes text at the upper edge of the picture, away from the pointer. */
static void write_at_edge(const viewport *self, ui *on, const char *text)
{
    float width = ui_text_width(on, UI_STYLE_BODY, text);
    write_on_plate(on, self->where.x + 0.5f * (self->where.width - width), self->where.y + 12.0f,
                   THEME_DIM, text);
}

static const float quality_scale[] = {1.0f, 0.85f, 0.7f, 0.6f}; /* lower resolutions look coarse */

/* Writes the resolution while it is reduced, below the sign of the mirror. */
static void ink_quality(const viewport *self, ui *on)
{
    char words[64];
    if (self->quality.level == 0)
        return;
    (void)snprintf(words, sizeof words, "Drawing is slow: %.0f %% resolution",
                   100.0 * (double)quality_scale[self->quality.level]);
    const float width = ui_text_width(on, UI_STYLE_BODY, words);
    write_on_plate(on, self->where.x + self->where.width - width - margin,
                   self->where.y + 40.0f + 26.0f, THEME_DIM, words);
}

/* Draws the button that removes Shift pulls and clay changes from the face. */
static void ink_chip(viewport *self, ui *on)
{
    char keys[KEY_WORDS], words[80];
    key_map_words(&app_looks_of(self->of)->keys, ACTION_NEUTRAL, keys);
    (void)snprintf(words, sizeof words, "Held pulls. Press %s to clear them",
                   keys[0] ? keys : "Neutral");
    const float width = ui_text_width(on, UI_STYLE_BODY, words);
    self->chip = (ui_rectangle){.width = 0.0f};
    if (!app_is_held(self->of) || self->is_off_stage)
        return;
    self->chip = (ui_rectangle){self->where.x + 0.5f * (self->where.width - width) - 8.0f,
                                self->where.y + 36.0f, width + 16.0f, 24.0f};
    ui_draw_box(on, self->chip, THEME_RAISED, 12.0f);
    ui_draw_text(on, self->chip.x + 8.0f,
                 self->chip.y + 0.5f * (24.0f - ui_text_height(on, UI_STYLE_BODY)), UI_STYLE_BODY,
                 THEME_ACCENT, 0.0f, words);
}

/* Draws a sign that the view is mirrored, which is easy to overlook, below the switch of the
 * layouts. A click ends it. */
static void ink_mirrored(viewport *self, ui *on)
{
    static const char words[] = "Mirrored";
    const float width = ui_text_width(on, UI_STYLE_DIM, words), height = 20.0f;
    self->mirrored = (ui_rectangle){.width = 0.0f};
    if (!is_mirrored(self) || app_looks_of(self->of)->is_face_only)
        return;
    self->mirrored = (ui_rectangle){self->where.x + self->where.width - width - 12.0f - margin,
                                    self->where.y + 40.0f, width + 12.0f, height};
    write_on_plate(on, self->mirrored.x + 6.0f, self->mirrored.y, THEME_DIM, words);
}

static void ink_hold(const viewport *self, ui *on)
{
    float x, y;
    if (!to_points(self, self->grip.at, &x, &y))
        return;
    ui_draw_ring(on, self->where.x + x, self->where.y + y, 7.5f, THEME_ACCENT, 2.0f);
    write_at_edge(self, on,
                  self->grip.how == POINTER_KNEADS
                      ? "Clay: the shape stays. Wheel: nearer, further"
                      : "Shift: the pull stays. Wheel: nearer, further");
}

static void ink_pointer(const viewport *self, ui *on)
{
    if (self->drag == VIEWPORT_HOLDS) {
        ink_hold(self, on);
        return;
    }
    bool is_busy = self->drag == VIEWPORT_ORBITS || self->drag == VIEWPORT_PANS;
    if (is_busy || !self->is_over)
        return;
    if (self->is_on_face && self->use == VIEWPORT_PAINTS)
        ink_ring(self, on, self->brush_mm, THEME_ACCENT);
    if (self->use != VIEWPORT_PERFORMS || !self->is_on_face)
        return;
    if (self->is_off_stage) {
        char keys[KEY_WORDS], words[96];
        key_map_words(&app_looks_of(self->of)->keys, ACTION_LIVE, keys);
        (void)snprintf(words, sizeof words,
                       "A take is shown. Press %s to go back to the live hands",
                       keys[0] ? keys : "Live");
        write_at_edge(self, on, words);
        return;
    }
    double half = viewport_half_radius(app_view(self->of)->solver.kernel);
    if (!self->contact || self->radius_shown_s > 0.0)
        ink_ring(self, on, (float)(half * reach_mm(self)), 0xd9a441a0u);
    if (self->radius_shown_s > 0.0) {
        char text[64];
        snprintf(text, sizeof text, "Reach %.0f mm", reach_mm(self));
        write_beside(self, on, self->hit.at, text);
    }
}

static void set_cursor(const viewport *self, ui *on)
{
    if (self->drag == VIEWPORT_ORBITS || self->drag == VIEWPORT_PANS)
        ui_set_cursor(on, UI_CURSOR_MOVE);
    else if (self->is_over && self->use != VIEWPORT_PERFORMS && self->is_on_face)
        ui_set_cursor(on, UI_CURSOR_CROSS);
    else if (self->is_over && (self->is_on_face || self->contact) && !self->is_off_stage)
        ui_set_cursor(on, UI_CURSOR_HAND);
}

/* ---- legends ---- */

static uint32_t mixed(uint32_t a, uint32_t b, float share)
{
    uint32_t out = 0xffu;
    for (int shift = 8; shift <= 24; shift += 8) {
        float from = (float)(a >> shift & 255u), to = (float)(b >> shift & 255u);
        out |= (uint32_t)lrintf(from + share * (to - from)) << shift;
    }
    return out;
}

static void ink_scale(ui *on, float x, float y, float width, const viewport_heat_legend *legend)
{
    enum { PARTS = 40 };
    for (int i = 0; i < PARTS; ++i) {
        float along = ((float)i + 0.5f) / PARTS * (VIEWPORT_HEAT_STOPS - 1);
        int low = (int)along;
        ui_rectangle part = {x + width * (float)i / PARTS, y, width / PARTS + 0.5f, 8.0f};
        ui_draw_box(on, part, mixed(legend->stop[low], legend->stop[low + 1], along - (float)low),
                    0.0f);
    }
}

static void ink_scale_words(ui *on, float x, float y, float width,
                            const viewport_heat_legend *legend)
{
    ui_draw_text(on, x, y, UI_STYLE_BODY, THEME_DIM, 0.0f, legend->low);
    float high = ui_text_width(on, UI_STYLE_BODY, legend->high);
    ui_draw_text(on, x + width - high, y, UI_STYLE_BODY, THEME_DIM, 0.0f, legend->high);
    if (!legend->mid)
        return;
    float mid = ui_text_width(on, UI_STYLE_BODY, legend->mid);
    ui_draw_text(on, x + 0.5f * (width - mid), y, UI_STYLE_BODY, THEME_DIM, 0.0f, legend->mid);
}

static void ink_bones(const viewport *self, ui *on, float x, float y, uint32_t count)
{
    float row = ui_text_height(on, UI_STYLE_BODY) + 3.0f;
    for (uint32_t bone = 0; bone < count; ++bone) {
        const char *name;
        uint32_t colour = viewport_heat_bone(self->heat, bone, &name);
        float top = y + row * (float)bone;
        ui_draw_box(on, (ui_rectangle){x, top + 3.0f, 12.0f, 12.0f}, colour, 2.0f);
        ui_draw_text(on, x + 20.0f, top, UI_STYLE_BODY, THEME_TEXT, 0.0f, name);
    }
}

static void ink_heat(const viewport *self, ui *on)
{
    if (!self->heat || self->heat_shown == APP_HEAT_NONE || self->has_paint)
        return;
    viewport_heat_legend legend;
    viewport_heat_legend_of(self->heat, self->heat_shown, &legend);
    float line = ui_text_height(on, UI_STYLE_BODY) + 3.0f;
    float wide = legend.bone_count ? 150.0f : 250.0f;
    bool has_depth = self->heat_shown == APP_HEAT_PENETRATION;
    float high = 16.0f + line * (legend.bone_count ? (float)(1 + legend.bone_count)
                                 : has_depth       ? 3.0f
                                                   : 2.0f);
    high += legend.bone_count ? 4.0f : 16.0f;
    ui_rectangle box = {self->where.x + margin, self->where.y + margin, wide, high};
    ui_draw_box(on, box, plate, 4.0f);
    float x = box.x + 10.0f, y = box.y + 8.0f, inner = wide - 20.0f;
    ui_draw_text(on, x, y, UI_STYLE_BODY, THEME_TEXT, inner, legend.title);
    y += line + 3.0f;
    if (legend.bone_count) {
        ink_bones(self, on, x, y, legend.bone_count);
        return;
    }
    ink_scale(on, x, y, inner, &legend);
    ink_scale_words(on, x, y + 12.0f, inner, &legend);
    if (!has_depth)
        return;
    char text[80];
    snprintf(text, sizeof text, "Skin pushed out: %.1f mm", app_view(self->of)->penetration_mm);
    ui_draw_text(on, x, y + 12.0f + line, UI_STYLE_BODY, THEME_TEXT, inner, text);
}

static void ink_all(const viewport *self, ui *on)
{
    ink_contacts(self, on);
    ink_pointer(self, on);
    set_cursor(self, on);
    ink_heat(self, on);
}

/* ---- the viewport ---- */

static const char output_key[] =
    "viewport.output_from_front"; /* 1: the output shows the front, independent of the camera */

/* ---- create and destroy ---- */

static bool make_parts(viewport *self, error *err)
{
    self->renderer = draw_renderer_create(err);
    if (!self->renderer)
        return false;
    draw_renderer_set_live(self->renderer, true);
    self->picture = viewport_picture_create(self->renderer);
    self->hand = virtual_hand_create(self->of);
    if (!self->picture || !self->hand) {
        error_set(err, MRT_ERR_MEMORY, "no memory for the picture of the face");
        return false;
    }
    return true;
}

static void read_settings(viewport *self)
{
    settings *s = app_settings(self->of);
    for (int i = 0; i < DRAW_VIEW_NUMBERS; ++i)
        self->camera_kept.number[i] = settings_number(s, camera_key[i], i == 2 ? 1.0 : 0.0);
    double radius = settings_number(s, radius_key, 0.0);
    self->radius_mm = radius > 0.0 && radius < 1e4 ? radius : 0.0;
}

viewport *viewport_create(app *of, error *err)
{
    viewport *self = calloc(1, sizeof *self);
    if (!self) {
        error_set(err, MRT_ERR_MEMORY, "no memory for the picture of the face");
        return NULL;
    }
    self->of = of;
    if (!make_parts(self, err)) {
        viewport_destroy(self);
        return NULL;
    }
    read_settings(self);
    return self;
}

draw_camera_view viewport_view(const viewport *self)
{
    return viewport_camera_keep(&self->camera);
}

void viewport_go_to(viewport *self, const draw_camera_view *view)
{
    viewport_camera there = self->camera;
    viewport_camera_recall(&there, view);
    self->camera.from = self->camera.now;
    self->camera.to = there.now;
    self->camera.glided_s = 0.0;
}

void viewport_destroy(viewport *self)
{
    if (!self)
        return;
    if (self->has_camera)
        keep_camera(self);
    virtual_hand_destroy(self->hand);
    drop_face(self);
    viewport_picture_destroy(self->picture);
    for (int i = 0; i < VIEWPORT_TAKERS; ++i)
        viewport_picture_destroy(self->output[i]);
    draw_backdrop_destroy(self->backdrop);
    draw_renderer_destroy(self->renderer);
    free(self->extra);
    free(self);
}

/* ---- the camera ---- */

static void do_asked(viewport *self)
{
    if (app_take_request(self->of, ACTION_VIEW_FRONT))
        viewport_camera_glide(&self->camera, VIEWPORT_FRONT);
    if (app_take_request(self->of, ACTION_VIEW_SIDE))
        viewport_camera_glide(&self->camera, VIEWPORT_SIDE);
    if (app_take_request(self->of, ACTION_VIEW_THREE_QUARTER))
        viewport_camera_glide(&self->camera, VIEWPORT_THREE_QUARTER);
    if (app_take_request(self->of, ACTION_VIEW_FRAME))
        viewport_camera_frame(&self->camera);
}

void viewport_update(viewport *self, const ui *keys, const struct window_gamepad *pad, double dt_s)
{
    self->dt_s = dt_s;
    self->radius_shown_s -= dt_s;
    virtual_hand_update(self->hand, keys, pad, dt_s);
    if (!self->has_camera)
        return;
    do_asked(self);
    viewport_camera_update(&self->camera, dt_s);
    if (app_looks_of(self->of)->is_turning && self->drag == VIEWPORT_DRAGS_NOTHING)
        viewport_camera_turn(&self->camera, dt_s);
    if (self->camera.glided_s >= 0.0 || app_looks_of(self->of)->is_turning)
        app_want_frame(self->of, 0.0);
    if (self->radius_shown_s > 0.0)
        app_want_frame(self->of, self->radius_shown_s);
    if (self->quality.level > 0) /* full resolution when the picture does not change */
        app_want_frame(self->of, 0.05);
}

/* ---- resolution ---- */

enum { QUALITIES = sizeof quality_scale / sizeof *quality_scale };
static const double slow_frame_s = 0.040, slow_for_s = 0.25, still_for_s = 0.30, fast_for_s = 1.0;

/* Returns whether a frame at the next higher resolution would still be fast enough. */
static bool has_time_for_more(const viewport *self)
{
    const uint32_t level = self->quality.level;
    if (level == 0)
        return false;
    const double more = (double)(quality_scale[level - 1] / quality_scale[level]);
    return self->dt_s * more * more < 0.75 * slow_frame_s;
}

/* Chooses the resolution. It decreases while a slow renderer must redraw each frame, increases when
 * there is time, and is full when nothing changes. */
static float choose_quality(viewport *self)
{
    viewport_quality *q = &self->quality;
    uint64_t count = viewport_picture_count(self->picture);
    const bool was_drawn = count != q->count;
    const bool is_going_on = was_drawn && q->was_drawn; /* a single slow picture does not count */
    q->count = count;
    q->was_drawn = was_drawn;
    if (!was_drawn) {
        q->slow_s = q->fast_s = 0.0;
        q->still_s += self->dt_s;
        if (q->still_s >= still_for_s)
            q->level = 0;
    } else {
        q->still_s = 0.0;
        const bool is_slow = is_going_on && self->dt_s > slow_frame_s && self->dt_s < 1.0;
        q->slow_s = is_slow ? q->slow_s + self->dt_s : 0.0;
        if (q->slow_s > slow_for_s && q->level + 1 < QUALITIES) {
            q->level += 1;
            q->slow_s = 0.0;
        }
        q->fast_s = has_time_for_more(self) ? q->fast_s + self->dt_s : 0.0;
        if (q->fast_s > fast_for_s) {
            q->level -= 1;
            q->fast_s = 0.0;
        }
    }
    return quality_scale[q->level];
}

/* ---- drawing ---- */

static uint32_t pixels(float length)
{
    return length > 1.0f ? (uint32_t)lrintf(length) : 1;
}

static void update_rectangle(viewport *self, const ui_canvas *canvas, float scale)
{
    float before = self->rectangle[3] ? aspect_of(self) : 0.0f;
    self->where = canvas->where;
    self->px_per_point = scale;
    self->rectangle[2] = pixels(canvas->where.width * scale);
    self->rectangle[3] = pixels(canvas->where.height * scale);
    if (self->has_camera && fabsf(aspect_of(self) - before) > 1e-3f)
        viewport_camera_fit(&self->camera, self->low, self->high, aspect_of(self));
}

static void make_scene(viewport *self)
{
    const app_looks *looks = app_looks_of(self->of);
    viewport_scene_of of = {.view = app_view(self->of),
                            .file = self->face.file,
                            .looks = looks,
                            .camera = &self->camera.now,
                            .aspect = aspect_of(self),
                            .px_per_point = self->px_per_point,
                            .contact_position = self->shape,
                            .stands_in = self->stands_in};
    viewport_scene_make(&self->scene, &of);
    for (uint32_t i = 0; i < self->extra_count; ++i) {
        overlay_item item = self->extra[i];
        item.width_px *= self->px_per_point;
        viewport_scene_add(&self->scene, &item);
    }
}

/* Returns the background picture of the scene on the graphics card; NULL: the wall. */
static const draw_backdrop *backdrop_of(viewport *self)
{
    uint64_t number;
    const scenery_picture *of = kept_scenery_picture(app_scenery(self->of), &number);
    if (number == self->backdrop_number)
        return self->backdrop;
    error err = {""};
    draw_backdrop_destroy(self->backdrop);
    self->backdrop = NULL;
    self->backdrop_number = number;
    if (of->rgba)
        self->backdrop = draw_backdrop_create(of->width, of->height, of->rgba, &err);
    if (of->rgba && !self->backdrop)
        say(self, MRT_LOG_WARNING, err.text);
    return self->backdrop;
}

static uint32_t draw_picture(viewport *self)
{
    float quality = choose_quality(self);
    const draw_backdrop *backdrop = backdrop_of(self);
    viewport_picture_look look = {.width = pixels(quality * (float)self->rectangle[2]),
                                  .height = pixels(quality * (float)self->rectangle[3]),
                                  .camera = self->camera.now,
                                  .scenery = kept_scenery_now(app_scenery(self->of)),
                                  .backdrop = backdrop,
                                  .backdrop_number = self->backdrop_number,
                                  .scene = &self->scene};
    error err = {{0}};
    uint32_t texture = viewport_picture_draw(self->picture, &look, &err);
    if (!texture && !self->has_failed)
        say(self, MRT_LOG_ERROR, err.text);
    self->has_failed = !texture;
    return texture;
}

static void draw_face_in(viewport *self, ui *on, const ui_canvas *canvas)
{
    follow_shape(self);
    follow_pointer(self, canvas);
    follow_colours(self);
    make_scene(self);
    uint32_t texture = ui_is_hidden(on) ? 0 : draw_picture(self);
    if (texture)
        ui_draw_image(on, canvas->where, texture, viewport_drawn(self),
                      app_looks_of(self->of)->is_mirrored);
    ink_all(self, on);
    ink_chip(self, on);
    ink_mirrored(self, on);
    ink_quality(self, on);
    bool is_moving = self->drag != VIEWPORT_DRAGS_NOTHING || self->camera.glided_s >= 0.0 ||
                     app_looks_of(self->of)->is_turning;
    if (!is_moving)
        keep_camera(self);
}

/* Prepares the shading of the face. A hidden window has not drawn yet. */
static void shade_face(viewport *self)
{
    error err = {{0}};
    self->has_face = viewport_picture_shade(self->picture, &self->face.file->mesh, &err) >= 0;
    if (!self->has_face)
        say(self, MRT_LOG_ERROR, err.text);
}

void viewport_draw(viewport *self, ui *on, ui_rectangle where, float scale)
{
    ui_canvas canvas;
    const float keys = virtual_hand_keys_height(self->hand, on, where.width, where.height);
    if (keys > 0.0f) {
        const ui_rectangle strip = {where.x, where.y, where.width, keys};
        ui_panel_begin(on, "keys", strip, UI_GROUND_PANEL);
        virtual_hand_draw_keys(self->hand, on, strip, where.height);
        ui_panel_end(on);
        where.y += keys;
        where.height -= keys;
    }
    ui_panel_begin(on, "viewport", where, UI_GROUND_NONE);
    ui_canvas_begin(on, "face", 0.0f, 0.0f, &canvas);
    ui_on_face_begin(on);
    update_rectangle(self, &canvas, scale);
    follow_face(self);
    if (self->has_face && !ui_is_hidden(on))
        shade_face(self);
    if (self->has_face)
        draw_face_in(self, on, &canvas);
    ui_on_face_end(on);
    ui_canvas_end(on);
    ui_panel_end(on);
}

/* ---- output for other programs ---- */

void viewport_set_use(viewport *self, viewport_use use, float brush_mm)
{
    self->use = use;
    self->brush_mm = brush_mm;
}

const viewport_stroke *viewport_stroke_now(const viewport *self)
{
    return &self->stroke;
}

void viewport_add(viewport *self, const struct overlay_item *item, uint32_t count)
{
    if (count > self->extra_capacity) {
        overlay_item *grown = realloc(self->extra, count * sizeof *grown);
        if (!grown)
            return;
        self->extra = grown;
        self->extra_capacity = count;
    }
    if (count > 0)
        memcpy(self->extra, item, count * sizeof *item);
    self->extra_count = count;
}

uint64_t viewport_drawn(const viewport *self)
{
    return viewport_picture_count(self->picture);
}

static draw_camera output_camera(const viewport *self, float aspect)
{
    draw_camera whole = draw_camera_framing(self->low, self->high, aspect);
    if (settings_number(app_settings(self->of), output_key, 0.0) > 0.5)
        return whole;
    draw_camera camera = self->camera.now;
    camera.distance_mm *= whole.distance_mm / self->camera.home.distance_mm;
    return camera;
}

static bool has_output(viewport *self, viewport_taker to, error *err)
{
    if (!self->output[to])
        self->output[to] = viewport_picture_create(self->renderer);
    if (!self->output[to]) {
        error_set(err, MRT_ERR_MEMORY, "no memory for the output");
        return false;
    }
    if (!self->output_has_face[to])
        self->output_has_face[to] =
            viewport_picture_face(self->output[to], &self->face.file->mesh, err) >= 0 &&
            viewport_picture_shade(self->output[to], &self->face.file->mesh, err) >= 0;
    return self->output_has_face[to];
}

void viewport_set_ground(viewport *self, const float rgba[4])
{
    self->has_ground = rgba != NULL;
    if (rgba)
        memcpy(self->ground, rgba, sizeof self->ground);
}

uint32_t viewport_output(viewport *self, viewport_taker to, uint32_t width, uint32_t height)
{
    error err = {{0}};
    if (!self->has_face || width == 0 || height == 0 || !has_output(self, to, &err))
        return 0;
    const live_view *view = app_view(self->of);
    if (view->position && view->vertex_count == self->face.vertex_count)
        viewport_picture_follow(self->output[to], view);
    const draw_backdrop *backdrop = backdrop_of(self);
    viewport_picture_look look = {.width = width,
                                  .height = height,
                                  .ground = self->has_ground ? self->ground : NULL,
                                  .scenery = kept_scenery_now(app_scenery(self->of)),
                                  .backdrop = backdrop,
                                  .backdrop_number = self->backdrop_number,
                                  .camera = output_camera(self, (float)width / (float)height)};
    return viewport_picture_draw(self->output[to], &look, &err);
}

uint64_t viewport_output_drawn(const viewport *self, viewport_taker to)
{
    return self->output[to] ? viewport_picture_count(self->output[to]) : 0;
}

uint32_t viewport_portrait(viewport *self, const float *position, uint32_t vertex_count,
                           const float ground[4], const float frame[6], uint32_t width,
                           uint32_t height)
{
    static const float closer = 0.86f, /* factors of the default camera distance, which leaves a
                                          margin around the head */
        closest = 0.68f;
    error err = {{0}};
    if (!self->has_face || vertex_count != self->face.vertex_count || width == 0 || height == 0 ||
        !has_output(self, VIEWPORT_PORTRAIT, &err))
        return 0;
    viewport_picture_shape(self->output[VIEWPORT_PORTRAIT], position, NULL);
    viewport_picture_look look = {.width = width,
                                  .height = height,
                                  .ground = ground,
                                  .scenery = kept_scenery_now(app_scenery(self->of)),
                                  .camera = draw_camera_framing(frame ? frame : self->low,
                                                                frame ? frame + 3 : self->high,
                                                                (float)width / (float)height)};
    look.camera.distance_mm *= frame ? closest : closer;
    return viewport_picture_draw(self->output[VIEWPORT_PORTRAIT], &look, &err);
}

uint32_t viewport_copy_portrait(viewport *self)
{
    viewport_picture *of = self->output[VIEWPORT_PORTRAIT];
    return of ? viewport_picture_copy(of) : 0;
}
