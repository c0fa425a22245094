/* The pulls of several layers on one face: who owns what, who lies over whom, what stays when
 * somebody goes. mm. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "unit/allocation_count.h"
#include "unit/resume_scene.h"

/* ---- a face, and those who speak ---- */

typedef struct desk {
    face_file file;
    composer *composer;
    mrt_pull pull[COMPOSER_PARTS_MAX];
    composer_part part[COMPOSER_PARTS_MAX];
    uint32_t count;
} desk;

static void set_up(desk *d, const char *face_name)
{
    error err = {""};
    const csrbf_settings solver = {.radius = 0};
    *d = (desk){.count = 0};
    scene_face(&d->file, face_name);
    scene_must(composer_create(&d->composer, &d->file, &solver, &err), &err);
}

static void tear_down(desk *d)
{
    composer_destroy(d->composer);
    face_file_destroy(&d->file);
}

static mrt_pull *add_part(desk *d, uint32_t slot, uint32_t lane)
{
    mrt_pull *pull = &d->pull[d->count];
    *pull = (mrt_pull){.mode = MRT_ANCHORED};
    for (int i = 0; i < MRT_MAX_DOFS; ++i)
        pull->dof[i] = NAN;
    d->part[d->count++] = (composer_part){
        .slot = slot, .layer = lane, .is_fresh = true, .weight = 1.0, .gain = 1.0, .pull = pull};
    return pull;
}

static void move(desk *d)
{
    composer_move(d->composer, d->part, d->count, 0.01);
}

static uint64_t shown(desk *d)
{
    composer_draw(d->composer);
    assert_int_equal(composer_counted(d->composer)->held_pulls, 0);
    return scene_hash(composer_face(d->composer));
}

static void go(desk *d, uint32_t index)
{
    d->part[index] = d->part[d->count - 1];
    d->count -= 1;
}

static uint32_t contact_named(const desk *d, const char *name)
{
    const mrt_face *about = composer_about(d->composer);
    for (uint32_t i = 0; i < about->contact_count; ++i)
        if (strcmp(about->contacts[i].name, name) == 0)
            return i + 1;
    fail_msg("no %s", name);
    return 0;
}

static void hold_contact(const desk *d, mrt_pull *pull, const char *name, float x, float y, float z)
{
    uint32_t contact = contact_named(d, name);
    mrt_vec3 at = composer_about(d->composer)->contacts[contact - 1].rest;
    pull->vector[pull->count++] = (mrt_vector){at, {at.x + x, at.y + y, at.z + z}, contact};
}

static void hold_point(mrt_pull *pull, mrt_vec3 at, float z)
{
    pull->vector[pull->count++] = (mrt_vector){at, {at.x, at.y, at.z + z}, 0};
}

static void push(mrt_pull *pull, uint32_t vector, float z)
{
    pull->vector[vector].end.z = pull->vector[vector].start.z + z;
}

/* How far a contact is from its rest. */
static vec3 way_of(desk *d, const char *name)
{
    uint32_t contact = contact_named(d, name);
    composer_draw(d->composer);
    mrt_vec3 rest = composer_about(d->composer)->contacts[contact - 1].rest;
    vec3 at = face_contact_now(composer_face(d->composer), contact);
    return (vec3){at.x - (double)rest.x, at.y - (double)rest.y, at.z - (double)rest.z};
}

static void expect_way(desk *d, const char *name, double x, double y, double z, double within)
{
    vec3 way = way_of(d, name);
    double off = vec3_length(vec3_sub(way, (vec3){x, y, z}));
    if (!(off <= within))
        fail_msg("%s has gone (%g, %g, %g) instead of (%g, %g, %g)", name, way.x, way.y, way.z, x,
                 y, z);
}

/* Of the plane: how far the vertex nearest to a place of the rest shape has gone out. */
static double height_at(desk *d, mrt_vec3 place)
{
    composer_draw(d->composer);
    const points *rest = face_rest(composer_face(d->composer)),
                 *now = face_shown(composer_face(d->composer));
    uint32_t best = 0;
    float least = INFINITY;
    for (uint32_t i = 0; i < rest->count; ++i) {
        float x = rest->x[i] - place.x, y = rest->y[i] - place.y;
        if (x * x + y * y < least) {
            least = x * x + y * y;
            best = i;
        }
    }
    return (double)now->z[best] - (double)rest->z[best];
}

static void expect_height(desk *d, mrt_vec3 place, double height, double within)
{
    double is = height_at(d, place);
    if (!(fabs(is - height) <= within))
        fail_msg("the face is %g mm out at (%g, %g) instead of %g", is, (double)place.x,
                 (double)place.y, height);
}

/* At vertices of the plane: row 11, columns 5 and 18. */
static const mrt_vec3 left_place = {42.0f, 95.7f, 52.944f};
static const mrt_vec3 right_place = {-42.5f, 95.7f, 52.775f};
static const double near_mm = 0.02;

/* ---- owning ---- */

static const char *const mouth[] = {"mouth.corner.l", "mouth.corner.r", "lip.upper.mid",
                                    "lip.lower.mid"};
static const char *const brows[] = {"brow.inner.l", "brow.inner.r", "brow.mid.l", "brow.mid.r"};

static void hold_mouth(const desk *d, mrt_pull *pull, float amount)
{
    for (int i = 0; i < 4; ++i)
        hold_contact(d, pull, mouth[i], amount * (float)(i - 1), 0.5f * amount, 2.0f * amount);
}

static void hold_brows(const desk *d, mrt_pull *pull, float amount)
{
    for (int i = 0; i < 4; ++i)
        hold_contact(d, pull, brows[i], 0, 3.0f * amount, 0.4f * amount);
}

static void layers_that_own_different_contacts_give_what_one_pull_gives(void **state)
{
    (void)state;
    desk one, two;
    set_up(&one, "puppet");
    set_up(&two, "puppet");
    mrt_pull *all = add_part(&one, 0, 0);
    mrt_pull *low = add_part(&two, 3, 0), *high = add_part(&two, 1, 1);
    uint64_t before = 0;
    for (int n = 0; n < 20; ++n) {
        float amount = 0.15f * (float)n;
        all->count = low->count = high->count = 0;
        hold_mouth(&one, all, amount);
        hold_brows(&one, all, 2.0f - amount);
        hold_mouth(&two, low, amount);
        hold_brows(&two, high, 2.0f - amount);
        all->dof[0] = low->dof[0] = 0.01f * (float)n;
        move(&one);
        move(&two);
        uint64_t now = shown(&one);
        assert_true(now == shown(&two));
        assert_true(now != before);
        before = now;
    }
    tear_down(&one);
    tear_down(&two);
}

/* What a layer does not own it does not move, whatever its pull says. */
static void a_layer_moves_only_what_it_owns(void **state)
{
    (void)state;
    desk all, some;
    set_up(&all, "puppet");
    set_up(&some, "puppet");
    const mrt_face *about = composer_about(some.composer);
    uint8_t owns[256] = {0};
    assert_true(about->contact_count + about->dof_count < sizeof owns);
    for (int i = 0; i < 4; ++i)
        owns[contact_named(&some, brows[i]) - 1] = 1;
    mrt_pull *only_brows = add_part(&all, 0, 0), *everything = add_part(&some, 0, 0);
    hold_brows(&all, only_brows, 1.5f);
    hold_brows(&some, everything, 1.5f);
    hold_mouth(&some, everything, 2.0f);
    hold_point(everything, about->contacts[contact_named(&some, "nose.tip") - 1].rest, 3.0f);
    everything->dof[0] = 0.3f;
    some.part[0].owns = owns;
    move(&all);
    move(&some);
    assert_true(shown(&all) == shown(&some));
    tear_down(&all);
    tear_down(&some);
}

/* ---- over each other ---- */

static void a_later_layer_replaces_an_additive_one_adds(void **state)
{
    (void)state;
    desk d;
    set_up(&d, "puppet");
    mrt_pull *below = add_part(&d, 0, 0), *above = add_part(&d, 1, 1);
    hold_contact(&d, below, "brow.mid.l", 0, 2, 1);
    hold_contact(&d, below, "brow.mid.r", 0, 2, 1);
    hold_contact(&d, above, "brow.mid.l", 1, -3, 2);
    below->dof[0] = above->dof[0] = 0.0f;
    move(&d);
    expect_way(&d, "brow.mid.l", 1, -3, 2, near_mm);
    expect_way(&d, "brow.mid.r", 0, 2, 1, near_mm);
    d.part[1].is_additive = true;
    move(&d);
    expect_way(&d, "brow.mid.l", 1, -1, 3, near_mm);
    expect_way(&d, "brow.mid.r", 0, 2, 1, near_mm);
    tear_down(&d);
}

static void weights_blend_linearly_and_gains_multiply(void **state)
{
    (void)state;
    desk d;
    set_up(&d, "puppet");
    mrt_pull *below = add_part(&d, 0, 0), *above = add_part(&d, 1, 1);
    hold_contact(&d, below, "brow.mid.l", 0, 2, 1);
    hold_contact(&d, above, "brow.mid.l", 1, -2, 2);
    for (int n = 0; n <= 10; ++n) {
        double w = 0.1 * n;
        d.part[1].weight = w;
        move(&d);
        expect_way(&d, "brow.mid.l", w, 2 - 4 * w, 1 + w, near_mm);
    }
    d.part[1].weight = 0.25;
    d.part[1].gain = 2.0; /* of what it adds, not of what it takes away */
    move(&d);
    expect_way(&d, "brow.mid.l", 0.5, 0.75 * 2 - 1, 0.75 + 1, near_mm);
    d.part[0].weight = 0.5; /* towards the rest */
    d.part[1].weight = 0.0;
    move(&d);
    expect_way(&d, "brow.mid.l", 0, 1, 0.5, near_mm);
    d.part[0].weight = 1.0;
    d.part[0].gain = 1.5;
    move(&d);
    expect_way(&d, "brow.mid.l", 0, 3, 1.5, near_mm);
    tear_down(&d);
}

/* Two clips of one layer cross-fade: their weights sum to 1. */
static void parts_of_one_layer_share_it(void **state)
{
    (void)state;
    desk d;
    set_up(&d, "puppet");
    mrt_pull *below = add_part(&d, 2, 0), *out = add_part(&d, 0, 1), *in = add_part(&d, 1, 1);
    hold_contact(&d, below, "brow.mid.l", 0, 0, 4);
    hold_contact(&d, out, "brow.mid.l", 0, 2, 0);
    hold_contact(&d, in, "brow.mid.l", 0, -2, 1);
    for (int n = 0; n <= 4; ++n) {
        d.part[1].weight = 1.0 - 0.25 * n;
        d.part[2].weight = 0.25 * n;
        move(&d);
        expect_way(&d, "brow.mid.l", 0, 2 - n, 0.25 * n, near_mm); /* nothing from below */
    }
    tear_down(&d);
}

static void degrees_of_freedom_are_laid_over_each_other_too(void **state)
{
    (void)state;
    desk d;
    set_up(&d, "puppet");
    const mrt_face *about = composer_about(d.composer);
    uint32_t open = 0;
    while (open < about->dof_count && strcmp(about->dofs[open].name, "jaw.open") != 0)
        open += 1;
    assert_true(open < about->dof_count);
    mrt_pull *below = add_part(&d, 0, 0), *above = add_part(&d, 1, 1);
    hold_contact(&d, below, "brow.mid.l", 0, 0, 0);
    hold_contact(&d, above, "brow.mid.r", 0, 0, 0);
    below->dof[open] = 0.2f;
    move(&d);
    const float *dof = face_metered(composer_face(d.composer))->dof;
    assert_true(fabs((double)dof[open] - 0.2) < 1e-3); /* the one above says nothing */
    above->dof[open] = 0.1f;
    move(&d);
    assert_true(fabs((double)dof[open] - 0.1) < 1e-3);
    d.part[1].weight = 0.5;
    move(&d);
    assert_true(fabs((double)dof[open] - 0.15) < 1e-3);
    d.part[1].is_additive = true;
    d.part[1].weight = 1.0;
    above->dof[open] = 0.05f;
    move(&d);
    assert_true(fabs((double)dof[open] - 0.25) < 1e-3);
    tear_down(&d);
}

/* ---- coming and going ---- */

static void who_goes_leaves_nothing_behind(void **state)
{
    (void)state;
    static const char *const faces[] = {"plane", "puppet"};
    for (int i = 0; i < 2; ++i) {
        desk d, alone;
        set_up(&d, faces[i]);
        set_up(&alone, faces[i]);
        const mrt_face *about = composer_about(d.composer);
        mrt_vec3 first = i == 0 ? left_place : about->contacts[0].rest;
        mrt_vec3 second = i == 0 ? right_place : about->contacts[1].rest;
        uint64_t at_rest = shown(&d);
        mrt_pull *a = add_part(&d, 0, 0), *b = add_part(&d, 5, 1), *own = add_part(&alone, 5, 1);
        hold_point(a, first, 6.0f);
        hold_point(b, second, 3.0f);
        hold_point(own, second, 3.0f);
        move(&d);
        move(&alone);
        uint64_t with_both = shown(&d);
        go(&d, 0); /* b stays */
        move(&d);
        composer_draw(d.composer);
        composer_draw(alone.composer);
        assert_true(shown(&d) != with_both);
        assert_true(scene_distance(face_shown(composer_face(d.composer)),
                                   face_shown(composer_face(alone.composer))) < 1e-4);
        d.count = 0;
        move(&d);
        assert_true(i == 1 || shown(&d) == at_rest);
        composer_draw(d.composer);
        assert_true(scene_distance(face_shown(composer_face(d.composer)),
                                   face_rest(composer_face(d.composer))) < 1e-4);
        tear_down(&d);
        tear_down(&alone);
    }
}

/* Its new starts are where it had pulled the face to; what the others pull is not baked. */
static void who_anchors_anew_bakes_only_its_own(void **state)
{
    (void)state;
    desk d;
    set_up(&d, "plane");
    mrt_pull *a = add_part(&d, 0, 0), *b = add_part(&d, 1, 1);
    a->radius_mm = b->radius_mm = 30.0f;
    hold_point(a, left_place, 0.0f);
    hold_point(b, right_place, 0.0f);
    move(&d);
    push(a, 0, 5.0f);
    push(b, 0, 3.0f);
    move(&d);
    expect_height(&d, left_place, 5, near_mm);
    expect_height(&d, right_place, 3, near_mm);
    uint64_t before = composer_counted(d.composer)->engagements;
    a->anchor += 1;
    a->vector[0].start = a->vector[0].end;
    move(&d);
    assert_int_equal(composer_counted(d.composer)->engagements, before + 1);
    expect_height(&d, left_place, 5, near_mm); /* nothing jumps */
    expect_height(&d, right_place, 3, near_mm);
    push(a, 0, 1.0f);
    push(b, 0, 2.0f);
    move(&d);
    expect_height(&d, left_place, 6, near_mm);
    expect_height(&d, right_place, 2, near_mm);
    d.count = 0;
    move(&d);
    expect_height(&d, left_place, 5, near_mm);
    expect_height(&d, right_place, 0, near_mm);
    tear_down(&d);
}

static void who_commits_bakes_only_its_own(void **state)
{
    (void)state;
    desk d;
    set_up(&d, "plane");
    mrt_pull *a = add_part(&d, 0, 0), *b = add_part(&d, 1, 1);
    a->radius_mm = b->radius_mm = 30.0f;
    hold_point(a, left_place, 5.0f);
    hold_point(b, right_place, 3.0f);
    move(&d);
    a->commit += 1;
    a->anchor += 1;
    a->vector[0].start = a->vector[0].end;
    move(&d);
    assert_int_equal(composer_counted(d.composer)->commits, 1);
    expect_height(&d, left_place, 5, near_mm);
    expect_height(&d, right_place, 3, near_mm);
    d.count = 0;
    move(&d);
    expect_height(&d, left_place, 5, near_mm);
    expect_height(&d, right_place, 0, near_mm);
    tear_down(&d);
}

/* It has nothing more to say: what is in the base is not pulled once more when another moves. */
static void who_commits_and_idles_is_not_pulled_twice(void **state)
{
    (void)state;
    desk d;
    set_up(&d, "plane");
    mrt_pull *a = add_part(&d, 0, 0), *b = add_part(&d, 1, 1);
    a->radius_mm = b->radius_mm = 30.0f;
    hold_point(a, left_place, 5.0f);
    hold_point(b, right_place, 3.0f);
    move(&d);
    a->mode = MRT_IDLE;
    b->mode = MRT_IDLE;
    a->commit += 1;
    move(&d);
    expect_height(&d, left_place, 5, near_mm);
    expect_height(&d, right_place, 3, near_mm); /* who only idles goes on holding */
    b->mode = MRT_ANCHORED;
    push(b, 0, 2.0f);
    move(&d);
    expect_height(&d, left_place, 5, near_mm);
    expect_height(&d, right_place, 2, near_mm);
    tear_down(&d);
}

static void idle_holds_what_was_pulled(void **state)
{
    (void)state;
    desk d;
    set_up(&d, "plane");
    mrt_pull *a = add_part(&d, 0, 0), *b = add_part(&d, 1, 1);
    hold_point(a, left_place, 5.0f);
    hold_point(b, right_place, 3.0f);
    move(&d);
    uint64_t held = shown(&d);
    a->mode = MRT_IDLE;
    a->count = 0;
    for (int n = 0; n < 5; ++n)
        move(&d);
    assert_true(shown(&d) == held);
    d.part[0].weight = 0.5; /* but it fades */
    move(&d);
    assert_true(height_at(&d, left_place) < 4.0);
    tear_down(&d);
}

/* ---- kneading ---- */

static void knead_to(mrt_pull *pull, float z)
{
    pull->vector[0].start = pull->vector[0].end;
    pull->vector[0].end.z = left_place.z + z;
}

static void a_kneaded_face_carries_what_anchored_layers_add(void **state)
{
    (void)state;
    desk d, alone;
    set_up(&d, "plane");
    set_up(&alone, "plane");
    mrt_pull *clay = add_part(&d, 0, 0), *over = add_part(&d, 1, 1);
    mrt_pull *only = add_part(&alone, 0, 0);
    clay->mode = only->mode = MRT_UNANCHORED;
    clay->radius_mm = only->radius_mm = over->radius_mm = 30.0f;
    hold_point(clay, left_place, 0.0f);
    hold_point(only, left_place, 0.0f);
    hold_point(over, right_place, 3.0f);
    for (int n = 0; n < 40; ++n) {
        float z = 0.15f * (float)n;
        knead_to(clay, z);
        knead_to(only, z);
        d.part[0].is_fresh = alone.part[0].is_fresh = true;
        move(&d);
        move(&alone);
        d.part[0].is_fresh = false;
        push(over, 0, 3.0f + 0.02f * (float)n);
        move(&d); /* a sample of the other alone */
        expect_height(&d, left_place, height_at(&alone, left_place), near_mm);
        expect_height(&d, right_place, 3.0 + 0.02 * n, near_mm);
    }
    assert_true(height_at(&alone, left_place) > 4.0);
    go(&d, 1); /* the one above goes: what was kneaded is left */
    move(&d);
    composer_draw(d.composer);
    composer_draw(alone.composer);
    assert_true(scene_distance(face_shown(composer_face(d.composer)),
                               face_shown(composer_face(alone.composer))) < 0.01);
    tear_down(&d);
    tear_down(&alone);
}

/* A sample of another layer is none of the kneading one's. */
static void a_pull_that_was_heard_before_does_not_knead_again(void **state)
{
    (void)state;
    desk d;
    set_up(&d, "plane");
    mrt_pull *clay = add_part(&d, 0, 0);
    clay->mode = MRT_UNANCHORED;
    clay->radius_mm = 30.0f;
    hold_point(clay, left_place, 0.0f);
    move(&d);
    knead_to(clay, 2.0f);
    move(&d);
    uint64_t once = shown(&d);
    d.part[0].is_fresh = false;
    for (int n = 0; n < 5; ++n)
        move(&d);
    assert_true(shown(&d) == once);
    tear_down(&d);
}

/* ---- limits ---- */

static void vectors_beyond_the_limit_are_counted(void **state)
{
    (void)state;
    desk d;
    set_up(&d, "plane");
    mrt_pull *pulls[2] = {add_part(&d, 0, 0), add_part(&d, 1, 1)};
    for (int p = 0; p < 2; ++p)
        for (int i = 0; i < 40; ++i)
            hold_point(pulls[p],
                       (mrt_vec3){-70.0f + 3.5f * (float)i, 30.0f + 100.0f * (float)p, 55.0f},
                       1.0f);
    move(&d);
    assert_int_equal(composer_counted(d.composer)->left_out, 16);
    (void)shown(&d); /* none is held */
    go(&d, 0);
    move(&d);
    assert_int_equal(composer_counted(d.composer)->left_out, 16);
    tear_down(&d);
}

static void nothing_allocates_while_layers_come_and_go(void **state)
{
    (void)state;
    if (!ALLOCATIONS_ARE_COUNTED) {
        print_message("SKIPPED: the sanitizer has an allocator of its own\n");
        skip();
    }
    desk d;
    set_up(&d, "puppet");
    mrt_pull *low = add_part(&d, 0, 0), *high = add_part(&d, 1, 1), *clay = add_part(&d, 2, 2);
    unsigned char *bytes = malloc(4 << 20);
    assert_non_null(bytes);
    hold_mouth(&d, low, 1.0f);
    hold_brows(&d, high, 1.0f);
    clay->mode = MRT_UNANCHORED;
    clay->radius_mm = 20.0f;
    hold_point(clay, composer_about(d.composer)->contacts[0].rest, 0.0f);
    uint64_t before = atomic_load(&allocation_count);
    for (uint32_t n = 0; n < 60; ++n) {
        low->vector[0].end.y += 0.05f;
        clay->vector[0].start = clay->vector[0].end;
        clay->vector[0].end.z += 0.05f;
        low->anchor += n % 20 == 5;
        high->commit += n % 20 == 9;
        d.part[1].weight = n % 10 == 3 ? 0.5 : 1.0;
        d.count = n % 7 == 0 ? 1 : n % 3 == 0 ? 2 : 3;
        move(&d);
        composer_draw(d.composer);
        assert_true(composer_save(d.composer, bytes, 4 << 20) < 4 << 20);
    }
    assert_int_equal(atomic_load(&allocation_count) - before, 0);
    free(bytes);
    tear_down(&d);
}

/* ---- kept ---- */

static void tell(desk *d, uint32_t n)
{
    d->pull[0].vector[0].end.z += 0.1f;
    d->pull[1].vector[0].end.y += 0.07f;
    d->pull[2].vector[0].start = d->pull[2].vector[0].end;
    d->pull[2].vector[0].end.z += 0.2f;
    d->pull[0].anchor += n % 11 == 4;
    d->pull[1].commit += n % 13 == 6;
    d->pull[1].mode = n % 9 > 6 ? MRT_IDLE : MRT_ANCHORED;
    d->part[1].weight = n % 8 < 4 ? 1.0 : 0.7;
    d->part[2].is_fresh = n % 3 == 0;
    d->count = n % 10 == 7 ? 2 : 3;
    move(d);
}

static void layers_that_are_taken_up_go_on_with_the_same_bits(void **state)
{
    (void)state;
    enum { STEPS = 40 };
    for (uint32_t from = 0; from < STEPS; from += 3) {
        desk told, again;
        error err = {""};
        set_up(&told, "moai");
        set_up(&again, "moai");
        mrt_pull *low = add_part(&told, 0, 0), *high = add_part(&told, 1, 1),
                 *clay = add_part(&told, 2, 2);
        hold_mouth(&told, low, 0.5f);
        hold_brows(&told, high, 0.5f);
        clay->mode = MRT_UNANCHORED;
        clay->radius_mm = 25.0f;
        clay->leak_per_s = 0.2f;
        hold_point(clay, composer_about(told.composer)->contacts[3].rest, 0.0f);
        for (uint32_t n = 0; n <= from; ++n)
            tell(&told, n);
        size_t size = composer_save(told.composer, NULL, 0);
        unsigned char *bytes = malloc(size);
        assert_int_equal(composer_save(told.composer, bytes, size), size);
        scene_must(composer_load(again.composer, bytes, size, &err), &err);
        memcpy(again.pull, told.pull, sizeof again.pull);
        memcpy(again.part, told.part, sizeof again.part);
        again.count = told.count;
        for (uint32_t i = 0; i < 3; ++i)
            again.part[i].pull = &again.pull[i];
        for (uint32_t n = from + 1; n < STEPS; ++n) {
            tell(&told, n);
            tell(&again, n);
            if (shown(&told) != shown(&again))
                fail_msg("taken up after step %u: step %u differs", from, n);
        }
        free(bytes);
        tear_down(&told);
        tear_down(&again);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(layers_that_own_different_contacts_give_what_one_pull_gives),
        cmocka_unit_test(a_layer_moves_only_what_it_owns),
        cmocka_unit_test(a_later_layer_replaces_an_additive_one_adds),
        cmocka_unit_test(weights_blend_linearly_and_gains_multiply),
        cmocka_unit_test(parts_of_one_layer_share_it),
        cmocka_unit_test(degrees_of_freedom_are_laid_over_each_other_too),
        cmocka_unit_test(who_goes_leaves_nothing_behind),
        cmocka_unit_test(who_anchors_anew_bakes_only_its_own),
        cmocka_unit_test(who_commits_bakes_only_its_own),
        cmocka_unit_test(who_commits_and_idles_is_not_pulled_twice),
        cmocka_unit_test(idle_holds_what_was_pulled),
        cmocka_unit_test(a_kneaded_face_carries_what_anchored_layers_add),
        cmocka_unit_test(a_pull_that_was_heard_before_does_not_knead_again),
        cmocka_unit_test(vectors_beyond_the_limit_are_counted),
        cmocka_unit_test(nothing_allocates_while_layers_come_and_go),
        cmocka_unit_test(layers_that_are_taken_up_go_on_with_the_same_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
