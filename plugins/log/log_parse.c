#include "log_parse.h"
#include "device_io.h"

#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- texts ---- */

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

static log_text trimmed(log_text text)
{
    while (text.at < text.end && is_blank(*text.at))
        text.at += 1;
    while (text.end > text.at && is_blank(text.end[-1]))
        text.end -= 1;
    return text;
}

/* Removes the text before the next `separator` from `rest` and returns it. */
static log_text taken(log_text *rest, char separator)
{
    const char *stop = memchr(rest->at, separator, (size_t)(rest->end - rest->at));
    log_text piece = {rest->at, stop ? stop : rest->end};
    rest->at = stop ? stop + 1 : NULL;
    return trimmed(piece);
}

/* Removes the next line from `rest`, trimmed of blanks and of its \r\n or \n. Returns false
 * at the end. */
static bool next_line(log_text *rest, log_text *out_line)
{
    if (!rest->at || rest->at == rest->end)
        return false;
    *out_line = taken(rest, '\n');
    return true;
}

/* Removes the next comma-separated field from `rest`, trimmed of blanks. Returns false at the end.
 * "a,,b" gives "a", "", "b". */
static bool next_field(log_text *rest, log_text *out_field)
{
    if (!rest->at)
        return false;
    *out_field = taken(rest, ',');
    return true;
}

/* Removes the next word of non-blank bytes from `rest`. Returns false if only blanks remain. */
static bool next_word(log_text *rest, log_text *out_word)
{
    while (rest->at < rest->end && is_blank(*rest->at))
        rest->at += 1;
    if (rest->at == rest->end)
        return false;
    out_word->at = rest->at;
    while (rest->at < rest->end && !is_blank(*rest->at))
        rest->at += 1;
    out_word->end = rest->at;
    return true;
}

/* Returns true for a digit, sign or point. */
static bool starts_number(log_text text)
{
    return text.at < text.end && (is_digit(*text.at) || strchr("+-.", *text.at));
}

static bool text_is(log_text text, const char *word)
{
    size_t length = strlen(word);
    return (size_t)(text.end - text.at) == length && memcmp(text.at, word, length) == 0;
}

/* Copies into a 0-ended buffer, truncated to fit. Unprintable bytes become '?'. */
static void text_copy(char *out, size_t capacity, log_text text)
{
    size_t length = (size_t)(text.end - text.at);
    if (length > capacity - 1)
        length = capacity - 1;
    for (size_t i = 0; i < length; ++i)
        out[i] = text.at[i] >= 32 && text.at[i] < 127 ? text.at[i] : '?';
    out[length] = '\0';
}

/* ---- numbers ---- */

static const double NUMBER_MAX = 1e30;

bool log_text_number(log_text text, double *out)
{
    char copy[LOG_NUMBER];
    char *end;
    size_t length = (size_t)(text.end - text.at);
    if (length == 0 || length >= sizeof copy)
        return false;
    memcpy(copy, text.at, length);
    copy[length] = '\0';
    if (strspn(copy, "+-.0123456789eE") != length) /* strtod accepts hexadecimal, nan, inf */
        return false;
    *out = strtod(copy, &end);
    return *end == '\0' && *out > -NUMBER_MAX && *out < NUMBER_MAX;
}

#define LOG_INTEGER_MAX INT64_C(4000000000000000000)
/* Limited to +-LOG_INTEGER_MAX, so that the difference of any two fits an int64_t. */
static bool read_integer(log_text text, int64_t *out)
{
    bool negative = text.at < text.end && *text.at == '-';
    if (text.at < text.end && (*text.at == '-' || *text.at == '+'))
        text.at += 1;
    int64_t value = 0;
    const char *first = text.at;
    for (; text.at < text.end && is_digit(*text.at); text.at += 1) {
        int64_t digit = *text.at - '0';
        if (value > (LOG_INTEGER_MAX - digit) / 10)
            return false;
        value = value * 10 + digit;
    }
    *out = negative ? -value : value;
    return text.at == text.end && text.at > first;
}

/* ---- common to both formats: the current record, rejection of a line, channels ---- */

typedef struct log_record {
    int64_t time_ns; /* of the file's own clock */
    float value[MRT_MAX_CHANNELS];
} log_record;

/* An angle of more than one turn is not a joint's angle. */
#define LOG_ANGLE_MAX 6.2831853071795865

/* Writes the reason and returns MRT_ERR_FORMAT. */
__attribute__((format(printf, 2, 3))) static mrt_result log_refuse(char *out_reason,
                                                                   const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(out_reason, LOG_REASON, format, arguments);
    va_end(arguments);
    return MRT_ERR_FORMAT;
}

/* Returns the maximum of a channel's values, for gauges. */
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

/* Adds a channel; `name` and `unit` are copied. */
static void log_add_channel(log_data *data, const char *name, const char *unit, uint32_t semantic,
                            uint32_t hand)
{
    uint32_t i = data->channel_count++;
    snprintf(data->name[i], LOG_NAME, "%s", name);
    snprintf(data->unit[i], LOG_NAME, "%s", unit);
    float max = channel_max(semantic, data->unit[i]);
    data->channel[i] = (mrt_channel){data->name[i],
                                     data->unit[i],
                                     semantic,
                                     hand,
                                     is_never_negative(semantic, data->unit[i]) ? 0.0f : -max,
                                     max};
}

/* ---- recordings of GraspDB14 ---- */

enum { WORDS = 30, WORD_SECOND = 5, WORD_FIRST_ANGLE = 7, ANGLES = 23 };

/* angle = sign * (a[plus] - a[minus]) + zero, with a counted from 1 as in the recordings; minus 0:
 * nothing is subtracted. The recordings contain the deviation of each finger (positive to the
 * little finger's side). The glove measured the three differences between neighbours, which marotte
 * uses. */
static const struct source {
    int plus, minus;
    double sign, zero_rad;
} sources[MRT_ANGLES] = {
    {1, 0, -1, 0},     {2, 0, -1, 0},     {3, 0, -1, 0},    {4, 0, 1, 0.55},  /* thumb */
    {5, 0, -1, 0},     {6, 0, -1, 0},     {7, 0, -1, 0},                      /* index */
    {9, 0, -1, 0},     {10, 0, -1, 0},    {11, 0, -1, 0},   {8, 12, -1, 0.2}, /* middle */
    {13, 0, -1, 0},    {14, 0, -1, 0},    {15, 0, -1, 0},   {16, 12, 1, 0.1}, /* ring */
    {17, 0, -1, 0},    {18, 0, -1, 0},    {19, 0, -1, 0},   {20, 16, 1, 0.1}, /* little */
    {21, 0, -1, -0.3}, {22, 0, -1, -0.2}, {23, 0, 1, -0.1},                   /* palm, wrist */
};

static void log_recording_channels(log_data *data, uint32_t hand)
{
    data->is_hand_assumed = true;
    for (uint32_t i = 0; i < MRT_ANGLES; ++i) {
        char name[LOG_NAME];
        snprintf(name, sizeof name, "%s.%s", hand == MRT_LEFT ? "left" : "right",
                 device_sensor_name[i]);
        log_add_channel(data, name, "rad", MRT_CH_ANGLE + i, hand);
    }
}

/* Days since 1970-01-01 in the Gregorian calendar. Years begin in March here, so that leap days are
 * last. */
static int64_t days_of(int64_t year, int64_t month, int64_t day)
{
    int64_t y = month <= 2 ? year - 1 : year;
    int64_t month_from_march = month <= 2 ? month + 9 : month - 3;
    int64_t day_of_year = (153 * month_from_march + 2) / 5 + day - 1;
    return 365 * y + y / 4 - y / 100 + y / 400 + day_of_year - 719468;
}

static bool is_within(double value, double low, double high)
{
    return value >= low && value <= high && value == (double)(int64_t)value;
}

/* Converts year month day hour minute second to ns since 1970, so that midnight is not a jump. */
static bool time_of(const double *word, int64_t *out_ns)
{
    double second = word[WORD_SECOND];
    if (!is_within(word[0], 1900, 2200) || !is_within(word[1], 1, 12) ||
        !is_within(word[2], 1, 31) || !is_within(word[3], 0, 23) || !is_within(word[4], 0, 59) ||
        !(second >= 0.0 && second < 61.0))
        return false;
    int64_t days = days_of((int64_t)word[0], (int64_t)word[1], (int64_t)word[2]);
    int64_t minutes = (days * 24 + (int64_t)word[3]) * 60 + (int64_t)word[4];
    *out_ns = minutes * 60 * INT64_C(1000000000) + (int64_t)(second * 1e9 + 0.5);
    return true;
}

static mrt_result read_words(log_text line, double *out, char *out_reason)
{
    log_text word;
    int count = 0;
    while (next_word(&line, &word)) {
        if (count < WORDS && !log_text_number(word, &out[count])) {
            char text[LOG_NAME];
            text_copy(text, sizeof text, word);
            return log_refuse(out_reason, "word %d is not a number: \"%s\"", count + 1, text);
        }
        count += 1;
    }
    if (count != WORDS)
        return log_refuse(out_reason, "expected 30 numbers (date, time, switch, 23 angles), not %d",
                          count);
    return MRT_OK;
}

static mrt_result log_recording_record(log_text line, log_record *out, char *out_reason)
{
    double word[WORDS] = {0};
    mrt_result result = read_words(line, word, out_reason);
    if (result < 0)
        return result;
    if (!time_of(word, &out->time_ns))
        return log_refuse(out_reason, "its date or time is invalid");
    const double *angle = word + WORD_FIRST_ANGLE;
    for (int i = 0; i < ANGLES; ++i)
        if (!(angle[i] >= -LOG_ANGLE_MAX && angle[i] <= LOG_ANGLE_MAX))
            return log_refuse(out_reason, "angle %d is more than a turn", i + 1);
    for (int i = 0; i < MRT_ANGLES; ++i) {
        const struct source *s = &sources[i];
        double base = s->minus > 0 ? angle[s->minus - 1] : 0.0;
        out->value[i] = (float)(s->sign * (angle[s->plus - 1] - base) + s->zero_rad);
    }
    return MRT_OK;
}

/* ---- marotte's log tables ---- */

static const char *const wrist_name[7] = {"wrist.x",  "wrist.y",  "wrist.z", "wrist.qx",
                                          "wrist.qy", "wrist.qz", "wrist.qw"};
static const char *const pedal_name[MRT_MAX_PEDALS] = {"pedal.1", "pedal.2", "pedal.3", "pedal.4"};

static const double RADIANS_PER_DEGREE = 0.017453292519943295;
static const double OTHER_MAX = 1e6, COUNT_MAX = 65535;
static const double TIME_MAX_S = 1e8;

typedef struct log_table {
    bool time_in_ns;
    double scale[MRT_MAX_CHANNELS]; /* factor from the file's unit to the channel's */
    double limit[MRT_MAX_CHANNELS]; /* largest magnitude, in the channel's unit */
    bool may_have_units;            /* no record was read yet */
} log_table;

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
    if (strncmp(name, "button.", 7) == 0)
        return (meaning){MRT_CH_BUTTON, MRT_NO_HAND, "1"};
    uint32_t hand;
    if (strncmp(name, "right.", 6) == 0)
        hand = MRT_RIGHT;
    else if (strncmp(name, "left.", 5) == 0)
        hand = MRT_LEFT;
    else
        return (meaning){MRT_CH_OTHER, MRT_NO_HAND, ""};
    const char *sensor = strchr(name, '.') + 1;
    for (uint32_t i = 0; i < MRT_ANGLES; ++i)
        if (strcmp(sensor, device_sensor_name[i]) == 0)
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
    text_copy(name, sizeof name, field);
    if (i == MRT_MAX_CHANNELS)
        return log_refuse(
            out_reason,
            "more than %d columns besides the time, starting with \"%s\": split the file",
            MRT_MAX_CHANNELS, name);
    if (name[0] == '\0' || strlen(name) != (size_t)(field.end - field.at))
        return log_refuse(out_reason, "the name of column %u is empty or longer than %d letters",
                          i + 2u, LOG_NAME - 1);
    for (uint32_t k = 0; k < i; ++k)
        if (strcmp(data->name[k], name) == 0)
            return log_refuse(out_reason, "two columns have the name \"%s\"", name);
    meaning m = meaning_of(name);
    table->scale[i] = 1.0;
    table->limit[i] = is_angle(m.semantic) ? LOG_ANGLE_MAX : OTHER_MAX;
    log_add_channel(data, name, m.unit, m.semantic, m.hand);
    return MRT_OK;
}

static mrt_result log_table_header(log_table *table, log_data *data, log_text line,
                                   char *out_reason)
{
    log_text field;
    *table = (log_table){.may_have_units = true};
    next_field(&line, &field);
    table->time_in_ns = text_is(field, "time_ns");
    if (!table->time_in_ns && !text_is(field, "time_s")) {
        char text[LOG_NAME];
        text_copy(text, sizeof text, field);
        return log_refuse(out_reason,
                          "expected a log: a header row whose first column is time_s or time_ns, "
                          "not \"%s\"",
                          text);
    }
    while (next_field(&line, &field)) {
        mrt_result result = add_column(table, data, field, out_reason);
        if (result < 0)
            return result;
    }
    if (data->channel_count == 0)
        return log_refuse(out_reason, "the header has no column besides the time");
    return MRT_OK;
}

/* ---- units ---- */

static mrt_result set_angle_unit(log_table *table, log_data *data, uint32_t i, log_text unit,
                                 char *out_reason)
{
    if (text_is(unit, "rad"))
        return MRT_OK;
    if (text_is(unit, "deg")) {
        table->scale[i] = RADIANS_PER_DEGREE;
        return MRT_OK;
    }
    if (text_is(unit, MRT_UNIT_LANDMARKS)) {
        strcpy(data->unit[i], MRT_UNIT_LANDMARKS);
        return MRT_OK;
    }
    if (!text_is(unit, "count"))
        return log_refuse(out_reason,
                          "the unit of \"%s\" is not rad, deg, count or " MRT_UNIT_LANDMARKS,
                          data->name[i]);
    table->limit[i] = COUNT_MAX;
    strcpy(data->unit[i], "count");
    data->channel[i].min = 0.0f;
    data->channel[i].max = 255.0f;
    return MRT_OK;
}

/* "0..1" is the range of a channel's values. */
static bool set_range(mrt_channel *channel, log_text unit)
{
    log_text low = unit, high = unit;
    for (low.end = low.at; low.end + 2 < unit.end; ++low.end) {
        double min, max;
        if (low.end[0] != '.' || low.end[1] != '.')
            continue;
        high.at = low.end + 2;
        if (!log_text_number(low, &min) || !log_text_number(high, &max) || !(min < max) ||
            min < -OTHER_MAX || max > OTHER_MAX)
            return false;
        channel->min = (float)min;
        channel->max = (float)max;
        return true;
    }
    return false;
}

static mrt_result set_unit(log_table *table, log_data *data, uint32_t i, log_text unit,
                           char *out_reason)
{
    if (is_angle(data->channel[i].semantic))
        return set_angle_unit(table, data, i, unit, out_reason);
    if (data->channel[i].semantic == MRT_CH_OTHER && set_range(&data->channel[i], unit))
        return MRT_OK;
    if (data->channel[i].semantic == MRT_CH_OTHER) {
        text_copy(data->unit[i], LOG_NAME, unit);
        return MRT_OK;
    }
    if (unit.at == unit.end || text_is(unit, data->unit[i]))
        return MRT_OK;
    return log_refuse(out_reason, "the unit of \"%s\" is %s", data->name[i], data->unit[i]);
}

/* One calibration applies to all sensors of a hand, so they must have one unit. */
static mrt_result check_hands(const log_data *data, char *out_reason)
{
    for (uint32_t hand = MRT_LEFT; hand <= MRT_RIGHT; ++hand) {
        const char *unit = NULL;
        for (uint32_t i = 0; i < data->channel_count; ++i) {
            if (data->channel[i].hand != hand || !is_angle(data->channel[i].semantic))
                continue;
            if (unit && strcmp(unit, data->unit[i]) != 0)
                return log_refuse(out_reason, "the sensors of one hand use two units: %s and %s",
                                  unit, data->unit[i]);
            unit = data->unit[i];
        }
    }
    return MRT_OK;
}

/* Parses the unit row. Returns 0 if the line is a record, > 0 if it was a unit row, < 0 on an
 * error. */
static mrt_result log_table_units(log_table *table, log_data *data, log_text line, char *out_reason)
{
    log_text unit;
    next_field(&line, &unit);
    if (!text_is(unit, "unit"))
        return MRT_OK;
    uint32_t count = 0;
    while (next_field(&line, &unit)) {
        if (count == data->channel_count)
            return log_refuse(out_reason, "more units than columns");
        mrt_result result = set_unit(table, data, count++, unit, out_reason);
        if (result < 0)
            return result;
    }
    if (count != data->channel_count)
        return log_refuse(out_reason, "%u units for %u columns", count, data->channel_count);
    mrt_result result = check_hands(data, out_reason);
    return result < 0 ? result : 1;
}

/* ---- records ---- */

static mrt_result read_time(const log_table *table, log_text field, int64_t *out_ns,
                            char *out_reason)
{
    double seconds;
    if (table->time_in_ns) {
        if (read_integer(field, out_ns))
            return MRT_OK;
        return log_refuse(out_reason, "its time_ns is not a whole number within +-4e18");
    }
    if (!log_text_number(field, &seconds) || !(seconds >= -TIME_MAX_S && seconds <= TIME_MAX_S))
        return log_refuse(out_reason, "its time_s is not a number within +-1e8");
    double ns = seconds * 1e9;
    *out_ns = (int64_t)(ns < 0.0 ? ns - 0.5 : ns + 0.5);
    return MRT_OK;
}

static mrt_result read_value(const log_table *table, const log_data *data, uint32_t i,
                             log_text field, float *out, char *out_reason)
{
    double value;
    if (!log_text_number(field, &value))
        return log_refuse(out_reason, "its \"%s\" is not a number", data->name[i]);
    value *= table->scale[i];
    if (!(value >= -table->limit[i] && value <= table->limit[i]))
        return log_refuse(out_reason, "its \"%s\" is out of range", data->name[i]);
    *out = (float)value;
    return MRT_OK;
}

static mrt_result log_table_record(log_table *table, const log_data *data, log_text line,
                                   log_record *out, char *out_reason)
{
    log_text field;
    next_field(&line, &field);
    mrt_result result = read_time(table, field, &out->time_ns, out_reason);
    uint32_t count = 0;
    while (result >= 0 && next_field(&line, &field)) {
        if (count < data->channel_count)
            result = read_value(table, data, count, field, &out->value[count], out_reason);
        count += 1;
    }
    if (result >= 0 && count != data->channel_count)
        return log_refuse(out_reason, "it has %u values for %u columns", count,
                          data->channel_count);
    return result;
}

/* ---- a log ---- */

/* Eleven days: longer than any performance, and sums of such times do not overflow. */
static const int64_t LENGTH_MAX_NS = INT64_C(1000000) * 1000000000;

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
        log_refuse(self->reason, "out of memory for %zu records", capacity);
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
        return log_refuse(self->reason, "its time is before that of the previous record");
    if (time_ns > LENGTH_MAX_NS)
        return log_refuse(self->reason, "its time is more than eleven days after the first");
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

/* Detects the format from the first line that is not a comment. */
static mrt_result begin(reader *self, log_text line, uint32_t hand)
{
    if (starts_number(line)) {
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
    while (next_line(&text, &line)) {
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

/* Text has no 0 bytes; checking the beginning is enough to reject other files. */
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
        return log_refuse(out_reason, "it is not text");
    const char *at = bytes;
    reader self = {.data = out};
    mrt_result result = read_lines(&self, without_byte_order_mark((log_text){at, at + size}), hand);
    if (result < 0) {
        memcpy(out_reason, self.reason, LOG_REASON);
        log_data_finish(out);
    }
    return result < 0 ? result : MRT_OK;
}

/* ---- mirroring ---- */

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

/* Mirroring negates the x of a position. A rotation has its axis mirrored and its direction
 * reversed, which keeps qx and qw and negates qy and qz. */
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

/* ---- reading a file ---- */

static const size_t SIZE_MAX_BYTES = (size_t)LOG_FILE_MAX_MIB << 20;

static mrt_result refuse(char *out_reason, mrt_result code, const char *reason)
{
    snprintf(out_reason, LOG_REASON, "%s", reason);
    return code;
}

/* The size is only a hint: the file may shrink or grow while it is read. */
static mrt_result read_all(log_file *out, int descriptor, size_t size, char *out_reason)
{
    out->data = malloc(size + 1);
    if (!out->data)
        return refuse(out_reason, MRT_ERR_MEMORY, "out of memory");
    while (out->size < size) {
        ssize_t count = read(descriptor, out->data + out->size, size - out->size);
        if (count < 0 && errno == EINTR)
            continue;
        if (count < 0)
            return refuse(out_reason, MRT_ERR_IO, strerror(errno));
        if (count == 0)
            break;
        out->size += (size_t)count;
    }
    return MRT_OK;
}

static mrt_result read_regular(log_file *out, int descriptor, char *out_reason)
{
    struct stat status;
    if (fstat(descriptor, &status) < 0)
        return refuse(out_reason, MRT_ERR_IO, strerror(errno));
    if (S_ISDIR(status.st_mode))
        return refuse(out_reason, MRT_ERR_IO, "it is a directory; a recording is a file");
    if (!S_ISREG(status.st_mode))
        return refuse(out_reason, MRT_ERR_IO, "it is a device or a pipe; a recording is a file");
    if (status.st_size < 0 || (uint64_t)status.st_size > SIZE_MAX_BYTES) {
        snprintf(out_reason, LOG_REASON, "it is larger than %d MiB: split it", LOG_FILE_MAX_MIB);
        return MRT_ERR_UNSUPPORTED;
    }
    return read_all(out, descriptor, (size_t)status.st_size, out_reason);
}

mrt_result log_file_read(log_file *out, const char *path, char *out_reason)
{
    *out = (log_file){NULL, 0};
    int descriptor = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (descriptor < 0)
        return refuse(out_reason, MRT_ERR_IO, strerror(errno));
    mrt_result result = read_regular(out, descriptor, out_reason);
    close(descriptor);
    if (result < 0) {
        free(out->data);
        *out = (log_file){NULL, 0};
    }
    return result;
}
