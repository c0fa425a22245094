/* Writes the shape shown by blocks, and only those that have changed since the frame before. A
 * block depends on the origin there, on the columns that reach it and their weights, and on the
 * poses of the proxies near it. If none of these has changed, the block is kept. */
#include "face/frame/frame.h"
#include "face/frame/rows.h"

#include <stdlib.h>
#include <string.h>

_Static_assert((int)POINTS_BLOCK == (int)SHADING_BLOCK, "shading has the blocks of its points");

static uint32_t words_of(uint32_t column_count)
{
    return (column_count + COLUMNS_WORD - 1) / COLUMNS_WORD;
}

/* ---- creation ---- */

static bool is_whole(const float *weight)
{
    uint32_t whole = 0;
    for (uint32_t i = 0; i < POINTS_BLOCK; ++i)
        whole += weight[i] < 1.0f ? 0 : 1;
    return whole == POINTS_BLOCK;
}

/* Returns the only bone that moves vertices of the block, if it moves all of them fully. Otherwise
 * returns SHADING_LOOSE. */
static uint8_t bone_of_block(const face *f, uint32_t block)
{
    uint8_t found = SHADING_LOOSE;
    for (uint32_t b = 0; b < f->bone_count; ++b) {
        const face_field *field = &f->field[b];
        if (!field->carried[block])
            continue;
        if (found != SHADING_LOOSE || !is_whole(field->weight + (size_t)block * POINTS_BLOCK))
            return SHADING_LOOSE;
        found = (uint8_t)b;
    }
    return found;
}

mrt_result face_shown_create(face *f, error *err)
{
    face_blocks *s = &f->blocks;
    arrays *a = &f->arrays;
    size_t blocks = f->rest.block_count, words = words_of(f->columns.capacity);
    s->is_stale = arrays_add(a, blocks, 1);
    s->is_rest = arrays_add(a, blocks, 1);
    s->carrier = arrays_add(a, blocks, 1);
    s->bone = arrays_add(a, blocks, 1);
    s->weight = arrays_add(a, (size_t)3 * f->columns.capacity, sizeof *s->weight);
    s->changed = arrays_add(a, words, sizeof *s->changed);
    s->of_controls = arrays_add(a, words, sizeof *s->of_controls);
    if (a->failed)
        return error_set(err, MRT_ERR_MEMORY, "no memory for %u blocks of vertices",
                         f->rest.block_count);
    for (uint32_t block = 0; block < f->rest.block_count; ++block)
        s->bone[block] = bone_of_block(f, block);
    return stamps_create(&s->written, f->rest.block_count, err);
}

/* ---- changes ---- */

static bool is_same_block(const points *a, const points *b, uint32_t block)
{
    size_t first = (size_t)block * POINTS_BLOCK, size = POINTS_BLOCK * sizeof(float);
    return memcmp(a->x + first, b->x + first, size) == 0 &&
           memcmp(a->y + first, b->y + first, size) == 0 &&
           memcmp(a->z + first, b->z + first, size) == 0;
}

void face_mark_stale(face *f, uint32_t block, const points *origin)
{
    f->blocks.is_stale[block] = 1;
    f->blocks.is_rest[block] = is_same_block(origin, &f->rest, block);
}

void face_mark_all_stale(face *f)
{
    for (uint32_t block = 0; block < f->rest.block_count; ++block)
        face_mark_stale(f, block, f->origin);
}

void face_mark_changed_stale(face *f, const points *now, const points *before)
{
    for (uint32_t block = 0; block < now->block_count; ++block)
        if (!is_same_block(now, before, block))
            face_mark_stale(f, block, now);
}

bool face_reaches(const columns *c, const uint64_t *some, uint32_t block)
{
    const uint64_t *mark = c->mark + (size_t)block * c->mark_words;
    uint64_t any = 0;
    for (uint32_t word = 0; word < words_of(c->count); ++word)
        any |= mark[word] & some[word];
    return any != 0;
}

void face_discard_columns(face *f)
{
    const columns *c = &f->columns;
    face_blocks *s = &f->blocks;
    memset(s->changed, 0, words_of(c->count) * sizeof *s->changed);
    for (uint32_t column = 0; column < c->count; ++column) {
        const float *g = s->weight + (size_t)3 * column;
        uint64_t counts = (g[0] != 0.0f) | (g[1] != 0.0f) | (g[2] != 0.0f);
        s->changed[column / COLUMNS_WORD] |= counts << column % COLUMNS_WORD;
    }
    for (uint32_t block = 0; block < c->block_count; ++block)
        if (face_reaches(c, s->changed, block))
            s->is_stale[block] = 1;
    memset(s->weight, 0, (size_t)3 * c->count * sizeof *s->weight);
}

/* ---- frames ---- */

/* Sets blocks.changed to the columns whose weight differs from the frame before. */
static void note_weights(face *f)
{
    const columns *c = &f->columns;
    face_blocks *s = &f->blocks;
    const float *now = c->weights.value;
    memset(s->changed, 0, words_of(c->count) * sizeof *s->changed);
    memset(s->of_controls, 0, words_of(c->count) * sizeof *s->of_controls);
    for (uint32_t column = 0; column < c->count; ++column) {
        float *before = s->weight + (size_t)3 * column;
        uint64_t differs = memcmp(before, now + (size_t)3 * column, 3 * sizeof *now) != 0;
        uint64_t is_control = column < f->control_column_count;
        uint32_t word = column / COLUMNS_WORD, bit = column % COLUMNS_WORD;
        s->changed[word] |= differs << bit;
        s->of_controls[word] |= (is_control << bit) & c->weights.live[word];
        memcpy(before, now + (size_t)3 * column, 3 * sizeof *now);
    }
}

static bool is_due(const face *f, uint32_t block)
{
    return f->blocks.is_stale[block] || face_reaches(&f->columns, f->blocks.changed, block);
}

static bool is_sealed(const face *f, uint32_t block)
{
    return f->lips.is_meeting && f->lips.reaches[block];
}

/* Finishes a block that bones, controls and the seal have just moved. */
static void end_block(face *f, uint32_t block)
{
    face_blocks *s = &f->blocks;
    bool is_loose = projection_apply(&f->projection, &f->shown, block) || is_sealed(f, block) ||
                    !s->is_rest[block] || face_reaches(&f->columns, s->of_controls, block);
    s->carrier[block] = is_loose ? SHADING_LOOSE : s->bone[block];
    s->is_stale[block] = 0;
    stamps_mark(&s->written, block);
}

/* Writes a block whose controls the limit has already summed: only the bones' part is missing. */
static uint32_t write_known(face *f, uint32_t block)
{
    float sum[3][POINTS_BLOCK];
    face_limit_added(f, sum, block);
    columns_sum(&f->columns, sum, f->control_column_count, block);
    columns_add(&f->shown, f->origin, sum, block);
    end_block(f, block);
    return block + 1;
}

/* Writes a block that the limit has already summed with the seal: nothing is missing. */
static uint32_t write_sealed(face *f, uint32_t block)
{
    const size_t first = (size_t)block * POINTS_BLOCK;
    for (size_t slot = first; slot < first + POINTS_BLOCK; slot += 4)
        rows_into(f->shown.x + slot, f->shown.y + slot, f->shown.z + slot,
                  (const float(*)[4])f->lips.sealed + slot);
    points_update_block(&f->shown, block);
    end_block(f, block);
    return block + 1;
}

/* Writes a run of blocks, since columns are faster for several blocks. Returns the end. */
static uint32_t write_run(face *f, uint32_t first)
{
    uint32_t end = first + 1;
    while (end < f->rest.block_count && is_due(f, end) && !is_sealed(f, end) &&
           !face_limit_has_sum(f, end))
        ++end;
    columns_move_blocks(&f->columns, &f->shown, f->origin, first, end);
    for (uint32_t block = first; block < end; ++block)
        end_block(f, block);
    return end;
}

static void note_projection(face *f)
{
    projection_report report = projection_reported(&f->projection);
    f->meter.penetration_mm = report.depth_mm;
    f->meter.projected_count = report.moved_count;
    f->is_exact = report.moved_count == 0 && !f->lips.is_meeting;
}

void face_write(face *f)
{
    face_blocks *s = &f->blocks;
    columns_weigh(&f->columns, f->given, f->columns.count);
    note_weights(f);
    if (face_lips_show(f))
        for (uint32_t block = 0; block < f->rest.block_count; ++block)
            s->is_stale[block] |= f->lips.reaches[block];
    for (uint32_t block = 0; block < f->rest.block_count;)
        block = !is_due(f, block)              ? block + 1
                : is_sealed(f, block)          ? write_sealed(f, block)
                : face_limit_has_sum(f, block) ? write_known(f, block)
                                               : write_run(f, block);
}

void face_show(face *f)
{
    face_blocks *s = &f->blocks;
    face_limit_pull(f);
    face_tongue_limit(f);
    memcpy(s->pose, f->pose, sizeof s->pose);
    stamps_begin(&s->written);
    face_write(f);
    face_limit_slide(f);
    note_projection(f);
}

void face_show_rest(face *f)
{
    face_blocks *s = &f->blocks;
    points_copy(&f->shown, &f->rest);
    projection_pose(&f->projection, f->pose, s->is_stale);
    projection_rest(&f->projection);
    memset(s->weight, 0, (size_t)3 * f->columns.capacity * sizeof *s->weight);
    memset(s->is_stale, 0, f->rest.block_count);
    face_lips_clear(f);
    (void)face_lips_show(f);
    memcpy(s->carrier, s->bone, f->rest.block_count);
    memcpy(s->pose, f->pose, sizeof s->pose);
    stamps_begin(&s->written);
    stamps_mark_all(&s->written);
    note_projection(f);
}

/* ---- access ---- */

const points *face_shown(const face *f)
{
    return &f->shown;
}

const stamps *face_written(const face *f)
{
    return &f->blocks.written;
}

shading_shape face_shading(const face *f)
{
    const points *p = &f->shown;
    return (shading_shape){.at = {p->x, p->y, p->z},
                           .written = &f->blocks.written,
                           .carrier = f->blocks.carrier,
                           .pose = f->blocks.pose};
}
