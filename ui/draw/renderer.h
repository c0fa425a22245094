/* draw/renderer.h - the inside of the renderer. The thread of the context. */
#ifndef MAROTTE_UI_DRAW_RENDERER_H
#define MAROTTE_UI_DRAW_RENDERER_H
#include "draw/draw.h"
#include "draw/gl.h"
#include "draw/annotations.h"
#include "draw/face.h"
#include "draw/lighting.h"
#include "draw/overlay.h"

typedef struct renderer_face_program {
    GLuint program;
    GLint projection, eye, base_colour, roughness, metallic, grain_scale, light_direction;
    GLint shadow_projection, shadow_map, shadow_texel_mm, shadow_reach_texels, origin, side,
        has_own_colours, light_colour, room;
    GLint softness, coat, bounce;
    GLint texture[FACE_TEXTURES], uv_transform, has_tint; /* of a painted surface */
    GLint emission, normal_scale, shade, toon, alpha_range;
} renderer_face_program;

/* The face's program once for each way of drawing it: software renderers compute both sides of a
 * branch, and what may be left out of a pixel hides what is behind it late. */
typedef enum renderer_look {
    LOOK_SMOOTH = 0,
    LOOK_STONE,
    LOOK_FELT,
    LOOK_PAINTED,      /* base texture, vertex colours */
    LOOK_PAINTED_BENT, /* and a normal map */
    LOOK_PAINTED_ALL,  /* and emission, roughness and metal */
    LOOK_PAINTED_CUT,  /* and alpha */
    LOOK_FLAT,         /* no light: base, emission, alpha */
    LOOK_TOON,
    LOOKS
} renderer_look;

struct draw_backdrop {
    GLuint texture;
    float aspect; /* width to height */
};

typedef struct renderer_wall_program {
    GLuint program;
    GLint origin, side, edge, light;
    GLint picture, picture_scale; /* of the one with a picture */
} renderer_wall_program;

struct draw_renderer {
    renderer_face_program face[LOOKS];
    GLuint no_texture[FACE_TEXTURES]; /* one pixel that changes nothing, for each that is missing */
    GLuint depth_program;
    GLint depth_projection;
    renderer_wall_program wall, picture; /* the wall alone; a picture before it */
    GLuint shadow_map, shadow_framebuffer;
    GLsizei shadow_side; /* texels */
    GLuint vertex_array; /* without attributes */
    lighting light;
    const draw_backdrop *backdrop; /* NULL: the wall */
    draw_fit fit;
    bool has_ground; /* a colour instead of both */
    float ground[4];
    letters *letters;
    strokes *strokes;
    overlays *overlays;
};

#endif
