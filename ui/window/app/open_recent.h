/* window/app/open_recent.h - the files that were opened recently, in the settings. [main] */
#ifndef MAROTTE_UI_WINDOW_APP_OPEN_RECENT_H
#define MAROTTE_UI_WINDOW_APP_OPEN_RECENT_H
#include "window/app/settings.h"

enum { OPEN_RECENT_MAX = 6 };
/* The newest first. Valid until the next change of the settings. */
uint32_t open_recent(const settings *from, const char *out[OPEN_RECENT_MAX]);
void open_recent_add(settings *to, const char *path);
/* Removes the files that a text names, such as the input "log:hand.csv,loop=1": they are broken. */
void open_recent_remove(settings *to, const char *text);

#endif
