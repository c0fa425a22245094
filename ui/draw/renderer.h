/* draw/renderer.h - internals of the renderer. [thread of the context] */
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
    GLint softness, coat, cornea, bounce;
    GLint nap_mm, nap_layers;                             /* of fuzz */
    GLint texture[FACE_TEXTURES], uv_transform, has_tint; /* of painted surfaces */
    GLint emission, normal_scale, shade, toon, alpha_range;
} renderer_face_program;

/* Variants of the program of the face. Software renderers compute both sides of a branch. A program
 * that may discard pixels cannot test the depth early. */
typedef enum renderer_look {
    LOOK_SMOOTH = 0,
    LOOK_STONE,
    LOOK_FELT,
    LOOK_FUZZ,         /* fibres around felt, where it ends */
    LOOK_PAINTED,      /* with base texture and vertex colours */
    LOOK_PAINTED_BENT, /* and with a normal map */
    LOOK_PAINTED_ALL,  /* and with emission, roughness and metal */
    LOOK_PAINTED_CUT,  /* and with alpha */
    LOOK_FLAT,         /* unlit: base, emission, alpha */
    LOOK_TOON,
    LOOKS
} renderer_look;

struct draw_backdrop {
    GLuint texture;
    float aspect; /* width / height */
};

typedef struct renderer_wall_program {
    GLuint program;
    GLint origin, side, edge, light;
    GLint picture, picture_scale; /* of the program with a picture */
} renderer_wall_program;

struct draw_renderer {
    renderer_face_program face[LOOKS];
    GLuint no_texture[FACE_TEXTURES]; /* textures of one neutral pixel, for missing ones */
    GLuint depth_program;
    GLint depth_projection;
    renderer_wall_program wall, picture; /* only the wall; a picture in front of it */
    GLuint shadow_map, shadow_framebuffer;
    GLsizei shadow_side; /* side in texels */
    GLuint vertex_array; /* without attributes */
    lighting light;
    const draw_backdrop *backdrop; /* NULL: the wall */
    draw_fit fit;
    bool is_live;
    bool has_ground; /* one colour instead of wall and picture */
    float ground[4];
    letters *letters;
    strokes *strokes;
    overlays *overlays;
};

#endif
