#include "osc_table.h"
#include "osc_wire.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

bool osc_table_is_text(const char *text, size_t capacity)
{
    if (!text)
        return false;
    size_t length = 0;
    for (; text[length] != '\0'; ++length)
        if ((unsigned char)text[length] < 0x20 || text[length] == 0x7f || length + 1 >= capacity)
            return false;
    return true;
}

static bool is_channel(const mrt_channel *channel)
{
    return osc_table_is_text(channel->name, OSC_NAME_LENGTH) &&
           osc_table_is_text(channel->unit, OSC_UNIT_LENGTH) && channel->hand <= MRT_NO_HAND &&
           channel->semantic <= INT32_MAX && isfinite(channel->min) && isfinite(channel->max);
}

static void point_to_own_texts(osc_table *table)
{
    for (uint32_t i = 0; i < table->count; ++i) {
        table->channel[i].name = table->name[i];
        table->channel[i].unit = table->unit[i];
    }
}

bool osc_table_set(osc_table *out, const char *source, int32_t version, const mrt_channel *channels,
                   uint32_t count)
{
    if (!osc_table_is_text(source, OSC_SOURCE_LENGTH) || source[0] == '\0' || !channels ||
        count == 0 || count > MRT_MAX_CHANNELS)
        return false;
    for (uint32_t i = 0; i < count; ++i)
        if (!is_channel(&channels[i]))
            return false;
    memset(out, 0, sizeof *out);
    snprintf(out->source, sizeof out->source, "%s", source);
    out->version = version;
    out->count = count;
    for (uint32_t i = 0; i < count; ++i) {
        out->channel[i] = channels[i];
        snprintf(out->name[i], OSC_NAME_LENGTH, "%s", channels[i].name);
        snprintf(out->unit[i], OSC_UNIT_LENGTH, "%s", channels[i].unit);
    }
    point_to_own_texts(out);
    return true;
}

void osc_table_copy(osc_table *out, const osc_table *from)
{
    *out = *from;
    point_to_own_texts(out);
}

static bool is_same_channel(const mrt_channel *a, const mrt_channel *b)
{
    return a->semantic == b->semantic && a->hand == b->hand && a->min == b->min &&
           a->max == b->max && strcmp(a->name, b->name) == 0 && strcmp(a->unit, b->unit) == 0;
}

bool osc_table_has(const osc_table *table, const mrt_channel *channels, uint32_t count)
{
    if (table->count != count)
        return false;
    for (uint32_t i = 0; i < count; ++i)
        if (!channels[i].name || !channels[i].unit ||
            !is_same_channel(&table->channel[i], &channels[i]))
            return false;
    return true;
}

size_t osc_table_write(const osc_table *table, void *out, size_t capacity)
{
    osc_builder builder = osc_builder_start();
    osc_builder_text(&builder, table->source);
    osc_builder_int32(&builder, table->version);
    for (uint32_t i = 0; i < table->count; ++i) {
        const mrt_channel *channel = &table->channel[i];
        osc_builder_text(&builder, channel->name);
        osc_builder_text(&builder, channel->unit);
        osc_builder_int32(&builder, (int32_t)channel->semantic);
        osc_builder_int32(&builder, (int32_t)channel->hand);
        osc_builder_float(&builder, channel->min);
        osc_builder_float(&builder, channel->max);
    }
    return osc_builder_finish(&builder, "/marotte/1/channels", out, capacity);
}

size_t osc_table_write_sample(const osc_table *table, const mrt_sample *sample, int64_t sent_ns,
                              void *out, size_t capacity)
{
    osc_builder builder = osc_builder_start();
    osc_builder_text(&builder, table->source);
    osc_builder_int32(&builder, table->version);
    int32_t sequence;
    memcpy(&sequence, &sample->sequence, sizeof sequence);
    osc_builder_int32(&builder, sequence);
    osc_builder_int64(&builder, sample->time_ns);
    osc_builder_int64(&builder, sent_ns);
    for (uint32_t i = 0; i < sample->count; ++i)
        osc_builder_float(&builder, sample->value[i]);
    return osc_builder_finish(&builder, "/marotte/1/sample", out, capacity);
}

size_t osc_table_write_end(const osc_table *table, void *out, size_t capacity)
{
    osc_builder builder = osc_builder_start();
    osc_builder_text(&builder, table->source);
    osc_builder_int32(&builder, table->version);
    return osc_builder_finish(&builder, "/marotte/1/end", out, capacity);
}
