/* stage/perform/patch.h - a patch: connections from input channels to targets. A connection reads a
 * raw channel (a fader, a stick, a phone's shape, a sensor). It maps the value from the range of
 * the channel to that of the target along a curve, smooths it, and can wait for pick-up. Plain data
 * and pure functions. Does not cover targets on a face (patch_bay.h) and files (patch_file.h).
 *
 *   n = (raw - in low) / (in high - in low)           0..1, clamped; if in low < 0 < in high:
 *                                                     -1..1, with 0 at raw 0
 *   c = sign(n) ease(bend(|n|))                       Schlick, Fast Alternatives to Perlin's Bias
 *                                                     and Gain Functions, Graphics Gems IV (1994)
 *   wanted = out low + c (out high - out low)         0..1
 *   wanted = rest + |c| (out high - rest)             -1..1, n >= 0; out low instead if n < 0
 *   value += dt / (smooth + dt) (wanted - value)      starts at the first wanted
 *
 * Uses no sine, power or exponential, so the bits are the same on every machine. [any] */
#ifndef MAROTTE_STAGE_PATCH_H
#define MAROTTE_STAGE_PATCH_H
#include "base/error.h"

enum { PATCH_CONNECTIONS_MAX = 64, PATCH_NAME = 64 };

typedef enum patch_kind {
    PATCH_NOTHING = 0,
    PATCH_PARAM,   /* of the mapping, by its key in --map: "smile", "placement.up" */
    PATCH_DOF,     /* degree of freedom of a bone: "jaw.open" */
    PATCH_CONTACT, /* "mouth.corner.l", along `way` */
    PATCH_POSE,    /* of the rig, by name: moves all its contacts and degrees of freedom. Or else
                      made by the shapes of the head */
    PATCH_ACTION,  /* of the transport: patch_action_names */
    PATCH_SHAPE,   /* shape of the head with that name, else pose of the rig: "mouthSmileLeft" */
    PATCH_KINDS
} patch_kind;
extern const char *const patch_kind_names[PATCH_KINDS]; /* "", "param", "dof" ... as in files */

typedef enum patch_action { PATCH_RECORD = 0, PATCH_STOP, PATCH_MARK, PATCH_ACTIONS } patch_action;
extern const char *const patch_action_names[PATCH_ACTIONS]; /* "record", "stop", "mark" */

/* Name of a pseudo input: hands and pedals as a mapping sees them, calibrated and filtered. Its
 * channels are named as in logs, such as "right.index.mpj" (rad), and "pedal.1" to "pedal.4". */
#define PATCH_PERFORMER "performer"

typedef struct patch_connection {
    char input[PATCH_NAME]; /* "gamepad 2", or its first word "gamepad", or PATCH_PERFORMER; "": the
                               first input that has the channel */
    char channel[PATCH_NAME];
    patch_kind kind;
    char target[PATCH_NAME]; /* in contacts and degrees of freedom one '*' matches l and r */
    float way[3]; /* direction of a contact, unit vector in the face frame; with '*', +x points away
                     from the midline */
    double in[2]; /* raw range, ascending; NaN: the range of the channel */
    /* Output range. Unit: that of the parameter; rad or mm for a degree of freedom; mm on a face
     * 240 mm high for a contact; 1 = full for a pose or shape. NaN: the range of the target. out[0]
     * > out[1] inverts the connection. */
    double out[2];
    double bend; /* -1..1: > 0 slow at first, < 0 fast at first */
    double ease; /* -1..1: > 0 slow at both ends, < 0 slow in the middle */
    double smooth_s;
    bool adds;     /* adds to other pulls of the target; false: replaces them */
    bool picks_up; /* has no effect until its value reaches that of the target, so that the target
                      does not jump */
    bool is_muted;
} patch_connection;

typedef struct patch {
    char name[PATCH_NAME];
    uint32_t count;
    patch_connection connection[PATCH_CONNECTIONS_MAX];
} patch;

/* Returns a connection of that kind with default values. */
patch_connection patch_connection_of(patch_kind kind);
/* Checks that all values are present and in range. The error begins with a path such as
 * "$.connections[3].smooth_s". */
CHECKED mrt_result patch_check(const patch *p, error *err);
bool patch_connection_equal(const patch_connection *a, const patch_connection *b);
bool patch_equal(const patch *a, const patch *b);
/* Writes a description for lists: "fader 1 -> jaw.open". */
void patch_connection_describe(const patch_connection *c, char *out, size_t capacity);

/* ---- the value of a connection over time ---- */

typedef struct patch_range { /* of the target */
    double low, high, rest;
} patch_range;

/* Maps 0..1 to 0..1. */
double patch_curve(double share, double bend, double ease);
/* Returns the value that the channel requests for the target. channel: gives its range. */
double patch_wanted(const patch_connection *c, const mrt_channel *channel, double raw,
                    const patch_range *of);

typedef struct patch_course { /* zeroed: no sample yet */
    bool is_heard;
    bool is_picked_up; /* picked up */
    bool was_down;     /* of a button */
    double wanted, value;
    double under; /* value of the target before pick-up, or after it was moved by other means */
} patch_course;
/* Performs one step. under: value of the target without this connection. Returns true if the
 * connection is active with course->value. */
bool patch_course_step(patch_course *course, const patch_connection *c, double wanted, double under,
                       const patch_range *of, double dt_s);
/* Returns true in the step in which a button is pressed. A button that is already down at its first
 * sample does not count as pressed. */
bool patch_course_press(patch_course *course, double share);

/* ---- inputs ---- */

/* Finds the channel of the connection in this frame and returns its raw value and description. The
 * description of a PATCH_PERFORMER angle also has a range. Returns false if no input has the
 * channel. */
bool patch_read_channel(const patch_connection *c, const mrt_frame *frame, mrt_channel *out_channel,
                        double *out_raw);
/* Returns whether `name` equals `wanted` or begins with it as a whole word. */
bool patch_is_input(const char *wanted, const char *name);

#endif
