/* cyberglove/glove_start.h - the start-up that works for all models: finds out what is at the port,
 * sets it up, and has its first record. Every step is bounded, and the whole: 6 s. Leaves out which
 * port, and what follows. [main] [input]. */
#ifndef MAROTTE_CYBERGLOVE_START_H
#define MAROTTE_CYBERGLOVE_START_H
#include "glove_parse.h"
#include "glove_port.h"

enum { GLOVE_CTRL_C = 0x03, GLOVE_CTRL_R = 0x12 };
enum { GLOVE_MODE_AUTO = 0, GLOVE_MODE_STREAM, GLOVE_MODE_POLLED };
enum { GLOVE_STAMPS_AUTO = 0, GLOVE_STAMPS_ON, GLOVE_STAMPS_OFF };
enum { GLOVE_HAND_AUTO = 0, GLOVE_HAND_LEFT, GLOVE_HAND_RIGHT };
enum { GLOVE_FILTER_AS_IT_IS = 0, GLOVE_FILTER_OFF, GLOVE_FILTER_ON };

/* What the person asked for. */
typedef struct glove_settings {
    uint32_t baud;
    double rate_hz; /* 0: whatever the glove does */
    int mode, stamps, hand, filter;
    glove_form form;
    double patience; /* all limits, times this */
} glove_settings;

/* What there is. */
typedef struct glove_unit {
    glove_layout layout;
    glove_sensors sensors;
    uint32_t hand; /* MRT_LEFT, MRT_RIGHT */
    bool reported_hand, is_polled;
    int64_t period_ns;  /* between records; 0: unknown */
    char refused[16];   /* letters of the orders that it does not know */
    double asked_hz;    /* of the rate asked for, what the line lets through; 0: all of it */
    uint32_t readiness; /* ?G: 1 initialised, 2 plugged in */
} glove_unit;

/* effort: whether a glove that is silent is restarted, which takes it seconds. */
typedef enum glove_effort { GLOVE_JUST_ASK = 0, GLOVE_MAY_RESTART } glove_effort;

/* On success the glove sends (or answers 'G'), and `parse` is set up for it. */
mrt_result glove_start(glove_port *port, const mrt_host *host, const glove_settings *settings,
                       glove_effort effort, glove_unit *out, glove_parse *parse, glove_why *why);
/* Lets it begin to send, as glove_start did: after an interruption. False: the port is gone. */
bool glove_start_sending(glove_port *port, const glove_unit *unit);

#endif
