/* Words in pictures. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "draw/draw.h"
#include "draw/annotations.h"
#include "draw/system_font.h"
#include "draw_help.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { WIDTH = 320, HEIGHT = 80, BYTES = WIDTH * HEIGHT * 4 };

static const float white[4] = {1, 1, 1, 1};
static letters *font;
static draw_target *target;
static uint8_t page[BYTES], picture[BYTES], other[BYTES];

static void write_fresh(letters *with, const char *words, float x, float y, float size_px,
                        uint8_t *out)
{
    error err;
    draw_target_destroy(target);
    target = draw_target_create(WIDTH, HEIGHT, &err);
    assert_non_null(target);
    letters_draw(with, target, words, x, y, size_px, white);
    draw_read(target, out);
}

static int need_font(void **state)
{
    (void)state;
    if (!letters_font(font))
        printf("SKIPPED: no font was found: install fonts-inter\n");
    return 0;
}

static void widths_add_up_and_scale(void **state)
{
    (void)state;
    if (!letters_font(font))
        skip();
    float one = letters_width(font, "Marotte", 20), two = letters_width(font, "MarotteMarotte", 20);
    assert_true(one > 40.0f && one < 120.0f);
    assert_near(two, 2 * one, 0.02);
    assert_near(letters_width(font, "Marotte", 40), 2 * one, 0.02f * one);
    assert_true(letters_width(font, "", 20) == 0.0f);
    assert_near(letters_width(font, "\xc3\xa9", 20), letters_width(font, "e", 20), 0.5);
}

static void ink_lies_within_the_measured_line(void **state)
{
    (void)state;
    if (!letters_font(font))
        skip();
    const float x = 30.4f, y = 20.0f, size = 32.0f;
    write_fresh(font, "Ågjy 0123", x, y, size, picture);
    float width = letters_width(font, "Ågjy 0123", size);
    int inked = 0, left = WIDTH, right = 0;
    for (int row = 0; row < HEIGHT; ++row)
        for (int column = 0; column < WIDTH; ++column) {
            const uint8_t *p = picture + (row * WIDTH + column) * 4;
            if (memcmp(p, page, 4) == 0)
                continue;
            ++inked;
            assert_true(column >= (int)x - 1 && (float)column <= x + width + 1.0f);
            assert_true(row >= (int)y - 1 && (float)row <= y + size + 1.0f);
            left = column < left ? column : left;
            right = column > right ? column : right;
        }
    assert_true(inked > 500);
    assert_true((float)left < x + 6.0f && (float)right > x + width - 6.0f);
    assert_true(picture[0] == page[0] && picture[3] == 255);
}

static void strokes_are_crisp(void **state)
{
    (void)state;
    if (!letters_font(font))
        skip();
    write_fresh(font, "HHHH", 10, 10, 48, picture);
    int full = 0;
    for (int i = 0; i < WIDTH * HEIGHT; ++i)
        full += picture[i * 4] > 250;
    assert_true(full > 200);
}

static void broken_utf8_is_drawn_as_something(void **state)
{
    (void)state;
    static const char *const broken[] = {"\xff\xfe",      "\xc3",     "a\xe2\x82",
                                         "\xf0\x9f\x98",  "\x80\x80", "\xed\xa0\x80",
                                         "tab\tline\nend"};
    for (size_t i = 0; i < sizeof broken / sizeof *broken; ++i)
        write_fresh(font, broken[i], 0, 0, 20, picture);
    write_fresh(font, "wild", NAN, 1e30f, 20, picture);
    write_fresh(font, "wild", 0, 0, NAN, picture);
    write_fresh(font, "wild", 0, 0, 1e9f, picture);
    write_fresh(font, "wild", 0, 0, -5, picture);
}

static void letters_stay_right_when_the_atlas_overflows(void **state)
{
    (void)state;
    write_fresh(font, "The quick brown fox", 5, 5, 24, picture);
    for (int size = 10; size < 250; ++size)
        write_fresh(font, "ABCDEFGHIJKLMNOPQRSTUVWXYZ&%@", 0, 0, (float)size, other);
    write_fresh(font, "The quick brown fox", 5, 5, 24, other);
    assert_memory_equal(picture, other, BYTES);
}

static void letters_that_our_font_lacks_come_from_the_system(void **state)
{
    (void)state;
    static const struct {
        const char *script, *one, *other;
        uint32_t first;
    } pairs[] = {{"Hebrew", "\xd7\xa9", "\xd7\x9c", 0x5e9},
                 {"Arabic", "\xd8\xb3", "\xd9\x85", 0x633},
                 {"Chinese", "\xe6\xbc\xa2", "\xe5\xad\x97", 0x6f22},
                 {"Devanagari", "\xe0\xa4\xa8", "\xe0\xa4\xae", 0x928}};
    system_fonts *fonts = system_fonts_create();
    assert_non_null(fonts);
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; ++i) {
        if (!letters_font(font) || !system_fonts_find(fonts, pairs[i].first).path) {
            printf("SKIPPED: no font for %s\n", pairs[i].script);
            continue;
        }
        write_fresh(font, pairs[i].one, 5, 5, 40, picture); /* not the box for what is missing */
        write_fresh(font, pairs[i].other, 5, 5, 40, other);
        assert_memory_not_equal(picture, other, BYTES);
        assert_true(letters_width(font, pairs[i].one, 40) > 4.0f);
    }
    system_fonts_destroy(fonts);
}

static void without_a_font_nothing_is_drawn(void **state)
{
    (void)state;
    error err = {{0}};
    static const char *const none[] = {"/nowhere/font.otf", "/dev/null", NULL};
    letters *empty = letters_create(none, &err);
    assert_non_null(empty);
    assert_null(letters_font(empty));
    assert_true(letters_width(empty, "words", 20) == 0.0f);
    write_fresh(empty, "words", 5, 5, 24, picture);
    assert_memory_equal(picture, page, BYTES);
    letters_destroy(empty);
}

int main(void)
{
    error err = {{0}};
    draw_context *context = draw_context_create(&err);
    if (!context) {
        printf("SKIPPED: %s\n", err.text);
        return 77;
    }
    font = letters_create(letters_fonts, &err);
    target = font ? draw_target_create(WIDTH, HEIGHT, &err) : NULL;
    if (!target) {
        printf("%s\n", err.text);
        return 1;
    }
    draw_read(target, page);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(widths_add_up_and_scale),
        cmocka_unit_test(ink_lies_within_the_measured_line),
        cmocka_unit_test(strokes_are_crisp),
        cmocka_unit_test(broken_utf8_is_drawn_as_something),
        cmocka_unit_test(letters_stay_right_when_the_atlas_overflows),
        cmocka_unit_test(letters_that_our_font_lacks_come_from_the_system),
        cmocka_unit_test(without_a_font_nothing_is_drawn),
    };
    int failed = cmocka_run_group_tests(tests, need_font, NULL);
    draw_target_destroy(target);
    letters_destroy(font);
    draw_context_destroy(context);
    return failed;
}
