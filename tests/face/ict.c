/* The rig of the ICT face against the expressions that were sculpted for it: how close it comes,
 * and what must not move. The face is not part of the project: it lies in $MAROTTE_SHARED, or in
 * shared/ beside the sources; without it this is skipped. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "face/fit.h"
#include "face/rig_draft.h"
#include "io/mesh_file.h"
#include "io/openmesh.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Of ict_face_parts.json. */
typedef struct part {
    uint32_t first, last;
} part;
static const part teeth_upper = {17039, 19246}, eyeballs = {21451, 24590}, cranium = {9409, 11247};

static mesh head;
static topology surface;
static rig ict;

static void require(mrt_result result, const error *err)
{
    if (result < 0)
        fail_msg("%s", err->text);
}

/* ---- targets ---- */

typedef struct portion {
    const char *name;
    float amount;
} portion;

static const float *offset_named(const char *name)
{
    for (uint32_t t = 0; t < head.target_count; t++)
        if (strcmp(head.target[t].name, name) == 0)
            return head.target[t].offset;
    fail_msg("the face has no target %s", name);
    return NULL;
}

static void mix(mesh_target *out, const char *name, const portion *portions, int count)
{
    out->name = strdup(name);
    out->offset = calloc(3 * (size_t)head.vertex_count, sizeof *out->offset);
    assert_non_null(out->offset);
    for (int p = 0; p < count; p++) {
        const float *from = offset_named(portions[p].name);
        for (size_t i = 0; i < 3 * (size_t)head.vertex_count; i++)
            out->offset[i] += portions[p].amount * from[i];
    }
}

enum { CORE_COUNT = 6 };

/* A view of the head with other targets; only these are the caller's. */
static mesh core_set(mesh_target out[CORE_COUNT])
{
    mix(&out[0], "jawOpen", (portion[]){{"jawOpen", 1}}, 1);
    mix(&out[1], "mouthPucker", (portion[]){{"mouthPucker", 1}}, 1);
    mix(&out[2], "smile", (portion[]){{"mouthSmile_L", 1}, {"mouthSmile_R", 1}}, 2);
    mix(&out[3], "surprise",
        (portion[]){{"jawOpen", 0.7f},
                    {"browInnerUp_L", 1},
                    {"browInnerUp_R", 1},
                    {"browOuterUp_L", 1},
                    {"browOuterUp_R", 1}},
        5);
    mix(&out[4], "frown", (portion[]){{"mouthFrown_L", 1}, {"mouthFrown_R", 1}}, 2);
    mix(&out[5], "open smile",
        (portion[]){{"jawOpen", 0.5f}, {"mouthSmile_L", 1}, {"mouthSmile_R", 1}}, 3);
    mesh set = head;
    set.target = out;
    set.target_count = CORE_COUNT;
    return set;
}

static void free_targets(mesh_target *target, uint32_t count)
{
    for (uint32_t t = 0; t < count; t++) {
        free(target[t].name);
        free(target[t].offset);
    }
}

/* ---- fits ---- */

static double motion_of(const fit_result *result, part p)
{
    double most = 0;
    for (size_t v = p.first; v <= p.last; v++)
        for (size_t a = 3 * v; a < 3 * v + 3; a++)
            most = fmax(most, fabs((double)result->position[a] - (double)head.position[a]));
    return most;
}

/* What holds of every fit, whatever its residual. */
static void assert_face_is_sound(const fit_result *result)
{
    assert_true(result->rigid_motion_mm == 0);
    assert_true(motion_of(result, teeth_upper) == 0);
    assert_true(motion_of(result, eyeballs) == 0);
    assert_true(motion_of(result, cranium) == 0);
    assert_true(result->penetration_mm < 1e-3); /* of a projection in float */
    assert_true(result->min_determinant > 0);
}

/* Returns the mean relative residual; prints what came out. */
static double fit_all(const rig *r, const mesh *targets, const uint32_t *contact, uint32_t count,
                      double *out_worst_blink)
{
    error err = {""};
    fit_options options = {contact, count, {0}};
    fit_result *result = calloc(targets->target_count, sizeof *result);
    assert_non_null(result);
    require(fit_targets(result, r, &head, &surface, targets, &options, &err), &err);
    double mean = 0, paper = 0;
    *out_worst_blink = 0;
    for (uint32_t t = 0; t < targets->target_count; t++) {
        const fit_result *f = &result[t];
        print_message("  %-16s %.3f  worst %4.1f mm  det %.2f  paper %.3f, skull torn %.1f mm\n",
                      f->name, f->relative_residual, f->worst_mm, f->min_determinant,
                      f->paper_residual, f->paper_rigid_motion_mm);
        assert_face_is_sound(f);
        mean += f->relative_residual / targets->target_count;
        paper += f->paper_residual / targets->target_count;
        if (strncmp(f->name, "eyeBlink", 8) == 0)
            *out_worst_blink = fmax(*out_worst_blink, f->relative_residual);
    }
    print_message("  %u contacts: mean %.4f, paper %.4f\n", count, mean, paper);
    fit_results_destroy(result, targets->target_count);
    free(result);
    return mean;
}

static double fit_set(const char *set_name, const mesh *targets, double *out_worst_blink)
{
    const rig_contact_set *set = rig_find_contact_set(&ict, set_name);
    assert_non_null(set);
    return fit_all(&ict, targets, set->contact, set->contact_count, out_worst_blink);
}

static void ten_contacts_make_the_core_faces(void **state)
{
    (void)state;
    mesh_target target[CORE_COUNT];
    mesh core = core_set(target);
    double blink;
    assert_true(fit_set("fit10", &core, &blink) <= 0.28);
    free_targets(target, CORE_COUNT);
}

static void eighteen_contacts_make_them_better(void **state)
{
    (void)state;
    mesh_target target[CORE_COUNT];
    mesh core = core_set(target);
    double blink;
    assert_true(fit_set("fit18", &core, &blink) <= 0.22);
    free_targets(target, CORE_COUNT);
}

static void twenty_eight_and_lids_make_each_expression(void **state)
{
    (void)state;
    double blink;
    assert_true(fit_set("fit28", &head, &blink) <= 0.30);
    assert_true(blink > 0 && blink <= 0.35);
}

/* By nobody's hand. What `rig new` makes folds nowhere before the pulls are whole, and comes within
 * 1.3 times as close as the hand-made rig's 18 contacts do (0.2125). */
static void a_drafted_rig_makes_the_core_faces(void **state)
{
    (void)state;
    mesh_target target[CORE_COUNT];
    mesh core = core_set(target);
    rig drafted;
    char *confirm;
    error err = {""};
    require(rig_draft_make(&drafted, &confirm, &head, &surface, "ict_face.glb", NULL, 0, &err),
            &err);
    uint32_t contact[64];
    assert_true(drafted.contact_count <= 64);
    for (uint32_t k = 0; k < drafted.contact_count; k++)
        contact[k] = k;
    double blink;
    double mean = fit_all(&drafted, &core, contact, drafted.contact_count, &blink);
    assert_true(mean <= 1.3 * 0.2125);
    free(confirm);
    rig_destroy(&drafted);
    free_targets(target, CORE_COUNT);
}

/* A rig whose contacts are these vertices. */
static double fit_vertices(const uint32_t *vertex, uint32_t count, const mesh *targets)
{
    rig other = ict;
    uint32_t index[64];
    double blink;
    other.contact = calloc(count, sizeof *other.contact);
    assert_non_null(other.contact);
    other.contact_count = count;
    for (uint32_t k = 0; k < count; k++) {
        char name[16] = "suggested";
        other.contact[k] =
            (rig_contact){.name = name, .bone = RIG_NONE, .vertex = vertex[k], .mirror = RIG_NONE};
        index[k] = k;
    }
    double mean = fit_all(&other, targets, index, count, &blink);
    free(other.contact);
    return mean;
}

static void suggested_contacts_make_the_core_faces(void **state)
{
    (void)state;
    mesh_target target[CORE_COUNT];
    mesh core = core_set(target);
    uint32_t vertex[10], count;
    csrbf_settings settings = {0};
    error err = {""};
    require(fit_suggest(vertex, &count, 10, &ict, &head, &surface, &core, &settings, &err), &err);
    assert_int_equal(count, 10);
    assert_true(fit_vertices(vertex, count, &core) <= 0.28);
    free_targets(target, CORE_COUNT);
}

/* Chosen for mouths that pucker, frown, and brows that rise inside; tried on what was not seen. */
static void contacts_serve_faces_that_they_were_not_chosen_for(void **state)
{
    (void)state;
    if (!getenv("MAROTTE_TEST_LONG"))
        skip(); /* the slowest: 28 of them are suggested */
    static const char *const seen_names[] = {"mouthPucker",   "mouthFrown_L",  "mouthFrown_R",
                                             "browInnerUp_L", "browInnerUp_R", "eyeBlink_L",
                                             "eyeBlink_R"};
    static const char *const new_names[] = {"jawOpen",       "mouthSmile_L",  "mouthSmile_R",
                                            "browOuterUp_L", "browOuterUp_R", "mouthUpperUp_L",
                                            "mouthUpperUp_R"};
    mesh_target seen[7], fresh[7];
    for (int i = 0; i < 7; i++) {
        mix(&seen[i], seen_names[i], &(portion){seen_names[i], 1}, 1);
        mix(&fresh[i], new_names[i], &(portion){new_names[i], 1}, 1);
    }
    mesh chosen_for = head, tried_on = head;
    chosen_for.target = seen;
    tried_on.target = fresh;
    chosen_for.target_count = tried_on.target_count = 7;
    uint32_t vertex[28], count;
    csrbf_settings settings = {0};
    error err = {""};
    require(fit_suggest(vertex, &count, 28, &ict, &head, &surface, &chosen_for, &settings, &err),
            &err);
    assert_true(fit_vertices(vertex, count, &tried_on) <= 0.36);
    free_targets(seen, 7);
    free_targets(fresh, 7);
}

/* ---- lips and weights ---- */

/* Of the Multi-PIE landmarks: the middle of each lip, inside and outside. */
static const uint32_t upper_lip[] = {5711, 5533, 6216, 2081, 0, 4275};
static const uint32_t lower_lip[] = {5966, 5517, 6470, 5957, 5518, 6461};

/* How far the lip moves when the contact is pulled by 5 mm along y. */
static double lip_follows(const char *contact, double pull_mm, const uint32_t lip[6])
{
    face *f;
    error err = {""};
    require(face_create(&f, &ict, &head, &surface, 1, &err), &err);
    uint32_t index = rig_find_contact(&ict, contact), count;
    assert_int_not_equal(index, RIG_NONE);
    const mrt_contact *at = &face_contacts(f, &count)[index];
    vec3 start = {(double)at->rest.x, (double)at->rest.y, (double)at->rest.z};
    face_control control = {start, index + 1};
    double end[3] = {start.x, start.y + pull_mm, start.z};
    require(face_engage(f, &ict.solver, &control, 1, &err), &err);
    float still[MRT_MAX_DOFS] = {0};
    require(face_pull(f, end, still, &err), &err);
    float *shown = malloc(3 * (size_t)head.vertex_count * sizeof *shown);
    assert_non_null(shown);
    points_to_rows(shown, face_shown(f), face_order(f));
    double most = 0, own = 0;
    for (size_t i = 0; i < 6; i++)
        for (size_t a = 0; a < 3; a++)
            most = fmax(
                most, fabs((double)shown[3 * lip[i] + a] - (double)head.position[3 * lip[i] + a]));
    own = (double)shown[3 * ict.contact[index].vertex + 1] - start.y;
    assert_true(fabs(own - pull_mm) < 1e-3);
    free(shown);
    face_destroy(f);
    return most;
}

static void a_pulled_lip_leaves_the_other_where_it_is(void **state)
{
    (void)state;
    double lower = lip_follows("lip.upper.edge", 5, lower_lip);
    double upper = lip_follows("lip.lower.edge", -5, upper_lip);
    print_message("  upper lip pulled 5 mm: lower %.4f mm; lower pulled: upper %.4f mm\n", lower,
                  upper);
    assert_true(lower < 0.1 && upper < 0.1);
}

static void weights_sum_to_one_and_mirror(void **state)
{
    (void)state;
    binding b;
    error err = {""};
    require(binding_create(&b, &ict, &head, &surface, &err), &err);
    for (size_t v = 0; v < b.vertex_count; v++) {
        double sum = 0;
        for (size_t bone = 0; bone < b.bone_count; bone++)
            sum += (double)b.weight[bone * b.vertex_count + v];
        assert_true(fabs(sum - 1) <= 1e-6);
    }
    /* The face is split into triangles alike on both sides, not mirrored: so only nearly. */
    static const uint32_t pairs[][2] = {{1225, 3443}, {1719, 3924}, {1722, 3927}, {2199, 4390},
                                        {1447, 3661}, {5708, 6213}, {5841, 6346}, {5695, 6200}};
    size_t jaw = rig_find_bone(&ict, "jaw") * (size_t)b.vertex_count;
    for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++) {
        double off = (double)b.weight[jaw + pairs[i][0]] - (double)b.weight[jaw + pairs[i][1]];
        assert_true(fabs(off) <= 0.01);
    }
    binding_destroy(&b);
}

/* Else nothing that gives way to them could keep a frame from folding. */
static void bones_go_to_their_limits_without_a_fold(void **state)
{
    (void)state;
    face *f;
    error err = {""};
    require(face_create(&f, &ict, &head, &surface, 1, &err), &err);
    for (uint32_t d = 0; d < face_bones(f)->dof_count; d++)
        for (int end = 0; end < 2; end++) {
            float dof[MRT_MAX_DOFS] = {0};
            dof[d] = end == 0 ? face_bones(f)->dof[d].min : face_bones(f)->dof[d].max;
            require(face_pull(f, NULL, dof, &err), &err);
            if (!(face_min_determinant(f) > 0.05))
                fail_msg("%s at %g folds", face_bones(f)->dof[d].name, (double)dof[d]);
        }
    face_destroy(f);
}

/* ---- the face ---- */

static bool find_face(char *out, size_t size)
{
    const char *shared = getenv("MAROTTE_SHARED");
    (void)snprintf(out, size, "%s/data/faces/ict_face.glb",
                   shared != NULL ? shared : SOURCE_DIR "/../shared");
    return access(out, R_OK) == 0;
}

static int read_face(void **state)
{
    (void)state;
    char path[4096];
    error err = {""};
    (void)find_face(path, sizeof path);
    if (rig_read_trusted(&ict, SOURCE_DIR "/tests/face/ict.rig.json", &err) < 0 ||
        mesh_file_read(&head, path, NULL, &err) < 0 ||
        openmesh_topology(&surface, &head, &err) < 0) {
        print_error("%s\n", err.text);
        return -1;
    }
    return 0;
}

static int drop_face(void **state)
{
    (void)state;
    topology_destroy(&surface);
    mesh_destroy(&head);
    rig_destroy(&ict);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ten_contacts_make_the_core_faces),
        cmocka_unit_test(eighteen_contacts_make_them_better),
        cmocka_unit_test(twenty_eight_and_lids_make_each_expression),
        cmocka_unit_test(a_drafted_rig_makes_the_core_faces),
        cmocka_unit_test(suggested_contacts_make_the_core_faces),
        cmocka_unit_test(contacts_serve_faces_that_they_were_not_chosen_for),
        cmocka_unit_test(a_pulled_lip_leaves_the_other_where_it_is),
        cmocka_unit_test(weights_sum_to_one_and_mirror),
        cmocka_unit_test(bones_go_to_their_limits_without_a_fold),
    };
    char path[4096];
    if (!find_face(path, sizeof path)) {
        printf("SKIPPED: %s is not there; set MAROTTE_SHARED to the folder with data/\n", path);
        return 77;
    }
    return cmocka_run_group_tests(tests, read_face, drop_face);
}
