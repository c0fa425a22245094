#include "window/front_output.h"

#include "base/slot.h"
#include "draw/gl.h"
#include "window/front_inside.h"

#include <pthread.h>
#include <stdlib.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

enum { PICTURES = 3, SMALL_WIDTH = 960, SMALL_HEIGHT = 540 };

typedef struct picture { /* of the slot's three: [main] fills it, the thread shows it */
    GLuint texture, framebuffer;
    uint32_t width, height;
    bool is_mirrored;
    GLsync filled, shown;
} picture;

struct front_output {
    GLFWwindow *window, *main_window;
    GLuint read_framebuffer;
    picture picture[PICTURES];
    publish_slot slot;

    pthread_t thread;
    bool has_thread;
    pthread_mutex_t mutex; /* guards what follows */
    pthread_cond_t wake;
    bool has_mutex, is_new, stop, has_failed;
    uint32_t width_px, height_px; /* of the window */

    bool is_dragged;
    double drag_x, drag_y;
};

/* ---- the thread ---- */

static bool wait_for_picture(front_output *self, uint32_t *out_width, uint32_t *out_height)
{
    pthread_mutex_lock(&self->mutex);
    while (!self->is_new && !self->stop)
        pthread_cond_wait(&self->wake, &self->mutex);
    self->is_new = false;
    *out_width = self->width_px;
    *out_height = self->height_px;
    const bool goes_on = !self->stop;
    pthread_mutex_unlock(&self->mutex);
    return goes_on;
}

static void show(front_output *self, const front_fill *fill, uint32_t width, uint32_t height)
{
    if (!slot_take(&self->slot))
        return;
    picture *one = &self->picture[slot_front(&self->slot)];
    if (one->filled)
        glWaitSync(one->filled, 0, GL_TIMEOUT_IGNORED);
    front_fill_draw(fill, one->texture, one->is_mirrored, width, height);
    if (one->shown)
        glDeleteSync(one->shown);
    one->shown = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl_end_scene();
    glfwSwapBuffers(self->window);
}

static void *run(void *data)
{
    front_output *self = data;
    front_fill fill = {0};
    uint32_t width, height;
    error ignored;
    glfwMakeContextCurrent(self->window);
    glfwSwapInterval(1);
    const bool can_draw = front_fill_init(&fill, &ignored) == MRT_OK;
    pthread_mutex_lock(&self->mutex);
    self->has_failed = !can_draw;
    pthread_mutex_unlock(&self->mutex);
    while (can_draw && wait_for_picture(self, &width, &height))
        show(self, &fill, width, height);
    front_fill_finish(&fill);
    gl_forget_scenes();
    glfwMakeContextCurrent(NULL);
    return NULL;
}

/* ---- the window ---- */

static bool is_within(GLFWmonitor *monitor, int x, int y)
{
    int left, top;
    const GLFWvidmode *mode = glfwGetVideoMode(monitor);
    glfwGetMonitorPos(monitor, &left, &top);
    return mode && x >= left && x < left + mode->width && y >= top && y < top + mode->height;
}

/* The first monitor that the stage is not on; NULL: there is one monitor. */
static GLFWmonitor *other_monitor(GLFWwindow *main_window)
{
    int count = 0, x, y, width, height;
    GLFWmonitor **monitors = glfwGetMonitors(&count);
    glfwGetWindowPos(main_window, &x, &y);
    glfwGetWindowSize(main_window, &width, &height);
    for (int i = 0; i < count && count > 1; ++i)
        if (!is_within(monitors[i], x + width / 2, y + height / 2) && glfwGetVideoMode(monitors[i]))
            return monitors[i];
    return NULL;
}

static GLFWwindow *open_window(GLFWwindow *main_window)
{
    GLFWmonitor *monitor = other_monitor(main_window);
    const GLFWvidmode *mode = monitor ? glfwGetVideoMode(monitor) : NULL;
    glfwWindowHint(GLFW_DECORATED, GLFW_FALSE);
    glfwWindowHint(GLFW_AUTO_ICONIFY, GLFW_FALSE);
    glfwWindowHint(GLFW_FOCUS_ON_SHOW, GLFW_FALSE);
    glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_FALSE);
    if (mode) { /* the mode that it has: nothing flickers */
        glfwWindowHint(GLFW_RED_BITS, mode->redBits);
        glfwWindowHint(GLFW_GREEN_BITS, mode->greenBits);
        glfwWindowHint(GLFW_BLUE_BITS, mode->blueBits);
        glfwWindowHint(GLFW_REFRESH_RATE, mode->refreshRate);
    }
    GLFWwindow *out =
        glfwCreateWindow(mode ? mode->width : SMALL_WIDTH, mode ? mode->height : SMALL_HEIGHT,
                         "marotte: output", monitor, main_window);
    if (out && monitor)
        glfwSetInputMode(out, GLFW_CURSOR, GLFW_CURSOR_HIDDEN);
    return out;
}

/* Without a frame it is dragged by the picture. */
static void on_button(GLFWwindow *window, int button, int action, int modifiers)
{
    front_output *self = glfwGetWindowUserPointer(window);
    (void)modifiers;
    if (button != GLFW_MOUSE_BUTTON_LEFT || glfwGetWindowMonitor(window))
        return;
    self->is_dragged = action == GLFW_PRESS;
    glfwGetCursorPos(window, &self->drag_x, &self->drag_y);
}

static void on_move(GLFWwindow *window, double x, double y)
{
    front_output *self = glfwGetWindowUserPointer(window);
    int left, top;
    if (!self->is_dragged)
        return;
    glfwGetWindowPos(window, &left, &top);
    glfwSetWindowPos(window, left + (int)(x - self->drag_x), top + (int)(y - self->drag_y));
}

static void make_pictures(front_output *self)
{
    glGenFramebuffers(1, &self->read_framebuffer);
    for (uint32_t i = 0; i < PICTURES; ++i) {
        glGenTextures(1, &self->picture[i].texture);
        glGenFramebuffers(1, &self->picture[i].framebuffer);
    }
}

static mrt_result start(front_output *self, error *err)
{
    self->window = open_window(self->main_window);
    if (!self->window) {
        const char *why = NULL;
        (void)glfwGetError(&why);
        return error_set(err, MRT_ERR_UNSUPPORTED, "the output window cannot be opened: %s",
                         why ? why : "the display refuses it");
    }
    glfwSetWindowUserPointer(self->window, self);
    glfwSetMouseButtonCallback(self->window, on_button);
    glfwSetCursorPosCallback(self->window, on_move);
    make_pictures(self);
    slot_init(&self->slot);
    self->has_mutex =
        pthread_mutex_init(&self->mutex, NULL) == 0 && pthread_cond_init(&self->wake, NULL) == 0;
    self->has_thread = self->has_mutex && pthread_create(&self->thread, NULL, run, self) == 0;
    return self->has_thread
               ? MRT_OK
               : error_set(err, MRT_ERR_MEMORY, "the output cannot be drawn: no thread for it");
}

mrt_result front_output_create(front_output **out, GLFWwindow *main_window, error *err)
{
    *out = NULL;
    front_output *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the output");
    self->main_window = main_window;
    mrt_result result = start(self, err);
    if (result < 0) {
        front_output_destroy(self);
        return result;
    }
    *out = self;
    return MRT_OK;
}

static void end_thread(front_output *self)
{
    if (self->has_thread) {
        pthread_mutex_lock(&self->mutex);
        self->stop = true;
        pthread_cond_signal(&self->wake);
        pthread_mutex_unlock(&self->mutex);
        (void)pthread_join(self->thread, NULL);
    }
    if (self->has_mutex) {
        pthread_cond_destroy(&self->wake);
        pthread_mutex_destroy(&self->mutex);
    }
}

void front_output_destroy(front_output *self)
{
    if (!self)
        return;
    end_thread(self);
    glfwMakeContextCurrent(self->main_window);
    for (uint32_t i = 0; i < PICTURES; ++i) {
        picture *one = &self->picture[i];
        if (one->filled)
            glDeleteSync(one->filled);
        if (one->shown)
            glDeleteSync(one->shown);
        glDeleteFramebuffers(1, &one->framebuffer);
        glDeleteTextures(1, &one->texture);
    }
    glDeleteFramebuffers(1, &self->read_framebuffer);
    if (self->window)
        glfwDestroyWindow(self->window);
    free(self);
}

GLFWwindow *front_output_window(const front_output *self)
{
    return self->window;
}

bool front_output_is_over(front_output *self)
{
    pthread_mutex_lock(&self->mutex);
    const bool has_failed = self->has_failed;
    pthread_mutex_unlock(&self->mutex);
    return has_failed || glfwWindowShouldClose(self->window);
}

void front_output_measure(front_output *self, uint32_t *out_width, uint32_t *out_height)
{
    int width = 0, height = 0;
    glfwGetFramebufferSize(self->window, &width, &height);
    *out_width = width > 0 ? (uint32_t)width : 0;
    *out_height = height > 0 ? (uint32_t)height : 0;
    pthread_mutex_lock(&self->mutex);
    self->width_px = *out_width;
    self->height_px = *out_height;
    pthread_mutex_unlock(&self->mutex);
}

/* ---- giving ---- */

static void make_size(picture *self, uint32_t width, uint32_t height)
{
    if (self->width == width && self->height == height)
        return;
    glBindTexture(GL_TEXTURE_2D, self->texture);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, (GLsizei)width, (GLsizei)height, 0, GL_RGBA,
                 GL_UNSIGNED_BYTE, NULL);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    glBindTexture(GL_TEXTURE_2D, 0);
    gl_bind_framebuffer(GL_FRAMEBUFFER, self->framebuffer);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, self->texture, 0);
    self->width = width;
    self->height = height;
}

static void copy(front_output *self, picture *to, uint32_t texture)
{
    const GLint width = (GLint)to->width, height = (GLint)to->height;
    gl_bind_framebuffer(GL_READ_FRAMEBUFFER, self->read_framebuffer);
    glFramebufferTexture2D(GL_READ_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture, 0);
    gl_bind_framebuffer(GL_DRAW_FRAMEBUFFER, to->framebuffer);
    glDisable(GL_SCISSOR_TEST);
    glBlitFramebuffer(0, 0, width, height, 0, 0, width, height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    gl_bind_framebuffer(GL_FRAMEBUFFER, 0);
}

void front_output_give(front_output *self, uint32_t texture, uint32_t width, uint32_t height,
                       bool is_mirrored)
{
    picture *one = &self->picture[slot_back(&self->slot)];
    if (one->shown)
        glWaitSync(one->shown, 0, GL_TIMEOUT_IGNORED);
    make_size(one, width, height);
    copy(self, one, texture);
    one->is_mirrored = is_mirrored;
    if (one->filled)
        glDeleteSync(one->filled);
    one->filled = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    glFlush();
    slot_publish(&self->slot);
    pthread_mutex_lock(&self->mutex);
    self->is_new = true;
    pthread_cond_signal(&self->wake);
    pthread_mutex_unlock(&self->mutex);
}
