/* window/gui/ui_damage.hpp - which parts of the screen differ from what was drawn last. The draw
 * lists of Dear ImGui say all of a frame, so comparing them misses nothing that a panel forgot to
 * report; only pictures have a version beside. For ui.cpp alone. [main] */
#ifndef MAROTTE_UI_WINDOW_GUI_UI_DAMAGE_HPP
#define MAROTTE_UI_WINDOW_GUI_UI_DAMAGE_HPP
#include <imgui.h>
#include <imgui_internal.h>

#include <cstdint>

constexpr int UI_DAMAGE_BOXES = 6;
constexpr int UI_DAMAGE_IMAGES = 16;

struct ui_damage_image {
    ImTextureID texture;
    uint64_t version; /* another one: its pixels have changed */
};

struct ui_damage_images {
    ui_damage_image of[UI_DAMAGE_IMAGES];
    int count; /* more than fit: all of them count as changed */
};

struct ui_damage_boxes { /* whole pixels; they do not overlap */
    ImRect box[UI_DAMAGE_BOXES];
    int count;
};

struct ui_damage;

ui_damage *ui_damage_create(); /* NULL: no memory */
void ui_damage_destroy(ui_damage *self);
/* What was drawn is gone: all of the screen differs. */
void ui_damage_forget(ui_damage *self);
/* What of `now` differs from what was kept. */
ui_damage_boxes ui_damage_find(const ui_damage *self, const ImDrawData *now,
                               const ui_damage_images *images);
/* It has been drawn. */
void ui_damage_keep(ui_damage *self, const ImDrawData *now, const ui_damage_images *images);

#endif
