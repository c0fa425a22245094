#include "mesh/shading_state.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* A vertex by itself takes so many times as long as one of a whole block, which shares triangles.
 */
enum { LANES_WORTH = 7 };

/* ---- from triangles ---- */

/* Twice the area of a triangle, along its normal. The fourth lane has no meaning. */
static inline void cross(shading_row *restrict out, const shading_row *restrict place,
                         const uint32_t *restrict corner)
{
    const float *a = place[corner[0]].at, *b = place[corner[1]].at, *c = place[corner[2]].at;
    float u0 = b[0] - a[0], u1 = b[1] - a[1], u2 = b[2] - a[2], u3 = b[3] - a[3];
    float v0 = c[0] - a[0], v1 = c[1] - a[1], v2 = c[2] - a[2], v3 = c[3] - a[3];
    out->at[0] = u1 * v2 - u2 * v1;
    out->at[1] = u2 * v0 - u0 * v2;
    out->at[2] = u0 * v1 - u1 * v0;
    out->at[3] = u3 * v3 - u3 * v3;
}

static inline void add(shading_row *restrict sum, const shading_row *restrict one)
{
    for (int k = 0; k < 4; ++k)
        sum->at[k] += one->at[k];
}

/* All vertices of a block. Triangles without area are added where a vertex has no more: that
 * changes no bit, and asks nothing of each vertex. */
static void add_block(shading_row *restrict sum, const shading *self, uint32_t block)
{
    const shading_block *b = &self->block[block];
    const shading_table *table = &self->table[block];
    const uint32_t *corner = self->corner + (size_t)3 * b->first_triangle;
    shading_row area[SHADING_CROSSES + 1];
    for (uint32_t i = 0; i < b->triangle_count; ++i)
        cross(&area[i], self->place, corner + (size_t)3 * i);
    area[b->triangle_count] = (shading_row){{0}};
    for (int lane = 0; lane < SHADING_BLOCK; ++lane) {
        const uint16_t *triangle = table->triangle[lane];
        shading_row all = {{0}};
        for (int i = 0; i < SHADING_FEW; ++i)
            add(&all, &area[triangle[i]]);
        if (triangle[SHADING_FEW] != b->triangle_count)
            for (int i = SHADING_FEW; i < SHADING_TABLED; ++i)
                add(&all, &area[triangle[i]]);
        sum[lane] = all;
    }
}

static void add_more(shading_row *sum, const shading *self, uint32_t block)
{
    const shading_block *b = &self->block[block];
    for (uint32_t i = 0; i < b->more_count; ++i) {
        const shading_more *more = &self->more[b->first_more + i];
        shading_row one;
        cross(&one, self->place, more->corner);
        add(&sum[more->lane], &one);
    }
}

static inline bool is_good(float square)
{
    return (square > 1e-30f) & (square <= FLT_MAX);
}

/* Without branches, so that it runs on whole vectors. */
static inline void normalise(float *restrict nx, float *restrict ny, float *restrict nz,
                             const shading_row *restrict sum, int count)
{
    for (int i = 0; i < count; ++i) {
        float x = sum[i].at[0], y = sum[i].at[1], z = sum[i].at[2];
        float square = x * x + y * y + z * z;
        bool good = is_good(square);
        float inverse = 1.0f / sqrtf(good ? square : 1.0f);
        nx[i] = good ? x * inverse : 0.0f;
        ny[i] = good ? y * inverse : 0.0f;
        nz[i] = good ? z * inverse : 1.0f;
    }
}

static void gather_block(shading *self, uint32_t block)
{
    size_t first = (size_t)block * SHADING_BLOCK;
    shading_row sum[SHADING_BLOCK];
    add_block(sum, self, block);
    add_more(sum, self, block);
    normalise(self->normal[0] + first, self->normal[1] + first, self->normal[2] + first, sum,
              SHADING_BLOCK);
}

/* One vertex; the bits of gather_block. */
static void gather_lane(shading *self, uint32_t block, uint32_t lane)
{
    const shading_block *b = &self->block[block];
    const uint16_t *triangle = self->table[block].triangle[lane];
    const uint32_t *corner = self->corner + (size_t)3 * b->first_triangle;
    size_t slot = (size_t)block * SHADING_BLOCK + lane;
    shading_row area[SHADING_TABLED], all = {{0}};
    int count = 0;
    for (; count < SHADING_TABLED && triangle[count] != b->triangle_count; ++count)
        cross(&area[count], self->place, corner + (size_t)3 * triangle[count]);
    for (int i = 0; i < count; ++i)
        add(&all, &area[i]);
    for (uint32_t i = 0; i < b->more_count; ++i) {
        const shading_more *more = &self->more[b->first_more + i];
        if (more->lane != lane)
            continue;
        cross(&area[0], self->place, more->corner);
        add(&all, &area[0]);
    }
    normalise(self->normal[0] + slot, self->normal[1] + slot, self->normal[2] + slot, &all, 1);
}

/* So many that the whole block is found as quickly. */
static bool are_many(uint64_t lanes)
{
    return __builtin_popcountll(lanes) * LANES_WORTH > SHADING_BLOCK;
}

void shading_gather(shading *self, uint32_t block, uint64_t lanes)
{
    if (are_many(lanes)) {
        gather_block(self, block);
        return;
    }
    for (; lanes != 0; lanes &= lanes - 1)
        gather_lane(self, block, (uint32_t)__builtin_ctzll(lanes));
}

uint64_t shading_flat(const shading *self, uint32_t block)
{
    shading_row sum[SHADING_BLOCK];
    uint64_t flat = 0;
    add_block(sum, self, block);
    add_more(sum, self, block);
    for (uint32_t lane = 0; lane < SHADING_BLOCK; ++lane) {
        const float *s = sum[lane].at;
        if (!is_good(s[0] * s[0] + s[1] * s[1] + s[2] * s[2]))
            flat |= (uint64_t)1 << lane;
    }
    return flat;
}

/* ---- from the rest shape ---- */

static bool is_still(const rigid *pose)
{
    const rigid still = rigid_identity();
    return memcmp(pose->r, still.r, sizeof still.r) == 0;
}

static void turn(shading *self, const rigid *pose, uint32_t block)
{
    size_t first = (size_t)block * SHADING_BLOCK;
    const float *restrict x = self->rest[0] + first, *restrict y = self->rest[1] + first,
                          *restrict z = self->rest[2] + first;
    for (size_t axis = 0; axis < 3; ++axis) {
        float *restrict out = self->normal[axis] + first;
        const float a = (float)pose->r[axis][0], b = (float)pose->r[axis][1],
                    c = (float)pose->r[axis][2];
        for (int i = 0; i < SHADING_BLOCK; ++i)
            out[i] = a * x[i] + b * y[i] + c * z[i];
    }
}

static void turn_block(shading *self, const rigid *pose, uint32_t block)
{
    size_t first = (size_t)block * SHADING_BLOCK, size = SHADING_BLOCK * sizeof(float);
    if (!is_still(pose)) {
        turn(self, pose, block);
        return;
    }
    for (size_t axis = 0; axis < 3; ++axis)
        memcpy(self->normal[axis] + first, self->rest[axis] + first, size);
}

/* ---- an update ---- */

/* The fourth lane is of no use: it repeats the third so that this runs on whole vectors. */
static void place_block(shading *self, const float *const at[3], uint32_t block)
{
    size_t first = (size_t)block * SHADING_BLOCK;
    float *restrict place = self->place[first].at;
    const float *restrict x = at[0] + first, *restrict y = at[1] + first,
                          *restrict z = at[2] + first;
    for (size_t i = 0; i < SHADING_BLOCK; ++i) {
        place[4 * i] = x[i];
        place[4 * i + 1] = y[i];
        place[4 * i + 2] = z[i];
        place[4 * i + 3] = z[i];
    }
    self->is_placed[block] = 1;
}

/* Where all corners of its triangles are now. */
static void place_around(shading *self, const float *const at[3], uint32_t block)
{
    const shading_block *b = &self->block[block];
    if (!self->is_placed[block])
        place_block(self, at, block);
    for (uint32_t i = 0; i < b->neighbour_count; ++i) {
        uint32_t other = self->neighbour[b->first_neighbour + i].block;
        if (!self->is_placed[other])
            place_block(self, at, other);
    }
}

/* The vertices of a block that share a triangle with one that was written. */
static uint64_t lanes_touched(const shading *self, uint32_t block)
{
    const shading_block *b = &self->block[block];
    const shading_neighbour *neighbour = self->neighbour + b->first_neighbour;
    uint64_t lanes = 0;
    if (self->is_new[block])
        return UINT64_MAX;
    for (uint32_t i = 0; i < b->neighbour_count; ++i)
        lanes |= self->is_new[neighbour[i].block] ? neighbour[i].lanes : 0;
    return lanes;
}

/* The vertices of a carried block of which some triangle is not carried with it. */
static uint64_t lanes_bent(const shading *self, const uint8_t *carrier, uint32_t block)
{
    const shading_block *b = &self->block[block];
    const shading_neighbour *neighbour = self->neighbour + b->first_neighbour;
    uint64_t lanes = b->flat;
    for (uint32_t i = 0; i < b->neighbour_count; ++i)
        lanes |= carrier[neighbour[i].block] != carrier[block] ? neighbour[i].lanes : 0;
    return lanes;
}

static void update_block(shading *self, const shading_shape *now, uint32_t block)
{
    uint64_t lanes = lanes_touched(self, block);
    uint8_t carrier = now->carrier[block];
    if (lanes == 0)
        return;
    if (carrier != SHADING_LOOSE) {
        lanes = lanes_bent(self, now->carrier, block);
        if (!are_many(lanes))
            turn_block(self, &now->pose[carrier], block);
    }
    if (lanes != 0) {
        place_around(self, now->at, block);
        shading_gather(self, block, lanes);
    }
    stamps_mark(&self->written, block);
}

void shading_update(shading *self, const shading_shape *now)
{
    if (!stamps_has_news(&self->seen, now->written))
        return;
    for (uint32_t block = 0; block < self->block_count; ++block) {
        self->is_new[block] = stamps_is_new(&self->seen, now->written, block);
        if (self->is_new[block])
            self->is_placed[block] = 0;
    }
    stamps_read(&self->seen, now->written);
    stamps_begin(&self->written);
    for (uint32_t block = 0; block < self->block_count; ++block)
        update_block(self, now, block);
}

/* ---- what others see ---- */

const float *shading_normal(const shading *self, uint32_t axis)
{
    return self->normal[axis];
}

const stamps *shading_written(const shading *self)
{
    return &self->written;
}
