#include "stage/mapping/null_mapping.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Time after a reset in which bones return to neutral. After it, they are left to other layers and
 * the pointer. */
static const double settles_s = 0.5;

struct mrt_plugin {
    bool has_begun;
    double since_s; /* time since the last reset */
};

static mrt_plugin *create(const mrt_host *host)
{
    (void)host;
    return calloc(1, sizeof(mrt_plugin));
}

static void destroy(mrt_plugin *self)
{
    free(self);
}

static mrt_result activate(mrt_plugin *self, const mrt_face *face)
{
    (void)self, (void)face;
    return MRT_OK;
}

static void do_nothing(mrt_plugin *self)
{
    (void)self;
}

static void reset(mrt_plugin *self)
{
    self->has_begun = false;
    self->since_s = 0.0;
}

/* Anchored, so that earlier pulls end. An idle mapping would keep them. */
static mrt_result process(mrt_plugin *self, const mrt_frame *frame, mrt_pull *pull)
{
    if (!self->has_begun && !(frame->dt_s > 0.0)) /* no other mapping performed before */
        self->since_s = settles_s;
    self->has_begun = true;
    self->since_s = fmin(self->since_s + frame->dt_s, settles_s);
    *pull = (mrt_pull){.mode = MRT_ANCHORED};
    for (uint32_t i = 0; i < MRT_MAX_DOFS; ++i)
        pull->dof[i] = self->since_s < settles_s ? 0.0f : NAN;
    return MRT_OK;
}

static size_t save(mrt_plugin *self, void *out, size_t capacity)
{
    const double kept[2] = {self->has_begun ? 1.0 : 0.0, self->since_s};
    if (out && capacity >= sizeof kept)
        memcpy(out, kept, sizeof kept);
    return sizeof kept;
}

static mrt_result load(mrt_plugin *self, const void *bytes, size_t size)
{
    double kept[2];
    if (size != sizeof kept)
        return MRT_ERR_FORMAT;
    memcpy(kept, bytes, sizeof kept);
    if (!(kept[1] >= 0.0 && kept[1] <= settles_s))
        return MRT_ERR_FORMAT;
    *self = (mrt_plugin){.has_begun = kept[0] > 0.0, .since_s = kept[1]};
    return MRT_OK;
}

static const mrt_mapping mapping = {
    .activate = activate, .deactivate = do_nothing, .reset = reset, .process = process};
static const mrt_resume resume = {.save = save, .load = load};
static const mrt_interface interfaces[] = {
    {MRT_MAPPING, &mapping}, {MRT_RESUME, &resume}, {NULL, NULL}};
const mrt_plugin_type null_mapping_type = {
    .abi = MRT_ABI,
    .interfaces = interfaces,
    .id = "org.marotte.nothing",
    .name = "Nothing",
    .version = "1.0",
    .about = "The face rests, and only the pointer moves it.",
    .create = create,
    .destroy = destroy,
};
