/* stage/nothing.h - the mapping that maps nothing: whatever the hands do, the face rests, and only
 * the pointer moves it. For performances without a mapping, live and performed again. Const data.
 */
#ifndef MAROTTE_STAGE_NOTHING_H
#define MAROTTE_STAGE_NOTHING_H
#include <marotte/plugin.h>

extern const mrt_plugin_type nothing_type; /* "org.marotte.nothing" */

#endif
