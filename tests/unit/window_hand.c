/* window/panels: which lines of the card of one_hand are lit, how near a face is to a goal, the
 * order of "Say it", and the rounds of "Simon says". */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "card.h"
#include "settings.h"
#include "window/panels/hand_lights.h"
#include "window/panels/say_it.h"
#include "window/panels/simon.h"

#include <math.h>
#include <string.h>

static const double frame_s = 1.0 / 60.0;

static void assert_near(double value, double wanted, double tolerance)
{
    if (!(fabs(value - wanted) <= tolerance))
        fail_msg("%.9g instead of %.9g", value, wanted);
}

/* ---- lights ---- */

static const mrt_card_line *lines_of(uint32_t *out_count)
{
    static double params[SET_COUNT];
    return card_lines(params, NULL, MRT_RIGHT, out_count);
}

static uint32_t line_named(const char *hand)
{
    uint32_t count;
    const mrt_card_line *line = lines_of(&count);
    for (uint32_t i = 0; i < count; ++i)
        if (strcmp(line[i].hand, hand) == 0)
            return i;
    fail_msg("no line \"%s\"", hand);
    return 0;
}

/* The angle moves so far within 0.2 s, from where it is. */
static void move(hand_lights *lights, mrt_hand *hand, int angle, float by_rad)
{
    uint32_t count;
    const mrt_card_line *line = lines_of(&count);
    for (int i = 0; i < 12; ++i) {
        hand->angle[angle] += by_rad / 12.0f;
        hand_lights_update(lights, line, count, hand, frame_s);
    }
}

static void a_line_is_lit_while_its_angle_moves_and_alone(void **state)
{
    (void)state;
    static const struct {
        const char *hand;
        int angle;
        float by_rad;
    } moves[] = {{"Thumb down", 3, 0.4f},
                 {"Thumb pressed up", 1, 0.3f},
                 {"Index knuckle lifted, bent", 4, -0.4f},
                 {"Index knuckle lifted, bent", 4, 0.4f},
                 {"Middle knuckle bent, lifted", 7, 0.4f},
                 {"Ring finger lifted, bent", 11, -0.4f},
                 {"Thumb rolled across the palm, back", 0, 0.3f},
                 {"Wrist", 20, 0.4f},
                 {"Wrist", 21, -0.4f}};
    uint32_t count;
    (void)lines_of(&count);
    for (size_t m = 0; m < sizeof moves / sizeof *moves; ++m) {
        hand_lights lights;
        mrt_hand hand = {.present = true};
        hand_lights_begin(&lights);
        move(&lights, &hand, 0, 0.0f);
        move(&lights, &hand, moves[m].angle, moves[m].by_rad);
        const uint32_t wanted = line_named(moves[m].hand);
        for (uint32_t i = 0; i < count; ++i)
            if (i == wanted ? lights.level[i] < 0.8f : lights.level[i] > 0.1f)
                fail_msg("%s: line %u has %.2f", moves[m].hand, i, (double)lights.level[i]);
        for (int i = 0; i < 3; ++i) /* it stands still: dark within a second */
            move(&lights, &hand, 0, 0.0f);
        assert_true(lights.level[wanted] > 0.02f); /* and not at once */
        for (int i = 0; i < 4; ++i)
            move(&lights, &hand, 0, 0.0f);
        assert_true(lights.level[wanted] < 0.1f);
    }
}

static void a_diagonal_of_the_wrist_lights_it(void **state)
{
    (void)state;
    uint32_t count;
    const mrt_card_line *line = lines_of(&count);
    hand_lights lights;
    mrt_hand hand = {.present = true};
    hand_lights_begin(&lights);
    for (int i = 0; i < 15; ++i) {
        hand.angle[20] += 0.02f;
        hand.angle[21] -= 0.02f;
        hand_lights_update(&lights, line, count, &hand, frame_s);
    }
    assert_true(lights.level[line_named("Wrist")] > 0.5f);
}

static void trembling_and_an_absent_hand_light_nothing(void **state)
{
    (void)state;
    uint32_t count;
    const mrt_card_line *line = lines_of(&count);
    hand_lights lights;
    mrt_hand hand = {.present = true};
    hand_lights_begin(&lights);
    for (int i = 0; i < 120; ++i) {
        for (int k = 0; k < MRT_ANGLES; ++k)
            hand.angle[k] = 0.012f * sinf(0.7f * (float)(i + 5 * k)); /* 0.7 degrees */
        hand_lights_update(&lights, line, count, &hand, frame_s);
        for (uint32_t k = 0; k < count; ++k)
            assert_true(lights.level[k] < 0.05f);
    }
    hand.present = false;
    hand.angle[1] = -1.0f;
    hand_lights_update(&lights, line, count, &hand, frame_s);
    hand.present = true; /* where it comes back is no movement */
    hand_lights_update(&lights, line, count, &hand, frame_s);
    assert_true(lights.level[line_named("Thumb down")] < 0.05f);
}

/* ---- how near ---- */

static goal_face face_with(double mm)
{
    goal_face out = {.contact_count = 3, .dof_count = 2};
    for (int i = 0; i < 3; ++i)
        out.has_contact[i] = i < 2;
    out.has_dof[0] = true;
    out.pull_mm[0] = (vec3){0.0, mm, 0.0};
    out.pull_mm[2] = (vec3){9.0, 9.0, 9.0}; /* of the other half */
    out.dof_mm[0] = mm;
    return out;
}

static void the_ring_is_open_at_rest_and_closed_when_near(void **state)
{
    (void)state;
    const goal_face wanted = face_with(10.0), rest = face_with(0.0), near = face_with(8.5);
    goal_face beside = wanted;
    goal_distance how = goal_measure(&wanted, &rest);
    assert_near(how.off_mm, 10.0, 1e-9);
    assert_near(how.limit_mm, 2.0, 1e-9);
    assert_near(how.closed, 0.0, 1e-9);
    how = goal_measure(&wanted, &near);
    assert_true(how.off_mm < how.limit_mm);
    assert_near(how.closed, 1.0, 1e-9);
    how = goal_measure(&wanted, &(goal_face){.contact_count = 3, .dof_count = 2});
    assert_near(how.off_mm, 10.0, 1e-9);       /* the other half does not count */
    beside.pull_mm[1] = (vec3){5.0, 0.0, 0.0}; /* what the goal leaves at rest does */
    how = goal_measure(&wanted, &beside);
    assert_near(how.off_mm, 5.0 / sqrt(2.0), 1e-9);
}

static void a_small_face_is_not_met_by_one_at_rest(void **state)
{
    (void)state;
    const goal_face wanted = face_with(2.0), rest = face_with(0.0);
    const goal_distance how = goal_measure(&wanted, &rest);
    assert_near(how.limit_mm, 1.0, 1e-9);
    assert_near(how.closed, 0.0, 1e-9);
    const goal_face large = face_with(40.0); /* 15 % */
    assert_near(goal_measure(&large, &rest).limit_mm, 6.0, 1e-9);
}

/* ---- the exercise ---- */

static const goal_distance met = {.off_mm = 1.0, .limit_mm = 2.0, .closed = 1.0},
                           missed = {.off_mm = 3.0, .limit_mm = 2.0, .closed = 0.9};

/* Frames until a step is met. */
static int frames_until_met(say_it *say)
{
    for (int i = 1; i < 100; ++i)
        if (say_it_update(say, &met, 0.01))
            return i;
    fail_msg("never met");
    return 0;
}

static void begin_with_all(say_it *say)
{
    say_it_begin(say, NULL);
    assert_null(say_it_step(say)); /* no rig, no goal */
    for (int i = 0; i < GOAL_COUNT; ++i)
        say->is_there[i] = true;
    say->at = say->step = 0;
}

static void a_face_is_held_for_a_quarter_of_a_second(void **state)
{
    (void)state;
    say_it say;
    uint32_t of;
    double took_s;
    begin_with_all(&say);
    assert_string_equal(say_it_step(&say)->name, "PP");
    for (int i = 0; i < 20; ++i)
        assert_false(say_it_update(&say, &met, 0.01));
    assert_false(say_it_update(&say, &missed, 0.01)); /* begins anew */
    assert_in_range(frames_until_met(&say), 25, 26);
    assert_string_equal(say_it_step(&say)->name, "FF");
    assert_int_equal(say_it_progress(&say, &of, &took_s), 1);
    assert_int_equal(of, GOAL_COUNT);
    assert_true(took_s > 0.45 && took_s < 0.48);
    say_it_back(&say);
    assert_string_equal(say_it_step(&say)->name, "PP");
    say_it_back(&say);
    assert_string_equal(say_it_step(&say)->name, "PP");
    say.is_there[1] = false; /* the rig lacks it */
    say_it_skip(&say);
    assert_string_equal(say_it_step(&say)->name, "aa");
    say_it_back(&say);
    assert_string_equal(say_it_step(&say)->name, "PP");
}

static void a_word_goes_on_at_each_viseme_and_words_end_the_exercise(void **state)
{
    (void)state;
    say_it say;
    begin_with_all(&say);
    while (strcmp(goals[say.at].name, "mama") != 0)
        say_it_skip(&say);
    static const char *const visemes[] = {"PP", "aa", "PP", "aa"};
    for (int i = 0; i < 4; ++i) {
        assert_string_equal(say_it_step(&say)->name, visemes[i]);
        assert_in_range(frames_until_met(&say), 8, 9);
    }
    assert_string_not_equal(goals[say.at].name, "mama");
    while (say_it_step(&say))
        say_it_skip(&say);
    assert_false(say_it_update(&say, &met, 0.01));
    assert_int_equal(say.at, GOAL_COUNT);
}

/* ---- Simon says ---- */

static void begin(simon *of, uint32_t faces)
{
    uint32_t count;
    const mrt_card_line *line = lines_of(&count);
    simon_begin(of, faces, line, count);
    assert_true(of->counts[1] && of->counts[10] && !of->counts[20] && !of->counts[21]);
}

/* Every counted angle is so far from zero. */
static void answer(simon *of, float deg)
{
    float angle_rad[MRT_ANGLES];
    for (int i = 0; i < MRT_ANGLES; ++i)
        angle_rad[i] = deg * 0.017453292f;
    simon_answer(of, angle_rad);
}

static void two_rounds_ask_for_every_face_in_another_order(void **state)
{
    (void)state;
    simon of;
    uint32_t first[12], second[12], asked = 0;
    begin(&of, 12);
    for (int i = 0; i < 12; ++i) {
        first[i] = simon_asked(&of);
        asked |= 1u << first[i];
        answer(&of, 20.0f * (float)first[i]);
    }
    assert_int_equal(asked, 0xfff);
    assert_int_equal(simon_asked(&of), 12);
    assert_int_equal(simon_left(&of), 12);
    simon_next_round(&of);
    for (int i = 0; i < 12; ++i) {
        second[i] = simon_asked(&of);
        answer(&of, 20.0f * (float)second[i] + 3.0f);
    }
    assert_memory_not_equal(first, second, sizeof first);
    assert_int_equal(simon_left(&of), 0); /* all near: no third round */
    for (uint32_t i = 0; i < 12; ++i)
        assert_near(simon_spread_deg(&of, i), 3.0, 1e-3);
}

static void a_third_round_asks_for_faces_answered_far_apart(void **state)
{
    (void)state;
    simon of;
    begin(&of, 4);
    for (int round = 0; round < 2; ++round) {
        while (simon_asked(&of) < 4) {
            const uint32_t asked = simon_asked(&of);
            answer(&of, 30.0f * (float)asked + (round == 1 && asked == 2 ? 15.0f : 0.0f));
        }
        if (round == 0)
            simon_next_round(&of);
    }
    assert_int_equal(simon_left(&of), 1);
    simon_next_round(&of);
    assert_int_equal(simon_asked(&of), 2);
    answer(&of, 68.0f);
    assert_int_equal(simon_asked(&of), 4);
    simon_next_round(&of);
    answer(&of, 68.0f);
    assert_int_equal(simon_left(&of), 0); /* four answers are enough */
    simon_forget(&of, 2);
    assert_int_equal(simon_left(&of), 1);
}

static void two_faces_with_one_hand_are_named_nearest_first(void **state)
{
    (void)state;
    simon of;
    simon_pair pair[SIMON_PAIRS_MAX];
    static const float deg[] = {0.0f, 40.0f, 5.0f, 41.0f, 80.0f};
    begin(&of, 5);
    for (int i = 0; i < 5; ++i)
        answer(&of, deg[i]);
    assert_int_equal(simon_twins(&of, pair), 2);
    assert_int_equal(pair[0].a, 1);
    assert_int_equal(pair[0].b, 3);
    assert_near(pair[0].deg, 1.0, 1e-3);
    assert_int_equal(pair[1].a, 0);
    assert_int_equal(pair[1].b, 2);
    simon_forget_all(&of);
    assert_int_equal(simon_twins(&of, pair), 0);
}

static void many_twins_keep_the_nearest(void **state)
{
    (void)state;
    simon of;
    simon_pair pair[SIMON_PAIRS_MAX];
    begin(&of, 8);
    for (int i = 0; i < 8; ++i)
        answer(&of, 0.5f * (float)i);
    assert_int_equal(simon_twins(&of, pair), SIMON_PAIRS_MAX);
    for (int i = 0; i < SIMON_PAIRS_MAX; ++i)
        assert_true(pair[i].deg < 1.01 && (i == 0 || pair[i].deg >= pair[i - 1].deg));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_line_is_lit_while_its_angle_moves_and_alone),
        cmocka_unit_test(a_diagonal_of_the_wrist_lights_it),
        cmocka_unit_test(trembling_and_an_absent_hand_light_nothing),
        cmocka_unit_test(the_ring_is_open_at_rest_and_closed_when_near),
        cmocka_unit_test(a_small_face_is_not_met_by_one_at_rest),
        cmocka_unit_test(a_face_is_held_for_a_quarter_of_a_second),
        cmocka_unit_test(a_word_goes_on_at_each_viseme_and_words_end_the_exercise),
        cmocka_unit_test(two_rounds_ask_for_every_face_in_another_order),
        cmocka_unit_test(a_third_round_asks_for_faces_answered_far_apart),
        cmocka_unit_test(two_faces_with_one_hand_are_named_nearest_first),
        cmocka_unit_test(many_twins_keep_the_nearest),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
