/* One plugin per rule that it breaks: BROKEN_<RULE> is defined by the build. Each is a mapping (and
 * an input) that is right but for that rule. */
#include <marotte/plugin.h>

#include <math.h>
#include <stdlib.h>

struct mrt_plugin {
    int frames;
    uint32_t sequence;
};

static mrt_plugin *create(const mrt_host *host)
{
#ifdef BROKEN_CREATE
    host->log(host, MRT_LOG_ERROR, "no licence for this machine");
    return NULL;
#else
    (void)host;
    return calloc(1, sizeof(mrt_plugin));
#endif
}

static void destroy(mrt_plugin *self)
{
    free(self);
}

static mrt_result activate(mrt_plugin *self, const mrt_face *face)
{
    (void)self;
    (void)face;
    return MRT_OK;
}

static void deactivate(mrt_plugin *self)
{
    (void)self;
}

static void reset(mrt_plugin *self)
{
    self->frames = 0;
}

static mrt_result process(mrt_plugin *self, const mrt_frame *frame, mrt_pull *pull)
{
    (void)frame;
    self->frames += 1;
    pull->mode = MRT_ANCHORED;
    pull->anchor = 1;
    pull->count = 1;
    pull->vector[0] = (mrt_vector){{0, 0, 0}, {0, 0, 1}, 0};
#ifdef BROKEN_NAN
    if (self->frames > 3)
        pull->vector[0].end.x = NAN;
#endif
#ifdef BROKEN_MANY
    pull->count = MRT_MAX_VECTORS + 1;
#endif
#ifdef BROKEN_RADIUS
    pull->radius_mm = -5.0f;
#endif
#ifdef BROKEN_REACH
    pull->vector[0].end.x = 1e9f;
#endif
#ifdef BROKEN_RESULT
    return MRT_ERR_IO;
#else
    return MRT_OK;
#endif
}

static mrt_result open_input(mrt_plugin *self, const char *address, const double *params)
{
    (void)self;
    (void)address;
    (void)params;
    return MRT_OK;
}

static const mrt_channel *channels(mrt_plugin *self, uint32_t *out_count)
{
    (void)self;
    static const mrt_channel channel = {"thumb", "rad", MRT_CH_ANGLE, MRT_RIGHT, -3, 3};
    *out_count = 1;
    return &channel;
}

static mrt_result read_input(mrt_plugin *self, const double *params, int64_t deadline_ns,
                             mrt_sample *out)
{
    (void)params;
    (void)deadline_ns;
    if (self->sequence == 20)
        return MRT_END;
    out->sequence = self->sequence++;
    out->count = 1;
    out->time_ns = (int64_t)out->sequence * 10000000;
    out->value[0] = 0.1f;
    return MRT_OK;
}

static void close_input(mrt_plugin *self)
{
    (void)self;
}

static const mrt_mapping mapping = {activate, deactivate, reset, process};
static const mrt_input input = {open_input, channels, read_input, close_input, MRT_INPUT_RECORDED};
static const mrt_interface interfaces[] = {
    {MRT_MAPPING, &mapping}, {MRT_INPUT, &input}, {NULL, NULL}};

#ifdef BROKEN_PARAM
static const mrt_param params[] = {{1, 0, "Gain", "", "", "", 1, 0, 0, NULL}};
#endif

static const mrt_plugin_type broken = {
#ifdef BROKEN_ABI
    MRT_ABI + 6,
#else
    MRT_ABI,
#endif
#ifdef BROKEN_PARAM
    1,
    params,
#else
    0,
    NULL,
#endif
    interfaces,
    "org.example.broken",
    "Broken",
    "1",
    "Breaks one rule.",
    create,
    destroy};

#ifdef BROKEN_SYMBOL
MRT_EXPORT const mrt_plugin_type *const another_name[] = {&broken, NULL};
#else
MRT_EXPORT const mrt_plugin_type *const marotte_plugins[] = {&broken, NULL};
#endif
