/* stage/input/tap.h - every sample of one input for somebody beside the performance, who may be
 * slower than it: the frame thread offers what it performs, [main] says of which input it wants to
 * hear, and takes. Neither waits; what is not taken for some seconds is left out. */
#ifndef MAROTTE_STAGE_TAP_H
#define MAROTTE_STAGE_TAP_H
#include <marotte/plugin.h>

enum { TAP_SAMPLES = 2048 };

typedef struct tap tap;
tap *tap_create(void);       /* [main] NULL: no memory */
void tap_destroy(tap *self); /* [main] NULL is fine */
/* [main] From the next sample of this input on; UINT32_MAX: of none. What was of another input is
 * not given any more. */
void tap_listen(tap *self, uint32_t input);
/* [main] The oldest; false: none now. */
bool tap_take(tap *self, mrt_sample *out);
/* [frame] */
void tap_offer(tap *self, uint32_t input, const mrt_sample *sample);

#endif
