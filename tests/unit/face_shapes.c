/* The head's own shapes: they answer pulls before the fields do, beside the bones and never twice.
 */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "face/face_weights.h"
#include "unit/allocation_count.h"
#include "unit/face_scene.h"

enum { JAW_OPEN, MOUTH_CLOSE, SMILE, BROW_UP, CHEEK_FOLD, LOOK_LEFT, STILL, SHAPES };
enum { FRAMES = 60 };
static const csrbf_settings settings = {.radius = 30.0};
static const double jaw_rad = 0.35, look_rad = 0.4;

typedef struct shaped {
    face_scene scene;
    mesh_target target[SHAPES];
    float offset[SHAPES][SCENE_VERTICES][3];
} shaped;

static void must(mrt_result result, const error *err)
{
    if (result < 0)
        fail_msg("%s", err->text);
}

static double hill(const face_scene *s, uint32_t v, double x, double y, double reach)
{
    double dx = (double)s->position[v][0] - x, dy = (double)s->position[v][1] - y;
    double q = 1.0 - (dx * dx + dy * dy) / (reach * reach);
    return q > 0.0 && v < SCENE_UPPER_TEETH ? q * q : 0.0;
}

static void set(shaped *s, int which, uint32_t v, double x, double y, double z)
{
    s->offset[which][v][0] = (float)x;
    s->offset[which][v][1] = (float)y;
    s->offset[which][v][2] = (float)z;
}

/* jawOpen is the jaw's motion and a hill beside it; eyeLookOutLeft the eye's and a lid's. */
static void sculpt(shaped *s, char *const names[SHAPES])
{
    const face_scene *scene = &s->scene;
    binding b;
    bones posed;
    error err = {""};
    rigid jaw[RIG_BONES_MAX], eye[RIG_BONES_MAX];
    float dof[MRT_MAX_DOFS] = {0}, look[MRT_MAX_DOFS] = {0};
    scene_bind(scene, &b);
    must(bones_init(&posed, &scene->rig, (vec3){0, 0, 0}, &err), &err);
    dof[posed.first_dof[JAW]] = (float)jaw_rad;
    look[posed.first_dof[EYE]] = (float)look_rad;
    bones_pose(jaw, &posed, dof);
    bones_pose(eye, &posed, look);
    for (uint32_t v = 0; v < SCENE_VERTICES; ++v) {
        vec3 at = scene_rest(scene, v);
        double open = (double)b.weight[(size_t)JAW * SCENE_VERTICES + v];
        double sees = (double)b.weight[(size_t)EYE * SCENE_VERTICES + v];
        vec3 by = vec3_scale(vec3_sub(rigid_apply(&jaw[JAW], at), at), open);
        set(s, JAW_OPEN, v, by.x, by.y, by.z + 2.0 * hill(scene, v, 0, 12, 12));
        by = vec3_scale(vec3_sub(rigid_apply(&eye[EYE], at), at), sees);
        set(s, LOOK_LEFT, v, by.x + 0.3 * hill(scene, v, 30, 40, 12), by.y, by.z);
        set(s, MOUTH_CLOSE, v, 0, 9.0 * hill(scene, v, 0, -2, 14), 0);
        double up = hill(scene, v, 25, 0, 20);
        set(s, SMILE, v, 6.0 * up, 5.0 * up, 2.0 * up);
        set(s, BROW_UP, v, 0, 5.0 * hill(scene, v, 22, 50, 25), 0);
        set(s, CHEEK_FOLD, v, 14.0 * hill(scene, v, 33, 14, 9), 0, 0); /* it folds by itself */
    }
    for (int i = 0; i < SHAPES; ++i)
        s->target[i] = (mesh_target){names[i], s->offset[i][0]};
    s->scene.mesh.target = s->target;
    s->scene.mesh.target_count = SHAPES;
    binding_destroy(&b);
}

static char *const shape_names[SHAPES] = {"jawOpen",   "mouthClose",     "smile", "browUp",
                                          "cheekFold", "eyeLookOutLeft", "still"};

static void make_called(shaped *s, char *const names[SHAPES], mesh_expression *row, uint32_t count)
{
    error err = {""};
    binding b;
    scene_init(&s->scene);
    sculpt(s, names);
    s->scene.mesh.expression = row;
    s->scene.mesh.expression_count = count;
    scene_bind(&s->scene, &b);
    must(face_create_shaped(&s->scene.face, &s->scene.rig, &s->scene.mesh, &b, MRT_MAX_VECTORS,
                            &err),
         &err);
}

/* LOOK_DOWN instead of CHEEK_FOLD: the eye's turn and the lid's, of which a part is what it follows
 * the eye by. */
static const double look_down_rad = 0.25, lid_down_rad = 0.18;

static void make_looking_down(shaped *s, double share)
{
    static char *const names[SHAPES] = {"jawOpen",         "mouthClose",     "smile", "browUp",
                                        "eyeLookDownLeft", "eyeLookOutLeft", "still"};
    error err = {""};
    binding b;
    bones posed;
    float dof[MRT_MAX_DOFS] = {0};
    rigid pose[RIG_BONES_MAX];
    scene_init(&s->scene);
    sculpt(s, names);
    scene_bind(&s->scene, &b);
    must(bones_init(&posed, &s->scene.rig, (vec3){0, 0, 0}, &err), &err);
    dof[posed.first_dof[EYE] + 1] = (float)look_down_rad;
    dof[posed.first_dof[LID]] = (float)lid_down_rad;
    bones_pose(pose, &posed, dof);
    for (uint32_t v = 0; v < SCENE_VERTICES; ++v) {
        vec3 at = scene_rest(&s->scene, v), by = {0, 0, 0};
        for (uint32_t bone = EYE; bone <= LID; ++bone)
            by = vec3_add(by, vec3_scale(vec3_sub(rigid_apply(&pose[bone], at), at),
                                         (double)b.weight[(size_t)bone * SCENE_VERTICES + v]));
        set(s, CHEEK_FOLD, v, by.x, by.y, by.z);
    }
    s->scene.bone[LID].turn[0].follows = (rig_follow){EYE, 1, share};
    must(face_create_shaped(&s->scene.face, &s->scene.rig, &s->scene.mesh, &b, MRT_MAX_VECTORS,
                            &err),
         &err);
}

static void make(shaped *s)
{
    make_called(s, shape_names, NULL, 0);
}

static double weight_of(const shaped *s, const char *name)
{
    const face *f = s->scene.face;
    for (uint32_t i = 0; i < face_shape_count(f); ++i)
        if (strcmp(face_shape_name(f, i), name) == 0)
            return face_shape_weight(f, i);
    return -1.0;
}

static void ask(const shaped *s, double end[SCENE_CONTACTS][3], int which, double weight)
{
    for (int k = 0; k < SCENE_CONTACTS; ++k)
        for (int axis = 0; axis < 3; ++axis)
            end[k][axis] += weight * (double)s->offset[which][s->scene.contact[k].vertex][axis];
}

static double greatest_miss(const shaped *s, double end[SCENE_CONTACTS][3])
{
    double most = 0.0;
    for (int k = 0; k < SCENE_CONTACTS; ++k) {
        vec3 to = {end[k][0], end[k][1], end[k][2]};
        most = fmax(most, scene_distance(face_contact_now(s->scene.face, 1 + (uint32_t)k), to));
    }
    return most;
}

/* Of the face as shown to the rest face and so much of the shape, over all vertices, mm. */
static double greatest_off(const shaped *s, int which, double weight)
{
    double most = 0.0;
    for (uint32_t v = 0; v < SCENE_VERTICES; ++v) {
        const float *by = s->offset[which][v];
        vec3 way = {weight * (double)by[0], weight * (double)by[1], weight * (double)by[2]};
        most = fmax(most, scene_distance(scene_shown(&s->scene, v),
                                         vec3_add(scene_rest(&s->scene, v), way)));
    }
    return most;
}

static void shapes_that_move_nothing_are_none(void **state)
{
    static shaped s;
    (void)state;
    make(&s);
    assert_int_equal(face_shape_count(s.scene.face), SHAPES - 1);
    assert_true(weight_of(&s, "still") < 0.0);
    face_destroy(s.scene.face);
}

static void a_pull_that_a_shape_explains_becomes_that_shape(void **state)
{
    static shaped s;
    error err = {""};
    double end[SCENE_CONTACTS][3];
    (void)state;
    make(&s);
    must(scene_hold(&s.scene, &settings, end, &err), &err);
    ask(&s, end, SMILE, 0.7);
    must(face_pull(s.scene.face, end[0], NULL, &err), &err);
    assert_true(fabs(weight_of(&s, "smile") - 0.7) < 0.05);
    assert_true(weight_of(&s, "browUp") < 0.05);
    assert_true(greatest_off(&s, SMILE, 0.7) < 0.4);
    assert_true(greatest_miss(&s, end) < 1e-4);
    face_destroy(s.scene.face);
}

/* What no shape explains the fields do: every contact lands all the same. */
static void contacts_land_whatever_is_pulled(void **state)
{
    static shaped s;
    error err = {""};
    double end[SCENE_CONTACTS][3], way[SCENE_CONTACTS][3];
    (void)state;
    make(&s);
    must(scene_hold(&s.scene, &settings, end, &err), &err);
    for (int n = 0; n < FRAMES; ++n) {
        float dof[MRT_MAX_DOFS];
        memcpy(way, end, sizeof way);
        for (int k = 0; k < SCENE_CONTACTS; ++k) {
            way[k][0] += 2.0 * sin(0.3 * n + k);
            way[k][1] += 2.0 * cos(0.2 * n + 2 * k);
            way[k][2] += 1.5 * sin(0.5 * n + 3 * k);
        }
        for (int d = 0; d < MRT_MAX_DOFS; ++d)
            dof[d] = n % 2 == 0 || d > 2 ? NAN : (float)(0.05 * (n % 5));
        must(face_pull(s.scene.face, way[0], dof, &err), &err);
        for (uint32_t i = 0; i < face_shape_count(s.scene.face); ++i)
            assert_true(face_shape_weight(s.scene.face, i) >= 0.0 &&
                        face_shape_weight(s.scene.face, i) <= 1.0);
        if (!(face_metered(s.scene.face)->held_back_mm > 0.0))
            assert_true(greatest_miss(&s, way) < 1e-3);
        assert_true(face_min_determinant(s.scene.face) > 0.0);
    }
    face_destroy(s.scene.face);
}

/* The jaw opens and jawOpen adds what is beside that: together they are the shape as it was made,
 * whether the bone is driven or follows from the contacts. */
static void bones_and_shapes_do_the_work_once(void **state)
{
    static shaped s;
    error err = {""};
    double end[SCENE_CONTACTS][3];
    float dof[MRT_MAX_DOFS];
    (void)state;
    make(&s);
    for (int d = 0; d < MRT_MAX_DOFS; ++d)
        dof[d] = NAN;
    dof[scene_dof(&s.scene, "jaw.open")] = (float)jaw_rad;
    must(face_pull(s.scene.face, NULL, dof, &err), &err); /* nothing holds the face */
    assert_true(weight_of(&s, "jawOpen") > 0.95);
    assert_true(greatest_off(&s, JAW_OPEN, 1.0) < 0.3);
    face_reset(s.scene.face);
    must(scene_hold(&s.scene, &settings, end, &err), &err);
    ask(&s, end, JAW_OPEN, 1.0);
    must(face_pull(s.scene.face, end[0], NULL, &err), &err);
    assert_true(weight_of(&s, "jawOpen") > 0.9);
    double open = (double)face_metered(s.scene.face)->dof[scene_dof(&s.scene, "jaw.open")];
    assert_true(fabs(open - jaw_rad) < 0.03);
    assert_true(greatest_miss(&s, end) < 1e-4);
    face_destroy(s.scene.face);
}

/* eyeLookDown takes the lid along by itself: a lid that follows the gaze besides goes no further
 * than the head's maker had it. */
static void a_lid_that_a_look_moves_is_not_moved_twice(void **state)
{
    static const double shares[] = {0.0, 0.6, 0.72, 1.0};
    static shaped s;
    error err = {""};
    (void)state;
    for (size_t i = 0; i < sizeof shares / sizeof *shares; ++i) {
        float dof[MRT_MAX_DOFS];
        make_looking_down(&s, shares[i]);
        for (int d = 0; d < MRT_MAX_DOFS; ++d)
            dof[d] = NAN;
        dof[scene_dof(&s.scene, "eye.pitch")] = (float)look_down_rad;
        must(face_pull(s.scene.face, NULL, dof, &err), &err);
        double off = greatest_off(&s, CHEEK_FOLD, 1.0);
        print_message("follows by %.2f: %.2f mm off the file's shape\n", shares[i], off);
        assert_true(off < (shares[i] > 0.0 ? 0.8 : 2.0));
        face_destroy(s.scene.face);
    }
}

static void ask_for(const shaped *s, const char *name, float weight)
{
    float asked[SHAPES] = {0};
    for (uint32_t i = 0; i < face_shape_count(s->scene.face); ++i)
        if (strcmp(face_shape_name(s->scene.face, i), name) == 0)
            asked[i] = weight;
    face_set_least_weights(s->scene.face, asked);
}

/* With no hand there, and as it was made. */
static void a_shape_that_is_asked_for_is_that_shape(void **state)
{
    static shaped s;
    error err = {""};
    (void)state;
    make(&s);
    ask_for(&s, "smile", 0.6f);
    must(face_pull(s.scene.face, NULL, NULL, &err), &err);
    assert_true(fabs(weight_of(&s, "smile") - 0.6) < 1e-6);
    assert_true(greatest_off(&s, SMILE, 0.6) < 1e-3);
    face_set_least_weights(s.scene.face, NULL);
    must(face_pull(s.scene.face, NULL, NULL, &err), &err);
    assert_true(greatest_off(&s, SMILE, 0.0) < 1e-6);
    face_destroy(s.scene.face);
}

/* VRM's: what is asked for in its words, and said to other programs. */
static void words_of_the_file_are_sums_of_its_shapes(void **state)
{
    static shaped s;
    static float shown[SCENE_VERTICES][3];
    static mesh_expression rows[] = {{"eyeBlinkRight", STILL, 1.0f},
                                     {"happy", BROW_UP, 0.5f},
                                     {"happy", SMILE, 1.0f},
                                     {"jawOpen", SMILE, 1.0f}};
    float part[SHAPES];
    face_weights *weights;
    error err = {""};
    (void)state;
    make_called(&s, shape_names, rows, 4);
    face *f = s.scene.face;
    assert_true(face_shape_parts(f, "happy", part));
    for (uint32_t i = 0; i < face_shape_count(f); ++i)
        assert_true(part[i] == (strcmp(face_shape_name(f, i), "smile") == 0    ? 1.0f
                                : strcmp(face_shape_name(f, i), "browUp") == 0 ? 0.5f
                                                                               : 0.0f));
    /* A shape's own name comes first; one that moves nothing is no part of anything. */
    assert_true(face_shape_parts(f, "JawOpen", part));
    for (uint32_t i = 0; i < face_shape_count(f); ++i)
        assert_true(part[i] == (strcmp(face_shape_name(f, i), "jawOpen") == 0 ? 1.0f : 0.0f));
    assert_false(face_shape_parts(f, "eyeBlinkRight", part));
    assert_false(face_shape_parts(f, "sad", part));

    must(face_weights_create(&weights, f, &s.scene.rig, &s.scene.mesh, &err), &err);
    assert_true(face_shape_parts(f, "happy", part));
    for (uint32_t i = 0; i < face_shape_count(f); ++i)
        part[i] *= 0.6f;
    face_set_least_weights(f, part);
    must(face_pull(f, NULL, NULL, &err), &err);
    points_to_rows(shown[0], face_shown(f), face_order(f));
    const face_channels *channels = face_weights_solve(weights, shown[0], face_metered(f)->dof);
    for (uint32_t i = 0; i < FACE_EXPRESSIONS; ++i) {
        const char *name = face_expression_name[i];
        double wanted = strcmp(name, "happy") == 0 ? 0.6 : strcmp(name, "neutral") == 0 ? 0.4 : 0.0;
        if (!(fabs(channels->expression[i] - wanted) < 0.02))
            fail_msg("%s: %.3f", name, channels->expression[i]);
    }
    face_weights_destroy(weights);
    face_destroy(f);
}

/* Hands that hold the face still let it smile; what they pull adds to it. */
static void pulls_add_to_what_is_asked_for(void **state)
{
    static shaped s;
    error err = {""};
    double way[SCENE_CONTACTS][3], end[SCENE_CONTACTS][3];
    uint8_t rides[SCENE_CONTACTS];
    (void)state;
    make(&s);
    must(scene_hold(&s.scene, &settings, end, &err), &err);
    memset(rides, 1, sizeof rides);
    memset(way, 0, sizeof way);
    ask_for(&s, "smile", 0.6f);
    memcpy(end, way, sizeof end);
    face_ride(s.scene.face, end[0], rides, NULL);
    must(face_pull(s.scene.face, end[0], NULL, &err), &err);
    assert_true(fabs(weight_of(&s, "smile") - 0.6) < 1e-6);
    assert_true(greatest_off(&s, SMILE, 0.6) < 1e-3);
    ask(&s, way, SMILE, 0.3);
    memcpy(end, way, sizeof end);
    face_ride(s.scene.face, end[0], rides, NULL);
    must(face_pull(s.scene.face, end[0], NULL, &err), &err);
    assert_true(weight_of(&s, "smile") > 0.8);
    assert_true(greatest_off(&s, SMILE, 0.9) < 0.4);
    assert_true(greatest_miss(&s, end) < 1e-4);
    /* taking hold anew, and letting go, moves nothing and leaves nothing behind */
    double before = greatest_off(&s, SMILE, 0.9);
    must(scene_hold(&s.scene, &settings, end, &err), &err);
    face_show(s.scene.face);
    assert_true(fabs(greatest_off(&s, SMILE, 0.9) - before) < 1e-3);
    face_set_least_weights(s.scene.face, NULL);
    memset(end, 0, sizeof end);
    face_ride(s.scene.face, end[0], rides, NULL);
    must(face_pull(s.scene.face, end[0], NULL, &err), &err);
    assert_true(greatest_off(&s, SMILE, 0.3) < 0.4); /* what was pulled is in the base */
    face_destroy(s.scene.face);
}

/* Pulled slowly, and further than skin goes: it is held back without a jump. */
static void what_is_held_back_does_not_jump(void **state)
{
    static shaped s;
    error err = {""};
    double end[SCENE_CONTACTS][3], way[SCENE_CONTACTS][3], most = 0.0, held = 0.0;
    enum { DIRECTIONS = 12, STEPS = 150 };
    (void)state;
    make(&s);
    for (int n = 0; n < DIRECTIONS; ++n) {
        vec3 before[SCENE_VERTICES];
        face_reset(s.scene.face);
        must(scene_hold(&s.scene, &settings, end, &err), &err);
        for (int i = 0; i < STEPS; ++i) {
            memcpy(way, end, sizeof way);
            for (int which = 0; which < SHAPES; ++which)
                ask(&s, way, which, 0.01 * i * sin(1.7 * n + 2.3 * which));
            for (int k = 0; k < SCENE_CONTACTS; ++k)
                for (int axis = 0; axis < 3; ++axis)
                    way[k][axis] += 0.05 * i * sin(1.3 * n + 2.3 * k + 4.1 * axis);
            must(face_pull(s.scene.face, way[0], NULL, &err), &err);
            for (uint32_t v = 0; v < SCENE_VERTICES; ++v) {
                vec3 at = scene_shown(&s.scene, v);
                if (i > 0)
                    most = fmax(most, scene_distance(at, before[v]));
                before[v] = at;
            }
            held = fmax(held, face_metered(s.scene.face)->held_back_mm);
        }
    }
    assert_true(held > 5.0); /* else nothing was tried */
    assert_true(most < 1.0); /* ten times as far as a pull goes in a step */
    face_destroy(s.scene.face);
}

static void rigid_parts_stay_rigid(void **state)
{
    static shaped s;
    error err = {""};
    double end[SCENE_CONTACTS][3];
    (void)state;
    make(&s);
    must(scene_hold(&s.scene, &settings, end, &err), &err);
    ask(&s, end, JAW_OPEN, 0.6);
    ask(&s, end, SMILE, 0.6);
    must(face_pull(s.scene.face, end[0], NULL, &err), &err);
    for (uint32_t v = SCENE_UPPER_TEETH; v + 1 < SCENE_EYE + 6; ++v) {
        bool same_part = v + 1 != SCENE_LOWER_TEETH && v + 1 != SCENE_EYE;
        double was = scene_distance(scene_rest(&s.scene, v), scene_rest(&s.scene, v + 1));
        double is = scene_distance(scene_shown(&s.scene, v), scene_shown(&s.scene, v + 1));
        assert_true(!same_part || fabs(is - was) < 1e-3);
    }
    face_destroy(s.scene.face);
}

static void correctives_come_only_with_what_they_correct(void **state)
{
    static shaped s;
    error err = {""};
    double end[SCENE_CONTACTS][3];
    (void)state;
    make(&s);
    must(scene_hold(&s.scene, &settings, end, &err), &err);
    ask(&s, end, MOUTH_CLOSE, 0.8);
    must(face_pull(s.scene.face, end[0], NULL, &err), &err);
    assert_true(weight_of(&s, "mouthClose") <= weight_of(&s, "jawOpen") + 1e-12);
    face_destroy(s.scene.face);

    /* whatever they are called: as others spell it, or by the file's table of expressions */
    static char *const otherwise[SHAPES] = {"Jaw_Open", "Shape12", "a", "b", "c", "d", "e"};
    static mesh_expression row[] = {{"mouthClose", MOUTH_CLOSE, 1.0f}};
    make_called(&s, otherwise, row, 1);
    must(scene_hold(&s.scene, &settings, end, &err), &err);
    ask(&s, end, MOUTH_CLOSE, 0.8);
    must(face_pull(s.scene.face, end[0], NULL, &err), &err);
    assert_true(weight_of(&s, "Shape12") <= weight_of(&s, "Jaw_Open") + 1e-12);
    face_destroy(s.scene.face);
}

static void a_look_turns_with_its_eye_alone(void **state)
{
    static shaped s;
    error err = {""};
    double end[SCENE_CONTACTS][3];
    float dof[MRT_MAX_DOFS];
    (void)state;
    make(&s);
    for (int d = 0; d < MRT_MAX_DOFS; ++d)
        dof[d] = NAN;
    must(scene_hold(&s.scene, &settings, end, &err), &err);
    ask(&s, end, LOOK_LEFT, 1.0);
    must(face_pull(s.scene.face, end[0], dof, &err), &err);
    assert_true(weight_of(&s, "eyeLookOutLeft") < 1e-9);
    dof[scene_dof(&s.scene, "eye.yaw")] = (float)(0.5 * look_rad);
    must(face_pull(s.scene.face, end[0], dof, &err), &err);
    assert_true(fabs(weight_of(&s, "eyeLookOutLeft") - 0.5) < 0.02);
    face_destroy(s.scene.face);
}

/* Clay, bit for bit. */
static void at_nought_the_face_is_one_without_shapes(void **state)
{
    static shaped s;
    static face_scene plain;
    error err = {""};
    double end[SCENE_CONTACTS][3];
    (void)state;
    make(&s);
    scene_init(&plain);
    must(scene_finish(&plain, &err), &err);
    face_set_shapes(s.scene.face, 0.0);
    for (int n = 0; n < 20; ++n) {
        if (n % 10 == 0) {
            must(scene_hold(&plain, &settings, end, &err), &err);
            must(scene_hold(&s.scene, &settings, end, &err), &err);
        }
        end[CORNER][1] += 0.3;
        end[CORNER][2] += n > 14 ? 25.0 : 0.0; /* held back alike: it would tear */
        end[CHIN][1] -= 0.5;
        must(face_pull(plain.face, end[0], NULL, &err), &err);
        must(face_pull(s.scene.face, end[0], NULL, &err), &err);
        assert_true(scene_same_bits(face_shown(plain.face), face_shown(s.scene.face)));
    }
    assert_true(face_measure_surface(plain.face).held_back_mm > 1.0);
    face_destroy(plain.face);
    face_destroy(s.scene.face);
}

static float moved(float base, float by)
{
    return by == 0.0f ? base : base + by;
}

/* What exports write: base and columns by their weights, whatever was summed before for the limit.
 */
static void columns_are_the_frame(void **state)
{
    static shaped s;
    error err = {""};
    double end[SCENE_CONTACTS][3];
    char name[FACE_COLUMN_NAME];
    bool named = false;
    (void)state;
    make(&s);
    must(scene_hold(&s.scene, &settings, end, &err), &err);
    ask(&s, end, SMILE, 0.5);
    ask(&s, end, JAW_OPEN, 0.5);
    end[CHEEK][2] += 12.0;
    must(face_pull(s.scene.face, end[0], NULL, &err), &err);
    const face_columns c = face_columns_now(s.scene.face);
    const points *shown = face_shown(s.scene.face);
    assert_true(c.is_exact);
    for (uint32_t v = 0; v < shown->count; ++v) {
        float at[3] = {0.0f, 0.0f, 0.0f};
        for (uint32_t k = 0; k < c.count; ++k)
            for (int axis = 0; axis < 3; ++axis)
                at[axis] += c.column[k * c.stride + v] * (float)c.weight[3 * k + (uint32_t)axis];
        assert_true(moved(c.base->x[v], at[0]) == shown->x[v]);
        assert_true(moved(c.base->y[v], at[1]) == shown->y[v]);
        assert_true(moved(c.base->z[v], at[2]) == shown->z[v]);
    }
    for (uint32_t k = 0; k < c.count; ++k) {
        face_column_name(s.scene.face, k, name);
        named |= strcmp(name, "smile.x") == 0;
        assert_true(name[0] != '\0');
    }
    assert_true(named);
    face_destroy(s.scene.face);
}

/* A performance of all that a face does; `end` as it was held last. */
static void step_on(shaped *s, double end[SCENE_CONTACTS][3], int n)
{
    error err = {""};
    double way[SCENE_CONTACTS][3], to[3];
    float dof[MRT_MAX_DOFS];
    shape_step step;
    for (int d = 0; d < MRT_MAX_DOFS; ++d)
        dof[d] = NAN;
    if (n % 20 > 10)
        dof[scene_dof(&s->scene, "jaw.open")] = (float)(0.03 * (n % 10));
    if (n % 20 == 0)
        must(scene_hold(&s->scene, &settings, end, &err), &err);
    if (n % 20 > 4 && n % 4 == 1)
        ask_for(s, "browUp", 0.04f * (float)(n % 20));
    memcpy(way, end, sizeof way);
    ask(s, way, SMILE, 0.05 * (n % 20));
    ask(s, way, JAW_OPEN, 0.03 * (n % 20));
    way[BROW][1] += 0.2 * (n % 7);
    if (n % 20 < 15)
        must(face_pull(s->scene.face, way[0], dof, &err), &err);
    if (n % 20 == 15) {
        face_commit(s->scene.face);
        face_show(s->scene.face);
    }
    if (n % 20 < 16)
        return;
    vec3 tip = scene_shown(&s->scene, scene_at(5, 5));
    const double from[3] = {tip.x, tip.y, tip.z};
    to[0] = tip.x + 0.2;
    to[1] = tip.y;
    to[2] = tip.z + 0.3;
    must(face_drag(s->scene.face, &settings, from, to, 1, dof, NULL, &step, &err), &err);
}

static void a_face_that_is_taken_up_goes_on_with_the_same_bits(void **state)
{
    (void)state;
    for (int from = 0; from < 40; from += 3) {
        static shaped told, again;
        double end[SCENE_CONTACTS][3] = {{0}}, same[SCENE_CONTACTS][3];
        error err = {""};
        make(&told);
        make(&again);
        for (int n = 0; n <= from; ++n)
            step_on(&told, end, n);
        size_t size = face_save(told.scene.face, NULL, 0);
        void *bytes = malloc(size);
        assert_int_equal(face_save(told.scene.face, bytes, size), size);
        must(face_load(again.scene.face, bytes, size, &err), &err);
        assert_true(scene_same_bits(face_shown(told.scene.face), face_shown(again.scene.face)));
        memcpy(same, end, sizeof same);
        for (int n = from + 1; n < 45; ++n) {
            step_on(&told, end, n);
            step_on(&again, same, n);
            if (!scene_same_bits(face_shown(told.scene.face), face_shown(again.scene.face)))
                fail_msg("taken up after step %d: step %d differs", from, n);
        }
        free(bytes);
        face_destroy(told.scene.face);
        face_destroy(again.scene.face);
    }
}

/* Committed, held anew, dragged: nothing jumps. */
static void nothing_jumps_when_it_takes_hold_anew(void **state)
{
    static shaped s;
    error err = {""};
    double end[SCENE_CONTACTS][3];
    (void)state;
    make(&s);
    must(scene_hold(&s.scene, &settings, end, &err), &err);
    ask(&s, end, SMILE, 0.8);
    ask(&s, end, JAW_OPEN, 0.5);
    must(face_pull(s.scene.face, end[0], NULL, &err), &err);
    static float before[3][SCENE_VERTICES + 64];
    const points *shown = face_shown(s.scene.face);
    memcpy(before[0], shown->x, shown->count * sizeof(float));
    memcpy(before[1], shown->y, shown->count * sizeof(float));
    memcpy(before[2], shown->z, shown->count * sizeof(float));
    face_commit(s.scene.face);
    face_show(s.scene.face);
    for (uint32_t v = 0; v < shown->count; ++v) {
        assert_true(fabsf(shown->x[v] - before[0][v]) < 1e-3f);
        assert_true(fabsf(shown->y[v] - before[1][v]) < 1e-3f);
        assert_true(fabsf(shown->z[v] - before[2][v]) < 1e-3f);
    }
    must(scene_hold(&s.scene, &settings, end, &err), &err);
    must(face_pull(s.scene.face, end[0], NULL, &err), &err);
    for (uint32_t v = 0; v < shown->count; ++v)
        assert_true(fabsf(shown->y[v] - before[1][v]) < 0.5f);
    face_destroy(s.scene.face);
}

static void frames_with_shapes_allocate_nothing(void **state)
{
    static shaped s;
    double end[SCENE_CONTACTS][3] = {{0}};
    (void)state;
    if (!ALLOCATIONS_ARE_COUNTED)
        skip();
    make(&s);
    allocation_count = 0;
    for (int n = 0; n < 40; ++n)
        step_on(&s, end, n);
    size_t counted = allocation_count;
    assert_int_equal(counted, 0);
    face_destroy(s.scene.face);
}

/* Three hundred, the same name twice among them. */
static void three_hundred_shapes_work(void **state)
{
    static shaped s;
    static mesh_target many[300];
    error err = {""};
    double end[SCENE_CONTACTS][3];
    binding b;
    (void)state;
    scene_init(&s.scene);
    sculpt(&s, shape_names);
    for (int i = 0; i < 300; ++i)
        many[i] = s.target[i % (SHAPES - 1)];
    s.scene.mesh.target = many;
    s.scene.mesh.target_count = 300;
    scene_bind(&s.scene, &b);
    must(face_create_shaped(&s.scene.face, &s.scene.rig, &s.scene.mesh, &b, MRT_MAX_VECTORS, &err),
         &err);
    assert_int_equal(face_shape_count(s.scene.face), 300);
    must(scene_hold(&s.scene, &settings, end, &err), &err);
    ask(&s, end, SMILE, 0.7);
    must(face_pull(s.scene.face, end[0], NULL, &err), &err);
    assert_true(greatest_off(&s, SMILE, 0.7) < 0.4);
    assert_true(greatest_miss(&s, end) < 1e-4);
    face_destroy(s.scene.face);
}

/* 500 small ones and 300 of a million vertices: the first 320, and none. */
static void too_many_shapes_are_left_out(void **state)
{
    (void)state;
    mesh few = {.vertex_count = 1000, .target_count = 200};
    mesh many = {.vertex_count = 1000, .target_count = 500};
    mesh large = {.vertex_count = 1000000, .target_count = 300};
    assert_int_equal(face_shapes_of(&few), 200);
    assert_int_equal(face_shapes_of(&many), FACE_SHAPES_MAX);
    assert_int_equal(face_shapes_of(&large), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shapes_that_move_nothing_are_none),
        cmocka_unit_test(a_pull_that_a_shape_explains_becomes_that_shape),
        cmocka_unit_test(contacts_land_whatever_is_pulled),
        cmocka_unit_test(bones_and_shapes_do_the_work_once),
        cmocka_unit_test(a_lid_that_a_look_moves_is_not_moved_twice),
        cmocka_unit_test(a_shape_that_is_asked_for_is_that_shape),
        cmocka_unit_test(words_of_the_file_are_sums_of_its_shapes),
        cmocka_unit_test(pulls_add_to_what_is_asked_for),
        cmocka_unit_test(what_is_held_back_does_not_jump),
        cmocka_unit_test(rigid_parts_stay_rigid),
        cmocka_unit_test(correctives_come_only_with_what_they_correct),
        cmocka_unit_test(a_look_turns_with_its_eye_alone),
        cmocka_unit_test(at_nought_the_face_is_one_without_shapes),
        cmocka_unit_test(columns_are_the_frame),
        cmocka_unit_test(a_face_that_is_taken_up_goes_on_with_the_same_bits),
        cmocka_unit_test(nothing_jumps_when_it_takes_hold_anew),
        cmocka_unit_test(frames_with_shapes_allocate_nothing),
        cmocka_unit_test(three_hundred_shapes_work),
        cmocka_unit_test(too_many_shapes_are_left_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
