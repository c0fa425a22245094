/* The limit of folds passes over what its bounds say is far from a fold, and guesses from the frame
 * before: of the puppet in random poses, under random pulls, small and far too large ones, the
 * shape shown has the bits that it has when every group of triangles is measured in every frame. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "face/frame/frame.h"
#include "stage/perform/face_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WAYS = 40, STEPS = 6 };

static uint64_t random_state = 5;

static double next_part(void) /* -1..1; splitmix64 */
{
    uint64_t z = (random_state += UINT64_C(0x9e3779b97f4a7c15));
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-52 - 1.0;
}

static void must(mrt_result result, const error *err)
{
    if (result < 0)
        fail_msg("%s", err->text);
}

typedef struct scene {
    face_file file;
    face *quick, *slow; /* slow: measures all */
    uint32_t count;
    double start[MRT_MAX_VECTORS][3], end[MRT_MAX_VECTORS][3], from[MRT_MAX_VECTORS][3],
        to[MRT_MAX_VECTORS][3];
    float dof[MRT_MAX_DOFS], dof_from[MRT_MAX_DOFS], dof_to[MRT_MAX_DOFS];
} scene;

static void engage(face *f, scene *s, const csrbf_settings *settings)
{
    error err = {""};
    face_control control[MRT_MAX_VECTORS];
    uint32_t contacts = 0;
    const mrt_contact *contact = face_contacts(f, &contacts);
    s->count = contacts < MRT_MAX_VECTORS ? contacts : MRT_MAX_VECTORS;
    for (uint32_t i = 0; i < s->count; ++i) {
        const mrt_vec3 at = contact[i].rest;
        control[i] = (face_control){{(double)at.x, (double)at.y, (double)at.z}, 1 + i};
        s->start[i][0] = control[i].start.x;
        s->start[i][1] = control[i].start.y;
        s->start[i][2] = control[i].start.z;
    }
    must(face_engage(f, settings, control, s->count, &err), &err);
    memcpy(s->to, s->start, sizeof s->to);
}

static void begin(scene *s)
{
    char path[4096];
    error err = {""};
    (void)snprintf(path, sizeof path, "%s/rigs/puppet/puppet.rig.json", SOURCE_DIR);
    must(face_file_read(&s->file, path, NULL, FACE_FILE_USABLE, &err), &err);
    face **const both[2] = {&s->quick, &s->slow};
    for (int i = 0; i < 2; ++i) {
        must(face_create(both[i], s->file.rig, &s->file.mesh, &s->file.topology, MRT_MAX_VECTORS,
                         &err),
             &err);
        engage(*both[i], s, &s->file.rig->solver);
    }
    s->slow->limit.measures_all_groups = true;
}

static void end(scene *s)
{
    face_destroy(s->quick);
    face_destroy(s->slow);
    face_file_destroy(&s->file);
}

/* A new aim: of some contacts up to `size` mm away, the others at rest; the bones anywhere. */
static void aim(scene *s, double size)
{
    const bones *b = face_bones(s->quick);
    memcpy(s->from, s->to, sizeof s->from);
    memcpy(s->dof_from, s->dof_to, sizeof s->dof_from);
    for (uint32_t i = 0; i < s->count; ++i)
        for (int axis = 0; axis < 3; ++axis)
            s->to[i][axis] = s->start[i][axis] + (i % 3 == 0 ? size * next_part() : 0.0);
    for (uint32_t i = 0; i < b->dof_count; ++i) {
        const float middle = 0.5f * (b->dof[i].min + b->dof[i].max),
                    half = 0.5f * (b->dof[i].max - b->dof[i].min);
        s->dof_to[i] = next_part() > 0.0 ? middle + half * (float)next_part() : 0.0f;
    }
}

static void step(scene *s, double part)
{
    error err = {""};
    for (uint32_t i = 0; i < s->count; ++i)
        for (int axis = 0; axis < 3; ++axis)
            s->end[i][axis] = s->from[i][axis] + part * (s->to[i][axis] - s->from[i][axis]);
    for (int i = 0; i < MRT_MAX_DOFS; ++i)
        s->dof[i] = s->dof_from[i] + (float)part * (s->dof_to[i] - s->dof_from[i]);
    must(face_pull(s->quick, s->end[0], s->dof, &err), &err);
    must(face_pull(s->slow, s->end[0], s->dof, &err), &err);
}

static void must_be_the_same(const scene *s, int way, int at)
{
    const points *a = face_shown(s->quick), *b = face_shown(s->slow);
    const size_t size = a->count * sizeof(float);
    if (memcmp(a->x, b->x, size) || memcmp(a->y, b->y, size) || memcmp(a->z, b->z, size))
        fail_msg("way %d, step %d: measuring every group gives another shape", way, at);
    if (face_metered(s->quick)->held_back_mm != face_metered(s->slow)->held_back_mm)
        fail_msg("way %d, step %d: measuring every group holds back otherwise", way, at);
}

static void what_is_passed_over_changes_nothing(void **state)
{
    (void)state;
    static scene s;
    uint32_t held = 0;
    begin(&s);
    for (int way = 0; way < WAYS; ++way) {
        const double size_mm[4] = {2.0, 5.0, 10.0, 25.0};
        aim(&s, size_mm[way % 4]);
        for (int i = 1; i <= STEPS; ++i) {
            step(&s, (double)i / STEPS);
            must_be_the_same(&s, way, i);
            held += face_metered(s.quick)->held_back_mm > 0.0;
        }
    }
    assert_true(held > WAYS && held < WAYS * STEPS); /* both kinds of frames were tried */
    end(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(what_is_passed_over_changes_nothing)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
