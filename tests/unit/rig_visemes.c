/* The poses of the rigs as a lip-reader sees them: visemes differ on the lips, U is round and
 * forward, lips never overlap, nothing folds, and a performed pose is its portrait. mm. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "face/rig/rig_poses.h"
#include "mesh/position.h"
#include "slit.h"
#include "stage/perform/face_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PUPPET, MOAI, FACES };

/* Which vertices a pose is judged by. */
typedef struct known {
    face_file file;
    rig_poses_stage stage;
    bool *is_lip;  /* skin within 12 mm of a rim, not what lies behind the lips */
    bool *is_seen; /* lips, and skin within 12 mm of the contacts of brows, and lids */
    uint32_t lip_count;
} known;
static known faces[FACES];

static void must(mrt_result result, const error *err)
{
    if (result < 0)
        fail_msg("%s", err->text);
}

static bool starts(const char *name, const char *with)
{
    return strncmp(name, with, strlen(with)) == 0;
}

static bool is_near_rim(const known *k, vec3 at)
{
    const rig_mouth *mouth = &k->stage.rig.mouth;
    for (uint32_t i = 0; i < mouth->upper_count; ++i)
        if (vec3_length(vec3_sub(at, mesh_position(&k->file.mesh, mouth->upper[i]))) <= 12.0)
            return true;
    for (uint32_t i = 0; i < mouth->lower_count; ++i)
        if (vec3_length(vec3_sub(at, mesh_position(&k->file.mesh, mouth->lower[i]))) <= 12.0)
            return true;
    return false;
}

static bool is_near_brow(const known *k, vec3 at)
{
    const rig *r = &k->stage.rig;
    for (uint32_t i = 0; i < r->contact_count; ++i)
        if (starts(r->contact[i].name, "brow") &&
            vec3_length(vec3_sub(at, mesh_position(&k->file.mesh, r->contact[i].vertex))) <= 12.0)
            return true;
    return false;
}

static void mark(known *k)
{
    const mesh *m = &k->file.mesh;
    const binding *b = face_binding(k->stage.face);
    bool *is_skin = calloc(m->vertex_count, sizeof *is_skin);
    k->is_lip = calloc(m->vertex_count, sizeof *k->is_lip);
    k->is_seen = calloc(m->vertex_count, sizeof *k->is_seen);
    assert_true(is_skin && k->is_lip && k->is_seen);
    for (uint32_t p = 0; p < m->part_count; ++p) {
        const mesh_part *part = &m->part[p];
        for (size_t i = 0; i < (size_t)3 * part->triangle_count; ++i) {
            uint32_t v = m->triangle[(size_t)3 * part->first_triangle + i];
            is_skin[v] = is_skin[v] || !starts(part->name, "mouth");
            k->is_seen[v] = k->is_seen[v] || starts(part->name, "lid_");
        }
    }
    for (uint32_t v = 0; v < m->vertex_count; ++v) {
        const vec3 at = mesh_position(m, v);
        const bool is_free = is_skin[v] && b->mobility[v] > 0.0f;
        k->is_lip[v] = is_free && is_near_rim(k, at);
        k->lip_count += k->is_lip[v];
        k->is_seen[v] = k->is_seen[v] || k->is_lip[v] || (is_free && is_near_brow(k, at));
    }
    free(is_skin);
    assert_true(k->lip_count > 200);
}

static int open_faces(void **state)
{
    (void)state;
    static const char *const path[FACES] = {SOURCE_DIR "/rigs/puppet/puppet.rig.json",
                                            SOURCE_DIR "/rigs/moai/moai.rig.json"};
    for (int n = 0; n < FACES; ++n) {
        known *k = &faces[n];
        error err = {""};
        must(face_file_read(&k->file, path[n], NULL, FACE_FILE_USABLE, &err), &err);
        must(rig_poses_stage_init(&k->stage, k->file.rig, &k->file.mesh, &k->file.topology, &err),
             &err);
        mark(k);
    }
    return 0;
}

static int close_faces(void **state)
{
    (void)state;
    for (int n = 0; n < FACES; ++n) {
        free(faces[n].is_lip);
        free(faces[n].is_seen);
        rig_poses_stage_finish(&faces[n].stage);
        face_file_destroy(&faces[n].file);
    }
    return 0;
}

/* stretch_most < 0: the portrait; the rig's: as it is performed, with all contacts held. */
static float *copy_of(known *k, uint32_t pose, double stretch_most)
{
    const size_t size = (size_t)3 * k->file.mesh.vertex_count * sizeof(float);
    float *out = malloc(size);
    error err = {""};
    assert_non_null(out);
    k->stage.solver.stretch_most = stretch_most;
    must(rig_poses_show(&k->stage, pose, &err), &err);
    memcpy(out, k->stage.position, size);
    return out;
}

static float *performed(known *k, uint32_t pose)
{
    return copy_of(k, pose, k->file.rig->solver.stretch_most);
}

static float *performed_by_name(known *k, const char *name)
{
    for (uint32_t i = 0; i < k->stage.rig.pose_count; ++i)
        if (strcmp(k->stage.rig.pose[i].name, name) == 0)
            return performed(k, i);
    fail_msg("no pose %s", name);
    return NULL;
}

static vec3 at(const float *surface, uint32_t vertex)
{
    const float *p = surface + (size_t)3 * vertex;
    return (vec3){(double)p[0], (double)p[1], (double)p[2]};
}

static double lips_apart(const known *k, const float *a, const float *b)
{
    double sum = 0.0;
    for (uint32_t v = 0; v < k->file.mesh.vertex_count; ++v)
        if (k->is_lip[v]) {
            const vec3 way = vec3_sub(at(a, v), at(b, v));
            sum += vec3_dot(way, way);
        }
    return sqrt(sum / k->lip_count);
}

static void visemes_differ_on_the_lips(void **state)
{
    (void)state;
    static const char *const names[] = {"PP", "FF", "TH", "DD", "kk", "CH", "SS",
                                        "nn", "RR", "aa", "E",  "I",  "O",  "U"};
    enum { COUNT = sizeof names / sizeof *names };
    for (int n = 0; n < FACES; ++n) {
        known *k = &faces[n];
        float *shown[COUNT];
        print_message("  %s, root mean square on %u vertices of the lips, mm\n", k->stage.rig.name,
                      k->lip_count);
        for (int i = 0; i < COUNT; ++i) {
            char name[32];
            (void)snprintf(name, sizeof name, "viseme_%s", names[i]);
            shown[i] = performed_by_name(k, name);
            print_message("  %3s", names[i]);
            for (int other = 0; other < i; ++other) {
                const double apart = lips_apart(k, shown[i], shown[other]);
                print_message(" %5.1f", apart);
                if (!(apart >= 1.5))
                    fail_msg("%s and %s differ by %.2f mm", names[i], names[other], apart);
            }
            print_message("\n");
        }
        for (int i = 0; i < COUNT; ++i)
            free(shown[i]);
    }
}

/* Of the slit: pairs of points of the rims that are more than 0.5 mm apart. */
typedef struct opening {
    double width_mm, height_mm;
} opening;

static opening opening_of(const known *k, const float *surface)
{
    const rig_mouth *mouth = &k->stage.rig.mouth;
    double low[2] = {1e9, 1e9}, high[2] = {-1e9, -1e9};
    assert_int_equal(mouth->upper_count, mouth->lower_count);
    for (uint32_t i = 0; i < mouth->upper_count; ++i) {
        const vec3 pair[2] = {at(surface, mouth->upper[i]), at(surface, mouth->lower[i])};
        for (int p = 0; p < 2 && vec3_length(vec3_sub(pair[0], pair[1])) > 0.5; ++p) {
            low[0] = fmin(low[0], pair[p].x);
            high[0] = fmax(high[0], pair[p].x);
            low[1] = fmin(low[1], pair[p].y);
            high[1] = fmax(high[1], pair[p].y);
        }
    }
    assert_true(high[0] > low[0]);
    return (opening){high[0] - low[0], high[1] - low[1]};
}

static void round_mouths_are_round_and_forward(void **state)
{
    (void)state;
    static const char *const round[] = {"viseme_U", "viseme_O", "mouthPucker"};
    static const char *const middles[] = {"lip.upper.mid", "lip.lower.mid"};
    known *k = &faces[PUPPET];
    float *shown[3];
    for (int i = 0; i < 3; ++i) {
        shown[i] = performed_by_name(k, round[i]);
        const opening o = opening_of(k, shown[i]);
        print_message("  %s: %.1f mm wide, %.1f mm high, ratio %.2f\n", round[i], o.width_mm,
                      o.height_mm, o.width_mm / o.height_mm);
        assert_true(o.width_mm <= 1.5 * o.height_mm);
    }
    for (int i = 0; i < 2; ++i) {
        const rig *r = &k->stage.rig;
        const uint32_t vertex = r->contact[rig_find_contact(r, middles[i])].vertex;
        const double ahead = at(shown[0], vertex).z - at(shown[1], vertex).z;
        print_message("  U is %.1f mm in front of O at %s\n", ahead, middles[i]);
        assert_true(ahead >= 4.0);
    }
    for (int i = 0; i < 3; ++i)
        free(shown[i]);
}

static vec3 place_on(const void *surface, uint32_t vertex)
{
    return at(surface, vertex);
}

static double overlap_of(const known *k, const float *surface)
{
    slit out;
    if (!slit_measure(&out, &k->stage.rig.mouth, place_on, surface))
        fail_msg("a rim does not go from corner to corner");
    return out.overlap;
}

/* In all poses: lips do not overlap, nothing folds, and what is performed is the portrait. */
static void every_pose_is_sound(void **state)
{
    (void)state;
    for (int n = 0; n < FACES; ++n) {
        known *k = &faces[n];
        const binding *b = face_binding(k->stage.face);
        double overlap = 0.0, least = 1.0, seen = 0.0, held = 0.0;
        for (uint32_t i = 0; i < k->stage.rig.pose_count; ++i) {
            const char *name = k->stage.rig.pose[i].name;
            float *portrait = copy_of(k, i, -1.0), *now = performed(k, i);
            double apart[2] = {0.0, 0.0};
            for (uint32_t v = 0; v < k->file.mesh.vertex_count; ++v) {
                const double mm = vec3_length(vec3_sub(at(portrait, v), at(now, v)));
                apart[0] = b->mobility[v] > 0.0f ? fmax(apart[0], mm) : apart[0];
                apart[1] = k->is_seen[v] ? fmax(apart[1], mm) : apart[1];
            }
            if (!(apart[0] <= 0.5))
                fail_msg("%s is held back by %.2f mm", name, apart[0]);
            if (!(apart[1] <= 0.5))
                fail_msg("%s is %.2f mm beside its portrait", name, apart[1]);
            const double crossed = overlap_of(k, now), folded = face_min_determinant(k->stage.face);
            if (!(crossed <= 0.3 && folded > 0.0))
                fail_msg("%s: overlap %.2f mm, determinant %.3f", name, crossed, folded);
            held = fmax(held, apart[0]);
            seen = fmax(seen, apart[1]);
            overlap = fmax(overlap, crossed);
            least = fmin(least, folded);
            free(portrait);
            free(now);
        }
        print_message("  %s, %u poses: overlap %.3f mm, least determinant %.3f, held back %.2f mm, "
                      "beside the portrait on lips, brows and lids %.2f mm\n",
                      k->stage.rig.name, k->stage.rig.pose_count, overlap, least, held, seen);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(visemes_differ_on_the_lips),
        cmocka_unit_test(round_mouths_are_round_and_forward),
        cmocka_unit_test(every_pose_is_sound),
    };
    return cmocka_run_group_tests(tests, open_faces, close_faces);
}
