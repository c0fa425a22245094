/* perform/patch_bay.h: a patch on a face, step by step. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "stage/perform/patch_bay.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { CHANNELS = 3, JAW = 0, NOD = 1 };
static const mrt_channel channels[CHANNELS] = {{"fader 1", "", MRT_CH_OTHER, MRT_NO_HAND, 0, 1},
                                               {"stick", "", MRT_CH_OTHER, MRT_NO_HAND, -1, 1},
                                               {"button", "", MRT_CH_BUTTON, MRT_NO_HAND, 0, 1}};
static const mrt_contact contacts[3] = {{"mouth.corner.l", "skull", {30, -40, 60}, {0, 0, 1}},
                                        {"mouth.corner.r", "skull", {-30, -40, 60}, {0, 0, 1}},
                                        {"chin", "jaw", {0, -90, 60}, {0, 0, 1}}};
static const mrt_dof dofs[2] = {{"jaw.open", "rad", 0, 0.5f}, {"skull.nod", "rad", -0.4f, 0.6f}};
static const mrt_face about = {contacts, dofs, 3, 2, {-80, -120, -80}, {80, 120, 80}};
static const guard fence = {.contact_count = 3, .reach_mm = 2000.0};
static const char *const labels[] = {"one", "two", "three"};
static const mrt_param params[3] = {{1, 0, "Gain", "", "", "", 0, 10, 2, NULL},
                                    {2, MRT_PARAM_STEPPED, "Mode", "", "", "", 0, 2, 0, labels},
                                    {3, MRT_PARAM_TRIGGER, "Teach", "", "", "", 0, 1, 0, NULL}};
static const mrt_plugin_type mapping = {.abi = MRT_ABI, .param_count = 3, .params = params};

typedef struct scene {
    patch of;
    patch_bay bay;
    float value[CHANNELS];
    mrt_channels input;
    mrt_frame frame;
    mrt_pull below;
    double own[3], out[3];
} scene;

static patch_connection *connect(scene *s, patch_kind kind, const char *channel, const char *target)
{
    patch_connection *c = &s->of.connection[s->of.count++];
    *c = patch_connection_of(kind);
    (void)snprintf(c->channel, sizeof c->channel, "%s", channel);
    (void)snprintf(c->target, sizeof c->target, "%s", target);
    return c;
}

static void plug(scene *s)
{
    error err = {""};
    patch_plan *plan, *old;
    assert_int_equal(patch_plan_create(&plan, &s->of, &about, NULL, NULL, &err), MRT_OK);
    assert_string_equal(patch_plan_note(plan), "");
    assert_true(patch_bay_set(&s->bay, plan, &old));
    patch_plan_destroy(old);
}

static scene *begin(void)
{
    scene *s = calloc(1, sizeof *s);
    assert_non_null(s);
    patch_bay_init(&s->bay, &fence);
    s->input = (mrt_channels){"midi box", channels, s->value, 0, CHANNELS};
    s->frame = (mrt_frame){.dt_s = 0.01, .inputs = &s->input, .input_count = 1};
    s->own[0] = 2.0;
    for (int i = 0; i < MRT_MAX_DOFS; ++i)
        s->below.dof[i] = NAN;
    return s;
}

static void end(scene *s)
{
    patch_bay_finish(&s->bay);
    free(s);
}

static void step(scene *s)
{
    patch_bay_step(&s->bay, &s->frame, &mapping, s->own, &s->below);
    patch_bay_params(&s->bay, s->own, s->out);
    s->frame.time_ns += 10000000;
}

static void settle(scene *s)
{
    for (int i = 0; i < 40; ++i)
        step(s);
}

static void a_star_pulls_both_sides_away_from_the_middle(void **state)
{
    (void)state;
    scene *s = begin();
    patch_connection *c = connect(s, PATCH_CONTACT, "fader 1", "mouth.corner.*");
    c->way[0] = 0.6f;
    c->way[1] = 0.8f;
    c->out[0] = 0.0;
    c->out[1] = 10.0;
    plug(s);
    s->value[0] = 1.0f;
    step(s);
    const mrt_pull *pull = &s->bay.pull[PATCH_INSTEAD];
    assert_int_equal(pull->mode, MRT_ANCHORED);
    assert_int_equal(pull->count, 2);
    assert_float_equal(pull->vector[0].end.x - pull->vector[0].start.x, 6.0f, 1e-4);
    assert_float_equal(pull->vector[1].end.x - pull->vector[1].start.x, -6.0f, 1e-4);
    assert_float_equal(pull->vector[1].end.y - pull->vector[1].start.y, 8.0f, 1e-4);
    assert_int_equal(s->bay.pull[PATCH_ADDED].mode, MRT_IDLE);
    end(s);
}

static void several_connections_add_up(void **state)
{
    (void)state;
    scene *s = begin();
    connect(s, PATCH_DOF, "fader 1", "jaw.open");
    connect(s, PATCH_DOF, "stick", "jaw.open")->out[0] = 0.0;
    s->of.connection[1].out[1] = 0.1;
    connect(s, PATCH_DOF, "stick", "skull.nod")->adds = true;
    plug(s);
    s->value[0] = 0.5f;
    s->value[1] = 1.0f;
    step(s);
    assert_float_equal(s->bay.pull[PATCH_INSTEAD].dof[JAW], 0.35f, 1e-6);
    assert_true(isnan(s->bay.pull[PATCH_INSTEAD].dof[NOD]));
    assert_float_equal(s->bay.pull[PATCH_ADDED].dof[NOD], 0.6f, 1e-6);
    end(s);
}

static void parameters_are_replaced_stepped_and_pressed(void **state)
{
    (void)state;
    scene *s = begin();
    connect(s, PATCH_PARAM, "fader 1", "gain");
    connect(s, PATCH_PARAM, "fader 1", "mode");
    connect(s, PATCH_PARAM, "button", "teach");
    plug(s);
    step(s);
    assert_float_equal(s->out[0], 0.0, 1e-12); /* the fader is down */
    s->value[0] = 0.7f;
    s->value[2] = 1.0f;
    step(s);
    assert_float_equal(s->out[0], 7.0, 1e-6);
    assert_float_equal(s->out[1], 1.0, 0.0); /* 1.4 */
    assert_float_equal(s->out[2], 1.0, 0.0);
    step(s);
    assert_float_equal(s->out[2], 0.0, 0.0); /* held down: pressed once */
    s->of.connection[0].adds = true;
    plug(s);
    step(s);
    assert_float_equal(s->out[0], 9.0, 1e-6);
    s->value[0] = 1.0f;
    step(s);
    assert_float_equal(s->out[0], 10.0, 0.0); /* its largest */
    end(s);
}

/* What is seen of everything that moves the jaw in a step. */
static double seen_jaw(const patch_bay *bay, double mapped)
{
    double w = patch_bay_weight(bay), cover = 0.0, sum = 0.0;
    float now = bay->pull[PATCH_INSTEAD].dof[JAW], then = bay->leaving[PATCH_INSTEAD].dof[JAW];
    if (!isnan(now)) {
        cover += w;
        sum += w * (double)now;
    }
    if (!isnan(then)) {
        cover += 1.0 - w;
        sum += (1.0 - w) * (double)then;
    }
    return sum + (1.0 - fmin(cover, 1.0)) * mapped;
}

static void nothing_jumps_when_the_patch_or_its_inputs_change(void **state)
{
    (void)state;
    scene *s = begin();
    const double mapped = 0.1, most = 0.5 * 0.01 / PATCH_FADE_S + 1e-6;
    double before = mapped;
    connect(s, PATCH_DOF, "fader 1", "jaw.open");
    plug(s);
    s->value[0] = 1.0f;
    s->frame.input_count = 0; /* not heard yet */
    for (int i = 0; i < 300; ++i) {
        if (i == 20)
            s->frame.input_count = 1;
        if (i == 100) {
            s->of.connection[0].out[0] = 0.0;
            s->of.connection[0].out[1] = 0.2;
            plug(s);
        }
        if (i == 200) {
            s->of.count = 0;
            plug(s);
        }
        step(s);
        double now = seen_jaw(&s->bay, mapped);
        assert_true(fabs(now - before) <= most);
        if (i == 99)
            assert_float_equal(now, 0.5, 1e-6);
        if (i == 199)
            assert_float_equal(now, 0.2, 1e-6);
        before = now;
    }
    assert_float_equal(before, mapped, 1e-12);
    end(s);
}

static void while_one_change_comes_the_next_waits(void **state)
{
    (void)state;
    scene *s = begin();
    error err = {""};
    patch_plan *plan, *old;
    connect(s, PATCH_DOF, "fader 1", "jaw.open");
    plug(s);
    step(s);
    assert_true(s->bay.is_fading);
    assert_int_equal(patch_plan_create(&plan, &s->of, &about, NULL, NULL, &err), MRT_OK);
    assert_false(patch_bay_set(&s->bay, plan, &old));
    settle(s);
    assert_true(patch_bay_set(&s->bay, plan, &old));
    patch_plan_destroy(old);
    end(s);
}

static void what_is_kept_goes_on_with_the_same_bits(void **state)
{
    (void)state;
    scene *a = begin(), *b = begin();
    unsigned char bytes[16384];
    for (int k = 0; k < 2; ++k) {
        scene *s = k ? b : a;
        connect(s, PATCH_DOF, "fader 1", "jaw.open")->smooth_s = 0.1;
        connect(s, PATCH_CONTACT, "stick", "chin")->adds = true;
        connect(s, PATCH_PARAM, "stick", "gain")->picks_up = true;
        connect(s, PATCH_ACTION, "button", "mark");
        plug(s);
    }
    for (int i = 0; i < 200; ++i) {
        a->value[0] = (float)(i % 17) / 17.0f;
        a->value[1] = (float)(i % 41) / 20.0f - 1.0f;
        a->value[2] = i % 30 > 20 ? 1.0f : 0.0f;
        step(a);
        if (i == 7 || i == 60) { /* while it fades, and later */
            size_t size = patch_bay_save(&a->bay, bytes, sizeof bytes);
            assert_in_range(size, 1, sizeof bytes);
            assert_true(patch_bay_load(&b->bay, bytes, size));
            b->frame = a->frame;
            b->frame.inputs = &b->input;
        }
        if (i < 7 || i == 60 || i == 7)
            continue;
        memcpy(b->value, a->value, sizeof a->value);
        step(b);
        assert_memory_equal(a->bay.pull, b->bay.pull, sizeof a->bay.pull);
        assert_memory_equal(a->out, b->out, sizeof a->out);
        assert_memory_equal(a->bay.presses, b->bay.presses, sizeof a->bay.presses);
    }
    /* Another patch's bytes, and damaged ones. */
    size_t size = patch_bay_save(&a->bay, bytes, sizeof bytes);
    for (size_t i = 0; i < size; i += 3)
        assert_false(patch_bay_load(&b->bay, bytes, i));
    b->of.connection[0].smooth_s = 0.2;
    settle(b);
    plug(b);
    assert_false(patch_bay_load(&b->bay, bytes, size));
    end(a);
    end(b);
}

static void presses_of_the_transport_are_counted(void **state)
{
    (void)state;
    scene *s = begin();
    connect(s, PATCH_ACTION, "button", "record");
    plug(s);
    for (int i = 0; i < 60; ++i) {
        s->value[2] = i % 20 > 10 ? 1.0f : 0.0f;
        step(s);
    }
    assert_int_equal(s->bay.pressed[PATCH_RECORD], 3);
    assert_int_equal(s->bay.pressed[PATCH_STOP], 0);
    assert_int_equal(s->bay.pull[PATCH_INSTEAD].mode, MRT_IDLE);
    end(s);
}

static void what_a_face_has_not_is_noted_and_left_out(void **state)
{
    (void)state;
    scene *s = begin();
    error err = {""};
    patch_plan *plan;
    connect(s, PATCH_DOF, "fader 1", "tail.wag");
    connect(s, PATCH_CONTACT, "fader 1", "mouth.*");
    connect(s, PATCH_POSE, "fader 1", "joy");
    connect(s, PATCH_PARAM, "fader 1", "waldo");
    assert_int_equal(patch_plan_create(&plan, &s->of, &about, NULL, NULL, &err), MRT_OK);
    patch_plan_check_params(plan, &mapping);
    assert_non_null(strstr(patch_plan_note(plan), "no degree of freedom \"tail.wag\""));
    assert_non_null(strstr(patch_plan_note(plan), "no contact \"mouth.*\""));
    assert_non_null(strstr(patch_plan_note(plan), "no pose \"joy\""));
    assert_non_null(strstr(patch_plan_note(plan), "no parameter \"waldo\""));
    patch_plan *old;
    assert_true(patch_bay_set(&s->bay, plan, &old));
    s->value[0] = 1.0f;
    step(s);
    assert_int_equal(s->bay.pull[PATCH_INSTEAD].count, 0);
    assert_float_equal(s->out[0], s->own[0], 0.0);
    end(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_star_pulls_both_sides_away_from_the_middle),
        cmocka_unit_test(several_connections_add_up),
        cmocka_unit_test(parameters_are_replaced_stepped_and_pressed),
        cmocka_unit_test(nothing_jumps_when_the_patch_or_its_inputs_change),
        cmocka_unit_test(while_one_change_comes_the_next_waits),
        cmocka_unit_test(what_is_kept_goes_on_with_the_same_bits),
        cmocka_unit_test(presses_of_the_transport_are_counted),
        cmocka_unit_test(what_a_face_has_not_is_noted_and_left_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
