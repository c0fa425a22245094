/* window/panels/mapping.h - the part of the mapping panel that does not draw. It detects the moving
 * finger and the parameter that links it to a contact (learn mode), and finds the parameters that
 * assign pedals. The selected finger is the one whose joints travelled most in the last second.
 * Pure; no allocation. */
#ifndef MAROTTE_UI_WINDOW_PANELS_MAPPING_H
#define MAROTTE_UI_WINDOW_PANELS_MAPPING_H
#include <marotte/plugin.h>

enum {
    LEARN_FINGERS = 10, /* right thumb .. little, then the left hand's */
    LEARN_MOMENTS = 40, /* of the last second */
    LEARN_NONE = -1
};

typedef struct learn {
    uint32_t count, next; /* of the ring of moments */
    double time_s, last_s;
    struct learn_moment {
        double time_s;
        bool is_present[2];
        float angle[2][MRT_ANGLES];
    } moment[LEARN_MOMENTS];
    float travel_rad[LEARN_FINGERS]; /* over the last second */
    int finger; /* selected finger: the last one that clearly moved; LEARN_NONE */
} learn;

void learn_begin(learn *self);
/* Adds the current hands, left and right. Call it once for each drawn frame. */
void learn_update(learn *self, const mrt_hand hand[2], double dt_s);

/* Returns the finger that a parameter links to a contact, or LEARN_NONE. Such a parameter is
 * stepped, is in the group "Contacts" and has the name of the finger. Its value is 0 for no
 * contact, or n for contact n. */
int learn_finger_of(const mrt_param *param);
/* Returns the index of the parameter that links this finger, or param_count. */
uint32_t learn_param_of(const mrt_plugin_type *type, int finger);
bool learn_can(const mrt_plugin_type *type); /* the mapping can link a finger */

enum { PEDAL_MEANING = 64 };
/* Writes the function of a pedal parameter, such as "Anchor". Returns false for other parameters.
 */
bool pedal_table_meaning(const mrt_param *param, char out[PEDAL_MEANING]);
/* Writes the functions of pedal 1..4 for these values (param_count), such as "Anchor, Hold", or "".
 */
void pedal_table_words(const mrt_plugin_type *type, const double *values, uint32_t pedal, char *out,
                       size_t capacity);

#endif
