/* ui/window/app/camera_page.h - the camera's page (plugins/camera) as the program sees it: where it
 * is, and how it is shown. What it needs: camera_package.h. [main], or where marked any thread that
 * may block. */
#ifndef MAROTTE_UI_CAMERA_PAGE_H
#define MAROTTE_UI_CAMERA_PAGE_H
#include "base/error.h"

#include <limits.h>

enum { CAMERA_PAGE_PORT = 9130, CAMERA_PAGE_ADDRESS = 96 };
#define CAMERA_PAGE_PLUGIN "org.marotte.camera"

/* The port of an input, "camera" or "camera:9131,hand=left". */
uint16_t camera_page_port(const char *input_text);
/* "http://127.0.0.1:9130/TOKEN/". An error when no camera was ever opened here. */
CHECKED mrt_result camera_page_address(char out[CAMERA_PAGE_ADDRESS], uint16_t port, error *err);
/* [worker] Has the person's own browser open it (xdg-open, or what $MAROTTE_BROWSER names). Takes
 * up to two seconds. */
CHECKED mrt_result camera_page_show(uint16_t port, error *err);
/* [worker] Returns whether there is such a browser, as far as the system tells. */
bool camera_page_has_browser(void);

#endif
