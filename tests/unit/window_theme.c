/* The colours of the window: every colour of text can be read on every ground. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "window/gui/theme.h"

#include <math.h>

static const uint32_t texts[] = {THEME_TEXT,    THEME_DIM, THEME_ACCENT, THEME_RECORD, THEME_GOOD,
                                 THEME_WARNING, THEME_BAD, THEME_LEFT,   THEME_RIGHT};
static const uint32_t grounds[] = {THEME_STAGE, THEME_BAR,    THEME_PANEL,
                                   THEME_WELL,  THEME_RAISED, THEME_HOVER};

static double part(uint32_t colour, uint32_t shift)
{
    const double s = (double)(colour >> shift & 0xffu) / 255.0;
    return s <= 0.04045 ? s / 12.92 : pow((s + 0.055) / 1.055, 2.4);
}

/* As WCAG 2 counts it. */
static double contrast(uint32_t a, uint32_t b)
{
    const double x = 0.2126 * part(a, 24) + 0.7152 * part(a, 16) + 0.0722 * part(a, 8);
    const double y = 0.2126 * part(b, 24) + 0.7152 * part(b, 16) + 0.0722 * part(b, 8);
    return (fmax(x, y) + 0.05) / (fmin(x, y) + 0.05);
}

static const theme themes[] = {{false, false}, {true, false}, {false, true}, {true, true}};
enum { THEMES = sizeof themes / sizeof themes[0] };

static void every_text_can_be_read_on_every_ground(void **state)
{
    (void)state;
    for (size_t t = 0; t < THEMES; ++t)
        for (size_t i = 0; i < sizeof texts / sizeof texts[0]; ++i)
            for (size_t k = 0; k < sizeof grounds / sizeof grounds[0]; ++k) {
                const uint32_t text = theme_colour(themes[t], texts[i]);
                const uint32_t ground = theme_colour(themes[t], grounds[k]);
                if (contrast(text, ground) < 4.5)
                    fail_msg("theme %zu: #%08x on #%08x: %.2f", t, text, ground,
                             contrast(text, ground));
            }
}

static void letters_can_be_read_on_what_is_bright(void **state)
{
    static const uint32_t bright[] = {THEME_ACCENT, THEME_RECORD, THEME_ACCENT_HOVER};
    (void)state;
    for (size_t t = 0; t < THEMES; ++t)
        for (size_t i = 0; i < sizeof bright / sizeof bright[0]; ++i)
            assert_true(contrast(theme_colour(themes[t], THEME_STAGE),
                                 theme_colour(themes[t], bright[i])) >= 4.5);
}

/* As somebody sees it who lacks one kind of cones: Machado, Oliveira and Fernandes 2009, severity
 * 1.0; then Oklab. */
static void seen_as(double out_lab[3], uint32_t colour, const double lack[3][3])
{
    const double own[3] = {part(colour, 24), part(colour, 16), part(colour, 8)};
    double rgb[3], cone[3];
    static const double to_cone[3][3] = {{0.4122214708, 0.5363325363, 0.0514459929},
                                         {0.2119034982, 0.6806995451, 0.1073969566},
                                         {0.0883024619, 0.2817188376, 0.6299787005}};
    static const double to_lab[3][3] = {{0.2104542553, 0.7936177850, -0.0040720468},
                                        {1.9779984951, -2.4285922050, 0.4505937099},
                                        {0.0259040371, 0.7827717662, -0.8086757660}};
    for (size_t i = 0; i < 3; ++i)
        rgb[i] =
            fmin(fmax(lack[i][0] * own[0] + lack[i][1] * own[1] + lack[i][2] * own[2], 0.0), 1.0);
    for (size_t i = 0; i < 3; ++i)
        cone[i] = cbrt(to_cone[i][0] * rgb[0] + to_cone[i][1] * rgb[1] + to_cone[i][2] * rgb[2]);
    for (size_t i = 0; i < 3; ++i)
        out_lab[i] = to_lab[i][0] * cone[0] + to_lab[i][1] * cone[1] + to_lab[i][2] * cone[2];
}

static void safe_colours_are_told_apart_without_red_green_or_blue(void **state)
{
    static const double lacks[3][3][3] = {{{0.152286, 1.052583, -0.204868},
                                           {0.114503, 0.786281, 0.099216},
                                           {-0.003882, -0.048116, 1.051998}},
                                          {{0.367322, 0.860646, -0.227968},
                                           {0.280085, 0.672501, 0.047413},
                                           {-0.011820, 0.042940, 0.968881}},
                                          {{1.255528, -0.076749, -0.178779},
                                           {-0.078411, 0.930809, 0.147602},
                                           {0.004733, 0.691367, 0.303900}}};
    static const uint32_t pairs[][2] = {{THEME_GOOD, THEME_BAD},      {THEME_GOOD, THEME_WARNING},
                                        {THEME_WARNING, THEME_BAD},   {THEME_LEFT, THEME_RIGHT},
                                        {THEME_ACCENT, THEME_RECORD}, {THEME_GOOD, THEME_RECORD}};
    const double least = 0.1; /* of Oklab, where black and white are 1 apart */
    (void)state;
    for (size_t t = 2; t < THEMES; ++t)
        for (size_t k = 0; k < 3; ++k)
            for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; ++i) {
                double a[3], b[3];
                seen_as(a, theme_colour(themes[t], pairs[i][0]), lacks[k]);
                seen_as(b, theme_colour(themes[t], pairs[i][1]), lacks[k]);
                const double apart =
                    sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) +
                         (a[2] - b[2]) * (a[2] - b[2]));
                if (apart < least)
                    fail_msg("theme %zu, lack %zu, pair %zu: %.3f apart", t, k, i, apart);
            }
}

static void a_colour_without_a_name_turns_round_and_keeps_its_alpha(void **state)
{
    (void)state;
    assert_int_equal(theme_colour(themes[0], 0x2c3a41ffu), 0x2c3a41ffu);
    const uint32_t light = theme_colour(themes[1], 0x2c3a4180u);
    assert_int_equal(light & 0xffu, 0x80);
    assert_true(part(light, 16) > 0.5);
    assert_int_equal(theme_colour(themes[1], 0), 0);
    assert_int_equal(theme_colour(themes[1], THEME_ACCENT - 0xbfu) & 0xffu, 0x40);
    assert_int_equal(theme_colour(themes[1], THEME_ACCENT - 0xbfu) >> 8,
                     theme_colour(themes[1], THEME_ACCENT) >> 8);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_text_can_be_read_on_every_ground),
        cmocka_unit_test(letters_can_be_read_on_what_is_bright),
        cmocka_unit_test(safe_colours_are_told_apart_without_red_green_or_blue),
        cmocka_unit_test(a_colour_without_a_name_turns_round_and_keeps_its_alpha),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
