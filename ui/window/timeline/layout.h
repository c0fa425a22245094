/* window/timeline/layout.h - layout of a take on the timeline: the ruler with range and markers, a
 * row for each layer (top layer first), for the sound and for each take to comp from. Also finds
 * the item under the pointer. Leaves out drawing. Pure; points. */
#ifndef MAROTTE_UI_WINDOW_TIMELINE_LAYOUT_H
#define MAROTTE_UI_WINDOW_TIMELINE_LAYOUT_H
#include "show/edit.h"
#include "window/gui/ui_types.h"
#include "window/timeline/axis.h"

enum { TIMELINE_COMPS_MAX = 12, TIMELINE_ROWS_MAX = EDIT_LAYERS_MAX + 1 + TIMELINE_COMPS_MAX };

typedef enum timeline_row_kind {
    TIMELINE_LAYER = 0,
    TIMELINE_SOUND,
    TIMELINE_COMP /* another take to comp from */
} timeline_row_kind;
typedef struct timeline_row {
    timeline_row_kind kind;
    uint32_t index; /* index of the layer, or of the other take */
    float y, height;
} timeline_row;

#define TIMELINE_RULER_HEIGHT 42.0f
#define TIMELINE_RANGE_HEIGHT 18.0f /* upper part of the ruler: range and markers */
#define TIMELINE_LAYER_HEIGHT 46.0f
#define TIMELINE_SOUND_HEIGHT 40.0f
#define TIMELINE_COMP_HEIGHT  24.0f
#define TIMELINE_HEAD_WIDTH   186.0f /* column of names and switches, left of the axis */

typedef struct timeline_rows {
    float x, y, width, height; /* of the whole timeline: ruler, heads and lanes */
    float lanes_y;             /* below the ruler */
    float full_height;         /* of all rows, visible or not */
    float scroll;              /* 0..maximum */
    uint32_t count;
    timeline_row row[TIMELINE_ROWS_MAX]; /* with y on the screen */
} timeline_rows;

/* Lays out the rows. t NULL: no rows. Clamps scroll. Rows grow slightly if there is space. */
void timeline_rows_lay(timeline_rows *out, const take *t, uint32_t comp_count, float x, float y,
                       float width, float height, float scroll);

/* ---- hit test ---- */

typedef enum timeline_part {
    TIMELINE_NOWHERE = 0,
    TIMELINE_RANGE,    /* upper part of the ruler */
    TIMELINE_RANGE_IN, /* handle of the range */
    TIMELINE_RANGE_OUT,
    TIMELINE_MARKER,
    TIMELINE_SCRUB, /* lower part of the ruler */
    TIMELINE_LANE,  /* lane without a clip */
    TIMELINE_CLIP,
    TIMELINE_CLIP_START,
    TIMELINE_CLIP_END,
    TIMELINE_FADE_IN,
    TIMELINE_FADE_OUT,
    TIMELINE_SOUND_BODY,
    TIMELINE_SOUND_START,
    TIMELINE_SOUND_END,
    TIMELINE_COMP_BODY,
    /* parts of the heads */
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
    uint32_t layer, clip; /* ids; 0: none */
    int32_t marker;       /* -1 */
} timeline_hit;

typedef struct timeline_under {
    const timeline_rows *rows;
    const timeline_axis *axis;
    const take *take;
    int64_t in_ns, out_ns; /* selected range; in >= out: none */
    float flag_width;      /* width of a marker's flag */
    int64_t sound_ns;      /* duration of the take's sound; 0: unknown */
} timeline_under;
/* Return the start and end of the untrimmed part of the sound on the timeline. */
int64_t timeline_sound_start_ns(const take_audio *audio);
int64_t timeline_sound_end_ns(const take_audio *audio, int64_t sound_ns);
timeline_hit timeline_hit_at(const timeline_under *under, float x, float y);

/* Switches in the head of a row, from the left: mute, solo, additive, arm. */
enum { TIMELINE_SWITCHES = 4 };
#define TIMELINE_SWITCH_SIZE 18.0f
ui_rectangle timeline_switch_box(const timeline_rows *rows, const timeline_row *row,
                                 uint32_t index);
ui_rectangle timeline_gain_box(const timeline_rows *rows, const timeline_row *row);

/* Returns the rectangle of a clip on the screen. */
ui_rectangle timeline_clip_box(const timeline_row *row, const timeline_axis *axis,
                               const take_layer *layer, const take_clip *clip);
/* Returns the first clip of the layer that has not ended at from_ns (timeline of the take). */
uint32_t timeline_first_clip(const take_layer *layer, int64_t from_ns);

#endif
