/* window/app/remote.h - remote control of the stage by a phone, a Stream Deck or a script: OSC by
 * UDP and JSON by WebSocket at one port. Commands do what keys do, and the result is sent back in
 * the next frame. Off by default. It accepts only this computer unless told otherwise, and then
 * requires a pairing code. It never blocks. Leaves out the message format (remote_wire.h). [main]
 */
#ifndef MAROTTE_UI_WINDOW_APP_REMOTE_H
#define MAROTTE_UI_WINDOW_APP_REMOTE_H
#include "window/app/app.h"

typedef struct remote remote;

enum { REMOTE_PORT = 9110 };
/* Limits of messages of each client and of datagrams in one frame. The rest waits in the sockets,
 * so a client that sends without a pause delays neither the frame nor the other clients. */
enum { REMOTE_MESSAGES_A_LOOK = 8, REMOTE_DATAGRAMS_A_LOOK = 32 };

remote *remote_create(app *of);    /* off; NULL: no memory */
void remote_destroy(remote *self); /* NULL is fine */

/* "[HOST:]PORT", where HOST is a numeric address of this computer; "": off. If another program uses
 * the port, this is reported once, and retried until the port is free. */
CHECKED mrt_result remote_listen(remote *self, const char *address, error *err);
/* Whether only this computer reaches it there, or nobody: the others need a code (remote_wire.h),
 * which is drawn once and kept in the settings. */
bool remote_is_local(const char *address);
void remote_renew_code(remote *self);
/* Once a frame. */
void remote_update(remote *self, double dt_s);

app_remote_status remote_status_of(const remote *self);

#endif
