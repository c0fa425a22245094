/* Every sample of an input of a live stage, for somebody who is slower than it (a calibration); and
 * fingers that are linked to contacts while they perform. */
#include "window/live_fixture.h"

static const char demo[] = "log:" SOURCE_DIR "/plugins/log/demo_hand.csv,loop=1";

static void add(live_fixture *d)
{
    error err = {""};
    fixture_must(fixture_add_input(d, demo, &err), &err);
}

typedef struct heard {
    uint32_t count, first, last, lost;
} heard;

static void take_all(live_fixture *d, heard *h)
{
    mrt_sample sample;
    while (live_pop_tapped(d->live, &sample)) {
        if (h->count == 0)
            h->first = sample.sequence;
        else
            h->lost += sample.sequence - h->last - 1;
        h->last = sample.sequence;
        h->count += 1;
    }
}

static bool has_forty(live_fixture *d, void *data)
{
    heard *h = data;
    take_all(d, h);
    return h->count >= 40;
}

static void every_sample_is_heard_though_nobody_looks_for_a_while(void **state)
{
    (void)state;
    live_fixture d;
    heard h = {.count = 0};
    fixture_start(&d, "puppet", "one_hand", FIXTURE_NO_SHOW);
    add(&d);
    live_tap(d.live, 0);
    assert_true(fixture_until(&d, has_forty, &h));
    fixture_pass(&d, 0.5); /* a window that draws twice a second */
    take_all(&d, &h);
    assert_true(h.count >= 60);
    assert_int_equal(h.lost, 0);
    fixture_finish(&d);
}

static void only_what_is_tapped_is_heard(void **state)
{
    (void)state;
    live_fixture d;
    heard h = {.count = 0}, other = {.count = 0};
    mrt_sample sample;
    fixture_start(&d, "puppet", "one_hand", FIXTURE_NO_SHOW);
    assert_false(live_pop_tapped(d.live, &sample));
    add(&d);
    add(&d);
    live_tap(d.live, 1);
    assert_true(fixture_until(&d, has_forty, &h));
    assert_int_equal(h.lost, 0); /* two inputs in turn would leave gaps, or go back */
    live_tap(d.live, 7);
    take_all(&d, &other);
    assert_int_equal(other.count, 0);
    fixture_finish(&d);
}

static bool is_linked(live_fixture *d, void *data)
{
    const uint32_t *contact = data;
    for (uint32_t i = 0; i < d->view->pull.count; ++i)
        if (d->view->pull.vector[i].contact == *contact)
            return true;
    return false;
}

static void a_link_is_used_at_once_and_the_face_does_not_jump(void **state)
{
    (void)state;
    live_fixture d;
    error err = {""};
    fixture_start(&d, "puppet", "anchored", FIXTURE_NO_SHOW);
    add(&d);
    uint32_t corner = fixture_contact(&d, "mouth.corner.l") + 1;
    fixture_pass(&d, 0.3);
    char value[16];
    snprintf(value, sizeof value, "%u", corner);
    fixture_must(instance_set_text(live_mapping(d.live), "right_index", value, &err), &err);
    size_t size = (size_t)d.view->vertex_count * 3;
    float *before = malloc(size * sizeof *before);
    assert_non_null(before);
    double most_mm = 0.0;
    for (int i = 0; i < 400 && !is_linked(&d, &corner); ++i) {
        memcpy(before, d.view->position, size * sizeof *before);
        uint64_t number = d.view->number;
        fixture_frame(&d);
        if (d.view->number == number + 1)
            most_mm = fmax(most_mm, fixture_apart_mm(&d, before));
    }
    free(before);
    assert_true(is_linked(&d, &corner));
    assert_true(most_mm <
                8.0); /* what a hand does within a frame or two, no jump across the face */
    fixture_finish(&d);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_sample_is_heard_though_nobody_looks_for_a_while),
        cmocka_unit_test(only_what_is_tapped_is_heard),
        cmocka_unit_test(a_link_is_used_at_once_and_the_face_does_not_jump),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
