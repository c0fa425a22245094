#include "posture.h"

#include <math.h>
#include <stddef.h>

const char *const posture_hand_labels[] = {"Either", "Left", "Right", NULL};

static bool is_sound(const mrt_hand *hand)
{
    for (int i = 0; i < MRT_ANGLES; ++i)
        if (!isfinite(hand->angle[i]))
            return false;
    return hand->present;
}

const mrt_hand *posture_hand(const mrt_frame *frame, double choice)
{
    enum { EITHER, LEFT };
    static const uint32_t order[][2] = {
        {MRT_RIGHT, MRT_LEFT}, {MRT_LEFT, MRT_LEFT}, {MRT_RIGHT, MRT_RIGHT}};
    const uint32_t *side = order[choice < 0.5 ? EITHER : choice < 1.5 ? LEFT : LEFT + 1];
    for (int i = 0; i < 2; ++i)
        if (is_sound(&frame->hand[side[i]]))
            return &frame->hand[side[i]];
    return NULL;
}

double posture_bend(const mrt_hand *hand)
{
    static const int joints[] = {4, 5, 7, 8, 11, 12, 15, 16};
    double sum = 0.0;
    for (int i = 0; i < 8; ++i)
        sum += (double)hand->angle[joints[i]];
    return sum / 8.0;
}

double posture_share(double dt_s, double time_s)
{
    return dt_s > 0.0 ? dt_s / (time_s + dt_s) : 0.0;
}

double posture_ease(double t)
{
    if (!(t > 0.0))
        return 0.0;
    return t >= 1.0 ? 1.0 : t * t * t * (10.0 - 15.0 * t + 6.0 * t * t);
}

double posture_limit(double x, double most)
{
    double q = x * x / (most * most);
    return x / sqrt(sqrt(1.0 + q * q));
}

double posture_clamp(double x, double low, double high)
{
    return x < low ? low : x > high ? high : x;
}
