#include "stage/nothing.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct mrt_plugin {
    char unused;
};

static const unsigned char state[4] = {'n', 'o', 't', 'h'}; /* it has none */

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

/* Anchored, so that what was pulled before leaves; idle would keep it. */
static mrt_result process(mrt_plugin *self, const mrt_frame *frame, mrt_pull *pull)
{
    (void)self, (void)frame;
    *pull = (mrt_pull){.mode = MRT_ANCHORED};
    for (uint32_t i = 0; i < MRT_MAX_DOFS; ++i)
        pull->dof[i] = NAN;
    return MRT_OK;
}

static size_t save(mrt_plugin *self, void *out, size_t capacity)
{
    (void)self;
    if (out && capacity >= sizeof state)
        memcpy(out, state, sizeof state);
    return sizeof state;
}

static mrt_result load(mrt_plugin *self, const void *bytes, size_t size)
{
    (void)self;
    return size == sizeof state && memcmp(bytes, state, size) == 0 ? MRT_OK : MRT_ERR_FORMAT;
}

static const mrt_mapping mapping = {
    .activate = activate, .deactivate = do_nothing, .reset = do_nothing, .process = process};
static const mrt_resume resume = {.save = save, .load = load};
static const mrt_interface interfaces[] = {
    {MRT_MAPPING, &mapping}, {MRT_RESUME, &resume}, {NULL, NULL}};
const mrt_plugin_type nothing_type = {
    .abi = MRT_ABI,
    .interfaces = interfaces,
    .id = "org.marotte.nothing",
    .name = "Nothing",
    .version = "1.0",
    .about = "The face rests, and only the pointer moves it.",
    .create = create,
    .destroy = destroy,
};
