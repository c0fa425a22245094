/* mesh/arkit.h - the 52 shapes of ARKit and the 9 turns that Live Link Face adds, by their names.
 * Leaves out who says them (face/face_weights.h) and files of them (io/export.h). Pure; any thread.
 */
#ifndef MAROTTE_MESH_ARKIT_H
#define MAROTTE_MESH_ARKIT_H
#include <stdbool.h>
#include <stdint.h>

enum { ARKIT_SHAPES = 52, ARKIT_CHANNELS = 61, ARKIT_NONE = ARKIT_CHANNELS };

/* "EyeBlinkLeft": in the order of the app's tables: its shapes, then turns of head and eyes. */
extern const char *const arkit_name[ARKIT_CHANNELS];
/* "jawOpen", "JawOpen", "jaw_open"; "eyeBlink_L" as EyeBlinkLeft. ARKIT_NONE: it is none of them.
 */
uint32_t arkit_find(const char *name);
/* The same name; or the same of the 52 shapes, whoever writes it. */
bool arkit_is_same_name(const char *a, const char *b);

#endif
