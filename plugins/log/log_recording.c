/* The recordings of GraspDB14: 30 words a line, "year month day hour minute second switch a1..a23".
 * Signs and zeros are turned into ours; plugins/log/README.md gives the table and its reasons. */
#include "log_format.h"

#include <stdio.h>

enum { WORDS = 30, WORD_SECOND = 5, WORD_FIRST_ANGLE = 7, ANGLES = 23 };

/* angle = sign * (a[plus] - a[minus]) + zero, with a counted from 1 as the recordings do; minus 0:
 * nothing is taken off. The recordings give each finger's own deviation (positive to the little
 * finger's side); the glove measured the three differences between neighbours, which are ours. */
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

void log_recording_channels(log_data *data, uint32_t hand)
{
    data->is_hand_assumed = true;
    for (uint32_t i = 0; i < MRT_ANGLES; ++i) {
        char name[LOG_NAME];
        snprintf(name, sizeof name, "%s.%s", hand == MRT_LEFT ? "left" : "right",
                 log_sensor_name[i]);
        log_add_channel(data, name, "rad", MRT_CH_ANGLE + i, hand);
    }
}

/* Days since 1970-01-01 in the Gregorian calendar, whose years here begin in March: leap days then
 * come last. */
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

/* year month day hour minute second, to ns since 1970: a midnight between two records is no jump */
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
    while (log_text_word(&line, &word)) {
        if (count < WORDS && !log_text_number(word, &out[count])) {
            char text[LOG_NAME];
            log_text_copy(text, sizeof text, word);
            return log_refuse(out_reason, "word %d is no number: \"%s\"", count + 1, text);
        }
        count += 1;
    }
    if (count != WORDS)
        return log_refuse(out_reason, "expected 30 numbers (date, time, switch, 23 angles), not %d",
                          count);
    return MRT_OK;
}

mrt_result log_recording_record(log_text line, log_record *out, char *out_reason)
{
    double word[WORDS] = {0};
    mrt_result result = read_words(line, word, out_reason);
    if (result < 0)
        return result;
    if (!time_of(word, &out->time_ns))
        return log_refuse(out_reason, "its date and time make no sense");
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
