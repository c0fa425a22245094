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

static void every_text_can_be_read_on_every_ground(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; ++i)
        for (size_t k = 0; k < sizeof grounds / sizeof grounds[0]; ++k)
            if (contrast(texts[i], grounds[k]) < 4.5)
                fail_msg("#%08x on #%08x: %.2f", texts[i], grounds[k],
                         contrast(texts[i], grounds[k]));
}

static void dark_letters_can_be_read_on_what_is_bright(void **state)
{
    (void)state;
    assert_true(contrast(THEME_STAGE, THEME_ACCENT) >= 4.5);
    assert_true(contrast(THEME_STAGE, THEME_RECORD) >= 4.5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_text_can_be_read_on_every_ground),
        cmocka_unit_test(dark_letters_can_be_read_on_what_is_bright),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
