/* The state of a face as bytes: what it does afterwards has the same bits, and bytes that are none
 * of its own are refused. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "unit/face_scene.h"

enum { STEPS = 48 };
static const csrbf_settings settings = {.radius = 30.0};

static void must(mrt_result result, const error *err)
{
    if (result < 0)
        fail_msg("%s", err->text);
}

static void make(face_scene *s)
{
    error err = {""};
    scene_init(s);
    must(scene_finish(s, &err), &err);
}

static void finish(face_scene *s)
{
    face_destroy(s->face);
}

static double wave(int n, int period)
{
    int at = n % period, half = period / 2;
    return (double)(at < half ? at : period - at) / half;
}

/* Step n of a performance: anchored, committed, dragged, leaking, anchored anew, with bones that
 * are driven and a jaw that is derived. `end`: of the controls, as scene_hold left it. */
typedef struct telling {
    double end[SCENE_CONTACTS][3];
    double tip[3];
} telling;

static void pull(face_scene *s, telling *t, int n)
{
    error err = {""};
    float dof[MRT_MAX_DOFS];
    double end[SCENE_CONTACTS][3];
    memcpy(end, t->end, sizeof end);
    for (int i = 0; i < SCENE_CONTACTS; ++i) {
        end[i][1] -= (i == LOWER_LIP || i == CHIN ? 6.0 : 1.0) * wave(n + i, 14);
        end[i][2] += 2.0 * wave(n, 10);
    }
    for (int i = 0; i < MRT_MAX_DOFS; ++i)
        dof[i] = NAN;
    dof[scene_dof(s, "eye.yaw")] = (float)(0.4 * wave(n, 8));
    if (n % 24 > 12)
        dof[scene_dof(s, "jaw.open")] = (float)(0.3 * wave(n, 12));
    must(face_pull(s->face, end[0], dof, &err), &err);
}

static void knead(face_scene *s, telling *t, int n)
{
    error err = {""};
    shape_step step;
    float dof[MRT_MAX_DOFS] = {0};
    double to[3] = {t->tip[0] + 0.3, t->tip[1] + 0.2, t->tip[2] + 0.5};
    dof[scene_dof(s, "jaw.open")] = (float)(0.1 * wave(n, 6));
    must(face_drag(s->face, &settings, t->tip, to, 1, dof, t->tip, &step, &err), &err);
}

static void step_on(face_scene *s, telling *t, int n)
{
    error err = {""};
    int at = n % 24;
    if (n % 24 == 0)
        must(scene_hold(s, &settings, t->end, &err), &err);
    if (at < 14)
        pull(s, t, n);
    if (at == 14) {
        face_commit(s->face);
        face_show(s->face);
        vec3 tip = scene_shown(s, scene_at(5, 5));
        t->tip[0] = tip.x;
        t->tip[1] = tip.y;
        t->tip[2] = tip.z;
    }
    if (at >= 15)
        knead(s, t, n);
    if (at > 20)
        face_leak(s->face, 2.0, 0.05);
}

static bool is_same(const face *a, const face *b)
{
    const points *p = face_shown(a), *q = face_shown(b);
    size_t size = p->count * sizeof(float);
    return memcmp(p->x, q->x, size) == 0 && memcmp(p->y, q->y, size) == 0 &&
           memcmp(p->z, q->z, size) == 0;
}

static unsigned char *keep(const face *f, size_t *out_size)
{
    size_t size = face_save(f, NULL, 0);
    unsigned char *bytes = malloc(size);
    assert_non_null(bytes);
    assert_int_equal(face_save(f, bytes, size), size);
    *out_size = size;
    return bytes;
}

static void a_face_that_is_taken_up_goes_on_with_the_same_bits(void **state)
{
    (void)state;
    for (int from = 0; from < STEPS; ++from) {
        face_scene told, again;
        telling t = {{{0}}, {0}};
        error err = {""};
        make(&told);
        make(&again);
        for (int n = 0; n <= from; ++n)
            step_on(&told, &t, n);
        size_t size;
        unsigned char *bytes = keep(told.face, &size);
        must(face_load(again.face, bytes, size, &err), &err);
        assert_true(is_same(told.face, again.face));
        telling u = t;
        for (int n = from + 1; n < STEPS; ++n) {
            step_on(&told, &t, n);
            step_on(&again, &u, n);
            if (!is_same(told.face, again.face))
                fail_msg("taken up after step %d: step %d differs", from, n);
        }
        size_t later, then;
        unsigned char *a = keep(told.face, &later), *b = keep(again.face, &then);
        assert_int_equal(later, then);
        assert_memory_equal(a, b, later);
        free(a);
        free(b);
        free(bytes);
        finish(&told);
        finish(&again);
    }
}

static void a_face_is_kept_in_few_bytes(void **state)
{
    (void)state;
    face_scene s;
    telling t = {{{0}}, {0}};
    make(&s);
    assert_true(face_save(s.face, NULL, 0) < 500);
    for (int n = 0; n < 10; ++n)
        step_on(&s, &t, n);
    assert_true(face_save(s.face, NULL, 0) < 4000); /* engaged on the rest shape */
    for (int n = 10; n < 20; ++n)
        step_on(&s, &t, n);
    size_t padded = face_rest(s.face)->padded_count;
    assert_true(face_save(s.face, NULL, 0) < 2 * 12 * padded + 500); /* base and what is kneaded */
    finish(&s);
}

static void nothing_is_written_beyond_the_capacity(void **state)
{
    (void)state;
    face_scene s;
    telling t = {{{0}}, {0}};
    make(&s);
    for (int n = 0; n < 10; ++n)
        step_on(&s, &t, n);
    size_t size = face_save(s.face, NULL, 0);
    unsigned char *bytes = malloc(size + 1);
    for (size_t capacity = 0; capacity < size; capacity += 37) {
        memset(bytes, 0x5a, size + 1);
        assert_int_equal(face_save(s.face, bytes, capacity), size);
        for (size_t i = capacity; i <= size; ++i)
            assert_int_equal(bytes[i], 0x5a);
    }
    free(bytes);
    finish(&s);
}

static void expect_rest(const face_scene *s)
{
    for (uint32_t v = 0; v < SCENE_VERTICES; ++v)
        assert_true(scene_distance(scene_shown(s, v), scene_rest(s, v)) <= 0.0);
}

static void damaged_bytes_are_refused_or_give_a_face(void **state)
{
    (void)state;
    static const int kept_after[] = {9, 14, 18};
    for (int k = 0; k < 3; ++k) {
        face_scene s;
        telling t = {{{0}}, {0}};
        error err = {""};
        make(&s);
        for (int n = 0; n <= kept_after[k]; ++n)
            step_on(&s, &t, n);
        size_t size;
        unsigned char *bytes = keep(s.face, &size);
        for (size_t at = 0; at < size; at += at < 3000 ? 1 : 977)
            for (int bit = 0; bit < 8; bit += 3 + (int)(at % 4)) {
                bytes[at] ^= (unsigned char)(1u << bit);
                if (face_load(s.face, bytes, size, &err) < 0)
                    expect_rest(&s);
                telling u = t;
                if (face_control_count(s.face) == SCENE_CONTACTS)
                    pull(&s, &u, 10);
                assert_true(points_are_usable(face_shown(s.face)));
                bytes[at] ^= (unsigned char)(1u << bit);
            }
        for (size_t cut = 0; cut < size; cut += 1 + cut / 30) {
            unsigned char *exact = malloc(cut + 1);
            memcpy(exact, bytes, cut);
            assert_int_equal(face_load(s.face, exact, cut, &err), MRT_ERR_FORMAT);
            expect_rest(&s);
            free(exact);
        }
        must(face_load(s.face, bytes, size, &err), &err);
        free(bytes);
        finish(&s);
    }
}

static void bytes_of_another_face_are_refused(void **state)
{
    (void)state;
    face_scene s, other;
    error err = {""};
    make(&s);
    scene_init(&other);
    other.rig.contact_count -= 1;
    must(scene_finish(&other, &err), &err);
    size_t size;
    unsigned char *bytes = keep(s.face, &size);
    assert_int_equal(face_load(other.face, bytes, size, &err), MRT_ERR_FORMAT);
    assert_non_null(strstr(err.text, "belongs to another face"));
    free(bytes);
    finish(&s);
    finish(&other);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_face_that_is_taken_up_goes_on_with_the_same_bits),
        cmocka_unit_test(a_face_is_kept_in_few_bytes),
        cmocka_unit_test(nothing_is_written_beyond_the_capacity),
        cmocka_unit_test(damaged_bytes_are_refused_or_give_a_face),
        cmocka_unit_test(bytes_of_another_face_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
