/* stage/perform/life_input.h - the input of life (perform/life.h): ticks with the strengths and the
 * seed, which are its parameters. It is built in, and waits only through the host, so it runs on
 * any clock. While all strengths are 0 it rests, after the time in which they ease out. Leaves out
 * what the ticks do. Const data. */
#ifndef MAROTTE_STAGE_LIFE_INPUT_H
#define MAROTTE_STAGE_LIFE_INPUT_H
#include <marotte/plugin.h>

/* The parameters: the strengths, in the order of life_kind, the seed, and the length. */
enum { LIFE_PARAM_SECONDS = 5, LIFE_PARAMS };
extern const mrt_plugin_type life_input_type; /* LIFE_ID */

#endif
