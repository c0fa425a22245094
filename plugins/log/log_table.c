/* The log table: a header row that names the columns, a row of units if need be, then records.
 * plugins/log/README.md describes it. */
#include "log_format.h"

#include <string.h>

static const char *const wrist_name[7] = {"wrist.x",  "wrist.y",  "wrist.z", "wrist.qx",
                                          "wrist.qy", "wrist.qz", "wrist.qw"};
static const char *const pedal_name[MRT_MAX_PEDALS] = {"pedal.1", "pedal.2", "pedal.3", "pedal.4"};

static const double RADIANS_PER_DEGREE = 0.017453292519943295;
static const double OTHER_MAX = 1e6, COUNT_MAX = 65535;
static const double TIME_MAX_S = 1e8;

/* ---- the header ---- */

typedef struct meaning {
    uint32_t semantic, hand;
    const char *unit;
} meaning;

static bool is_angle(uint32_t semantic)
{
    return semantic >= MRT_CH_ANGLE && semantic < MRT_CH_ANGLE + MRT_ANGLES;
}

static meaning meaning_of(const char *name)
{
    for (uint32_t i = 0; i < MRT_MAX_PEDALS; ++i)
        if (strcmp(name, pedal_name[i]) == 0)
            return (meaning){MRT_CH_PEDAL + i, MRT_NO_HAND, "1"};
    uint32_t hand;
    if (strncmp(name, "right.", 6) == 0)
        hand = MRT_RIGHT;
    else if (strncmp(name, "left.", 5) == 0)
        hand = MRT_LEFT;
    else
        return (meaning){MRT_CH_OTHER, MRT_NO_HAND, ""};
    const char *sensor = strchr(name, '.') + 1;
    for (uint32_t i = 0; i < MRT_ANGLES; ++i)
        if (strcmp(sensor, log_sensor_name[i]) == 0)
            return (meaning){MRT_CH_ANGLE + i, hand, "rad"};
    for (uint32_t i = 0; i < 7; ++i)
        if (strcmp(sensor, wrist_name[i]) == 0)
            return (meaning){MRT_CH_WRIST + i, hand, i < 3 ? "mm" : "1"};
    return (meaning){MRT_CH_OTHER, hand, ""};
}

static mrt_result add_column(log_table *table, log_data *data, log_text field, char *out_reason)
{
    uint32_t i = data->channel_count;
    char name[LOG_NAME];
    log_text_copy(name, sizeof name, field);
    if (i == MRT_MAX_CHANNELS)
        return log_refuse(out_reason,
                          "more than %d columns beside the time, from \"%s\" on: split the file",
                          MRT_MAX_CHANNELS, name);
    if (name[0] == '\0' || strlen(name) != (size_t)(field.end - field.at))
        return log_refuse(out_reason, "the name of column %u has no or more than %d letters",
                          i + 2u, LOG_NAME - 1);
    for (uint32_t k = 0; k < i; ++k)
        if (strcmp(data->name[k], name) == 0)
            return log_refuse(out_reason, "two columns are called \"%s\"", name);
    meaning m = meaning_of(name);
    table->scale[i] = 1.0;
    table->limit[i] = is_angle(m.semantic) ? LOG_ANGLE_MAX : OTHER_MAX;
    log_add_channel(data, name, m.unit, m.semantic, m.hand);
    return MRT_OK;
}

mrt_result log_table_header(log_table *table, log_data *data, log_text line, char *out_reason)
{
    log_text field;
    *table = (log_table){.may_have_units = true};
    log_text_field(&line, &field);
    table->time_in_ns = log_text_is(field, "time_ns");
    if (!table->time_in_ns && !log_text_is(field, "time_s")) {
        char text[LOG_NAME];
        log_text_copy(text, sizeof text, field);
        return log_refuse(out_reason,
                          "expected a log: a header row whose first column is time_s or time_ns, "
                          "not \"%s\"",
                          text);
    }
    while (log_text_field(&line, &field)) {
        mrt_result result = add_column(table, data, field, out_reason);
        if (result < 0)
            return result;
    }
    if (data->channel_count == 0)
        return log_refuse(out_reason, "the header names no column beside the time");
    return MRT_OK;
}

/* ---- units ---- */

static mrt_result set_angle_unit(log_table *table, log_data *data, uint32_t i, log_text unit,
                                 char *out_reason)
{
    if (log_text_is(unit, "rad"))
        return MRT_OK;
    if (log_text_is(unit, "deg")) {
        table->scale[i] = RADIANS_PER_DEGREE;
        return MRT_OK;
    }
    if (!log_text_is(unit, "count"))
        return log_refuse(out_reason, "the unit of \"%s\" is not rad, deg or count", data->name[i]);
    table->limit[i] = COUNT_MAX;
    strcpy(data->unit[i], "count");
    data->channel[i].min = 0.0f;
    data->channel[i].max = 255.0f;
    return MRT_OK;
}

static mrt_result set_unit(log_table *table, log_data *data, uint32_t i, log_text unit,
                           char *out_reason)
{
    if (is_angle(data->channel[i].semantic))
        return set_angle_unit(table, data, i, unit, out_reason);
    if (data->channel[i].semantic == MRT_CH_OTHER) {
        log_text_copy(data->unit[i], LOG_NAME, unit);
        return MRT_OK;
    }
    if (unit.at == unit.end || log_text_is(unit, data->unit[i]))
        return MRT_OK;
    return log_refuse(out_reason, "the unit of \"%s\" is %s", data->name[i], data->unit[i]);
}

/* One calibration serves all sensors of a hand, so they come in one unit. */
static mrt_result check_hands(const log_data *data, char *out_reason)
{
    for (uint32_t hand = MRT_LEFT; hand <= MRT_RIGHT; ++hand) {
        const char *unit = NULL;
        for (uint32_t i = 0; i < data->channel_count; ++i) {
            if (data->channel[i].hand != hand || !is_angle(data->channel[i].semantic))
                continue;
            if (unit && strcmp(unit, data->unit[i]) != 0)
                return log_refuse(out_reason,
                                  "the sensors of one hand are partly in counts, partly in angles");
            unit = data->unit[i];
        }
    }
    return MRT_OK;
}

mrt_result log_table_units(log_table *table, log_data *data, log_text line, char *out_reason)
{
    log_text unit;
    log_text_field(&line, &unit);
    if (!log_text_is(unit, "unit"))
        return MRT_OK;
    uint32_t count = 0;
    while (log_text_field(&line, &unit)) {
        if (count == data->channel_count)
            return log_refuse(out_reason, "there are more units than columns");
        mrt_result result = set_unit(table, data, count++, unit, out_reason);
        if (result < 0)
            return result;
    }
    if (count != data->channel_count)
        return log_refuse(out_reason, "there are %u units for %u columns", count,
                          data->channel_count);
    mrt_result result = check_hands(data, out_reason);
    return result < 0 ? result : 1;
}

/* ---- records ---- */

static mrt_result read_time(const log_table *table, log_text field, int64_t *out_ns,
                            char *out_reason)
{
    double seconds;
    if (table->time_in_ns) {
        if (log_text_integer(field, out_ns))
            return MRT_OK;
        return log_refuse(out_reason, "its time_ns is no whole number within +-4e18");
    }
    if (!log_text_number(field, &seconds) || !(seconds >= -TIME_MAX_S && seconds <= TIME_MAX_S))
        return log_refuse(out_reason, "its time_s is no number within +-1e8");
    double ns = seconds * 1e9;
    *out_ns = (int64_t)(ns < 0.0 ? ns - 0.5 : ns + 0.5);
    return MRT_OK;
}

static mrt_result read_value(const log_table *table, const log_data *data, uint32_t i,
                             log_text field, float *out, char *out_reason)
{
    double value;
    if (!log_text_number(field, &value))
        return log_refuse(out_reason, "its \"%s\" is no number", data->name[i]);
    value *= table->scale[i];
    if (!(value >= -table->limit[i] && value <= table->limit[i]))
        return log_refuse(out_reason, "its \"%s\" is out of range", data->name[i]);
    *out = (float)value;
    return MRT_OK;
}

mrt_result log_table_record(log_table *table, const log_data *data, log_text line, log_record *out,
                            char *out_reason)
{
    log_text field;
    log_text_field(&line, &field);
    mrt_result result = read_time(table, field, &out->time_ns, out_reason);
    uint32_t count = 0;
    while (result >= 0 && log_text_field(&line, &field)) {
        if (count < data->channel_count)
            result = read_value(table, data, count, field, &out->value[count], out_reason);
        count += 1;
    }
    if (result >= 0 && count != data->channel_count)
        return log_refuse(out_reason, "it has %u values for %u columns", count,
                          data->channel_count);
    return result;
}
