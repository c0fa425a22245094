/* The life of a live stage: its input (life_input.h), which follows what [main] wants. */
#include "stage/live/live_stage.h"

#include <stdio.h>
#include <string.h>

static const char *const key[LIFE_KINDS] = {
    [LIFE_BLINK] = "blink", [LIFE_GAZE] = "gaze", [LIFE_BREATH] = "breath", [LIFE_LEAN] = "lean"};

static input *input_of(live *self)
{
    for (uint32_t i = 0; i < self->entry_count; ++i)
        if (strcmp(input_plugin(self->entry[i].input)->id, LIFE_ID) == 0)
            return self->entry[i].input;
    return NULL;
}

/* A take has its own life. */
static bool has_take_life(const live *self)
{
    bool has = false;
    for (uint32_t i = 0; self->is_shown && i < self->shown.layer_count; ++i) {
        const take_layer *l = &self->shown.layer[i];
        has |= l->clip_count > 0 && l->clip[0].part == TAKE_LIFE;
    }
    return has;
}

/* The face lives while hands perform it, and over a take that does not live. */
static bool is_alive(const live *self)
{
    return !self->is_shown || (self->is_over && !has_take_life(self));
}

static bool is_wanted(const live *self)
{
    bool is_any = false;
    for (int i = 0; i < LIFE_KINDS; ++i)
        is_any |= self->life.wanted.is_on[i] && self->life.wanted.strength[i] > 0.0;
    return is_any;
}

static void open_input(live *self)
{
    live_life *l = &self->life;
    input *made;
    error err = {""};
    if (self->status.is_recording || (l->trouble.text[0] && l->refused_at == self->entry_count))
        return;
    mrt_result result = input_create(&made, &life_input_type, "", "blink=0,gaze=0,breath=0,lean=0",
                                     CLOCK_REAL, self->settings.log, &err);
    if (result >= 0)
        result = live_add_input(self, made, TAKE_LIFE_LAYER, &err);
    l->refused_at = self->entry_count;
    l->trouble.text[0] = '\0';
    if (result < 0) {
        (void)error_set(&l->trouble, result, "%s", err.text);
        log_push(self->settings.log, MRT_LOG_WARNING, "stage", err.text);
    }
    for (int i = 0; i < LIFE_KINDS; ++i)
        l->sent[i] = 0.0;
    l->sent_seed = UINT32_MAX;
}

static void send(live *self, input *to, const char *name, double value)
{
    char text[32];
    error err = {""};
    (void)snprintf(text, sizeof text, "%.9g", value);
    if (input_set(to, name, text, &err) < 0)
        log_push(self->settings.log, MRT_LOG_ERROR, "stage", err.text);
}

void live_life_update(live *self)
{
    live_life *l = &self->life;
    input *to = input_of(self);
    if (!to && is_wanted(self))
        open_input(self);
    to = input_of(self);
    if (!to)
        return;
    l->trouble.text[0] = '\0';
    if (l->sent_seed != l->wanted.seed)
        send(self, to, "seed", (double)l->wanted.seed);
    l->sent_seed = l->wanted.seed;
    for (int i = 0; i < LIFE_KINDS; ++i) {
        const double value = l->wanted.is_on[i] && is_alive(self) ? l->wanted.strength[i] : 0.0;
        if (value >= l->sent[i] && value <= l->sent[i])
            continue;
        send(self, to, key[i], value);
        l->sent[i] = value;
    }
}

void live_set_life(live *self, const life_settings *to)
{
    self->life.wanted = *to;
}

const char *live_life_trouble(const live *self)
{
    return self->life.trouble.text;
}

const char *live_life_missing(const live *self, life_kind kind)
{
    return life_missing(&self->scene->performer->voice[0].layer->life.body, kind);
}
