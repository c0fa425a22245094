/* hand/virtualhand.h - calibrations of VirtualHand 1.x (Virtual Technologies): a text file of one
 * offset and gain per sensor, angle = gain * (raw - offset), and the hand's shape in centimetres
 * (research/hardware.md 2.2). Calibrations of its successor's Device Configuration Utility have
 * another layout, which nobody has published: they are refused with that reason. [main] */
#ifndef MAROTTE_HAND_VIRTUALHAND_H
#define MAROTTE_HAND_VIRTUALHAND_H
#include "hand/calibration_file.h"

/* side: whose hand it is if the file does not say so; MRT_NO_HAND: then it is refused. `name` is
 * the file's, for messages. Everything of `out` is set but the person's name and the date; what was
 * odd is in its note. On failure `out` is empty.
 * Directions are those of the glove's sensors, which are the same on every glove (flexion counts
 * up, spreads count down), not those of the file's gains, whose angles have other signs. */
CHECKED mrt_result virtualhand_parse(calibration_file *out, const void *bytes, size_t size,
                                     const char *name, uint32_t side, error *err);
CHECKED mrt_result virtualhand_read(calibration_file *out, const char *path, uint32_t side,
                                    error *err);

#endif
