/* window/app/action.h - table of all actions of the stage: name, key, help. Keys (which the user
 * can change: key_map.h), buttons, the list behind `?` and scripts use it. Leaves out what an
 * action does (app.h). Constant data. */
#ifndef MAROTTE_UI_WINDOW_APP_ACTION_H
#define MAROTTE_UI_WINDOW_APP_ACTION_H
#include <stdbool.h>
#include <stdint.h>

typedef enum action {
    ACTION_NONE = 0,
    /* performance */
    ACTION_RECORD,    /* R: begins a take, ends it; over a take that is shown: performs over it */
    ACTION_KEEP,      /* K: the last 30 s become a take */
    ACTION_MARK,      /* M: this instant */
    ACTION_NEUTRAL,   /* N: everything that is held or pulled eases back to rest */
    ACTION_REZERO,    /* Z: the pose that the hands hold now is their neutral one */
    ACTION_LIVE,      /* L: back to the live hands */
    ACTION_HAND_KEYS, /* Y: the keyboard is a hand, until Escape (virtual_hand.h) */
    ACTION_LIFE,      /* Shift+L: the face lives by itself, or rests (kept_life.h) */
    /* transport */
    ACTION_PLAY,           /* Space */
    ACTION_STOP,           /* Shift+Space: stop, to where it was started */
    ACTION_TO_START,       /* Home */
    ACTION_TO_END,         /* End */
    ACTION_FRAME_BACK,     /* , */
    ACTION_FRAME_FORWARD,  /* . */
    ACTION_SECOND_BACK,    /* Left */
    ACTION_SECOND_FORWARD, /* Right */
    ACTION_LOOP,           /* O */
    ACTION_LOOP_IN,        /* I */
    ACTION_LOOP_OUT,       /* Shift+I */
    ACTION_SLOWER,         /* - */
    ACTION_FASTER,         /* = */
    ACTION_TAKE_BEFORE,    /* PageDown: the list has the newest on top */
    ACTION_TAKE_NEXT,      /* PageUp */
    ACTION_SOUND_ARM,      /* A: the microphone is recorded too */
    /* edits */
    ACTION_UNDO,       /* Ctrl+Z */
    ACTION_REDO,       /* Ctrl+Shift+Z */
    ACTION_SPLIT,      /* S: the clip that is chosen, at the play head */
    ACTION_TRIM_START, /* [ */
    ACTION_TRIM_END,   /* ] */
    ACTION_REMOVE,     /* Delete: what is chosen */
    ACTION_MUTE,       /* U: the layer or clip that is chosen */
    ACTION_SOLO,       /* Shift+U */
    ACTION_RATE_0,     /* 0 .. */
    ACTION_RATE_1,
    ACTION_RATE_2,
    ACTION_RATE_3,
    ACTION_RATE_4,
    ACTION_RATE_5,    /* 5 */
    ACTION_DUPLICATE, /* Ctrl+D: the take that is chosen */
    ACTION_EXPORT,    /* Ctrl+E: the same */
    /* view */
    ACTION_VIEW_FRONT,         /* F */
    ACTION_VIEW_SIDE,          /* D */
    ACTION_VIEW_THREE_QUARTER, /* G */
    ACTION_VIEW_MIRROR,        /* X: as in a mirror */
    ACTION_VIEW_FRAME,         /* Shift+F: the whole face */
    ACTION_VIEW_TURNTABLE,     /* T */
    ACTION_SHOW_HANDS,         /* H */
    ACTION_SHOW_VECTORS,       /* V */
    ACTION_SHOW_SUPPORTS,      /* Shift+V */
    ACTION_SHOW_CONTACTS,      /* C */
    ACTION_SHOW_JAW,           /* J: the jaw's axis */
    ACTION_SHOW_CARD,          /* Shift+H: card of what each part of the hand does */
    ACTION_HEAT_NEXT,          /* W: no heat map, weights, mobility, strain, penetration */
    ACTION_OUTPUT,             /* F11: the face alone on the second monitor */
    ACTION_OUTPUT_MIRROR,      /* Shift+F11 */
    ACTION_FACE_ONLY,          /* B: panels away */
    /* program */
    ACTION_PANEL_DEVICES,  /* F2 */
    ACTION_PANEL_MAPPING,  /* F3 */
    ACTION_PANEL_RIG,      /* F4 */
    ACTION_PANEL_ENGINE,   /* F5 */
    ACTION_PANEL_LOG,      /* F6 */
    ACTION_PANEL_PATCH,    /* Shift+F3 */
    ACTION_PANEL_OUTPUT,   /* Shift+F2 */
    ACTION_PANEL_SCENE,    /* Shift+F4 */
    ACTION_PANEL_HAND,     /* Shift+F5 */
    ACTION_PANEL_POSES,    /* Shift+F6 */
    ACTION_PANEL_LEFT,     /* Ctrl+Left: the panel that was shown last, to the left dock */
    ACTION_PANEL_RIGHT,    /* Ctrl+Right */
    ACTION_PANEL_FLOAT,    /* Ctrl+Up: over the face */
    ACTION_PANEL_HIDE,     /* Ctrl+Down */
    ACTION_LAYOUT_PERFORM, /* Ctrl+1 */
    ACTION_LAYOUT_EDIT,    /* Ctrl+2 */
    ACTION_LAYOUT_RIG,     /* Ctrl+3 */
    ACTION_LAYOUT_RESET,   /* Ctrl+0 */
    ACTION_LAYOUT_KEEP,    /* new shows start with the layouts of this one */
    ACTION_TIMELINE,       /* F7: shown or not */
    ACTION_TIMELINE_FIT,   /* Shift+Z */
    ACTION_SNAP,           /* Shift+S: drags on the timeline snap, or not */
    ACTION_RIPPLE,         /* Shift+R: what follows moves with edits of clips, or stays */
    ACTION_NEW,            /* Ctrl+N: a new show */
    ACTION_OPEN,           /* Ctrl+O: a show or a face */
    ACTION_SAVE,           /* Ctrl+S: the rig */
    ACTION_SAVE_AS,        /* Ctrl+Shift+S: the show or the rig, under another name */
    ACTION_MENU,           /* F10 */
    ACTION_PALETTE,        /* Ctrl+Shift+P: finds an action by its name */
    ACTION_GUIDES,         /* F1 */
    ACTION_ABOUT,
    ACTION_TOUR, /* Shift+F1 */
    ACTION_HELP, /* ? */
    ACTION_QUIT, /* Ctrl+Q */
    ACTION_COUNT
} action;

typedef enum action_group {
    ACTION_PERFORMANCE = 0,
    ACTION_TRANSPORT,
    ACTION_EDIT,
    ACTION_VIEW,
    ACTION_PROGRAM,
    ACTION_GROUPS
} action_group;
extern const char *const action_group_name[ACTION_GROUPS];

typedef struct action_entry {
    action_group group;
    const char *name;        /* "record": for scripts */
    const char *title;       /* "Record" */
    const char *help;        /* one sentence */
    uint32_t key, modifiers; /* ui.h; as the program brings them */
} action_entry;
const action_entry *action_of(action id); /* for ever; id < ACTION_COUNT */
action action_named(const char *name);    /* ACTION_NONE: no such */

#endif
