/* ui/rigportraits.h - a rig's poses as portraits: one panel each in the face's own colours, with
 * the pose's name below. It draws in a context of its own. [main] */
#ifndef MAROTTE_UI_RIGPORTRAITS_H
#define MAROTTE_UI_RIGPORTRAITS_H
#include "rigpicture.h"
#include "rigpose.h"
#include "draw/draw.h"

enum { /* at most so many, usually so many side by side; pixels */
       RIGPORTRAITS_MAX = 32,
       RIGPORTRAITS_COLUMNS = 4,
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

typedef struct rigportraits_about {
    const char *title, *made_from; /* as in draw/sheet.h */
    uint32_t width, height;        /* pixels of the whole; 0: as many as the panels take */
} rigportraits_about;

/* Where the panels of so many poses stand: below a header, each above its caption. */
typedef struct rigportraits_grid {
    uint32_t width, height, header, columns, rows, left, top; /* left, top: of the first panel */
    uint32_t panel_width, panel_height, caption;
} rigportraits_grid;
rigportraits_grid rigportraits_lay_out(uint32_t count, uint32_t width, uint32_t height);

/* Writes the first RIGPORTRAITS_MAX poses of the stage's rig as a PNG; frame: of all of them. */
CHECKED mrt_result rigportraits_write(const char *path, rigpose_stage *stage,
                                      const rigportraits_frame *frame,
                                      const rigportraits_about *about, error *err);

#endif
