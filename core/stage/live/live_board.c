#include "stage/live/live_board.h"
#include "base/clock.h"

#include <stdlib.h>
#include <string.h>

static const int64_t ease_ns = 250 * NS_PER_MS;

static size_t row_floats(const live_board *self)
{
    return (size_t)self->vertex_count * 3;
}

static uint32_t end_of_block(const points_order *order, uint32_t block)
{
    uint32_t end = (block + 1) * POINTS_BLOCK;
    return end < order->count ? end : order->count;
}

/* Appends the parts that contain vertices of a block, without duplicates. Returns the new count. */
static uint32_t list_parts(live_board *out, const points_order *order, uint32_t block,
                           uint32_t count)
{
    uint32_t first = count, end = end_of_block(order, block);
    for (uint32_t slot = block * POINTS_BLOCK; slot < end; ++slot) {
        uint32_t part = order->file_of_slot[slot] / LIVE_ROWS, i = first;
        while (i < count && out->part[i] != part)
            ++i;
        if (i == count)
            out->part[count++] = part;
    }
    return count;
}

static mrt_result create_changes(live_board *out, const points_order *order, error *err)
{
    uint32_t parts = out->vertex_count / LIVE_ROWS + (out->vertex_count % LIVE_ROWS != 0);
    uint32_t blocks = out->vertex_count / POINTS_BLOCK + (out->vertex_count % POINTS_BLOCK != 0);
    mrt_result result = stamps_create(&out->changed, parts, err);
    for (int i = 0; i < 3 && result >= 0; ++i)
        result = stamps_create(&out->changed_in[i], parts, err);
    if (result < 0)
        return result;
    out->first_part = calloc((size_t)blocks + 1, sizeof *out->first_part);
    out->part = malloc(((size_t)out->vertex_count + 1) * sizeof *out->part);
    if (!out->first_part || !out->part)
        return error_set(err, MRT_ERR_MEMORY, "no memory to track the changes of a face");
    for (uint32_t block = 0; block < blocks; ++block)
        out->first_part[block + 1] = list_parts(out, order, block, out->first_part[block]);
    return MRT_OK;
}

mrt_result live_board_create(live_board *out, const composer *of, error *err)
{
    *out = (live_board){.number = 0};
    /* the composer's face is not changed here */
    face *f = composer_face((composer *)(uintptr_t)of);
    out->vertex_count = face_order(f)->count;
    slot_init(&out->slot);
    atomic_init(&out->is_taken, true);
    size_t size = row_floats(out) * 2 + 1;
    bool good = true;
    for (int i = 0; i < 3; ++i) {
        out->rows[i] = calloc(size, sizeof *out->rows[i]);
        good &= out->rows[i] != NULL;
    }
    out->from = calloc(size, sizeof *out->from);
    mrt_result result = good && out->from
                            ? create_changes(out, face_order(f), err)
                            : error_set(err, MRT_ERR_MEMORY, "no memory for the published faces");
    if (result < 0)
        live_board_destroy(out);
    return result;
}

void live_board_destroy(live_board *self)
{
    for (int i = 0; i < 3; ++i) {
        free(self->rows[i]);
        stamps_destroy(&self->changed_in[i]);
    }
    stamps_destroy(&self->changed);
    free(self->first_part);
    free(self->part);
    free(self->from);
    memset(self, 0, sizeof *self);
}

/* ---- [frame] ---- */

/* Positions or normals of a composer's face. */
typedef struct board_source {
    const float *stream[3]; /* in the engine's order */
    const stamps *written;  /* blocks with changes */
    const points_order *order;
} board_source;

/* Copies a block to rows in the order of the mesh file. */
static void write_block(float *restrict out, const board_source *from, uint32_t block)
{
    const float *restrict x = from->stream[0], *restrict y = from->stream[1],
                          *restrict z = from->stream[2];
    const uint32_t *restrict file_of_slot = from->order->file_of_slot;
    uint32_t end = end_of_block(from->order, block);
    for (uint32_t slot = block * POINTS_BLOCK; slot < end; ++slot) {
        float *row = out + (size_t)file_of_slot[slot] * 3;
        row[0] = x[slot];
        row[1] = y[slot];
        row[2] = z[slot];
    }
}

static void mark_block(live_board *self, uint32_t block)
{
    self->is_new = true;
    for (uint32_t i = self->first_part[block]; i < self->first_part[block + 1]; ++i)
        stamps_mark(&self->changed, self->part[i]);
}

/* Copies the changes since this buffer was filled, and marks the changes since the last fill of any
 * buffer. */
static void copy_rows(live_board *self, float *out, const board_source *from, stamps_reader *taken,
                      stamps_reader *noted)
{
    for (uint32_t block = 0; block < from->written->count; ++block) {
        if (stamps_is_new(taken, from->written, block))
            write_block(out, from, block);
        if (stamps_is_new(noted, from->written, block))
            mark_block(self, block);
    }
    stamps_read(taken, from->written);
    stamps_read(noted, from->written);
}

static void copy_face(live_board *self, uint32_t back, composer *of)
{
    const face *f = composer_face(of);
    const points *p = face_shown(f);
    const shading *s = composer_shading(of);
    const board_source position = {{p->x, p->y, p->z}, face_written(f), face_order(f)};
    const board_source normal = {{shading_normal(s, 0), shading_normal(s, 1), shading_normal(s, 2)},
                                 shading_written(s),
                                 face_order(f)};
    float *rows = self->rows[back];
    live_taken *taken = &self->taken[back], *noted = &self->noted;
    copy_rows(self, rows, &position, &taken->position, &noted->position);
    copy_rows(self, rows + row_floats(self), &normal, &taken->normal, &noted->normal);
}

/* The buffer now shows a mixed face, so all of it must be copied again for the next frame. */
static void ease(live_board *self, uint32_t back, int64_t now_ns)
{
    float *rows = self->rows[back];
    self->is_new = true;
    double s = (double)(now_ns - self->eases_from_ns) / (double)ease_ns;
    if (s >= 1.0) {
        self->is_easing = false;
        return;
    }
    float left = s > 0.0 ? (float)(1.0 - s * s * (3.0 - 2.0 * s)) : 1.0f;
    for (size_t i = 0; i < row_floats(self) * 2; ++i)
        rows[i] += left * (self->from[i] - rows[i]);
    self->taken[back] = self->noted = (live_taken){.position = {.seen = 0}};
    stamps_mark_all(&self->changed);
}

live_view *live_board_fill(live_board *self, composer *of, int64_t now_ns)
{
    uint32_t back = slot_back(&self->slot);
    float *rows = self->rows[back];
    live_view *view = &self->view[back];
    stamps_begin(&self->changed);
    copy_face(self, back, of);
    if (self->is_easing)
        ease(self, back, now_ns);
    stamps_copy(&self->changed_in[back], &self->changed);
    memset(view, 0, sizeof *view);
    view->number = self->number + 1;
    view->position = rows;
    view->normal = rows + row_floats(self);
    view->changed = &self->changed_in[back];
    view->vertex_count = self->vertex_count;
    view->min_determinant = 1.0;
    return view;
}

bool live_board_is_new(const live_board *self)
{
    return self->is_new;
}

const live_view *live_board_published(const live_board *self)
{
    return self->has_shown ? &self->view[self->shown] : NULL;
}

static void publish(live_board *self)
{
    self->shown = slot_back(&self->slot);
    self->has_shown = true;
    self->is_new = false;
    atomic_store(&self->is_taken, false);
    slot_publish(&self->slot);
}

void live_board_publish(live_board *self)
{
    self->number += 1;
    publish(self);
}

void live_board_publish_again(live_board *self)
{
    self->view[slot_back(&self->slot)].number = self->number;
    publish(self);
}

/* The last published buffer is only read, here as well as by [main]. */
void live_board_ease(live_board *self, int64_t now_ns)
{
    if (!self->has_shown)
        return;
    memcpy(self->from, self->rows[self->shown], row_floats(self) * 2 * sizeof *self->from);
    self->is_easing = true;
    self->eases_from_ns = now_ns;
}

void live_board_ease_from(live_board *self, const live_board *other, int64_t now_ns)
{
    if (!other->has_shown || other->vertex_count != self->vertex_count)
        return;
    memcpy(self->from, other->rows[other->shown], row_floats(self) * 2 * sizeof *self->from);
    self->is_easing = true;
    self->eases_from_ns = now_ns;
}

bool live_board_is_easing(const live_board *self)
{
    return self->is_easing;
}

bool live_board_is_taken(const live_board *self)
{
    return atomic_load(&self->is_taken);
}

/* ---- [main] ---- */

bool live_board_look(live_board *self, const live_view **out)
{
    bool is_new = slot_receive(&self->slot);
    *out = &self->view[slot_front(&self->slot)];
    if (is_new)
        atomic_store(&self->is_taken, true);
    return is_new;
}
