/* plugins/anchored: fingers that are linked to contacts of the face (learn mode sets them). */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "hand/hand.h"
#include "stage/mapping/instance.h"
#include "stage/mapping/plugins.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const mrt_contact contact[3] = {
    {"brow", "skull", {10, 200, 70}, {0, 0, 1}},
    {"mouth.corner.l", "skull", {25, 90, 65}, {0, 0, 1}},
    {"mouth.corner.r", "skull", {-25, 90, 65}, {0, 0, 1}},
};
static const mrt_face face = {
    .contacts = contact, .contact_count = 3, .low = {-75, 0, -75}, .high = {75, 300, 75}};

typedef struct rig {
    plugin_list plugins;
    instance plugin;
    const mrt_mapping *functions;
    mrt_frame frame;
    mrt_pull pull;
    hand_skeleton *skeleton[2];
} rig;

static void set_up(rig *r, const char *params)
{
    error err = {""};
    const mrt_plugin_type *type;
    *r = (rig){.pull = {.mode = 0}};
    assert_int_equal(plugin_list_add(&r->plugins, BUILD_DIR "/plugins/anchored.so", &err), MRT_OK);
    assert_int_equal(plugin_list_find(&r->plugins, "anchored", MRT_MAPPING, &type, &err), MRT_OK);
    assert_int_equal(instance_create(&r->plugin, type, CLOCK_VIRTUAL, NULL, &err), MRT_OK);
    if (instance_set_list(&r->plugin, params, &err) < 0)
        fail_msg("%s", err.text);
    r->functions = plugin_interface(type, MRT_MAPPING);
    assert_int_equal(r->functions->activate(r->plugin.self, &face), MRT_OK);
    r->functions->reset(r->plugin.self);
    for (uint32_t side = 0; side < 2; ++side)
        r->skeleton[side] = hand_skeleton_create(side, 190);
    for (int i = 0; i < MRT_MAX_DOFS; ++i)
        r->pull.dof[i] = NAN;
    r->frame.near = true;
}

static void tear_down(rig *r)
{
    r->functions->deactivate(r->plugin.self);
    instance_destroy(&r->plugin);
    plugin_list_destroy(&r->plugins);
    for (int side = 0; side < 2; ++side)
        hand_skeleton_destroy(r->skeleton[side]);
}

static void pose(rig *r, uint32_t side, float index_bend)
{
    mrt_hand *hand = &r->frame.hand[side];
    memset(hand->angle, 0, sizeof hand->angle);
    hand->angle[4] = hand->angle[5] = index_bend;
    rigid wrist = rigid_identity();
    hand_pose(r->skeleton[side], hand->angle, &wrist, hand->joint, hand->palm);
    hand->present = true;
}

static void step(rig *r)
{
    r->frame.dt_s = r->frame.time_ns ? 0.01 : 0.0;
    r->frame.time_ns += 10000000;
    instance_latch(&r->plugin);
    r->frame.params = r->plugin.params;
    assert_int_equal(r->functions->process(r->plugin.self, &r->frame, &r->pull), MRT_OK);
}

static void set(rig *r, const char *list)
{
    error err = {""};
    if (instance_set_list(&r->plugin, list, &err) < 0)
        fail_msg("%s", err.text);
}

static void assert_rests(const mrt_vector *v)
{
    assert_memory_equal(&v->start, &v->end, sizeof v->start);
}

static void a_linked_finger_pulls_its_contact_from_its_rest(void **state)
{
    (void)state;
    rig r;
    set_up(&r, "right_index=2");
    pose(&r, MRT_RIGHT, 0.0f);
    step(&r);
    assert_int_equal(r.pull.vector[1].contact, 2);
    assert_memory_equal(&r.pull.vector[1].start, &contact[1].rest, sizeof(mrt_vec3));
    assert_rests(&r.pull.vector[1]);
    pose(&r, MRT_RIGHT, 0.6f);
    step(&r);
    assert_memory_equal(&r.pull.vector[1].start, &contact[1].rest, sizeof(mrt_vec3));
    float moved = fabsf(r.pull.vector[1].end.x - r.pull.vector[1].start.x) +
                  fabsf(r.pull.vector[1].end.y - r.pull.vector[1].start.y);
    assert_true(moved > 3.0f);
    for (uint32_t i = 0; i < 5; ++i)
        if (i != 1)
            assert_int_equal(r.pull.vector[i].contact, 0);
    tear_down(&r);
}

static void linking_while_it_pulls_takes_hold_anew_and_moves_nothing(void **state)
{
    (void)state;
    rig r;
    set_up(&r, "");
    pose(&r, MRT_RIGHT, 0.0f);
    step(&r);
    pose(&r, MRT_RIGHT, 0.6f);
    step(&r);
    uint32_t anchor = r.pull.anchor;
    set(&r, "right_index=3");
    step(&r);
    assert_int_equal(r.pull.anchor, anchor + 1);
    assert_int_equal(r.pull.vector[1].contact, 3);
    for (uint32_t i = 0; i < r.pull.count; ++i)
        assert_rests(&r.pull.vector[i]);
    step(&r);
    assert_int_equal(r.pull.anchor, anchor + 1);
    set(&r, "right_index=0");
    step(&r);
    assert_int_equal(r.pull.anchor, anchor + 2);
    assert_int_equal(r.pull.vector[1].contact, 0);
    tear_down(&r);
}

static void each_hand_has_links_of_its_own(void **state)
{
    (void)state;
    rig r;
    set_up(&r, "right_thumb=3,left_thumb=2,palm=on");
    pose(&r, MRT_LEFT, 0.0f);
    pose(&r, MRT_RIGHT, 0.0f);
    step(&r);
    assert_int_equal(r.pull.count, 2 * (5 + MRT_PALM));
    assert_int_equal(r.pull.vector[0].contact, 2);
    assert_int_equal(r.pull.vector[5 + MRT_PALM].contact, 3);
    for (uint32_t i = 1; i < r.pull.count; ++i)
        if (i != 5 + MRT_PALM)
            assert_int_equal(r.pull.vector[i].contact, 0);
    set(&r, "hands=right");
    step(&r);
    assert_int_equal(r.pull.vector[0].contact, 3);
    tear_down(&r);
}

static void a_contact_that_the_face_lacks_is_no_link(void **state)
{
    (void)state;
    rig r;
    set_up(&r, "right_ring=4,left_ring=256");
    pose(&r, MRT_RIGHT, 0.0f);
    pose(&r, MRT_LEFT, 0.0f);
    for (int i = 0; i < 3; ++i)
        step(&r);
    assert_int_equal(r.pull.anchor, 1);
    for (uint32_t i = 0; i < r.pull.count; ++i)
        assert_int_equal(r.pull.vector[i].contact, 0);
    tear_down(&r);
}

/* A hand far from the face can hold a contact: at the gate it is the contact that is near. */
static void a_linked_finger_passes_the_gate_at_its_contact(void **state)
{
    (void)state;
    rig r;
    set_up(&r, "right_middle=1,gate=on");
    r.frame.near = false;
    pose(&r, MRT_RIGHT, 0.0f);
    step(&r);
    assert_int_equal(r.pull.mode, MRT_IDLE);
    assert_memory_equal(&r.pull.vector[2].end, &contact[0].rest, sizeof(mrt_vec3));
    tear_down(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_linked_finger_pulls_its_contact_from_its_rest),
        cmocka_unit_test(linking_while_it_pulls_takes_hold_anew_and_moves_nothing),
        cmocka_unit_test(each_hand_has_links_of_its_own),
        cmocka_unit_test(a_contact_that_the_face_lacks_is_no_link),
        cmocka_unit_test(a_linked_finger_passes_the_gate_at_its_contact),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
