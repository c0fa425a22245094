#include "face/rig/rig_head.h"

#include "base/percentile.h"

#include "mesh/position.h"

#include <math.h>
#include <stdlib.h>

/* ---- left and right ---- */

/* A vertex and its cell in a grid. Cells are doubles, because a mesh can be huge and the reach
 * tiny. */
typedef struct sorted_vertex {
    double cell[3];
    uint32_t vertex;
} sorted_vertex;

enum { SCANNED_MAX = 100 }; /* vertices in three cells; only coincident vertices exceed this */
static const double cell_min_mm = 1e-9;

static int compare_cells(const double a[3], const double b[3])
{
    for (int i = 0; i < 3; ++i)
        if (a[i] < b[i] || a[i] > b[i])
            return a[i] < b[i] ? -1 : 1;
    return 0;
}

static int compare_sorted(const void *left, const void *right)
{
    const sorted_vertex *a = left, *b = right;
    const int cells = compare_cells(a->cell, b->cell);
    return cells ? cells : a->vertex < b->vertex ? -1 : a->vertex > b->vertex;
}

static void find_cell(double out[3], vec3 p, double cell_mm)
{
    out[0] = floor(p.x / cell_mm);
    out[1] = floor(p.y / cell_mm);
    out[2] = floor(p.z / cell_mm);
}

static size_t first_at_least(const sorted_vertex *sorted, size_t count, const double cell[3])
{
    size_t low = 0, high = count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (compare_cells(sorted[middle].cell, cell) < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static vec3 mirrored(vec3 p, double middle_x)
{
    return (vec3){2.0 * middle_x - p.x, p.y, p.z};
}

/* Tests nine columns of cells around the image. The three cells of a column are contiguous in the
 * sorted array. */
static bool has_partner(const sorted_vertex *sorted, size_t count, const mesh *m, vec3 image,
                        double reach_mm, double cell_mm)
{
    double at[3];
    find_cell(at, image, cell_mm);
    for (int column = 0; column < 9; ++column) {
        const double from[3] = {at[0] + column / 3 - 1, at[1] + column % 3 - 1, at[2] - 1.0};
        const double to[3] = {from[0], from[1], at[2] + 1.0};
        const size_t first = first_at_least(sorted, count, from);
        for (size_t i = first;
             i < count && i - first < SCANNED_MAX && compare_cells(sorted[i].cell, to) <= 0; ++i) {
            vec3 d = vec3_sub(mesh_position(m, sorted[i].vertex), image);
            if (vec3_dot(d, d) <= reach_mm * reach_mm)
                return true;
        }
    }
    return false;
}

bool rig_mirror_count_alone(uint32_t *out_count, uint32_t *out_example, const mesh *m,
                            const uint8_t *is_face, double middle_x, double reach_mm)
{
    size_t count = 0;
    *out_count = 0;
    *out_example = 0;
    sorted_vertex *sorted = malloc(((size_t)m->vertex_count + 1) * sizeof *sorted);
    if (!sorted)
        return false;
    const double cell_mm = fmax(reach_mm, cell_min_mm);
    for (uint32_t v = 0; v < m->vertex_count; ++v) {
        if (is_face && !is_face[v])
            continue;
        find_cell(sorted[count].cell, mesh_position(m, v), cell_mm);
        sorted[count++].vertex = v;
    }
    qsort(sorted, count, sizeof *sorted, compare_sorted);
    for (uint32_t v = 0; v < m->vertex_count; ++v) {
        if ((is_face && !is_face[v]) ||
            has_partner(sorted, count, m, mirrored(mesh_position(m, v), middle_x), reach_mm,
                        cell_mm))
            continue;
        if (*out_count == 0)
            *out_example = v;
        *out_count += 1;
    }
    free(sorted);
    return true;
}

uint32_t rig_mirror_of(const mesh *m, const uint8_t *is_face, uint32_t vertex, double middle_x,
                       double *out_distance_mm)
{
    vec3 image = mirrored(mesh_position(m, vertex), middle_x);
    uint32_t best = vertex;
    double best_square = (double)INFINITY;
    for (uint32_t v = 0; v < m->vertex_count; ++v) {
        vec3 d = vec3_sub(mesh_position(m, v), image);
        double square = vec3_dot(d, d);
        if (square < best_square && (!is_face || is_face[v])) {
            best_square = square;
            best = v;
        }
    }
    *out_distance_mm = sqrt(best_square);
    return best;
}

enum { ROWS = 512 };

typedef struct profile { /* cut of the mesh with its middle plane, by height */
    double low_y, row_mm;
    double front[ROWS], back[ROWS]; /* z; -inf and +inf for rows without surface */
} profile;

/* ---- the profile ---- */

static double row_y(const profile *p, int row)
{
    return p->low_y + (row + 0.5) * p->row_mm;
}

static void add_point(profile *p, double y, double z)
{
    int row = (int)floor((y - p->low_y) / p->row_mm);
    row = row < 0 ? 0 : row >= ROWS ? ROWS - 1 : row;
    p->front[row] = fmax(p->front[row], z);
    p->back[row] = fmin(p->back[row], z);
}

static void add_segment(profile *p, vec3 a, vec3 b)
{
    int steps = 1 + (int)fmin(2.0 * ROWS, ceil(fabs(b.y - a.y) / p->row_mm * 2.0));
    for (int i = 0; i <= steps; ++i) {
        double s = (double)i / steps;
        add_point(p, a.y + s * (b.y - a.y), a.z + s * (b.z - a.z));
    }
}

/* Adds the segment where the triangle crosses x = middle_x, if it does. */
static void add_triangle(profile *p, const vec3 corner[3], double middle_x)
{
    vec3 cut[3];
    int count = 0;
    for (int i = 0; i < 3; ++i) {
        vec3 a = corner[i], b = corner[(i + 1) % 3];
        if ((a.x < middle_x) == (b.x < middle_x))
            continue;
        double s = (middle_x - a.x) / (b.x - a.x);
        cut[count++] = vec3_add(a, vec3_scale(vec3_sub(b, a), s));
    }
    if (count == 2)
        add_segment(p, cut[0], cut[1]);
}

static void triangle_corners(vec3 out[3], const mesh *m, uint32_t triangle)
{
    for (size_t i = 0; i < 3; ++i)
        out[i] = mesh_position(m, m->triangle[(size_t)triangle * 3 + i]);
}

static bool is_of_face(const mesh *m, const uint8_t *is_face, uint32_t triangle)
{
    const uint32_t *corner = m->triangle + (size_t)triangle * 3;
    return !is_face || (is_face[corner[0]] && is_face[corner[1]] && is_face[corner[2]]);
}

static void cut_profile(profile *p, const mesh *m, const uint8_t *is_face, double at_x,
                        double low_y, double high_y)
{
    *p = (profile){.low_y = low_y, .row_mm = (high_y - low_y) / ROWS};
    for (int row = 0; row < ROWS; ++row) {
        p->front[row] = -(double)INFINITY;
        p->back[row] = (double)INFINITY;
    }
    for (uint32_t i = 0; i < m->triangle_count; ++i) {
        vec3 corner[3];
        if (!is_of_face(m, is_face, i))
            continue;
        triangle_corners(corner, m, i);
        add_triangle(p, corner, at_x);
    }
}

/* ---- features of the profile ---- */

/* Returns how far the profile stands out from those beside it. The bound is for eyes beside it that
 * are holes. */
static double prominence(const profile *p, const profile *left, const profile *right, int row)
{
    double beside = fmax(left->front[row], right->front[row]), most = 0.08 * ROWS * p->row_mm;
    return isfinite(beside) ? fmin(fmax(p->front[row] - beside, 0.0), most) : 0.0;
}

static double forward_at(const profile *p, const profile *left, const profile *right, int row)
{
    return p->front[row] + prominence(p, left, right, row);
}

/* Finds the row that stands out most, both from the head and from the skin to its left and right.
 * Muzzles are broad, noses are not. Hair over the forehead can stand out as far, so high rows count
 * less. */
static int find_nose(double *out_mm, const profile *p, const profile *left, const profile *right)
{
    int best = -1;
    for (int row = ROWS / 4; row < ROWS * 17 / 20; ++row) {
        double above = fmax(row - 0.6 * ROWS, 0.0) * p->row_mm;
        double mm = forward_at(p, left, right, row) - 0.3 * above;
        if (!isfinite(p->front[row]) || (best >= 0 && mm <= *out_mm))
            continue;
        best = row;
        *out_mm = mm;
    }
    for (int from = -1; best >= 0 && from != best;) { /* move up or down to the tip */
        from = best;
        const int low = from - ROWS / 64, high = from + ROWS / 64;
        for (int row = low > 0 ? low : 0; row <= high && row < ROWS; ++row)
            if (forward_at(p, left, right, row) > forward_at(p, left, right, best))
                best = row;
    }
    return best;
}

/* Finds the last row, going down from the nose, before the front recedes to the neck. Dips of at
 * most 6 % of the height, as under a nose, are part of the face. Under a long nose everything
 * recedes. So the limit is relaxed until at least a fifth of the face's height is below its
 * nose. */
static int find_chin(const profile *p, int nose, double depth_mm)
{
    int chin = nose, top = ROWS - 1;
    while (top > nose && !isfinite(p->front[top]))
        top -= 1;
    for (double recession = 0.2; recession < 0.4 && nose - chin < (top - chin) / 5;
         recession += 0.05)
        for (int row = chin; row >= 0 && chin - row <= ROWS * 6 / 100; --row)
            if (isfinite(p->front[row]) && p->front[row] >= p->front[nose] - recession * depth_mm)
                chin = row;
    return chin;
}

/* Finds the row of the front that stands out most, within `reach` rows from `row`. way: -1 or 1. */
static int find_crest(const profile *p, int row, int way, int reach)
{
    int best = row;
    for (int i = 1; i <= reach; ++i) {
        int at = row + way * i;
        if (at < 0 || at >= ROWS)
            break;
        if (!isfinite(p->front[best]) || (isfinite(p->front[at]) && p->front[at] > p->front[best]))
            best = at;
    }
    return best;
}

/* Returns how deep the profile is at a row, below the line between the points above and below. */
static double depth_at(const profile *p, int row, int reach)
{
    if (row - reach < 0 || row + reach >= ROWS)
        return 0.0;
    double around = 0.5 * (p->front[row - reach] + p->front[row + reach]);
    double depth = around - p->front[row];
    return isfinite(depth) ? depth : 0.0;
}

static double sharpness_at(const profile *p, int row, int span)
{
    return fmax(depth_at(p, row, span * 4 / 100 + 1), 0.0);
}

/* Finds the deepest row between the lips. It is sharp, while the fold below the lips is broad, and
 * usually half way from nose to chin. If another row above a fold is as sharp, that row is the
 * mouth. */
static int find_mouth(const profile *p, int nose, int chin, double *out_depth)
{
    int span = nose - chin, best = nose - span * 47 / 100;
    double best_score = 0.0;
    *out_depth = 0.0;
    for (int row = nose - span * 88 / 100; row <= nose - span * 28 / 100; ++row) {
        double off = ((double)(nose - row) / span - 0.48) / 0.13;
        double depth = depth_at(p, row, span * 8 / 100 + 1);
        double score = (depth + 2.0 * sharpness_at(p, row, span)) * (exp(-off * off) + 0.03);
        if (score <= best_score)
            continue;
        best_score = score;
        best = row;
        *out_depth = depth;
    }
    int fold = best, lips = best;
    for (int row = fold + span * 10 / 100; row <= nose - span * 30 / 100; ++row)
        if (best_score > 0.0 && sharpness_at(p, row, span) > sharpness_at(p, lips, span) &&
            depth_at(p, row, span * 8 / 100 + 1) > 0.5 * *out_depth)
            lips = row;
    if (lips != fold) {
        best = lips;
        *out_depth = depth_at(p, best, span * 8 / 100 + 1);
    }
    for (int row = best - span * 4 / 100, end = best + span * 4 / 100; row <= end; ++row)
        if (best_score > 0.0 && depth_at(p, row, span * 8 / 100 + 1) > *out_depth) {
            *out_depth = depth_at(p, row, span * 8 / 100 + 1);
            best = row;
        }
    return best;
}

/* Finds lips that touch: two layers of skin that coincide in the middle between nose and chin.
 * Writes their mean height. */
static bool find_touching(double *out_y, const mesh *m, const uint8_t *is_face,
                          const rig_head *head)
{
    enum { LOOKED_AT = 4000, LEAST = 3 };
    const double span = head->nose.y - head->chin.y, near = 1e-4 * span;
    uint32_t found[LOOKED_AT], count = 0, touching = 0;
    double sum = 0.0;
    for (uint32_t v = 0; v < m->vertex_count && count < LOOKED_AT; ++v) {
        vec3 p = mesh_position(m, v);
        if ((is_face && !is_face[v]) || mesh_point(m, v) != v ||
            fabs(p.x - head->middle_x) > 0.15 * span || p.y > head->nose.y - 0.15 * span ||
            p.y < head->chin.y + 0.1 * span || p.z < head->chin.z - 0.5 * span)
            continue;
        for (uint32_t i = 0; i < count; ++i)
            if (vec3_length(vec3_sub(p, mesh_position(m, found[i]))) < near) {
                touching += 1;
                sum += p.y;
            }
        found[count++] = v;
    }
    *out_y = sum / (touching > 0 ? touching : 1);
    return touching >= LEAST;
}

/* Finds the first row from the mouth where the front has come out by three quarters. */
static int find_lip(const profile *p, int mouth, int way, int reach)
{
    int crest = find_crest(p, mouth, way, reach);
    double deep = p->front[mouth], out = p->front[crest];
    for (int row = mouth; row != crest; row += way)
        if (isfinite(p->front[row]) &&
            (!isfinite(deep) || p->front[row] >= deep + 0.75 * (out - deep)))
            return row;
    return crest;
}

typedef struct bounds {
    vec3 low, high;
} bounds;

static bool bounds_of(bounds *out, const mesh *m, const uint8_t *is_face)
{
    bool found = false;
    for (uint32_t v = 0; v < m->vertex_count; ++v) {
        vec3 p = mesh_position(m, v);
        if (is_face && !is_face[v])
            continue;
        if (!found)
            *out = (bounds){p, p};
        found = true;
        out->low = (vec3){fmin(out->low.x, p.x), fmin(out->low.y, p.y), fmin(out->low.z, p.z)};
        out->high = (vec3){fmax(out->high.x, p.x), fmax(out->high.y, p.y), fmax(out->high.z, p.z)};
    }
    return found;
}

/* Finds the plane through the nose, for scans and sculptures, which are not mirror images and may
 * look slightly aside. */
static mrt_result find_plane_of_nose(double *out_x, const mesh *m, const uint8_t *is_face,
                                     const bounds *box, error *err)
{
    enum { BESIDE = 5, ASIDE = 12, COLUMNS = 2 * (ASIDE + BESIDE) + 1 };
    profile *column = malloc(COLUMNS * sizeof *column);
    if (!column)
        return error_set(err, MRT_ERR_MEMORY, "no memory to measure the head");
    const double middle = 0.5 * (box->low.x + box->high.x),
                 step = 0.1 * (box->high.y - box->low.y) / BESIDE;
    for (int i = 0; i < COLUMNS; ++i)
        cut_profile(&column[i], m, is_face, middle + (i - ASIDE - BESIDE) * step, box->low.y,
                    box->high.y);
    double most = -(double)INFINITY;
    *out_x = middle;
    for (int i = BESIDE; i < COLUMNS - BESIDE; ++i) {
        double mm;
        if (find_nose(&mm, &column[i], &column[i - BESIDE], &column[i + BESIDE]) < 0 || mm <= most)
            continue;
        most = mm;
        *out_x = middle + (i - ASIDE - BESIDE) * step;
    }
    free(column);
    return MRT_OK;
}

static mrt_result choose_plane(double *out_x, const mesh *m, const uint8_t *is_face,
                               const bounds *box, error *err)
{
    const double middle = 0.5 * (box->low.x + box->high.x),
                 reach_mm = 0.002 * (box->high.y - box->low.y);
    uint32_t at_zero, at_middle, example, count = 0;
    if (!rig_mirror_count_alone(&at_zero, &example, m, is_face, 0.0, reach_mm) ||
        !rig_mirror_count_alone(&at_middle, &example, m, is_face, middle, reach_mm))
        return error_set(err, MRT_ERR_MEMORY, "no memory to measure the head");
    for (uint32_t v = 0; v < m->vertex_count; ++v)
        count += !is_face || is_face[v];
    *out_x = at_zero <= at_middle ? 0.0 : middle;
    if (2 * (uint64_t)(at_zero <= at_middle ? at_zero : at_middle) <= count)
        return MRT_OK;
    return find_plane_of_nose(out_x, m, is_face, box, err);
}

/* Measures outwards from the middle until the front no longer belongs to the face. The border is at
 * 0.58 of the depth from the back, as at the first points of the jaw line on the ICT face (26 719
 * vertices). */
static double measure_half_width(const mesh *m, const uint8_t *is_face, const rig_head *head,
                                 double reach_mm)
{
    const int steps = 48;
    double limit_z = head->back_z + 0.58 * (head->nose.z - head->back_z), width = 0.0;
    for (int i = 1; i <= steps; ++i) {
        vec3 hit;
        uint32_t vertex;
        double x = reach_mm * i / steps;
        if (!rig_head_hit(&hit, &vertex, m, is_face, head->middle_x + x, head->nose.y) ||
            hit.z < limit_z)
            break;
        width = x;
    }
    return width;
}

/* Returns where the lips end, at or before `last`: a groove that then turns up or down by more than
 * 45 degrees, and far, is a fold of the cheek. */
static int end_of_lips(const double *groove_y, int last, double step_mm, double span_mm)
{
    for (int i = last / 2 + 1; i <= last; ++i)
        if (fabs(groove_y[i] - groove_y[i - 1]) > step_mm &&
            fabs(groove_y[last] - groove_y[i - 1]) > 0.12 * span_mm)
            return i - 1;
    return last;
}

/* Follows the groove between the lips outwards until it ends. */
static void follow_mouth(profile *p, rig_head *head, const mesh *m, const uint8_t *is_face,
                         int mouth, int span)
{
    const int steps = RIG_GROOVE - 1;
    double groove[RIG_GROOVE] = {head->mouth_y};
    int last = 0;
    const double low_y = p->low_y, high_y = p->low_y + ROWS * p->row_mm;
    for (int i = 1; i <= steps; ++i) {
        double x = 0.9 * head->half_width * i / steps, deepest = 0.0;
        int best = mouth;
        cut_profile(p, m, is_face, head->middle_x + x, low_y, high_y);
        for (int row = mouth - span * 6 / 100 - 1; row <= mouth + span * 6 / 100 + 1; ++row) {
            double depth = depth_at(p, row, span * 8 / 100 + 1);
            if (depth > deepest) {
                deepest = depth;
                best = row;
            }
        }
        if (deepest < 0.25 * head->mouth_depth)
            break;
        mouth = best;
        groove[i] = row_y(p, mouth);
        last = i;
    }
    last = end_of_lips(groove, last, 0.9 * head->half_width / steps, span * p->row_mm);
    head->corner_x = 0.9 * head->half_width * last / steps;
    for (int i = 0; i < RIG_GROOVE; ++i) {
        double at = (double)last * i / steps;
        int from = (int)at, to = from < last ? from + 1 : from;
        head->groove_y[i] = groove[from] + (at - from) * (groove[to] - groove[from]);
    }
}

/* True for a mask: it has no back, so its cut is a single line. */
static bool is_mask(const profile *p)
{
    int rows = 0, thin = 0;
    for (int row = 0; row < ROWS; ++row) {
        bool is_there = isfinite(p->front[row]);
        rows += is_there;
        thin += is_there && p->front[row] - p->back[row] < 0.1 * ROWS * p->row_mm;
    }
    return 10 * thin > 8 * rows;
}

static void measure_profile(rig_head *out, profile p[3], const mesh *m, const uint8_t *is_face,
                            int nose, int chin, double least_depth)
{
    int span = nose - chin, mouth = find_mouth(p, nose, chin, &out->mouth_depth);
    double lips_y;
    out->nose = (vec3){out->middle_x, row_y(p, nose), p->front[nose]};
    out->chin = (vec3){out->middle_x, row_y(p, chin), p->front[chin]};
    out->has_touching_lips = find_touching(&lips_y, m, is_face, out);
    if (out->has_touching_lips) {
        mouth = (int)floor((lips_y - p->low_y) / p->row_mm);
        out->mouth_depth = fmax(depth_at(p, mouth, span * 8 / 100 + 1), 0.0);
    }
    out->mouth_y = row_y(p, mouth);
    int upper = find_lip(p, mouth, 1, span * 16 / 100 + 1);
    int lower = find_lip(p, mouth, -1, span * 16 / 100 + 1);
    out->lip_upper_y = row_y(p, upper);
    out->lip_lower_y = row_y(p, lower);
    out->mouth_z = fmin(p->front[upper], p->front[lower]);
    /* The cut may run along the inside of an open mouth. */
    const double behind = fmin(out->nose.z, out->chin.z) - 0.25 * (out->nose.y - out->chin.y);
    out->mouth_z = isfinite(out->mouth_z) ? fmax(out->mouth_z, behind) : out->chin.z;
    out->back_z = out->nose.z;
    for (int row = chin; row < ROWS; ++row)
        out->back_z = fmin(out->back_z, p->back[row]);
    for (int row = chin; row < ROWS; ++row)
        out->top_y = isfinite(p->front[row]) ? row_y(p, row) : out->top_y;
    out->back_z = fmin(out->back_z, out->nose.z - least_depth);
    bounds box = {{0, 0, 0}, {0, 0, 0}};
    (void)bounds_of(&box, m, is_face);
    out->half_width = measure_half_width(m, is_face, out, 0.5 * (box.high.x - box.low.x));
    if (out->mouth_depth > 0.01 * (out->nose.y - out->chin.y))
        follow_mouth(&p[1], out, m, is_face, mouth, span);
}

/* A row of the profile by its height, 0..1; -1: nothing is there. */
static int plain_row(const profile *p, double up)
{
    int low = 0, high = ROWS - 1;
    while (low < ROWS && !isfinite(p->front[low]))
        low += 1;
    while (high > low && !isfinite(p->front[high]))
        high -= 1;
    const int row = low + (int)(up * (high - low));
    return row < ROWS && isfinite(p->front[row]) ? row : -1;
}

/* Whether no row comes forward more than the usual one, and none lies behind those above and below
 * it: a ball, a barrel or a box. */
static bool is_plain(const rig_head *head, const profile p[3], int nose, int chin)
{
    double out[ROWS], front[ROWS];
    uint32_t count = 0;
    const double height = ROWS * p->row_mm;
    const int span = nose - chin, reach = span * 8 / 100 + 1;
    const int mouth = (int)floor((head->mouth_y - p->low_y) / p->row_mm);
    for (int row = 0; row < ROWS; ++row)
        if (isfinite(p->front[row])) {
            out[count] = prominence(&p[0], &p[1], &p[2], row);
            front[count++] = p->front[row];
        }
    double lips = 0.0;
    if (mouth >= reach && mouth + reach < ROWS)
        lips = fmin(p->front[mouth - reach], p->front[mouth + reach]) - p->front[mouth];
    return prominence(&p[0], &p[1], &p[2], nose) - percentile(out, count, 0.5) < 0.01 * height &&
           p->front[nose] - percentile(front, count, 0.5) < 0.12 * height &&
           !(lips > 0.01 * span * p->row_mm) && !head->has_touching_lips;
}

/* ---- rays ---- */

/* Computes the barycentric coordinates of the point in the triangle, seen along z. */
static bool covers(double share[3], const vec3 corner[3], double x, double y)
{
    double area = (corner[1].x - corner[0].x) * (corner[2].y - corner[0].y) -
                  (corner[2].x - corner[0].x) * (corner[1].y - corner[0].y);
    if (!(fabs(area) > 1e-12))
        return false;
    for (int i = 0; i < 3; ++i) {
        vec3 a = corner[(i + 1) % 3], b = corner[(i + 2) % 3];
        share[i] = ((b.x - a.x) * (y - a.y) - (x - a.x) * (b.y - a.y)) / area;
        if (!(share[i] >= -1e-9))
            return false;
    }
    return true;
}

static uint32_t nearest_corner(const mesh *m, uint32_t triangle, vec3 to)
{
    uint32_t best = m->triangle[(size_t)triangle * 3];
    double best_mm = (double)INFINITY;
    for (size_t i = 0; i < 3; ++i) {
        uint32_t vertex = m->triangle[(size_t)triangle * 3 + i];
        double mm = vec3_length(vec3_sub(mesh_position(m, vertex), to));
        if (mm < best_mm) {
            best_mm = mm;
            best = vertex;
        }
    }
    return best;
}

bool rig_head_hit(vec3 *out_point, uint32_t *out_vertex, const mesh *m, const uint8_t *is_face,
                  double x, double y)
{
    bool found = false;
    uint32_t best = 0;
    for (uint32_t i = 0; i < m->triangle_count; ++i) {
        vec3 corner[3];
        double share[3];
        triangle_corners(corner, m, i);
        if (!is_of_face(m, is_face, i) || !covers(share, corner, x, y))
            continue;
        double z = share[0] * corner[0].z + share[1] * corner[1].z + share[2] * corner[2].z;
        if (found && z <= out_point->z)
            continue;
        *out_point = (vec3){x, y, z};
        best = i;
        found = true;
    }
    if (found)
        *out_vertex = nearest_corner(m, best, *out_point);
    return found;
}

/* ---- doubts ---- */

enum { DEPTH_CELLS = 64 };

/* Writes the z of the foremost surface in the middle of each cell of a square of size_mm. */
static void draw_depth(double depth[DEPTH_CELLS][DEPTH_CELLS], const mesh *m,
                       const uint8_t *is_face, double low_x, double low_y, double size_mm)
{
    const double cell_mm = size_mm / DEPTH_CELLS;
    for (int y = 0; y < DEPTH_CELLS; ++y)
        for (int x = 0; x < DEPTH_CELLS; ++x)
            depth[y][x] = -(double)INFINITY;
    for (uint32_t i = 0; i < m->triangle_count; ++i) {
        vec3 corner[3];
        if (!is_of_face(m, is_face, i))
            continue;
        triangle_corners(corner, m, i);
        double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
        for (int k = 0; k < 3; ++k) {
            const double at[2] = {(corner[k].x - low_x) / cell_mm, (corner[k].y - low_y) / cell_mm};
            for (int axis = 0; axis < 2; ++axis) {
                low[axis] = fmax(fmin(low[axis], at[axis]), 0.0);
                high[axis] = fmin(fmax(high[axis], at[axis]), DEPTH_CELLS - 1.0);
            }
        }
        for (int y = (int)low[1]; y <= high[1]; ++y)
            for (int x = (int)low[0]; x <= high[0]; ++x) {
                double share[3];
                if (!covers(share, corner, low_x + (x + 0.5) * cell_mm,
                            low_y + (y + 0.5) * cell_mm))
                    continue;
                const double z =
                    share[0] * corner[0].z + share[1] * corner[1].z + share[2] * corner[2].z;
                depth[y][x] = fmax(depth[y][x], z);
            }
    }
}

/* Returns the share of the face, seen from the front, whose mirror image is missing or lies a fifth
 * of the head's height before or behind it. */
static double unevenness(const rig_head *head, const mesh *m, const uint8_t *is_face)
{
    double depth[DEPTH_CELLS][DEPTH_CELLS];
    const double height = head->top_y - head->chin.y, size_mm = 0.8 * height;
    uint32_t seen = 0, uneven = 0;
    draw_depth(depth, m, is_face, head->middle_x - 0.5 * size_mm, head->chin.y - 0.05 * height,
               size_mm);
    for (int y = 0; y < DEPTH_CELLS; ++y)
        for (int x = 0; x < DEPTH_CELLS / 2; ++x) {
            const double left = depth[y][x], right = depth[y][DEPTH_CELLS - 1 - x];
            if (!isfinite(left) && !isfinite(right))
                continue;
            seen += 1;
            if (!(fabs(left - right) <= 0.2 * height)) /* infinite where one side is missing */
                uneven += 1;
        }
    return seen > 0 ? (double)uneven / seen : 0.0;
}

/* The limits lie between heads whose faces were found and others that were taken for faces:
 * tests/bench/heads.sh. */
static head_doubt find_doubt(const rig_head *head, const mesh *m, const uint8_t *is_face)
{
    const double below_nose = (head->nose.y - head->chin.y) / (head->top_y - head->chin.y);
    return unevenness(head, m, is_face) > 0.28            ? HEAD_UNEVEN
           : !(below_nose > 0.25) || !(below_nose < 0.55) ? HEAD_UNUSUAL
                                                          : HEAD_NO_DOUBT;
}

/* ---- the head ---- */

/* Cuts the profile, and those to its left and right. */
static void cut_profiles(profile p[3], const mesh *m, const uint8_t *is_face, double middle_x,
                         double low_y, double high_y)
{
    /* Slightly off the plane, since edges in the plane are not cut by it. */
    const double height = high_y - low_y, x = middle_x + 1e-4 * height, beside = 0.1 * height;
    cut_profile(&p[0], m, is_face, x, low_y, high_y);
    cut_profile(&p[1], m, is_face, x - beside, low_y, high_y);
    cut_profile(&p[2], m, is_face, x + beside, low_y, high_y);
}

/* Returns whether ears or horns rise far above the profile, and writes the top of the profile. */
static bool has_tall_ears(double *out_top_y, const profile *p)
{
    int top = ROWS - 1;
    while (top > 0 && !isfinite(p->front[top]))
        top -= 1;
    *out_top_y = row_y(p, top) + 0.5 * p->row_mm;
    return top < ROWS * 3 / 5 && top > ROWS / 5;
}

mrt_result rig_head_measure(rig_head *out, const mesh *m, const uint8_t *is_face, error *err)
{
    static const char refusal[] = "no profile of a face was found in the mesh: it must look along "
                                  "+z, with +y up, and have a nose and a chin";
    bounds box = {{0, 0, 0}, {0, 0, 0}};
    *out = (rig_head){0};
    if (!bounds_of(&box, m, is_face) || !(box.high.y - box.low.y > 0.0) ||
        !(box.high.z - box.low.z > 0.0) || m->triangle_count == 0)
        return error_set(err, MRT_ERR_UNSUPPORTED, "%s", refusal);
    mrt_result result = choose_plane(&out->middle_x, m, is_face, &box, err);
    profile *p = result < 0 ? NULL : malloc(3 * sizeof *p);
    if (!p)
        return result < 0 ? result
                          : error_set(err, MRT_ERR_MEMORY, "no memory to measure the head");
    double mm, top_y;
    cut_profiles(p, m, is_face, out->middle_x, box.low.y, box.high.y);
    if (has_tall_ears(&top_y, &p[0])) {
        box.high.y = top_y;
        cut_profiles(p, m, is_face, out->middle_x, box.low.y, box.high.y);
    }
    const double height = box.high.y - box.low.y;
    int nose = find_nose(&mm, &p[0], &p[1], &p[2]);
    /* A head that wears a mask is 1.2 times as deep as the mask is high, from chin to hairline. */
    double least_depth = is_mask(&p[0]) ? 1.2 * height : 0.0;
    int chin = nose < 0 ? -1 : find_chin(p, nose, fmax(box.high.z - box.low.z, least_depth));
    bool is_found = nose - chin >= ROWS / 20;
    out->nose_mm = is_found ? prominence(&p[0], &p[1], &p[2], nose) : 0.0;
    if (is_found)
        measure_profile(out, p, m, is_face, nose, chin, least_depth);
    if (!is_found || is_plain(out, p, nose, chin)) {
        nose = plain_row(p, 0.42);
        chin = plain_row(p, 0.08);
        is_found = nose - chin >= ROWS / 20;
        *out = (rig_head){.middle_x = out->middle_x, .doubt = HEAD_PLAIN};
        if (is_found)
            measure_profile(out, p, m, is_face, nose, chin, least_depth);
    } else {
        out->doubt = find_doubt(out, m, is_face);
    }
    free(p);
    if (is_found && out->half_width > 0.0)
        return MRT_OK;
    return error_set(err, MRT_ERR_UNSUPPORTED, "%s", refusal);
}
