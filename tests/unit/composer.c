/* The pulls of several layers on one face: who owns what, who lies over whom, and what it costs.
 * mm.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "unit/allocation_count.h"
#include "unit/composer_scene.h"

/* ---- owning ---- */

static void layers_that_own_different_contacts_give_what_one_pull_gives(void **state)
{
    (void)state;
    fixture one, two;
    fixture_set_up(&one, "puppet");
    fixture_set_up(&two, "puppet");
    mrt_pull *all = fixture_add_part(&one, 0, 0);
    mrt_pull *low = fixture_add_part(&two, 3, 0), *high = fixture_add_part(&two, 1, 1);
    uint64_t before = 0;
    for (int n = 0; n < 20; ++n) {
        float amount = 0.15f * (float)n;
        all->count = low->count = high->count = 0;
        fixture_hold_mouth(&one, all, amount);
        fixture_hold_brows(&one, all, 2.0f - amount);
        fixture_hold_mouth(&two, low, amount);
        fixture_hold_brows(&two, high, 2.0f - amount);
        all->dof[0] = low->dof[0] = 0.01f * (float)n;
        fixture_move(&one);
        fixture_move(&two);
        uint64_t now = fixture_shown(&one);
        assert_true(now == fixture_shown(&two));
        assert_true(now != before);
        before = now;
    }
    fixture_tear_down(&one);
    fixture_tear_down(&two);
}

/* What a layer does not own it does not move, whatever its pull says. */
static void a_layer_moves_only_what_it_owns(void **state)
{
    (void)state;
    fixture all, some;
    fixture_set_up(&all, "puppet");
    fixture_set_up(&some, "puppet");
    const mrt_face *about = composer_about(some.composer);
    uint8_t owns[256] = {0};
    assert_true(about->contact_count + about->dof_count < sizeof owns);
    for (int i = 0; i < 4; ++i)
        owns[fixture_contact_named(&some, fixture_brows[i]) - 1] = 1;
    mrt_pull *only_brows = fixture_add_part(&all, 0, 0),
             *everything = fixture_add_part(&some, 0, 0);
    fixture_hold_brows(&all, only_brows, 1.5f);
    fixture_hold_brows(&some, everything, 1.5f);
    fixture_hold_mouth(&some, everything, 2.0f);
    fixture_hold_point(everything,
                       about->contacts[fixture_contact_named(&some, "nose.tip") - 1].rest, 3.0f);
    everything->dof[0] = 0.3f;
    some.part[0].owns = owns;
    fixture_move(&all);
    fixture_move(&some);
    assert_true(fixture_shown(&all) == fixture_shown(&some));
    fixture_tear_down(&all);
    fixture_tear_down(&some);
}

/* Hands at the back of a head, or on a hat, must not perform without any effect. */
static void points_on_rigid_skin_grip_the_nearest_skin_that_moves(void **state)
{
    (void)state;
    const mrt_vec3 back = {0.0f, 60.0f, -98.0f};
    fixture alone, beside, without;
    fixture_set_up(&alone, "puppet");
    fixture_set_up(&beside, "puppet");
    fixture_set_up(&without, "puppet");
    const uint64_t rest = fixture_shown(&alone);
    fixture_hold_point(fixture_add_part(&alone, 0, 0), back, 3.0f);
    fixture_move(&alone);
    assert_true(fixture_shown(&alone) != rest);
    /* A point beside others that touch such skin has no effect. */
    const mrt_vec3 nose = composer_about(beside.composer)
                              ->contacts[fixture_contact_named(&beside, "nose.tip") - 1]
                              .rest;
    mrt_pull *both = fixture_add_part(&beside, 0, 0), *one = fixture_add_part(&without, 0, 0);
    fixture_hold_point(both, nose, 2.0f);
    fixture_hold_point(both, back, 3.0f);
    fixture_hold_point(one, nose, 2.0f);
    fixture_move(&beside);
    fixture_move(&without);
    assert_true(fixture_shown(&beside) == fixture_shown(&without));
    fixture_tear_down(&alone);
    fixture_tear_down(&beside);
    fixture_tear_down(&without);
}

/* ---- over each other ---- */

static void a_later_layer_replaces_an_additive_one_adds(void **state)
{
    (void)state;
    fixture d;
    fixture_set_up(&d, "puppet");
    mrt_pull *below = fixture_add_part(&d, 0, 0), *above = fixture_add_part(&d, 1, 1);
    fixture_hold_contact(&d, below, "brow.mid.l", 0, 2, 1);
    fixture_hold_contact(&d, below, "brow.mid.r", 0, 2, 1);
    fixture_hold_contact(&d, above, "brow.mid.l", 1, -3, 2);
    below->dof[0] = above->dof[0] = 0.0f;
    fixture_move(&d);
    fixture_expect_way(&d, "brow.mid.l", 1, -3, 2, fixture_near_mm);
    fixture_expect_way(&d, "brow.mid.r", 0, 2, 1, fixture_near_mm);
    d.part[1].is_additive = true;
    fixture_move(&d);
    fixture_expect_way(&d, "brow.mid.l", 1, -1, 3, fixture_near_mm);
    fixture_expect_way(&d, "brow.mid.r", 0, 2, 1, fixture_near_mm);
    fixture_tear_down(&d);
}

static void weights_blend_linearly_and_gains_multiply(void **state)
{
    (void)state;
    fixture d;
    fixture_set_up(&d, "puppet");
    mrt_pull *below = fixture_add_part(&d, 0, 0), *above = fixture_add_part(&d, 1, 1);
    fixture_hold_contact(&d, below, "brow.mid.l", 0, 2, 1);
    fixture_hold_contact(&d, above, "brow.mid.l", 1, -2, 2);
    for (int n = 0; n <= 10; ++n) {
        double w = 0.1 * n;
        d.part[1].weight = w;
        fixture_move(&d);
        fixture_expect_way(&d, "brow.mid.l", w, 2 - 4 * w, 1 + w, fixture_near_mm);
    }
    d.part[1].weight = 0.25;
    d.part[1].gain = 2.0; /* of what it adds, not of what it takes away */
    fixture_move(&d);
    fixture_expect_way(&d, "brow.mid.l", 0.5, 0.75 * 2 - 1, 0.75 + 1, fixture_near_mm);
    d.part[0].weight = 0.5; /* towards the rest */
    d.part[1].weight = 0.0;
    fixture_move(&d);
    fixture_expect_way(&d, "brow.mid.l", 0, 1, 0.5, fixture_near_mm);
    d.part[0].weight = 1.0;
    d.part[0].gain = 1.5;
    fixture_move(&d);
    fixture_expect_way(&d, "brow.mid.l", 0, 3, 1.5, fixture_near_mm);
    fixture_tear_down(&d);
}

/* Two clips of one layer cross-fade: their weights sum to 1. */
static void parts_of_one_layer_share_it(void **state)
{
    (void)state;
    fixture d;
    fixture_set_up(&d, "puppet");
    mrt_pull *below = fixture_add_part(&d, 2, 0), *out = fixture_add_part(&d, 0, 1),
             *in = fixture_add_part(&d, 1, 1);
    fixture_hold_contact(&d, below, "brow.mid.l", 0, 0, 4);
    fixture_hold_contact(&d, out, "brow.mid.l", 0, 2, 0);
    fixture_hold_contact(&d, in, "brow.mid.l", 0, -2, 1);
    for (int n = 0; n <= 4; ++n) {
        d.part[1].weight = 1.0 - 0.25 * n;
        d.part[2].weight = 0.25 * n;
        fixture_move(&d);
        fixture_expect_way(&d, "brow.mid.l", 0, 2 - n, 0.25 * n,
                           fixture_near_mm); /* nothing from below */
    }
    fixture_tear_down(&d);
}

static void degrees_of_freedom_are_laid_over_each_other_too(void **state)
{
    (void)state;
    fixture d;
    fixture_set_up(&d, "puppet");
    const mrt_face *about = composer_about(d.composer);
    uint32_t open = 0;
    while (open < about->dof_count && strcmp(about->dofs[open].name, "jaw.open") != 0)
        open += 1;
    assert_true(open < about->dof_count);
    mrt_pull *below = fixture_add_part(&d, 0, 0), *above = fixture_add_part(&d, 1, 1);
    fixture_hold_contact(&d, below, "brow.mid.l", 0, 0, 0);
    fixture_hold_contact(&d, above, "brow.mid.r", 0, 0, 0);
    below->dof[open] = 0.2f;
    fixture_move(&d);
    const float *dof = face_metered(composer_face(d.composer))->dof;
    assert_true(fabs((double)dof[open] - 0.2) < 1e-3); /* the one above says nothing */
    above->dof[open] = 0.1f;
    fixture_move(&d);
    assert_true(fabs((double)dof[open] - 0.1) < 1e-3);
    d.part[1].weight = 0.5;
    fixture_move(&d);
    assert_true(fabs((double)dof[open] - 0.15) < 1e-3);
    d.part[1].is_additive = true;
    d.part[1].weight = 1.0;
    above->dof[open] = 0.05f;
    fixture_move(&d);
    assert_true(fabs((double)dof[open] - 0.25) < 1e-3);
    fixture_tear_down(&d);
}

/* ---- limits ---- */

static void vectors_beyond_the_limit_are_counted(void **state)
{
    (void)state;
    fixture d;
    fixture_set_up(&d, "plane");
    mrt_pull *pulls[2] = {fixture_add_part(&d, 0, 0), fixture_add_part(&d, 1, 1)};
    for (int p = 0; p < 2; ++p)
        for (int i = 0; i < 40; ++i)
            fixture_hold_point(
                pulls[p], (mrt_vec3){-70.0f + 3.5f * (float)i, 30.0f + 100.0f * (float)p, 55.0f},
                1.0f);
    fixture_move(&d);
    assert_int_equal(composer_get_counts(d.composer)->left_out, 16);
    (void)fixture_shown(&d); /* none is held */
    fixture_go(&d, 0);
    fixture_move(&d);
    assert_int_equal(composer_get_counts(d.composer)->left_out, 16);
    fixture_tear_down(&d);
}

/* ---- what mappings are given ---- */

/* Whether it moves anything: viseme_sil does not. */
static bool check_mapped_pose(const composer *c, uint32_t at)
{
    static const uint32_t parts[] = {[POSE_WHOLE] = MRT_POSE_WHOLE,
                                     [POSE_MOUTH] = MRT_POSE_MOUTH,
                                     [POSE_UPPER] = MRT_POSE_UPPER};
    const mapped_face *mapped = composer_mapped(c);
    const rig_pose *ought = &composer_rig(c)->pose[at];
    const mrt_rig_pose *pose = &mapped->pose[at];
    uint32_t moved = 0, driven = 0;
    assert_string_equal(pose->name, ought->name);
    assert_int_equal(pose->part, parts[ought->part]);
    for (uint32_t k = 0; k < ought->pull_count + ought->follow_count; ++k) {
        const mrt_vec3 pull = pose->pulls[ought->pull_contact[k]];
        assert_float_equal(pull.x, ought->pull_mm[k].x, 1e-5);
        assert_float_equal(pull.y, ought->pull_mm[k].y, 1e-5);
        assert_float_equal(pull.z, ought->pull_mm[k].z, 1e-5);
    }
    for (uint32_t i = 0; i < mapped->about.contact_count; ++i) {
        const mrt_vec3 p = pose->pulls[i];
        moved += fabsf(p.x) + fabsf(p.y) + fabsf(p.z) > 0.0f;
    }
    assert_true(moved <= ought->pull_count + ought->follow_count); /* the others are at rest */
    for (uint32_t d = 0; d < mapped->about.dof_count; ++d) {
        double value = 0.0;
        for (uint32_t k = 0; k < ought->dof_count; ++k)
            if (strcmp(ought->dof_name[k], mapped->about.dofs[d].name) == 0)
                value = ought->dof_value[k];
        assert_float_equal(pose->dofs[d], value, 1e-6);
        driven += fabs(value) > 0.0;
    }
    return moved + driven > 0;
}

static void mappings_are_given_every_pose_of_the_rig(void **state)
{
    (void)state;
    static const char *const faces[] = {"puppet", "moai"};
    for (size_t i = 0; i < sizeof faces / sizeof *faces; ++i) {
        fixture d;
        uint32_t moving = 0;
        fixture_set_up(&d, faces[i]);
        const mapped_face *mapped = composer_mapped(d.composer);
        assert_ptr_equal(&mapped->about, composer_about(d.composer));
        assert_int_equal(mapped->pose_count, composer_rig(d.composer)->pose_count);
        for (uint32_t p = 0; p < mapped->pose_count; ++p)
            moving += check_mapped_pose(d.composer, p);
        assert_true(moving > 10);
        fixture_tear_down(&d);
    }
    fixture bare;
    fixture_set_up(&bare, "plane");
    assert_int_equal(composer_mapped(bare.composer)->pose_count, 0);
    fixture_tear_down(&bare);
}

static void nothing_allocates_while_layers_come_and_go(void **state)
{
    (void)state;
    if (!ALLOCATIONS_ARE_COUNTED) {
        print_message("SKIPPED: the sanitizer has an allocator of its own\n");
        skip();
    }
    fixture d;
    fixture_set_up(&d, "puppet");
    mrt_pull *low = fixture_add_part(&d, 0, 0), *high = fixture_add_part(&d, 1, 1),
             *clay = fixture_add_part(&d, 2, 2);
    unsigned char *bytes = malloc(4 << 20);
    assert_non_null(bytes);
    fixture_hold_mouth(&d, low, 1.0f);
    fixture_hold_brows(&d, high, 1.0f);
    clay->mode = MRT_UNANCHORED;
    clay->radius_mm = 20.0f;
    fixture_hold_point(clay, composer_about(d.composer)->contacts[0].rest, 0.0f);
    uint64_t before = atomic_load(&allocation_count);
    for (uint32_t n = 0; n < 60; ++n) {
        low->vector[0].end.y += 0.05f;
        clay->vector[0].start = clay->vector[0].end;
        clay->vector[0].end.z += 0.05f;
        low->anchor += n % 20 == 5;
        high->commit += n % 20 == 9;
        d.part[1].weight = n % 10 == 3 ? 0.5 : 1.0;
        d.count = n % 7 == 0 ? 1 : n % 3 == 0 ? 2 : 3;
        fixture_move(&d);
        composer_draw(d.composer);
        assert_true(composer_save(d.composer, bytes, 4 << 20) < 4 << 20);
    }
    assert_int_equal(atomic_load(&allocation_count) - before, 0);
    free(bytes);
    fixture_tear_down(&d);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(layers_that_own_different_contacts_give_what_one_pull_gives),
        cmocka_unit_test(a_layer_moves_only_what_it_owns),
        cmocka_unit_test(points_on_rigid_skin_grip_the_nearest_skin_that_moves),
        cmocka_unit_test(a_later_layer_replaces_an_additive_one_adds),
        cmocka_unit_test(weights_blend_linearly_and_gains_multiply),
        cmocka_unit_test(parts_of_one_layer_share_it),
        cmocka_unit_test(degrees_of_freedom_are_laid_over_each_other_too),
        cmocka_unit_test(vectors_beyond_the_limit_are_counted),
        cmocka_unit_test(mappings_are_given_every_pose_of_the_rig),
        cmocka_unit_test(nothing_allocates_while_layers_come_and_go),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
