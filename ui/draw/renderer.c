#include "draw/camera.h"
#include "draw/face.h"
#include "draw/renderer.h"
#include "draw/target.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Sides of the shadow map in texels: at least the height of the picture, within these limits. */
enum { SHADOW_MIN = 512, SHADOW_MAX = 1024 };
static const float shadow_reach = 4.5f / SHADOW_MAX; /* share of the map: softness of shadows */

/* Length of the fibres, as a share of the height of the face; layers that show them. */
static const float nap_share = 0.0075f;
static const float nap_least_pixels = 2.0f; /* shorter fibres only make the edge rough */
enum { NAP_LAYERS = 4, NAP_LAYERS_IN_SOFTWARE = 2 };

static void find_face_uniforms(renderer_face_program *out)
{
    GLuint p = out->program;
    out->projection = glGetUniformLocation(p, "projection");
    out->eye = glGetUniformLocation(p, "eye");
    out->base_colour = glGetUniformLocation(p, "base_colour");
    out->roughness = glGetUniformLocation(p, "roughness");
    out->metallic = glGetUniformLocation(p, "metallic");
    out->grain_scale = glGetUniformLocation(p, "grain_scale");
    out->light_direction = glGetUniformLocation(p, "light_direction");
    out->shadow_projection = glGetUniformLocation(p, "shadow_projection");
    out->shadow_map = glGetUniformLocation(p, "shadow_map");
    out->shadow_texel_mm = glGetUniformLocation(p, "shadow_texel_mm");
    out->shadow_reach_texels = glGetUniformLocation(p, "shadow_reach_texels");
    out->origin = glGetUniformLocation(p, "origin");
    out->side = glGetUniformLocation(p, "side");
    out->light_colour = glGetUniformLocation(p, "light_colour");
    out->room = glGetUniformLocation(p, "room");
    out->has_own_colours = glGetUniformLocation(p, "has_own_colours");
    out->softness = glGetUniformLocation(p, "softness");
    out->coat = glGetUniformLocation(p, "coat");
    out->cornea = glGetUniformLocation(p, "cornea");
    out->nap_mm = glGetUniformLocation(p, "nap_mm");
    out->nap_layers = glGetUniformLocation(p, "nap_layers");
    out->bounce = glGetUniformLocation(p, "bounce");
    static const char *const textures[FACE_TEXTURES] = {"base_map", "normal_map", "emission_map",
                                                        "rough_metal_map"};
    for (int i = 0; i < FACE_TEXTURES; ++i)
        out->texture[i] = glGetUniformLocation(p, textures[i]);
    out->uv_transform = glGetUniformLocation(p, "uv_transform");
    out->has_tint = glGetUniformLocation(p, "has_tint");
    out->emission = glGetUniformLocation(p, "emission");
    out->normal_scale = glGetUniformLocation(p, "normal_scale");
    out->shade = glGetUniformLocation(p, "shade");
    out->toon = glGetUniformLocation(p, "toon");
    out->alpha_range = glGetUniformLocation(p, "alpha_range");
}

static bool create_wall(renderer_wall_program *out, const char *defines, error *err)
{
    const gl_source background[] = {shaders_screen_vert, shaders_background_frag};
    const GLuint p = out->program = gl_program_create(background, defines, err);
    out->origin = glGetUniformLocation(p, "origin");
    out->side = glGetUniformLocation(p, "side");
    out->edge = glGetUniformLocation(p, "wall_edge");
    out->light = glGetUniformLocation(p, "wall_light");
    out->picture = glGetUniformLocation(p, "picture");
    out->picture_scale = glGetUniformLocation(p, "picture_scale");
    return p != 0;
}

static mrt_result create_programs(draw_renderer *self, error *err)
{
    const gl_source face[] = {shaders_face_vert, shaders_face_frag};
    const gl_source depth[] = {shaders_depth_vert, shaders_depth_frag};
#define PAINTED "#define PAINTED\n"
#define BENT    "#define NORMAL_MAP\n"
#define GLOW    "#define EMISSION\n"
#define CUT     "#define CUT\n"
    static const char *const look[LOOKS] = {
        [LOOK_SMOOTH] = "#define OWN_COLOURS\n",
        [LOOK_STONE] = "#define STONE\n",
        [LOOK_FELT] = "#define FELT\n",
        [LOOK_FUZZ] = "#define FELT\n#define FUZZ\n",
        [LOOK_PAINTED] = PAINTED,
        [LOOK_PAINTED_BENT] = PAINTED BENT,
        [LOOK_PAINTED_ALL] = PAINTED BENT GLOW "#define ROUGH_METAL\n",
        [LOOK_PAINTED_CUT] = PAINTED BENT GLOW "#define ROUGH_METAL\n" CUT,
        [LOOK_FLAT] = PAINTED GLOW "#define FLAT\n" CUT,
        [LOOK_TOON] = PAINTED BENT GLOW "#define TOON\n" CUT};
    for (int i = 0; i < LOOKS; ++i) {
        self->face[i].program = gl_program_create(face, look[i], err);
        if (!self->face[i].program)
            return MRT_ERR_UNSUPPORTED;
        find_face_uniforms(&self->face[i]);
    }
    self->depth_program = gl_program_create(depth, "", err);
    if (!self->depth_program || !create_wall(&self->wall, "", err) ||
        !create_wall(&self->picture, "#define PICTURE\n", err))
        return MRT_ERR_UNSUPPORTED;
    self->depth_projection = glGetUniformLocation(self->depth_program, "projection");
    glGenVertexArrays(1, &self->vertex_array);
    return gl_check_error("the drawing programs", err);
}

static mrt_result create_no_textures(draw_renderer *self, error *err)
{
    static const GLubyte pixel[FACE_TEXTURES][4] = {
        {255, 255, 255, 255}, {128, 128, 255, 255}, {255, 255, 255, 255}, {255, 255, 255, 255}};
    glGenTextures(FACE_TEXTURES, self->no_texture);
    for (int i = 0; i < FACE_TEXTURES; ++i) {
        glBindTexture(GL_TEXTURE_2D, self->no_texture[i]);
        glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, 1, 1, 0, GL_RGBA, GL_UNSIGNED_BYTE, pixel[i]);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    }
    return gl_check_error("the textures of plain surfaces", err);
}

/* Expects that the map is bound. */
static void size_shadow(draw_renderer *self, GLsizei side)
{
    self->shadow_side = side;
    glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT24, side, side, 0, GL_DEPTH_COMPONENT,
                 GL_UNSIGNED_INT, NULL);
}

static mrt_result create_shadow(draw_renderer *self, error *err)
{
    static const GLfloat lit[4] = {1.0f, 1.0f, 1.0f, 1.0f};
    glGenTextures(1, &self->shadow_map);
    glBindTexture(GL_TEXTURE_2D, self->shadow_map);
    size_shadow(self, SHADOW_MAX);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER);
    glTexParameterfv(GL_TEXTURE_2D, GL_TEXTURE_BORDER_COLOR, lit);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
    glGenFramebuffers(1, &self->shadow_framebuffer);
    gl_bind_framebuffer(GL_FRAMEBUFFER, self->shadow_framebuffer);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, self->shadow_map, 0);
    glDrawBuffer(GL_NONE);
    glReadBuffer(GL_NONE);
    mrt_result result = gl_check_error("the shadow map", err);
    if (result == MRT_OK && glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        result = error_set(err, MRT_ERR_UNSUPPORTED, "the graphics driver cannot draw shadows");
    return result;
}

draw_renderer *draw_renderer_create(error *err)
{
    if (gl_check_current(err) != MRT_OK)
        return NULL;
    draw_renderer *self = calloc(1, sizeof *self);
    if (!self) {
        error_set(err, MRT_ERR_MEMORY, "no memory for the renderer");
        return NULL;
    }
    self->light = lighting_looks[0].light;
    gl_state before;
    gl_state_enter(&before);
    bool made = create_programs(self, err) == MRT_OK && create_no_textures(self, err) == MRT_OK &&
                create_shadow(self, err) == MRT_OK;
    if (made)
        made = (self->letters = letters_create(letters_fonts, err)) != NULL;
    if (made)
        made = (self->strokes = strokes_create(err)) != NULL;
    if (made)
        made = (self->overlays = overlays_create(err)) != NULL;
    gl_state_leave(&before);
    if (made)
        return self;
    draw_renderer_destroy(self);
    return NULL;
}

void draw_renderer_set_live(draw_renderer *self, bool is_live)
{
    self->is_live = is_live;
}

void draw_renderer_destroy(draw_renderer *self)
{
    if (!self)
        return;
    letters_destroy(self->letters);
    strokes_destroy(self->strokes);
    overlays_destroy(self->overlays);
    for (int i = 0; i < LOOKS; ++i)
        glDeleteProgram(self->face[i].program);
    glDeleteTextures(FACE_TEXTURES, self->no_texture);
    glDeleteProgram(self->depth_program);
    glDeleteProgram(self->wall.program);
    glDeleteProgram(self->picture.program);
    glDeleteTextures(1, &self->shadow_map);
    glDeleteFramebuffers(1, &self->shadow_framebuffer);
    glDeleteVertexArrays(1, &self->vertex_array);
    free(self);
}

typedef struct view { /* one draw_render */
    draw_camera camera;
    GLint x, y; /* of the rectangle, pixels from the bottom left */
    GLsizei width, height;
    GLint side; /* pixels of the framebuffer on each side of a pixel of the picture; x, y, width and
                   height count pixels of the framebuffer */
    float light[LIGHTING_LAMPS][3];
    matrix4 shadow_projection; /* mm to clip space of the key light */
    float shadow_radius_mm;
} view;

/* Computes a unit vector towards the light. The lights turn with the camera, like a studio around a
 * turntable, so that every view is lit. */
static void turn_light(const draw_renderer *self, float out[3], lighting_lamp_name lamp,
                       float camera_yaw_rad)
{
    const float *at = self->light.lamp[lamp].direction;
    float s = (float)sin((double)camera_yaw_rad), c = (float)cos((double)camera_yaw_rad);
    out[0] = c * at[0] + s * at[2];
    out[1] = at[1];
    out[2] = c * at[2] - s * at[0];
}

static void draw_shadow(draw_renderer *self, const draw_face *face, const view *v)
{
    GLsizei side = SHADOW_MIN, height = v->height / v->side;
    while (side < height && side < SHADOW_MAX)
        side *= 2;
    if (side != self->shadow_side) {
        gl_end_scene();
        glBindTexture(GL_TEXTURE_2D, self->shadow_map);
        size_shadow(self, side);
    }
    gl_bind_framebuffer(GL_FRAMEBUFFER, self->shadow_framebuffer);
    glViewport(0, 0, side, side);
    glClear(GL_DEPTH_BUFFER_BIT);
    if (face->triangle_count == 0)
        return;
    glEnable(GL_DEPTH_TEST);
    glEnable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(1.5f, 4.0f);
    glUseProgram(self->depth_program);
    glUniformMatrix4fv(self->depth_projection, 1, GL_FALSE, v->shadow_projection.m);
    glBindVertexArray(face->vertex_array);
    face_draw_all(face);
    glDisable(GL_POLYGON_OFFSET_FILL);
}

static void clear_ground(const draw_renderer *self)
{
    glClearColor(self->ground[0], self->ground[1], self->ground[2], self->ground[3]);
    glClear(GL_COLOR_BUFFER_BIT);
}

/* Computes the share of the picture that the rectangle covers, in both directions. */
static void picture_scale(const draw_renderer *self, const view *v, float out[2])
{
    const float wider = (float)v->width / (float)v->height / self->backdrop->aspect;
    const bool is_full_width = (wider > 1.0f) == (self->fit == DRAW_COVER);
    out[0] = is_full_width ? 1.0f : wider;
    out[1] = is_full_width ? 1.0f / wider : 1.0f;
}

/* Draws the wall where nothing solid is in front of it. */
static void draw_wall(const draw_renderer *self, const view *v)
{
    const renderer_wall_program *u = self->backdrop ? &self->picture : &self->wall;
    glUseProgram(u->program);
    glUniform2i(u->origin, v->x, v->y);
    glUniform1i(u->side, v->side);
    glUniform3fv(u->edge, 1, self->light.wall_edge);
    glUniform3fv(u->light, 1, self->light.wall_light);
    if (self->backdrop) {
        float scale[2];
        picture_scale(self, v, scale);
        glActiveTexture(GL_TEXTURE1);
        glBindTexture(GL_TEXTURE_2D, self->backdrop->texture);
        glActiveTexture(GL_TEXTURE0);
        glUniform1i(u->picture, 1);
        glUniform2fv(u->picture_scale, 1, scale);
    }
    glBindVertexArray(self->vertex_array);
    glDepthFunc(GL_LEQUAL);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glDepthFunc(GL_LESS);
}

static void set_face_uniforms(const draw_renderer *self, const renderer_face_program *u,
                              const draw_face *face, const view *v)
{
    float eye[3];
    camera_eye(&v->camera, eye);
    matrix4 projection = camera_projection(&v->camera, (float)v->width / (float)v->height,
                                           face->centre, face->radius_mm);
    matrix4 shadow = camera_to_texture(&v->shadow_projection);
    glUseProgram(u->program);
    glUniformMatrix4fv(u->projection, 1, GL_FALSE, projection.m);
    glUniform3fv(u->eye, 1, eye);
    glUniform1f(u->grain_scale, 1.0f / face->height_mm);
    glUniform3fv(u->light_direction, LIGHTING_LAMPS, v->light[0]);
    float colour[LIGHTING_LAMPS][3];
    for (int lamp = 0; lamp < LIGHTING_LAMPS; ++lamp)
        for (int i = 0; i < 3; ++i)
            colour[lamp][i] = self->light.lamp[lamp].power * self->light.lamp[lamp].rgb[i];
    glUniform3fv(u->light_colour, LIGHTING_LAMPS, colour[0]);
    glUniform1f(u->room, self->light.room);
    glUniformMatrix4fv(u->shadow_projection, 1, GL_FALSE, shadow.m);
    glUniform1i(u->shadow_map, 0);
    glUniform1f(u->shadow_texel_mm, 2.0f * v->shadow_radius_mm / (float)self->shadow_side);
    glUniform1f(u->shadow_reach_texels, shadow_reach * (float)self->shadow_side);
    glUniform2i(u->origin, v->x, v->y);
    glUniform1i(u->side, v->side);
    glUniform1i(u->has_own_colours, face->colour_buffer != 0);
}

/* Passes of a painted surface, by alpha. Pixels with a < low or a >= high are skipped. */
typedef enum pass {
    PASS_SOLID = 0,   /* opaque and masked surfaces */
    PASS_CLEAR_SOLID, /* almost opaque pixels of transparent surfaces: they may hide what is behind
                         them */
    PASS_CLEAR
} pass;

static renderer_look look_of(const face_batch *batch)
{
    static const renderer_look plain[SURFACE_KINDS] = {LOOK_SMOOTH, LOOK_STONE, LOOK_FELT,
                                                       LOOK_PAINTED};
    const float *emission = batch->look.emission_colour;
    if (batch->surface.kind != SURFACE_PAINTED)
        return plain[batch->surface.kind];
    if (batch->look.lighting != MESH_LIGHTING_FULL)
        return batch->look.lighting == MESH_LIGHTING_TOON ? LOOK_TOON : LOOK_FLAT;
    if (batch->is_clear || batch->look.alpha == MESH_ALPHA_MASK)
        return LOOK_PAINTED_CUT;
    if (batch->texture[FACE_ROUGH_METAL] || emission[0] + emission[1] + emission[2] > 0.0f)
        return LOOK_PAINTED_ALL;
    return batch->texture[FACE_NORMAL_MAP] ? LOOK_PAINTED_BENT : LOOK_PAINTED;
}

static const float as_good_as_opaque = 0.95f;

static void set_painted(const draw_renderer *self, const renderer_face_program *u,
                        const draw_face *face, const face_batch *batch, pass which)
{
    const mesh_material *look = &batch->look;
    const mesh_texture *texture[FACE_TEXTURES] = {&look->base, &look->normal, &look->emission,
                                                  &look->surface};
    GLfloat uv_transform[FACE_TEXTURES][6];
    for (int i = 0; i < FACE_TEXTURES; ++i) {
        memcpy(uv_transform[i], texture[i]->uv_transform, sizeof uv_transform[i]);
        glActiveTexture(GL_TEXTURE1 + (GLenum)i);
        glBindTexture(GL_TEXTURE_2D, batch->texture[i] ? batch->texture[i] : self->no_texture[i]);
        glUniform1i(u->texture[i], 1 + i);
    }
    glActiveTexture(GL_TEXTURE0);
    glUniform3fv(u->uv_transform, 2 * FACE_TEXTURES, uv_transform[0]);
    glUniform1i(u->has_tint, face->tint_buffer != 0);
    glUniform3fv(u->emission, 1, look->emission_colour);
    glUniform1f(u->normal_scale, look->normal_scale);
    glUniform3fv(u->shade, 1, look->shade_colour);
    glUniform2f(u->toon, look->shade_shift, look->shade_toony);
    if (which == PASS_SOLID)
        glUniform2f(u->alpha_range, look->alpha == MESH_ALPHA_MASK ? look->alpha_cutoff : -1.0f,
                    2.0f);
    else
        glUniform2f(u->alpha_range, which == PASS_CLEAR ? 0.004f : as_good_as_opaque,
                    which == PASS_CLEAR ? as_good_as_opaque : 2.0f);
}

/* Light that lips, gums and tongue reflect onto teeth in the shadow of a lip. */
static const float mouth_bounce = 0.3f;

static void draw_batch(const draw_renderer *self, const draw_face *face, const face_batch *batch,
                       pass which)
{
    static const float opaque[4] = {1.0f, 1.0f, 1.0f, 1.0f};
    bool own = face->colour_buffer != 0;
    renderer_look look = own ? LOOK_SMOOTH : look_of(batch);
    const renderer_face_program *u = &self->face[look];
    glUseProgram(u->program);
    glUniform4fv(u->base_colour, 1, own ? opaque : batch->look.base_colour);
    glUniform1f(u->roughness, own ? 0.6f : batch->look.roughness);
    glUniform1f(u->metallic, own ? 0.0f : batch->look.metallic);
    glUniform1f(u->softness, own ? 0.0f : batch->surface.softness);
    glUniform1f(u->coat, own ? 0.0f : batch->surface.coat);
    glUniform1f(u->cornea, own ? 0.0f : batch->surface.cornea);
    glUniform1f(u->bounce, batch->surface.is_in_mouth && !own ? mouth_bounce : 0.0f);
    if (look >= LOOK_PAINTED) {
        set_painted(self, u, face, batch, which);
        if (batch->look.is_single_sided)
            glEnable(GL_CULL_FACE);
    }
    if (face->triangle_count)
        glDrawElements(GL_TRIANGLES, batch->index_count, GL_UNSIGNED_INT,
                       (const void *)(batch->first_index * sizeof(GLuint)));
    else
        glDrawArrays(GL_POINTS, 0, (GLsizei)face->vertex_count);
    glDisable(GL_CULL_FACE);
}

/* Colours of draw_face_colour are opaque. */
static bool is_drawn_clear(const draw_face *face, const face_batch *batch)
{
    return batch->is_clear && !face->colour_buffer;
}

static void draw_solid(const draw_renderer *self, const draw_face *face)
{
    for (uint32_t i = 0; i < face->batch_count; ++i) {
        const face_batch *batch = &face->batch[i];
        bool is_used = batch->index_count > 0 || face->triangle_count == 0;
        if (is_used && !is_drawn_clear(face, batch))
            draw_batch(self, face, batch, PASS_SOLID);
    }
}

/* How many pixels of the picture the fibres are long. */
static float nap_pixels(const draw_face *face, const view *v)
{
    const float up = v->camera.distance_mm * tanf(0.5f * v->camera.field_of_view_rad);
    return nap_share * face->height_mm * (float)v->height / (2.0f * (up > 1e-3f ? up : 1e-3f));
}

/* Draws the fibres that stand out of the felt where it ends: the inside of shells around it. What
 * is in front of the felt is culled, the rest hidden by it, so that few pixels are shaded. */
static void draw_fuzz(const draw_renderer *self, const draw_face *face, const view *v)
{
    const renderer_face_program *u = &self->face[LOOK_FUZZ];
    const GLsizei layers = gl_is_llvmpipe() ? NAP_LAYERS_IN_SOFTWARE : NAP_LAYERS;
    if (face->triangle_count == 0 || face->colour_buffer ||
        nap_pixels(face, v) < nap_least_pixels || (self->is_live && gl_is_llvmpipe()))
        return;
    glUseProgram(u->program);
    glUniform1f(u->nap_mm, nap_share * face->height_mm);
    glUniform1f(u->nap_layers, (GLfloat)layers);
    glEnable(GL_CULL_FACE);
    glCullFace(GL_FRONT);
    for (uint32_t i = 0; i < face->batch_count; ++i) {
        const face_batch *batch = &face->batch[i];
        if (!batch->surface.has_nap || batch->is_clear || batch->index_count == 0)
            continue;
        glUniform4fv(u->base_colour, 1, batch->look.base_colour);
        glUniform1f(u->roughness, batch->look.roughness);
        glUniform1f(u->metallic, batch->look.metallic);
        glDrawElementsInstanced(GL_TRIANGLES, batch->index_count, GL_UNSIGNED_INT,
                                (const void *)(batch->first_index * sizeof(GLuint)), layers);
    }
    glCullFace(GL_BACK);
    glDisable(GL_CULL_FACE);
}

static float distance_of(const face_batch *batch, const float eye[3])
{
    float x = batch->centre[0] - eye[0], y = batch->centre[1] - eye[1],
          z = batch->centre[2] - eye[2];
    return x * x + y * y + z * z;
}

/* Returns the farthest batch that is nearer than `last`, or as near and later in order. NULL: none
 * is left. */
static const face_batch *next_clear(const draw_face *face, const float eye[3],
                                    const face_batch *last)
{
    const face_batch *best = NULL;
    float best_distance = -1.0f, last_distance = last ? distance_of(last, eye) : INFINITY;
    for (uint32_t i = 0; i < face->batch_count; ++i) {
        const face_batch *batch = &face->batch[i];
        float distance = distance_of(batch, eye);
        bool is_left = distance < last_distance || (distance == last_distance && batch > last);
        if (batch->index_count > 0 && is_drawn_clear(face, batch) && is_left &&
            distance > best_distance) {
            best = batch;
            best_distance = distance;
        }
    }
    return best;
}

static void draw_clear(const draw_renderer *self, const draw_face *face, const view *v)
{
    float eye[3];
    camera_eye(&v->camera, eye);
    for (const face_batch *batch = next_clear(face, eye, NULL); batch;
         batch = next_clear(face, eye, batch))
        if (batch->surface.kind == SURFACE_PAINTED)
            draw_batch(self, face, batch, PASS_CLEAR_SOLID);
    glEnable(GL_BLEND);
    glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ZERO, GL_ONE);
    glDepthMask(GL_FALSE);
    for (const face_batch *batch = next_clear(face, eye, NULL); batch;
         batch = next_clear(face, eye, batch))
        draw_batch(self, face, batch, PASS_CLEAR);
}

static void draw_face_lit(const draw_renderer *self, const draw_face *face, const view *v)
{
    for (int i = 0; i < LOOKS; ++i)
        set_face_uniforms(self, &self->face[i], face, v);
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D, self->shadow_map);
    glBindVertexArray(face->vertex_array);
    glEnable(GL_DEPTH_TEST);
    glPointSize(4.0f * (float)v->side);
    draw_solid(self, face);
    draw_fuzz(self, face, v);
    if (!self->has_ground)
        draw_wall(self, v);
    glBindVertexArray(face->vertex_array);
    draw_clear(self, face, v);
}

/* Describes what is behind the face. Returns false if it cannot be compared. */
static bool describe_scene(target_scene *out, const draw_renderer *self, const GLint viewport[4])
{
    memset(out, 0, sizeof *out);
    memcpy(out->viewport, viewport, sizeof out->viewport);
    memcpy(out->edge, self->light.wall_edge, sizeof out->edge);
    memcpy(out->light, self->light.wall_light, sizeof out->light);
    memcpy(out->ground, self->ground, sizeof out->ground);
    out->has_ground = self->has_ground;
    return self->has_ground || !self->backdrop;
}

/* Computes the pixels of the framebuffer that the face may cover: left, bottom, right, top, with a
 * margin for rounding. */
static void find_covered(GLint out[4], const draw_face *face, const view *v)
{
    const float margin = 4.0f + 2.0f * nap_pixels(face, v),
                size[2] = {(float)v->width, (float)v->height};
    const matrix4 projection =
        camera_projection(&v->camera, size[0] / size[1], face->centre, face->radius_mm);
    float at[4];
    if (!face_find_rectangle(at, face, projection.m)) {
        at[0] = at[1] = -1.0f;
        at[2] = at[3] = 1.0f;
    }
    for (int k = 0; k < 4; ++k) {
        const float most = size[k % 2], place = (0.5f + 0.5f * at[k]) * most;
        const float wide = place + (k < 2 ? -margin : margin);
        out[k] = (k % 2 ? v->y : v->x) + (GLint)fminf(fmaxf(wide, 0.0f), most);
    }
}

/* Limits drawing to the pixels that the face covered or covers, if the target already has the same
 * scene. */
static void narrow(const draw_renderer *self, draw_target *target, const draw_face *face,
                   const view *v, bool had_scene)
{
    const GLint viewport[4] = {v->x, v->y, v->width, v->height};
    GLint covered[4], area[4];
    target_scene scene;
    const bool is_known = describe_scene(&scene, self, viewport);
    find_covered(covered, face, v);
    if (had_scene && is_known && memcmp(&scene, &target->scene, sizeof scene) == 0) {
        for (int k = 0; k < 4; ++k) {
            const bool is_before = target->covered[k] < covered[k];
            area[k] = is_before == (k < 2) ? target->covered[k] : covered[k];
        }
        memcpy(target->changed, area, sizeof area);
        glScissor(area[0], area[1], area[2] - area[0], area[3] - area[1]);
    }
    target->has_scene = is_known;
    target->scene = scene;
    memcpy(target->covered, covered, sizeof covered);
}

void draw_render(draw_renderer *self, draw_target *target, const draw_face *face,
                 const draw_camera *camera, uint32_t x, uint32_t y, uint32_t width, uint32_t height)
{
    const uint32_t rectangle[4] = {x, y, width, height};
    GLint viewport[4];
    if (!target_viewport(viewport, target, rectangle))
        return;
    view v = {.camera = camera_made_safe(camera),
              .x = viewport[0],
              .y = viewport[1],
              .width = viewport[2],
              .height = viewport[3],
              .side = (GLint)target->side,
              .shadow_radius_mm = face->radius_mm * 1.02f};
    for (lighting_lamp_name lamp = 0; lamp < LIGHTING_LAMPS; ++lamp)
        turn_light(self, v.light[lamp], lamp, v.camera.yaw_rad);
    v.shadow_projection =
        camera_light_projection(v.light[LIGHTING_KEY], face->centre, v.shadow_radius_mm);
    gl_state before;
    gl_state_enter(&before);
    draw_shadow(self, face, &v);
    const bool had_scene = target->has_scene && !target->stale;
    target_begin(target, viewport);
    glClear(GL_DEPTH_BUFFER_BIT);
    narrow(self, target, face, &v, had_scene);
    if (self->has_ground)
        clear_ground(self);
    draw_face_lit(self, face, &v);
    target->is_clear = self->has_ground && self->ground[3] < 1.0f;
    gl_state_leave(&before);
}

void draw_light(draw_renderer *self, const lighting *light)
{
    self->light = light ? *light : lighting_looks[0].light;
}

void draw_behind(draw_renderer *self, const draw_backdrop *backdrop, draw_fit fit)
{
    self->backdrop = backdrop;
    self->fit = fit;
}

void draw_ground(draw_renderer *self, const float rgba[4])
{
    self->has_ground = rgba != NULL;
    if (rgba)
        memcpy(self->ground, rgba, sizeof self->ground);
}

void draw_text(draw_renderer *self, draw_target *target, const char *words, float x, float y,
               float size_px, const float rgba[4])
{
    letters_draw(self->letters, target, words, x, y, size_px, rgba);
}

void draw_strokes(draw_renderer *self, draw_target *target, const draw_stroke *stroke,
                  uint32_t count)
{
    strokes_draw(self->strokes, target, stroke, count);
}

void draw_overlay(draw_renderer *self, draw_target *target, const draw_face *face,
                  const draw_camera *camera, const uint32_t rectangle[4], const overlay_item *item,
                  uint32_t count)
{
    const draw_camera safe = camera_made_safe(camera);
    float to_light[3];
    turn_light(self, to_light, LIGHTING_KEY, safe.yaw_rad);
    overlays_draw(self->overlays, target, face, &safe, to_light, rectangle, item, count);
}

bool draw_project(float out_px[2], const draw_camera *camera, const uint32_t rectangle[4],
                  const float point[3])
{
    if (rectangle[2] == 0 || rectangle[3] == 0)
        return false;
    draw_camera safe = camera_made_safe(camera);
    float width = (float)rectangle[2], height = (float)rectangle[3];
    matrix4 p = camera_projection(&safe, width / height, safe.target, safe.distance_mm);
    float clip[4];
    for (int row = 0; row < 4; ++row)
        clip[row] =
            p.m[row] * point[0] + p.m[4 + row] * point[1] + p.m[8 + row] * point[2] + p.m[12 + row];
    if (!(clip[3] > 0.0f))
        return false;
    out_px[0] = (float)rectangle[0] + width * (0.5f + 0.5f * clip[0] / clip[3]);
    out_px[1] = (float)rectangle[1] + height * (0.5f - 0.5f * clip[1] / clip[3]);
    return true;
}

float draw_text_width(draw_renderer *self, const char *words, float size_px)
{
    return letters_width(self->letters, words, size_px);
}

const char *draw_text_font(const draw_renderer *self)
{
    return letters_font(self->letters);
}

/* ---- a picture behind the face, on the graphics card ---- */

draw_backdrop *draw_backdrop_create(uint32_t width, uint32_t height, const uint8_t *rgba,
                                    error *err)
{
    draw_backdrop *self = calloc(1, sizeof *self);
    gl_state before;
    if (!self) {
        (void)error_set(err, MRT_ERR_MEMORY, "no memory for the picture behind the face");
        return NULL;
    }
    self->aspect = (float)width / (float)height;
    gl_state_enter(&before);
    glGenTextures(1, &self->texture);
    glBindTexture(GL_TEXTURE_2D, self->texture);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, (GLsizei)width, (GLsizei)height, 0, GL_RGBA,
                 GL_UNSIGNED_BYTE, rgba);
    glGenerateMipmap(GL_TEXTURE_2D);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    const mrt_result result = gl_check_error("the picture behind the face", err);
    gl_state_leave(&before);
    if (result >= 0)
        return self;
    draw_backdrop_destroy(self);
    return NULL;
}

void draw_backdrop_destroy(draw_backdrop *self)
{
    if (!self)
        return;
    glDeleteTextures(1, &self->texture);
    free(self);
}
