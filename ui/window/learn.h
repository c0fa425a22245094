/* window/learn.h - learn mode: which finger somebody moves, and which parameter of a mapping links
 * it to a contact of the face. A finger is meant when its joints have gone through more than those
 * of any other over the last second. Leaves out the click on the face and what is drawn. A function
 * of the hands and times it is given; no allocation. */
#ifndef MAROTTE_UI_WINDOW_LEARN_H
#define MAROTTE_UI_WINDOW_LEARN_H
#include <marotte/plugin.h>

enum {
    LEARN_FINGERS = 10, /* right thumb .. little, then the left hand's */
    LEARN_MOMENTS = 40, /* of the last second */
    LEARN_NONE = -1
};
extern const char *const learn_finger_name[LEARN_FINGERS]; /* "right thumb" */

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

#endif
