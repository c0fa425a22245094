/* stage/input/tap.h - copies every sample of one input to a reader that may be slower than the
 * performance. The frame thread offers the performed samples. [main] selects the input and reads.
 * Neither waits. Samples that are not read for some seconds are dropped. */
#ifndef MAROTTE_STAGE_TAP_H
#define MAROTTE_STAGE_TAP_H
#include <marotte/plugin.h>

enum { TAP_SAMPLES = 2048 };

typedef struct tap tap;
tap *tap_create(void);       /* [main] NULL: out of memory */
void tap_destroy(tap *self); /* [main] accepts NULL */
/* [main] Selects the input, beginning with its next sample; UINT32_MAX: none. Samples of the
 * previous input are discarded. */
void tap_select(tap *self, uint32_t input);
/* [main] Removes the oldest sample. False: none now. */
bool tap_pop(tap *self, mrt_sample *out);
/* [frame] */
void tap_push(tap *self, uint32_t input, const mrt_sample *sample);

#endif
