/* stage/mapping/services.h - services of a host (mrt_host.service): folders, which are the same in
 * the program and in an isolated plugin; and landmarks, only for inputs, which always run in the
 * program. [main] unless marked. */
#ifndef MAROTTE_STAGE_MAPPING_SERVICES_H
#define MAROTTE_STAGE_MAPPING_SERVICES_H
#include "hand/hand.h"

/* Returns the settings folder of this type and creates it if necessary. "" after an error. The id
 * was checked: it cannot be a path. */
CHECKED mrt_result services_settings_folder(const char *type_id, char *out, size_t capacity,
                                            error *err);
/* MRT_FOLDERS, for a host whose `data` points to a struct that begins with the plugin's type (const
 * mrt_plugin_type *). */
extern const mrt_folders services_folders;

/* State of MRT_LANDMARKS. Zeroed: not initialised. */
typedef struct services_reader {
    hand_skeleton *skeleton[2];
} services_reader;
/* Does nothing if it is already initialised. False: out of memory. */
bool services_reader_init(services_reader *self);
void services_reader_finish(services_reader *self);
/* [any] See plugin.h. An invalid side gives confidence 0. */
void services_read_landmarks(const services_reader *self, const mrt_landmarks *seen,
                             mrt_hand_reading *reading);

#endif
