#include "window/viewport_inside.h"

#include <stdlib.h>
#include <string.h>

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

void viewport_drop_face(viewport *self)
{
    viewport_let_go(self);
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

static bool take_face(viewport *self, const viewport_face *now, error *err)
{
    viewport_drop_face(self);
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

/* Another rig on the surface that is shown: what is shown, and how, stays. */
static void take_rig(viewport *self, const viewport_face *now)
{
    self->face = *now;
    self->contact = 0;
    viewport_heat_destroy(self->heat);
    self->heat = NULL;
    self->heat_shown = STUDIO_HEAT_NONE;
}

void viewport_follow_face(viewport *self)
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
        viewport_drop_face(self);
    self->face = now;
    self->surface = surface;
    self->has_face = file && take_face(self, &now, &err);
    if (file && !self->has_face)
        viewport_say(self, MRT_LOG_ERROR, err.text);
    if (!self->has_face)
        return;
    if (self->has_camera)
        viewport_keep_camera(self);
    viewport_camera_init(&self->camera, self->low, self->high, viewport_aspect(self));
    viewport_camera_recall(&self->camera, self->camera_kept);
    self->has_camera = true;
}

/* ---- which shape ---- */

void viewport_follow_shape(viewport *self)
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
    viewport_say(self, MRT_LOG_ERROR, err.text);
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

void viewport_follow_colours(viewport *self)
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
