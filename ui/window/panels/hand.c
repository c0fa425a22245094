/* The hand panel: the hand card of the mapping, the exercise "Say it", and "Simon says", which
 * teaches the mapping the hand poses of a performer. */
#include "window/panels/hand.h"
#include "window/gui/theme.h"
#include "window/panels/hand_card.h"
#include "window/panels/hand_lights.h"
#include "window/panels/mapping.h"
#include "window/panels/say_it.h"
#include "window/panels/simon.h"
#include "window/viewport/posed_shape.h"
#include "window/viewport/viewport.h"

#include "stage/mapping/taught.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Angles of a relaxed hand, in sensor order. They are used while no hand is tracked, and for the
 * initial order of the lines. */
static const float relaxed_rad[MRT_ANGLES] = {0.8f,  0.15f, 0.2f,  0.4f, 0.3f,  0.35f, 0.2f,  0.3f,
                                              0.35f, 0.2f,  0.05f, 0.3f, 0.35f, 0.2f,  0.05f, 0.3f,
                                              0.35f, 0.2f,  0.08f, 0.1f, 0.0f,  0.0f};

enum { VALUES_MAX = 256 };
enum { TAB_CARD = 0, TAB_SAY_IT, TAB_SIMON, TABS };
static const char *const tabs[TABS] = {"Card", "Say it", "Simon says"};

/* Lesson that the mapping is learning. */
typedef enum lesson_kind {
    LESSON_NONE = 0,
    LESSON_ANSWER,
    LESSON_FORGET,
    LESSON_FORGET_ALL
} lesson_kind;

struct panel {
    app *app;
    uint32_t tab;
    bool was_drawn, was_pedal_down;
    uint32_t pedal;  /* pedal that answers and skips, 1..MRT_MAX_PEDALS; 0: no free pedal */
    bool is_pressed; /* the pedal was pressed in this frame */

    /* ---- the card ---- */
    const mrt_plugin_type *type; /* of the active mapping; only compared, never dereferenced */
    double value[VALUES_MAX];    /* of its parameters */
    const mrt_card_line *line;
    uint32_t line_count, side;
    char device[INPUT_NAME]; /* "": no input measures a hand */
    bool is_present;
    hand_lights lights;
    float angle_rad[MRT_ANGLES], rest_rad[MRT_ANGLES];
    float steady_rad[MRT_ANGLES]; /* smoothed; recorded as the answer */
    float order_rad[MRT_ANGLES];  /* angles that determine the order of the lines */
    double still_s;               /* time for which the hand stays at steady_rad */
    hand_skeleton *skeleton[2];

    /* ---- goals ---- */
    posed_shape *shapes;
    bool needs_shapes; /* a tab that shows a goal was opened */
    const rig *rig;    /* with complete poses; valid until the next update */
    goal_face wanted, performed;
    goal_distance how;
    bool is_measured;
    char measured[64]; /* name of the step of `wanted`; may be "" */

    bool says; /* the exercise is running */
    say_it say;
    double cheer_s; /* since the last step was done */

    /* ---- Simon says ---- */
    bool is_teaching;
    simon simon;
    uint32_t face_goal[SIMON_FACES_MAX];  /* index into goals, for each face */
    uint32_t face_label[SIMON_FACES_MAX]; /* value of the parameter "Face" */
    lesson_kind lesson;                   /* lesson in progress */
    double lesson_s;
    unsigned char *before; /* taught state before the lesson */
    size_t before_size;
    simon simon_before;
    float answer_rad[MRT_ANGLES];
    char said[160]; /* result of the last answer */
};

/* ---- the mapping: its card and its lesson parameters ---- */

typedef struct lesson_params { /* indices; param_count: not present */
    uint32_t face, answer, forget, forget_all;
    bool has_all;
} lesson_params;

static bool is_key(const mrt_plugin_type *type, uint32_t index, const char *key)
{
    char own[160];
    instance_key(type, index, own, sizeof own);
    const char *name = strrchr(own, '.');
    return strcmp(name ? name + 1 : own, key) == 0;
}

static uint32_t find_param(const mrt_plugin_type *type, const char *key, uint32_t flags)
{
    for (uint32_t i = 0; i < type->param_count; ++i)
        if ((type->params[i].flags & flags) == flags && is_key(type, i, key))
            return i;
    return type->param_count;
}

static lesson_params lesson_params_of(const mrt_plugin_type *type)
{
    lesson_params out = {
        .face = find_param(type, "face", MRT_PARAM_STEPPED),
        .answer = find_param(type, "answer", MRT_PARAM_TRIGGER),
        .forget = find_param(type, "forget", MRT_PARAM_TRIGGER),
        .forget_all = find_param(type, "forget_all", MRT_PARAM_TRIGGER),
    };
    out.has_all = out.face < type->param_count && type->params[out.face].labels &&
                  out.answer < type->param_count && out.forget < type->param_count &&
                  out.forget_all < type->param_count;
    return out;
}

/* Finds the value of the parameter with this label. Returns false if there is none. */
static bool find_label(const mrt_param *p, const char *name, uint32_t *out)
{
    for (uint32_t i = 0; p->labels[i]; ++i)
        if (strcmp(p->labels[i], name) == 0) {
            *out = i;
            return true;
        }
    return false;
}

static bool measures(const mrt_channels *of, uint32_t side)
{
    for (uint32_t i = 0; i < of->count; ++i)
        if (channel_is_angle(&of->channel[i]) && of->channel[i].hand == side)
            return true;
    return false;
}

/* Finds the first input that measures the performing hand. Returns false if there is none. */
static bool find_input(panel *self, mrt_channels *out, mrt_sample *room)
{
    live *stage = app_live(self->app);
    for (uint32_t i = 0; i < live_input_count(stage); ++i) {
        const input *of = live_input(stage, i);
        if (!live_input_sample(stage, i, room))
            continue;
        *out = (mrt_channels){.name = input_name(of), .value = room->value};
        out->channel = input_channels(of, &out->count);
        if (measures(out, self->side))
            return true;
    }
    return false;
}

/* Returns NULL if the mapping has more than VALUES_MAX parameters. */
static const double *read_values(panel *self, const instance *mapping)
{
    for (uint32_t i = 0; i < mapping->type->param_count && i < VALUES_MAX; ++i)
        self->value[i] = instance_value(mapping, i);
    return mapping->type->param_count <= VALUES_MAX ? self->value : NULL;
}

static void follow_card(panel *self, const instance *mapping)
{
    const mrt_hand_card *card =
        mapping ? plugin_interface(isolate_inner(mapping->type), MRT_HAND_CARD) : NULL;
    const mrt_hand *hand = app_view(self->app)->hand;
    mrt_channels channels;
    mrt_sample sample;
    if (hand[MRT_RIGHT].present || hand[MRT_LEFT].present)
        self->side = hand[MRT_RIGHT].present ? MRT_RIGHT : MRT_LEFT;
    self->is_present = hand[self->side].present;
    const bool has_input = find_input(self, &channels, &sample);
    (void)snprintf(self->device, sizeof self->device, "%s", has_input ? channels.name : "");
    const double *values = card ? read_values(self, mapping) : NULL;
    self->line_count = 0;
    self->line =
        values ? card->lines(values, has_input ? &channels : NULL, self->side, &self->line_count)
               : NULL;
}

/* Returns whether lights still fade or smoothed angles still move. */
static bool is_hand_moving(const panel *self)
{
    static const float level_least = 0.01f, angle_least = 0.005f;
    bool is_moving = false;
    for (uint32_t i = 0; i < HAND_LIGHTS_MAX; ++i)
        is_moving |= self->lights.level[i] > level_least;
    for (int i = 0; i < MRT_ANGLES; ++i)
        is_moving |= fabsf(self->angle_rad[i] - self->steady_rad[i]) > angle_least;
    return is_moving;
}

static void follow_hand(panel *self, double dt_s)
{
    static const double steady_s = 0.15;
    static const float still_rad = 0.04f;
    const mrt_hand *hand = &app_view(self->app)->hand[self->side];
    bool is_still = true;
    const float share = (float)(1.0 - exp(-dt_s / steady_s));
    for (int i = 0; i < MRT_ANGLES; ++i) {
        const float now = hand->present && isfinite(hand->angle[i])
                              ? fminf(fmaxf(hand->angle[i], -3.0f), 3.0f)
                              : self->rest_rad[i];
        self->angle_rad[i] = now;
        self->steady_rad[i] += share * (now - self->steady_rad[i]);
        is_still &= fabsf(now - self->steady_rad[i]) < still_rad;
    }
    self->still_s = is_still ? self->still_s + dt_s : 0.0;
    hand_lights_update(&self->lights, self->line, self->line_count, hand, dt_s);
    if (is_hand_moving(self))
        app_want_frame(self->app, 0.0);
}

/* Selects the last pedal that has no other function. */
static void follow_pedal(panel *self, const instance *mapping)
{
    const double *values = mapping ? read_values(self, mapping) : NULL;
    const uint32_t rezero =
        (uint32_t)settings_number(app_settings(self->app), APP_REZERO_PEDAL, 0.0);
    char words[256];
    self->pedal = 0;
    for (uint32_t pedal = MRT_MAX_PEDALS; values && pedal > 0 && self->pedal == 0; --pedal) {
        pedal_table_words(mapping->type, values, pedal, words, sizeof words);
        if (!words[0] && pedal != rezero)
            self->pedal = pedal;
    }
    const bool is_down = self->pedal > 0 && app_view(self->app)->pedal[self->pedal - 1] > 0.5f;
    self->is_pressed = is_down && !self->was_pedal_down;
    self->was_pedal_down = is_down;
}

/* ---- goals ---- */

/* Measures the live face against a step. */
static void measure(panel *self, const goal_step *step)
{
    const live_view *view = app_view(self->app);
    self->is_measured = false;
    if (!step || !self->rig || !view->about)
        return;
    if (strcmp(self->measured, step->name) != 0 &&
        !goal_face_of_rig(&self->wanted, step, self->rig, view->about))
        return;
    (void)snprintf(self->measured, sizeof self->measured, "%s", step->name);
    goal_face_of_pull(&self->performed, &view->pull, view->meter.dof, view->about);
    self->how = goal_measure(&self->wanted, &self->performed);
    self->is_measured = true;
}

static const goal_step *step_now(const panel *self)
{
    if (self->tab == TAB_SAY_IT)
        return self->says ? say_it_step(&self->say) : NULL;
    const uint32_t asked = self->is_teaching ? simon_asked(&self->simon) : SIMON_FACES_MAX;
    return self->is_teaching && asked < self->simon.face_count
               ? &goals[self->face_goal[asked]].step[0]
               : NULL;
}

static void follow_goal(panel *self, double dt_s)
{
    const rig *before = self->rig;
    if (self->needs_shapes)
        posed_shape_follow(self->shapes, app_face(self->app));
    self->rig = self->needs_shapes ? posed_shape_rig(self->shapes) : NULL;
    if (self->rig != before) {
        self->measured[0] = '\0';
        self->says = self->is_teaching = false;
    }
    measure(self, step_now(self));
    self->cheer_s += dt_s;
    if (self->tab == TAB_SAY_IT && self->says && self->is_measured && self->is_present &&
        say_it_update(&self->say, &self->how, dt_s))
        self->cheer_s = 0.0;
}

/* ---- lessons: undo steps ---- */

/* The value of an undo step. */
typedef struct lesson {
    simon simon;
    size_t size;
    unsigned char bytes[]; /* taught state of the mapping */
} lesson;

static void say(panel *self, int32_t level, const char *text)
{
    news_list_add(app_news(self->app), level, "hand", text);
}

static mrt_result set(void *owner, const void *value)
{
    panel *self = owner;
    const lesson *to = value;
    error err = {""};
    const mrt_result result = live_teach(app_live(self->app), to->bytes, to->size, &err);
    if (result < 0) {
        say(self, MRT_LOG_ERROR, err.text);
        return result;
    }
    self->simon = to->simon;
    self->said[0] = '\0';
    return MRT_OK;
}

/* Returns the taught state, which the caller frees. NULL: the mapping has none, or no memory. */
static unsigned char *fetch_taught(panel *self, size_t *out_size)
{
    unsigned char *out = malloc(TAUGHT_BYTES_MAX);
    *out_size = out ? live_taught(app_live(self->app), out, TAUGHT_BYTES_MAX) : 0;
    if (*out_size > 0)
        return out;
    free(out);
    return NULL;
}

/* NULL: no memory. */
static lesson *lesson_of(const simon *of, const unsigned char *bytes, size_t size)
{
    lesson *out = malloc(sizeof *out + size);
    if (!out)
        return NULL;
    *out = (lesson){.simon = *of, .size = size};
    memcpy(out->bytes, bytes, size);
    return out;
}

/* Without memory the lesson stays, but cannot be undone. */
static void keep_step(panel *self, const unsigned char *after, size_t after_size, const char *words)
{
    undo_change made = {.owner = self,
                        .set = set,
                        .before = lesson_of(&self->simon_before, self->before, self->before_size),
                        .after = lesson_of(&self->simon, after, after_size),
                        .bytes = 2 * sizeof(lesson) + self->before_size + after_size};
    if (!made.before || !made.after) {
        free(made.before);
        free(made.after);
        return;
    }
    (void)snprintf(made.words, sizeof made.words, "%s", words);
    app_add_change(self->app, &made);
}

static void end_lesson(panel *self)
{
    free(self->before);
    self->before = NULL;
    self->before_size = 0;
    self->lesson = LESSON_NONE;
}

/* Starts a lesson about a face. The lesson is done when the taught state of the mapping changes. */
static void begin_lesson(panel *self, instance *mapping, lesson_kind kind, uint32_t asked)
{
    const lesson_params at = lesson_params_of(mapping->type);
    const uint32_t trigger = kind == LESSON_ANSWER   ? at.answer
                             : kind == LESSON_FORGET ? at.forget
                                                     : at.forget_all;
    if (self->lesson != LESSON_NONE || !at.has_all)
        return;
    self->before = fetch_taught(self, &self->before_size);
    self->simon_before = self->simon;
    memcpy(self->answer_rad, self->steady_rad, sizeof self->answer_rad);
    self->lesson = kind;
    self->lesson_s = 0.0;
    if (asked < self->simon.face_count)
        instance_set_value(mapping, at.face,
                           mapping->type->params[at.face].min + (double)self->face_label[asked]);
    instance_trigger(mapping, trigger);
}

static void note_lesson(panel *self, lesson_kind kind, uint32_t asked, char *out, size_t capacity)
{
    const char *name = asked < self->simon.face_count ? goals[self->face_goal[asked]].name : "";
    if (kind == LESSON_ANSWER) {
        (void)snprintf(out, capacity, "hand pose for %s", name);
        simon_answer(&self->simon, self->answer_rad);
        const double apart_deg = simon_spread_deg(&self->simon, asked);
        if (self->simon.answered[asked] > 1)
            (void)snprintf(self->said, sizeof self->said,
                           "%s: %.0f\xc2\xb0 from your earlier answer.", name, apart_deg);
        else
            (void)snprintf(self->said, sizeof self->said, "%s: learned.", name);
    } else if (kind == LESSON_FORGET) {
        (void)snprintf(out, capacity, "forget the hand poses for %s", name);
        simon_forget(&self->simon, asked);
        (void)snprintf(self->said, sizeof self->said, "%s: the default hand pose is in use.", name);
    } else {
        (void)snprintf(out, capacity, "forget all hand poses");
        simon_forget_all(&self->simon);
        (void)snprintf(self->said, sizeof self->said, "The default hand poses are in use.");
    }
}

static void follow_lesson(panel *self, double dt_s)
{
    static const double asked_every_s = 0.05, patience_s = 1.0;
    size_t size = 0;
    const lesson_kind kind = self->lesson;
    if (kind == LESSON_NONE)
        return;
    const double before_s = self->lesson_s;
    self->lesson_s += dt_s;
    if (floor(before_s / asked_every_s) >= floor(self->lesson_s / asked_every_s))
        return;
    unsigned char *now = fetch_taught(self, &size);
    const bool is_kept = now && self->before; /* otherwise the lesson is assumed to be done */
    const bool has_learned =
        !is_kept || size != self->before_size || memcmp(now, self->before, size) != 0;
    if (has_learned) {
        char words[EDIT_TEXT];
        note_lesson(self, kind, simon_asked(&self->simon), words, sizeof words);
        if (is_kept)
            keep_step(self, now, size, words);
        end_lesson(self);
    } else if (self->lesson_s > patience_s) {
        (void)snprintf(
            self->said, sizeof self->said, "%s",
            kind == LESSON_ANSWER
                ? "The mapping did not learn the answer. Show your hand, then answer again."
                : "This face already uses the default hand pose.");
        end_lesson(self);
    }
    free(now);
}

/* ---- drawing: the card ---- */

static uint32_t hand_colour(const panel *self)
{
    return !self->is_present ? THEME_OFF : self->side == MRT_LEFT ? THEME_LEFT : THEME_RIGHT;
}

static hand_card card_of(const panel *self)
{
    return (hand_card){.line = self->line,
                       .count = self->line_count,
                       .level = self->lights.level,
                       .skeleton = self->skeleton[self->side],
                       .rest_rad = self->order_rad,
                       .angle_rad = self->angle_rad,
                       .colour = hand_colour(self)};
}

static void draw_absence(panel *self, ui *on)
{
    char words[256], devices[KEY_WORDS + 4], keys[KEY_WORDS];
    if (self->is_present)
        return;
    key_map_after(&app_looks_of(self->app)->keys, ACTION_PANEL_DEVICES, devices);
    key_map_words(&app_looks_of(self->app)->keys, ACTION_HAND_KEYS, keys);
    (void)snprintf(words, sizeof words,
                   "No hand is tracked. Open a glove or a camera in Devices%s, or press %s to use "
                   "the keyboard as a hand.",
                   devices, keys[0] ? keys : "Y");
    ui_text_wrapped(on, UI_STYLE_WARNING, words);
}

/* Uses the dense layout if the card does not fit otherwise. Returns false if neither fits. */
static bool fit_card(const ui *on, hand_card *card, float width, float height)
{
    for (int dense = 0; dense < 2; ++dense) {
        card->is_dense = dense == 1;
        const float high = hand_card_height(on, card, width);
        if (high > 0.0f && high <= height)
            return true;
    }
    return false;
}

/* Lines keep their places during a performance. When the hand is held for two seconds in a way that
 * makes leaders cross (a fist does), the lines are ordered by that hand. */
static void draw_card_at(panel *self, ui *on, ui_rectangle where, const hand_card *card)
{
    static const double held_s = 2.0;
    if (self->still_s > held_s && hand_card_crossings(on, where, card) > 0)
        memcpy(self->order_rad, self->angle_rad, sizeof self->order_rad);
    hand_card_draw(on, where, card);
}

static void draw_card(panel *self, ui *on)
{
    hand_card card = card_of(self);
    app_looks *looks = app_looks_of(self->app);
    char words[200];
    (void)ui_check(on, "Show on the stage", &looks->shows_card);
    ui_hint(on, "Show the card beside the face, also while the panels are hidden.");
    if (self->is_present && self->device[0]) {
        (void)snprintf(words, sizeof words, "%s hand, %.120s",
                       self->side == MRT_LEFT ? "Left" : "Right", self->device);
        ui_text(on, UI_STYLE_DIM, words);
    }
    draw_absence(self, on);
    if (!fit_card(on, &card, ui_available_width(on), ui_available_height(on))) {
        card.is_dense = false;
        ui_scroll_begin(on, "list", 0.0f, 0.0f);
        hand_card_list(on, &card);
        ui_scroll_end(on);
        return;
    }
    ui_canvas at;
    ui_canvas_begin(on, "card", 0.0f, ui_available_height(on), &at);
    draw_card_at(self, on, at.where, &card);
    ui_canvas_end(on);
}

/* ---- drawing: a goal with its ring ---- */

enum { RING_PARTS = 96 };
static const float ring_most = 290.0f, ring_least = 110.0f;

static void draw_arc(ui *on, float x, float y, float radius, double share, uint32_t colour,
                     float thickness)
{
    float xy[2 * (RING_PARTS + 1)];
    const int parts = (int)ceil(share * RING_PARTS);
    for (int i = 0; i <= parts; ++i) {
        const double turn = 6.283185307179586 * fmin((double)i / RING_PARTS, share);
        xy[2 * i] = x + radius * (float)sin(turn);
        xy[2 * i + 1] = y - radius * (float)cos(turn);
    }
    if (parts > 0)
        ui_draw_lines(on, xy, (uint32_t)parts + 1, colour, thickness);
}

static void ground_of(const panel *self, float out[4])
{
    const uint32_t colour = theme_colour(app_looks_of(self->app)->theme, THEME_PANEL);
    for (int i = 0; i < 3; ++i)
        out[i] = (float)(colour >> (24 - 8 * i) & 255u) / 255.0f;
    out[3] = 1.0f;
}

/* Draws the goal face with a ring that shows how close the performed face is. */
static void draw_goal(panel *self, ui *on, const goal_step *step, double closed, float room)
{
    static const uint32_t pixels = 448;
    const float size = fmaxf(fminf(fminf(ui_available_width(on), room), ring_most), ring_least);
    uint32_t vertex_count = 0, texture = 0;
    float ground[4];
    ui_canvas at;
    ui_canvas_begin(on, "goal", 0.0f, size, &at);
    const float x = at.where.x + 0.5f * at.where.width, y = at.where.y + 0.5f * size;
    const float radius = 0.5f * size - 5.0f, half = 0.9f * radius;
    const float *position = posed_shape_of(self->shapes, step->pose, &vertex_count);
    viewport *view = app_viewport(self->app);
    ground_of(self, ground);
    if (!position) /* the shape is being computed */
        ui_want_frame(on, 0.05);
    if (position && view && !ui_is_hidden(on))
        texture = viewport_portrait(view, position, vertex_count, ground, NULL, pixels, pixels);
    if (texture)
        ui_draw_image(on, (ui_rectangle){x - half, y - half, 2.0f * half, 2.0f * half}, texture,
                      viewport_output_drawn(view, VIEWPORT_PORTRAIT),
                      app_looks_of(self->app)->is_mirrored);
    const bool is_cheering = self->cheer_s < 0.5;
    ui_draw_ring(on, x, y, radius, THEME_RAISED, 6.0f);
    draw_arc(on, x, y, radius, is_cheering ? 1.0 : closed,
             is_cheering || closed >= 1.0 ? THEME_GOOD : THEME_ACCENT, 6.0f);
    ui_canvas_end(on);
}

static void draw_centred(ui *on, const char *id, ui_style style, const char *text)
{
    ui_canvas at;
    ui_canvas_begin(on, id, 0.0f, ui_text_height(on, style) + 2.0f, &at);
    const float room = at.where.width - ui_text_width(on, style, text);
    ui_draw_text(on, at.where.x + fmaxf(0.5f * room, 0.0f), at.where.y, style, THEME_TEXT,
                 at.where.width, text);
    ui_canvas_end(on);
}

/* Returns whether the user answered with pedal, Space or Enter. Space is not available while the
 * keyboard controls the virtual hand. */
static bool is_answered(panel *self, ui *on)
{
    app_looks_of(self->app)->is_answering = true;
    return self->is_pressed || ui_pressed(on, UI_KEY_ENTER, 0) ||
           (!app_has_hand_keys(self->app) && ui_pressed(on, ' ', 0));
}

static void write_keys(const panel *self, char *out, size_t capacity, const char *what)
{
    const char *keys = app_has_hand_keys(self->app) ? "Enter" : "Space";
    if (self->pedal > 0)
        (void)snprintf(out, capacity, "%s or pedal %u %s.", keys, self->pedal, what);
    else
        (void)snprintf(out, capacity, "%s %s.", keys, what);
}

/* Returns whether the poses of the rig are ready. Otherwise draws the reason. */
static bool has_goals(panel *self, ui *on)
{
    const face_file *file = app_face(self->app);
    self->needs_shapes = true;
    if (self->rig)
        return true;
    ui_text_wrapped(on, UI_STYLE_DIM,
                    file && file->rig ? "Finding the poses of the rig\xe2\x80\xa6"
                                      : "The face has no rig and therefore no poses to perform.");
    return false;
}

/* ---- drawing: Say it ---- */

static void write_word(const goal *of, uint32_t step, char *out, size_t capacity)
{
    size_t used = 0;
    out[0] = '\0';
    for (uint32_t i = 0; i < goal_step_count(of) && used < capacity; ++i) {
        const int length = snprintf(out + used, capacity - used, i == step ? "%s[%s]" : "%s%s",
                                    i > 0 ? "  " : "", of->step[i].name);
        used += length > 0 ? (size_t)length : 0;
    }
}

static void draw_progress(panel *self, ui *on)
{
    char words[96];
    double took_s;
    uint32_t of;
    const uint32_t met = say_it_progress(&self->say, &of, &took_s);
    if (met > 0)
        (void)snprintf(words, sizeof words, "%u of %u done, %.1f s each", met, of,
                       took_s / (double)met);
    else
        (void)snprintf(words, sizeof words, "%u of %u done", met, of);
    ui_text(on, UI_STYLE_DIM, words);
}

static void draw_saying(panel *self, ui *on)
{
    const goal_step *step = say_it_step(&self->say);
    const goal *of = &goals[self->say.at < GOAL_COUNT ? self->say.at : 0];
    const double closed = self->is_measured && self->is_present ? self->how.closed : 0.0;
    char words[160], keys[64];
    draw_progress(self, on);
    draw_absence(self, on);
    draw_goal(self, on, step, closed, ui_available_height(on) - 170.0f);
    draw_centred(on, "name", UI_STYLE_LARGE, of->name);
    if (goal_step_count(of) > 1) {
        write_word(of, self->say.step, words, sizeof words);
        draw_centred(on, "word", UI_STYLE_STRONG, words);
    }
    (void)snprintf(words, sizeof words, "%.0f %%, %.1f mm off", 100.0 * closed, self->how.off_mm);
    draw_centred(on, "how", UI_STYLE_NUMBER, self->is_measured && self->is_present ? words : "");
    ui_space(on, 4.0f);
    if (ui_button(on, "Previous", UI_PLAIN) || ui_pressed(on, UI_KEY_BACKSPACE, 0))
        say_it_back(&self->say);
    ui_hint(on, "Go back to the face before this one (Backspace).");
    ui_same_line(on);
    if (ui_button(on, "Skip", UI_PLAIN) || is_answered(self, on))
        say_it_skip(&self->say);
    write_keys(self, keys, sizeof keys, "skips this face");
    ui_hint(on, keys);
    ui_same_line(on);
    if (ui_button(on, "Restart", UI_QUIET))
        say_it_begin(&self->say, self->rig);
    ui_hint(on, "Begin again with the first face.");
}

static void draw_say_it(panel *self, ui *on)
{
    if (!has_goals(self, on))
        return;
    if (self->says && say_it_step(&self->say)) {
        draw_saying(self, on);
        return;
    }
    if (self->says)
        draw_progress(self, on);
    ui_text_wrapped(on, UI_STYLE_BODY,
                    "The puppet shows a face. Perform it with your hand. The ring closes as your "
                    "face gets closer. Words follow after the faces.");
    draw_absence(self, on);
    ui_space(on, 4.0f);
    if (ui_button(on, "Start", UI_ACCENT) || is_answered(self, on)) {
        say_it_begin(&self->say, self->rig);
        self->says = true;
        self->cheer_s = 1.0;
    }
    ui_hint(on, "Begin with the first face (Space).");
}

/* ---- drawing: Simon says ---- */

static void begin_teaching(panel *self, const instance *mapping)
{
    const lesson_params at = lesson_params_of(mapping->type);
    uint32_t count = 0;
    for (uint32_t i = 0; i < GOAL_FACES && count < SIMON_FACES_MAX; ++i) {
        if (!goal_is_available(&goals[i], self->rig) ||
            !find_label(&mapping->type->params[at.face], goals[i].name, &self->face_label[count]))
            continue;
        self->face_goal[count++] = i;
    }
    simon_begin(&self->simon, count, self->line, self->line_count);
    self->is_teaching = count > 0;
    self->said[0] = '\0';
    self->cheer_s = 1.0;
}

static void draw_pair(const panel *self, ui *on, const simon_pair *pair)
{
    char words[240];
    (void)snprintf(words, sizeof words,
                   "The hand poses for %s and %s are too similar (%.0f\xc2\xb0 apart). Answer one "
                   "of them with another pose, or forget it.",
                   goals[self->face_goal[pair->a]].name, goals[self->face_goal[pair->b]].name,
                   pair->deg);
    ui_text_wrapped(on, UI_STYLE_WARNING, words);
}

static void draw_answers(panel *self, ui *on)
{
    for (uint32_t i = 0; i < self->simon.face_count; ++i) {
        char words[64];
        const double deg = simon_spread_deg(&self->simon, i);
        const bool is_far = deg > SIMON_SPREAD_DEG;
        const uint32_t count = self->simon.answered[i];
        if (count == 0)
            (void)snprintf(words, sizeof words, "not answered");
        else if (count == 1)
            (void)snprintf(words, sizeof words, "answered once");
        else
            (void)snprintf(words, sizeof words, "%.0f\xc2\xb0 apart%s", deg,
                           is_far ? ", repeat" : "");
        ui_fact(on, goals[self->face_goal[i]].name, 110.0f,
                is_far ? UI_STYLE_WARNING : UI_STYLE_BODY, words);
    }
}

static void draw_round_end(panel *self, ui *on, instance *mapping)
{
    simon_pair pair[SIMON_PAIRS_MAX];
    const uint32_t pairs = simon_twins(&self->simon, pair), left = simon_left(&self->simon);
    char words[160], keys[64];
    (void)snprintf(words, sizeof words, "Round %u is over", self->simon.round + 1);
    ui_text(on, UI_STYLE_TITLE, words);
    ui_scroll_begin(on, "answers", 0.0f, fmaxf(ui_available_height(on) - 118.0f, 90.0f));
    for (uint32_t i = 0; i < pairs; ++i)
        draw_pair(self, on, &pair[i]);
    draw_answers(self, on);
    ui_scroll_end(on);
    if (left > 0) {
        (void)snprintf(words, sizeof words, "Round %u asks for %u %s.", self->simon.round + 2, left,
                       left == 1 ? "face" : "faces");
        ui_text(on, UI_STYLE_DIM, words);
        if (ui_button(on, "Next round", UI_ACCENT) || is_answered(self, on))
            simon_next_round(&self->simon);
        write_keys(self, keys, sizeof keys, "begins the next round");
        ui_hint(on, keys);
    } else {
        ui_text_wrapped(on, UI_STYLE_GOOD,
                        "The mapping has learned your hand. The show saves it. Presets in Mapping "
                        "save it too.");
        if (ui_button(on, "Try it", UI_ACCENT) || is_answered(self, on)) {
            self->tab = TAB_SAY_IT;
            self->is_teaching = false;
        }
        ui_hint(on, "Open the exercise \"Say it\".");
    }
    ui_same_line(on);
    if (ui_button(on, "Forget all", UI_QUIET))
        begin_lesson(self, mapping, LESSON_FORGET_ALL, SIMON_FACES_MAX);
    ui_hint(on, "Use the default hand poses for all faces.");
    ui_same_line(on);
    if (ui_button(on, "Restart", UI_QUIET))
        begin_teaching(self, mapping);
    ui_hint(on, "Start the rounds again and keep the learned hand poses.");
}

static void draw_question(panel *self, ui *on, instance *mapping)
{
    const uint32_t asked = simon_asked(&self->simon);
    const goal *of = &goals[self->face_goal[asked]];
    char words[160], keys[64];
    (void)snprintf(words, sizeof words, "Round %u, face %u of %u", self->simon.round + 1,
                   self->simon.place + 1, self->simon.face_count);
    ui_text(on, UI_STYLE_DIM, words);
    draw_absence(self, on);
    draw_goal(self, on, &of->step[0],
              self->is_measured && self->is_present ? self->how.closed : 0.0,
              ui_available_height(on) - 220.0f);
    draw_centred(on, "name", UI_STYLE_LARGE, of->name);
    write_keys(self, keys, sizeof keys, "answers");
    (void)snprintf(words, sizeof words, "Hold the hand pose for this face. %s", keys);
    ui_text_wrapped(on, UI_STYLE_BODY, words);
    ui_disabled_begin(on, !self->is_present || self->lesson != LESSON_NONE);
    if (ui_button(on, "Answer", UI_ACCENT) || (is_answered(self, on) && self->is_present))
        begin_lesson(self, mapping, LESSON_ANSWER, asked);
    ui_hint(on, "Add the current hand pose to your hand poses for this face.");
    ui_same_line(on);
    if (ui_button(on, "Skip", UI_PLAIN))
        simon_skip(&self->simon);
    ui_hint(on, "Skip this face.");
    ui_same_line(on);
    if (ui_button(on, "Undo", UI_PLAIN))
        app_do(self->app, ACTION_UNDO);
    ui_hint(on, "Undo the last answer (Ctrl+Z).");
    ui_disabled_end(on);
    if (ui_button(on, "Forget this face", UI_QUIET))
        begin_lesson(self, mapping, LESSON_FORGET, asked);
    ui_hint(on, "Use the default hand pose for this face.");
    ui_same_line(on);
    if (ui_button(on, "Forget all", UI_QUIET))
        begin_lesson(self, mapping, LESSON_FORGET_ALL, SIMON_FACES_MAX);
    ui_hint(on, "Use the default hand poses for all faces.");
    if (self->said[0])
        ui_text_wrapped(on, UI_STYLE_DIM, self->said);
}

static void draw_simon(panel *self, ui *on, instance *mapping)
{
    if (!lesson_params_of(mapping->type).has_all) {
        ui_text_wrapped(on, UI_STYLE_DIM,
                        "This mapping cannot learn hand poses. Choose \"One hand\" in Mapping.");
        return;
    }
    if (!has_goals(self, on))
        return;
    if (self->is_teaching && simon_asked(&self->simon) < self->simon.face_count) {
        draw_question(self, on, mapping);
        return;
    }
    if (self->is_teaching) {
        draw_round_end(self, on, mapping);
        return;
    }
    ui_text_wrapped(on, UI_STYLE_BODY,
                    "The puppet shows twelve faces, twice. For each face, hold the hand pose that "
                    "fits it, then answer. The mapping learns your poses.");
    draw_absence(self, on);
    ui_space(on, 4.0f);
    if (ui_button(on, "Start##simon", UI_ACCENT) || is_answered(self, on))
        begin_teaching(self, mapping);
    ui_hint(on, "Begin the first round (Space).");
}

/* ---- the panel ---- */

static instance *mapping_of(panel *self)
{
    return live_mapping(app_live(self->app));
}

static void draw(panel *self, ui *on, ui_rectangle where)
{
    instance *mapping = mapping_of(self);
    ui_panel_begin(on, "hand", where, UI_GROUND_PANEL);
    app_looks_of(self->app)->is_answering = false;
    if (!mapping || mapping->type != self->type || self->line_count == 0) {
        char words[200];
        (void)snprintf(words, sizeof words,
                       "%.60s has no hand card. Choose \"One hand\" in Mapping.",
                       mapping ? mapping->type->name : "The mouse");
        ui_text_wrapped(on, UI_STYLE_DIM, words);
    } else {
        (void)ui_tabs(on, "tabs", tabs, TABS, &self->tab);
        ui_space(on, 4.0f);
        if (self->tab == TAB_CARD)
            draw_card(self, on);
        else if (self->tab == TAB_SAY_IT)
            draw_say_it(self, on);
        else
            draw_simon(self, on, mapping);
    }
    self->was_drawn = true;
    ui_panel_end(on);
}

static void update(panel *self, double dt_s)
{
    instance *mapping = mapping_of(self);
    app_looks *looks = app_looks_of(self->app);
    if (!self->was_drawn) {
        looks->is_answering = false;
        if (!looks->shows_card && self->lesson == LESSON_NONE)
            return; /* neither the panel nor the card is visible */
    }
    self->was_drawn = false;
    const mrt_plugin_type *type = mapping ? mapping->type : NULL;
    if (type != self->type) {
        self->type = type;
        self->is_teaching = false;
        end_lesson(self);
    }
    follow_card(self, mapping);
    follow_hand(self, dt_s);
    follow_pedal(self, mapping);
    follow_goal(self, dt_s);
    follow_lesson(self, dt_s);
    if (step_now(self) || self->lesson != LESSON_NONE)
        app_want_frame(self->app, 0.0);
    if (self->needs_shapes && !self->rig)
        app_want_frame(self->app, 0.1);
}

static const float card_margin = 12.0f;

float hand_panel_card_width(panel *self, const ui *on, ui_rectangle stage)
{
    static const float widths[] = {400.0f, 480.0f}, face_least = 320.0f;
    hand_card card = card_of(self);
    if (!app_looks_of(self->app)->shows_card || self->line_count == 0)
        return 0.0f;
    for (size_t i = 0; i < sizeof widths / sizeof *widths; ++i)
        if (stage.width - widths[i] >= face_least &&
            fit_card(on, &card, widths[i] - 2.0f * card_margin, stage.height - 2.0f * card_margin))
            return widths[i];
    return 0.0f; /* the panel shows the list instead */
}

void hand_panel_draw_card(panel *self, ui *on, ui_rectangle where)
{
    hand_card card = card_of(self);
    const ui_rectangle inside = {where.x + card_margin, where.y + card_margin,
                                 where.width - 2.0f * card_margin,
                                 where.height - 2.0f * card_margin};
    (void)fit_card(on, &card, inside.width, inside.height);
    ui_panel_begin(on, "hand_card", where, UI_GROUND_PANEL);
    draw_card_at(self, on, inside, &card);
    ui_panel_end(on);
}

static void destroy(panel *self)
{
    if (!self)
        return;
    app_forget_changes(self->app, self);
    posed_shape_destroy(self->shapes);
    for (uint32_t side = 0; side < 2; ++side)
        hand_skeleton_destroy(self->skeleton[side]);
    free(self->before);
    free(self);
}

static panel *create(app *of)
{
    panel *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->app = of;
    self->side = MRT_RIGHT;
    self->cheer_s = 1.0;
    memcpy(self->rest_rad, relaxed_rad, sizeof self->rest_rad);
    memcpy(self->angle_rad, self->rest_rad, sizeof self->angle_rad);
    memcpy(self->order_rad, self->rest_rad, sizeof self->order_rad);
    memcpy(self->steady_rad, self->rest_rad, sizeof self->steady_rad);
    self->shapes = posed_shape_create();
    for (uint32_t side = 0; side < 2; ++side)
        self->skeleton[side] = hand_skeleton_create(side, HAND_LENGTH_MM);
    if (self->shapes && self->skeleton[0] && self->skeleton[1])
        return self;
    destroy(self);
    return NULL;
}

const panel_type panel_hand = {create, destroy, draw, update};
