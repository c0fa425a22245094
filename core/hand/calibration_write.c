#include "hand/calibration_file.h"

#include "base/file.h"
#include "hand/sensor.h"

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* 7 digits: a float reads as it was meant, 0.6 and not 0.600000024. */
enum { TEXT_FLAGS = JSON_ENCODE_ANY | JSON_REAL_PRECISION(7) };

/* jansson's setters fail on NULL, so one check at the end finds all failures of memory. */
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

/* Over what was read: unknown keys stay. */
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

/* The object at `key`, made if need be; owned by `parent`. */
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
    set(writer, root, "hand", json_string(file->side == MRT_LEFT ? "left" : "right"));
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

/* One member a line, the sensors one by one: a person finds what she looks for. */
static bool print_members(FILE *stream, json_t *object, const char *indent)
{
    bool failed = false;
    const char *joint = "";
    for (void *at = json_object_iter(object); at; at = json_object_iter_next(object, at)) {
        json_t *key = json_string(json_object_iter_key(at)), *value = json_object_iter_value(at);
        bool is_split = indent[2] == '\0' && strcmp(json_object_iter_key(at), "sensors") == 0;
        failed |= fprintf(stream, "%s%s", joint, indent) < 0;
        failed |= json_dumpf(key, stream, TEXT_FLAGS) != 0 || fputs(": ", stream) < 0;
        json_decref(key);
        if (is_split) {
            failed |= fputs("{\n", stream) < 0 || print_members(stream, value, "    ");
            failed |= fputs("\n  }", stream) < 0;
        } else {
            failed |= json_dumpf(value, stream, TEXT_FLAGS) != 0;
        }
        joint = ",\n";
    }
    return failed;
}

static char *text_of(json_t *root)
{
    char *text = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&text, &size);
    if (!stream)
        return NULL;
    bool failed = fputs("{\n", stream) < 0 || print_members(stream, root, "  ");
    failed |= fputs("\n}\n", stream) < 0;
    failed |= fclose(stream) != 0;
    if (failed) {
        free(text);
        return NULL;
    }
    return text;
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
