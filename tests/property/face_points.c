/* Files have a vertex twice along every seam. The puppet with seams everywhere performs as the
 * puppet does: no vertices of one point ever differ, and none goes another way than without
 * seams. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "csrbf_scene.h"
#include "face/face.h"
#include "io/mesh_file.h"
#include "io/openmesh.h"
#include "mesh/weld.h"

#include <stdlib.h>
#include <string.h>

enum { CONTACTS = 8, FRAMES = 20, FRAMES_LONG = 60 };

typedef struct performed {
    rig rig;
    mesh mesh;
    topology topology;
    face *face;
    float *rows; /* vertex_count by 3: as shown, in the file's order */
} performed;

static void must(mrt_result result, const error *err)
{
    if (result < 0)
        fail_msg("%s", err->text);
}

static double unit(uint64_t *seed)
{
    return (double)(scene_next(seed) >> 11) * 0x1p-53;
}

/* So many of the corners, 0..1, get a vertex of their own; not the first of each vertex, so that
 * the rig still fits. */
static void tear(mesh *m, uint64_t *seed, double part)
{
    size_t corners = (size_t)m->triangle_count * 3, count = m->vertex_count;
    m->position = realloc(m->position, (count + corners) * 3 * sizeof *m->position);
    m->normal = realloc(m->normal, (count + corners) * 3 * sizeof *m->normal);
    for (uint32_t i = 0; i < m->attribute_count; ++i)
        m->attribute[i].value =
            realloc(m->attribute[i].value, (count + corners) * 4 * sizeof *m->attribute[i].value);
    uint8_t *is_kept = calloc(count, 1);
    assert_non_null(is_kept);
    for (size_t i = 0; i < corners; ++i) {
        uint32_t v = m->triangle[i];
        bool is_first = !is_kept[v];
        is_kept[v] = 1;
        if (is_first || !(unit(seed) < part))
            continue;
        memcpy(m->position + 3 * count, m->position + 3 * (size_t)v, 3 * sizeof *m->position);
        memcpy(m->normal + 3 * count, m->normal + 3 * (size_t)v, 3 * sizeof *m->normal);
        for (uint32_t k = 0; k < m->attribute_count; ++k) {
            size_t width = m->attribute[k].component_count;
            memcpy(m->attribute[k].value + width * count, m->attribute[k].value + width * v,
                   width * sizeof(float));
        }
        m->triangle[i] = (uint32_t)count++;
    }
    m->vertex_count = (uint32_t)count;
    free(is_kept);
}

static void begin(performed *p, uint64_t *seed, double torn)
{
    error err = {""};
    *p = (performed){.face = NULL};
    must(rig_read(&p->rig, SOURCE_DIR "/rigs/puppet/puppet.rig.json", &err), &err);
    must(mesh_file_read(&p->mesh, p->rig.mesh_path, NULL, &err), &err);
    p->rig.mesh_vertex_count = 0;
    tear(&p->mesh, seed, torn);
    must(mesh_weld(&p->mesh, &err), &err);
    must(openmesh_topology(&p->topology, &p->mesh, &err), &err);
    must(face_create(&p->face, &p->rig, &p->mesh, &p->topology, CONTACTS, &err), &err);
    p->rows = calloc((size_t)p->mesh.vertex_count * 3, sizeof *p->rows);
    assert_non_null(p->rows);
}

static void end(performed *p)
{
    face_destroy(p->face);
    topology_destroy(&p->topology);
    mesh_destroy(&p->mesh);
    rig_destroy(&p->rig);
    free(p->rows);
}

static void engage(performed *p, uint64_t seed)
{
    const csrbf_settings settings = p->rig.solver;
    face_control control[CONTACTS];
    error err = {""};
    for (uint32_t i = 0; i < CONTACTS; ++i) {
        uint32_t contact = 1 + (uint32_t)(scene_next(&seed) % (p->rig.contact_count / CONTACTS)) +
                           i * (p->rig.contact_count / CONTACTS);
        control[i] = (face_control){face_contact_now(p->face, contact), contact};
    }
    must(face_engage(p->face, &settings, control, CONTACTS, &err), &err);
}

/* One frame: anchored, or a drag of clay. */
static void go_on(performed *p, uint64_t seed)
{
    const bones *b = face_bones(p->face);
    float dof[MRT_MAX_DOFS] = {0};
    double from[CONTACTS][3], to[CONTACTS][3], reached[3 * CONTACTS];
    error err = {""};
    for (uint32_t i = 0; i < b->dof_count; ++i)
        if (!face_dof_swings(p->face, i)) /* hands do not drive loose parts */
            dof[i] = b->dof[i].min + (float)unit(&seed) * (b->dof[i].max - b->dof[i].min);
    if (unit(&seed) < 0.2)
        engage(p, scene_next(&seed));
    for (uint32_t i = 0; i < CONTACTS; ++i) {
        vec3 at = face_contact_now(p->face, 1 + i * (p->rig.contact_count / CONTACTS));
        double way[3] = {at.x, at.y, at.z};
        for (size_t axis = 0; axis < 3; ++axis) {
            from[i][axis] = way[axis];
            to[i][axis] = way[axis] + 12.0 * (unit(&seed) - 0.5);
        }
    }
    if (face_control_count(p->face) > 0 && unit(&seed) < 0.7) {
        must(face_pull(p->face, to[0], dof, &err), &err);
    } else {
        shape_step step;
        must(
            face_drag(p->face, &p->rig.solver, from[0], to[0], CONTACTS, dof, reached, &step, &err),
            &err);
    }
    points_to_rows(p->rows, face_shown(p->face), face_order(p->face));
}

static void weights_are_those_without_seams(const performed *torn, const performed *whole)
{
    const binding *a = face_binding(torn->face), *b = face_binding(whole->face);
    for (uint32_t v = 0; v < torn->mesh.vertex_count; ++v) {
        uint32_t point = torn->mesh.point[v];
        assert_true(point < whole->mesh.vertex_count);
        assert_memory_equal(&a->mobility[v], &b->mobility[point], sizeof(float));
        for (uint32_t bone = 0; bone < b->bone_count; ++bone)
            assert_memory_equal(&a->weight[(size_t)bone * a->vertex_count + v],
                                &b->weight[(size_t)bone * b->vertex_count + point], sizeof(float));
    }
}

static void perform(uint64_t seed, double part)
{
    performed torn, whole;
    begin(&torn, &seed, part);
    begin(&whole, &seed, 0.0);
    assert_true(torn.mesh.vertex_count > whole.mesh.vertex_count);
    weights_are_those_without_seams(&torn, &whole);
    engage(&torn, seed);
    engage(&whole, seed);
    const int frames = getenv("MAROTTE_TEST_LONG") ? FRAMES_LONG : FRAMES;
    for (int frame = 0; frame < frames; ++frame) {
        go_on(&torn, seed);
        go_on(&whole, seed);
        (void)scene_next(&seed);
        for (uint32_t v = 0; v < torn.mesh.vertex_count; ++v)
            assert_memory_equal(torn.rows + (size_t)3 * v,
                                whole.rows + (size_t)3 * torn.mesh.point[v], 3 * sizeof(float));
    }
    end(&torn);
    end(&whole);
}

static void a_seam_here_and_there(void **state)
{
    (void)state;
    perform(1, 0.05);
    perform(2, 0.3);
}

static void no_two_triangles_share_a_vertex(void **state)
{
    (void)state;
    perform(3, 1.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_seam_here_and_there),
        cmocka_unit_test(no_two_triangles_share_a_vertex),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
