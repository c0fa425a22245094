/* window/app/kept_layouts.h - the three layouts of the open show: the one on the screen, and all of
 * them in the settings of this computer, by the path of the show. A show has no layout in its file,
 * so that the show of another person moves no panel. [main] */
#ifndef MAROTTE_UI_WINDOW_APP_KEPT_LAYOUTS_H
#define MAROTTE_UI_WINDOW_APP_KEPT_LAYOUTS_H
#include "window/app/arrangement.h"
#include "window/app/settings.h"

enum { KEPT_LAYOUT_SHOWS = 64 }; /* the settings keep the layouts of as many shows */

typedef struct kept_layouts {
    arrangement now;
    app_layout of; /* that `now` is */
    char show[20]; /* its name in the settings; "": of new shows */
} kept_layouts;

/* show_path NULL: no show. Those that the settings do not have are the ones for new shows, and
 * without them the layouts as they are at first. */
void kept_layouts_read(kept_layouts *self, const settings *from, const char *show_path);
/* Writes the layout that is on the screen, if it was changed. */
void kept_layouts_write(const kept_layouts *self, settings *to);
/* Writes the layout that is on the screen, and shows another one. */
void kept_layouts_switch(kept_layouts *self, settings *in, app_layout to);
/* The layout as it is at first. */
void kept_layouts_reset(kept_layouts *self);
/* New shows start with the three layouts of this one. */
void kept_layouts_use_for_new(const kept_layouts *self, settings *to);
/* The layouts of another show, of which this one is a copy. */
void kept_layouts_copy(kept_layouts *self, settings *in, const kept_layouts *from);

#endif
