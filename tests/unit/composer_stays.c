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
        fixture d, alone;
        fixture_set_up(&d, faces[i]);
        fixture_set_up(&alone, faces[i]);
        const mrt_face *about = composer_about(d.composer);
        mrt_vec3 first = i == 0 ? fixture_left_position : about->contacts[0].rest;
        mrt_vec3 second = i == 0 ? fixture_right_position : about->contacts[1].rest;
        uint64_t at_rest = fixture_shown(&d);
        mrt_pull *a = fixture_add_part(&d, 0, 0), *b = fixture_add_part(&d, 5, 1),
                 *own = fixture_add_part(&alone, 5, 1);
        fixture_hold_point(a, first, 6.0f);
        fixture_hold_point(b, second, 3.0f);
        fixture_hold_point(own, second, 3.0f);
        fixture_move(&d);
        fixture_move(&alone);
        uint64_t with_both = fixture_shown(&d);
        fixture_go(&d, 0); /* b stays */
        fixture_move(&d);
        composer_draw(d.composer);
        composer_draw(alone.composer);
        assert_true(fixture_shown(&d) != with_both);
        assert_true(scene_distance(face_shown(composer_face(d.composer)),
                                   face_shown(composer_face(alone.composer))) < 1e-4);
        d.count = 0;
        fixture_move(&d);
        assert_true(i == 1 || fixture_shown(&d) == at_rest);
        composer_draw(d.composer);
        assert_true(scene_distance(face_shown(composer_face(d.composer)),
                                   face_rest(composer_face(d.composer))) < 1e-4);
        fixture_tear_down(&d);
        fixture_tear_down(&alone);
    }
}

/* Its new starts are where it had pulled the face to; what the others pull is not baked. */
static void who_anchors_anew_bakes_only_its_own(void **state)
{
    (void)state;
    fixture d;
    fixture_set_up(&d, "plane");
    mrt_pull *a = fixture_add_part(&d, 0, 0), *b = fixture_add_part(&d, 1, 1);
    a->radius_mm = b->radius_mm = 30.0f;
    fixture_hold_point(a, fixture_left_position, 0.0f);
    fixture_hold_point(b, fixture_right_position, 0.0f);
    fixture_move(&d);
    fixture_push(a, 0, 5.0f);
    fixture_push(b, 0, 3.0f);
    fixture_move(&d);
    fixture_expect_height(&d, fixture_left_position, 5, fixture_near_mm);
    fixture_expect_height(&d, fixture_right_position, 3, fixture_near_mm);
    uint64_t before = composer_get_counts(d.composer)->engagements;
    a->anchor += 1;
    a->vector[0].start = a->vector[0].end;
    fixture_move(&d);
    assert_int_equal(composer_get_counts(d.composer)->engagements, before + 1);
    fixture_expect_height(&d, fixture_left_position, 5, fixture_near_mm); /* nothing jumps */
    fixture_expect_height(&d, fixture_right_position, 3, fixture_near_mm);
    fixture_push(a, 0, 1.0f);
    fixture_push(b, 0, 2.0f);
    fixture_move(&d);
    fixture_expect_height(&d, fixture_left_position, 6, fixture_near_mm);
    fixture_expect_height(&d, fixture_right_position, 2, fixture_near_mm);
    d.count = 0;
    fixture_move(&d);
    fixture_expect_height(&d, fixture_left_position, 5, fixture_near_mm);
    fixture_expect_height(&d, fixture_right_position, 0, fixture_near_mm);
    fixture_tear_down(&d);
}

static void who_commits_bakes_only_its_own(void **state)
{
    (void)state;
    fixture d;
    fixture_set_up(&d, "plane");
    mrt_pull *a = fixture_add_part(&d, 0, 0), *b = fixture_add_part(&d, 1, 1);
    a->radius_mm = b->radius_mm = 30.0f;
    fixture_hold_point(a, fixture_left_position, 5.0f);
    fixture_hold_point(b, fixture_right_position, 3.0f);
    fixture_move(&d);
    a->commit += 1;
    a->anchor += 1;
    a->vector[0].start = a->vector[0].end;
    fixture_move(&d);
    assert_int_equal(composer_get_counts(d.composer)->commits, 1);
    fixture_expect_height(&d, fixture_left_position, 5, fixture_near_mm);
    fixture_expect_height(&d, fixture_right_position, 3, fixture_near_mm);
    d.count = 0;
    fixture_move(&d);
    fixture_expect_height(&d, fixture_left_position, 5, fixture_near_mm);
    fixture_expect_height(&d, fixture_right_position, 0, fixture_near_mm);
    fixture_tear_down(&d);
}

/* It has nothing more to say: what is in the base is not pulled once more when another moves. */
static void who_commits_and_idles_is_not_pulled_twice(void **state)
{
    (void)state;
    fixture d;
    fixture_set_up(&d, "plane");
    mrt_pull *a = fixture_add_part(&d, 0, 0), *b = fixture_add_part(&d, 1, 1);
    a->radius_mm = b->radius_mm = 30.0f;
    fixture_hold_point(a, fixture_left_position, 5.0f);
    fixture_hold_point(b, fixture_right_position, 3.0f);
    fixture_move(&d);
    a->mode = MRT_IDLE;
    b->mode = MRT_IDLE;
    a->commit += 1;
    fixture_move(&d);
    fixture_expect_height(&d, fixture_left_position, 5, fixture_near_mm);
    fixture_expect_height(&d, fixture_right_position, 3,
                          fixture_near_mm); /* who only idles goes on holding */
    b->mode = MRT_ANCHORED;
    fixture_push(b, 0, 2.0f);
    fixture_move(&d);
    fixture_expect_height(&d, fixture_left_position, 5, fixture_near_mm);
    fixture_expect_height(&d, fixture_right_position, 2, fixture_near_mm);
    fixture_tear_down(&d);
}

static void idle_holds_what_was_pulled(void **state)
{
    (void)state;
    fixture d;
    fixture_set_up(&d, "plane");
    mrt_pull *a = fixture_add_part(&d, 0, 0), *b = fixture_add_part(&d, 1, 1);
    fixture_hold_point(a, fixture_left_position, 5.0f);
    fixture_hold_point(b, fixture_right_position, 3.0f);
    fixture_move(&d);
    uint64_t held = fixture_shown(&d);
    a->mode = MRT_IDLE;
    a->count = 0;
    for (int n = 0; n < 5; ++n)
        fixture_move(&d);
    assert_true(fixture_shown(&d) == held);
    d.part[0].weight = 0.5; /* but it fades */
    fixture_move(&d);
    assert_true(fixture_height_at(&d, fixture_left_position) < 4.0);
    fixture_tear_down(&d);
}

/* ---- kneading ---- */

static void knead_to(mrt_pull *pull, float z)
{
    pull->vector[0].start = pull->vector[0].end;
    pull->vector[0].end.z = fixture_left_position.z + z;
}

static void a_kneaded_face_carries_what_anchored_layers_add(void **state)
{
    (void)state;
    fixture d, alone;
    fixture_set_up(&d, "plane");
    fixture_set_up(&alone, "plane");
    mrt_pull *clay = fixture_add_part(&d, 0, 0), *over = fixture_add_part(&d, 1, 1);
    mrt_pull *only = fixture_add_part(&alone, 0, 0);
    clay->mode = only->mode = MRT_UNANCHORED;
    clay->radius_mm = only->radius_mm = over->radius_mm = 30.0f;
    fixture_hold_point(clay, fixture_left_position, 0.0f);
    fixture_hold_point(only, fixture_left_position, 0.0f);
    fixture_hold_point(over, fixture_right_position, 3.0f);
    for (int n = 0; n < 40; ++n) {
        float z = 0.15f * (float)n;
        knead_to(clay, z);
        knead_to(only, z);
        d.part[0].is_fresh = alone.part[0].is_fresh = true;
        fixture_move(&d);
        fixture_move(&alone);
        d.part[0].is_fresh = false;
        fixture_push(over, 0, 3.0f + 0.02f * (float)n);
        fixture_move(&d); /* a sample of the other alone */
        fixture_expect_height(&d, fixture_left_position,
                              fixture_height_at(&alone, fixture_left_position), fixture_near_mm);
        fixture_expect_height(&d, fixture_right_position, 3.0 + 0.02 * n, fixture_near_mm);
    }
    assert_true(fixture_height_at(&alone, fixture_left_position) > 4.0);
    fixture_go(&d, 1); /* the one above goes: what was kneaded is left */
    fixture_move(&d);
    composer_draw(d.composer);
    composer_draw(alone.composer);
    assert_true(scene_distance(face_shown(composer_face(d.composer)),
                               face_shown(composer_face(alone.composer))) < 0.01);
    fixture_tear_down(&d);
    fixture_tear_down(&alone);
}

/* A sample of another layer is none of the kneading one's. */
static void a_pull_that_was_heard_before_does_not_knead_again(void **state)
{
    (void)state;
    fixture d;
    fixture_set_up(&d, "plane");
    mrt_pull *clay = fixture_add_part(&d, 0, 0);
    clay->mode = MRT_UNANCHORED;
    clay->radius_mm = 30.0f;
    fixture_hold_point(clay, fixture_left_position, 0.0f);
    fixture_move(&d);
    knead_to(clay, 2.0f);
    fixture_move(&d);
    uint64_t once = fixture_shown(&d);
    d.part[0].is_fresh = false;
    for (int n = 0; n < 5; ++n)
        fixture_move(&d);
    assert_true(fixture_shown(&d) == once);
    fixture_tear_down(&d);
}

/* ---- kept ---- */

static void tell(fixture *d, uint32_t n)
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
    fixture_move(d);
}

static void layers_that_are_taken_up_go_on_with_the_same_bits(void **state)
{
    (void)state;
    enum { STEPS = 40 };
    for (uint32_t from = 0; from < STEPS; from += 3) {
        fixture told, again;
        error err = {""};
        fixture_set_up(&told, "moai");
        fixture_set_up(&again, "moai");
        mrt_pull *low = fixture_add_part(&told, 0, 0), *high = fixture_add_part(&told, 1, 1),
                 *clay = fixture_add_part(&told, 2, 2);
        fixture_hold_mouth(&told, low, 0.5f);
        fixture_hold_brows(&told, high, 0.5f);
        clay->mode = MRT_UNANCHORED;
        clay->radius_mm = 25.0f;
        clay->leak_per_s = 0.2f;
        fixture_hold_point(clay, composer_about(told.composer)->contacts[3].rest, 0.0f);
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
            if (fixture_shown(&told) != fixture_shown(&again))
                fail_msg("taken up after step %u: step %u differs", from, n);
        }
        free(bytes);
        fixture_tear_down(&told);
        fixture_tear_down(&again);
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
