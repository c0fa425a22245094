/* Fitting a rig's poses and pulls to morph targets, on a sheet with a mouth. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "face/fit.h"
#include "unit/face_sheet.h"

#include <math.h>

/* Contacts: 0 and 1 beside the mouth, 2 the chin's middle, 3 the nose. */
#define CONTACTS                                                                                   \
    "\"contacts\": [{\"name\": \"cheek.l\", \"vertex\": 228}, {\"name\": \"cheek.r\", "            \
    "\"vertex\": 212}, {\"name\": \"chin\", \"vertex\": 115}, {\"name\": \"nose\", "               \
    "\"vertex\": 304}], \"solver\": {\"radius_mm\": 40}"
#define MOBILE                                                                                     \
    "{\"bone\": \"skull\", \"mobility\": 1, \"select\": {\"vertices\": [\"0-399\", \"441-449\"]}}"
#define RIG "{" SHEET_BONES ", \"regions\": [" MOBILE ", " SHEET_REGIONS "], " CONTACTS "}"

typedef struct stage {
    sheet sheet;
    mesh targets;
} stage;

/* A target that the rig can make: the face itself makes it. */
static void add_target(stage *s, const char *name, const float *dof, const vec3 *pull)
{
    face *f;
    error err = {""};
    assert_int_equal(face_create(&f, &s->sheet.rig, &s->sheet.mesh, &s->sheet.topology, 4, &err),
                     MRT_OK);
    face_control control[4];
    double end[12];
    for (uint32_t k = 0; k < 4; k++) {
        control[k] = (face_control){s->sheet.binding.contact_position[k], k + 1};
        vec3 to = vec3_add(control[k].start, pull[k]);
        memcpy(end + 3 * (size_t)k, &to, sizeof to);
    }
    assert_int_equal(face_engage(f, &s->sheet.rig.solver, control, 4, &err), MRT_OK);
    assert_int_equal(face_pull(f, end, dof, &err), MRT_OK);
    mesh_target *target = &s->targets.target[s->targets.target_count++];
    target->name = strdup(name);
    target->offset = malloc(3 * SHEET_COUNT * sizeof(float));
    assert_non_null(target->offset);
    points_to_rows(target->offset, face_shown(f), face_order(f));
    for (size_t i = 0; i < (size_t)3 * SHEET_COUNT; i++)
        target->offset[i] -= s->sheet.mesh.position[i];
    face_destroy(f);
}

static void stage_create(stage *s)
{
    sheet_create(&s->sheet, RIG);
    sheet_create_mesh(&s->targets, 0, 0);
    s->targets.target = calloc(3, sizeof *s->targets.target);
    assert_non_null(s->targets.target);
    static const vec3 smile[4] = {{3, 2, -1}, {-3, 2, -1}, {0, 0, 0}};
    static const vec3 talk[4] = {{1, -2, 0}, {-1, -2, 0}, {0, -6, -4}, {0, 1, 1}};
    add_target(s, "smile", (const float[3]){0, 0, 0}, smile);
    add_target(s, "talk", (const float[3]){0.12f, 0, 0}, talk);
}

static void stage_destroy(stage *s)
{
    mesh_destroy(&s->targets);
    sheet_destroy(&s->sheet);
}

static const uint32_t all_contacts[] = {0, 1, 2, 3};

static void a_face_that_the_rig_can_make_is_found(void **state)
{
    (void)state;
    stage s;
    stage_create(&s);
    fit_options options = {all_contacts, 4, {0}};
    fit_result result[2];
    error err = {""};
    if (fit_targets(result, &s.sheet.rig, &s.sheet.mesh, &s.sheet.topology, &s.targets, &options,
                    &err) != MRT_OK)
        fail_msg("%s", err.text);
    assert_string_equal(result[0].name, "smile");
    for (int i = 0; i < 2; i++) {
        assert_true(result[i].relative_residual < 0.005);
        assert_true(result[i].worst_mm < 0.05);
        assert_true(result[i].rigid_motion_mm == 0);
        assert_true(result[i].min_determinant > 0);
    }
    assert_true(fabs(result[0].pull[0].x - 3) < 0.05 && fabs(result[0].pull[1].x + 3) < 0.05);
    assert_true(fabsf(result[1].dof[0] - 0.12f) < 0.005f);
    fit_results_destroy(result, 2);
    stage_destroy(&s);
}

/* Saved as a pose of the rig, pulls ride on the bones: they must not hold what the jaw does. */
static void dofs_and_riding_pulls_pose_the_fitted_shape(void **state)
{
    (void)state;
    stage s;
    face *f;
    stage_create(&s);
    fit_options options = {all_contacts, 4, {0}};
    fit_result result[2];
    error err = {""};
    assert_int_equal(fit_targets(result, &s.sheet.rig, &s.sheet.mesh, &s.sheet.topology, &s.targets,
                                 &options, &err),
                     MRT_OK);
    assert_int_equal(face_create(&f, &s.sheet.rig, &s.sheet.mesh, &s.sheet.topology, 4, &err),
                     MRT_OK);
    face_control control[4];
    double end[12];
    const uint8_t rides[4] = {1, 1, 1, 1};
    for (uint32_t k = 0; k < 4; k++) {
        control[k] = (face_control){s.sheet.binding.contact_position[k], k + 1};
        memcpy(end + 3 * (size_t)k, &result[1].pull[k], 3 * sizeof *end);
    }
    assert_int_equal(face_engage(f, &s.sheet.rig.solver, control, 4, &err), MRT_OK);
    face_ride(f, end, rides, result[1].dof);
    assert_int_equal(face_pull(f, end, result[1].dof, &err), MRT_OK);
    float *posed = malloc(3 * SHEET_COUNT * sizeof *posed);
    assert_non_null(posed);
    points_to_rows(posed, face_shown(f), face_order(f));
    assert_true(fabsf(result[1].dof[0]) > 0.05f); /* the jaw is open */
    for (size_t i = 0; i < (size_t)3 * SHEET_COUNT; i++)
        assert_true(fabsf(posed[i] - result[1].position[i]) < 1e-3f);
    free(posed);
    face_destroy(f);
    fit_results_destroy(result, 2);
    stage_destroy(&s);
}

static void the_fitted_shape_is_what_the_residual_is_of(void **state)
{
    (void)state;
    stage s;
    stage_create(&s);
    fit_options options = {all_contacts, 1, {0}}; /* one cheek alone */
    fit_result result[2];
    error err = {""};
    assert_int_equal(fit_targets(result, &s.sheet.rig, &s.sheet.mesh, &s.sheet.topology, &s.targets,
                                 &options, &err),
                     MRT_OK);
    double missed = 0, wanted = 0;
    for (uint32_t v = 0; v < SHEET_COUNT; v++)
        for (uint32_t a = 0; a < 3 && s.sheet.binding.mobility[v] > 0; a++) {
            double offset = (double)s.targets.target[0].offset[3 * v + a];
            double moved =
                (double)result[0].position[3 * v + a] - (double)s.sheet.mesh.position[3 * v + a];
            missed += (moved - offset) * (moved - offset);
            wanted += offset * offset;
        }
    assert_true(fabs(result[0].relative_residual - sqrt(missed / wanted)) < 1e-4);
    assert_true(result[0].relative_residual > 0.3);
    fit_results_destroy(result, 2);
    stage_destroy(&s);
}

static void the_papers_warp_cannot_part_the_lips(void **state)
{
    (void)state;
    stage s;
    stage_create(&s);
    fit_options options = {all_contacts, 4, {0}};
    fit_result result[2];
    error err = {""};
    assert_int_equal(fit_targets(result, &s.sheet.rig, &s.sheet.mesh, &s.sheet.topology, &s.targets,
                                 &options, &err),
                     MRT_OK);
    assert_true(result[1].paper_residual > 0.2);
    fit_results_destroy(result, 2);
    stage_destroy(&s);
}

static void a_target_that_moves_nothing_has_no_residual(void **state)
{
    (void)state;
    stage s;
    stage_create(&s);
    memset(s.targets.target[0].offset, 0, 3 * SHEET_COUNT * sizeof(float));
    fit_options options = {all_contacts, 4, {0}};
    fit_result result[2];
    error err = {""};
    assert_int_equal(fit_targets(result, &s.sheet.rig, &s.sheet.mesh, &s.sheet.topology, &s.targets,
                                 &options, &err),
                     MRT_OK);
    assert_true(result[0].relative_residual == 0);
    assert_memory_equal(result[0].position, s.sheet.mesh.position, 3 * SHEET_COUNT * sizeof(float));
    fit_results_destroy(result, 2);
    stage_destroy(&s);
}

static void without_contacts_the_bones_are_fitted_alone(void **state)
{
    (void)state;
    stage s;
    stage_create(&s);
    fit_options options = {NULL, 0, {0}};
    fit_result result[2];
    error err = {""};
    assert_int_equal(fit_targets(result, &s.sheet.rig, &s.sheet.mesh, &s.sheet.topology, &s.targets,
                                 &options, &err),
                     MRT_OK);
    assert_true(result[1].dof[0] > 0.05f && result[1].relative_residual < 0.6);
    assert_true(fabs(result[1].paper_residual - 1) < 1e-6);
    fit_results_destroy(result, 2);
    stage_destroy(&s);
}

static void what_does_not_fit_together_is_refused(void **state)
{
    (void)state;
    stage s;
    stage_create(&s);
    static const uint32_t unknown[] = {9}, twice[] = {1, 1};
    const fit_options bad[] = {{unknown, 1, {0}}, {twice, 2, {0}}};
    fit_result result[2];
    error err = {""};
    for (int i = 0; i < 2; i++)
        assert_int_equal(fit_targets(result, &s.sheet.rig, &s.sheet.mesh, &s.sheet.topology,
                                     &s.targets, &bad[i], &err),
                         MRT_ERR_ARGUMENT);
    assert_non_null(strstr(err.text, "cheek.r"));
    mesh other = s.targets;
    other.vertex_count--;
    fit_options options = {all_contacts, 4, {0}};
    assert_int_equal(
        fit_targets(result, &s.sheet.rig, &s.sheet.mesh, &s.sheet.topology, &other, &options, &err),
        MRT_ERR_ARGUMENT);
    assert_non_null(strstr(err.text, "449 vertices"));
    uint32_t vertex[65], count;
    assert_int_equal(fit_suggest(vertex, &count, 65, &s.sheet.rig, &s.sheet.mesh, &s.sheet.topology,
                                 &s.targets, &s.sheet.rig.solver, &err),
                     MRT_ERR_ARGUMENT);
    stage_destroy(&s);
}

static uint32_t mirrored(const mesh *m, uint32_t v)
{
    for (uint32_t other = 0; other < m->vertex_count; other++)
        if (m->position[3 * other] == -m->position[3 * v] &&
            m->position[3 * other + 1] == m->position[3 * v + 1])
            return other;
    return UINT32_MAX;
}

static void suggested_contacts_are_mirrored_and_near_what_moves(void **state)
{
    (void)state;
    stage s;
    stage_create(&s);
    s.targets.target_count = 1; /* the smile */
    uint32_t vertex[4], count;
    csrbf_settings settings = {.radius = 40};
    error err = {""};
    mrt_result result = fit_suggest(vertex, &count, 2, &s.sheet.rig, &s.sheet.mesh,
                                    &s.sheet.topology, &s.targets, &settings, &err);
    s.targets.target_count = 2;
    assert_int_equal(result, MRT_OK);
    assert_int_equal(count, 2);
    assert_int_equal(mirrored(&s.sheet.mesh, vertex[0]), vertex[1]);
    float x = fabsf(s.sheet.mesh.position[3 * vertex[0]]);
    float y = s.sheet.mesh.position[3 * vertex[0] + 1];
    assert_true(fabsf(x - 40) <= 10 && fabsf(y) <= 10); /* where the cheeks were pulled */
    stage_destroy(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_face_that_the_rig_can_make_is_found),
        cmocka_unit_test(dofs_and_riding_pulls_pose_the_fitted_shape),
        cmocka_unit_test(the_fitted_shape_is_what_the_residual_is_of),
        cmocka_unit_test(the_papers_warp_cannot_part_the_lips),
        cmocka_unit_test(a_target_that_moves_nothing_has_no_residual),
        cmocka_unit_test(without_contacts_the_bones_are_fitted_alone),
        cmocka_unit_test(what_does_not_fit_together_is_refused),
        cmocka_unit_test(suggested_contacts_are_mirrored_and_near_what_moves),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
