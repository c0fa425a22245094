/* The mapping panel: choice of the mapping, its parameters and presets, pedals, learn mode. */
#include "window/panels/mapping.h"
#include "window/app/app.h"
#include "window/gui/hand_figure.h"
#include "window/gui/theme.h"
#include "window/gui/ui.h"
#include "window/panels/panels.h"
#include "window/app/presets.h"
#include "window/viewport/viewport.h"

#include "base/clock.h"
#include "base/text.h"
#include "stage/mapping/taught.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { MAPPING_GROUPS_MAX = 64, MAPPING_CHOICES_MAX = 128 };

struct panel {
    app *app;
    uint32_t tab;
    char find[64]; /* search text for parameter names */

    /* State for the active mapping. follow_mapping resets it when the type changes. */
    const mrt_plugin_type *type; /* may be unloaded after a change of face */
    char type_id[128];           /* "": none */
    const char *group[MAPPING_GROUPS_MAX];
    uint32_t group_count;
    float label_width;
    double *values; /* scratch memory, param_count values */
    bool is_held;   /* a slider is being dragged */
    uint32_t held;  /* its parameter */
    double held_before;

    char preset[PRESET_NAME]; /* last used or saved preset; may be "" */
    char preset_name[PRESET_NAME];
    bool is_naming, was_naming;
    char **presets; /* their names; one block */
    uint32_t preset_count;
    bool presets_are_stale; /* a preset was saved or deleted, also by undo or redo */

    bool is_learning, was_drawn,
        had_contacts; /* had_contacts: contacts were shown before learning started */
    learn learn;
    char learnt[160]; /* last link, or the reason for a failure */

    /* ---- taught hand poses ---- */
    unsigned char *lessons; /* MRT_STATE; NULL: unknown */
    size_t lessons_size;
    double lessons_wait_s; /* until the next query */
    /* The taught state before a button that teaches was pressed. NULL: no button waits. */
    unsigned char *untaught;
    size_t untaught_size;
    double taught_wait_s; /* until the frame thread has handled the button */
    char taught_by[EDIT_TEXT];
    hand_skeleton *skeleton[2];
};

/* ---- undo steps ---- */

typedef enum setting_kind { SETTING_PARAMS, SETTING_MAPPING, SETTING_PRESET } setting_kind;

typedef struct param_value {
    uint32_t id; /* of the parameter; constant across plugin reloads */
    double value;
} param_value;

/* The value of an undo step, in one allocation. */
typedef struct setting {
    setting_kind kind;
    char name[PRESET_KEY]; /* PARAMS: id of the mapping; PRESET: settings key; else "" */
    size_t size;           /* of the bytes that follow the parameters: the taught state, or text
                              with its NUL. 0: taught state unchanged; preset deleted */
    uint32_t param_count;
    param_value params[];
} setting;

static const void *bytes_of(const setting *of)
{
    return of->params + of->param_count;
}

static size_t setting_size(const setting *of)
{
    return sizeof *of + of->param_count * sizeof *of->params + of->size;
}

/* NULL: no memory. */
static setting *setting_new(setting_kind kind, const char *name, const param_value *params,
                            uint32_t param_count, const void *bytes, size_t size)
{
    setting *out = malloc(sizeof *out + param_count * sizeof *params + size);
    if (!out)
        return NULL;
    *out = (setting){.kind = kind, .size = size, .param_count = param_count};
    (void)snprintf(out->name, sizeof out->name, "%s", name);
    if (param_count > 0)
        memcpy(out->params, params, param_count * sizeof *params);
    if (size > 0)
        memcpy(out->params + param_count, bytes, size);
    return out;
}

static setting *setting_of_text(setting_kind kind, const char *name, const char *text)
{
    return setting_new(kind, name, NULL, 0, text, text ? strlen(text) + 1 : 0);
}

static bool same(double a, double b)
{
    return a >= b && a <= b;
}

/* ---- undo and redo ---- */

static void say(panel *self, int32_t level, const char *text)
{
    news_list_add(app_news(self->app), level, "mapping", text);
}

static void set_preset(panel *self, const char *key, const char *text)
{
    settings_set_text(app_settings(self->app), key, text);
    self->presets_are_stale = true;
}

static mrt_result set_params(panel *self, const setting *to)
{
    error err = {""};
    instance *mapping = live_mapping(app_live(self->app));
    if (!mapping || strcmp(mapping->type->id, to->name) != 0) {
        say(self, MRT_LOG_WARNING, "that parameter belongs to another mapping and was not changed");
        return MRT_OK;
    }
    for (uint32_t i = 0; i < to->param_count; ++i)
        for (uint32_t k = 0; k < mapping->type->param_count; ++k)
            if (mapping->type->params[k].id == to->params[i].id)
                instance_set_value(mapping, k, to->params[i].value);
    const mrt_result result =
        to->size ? live_teach(app_live(self->app), bytes_of(to), to->size, &err) : MRT_OK;
    if (result < 0)
        say(self, MRT_LOG_ERROR, err.text);
    return result;
}

static mrt_result set(void *owner, const void *of)
{
    panel *self = owner;
    const setting *to = of;
    error err = {""};
    mrt_result result = MRT_OK;
    switch (to->kind) {
    case SETTING_PARAMS:
        return set_params(self, to);
    case SETTING_MAPPING:
        result = live_set_mapping(app_live(self->app), bytes_of(to), &err);
        if (result < 0)
            say(self, MRT_LOG_ERROR, err.text);
        return result;
    case SETTING_PRESET:
        set_preset(self, to->name, to->size ? bytes_of(to) : NULL);
        return MRT_OK;
    }
    return MRT_OK;
}

/* Adds an undo step, and takes ownership of its values. Without memory (a value is NULL) the change
 * stays, but cannot be undone. */
static void note(panel *self, const char *words, setting *before, setting *after)
{
    if (!before || !after) {
        free(before);
        free(after);
        return;
    }
    undo_change made = {.owner = self,
                        .set = set,
                        .before = before,
                        .after = after,
                        .bytes = setting_size(before) + setting_size(after)};
    (void)snprintf(made.words, sizeof made.words, "%s", words);
    app_add_change(self->app, &made);
}

/* Returns the taught state of the active mapping, which the caller frees. NULL: none, or no memory.
 */
static unsigned char *fetch_taught(panel *self, size_t *out_size)
{
    unsigned char *out = malloc(TAUGHT_BYTES_MAX);
    *out_size = out ? live_taught(app_live(self->app), out, TAUGHT_BYTES_MAX) : 0;
    if (*out_size > 0)
        return out;
    free(out);
    return NULL;
}

/* Loads a taught state into the mapping. Returns the previous one, which the caller frees. NULL:
 * unchanged, or no memory for undo. */
static unsigned char *teach(panel *self, const unsigned char *taught, size_t size,
                            size_t *out_before_size)
{
    error err = {""};
    unsigned char *before = fetch_taught(self, out_before_size);
    if (before && *out_before_size == size && memcmp(before, taught, size) == 0) {
        free(before);
        return NULL;
    }
    if (live_teach(app_live(self->app), taught, size, &err) >= 0)
        return before;
    char words[256];
    (void)snprintf(words, sizeof words,
                   "cannot restore the learned hand poses of the preset: %.200s", err.text);
    say(self, MRT_LOG_ERROR, words);
    free(before);
    return NULL;
}

/* Sets the parameters of the active mapping (values: param_count, by index) and its taught state
 * (NULL: unchanged; freed). The changes become one undo step. `words`: such as "gain 0.8". */
static void set_values(panel *self, const double *values, unsigned char *taught, size_t taught_size,
                       const char *words)
{
    instance *mapping = live_mapping(app_live(self->app));
    const uint32_t count = mapping ? mapping->type->param_count : 0;
    param_value *before = calloc((size_t)count + 1, sizeof *before),
                *after = calloc((size_t)count + 1, sizeof *after);
    uint32_t changed = 0;
    size_t taught_before_size = 0;
    unsigned char *taught_before =
        mapping && taught ? teach(self, taught, taught_size, &taught_before_size) : NULL;
    for (uint32_t i = 0; i < count; ++i) {
        const mrt_param *p = &mapping->type->params[i];
        const double was = instance_value(mapping, i);
        if (p->flags & MRT_PARAM_TRIGGER || same(was, values[i]))
            continue;
        instance_set_value(mapping, i, values[i]);
        if (!before || !after)
            continue; /* no memory for undo */
        before[changed] = (param_value){p->id, was};
        after[changed++] = (param_value){p->id, instance_value(mapping, i)};
    }
    if (changed > 0 || taught_before) {
        const char *id = mapping->type->id;
        note(self, words,
             setting_new(SETTING_PARAMS, id, before, changed, taught_before, taught_before_size),
             setting_new(SETTING_PARAMS, id, after, changed, taught,
                         taught_before ? taught_size : 0));
    }
    free(taught_before);
    free(taught);
    free(before);
    free(after);
}

/* Sets all values as one undo step. */
static void set_all(panel *self, const double *values, const char *words)
{
    char all[EDIT_TEXT];
    (void)snprintf(all, sizeof all, "%.50s: %.100s", self->type ? self->type->name : "", words);
    set_values(self, values, NULL, 0, all);
}

/* Adds an undo step for a parameter that a drag has already changed. `before`: its old value. */
static void note_value(panel *self, uint32_t index, double before)
{
    instance *mapping = live_mapping(app_live(self->app));
    if (!mapping || index >= mapping->type->param_count)
        return;
    const mrt_param *p = &mapping->type->params[index];
    double after = instance_value(mapping, index);
    char words[EDIT_TEXT];
    if (same(before, after))
        return;
    (void)snprintf(words, sizeof words, "%.60s: %.60s %g%s%.20s", mapping->type->name, p->name,
                   after, p->unit[0] ? " " : "", p->unit);
    const char *id = mapping->type->id;
    note(self, words, setting_new(SETTING_PARAMS, id, &(param_value){p->id, before}, 1, NULL, 0),
         setting_new(SETTING_PARAMS, id, &(param_value){p->id, after}, 1, NULL, 0));
}

/* Switches to a mapping by name ("": none). Reports errors in the log panel. */
static void choose_mapping(panel *self, const char *name)
{
    char before[PRESET_MAPPING], after[PRESET_MAPPING], words[EDIT_TEXT];
    error err = {""};
    presets_mapping_text(live_mapping(app_live(self->app)), before, sizeof before);
    if (live_set_mapping(app_live(self->app), name, &err) < 0) {
        say(self, MRT_LOG_ERROR, err.text);
        return;
    }
    const instance *now = live_mapping(app_live(self->app));
    presets_mapping_text(now, after, sizeof after);
    (void)snprintf(words, sizeof words, "mapping %.100s",
                   now ? isolate_inner(now->type)->name : "none");
    if (strcmp(before, after) != 0)
        note(self, words, setting_of_text(SETTING_MAPPING, "", before),
             setting_of_text(SETTING_MAPPING, "", after));
}

/* Saves the text of a preset, or deletes the preset (text NULL). Without memory the change stays,
 * but cannot be undone. */
static void change_preset(panel *self, const mrt_plugin_type *type, const char *name,
                          const char *text)
{
    char key[PRESET_KEY], words[EDIT_TEXT];
    presets_key(key, type, name);
    const char *before = presets_kept(app_settings(self->app), type, name);
    if (before == text || (before && text && strcmp(before, text) == 0))
        return;
    (void)snprintf(words, sizeof words, "preset '%s' %s", name, text ? "saved" : "deleted");
    note(self, words, setting_of_text(SETTING_PRESET, key, before),
         setting_of_text(SETTING_PRESET, key, text));
    set_preset(self, key, text);
}

/* Saves the current values and taught state of the active mapping as a preset. `name` is clean. */
static void save_preset(panel *self, const char *name)
{
    size_t size = 0;
    const instance *mapping = live_mapping(app_live(self->app));
    if (!mapping)
        return;
    unsigned char *taught = fetch_taught(self, &size);
    if (size > PRESET_TAUGHT_MAX) {
        say(self, MRT_LOG_ERROR,
            "the learned hand poses are too large for a preset: only the values are saved");
        size = 0;
    }
    char *text = presets_make(mapping, taught, size);
    if (text)
        change_preset(self, mapping->type, name, text);
    else
        say(self, MRT_LOG_ERROR, "no memory for the preset");
    free(taught);
    free(text);
}

static void delete_preset(panel *self, const char *name)
{
    const instance *mapping = live_mapping(app_live(self->app));
    if (mapping)
        change_preset(self, mapping->type, name, NULL);
}

/* ---- learning: selection of the finger ---- */

static const double span_s = 1.0,
                    step_s = 1.0 / 36.0; /* fewer than LEARN_MOMENTS moments in span_s */
static const float least_rad = 0.4f, clearly = 1.3f;

enum { JOINTS = 3 };
/* Joints from thumb to little finger. Thumb: roll, MPJ, IJ. Others: MPJ, PIJ. Not every glove
 * measures the DIJ. */
static const int joint_of[5][JOINTS] = {
    {0, 1, 2}, {4, 5, -1}, {7, 8, -1}, {11, 12, -1}, {15, 16, -1}};

static const char *const learn_finger_name[LEARN_FINGERS] = {
    "right thumb", "right index", "right middle", "right ring", "right little",
    "left thumb",  "left index",  "left middle",  "left ring",  "left little"};

void learn_begin(learn *self)
{
    *self = (learn){.finger = LEARN_NONE};
}

static uint32_t side_of(int finger)
{
    return finger < 5 ? MRT_RIGHT : MRT_LEFT;
}

static float travel_of_joint(const learn *self, uint32_t side, int joint)
{
    float low = INFINITY, high = -INFINITY;
    for (uint32_t i = 0; i < self->count; ++i) {
        const struct learn_moment *at = &self->moment[i];
        if (!at->is_present[side] || self->time_s - at->time_s > span_s)
            continue;
        low = fminf(low, at->angle[side][joint]);
        high = fmaxf(high, at->angle[side][joint]);
    }
    return high > low ? high - low : 0.0f;
}

static void measure(learn *self)
{
    for (int finger = 0; finger < LEARN_FINGERS; ++finger) {
        self->travel_rad[finger] = 0.0f;
        for (int i = 0; i < JOINTS && joint_of[finger % 5][i] >= 0; ++i)
            self->travel_rad[finger] +=
                travel_of_joint(self, side_of(finger), joint_of[finger % 5][i]);
    }
}

static void decide(learn *self)
{
    int most = 0;
    for (int finger = 1; finger < LEARN_FINGERS; ++finger)
        if (self->travel_rad[finger] > self->travel_rad[most])
            most = finger;
    float second = 0.0f;
    for (int finger = 0; finger < LEARN_FINGERS; ++finger)
        if (finger != most)
            second = fmaxf(second, self->travel_rad[finger]);
    if (self->travel_rad[most] >= least_rad && self->travel_rad[most] >= clearly * second)
        self->finger = most;
}

static void remember(learn *self, const mrt_hand hand[2])
{
    struct learn_moment *at = &self->moment[self->next];
    at->time_s = self->time_s;
    for (int side = 0; side < 2; ++side) {
        at->is_present[side] = hand[side].present;
        for (int i = 0; i < MRT_ANGLES; ++i)
            at->angle[side][i] = isfinite(hand[side].angle[i]) ? hand[side].angle[i] : 0.0f;
    }
    self->next = (self->next + 1) % LEARN_MOMENTS;
    if (self->count < LEARN_MOMENTS)
        self->count += 1;
}

void learn_update(learn *self, const mrt_hand hand[2], double dt_s)
{
    self->time_s += dt_s > 0.0 ? dt_s : 0.0;
    if (self->count > 0 && self->time_s - self->last_s < step_s)
        return;
    self->last_s = self->time_s;
    remember(self, hand);
    measure(self);
    decide(self);
}

int learn_finger_of(const mrt_param *param)
{
    if (!(param->flags & MRT_PARAM_STEPPED) || strcmp(param->group, "Contacts") != 0 ||
        param->min > 0.0 || param->max < 1.0 || param->labels)
        return LEARN_NONE;
    for (int finger = 0; finger < LEARN_FINGERS; ++finger)
        if (strcasecmp(param->name, learn_finger_name[finger]) == 0)
            return finger;
    return LEARN_NONE;
}

uint32_t learn_param_of(const mrt_plugin_type *type, int finger)
{
    for (uint32_t i = 0; i < type->param_count && finger != LEARN_NONE; ++i)
        if (learn_finger_of(&type->params[i]) == finger)
            return i;
    return type->param_count;
}

bool learn_can(const mrt_plugin_type *type)
{
    for (uint32_t i = 0; i < type->param_count; ++i)
        if (learn_finger_of(&type->params[i]) != LEARN_NONE)
            return true;
    return false;
}

/* ---- functions of pedals ---- */

static const char ending[] = " pedal";

bool pedal_table_meaning(const mrt_param *param, char out[PEDAL_MEANING])
{
    size_t length = strlen(param->name), tail = sizeof ending - 1;
    bool is_pedal = (param->flags & MRT_PARAM_STEPPED) && length > tail &&
                    strcmp(param->name + length - tail, ending) == 0 && param->min >= 0.0 &&
                    param->min <= 0.0 && param->max <= MRT_MAX_PEDALS;
    if (is_pedal)
        (void)snprintf(out, PEDAL_MEANING, "%.*s", (int)(length - tail), param->name);
    return is_pedal;
}

void pedal_table_words(const mrt_plugin_type *type, const double *values, uint32_t pedal, char *out,
                       size_t capacity)
{
    char meaning[PEDAL_MEANING];
    size_t used = 0;
    out[0] = '\0';
    for (uint32_t i = 0; i < type->param_count && used < capacity; ++i) {
        if (!pedal_table_meaning(&type->params[i], meaning) || (uint32_t)values[i] != pedal)
            continue;
        int length = snprintf(out + used, capacity - used, "%s%s", used ? ", " : "", meaning);
        used += length > 0 ? (size_t)length : 0;
    }
}

/* ---- parameters ---- */

#define LESSON_S      0.3 /* time for the frame thread to handle a button that teaches */
#define LESSON_LATE_S 1.0 /* after that, on a busy machine; then the button has taught nothing */
static const float label_least = 84.0f, label_most = 146.0f;

/* Returns whether the parameter list shows a parameter: it is neither hidden nor a finger link. */
static bool mapping_param_is_shown(const mrt_param *p)
{
    return !(p->flags & MRT_PARAM_HIDDEN) && learn_finger_of(p) == LEARN_NONE;
}

static bool mapping_param_is_changed(const instance *mapping, uint32_t index)
{
    const mrt_param *p = &mapping->type->params[index];
    double value = instance_value(mapping, index);
    return !(p->flags & MRT_PARAM_TRIGGER) && !(value >= p->initial && value <= p->initial);
}

/* ---- one parameter ---- */

static uint32_t digits_of(const mrt_param *p)
{
    double span = p->max - p->min;
    return span >= 200.0 ? 0 : span >= 20.0 ? 1 : span >= 1.0 ? 2 : 3;
}

static uint32_t label_count(const mrt_param *p)
{
    uint32_t count = 0;
    while (p->labels[count])
        count += 1;
    return count;
}

static void draw_labels(panel *self, ui *on, instance *mapping, uint32_t index, const char *label)
{
    const mrt_param *p = &mapping->type->params[index];
    double before = instance_value(mapping, index);
    uint32_t chosen = (uint32_t)(before - p->min);
    if (!ui_choice(on, label, self->label_width, p->labels, label_count(p), &chosen))
        return;
    instance_set_value(mapping, index, p->min + (double)chosen);
    note_value(self, index, before);
}

/* Draws the list of the poses of the face, for a parameter that chooses one of them. */
static void draw_poses(panel *self, ui *on, instance *mapping, uint32_t index, const char *label)
{
    enum { ITEMS = 256 };
    const char *items[ITEMS] = {"None"};
    const double before = instance_value(mapping, index);
    uint32_t count, chosen = 0, item_count = 1;
    const mrt_rig_pose *pose = live_poses(app_live(self->app), &count);
    for (uint32_t i = 0; i < count && item_count + 1 < ITEMS; ++i) {
        if (fabs((double)mrt_pose_value(pose[i].name) - before) < 0.5)
            chosen = item_count;
        items[item_count++] = pose[i].name;
    }
    if (chosen == 0 && before > 0.0) {
        chosen = item_count;
        items[item_count++] = "A pose that this face lacks";
    }
    const uint32_t was = chosen;
    if (!ui_choice(on, label, self->label_width, items, item_count, &chosen) || chosen == was)
        return;
    instance_set_value(mapping, index, chosen == 0 ? 0.0 : (double)mrt_pose_value(items[chosen]));
    note_value(self, index, before);
}

/* Draws a slider. One drag is one undo step. */
static void draw_slider(panel *self, ui *on, instance *mapping, uint32_t index, const char *label)
{
    const mrt_param *p = &mapping->type->params[index];
    const ui_range range = {.min = p->min,
                            .max = p->max,
                            .unit = p->unit,
                            .digits = digits_of(p),
                            .is_whole = (p->flags & MRT_PARAM_STEPPED) != 0,
                            .initial = p->initial};
    double before = instance_value(mapping, index), value = before;
    bool has_changed = ui_slider(on, label, self->label_width, &range, &value);
    bool is_held = ui_slider_is_held(on), was_held = self->is_held && self->held == index;
    if (has_changed)
        instance_set_value(mapping, index, value);
    if (is_held && !was_held) {
        self->is_held = true;
        self->held = index;
        self->held_before = before;
    } else if (!is_held && was_held) {
        self->is_held = false;
        note_value(self, index, self->held_before);
    } else if (has_changed && !is_held) {
        note_value(self, index, before);
    }
}

/* Selects a clicked parameter as target while the patch panel learns. */
static bool is_pointed_at(panel *self, ui *on, const instance *mapping, uint32_t index)
{
    const mrt_param *p = &mapping->type->params[index];
    app_patch_aim *aim = app_patch_aimed(self->app);
    char label[112];
    if (!aim->is_learning)
        return false;
    (void)snprintf(label, sizeof label, "\xe2\x86\x92 %.70s###%u", p->name, p->id);
    if (ui_button(on, label, UI_QUIET)) {
        aim->kind = PATCH_PARAM;
        instance_key(mapping->type, index, aim->target, sizeof aim->target);
    }
    return true;
}

/* Keeps the taught state, for undo. Two buttons that follow each other at once are one step. */
static void begin_teaching(panel *self, const instance *mapping, const mrt_param *p)
{
    if (!self->untaught)
        self->untaught = fetch_taught(self, &self->untaught_size);
    self->taught_wait_s = LESSON_S;
    (void)snprintf(self->taught_by, sizeof self->taught_by, "%.50s: %.100s", mapping->type->name,
                   p->name);
}

/* Adds an undo step when the button has changed what the mapping was taught. */
static void end_teaching(panel *self, double dt_s)
{
    size_t size;
    self->taught_wait_s -= dt_s;
    if (!self->untaught || self->taught_wait_s > 0.0)
        return;
    const instance *mapping = live_mapping(app_live(self->app));
    unsigned char *now = fetch_taught(self, &size);
    const bool is_new =
        mapping && now && (size != self->untaught_size || memcmp(now, self->untaught, size) != 0);
    if (is_new) {
        const char *id = mapping->type->id;
        note(self, self->taught_by,
             setting_new(SETTING_PARAMS, id, NULL, 0, self->untaught, self->untaught_size),
             setting_new(SETTING_PARAMS, id, NULL, 0, now, size));
    }
    if (is_new || self->taught_wait_s < -LESSON_LATE_S) {
        free(self->untaught);
        self->untaught = NULL;
    }
    free(now);
}

/* Draws the widget of a parameter. Each change is an undo step. */
static void mapping_param_draw(panel *self, ui *on, instance *mapping, uint32_t index,
                               const char *name)
{
    const mrt_param *p = &mapping->type->params[index];
    char label[96];
    if (is_pointed_at(self, on, mapping, index))
        return;
    (void)snprintf(label, sizeof label, "%.70s%s###%u", name,
                   mapping_param_is_changed(mapping, index) ? " \xe2\x80\xa2" : "", p->id);
    if (p->flags & MRT_PARAM_TRIGGER) {
        if (ui_button(on, label, UI_PLAIN)) {
            begin_teaching(self, mapping, p);
            instance_trigger(mapping, index);
            self->lessons_wait_s = LESSON_S;
        }
    } else if (p->flags & MRT_PARAM_POSE) {
        draw_poses(self, on, mapping, index, label);
    } else if (p->labels) {
        draw_labels(self, on, mapping, index, label);
    } else {
        draw_slider(self, on, mapping, index, label);
    }
    ui_hint(on, p->help);
}

/* ---- all parameters by group ---- */

/* Sets the label width to the longest name of the group. */
static void measure_labels(panel *self, const ui *on, const instance *mapping, const char *group)
{
    float widest = label_least;
    for (uint32_t i = 0; i < mapping->type->param_count; ++i) {
        const mrt_param *p = &mapping->type->params[i];
        if (mapping_param_is_shown(p) && !(p->flags & MRT_PARAM_TRIGGER) &&
            (!group || strcmp(p->group, group) == 0))
            widest = fmaxf(widest, ui_text_width(on, UI_STYLE_BODY, p->name) + 20.0f);
    }
    self->label_width = fminf(widest, label_most);
}

static bool contains(const char *text, const char *part)
{
    for (; *text; ++text) {
        size_t i = 0;
        while (part[i] && tolower((unsigned char)text[i]) == tolower((unsigned char)part[i]))
            i += 1;
        if (!part[i])
            return true;
    }
    return !*part;
}

/* ---- taught hand poses, drawn as hands ---- */

#define LESSONS_S     2.0 /* interval of queries, because a pedal can teach too */
#define FIGURE_HEIGHT 88.0f

static bool pose_of(const panel *self, const instance *mapping, const mrt_param *p,
                    float out_rad[MRT_ANGLES])
{
    const mrt_taught_poses *poses = plugin_interface(mapping->type, MRT_TAUGHT_POSES);
    if (!poses || !self->lessons || !(p->flags & MRT_PARAM_TRIGGER) ||
        poses->pose(self->lessons, self->lessons_size, p->id, out_rad) != MRT_OK)
        return false;
    for (int i = 0; i < MRT_ANGLES; ++i)
        out_rad[i] = fminf(fmaxf(out_rad[i], -3.0f), 3.0f);
    return true;
}

static void follow_lessons(panel *self, const instance *mapping)
{
    size_t size;
    if (self->lessons_wait_s > 0.0 || !plugin_interface(mapping->type, MRT_TAUGHT_POSES))
        return;
    self->lessons_wait_s = LESSONS_S;
    unsigned char *now = fetch_taught(self, &size);
    if (!now)
        return;
    free(self->lessons);
    self->lessons = now;
    self->lessons_size = size;
}

static float cell_width(const ui *on, const instance *mapping, const char *group)
{
    float widest = FIGURE_HEIGHT;
    for (uint32_t i = 0; i < mapping->type->param_count; ++i) {
        const mrt_param *p = &mapping->type->params[i];
        if ((p->flags & MRT_PARAM_TRIGGER) && strcmp(p->group, group) == 0)
            widest = fmaxf(widest, ui_text_width(on, UI_STYLE_BODY, p->name) + 16.0f);
    }
    return widest;
}

static void draw_figure(panel *self, ui *on, const mrt_param *p, const float *angle_rad,
                        float width)
{
    const mrt_hand *hand = app_view(self->app)->hand;
    const uint32_t side = hand[MRT_LEFT].present && !hand[MRT_RIGHT].present ? MRT_LEFT : MRT_RIGHT;
    char id[24];
    ui_canvas at;
    (void)snprintf(id, sizeof id, "figure%u", p->id);
    ui_canvas_begin(on, id, width, FIGURE_HEIGHT, &at);
    hand_figure_draw(on, at.where, self->skeleton[side], angle_rad, 1e-9 * (double)clock_now_ns(),
                     side == MRT_LEFT ? THEME_LEFT : THEME_RIGHT);
    ui_canvas_end(on);
    ui_hint(on, p->help);
}

/* Draws the taught hand poses, each with its teach button below. */
static void draw_lessons(panel *self, ui *on, instance *mapping, const char *group,
                         const char *find)
{
    const float width = cell_width(on, mapping, group);
    const uint32_t fit = (uint32_t)fmaxf(ui_available_width(on) / (width + 8.0f), 1.0f);
    float angle_rad[MRT_ANGLES];
    uint32_t row[16], count = 0;
    for (uint32_t i = 0; i <= mapping->type->param_count; ++i) {
        const bool is_end = i == mapping->type->param_count;
        const mrt_param *p = is_end ? NULL : &mapping->type->params[i];
        if (p && strcmp(p->group, group) == 0 && contains(p->name, find) &&
            pose_of(self, mapping, p, angle_rad)) {
            if (count > 0)
                ui_same_line(on);
            draw_figure(self, on, p, angle_rad, width);
            row[count++] = i;
        }
        if (count == 0 || (!is_end && count < fit && count < 16))
            continue;
        for (uint32_t k = 0; k < count; ++k) {
            if (k > 0)
                ui_same_line(on);
            ui_width(on, width);
            mapping_param_draw(self, on, mapping, row[k], mapping->type->params[row[k]].name);
        }
        count = 0;
    }
}

/* ---- a group ---- */

/* Draws the parameters of a group, with buttons side by side. */
static void draw_group(panel *self, ui *on, instance *mapping, const char *group, const char *find)
{
    bool is_after_button = false;
    float angle_rad[MRT_ANGLES];
    draw_lessons(self, on, mapping, group, find);
    for (uint32_t i = 0; i < mapping->type->param_count; ++i) {
        const mrt_param *p = &mapping->type->params[i];
        if (!mapping_param_is_shown(p) || strcmp(p->group, group) != 0 ||
            !contains(p->name, find) || pose_of(self, mapping, p, angle_rad))
            continue;
        bool is_button = (p->flags & MRT_PARAM_TRIGGER) != 0;
        if (is_button && is_after_button) {
            ui_same_line(on);
            if (ui_available_width(on) < ui_text_width(on, UI_STYLE_BODY, p->name) + 24.0f)
                ui_next_line(on);
        }
        mapping_param_draw(self, on, mapping, i, p->name);
        is_after_button = is_button;
    }
}

static uint32_t changed_in(const instance *mapping, const char *group)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < mapping->type->param_count; ++i)
        count += strcmp(mapping->type->params[i].group, group) == 0 &&
                 mapping_param_is_shown(&mapping->type->params[i]) &&
                 mapping_param_is_changed(mapping, i);
    return count;
}

static bool finds_in(const instance *mapping, const char *group, const char *find)
{
    for (uint32_t i = 0; i < mapping->type->param_count; ++i) {
        const mrt_param *p = &mapping->type->params[i];
        if (mapping_param_is_shown(p) && strcmp(p->group, group) == 0 && contains(p->name, find))
            return true;
    }
    return false;
}

static void draw_found(panel *self, ui *on, instance *mapping)
{
    bool has_found = false;
    for (uint32_t i = 0; i < self->group_count; ++i) {
        bool is_of_group = contains(self->group[i], self->find);
        const char *find = is_of_group ? "" : self->find;
        if (!finds_in(mapping, self->group[i], find))
            continue;
        has_found = true;
        measure_labels(self, on, mapping, self->group[i]);
        ui_text(on, UI_STYLE_TITLE, self->group[i]);
        draw_group(self, on, mapping, self->group[i], find);
    }
    if (!has_found)
        ui_text(on, UI_STYLE_DIM, "No matching parameter.");
}

static void draw_groups(panel *self, ui *on, instance *mapping)
{
    char title[128];
    uint32_t count = 0; /* without choices of a pose, which few change */
    for (uint32_t i = 0; i < mapping->type->param_count; ++i)
        count += !(mapping->type->params[i].flags & MRT_PARAM_POSE);
    const bool is_small = count <= 16;
    for (uint32_t i = 0; i < self->group_count; ++i) {
        uint32_t changed = changed_in(mapping, self->group[i]);
        if (changed > 0)
            (void)snprintf(title, sizeof title, "%.80s \xe2\x80\xa2 %u###%u", self->group[i],
                           changed, i);
        else
            (void)snprintf(title, sizeof title, "%.80s###%u", self->group[i], i);
        if (!ui_section(on, title, is_small || i == 0))
            continue;
        measure_labels(self, on, mapping, self->group[i]);
        ui_id_begin(on, self->group[i]);
        draw_group(self, on, mapping, self->group[i], "");
        ui_id_end(on);
    }
}

/* Above the list: it does not scroll with it. */
static void mapping_find_draw(panel *self, ui *on, instance *mapping)
{
    if (mapping->type->param_count == 0)
        return;
    ui_width(on, -92.0f);
    (void)ui_input(on, "##find", "Find a parameter", self->find, sizeof self->find);
    ui_same_line(on);
    ui_width(on, 84.0f);
    if (ui_button(on, "Reset all", UI_PLAIN)) {
        for (uint32_t i = 0; i < mapping->type->param_count; ++i)
            self->values[i] = learn_finger_of(&mapping->type->params[i]) == LEARN_NONE
                                  ? mapping->type->params[i].initial
                                  : instance_value(mapping, i);
        set_all(self, self->values, "all parameters reset");
    }
    ui_hint(on, "Reset all parameters except finger links. Double-click a parameter to reset only "
                "that one.");
}

static void mapping_params_draw(panel *self, ui *on, instance *mapping)
{
    follow_lessons(self, mapping);
    if (mapping->type->param_count == 0)
        ui_text(on, UI_STYLE_DIM, "This mapping has no parameters.");
    else if (self->find[0])
        draw_found(self, on, mapping);
    else
        draw_groups(self, on, mapping);
}

/* ---- pedals ---- */

static const float label_width = 118.0f;

static void draw_pedal(panel *self, ui *on, const instance *mapping, uint32_t pedal)
{
    char words[256], id[16];
    ui_canvas at;
    float down = app_view(self->app)->pedal[pedal - 1];
    uint32_t rezero = (uint32_t)settings_number(app_settings(self->app), APP_REZERO_PEDAL, 0.0);
    if (rezero == pedal)
        (void)snprintf(words, sizeof words, "Re-zero");
    else
        pedal_table_words(mapping->type, self->values, pedal, words, sizeof words);
    (void)snprintf(id, sizeof id, "%u", pedal);
    ui_canvas_begin(on, id, 0.0f, 26.0f, &at);
    float middle = at.where.y + 13.0f, share = fminf(fmaxf(down, 0.0f), 1.0f);
    const ui_rectangle well = {at.where.x + 26.0f, middle - 4.0f, 56.0f, 8.0f};
    ui_draw_text(on, at.where.x + 6.0f, middle - 8.0f, UI_STYLE_STRONG, THEME_TEXT, 0.0f, id);
    ui_draw_box(on, well, THEME_WELL, 2.0f);
    if (share > 0.0f)
        ui_draw_box(on, (ui_rectangle){well.x, well.y, well.width * share, well.height},
                    THEME_ACCENT, 2.0f);
    ui_draw_text(on, at.where.x + 96.0f, middle - 8.0f, UI_STYLE_BODY,
                 words[0] ? THEME_TEXT : THEME_DIM, at.where.width - 98.0f,
                 words[0] ? words : "not used");
    ui_canvas_end(on);
    if (words[0])
        ui_hint(on, words);
}

static void mapping_pedals_draw(panel *self, ui *on, instance *mapping)
{
    char meaning[PEDAL_MEANING];
    uint32_t count = 0;
    for (uint32_t i = 0; i < mapping->type->param_count; ++i)
        self->values[i] = instance_value(mapping, i);
    for (uint32_t pedal = 1; pedal <= MRT_MAX_PEDALS; ++pedal)
        draw_pedal(self, on, mapping, pedal);
    ui_space(on, 4.0f);
    ui_rule(on);
    ui_space(on, 4.0f);
    self->label_width = label_width;
    for (uint32_t i = 0; i < mapping->type->param_count; ++i) {
        if (!pedal_table_meaning(&mapping->type->params[i], meaning))
            continue;
        mapping_param_draw(self, on, mapping, i, meaning);
        count += 1;
    }
    if (count == 0)
        ui_text_wrapped(on, UI_STYLE_DIM, "This mapping uses no pedals.");
    ui_space(on, 4.0f);
    char words[128], keys[KEY_WORDS + 4];
    key_map_after(&app_looks_of(self->app)->keys, ACTION_PANEL_DEVICES, keys);
    (void)snprintf(words, sizeof words, "Choose the pedal that re-zeroes the hands in Devices%s.",
                   keys);
    ui_text_wrapped(on, UI_STYLE_DIM, words);
}

/* ---- presets ---- */

static void mapping_presets_read(panel *self)
{
    free(self->presets);
    self->presets = NULL;
    self->preset_count =
        self->type ? presets_list(app_settings(self->app), self->type, &self->presets) : 0;
    self->presets_are_stale = false;
}

static void use(panel *self, const instance *mapping, const char *name)
{
    error note = {""};
    char words[EDIT_TEXT];
    const char *text = presets_kept(app_settings(self->app), mapping->type, name);
    if (!text)
        return;
    presets_values(mapping->type, text, self->values, &note);
    unsigned char *taught;
    size_t taught_size;
    error why = {""};
    if (presets_taught(text, &taught, &taught_size, &why) < 0)
        news_list_add(app_news(self->app), MRT_LOG_ERROR, "mapping", why.text);
    (void)snprintf(words, sizeof words, "%.50s: preset '%s'", mapping->type->name, name);
    set_values(self, self->values, taught, taught_size, words);
    if (name != self->preset)
        (void)snprintf(self->preset, sizeof self->preset, "%s", name);
    if (note.text[0])
        news_list_add(app_news(self->app), MRT_LOG_WARNING, "mapping", note.text);
}

static void save(panel *self)
{
    char clean[PRESET_NAME];
    if (!presets_clean_name(clean, self->preset_name))
        return;
    save_preset(self, clean);
    (void)snprintf(self->preset, sizeof self->preset, "%s", clean);
    self->is_naming = false;
}

/* Returns whether values and taught state still match the last used preset. */
static bool is_still(const panel *self, const instance *mapping)
{
    char now[PRESET_TEXT];
    const char *text =
        self->preset[0] ? presets_kept(app_settings(self->app), mapping->type, self->preset) : NULL;
    if (!text)
        return true;
    presets_text(mapping, now, sizeof now);
    return presets_has_values(text, now);
}

static void draw_naming(panel *self, ui *on)
{
    if (!self->was_naming)
        ui_input_take_keys(on);
    self->was_naming = true;
    ui_width(on, -132.0f);
    (void)ui_input(on, "##preset name", "name of the preset", self->preset_name,
                   sizeof self->preset_name);
    const bool is_entered = ui_input_is_entered(on);
    ui_same_line(on);
    ui_width(on, 58.0f);
    char clean[PRESET_NAME];
    const bool is_name = presets_clean_name(clean, self->preset_name);
    ui_disabled_begin(on, !is_name);
    if (ui_button(on, "Save", UI_ACCENT) || (is_entered && is_name))
        save(self);
    ui_disabled_end(on);
    ui_same_line(on);
    ui_width(on, 66.0f);
    if (ui_button(on, "Cancel##preset", UI_QUIET))
        self->is_naming = false;
}

static void draw_list(panel *self, ui *on, const instance *mapping)
{
    const char *items[MAPPING_CHOICES_MAX];
    char shown[PRESET_NAME + 16];
    uint32_t count = 0, chosen = UINT32_MAX;
    for (; count < self->preset_count && count < MAPPING_CHOICES_MAX - 1; ++count) {
        items[count] = self->presets[count];
        if (strcmp(self->presets[count], self->preset) == 0)
            chosen = count;
    }
    bool is_changed = chosen != UINT32_MAX && !is_still(self, mapping);
    if (is_changed) {
        (void)snprintf(shown, sizeof shown, "%s (changed)", self->preset);
        items[count] = shown;
    } else if (chosen == UINT32_MAX) {
        items[count] = count > 0 ? "choose\xe2\x80\xa6" : "none saved";
    }
    uint32_t at = is_changed || chosen == UINT32_MAX ? count : chosen;
    ui_width(on, 0.0f);
    if (ui_choice(on, "Preset", 66.0f, items, at == count ? count + 1 : count, &at) &&
        at < self->preset_count)
        use(self, mapping, self->presets[at]);
    ui_hint(
        on,
        "Load a preset: the values of all parameters and the learned hand poses of this mapping.");
}

static void mapping_presets_draw(panel *self, ui *on, instance *mapping)
{
    if (self->presets_are_stale)
        mapping_presets_read(self);
    if (self->is_naming) {
        draw_naming(self, on);
        return;
    }
    draw_list(self, on, mapping);
    ui_text(on, UI_STYLE_DIM, "");
    ui_at(on, 66.0f);
    if (ui_button(on, "Save as\xe2\x80\xa6", UI_PLAIN)) {
        self->is_naming = true;
        self->was_naming = false;
        (void)snprintf(self->preset_name, sizeof self->preset_name, "%s", self->preset);
    }
    ui_hint(on, "Save all values and the learned hand poses as a preset.");
    if (!self->preset[0] || !presets_kept(app_settings(self->app), mapping->type, self->preset))
        return;
    ui_same_line(on);
    if (ui_button(on, "Delete", UI_QUIET))
        delete_preset(self, self->preset);
    ui_hint(on, "Delete the preset and keep the current values. Undo restores the preset.");
    if (!self->preset[0] || !plugin_interface(mapping->type, MRT_STATE))
        return;
    ui_same_line(on);
    if (ui_button(on, "Reload", UI_QUIET))
        use(self, mapping, self->preset);
    ui_hint(on, "Load the values and the learned hand poses of the preset again.");
}

/* ---- learn mode ---- */

/* ---- links ---- */

static const char *contact_name(const panel *self, uint32_t contact)
{
    const mrt_face *about = app_view(self->app)->about;
    return about && contact > 0 && contact <= about->contact_count
               ? about->contacts[contact - 1].name
               : NULL;
}

static void set_link(panel *self, instance *mapping, int finger, uint32_t contact)
{
    char words[EDIT_TEXT];
    const char *name = contact_name(self, contact);
    uint32_t index = learn_param_of(mapping->type, finger);
    if (index == mapping->type->param_count)
        return;
    for (uint32_t i = 0; i < mapping->type->param_count; ++i)
        self->values[i] = instance_value(mapping, i);
    self->values[index] = (double)contact;
    if (name)
        (void)snprintf(words, sizeof words, "%s pulls %.100s", learn_finger_name[finger], name);
    else
        (void)snprintf(words, sizeof words, "%s is not linked", learn_finger_name[finger]);
    set_all(self, self->values, words);
    (void)snprintf(self->learnt, sizeof self->learnt, "%s", words);
}

static void draw_links(panel *self, ui *on, instance *mapping)
{
    uint32_t count = 0;
    char missing[32];
    for (int finger = 0; finger < LEARN_FINGERS; ++finger) {
        uint32_t index = learn_param_of(mapping->type, finger);
        uint32_t contact =
            index < mapping->type->param_count ? (uint32_t)instance_value(mapping, index) : 0;
        if (contact == 0)
            continue;
        const char *name = contact_name(self, contact);
        (void)snprintf(missing, sizeof missing, "contact %u not found", contact);
        ui_id_begin(on, learn_finger_name[finger]);
        ui_label(on, "finger", 92.0f, THEME_TEXT, learn_finger_name[finger]);
        ui_label(on, "contact", ui_available_width(on) - 80.0f, name ? THEME_ACCENT : THEME_WARNING,
                 name ? name : missing);
        if (ui_button(on, "Remove", UI_QUIET))
            set_link(self, mapping, finger, 0);
        ui_id_end(on);
        count += 1;
    }
    if (count == 0)
        ui_text_wrapped(
            on, UI_STYLE_DIM,
            "No finger is linked to a contact. Each finger pulls the point it touches.");
}

/* ---- learning ---- */

static void begin(panel *self)
{
    self->is_learning = true;
    self->had_contacts = app_looks_of(self->app)->shows_contacts;
    app_looks_of(self->app)->shows_contacts = true;
    self->learnt[0] = '\0';
    learn_begin(&self->learn);
}

static void mapping_learn_end(panel *self)
{
    viewport *view = app_viewport(self->app);
    if (!self->is_learning)
        return;
    self->is_learning = false;
    app_looks_of(self->app)->shows_contacts = self->had_contacts;
    if (view)
        viewport_set_use(view, VIEWPORT_PERFORMS, 0.0f);
}

static void follow_click(panel *self, instance *mapping)
{
    viewport *view = app_viewport(self->app);
    const viewport_stroke *stroke = view ? viewport_stroke_now(view) : NULL;
    if (!stroke || !stroke->is_pressed)
        return;
    if (self->learn.finger == LEARN_NONE) {
        (void)snprintf(self->learnt, sizeof self->learnt,
                       "First move one finger, clearly more than the others.");
    } else if (stroke->contact == 0) {
        (void)snprintf(self->learnt, sizeof self->learnt,
                       "No contact at this point. Click one of the dots.");
    } else {
        set_link(self, mapping, self->learn.finger, stroke->contact);
        learn_begin(&self->learn); /* for the next finger */
    }
}

static void mapping_learn_update(panel *self, instance *mapping, double dt_s)
{
    viewport *view = app_viewport(self->app);
    if (!self->is_learning)
        return;
    if (!self->was_drawn || !mapping || !learn_can(mapping->type)) {
        mapping_learn_end(self);
        return;
    }
    app_want_frame(self->app, 0.0); /* the travel over the last second changes in each frame */
    learn_update(&self->learn, app_view(self->app)->hand, dt_s);
    if (view)
        viewport_set_use(view, VIEWPORT_PICKS, 0.0f);
    follow_click(self, mapping);
}

/* Draws the travel of each finger of a hand over the last second. */
static void draw_travel(const panel *self, ui *on, int first, const char *id)
{
    static const char *const letter[5] = {"thumb", "index", "middle", "ring", "little"};
    ui_canvas at;
    const float most_rad = 1.5f;
    ui_canvas_begin(on, id, 0.0f, 44.0f, &at);
    float wide = at.where.width / 5.0f;
    for (int i = 0; i < 5; ++i) {
        bool is_meant = self->learn.finger == first + i;
        float share = fminf(self->learn.travel_rad[first + i] / most_rad, 1.0f);
        ui_rectangle well = {at.where.x + wide * (float)i, at.where.y + 2.0f, wide - 8.0f, 22.0f};
        ui_draw_box(on, well, THEME_WELL, 2.0f);
        ui_draw_box(on,
                    (ui_rectangle){well.x, well.y + well.height * (1.0f - share), well.width,
                                   well.height * share},
                    is_meant ? THEME_ACCENT : THEME_HOVER, 2.0f);
        ui_draw_text(on, well.x, at.where.y + 26.0f, UI_STYLE_BODY,
                     is_meant ? THEME_ACCENT : THEME_DIM, wide - 2.0f, letter[i]);
    }
    ui_canvas_end(on);
}

static void draw_learning(panel *self, ui *on)
{
    const mrt_hand *hand = app_view(self->app)->hand;
    char words[96];
    if (!hand[0].present && !hand[1].present)
        (void)snprintf(words, sizeof words, "No hand is tracked. Open a glove in Devices.");
    else if (self->learn.finger == LEARN_NONE)
        (void)snprintf(words, sizeof words, "Move one finger.");
    else
        (void)snprintf(words, sizeof words, "Selected: %s. Now click a contact on the face.",
                       learn_finger_name[self->learn.finger]);
    ui_text_wrapped(on, UI_STYLE_STRONG, words);
    if (hand[MRT_RIGHT].present)
        draw_travel(self, on, 0, "right");
    if (hand[MRT_LEFT].present)
        draw_travel(self, on, 5, "left");
    if (ui_button(on, "Done", UI_PLAIN) || ui_pressed(on, UI_KEY_ESCAPE, 0))
        mapping_learn_end(self);
    ui_hint(on, "Stop learning (Escape).");
}

static void draw_cannot(panel *self, ui *on, const instance *mapping)
{
    char words[200];
    (void)snprintf(
        words, sizeof words,
        "%.60s cannot link fingers to contacts. Anchored can link each finger to a contact.",
        mapping->type->name);
    ui_text_wrapped(on, UI_STYLE_DIM, words);
    if (ui_button(on, "Switch to Anchored", UI_PLAIN))
        choose_mapping(self, "anchored");
    ui_hint(on, "Switch to another mapping. Undo restores this one.");
}

static void mapping_learn_draw(panel *self, ui *on, instance *mapping)
{
    if (!learn_can(mapping->type)) {
        draw_cannot(self, on, mapping);
        return;
    }
    draw_links(self, on, mapping);
    ui_space(on, 6.0f);
    if (self->is_learning)
        draw_learning(self, on);
    else if (ui_button(on, "Learn", UI_ACCENT))
        begin(self);
    if (!self->is_learning)
        ui_hint(on, "Link a finger to a contact: move the finger, then click the contact.");
    if (self->learnt[0])
        ui_text_wrapped(on, UI_STYLE_DIM, self->learnt);
}

/* ---- the panel ---- */

enum { TAB_PARAMETERS = 0, TAB_PEDALS, TAB_LEARN, TABS };
static const char *const tabs[TABS] = {"Parameters", "Pedals", "Learn"};

/* ---- the active mapping ---- */

static void find_groups(panel *self)
{
    self->group_count = 0;
    for (uint32_t i = 0; self->type && i < self->type->param_count; ++i) {
        const mrt_param *p = &self->type->params[i];
        bool is_known = !mapping_param_is_shown(p);
        for (uint32_t k = 0; k < self->group_count && !is_known; ++k)
            is_known = strcmp(self->group[k], p->group) == 0;
        if (!is_known && self->group_count < MAPPING_GROUPS_MAX)
            self->group[self->group_count++] = p->group;
    }
}

/* Returns the active mapping and resets the panel when the mapping or its version changes. NULL:
 * none, or no memory. */
static instance *follow_mapping(panel *self)
{
    instance *mapping = live_mapping(app_live(self->app));
    const mrt_plugin_type *type = mapping ? mapping->type : NULL;
    if (type != self->type) {
        self->type = type;
        self->is_held = false;
        free(self->lessons);
        self->lessons = NULL;
        self->lessons_wait_s = 0.0;
        free(self->values);
        self->values = type ? calloc((size_t)type->param_count + 1, sizeof(double)) : NULL;
        if (type &&
            strcmp(type->id, self->type_id) != 0) { /* another mapping, not just another version */
            (void)snprintf(self->type_id, sizeof self->type_id, "%s", type->id);
            self->preset[0] = self->find[0] = '\0';
            self->is_naming = false;
        }
        find_groups(self);
        mapping_presets_read(self);
    }
    return self->values ? mapping : NULL;
}

/* ---- choice ---- */

static void draw_choice(panel *self, ui *on)
{
    const plugin_list *plugins = app_plugins(self->app);
    const char *items[MAPPING_CHOICES_MAX] = {"none (mouse only)"};
    const mrt_plugin_type *types[MAPPING_CHOICES_MAX] = {NULL};
    uint32_t count = 1, chosen = 0;
    for (uint32_t i = 0; i < plugins->entry_count && count < MAPPING_CHOICES_MAX; ++i) {
        const mrt_plugin_type *type = plugins->entry[i].type;
        const bool is_chosen = self->type && strcmp(type->id, self->type->id) == 0;
        if (!plugin_interface(type, MRT_MAPPING) || (!is_chosen && !plugin_is_offered(type)))
            continue;
        if (is_chosen)
            chosen = count;
        items[count] = type->name;
        types[count++] = type;
    }
    const bool is_other = ui_choice(on, "Mapping", 66.0f, items, count, &chosen);
    ui_hint(on, "Choose how hands move the face. The face does not jump when you switch.");
    if (is_other)
        choose_mapping(self, types[chosen] ? types[chosen]->id : "");
    bool keeps_clay = live_keeps_clay(app_live(self->app));
    if (ui_check(on, "Keep the clay", &keeps_clay)) {
        live_keep_clay(app_live(self->app), keeps_clay);
        settings_set_number(app_settings(self->app), "stage.keeps_clay", keeps_clay ? 1.0 : 0.0);
    }
    ui_hint(on,
            "On: the shape that your hands kneaded stays when you choose another mapping or remove "
            "your hand. Off: the face returns to rest.");
}

/* ---- isolation and reload ---- */

static void draw_isolation(ui *on, const instance *mapping, const isolate_counts *counts)
{
    char words[400];
    const char *why = isolate_first_reason(mapping->self);
    if (counts->failed == 0) {
        ui_text(on, UI_STYLE_DIM, "Runs in a separate process.");
        return;
    }
    (void)snprintf(words, sizeof words, "Separate process %s: %.300s.",
                   counts->restarted > 1    ? "was restarted several times"
                   : counts->restarted == 1 ? "was restarted once"
                                            : "has failed",
                   why[0] ? why : "it failed");
    ui_text_wrapped(on, UI_STYLE_WARNING, words);
    if (counts->is_away)
        ui_text_wrapped(on, UI_STYLE_WARNING,
                        "The face is held. Choose this mapping again, or another one.");
}

static void draw_state(panel *self, ui *on, const instance *mapping)
{
    const live_status *status = app_status(self->app);
    char words[160];
    if (isolate_inner(mapping->type) != mapping->type)
        draw_isolation(on, mapping, &status->isolated);
    if (status->reload_taken > 0) {
        char times[24] = "once";
        if (status->reload_taken > 1)
            (void)snprintf(times, sizeof times, "%u times", status->reload_taken);
        (void)snprintf(words, sizeof words, "Plugin reloaded %s.", times);
        ui_text_wrapped(on, UI_STYLE_DIM, words);
    }
    if (status->reload_refused > 0) {
        const bool is_one = status->reload_refused == 1;
        (void)snprintf(words, sizeof words, "%u new version%s refused. See the log for the reason.",
                       status->reload_refused, is_one ? " was" : "s were");
        ui_text_wrapped(on, UI_STYLE_WARNING, words);
    }
}

/* ---- the panel ---- */

#define LOW_POINTS 420.0f /* below this height, the whole panel scrolls */

static void draw_mapping(panel *self, ui *on, instance *mapping, bool is_low)
{
    ui_text_wrapped(on, UI_STYLE_DIM, mapping->type->about);
    draw_state(self, on, mapping);
    ui_space(on, 4.0f);
    mapping_presets_draw(self, on, mapping);
    ui_space(on, 2.0f);
    (void)ui_tabs(on, "tabs", tabs, TABS, &self->tab);
    ui_space(on, is_low ? 0.0f : 4.0f);
    if (!is_low && self->tab == TAB_PARAMETERS)
        mapping_find_draw(self, on, mapping);
    if (!is_low)
        ui_scroll_begin(on, tabs[self->tab], 0.0f, 0.0f);
    ui_space(on, 4.0f);
    if (self->tab == TAB_PARAMETERS)
        mapping_params_draw(self, on, mapping);
    else if (self->tab == TAB_PEDALS)
        mapping_pedals_draw(self, on, mapping);
    else
        mapping_learn_draw(self, on, mapping);
    if (!is_low)
        ui_scroll_end(on);
}

static void draw(panel *self, ui *on, ui_rectangle where)
{
    instance *mapping = follow_mapping(self);
    const bool is_low = where.height < LOW_POINTS;
    ui_panel_begin(on, "mapping", where, UI_GROUND_PANEL);
    if (is_low && mapping && self->tab == TAB_PARAMETERS)
        mapping_find_draw(self, on, mapping);
    if (is_low)
        ui_scroll_begin(on, "all", 0.0f, 0.0f);
    draw_choice(self, on);
    mapping = follow_mapping(self);
    if (mapping)
        draw_mapping(self, on, mapping, is_low);
    else
        ui_text_wrapped(on, UI_STYLE_DIM, "No mapping is active. Only the mouse moves the face.");
    if (is_low)
        ui_scroll_end(on);
    self->was_drawn = mapping && self->tab == TAB_LEARN;
    ui_panel_end(on);
}

static void update(panel *self, double dt_s)
{
    char *preset = app_notes_of(self->app)->preset;
    instance *mapping = follow_mapping(self);
    mapping_learn_update(self, mapping, dt_s);
    self->lessons_wait_s -= dt_s;
    end_teaching(self, dt_s);
    if (preset[0] && mapping)
        use(self, mapping, preset);
    preset[0] = '\0';
    self->was_drawn = false;
}

static void destroy(panel *self)
{
    if (!self)
        return;
    mapping_learn_end(self);
    app_forget_changes(self->app, self);
    for (uint32_t side = 0; side < 2; ++side)
        hand_skeleton_destroy(self->skeleton[side]);
    free(self->lessons);
    free(self->untaught);
    free(self->values);
    free(self->presets);
    free(self);
}

static panel *create(app *of)
{
    panel *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->app = of;
    for (uint32_t side = 0; side < 2; ++side)
        self->skeleton[side] = hand_skeleton_create(side, HAND_LENGTH_MM);
    if (self->skeleton[0] && self->skeleton[1])
        return self;
    destroy(self);
    return NULL;
}

const panel_type panel_mapping = {create, destroy, draw, update};
