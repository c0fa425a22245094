/* osc.c - the plugin "org.marotte.osc": hands and pedals from the network (input), and what inputs
 * measure to another marotte (output). README.md documents every message. */
#include "osc_input.h"
#include "osc_output.h"

#include <stdlib.h>

struct mrt_plugin {
    osc_input *input;
    osc_output *output;
};

static mrt_result input_open(mrt_plugin *self, const char *address, const double *params)
{
    return osc_input_open(self->input, address, params);
}

static const mrt_channel *input_channels(mrt_plugin *self, uint32_t *out_count)
{
    return osc_input_channels(self->input, out_count);
}

static mrt_result input_read(mrt_plugin *self, const double *params, int64_t deadline_ns,
                             mrt_sample *out_sample)
{
    return osc_input_read(self->input, params, deadline_ns, out_sample);
}

static void input_close(mrt_plugin *self)
{
    osc_input_close(self->input);
}

static mrt_result output_open(mrt_plugin *self, const char *address, const double *params)
{
    (void)params;
    return osc_output_open(self->output, address);
}

static mrt_result output_write(mrt_plugin *self, const char *source, const mrt_channel *channels,
                               const mrt_sample *sample)
{
    return osc_output_write(self->output, source, channels, sample);
}

static void output_close(mrt_plugin *self)
{
    osc_output_close(self->output);
}

static void osc_destroy(mrt_plugin *self)
{
    if (!self)
        return;
    osc_input_destroy(self->input);
    osc_output_destroy(self->output);
    free(self);
}

static mrt_plugin *osc_create(const mrt_host *host)
{
    mrt_plugin *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->input = osc_input_create(host);
    self->output = osc_output_create(host);
    if (self->input && self->output)
        return self;
    osc_destroy(self);
    return NULL;
}

static const char *const hand_label[] = {"left", "right", NULL};
static const char *const content_label[] = {"hand and pedals", "hand and wrist", "pedals",
                                            "controls", NULL};

static const mrt_param params[OSC_PARAM_COUNT] = {
    [OSC_PARAM_HAND] = {1, MRT_PARAM_STEPPED, "hand", "Network", "",
                        "Whose hand the messages of other software are taken for", MRT_LEFT,
                        MRT_RIGHT, MRT_RIGHT, hand_label},
    [OSC_PARAM_CONTENT] = {2, MRT_PARAM_STEPPED, "content", "Network", "",
                           "Which channels the messages of other software give", 0, 3, 0,
                           content_label},
    [OSC_PARAM_SILENCE] = {3, 0, "silence", "Network", "s",
                           "Pedals go up after this silence, and after three the sender is lost; 0 "
                           "if it speaks only when something changes",
                           0, 60, 1, NULL},
};

static const mrt_input input = {input_open, input_channels, input_read, input_close, 0};
static const mrt_output output = {output_open, output_write, output_close};

static const mrt_interface interfaces[] = {
    {MRT_INPUT, &input}, {MRT_OUTPUT, &output}, {NULL, NULL}};

static const mrt_plugin_type type = {
    MRT_ABI,
    OSC_PARAM_COUNT,
    params,
    interfaces,
    "org.marotte.osc",
    "Network",
    MAROTTE_VERSION,
    "Hands and pedals over the network: from trackers that speak OSC or VMC, and between marottes",
    osc_create,
    osc_destroy,
};

MRT_EXPORT const mrt_plugin_type *const marotte_plugins[] = {&type, NULL};
