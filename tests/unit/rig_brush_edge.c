/* What a stroke of the brush does to the weights at its edge, and does not do beyond it. mm. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "unit/brush_scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void lay(binding *out, const rig *r)
{
    error err = {""};
    must(binding_create(out, r, &puppet.mesh, &puppet.topology, &err), &err);
}

/* No vertex that is touched rides on the bone less than before, however lightly it is touched. */
static void a_soft_stroke_takes_nothing_from_its_bone(const char *bone)
{
    binding before, after;
    const uint32_t of = rig_find_bone(puppet.rig, bone), count = puppet.mesh.vertex_count;
    uint32_t touched_count;
    double gained = 0.0;
    lay(&before, puppet.rig);
    filled = &before;
    rig soft = painted(puppet.rig, &wide, rides_on(bone), contact("cheek.lower.l"));
    filled = NULL;
    lay(&after, &soft);
    const uint32_t *touched = brush_touched(tool, &touched_count);
    for (uint32_t i = 0; i < touched_count; ++i) {
        const size_t at = (size_t)of * count + touched[i];
        const double had = (double)before.weight[at], has = (double)after.weight[at];
        gained += has - had;
        if (has < had - 0.01)
            fail_msg("vertex %u: %s had %.3f, has %.3f", touched[i], bone, had, has);
    }
    assert_true(gained > 1.0);
    binding_destroy(&before);
    binding_destroy(&after);
    rig_destroy(&soft);
}

static void soft_edges_pass_over_into_what_is_there(void **state)
{
    (void)state;
    a_soft_stroke_takes_nothing_from_its_bone("jaw");
    a_soft_stroke_takes_nothing_from_its_bone("skull");
}

static void a_soft_stroke_of_mobility_stills_nothing(void **state)
{
    (void)state;
    binding before, after;
    const rig_stroke_ink free_ink = {.ink = RIG_INK_FREE, .strength = 1.0};
    lay(&before, puppet.rig);
    filled = &before;
    rig soft = painted(puppet.rig, &wide, free_ink, contact("nose.tip"));
    filled = NULL;
    lay(&after, &soft);
    for (uint32_t v = 0; v < puppet.mesh.vertex_count; ++v)
        if (after.mobility[v] < before.mobility[v] - 0.02f)
            fail_msg("vertex %u: %.3f becomes %.3f", v, (double)before.mobility[v],
                     (double)after.mobility[v]);
    binding_destroy(&before);
    binding_destroy(&after);
    rig_destroy(&soft);
}

/* ---- what a stroke does to what it does not touch ---- */

/* is_near: vertex_count; the vertices of one more ring of edges. */
static void widen(uint8_t *is_near)
{
    const topology *t = &puppet.topology;
    uint8_t *from = malloc(t->vertex_count);
    assert_non_null(from);
    memcpy(from, is_near, t->vertex_count);
    for (uint32_t v = 0; v < t->vertex_count; ++v)
        for (size_t e = t->neighbour_start[v]; from[v] && e < t->neighbour_start[v + 1]; ++e)
            is_near[t->neighbour[e]] = 1;
    free(from);
}

static uint8_t *touched_mask(void)
{
    uint32_t touched_count;
    const uint32_t *touched = brush_touched(tool, &touched_count);
    uint8_t *out = calloc(puppet.mesh.vertex_count, 1);
    assert_non_null(out);
    for (uint32_t i = 0; i < touched_count; ++i)
        out[touched[i]] = 1;
    return out;
}

typedef struct changes {
    double least, most;
} changes;

/* Of the weights on a bone, over the vertices where `where` is `is`. */
static changes changes_of(const binding *before, const binding *after, uint32_t bone,
                          const uint8_t *where, uint8_t is)
{
    changes out = {0.0, 0.0};
    for (uint32_t v = 0; v < puppet.mesh.vertex_count; ++v) {
        const size_t at = (size_t)bone * puppet.mesh.vertex_count + v;
        const double by = (double)after->weight[at] - (double)before->weight[at];
        if (where[v] != is)
            continue;
        out.least = fmin(out.least, by);
        out.most = fmax(out.most, by);
    }
    return out;
}

/* What it does not touch changes less than what it touches, and to the same side; beyond `rings`
 * rings of edges by less than 0.01. */
static void a_stroke_ends_where_it_ends(const char *at, const char *bone, const brush_shape *shape,
                                        int rings)
{
    binding before, after;
    lay(&before, puppet.rig);
    filled = &before;
    rig changed = painted(puppet.rig, shape, rides_on(bone), contact(at));
    filled = NULL;
    lay(&after, &changed);
    uint8_t *is_near = touched_mask();
    for (uint32_t b = 0; b < before.bone_count; ++b) {
        const changes on = changes_of(&before, &after, b, is_near, 1),
                      off = changes_of(&before, &after, b, is_near, 0);
        if (off.most > on.most + 1e-5 || off.least < on.least - 1e-5)
            fail_msg("%s, %s, bone %u: %.4f..%.4f off the stroke, %.4f..%.4f on it", at, bone, b,
                     off.least, off.most, on.least, on.most);
    }
    for (int i = 0; i < rings; ++i)
        widen(is_near);
    for (uint32_t b = 0; b < before.bone_count; ++b) {
        const changes far = changes_of(&before, &after, b, is_near, 0);
        if (far.most > 0.01 || far.least < -0.01)
            fail_msg("%s, %s, bone %u: %.4f..%.4f beyond %d rings", at, bone, b, far.least,
                     far.most, rings);
    }
    free(is_near);
    binding_destroy(&before);
    binding_destroy(&after);
    rig_destroy(&changed);
}

static void strokes_end_where_they_end(void **state)
{
    (void)state;
    static const char *const places[] = {"cheek.lower.l", "cheek.l", "mouth.corner.l", "chin",
                                         "nose.tip"};
    const brush_shape small = {.radius_mm = 8.0, .sides = BRUSH_ONE_SIDE},
                      hard = {.radius_mm = 14.0, .falloff = BRUSH_HARD, .sides = BRUSH_ONE_SIDE};
    for (size_t i = 0; i < sizeof places / sizeof *places; ++i)
        for (size_t b = 0; b < 2; ++b) {
            const char *bone = b == 0 ? "jaw" : "skull";
            if (b != i % 2 && !getenv("MAROTTE_TEST_LONG"))
                continue; /* each place with one of them */
            a_stroke_ends_where_it_ends(places[i], bone, &wide, 1);
            a_stroke_ends_where_it_ends(places[i], bone, &small, 2);
            a_stroke_ends_where_it_ends(places[i], bone, &hard, 5);
        }
}

static void what_is_still_leaves_the_rest_free(void **state)
{
    (void)state;
    binding before, after;
    lay(&before, puppet.rig);
    const rig_stroke_ink still = {.ink = RIG_INK_STILL, .strength = 1.0};
    rig changed = painted(puppet.rig, &wide, still, contact("cheek.l"));
    lay(&after, &changed);
    uint8_t *is_near = touched_mask();
    double stilled = 0.0;
    for (uint32_t v = 0; v < puppet.mesh.vertex_count; ++v) {
        const double by = (double)after.mobility[v] - (double)before.mobility[v];
        stilled = fmin(stilled, by);
        if (by > 1e-5 || (!is_near[v] && by < -0.02))
            fail_msg("vertex %u: %.4f", v, by);
    }
    assert_true(stilled < -0.5);
    free(is_near);
    binding_destroy(&before);
    binding_destroy(&after);
    rig_destroy(&changed);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(soft_edges_pass_over_into_what_is_there),
        cmocka_unit_test(a_soft_stroke_of_mobility_stills_nothing),
        cmocka_unit_test(strokes_end_where_they_end),
        cmocka_unit_test(what_is_still_leaves_the_rest_free),
    };
    return cmocka_run_group_tests(tests, open_puppet, close_puppet);
}
