/* The whole window: what is on it, what keys and clicks do, what stays readable. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "window/scene.h"

static void the_first_face_is_drawn_with_all_around_it(void **state)
{
    scene s;
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    scene_frames(&s, 20);
    scene_picture(&s, "desk");
    assert_non_null(scene_word(&s, "Live"));
    assert_non_null(scene_word(&s, "night"));
    assert_non_null(scene_word(&s, "puppet"));
    scene_check_words(&s);
    scene_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_first_face_is_drawn_with_all_around_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
