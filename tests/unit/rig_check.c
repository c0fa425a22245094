/* What rig_check and rig_validate find: on rigs of this project with one thing wrong each. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "face/rig_check.h"
#include "io/openmesh.h"
#include "stage/perform/face_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static face_file moai;
static binding moai_binding;

static int read_moai(void **state)
{
    (void)state;
    error err = {""};
    if (face_file_read(&moai, SOURCE_DIR "/rigs/moai/moai.rig.json", NULL, FACE_FILE_USABLE, &err) <
            0 ||
        binding_create(&moai_binding, moai.rig, &moai.mesh, &moai.topology, &err) < 0) {
        print_error("%s\n", err.text);
        return -1;
    }
    return 0;
}

static int destroy_moai(void **state)
{
    (void)state;
    binding_destroy(&moai_binding);
    face_file_destroy(&moai);
    return 0;
}

static rig_findings check_moai(void)
{
    rig_findings out;
    error err = {""};
    assert_int_equal(rig_check(&out, moai.rig, &moai.mesh, &moai.topology, &moai_binding, &err),
                     MRT_OK);
    return out;
}

static const rig_finding *find(const rig_findings *all, const char *words)
{
    for (uint32_t i = 0; i < all->count; ++i)
        if (strstr(all->item[i].text, words))
            return &all->item[i];
    for (uint32_t i = 0; i < all->count; ++i)
        print_message("%s: %s\n", all->item[i].path, all->item[i].text);
    fail_msg("nothing says: %s", words);
    return NULL;
}

static void assert_found(rig_severity severity, const char *path, const char *words)
{
    rig_findings all = check_moai();
    const rig_finding *found = find(&all, words);
    assert_int_equal(found->severity, severity);
    assert_string_equal(found->path, path);
    rig_findings_finish(&all);
}

static void assert_invalid(const char *start, const char *words)
{
    error err = {""};
    assert_true(rig_validate(moai.rig, &moai.mesh, &moai.topology, &err) < 0);
    if (strncmp(err.text, start, strlen(start)) != 0 || !strstr(err.text, words))
        fail_msg("%s", err.text);
}

static void rigs_of_the_project_have_no_errors_no_warnings_and_no_stale_hash(void **state)
{
    (void)state;
    static const char *const paths[] = {SOURCE_DIR "/rigs/moai/moai.rig.json",
                                        SOURCE_DIR "/rigs/puppet/puppet.rig.json"};
    for (size_t i = 0; i < sizeof paths / sizeof *paths; ++i) {
        face_file f;
        binding b;
        rig_findings all;
        error err = {""};
        if (face_file_read(&f, paths[i], NULL, FACE_FILE_USABLE, &err) < 0 ||
            binding_create(&b, f.rig, &f.mesh, &f.topology, &err) < 0 ||
            rig_check(&all, f.rig, &f.mesh, &f.topology, &b, &err) < 0)
            fail_msg("%s", err.text);
        assert_int_equal(f.rig->contact_count, 27);
        for (uint32_t k = 0; k < all.count; ++k)
            if (all.item[k].severity != RIG_NOTE || strcmp(all.item[k].path, "$.mesh_hash") == 0)
                fail_msg("%s: %s: %s", paths[i], all.item[k].path, all.item[k].text);
        rig_findings_finish(&all);
        binding_destroy(&b);
        face_file_destroy(&f);
    }
}

static void another_vertex_count_names_both(void **state)
{
    (void)state;
    uint32_t count = moai.rig->mesh_vertex_count;
    moai.rig->mesh_vertex_count = 12;
    assert_invalid("$.mesh_vertices: ", "a mesh of 12 vertices, but this one has 3578");
    assert_found(RIG_ERROR, "$.mesh_vertices", "of 12 vertices");
    moai.rig->mesh_vertex_count = count;
}

static void another_hash_is_a_note(void **state)
{
    (void)state;
    moai.rig->mesh_hash ^= 1;
    assert_found(RIG_NOTE, "$.mesh_hash", "triangles changed");
    moai.rig->mesh_hash ^= 1;
}

static void a_contact_beyond_the_mesh_is_an_error(void **state)
{
    (void)state;
    uint32_t vertex = moai.rig->contact[3].vertex;
    moai.rig->contact[3].vertex = 3578;
    assert_invalid("$.contacts[3].vertex: ", "vertex 3578 does not exist, the mesh has 3578");
    moai.rig->contact[3].vertex = vertex;
}

static void exchanged_condyles_are_an_error(void **state)
{
    (void)state;
    vec3 *left = &moai.rig->bone[1].hinge_left, *right = &moai.rig->bone[1].hinge_right;
    vec3 kept = *left;
    *left = *right;
    *right = kept;
    assert_invalid("$.bones[1].hinge: ", "exchange them");
    assert_found(RIG_ERROR, "$.bones[1].hinge", "exchange them");
    *right = *left;
    *left = kept;
}

static void a_far_axis_is_a_warning(void **state)
{
    (void)state;
    moai.rig->bone[1].hinge_left.y += 150.0;
    moai.rig->bone[1].hinge_right.y += 150.0;
    assert_found(RIG_WARNING, "$.bones[1]", "of the way from chin to top");
    moai.rig->bone[1].hinge_left.y -= 150.0;
    moai.rig->bone[1].hinge_right.y -= 150.0;
}

static void a_jaw_that_hardly_opens_is_a_warning(void **state)
{
    (void)state;
    double open = moai.rig->bone[1].open_max_rad, slide = moai.rig->bone[1].slide_mm;
    moai.rig->bone[1].open_max_rad = 0.1;
    moai.rig->bone[1].slide_mm = 0.0;
    assert_found(RIG_WARNING, "$.bones[1]", "the incisors are");
    moai.rig->bone[1].open_max_rad = open;
    moai.rig->bone[1].slide_mm = slide;
}

static void a_mouth_that_is_not_between_nose_and_chin_is_a_warning(void **state)
{
    (void)state;
    rig_contact *lip = &moai.rig->contact[rig_find_contact(moai.rig, "lip.lower.mid")];
    const uint32_t kept = lip->vertex;
    lip->vertex = moai.rig->contact[rig_find_contact(moai.rig, "forehead.mid")].vertex;
    assert_found(RIG_WARNING, "$.contacts", "\"lip.lower.mid\" does not lie below");
    lip->vertex = kept;
}

static void teeth_before_the_lips_are_a_warning(void **state)
{
    (void)state;
    rig_bone *jaw = &moai.rig->bone[1];
    const rig_bone kept = *jaw;
    jaw->has_incisor = true;
    jaw->incisor = (vec3){0.0, 80.0, 400.0};
    assert_found(RIG_WARNING, "$.bones[1]", "before the lips");
    *jaw = kept;
}

static void a_jaw_that_moves_nothing_is_a_warning(void **state)
{
    (void)state;
    rig_findings all;
    binding b;
    error err = {""};
    assert_true(binding_create(&b, moai.rig, &moai.mesh, &moai.topology, &err) >= 0);
    memset(b.weight + b.vertex_count, 0, b.vertex_count * sizeof *b.weight);
    assert_true(rig_check(&all, moai.rig, &moai.mesh, &moai.topology, &b, &err) >= 0);
    assert_int_equal(find(&all, "the jaw moves no skin")->severity, RIG_WARNING);
    rig_findings_finish(&all);
    binding_destroy(&b);
}

static void a_contact_on_what_is_rigid_is_a_warning(void **state)
{
    (void)state;
    uint32_t contact = rig_find_contact(moai.rig, "forehead.mid"), top = 0;
    uint32_t vertex = moai.rig->contact[contact].vertex;
    for (uint32_t v = 0; v < moai.mesh.vertex_count; ++v)
        if (moai.mesh.position[v * 3 + 1] > moai.mesh.position[top * 3 + 1])
            top = v;
    moai.rig->contact[contact].vertex = top;
    rig_findings all = check_moai();
    assert_int_equal(find(&all, "\"forehead.mid\" cannot be pulled")->severity, RIG_WARNING);
    rig_findings_finish(&all);
    moai.rig->contact[contact].vertex = vertex;
}

static void a_mirror_that_is_none_is_a_warning_with_a_better_vertex(void **state)
{
    (void)state;
    uint32_t left = rig_find_contact(moai.rig, "cheek.l");
    uint32_t right = rig_find_contact(moai.rig, "cheek.r");
    uint32_t vertex = moai.rig->contact[right].vertex;
    moai.rig->contact[right].vertex =
        moai.rig->contact[rig_find_contact(moai.rig, "jaw.angle.r")].vertex;
    char better[64];
    (void)snprintf(better, sizeof better, "vertex %u would be 0.0 mm off", vertex);
    rig_findings all = check_moai();
    assert_int_equal(find(&all, better)->severity, RIG_WARNING);
    rig_findings_finish(&all);
    moai.rig->contact[right].vertex = vertex;
    assert_true(left != RIG_NONE);
}

static void left_on_the_right_is_a_warning(void **state)
{
    (void)state;
    rig_contact *left = &moai.rig->contact[rig_find_contact(moai.rig, "cheek.l")];
    rig_contact *right = &moai.rig->contact[rig_find_contact(moai.rig, "cheek.r")];
    uint32_t kept = left->vertex;
    left->vertex = right->vertex;
    right->vertex = kept;
    rig_findings all = check_moai();
    assert_int_equal(find(&all, "+x is the subject's left")->severity, RIG_WARNING);
    rig_findings_finish(&all);
    right->vertex = left->vertex;
    left->vertex = kept;
}

static void a_small_radius_is_a_warning(void **state)
{
    (void)state;
    double radius = moai.rig->solver.radius;
    moai.rig->solver.radius = 4.0;
    assert_found(RIG_WARNING, "$.solver.radius_mm", "the skin dips");
    moai.rig->solver.radius = radius;
}

static void a_wrong_unit_and_lost_symmetry_are_found(void **state)
{
    (void)state;
    size_t count = (size_t)moai.mesh.vertex_count * 3;
    float *kept = malloc(count * sizeof *kept);
    assert_non_null(kept);
    memcpy(kept, moai.mesh.position, count * sizeof *kept);
    for (size_t i = 0; i < count; ++i)
        moai.mesh.position[i] *= 0.01f;
    assert_found(RIG_WARNING, "$.unit", "check the unit");
    memcpy(moai.mesh.position, kept, count * sizeof *kept);
    moai.mesh.position[9] += 3.0f;
    assert_found(RIG_NOTE, "$.mesh", "have no mirror image");
    memcpy(moai.mesh.position, kept, count * sizeof *kept);
    free(kept);
}

static void a_surface_turned_in_is_a_warning(void **state)
{
    (void)state;
    for (int pass = 0; pass < 2; ++pass) {
        for (uint32_t i = 0; i < moai.mesh.triangle_count; ++i) {
            uint32_t *corner = moai.mesh.triangle + (size_t)i * 3, kept = corner[1];
            corner[1] = corner[2];
            corner[2] = kept;
        }
        if (pass == 0)
            assert_found(RIG_WARNING, "$.mesh", "faces inwards");
    }
}

/* A copy of a contact's vertex in the same place that another bone owns: the edge of a lip. */
static void a_contact_on_a_seam_is_an_error_unless_its_bone_is_named(void **state)
{
    (void)state;
    uint32_t upper = rig_find_contact(moai.rig, "lip.upper.mid");
    uint32_t a = moai.rig->contact[upper].vertex;
    uint32_t b = moai.rig->contact[rig_find_contact(moai.rig, "lip.lower.mid")].vertex;
    float kept[3];
    memcpy(kept, moai.mesh.position + (size_t)b * 3, sizeof kept);
    memcpy(moai.mesh.position + (size_t)b * 3, moai.mesh.position + (size_t)a * 3, sizeof kept);
    rig_findings all = check_moai();
    const rig_finding *found = find(&all, "is on a seam");
    assert_int_equal(found->severity, RIG_ERROR);
    assert_non_null(strstr(found->path, "$.contacts["));
    rig_findings_finish(&all);
    moai.rig->contact[upper].bone = 0;
    moai.rig->contact[rig_find_contact(moai.rig, "lip.lower.mid")].bone = 1;
    all = check_moai();
    assert_int_equal(rig_findings_count(&all, RIG_ERROR), 0);
    rig_findings_finish(&all);
    moai.rig->contact[upper].bone = RIG_NONE;
    moai.rig->contact[rig_find_contact(moai.rig, "lip.lower.mid")].bone = RIG_NONE;
    memcpy(moai.mesh.position + (size_t)b * 3, kept, sizeof kept);
}

/* Two strips of skin that touch along a line of six places: which vertices ride on what. */
static void check_strips(rig_findings *out, const char *on_jaw, const char *on_skull)
{
    enum { LONG = 6, STRIP = 2 * LONG };
    mesh m;
    topology t;
    rig r;
    binding b;
    error err = {""};
    char text[1024];
    assert_int_equal(mesh_create(&m, 2 * STRIP, 4 * (LONG - 1), &err), MRT_OK);
    uint32_t count = 0;
    for (uint32_t v = 0; v < 2 * STRIP; ++v) {
        m.position[3 * v] = 20.0f * (float)(v % LONG);
        m.position[3 * v + 1] = v / LONG == 0 ? 0.0f : v / LONG == 3 ? 200.0f : 100.0f;
    }
    for (uint32_t strip = 0; strip < 2; ++strip)
        for (uint32_t i = 0; i + 1 < LONG; ++i) {
            uint32_t a = strip * STRIP + i;
            const uint32_t corner[6] = {a, a + 1, a + 1 + LONG, a, a + 1 + LONG, a + LONG};
            memcpy(m.triangle + 3 * (size_t)count, corner, sizeof corner);
            count += 2;
        }
    (void)snprintf(text, sizeof text,
                   "{\"marotte_rig\": 1, \"mesh\": \"strips.obj\", \"unit\": \"mm\", \"bones\": "
                   "[{\"name\": \"skull\"}, {\"name\": \"jaw\", \"hinge\": {\"left\": [60, 0, "
                   "-80], \"right\": [-60, 0, -80]}, \"incisor\": [0, -40, 0]}], \"regions\": "
                   "[{\"bone\": \"jaw\", \"weight\": 1, \"select\": {\"vertices\": [\"%s\"]}}, "
                   "{\"bone\": \"skull\", \"weight\": 1, \"select\": {\"vertices\": "
                   "[\"%s\"]}}], \"contacts\": []}",
                   on_jaw, on_skull);
    assert_true(rig_parse(&r, text, strlen(text), "strips.rig.json", &err) >= 0);
    assert_true(openmesh_topology(&t, &m, &err) >= 0);
    if (binding_create(&b, &r, &m, &t, &err) < 0)
        fail_msg("%s", err.text);
    assert_int_equal(rig_check(out, &r, &m, &t, &b, &err), MRT_OK);
    binding_destroy(&b);
    topology_destroy(&t);
    rig_destroy(&r);
    mesh_destroy(&m);
}

static void pieces_that_touch_and_would_part_are_a_warning(void **state)
{
    (void)state;
    rig_findings all;
    check_strips(&all, "0-11", "12-23");
    assert_int_equal(find(&all, "touch at 6 places but follow different bones")->severity,
                     RIG_WARNING);
    rig_findings_finish(&all);
    check_strips(&all, "0-5", "6-23");
    for (uint32_t i = 0; i < all.count; ++i)
        assert_null(strstr(all.item[i].text, "gaps open there"));
    rig_findings_finish(&all);
}

static void a_pose_that_reaches_into_the_other_half_is_a_warning(void **state)
{
    (void)state;
    char name[] = "talk", nod[] = "skull.nod";
    char *dof[] = {nod};
    double turn = 0.1;
    uint32_t contact[2] = {rig_find_contact(moai.rig, "chin"),
                           rig_find_contact(moai.rig, "brow.mid.l")};
    vec3 way[2] = {{0, 4, 0}, {0, 4, 0}};
    rig_pose pose = {
        .name = name, .part = POSE_MOUTH, .pull_contact = contact, .pull_mm = way, .pull_count = 2};
    rig_pose *had = moai.rig->pose;
    uint32_t had_count = moai.rig->pose_count;
    moai.rig->pose = &pose;
    moai.rig->pose_count = 1;
    assert_found(RIG_WARNING, "$.poses[0]", "\"brow.mid.l\" does not belong to the part \"mouth\"");
    pose.part = POSE_UPPER;
    assert_found(RIG_WARNING, "$.poses[0]", "\"chin\" does not belong to the part \"upper\"");
    pose.pull_count = 0;
    pose.dof_name = dof;
    pose.dof_value = &turn;
    pose.dof_count = 1;
    assert_found(RIG_WARNING, "$.poses[0]", "\"skull.nod\" does not belong to the part \"upper\"");
    pose.part = POSE_WHOLE;
    rig_findings all = check_moai();
    for (uint32_t i = 0; i < all.count; ++i)
        assert_null(strstr(all.item[i].text, "does not belong to the part"));
    rig_findings_finish(&all);
    moai.rig->pose = had;
    moai.rig->pose_count = had_count;
}

/* What is asked for and what is given. */
static void a_pose_that_folds_is_held_back_and_a_warning(void **state)
{
    (void)state;
    char name[] = "torn";
    uint32_t contact = rig_find_contact(moai.rig, "brow.inner.l");
    vec3 way = {60, 0, 0};
    rig_pose pose = {.name = name, .pull_contact = &contact, .pull_mm = &way, .pull_count = 1};
    rig_pose *had = moai.rig->pose;
    uint32_t had_count = moai.rig->pose_count;
    rig_findings all = {0};
    error err = {""};
    moai.rig->pose = &pose;
    moai.rig->pose_count = 1;
    assert_int_equal(
        rig_check_poses(&all, moai.rig, &moai.mesh, &moai.topology, &moai_binding, &err), MRT_OK);
    assert_int_equal(all.count, 2);
    assert_int_equal(find(&all, "\"torn\" is held back by up to")->severity, RIG_WARNING);
    assert_int_equal(find(&all, "poses hold all 27 contacts")->severity, RIG_NOTE);
    rig_findings_finish(&all);
    moai.rig->pose = had;
    moai.rig->pose_count = had_count;
}

static void poses_in_another_unit_are_warnings(void **state)
{
    (void)state;
    uint32_t contact = 0;
    vec3 pull = {0, 0, 400};
    char jaw[] = "jaw.open", *dof[] = {jaw};
    double value = 0.4 * 0.017453292519943295; /* who wrote 0.4 meant radians */
    rig_pose pose = {.name = (char[]){"far"},
                     .dof_name = dof,
                     .dof_value = &value,
                     .dof_count = 1,
                     .pull_contact = &contact,
                     .pull_mm = &pull,
                     .pull_count = 1};
    rig_pose *had = moai.rig->pose;
    uint32_t had_count = moai.rig->pose_count;
    moai.rig->pose = &pose;
    moai.rig->pose_count = 1;
    assert_found(RIG_WARNING, "$.poses[0]",
                 "is pulled by 400 mm, more than the height of the head");
    assert_found(RIG_WARNING, "$.poses[0]", "are these radians? Turns are in degrees");
    pull.z = 0.004;
    assert_found(RIG_WARNING, "$.poses[0]",
                 "pulls no contact by more than 0.004 mm: are these metres?");
    moai.rig->pose = had;
    moai.rig->pose_count = had_count;
}

static void errors_come_first(void **state)
{
    (void)state;
    uint32_t count = moai.rig->mesh_vertex_count;
    double radius = moai.rig->solver.radius;
    moai.rig->mesh_vertex_count = 12;
    moai.rig->solver.radius = 4.0;
    rig_findings all = check_moai();
    assert_int_equal(all.item[0].severity, RIG_ERROR);
    for (uint32_t i = 1; i < all.count; ++i)
        assert_true(all.item[i - 1].severity >= all.item[i].severity);
    rig_findings_finish(&all);
    moai.rig->mesh_vertex_count = count;
    moai.rig->solver.radius = radius;
}

static void a_missing_mesh_names_the_rig_and_the_place(void **state)
{
    (void)state;
    face_file f;
    error err = {""};
    static const char path[] = BUILD_DIR "/missing_mesh.rig.json";
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs("{\"marotte_rig\": 1, \"mesh\": \"not_there.glb\"}", file);
    fclose(file);
    assert_true(face_file_read(&f, path, NULL, FACE_FILE_ANY, &err) < 0);
    (void)remove(path);
    assert_non_null(strstr(err.text, "missing_mesh.rig.json: $.mesh: "));
    assert_non_null(strstr(err.text, "not_there.glb: No such file"));
}

/* A bone of the Moai that is a loose part: the jaw's vertices hang on it. */
static void loose_parts_that_are_none_are_named(void **state)
{
    (void)state;
    static char turn[] = "nod";
    rig *r = moai.rig;
    const rig_bone kept = r->bone[0];
    r->bone[0] = (rig_bone){.name = kept.name,
                            .kind = BONE_BALL,
                            .parent = RIG_NONE,
                            .turn_count = 1,
                            .turn[0] = {turn, {1, 0, 0}, -0.3, 0.3, {0}},
                            .spring = {{0, 90, 0}, 3.0, 0.3, 1.0, 0.0, 0.0}};
    rig_findings found = check_moai();
    (void)find(&found, "no bone carries it");
    (void)find(&found, "% of the mesh; mark only the loose part");
    rig_findings_finish(&found);
    r->bone[0].turn[0].axis = (vec3){0, 1, 0};
    found = check_moai();
    (void)find(&found, "its turns go about the line from its centre to its tip");
    rig_findings_finish(&found);
    r->bone[0] = kept;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(loose_parts_that_are_none_are_named),
        cmocka_unit_test(rigs_of_the_project_have_no_errors_no_warnings_and_no_stale_hash),
        cmocka_unit_test(another_vertex_count_names_both),
        cmocka_unit_test(another_hash_is_a_note),
        cmocka_unit_test(a_contact_beyond_the_mesh_is_an_error),
        cmocka_unit_test(exchanged_condyles_are_an_error),
        cmocka_unit_test(a_far_axis_is_a_warning),
        cmocka_unit_test(a_jaw_that_hardly_opens_is_a_warning),
        cmocka_unit_test(a_mouth_that_is_not_between_nose_and_chin_is_a_warning),
        cmocka_unit_test(teeth_before_the_lips_are_a_warning),
        cmocka_unit_test(a_jaw_that_moves_nothing_is_a_warning),
        cmocka_unit_test(a_contact_on_what_is_rigid_is_a_warning),
        cmocka_unit_test(a_mirror_that_is_none_is_a_warning_with_a_better_vertex),
        cmocka_unit_test(left_on_the_right_is_a_warning),
        cmocka_unit_test(a_small_radius_is_a_warning),
        cmocka_unit_test(a_wrong_unit_and_lost_symmetry_are_found),
        cmocka_unit_test(a_surface_turned_in_is_a_warning),
        cmocka_unit_test(a_contact_on_a_seam_is_an_error_unless_its_bone_is_named),
        cmocka_unit_test(pieces_that_touch_and_would_part_are_a_warning),
        cmocka_unit_test(poses_in_another_unit_are_warnings),
        cmocka_unit_test(a_pose_that_reaches_into_the_other_half_is_a_warning),
        cmocka_unit_test(a_pose_that_folds_is_held_back_and_a_warning),
        cmocka_unit_test(errors_come_first),
        cmocka_unit_test(a_missing_mesh_names_the_rig_and_the_place),
    };
    return cmocka_run_group_tests(tests, read_moai, destroy_moai);
}
