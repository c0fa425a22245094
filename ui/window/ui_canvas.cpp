/* Canvases: rectangles of a panel that take the pointer, and what is drawn on them. */
#include "window/ui_inside.hpp"

#include <cstring>

/* ---- the pointer ---- */

static void follow_drag(ui *self, ImGuiID id, const ImRect &box, ui_canvas *out)
{
    const ImVec2 pointer = ImGui::GetIO().MousePos;
    const bool is_active = ImGui::IsItemActive(), is_released = ImGui::IsItemDeactivated();
    out->button = -1;
    if (ImGui::IsItemActivated()) {
        self->grip.id = id;
        self->grip.start = self->grip.last = pointer;
        self->grip.button = GImGui->ActiveIdMouseButton;
    }
    if (self->grip.id != id || !(is_active || is_released))
        return;
    out->button = self->grip.button;
    out->start_x = (self->grip.start.x - box.Min.x) / self->scale;
    out->start_y = (self->grip.start.y - box.Min.y) / self->scale;
    out->moved_x = (pointer.x - self->grip.last.x) / self->scale;
    out->moved_y = (pointer.y - self->grip.last.y) / self->scale;
    self->grip.last = pointer;
    out->is_pressed = ImGui::IsItemActivated();
    out->is_dragging = is_active;
    out->is_released = is_released;
    if (is_released)
        self->grip.id = 0;
}

static bool is_double_clicked(void)
{
    return ImGui::IsMouseDoubleClicked(0) || ImGui::IsMouseDoubleClicked(1) ||
           ImGui::IsMouseDoubleClicked(2);
}

void ui_canvas_begin(ui *self, const char *id, float width, float height, ui_canvas *out)
{
    const ImVec2 room = ImGui::GetContentRegionAvail();
    const float wide = width > 0.0f ? ui_px(self, width) : room.x + ui_px(self, width);
    const float high = height > 0.0f ? ui_px(self, height) : room.y + ui_px(self, height);
    ImGui::InvisibleButton(id, ImVec2(ImMax(wide, 1.0f), ImMax(high, 1.0f)),
                           ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight |
                               ImGuiButtonFlags_MouseButtonMiddle);
    const ImGuiIO &io = ImGui::GetIO();
    const ImRect box(ImGui::GetItemRectMin(), ImGui::GetItemRectMax());
    *out = ui_canvas{};
    out->where = ui_points_box(self, box);
    out->x = (io.MousePos.x - box.Min.x) / self->scale;
    out->y = (io.MousePos.y - box.Min.y) / self->scale;
    out->is_hovered = ImGui::IsItemHovered();
    if (out->is_hovered) {
        out->wheel_x = io.MouseWheelH;
        out->wheel_y = io.MouseWheel;
        out->is_double_clicked = is_double_clicked();
    }
    out->modifiers = ui_modifiers(self);
    follow_drag(self, ImGui::GetItemID(), box, out);
    ImGui::PushClipRect(box.Min, box.Max, true);
}

void ui_canvas_end(ui *self)
{
    (void)self;
    ImGui::PopClipRect();
}

/* ---- shapes ---- */

static ImDrawList *list_of_window(void)
{
    return ImGui::GetWindowDrawList();
}

void ui_draw_box(ui *self, ui_rectangle where, uint32_t colour, float rounding)
{
    ui_put_box(self, ui_px_box(self, where), colour, ui_px(self, rounding));
}

void ui_draw_frame(ui *self, ui_rectangle where, uint32_t colour, float rounding, float thickness)
{
    const ImRect box = ui_px_box(self, where);
    list_of_window()->AddRect(box.Min, box.Max, ui_ink(colour), ui_px(self, rounding), 0,
                              ui_px(self, thickness));
}

void ui_draw_line(ui *self, float x0, float y0, float x1, float y1, uint32_t colour,
                  float thickness)
{
    list_of_window()->AddLine(ui_px2(self, x0, y0), ui_px2(self, x1, y1), ui_ink(colour),
                              ui_px(self, thickness));
}

void ui_draw_lines(ui *self, const float *xy, uint32_t count, uint32_t colour, float thickness)
{
    ImDrawList *list = list_of_window();
    for (uint32_t i = 0; i < count; ++i)
        list->PathLineTo(ui_px2(self, xy[2 * i], xy[2 * i + 1]));
    list->PathStroke(ui_ink(colour), 0, ui_px(self, thickness));
}

/* Quads without the seams that anti-aliased edges between them would show. */
void ui_draw_area(ui *self, const float *x, const float *low, const float *high, uint32_t count,
                  uint32_t colour)
{
    constexpr uint32_t part_max = 8192; /* columns: indices have 16 bits */
    ImDrawList *list = list_of_window();
    const ImVec2 white = ImGui::GetDrawListSharedData()->TexUvWhitePixel;
    for (uint32_t first = 0; first + 1 < count; first += part_max - 1) {
        const uint32_t columns = ImMin(count - first, part_max);
        list->PrimReserve(static_cast<int>(6 * (columns - 1)), static_cast<int>(2 * columns));
        const unsigned int base = list->_VtxCurrentIdx;
        for (uint32_t i = 0; i < columns; ++i) {
            list->PrimWriteVtx(ui_px2(self, x[first + i], low[first + i]), white, ui_ink(colour));
            list->PrimWriteVtx(ui_px2(self, x[first + i], high[first + i]), white, ui_ink(colour));
        }
        for (uint32_t i = 0; i + 1 < columns; ++i) {
            const unsigned int corner = base + 2 * i, order[] = {0, 1, 3, 0, 3, 2};
            for (unsigned int offset : order)
                list->PrimWriteIdx(static_cast<ImDrawIdx>(corner + offset));
        }
    }
}

void ui_draw_disc(ui *self, float x, float y, float radius, uint32_t colour)
{
    list_of_window()->AddCircleFilled(ui_px2(self, x, y), ui_px(self, radius), ui_ink(colour));
}

void ui_draw_ring(ui *self, float x, float y, float radius, uint32_t colour, float thickness)
{
    list_of_window()->AddCircle(ui_px2(self, x, y), ui_px(self, radius), ui_ink(colour), 0,
                                ui_px(self, thickness));
}

void ui_draw_triangle(ui *self, const float xy[6], uint32_t colour)
{
    list_of_window()->AddTriangleFilled(ui_px2(self, xy[0], xy[1]), ui_px2(self, xy[2], xy[3]),
                                        ui_px2(self, xy[4], xy[5]), ui_ink(colour));
}

void ui_draw_text(ui *self, float x, float y, ui_style style, uint32_t colour, float max_width,
                  const char *text)
{
    ui_put_text(self, ui_style_font(self, style), ui_px2(self, x, y), colour,
                max_width > 0.0f ? ui_px(self, max_width) : 0.0f, text, text + std::strlen(text));
}

void ui_draw_image(ui *self, ui_rectangle where, uint32_t texture, bool is_mirrored)
{
    const ImRect box = ui_px_box(self, where);
    const float left = is_mirrored ? 1.0f : 0.0f;
    list_of_window()->AddImage(reinterpret_cast<ImTextureID>(static_cast<uintptr_t>(texture)),
                               box.Min, box.Max, ImVec2(left, 1.0f), ImVec2(1.0f - left, 0.0f));
    ui_notes_box(self->notes, self->surface, where, 0);
}

void ui_clip_begin(ui *self, ui_rectangle where)
{
    const ImRect box = ui_px_box(self, where);
    ImGui::PushClipRect(box.Min, box.Max, true);
}

void ui_clip_end(ui *self)
{
    (void)self;
    ImGui::PopClipRect();
}
