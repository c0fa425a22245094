/* window/app/pose_palette.h - who plays the poses of the stage (live.h, palette.h): a click, a key,
 * a pad, a fader, a button or the remote control. Several of them may play one pose; their
 * strengths add up, at most to 1. Holds what was learnt, the fade times and the favourites, which
 * are kept between runs. Leaves out the pictures (panels/poses.c). [main] */
#ifndef MAROTTE_UI_WINDOW_APP_POSE_PALETTE_H
#define MAROTTE_UI_WINDOW_APP_POSE_PALETTE_H
#include "stage/perform/patch.h"
#include "window/app/settings.h"

enum { POSE_TRIGGERS_MAX = 128, POSE_FAVOURITES_MAX = 64, POSE_NAME = 48 };

typedef enum pose_mode {
    POSE_HOLD = 0, /* the pose stays while the key is down */
    POSE_LATCH     /* one press fades the pose in, the next one out */
} pose_mode;

typedef struct pose_trigger { /* a control that plays a pose */
    char pose[POSE_NAME];
    uint32_t key;                                /* ui_types.h; 0: the channel of an input */
    char input[PATCH_NAME], channel[PATCH_NAME]; /* as of a patch connection */
    bool follows; /* a fader: the strength follows it; false: it is pressed, as hard as its value */
} pose_trigger;

typedef struct pose_settings {
    pose_mode mode;
    double fade_in_s, fade_out_s; /* 0..POSE_FADE_MOST_S */
    double strength;              /* 0..1: of clicks and keys; pads and faders have their own */
    uint32_t trigger_count, favourite_count;
    pose_trigger trigger[POSE_TRIGGERS_MAX];
    char favourite[POSE_FAVOURITES_MAX][POSE_NAME];
} pose_settings;
#define POSE_FADE_MOST_S 3.0

struct app;
typedef struct pose_palette pose_palette;
pose_palette *pose_palette_create(struct app *of, const settings *from); /* NULL: no memory */
void pose_palette_destroy(pose_palette *self);                           /* NULL is fine */

/* Brings the palette onto the stage, so that poses can be played: not before the end of a take that
 * is being recorded. It happens by itself where something was learnt. */
void pose_palette_want(pose_palette *self);
/* Why poses cannot be played now; "": they can, or the palette was not wanted. */
const char *pose_palette_trouble(const pose_palette *self);
/* Once a frame, before what is drawn. */
void pose_palette_update(pose_palette *self);

const pose_settings *pose_palette_settings(const pose_palette *self);
/* As one step of undo, described by `words`. The settings are kept. */
void pose_palette_change(pose_palette *self, const pose_settings *to, const char *words);

/* The poses of the face: live_poses, as far as they can be played. 0: none yet. */
uint32_t pose_palette_count(const pose_palette *self);
const char *pose_palette_name(const pose_palette *self, uint32_t pose); /* of the rig */
/* UINT32_MAX: the face has no such pose. */
uint32_t pose_palette_find(const pose_palette *self, const char *name);
double pose_palette_wanted(const pose_palette *self, uint32_t pose); /* 0..1 */

/* ---- playing ---- */

/* A pose under the mouse: down with a click, up with its end. */
void pose_palette_press(pose_palette *self, uint32_t pose);
void pose_palette_release(pose_palette *self);
/* The state of the keys in this frame. is_taken: tells which keys have another use now; NULL: none.
 */
struct ui;
void pose_palette_read_keys(pose_palette *self, const struct ui *keys,
                            bool (*is_taken)(uint32_t key));
/* Whether a key plays a pose, or is to be learnt, so that it has no other meaning. */
bool pose_palette_has_key(const pose_palette *self, uint32_t key);
/* Fades a pose to `amount` within fade_s, in addition to its other controls. An error names what
 * the face has. */
CHECKED mrt_result pose_palette_set(pose_palette *self, const char *name, double amount,
                                    double fade_s, error *err);
/* Everything that is latched, set or pressed fades out. */
void pose_palette_release_all(pose_palette *self, double fade_s);

/* ---- learning: the next key, pad, button or fader plays the pose ---- */

void pose_palette_learn(pose_palette *self, uint32_t pose); /* UINT32_MAX: ends */
uint32_t pose_palette_learns(const pose_palette *self);     /* UINT32_MAX: none */
/* Writes what plays a pose: "Q, note.36"; "": nothing. */
void pose_palette_describe(const pose_palette *self, const char *name, char *out, size_t capacity);

#endif
