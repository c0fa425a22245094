/* hands/mapping.h - what every mapping of this program does the same: the ends of an instance that
 * is one block of memory, and how an anchored pull is written. [frame] unless said otherwise. */
#ifndef MAROTTE_PLUGINS_HANDS_MAPPING_H
#define MAROTTE_PLUGINS_HANDS_MAPPING_H
#include <marotte/plugin.h>

/* For mrt_plugin_type and mrt_mapping. [main] */
void mapping_destroy(mrt_plugin *self);    /* of one calloc */
void mapping_deactivate(mrt_plugin *self); /* nothing was allocated for the face */

/* The pull is anchored, with these vectors. Its anchor changes only where one begins elsewhere, or
 * pulls another contact, than before. radius_mm: 0 as the rig says. */
void mapping_pull(mrt_pull *pull, const mrt_vector *vector, uint32_t count, float radius_mm);

#endif
