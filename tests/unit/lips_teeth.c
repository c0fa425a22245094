/* The puppet's lips stay before its teeth, and do not pass through each other: in every pose, and
 * whatever hands perform. A vertex of
 * the lips is behind a row by as much as a way out of the mouth, level and from the middle of the
 * row's arch, still has to go to the last tooth on it. mm. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "face/rig/rig_poses.h"
#include "face/rig_draft.h"
#include "resume_scene.h"
#include "mesh/position.h"
#include "slit.h"

enum { BINS = 128, ROWS = 2 };
static const double lips_reach_mm = 12.0, behind_most_mm = 0.2, overlap_most_mm = 0.3;

/* Teeth of a row, by their direction from the middle of its arch. */
typedef struct row {
    uint32_t bone;
    double low_y, high_y, middle_z, front_z, furthest_mm;
    uint32_t *triangle[BINS], count[BINS];
} row;

typedef struct stand {
    face_file file;
    row row[ROWS];
    uint32_t *lip, lip_count; /* vertices */
    uint8_t *skipped[ROWS];   /* of each lip: behind the row at rest, as the bag's are */
} stand;

static bool is_part(const mesh *m, uint32_t part, const char *prefix)
{
    return strncmp(m->part[part].name, prefix, strlen(prefix)) == 0;
}

static uint8_t *vertices_of(const mesh *m, const char *prefix)
{
    uint8_t *out = calloc(m->vertex_count, 1);
    assert_non_null(out);
    for (uint32_t p = 0; p < m->part_count; ++p)
        for (size_t i = 0; is_part(m, p, prefix) && i < (size_t)3 * m->part[p].triangle_count; ++i)
            out[m->triangle[(size_t)3 * m->part[p].first_triangle + i]] = 1;
    return out;
}

/* Within 12 mm of the edge of the lips, where the skin becomes the bag. */
static void find_lips(stand *s)
{
    const mesh *m = &s->file.mesh;
    uint8_t *is_skin = vertices_of(m, "skin"), *is_bag = vertices_of(m, "mouth_bag");
    s->lip = calloc(m->vertex_count, sizeof *s->lip);
    assert_non_null(s->lip);
    for (uint32_t v = 0; v < m->vertex_count; ++v) {
        double nearest = 1e30;
        for (uint32_t e = 0; e < m->vertex_count && (is_skin[v] || is_bag[v]); ++e)
            if (is_skin[e] && is_bag[e])
                nearest =
                    fmin(nearest, vec3_length(vec3_sub(mesh_position(m, v), mesh_position(m, e))));
        if (nearest < lips_reach_mm)
            s->lip[s->lip_count++] = v;
    }
    assert_true(s->lip_count > 500);
    free(is_skin);
    free(is_bag);
}

static int bin_of(double x, double z)
{
    int bin = (int)floor((atan2(x, z) + 3.14159265358979) / 6.28318530717959 * BINS);
    return bin < 0 ? 0 : bin >= BINS ? BINS - 1 : bin;
}

static void find_row(row *out, const mesh *m, const char *prefix, uint32_t bone)
{
    uint8_t *is_tooth = vertices_of(m, prefix);
    double back = 1e30;
    *out = (row){.bone = bone, .low_y = 1e30, .high_y = -1e30};
    for (uint32_t v = 0; v < m->vertex_count; ++v)
        if (is_tooth[v]) {
            vec3 at = mesh_position(m, v);
            out->low_y = fmin(out->low_y, at.y);
            out->high_y = fmax(out->high_y, at.y);
            back = fmin(back, at.z);
            out->front_z = fmax(out->front_z, at.z);
        }
    out->middle_z = back;
    for (int b = 0; b < BINS; ++b)
        out->triangle[b] = calloc(m->triangle_count, sizeof *out->triangle[b]);
    for (uint32_t t = 0; t < m->triangle_count; ++t) {
        const uint32_t *corner = m->triangle + (size_t)3 * t;
        if (!is_tooth[corner[0]] || !is_tooth[corner[1]] || !is_tooth[corner[2]])
            continue;
        int low = BINS, high = -1;
        for (int i = 0; i < 3; ++i) {
            vec3 at = mesh_position(m, corner[i]);
            int bin = bin_of(at.x, at.z - back);
            out->furthest_mm = fmax(out->furthest_mm, hypot(at.x, at.z - back));
            low = bin < low ? bin : low;
            high = bin > high ? bin : high;
        }
        for (int b = low; b <= high && high - low < BINS / 2; ++b)
            out->triangle[b][out->count[b]++] = t;
    }
    free(is_tooth);
}

/* How far along `way` (unit) from `at` a triangle is met; below 0: not. */
static double meets(const mesh *m, uint32_t triangle, vec3 at, vec3 way)
{
    const uint32_t *corner = m->triangle + (size_t)3 * triangle;
    vec3 a = mesh_position(m, corner[0]);
    vec3 u = vec3_sub(mesh_position(m, corner[1]), a), v = vec3_sub(mesh_position(m, corner[2]), a);
    vec3 p = vec3_cross(way, v), from = vec3_sub(at, a);
    double det = vec3_dot(u, p);
    if (fabs(det) < 1e-12)
        return -1.0;
    double s = vec3_dot(from, p) / det;
    vec3 q = vec3_cross(from, u);
    double t = vec3_dot(way, q) / det;
    return s < 0.0 || t < 0.0 || s + t > 1.0 ? -1.0 : vec3_dot(v, q) / det;
}

/* at: in the frame of the row's bone. */
static double behind(const row *r, const mesh *m, vec3 at)
{
    vec3 way = {at.x, 0.0, at.z - r->middle_z};
    double out = vec3_length(way), furthest = 0.0;
    if (at.y < r->low_y || at.y > r->high_y || out > r->furthest_mm || out < 1e-6)
        return 0.0;
    int bin = bin_of(way.x, way.z);
    way = vec3_scale(way, 1.0 / out);
    for (uint32_t i = 0; i < r->count[bin]; ++i)
        furthest = fmax(furthest, meets(m, r->triangle[bin][i], at, way));
    return furthest;
}

static void set_up(stand *s)
{
    *s = (stand){0};
    scene_rig(&s->file, "puppet");
    const mesh *m = &s->file.mesh;
    find_lips(s);
    find_row(&s->row[0], m, "teeth_upper", rig_find_bone(s->file.rig, "skull"));
    find_row(&s->row[1], m, "teeth_lower", rig_find_bone(s->file.rig, "jaw"));
    for (int k = 0; k < ROWS; ++k) {
        s->skipped[k] = calloc(s->lip_count, 1);
        assert_non_null(s->skipped[k]);
        for (uint32_t i = 0; i < s->lip_count; ++i)
            s->skipped[k][i] = behind(&s->row[k], m, mesh_position(m, s->lip[i])) > 0.0;
    }
}

static void tear_down(stand *s)
{
    for (int k = 0; k < ROWS; ++k) {
        for (int b = 0; b < BINS; ++b)
            free(s->row[k].triangle[b]);
        free(s->skipped[k]);
    }
    free(s->lip);
    face_file_destroy(&s->file);
}

typedef struct depth {
    double mm, overlap_mm; /* of a lip behind the teeth; of lips inside each other */
    uint32_t vertex, row;
} depth;

typedef struct upright {
    const face *face;
    rigid into_skull;
} upright;

static vec3 upright_place(const void *of, uint32_t vertex)
{
    const upright *u = of;
    return rigid_apply(&u->into_skull, slit_shown(u->face, vertex));
}

/* The deepest lip of a face as it is shown. */
static void note_deepest(depth *deepest, const stand *s, const face *f)
{
    rigid pose[RIG_BONES_MAX];
    float dof[MRT_MAX_DOFS] = {0};
    bones_unlimit(dof, face_bones(f), face_metered(f)->dof);
    bones_pose(pose, face_bones(f), dof);
    for (uint32_t k = 0; k < ROWS; ++k) {
        rigid into = rigid_inverse(&pose[s->row[k].bone]);
        for (uint32_t i = 0; i < s->lip_count; ++i) {
            vec3 at = rigid_apply(&into, slit_shown(f, s->lip[i]));
            double mm = s->skipped[k][i] ? 0.0 : behind(&s->row[k], &s->file.mesh, at);
            if (mm > deepest->mm)
                *deepest = (depth){mm, deepest->overlap_mm, s->lip[i], k};
        }
    }
    const upright place = {f, rigid_inverse(&pose[s->row[0].bone])};
    slit lips;
    if (!slit_measure(&lips, &s->file.rig->mouth, upright_place, &place))
        fail_msg("a rim does not go from corner to corner");
    deepest->overlap_mm = fmax(deepest->overlap_mm, lips.overlap);
}

static void print_depth(const char *of, const depth *deepest)
{
    print_message("%-24s %5.2f mm behind the %s teeth (vertex %u), lips overlap by %.2f mm\n", of,
                  deepest->mm, deepest->row == 0 ? "upper" : "lower", deepest->vertex,
                  deepest->overlap_mm);
}

static void lips_are_before_the_teeth_in_every_pose(void **state)
{
    (void)state;
    static stand s;
    rig_poses_stage stage;
    error err = {""};
    double most = 0.0;
    set_up(&s);
    scene_must(rig_poses_stage_init(&stage, s.file.rig, &s.file.mesh, &s.file.topology, &err),
               &err);
    for (uint32_t i = 0; i < s.file.rig->pose_count; ++i) {
        depth deepest = {0};
        scene_must(rig_poses_show(&stage, i, &err), &err);
        note_deepest(&deepest, &s, stage.face);
        if (deepest.mm > behind_most_mm)
            print_depth(s.file.rig->pose[i].name, &deepest);
        most = fmax(most, deepest.mm);
    }
    print_message("%u poses, %u lip vertices: at most %.2f mm\n", s.file.rig->pose_count,
                  s.lip_count, most);
    assert_true(most <= behind_most_mm);
    rig_poses_stage_finish(&stage);
    tear_down(&s);
}

static void lips_are_before_the_teeth_whatever_hands_perform(void **state)
{
    (void)state;
    enum { EVERY = 5 };
    const uint32_t frames = getenv("MAROTTE_TEST_LONG") ? 1500 : 300; /* 300 hands, or 60 */
    static const struct {
        const char *name, *params;
    } mapping[] = {
        {"anchored", ""}, {"unanchored", ""}, {"one_hand", ""}, {"poses", "amount=120,width=80"},
        {"sculpt", ""},   {"magnet", ""},     {"tongs", ""},    {"gesture", ""}};
    static stand s;
    double most = 0.0;
    set_up(&s);
    for (size_t i = 0; i < sizeof mapping / sizeof *mapping; ++i) {
        depth deepest = {0};
        double least = 1.0;
        face_file file;
        scene_stand at;
        const scene_play play = {
            .mapping = mapping[i].name, .face = "puppet", .params = mapping[i].params};
        scene_face(&file, "puppet");
        scene_stand_up(&at, &play, &file);
        for (uint32_t n = 0; n < frames; ++n) {
            scene_step(&at, &play, n);
            if (n % EVERY != EVERY - 1)
                continue;
            composer_draw(at.performer->composer);
            note_deepest(&deepest, &s, composer_face(at.performer->composer));
            if (composer_is_anchored(at.performer->composer))
                least = fmin(least, face_min_determinant(composer_face(at.performer->composer)));
        }
        print_depth(mapping[i].name, &deepest);
        print_message("%-24s least determinant %.3f\n", "", least);
        most = fmax(most, deepest.mm);
        assert_true(least > 0.0);
        assert_true(deepest.overlap_mm <= overlap_most_mm);
        scene_lay_down(&at);
        face_file_destroy(&file);
    }
    assert_true(most <= behind_most_mm);
    tear_down(&s);
}

/* Random ends for all contacts at once, over an opening of the jaw. */
static void pull_randomly(face *f, const stand *s, uint64_t random, double most_mm)
{
    const rig *r = s->file.rig;
    error err = {""};
    face_control control[MRT_MAX_VECTORS];
    double end[3 * MRT_MAX_VECTORS];
    float dof[MRT_MAX_DOFS];
    uint8_t rides[MRT_MAX_VECTORS];
    for (int d = 0; d < MRT_MAX_DOFS; ++d)
        dof[d] = NAN;
    dof[face_bones(f)->first_dof[face_bones(f)->jaw]] = 0.05f * (float)(random % 6);
    face_reset(f);
    for (uint32_t k = 0; k < r->contact_count; ++k) {
        control[k] = (face_control){mesh_position(&s->file.mesh, r->contact[k].vertex), 1 + k};
        rides[k] = 1;
    }
    scene_must(face_engage(f, &r->solver, control, r->contact_count, &err), &err);
    for (uint32_t k = 0; k < 3 * r->contact_count; ++k) {
        random = random * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
        end[k] = most_mm * ((double)(random >> 40) * 0x1p-23 - 1.0);
    }
    face_ride(f, end, rides, dof);
    scene_must(face_pull(f, end, dof, &err), &err);
}

static void lips_are_before_the_teeth_in_random_hands(void **state)
{
    (void)state;
    enum { STRENGTHS = 3 };
    const uint64_t hand_count = getenv("MAROTTE_TEST_LONG") ? 40 : 12;
    static const double pull_mm[STRENGTHS] = {4.0, 8.0, 14.0}; /* no hand pulls as the last */
    static stand s;
    face *f;
    error err = {""};
    set_up(&s);
    scene_must(face_create(&f, s.file.rig, &s.file.mesh, &s.file.topology, MRT_MAX_VECTORS, &err),
               &err);
    for (int strength = 0; strength < STRENGTHS; ++strength) {
        depth deepest = {0};
        double least = 1.0;
        char of[48];
        for (uint64_t hand = 0; hand < hand_count; ++hand) {
            pull_randomly(f, &s, 11 + hand, pull_mm[strength]);
            note_deepest(&deepest, &s, f);
            least = fmin(least, face_min_determinant(f));
        }
        (void)snprintf(of, sizeof of, "random, up to %.0f mm", pull_mm[strength]);
        print_depth(of, &deepest);
        print_message("%-24s least determinant %.3f\n", "", least);
        assert_true(deepest.mm <= behind_most_mm && deepest.overlap_mm <= overlap_most_mm);
        assert_true(least > 0.0);
    }
    face_destroy(f);
    tear_down(&s);
}

/* F: the lower lip goes under the upper teeth and touches their edge, from below. */
static void a_lower_lip_touches_the_edge_of_the_upper_teeth(void **state)
{
    (void)state;
    static stand s;
    face *f;
    error err = {""};
    double nearest = 1e30;
    set_up(&s);
    const rig *r = s.file.rig;
    const uint32_t contact = rig_find_contact(r, "lip.lower.mid");
    const vec3 at = mesh_position(&s.file.mesh, r->contact[contact].vertex);
    const face_control control = {at, 1 + contact};
    scene_must(face_create(&f, r, &s.file.mesh, &s.file.topology, MRT_MAX_VECTORS, &err), &err);
    const binding *b = face_binding(f);
    for (double down = 14.0; down >= 2.0; down -= 0.25) {
        const double end[3] = {at.x, at.y - down, at.z - 10.0};
        float dof[MRT_MAX_DOFS] = {0};
        depth deepest = {0};
        double gap = 1e30;
        face_reset(f);
        scene_must(face_engage(f, &r->solver, &control, 1, &err), &err);
        scene_must(face_pull(f, end, dof, &err), &err);
        note_deepest(&deepest, &s, f);
        assert_true(deepest.mm <= behind_most_mm);
        for (uint32_t i = 0; i < s.lip_count; ++i) {
            vec3 p = slit_shown(f, s.lip[i]);
            bool is_lower = b->weight[(size_t)s.row[1].bone * b->vertex_count + s.lip[i]] > 0.9f;
            if (is_lower && fabs(p.x) < 10.0 && p.z < s.row[0].front_z - 4.0)
                gap = fmin(gap, s.row[0].low_y - p.y);
        }
        nearest = fmin(nearest, gap);
    }
    print_message("the lower lip is %.2f mm below the edge of the upper teeth\n", nearest);
    assert_true(nearest > -0.05 && nearest < 0.6);
    face_destroy(f);
    tear_down(&s);
}

/* A head whose lips lie in the shape at rest: they go no deeper, and nothing moves at rest. */
static void lips_that_touch_the_teeth_at_rest_go_no_deeper(void **state)
{
    (void)state;
    static stand s;
    face *f;
    error err = {""};
    set_up(&s);
    rig *r = s.file.rig;
    const uint32_t contact = rig_find_contact(r, "lip.upper.mid");
    const uint32_t vertex = r->contact[contact].vertex;
    const vec3 at = mesh_position(&s.file.mesh, vertex);
    rig_proxy *upper = &r->proxy[r->proxy_count - ROWS];
    upper->radii.z = at.z + 1.0 - upper->centre.z; /* the lip is 1 mm in it, or a little less */
    scene_must(face_create(&f, r, &s.file.mesh, &s.file.topology, MRT_MAX_VECTORS, &err), &err);
    scene_must(face_pull(f, NULL, NULL, &err), &err);
    assert_int_equal(face_metered(f)->projected_count, 0);
    const face_control control = {at, 1 + contact};
    const double end[3] = {at.x, at.y, at.z - 8.0};
    scene_must(face_engage(f, &r->solver, &control, 1, &err), &err);
    scene_must(face_pull(f, end, NULL, &err), &err);
    vec3 now = slit_shown(f, vertex);
    print_message("pulled back by 8 mm it goes %.2f mm\n", at.z - now.z);
    assert_true(at.z - now.z < 0.5);
    face_destroy(f);
    tear_down(&s);
}

/* `marotte rig teeth puppet` prints them. */
static void the_rows_of_the_puppet_are_those_that_are_fitted_to_its_teeth(void **state)
{
    (void)state;
    face_file file;
    rig fitted;
    error err = {""};
    scene_rig(&file, "puppet");
    scene_must(rig_copy(&fitted, file.rig, &err), &err);
    scene_must(rig_draft_teeth(&fitted, &file.mesh, &file.topology, &err), &err);
    assert_int_equal(fitted.proxy_count, file.rig->proxy_count);
    for (uint32_t i = 0; i < fitted.proxy_count; ++i) {
        const rig_proxy *is = &file.rig->proxy[i], *to_be = &fitted.proxy[i];
        assert_int_equal(is->kind, to_be->kind);
        assert_int_equal(is->bone, to_be->bone);
        assert_true(vec3_length(vec3_sub(is->centre, to_be->centre)) < 1e-6);
        assert_true(vec3_length(vec3_sub(is->radii, to_be->radii)) < 1e-6);
    }
    rig_destroy(&fitted);
    face_file_destroy(&file);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lips_are_before_the_teeth_in_every_pose),
        cmocka_unit_test(lips_are_before_the_teeth_whatever_hands_perform),
        cmocka_unit_test(lips_are_before_the_teeth_in_random_hands),
        cmocka_unit_test(a_lower_lip_touches_the_edge_of_the_upper_teeth),
        cmocka_unit_test(lips_that_touch_the_teeth_at_rest_go_no_deeper),
        cmocka_unit_test(the_rows_of_the_puppet_are_those_that_are_fitted_to_its_teeth)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
