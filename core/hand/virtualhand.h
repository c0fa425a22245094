/* hand/virtualhand.h - calibrations of VirtualHand 1.x (Virtual Technologies): a text file with one
 * offset and gain per sensor, angle = gain * (raw - offset), and the shape of the hand in
 * centimetres (research/hardware.md 2.2). Calibrations of its successor's Device Configuration
 * Utility have an unpublished layout, and are rejected for that reason. [main] */
#ifndef MAROTTE_HAND_VIRTUALHAND_H
#define MAROTTE_HAND_VIRTUALHAND_H
#include "hand/calibration_file.h"

/* side: the hand, if the file does not contain it; MRT_NO_HAND: such a file is rejected. `name` is
 * the name of the file, for messages. Sets everything in `out` except the person's name and the
 * date; its note lists oddities. On failure `out` is empty. Directions are those of the glove's
 * sensors, which are the same on every glove: flexion counts up, spreads count down. The gains of
 * the file are not used for that, because its angles have other signs. */
CHECKED mrt_result virtualhand_parse(calibration_file *out, const void *bytes, size_t size,
                                     const char *name, uint32_t side, error *err);
CHECKED mrt_result virtualhand_read(calibration_file *out, const char *path, uint32_t side,
                                    error *err);

#endif
