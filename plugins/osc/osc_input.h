/* plugins/osc/osc_input.h - MRT_INPUT: hands, pedals and forwarded sources that others send. Says
 * what is heard as samples, notices when a sender is silent, lets its pedals up. Threads as
 * plugin.h says for each function. */
#ifndef MAROTTE_OSC_INPUT_H
#define MAROTTE_OSC_INPUT_H
#include <marotte/plugin.h>

/* In the order of the table of parameters. */
enum { OSC_PARAM_HAND = 0, OSC_PARAM_CONTENT, OSC_PARAM_SILENCE, OSC_PARAM_COUNT };

typedef struct osc_input osc_input;

osc_input *osc_input_create(const mrt_host *host); /* NULL: no memory */
void osc_input_destroy(osc_input *self);           /* NULL is fine */
mrt_result osc_input_open(osc_input *self, const char *address, const double *params);
const mrt_channel *osc_input_channels(osc_input *self, uint32_t *out_count);
mrt_result osc_input_read(osc_input *self, const double *params, int64_t deadline_ns,
                          mrt_sample *out_sample);
void osc_input_close(osc_input *self);

#endif
