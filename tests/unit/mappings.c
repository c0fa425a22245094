/* plugins/anchored and plugins/unanchored, as loaded from the build: what a performer relies on. */
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
#include <stdlib.h>
#include <string.h>

/* A mapping at work on a face of 150 x 300 x 150 mm, with hands that the test poses. */
typedef struct rig {
    plugin_list plugins;
    instance plugin;
    const mrt_mapping *functions;
    mrt_frame frame;
    mrt_pull pull;
    hand_skeleton *skeleton[2];
} rig;

static const mrt_face face = {.low = {-75, 0, -75}, .high = {75, 300, 75}};

static void set_up(rig *r, const char *name, const char *params)
{
    char path[1024];
    error err = {""};
    const mrt_plugin_type *type;
    *r = (rig){.pull = {.mode = 0}};
    snprintf(path, sizeof path, "%s/plugins/%s.so", BUILD_DIR, name);
    assert_int_equal(plugin_list_add(&r->plugins, path, &err), MRT_OK);
    assert_int_equal(plugin_list_find(&r->plugins, name, MRT_MAPPING, &type, &err), MRT_OK);
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

/* One frame, 10 ms later, with all finger joints of a hand bent by `bend` rad. */
static mrt_result step(rig *r, uint32_t side, float bend)
{
    static const int flexions[] = {1, 2, 4, 5, 6, 7, 8, 9, 11, 12, 13, 15, 16, 17};
    mrt_hand *hand = &r->frame.hand[side];
    memset(hand->angle, 0, sizeof hand->angle);
    for (size_t i = 0; i < sizeof flexions / sizeof flexions[0]; ++i)
        hand->angle[flexions[i]] = bend;
    rigid wrist = rigid_identity();
    hand_pose(r->skeleton[side], hand->angle, &wrist, hand->joint, hand->palm);
    hand->present = true;
    r->frame.dt_s = r->frame.time_ns ? 0.01 : 0.0;
    r->frame.time_ns += 10000000;
    instance_latch(&r->plugin);
    r->frame.params = r->plugin.params;
    return r->functions->process(r->plugin.self, &r->frame, &r->pull);
}

static void trigger(rig *r, const char *name)
{
    for (uint32_t i = 0; i < r->plugin.type->param_count; ++i)
        if (strcmp(r->plugin.type->params[i].name, name) == 0)
            instance_trigger(&r->plugin, i);
}

static float length_of(const mrt_vector *v)
{
    float x = v->end.x - v->start.x, y = v->end.y - v->start.y, z = v->end.z - v->start.z;
    return sqrtf(x * x + y * y + z * z);
}

static float longest(const mrt_pull *pull)
{
    float out = 0;
    for (uint32_t i = 0; i < pull->count; ++i)
        out = fmaxf(out, length_of(&pull->vector[i]));
    return out;
}

/* ---- anchored ---- */

static void anchored_starts_stay_until_the_anchor_changes(void **state)
{
    (void)state;
    rig r;
    set_up(&r, "anchored", "");
    assert_int_equal(step(&r, MRT_RIGHT, 0.2f), MRT_OK);
    assert_int_equal(r.pull.mode, MRT_ANCHORED);
    assert_int_equal(r.pull.count, 5);
    assert_true(longest(&r.pull) <= 0.0f);
    mrt_pull first = r.pull;
    for (int i = 0; i < 20; ++i) {
        assert_int_equal(step(&r, MRT_RIGHT, 0.2f + 0.03f * (float)i), MRT_OK);
        assert_int_equal(r.pull.anchor, first.anchor);
        for (uint32_t k = 0; k < 5; ++k)
            assert_memory_equal(&r.pull.vector[k].start, &first.vector[k].start, sizeof(mrt_vec3));
    }
    assert_true(longest(&r.pull) > 5.0f);
    tear_down(&r);
}

static void anchored_pull_never_exceeds_its_reach(void **state)
{
    (void)state;
    rig r;
    set_up(&r, "anchored", "reach=30,radius=25,gain=4");
    (void)step(&r, MRT_RIGHT, 0.0f);
    (void)step(&r, MRT_RIGHT, 1.5f);
    assert_true(longest(&r.pull) > 0.29f * 75.0f && longest(&r.pull) < 0.3f * 75.0f + 1e-3f);
    tear_down(&r);
}

/* Whatever the other parameters say, and all of the hand's way. */
static void preset_paper_is_the_paper_to_the_letter(void **state)
{
    (void)state;
    for (int is_free = 0; is_free < 2; ++is_free) {
        rig r;
        const char *name = is_free ? "unanchored" : "anchored";
        set_up(&r, name, "preset=paper,radius_mm=60,gain=0.1");
        (void)step(&r, MRT_RIGHT, 0.0f);
        (void)step(&r, MRT_RIGHT, 1.5f);
        assert_true(longest(&r.pull) > 60.0f); /* a soft reach ends at 22 */
        assert_int_equal(r.pull.solve, MRT_SOLVE_LINEAR | MRT_SOLVE_ONCE);
        assert_true(r.pull.stretch_most < 0.0f);
        assert_true(fabsf(r.pull.radius_mm - 60.0f) < 1e-3f);
        tear_down(&r);
        set_up(&r, name, "");
        (void)step(&r, MRT_RIGHT, 0.0f);
        assert_int_equal(r.pull.solve, 0);
        assert_true(fabsf(r.pull.stretch_most - 8.0f) < 1e-6f);
        assert_true(fabsf(r.pull.radius_mm - 75.0f) < 1e-3f);
        tear_down(&r);
    }
}

static void anchored_waits_at_the_gate(void **state)
{
    (void)state;
    rig r;
    set_up(&r, "anchored", "gate=1");
    r.frame.near = false;
    for (int i = 0; i < 5; ++i) {
        (void)step(&r, MRT_RIGHT, 0.1f * (float)i);
        assert_int_equal(r.pull.mode, MRT_IDLE);
        assert_int_equal(r.pull.gate, 1);
        assert_true(r.pull.count == 5 && longest(&r.pull) <= 0.0f); /* what the host probes */
    }
    r.frame.near = true;
    (void)step(&r, MRT_RIGHT, 0.5f);
    assert_int_equal(r.pull.mode, MRT_ANCHORED);
    assert_true(longest(&r.pull) <= 0.0f);
    tear_down(&r);
}

static void anchored_reengage_starts_where_the_hand_is(void **state)
{
    (void)state;
    rig r;
    set_up(&r, "anchored", "");
    (void)step(&r, MRT_RIGHT, 0.1f);
    (void)step(&r, MRT_RIGHT, 0.6f);
    uint32_t anchor = r.pull.anchor;
    trigger(&r, "Engage");
    (void)step(&r, MRT_RIGHT, 0.6f);
    assert_int_not_equal(r.pull.anchor, anchor);
    assert_true(longest(&r.pull) <= 0.0f);
    (void)step(&r, MRT_RIGHT, 0.6f); /* a trigger is one call long */
    assert_int_equal(r.pull.anchor, anchor + 1);
    tear_down(&r);
}

static void anchored_commit_asks_for_a_new_base_and_engages_anew(void **state)
{
    (void)state;
    rig r;
    set_up(&r, "anchored", "commit_pedal=2");
    (void)step(&r, MRT_RIGHT, 0.1f);
    (void)step(&r, MRT_RIGHT, 0.6f);
    mrt_pull before = r.pull;
    r.frame.pedal[1] = 1.0f;
    for (int i = 0; i < 3; ++i) /* held down: one press */
        (void)step(&r, MRT_RIGHT, 0.6f);
    assert_int_equal(r.pull.commit, before.commit + 1);
    assert_int_equal(r.pull.anchor, before.anchor + 1);
    assert_true(longest(&r.pull) <= 0.0f);
    tear_down(&r);
}

static void anchored_release_holds_or_springs_back_without_a_jump(void **state)
{
    (void)state;
    rig r;
    set_up(&r, "anchored", "on_release=hold");
    (void)step(&r, MRT_RIGHT, 0.1f);
    (void)step(&r, MRT_RIGHT, 0.7f);
    mrt_pull held = r.pull;
    trigger(&r, "Release");
    for (int i = 0; i < 10; ++i) {
        (void)step(&r, MRT_RIGHT, 0.1f * (float)i);
        assert_memory_equal(r.pull.vector, held.vector, 5 * sizeof(mrt_vector));
    }
    tear_down(&r);

    set_up(&r, "anchored", "on_release=spring_back,release_time=0.25");
    (void)step(&r, MRT_RIGHT, 0.1f);
    (void)step(&r, MRT_RIGHT, 0.7f);
    float before = longest(&r.pull), biggest_step = 0;
    float full = before;
    trigger(&r, "Release");
    for (int i = 0; i < 30; ++i) {
        (void)step(&r, MRT_RIGHT, 1.2f); /* the hand goes on; the face does not care */
        float now = longest(&r.pull);
        assert_true(now <= before + 1e-4f);
        biggest_step = fmaxf(biggest_step, before - now);
        before = now;
    }
    assert_true(before <= 0.0f);              /* back at the starts */
    assert_true(biggest_step < 0.09f * full); /* 1.875 x 10 ms / 250 ms, minimum jerk */
    tear_down(&r);
}

static void anchored_leak_eases_a_held_pull_away(void **state)
{
    (void)state;
    rig r;
    set_up(&r, "anchored", "leak=0.5,gain=0.1,reach=100"); /* far from the reach: linear */
    (void)step(&r, MRT_RIGHT, 0.1f);
    (void)step(&r, MRT_RIGHT, 0.4f);
    float first = longest(&r.pull);
    for (int i = 0; i < 50; ++i) /* one time constant */
        (void)step(&r, MRT_RIGHT, 0.4f);
    assert_true(fabsf(longest(&r.pull) / first - 0.3678f) < 0.02f);
    tear_down(&r);
}

static void both_hands_and_palms_pull_with_all_their_points(void **state)
{
    (void)state;
    rig r;
    set_up(&r, "anchored", "palm=on,hands=both,apart=100");
    (void)step(&r, MRT_RIGHT, 0.1f);
    assert_int_equal(r.pull.count, 13);
    (void)step(&r, MRT_LEFT, 0.1f); /* the left hand comes in: hold anew, nothing jumps */
    assert_int_equal(r.pull.count, 26);
    assert_true(longest(&r.pull) <= 0.0f);
    float apart = 0; /* the left hand lies on the subject's left: the face's width */
    for (int i = 0; i < 5; ++i)
        apart += (r.pull.vector[i].start.x - r.pull.vector[13 + i].start.x) / 5.0f;
    assert_true(fabsf(apart - 150.0f) < 0.01f);
    tear_down(&r);
}

static float distance_of(mrt_vec3 a, mrt_vec3 b)
{
    float x = a.x - b.x, y = a.y - b.y, z = a.z - b.z;
    return sqrtf(x * x + y * y + z * z);
}

/* Ten tips have ten places, whatever the head: narrow as a Moai, as wide as high, of a child. */
static void two_hands_stand_beside_each_other_on_any_face(void **state)
{
    (void)state;
    static const float width_and_height[][2] = {{130, 300}, {200, 300}, {300, 300}, {16, 24}};
    for (size_t k = 0; k < sizeof width_and_height / sizeof width_and_height[0]; ++k) {
        float half = 0.5f * width_and_height[k][0], height = width_and_height[k][1];
        mrt_face head = {.low = {-half, 0, -half}, .high = {half, height, half}};
        rig r;
        set_up(&r, "anchored", "");
        r.functions->deactivate(r.plugin.self);
        assert_int_equal(r.functions->activate(r.plugin.self, &head), MRT_OK);
        (void)step(&r, MRT_RIGHT, 0.6f);
        (void)step(&r, MRT_LEFT, 0.6f);
        assert_int_equal(r.pull.count, 10);
        for (int i = 0; i < 10; ++i) {
            mrt_vec3 tip = r.pull.vector[i].start;
            assert_true(i < 5 ? tip.x > 0.0f : tip.x < 0.0f); /* each hand on its own side */
            assert_true(fabsf(tip.x) < 1.25f * half);
            assert_true(tip.y > 0.1f * height && tip.y < 0.6f * height);
            for (int j = 0; j < i; ++j)
                assert_true(distance_of(tip, r.pull.vector[j].start) > 0.1f * half);
        }
        assert_true(distance_of(r.pull.vector[1].start, r.pull.vector[6].start) > 0.25f * half);
        tear_down(&r);
    }
}

/* Where two hands are laid onto each other, opposite tips take one place and do not fight for it:
 * they follow the mean of what they do. */
static void tips_too_near_to_each_other_share_a_place(void **state)
{
    (void)state;
    static const char *const names[] = {"anchored", "unanchored"};
    for (int k = 0; k < 2; ++k) {
        rig r;
        set_up(&r, names[k], "apart=0.01,roll=90,gain=1");
        (void)step(&r, MRT_RIGHT, 0.3f);
        (void)step(&r, MRT_LEFT, 0.3f);
        (void)step(&r, MRT_RIGHT, 0.3f);
        (void)step(&r, MRT_RIGHT, 0.4f); /* one hand moves, the other stays */
        assert_int_equal(r.pull.count, 10);
        int shared_count = 0;
        for (int i = 0; i < 5; ++i)
            for (int j = 5; j < 10; ++j) {
                mrt_vector a = r.pull.vector[i], b = r.pull.vector[j];
                if (distance_of(a.start, b.start) > 0.0f) {
                    assert_true(distance_of(a.start, b.start) > 8.0f);
                    continue;
                }
                ++shared_count;
                assert_true(distance_of(a.end, b.end) <= 0.0f);
                assert_true(length_of(&a) > 0.1f);
            }
        assert_true(shared_count > 0);
        tear_down(&r);
    }
}

static void left_hand_mirrors_the_right_one(void **state)
{
    (void)state;
    mrt_pull pulls[2];
    for (uint32_t side = 0; side < 2; ++side) {
        rig r;
        set_up(&r, "anchored", "yaw=20,pitch=10,roll=-60,palm=on");
        (void)step(&r, side, 0.1f);
        (void)step(&r, side, 0.6f);
        pulls[side] = r.pull;
        tear_down(&r);
    }
    assert_int_equal(pulls[0].count, 13);
    for (uint32_t i = 0; i < 13; ++i) {
        mrt_vec3 left = pulls[MRT_LEFT].vector[i].end, right = pulls[MRT_RIGHT].vector[i].end;
        assert_true(fabsf(left.x + right.x) < 1e-3f);
        assert_true(fabsf(left.y - right.y) < 1e-3f && fabsf(left.z - right.z) < 1e-3f);
    }
}

static void hand_is_laid_where_the_placement_says(void **state)
{
    (void)state;
    static const char *const postures[] = {
        "up=60,across=50,depth=90,posture=in_the_head",
        "up=60,across=50,depth=90,posture=before_the_face,pitch=20,yaw=-30,roll=130"};
    for (int k = 0; k < 2; ++k) {
        rig r;
        set_up(&r, "anchored", postures[k]);
        (void)step(&r, MRT_RIGHT, 0.2f);
        mrt_vec3 centre = {0, 0, 0};
        for (int i = 0; i < 5; ++i) {
            centre.x += r.pull.vector[i].start.x / 5;
            centre.y += r.pull.vector[i].start.y / 5;
            centre.z += r.pull.vector[i].start.z / 5;
        }
        assert_true(fabsf(centre.x) < 1e-3f);
        assert_true(fabsf(centre.y - 180.0f) < 1e-3f);
        assert_true(fabsf(centre.z - 60.0f) < 1e-3f);
        tear_down(&r);
    }
}

/* ---- unanchored ---- */

static void unanchored_goes_on_from_its_last_ends(void **state)
{
    (void)state;
    rig r;
    set_up(&r, "unanchored", "gain=1");
    (void)step(&r, MRT_RIGHT, 0.2f);
    assert_int_equal(r.pull.mode, MRT_UNANCHORED);
    assert_true(longest(&r.pull) <= 0.0f);
    for (int i = 1; i < 20; ++i) {
        mrt_pull before = r.pull;
        (void)step(&r, MRT_RIGHT, 0.2f + 0.04f * (float)i);
        assert_int_equal(r.pull.count, 5);
        for (uint32_t k = 0; k < 5; ++k)
            assert_memory_equal(&r.pull.vector[k].start, &before.vector[k].end, sizeof(mrt_vec3));
        assert_true(longest(&r.pull) > 0.1f);
    }
    tear_down(&r);
}

static void unanchored_release_lets_go_and_touch_moves_nothing_first(void **state)
{
    (void)state;
    rig r;
    set_up(&r, "unanchored",
           "on_release=spring_back,release_time=0.3,engage_pedal=1,release_pedal=2");
    (void)step(&r, MRT_RIGHT, 0.2f);
    (void)step(&r, MRT_RIGHT, 0.3f);
    assert_true(r.pull.leak_per_s <= 0.0f);
    r.frame.pedal[1] = 1.0f;
    (void)step(&r, MRT_RIGHT, 0.4f);
    assert_int_equal(r.pull.count, 0);
    assert_true(fabsf(r.pull.leak_per_s - 10.0f) < 1e-4f);
    r.frame.pedal[0] = 1.0f;
    (void)step(&r, MRT_RIGHT, 0.9f);
    assert_int_equal(r.pull.count, 5);
    assert_true(longest(&r.pull) <= 0.0f && r.pull.leak_per_s <= 0.0f);
    tear_down(&r);
}

static void mappings_are_functions_of_their_frames(void **state)
{
    (void)state;
    static const char *const names[] = {"anchored", "unanchored"};
    for (int k = 0; k < 2; ++k) {
        mrt_pull ends[2];
        rig r;
        set_up(&r, names[k], "");
        for (int run = 0; run < 2; ++run) { /* again after a reset: the same bits */
            r.functions->reset(r.plugin.self);
            memset(&r.pull, 0, sizeof r.pull);
            memset(&r.frame, 0, sizeof r.frame);
            r.frame.near = true;
            for (int i = 0; i < 40; ++i)
                (void)step(&r, MRT_RIGHT, 0.5f + 0.4f * (float)((i * 7) % 11) / 11.0f);
            ends[run] = r.pull;
        }
        assert_memory_equal(&ends[0], &ends[1], sizeof ends[0]);
        tear_down(&r);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(anchored_starts_stay_until_the_anchor_changes),
        cmocka_unit_test(anchored_pull_never_exceeds_its_reach),
        cmocka_unit_test(preset_paper_is_the_paper_to_the_letter),
        cmocka_unit_test(anchored_waits_at_the_gate),
        cmocka_unit_test(anchored_reengage_starts_where_the_hand_is),
        cmocka_unit_test(anchored_commit_asks_for_a_new_base_and_engages_anew),
        cmocka_unit_test(anchored_release_holds_or_springs_back_without_a_jump),
        cmocka_unit_test(anchored_leak_eases_a_held_pull_away),
        cmocka_unit_test(both_hands_and_palms_pull_with_all_their_points),
        cmocka_unit_test(two_hands_stand_beside_each_other_on_any_face),
        cmocka_unit_test(tips_too_near_to_each_other_share_a_place),
        cmocka_unit_test(left_hand_mirrors_the_right_one),
        cmocka_unit_test(hand_is_laid_where_the_placement_says),
        cmocka_unit_test(unanchored_goes_on_from_its_last_ends),
        cmocka_unit_test(unanchored_release_lets_go_and_touch_moves_nothing_first),
        cmocka_unit_test(mappings_are_functions_of_their_frames),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
