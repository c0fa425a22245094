/* draw/gl.h - what every drawing file needs of OpenGL: is there a context, does this program
 * compile, where one scene ends, and leaving the state of a window as it was. The thread of the
 * context. */
#ifndef MAROTTE_UI_DRAW_GL_H
#define MAROTTE_UI_DRAW_GL_H
#include "base/error.h"
#include "draw/shaders.h"

#include <epoxy/gl.h>

/* Whether this thread has a current context, by EGL or GLX. libepoxy ends the process when a GL
 * function is called without one, so this is asked first. */
bool gl_is_current(void);
/* The above, and that the context is OpenGL 3.3 or newer. */
CHECKED mrt_result gl_check_current(error *err);
/* MRT_OK, or what glGetError says about `what`; clears every pending error. */
CHECKED mrt_result gl_check_error(const char *what, error *err);

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

enum { GL_STATE_UNITS = 5, GL_STATE_SWITCHES = 12 };
typedef struct gl_state { /* of the caller: a window, a user interface */
    GLint draw_framebuffer, read_framebuffer, program, vertex_array, array_buffer, unit;
    GLint texture[GL_STATE_UNITS], multisample_texture[GL_STATE_UNITS], sampler[GL_STATE_UNITS];
    GLint viewport[4], scissor[4], pack[4], unpack[4], pack_buffer, unpack_buffer;
    GLint blend_source[2], blend_destination[2], blend_equation[2];
    GLint cull_face, front_face, depth_function, polygon_mode[2];
    GLfloat clear_colour[4], polygon_offset[2], point_size;
    GLdouble clear_depth;
    GLboolean colour_mask[4], depth_mask, enabled[GL_STATE_SWITCHES];
} gl_state;
/* Saves, then sets what drawing here starts from: nothing enabled, everything written. */
void gl_state_enter(gl_state *out);
void gl_state_leave(const gl_state *state);

#endif
