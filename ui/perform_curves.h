/* perform_curves.h - a face performed by a table of curves (io/curves.h), row by row, in place of
 * hands: what `--export FILE.csv` has written, with or without changes, or what another program
 * has. [main] */
#ifndef MAROTTE_UI_PERFORM_CURVES_H
#define MAROTTE_UI_PERFORM_CURVES_H
#include "perform_options.h"

/* `options` has curves. Tells what it did. */
CHECKED mrt_result perform_curves(const perform_options *options, facts *told, error *err);

#endif
