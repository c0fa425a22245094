#include "bare_hand.h"
#include "device_io.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { WRIST_PITCH = 20, WRIST_YAW = 21 };
static const float turn_most_rad = 1.2f;

static const char *const side_label[] = {"left", "right", "either", NULL};
static const char *const wrist_label[] = {"still", "followed", NULL};
const mrt_param bare_hand_params[BARE_HAND_PARAMS] = {
    [BARE_HAND_SIDE] = {1, MRT_PARAM_STEPPED, "hand", "Hand", "",
                        "Hand that performs; either: the visible one, used as a right hand",
                        MRT_LEFT, BARE_HAND_EITHER, BARE_HAND_EITHER, side_label},
    [BARE_HAND_WRIST] =
        {2, MRT_PARAM_STEPPED, "wrist", "Hand", "",
         "Whether the wrist follows the tilt and turn of the hand since it was first seen", 0, 1, 1,
         wrist_label},
};

static uint32_t wanted_of(const double *params)
{
    double hand = params[BARE_HAND_SIDE];
    return hand < 0.5 ? MRT_LEFT : hand < 1.5 ? MRT_RIGHT : BARE_HAND_EITHER;
}

void bare_hand_init(bare_hand *out, const mrt_host *host)
{
    *out = (bare_hand){.host = host, .reader = host->service(host, MRT_LANDMARKS)};
}

bool bare_hand_has_reader(const bare_hand *self)
{
    if (!self->reader)
        device_log(self->host, MRT_LOG_ERROR,
                   "this version of marotte cannot read hand landmarks: use a newer one");
    return self->reader != NULL;
}

void bare_hand_begin(bare_hand *self, const double *params)
{
    *self = (bare_hand){.host = self->host,
                        .reader = self->reader,
                        .wanted = wanted_of(params),
                        .host_offset_ns = device_clock_host_offset_ns(self->host),
                        .last_ns = self->host->now_ns(self->host)};
    const uint32_t side = self->wanted == MRT_LEFT ? MRT_LEFT : MRT_RIGHT;
    for (uint32_t i = 0; i < MRT_ANGLES; ++i) {
        (void)snprintf(self->name[i], sizeof self->name[i], "%s.%s",
                       side == MRT_LEFT ? "left" : "right", device_sensor_name[i]);
        self->channel[i] =
            (mrt_channel){self->name[i], MRT_UNIT_LANDMARKS, MRT_CH_ANGLE + i, side, -0.7f, 2.2f};
    }
}

void bare_hand_follow(bare_hand *self, const double *params)
{
    self->follows_wrist = params[BARE_HAND_WRIST] > 0.5;
    if (self->has_asked_to_restart || wanted_of(params) == self->wanted)
        return;
    self->has_asked_to_restart = true;
    self->host->request_restart(self->host);
}

/* Rotates v by q: v + 2 w (u x v) + 2 u x (u x v). */
static void rotate(const float q[4], const float v[3], float out[3])
{
    float t[3];
    for (int i = 0; i < 3; ++i) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        t[i] = 2.0f * (q[j] * v[k] - q[k] * v[j]);
    }
    for (int i = 0; i < 3; ++i) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        out[i] = v[i] + q[3] * t[i] + q[j] * t[k] - q[k] * t[j];
    }
}

/* Angles of a hand that first yaws to the thumb's side, then pitches to the palm, like a wrist. The
 * fingers point along (sin yaw, -sin pitch cos yaw, cos pitch cos yaw). */
void bare_hand_turn(bare_hand *self, uint32_t side, mrt_hand_reading *reading)
{
    static const float along[3] = {0.0f, 0.0f, 1.0f};
    const float *now = reading->wrist + 3;
    float *first = self->first[side], fingers[3], seen[3];
    reading->angle[WRIST_PITCH] = reading->angle[WRIST_YAW] = 0.0f;
    if (!self->follows_wrist)
        return;
    if (!self->is_begun[side])
        memcpy(first, now, sizeof self->first[side]);
    self->is_begun[side] = true;
    const float back[4] = {-first[0], -first[1], -first[2], first[3]};
    rotate(now, along, fingers);
    rotate(back, fingers, seen);
    float aside = side == MRT_LEFT ? -seen[0] : seen[0];
    float yaw = asinf(fminf(fmaxf(aside, -1.0f), 1.0f)), pitch = atan2f(-seen[1], seen[2]);
    reading->angle[WRIST_YAW] = fminf(fmaxf(yaw, -turn_most_rad), turn_most_rad);
    reading->angle[WRIST_PITCH] = fminf(fmaxf(pitch, -turn_most_rad), turn_most_rad);
}

void bare_hand_show(bare_hand *self, uint32_t side, int64_t time_ns)
{
    self->has_shown = true;
    self->shown_side = side;
    self->shown_ns = time_ns;
}

void bare_hand_write_sample(bare_hand *self, int64_t time_ns, mrt_sample *out)
{
    self->sequence += self->lost + self->has_given;
    self->lost = 0;
    self->has_given = true;
    memset(out, 0, sizeof *out);
    out->time_ns = self->last_ns = time_ns;
    out->sequence = self->sequence;
    out->count = MRT_ANGLES;
    memcpy(out->value, self->reading.angle, sizeof self->reading.angle);
}
