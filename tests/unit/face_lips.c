/* Lips meet and never pass through each other: the seal of the puppet's mouth under bones, pulls
 * and poses, and rims that cannot be sealed. mm. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "base/arrays.h"
#include "face/rig_check.h"
#include "face/face.h"
#include "mesh/position.h"
#include "stage/perform/face_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { COLUMNS = 25 };

typedef struct actor {
    face_file file;
    face *face;
    csrbf_settings settings;
} actor;

typedef struct slit { /* mm; 0 where the lips touch */
    double gap, overlap;
} slit;

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
}

static void open_puppet(actor *out)
{
    open_actor(out, SOURCE_DIR "/rigs/puppet/puppet.rig.json");
}

static void close_actor(actor *a)
{
    face_destroy(a->face);
    face_file_destroy(&a->file);
}

static vec3 shown(const actor *a, uint32_t vertex)
{
    return points_position(face_shown(a->face), face_order(a->face)->slot_of_file[vertex]);
}

static uint32_t dof_named(const actor *a, const char *name)
{
    const bones *b = face_bones(a->face);
    for (uint32_t i = 0; i < b->dof_count; ++i)
        if (strcmp(b->dof[i].name, name) == 0)
            return i;
    fail_msg("there is no degree of freedom %s", name);
    return 0;
}

static const rig_pose *pose_named(const actor *a, const char *name)
{
    for (uint32_t i = 0; i < a->file.rig->pose_count; ++i)
        if (strcmp(a->file.rig->pose[i].name, name) == 0)
            return &a->file.rig->pose[i];
    fail_msg("there is no pose %s", name);
    return NULL;
}

/* All contacts held; a pose (or NULL) over a jaw that is opened further, and the lips sealed. */
static void perform(actor *a, const rig_pose *pose, double jaw_deg, double seal)
{
    error err = {""};
    const rig *r = a->file.rig;
    uint32_t count = r->contact_count;
    face_control *control = calloc(count, sizeof *control);
    double *end = calloc(3 * (size_t)count, sizeof *end);
    uint8_t *rides = malloc(count);
    float dof[MRT_MAX_DOFS] = {0};
    memset(rides, 1, count);
    face_reset(a->face);
    for (uint32_t i = 0; i < count; ++i)
        control[i] = (face_control){mesh_position(&a->file.mesh, r->contact[i].vertex), 1 + i};
    for (uint32_t i = 0; pose && i < pose->pull_count; ++i) {
        double *to = end + 3 * (size_t)pose->pull_contact[i];
        to[0] = pose->pull_mm[i].x;
        to[1] = pose->pull_mm[i].y;
        to[2] = pose->pull_mm[i].z;
    }
    for (uint32_t i = 0; pose && i < pose->dof_count; ++i)
        dof[dof_named(a, pose->dof_name[i])] = (float)pose->dof_value[i];
    dof[dof_named(a, "jaw.open")] += (float)(jaw_deg * 3.14159265358979 / 180.0);
    dof[dof_named(a, "lips.seal")] = (float)seal;
    must(face_engage(a->face, &a->settings, control, count, &err), &err);
    face_ride(a->face, end, rides, dof);
    must(face_pull(a->face, end, dof, &err), &err);
    free(control);
    free(end);
    free(rides);
}

/* Height of a rim at a place across the mouth. */
static double rim_height(const actor *a, const uint32_t *rim, uint32_t count, double x)
{
    for (uint32_t i = 1; i < count; ++i) {
        vec3 p = shown(a, rim[i - 1]), q = shown(a, rim[i]);
        if (p.x <= x && x <= q.x && q.x > p.x)
            return p.y + (q.y - p.y) * (x - p.x) / (q.x - p.x);
    }
    return (double)NAN;
}

/* The lowest place of one lip, or the highest of the other, in a slice `wide` mm of either side. */
static slit measure(const actor *a)
{
    const rig_mouth *mouth = &a->file.rig->mouth;
    slit out = {0.0, 0.0};
    double right = shown(a, mouth->upper[0]).x;
    double left = shown(a, mouth->upper[mouth->upper_count - 1]).x;
    for (int k = 0; k < COLUMNS; ++k) {
        double x = right + (left - right) * (k + 1) / (COLUMNS + 1);
        double open = rim_height(a, mouth->upper, mouth->upper_count, x) -
                      rim_height(a, mouth->lower, mouth->lower_count, x);
        out.gap = fmax(out.gap, open);
        if (getenv("WHERE"))
            print_message("   x %.1f open %.3f\n", x, open);
        out.overlap = fmax(out.overlap, -open);
    }
    return out;
}

static void sealed_lips_meet_over_an_open_jaw(void **state)
{
    (void)state;
    static const char *const over[] = {
        NULL,          "viseme_aa", "mouthSmileLeft", "mouthFrownLeft", "mouthStretchLeft",
        "mouthPucker", "viseme_U",  "jawLeft"};
    static const double jaw_deg[] = {0, 3, 6, 10, 20, 32};
    actor a;
    open_puppet(&a);
    for (size_t p = 0; p < sizeof over / sizeof *over; ++p)
        for (size_t j = 0; j < sizeof jaw_deg / sizeof *jaw_deg; ++j) {
            perform(&a, over[p] ? pose_named(&a, over[p]) : NULL, jaw_deg[j], 0.0);
            slit open = measure(&a);
            perform(&a, over[p] ? pose_named(&a, over[p]) : NULL, jaw_deg[j], 1.0);
            slit closed = measure(&a);
            print_message(
                "%-18s jaw %4.1f: open %.2f (overlap %.2f), sealed gap %.3f overlap %.3f, "
                "least determinant %.3f, held %.2f\n",
                over[p] ? over[p] : "rest", jaw_deg[j], open.gap, open.overlap, closed.gap,
                closed.overlap, face_min_determinant(a.face), face_metered(a.face)->held_back_mm);
        }
    close_actor(&a);
}

static void no_pose_of_the_puppet_crosses_its_lips(void **state)
{
    (void)state;
    actor a;
    open_puppet(&a);
    for (uint32_t i = 0; i < a.file.rig->pose_count; ++i) {
        perform(&a, &a.file.rig->pose[i], 0.0, 0.0);
        slit s = measure(&a);
        if (s.overlap > 0.05)
            print_message("%-18s gap %.3f overlap %.3f det %.3f\n", a.file.rig->pose[i].name, s.gap,
                          s.overlap, face_min_determinant(a.face));
    }
    close_actor(&a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sealed_lips_meet_over_an_open_jaw),
        cmocka_unit_test(no_pose_of_the_puppet_crosses_its_lips),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
