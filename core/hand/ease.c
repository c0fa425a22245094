#include "hand/ease.h"

#include <math.h>
#include <string.h>

double ease_share(int64_t elapsed_ns)
{
    if (elapsed_ns <= 0)
        return 0.0;
    if (elapsed_ns >= EASE_SPAN_NS)
        return 1.0;
    double s = (double)elapsed_ns / (double)EASE_SPAN_NS;
    return s * s * (3.0 - 2.0 * s);
}

static int64_t elapsed_since(int64_t start_ns, int64_t time_ns)
{
    if (time_ns <= start_ns)
        return 0;
    uint64_t elapsed = (uint64_t)time_ns - (uint64_t)start_ns;
    return elapsed < (uint64_t)EASE_SPAN_NS ? (int64_t)elapsed : EASE_SPAN_NS;
}

static float between(float from, float to, double share)
{
    return (float)((1.0 - share) * (double)from + share * (double)to);
}

/* Advances to time_ns. Returns true if an ease from the last shown values begins. */
static bool starts_ease(ease_clock *clock, int64_t time_ns)
{
    bool starts = clock->has_shown && hand_is_gap(clock->last_ns, time_ns);
    if (starts) {
        clock->is_easing = true;
        clock->start_ns = time_ns;
    }
    clock->has_shown = true;
    clock->last_ns = time_ns;
    return starts;
}

/* Returns the progress of the ease. At 1 it ends. */
static double share_now(ease_clock *clock, int64_t time_ns)
{
    if (!clock->is_easing)
        return 1.0;
    double share = ease_share(elapsed_since(clock->start_ns, time_ns));
    clock->is_easing = share < 1.0;
    return share;
}

void ease_angles_apply(ease_angles *ease, float *angle_rad, int64_t time_ns)
{
    if (starts_ease(&ease->clock, time_ns))
        memcpy(ease->from, ease->last, sizeof ease->from);
    double share = share_now(&ease->clock, time_ns);
    if (share < 1.0)
        for (int i = 0; i < MRT_ANGLES; ++i)
            angle_rad[i] = between(ease->from[i], angle_rad[i], share);
    memcpy(ease->last, angle_rad, sizeof ease->last);
}

static double dot4(const float *a, const float *b)
{
    double sum = 0;
    for (int i = 0; i < 4; ++i)
        sum += (double)a[i] * (double)b[i];
    return sum;
}

/* Returns false if its length is 0. */
static bool normalise4(float *quaternion)
{
    double length = sqrt(dot4(quaternion, quaternion));
    if (!(length > 1e-12) || !isfinite(length))
        return false;
    for (int i = 0; i < 4; ++i)
        quaternion[i] = (float)((double)quaternion[i] / length);
    return true;
}

/* Interpolates two unit quaternions along the shorter arc. If they are opposite, the sum has no
 * length; then it returns the nearer one. */
static void slerp_between(float *out, const float *from, const float *to, double share)
{
    float blend[4];
    double sign = dot4(from, to) < 0.0 ? -1.0 : 1.0;
    for (int i = 0; i < 4; ++i)
        blend[i] = (float)((1.0 - share) * (double)from[i] + share * sign * (double)to[i]);
    memcpy(out, normalise4(blend) ? blend : share < 0.5 ? from : to, sizeof blend);
}

void ease_wrist_apply(ease_wrist *ease, float *wrist, int64_t time_ns)
{
    static const float no_rotation[4] = {0, 0, 0, 1};
    float *rotation = wrist + 3;
    if (!normalise4(rotation))
        memcpy(rotation, ease->clock.has_shown ? ease->last + 3 : no_rotation, sizeof no_rotation);
    if (starts_ease(&ease->clock, time_ns))
        memcpy(ease->from, ease->last, sizeof ease->from);
    double share = share_now(&ease->clock, time_ns);
    if (share < 1.0) {
        for (int i = 0; i < 3; ++i)
            wrist[i] = between(ease->from[i], wrist[i], share);
        float measured[4];
        memcpy(measured, rotation, sizeof measured);
        slerp_between(rotation, ease->from + 3, measured, share);
    }
    memcpy(ease->last, wrist, sizeof ease->last);
}

static double offset_share(const ease_offset *offset, int64_t time_ns)
{
    return ease_share(elapsed_since(offset->start_ns, time_ns));
}

void ease_offset_set(ease_offset *offset, const float *to_rad, int64_t time_ns)
{
    double share = offset_share(offset, time_ns);
    for (int i = 0; i < MRT_ANGLES; ++i) {
        offset->from_rad[i] = between(offset->from_rad[i], offset->to_rad[i], share);
        offset->to_rad[i] = to_rad[i];
    }
    offset->start_ns = time_ns;
}

void ease_offset_add(const ease_offset *offset, float *angle_rad, int64_t time_ns)
{
    double share = offset_share(offset, time_ns);
    for (int i = 0; i < MRT_ANGLES; ++i)
        angle_rad[i] += between(offset->from_rad[i], offset->to_rad[i], share);
}
