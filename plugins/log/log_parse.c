#include "log_parse.h"

#include "log_format.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Eleven days: no performance lasts longer, and sums of such times stay far from overflow. */
static const int64_t LENGTH_MAX_NS = INT64_C(1000000) * 1000000000;

mrt_result log_refuse(char *out_reason, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(out_reason, LOG_REASON, format, arguments);
    va_end(arguments);
    return MRT_ERR_FORMAT;
}

const char *const log_sensor_name[MRT_ANGLES] = {
    "thumb.roll", "thumb.mpj",  "thumb.ij",    "thumb.abd",  "index.mpj",  "index.pij",
    "index.dij",  "middle.mpj", "middle.pij",  "middle.dij", "middle.abd", "ring.mpj",
    "ring.pij",   "ring.dij",   "ring.abd",    "little.mpj", "little.pij", "little.dij",
    "little.abd", "palm.arch",  "wrist.pitch", "wrist.yaw"};

/* What the values of a channel may reach, for gauges. */
static float channel_max(uint32_t semantic, const char *unit)
{
    if (strcmp(unit, "rad") == 0)
        return 3.1415927f;
    if (strcmp(unit, "count") == 0)
        return 255.0f;
    if (strcmp(unit, "mm") == 0)
        return 2000.0f;
    return semantic == MRT_CH_OTHER ? 1e6f : 1.0f;
}

static bool is_never_negative(uint32_t semantic, const char *unit)
{
    return strcmp(unit, "count") == 0 || semantic >= MRT_CH_PEDAL;
}

void log_add_channel(log_data *data, const char *name, const char *unit, uint32_t semantic,
                     uint32_t hand)
{
    uint32_t i = data->channel_count++;
    snprintf(data->name[i], LOG_NAME, "%s", name);
    snprintf(data->unit[i], LOG_NAME, "%s", unit);
    float max = channel_max(semantic, unit);
    data->channel[i] = (mrt_channel){data->name[i],
                                     data->unit[i],
                                     semantic,
                                     hand,
                                     is_never_negative(semantic, unit) ? 0.0f : -max,
                                     max};
}

/* ---- records ---- */

typedef enum log_kind { KIND_NONE = 0, KIND_TABLE, KIND_RECORDING } log_kind;

typedef struct reader {
    log_data *data;
    log_kind kind;
    log_table table;
    size_t line_number;
    size_t capacity; /* of the record arrays */
    int64_t first_ns;
    char reason[LOG_REASON];
} reader;

static mrt_result grow(reader *self)
{
    log_data *data = self->data;
    size_t capacity = self->capacity + self->capacity / 2 + 256;
    int64_t *time_ns = realloc(data->time_ns, capacity * sizeof *time_ns);
    if (time_ns)
        data->time_ns = time_ns;
    float *value = realloc(data->value, capacity * data->channel_count * sizeof *value);
    if (value)
        data->value = value;
    if (!time_ns || !value) {
        log_refuse(self->reason, "no memory for %zu records", capacity);
        return MRT_ERR_MEMORY;
    }
    self->capacity = capacity;
    return MRT_OK;
}

static mrt_result append(reader *self, const log_record *record)
{
    log_data *data = self->data;
    if (data->record_count == 0)
        self->first_ns = record->time_ns;
    int64_t time_ns = record->time_ns - self->first_ns;
    if (data->record_count > 0 && time_ns < data->time_ns[data->record_count - 1])
        return log_refuse(self->reason, "its time lies before that of the record above");
    if (time_ns > LENGTH_MAX_NS)
        return log_refuse(self->reason, "its time lies more than eleven days after the first");
    if (data->record_count == self->capacity) {
        mrt_result result = grow(self);
        if (result < 0)
            return result;
    }
    data->time_ns[data->record_count] = time_ns;
    memcpy(data->value + data->record_count * data->channel_count, record->value,
           data->channel_count * sizeof *data->value);
    data->record_count += 1;
    return MRT_OK;
}

static mrt_result read_record(reader *self, log_text line)
{
    log_record record;
    mrt_result result =
        self->kind == KIND_TABLE
            ? log_table_record(&self->table, self->data, line, &record, self->reason)
            : log_recording_record(line, &record, self->reason);
    return result < 0 ? result : append(self, &record);
}

static void count_damage(reader *self)
{
    log_data *data = self->data;
    if (data->damaged_count++ > 0)
        return;
    data->first_damaged_line = self->line_number;
    memcpy(data->first_damage, self->reason, LOG_REASON);
}

/* ---- lines ---- */

/* The first line that says anything decides what the file is. */
static mrt_result begin(reader *self, log_text line, uint32_t hand)
{
    if (log_text_starts_number(line)) {
        if (memchr(line.at, ',', (size_t)(line.end - line.at)))
            return log_refuse(self->reason,
                              "line %zu: expected a header row that names the "
                              "columns, such as time_s,right.index.mpj",
                              self->line_number);
        self->kind = KIND_RECORDING;
        log_recording_channels(self->data, hand);
        return MRT_OK;
    }
    self->kind = KIND_TABLE;
    char why[LOG_REASON];
    mrt_result result = log_table_header(&self->table, self->data, line, why);
    if (result < 0)
        log_refuse(self->reason, "line %zu: %.150s", self->line_number, why);
    return result;
}

static mrt_result read_line(reader *self, log_text line, uint32_t hand)
{
    if (line.at == line.end || *line.at == '#')
        return MRT_OK;
    if (self->kind == KIND_NONE) {
        mrt_result result = begin(self, line, hand);
        if (result < 0 || self->kind == KIND_TABLE)
            return result;
    }
    if (self->kind == KIND_TABLE && self->table.may_have_units) {
        char why[LOG_REASON];
        self->table.may_have_units = false;
        mrt_result result = log_table_units(&self->table, self->data, line, why);
        if (result < 0)
            log_refuse(self->reason, "line %zu: %.150s", self->line_number, why);
        if (result != 0)
            return result;
    }
    mrt_result result = read_record(self, line);
    if (result == MRT_ERR_MEMORY)
        return result;
    if (result < 0)
        count_damage(self);
    return MRT_OK;
}

static mrt_result read_lines(reader *self, log_text text, uint32_t hand)
{
    log_text line;
    while (log_text_line(&text, &line)) {
        self->line_number += 1;
        mrt_result result = read_line(self, line, hand);
        if (result < 0)
            return result;
    }
    const log_data *data = self->data;
    if (self->kind == KIND_NONE)
        return log_refuse(self->reason, "it is empty");
    if (data->damaged_count > data->record_count)
        return log_refuse(self->reason, "%zu of %zu records are damaged, first line %zu: %.100s",
                          data->damaged_count, data->damaged_count + data->record_count,
                          data->first_damaged_line, data->first_damage);
    if (data->record_count == 0)
        return log_refuse(self->reason, "it has no records");
    return MRT_OK;
}

/* Text has no 0 bytes; a look at the beginning is enough to name what is foreign. */
static bool is_binary(const void *bytes, size_t size)
{
    return memchr(bytes, '\0', size < 4096 ? size : 4096) != NULL;
}

static log_text without_byte_order_mark(log_text text)
{
    if (text.end - text.at >= 3 && memcmp(text.at, "\xEF\xBB\xBF", 3) == 0)
        text.at += 3;
    return text;
}

mrt_result log_parse(log_data *out, const void *bytes, size_t size, uint32_t hand, char *out_reason)
{
    memset(out, 0, sizeof *out);
    out_reason[0] = '\0';
    if (size == 0)
        return log_refuse(out_reason, "it is empty");
    if (is_binary(bytes, size))
        return log_refuse(out_reason, "it is no text");
    const char *at = bytes;
    reader self = {.data = out};
    mrt_result result = read_lines(&self, without_byte_order_mark((log_text){at, at + size}), hand);
    if (result < 0) {
        memcpy(out_reason, self.reason, LOG_REASON);
        log_data_finish(out);
    }
    return result < 0 ? result : MRT_OK;
}

/* ---- the other hand ---- */

static void swap_side(log_data *data, uint32_t i)
{
    mrt_channel *channel = &data->channel[i];
    if (channel->hand > MRT_RIGHT)
        return;
    bool was_left = channel->hand == MRT_LEFT;
    char *name = data->name[i], *sensor = strchr(name, '.');
    channel->hand = was_left ? MRT_RIGHT : MRT_LEFT;
    memmove(name + (was_left ? 5 : 4), sensor, strlen(sensor) + 1);
    memcpy(name, was_left ? "right" : "left", was_left ? 5 : 4);
}

/* A point's x changes its sign; a turn's axis is mirrored and its sense turns round, which leaves
 * qx and qw and changes qy and qz. */
static bool changes_sign(uint32_t semantic)
{
    return semantic == MRT_CH_WRIST || semantic == MRT_CH_WRIST + 4 || semantic == MRT_CH_WRIST + 5;
}

void log_mirror(log_data *data)
{
    for (uint32_t i = 0; i < data->channel_count; ++i) {
        swap_side(data, i);
        for (size_t k = 0; k < data->record_count && changes_sign(data->channel[i].semantic); ++k) {
            float *value = &data->value[k * data->channel_count + i];
            *value = -*value;
        }
    }
}

void log_data_finish(log_data *data)
{
    if (!data)
        return;
    free(data->time_ns);
    free(data->value);
    memset(data, 0, sizeof *data);
}
