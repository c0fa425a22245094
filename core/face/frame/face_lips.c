/* The seal of the lips. The rims of the mouth's slit (bind_lips) are a row of stations, each with a
 * point of the upper rim and one of the lower. In each frame, after bones and pulls have moved the
 * rims:
 * 1. lips.seal closes them. At a station that is sealed by s, 0..1, the lower point moves towards
 *    the upper one by s times their distance. Stations are sealed one after the other, from the
 *    corners of the mouth inwards or from its middle outwards.
 * 2. Where a rim has still crossed the other one, it is moved back up or down, so that they touch.
 *    Rims are compared where they face each other now, also after the jaw has moved aside.
 * Both lips share that motion (rig_mouth.upper_share). Each lip has its own field over the rest
 * shape, with the stations of its rim as control vectors, factored once. Surface distances keep the
 * field on its lip. Each frame computes the seal again, as it does the projection. The seal is not
 * part of the columns or of a baked shape. At rest nothing moves. */
#include "face/frame/frame.h"
#include "face/frame/strain.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Radius of the fields, over the width of the mouth. */
static const double reach_of_width = 0.36;
/* The mobility from which skin follows its rim fully, and the size below which responses are
 * dropped. */
static const float free_from = 0.6f, response_least = 2e-4f;
/* Length of the closing front, over half the slit. */
static const double zip_width = 1.0;
/* Each step moves stations of both rims, and then teeth push them, so that they may cross
 * elsewhere. The steps repeat until the rims cross by less than this. */
enum { PARTINGS = 6 };
static const double crossed_most_mm = 0.02;

static double clamp01(double t)
{
    return t < 0.0 ? 0.0 : t > 1.0 ? 1.0 : t;
}

static double smooth(double t)
{
    t = clamp01(t);
    return t * t * (3.0 - 2.0 * t);
}

/* ---- creation ---- */

/* Returns the position at rest of a station of the upper rim (0) or the lower one (1). */
static vec3 rest_of(const face *f, uint32_t station, uint32_t rim)
{
    const face_lips *l = &f->lips;
    const uint32_t *slot = l->slot + 4 * (size_t)station + 2 * rim;
    double along = l->along[2 * station + rim];
    return vec3_add(vec3_scale(points_position(&f->rest, slot[0]), 1.0 - along),
                    vec3_scale(points_position(&f->rest, slot[1]), along));
}

static void copy_stations(face *f)
{
    const bind_lips *from = &f->binding.lips;
    face_lips *l = &f->lips;
    double most = -1.0;
    for (uint32_t i = 0; i < l->count; ++i) {
        const bind_station *rim[2] = {&from->upper[i], &from->lower[i]};
        for (uint32_t k = 0; k < 4; ++k)
            l->slot[4 * i + k] = f->order.slot_of_file[rim[k / 2]->vertex[k % 2]];
        for (uint32_t k = 0; k < 2; ++k)
            l->along[2 * i + k] = rim[k]->along;
        double part =
            vec3_dot(vec3_sub(rest_of(f, i, 0), rest_of(f, 0, 0)), from->across) / from->width_mm;
        l->from_corner[i] = clamp01(1.0 - fabs(2.0 * part - 1.0));
        l->open_mm[i] = vec3_dot(vec3_sub(rest_of(f, i, 0), rest_of(f, i, 1)), from->up);
        l->floor_mm[i] = fmin(l->open_mm[i], 0.0);
        vec3_set_row(l->rest, i, rest_of(f, i, 0));
        l->middle = l->from_corner[i] > l->from_corner[l->middle] ? i : l->middle;
    }
    for (uint32_t b = 0; b < f->bone_count; ++b) {
        double sum = 0.0;
        for (uint32_t i = 0; i < l->count; ++i)
            sum += (double)f->field[b].weight[l->slot[4 * i]];
        l->carrier = sum > most ? b : l->carrier;
        most = fmax(sum, most);
    }
}

static float follows(const face *f, const float *of_rim, size_t slot)
{
    uint32_t last = f->rest.count - 1;
    float t = f->mobility[slot] / free_from;
    t = t > 1.0f ? 1.0f : t;
    return of_rim[f->order.file_of_slot[slot < last ? slot : last]] * t * (2.0f - t);
}

/* Adds one lip's part of each column: `share` of the unit responses of a field over its rim. */
static mrt_result add_lip(face *f, uint32_t rim, double share, const float *of_rim, error *err)
{
    face_lips *l = &f->lips;
    const csrbf_settings settings = {.kernel = CSRBF_WENDLAND_C2,
                                     .polynomial = CSRBF_NONE,
                                     .radius = reach_of_width * f->binding.lips.width_mm};
    csrbf_solver *solver = csrbf_solver_create(l->count);
    float *row = calloc((size_t)l->count * l->columns.stride, sizeof *row);
    for (uint32_t i = 0; i < l->count; ++i)
        vec3_set_row(l->upper, i, rest_of(f, i, rim));
    mrt_result result = solver && row
                            ? csrbf_factor(solver, &settings, l->upper, NULL, l->count, err)
                            : error_set(err, MRT_ERR_MEMORY, "no memory for the seal of the lips");
    if (result >= 0)
        csrbf_responses(solver, row, l->columns.stride, &f->rest);
    for (uint32_t i = 0; result >= 0 && i < l->count; ++i) {
        float *column = columns_row(&l->columns, i);
        const float *from = row + (size_t)i * l->columns.stride;
        for (size_t slot = 0; slot < f->rest.padded_count; ++slot) {
            float response = follows(f, of_rim, slot) * from[slot];
            if (fabsf(response) > response_least)
                column[slot] += (float)share * response;
        }
    }
    csrbf_solver_destroy(solver);
    free(row);
    return result;
}

static bool is_reached(const face_lips *l, const uint32_t *corner)
{
    return l->reaches[corner[0] / POINTS_BLOCK] || l->reaches[corner[1] / POINTS_BLOCK] ||
           l->reaches[corner[2] / POINTS_BLOCK];
}

static void list_reached(face *f)
{
    face_lips *l = &f->lips;
    const columns *c = &l->columns;
    for (uint32_t block = 0; block < f->rest.block_count; ++block) {
        uint64_t any = 0;
        for (uint32_t word = 0; word < c->mark_words; ++word)
            any |= c->mark[block * (size_t)c->mark_words + word];
        l->reaches[block] = any != 0;
    }
    for (uint32_t t = 0; t < f->skin_count; ++t) {
        uint32_t group = t / STRAIN_GROUP;
        if (is_reached(l, f->skin + (size_t)3 * t) &&
            (l->group_count == 0 || l->group[l->group_count - 1] != group))
            l->group[l->group_count++] = group;
    }
}

/* Lists the blocks of all corners of these groups, and of the neighbouring triangles. */
static void list_blocks(face *f)
{
    face_lips *l = &f->lips;
    uint32_t *const is_listed = l->block; /* used as flags first */
    for (uint32_t i = 0; i < l->group_count; ++i) {
        uint32_t first = STRAIN_GROUP * l->group[i], end = first + STRAIN_GROUP, around[6];
        for (uint32_t t = first; t < end && t < f->skin_count; ++t) {
            for (uint32_t k = 0; k < 3; ++k)
                is_listed[f->skin[3 * (size_t)t + k] / POINTS_BLOCK] = 1;
            if (surface_meter_around(f->surface_meter, t, around))
                for (uint32_t k = 3; k < 6; ++k)
                    is_listed[around[k] / POINTS_BLOCK] = 1;
        }
    }
    for (uint32_t block = 0; block < f->rest.block_count; ++block)
        if (is_listed[block] || l->reaches[block])
            l->block[l->block_count++] = block;
}

/* Measures gradients of sums of columns. Each column alone is steep, but neighbouring stations move
 * nearly the same way. */
static mrt_result measure_steepness(face *f, error *err)
{
    face_lips *l = &f->lips;
    const strain_loops *loops = strain_loops_now();
    size_t vertices = f->rest.padded_count;
    float(*rest)[4] = calloc(vertices, sizeof *rest), (*sum)[4] = calloc(vertices, sizeof *sum);
    l->steepest = arrays_add(&f->arrays, (size_t)l->count * l->group_count, sizeof *l->steepest);
    l->steepness = arrays_add(&f->arrays, l->group_count, sizeof *l->steepness);
    bool has_memory = rest && sum && !f->arrays.failed;
    for (size_t slot = 0; has_memory && slot < vertices; ++slot) {
        rest[slot][0] = f->rest.x[slot];
        rest[slot][1] = f->rest.y[slot];
        rest[slot][2] = f->rest.z[slot];
    }
    for (uint32_t i = l->count; has_memory && i-- > 0;) {
        const float *column = columns_row(&l->columns, i);
        for (size_t slot = 0; slot < vertices; ++slot)
            sum[slot][0] += column[slot];
        for (uint32_t k = 0; k < l->group_count; ++k) {
            size_t first = (size_t)STRAIN_GROUP * l->group[k], left = f->skin_count - first;
            size_t count = left < STRAIN_GROUP ? left : STRAIN_GROUP;
            const uint32_t *corner = f->skin + 3 * first;
            const strain_corners at = {(const float(*)[4])rest, corner, count};
            const strain_corners moved = {(const float(*)[4])sum, corner, count};
            strain_frames frames;
            loops->frames(&frames, &at);
            l->steepest[(size_t)i * l->group_count + k] =
                1.01f * loops->steepest(&frames.shape, &moved);
        }
    }
    free(rest);
    free(sum);
    return has_memory ? MRT_OK
                      : error_set(err, MRT_ERR_MEMORY, "no memory for the seal of the lips");
}

static mrt_result allocate(face *f, uint32_t count, error *err)
{
    face_lips *l = &f->lips;
    arrays *a = &f->arrays;
    double **const of_slots[] = {&l->x, &l->y, &l->z};
    double **const rows[] = {&l->rest, &l->upper, &l->lower, &l->correction};
    double **const of_stations[] = {&l->floor_mm, &l->open_mm, &l->from_corner, &l->near};
    for (size_t i = 0; i < sizeof of_slots / sizeof *of_slots; ++i)
        *of_slots[i] = arrays_add(a, 4 * count, sizeof(double));
    for (size_t i = 0; i < sizeof rows / sizeof *rows; ++i)
        *rows[i] = arrays_add(a, 3 * count, sizeof(double));
    for (size_t i = 0; i < sizeof of_stations / sizeof *of_stations; ++i)
        *of_stations[i] = arrays_add(a, count, sizeof(double));
    l->slot = arrays_add(a, 4 * count, sizeof *l->slot);
    l->along = arrays_add(a, 2 * count, sizeof *l->along);
    l->shown = arrays_add(a, 3 * count, sizeof *l->shown);
    l->at_slot = arrays_add(a, (size_t)4 * count * f->columns.capacity, sizeof *l->at_slot);
    l->block = arrays_add(a, f->rest.block_count, sizeof *l->block);
    l->group = arrays_add(a, f->skin_count / STRAIN_GROUP + 1, sizeof *l->group);
    l->bare = arrays_add(a, f->rest.padded_count, sizeof *l->bare);
    l->sealed = arrays_add(a, f->rest.padded_count, sizeof *l->sealed);
    return a->failed ? error_set(err, MRT_ERR_MEMORY, "no memory for the seal of the lips")
                     : MRT_OK;
}

mrt_result face_lips_create(face *f, error *err)
{
    const bind_lips *from = &f->binding.lips;
    face_lips *l = &f->lips;
    const uint32_t count = from->station_count;
    l->reaches = arrays_add(&f->arrays, f->rest.block_count, 1);
    if (count == 0)
        return l->reaches ? MRT_OK : error_set(err, MRT_ERR_MEMORY, "no memory for the lips");
    mrt_result result = allocate(f, count, err);
    if (result >= 0)
        result = columns_create(&l->columns, &f->rest, count, err);
    if (result < 0)
        return result;
    memset(columns_row(&l->columns, 0), 0, count * l->columns.stride * sizeof(float));
    l->count = count;
    copy_stations(f);
    result = add_lip(f, 0, f->rig->mouth.upper_share, from->of_upper, err);
    if (result >= 0)
        result = add_lip(f, 1, f->rig->mouth.upper_share - 1.0, from->of_lower, err);
    columns_note(&l->columns, count);
    list_reached(f);
    list_blocks(f);
    return result < 0 ? result : measure_steepness(f, err);
}

void face_lips_destroy(face *f)
{
    columns_destroy(&f->lips.columns);
}

/* ---- frames ---- */

void face_lips_engage(face *f)
{
    face_lips *l = &f->lips;
    for (uint32_t column = 0; l->count > 0 && column < f->columns.count; ++column) {
        const float *row = columns_row(&f->columns, column);
        float *out = l->at_slot + (size_t)4 * l->count * column;
        for (uint32_t i = 0; i < 4 * l->count; ++i)
            out[i] = row[l->slot[i]];
    }
}

/* Computes the ends of the stations' edges from f->given and the pose. */
static void place_rims(face *f)
{
    face_lips *l = &f->lips;
    const uint32_t slots = 4 * l->count;
    double *restrict x = l->x, *restrict y = l->y, *restrict z = l->z;
    for (uint32_t i = 0; i < slots; ++i) {
        x[i] = (double)f->origin->x[l->slot[i]];
        y[i] = (double)f->origin->y[l->slot[i]];
        z[i] = (double)f->origin->z[l->slot[i]];
    }
    for (uint32_t column = 0; column < f->columns.count; ++column) {
        const double *w = f->given + (size_t)3 * column;
        const float *restrict at = l->at_slot + (size_t)slots * column;
        const double wx = w[0], wy = w[1], wz = w[2];
        if (wx == 0.0 && wy == 0.0 && wz == 0.0)
            continue;
        for (uint32_t i = 0; i < slots; ++i) {
            x[i] += (double)at[i] * wx;
            y[i] += (double)at[i] * wy;
            z[i] += (double)at[i] * wz;
        }
    }
}

/* Computes l->upper and l->lower: the rims moved by the corrections, then by skull and teeth. */
static void find_rims(face *f)
{
    face_lips *l = &f->lips;
    const double share[2] = {f->rig->mouth.upper_share, f->rig->mouth.upper_share - 1.0};
    for (uint32_t i = 0; i < 2 * l->count; ++i) {
        vec3 end[2], by = vec3_scale(vec3_row(l->correction, i / 2), share[i % 2]);
        for (uint32_t k = 0; k < 2; ++k) {
            uint32_t at = 2 * i + k;
            end[k] = vec3_add((vec3){l->x[at], l->y[at], l->z[at]}, by);
            end[k] = projection_at(&f->projection, l->slot[at], end[k]);
        }
        vec3 way = vec3_sub(end[1], end[0]);
        vec3_set_row(i % 2 ? l->lower : l->upper, i / 2,
                     vec3_add(end[0], vec3_scale(way, l->along[i])));
    }
}

/* Returns how far a station is sealed, 0..1. */
static double sealed_at(const face *f, uint32_t station, double seal)
{
    double late = f->lips.from_corner[station];
    if (f->rig->mouth.seal_from == SEAL_FROM_MIDDLE)
        late = 1.0 - late;
    return smooth((seal * (1.0 + zip_width) - late) / zip_width);
}

/* Computes corrections for the seal, and for lips that stick to each other. */
static void close_lips(face *f, double seal, vec3 up)
{
    face_lips *l = &f->lips;
    const double stick_mm = f->rig->mouth.stickiness_mm;
    for (uint32_t i = 0; i < l->count; ++i) {
        vec3 apart = vec3_sub(vec3_row(l->upper, i), vec3_row(l->lower, i));
        double s = sealed_at(f, i, seal) * (1.0 - (1.0 - l->share_near) * l->near[i]);
        vec3 to = vec3_scale(apart, -s);
        double parted_mm = vec3_dot(vec3_add(apart, to), up) - l->open_mm[i];
        if (stick_mm > 0.0 && parted_mm > 0.0 && parted_mm < stick_mm)
            to = vec3_add(to, vec3_scale(up, -parted_mm * (1.0 - smooth(parted_mm / stick_mm))));
        vec3_set_row(l->correction, i, to);
    }
}

/* Finds the height along `up` of the rim `other` at the place of `at`. Searches from station i
 * outwards, since one lip may be pulled far aside. Returns false if no edge is there. */
static bool facing_height(double *out, const double *other, uint32_t count, uint32_t i, vec3 at,
                          vec3 across, vec3 up)
{
    double wanted = vec3_dot(at, across);
    for (uint32_t way = 0; way < count; ++way) {
        /* the edges before and after, further and further away */
        const uint32_t edge[2] = {i > way ? i - way - 1 : count, i + way};
        for (int k = 0; k < 2; ++k) {
            if (edge[k] + 1 >= count)
                continue;
            vec3 a = vec3_row(other, edge[k]), b = vec3_row(other, edge[k] + 1);
            double from = vec3_dot(a, across), to = vec3_dot(b, across);
            if (!(from <= wanted && wanted <= to && to > from))
                continue;
            double t = (wanted - from) / (to - from);
            *out = vec3_dot(a, up) * (1.0 - t) + vec3_dot(b, up) * t;
            return true;
        }
    }
    return false;
}

/* Moves rims that have crossed back until they touch. Returns the greatest depth of the
 * crossing. */
static double keep_apart(face *f, vec3 across, vec3 up)
{
    face_lips *l = &f->lips;
    double most = 0.0;
    for (uint32_t i = 1; i + 1 < l->count; ++i) {
        vec3 upper = vec3_row(l->upper, i), lower = vec3_row(l->lower, i);
        double below = 0.0, above = 0.0, crossed = 0.0;
        if (facing_height(&below, l->lower, l->count, i, upper, across, up))
            crossed = fmax(crossed, below - vec3_dot(upper, up) + l->floor_mm[i]);
        if (facing_height(&above, l->upper, l->count, i, lower, across, up))
            crossed = fmax(crossed, vec3_dot(lower, up) - above + l->floor_mm[i]);
        if (crossed > 0.0)
            vec3_set_row(l->correction, i,
                         vec3_add(vec3_row(l->correction, i), vec3_scale(up, crossed)));
        most = fmax(most, crossed);
    }
    return most;
}

void face_lips_solve(face *f, double strength)
{
    face_lips *l = &f->lips;
    const bind_lips *slit = &f->binding.lips;
    if (l->count == 0)
        return;
    const rigid *pose = &f->pose[l->carrier];
    vec3 across = rigid_rotate(pose, slit->across), up = rigid_rotate(pose, slit->up);
    const double seal = strength * l->share * (double)f->meter.dof[f->bones.seal];
    memset(l->correction, 0, (size_t)3 * l->count * sizeof *l->correction);
    place_rims(f);
    if (seal > 0.0 || f->rig->mouth.stickiness_mm > 0.0) {
        find_rims(f);
        close_lips(f, seal, up);
    }
    for (int i = 0; i < PARTINGS; ++i) {
        find_rims(f);
        if (!(keep_apart(f, across, up) > crossed_most_mm))
            break;
    }
    l->is_meeting = false;
    for (uint32_t i = 0; i < 3 * l->count; ++i)
        l->is_meeting = l->is_meeting || l->correction[i] != 0.0;
    columns_weigh(&l->columns, l->correction, l->count);
}

double face_lips_open_mm(face *f)
{
    const face_lips *l = &f->lips;
    find_rims(f);
    vec3 up = rigid_rotate(&f->pose[l->carrier], f->binding.lips.up);
    return vec3_dot(vec3_sub(vec3_row(l->upper, l->middle), vec3_row(l->lower, l->middle)), up);
}

void face_lips_bound(face *f)
{
    face_lips *l = &f->lips;
    vec3 before = {0, 0, 0};
    memset(l->steepness, 0, l->group_count * sizeof *l->steepness);
    for (uint32_t i = 0; i < l->count; ++i) {
        vec3 now = vec3_row(l->correction, i);
        float more = (float)vec3_length(vec3_sub(now, before));
        before = now;
        if (more > 0.0f)
            f->limit.loops->add(l->steepness, l->steepest + (size_t)i * l->group_count, more,
                                l->group_count);
    }
}

void face_lips_clear(face *f)
{
    if (f->lips.count == 0)
        return;
    memset(f->lips.correction, 0, (size_t)3 * f->lips.count * sizeof *f->lips.correction);
    f->lips.is_meeting = false;
}

void face_lips_sum(const face *f, float sum[3][POINTS_BLOCK], uint32_t block)
{
    if (f->lips.is_meeting && f->lips.reaches[block])
        columns_sum(&f->lips.columns, sum, 0, block);
}

bool face_lips_show(face *f)
{
    face_lips *l = &f->lips;
    bool differs = false;
    for (uint32_t i = 0; i < 3 * l->count; ++i) {
        float now = (float)l->correction[i];
        differs = differs || memcmp(&l->shown[i], &now, sizeof now) != 0;
        l->shown[i] = now;
    }
    return differs;
}
