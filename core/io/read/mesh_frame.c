#include "io/read/mesh_frame.h"

#include "io/read/mesh_shape.h"

#include <ctype.h>
#include <math.h>
#include <string.h>
#include <strings.h>

/* ---- rotation ---- */

static int line_of(mesh_axis axis) /* x 0, y 1, z 2 */
{
    return ((int)axis - MESH_AXIS_X) % 3;
}

static void axis_vector(int out[3], mesh_axis axis)
{
    out[0] = out[1] = out[2] = 0;
    if (axis != MESH_AXIS_AUTO)
        out[line_of(axis)] = axis < MESH_AXIS_MINUS_X ? 1 : -1;
}

/* Rotates vectors. Rows: the axis of the file for each axis of the mesh. */
static void turn_vectors(int rotation[3][3], float *vector, size_t count)
{
    for (float *v = vector, *end = vector + count * 3; v < end; v += 3) {
        const float from[3] = {v[0], v[1], v[2]};
        for (int row = 0; row < 3; ++row)
            for (int axis = 0; axis < 3; ++axis)
                if (rotation[row][axis])
                    v[row] = rotation[row][axis] > 0 ? from[axis] : -from[axis];
    }
}

/* Rotates the mesh: up becomes +y, forward +z, and the face's own left +x. Only the signs of
 * numbers change. */
static void turn_axes(mesh *m)
{
    int rotation[3][3];
    axis_vector(rotation[1], m->up);
    axis_vector(rotation[2], m->forward);
    for (int i = 0; i < 3; ++i)
        rotation[0][i] = rotation[1][(i + 1) % 3] * rotation[2][(i + 2) % 3] -
                         rotation[1][(i + 2) % 3] * rotation[2][(i + 1) % 3];
    turn_vectors(rotation, m->position, m->vertex_count);
    if (m->normal)
        turn_vectors(rotation, m->normal, m->vertex_count);
    for (uint32_t t = 0; t < m->target_count; ++t)
        turn_vectors(rotation, m->target[t].offset, m->vertex_count);
    for (uint32_t j = 0; j < m->joint_count; ++j)
        for (size_t column = 0; column < 4; ++column) {
            float *rest = m->joint[j].rest + column, vector[3] = {rest[0], rest[4], rest[8]};
            turn_vectors(rotation, vector, 1);
            for (size_t row = 0; row < 3; ++row)
                rest[row * 4] = vector[row];
        }
}

/* ---- axes from the skeleton ---- */

/* Returns the axis nearest to the vector; AUTO: not clear. */
static mesh_axis nearest_axis(const double vector[3])
{
    double length = sqrt(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2]);
    for (int i = 0; i < 3 && length > 0.0; ++i)
        if (fabs(vector[i]) > 0.85 * length)
            return (mesh_axis)((vector[i] > 0.0 ? MESH_AXIS_X : MESH_AXIS_MINUS_X) + i);
    return MESH_AXIS_AUTO;
}

static void joint_position(double out[3], const mesh_joint *joint)
{
    for (int i = 0; i < 3; ++i)
        out[i] = (double)joint->rest[i * 4 + 3];
}

static bool contains(const char *name, const char *word)
{
    size_t length = strlen(word);
    for (; *name; ++name)
        if (strncasecmp(name, word, length) == 0)
            return true;
    return false;
}

/* Finds a joint by its VRM role, else the first joint with one of the words in its name. */
static const mesh_joint *find_joint(const mesh *m, const char *role, const char *const words[2])
{
    for (uint32_t i = 0; i < m->joint_count; ++i)
        if (strcmp(m->joint[i].role, role) == 0)
            return &m->joint[i];
    for (uint32_t i = 0; i < m->joint_count; ++i)
        if (contains(m->joint[i].name, words[0]) || contains(m->joint[i].name, words[1]))
            return &m->joint[i];
    return NULL;
}

/* Returns whether `right` is the name `left` with the sides exchanged. */
static bool is_other_side(const char *left, const char *right)
{
    const char *l = left, *r = right;
    while (*l && *l == *r && !(strncasecmp(l, "left", 4) == 0 && strncasecmp(r, "right", 5) == 0))
        ++l, ++r;
    if (strncasecmp(l, "left", 4) == 0 && strncasecmp(r, "right", 5) == 0)
        return strcmp(l + 4, r + 5) == 0;
    bool is_letter = (*l == 'L' && *r == 'R') || (*l == 'l' && *r == 'r'); /* "arm_L", "L_arm" */
    bool starts = l == left || !isalnum((unsigned char)l[-1]);
    bool ends = *l && !isalnum((unsigned char)l[1]);
    return is_letter && starts && ends && strcmp(l + 1, r + 1) == 0;
}

/* Sums the vectors from each joint of the right side to its counterpart on the left. */
static void find_left(double out[3], const mesh *m)
{
    enum { JOINTS_MAX = 512 }; /* maximum number of joints, since all pairs are compared */
    out[0] = out[1] = out[2] = 0.0;
    for (uint32_t a = 0; a < m->joint_count && m->joint_count <= JOINTS_MAX; ++a)
        for (uint32_t b = 0; b < m->joint_count; ++b) {
            if (!is_other_side(m->joint[a].name, m->joint[b].name))
                continue;
            double left[3], right[3];
            joint_position(left, &m->joint[a]);
            joint_position(right, &m->joint[b]);
            for (int i = 0; i < 3; ++i)
                out[i] += left[i] - right[i];
        }
}

static bool find_spine(const mesh *m, double out_hips[3], double out_head[3])
{
    static const char *const heads[2] = {"head", "head"}, *const hips[2] = {"hips", "pelvis"};
    const mesh_joint *head = find_joint(m, "head", heads), *hip = find_joint(m, "hips", hips);
    if (!head || !hip)
        return false;
    joint_position(out_head, head);
    joint_position(out_hips, hip);
    return true;
}

static bool find_by_skeleton(const mesh *m, mesh_axis *out_up, mesh_axis *out_forward)
{
    double top[3], bottom[3], left[3], forward[3];
    if (!find_spine(m, bottom, top))
        return false;
    for (int i = 0; i < 3; ++i)
        top[i] -= bottom[i];
    find_left(left, m);
    for (int i = 0; i < 3; ++i)
        forward[i] = left[(i + 1) % 3] * top[(i + 2) % 3] - left[(i + 2) % 3] * top[(i + 1) % 3];
    *out_up = nearest_axis(top);
    *out_forward = nearest_axis(forward);
    return *out_up != MESH_AXIS_AUTO && *out_forward != MESH_AXIS_AUTO &&
           line_of(*out_up) != line_of(*out_forward);
}

/* ---- axes from the shape ---- */

/* Finds the direction of the small triangles, which are the features of a face. It is the mean
 * centre of the triangles minus that of the area, in parts of the box. */
static void find_detail(double out[3], const mesh *m, const float low[3], const float high[3])
{
    double mean[3] = {0}, by_area[3] = {0}, area_sum = 0.0;
    for (const uint32_t *t = m->triangle, *end = t + (size_t)m->triangle_count * 3; t < end;
         t += 3) {
        const float *a = m->position + (size_t)t[0] * 3, *b = m->position + (size_t)t[1] * 3,
                    *c = m->position + (size_t)t[2] * 3;
        double normal[3], area = 0.0;
        for (int i = 0; i < 3; ++i) {
            int j = (i + 1) % 3, k = (i + 2) % 3;
            normal[i] = (double)(b[j] - a[j]) * (double)(c[k] - a[k]) -
                        (double)(b[k] - a[k]) * (double)(c[j] - a[j]);
            area += normal[i] * normal[i];
        }
        area = sqrt(area);
        area_sum += area;
        for (int i = 0; i < 3; ++i) {
            double centre = ((double)a[i] + (double)b[i] + (double)c[i]) / 3.0;
            mean[i] += centre;
            by_area[i] += area * centre;
        }
    }
    for (int i = 0; i < 3; ++i) {
        double extent = (double)high[i] - (double)low[i];
        bool is_there = area_sum > 0.0 && extent > 0.0;
        out[i] = is_there ? (mean[i] / m->triangle_count - by_area[i] / area_sum) / extent : 0.0;
    }
}

/* Measures how far the middles of horizontal rows (y up) vary in x and in z, in parts of the size.
 * A head is symmetric left and right, but not front and back. */
static void find_wander(double out[2], const mesh *m, const float low[3], const double size[3])
{
    enum { ROWS = 48 };
    double from[2][ROWS], to[2][ROWS], mean[2] = {0}, square[2] = {0};
    int count = 0;
    for (int row = 0; row < ROWS; ++row)
        for (int i = 0; i < 2; ++i) {
            from[i][row] = (double)INFINITY;
            to[i][row] = -(double)INFINITY;
        }
    for (uint32_t v = 0; v < m->vertex_count; ++v) {
        const float *p = m->position + (size_t)v * 3;
        int row = (int)(((double)p[1] - (double)low[1]) / size[1] * ROWS);
        row = row < ROWS ? row : ROWS - 1;
        for (int i = 0; i < 2; ++i) {
            from[i][row] = fmin(from[i][row], (double)p[2 * i]);
            to[i][row] = fmax(to[i][row], (double)p[2 * i]);
        }
    }
    for (int row = 0; row < ROWS; ++row) {
        if (!isfinite(from[0][row]))
            continue;
        count += 1;
        for (int i = 0; i < 2; ++i) {
            double middle = 0.5 * (from[i][row] + to[i][row]) - (double)low[2 * i];
            mean[i] += middle;
            square[i] += middle * middle;
        }
    }
    for (int i = 0; i < 2; ++i)
        out[i] = sqrt(fmax(square[i] / count - mean[i] * mean[i] / ((double)count * count), 0.0)) /
                 size[2 * i];
}

/* Left and right are alike, front and back are not: the axis of left and right, where it is clear.
 * `margin`: by how much x may be less alike than another axis. */
static int find_left_axis(const double symmetry[3], double margin)
{
    int best = 0;
    for (int i = 1; i < 3; ++i)
        if (symmetry[i] > 0.75 && symmetry[i] > symmetry[0] + margin &&
            (best == 0 || symmetry[i] > symmetry[best]))
            best = i;
    return best;
}

/* The horizontal direction from which the surface has most relief. x and y are horizontal. */
static mesh_axis find_front_of_z_up(const double symmetry[3], double relief[3][2])
{
    const double clear = 1.15, alike = 0.06;
    mesh_axis best = MESH_AXIS_MINUS_Y;
    double most = clear * relief[1][1];
    for (int axis = 0; axis < 2; ++axis)
        for (int side = 0; side < 2; ++side)
            if (relief[axis][side] > most && symmetry[1 - axis] > symmetry[axis] - alike) {
                most = relief[axis][side];
                best = (mesh_axis)((side == 0 ? MESH_AXIS_X : MESH_AXIS_MINUS_X) + axis);
            }
    return best;
}

/* Whether a z-up modelling program wrote the mesh: its face is where y is down, or a head is higher
 * in z than deep in y. */
static bool is_up_z(mesh_axis *out_forward, const double detail[3], const double size[3])
{
    bool has_face_in_y =
        -detail[1] > 0.1 && -detail[1] > 2.0 * fabs(detail[2]) && size[1] < 2.2 * size[2];
    bool lies_on_back = fabs(detail[1]) > 0.05 && fabs(detail[1]) > 1.1 * fabs(detail[2]) &&
                        size[2] > 1.1 * size[1];
    *out_forward = lies_on_back && detail[1] > 0.0 ? MESH_AXIS_Y : MESH_AXIS_MINUS_Y;
    return has_face_in_y || lies_on_back;
}

/* Finds the axes by shape, in clear cases only. The axes that the format prescribes stand unless
 * another axis than theirs divides left and right, or a body is tall along z. */
static mrt_result find_by_shape(mesh *m, const mesh_frame *usual, mesh_axis *out_up,
                                mesh_axis *out_forward, bool *out_found, error *err)
{
    enum { TRIANGLES_MIN = 300 };
    const bool is_prescribed = usual->up == MESH_AXIS_Y;
    float low[3], high[3];
    double size[3], detail[3], symmetry[3], relief[3][2], wander[2];
    mesh_bounds(m, low, high);
    for (int i = 0; i < 3; ++i)
        size[i] = (double)high[i] - (double)low[i];
    *out_up = usual->up == MESH_AXIS_AUTO ? MESH_AXIS_Y : usual->up;
    *out_forward = *out_up == MESH_AXIS_Z ? MESH_AXIS_MINUS_Y : MESH_AXIS_Z;
    *out_found = *out_up == MESH_AXIS_Z;
    if (m->triangle_count < TRIANGLES_MIN || !(size[0] > 0.0 && size[1] > 0.0 && size[2] > 0.0))
        return MRT_OK;
    find_detail(detail, m, low, high);
    mesh_symmetry(symmetry, m);
    if (!mesh_relief(relief, m))
        return error_set(err, MRT_ERR_MEMORY, "no memory to detect the axes");
    const bool is_even = fabs(detail[0]) < 0.02; /* left and right are alike */
    const bool is_tall_in_z = size[2] > 2.2 * size[1] && size[2] > 0.8 * size[0];
    const bool is_tall_in_y = size[1] > 1.8 * size[2];
    if (usual->up == MESH_AXIS_Z && !is_tall_in_y) {
        *out_forward = find_front_of_z_up(symmetry, relief);
        return MRT_OK;
    }
    *out_up = MESH_AXIS_Y;
    *out_forward = MESH_AXIS_Z;
    *out_found = true;
    if (is_even && is_tall_in_z) {
        *out_up = MESH_AXIS_Z;
        *out_forward = MESH_AXIS_MINUS_Y;
        return MRT_OK;
    }
    const bool is_card = size[0] < 0.2 * fmin(size[1], size[2]) && symmetry[2] > 0.9;
    if (is_card || find_left_axis(symmetry, is_prescribed ? 0.3 : 0.1) == 2) {
        *out_forward = relief[0][0] >= relief[0][1] ? MESH_AXIS_X : MESH_AXIS_MINUS_X;
        return MRT_OK;
    }
    if (is_prescribed) {
        *out_found = is_even && detail[2] < -0.03 && relief[2][1] > 1.35 * relief[2][0];
        *out_forward = MESH_AXIS_MINUS_Z;
        return MRT_OK;
    }
    mesh_axis forward;
    if (is_even && is_up_z(&forward, detail, size)) {
        *out_up = MESH_AXIS_Z;
        *out_forward = forward;
        return MRT_OK;
    }
    const bool is_head = size[1] < 1.7 * fmax(size[0], size[2]);
    if (is_even && ((-detail[2] > 0.08 && -detail[2] > fabs(detail[1])) ||
                    (is_head && relief[2][1] > 1.35 * relief[2][0]))) {
        *out_forward = MESH_AXIS_MINUS_Z;
        return MRT_OK;
    }
    find_wander(wander, m, low, size);
    if (size[1] < 2.6 * size[0] && size[1] < 2.6 * size[2] && wander[0] > 0.03 &&
        wander[0] > 3.0 * wander[1] && fabs(detail[0]) > 0.05) {
        *out_forward = detail[0] > 0.0 ? MESH_AXIS_X : MESH_AXIS_MINUS_X;
        return MRT_OK;
    }
    *out_found = false;
    return MRT_OK;
}

/* ---- axes ---- */

/* Sets the missing one of two axes to its usual value. */
static void complete(mesh_axis *up, mesh_axis *forward)
{
    if (*up == MESH_AXIS_AUTO)
        *up = *forward != MESH_AXIS_AUTO && line_of(*forward) == 1 ? MESH_AXIS_Z : MESH_AXIS_Y;
    if (*forward == MESH_AXIS_AUTO)
        *forward = line_of(*up) == 2 ? MESH_AXIS_MINUS_Y : MESH_AXIS_Z;
}

static mrt_result set_axes(mesh *m, const mesh_frame *given, const mesh_frame *usual, error *err)
{
    mesh_axis up = given->up, forward = given->forward;
    const char *why = NULL;
    if (up == MESH_AXIS_AUTO && forward == MESH_AXIS_AUTO) {
        bool is_found = find_by_skeleton(m, &up, &forward);
        why = "from its skeleton";
        if (!is_found && (m->up != MESH_AXIS_AUTO || m->forward != MESH_AXIS_AUTO)) {
            is_found = true;
            up = m->up;
            forward = m->forward;
            why = "standard of VRM 0";
        }
        if (!is_found && m->joint_count == 0) {
            mrt_result result = find_by_shape(m, usual, &up, &forward, &is_found, err);
            if (result < 0)
                return result;
            why = "from its shape";
        }
        if (!is_found)
            up = forward = MESH_AXIS_AUTO;
    }
    complete(&up, &forward);
    if (line_of(up) == line_of(forward))
        return error_set(err, MRT_ERR_ARGUMENT,
                         "--up %s and --forward %s are on one line: they must be at right angles",
                         mesh_axis_name(up), mesh_axis_name(forward));
    m->up = up;
    m->forward = forward;
    if (up == MESH_AXIS_Y && forward == MESH_AXIS_Z)
        return MRT_OK;
    turn_axes(m);
    if (why)
        mesh_note(m, "detected axes: up %s, forward %s (%s). Change them with --up and --forward",
                  mesh_axis_name(up), mesh_axis_name(forward), why);
    return MRT_OK;
}

/* ---- the unit ---- */

static void scale(mesh *m, double mm_per_unit)
{
    m->mm_per_unit = mm_per_unit;
    for (size_t i = 0; i < (size_t)m->vertex_count * 3; ++i)
        m->position[i] = (float)((double)m->position[i] * mm_per_unit);
    for (uint32_t t = 0; t < m->target_count; ++t)
        for (size_t i = 0; i < (size_t)m->vertex_count * 3; ++i)
            m->target[t].offset[i] = (float)((double)m->target[t].offset[i] * mm_per_unit);
    for (uint32_t j = 0; j < m->joint_count; ++j)
        for (size_t i = 3; i < 12; i += 4)
            m->joint[j].rest[i] = (float)((double)m->joint[j].rest[i] * mm_per_unit);
}

static double rounded(double value) /* to two digits */
{
    double step = pow(10.0, floor(log10(value)) - 1.0);
    return round(value / step) * step;
}

/* Possible types by proportions: between the two limits it may be a long head or a stout body. */
typedef struct stature {
    bool is_head, is_body;
    double height; /* units */
} stature;

static const double head_least_mm = 80.0, head_most_mm = 700.0;

static bool is_likely(const stature *s, double mm_per_unit)
{
    double mm = s->height * mm_per_unit;
    return (s->is_head && mm >= head_least_mm && mm <= head_most_mm) ||
           (s->is_body && mm >= 500.0 && mm <= 2600.0);
}

/* Returns true if the hips and head of the skeleton are inside the mesh, one above the other. That
 * includes several bodies that are wider than tall. A head that was cut from a body may have kept a
 * longer skeleton. */
static bool has_body(const mesh *m, double low_y, double high_y)
{
    double hips[3], head[3];
    return find_spine(m, hips, head) && hips[1] >= low_y && head[1] <= high_y &&
           head[1] - hips[1] > 0.15 * (high_y - low_y);
}

/* Guesses the unit that gives a head or a body its usual height. */
static double guess_mm_per_unit(mesh *m, double format_mm)
{
    static const struct {
        const char *name;
        double mm;
    } unit[] = {{"mm", 1.0}, {"cm", 10.0}, {"m", 1000.0}};
    float low[3], high[3];
    mesh_bounds(m, low, high);
    double width = (double)high[0] - (double)low[0], depth = (double)high[2] - (double)low[2];
    double thinner = width < depth ? width : depth;
    stature s = {.height = (double)high[1] - (double)low[1]};
    bool is_flat = !(thinner > 0.05 * s.height);
    const bool is_body_by_joints = has_body(m, (double)low[1], (double)high[1]);
    s.is_body = is_body_by_joints || (!is_flat && s.height > 2.2 * thinner);
    s.is_head = !is_body_by_joints && (is_flat || s.height < 2.8 * thinner);
    if (!(s.height > 0.0 && isfinite(s.height)) || (is_flat && format_mm > 0.0))
        return format_mm > 0.0 ? format_mm : 1.0;
    /* No note is needed. This includes a thin mask if the format has a unit. */
    bool is_of_heads_size =
        s.height * format_mm >= head_least_mm && s.height * format_mm <= head_most_mm;
    if (is_of_heads_size || is_likely(&s, format_mm))
        return format_mm;
    for (size_t i = 0; i < sizeof unit / sizeof *unit; ++i)
        if (is_likely(&s, unit[i].mm)) {
            m->is_unit_guessed = true;
            mesh_note(m, "assumed unit: %s, which makes the height %.0f mm. Change it with --unit",
                      unit[i].name, s.height * unit[i].mm);
            return unit[i].mm;
        }
    double mm = rounded((s.is_head ? 300.0 : 1700.0) / s.height);
    if (!(mm >= 1e-9 && mm <= 1e9))
        return format_mm > 0.0 ? format_mm : 1.0;
    m->is_unit_guessed = true;
    mesh_note(
        m,
        "the height of %g units does not fit a %s in mm, cm or m. Assumed unit: %g mm, which makes "
        "the height %.0f mm. Change it with --unit",
        s.height, s.is_head ? "head" : "body", mm, s.height * mm);
    return mm;
}

mrt_result mesh_frame_apply(mesh *m, const mesh_frame *given, const mesh_frame *usual, error *err)
{
    mrt_result result = set_axes(m, given, usual, err);
    if (result >= 0)
        scale(m, given->mm_per_unit > 0.0 ? given->mm_per_unit
                                          : guess_mm_per_unit(m, usual->mm_per_unit));
    return result;
}
