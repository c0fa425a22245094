/* stage/mapping/services.h - what a host offers beside its functions (mrt_host.service): folders,
 * the same in the program and in a mapping's own process; landmarks, to inputs, which are always in
 * the program. [main] unless marked. */
#ifndef MAROTTE_STAGE_MAPPING_SERVICES_H
#define MAROTTE_STAGE_MAPPING_SERVICES_H
#include "hand/hand.h"

/* A folder of this type's own below the person's settings, made if need be; "" after an
 * error. The type was checked: its id is no path. */
CHECKED mrt_result services_settings_folder(const char *type_id, char *out, size_t capacity,
                                            error *err);
/* MRT_FOLDERS, for a host whose `data` begins with the plugin's type (const mrt_plugin_type *). */
extern const mrt_folders services_folders;

/* What MRT_LANDMARKS is read with. Zeroed: nothing is there. */
typedef struct services_reader {
    hand_skeleton *skeleton[2];
} services_reader;
/* Once; again is fine. False: no memory. */
bool services_reader_init(services_reader *self);
void services_reader_finish(services_reader *self);
/* [any] As plugin.h says; a side that is none gives no confidence. */
void services_read_landmarks(const services_reader *self, const mrt_landmarks *seen,
                             mrt_hand_reading *reading);

#endif
