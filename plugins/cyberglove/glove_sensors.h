/* cyberglove/glove_sensors.h - which sensors a record holds, in its order, by the glove's masks:
 * bit 4 * finger + joint, thumb to little and carpus; MCP, PIP, DIP, abduction. Pure. */
#ifndef MAROTTE_CYBERGLOVE_SENSORS_H
#define MAROTTE_CYBERGLOVE_SENSORS_H
#include "glove_parse.h"

#include <marotte/plugin.h>

enum { GLOVE_MASK_18 = 0x7BBB3F, GLOVE_MASK_22 = 0x7FFF7F };

typedef struct glove_sensors {
    uint32_t count;
    uint32_t semantic[GLOVE_SENSORS_MAX]; /* MRT_CH_ANGLE + n, or MRT_CH_OTHER */
} glove_sensors;

/* What the glove says of itself; 0 where it does not. */
typedef struct glove_census {
    uint32_t sensor_count;  /* ?S */
    uint32_t hardware_mask; /* ?K */
    uint32_t software_mask; /* ?M */
    uint32_t sent_count;    /* ?N */
} glove_census;

/* False: what it says names no glove (`out` is left alone). */
bool glove_sensors_find(const glove_census *census, glove_sensors *out);
/* 18 or 22 sensors. */
void glove_sensors_of_count(uint32_t count, glove_sensors *out);

/* "thumb.roll"; "extra" for one without a meaning. */
const char *glove_sensor_name(uint32_t semantic);

#endif
