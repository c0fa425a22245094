/* Pins before tips: what has been factored of them is used again while they stay, and no bit tells
 * by which way a field was reached. Many centres: their order, and their envelope. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "csrbf/saddle.h"
#include "property/csrbf_scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SKULL = 180, JAW = 47, TIPS = 11, PINS = SKULL + JAW, ALL = PINS + TIPS, POINTS = 60 };

typedef struct controls { /* the skull, the jaw, the tips: each from where `first` says */
    double at[ALL][3], g[ALL][3];
    csrbf_class class[ALL];
    uint32_t count;
} controls;

static void must(mrt_result result, const error *err)
{
    if (result < 0)
        fail_msg("%s", err->text);
}

static void put(controls *c, csrbf_class class, const double at[3], const double g[3])
{
    c->class[c->count] = class;
    memcpy(c->at[c->count], at, sizeof c->at[0]);
    memcpy(c->g[c->count++], g, sizeof c->g[0]);
}

/* Spread evenly over an ellipsoid, seen from the middle of it. */
static void place_on_head(double out[3], uint32_t i, uint32_t count, double size)
{
    const double golden = 2.399963229728653;
    double y = 1.0 - 2.0 * ((double)i + 0.5) / (double)count, r = sqrt(1.0 - y * y);
    out[0] = 1.2 * size * r * cos(golden * i);
    out[1] = 1.7 * size * y;
    out[2] = 1.5 * size * r * sin(golden * i);
}

static controls scene_of_pins(uint64_t seed, double jaw_drop)
{
    const double still[3] = {0.0, 0.0, 0.0}, dropped[3] = {0.0, -0.125, 0.0};
    controls c = {.count = 0};
    double at[3], g[3];
    for (uint32_t i = 0; i < SKULL; ++i) {
        place_on_head(at, i, SKULL, 1.0);
        put(&c, CSRBF_SKULL, at, still);
    }
    for (uint32_t i = 0; i < JAW; ++i) {
        place_on_head(at, i, JAW, 0.5);
        at[1] -= 1.5 + jaw_drop;
        put(&c, CSRBF_JAW, at, dropped);
    }
    for (uint32_t i = 0; i < TIPS; ++i) {
        place_on_head(at, i, TIPS, 1.5);
        for (int axis = 0; axis < 3; ++axis) {
            at[axis] += scene_number(&seed, 0.125);
            g[axis] = scene_number(&seed, 0.25);
        }
        put(&c, CSRBF_TIP, at, g);
    }
    return c;
}

/* What a field does, as bytes. */
typedef struct outcome {
    double moved[POINTS][3];
    csrbf_diagnostics said;
} outcome;

static void perform(outcome *out, csrbf_solver *solver, const csrbf_settings *settings,
                    const controls *c)
{
    error err = {""};
    uint64_t seed = 5;
    memset(out, 0, sizeof *out);
    must(csrbf_factor(solver, settings, c->at[0], c->class, c->count, &err), &err);
    must(csrbf_solve(solver, c->g[0], &err), &err);
    for (int i = 0; i < POINTS; ++i)
        for (int axis = 0; axis < 3; ++axis)
            out->moved[i][axis] = scene_number(&seed, 2.5);
    csrbf_move_f64(solver, out->moved[0], POINTS);
    out->said = csrbf_diagnose(solver);
}

static void expect_same(const outcome *a, const outcome *b)
{
    assert_memory_equal(a->moved, b->moved, sizeof a->moved);
    assert_int_equal(a->said.envelope_count, b->said.envelope_count);
    assert_memory_equal(&a->said.alpha_sum, &b->said.alpha_sum, sizeof a->said.alpha_sum);
}

static void expect_as_fresh(csrbf_solver *solver, const csrbf_settings *settings, const controls *c)
{
    static outcome found, expected;
    csrbf_solver *fresh = csrbf_solver_create(ALL);
    assert_non_null(fresh);
    perform(&expected, fresh, settings, c);
    perform(&found, solver, settings, c);
    csrbf_solver_destroy(fresh);
    expect_same(&found, &expected);
}

/* ---- the same bits ---- */

static void a_field_does_not_tell_what_was_factored_before(void **state)
{
    (void)state;
    uint64_t seed = 3;
    csrbf_solver *solver = csrbf_solver_create(ALL);
    assert_non_null(solver);
    for (int step = 0; step < 120; ++step) {
        uint64_t chance = scene_next(&seed);
        csrbf_settings settings = {.radius = chance % 8 == 0 ? 0.75 : 1.0,
                                   .ridge = chance % 11 == 0 ? 0.02 : 0.0,
                                   .kernel =
                                       chance % 13 == 0 ? CSRBF_WENDLAND_C4 : CSRBF_WENDLAND_C2,
                                   .polynomial = (csrbf_polynomial)(chance / 64 % 4)};
        controls c = scene_of_pins(chance, chance % 5 == 0 ? 0.25 : 0.0);
        if (chance % 3 == 0)
            c.count -= (uint32_t)(chance / 1024 % (TIPS + 5)); /* fewer tips, or jaw pins too */
        if (chance % 7 == 0)
            c.at[chance % ALL][2] += 0.0625; /* somewhere in the middle of the order */
        expect_as_fresh(solver, &settings, &c);
    }
    csrbf_solver_destroy(solver);
}

static void nor_do_fields_of_tips_alone(void **state)
{
    (void)state;
    uint64_t seed = 8;
    csrbf_solver *solver = csrbf_solver_create(ALL);
    assert_non_null(solver);
    controls c = scene_of_pins(1, 0.0);
    for (uint32_t i = 0; i < c.count; ++i)
        c.class[i] = CSRBF_TIP;
    for (int step = 0; step < 60; ++step) {
        c.count = 1 + (uint32_t)(scene_next(&seed) % 40);
        c.at[scene_next(&seed) % c.count][1] += 0.03125;
        expect_as_fresh(solver, &(csrbf_settings){.radius = 0.5}, &c);
    }
    csrbf_solver_destroy(solver);
}

static void a_refused_set_leaves_the_field_and_spoils_no_later_one(void **state)
{
    (void)state;
    static outcome before, after;
    const csrbf_settings settings = {.radius = 1.0, .kernel = CSRBF_WENDLAND_C6};
    csrbf_solver *solver = csrbf_solver_create(ALL);
    assert_non_null(solver);
    controls good = scene_of_pins(1, 0.0), other = scene_of_pins(2, 0.0), bad = good;
    perform(&before, solver, &settings, &good);
    for (int i = PINS; i < ALL; ++i) { /* so close in a row that a pivot vanishes behind the pins */
        memcpy(bad.at[i], bad.at[PINS], sizeof bad.at[i]);
        bad.at[i][0] += 0.002 * (i - PINS);
    }
    assert_int_equal(csrbf_factor(solver, &settings, bad.at[0], bad.class, bad.count, NULL),
                     MRT_ERR_UNSUPPORTED);
    bad.at[ALL - 1][0] = (double)NAN;
    assert_true(csrbf_factor(solver, &settings, bad.at[0], bad.class, bad.count, NULL) < 0);
    after = before;
    uint64_t seed = 5;
    for (int i = 0; i < POINTS; ++i)
        for (int axis = 0; axis < 3; ++axis)
            after.moved[i][axis] = scene_number(&seed, 2.5);
    csrbf_move_f64(solver, after.moved[0], POINTS);
    expect_same(&after, &before);
    expect_as_fresh(solver, &settings, &other);
    expect_as_fresh(solver, &settings, &good);
    csrbf_solver_destroy(solver);
}

static void shuffle(controls *c, uint64_t seed)
{
    for (uint32_t i = c->count; i > 1; --i) {
        uint32_t k = (uint32_t)(scene_next(&seed) % i);
        controls old = *c;
        c->class[i - 1] = old.class[k];
        c->class[k] = old.class[i - 1];
        memcpy(c->at[i - 1], old.at[k], sizeof old.at[k]);
        memcpy(c->at[k], old.at[i - 1], sizeof old.at[k]);
        memcpy(c->g[i - 1], old.g[k], sizeof old.g[k]);
        memcpy(c->g[k], old.g[i - 1], sizeof old.g[k]);
    }
}

static void many_controls_in_any_order_give_the_same_bits(void **state)
{
    (void)state;
    static outcome first, second;
    const csrbf_settings settings = {.radius = 1.0};
    csrbf_solver *solver = csrbf_solver_create(ALL);
    assert_non_null(solver);
    controls c = scene_of_pins(4, 0.0);
    perform(&first, solver, &settings, &c);
    for (uint64_t seed = 1; seed < 6; ++seed) {
        shuffle(&c, seed);
        perform(&second, solver, &settings, &c);
        expect_same(&second, &first);
    }
    csrbf_solver_destroy(solver);
}

/* ---- what is done again ---- */

static order_item scratch[3 * ALL];

static void factor(saddle *s, const saddle *other, const csrbf_settings *settings,
                   const controls *c)
{
    error err = {""};
    must(saddle_factor(s, other, scratch, settings, c->at[0], c->class, c->count, &err), &err);
}

/* Marks a row of the factor: it shows later whether the row was factored again. */
static const double mark = 12345.0;

static double *last_of_row(saddle *s, uint32_t row)
{
    return &s->matrix.value[s->matrix.start[row + 1] - 1];
}

static uint32_t rows_marked(saddle *s)
{
    uint32_t row = 0;
    while (row < s->matrix.row_count && *last_of_row(s, row) >= mark)
        ++row;
    return row;
}

static uint32_t rows_kept(const controls *before, const csrbf_settings *settings_before,
                          const controls *after, const csrbf_settings *settings_after)
{
    saddle s[2];
    assert_true(saddle_create(&s[0], ALL) && saddle_create(&s[1], ALL));
    factor(&s[0], &s[1], settings_before, before);
    for (uint32_t row = 0; row < s[0].matrix.row_count; ++row)
        *last_of_row(&s[0], row) = mark;
    factor(&s[1], &s[0], settings_after, after); /* lent */
    uint32_t lent = rows_marked(&s[1]);
    factor(&s[0], &s[1], settings_after, after); /* its own */
    assert_int_equal(rows_marked(&s[0]), lent);
    saddle_destroy(&s[0]);
    saddle_destroy(&s[1]);
    return lent;
}

static void pins_that_stay_are_not_factored_again(void **state)
{
    (void)state;
    const csrbf_settings near = {.radius = 0.5}, wide = {.radius = 0.75};
    csrbf_settings other = near;
    controls c = scene_of_pins(1, 0.0), tips = scene_of_pins(2, 0.0), jaw = scene_of_pins(1, 0.25);
    assert_in_range(rows_kept(&c, &near, &tips, &near), PINS - 3, PINS);
    assert_in_range(rows_kept(&c, &near, &jaw, &near), SKULL - 3, SKULL);
    assert_int_equal(rows_kept(&c, &near, &tips, &wide), 0);
    other.ridge = 0.02;
    assert_int_equal(rows_kept(&c, &near, &tips, &other), 0);
    other = near;
    other.kernel = CSRBF_WENDLAND_C6;
    assert_int_equal(rows_kept(&c, &near, &tips, &other), 0);
    other = near;
    other.polynomial = CSRBF_CONSTANT; /* not of the matrix */
    assert_in_range(rows_kept(&c, &near, &tips, &other), PINS - 3, PINS);
}

static void the_skull_comes_first_then_the_jaw_then_tips(void **state)
{
    (void)state;
    saddle s[2];
    assert_true(saddle_create(&s[0], ALL) && saddle_create(&s[1], ALL));
    controls c = scene_of_pins(1, 0.0);
    shuffle(&c, 9);
    factor(&s[0], &s[1], &(csrbf_settings){.radius = 1.0}, &c);
    assert_int_equal(s[0].merge.group_count, ALL);
    for (uint32_t i = 0; i < ALL; ++i) {
        uint32_t place = s[0].merge.group[i];
        csrbf_class expected = place < SKULL ? CSRBF_SKULL : place < PINS ? CSRBF_JAW : CSRBF_TIP;
        assert_int_equal(c.class[i], expected);
    }
    saddle_destroy(&s[0]);
    saddle_destroy(&s[1]);
}

/* A tip on a pin belongs to the pin, and two pins that one tip joins become one: other rows. */
static void a_tip_that_joins_pins_makes_their_rows_anew(void **state)
{
    (void)state;
    csrbf_solver *solver = csrbf_solver_create(ALL);
    assert_non_null(solver);
    const csrbf_settings settings = {.radius = 1.0};
    controls c = scene_of_pins(1, 0.0);
    memcpy(c.at[7], c.at[3], sizeof c.at[7]);
    c.at[7][0] += 0x1p-10 + 0x1p-11; /* 1.5e-3 R from the third: not joined to it by itself */
    expect_as_fresh(solver, &settings, &c);
    memcpy(c.at[PINS], c.at[3], sizeof c.at[PINS]);
    c.at[PINS][0] += 0x1p-11 + 0x1p-12; /* half way */
    expect_as_fresh(solver, &settings, &c);
    assert_int_equal(csrbf_diagnose(solver).centre_count, ALL - 2);
    memcpy(c.at[PINS], c.at[0], sizeof c.at[PINS]);
    expect_as_fresh(solver, &settings, &c);
    assert_int_equal(csrbf_diagnose(solver).centre_count, ALL - 1);
    csrbf_solver_destroy(solver);
}

/* ---- many ---- */

static void many_centres_have_a_small_envelope(void **state)
{
    (void)state;
    enum { MANY = 900 };
    static double at[MANY][3];
    error err = {""};
    for (uint32_t i = 0; i < MANY; ++i)
        place_on_head(at[i], i, MANY, 50.0);
    csrbf_solver *solver = csrbf_solver_create(MANY);
    assert_non_null(solver);
    must(csrbf_factor(solver, &(csrbf_settings){.radius = 30.0}, at[0], NULL, MANY, &err), &err);
    double triangle = 0.5 * MANY * (MANY + 1.0);
    assert_true(csrbf_diagnose(solver).envelope_count < 0.3 * triangle); /* Morton: 0.42 */
    csrbf_solver_destroy(solver);
}

/* Centres that coincide are found among many as among few. */
static void each_pair_that_coincides_is_joined(void **state)
{
    (void)state;
    enum { MANY = 600, PAIRS = 150 };
    static double at[MANY][3];
    error err = {""};
    uint64_t seed = 2;
    for (uint32_t i = 0; i < MANY; ++i)
        place_on_head(at[i], i, MANY, 50.0);
    for (uint32_t i = 0; i < PAIRS; ++i)
        for (int axis = 0; axis < 3; ++axis)
            at[MANY - 1 - i][axis] = at[2 * i][axis] + scene_number(&seed, 0.0009765625) * 8.0;
    csrbf_solver *solver = csrbf_solver_create(MANY);
    assert_non_null(solver);
    must(csrbf_factor(solver, &(csrbf_settings){.radius = 30.0}, at[0], NULL, MANY, &err), &err);
    assert_int_equal(csrbf_diagnose(solver).centre_count, MANY - PAIRS);
    csrbf_solver_destroy(solver);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_field_does_not_tell_what_was_factored_before),
        cmocka_unit_test(nor_do_fields_of_tips_alone),
        cmocka_unit_test(a_refused_set_leaves_the_field_and_spoils_no_later_one),
        cmocka_unit_test(many_controls_in_any_order_give_the_same_bits),
        cmocka_unit_test(pins_that_stay_are_not_factored_again),
        cmocka_unit_test(the_skull_comes_first_then_the_jaw_then_tips),
        cmocka_unit_test(a_tip_that_joins_pins_makes_their_rows_anew),
        cmocka_unit_test(many_centres_have_a_small_envelope),
        cmocka_unit_test(each_pair_that_coincides_is_joined),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
