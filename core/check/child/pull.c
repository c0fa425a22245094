#include "check/child/pull.h"
#include "check/child/tell.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- what it may hold ---- */

static bool is_finite(mrt_vec3 p)
{
    return isfinite(p.x) && isfinite(p.y) && isfinite(p.z);
}

static double from_centre_mm(mrt_vec3 p, const double *centre)
{
    double x = (double)p.x - centre[0], y = (double)p.y - centre[1], z = (double)p.z - centre[2];
    return sqrt(x * x + y * y + z * z);
}

static bool judge_point(mrt_vec3 p, const char *what, uint32_t i, const pull_limits *limits,
                        const char *where)
{
    if (!is_finite(p)) {
        tell_failed(RULE_MAPPING_FINITE, "%s: the %s of vector %u is (%g, %g, %g)", where, what, i,
                    (double)p.x, (double)p.y, (double)p.z);
        return false;
    }
    double far_mm = from_centre_mm(p, limits->centre);
    if (far_mm <= limits->reach_mm)
        return true;
    tell_failed(RULE_MAPPING_REACH,
                "%s: the %s of vector %u is %.4g mm from the face's centre, the guard stops at "
                "%.4g mm",
                where, what, i, far_mm, limits->reach_mm);
    return false;
}

static bool judge_vectors(const mrt_pull *pull, const pull_limits *limits, const char *where)
{
    for (uint32_t i = 0; i < pull->count; ++i) {
        const mrt_vector *v = &pull->vector[i];
        if (!judge_point(v->start, "start", i, limits, where) ||
            !judge_point(v->end, "end", i, limits, where))
            return false;
        if (v->contact > limits->face->contact_count) {
            tell_failed(RULE_MAPPING_CONTACT,
                        "%s: vector %u pulls contact %u, the face has %u: 1 to %u, or 0", where, i,
                        v->contact, limits->face->contact_count, limits->face->contact_count);
            return false;
        }
    }
    return true;
}

static bool judge_scalars(const mrt_pull *pull, const char *where)
{
    bool is_good = true;
    if (!isfinite(pull->radius_mm) || pull->radius_mm < 0.0f) {
        tell_failed(RULE_MAPPING_RADIUS, "%s: radius_mm is %g", where, (double)pull->radius_mm);
        is_good = false;
    }
    if (!isfinite(pull->leak_per_s) || pull->leak_per_s < 0.0f) {
        tell_failed(RULE_MAPPING_LEAK, "%s: leak_per_s is %g", where, (double)pull->leak_per_s);
        is_good = false;
    }
    if (pull->gate > 1) {
        tell_failed(RULE_MAPPING_GATE, "%s: gate is %u", where, pull->gate);
        is_good = false;
    }
    for (int i = 0; i < MRT_MAX_DOFS; ++i)
        if (isinf(pull->dof[i])) {
            tell_failed(RULE_MAPPING_FINITE, "%s: dof[%d] is infinite", where, i);
            is_good = false;
        }
    return is_good;
}

bool pull_judge(const mrt_pull *pull, const pull_limits *limits, const char *where)
{
    if (pull->mode > MRT_UNANCHORED) {
        tell_failed(RULE_MAPPING_MODE, "%s: mode is %u", where, pull->mode);
        return false;
    }
    if (pull->count > MRT_MAX_VECTORS) {
        tell_failed(RULE_MAPPING_COUNT, "%s: count is %u, at most %d", where, pull->count,
                    MRT_MAX_VECTORS);
        return false;
    }
    bool is_good = judge_scalars(pull, where);
    return judge_vectors(pull, limits, where) && is_good;
}

/* ---- from one to the next ---- */

static bool is_same_point(mrt_vec3 a, mrt_vec3 b)
{
    return memcmp(&a, &b, sizeof a) == 0;
}

void pull_judge_anchor(const mrt_pull *before, const mrt_pull *now, const char *where)
{
    if (now->anchor != before->anchor)
        return;
    if (now->count != before->count)
        tell_failed(RULE_MAPPING_ANCHOR,
                    "%s: %u anchored vectors became %u, and anchor stayed at %u", where,
                    before->count, now->count, now->anchor);
    for (uint32_t i = 0; i < now->count && i < before->count; ++i)
        if (!is_same_point(now->vector[i].start, before->vector[i].start) ||
            now->vector[i].contact != before->vector[i].contact) {
            tell_failed(RULE_MAPPING_ANCHOR,
                        "%s: the start of vector %u (or its contact) changed, and anchor stayed at "
                        "%u",
                        where, i, now->anchor);
            return;
        }
}

static mrt_vec3 way_of(const mrt_vector *v)
{
    return (mrt_vec3){v->end.x - v->start.x, v->end.y - v->start.y, v->end.z - v->start.z};
}

static double distance_mm(mrt_vec3 a, mrt_vec3 b)
{
    double x = (double)a.x - (double)b.x, y = (double)a.y - (double)b.y;
    double z = (double)a.z - (double)b.z;
    return sqrt(x * x + y * y + z * z);
}

/* How far what this vector holds goes at once: from where the last hold of the same place had it,
 * or from where it is. */
static double jump_mm(const mrt_pull *before, const mrt_vector *v)
{
    mrt_vec3 way = way_of(v);
    double least = distance_mm(way, (mrt_vec3){0, 0, 0});
    for (uint32_t k = 0; before && k < before->count; ++k)
        if (before->vector[k].contact == v->contact &&
            is_same_point(before->vector[k].start, v->start))
            least = fmin(least, distance_mm(way, way_of(&before->vector[k])));
    return least;
}

void pull_judge_hold(const mrt_pull *before, const mrt_pull *now, double max_jump_mm,
                     const char *where)
{
    for (uint32_t i = 0; i < now->count; ++i) {
        double mm = jump_mm(before, &now->vector[i]);
        if (mm <= max_jump_mm)
            continue;
        tell_failed(RULE_MAPPING_JUMP,
                    "%s: a new hold begins %.3g mm away from where the face is (vector %u)", where,
                    mm, i);
        return;
    }
}

/* ---- the same ---- */

static uint64_t sum_on(uint64_t sum, const void *bytes, size_t size)
{
    const unsigned char *at = bytes;
    for (size_t i = 0; i < size; ++i)
        sum = (sum ^ at[i]) * UINT64_C(0x100000001b3);
    return sum;
}

/* NaNs are all alike: not driven. */
static float plain(float dof)
{
    return isnan(dof) ? NAN : dof;
}

uint64_t pull_sum(const mrt_pull *pull)
{
    uint64_t sum = UINT64_C(0xcbf29ce484222325);
    uint32_t count = pull->count < MRT_MAX_VECTORS ? pull->count : MRT_MAX_VECTORS;
    sum = sum_on(sum, pull, offsetof(mrt_pull, vector));
    sum = sum_on(sum, pull->vector, count * sizeof *pull->vector);
    for (int i = 0; i < MRT_MAX_DOFS; ++i) {
        float dof = plain(pull->dof[i]);
        sum = sum_on(sum, &dof, sizeof dof);
    }
    return sum;
}

static void say_points(char *out, size_t capacity, const char *what, uint32_t i, mrt_vec3 a,
                       mrt_vec3 b)
{
    (void)snprintf(out, capacity, "vector %u %s at (%.9g, %.9g, %.9g) and (%.9g, %.9g, %.9g)", i,
                   what, (double)a.x, (double)a.y, (double)a.z, (double)b.x, (double)b.y,
                   (double)b.z);
}

void pull_difference(const mrt_pull *a, const mrt_pull *b, char *out, size_t capacity)
{
    out[0] = '\0';
    if (pull_sum(a) == pull_sum(b))
        return;
    if (a->mode != b->mode || a->count != b->count) {
        (void)snprintf(out, capacity, "mode %u of %u vectors and mode %u of %u", a->mode, a->count,
                       b->mode, b->count);
        return;
    }
    if (a->anchor != b->anchor || a->commit != b->commit || a->gate != b->gate) {
        (void)snprintf(out, capacity, "anchor, commit, gate %u, %u, %u and %u, %u, %u", a->anchor,
                       a->commit, a->gate, b->anchor, b->commit, b->gate);
        return;
    }
    for (uint32_t i = 0; i < a->count && i < MRT_MAX_VECTORS; ++i) {
        const mrt_vector *v = &a->vector[i], *w = &b->vector[i];
        if (!is_same_point(v->start, w->start))
            say_points(out, capacity, "starts", i, v->start, w->start);
        else if (!is_same_point(v->end, w->end))
            say_points(out, capacity, "ends", i, v->end, w->end);
        else if (v->contact != w->contact)
            (void)snprintf(out, capacity, "vector %u pulls contact %u and %u", i, v->contact,
                           w->contact);
        if (out[0])
            return;
    }
    for (int i = 0; i < MRT_MAX_DOFS; ++i) {
        float x = plain(a->dof[i]), y = plain(b->dof[i]);
        if (memcmp(&x, &y, sizeof x) == 0)
            continue;
        (void)snprintf(out, capacity, "dof[%d] is %.9g and %.9g", i, (double)x, (double)y);
        return;
    }
    (void)snprintf(out, capacity, "radius, leak %.9g, %.9g and %.9g, %.9g", (double)a->radius_mm,
                   (double)a->leak_per_s, (double)b->radius_mm, (double)b->leak_per_s);
}
