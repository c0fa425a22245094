/* Names beside dots. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "window/viewport/viewport.h"

#include <stdlib.h>

static const ui_rectangle screen = {0, 0, 400, 300};
static const float dot = 5.0f;

static bool overlap(float ax, float ay, float aw, float ah, float bx, float by, float bw, float bh)
{
    return ax < bx + bw && bx < ax + aw && ay < by + bh && by < ay + ah;
}

static void check_all(const viewport_label *label, uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i) {
        const viewport_label *a = &label[i];
        if (!a->is_placed)
            continue;
        assert_true(a->at_x >= 0 && a->at_x + a->width <= screen.width);
        assert_true(a->at_y >= 0 && a->at_y + a->height <= screen.height);
        for (uint32_t k = 0; k < count; ++k) {
            const viewport_label *b = &label[k];
            assert_false(k != i && b->is_placed &&
                         overlap(a->at_x, a->at_y, a->width, a->height, b->at_x, b->at_y, b->width,
                                 b->height));
            assert_false(k != i && overlap(a->at_x, a->at_y, a->width, a->height, b->x - dot,
                                           b->y - dot, 2 * dot, 2 * dot));
        }
    }
}

static void a_lone_name_is_to_the_right_of_its_dot(void **state)
{
    (void)state;
    viewport_label label = {.x = 100, .y = 100, .width = 60, .height = 16};
    viewport_labels_place(&label, 1, screen, dot);
    assert_true(label.is_placed);
    assert_true(label.at_x > 105 && label.at_x < 120);
    assert_true(label.at_y < 100 && label.at_y + label.height > 100);
}

static void at_the_edge_it_is_to_the_left(void **state)
{
    (void)state;
    viewport_label label = {.x = 390, .y = 100, .width = 60, .height = 16};
    viewport_labels_place(&label, 1, screen, dot);
    assert_true(label.is_placed);
    assert_true(label.at_x + label.width < 390);
}

static void the_first_has_its_place_and_the_others_make_room(void **state)
{
    (void)state;
    viewport_label label[3];
    for (uint32_t i = 0; i < 3; ++i)
        label[i] = (viewport_label){.x = 200, .y = 150 + (float)i * 11, .width = 90, .height = 16};
    viewport_labels_place(label, 3, screen, dot);
    assert_true(label[0].is_placed);
    assert_true(label[0].at_x > 200);
    check_all(label, 3);
}

static void whatever_has_no_room_is_left_out(void **state)
{
    (void)state;
    viewport_label label[VIEWPORT_LABELS_MAX];
    srand(7);
    for (uint32_t i = 0; i < VIEWPORT_LABELS_MAX; ++i)
        label[i] = (viewport_label){.x = (float)(rand() % 440 - 20),
                                    .y = (float)(rand() % 340 - 20),
                                    .width = (float)(30 + rand() % 80),
                                    .height = 16};
    viewport_labels_place(label, VIEWPORT_LABELS_MAX, screen, dot);
    uint32_t placed = 0;
    for (uint32_t i = 0; i < VIEWPORT_LABELS_MAX; ++i)
        placed += label[i].is_placed;
    assert_in_range(placed, 3, VIEWPORT_LABELS_MAX - 50);
    check_all(label, VIEWPORT_LABELS_MAX);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_lone_name_is_to_the_right_of_its_dot),
        cmocka_unit_test(at_the_edge_it_is_to_the_left),
        cmocka_unit_test(the_first_has_its_place_and_the_others_make_room),
        cmocka_unit_test(whatever_has_no_room_is_left_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
