/* Keys, framebuffers and what both ways of showing have in common; then the second window, the
 * window of the desktop (GLFW), and no window at all. */
#include "window/gui/window.h"
#include "draw/draw.h"
#include "draw/gl.h"
#include "window/gui/pace.h"
#include "window/gui/theme.h"
#include "window/gui/ui.h"
#include "window/gui/window_icon.h"

#include "base/clock.h"
#include "base/error.h"
#include "base/slot.h"
#include "io/export.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <dlfcn.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdlib.h>
#include <math.h>
#include <string.h>

typedef struct window_type {
    void (*close)(window *self);
    bool (*begin)(window *self, ui *to, ui_screen *out_screen);
    void (*end)(window *self, ui *from);
    mrt_result (*picture)(window *self, const char *png_path, error *err);
    void (*set_title)(window *self, const char *title); /* NULL: nothing to write it on */
    bool (*read_gamepad)(window *self, window_gamepad *out);
    bool (*is_maximised)(const window *self);
    void (*maximise)(window *self);
    mrt_result (*open_output)(window *self, const window_output_look *look, error *err);
    void (*close_output)(window *self);
    bool (*has_output)(const window *self);
    void (*output_size)(const window *self, uint32_t *out_width, uint32_t *out_height);
    void (*show_output)(window *self, uint32_t texture, bool is_mirrored, bool is_new);
} window_type;

enum { DROPS = 8, DROP_PATH = 4096 };

struct window { /* the first member of either */
    const window_type *type;
    char drop[DROPS][DROP_PATH]; /* a ring */
    uint32_t dropped, taken;
    uint32_t width_px, height_px;
    bool is_awaited; /* although nobody sees it */
    pace pace;
    float scale; /* pixels a point, without the zoom */
    float zoom;  /* 0: 1 */
};

enum { ZOOMED_WIDTH = 800, ZOOMED_HEIGHT = 500 }; /* points that a zoom leaves at least */

/* Pixels a point. */
static float zoomed(const window *self)
{
    const float across = (float)self->width_px / ZOOMED_WIDTH / self->scale;
    const float down = (float)self->height_px / ZOOMED_HEIGHT / self->scale;
    const float most = fmaxf(fminf(across, down), 1.0f);
    return self->scale * (self->zoom > 0.0f ? fminf(self->zoom, most) : 1.0f);
}

void window_drop(window *self, const char *path)
{
    const size_t length = strlen(path);
    if (self->dropped - self->taken < DROPS && length < DROP_PATH)
        memcpy(self->drop[self->dropped++ % DROPS], path, length + 1);
}

const char *window_take_drop(window *self)
{
    return self->taken < self->dropped ? self->drop[self->taken++ % DROPS] : NULL;
}

/* A framebuffer that a frame is drawn into: it can be read whatever a display does with its own. */
typedef struct window_sheet {
    uint32_t framebuffer, colour; /* a texture */
    uint32_t width_px, height_px;
} window_sheet;

/* Draws a texture over all of the framebuffer that is bound. */
typedef struct window_fill {
    uint32_t program, vertex_array;
    int32_t mirror, clear;
} window_fill;

typedef struct window_output window_output;

/* NULL is fine */
static void window_output_destroy(window_output *self);

/* ---- GLFW's keys as gui/ui.h's: by what is written on them, not by where they lie ---- */

typedef struct pair {
    int theirs;
    uint32_t ours;
} pair;

static const pair pairs[] = {
    {GLFW_KEY_ESCAPE, UI_KEY_ESCAPE},
    {GLFW_KEY_ENTER, UI_KEY_ENTER},
    {GLFW_KEY_KP_ENTER, UI_KEY_ENTER},
    {GLFW_KEY_TAB, UI_KEY_TAB},
    {GLFW_KEY_BACKSPACE, UI_KEY_BACKSPACE},
    {GLFW_KEY_DELETE, UI_KEY_DELETE},
    {GLFW_KEY_INSERT, UI_KEY_INSERT},
    {GLFW_KEY_LEFT, UI_KEY_LEFT},
    {GLFW_KEY_RIGHT, UI_KEY_RIGHT},
    {GLFW_KEY_UP, UI_KEY_UP},
    {GLFW_KEY_DOWN, UI_KEY_DOWN},
    {GLFW_KEY_PAGE_UP, UI_KEY_PAGE_UP},
    {GLFW_KEY_PAGE_DOWN, UI_KEY_PAGE_DOWN},
    {GLFW_KEY_HOME, UI_KEY_HOME},
    {GLFW_KEY_END, UI_KEY_END},
    {GLFW_KEY_LEFT_SHIFT, UI_KEY_SHIFT},
    {GLFW_KEY_RIGHT_SHIFT, UI_KEY_SHIFT},
    {GLFW_KEY_LEFT_CONTROL, UI_KEY_CONTROL},
    {GLFW_KEY_RIGHT_CONTROL, UI_KEY_CONTROL},
    {GLFW_KEY_LEFT_ALT, UI_KEY_ALT},
    {GLFW_KEY_KP_ADD, '='},
    {GLFW_KEY_KP_SUBTRACT, '-'},
    {GLFW_KEY_KP_DECIMAL, '.'},
    {GLFW_KEY_KP_DIVIDE, '/'},
};

static uint32_t from_table(int key)
{
    for (uint32_t i = 0; i < sizeof pairs / sizeof pairs[0]; ++i)
        if (pairs[i].theirs == key)
            return pairs[i].ours;
    return UI_KEY_NONE;
}

/* UI_KEY_NONE: none of ours */
/* Digits are where they are on every keyboard; on some they are written with Shift. */
static uint32_t window_key_of(int key, int scancode)
{
    const uint32_t named = from_table(key);
    if (named != UI_KEY_NONE)
        return named;
    if (key >= GLFW_KEY_F1 && key <= GLFW_KEY_F12)
        return UI_KEY_F1 + (uint32_t)(key - GLFW_KEY_F1);
    if (key >= GLFW_KEY_KP_0 && key <= GLFW_KEY_KP_9)
        return '0' + (uint32_t)(key - GLFW_KEY_KP_0);
    if (key < GLFW_KEY_SPACE || key > GLFW_KEY_GRAVE_ACCENT)
        return UI_KEY_NONE;
    const char *name = glfwGetKeyName(key, scancode);
    const bool is_digit = key >= GLFW_KEY_0 && key <= GLFW_KEY_9;
    if (is_digit || !name || name[0] <= ' ' || name[0] > '~' || name[1] != '\0')
        return (uint32_t)key;
    return name[0] >= 'a' && name[0] <= 'z' ? (uint32_t)(name[0] - 'a' + 'A') : (uint32_t)name[0];
}

/* ---- what both do ---- */

static float part_of(uint32_t colour, uint32_t shift)
{
    return (float)(colour >> shift & 0xffu) / 255.0f;
}

/* The framebuffer that is bound, cleared to the colour behind the face. */
static void window_clear(uint32_t width_px, uint32_t height_px)
{
    glViewport(0, 0, (GLsizei)width_px, (GLsizei)height_px);
    glDisable(GL_SCISSOR_TEST);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glClearColor(part_of(THEME_STAGE, 24), part_of(THEME_STAGE, 16), part_of(THEME_STAGE, 8), 1.0f);
    glClear(GL_COLOR_BUFFER_BIT);
}

static mrt_result window_sheet_init(window_sheet *out, uint32_t width, uint32_t height, error *err)
{
    *out = (window_sheet){.width_px = width, .height_px = height};
    glGenTextures(1, &out->colour);
    glBindTexture(GL_TEXTURE_2D, out->colour);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, (GLsizei)width, (GLsizei)height, 0, GL_RGBA,
                 GL_UNSIGNED_BYTE, NULL);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glBindTexture(GL_TEXTURE_2D, 0);
    glGenFramebuffers(1, &out->framebuffer);
    gl_bind_framebuffer(GL_FRAMEBUFFER, out->framebuffer);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, out->colour, 0);
    mrt_result result = gl_check_error("a picture", err);
    if (result == MRT_OK && glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        result = error_set(err, MRT_ERR_UNSUPPORTED,
                           "a picture of %u x %u pixels cannot be drawn here", width, height);
    return result;
}

/* accepts zeroed */
static void window_sheet_finish(window_sheet *self)
{
    if (self->framebuffer)
        glDeleteFramebuffers(1, &self->framebuffer);
    if (self->colour)
        glDeleteTextures(1, &self->colour);
    *self = (window_sheet){0};
}

/* Rows of the framebuffer that is bound for reading, as a PNG. */
static mrt_result window_write_picture(uint32_t width_px, uint32_t height_px, bool is_clear,
                                       const char *png_path, error *err)
{
    uint8_t *rgba = malloc((size_t)width_px * height_px * 4);
    if (!rgba)
        return error_set(err, MRT_ERR_MEMORY, "%s: no memory for a picture of %u x %u", png_path,
                         width_px, height_px);
    gl_read_picture(rgba, width_px, height_px);
    for (size_t i = 3; i < (size_t)width_px * height_px * 4 && !is_clear; i += 4)
        rgba[i] = 255;
    mrt_result result = png_write(png_path, rgba, width_px, height_px, err);
    free(rgba);
    return result;
}

/* ---- a texture over everything ---- */

static const char fill_vertex[] =
    "out vec2 texture_uv;\n"
    "uniform float mirror;\n"
    "void main() {\n"
    "    vec2 corner = vec2(gl_VertexID == 1 ? 2.0 : 0.0, gl_VertexID == 2 ? 2.0 : 0.0);\n"
    "    texture_uv = vec2(mix(corner.x, 1.0 - corner.x, mirror), corner.y);\n"
    "    gl_Position = vec4(2.0 * corner - 1.0, 0.0, 1.0);\n"
    "}\n";
static const char fill_fragment[] = "in vec2 texture_uv;\n"
                                    "out vec4 colour;\n"
                                    "uniform sampler2D picture;\n"
                                    "uniform float clear;\n" /* 1: premultiplied */
                                    "void main() {\n"
                                    "    vec4 straight = texture(picture, texture_uv);\n"
                                    "    float alpha = mix(1.0, straight.a, clear);\n"
                                    "    colour = vec4(straight.rgb * alpha, alpha);\n"
                                    "}\n";

static mrt_result window_fill_init(window_fill *out, error *err)
{
    const gl_source stages[GL_STAGE_COUNT] = {
        {"fill.vert", fill_vertex, sizeof fill_vertex - 1},
        {"fill.frag", fill_fragment, sizeof fill_fragment - 1}};
    *out = (window_fill){0};
    out->program = gl_program_create(stages, "", err);
    if (!out->program)
        return MRT_ERR_UNSUPPORTED;
    glUseProgram(out->program);
    glUniform1i(glGetUniformLocation(out->program, "picture"), 0);
    glUseProgram(0);
    out->mirror = glGetUniformLocation(out->program, "mirror");
    out->clear = glGetUniformLocation(out->program, "clear");
    glGenVertexArrays(1, &out->vertex_array);
    return gl_check_error("the output", err);
}

static void window_fill_finish(window_fill *self)
{
    if (self->vertex_array)
        glDeleteVertexArrays(1, &self->vertex_array);
    if (self->program)
        glDeleteProgram(self->program);
    *self = (window_fill){0};
}

static void window_fill_draw(const window_fill *self, uint32_t texture, bool is_mirrored,
                             bool is_clear, uint32_t width_px, uint32_t height_px)
{
    window_clear(width_px, height_px);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    glUseProgram(self->program);
    glUniform1f(self->mirror, is_mirrored ? 1.0f : 0.0f);
    glUniform1f(self->clear, is_clear ? 1.0f : 0.0f);
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D, texture);
    glBindVertexArray(self->vertex_array);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glBindVertexArray(0);
    glUseProgram(0);
}

/* ---- each its own way ---- */

void window_close(window *self)
{
    if (self)
        self->type->close(self);
}

bool window_begin(window *self, ui *to, ui_screen *out_screen)
{
    return self->type->begin(self, to, out_screen);
}

void window_end(window *self, ui *from)
{
    self->type->end(self, from);
}

mrt_result window_picture(window *self, const char *png_path, error *err)
{
    return self->type->picture(self, png_path, err);
}

void window_set_title(window *self, const char *title)
{
    if (self->type->set_title)
        self->type->set_title(self, title);
}

void window_want_frame(window *self, double in_s)
{
    if (in_s < 1e6)
        pace_ask(&self->pace, self->pace.began_ns + (int64_t)(in_s * (double)NS_PER_S));
}

const pace *window_pace(const window *self)
{
    return &self->pace;
}

wake *window_signal(window *self)
{
    return &self->pace.signal;
}

void window_stay_awake(window *self, bool is_awaited)
{
    self->is_awaited = is_awaited;
}

bool window_is_maximised(const window *self)
{
    return self->type->is_maximised(self);
}

void window_maximise(window *self)
{
    self->type->maximise(self);
}

void window_set_zoom(window *self, float zoom)
{
    self->zoom = zoom >= 0.5f && zoom <= 3.0f ? zoom : 1.0f;
}

float window_scale(const window *self)
{
    return self->scale;
}

uint32_t window_width_px(const window *self)
{
    return self->width_px;
}

uint32_t window_height_px(const window *self)
{
    return self->height_px;
}

bool window_read_gamepad(window *self, window_gamepad *out)
{
    *out = (window_gamepad){0};
    return self->type->read_gamepad(self, out);
}

mrt_result window_open_output(window *self, const window_output_look *look, error *err)
{
    return window_has_output(self) ? MRT_OK : self->type->open_output(self, look, err);
}

void window_close_output(window *self)
{
    if (window_has_output(self))
        self->type->close_output(self);
}

bool window_has_output(const window *self)
{
    return self->type->has_output(self);
}

void window_output_size(const window *self, uint32_t *out_width, uint32_t *out_height)
{
    *out_width = *out_height = 0;
    if (window_has_output(self))
        self->type->output_size(self, out_width, out_height);
}

void window_show_output(window *self, uint32_t texture, bool is_mirrored, bool is_new)
{
    if (window_has_output(self))
        self->type->show_output(self, texture, is_mirrored, is_new);
}

/* ---- the face alone in a second window, drawn by a thread of its own ---- */

enum { PICTURES = 3, SMALL_WIDTH = 960, SMALL_HEIGHT = 540 };

typedef struct picture { /* of the slot's three: [main] fills it, the thread shows it */
    GLuint texture, framebuffer;
    uint32_t width, height;
    bool is_mirrored;
    GLsync filled, shown;
} picture;

struct window_output {
    GLFWwindow *window, *main_window;
    window_output_look look;
    GLuint read_framebuffer;
    picture picture[PICTURES];
    publish_slot slot;

    pthread_t thread;
    bool has_thread;
    pthread_mutex_t mutex; /* guards what follows */
    pthread_cond_t wake;
    bool has_mutex, is_new, stop, has_failed;
    uint32_t width_px, height_px; /* of the window */

    bool is_exposed; /* its content was lost */
    bool is_dragged;
    double drag_x, drag_y;
};

/* ---- the thread ---- */

static bool wait_for_picture(window_output *self, uint32_t *out_width, uint32_t *out_height)
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

static void show(window_output *self, const window_fill *fill, uint32_t width, uint32_t height)
{
    if (!slot_receive(&self->slot))
        return;
    picture *one = &self->picture[slot_front(&self->slot)];
    if (one->filled)
        glWaitSync(one->filled, 0, GL_TIMEOUT_IGNORED);
    window_fill_draw(fill, one->texture, one->is_mirrored, self->look.is_clear, width, height);
    if (one->shown)
        glDeleteSync(one->shown);
    one->shown = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl_end_scene();
    glfwSwapBuffers(self->window);
}

static void *run(void *data)
{
    window_output *self = data;
    window_fill fill = {0};
    uint32_t width, height;
    error ignored;
    glfwMakeContextCurrent(self->window);
    glfwSwapInterval(1);
    const bool can_draw = window_fill_init(&fill, &ignored) == MRT_OK;
    pthread_mutex_lock(&self->mutex);
    self->has_failed = !can_draw;
    pthread_mutex_unlock(&self->mutex);
    while (can_draw && wait_for_picture(self, &width, &height))
        show(self, &fill, width, height);
    window_fill_finish(&fill);
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

/* The first monitor without the stage; NULL: only one monitor. */
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

static GLFWwindow *open_window(GLFWwindow *main_window, const window_output_look *look)
{
    GLFWmonitor *monitor = look->is_window ? NULL : other_monitor(main_window);
    const GLFWvidmode *mode = monitor ? glfwGetVideoMode(monitor) : NULL;
    glfwWindowHint(GLFW_DECORATED, GLFW_FALSE);
    glfwWindowHint(GLFW_AUTO_ICONIFY, GLFW_FALSE);
    glfwWindowHint(GLFW_FOCUS_ON_SHOW, GLFW_FALSE);
    glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_FALSE);
    glfwWindowHint(GLFW_TRANSPARENT_FRAMEBUFFER, look->is_clear);
    glfwWindowHint(GLFW_FLOATING, look->is_on_top);
    if (mode) { /* the mode that it has: nothing flickers */
        glfwWindowHint(GLFW_RED_BITS, mode->redBits);
        glfwWindowHint(GLFW_GREEN_BITS, mode->greenBits);
        glfwWindowHint(GLFW_BLUE_BITS, mode->blueBits);
        glfwWindowHint(GLFW_REFRESH_RATE, mode->refreshRate);
    }
    GLFWwindow *out =
        glfwCreateWindow(mode ? mode->width : SMALL_WIDTH, mode ? mode->height : SMALL_HEIGHT,
                         "marotte: output", monitor, main_window);
    if (out)
        glfwSetInputMode(out, GLFW_CURSOR, GLFW_CURSOR_HIDDEN);
    return out;
}

/* Without a frame it is dragged by the picture. */
static void on_button(GLFWwindow *handle, int button, int action, int modifiers)
{
    window_output *self = glfwGetWindowUserPointer(handle);
    (void)modifiers;
    if (button != GLFW_MOUSE_BUTTON_LEFT || glfwGetWindowMonitor(handle))
        return;
    self->is_dragged = action == GLFW_PRESS;
    glfwGetCursorPos(handle, &self->drag_x, &self->drag_y);
}

static void on_move(GLFWwindow *handle, double x, double y)
{
    window_output *self = glfwGetWindowUserPointer(handle);
    int left, top;
    if (!self->is_dragged)
        return;
    glfwGetWindowPos(handle, &left, &top);
    glfwSetWindowPos(handle, left + (int)(x - self->drag_x), top + (int)(y - self->drag_y));
}

static void on_output_refresh(GLFWwindow *handle)
{
    ((window_output *)glfwGetWindowUserPointer(handle))->is_exposed = true;
}

static void make_pictures(window_output *self)
{
    glGenFramebuffers(1, &self->read_framebuffer);
    for (uint32_t i = 0; i < PICTURES; ++i) {
        glGenTextures(1, &self->picture[i].texture);
        glGenFramebuffers(1, &self->picture[i].framebuffer);
    }
}

static mrt_result start(window_output *self, error *err)
{
    self->window = open_window(self->main_window, &self->look);
    if (!self->window) {
        const char *why = NULL;
        (void)glfwGetError(&why);
        return error_set(err, MRT_ERR_UNSUPPORTED, "the output window cannot be opened: %s",
                         why ? why : "the display refused it");
    }
    glfwSetWindowUserPointer(self->window, self);
    glfwSetMouseButtonCallback(self->window, on_button);
    glfwSetCursorPosCallback(self->window, on_move);
    glfwSetWindowRefreshCallback(self->window, on_output_refresh);
    make_pictures(self);
    slot_init(&self->slot);
    self->has_mutex =
        pthread_mutex_init(&self->mutex, NULL) == 0 && pthread_cond_init(&self->wake, NULL) == 0;
    self->has_thread = self->has_mutex && pthread_create(&self->thread, NULL, run, self) == 0;
    return self->has_thread
               ? MRT_OK
               : error_set(err, MRT_ERR_MEMORY, "the output cannot be drawn: no thread for it");
}

/* Opens full screen on a monitor without `main`, or as a movable borderless window. The context of
 * `main` must be current, and is shared. */
static mrt_result window_output_create(window_output **out, GLFWwindow *main_window,
                                       const window_output_look *look, error *err)
{
    *out = NULL;
    window_output *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the output");
    self->main_window = main_window;
    self->look = *look;
    mrt_result result = start(self, err);
    if (result < 0) {
        window_output_destroy(self);
        return result;
    }
    *out = self;
    return MRT_OK;
}

static void end_thread(window_output *self)
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

static void window_output_destroy(window_output *self)
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

static GLFWwindow *window_output_window(const window_output *self)
{
    return self->window;
}

/* The person wants it to be closed, or it could not be drawn. */
static bool window_output_is_over(window_output *self)
{
    pthread_mutex_lock(&self->mutex);
    const bool has_failed = self->has_failed;
    pthread_mutex_unlock(&self->mutex);
    return has_failed || glfwWindowShouldClose(self->window);
}

static void window_output_measure(window_output *self, uint32_t *out_width, uint32_t *out_height)
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

static void copy(window_output *self, picture *to, uint32_t texture)
{
    const GLint width = (GLint)to->width, height = (GLint)to->height;
    gl_bind_framebuffer(GL_READ_FRAMEBUFFER, self->read_framebuffer);
    glFramebufferTexture2D(GL_READ_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture, 0);
    gl_bind_framebuffer(GL_DRAW_FRAMEBUFFER, to->framebuffer);
    glDisable(GL_SCISSOR_TEST);
    glBlitFramebuffer(0, 0, width, height, 0, 0, width, height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    gl_bind_framebuffer(GL_FRAMEBUFFER, 0);
}

/* The texture is copied, with the commands that are already on their way. */
static void window_output_give(window_output *self, uint32_t texture, uint32_t width,
                               uint32_t height, bool is_mirrored)
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

/* ---- a window of the desktop ---- */

enum { CURSORS = UI_CURSOR_CROSS + 1 };

static const int64_t HIDDEN_FRAME_NS = 200 * NS_PER_MS; /* nobody sees it */

typedef struct glfw_window {
    window base;
    GLFWwindow *glfw;
    ui *to; /* whom events are for; since window_begin */
    window_output *output;
    GLFWcursor *cursor[CURSORS];
    ui_cursor cursor_now;
    window_sheet sheet;    /* draw target, copied to the window when the frame ends */
    float pixels_per_unit; /* pixels in a unit of the desktop coordinates */
    int64_t frame_ns;
    bool is_iconified;
    bool has_event;    /* since the last frame */
    bool is_exposed;   /* the content of the window was lost: show it again */
    bool is_caught_up; /* the previous frame was late, and delayed its events */
    pthread_t thread;  /* thread that ends the wait for events at a signal */
    bool has_thread;
    _Atomic bool is_waiting, stop;
} glfw_window;

static glfw_window *glfw_window_of(window *self)
{
    return (glfw_window *)self;
}

/* ---- events ---- */

static void push(GLFWwindow *from, ui_event event)
{
    glfw_window *self = glfwGetWindowUserPointer(from);
    self->has_event = true;
    if (self->to)
        ui_push(self->to, &event);
}

static void glfw_on_move(GLFWwindow *from, double x, double y)
{
    const glfw_window *self = glfwGetWindowUserPointer(from);
    const float points = self->pixels_per_unit / zoomed(&self->base);
    push(from, (ui_event){.kind = UI_EVENT_MOVE, .x = (float)x * points, .y = (float)y * points});
}

/* Outside it hovers over nothing. */
static void on_enter(GLFWwindow *from, int is_inside)
{
    if (!is_inside)
        push(from, (ui_event){.kind = UI_EVENT_MOVE, .x = -10000.0f, .y = -10000.0f});
}

static void glfw_on_button(GLFWwindow *from, int button, int action, int modifiers)
{
    (void)modifiers;
    if (button >= 0 && button <= GLFW_MOUSE_BUTTON_MIDDLE)
        push(from, (ui_event){.kind = UI_EVENT_BUTTON,
                              .code = (uint32_t)button,
                              .is_down = action == GLFW_PRESS});
}

static void on_wheel(GLFWwindow *from, double x, double y)
{
    push(from, (ui_event){.kind = UI_EVENT_WHEEL, .x = (float)x, .y = (float)y});
}

static int other_side(int key)
{
    switch (key) {
    case GLFW_KEY_LEFT_SHIFT:
        return GLFW_KEY_RIGHT_SHIFT;
    case GLFW_KEY_RIGHT_SHIFT:
        return GLFW_KEY_LEFT_SHIFT;
    case GLFW_KEY_LEFT_CONTROL:
        return GLFW_KEY_RIGHT_CONTROL;
    case GLFW_KEY_RIGHT_CONTROL:
        return GLFW_KEY_LEFT_CONTROL;
    default:
        return GLFW_KEY_UNKNOWN;
    }
}

static void on_key(GLFWwindow *from, int key, int scancode, int action, int modifiers)
{
    (void)modifiers;
    const uint32_t code = window_key_of(key, scancode);
    const int other = other_side(key);
    if (code == UI_KEY_NONE || action == GLFW_REPEAT)
        return;
    if (action == GLFW_RELEASE && other != GLFW_KEY_UNKNOWN &&
        glfwGetKey(from, other) == GLFW_PRESS)
        return;
    push(from, (ui_event){.kind = UI_EVENT_KEY, .code = code, .is_down = action == GLFW_PRESS});
}

static void on_text(GLFWwindow *from, unsigned int point)
{
    push(from, (ui_event){.kind = UI_EVENT_TEXT, .code = point});
}

static void on_focus(GLFWwindow *from, int has_focus)
{
    push(from, (ui_event){.kind = UI_EVENT_FOCUS, .is_down = has_focus == GLFW_TRUE});
}

static void on_iconify(GLFWwindow *from, int is_iconified)
{
    glfw_window *self = glfwGetWindowUserPointer(from);
    self->is_iconified = is_iconified == GLFW_TRUE;
    self->has_event = self->is_exposed = true;
}

/* It is shown, uncovered, or has another size. */
static void on_refresh(GLFWwindow *from)
{
    glfw_window *self = glfwGetWindowUserPointer(from);
    self->has_event = self->is_exposed = true;
}

static void on_size(GLFWwindow *from, int width, int height)
{
    (void)width, (void)height;
    on_refresh(from);
}

static void on_maximise(GLFWwindow *from, int is_maximised)
{
    (void)is_maximised;
    on_refresh(from);
}

static void on_scale(GLFWwindow *from, float x, float y)
{
    (void)x, (void)y;
    on_refresh(from);
}

static void on_drop(GLFWwindow *from, int count, const char **paths)
{
    glfw_window *self = glfwGetWindowUserPointer(from);
    for (int i = 0; i < count; ++i)
        window_drop(&self->base, paths[i]);
    self->has_event = true;
}

static void listen(GLFWwindow *to)
{
    glfwSetDropCallback(to, on_drop);
    glfwSetCursorPosCallback(to, glfw_on_move);
    glfwSetCursorEnterCallback(to, on_enter);
    glfwSetMouseButtonCallback(to, glfw_on_button);
    glfwSetScrollCallback(to, on_wheel);
    glfwSetKeyCallback(to, on_key);
    glfwSetCharCallback(to, on_text);
    glfwSetWindowFocusCallback(to, on_focus);
    glfwSetWindowIconifyCallback(to, on_iconify);
    glfwSetWindowRefreshCallback(to, on_refresh);
    glfwSetWindowCloseCallback(to, on_refresh);
    glfwSetWindowMaximizeCallback(to, on_maximise);
    glfwSetFramebufferSizeCallback(to, on_size);
    glfwSetWindowContentScaleCallback(to, on_scale);
}

static const char *get_clipboard(void *data)
{
    return glfwGetClipboardString(data);
}

static void set_clipboard(void *data, const char *text)
{
    glfwSetClipboardString(data, text);
}

/* ---- frames ---- */

static void measure(glfw_window *self)
{
    int width = 0, height = 0, units = 0, units_high = 0;
    float scale = 1.0f, scale_y = 1.0f;
    glfwGetFramebufferSize(self->glfw, &width, &height);
    glfwGetWindowSize(self->glfw, &units, &units_high);
    glfwGetWindowContentScale(self->glfw, &scale, &scale_y);
    self->base.scale = scale >= 0.5f && scale <= 8.0f ? scale : 1.0f;
    self->pixels_per_unit = units > 0 && width > 0 ? (float)width / (float)units : 1.0f;
    self->base.width_px = width > 0 ? (uint32_t)width : 1;
    self->base.height_px = height > 0 ? (uint32_t)height : 1;
}

static int64_t refresh_ns(void)
{
    GLFWmonitor *monitor = glfwGetPrimaryMonitor();
    const GLFWvidmode *mode = monitor ? glfwGetVideoMode(monitor) : NULL;
    const int64_t rate = mode && mode->refreshRate >= 24 ? mode->refreshRate : 60;
    return NS_PER_S / rate;
}

/* Where nothing else keeps the pace: a display without a refresh, a window that is put away. */
static void keep_pace(glfw_window *self)
{
    const bool is_idle = self->is_iconified && !self->base.is_awaited;
    const int64_t frame_ns = is_idle ? HIDDEN_FRAME_NS : self->frame_ns;
    const int64_t next_ns = self->base.pace.began_ns + frame_ns * 9 / 10;
    if (!self->is_caught_up && clock_now_ns() < next_ns)
        clock_sleep_until_ns(next_ns);
}

/* Ends the wait for events when another thread has something new. */
static void *watch_signal(void *data)
{
    glfw_window *self = data;
    wake *signal = &self->base.pace.signal;
    uint32_t seen = wake_seen(signal);
    while (!atomic_load(&self->stop)) {
        wake_wait_until_ns(signal, seen, INT64_MAX);
        const uint32_t now = wake_seen(signal);
        if (now != seen && atomic_load(&self->is_waiting))
            glfwPostEmptyEvent();
        seen = now;
    }
    return NULL;
}

/* Sleeps until a frame is due. */
static pace_reason wait_for_frame(glfw_window *self, bool *out_has_rested)
{
    const pace *of = &self->base.pace;
    *out_has_rested = false;
    for (;;) {
        glfwPollEvents();
        atomic_store(&self->is_waiting, true);
        const int64_t now_ns = clock_now_ns();
        const bool has_event = self->has_event || !ui_is_idle(self->to) || !self->has_thread;
        const pace_reason why = pace_due(of, now_ns, has_event);
        if (why != PACE_NOT_DUE) {
            atomic_store(&self->is_waiting, false);
            return why;
        }
        *out_has_rested = true;
        glfwWaitEventsTimeout(1e-9 * (double)(pace_until_ns(of) - now_ns + 1));
    }
}

/* Fits the framebuffer to the window. Without memory for it, draws directly to the display. Returns
 * true if its content was lost. */
static bool fit_sheet(glfw_window *self)
{
    error ignored = {""};
    const window *base = &self->base;
    if (self->sheet.width_px == base->width_px && self->sheet.height_px == base->height_px)
        return self->sheet.framebuffer == 0; /* the display's own is another one each time */
    window_sheet_finish(&self->sheet);
    if (window_sheet_init(&self->sheet, base->width_px, base->height_px, &ignored) < 0) {
        window_sheet_finish(&self->sheet);
        self->sheet.width_px = base->width_px;
        self->sheet.height_px = base->height_px;
    }
    return true;
}

static void show_sheet(const glfw_window *self)
{
    const GLint width = (GLint)self->sheet.width_px, height = (GLint)self->sheet.height_px;
    if (self->sheet.framebuffer == 0)
        return;
    gl_bind_framebuffer(GL_READ_FRAMEBUFFER, self->sheet.framebuffer);
    gl_bind_framebuffer(GL_DRAW_FRAMEBUFFER, 0);
    glBlitFramebuffer(0, 0, width, height, 0, 0, width, height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    gl_bind_framebuffer(GL_FRAMEBUFFER, 0);
}

static bool glfw_begin(window *base, ui *to, ui_screen *out_screen)
{
    glfw_window *self = glfw_window_of(base);
    if (!self->to) {
        const ui_clipboard clipboard = {self->glfw, get_clipboard, set_clipboard};
        ui_set_clipboard(to, &clipboard);
        self->to = to;
    }
    bool has_rested;
    keep_pace(self);
    const pace_reason why = wait_for_frame(self, &has_rested);
    measure(self);
    const int64_t now_ns = clock_now_ns(), before_ns = base->pace.began_ns;
    const float scale = zoomed(base);
    const bool is_late = pace_begin(&base->pace, why, has_rested, now_ns);
    *out_screen = (ui_screen){.width = (float)base->width_px / scale,
                              .height = (float)base->height_px / scale,
                              .scale = scale,
                              .dt_s = before_ns ? 1e-9 * (double)(now_ns - before_ns) : 0.0,
                              .is_hidden = self->is_iconified,
                              .is_lost = fit_sheet(self),
                              .is_late = is_late};
    self->is_caught_up = is_late;
    self->has_event = is_late; /* events wait for the next frame, which follows immediately */
    gl_bind_framebuffer(GL_FRAMEBUFFER, self->sheet.framebuffer);
    glViewport(0, 0, (GLsizei)base->width_px, (GLsizei)base->height_px);
    return !glfwWindowShouldClose(self->glfw);
}

static void show_cursor(glfw_window *self, ui_cursor wanted)
{
    static const int shapes[CURSORS] = {
        [UI_CURSOR_ARROW] = GLFW_ARROW_CURSOR,    [UI_CURSOR_HAND] = GLFW_HAND_CURSOR,
        [UI_CURSOR_MOVE] = GLFW_HAND_CURSOR,      [UI_CURSOR_ACROSS] = GLFW_HRESIZE_CURSOR,
        [UI_CURSOR_DOWN] = GLFW_VRESIZE_CURSOR,   [UI_CURSOR_TEXT] = GLFW_IBEAM_CURSOR,
        [UI_CURSOR_CROSS] = GLFW_CROSSHAIR_CURSOR};
    if (wanted == self->cursor_now)
        return;
    self->cursor_now = wanted;
    if (!self->cursor[wanted])
        self->cursor[wanted] = glfwCreateStandardCursor(shapes[wanted]);
    glfwSetCursor(self->glfw, self->cursor[wanted]); /* NULL: the arrow */
}

static void glfw_end(window *base, ui *from)
{
    glfw_window *self = glfw_window_of(base);
    show_cursor(self, ui_cursor_wanted(from));
    glfwSetWindowShouldClose(self->glfw, GLFW_FALSE); /* the workspace has heard it */
    if (ui_is_new(from))
        pace_note_change(&base->pace);
    else if (!self->is_exposed)
        return;
    self->is_exposed = false;
    show_sheet(self);
    gl_end_scene();
    if (!self->is_iconified) /* some drivers wait a second for what nobody sees */
        glfwSwapBuffers(self->glfw);
}

static mrt_result glfw_picture(window *base, const char *png_path, error *err)
{
    gl_bind_framebuffer(GL_FRAMEBUFFER, glfw_window_of(base)->sheet.framebuffer);
    return window_write_picture(base->width_px, base->height_px, false, png_path, err);
}

static void glfw_set_title(window *base, const char *title)
{
    glfwSetWindowTitle(glfw_window_of(base)->glfw, title);
}

/* ---- gamepad ---- */

static bool glfw_read_gamepad(window *base, window_gamepad *out)
{
    (void)base;
    for (int id = GLFW_JOYSTICK_1; id <= GLFW_JOYSTICK_LAST; ++id) {
        GLFWgamepadstate state;
        if (!glfwJoystickIsGamepad(id) || !glfwGetGamepadState(id, &state))
            continue;
        const char *name = glfwGetGamepadName(id);
        for (int i = 0; i < 6; ++i)
            out->axis[i] = state.axes[i];
        for (int i = 0; i <= GLFW_GAMEPAD_BUTTON_LAST; ++i)
            out->button[i] = state.buttons[i] == GLFW_PRESS;
        strncpy(out->name, name ? name : "gamepad", sizeof out->name - 1);
        return true;
    }
    return false;
}

/* ---- the output ---- */

/* Keys go to the stage from there too; Escape closes it. */
static void on_output_key(GLFWwindow *from, int key, int scancode, int action, int modifiers)
{
    glfw_window *self = glfwGetWindowUserPointer(glfwGetCurrentContext());
    if (key == GLFW_KEY_ESCAPE) {
        glfwSetWindowShouldClose(from, GLFW_TRUE);
        self->has_event = true;
        return;
    }
    on_key(self->glfw, key, scancode, action, modifiers);
}

static mrt_result glfw_open_output(window *base, const window_output_look *look, error *err)
{
    glfw_window *self = glfw_window_of(base);
    mrt_result result = window_output_create(&self->output, self->glfw, look, err);
    if (result < 0)
        return result;
    glfwSetKeyCallback(window_output_window(self->output), on_output_key);
    /* On a monitor of its own it hides nothing. Else it comes before the stage, and passes on keys.
     */
    GLFWwindow *output = window_output_window(self->output);
    glfwFocusWindow(glfwGetWindowMonitor(output) ? self->glfw : output);
    return MRT_OK;
}

static void glfw_close_output(window *base)
{
    glfw_window *self = glfw_window_of(base);
    window_output_destroy(self->output);
    self->output = NULL;
}

static bool glfw_has_output(const window *base)
{
    return ((const glfw_window *)base)->output != NULL;
}

static void glfw_output_size(const window *base, uint32_t *out_width, uint32_t *out_height)
{
    window_output_measure(((const glfw_window *)base)->output, out_width, out_height);
}

static void glfw_show_output(window *base, uint32_t texture, bool is_mirrored, bool is_new)
{
    glfw_window *self = glfw_window_of(base);
    uint32_t width, height;
    if (window_output_is_over(self->output)) {
        glfw_close_output(base);
        return;
    }
    if (!is_new && !self->output->is_exposed)
        return;
    self->output->is_exposed = false;
    window_output_measure(self->output, &width, &height);
    window_output_give(self->output, texture, width, height, is_mirrored);
}

/* ---- life ---- */

static void glfw_close(window *base)
{
    glfw_window *self = glfw_window_of(base);
    if (self->has_thread) {
        atomic_store(&self->stop, true);
        wake_signal(&base->pace.signal);
        (void)pthread_join(self->thread, NULL);
    }
    window_output_destroy(self->output);
    if (self->glfw) {
        window_sheet_finish(&self->sheet);
        gl_forget_scenes();
    }
    for (uint32_t i = 0; i < CURSORS; ++i)
        if (self->cursor[i])
            glfwDestroyCursor(self->cursor[i]);
    if (self->glfw)
        glfwDestroyWindow(self->glfw);
    glfwTerminate();
    free(self);
}

static bool glfw_is_maximised(const window *base)
{
    return glfwGetWindowAttrib(((const glfw_window *)base)->glfw, GLFW_MAXIMIZED) != 0;
}

static void glfw_maximise(window *base)
{
    glfwMaximizeWindow(((glfw_window *)base)->glfw);
}

static const window_type type = {
    .close = glfw_close,
    .begin = glfw_begin,
    .end = glfw_end,
    .picture = glfw_picture,
    .set_title = glfw_set_title,
    .read_gamepad = glfw_read_gamepad,
    .is_maximised = glfw_is_maximised,
    .maximise = glfw_maximise,
    .open_output = glfw_open_output,
    .close_output = glfw_close_output,
    .has_output = glfw_has_output,
    .output_size = glfw_output_size,
    .show_output = glfw_show_output,
};

/* Two threads draw through one connection to the X server. libX11 before 1.8 needs XInitThreads for
 * that. */
static void let_x11_have_threads(void)
{
    void *library = dlopen("libX11.so.6", RTLD_LAZY);
    void *symbol = library ? dlsym(library, "XInitThreads") : NULL;
    int (*init)(void) = NULL;
    memcpy(&init, &symbol, sizeof init);
    if (init)
        (void)init();
}

static const char *last_words(void)
{
    const char *why = NULL;
    (void)glfwGetError(&why);
    return why ? why : "unknown reason";
}

static void set_icon(GLFWwindow *of)
{
    window_icon icon[WINDOW_ICONS];
    GLFWimage image[WINDOW_ICONS];
    const uint32_t count = window_icons_read(icon);
    for (uint32_t i = 0; i < count; ++i)
        image[i] = (GLFWimage){(int)icon[i].size_px, (int)icon[i].size_px, icon[i].rgba};
    glfwSetWindowIcon(of, (int)count, image);
    window_icons_finish(icon, count);
}

static mrt_result open_glfw(glfw_window *self, uint32_t width, uint32_t height, const char *title,
                            error *err)
{
    let_x11_have_threads();
    if (!glfwInit())
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "there is no display to open a window on (%s); marotte --hidden, and the "
                         "commands of marotte --help, work without one",
                         last_words());
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
    glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
    glfwWindowHintString(GLFW_X11_CLASS_NAME, "marotte");
    glfwWindowHintString(GLFW_X11_INSTANCE_NAME, "marotte");
    self->glfw = glfwCreateWindow((int)width, (int)height, title, NULL, NULL);
    if (!self->glfw)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "no window with OpenGL 3.3 can be opened: %s; update the graphics driver, "
                         "or install libgl1-mesa-dri",
                         last_words());
    set_icon(self->glfw);
    glfwSetWindowSizeLimits(self->glfw, 800, 500, GLFW_DONT_CARE, GLFW_DONT_CARE);
    glfwMakeContextCurrent(self->glfw);
    gl_begin_scenes();
    glfwSwapInterval(1);
    return gl_check_current(err);
}

mrt_result window_open_window(window **out, uint32_t width, uint32_t height, const char *title,
                              error *err)
{
    *out = NULL;
    glfw_window *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the window");
    self->base.type = &type;
    mrt_result result = open_glfw(self, width, height, title, err);
    if (result < 0) {
        glfw_close(&self->base);
        return result;
    }
    glfwSetWindowUserPointer(self->glfw, self);
    listen(self->glfw);
    measure(self);
    self->frame_ns = refresh_ns();
    pace_init(&self->base.pace);
    /* Without the thread a frame is always due. */
    self->has_thread = pthread_create(&self->thread, NULL, watch_signal, self) == 0;
    *out = &self->base;
    return MRT_OK;
}

/* ---- no window: framebuffers in a context without a display ---- */

enum { OUTPUT_WIDTH = 1280, OUTPUT_HEIGHT = 720, REAL_FPS = 60 };

typedef struct hidden {
    window base;
    draw_context *context;
    window_sheet stage, output;
    window_fill fill;
    double dt_s; /* 0: as the clock goes, at most REAL_FPS frames a second */
    bool has_output, output_is_clear, is_maximised;
    bool is_unseen;    /* as a window that is put away */
    bool is_caught_up; /* the frame before was late */
    window_gamepad gamepad;
    bool has_gamepad;
} hidden;

static hidden *hidden_of(window *self)
{
    return (hidden *)self;
}

static void hidden_close(window *base)
{
    hidden *self = hidden_of(base);
    if (self->context) {
        window_fill_finish(&self->fill);
        window_sheet_finish(&self->output);
        window_sheet_finish(&self->stage);
    }
    draw_context_destroy(self->context);
    free(self);
}

/* Sleeps until a frame is due. Returns how long it is since the last one. */
static double real_dt_s(hidden *self, const ui *to, bool *out_is_late)
{
    pace *of = &self->base.pace;
    const int64_t before_ns = of->began_ns, next_ns = before_ns + NS_PER_S / REAL_FPS;
    pace_reason why;
    bool has_rested = false;
    if (before_ns && !self->is_caught_up && clock_now_ns() < next_ns)
        clock_sleep_until_ns(next_ns);
    for (;;) {
        const uint32_t seen = wake_seen(&of->signal);
        why = pace_due(of, clock_now_ns(), !ui_is_idle(to));
        if (why != PACE_NOT_DUE)
            break;
        has_rested = true;
        wake_wait_until_ns(&of->signal, seen, pace_until_ns(of));
    }
    const int64_t now_ns = clock_now_ns();
    *out_is_late = pace_begin(of, why, has_rested, now_ns);
    return before_ns ? 1e-9 * (double)(now_ns - before_ns) : 0.0;
}

static bool hidden_begin(window *base, ui *to, ui_screen *out_screen)
{
    hidden *self = hidden_of(base);
    const float scale = zoomed(base);
    bool is_late = false;
    const double dt_s = self->dt_s > 0.0 ? self->dt_s : real_dt_s(self, to, &is_late);
    self->is_caught_up = is_late;
    *out_screen = (ui_screen){.width = (float)base->width_px / scale,
                              .height = (float)base->height_px / scale,
                              .scale = scale,
                              .dt_s = dt_s,
                              .is_late = is_late,
                              .is_hidden = self->is_unseen};
    gl_bind_framebuffer(GL_FRAMEBUFFER, self->stage.framebuffer);
    glViewport(0, 0, (GLsizei)base->width_px, (GLsizei)base->height_px);
    return true;
}

static void hidden_end(window *base, ui *from)
{
    if (!ui_is_new(from))
        return;
    pace_note_change(&base->pace);
    gl_end_scene();
    glFlush();
}

static mrt_result hidden_picture(window *base, const char *png_path, error *err)
{
    gl_bind_framebuffer(GL_FRAMEBUFFER, hidden_of(base)->stage.framebuffer);
    return window_write_picture(base->width_px, base->height_px, false, png_path, err);
}

static bool hidden_read_gamepad(window *base, window_gamepad *out)
{
    *out = hidden_of(base)->gamepad;
    return hidden_of(base)->has_gamepad;
}

static mrt_result hidden_open_output(window *base, const window_output_look *look, error *err)
{
    hidden *self = hidden_of(base);
    self->output_is_clear = look->is_clear;
    mrt_result result = self->fill.program ? MRT_OK : window_fill_init(&self->fill, err);
    if (result == MRT_OK)
        result = window_sheet_init(&self->output, OUTPUT_WIDTH, OUTPUT_HEIGHT, err);
    gl_bind_framebuffer(GL_FRAMEBUFFER, self->stage.framebuffer);
    self->has_output = result == MRT_OK;
    if (!self->has_output)
        window_sheet_finish(&self->output);
    return result;
}

static void hidden_close_output(window *base)
{
    window_sheet_finish(&hidden_of(base)->output);
    hidden_of(base)->has_output = false;
}

static bool hidden_has_output(const window *base)
{
    return ((const hidden *)base)->has_output;
}

static void hidden_output_size(const window *base, uint32_t *out_width, uint32_t *out_height)
{
    *out_width = ((const hidden *)base)->output.width_px;
    *out_height = ((const hidden *)base)->output.height_px;
}

static void hidden_show_output(window *base, uint32_t texture, bool is_mirrored, bool is_new)
{
    hidden *self = hidden_of(base);
    if (!is_new)
        return;
    gl_bind_framebuffer(GL_FRAMEBUFFER, self->output.framebuffer);
    window_fill_draw(&self->fill, texture, is_mirrored, self->output_is_clear,
                     self->output.width_px, self->output.height_px);
    gl_bind_framebuffer(GL_FRAMEBUFFER, self->stage.framebuffer);
    glViewport(0, 0, (GLsizei)base->width_px, (GLsizei)base->height_px);
}

static bool hidden_is_maximised(const window *base)
{
    return ((const hidden *)base)->is_maximised;
}

static void hidden_maximise(window *base)
{
    hidden_of(base)->is_maximised = true;
}

static const window_type hidden_type = {
    .close = hidden_close,
    .begin = hidden_begin,
    .end = hidden_end,
    .picture = hidden_picture,
    .read_gamepad = hidden_read_gamepad,
    .is_maximised = hidden_is_maximised,
    .maximise = hidden_maximise,
    .open_output = hidden_open_output,
    .close_output = hidden_close_output,
    .has_output = hidden_has_output,
    .output_size = hidden_output_size,
    .show_output = hidden_show_output,
};

mrt_result window_open_hidden(window **out, uint32_t width, uint32_t height, float scale,
                              double dt_s, error *err)
{
    *out = NULL;
    if (width == 0 || height == 0 || width > 16384 || height > 16384 || !(scale >= 0.25f) ||
        !(scale <= 8.0f))
        return error_set(err, MRT_ERR_ARGUMENT,
                         "a stage of %u x %u pixels at scale %.2f: expected 1 to 16384 pixels a "
                         "side, and a scale of 0.25 to 8",
                         width, height, (double)scale);
    hidden *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the window");
    self->base = (window){.type = &hidden_type, .width_px = width, .height_px = height};
    self->base.scale = scale;
    pace_init(&self->base.pace);
    self->dt_s = dt_s;
    self->context = draw_context_create(err);
    mrt_result result =
        self->context ? window_sheet_init(&self->stage, width, height, err) : MRT_ERR_UNSUPPORTED;
    if (result < 0) {
        hidden_close(&self->base);
        return result;
    }
    *out = &self->base;
    return MRT_OK;
}

void window_hidden_put_away(window *self, bool is_away)
{
    hidden_of(self)->is_unseen = is_away;
}

void window_hidden_draw_again(window *self, ui *from)
{
    gl_bind_framebuffer(GL_FRAMEBUFFER, hidden_of(self)->stage.framebuffer);
    glViewport(0, 0, (GLsizei)self->width_px, (GLsizei)self->height_px);
    ui_draw_again(from);
    gl_end_scene();
}

void window_hidden_gamepad(window *base, const window_gamepad *now)
{
    hidden *self = hidden_of(base);
    self->has_gamepad = now != NULL;
    self->gamepad = now ? *now : (window_gamepad){0};
}

mrt_result window_hidden_output_picture(window *base, const char *png_path, error *err)
{
    hidden *self = hidden_of(base);
    if (!self->has_output)
        return error_set(err, MRT_ERR_ARGUMENT, "%s: the output is not open", png_path);
    gl_bind_framebuffer(GL_FRAMEBUFFER, self->output.framebuffer);
    mrt_result result = window_write_picture(self->output.width_px, self->output.height_px,
                                             self->output_is_clear, png_path, err);
    gl_bind_framebuffer(GL_FRAMEBUFFER, self->stage.framebuffer);
    return result;
}
