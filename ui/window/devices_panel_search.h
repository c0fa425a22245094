/* window/devices_panel_search.h - what is plugged in and which calibrations there are, looked for
 * in the background: a thread of its own with its own instances of the plugins asks every two
 * seconds while somebody wants to know. [main] */
#ifndef MAROTTE_UI_WINDOW_DEVICES_PANEL_SEARCH_H
#define MAROTTE_UI_WINDOW_DEVICES_PANEL_SEARCH_H
#include "hand/calibration_folder.h"
#include "stage/device_list.h"

typedef struct devices_search devices_search;

/* plugins and log must outlive it. NULL: no memory, or no thread. */
devices_search *devices_search_create(const plugin_list *plugins, log_queue *log);
void devices_search_destroy(devices_search *self); /* waits for a look that goes on; NULL is fine */

/* Somebody looks: goes on for some seconds. Never waits. */
void devices_search_want(devices_search *self);
/* As soon as possible: something was plugged in, opened or saved. */
void devices_search_again(devices_search *self);

/* The newest; until the next call. Never waits. */
typedef struct devices_seen {
    bool is_known; /* a first look is done */
    const device_list *devices;
    const calibration_list *calibrations;
    const char *note; /* what could not be read; "" */
} devices_seen;
devices_seen devices_search_look(devices_search *self);

#endif
