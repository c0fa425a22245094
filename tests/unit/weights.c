/* Weights of bones over a surface, from the marks of a rig. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "unit/face_sheet.h"

#include <math.h>

#define SHEET_RIG "{" SHEET_BONES ", \"regions\": [" SHEET_REGIONS "]}"

static void weights_are_shares_that_sum_to_one(void **state)
{
    (void)state;
    sheet s;
    sheet_create(&s, SHEET_RIG);
    for (uint32_t v = 0; v < SHEET_COUNT; v++) {
        float skull = sheet_weight(&s, 0, v), jaw = sheet_weight(&s, 1, v);
        assert_true(skull >= 0 && skull <= 1 && jaw >= 0 && jaw <= 1);
        assert_true(fabsf(skull + jaw - 1) <= 1e-6f);
        assert_true(s.binding.mobility[v] >= 0 && s.binding.mobility[v] <= 1);
    }
    sheet_destroy(&s);
}

static void marks_are_kept_to_the_bit(void **state)
{
    (void)state;
    sheet s;
    sheet_create(&s, SHEET_RIG);
    for (int column = -10; column <= 10; column++) {
        assert_true(sheet_weight(&s, 0, sheet_at(column, 10)) == 1);
        assert_true(s.binding.mobility[sheet_at(column, 10)] == 0);
        assert_true(sheet_weight(&s, 1, sheet_at(column, -10)) == 1);
        assert_true(s.binding.mobility[sheet_at(column, -10)] == 1);
    }
    for (int column = -2; column <= 2; column++) {
        assert_true(sheet_weight(&s, 1, sheet_at(column, 0)) == 0);
        assert_true(sheet_weight(&s, 1, sheet_lower_lip(column)) == 1);
    }
    sheet_destroy(&s);
}

static void a_symmetric_sheet_gets_symmetric_weights(void **state)
{
    (void)state;
    sheet s;
    sheet_create(&s, SHEET_RIG);
    for (int row = -10; row <= 10; row++)
        for (int column = 1; column <= 10; column++) {
            uint32_t left = sheet_at(column, row), right = sheet_at(-column, row);
            assert_true(fabsf(sheet_weight(&s, 1, left) - sheet_weight(&s, 1, right)) <= 1e-6f);
            assert_true(fabsf(s.binding.mobility[left] - s.binding.mobility[right]) <= 1e-6f);
        }
    sheet_destroy(&s);
}

/* Columns 3 and 4 of the lips are free, and at the same place in space. */
static void the_fill_does_not_leap_over_the_slit(void **state)
{
    (void)state;
    sheet s;
    sheet_create(&s, SHEET_RIG);
    float upper = sheet_weight(&s, 1, sheet_at(3, 0));
    float lower = sheet_weight(&s, 1, sheet_lower_lip(3));
    assert_true(lower - upper > 0.5f);
    sheet_destroy(&s);
}

/* Where nothing but the two ends is marked, the fill is a ramp: half at half way. */
static void between_two_marks_lies_a_monotone_ramp(void **state)
{
    (void)state;
    sheet s;
    sheet_create(&s,
                 "{" SHEET_BONES ", \"regions\": [{\"bone\": \"skull\", \"weight\": 1, \"select\": "
                 "{\"half_space\": {\"point\": [-45, 0, 0], \"normal\": [-1, 0, 0]}}}, "
                 "{\"bone\": \"jaw\", \"weight\": 1, \"select\": "
                 "{\"half_space\": {\"point\": [45, 0, 0], \"normal\": [1, 0, 0]}}}]}");
    for (int column = -10; column < 10; column++) {
        float here = sheet_weight(&s, 1, sheet_at(column, 5));
        assert_true(sheet_weight(&s, 1, sheet_at(column + 1, 5)) >= here);
    }
    assert_true(fabsf(sheet_weight(&s, 1, sheet_at(0, 5)) - 0.5f) < 0.01f);
    sheet_destroy(&s);
}

/* One vertex marked 1 amid zeros at the rim: the harmonic fill is a spike there, half as high one
 * edge away; this one is a hill. */
static void a_single_mark_makes_a_hill_and_no_spike(void **state)
{
    (void)state;
    sheet s;
    sheet_create(&s, "{" SHEET_BONES
                     ", \"regions\": [{\"bone\": \"skull\", \"weight\": 1, \"select\": {\"not\": "
                     "{\"box\": {\"low\": [-48, -48, -1], \"high\": [48, 48, 1]}}}}, "
                     "{\"bone\": \"jaw\", \"weight\": 1, \"select\": {\"vertices\": [325]}}]}");
    assert_true(sheet_weight(&s, 1, 325) == 1); /* column 0, row 5 */
    assert_true(sheet_weight(&s, 1, sheet_at(1, 5)) > 0.8f);
    sheet_destroy(&s);
}

#define PAINT_ON(what)                                                                             \
    "{" SHEET_BONES ", \"regions\": [" SHEET_REGIONS ", {\"name\": \"" what                        \
    "\", \"bone\": \"jaw\", \"weight\": 1, \"select\": "                                           \
    "{\"vertices\": [325, 326]}}]}"

/* The same marks as a region of the file and as paint: one spreads, the other fades out, and takes
 * nothing from anybody. */
static void paint_changes_what_is_filled_only_where_it_is(void **state)
{
    (void)state;
    sheet bare, region, paint;
    sheet_create(&bare, SHEET_RIG);
    sheet_create(&region, PAINT_ON("jaw above"));
    sheet_create(&paint, PAINT_ON("painted jaw"));
    float spread = 0, faded = 0;
    for (uint32_t v = 0; v < SHEET_COUNT; v++) {
        float had = sheet_weight(&bare, 1, v), has = sheet_weight(&paint, 1, v);
        int32_t row = (int32_t)(v / 21) - 10, column = (int32_t)(v % 21) - 10;
        assert_true(has >= had - 1e-6f && has <= 1);
        assert_true(fabsf(has + sheet_weight(&paint, 0, v) - 1) <= 1e-6f);
        if (v < 441 && (abs(row - 5) > 4 || abs(column) > 5)) {
            faded = fmaxf(faded, fabsf(has - had));
            spread = fmaxf(spread, fabsf(sheet_weight(&region, 1, v) - had));
        }
    }
    assert_true(sheet_weight(&paint, 1, 325) == 1 && sheet_weight(&paint, 1, 326) == 1);
    assert_true(sheet_weight(&bare, 1, 325) < 0.5f);
    assert_true(faded < 0.01f);
    assert_true(spread > 0.05f);
    sheet_destroy(&bare);
    sheet_destroy(&region);
    sheet_destroy(&paint);
}

static void what_is_missing_to_one_goes_to_the_parent(void **state)
{
    (void)state;
    sheet s;
    sheet_create(&s,
                 "{" SHEET_BONES ", \"regions\": [" SHEET_REGIONS
                 ", {\"bone\": \"jaw\", \"weight\": 0.25, \"select\": {\"vertices\": [225]}}]}");
    assert_true(fabsf(sheet_weight(&s, 1, 225) - 0.25f) <= 1e-6f);
    assert_true(fabsf(sheet_weight(&s, 0, 225) - 0.75f) <= 1e-6f);
    sheet_destroy(&s);
}

static void without_marks_of_mobility_everything_is_free(void **state)
{
    (void)state;
    sheet s;
    sheet_create(&s, "{" SHEET_BONES
                     ", \"regions\": [{\"bone\": \"skull\", \"rigid\": true, \"select\": "
                     "{\"vertices\": [\"420-440\"]}}, {\"bone\": \"jaw\", \"weight\": 1, "
                     "\"select\": {\"vertices\": [\"0-20\"]}}]}");
    assert_true(s.binding.mobility[sheet_at(0, 0)] == 1);
    assert_true(s.binding.mobility[sheet_at(0, 10)] == 0);
    sheet_destroy(&s);
}

static void a_contact_can_be_pulled_though_no_region_says_so(void **state)
{
    (void)state;
    sheet s;
    sheet_create(&s, "{" SHEET_BONES
                     ", \"regions\": [{\"bone\": \"skull\", \"rigid\": true, \"select\": "
                     "{\"vertices\": [\"420-440\"]}}, {\"bone\": \"jaw\", \"weight\": 1, "
                     "\"select\": {\"vertices\": [\"0-20\"]}}], "
                     "\"contacts\": [{\"name\": \"nose\", \"vertex\": 283}]}");
    assert_true(s.binding.mobility[283] == 1);
    assert_true(s.binding.contact_position[0].x == 0 && s.binding.contact_position[0].y == 15);
    assert_true(s.binding.contact_normal[0].z == 1);
    sheet_destroy(&s);
}

static void a_contact_rides_on_the_bone_that_it_names(void **state)
{
    (void)state;
    sheet s;
    sheet_create(&s, "{" SHEET_BONES ", \"regions\": [" SHEET_REGIONS
                     "], \"contacts\": [{\"name\": \"cheek\", \"bone\": \"jaw\", "
                     "\"vertex\": 218}, {\"name\": \"side\", \"bone\": \"jaw\", "
                     "\"vertex\": 200}]}");
    assert_true(sheet_weight(&s, 1, 200) == 1);
    assert_true(sheet_weight(&s, 1, 218) == 1);
    sheet_destroy(&s);
}

/* A strip of four vertices that begins on the lower lip and ends 40 mm above it, over skin of the
 * skull: a lash. */
static void a_lash_goes_with_its_root(void **state)
{
    (void)state;
    sheet s = {0};
    sheet_create_mesh(&s.mesh, 4, 2);
    static const float strip[4][3] = {{-1, -10, 1}, {1, -10, 1}, {-1, 30, 2}, {1, 30, 2}};
    memcpy(s.mesh.position + 3 * SHEET_COUNT, strip, sizeof strip);
    uint32_t at = s.mesh.triangle_count - 2;
    sheet_put(&s.mesh, &at, SHEET_COUNT, SHEET_COUNT + 1, SHEET_COUNT + 2);
    sheet_put(&s.mesh, &at, SHEET_COUNT + 1, SHEET_COUNT + 3, SHEET_COUNT + 2);
    sheet_bind(&s, SHEET_RIG);
    float root = sheet_weight(&s, 1, SHEET_COUNT), skin = sheet_weight(&s, 1, sheet_at(0, -2));
    assert_true(skin > 0.9f && root == skin);
    assert_true(sheet_weight(&s, 1, SHEET_COUNT + 2) > 0.9f);
    sheet_destroy(&s);
}

static void degenerate_triangles_do_no_harm(void **state)
{
    (void)state;
    sheet s = {0};
    sheet_create_mesh(&s.mesh, 0, 1);
    uint32_t at = s.mesh.triangle_count - 1;
    sheet_put(&s.mesh, &at, 3, 3, 3);
    s.mesh.position[3 * sheet_at(5, 5)] = s.mesh.position[3 * sheet_at(4, 5)];
    sheet_bind(&s, SHEET_RIG);
    for (uint32_t v = 0; v < SHEET_COUNT; v++)
        assert_true(fabsf(sheet_weight(&s, 0, v) + sheet_weight(&s, 1, v) - 1) <= 1e-6f);
    sheet_destroy(&s);
}

static void no_rig_is_one_bone_and_everything_free(void **state)
{
    (void)state;
    mesh m;
    sheet_create_mesh(&m, 0, 0);
    binding b;
    error err;
    assert_int_equal(binding_create(&b, NULL, &m, NULL, &err), MRT_OK);
    assert_int_equal(b.bone_count, 1);
    for (uint32_t v = 0; v < SHEET_COUNT; v++)
        assert_true(b.weight[v] == 1 && b.mobility[v] == 1);
    binding_destroy(&b);
    mesh_destroy(&m);
}

static void the_same_marks_give_the_same_bits(void **state)
{
    (void)state;
    sheet a, b;
    sheet_create(&a, SHEET_RIG);
    sheet_create(&b, SHEET_RIG);
    assert_memory_equal(a.binding.weight, b.binding.weight, 2 * SHEET_COUNT * sizeof(float));
    assert_memory_equal(a.binding.mobility, b.binding.mobility, SHEET_COUNT * sizeof(float));
    sheet_destroy(&a);
    sheet_destroy(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(weights_are_shares_that_sum_to_one),
        cmocka_unit_test(marks_are_kept_to_the_bit),
        cmocka_unit_test(a_symmetric_sheet_gets_symmetric_weights),
        cmocka_unit_test(the_fill_does_not_leap_over_the_slit),
        cmocka_unit_test(between_two_marks_lies_a_monotone_ramp),
        cmocka_unit_test(a_single_mark_makes_a_hill_and_no_spike),
        cmocka_unit_test(paint_changes_what_is_filled_only_where_it_is),
        cmocka_unit_test(what_is_missing_to_one_goes_to_the_parent),
        cmocka_unit_test(without_marks_of_mobility_everything_is_free),
        cmocka_unit_test(a_contact_can_be_pulled_though_no_region_says_so),
        cmocka_unit_test(a_contact_rides_on_the_bone_that_it_names),
        cmocka_unit_test(a_lash_goes_with_its_root),
        cmocka_unit_test(degenerate_triangles_do_no_harm),
        cmocka_unit_test(no_rig_is_one_bone_and_everything_free),
        cmocka_unit_test(the_same_marks_give_the_same_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
