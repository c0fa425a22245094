#include "stage/mapping/answers.h"

#include <stdlib.h>
#include <string.h>

void answers_finish(answers *self)
{
    free(self->of);
    free(self->bytes);
    *self = (answers){0};
}

static bool make_room(answers *self, size_t size)
{
    if (self->count == self->capacity) {
        size_t capacity = self->capacity * 2 + 256;
        answers_step *grown = realloc(self->of, capacity * sizeof *grown);
        if (!grown)
            return false;
        self->of = grown;
        self->capacity = capacity;
    }
    if (self->size + size <= self->bytes_capacity)
        return true;
    size_t capacity = self->bytes_capacity * 2 + 64 * size;
    unsigned char *bytes = realloc(self->bytes, capacity);
    if (!bytes)
        return false;
    self->bytes = bytes;
    self->bytes_capacity = capacity;
    return true;
}

static uint32_t vectors_to_keep(const mrt_pull *pull)
{
    static const mrt_vector nothing = {{0, 0, 0}, {0, 0, 0}, 0};
    uint32_t count = MRT_MAX_VECTORS;
    while (count > pull->count && memcmp(&pull->vector[count - 1], &nothing, sizeof nothing) == 0)
        count -= 1;
    return count;
}

void answers_write_pull(bytes_out *out, const mrt_pull *pull)
{
    uint32_t count = vectors_to_keep(pull);
    bytes_write(out, pull, offsetof(mrt_pull, vector));
    bytes_write_u32(out, count);
    bytes_write(out, pull->vector, count * sizeof *pull->vector);
    bytes_write(out, pull->dof, sizeof pull->dof);
}

uint32_t answers_read_pull(bytes_in *in, mrt_pull *out)
{
    bytes_read(in, out, offsetof(mrt_pull, vector));
    uint32_t count = bytes_read_u32(in);
    if (count > MRT_MAX_VECTORS)
        in->failed = true;
    else
        bytes_read(in, out->vector, count * sizeof *out->vector);
    bytes_read(in, out->dof, sizeof out->dof);
    return count;
}

void answers_add(answers *self, int64_t time_ns, mrt_result result, const mrt_pull *pull)
{
    if (self->is_full || !make_room(self, sizeof(uint32_t) + sizeof *pull)) {
        self->is_full = true;
        return;
    }
    bytes_out out = {self->bytes, self->bytes_capacity, self->size};
    self->of[self->count++] = (answers_step){
        .time_ns = time_ns, .at = self->size, .result = result, .is_taught = self->is_taught};
    answers_write_pull(&out, pull);
    self->size = out.size;
}

const answers_step *answers_find(answers *self, int64_t time_ns)
{
    size_t low = 0, high = self->count;
    if (self->next < self->count && self->of[self->next].time_ns == time_ns)
        return &self->of[self->next];
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (self->of[middle].time_ns < time_ns)
            low = middle + 1;
        else
            high = middle;
    }
    self->next = low;
    return low < self->count && self->of[low].time_ns == time_ns ? &self->of[low] : NULL;
}

mrt_result answers_pop(answers *self, int64_t time_ns, mrt_pull *pull)
{
    const answers_step *found = answers_find(self, time_ns);
    if (!found)
        return MRT_HOLD;
    bytes_in in = {self->bytes + found->at, self->bytes + self->size, false};
    *pull = (mrt_pull){0};
    (void)answers_read_pull(&in, pull);
    self->next += 1;
    return found->result;
}

size_t answers_size(const answers *self)
{
    return self->size + self->count * sizeof *self->of;
}
