#include "window/app/pulls.h"

#include <stdio.h>
#include <stdlib.h>

typedef struct kept { /* the face on the other side of a step: before it, or after it once undone */
    void *bytes;
    size_t size;
    bool is_held;
} kept;

struct pulls {
    app *of;
    kept begun; /* no bytes: nothing has, or it was too much to keep */
    bool is_held;
};

static void finish(kept *one)
{
    free(one->bytes);
    *one = (kept){.is_held = false};
}

static void forget(void *data)
{
    finish(data);
    free(data);
}

static kept look(pulls *self)
{
    error err = {0};
    kept out = {.is_held = self->is_held};
    if (live_save_pulled(app_live(self->of), &out.bytes, &out.size, &err) < 0)
        news_list_add(app_news(self->of), MRT_LOG_WARNING, "stage", err.text);
    return out;
}

/* To the other side of a step; back is the same. */
static void cross(void *owner, void *data)
{
    pulls *self = owner;
    kept *there = data;
    error err = {0};
    kept here = {.is_held = self->is_held};
    mrt_result result = live_save_pulled(app_live(self->of), &here.bytes, &here.size, &err);
    if (result >= 0)
        result = live_load_pulled(app_live(self->of), there->bytes, there->size, &err);
    if (result < 0) {
        finish(&here);
        news_list_add(app_news(self->of), MRT_LOG_ERROR, "stage", err.text);
        return;
    }
    self->is_held = there->is_held;
    finish(there);
    *there = here;
}

pulls *pulls_create(app *of)
{
    pulls *self = calloc(1, sizeof *self);
    if (self)
        self->of = of;
    return self;
}

void pulls_destroy(pulls *self)
{
    if (!self)
        return;
    pulls_forget(self);
    free(self);
}

void pulls_begin(pulls *self)
{
    finish(&self->begun);
    self->begun = look(self);
}

static void did(pulls *self, const char *words)
{
    kept *made = self->begun.bytes ? malloc(sizeof *made) : NULL;
    if (!made)
        return;
    *made = self->begun;
    self->begun = (kept){.is_held = false};
    app_step step = {.owner = self,
                     .undo = cross,
                     .redo = cross,
                     .data = made,
                     .bytes = sizeof *made + made->size,
                     .forget = forget};
    (void)snprintf(step.words, sizeof step.words, "%s", words);
    app_did(self->of, &step);
}

void pulls_did(pulls *self, const char *words)
{
    did(self, words);
    self->is_held = true;
}

void pulls_clear(pulls *self)
{
    if (self->is_held)
        pulls_begin(self);
    live_neutral(app_live(self->of));
    if (self->is_held)
        did(self, "clearing what was held");
    self->is_held = false;
}

void pulls_forget(pulls *self)
{
    app_forget_steps(self->of, self);
    finish(&self->begun);
    self->is_held = false;
}

bool pulls_is_step(const pulls *self, const app_step *step)
{
    return step->owner == self;
}

bool pulls_is_held(const pulls *self)
{
    return self->is_held;
}
