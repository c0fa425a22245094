/* A rig's poses on its face: bones turn, contacts land where their pulls ride to, nothing of one
 * pose is left in the next; and the puppet's expressions are sound. mm. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "rig_help.h"
#include "face/rig/rig_poses.h"
#include "stage/perform/face_file.h"

#include <math.h>

/* A plane that rides on a head, which turns about +z; one contact at (10, 10, 0), one in the
 * middle. */
static const char plane_rig[] =
    "\"unit\": \"mm\", \"bones\": [{\"name\": \"skull\", \"ball\": {\"centre\": [0, 0, 0]}, "
    "\"turns\": [{\"name\": \"turn\", \"axis\": [0, 0, 1], \"deg\": [-120, 120]}]}], "
    "\"contacts\": [{\"name\": \"corner\", \"vertex\": 18}, {\"name\": \"middle\", \"vertex\": "
    "12}], \"poses\": ["
    "{\"name\": \"turned\", \"dofs\": {\"skull.turn\": 90}, \"pulls\": {\"corner\": [4, 0, 3]}}, "
    "{\"name\": \"rest\"}, "
    "{\"name\": \"folded\", \"pulls\": {\"middle\": [35, 0, 0]}}], "
    "\"solver\": {\"kernel\": \"wendland_c2\", \"radius_mm\": 30, \"polynomial\": \"none\"}";
enum { TURNED, REST, FOLDED, CORNER = 18, MIDDLE = 12 };

typedef struct plane {
    rig rig;
    mesh mesh;
    topology topology;
    rig_poses_stage stage;
} plane;

static void open_plane(plane *out)
{
    error err = {""};
    if (rig_with(&out->rig, plane_rig, &err) < 0)
        fail_msg("%s", err.text);
    out->mesh = make_sheet();
    out->topology = make_topology(&out->mesh);
    if (rig_poses_stage_init(&out->stage, &out->rig, &out->mesh, &out->topology, &err) < 0)
        fail_msg("%s", err.text);
}

static void close_plane(plane *p)
{
    rig_poses_stage_finish(&p->stage);
    topology_destroy(&p->topology);
    mesh_destroy(&p->mesh);
    rig_destroy(&p->rig);
}

static void show(rig_poses_stage *stage, uint32_t pose)
{
    error err = {""};
    if (rig_poses_show(stage, pose, &err) < 0)
        fail_msg("%s", err.text);
}

static void assert_at(const rig_poses_stage *stage, uint32_t vertex, float x, float y, float z)
{
    const float *p = stage->position + (size_t)vertex * 3;
    const float apart = fabsf(p[0] - x) + fabsf(p[1] - y) + fabsf(p[2] - z);
    if (!(apart < 1e-3f))
        fail_msg("vertex %u is at %g %g %g", vertex, (double)p[0], (double)p[1], (double)p[2]);
}

static void pulls_ride_on_turned_bones(void **state)
{
    (void)state;
    plane p;
    open_plane(&p);
    show(&p.stage, TURNED);
    assert_at(&p.stage, CORNER, -10.0f, 14.0f, 3.0f); /* (14, 10, 3), a quarter turn on */
    rig_poses_measure m = rig_poses_measured(&p.stage);
    assert_true(m.furthest_mm > 39.9 && m.furthest_mm < 42.0); /* the sheet's corners: 40 */
    assert_true(m.least_determinant > 0.0 && m.least_determinant <= 1.0);
    close_plane(&p);
}

static void no_pose_is_left_in_the_next(void **state)
{
    (void)state;
    plane p;
    open_plane(&p);
    show(&p.stage, FOLDED);
    show(&p.stage, TURNED);
    show(&p.stage, REST);
    for (uint32_t i = 0; i < p.mesh.vertex_count * 3; ++i)
        assert_true(fabsf(p.stage.position[i] - p.mesh.position[i]) < 1e-5f);
    rig_poses_measure m = rig_poses_measured(&p.stage);
    assert_true(m.furthest_mm < 1e-4 && fabs(m.least_determinant - 1.0) < 1e-6);
    close_plane(&p);
}

static void a_pose_that_folds_is_measured_as_one(void **state)
{
    (void)state;
    plane p;
    open_plane(&p);
    show(&p.stage, FOLDED);
    rig_poses_measure m = rig_poses_measured(&p.stage);
    assert_true(m.least_determinant < 0.0);
    assert_int_equal(m.furthest_vertex, MIDDLE);
    assert_true(fabs(m.furthest_mm - 35.0) < 1e-3);
    close_plane(&p);
}

/* What is seen becomes a pose, and that pose is seen as the same. */
static void a_shape_becomes_a_pose_that_gives_the_shape(void **state)
{
    (void)state;
    plane p;
    error err = {""};
    rig_pose made;
    open_plane(&p);
    show(&p.stage, TURNED);
    const bones *b = face_bones(p.stage.face);
    float dof[MRT_MAX_DOFS] = {0.0f};
    vec3 at[2] = {face_contact_now(p.stage.face, 1), face_contact_now(p.stage.face, 2)};
    dof[0] = (float)p.rig.pose[TURNED].dof_value[0];
    assert_int_equal(b->dof_count, 1);
    if (rig_poses_of(&made, "again", p.stage.face, 1, &p.rig, &p.stage.solver, at, dof, &err) < 0)
        fail_msg("%s", err.text);
    assert_string_equal(made.name, "again");
    assert_int_equal(made.dof_count, 1);
    assert_string_equal(made.dof_name[0], "skull.turn");
    assert_true(fabs(made.dof_value[0] - p.rig.pose[TURNED].dof_value[0]) < 1e-6);
    assert_true(made.pull_count >= 1 && made.pull_contact[0] == 0);
    const vec3 meant = p.rig.pose[TURNED].pull_mm[0];
    assert_true(vec3_length(vec3_sub(made.pull_mm[0], meant)) < 0.01);
    rig_pose_finish(&made);
    close_plane(&p);
}

/* ---- the puppet ---- */

/* Greatest motion of the contacts to the subject's left, whose mirror has another one. */
static double asymmetry(const rig *r, const mesh *m, const rig_poses_stage *stage)
{
    double most = 0.0;
    for (uint32_t i = 0; i < r->contact_count; ++i) {
        if (r->contact[i].mirror == RIG_NONE)
            continue;
        size_t a = r->contact[i].vertex * (size_t)3,
               b = r->contact[r->contact[i].mirror].vertex * (size_t)3;
        float up = stage->position[a + 1] - m->position[a + 1];
        float mirrored_up = stage->position[b + 1] - m->position[b + 1];
        most = fmax(most, (double)fabsf(up - mirrored_up));
    }
    return most;
}

/* Between the middles of the lips, mm; 11.7 at rest. */
static double lips_apart(const rig *r, const rig_poses_stage *stage)
{
    uint32_t upper = rig_find_contact(r, "lip.upper.mid"),
             lower = rig_find_contact(r, "lip.lower.mid");
    assert_true(upper != RIG_NONE && lower != RIG_NONE);
    const float *a = stage->position + (size_t)3 * r->contact[upper].vertex;
    const float *b = stage->position + (size_t)3 * r->contact[lower].vertex;
    return vec3_length((vec3){(double)(a[0] - b[0]), (double)(a[1] - b[1]), (double)(a[2] - b[2])});
}

static void expressions_of_the_puppet_are_sound(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double lips_least_mm, lips_most_mm;
    } expected[] = {{"joy", 35.0, 70.0},
                    {"surprise", 35.0, 80.0},
                    {"grumpy", 3.0, 11.0},
                    {"mischief", 5.0, 14.0}};
    face_file f;
    rig_poses_stage stage;
    error err = {""};
    if (face_file_read(&f, SOURCE_DIR "/rigs/puppet/puppet.rig.json", NULL, FACE_FILE_USABLE,
                       &err) < 0 ||
        rig_poses_stage_init(&stage, f.rig, &f.mesh, &f.topology, &err) < 0)
        fail_msg("%s", err.text);
    assert_true(f.rig->pose_count >= 4);
    for (uint32_t i = 0; i < 4; ++i) {
        assert_string_equal(f.rig->pose[i].name, expected[i].name);
        show(&stage, i);
        rig_poses_measure m = rig_poses_measured(&stage);
        double lips_mm = lips_apart(f.rig, &stage);
        print_message("%s: least determinant %.3f, penetration %.2f mm, lips %.1f mm apart\n",
                      expected[i].name, m.least_determinant, m.penetration_mm, lips_mm);
        assert_true(m.least_determinant > 0.1);
        assert_true(m.penetration_mm < 0.1);
        assert_true(m.furthest_mm > 10.0 && m.furthest_mm < 80.0);
        assert_true(lips_mm > expected[i].lips_least_mm && lips_mm < expected[i].lips_most_mm);
        if (i == 3)
            assert_true(asymmetry(f.rig, &f.mesh, &stage) > 10.0);
    }
    rig_poses_stage_finish(&stage);
    face_file_destroy(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pulls_ride_on_turned_bones),
        cmocka_unit_test(no_pose_is_left_in_the_next),
        cmocka_unit_test(a_pose_that_folds_is_measured_as_one),
        cmocka_unit_test(a_shape_becomes_a_pose_that_gives_the_shape),
        cmocka_unit_test(expressions_of_the_puppet_are_sound),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
