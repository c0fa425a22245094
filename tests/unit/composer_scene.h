/* What the tests of the composer share: a face, and those who speak to it. mm. */
#ifndef MAROTTE_TESTS_COMPOSER_SCENE_H
#define MAROTTE_TESTS_COMPOSER_SCENE_H
#include "unit/resume_scene.h"

typedef struct fixture {
    face_file file;
    composer *composer;
    mrt_pull pull[COMPOSER_PARTS_MAX];
    composer_part part[COMPOSER_PARTS_MAX];
    uint32_t count;
} fixture;

static inline void fixture_set_up(fixture *d, const char *face_name)
{
    error err = {""};
    const csrbf_settings solver = {.radius = 0};
    *d = (fixture){.count = 0};
    scene_face(&d->file, face_name);
    scene_must(composer_create(&d->composer, &d->file, &solver, &err), &err);
}

static inline void fixture_tear_down(fixture *d)
{
    composer_destroy(d->composer);
    face_file_destroy(&d->file);
}

static inline mrt_pull *fixture_add_part(fixture *d, uint32_t slot, uint32_t lane)
{
    mrt_pull *pull = &d->pull[d->count];
    *pull = (mrt_pull){.mode = MRT_ANCHORED};
    for (int i = 0; i < MRT_MAX_DOFS; ++i)
        pull->dof[i] = NAN;
    d->part[d->count++] = (composer_part){
        .slot = slot, .layer = lane, .is_fresh = true, .weight = 1.0, .gain = 1.0, .pull = pull};
    return pull;
}

static inline void fixture_move(fixture *d)
{
    composer_move(d->composer, d->part, d->count, 0.01);
}

static inline uint64_t fixture_shown(fixture *d)
{
    composer_draw(d->composer);
    assert_int_equal(composer_get_counts(d->composer)->held_pulls, 0);
    return scene_hash(composer_face(d->composer));
}

static inline void fixture_go(fixture *d, uint32_t index)
{
    d->part[index] = d->part[d->count - 1];
    d->count -= 1;
}

static inline uint32_t fixture_contact_named(const fixture *d, const char *name)
{
    const mrt_face *about = composer_about(d->composer);
    for (uint32_t i = 0; i < about->contact_count; ++i)
        if (strcmp(about->contacts[i].name, name) == 0)
            return i + 1;
    fail_msg("no %s", name);
    return 0;
}

static inline void fixture_hold_contact(const fixture *d, mrt_pull *pull, const char *name, float x,
                                        float y, float z)
{
    uint32_t contact = fixture_contact_named(d, name);
    mrt_vec3 at = composer_about(d->composer)->contacts[contact - 1].rest;
    pull->vector[pull->count++] = (mrt_vector){at, {at.x + x, at.y + y, at.z + z}, contact};
}

static inline void fixture_hold_point(mrt_pull *pull, mrt_vec3 at, float z)
{
    pull->vector[pull->count++] = (mrt_vector){at, {at.x, at.y, at.z + z}, 0};
}

static inline void fixture_push(mrt_pull *pull, uint32_t vector, float z)
{
    pull->vector[vector].end.z = pull->vector[vector].start.z + z;
}

/* How far a contact is from its rest. */
static inline vec3 fixture_way_of(fixture *d, const char *name)
{
    uint32_t contact = fixture_contact_named(d, name);
    composer_draw(d->composer);
    mrt_vec3 rest = composer_about(d->composer)->contacts[contact - 1].rest;
    vec3 at = face_contact_now(composer_face(d->composer), contact);
    return (vec3){at.x - (double)rest.x, at.y - (double)rest.y, at.z - (double)rest.z};
}

static inline void fixture_expect_way(fixture *d, const char *name, double x, double y, double z,
                                      double within)
{
    vec3 way = fixture_way_of(d, name);
    double off = vec3_length(vec3_sub(way, (vec3){x, y, z}));
    if (!(off <= within))
        fail_msg("%s has gone (%g, %g, %g) instead of (%g, %g, %g)", name, way.x, way.y, way.z, x,
                 y, z);
}

/* Of the plane: how far the vertex nearest to a place of the rest shape has gone out. */
static inline double fixture_height_at(fixture *d, mrt_vec3 position)
{
    composer_draw(d->composer);
    const points *rest = face_rest(composer_face(d->composer)),
                 *now = face_shown(composer_face(d->composer));
    uint32_t best = 0;
    float least = INFINITY;
    for (uint32_t i = 0; i < rest->count; ++i) {
        float x = rest->x[i] - position.x, y = rest->y[i] - position.y;
        if (x * x + y * y < least) {
            least = x * x + y * y;
            best = i;
        }
    }
    return (double)now->z[best] - (double)rest->z[best];
}

static inline void fixture_expect_height(fixture *d, mrt_vec3 position, double height,
                                         double within)
{
    double is = fixture_height_at(d, position);
    if (!(fabs(is - height) <= within))
        fail_msg("the face is %g mm out at (%g, %g) instead of %g", is, (double)position.x,
                 (double)position.y, height);
}

/* At vertices of the plane: row 11, columns 5 and 18. */
static const mrt_vec3 fixture_left_position = {42.0f, 95.7f, 52.944f};
static const mrt_vec3 fixture_right_position = {-42.5f, 95.7f, 52.775f};
static const double fixture_near_mm = 0.02;

static const char *const fixture_mouth[] = {"mouth.corner.l", "mouth.corner.r", "lip.upper.mid",
                                            "lip.lower.mid"};
static const char *const fixture_brows[] = {"brow.inner.l", "brow.inner.r", "brow.mid.l",
                                            "brow.mid.r"};

static inline void fixture_hold_mouth(const fixture *d, mrt_pull *pull, float amount)
{
    for (int i = 0; i < 4; ++i)
        fixture_hold_contact(d, pull, fixture_mouth[i], amount * (float)(i - 1), 0.5f * amount,
                             2.0f * amount);
}

static inline void fixture_hold_brows(const fixture *d, mrt_pull *pull, float amount)
{
    for (int i = 0; i < 4; ++i)
        fixture_hold_contact(d, pull, fixture_brows[i], 0, 3.0f * amount, 0.4f * amount);
}

#endif
