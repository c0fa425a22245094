/* window/ui_fonts.hpp - the fonts of the window at the scale it has: Inter, with DejaVu for what it
 * has no signs for; without both, what Dear ImGui brings. [main] */
#ifndef MAROTTE_UI_WINDOW_UI_FONTS_HPP
#define MAROTTE_UI_WINDOW_UI_FONTS_HPP
#include "window/ui_inside.hpp"

/* Replaces those that are loaded. Never fails: some font is always there. */
void ui_fonts_load(ui *self);

#endif
