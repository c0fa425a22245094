/* ui/rigpicture.h - a rig on a picture: weights as colours, contacts with their names, the axis of
 * the jaw, from several sides. It draws in a context of its own. [main] */
#ifndef MAROTTE_UI_RIGPICTURE_H
#define MAROTTE_UI_RIGPICTURE_H
#include "face/bind.h"

enum {
    RIGPICTURE_VIEWS_MAX = 3,
    RIGPICTURE_WIDTH = 900,
    RIGPICTURE_HEIGHT = 900,
    RIGPICTURE_HEADER = 98,
    RIGPICTURE_LABELS_MAX = 1024 /* of one view */
};

typedef struct rigpicture_view {
    float yaw_rad, pitch_rad;
} rigpicture_view;

typedef struct rigpicture_about {
    const char *made_from;  /* the command that makes it again */
    uint32_t width, height; /* pixels of the whole; 0: of views of RIGPICTURE_WIDTH by _HEIGHT */
} rigpicture_about;

/* Writes view_count views side by side, under a legend of RIGPICTURE_HEADER, as a PNG. */
CHECKED mrt_result rigpicture_write(const char *path, const rig *r, const mesh *m, const binding *b,
                                    const rigpicture_view *view, uint32_t view_count,
                                    const rigpicture_about *about, error *err);

/* Where at most RIGPICTURE_LABELS_MAX labels stand, for the tests: y in pixels, ascending, at least
 * `gap` apart and within low..high as far as they fit, else from low on; as near to `wanted`
 * (ascending) as that allows, by least squares. */
void rigpicture_spread(float *out_y, const float *wanted, uint32_t count, float gap, float low,
                       float high);

/* The colour of a bone, linear: skull blue, jaw red, others told apart. */
typedef struct rigpicture_colour {
    float rgb[3];
} rigpicture_colour;
rigpicture_colour rigpicture_bone_colour(const rig *r, uint32_t bone);

#endif
