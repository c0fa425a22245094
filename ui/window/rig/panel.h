/* window/rig/panel.h - the state of the rig panel, which its files share: panel.c has the panel and
 * the tabs of regions, contacts and checks, parts.c those of bones, poses and the jaw, on_face.c
 * what the pointer does on the face and how the rig is shown there. No other room includes this
 * header. [main] */
#ifndef MAROTTE_UI_WINDOW_RIG_PANEL_H
#define MAROTTE_UI_WINDOW_RIG_PANEL_H
#include "window/panels/panels.h"
#include "window/rig/brush.h"
#include "window/rig/gizmo.h"
#include "window/rig/model.h"
#include "window/viewport/viewport.h"

#define RIG_PANEL_LABEL 74.0f  /* points: where the widgets of a line begin */
#define RIG_PANEL_RIGHT 292.0f /* where rows end */

typedef enum rig_tab {
    RIG_TAB_REGIONS = 0,
    RIG_TAB_CONTACTS,
    RIG_TAB_JAW,
    RIG_TAB_PARTS,
    RIG_TAB_CHECK,
    RIG_TABS
} rig_tab;

enum { RIG_PANEL_NAME = 64, RIG_PANEL_TROUBLE = 1024, RIG_PANEL_PATH = 4096 };

typedef struct rig_painting { /* the brush */
    bool is_on;
    rig_stroke_ink ink;
    brush_shape shape;
    rig_stroke *stroke; /* NULL: none is being made */
} rig_painting;

typedef struct rig_naming { /* of one of a list, as it is typed */
    char text[RIG_PANEL_NAME];
    uint32_t of, number; /* of which and which state that is */
} rig_naming;

typedef struct rig_placing { /* of contacts, on the face */
    bool is_adding;          /* the next click places a new one */
    bool is_pressed;         /* on the dot of the chosen contact */
    bool is_moving;          /* and was dragged */
    rig_ray pressed;         /* where */
    uint32_t vertex;         /* where it is dragged to */
    rig_naming name;
} rig_placing;

typedef struct rig_jawing {                /* the axis, and how the jaw moves about it */
    rig_edit_jaw jaw;                      /* as shown; the rig's but while it is changed */
    bool is_changing;                      /* a slider or a handle is held */
    rig_handle held;                       /* RIG_HANDLES: none */
    vec3 grip;                             /* from where it was taken hold of to the handle */
    double open_deg, aside_mm, forward_mm; /* tried */
    double gap_mm;                         /* of the incisors, as tried */
} rig_jawing;

typedef struct rig_mouthing { /* the mouth, as shown; the rig's but while a slider is held */
    double upper_percent, stickiness_mm;
    double sealed_percent; /* tried */
    bool is_held;
} rig_mouthing;

typedef struct rig_parting {    /* bones, what skin does not enter, poses */
    uint32_t bone, proxy, pose; /* that is chosen, at most one of them; RIG_NONE */
    uint32_t kind;              /* of the bone that is to be added */
    rig_naming bone_name, pose_name;
    vec3 centre, radii; /* of the chosen one as shown; of a ball radii.x */
    bool is_held;       /* a slider is dragged */
    uint32_t turn;      /* of the chosen ball, that is chosen; RIG_NONE */
    rig_turn turn_now;  /* as shown; its name is the rig's */
    rig_naming turn_name;
    bool is_turn_held, has_own_axis; /* own: none of the usual ones was asked for */
    double tried_rad[RIG_TURNS_MAX]; /* on the face */
} rig_parting;

typedef struct rig_shown {       /* what the viewport was told */
    bool is_released;            /* nothing: the panel is not seen */
    bool is_tinted, is_tint_new; /* new: it is to be told again */
    uint32_t vertex_count;       /* of the memory below */
    float *rgb, *share;          /* vertex_count by 3; vertex_count */
    float *position, *normal;    /* vertex_count by 3: of the jaw that is tried */
    float *scratch;              /* 6 by vertex_count */
    bool stands_in, is_shape_new;
} rig_shown;

struct panel {
    app *of;
    rig_model *model; /* NULL: there is no face, or no memory */
    const rig *stage_rig;
    const float *stage_position; /* which face that is */
    char *stage_path;
    bool stage_rig_is_file; /* false: the stage's face is a mesh's file, its rig is new */
    bool adopts;            /* the next face of the stage is the model's own */
    double known_s;         /* since the face is known */
    bool is_shown, was_unsaved;
    bool is_draft_wanted; /* as soon as there is a model */
    uint32_t tab;
    error err;                       /* of the change that is made */
    char trouble[RIG_PANEL_TROUBLE]; /* of the last thing that was done; "" */
    char *confirm;                   /* of a draft, lines; NULL */
    uint32_t region, contact;        /* that is chosen; RIG_NONE */
    bool is_to_follow;               /* it was chosen: its row is to be seen */
    bool is_even;                    /* both sides alike: strokes, contacts, the jaw */
    rig_naming region_name;
    rig_edit_says says; /* of the chosen region while a slider is held */
    bool is_says_held;
    rig_painting painting;
    rig_placing placing;
    rig_jawing jawing;
    rig_mouthing mouthing;
    rig_parting parting;
    rig_shown shown;
};

/* ---- changes: begin, change the copy, finish; one step of undo (panel.c) ---- */

rig *rig_panel_begin(panel *self); /* NULL: it is said why */
/* words: "paint jaw". On result < 0 nothing has changed, and it is said why: self->err. */
bool rig_panel_finish(panel *self, mrt_result result, const char *words);
void rig_panel_say(panel *self, const char *trouble);            /* "": nothing */
void rig_panel_choose(panel *self, rig_tab tab, uint32_t index); /* a region, a contact */

/* A name that is typed; true: it was ended and is another one. */
bool rig_panel_draw_name(const panel *self, ui *on, const char *hint, rig_naming *naming,
                         uint32_t of, const char *name);
void rig_panel_write_right(ui *on, const char *words); /* at the end of a row */

/* ---- on the face (on_face.c) ---- */

void rig_panel_face(panel *self, viewport *view);    /* each frame in which it is seen */
void rig_panel_release(panel *self, viewport *view); /* when it no longer is */
void rig_panel_end_stroke(panel *self);
void rig_panel_shown_finish(rig_shown *shown);
void rig_panel_put_jaw(panel *self); /* what is shown of it into the rig */

/* ---- the tabs that are in parts.c ---- */

void rig_panel_draw_jaw(panel *self, ui *on);
void rig_panel_draw_parts(panel *self, ui *on);
/* At most one of the three. */
void rig_panel_choose_part(panel *self, uint32_t bone, uint32_t proxy, uint32_t pose);
void rig_panel_keep_part(panel *self); /* what is chosen may be gone */
/* The chosen pose into shown.position; false: it cannot be shown. */
bool rig_panel_show_pose(panel *self);
/* What is chosen, as lines and dots. Returns how many. */
uint32_t rig_panel_part_items(const panel *self, overlay_item *out, uint32_t capacity);

#endif
