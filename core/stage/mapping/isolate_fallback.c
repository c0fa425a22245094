#include "stage/mapping/isolate_fallback.h"

#include <math.h>

enum { FINGERS = 5, JOINTS_OF_FINGER = 4 };

static mrt_vec3 sub(mrt_vec3 a, mrt_vec3 b)
{
    return (mrt_vec3){a.x - b.x, a.y - b.y, a.z - b.z};
}

static mrt_vec3 add(mrt_vec3 a, mrt_vec3 b)
{
    return (mrt_vec3){a.x + b.x, a.y + b.y, a.z + b.z};
}

static mrt_vec3 limited(mrt_vec3 a, float most)
{
    float length = sqrtf(a.x * a.x + a.y * a.y + a.z * a.z);
    float share = length > most ? most / length : 1.0f;
    return (mrt_vec3){a.x * share, a.y * share, a.z * share};
}

static mrt_vec3 tip_of(const mrt_frame *frame, uint32_t tip)
{
    const mrt_hand *hand = &frame->hand[tip / FINGERS];
    return hand->joint[(tip % FINGERS + 1) * JOINTS_OF_FINGER];
}

static bool is_there(const mrt_frame *frame, uint32_t tip)
{
    return frame->hand[tip / FINGERS].present;
}

/* Hands and face have other places: only how tips and vectors lie to their own middles counts. */
static mrt_vec3 middle_of_tips(const mrt_frame *frame)
{
    mrt_vec3 sum = {0, 0, 0};
    float count = 0;
    for (uint32_t i = 0; i < ISOLATE_TIPS; ++i)
        if (is_there(frame, i)) {
            sum = add(sum, tip_of(frame, i));
            count += 1;
        }
    return count > 0 ? (mrt_vec3){sum.x / count, sum.y / count, sum.z / count} : sum;
}

static mrt_vec3 middle_of_ends(const mrt_pull *pull)
{
    mrt_vec3 sum = {0, 0, 0};
    float count = (float)pull->count;
    for (uint32_t i = 0; i < pull->count; ++i)
        sum = add(sum, pull->vector[i].end);
    return count > 0 ? (mrt_vec3){sum.x / count, sum.y / count, sum.z / count} : sum;
}

static uint32_t nearest_tip(const mrt_frame *frame, mrt_vec3 place)
{
    uint32_t best = ISOLATE_TIPS;
    float best_distance = INFINITY;
    mrt_vec3 middle = middle_of_tips(frame);
    for (uint32_t i = 0; i < ISOLATE_TIPS; ++i) {
        mrt_vec3 d = sub(sub(tip_of(frame, i), middle), place);
        float distance = d.x * d.x + d.y * d.y + d.z * d.z;
        if (is_there(frame, i) && distance < best_distance) {
            best = i;
            best_distance = distance;
        }
    }
    return best;
}

static void remember_tips(isolate_fallback *self, const mrt_frame *frame)
{
    for (uint32_t i = 0; i < ISOLATE_TIPS; ++i)
        self->tip[i] = tip_of(frame, i);
    for (int side = 0; side < 2; ++side)
        self->has_tip[side] = frame->hand[side].present;
}

void isolate_fallback_begin(isolate_fallback *self, const mrt_frame *frame, const mrt_pull *held)
{
    *self = (isolate_fallback){.from = *held};
    if (self->from.count > MRT_MAX_VECTORS)
        self->from.count = 0;
    mrt_vec3 middle = middle_of_ends(&self->from);
    for (uint32_t i = 0; i < self->from.count; ++i)
        self->nearest[i] = nearest_tip(frame, sub(self->from.vector[i].end, middle));
    remember_tips(self, frame);
}

static void follow_tips(isolate_fallback *self, const mrt_frame *frame)
{
    for (uint32_t i = 0; i < ISOLATE_TIPS; ++i) {
        if (!is_there(frame, i) || !self->has_tip[i / FINGERS])
            continue;
        mrt_vec3 step = limited(sub(tip_of(frame, i), self->tip[i]), ISOLATE_FALLBACK_STEP_MM);
        self->moved[i] =
            limited(add(self->moved[i], step), ISOLATE_FALLBACK_REACH_MM / ISOLATE_FALLBACK_GAIN);
    }
    remember_tips(self, frame);
}

void isolate_fallback_process(isolate_fallback *self, const mrt_frame *frame, mrt_pull *pull)
{
    follow_tips(self, frame);
    mrt_pull before = *pull;
    *pull = self->from;
    for (uint32_t i = 0; i < pull->count; ++i) {
        mrt_vector *v = &pull->vector[i];
        mrt_vec3 way = {0, 0, 0};
        if (self->nearest[i] < ISOLATE_TIPS)
            way = self->moved[self->nearest[i]];
        v->end.x += ISOLATE_FALLBACK_GAIN * way.x;
        v->end.y += ISOLATE_FALLBACK_GAIN * way.y;
        v->end.z += ISOLATE_FALLBACK_GAIN * way.z;
        if (pull->mode == MRT_UNANCHORED && before.count == pull->count)
            v->start = before.vector[i].end; /* goes on from there */
    }
}
