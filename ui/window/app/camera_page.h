/* ui/window/app/camera_page.h - the camera's page (plugins/camera) as the program sees it: where it
 * is, how it is shown, and whether the package is there that it needs, which `marotte camera
 * --setup` fetches. [main] */
#ifndef MAROTTE_UI_CAMERA_PAGE_H
#define MAROTTE_UI_CAMERA_PAGE_H
#include "base/error.h"

#include <limits.h>

enum { CAMERA_PAGE_PORT = 9130, CAMERA_PAGE_ADDRESS = 96 };
#define CAMERA_PAGE_PLUGIN  "org.marotte.camera"
#define CAMERA_PAGE_VERSION "0.4.1675469240" /* of @mediapipe/hands */

/* The port of an input, "camera" or "camera:9131,hand=left". */
uint16_t camera_page_port(const char *input_text);
/* "http://127.0.0.1:9130/TOKEN/". An error when no camera was ever opened here. */
CHECKED mrt_result camera_page_address(char out[CAMERA_PAGE_ADDRESS], uint16_t port, error *err);
/* Has the person's own browser open it (xdg-open, or what $MAROTTE_BROWSER names). */
CHECKED mrt_result camera_page_show(uint16_t port, error *err);

/* Where the package lies, below the folder that npm gets. */
CHECKED mrt_result camera_page_package(char out[PATH_MAX], error *err);
bool camera_page_has_package(void);

#endif
