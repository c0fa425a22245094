/* draw/gl.h - OpenGL functions that all drawing files use: checks of context and errors, programs,
 * the end of a scene, and the state before and after drawing. [thread of the context] */
#ifndef MAROTTE_UI_DRAW_GL_H
#define MAROTTE_UI_DRAW_GL_H
#include "base/error.h"

#include <epoxy/gl.h>

#include <stddef.h>

/* Returns whether this thread has a current context, of EGL or GLX. Check this first: libepoxy ends
 * the process if a GL function is called without one. */
bool gl_is_current(void);
/* Checks that there is a current context, of OpenGL 3.3 or newer. */
CHECKED mrt_result gl_check_current(error *err);
/* Returns MRT_OK, or the error of glGetError with `what` as its subject. Clears all pending
 * errors. */
CHECKED mrt_result gl_check_error(const char *what, error *err);

/* ---- programs; the source texts in shaders/ are built into the library ---- */

typedef struct gl_source { /* GLSL without a #version line, not terminated by 0 */
    const char *name, *text;
    size_t size;
} gl_source;

extern const gl_source shaders_common, shaders_screen_vert, shaders_background_frag,
    shaders_resolve_frag, shaders_depth_vert, shaders_depth_frag, shaders_face_vert,
    shaders_face_frag, shaders_letters_vert, shaders_letters_frag, shaders_strokes_vert,
    shaders_strokes_frag, shaders_overlay_line_vert, shaders_overlay_line_frag,
    shaders_overlay_solid_vert, shaders_overlay_solid_frag;

typedef enum gl_stage { GL_STAGE_VERTEX, GL_STAGE_FRAGMENT, GL_STAGE_COUNT } gl_stage;
/* Returns 0 on failure. Each stage begins with `defines` ("" or lines of #define) and the text of
 * common.glsl. */
GLuint gl_program_create(const gl_source stages[GL_STAGE_COUNT], const char *defines, error *err);

/* Returns whether the driver is Mesa's software renderer. */
bool gl_is_llvmpipe(void);

/* Binds a framebuffer, and ends the scene that was drawn into the previous one. Nothing else binds
 * framebuffers. */
void gl_bind_framebuffer(GLenum target, GLuint framebuffer);
/* Ends a scene. Call it before a blit, reading pixels, showing a window, or changing a texture that
 * was drawn with. */
void gl_end_scene(void);
/* Forgets the scenes of the previous context. Call it after a new context was made current on this
 * thread. */
void gl_begin_scenes(void);
/* Call it before the context of a thread is destroyed or released. */
void gl_forget_scenes(void);

/* Reads the framebuffer that is bound for reading: RGBA, rows from the top (OpenGL's first row is
 * the lowest). */
void gl_read_picture(uint8_t *out_rgba, uint32_t width, uint32_t height);

enum { GL_UNITS = 5 };    /* number of texture units that are used here */
typedef struct gl_state { /* state of the caller */
    GLint draw_framebuffer, read_framebuffer, viewport[4];
} gl_state;
/* Saves the state of the caller, and sets the state for drawing: everything disabled, all writes
 * enabled, nothing bound. */
void gl_state_enter(gl_state *out);
/* Sets the same state, and binds the caller's framebuffers. Textures and buffers are not restored;
 * their users bind them again. */
void gl_state_leave(const gl_state *state);

#endif
