#include "face/bones.h"

#include "base/angle.h"

#include <math.h>
#include <stdio.h>

static const double soft_part = 0.15;       /* of a limit: the range where it takes effect */
static const double narrowed_to = 0.4;      /* of the lateral and forward limits at full opening */
static const double slide_begins_mm = 20.0; /* incisor gap */
static const double slide_ends_mm = 45.0;
static const double guidance = 0.4;        /* mm down per mm aside, with the teeth together */
static const double guidance_ends_mm = 12; /* incisor gap */
static const double depth_least =
    0.3;                           /* of the arm: bounds the rotation of a jaw that hangs down */
static const double side_mm = 2.0; /* lateral motion at which its centre approaches a condyle */
static const vec3 condyle_path = {0.0, -0.55, 0.83};

/* ---- limits ---- */

/* Limits a value to 0 .. limit, limit >= 0. From 85 % on uses a cubic with slope 1 there and 0 at
 * the limit. */
static double soft_side(double value, double limit)
{
    double width = soft_part * limit, from = limit - width;
    if (value <= from)
        return value;
    if (value >= limit)
        return limit;
    double t = (value - from) / width;
    double soft = from + width * (t + t * t - t * t * t);
    return soft < limit ? soft : limit;
}

double bones_soft_limit(double value, double min, double max)
{
    return value < 0.0 ? -soft_side(-value, -min) : soft_side(value, max);
}

/* Uses bisection, since the cubic is flat at its end. */
static double soft_side_inverse(double limited, double limit)
{
    double width = soft_part * limit, low = limit - width, high = limit;
    if (limited <= low)
        return limited;
    if (limited >= limit)
        return limit;
    for (int i = 0; i < 52; ++i) {
        double middle = 0.5 * (low + high);
        if (soft_side(middle, limit) < limited)
            low = middle;
        else
            high = middle;
    }
    return high;
}

double bones_soft_limit_inverse(double limited, double min, double max)
{
    return limited < 0.0 ? -soft_side_inverse(-limited, -min) : soft_side_inverse(limited, max);
}

double bones_followed(double limited, double by_rad, double min, double max)
{
    if (by_rad == 0.0)
        return limited;
    double part = limited > 0.0 ? limited / max : 0.0;
    double fade = part < 1.0 ? (1.0 - part) * (1.0 - part) * (1.0 + 2.0 * part) : 0.0;
    /* at most half the range: beyond, the result would decrease while `limited` grows */
    if (by_rad > 0.0)
        return limited + fade * soft_side(by_rad, 0.5 * max);
    return limited - soft_side(-by_rad * fade, limited - min);
}

static double narrowing(const rig_bone *jaw, double open_rad)
{
    double part = jaw->open_max_rad > 0.0 ? open_rad / jaw->open_max_rad : 0.0;
    part = part < 0.0 ? 0.0 : (part > 1.0 ? 1.0 : part);
    return 1.0 - (1.0 - narrowed_to) * part;
}

double bones_lateral_limit(const bones *b, double open_rad)
{
    const rig_bone *jaw = &b->rig->bone[b->jaw];
    return jaw->lateral_mm * narrowing(jaw, open_rad);
}

double bones_forward_limit(const bones *b, double open_rad)
{
    const rig_bone *jaw = &b->rig->bone[b->jaw];
    return jaw->forward_mm * narrowing(jaw, open_rad);
}

/* ---- motions ---- */

static double smoothstep(double low, double high, double x)
{
    double t = (x - low) / (high - low);
    t = t < 0.0 ? 0.0 : (t > 1.0 ? 1.0 : t);
    return t * t * (3.0 - 2.0 * t);
}

/* Returns the rotation that moves a point by `way` sideways. The point is `depth` in front of an
 * upright axis and `side` beside it: depth sin a + side (1 - cos a) = way, by Newton's method. */
static double lateral_angle(double depth, double side, double way)
{
    double angle = way / depth;
    for (int i = 0; i < 4; ++i) {
        angle_sincos rotation = angle_sincos_of(angle);
        double missing = depth * rotation.sin + side * (1.0 - rotation.cos) - way;
        angle -= missing / (depth * rotation.cos + side * rotation.sin);
    }
    return angle;
}

/* The condyle of one side stays and the other one moves forward. Smooth and symmetric about 0. */
rigid bones_aside(const bones *b, double lateral_mm, double turn_rad)
{
    const bones_hinge *h = &b->hinge;
    if (lateral_mm == 0.0)
        return rigid_identity();
    double side = lateral_mm / sqrt(lateral_mm * lateral_mm + side_mm * side_mm);
    double offset = h->half_mm * side;
    angle_sincos opened = angle_sincos_of(turn_rad);
    double depth = h->depth_mm * opened.cos + h->rise_mm * opened.sin;
    depth = depth > depth_least * h->arm_mm ? depth : depth_least * h->arm_mm;
    vec3 centre = vec3_add(h->middle, vec3_scale(h->left, offset));
    return rigid_turn(centre, h->up, lateral_angle(depth, offset, lateral_mm));
}

static double incisor_gap(const bones *b, double open_rad)
{
    return 2.0 * b->hinge.arm_mm * fabs(angle_sincos_of(0.5 * open_rad).sin);
}

double bones_slide(const bones *b, double open_rad)
{
    double gap = incisor_gap(b, open_rad);
    return b->rig->bone[b->jaw].slide_mm * smoothstep(slide_begins_mm, slide_ends_mm, gap);
}

/* Smooth where the lateral motion begins: 1 mm rounds the corner. */
double bones_guided_opening(const bones *b, double open_rad, double lateral_mm)
{
    double down_mm = guidance * (sqrt(lateral_mm * lateral_mm + 1.0) - 1.0);
    double touching = 1.0 - smoothstep(0.0, guidance_ends_mm, incisor_gap(b, open_rad));
    return open_rad + down_mm / b->hinge.arm_mm * touching;
}

rigid bones_jaw(const bones *b, double open_rad, double lateral_mm, double forward_mm)
{
    if (b->jaw == RIG_NONE)
        return rigid_identity();
    const bones_hinge *h = &b->hinge;
    double turn_rad = bones_guided_opening(b, open_rad, lateral_mm);
    rigid opening = rigid_turn(h->middle, h->left, turn_rad);
    rigid aside = bones_aside(b, lateral_mm, turn_rad);
    rigid out = rigid_compose(&aside, &opening);
    out.t = vec3_add(out.t, vec3_scale(h->path, bones_slide(b, open_rad) + forward_mm));
    return out;
}

static double value_of(const float *dof, uint32_t at)
{
    double value = (double)dof[at];
    return isnan(value) ? 0.0 : value;
}

/* Limits the jaw's dofs: open rad, lateral mm, forward mm. */
static void limit_jaw(double out[3], const bones *b, const float *dof)
{
    const rig_bone *jaw = &b->rig->bone[b->jaw];
    out[0] = bones_soft_limit(value_of(dof, 0), jaw->open_min_rad, jaw->open_max_rad);
    double aside = bones_lateral_limit(b, out[0]);
    out[1] = bones_soft_limit(value_of(dof, 1), -aside, aside);
    out[2] = bones_soft_limit(value_of(dof, 2), 0.0, bones_forward_limit(b, out[0]));
}

static double limit_turn(const rig_bone *ball, uint32_t axis, const float *dof)
{
    const rig_turn *t = &ball->turn[axis];
    return bones_soft_limit(value_of(dof, axis), t->min_rad, t->max_rad);
}

void bones_limit(float *out_dof, const bones *b, const float *dof)
{
    for (uint32_t bone = 0; b->rig && bone < b->bone_count; ++bone) {
        const rig_bone *one = &b->rig->bone[bone];
        uint32_t first = b->first_dof[bone];
        double jaw[3];
        if (one->kind == BONE_JAW)
            limit_jaw(jaw, b, dof + first);
        for (uint32_t i = 0; one->kind == BONE_JAW && i < 3; ++i)
            out_dof[first + i] = (float)jaw[i];
        for (uint32_t i = 0; one->kind == BONE_BALL && i < one->turn_count; ++i)
            out_dof[first + i] = (float)limit_turn(one, i, dof + first);
    }
    if (b->rig && b->seal != RIG_NONE)
        out_dof[b->seal] = (float)bones_soft_limit(value_of(dof, b->seal), 0.0, 1.0);
}

void bones_unlimit(float *out_dof, const bones *b, const float *limited)
{
    for (uint32_t bone = 0; b->rig && bone < b->bone_count; ++bone) {
        const rig_bone *one = &b->rig->bone[bone];
        const float *from = limited + b->first_dof[bone];
        float *to = out_dof + b->first_dof[bone];
        if (one->kind == BONE_JAW) {
            double open = value_of(from, 0), aside = bones_lateral_limit(b, open);
            to[0] = (float)bones_soft_limit_inverse(open, one->open_min_rad, one->open_max_rad);
            to[1] = (float)bones_soft_limit_inverse(value_of(from, 1), -aside, aside);
            to[2] = (float)bones_soft_limit_inverse(value_of(from, 2), 0.0,
                                                    bones_forward_limit(b, open));
        }
        for (uint32_t i = 0; one->kind == BONE_BALL && i < one->turn_count; ++i)
            to[i] = (float)bones_soft_limit_inverse(value_of(from, i), one->turn[i].min_rad,
                                                    one->turn[i].max_rad);
    }
    if (b->rig && b->seal != RIG_NONE)
        out_dof[b->seal] = (float)bones_soft_limit_inverse(value_of(limited, b->seal), 0.0, 1.0);
}

static rigid pose_jaw(const bones *b, const float *dof)
{
    double jaw[3];
    limit_jaw(jaw, b, dof);
    return bones_jaw(b, jaw[0], jaw[1], jaw[2]);
}

static double angle_of(const bones *b, uint32_t bone, uint32_t axis, const float *dof)
{
    const rig_turn *turn = &b->rig->bone[bone].turn[axis];
    const rig_follow *follows = &turn->follows;
    double limited = limit_turn(&b->rig->bone[bone], axis, dof + b->first_dof[bone]);
    if (follows->share == 0.0)
        return limited;
    double other =
        limit_turn(&b->rig->bone[follows->bone], follows->turn, dof + b->first_dof[follows->bone]);
    return bones_followed(limited, follows->share * other, turn->min_rad, turn->max_rad);
}

static rigid pose_ball(const bones *b, uint32_t bone, const float *dof)
{
    const rig_bone *ball = &b->rig->bone[bone];
    rigid out = rigid_identity();
    for (uint32_t i = 0; i < ball->turn_count; ++i) {
        double angle = angle_of(b, bone, i, dof);
        if (angle == 0.0)
            continue;
        rigid rotation = rigid_turn(ball->centre, ball->turn[i].axis, angle);
        out = rigid_compose(&out, &rotation);
    }
    return out;
}

void bones_pose(rigid *out, const bones *b, const float *dof)
{
    for (uint32_t i = 0; i < b->bone_count; ++i) {
        uint32_t bone = b->order[i];
        out[bone] = rigid_identity();
        if (!b->moves[bone])
            continue;
        const rig_bone *one = &b->rig->bone[bone];
        if (one->kind == BONE_JAW)
            out[bone] = pose_jaw(b, dof + b->first_dof[bone]);
        else if (one->kind == BONE_BALL)
            out[bone] = pose_ball(b, bone, dof);
        if (one->parent != RIG_NONE && b->moves[one->parent])
            out[bone] = rigid_compose(&out[one->parent], &out[bone]);
    }
}

/* ---- creation from a rig ---- */

static bool is_finite(vec3 v)
{
    return isfinite(v.x) && isfinite(v.y) && isfinite(v.z);
}

static mrt_result init_hinge(bones *b, const rig_bone *jaw, error *err)
{
    bones_hinge *h = &b->hinge;
    vec3 across = vec3_sub(jaw->hinge_left, jaw->hinge_right);
    double width = vec3_length(across);
    if (!is_finite(across) || !(width > 1e-3))
        return error_set(err, MRT_ERR_FORMAT,
                         "bone %s: its hinge is only %g mm wide; place \"left\" and \"right\" at "
                         "the two condyles",
                         jaw->name, width);
    if (!(jaw->open_min_rad <= 0.0 && jaw->open_max_rad >= 0.0 && jaw->open_max_rad < ANGLE_PI &&
          jaw->open_min_rad > -ANGLE_PI))
        return error_set(err, MRT_ERR_FORMAT,
                         "bone %s: \"open_deg\" ranges from %g to %g rad: expected [low, high] "
                         "with low <= 0 <= high, less than 180 degrees",
                         jaw->name, jaw->open_min_rad, jaw->open_max_rad);
    if (!(jaw->lateral_mm >= 0.0 && jaw->forward_mm >= 0.0 && jaw->slide_mm >= 0.0 &&
          isfinite(jaw->lateral_mm + jaw->forward_mm + jaw->slide_mm)))
        return error_set(err, MRT_ERR_FORMAT,
                         "bone %s: lateral, forward and slide must be lengths of 0 or more",
                         jaw->name);
    const vec3 y = {0.0, 1.0, 0.0}, z = {0.0, 0.0, 1.0};
    h->half_mm = 0.5 * width;
    h->middle = vec3_scale(vec3_add(jaw->hinge_left, jaw->hinge_right), 0.5);
    h->left = vec3_scale(across, 1.0 / width);
    h->up = vec3_sub(y, vec3_scale(h->left, vec3_dot(y, h->left)));
    h->up = vec3_normalised(vec3_length(h->up) > 0.1 ? h->up : vec3_cross(z, h->left), y);
    h->forward = vec3_cross(h->left, h->up);
    h->path = vec3_normalised(condyle_path, z);
    vec3 arm = vec3_sub(b->incisor, h->middle);
    arm = vec3_sub(arm, vec3_scale(h->left, vec3_dot(arm, h->left)));
    h->arm_mm = vec3_length(arm);
    h->depth_mm = vec3_dot(arm, h->forward);
    h->rise_mm = vec3_dot(arm, h->up);
    if (!is_finite(arm) || !(h->depth_mm > 1.0))
        return error_set(err, MRT_ERR_FORMAT,
                         "bone %s: the incisor is %g mm in front of the hinge; set \"incisor\", or "
                         "turn the face towards +z with its left at +x",
                         jaw->name, h->depth_mm);
    return MRT_OK;
}

static mrt_result add_dof(bones *b, uint32_t bone, const char *name, const char *unit, double min,
                          double max, error *err)
{
    const char *owner = b->rig->bone[bone].name;
    if (b->dof_count == MRT_MAX_DOFS)
        return error_set(
            err, MRT_ERR_UNSUPPORTED,
            "bone %s: the rig has more than %d degrees of freedom; remove some \"turns\"", owner,
            MRT_MAX_DOFS);
    bones_dof *dof = &b->dof[b->dof_count];
    int length = snprintf(dof->name, sizeof dof->name, "%s.%s", owner, name);
    if (length < 0 || (size_t)length >= sizeof dof->name)
        return error_set(err, MRT_ERR_FORMAT,
                         "bone %s: the name %s.%s is longer than %zu characters; shorten it", owner,
                         owner, name, sizeof dof->name - 1);
    dof->unit = unit;
    dof->min = (float)min;
    dof->max = (float)max;
    dof->bone = bone;
    dof->index = b->dof_count - b->first_dof[bone];
    b->dof_count += 1;
    return MRT_OK;
}

static mrt_result init_jaw(bones *b, uint32_t bone, error *err)
{
    const rig_bone *jaw = &b->rig->bone[bone];
    if (b->jaw != RIG_NONE)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "bone %s: the rig already has a jaw, %s; only one bone can have a hinge",
                         jaw->name, b->rig->bone[b->jaw].name);
    b->jaw = bone;
    if (jaw->has_incisor)
        b->incisor = jaw->incisor;
    mrt_result result = init_hinge(b, jaw, err);
    if (result >= 0)
        result = add_dof(b, bone, "open", "rad", jaw->open_min_rad, jaw->open_max_rad, err);
    if (result >= 0)
        result = add_dof(b, bone, "lateral", "mm", -jaw->lateral_mm, jaw->lateral_mm, err);
    if (result >= 0)
        result = add_dof(b, bone, "forward", "mm", 0.0, jaw->forward_mm, err);
    return result;
}

static mrt_result init_ball(bones *b, uint32_t bone, error *err)
{
    const rig_bone *ball = &b->rig->bone[bone];
    if (ball->turn_count > RIG_TURNS_MAX || !is_finite(ball->centre))
        return error_set(err, MRT_ERR_FORMAT, "bone %s: expected a centre and at most %d turns",
                         ball->name, RIG_TURNS_MAX);
    for (uint32_t i = 0; i < ball->turn_count; ++i) {
        const rig_turn *t = &ball->turn[i];
        if (!(fabs(vec3_length(t->axis) - 1.0) < 1e-6))
            return error_set(err, MRT_ERR_FORMAT,
                             "bone %s: the axis of turn %s has length %g: expected 1", ball->name,
                             t->name, vec3_length(t->axis));
        if (!(t->min_rad <= 0.0 && t->max_rad >= 0.0 && isfinite(t->max_rad - t->min_rad)))
            return error_set(
                err, MRT_ERR_FORMAT,
                "bone %s: turn %s from %g to %g rad: expected [low, high] with low <= 0 "
                "<= high",
                ball->name, t->name, t->min_rad, t->max_rad);
        const char *fault = rig_follow_fault(b->rig, bone, i);
        if (fault)
            return error_set(err, MRT_ERR_FORMAT, "bone %s: the turn that %s follows %s",
                             ball->name, t->name, fault);
        mrt_result result = add_dof(b, bone, t->name, "rad", t->min_rad, t->max_rad, err);
        if (result < 0)
            return result;
    }
    return MRT_OK;
}

static mrt_result init_seal(bones *b, error *err)
{
    if (b->dof_count == MRT_MAX_DOFS)
        return error_set(
            err, MRT_ERR_UNSUPPORTED,
            "$.mouth: the bones already have all %d degrees of freedom, and " RIG_LIPS_SEAL
            " needs one more; remove some \"turns\"",
            MRT_MAX_DOFS);
    b->seal = b->dof_count++;
    b->dof[b->seal] =
        (bones_dof){.name = RIG_LIPS_SEAL, .unit = "", .min = 0.0f, .max = 1.0f, .bone = RIG_NONE};
    return MRT_OK;
}

/* Orders the bones with parents before their children. */
static mrt_result init_order(bones *b, error *err)
{
    bool placed[RIG_BONES_MAX] = {false};
    uint32_t count = 0;
    for (uint32_t pass = 0; pass < b->bone_count; ++pass)
        for (uint32_t bone = 0; bone < b->bone_count; ++bone) {
            uint32_t parent = b->rig->bone[bone].parent;
            if (placed[bone] || (parent < b->bone_count && !placed[parent]))
                continue;
            placed[bone] = true;
            b->order[count++] = bone;
            if (parent < b->bone_count)
                b->moves[bone] = b->moves[bone] || b->moves[parent];
        }
    for (uint32_t bone = 0; bone < b->bone_count; ++bone)
        if (!placed[bone])
            return error_set(
                err, MRT_ERR_FORMAT,
                "bone %s: it is its own parent through other bones; choose another parent",
                b->rig->bone[bone].name);
    return MRT_OK;
}

mrt_result bones_init(bones *out, const rig *r, vec3 incisor, error *err)
{
    *out = (bones){.rig = r, .incisor = incisor, .jaw = RIG_NONE, .seal = RIG_NONE};
    out->bone_count = r ? r->bone_count : 1;
    if (out->bone_count < 1 || out->bone_count > RIG_BONES_MAX)
        return error_set(err, MRT_ERR_FORMAT, "the rig has %u bones: expected 1 to %d",
                         out->bone_count, RIG_BONES_MAX);
    for (uint32_t bone = 0; r && bone < r->bone_count; ++bone) {
        uint32_t parent = r->bone[bone].parent;
        mrt_result result = MRT_OK;
        out->first_dof[bone] = out->dof_count;
        if (parent != RIG_NONE && parent >= r->bone_count)
            return error_set(err, MRT_ERR_FORMAT,
                             "bone %s: its parent is bone %u, but the rig has only %u bones",
                             r->bone[bone].name, parent, r->bone_count);
        if (r->bone[bone].kind == BONE_JAW)
            result = init_jaw(out, bone, err);
        else if (r->bone[bone].kind == BONE_BALL)
            result = init_ball(out, bone, err);
        if (result < 0)
            return result;
        out->moves[bone] = out->dof_count > out->first_dof[bone];
    }
    if (!r)
        return MRT_OK;
    if (r->mouth.upper) {
        mrt_result result = init_seal(out, err);
        if (result < 0)
            return result;
    }
    return init_order(out, err);
}
