#include "mesh/shading.h"

#include "base/arrays.h"
#include "base/large.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A table holds up to SHADING_TABLED triangles of a vertex; almost all vertices have no more. */
enum { SHADING_FEW = 6, SHADING_TABLED = 8, SHADING_CROSSES = SHADING_BLOCK * SHADING_TABLED };

typedef struct shading_row { /* x, y, z, and a fourth number to fill a vector */
    _Alignas(16) float at[4];
} shading_row;

/* The triangles of a vertex as indices into those of its block, ascending as in the mesh. Unused
 * entries are the block's triangle_count: a triangle without area. */
typedef struct shading_table {
    uint16_t triangle[SHADING_BLOCK][SHADING_TABLED];
} shading_table;

typedef struct shading_more { /* a triangle that does not fit into a vertex's table, in order */
    uint32_t lane, corner[3];
} shading_more;

typedef struct shading_neighbour {
    uint32_t block;
    uint64_t lanes; /* bits: vertices of this block that share a triangle with that block */
} shading_neighbour;

typedef struct shading_block {
    uint32_t first_triangle, triangle_count;
    uint32_t first_more, more_count;
    uint32_t first_neighbour, neighbour_count;
    uint64_t flat; /* bits: vertices without a normal at rest */
} shading_block;

struct shading {
    uint32_t vertex_count, block_count;
    shading_block *block;
    shading_table *table;         /* block_count */
    uint32_t *corner;             /* by 3: slots of the triangles of all blocks */
    shading_more *more;           /* of all blocks */
    shading_neighbour *neighbour; /* of all blocks */
    shading_row *position;        /* of each slot */
    float *normal[3], *rest[3];   /* block_count whole blocks each */
    uint8_t *is_new;              /* block_count: scratch of an update */
    uint8_t *is_placed;           /* block_count: `position` is up to date */
    stamps_reader seen;
    stamps written;
};

enum { STAGGER = 80 }; /* floats between two streams: not a power of two */
/* Cost of a single vertex, relative to one in a whole block, which shares triangles. */
enum { LANES_WORTH = 7 };

/* ---- from triangles ---- */

/* Computes twice the area of a triangle, along its normal. The fourth lane is undefined. */
static inline void cross(shading_row *restrict out, const shading_row *restrict position,
                         const uint32_t *restrict corner)
{
    const float *a = position[corner[0]].at, *b = position[corner[1]].at,
                *c = position[corner[2]].at;
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

/* Adds the triangles of all vertices of a block. Vertices with fewer triangles add ones without
 * area, which changes no bits and avoids a branch. */
static void add_block(shading_row *restrict sum, const shading *self, uint32_t block)
{
    const shading_block *b = &self->block[block];
    const shading_table *table = &self->table[block];
    const uint32_t *corner = self->corner + (size_t)3 * b->first_triangle;
    shading_row area[SHADING_CROSSES + 1];
    for (uint32_t i = 0; i < b->triangle_count; ++i)
        cross(&area[i], self->position, corner + (size_t)3 * i);
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
        cross(&one, self->position, more->corner);
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

/* Computes one vertex, with the same bits as gather_block. */
static void gather_lane(shading *self, uint32_t block, uint32_t lane)
{
    const shading_block *b = &self->block[block];
    const uint16_t *triangle = self->table[block].triangle[lane];
    const uint32_t *corner = self->corner + (size_t)3 * b->first_triangle;
    size_t slot = (size_t)block * SHADING_BLOCK + lane;
    shading_row area[SHADING_TABLED], all = {{0}};
    int count = 0;
    for (; count < SHADING_TABLED && triangle[count] != b->triangle_count; ++count)
        cross(&area[count], self->position, corner + (size_t)3 * triangle[count]);
    for (int i = 0; i < count; ++i)
        add(&all, &area[i]);
    for (uint32_t i = 0; i < b->more_count; ++i) {
        const shading_more *more = &self->more[b->first_more + i];
        if (more->lane != lane)
            continue;
        cross(&area[0], self->position, more->corner);
        add(&all, &area[0]);
    }
    normalise(self->normal[0] + slot, self->normal[1] + slot, self->normal[2] + slot, &all, 1);
}

/* Returns whether computing the whole block is as fast. */
static bool are_many(uint64_t lanes)
{
    return __builtin_popcountll(lanes) * LANES_WORTH > SHADING_BLOCK;
}

static void gather_lanes(shading *self, uint32_t block, uint64_t lanes)
{
    if (are_many(lanes)) {
        gather_block(self, block);
        return;
    }
    for (; lanes != 0; lanes &= lanes - 1)
        gather_lane(self, block, (uint32_t)__builtin_ctzll(lanes));
}

static uint64_t flat_lanes(const shading *self, uint32_t block)
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

/* ---- from the normals at rest ---- */

static bool is_still(const rigid *pose)
{
    const rigid still = rigid_identity();
    return memcmp(pose->r, still.r, sizeof still.r) == 0;
}

static void rotate(shading *self, const rigid *pose, uint32_t block)
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

static void rotate_block(shading *self, const rigid *pose, uint32_t block)
{
    size_t first = (size_t)block * SHADING_BLOCK, size = SHADING_BLOCK * sizeof(float);
    if (!is_still(pose)) {
        rotate(self, pose, block);
        return;
    }
    for (size_t axis = 0; axis < 3; ++axis)
        memcpy(self->normal[axis] + first, self->rest[axis] + first, size);
}

/* ---- an update ---- */

/* The fourth lane is unused: it repeats the third so that this runs on whole vectors. */
static void read_positions(shading *self, const float *const at[3], uint32_t block)
{
    size_t first = (size_t)block * SHADING_BLOCK;
    float *restrict position = self->position[first].at;
    const float *restrict x = at[0] + first, *restrict y = at[1] + first,
                          *restrict z = at[2] + first;
    for (size_t i = 0; i < SHADING_BLOCK; ++i) {
        position[4 * i] = x[i];
        position[4 * i + 1] = y[i];
        position[4 * i + 2] = z[i];
        position[4 * i + 3] = z[i];
    }
    self->is_placed[block] = 1;
}

/* Copies the current positions of all corners of its triangles. */
static void read_positions_around(shading *self, const float *const at[3], uint32_t block)
{
    const shading_block *b = &self->block[block];
    if (!self->is_placed[block])
        read_positions(self, at, block);
    for (uint32_t i = 0; i < b->neighbour_count; ++i) {
        uint32_t other = self->neighbour[b->first_neighbour + i].block;
        if (!self->is_placed[other])
            read_positions(self, at, other);
    }
}

/* Returns the vertices of a block that share a triangle with a written block. */
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

/* Returns the vertices of a carried block with a triangle that is not carried by the same bone. */
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
            rotate_block(self, &now->pose[carrier], block);
    }
    if (lanes != 0) {
        read_positions_around(self, now->at, block);
        gather_lanes(self, block, lanes);
    }
    stamps_mark(&self->written, block);
}

void shading_update(shading *self, const shading_shape *now)
{
    if (!stamps_may_have_changes(&self->seen, now->written))
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

/* ---- creation: triangles of each block, and neighbouring blocks ---- */

/* Triangles of each vertex, during creation. */
typedef struct incidence {
    arrays arrays; /* the arrays below */
    const uint32_t *triangle, *smooth;
    uint32_t triangle_count, vertex_count, block_count;
    uint32_t *start, *of; /* triangles of each vertex that represents others, ascending */
    uint32_t *local;      /* triangle_count: its index in the last block that has it */
    uint32_t *owner;      /* triangle_count: 1 + that block */
    uint32_t *entry;      /* block_count: its index among the neighbours of `whose` */
    uint32_t *whose;      /* block_count: 1 + the block */
} incidence;

static bool incidence_allocate(incidence *s)
{
    arrays *a = &s->arrays;
    s->start = arrays_add(a, (size_t)s->vertex_count + 1, sizeof *s->start);
    s->of = arrays_add(a, (size_t)3 * s->triangle_count, sizeof *s->of);
    s->local = arrays_add(a, s->triangle_count, sizeof *s->local);
    s->owner = arrays_add(a, s->triangle_count, sizeof *s->owner);
    s->entry = arrays_add(a, s->block_count, sizeof *s->entry);
    s->whose = arrays_add(a, s->block_count, sizeof *s->whose);
    return !a->failed;
}

static uint32_t smooth_of(const incidence *s, uint32_t vertex)
{
    return s->smooth ? s->smooth[vertex] : vertex;
}

/* start is shifted by one during filling. */
static void list_triangles(incidence *s)
{
    size_t corners = (size_t)3 * s->triangle_count;
    for (size_t i = 0; i < corners; ++i)
        s->start[smooth_of(s, s->triangle[i]) + 2] += 1;
    for (uint32_t v = 0; v < s->vertex_count; ++v)
        s->start[v + 2] += s->start[v + 1];
    for (size_t i = 0; i < corners; ++i)
        s->of[s->start[smooth_of(s, s->triangle[i]) + 1]++] = (uint32_t)(i / 3);
}

/* ---- creation: one block ---- */

static uint32_t lanes_of_block(const incidence *s, uint32_t block)
{
    uint32_t left = s->vertex_count - block * SHADING_BLOCK;
    return left < SHADING_BLOCK ? left : SHADING_BLOCK;
}

static uint32_t local_of(incidence *s, uint32_t *corner, shading_block *b, uint32_t block,
                         uint32_t t)
{
    if (s->owner[t] != 1 + block) {
        s->owner[t] = 1 + block;
        s->local[t] = b->triangle_count++;
        if (corner)
            memcpy(corner + (size_t)3 * (b->first_triangle + s->local[t]),
                   s->triangle + (size_t)3 * t, 3 * sizeof *corner);
    }
    return s->local[t];
}

/* Fills the table of a block and the triangles that do not fit. If self->corner and more are NULL,
 * only counts. */
static void fill_triangles(shading *self, incidence *s, uint32_t block)
{
    shading_block *b = &self->block[block];
    b->triangle_count = b->more_count = 0;
    for (uint32_t lane = 0; lane < lanes_of_block(s, block); ++lane) {
        uint32_t v = smooth_of(s, block * SHADING_BLOCK + lane), first = s->start[v];
        for (uint32_t i = first; i < s->start[v + 1]; ++i) {
            uint32_t t = s->of[i];
            if (i - first < SHADING_TABLED) {
                uint32_t local = local_of(s, self->corner, b, block, t);
                self->table[block].triangle[lane][i - first] = (uint16_t)local;
                continue;
            }
            shading_more *more = self->more ? &self->more[b->first_more + b->more_count] : NULL;
            if (more)
                more->lane = lane;
            if (more)
                memcpy(more->corner, s->triangle + (size_t)3 * t, sizeof more->corner);
            b->more_count += 1;
        }
    }
}

static void end_table(shading *self, const incidence *s, uint32_t block)
{
    for (uint32_t lane = 0; lane < SHADING_BLOCK; ++lane) {
        uint32_t v = block * SHADING_BLOCK + lane;
        uint32_t leader = v < s->vertex_count ? smooth_of(s, v) : 0;
        uint32_t count = v < s->vertex_count ? s->start[leader + 1] - s->start[leader] : 0;
        for (uint32_t i = count; i < SHADING_TABLED; ++i)
            self->table[block].triangle[lane][i] = (uint16_t)self->block[block].triangle_count;
    }
}

static void note_neighbour(shading *self, incidence *s, uint32_t block, uint32_t other,
                           uint32_t lane)
{
    shading_block *b = &self->block[block];
    if (s->whose[other] != 1 + block) {
        s->whose[other] = 1 + block;
        s->entry[other] = b->neighbour_count++;
        if (self->neighbour)
            self->neighbour[b->first_neighbour + s->entry[other]] =
                (shading_neighbour){.block = other};
    }
    if (self->neighbour)
        self->neighbour[b->first_neighbour + s->entry[other]].lanes |= (uint64_t)1 << lane;
}

/* If self->neighbour is NULL, only counts. */
static void fill_neighbours(shading *self, incidence *s, uint32_t block)
{
    self->block[block].neighbour_count = 0;
    for (uint32_t lane = 0; lane < lanes_of_block(s, block); ++lane) {
        uint32_t v = smooth_of(s, block * SHADING_BLOCK + lane);
        for (uint32_t i = s->start[v]; i < s->start[v + 1]; ++i)
            for (size_t k = 0; k < 3; ++k) {
                uint32_t other = s->triangle[(size_t)3 * s->of[i] + k] / SHADING_BLOCK;
                if (other != block)
                    note_neighbour(self, s, block, other, lane);
            }
    }
}

/* ---- creation: all blocks ---- */

static void fill_blocks(shading *self, incidence *s)
{
    memset(s->owner, 0, s->triangle_count * sizeof *s->owner);
    memset(s->whose, 0, s->block_count * sizeof *s->whose);
    for (uint32_t block = 0; block < self->block_count; ++block) {
        fill_triangles(self, s, block);
        fill_neighbours(self, s, block);
    }
}

/* Counts first, then fills. */
static bool list_blocks(shading *self, incidence *s)
{
    uint32_t triangles = 0, more = 0, neighbours = 0;
    fill_blocks(self, s);
    for (uint32_t block = 0; block < self->block_count; ++block) {
        shading_block *b = &self->block[block];
        b->first_triangle = triangles;
        b->first_more = more;
        b->first_neighbour = neighbours;
        triangles += b->triangle_count;
        more += b->more_count;
        neighbours += b->neighbour_count;
    }
    self->corner = malloc(((size_t)triangles + 1) * 3 * sizeof *self->corner);
    self->more = malloc(((size_t)more + 1) * sizeof *self->more);
    self->neighbour = malloc(((size_t)neighbours + 1) * sizeof *self->neighbour);
    if (!self->corner || !self->more || !self->neighbour)
        return false;
    fill_blocks(self, s);
    for (uint32_t block = 0; block < self->block_count; ++block)
        end_table(self, s, block);
    return true;
}

static bool build_blocks(shading *self, const uint32_t *triangle, uint32_t triangle_count,
                         const uint32_t *smooth)
{
    incidence s = {.triangle = triangle,
                   .smooth = smooth,
                   .triangle_count = triangle_count,
                   .vertex_count = self->vertex_count,
                   .block_count = self->block_count};
    bool done = incidence_allocate(&s);
    if (done) {
        list_triangles(&s);
        done = list_blocks(self, &s);
    }
    arrays_free(&s.arrays);
    return done;
}

static bool allocate(shading *self)
{
    size_t blocks = (size_t)self->block_count + 1, slots = blocks * SHADING_BLOCK;
    size_t stream = slots + STAGGER;
    self->block = calloc(blocks, sizeof *self->block);
    self->table = calloc(blocks, sizeof *self->table);
    self->is_new = calloc(blocks, sizeof *self->is_new);
    self->is_placed = calloc(blocks, sizeof *self->is_placed);
    self->position = large_alloc(slots * sizeof *self->position);
    self->normal[0] = large_alloc(6 * stream * sizeof(float));
    if (!self->block || !self->table || !self->is_new || !self->is_placed || !self->position ||
        !self->normal[0])
        return false;
    memset(self->position, 0, slots * sizeof *self->position);
    memset(self->normal[0], 0, 6 * stream * sizeof(float));
    for (size_t axis = 0; axis < 3; ++axis) {
        self->normal[axis] = self->normal[0] + axis * stream;
        self->rest[axis] = self->normal[0] + (3 + axis) * stream;
    }
    return true;
}

/* Stores the normals at rest, and the vertices without a normal. */
static void store_rest(shading *self, const float *const rest[3])
{
    for (uint32_t v = 0; v < self->vertex_count; ++v)
        self->position[v] = (shading_row){{rest[0][v], rest[1][v], rest[2][v], 0.0f}};
    for (uint32_t block = 0; block < self->block_count; ++block) {
        gather_lanes(self, block, UINT64_MAX);
        self->block[block].flat = flat_lanes(self, block);
    }
    for (uint32_t axis = 0; axis < 3; ++axis)
        memcpy(self->rest[axis], self->normal[axis],
               (size_t)self->block_count * SHADING_BLOCK * sizeof(float));
}

mrt_result shading_create(shading **out, const float *const rest[3], uint32_t vertex_count,
                          const uint32_t *triangle, uint32_t triangle_count, const uint32_t *smooth,
                          error *err)
{
    *out = NULL;
    shading *self = calloc(1, sizeof *self);
    if (self) {
        self->vertex_count = vertex_count;
        self->block_count = vertex_count / SHADING_BLOCK + (vertex_count % SHADING_BLOCK != 0);
    }
    if (!self || !allocate(self) || !build_blocks(self, triangle, triangle_count, smooth)) {
        shading_destroy(self);
        return error_set(err, MRT_ERR_MEMORY, "no memory for the normals of %u triangles",
                         triangle_count);
    }
    mrt_result result = stamps_create(&self->written, self->block_count, err);
    if (result < 0) {
        shading_destroy(self);
        return result;
    }
    store_rest(self, rest);
    *out = self;
    return MRT_OK;
}

void shading_destroy(shading *self)
{
    if (!self)
        return;
    free(self->block);
    free(self->table);
    free(self->corner);
    free(self->more);
    free(self->neighbour);
    large_free(self->position);
    large_free(self->normal[0]);
    free(self->is_new);
    free(self->is_placed);
    stamps_destroy(&self->written);
    free(self);
}

/* ---- results ---- */

const float *shading_normal(const shading *self, uint32_t axis)
{
    return self->normal[axis];
}

const stamps *shading_written(const shading *self)
{
    return &self->written;
}
