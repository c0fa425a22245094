/* window/app/camera_setup.h - does what the camera needs and what takes time, on a thread of its
 * own: looks whether the hand tracker and a browser are here, downloads the tracker, and opens the
 * camera's page. [main] */
#ifndef MAROTTE_UI_CAMERA_SETUP_H
#define MAROTTE_UI_CAMERA_SETUP_H
#include "base/error.h"

typedef struct camera_setup camera_setup;
camera_setup *camera_setup_create(void);       /* NULL: no memory or no thread */
void camera_setup_destroy(camera_setup *self); /* cancels a download; accepts NULL */

typedef struct camera_setup_state {
    bool is_known; /* the values below were looked up */
    bool has_tracker, has_browser;
    bool is_fetching;
    uint64_t done, whole; /* bytes of the download; whole 0: the files are being checked */
    error trouble;        /* of the last download, or of the page; "": none */
} camera_setup_state;
camera_setup_state camera_setup_now(camera_setup *self);

/* Checks the tracker, and downloads it if it is missing or damaged. */
void camera_setup_fetch(camera_setup *self);
void camera_setup_cancel(camera_setup *self);
/* Opens the page of that port in the browser, after a download that goes on. */
void camera_setup_show(camera_setup *self, uint16_t port);
void camera_setup_forget_trouble(camera_setup *self);

#endif
