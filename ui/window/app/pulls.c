#include "window/app/pulls.h"

#include <stdio.h>
#include <stdlib.h>

enum {
    KEPT_MAX = 256, /* as many steps as are undone at all */
    KEPT_BYTES = 256 << 20
};

typedef struct kept { /* the face on the other side of a step: before it, or after it once undone */
    void *bytes;      /* NULL: it was too much to keep */
    size_t size;
    bool is_held;
} kept;

struct pulls {
    app *of;
    kept begun, step[KEPT_MAX]; /* a ring, by the steps' numbers */
    uint64_t count;             /* of steps so far */
    size_t bytes;               /* of all steps */
    bool is_held;
};

static void drop(pulls *self, kept *one)
{
    if (one != &self->begun)
        self->bytes -= one->size;
    free(one->bytes);
    *one = (kept){.is_held = false};
}

static kept look(pulls *self)
{
    error err = {0};
    kept out = {.is_held = self->is_held};
    if (live_save_pulled(app_live(self->of), &out.bytes, &out.size, &err) < 0)
        news_list_add(app_news(self->of), MRT_LOG_WARNING, "stage", err.text);
    return out;
}

/* The oldest go first, when all of them are too much. */
static void put(pulls *self, kept *to, const kept *one)
{
    *to = *one;
    self->bytes += one->size;
    for (uint64_t i = self->count > KEPT_MAX ? self->count - KEPT_MAX : 0;
         i < self->count && self->bytes > KEPT_BYTES; ++i)
        if (&self->step[i % KEPT_MAX] != to)
            drop(self, &self->step[i % KEPT_MAX]);
}

/* To the other side of a step; back is the same. */
static void cross(void *owner, uint64_t number)
{
    pulls *self = owner;
    error err = {0};
    kept *there = &self->step[number % KEPT_MAX];
    kept here = {.bytes = NULL};
    mrt_result result = MRT_OK;
    if (!there->bytes)
        result = error_set(&err, MRT_ERR_ARGUMENT, "that pull is too long ago");
    if (result >= 0)
        result = live_save_pulled(app_live(self->of), &here.bytes, &here.size, &err);
    if (result >= 0)
        result = live_load_pulled(app_live(self->of), there->bytes, there->size, &err);
    if (result < 0) {
        free(here.bytes);
        news_list_add(app_news(self->of), MRT_LOG_ERROR, "stage", err.text);
        return;
    }
    here.is_held = self->is_held;
    self->is_held = there->is_held;
    drop(self, there);
    put(self, there, &here);
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
    drop(self, &self->begun);
    self->begun = look(self);
}

static void did(pulls *self, const char *words)
{
    app_step step = {.owner = self, .undo = cross, .redo = cross, .number = self->count};
    (void)snprintf(step.words, sizeof step.words, "%s", words);
    kept *to = &self->step[self->count++ % KEPT_MAX];
    drop(self, to);
    put(self, to, &self->begun);
    self->begun = (kept){.is_held = false};
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
        did(self, "clearing what was held");
    self->is_held = false;
}

void pulls_forget(pulls *self)
{
    app_forget_steps(self->of, self);
    drop(self, &self->begun);
    for (uint32_t i = 0; i < KEPT_MAX; ++i)
        drop(self, &self->step[i]);
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
