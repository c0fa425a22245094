/* ui/cli/rigpicture.h - a picture of a rig from several sides: weights as colours, contacts with
 * their names, the axis of the jaw, the rims of the mouth. It draws in its own context. [main] */
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
    const char *title;      /* title of portraits */
    const char *made_from;  /* command that makes the picture */
    uint32_t width, height; /* pixels of the whole picture; 0: the sum of its views or panels */
} rigpicture_about;

/* Writes a PNG with view_count views side by side, below a legend of RIGPICTURE_HEADER. A view is
 * usually RIGPICTURE_WIDTH by RIGPICTURE_HEIGHT. */
CHECKED mrt_result rigpicture_write(const char *path, const rig *r, const mesh *m, const binding *b,
                                    const rigpicture_view *view, uint32_t view_count,
                                    const rigpicture_about *about, error *err);

/* Computes the y of at most RIGPICTURE_LABELS_MAX labels, in pixels; public for the tests. The
 * results ascend, are at least `gap` apart, and are as near to `wanted` (ascending) as possible, by
 * least squares. They stay within low..high; if there are too many, they begin at low. */
void rigpicture_spread(float *out_y, const float *wanted, uint32_t count, float gap, float low,
                       float high);

/* Returns the linear colour of a bone: skull blue, jaw red, others distinct. */
typedef struct rigpicture_colour {
    float rgb[3];
} rigpicture_colour;
rigpicture_colour rigpicture_bone_colour(const rig *r, uint32_t bone);

/* ---- portraits of the poses of a rig ---- */

enum { /* limit of portraits; usual number of columns; with more than FEW portraits, more columns of
          half the size; the others in pixels */
       RIGPORTRAITS_MAX = 128,
       RIGPORTRAITS_COLUMNS = 4,
       RIGPORTRAITS_FEW = 24,
       RIGPORTRAITS_COLUMNS_OF_MANY = 9,
       RIGPORTRAITS_WIDTH = 400,
       RIGPORTRAITS_HEIGHT = 480,
       RIGPORTRAITS_CAPTION = 44,
       RIGPORTRAITS_HEADER = 104
};

/* Returns the default view of a portrait. */
rigpicture_view rigportraits_default_view(void);

/* The extent of all faces in a view. Add each face, then get the camera that shows all of them. */
typedef struct rigportraits_frame {
    rigpicture_view view;
    double slope[2]; /* slopes of the edges of the view: to the side, upwards */
    double reach[4]; /* mm: greatest right, left, up and down of the vertices, corrected for
                        perspective */
    double depth[2]; /* mm: least and greatest depth towards the eye */
} rigportraits_frame;
rigportraits_frame rigportraits_frame_empty(rigpicture_view view);
void rigportraits_frame_add(rigportraits_frame *self, const float *position, uint32_t vertex_count);
/* Returns the camera that shows everything as large as possible in a panel, with a small margin. */
draw_camera rigportraits_frame_camera(const rigportraits_frame *self);

/* Positions of the panels: below a header, each above its caption. */
typedef struct rigportraits_grid {
    uint32_t width, height, header, columns, rows, left, top; /* left, top: of the first panel */
    uint32_t panel_width, panel_height, caption;
} rigportraits_grid;
rigportraits_grid rigportraits_lay_out(uint32_t count, uint32_t width, uint32_t height);

/* Writes the first `count` poses (at most RIGPORTRAITS_MAX) of the stage's rig as a PNG. frame:
 * extent of all of them. */
CHECKED mrt_result rigportraits_write(const char *path, rig_poses_stage *stage, uint32_t count,
                                      const rigportraits_frame *frame,
                                      const rigpicture_about *about, error *err);

#endif
