#include "camera_wire.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- HTTP ---- */

int camera_request_judge(const web_request *request, uint16_t port, const char *token,
                         const char **out_name)
{
    char host[32], origin[48];
    (void)snprintf(host, sizeof host, "127.0.0.1:%u", (unsigned)port);
    (void)snprintf(origin, sizeof origin, "http://%s", host);
    *out_name = "";
    if (!request->has_host || strcmp(request->host, host) != 0)
        return 403;
    if (request->has_origin && strcmp(request->origin, origin) != 0)
        return 403;
    if (strlen(request->path) < 2 + CAMERA_TOKEN || request->path[1 + CAMERA_TOKEN] != '/')
        return 404;
    unsigned char differs = 0; /* in a time that does not depend on the content */
    for (int i = 0; i < CAMERA_TOKEN; ++i)
        differs |= (unsigned char)request->path[1 + i] ^ (unsigned char)token[i];
    if (differs)
        return 404;
    *out_name = request->path + 2 + CAMERA_TOKEN;
    if (strcmp(*out_name, "socket") != 0)
        return 200;
    return request->has_origin && request->is_socket ? 101 : 403;
}

/* ---- messages ---- */

enum {
    HEAD_SIZE = 1 + 4 + 8 + 1,
    WORLD_AT = 1 + 4,
    PICTURE_AT = WORLD_AT + 4 * 3 * MRT_JOINTS,
    HAND_SIZE = PICTURE_AT + 4 * 2 * MRT_JOINTS,
    ASK_SIZE = 1 + 8
};
static const double time_most_ms = 1e12 /* 30 years */, furthest_m = 10.0, mm_per_m = 1000.0;

static uint64_t take(const unsigned char *at, int bytes)
{
    uint64_t value = 0;
    for (int i = bytes - 1; i >= 0; --i)
        value = value << 8 | at[i];
    return value;
}

static float take_f32(const unsigned char *at)
{
    uint32_t bits = (uint32_t)take(at, 4);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static bool take_time(camera_message *out, const unsigned char *at)
{
    uint64_t bits = take(at, 8);
    memcpy(&out->time_ms, &bits, sizeof bits);
    if (!(fabs(out->time_ms) <= time_most_ms)) /* also false for NaN */
        return false;
    out->time_ns = (int64_t)(out->time_ms * 1e6);
    return true;
}

static bool take_coordinate(float *out, const unsigned char *at, double scale)
{
    double value = (double)take_f32(at);
    *out = (float)(scale * value);
    return fabs(value) <= furthest_m;
}

/* MediaPipe's x is to the right of the picture, y down, z away from the camera. In a picture that
 * is not mirrored, right is the subject's left. */
static bool take_hand(camera_hand *out, const unsigned char *at)
{
    *out = (camera_hand){.seen = {.side = at[0]}, .score = take_f32(at + 1)};
    bool is_good = at[0] <= MRT_RIGHT && out->score >= 0.0f && out->score <= 1.0f;
    for (int i = 0; i < MRT_JOINTS; ++i) {
        const unsigned char *point = at + WORLD_AT + 12 * (size_t)i;
        mrt_vec3 *to = &out->seen.at[i];
        is_good &= take_coordinate(&to->x, point, mm_per_m);
        is_good &= take_coordinate(&to->y, point + 4, -mm_per_m);
        is_good &= take_coordinate(&to->z, point + 8, -mm_per_m);
    }
    float unused;
    for (size_t i = 0; i < (size_t)2 * MRT_JOINTS; ++i)
        is_good &= take_coordinate(&unused, at + PICTURE_AT + 4 * i, 1.0);
    return is_good;
}

bool camera_message_parse(camera_message *out, const void *bytes, size_t size)
{
    const unsigned char *at = bytes;
    *out = (camera_message){.kind = CAMERA_NOTHING};
    if (size == ASK_SIZE && at[0] == CAMERA_ASKED && take_time(out, at + 1)) {
        out->kind = CAMERA_ASKED;
        return true;
    }
    if (size < HEAD_SIZE || at[0] != CAMERA_SEEN || !take_time(out, at + 5))
        return false;
    out->sequence = (uint32_t)take(at + 1, 4);
    out->hand_count = at[13];
    if (out->hand_count > CAMERA_HANDS_MAX ||
        size != HEAD_SIZE + (size_t)out->hand_count * HAND_SIZE)
        return false;
    for (uint32_t i = 0; i < out->hand_count; ++i)
        if (!take_hand(&out->hand[i], at + HEAD_SIZE + (size_t)i * HAND_SIZE))
            return false;
    out->kind = CAMERA_SEEN;
    return true;
}

void camera_answer_write(unsigned char out[CAMERA_ANSWER_SIZE], double time_ms, int64_t time_ns)
{
    uint64_t asked, own = (uint64_t)time_ns;
    memcpy(&asked, &time_ms, sizeof asked);
    out[0] = CAMERA_ANSWER;
    for (int i = 0; i < 8; ++i) {
        out[1 + i] = (unsigned char)(asked >> 8 * i);
        out[9 + i] = (unsigned char)(own >> 8 * i);
    }
}
