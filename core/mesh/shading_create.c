/* Shading from triangles: which of them touch each block, which blocks touch each other. */
#include "mesh/shading_state.h"

#include <stdlib.h>
#include <string.h>

enum { ALIGNMENT = 64, STAGGER = 80 }; /* floats between two streams: no power of two */

/* The mesh while it is taken in. */
typedef struct source {
    const uint32_t *triangle, *smooth;
    uint32_t triangle_count, vertex_count, block_count;
    uint32_t *start, *of; /* the triangles of each vertex that stands for others, ascending */
    uint32_t *local;      /* triangle_count: its index in the block that has it last */
    uint32_t *owner;      /* triangle_count: 1 + that block */
    uint32_t *entry;      /* block_count: where the block is among the neighbours of `whose` */
    uint32_t *whose;      /* block_count: 1 + the block */
} source;

static void free_source(source *s)
{
    free(s->start);
    free(s->of);
    free(s->local);
    free(s->owner);
    free(s->entry);
    free(s->whose);
}

static bool allocate_source(source *s)
{
    size_t triangles = (size_t)s->triangle_count + 1, blocks = (size_t)s->block_count + 1;
    s->start = calloc((size_t)s->vertex_count + 2, sizeof *s->start);
    s->of = malloc(3 * triangles * sizeof *s->of);
    s->local = calloc(triangles, sizeof *s->local);
    s->owner = calloc(triangles, sizeof *s->owner);
    s->entry = calloc(blocks, sizeof *s->entry);
    s->whose = calloc(blocks, sizeof *s->whose);
    return s->start && s->of && s->local && s->owner && s->entry && s->whose;
}

static uint32_t smooth_of(const source *s, uint32_t vertex)
{
    return s->smooth ? s->smooth[vertex] : vertex;
}

/* start is shifted by one while it is filled. */
static void list_triangles(source *s)
{
    size_t corners = (size_t)3 * s->triangle_count;
    for (size_t i = 0; i < corners; ++i)
        s->start[smooth_of(s, s->triangle[i]) + 2] += 1;
    for (uint32_t v = 0; v < s->vertex_count; ++v)
        s->start[v + 2] += s->start[v + 1];
    for (size_t i = 0; i < corners; ++i)
        s->of[s->start[smooth_of(s, s->triangle[i]) + 1]++] = (uint32_t)(i / 3);
}

/* ---- one block ---- */

static uint32_t lanes_of_block(const source *s, uint32_t block)
{
    uint32_t left = s->vertex_count - block * SHADING_BLOCK;
    return left < SHADING_BLOCK ? left : SHADING_BLOCK;
}

static uint32_t local_of(source *s, uint32_t *corner, shading_block *b, uint32_t block, uint32_t t)
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

/* The table of a block and what is beyond it; self->corner and more NULL: only counts. */
static void take_triangles(shading *self, source *s, uint32_t block)
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

static void end_table(shading *self, const source *s, uint32_t block)
{
    for (uint32_t lane = 0; lane < SHADING_BLOCK; ++lane) {
        uint32_t v = block * SHADING_BLOCK + lane;
        uint32_t leader = v < s->vertex_count ? smooth_of(s, v) : 0;
        uint32_t count = v < s->vertex_count ? s->start[leader + 1] - s->start[leader] : 0;
        for (uint32_t i = count; i < SHADING_TABLED; ++i)
            self->table[block].triangle[lane][i] = (uint16_t)self->block[block].triangle_count;
    }
}

static void note_neighbour(shading *self, source *s, uint32_t block, uint32_t other, uint32_t lane)
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

/* self->neighbour NULL: only counts. */
static void take_neighbours(shading *self, source *s, uint32_t block)
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

/* ---- all of them ---- */

static void take_blocks(shading *self, source *s)
{
    memset(s->owner, 0, s->triangle_count * sizeof *s->owner);
    memset(s->whose, 0, s->block_count * sizeof *s->whose);
    for (uint32_t block = 0; block < self->block_count; ++block) {
        take_triangles(self, s, block);
        take_neighbours(self, s, block);
    }
}

/* Counted first, then filled. */
static bool list_blocks(shading *self, source *s)
{
    uint32_t triangles = 0, more = 0, neighbours = 0;
    take_blocks(self, s);
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
    take_blocks(self, s);
    for (uint32_t block = 0; block < self->block_count; ++block)
        end_table(self, s, block);
    return true;
}

static bool take_in(shading *self, const uint32_t *triangle, uint32_t triangle_count,
                    const uint32_t *smooth)
{
    source s = {.triangle = triangle,
                .smooth = smooth,
                .triangle_count = triangle_count,
                .vertex_count = self->vertex_count,
                .block_count = self->block_count};
    bool done = allocate_source(&s);
    if (done) {
        list_triangles(&s);
        done = list_blocks(self, &s);
    }
    free_source(&s);
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
    self->place = aligned_alloc(ALIGNMENT, slots * sizeof *self->place);
    self->normal[0] = aligned_alloc(ALIGNMENT, 6 * stream * sizeof(float));
    if (!self->block || !self->table || !self->is_new || !self->is_placed || !self->place ||
        !self->normal[0])
        return false;
    memset(self->place, 0, slots * sizeof *self->place);
    memset(self->normal[0], 0, 6 * stream * sizeof(float));
    for (size_t axis = 0; axis < 3; ++axis) {
        self->normal[axis] = self->normal[0] + axis * stream;
        self->rest[axis] = self->normal[0] + (3 + axis) * stream;
    }
    return true;
}

/* The normals of the shape at rest, and which vertices have none. */
static void take_rest(shading *self, const float *const rest[3])
{
    for (uint32_t v = 0; v < self->vertex_count; ++v)
        self->place[v] = (shading_row){{rest[0][v], rest[1][v], rest[2][v], 0.0f}};
    for (uint32_t block = 0; block < self->block_count; ++block) {
        shading_gather(self, block, UINT64_MAX);
        self->block[block].flat = shading_flat(self, block);
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
    if (!self || !allocate(self) || !take_in(self, triangle, triangle_count, smooth)) {
        shading_destroy(self);
        return error_set(err, MRT_ERR_MEMORY, "no memory for the normals of %u triangles",
                         triangle_count);
    }
    mrt_result result = stamps_create(&self->written, self->block_count, err);
    if (result < 0) {
        shading_destroy(self);
        return result;
    }
    take_rest(self, rest);
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
    free(self->place);
    free(self->normal[0]);
    free(self->is_new);
    free(self->is_placed);
    stamps_destroy(&self->written);
    free(self);
}
