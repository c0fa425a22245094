/* What a frame is handed of keys, letters and the pointer, and who gets a key: a text that is
 * typed, a question, or whoever asks. */
#include "window/ui_inside.hpp"

#include <cstring>

/* The '?' of other keyboards is not over the '/'. */
static void read_question_mark(ui_frame_input *input)
{
    for (uint32_t i = 0; i < input->text_count; ++i)
        if (input->text[i] == '?' && !input->key['/'])
            input->pressed['?'] = true;
}

static bool is_text_of_lines()
{
    const ImGuiContext &g = *ImGui::GetCurrentContext();
    return g.InputTextState.ID == g.ActiveId &&
           (g.InputTextState.Flags & ImGuiInputTextFlags_Multiline) != 0;
}

/* Writes nothing and changes nothing in a text that is typed. Ctrl with Alt is AltGr. */
static bool is_command(uint32_t key, uint32_t modifiers)
{
    if (key >= UI_KEY_F1 && key <= UI_KEY_F12)
        return true;
    if (key == UI_KEY_PAGE_UP || key == UI_KEY_PAGE_DOWN)
        return !is_text_of_lines();
    return key > ' ' && key < 127 && (modifiers & UI_CONTROL) && !(modifiers & UI_ALT) &&
           !std::strchr("ACVXYZ", static_cast<int>(key));
}

/* A command ends the text as Enter does and is there in the next frame: what it does may put away
 * the widget that holds the text. */
static void find_command(ui *self)
{
    ui_frame_input *input = self->input;
    const uint32_t modifiers = ui_frame_modifiers(input);
    self->late = self->command;
    self->late_modifiers = self->command_modifiers;
    self->command = UI_KEY_NONE;
    if (!input->is_typing || ImGui::GetTopMostPopupModal())
        return;
    for (uint32_t key = 1; key < UI_KEY_COUNT; ++key) {
        if (!input->pressed[key] || !is_command(key, modifiers))
            continue;
        self->command = key;
        self->command_modifiers = modifiers;
    }
}

void ui_hand_over(ui *self)
{
    ImGuiIO &io = ImGui::GetIO();
    ui_frame_input *input = self->input;
    input->is_typing = io.WantTextInput;
    ui_queue_take(self->queue, input);
    read_question_mark(input);
    find_command(self);
    io.MousePos =
        input->has_pointer ? ui_px2(self, input->x, input->y) : ImVec2(-FLT_MAX, -FLT_MAX);
    for (uint32_t i = 0; i < UI_BUTTONS; ++i)
        io.MouseDown[i] = input->button[i];
    io.MouseWheel = input->wheel_y;
    io.MouseWheelH = input->wheel_x;
    for (uint32_t i = 0; i < UI_KEY_COUNT; ++i)
        io.KeysDown[i] = input->key[i];
    io.KeyShift = input->key[UI_KEY_SHIFT];
    io.KeyCtrl = input->key[UI_KEY_CONTROL];
    io.KeyAlt = input->key[UI_KEY_ALT];
    for (uint32_t i = 0; i < input->text_count; ++i)
        io.AddInputCharacter(input->text[i]);
}

/* ---- keys ---- */

/* Questions over everything keep the keys to themselves. */
static bool has_keys(const ui *self)
{
    return !ImGui::GetIO().WantTextInput &&
           (self->dialog_depth > 0 || !ImGui::GetTopMostPopupModal());
}

bool ui_pressed(const ui *self, uint32_t key, uint32_t modifiers)
{
    if (key >= UI_KEY_COUNT || !has_keys(self))
        return false;
    if (key == '/' && modifiers == UI_SHIFT && self->input->pressed['?'])
        return true;
    if (key == self->late && modifiers == self->late_modifiers && key != UI_KEY_NONE)
        return true;
    return self->input->pressed[key] && ui_frame_modifiers(self->input) == modifiers;
}

bool ui_is_down(const ui *self, uint32_t key)
{
    return key < UI_KEY_COUNT && has_keys(self) && self->input->key[key];
}

uint32_t ui_modifiers(const ui *self)
{
    return ui_frame_modifiers(self->input);
}

bool ui_is_typing(const ui *self)
{
    (void)self;
    return ImGui::GetIO().WantTextInput;
}
