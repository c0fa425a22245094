/* cyberglove/glove_start.h - start-up for all models: identifies the device at the port, sets it
 * up, and reads its first record. Each step has a limit, and the whole takes at most 6 s. Leaves
 * out the choice of the port, and reading after the first record. [main] [input]. */
#ifndef MAROTTE_CYBERGLOVE_START_H
#define MAROTTE_CYBERGLOVE_START_H
#include "glove_parse.h"
#include "glove_port.h"

enum { GLOVE_CTRL_C = 0x03, GLOVE_CTRL_R = 0x12 };
enum { GLOVE_MODE_AUTO = 0, GLOVE_MODE_STREAM, GLOVE_MODE_POLLED };
enum { GLOVE_STAMPS_AUTO = 0, GLOVE_STAMPS_ON, GLOVE_STAMPS_OFF };
enum { GLOVE_HAND_AUTO = 0, GLOVE_HAND_LEFT, GLOVE_HAND_RIGHT };
enum { GLOVE_FILTER_AS_IT_IS = 0, GLOVE_FILTER_OFF, GLOVE_FILTER_ON };

/* Settings from the user. */
typedef struct glove_settings {
    uint32_t baud;
    double rate_hz; /* 0: the glove's own rate */
    int mode, stamps, hand, filter;
    glove_form form;
    double patience; /* factor for all timeouts */
} glove_settings;

/* Properties of the glove found. */
typedef struct glove_unit {
    glove_layout layout;
    glove_sensors sensors;
    uint32_t hand; /* MRT_LEFT, MRT_RIGHT */
    bool reported_hand, is_polled;
    int64_t period_ns;  /* between records; 0: unknown */
    char refused[16];   /* letters of the commands that the glove rejected */
    double asked_hz;    /* highest rate that the line allows, if below the requested rate; else 0 */
    uint32_t readiness; /* ?G: 1 initialised, 2 plugged in */
} glove_unit;

/* effort: whether to restart a silent glove, which takes seconds. */
typedef enum glove_effort { GLOVE_JUST_ASK = 0, GLOVE_MAY_RESTART } glove_effort;

/* Starts the glove. On success it sends (or answers 'G'), and `parse` is set up for it. */
mrt_result glove_start(glove_port *port, const mrt_host *host, const glove_settings *settings,
                       glove_effort effort, glove_unit *out, glove_parse *parse, glove_error *why);
/* Starts sending again after an interruption, as glove_start did. Returns false if the port was
 * lost. */
bool glove_start_sending(glove_port *port, const glove_unit *unit);

#endif
