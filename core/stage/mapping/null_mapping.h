/* stage/mapping/null_mapping.h - the null mapping: it ignores the hands, the face rests, and only
 * the pointer moves it. For performances without a mapping, live and replayed. Const data. */
#ifndef MAROTTE_STAGE_NULL_MAPPING_H
#define MAROTTE_STAGE_NULL_MAPPING_H
#include <marotte/plugin.h>

extern const mrt_plugin_type null_mapping_type; /* "org.marotte.nothing" */

#endif
