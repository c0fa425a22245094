/* The head's own shapes (morph targets of its file) answer a pull before the fields do.
 *
 * At load each shape is analysed. theta_k are the degrees of freedom with which the bones come
 * closest to the shape, measured where a bone alone carries the face. The rest of the shape, S_k,
 * is stored in the frame of the bones, so that theta_k and weight 1 give the original shape. S_k is
 * 0 on rigid parts, and is smoothed where the shape alone would fold the skin.
 * In each frame let y be the displacements that the controls need, with the bones at rest:
 *   min |A w - y|^2 + sum_k ridge_k w_k^2 + few_k w_k,   0 <= w_k <= high_k
 * A holds the shapes at the controls, C is the number of controls. ridge_k = 3 C (lambda_k e_k)^2,
 * with e_k the root mean square of a shape over the skin. It keeps shapes small that the controls
 * hardly determine. (Lewis and Anjyo, Direct Manipulation Blendshapes, 2010, with bounds; lambda_k
 * is larger the less a shape moves the controls.)
 * For each motion of a bone, the shape that is closest to it follows the bone: its weight is how
 * far the bone has moved along theta_k. Other shapes with a part in theta get no larger weight than
 * their bones allow. A bone that is not driven, and that shapes move, is posed by the weights.
 * The residual at the controls that a shape moves determines how far the shape is trusted. The less
 * the shapes are trusted, the more the jaw is posed by its controls alone.
 * The fields do the rest of y, so that each control lands on its end. */
#include "face/frame/frame.h"
#include "face/frame/shape_solve.h"
#include "face/frame/strain.h"
#include "mesh/arkit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STILL = RIG_BONES_MAX, CARRIERS };
enum { FIT_POINTS = 256, FIT_STEPS = 12, EASINGS = 60, NOT_KNOWN = UINT32_MAX };
static const double least_mm = 0.05;     /* least size of a shape that is used */
static const double bone_least_mm = 0.3; /* least motion of bones in a shape */
static const double bone_explains =
    0.6; /* least part of the square of its vertices' motion that a bone must explain; */
static const double bone_part = 0.25; /* and least part of the whole shape's */
static const double alike = 0.5;      /* cosine from which two shapes move a bone the same way */
static const double carried = 0.9; /* least weight of a vertex that a bone carries nearly alone */
static const float strain_most = 0.6f; /* for a shape alone; above 1 it may fold */
static const double ridge_blind = 0.05, ridge_seeing = 0.02; /* lambda_k */
static const double few_mm = 0.02;
/* Residual as a share of the squared displacements of the controls that a shape moves. Up to
 * trusted_from the shape is fully trusted, from trusted_to not at all. trusted_alone replaces
 * trusted_to for a single control, whose displacement many shapes could explain. */
static const double trusted_from = 0.005, trusted_to = 0.15, trusted_alone = 0.01;
static const uint64_t bytes_most = UINT64_C(1) << 30;

/* ---- analysis of the shapes ---- */

typedef struct learning {
    arrays arrays; /* owner of the arrays below */
    face *f;
    const mesh *m;
    float (*row)[4], (*posed)[4], (*change)[4]; /* padded_count: of the current shape */
    float (*normal)[3];             /* of the skin: at rest, turned by the bones of the shape */
    uint32_t *triangle;             /* skin_count */
    uint32_t *point[RIG_BONES_MAX]; /* slots that a bone carries, at most FIT_POINTS */
    uint32_t points[RIG_BONES_MAX];
} learning;

static uint32_t dofs_of(const bones *b, uint32_t bone)
{
    if (bone == b->jaw)
        return 3;
    const rig_bone *one = &b->rig->bone[bone];
    return one->kind == BONE_BALL ? one->turn_count : 0;
}

static float weight_of(const face *f, uint32_t carrier, size_t slot)
{
    float sum = 0.0f;
    if (carrier != STILL)
        return f->bones.moves[carrier] ? f->field[carrier].weight[slot] : 0.0f;
    for (uint32_t b = 0; b < f->bone_count; ++b)
        sum += f->bones.moves[b] ? 0.0f : f->field[b].weight[slot];
    return sum;
}

/* Samples the vertices that the bone carries nearly alone: rigid ones if there are any, else
 * skin. */
static void choose_points(learning *l, uint32_t bone)
{
    const face *f = l->f;
    const float *weight = f->field[bone].weight;
    uint32_t count[2] = {0, 0};
    for (uint32_t slot = 0; slot < f->rest.count; ++slot)
        if ((double)weight[slot] > carried)
            count[f->mobility[slot] > 0.0f] += 1;
    bool takes_skin = count[0] < 4;
    uint32_t all = count[takes_skin], seen = 0;
    l->points[bone] = 0;
    for (uint32_t slot = 0; slot < f->rest.count && l->points[bone] < FIT_POINTS; ++slot) {
        if (!((double)weight[slot] > carried) || (f->mobility[slot] > 0.0f) != takes_skin)
            continue;
        if ((uint64_t)seen * FIT_POINTS >= (uint64_t)l->points[bone] * all)
            l->point[bone][l->points[bone]++] = slot;
        seen += 1;
    }
}

static void read_shape(learning *l, uint32_t target)
{
    const face *f = l->f;
    for (size_t slot = 0; slot < f->rest.padded_count; ++slot) {
        uint32_t last = f->rest.count - 1;
        uint32_t vertex = mesh_point(l->m, f->order.file_of_slot[slot < last ? slot : last]);
        memcpy(l->row[slot], l->m->target[target].offset + (size_t)3 * vertex, 3 * sizeof(float));
    }
}

static vec3 row_of(const learning *l, size_t slot)
{
    const float *row = l->row[slot];
    return (vec3){(double)row[0], (double)row[1], (double)row[2]};
}

/* ---- the part of a shape that bones do ---- */

/* Returns the sum of squares of the residual of the shape at the bone's points. out: the
 * residuals. */
static double left_over(const learning *l, uint32_t bone, const float *dof, vec3 *out)
{
    rigid pose[RIG_BONES_MAX];
    double sum = 0.0;
    bones_pose(pose, &l->f->bones, dof);
    for (uint32_t i = 0; i < l->points[bone]; ++i) {
        uint32_t slot = l->point[bone][i];
        vec3 at = points_position(&l->f->rest, slot);
        vec3 off = vec3_sub(vec3_add(at, row_of(l, slot)), rigid_apply(&pose[bone], at));
        sum += vec3_dot(off, off);
        if (out)
            out[i] = off;
    }
    return sum;
}

/* Makes a Gauss-Newton step within the limits of the bone's degrees of freedom. Returns false if it
 * does not help. */
static bool improve_fit(const learning *l, uint32_t bone, float *dof, double damping)
{
    const bones *b = &l->f->bones;
    uint32_t first = b->first_dof[bone], count = dofs_of(b, bone);
    vec3 off[FIT_POINTS], moved[3][FIT_POINTS];
    matrix3x3 h = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, inverse;
    double g[3] = {0, 0, 0}, was = left_over(l, bone, dof, off);
    for (uint32_t i = 0; i < count; ++i) {
        float kept = dof[first + i], by = 0.01f * (b->dof[first + i].max - b->dof[first + i].min);
        by = kept + by > b->dof[first + i].max ? -by : by;
        dof[first + i] = kept + by;
        (void)left_over(l, bone, dof, moved[i]);
        dof[first + i] = kept;
        for (uint32_t k = 0; k < l->points[bone]; ++k)
            moved[i][k] = vec3_scale(vec3_sub(off[k], moved[i][k]), 1.0 / (double)by);
    }
    for (uint32_t i = 0; i < count; ++i) {
        for (uint32_t j = 0; j < count; ++j) {
            h.at[i][j] = 0.0;
            for (uint32_t k = 0; k < l->points[bone]; ++k)
                h.at[i][j] += vec3_dot(moved[i][k], moved[j][k]);
        }
        h.at[i][i] += damping * h.at[i][i] + 1e-9;
        for (uint32_t k = 0; k < l->points[bone]; ++k)
            g[i] += vec3_dot(moved[i][k], off[k]);
    }
    double scale[3] = {1, 1, 1}; /* scaled so that the test of the determinant is meaningful */
    for (uint32_t i = 0; i < count; ++i)
        scale[i] = 1.0 / sqrt(h.at[i][i]);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            h.at[i][j] *= scale[i] * scale[j];
    if (!matrix3x3_invert(&inverse, &h))
        return false;
    vec3 step =
        matrix3x3_apply(&inverse, (vec3){g[0] * scale[0], g[1] * scale[1], g[2] * scale[2]});
    const double way[3] = {step.x * scale[0], step.y * scale[1], step.z * scale[2]};
    float tried[MRT_MAX_DOFS];
    memcpy(tried, dof, sizeof tried);
    for (uint32_t i = 0; i < count; ++i) {
        const bones_dof *d = &b->dof[first + i];
        float to = dof[first + i] + (float)way[i];
        tried[first + i] = to < d->min ? d->min : (to > d->max ? d->max : to);
    }
    if (!(left_over(l, bone, tried, NULL) < was))
        return false;
    memcpy(dof, tried, sizeof tried);
    return true;
}

/* Returns the share of the whole shape's sum of squares that the bone explains. */
static double part_of(const learning *l, uint32_t bone, const float *dof)
{
    const face *f = l->f;
    rigid pose[RIG_BONES_MAX];
    double whole = 0.0, left = 0.0;
    bones_pose(pose, &f->bones, dof);
    for (size_t slot = 0; slot < f->rest.count; ++slot) {
        vec3 at = points_position(&f->rest, slot), way = row_of(l, slot);
        vec3 moved = vec3_sub(rigid_apply(&pose[bone], at), at);
        vec3 off = vec3_sub(way, vec3_scale(moved, (double)f->field[bone].weight[slot]));
        whole += vec3_dot(way, way);
        left += vec3_dot(off, off);
    }
    return whole > 0.0 ? 1.0 - left / whole : 0.0;
}

/* Poses the eye for a lid that follows the gaze. The eye was fitted before, so the lid is fitted to
 * the rest. */
static void follow_fitted(float *dof, const face_shape *one, const bones *b, const rig_turn *turn)
{
    const rig_follow *follows = &turn->follows;
    if (follows->share == 0.0)
        return;
    uint32_t at = b->first_dof[follows->bone] + follows->turn;
    dof[at] = one->dof[at];
}

static void fit_bone(const learning *l, face_shape *one, uint32_t bone)
{
    const bones *b = &l->f->bones;
    float dof[MRT_MAX_DOFS] = {0};
    for (uint32_t i = 0; i < dofs_of(b, bone); ++i)
        follow_fitted(dof, one, b, &b->rig->bone[bone].turn[i]);
    double before = left_over(l, bone, dof, NULL), damping = 1e-3;
    double least = bone_least_mm * bone_least_mm * l->points[bone];
    if (l->points[bone] < 4 || !(before > least))
        return;
    for (int i = 0; i < FIT_STEPS; ++i)
        damping *= improve_fit(l, bone, dof, damping) ? 0.3 : 10.0;
    bool explains = left_over(l, bone, dof, NULL) < (1.0 - bone_explains) * before;
    if (!explains || !(part_of(l, bone, dof) > bone_part))
        return;
    for (uint32_t i = 0; i < dofs_of(b, bone); ++i)
        one->dof[b->first_dof[bone] + i] = dof[b->first_dof[bone] + i];
    one->bones |= UINT32_C(1) << bone;
}

/* Blends the bones at a vertex as posed in a shape. */
static blend blend_in_shape(const face *f, const rigid *pose, size_t slot)
{
    double share[RIG_BONES_MAX];
    for (uint32_t b = 0; b < f->bone_count; ++b)
        share[b] = (double)f->field[b].weight[slot];
    return blend_of(share, pose, f->bones.moves, f->bone_count);
}

static void set_row(float (*row)[4], size_t slot, vec3 value)
{
    row[slot][0] = (float)value.x;
    row[slot][1] = (float)value.y;
    row[slot][2] = (float)value.z;
}

/* Sets l->posed to the face with the bones as in the shape, and l->row to the rest of the shape.
 * Returns the share of its sum of squares that the bones explain. */
static double subtract_bones(learning *l, const rigid *pose)
{
    const face *f = l->f;
    double whole = 0.0, left = 0.0;
    for (size_t slot = 0; slot < f->rest.padded_count; ++slot) {
        blend here = blend_in_shape(f, pose, slot);
        vec3 offset = row_of(l, slot), at = points_position(&f->rest, slot);
        vec3 moved = blend_moves(&here, at), rest = vec3_sub(offset, moved);
        set_row(l->posed, slot, vec3_add(at, moved));
        set_row(l->row, slot, vec3_scale(rest, fmin(1.0, 10.0 * (double)f->mobility[slot])));
        if (slot < f->rest.count) {
            whole += vec3_dot(offset, offset);
            left += vec3_dot(rest, rest);
        }
    }
    return whole > 0.0 ? fmax(0.0, 1.0 - left / whole) : 0.0;
}

/* Computes l->normal, the normals for the projection of triangles, as face_min_determinant does. */
static void turn_normals(learning *l, const rigid *pose)
{
    const face *f = l->f;
    for (size_t t = 0; t < f->skin_count; ++t) {
        const uint32_t *corner = f->skin + 3 * t;
        double share[RIG_BONES_MAX];
        for (uint32_t b = 0; b < f->bone_count; ++b) {
            const float *weight = f->field[b].weight;
            share[b] = (double)(weight[corner[0]] + weight[corner[1]] + weight[corner[2]]) / 3.0;
        }
        blend here = blend_of(share, pose, f->bones.moves, f->bone_count);
        vec3 at = points_position(&f->rest, corner[0]);
        vec3 normal = vec3_cross(vec3_sub(points_position(&f->rest, corner[1]), at),
                                 vec3_sub(points_position(&f->rest, corner[2]), at));
        normal = vec3_add(normal, matrix3x3_apply(&here.rotation, normal));
        l->normal[t][0] = (float)normal.x;
        l->normal[t][1] = (float)normal.y;
        l->normal[t][2] = (float)normal.z;
    }
}

/* Transforms l->row into the frame of the bones at rest. Vertices of one point get the same
 * value. */
static void carry_back(learning *l, const rigid *pose)
{
    const face *f = l->f;
    for (size_t slot = 0; slot < f->rest.padded_count; ++slot) {
        blend here = blend_in_shape(f, pose, slot);
        set_row(l->row, slot, blend_undo_direction(&here, row_of(l, slot)));
    }
    for (size_t slot = 0; slot < f->rest.padded_count; ++slot) {
        uint32_t last = f->rest.count - 1;
        uint32_t vertex = mesh_point(l->m, f->order.file_of_slot[slot < last ? slot : last]);
        memcpy(l->row[slot], l->row[f->order.slot_of_file[vertex]], sizeof l->row[slot]);
    }
}

/* ---- removing folds of single shapes ---- */

/* Moves the corners of a triangle that the shape strains too much towards their mean. Adds to
 * l->change; its last number counts the additions. */
static bool ease_triangle(learning *l, uint32_t triangle)
{
    const uint32_t *corner = l->f->skin + (size_t)3 * triangle;
    float e[2][3], d[2][3];
    for (int i = 0; i < 2; ++i)
        for (int axis = 0; axis < 3; ++axis) {
            e[i][axis] = l->posed[corner[1 + i]][axis] - l->posed[corner[0]][axis];
            d[i][axis] = l->row[corner[1 + i]][axis] - l->row[corner[0]][axis];
        }
    float strain = strain_fold((const float(*)[3])e, (const float(*)[3])d, l->normal[triangle]);
    if (!(strain > strain_most))
        return false;
    float apart = 1.0f - fmaxf(strain_most / strain, 0.3f);
    for (int axis = 0; axis < 3; ++axis) {
        float mean = l->row[corner[0]][axis] + (d[0][axis] + d[1][axis]) / 3.0f;
        for (int c = 0; c < 3; ++c)
            l->change[corner[c]][axis] += apart * (mean - l->row[corner[c]][axis]);
    }
    for (int c = 0; c < 3; ++c)
        l->change[corner[c]][3] += 1.0f;
    return true;
}

/* Smooths a shape where it folds skin. Differences between the corners of a triangle cause the
 * fold. */
static void ease_folds(learning *l)
{
    const face *f = l->f;
    bool any = true;
    for (size_t slot = 0; slot < f->rest.padded_count; ++slot)
        l->change[slot][3] =
            1.0f; /* the first pass visits all triangles, later ones only changed ones */
    for (int i = 0; any && i < EASINGS; ++i) {
        uint32_t count = 0;
        any = false;
        for (uint32_t t = 0; t < f->skin_count; ++t) {
            const uint32_t *corner = f->skin + (size_t)3 * t;
            if (l->change[corner[0]][3] > 0.0f || l->change[corner[1]][3] > 0.0f ||
                l->change[corner[2]][3] > 0.0f)
                l->triangle[count++] = t;
        }
        memset(l->change, 0, f->rest.padded_count * sizeof *l->change);
        for (uint32_t n = 0; n < count; ++n)
            any |= ease_triangle(l, l->triangle[n]);
        for (size_t slot = 0; any && slot < f->rest.count; ++slot)
            for (int axis = 0; axis < 3 && l->change[slot][3] > 0.0f; ++axis)
                l->row[slot][axis] += l->change[slot][axis] / l->change[slot][3];
    }
}

/* Notes the greatest lengths of the edges in the shape. Registers the shape with the surface meter.
 * f->before is scratch. */
static mrt_result note_edges(learning *l, error *err)
{
    face *f = l->f;
    float *const at[3] = {f->before.x, f->before.y, f->before.z};
    for (size_t slot = 0; slot < f->rest.padded_count; ++slot)
        for (int axis = 0; axis < 3; ++axis)
            at[axis][slot] = l->posed[slot][axis] + l->row[slot][axis];
    for (size_t t = 0; t < f->skin_count; ++t)
        for (size_t e = 0; e < 3; ++e) {
            uint32_t a = f->skin[3 * t + e], b = f->skin[3 * t + (e == 2 ? 0 : e + 1)];
            float sum = 0.0f, *longest = &f->shapes.longest[t][e];
            for (int axis = 0; axis < 3; ++axis) {
                float d = at[axis][b] - at[axis][a];
                sum += d * d;
            }
            *longest = fmaxf(*longest, sqrtf(sum));
        }
    return surface_meter_learn(f->surface_meter, (const float *const *)at, err);
}

/* ---- the list of shapes ---- */

/* Returns the root mean square over the skin in mm, including the part that bones do. */
static double size_of(const learning *l, uint32_t target)
{
    const face *f = l->f;
    double sum = 0.0;
    uint32_t count = 0;
    for (uint32_t slot = 0; slot < f->rest.count; ++slot) {
        const float *o =
            l->m->target[target].offset + (size_t)3 * mesh_point(l->m, f->order.file_of_slot[slot]);
        if (!(f->mobility[slot] > 0.0f))
            continue;
        sum +=
            (double)o[0] * (double)o[0] + (double)o[1] * (double)o[1] + (double)o[2] * (double)o[2];
        count += 1;
    }
    return sqrt(sum / (count > 0 ? count : 1));
}

static uint32_t find_shape(const face_shapes *s, const char *name, size_t length)
{
    for (uint32_t i = 0; i < s->count; ++i)
        if (strlen(s->shape[i].name) == length && memcmp(s->shape[i].name, name, length) == 0)
            return i;
    return s->count;
}

static bool is_called(const mesh *m, uint32_t arkit)
{
    for (uint32_t i = 0; i < m->target_count; ++i)
        if (arkit_find(m->target[i].name) == arkit)
            return true;
    return false;
}

/* Returns ARKit's shape of that name. Otherwise returns the expression that consists of this shape
 * alone, if no other shape has its name. */
static uint32_t arkit_of(const mesh *m, uint32_t target)
{
    uint32_t of = arkit_find(m->target[target].name);
    for (uint32_t i = 0; i < m->expression_count && of >= ARKIT_SHAPES; ++i) {
        const mesh_expression *row = &m->expression[i];
        const bool is_shared = (i > 0 && strcmp(row[-1].name, row->name) == 0) ||
                               (i + 1 < m->expression_count && strcmp(row[1].name, row->name) == 0);
        const uint32_t channel = row->target == target && row->weight >= 1.0f && !is_shared
                                     ? arkit_find(row->name)
                                     : ARKIT_NONE;
        if (channel < ARKIT_SHAPES && !is_called(m, channel))
            of = channel;
    }
    return of;
}

/* Finds the shapes that a corrective depends on. "mouthClose" closes the lips of an open jaw; "a_b"
 * corrects the combination of a and b. */
static void find_needs(face_shapes *s)
{
    const uint32_t close = arkit_find("mouthClose"), open = arkit_find("jawOpen");
    for (uint32_t i = 0; i < s->count; ++i) {
        face_shape *one = &s->shape[i];
        for (uint32_t jaw = 0; jaw < s->count && one->arkit == close; ++jaw)
            if (s->shape[jaw].arkit == open)
                one->needs[0] = 1 + jaw;
        for (const char *cut = strchr(one->name, '_'); cut; cut = strchr(cut + 1, '_')) {
            uint32_t a = find_shape(s, one->name, (size_t)(cut - one->name));
            uint32_t b = find_shape(s, cut + 1, strlen(cut + 1));
            if (a >= s->count || b >= s->count)
                continue;
            one->needs[0] = 1 + a;
            one->needs[1] = 1 + b;
        }
    }
}

static double dof_product(const face_shapes *s, const float *a, const float *b, uint32_t dof_count)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < dof_count; ++i)
        sum += s->dof_mm[i] * s->dof_mm[i] * (double)a[i] * (double)b[i];
    return sum;
}

/* Among shapes that move the same bones the same way, chooses the one that is closest to this
 * motion to follow the bones. */
static void choose_leads(face *f)
{
    face_shapes *s = &f->shapes;
    uint32_t dofs = f->bones.dof_count;
    for (uint32_t i = 0; i < s->count; ++i) {
        face_shape *a = &s->shape[i];
        a->bone_square = dof_product(s, a->dof, a->dof, dofs);
        a->follows_bones = a->bones != 0 && a->bone_square > 0.0;
        for (uint32_t j = 0; j < s->count && a->follows_bones; ++j) {
            const face_shape *b = &s->shape[j];
            double product = dof_product(s, a->dof, b->dof, dofs);
            double other = dof_product(s, b->dof, b->dof, dofs);
            bool is_alike = product > alike * sqrt(a->bone_square * other);
            double mine = a->purity * a->bone_square, theirs = b->purity * other;
            if (j != i && is_alike && (theirs > mine || (!(theirs < mine) && j < i)))
                a->follows_bones = false;
        }
    }
}

/* Measures dof_mm: how far a change of a degree of freedom by 1 moves the vertices that its bone
 * carries. */
static void measure_dofs(learning *l)
{
    const face *f = l->f;
    const bones *b = &f->bones;
    for (uint32_t bone = 0; bone < f->bone_count; ++bone)
        for (uint32_t i = 0; i < dofs_of(b, bone); ++i) {
            float dof[MRT_MAX_DOFS] = {0};
            uint32_t at = b->first_dof[bone] + i;
            dof[at] = b->dof[at].max > 0.0f ? 0.5f * b->dof[at].max : 0.5f * b->dof[at].min;
            for (size_t slot = 0; slot < f->rest.padded_count; ++slot)
                memset(l->row[slot], 0, sizeof l->row[slot]);
            double square = left_over(l, bone, dof, NULL);
            double mm = sqrt(square / (l->points[bone] > 0 ? l->points[bone] : 1));
            l->f->shapes.dof_mm[at] = fabsf(dof[at]) > 0.0f ? mm / fabs((double)dof[at]) : 0.0;
        }
}

/* True if skin moves with the bone, as on the jaw and on lids, but not on an eyeball. */
static bool carries_skin(const face *f, uint32_t bone)
{
    for (uint32_t slot = 0; slot < f->rest.count; ++slot)
        if (f->field[bone].weight[slot] > 0.5f && f->mobility[slot] > 0.1f)
            return true;
    return false;
}

static bool reaches_carrier(const learning *l, uint32_t carrier)
{
    const face *f = l->f;
    for (size_t slot = 0; slot < f->rest.count; ++slot) {
        const float *row = l->row[slot];
        bool moves = fabsf(row[0]) > 0.0f || fabsf(row[1]) > 0.0f || fabsf(row[2]) > 0.0f;
        if (moves && weight_of(f, carrier, slot) > 0.0f)
            return true;
    }
    return false;
}

static mrt_result learn_shape(learning *l, uint32_t target, float *kept, error *err)
{
    face *f = l->f;
    face_shapes *s = &f->shapes;
    face_shape *one = &s->shape[s->count];
    rigid pose[RIG_BONES_MAX];
    *one = (face_shape){.name = l->m->target[target].name,
                        .target = target,
                        .arkit = arkit_of(l->m, target),
                        .size_mm = size_of(l, target)};
    read_shape(l, target);
    for (uint32_t bone = 0; bone < f->bone_count; ++bone)
        if (dofs_of(&f->bones, bone) > 0)
            fit_bone(l, one, bone);
    bones_pose(pose, &f->bones, one->dof);
    one->purity = subtract_bones(l, pose);
    turn_normals(l, pose);
    ease_folds(l);
    mrt_result result = note_edges(l, err);
    if (result < 0)
        return result;
    carry_back(l, pose);
    float greatest = 0.0f;
    for (size_t slot = 0; slot < f->rest.count; ++slot)
        for (int axis = 0; axis < 3; ++axis)
            greatest = fmaxf(greatest, fabsf(l->row[slot][axis]));
    if (!((double)greatest > least_mm) && one->bones == 0)
        return MRT_OK;
    for (uint32_t carrier = 0; carrier < CARRIERS; ++carrier)
        if ((carrier == STILL || carrier < f->bone_count) && reaches_carrier(l, carrier)) {
            s->part[s->part_count] = (face_shape_part){s->count, carrier, 3 * s->part_count};
            s->part_count += 1;
        }
    for (size_t slot = 0; slot < f->rest.padded_count; ++slot)
        memcpy(kept + 3 * slot, l->row[slot], 3 * sizeof *kept);
    s->count += 1;
    return MRT_OK;
}

static bool begin_learning(learning *l)
{
    const face *f = l->f;
    arrays *a = &l->arrays;
    size_t vertices = f->rest.padded_count;
    l->row = arrays_add(a, vertices, sizeof *l->row);
    l->change = arrays_add(a, vertices, sizeof *l->change);
    l->posed = arrays_add(a, vertices, sizeof *l->posed);
    l->triangle = arrays_add(a, f->skin_count, sizeof *l->triangle);
    l->normal = arrays_add(a, f->skin_count, sizeof *l->normal);
    for (uint32_t b = 0; b < f->bone_count; ++b)
        l->point[b] = arrays_add(a, FIT_POINTS, sizeof *l->point[b]);
    for (uint32_t b = 0; !a->failed && b < f->bone_count; ++b)
        choose_points(l, b);
    return !a->failed;
}

static void make_room(face *f, uint32_t count)
{
    face_shapes *s = &f->shapes;
    arrays *a = &f->arrays;
    size_t controls = f->control_capacity, k = (size_t)count + 1, rows = k * (3 * controls + 1);
    s->shape = arrays_add(a, k, sizeof *s->shape);
    s->part = arrays_add(a, k * CARRIERS, sizeof *s->part);
    s->weight = arrays_add(a, k, sizeof *s->weight);
    s->asked = arrays_add(a, k, sizeof *s->asked);
    s->at = arrays_add(a, rows, sizeof *s->at);
    s->whole = arrays_add(a, rows, sizeof *s->whole);
    s->h = arrays_add(a, k * k, sizeof *s->h);
    s->b = arrays_add(a, k, sizeof *s->b);
    s->few = arrays_add(a, k, sizeof *s->few);
    s->low = arrays_add(a, k, sizeof *s->low);
    s->high = arrays_add(a, k, sizeof *s->high);
    s->given = arrays_add(a, k, sizeof *s->given);
    s->strain = arrays_add(a, k, sizeof *s->strain);
    s->scratch = arrays_add(a, SHAPE_SOLVE_SCRATCH(k), sizeof *s->scratch);
    s->y = arrays_add(a, 3 * controls, sizeof *s->y);
    s->left = arrays_add(a, 3 * controls, sizeof *s->left);
    s->longest = arrays_add(a, f->skin_count, sizeof *s->longest);
}

uint32_t face_shapes_of(const mesh *m)
{
    uint32_t count = m->target_count < FACE_SHAPES_MAX ? m->target_count : FACE_SHAPES_MAX;
    /* a column on two carriers, its part of the limits, and the shape itself during the analysis */
    uint64_t bytes = (uint64_t)count * m->vertex_count * 3 * sizeof(float) * 3;
    return bytes > bytes_most ? 0 : count;
}

mrt_result face_shapes_create(face *f, const mesh *m, error *err)
{
    face_shapes *s = &f->shapes;
    learning l = {.f = f, .m = m};
    uint32_t count = face_shapes_of(m);
    size_t each = (size_t)3 * f->rest.padded_count;
    s->m = m;
    s->amount = 1.0;
    s->derived = NOT_KNOWN;
    if (!f->wants_shapes || !f->rig || count == 0)
        return MRT_OK;
    s->learnt = malloc(count * each * sizeof *s->learnt);
    make_room(f, count);
    if (!s->learnt || f->arrays.failed || !begin_learning(&l)) {
        arrays_free(&l.arrays);
        return error_set(err, MRT_ERR_MEMORY, "no memory for %u shapes", count);
    }
    measure_dofs(&l);
    for (uint32_t bone = 0; bone < f->bone_count; ++bone)
        s->derives[bone] = dofs_of(&f->bones, bone) > 0 && carries_skin(f, bone) &&
                           f->rig->bone[bone].kind != BONE_FIXED;
    mrt_result result = MRT_OK;
    for (uint32_t t = 0; t < count && result >= 0; ++t)
        result = learn_shape(&l, t, s->learnt + s->count * each, err);
    arrays_free(&l.arrays);
    if (result < 0)
        return result;
    for (uint32_t i = 0; i < s->count; ++i)
        s->speaks_of |= s->shape[i].bones;
    for (uint32_t i = 0; i < s->count; ++i)
        for (uint32_t d = 0; d < f->bones.dof_count; ++d)
            s->covers[d] |= s->dof_mm[d] * fabs((double)s->shape[i].dof[d]) > bone_least_mm;
    find_needs(s);
    choose_leads(f);
    f->shape_column_count = f->control_column_count = 3 * s->part_count;
    return MRT_OK;
}

void face_shapes_fill(face *f)
{
    face_shapes *s = &f->shapes;
    for (uint32_t p = 0; p < s->part_count; ++p) {
        const face_shape_part *part = &s->part[p];
        const float *row = s->learnt + (size_t)3 * f->rest.padded_count * part->shape;
        for (uint32_t axis = 0; axis < 3; ++axis) {
            float *column = columns_row(&f->columns, part->column + axis);
            for (size_t slot = 0; slot < f->rest.padded_count; ++slot)
                column[slot] = weight_of(f, part->carrier, slot) * row[3 * slot + axis];
        }
    }
    free(s->learnt);
    s->learnt = NULL;
    columns_note(&f->columns, f->shape_column_count);
}

/* ---- an engagement ---- */

/* Returns the offset for weight 1 with the bones at rest. */
static vec3 shape_at(const face *f, const face_shape_part *part, uint32_t slot)
{
    return (vec3){(double)columns_row(&f->columns, part->column)[slot],
                  (double)columns_row(&f->columns, part->column + 1)[slot],
                  (double)columns_row(&f->columns, part->column + 2)[slot]};
}

void face_shapes_engage(face *f)
{
    face_shapes *s = &f->shapes;
    size_t stride = (size_t)3 * f->control_capacity;
    s->derived = NOT_KNOWN;
    s->rides = 0;
    if (s->count == 0)
        return;
    memset(s->at, 0, s->count * stride * sizeof *s->at);
    for (uint32_t k = 0; k < f->control_count; ++k) {
        const face_grip *grip = &f->grip[k];
        uint32_t slot = grip->contact > 0 ? f->contact_slot[grip->contact - 1]
                                          : points_nearest(&f->base, grip->start);
        for (uint32_t p = 0; p < s->part_count; ++p) {
            double *at = s->at + s->part[p].shape * stride + (size_t)3 * k;
            vec3 here = shape_at(f, &s->part[p], slot);
            at[0] += here.x;
            at[1] += here.y;
            at[2] += here.z;
        }
        for (uint32_t b = 0; b < f->bone_count && !grip->is_dropped; ++b)
            if (grip->share[b] > 0.5)
                s->rides |= UINT32_C(1) << b;
    }
}

static bool is_derived(const face *f, uint32_t dof, uint32_t derived)
{
    uint32_t bone = f->bones.dof[dof].bone;
    return bone != RIG_NONE && (derived >> bone & 1) != 0 && f->shapes.covers[dof];
}

/* Computes A, and everything that depends only on which bones follow the weights. */
static void find_responses(face *f, uint32_t derived)
{
    face_shapes *s = &f->shapes;
    size_t stride = (size_t)3 * f->control_capacity, count = (size_t)3 * f->control_count;
    uint32_t held = 0;
    s->derived = derived;
    for (uint32_t k = 0; k < f->control_count; ++k)
        held += !f->grip[k].is_dropped;
    for (uint32_t i = 0; i < s->count; ++i) {
        const face_shape *one = &s->shape[i];
        float dof[MRT_MAX_DOFS] = {0};
        rigid pose[RIG_BONES_MAX];
        for (uint32_t d = 0; d < f->bones.dof_count; ++d)
            if (is_derived(f, d, derived))
                dof[d] = one->dof[d];
        if (one->bones & derived)
            bones_pose(pose, &f->bones, dof);
        for (uint32_t k = 0; k < f->control_count; ++k) {
            const double *at = s->at + i * stride + (size_t)3 * k;
            double *whole = s->whole + i * stride + (size_t)3 * k;
            vec3 way = vec3_row(at, 0);
            if (one->bones & derived) {
                blend posed = face_blend_at(f, &f->grip[k], pose);
                vec3 start = f->grip[k].start;
                way = vec3_sub(blend_apply(&posed, vec3_add(start, way)), start);
            }
            if (f->grip[k].is_dropped)
                way = (vec3){0, 0, 0};
            vec3_set_row(whole, 0, way);
        }
    }
    for (uint32_t i = 0; i < s->count; ++i) {
        const double *a = s->whole + i * stride;
        for (uint32_t j = 0; j <= i; ++j) {
            const double *b = s->whole + j * stride;
            double sum = 0.0;
            for (size_t r = 0; r < count; ++r)
                sum += a[r] * b[r];
            s->h[(size_t)i * s->count + j] = s->h[(size_t)j * s->count + i] = sum;
        }
        double *own = &s->h[(size_t)i * s->count + i], size = s->shape[i].size_mm;
        double rows = 3.0 * (held > 0 ? held : 1), e = size * size;
        double seen =
            e > 0.0 ? *own / (rows / 3.0) / e : 0.0; /* mean square at the controls over e^2 */
        double lambda = ridge_seeing + (ridge_blind - ridge_seeing) / (1.0 + seen);
        s->few[i] = few_mm * sqrt(*own);
        *own += rows * lambda * lambda * e + 1e-6;
    }
}

/* ---- a frame ---- */

/* Returns how far the bones have moved along the theta of a shape, 0..1. */
static double drive_of(const face *f, const face_shape *one, const float *dof)
{
    double way = dof_product(&f->shapes, one->dof, dof, f->bones.dof_count);
    double part = one->bone_square > 0.0 ? way / one->bone_square : 0.0;
    return part > 0.0 ? (part < 1.0 ? part : 1.0) : 0.0;
}

/* Returns the weight of a shape without pulls: from the bones that it follows, or from
 * face_set_least_weights. */
static double led_by(const face *f, uint32_t i, const float *dof)
{
    const face_shapes *s = &f->shapes;
    return s->shape[i].follows_bones ? drive_of(f, &s->shape[i], dof) : s->asked[i];
}

static double led_now(const face_shapes *s, uint32_t i)
{
    return s->shape[i].follows_bones ? s->weight[i] : fmin(s->asked[i], s->weight[i]);
}

static void lead_by(face *f, const float *dof)
{
    face_shapes *s = &f->shapes;
    for (uint32_t i = 0; i < s->count; ++i) {
        double led = led_by(f, i, dof);
        if (s->shape[i].follows_bones || s->weight[i] < led)
            s->weight[i] = led;
    }
}

void face_shapes_settle(face *f, const float *dof)
{
    face_shapes *s = &f->shapes;
    for (uint32_t i = 0; i < s->count; ++i)
        s->weight[i] = 0.0;
    lead_by(f, dof);
}

static bool is_driven(const bones *b, uint32_t bone, const float *dof)
{
    for (uint32_t i = 0; dof && i < dofs_of(b, bone); ++i)
        if (!isnan(dof[b->first_dof[bone] + i]))
            return true;
    return false;
}

/* Returns the bones that the weights pose: not driven, and moved by shapes; the jaw only if some
 * control rides on it. */
static uint32_t derived_bones(const face *f, const float *dof)
{
    const face_shapes *s = &f->shapes;
    uint32_t out = 0;
    for (uint32_t b = 0; b < f->bone_count; ++b)
        if (s->derives[b] && !is_driven(&f->bones, b, dof) &&
            (b != f->bones.jaw || (s->rides >> b & 1)))
            out |= UINT32_C(1) << b;
    return out & s->speaks_of;
}

/* Sets the bounds of the weights, and y: the requested displacements minus those by bones that do
 * not follow the weights. */
static void begin_frame(face *f, const float *resolved, uint32_t derived, const double *end)
{
    face_shapes *s = &f->shapes;
    float held[MRT_MAX_DOFS];
    rigid pose[RIG_BONES_MAX];
    memcpy(held, resolved, sizeof held);
    for (uint32_t d = 0; d < f->bones.dof_count; ++d)
        if (is_derived(f, d, derived))
            held[d] = 0.0f;
    face_pose_bones(f, pose, held);
    for (uint32_t k = 0; k < f->control_count; ++k) {
        const face_grip *grip = &f->grip[k];
        blend posed = face_blend_at(f, grip, pose);
        vec3 at = vec3_row(end, k);
        vec3 way = vec3_sub(blend_undo(&posed, at), grip->start);
        vec3_set_row(s->y, k, grip->is_dropped ? (vec3){0, 0, 0} : way);
    }
    for (uint32_t i = 0; i < s->count; ++i) {
        const face_shape *one = &s->shape[i];
        s->low[i] = s->asked[i];
        s->high[i] = 1.0;
        if (one->bones == 0 || (one->bones & derived))
            continue;
        s->high[i] = fmax(drive_of(f, one, held), s->asked[i]);
        s->low[i] = one->follows_bones ? s->high[i] : s->asked[i];
    }
}

/* Bounds each corrective by the least weight of the shapes that it corrects. Returns true if one
 * exceeded it. */
static bool bound_correctives(face_shapes *s)
{
    bool any = false;
    for (uint32_t i = 0; i < s->count; ++i)
        for (int n = 0; n < 2; ++n) {
            uint32_t need = s->shape[i].needs[n];
            double most = need > 0 ? fmax(s->weight[need - 1], s->asked[i]) : 1.0;
            if (!(s->weight[i] > most))
                continue;
            s->high[i] = fmin(s->high[i], most);
            s->low[i] = fmin(s->low[i], s->high[i]);
            any = true;
        }
    return any;
}

/* Reduces the weight of a shape if the shapes explain the displacements of its controls badly. The
 * fields do the rest. */
static void trust_shapes(face *f)
{
    face_shapes *s = &f->shapes;
    size_t stride = (size_t)3 * f->control_capacity, count = (size_t)3 * f->control_count;
    for (size_t r = 0; r < count; ++r)
        s->left[r] = s->y[r];
    for (uint32_t i = 0; i < s->count; ++i)
        for (size_t r = 0; s->weight[i] > 0.0 && r < count; ++r)
            s->left[r] -= s->weight[i] * s->whole[i * stride + r];
    for (uint32_t i = 0; i < s->count; ++i) {
        const double *a = s->whole + i * stride;
        double asked = 0.0, left = 0.0, sum = 0.0, square = 0.0;
        if (!(s->weight[i] > s->low[i]))
            continue;
        for (size_t r = 0; r < count; r += 3) {
            double size = a[r] * a[r] + a[r + 1] * a[r + 1] + a[r + 2] * a[r + 2];
            sum += size;
            square += size * size;
            for (size_t axis = r; axis < r + 3; ++axis) {
                asked += size * s->y[axis] * s->y[axis];
                left += size * s->left[axis] * s->left[axis];
            }
        }
        double alone = sum > 0.0 ? square / (sum * sum)
                                 : 1.0; /* 1 over the number of controls that determine it */
        double to = trusted_to + alone * (trusted_alone - trusted_to);
        double part = asked > 0.0 ? (left / asked - trusted_from) / (to - trusted_from) : 1.0;
        part = part < 0.0 ? 0.0 : (part > 1.0 ? 1.0 : part);
        double trust = 1.0 - part * part * (3.0 - 2.0 * part);
        s->weight[i] = s->low[i] + trust * (s->weight[i] - s->low[i]);
    }
}

/* Sums for each degree of freedom the absolute motions by the shapes. */
static void add_ways(const face *f, double *out)
{
    const face_shapes *s = &f->shapes;
    for (uint32_t d = 0; d < f->bones.dof_count; ++d) {
        out[d] = 0.0;
        for (uint32_t i = 0; i < s->count; ++i)
            out[d] += s->weight[i] * fabs((double)s->shape[i].dof[d]);
    }
}

/* Blends between the value that the weights give and the value before, by how far the weights are
 * trusted. */
static double derive_dof(const face *f, uint32_t d, double was, double asked, double believed)
{
    const face_shapes *s = &f->shapes;
    double least = bone_least_mm / fmax(s->dof_mm[d], 1e-3), sum = 0.0;
    for (uint32_t i = 0; i < s->count; ++i)
        sum += s->weight[i] * (double)s->shape[i].dof[d];
    double trust = fmin((believed + least) / (asked + least), 1.0);
    sum = s->amount * (sum + (1.0 - trust) * was) + (1.0 - s->amount) * was;
    return fmin(fmax(sum, (double)f->bones.dof[d].min), (double)f->bones.dof[d].max);
}

void face_shapes_solve(face *f, float *resolved, const float *dof, const double *end)
{
    face_shapes *s = &f->shapes;
    size_t stride = (size_t)3 * f->control_capacity, count = (size_t)3 * f->control_count;
    uint32_t derived = derived_bones(f, dof);
    if (derived != s->derived)
        find_responses(f, derived);
    begin_frame(f, resolved, derived, end);
    for (uint32_t i = 0; i < s->count; ++i) {
        const double *a = s->whole + i * stride;
        double sum = -s->few[i];
        for (size_t r = 0; r < count; ++r)
            sum += a[r] * s->y[r];
        s->b[i] = sum;
    }
    const shape_problem problem = {s->h, s->b, s->low, s->high, s->count};
    (void)shape_solve(s->weight, &problem, s->scratch);
    if (bound_correctives(s))
        (void)shape_solve(s->weight, &problem, s->scratch);
    double asked[MRT_MAX_DOFS], believed[MRT_MAX_DOFS];
    add_ways(f, asked);
    trust_shapes(f);
    add_ways(f, believed);
    for (uint32_t d = 0; d < f->bones.dof_count; ++d)
        if (is_derived(f, d, derived))
            resolved[d] = (float)derive_dof(f, d, (double)resolved[d], asked[d], believed[d]);
    lead_by(f, resolved);
    (void)bound_correctives(s);
    for (uint32_t i = 0; i < s->count; ++i)
        if (s->shape[i].needs[0] > 0)
            s->weight[i] = fmin(s->weight[i], s->high[i]);
}

/* Sums the offsets of all shapes with `weight` at a control. */
static vec3 sum_at(const face *f, uint32_t control, const double *weight)
{
    const face_shapes *s = &f->shapes;
    vec3 sum = {0, 0, 0};
    for (uint32_t i = 0; i < s->count; ++i) {
        const double *at = s->at + (size_t)3 * (f->control_capacity * (size_t)i + control);
        if (weight[i] != 0.0)
            sum = vec3_add(sum, vec3_scale(vec3_row(at, 0), s->amount * weight[i]));
    }
    return sum;
}

vec3 face_shapes_at(const face *f, uint32_t control)
{
    return sum_at(f, control, f->shapes.weight);
}

vec3 face_shapes_missing(const face *f, uint32_t control)
{
    const face_shapes *s = &f->shapes;
    for (uint32_t i = 0; i < s->count; ++i)
        s->b[i] = s->weight[i] * (1.0 - s->given[i]); /* b: scratch */
    return sum_at(f, control, s->b);
}

vec3 face_shapes_led_at(const face *f, uint32_t control, const float *dof)
{
    const face_shapes *s = &f->shapes;
    for (uint32_t i = 0; i < s->count; ++i)
        s->b[i] = led_by(f, i, dof);
    return sum_at(f, control, s->b);
}

vec3 face_shapes_led_slot(const face *f, uint32_t slot)
{
    const face_shapes *s = &f->shapes;
    vec3 sum = {0, 0, 0};
    for (uint32_t p = 0; p < s->part_count; ++p) {
        const face_shape_part *part = &s->part[p];
        double led = led_now(s, part->shape);
        if (led != 0.0)
            sum = vec3_add(sum, vec3_scale(shape_at(f, part, slot), s->amount * led));
    }
    return sum;
}

/* ---- columns ---- */

void face_shapes_weigh(const face *f, double *weight, const rigid *pose)
{
    const face_shapes *s = &f->shapes;
    for (uint32_t p = 0; p < s->part_count; ++p) {
        const face_shape_part *part = &s->part[p];
        double *row = weight + (size_t)3 * part->column, by = s->amount * s->weight[part->shape];
        for (int axis = 0; axis < 3; ++axis)
            for (int i = 0; i < 3; ++i) {
                double rotation = axis == i ? 1.0 : 0.0;
                row[3 * axis + i] =
                    by * (part->carrier == STILL ? rotation : pose[part->carrier].r[i][axis]);
            }
    }
}

void face_shapes_unlead(const face *f, double *weight)
{
    const face_shapes *s = &f->shapes;
    for (uint32_t p = 0; p < s->part_count; ++p) {
        uint32_t of = s->part[p].shape;
        double led = led_now(s, of), *row = weight + (size_t)3 * s->part[p].column;
        for (int i = 0; i < 9 && led > 0.0; ++i)
            row[i] = led < s->weight[of] ? row[i] * (1.0 - led / s->weight[of]) : 0.0;
    }
}

void face_shapes_apply(face *f)
{
    const face_shapes *s = &f->shapes;
    for (uint32_t p = 0; p < s->part_count; ++p) {
        size_t first = (size_t)3 * s->part[p].column;
        for (size_t i = first; i < first + 9; ++i)
            f->given[i] = s->given[s->part[p].shape] * f->weight[i];
    }
}

const char *face_shapes_column_name(const face *f, uint32_t column, uint32_t *out_carrier)
{
    const face_shape_part *part = &f->shapes.part[column / 3];
    *out_carrier = part->carrier == STILL ? RIG_NONE : part->carrier;
    return f->shapes.shape[part->shape].name;
}

bool face_shapes_weigh_something(const face *f)
{
    const face_shapes *s = &f->shapes;
    for (uint32_t i = 0; i < s->count; ++i)
        if (s->weight[i] > 0.0 && s->amount > 0.0)
            return true;
    return false;
}

bool face_shapes_are_held(const face *f)
{
    const face_shapes *s = &f->shapes;
    for (uint32_t i = 0; i < s->count; ++i)
        if (s->weight[i] > 0.0 && s->given[i] < 1.0)
            return true;
    return false;
}

/* ---- access ---- */

uint32_t face_shape_count(const face *f)
{
    return f->shapes.count;
}

const char *face_shape_name(const face *f, uint32_t index)
{
    return f->shapes.shape[index].name;
}

bool face_shape_parts(const face *f, const char *name, float *out)
{
    const face_shapes *s = &f->shapes;
    const uint32_t of = arkit_find(name);
    bool is_there = false;
    for (uint32_t i = 0; i < s->count; ++i) {
        const face_shape *one = &s->shape[i];
        out[i] = strcmp(one->name, name) == 0 || (of < ARKIT_SHAPES && one->arkit == of);
        is_there = is_there || out[i] > 0.0f;
    }
    for (uint32_t r = 0; !is_there && s->count > 0 && r < s->m->expression_count; ++r) {
        const mesh_expression *row = &s->m->expression[r];
        for (uint32_t i = 0; i < s->count && arkit_is_same_name(row->name, name); ++i)
            if (s->shape[i].target == row->target)
                out[i] = row->weight;
    }
    for (uint32_t i = 0; i < s->count; ++i)
        is_there = is_there || out[i] > 0.0f;
    return is_there;
}

const float *face_shape_dofs(const face *f, uint32_t index)
{
    return f->shapes.shape[index].dof;
}

void face_set_least_weights(face *f, const float *weight)
{
    face_shapes *s = &f->shapes;
    for (uint32_t i = 0; i < s->count; ++i) {
        bool is_led = s->shape[i].follows_bones || !weight;
        s->asked[i] = is_led ? 0.0 : fmin(fmax((double)weight[i], 0.0), 1.0);
    }
}

void face_shape_offset(const face *f, uint32_t index, float *out)
{
    memset(out, 0, (size_t)3 * f->rest.count * sizeof *out);
    for (uint32_t p = 0; p < f->shapes.part_count; ++p)
        for (uint32_t axis = 0; axis < 3 && f->shapes.part[p].shape == index; ++axis) {
            const float *column = columns_row(&f->columns, f->shapes.part[p].column + axis);
            for (uint32_t slot = 0; slot < f->rest.count; ++slot)
                out[(size_t)3 * f->order.file_of_slot[slot] + axis] += column[slot];
        }
}

double face_shape_weight(const face *f, uint32_t index)
{
    const face_shapes *s = &f->shapes;
    return s->amount * s->weight[index] * s->given[index];
}

void face_set_shapes(face *f, double amount)
{
    f->shapes.amount = amount > 0.0 ? (amount < 1.0 ? amount : 1.0) : 0.0;
    face_shapes_settle(f, f->dof);
}
