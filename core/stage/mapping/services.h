/* stage/mapping/services.h - what a host offers beside its functions (mrt_host.service), the same
 * in the program and in a plugin's own process. [main] */
#ifndef MAROTTE_STAGE_MAPPING_SERVICES_H
#define MAROTTE_STAGE_MAPPING_SERVICES_H
#include "base/error.h"

/* A folder of this type's own below the person's settings (or cache), made if need be; "" after an
 * error. The type was checked: its id is no path. */
CHECKED mrt_result services_settings_folder(const char *type_id, char *out, size_t capacity,
                                            error *err);
CHECKED mrt_result services_cache_folder(const char *type_id, char *out, size_t capacity,
                                         error *err);

#endif
