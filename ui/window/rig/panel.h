/* window/rig/panel.h - the state of the rig panel, shared by its files. panel.c: the panel and the
 * tabs Regions, Contacts and Check. parts.c: the tabs Parts and Jaw. on_face.c: pointer and drawing
 * on the face. No other folder includes this header. [main] */
#ifndef MAROTTE_UI_WINDOW_RIG_PANEL_H
#define MAROTTE_UI_WINDOW_RIG_PANEL_H
#include "window/panels/panels.h"
#include "window/rig/brush.h"
#include "window/rig/gizmo.h"
#include "window/rig/model.h"
#include "window/viewport/viewport.h"

#define RIG_PANEL_LABEL 74.0f  /* x of the widgets in a row, points */
#define RIG_PANEL_RIGHT 292.0f /* right end of the rows, points */

typedef enum rig_tab {
    RIG_TAB_REGIONS = 0,
    RIG_TAB_CONTACTS,
    RIG_TAB_JAW,
    RIG_TAB_PARTS,
    RIG_TAB_CHECK,
    RIG_TABS
} rig_tab;

enum { RIG_PANEL_NAME = 64, RIG_PANEL_TROUBLE = 1024, RIG_PANEL_PATH = 4096 };

typedef struct rig_painting { /* state of the brush */
    bool is_on;
    rig_stroke_ink ink;
    brush_shape shape;
    rig_stroke *stroke; /* NULL: no stroke in progress */
} rig_painting;

typedef struct rig_naming { /* name of a list item while it is typed */
    char text[RIG_PANEL_NAME];
    uint32_t of, number; /* item and number of its rig state */
} rig_naming;

typedef struct rig_placing { /* placing of contacts on the face */
    bool is_adding;          /* the next click places a new one */
    bool is_pressed;         /* pressed on the dot of the selected contact */
    bool is_moving;          /* dragged after the press */
    rig_ray pressed;         /* ray at the press */
    uint32_t vertex;         /* target of the drag */
    rig_naming name;
} rig_placing;

typedef struct rig_jawing {                /* jaw axis and movement */
    rig_edit_jaw jaw;                      /* as shown; differs from the rig only during a change */
    bool is_changing;                      /* a slider or a handle is held */
    rig_handle held;                       /* RIG_HANDLES: none */
    vec3 grip;                             /* vector from the grabbed point to the handle */
    double open_deg, aside_mm, forward_mm; /* tried values */
    double gap_mm;                         /* movement of the lower incisor, as tried */
} rig_jawing;

typedef struct rig_mouthing { /* mouth as shown; differs from the rig only while a slider is held */
    double upper_percent, stickiness_mm;
    double sealed_percent; /* tried values */
    bool is_held;
} rig_mouthing;

typedef struct rig_parting {    /* bones, collision shapes, poses */
    uint32_t bone, proxy, pose; /* selection, at most one of the three; RIG_NONE */
    uint32_t kind;              /* kind of the bone to add */
    rig_naming bone_name, pose_name;
    vec3 centre, radii; /* of the selected item as shown; radii.x for a ball */
    bool is_held;       /* a slider is being dragged */
    uint32_t turn;      /* selected turn of the selected ball; RIG_NONE */
    rig_turn turn_now;  /* as shown; the rig owns the name */
    rig_naming turn_name;
    bool is_turn_held, has_own_axis; /* has_own_axis: custom axis selected */
    double tried_rad[RIG_TURNS_MAX]; /* tried on the face */
    rig_spring spring;               /* of the selected ball, as shown */
    bool is_spring_held;
} rig_parting;

typedef struct rig_shown {       /* state of the viewport */
    bool is_released;            /* the panel is hidden and shows nothing */
    bool is_tinted, is_tint_new; /* is_tint_new: the tint must be sent again */
    uint32_t vertex_count;       /* size of the buffers below */
    float *rgb, *share;          /* vertex_count by 3; vertex_count */
    float *position, *normal;    /* vertex_count by 3, for the tried pose */
    float *scratch;              /* 6 by vertex_count */
    bool stands_in, is_shape_new;
} rig_shown;

struct panel {
    app *of;
    rig_model *model; /* NULL: no face, or no memory */
    const rig *stage_rig;
    const float *stage_position; /* identifies the face of the stage */
    char *stage_path;
    bool stage_rig_is_file; /* false: the stage opened a mesh file, and its rig is new */
    bool adopts;            /* the next face of the stage comes from the model */
    double known_s;         /* time since the face was opened */
    bool is_shown, was_unsaved;
    bool is_draft_wanted; /* start a draft when the model exists */
    uint32_t tab;
    error err;                       /* error of the current change */
    char trouble[RIG_PANEL_TROUBLE]; /* error of the last action; may be "" */
    char *confirm;                   /* lines of a draft to check; NULL: none */
    uint32_t region, contact;        /* selected; RIG_NONE */
    bool is_to_follow;               /* scroll to the selected row */
    bool is_even;                    /* symmetric edits: strokes, contacts, jaw */
    rig_naming region_name;
    rig_edit_region_values says; /* effect of the selected region while a slider is held */
    bool is_says_held;
    rig_painting painting;
    rig_placing placing;
    rig_jawing jawing;
    rig_mouthing mouthing;
    rig_parting parting;
    rig_shown shown;
};

/* ---- changes: begin, change the copy, finish; one step of undo (panel.c) ---- */

rig *rig_panel_begin(panel *self); /* NULL: failed, reported to the user */
/* Commits a change. words: name of the undo step, such as "paint jaw". result < 0: reports
 * self->err and changes nothing. */
bool rig_panel_finish(panel *self, mrt_result result, const char *words);
void rig_panel_report(panel *self, const char *trouble); /* reports an error; "" clears it */
void rig_panel_choose(panel *self, rig_tab tab, uint32_t index); /* index: region or contact */

/* Draws a name field. Returns true when the user has entered another name. */
bool rig_panel_draw_name(const panel *self, ui *on, const char *hint, rig_naming *naming,
                         uint32_t of, const char *name);
void rig_panel_write_right(ui *on, const char *words); /* right-aligned in the row */

/* ---- on the face (on_face.c) ---- */

void rig_panel_face(panel *self, viewport *view);    /* in each frame while the panel is visible */
void rig_panel_release(panel *self, viewport *view); /* when the panel is no longer visible */
void rig_panel_end_stroke(panel *self);
void rig_panel_shown_finish(rig_shown *shown);
void rig_panel_commit_jaw(panel *self); /* writes the shown jaw into the rig */

/* ---- tabs in parts.c ---- */

void rig_panel_draw_jaw(panel *self, ui *on);
void rig_panel_draw_parts(panel *self, ui *on);
/* Selects at most one of the three. */
void rig_panel_choose_part(panel *self, uint32_t bone, uint32_t proxy, uint32_t pose);
void rig_panel_keep_part(panel *self); /* drops a selection that no longer exists */
/* Writes the selected pose into shown.position. Returns false if it cannot be shown. */
bool rig_panel_show_pose(panel *self);
/* Draws the selection as lines and dots. Returns the number of items. */
uint32_t rig_panel_part_items(const panel *self, overlay_item *out, uint32_t capacity);

#endif
