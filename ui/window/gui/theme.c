#include "window/gui/theme.h"

#include "base/srgb.h"

#include <math.h>
#include <stddef.h>

typedef struct named {
    uint32_t dark, light, dark_safe, light_safe;
} named;

static const named names[] = {
    {THEME_STAGE, 0xf6f5f2ffu, THEME_STAGE, 0xf6f5f2ffu},
    {THEME_BAR, 0xeae8e4ffu, THEME_BAR, 0xeae8e4ffu},
    {THEME_PANEL, 0xf2f0edffu, THEME_PANEL, 0xf2f0edffu},
    {THEME_WELL, 0xfdfcfaffu, THEME_WELL, 0xfdfcfaffu},
    {THEME_RAISED, 0xe2dfd9ffu, THEME_RAISED, 0xe2dfd9ffu},
    {THEME_HOVER, 0xd9d5ceffu, THEME_HOVER, 0xd9d5ceffu},
    {THEME_RULE, 0xc6c2baffu, THEME_RULE, 0xc6c2baffu},
    {THEME_TEXT, 0x1d1e20ffu, THEME_TEXT, 0x1d1e20ffu},
    {THEME_DIM, 0x4d4b47ffu, THEME_DIM, 0x4d4b47ffu},
    {THEME_OFF, 0xa5a199ffu, THEME_OFF, 0xa5a199ffu},
    {THEME_ACCENT, 0x784d00ffu, 0xf2e64effu, 0x6a5000ffu},
    {THEME_ACCENT_HOVER, 0x5f3d00ffu, 0xf7ef86ffu, 0x524000ffu},
    {THEME_RECORD, 0xa8140fffu, 0xff8247ffu, 0x700058ffu},
    {THEME_GOOD, 0x1f5f2bffu, 0x5cc8ffffu, 0x0058a8ffu},
    {THEME_WARNING, 0x7d4300ffu, 0xf0d860ffu, 0x665300ffu},
    {THEME_BAD, 0xa01a28ffu, 0xff8c94ffu, 0x640040ffu},
    {THEME_LEFT, 0x12577fffu, 0x6cb8f0ffu, 0x005a9effu},
    {THEME_RIGHT, 0x8b3f17ffu, 0xe8993affu, 0x8a4000ffu},
};

double theme_linear(uint32_t part)
{
    return srgb_to_linear((double)(part & 0xffu) / 255.0);
}

uint32_t theme_coded(double part)
{
    if (!(part > 0.0))
        return 0;
    if (part >= 1.0)
        return 255;
    return (uint32_t)(255.0 * srgb_from_linear(part) + 0.5);
}

/* Oklab (Ottosson 2020): the lightness between those of stage and text is turned round. */
static uint32_t turned_round(uint32_t colour)
{
    const double r = theme_linear(colour >> 24), g = theme_linear(colour >> 16),
                 b = theme_linear(colour >> 8);
    const double l = cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
    const double m = cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
    const double s = cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
    const double light = 0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s;
    const double x = 1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s;
    const double y = 0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s;
    const double turned = fmin(fmax(1.135 - light, 0.0), 1.0);
    const double l2 = pow(turned + 0.3963377774 * x + 0.2158037573 * y, 3.0);
    const double m2 = pow(turned - 0.1055613458 * x - 0.0638541728 * y, 3.0);
    const double s2 = pow(turned - 0.0894841775 * x - 1.2914855480 * y, 3.0);
    return theme_coded(4.0767416621 * l2 - 3.3077115913 * m2 + 0.2309699292 * s2) << 24 |
           theme_coded(-1.2684380046 * l2 + 2.6097574011 * m2 - 0.3413193965 * s2) << 16 |
           theme_coded(-0.0041960863 * l2 - 0.7034186147 * m2 + 1.7076147010 * s2) << 8;
}

uint32_t theme_colour(theme of, uint32_t colour)
{
    const uint32_t alpha = colour & 0xffu;
    if ((!of.is_light && !of.is_colour_safe) || alpha == 0)
        return colour;
    for (size_t i = 0; i < sizeof names / sizeof names[0]; ++i) {
        if ((names[i].dark ^ colour) >> 8)
            continue;
        const uint32_t found = of.is_light
                                   ? of.is_colour_safe ? names[i].light_safe : names[i].light
                                   : names[i].dark_safe;
        return (found & 0xffffff00u) | alpha;
    }
    return of.is_light ? turned_round(colour) | alpha : colour;
}
