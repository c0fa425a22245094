/* The mapping that `marotte plugin new` writes is an example in all that it does: it moves any
 * face, follows time alone, forgets at reset, remembers to the bit. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include <dlfcn.h>
#include <marotte/plugin.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FRAMES = 40, MANY = MRT_MAX_VECTORS + 6 };

static const mrt_plugin_type *type;

static const void *interface_of(const char *id)
{
    for (const mrt_interface *i = type->interfaces; i->id; ++i)
        if (strcmp(i->id, id) == 0)
            return i->functions;
    fail_msg("no %s", id);
    return NULL;
}

static int load_library(void **state)
{
    (void)state;
    void *library = dlopen(BUILD_DIR "/tests/plugin/mapping_template.so", RTLD_NOW);
    const mrt_plugin_type *const *types = library ? dlsym(library, "marotte_plugins") : NULL;
    type = types ? types[0] : NULL;
    if (!type)
        fprintf(stderr, "%s\n", dlerror());
    return type ? 0 : -1;
}

/* ---- a stage without a host ---- */

static const mrt_contact contacts[MANY] = {
    {"cheek.l", "skull", {30, 0, 40}, {0.6f, 0, 0.8f}},
    {"chin", "jaw", {0, -60, 50}, {0, 0, 1}},
};
static const mrt_dof dofs[] = {{"eye.l.yaw", "rad", -1, 1}, {"jaw.open", "rad", 0, 0.5f}};

static mrt_face face_of(uint32_t contact_count, uint32_t dof_count)
{
    return (mrt_face){contacts, dofs, contact_count, dof_count, {-50, -100, -60}, {50, 100, 60}};
}

typedef struct scene {
    mrt_plugin *plugin;
    mrt_pull pull;
    mrt_frame frame;
    double params[2];
} scene;

static void begin(scene *out, const mrt_face *face)
{
    const mrt_mapping *mapping = interface_of(MRT_MAPPING);
    memset(out, 0, sizeof *out);
    for (uint32_t i = 0; i < MRT_MAX_DOFS; ++i)
        out->pull.dof[i] = NAN;
    for (uint32_t i = 0; i < type->param_count; ++i)
        out->params[i] = type->params[i].initial;
    out->frame.params = out->params;
    out->plugin = type->create(NULL);
    assert_non_null(out->plugin);
    assert_int_equal(mapping->activate(out->plugin, face), MRT_OK);
    mapping->reset(out->plugin);
}

static void end(scene *s)
{
    const mrt_mapping *mapping = interface_of(MRT_MAPPING);
    mapping->deactivate(s->plugin);
    type->destroy(s->plugin);
}

static mrt_result step(scene *s, double dt_s, float knuckle_rad)
{
    const mrt_mapping *mapping = interface_of(MRT_MAPPING);
    static const int knuckles[] = {4, 7, 11, 15};
    s->frame.hand[MRT_RIGHT].present = true;
    for (int i = 0; i < 4; ++i)
        s->frame.hand[MRT_RIGHT].angle[knuckles[i]] = knuckle_rad;
    s->frame.dt_s = dt_s;
    return mapping->process(s->plugin, &s->frame, &s->pull);
}

/* A hand that closes and opens; the same for every scene. */
static float knuckle_at(int frame)
{
    return (float)(frame < FRAMES / 2 ? frame : FRAMES - frame) * 0.07f;
}

static float way_of(const mrt_vector *v)
{
    float x = v->end.x - v->start.x, y = v->end.y - v->start.y, z = v->end.z - v->start.z;
    return sqrtf(x * x + y * y + z * z);
}

/* ---- tests ---- */

static void a_fist_pushes_contacts_along_their_normals(void **state)
{
    (void)state;
    mrt_face face = face_of(2, 2);
    scene s;
    begin(&s, &face);
    for (int i = 0; i < 200; ++i)
        assert_int_equal(step(&s, 0.01, 1.5f), MRT_OK);
    assert_int_equal(s.pull.mode, MRT_ANCHORED);
    assert_int_equal(s.pull.count, 2);
    /* 3 % of 200 mm; 200 frames of a hundredth of a second are 40 time constants. */
    assert_float_equal(way_of(&s.pull.vector[0]), 6.0f, 1e-3f);
    assert_float_equal(s.pull.vector[0].end.x - 30.0f, 0.6f * 6.0f, 1e-3f);
    assert_float_equal(s.pull.vector[0].end.z - 40.0f, 0.8f * 6.0f, 1e-3f);
    assert_int_equal(s.pull.vector[1].contact, 2);
    assert_true(isnan(s.pull.dof[0]));
    assert_float_equal(s.pull.dof[1], 0.6f * 0.5f, 1e-4f);
    end(&s);
}

static void a_flat_hand_leaves_the_face_at_rest(void **state)
{
    (void)state;
    mrt_face face = face_of(2, 2);
    scene s;
    begin(&s, &face);
    for (int i = 0; i < 10; ++i)
        assert_int_equal(step(&s, 0.01, 0.0f), MRT_OK);
    assert_float_equal(way_of(&s.pull.vector[0]), 0.0f, 0.0f);
    assert_float_equal(s.pull.dof[1], 0.0f, 0.0f);
    end(&s);
}

static void a_hand_that_appears_does_not_make_the_face_jump(void **state)
{
    (void)state;
    mrt_face face = face_of(2, 2);
    const mrt_mapping *mapping = interface_of(MRT_MAPPING);
    scene s;
    begin(&s, &face);
    assert_int_equal(mapping->process(s.plugin, &s.frame, &s.pull), MRT_HOLD);
    assert_int_equal(step(&s, 0.0, 1.5f), MRT_OK);
    assert_float_equal(way_of(&s.pull.vector[0]), 0.0f, 0.0f);
    assert_int_equal(step(&s, 0.001, 1.5f), MRT_OK);
    assert_in_range((int)(1000 * way_of(&s.pull.vector[0])), 1, 200); /* um */
    end(&s);
}

static void without_easing_it_follows_at_once_and_never_divides_by_nothing(void **state)
{
    (void)state;
    mrt_face face = face_of(2, 2);
    scene s;
    begin(&s, &face);
    s.params[1] = 0.0; /* ease, s */
    assert_int_equal(step(&s, 0.0, 1.5f), MRT_OK);
    assert_true(way_of(&s.pull.vector[0]) <= 0.0f); /* false for NaN */
    assert_int_equal(step(&s, 0.01, 1.5f), MRT_OK);
    assert_float_equal(way_of(&s.pull.vector[0]), 6.0f, 1e-4f);
    end(&s);
}

static void a_face_without_contacts_is_pulled_at_its_front(void **state)
{
    (void)state;
    mrt_face face = face_of(0, 0);
    scene s;
    begin(&s, &face);
    for (int i = 0; i < 200; ++i)
        assert_int_equal(step(&s, 0.01, 1.5f), MRT_OK);
    assert_int_equal(s.pull.count, 1);
    assert_int_equal(s.pull.vector[0].contact, 0);
    assert_float_equal(s.pull.vector[0].start.y, -20.0f, 1e-4f);
    assert_float_equal(s.pull.vector[0].end.z, 66.0f, 1e-3f);
    end(&s);
}

static void more_contacts_than_vectors_fill_the_pull_and_no_more(void **state)
{
    (void)state;
    mrt_face face = face_of(MANY, 0);
    scene s;
    begin(&s, &face);
    assert_int_equal(step(&s, 0.01, 1.0f), MRT_OK);
    assert_int_equal(s.pull.count, MRT_MAX_VECTORS);
    end(&s);
}

static void a_left_hand_does_as_well(void **state)
{
    (void)state;
    mrt_face face = face_of(2, 2);
    const mrt_mapping *mapping = interface_of(MRT_MAPPING);
    scene s;
    begin(&s, &face);
    s.frame.hand[MRT_LEFT].present = true;
    s.frame.hand[MRT_LEFT].angle[4] = 1.5f;
    s.frame.dt_s = 0.05;
    assert_int_equal(mapping->process(s.plugin, &s.frame, &s.pull), MRT_OK);
    assert_true(way_of(&s.pull.vector[0]) > 0.5f);
    end(&s);
}

static void after_reset_the_same_samples_give_the_same_pulls(void **state)
{
    (void)state;
    mrt_face face = face_of(2, 2);
    const mrt_mapping *mapping = interface_of(MRT_MAPPING);
    scene first, second;
    begin(&first, &face);
    begin(&second, &face);
    for (int i = 0; i < 7; ++i)
        assert_int_equal(step(&second, 0.03, 1.2f), MRT_OK);
    mapping->reset(second.plugin);
    for (int i = 0; i < FRAMES; ++i) {
        assert_int_equal(step(&first, 0.01, knuckle_at(i)), MRT_OK);
        assert_int_equal(step(&second, 0.01, knuckle_at(i)), MRT_OK);
        assert_memory_equal(first.pull.vector, second.pull.vector, 2 * sizeof(mrt_vector));
    }
    end(&first);
    end(&second);
}

static void what_is_resumed_goes_on_to_the_bit(void **state)
{
    (void)state;
    mrt_face face = face_of(2, 2);
    const mrt_resume *resume = interface_of(MRT_RESUME);
    scene first, second;
    unsigned char bytes[64];
    begin(&first, &face);
    begin(&second, &face);
    for (int i = 0; i < FRAMES / 2; ++i)
        assert_int_equal(step(&first, 0.01, knuckle_at(i)), MRT_OK);
    size_t size = resume->save(first.plugin, bytes, sizeof bytes);
    assert_in_range(size, 1, sizeof bytes);
    assert_int_equal(resume->load(second.plugin, bytes, size), MRT_OK);
    for (int i = FRAMES / 2; i < FRAMES; ++i) {
        assert_int_equal(step(&first, 0.01, knuckle_at(i)), MRT_OK);
        assert_int_equal(step(&second, 0.01, knuckle_at(i)), MRT_OK);
        assert_memory_equal(first.pull.vector, second.pull.vector, 2 * sizeof(mrt_vector));
    }
    end(&first);
    end(&second);
}

static void too_little_room_is_left_alone(void **state)
{
    (void)state;
    mrt_face face = face_of(2, 2);
    const mrt_resume *resume = interface_of(MRT_RESUME);
    scene s;
    unsigned char bytes[64], untouched[64];
    memset(bytes, 0x5a, sizeof bytes);
    memset(untouched, 0x5a, sizeof untouched);
    begin(&s, &face);
    size_t size = resume->save(s.plugin, NULL, 0);
    assert_in_range(size, 1, sizeof bytes);
    assert_int_equal(resume->save(s.plugin, bytes, size - 1), size);
    assert_memory_equal(bytes, untouched, sizeof bytes);
    end(&s);
}

static void bytes_from_elsewhere_are_refused_and_change_nothing(void **state)
{
    (void)state;
    mrt_face face = face_of(2, 2);
    const mrt_resume *resume = interface_of(MRT_RESUME);
    scene s;
    unsigned char good[64], bad[64], after[64];
    begin(&s, &face);
    assert_int_equal(step(&s, 0.02, 1.0f), MRT_OK);
    size_t size = resume->save(s.plugin, good, sizeof good);
    for (size_t cut = 0; cut < size; ++cut)
        assert_true(resume->load(s.plugin, good, cut) < 0);
    memset(bad, 0xff, sizeof bad); /* its number is none */
    assert_true(resume->load(s.plugin, bad, size) < 0);
    memcpy(bad, good, size - sizeof(float));
    assert_true(resume->load(s.plugin, bad, size) < 0);
    assert_true(resume->load(s.plugin, bad, size + 1) < 0);
    assert_int_equal(resume->save(s.plugin, after, sizeof after), size);
    assert_memory_equal(good, after, size);
    end(&s);
}

static void destroying_nothing_is_fine(void **state)
{
    (void)state;
    type->destroy(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_fist_pushes_contacts_along_their_normals),
        cmocka_unit_test(a_flat_hand_leaves_the_face_at_rest),
        cmocka_unit_test(a_hand_that_appears_does_not_make_the_face_jump),
        cmocka_unit_test(without_easing_it_follows_at_once_and_never_divides_by_nothing),
        cmocka_unit_test(a_face_without_contacts_is_pulled_at_its_front),
        cmocka_unit_test(more_contacts_than_vectors_fill_the_pull_and_no_more),
        cmocka_unit_test(a_left_hand_does_as_well),
        cmocka_unit_test(after_reset_the_same_samples_give_the_same_pulls),
        cmocka_unit_test(what_is_resumed_goes_on_to_the_bit),
        cmocka_unit_test(too_little_room_is_left_alone),
        cmocka_unit_test(bytes_from_elsewhere_are_refused_and_change_nothing),
        cmocka_unit_test(destroying_nothing_is_fine),
    };
    return cmocka_run_group_tests(tests, load_library, NULL);
}
