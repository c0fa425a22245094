/* Bones, ellipsoids, poses and the mouth of a rig as a person adds, names and takes them out: what
 * is written is read again as it was meant, what rides on something that goes rides on, and what
 * makes no sense is refused and changes nothing. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "base/file.h"
#include "face/rig_edit.h"
#include "rig_help.h"

#include <math.h>
#include <unistd.h>

static char folder[64];

static int make_folder(void **state)
{
    (void)state;
    strcpy(folder, "/tmp/marotte_parts_XXXXXX");
    return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void **state)
{
    (void)state;
    char command[128];
    (void)snprintf(command, sizeof command, "rm -r %s", folder);
    return system(command);
}

static void must(mrt_result result, const error *err)
{
    if (result < 0)
        fail_msg("%s", err->text);
}

/* Refused, with a line that says why. */
static void refused(mrt_result result, const error *err, const char *why)
{
    assert_true(result < 0);
    if (!strstr(err->text, why))
        fail_msg("\"%s\" does not say \"%s\"", err->text, why);
}

static const char body[] =
    "\"bones\": [{\"name\": \"skull\"},"
    " {\"name\": \"jaw\", \"hinge\": {\"left\": [50, 0, 0], \"right\": [-50, 0, 0]}},"
    " {\"name\": \"tongue\", \"parent\": \"jaw\"}],"
    "\"regions\": [{\"bone\": \"jaw\", \"weight\": 1, \"select\": {\"vertices\": [20]}},"
    " {\"bone\": \"tongue\", \"rigid\": true, \"select\": {\"vertices\": [3]}},"
    " {\"mobility\": 1, \"select\": {\"vertices\": [4]}}],"
    "\"contacts\": [{\"name\": \"tip\", \"vertex\": 4, \"bone\": \"tongue\"},"
    " {\"name\": \"brow\", \"vertex\": 0}],"
    "\"skull_proxy\": [{\"ellipsoid\": {\"centre\": [0, 1, 2], \"radii\": [3, 4, 5], "
    "\"bone\": \"skull\"}, \"who\": \"Ana\"},"
    " {\"ellipsoid\": {\"centre\": [6, 7, 8], \"radii\": [1, 1, 1], \"bone\": \"tongue\"}, "
    "\"who\": \"Bo\"}],"
    "\"poses\": [{\"name\": \"wide\", \"dofs\": {\"jaw.open\": 20, \"jaw.lateral\": 3},"
    " \"pulls\": {\"tip\": [0, 1, 0]}}]";

static void make(rig *out)
{
    error err = {""};
    must(rig_with(out, body, &err), &err);
}

/* Written, and read again in its place. */
static void again(rig *r)
{
    error err = {""};
    char path[128];
    (void)snprintf(path, sizeof path, "%s/a.rig.json", folder);
    must(rig_write(r, path, &err), &err);
    rig_destroy(r);
    must(rig_read_trusted(r, path, &err), &err);
}

/* ---- bones ---- */

static void an_eye_is_added_and_read_again(void **state)
{
    (void)state;
    rig r;
    error err = {""};
    uint32_t index = RIG_NONE;
    const vec3 at = {30, 40, 50};
    make(&r);
    must(rig_edit_add_bone(&r, "eye.l", BONE_BALL, at, 12.0, &index, &err), &err);
    assert_int_equal(index, 3);
    must(rig_edit_set_ball(&r, index, (vec3){31, 41, 51}, 13.0, &err), &err);
    again(&r);
    assert_int_equal(r.bone_count, 4);
    assert_string_equal(r.bone[3].name, "eye.l");
    assert_int_equal(r.bone[3].kind, BONE_BALL);
    assert_int_equal(r.bone[3].parent, 0);
    assert_float_equal(r.bone[3].centre.z, 51.0, 1e-9);
    assert_float_equal(r.bone[3].radius_mm, 13.0, 1e-9);
    assert_int_equal(r.bone[3].turn_count, 2);
    assert_true(r.bone[3].turn[0].max_rad > 0.3);
    assert_float_equal(r.bone[3].turn[1].axis.x, -1.0, 1e-9); /* pitch is positive upwards */
    rig_destroy(&r);
}

static void a_loose_part_swings_and_is_read_again(void **state)
{
    (void)state;
    rig r;
    error err = {""};
    uint32_t index = RIG_NONE;
    const rig_spring spring = {{0, 90, 0}, 2.5, 0.2, 0.5, 0.1, 8.0};
    rig_spring wrong = spring;
    make(&r);
    must(rig_edit_add_bone(&r, "hair", BONE_BALL, (vec3){0, 60, 0}, 12.0, &index, &err), &err);
    refused(rig_edit_set_spring(&r, 1, &spring, &err), &err, "not a ball");
    wrong.frequency_hz = (double)NAN;
    refused(rig_edit_set_spring(&r, index, &wrong, &err), &err, "0.2 to 20 Hz");
    wrong = spring;
    wrong.damping = -0.1;
    refused(rig_edit_set_spring(&r, index, &wrong, &err), &err, "a damping of 0.02 to 4");
    wrong = spring;
    wrong.tip = (vec3){0, 60, 0};
    refused(rig_edit_set_spring(&r, index, &wrong, &err), &err, "away from its centre");
    must(rig_edit_set_spring(&r, index, &spring, &err), &err);
    refused(rig_edit_set_springs(&r, 1.5, &err), &err, "from 0 to 1");
    must(rig_edit_set_springs(&r, 0.0, &err), &err);
    again(&r);
    const rig_spring *read = &r.bone[index].spring;
    assert_float_equal(read->tip.y, 90.0, 1e-9);
    assert_float_equal(read->frequency_hz, 2.5, 1e-9);
    assert_float_equal(read->damping, 0.2, 1e-9);
    assert_float_equal(read->inertia, 0.5, 1e-9);
    assert_float_equal(read->gravity, 0.1, 1e-9);
    assert_float_equal(read->radius_mm, 8.0, 1e-9);
    assert_true(r.springs == 0.0);
    must(rig_edit_set_spring(&r, index, &(rig_spring){.frequency_hz = 0.0}, &err), &err);
    again(&r);
    assert_true(r.bone[index].spring.frequency_hz == 0.0);
    rig_destroy(&r);
}

static const double degree = 3.14159265358979323846 / 180.0;

static void the_turns_of_a_ball_are_changed_and_read_again(void **state)
{
    (void)state;
    rig r;
    error err = {""};
    uint32_t index = RIG_NONE, bone = RIG_NONE;
    char name[] = "close", other[] = "roll";
    make(&r);
    must(rig_edit_add_bone(&r, "lid", BONE_BALL, (vec3){30, 40, 50}, 12.0, &bone, &err), &err);
    rig_turn to = {name, {0.0, 1.0, 1.0}, -12.3456 * degree, 50.0 * degree, {0}};
    must(rig_edit_set_turn(&r, bone, 0, &to, &err), &err);
    to = (rig_turn){other, {0.0, 0.0, 3.0}, 0.0, 10.0 * degree, {0}};
    must(rig_edit_add_turn(&r, bone, &to, &index, &err), &err);
    assert_int_equal(index, 2);
    must(rig_edit_remove_turn(&r, bone, 1, &err), &err);
    again(&r);
    const rig_bone *lid = &r.bone[bone];
    assert_int_equal(lid->turn_count, 2);
    assert_string_equal(lid->turn[0].name, "close");
    assert_float_equal(lid->turn[0].axis.y, sqrt(0.5), 1e-6);
    assert_float_equal(vec3_length(lid->turn[0].axis), 1.0, 1e-9);
    assert_float_equal((lid->turn[0].min_rad / degree), -12.35, 1e-9);
    assert_float_equal((lid->turn[0].max_rad / degree), 50.0, 1e-9);
    assert_string_equal(lid->turn[1].name, "roll");
    assert_float_equal(lid->turn[1].axis.z, 1.0, 1e-9);
    rig_destroy(&r);
}

static void poses_follow_a_turn_and_forget_it(void **state)
{
    (void)state;
    rig r;
    error err = {""};
    uint32_t bone = RIG_NONE, pose = RIG_NONE;
    char dof[] = "eye.yaw", *dofs[] = {dof}, pose_name[] = "aside", name[] = "look";
    double value = 12.3456 * degree;
    make(&r);
    must(rig_edit_add_bone(&r, "eye", BONE_BALL, (vec3){30, 40, 50}, 12.0, &bone, &err), &err);
    const rig_pose made = {
        .name = pose_name, .dof_name = dofs, .dof_value = &value, .dof_count = 1};
    must(rig_edit_add_pose(&r, &made, &pose, &err), &err);
    rig_turn to = r.bone[bone].turn[0];
    to.name = name;
    must(rig_edit_set_turn(&r, bone, 0, &to, &err), &err);
    again(&r);
    assert_string_equal(r.pose[pose].dof_name[0], "eye.look");
    assert_float_equal((r.pose[pose].dof_value[0] / degree), 12.35, 1e-9);
    must(rig_edit_remove_turn(&r, bone, 0, &err), &err);
    assert_int_equal(r.pose[pose].dof_count, 0);
    assert_int_equal(r.pose[0].dof_count, 2); /* the jaw's stay */
    again(&r);
    rig_destroy(&r);
}

static void a_lid_follows_a_turn_that_is_renamed_moved_and_taken_out(void **state)
{
    (void)state;
    rig r;
    error err = {""};
    uint32_t eye = RIG_NONE, lid = RIG_NONE;
    const vec3 at = {30, 40, 50};
    make(&r);
    must(rig_edit_add_bone(&r, "eye", BONE_BALL, at, 12.0, &eye, &err), &err);
    must(rig_edit_add_bone(&r, "lid", BONE_BALL, at, 12.0, &lid, &err), &err);
    rig_turn to = r.bone[lid].turn[1];
    to.follows = (rig_follow){eye, 1, -0.6};
    must(rig_edit_set_turn(&r, lid, 1, &to, &err), &err);
    to = r.bone[eye].turn[1];
    to.follows = (rig_follow){lid, 1, 0.5};
    refused(rig_edit_set_turn(&r, eye, 1, &to, &err), &err, "listed later");
    again(&r);
    assert_int_equal(r.bone[lid].turn[1].follows.bone, eye);
    assert_int_equal(r.bone[lid].turn[1].follows.turn, 1);
    assert_float_equal(r.bone[lid].turn[1].follows.share, -0.6, 1e-12);
    must(rig_edit_name_bone(&r, eye, "eye.l", &err), &err);
    must(rig_edit_remove_turn(&r, eye, 0, &err), &err);
    must(rig_edit_remove_bone(&r, 2, &err), &err); /* the tongue, before both */
    again(&r);
    eye -= 1;
    lid -= 1;
    assert_int_equal(r.bone[lid].turn[1].follows.bone, eye);
    assert_int_equal(r.bone[lid].turn[1].follows.turn, 0);
    must(rig_edit_remove_bone(&r, eye, &err), &err);
    again(&r);
    lid -= 1;
    assert_true(r.bone[lid].turn[1].follows.share == 0.0);
    rig_destroy(&r);
}

static void turns_that_make_no_sense_are_refused(void **state)
{
    (void)state;
    rig r;
    error err = {""};
    uint32_t bone = RIG_NONE, index = 77;
    char yaw[] = "yaw", none[] = "", third[] = "third", fourth[] = "fourth";
    make(&r);
    must(rig_edit_add_bone(&r, "eye", BONE_BALL, (vec3){30, 40, 50}, 12.0, &bone, &err), &err);
    rig_turn to = {yaw, {1, 0, 0}, -1.0, 1.0, {0}};
    refused(rig_edit_set_turn(&r, 1, 0, &to, &err), &err, "not a ball");
    refused(rig_edit_set_turn(&r, bone, 2, &to, &err), &err, "no turn 2");
    refused(rig_edit_set_turn(&r, bone, 1, &to, &err), &err, "another turn");
    to.name = none;
    refused(rig_edit_set_turn(&r, bone, 1, &to, &err), &err, "1 to");
    to = (rig_turn){third, {0, 0, 0}, -1.0, 1.0, {0}};
    refused(rig_edit_set_turn(&r, bone, 1, &to, &err), &err, "axis");
    to = (rig_turn){third, {1, 0, 0}, 0.1, 1.0, {0}};
    refused(rig_edit_set_turn(&r, bone, 1, &to, &err), &err, "180");
    to = (rig_turn){third, {1, 0, 0}, -4.0, 1.0, {0}};
    refused(rig_edit_set_turn(&r, bone, 1, &to, &err), &err, "180");
    to = (rig_turn){third, {1, 0, 0}, 0.0, 1e-6, {0}};
    refused(rig_edit_set_turn(&r, bone, 1, &to, &err), &err, "both limits");
    assert_string_equal(r.bone[bone].turn[1].name, "pitch");
    to = (rig_turn){third, {1, 0, 0}, 0.0, 1.0, {0}};
    must(rig_edit_add_turn(&r, bone, &to, &index, &err), &err);
    to.name = fourth;
    refused(rig_edit_add_turn(&r, bone, &to, &index, &err), &err, "at most 3");
    must(rig_edit_remove_turn(&r, bone, 0, &err), &err);
    must(rig_edit_remove_turn(&r, bone, 0, &err), &err);
    refused(rig_edit_remove_turn(&r, bone, 0, &err), &err, "cannot be removed");
    rig_destroy(&r);
}

static void a_bone_rides_on_another_that_is_before_it(void **state)
{
    (void)state;
    rig r;
    error err = {""};
    uint32_t bone = RIG_NONE;
    make(&r);
    must(rig_edit_add_bone(&r, "hat", BONE_FIXED, (vec3){0, 0, 0}, 1.0, &bone, &err), &err);
    must(rig_edit_set_parent(&r, bone, 1, &err), &err);
    again(&r);
    assert_int_equal(r.bone[bone].parent, 1);
    must(rig_edit_set_parent(&r, bone, RIG_NONE, &err), &err);
    again(&r);
    assert_int_equal(r.bone[bone].parent, RIG_NONE);
    refused(rig_edit_set_parent(&r, bone, bone, &err), &err, "before it");
    refused(rig_edit_set_parent(&r, 0, RIG_NONE, &err), &err, "cannot be removed");
    rig_destroy(&r);
}

/* ---- numbers ---- */

/* A drag ends anywhere: the file has what a hand can mean, and what was not dragged stays as it was
 * written. */
static void numbers_that_a_drag_gave_are_rounded_and_others_stay(void **state)
{
    (void)state;
    rig r;
    error err = {""};
    file_bytes bytes;
    make(&r);
    const uint32_t jaw = 1;
    assert_int_equal(r.bone[jaw].kind, BONE_JAW);
    r.bone[jaw].hinge_right = (vec3){-67.123456789, 1.0, 2.0};
    rig_edit_jaw to;
    rig_edit_jaw_of(&to, &r, jaw);
    to.left = (vec3){67.9999989629714, -23.123456, 0.001};
    to.open_min_rad = -2.34567 * degree;
    to.lateral_mm = 9.87654321;
    must(rig_edit_set_jaw(&r, jaw, &to, &err), &err);
    assert_true(r.bone[jaw].hinge_left.x >= 68.0 && r.bone[jaw].hinge_left.x <= 68.0);
    assert_float_equal(r.bone[jaw].hinge_left.y, -23.12, 1e-12);
    assert_float_equal(r.bone[jaw].hinge_right.x, -67.123456789, 1e-12);
    assert_float_equal(r.bone[jaw].lateral_mm, 9.88, 1e-12);
    assert_float_equal((r.bone[jaw].open_min_rad / degree), -2.35, 1e-9);
    again(&r);
    char path[128];
    (void)snprintf(path, sizeof path, "%s/a.rig.json", folder);
    must(file_read(&bytes, path, 1 << 20, &err), &err);
    const char *text = (const char *)bytes.data;
    assert_non_null(strstr(text, "-23.12,"));
    assert_non_null(strstr(text, "-67.123456789"));
    assert_non_null(strstr(text, "-2.35"));
    assert_null(strstr(text, "67.99"));
    file_bytes_finish(&bytes);
    rig_destroy(&r);
}

static void a_rigid_part_and_a_jaw_are_added(void **state)
{
    (void)state;
    rig r;
    error err = {""};
    uint32_t index;
    must(rig_with(&r, "\"bones\": [{\"name\": \"skull\"}]", &err), &err);
    must(rig_edit_add_bone(&r, "jaw", BONE_JAW, (vec3){1, 2, 3}, 40.0, &index, &err), &err);
    must(rig_edit_add_bone(&r, "hat", BONE_FIXED, (vec3){0, 0, 0}, 1.0, &index, &err), &err);
    again(&r);
    assert_int_equal(r.bone[1].kind, BONE_JAW);
    assert_float_equal(r.bone[1].hinge_left.x, 41.0, 1e-9);
    assert_float_equal(r.bone[1].hinge_right.x, -39.0, 1e-9);
    assert_true(fabs(r.bone[1].open_max_rad - 32.0 * acos(-1.0) / 180.0) < 1e-9);
    assert_int_equal(r.bone[2].kind, BONE_FIXED);
    rig_destroy(&r);
}

static void what_rode_on_a_bone_rides_on_its_parent(void **state)
{
    (void)state;
    rig r;
    error err = {""};
    make(&r);
    must(rig_edit_remove_bone(&r, 1, &err), &err);
    again(&r);
    assert_int_equal(r.bone_count, 2);
    assert_string_equal(r.bone[1].name, "tongue");
    assert_int_equal(r.bone[1].parent, 0);
    assert_int_equal(r.region[0].bone, 0);
    assert_int_equal(r.region[1].bone, 1);
    assert_int_equal(r.region[2].bone, RIG_NONE);
    assert_int_equal(r.contact[0].bone, 1);
    assert_int_equal(r.contact[1].bone, RIG_NONE);
    assert_int_equal(r.proxy[1].bone, 1);
    assert_int_equal(r.pose[0].dof_count, 0);
    assert_int_equal(r.pose[0].pull_count, 1);
    rig_destroy(&r);
}

static void poses_follow_a_bones_name(void **state)
{
    (void)state;
    rig r;
    error err = {""};
    make(&r);
    must(rig_edit_name_bone(&r, 1, "beak", &err), &err);
    again(&r);
    assert_int_equal(rig_find_bone(&r, "beak"), 1);
    assert_int_equal(r.bone[2].parent, 1);
    assert_int_equal(r.pose[0].dof_count, 2);
    for (uint32_t i = 0; i < 2; ++i)
        assert_int_equal(strncmp(r.pose[0].dof_name[i], "beak.", 5), 0);
    rig_destroy(&r);
}

static void bones_that_make_no_sense_are_refused(void **state)
{
    (void)state;
    rig r;
    error err = {""};
    uint32_t index = 77;
    const vec3 here = {0, 0, 0}, nowhere = {(double)NAN, 0, 0};
    make(&r);
    refused(rig_edit_add_bone(&r, "jaw2", BONE_JAW, here, 9, &index, &err), &err, "already");
    refused(rig_edit_add_bone(&r, "jaw", BONE_FIXED, here, 9, &index, &err), &err, "another bone");
    refused(rig_edit_add_bone(&r, "", BONE_FIXED, here, 9, &index, &err), &err, "1 to");
    refused(rig_edit_add_bone(&r, "x", BONE_BALL, nowhere, 9, &index, &err), &err, "too far");
    refused(rig_edit_add_bone(&r, "x", BONE_BALL, here, 0, &index, &err), &err, "too small");
    refused(rig_edit_remove_bone(&r, 0, &err), &err, "cannot be removed");
    refused(rig_edit_remove_bone(&r, 9, &err), &err, "no bone 9");
    refused(rig_edit_name_bone(&r, 0, "head", &err), &err, "cannot be removed");
    refused(rig_edit_set_ball(&r, 1, here, 3.0, &err), &err, "not a ball");
    assert_int_equal(r.bone_count, 3);
    assert_int_equal(index, 77);
    for (uint32_t i = r.bone_count; i < RIG_BONES_MAX; ++i) {
        char name[16];
        (void)snprintf(name, sizeof name, "part %u", i);
        must(rig_edit_add_bone(&r, name, BONE_FIXED, here, 9, &index, &err), &err);
    }
    refused(rig_edit_add_bone(&r, "more", BONE_FIXED, here, 9, &index, &err), &err, "at most 16");
    rig_destroy(&r);
}

/* ---- ellipsoids ---- */

static void ellipsoids_come_change_and_go(void **state)
{
    (void)state;
    rig r;
    error err = {""};
    uint32_t index = RIG_NONE;
    rig_proxy made = {.bone = 1, .centre = {1, 2, 3}, .radii = {4, 5, 6}};
    make(&r);
    must(rig_edit_add_proxy(&r, &made, &index, &err), &err);
    assert_int_equal(index, 2);
    must(rig_edit_remove_proxy(&r, 0, &err), &err);
    made.radii.y = 9.0;
    must(rig_edit_set_proxy(&r, 1, &made, &err), &err);
    again(&r);
    assert_int_equal(r.proxy_count, 2);
    assert_float_equal(r.proxy[0].centre.x, 6.0, 1e-9);
    assert_int_equal(r.proxy[0].bone, 2);
    assert_int_equal(r.proxy[1].bone, 1);
    assert_float_equal(r.proxy[1].radii.y, 9.0, 1e-9);
    assert_true(r.note && strstr(r.note, "skull_proxy[0].who")); /* Bo's stays Bo's */
    made.radii.x = 0.0;
    refused(rig_edit_add_proxy(&r, &made, &index, &err), &err, "greater than 0");
    made.radii.x = (double)INFINITY;
    refused(rig_edit_set_proxy(&r, 0, &made, &err), &err, "too far");
    made = r.proxy[0];
    made.bone = 12;
    refused(rig_edit_set_proxy(&r, 0, &made, &err), &err, "no bone 12");
    refused(rig_edit_remove_proxy(&r, 5, &err), &err, "no ellipsoid 5");
    rig_destroy(&r);
}

static void a_row_of_teeth_is_added_and_read_again(void **state)
{
    (void)state;
    rig r;
    error err = {""};
    uint32_t index = RIG_NONE;
    const rig_proxy made = {
        .kind = PROXY_TEETH, .bone = 1, .centre = {0, -50, 40}, .radii = {30, 9, 35}};
    make(&r);
    must(rig_edit_add_proxy(&r, &made, &index, &err), &err);
    again(&r);
    assert_int_equal(r.proxy[0].kind, PROXY_ELLIPSOID);
    assert_int_equal(r.proxy[index].kind, PROXY_TEETH);
    assert_float_equal(r.proxy[index].radii.z, 35.0, 1e-9);
    assert_int_equal(r.proxy[index].bone, 1);
    rig_destroy(&r);
}

static void what_this_version_does_not_know_stays_with_its_ellipsoid(void **state)
{
    (void)state;
    rig r;
    error err = {""};
    char path[128];
    file_bytes bytes;
    make(&r);
    must(rig_edit_remove_proxy(&r, 0, &err), &err);
    again(&r);
    (void)snprintf(path, sizeof path, "%s/a.rig.json", folder);
    must(file_read(&bytes, path, 1 << 20, &err), &err);
    assert_non_null(strstr((const char *)bytes.data, "Bo"));
    assert_null(strstr((const char *)bytes.data, "Ana"));
    file_bytes_finish(&bytes);
    rig_destroy(&r);
}

/* ---- poses ---- */

static void poses_come_are_named_and_go(void **state)
{
    (void)state;
    rig r;
    error err = {""};
    uint32_t index = RIG_NONE, contact[2] = {1, 0};
    char open[] = "jaw.open";
    char *dof[] = {open};
    double value[] = {0.3};
    vec3 way[2] = {{0, 3, 1}, {1, 0, 0}};
    char name[] = "surprise";
    const rig_pose pose = {.name = name,
                           .part = POSE_MOUTH,
                           .dof_name = dof,
                           .dof_value = value,
                           .dof_count = 1,
                           .pull_contact = contact,
                           .pull_mm = way,
                           .pull_count = 2};
    make(&r);
    must(rig_edit_add_pose(&r, &pose, &index, &err), &err);
    assert_int_equal(index, 1);
    refused(rig_edit_add_pose(&r, &pose, &index, &err), &err, "another pose");
    must(rig_edit_name_pose(&r, 1, "oh", &err), &err);
    refused(rig_edit_name_pose(&r, 1, "wide", &err), &err, "another pose");
    again(&r);
    assert_int_equal(r.pose_count, 2);
    assert_string_equal(r.pose[1].name, "oh");
    assert_float_equal(r.pose[1].dof_value[0], 0.3, 1e-4); /* to 0.01 degrees */
    assert_int_equal(r.pose[1].pull_count, 2);
    assert_int_equal(r.pose[1].part, POSE_MOUTH);
    must(rig_edit_remove_pose(&r, 0, &err), &err);
    again(&r);
    assert_int_equal(r.pose_count, 1);
    assert_string_equal(r.pose[0].name, "oh");
    refused(rig_edit_remove_pose(&r, 1, &err), &err, "no pose 1");
    (void)snprintf(open, sizeof open, "%s", "jaw.hop");
    (void)snprintf(name, sizeof name, "%s", "other");
    refused(rig_edit_add_pose(&r, &pose, &index, &err), &err, "jaw.hop");
    rig_destroy(&r);
}

static void a_mouth_comes_changes_and_goes(void **state)
{
    (void)state;
    uint32_t upper[] = {1, 2, 3, 4}, lower[] = {1, 6, 4}, contact[] = {0}, index = RIG_NONE;
    char name[] = "pressed", seal[] = RIG_LIPS_SEAL, *dof[] = {seal};
    double value[] = {1.0};
    vec3 way[] = {{0, 1, 0}};
    rig r;
    error err = {""};
    rig_mouth mouth = {.upper = upper,
                       .upper_count = 4,
                       .lower = lower,
                       .lower_count = 3,
                       .upper_share = 0.43217,
                       .stickiness_mm = 2.718,
                       .seal_from = SEAL_FROM_MIDDLE};
    const rig_pose pose = {.name = name,
                           .dof_name = dof,
                           .dof_value = value,
                           .dof_count = 1,
                           .pull_contact = contact,
                           .pull_mm = way,
                           .pull_count = 1};
    make(&r);
    must(rig_edit_set_mouth(&r, &mouth, &err), &err);
    must(rig_edit_add_pose(&r, &pose, &index, &err), &err);
    again(&r);
    assert_int_equal(r.mouth.upper_count, 4);
    assert_int_equal(r.mouth.lower[1], 6);
    assert_float_equal(r.mouth.upper_share, 0.432, 1e-9);
    assert_float_equal(r.mouth.stickiness_mm, 2.72, 1e-9);
    assert_int_equal(r.mouth.seal_from, SEAL_FROM_MIDDLE);
    mouth.upper_share = 1.5;
    refused(rig_edit_set_mouth(&r, &mouth, &err), &err, "0 to 1");
    mouth.upper_share = 0.5;
    mouth.lower_count = 2;
    refused(rig_edit_set_mouth(&r, &mouth, &err), &err, "3 to");
    assert_int_equal(r.mouth.lower_count, 3);
    rig_edit_remove_mouth(&r);
    again(&r);
    assert_null(r.mouth.upper);
    assert_int_equal(r.pose[index].dof_count, 0);
    assert_int_equal(r.pose[index].pull_count, 1);
    rig_destroy(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_eye_is_added_and_read_again),
        cmocka_unit_test(a_loose_part_swings_and_is_read_again),
        cmocka_unit_test(the_turns_of_a_ball_are_changed_and_read_again),
        cmocka_unit_test(poses_follow_a_turn_and_forget_it),
        cmocka_unit_test(a_lid_follows_a_turn_that_is_renamed_moved_and_taken_out),
        cmocka_unit_test(turns_that_make_no_sense_are_refused),
        cmocka_unit_test(a_bone_rides_on_another_that_is_before_it),
        cmocka_unit_test(numbers_that_a_drag_gave_are_rounded_and_others_stay),
        cmocka_unit_test(a_rigid_part_and_a_jaw_are_added),
        cmocka_unit_test(what_rode_on_a_bone_rides_on_its_parent),
        cmocka_unit_test(poses_follow_a_bones_name),
        cmocka_unit_test(bones_that_make_no_sense_are_refused),
        cmocka_unit_test(ellipsoids_come_change_and_go),
        cmocka_unit_test(a_row_of_teeth_is_added_and_read_again),
        cmocka_unit_test(what_this_version_does_not_know_stays_with_its_ellipsoid),
        cmocka_unit_test(poses_come_are_named_and_go),
        cmocka_unit_test(a_mouth_comes_changes_and_goes),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
