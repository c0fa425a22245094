#include "stage/perform/frame_inputs.h"
#include "base/bytes.h"
#include "stage/perform/pointer.h"

#include <math.h>
#include <string.h>

enum { STORE_VERSION = 1 };

void frame_inputs_reset(frame_inputs *self)
{
    self->count = 0;
}

static void show(frame_inputs *self, uint32_t i, int64_t time_ns)
{
    self->shown[i] = (mrt_channels){.name = self->name[i],
                                    .channel = self->table[i].channel,
                                    .value = self->value[i],
                                    .time_ns = time_ns,
                                    .count = self->table[i].count};
}

static bool is_known_as(const frame_inputs *self, uint32_t i, const channel_route *route)
{
    if (strcmp(self->name[i], route->name) != 0)
        return false;
    return route->name[0] || channel_table_equal(&self->table[i], &route->table, NULL);
}

static uint32_t slot_of(const frame_inputs *self, const channel_route *route)
{
    uint32_t oldest = 0;
    for (uint32_t i = 0; i < self->count; ++i) {
        if (is_known_as(self, i, route))
            return i;
        if (self->shown[i].time_ns < self->shown[oldest].time_ns)
            oldest = i;
    }
    return self->count < MRT_MAX_INPUTS ? self->count : oldest;
}

/* Copies the names and channels of an input if they changed. The comparison avoids copying long
 * names at each step. */
static void describe(frame_inputs *self, uint32_t i, const channel_route *route)
{
    const channel_table *from = &route->table;
    channel_table *to = &self->table[i];
    bool is_same = i < self->count && to->count == from->count &&
                   memcmp(self->name[i], route->name, sizeof route->name) == 0 &&
                   memcmp(to->name, from->name, sizeof to->name) == 0 &&
                   channel_table_equal(to, from, NULL);
    if (is_same)
        return;
    memcpy(self->name[i], route->name, sizeof self->name[i]);
    channel_table_copy(to, from->channel, from->count);
    if (i == self->count)
        self->count += 1;
}

static bool is_hosts_own(const channel_route *route)
{
    return route->table.count == 0 || route->table.channel[0].semantic >= POINTER_SEMANTIC;
}

void frame_inputs_read(frame_inputs *self, const sample_step *s, int64_t time_ns)
{
    for (uint32_t k = 0; k < s->count; ++k) {
        const channel_route *route = s->of[k].route;
        const mrt_sample *sample = &s->of[k].sample;
        if (is_hosts_own(route))
            continue;
        uint32_t i = slot_of(self, route);
        describe(self, i, route);
        memset(self->value[i], 0, sizeof self->value[i]);
        for (uint32_t c = 0; c < route->table.count && c < sample->count; ++c)
            self->value[i][c] = sample->value[c];
        show(self, i, time_ns);
    }
}

/* ---- save and load ---- */

static void write_text(bytes_out *out, const char *text)
{
    uint32_t length = (uint32_t)strlen(text);
    bytes_write_u32(out, length);
    bytes_write(out, text, length);
}

static void read_text(bytes_in *in, char *out, size_t capacity)
{
    uint32_t length = bytes_read_u32(in);
    memset(out, 0, capacity);
    in->failed |= length >= capacity;
    if (in->failed)
        return;
    bytes_read(in, out, length);
    in->failed |= strlen(out) != length;
}

size_t frame_inputs_save(const frame_inputs *self, void *bytes, size_t capacity)
{
    bytes_out out = {.data = bytes, .capacity = bytes ? capacity : 0};
    bytes_write_u32(&out, STORE_VERSION);
    bytes_write_u32(&out, self->count);
    for (uint32_t i = 0; i < self->count; ++i) {
        write_text(&out, self->name[i]);
        bytes_write(&out, &self->shown[i].time_ns, sizeof self->shown[i].time_ns);
        bytes_write_u32(&out, self->table[i].count);
        for (uint32_t c = 0; c < self->table[i].count; ++c) {
            const mrt_channel *channel = &self->table[i].channel[c];
            write_text(&out, channel->name);
            write_text(&out, channel->unit);
            bytes_write_u32(&out, channel->semantic);
            bytes_write_u32(&out, channel->hand);
            bytes_write(&out, &channel->min, sizeof channel->min);
            bytes_write(&out, &channel->max, sizeof channel->max);
            bytes_write(&out, &self->value[i][c], sizeof self->value[i][c]);
        }
    }
    return out.size;
}

static void read_channel(bytes_in *in, frame_inputs *self, uint32_t i, uint32_t c)
{
    channel_table *table = &self->table[i];
    mrt_channel *channel = &table->channel[c];
    read_text(in, table->name[c], CHANNEL_NAME);
    read_text(in, table->unit[c], CHANNEL_UNIT);
    channel->name = table->name[c];
    channel->unit = table->unit[c];
    channel->semantic = bytes_read_u32(in);
    channel->hand = bytes_read_u32(in);
    bytes_read(in, &channel->min, sizeof channel->min);
    bytes_read(in, &channel->max, sizeof channel->max);
    bytes_read(in, &self->value[i][c], sizeof self->value[i][c]);
    in->failed |= channel->hand > MRT_NO_HAND || !isfinite(channel->min) ||
                  !isfinite(channel->max) || !isfinite(self->value[i][c]);
}

static void read_input(bytes_in *in, frame_inputs *self, uint32_t i)
{
    int64_t time_ns = 0;
    channel_table *table = &self->table[i];
    *table = (channel_table){0};
    memset(self->value[i], 0, sizeof self->value[i]);
    read_text(in, self->name[i], ROUTE_NAME);
    bytes_read(in, &time_ns, sizeof time_ns);
    table->count = bytes_read_u32(in);
    in->failed |= table->count == 0 || table->count > MRT_MAX_CHANNELS;
    for (uint32_t c = 0; !in->failed && c < table->count; ++c)
        read_channel(in, self, i, c);
    show(self, i, time_ns);
}

bool frame_inputs_load(frame_inputs *self, const void *bytes, size_t size)
{
    bytes_in in = {.at = bytes, .end = (const unsigned char *)bytes + size};
    frame_inputs_reset(self);
    in.failed |= bytes_read_u32(&in) != STORE_VERSION;
    uint32_t count = bytes_read_u32(&in);
    in.failed |= count > MRT_MAX_INPUTS;
    for (uint32_t i = 0; !in.failed && i < count; ++i)
        read_input(&in, self, i);
    if (in.failed || in.at != in.end)
        return false;
    self->count = count;
    return true;
}

void frame_inputs_shift_time(frame_inputs *self, int64_t by_ns)
{
    for (uint32_t i = 0; i < self->count; ++i)
        self->shown[i].time_ns = (int64_t)((uint64_t)self->shown[i].time_ns + (uint64_t)by_ns);
}
