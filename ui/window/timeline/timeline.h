/* window/timeline/timeline.h - the state of the timeline's panel, which its files share: timeline.c
 * puts the panel together, paint.c draws a take, journal.c has what is shown while no take is
 * chosen, mouse.c turns the pointer into gestures, menu.c has the menus and dialogs, strip.c the
 * transport above, take_list.c the list beside it. No other room includes this header. [main] */
#ifndef MAROTTE_UI_WINDOW_TIMELINE_TIMELINE_H
#define MAROTTE_UI_WINDOW_TIMELINE_TIMELINE_H
#include "window/panels/panels.h"
#include "window/gui/theme.h"
#include "window/timeline/drag.h"
#include "window/timeline/worker.h"

#define TIMELINE_LIST_WIDTH   250.0f
#define TIMELINE_STRIP_HEIGHT 46.0f

/* ---- colours of the timeline alone ---- */

#define TIMELINE_CLIP_COLOUR  0x2c3a41ffu
#define TIMELINE_CURVE_COLOUR 0x86a9b8ffu
#define TIMELINE_CURVE_FILL   0x86a9b83cu
#define TIMELINE_MUTED_CLIP   0x22262affu
#define TIMELINE_MUTED_CURVE  0x86a9b848u
#define TIMELINE_MUTED_FILL   0x86a9b818u
#define TIMELINE_WAVE_COLOUR  0x9c93b8d0u
#define TIMELINE_OVER_COLOUR  0xff6b6b24u /* what is being performed over a take */
#define TIMELINE_WAVE_TRIMMED 0x9c93b840u /* what of it is not heard */
#define TIMELINE_SHADE        0x0d0f1190u /* where a fade takes something away */
#define TIMELINE_RANGE_COLOUR 0xd9a44133u
#define TIMELINE_HEAD_COLOUR  0xe6e3dcffu /* the play head */

/* ---- which takes the list shows, newest first: all, the good ones, or those that were deleted,
 * with some words in title or note (take_list.c). Pure but for its memory, which is kept ---- */

typedef enum takes_filter {
    TAKES_ALL = 0,
    TAKES_GOOD, /* three stars and more */
    TAKES_DELETED,
    TAKES_FILTERS
} takes_filter;

enum { TAKES_WORDS = 64, TAKES_SEARCH_FROM = 9 }; /* so many takes are worth a search field */
typedef struct takes_row {                        /* of the list, as it is shown */
    uint32_t line, over_count;                    /* overdubs of it, folded under it */
    bool is_over;                                 /* it is one of those, under its take */
} takes_row;

typedef struct takes_root { /* of a line */
    uint32_t at;            /* the line that it lies under, or itself; not shown: UINT32_MAX */
    uint32_t over_count, put_count, row; /* overdubs listed below it */
    bool is_unfolded;
} takes_root;

enum { TAKES_UNFOLDED = 32 };
typedef struct timeline_takes {
    takes_filter filter;
    char words[TAKES_WORDS]; /* all of them must be there, in any case */
    takes_row *row;
    takes_root *root; /* of each line */
    uint32_t count, capacity;
    int64_t unfolded[TAKES_UNFOLDED]; /* takes whose overdubs are unfolded */
    uint32_t unfolded_next;
} timeline_takes;

void timeline_takes_finish(timeline_takes *self); /* accepts zeroed */

/* "5.3 s", "2:05", "1:02:05" */
void timeline_takes_duration(char *out, size_t capacity, int64_t duration_ns);
/* All words of `words` are in the title or the note, in any case. */
bool timeline_takes_matches(const app_take_line *line, const char *words);

/* ---- how much each input moved in the last half hour, as long as nobody recorded: bins of a tenth
 * of a second, written while the window looks, in memory that does not grow (journal.c; the journal
 * itself: show/writer_store.h). Pure; time is any clock's that does not go back ---- */

enum { JOURNAL_LANES = 9, JOURNAL_BINS = 18000 }; /* 30 min */
#define JOURNAL_BIN_NS 100000000LL

typedef struct timeline_journal timeline_journal;

timeline_journal *timeline_journal_create(void);       /* NULL: no memory */
void timeline_journal_destroy(timeline_journal *self); /* NULL is fine */
/* The newest sample of an input, seen at now_ns; its channels say what a whole movement is. of:
 * which input, whatever its index; when there are too many, the one not updated for longest goes.
 */
void timeline_journal_note(timeline_journal *self, uint64_t of, int64_t now_ns,
                           const mrt_sample *sample, const mrt_channel *channel);
/* The greatest movement between two instants, 0..1: of a lane's channels, as a mean share of their
 * range in a tenth of a second, made visible. 0 where nothing is known. */
float timeline_journal_read(const timeline_journal *self, uint64_t of, int64_t from_ns,
                            int64_t to_ns);

/* Of a span that somebody swiped, in either direction, what can be kept: the journal reaches back
 * reach_ns, and what ends near now ends now. False: too short. */
bool timeline_keep_span(int64_t *io_from_ns, int64_t *io_to_ns, int64_t now_ns, int64_t reach_ns);

/* What the pointer does, beside drags that are edits (drag.h). */
typedef enum timeline_gesture {
    GESTURE_NONE = 0,
    GESTURE_PRESSED, /* on something that is dragged once it has moved some points */
    GESTURE_EDIT,
    GESTURE_SCRUB,
    GESTURE_RANGE, /* a new one, or one of its ends */
    GESTURE_PAN,
    GESTURE_SWIPE, /* over a comp lane */
    GESTURE_SLIDE, /* of a comp lane: it lies elsewhere under the take */
    GESTURE_KEEP   /* over the journal */
} timeline_gesture;

typedef struct timeline_slip { /* what a take is called, as it is typed */
    char name[TAKE_NAME], scene[TAKE_NAME], shot[TAKE_NAME], number[8], note[512];
} timeline_slip;

enum { TIMELINE_COLUMNS_MAX = 8192 };

typedef struct timeline_slid { /* so much later than its own time another take lies under one */
    int64_t of, take, later_ns;
} timeline_slid;

struct panel {
    app *app;
    timeline_worker *worker;
    timeline_request request;
    const timeline_result *result;
    const timeline_comps *comps; /* of the chosen take; NULL */
    /* where things are */
    timeline_axis axis;
    timeline_rows rows;
    float scroll;
    int64_t fitted_take, fitted_duration_ns;
    bool is_fit; /* the whole take is shown: also when it becomes longer */
    int64_t last_head_ns;
    /* settings of the person */
    bool is_snapping, is_following, has_comps;
    uint32_t regions; /* that a swipe comps */
    timeline_slid slid[TIMELINE_COMPS_MAX];
    uint32_t slid_next; /* the slot that the next one takes */
    char *slid_show;    /* path of the show whose takes they are; NULL: not looked at yet */
    /* the pointer */
    timeline_gesture gesture;
    timeline_drag drag;
    uint64_t edition; /* of the take when the drag began */
    timeline_hit pressed, menu;
    int64_t over_from_ns; /* where performing over the take began to count; -1: it does not */
    int64_t pressed_ns, menu_ns;
    int64_t slid_from_ns;             /* where a comp lane lay when it was pressed */
    int64_t span_from_ns, span_to_ns; /* of a swipe, a keep, a range */
    const char *hint;
    /* the journal: what is seen while nothing is chosen */
    timeline_journal *journal;
    int64_t journal_span_ns;
    int64_t journal_now_ns; /* its end: goes on with each new face, else in steps */
    uint64_t journal_face;  /* the number of that face */
    /* takes */
    timeline_takes takes;
    float takes_scroll;
    int64_t takes_menu, takes_shown; /* ids; shown: kept in sight */
    /* A star that was clicked: it is meant unless a second click, which shows the take, follows. */
    struct {
        int64_t take; /* 0: none */
        uint32_t rating;
        double wait_s;
    } rates;
    /* questions */
    uint32_t asked_layer, asked_clip;
    int32_t asked_marker;
    int64_t asked_take;
    char text[512];
    timeline_slip slip, slip_before;
    double number[5];
    uint32_t asked_regions;
    bool is_everything, is_asked_first;
    /* memory for drawing */
    float column_x[TIMELINE_COLUMNS_MAX], column_low[TIMELINE_COLUMNS_MAX],
        column_high[TIMELINE_COLUMNS_MAX], column_least[TIMELINE_COLUMNS_MAX],
        column_line[2 * TIMELINE_COLUMNS_MAX];
};

/* ---- what the files know of each other ---- */

/* The take as it is drawn: with what is being dragged. NULL: none is chosen. */
const take *timeline_take(const panel *self);
timeline_code timeline_code_now(const panel *self);
int64_t timeline_head_ns(const panel *self);
bool timeline_range(const panel *self, int64_t *out_in_ns, int64_t *out_out_ns);
/* What is swiped or dragged, in order. */
void timeline_span_now(const panel *self, int64_t *out_from_ns, int64_t *out_to_ns);
void timeline_fit(panel *self);
void timeline_say(panel *self, const error *err);  /* as news */
double timeline_clip_speed(const take_clip *clip); /* of all of it */
void timeline_edit(panel *self, edit *e);          /* makes it, and finishes it */

void timeline_own_words(const take_layer *lane, char *out, size_t capacity);
uint32_t timeline_own_regions(const take_layer *lane); /* bits; those whose patterns it has */
bool timeline_is_of_regions(const char *pattern, uint32_t regions);
/* Of a comp lane: how much later it lies than its own time; 0 at first. */
int64_t timeline_comp_later_ns(const panel *self, uint32_t index);
void timeline_comp_slide(panel *self, uint32_t index, int64_t later_ns);
take_layer timeline_comp_lane(const panel *self, uint32_t index); /* its lowest, as it lies; the
                                                                     clips are the comp's */
void timeline_slide_note(panel *self, uint32_t index, int64_t before_ns); /* it was slid */

/* strip.c */
void timeline_strip_draw(panel *self, ui *on, ui_rectangle where);
void timeline_history_dialog(panel *self, ui *on);

/* paint.c */
void timeline_paint_ruler(panel *self, ui *on);
void timeline_paint_over(panel *self, ui *on); /* what is being performed over the take */
void timeline_paint_head(panel *self, ui *on); /* over everything */
void timeline_paint_corner(panel *self, ui *on, const ui_canvas *canvas);
void timeline_paint_rows(panel *self, ui *on);

/* mouse.c */
int64_t timeline_sound_ns(const panel *self); /* of the take; 0: none, or not known yet */
void timeline_mouse(panel *self, ui *on, const ui_canvas *canvas);

/* menu.c */
void timeline_menu(panel *self, ui *on);
void timeline_ask_layer(panel *self, ui *on, uint32_t id); /* 0: a new one */
void timeline_ask_clip(panel *self, ui *on, uint32_t id);
void timeline_ask_marker(panel *self, ui *on, int32_t marker);
void timeline_dialogs(panel *self, ui *on);

/* journal.c */
uint64_t timeline_journal_input(live *stage, uint32_t index); /* for timeline_journal_note */
void timeline_paint_journal(panel *self, ui *on, const ui_canvas *canvas);

/* take_list.c */
void timeline_takes_draw(panel *self, ui *on, ui_rectangle where);
void timeline_takes_update(panel *self, double dt_s);
void timeline_takes_dialog(panel *self, ui *on);

#endif
