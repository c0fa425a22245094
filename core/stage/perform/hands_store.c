/* The state of the hands as bytes. */
#include "base/bytes.h"
#include "stage/perform/hands_state.h"

#include <math.h>

enum { STORE_VERSION = 1 };

static void take_finite(bytes_in *in, float *out, size_t count)
{
    bytes_take(in, out, count * sizeof *out);
    for (size_t i = 0; i < count; ++i)
        in->failed |= !isfinite(out[i]);
}

/* ---- filter and window ---- */

static void put_filter(bytes_out *out, const hand_filter *filter)
{
    for (int i = 0; i < MRT_ANGLES; ++i) {
        bytes_put(out, &filter->state[i].value, sizeof filter->state[i].value);
        bytes_put(out, &filter->state[i].derivative, sizeof filter->state[i].derivative);
        bytes_put_u32(out, filter->state[i].running);
    }
    bytes_put(out, &filter->last_ns, sizeof filter->last_ns);
    bytes_put_u32(out, filter->running);
}

static void take_filter(bytes_in *in, hand_filter *filter)
{
    for (int i = 0; i < MRT_ANGLES; ++i) {
        take_finite(in, &filter->state[i].value, 1);
        take_finite(in, &filter->state[i].derivative, 1);
        filter->state[i].running = bytes_take_u32(in) != 0;
    }
    bytes_take(in, &filter->last_ns, sizeof filter->last_ns);
    filter->running = bytes_take_u32(in) != 0;
}

/* The rows in use, oldest first. */
static void put_window(bytes_out *out, const still_window *window)
{
    bytes_put_u32(out, window->count);
    for (uint32_t i = 0; i < window->count; ++i) {
        uint32_t row = (window->first + i) % STILL_SAMPLES;
        bytes_put(out, &window->time_ns[row], sizeof window->time_ns[row]);
        bytes_put(out, window->value[row], sizeof window->value[row]);
    }
}

static void take_window(bytes_in *in, still_window *window)
{
    window->first = 0;
    window->count = bytes_take_u32(in);
    if (window->count > STILL_SAMPLES) {
        in->failed = true;
        window->count = 0;
    }
    for (uint32_t row = 0; row < window->count; ++row) {
        int64_t *time_ns = &window->time_ns[row];
        bytes_take(in, time_ns, sizeof *time_ns);
        take_finite(in, window->value[row], MRT_ANGLES);
        uint64_t since_ns = (uint64_t)*time_ns - (uint64_t)window->time_ns[0];
        in->failed |= since_ns > (uint64_t)window->span_ns || (row > 0 && *time_ns <= time_ns[-1]);
    }
}

/* ---- eases ---- */

static void put_clock(bytes_out *out, const ease_clock *clock)
{
    bytes_put_u32(out, clock->has_shown);
    bytes_put_u32(out, clock->is_easing);
    bytes_put(out, &clock->last_ns, sizeof clock->last_ns);
    bytes_put(out, &clock->start_ns, sizeof clock->start_ns);
}

static void take_clock(bytes_in *in, ease_clock *clock)
{
    clock->has_shown = bytes_take_u32(in) != 0;
    clock->is_easing = bytes_take_u32(in) != 0;
    bytes_take(in, &clock->last_ns, sizeof clock->last_ns);
    bytes_take(in, &clock->start_ns, sizeof clock->start_ns);
}

static void put_hand(bytes_out *out, const one_hand *hand)
{
    put_filter(out, &hand->filter);
    bytes_put(out, hand->raw, sizeof hand->raw);
    bytes_put(out, hand->wrist_raw, sizeof hand->wrist_raw);
    bytes_put_u32(out, hand->has_wrist);
    put_window(out, &hand->window);
    bytes_put(out, hand->neutral_rad, sizeof hand->neutral_rad);
    bytes_put(out, &hand->offset.start_ns, sizeof hand->offset.start_ns);
    bytes_put(out, hand->offset.from_rad, sizeof hand->offset.from_rad);
    bytes_put(out, hand->offset.to_rad, sizeof hand->offset.to_rad);
    put_clock(out, &hand->eased.clock);
    bytes_put(out, hand->eased.last, sizeof hand->eased.last);
    bytes_put(out, hand->eased.from, sizeof hand->eased.from);
    put_clock(out, &hand->eased_wrist.clock);
    bytes_put(out, hand->eased_wrist.last, sizeof hand->eased_wrist.last);
    bytes_put(out, hand->eased_wrist.from, sizeof hand->eased_wrist.from);
    bytes_put(out, hand->angle_rad, sizeof hand->angle_rad);
}

static void take_hand(bytes_in *in, one_hand *hand)
{
    take_filter(in, &hand->filter);
    bytes_take(in, hand->raw, sizeof hand->raw);
    take_finite(in, hand->wrist_raw, EASE_WRIST);
    hand->has_wrist = bytes_take_u32(in) != 0;
    take_window(in, &hand->window);
    take_finite(in, hand->neutral_rad, MRT_ANGLES);
    bytes_take(in, &hand->offset.start_ns, sizeof hand->offset.start_ns);
    take_finite(in, hand->offset.from_rad, MRT_ANGLES);
    take_finite(in, hand->offset.to_rad, MRT_ANGLES);
    take_clock(in, &hand->eased.clock);
    take_finite(in, hand->eased.last, MRT_ANGLES);
    take_finite(in, hand->eased.from, MRT_ANGLES);
    take_clock(in, &hand->eased_wrist.clock);
    take_finite(in, hand->eased_wrist.last, EASE_WRIST);
    take_finite(in, hand->eased_wrist.from, EASE_WRIST);
    take_finite(in, hand->angle_rad, MRT_ANGLES);
}

size_t hands_save(const hands *self, void *bytes, size_t capacity)
{
    bytes_out out = {.data = bytes, .capacity = bytes ? capacity : 0};
    bytes_put_u32(&out, STORE_VERSION);
    bytes_put_u32(&out, self->is_rezero_down);
    for (int side = 0; side < 2; ++side)
        put_hand(&out, &self->hand[side]);
    return out.size;
}

bool hands_load(hands *self, const void *bytes, size_t size)
{
    bytes_in in = {.at = bytes, .end = (const unsigned char *)bytes + size};
    hands_reset(self);
    in.failed |= bytes_take_u32(&in) != STORE_VERSION;
    self->is_rezero_down = bytes_take_u32(&in) != 0;
    for (int side = 0; side < 2; ++side)
        take_hand(&in, &self->hand[side]);
    if (!in.failed && in.at == in.end)
        return true;
    hands_reset(self);
    return false;
}

/* ---- another clock ---- */

static void shift(int64_t *time_ns, int64_t by_ns)
{
    *time_ns = (int64_t)((uint64_t)*time_ns + (uint64_t)by_ns);
}

static void shift_clock(ease_clock *clock, int64_t by_ns)
{
    shift(&clock->last_ns, by_ns);
    shift(&clock->start_ns, by_ns);
}

void hands_shift_time(hands *self, int64_t by_ns)
{
    for (int side = 0; side < 2; ++side) {
        one_hand *hand = &self->hand[side];
        shift(&hand->filter.last_ns, by_ns);
        for (int row = 0; row < STILL_SAMPLES; ++row)
            shift(&hand->window.time_ns[row], by_ns);
        shift(&hand->offset.start_ns, by_ns);
        shift_clock(&hand->eased.clock, by_ns);
        shift_clock(&hand->eased_wrist.clock, by_ns);
    }
}
