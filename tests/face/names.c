/* face/face_weights.h on faces that nobody here made: what comes back of shapes that are performed
 * by contacts and bones, and of poses that are carried over from the puppet. They are not part of
 * the project: they lie in $MAROTTE_SHARED, or in shared/ beside the sources; without them this is
 * skipped. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "base/clock.h"
#include "face/face_weights.h"
#include "face/frame/frame.h"
#include "face/rig/rig_poses.h"
#include "face/rig_draft.h"
#include "stage/perform/face_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { PARTS_MAX = 4, MIXTURES = 40, SOLVES = 200 };

static const double seen_mm = 1.0; /* of a contact that performs a shape */
static char shared[2048];
static uint64_t random_state;

static double next_random(void) /* 0..1; splitmix64 */
{
    uint64_t z = (random_state += UINT64_C(0x9e3779b97f4a7c15));
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

static void must(mrt_result result, const error *err)
{
    if (result < 0)
        fail_msg("%s", err->text);
}

/* ---- a face, performed ---- */

typedef struct performed {
    face_file file;
    face *face;
    face_weights *weights;
    float *shown; /* vertex_count by 3 */
} performed;

static void begin(performed *p)
{
    error err = {""};
    binding bound;
    must(binding_create(&bound, p->file.rig, &p->file.mesh, &p->file.topology, &err), &err);
    must(face_create_shaped(&p->face, p->file.rig, &p->file.mesh, &bound, MRT_MAX_VECTORS, &err),
         &err);
    must(face_file_weights(&p->weights, &p->file, &err), &err);
    p->shown = malloc((size_t)3 * p->file.mesh.vertex_count * sizeof *p->shown);
    assert_non_null(p->shown);
}

static void end(performed *p)
{
    free(p->shown);
    face_weights_destroy(p->weights);
    face_destroy(p->face);
    face_file_destroy(&p->file);
}

static void draft(face_file *out, const char *head)
{
    char path[4096], *confirm = NULL;
    error err = {""};
    (void)snprintf(path, sizeof path, "%s/data/heads/%s", shared, head);
    must(face_file_read(out, path, NULL, FACE_FILE_USABLE, &err), &err);
    out->rig = calloc(1, sizeof *out->rig);
    assert_non_null(out->rig);
    must(rig_draft_make(out->rig, &confirm, &out->mesh, &out->topology, path, NULL, 0, &err), &err);
    free(confirm);
}

static const face_channels *solve(performed *p)
{
    points_to_rows(p->shown, face_shown(p->face), face_order(p->face));
    return face_weights_solve(p->weights, p->shown, face_metered(p->face)->dof);
}

typedef struct errors {
    double sum, worst;
    uint32_t count, far_count; /* of numbers; by more than 0.25 */
    uint32_t pressed_count;    /* mixtures that were left out */
    uint32_t worst_at;
} errors;

/* Of the 52 that the face can say; looks are of bones. */
static void compare(errors *to, const performed *p, const face_channels *channels,
                    const double weight[ARKIT_SHAPES])
{
    for (uint32_t i = 0; i < ARKIT_SHAPES; ++i) {
        face_name_source from = face_weights_source(p->weights, i);
        double off = fabs(channels->arkit[i] - weight[i]);
        if (from == FACE_NAME_NONE || from == FACE_NAME_BONES)
            continue;
        to->sum += off;
        to->count += 1;
        to->far_count += off > 0.25 ? 1 : 0;
        if (off > to->worst) {
            to->worst = off;
            to->worst_at = i;
        }
    }
}

static uint32_t count_of(const performed *p, face_name_source source)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < ARKIT_SHAPES; ++i)
        count += face_weights_source(p->weights, i) == source;
    return count;
}

static double solve_ms(performed *p)
{
    double best = INFINITY;
    for (int i = 0; i < SOLVES; ++i) {
        int64_t start_ns = clock_now_ns();
        (void)face_weights_solve(p->weights, p->shown, face_metered(p->face)->dof);
        best = fmin(best, (double)(clock_now_ns() - start_ns) * 1e-6);
    }
    return best;
}

static void tell(const performed *p, const char *name, const errors *e)
{
    print_message(
        "  %-12s %2u of the 52: %u shapes, %u poses, %u by eyes; mean error %.4f, greatest "
        "%.3f (%s), %u of %u by more than 0.25; in %u others lips are pressed\n",
        name, ARKIT_SHAPES - count_of(p, FACE_NAME_NONE), count_of(p, FACE_NAME_SHAPE),
        count_of(p, FACE_NAME_POSE), count_of(p, FACE_NAME_BONES),
        e->count > 0 ? e->sum / e->count : 0.0, e->worst, arkit_name[e->worst_at], e->far_count,
        e->count, e->pressed_count);
}

/* ---- its own shapes, asked for by contacts ---- */

static const char *base_name(char out[64], const char *name)
{
    size_t size = strlen(name);
    (void)snprintf(out, 64, "%s", name);
    if (arkit_find(name) == ARKIT_NONE && size > 2 && name[size - 2] == '_' && size < 64)
        out[size - 2] = '\0';
    return out;
}

/* What the bones do of a shape; NULL: the face has it not. */
static const float *turned_by(const performed *p, const char *target)
{
    const face_shapes *s = &p->face->shapes;
    for (uint32_t i = 0; i < s->count; ++i)
        if (strcmp(s->shape[i].name, target) == 0)
            return s->shape[i].dof;
    return NULL;
}

/* A contact or a bone can perform it: of a lid that has neither nobody can say that it is closed.
 */
static bool is_usable(const performed *p, uint32_t target)
{
    char name[64];
    const mesh_target *t = &p->file.mesh.target[target];
    const float *dof = turned_by(p, t->name);
    uint32_t at = arkit_find(base_name(name, t->name));
    double most_mm = 0.0;
    if (at >= ARKIT_SHAPES || face_weights_source(p->weights, at) != FACE_NAME_SHAPE ||
        at == arkit_find("mouthClose") || !dof)
        return false;
    for (uint32_t k = 0; k < p->file.rig->contact_count; ++k) {
        const float *o = t->offset + (size_t)3 * p->file.rig->contact[k].vertex;
        vec3 way = {(double)o[0], (double)o[1], (double)o[2]};
        most_mm = fmax(most_mm, vec3_length(way));
    }
    for (uint32_t d = 0; d < face_bones(p->face)->dof_count; ++d)
        most_mm = dof[d] != 0.0f ? 1e9 : most_mm;
    return most_mm > seen_mm;
}

/* Bones are driven, as a hand drives them. */
static void drive(const performed *p, const double weight[ARKIT_SHAPES], float dof[MRT_MAX_DOFS])
{
    const bones *b = face_bones(p->face);
    const mesh *m = &p->file.mesh;
    for (uint32_t d = 0; d < b->dof_count; ++d)
        dof[d] = 0.0f;
    for (uint32_t t = 0; t < m->target_count; ++t) {
        char name[64];
        uint32_t at = arkit_find(base_name(name, m->target[t].name));
        const float *by = turned_by(p, m->target[t].name);
        for (uint32_t d = 0; d < b->dof_count && by && at < ARKIT_SHAPES; ++d)
            dof[d] += (float)weight[at] * by[d];
    }
}

/* A mixture's ends of all contacts that can be held; halves of browInnerUp go together. */
static void ask(const performed *p, const double weight[ARKIT_SHAPES], double *end,
                const face_control *control, uint32_t count)
{
    const mesh *m = &p->file.mesh;
    for (uint32_t k = 0; k < count; ++k) {
        end[3 * k] = control[k].start.x;
        end[3 * k + 1] = control[k].start.y;
        end[3 * k + 2] = control[k].start.z;
    }
    for (uint32_t t = 0; t < m->target_count; ++t) {
        char name[64];
        uint32_t at = arkit_find(base_name(name, m->target[t].name));
        for (uint32_t k = 0; k < count && at < ARKIT_SHAPES && weight[at] > 0.0; ++k)
            for (size_t axis = 0; axis < 3; ++axis)
                end[3 * k + axis] +=
                    weight[at] *
                    (double)m->target[t]
                        .offset[(size_t)3 * p->file.rig->contact[control[k].contact - 1].vertex +
                                axis];
    }
}

/* How far lips that touch are kept from where they were to go. */
static double pressed_mm(const face *f)
{
    double most = 0.0;
    for (uint32_t i = 0; i < f->lips.count; ++i)
        most = fmax(most, vec3_length(vec3_row(f->lips.correction, i)));
    return most;
}

static void mix(performed *p, errors *out, uint32_t count)
{
    face_control control[MRT_MAX_VECTORS];
    double to[3 * MRT_MAX_VECTORS];
    uint32_t usable[512], usable_count = 0;
    const mesh *m = &p->file.mesh;
    csrbf_settings solver = rig_poses_solver(p->file.rig, m);
    error err = {""};
    solver.stretch_most = p->file.rig->solver.stretch_most;
    for (uint32_t k = 0; k < count; ++k) {
        const float *at = m->position + (size_t)3 * p->file.rig->contact[k].vertex;
        control[k] = (face_control){{(double)at[0], (double)at[1], (double)at[2]}, 1 + k};
    }
    for (uint32_t t = 0; t < m->target_count && usable_count < 512; ++t)
        if (is_usable(p, t))
            usable[usable_count++] = t;
    assert_true(usable_count > PARTS_MAX);
    random_state = 7;
    for (int n = 0; n < MIXTURES; ++n) {
        double weight[ARKIT_SHAPES] = {0};
        float dof[MRT_MAX_DOFS];
        for (int part = 1 + (int)(PARTS_MAX * next_random()); part > 0; --part) {
            char name[64];
            const char *called = m->target[usable[(size_t)(next_random() * usable_count)]].name;
            weight[arkit_find(base_name(name, called))] = 0.3 + 0.7 * next_random();
        }
        ask(p, weight, to, control, count);
        face_reset(p->face);
        must(face_engage(p->face, &solver, control, count, &err), &err);
        drive(p, weight, dof);
        must(face_pull(p->face, to, dof, &err), &err);
        if (pressed_mm(p->face) > 0.5) /* pressed lips show another face than was asked for */
            out->pressed_count += 1;
        else
            compare(out, p, solve(p), weight);
    }
}

static void shapes_that_contacts_pull_come_back(void **state)
{
    (void)state;
    performed p = {.face = NULL};
    errors e = {.sum = 0.0};
    error err = {""};
    must(face_file_read(&p.file, SOURCE_DIR "/tests/face/ict.rig.json", NULL, FACE_FILE_USABLE,
                        &err),
         &err);
    begin(&p);
    mix(&p, &e, p.file.rig->contact_count);
    tell(&p, "ict", &e);
    print_message("  a solve takes %.3f ms\n", solve_ms(&p));
    end(&p);
    p = (performed){.face = NULL};
    errors own = {.sum = 0.0};
    draft(&p.file, "rpm_arkit.glb");
    begin(&p);
    mix(&p, &own, p.file.rig->contact_count);
    tell(&p, "rpm_arkit", &own);
    end(&p);
    assert_true(e.sum / e.count < 0.05 && e.far_count == 0);
    assert_true(own.sum / own.count < 0.05 && own.far_count == 0);
}

/* ---- poses that are the puppet's ---- */

static void poses_are_carried_to_heads_that_were_drafted(void **state)
{
    (void)state;
    face_file puppet;
    error err = {""};
    must(face_file_read(&puppet, SOURCE_DIR "/rigs/puppet/puppet.rig.json", NULL, FACE_FILE_USABLE,
                        &err),
         &err);
    static const char *const heads[] = {"reyn_head.glb", "leeperry_draco.glb", "bust.gltf"};
    for (size_t n = 0; n < sizeof heads / sizeof *heads; ++n) {
        performed p = {.face = NULL};
        errors e = {.sum = 0.0};
        uint32_t folds = 0, jaw = 0;
        draft(&p.file, heads[n]);
        rig_poses_stage stage;
        must(rig_poses_stage_init(&stage, p.file.rig, &p.file.mesh, &p.file.topology, &err), &err);
        must(rig_poses_transfer(p.file.rig, &p.file.mesh, stage.face, puppet.rig, &puppet.mesh,
                                &puppet.topology, &err),
             &err);
        rig_poses_stage_finish(&stage);
        begin(&p);
        csrbf_settings solver = rig_poses_solver(p.file.rig, &p.file.mesh);
        must(rig_poses_complete(p.file.rig, 0, p.face, &solver, &err), &err);
        solver.stretch_most = p.file.rig->solver.stretch_most;
        for (uint32_t i = 0; i < p.file.rig->pose_count; ++i) {
            const char *name = p.file.rig->pose[i].name;
            double weight[ARKIT_SHAPES] = {0};
            uint32_t at = arkit_find(name);
            if (at >= ARKIT_SHAPES || face_weights_source(p.weights, at) != FACE_NAME_POSE)
                continue;
            weight[at] = 1.0;
            if (strcmp(name, "mouthClose") == 0)
                weight[arkit_find("jawOpen")] = 1.0;
            must(rig_poses_show_on(p.face, p.file.rig, i, &solver, &err), &err);
            compare(&e, &p, solve(&p), weight);
            folds += face_min_determinant(p.face) > 0.0 ? 0 : 1;
            jaw += at == arkit_find("jawOpen");
        }
        tell(&p, heads[n], &e);
        assert_true(jaw == 1 && folds == 0);
        assert_true(count_of(&p, FACE_NAME_POSE) >= 30);
        assert_true(e.sum / e.count < 0.02);
        end(&p);
    }
    face_file_destroy(&puppet);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shapes_that_contacts_pull_come_back),
        cmocka_unit_test(poses_are_carried_to_heads_that_were_drafted),
    };
    const char *channels = getenv("MAROTTE_SHARED");
    char path[4096];
    (void)snprintf(shared, sizeof shared, "%s", channels ? channels : SOURCE_DIR "/../shared");
    (void)snprintf(path, sizeof path, "%s/data/heads/rpm_arkit.glb", shared);
    if (access(path, R_OK) != 0) {
        printf("SKIPPED: %s is not there; set MAROTTE_SHARED to the folder with data/\n", path);
        return 77;
    }
    (void)setenv("MAROTTE_FILE_FOLDERS", shared, 1);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
