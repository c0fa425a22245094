/* How bones move: limits, the jaw's three degrees of freedom, balls, parents; and the jaw pose that
 * controls ask for. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "base/angle.h"
#include "unit/face_scene.h"

static void expect_near(double got, double expected, double limit)
{
    if (!(fabs(got - expected) <= limit))
        fail_msg("%.17g instead of %.17g (+-%g)", got, expected, limit);
}

static bones make_bones(face_scene *s)
{
    bones b;
    error err = {""};
    scene_init(s);
    if (bones_init(&b, &s->rig, (vec3){0, 0, 0}, &err) < 0)
        fail_msg("%s", err.text);
    return b;
}

static const vec3 incisor = {0, -1, 79.3};

static vec3 incisor_at(const bones *b, const float *dof)
{
    rigid pose[SCENE_BONES];
    bones_pose(pose, b, dof);
    return rigid_apply(&pose[JAW], incisor);
}

/* ---- names and limits ---- */

static void dofs_are_named_after_their_bones(void **state)
{
    (void)state;
    static const char *const names[] = {"jaw.open", "jaw.lateral", "jaw.forward",
                                        "eye.yaw",  "eye.pitch",   "lid.close"};
    static face_scene s;
    bones b = make_bones(&s);
    assert_int_equal(b.dof_count, 6);
    for (uint32_t i = 0; i < 6; ++i)
        assert_string_equal(b.dof[i].name, names[i]);
    assert_string_equal(b.dof[0].unit, "rad");
    assert_string_equal(b.dof[1].unit, "mm");
    assert_true(b.dof[1].min == -10.0f && b.dof[1].max == 10.0f && b.dof[2].min == 0.0f);
    assert_int_equal(b.jaw, JAW);
    assert_false(b.moves[SKULL]);
    assert_true(b.moves[JAW] && b.moves[EYE] && b.moves[LID]);
}

static void limits_are_exact_inside_smooth_and_never_passed(void **state)
{
    (void)state;
    const double h = 1e-6;
    double last = -3.0, last_slope = 0.0;
    for (int i = -500; i <= 500; ++i) {
        double x = 0.01 * i, y = bones_soft_limit(x, -2.0, 4.0);
        double slope =
            (bones_soft_limit(x + h, -2.0, 4.0) - bones_soft_limit(x - h, -2.0, 4.0)) / (2 * h);
        assert_true(y >= last && y >= -2.0 && y <= 4.0);
        if (x >= -1.7 && x <= 3.4)
            assert_true(y == x);
        if (i > -500)
            assert_true(fabs(slope - last_slope) < 0.15); /* a kink would be 1 */
        last = y;
        last_slope = slope;
    }
    assert_true(bones_soft_limit(0.0, 0.0, 4.0) == 0.0);
    assert_true(bones_soft_limit(-1.0, 0.0, 4.0) == 0.0);
    assert_true(bones_soft_limit(4.0, -2.0, 4.0) == 4.0);
    assert_true(bones_soft_limit(1e30, -2.0, 4.0) == 4.0);
    assert_true(bones_soft_limit(1.0, 0.0, 0.0) == 0.0);
}

static void limits_can_be_undone(void **state)
{
    (void)state;
    for (double y = -2.0; y <= 4.0; y += 0.03125) {
        double x = bones_soft_limit_inverse(y, -2.0, 4.0);
        expect_near(bones_soft_limit(x, -2.0, 4.0), y, 1e-14);
        if (y >= -1.7 && y <= 3.4)
            assert_true(x == y);
    }
    assert_true(bones_soft_limit_inverse(9.0, -2.0, 4.0) == 4.0);
}

/* ---- motions ---- */

static void at_rest_nothing_moves_bit_for_bit(void **state)
{
    (void)state;
    static face_scene s;
    bones b = make_bones(&s);
    const float still[MRT_MAX_DOFS] = {0}, undriven[MRT_MAX_DOFS] = {NAN, NAN, NAN, NAN, NAN, NAN};
    const rigid identity = rigid_identity();
    rigid pose[SCENE_BONES];
    for (int turn = 0; turn < 2; ++turn) {
        bones_pose(pose, &b, turn ? undriven : still);
        for (int bone = 0; bone < SCENE_BONES; ++bone)
            assert_memory_equal(&pose[bone], &identity, sizeof identity);
    }
}

static void an_open_jaw_gapes_45_to_55_mm(void **state)
{
    (void)state;
    static face_scene s;
    bones b = make_bones(&s);
    float dof[MRT_MAX_DOFS] = {b.dof[0].max};
    vec3 at = incisor_at(&b, dof);
    double gape = scene_distance(at, incisor);
    print_message("incisor at full opening: (%.1f, %.1f, %.1f) mm away, %.1f mm\n",
                  at.x - incisor.x, at.y - incisor.y, at.z - incisor.z, gape);
    assert_true(gape >= 45.0 && gape <= 55.0);
    assert_true(at.y < incisor.y - 35.0 && fabs(at.x) < 1e-12);
    dof[0] = 100.0f;
    expect_near(scene_distance(incisor_at(&b, dof), incisor), gape, 1e-6);
    dof[0] = -1.0f;
    assert_true(scene_distance(incisor_at(&b, dof), incisor) == 0.0);
}

/* Up to 20 mm a hinge alone; at 45 mm the condyles have slid by 12 mm, 33.5 degrees down. */
static void condyles_slide_as_the_jaw_opens(void **state)
{
    (void)state;
    static face_scene s;
    bones b = make_bones(&s);
    const vec3 middle = {0, 10, -10};
    double last = 0.0;
    for (double open = 0.0; open <= 0.56; open += 0.005) {
        rigid jaw = bones_jaw(&b, open, 0.0, 0.0);
        vec3 slid = vec3_sub(rigid_apply(&jaw, middle), middle);
        double gap = 2.0 * vec3_length(vec3_sub(incisor, middle)) * sin(0.5 * open);
        double way = vec3_length(slid);
        if (gap <= 20.0)
            assert_true(way < 1e-12);
        if (gap >= 45.0)
            expect_near(way, 12.0, 1e-9);
        if (way > 1e-6)
            expect_near(slid.y / slid.z, -0.55 / 0.83, 1e-9);
        assert_true(way >= last - 1e-12);
        last = way;
    }
    assert_true(last > 11.0);
}

static void the_jaw_goes_aside_alike_on_both_sides(void **state)
{
    (void)state;
    static face_scene s;
    bones b = make_bones(&s);
    for (double lateral = 0.25; lateral <= 10.0; lateral += 0.25) {
        rigid left = bones_jaw(&b, 0.0, lateral, 0.0), right = bones_jaw(&b, 0.0, -lateral, 0.0);
        vec3 a = rigid_apply(&left, incisor), c = rigid_apply(&right, incisor);
        expect_near(a.x, lateral, 1e-9);
        expect_near(c.x, -a.x, 1e-12);
        expect_near(a.y, c.y, 1e-12);
        expect_near(a.z, c.z, 1e-12);
    }
    for (double open = 0.0; open <= 0.5;
         open += 0.125) { /* at the incisor, however wide it is open */
        rigid jaw = bones_jaw(&b, open, 4.0, 0.0);
        expect_near(rigid_apply(&jaw, incisor).x, 4.0, 1e-9);
    }
    /* To the left the left condyle all but stays and the right one goes forward. */
    rigid left = bones_jaw(&b, 0.0, 10.0, 0.0);
    const vec3 condyle[2] = {{50, 10, -10}, {-50, 10, -10}};
    assert_true(scene_distance(rigid_apply(&left, condyle[0]), condyle[0]) < 0.5);
    assert_true(rigid_apply(&left, condyle[1]).z > condyle[1].z + 9.0);
    /* Smooth at 0: the second difference vanishes with the step. */
    double h = 1e-3;
    rigid before = bones_jaw(&b, 0.0, -h, 0.0), after = bones_jaw(&b, 0.0, h, 0.0);
    vec3 p = rigid_apply(&before, condyle[0]), q = rigid_apply(&after, condyle[0]);
    double bend = vec3_length(vec3_sub(vec3_add(p, q), vec3_scale(condyle[0], 2.0))) / h;
    assert_true(bend < 1e-3);
}

/* Teeth together, the cusps slide down each other; apart, they do not meet. */
static void the_jaw_gives_way_to_the_cusps(void **state)
{
    (void)state;
    static face_scene s;
    bones b = make_bones(&s);
    double last = 0.0;
    for (double lateral = 1.0; lateral <= 10.0; lateral += 1.0) {
        rigid jaw = bones_jaw(&b, 0.0, lateral, 0.0), alone = bones_aside(&b, lateral, 0.0);
        double down = rigid_apply(&alone, incisor).y - rigid_apply(&jaw, incisor).y;
        expect_near(down, 0.4 * (sqrt(lateral * lateral + 1.0) - 1.0), 0.05);
        assert_true(down > last);
        last = down;
    }
    assert_true(bones_guided_opening(&b, 0.2, 10.0) == 0.2);
    for (double open = 0.0, before = 0.0; open <= 0.2; open += 0.001) {
        double now = bones_guided_opening(&b, open, 10.0);
        assert_true(now >= before && now >= open);
        before = now;
    }
}

static void the_envelope_narrows_as_the_jaw_opens(void **state)
{
    (void)state;
    static face_scene s;
    bones b = make_bones(&s);
    double widest = s.bone[JAW].open_max_rad;
    expect_near(bones_lateral_limit(&b, 0.0), 10.0, 1e-12);
    expect_near(bones_lateral_limit(&b, 0.5 * widest), 7.0, 1e-12);
    expect_near(bones_lateral_limit(&b, widest), 4.0, 1e-12);
    expect_near(bones_forward_limit(&b, 0.0), 8.0, 1e-12);
    expect_near(bones_forward_limit(&b, widest), 3.2, 1e-12);
    for (double open = 0.0; open <= 1.0; open += 0.125) {
        float dof[MRT_MAX_DOFS] = {(float)(open * widest), 50.0f, 50.0f}, limited[MRT_MAX_DOFS];
        bones_limit(limited, &b, dof);
        double part = (double)limited[0] / widest;
        assert_true(fabs(part - open) < 0.05);
        expect_near((double)limited[1], 10.0 - 6.0 * part, 1e-5);
        expect_near((double)limited[2], 8.0 - 4.8 * part, 1e-5);
    }
}

static void balls_turn_about_their_centre_first_listed_outermost(void **state)
{
    (void)state;
    static face_scene s;
    bones b = make_bones(&s);
    const float dof[MRT_MAX_DOFS] = {0, 0, 0, 0.5f, 0.4f, 0};
    rigid pose[SCENE_BONES];
    bones_pose(pose, &b, dof);
    const vec3 centre = {30, 40, 60}, front = {30, 40, 70};
    assert_true(scene_distance(rigid_apply(&pose[EYE], centre), centre) < 1e-12);
    rigid pitch = rigid_turn(centre, (vec3){1, 0, 0}, (double)0.4f);
    rigid yaw = rigid_turn(centre, (vec3){0, 1, 0}, (double)0.5f);
    vec3 expected = rigid_apply(&pitch, front);
    expected = rigid_apply(&yaw, expected);
    assert_true(scene_distance(rigid_apply(&pose[EYE], front), expected) < 1e-12);
}

/* ---- a lid that follows the gaze ---- */

static double lid_angle(const bones *b, float pitch_rad, float close_rad)
{
    float dof[MRT_MAX_DOFS] = {0};
    rigid pose[SCENE_BONES];
    dof[b->first_dof[EYE] + 1] = pitch_rad;
    dof[b->first_dof[LID]] = close_rad;
    bones_pose(pose, b, dof);
    return atan2(pose[LID].r[2][1], pose[LID].r[1][1]);
}

static void a_lid_follows_the_gaze_within_its_limits(void **state)
{
    (void)state;
    static face_scene s;
    bones b = make_bones(&s);
    s.bone[LID].turn[0].follows = (rig_follow){EYE, 1, 0.6};
    expect_near(lid_angle(&b, 0.2f, 0.0f), 0.12, 1e-7);
    expect_near(lid_angle(&b, 0.0f, 0.3f), (double)0.3f, 1e-12);
    expect_near(lid_angle(&b, -0.1f, 0.0f), -0.06, 1e-7); /* it widens */
    expect_near(lid_angle(&b, -0.5f, 0.0f), -0.1, 1e-7);  /* as far as it can */
    expect_near(lid_angle(&b, -0.5f, -0.1f), -0.1, 1e-7);
    assert_true(lid_angle(&b, 0.2f, -0.1f) > -0.1);
    for (int i = -9; i <= 9; ++i) /* shut is shut, wherever the eye looks */
        assert_true(lid_angle(&b, 0.1f * (float)i, 0.5f) == lid_angle(&b, 0.0f, 0.5f));
}

/* Plugins and takes see what was driven: limits know nothing of the gaze. */
static void the_value_of_a_lid_that_follows_stays_the_driven_one(void **state)
{
    (void)state;
    static face_scene s;
    bones b = make_bones(&s);
    const float dof[MRT_MAX_DOFS] = {0, 0, 0, 0, 0.45f, 0.2f};
    float plain[MRT_MAX_DOFS], limited[MRT_MAX_DOFS], back[MRT_MAX_DOFS];
    rigid before[SCENE_BONES], after[SCENE_BONES];
    bones_limit(plain, &b, dof);
    s.bone[LID].turn[0].follows = (rig_follow){EYE, 1, -0.6};
    bones_limit(limited, &b, dof);
    assert_memory_equal(plain, limited, b.dof_count * sizeof *plain);
    bones_unlimit(back, &b, limited);
    bones_pose(before, &b, dof);
    bones_pose(after, &b, back);
    const vec3 x = {30, 40, 72};
    assert_true(scene_distance(rigid_apply(&before[LID], x), rigid_apply(&after[LID], x)) < 1e-4);
}

static void following_is_smooth_and_never_turns_back(void **state)
{
    (void)state;
    const double h = 1e-6, min = -0.2, max = 0.9;
    for (int k = -10; k <= 10; ++k) {
        double by = 0.1 * k, last = -1.0, last_slope = 0.0;
        for (int i = 0; i <= 4400; ++i) {
            double x = min + 0.00025 * i, y = bones_followed(x, by, min, max);
            double slope =
                (bones_followed(x + h, by, min, max) - bones_followed(x - h, by, min, max)) /
                (2 * h);
            assert_true(y >= last - 1e-12 && y >= min - 1e-12 && y <= max + 1e-12);
            if (i > 1 && i < 4399)
                assert_true(fabs(slope - last_slope) < 0.1); /* a kink would be 1 */
            last = y;
            last_slope = slope;
        }
    }
    assert_true(bones_followed(0.3, 0.0, min, max) == 0.3);
    assert_true(bones_followed(0.0, -0.5, 0.0, max) == 0.0); /* a lid that cannot widen */
    assert_true(bones_followed(0.0, 0.5, min, 0.0) == 0.0);
}

static void what_cannot_be_followed_is_refused(void **state)
{
    (void)state;
    static const struct {
        rig_follow follows;
        const char *why;
    } wrong[] = {{{LID, 0, 0.5}, "of the same bone"},
                 {{EYE, 2, 0.5}, "not a turn of a ball"},
                 {{JAW, 0, 0.5}, "not a turn of a ball"},
                 {{EYE, 0, 1.5}, "outside -1 to 1"}};
    static face_scene s;
    error err = {""};
    bones b;
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; ++i) {
        scene_init(&s);
        s.bone[LID].turn[0].follows = wrong[i].follows;
        assert_int_equal(bones_init(&b, &s.rig, incisor, &err), MRT_ERR_FORMAT);
        if (!strstr(err.text, wrong[i].why))
            fail_msg("%s", err.text);
    }
    scene_init(&s);
    s.bone[EYE].turn[0].follows = (rig_follow){LID, 0, 0.5};
    assert_int_equal(bones_init(&b, &s.rig, incisor, &err), MRT_ERR_FORMAT);
    assert_non_null(strstr(err.text, "listed later"));
}

static void bones_ride_on_a_skull_that_turns(void **state)
{
    (void)state;
    static face_scene s;
    static char nod[] = "nod";
    error err = {""};
    bones b;
    scene_init(&s);
    s.bone[SKULL].kind = BONE_BALL;
    s.bone[SKULL].centre = (vec3){0, -60, 0};
    s.bone[SKULL].turn[0] = (rig_turn){nod, {1, 0, 0}, -0.4, 0.4, {0}};
    s.bone[SKULL].turn_count = 1;
    s.bone[SKULL].parent = RIG_NONE;
    rig_bone swapped = s.bone[SKULL]; /* a parent may be listed behind its child */
    s.bone[SKULL] = s.bone[LID];
    s.bone[LID] = swapped;
    s.bone[SKULL].parent = s.bone[JAW].parent = s.bone[EYE].parent = LID;
    assert_int_equal(bones_init(&b, &s.rig, incisor, &err), MRT_OK);
    float dof[MRT_MAX_DOFS] = {0};
    dof[b.first_dof[JAW]] = 0.25f;
    dof[b.first_dof[LID]] = 0.125f;
    rigid pose[SCENE_BONES];
    bones_pose(pose, &b, dof);
    rigid head = rigid_turn((vec3){0, -60, 0}, (vec3){1, 0, 0}, 0.125);
    rigid jaw = bones_jaw(&b, 0.25, 0.0, 0.0);
    rigid both = rigid_compose(&head, &jaw);
    const vec3 x = {12, -30, 70};
    assert_true(scene_distance(rigid_apply(&pose[JAW], x), rigid_apply(&both, x)) < 1e-12);
    assert_true(scene_distance(rigid_apply(&pose[EYE], x), rigid_apply(&head, x)) < 1e-12);
}

static void rigs_that_cannot_move_are_refused_by_name(void **state)
{
    (void)state;
    static face_scene s;
    error err = {""};
    bones b;
    scene_init(&s);
    s.bone[JAW].hinge_right = s.bone[JAW].hinge_left;
    assert_int_equal(bones_init(&b, &s.rig, incisor, &err), MRT_ERR_FORMAT);
    assert_non_null(strstr(err.text, "bone jaw: its hinge is only 0 mm wide"));
    scene_init(&s);
    s.bone[JAW].open_max_rad = -0.1;
    assert_int_equal(bones_init(&b, &s.rig, incisor, &err), MRT_ERR_FORMAT);
    assert_non_null(strstr(err.text, "\"open_deg\""));
    scene_init(&s);
    s.bone[JAW].incisor = (vec3){0, 0, -50};
    assert_int_equal(bones_init(&b, &s.rig, incisor, &err), MRT_ERR_FORMAT);
    assert_non_null(strstr(err.text, "incisor"));
    scene_init(&s);
    s.bone[SKULL].parent = JAW;
    assert_int_equal(bones_init(&b, &s.rig, incisor, &err), MRT_ERR_FORMAT);
    assert_non_null(strstr(err.text, "its own parent"));
    scene_init(&s);
    s.bone[EYE].turn[0].axis = (vec3){0, 0, 0};
    assert_int_equal(bones_init(&b, &s.rig, incisor, &err), MRT_ERR_FORMAT);
    assert_non_null(strstr(err.text, "axis of turn yaw"));
    scene_init(&s);
    s.bone[LID] = s.bone[JAW];
    assert_int_equal(bones_init(&b, &s.rig, incisor, &err), MRT_ERR_UNSUPPORTED);
    assert_non_null(strstr(err.text, "already has a jaw"));
}

/* ---- the derived jaw ---- */

enum { RIDERS = 4 };
static const double rider[RIDERS][3] = {{0, -30, 80}, {0, -5, 84}, {30, -25, 60}, {-30, -25, 60}};
static const double riding[RIDERS] = {1.0, 0.9, 0.6, 0.6};

static void ask(const bones *b, double open, double lateral, double forward, double end[RIDERS][3])
{
    rigid jaw = bones_jaw(b, open, lateral, forward);
    for (int i = 0; i < RIDERS; ++i) {
        vec3 to = rigid_apply(&jaw, (vec3){rider[i][0], rider[i][1], rider[i][2]});
        end[i][0] = to.x;
        end[i][1] = to.y;
        end[i][2] = to.z;
    }
}

static void controls_at_rest_leave_the_jaw_exactly_shut(void **state)
{
    (void)state;
    static face_scene s;
    bones b = make_bones(&s);
    float dof[3] = {0};
    for (uint32_t count = 1; count <= RIDERS; ++count) {
        bones_derive_jaw(dof, &b, rider[0], rider[0], riding, count);
        assert_true(dof[0] == 0.0f && dof[1] == 0.0f && dof[2] == 0.0f);
    }
}

/* Where the joint pose is posed again, it is the pose that was asked for. */
static void a_pose_of_the_jaw_is_found_again(void **state)
{
    (void)state;
    static face_scene s;
    bones b = make_bones(&s);
    double worst = 0.0;
    for (int i = 0; i <= 10; ++i)
        for (int j = -4; j <= 4; ++j)
            for (int k = 0; k <= 4; ++k) {
                double open = 0.1 * i * s.bone[JAW].open_max_rad, end[RIDERS][3];
                double lateral = 0.25 * j * bones_lateral_limit(&b, open);
                double forward = 0.25 * k * bones_forward_limit(&b, open);
                float dof[MRT_MAX_DOFS] = {0};
                rigid pose[SCENE_BONES], asked = bones_jaw(&b, open, lateral, forward);
                ask(&b, open, lateral, forward, end);
                bones_derive_jaw(dof, &b, rider[0], end[0], riding, RIDERS);
                bones_pose(pose, &b, dof);
                worst = fmax(worst, scene_distance(rigid_apply(&pose[JAW], incisor),
                                                   rigid_apply(&asked, incisor)));
            }
    print_message("incisor after posing anew: at most %.2g mm away\n", worst);
    assert_true(worst < 2e-5);
}

static void the_jaw_follows_the_chin_steadily(void **state)
{
    (void)state;
    static face_scene s;
    bones b = make_bones(&s);
    for (uint32_t count = 1; count <= 2; ++count) {
        double last = 0.0;
        for (int i = 0; i <= 800;
             ++i) { /* straight down, 0.1 mm at a time, further than it opens */
            double end[2][3] = {{rider[0][0], rider[0][1] - 0.1 * i, rider[0][2]},
                                {rider[1][0], rider[1][1] - 0.1 * i, rider[1][2]}};
            float dof[3] = {0};
            bones_derive_jaw(dof, &b, rider[0], end[0], riding, count);
            double open = bones_soft_limit((double)dof[0], 0.0, s.bone[JAW].open_max_rad);
            assert_true(open >= last - 1e-6);
            assert_true(open - last < 0.0015); /* rad; 0.1 mm at 90 mm are 0.0011 */
            last = open;
        }
        assert_true(last > 0.5);
    }
}

static double any_between(uint64_t *seed, double low, double high)
{
    *seed = *seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return low + (high - low) * (double)(*seed >> 40) / 16777216.0;
}

/* Two tips that ask for what no jaw can do, up to 20 mm apart from it, on straight ways of 0.05 mm
 * a step: the answer passes from one side to the other in steps, not in one leap of 10 mm. */
static void a_jaw_that_is_torn_to_both_sides_goes_there_in_steps(void **state)
{
    (void)state;
    static face_scene s;
    bones b = make_bones(&s);
    uint64_t seed = 7;
    double worst_mm = 0.0;
    for (int way = 0; way < 60; ++way) {
        double from[6], along[6], length = 0.0;
        for (int i = 0; i < 6; ++i) {
            from[i] = any_between(&seed, -12.0, 12.0);
            along[i] = any_between(&seed, -1.0, 1.0);
            length += along[i] * along[i];
        }
        vec3 last = {0, 0, 0};
        for (int step = -100; step <= 100; ++step) {
            double end[2][3];
            float dof[MRT_MAX_DOFS] = {0};
            rigid pose[SCENE_BONES];
            for (int i = 0; i < 6; ++i)
                end[i / 3][i % 3] =
                    rider[2 + i / 3][i % 3] + from[i] + along[i] * 0.05 * step / sqrt(length);
            bones_derive_jaw(dof, &b, rider[2], end[0], riding + 2, 2);
            bones_pose(pose, &b, dof);
            vec3 now = rigid_apply(&pose[JAW], incisor);
            if (step > -100)
                worst_mm = fmax(worst_mm, scene_distance(now, last));
            last = now;
        }
    }
    print_message("0.05 mm of two tips moves the incisor by at most %.3f mm\n", worst_mm);
    assert_true(worst_mm < 3.5);
}

static void pulls_upwards_do_not_open_it(void **state)
{
    (void)state;
    static face_scene s;
    bones b = make_bones(&s);
    float dof[3] = {0};
    double end[1][3] = {{0, -20, 80}};
    bones_derive_jaw(dof, &b, rider[0], end[0], riding, 1);
    assert_true(dof[0] == 0.0f && dof[1] == 0.0f && dof[2] == 0.0f);
}

static void too_few_controls_leave_the_last_values(void **state)
{
    (void)state;
    static face_scene s;
    bones b = make_bones(&s);
    const double none[RIDERS] = {0.0, 0.0, 0.0, 0.0};
    double end[RIDERS][3];
    float dof[3] = {0.25f, 3.0f, 2.0f};
    bones_derive_jaw(dof, &b, rider[0], rider[0], none, RIDERS);
    assert_true(dof[0] == 0.25f && dof[1] == 3.0f && dof[2] == 2.0f);
    ask(&b, 0.2, 3.0, 2.0, end);
    bones_derive_jaw(dof, &b, rider[0], end[0], riding, 1);
    assert_true(dof[1] == 3.0f && dof[2] == 2.0f);
    expect_near((double)dof[0], 0.2, 1e-6);
}

static void the_derived_jaw_keeps_within_its_limits(void **state)
{
    (void)state;
    static face_scene s;
    bones b = make_bones(&s);
    uint64_t seed = 7;
    for (int i = 0; i < 500; ++i) {
        double end[RIDERS][3];
        float dof[3] = {0};
        for (int k = 0; k < RIDERS; ++k)
            for (int axis = 0; axis < 3; ++axis) {
                seed = seed * 6364136223846793005u + 1442695040888963407u;
                end[k][axis] = rider[k][axis] + 120.0 * ((double)(seed >> 11) * 0x1p-53 - 0.5);
            }
        bones_derive_jaw(dof, &b, rider[0], end[0], riding, RIDERS);
        assert_true(dof[0] >= 0.0f && dof[0] <= b.dof[0].max);
        assert_true(fabsf(dof[1]) <= 10.0f && dof[2] >= 0.0f && dof[2] <= 8.0f);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(dofs_are_named_after_their_bones),
        cmocka_unit_test(limits_are_exact_inside_smooth_and_never_passed),
        cmocka_unit_test(limits_can_be_undone),
        cmocka_unit_test(at_rest_nothing_moves_bit_for_bit),
        cmocka_unit_test(an_open_jaw_gapes_45_to_55_mm),
        cmocka_unit_test(condyles_slide_as_the_jaw_opens),
        cmocka_unit_test(the_jaw_goes_aside_alike_on_both_sides),
        cmocka_unit_test(the_jaw_gives_way_to_the_cusps),
        cmocka_unit_test(the_envelope_narrows_as_the_jaw_opens),
        cmocka_unit_test(balls_turn_about_their_centre_first_listed_outermost),
        cmocka_unit_test(a_lid_follows_the_gaze_within_its_limits),
        cmocka_unit_test(the_value_of_a_lid_that_follows_stays_the_driven_one),
        cmocka_unit_test(following_is_smooth_and_never_turns_back),
        cmocka_unit_test(what_cannot_be_followed_is_refused),
        cmocka_unit_test(bones_ride_on_a_skull_that_turns),
        cmocka_unit_test(rigs_that_cannot_move_are_refused_by_name),
        cmocka_unit_test(controls_at_rest_leave_the_jaw_exactly_shut),
        cmocka_unit_test(a_pose_of_the_jaw_is_found_again),
        cmocka_unit_test(the_jaw_follows_the_chin_steadily),
        cmocka_unit_test(a_jaw_that_is_torn_to_both_sides_goes_there_in_steps),
        cmocka_unit_test(pulls_upwards_do_not_open_it),
        cmocka_unit_test(too_few_controls_leave_the_last_values),
        cmocka_unit_test(the_derived_jaw_keeps_within_its_limits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
