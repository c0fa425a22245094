#include "mapping.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void mapping_destroy(mrt_plugin *self)
{
    free(self);
}

void mapping_deactivate(mrt_plugin *self)
{
    (void)self;
}

void mapping_pull(mrt_pull *pull, const mrt_vector *vector, uint32_t count, float radius_mm)
{
    bool is_new = pull->mode != MRT_ANCHORED || pull->count != count;
    for (uint32_t i = 0; i < count; ++i) {
        const mrt_vector *before = &pull->vector[i];
        is_new = is_new || before->contact != vector[i].contact ||
                 memcmp(&before->start, &vector[i].start, sizeof before->start) != 0;
        pull->vector[i] = vector[i];
    }
    pull->mode = MRT_ANCHORED;
    pull->anchor += is_new;
    pull->count = count;
    pull->radius_mm = radius_mm;
    pull->gate = 0;
    pull->leak_per_s = 0.0f;
}

/* ---- saved state ---- */

/* Format: FNV-1a of the type's id, version, size of the body; the body; FNV-1a of all of that,
 * beginning with the id. */
enum { HEAD = 16, SUM = 8 };
_Static_assert(sizeof(int) == 4 && sizeof(bool) == 1 && sizeof(memory_kind) == 4, "stored so");

uint64_t memory_sum(uint64_t sum, const void *bytes, size_t size)
{
    const unsigned char *at = bytes;
    for (size_t i = 0; i < size; ++i)
        sum = (sum ^ at[i]) * UINT64_C(0x100000001b3);
    return sum;
}

static uint64_t sum_of_type(const memory_list *list)
{
    return memory_sum(MEMORY_SUM_START, list->type, strlen(list->type));
}

static size_t size_of(memory_kind kind)
{
    return kind == MEMORY_BOOL ? 1 : kind == MEMORY_DOUBLE ? 8 : 4;
}

/* Returns NULL after the last part. */
static const memory_part *part_of(const memory_list *list, uint32_t i)
{
    return i < MEMORY_PARTS_MAX && list->parts[i].at ? &list->parts[i] : NULL;
}

static size_t body_of(const memory_list *list)
{
    const memory_part *part;
    size_t size = 0;
    for (uint32_t i = 0; (part = part_of(list, i)); ++i)
        size += part->size;
    return size;
}

static void write_head(const memory_list *list, unsigned char out[HEAD])
{
    uint64_t type = sum_of_type(list);
    uint32_t body = (uint32_t)body_of(list);
    memcpy(out, &type, 8);
    memcpy(out + 8, &list->version, 4);
    memcpy(out + 12, &body, 4);
}

static bool is_value_allowed(const memory_part *part, const unsigned char *at)
{
    float single;
    double value = 0.0;
    uint32_t whole;
    switch (part->kind) {
    case MEMORY_BOOL:
        return *at <= 1;
    case MEMORY_WHOLE:
        memcpy(&whole, at, sizeof whole);
        return (double)whole <= part->most;
    case MEMORY_FLOAT:
        memcpy(&single, at, sizeof single);
        value = (double)single;
        break;
    case MEMORY_DOUBLE:
        memcpy(&value, at, sizeof value);
        break;
    }
    return value >= -part->most && value <= part->most;
}

/* Returns true if the variable may have the value in the bytes. */
static bool is_allowed(const memory_part *part, const void *there)
{
    const unsigned char *at = there;
    for (size_t k = 0; k < part->size; k += size_of(part->kind))
        if (!is_value_allowed(part, at + k))
            return false;
    return true;
}

static bool are_allowed(const memory_list *list, const unsigned char *at)
{
    const memory_part *part;
    for (uint32_t i = 0; (part = part_of(list, i)); ++i) {
        if (!is_allowed(part, at))
            return false;
        at += part->size;
    }
    return true;
}

size_t memory_save(const memory_list *list, void *out, size_t capacity)
{
    const memory_part *part;
    size_t size = HEAD + body_of(list) + SUM;
    for (uint32_t i = 0; (part = part_of(list, i)); ++i)
        if (!is_allowed(part, part->at))
            return 0;
    if (!out || capacity < size)
        return size;
    unsigned char *bytes = out, *at = bytes + HEAD;
    write_head(list, bytes);
    for (uint32_t i = 0; (part = part_of(list, i)); ++i) {
        memcpy(at, part->at, part->size);
        at += part->size;
    }
    uint64_t sum = memory_sum(sum_of_type(list), bytes, (size_t)(at - bytes));
    memcpy(at, &sum, SUM);
    return size;
}

bool memory_load(const memory_list *list, const void *bytes, size_t size)
{
    const unsigned char *at = bytes;
    unsigned char head[HEAD];
    uint64_t sum;
    write_head(list, head);
    if (!at || size != HEAD + body_of(list) + SUM || memcmp(at, head, HEAD) != 0)
        return false;
    memcpy(&sum, at + size - SUM, SUM);
    if (sum != memory_sum(sum_of_type(list), at, size - SUM) || !are_allowed(list, at + HEAD))
        return false;
    at += HEAD;
    const memory_part *part;
    for (uint32_t i = 0; (part = part_of(list, i)); ++i) {
        memcpy(part->at, at, part->size);
        at += part->size;
    }
    return true;
}

/* ---- the clutch ---- */

const char *const clutch_start_labels[] = {"At once", "On trigger", NULL};
const char *const clutch_pedal_labels[] = {"None",    "Pedal 1", "Pedal 2",
                                           "Pedal 3", "Pedal 4", NULL};
const char *const clutch_release_labels[] = {"Hold", "Spring back", NULL};

void clutch_reset(clutch *self)
{
    *self = (clutch){0};
}

/* Returns true in the frame in which the pedal goes down. */
static bool is_pressed(const clutch *self, const mrt_frame *frame, double pedal)
{
    int number = (int)pedal - 1;
    if (number < 0 || number >= MRT_MAX_PEDALS)
        return false;
    return frame->pedal[number] > 0.5f && !self->was_down[number];
}

clutch_events clutch_step(clutch *self, const mrt_frame *frame, const double *params)
{
    clutch_events events = {
        .engage =
            params[CLUTCH_ENGAGE] > 0.5 || is_pressed(self, frame, params[CLUTCH_ENGAGE_PEDAL]),
        .release =
            params[CLUTCH_RELEASE] > 0.5 || is_pressed(self, frame, params[CLUTCH_RELEASE_PEDAL]),
        .commit =
            params[CLUTCH_COMMIT] > 0.5 || is_pressed(self, frame, params[CLUTCH_COMMIT_PEDAL]),
    };
    if (!self->has_started && params[CLUTCH_START] < 0.5)
        events.engage = true;
    self->has_started = true;
    for (int i = 0; i < MRT_MAX_PEDALS; ++i)
        self->was_down[i] = frame->pedal[i] > 0.5f;
    return events;
}

bool clutch_springs_back(const double *params)
{
    return params[CLUTCH_ON_RELEASE] > 0.5;
}

float clutch_release_rate(const double *params)
{
    return (float)(3.0 / params[CLUTCH_RELEASE_TIME]);
}

/* ---- the pose of a hand ---- */

const char *const performing_hand_labels[] = {"Either", "Left", "Right", NULL};

static bool is_sound(const mrt_hand *hand)
{
    for (int i = 0; i < MRT_ANGLES; ++i)
        if (!isfinite(hand->angle[i]))
            return false;
    return hand->present;
}

const mrt_hand *performing_hand(const mrt_frame *frame, double choice)
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

double finger_bend(const mrt_hand *hand)
{
    static const int joints[] = {4, 5, 7, 8, 11, 12, 15, 16};
    double sum = 0.0;
    for (int i = 0; i < 8; ++i)
        sum += (double)hand->angle[joints[i]];
    return sum / 8.0;
}

double smoothing_share(double dt_s, double time_s)
{
    return dt_s > 0.0 ? dt_s / (time_s + dt_s) : 0.0;
}

double minimum_jerk(double t)
{
    if (!(t > 0.0))
        return 0.0;
    return t >= 1.0 ? 1.0 : t * t * t * (10.0 - 15.0 * t + 6.0 * t * t);
}

double soft_limit(double x, double most)
{
    double q = x * x / (most * most);
    return x / sqrt(sqrt(1.0 + q * q));
}

double clamp(double x, double low, double high)
{
    return x < low ? low : x > high ? high : x;
}
