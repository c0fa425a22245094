/* window/app/remote.h - the stage done from afar, whoever has the keyboard: OSC by UDP, JSON by
 * WebSocket, both at one port, so that a phone, a Stream Deck or a script is an assistant. What is
 * said does what the stage's keys do, and is answered in the next frame with what happened. Off
 * until it is switched on; of this computer alone unless told, and then with a code. It never
 * waits. Leaves out the bytes (remote_wire.h). [main] */
#ifndef MAROTTE_UI_WINDOW_APP_REMOTE_H
#define MAROTTE_UI_WINDOW_APP_REMOTE_H
#include "window/app/app.h"

typedef struct remote remote;

enum { REMOTE_PORT = 9110 };
/* At most so many messages of each client, and so many datagrams, are handled in one frame: the
 * rest waits in the sockets, and nobody who sends without a pause holds the others or the frame. */
enum { REMOTE_MESSAGES_A_LOOK = 8, REMOTE_DATAGRAMS_A_LOOK = 32 };

remote *remote_create(app *of);    /* off; NULL: no memory */
void remote_destroy(remote *self); /* NULL is fine */

/* "[HOST:]PORT", HOST this computer's own address in numbers; "": off. A port that another program
 * has is said once and tried again until it is free. */
CHECKED mrt_result remote_listen(remote *self, const char *address, error *err);
/* Whether only this computer reaches it there, or nobody: the others need a code (remote_wire.h),
 * which is drawn once and kept in the settings. */
bool remote_is_local(const char *address);
void remote_renew_code(remote *self);
/* Once a frame. */
void remote_update(remote *self, double dt_s);

app_remote_status remote_status_of(const remote *self);

#endif
