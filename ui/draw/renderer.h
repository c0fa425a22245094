/* draw/renderer.h - the inside of the renderer. The thread of the context. */
#ifndef MAROTTE_UI_DRAW_RENDERER_H
#define MAROTTE_UI_DRAW_RENDERER_H
#include "draw/draw.h"
#include "draw/gl.h"
#include "draw/letters.h"
#include "draw/strokes.h"

typedef struct renderer_face_program {
    GLuint program;
    GLint projection, eye, base_colour, roughness, metallic, grain_scale, light_direction;
    GLint shadow_projection, shadow_map, shadow_texel_mm, origin, has_own_colours;
} renderer_face_program;

typedef enum renderer_surface {
    RENDERER_SMOOTH,
    RENDERER_STONE,
    RENDERER_SURFACES
} renderer_surface;

struct draw_renderer {
    renderer_face_program face[RENDERER_SURFACES];
    GLuint depth_program, background_program;
    GLint depth_projection, background_origin;
    GLuint shadow_map, shadow_framebuffer;
    GLuint vertex_array; /* without attributes */
    bool has_ground;     /* a colour instead of the wall */
    float ground[4];
    letters *letters;
    strokes *strokes;
};

#endif
