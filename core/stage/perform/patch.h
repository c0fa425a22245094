/* stage/perform/patch.h - a patch: which channel of which input moves what, and how. A connection
 * takes a raw channel (a fader, a stick, a phone's shape, a sensor), brings it from its range to
 * that of its target along a curve, smooths it, and waits until it is picked up. Plain data and
 * pure functions. Leaves out what the targets are on a face (patch_bay.h) and files (patch_file.h).
 *
 *   n = (raw - in low) / (in high - in low)           0..1, held at its ends; where in low < 0 < in
 *                                                     high -1..1 with 0 at raw 0
 *   c = sign(n) ease(bend(|n|))                       Schlick, Fast Alternatives to Perlin's Bias
 *                                                     and Gain Functions, Graphics Gems IV (1994)
 *   wanted = out low + c (out high - out low); of -1..1 from rest to out low, and to out high
 *   value += dt / (smooth + dt) (wanted - value), from the first sample's on
 *
 * No sine, power or exponential: the same bits on every machine. Any thread. */
#ifndef MAROTTE_STAGE_PATCH_H
#define MAROTTE_STAGE_PATCH_H
#include "base/error.h"

enum { PATCH_CONNECTIONS_MAX = 64, PATCH_NAME = 64 };

typedef enum patch_kind {
    PATCH_NOTHING = 0,
    PATCH_PARAM,   /* of the mapping, by its key as in --map: "smile", "placement.up" */
    PATCH_DOF,     /* degree of freedom of a bone: "jaw.open" */
    PATCH_CONTACT, /* "mouth.corner.l", along `way` */
    PATCH_POSE,    /* of the rig, by its name: all its contacts and degrees of freedom */
    PATCH_ACTION,  /* of the transport: patch_action_names */
    PATCH_SHAPE,   /* the head's own of that name, else the rig's pose: "mouthSmileLeft" */
    PATCH_KINDS
} patch_kind;
extern const char *const patch_kind_names[PATCH_KINDS]; /* "", "param", "dof" ... as in files */

typedef enum patch_action { PATCH_RECORD = 0, PATCH_STOP, PATCH_MARK, PATCH_ACTIONS } patch_action;
extern const char *const patch_action_names[PATCH_ACTIONS]; /* "record", "stop", "mark" */

/* The input that stands for hands and pedals as a mapping sees them, calibrated and filtered: its
 * channels are "right.index.mpj" (rad) and so on as in logs, and "pedal.1" to "pedal.4". */
#define PATCH_PERFORMER "performer"

typedef struct patch_connection {
    char input[PATCH_NAME]; /* "gamepad 2", its first word "gamepad", or PATCH_PERFORMER; "": the
                               first that has the channel */
    char channel[PATCH_NAME];
    patch_kind kind;
    char target[PATCH_NAME]; /* of contacts and degrees of freedom one '*' stands for l and for r */
    float way[3]; /* of a contact, face frame, unit; of a '*' x counts away from the midline */
    double in[2]; /* raw, ascending; NaN: where the channel ends */
    /* In the parameter's own unit; rad or mm of a degree of freedom; mm on a face 240 mm high of a
     * contact; 1 in full of a pose or shape. NaN: the target's own range. out[0] > out[1] turns it
     * round. */
    double out[2];
    double bend; /* -1..1: > 0 slow at first, < 0 fast at first */
    double ease; /* -1..1: > 0 slow at both ends, < 0 slow in the middle */
    double smooth_s;
    bool adds;     /* to what else moves the target; false: instead of it */
    bool picks_up; /* does nothing until it has come by where the target is: no jump */
    bool is_muted;
} patch_connection;

typedef struct patch {
    char name[PATCH_NAME];
    uint32_t count;
    patch_connection connection[PATCH_CONNECTIONS_MAX];
} patch;

/* A connection of that kind whose other values are the usual ones. */
patch_connection patch_connection_of(patch_kind kind);
/* All within their ranges and nothing missing; the error begins with "$.connections[3].smooth_s".
 */
CHECKED mrt_result patch_check(const patch *p, error *err);
bool patch_connection_equal(const patch_connection *a, const patch_connection *b);
bool patch_equal(const patch *a, const patch *b);
/* "fader 1 -> jaw.open": for lists. */
void patch_connection_describe(const patch_connection *c, char *out, size_t capacity);

/* ---- a connection's course ---- */

typedef struct patch_range { /* of the target */
    double low, high, rest;
} patch_range;

/* 0..1 to 0..1. */
double patch_curve(double share, double bend, double ease);
/* What the channel wants of the target; channel: for its ends. */
double patch_wanted(const patch_connection *c, const mrt_channel *channel, double raw,
                    const patch_range *of);

typedef struct patch_course { /* zeroed: nothing was heard yet */
    bool is_heard;
    bool is_caught; /* picked up */
    bool was_down;  /* of what is pressed */
    double wanted, value;
    double under; /* where the target was when it was not yet picked up, or has been moved by
                     another hand */
} patch_course;
/* One step. under: where the target is without this connection. True: it speaks, course->value. */
bool patch_course_step(patch_course *course, const patch_connection *c, double wanted, double under,
                       const patch_range *of, double dt_s);
/* Of a button: true in the step in which it goes down; held when first heard, it was not pressed.
 */
bool patch_course_press(patch_course *course, double share);

/* ---- what is heard ---- */

/* The raw value of the connection's channel in this frame; out_channel says what it is, with the
 * ends of an angle of PATCH_PERFORMER too. False: nobody has it. */
bool patch_listen(const patch_connection *c, const mrt_frame *frame, mrt_channel *out_channel,
                  double *out_raw);
/* The input of that name, or whose name begins with that word. */
bool patch_is_input(const char *wanted, const char *name);

#endif
