/* io/arkit.h - the 52 shapes of ARKit and the 9 turns that Live Link Face adds, and which curves of
 * a clip say them: its own shapes and poses by their names, the jaw, lids, eyes and head by their
 * degrees of freedom. Leaves out a fit of the shapes that no curve says. Pure; any thread. */
#ifndef MAROTTE_IO_ARKIT_H
#define MAROTTE_IO_ARKIT_H
#include "io/export.h"
#include "mesh/arkit.h"

typedef struct arkit_map {
    struct {
        uint32_t curve; /* UINT32_MAX: nothing says it */
        double sign;    /* the side of the curve that says it; of a turn which way it counts */
    } of[ARKIT_CHANNELS];
    uint32_t shape_count, turn_count; /* that something says */
} arkit_map;

void arkit_map_find(arkit_map *out, const clip *c);
/* Of a frame: shapes 0..1; turns rad, to the face's own left, up, and to its left shoulder. 0 where
 * nothing says it. */
void arkit_values(double out[ARKIT_CHANNELS], const arkit_map *map, const clip *c, uint32_t frame);

/* The table of Live Link Face: Timecode as HH:MM:SS:FF.fff, BlendShapeCount, then arkit_name. */
CHECKED mrt_result livelink_write(const char *path, const clip *c, const export_progress *progress,
                                  error *err);

/* .vrma, VRM animation 1.0: the turns of neck, head (a bone "head", else "skull") and jaw, the gaze
 * as the middle of both eyes', and as expressions what arkit_map_find finds: each by ARKit's name,
 * and aa, blinkLeft and blinkRight. */
CHECKED mrt_result vrma_write(const char *path, const clip *c, const export_progress *progress,
                              error *err);

#endif
