#include "hand/calibration_file.h"

#include "base/angle.h"
#include "base/file.h"
#include "base/json.h"
#include "base/text.h"
#include "hand/sensor.h"

#include <jansson.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { EXPECTED_TEXT = 256 };

/* ---- reading values ---- */

/* Reads at most capacity - 1 printable bytes. */
static mrt_result read_text(char *out, size_t capacity, const json_node *at, error *err)
{
    const char *text = json_string_value(at->value);
    size_t length = json_string_length(at->value);
    if (!text || length >= capacity || !text_is_printable(text_view_of(text, length))) {
        char expected[EXPECTED_TEXT];
        (void)snprintf(expected, sizeof expected,
                       "a text of at most %zu bytes without control characters", capacity - 1);
        return json_node_unexpected(err, at, expected);
    }
    memcpy(out, text, length + 1);
    return MRT_OK;
}

/* Reads one of `count` words; out: its index. */
static mrt_result read_choice(uint32_t *out, const json_node *at, const char *const *words,
                              uint32_t count, error *err)
{
    const char *text = json_string_value(at->value);
    for (uint32_t i = 0; text && i < count; ++i) {
        if (strcmp(text, words[i]) != 0)
            continue;
        *out = i;
        return MRT_OK;
    }
    char expected[EXPECTED_TEXT];
    size_t used = 0;
    for (uint32_t i = 0; i < count && used < sizeof expected; ++i) {
        const char *joint = i == 0 ? "" : i + 1 == count ? " or " : ", ";
        int added = snprintf(expected + used, sizeof expected - used, "%s\"%s\"", joint, words[i]);
        used += added > 0 ? (size_t)added : 0;
    }
    return json_node_unexpected(err, at, expected);
}

const char *const calibration_source_name[CALIBRATION_SOURCES] = {"shipped", "zeroed", "measured",
                                                                  "imported"};
static const char *const side_name[2] = {"left", "right"};
static const char pair_expected[] = "two numbers [a, b]";
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

static void note_unknown(calibration_file *file, const json_node *object, const char *const *known)
{
    void *at = NULL;
    for (const char *key; (key = json_node_unknown(object, known, &at)) != NULL;)
        calibration_file_note(file, "%s: unknown key; it is kept",
                              json_node_member(object, key).path.text);
}

/* If the key is missing, `out` is unchanged. */
static mrt_result read_optional(double *out, bool *out_has, const json_node *of, const char *key,
                                double low, double high, error *err)
{
    json_node at = json_node_member(of, key);
    *out_has = at.value != NULL;
    return at.value ? json_node_number(out, &at, low, high, err) : MRT_OK;
}

static mrt_result read_points(hand_table *out, const json_node *at, error *err)
{
    size_t count = json_array_size(at->value);
    if (!json_is_array(at->value) || count < 2 || count > HAND_TABLE_MAX)
        return json_node_unexpected(err, at, "an array of 2 to 16 points [raw, rad]");
    for (size_t i = 0; i < count; ++i) {
        json_node item = json_node_item(at, i);
        double point[2];
        mrt_result result =
            json_node_numbers(point, 2, &item, -raw_cap, raw_cap, pair_expected, err);
        if (result < 0)
            return result;
        json_node rad = json_node_item(&item, 1);
        result = json_node_number(&point[1], &rad, -ANGLE_PI, ANGLE_PI, err);
        if (result < 0)
            return result;
        out->raw[i] = (float)point[0];
        out->rad[i] = (float)point[1];
        if (i > 0 && !(out->raw[i] > out->raw[i - 1]))
            return error_set(err, MRT_ERR_FORMAT,
                             "%s: expected a raw value above the one before it, %.9g, found %.9g",
                             item.path.text, (double)out->raw[i - 1], point[0]);
    }
    out->count = (uint32_t)count;
    return MRT_OK;
}

static mrt_result read_range(float out[2], bool *out_has, const json_node *of, const char *key,
                             double cap, error *err)
{
    double pair[2] = {0, 0};
    json_node at = json_node_member(of, key);
    *out_has = at.value != NULL;
    mrt_result result =
        at.value ? json_node_numbers(pair, 2, &at, -cap, cap, pair_expected, err) : MRT_OK;
    out[0] = (float)pair[0];
    out[1] = (float)pair[1];
    return result;
}

static mrt_result read_ranges(calibration_sensor *out, const json_node *at, error *err)
{
    bool has_raw = false, has_rad = false;
    mrt_result result = read_range(out->raw_range, &has_raw, at, "raw_range", raw_cap, err);
    if (result >= 0)
        result = read_range(out->rad_range, &has_rad, at, "rad_range", 2.0 * ANGLE_PI, err);
    if (result >= 0 && has_raw != has_rad) {
        json_node missing = json_node_member(at, has_raw ? "rad_range" : "raw_range");
        result = json_node_unexpected(err, &missing, "both raw_range and rad_range, or neither");
    }
    out->has_range = has_raw && has_rad;
    return result;
}

static mrt_result find_sensor(int *out, const char *key, const json_node *at, error *err)
{
    *out = sensor_find(key);
    return *out >= 0
               ? MRT_OK
               : error_set(err, MRT_ERR_FORMAT, "%s: unknown sensor; names are as in \"index.mpj\"",
                           at->path.text);
}

static mrt_result read_cross_talk(calibration_sensor *out, const json_node *of, error *err)
{
    json_node at = json_node_member(of, "cross_talk");
    if (!at.value)
        return MRT_OK;
    mrt_result result = json_node_object(&at, "an object {\"sensor\": rad per rad}", err);
    if (result < 0)
        return result;
    json_t *object = (json_t *)(uintptr_t)at.value;
    for (void *i = json_object_iter(object); i; i = json_object_iter_next(object, i)) {
        const char *key = json_object_iter_key(i);
        json_node member = json_node_member(&at, key);
        int sensor;
        result = find_sensor(&sensor, key, &member, err);
        if (result < 0)
            return result;
        double share = 0;
        result = json_node_number(&share, &member, -cross_talk_cap, cross_talk_cap, err);
        if (result < 0)
            return result;
        out->cross_talk[sensor] = (float)share;
    }
    return MRT_OK;
}

static mrt_result read_sensor(calibration_file *file, int sensor, const json_node *at, error *err)
{
    static const char *const known[] = {"source",    "points",       "neutral_rad", "raw_range",
                                        "rad_range", "residual_rad", "cross_talk",  NULL};
    calibration_sensor *out = &file->sensor[sensor];
    mrt_result result = json_node_object(at, "an object", err);
    if (result < 0)
        return result;
    json_node source = json_node_member(at, "source");
    json_node points = json_node_member(at, "points");
    uint32_t choice = 0;
    double neutral = (double)sensor_table[sensor].neutral_rad, residual = 0;
    bool has_neutral = false;
    result = read_choice(&choice, &source, calibration_source_name, CALIBRATION_SOURCES, err);
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

static mrt_result read_sensors(calibration_file *out, const json_node *root, error *err)
{
    json_node at = json_node_member(root, "sensors");
    mrt_result result = json_node_object(&at, "an object of sensors, {\"index.mpj\": ...}", err);
    if (result < 0)
        return result;
    json_t *object = (json_t *)(uintptr_t)at.value;
    for (void *i = json_object_iter(object); i; i = json_object_iter_next(object, i)) {
        const char *key = json_object_iter_key(i);
        json_node member = json_node_member(&at, key);
        int sensor;
        result = find_sensor(&sensor, key, &member, err);
        if (result < 0)
            return result;
        result = read_sensor(out, sensor, &member, err);
        if (result < 0)
            return result;
    }
    json_node count_at = json_node_member(root, "sensor_count");
    double count = 0;
    result = json_node_number(&count, &count_at, 1, MRT_ANGLES, err);
    if (result >= 0 && (uint32_t)count != calibration_file_sensor_count(out))
        result =
            error_set(err, MRT_ERR_FORMAT, "%s: expected %u, as many as $.sensors has, found %g",
                      count_at.path.text, calibration_file_sensor_count(out), count);
    return result;
}

static mrt_result read_root(calibration_file *out, const json_node *root, error *err)
{
    static const char *const known[] = {
        "marotte_calibration", "name",           "date",    "hand", "input",
        "sensor_count",        "hand_length_mm", "sensors", NULL};
    mrt_result result = json_node_object(root, "an object, a calibration", err);
    if (result < 0)
        return result;
    json_node name_at = json_node_member(root, "name"), date_at = json_node_member(root, "date");
    json_node hand_at = json_node_member(root, "hand");
    json_node input_at = json_node_member(root, "input");
    result = json_node_version(root, "marotte_calibration", err);
    if (result >= 0 && name_at.value)
        result = read_text(out->name, sizeof out->name, &name_at, err);
    if (result >= 0 && date_at.value)
        result = read_text(out->date, sizeof out->date, &date_at, err);
    if (result >= 0)
        result = read_choice(&out->side, &hand_at, side_name, 2, err);
    if (result >= 0 && input_at.value)
        result = read_text(out->input, sizeof out->input, &input_at, err);
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
    json_t *value;
    mrt_result result = json_parse(&value, bytes, size, err);
    if (result < 0) {
        error_prefix(err, name);
        return result;
    }
    json_node root = json_node_root(value, name);
    out->document = value;
    result = read_root(out, &root, err);
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
    if (file->input[0])
        hand_calibration_identity(out);
    else
        hand_calibration_default(out);
    memcpy(out->input, file->input, sizeof out->input);
    for (int i = 0; i < MRT_ANGLES; ++i) {
        if (file->sensor[i].table.count == 0)
            continue;
        out->sensor[i] = file->sensor[i].table;
        out->neutral_rad[i] = file->sensor[i].neutral_rad;
    }
    for (int finger = 0; finger < SENSOR_DISTAL_COUNT && !file->input[0]; ++finger) {
        int distal = sensor_distal[finger];
        out->has_distal[finger] = file->sensor[distal].table.count > 0;
        if (!out->has_distal[finger])
            out->neutral_rad[distal] =
                hand_distal_from_middle(out->neutral_rad[sensor_middle[finger]]);
    }
}

/* ---- writing ---- */

/* 7 digits, so that a float is written as 0.6 and not as 0.600000024. */
enum { TEXT_FLAGS = JSON_ENCODE_ANY | JSON_REAL_PRECISION(7) };

/* The setters of jansson fail on NULL, so one check at the end finds all failures of memory. */
typedef struct json_writer {
    bool failed;
} json_writer;

static void set(json_writer *writer, json_t *object, const char *key, json_t *value)
{
    writer->failed |= json_object_set_new(object, key, value) != 0;
}

static void unset(json_t *object, const char *key)
{
    (void)json_object_del(object, key);
}

static json_t *pair_of(json_writer *writer, float a, float b)
{
    json_t *pair = json_array();
    writer->failed |= json_array_append_new(pair, json_real((double)a)) != 0;
    writer->failed |= json_array_append_new(pair, json_real((double)b)) != 0;
    return pair;
}

static json_t *points_of(json_writer *writer, const hand_table *table)
{
    json_t *points = json_array();
    for (uint32_t i = 0; i < table->count && i < HAND_TABLE_MAX; ++i)
        writer->failed |=
            json_array_append_new(points, pair_of(writer, table->raw[i], table->rad[i])) != 0;
    return points;
}

static json_t *cross_talk_of(json_writer *writer, const calibration_sensor *sensor)
{
    json_t *object = json_object();
    for (int i = 0; i < MRT_ANGLES; ++i)
        if (sensor->cross_talk[i] < 0.0f || sensor->cross_talk[i] > 0.0f)
            set(writer, object, sensor_table[i].name, json_real((double)sensor->cross_talk[i]));
    return object;
}

/* Writes over the object that was read, so that unknown keys stay. */
static void set_sensor(json_writer *writer, json_t *object, const calibration_sensor *sensor)
{
    set(writer, object, "source", json_string(calibration_source_name[sensor->source]));
    set(writer, object, "points", points_of(writer, &sensor->table));
    set(writer, object, "neutral_rad", json_real((double)sensor->neutral_rad));
    if (sensor->has_range) {
        set(writer, object, "raw_range",
            pair_of(writer, sensor->raw_range[0], sensor->raw_range[1]));
        set(writer, object, "rad_range",
            pair_of(writer, sensor->rad_range[0], sensor->rad_range[1]));
    } else {
        unset(object, "raw_range");
        unset(object, "rad_range");
    }
    if (sensor->has_residual)
        set(writer, object, "residual_rad", json_real((double)sensor->residual_rad));
    else
        unset(object, "residual_rad");
    set(writer, object, "cross_talk", cross_talk_of(writer, sensor));
}

/* Returns the object at `key`, created if it is missing; owned by `parent`. */
static json_t *object_at(json_writer *writer, json_t *parent, const char *key)
{
    json_t *object = json_object_get(parent, key);
    if (json_is_object(object))
        return object;
    set(writer, parent, key, json_object());
    return json_object_get(parent, key);
}

static void set_file(json_writer *writer, json_t *root, const calibration_file *file)
{
    set(writer, root, "marotte_calibration", json_integer(1));
    set(writer, root, "name", json_string(file->name));
    set(writer, root, "date", json_string(file->date));
    set(writer, root, "hand", json_string(side_name[file->side == MRT_LEFT ? 0 : 1]));
    if (file->input[0])
        set(writer, root, "input", json_string(file->input));
    else
        unset(root, "input");
    set(writer, root, "sensor_count",
        json_integer((json_int_t)calibration_file_sensor_count(file)));
    if (file->hand_length_mm > 0)
        set(writer, root, "hand_length_mm", json_real(file->hand_length_mm));
    else
        unset(root, "hand_length_mm");
    json_t *sensors = object_at(writer, root, "sensors");
    for (int i = 0; i < MRT_ANGLES; ++i) {
        if (file->sensor[i].table.count == 0)
            unset(sensors, sensor_table[i].name);
        else
            set_sensor(writer, object_at(writer, sensors, sensor_table[i].name), &file->sensor[i]);
    }
}

typedef struct growing_text {
    char *data; /* owned; ends with 0 */
    size_t size, capacity;
} growing_text;

/* Returns 0, or -1 without memory, as json_dump_callback expects. */
static int append(const char *bytes, size_t size, void *data)
{
    growing_text *to = data;
    if (to->size + size >= to->capacity) {
        const size_t capacity = 2 * (to->size + size) + 1;
        char *longer = realloc(to->data, capacity);
        if (!longer)
            return -1;
        to->data = longer;
        to->capacity = capacity;
    }
    memcpy(to->data + to->size, bytes, size);
    to->size += size;
    to->data[to->size] = '\0';
    return 0;
}

static bool append_word(growing_text *to, const char *word)
{
    return append(word, strlen(word), to) != 0;
}

/* One member per line, and one line per sensor, so that a person can find them. Returns true if it
 * failed. */
static bool print_members(growing_text *to, json_t *object, const char *indent)
{
    bool failed = false;
    const char *joint = "";
    for (void *at = json_object_iter(object); at; at = json_object_iter_next(object, at)) {
        json_t *key = json_string(json_object_iter_key(at)), *value = json_object_iter_value(at);
        bool is_split = indent[2] == '\0' && strcmp(json_object_iter_key(at), "sensors") == 0;
        failed |= append_word(to, joint) || append_word(to, indent);
        failed |= json_dump_callback(key, append, to, TEXT_FLAGS) != 0 || append_word(to, ": ");
        json_decref(key);
        if (is_split) {
            failed |= append_word(to, "{\n") || print_members(to, value, "    ");
            failed |= append_word(to, "\n  }");
        } else {
            failed |= json_dump_callback(value, append, to, TEXT_FLAGS) != 0;
        }
        joint = ",\n";
    }
    return failed;
}

static char *text_of(json_t *root)
{
    growing_text text = {0};
    const bool failed = append_word(&text, "{\n") || print_members(&text, root, "  ") ||
                        append_word(&text, "\n}\n");
    if (failed) {
        free(text.data);
        return NULL;
    }
    return text.data;
}

char *calibration_file_text(const calibration_file *file)
{
    json_writer writer = {false};
    json_t *root = file->document ? json_deep_copy(file->document) : json_object();
    if (!root)
        return NULL;
    set_file(&writer, root, file);
    char *text = writer.failed ? NULL : text_of(root);
    json_decref(root);
    return text;
}

mrt_result calibration_file_write(const calibration_file *file, const char *path, error *err)
{
    char *text = calibration_file_text(file);
    if (!text)
        return error_set(err, MRT_ERR_MEMORY, "%s: no memory, or a name that is not UTF-8", path);
    file_writer writer;
    mrt_result result = file_writer_open(&writer, path, err);
    if (result >= 0) {
        (void)fputs(text, writer.stream);
        result = file_writer_commit(&writer, err);
    }
    free(text);
    return result;
}

/* ---- a linear table ---- */

static const double RADIANS_PER_DEGREE = ANGLE_PI / 180.0;
static const double BEYOND_DEG = 15.0;

hand_table calibration_line(int sensor, double gain, double zero, double rad_at_zero)
{
    const sensor_facts *facts = &sensor_table[sensor];
    double low_rad = ((double)facts->low_deg - BEYOND_DEG) * RADIANS_PER_DEGREE;
    double high_rad = ((double)facts->high_deg + BEYOND_DEG) * RADIANS_PER_DEGREE;
    double first_rad = gain > 0 ? low_rad : high_rad, last_rad = gain > 0 ? high_rad : low_rad;
    double first = zero + (first_rad - rad_at_zero) / gain;
    double last = zero + (last_rad - rad_at_zero) / gain;
    const double raw[5] = {first - 1.0, first, zero, last, last + 1.0};
    const double rad[5] = {first_rad, first_rad, rad_at_zero, last_rad, last_rad};
    hand_table out = {.count = 5};
    for (int i = 0; i < 5; ++i) {
        out.raw[i] = (float)raw[i];
        out.rad[i] = (float)rad[i];
    }
    return out;
}
