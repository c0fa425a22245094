#include "window/viewport_inside.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const camera_key[VIEWPORT_CAMERA_KEPT] = {
    "viewport.camera.yaw_rad",  "viewport.camera.pitch_rad", "viewport.camera.distance",
    "viewport.camera.target_x", "viewport.camera.target_y",  "viewport.camera.target_z"};
static const char radius_key[] = "viewport.pointer_radius_mm";
static const char output_key[] = "viewport.output_from_front"; /* 1: whatever the camera does */

void viewport_say(const viewport *self, int32_t level, const char *text)
{
    news_list_add(studio_news(self->of), level, "picture", text);
}

/* ---- made and unmade ---- */

static bool make_parts(viewport *self, error *err)
{
    self->renderer = draw_renderer_create(err);
    if (!self->renderer)
        return false;
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
    settings *s = studio_settings(self->of);
    for (int i = 0; i < VIEWPORT_CAMERA_KEPT; ++i)
        self->camera_kept[i] = settings_number(s, camera_key[i], i == 2 ? 1.0 : 0.0);
    double radius = settings_number(s, radius_key, 0.0);
    self->radius_mm = radius > 0.0 && radius < 1e4 ? radius : 0.0;
}

viewport *viewport_create(studio *of, error *err)
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

void viewport_keep_camera(viewport *self)
{
    double now[VIEWPORT_CAMERA_KEPT];
    viewport_camera_keep(&self->camera, now);
    if (memcmp(now, self->camera_kept, sizeof now) == 0)
        return;
    memcpy(self->camera_kept, now, sizeof now);
    for (int i = 0; i < VIEWPORT_CAMERA_KEPT; ++i)
        settings_set_number(studio_settings(self->of), camera_key[i], now[i]);
}

void viewport_destroy(viewport *self)
{
    if (!self)
        return;
    if (self->has_camera)
        viewport_keep_camera(self);
    virtual_hand_destroy(self->hand);
    viewport_drop_face(self);
    viewport_picture_destroy(self->picture);
    viewport_picture_destroy(self->output);
    draw_renderer_destroy(self->renderer);
    free(self->extra);
    free(self);
}

float viewport_aspect(const viewport *self)
{
    return (float)self->rectangle[2] / (float)self->rectangle[3];
}

/* ---- the camera ---- */

static void do_asked(viewport *self)
{
    if (studio_asked(self->of, ACTION_VIEW_FRONT))
        viewport_camera_glide(&self->camera, VIEWPORT_FRONT);
    if (studio_asked(self->of, ACTION_VIEW_SIDE))
        viewport_camera_glide(&self->camera, VIEWPORT_SIDE);
    if (studio_asked(self->of, ACTION_VIEW_THREE_QUARTER))
        viewport_camera_glide(&self->camera, VIEWPORT_THREE_QUARTER);
    if (studio_asked(self->of, ACTION_VIEW_FRAME))
        viewport_camera_frame(&self->camera);
}

void viewport_update(viewport *self, const ui *keys, const struct front_gamepad *pad, double dt_s)
{
    self->dt_s = dt_s;
    self->radius_shown_s -= dt_s;
    virtual_hand_update(self->hand, keys, pad, dt_s);
    if (!self->has_camera)
        return;
    do_asked(self);
    viewport_camera_update(&self->camera, dt_s);
    if (studio_looks_of(self->of)->is_turning && self->drag == VIEWPORT_DRAGS_NOTHING)
        viewport_camera_turn(&self->camera, dt_s);
}

/* ---- how many pixels ---- */

static const float quality_scale[] = {1.0f, 0.7f, 0.5f, 0.35f};
enum { QUALITIES = sizeof quality_scale / sizeof *quality_scale };
static const double slow_frame_s = 0.040, slow_for_s = 0.25, still_for_s = 0.30;

/* A renderer that takes long is given fewer pixels while it must draw anew each frame; all of them
 * once the picture stands still. */
static float choose_quality(viewport *self)
{
    viewport_quality *q = &self->quality;
    uint64_t count = viewport_picture_count(self->picture);
    bool was_drawn = count != q->count;
    q->count = count;
    if (!was_drawn) {
        q->slow_s = 0.0;
        q->still_s += self->dt_s;
        if (q->still_s >= still_for_s)
            q->level = 0;
    } else {
        q->still_s = 0.0;
        bool is_slow = self->dt_s > slow_frame_s && self->dt_s < 1.0;
        q->slow_s = is_slow ? q->slow_s + self->dt_s : 0.0;
        if (q->slow_s > slow_for_s && q->level + 1 < QUALITIES) {
            q->level += 1;
            q->slow_s = 0.0;
        }
    }
    return quality_scale[q->level];
}

/* ---- drawing ---- */

static uint32_t pixels(float length)
{
    return length > 1.0f ? (uint32_t)lrintf(length) : 1;
}

static void take_place(viewport *self, const ui_canvas *canvas, float scale)
{
    float before = self->rectangle[3] ? viewport_aspect(self) : 0.0f;
    self->where = canvas->where;
    self->px_per_point = scale;
    self->rectangle[2] = pixels(canvas->where.width * scale);
    self->rectangle[3] = pixels(canvas->where.height * scale);
    if (self->has_camera && fabsf(viewport_aspect(self) - before) > 1e-3f)
        viewport_camera_fit(&self->camera, self->low, self->high, viewport_aspect(self));
}

static void make_scene(viewport *self)
{
    const studio_looks *looks = studio_looks_of(self->of);
    viewport_scene_of of = {.view = studio_view(self->of),
                            .file = self->face.file,
                            .looks = looks,
                            .camera = &self->camera.now,
                            .aspect = viewport_aspect(self),
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

static uint32_t draw_picture(viewport *self)
{
    float quality = choose_quality(self);
    viewport_picture_look look = {.width = pixels(quality * (float)self->rectangle[2]),
                                  .height = pixels(quality * (float)self->rectangle[3]),
                                  .camera = self->camera.now,
                                  .scene = &self->scene};
    error err = {{0}};
    uint32_t texture = viewport_picture_draw(self->picture, &look, &err);
    if (!texture && !self->has_failed)
        viewport_say(self, MRT_LOG_ERROR, err.text);
    self->has_failed = !texture;
    return texture;
}

static void draw_face_in(viewport *self, ui *on, const ui_canvas *canvas)
{
    viewport_follow_shape(self);
    viewport_point(self, canvas);
    viewport_follow_colours(self);
    make_scene(self);
    uint32_t texture = draw_picture(self);
    if (texture)
        ui_draw_image(on, canvas->where, texture, studio_looks_of(self->of)->is_mirrored);
    viewport_ink(self, on);
    bool is_moving = self->drag != VIEWPORT_DRAGS_NOTHING || self->camera.glided_s >= 0.0 ||
                     studio_looks_of(self->of)->is_turning;
    if (!is_moving)
        viewport_keep_camera(self);
}

void viewport_draw(viewport *self, ui *on, ui_rectangle where, float scale)
{
    ui_canvas canvas;
    ui_panel_begin(on, "viewport", where, UI_GROUND_NONE);
    ui_canvas_begin(on, "face", 0.0f, 0.0f, &canvas);
    take_place(self, &canvas, scale);
    viewport_follow_face(self);
    if (self->has_face)
        draw_face_in(self, on, &canvas);
    ui_canvas_end(on);
    ui_panel_end(on);
}

/* ---- for others ---- */

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
    if (settings_number(studio_settings(self->of), output_key, 0.0) > 0.5)
        return whole;
    draw_camera camera = self->camera.now;
    camera.distance_mm *= whole.distance_mm / self->camera.home.distance_mm;
    return camera;
}

static bool has_output(viewport *self, error *err)
{
    if (!self->output)
        self->output = viewport_picture_create(self->renderer);
    if (!self->output) {
        error_set(err, MRT_ERR_MEMORY, "no memory for the output window");
        return false;
    }
    if (!self->output_has_face)
        self->output_has_face =
            viewport_picture_face(self->output, &self->face.file->mesh, err) >= 0;
    return self->output_has_face;
}

uint32_t viewport_output(viewport *self, uint32_t width, uint32_t height)
{
    error err = {{0}};
    if (!self->has_face || width == 0 || height == 0 || !has_output(self, &err))
        return 0;
    const live_view *view = studio_view(self->of);
    if (view->position && view->vertex_count == self->face.vertex_count)
        viewport_picture_follow(self->output, view);
    viewport_picture_look look = {.width = width,
                                  .height = height,
                                  .camera = output_camera(self, (float)width / (float)height)};
    return viewport_picture_draw(self->output, &look, &err);
}
