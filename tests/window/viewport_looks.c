/* What lies over the face in the viewport: drawn without a word of complaint from OpenGL, and
 * pictures of it to be looked at. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "draw/gl.h"
#include "hand/hand.h"
#include "hand/sensor.h"
#include "viewport_stand.h"

#include <stdlib.h>
#include <string.h>

static viewport_stand s;

static void check_no_gl_error(void)
{
    error err = {{0}};
    if (gl_check_error("the viewport", &err) != MRT_OK)
        fail_msg("%s", err.text);
}

static void give_hand(uint32_t side, float thumb, bool present)
{
    float angle[MRT_ANGLES];
    for (int i = 0; i < MRT_ANGLES; ++i)
        angle[i] = sensor_table[i].neutral_rad;
    angle[SENSOR_THUMB_MPJ] -= thumb;
    hand_skeleton *skeleton = hand_skeleton_create(side, HAND_LENGTH_MM);
    assert_non_null(skeleton);
    const rigid still = rigid_identity();
    mrt_hand *hand = &s.view.hand[side];
    hand_pose(skeleton, angle, &still, hand->joint, hand->palm);
    hand->present = present;
    hand->time_ns = 1;
    hand_skeleton_destroy(skeleton);
}

static void smile(void)
{
    stand_pull(&s, "mouth.corner.l", 8, 9, -4);
    stand_pull(&s, "mouth.corner.r", -8, 9, -4);
    stand_pull(&s, "brow.inner.l", 0, 7, 0);
    stand_pull(&s, "brow.outer.r", 2, -6, 0);
    for (uint32_t i = 0; i < s.view.about->dof_count; ++i)
        if (strcmp(s.view.about->dofs[i].name, "jaw.open") == 0)
            s.view.pull.dof[i] = 0.30f;
    stand_perform(&s);
}

/* Where nobody looks at the pictures, a sixteenth of the pixels complains of the same. */
static void open_stage(const char *path, uint32_t width, uint32_t height, float scale)
{
    const uint32_t part = getenv("MAROTTE_PICTURES") ? 1 : 4;
    stand_open(&s, path, width / part, height / part, scale);
    stand_show(&s);
    smile();
}

static void the_face_alone(void **state)
{
    (void)state;
    open_stage("rigs/puppet/puppet.rig.json", 1280, 720, 1.0f);
    stand_picture(&s, "viewport_puppet");
    check_no_gl_error();
    stand_close(&s);
    open_stage("rigs/moai/moai.rig.json", 1280, 720, 1.0f);
    stand_picture(&s, "viewport_moai");
    check_no_gl_error();
    stand_close(&s);
}

static void everything_over_the_face(void **state)
{
    (void)state;
    open_stage("rigs/puppet/puppet.rig.json", 1280, 720, 1.0f);
    give_hand(MRT_LEFT, 0.0f, false);
    give_hand(MRT_RIGHT, 0.4f, true);
    s.looks.shows_hands = s.looks.shows_vectors = true;
    stand_picture(&s, "viewport_hands_vectors");
    s.looks.shows_hands = false;
    s.looks.shows_supports = s.looks.shows_jaw = true;
    stand_picture(&s, "viewport_supports_jaw");
    s.looks.shows_vectors = s.looks.shows_supports = s.looks.shows_jaw = false;
    s.looks.shows_contacts = true;
    stand_picture(&s, "viewport_contacts");
    s.looks.is_mirrored = true;
    s.asked[ACTION_VIEW_THREE_QUARTER] = true;
    stand_frames(&s, 15);
    stand_picture(&s, "viewport_contacts_mirrored");
    check_no_gl_error();
    stand_close(&s);
}

static void heat_maps(void **state)
{
    (void)state;
    static const char *const name[APP_HEATS] = {"", "viewport_weights", "viewport_mobility",
                                                "viewport_strain", "viewport_skull"};
    open_stage("rigs/puppet/puppet.rig.json", 1280, 720, 1.0f);
    for (int heat = APP_HEAT_WEIGHTS; heat < APP_HEATS; ++heat) {
        s.looks.heat = (app_heat)heat;
        stand_picture(&s, name[heat]);
    }
    check_no_gl_error();
    stand_close(&s);
}

static void the_hand_keys_on_a_large_screen(void **state)
{
    (void)state;
    open_stage("rigs/puppet/puppet.rig.json", 2560, 1440, 2.0f);
    give_hand(MRT_RIGHT, 0.4f, true);
    s.looks.shows_hands = true;
    s.has_hand_keys = true;
    stand_key(&s, ' ', true);
    stand_picture(&s, "viewport_hand_keys_2560");
    check_no_gl_error();
    stand_key(&s, ' ', false);
    stand_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_face_alone),
        cmocka_unit_test(everything_over_the_face),
        cmocka_unit_test(heat_maps),
        cmocka_unit_test(the_hand_keys_on_a_large_screen),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
