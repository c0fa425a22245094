/* core/show/own.h: patterns, regions, and who speaks where several layers do. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "edit_help.h"

#include "face/bones.h"
#include "show/own.h"

#include <math.h>

typedef struct match {
    const char *pattern, *name;
    bool matches;
} match;

static void a_pattern_is_a_name_and_all_below_it(void **state)
{
    (void)state;
    static const match matches[] = {
        {"jaw", "jaw", true},
        {"jaw", "jaw.open", true},
        {"jaw", "jawline", false},
        {"jaw.*", "jaw", true},
        {"jaw.*", "jaw.angle.l", true},
        {"jaw.*", "jawline", false},
        {"jaw.open", "jaw.open", true},
        {"jaw.open", "jaw.opening", false},
        {"jaw.open", "jaw", false},
        {"mouth.corner", "mouth.corner.l", true},
        {"mouth.corner", "mouth.corner2.l", false},
        {"mouth.corner*", "mouth.corner2.l", true},
        {"lid_*", "lid_upper.l.close", true},
        {"lid_*", "lid", false},
        {"*", "anything", true},
        {"*", "", true},
    };
    for (size_t i = 0; i < sizeof matches / sizeof matches[0]; ++i)
        if (own_matches(matches[i].pattern, matches[i].name) != matches[i].matches)
            fail_msg("%s, %s", matches[i].pattern, matches[i].name);
}

static void patterns_meet_if_a_name_matches_both(void **state)
{
    (void)state;
    static const match meetings[] = {
        {"jaw.*", "jaw.open", true},    {"jaw", "jaw.*", true},  {"jaw.*", "jawline", false},
        {"mouth.*", "mouth.co*", true}, {"*", "nose.tip", true}, {"mouth.*", "lip.*", false},
        {"brow.mid*", "brow.m*", true}, {"a.b", "a.b", true},    {"a.b", "a.c", false},
        {"lid_*", "lid_upper.l", true}, {"eye.*", "eye*", true}, {"eyes", "eye.*", false},
    };
    for (size_t i = 0; i < sizeof meetings / sizeof meetings[0]; ++i) {
        const match *m = &meetings[i];
        if (own_patterns_overlap(m->pattern, m->name) != m->matches ||
            own_patterns_overlap(m->name, m->pattern) != m->matches)
            fail_msg("%s, %s", m->pattern, m->name);
    }
}

static void patterns_are_told_from_other_texts(void **state)
{
    (void)state;
    static const char *const good[] = {"*", "jaw", "jaw.*", "mouth.corner.l", "lid_*", "\xc3\xa9"};
    static const char *const bad[] = {"", " ", "a b", "a*b", "**", ".jaw", "a\tb", "a\x7f"};
    for (size_t i = 0; i < sizeof good / sizeof good[0]; ++i)
        assert_true(own_is_pattern(good[i]));
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; ++i)
        assert_false(own_is_pattern(bad[i]));
}

/* ---- regions and the rigs ---- */

static uint32_t regions_of(const char *name)
{
    uint32_t count = 0;
    for (int region = 0; region < OWN_REGION_COUNT; ++region) {
        const own_part *part = own_part_of((own_region)region);
        bool owns = false;
        for (uint32_t i = 0; i < part->pattern_count; ++i)
            owns |= own_matches(part->pattern[i], name);
        count += owns;
    }
    return count;
}

static void require_one_region(const char *path, const char *name)
{
    if (regions_of(name) != 1)
        fail_msg("%s: %s belongs to %u regions", path, name, regions_of(name));
}

static void check_rig(const char *path)
{
    rig r;
    bones b;
    error err;
    if (rig_read_trusted(&r, path, &err) < 0 || bones_init(&b, &r, (vec3){0, 0, 0}, &err) < 0)
        fail_msg("%s", err.text);
    for (uint32_t i = 0; i < r.contact_count; ++i)
        require_one_region(path, r.contact[i].name);
    for (uint32_t i = 0; i < r.bone_count; ++i)
        require_one_region(path, r.bone[i].name);
    for (uint32_t i = 0; i < b.dof_count; ++i)
        require_one_region(path, b.dof[i].name);
    assert_true(r.contact_count >= 27 && b.dof_count >= 3);
    rig_destroy(&r);
}

static void every_name_of_our_rigs_belongs_to_one_region(void **state)
{
    (void)state;
    check_rig(SOURCE_DIR "/rigs/puppet/puppet.rig.json");
    check_rig(SOURCE_DIR "/rigs/moai/moai.rig.json");
    check_rig(SOURCE_DIR "/tests/face/ict.rig.json");
}

static void regions_are_found_by_their_names(void **state)
{
    (void)state;
    static const char *const names[] = {"mouth", "jaw",    "brows", "lids",
                                        "eyes",  "cheeks", "nose",  "head"};
    for (int i = 0; i < OWN_REGION_COUNT; ++i) {
        own_region region = OWN_REGION_COUNT;
        assert_true(own_region_named(names[i], &region));
        assert_int_equal(region, i);
        assert_string_equal(own_part_of(region)->name, names[i]);
    }
    own_region region;
    assert_false(own_region_named("ear", &region));
    assert_null(own_part_of(OWN_REGION_COUNT));
}

/* ---- layers ---- */

/* 'face' owns all; above it 'mouth' from 2 to 8 s, then 'corner' from 4 to 6 s. */
static take three_layers(void)
{
    take t = help_take();
    help_do(&t, "{'op':'layer.add','name':'mouth','own':['mouth.*']}");
    help_do(&t, "{'op':'clip.add','layer':3,'performance':8,'start_ns':2000m,'end_ns':8000m}");
    help_do(&t, "{'op':'clip.fade','clip':4,'fade_in_ns':1000m}");
    help_do(&t, "{'op':'layer.add','name':'corner','own':['mouth.corner.l']}");
    help_do(&t, "{'op':'clip.add','layer':5,'performance':9,'start_ns':4000m,'end_ns':6000m}");
    return t;
}

static void require_weights(const take *t, const char *name, int64_t at_ms, double face,
                            double mouth, double corner)
{
    double weight[3];
    own_weights(weight, t, name, at_ms * help_ms);
    if (fabs(weight[0] - face) > 1e-12 || fabs(weight[1] - mouth) > 1e-12 ||
        fabs(weight[2] - corner) > 1e-12)
        fail_msg("%s at %d ms: %g %g %g", name, (int)at_ms, weight[0], weight[1], weight[2]);
}

static void a_later_layer_takes_what_it_owns_where_it_shows_a_clip(void **state)
{
    (void)state;
    take t = three_layers();
    require_weights(&t, "mouth.corner.l", 1000, 1, 0, 0);
    require_weights(&t, "mouth.corner.l", 2250, 0.75, 0.25, 0);
    require_weights(&t, "mouth.corner.l", 3500, 0, 1, 0);
    require_weights(&t, "mouth.corner.l", 5000, 0, 0, 1);
    require_weights(&t, "mouth.corner.r", 5000, 0, 1, 0);
    require_weights(&t, "cheek.l", 5000, 1, 0, 0);
    require_weights(&t, "mouth.corner.l", 9000, 1, 0, 0);
    require_weights(&t, "mouth.corner.l", 11000, 0, 0, 0);
    take_finish(&t);
}

static void muted_layers_take_nothing_and_solo_silences_others(void **state)
{
    (void)state;
    take t = three_layers();
    help_do(&t, "{'op':'layer.mute','layer':5,'muted':true}");
    require_weights(&t, "mouth.corner.l", 5000, 0, 1, 0);
    help_do(&t, "{'op':'layer.solo','layer':1,'solo':true}");
    require_weights(&t, "mouth.corner.l", 5000, 1, 0, 0);
    help_do(&t, "{'op':'layer.solo','layer':5,'solo':true}");
    require_weights(&t, "mouth.corner.l", 5000, 1, 0, 0);
    assert_false(own_layer_is_active(&t, 2));
    help_do(&t, "{'op':'layer.mute','layer':5,'muted':false}");
    require_weights(&t, "mouth.corner.l", 5000, 0, 0, 1);
    take_finish(&t);
}

static void a_muted_clip_takes_nothing(void **state)
{
    (void)state;
    take t = three_layers();
    help_do(&t, "{'op':'clip.mute','clip':6,'muted':true}");
    require_weights(&t, "mouth.corner.l", 5000, 0, 1, 0);
    take_finish(&t);
}

static void an_additive_layer_leaves_what_is_below(void **state)
{
    (void)state;
    take t = three_layers();
    help_do(&t, "{'op':'layer.additive','layer':5,'additive':true}");
    require_weights(&t, "mouth.corner.l", 5000, 0, 1, 1);
    require_weights(&t, "mouth.corner.r", 5000, 0, 1, 0);
    take_finish(&t);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_pattern_is_a_name_and_all_below_it),
        cmocka_unit_test(patterns_meet_if_a_name_matches_both),
        cmocka_unit_test(patterns_are_told_from_other_texts),
        cmocka_unit_test(every_name_of_our_rigs_belongs_to_one_region),
        cmocka_unit_test(regions_are_found_by_their_names),
        cmocka_unit_test(a_later_layer_takes_what_it_owns_where_it_shows_a_clip),
        cmocka_unit_test(muted_layers_take_nothing_and_solo_silences_others),
        cmocka_unit_test(a_muted_clip_takes_nothing),
        cmocka_unit_test(an_additive_layer_leaves_what_is_below),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
