/* Mouths of drafted heads: rims are found where there is a slit, and the seal closes it; where
 * there is none the draft says so. And mouths in rig files that are none. Heads of ../shared/data.
 * mm. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "closed_moai.h"
#include "face/face.h"
#include "face/rig_check.h"
#include "face/rig_draft.h"
#include "io/openmesh.h"
#include "mesh/position.h"
#include "slit.h"
#include "stage/perform/face_file.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double radian_per_degree = 0.017453292519943295;

typedef struct actor {
    face_file file;
    rig rig;
    char *confirm;
    face *face;
} actor;

static void must(mrt_result result, const char *of, const error *err)
{
    if (result < 0)
        fail_msg("%s: %s", of, err->text);
}

static void close_actor(actor *a)
{
    face_destroy(a->face);
    rig_destroy(&a->rig);
    free(a->confirm);
    face_file_destroy(&a->file);
}

static vec3 shown(const actor *a, uint32_t vertex)
{
    return slit_shown(a->face, vertex);
}

static uint32_t dof_named(const actor *a, const char *name)
{
    const uint32_t dof = slit_dof(a->face, name);
    assert_true(dof != RIG_NONE);
    return dof;
}

static void perform(actor *a, double jaw_deg, double seal)
{
    float dof[MRT_MAX_DOFS] = {0};
    error err = {""};
    dof[dof_named(a, "jaw.open")] = (float)(jaw_deg * radian_per_degree);
    dof[dof_named(a, "lips.seal")] = (float)seal;
    must(face_pull(a->face, NULL, dof, &err), "face_pull", &err);
}

/* ---- how far the lips are apart ---- */

static vec3 shown_place(const void *of, uint32_t vertex)
{
    return shown(of, vertex);
}

typedef struct gaps { /* the greatest of all columns */
    double rims;      /* from the lower rim up to the upper one */
    double seen;      /* from the front, between the lips */
} gaps;

/* Where the foremost triangle at x, y is. */
static double front_at(const actor *a, const uint32_t *near, uint32_t near_count, double x,
                       double y)
{
    double front = -(double)INFINITY;
    for (uint32_t i = 0; i < near_count; ++i) {
        const uint32_t *corner = a->file.mesh.triangle + (size_t)near[i] * 3;
        vec3 p = shown(a, corner[0]), u = vec3_sub(shown(a, corner[1]), p),
             v = vec3_sub(shown(a, corner[2]), p);
        double area = u.x * v.y - u.y * v.x;
        double s = ((x - p.x) * v.y - (y - p.y) * v.x) / area;
        double t = (u.x * (y - p.y) - u.y * (x - p.x)) / area;
        if (fabs(area) > 1e-9 && s >= 0.0 && t >= 0.0 && s + t <= 1.0)
            front = fmax(front, p.z + s * u.z + t * v.z);
    }
    return front;
}

/* Of the column at x, the height of what is more than 2 mm behind the rims, within 4 mm of them. */
static double seen_gap(const actor *a, vec3 upper, vec3 lower)
{
    enum { NEAR = 4096 };
    static uint32_t near[NEAR];
    const double step = 0.1, behind = fmin(upper.z, lower.z) - 2.0, x = upper.x;
    double open = 0.0, low = fmin(upper.y, lower.y) - 4.0, high = fmax(upper.y, lower.y) + 4.0;
    uint32_t count = 0;
    for (uint32_t i = 0; i < a->file.mesh.triangle_count && count < NEAR; ++i) {
        const uint32_t *corner = a->file.mesh.triangle + (size_t)i * 3;
        vec3 p = shown(a, corner[0]), q = shown(a, corner[1]), r = shown(a, corner[2]);
        if (fmin(p.x, fmin(q.x, r.x)) <= x && fmax(p.x, fmax(q.x, r.x)) >= x &&
            fmin(p.y, fmin(q.y, r.y)) <= high && fmax(p.y, fmax(q.y, r.y)) >= low &&
            fmax(p.z, fmax(q.z, r.z)) >= behind)
            near[count++] = i;
    }
    for (double y = low; y <= high; y += step)
        if (front_at(a, near, count, x, y) < behind)
            open += step;
    return open;
}

static gaps measure(const actor *a)
{
    gaps out = {0.0, 0.0};
    for (int k = 1; k <= SLIT_COLUMNS; ++k) {
        vec3 upper, lower;
        if (!slit_column(&upper, &lower, &a->rig.mouth, k, shown_place, a))
            fail_msg("a rim does not reach column %d", k);
        out.rims = fmax(out.rims, upper.y - lower.y);
        out.seen = fmax(out.seen, seen_gap(a, upper, lower));
    }
    return out;
}

/* ---- heads ---- */

static void draft(actor *out, const char *path)
{
    error err = {""};
    *out = (actor){.face = NULL};
    must(face_file_read(&out->file, path, NULL, FACE_FILE_ANY, &err), path, &err);
    must(rig_draft_make(&out->rig, &out->confirm, &out->file.mesh, &out->file.topology, path, NULL,
                        0, &err),
         path, &err);
}

static void make_face(actor *a, const char *path)
{
    error err = {""};
    must(face_create(&a->face, &a->rig, &a->file.mesh, &a->file.topology, 0, &err), path, &err);
}

/* False: there is no such head. */
static bool find_head(char out[1024], const char *name)
{
    const char *shared = getenv("MAROTTE_SHARED");
    (void)snprintf(out, 1024, "%s/data/%s", shared ? shared : SOURCE_DIR "/../shared", name);
    FILE *file = fopen(out, "rb");
    if (file)
        fclose(file);
    else
        print_message("SKIPPED: no %s\n", out);
    return file != NULL;
}

static void assert_seals(actor *a, const char *name)
{
    static const double jaw_deg[] = {0.0, 6.0};
    make_face(a, name);
    assert_true(face_binding(a->face)->lips.station_count > 0);
    perform(a, 0.0, 0.0);
    gaps now = measure(a);
    print_message("%-24s %3u and %3u vertices, %5.1f mm wide, open at rest %5.2f (seen %5.2f)",
                  name, a->rig.mouth.upper_count, a->rig.mouth.lower_count,
                  face_binding(a->face)->lips.width_mm, now.rims, now.seen);
    for (int i = 0; i < 2; ++i) {
        perform(a, jaw_deg[i], 1.0);
        now = measure(a);
        print_message(", sealed over %.0f deg %.2f (%.2f)", jaw_deg[i], now.rims, now.seen);
        assert_true(now.rims < 0.5 && now.seen < 0.5);
        assert_true(face_min_determinant(a->face) > 0.0);
    }
    print_message("\n");
}

/* Drafts each head that is there; skips the test where none is. */
static void check_heads(const char *const *heads, size_t count,
                        void (*check)(actor *, const char *))
{
    size_t skipped = 0;
    for (size_t i = 0; i < count; ++i) {
        char path[1024];
        actor a;
        if (!find_head(path, heads[i])) {
            skipped += 1;
            continue;
        }
        draft(&a, path);
        check(&a, heads[i]);
        close_actor(&a);
    }
    if (skipped == count)
        skip();
}

static void check_seals(actor *a, const char *name)
{
    assert_non_null(strstr(a->confirm, "mouth: lips.seal brings its rims together"));
    assert_seals(a, name);
}

static void a_slit_is_found_and_closes(void **state)
{
    (void)state;
    static const char *const heads[] = {"heads/bust.gltf",          "heads/girl.glb",
                                        "heads/rpm_arkit.glb",      "heads/homer.obj",
                                        "heads/leeperry_draco.glb", "heads2/brunette_t.glb",
                                        "heads2/makehuman.obj",     "faces/ict_face.glb"};
    check_heads(heads, sizeof heads / sizeof *heads, check_seals);
}

static void check_has_no_rims(actor *a, const char *name)
{
    if (a->rig.mouth.upper || !strstr(a->confirm, "mouth: the lips cannot be sealed, since the "
                                                  "surface is closed"))
        fail_msg("%s: %s", name, a->confirm);
}

/* A groove, a line of paint and a closed surface are no slits. */
static void lips_without_a_slit_get_no_rims(void **state)
{
    (void)state;
    static const char *const heads[] = {
        "heads/reyn_head.glb",      "heads/suzanne.glb",      "heads2/ar_elephant.glb",
        "heads2/ar_fox.glb",        "heads2/ar_lion.glb",     "heads2/bust_lucie.glb",
        "heads2/char11.obj",        "heads2/chr_knight.glb",  "heads2/daft_guyman.glb",
        "heads2/dekier_rabbit.glb", "heads2/filbot.glb",      "heads2/fox.glb",
        "heads2/goathead.obj",      "heads2/kaykit_Mage.glb", "heads2/minifig.glb",
        "heads2/oded_cat.obj",      "heads2/pirate.glb",      "heads2/planck.obj",
        "heads2/pviz_head.stl",     "heads2/rabbit.obj",      "heads2/rocki_head.glb",
        "heads2/stuffedtoy.obj"};
    check_heads(heads, sizeof heads / sizeof *heads, check_has_no_rims);
}

static void a_drafted_puppet_has_the_rims_that_its_rig_declares(void **state)
{
    (void)state;
    error err = {""};
    actor a;
    rig declared;
    draft(&a, SOURCE_DIR "/rigs/puppet/puppet.glb");
    must(rig_read(&declared, SOURCE_DIR "/rigs/puppet/puppet.rig.json", &err), "puppet", &err);
    const rig_mouth *found = &a.rig.mouth, *known = &declared.mouth;
    assert_int_equal(found->upper_count, known->upper_count);
    assert_int_equal(found->lower_count, known->lower_count);
    for (uint32_t i = 0; i < known->upper_count; ++i)
        assert_int_equal(mesh_point(&a.file.mesh, found->upper[i]),
                         mesh_point(&a.file.mesh, known->upper[i]));
    for (uint32_t i = 0; i < known->lower_count; ++i)
        assert_int_equal(mesh_point(&a.file.mesh, found->lower[i]),
                         mesh_point(&a.file.mesh, known->lower[i]));
    assert_seals(&a, "puppet.glb");
    rig_destroy(&declared);
    close_actor(&a);
}

/* Each point of the slit is there twice, at one place. */
static void lips_that_touch_have_two_rims(void **state)
{
    (void)state;
    actor a;
    draft(&a, SOURCE_DIR "/rigs/moai/moai.glb");
    assert_int_equal(a.rig.mouth.upper_count, a.rig.mouth.lower_count);
    assert_seals(&a, "moai.glb");
    close_actor(&a);
}

static void cut(actor *out, const char *path)
{
    uint32_t *chain, count;
    error err = {""};
    *out = (actor){.face = NULL};
    must(face_file_read(&out->file, path, NULL, FACE_FILE_ANY, &err), path, &err);
    must(rig_draft_mouth(&chain, &count, NULL, &out->file.mesh, &out->file.topology, &err), path,
         &err);
    assert_non_null(chain);
    must(face_file_cut_mouth(&out->file, chain, count, &err), path, &err);
    must(rig_draft_make(&out->rig, &out->confirm, &out->file.mesh, &out->file.topology, path, chain,
                        count, &err),
         path, &err);
    const rig_mouth *m = &out->rig.mouth;
    assert_int_equal(m->upper_count, count);
    assert_int_equal(m->lower_count, count);
    for (uint32_t i = 0; i < count; ++i) {
        vec3 p = mesh_position(&out->file.mesh, m->upper[i]);
        vec3 q = mesh_position(&out->file.mesh, m->lower[i]);
        assert_memory_equal(&p, &q, sizeof p);
        assert_true((m->upper[i] == m->lower[i]) == (i == 0 || i == count - 1));
    }
    free(chain);
}

static void a_mouth_that_is_cut_has_the_sides_of_the_cut_as_rims(void **state)
{
    (void)state;
    const char *path = BUILD_DIR "/head_lips_closed_moai.obj";
    char head[1024];
    actor a;
    write_closed_moai(path);
    cut(&a, path);
    close_actor(&a);
    if (!find_head(head, "heads/reyn_head.glb"))
        return;
    cut(&a, head);
    assert_seals(&a, "reyn_head.glb, cut");
    close_actor(&a);
}

/* The lips end in an open border. The check of the rig names it. */
static void a_mouth_without_a_bag_is_sealed_all_the_same(void **state)
{
    (void)state;
    error err = {""};
    actor a = {.face = NULL};
    rig_findings findings = {0};
    bool is_noted = false;
    mesh *m = &a.file.mesh;
    must(mesh_file_read(m, SOURCE_DIR "/rigs/moai/moai.glb", NULL, &err), "moai", &err);
    const uint32_t bag = m->part_count - 1;
    assert_string_equal(m->part[bag].name, "mouth");
    m->triangle_count = m->part[bag].first_triangle;
    free(m->part[bag].name);
    m->part_count = bag;
    must(openmesh_topology(&a.file.topology, m, &err), "moai", &err);
    must(rig_draft_make(&a.rig, &a.confirm, m, &a.file.topology, "moai.glb", NULL, 0, &err), "moai",
         &err);
    assert_seals(&a, "moai.glb without a bag");
    must(rig_check(&findings, &a.rig, m, &a.file.topology, face_binding(a.face), &err), "moai",
         &err);
    for (uint32_t i = 0; i < findings.count; ++i)
        is_noted = is_noted || strstr(findings.item[i].text, "an open border of");
    assert_true(is_noted);
    rig_findings_finish(&findings);
    close_actor(&a);
}

/* ---- mouths in rig files ---- */

/* A copy of the puppet's rig with that mouth performs, its lips open, and its file says why. */
static void assert_unsealed(const char *mouth, const char *why)
{
    const char *path = BUILD_DIR "/head_lips.rig.json";
    error err = {""};
    actor a = {.face = NULL};
    json_t *root = json_load_file(SOURCE_DIR "/rigs/puppet/puppet.rig.json", 0, NULL);
    json_t *value = json_loads(mouth, JSON_DECODE_ANY, NULL);
    assert_non_null(root);
    assert_non_null(value);
    json_object_set_new(root, "mouth", value);
    json_object_set_new(root, "mesh", json_string(SOURCE_DIR "/rigs/puppet/puppet.glb"));
    assert_int_equal(setenv("MAROTTE_FILE_FOLDERS", SOURCE_DIR "/rigs/puppet", 1), 0);
    assert_int_equal(json_dump_file(root, path, 0), 0);
    json_decref(root);
    must(face_file_read(&a.file, path, NULL, FACE_FILE_USABLE, &err), mouth, &err);
    if (!a.file.note || !strstr(a.file.note, why) ||
        !strstr(a.file.note, "the face performs, but its lips are not sealed"))
        fail_msg("%s: %s", mouth, a.file.note);
    must(rig_copy(&a.rig, a.file.rig, &err), mouth, &err);
    make_face(&a, mouth);
    assert_int_equal(face_binding(a.face)->lips.station_count, 0);
    perform(&a, 6.0, 1.0);
    assert_true(face_min_determinant(a.face) > 0.0);
    close_actor(&a);
}

/* The puppet's rims, changed: of the upper rim and the lower one `from`, so many vertices. */
static void assert_spoiled(uint32_t upper_from, uint32_t upper_count, bool is_turned,
                           uint32_t lower_from, uint32_t lower_count, const char *why)
{
    error err = {""};
    rig r;
    must(rig_read(&r, SOURCE_DIR "/rigs/puppet/puppet.rig.json", &err), "puppet", &err);
    const rig_mouth *m = &r.mouth;
    json_t *mouth = json_object(), *upper = json_array(), *lower = json_array();
    for (uint32_t i = 0; i < upper_count; ++i) {
        const uint32_t at = is_turned ? upper_count - 1 - i : i;
        json_array_append_new(upper, json_integer((json_int_t)m->upper[upper_from + at]));
    }
    for (uint32_t i = 0; i < lower_count; ++i)
        json_array_append_new(lower, json_integer((json_int_t)m->lower[lower_from + i]));
    json_object_set_new(mouth, "upper", upper);
    json_object_set_new(mouth, "lower", lower);
    char *text = json_dumps(mouth, 0);
    assert_non_null(text);
    assert_unsealed(text, why);
    free(text);
    json_decref(mouth);
    rig_destroy(&r);
}

static void mouths_of_a_wrong_type_are_named(void **state)
{
    (void)state;
    static const char *const cases[][2] = {
        {"7", "an object with \"upper\" and \"lower\""},
        {"null", "an object with \"upper\" and \"lower\""},
        {"\"wide\"", "an object with \"upper\" and \"lower\""},
        {"[]", "an object with \"upper\" and \"lower\""},
        {"{}", "$.mouth.upper"},
        {"{\"upper\": 3, \"lower\": [1, 2, 3]}", "a list of 3 vertices or more"},
        {"{\"upper\": [], \"lower\": []}", "a list of 3 vertices or more"},
        {"{\"upper\": [4], \"lower\": [5]}", "a list of 3 vertices or more"},
        {"{\"upper\": [1, 2, 3]}", "$.mouth.lower"},
        {"{\"upper\": [1, 2, \"3\"], \"lower\": [1, 5, 3]}", "$.mouth.upper[2]"},
        {"{\"upper\": [1, 2, -3], \"lower\": [1, 5, 3]}", "$.mouth.upper[2]"},
        {"{\"upper\": [1, 2.5, 3], \"lower\": [1, 5, 3]}", "$.mouth.upper[1]"},
        {"{\"upper\": [1, 2, 99999999999999], \"lower\": [1, 5, 3]}", "$.mouth.upper[2]"},
        {"{\"upper\": [1, 2, 4000000000], \"lower\": [1, 5, 3]}",
         "a vertex number of the mesh file"},
        {"{\"upper\": [1, 2, 400000], \"lower\": [1, 5, 3]}", "does not exist, the mesh has"},
        {"{\"upper\": [1, 2, 3], \"lower\": [1, 5, 3], \"upper_share\": 2}", "upper_share"},
        {"{\"upper\": [1, 2, 3], \"lower\": [1, 5, 3], \"stickiness_mm\": -1}", "stickiness_mm"},
        {"{\"upper\": [1, 2, 3], \"lower\": [1, 5, 3], \"seal_from\": \"left\"}",
         "\"corners\" or \"middle\""}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i)
        assert_unsealed(cases[i][0], cases[i][1]);
}

static void rims_that_are_none_are_named(void **state)
{
    (void)state;
    assert_spoiled(0, 37, true, 0, 37, "are the same point"); /* crossed */
    assert_spoiled(0, 37, false, 0, 18, "mm apart");          /* of different length */
    assert_spoiled(0, 12, false, 24, 13, "mm apart");         /* of two slits */
    /* doubled */
    assert_unsealed("{\"upper\": [14909, 14909, 4693], \"lower\": [14909, 14908, 4693]}",
                    "are the same point");
    assert_unsealed("{\"upper\": [14909, 20000, 4693], \"lower\": [14909, 14908, 4693]}",
                    "on another piece of surface");
}

static void a_mouth_that_cannot_be_read_is_written_as_it_is(void **state)
{
    (void)state;
    static const char text[] = "{\"marotte_rig\": 1, \"mesh\": \"a.glb\", \"bones\": [{\"name\": "
                               "\"skull\"}], \"mouth\": {\"upper\": [7], \"lower\": 4}}";
    const char *path = BUILD_DIR "/head_lips_kept.rig.json";
    error err = {""};
    rig r;
    must(rig_parse(&r, text, strlen(text), "kept.rig.json", &err), "kept", &err);
    assert_non_null(strstr(r.mouth.fault, "a list of 3 vertices or more"));
    must(rig_write(&r, path, &err), "kept", &err);
    rig_destroy(&r);
    json_t *root = json_load_file(path, 0, NULL);
    const json_t *mouth = json_object_get(root, "mouth");
    assert_int_equal(json_integer_value(json_array_get(json_object_get(mouth, "upper"), 0)), 7);
    assert_int_equal(json_integer_value(json_object_get(mouth, "lower")), 4);
    json_decref(root);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_slit_is_found_and_closes),
        cmocka_unit_test(lips_without_a_slit_get_no_rims),
        cmocka_unit_test(a_drafted_puppet_has_the_rims_that_its_rig_declares),
        cmocka_unit_test(lips_that_touch_have_two_rims),
        cmocka_unit_test(a_mouth_that_is_cut_has_the_sides_of_the_cut_as_rims),
        cmocka_unit_test(a_mouth_without_a_bag_is_sealed_all_the_same),
        cmocka_unit_test(mouths_of_a_wrong_type_are_named),
        cmocka_unit_test(rims_that_are_none_are_named),
        cmocka_unit_test(a_mouth_that_cannot_be_read_is_written_as_it_is),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
