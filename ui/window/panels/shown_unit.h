/* window/panels/shown_unit.h - the unit in which a person reads a value: degrees for radians. */
#ifndef MAROTTE_UI_WINDOW_PANELS_SHOWN_UNIT_H
#define MAROTTE_UI_WINDOW_PANELS_SHOWN_UNIT_H
#include "base/angle.h"

#include <stdbool.h>
#include <string.h>

typedef struct shown_unit {
    const char *name; /* of an angle the sign of degrees, else that of the value */
    double factor;    /* from the unit of the value to this one */
} shown_unit;

static inline shown_unit shown_unit_of(const char *unit)
{
    const bool is_angle = strncmp(unit, "rad", 3) == 0; /* and MRT_UNIT_LANDMARKS */
    return is_angle ? (shown_unit){"\xc2\xb0", 180.0 / ANGLE_PI} : (shown_unit){unit, 1.0};
}

#endif
