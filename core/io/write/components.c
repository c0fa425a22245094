#include "io/write/components.h"

#include "io/write/component_plan.h"
#include "io/write/component_window.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Share of the tolerance that is used: the rest covers what float32 sums lose. */
static const double TOLERANCE_SHARE = 0.999;

static uint32_t cap_of(const components_request *wanted, uint32_t vertex_count)
{
    size_t cap = (size_t)COMPONENTS_MAX_BYTES / ((size_t)vertex_count * 3 * sizeof(float));
    cap = cap < 16 ? 16 : cap > COMPONENTS_MAX ? COMPONENTS_MAX : cap;
    return wanted->max_count && wanted->max_count < cap ? wanted->max_count : (uint32_t)cap;
}

/* What is left of the cap, shared by what the window and those after it need. */
static uint32_t cap_of_window(const component_plan *plan, uint32_t window, uint32_t left)
{
    uint64_t need = 0;
    for (uint32_t w = window; w < plan->count; ++w)
        need += plan->need[w];
    assert(need > 0);
    uint32_t share = (uint32_t)((uint64_t)left * plan->need[window] / need);
    return share ? share : left > 0;
}

static mrt_result find_window(components *out, component_frames *frames, const component_plan *plan,
                              const window_request *common, uint32_t left, error *err)
{
    uint32_t index = out->window_count;
    window_request wanted = *common;
    wanted.first_frame = plan->first[index];
    wanted.frame_count = plan->first[index + 1] - plan->first[index];
    wanted.cap = cap_of_window(plan, index, left);
    wanted.base = plan->count > 1 && wanted.cap > 0 ? WINDOW_BASE_MEAN : WINDOW_BASE_NONE;
    wanted.done_before = 0.1 + 0.7 * (double)wanted.first_frame / (double)frames->count;
    wanted.done_share = 0.7 * (double)wanted.frame_count / (double)frames->count;
    double error_m;
    component_window *window = &out->window[index];
    mrt_result result = component_window_find(window, &error_m, frames, &wanted, err);
    if (result < 0)
        return result;
    out->window_count++;
    out->target_count += component_window_target_count(window);
    out->max_error_mm = fmax(out->max_error_mm, error_m * 1000.0);
    return MRT_OK;
}

static mrt_result find_windows(components *out, component_frames *frames,
                               const component_plan *plan, const components_request *wanted,
                               const export_progress *progress, error *err)
{
    window_request common = {.tolerance_m = wanted->tolerance_mm * 0.001 * TOLERANCE_SHARE,
                             .progress = progress};
    uint32_t cap = cap_of(wanted, out->vertex_count);
    out->window = calloc(plan->count, sizeof *out->window);
    if (!out->window)
        return error_set(err, MRT_ERR_MEMORY, "no memory for %u windows of free frames",
                         plan->count);
    for (uint32_t w = 0; w < plan->count; ++w) {
        mrt_result result = find_window(out, frames, plan, &common, cap - out->target_count, err);
        if (result < 0)
            return result;
    }
    return MRT_OK;
}

void components_finish(components *c)
{
    if (!c)
        return;
    for (uint32_t w = 0; w < c->window_count; ++w)
        component_window_finish(&c->window[w]);
    free(c->window);
    free(c->frame);
    *c = (components){0};
}

void components_offset(float *out, const components *c, const component_window *window,
                       uint32_t component)
{
    const float *axis = window->axis + (size_t)component * window->moved_count * 3;
    memset(out, 0, (size_t)c->vertex_count * 3 * sizeof *out);
    for (uint32_t i = 0; i < window->moved_count; ++i)
        memcpy(out + (size_t)window->moved[i] * 3, axis + (size_t)i * 3, 3 * sizeof *out);
}

mrt_result components_find(components *out, const clip *c, const components_request *wanted,
                           const export_progress *progress, error *err)
{
    *out = (components){.vertex_count = clip_mesh(c)->vertex_count};
    component_frames frames;
    component_plan plan = {0};
    mrt_result result = component_frames_init(&frames, c, wanted->base_m, err);
    if (result == MRT_OK && frames.count > 0) {
        result = component_plan_make(&plan, &frames, wanted->tolerance_mm * 0.001,
                                     cap_of(wanted, out->vertex_count), err);
        if (result == MRT_OK)
            result = find_windows(out, &frames, &plan, wanted, progress, err);
    }
    out->frame_count = frames.count;
    out->frame = frames.frame;
    frames.frame = NULL;
    component_plan_finish(&plan);
    component_frames_finish(&frames);
    if (result < 0)
        components_finish(out);
    return result;
}
