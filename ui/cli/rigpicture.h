/* ui/cli/rigpicture.h - a rig on a picture: weights as colours, contacts with their names, the axis of
 * the jaw, the rims of the mouth, from several sides. It draws in a context of its own. [main] */
#ifndef MAROTTE_UI_RIGPICTURE_H
#define MAROTTE_UI_RIGPICTURE_H
#include "draw/draw.h"
#include "face/bind.h"
#include "face/rig/rig_poses.h"

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
    const char *title;      /* of portraits */
    const char *made_from;  /* the command that makes it again */
    uint32_t width, height; /* pixels of the whole; 0: as many as its views or panels take */
} rigpicture_about;

/* Writes view_count views side by side, under a legend of RIGPICTURE_HEADER, as a PNG: usually of
 * RIGPICTURE_WIDTH by _HEIGHT each. */
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

/* ---- portraits of its poses ---- */

enum { /* at most so many, usually so many side by side, of more than a few at half the size; pixels
        */
       RIGPORTRAITS_MAX = 128,
       RIGPORTRAITS_COLUMNS = 4,
       RIGPORTRAITS_FEW = 24,
       RIGPORTRAITS_COLUMNS_OF_MANY = 9,
       RIGPORTRAITS_WIDTH = 400,
       RIGPORTRAITS_HEIGHT = 480,
       RIGPORTRAITS_CAPTION = 44,
       RIGPORTRAITS_HEADER = 104
};

/* From where a portrait is looked at when nothing else is asked for. */
rigpicture_view rigportraits_usual_view(void);

/* What a view must show: gathered face by face, then the camera that shows all of it. */
typedef struct rigportraits_frame {
    rigpicture_view view;
    double slope[2]; /* of the view's edges against its middle: to the side, upwards */
    double reach[4]; /* mm: right, left, up, down, of what perspective makes of each vertex */
    double depth[2]; /* mm: least and greatest, towards the eye */
} rigportraits_frame;
rigportraits_frame rigportraits_frame_empty(rigpicture_view view);
void rigportraits_frame_add(rigportraits_frame *self, const float *position, uint32_t vertex_count);
/* Shows all that was added as large as a panel can, with a little air. */
draw_camera rigportraits_frame_camera(const rigportraits_frame *self);

/* Where the panels of so many poses stand: below a header, each above its caption. */
typedef struct rigportraits_grid {
    uint32_t width, height, header, columns, rows, left, top; /* left, top: of the first panel */
    uint32_t panel_width, panel_height, caption;
} rigportraits_grid;
rigportraits_grid rigportraits_lay_out(uint32_t count, uint32_t width, uint32_t height);

/* Writes the first `count` poses (RIGPORTRAITS_MAX at most) of the stage's rig as a PNG; frame: of
 * all of them. */
CHECKED mrt_result rigportraits_write(const char *path, rig_poses_stage *stage, uint32_t count,
                                      const rigportraits_frame *frame,
                                      const rigpicture_about *about, error *err);

#endif
