/* The rigs that are here, performed: lips that part, teeth and eyes that stay, jaws that open, no
 * jump. The ICT face is looked for beside the repository. mm. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "base/file.h"
#include "face/face.h"
#include "stage/perform/face_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct actor {
    face_file file;
    face *face;
    csrbf_settings settings;
} actor;

static void must(mrt_result result, const error *err)
{
    if (result < 0)
        fail_msg("%s", err->text);
}

static void open_actor(actor *out, const char *path)
{
    error err = {""};
    *out = (actor){0};
    must(face_file_read(&out->file, path, NULL, FACE_FILE_USABLE, &err), &err);
    must(face_create(&out->face, out->file.rig, &out->file.mesh, &out->file.topology,
                     MRT_MAX_VECTORS, &err),
         &err);
    out->settings = out->file.rig->solver;
    if (!(out->settings.radius > 0.0))
        out->settings.radius = 60.0;
}

static void close_actor(actor *a)
{
    face_destroy(a->face);
    face_file_destroy(&a->file);
}

static void open_puppet(actor *out)
{
    open_actor(out, SOURCE_DIR "/rigs/puppet/puppet.rig.json");
}

/* False: it is not here. */
static bool open_ict(actor *out)
{
    FILE *file = fopen(SOURCE_DIR "/../shared/data/faces/ict_face.glb", "rb");
    if (!file) {
        print_message("SKIPPED: ../shared/data/faces/ict_face.glb is not here\n");
        return false;
    }
    (void)fclose(file);
    (void)setenv("MAROTTE_FILE_FOLDERS", SOURCE_DIR "/../shared", 1);
    open_actor(out, SOURCE_DIR "/tests/face/ict.rig.json");
    return true;
}

static double moved(const actor *a, uint32_t vertex)
{
    const points *p = face_shown(a->face), *q = face_rest(a->face);
    uint32_t slot = face_order(a->face)->slot_of_file[vertex];
    double d[3] = {(double)p->x[slot] - (double)q->x[slot], (double)p->y[slot] - (double)q->y[slot],
                   (double)p->z[slot] - (double)q->z[slot]};
    return sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
}

/* Greatest motion of what is rigid on a bone. */
static double rigid_motion(const actor *a, uint32_t bone)
{
    const binding *b = face_binding(a->face);
    double most = 0.0;
    for (uint32_t v = 0; v < b->vertex_count; ++v)
        if (b->weight[(size_t)bone * b->vertex_count + v] >= 1.0f && b->mobility[v] <= 0.0f)
            most = fmax(most, moved(a, v));
    return most;
}

/* 5 mm up or down at one vertex, nothing else held, the jaw not driven. */
static void pull_one(const actor *a, uint32_t vertex, uint32_t contact, double up)
{
    error err = {""};
    const float *at = a->file.mesh.position + (size_t)3 * vertex;
    face_control control = {{(double)at[0], (double)at[1], (double)at[2]}, contact};
    const double end[3] = {control.start.x, control.start.y + up, control.start.z};
    face_reset(a->face);
    must(face_engage(a->face, &a->settings, &control, 1, &err), &err);
    must(face_pull(a->face, end, NULL, &err), &err);
    assert_true(fabs(moved(a, vertex) - fabs(up)) < 1e-3);
}

static void closed_lips_do_not_drag_each_other(void **state)
{
    (void)state;
    actor a;
    open_puppet(&a);
    uint32_t upper = rig_find_contact(a.file.rig, "lip.upper.mid");
    uint32_t lower = rig_find_contact(a.file.rig, "lip.lower.mid");
    assert_true(upper != RIG_NONE && lower != RIG_NONE);
    uint32_t upper_vertex = a.file.rig->contact[upper].vertex;
    uint32_t lower_vertex = a.file.rig->contact[lower].vertex;
    pull_one(&a, upper_vertex, 1 + upper, 5.0);
    print_message("puppet: upper lip up, the lower one moves %.3g mm\n", moved(&a, lower_vertex));
    assert_true(moved(&a, lower_vertex) < 0.1);
    pull_one(&a, lower_vertex, 1 + lower, -5.0);
    print_message("puppet: lower lip down, the upper one moves %.3g mm\n", moved(&a, upper_vertex));
    assert_true(moved(&a, upper_vertex) < 0.1);
    const uint32_t jaw = face_bones(a.face)->jaw;
    for (uint32_t bone = 0; bone < a.file.rig->bone_count; ++bone)
        if (bone != jaw && a.file.rig->bone[bone].parent != jaw)
            assert_true(rigid_motion(&a, bone) == 0.0);
    close_actor(&a);
}

/* Landmarks 61 to 63 are the upper lip's inner edge, 65 to 67 the lower one's. */
static void lips_of_the_ict_face_do_not_drag_each_other(void **state)
{
    (void)state;
    static const uint32_t upper[] = {5711, 5533, 6216}, lower[] = {6470, 5517, 5966};
    actor a;
    if (!open_ict(&a))
        skip();
    double most[2] = {0.0, 0.0};
    for (int i = 0; i < 3; ++i) {
        pull_one(&a, upper[i], 0, 5.0);
        for (int k = 0; k < 3; ++k)
            most[0] = fmax(most[0], moved(&a, lower[k]));
        for (uint32_t bone = 0; bone < a.file.rig->bone_count; ++bone)
            assert_true(rigid_motion(&a, bone) == 0.0);
        pull_one(&a, lower[i], 0, -5.0);
        for (int k = 0; k < 3; ++k)
            most[1] = fmax(most[1], moved(&a, upper[k]));
        assert_true(rigid_motion(&a, 0) == 0.0);
    }
    print_message("ICT face: the lower lip moves %.3g mm, the upper one %.3g mm\n", most[0],
                  most[1]);
    assert_true(most[0] < 0.1 && most[1] < 0.1);
    close_actor(&a);
}

static vec3 shown(const actor *a, uint32_t vertex)
{
    double at[3];
    points_at(at, face_shown(a->face), face_order(a->face)->slot_of_file[vertex]);
    return (vec3){at[0], at[1], at[2]};
}

/* All contacts, where they are shown. */
static uint32_t hold_all(const actor *a, double *end)
{
    face_control control[MRT_MAX_VECTORS];
    error err = {""};
    uint32_t count = a->file.rig->contact_count;
    assert_true(count >= 24 && count <= MRT_MAX_VECTORS);
    for (uint32_t k = 0; k < count; ++k) {
        vec3 at = shown(a, a->file.rig->contact[k].vertex);
        control[k] = (face_control){at, 1 + k};
        end[3 * k] = at.x;
        end[3 * k + 1] = at.y;
        end[3 * k + 2] = at.z;
    }
    must(face_engage(a->face, &a->settings, control, count, &err), &err);
    return count;
}

static double furthest_from_end(const actor *a, const double *end, uint32_t count)
{
    double most = 0.0;
    for (uint32_t k = 0; k < count; ++k) {
        vec3 to = {end[3 * k], end[3 * k + 1], end[3 * k + 2]};
        vec3 at = shown(a, a->file.rig->contact[k].vertex);
        most = fmax(most, vec3_length(vec3_sub(at, to)));
    }
    return most;
}

static double difference(const points *p, const points *q)
{
    double most = 0.0;
    for (uint32_t v = 0; v < p->count; ++v) {
        most = fmax(most, fabs((double)p->x[v] - (double)q->x[v]));
        most = fmax(most, fabs((double)p->y[v] - (double)q->y[v]));
        most = fmax(most, fabs((double)p->z[v] - (double)q->z[v]));
    }
    return most;
}

/* From each pose the contacts go 2 mm forward, where nothing is in the way, and are held anew. */
static void every_contact_lands_in_any_pose_and_nothing_jumps(void **state)
{
    (void)state;
    actor a;
    error err = {""};
    points kept;
    double end[MRT_MAX_VECTORS * 3];
    open_puppet(&a);
    const bones *b = face_bones(a.face);
    must(points_create(&kept, face_order(a.face), a.file.mesh.position, &err), &err);
    for (int round = 0; round < 5; ++round) {
        float dof[MRT_MAX_DOFS] = {0};
        face_reset(a.face);
        for (uint32_t i = 0; i < b->dof_count; ++i)
            dof[i] =
                i == b->seal ? 0.0f : b->dof[i].max * 0.2f * (float)round; /* it moves lips on */
        must(face_pull(a.face, NULL, dof, &err), &err);
        uint32_t count = hold_all(&a, end);
        for (uint32_t k = 0; k < count; ++k)
            end[3 * k + 2] += 2.0;
        must(face_pull(a.face, end, dof, &err), &err);
        double miss = furthest_from_end(&a, end, count);
        bool is_free = face_columns_now(a.face).is_exact;
        points_copy(&kept, face_shown(a.face));
        count = hold_all(&a, end);
        must(face_pull(a.face, end, dof, &err), &err);
        double jump = difference(&kept, face_shown(a.face));
        face_commit(a.face);
        must(face_pull(a.face, NULL, dof, &err), &err);
        jump = fmax(jump, difference(&kept, face_shown(a.face)));
        print_message("pose %d: furthest from its end %.2g mm%s, jump %.2g mm\n", round, miss,
                      is_free ? "" : " (the skull was in the way)", jump);
        assert_true(miss < 1e-3 || !is_free);
        assert_true(round > 0 || miss < 1e-3); /* the teeth may hold the inside of the mouth */
        assert_true(jump < 1e-4);
    }
    points_destroy(&kept);
    close_actor(&a);
}

static void hold_named(const actor *a, face_control *out, const char *const *names, uint32_t count)
{
    uint32_t contacts;
    error err = {""};
    const mrt_contact *contact = face_contacts(a->face, &contacts);
    for (uint32_t k = 0; k < count; ++k)
        for (uint32_t i = 0; i < contacts; ++i)
            if (strcmp(contact[i].name, names[k]) == 0)
                out[k] = (face_control){{(double)contact[i].rest.x, (double)contact[i].rest.y,
                                         (double)contact[i].rest.z},
                                        i + 1};
    must(face_engage(a->face, &a->settings, out, count, &err), &err);
}

/* The jaw is aside, and the edges at that corner of the mouth are nearly bent as far as they may
 * be: what pulls there gives way, what pulls the brows does not. */
static void no_pull_bends_what_bones_have_bent(void **state)
{
    (void)state;
    static const char *const names[] = {"mouth.corner.l", "mouth.corner.r", "lip.lower.side.r",
                                        "nasolabial.r", "brow.mid.l"};
    enum { HELD = sizeof names / sizeof *names, BROW = HELD - 1 };
    actor a;
    face_control control[HELD];
    double end[HELD][3], least_brow = 6.0;
    float dof[MRT_MAX_DOFS] = {0.0f};
    uint32_t seed = 3, held = 0;
    error err = {""};
    open_puppet(&a);
    const bones *b = face_bones(a.face);
    dof[b->first_dof[b->jaw] + 1] = 10.0f;
    hold_named(&a, control, names, HELD);
    for (int i = 0; i < 100; ++i) {
        const uint8_t rides[HELD] = {1, 1, 1, 1, 1};
        for (uint32_t k = 0; k < HELD; ++k)
            for (int axis = 0; axis < 3; ++axis) {
                seed = seed * 1664525u + 1013904223u;
                end[k][axis] = (double)(seed >> 8) / 16777216.0 * 30.0 - 15.0;
            }
        memcpy(end[BROW], (const double[3]){0.0, 6.0, 0.0}, sizeof end[BROW]);
        face_ride(a.face, end[0], rides, dof);
        must(face_pull(a.face, end[0], dof, &err), &err);
        face_surface now = face_measure_surface(a.face);
        assert_true(now.min_determinant > 0.0);
        assert_int_equal(now.skin.bent_count, 0);
        held += now.held_back_mm > 1.0;
        vec3 at = face_contact_now(a.face, control[BROW].contact);
        least_brow = fmin(least_brow, at.y - control[BROW].start.y);
    }
    print_message("held back in %u of 100, the brow by %.2f of 6 mm at most\n", held,
                  6.0 - least_brow);
    assert_true(held > 10 && least_brow > 3.0);
    close_actor(&a);
}

/* The jaw opens and goes aside by a 500th a step under pulls that stay. On the way it tilts a
 * triangle at the corner of the mouth until that is seen from its edge: the pulls go on. */
static void bones_that_tilt_skin_make_no_pull_jump(void **state)
{
    (void)state;
    enum { STEPS = 500 };
    static const char *const names[] = {"mouth.corner.l", "mouth.corner.r", "nasolabial.l",
                                        "nasolabial.r",   "brow.inner.l",   "brow.inner.r"};
    static const double pull[][3] = {{-3.9, 6.3, 0.7}, {3.9, 6.3, 0.7}, {0.4, 4.2, 1.7},
                                     {-0.4, 4.2, 1.7}, {0, -12.9, 0},   {0, -12.9, 0}};
    enum { HELD = sizeof names / sizeof *names };
    actor a;
    points before;
    face_control control[HELD];
    double end[HELD][3], worst = 0.0, held = 0.0;
    float dof[MRT_MAX_DOFS] = {0.0f};
    error err = {""};
    open_puppet(&a);
    hold_named(&a, control, names, HELD);
    must(points_create(&before, face_order(a.face), a.file.mesh.position, &err), &err);
    float *jaw = dof + face_bones(a.face)->first_dof[face_bones(a.face)->jaw];
    for (int i = 0; i <= STEPS; ++i) {
        const uint8_t rides[HELD] = {1, 1, 1, 1, 1, 1};
        jaw[0] = 0.52f * (float)i / STEPS;
        jaw[1] = -6.0f * (float)i / STEPS;
        memcpy(end, pull, sizeof end);
        face_ride(a.face, end[0], rides, dof);
        must(face_pull(a.face, end[0], dof, &err), &err);
        if (i > 0)
            worst = fmax(worst, difference(&before, face_shown(a.face)));
        points_copy(&before, face_shown(a.face));
        held = fmax(held, face_measure_surface(a.face).held_back_mm);
        assert_true(face_measure_surface(a.face).min_determinant > 0.0);
    }
    print_message("at most %.3f mm a step, %.1f mm held back\n", worst, held);
    assert_true(worst > 0.05 && worst < 0.4);
    points_destroy(&before);
    close_actor(&a);
}

static void put(const char *folder, const char *name, const char *text)
{
    char path[256];
    error err = {""};
    (void)snprintf(path, sizeof path, "%s/%s", folder, name);
    must(file_write(path, text, strlen(text), &err), &err);
}

/* An OBJ whose pictures need one vertex more than it lists. */
static void a_rig_from_before_pictures_keeps_the_mesh_that_it_was_made_for(void **state)
{
    (void)state;
    static const struct {
        const char *knows;
        uint32_t vertex_count;
    } rigs[] = {{"\"mesh_vertices\": 4, ", 4}, {"\"mesh_vertices\": 5, ", 5}, {"", 5}};
    char folder[] = "/tmp/marotte-rigs-XXXXXX", path[256], text[256];
    error err = {""};
    assert_non_null(mkdtemp(folder));
    put(folder, "head.mtl", "newmtl skin\nmap_Kd gone.png\n");
    put(folder, "head.obj",
        "mtllib head.mtl\nv 0 0 0\nv 100 0 0\nv 100 200 0\nv 0 200 0\nvt 0 0\nvt 1 0\nvt 1 1\n"
        "usemtl skin\nf 1/1 2/2 3/3\nf 1/2 3/3 4/1\n");
    for (size_t i = 0; i < sizeof rigs / sizeof *rigs; ++i) {
        face_file f;
        (void)snprintf(text, sizeof text,
                       "{\"marotte_rig\": 1, \"mesh\": \"head.obj\", %s\"bones\": []}",
                       rigs[i].knows);
        put(folder, "head.rig.json", text);
        (void)snprintf(path, sizeof path, "%s/head.rig.json", folder);
        must(face_file_read(&f, path, NULL, FACE_FILE_ANY, &err), &err);
        assert_int_equal(f.mesh.vertex_count, rigs[i].vertex_count);
        assert_true((f.mesh.uv != NULL) == (rigs[i].vertex_count == 5));
        assert_int_equal(strstr(f.note, "its pictures are not drawn") != NULL,
                         rigs[i].vertex_count == 4);
        face_file_destroy(&f);
    }
    /* Of another mesh it is an error, as ever. */
    put(folder, "head.rig.json",
        "{\"marotte_rig\": 1, \"mesh\": \"head.obj\", \"mesh_vertices\": 3, \"bones\": []}");
    face_file f;
    assert_true(face_file_read(&f, path, NULL, FACE_FILE_USABLE, &err) < 0);
    (void)snprintf(text, sizeof text, "rm -r %s", folder);
    assert_int_equal(system(text), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(closed_lips_do_not_drag_each_other),
        cmocka_unit_test(lips_of_the_ict_face_do_not_drag_each_other),
        cmocka_unit_test(every_contact_lands_in_any_pose_and_nothing_jumps),
        cmocka_unit_test(no_pull_bends_what_bones_have_bent),
        cmocka_unit_test(bones_that_tilt_skin_make_no_pull_jump),
        cmocka_unit_test(a_rig_from_before_pictures_keeps_the_mesh_that_it_was_made_for),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
