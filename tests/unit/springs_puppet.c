/* The puppet's tuft and ears while its head turns and nods as fast as a hand can: how long a step
 * takes, and what the surface does where the parts hang on the head. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "base/clock.h"
#include "unit/composer_scene.h"

#include <stdlib.h>

static uint32_t dof_named(const composer *of, const char *name)
{
    const mrt_face *about = composer_about(of);
    for (uint32_t i = 0; i < about->dof_count; ++i)
        if (strcmp(about->dofs[i].name, name) == 0)
            return i;
    fail_msg("the puppet has no %s", name);
    return 0;
}

static double ramp(double time_s, double from_s, double to_s)
{
    const double part = fmin(fmax((time_s - from_s) / (to_s - from_s), 0.0), 1.0);
    return part * part * (3.0 - 2.0 * part);
}

static vec3 shown_at(const face *f, uint32_t vertex)
{
    return points_position(face_shown(f), face_order(f)->slot_of_file[vertex]);
}

static vec3 rest_at(const mesh *m, uint32_t vertex)
{
    const float *at = m->position + (size_t)3 * vertex;
    return (vec3){(double)at[0], (double)at[1], (double)at[2]};
}

static bool is_loose(const binding *b, const bones *all, uint32_t vertex)
{
    for (uint32_t bone = 0; bone < b->bone_count; ++bone)
        if (all->rig->bone[bone].spring.frequency_hz > 0.0 &&
            b->weight[(size_t)bone * b->vertex_count + vertex] > 0.0f)
            return true;
    return false;
}

typedef struct surface {
    double stretch, squeeze; /* greatest and least length of an edge over that at rest */
    double area;             /* least area of a triangle over that at rest */
    uint32_t triangle_count;
} surface;

static void measure(surface *out, const face *f, const mesh *m)
{
    out->triangle_count = 0;
    for (uint32_t t = 0; t < m->triangle_count; ++t) {
        const uint32_t *corner = m->triangle + (size_t)3 * t;
        vec3 now[3], rest[3];
        if (!is_loose(face_binding(f), face_bones(f), corner[0]) &&
            !is_loose(face_binding(f), face_bones(f), corner[1]) &&
            !is_loose(face_binding(f), face_bones(f), corner[2]))
            continue;
        out->triangle_count += 1;
        for (int i = 0; i < 3; ++i) {
            now[i] = shown_at(f, corner[i]);
            rest[i] = rest_at(m, corner[i]);
        }
        for (int i = 0; i < 3; ++i) {
            const double part = vec3_length(vec3_sub(now[i], now[(i + 1) % 3])) /
                                vec3_length(vec3_sub(rest[i], rest[(i + 1) % 3]));
            out->stretch = fmax(out->stretch, part);
            out->squeeze = fmin(out->squeeze, part);
        }
        const vec3 a = vec3_cross(vec3_sub(now[1], now[0]), vec3_sub(now[2], now[0]));
        const vec3 b = vec3_cross(vec3_sub(rest[1], rest[0]), vec3_sub(rest[2], rest[0]));
        out->area = fmin(out->area, vec3_length(a) / vec3_length(b));
    }
}

static void its_tuft_and_ears_swing_and_stay_whole(void **state)
{
    (void)state;
    face_file file;
    composer *c;
    error err = {""};
    mrt_pull pull = {.mode = MRT_ANCHORED};
    scene_face(&file, "puppet");
    const csrbf_settings solver = {0};
    scene_must(composer_create(&c, &file, &solver, &err), &err);
    const uint32_t turn = dof_named(c, "skull.turn"), nod = dof_named(c, "skull.nod"),
                   hair = dof_named(c, "hair.nod"), ear = dof_named(c, "ear.l.flap");
    const composer_part part = {.weight = 1.0, .gain = 1.0, .is_fresh = true, .pull = &pull};
    surface s = {1.0, 1.0, 1.0, 0};
    double hair_deg = 0.0, ear_deg = 0.0;
    int64_t least_ns = INT64_MAX;
    for (int i = 0; i < MRT_MAX_DOFS; ++i)
        pull.dof[i] = NAN;
    for (int n = 0; n < 300; ++n) {
        const double t = n / 60.0;
        pull.dof[turn] =
            (float)(0.6 * ramp(t, 0.2, 0.4) - 1.2 * ramp(t, 1.0, 1.3) + 0.6 * ramp(t, 2.0, 2.2));
        pull.dof[nod] = (float)(0.35 * ramp(t, 2.8, 2.95) - 0.35 * ramp(t, 3.1, 3.25));
        composer_move(c, &part, 1, 1.0 / 60.0);
        const int64_t before_ns = clock_now_ns();
        composer_swing(c, (int64_t)(t * 1e9));
        const int64_t took_ns = clock_now_ns() - before_ns;
        least_ns = n > 15 && n < 40 && took_ns < least_ns ? took_ns : least_ns;
        composer_draw(c);
        const float *dof = face_metered(composer_face(c))->dof;
        hair_deg = fmax(hair_deg, 57.29578 * fabs((double)dof[hair]));
        ear_deg = fmax(ear_deg, 57.29578 * fabs((double)dof[ear]));
        if (n % 3 == 0)
            measure(&s, composer_face(c), &file.mesh);
    }
    print_message("  a step of the springs takes %.4f ms; tuft %.1f, ear %.1f degrees; of %u "
                  "triangles edges %.2f to %.2f of their length, areas from %.2f\n",
                  1e-6 * (double)least_ns, hair_deg, ear_deg, s.triangle_count, s.squeeze,
                  s.stretch, s.area);
    assert_true(hair_deg > 5.0 && ear_deg > 5.0);
    assert_true(s.triangle_count > 500);
    assert_true(s.stretch < 1.6 && s.squeeze > 0.5 && s.area > 0.5);
    assert_true(least_ns < 50000); /* 0.05 ms */
    composer_destroy(c);
    face_file_destroy(&file);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(its_tuft_and_ears_swing_and_stay_whole),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
