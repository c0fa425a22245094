/* The mouse on the face of a live stage: what is dragged moves, springs back, stays, is clay. */
#include "window/live_fixture.h"

static const vec3 way = {0.0, 6.0, 4.0};

static void start(live_fixture *d, const char *mapping)
{
    fixture_start(d, "puppet", mapping, FIXTURE_NO_SHOW);
}

static void stage_is_seen_before_any_sample(void **state)
{
    (void)state;
    live_fixture d;
    start(&d, NULL);
    assert_true(d.view->vertex_count > 1000);
    assert_true(d.view->number >= 1);
    assert_true(d.view->contact_count > 0);
    assert_true(fixture_is_at_rest(&d, NULL));
    fixture_finish(&d);
}

static void dragged_contact_moves_by_the_drag(void **state)
{
    (void)state;
    live_fixture d;
    start(&d, NULL);
    uint32_t corner = fixture_contact(&d, "mouth.corner.l");
    fixture_drag(&d, POINTER_PULLS, corner, way, false);
    vec3 moved = vec3_sub(d.view->contact[corner], fixture_rest(&d, corner));
    assert_true(vec3_length(vec3_sub(moved, way)) < 0.05);
    fixture_let_go(&d);
    assert_true(fixture_until(&d, fixture_is_at_rest, NULL));
    fixture_finish(&d);
}

static void staying_contact_stays_until_it_is_let_go(void **state)
{
    (void)state;
    live_fixture d;
    start(&d, NULL);
    uint32_t left = fixture_contact(&d, "mouth.corner.l"),
             right = fixture_contact(&d, "mouth.corner.r");
    fixture_drag(&d, POINTER_PULLS, left, way, true);
    fixture_let_go(&d);
    assert_true(fabs(fixture_moved_mm(&d, left) - vec3_length(way)) < 0.05);
    fixture_drag(&d, POINTER_PULLS, right, way, true);
    fixture_let_go(&d);
    assert_true(fabs(fixture_moved_mm(&d, left) - vec3_length(way)) < 0.05);
    assert_true(fabs(fixture_moved_mm(&d, right) - vec3_length(way)) < 0.05);
    const vec3 nowhere = {0, 0, 0};
    fixture_point(&d, POINTER_RELEASE_ALL, nowhere, nowhere, false);
    assert_true(fixture_until(&d, fixture_is_at_rest, NULL));
    fixture_finish(&d);
}

static vec3 cheek(const live_fixture *d)
{
    uint32_t corner = fixture_contact(d, "mouth.corner.l");
    vec3 near = vec3_add(fixture_rest(d, corner), (vec3){6.0, 8.0, 0.0});
    const float *nearest = d->first;
    double least = INFINITY;
    for (size_t v = 0; v < d->view->vertex_count; ++v) {
        const float *p = d->first + 3 * v;
        vec3 away = vec3_sub((vec3){(double)p[0], (double)p[1], (double)p[2]}, near);
        if (vec3_dot(away, away) >= least)
            continue;
        least = vec3_dot(away, away);
        nearest = p;
    }
    return (vec3){(double)nearest[0], (double)nearest[1], (double)nearest[2]};
}

static double moved_at(const live_fixture *d, vec3 position, vec3 *out)
{
    for (size_t v = 0; v < d->view->vertex_count; ++v) {
        const float *p = d->first + 3 * v, *q = d->view->position + 3 * v;
        if ((double)p[0] == position.x && (double)p[1] == position.y &&
            (double)p[2] == position.z) {
            *out = (vec3){(double)q[0], (double)q[1], (double)q[2]};
            return vec3_length(vec3_sub(*out, position));
        }
    }
    return NAN;
}

static void drag_place(live_fixture *d, pointer_grip grip, vec3 position, bool stays)
{
    vec3 from = position;
    (void)moved_at(d, position, &from);
    fixture_point(d, grip, position, from, stays);
    for (int i = 1; i <= 20; ++i) {
        fixture_frame(d);
        fixture_point(d, grip, position, vec3_add(from, vec3_scale(way, (double)i / 20.0)), stays);
    }
    fixture_perform(d, 0.0);
}

static void place_of_the_skin_springs_back(void **state)
{
    (void)state;
    live_fixture d;
    vec3 now;
    start(&d, NULL);
    vec3 position = cheek(&d);
    drag_place(&d, POINTER_PULLS, position, false);
    assert_true(fabs(moved_at(&d, position, &now) - vec3_length(way)) < 0.5);
    fixture_let_go(&d);
    assert_true(fixture_until(&d, fixture_is_at_rest, NULL));
    fixture_finish(&d);
}

static void place_that_stays_can_be_dragged_on(void **state)
{
    (void)state;
    live_fixture d;
    vec3 now;
    start(&d, NULL);
    vec3 position = cheek(&d);
    drag_place(&d, POINTER_PULLS, position, true);
    fixture_let_go(&d);
    double once = moved_at(&d, position, &now);
    assert_true(fabs(once - vec3_length(way)) < 0.5);
    drag_place(&d, POINTER_PULLS, position, true);
    fixture_let_go(&d);
    double twice = moved_at(&d, position, &now);
    if (fabs(twice - 2.0 * vec3_length(way)) >= 1.0)
        fail_msg("%g mm after one drag, %g mm after two", once, twice);
    fixture_finish(&d);
}

static void clay_stays_until_neutral(void **state)
{
    (void)state;
    live_fixture d;
    vec3 now;
    start(&d, NULL);
    vec3 position = cheek(&d);
    drag_place(&d, POINTER_KNEADS, position, false);
    fixture_let_go(&d);
    double moved_mm = moved_at(&d, position, &now);
    if (moved_mm < 2.0)
        fail_msg("clay moved by %g mm", moved_mm);
    live_neutral(d.live);
    assert_true(fixture_until(&d, fixture_is_at_rest, NULL));
    fixture_finish(&d);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stage_is_seen_before_any_sample),
        cmocka_unit_test(dragged_contact_moves_by_the_drag),
        cmocka_unit_test(staying_contact_stays_until_it_is_let_go),
        cmocka_unit_test(place_of_the_skin_springs_back),
        cmocka_unit_test(place_that_stays_can_be_dragged_on),
        cmocka_unit_test(clay_stays_until_neutral),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
