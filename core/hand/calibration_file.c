#include "hand/calibration_file.h"

#include "base/angle.h"
#include "base/file.h"
#include "base/text.h"
#include "hand/calibration_json.h"
#include "hand/sensor.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

const char *const calibration_source_name[CALIBRATION_SOURCES] = {"shipped", "zeroed", "measured",
                                                                  "imported"};
static const char *const side_name[2] = {"left", "right"};
static const double raw_cap = 1e6, cross_talk_cap = 1e3;

void calibration_file_init(calibration_file *out, uint32_t side)
{
    memset(out, 0, sizeof *out);
    out->side = side;
}

void calibration_file_finish(calibration_file *file)
{
    if (!file)
        return;
    json_decref(file->document);
    file->document = NULL;
}

void calibration_file_note(calibration_file *file, const char *format, ...)
{
    char line[512];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    size_t used = strlen(file->note), added = strlen(line);
    if (used + added + 2 <= sizeof file->note)
        (void)snprintf(file->note + used, sizeof file->note - used, "%s%s", used ? "\n" : "", line);
}

/* ---- reading ---- */

static void note_unknown(calibration_file *file, const json_place *object, const char *const *known)
{
    json_t *value = (json_t *)(uintptr_t)object->value;
    for (void *at = json_object_iter(value); at; at = json_object_iter_next(value, at)) {
        const char *key = json_object_iter_key(at);
        const char *const *entry = known;
        while (*entry && strcmp(*entry, key) != 0)
            ++entry;
        if (*entry)
            continue;
        json_place member = json_place_member(object, key);
        calibration_file_note(file, "%s: a key that this version does not know; it is kept",
                              member.text);
    }
}

/* Not there: `out` stays. */
static mrt_result read_optional(double *out, bool *out_has, const json_place *of, const char *key,
                                double low, double high, error *err)
{
    json_place at = json_place_member(of, key);
    *out_has = at.value != NULL;
    return at.value ? json_place_number(out, &at, low, high, err) : MRT_OK;
}

static mrt_result read_points(hand_table *out, const json_place *at, error *err)
{
    size_t count = json_array_size(at->value);
    if (!json_is_array(at->value) || count < 2 || count > HAND_TABLE_MAX)
        return json_place_unexpected(err, at, "an array of 2 to 16 points [raw, rad]");
    for (size_t i = 0; i < count; ++i) {
        json_place item = json_place_item(at, i);
        double point[2];
        mrt_result result = json_place_pair(point, &item, -raw_cap, raw_cap, err);
        if (result < 0)
            return result;
        json_place rad = json_place_item(&item, 1);
        result = json_place_number(&point[1], &rad, -ANGLE_PI, ANGLE_PI, err);
        if (result < 0)
            return result;
        out->raw[i] = (float)point[0];
        out->rad[i] = (float)point[1];
        if (i > 0 && !(out->raw[i] > out->raw[i - 1]))
            return error_set(err, MRT_ERR_FORMAT,
                             "%s: expected a raw value above the one before it, %.9g, found %.9g",
                             item.text, (double)out->raw[i - 1], point[0]);
    }
    out->count = (uint32_t)count;
    return MRT_OK;
}

static mrt_result read_range(float out[2], bool *out_has, const json_place *of, const char *key,
                             double cap, error *err)
{
    double pair[2] = {0, 0};
    json_place at = json_place_member(of, key);
    *out_has = at.value != NULL;
    mrt_result result = at.value ? json_place_pair(pair, &at, -cap, cap, err) : MRT_OK;
    out[0] = (float)pair[0];
    out[1] = (float)pair[1];
    return result;
}

static mrt_result read_ranges(calibration_sensor *out, const json_place *at, error *err)
{
    bool has_raw = false, has_rad = false;
    mrt_result result = read_range(out->raw_range, &has_raw, at, "raw_range", raw_cap, err);
    if (result >= 0)
        result = read_range(out->rad_range, &has_rad, at, "rad_range", 2.0 * ANGLE_PI, err);
    if (result >= 0 && has_raw != has_rad) {
        json_place missing = json_place_member(at, has_raw ? "rad_range" : "raw_range");
        result = json_place_unexpected(err, &missing, "both raw_range and rad_range, or neither");
    }
    out->has_range = has_raw && has_rad;
    return result;
}

static mrt_result read_cross_talk(calibration_sensor *out, const json_place *of, error *err)
{
    json_place at = json_place_member(of, "cross_talk");
    if (!at.value)
        return MRT_OK;
    mrt_result result = json_place_object(&at, "an object {\"sensor\": rad per rad}", err);
    if (result < 0)
        return result;
    json_t *object = (json_t *)(uintptr_t)at.value;
    for (void *i = json_object_iter(object); i; i = json_object_iter_next(object, i)) {
        const char *key = json_object_iter_key(i);
        json_place member = json_place_member(&at, key);
        int sensor = sensor_find(key);
        if (sensor < 0)
            return error_set(err, MRT_ERR_FORMAT,
                             "%s: there is no sensor of that name, as in \"index.mpj\"",
                             member.text);
        double share = 0;
        result = json_place_number(&share, &member, -cross_talk_cap, cross_talk_cap, err);
        if (result < 0)
            return result;
        out->cross_talk[sensor] = (float)share;
    }
    return MRT_OK;
}

static mrt_result read_sensor(calibration_file *file, int sensor, const json_place *at, error *err)
{
    static const char *const known[] = {"source",    "points",       "neutral_rad", "raw_range",
                                        "rad_range", "residual_rad", "cross_talk",  NULL};
    calibration_sensor *out = &file->sensor[sensor];
    mrt_result result = json_place_object(at, "an object", err);
    if (result < 0)
        return result;
    json_place source = json_place_member(at, "source");
    json_place points = json_place_member(at, "points");
    uint32_t choice = 0;
    double neutral = (double)sensor_table[sensor].neutral_rad, residual = 0;
    bool has_neutral = false;
    result = json_place_choice(&choice, &source, calibration_source_name, CALIBRATION_SOURCES, err);
    if (result >= 0)
        result = read_points(&out->table, &points, err);
    if (result >= 0)
        result = read_optional(&neutral, &has_neutral, at, "neutral_rad", -ANGLE_PI, ANGLE_PI, err);
    if (result >= 0)
        result = read_ranges(out, at, err);
    if (result >= 0)
        result = read_optional(&residual, &out->has_residual, at, "residual_rad", 0, ANGLE_PI, err);
    if (result >= 0)
        result = read_cross_talk(out, at, err);
    if (result < 0)
        return result;
    out->source = (calibration_source)choice;
    out->neutral_rad = (float)neutral;
    out->residual_rad = (float)residual;
    note_unknown(file, at, known);
    return MRT_OK;
}

static mrt_result read_sensors(calibration_file *out, const json_place *root, error *err)
{
    json_place at = json_place_member(root, "sensors");
    mrt_result result = json_place_object(&at, "an object of sensors, {\"index.mpj\": ...}", err);
    if (result < 0)
        return result;
    json_t *object = (json_t *)(uintptr_t)at.value;
    for (void *i = json_object_iter(object); i; i = json_object_iter_next(object, i)) {
        const char *key = json_object_iter_key(i);
        json_place member = json_place_member(&at, key);
        int sensor = sensor_find(key);
        if (sensor < 0)
            return error_set(err, MRT_ERR_FORMAT,
                             "%s: there is no sensor of that name, as in \"index.mpj\"",
                             member.text);
        result = read_sensor(out, sensor, &member, err);
        if (result < 0)
            return result;
    }
    json_place count_at = json_place_member(root, "sensor_count");
    double count = 0;
    result = json_place_number(&count, &count_at, 1, MRT_ANGLES, err);
    if (result >= 0 && (uint32_t)count != calibration_file_sensor_count(out))
        result =
            error_set(err, MRT_ERR_FORMAT, "%s: expected %u, as many as $.sensors has, found %g",
                      count_at.text, calibration_file_sensor_count(out), count);
    return result;
}

static mrt_result read_root(calibration_file *out, const json_place *root, error *err)
{
    static const char *const known[] = {"marotte_calibration", "name",           "date",    "hand",
                                        "sensor_count",        "hand_length_mm", "sensors", NULL};
    mrt_result result = json_place_object(root, "an object, a calibration", err);
    if (result < 0)
        return result;
    json_place version_at = json_place_member(root, "marotte_calibration");
    json_place name_at = json_place_member(root, "name"), date_at = json_place_member(root, "date");
    json_place hand_at = json_place_member(root, "hand");
    if (!json_is_integer(version_at.value) || json_integer_value(version_at.value) != 1)
        return json_place_unexpected(err, &version_at, "1, the version of the file");
    if (name_at.value)
        result = json_place_text(out->name, sizeof out->name, &name_at, err);
    if (result >= 0 && date_at.value)
        result = json_place_text(out->date, sizeof out->date, &date_at, err);
    if (result >= 0)
        result = json_place_choice(&out->side, &hand_at, side_name, 2, err);
    bool has_length = false;
    if (result >= 0)
        result = read_optional(&out->hand_length_mm, &has_length, root, "hand_length_mm",
                               HAND_LENGTH_MIN_MM, HAND_LENGTH_MAX_MM, err);
    if (result >= 0)
        result = read_sensors(out, root, err);
    if (result >= 0)
        note_unknown(out, root, known);
    return result;
}

mrt_result calibration_file_parse(calibration_file *out, const void *bytes, size_t size,
                                  const char *name, error *err)
{
    calibration_file_init(out, MRT_LEFT);
    json_error_t reason;
    json_t *value = json_loadb(bytes, size, JSON_REJECT_DUPLICATES, &reason);
    if (!value) {
        char said[JSON_ERROR_TEXT_LENGTH];
        text_copy(said, sizeof said, text_view_of(reason.text, strlen(reason.text)));
        return error_set(err, MRT_ERR_FORMAT, "%.120s: line %d, column %d: not JSON: %s", name,
                         reason.line, reason.column, said);
    }
    json_place root = json_place_root(value, name);
    out->document = value;
    mrt_result result = read_root(out, &root, err);
    if (result < 0) {
        calibration_file_finish(out);
        calibration_file_init(out, MRT_LEFT);
    }
    return result;
}

mrt_result calibration_file_read(calibration_file *out, const char *path, error *err)
{
    file_bytes bytes;
    calibration_file_init(out, MRT_LEFT);
    mrt_result result = file_read(&bytes, path, CALIBRATION_FILE_CAP, err);
    if (result < 0)
        return result;
    result = calibration_file_parse(out, bytes.data, bytes.size, path, err);
    file_bytes_finish(&bytes);
    return result;
}

/* ---- use ---- */

uint32_t calibration_file_sensor_count(const calibration_file *file)
{
    uint32_t count = 0;
    for (int i = 0; i < MRT_ANGLES; ++i)
        count += file->sensor[i].table.count > 0;
    return count;
}

void calibration_file_use(const calibration_file *file, hand_calibration *out)
{
    hand_calibration_default(out);
    for (int i = 0; i < MRT_ANGLES; ++i) {
        if (file->sensor[i].table.count == 0)
            continue;
        out->sensor[i] = file->sensor[i].table;
        out->neutral_rad[i] = file->sensor[i].neutral_rad;
    }
    for (int finger = 0; finger < SENSOR_DISTAL_COUNT; ++finger) {
        int distal = sensor_distal[finger];
        out->has_distal[finger] = file->sensor[distal].table.count > 0;
        if (!out->has_distal[finger])
            out->neutral_rad[distal] =
                hand_distal_from_middle(out->neutral_rad[sensor_middle[finger]]);
    }
}
