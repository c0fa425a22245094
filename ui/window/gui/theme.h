/* window/gui/theme.h - colours and sizes of the window. Colours are 0xRRGGBBAA in sRGB. Each text
 * colour has a contrast of at least 4.5:1 on each background (tests/unit/window_theme.c). Panels
 * use colours of the dark theme, and the ui converts them to the selected theme (theme_colour).
 * Pure. */
#ifndef MAROTTE_UI_WINDOW_GUI_THEME_H
#define MAROTTE_UI_WINDOW_GUI_THEME_H
#include <stdbool.h>
#include <stdint.h>

#define THEME_STAGE   0x101113ffu /* behind the face */
#define THEME_BAR     0x17191cffu
#define THEME_PANEL   0x1c1f23ffu
#define THEME_WELL    0x131518ffu /* fields, lanes */
#define THEME_RAISED  0x2a2e34ffu /* buttons, clips */
#define THEME_HOVER   0x31363dffu
#define THEME_RULE    0x33383fffu
#define THEME_TEXT    0xe6e3dcffu
#define THEME_DIM     0xa5a49effu
#define THEME_ACCENT  0xd9a441ffu /* felt and brass: what is chosen */
#define THEME_RECORD  0xff7268ffu
#define THEME_GOOD    0x7fc48affu
#define THEME_WARNING 0xe6b450ffu
#define THEME_BAD     0xff8a80ffu
#define THEME_LEFT    0x6fb3d9ffu /* the left hand */
#define THEME_RIGHT   0xd98f6fffu /* the right hand */
#define THEME_OFF     0x5a5f66ffu /* a sign of what cannot be done now */

#define THEME_ACCENT_HOVER 0xe6b65cffu

typedef struct theme {
    bool is_light;
    /* Colours that carry meaning (good and bad, left and right, recording) can be distinguished by
     * users who cannot see red, green or blue. */
    bool is_colour_safe;
} theme;
/* Converts `colour` of the dark theme to that theme, with the same alpha. A colour without a name
 * here keeps its hue, and its lightness is inverted in the light theme. */
uint32_t theme_colour(theme of, uint32_t colour);
/* A part of a colour as on a screen, 0..255, as light, 0..1; and back. */
double theme_linear(uint32_t part);
uint32_t theme_coded(double part);

#define THEME_BODY_POINTS  14.0f
#define THEME_TITLE_POINTS 15.0f
#define THEME_LARGE_POINTS 34.0f
#define THEME_PADDING      8.0f
#define THEME_BAR_HEIGHT   52.0f
#define THEME_DOCK_WIDTH   330.0f

#endif
