#include "window/viewport/picture.h"
#include "window/gui/theme.h"

#include "csrbf/kernel.h"
#include "draw/camera.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double least_way_mm = 0.3;
static const float vector_points = 2.8f, dot_points = 7.0f, line_points = 1.4f;

static void set_ink(float out[4], uint32_t colour, float alpha)
{
    for (int i = 0; i < 3; ++i)
        out[i] = (float)(colour >> (24 - 8 * i) & 255u) / 255.0f;
    out[3] = alpha;
}

static void set_point(float out[3], vec3 at)
{
    out[0] = (float)at.x;
    out[1] = (float)at.y;
    out[2] = (float)at.z;
}

static vec3 vec3_of(mrt_vec3 a)
{
    return (vec3){(double)a.x, (double)a.y, (double)a.z};
}

static vec3 vec3_at(const float at[3])
{
    return (vec3){(double)at[0], (double)at[1], (double)at[2]};
}

void viewport_scene_add(viewport_scene *self, const overlay_item *item)
{
    if (self->count < VIEWPORT_ITEMS_MAX)
        self->item[self->count++] = *item;
}

static float face_height(const mrt_face *about)
{
    float height = about->high.y - about->low.y;
    return height > 1.0f ? height : 1.0f;
}

/* ---- hands: in the lower corners of the picture, wherever the camera is ---- */

enum { FINGERS = 5, FINGER_JOINTS = 4 };
static const double hand_share =
    0.30; /* length of a hand from wrist to fingertip, share of the picture's height */
static const double hand_edge = 0.11; /* distance from the left or right edge, share of the width */
static const double hand_up =
    -0.20; /* position of the wrist from the middle, share of the height */
static const double hand_tilt_rad =
    0.95; /* shows the back of the hand, with the fingers towards the viewer */
static const double hand_length_mm = 190.0;
static const float absent_alpha = 0.22f;

typedef struct hand_stance {
    vec3 wrist, right, up, out; /* unit vectors of the hand's x, y, z in the face frame */
    double mm;                  /* scale from hand to picture */
} hand_stance;

static hand_stance hand_stance_of(const viewport_scene_of *of, uint32_t side)
{
    const draw_camera *c = of->camera;
    float axes[3][3];
    camera_axes_of(c, axes[0], axes[1], axes[2]);
    vec3 right = vec3_at(axes[0]), up = vec3_at(axes[1]), back = vec3_at(axes[2]);
    double high = 2.0 * tan(0.5 * (double)c->field_of_view_rad) * (double)c->distance_mm;
    double wide = high * (double)of->aspect;
    double across = wide * (0.5 - hand_edge) * (side == MRT_RIGHT ? -1.0 : 1.0);
    hand_stance pose = {.mm = high * hand_share / hand_length_mm, .right = right};
    pose.wrist = vec3_add(vec3_add(vec3_at(c->target), vec3_scale(right, across)),
                          vec3_scale(up, hand_up * high));
    double st = sin(hand_tilt_rad), ct = cos(hand_tilt_rad);
    pose.up = vec3_add(vec3_scale(up, ct), vec3_scale(back, st));
    pose.out = vec3_sub(vec3_scale(back, ct), vec3_scale(up, st));
    return pose;
}

static vec3 to_face_frame(const hand_stance *pose, mrt_vec3 joint)
{
    vec3 at = pose->wrist;
    at = vec3_add(at, vec3_scale(pose->right, pose->mm * (double)joint.x));
    at = vec3_add(at, vec3_scale(pose->up, pose->mm * (double)joint.y));
    return vec3_add(at, vec3_scale(pose->out, pose->mm * (double)joint.z));
}

static void add_bone(viewport_scene *out, const hand_stance *pose, const mrt_hand *hand, int from,
                     int to, const overlay_item *like, double radius_mm)
{
    overlay_item bone = *like;
    bone.kind = OVERLAY_BONE;
    bone.radius_mm = (float)(radius_mm * pose->mm);
    set_point(bone.from, to_face_frame(pose, hand->joint[from]));
    set_point(bone.to, to_face_frame(pose, hand->joint[to]));
    viewport_scene_add(out, &bone);
}

static void add_hand(viewport_scene *out, const viewport_scene_of *of, uint32_t side)
{
    const mrt_hand *hand = &of->view->hand[side];
    if (!hand->present && hand->time_ns == 0)
        return;
    hand_stance pose = hand_stance_of(of, side);
    uint32_t colour = side == MRT_LEFT ? THEME_LEFT : THEME_RIGHT;
    overlay_item like = {.kind = OVERLAY_BONE};
    set_ink(like.rgba, colour, hand->present ? 1.0f : absent_alpha);
    for (int finger = 0; finger < FINGERS; ++finger) {
        int first = 1 + FINGER_JOINTS * finger, tip = first + FINGER_JOINTS - 1;
        add_bone(out, &pose, hand, 0, first, &like, 8.5);
        for (int joint = first; joint < tip; ++joint)
            add_bone(out, &pose, hand, joint, joint + 1, &like, finger == 0 ? 8.5 : 7.5);
        overlay_item ball = like;
        ball.kind = OVERLAY_BALL;
        ball.radius_mm = (float)(7.0 * pose.mm);
        for (int i = 0; i < 3; ++i)
            ball.rgba[i] = 0.45f * ball.rgba[i] + 0.55f;
        set_point(ball.from, to_face_frame(&pose, hand->joint[tip]));
        set_point(ball.to, to_face_frame(&pose, hand->joint[tip]));
        viewport_scene_add(out, &ball);
    }
    for (int finger = 1; finger + 1 < FINGERS; ++finger)
        add_bone(out, &pose, hand, 1 + FINGER_JOINTS * finger, 1 + FINGER_JOINTS * (finger + 1),
                 &like, 7.5);
}

/* ---- control vectors and their reach ---- */

double viewport_half_radius(csrbf_kernel kernel)
{
    double low = 0.0, high = 1.0; /* kernels fall from 1 to 0 */
    for (int i = 0; i < 50; ++i) {
        double middle = 0.5 * (low + high);
        if (kernel_value(kernel, middle) > 0.5)
            low = middle;
        else
            high = middle;
    }
    return 0.5 * (low + high);
}

/* Returns the current pose of the bone of a contact. */
static rigid bone_of_contact(const viewport_scene_of *of, uint32_t contact)
{
    const rig *r = of->file->rig;
    uint32_t bone = r ? rig_find_bone(r, of->view->about->contacts[contact].bone) : RIG_NONE;
    return bone < RIG_BONES_MAX ? of->view->bone[bone] : rigid_identity();
}

/* Computes the ends of control vector `index` on the shown face, mm. The vector of a contact turns
 * with its bone. Returns false if there is no visible vector. */
static bool viewport_vector_shown(const viewport_scene_of *of, uint32_t index, float out_from[3],
                                  float out_to[3])
{
    const live_view *view = of->view;
    if (index >= view->pull.count || view->pull.mode == MRT_IDLE)
        return false;
    const mrt_vector *vector = &view->pull.vector[index];
    vec3 from = vec3_of(vector->start), to = vec3_of(vector->end);
    vec3 way = vec3_sub(to, from);
    if (!(vec3_length(way) >= least_way_mm))
        return false;
    if (vector->contact > 0 && vector->contact <= view->contact_count) {
        uint32_t contact = vector->contact - 1;
        rigid bone = bone_of_contact(of, contact);
        to = view->contact[contact];
        from = vec3_sub(to, rigid_rotate(&bone, way));
    }
    set_point(out_from, from);
    set_point(out_to, to);
    return true;
}

static void add_vectors(viewport_scene *out, const viewport_scene_of *of)
{
    overlay_item arrow = {.kind = OVERLAY_ARROW}, shade = arrow; /* visible on any skin colour */
    arrow.width_px = vector_points * of->px_per_point;
    shade.width_px = (vector_points + 1.6f) * of->px_per_point;
    set_ink(arrow.rgba, THEME_ACCENT, 1.0f);
    set_ink(shade.rgba, THEME_STAGE, 0.8f);
    for (uint32_t i = 0; i < of->view->pull.count; ++i) {
        if (!viewport_vector_shown(of, i, arrow.from, arrow.to))
            continue;
        memcpy(shade.from, arrow.from, sizeof shade.from);
        memcpy(shade.to, arrow.to, sizeof shade.to);
        viewport_scene_add(out, &shade);
        viewport_scene_add(out, &arrow);
    }
}

static void add_supports(viewport_scene *out, const viewport_scene_of *of)
{
    const live_view *view = of->view;
    double radius =
        view->pull.radius_mm > 0.0f ? (double)view->pull.radius_mm : view->solver.radius;
    overlay_item sphere = {.kind = OVERLAY_SPHERE,
                           .radius_mm = (float)(radius * viewport_half_radius(view->solver.kernel)),
                           .width_px = 1.0f * of->px_per_point};
    set_ink(sphere.rgba, THEME_ACCENT, 0.34f);
    float from[3];
    for (uint32_t i = 0; i < view->pull.count; ++i)
        if (viewport_vector_shown(of, i, from, sphere.from)) {
            memcpy(sphere.to, sphere.from, sizeof sphere.to);
            viewport_scene_add(out, &sphere);
        }
}

/* ---- contacts ---- */

static void add_dot(viewport_scene *out, vec3 at, float width_px, uint32_t colour)
{
    float rgba[4];
    set_ink(rgba, colour, 1.0f);
    const overlay_item dot = overlay_dot(at, width_px, rgba);
    viewport_scene_add(out, &dot);
}

static void add_contacts(viewport_scene *out, const viewport_scene_of *of)
{
    const rig *r = of->file->rig;
    for (uint32_t i = 0; r && i < r->contact_count; ++i) {
        const vec3 at = vec3_at(of->contact_position + (size_t)r->contact[i].vertex * 3);
        add_dot(out, at, dot_points * of->px_per_point, THEME_STAGE);
        add_dot(out, at, (dot_points - 2.6f) * of->px_per_point, THEME_TEXT);
    }
}

/* ---- the jaw ---- */

enum { ARC_PARTS = 24 };

static void add_line(viewport_scene *out, const overlay_item *like, vec3 from, vec3 to)
{
    overlay_item line = *like;
    set_point(line.from, from);
    set_point(line.to, to);
    viewport_scene_add(out, &line);
}

/* Adds the opening path of the incisor and its current position. */
static void add_arc(viewport_scene *out, const viewport_scene_of *of, const rig_bone *jaw,
                    uint32_t jaw_index, const rigid *carrier)
{
    bones b;
    if (!jaw->has_incisor || bones_init(&b, of->file->rig, jaw->incisor, NULL) < 0)
        return;
    overlay_item line = {.kind = OVERLAY_LINE, .width_px = line_points * of->px_per_point};
    set_ink(line.rgba, 0xe09a8affu, 1.0f);
    vec3 last = {0, 0, 0};
    for (int i = 0; i <= ARC_PARTS; ++i) {
        double open = jaw->open_min_rad + (jaw->open_max_rad - jaw->open_min_rad) * i / ARC_PARTS;
        rigid opening = bones_jaw(&b, open, 0.0, 0.0);
        vec3 at = rigid_apply(carrier, rigid_apply(&opening, jaw->incisor));
        if (i > 0)
            add_line(out, &line, last, at);
        last = at;
    }
    add_dot(out, rigid_apply(&of->view->bone[jaw_index], jaw->incisor), 8.0f * of->px_per_point,
            0xffb9a8ffu);
}

static void add_jaw(viewport_scene *out, const viewport_scene_of *of)
{
    const rig *r = of->file->rig;
    uint32_t index = 0;
    while (r && index < r->bone_count && r->bone[index].kind != BONE_JAW)
        ++index;
    if (!r || index >= r->bone_count || index >= RIG_BONES_MAX)
        return;
    const rig_bone *jaw = &r->bone[index];
    rigid carrier = jaw->parent < RIG_BONES_MAX ? of->view->bone[jaw->parent] : rigid_identity();
    vec3 left = rigid_apply(&carrier, jaw->hinge_left);
    vec3 right = rigid_apply(&carrier, jaw->hinge_right);
    vec3 beyond = vec3_scale(vec3_sub(left, right), 0.25);
    overlay_item line = {.kind = OVERLAY_LINE, .width_px = 1.6f * of->px_per_point};
    set_ink(line.rgba, 0xe09a8affu, 1.0f);
    add_line(out, &line, vec3_add(left, beyond), vec3_sub(right, beyond));
    overlay_item ball = {.kind = OVERLAY_BALL, .radius_mm = 0.013f * face_height(of->view->about)};
    set_ink(ball.rgba, 0xffb9a8ffu, 1.0f);
    add_line(out, &ball, left, left);
    add_line(out, &ball, right, right);
    add_arc(out, of, jaw, index, &carrier);
}

void viewport_scene_make(viewport_scene *out, const viewport_scene_of *of)
{
    memset(out, 0, sizeof *out);
    if (!of->view->about)
        return;
    for (uint32_t side = 0; side < 2 && of->looks->shows_hands; ++side)
        add_hand(out, of, side);
    if (of->looks->shows_supports && !of->stands_in)
        add_supports(out, of);
    if (of->looks->shows_vectors && !of->stands_in)
        add_vectors(out, of);
    if (of->looks->shows_jaw)
        add_jaw(out, of);
    if (of->looks->shows_contacts)
        add_contacts(out, of);
}

/* ---- the texture ---- */

typedef struct picture_key { /* inputs of a picture other than shape, colours and items */
    draw_camera camera;
    lighting light;
    bool has_backdrop, has_ground;
    draw_fit fit; /* fit of the backdrop */
    uint64_t backdrop_number;
    float ground[4];
} picture_key;

struct viewport_picture {
    draw_renderer *renderer;
    draw_target *target;
    uint32_t width, height;
    draw_face *face;
    uint32_t vertex_count;
    float *shape; /* vertex_count by 3; last drawn shape, if has_shape */
    bool is_shaded, has_shape, has_colours, is_stale;
    picture_key drawn;
    viewport_scene scene; /* last drawn scene */
    uint64_t count, shape_count;
};

viewport_picture *viewport_picture_create(draw_renderer *renderer)
{
    viewport_picture *self = calloc(1, sizeof *self);
    if (self)
        self->renderer = renderer;
    return self;
}

static void drop_face(viewport_picture *self)
{
    draw_face_destroy(self->face);
    free(self->shape);
    self->face = NULL;
    self->shape = NULL;
    self->vertex_count = 0;
    self->is_shaded = self->has_colours = false;
    self->is_stale = true;
}

void viewport_picture_destroy(viewport_picture *self)
{
    if (!self)
        return;
    drop_face(self);
    draw_target_destroy(self->target);
    free(self);
}

mrt_result viewport_picture_face(viewport_picture *self, const mesh *m, error *err)
{
    drop_face(self);
    if (!m)
        return MRT_OK;
    size_t size = (size_t)m->vertex_count * 3 * sizeof *self->shape;
    self->shape = malloc(size + 1);
    if (!self->shape)
        return error_set(err, MRT_ERR_MEMORY, "no memory to show the face");
    self->face = draw_face_create_unshaded(m, err);
    if (!self->face)
        return MRT_ERR_UNSUPPORTED;
    memcpy(self->shape, m->position, size);
    self->has_shape = true;
    self->vertex_count = m->vertex_count;
    return MRT_OK;
}

mrt_result viewport_picture_shade(viewport_picture *self, const mesh *m, error *err)
{
    if (self->is_shaded || !self->face)
        return MRT_OK;
    self->is_shaded = true;
    self->has_shape = false;
    return draw_face_shade(self->face, m, err);
}

static void note_shape(viewport_picture *self, bool is_kept)
{
    self->has_shape = is_kept;
    self->shape_count += 1;
    self->is_stale = true;
}

void viewport_picture_shape(viewport_picture *self, const float *position, const float *normal)
{
    size_t size = (size_t)self->vertex_count * 3 * sizeof *position;
    if (!self->face || (self->has_shape && memcmp(self->shape, position, size) == 0))
        return;
    memcpy(self->shape, position, size);
    draw_face_update(self->face, position, normal);
    note_shape(self, true);
}

void viewport_picture_follow(viewport_picture *self, const live_view *view)
{
    if (self->face && draw_face_follow(self->face, view->position, view->normal, view->changed))
        note_shape(self, false);
}

void viewport_picture_colour(viewport_picture *self, const float *rgb)
{
    if (!self->face || (!rgb && !self->has_colours))
        return;
    draw_face_colour(self->face, rgb);
    self->has_colours = rgb != NULL;
    self->is_stale = true;
}

static bool has_target(viewport_picture *self, uint32_t width, uint32_t height, error *err)
{
    if (self->target && self->width == width && self->height == height)
        return true;
    draw_target_destroy(self->target);
    self->target = draw_target_create(width, height, err);
    self->width = width;
    self->height = height;
    self->is_stale = true;
    return self->target != NULL;
}

static const lighting *light_of(const viewport_picture_look *look)
{
    return look->scenery ? &look->scenery->light : &lighting_looks[0].light;
}

static draw_fit fit_of(const viewport_picture_look *look)
{
    return look->scenery ? look->scenery->fit : DRAW_COVER;
}

/* Makes the key, zeroed first so that memcmp can compare it. */
static void make_key(picture_key *out, const viewport_picture_look *look)
{
    memset(out, 0, sizeof *out);
    out->camera = look->camera;
    out->light = *light_of(look);
    out->has_backdrop = look->backdrop != NULL;
    out->has_ground = look->ground != NULL;
    if (look->backdrop) {
        out->fit = fit_of(look);
        out->backdrop_number = look->backdrop_number;
    }
    if (look->ground)
        memcpy(out->ground, look->ground, sizeof out->ground);
}

static bool is_same_scene(const viewport_scene *kept, const viewport_scene *scene)
{
    const uint32_t count = scene ? scene->count : 0;
    return count == kept->count &&
           (count == 0 || memcmp(kept->item, scene->item, count * sizeof *scene->item) == 0);
}

static void keep_scene(viewport_scene *kept, const viewport_scene *scene)
{
    kept->count = scene ? scene->count : 0;
    if (kept->count > 0)
        memcpy(kept->item, scene->item, kept->count * sizeof *kept->item);
}

uint32_t viewport_picture_draw(viewport_picture *self, const viewport_picture_look *look,
                               error *err)
{
    if (!self->face) {
        error_set(err, MRT_ERR_ARGUMENT, "no face is open. Open one.");
        return 0;
    }
    if (!has_target(self, look->width, look->height, err))
        return 0;
    picture_key key;
    make_key(&key, look);
    if (self->is_stale || memcmp(&key, &self->drawn, sizeof key) != 0 ||
        !is_same_scene(&self->scene, look->scene)) {
        const uint32_t whole[4] = {0, 0, look->width, look->height};
        draw_light(self->renderer, light_of(look));
        draw_behind(self->renderer, look->backdrop, fit_of(look));
        draw_ground(self->renderer, look->ground);
        draw_render(self->renderer, self->target, self->face, &look->camera, 0, 0, look->width,
                    look->height);
        draw_ground(self->renderer, NULL);
        draw_behind(self->renderer, NULL,
                    DRAW_COVER); /* the backdrop may not exist at the next draw */
        if (look->scene)
            draw_overlay(self->renderer, self->target, self->face, &look->camera, whole,
                         look->scene->item, look->scene->count);
        keep_scene(&self->scene, look->scene);
        memcpy(&self->drawn, &key, sizeof key);
        self->is_stale = false;
        self->count += 1;
    }
    return draw_target_texture(self->target);
}

uint32_t viewport_picture_copy(viewport_picture *self)
{
    return self->target ? draw_target_copy(self->target) : 0;
}

uint64_t viewport_picture_count(const viewport_picture *self)
{
    return self->count;
}

uint64_t viewport_picture_shapes(const viewport_picture *self)
{
    return self->shape_count;
}
