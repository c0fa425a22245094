/* window/app/remote_wire.h - parses commands of the remote control, from an OSC message or the JSON
 * text of a WebSocket message, and decides which HTTP requests are allowed. The sender is not
 * trusted. Pure. Leaves out what commands do, and sockets (remote.h). */
#ifndef MAROTTE_UI_WINDOW_APP_REMOTE_WIRE_H
#define MAROTTE_UI_WINDOW_APP_REMOTE_WIRE_H
#include "osc_wire.h"
#include "web.h"
#include "window/app/action.h"

enum { REMOTE_NAME = 64, REMOTE_WHY = 200, REMOTE_CODE = 8 };
#define REMOTE_OSC_PREFIX  "/marotte/remote/"
#define REMOTE_FADE_MOST_S 10.0

typedef enum remote_verb {
    REMOTE_NOTHING = 0, /* a button that was let go */
    REMOTE_RECORD,      /* begins only */
    REMOTE_STOP,        /* ends what is recorded; else what plays */
    REMOTE_MARK,
    REMOTE_EXPRESSION, /* `name` goes to `amount` within fade_s; "": all ease out */
    REMOTE_PRESET,     /* of the mapping that performs: `name` */
    REMOTE_STATUS,
    REMOTE_ACTION /* as a key of the stage does: `of`, of the performance, transport or view */
} remote_verb;

typedef struct remote_command {
    remote_verb verb;
    action of;
    char word[24];          /* the received verb, for the answer */
    char name[REMOTE_NAME]; /* printable; "" */
    double amount;          /* 0..1; 1 */
    double fade_s;          /* 0..REMOTE_FADE_MOST_S; 0.3 */
    int64_t id;             /* of a JSON text, for its answer */
    bool has_id;
} remote_command;

/* ---- pairing code where the network can reach the remote control: REMOTE_CODE letters, the first
 * part of an OSC address after REMOTE_OSC_PREFIX and of a WebSocket path. "": no code required ----
 */

#define REMOTE_CODE_LETTERS "0123456789abcdefghjkmnpqrstvwxyz" /* 32; none looks like another */
bool remote_is_code(const char *text);
/* Whether the address has this code; in a time that does not tell where it differs. */
bool remote_osc_has_code(const char *address, const char *code);

/* REMOTE_OSC_PREFIX [CODE/] VERB [/NAME], with NAME as a text instead, then numbers: of an
 * expression its amount and fade in s; of another verb 0 is a button that is let go. False: `why`
 * is one line. */
bool remote_command_of_osc(remote_command *out, const osc_message *message, const char *code,
                           char why[REMOTE_WHY]);
/* {"do": "expression", "name": "smile", "amount": 1, "fade_s": 0.3, "id": 7}; no other key. */
bool remote_command_of_json(remote_command *out, const char *text, size_t size,
                            char why[REMOTE_WHY]);

/* 101: a WebSocket; 200: the page; 403, 404. The host must be this computer or, with a pairing
 * code, a numeric address, because a name could belong to a foreign server. An origin must be the
 * same host. The path is "/" or "/CODE/". */
int remote_request_judge(const web_request *request, uint16_t port, const char *code);

#endif
