/* draw/gl.h - what every drawing file needs of OpenGL: is there a context, does this program
 * compile, where one scene ends, and the state that drawing starts from and leaves. The thread of
 * the context. */
#ifndef MAROTTE_UI_DRAW_GL_H
#define MAROTTE_UI_DRAW_GL_H
#include "base/error.h"

#include <epoxy/gl.h>

#include <stddef.h>

/* Whether this thread has a current context, by EGL or GLX. libepoxy ends the process when a GL
 * function is called without one, so this is asked first. */
bool gl_is_current(void);
/* The above, and that the context is OpenGL 3.3 or newer. */
CHECKED mrt_result gl_check_current(error *err);
/* MRT_OK, or what glGetError says about `what`; clears every pending error. */
CHECKED mrt_result gl_check_error(const char *what, error *err);

/* ---- programs; the texts of shaders/ are built into the library ---- */

typedef struct gl_source { /* GLSL without a #version line; not 0-ended */
    const char *name, *text;
    size_t size;
} gl_source;

extern const gl_source shaders_common, shaders_screen_vert, shaders_background_frag,
    shaders_resolve_frag, shaders_depth_vert, shaders_depth_frag, shaders_face_vert,
    shaders_face_frag, shaders_letters_vert, shaders_letters_frag, shaders_strokes_vert,
    shaders_strokes_frag, shaders_overlay_line_vert, shaders_overlay_line_frag,
    shaders_overlay_solid_vert, shaders_overlay_solid_frag;

typedef enum gl_stage { GL_STAGE_VERTEX, GL_STAGE_FRAGMENT, GL_STAGE_COUNT } gl_stage;
/* 0: failed. Every stage sees `defines` ("" or lines of #define) and the text of common.glsl before
 * its own. */
GLuint gl_program_create(const gl_source stages[GL_STAGE_COUNT], const char *defines, error *err);

/* Mesa's software renderer. */
bool gl_is_llvmpipe(void);

/* Framebuffers are bound by this alone: what was drawn into the one before is a scene. */
void gl_bind_framebuffer(GLenum target, GLuint framebuffer);
/* Before what ends a scene otherwise: a blit, reading pixels, showing a window, changing a texture
 * that was drawn with. */
void gl_end_scene(void);
/* A context that is new was made current on this thread: what is kept of one before is not its. */
void gl_begin_scenes(void);
/* Before a thread's context is destroyed or let go. */
void gl_forget_scenes(void);

/* Of the framebuffer that is bound for reading; RGBA, rows from the top (OpenGL's first row is the
 * lowest). */
void gl_read_picture(uint8_t *out_rgba, uint32_t width, uint32_t height);

enum { GL_UNITS = 5 };    /* of textures, that drawing here uses */
typedef struct gl_state { /* of the caller: where it draws */
    GLint draw_framebuffer, read_framebuffer, viewport[4];
} gl_state;
/* Saves it, then sets what drawing here starts from: nothing enabled, everything written, nothing
 * bound. */
void gl_state_enter(gl_state *out);
/* The same, drawn to the caller's framebuffers again: textures and buffers are bound anew by
 * whoever uses them. */
void gl_state_leave(const gl_state *state);

#endif
