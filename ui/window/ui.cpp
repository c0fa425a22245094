/* The facade over Dear ImGui: its life, its frame, places and text. Widgets are in ui_widgets.cpp,
 * canvases in ui_canvas.cpp, fonts in ui_fonts.cpp. */
#include "window/ui_fonts.hpp"
#include "window/ui_inside.hpp"

#include <backends/imgui_impl_opengl3.h>

#include <cstdlib>
#include <cstring>
#include <new>

extern "C" {
#include "draw/gl.h"
}

/* ---- life ---- */

static void map_keys(ImGuiIO &io)
{
    io.KeyMap[ImGuiKey_Tab] = UI_KEY_TAB;
    io.KeyMap[ImGuiKey_LeftArrow] = UI_KEY_LEFT;
    io.KeyMap[ImGuiKey_RightArrow] = UI_KEY_RIGHT;
    io.KeyMap[ImGuiKey_UpArrow] = UI_KEY_UP;
    io.KeyMap[ImGuiKey_DownArrow] = UI_KEY_DOWN;
    io.KeyMap[ImGuiKey_PageUp] = UI_KEY_PAGE_UP;
    io.KeyMap[ImGuiKey_PageDown] = UI_KEY_PAGE_DOWN;
    io.KeyMap[ImGuiKey_Home] = UI_KEY_HOME;
    io.KeyMap[ImGuiKey_End] = UI_KEY_END;
    io.KeyMap[ImGuiKey_Insert] = UI_KEY_INSERT;
    io.KeyMap[ImGuiKey_Delete] = UI_KEY_DELETE;
    io.KeyMap[ImGuiKey_Backspace] = UI_KEY_BACKSPACE;
    io.KeyMap[ImGuiKey_Space] = ' ';
    io.KeyMap[ImGuiKey_Enter] = UI_KEY_ENTER;
    io.KeyMap[ImGuiKey_Escape] = UI_KEY_ESCAPE;
    io.KeyMap[ImGuiKey_A] = 'A';
    io.KeyMap[ImGuiKey_C] = 'C';
    io.KeyMap[ImGuiKey_V] = 'V';
    io.KeyMap[ImGuiKey_X] = 'X';
    io.KeyMap[ImGuiKey_Y] = 'Y';
    io.KeyMap[ImGuiKey_Z] = 'Z';
}

static ImVec4 style_colour(uint32_t colour)
{
    return ImGui::ColorConvertU32ToFloat4(ui_ink(colour));
}

static void set_colours(ImGuiStyle &style)
{
    const struct {
        ImGuiCol which;
        uint32_t colour;
    } colours[] = {{ImGuiCol_Text, THEME_TEXT},
                   {ImGuiCol_TextDisabled, THEME_DIM},
                   {ImGuiCol_WindowBg, THEME_PANEL},
                   {ImGuiCol_ChildBg, 0},
                   {ImGuiCol_PopupBg, THEME_PANEL},
                   {ImGuiCol_Border, THEME_RULE},
                   {ImGuiCol_FrameBg, THEME_WELL},
                   {ImGuiCol_FrameBgHovered, THEME_WELL},
                   {ImGuiCol_FrameBgActive, THEME_WELL},
                   {ImGuiCol_ScrollbarBg, 0},
                   {ImGuiCol_ScrollbarGrab, THEME_RULE},
                   {ImGuiCol_ScrollbarGrabHovered, THEME_HOVER},
                   {ImGuiCol_ScrollbarGrabActive, THEME_HOVER},
                   {ImGuiCol_SliderGrab, 0},
                   {ImGuiCol_SliderGrabActive, 0},
                   {ImGuiCol_Button, THEME_RAISED},
                   {ImGuiCol_ButtonHovered, THEME_HOVER},
                   {ImGuiCol_ButtonActive, THEME_HOVER},
                   {ImGuiCol_Header, THEME_RAISED},
                   {ImGuiCol_HeaderHovered, THEME_HOVER},
                   {ImGuiCol_HeaderActive, THEME_HOVER},
                   {ImGuiCol_TextSelectedBg, 0xd9a44150u},
                   {ImGuiCol_ModalWindowDimBg, 0x08090aa0u},
                   {ImGuiCol_NavHighlight, 0}};
    for (const auto &entry : colours)
        style.Colors[entry.which] = style_colour(entry.colour);
}

static void set_style(ui *self)
{
    ImGuiStyle style;
    set_colours(style);
    style.WindowPadding = ImVec2(THEME_PADDING, THEME_PADDING);
    style.FramePadding = ImVec2(8.0f, 4.0f);
    style.ItemSpacing = ImVec2(8.0f, 6.0f);
    style.WindowRounding = 0.0f;
    style.PopupRounding = 6.0f;
    style.FrameRounding = 4.0f;
    style.ScrollbarSize = 9.0f;
    style.ScrollbarRounding = 4.0f;
    style.WindowBorderSize = 0.0f;
    style.PopupBorderSize = 1.0f;
    style.DisabledAlpha = 1.0f;
    style.AntiAliasedLinesUseTex = true;
    style.ScaleAllSizes(self->scale);
    style.WindowMinSize = ImVec2(1.0f, 1.0f);
    ImGui::GetStyle() = style;
}

static mrt_result start(ui *self, error *err)
{
    self->queue = static_cast<ui_queue *>(std::malloc(sizeof(ui_queue)));
    self->input = static_cast<ui_frame_input *>(std::calloc(1, sizeof(ui_frame_input)));
    self->notes = ui_notes_create();
    if (!self->queue || !self->input || !self->notes)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the window");
    ui_queue_init(self->queue);
    IMGUI_CHECKVERSION();
    self->context = ImGui::CreateContext();
    if (!self->context)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the window");
    ImGui::SetCurrentContext(self->context);
    ImGuiIO &io = ImGui::GetIO();
    io.IniFilename = nullptr;
    io.LogFilename = nullptr;
    io.ConfigInputTextCursorBlink = false;
    io.ConfigWindowsMoveFromTitleBarOnly = true;
    io.MouseDragThreshold = 3.0f;
    map_keys(io);
    self->is_drawing = ImGui_ImplOpenGL3_Init("#version 330 core");
    if (!self->is_drawing)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "the panels cannot be drawn: OpenGL 3.3 did not start");
    return MRT_OK;
}

mrt_result ui_create(ui **out, error *err)
{
    *out = nullptr;
    mrt_result result = gl_check_current(err);
    if (result < 0)
        return result;
    ui *self = static_cast<ui *>(std::calloc(1, sizeof(ui)));
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the window");
    result = start(self, err);
    if (result < 0) {
        ui_destroy(self);
        return result;
    }
    *out = self;
    return MRT_OK;
}

void ui_destroy(ui *self)
{
    if (!self)
        return;
    if (self->context)
        ImGui::SetCurrentContext(self->context);
    if (self->is_drawing)
        ImGui_ImplOpenGL3_Shutdown();
    if (self->context)
        ImGui::DestroyContext(self->context);
    ui_notes_destroy(self->notes);
    std::free(self->input);
    std::free(self->queue);
    std::free(self);
}

/* ---- events ---- */

void ui_push(ui *self, const ui_event *event)
{
    ui_queue_push(self->queue, event);
}

bool ui_is_idle(const ui *self)
{
    return ui_queue_is_empty(self->queue);
}

void ui_set_clipboard(ui *self, const ui_clipboard *clipboard)
{
    ImGui::SetCurrentContext(self->context);
    ImGuiIO &io = ImGui::GetIO();
    io.ClipboardUserData = clipboard->data;
    io.GetClipboardTextFn = clipboard->get;
    io.SetClipboardTextFn = clipboard->set;
}

/* ---- frame ---- */

static void set_scale(ui *self, float scale)
{
    if (self->scale == scale)
        return;
    self->scale = scale;
    ui_fonts_load(self);
    set_style(self);
    ImGui_ImplOpenGL3_DestroyDeviceObjects(); /* with the texture of the old fonts */
}

static constexpr float double_click_s = 0.3f;

void ui_begin(ui *self, const ui_screen *screen)
{
    ImGui::SetCurrentContext(self->context);
    ImGuiIO &io = ImGui::GetIO();
    self->screen = *screen;
    set_scale(self, screen->scale > 0.25f ? screen->scale : 0.25f);
    io.DisplaySize = ui_px2(self, screen->width, screen->height);
    io.DeltaTime = screen->dt_s > 1e-5 ? static_cast<float>(screen->dt_s) : 1e-5f;
    /* Each click takes two frames (ui_queue.h): where they are slow, a hand is not. */
    io.MouseDoubleClickTime = double_click_s + 3.0f * io.DeltaTime;
    ui_hand_over(self);
    self->cursor = UI_CURSOR_ARROW;
    self->panel_count = self->popup_depth = 0;
    self->had_dialog = self->has_dialog;
    self->has_dialog = false;
    self->next_width = 0.0f;
    self->is_slider_held = false;
    ui_notes_begin(self->notes);
    ImGui_ImplOpenGL3_NewFrame();
    ImGui::NewFrame();
    if (self->command != UI_KEY_NONE)
        ImGui::ClearActiveID();
}

/* Panels lie over each other in the order in which they were begun. */
static void order_panels(ui *self)
{
    for (int i = self->panel_count - 1; i >= 0; --i)
        ImGui::BringWindowToDisplayBack(self->panel[i]);
}

static ui_cursor cursor_of(ImGuiMouseCursor wanted)
{
    switch (wanted) {
    case ImGuiMouseCursor_TextInput:
        return UI_CURSOR_TEXT;
    case ImGuiMouseCursor_Hand:
        return UI_CURSOR_HAND;
    case ImGuiMouseCursor_ResizeAll:
        return UI_CURSOR_MOVE;
    case ImGuiMouseCursor_ResizeEW:
        return UI_CURSOR_ACROSS;
    case ImGuiMouseCursor_ResizeNS:
        return UI_CURSOR_DOWN;
    default:
        return UI_CURSOR_ARROW;
    }
}

void ui_end(ui *self)
{
    order_panels(self);
    ui_close_left_popups();
    ui_notes_end(self->notes);
    if (self->cursor == UI_CURSOR_ARROW)
        self->cursor = cursor_of(ImGui::GetMouseCursor());
    ImGui::Render();
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

void ui_set_cursor(ui *self, ui_cursor cursor)
{
    self->cursor = cursor;
}

ui_cursor ui_cursor_wanted(const ui *self)
{
    return self->cursor;
}

/* ---- places ---- */

void ui_panel_begin(ui *self, const char *id, ui_rectangle where, ui_ground ground)
{
    const ImGuiWindowFlags flags =
        ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
        ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoNav |
        ImGuiWindowFlags_NoScrollWithMouse | ImGuiWindowFlags_NoBackground |
        ImGuiWindowFlags_NoFocusOnAppearing; /* Dear ImGui aborts beside a new question */
    ImRect box = ui_px_box(self, where);
    box.Min = ImFloor(box.Min + ImVec2(0.5f, 0.5f));
    box.Max = ImFloor(box.Max + ImVec2(0.5f, 0.5f));
    ImGui::SetNextWindowPos(box.Min);
    ImGui::SetNextWindowSize(ImMax(box.GetSize(), ImVec2(1.0f, 1.0f)));
    const float padding = ground == UI_GROUND_NONE ? 0.0f : ui_px(self, THEME_PADDING);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(padding, padding));
    ImGui::Begin(id, nullptr, flags);
    ImGui::PopStyleVar();
    if (self->panel_count < UI_PANELS_MAX)
        self->panel[self->panel_count++] = ImGui::GetCurrentWindow();
    ImGui::PushClipRect(box.Min, box.Max, false); /* to its edge, not to half its padding */
    self->surface = ui_notes_surface(self->notes, where, false);
    if (ground != UI_GROUND_NONE)
        ui_put_box(self, box, ground == UI_GROUND_BAR ? THEME_BAR : THEME_PANEL, 0.0f);
}

void ui_panel_end(ui *self)
{
    (void)self;
    ImGui::PopClipRect();
    ImGui::End();
}

static float size_px(const ui *self, float points)
{
    return points == 0.0f ? 0.0f : ui_whole_px(self, points);
}

void ui_scroll_begin(ui *self, const char *id, float width, float height)
{
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0.0f, 0.0f));
    ImGui::BeginChild(id, ImVec2(size_px(self, width), size_px(self, height)), false,
                      ImGuiWindowFlags_NoNav);
    ImGui::PopStyleVar();
}

void ui_scroll_end(ui *self)
{
    (void)self;
    ImGui::EndChild();
}

void ui_scroll_to_end(ui *self)
{
    (void)self;
    ImGui::SetScrollHereY(1.0f);
}

void ui_same_line(ui *self)
{
    (void)self;
    ImGui::SameLine();
}

void ui_at(ui *self, float x)
{
    const ImGuiWindow *window = ImGui::GetCurrentWindow();
    ImGui::SameLine();
    ImGui::SetCursorPosX(window->WindowPadding.x + ui_whole_px(self, x));
}

void ui_space(ui *self, float height)
{
    ImGuiWindow *window = ImGui::GetCurrentWindow();
    window->DC.CursorPos.y += ui_whole_px(self, height);
    window->DC.CursorMaxPos.y =
        ImMax(window->DC.CursorMaxPos.y, window->DC.CursorPos.y - ImGui::GetStyle().ItemSpacing.y);
}

void ui_rule(ui *self)
{
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float width = ImGui::GetContentRegionAvail().x, thick = ImMax(1.0f, ui_px(self, 1.0f));
    ui_put_box(self, ImRect(at, at + ImVec2(width, thick)), THEME_RULE, 0.0f);
    ImGui::Dummy(ImVec2(width, thick));
}

void ui_width(ui *self, float width)
{
    self->next_width = size_px(self, width);
}

float ui_available_width(const ui *self)
{
    return ImGui::GetContentRegionAvail().x / self->scale;
}

float ui_available_height(const ui *self)
{
    return ImGui::GetContentRegionAvail().y / self->scale;
}

float ui_row_height(const ui *self)
{
    return ui_text_height(self, UI_STYLE_BODY) +
           2.0f * ImGui::GetStyle().FramePadding.y / self->scale;
}

void ui_id_begin(ui *self, const char *id)
{
    (void)self;
    ImGui::PushID(id);
}

void ui_id_end(ui *self)
{
    (void)self;
    ImGui::PopID();
}

void ui_disabled_begin(ui *self, bool is_disabled)
{
    ImGui::BeginDisabled(is_disabled);
    ImGui::PushStyleColor(ImGuiCol_Text,
                          is_disabled ? ui_ink(THEME_DIM) : ImGui::GetColorU32(ImGuiCol_Text));
    self->disabled_depth = (self->disabled_depth << 1) | (is_disabled ? 1 : 0);
}

void ui_disabled_end(ui *self)
{
    self->disabled_depth >>= 1;
    ImGui::PopStyleColor();
    ImGui::EndDisabled();
}

/* ---- what was drawn ---- */

void ui_note_words(ui *self, bool is_noting)
{
    ui_notes_set(self->notes, is_noting);
}

uint32_t ui_words(const ui *self, const ui_word **out)
{
    return ui_notes_words(self->notes, out);
}
