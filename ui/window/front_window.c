/* The stage in a window of the desktop: GLFW's events, gamepad, cursors, clipboard. */
#include "draw/gl.h"
#include "window/front_inside.h"
#include "window/front_keys.h"
#include "window/front_output.h"

#include "base/clock.h"

#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

enum { CURSORS = UI_CURSOR_CROSS + 1 };

static const int64_t HIDDEN_FRAME_NS = 200 * NS_PER_MS; /* nobody sees it */

typedef struct window {
    front base;
    GLFWwindow *glfw;
    ui *to; /* whom events are for; since front_begin */
    front_output *output;
    GLFWcursor *cursor[CURSORS];
    ui_cursor cursor_now;
    front_sheet sheet;            /* what is drawn before it is shown */
    float scale, pixels_per_unit; /* a unit of the desktop's coordinates */
    int64_t began_ns, frame_ns;
    bool is_iconified;
} window;

static window *window_of(front *self)
{
    return (window *)self;
}

/* ---- events ---- */

static void push(GLFWwindow *from, ui_event event)
{
    const window *self = glfwGetWindowUserPointer(from);
    if (self->to)
        ui_push(self->to, &event);
}

static void on_move(GLFWwindow *from, double x, double y)
{
    const window *self = glfwGetWindowUserPointer(from);
    const float points = self->pixels_per_unit / self->scale;
    push(from, (ui_event){.kind = UI_EVENT_MOVE, .x = (float)x * points, .y = (float)y * points});
}

/* Outside it hovers over nothing. */
static void on_enter(GLFWwindow *from, int is_inside)
{
    if (!is_inside)
        push(from, (ui_event){.kind = UI_EVENT_MOVE, .x = -10000.0f, .y = -10000.0f});
}

static void on_button(GLFWwindow *from, int button, int action, int modifiers)
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
    const uint32_t code = front_key_of(key, scancode);
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
    ((window *)glfwGetWindowUserPointer(from))->is_iconified = is_iconified == GLFW_TRUE;
}

static void listen(GLFWwindow *to)
{
    glfwSetCursorPosCallback(to, on_move);
    glfwSetCursorEnterCallback(to, on_enter);
    glfwSetMouseButtonCallback(to, on_button);
    glfwSetScrollCallback(to, on_wheel);
    glfwSetKeyCallback(to, on_key);
    glfwSetCharCallback(to, on_text);
    glfwSetWindowFocusCallback(to, on_focus);
    glfwSetWindowIconifyCallback(to, on_iconify);
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

static void measure(window *self)
{
    int width = 0, height = 0, units = 0, units_high = 0;
    float scale = 1.0f, scale_y = 1.0f;
    glfwGetFramebufferSize(self->glfw, &width, &height);
    glfwGetWindowSize(self->glfw, &units, &units_high);
    glfwGetWindowContentScale(self->glfw, &scale, &scale_y);
    self->scale = scale >= 0.5f && scale <= 8.0f ? scale : 1.0f;
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
static void keep_pace(window *self)
{
    const int64_t frame_ns = self->is_iconified ? HIDDEN_FRAME_NS : self->frame_ns;
    const int64_t next_ns = self->began_ns + frame_ns * 9 / 10;
    if (clock_now_ns() < next_ns)
        clock_sleep_until_ns(next_ns);
}

/* Of the window's size; where the card has no room for it, the display's own is drawn into. */
static void fit_sheet(window *self)
{
    error ignored = {""};
    const front *base = &self->base;
    if (self->sheet.width_px == base->width_px && self->sheet.height_px == base->height_px)
        return;
    front_sheet_finish(&self->sheet);
    if (front_sheet_init(&self->sheet, base->width_px, base->height_px, &ignored) < 0) {
        front_sheet_finish(&self->sheet);
        self->sheet.width_px = base->width_px;
        self->sheet.height_px = base->height_px;
    }
}

static void show_sheet(const window *self)
{
    const GLint width = (GLint)self->sheet.width_px, height = (GLint)self->sheet.height_px;
    if (self->sheet.framebuffer == 0)
        return;
    gl_bind_framebuffer(GL_READ_FRAMEBUFFER, self->sheet.framebuffer);
    gl_bind_framebuffer(GL_DRAW_FRAMEBUFFER, 0);
    glBlitFramebuffer(0, 0, width, height, 0, 0, width, height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    gl_bind_framebuffer(GL_FRAMEBUFFER, 0);
}

static bool window_begin(front *base, ui *to, ui_screen *out_screen)
{
    window *self = window_of(base);
    if (!self->to) {
        const ui_clipboard clipboard = {self->glfw, get_clipboard, set_clipboard};
        ui_set_clipboard(to, &clipboard);
        self->to = to;
    }
    keep_pace(self);
    glfwPollEvents();
    measure(self);
    const int64_t now_ns = clock_now_ns();
    *out_screen =
        (ui_screen){.width = (float)base->width_px / self->scale,
                    .height = (float)base->height_px / self->scale,
                    .scale = self->scale,
                    .dt_s = self->began_ns ? 1e-9 * (double)(now_ns - self->began_ns) : 0.0};
    self->began_ns = now_ns;
    fit_sheet(self);
    gl_bind_framebuffer(GL_FRAMEBUFFER, self->sheet.framebuffer);
    front_clear(base->width_px, base->height_px);
    return !glfwWindowShouldClose(self->glfw);
}

static void show_cursor(window *self, ui_cursor wanted)
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

static void window_end(front *base, ui *from)
{
    window *self = window_of(base);
    show_cursor(self, ui_cursor_wanted(from));
    glfwSetWindowShouldClose(self->glfw, GLFW_FALSE); /* the desk has heard it */
    show_sheet(self);
    gl_end_scene();
    glfwSwapBuffers(self->glfw);
}

static mrt_result window_picture(front *base, const char *png_path, error *err)
{
    gl_bind_framebuffer(GL_FRAMEBUFFER, window_of(base)->sheet.framebuffer);
    return front_write_picture(base->width_px, base->height_px, png_path, err);
}

static void window_set_title(front *base, const char *title)
{
    glfwSetWindowTitle(window_of(base)->glfw, title);
}

/* ---- gamepad ---- */

static bool window_read_gamepad(front *base, front_gamepad *out)
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
    window *self = glfwGetWindowUserPointer(glfwGetCurrentContext());
    if (key == GLFW_KEY_ESCAPE) {
        glfwSetWindowShouldClose(from, GLFW_TRUE);
        return;
    }
    on_key(self->glfw, key, scancode, action, modifiers);
}

static mrt_result window_open_output(front *base, error *err)
{
    window *self = window_of(base);
    mrt_result result = front_output_create(&self->output, self->glfw, err);
    if (result < 0)
        return result;
    glfwSetKeyCallback(front_output_window(self->output), on_output_key);
    glfwFocusWindow(self->glfw);
    return MRT_OK;
}

static void window_close_output(front *base)
{
    window *self = window_of(base);
    front_output_destroy(self->output);
    self->output = NULL;
}

static bool window_has_output(const front *base)
{
    return ((const window *)base)->output != NULL;
}

static void window_output_size(const front *base, uint32_t *out_width, uint32_t *out_height)
{
    front_output_measure(((const window *)base)->output, out_width, out_height);
}

static void window_show_output(front *base, uint32_t texture, bool is_mirrored)
{
    window *self = window_of(base);
    uint32_t width, height;
    if (front_output_is_over(self->output)) {
        window_close_output(base);
        return;
    }
    front_output_measure(self->output, &width, &height);
    front_output_give(self->output, texture, width, height, is_mirrored);
}

/* ---- life ---- */

static void window_close(front *base)
{
    window *self = window_of(base);
    front_output_destroy(self->output);
    if (self->glfw) {
        front_sheet_finish(&self->sheet);
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

static const front_type type = {
    .close = window_close,
    .begin = window_begin,
    .end = window_end,
    .picture = window_picture,
    .set_title = window_set_title,
    .read_gamepad = window_read_gamepad,
    .open_output = window_open_output,
    .close_output = window_close_output,
    .has_output = window_has_output,
    .output_size = window_output_size,
    .show_output = window_show_output,
};

/* Two threads draw through one connection to the X server; libX11 before 1.8 must be told. */
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
    return why ? why : "nobody says why";
}

static mrt_result open_glfw(window *self, uint32_t width, uint32_t height, const char *title,
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
    glfwSetWindowSizeLimits(self->glfw, 800, 500, GLFW_DONT_CARE, GLFW_DONT_CARE);
    glfwMakeContextCurrent(self->glfw);
    glfwSwapInterval(1);
    return gl_check_current(err);
}

mrt_result front_open_window(front **out, uint32_t width, uint32_t height, const char *title,
                             error *err)
{
    *out = NULL;
    window *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the window");
    self->base.type = &type;
    mrt_result result = open_glfw(self, width, height, title, err);
    if (result < 0) {
        window_close(&self->base);
        return result;
    }
    glfwSetWindowUserPointer(self->glfw, self);
    listen(self->glfw);
    measure(self);
    self->frame_ns = refresh_ns();
    *out = &self->base;
    return MRT_OK;
}
