#include "window/app/pose_palette.h"
#include "window/app/app.h"
#include "window/app/channel_learn.h"
#include "window/gui/ui.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NOBODY UINT32_MAX

static const double follow_s = 0.04; /* fade behind a fader, which is read once a frame */
static const double press_share = 0.02;
/* Share of its range at which a control counts as pressed. A fader is learnt from this on. */

typedef struct played { /* one pose */
    double latched;     /* by a press or the remote control */
    double sent;        /* what the stage was told; below 0: something else than before */
    double fade_s;      /* of the next change; NaN: as the settings say */
    double level;       /* of this frame */
    bool is_followed;   /* a fader moved it in this frame */
} played;

struct pose_palette {
    app *of;
    pose_settings settings;
    bool is_wanted;
    bool is_refused; /* reported; another number of inputs than refused_inputs may help */
    uint32_t refused_inputs;
    error trouble;
    const mrt_rig_pose *poses; /* of the stage; only to be compared */
    uint32_t count;
    played pose[PALETTE_POSES_MAX];
    bool was_down[POSE_TRIGGERS_MAX];
    double was_share[POSE_TRIGGERS_MAX];
    bool is_key_down[POSE_TRIGGERS_MAX];
    uint32_t pressed; /* by the mouse; NOBODY: none */
    uint32_t learns;
    bool keys_before[UI_KEY_COUNT];
    channel_learner learner;
};

/* ---- settings ---- */

static const char mode_key[] = "poses.mode", in_key[] = "poses.fade_in",
                  out_key[] = "poses.fade_out", strength_key[] = "poses.strength",
                  triggers_key[] = "poses.triggers", favourites_key[] = "poses.favourites";
enum { TRIGGER_TEXT = POSE_NAME + 2 * PATCH_NAME + 32 };

static double within(double value, double most, double otherwise)
{
    return value >= 0.0 && value <= most ? value : otherwise;
}

/* "jawOpen=key Q", "jawOpen=press midi: note.36", "jawOpen=follow midi: cc.1". */
static void write_trigger(const pose_trigger *t, char out[TRIGGER_TEXT])
{
    char words[KEY_WORDS];
    key_chord_words((key_chord){t->key, 0}, words);
    if (t->key)
        (void)snprintf(out, TRIGGER_TEXT, "%s=key %s", t->pose, words);
    else
        (void)snprintf(out, TRIGGER_TEXT, "%s=%s %s: %s", t->pose, t->follows ? "follow" : "press",
                       t->input, t->channel);
}

static bool copy_part(char *out, size_t capacity, const char *from, const char *to)
{
    const size_t size = (size_t)(to - from);
    if (size == 0 || size >= capacity)
        return false;
    memcpy(out, from, size);
    out[size] = '\0';
    return true;
}

static bool read_trigger(pose_trigger *out, const char *text)
{
    const char *equals = strchr(text, '=');
    *out = (pose_trigger){.key = 0};
    if (!equals || !copy_part(out->pose, sizeof out->pose, text, equals))
        return false;
    const char *how = equals + 1;
    key_chord chord;
    if (strncmp(how, "key ", 4) == 0) {
        out->key = key_chord_parse(&chord, how + 4) && !chord.modifiers ? chord.key : 0;
        return out->key != 0;
    }
    out->follows = strncmp(how, "follow ", 7) == 0;
    const char *at = out->follows ? how + 7 : how + 6, *colon = strstr(at, ": ");
    return (out->follows || strncmp(how, "press ", 6) == 0) && colon &&
           copy_part(out->input, sizeof out->input, at, colon) &&
           copy_part(out->channel, sizeof out->channel, colon + 2, colon + 2 + strlen(colon + 2));
}

static void read_settings(pose_settings *out, const settings *from)
{
    const char *text[POSE_TRIGGERS_MAX];
    *out = (pose_settings){
        .mode = settings_number(from, mode_key, 0.0) > 0.5 ? POSE_LATCH : POSE_HOLD,
        .fade_in_s = within(settings_number(from, in_key, 0.15), POSE_FADE_MOST_S, 0.15),
        .fade_out_s = within(settings_number(from, out_key, 0.25), POSE_FADE_MOST_S, 0.25),
        .strength = within(settings_number(from, strength_key, 1.0), 1.0, 1.0)};
    uint32_t count = settings_list(from, triggers_key, text, POSE_TRIGGERS_MAX);
    for (uint32_t i = 0; i < count; ++i)
        out->trigger_count += read_trigger(&out->trigger[out->trigger_count], text[i]);
    count = settings_list(from, favourites_key, text, POSE_FAVOURITES_MAX);
    for (uint32_t i = 0; i < count; ++i)
        if (text[i][0] && strlen(text[i]) < POSE_NAME)
            (void)snprintf(out->favourite[out->favourite_count++], POSE_NAME, "%s", text[i]);
}

static void keep_settings(const pose_palette *self)
{
    settings *to = app_settings(self->of);
    const pose_settings *s = &self->settings;
    char(*line)[TRIGGER_TEXT] = calloc(POSE_TRIGGERS_MAX, sizeof *line);
    const char *text[POSE_TRIGGERS_MAX];
    settings_set_number(to, mode_key, s->mode);
    settings_set_number(to, in_key, s->fade_in_s);
    settings_set_number(to, out_key, s->fade_out_s);
    settings_set_number(to, strength_key, s->strength);
    for (uint32_t i = 0; line && i < s->trigger_count; ++i) {
        write_trigger(&s->trigger[i], line[i]);
        text[i] = line[i];
    }
    if (line)
        settings_set_list(to, triggers_key, text, s->trigger_count, POSE_TRIGGERS_MAX);
    free(line);
    for (uint32_t i = 0; i < s->favourite_count; ++i)
        text[i] = s->favourite[i];
    settings_set_list(to, favourites_key, text, s->favourite_count, POSE_FAVOURITES_MAX);
}

static mrt_result use_settings(void *owner, const void *value)
{
    pose_palette *self = owner;
    self->settings = *(const pose_settings *)value;
    memset(self->was_down, 0, sizeof self->was_down);
    memset(self->was_share, 0, sizeof self->was_share);
    memset(self->is_key_down, 0, sizeof self->is_key_down);
    self->is_wanted |= self->settings.trigger_count > 0;
    keep_settings(self);
    return MRT_OK;
}

const pose_settings *pose_palette_settings(const pose_palette *self)
{
    return &self->settings;
}

void pose_palette_change(pose_palette *self, const pose_settings *to, const char *words)
{
    const pose_settings before = self->settings;
    undo_change made = {.owner = self, .set = use_settings};
    (void)snprintf(made.words, sizeof made.words, "poses: %.120s", words);
    (void)use_settings(self, to);
    app_add_copied_change(self->of, &made, &before, to, sizeof before);
}

/* ---- create and destroy ---- */

pose_palette *pose_palette_create(app *of, const settings *from)
{
    pose_palette *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->of = of;
    self->pressed = self->learns = NOBODY;
    read_settings(&self->settings, from);
    self->is_wanted = self->settings.trigger_count > 0;
    return self;
}

void pose_palette_destroy(pose_palette *self)
{
    free(self);
}

void pose_palette_want(pose_palette *self)
{
    self->is_wanted = true;
}

const char *pose_palette_trouble(const pose_palette *self)
{
    return self->trouble.text;
}

/* ---- the poses of the face ---- */

uint32_t pose_palette_count(const pose_palette *self)
{
    return self->count;
}

const char *pose_palette_name(const pose_palette *self, uint32_t pose)
{
    return self->poses[pose].name;
}

uint32_t pose_palette_find(const pose_palette *self, const char *name)
{
    for (uint32_t i = 0; i < self->count; ++i)
        if (strcmp(self->poses[i].name, name) == 0)
            return i;
    return NOBODY;
}

double pose_palette_wanted(const pose_palette *self, uint32_t pose)
{
    return pose < self->count ? fmax(self->pose[pose].sent, 0.0) : 0.0;
}

static void forget_poses(pose_palette *self)
{
    for (uint32_t i = 0; i < PALETTE_POSES_MAX; ++i)
        self->pose[i] = (played){.sent = -1.0, .fade_s = NAN};
    self->pressed = self->learns = NOBODY;
}

/* Opens the palette, and follows the face. False: no pose can be played now. */
static bool follow_stage(pose_palette *self)
{
    live *stage = app_live(self->of);
    const bool is_recording = app_status(self->of)->is_recording;
    uint32_t count;
    const mrt_rig_pose *poses = live_poses(stage, &count);
    if (poses != self->poses) {
        self->poses = poses;
        self->count = 0;
        self->is_refused = false;
        forget_poses(self);
    }
    self->is_refused &= live_input_count(stage) == self->refused_inputs;
    self->trouble.text[0] = '\0';
    if (count == 0) {
        (void)error_set(&self->trouble, MRT_ERR_UNSUPPORTED,
                        "This face has no poses. A rig gives it some: see the panel Rig.");
        return false;
    }
    if (!is_recording && !self->is_refused) {
        error err = {""};
        self->is_refused = live_palette_open(stage, &err) < 0;
        self->refused_inputs = live_input_count(stage);
        if (self->is_refused)
            news_list_add(app_news(self->of), MRT_LOG_WARNING, "stage", err.text);
    }
    self->count = live_palette_count(stage);
    if (self->count == 0)
        (void)error_set(&self->trouble, MRT_ERR_UNSUPPORTED,
                        is_recording ? "End the take to play poses."
                                     : "Poses cannot be played: too many inputs are open. Remove "
                                       "one in the panel Devices.");
    return self->count > 0;
}

/* ---- controls ---- */

static void latch(pose_palette *self, uint32_t pose, double strength)
{
    played *p = &self->pose[pose];
    p->latched = p->latched > 0.0 ? 0.0 : strength;
}

void pose_palette_press(pose_palette *self, uint32_t pose)
{
    if (pose >= self->count)
        return;
    if (self->settings.mode == POSE_LATCH)
        latch(self, pose, self->settings.strength);
    else
        self->pressed = pose;
}

void pose_palette_release(pose_palette *self)
{
    self->pressed = NOBODY;
}

bool pose_palette_has_key(const pose_palette *self, uint32_t key)
{
    if (self->learns != NOBODY)
        return key < 128 && key != ' ';
    for (uint32_t i = 0; i < self->settings.trigger_count && self->count > 0; ++i)
        if (self->settings.trigger[i].key == key)
            return true;
    return false;
}

/* Removes other triggers of the same control: a control plays one pose. */
static void forget_control(pose_settings *s, const pose_trigger *t)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < s->trigger_count; ++i) {
        const pose_trigger *o = &s->trigger[i];
        const bool is_same = o->key == t->key && strcmp(o->input, t->input) == 0 &&
                             strcmp(o->channel, t->channel) == 0;
        if (!is_same)
            s->trigger[kept++] = *o;
    }
    s->trigger_count = kept;
}

static void add_trigger(pose_palette *self, pose_trigger t)
{
    pose_settings to = self->settings;
    char words[TRIGGER_TEXT], before[POSE_NAME] = "";
    for (uint32_t i = 0; i < to.trigger_count; ++i)
        if (to.trigger[i].key == t.key && strcmp(to.trigger[i].channel, t.channel) == 0 &&
            strcmp(to.trigger[i].input, t.input) == 0)
            (void)snprintf(before, sizeof before, "%s", to.trigger[i].pose);
    (void)snprintf(t.pose, sizeof t.pose, "%s", pose_palette_name(self, self->learns));
    self->learns = NOBODY;
    forget_control(&to, &t);
    if (to.trigger_count == POSE_TRIGGERS_MAX) {
        news_list_add(app_news(self->of), MRT_LOG_WARNING, "stage",
                      "poses: no more controls can be learnt. Forget one first.");
        return;
    }
    to.trigger[to.trigger_count++] = t;
    write_trigger(&t, words);
    pose_palette_change(self, &to, words);
    if (before[0] && strcmp(before, t.pose) != 0) {
        (void)snprintf(words, sizeof words, "poses: this control played %s before", before);
        news_list_add(app_news(self->of), MRT_LOG_INFO, "stage", words);
    }
}

void pose_palette_read_keys(pose_palette *self, const ui *keys, bool (*is_taken)(uint32_t key))
{
    for (uint32_t i = 0; i < self->settings.trigger_count; ++i) {
        const uint32_t key = self->settings.trigger[i].key;
        self->is_key_down[i] =
            key && ui_modifiers(keys) == 0 && ui_is_down(keys, key) && !(is_taken && is_taken(key));
    }
    for (uint32_t key = '!'; self->learns != NOBODY && key < 127; ++key)
        if (ui_pressed(keys, key, 0)) {
            add_trigger(self, (pose_trigger){.key = key});
            self->was_down[self->settings.trigger_count - 1] = true; /* it plays when it is free */
            return;
        }
}

void pose_palette_learn(pose_palette *self, uint32_t pose)
{
    self->learns = pose < self->count ? pose : NOBODY;
    self->learner = (channel_learner){.count = 0};
}

uint32_t pose_palette_learns(const pose_palette *self)
{
    return self->learns;
}

static void learn_channel(pose_palette *self, const channels_now *now)
{
    patch_connection found;
    if (self->learns == NOBODY || !channel_learn(&self->learner, now, &found))
        return;
    pose_trigger t = {.follows = !self->learner.has_jumped};
    mrt_channel channel;
    double raw;
    memcpy(t.input, found.input, sizeof t.input);
    memcpy(t.channel, found.channel, sizeof t.channel);
    if (patch_read_channel(&found, &now->frame, &channel, &raw) &&
        (channel.semantic == MRT_CH_BUTTON || channel_is_pedal(&channel)))
        t.follows = false;
    add_trigger(self, t);
    self->was_down[self->settings.trigger_count - 1] = true;
}

/* Whether the control was pressed since the last frame, perhaps for less than a frame. */
static bool was_hit(const pose_trigger *t, const channels_now *now, const uint64_t *presses)
{
    for (uint32_t k = 0; k < now->frame.input_count && !t->key; ++k)
        for (uint32_t c = 0; c < now->inputs[k].count; ++c)
            if ((presses[k] >> c & 1u) && patch_is_input(t->input, now->inputs[k].name) &&
                strcmp(now->inputs[k].channel[c].name, t->channel) == 0)
                return true;
    return false;
}

/* Reads the share of its range at which a control is, 0..1. A lost device counts as released. */
static double share_of(const pose_palette *self, uint32_t i, const channels_now *now)
{
    static const patch_range whole = {0.0, 1.0, 0.0};
    const pose_trigger *t = &self->settings.trigger[i];
    patch_connection c = patch_connection_of(PATCH_POSE);
    mrt_channel channel;
    double raw;
    if (t->key)
        return self->is_key_down[i] ? self->settings.strength : 0.0;
    memcpy(c.input, t->input, sizeof c.input);
    memcpy(c.channel, t->channel, sizeof c.channel);
    for (uint32_t k = 0; k < now->frame.input_count; ++k)
        if (now->is_lost[k] && patch_is_input(t->input, now->inputs[k].name))
            return 0.0;
    if (!patch_read_channel(&c, &now->frame, &channel, &raw))
        return 0.0;
    return fabs(patch_wanted(&c, &channel, raw, &whole));
}

static void read_trigger_now(pose_palette *self, uint32_t i, const channels_now *now,
                             const uint64_t *presses)
{
    const pose_trigger *t = &self->settings.trigger[i];
    const uint32_t pose = pose_palette_find(self, t->pose);
    const double before = self->was_share[i];
    double share = share_of(self, i, now);
    const bool is_hit = !t->follows && was_hit(t, now, presses);
    if (share < press_share && is_hit)
        share = self->settings.strength; /* its velocity is over */
    const bool is_down = share >= press_share, is_press = is_hit || (is_down && !self->was_down[i]);
    self->was_down[i] = is_down;
    self->was_share[i] = share;
    if (pose == NOBODY)
        return;
    played *p = &self->pose[pose];
    p->is_followed |= t->follows && (share < before || share > before);
    if (t->follows || self->settings.mode == POSE_HOLD)
        p->level += share;
    else if (is_press)
        latch(self, pose, share);
}

/* ---- what the stage is told ---- */

static double fade_of(const pose_palette *self, const played *p)
{
    if (!isnan(p->fade_s))
        return p->fade_s;
    if (p->is_followed)
        return follow_s;
    return p->level > p->sent ? self->settings.fade_in_s : self->settings.fade_out_s;
}

/* Sends all changes: those with the same fade together. */
static void send_changes(pose_palette *self)
{
    live *stage = app_live(self->of);
    for (uint32_t first = 0; first < self->count; ++first) {
        const played *of = &self->pose[first];
        if (!(of->level < of->sent || of->level > of->sent))
            continue;
        const double fade_s = fade_of(self, of);
        for (uint32_t i = first; i < self->count; ++i) {
            played *p = &self->pose[i];
            const double own_s = fade_of(self, p);
            if (!(p->level < p->sent || p->level > p->sent) || own_s < fade_s || own_s > fade_s)
                continue;
            live_palette_set(stage, i, p->level);
            p->sent = p->level;
            p->fade_s = NAN;
        }
        live_palette_send(stage, fade_s);
    }
}

void pose_palette_update(pose_palette *self)
{
    channels_now now;
    uint64_t presses[CHANNELS_INPUTS];
    if (!self->is_wanted || !app_live(self->of) || !follow_stage(self))
        return;
    channels_read(&now, self->of);
    for (uint32_t i = 0; i < CHANNELS_INPUTS; ++i)
        presses[i] = live_input_presses(app_live(self->of), i);
    if (self->learns != NOBODY) /* the press that is learnt plays nothing */
        memset(presses, 0, sizeof presses);
    learn_channel(self, &now);
    for (uint32_t i = 0; i < self->count; ++i) {
        self->pose[i].level = self->pose[i].latched;
        self->pose[i].is_followed = false;
    }
    for (uint32_t i = 0; i < self->settings.trigger_count; ++i)
        read_trigger_now(self, i, &now, presses);
    if (self->settings.mode == POSE_LATCH)
        for (uint32_t i = 0; i < self->count; ++i) /* a press of this frame */
            self->pose[i].level = fmax(self->pose[i].level, self->pose[i].latched);
    if (self->pressed != NOBODY)
        self->pose[self->pressed].level += self->settings.strength;
    for (uint32_t i = 0; i < self->count; ++i)
        self->pose[i].level = fmin(self->pose[i].level, 1.0);
    send_changes(self);
    bool is_polled = self->learns != NOBODY; /* pads and faders move while the face rests */
    for (uint32_t i = 0; i < self->settings.trigger_count; ++i)
        is_polled |= self->settings.trigger[i].key == 0;
    if (is_polled)
        app_want_frame(self->of, 0.0);
}

/* ---- the remote control, neutral ---- */

static void list_names(const pose_palette *self, char *out, size_t capacity)
{
    size_t used = 0;
    out[0] = '\0';
    for (uint32_t i = 0; i < self->count && used < capacity; ++i)
        used += (size_t)snprintf(out + used, capacity - used, "%s%s", i ? ", " : "",
                                 pose_palette_name(self, i));
}

mrt_result pose_palette_set(pose_palette *self, const char *name, double amount, double fade_s,
                            error *err)
{
    const uint32_t pose = pose_palette_find(self, name);
    char names[160];
    if (pose != NOBODY) {
        self->pose[pose].latched = amount;
        self->pose[pose].fade_s = fade_s;
        return MRT_OK;
    }
    list_names(self, names, sizeof names);
    return self->count == 0
               ? error_set(err, MRT_ERR_UNSUPPORTED, "%s",
                           self->trouble.text[0] ? self->trouble.text
                                                 : "the face on the stage has no poses")
               : error_set(err, MRT_ERR_ARGUMENT, "the face has no pose \"%s\"; it has %s", name,
                           names);
}

void pose_palette_release_all(pose_palette *self, double fade_s)
{
    for (uint32_t i = 0; i < self->count; ++i)
        if (self->pose[i].latched > 0.0) {
            self->pose[i].latched = 0.0;
            self->pose[i].fade_s = fade_s;
        }
    self->pressed = NOBODY;
}

void pose_palette_describe(const pose_palette *self, const char *name, char *out, size_t capacity)
{
    size_t used = 0;
    out[0] = '\0';
    for (uint32_t i = 0; i < self->settings.trigger_count && used < capacity; ++i) {
        const pose_trigger *t = &self->settings.trigger[i];
        char words[KEY_WORDS];
        if (strcmp(t->pose, name) != 0)
            continue;
        key_chord_words((key_chord){t->key, 0}, words);
        used += (size_t)snprintf(out + used, capacity - used, "%s%.60s", used ? ", " : "",
                                 t->key ? words : t->channel);
    }
}
