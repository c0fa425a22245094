/* The palette of a live stage: its inputs, each with a channel for the fade and one for each of its
 * poses (palette.h). */
#include "stage/live/live_stage.h"
#include "base/clock.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define PALETTE_NAME TAKE_PALETTE_LAYER

static const int64_t settle_ns = 100 * NS_PER_MS; /* samples go on after a fade for this time */

/* ---- the inputs ---- */

static uint32_t index_of_input(const live *self, const input *of)
{
    for (uint32_t i = 0; of && i < self->entry_count; ++i)
        if (self->entry[i].input == of)
            return i;
    return UINT32_MAX;
}

static void send(live *self, uint32_t which, feed_activity activity)
{
    live_palette *p = &self->palette;
    feed_push(p->feed[which], p->value[which], activity);
    p->rests_at_ns[which] =
        activity == FEED_MOVES
            ? clock_now_ns() + (int64_t)(1e9 * (double)p->value[which][0]) + settle_ns
            : 0;
    p->is_marked[which] = false;
}

static mrt_result leave(live *self, error *err)
{
    live_palette *p = &self->palette;
    for (uint32_t i = p->input_count; i-- > 0;) {
        const uint32_t index = index_of_input(self, p->input[i]);
        const mrt_result result =
            index == UINT32_MAX ? MRT_OK : live_remove_input(self, index, err);
        if (result < 0)
            return result;
        feed_destroy(p->feed[i]);
        p->input_count = i;
    }
    *p = (live_palette){.is_open = p->is_open};
    return MRT_OK;
}

static mrt_result join_one(live *self, uint32_t which, error *err)
{
    live_palette *p = &self->palette;
    uint32_t count;
    const mrt_rig_pose *pose = live_poses(self, &count);
    const uint32_t first = which * PALETTE_INPUT_POSES;
    mrt_channel channel[MRT_MAX_CHANNELS] = {
        {"fade", "s", PALETTE_SEMANTIC, MRT_NO_HAND, 0.0f, (float)PALETTE_FADE_MOST_S}};
    char name[2][32] = {PALETTE_NAME, PALETTE_NAME " 2"};
    feed_settings settings = {.id = PALETTE_ID, .name = "Palette", .channels = channel};
    settings.channel_count = 1;
    for (uint32_t i = first; i < count && i < first + PALETTE_INPUT_POSES; ++i)
        channel[settings.channel_count++] =
            (mrt_channel){pose[i].name, "", PALETTE_SEMANTIC, MRT_NO_HAND, 0.0f, 1.0f};
    mrt_result result = feed_create(&p->feed[which], &settings, err);
    if (result < 0)
        return result;
    p->input_count = which + 1;
    result = input_create(&p->input[which], feed_type(p->feed[which]), which ? "2" : "", "",
                          CLOCK_REAL, self->settings.log, err);
    if (result >= 0)
        result = live_add_input(self, p->input[which], name[which], err);
    if (result < 0)
        p->input[which] = NULL;
    return result;
}

/* The inputs belong to the poses of the face. */
static mrt_result join(live *self, error *err)
{
    live_palette *p = &self->palette;
    uint32_t count;
    const mrt_rig_pose *pose = live_poses(self, &count);
    mrt_result result = MRT_OK;
    count = count < PALETTE_POSES_MAX ? count : (uint32_t)PALETTE_POSES_MAX;
    for (uint32_t i = 0; i * PALETTE_INPUT_POSES < count && result >= 0; ++i)
        result = join_one(self, i, err);
    error ignored = {""};
    if (result < 0 && leave(self, &ignored) < 0)
        return result;
    if (result < 0)
        return result;
    p->pose_count = count;
    p->scene = self->scene;
    for (uint32_t i = 0; i < count; ++i)
        (void)snprintf(p->name[i], sizeof p->name[i], "%s", pose[i].name);
    return MRT_OK;
}

static bool is_of_face(const live *self)
{
    const live_palette *p = &self->palette;
    uint32_t count;
    const mrt_rig_pose *pose = live_poses(self, &count);
    bool is_same = p->pose_count == (count < PALETTE_POSES_MAX ? count : PALETTE_POSES_MAX);
    for (uint32_t i = 0; i < p->pose_count && is_same; ++i)
        is_same = strncmp(p->name[i], pose[i].name, sizeof p->name[i] - 1) == 0;
    for (uint32_t i = 0; i < p->input_count; ++i)
        is_same &= index_of_input(self, p->input[i]) != UINT32_MAX;
    return is_same;
}

void live_palette_repeat(live *self)
{
    for (uint32_t i = 0; i < self->palette.input_count; ++i) {
        bool is_held = false;
        for (uint32_t c = 1; c < MRT_MAX_CHANNELS; ++c)
            is_held |= self->palette.value[i][c] > 0.0f;
        if (is_held)
            send(self, i, FEED_MOVES);
    }
}

/* Another face may have other poses. The strengths begin at 0 then. A new performer of the same
 * poses gets the strengths again. */
void live_palette_update(live *self)
{
    live_palette *p = &self->palette;
    const int64_t now_ns = clock_now_ns();
    error err = {""};
    if (!p->is_open)
        return;
    if (p->scene != self->scene && !is_of_face(self)) {
        if (live_check_free(self, PALETTE_NAME, &err) < 0)
            return;
        if (leave(self, &err) < 0 || join(self, &err) < 0) {
            p->is_open = false;
            log_push(self->settings.log, MRT_LOG_WARNING, "stage", err.text);
        }
        return;
    }
    if (p->scene != self->scene)
        live_palette_repeat(self);
    p->scene = self->scene;
    for (uint32_t i = 0; i < p->input_count; ++i)
        if (p->rests_at_ns[i] > 0 && now_ns >= p->rests_at_ns[i])
            send(self, i, FEED_RESTS);
}

bool live_palette_is_moving(const live *self)
{
    bool is_moving = false;
    for (uint32_t i = 0; i < self->palette.input_count; ++i)
        is_moving |= self->palette.rests_at_ns[i] > 0;
    return is_moving;
}

void live_palette_finish(live *self)
{
    for (uint32_t i = 0; i < self->palette.input_count; ++i)
        feed_destroy(self->palette.feed[i]);
}

/* ---- for the window ---- */

mrt_result live_palette_open(live *self, error *err)
{
    live_palette *p = &self->palette;
    if (p->is_open && is_of_face(self))
        return MRT_OK;
    mrt_result result = live_check_free(self, PALETTE_NAME, err);
    if (result >= 0)
        result = leave(self, err);
    if (result >= 0)
        result = join(self, err);
    p->is_open = result >= 0;
    return result;
}

uint32_t live_palette_count(const live *self)
{
    return self->palette.is_open ? self->palette.pose_count : 0;
}

void live_palette_set(live *self, uint32_t pose, double strength)
{
    live_palette *p = &self->palette;
    if (pose >= live_palette_count(self) || !(strength >= 0.0))
        return;
    const uint32_t which = pose / PALETTE_INPUT_POSES, at = 1 + pose % PALETTE_INPUT_POSES;
    const float value = strength < 1.0 ? (float)strength : 1.0f;
    p->is_marked[which] |= value < p->value[which][at] || value > p->value[which][at];
    p->value[which][at] = value;
}

void live_palette_send(live *self, double fade_s)
{
    live_palette *p = &self->palette;
    const double within = fade_s > 0.0 ? fmin(fade_s, PALETTE_FADE_MOST_S) : 0.0;
    for (uint32_t i = 0; i < p->input_count; ++i)
        if (p->is_marked[i]) {
            p->value[i][0] = (float)within;
            send(self, i, FEED_MOVES);
        }
}
