/* perform/patch.h, patch_file.h: what a connection makes of its channel, and patches as JSON. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "stage/perform/patch_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const mrt_channel fader = {"fader 1", "", MRT_CH_OTHER, MRT_NO_HAND, 0, 1};
static const mrt_channel stick = {"lefty", "", MRT_CH_OTHER, MRT_NO_HAND, -1, 1};
static const patch_range jaw = {-0.1, 0.5, 0.0};

static void curves_hold_their_ends_and_rise(void **state)
{
    (void)state;
    for (double bend = -1.0; bend <= 1.0; bend += 0.25)
        for (double ease = -1.0; ease <= 1.0; ease += 0.25) {
            assert_float_equal(patch_curve(0.0, bend, ease), 0.0, 1e-12);
            assert_float_equal(patch_curve(1.0, bend, ease), 1.0, 1e-12);
            assert_float_equal(patch_curve(-3.0, bend, ease), 0.0, 1e-12);
            assert_float_equal(patch_curve(7.0, bend, ease), 1.0, 1e-12);
            for (int i = 0; i < 200; ++i)
                assert_true(patch_curve((i + 1) / 200.0, bend, ease) >
                            patch_curve(i / 200.0, bend, ease));
        }
    assert_float_equal(patch_curve(0.3, 0.0, 0.0), 0.3, 1e-12); /* straight */
    assert_true(patch_curve(0.5, 0.5, 0.0) < 0.4);              /* slow at first */
    assert_true(patch_curve(0.5, -0.5, 0.0) > 0.6);
    assert_float_equal(patch_curve(0.5, 0.0, 0.7), 0.5, 1e-12);
    assert_true(patch_curve(0.1, 0.0, 0.7) < 0.05);
}

static void a_range_is_the_channels_and_the_targets_unless_said(void **state)
{
    (void)state;
    patch_connection c = patch_connection_of(PATCH_DOF);
    assert_float_equal(patch_wanted(&c, &fader, 0.0, &jaw), 0.0, 1e-12); /* from rest */
    assert_float_equal(patch_wanted(&c, &fader, 1.0, &jaw), 0.5, 1e-12);
    assert_float_equal(patch_wanted(&c, &fader, 9.0, &jaw), 0.5, 1e-12); /* held at its end */
    assert_float_equal(patch_wanted(&c, &stick, 0.0, &jaw), 0.0, 1e-12); /* rest is rest */
    assert_float_equal(patch_wanted(&c, &stick, -1.0, &jaw), -0.1, 1e-12);
    assert_float_equal(patch_wanted(&c, &stick, 1.0, &jaw), 0.5, 1e-12);
    c.in[0] = 0.0; /* one half of the stick */
    c.in[1] = 1.0;
    c.out[0] = 0.4; /* turned round */
    c.out[1] = 0.0;
    assert_float_equal(patch_wanted(&c, &stick, -0.7, &jaw), 0.4, 1e-12);
    assert_float_equal(patch_wanted(&c, &stick, 0.5, &jaw), 0.2, 1e-12);
    c = patch_connection_of(PATCH_PARAM); /* from its lowest, not from its first value */
    assert_float_equal(patch_wanted(&c, &fader, 0.0, &jaw), -0.1, 1e-12);
    const mrt_channel dead = {"x", "", MRT_CH_OTHER, MRT_NO_HAND, 0, 0};
    assert_true(isfinite(patch_wanted(&c, &dead, 3.0, &jaw)));
}

static void smoothing_starts_at_once_and_in_the_samples_time(void **state)
{
    (void)state;
    patch_connection c = patch_connection_of(PATCH_DOF);
    patch_course course = {0};
    c.smooth_s = 0.1;
    assert_true(patch_course_step(&course, &c, 0.4, 0.0, &jaw, 0.0));
    assert_float_equal(course.value, 0.4, 1e-12); /* not from nothing */
    assert_true(patch_course_step(&course, &c, 0.0, 0.0, &jaw, 0.1));
    assert_float_equal(course.value, 0.2, 1e-12);
    double before = course.value;
    assert_true(patch_course_step(&course, &c, 0.0, 0.0, &jaw, 0.0)); /* no time, no way */
    assert_float_equal(course.value, before, 0.0);
}

static void a_fader_is_picked_up_where_the_target_is(void **state)
{
    (void)state;
    patch_connection c = patch_connection_of(PATCH_DOF);
    patch_course course = {0};
    c.picks_up = true;
    assert_false(patch_course_step(&course, &c, 0.45, 0.2, &jaw, 0.01));
    assert_false(patch_course_step(&course, &c, 0.3, 0.2, &jaw, 0.01));
    assert_true(patch_course_step(&course, &c, 0.1, 0.2, &jaw, 0.01)); /* came by, fast */
    assert_float_equal(course.value, 0.1, 1e-12);
    assert_true(patch_course_step(&course, &c, 0.5, 0.2, &jaw, 0.01)); /* and stays */
    course = (patch_course){0};
    assert_true(patch_course_step(&course, &c, 0.205, 0.2, &jaw, 0.01)); /* was there already */
}

static void a_slider_that_is_moved_takes_its_parameter_back(void **state)
{
    (void)state;
    patch_connection c = patch_connection_of(PATCH_PARAM);
    patch_course course = {0};
    c.picks_up = true;
    assert_true(patch_course_step(&course, &c, 0.2, 0.2, &jaw, 0.01));
    assert_true(patch_course_step(&course, &c, 0.3, 0.2, &jaw, 0.01));
    assert_false(patch_course_step(&course, &c, 0.3, 0.05, &jaw, 0.01));
    assert_true(patch_course_step(&course, &c, 0.04, 0.05, &jaw, 0.01));
    c.picks_up = false;
    assert_true(patch_course_step(&course, &c, 0.3, -0.05, &jaw, 0.01));
}

static void a_button_is_pressed_once_and_not_by_being_found_down(void **state)
{
    (void)state;
    patch_course course = {0};
    assert_false(patch_course_press(&course, 1.0));
    assert_false(patch_course_press(&course, 0.45)); /* noise at the threshold */
    assert_false(patch_course_press(&course, 1.0));
    assert_false(patch_course_press(&course, 0.0));
    assert_true(patch_course_press(&course, 1.0));
    assert_false(patch_course_press(&course, 1.0));
}

static void channels_are_found_by_input_and_name(void **state)
{
    (void)state;
    static const float one[1] = {0.25f}, other[1] = {0.75f};
    const mrt_channels inputs[2] = {{"gamepad 1", &stick, one, 0, 1},
                                    {"gamepad 2", &stick, other, 0, 1}};
    mrt_frame frame = {.inputs = inputs, .input_count = 2, .pedal = {0, 0.5f, 0, 0}};
    frame.hand[MRT_RIGHT].present = true;
    frame.hand[MRT_RIGHT].angle[4] = 0.6f;
    static const struct {
        const char *input, *channel;
        double raw; /* NaN: nobody has it */
    } cases[] = {
        {"", "lefty", 0.25},
        {"gamepad", "lefty", 0.25},
        {"gamepad 2", "lefty", 0.75},
        {"gamepad 3", "lefty", NAN},
        {"game", "lefty", NAN},
        {"", "righty", NAN},
        {"performer", "pedal.2", 0.5},
        {"performer", "pedal.5", NAN},
        {"performer", "right.index.mpj", 0.6},
        {"performer", "left.index.mpj", NAN},
        {"performer", "right.toe", NAN},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        patch_connection c = patch_connection_of(PATCH_DOF);
        mrt_channel channel;
        double raw = 0.0;
        (void)snprintf(c.input, sizeof c.input, "%s", cases[i].input);
        (void)snprintf(c.channel, sizeof c.channel, "%s", cases[i].channel);
        bool is_there = patch_read_channel(&c, &frame, &channel, &raw);
        assert_int_equal(is_there, !isnan(cases[i].raw));
        if (is_there)
            assert_float_equal(raw, cases[i].raw, 1e-6);
    }
}

/* ---- as JSON ---- */

static patch *random_patch(uint32_t seed)
{
    static const char *const names[] = {"jaw.open", "mouth.corner.*", "a \"name\"", "\xc3\xa4",
                                        "record"};
    patch *p = calloc(1, sizeof *p);
    assert_non_null(p);
    srand(seed);
    p->count = (uint32_t)rand() % 20;
    (void)snprintf(p->name, sizeof p->name, "%s", seed % 2 ? "" : "some");
    for (uint32_t i = 0; i < p->count; ++i) {
        patch_connection *c = &p->connection[i];
        *c = patch_connection_of((patch_kind)(PATCH_PARAM + rand() % (PATCH_KINDS - PATCH_PARAM)));
        bool is_action = c->kind == PATCH_ACTION;
        (void)snprintf(c->target, sizeof c->target, "%s",
                       is_action ? patch_action_names[rand() % PATCH_ACTIONS] : names[rand() % 5]);
        (void)snprintf(c->channel, sizeof c->channel, "%s", names[rand() % 5]);
        (void)snprintf(c->input, sizeof c->input, "%s", rand() % 2 ? "" : names[rand() % 5]);
        if (rand() % 2) {
            c->in[0] = rand() / 3e9 - 1.0;
            c->in[1] = c->in[0] + 0.1 + rand() / 7e9;
        }
        if (rand() % 2) {
            c->out[0] = rand() / 1e5;
            c->out[1] = -rand() / 7e7;
        }
        c->bend = rand() / (double)RAND_MAX * 2.0 - 1.0;
        c->ease = rand() % 2 ? 0.25 : 0.0;
        c->smooth_s = rand() % 2 ? 0.1 : 0.0;
        c->adds = rand() % 2;
        c->picks_up = rand() % 2;
        c->is_muted = rand() % 2;
        if (c->kind == PATCH_CONTACT) {
            c->way[0] = 0.6f;
            c->way[1] = -0.8f;
        }
    }
    return p;
}

static void what_is_written_is_read_as_the_same(void **state)
{
    (void)state;
    patch *again = calloc(1, sizeof *again);
    for (uint32_t seed = 0; seed < 300; ++seed) {
        patch *p = random_patch(seed);
        char *text;
        error err = {""};
        assert_int_equal(patch_file_write(&text, p, &err), MRT_OK);
        if (patch_file_parse(again, text, strlen(text), "it", &err) < 0)
            fail_msg("%s in %s", err.text, text);
        assert_true(patch_equal(p, again));
        free(text);
        free(p);
    }
    free(again);
}

static void what_makes_no_sense_is_refused_with_its_place(void **state)
{
    (void)state;
#define ONE(text) "{'marotte_patch':1,'connections':[" text "]}"
#define TO_JAW    "'to':{'dof':'jaw.open'}"
    static const struct {
        const char *text, *words;
    } cases[] = {
        {"", "not JSON"},
        {"[]", "expected an object, found an array"},
        {"{}", "$.marotte_patch: expected 1, the version of the format, found nothing"},
        {"{'marotte_patch':2,'connections':[]}", "was made by a newer marotte (version 2, this"},
        {"{'marotte_patch':1}", "$.connections: expected an array of at most 64"},
        {"{'marotte_patch':1,'marotte_patch':1,'connections':[]}", "not JSON: duplicate"},
        {"{'marotte_patch':1,'connections':[],'more':1}", "$: unknown key \"more\""},
        {ONE("3"), "$.connections[0]: expected an object, found 3"},
        {ONE("{" TO_JAW "}"), "$.connections[0].from: expected an object, found nothing"},
        {ONE("{" TO_JAW ",'from':{'channel':''}}"), "from.channel: expected a text of 1 to 63"},
        {ONE("{" TO_JAW ",'from':{'channel':'a\\u0000b'}}"), "not JSON"},
        {ONE("{" TO_JAW ",'from':{'channel':'\\u001b[2J'}}"), "from.channel: expected a text"},
        {ONE("{" TO_JAW ",'from':{'channel':'a'},'in':[0]}"), "in: expected two numbers"},
        {ONE("{" TO_JAW ",'from':{'channel':'a'},'in':[1,1]}"), "in: is not two ascending"},
        {ONE("{" TO_JAW ",'from':{'channel':'a'},'out':[0,1e300]}"), "out: is not two numbers"},
        {ONE("{" TO_JAW ",'from':{'channel':'a'},'bend':1.5}"), "bend: is not within"},
        {ONE("{" TO_JAW ",'from':{'channel':'a'},'mode':'more'}"), "mode: expected"},
        {ONE("{" TO_JAW ",'from':{'channel':'a'},'pickup':1}"), "pickup: expected true or false"},
        {ONE("{'to':{'dof':'a','pose':'b'},'from':{'channel':'a'}}"), "to: expected one of"},
        {ONE("{'to':{'dof':'a','way':[0,1,0]},'from':{'channel':'a'}}"), "with a contact alone"},
        {ONE("{'to':{'contact':'a','way':[0,0,0]},'from':{'channel':'a'}}"), "a direction"},
    };
    patch *p = calloc(1, sizeof *p);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        char text[400];
        error err = {""};
        (void)snprintf(text, sizeof text, "%s", cases[i].text);
        for (char *at = text; *at; ++at)
            *at = *at == '\'' ? '"' : *at;
        assert_true(patch_file_parse(p, text, strlen(text), "it", &err) < 0);
        if (!strstr(err.text, cases[i].words))
            fail_msg("\"%s\" for %s", err.text, text);
        assert_int_equal(p->count, 0);
    }
    free(p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(curves_hold_their_ends_and_rise),
        cmocka_unit_test(a_range_is_the_channels_and_the_targets_unless_said),
        cmocka_unit_test(smoothing_starts_at_once_and_in_the_samples_time),
        cmocka_unit_test(a_fader_is_picked_up_where_the_target_is),
        cmocka_unit_test(a_slider_that_is_moved_takes_its_parameter_back),
        cmocka_unit_test(a_button_is_pressed_once_and_not_by_being_found_down),
        cmocka_unit_test(channels_are_found_by_input_and_name),
        cmocka_unit_test(what_is_written_is_read_as_the_same),
        cmocka_unit_test(what_makes_no_sense_is_refused_with_its_place),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
