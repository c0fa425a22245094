/* stage/take/identity.h - what a show remembers of plugins and faces, so that a change is
 * noticed later: names, versions, and the SHA-256 of files. [main] */
#ifndef MAROTTE_STAGE_IDENTITY_H
#define MAROTTE_STAGE_IDENTITY_H
#include "stage/mapping/instance.h"
#include "stage/mapping/plugins.h"
#include "stage/perform/face_file.h"
#include "take/take.h"

/* "id version sha256": see take.h; "-" for a library that cannot be read. To be freed; NULL: no
 * memory. */
char *identity_of_plugin(const plugin_list *plugins, const mrt_plugin_type *type);

/* Into rig, rig_hash, mesh_hash, rig_json and unit_mm; what was there is freed. */
CHECKED mrt_result identity_of_face(take_performance *out, const face_file *file, const char *path,
                                    double unit_mm, error *err);

/* The values that a mapping's parameters have now. */
void identity_of_params(take_performance *out, const instance *mapping);

#endif
