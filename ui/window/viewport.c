#include "window/viewport_inside.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const camera_key[VIEWPORT_CAMERA_KEPT] = {
    "viewport.camera.yaw_rad",  "viewport.camera.pitch_rad", "viewport.camera.distance",
    "viewport.camera.target_x", "viewport.camera.target_y",  "viewport.camera.target_z"};
static const char radius_key[] = "viewport.pointer_radius_mm";
static const char output_key[] = "viewport.output_from_front"; /* 1: whatever the camera does */

static void say(const viewport *self, int32_t level, const char *text)
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

static void drop_face(viewport *self)
{
    float **arrays[] = {&self->shape, &self->normal, &self->stand_in, &self->rgb, &self->paint};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; ++i) {
        free(*arrays[i]);
        *arrays[i] = NULL;
    }
    viewport_heat_destroy(self->heat);
    self->heat = NULL;
    self->has_face = self->output_has_face = self->has_paint = self->stands_in = false;
    self->has_colours = self->is_on_face = false;
    self->heat_shown = STUDIO_HEAT_NONE;
    self->contact = 0;
}

static void keep_camera(viewport *self)
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
        keep_camera(self);
    virtual_hand_destroy(self->hand);
    drop_face(self);
    viewport_picture_destroy(self->picture);
    viewport_picture_destroy(self->output);
    draw_renderer_destroy(self->renderer);
    free(self->extra);
    free(self);
}

/* ---- which face ---- */

static bool is_same_face(const viewport_face *a, const viewport_face *b)
{
    return a->file == b->file && a->rig == b->rig && a->position == b->position &&
           a->triangle == b->triangle && a->vertex_count == b->vertex_count;
}

static uint64_t hash_bytes(uint64_t hash, const void *data, size_t size)
{
    const unsigned char *at = data;
    for (size_t i = 0; i < size; ++i)
        hash = (hash ^ at[i]) * 1099511628211u; /* FNV-1a */
    return hash;
}

static uint64_t surface_of(const mesh *m)
{
    uint64_t hash = 14695981039346656037u;
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
    mesh_bounds(m, self->low, self->high);
    return true;
}

static float aspect_of(const viewport *self)
{
    return (float)self->rectangle[2] / (float)self->rectangle[3];
}

/* Another rig on the surface that is shown: what is shown, and how, stays. */
static void take_rig(viewport *self, const viewport_face *now)
{
    self->face = *now;
    self->contact = 0;
    viewport_heat_destroy(self->heat);
    self->heat = NULL;
    self->heat_shown = STUDIO_HEAT_NONE;
}

static void follow_face(viewport *self)
{
    const face_file *file = studio_face(self->of);
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
    viewport_camera_recall(&self->camera, self->camera_kept);
    self->has_camera = true;
}

/* ---- which shape ---- */

static void follow_shape(viewport *self)
{
    const live_view *view = studio_view(self->of);
    size_t count = (size_t)self->face.vertex_count * 3;
    const float *position = view->position, *normal = view->normal;
    if (self->stands_in) {
        position = self->stand_in;
        normal = self->stand_in + count;
    } else if (view->vertex_count != self->face.vertex_count) {
        return; /* the stage has not changed over to this face yet */
    }
    if (!position)
        return;
    viewport_picture_shape(self->picture, position, normal);
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
    memcpy(self->stand_in + count, normal ? normal : self->normal, count * sizeof *position);
}

/* ---- which colours ---- */

static bool has_heat(viewport *self)
{
    if (self->heat)
        return true;
    error err = {{0}};
    if (viewport_heat_create(&self->heat, self->face.file, &err) >= 0)
        return true;
    say(self, MRT_LOG_ERROR, err.text);
    studio_looks_of(self->of)->heat = STUDIO_HEAT_NONE;
    return false;
}

static void show_paint(viewport *self)
{
    if (self->is_painted_anew)
        viewport_picture_colour(self->picture, self->paint);
    self->is_painted_anew = false;
    self->has_colours = true;
    self->heat_shown = STUDIO_HEAT_NONE;
}

static void show_heat(viewport *self, studio_heat kind)
{
    uint64_t shown = viewport_picture_shapes(self->picture);
    bool depends = !viewport_heat_is_fixed(kind);
    if (kind == self->heat_shown && !(depends && shown != self->colours_of))
        return;
    viewport_heat_colour(self->heat, self->rgb, kind, self->shape, studio_view(self->of)->bone);
    viewport_picture_colour(self->picture, self->rgb);
    self->heat_shown = kind;
    self->colours_of = shown;
    self->has_colours = true;
}

static void follow_colours(viewport *self)
{
    studio_heat kind = studio_looks_of(self->of)->heat;
    if (self->has_paint) {
        show_paint(self);
    } else if (kind != STUDIO_HEAT_NONE && kind < STUDIO_HEATS && has_heat(self)) {
        show_heat(self, kind);
    } else if (self->has_colours) {
        viewport_picture_colour(self->picture, NULL);
        self->has_colours = false;
        self->heat_shown = STUDIO_HEAT_NONE;
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
    const studio_looks *looks = studio_looks_of(self->of);
    viewport_scene_of of = {.view = studio_view(self->of),
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
        say(self, MRT_LOG_ERROR, err.text);
    self->has_failed = !texture;
    return texture;
}

static void draw_face_in(viewport *self, ui *on, const ui_canvas *canvas)
{
    follow_shape(self);
    viewport_point(self, canvas);
    follow_colours(self);
    make_scene(self);
    uint32_t texture = draw_picture(self);
    if (texture)
        ui_draw_image(on, canvas->where, texture, studio_looks_of(self->of)->is_mirrored);
    viewport_ink(self, on);
    bool is_moving = self->drag != VIEWPORT_DRAGS_NOTHING || self->camera.glided_s >= 0.0 ||
                     studio_looks_of(self->of)->is_turning;
    if (!is_moving)
        keep_camera(self);
}

void viewport_draw(viewport *self, ui *on, ui_rectangle where, float scale)
{
    ui_canvas canvas;
    ui_panel_begin(on, "viewport", where, UI_GROUND_NONE);
    ui_canvas_begin(on, "face", 0.0f, 0.0f, &canvas);
    take_place(self, &canvas, scale);
    follow_face(self);
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
        viewport_picture_shape(self->output, view->position, view->normal);
    viewport_picture_look look = {.width = width,
                                  .height = height,
                                  .camera = output_camera(self, (float)width / (float)height)};
    return viewport_picture_draw(self->output, &look, &err);
}
