/* window/mapping_panel_pedal_table.h - which parameters of a mapping say which pedal does what: the
 * stepped ones from 0 (none) to 4 whose name ends in "pedal" ("Anchor pedal"). Pure. */
#ifndef MAROTTE_UI_WINDOW_MAPPING_PANEL_PEDAL_TABLE_H
#define MAROTTE_UI_WINDOW_MAPPING_PANEL_PEDAL_TABLE_H
#include <marotte/plugin.h>

enum { PEDAL_MEANING = 64 };
/* False: it is no such parameter. out: "Anchor". */
bool pedal_table_meaning(const mrt_param *param, char out[PEDAL_MEANING]);
/* "Anchor, Hold": what pedal 1..4 does by these values (param_count); "" nothing. */
void pedal_table_words(const mrt_plugin_type *type, const double *values, uint32_t pedal, char *out,
                       size_t capacity);

#endif
