/* unit/hand_recordings.h - recorded hands of people as tests of hand/ read them: ../shared/data,
 * which is not part of the repository. Readers return 0 when a file is not there. */
#ifndef MAROTTE_TEST_HAND_RECORDINGS_H
#define MAROTTE_TEST_HAND_RECORDINGS_H
#include "hand/hand.h"

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Angles over time, in the order of plugin.h. */
enum { RECORDING_ROWS_MAX = 7200 };
typedef struct recording {
    uint32_t count;
    double time_s[RECORDING_ROWS_MAX]; /* ascending */
    float angle_rad[RECORDING_ROWS_MAX][MRT_ANGLES];
    double wrist_xyzw[RECORDING_ROWS_MAX][4]; /* of Leap Motion: how the hand is turned */
} recording;

static inline void shared_path(char out[1024], const char *name)
{
    const char *shared = getenv("MAROTTE_SHARED");
    (void)snprintf(out, 1024, "%s/data/%s", shared ? shared : SOURCE_DIR "/../shared", name);
}

/* A hand that signs letters before a camera, 25 frames a second, as MediaPipe saw it. */
enum { CAMERA_FRAMES_MAX = 1000 };
static inline uint32_t read_camera(hand_landmarks out[CAMERA_FRAMES_MAX])
{
    char path[1024];
    shared_path(path, "camera/asl_hand_3d.full.json");
    json_t *frames = json_load_file(path, 0, NULL);
    uint32_t count = 0;
    for (size_t f = 0; f < json_array_size(frames) && count < CAMERA_FRAMES_MAX; ++f) {
        const json_t *points = json_array_get(frames, f);
        if (json_array_size(points) != MRT_JOINTS)
            continue;
        out[count] = (hand_landmarks){.doubtful = 0};
        for (size_t i = 0; i < MRT_JOINTS; ++i) {
            const json_t *p = json_array_get(points, i);
            out[count].at[i] = (mrt_vec3){(float)json_number_value(json_array_get(p, 0)),
                                          -(float)json_number_value(json_array_get(p, 1)),
                                          -(float)json_number_value(json_array_get(p, 2))};
        }
        ++count;
    }
    json_decref(frames);
    return count;
}

/* Appends a row; false: it is full, or time does not go on. */
static inline bool recording_add(recording *out, double time_s, const float *angle_rad)
{
    if (out->count == RECORDING_ROWS_MAX ||
        (out->count > 0 && time_s <= out->time_s[out->count - 1]))
        return false;
    out->time_s[out->count] = time_s;
    memcpy(out->angle_rad[out->count], angle_rad, sizeof out->angle_rad[0]);
    out->count += 1;
    return true;
}

/* The same hand as angles. skeleton: of a right hand. */
static inline uint32_t read_camera_angles(recording *out, const hand_skeleton *skeleton)
{
    static hand_landmarks seen[CAMERA_FRAMES_MAX];
    const uint32_t count = read_camera(seen);
    hand_reading reading = {.confidence = 0.0};
    out->count = 0;
    for (uint32_t f = 0; f < count; ++f) {
        hand_read(skeleton, &seen[f], &reading);
        if (reading.confidence >= 0.5)
            (void)recording_add(out, f / 25.0, reading.angle_rad);
    }
    return out->count;
}

/* The first hand of a Leap Motion recording, 100 to 115 frames a second: shared/data/leap/README.md
 * has the format. skeleton: left, right. */
static inline uint32_t read_leap(recording *out, const char *name, hand_skeleton *const skeleton[2])
{
    enum { PALM = 1, DIRECTION = 4, FINGERS = 10, FIELDS = FINGERS + 60 };
    const double palm_to_wrist_mm = -65.0;
    char path[1024], line[2048];
    hand_reading reading = {.confidence = 0.0};
    int side = -1;
    shared_path(path, name);
    FILE *file = fopen(path, "r");
    bool is_head = true;
    out->count = 0;
    while (file && fgets(line, sizeof line, file)) {
        char *at = line;
        double field[FIELDS] = {0.0};
        const double time_s = strtod(at, &at);
        const int of = strncmp(at, ",left", 5) == 0 ? MRT_LEFT : MRT_RIGHT;
        side = is_head || side >= 0 ? side : of;
        at = *at ? strchr(at + 1, ',') : NULL;
        for (int i = 0; i < FIELDS && at && *at == ','; ++i)
            field[i] = strtod(at + 1, &at);
        const bool is_used = !is_head && of == side;
        is_head = false;
        if (!is_used)
            continue;
        hand_landmarks seen = {.doubtful = 0};
        const double *palm = field + PALM, *direction = field + DIRECTION, *joint = field + FINGERS;
        seen.at[0] = (mrt_vec3){(float)(palm[0] + palm_to_wrist_mm * direction[0]),
                                (float)(palm[1] + palm_to_wrist_mm * direction[1]),
                                (float)(palm[2] + palm_to_wrist_mm * direction[2])};
        for (int i = 1; i < MRT_JOINTS; ++i, joint += 3)
            seen.at[i] = (mrt_vec3){(float)joint[0], (float)joint[1], (float)joint[2]};
        hand_read(skeleton[side], &seen, &reading);
        if (reading.confidence >= 0.5 && recording_add(out, time_s, reading.angle_rad))
            rigid_to_quaternion(&reading.wrist, out->wrist_xyzw[out->count - 1]);
    }
    if (file)
        (void)fclose(file);
    return out->count;
}

#endif
