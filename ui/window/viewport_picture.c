#include "window/viewport_picture.h"

#include <stdlib.h>
#include <string.h>

struct viewport_picture {
    draw_renderer *renderer;
    draw_target *target;
    uint32_t width, height;
    draw_face *face;
    uint32_t vertex_count;
    float *shape; /* vertex_count by 3: as drawn last, while has_shape */
    bool has_shape, has_colours, is_stale;
    draw_camera camera;
    viewport_scene scene;
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
    self->has_colours = false;
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
    self->face = draw_face_create(m, err);
    if (!self->face)
        return MRT_ERR_UNSUPPORTED;
    memcpy(self->shape, m->position, size);
    self->has_shape = true;
    self->vertex_count = m->vertex_count;
    return MRT_OK;
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

static bool is_same(const viewport_picture *self, const viewport_picture_look *look)
{
    uint32_t count = look->scene ? look->scene->count : 0;
    return !self->is_stale && memcmp(&self->camera, &look->camera, sizeof look->camera) == 0 &&
           count == self->scene.count &&
           (count == 0 ||
            memcmp(self->scene.item, look->scene->item, count * sizeof *look->scene->item) == 0);
}

static void keep(viewport_picture *self, const viewport_picture_look *look)
{
    self->is_stale = false;
    self->camera = look->camera;
    self->scene.count = look->scene ? look->scene->count : 0;
    if (self->scene.count > 0)
        memcpy(self->scene.item, look->scene->item, self->scene.count * sizeof *self->scene.item);
}

uint32_t viewport_picture_draw(viewport_picture *self, const viewport_picture_look *look,
                               error *err)
{
    if (!self->face) {
        error_set(err, MRT_ERR_ARGUMENT, "there is no face to be shown: open one");
        return 0;
    }
    if (!has_target(self, look->width, look->height, err))
        return 0;
    if (!is_same(self, look)) {
        const uint32_t whole[4] = {0, 0, look->width, look->height};
        draw_render(self->renderer, self->target, self->face, &look->camera, 0, 0, look->width,
                    look->height);
        if (look->scene)
            draw_overlay(self->renderer, self->target, self->face, &look->camera, whole,
                         look->scene->item, look->scene->count);
        keep(self, look);
        self->count += 1;
    }
    return draw_target_texture(self->target);
}

uint64_t viewport_picture_count(const viewport_picture *self)
{
    return self->count;
}

uint64_t viewport_picture_shapes(const viewport_picture *self)
{
    return self->shape_count;
}
