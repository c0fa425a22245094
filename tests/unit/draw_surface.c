/* Which surface a material is drawn as. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "draw/face.h"

static surface surface_named(const char *name, float roughness, float metallic)
{
    char copy[64] = "";
    for (size_t i = 0; name && i + 1 < sizeof copy && name[i]; ++i)
        copy[i] = name[i];
    mesh_material m = {.name = name ? copy : NULL,
                       .base_colour = {0.5f, 0.5f, 0.5f, 1.0f},
                       .roughness = roughness,
                       .metallic = metallic,
                       .has_roughness = true};
    return surface_of(&m);
}

static void dry_materials_that_say_so_have_a_grain(void **state)
{
    (void)state;
    assert_int_equal(surface_named("stone", 0.95f, 0).kind, SURFACE_STONE);
    assert_int_equal(surface_named("", 0.95f, 0).kind, SURFACE_SMOOTH);
    assert_int_equal(surface_named(NULL, 0.95f, 0).kind, SURFACE_SMOOTH);
    assert_int_equal(surface_named("skin", 0.88f, 0).kind, SURFACE_FELT);
    assert_int_equal(surface_named("Felt.001", 0.9f, 0).kind, SURFACE_FELT);
    assert_int_equal(surface_named("lid_upper.l", 0.85f, 0).kind, SURFACE_FELT);
}

static void a_default_roughness_makes_no_felt(void **state)
{
    (void)state;
    char name[] = "skin";
    mesh_material m = mesh_material_grey();
    m.name = name;
    m.roughness = 1.0f;
    assert_int_equal(surface_of(&m).kind, SURFACE_SMOOTH);
    m.has_roughness = true;
    assert_int_equal(surface_of(&m).kind, SURFACE_FELT);
    m.base.image = 1; /* it has colours of its own */
    assert_int_equal(surface_of(&m).kind, SURFACE_PAINTED);
}

static void words_are_whole_words(void **state)
{
    (void)state;
    assert_int_equal(surface_named("moraine solid", 0.9f, 0).kind, SURFACE_SMOOTH);
    assert_int_equal(surface_named("earth", 0.9f, 0).kind, SURFACE_SMOOTH);
    assert_int_equal(surface_named("left ears", 0.9f, 0).kind, SURFACE_FELT);
    assert_int_equal(surface_named("stone.skin", 0.9f, 0).kind, SURFACE_STONE);
}

static void what_is_smoother_is_smooth(void **state)
{
    (void)state;
    assert_int_equal(surface_named("skin", 0.8f, 0).kind, SURFACE_SMOOTH);
    assert_true(surface_named("skin", 0.6f, 0).softness > 0.9f);
    assert_true(surface_named("eye.l", 0.15f, 0).softness < 0.1f);
    assert_true(surface_named("eye.l", 0.15f, 0).coat < 0.1f);
}

static void mouths_are_wet(void **state)
{
    (void)state;
    assert_true(surface_named("tongue", 0.6f, 0).coat > 0.9f);
    assert_true(surface_named("teeth_upper", 0.35f, 0).coat > 0.9f);
    assert_true(surface_named("nose", 0.6f, 0).coat < 0.1f);
}

static void the_lamps_are_seen_in_eyes(void **state)
{
    (void)state;
    assert_true(surface_named("eye.l.iris", 0.12f, 0).cornea > 0.9f);
    assert_true(surface_named("Eyeball", 0.3f, 0).cornea > 0.9f);
    assert_true(surface_named("eye.l", 0.7f, 0).cornea == 0.0f); /* of cloth */
    assert_true(surface_named("teeth_upper", 0.35f, 0).cornea == 0.0f);
}

static void only_thick_felt_has_a_nap(void **state)
{
    (void)state;
    assert_true(surface_named("skin", 0.88f, 0).has_nap);
    assert_true(surface_named("brow.l", 0.95f, 0).has_nap);
    assert_false(surface_named("lid_upper.l", 0.88f, 0).has_nap);
    assert_false(surface_named("skin.lips", 0.88f, 0).has_nap);
    assert_false(surface_named("stone", 0.95f, 0).has_nap);
    assert_false(surface_named("skin", 0.6f, 0).has_nap); /* of people */
}

static void metal_is_metal(void **state)
{
    (void)state;
    surface s = surface_named("felt teeth", 0.9f, 1.0f);
    assert_int_equal(s.kind, SURFACE_SMOOTH);
    assert_true(s.softness == 0.0f && s.coat == 0.0f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(dry_materials_that_say_so_have_a_grain),
        cmocka_unit_test(a_default_roughness_makes_no_felt),
        cmocka_unit_test(words_are_whole_words),
        cmocka_unit_test(what_is_smoother_is_smooth),
        cmocka_unit_test(mouths_are_wet),
        cmocka_unit_test(the_lamps_are_seen_in_eyes),
        cmocka_unit_test(only_thick_felt_has_a_nap),
        cmocka_unit_test(metal_is_metal),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
