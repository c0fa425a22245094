/* hand/calibration_keep.h - a calibration that was made takes the place of one that was kept: its
 * keys that nobody knows stay, and what is no calibration is not overwritten. [main] */
#ifndef MAROTTE_HAND_CALIBRATION_KEEP_H
#define MAROTTE_HAND_CALIBRATION_KEEP_H
#include "hand/calibration_file.h"

/* What stands at `path` now, to be finished; empty: nothing. An error: it is no calibration. */
CHECKED mrt_result calibration_keep_old(calibration_file *out, const char *path, error *err);
/* Name, date of now and hand length; NULL, "" and 0: the old one's. */
void calibration_keep_sign(calibration_file *made, const calibration_file *old, const char *name,
                           double hand_length_mm);
CHECKED mrt_result calibration_keep_write(calibration_file *made, const calibration_file *old,
                                          const char *path, error *err);

#endif
