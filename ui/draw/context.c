#include "draw/draw.h"
#include "draw/gl.h"

#include <epoxy/egl.h>

#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>

struct draw_context {
    EGLDisplay display; /* of the process: other contexts may use it, so it is never terminated */
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

/* libepoxy ends the process when it does not find these. */
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
                         "EGL finds no driver to draw with (error 0x%04x): install "
                         "libgl1-mesa-dri",
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
