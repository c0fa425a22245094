/* The loops of face/frame/strain.h for one instruction set. */
#include "face/frame/strain.h"

#include "face/frame/rows.h"

#include <math.h>
#include <stdbool.h>

#define STRAIN(name) STRAIN_OF(name, MAROTTE_VARIANT)
STRAIN_DECLARE(MAROTTE_VARIANT);

/* Two edges of each triangle from its first corner, by axis. Unused lanes repeat the first
 * triangle. */
typedef struct edges {
    float a[3][STRAIN_GROUP], b[3][STRAIN_GROUP];
} edges;

/* Writes b - a for four triangles: out[axis][i]. */
static inline void write_edges(float out[3][STRAIN_GROUP], size_t first, const rows_four a[4],
                               const rows_four b[4])
{
    rows_four by[4] = {b[0] - a[0], b[1] - a[1], b[2] - a[2], b[3] - a[3]};
    rows_transpose(by);
    for (size_t axis = 0; axis < 3; ++axis)
        rows_store(out[axis] + first, by[axis]);
}

static inline void load_corners(rows_four out[3][4], const strain_corners *at, size_t first)
{
    for (size_t k = 0; k < 4; ++k) {
        const uint32_t *c = at->vertex + 3 * (first + k < at->count ? first + k : 0);
        for (size_t corner = 0; corner < 3; ++corner)
            out[corner][k] = rows_load(at->row[c[corner]]);
    }
}

static void gather(edges *out, const strain_corners *at)
{
    for (size_t i = 0; i < STRAIN_GROUP; i += 4) {
        rows_four corner[3][4];
        load_corners(corner, at, i);
        write_edges(out->a, i, corner[0], corner[1]);
        write_edges(out->b, i, corner[0], corner[2]);
    }
}

/* All three edges: `third` leads from the second corner to the third. */
typedef struct sides {
    edges two;
    float third[3][STRAIN_GROUP];
} sides;

static void gather_sides(sides *out, const strain_corners *at)
{
    for (size_t i = 0; i < STRAIN_GROUP; i += 4) {
        rows_four corner[3][4];
        load_corners(corner, at, i);
        write_edges(out->two.a, i, corner[0], corner[1]);
        write_edges(out->two.b, i, corner[0], corner[2]);
        write_edges(out->third, i, corner[1], corner[2]);
    }
}

void STRAIN(add)(float *restrict out, const float *restrict row, float by, size_t count)
{
    for (size_t i = 0; i < count; ++i)
        out[i] += by * row[i];
}

void STRAIN(frames)(strain_frames *restrict out, const strain_corners *at)
{
    edges e;
    gather(&e, at);
    for (size_t i = 0; i < STRAIN_GROUP; ++i) {
        float ax = e.a[0][i], ay = e.a[1][i], az = e.a[2][i];
        float bx = e.b[0][i], by = e.b[1][i], bz = e.b[2][i];
        float nx = ay * bz - az * by, ny = az * bx - ax * bz, nz = ax * by - ay * bx;
        float aa = ax * ax + ay * ay + az * az, nn = nx * nx + ny * ny + nz * nz;
        bool is_good = (aa > 1e-20f) & (nn > 1e-30f);
        float inv_first = is_good ? 1.0f / sqrtf(is_good ? aa : 1.0f) : 0.0f;
        float of_n = is_good ? 1.0f / sqrtf(is_good ? nn : 1.0f) : 0.0f;
        float fx = ax * inv_first, fy = ay * inv_first, fz = az * inv_first;
        nx *= of_n, ny *= of_n, nz *= of_n;
        out->first[0][i] = fx, out->first[1][i] = fy, out->first[2][i] = fz;
        out->normal[0][i] = nx, out->normal[1][i] = ny, out->normal[2][i] = nz;
        out->second[0][i] = ny * fz - nz * fy;
        out->second[1][i] = nz * fx - nx * fz;
        out->second[2][i] = nx * fy - ny * fx;
        out->shape.inv_first[i] = inv_first;
        out->shape.along[i] = bx * fx + by * fy + bz * fz;
        out->shape.inv_height[i] = is_good ? of_n / (is_good ? inv_first : 1.0f) : 0.0f;
    }
}

void STRAIN(turned)(float *restrict out, const strain_frames *rest, const strain_frames *posed,
                    const float rotation[9])
{
    for (size_t i = 0; i < STRAIN_GROUP; ++i) {
        float x = rest->normal[0][i], y = rest->normal[1][i], z = rest->normal[2][i];
        out[i] = posed->normal[0][i] * (rotation[0] * x + rotation[1] * y + rotation[2] * z) +
                 posed->normal[1][i] * (rotation[3] * x + rotation[4] * y + rotation[5] * z) +
                 posed->normal[2][i] * (rotation[6] * x + rotation[7] * y + rotation[8] * z);
    }
}

void STRAIN(turns)(float *restrict out, const float *restrict inv_tan_turn,
                   const float *restrict turn_cosine)
{
    const float none_left = 1e6f;
    for (size_t i = 0; i < STRAIN_GROUP; ++i) {
        float cosine = turn_cosine[i], square = 1.0f - cosine * cosine;
        float sine = sqrtf(square > 1e-6f ? square : 0.0f); /* a smaller value is rounding */
        float left = cosine - inv_tan_turn[i] * sine;       /* cot (a - b) */
        float of_left = (inv_tan_turn[i] * cosine + sine) / (left > 1e-6f ? left : 1e-6f);
        out[i] = left > 1e-6f && of_left < none_left ? of_left : none_left;
    }
}

static inline float steepest_of(const strain_shapes *s, const edges *e)
{
    float square[STRAIN_GROUP], most = 0.0f;
    for (size_t i = 0; i < STRAIN_GROUP; ++i) {
        float px = e->a[0][i] * s->inv_first[i], py = e->a[1][i] * s->inv_first[i],
              pz = e->a[2][i] * s->inv_first[i];
        float qx = (e->b[0][i] - s->along[i] * px) * s->inv_height[i];
        float qy = (e->b[1][i] - s->along[i] * py) * s->inv_height[i];
        float qz = (e->b[2][i] - s->along[i] * pz) * s->inv_height[i];
        square[i] = px * px + py * py + pz * pz + qx * qx + qy * qy + qz * qz;
    }
    for (size_t i = 0; i < STRAIN_GROUP; ++i)
        most = square[i] > most ? square[i] : most;
    return sqrtf(most);
}

float STRAIN(steepest)(const strain_shapes *s, const strain_corners *displacement)
{
    edges e;
    gather(&e, displacement);
    return steepest_of(s, &e);
}

void STRAIN(strains)(strain_found *restrict out, const strain_frames *f,
                     const strain_shapes *origin, const float *restrict inv_tan_tilt,
                     const float *restrict inv_tan_turn, const strain_corners *displacement)
{
    const float of_squeeze = 1.0f / STRAIN_SQUEEZE_MOST;
    const strain_shapes *s = &f->shape;
    edges e;
    gather(&e, displacement);
    out->steepest = steepest_of(origin, &e);
    for (size_t i = 0; i < STRAIN_GROUP; ++i) {
        float px = e.a[0][i] * s->inv_first[i], py = e.a[1][i] * s->inv_first[i],
              pz = e.a[2][i] * s->inv_first[i];
        float qx = (e.b[0][i] - s->along[i] * px) * s->inv_height[i];
        float qy = (e.b[1][i] - s->along[i] * py) * s->inv_height[i];
        float qz = (e.b[2][i] - s->along[i] * pz) * s->inv_height[i];
        float pp = f->first[0][i] * px + f->first[1][i] * py + f->first[2][i] * pz;
        float sp = f->second[0][i] * px + f->second[1][i] * py + f->second[2][i] * pz;
        float np = f->normal[0][i] * px + f->normal[1][i] * py + f->normal[2][i] * pz;
        float pq = f->first[0][i] * qx + f->first[1][i] * qy + f->first[2][i] * qz;
        float qq = f->second[0][i] * qx + f->second[1][i] * qy + f->second[2][i] * qz;
        float nq = f->normal[0][i] * qx + f->normal[1][i] * qy + f->normal[2][i] * qz;
        float mean = 0.5f * (pp + qq), apart = 0.5f * (pp - qq), shear = 0.5f * (sp + pq);
        float squeeze = sqrtf(apart * apart + shear * shear) - mean;
        float tilt = sqrtf(np * np + nq * nq);
        squeeze = squeeze > 0.0f ? squeeze : 0.0f;
        out->strain[i] = squeeze * of_squeeze + tilt * inv_tan_tilt[i];
        out->alone[i] = squeeze * of_squeeze + tilt * (1.0f / STRAIN_TILT_MOST);
        out->flip[i] = squeeze + tilt * inv_tan_turn[i];
        out->size[i] = sqrtf(px * px + py * py + pz * pz + qx * qx + qy * qy + qz * qz);
    }
}

static inline float length_at(float by[3][STRAIN_GROUP], size_t i)
{
    return sqrtf(by[0][i] * by[0][i] + by[1][i] * by[1][i] + by[2][i] * by[2][i]);
}

void STRAIN(stretches)(float *restrict out, const strain_corners *posed,
                       const strain_corners *added, const float (*longest)[3], float room_least)
{
    sides was, by;
    gather_sides(&was, posed);
    gather_sides(&by, added);
    for (size_t i = 0; i < STRAIN_GROUP; ++i) {
        const float *most = longest[i < posed->count ? i : 0];
        float gain[3] = {length_at(by.two.a, i), length_at(by.third, i), length_at(by.two.b, i)};
        float is[3] = {length_at(was.two.a, i), length_at(was.third, i), length_at(was.two.b, i)};
        float worst = 0.0f;
        for (int k = 0; k < 3; ++k) {
            float least = room_least * most[k], room = most[k] - is[k];
            float strain = gain[k] / (room > least ? room : least);
            worst = strain > worst ? strain : worst;
        }
        out[i] = worst;
    }
}

void STRAIN(may_strain)(uint8_t *restrict out, const strain_bounds *of, size_t count)
{
    const float *restrict pull = of->pull, *restrict change = of->change,
                          *restrict steepness = of->steepness, *restrict room = of->room;
    float *restrict strain = of->strain, *restrict flip = of->flip;
    const float shaped = of->shaped;
    for (size_t i = 0; i < count; ++i) {
        float by = (shaped > 0.0f) & (steepness[i] < INFINITY) ? shaped : steepness[i];
        float most = pull[i] * by, left = room[i] < 1.0f ? room[i] : 1.0f;
        bool may = (most > 0.0f) & !(most < left), is_lost = !may & (change[i] > 0.0f);
        out[i] = may;
        strain[i] = is_lost ? INFINITY : strain[i];
        flip[i] = is_lost ? INFINITY : flip[i];
    }
}

void STRAIN(turn_normals)(float (*restrict out)[STRAIN_GROUP],
                          const float (*restrict rest)[STRAIN_GROUP], const float *restrict share,
                          const float rotation[9])
{
    for (size_t axis = 0; axis < 3; ++axis)
        for (size_t i = 0; i < STRAIN_GROUP; ++i)
            out[axis][i] +=
                share[i] * (rotation[3 * axis] * rest[0][i] + rotation[3 * axis + 1] * rest[1][i] +
                            rotation[3 * axis + 2] * rest[2][i]);
}

void STRAIN(seen)(strain_seen *restrict out, const strain_corners *at,
                  const float (*restrict normal)[STRAIN_GROUP], const strain_turns *may_turn)
{
    const float *restrict cosine = may_turn->cosine, *restrict sine = may_turn->sine;
    const float less_cosine = may_turn->less_cosine, less_sine = may_turn->less_sine;
    edges e;
    gather(&e, at);
    for (size_t i = 0; i < STRAIN_GROUP; ++i) {
        float nx = normal[0][i], ny = normal[1][i], nz = normal[2][i];
        float nn = nx * nx + ny * ny + nz * nz;
        float ax = e.a[1][i] * e.b[2][i] - e.a[2][i] * e.b[1][i];
        float ay = e.a[2][i] * e.b[0][i] - e.a[0][i] * e.b[2][i];
        float az = e.a[0][i] * e.b[1][i] - e.a[1][i] * e.b[0][i];
        float along = nx * ax + ny * ay + nz * az;
        float left = cosine[i] < less_cosine ? cosine[i] * less_cosine + sine[i] * less_sine : 1.0f;
        bool is_there = (nn > 1e-30f) & (i < at->count);
        out->area[i] = is_there ? along / (nn > 1e-30f ? nn : 1.0f) : 1.0f;
        float size = sqrtf(nn * (ax * ax + ay * ay + az * az));
        out->turned[i] = is_there ? left * size - along : 0.0f;
    }
}

void STRAIN(blends)(const strain_blends *of, const float motion[12], float turn, size_t first,
                    size_t end)
{
    const float *restrict cx = of->centre[0], *restrict cy = of->centre[1],
                          *restrict cz = of->centre[2], *restrict radius = of->radius;
    const float *restrict gx = of->gradient[0], *restrict gy = of->gradient[1],
                          *restrict gz = of->gradient[2], *restrict length = of->length,
                          *restrict off = of->off;
    float *restrict along = of->along, *restrict steep = of->steep;
    for (size_t i = first; i < end; ++i) {
        float x = motion[0] * cx[i] + motion[1] * cy[i] + motion[2] * cz[i] + motion[3];
        float y = motion[4] * cx[i] + motion[5] * cy[i] + motion[6] * cz[i] + motion[7];
        float z = motion[8] * cx[i] + motion[9] * cy[i] + motion[10] * cz[i] + motion[11];
        float round = turn * radius[i], far = sqrtf(x * x + y * y + z * z) + round;
        float most = length[i] + off[i];
        along[i] = x * gx[i] + y * gy[i] + z * gz[i] - round * most - far * off[i];
        steep[i] = far * most;
    }
}

/* Returns an upper bound of the angle with this sine. */
static inline float angle_of(float sine)
{
    sine = sine < 1.0f ? sine : 1.0f;
    return sine + 0.5708f * sine * sine * sine;
}

/* Returns an upper bound of 1 over the tangent of an angle that is left. */
static inline float inv_tan_of(float angle)
{
    float left = angle > 1e-3f ? angle : 1e-3f;
    return 1.0f / left - left * (1.0f / 3.0f);
}

void STRAIN(rooms)(float *restrict out, const strain_rooms *of, size_t count)
{
    const float *restrict blended = of->blended, *restrict unlike = of->unlike,
                          *restrict along = of->along, *restrict steep = of->steep,
                          *restrict lost_of = of->lost, *restrict apart = of->apart,
                          *restrict rounding = of->rounding, *restrict tilt = of->tilt,
                          *restrict turn = of->turn, *restrict steepness = of->steepness;
    float *restrict out_tilted = of->tilted;
    const float sure = 1.05f; /* margin for the rounding of values derived from sums */
    for (size_t i = 0; i < count; ++i) {
        float square = 1.0f - 1.001f * unlike[i] - 1e-5f;
        float shrunk = sqrtf(square > 1e-4f ? square : 1e-4f), inv = 1.0f / shrunk;
        float n = steep[i] * inv, p = along[i] - n * blended[i];
        float left = 1.0f + p, lost = 1.01f * (lost_of[i] + rounding[i]);
        float pressed = 0.5f * (sqrtf(4.0f * (left > 0.0f ? left : 0.0f) + n * n) - n);
        pressed = pressed < 1.0f ? pressed : 1.0f;
        float scale = shrunk * pressed - lost;
        float worst = p > -n * n ? p : -n * n; /* the slope is greatest there */
        float cross = n * n - worst * worst, run = 1.0f + worst;
        float slope = sqrtf(cross > 0.0f ? cross : 0.0f) / (run > 1e-3f ? run : 1e-3f);
        float seen = angle_of(slope / sqrtf(1.0f + slope * slope)) * inv +
                     angle_of((1.0f - square) / (1.0f + square)) +
                     angle_of(lost / (scale > 1e-3f ? scale : 1e-3f)) + tilt[i];
        float tilted = inv_tan_of(STRAIN_SEEN_RAD - seen);
        float turned = inv_tan_of(turn[i] - seen - angle_of(blended[i]) - apart[i]);
        tilted = tilted > 1.0f / STRAIN_TILT_MOST ? tilted : 1.0f / STRAIN_TILT_MOST;
        turned = turned > 0.0f ? turned : 0.0f;
        float by_tilt = 1.0f / (STRAIN_SQUEEZE_MOST * STRAIN_SQUEEZE_MOST) + tilted * tilted;
        float by_turn = 1.0f + turned * turned;
        float now = sure * sqrtf(by_tilt > by_turn ? by_tilt : by_turn);
        bool is_known = (square > 1e-4f) & (left > 1e-3f) & (scale > 1e-3f);
        float room = (scale - rounding[i]) * steepness[i] / now;
        out[i] = is_known & (room > 0.0f) ? room : 0.0f;
        out_tilted[i] = is_known ? 1.001f * tilted : 1e6f;
    }
}

static inline float longer(float by[3][STRAIN_GROUP], float was[3][STRAIN_GROUP], size_t i)
{
    return by[0][i] * by[0][i] + by[1][i] * by[1][i] + by[2][i] * by[2][i] -
           (was[0][i] * was[0][i] + was[1][i] * was[1][i] + was[2][i] * was[2][i]);
}

void STRAIN(folds)(strain_folds *restrict out, const strain_corners *posed,
                   const strain_corners *added, const float (*restrict normal)[STRAIN_GROUP])
{
    sides was, moved;
    gather_sides(&was, posed);
    gather_sides(&moved, added);
    for (size_t i = 0; i < STRAIN_GROUP; ++i) { /* the same terms as in strain_fold */
        float nx = normal[0][i], ny = normal[1][i], nz = normal[2][i];
        float ax = was.two.a[0][i], ay = was.two.a[1][i], az = was.two.a[2][i];
        float bx = was.two.b[0][i], by = was.two.b[1][i], bz = was.two.b[2][i];
        float px = moved.two.a[0][i], py = moved.two.a[1][i], pz = moved.two.a[2][i];
        float qx = moved.two.b[0][i], qy = moved.two.b[1][i], qz = moved.two.b[2][i];
        float nn = nx * nx + ny * ny + nz * nz, left = STRAIN_FOLD_ROOM * nn;
        float area = nx * (ay * bz - az * by) + ny * (az * bx - ax * bz) + nz * (ax * by - ay * bx);
        float slope =
            nx * (ay * qz - az * qy) + ny * (az * qx - ax * qz) + nz * (ax * qy - ay * qx) +
            (nx * (py * bz - pz * by) + ny * (pz * bx - px * bz) + nz * (px * by - py * bx));
        float bend = nx * (py * qz - pz * qy) + ny * (pz * qx - px * qz) + nz * (px * qy - py * qx);
        bool has_room = (nn > 1e-30f) & (area > 1e-3f * nn);
        float room = area - (left < 0.5f * area ? left : 0.5f * area);
        has_room = has_room & (room > 0.0f);
        float at_end = slope + bend < 0.0f ? slope + bend : 0.0f;
        bool is_between = (bend > 0.0f) & (slope < 0.0f) & (-slope < 2.0f * bend);
        float between = -slope * slope / (4.0f * (is_between ? bend : 1.0f));
        float least = is_between ? between : at_end;
        out->fold[i] = has_room ? -least / (has_room ? room : 1.0f) : 0.0f;
        float a = longer(moved.two.a, was.two.a, i), b = longer(moved.two.b, was.two.b, i),
              c = longer(moved.third, was.third, i);
        a = b > a ? b : a;
        out->drawn[i] = c > a ? c : a;
    }
}
