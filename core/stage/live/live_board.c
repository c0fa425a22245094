#include "stage/live/live_board.h"
#include "base/clock.h"

#include <stdlib.h>
#include <string.h>

static const int64_t ease_ns = 250 * NS_PER_MS;

static size_t row_floats(const live_board *self)
{
    return (size_t)self->vertex_count * 3;
}

mrt_result live_board_create(live_board *out, const composer *of, error *err)
{
    *out = (live_board){.number = 0};
    /* a composer's face does not change by being asked */
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
    if (good && out->from)
        return MRT_OK;
    live_board_destroy(out);
    return error_set(err, MRT_ERR_MEMORY, "no memory for the faces that are shown");
}

void live_board_destroy(live_board *self)
{
    for (int i = 0; i < 3; ++i)
        free(self->rows[i]);
    free(self->from);
    memset(self, 0, sizeof *self);
}

/* ---- [frame] ---- */

static void copy_rows(const live_board *self, float *out, composer *of)
{
    const face *f = composer_face(of);
    const points_order *order = face_order(f);
    const float *x = composer_normal(of, 0), *y = composer_normal(of, 1),
                *z = composer_normal(of, 2);
    float *normal = out + row_floats(self);
    points_to_rows(out, face_shown(f), order);
    for (uint32_t slot = 0; slot < order->count; ++slot) {
        float *row = normal + (size_t)order->file_of_slot[slot] * 3;
        row[0] = x[slot];
        row[1] = y[slot];
        row[2] = z[slot];
    }
}

static void ease(live_board *self, float *rows, int64_t now_ns)
{
    double s = (double)(now_ns - self->eases_from_ns) / (double)ease_ns;
    if (s >= 1.0) {
        self->is_easing = false;
        return;
    }
    float left = s > 0.0 ? (float)(1.0 - s * s * (3.0 - 2.0 * s)) : 1.0f;
    for (size_t i = 0; i < row_floats(self) * 2; ++i)
        rows[i] += left * (self->from[i] - rows[i]);
}

live_view *live_board_fill(live_board *self, composer *of, int64_t now_ns)
{
    uint32_t back = slot_back(&self->slot);
    float *rows = self->rows[back];
    live_view *view = &self->view[back];
    copy_rows(self, rows, of);
    if (self->is_easing)
        ease(self, rows, now_ns);
    memset(view, 0, sizeof *view);
    view->number = ++self->number;
    view->position = rows;
    view->normal = rows + row_floats(self);
    view->vertex_count = self->vertex_count;
    view->min_determinant = 1.0;
    return view;
}

void live_board_publish(live_board *self)
{
    self->shown = slot_back(&self->slot);
    self->has_shown = true;
    atomic_store(&self->is_taken, false);
    slot_publish(&self->slot);
}

/* The buffer that was published last is read only, by whoever has it: here too. */
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
    bool is_new = slot_take(&self->slot);
    *out = &self->view[slot_front(&self->slot)];
    if (is_new)
        atomic_store(&self->is_taken, true);
    return is_new;
}
