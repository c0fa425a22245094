/* mesh/arkit.h - the names of the 52 shapes of ARKit, and of the 9 rotations of Live Link Face.
 * Leaves out computing their values (face/face_weights.h) and files of them (io/export.h). Pure.
 * [any] */
#ifndef MAROTTE_MESH_ARKIT_H
#define MAROTTE_MESH_ARKIT_H
#include <stdbool.h>
#include <stdint.h>

enum { ARKIT_SHAPES = 52, ARKIT_CHANNELS = 61, ARKIT_NONE = ARKIT_CHANNELS };

/* "EyeBlinkLeft": in the order of the app's tables: shapes, then rotations of head and eyes. */
extern const char *const arkit_name[ARKIT_CHANNELS];
/* Finds "jawOpen", "JawOpen", "jaw_open"; "eyeBlink_L" as EyeBlinkLeft. ARKIT_NONE: no such
 * name. */
uint32_t arkit_find(const char *name);
/* Returns whether the names are equal, or are spellings of the same of the 52 shapes. */
bool arkit_is_same_name(const char *a, const char *b);

#endif
