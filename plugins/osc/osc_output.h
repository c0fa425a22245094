/* plugins/osc/osc_output.h - MRT_OUTPUT: forwards samples of inputs to another marotte without loss
 * of a bit. A thread of its own tells the channels every 500 ms and says the last sample again
 * after 250 ms without a newer one, so that who listens can join late, hears that the sender is
 * there, and gets a pedal's release even if its datagram was lost. Threads as plugin.h says. */
#ifndef MAROTTE_OSC_OUTPUT_H
#define MAROTTE_OSC_OUTPUT_H
#include <marotte/plugin.h>

typedef struct osc_output osc_output;

osc_output *osc_output_create(const mrt_host *host); /* NULL: no memory */
void osc_output_destroy(osc_output *self);           /* NULL is fine */
mrt_result osc_output_open(osc_output *self, const char *address);
/* A network that fails for a while is said once and is no error: the next sample may pass. */
mrt_result osc_output_write(osc_output *self, const char *source, const mrt_channel *channels,
                            const mrt_sample *sample);
void osc_output_close(osc_output *self);

#endif
