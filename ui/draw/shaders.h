/* draw/shaders.h - the GLSL texts of shaders/, built into the library. Const data. */
#ifndef MAROTTE_UI_DRAW_SHADERS_H
#define MAROTTE_UI_DRAW_SHADERS_H
#include <stddef.h>

typedef struct gl_source { /* GLSL without a #version line; not 0-ended */
    const char *name, *text;
    size_t size;
} gl_source;

extern const gl_source shaders_common, shaders_screen_vert, shaders_background_frag,
    shaders_resolve_frag, shaders_depth_vert, shaders_depth_frag, shaders_face_vert,
    shaders_face_frag, shaders_letters_vert, shaders_letters_frag, shaders_strokes_vert,
    shaders_strokes_frag, shaders_overlay_line_vert, shaders_overlay_line_frag,
    shaders_overlay_solid_vert, shaders_overlay_solid_frag;

#endif
