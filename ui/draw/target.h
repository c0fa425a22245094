/* draw/target.h - the inside of a target: its samples, and the picture that is made from them when
 * somebody looks. A graphics card has four samples in each pixel; llvmpipe draws four pixels
 * instead: setting up a small triangle costs it several times more with samples, and it shades what
 * is hidden too. The thread of the context. */
#ifndef MAROTTE_UI_DRAW_TARGET_H
#define MAROTTE_UI_DRAW_TARGET_H
#include "draw/draw.h"
#include "draw/gl.h"

typedef struct target_scene { /* what draw_render has behind a face, and where */
    GLint viewport[4];
    float edge[3], light[3]; /* of the wall */
    float ground[4];
    bool has_ground;
} target_scene;

struct draw_target {
    uint32_t width, height;
    GLint sample_count;
    uint32_t
        side; /* pixels of the framebuffer to a side of the picture's: 1, or 2 without samples */
    GLuint samples, depth, framebuffer;   /* what is drawn into */
    GLuint picture, picture_framebuffer;  /* one sample per pixel, sRGB-coded */
    GLuint resolve_program, vertex_array; /* vertex_array: without attributes */
    GLint keeps_alpha;                    /* of the resolve program */
    bool stale;                           /* the picture is older than the samples */
    GLint changed[4];                     /* left, bottom, right, top of what is */
    bool has_scene;     /* nothing else was drawn than a face: around `covered` is the scene */
    target_scene scene; /* compared byte by byte */
    GLint covered[4];   /* by the face; as changed */
    bool is_clear;      /* alpha is coverage; else the picture is opaque */
};

/* A rectangle (x, y from the top left, width, height) in pixels of the framebuffer, y from below;
 * false: nothing of it is in the target, or it is larger than any picture. */
bool target_viewport(GLint out[4], const draw_target *self, const uint32_t rectangle[4]);
/* Of all of it: the picture is older, and the scene unknown. */
void target_change(draw_target *self);
/* Everything is drawn there, and nowhere else, until gl_state_leave. */
void target_begin(draw_target *self, const GLint viewport[4]);

#endif
