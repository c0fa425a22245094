/* window/timeline/layout.h - where everything of a take lies on the timeline: the ruler with its
 * range and markers, a row for each layer (the top one on top), for the sound and for each take
 * that can be comped from; and what is under the pointer. Leaves out looks. Pure; points. */
#ifndef MAROTTE_UI_WINDOW_TIMELINE_LAYOUT_H
#define MAROTTE_UI_WINDOW_TIMELINE_LAYOUT_H
#include "show/edit.h"
#include "window/gui/ui_types.h"
#include "window/timeline/axis.h"

enum { TIMELINE_COMPS_MAX = 12, TIMELINE_ROWS_MAX = EDIT_LAYERS_MAX + 1 + TIMELINE_COMPS_MAX };

typedef enum timeline_row_kind {
    TIMELINE_LAYER = 0,
    TIMELINE_SOUND,
    TIMELINE_COMP /* another take, to be swiped over */
} timeline_row_kind;
typedef struct timeline_row {
    timeline_row_kind kind;
    uint32_t index; /* of the layer in the take, of the other take */
    float y, height;
} timeline_row;

#define TIMELINE_RULER_HEIGHT 42.0f
#define TIMELINE_RANGE_HEIGHT 18.0f /* its upper part: range and markers */
#define TIMELINE_LAYER_HEIGHT 46.0f
#define TIMELINE_SOUND_HEIGHT 40.0f
#define TIMELINE_COMP_HEIGHT  24.0f
#define TIMELINE_HEAD_WIDTH   186.0f /* names and switches, left of the axis */

typedef struct timeline_rows {
    float x, y, width, height; /* of all: ruler, heads and lanes */
    float lanes_y;             /* below the ruler */
    float full_height;         /* of all rows, whether they are seen or not */
    float scroll;              /* 0..most */
    uint32_t count;
    timeline_row row[TIMELINE_ROWS_MAX]; /* y on the screen */
} timeline_rows;

/* t NULL: no rows. scroll is put within what is possible. Rows grow a little where there is room.
 */
void timeline_rows_lay(timeline_rows *out, const take *t, uint32_t comp_count, float x, float y,
                       float width, float height, float scroll);

/* ---- what is under the pointer ---- */

typedef enum timeline_part {
    TIMELINE_NOWHERE = 0,
    TIMELINE_RANGE,    /* the ruler's upper part */
    TIMELINE_RANGE_IN, /* its handles */
    TIMELINE_RANGE_OUT,
    TIMELINE_MARKER,
    TIMELINE_SCRUB, /* the ruler's lower part */
    TIMELINE_LANE,  /* where no clip is */
    TIMELINE_CLIP,
    TIMELINE_CLIP_START,
    TIMELINE_CLIP_END,
    TIMELINE_FADE_IN,
    TIMELINE_FADE_OUT,
    TIMELINE_SOUND_BODY,
    TIMELINE_SOUND_START,
    TIMELINE_SOUND_END,
    TIMELINE_COMP_BODY,
    /* in the heads */
    TIMELINE_NAME,
    TIMELINE_MUTE,
    TIMELINE_SOLO,
    TIMELINE_ADDITIVE,
    TIMELINE_ARM,
    TIMELINE_GAIN,
    TIMELINE_PARTS
} timeline_part;
typedef struct timeline_hit {
    timeline_part part;
    int32_t row;          /* -1 */
    uint32_t layer, clip; /* ids; 0 */
    int32_t marker;       /* -1 */
} timeline_hit;

typedef struct timeline_under {
    const timeline_rows *rows;
    const timeline_axis *axis;
    const take *take;
    int64_t in_ns, out_ns; /* the range; in >= out: none */
    float flag_width;      /* of a marker's flag */
    int64_t sound_ns;      /* how long the take's sound is; 0: not known */
} timeline_under;
/* What of a sound is heard, on the timeline. */
int64_t timeline_sound_start_ns(const take_audio *audio);
int64_t timeline_sound_end_ns(const take_audio *audio, int64_t sound_ns);
timeline_hit timeline_hit_at(const timeline_under *under, float x, float y);

/* The switches of a row's head: mute, solo, additive, arm, from the left. */
enum { TIMELINE_SWITCHES = 4 };
#define TIMELINE_SWITCH_SIZE 18.0f
ui_rectangle timeline_switch_box(const timeline_rows *rows, const timeline_row *row,
                                 uint32_t index);
ui_rectangle timeline_gain_box(const timeline_rows *rows, const timeline_row *row);

/* A clip on the screen. */
ui_rectangle timeline_clip_box(const timeline_row *row, const timeline_axis *axis,
                               const take_layer *layer, const take_clip *clip);
/* The first clip of the layer that may still be seen at from_ns (of the take's timeline): clips
 * before it have ended. */
uint32_t timeline_first_clip(const take_layer *layer, int64_t from_ns);

#endif
