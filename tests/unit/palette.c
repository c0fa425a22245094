/* The palette: how strengths become a pull over time, and that its state continues with the same
 * bits, or is refused. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/clock.h"
#include "stage/perform/palette.h"

#include <math.h>
#include <string.h>

static const mrt_contact contacts[] = {{"mouth.corner.l", "skull", {10, 0, 50}, {0, 0, 1}},
                                       {"mouth.corner.r", "skull", {-10, 0, 50}, {0, 0, 1}}};
static const mrt_dof dofs[] = {{"jaw.open", "rad", 0, 0.5f}, {"skull.nod", "rad", -0.5f, 0.5f}};
static const mrt_vec3 smile_pulls[] = {{4, 6, 0}, {-4, 6, 0}},
                      open_pulls[] = {{0, -2, 0}, {0, 0, 0}},
                      far_pulls[] = {{400, 0, 0}, {-400, 0, 0}};
static const float still[] = {0, 0}, open_dofs[] = {0.3f, 0};
static const mrt_rig_pose poses[] = {{"smile", smile_pulls, still, MRT_POSE_MOUTH},
                                     {"open", open_pulls, open_dofs, MRT_POSE_MOUTH},
                                     {"far", far_pulls, still, MRT_POSE_WHOLE}};
static const mapped_face mapped = {.about = {contacts, dofs, 2, 2, {-80, -120, -80}, {80, 120, 80}},
                                   .pose = poses,
                                   .pose_count = 3};
static const guard reach = {.contact_count = 2, .reach_mm = 300.0};

typedef struct fixture {
    palette palette;
    channel_route route;
    int64_t time_ns;
} fixture;

static void begin(fixture *f)
{
    static const mrt_channel channels[] = {
        {"fade", "s", PALETTE_SEMANTIC, MRT_NO_HAND, 0, 10},
        {"open", "", PALETTE_SEMANTIC, MRT_NO_HAND, 0, 1}, /* another order than the face's */
        {"smile", "", PALETTE_SEMANTIC, MRT_NO_HAND, 0, 1},
        {"grin", "", PALETTE_SEMANTIC, MRT_NO_HAND, 0, 1}, /* the face lacks it */
        {"far", "", PALETTE_SEMANTIC, MRT_NO_HAND, 0, 1}};
    memset(f, 0, sizeof *f);
    palette_init(&f->palette, &mapped);
    channel_route_init(&f->route, channels, 5);
}

static void step(fixture *f, double after_s, float fade_s, float open, float smile, float far)
{
    f->time_ns += (int64_t)(after_s * 1e9);
    sample_step s = {.time_ns = f->time_ns, .count = 1};
    s.of[0] = (step_sample){
        .route = &f->route,
        .sample = {.time_ns = f->time_ns, .count = 5, .value = {fade_s, open, smile, 1.0f, far}}};
    assert_true(palette_read(&f->palette, &reach, &s));
}

static void strengths_ease_and_poses_add_up(void **state)
{
    (void)state;
    fixture f;
    begin(&f);
    step(&f, 0.0, 0.2f, 1.0f, 0.0f, 0.0f);
    assert_true(f.palette.pull.mode == MRT_IDLE); /* it begins at 0 */
    step(&f, 0.1, 0.2f, 1.0f, 0.0f, 0.0f);
    assert_true(fabs(f.palette.pose[1].strength - 0.5) < 1e-6);
    assert_true(fabsf(f.palette.pull.dof[0] - 0.15f) < 1e-6f);
    step(&f, 0.2, 0.0f, 1.0f, 1.0f, 0.0f); /* the smile at once, from the next step on */
    step(&f, 0.01, 0.0f, 1.0f, 1.0f, 0.0f);
    assert_true(palette_is_settled(&f.palette));
    assert_int_equal(f.palette.pull.count, 2);
    assert_true(fabsf(f.palette.pull.vector[0].end.y - 4.0f) < 1e-5f); /* 6 - 2 */
    assert_true(fabsf(f.palette.pull.vector[1].end.x + 14.0f) < 1e-5f);
    step(&f, 0.01, 0.05f, 0.0f, 0.0f, 0.0f);
    step(&f, 0.1, 0.05f, 0.0f, 0.0f, 0.0f);
    assert_true(f.palette.pull.mode == MRT_IDLE);
}

static void nonsense_stays_in_range(void **state)
{
    (void)state;
    fixture f;
    begin(&f);
    step(&f, 0.0, -5.0f, 7.0f, -3.0f, 1.0f);
    step(&f, 0.1, 1e9f, 7.0f, -3.0f, 1.0f);
    for (uint32_t i = 0; i < f.palette.count; ++i)
        assert_true(f.palette.pose[i].strength >= 0.0 && f.palette.pose[i].strength <= 1.0);
    assert_null(guard_fault(&reach, &f.palette.pull)); /* "far" alone leads out of reach */
    assert_true(f.palette.pull.mode == MRT_ANCHORED);
}

static void bones_that_no_pose_moves_are_held_or_free(void **state)
{
    (void)state;
    fixture f;
    begin(&f);
    step(&f, 0.0, 0.0f, 1.0f, 0.0f, 0.0f);
    step(&f, 0.1, 0.0f, 1.0f, 0.0f, 0.0f);
    palette_hold_rest(&f.palette, false);
    assert_true(isnan(f.palette.pull.dof[1]) && f.palette.pull.dof[0] > 0.2f);
    palette_hold_rest(&f.palette, true);
    assert_true(f.palette.pull.dof[1] >= 0.0f && f.palette.pull.dof[1] <= 0.0f);
}

static void state_continues_with_the_same_bits(void **state)
{
    (void)state;
    fixture a, b;
    unsigned char bytes[1024];
    begin(&a);
    step(&a, 0.0, 0.3f, 1.0f, 0.2f, 0.0f);
    step(&a, 0.11, 0.3f, 1.0f, 0.2f, 0.0f);
    const size_t size = palette_save(&a.palette, bytes, sizeof bytes);
    assert_true(size > 0 && size <= sizeof bytes);
    b = a;
    palette_reset(&b.palette);
    assert_true(palette_load(&b.palette, &reach, bytes, size));
    for (int i = 0; i < 40; ++i) {
        step(&a, 0.013, 0.1f, i < 20 ? 1.0f : 0.0f, 0.6f, 0.0f);
        step(&b, 0.013, 0.1f, i < 20 ? 1.0f : 0.0f, 0.6f, 0.0f);
        assert_memory_equal(&a.palette.pull, &b.palette.pull, sizeof a.palette.pull);
    }
}

static void damaged_and_foreign_states_are_refused(void **state)
{
    static const mrt_rig_pose others[] = {{"smile", smile_pulls, still, MRT_POSE_MOUTH},
                                          {"wide", open_pulls, open_dofs, MRT_POSE_MOUTH},
                                          {"far", far_pulls, still, MRT_POSE_WHOLE}};
    mapped_face other = mapped;
    (void)state;
    fixture a;
    palette b;
    unsigned char bytes[1024], changed[1024];
    begin(&a);
    step(&a, 0.0, 0.3f, 1.0f, 0.2f, 0.0f);
    step(&a, 0.1, 0.3f, 1.0f, 0.2f, 0.0f);
    const size_t size = palette_save(&a.palette, bytes, sizeof bytes);
    palette_init(&b, &mapped);
    for (size_t cut = 0; cut < size; ++cut)
        assert_false(palette_load(&b, &reach, bytes, cut));
    for (size_t i = 0; i < size; ++i)
        for (int bit = 0; bit < 8; ++bit) {
            memcpy(changed, bytes, size);
            changed[i] ^= (unsigned char)(1 << bit);
            (void)palette_load(&b, &reach, changed, size);
            for (uint32_t k = 0; k < b.count; ++k)
                assert_true(b.pose[k].strength >= 0.0 && b.pose[k].strength <= 1.0 &&
                            b.pose[k].since_s <= b.pose[k].fade_s);
            assert_null(guard_fault(&reach, &b.pull));
        }
    other.pose = others;
    palette_init(&b, &other);
    assert_false(palette_load(&b, &reach, bytes, size));
}

/* The pull of a step with the poses open and smile, and shares of the jaw and the lips. */
static palette shared(float jaw, float lips)
{
    static const mrt_channel channels[] = {{"fade", "s", PALETTE_SEMANTIC, MRT_NO_HAND, 0, 10},
                                           {"jaw", "", PALETTE_JAW, MRT_NO_HAND, 0, 2},
                                           {"lips", "", PALETTE_LIPS, MRT_NO_HAND, 0, 2},
                                           {"open", "", PALETTE_SEMANTIC, MRT_NO_HAND, 0, 1}};
    fixture f;
    begin(&f);
    channel_route_init(&f.route, channels, 4);
    for (int i = 0; i < 2; ++i) {
        sample_step s = {.time_ns = i * 10000000, .count = 1};
        s.of[0] = (step_sample){
            .route = &f.route,
            .sample = {.time_ns = s.time_ns, .count = 4, .value = {0.0f, jaw, lips, 1.0f}}};
        assert_true(palette_read(&f.palette, &reach, &s));
    }
    return f.palette;
}

static void jaw_and_lips_are_scaled_apart(void **state)
{
    (void)state;
    const palette whole = shared(1.0f, 1.0f), jaw = shared(0.5f, 1.0f), lips = shared(1.0f, 0.5f);
    assert_true(fabsf(jaw.pull.dof[0] - 0.5f * whole.pull.dof[0]) < 1e-6f);
    assert_memory_equal(jaw.pull.vector, whole.pull.vector, sizeof whole.pull.vector);
    assert_true(fabsf(lips.pull.dof[0] - whole.pull.dof[0]) < 1e-6f);
    assert_true(fabsf(whole.pull.vector[0].end.y - whole.pull.vector[0].start.y) > 1.0f);
    assert_true(fabsf(lips.pull.vector[0].end.y - lips.pull.vector[0].start.y -
                      0.5f * (whole.pull.vector[0].end.y - whole.pull.vector[0].start.y)) < 1e-4f);
    unsigned char bytes[4096];
    palette again;
    const size_t size = palette_save(&jaw, bytes, sizeof bytes);
    palette_init(&again, &mapped);
    assert_true(palette_load(&again, &reach, bytes, size));
    assert_memory_equal(&again.pull, &jaw.pull, sizeof jaw.pull);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(jaw_and_lips_are_scaled_apart),
        cmocka_unit_test(strengths_ease_and_poses_add_up),
        cmocka_unit_test(nonsense_stays_in_range),
        cmocka_unit_test(bones_that_no_pose_moves_are_held_or_free),
        cmocka_unit_test(state_continues_with_the_same_bits),
        cmocka_unit_test(damaged_and_foreign_states_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
