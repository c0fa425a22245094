/* io/arkit.h - files of what a clip says in ARKit's names (clip_add_arkit). Leaves out who finds
 * that: face/face_weights.h. [main] */
#ifndef MAROTTE_IO_ARKIT_H
#define MAROTTE_IO_ARKIT_H
#include "io/export.h"

/* The table of Live Link Face: Timecode as HH:MM:SS:FF.fff, BlendShapeCount, then arkit_name. */
CHECKED mrt_result livelink_write(const char *path, const clip *c, const export_progress *progress,
                                  error *err);

/* .vrma, VRM animation 1.0: the turns of neck, head (a bone "head", else "skull") and jaw, the gaze
 * as the middle of both eyes', and as expressions what the clip says: each by ARKit's name,
 * and aa, blinkLeft and blinkRight. */
CHECKED mrt_result vrma_write(const char *path, const clip *c, const export_progress *progress,
                              error *err);

#endif
