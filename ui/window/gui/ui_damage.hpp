/* window/gui/ui_damage.hpp - finds the parts of the screen that differ from the previous frame. It
 * compares the draw lists of Dear ImGui, which describe the whole frame, so panels report nothing.
 * Pictures are compared by a version number. For ui.cpp alone. [main] */
#ifndef MAROTTE_UI_WINDOW_GUI_UI_DAMAGE_HPP
#define MAROTTE_UI_WINDOW_GUI_UI_DAMAGE_HPP
#include <imgui.h>
#include <imgui_internal.h>

#include <cstdint>

constexpr int UI_DAMAGE_BOXES = 6;
constexpr int UI_DAMAGE_IMAGES = 16;

struct ui_damage_image {
    ImTextureID texture;
    uint64_t version; /* changes when its pixels change */
};

struct ui_damage_images {
    ui_damage_image of[UI_DAMAGE_IMAGES];
    int count; /* above UI_DAMAGE_IMAGES: all count as changed */
};

struct ui_damage_boxes { /* whole pixels; they do not overlap */
    ImRect box[UI_DAMAGE_BOXES];
    int count;
};

struct ui_damage;

ui_damage *ui_damage_create(); /* NULL: no memory */
void ui_damage_destroy(ui_damage *self);
/* The framebuffer lost its content: the whole screen differs. */
void ui_damage_forget(ui_damage *self);
/* The parts of `now` that differ from the kept frame. */
ui_damage_boxes ui_damage_find(const ui_damage *self, const ImDrawData *now,
                               const ui_damage_images *images);
/* Keeps `now`: it has been drawn. */
void ui_damage_keep(ui_damage *self, const ImDrawData *now, const ui_damage_images *images);

#endif
