/* window/panels/mapping.h - what the mapping panel knows without being seen: which finger somebody
 * moves and which parameter links it to a contact (learn mode), and which parameters say what a
 * pedal does. A finger is meant when its joints have gone through more than those of any other over
 * the last second. Pure; no allocation. */
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
    int finger;                      /* that is meant: the last that clearly moved; LEARN_NONE */
} learn;

void learn_begin(learn *self);
/* Once a drawn frame: the hands of now, left and right. */
void learn_look(learn *self, const mrt_hand hand[2], double dt_s);

/* Which finger a parameter of a mapping links to a contact (group "Contacts", stepped, named as
 * above; 0: none, n: contact n): LEARN_NONE: it is none of these. */
int learn_finger_of(const mrt_param *param);
/* The parameter that links this finger; param_count: the mapping links none. */
uint32_t learn_param_of(const mrt_plugin_type *type, int finger);
bool learn_can(const mrt_plugin_type *type); /* it links some finger */

enum { PEDAL_MEANING = 64 };
/* False: it is no such parameter. out: "Anchor". */
bool pedal_table_meaning(const mrt_param *param, char out[PEDAL_MEANING]);
/* "Anchor, Hold": what pedal 1..4 does by these values (param_count); "" nothing. */
void pedal_table_words(const mrt_plugin_type *type, const double *values, uint32_t pedal, char *out,
                       size_t capacity);

#endif
