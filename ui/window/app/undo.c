#include "window/app/undo.h"

#include <stdlib.h>
#include <string.h>

struct undo_list {
    undo_change change[UNDO_CHANGES_MAX]; /* 0..done_count can be undone, the rest redone */
    uint32_t done_count, count;
    size_t bytes;
    uint64_t number; /* of the newest change */
};

static void drop(undo_list *self, uint32_t index)
{
    undo_change *of = &self->change[index];
    self->bytes -= of->bytes;
    free(of->before);
    free(of->after);
    memmove(of, of + 1, (self->count - index - 1) * sizeof *of);
    self->count -= 1;
    if (index < self->done_count)
        self->done_count -= 1;
}

void undo_list_add(undo_list *self, const undo_change *change)
{
    while (self->count > self->done_count)
        drop(self, self->count - 1);
    while (self->count == UNDO_CHANGES_MAX ||
           (self->count > 0 && self->bytes + change->bytes > UNDO_BYTES_MAX))
        drop(self, 0);
    self->change[self->count] = *change;
    self->change[self->count++].number = ++self->number;
    self->done_count = self->count;
    self->bytes += change->bytes;
}

void undo_list_add_undone(undo_list *self, const undo_change *change)
{
    if (self->count == UNDO_CHANGES_MAX)
        drop(self, self->count - 1);
    memmove(&self->change[1], &self->change[0], self->count * sizeof self->change[0]);
    self->change[0] = *change;
    self->change[0].number = 0;
    self->count += 1;
    self->bytes += change->bytes;
}

bool undo_change_copy(undo_change *change, const void *before, const void *after, size_t size)
{
    change->before = malloc(size);
    change->after = malloc(size);
    if (!change->before || !change->after) {
        free(change->before);
        free(change->after);
        return false;
    }
    memcpy(change->before, before, size);
    memcpy(change->after, after, size);
    change->bytes += 2 * size;
    return true;
}

undo_change *undo_list_next(undo_list *self)
{
    return self->done_count > 0 ? &self->change[self->done_count - 1] : NULL;
}

undo_change *undo_list_next_redo(undo_list *self)
{
    return self->done_count < self->count ? &self->change[self->done_count] : NULL;
}

/* The position changes first, because `set` may drop changes, of this owner or of another one. */
mrt_result undo_list_undo(undo_list *self)
{
    const undo_change *of = undo_list_next(self);
    if (!of)
        return MRT_END;
    self->done_count -= 1;
    return of->set(of->owner, of->before);
}

mrt_result undo_list_redo(undo_list *self)
{
    const undo_change *of = undo_list_next_redo(self);
    if (!of)
        return MRT_END;
    self->done_count += 1;
    return of->set(of->owner, of->after);
}

void undo_list_forget_if(undo_list *self, const void *owner,
                         bool (*is_dropped)(const undo_change *of, const void *data),
                         const void *data)
{
    for (uint32_t i = self->count; i > 0; --i) {
        const undo_change *of = &self->change[i - 1];
        if (of->owner == owner && (!is_dropped || is_dropped(of, data)))
            drop(self, i - 1);
    }
}

size_t undo_list_bytes(const undo_list *self)
{
    return self->bytes;
}

undo_list *undo_list_create(void)
{
    return calloc(1, sizeof(undo_list));
}

void undo_list_destroy(undo_list *self)
{
    if (!self)
        return;
    while (self->count > 0)
        drop(self, self->count - 1);
    free(self);
}
