/* Several layers on one face: what stays of them when they go, anchor anew, commit, idle, knead,
 * and when all is taken up again. mm. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "unit/composer_scene.h"

/* ---- coming and going ---- */

static void who_goes_leaves_nothing_behind(void **state)
{
    (void)state;
    static const char *const faces[] = {"plane", "puppet"};
    for (int i = 0; i < 2; ++i) {
        desk d, alone;
        desk_set_up(&d, faces[i]);
        desk_set_up(&alone, faces[i]);
        const mrt_face *about = composer_about(d.composer);
        mrt_vec3 first = i == 0 ? desk_left_place : about->contacts[0].rest;
        mrt_vec3 second = i == 0 ? desk_right_place : about->contacts[1].rest;
        uint64_t at_rest = desk_shown(&d);
        mrt_pull *a = desk_add_part(&d, 0, 0), *b = desk_add_part(&d, 5, 1),
                 *own = desk_add_part(&alone, 5, 1);
        desk_hold_point(a, first, 6.0f);
        desk_hold_point(b, second, 3.0f);
        desk_hold_point(own, second, 3.0f);
        desk_move(&d);
        desk_move(&alone);
        uint64_t with_both = desk_shown(&d);
        desk_go(&d, 0); /* b stays */
        desk_move(&d);
        composer_draw(d.composer);
        composer_draw(alone.composer);
        assert_true(desk_shown(&d) != with_both);
        assert_true(scene_distance(face_shown(composer_face(d.composer)),
                                   face_shown(composer_face(alone.composer))) < 1e-4);
        d.count = 0;
        desk_move(&d);
        assert_true(i == 1 || desk_shown(&d) == at_rest);
        composer_draw(d.composer);
        assert_true(scene_distance(face_shown(composer_face(d.composer)),
                                   face_rest(composer_face(d.composer))) < 1e-4);
        desk_tear_down(&d);
        desk_tear_down(&alone);
    }
}

/* Its new starts are where it had pulled the face to; what the others pull is not baked. */
static void who_anchors_anew_bakes_only_its_own(void **state)
{
    (void)state;
    desk d;
    desk_set_up(&d, "plane");
    mrt_pull *a = desk_add_part(&d, 0, 0), *b = desk_add_part(&d, 1, 1);
    a->radius_mm = b->radius_mm = 30.0f;
    desk_hold_point(a, desk_left_place, 0.0f);
    desk_hold_point(b, desk_right_place, 0.0f);
    desk_move(&d);
    desk_push(a, 0, 5.0f);
    desk_push(b, 0, 3.0f);
    desk_move(&d);
    desk_expect_height(&d, desk_left_place, 5, desk_near_mm);
    desk_expect_height(&d, desk_right_place, 3, desk_near_mm);
    uint64_t before = composer_counted(d.composer)->engagements;
    a->anchor += 1;
    a->vector[0].start = a->vector[0].end;
    desk_move(&d);
    assert_int_equal(composer_counted(d.composer)->engagements, before + 1);
    desk_expect_height(&d, desk_left_place, 5, desk_near_mm); /* nothing jumps */
    desk_expect_height(&d, desk_right_place, 3, desk_near_mm);
    desk_push(a, 0, 1.0f);
    desk_push(b, 0, 2.0f);
    desk_move(&d);
    desk_expect_height(&d, desk_left_place, 6, desk_near_mm);
    desk_expect_height(&d, desk_right_place, 2, desk_near_mm);
    d.count = 0;
    desk_move(&d);
    desk_expect_height(&d, desk_left_place, 5, desk_near_mm);
    desk_expect_height(&d, desk_right_place, 0, desk_near_mm);
    desk_tear_down(&d);
}

static void who_commits_bakes_only_its_own(void **state)
{
    (void)state;
    desk d;
    desk_set_up(&d, "plane");
    mrt_pull *a = desk_add_part(&d, 0, 0), *b = desk_add_part(&d, 1, 1);
    a->radius_mm = b->radius_mm = 30.0f;
    desk_hold_point(a, desk_left_place, 5.0f);
    desk_hold_point(b, desk_right_place, 3.0f);
    desk_move(&d);
    a->commit += 1;
    a->anchor += 1;
    a->vector[0].start = a->vector[0].end;
    desk_move(&d);
    assert_int_equal(composer_counted(d.composer)->commits, 1);
    desk_expect_height(&d, desk_left_place, 5, desk_near_mm);
    desk_expect_height(&d, desk_right_place, 3, desk_near_mm);
    d.count = 0;
    desk_move(&d);
    desk_expect_height(&d, desk_left_place, 5, desk_near_mm);
    desk_expect_height(&d, desk_right_place, 0, desk_near_mm);
    desk_tear_down(&d);
}

/* It has nothing more to say: what is in the base is not pulled once more when another moves. */
static void who_commits_and_idles_is_not_pulled_twice(void **state)
{
    (void)state;
    desk d;
    desk_set_up(&d, "plane");
    mrt_pull *a = desk_add_part(&d, 0, 0), *b = desk_add_part(&d, 1, 1);
    a->radius_mm = b->radius_mm = 30.0f;
    desk_hold_point(a, desk_left_place, 5.0f);
    desk_hold_point(b, desk_right_place, 3.0f);
    desk_move(&d);
    a->mode = MRT_IDLE;
    b->mode = MRT_IDLE;
    a->commit += 1;
    desk_move(&d);
    desk_expect_height(&d, desk_left_place, 5, desk_near_mm);
    desk_expect_height(&d, desk_right_place, 3, desk_near_mm); /* who only idles goes on holding */
    b->mode = MRT_ANCHORED;
    desk_push(b, 0, 2.0f);
    desk_move(&d);
    desk_expect_height(&d, desk_left_place, 5, desk_near_mm);
    desk_expect_height(&d, desk_right_place, 2, desk_near_mm);
    desk_tear_down(&d);
}

static void idle_holds_what_was_pulled(void **state)
{
    (void)state;
    desk d;
    desk_set_up(&d, "plane");
    mrt_pull *a = desk_add_part(&d, 0, 0), *b = desk_add_part(&d, 1, 1);
    desk_hold_point(a, desk_left_place, 5.0f);
    desk_hold_point(b, desk_right_place, 3.0f);
    desk_move(&d);
    uint64_t held = desk_shown(&d);
    a->mode = MRT_IDLE;
    a->count = 0;
    for (int n = 0; n < 5; ++n)
        desk_move(&d);
    assert_true(desk_shown(&d) == held);
    d.part[0].weight = 0.5; /* but it fades */
    desk_move(&d);
    assert_true(desk_height_at(&d, desk_left_place) < 4.0);
    desk_tear_down(&d);
}

/* ---- kneading ---- */

static void knead_to(mrt_pull *pull, float z)
{
    pull->vector[0].start = pull->vector[0].end;
    pull->vector[0].end.z = desk_left_place.z + z;
}

static void a_kneaded_face_carries_what_anchored_layers_add(void **state)
{
    (void)state;
    desk d, alone;
    desk_set_up(&d, "plane");
    desk_set_up(&alone, "plane");
    mrt_pull *clay = desk_add_part(&d, 0, 0), *over = desk_add_part(&d, 1, 1);
    mrt_pull *only = desk_add_part(&alone, 0, 0);
    clay->mode = only->mode = MRT_UNANCHORED;
    clay->radius_mm = only->radius_mm = over->radius_mm = 30.0f;
    desk_hold_point(clay, desk_left_place, 0.0f);
    desk_hold_point(only, desk_left_place, 0.0f);
    desk_hold_point(over, desk_right_place, 3.0f);
    for (int n = 0; n < 40; ++n) {
        float z = 0.15f * (float)n;
        knead_to(clay, z);
        knead_to(only, z);
        d.part[0].is_fresh = alone.part[0].is_fresh = true;
        desk_move(&d);
        desk_move(&alone);
        d.part[0].is_fresh = false;
        desk_push(over, 0, 3.0f + 0.02f * (float)n);
        desk_move(&d); /* a sample of the other alone */
        desk_expect_height(&d, desk_left_place, desk_height_at(&alone, desk_left_place),
                           desk_near_mm);
        desk_expect_height(&d, desk_right_place, 3.0 + 0.02 * n, desk_near_mm);
    }
    assert_true(desk_height_at(&alone, desk_left_place) > 4.0);
    desk_go(&d, 1); /* the one above goes: what was kneaded is left */
    desk_move(&d);
    composer_draw(d.composer);
    composer_draw(alone.composer);
    assert_true(scene_distance(face_shown(composer_face(d.composer)),
                               face_shown(composer_face(alone.composer))) < 0.01);
    desk_tear_down(&d);
    desk_tear_down(&alone);
}

/* A sample of another layer is none of the kneading one's. */
static void a_pull_that_was_heard_before_does_not_knead_again(void **state)
{
    (void)state;
    desk d;
    desk_set_up(&d, "plane");
    mrt_pull *clay = desk_add_part(&d, 0, 0);
    clay->mode = MRT_UNANCHORED;
    clay->radius_mm = 30.0f;
    desk_hold_point(clay, desk_left_place, 0.0f);
    desk_move(&d);
    knead_to(clay, 2.0f);
    desk_move(&d);
    uint64_t once = desk_shown(&d);
    d.part[0].is_fresh = false;
    for (int n = 0; n < 5; ++n)
        desk_move(&d);
    assert_true(desk_shown(&d) == once);
    desk_tear_down(&d);
}

/* ---- kept ---- */

static void tell(desk *d, uint32_t n)
{
    d->pull[0].vector[0].end.z += 0.1f;
    d->pull[1].vector[0].end.y += 0.07f;
    d->pull[2].vector[0].start = d->pull[2].vector[0].end;
    d->pull[2].vector[0].end.z += 0.2f;
    d->pull[0].anchor += n % 11 == 4;
    d->pull[1].commit += n % 13 == 6;
    d->pull[1].mode = n % 9 > 6 ? MRT_IDLE : MRT_ANCHORED;
    d->part[1].weight = n % 8 < 4 ? 1.0 : 0.7;
    d->part[2].is_fresh = n % 3 == 0;
    d->count = n % 10 == 7 ? 2 : 3;
    desk_move(d);
}

static void layers_that_are_taken_up_go_on_with_the_same_bits(void **state)
{
    (void)state;
    enum { STEPS = 40 };
    for (uint32_t from = 0; from < STEPS; from += 3) {
        desk told, again;
        error err = {""};
        desk_set_up(&told, "moai");
        desk_set_up(&again, "moai");
        mrt_pull *low = desk_add_part(&told, 0, 0), *high = desk_add_part(&told, 1, 1),
                 *clay = desk_add_part(&told, 2, 2);
        desk_hold_mouth(&told, low, 0.5f);
        desk_hold_brows(&told, high, 0.5f);
        clay->mode = MRT_UNANCHORED;
        clay->radius_mm = 25.0f;
        clay->leak_per_s = 0.2f;
        desk_hold_point(clay, composer_about(told.composer)->contacts[3].rest, 0.0f);
        for (uint32_t n = 0; n <= from; ++n)
            tell(&told, n);
        size_t size = composer_save(told.composer, NULL, 0);
        unsigned char *bytes = malloc(size);
        assert_int_equal(composer_save(told.composer, bytes, size), size);
        scene_must(composer_load(again.composer, bytes, size, &err), &err);
        memcpy(again.pull, told.pull, sizeof again.pull);
        memcpy(again.part, told.part, sizeof again.part);
        again.count = told.count;
        for (uint32_t i = 0; i < 3; ++i)
            again.part[i].pull = &again.pull[i];
        for (uint32_t n = from + 1; n < STEPS; ++n) {
            tell(&told, n);
            tell(&again, n);
            if (desk_shown(&told) != desk_shown(&again))
                fail_msg("taken up after step %u: step %u differs", from, n);
        }
        free(bytes);
        desk_tear_down(&told);
        desk_tear_down(&again);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(who_goes_leaves_nothing_behind),
        cmocka_unit_test(who_anchors_anew_bakes_only_its_own),
        cmocka_unit_test(who_commits_bakes_only_its_own),
        cmocka_unit_test(who_commits_and_idles_is_not_pulled_twice),
        cmocka_unit_test(idle_holds_what_was_pulled),
        cmocka_unit_test(a_kneaded_face_carries_what_anchored_layers_add),
        cmocka_unit_test(a_pull_that_was_heard_before_does_not_knead_again),
        cmocka_unit_test(layers_that_are_taken_up_go_on_with_the_same_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
