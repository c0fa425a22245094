/* Mapping, face, inputs and engine are changed while a live stage performs: nothing jumps, nothing
 * else stops. */
#include "window/live_fixture.h"

/* What an ease of a quarter of a second moves a vertex in 20 ms at most, of how far it has to go:
 * the hand is held still. */
static const double step_share = 0.16;

/* A right hand that is held still, bent. */
typedef struct still_hand {
    feed *feed;
    float angle[MRT_ANGLES];
    double moved_mm; /* the face, by it */
} still_hand;

/* From straight to bent, slowly: mappings take the first pose that they see as neutral. */
static void bend(live_fixture *d, still_hand *h)
{
    for (int n = 0; n <= 20; ++n) {
        for (uint32_t i = 0; i < 18; ++i)
            h->angle[i] = 0.03f * (float)n * (i % 4 == 0 ? 1.0f : -0.5f);
        feed_push(h->feed, h->angle, FEED_MOVES);
        fixture_perform(d, n == 0 ? 0.4 : 0.01);
    }
    fixture_perform(d, 0.7);
    h->moved_mm = fixture_apart_mm(d, d->first);
}

static void hold(live_fixture *d, still_hand *h)
{
    error err = {""};
    input *in;
    mrt_channel channel[MRT_ANGLES];
    for (uint32_t i = 0; i < MRT_ANGLES; ++i)
        channel[i] = (mrt_channel){"angle", "rad", MRT_CH_ANGLE + i, MRT_RIGHT, -2.0f, 2.0f};
    memset(h, 0, sizeof *h);
    const feed_settings settings = {.id = "org.marotte.test.hand",
                                    .name = "hand",
                                    .channels = channel,
                                    .channel_count = MRT_ANGLES,
                                    .rate_hz = 150.0};
    fixture_must(feed_create(&h->feed, &settings, &err), &err);
    fixture_must(input_create(&in, feed_type(h->feed), "", "", CLOCK_REAL, d->log, &err), &err);
    fixture_must(live_add_input(d->live, in, "hand", &err), &err);
    bend(d, h);
}

static void end(live_fixture *d, still_hand *h)
{
    fixture_finish(d);
    feed_destroy(h->feed);
}

typedef struct track {
    float *last;
    int64_t sample_ns;
    double most_mm; /* of any vertex between two faces, per 20 ms of samples */
} track;

static void look(live_fixture *d, track *t)
{
    size_t size = (size_t)d->view->vertex_count * 3;
    fixture_frame(d);
    if (!t->last) {
        t->last = malloc(size * sizeof *t->last);
        assert_non_null(t->last);
        memcpy(t->last, d->view->position, size * sizeof *t->last);
        t->sample_ns = d->view->sample_ns;
    }
    double passed_s = (double)(d->view->sample_ns - t->sample_ns) / 1e9;
    double frames = fmax(passed_s / 0.02, 1.0);
    t->most_mm = fmax(t->most_mm, fixture_apart_mm(d, t->last) / frames);
    memcpy(t->last, d->view->position, size * sizeof *t->last);
    t->sample_ns = d->view->sample_ns;
}

static void look_on(live_fixture *d, track *t, double seconds)
{
    int64_t until_ns = clock_now_ns() + (int64_t)(seconds * 1e9);
    do
        look(d, t);
    while (clock_now_ns() < until_ns || d->view->sample_ns < until_ns);
}

static void is_smooth(const track *t, const char *what, double moved_mm)
{
    double step_mm = step_share * moved_mm;
    print_message("%s: at most %.2f mm in 20 ms of %.1f mm\n", what, t->most_mm, moved_mm);
    if (t->most_mm > step_mm)
        fail_msg("%s: a vertex jumps by %.2f mm", what, t->most_mm);
}

static void add_demo(live_fixture *d)
{
    error err = {""};
    char text[FIXTURE_PATH];
    snprintf(text, sizeof text, "log:%s/plugins/log/demo_hand.csv,start=3,loop=1", SOURCE_DIR);
    fixture_must(fixture_add_input(d, text, &err), &err);
}

static void relax(live_fixture *d, still_hand *h)
{
    memset(h->angle, 0, sizeof h->angle);
    feed_push(h->feed, h->angle, FEED_MOVES);
    fixture_perform(d, 0.5);
}

static void change_mapping(live_fixture *d, still_hand *hand, const char *from, const char *to)
{
    error err = {""};
    char what[FIXTURE_PATH];
    track t = {0};
    relax(d, hand);
    fixture_must(live_set_mapping(d->live, from, &err), &err);
    fixture_perform(d, 0.6);
    bend(d, hand);
    look_on(d, &t, 0.0);
    fixture_must(live_set_mapping(d->live, to, &err), &err);
    assert_true((live_mapping(d->live) != NULL) == (to[0] != '\0'));
    look_on(d, &t, 0.8);
    snprintf(what, sizeof what, "from \"%s\" to \"%s\"", from, to);
    is_smooth(&t, what, hand->moved_mm);
    free(t.last);
}

static void mapping_changes_without_a_jump(void **state)
{
    (void)state;
    live_fixture d;
    still_hand hand;
    fixture_start(&d, "puppet", "one_hand", FIXTURE_SHOW);
    hold(&d, &hand);
    assert_true(hand.moved_mm > 3.0);
    change_mapping(&d, &hand, "one_hand", "");
    change_mapping(&d, &hand, "one_hand", "one_hand,smile_gain=130");
    change_mapping(&d, &hand, "one_hand", "anchored");
    change_mapping(&d, &hand, "anchored", "one_hand");
    end(&d, &hand);
}

static void knead(live_fixture *d, still_hand *hand, const char *mapping)
{
    error err = {""};
    relax(d, hand);
    fixture_must(live_set_mapping(d->live, mapping, &err), &err);
    fixture_perform(d, 0.6);
    bend(d, hand);
}

/* A mapping takes the pose at the change as neutral. So the face must be at rest after it. */
static void leaves_nothing(live_fixture *d, still_hand *hand, const char *from, const char *to)
{
    error err = {""};
    knead(d, hand, from);
    fixture_must(live_set_mapping(d->live, to, &err), &err);
    fixture_perform(d, 0.8);
    const double left_mm = fixture_apart_mm(d, d->first);
    print_message("from \"%s\" to \"%s\": %.2f mm of %.1f mm are left\n", from, to, left_mm,
                  hand->moved_mm);
    if (left_mm > 0.3)
        fail_msg("%.2f mm of %s stay in the face after the change to %s", left_mm, from, to);
}

static void start_with(live_fixture *d, still_hand *hand, const char *library)
{
    error err = {""};
    char path[FIXTURE_PATH];
    fixture_start(d, "puppet", "one_hand", FIXTURE_SHOW);
    snprintf(path, sizeof path, "%s/plugins/%s.so", BUILD_DIR, library);
    fixture_must(plugin_list_add(&d->plugins, path, &err), &err);
    hold(d, hand);
}

static void a_change_of_mapping_leaves_nothing_in_the_face(void **state)
{
    (void)state;
    live_fixture d;
    still_hand hand;
    start_with(&d, &hand, "poses");
    leaves_nothing(&d, &hand, "unanchored,gate=0", "one_hand");
    leaves_nothing(&d, &hand, "anchored", "");
    leaves_nothing(&d, &hand, "one_hand", "unanchored,gate=0");
    end(&d, &hand);
}

static void kneaded_clay_stays_where_a_person_keeps_it(void **state)
{
    (void)state;
    live_fixture d;
    still_hand hand;
    error err = {""};
    start_with(&d, &hand, "poses");
    live_keep_clay(d.live, true);
    assert_true(live_keeps_clay(d.live));
    knead(&d, &hand, "unanchored,gate=0");
    const double kneaded_mm = fixture_apart_mm(&d, d.first);
    assert_true(kneaded_mm > 5.0);
    fixture_must(live_set_mapping(d.live, "poses", &err), &err);
    fixture_perform(&d, 1.2);
    assert_true(fixture_apart_mm(&d, d.first) > 0.9 * kneaded_mm);
    end(&d, &hand);
}

/* Nothing else moves: the steps of the ease come from the stage itself. */
static void face_rests_after_the_last_hand_is_removed(void **state)
{
    static const char *const mappings[] = {"anchored", "unanchored,gate=0"};
    (void)state;
    for (size_t i = 0; i < sizeof mappings / sizeof *mappings; ++i) {
        live_fixture d;
        still_hand hand;
        error err = {""};
        track t = {0};
        start_with(&d, &hand, "poses");
        knead(&d, &hand, mappings[i]);
        look(&d, &t);
        fixture_must(live_remove_input(d.live, 0, &err), &err);
        for (int64_t until_ns = clock_now_ns() + NS_PER_S; clock_now_ns() < until_ns;)
            look(&d, &t);
        print_message("%s, no hand: %.2f mm of %.1f mm are left\n", mappings[i],
                      fixture_apart_mm(&d, d.first), hand.moved_mm);
        is_smooth(&t, mappings[i], fmax(hand.moved_mm, 1.0));
        assert_true(fixture_is_at_rest(&d, NULL));
        free(t.last);
        end(&d, &hand);
    }
}

static bool drives_a_bone(live_fixture *d, void *data)
{
    (void)data;
    for (uint32_t i = 0; i < d->view->about->dof_count; ++i)
        if (!isnan(d->view->pull.dof[i]))
            return true;
    return false;
}

/* Anchored says nothing of bones: the head and the jaw go home. */
static void a_mapping_of_vectors_drives_no_bone_of_the_one_before(void **state)
{
    (void)state;
    live_fixture d;
    still_hand hand;
    error err = {""};
    fixture_start(&d, "puppet", "one_hand", FIXTURE_NO_SHOW);
    hold(&d, &hand);
    assert_true(drives_a_bone(&d, NULL));
    fixture_must(live_set_mapping(d.live, "anchored", &err), &err);
    fixture_perform(&d, 1.0);
    assert_int_equal(d.view->pull.mode, MRT_ANCHORED);
    assert_false(drives_a_bone(&d, NULL));
    end(&d, &hand);
}

static bool is_moved(live_fixture *d, void *data)
{
    (void)data;
    return fixture_apart_mm(d, d->first) > 0.5;
}

static void mapping_of_nothing_lets_the_face_rest(void **state)
{
    (void)state;
    live_fixture d;
    error err = {""};
    fixture_start(&d, "puppet", "one_hand", FIXTURE_NO_SHOW);
    add_demo(&d);
    assert_true(fixture_until(&d, is_moved, NULL));
    fixture_must(live_set_mapping(d.live, NULL, &err), &err);
    assert_null(live_mapping(d.live));
    assert_true(fixture_until(&d, fixture_is_at_rest, NULL));
    assert_true(live_set_mapping(d.live, "no_such_mapping", &err) < 0);
    assert_true(live_set_mapping(d.live, "one_hand,no_such=1", &err) < 0);
    fixture_finish(&d);
}

static void inputs_come_and_go_while_it_performs(void **state)
{
    (void)state;
    live_fixture d;
    error err = {""};
    mrt_sample sample;
    live_status before, after;
    fixture_start(&d, "puppet", "one_hand", FIXTURE_SHOW);
    add_demo(&d);
    fixture_perform(&d, 0.4);
    track t = {0};
    for (int i = 0; i < 3; ++i) {
        add_demo(&d);
        assert_int_equal(live_input_count(d.live), 2);
        look_on(&d, &t, 0.1);
        fixture_must(live_remove_input(d.live, 0, &err), &err);
        look_on(&d, &t, 0.1);
    }
    free(t.last);
    assert_int_equal(live_input_count(d.live), 1);
    fixture_perform(&d, 0.1);
    assert_true(live_input_sample(d.live, 0, &sample));
    live_status_of(d.live, &before);
    fixture_perform(&d, 0.3);
    live_status_of(d.live, &after);
    assert_true(after.sample_count > before.sample_count);
    fixture_must(live_remove_input(d.live, 0, &err), &err);
    assert_false(live_input_sample(d.live, 0, &sample));
    assert_true(live_remove_input(d.live, 0, &err) < 0);
    assert_true(fixture_add_input(&d, "no_such_plugin", &err) < 0);
    assert_true(fixture_add_input(&d, "log:/no/such/file.csv", &err) < 0);
    assert_true(fixture_add_input(&d, ":", &err) < 0);
    assert_int_equal(live_input_count(d.live), 0);
    fixture_finish(&d);
}

static void eight_inputs_are_too_many(void **state)
{
    (void)state;
    live_fixture d;
    error err = {""};
    char text[FIXTURE_PATH];
    fixture_start(&d, "puppet", NULL, FIXTURE_SHOW);
    for (int i = 0; i < 7; ++i)
        add_demo(&d);
    snprintf(text, sizeof text, "log:%s/plugins/log/demo_hand.csv", SOURCE_DIR);
    assert_true(fixture_add_input(&d, text, &err) < 0);
    assert_true(strstr(err.text, "the limit of 7 inputs") != NULL);
    fixture_pass(&d, 0.1);
    fixture_finish(&d);
}

static void a_kernel_is_taken_with_the_radius_of_the_rig(void **state)
{
    (void)state;
    live_fixture d;
    error err = {""};
    fixture_start(&d, "puppet", "one_hand", FIXTURE_NO_SHOW);
    const csrbf_settings of_rig = d.view->solver;
    const csrbf_settings broad = {.kernel = CSRBF_WENDLAND_C6, .polynomial = CSRBF_CONSTANT};
    fixture_must(live_set_solver(d.live, &broad, &err), &err);
    fixture_pass(&d, 0.1);
    assert_int_equal(d.view->solver.kernel, CSRBF_WENDLAND_C6);
    assert_int_equal(d.view->solver.polynomial, CSRBF_CONSTANT);
    assert_float_equal(d.view->solver.radius, of_rig.radius, 1e-9);
    fixture_must(live_set_solver(d.live, NULL, &err), &err);
    fixture_pass(&d, 0.1);
    assert_int_equal(d.view->solver.kernel, of_rig.kernel);
    assert_int_equal(d.view->solver.polynomial, of_rig.polynomial);
    fixture_finish(&d);
}

static void face_and_engine_change_while_it_performs(void **state)
{
    (void)state;
    live_fixture d;
    still_hand hand;
    error err = {""};
    face_file moai = {0};
    char path[FIXTURE_PATH];
    fixture_start(&d, "puppet", "one_hand", FIXTURE_SHOW);
    hold(&d, &hand);
    csrbf_settings solver = d.view->solver;
    solver.radius *= 1.5;
    track t = {0};
    look_on(&d, &t, 0.05);
    fixture_must(live_set_solver(d.live, &solver, &err), &err);
    look_on(&d, &t, 0.6);
    is_smooth(&t, "another radius", hand.moved_mm);
    free(t.last);
    assert_true(fabs(d.view->solver.radius - solver.radius) < 1e-9);
    uint32_t of_puppet = d.view->vertex_count;
    snprintf(path, sizeof path, "%s/rigs/moai/moai.rig.json", SOURCE_DIR);
    fixture_must(face_file_read(&moai, path, NULL, FACE_FILE_USABLE, &err), &err);
    const live_view *before = d.view; /* two changes within a frame */
    fixture_must(live_set_solver(d.live, &solver, &err), &err);
    fixture_must(live_set_face(d.live, &moai, path, 0.0, &err), &err);
    assert_true(isfinite(before->position[3 * of_puppet - 1])); /* still there until it is looked */
    assert_true(live_read_view(d.live, &d.view));
    assert_int_not_equal(d.view->vertex_count, of_puppet);
    fixture_perform(&d, 0.3);
    assert_true(d.view->number > 2);
    fixture_must(live_set_face(d.live, &d.face, d.face_path, 0.0, &err), &err);
    fixture_pass(&d, 0.2);
    assert_int_equal(d.view->vertex_count, of_puppet);
    face_file_destroy(&moai);
    end(&d, &hand);
}

static void grip_of_a_moving_face_does_not_jump(void **state)
{
    (void)state;
    live_fixture d;
    still_hand hand;
    static const char *const contacts[] = {"mouth.corner.l", "chin", "brow.mid.l", "cheek.l",
                                           "nose.tip"};
    fixture_start(&d, "puppet", "one_hand", FIXTURE_NO_SHOW);
    hold(&d, &hand);
    for (size_t i = 0; i < sizeof contacts / sizeof *contacts; ++i) {
        uint32_t contact = fixture_contact(&d, contacts[i]);
        vec3 rest = fixture_rest(&d, contact), at = d.view->contact[contact];
        track t = {0};
        look_on(&d, &t, 0.1);
        at = d.view->contact[contact];
        fixture_point(&d, POINTER_PULLS, rest, at, false);
        look_on(&d, &t, 0.3);
        fixture_point(&d, POINTER_AWAY, rest, at, false);
        look_on(&d, &t, 0.6);
        is_smooth(&t, contacts[i], hand.moved_mm);
        free(t.last);
    }
    end(&d, &hand);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(mapping_changes_without_a_jump),
        cmocka_unit_test(a_change_of_mapping_leaves_nothing_in_the_face),
        cmocka_unit_test(kneaded_clay_stays_where_a_person_keeps_it),
        cmocka_unit_test(face_rests_after_the_last_hand_is_removed),
        cmocka_unit_test(a_mapping_of_vectors_drives_no_bone_of_the_one_before),
        cmocka_unit_test(mapping_of_nothing_lets_the_face_rest),
        cmocka_unit_test(inputs_come_and_go_while_it_performs),
        cmocka_unit_test(eight_inputs_are_too_many),
        cmocka_unit_test(a_kernel_is_taken_with_the_radius_of_the_rig),
        cmocka_unit_test(face_and_engine_change_while_it_performs),
        cmocka_unit_test(grip_of_a_moving_face_does_not_jump),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
