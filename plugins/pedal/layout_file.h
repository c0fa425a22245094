/* pedal/layout_file.h - a layout that was learnt, kept in the user's configuration folder:
 * marotte/pedals/05f3_00ff.layout below $XDG_CONFIG_HOME or ~/.config. Leaves out its text
 * (layout_text.h). [main] [input]: may block on the disk. */
#ifndef MAROTTE_PLUGINS_PEDAL_LAYOUT_FILE_H
#define MAROTTE_PLUGINS_PEDAL_LAYOUT_FILE_H
#include "layout_text.h"

enum { LAYOUT_FILE_PATH = 512, LAYOUT_FILE_REASON = LAYOUT_TEXT_REASON + LAYOUT_FILE_PATH + 64 };

/* False: neither XDG_CONFIG_HOME nor HOME names a folder. */
bool layout_file_path(char out[LAYOUT_FILE_PATH], uint16_t vendor, uint16_t product);
/* MRT_OK; MRT_END: there is none; < 0: `reason` says why it cannot be used. */
mrt_result layout_file_load(layout *out, uint16_t vendor, uint16_t product,
                            char reason[LAYOUT_FILE_REASON]);
/* Makes the folders; what was there before stays until the new file is whole. */
mrt_result layout_file_store(const layout *from, char reason[LAYOUT_FILE_REASON]);

#endif
