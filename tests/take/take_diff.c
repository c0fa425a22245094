/* How far apart two motions are, by regions. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "stage/playback/diff.h"

#include <math.h>
#include <string.h>

/* Two vertices beside the mouth, one beside a brow, one far away, one at a contact of no region. */
static const float rest[5 * 3] = {0, 0, 0, 2, 0, 0, 0, 50, 0, 0, 0, 400, 90, 0, 0};
static const mrt_contact contacts[3] = {{"mouth.corner.l", "skull", {1, 0, 0}, {0, 0, 1}},
                                        {"brow.inner.l", "skull", {0, 51, 0}, {0, 0, 1}},
                                        {"collar.l", "skull", {90, 1, 0}, {0, 0, 1}}};
static const mrt_face about = {.contacts = contacts, .contact_count = 3};

static void assert_near(double found, double expected, double tolerance)
{
    if (!(fabs(found - expected) <= tolerance))
        fail_msg("%.17g is not within %g of %.17g", found, tolerance, expected);
}

static diff *make(void)
{
    diff *out;
    error err = {""};
    assert_int_equal(diff_create(&out, rest, 5, &about, 30.0, &err), MRT_OK);
    return out;
}

static void vertices_belong_to_the_nearest_contact_within_the_radius(void **state)
{
    (void)state;
    diff *d = make();
    assert_int_equal(diff_vertex_count(d, OWN_MOUTH), 2);
    assert_int_equal(diff_vertex_count(d, OWN_BROWS), 1);
    assert_int_equal(diff_vertex_count(d, OWN_JAW), 0);
    assert_int_equal(diff_vertex_count(d, DIFF_ELSEWHERE), 2);
    assert_int_equal(diff_vertex_count(d, DIFF_FACE), 5);
    diff_destroy(d);
}

static void a_frame_tells_the_greatest_and_the_rms_of_each_region(void **state)
{
    (void)state;
    diff *d = make();
    float moved[15];
    diff_frame frame;
    memcpy(moved, rest, sizeof moved);
    moved[0] += 3.0f; /* mouth: 5 mm */
    moved[1] += 4.0f;
    moved[11] -= 1.0f; /* elsewhere: 1 mm */
    diff_measure(d, rest, moved, &frame);
    assert_near(frame.max_mm[OWN_MOUTH], 5.0, 1e-12);
    assert_near(frame.rms_mm[OWN_MOUTH], 3.5355339059327378, 1e-12); /* sqrt(25 / 2) */
    assert_near(frame.max_mm[OWN_BROWS], 0.0, 0.0);
    assert_near(frame.max_mm[DIFF_ELSEWHERE], 1.0, 1e-12);
    assert_near(frame.max_mm[DIFF_FACE], 5.0, 1e-12);
    assert_near(frame.rms_mm[DIFF_FACE], 2.2803508501982760, 1e-12); /* sqrt(26 / 5) */
    diff_measure(d, rest, rest, &frame);
    assert_near(frame.max_mm[DIFF_FACE], 0.0, 0.0);
    diff_destroy(d);
}

static void a_sum_is_over_all_frames_and_knows_the_worst(void **state)
{
    (void)state;
    diff_frame frame[3] = {{{0}, {0}}, {{0}, {0}}, {{0}, {0}}};
    diff_total sum;
    frame[1].max_mm[DIFF_FACE] = 7.0;
    frame[1].rms_mm[DIFF_FACE] = 3.0;
    frame[2].max_mm[DIFF_FACE] = 2.0;
    diff_sum(DIFF_FACE, frame, 3, &sum);
    assert_near(sum.max_mm, 7.0, 0.0);
    assert_near(sum.rms_mm, 1.7320508075688772, 1e-12); /* sqrt(9 / 3) */
    assert_int_equal(sum.worst, 1);
    diff_sum(DIFF_FACE, frame, 0, &sum);
    assert_near(sum.rms_mm, 0.0, 0.0);
}

static void the_worst_moments_are_apart(void **state)
{
    (void)state;
    static const double max_mm[6] = {1, 9, 8, 0, 0, 3};
    diff_frame frame[6];
    uint32_t worst[5];
    memset(frame, 0, sizeof frame);
    for (int i = 0; i < 6; ++i)
        frame[i].max_mm[DIFF_FACE] = max_mm[i];
    assert_int_equal(diff_worst(frame, 6, 2, worst, 5), 2);
    assert_int_equal(worst[0], 1);
    assert_int_equal(worst[1], 5);
    assert_int_equal(diff_worst(frame, 6, 1, worst, 5), 4);
    assert_int_equal(worst[1], 2);
    assert_int_equal(diff_worst(frame, 0, 2, worst, 5), 0);
}

static void a_mesh_alone_is_all_elsewhere(void **state)
{
    (void)state;
    diff *d;
    error err = {""};
    const mrt_face bare = {.contact_count = 0};
    assert_int_equal(diff_create(&d, rest, 5, &bare, 30.0, &err), MRT_OK);
    assert_int_equal(diff_vertex_count(d, DIFF_ELSEWHERE), 5);
    diff_destroy(d);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(vertices_belong_to_the_nearest_contact_within_the_radius),
        cmocka_unit_test(a_frame_tells_the_greatest_and_the_rms_of_each_region),
        cmocka_unit_test(a_sum_is_over_all_frames_and_knows_the_worst),
        cmocka_unit_test(the_worst_moments_are_apart),
        cmocka_unit_test(a_mesh_alone_is_all_elsewhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
