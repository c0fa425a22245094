/* window/timeline/timeline.h - the state of the timeline panel, shared by its files. timeline.c:
 * the panel. paint.c: drawing of a take. journal.c: the journal that is shown while no take is
 * selected. mouse.c: gestures. menu.c: menus and dialogs. sync_dialog.c: a dialog of its own.
 * strip.c: the transport. take_list.c: the list of takes. No other folder includes this header.
 * [main] */
#ifndef MAROTTE_UI_WINDOW_TIMELINE_TIMELINE_H
#define MAROTTE_UI_WINDOW_TIMELINE_TIMELINE_H
#include "window/panels/panels.h"
#include "window/gui/theme.h"
#include "window/timeline/drag.h"
#include "window/timeline/worker.h"

#define TIMELINE_LIST_WIDTH   250.0f
#define TIMELINE_STRIP_HEIGHT 46.0f

/* ---- colours of the timeline ---- */

#define TIMELINE_CURVE_COLOUR 0x86a9b8ffu
#define TIMELINE_FILL_ALPHA   0x3cu /* of a curve's area, which has the colour of its line */
#define TIMELINE_MUTED_CLIP   0x22262affu
#define TIMELINE_MUTED_CURVE  0x86a9b848u
#define TIMELINE_MUTED_FILL   0x86a9b818u
#define TIMELINE_WAVE_COLOUR  0x9c93b8d0u
#define TIMELINE_OVER_COLOUR  0xff6b6b24u /* current overdub */
#define TIMELINE_WAVE_TRIMMED 0x9c93b840u /* trimmed part of the sound */
#define TIMELINE_SHADE        0x0d0f1190u /* faded part of a clip */
#define TIMELINE_RANGE_COLOUR 0xd9a44133u
#define TIMELINE_HEAD_COLOUR  0xe6e3dcffu /* the playhead */

typedef struct timeline_colour { /* of a clip, by take_colour (paint.c) */
    const char *name;
    uint32_t ground, curve;
} timeline_colour;
extern const timeline_colour timeline_colours[TAKE_COLOURS];

/* ---- filter of the take list, newest first: all, good or deleted takes, with a text search in
 * title and note (take_list.c). Pure, except for its own memory ---- */

typedef enum takes_filter {
    TAKES_ALL = 0,
    TAKES_GOOD, /* three or more stars */
    TAKES_DELETED,
    TAKES_FILTERS
} takes_filter;

/* TAKES_SEARCH_FROM: number of takes from which the search field is shown. */
enum { TAKES_WORDS = 64, TAKES_SEARCH_FROM = 9 };
typedef struct takes_row {     /* visible row of the list */
    uint32_t line, over_count; /* over_count: overdubs of the take */
    bool is_over;              /* the row is an overdub, below its take */
} takes_row;

typedef struct takes_root { /* root take of a line */
    uint32_t at;            /* line of the root, or the line itself; UINT32_MAX: hidden */
    uint32_t over_count, put_count, row; /* over_count: overdubs listed below it */
    bool is_unfolded;
} takes_root;

enum { TAKES_UNFOLDED = 32 };
typedef struct timeline_takes {
    takes_filter filter;
    char words[TAKES_WORDS]; /* search words: all must match, ignoring case */
    takes_row *row;
    takes_root *root; /* for each line */
    uint32_t count, capacity;
    int64_t unfolded[TAKES_UNFOLDED]; /* takes with visible overdubs */
    uint32_t unfolded_next;
} timeline_takes;

void timeline_takes_finish(timeline_takes *self); /* accepts zeroed memory */

/* "5.3 s", "2:05", "1:02:05" */
void timeline_takes_duration(char *out, size_t capacity, int64_t duration_ns);
/* Returns whether all words of `words` are in the title or the note, ignoring case. */
bool timeline_takes_matches(const app_take_line *line, const char *words);

/* ---- movement of each input in the last half hour, outside of recordings: bins of 0.1 s in memory
 * of constant size, written in each frame of the window (journal.c; the recorded journal:
 * show/writer_store.h). Pure; times come from any monotonic clock ---- */

enum { JOURNAL_LANES = 9, JOURNAL_BINS = 18000 }; /* 30 min */
#define JOURNAL_BIN_NS 100000000LL

typedef struct timeline_journal timeline_journal;

timeline_journal *timeline_journal_create(void);       /* NULL: no memory */
void timeline_journal_destroy(timeline_journal *self); /* NULL is fine */
/* Adds the newest sample of an input at now_ns. The ranges of its channels scale the movement. of:
 * id of the input. If there are too many inputs, the least recently updated one is dropped. */
void timeline_journal_note(timeline_journal *self, uint64_t of, int64_t now_ns,
                           const mrt_sample *sample, const mrt_channel *channel);
/* Returns the greatest movement between two times, 0..1, scaled for display. The movement is the
 * mean over the channels, as share of their range per 0.1 s. Returns 0 if nothing is known. */
float timeline_journal_read(const timeline_journal *self, uint64_t of, int64_t from_ns,
                            int64_t to_ns);

/* Clamps a swiped span, in either direction, to the last reach_ns of the journal. An end near now
 * becomes now. Returns false if the span is too short. */
bool timeline_keep_span(int64_t *io_from_ns, int64_t *io_to_ns, int64_t now_ns, int64_t reach_ns);

/* Gestures of the pointer, except drags that are edits (drag.h). */
typedef enum timeline_gesture {
    GESTURE_NONE = 0,
    GESTURE_PRESSED, /* pressed; becomes a drag after some points of movement */
    GESTURE_EDIT,
    GESTURE_SCRUB,
    GESTURE_RANGE, /* new range, or one of its ends */
    GESTURE_PAN,
    GESTURE_SWIPE, /* swipe over a comp lane */
    GESTURE_SLIDE, /* shift of a comp lane in time */
    GESTURE_KEEP   /* swipe over the journal */
} timeline_gesture;

typedef struct timeline_slip { /* slate, name and note of a take while they are typed */
    char name[TAKE_NAME], scene[TAKE_NAME], shot[TAKE_NAME], number[8], note[512];
} timeline_slip;

enum { TIMELINE_COLUMNS_MAX = 8192 };

typedef struct timeline_slid { /* shift of another take below a take */
    int64_t of, take, later_ns;
} timeline_slid;

enum { TIMELINE_WORDS = 8192 };

struct panel {
    app *app;
    timeline_worker *worker;
    timeline_request request;
    const timeline_result *result;
    const timeline_comps *comps; /* for the selected take; NULL: none */
    /* layout */
    timeline_axis axis;
    timeline_rows rows;
    float scroll;
    int64_t fitted_take, fitted_duration_ns;
    float fitted_width;
    bool is_fit; /* show the whole take, also while it grows */
    int64_t last_head_ns;
    /* settings of the user */
    bool is_following, has_comps;
    uint32_t regions; /* regions that a swipe comps */
    timeline_slid slid[TIMELINE_COMPS_MAX];
    uint32_t slid_next; /* next slot to use */
    char *slid_show;    /* path of the show of these takes; NULL: not read yet */
    /* the pointer */
    timeline_gesture gesture;
    timeline_drag drag;
    uint64_t edition; /* edition of the take at the start of the drag */
    timeline_hit pressed, menu;
    int64_t over_from_ns; /* start of the current overdub; -1: none */
    int64_t pressed_ns, menu_ns;
    int64_t slid_from_ns;             /* shift of a comp lane at the press */
    int64_t span_from_ns, span_to_ns; /* span of a swipe or range */
    timeline_target range_snapped;    /* what the dragged end of the range has snapped to */
    bool is_free;                     /* Shift is held: this drag does not snap */
    const char *hint;
    char hint_words[800]; /* memory of a hint that is written: of a take, its whole name and note */
    /* the journal, shown while no take is selected */
    timeline_journal *journal;
    int64_t journal_span_ns;
    int64_t journal_now_ns; /* right end of the journal; advances with each new face, otherwise in
                               steps */
    uint64_t journal_face;  /* number of that face */
    /* takes */
    timeline_takes takes;
    float takes_scroll;
    int64_t takes_menu, takes_shown; /* ids; takes_shown: scrolled into view */
    /* Clicked star. It is applied unless a second click follows, which shows the take. */
    struct {
        int64_t take; /* 0: none */
        uint32_t rating;
        double wait_s;
    } rates;
    /* dialogs */
    uint32_t asked_layer, asked_clip;
    int32_t asked_marker;
    int64_t asked_take;
    char spoken[TIMELINE_WORDS]; /* words of a voice, for its mouth */
    double jaw_lips[2];          /* how much jaw, lips, in % */
    char text[512];
    timeline_slip slip, slip_before;
    double number[5], previewed[5]; /* values of the dialog of a clip; those that were previewed */
    bool has_clip_preview;          /* the stage shows the values of that dialog */
    error clip_why;                 /* why they are not possible; "": they are */
    uint32_t asked_regions;
    bool is_everything, is_asked_first;
    /* memory for drawing */
    float column_x[TIMELINE_COLUMNS_MAX], column_low[TIMELINE_COLUMNS_MAX],
        column_high[TIMELINE_COLUMNS_MAX], column_least[TIMELINE_COLUMNS_MAX],
        column_line[2 * TIMELINE_COLUMNS_MAX];
};

/* ---- functions shared by the files ---- */

/* Returns the take as drawn, including the current drag. NULL: no take is selected. */
const take *timeline_take(const panel *self);
timeline_code timeline_code_now(const panel *self);
int64_t timeline_head_ns(const panel *self);
timeline_target timeline_snapped(const panel *self); /* by the current drag */
bool timeline_range(const panel *self, int64_t *out_in_ns, int64_t *out_out_ns);
/* Returns the swiped or dragged span with start before end. */
void timeline_span_now(const panel *self, int64_t *out_from_ns, int64_t *out_to_ns);
void timeline_fit(panel *self);
void timeline_report(panel *self, const error *err); /* reports the error in the log panel */
double timeline_clip_speed(const take_clip *clip);   /* speed of the whole clip */
void timeline_edit(panel *self, edit *e);            /* applies the edit and finishes it */

void timeline_own_words(const take_layer *lane, char *out, size_t capacity);
uint32_t timeline_own_regions(const take_layer *lane); /* bits of the regions of the layer */
bool timeline_is_of_regions(const char *pattern, uint32_t regions);
/* Returns the shift of a comp lane; 0 by default. */
int64_t timeline_comp_later_ns(const panel *self, uint32_t index);
void timeline_comp_slide(panel *self, uint32_t index, int64_t later_ns);
take_layer timeline_comp_lane(const panel *self,
                              uint32_t index); /* lowest layer, shifted; the comp owns the clips */
void timeline_slide_note(panel *self, uint32_t index,
                         int64_t before_ns); /* adds an undo step for a shift */

/* strip.c */
void timeline_strip_draw(panel *self, ui *on, ui_rectangle where);
void timeline_history_dialog(panel *self, ui *on);

/* paint.c */
void timeline_paint_ruler(panel *self, ui *on);
void timeline_paint_over(panel *self, ui *on); /* draws the current overdub */
void timeline_paint_head(panel *self, ui *on); /* draws the playhead over everything else */
void timeline_paint_corner(panel *self, ui *on, const ui_canvas *canvas);
void timeline_paint_rows(panel *self, ui *on);
void timeline_paint_snap(panel *self, ui *on); /* draws what the drag has snapped to */

/* mouse.c */
int64_t timeline_sound_ns(const panel *self); /* duration of the sound; 0: none, or not known yet */
void timeline_mouse(panel *self, ui *on, const ui_canvas *canvas);

/* menu.c */
void timeline_menu(panel *self, ui *on);
void timeline_ask_layer(panel *self, ui *on, uint32_t id); /* 0: new layer */
void timeline_ask_clip(panel *self, ui *on, uint32_t id);
void timeline_ask_marker(panel *self, ui *on, int32_t marker);
void timeline_dialogs(panel *self, ui *on);

/* sync_dialog.c */
void timeline_ask_sync(panel *self, ui *on); /* of the chosen take */
void timeline_sync_dialog(panel *self, ui *on);

/* journal.c */
uint64_t timeline_journal_input(live *stage, uint32_t index); /* for timeline_journal_note */
void timeline_paint_journal(panel *self, ui *on, const ui_canvas *canvas);

/* take_list.c */
void timeline_takes_draw(panel *self, ui *on, ui_rectangle where);
void timeline_takes_update(panel *self, double dt_s);
void timeline_takes_dialog(panel *self, ui *on);

#endif
