/* draw/target.h - internals of a target: its samples, and the picture that is made from them on
 * demand. A graphics card uses four samples per pixel. llvmpipe draws four pixels instead: with
 * samples the setup of a small triangle costs it several times more, and it shades hidden pixels
 * too. [thread of the context] */
#ifndef MAROTTE_UI_DRAW_TARGET_H
#define MAROTTE_UI_DRAW_TARGET_H
#include "draw/draw.h"
#include "draw/gl.h"

typedef struct target_scene { /* what draw_render draws behind a face, and where */
    GLint viewport[4];
    float edge[3], light[3]; /* colours of the wall */
    float ground[4];
    bool has_ground;
} target_scene;

struct draw_target {
    uint32_t width, height;
    GLint sample_count;
    uint32_t side; /* pixels of the framebuffer per pixel of the picture, on each side: 1, or 2
                      without samples */
    GLuint samples, depth, framebuffer;   /* multisampled buffers */
    GLuint picture, picture_framebuffer;  /* one sample per pixel, sRGB-coded */
    GLuint resolve_program, vertex_array; /* vertex_array: without attributes */
    GLint keeps_alpha;                    /* uniform of the resolve program */
    bool stale;                           /* the picture is older than the samples */
    GLint changed[4];                     /* left, bottom, right, top of the stale part */
    bool has_scene;                       /* only a face was drawn: the scene is around `covered` */
    target_scene scene;                   /* compared byte by byte */
    GLint covered[4];                     /* covered by the face; left, bottom, right, top */
    bool is_clear;                        /* alpha is coverage; else the picture is opaque */
};

/* Converts a rectangle (x, y from the top left, width, height) to pixels of the framebuffer, y from
 * the bottom. Returns false if it is outside the target, or larger than the maximum size of a
 * picture. */
bool target_viewport(GLint out[4], const draw_target *self, const uint32_t rectangle[4]);
/* Marks the whole picture as stale, and the scene as unknown. */
void target_change(draw_target *self);
/* Limits all drawing to the viewport of the target, until gl_state_leave. */
void target_begin(draw_target *self, const GLint viewport[4]);

#endif
