#include "draw/gl.h"
#include "draw/draw.h"

#include <epoxy/egl.h>

#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>

static bool current_in(const char *library, const char *function)
{
    void *handle = dlopen(library, RTLD_LAZY | RTLD_NOLOAD);
    if (!handle)
        return false;
    void *(*get_current)(void) = NULL;
    void *symbol = dlsym(handle, function);
    memcpy(&get_current, &symbol, sizeof get_current);
    bool current = get_current && get_current();
    dlclose(handle);
    return current;
}

bool gl_is_current(void)
{
    return current_in("libEGL.so.1", "eglGetCurrentContext") ||
           current_in("libGLX.so.0", "glXGetCurrentContext") ||
           current_in("libGL.so.1", "glXGetCurrentContext");
}

mrt_result gl_check_current(error *err)
{
    if (!gl_is_current())
        return error_set(err, MRT_ERR_ARGUMENT,
                         "no OpenGL context is current on this thread: create one first");
    if (!epoxy_is_desktop_gl() || epoxy_gl_version() < 33)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "the graphics driver offers \"%s\", but OpenGL 3.3 is needed. Update "
                         "the driver, or install libgl1-mesa-dri to draw without a graphics card",
                         (const char *)glGetString(GL_VERSION));
    return MRT_OK;
}

mrt_result gl_check_error(const char *what, error *err)
{
    enum { MOST_PENDING = 32 }; /* a lost context reports errors endlessly */
    GLenum first = glGetError();
    for (int i = 0; i < MOST_PENDING && glGetError() != GL_NO_ERROR; ++i)
        ;
    if (first == GL_NO_ERROR)
        return MRT_OK;
    if (first == GL_OUT_OF_MEMORY)
        return error_set(err, MRT_ERR_MEMORY, "no graphics memory for %s", what);
    return error_set(err, MRT_ERR_UNSUPPORTED, "OpenGL refused %s (error 0x%04x)", what, first);
}

static void copy_log(char *out, size_t capacity, GLuint object, bool is_program)
{
    GLsizei length = 0;
    out[0] = '\0';
    if (is_program)
        glGetProgramInfoLog(object, (GLsizei)capacity, &length, out);
    else
        glGetShaderInfoLog(object, (GLsizei)capacity, &length, out);
    for (char *c = out; *c; ++c)
        if (*c == '\n' || *c == '\r')
            *c = c[1] ? ';' : '\0';
}

static GLuint compile(GLenum type, const gl_source *source, const char *defines, error *err)
{
    static const char line[] = "\n#line 1\n";
    const char *version =
        gl_is_llvmpipe() ? "#version 330 core\n#define LLVMPIPE\n" : "#version 330 core\n";
    const GLchar *text[] = {version, defines, shaders_common.text, line, source->text};
    const GLint size[] = {-1, -1, (GLint)shaders_common.size, -1, (GLint)source->size};
    GLuint shader = glCreateShader(type);
    if (shader == 0) {
        if (gl_check_error("a shader", err) == MRT_OK)
            error_set(err, MRT_ERR_UNSUPPORTED, "OpenGL refused to make a shader");
        return 0;
    }
    glShaderSource(shader, 5, text, size);
    glCompileShader(shader);
    GLint compiled = GL_FALSE;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
    if (compiled)
        return shader;
    char log[512];
    copy_log(log, sizeof log, shader, false);
    error_set(err, MRT_ERR_UNSUPPORTED, "the graphics driver refuses the shader %s: %s",
              source->name, log);
    glDeleteShader(shader);
    return 0;
}

GLuint gl_program_create(const gl_source stages[GL_STAGE_COUNT], const char *defines, error *err)
{
    GLuint vertex = compile(GL_VERTEX_SHADER, &stages[GL_STAGE_VERTEX], defines, err);
    GLuint fragment =
        vertex ? compile(GL_FRAGMENT_SHADER, &stages[GL_STAGE_FRAGMENT], defines, err) : 0;
    GLuint program = fragment ? glCreateProgram() : 0;
    if (program) {
        glAttachShader(program, vertex);
        glAttachShader(program, fragment);
        glLinkProgram(program);
    }
    glDeleteShader(vertex); /* deleted together with the program; 0 is ignored */
    glDeleteShader(fragment);
    if (!program)
        return 0;
    GLint linked = GL_FALSE;
    glGetProgramiv(program, GL_LINK_STATUS, &linked);
    if (linked)
        return program;
    char log[512];
    copy_log(log, sizeof log, program, true);
    error_set(err, MRT_ERR_UNSUPPORTED, "the graphics driver cannot link %s with %s: %s",
              stages[GL_STAGE_VERTEX].name, stages[GL_STAGE_FRAGMENT].name, log);
    glDeleteProgram(program);
    return 0;
}

/* Sets the state at the beginning and at the end of drawing. */
static void set_usual_state(void)
{
    static const GLenum off[] = {GL_BLEND,
                                 GL_CULL_FACE,
                                 GL_DEPTH_TEST,
                                 GL_SCISSOR_TEST,
                                 GL_STENCIL_TEST,
                                 GL_POLYGON_OFFSET_FILL,
                                 GL_FRAMEBUFFER_SRGB,
                                 GL_DEPTH_CLAMP,
                                 GL_PRIMITIVE_RESTART,
                                 GL_COLOR_LOGIC_OP,
                                 GL_RASTERIZER_DISCARD};
    static const GLenum transfer[] = {GL_PACK_ROW_LENGTH,  GL_PACK_SKIP_ROWS,
                                      GL_PACK_SKIP_PIXELS, GL_UNPACK_ROW_LENGTH,
                                      GL_UNPACK_SKIP_ROWS, GL_UNPACK_SKIP_PIXELS};
    for (size_t i = 0; i < sizeof off / sizeof off[0]; ++i)
        glDisable(off[i]);
    glEnable(GL_MULTISAMPLE);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glDepthMask(GL_TRUE);
    glDepthFunc(GL_LESS);
    glClearDepth(1.0);
    glFrontFace(GL_CCW);
    glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    glBlendEquation(GL_FUNC_ADD);
    glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    for (size_t i = 0; i < sizeof transfer / sizeof transfer[0]; ++i)
        glPixelStorei(transfer[i], 0);
    for (GLuint unit = 0; unit < GL_UNITS; ++unit)
        glBindSampler(unit, 0);
    glActiveTexture(GL_TEXTURE0);
    glBindVertexArray(0);
    glUseProgram(0);
}

void gl_state_enter(gl_state *out)
{
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &out->draw_framebuffer);
    glGetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &out->read_framebuffer);
    glGetIntegerv(GL_VIEWPORT, out->viewport);
    set_usual_state();
}

void gl_state_leave(const gl_state *state)
{
    set_usual_state();
    glViewport(state->viewport[0], state->viewport[1], state->viewport[2], state->viewport[3]);
    gl_bind_framebuffer(GL_DRAW_FRAMEBUFFER, (GLuint)state->draw_framebuffer);
    gl_bind_framebuffer(GL_READ_FRAMEBUFFER, (GLuint)state->read_framebuffer);
}

void gl_read_picture(uint8_t *out_rgba, uint32_t width, uint32_t height)
{
    const size_t row_size = (size_t)width * 4;
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
    glReadPixels(0, 0, (GLsizei)width, (GLsizei)height, GL_RGBA, GL_UNSIGNED_BYTE, out_rgba);
    for (uint32_t row = 0; row < height / 2; ++row) {
        uint8_t *above = out_rgba + row * row_size;
        uint8_t *below = out_rgba + (height - 1 - row) * row_size;
        for (size_t i = 0; i < row_size; ++i) {
            const uint8_t kept = above[i];
            above[i] = below[i];
            below[i] = kept;
        }
    }
}

/* Works around a use after free in Mesa's software renderer (llvmpipe; 22.3.6, and main when this
 * was written). It frees the fence of a scene as soon as all of its threads have counted it down.
 * But the last thread may still be unlocking the mutex in the fence. That writes four zero bytes
 * into freed memory, and the allocator crashes some time later. Each thread works on the scenes in
 * order. So when a later scene is done, all threads have left the earlier fences. Until then a
 * reference is kept here. tests/window/late_fence.sh */

enum { KEPT = 16 }; /* scenes of one or two frames: drawing may lag that far behind */

typedef struct kept_scenes { /* for the context of this thread */
    GLsync fence[KEPT];
    uint32_t first, count;
    bool is_known, is_llvmpipe;
} kept_scenes;

static _Thread_local kept_scenes kept;

bool gl_is_llvmpipe(void)
{
    if (!kept.is_known) {
        const char *renderer = (const char *)glGetString(GL_RENDERER);
        kept.is_llvmpipe = renderer && strstr(renderer, "llvmpipe");
        kept.is_known = true;
    }
    return kept.is_llvmpipe;
}

static void drop_first(void)
{
    glDeleteSync(kept.fence[kept.first]);
    kept.first = (kept.first + 1) % KEPT;
    kept.count -= 1;
}

void gl_end_scene(void)
{
    if (!gl_is_llvmpipe())
        return;
    if (kept.count == KEPT) {
        (void)glClientWaitSync(kept.fence[(kept.first + 1) % KEPT], 0, GL_TIMEOUT_IGNORED);
        drop_first();
    }
    const GLsync fence = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    if (!fence)
        return;
    kept.fence[(kept.first + kept.count) % KEPT] = fence;
    kept.count += 1;
}

void gl_bind_framebuffer(GLenum target, GLuint framebuffer)
{
    if (target != GL_READ_FRAMEBUFFER && gl_is_llvmpipe()) {
        GLint before = 0;
        glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &before);
        if ((GLuint)before != framebuffer)
            gl_end_scene();
    }
    glBindFramebuffer(target, framebuffer);
}

void gl_begin_scenes(void)
{
    kept = (kept_scenes){0};
}

void gl_forget_scenes(void)
{
    if (kept.count > 0)
        glFinish();
    while (kept.count > 0)
        drop_first();
    kept = (kept_scenes){0};
}

/* ---- a context without a window ---- */

struct draw_context {
    EGLDisplay display; /* shared by the whole process, so it is never terminated */
    EGLContext context;
};

static bool library_exists(const char *name)
{
    void *handle = dlopen(name, RTLD_LAZY | RTLD_LOCAL);
    if (!handle)
        return false;
    dlclose(handle);
    return true;
}

/* Checks for the libraries, because libepoxy ends the process if it does not find them. */
static mrt_result check_libraries(error *err)
{
    if (!library_exists("libEGL.so.1"))
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "drawing without a window needs libEGL.so.1: install libegl1");
    if (!library_exists("libOpenGL.so.0") && !library_exists("libGL.so.1"))
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "drawing needs libOpenGL.so.0 or libGL.so.1: install libopengl0 or "
                         "libgl1");
    return MRT_OK;
}

static mrt_result open_display(EGLDisplay *out, error *err)
{
    const char *extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    if (!extensions || !strstr(extensions, "EGL_EXT_platform_base") ||
        !strstr(extensions, "EGL_MESA_platform_surfaceless"))
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "EGL cannot draw without a window here: install libegl-mesa0 and "
                         "libgl1-mesa-dri");
    *out = eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL);
    if (*out == EGL_NO_DISPLAY || !eglInitialize(*out, NULL, NULL))
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "EGL finds no driver (error 0x%04x): install libgl1-mesa-dri",
                         (unsigned)eglGetError());
    return MRT_OK;
}

static mrt_result make_current(draw_context *self, error *err)
{
    static const EGLint config_wanted[] = {EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT,
                                           EGL_NONE};
    static const EGLint context_wanted[] = {EGL_CONTEXT_MAJOR_VERSION,
                                            3,
                                            EGL_CONTEXT_MINOR_VERSION,
                                            3,
                                            EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                            EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                            EGL_NONE};
    EGLConfig config;
    EGLint config_count = 0;
    if (!eglBindAPI(EGL_OPENGL_API) ||
        !eglChooseConfig(self->display, config_wanted, &config, 1, &config_count) ||
        config_count < 1)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "the EGL driver offers no OpenGL: install libgl1-mesa-dri");
    self->context = eglCreateContext(self->display, config, EGL_NO_CONTEXT, context_wanted);
    if (self->context == EGL_NO_CONTEXT)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "the EGL driver offers no OpenGL 3.3 core (error 0x%04x): install "
                         "libgl1-mesa-dri, or update the graphics driver",
                         (unsigned)eglGetError());
    if (!eglMakeCurrent(self->display, EGL_NO_SURFACE, EGL_NO_SURFACE, self->context))
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "the EGL context cannot be made current (error 0x%04x): this thread may "
                         "have a window's context already",
                         (unsigned)eglGetError());
    gl_begin_scenes();
    return gl_check_current(err);
}

draw_context *draw_context_create(error *err)
{
    draw_context *self = calloc(1, sizeof *self);
    if (!self) {
        error_set(err, MRT_ERR_MEMORY, "no memory for a drawing context");
        return NULL;
    }
    if (check_libraries(err) == MRT_OK && open_display(&self->display, err) == MRT_OK &&
        make_current(self, err) == MRT_OK)
        return self;
    draw_context_destroy(self);
    return NULL;
}

const char *draw_context_driver(const draw_context *self)
{
    (void)self;
    const GLubyte *name = glGetString(GL_RENDERER);
    return name ? (const char *)name : "unknown";
}

void draw_context_destroy(draw_context *self)
{
    if (!self)
        return;
    if (self->context) {
        if (eglGetCurrentContext() == self->context) {
            gl_forget_scenes();
            eglMakeCurrent(self->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        }
        eglDestroyContext(self->display, self->context);
    }
    free(self);
}
