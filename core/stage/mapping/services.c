#include "stage/mapping/services.h"
#include "base/file.h"

#include <stdio.h>
#include <string.h>

static mrt_result make(file_home below, const char *type_id, char *out, size_t capacity, error *err)
{
    char rest[256];
    int length = snprintf(rest, sizeof rest, "plugins/%s", type_id);
    if (capacity > 0)
        out[0] = '\0';
    if (length <= 0 || (size_t)length >= sizeof rest)
        return error_set(err, MRT_ERR_ARGUMENT, "%s: the id is too long for the name of a folder",
                         type_id);
    mrt_result result = file_home_path(out, capacity, below, rest, err);
    if (result >= 0)
        result = file_make_folders(out, err);
    if (result < 0 && capacity > 0)
        out[0] = '\0';
    return result;
}

mrt_result services_settings_folder(const char *type_id, char *out, size_t capacity, error *err)
{
    return make(FILE_HOME_CONFIG, type_id, out, capacity, err);
}

static mrt_result write_folder(const mrt_host *host, file_home below, char *out, size_t capacity)
{
    const mrt_plugin_type *const *type = host->data;
    error err = {""};
    mrt_result result = make(below, (*type)->id, out, capacity, &err);
    if (result < 0)
        host->log(host, MRT_LOG_ERROR, err.text);
    return result;
}

static mrt_result settings_folder(const mrt_host *host, char *out, size_t capacity)
{
    return write_folder(host, FILE_HOME_CONFIG, out, capacity);
}

static mrt_result cache_folder(const mrt_host *host, char *out, size_t capacity)
{
    return write_folder(host, FILE_HOME_CACHE, out, capacity);
}

const mrt_folders services_folders = {settings_folder, cache_folder};

bool services_reader_init(services_reader *self)
{
    for (uint32_t side = MRT_LEFT; side <= MRT_RIGHT; ++side)
        if (!self->skeleton[side])
            self->skeleton[side] = hand_skeleton_create(side, HAND_LENGTH_MM);
    return self->skeleton[MRT_LEFT] && self->skeleton[MRT_RIGHT];
}

void services_reader_finish(services_reader *self)
{
    hand_skeleton_destroy(self->skeleton[MRT_LEFT]);
    hand_skeleton_destroy(self->skeleton[MRT_RIGHT]);
    *self = (services_reader){{NULL, NULL}};
}

void services_read_landmarks(const services_reader *self, const mrt_landmarks *seen,
                             mrt_hand_reading *reading)
{
    reading->confidence = 0.0f;
    if (seen->side > MRT_RIGHT)
        return;
    hand_landmarks points = {.doubtful = seen->doubtful};
    memcpy(points.at, seen->at, sizeof points.at);
    hand_reading now = {.confidence = 0.0};
    memcpy(now.angle_rad, reading->angle, sizeof now.angle_rad);
    hand_read(self->skeleton[seen->side], &points, &now);
    if (!(now.confidence > 0.0))
        return;
    double xyzw[4];
    rigid_to_quaternion(&now.wrist, xyzw);
    const double wrist[7] = {now.wrist.t.x, now.wrist.t.y, now.wrist.t.z, xyzw[0],
                             xyzw[1],       xyzw[2],       xyzw[3]};
    memcpy(reading->angle, now.angle_rad, sizeof reading->angle);
    for (int i = 0; i < 7; ++i)
        reading->wrist[i] = (float)wrist[i];
    reading->size = (float)now.size;
    reading->confidence = (float)now.confidence;
}
