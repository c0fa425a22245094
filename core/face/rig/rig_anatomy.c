#include "face/rig/rig_anatomy.h"

#include "base/percentile.h"
#include "face/bind.h"
#include "face/rig/rig_outline.h"
#include "mesh/position.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static mrt_result no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory to look for the face");
}

static vec3 least(vec3 a, vec3 b)
{
    return (vec3){fmin(a.x, b.x), fmin(a.y, b.y), fmin(a.z, b.z)};
}

static vec3 greatest(vec3 a, vec3 b)
{
    return (vec3){fmax(a.x, b.x), fmax(a.y, b.y), fmax(a.z, b.z)};
}

/* ---- names ---- */

static bool has_text(const char *name, const char *text)
{
    size_t length = strlen(text);
    for (; *name; ++name) {
        size_t i = 0;
        while (i < length && tolower((unsigned char)name[i]) == text[i])
            ++i;
        if (i == length)
            return true;
    }
    return false;
}

/* True if a name contains one of the words, ignoring case. Words are lower case; the list ends with
 * NULL. */
static bool anatomy_has_word(const char *name, const char *const *words)
{
    for (; *words; ++words)
        if (has_text(name, *words))
            return true;
    return false;
}

#define WORDS(...) ((const char *const[]){__VA_ARGS__, NULL})

static bool is_eye_name(const char *name)
{
    return has_text(name, "eye") &&
           !anatomy_has_word(name, WORDS("brow", "lash", "lid", "socket", "extra", "shadow",
                                         "occlusion", "glass", "wear"));
}

static bool is_teeth_name(const char *name)
{
    return anatomy_has_word(name, WORDS("teeth", "tooth", "gum", "denture"));
}

static bool is_accessory_name(const char *name)
{
    return anatomy_has_word(name, WORDS("hair", "headwear", "hat", "beanie", "helmet", "glasses",
                                        "eyewear", "earring", "ear.", "ears", "horn", "crown",
                                        "hood", "mask"));
}

static bool is_clothes_name(const char *name)
{
    return anatomy_has_word(name, WORDS("outfit", "cloth", "shirt", "shoe", "footwear", "pants",
                                        "trouser", "dress", "jacket", "hand", "body"));
}

/* ---- the skeleton ---- */

/* Matches joints such as "mixamorig:Head", "J_Bip_C_Head", "Bip01 Head", "DEF-head.001" or
 * "CC_Base_Head". Excludes end joints and control joints. */
static bool is_joint_of(const mesh_joint *joint, const char *role, const char *word)
{
    if (joint->role && joint->role[0])
        return strcmp(joint->role, role) == 0;
    const char *colon = strrchr(joint->name, ':'), *name = colon ? colon + 1 : joint->name;
    if (anatomy_has_word(name, WORDS("end", "top", "nub", "tip", "ctrl", "ik", "gear", "band",
                                     "light", "phone", "forehead")))
        return false;
    for (const char *at = name; *at; ++at) {
        size_t i = 0, length = strlen(word);
        while (i < length && tolower((unsigned char)at[i]) == word[i])
            ++i;
        bool begins = at == name || !isalpha((unsigned char)at[-1]) ||
                      (islower((unsigned char)at[-1]) && isupper((unsigned char)at[0]));
        bool ends = i == length && !islower((unsigned char)at[i]);
        if (begins && ends)
            return true;
    }
    return false;
}

static void mark_below(uint8_t *is_below, const mesh *m, uint32_t root)
{
    memset(is_below, 0, m->joint_count);
    is_below[root] = 1;
    for (uint32_t i = root + 1; i < m->joint_count; ++i)
        if (m->joint[i].parent != MESH_NO_JOINT)
            is_below[i] = is_below[m->joint[i].parent];
}

/* Returns how far a vertex follows marked joints, 0..1. */
static float share_of(const mesh *m, const uint8_t *is_below, uint32_t vertex)
{
    float share = 0.0f;
    for (size_t k = 0; k < MESH_SKIN_WIDTH; ++k) {
        size_t at = (size_t)vertex * MESH_SKIN_WIDTH + k;
        share += is_below[m->skin_joint[at]] ? m->skin_weight[at] : 0.0f;
    }
    return share;
}

/* Finds the joint of the head. Of several heads takes the one in front, or the first of those side
 * by side. */
static mrt_result find_head_joint(rig_anatomy *a, const mesh *m, error *err)
{
    double front = -(double)INFINITY;
    if (!m->skin_joint)
        return MRT_OK;
    uint8_t *is_below = malloc((size_t)m->joint_count + 1);
    if (!is_below)
        return no_memory(err);
    for (uint32_t j = 0; j < m->joint_count; ++j) {
        uint32_t count = 0;
        double z = -(double)INFINITY;
        if (!is_joint_of(&m->joint[j], "head", "head"))
            continue;
        if (a->head_joint != MESH_NO_JOINT && m->joint[j].parent == a->head_joint)
            continue; /* a "head" joint inside a "head" joint */
        mark_below(is_below, m, j);
        for (uint32_t v = 0; v < m->vertex_count; ++v)
            if (share_of(m, is_below, v) >= 0.5f) {
                count += 1;
                z = fmax(z, mesh_position(m, v).z);
            }
        if (count < 16)
            continue;
        a->head_count += 1;
        if (z <= front + 1.0)
            continue;
        front = z;
        a->head_joint = j;
    }
    if (a->head_joint != MESH_NO_JOINT) {
        mark_below(is_below, m, a->head_joint);
        for (uint32_t v = 0; v < m->vertex_count; ++v)
            a->is_head[v] = share_of(m, is_below, v) >= 0.5f;
        for (uint32_t j = a->head_joint; j < m->joint_count; ++j)
            if (is_below[j] && is_joint_of(&m->joint[j], "jaw", "jaw"))
                a->jaw_joint = a->jaw_joint == MESH_NO_JOINT ? j : a->jaw_joint;
        for (uint32_t j = 0; j < m->joint_count; ++j) /* some skeletons have it beside the head */
            if (a->jaw_joint == MESH_NO_JOINT && is_joint_of(&m->joint[j], "jaw", "jaw"))
                a->jaw_joint = j;
        const float *rest = m->joint[a->head_joint].rest;
        a->neck = (vec3){(double)rest[3], (double)rest[7], (double)rest[11]};
        a->source = BY_SKELETON;
        a->has_body = true;
    }
    free(is_below);
    return MRT_OK;
}

static void count_head(rig_anatomy *a, const mesh *m)
{
    for (uint32_t i = 0; i < a->piece_count; ++i)
        a->piece[i].head_count = 0;
    for (uint32_t v = 0; v < m->vertex_count; ++v)
        if (mesh_point(m, v) == v && a->is_head[v] && a->of_vertex[v] < a->piece_count)
            a->piece[a->of_vertex[v]].head_count += 1;
}

static bool is_mostly_head(const anatomy_piece *p)
{
    return 2 * p->head_count > p->point_count;
}

/* ---- balls ---- */

/* Fits a sphere to a piece by least squares: |p|^2 = 2 c p + k. Returns the mean error over the
 * radius, or infinity if there is no sphere. */
static double fit_sphere(vec3 *out_centre, double *out_radius, const rig_anatomy *a, uint32_t piece,
                         const mesh *m)
{
    const anatomy_piece *p = &a->piece[piece];
    const uint32_t *member = a->member + p->first_member;
    double n[4][5] = {{0}}, miss = 0.0;
    for (uint32_t k = 0; k < p->point_count; ++k) {
        vec3 d = vec3_sub(mesh_position(m, member[k]), p->mean);
        double row[5] = {2.0 * d.x, 2.0 * d.y, 2.0 * d.z, 1.0, vec3_dot(d, d)};
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < 5; ++j)
                n[i][j] += row[i] * row[j];
    }
    for (int i = 0; i < 4; ++i) { /* symmetric positive definite, unless the piece is flat */
        if (!(n[i][i] > 1e-9))
            return (double)INFINITY;
        for (int k = 0; k < 4; ++k) {
            double part = k == i ? 0.0 : n[k][i] / n[i][i];
            for (int j = 0; j < 5; ++j)
                n[k][j] -= part * n[i][j];
        }
    }
    vec3 c = {n[0][4] / n[0][0], n[1][4] / n[1][1], n[2][4] / n[2][2]};
    double square = n[3][4] / n[3][3] + vec3_dot(c, c);
    if (!(square > 0.0))
        return (double)INFINITY;
    *out_centre = vec3_add(p->mean, c);
    *out_radius = sqrt(square);
    for (uint32_t k = 0; k < p->point_count; ++k)
        miss += fabs(vec3_length(vec3_sub(mesh_position(m, member[k]), *out_centre)) - *out_radius);
    return miss / p->point_count / *out_radius;
}

/* A pair of eyeballs, one beside the other. */
typedef struct eye_pair {
    vec3 centre[2];
    double radius_mm;
} eye_pair;

enum { EYE_PAIRS_MAX = 64 };

/* Finds pairs of eyeballs in a head of that height. Returns their number. */
static uint32_t find_eye_pairs(eye_pair out[EYE_PAIRS_MAX], const rig_anatomy *a, const mesh *m,
                               double height)
{
    enum { BALLS_MAX = 64 };
    anatomy_eye ball[BALLS_MAX];
    uint32_t count = 0, pair_count = 0;
    for (uint32_t i = 0; i < a->piece_count && count < BALLS_MAX; ++i) {
        const anatomy_piece *p = &a->piece[i];
        vec3 d = vec3_sub(p->high, p->low);
        if (p->point_count >= 20 && is_mostly_head(p) && d.x < 1.4 * d.y && d.y < 1.4 * d.x &&
            d.z > 0.25 * d.x && d.x < 0.35 * height && d.x > 0.02 * height &&
            fit_sphere(&ball[count].centre, &ball[count].radius_mm, a, i, m) < 0.12)
            count += 1;
    }
    for (uint32_t i = 0; i < count; ++i)
        for (uint32_t j = 0; j < count && pair_count < EYE_PAIRS_MAX; ++j) {
            vec3 apart = vec3_sub(ball[i].centre, ball[j].centre);
            double radius = ball[i].radius_mm;
            if (apart.x > 1.5 * radius && apart.x <= 8.0 * radius &&
                hypot(apart.y, apart.z) <= 0.3 * radius &&
                fabs(ball[j].radius_mm - radius) <= 0.2 * radius)
                out[pair_count++] = (eye_pair){{ball[i].centre, ball[j].centre}, radius};
        }
    return pair_count;
}

/* ---- heads by their position ---- */

enum { ROWS = 256 };

typedef struct rows { /* outline of a mesh by height */
    double low_y, row_mm;
    double low_x[ROWS], high_x[ROWS], low_z[ROWS], high_z[ROWS];
} rows;

static int row_of(const rows *r, double y)
{
    double row = floor((y - r->low_y) / r->row_mm); /* NaN for a flat mesh */
    return !(row > 0.0) ? 0 : row < (double)ROWS ? (int)row : ROWS - 1;
}

static void fill_rows(rows *r, const mesh *m, const uint8_t *is_head, vec3 low, vec3 high)
{
    *r = (rows){.low_y = low.y, .row_mm = (high.y - low.y) / ROWS};
    for (int i = 0; i < ROWS; ++i) {
        r->low_x[i] = r->low_z[i] = (double)INFINITY;
        r->high_x[i] = r->high_z[i] = -(double)INFINITY;
    }
    for (uint32_t i = 0; i < m->triangle_count; ++i) {
        const uint32_t *corner = m->triangle + (size_t)i * 3;
        vec3 a = mesh_position(m, corner[0]), b = mesh_position(m, corner[1]),
             c = mesh_position(m, corner[2]);
        vec3 from = least(a, least(b, c)), to = greatest(a, greatest(b, c));
        if (!is_head[corner[0]])
            continue;
        for (int row = row_of(r, from.y), end = row_of(r, to.y); row <= end; ++row) {
            r->low_x[row] = fmin(r->low_x[row], from.x);
            r->high_x[row] = fmax(r->high_x[row], to.x);
            r->low_z[row] = fmin(r->low_z[row], from.z);
            r->high_z[row] = fmax(r->high_z[row], to.z);
        }
    }
}

static double width_at(const rows *r, int row)
{
    double width = r->high_x[row] - r->low_x[row];
    return isfinite(width) ? width : 0.0;
}

/* Returns the first row with skin at or above a row, or -1. */
static int row_with_skin(const rows *r, int row)
{
    while (row < ROWS && !isfinite(r->low_x[row]))
        row += 1;
    return row < ROWS ? row : -1;
}

/* Finds the row of the shoulders, or -1. Below a head the body becomes far wider than the head and
 * stays so. Below ears it does not. */
static int find_shoulders(const rows *r)
{
    enum { CROWN = ROWS / 8 };
    double sorted[ROWS];
    for (int row = ROWS - 1 - CROWN; row > 0; --row) {
        int count = ROWS - 1 - row, wide = 0;
        for (int i = 0; i < count; ++i)
            sorted[i] = width_at(r, row + 1 + i);
        double usual = percentile(sorted, (uint32_t)count, 0.5);
        if (width_at(r, row) < 1.35 * usual)
            continue;
        for (int i = 0; i < row; ++i)
            wide += width_at(r, i) > 1.2 * usual;
        if (10 * wide > 7 * row)
            return row;
    }
    return -1;
}

/* Returns the row under the chin, where the front recedes, searching down from a row to the last
 * row. This is needed because strong necks are wider than jaws. */
static int below_chin(const rows *r, int row, int last)
{
    double front = -(double)INFINITY, back = (double)INFINITY;
    for (int i = row; i < ROWS; ++i) {
        front = fmax(front, r->high_z[i]);
        back = fmin(back, r->low_z[i]);
    }
    while (row > last && r->high_z[row] > front - 0.35 * (front - back))
        row -= 1;
    return row;
}

/* Finds the row where a body is narrowest above its shoulders, or -1. */
static int find_neck_of_body(const rows *r)
{
    int shoulder = find_shoulders(r), neck = shoulder + 1, span = ROWS - shoulder;
    if (shoulder <= ROWS * 2 / 5)
        return -1;
    for (int row = neck; row < shoulder + span * 2 / 5 && row < ROWS; ++row)
        if (width_at(r, row) < 0.97 * width_at(r, neck))
            neck = row;
    return below_chin(r, neck, shoulder + 1);
}

/* Finds the row where the shoulders of a bust begin, or -1. Shoulders are wider than everything
 * above, and most rows below (even a plinth) are wider than the head. Below ears and brims this is
 * not so. The narrowest row is no good measure: collars rise behind the neck and chins are in front
 * of it, so it may be at the jaw. */
static int find_neck_of_bust(const rows *r)
{
    double head = 0.0;
    for (int row = ROWS * 3 / 4; row > ROWS / 4; --row) {
        int height = ROWS - row, wide = 0;
        double below = 0.0;
        for (int i = row + height / 8; i < ROWS; ++i)
            head = fmax(head, width_at(r, i));
        for (int i = row; i >= 0 && i >= row - height / 3; --i)
            below = fmax(below, width_at(r, i));
        for (int i = 0; i < row; ++i)
            wide += width_at(r, i) > 1.15 * head;
        if (width_at(r, row) > 1.2 * head && below > 1.5 * head && 10 * wide > 6 * row)
            return row + 1;
    }
    return -1;
}

/* Figures whose heads are as wide as their bodies, as toys have them: the head is the highest part
 * that is large, and the neck below it is much thinner than both. Ears and hats on it are thin,
 * too. Thickness: by how many cells of the front are covered times the same from the side. Returns
 * the row; -1: there is none. */
static int find_neck_of_figure(const rig_anatomy *a, const mesh *m, vec3 low, vec3 high)
{
    enum { CELLS = 64 };
    const double size[3] = {high.x - low.x, high.y - low.y, high.z - low.z};
    double thick[ROWS], most = 0.0;
    uint64_t covered[ROWS][2] = {{0}};
    for (uint32_t i = 0; i < m->triangle_count; ++i) {
        const uint32_t *corner = m->triangle + (size_t)i * 3;
        const vec3 p[3] = {mesh_position(m, corner[0]), mesh_position(m, corner[1]),
                           mesh_position(m, corner[2])};
        const vec3 from = least(p[0], least(p[1], p[2])), to = greatest(p[0], greatest(p[1], p[2]));
        if (!a->is_head[corner[0]])
            continue;
        const double ends[2][2] = {{from.x - low.x, to.x - low.x}, {from.z - low.z, to.z - low.z}};
        for (int side = 0; side < 2; ++side) {
            const double cell = size[2 * side] / CELLS;
            const int first = (int)fmin(ends[side][0] / cell, CELLS - 1.0);
            const int last = (int)fmin(ends[side][1] / cell, CELLS - 1.0);
            const uint64_t bits = (UINT64_MAX >> (CELLS - 1 - (last - first))) << first;
            const int end = (int)fmin((to.y - low.y) / size[1] * ROWS, ROWS - 1.0);
            for (int row = (int)fmin((from.y - low.y) / size[1] * ROWS, ROWS - 1.0); row <= end;
                 ++row)
                covered[row][side] |= bits;
        }
    }
    for (int row = 0; row < ROWS; ++row) {
        thick[row] = (double)__builtin_popcountll(covered[row][0]) *
                     (double)__builtin_popcountll(covered[row][1]);
        most = fmax(most, thick[row]);
    }
    int head = ROWS - 1; /* the thickest row of the highest part that is large */
    while (head > 0 && thick[head] < 0.35 * most)
        head -= 1;
    for (int row = head; row > 0 && thick[row] > 0.6 * thick[head]; --row)
        head = thick[row] > thick[head] ? row : head;
    int neck = head;
    for (int row = head; row > ROWS / 10 && thick[row] < 1.5 * thick[neck] + 1.0; --row)
        neck = thick[row] < thick[neck] ? row : neck;
    double body = 0.0;
    for (int row = 0; row < neck; ++row)
        body = fmax(body, thick[row]);
    const bool is_narrow = __builtin_popcountll(covered[neck][0]) * 10 <
                           __builtin_popcountll(covered[head][0]) * 8; /* also from the front */
    const bool is_thin = is_narrow && thick[neck] < 0.55 * thick[head] && thick[neck] < 0.7 * body;
    return is_thin && body > 0.4 * thick[head] && 10 * (ROWS - neck) > 4 * ROWS &&
                   10 * neck > 4 * ROWS
               ? neck
               : -1;
}

static double size_of(const anatomy_piece *p)
{
    vec3 d = vec3_sub(p->high, p->low);
    return d.x * d.y * d.z;
}

/* Whether a piece of a figure may be its head: in the upper half, neither long nor flat. */
static bool may_be_head(const rig_anatomy *a, const anatomy_piece *p, const rows *r)
{
    const double height = ROWS * r->row_mm;
    const vec3 size = vec3_sub(p->high, p->low);
    const double wide = fmax(size.x, size.z), deep = fmin(size.x, size.z);
    return p->point_count > 0 && a->is_head[p->vertex] && size.y < 2.0 * wide &&
           wide < 2.5 * size.y && wide < 2.5 * deep && size.y > 0.1 * height &&
           size.y < 0.75 * height && p->low.y > r->low_y + 0.25 * height &&
           p->low.y + p->high.y > 2.0 * r->low_y + 0.9 * height;
}

/* Figures that are made of a piece for each limb: the head is the highest large piece that may be
 * one, where other large pieces are below it. Sets head_piece. Returns the row of its lower end;
 * -1: there is none. */
static int find_neck_by_pieces(rig_anatomy *a, const rows *r)
{
    const double height = ROWS * r->row_mm;
    const anatomy_piece *head = NULL;
    double below = 0.0, largest = 0.0;
    for (uint32_t i = 0; i < a->piece_count; ++i)
        if (may_be_head(a, &a->piece[i], r))
            largest = fmax(largest, size_of(&a->piece[i]));
    for (uint32_t i = 0; i < a->piece_count; ++i) {
        const anatomy_piece *p = &a->piece[i];
        if (may_be_head(a, p, r) && size_of(p) > 0.35 * largest &&
            (!head || p->low.y > head->low.y))
            head = p;
    }
    for (uint32_t i = 0; head && i < a->piece_count; ++i) {
        const anatomy_piece *p = &a->piece[i];
        const double tall = p->high.y - p->low.y, into = p->high.y - head->low.y;
        if (p == head || p->point_count == 0 || !a->is_head[p->vertex] ||
            p->low.y > head->low.y - 0.1 * height)
            continue;
        if (into > 0.5 * tall || into > 0.5 * (head->high.y - head->low.y))
            return -1; /* hair or a hat on the head */
        below += size_of(p);
    }
    const bool has_body =
        head && head->low.y - r->low_y > 0.25 * height && below > 0.3 * size_of(head);
    if (!has_body)
        return -1;
    a->head_piece = (uint32_t)(head - a->piece);
    return row_of(r, head->low.y);
}

/* Whether a pair of eyeballs lies below the row, in what may be a face. */
static bool has_eyes_below(const rig_anatomy *a, const mesh *m, const rows *r, int row)
{
    eye_pair pair[EYE_PAIRS_MAX];
    const double height = ROWS * r->row_mm;
    for (uint32_t i = row < 0 ? 0 : find_eye_pairs(pair, a, m, height); i-- > 0;)
        if (pair[i].centre[0].y < r->low_y + row * r->row_mm &&
            pair[i].centre[0].y > r->low_y + 0.3 * height)
            return true;
    return false;
}

/* Cuts off what lies behind and below the head of an animal on four legs. Returns false if it is
 * none. */
static bool cut_off_animal(rig_anatomy *a, const mesh *m, vec3 low, vec3 high)
{
    outline_head head;
    if (!rig_outline_find_head(&head, m, a->is_head, low, high))
        return false;
    a->neck_up = (vec3){0.0, head.up_y, head.up_z};
    a->neck = vec3_sub((vec3){0.5 * (low.x + high.x), head.y, head.z},
                       vec3_scale(a->neck_up, 1.1 * head.radius_mm));
    a->legs_y = head.y - 1.3 * head.radius_mm;
    for (uint32_t v = 0; v < m->vertex_count; ++v) {
        const vec3 p = mesh_position(m, v);
        a->is_head[v] &= p.y >= a->legs_y && vec3_dot(vec3_sub(p, a->neck), a->neck_up) >= 0.0;
    }
    a->has_body = a->is_on_four_legs = true;
    return true;
}

/* Cuts the head off at the neck. A head alone has no shoulders. A whole body is far higher than it
 * is deep. */
static void cut_off_body(rig_anatomy *a, const mesh *m, vec3 low, vec3 high)
{
    rows *r = malloc(sizeof *r);
    if (!r)
        return;
    if (cut_off_animal(a, m, low, high)) {
        free(r);
        return;
    }
    fill_rows(r, m, a->is_head, low, high);
    count_head(a, m);
    bool is_tall = high.y - low.y > 2.2 * (high.z - low.z);
    int neck = find_neck_by_pieces(a, r);
    if (has_eyes_below(a, m, r, neck)) {
        neck = -1;
        a->head_piece = UINT32_MAX;
    }
    if (neck < 0)
        neck = is_tall ? find_neck_of_body(r) : find_neck_of_bust(r);
    if (neck < 0)
        neck = find_neck_of_figure(a, m, low, high);
    if (has_eyes_below(a, m, r, neck))
        neck = -1;
    if (neck >= 0)
        neck = row_with_skin(r, neck); /* the head may hover above its body */
    if (neck >= 0) {
        double y = r->low_y + neck * r->row_mm;
        for (uint32_t v = 0; v < m->vertex_count; ++v)
            a->is_head[v] &= mesh_position(m, v).y >= y;
        a->neck = (vec3){0.5 * (r->low_x[neck] + r->high_x[neck]), y,
                         0.6 * r->low_z[neck] + 0.4 * r->high_z[neck]};
        a->has_body = true;
    }
    free(r);
}

static bool overlap(const anatomy_piece *p, const anatomy_piece *q)
{
    return p->low.x <= q->high.x && q->low.x <= p->high.x && p->low.y <= q->high.y &&
           q->low.y <= p->high.y && p->low.z <= q->high.z && q->low.z <= p->high.z;
}

/* Groups pieces with overlapping boxes into figures. Each figure at least half as large as the
 * largest counts as a head. The one in front is performed, or the first of those side by side. */
static mrt_result choose_figure(rig_anatomy *a, const mesh *m, error *err)
{
    enum { MANY = 2000 }; /* further pieces are not grouped */
    uint32_t count = a->piece_count < MANY ? a->piece_count : MANY;
    uint32_t *figure = malloc(((size_t)count + 1) * sizeof *figure);
    anatomy_piece *box = malloc(((size_t)count + 1) * sizeof *box);
    if (!figure || !box) {
        free(figure);
        free(box);
        return no_memory(err);
    }
    for (uint32_t i = 0; i < count; ++i) {
        figure[i] = i;
        box[i] = a->piece[i];
    }
    for (bool grows = true; grows;) {
        grows = false;
        for (uint32_t i = 0; i < count; ++i)
            for (uint32_t j = i + 1; figure[i] == i && j < count; ++j)
                if (figure[j] == j && overlap(&box[i], &box[j])) {
                    box[i].low = least(box[i].low, box[j].low);
                    box[i].high = greatest(box[i].high, box[j].high);
                    figure[j] = i;
                    grows = true;
                }
    }
    for (uint32_t i = 0; i < count; ++i)
        while (figure[i] != figure[figure[i]])
            figure[i] = figure[figure[i]];
    double largest = 0.0;
    for (uint32_t i = 0; i < count; ++i)
        largest = figure[i] == i ? fmax(largest, size_of(&box[i])) : largest;
    uint32_t best = 0;
    bool found = false;
    for (uint32_t i = 0; i < count; ++i) {
        if (figure[i] != i || size_of(&box[i]) < 0.5 * largest)
            continue;
        a->head_count += 1;
        if (found &&
            box[i].high.z <= box[best].high.z + 0.02 * (box[best].high.z - box[best].low.z))
            continue;
        best = i;
        found = true;
    }
    for (uint32_t v = 0; a->head_count > 1 && v < m->vertex_count; ++v)
        a->is_head[v] = a->of_vertex[v] < count && figure[a->of_vertex[v]] == best;
    if (a->head_count > 1)
        a->has_body = true;
    a->neck = (vec3){0.5 * (box[best].low.x + box[best].high.x), box[best].low.y,
                     0.6 * box[best].low.z + 0.4 * box[best].high.z};
    free(figure);
    free(box);
    return MRT_OK;
}

static mrt_result find_head_by_shape(rig_anatomy *a, const mesh *m, error *err)
{
    for (uint32_t v = 0; v < m->vertex_count; ++v)
        a->is_head[v] =
            a->of_vertex[v] < a->piece_count; /* vertices without a surface belong to no head */
    a->head_count = 0;
    mrt_result result = choose_figure(a, m, err);
    vec3 low = {0, 0, 0}, high = {0, 0, 0};
    bool found = false;
    for (uint32_t v = 0; result >= 0 && v < m->vertex_count; ++v) {
        vec3 p = mesh_position(m, v);
        if (!a->is_head[v])
            continue;
        low = found ? least(low, p) : p;
        high = found ? greatest(high, p) : p;
        found = true;
    }
    if (result >= 0 && high.y > low.y)
        cut_off_body(a, m, low, high);
    return result;
}

/* ---- pieces ---- */

static mrt_result measure_pieces(rig_anatomy *a, const mesh *m, const topology *t, error *err)
{
    a->of_vertex = malloc(((size_t)m->vertex_count + 1) * sizeof *a->of_vertex);
    if (!a->of_vertex)
        return no_memory(err);
    mrt_result result = topology_pieces(a->of_vertex, &a->piece_count, m, t, err);
    if (result < 0)
        return result;
    a->piece = calloc((size_t)a->piece_count + 1, sizeof *a->piece);
    if (!a->piece)
        return no_memory(err);
    for (uint32_t v = 0; v < m->vertex_count; ++v) {
        anatomy_piece *p = &a->piece[a->of_vertex[v]];
        vec3 at = mesh_position(m, v);
        if (mesh_point(m, v) != v)
            continue;
        if (p->point_count == 0)
            *p = (anatomy_piece){.vertex = v, .low = at, .high = at, .part = UINT32_MAX};
        p->low = least(p->low, at);
        p->high = greatest(p->high, at);
        p->mean = vec3_add(p->mean, at);
        p->point_count += 1;
    }
    a->member = malloc(((size_t)m->vertex_count + 1) * sizeof *a->member);
    if (!a->member)
        return no_memory(err);
    uint32_t next = 0;
    for (uint32_t i = 0; i <= a->piece_count; ++i) {
        a->piece[i].first_member = next;
        next += a->piece[i].point_count;
        a->piece[i].point_count = 0;
    }
    for (uint32_t v = 0; v < m->vertex_count; ++v) {
        anatomy_piece *p = &a->piece[a->of_vertex[v]];
        if (mesh_point(m, v) == v)
            a->member[p->first_member + p->point_count++] = v;
    }
    for (uint32_t i = 0; i < a->piece_count; ++i)
        a->piece[i].mean = vec3_scale(a->piece[i].mean, 1.0 / a->piece[i].point_count);
    for (uint32_t i = 0; i < m->part_count; ++i)
        for (uint32_t k = 0; k < m->part[i].triangle_count; ++k) {
            uint32_t corner = m->triangle[3 * ((size_t)m->part[i].first_triangle + k)];
            anatomy_piece *p = &a->piece[a->of_vertex[corner]];
            p->part = p->part == UINT32_MAX ? i : p->part;
        }
    return MRT_OK;
}

/* Returns the name of a piece's part, or "" if all parts have the same name. Joined meshes keep the
 * name of one of them. */
static const char *name_of(const mesh *m, const anatomy_piece *p)
{
    for (uint32_t i = 0; p->part < m->part_count && i < m->part_count; ++i)
        if (strcmp(m->part[i].name, m->part[p->part].name) != 0)
            return m->part[p->part].name;
    return "";
}

static const char *material_of(const mesh *m, const anatomy_piece *p)
{
    if (p->part >= m->part_count)
        return "";
    const char *own = m->material[m->part[p->part].material].name;
    for (uint32_t i = 0; i < m->part_count; ++i)
        if (strcmp(m->material[m->part[i].material].name, own) != 0)
            return own;
    return "";
}

/* True if one of the names of a piece matches. */
static bool matches_name(const mesh *m, const anatomy_piece *p, bool (*as)(const char *name))
{
    return as(name_of(m, p)) || as(material_of(m, p));
}

/* ---- the face: the piece with the largest visible area from the front ---- */

enum { PIXELS = 192 };

typedef struct front_view {
    vec3 low, high;
    double z[PIXELS * PIXELS];
    uint32_t piece[PIXELS * PIXELS];
} front_view;

static int pixel_of(double at, double low, double high)
{
    int pixel = (int)floor((at - low) / (high - low) * PIXELS);
    return pixel < 0 ? 0 : pixel >= PIXELS ? PIXELS - 1 : pixel;
}

static double centre_of(int pixel, double low, double high)
{
    return low + (pixel + 0.5) / PIXELS * (high - low);
}

static void draw_pixel(front_view *f, int x, int y, double z, uint32_t piece)
{
    size_t pixel = (size_t)y * PIXELS + (size_t)x;
    if (!(z > f->z[pixel]))
        return;
    f->z[pixel] = z;
    f->piece[pixel] = piece;
}

/* Draws the pixels whose centre the triangle covers. A small triangle draws at least the pixel of
 * its own middle. */
static void draw_triangle(front_view *f, const mesh *m, uint32_t triangle, uint32_t piece)
{
    const uint32_t *corner = m->triangle + (size_t)triangle * 3;
    vec3 a = mesh_position(m, corner[0]), b = mesh_position(m, corner[1]),
         c = mesh_position(m, corner[2]);
    vec3 middle = vec3_scale(vec3_add(a, vec3_add(b, c)), 1.0 / 3.0);
    vec3 from = least(a, least(b, c)), to = greatest(a, greatest(b, c));
    int first_x = pixel_of(from.x, f->low.x, f->high.x),
        last_x = pixel_of(to.x, f->low.x, f->high.x);
    int first_y = pixel_of(from.y, f->low.y, f->high.y),
        last_y = pixel_of(to.y, f->low.y, f->high.y);
    double area = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
    draw_pixel(f, pixel_of(middle.x, f->low.x, f->high.x), pixel_of(middle.y, f->low.y, f->high.y),
               middle.z, piece);
    for (int y = first_y; area != 0.0 && y <= last_y; ++y)
        for (int x = first_x; x <= last_x; ++x) {
            double px = centre_of(x, f->low.x, f->high.x) - a.x;
            double py = centre_of(y, f->low.y, f->high.y) - a.y;
            double u = (px * (c.y - a.y) - (c.x - a.x) * py) / area;
            double v = ((b.x - a.x) * py - px * (b.y - a.y)) / area;
            if (u >= 0.0 && v >= 0.0 && u + v <= 1.0)
                draw_pixel(f, x, y, a.z + u * (b.z - a.z) + v * (c.z - a.z), piece);
        }
}

static bool may_be_face(const rig_anatomy *a, const mesh *m, uint32_t piece)
{
    const anatomy_piece *p = &a->piece[piece];
    return p->head_count >= 8 && !matches_name(m, p, is_accessory_name) &&
           !matches_name(m, p, is_eye_name) && !matches_name(m, p, is_teeth_name);
}

/* Counts the points of a piece within reach_mm of a point. */
static uint32_t count_near(const rig_anatomy *a, const mesh *m, const anatomy_piece *p,
                           vec3 location, double reach_mm)
{
    uint32_t count = 0;
    for (uint32_t k = 0; k < p->point_count; ++k)
        count += vec3_length(vec3_sub(mesh_position(m, a->member[p->first_member + k]), location)) <
                 reach_mm;
    return count;
}

/* Multiplies the visible area of skin around a pair of eyeballs by four, since hats and hair can be
 * larger. */
static void prefer_sockets(double *visible, const rig_anatomy *a, const mesh *m, double height)
{
    enum { NEAR_LEAST = 4 };
    eye_pair pair[EYE_PAIRS_MAX];
    const uint32_t count = find_eye_pairs(pair, a, m, height);
    for (uint32_t k = 0; k < a->piece_count; ++k) {
        bool holds = false;
        for (uint32_t i = 0; i < count && !holds && visible[k] > 0.0; ++i) {
            const double reach_mm = 1.5 * pair[i].radius_mm;
            holds = count_near(a, m, &a->piece[k], pair[i].centre[0], reach_mm) >= NEAR_LEAST &&
                    count_near(a, m, &a->piece[k], pair[i].centre[1], reach_mm) >= NEAR_LEAST;
        }
        visible[k] *= holds ? 4.0 : 1.0;
    }
}

static mrt_result find_face(rig_anatomy *a, const mesh *m, error *err)
{
    front_view *f = calloc(1, sizeof *f);
    double *visible = calloc((size_t)a->piece_count + 1, sizeof *visible);
    bool found = false;
    a->face = a->piece_count;
    for (uint32_t v = 0; f && v < m->vertex_count; ++v) {
        vec3 p = mesh_position(m, v);
        if (!a->is_head[v])
            continue;
        f->low = found ? least(f->low, p) : p;
        f->high = found ? greatest(f->high, p) : p;
        found = true;
    }
    bool has_memory = f && visible;
    bool is_flat = !found || !(f->high.x > f->low.x) || !(f->high.y > f->low.y);
    for (size_t i = 0; has_memory && i < PIXELS * PIXELS; ++i) {
        f->z[i] = -(double)INFINITY;
        f->piece[i] = a->piece_count;
    }
    for (uint32_t i = 0; has_memory && !is_flat && i < m->triangle_count; ++i) {
        uint32_t corner = m->triangle[(size_t)i * 3];
        if (a->is_head[corner] && may_be_face(a, m, a->of_vertex[corner]))
            draw_triangle(f, m, i, a->of_vertex[corner]);
    }
    for (size_t i = 0; has_memory && i < PIXELS * PIXELS; ++i)
        visible[f->piece[i]] += 1.0;
    if (has_memory && found)
        prefer_sockets(visible, a, m, f->high.y - f->low.y);
    for (uint32_t i = 0; has_memory && i < a->piece_count; ++i) {
        if (anatomy_has_word(name_of(m, &a->piece[i]), WORDS("head", "face")))
            visible[i] *= 4.0;
        const vec3 size = vec3_sub(a->piece[i].high, a->piece[i].low);
        visible[i] *= fmin(2.0 * size.y / fmax(size.x, 1e-9), 1.0); /* brims are flat */
        if (i == a->head_piece)
            visible[i] *= 4.0;
        if (visible[i] > 0.0 && (a->face == a->piece_count || visible[i] > visible[a->face]))
            a->face = i;
    }
    free(f);
    free(visible);
    if (!has_memory)
        return no_memory(err);
    if (a->face == a->piece_count)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "no profile of a face was found in the mesh: no surface faces +z");
    for (uint32_t v = 0; v < m->vertex_count; ++v)
        a->is_face[v] = a->is_head[v] && a->of_vertex[v] == a->face;
    a->piece[a->face].kind = PIECE_FACE;
    a->piece[a->face].source = a->source;
    return MRT_OK;
}

/* ---- kinds of the other pieces ---- */

static void set_kind(anatomy_piece *p, piece_kind kind, anatomy_source source)
{
    p->kind = kind;
    p->source = source;
}

/* True for an eyeball: a ball of an eye's size in front, above the nose. */
static bool is_ball(anatomy_eye *out, const rig_anatomy *a, uint32_t piece, const mesh *m)
{
    const anatomy_piece *p = &a->piece[piece];
    const rig_head *head = &a->head;
    double height = head->top_y - head->chin.y, depth = head->nose.z - head->back_z;
    vec3 d = vec3_sub(p->high, p->low);
    if (p->point_count < 20 || !is_mostly_head(p) || d.x > 1.4 * d.y || d.y > 1.4 * d.x ||
        d.z < 0.25 * d.x || d.x > 0.35 * height || d.x < 0.03 * height)
        return false;
    if (!(fit_sphere(&out->centre, &out->radius_mm, a, piece, m) < 0.12) ||
        out->radius_mm > 0.25 * height)
        return false;
    double aside = fabs(out->centre.x - head->middle_x);
    return out->centre.y > head->mouth_y && out->centre.z > head->back_z + 0.4 * depth &&
           aside > 0.6 * out->radius_mm && aside < 1.1 * head->half_width;
}

static anatomy_eye *eye_at(rig_anatomy *a, double x)
{
    return &a->eye[x > a->head.middle_x ? 0 : 1];
}

static void set_eye(rig_anatomy *a, uint32_t piece, const anatomy_eye *ball, anatomy_source source)
{
    anatomy_eye *eye = eye_at(a, ball->centre.x);
    if (!eye->is_found || ball->radius_mm > eye->radius_mm)
        *eye = (anatomy_eye){true, ball->centre, ball->radius_mm};
    set_kind(&a->piece[piece], eye == &a->eye[0] ? PIECE_EYE_LEFT : PIECE_EYE_RIGHT, source);
}

/* True for pupils, irises and corneas: in the middle of an eyeball, and not far beyond it. */
static bool is_in_eye(const anatomy_eye *eye, const anatomy_piece *p)
{
    vec3 middle = vec3_scale(vec3_add(p->low, p->high), 0.5);
    vec3 off = vec3_sub(middle, eye->centre), d = vec3_sub(p->high, p->low);
    return eye->is_found && d.x < 1.4 * d.y && d.y < 1.4 * d.x &&
           hypot(off.x, off.y) < 0.25 * eye->radius_mm && fmax(d.x, d.y) < 2.3 * eye->radius_mm &&
           off.z > -0.5 * eye->radius_mm && off.z < 1.3 * eye->radius_mm;
}

typedef struct ball {
    uint32_t piece;
    anatomy_eye as;
} ball;

/* Adds both eyes of a pair if one is the mirror image of the other. */
static void set_eye_pair(rig_anatomy *a, const ball *one, const ball *other)
{
    vec3 c = other->as.centre, image = {2.0 * a->head.middle_x - c.x, c.y, c.z};
    if (a->piece[one->piece].kind != PIECE_UNKNOWN ||
        a->piece[other->piece].kind != PIECE_UNKNOWN ||
        vec3_length(vec3_sub(image, one->as.centre)) > 0.3 * one->as.radius_mm ||
        fabs(one->as.radius_mm - other->as.radius_mm) > 0.2 * one->as.radius_mm)
        return;
    set_eye(a, one->piece, &one->as, BY_SHAPE);
    set_eye(a, other->piece, &other->as, BY_SHAPE);
}

static void find_eyes(rig_anatomy *a, const mesh *m)
{
    enum { BALLS_MAX = 64 };
    ball found[BALLS_MAX];
    uint32_t count = 0;
    for (uint32_t i = 0; i < a->piece_count && count < BALLS_MAX; ++i) {
        found[count] = (ball){i, {.is_found = true}};
        if (a->piece[i].kind == PIECE_UNKNOWN && is_ball(&found[count].as, a, i, m))
            count += 1;
    }
    for (uint32_t i = 0; i < count; ++i)
        if (is_eye_name(name_of(m, &a->piece[found[i].piece])))
            set_eye(a, found[i].piece, &found[i].as, BY_NAME);
    if (!a->eye[0].is_found && !a->eye[1].is_found)
        for (uint32_t i = 0; i < count; ++i)
            for (uint32_t j = i + 1; j < count; ++j)
                set_eye_pair(a, &found[i], &found[j]);
    for (uint32_t i = 0; i < a->piece_count; ++i) {
        anatomy_piece *p = &a->piece[i];
        if (p->kind != PIECE_UNKNOWN || !is_mostly_head(p))
            continue;
        for (int side = 0; side < 2; ++side)
            if (is_in_eye(&a->eye[side], p))
                set_kind(p, side == 0 ? PIECE_EYE_LEFT : PIECE_EYE_RIGHT,
                         is_eye_name(name_of(m, p)) ? BY_NAME : BY_SHAPE);
    }
}

/* True for a piece behind the lips that is not wider than the mouth. */
static bool is_in_mouth(const rig_anatomy *a, const anatomy_piece *p)
{
    const rig_head *head = &a->head;
    double reach = head->nose.y - head->chin.y, depth = head->nose.z - head->back_z;
    double wide = 0.62 * head->half_width;
    return p->low.x > head->middle_x - wide && p->high.x < head->middle_x + wide &&
           p->mean.y < head->mouth_y + 0.3 * reach && p->mean.y > head->mouth_y - 0.35 * reach &&
           p->high.y - p->low.y < 0.36 * reach && p->mean.z > head->back_z + 0.4 * depth &&
           p->high.z < head->nose.z;
}

static void find_teeth(rig_anatomy *a, const mesh *m)
{
    const rig_head *head = &a->head;
    double widest = 0.0, front = -(double)INFINITY;
    for (uint32_t i = 0; i < a->piece_count; ++i) {
        const anatomy_piece *p = &a->piece[i];
        if (p->kind != PIECE_UNKNOWN || !is_mostly_head(p) || !is_in_mouth(a, p))
            continue;
        widest = fmax(widest, p->high.x - p->low.x);
        front = fmax(front, p->high.z);
    }
    for (uint32_t i = 0; i < a->piece_count; ++i) {
        anatomy_piece *p = &a->piece[i];
        bool is_named = matches_name(m, p, is_teeth_name),
             is_tongue = has_text(name_of(m, p), "tongue");
        if (p->kind != PIECE_UNKNOWN || !is_mostly_head(p))
            continue;
        if (!is_named && !is_tongue && !is_in_mouth(a, p))
            continue;
        bool is_behind = front - p->high.z > 0.15 * (front - p->low.z) &&
                         fabs(p->mean.x - head->middle_x) < 0.05 * widest &&
                         p->high.x - p->low.x > 0.3 * widest &&
                         p->high.x - p->low.x < 0.95 * widest;
        bool is_lower = p->mean.y < head->mouth_y;
        if (anatomy_has_word(name_of(m, p), WORDS("upper", "lower")))
            is_lower = has_text(name_of(m, p), "lower");
        set_kind(p,
                 is_tongue || (is_behind && !has_text(name_of(m, p), "upper")) ? PIECE_TONGUE
                 : is_lower                                                    ? PIECE_TEETH_LOWER
                                                                               : PIECE_TEETH_UPPER,
                 is_named || is_tongue ? BY_NAME : BY_SHAPE);
    }
}

/* True for the rim or glass of spectacles: in front of an eye, and around its centre as seen from
 * there. */
static bool is_before_eye(const anatomy_eye *eye, const anatomy_piece *p)
{
    return eye->is_found && p->low.z > eye->centre.z + 0.9 * eye->radius_mm &&
           p->low.x < eye->centre.x && p->high.x > eye->centre.x && p->low.y < eye->centre.y &&
           p->high.y > eye->centre.y;
}

/* True for hair, hats, glasses and ears: behind the face, above it, or across it. */
static bool is_around_face(const rig_anatomy *a, const anatomy_piece *p)
{
    const rig_head *head = &a->head;
    double reach = head->nose.y - head->chin.y, depth = head->nose.z - head->back_z;
    bool is_across = p->low.x < head->middle_x - 0.6 * head->half_width &&
                     p->high.x > head->middle_x + 0.6 * head->half_width;
    return is_before_eye(&a->eye[0], p) || is_before_eye(&a->eye[1], p) ||
           p->mean.z < head->back_z + 0.5 * depth || p->low.y > head->nose.y + 0.9 * reach ||
           (is_across && p->high.y - p->low.y < 0.6 * reach && p->low.y > head->mouth_y);
}

static void find_others(rig_anatomy *a, const mesh *m)
{
    for (uint32_t i = 0; i < a->piece_count; ++i) {
        anatomy_piece *p = &a->piece[i];
        const char *name = name_of(m, p);
        if (p->kind != PIECE_UNKNOWN)
            continue;
        if (p->head_count == 0 || (!is_mostly_head(p) && !matches_name(m, p, is_accessory_name)))
            set_kind(p, PIECE_BODY, a->source);
        else if (anatomy_has_word(name, WORDS("beard", "moustache", "mustache")))
            set_kind(p, p->mean.y < a->head.mouth_y ? PIECE_BEARD : PIECE_UNKNOWN, BY_NAME);
        else if (matches_name(m, p, is_accessory_name) &&
                 !anatomy_has_word(name, WORDS("lash", "brow")))
            set_kind(p, PIECE_RIDES, BY_NAME);
        else if (a->has_face && !anatomy_has_word(name, WORDS("lash", "brow", "lid", "tear")) &&
                 is_around_face(a, p))
            set_kind(p, PIECE_RIDES, BY_SHAPE);
        else if (!a->has_face)
            set_kind(p, PIECE_RIDES, BY_SHAPE);
        else if (is_clothes_name(name))
            set_kind(p, PIECE_BODY, BY_NAME);
    }
}

/* Returns the neck to the head where clothes made the cut too high. If the piece of the face ends
 * in its own neck, the whole piece belongs to the head. Of other pieces, everything above the
 * narrowest row of that neck does. */
static void extend_to_neck(rig_anatomy *a, const mesh *m)
{
    const anatomy_piece *face = &a->piece[a->face];
    vec3 size = vec3_sub(face->high, face->low);
    if (!a->has_body || a->is_on_four_legs || a->head_count > 1 || size.y > 2.2 * size.z ||
        face->head_count == face->point_count)
        return;
    rows *r = malloc(sizeof *r);
    if (!r)
        return;
    for (uint32_t v = 0; v < m->vertex_count; ++v)
        a->is_face[v] = a->of_vertex[v] == a->face;
    fill_rows(r, m, a->is_face, face->low, face->high);
    int neck = row_with_skin(r, ROWS / 2);
    if (find_shoulders(r) < 0 && neck >= 0) {
        for (int row = neck; row >= 0 && width_at(r, row) < 1.25 * width_at(r, neck); --row)
            if (width_at(r, row) > 0.0 && width_at(r, row) < width_at(r, neck))
                neck = row;
        double y = r->low_y + neck * r->row_mm;
        a->neck = (vec3){0.5 * (r->low_x[neck] + r->high_x[neck]), y,
                         0.6 * r->low_z[neck] + 0.4 * r->high_z[neck]};
        for (uint32_t v = 0; v < m->vertex_count; ++v)
            a->is_head[v] = a->is_face[v] || mesh_position(m, v).y >= y;
        count_head(a, m);
    }
    for (uint32_t v = 0; v < m->vertex_count; ++v)
        a->is_face[v] &= a->is_head[v];
    free(r);
}

/* ---- the slit between the lips ---- */

static mrt_result find_slit(rig_anatomy *a, const mesh *m, const topology *t, error *err)
{
    const rig_head *head = &a->head;
    double reach = head->nose.y - head->chin.y, reach_mm = 3.0 * reach;
    vec3 upper, lower;
    uint32_t above, below;
    if (!rig_head_hit(&upper, &above, m, a->is_face, head->middle_x,
                      head->lip_upper_y + 0.03 * reach) ||
        !rig_head_hit(&lower, &below, m, a->is_face, head->middle_x,
                      head->lip_lower_y - 0.03 * reach))
        return MRT_OK;
    double *distance = malloc(((size_t)m->vertex_count + 1) * sizeof *distance);
    bind_start start = {above, 0.0};
    if (!distance || !bind_distances(distance, &start, 1, reach_mm, m, t)) {
        free(distance);
        return no_memory(err);
    }
    double straight = vec3_length(vec3_sub(mesh_position(m, above), mesh_position(m, below)));
    double around = fmin(distance[below], reach_mm) - straight;
    a->lips_mm = fmin(distance[below], reach_mm);
    bool is_open =
        head->mouth_depth > 0.05 * reach && head->lip_upper_y - head->lip_lower_y > 0.06 * reach;
    a->has_parted_lips = above != below && (head->has_touching_lips ||
                                            (around > 1.2 * straight && around > 0.4 * reach));
    a->has_slit = a->has_parted_lips || (above != below && is_open);
    free(distance);
    return MRT_OK;
}

/* ---- skin behind the lips and the lids ---- */

static mrt_result find_hidden(rig_anatomy *a, const mesh *m, error *err)
{
    const rig_head *head = &a->head;
    double reach = head->nose.y - head->chin.y;
    front_view *f = calloc(1, sizeof *f);
    if (!f)
        return no_memory(err);
    f->low = (vec3){head->middle_x - 1.2 * head->half_width, head->chin.y, 0.0};
    f->high = (vec3){head->middle_x + 1.2 * head->half_width, head->nose.y + 1.2 * reach, 0.0};
    for (size_t i = 0; i < PIXELS * PIXELS; ++i)
        f->z[i] = -(double)INFINITY;
    for (uint32_t i = 0; i < m->triangle_count; ++i) {
        const uint32_t *corner = m->triangle + (size_t)i * 3;
        vec3 p = mesh_position(m, corner[0]);
        if (a->is_face[corner[0]] && p.x > f->low.x && p.x < f->high.x && p.y > f->low.y &&
            p.y < f->high.y)
            draw_triangle(f, m, i, a->face);
    }
    for (uint32_t v = 0; v < m->vertex_count; ++v) {
        vec3 p = mesh_position(m, v);
        if (!a->is_face[v] ||
            !(p.x > f->low.x && p.x < f->high.x && p.y > f->low.y && p.y < f->high.y))
            continue;
        int x = pixel_of(p.x, f->low.x, f->high.x), y = pixel_of(p.y, f->low.y, f->high.y);
        a->hidden_mm[v] = (float)fmax(f->z[y * PIXELS + x] - p.z, 0.0);
    }
    free(f);
    return MRT_OK;
}

/* ---- ears ---- */

typedef struct band { /* heights and depths at the sides of the face */
    double low_y, high_y, low_z, high_z;
} band;

static bool is_in_band(const band *b, vec3 p)
{
    return p.y > b->low_y && p.y < b->high_y && p.z > b->low_z && p.z < b->high_z;
}

static double widest_in(const rig_anatomy *a, const mesh *m, const band *b)
{
    double widest = 0.0;
    for (uint32_t v = 0; v < m->vertex_count; ++v)
        if (a->is_face[v] && is_in_band(b, mesh_position(m, v)))
            widest = fmax(widest, fabs(mesh_position(m, v).x - a->head.middle_x));
    return widest;
}

/* Finds the ears. The rim of an ear stands out from the sides of the head. Its hole is in front of
 * the middle of the rim and a little below (as on the ICT face). */
static void find_ears(rig_anatomy *a, const mesh *m)
{
    const rig_head *head = &a->head;
    double reach = head->nose.y - head->chin.y, depth = head->nose.z - head->back_z;
    double y = head->nose.y, z = head->back_z, rim_y = 0.0, rim_z = 0.0;
    band beside = {head->mouth_y - 0.3 * reach, y + 0.9 * reach, z + 0.15 * depth,
                   z + 0.75 * depth};
    band above = {y + reach, y + 1.4 * reach, z, z + depth};
    double ear = widest_in(a, m, &beside), side = widest_in(a, m, &above);
    double edge = ear - 0.35 * (ear - 0.9 * fmin(side, ear));
    uint32_t count = 0;
    for (uint32_t v = 0; v < m->vertex_count; ++v) {
        vec3 p = mesh_position(m, v);
        if (!a->is_face[v] || !is_in_band(&beside, p) || fabs(p.x - head->middle_x) < edge)
            continue;
        rim_y += p.y;
        rim_z += p.z;
        count += 1;
    }
    a->has_ears = count >= 6 && ear > 1.08 * side;
    if (a->has_ears)
        a->ear = (vec3){head->middle_x + side, rim_y / count - 0.07 * (head->top_y - head->chin.y),
                        rim_z / count + 0.1 * depth};
}

/* True for a head with a nose, a mouth or eyes. This test is needed since the profile of a ball
 * also has rows that stand out. */
static bool is_a_face(const rig_anatomy *a)
{
    const rig_head *head = &a->head;
    double reach = head->nose.y - head->chin.y;
    return a->eye[0].is_found || a->eye[1].is_found || head->mouth_depth > 0.01 * reach ||
           head->nose_mm > 0.02 * (head->top_y - head->chin.y);
}

/* ---- the mouth, where a shape of the file opens it ---- */

/* Returns the shape that opens the mouth; target_count if there is none. */
static uint32_t find_open_mouth(const mesh *m)
{
    for (uint32_t i = 0; i < m->target_count; ++i)
        if (anatomy_has_word(m->target[i].name, WORDS("jawopen", "jaw_open")))
            return i;
    for (uint32_t i = 0; i < m->expression_count; ++i)
        if (strcmp(m->expression[i].name, "aa") == 0)
            return m->expression[i].target;
    for (uint32_t i = 0; i < m->target_count; ++i)
        if (anatomy_has_word(m->target[i].name,
                             WORDS("mouthopen", "mouth_open", "viseme_aa", "mth_a")))
            return i;
    return m->target_count;
}

/* The lower lip is the highest skin in the middle that the shape moves much. The profile may have
 * taken another groove for the mouth. */
static void correct_mouth(rig_anatomy *a, const mesh *m)
{
    rig_head *head = &a->head;
    const uint32_t index = find_open_mouth(m);
    const double reach = head->nose.y - head->chin.y;
    double most_mm = 0.0, lip_y = -(double)INFINITY;
    if (index >= m->target_count)
        return;
    for (int pass = 0; pass < 2; ++pass)
        for (uint32_t v = 0; v < m->vertex_count; ++v) {
            const float *o = m->target[index].offset + (size_t)v * 3;
            const vec3 p = mesh_position(m, v);
            const double mm = vec3_length((vec3){(double)o[0], (double)o[1], (double)o[2]});
            if (!a->is_face[v] || p.z < head->nose.z - reach ||
                fabs(p.x - head->middle_x) > 0.15 * head->half_width)
                continue;
            if (pass == 0)
                most_mm = fmax(most_mm, mm);
            else if (mm > 0.4 * most_mm)
                lip_y = fmax(lip_y, p.y);
        }
    const double by_mm = lip_y - head->mouth_y;
    if (!(most_mm > 0.02 * reach) || !(fabs(by_mm) > 0.08 * reach) || lip_y > head->nose.y)
        return;
    head->mouth_y += by_mm;
    head->lip_upper_y += by_mm;
    head->lip_lower_y += by_mm;
    for (int i = 0; i < RIG_GROOVE; ++i)
        head->groove_y[i] += by_mm;
    a->is_mouth_of_shape = true;
}

/* ---- the whole anatomy ---- */

mrt_result rig_anatomy_find(rig_anatomy *out, const mesh *m, const topology *t, error *err)
{
    *out = (rig_anatomy){.head_joint = MESH_NO_JOINT,
                         .jaw_joint = MESH_NO_JOINT,
                         .head_piece = UINT32_MAX,
                         .neck_up = {0.0, 1.0, 0.0}};
    out->is_head = calloc((size_t)m->vertex_count + 1, 1);
    out->is_face = calloc((size_t)m->vertex_count + 1, 1);
    out->hidden_mm = calloc((size_t)m->vertex_count + 1, sizeof *out->hidden_mm);
    mrt_result result = out->is_head && out->is_face && out->hidden_mm
                            ? measure_pieces(out, m, t, err)
                            : no_memory(err);
    if (result >= 0)
        result = find_head_joint(out, m, err);
    if (result >= 0 && out->head_joint == MESH_NO_JOINT)
        result = find_head_by_shape(out, m, err);
    if (result >= 0) {
        count_head(out, m);
        result = find_face(out, m, err);
    }
    if (result >= 0 && out->source == BY_SHAPE)
        extend_to_neck(out, m);
    if (result >= 0) {
        mrt_result measured = rig_head_measure(&out->head, m, out->is_face, err);
        if (measured < 0 && out->head_piece < out->piece_count) { /* another piece is the face */
            out->head_piece = UINT32_MAX;
            out->piece[out->face].kind = PIECE_UNKNOWN;
            measured = find_face(out, m, err);
            if (measured >= 0)
                measured = rig_head_measure(&out->head, m, out->is_face, err);
        }
        out->has_face = measured >= 0;
        result = measured < 0 && out->head_joint == MESH_NO_JOINT ? measured : MRT_OK;
    }
    if (result >= 0 && out->has_face) {
        correct_mouth(out, m);
        find_eyes(out, m);
        find_teeth(out, m);
        find_ears(out, m);
        out->has_face = out->head_joint == MESH_NO_JOINT || is_a_face(out);
        result = find_slit(out, m, t, err);
        if (result >= 0)
            result = find_hidden(out, m, err);
    }
    if (result >= 0)
        find_others(out, m);
    if (result < 0)
        rig_anatomy_finish(out);
    return result;
}

void rig_anatomy_finish(rig_anatomy *a)
{
    free(a->of_vertex);
    free(a->piece);
    free(a->member);
    free(a->is_head);
    free(a->is_face);
    free(a->hidden_mm);
    *a = (rig_anatomy){0};
}
