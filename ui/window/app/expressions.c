#include "window/app/expressions.h"
#include "window/app/app.h"

#include "stage/input/channel_table.h"
#include "stage/input/feed.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define INPUT_NAME "expressions" /* as the id ends (input_name_of) */

static const double rate_hz = 125.0;
static const double settle_s = 0.5;  /* samples continue for this time after a fade, until the
                                        smoothing of the patch has settled */
static const double smooth_s = 0.02; /* between two drawn frames */

typedef struct expression {
    char name[CHANNEL_NAME];
    double from, to, now; /* 0..1 */
    double at_s, fade_s;  /* since it was asked for; for how long it fades */
} expression;

struct expressions {
    app *of;
    bool is_wanted, is_refused; /* refused: reported */
    expression item[MRT_MAX_CHANNELS];
    uint32_t count;
    feed *feed;
    input *made; /* live's; only to be compared */
    bool is_moving;
    double still_s;
};

expressions *expressions_create(app *of)
{
    expressions *self = calloc(1, sizeof *self);
    if (self)
        self->of = of;
    return self;
}

void expressions_destroy(expressions *self)
{
    if (!self)
        return;
    feed_destroy(self->feed);
    free(self);
}

void expressions_want(expressions *self)
{
    self->is_wanted = true;
}

/* ---- the input ---- */

static uint32_t index_of_input(const expressions *self)
{
    live *stage = app_live(self->of);
    for (uint32_t i = 0; self->made && i < live_input_count(stage); ++i)
        if (live_input(stage, i) == self->made)
            return i;
    return UINT32_MAX;
}

/* Poses that a channel can be named by. */
static uint32_t poses_of(const app *of, const char *out[MRT_MAX_CHANNELS])
{
    const rig *r = app_face(of)->rig;
    uint32_t count = 0;
    for (uint32_t i = 0; r && i < r->pose_count && count < MRT_MAX_CHANNELS; ++i)
        if (strlen(r->pose[i].name) < CHANNEL_NAME)
            out[count++] = r->pose[i].name;
    return count;
}

static bool is_of(const expressions *self, const char *const *pose, uint32_t count)
{
    bool is_same = self->count == count;
    for (uint32_t i = 0; i < count && is_same; ++i)
        is_same = strcmp(self->item[i].name, pose[i]) == 0;
    return is_same;
}

static void give(expressions *self, feed_activity activity)
{
    float value[MRT_MAX_CHANNELS] = {0};
    for (uint32_t i = 0; i < self->count; ++i)
        value[i] = (float)self->item[i].now;
    feed_push(self->feed, value, activity);
    self->is_moving = activity == FEED_MOVES;
}

/* Removes the input from the stage. False: it cannot be removed now. */
static bool leave(expressions *self)
{
    error ignored = {""};
    const uint32_t index = index_of_input(self);
    if (index != UINT32_MAX && live_remove_input(app_live(self->of), index, &ignored) < 0)
        return false;
    feed_destroy(self->feed);
    self->feed = NULL;
    self->made = NULL;
    self->count = 0;
    return true;
}

static mrt_result join(expressions *self, const char *const *pose, uint32_t count, error *err)
{
    mrt_channel channel[MRT_MAX_CHANNELS];
    const feed_settings wanted = {.id = "org.marotte.expressions",
                                  .name = INPUT_NAME,
                                  .channels = channel,
                                  .channel_count = count,
                                  .rate_hz = rate_hz};
    for (uint32_t i = 0; i < count; ++i) {
        self->item[i] = (expression){.now = 0.0};
        (void)snprintf(self->item[i].name, sizeof self->item[i].name, "%s", pose[i]);
        channel[i] = (mrt_channel){self->item[i].name, "",   MRT_CH_OTHER,
                                   MRT_NO_HAND,        0.0f, 1.0f}; /* copied */
    }
    self->count = count;
    mrt_result result = feed_create(&self->feed, &wanted, err);
    if (result >= 0)
        result = input_create(&self->made, feed_type(self->feed), "", "", CLOCK_REAL,
                              app_log(self->of), err);
    if (result >= 0) {
        give(self, FEED_MOVES); /* until the patch has heard it */
        self->still_s = 0.0;
        result = live_add_input(app_live(self->of), self->made, INPUT_NAME, err);
    }
    if (result < 0) { /* remove the input that could not join */
        self->made = NULL;
        (void)leave(self);
    }
    return result;
}

/* The face's poses, when it is another one; not while a take is recorded. */
static bool follow_face(expressions *self)
{
    const char *pose[MRT_MAX_CHANNELS];
    error err = {""};
    const uint32_t count = poses_of(self->of, pose);
    const bool has_joined = index_of_input(self) != UINT32_MAX;
    if (is_of(self, pose, count) && (has_joined || count == 0))
        return false;
    if (app_status(self->of)->is_recording || self->is_refused || !leave(self))
        return false;
    if (count > 0 && join(self, pose, count, &err) < 0) {
        self->is_refused = true;
        news_list_add(app_news(self->of), MRT_LOG_WARNING, "stage", err.text);
    }
    return true;
}

/* ---- fades ---- */

static bool fade(expression *one, double dt_s)
{
    const double before = one->now;
    one->at_s += dt_s;
    double share = one->fade_s > 0.0 ? one->at_s / one->fade_s : 1.0;
    share = share > 1.0 ? 1.0 : share;
    one->now = one->from + (one->to - one->from) * share * share * (3.0 - 2.0 * share);
    return share < 1.0 || one->now < before || one->now > before;
}

bool expressions_update(expressions *self, double dt_s)
{
    if (!self->is_wanted || !app_live(self->of))
        return false;
    const bool is_other = follow_face(self);
    bool is_fading = false;
    for (uint32_t i = 0; i < self->count; ++i)
        is_fading |= fade(&self->item[i], dt_s);
    self->still_s = is_fading ? 0.0 : self->still_s + dt_s;
    if (is_fading || self->is_moving)
        app_want_frame(self->of, 0.0);
    if (self->feed && (is_fading || (self->is_moving && self->still_s > settle_s)))
        give(self, is_fading ? FEED_MOVES : FEED_RESTS);
    return is_other;
}

/* ---- for others ---- */

void expressions_connect(const expressions *self, patch *p)
{
    for (uint32_t i = 0; i < self->count && p->count < PATCH_CONNECTIONS_MAX; ++i) {
        patch_connection *to = &p->connection[p->count++];
        *to = patch_connection_of(PATCH_POSE);
        (void)snprintf(to->input, sizeof to->input, "%s", INPUT_NAME);
        (void)snprintf(to->channel, sizeof to->channel, "%s", self->item[i].name);
        (void)snprintf(to->target, sizeof to->target, "%s", self->item[i].name);
        to->in[0] = to->out[0] = 0.0;
        to->in[1] = to->out[1] = 1.0;
        to->smooth_s = smooth_s;
        to->adds = true;
        to->picks_up = false;
    }
}

static void say_names(const expressions *self, char *out, size_t capacity)
{
    size_t used = 0;
    out[0] = '\0';
    for (uint32_t i = 0; i < self->count && used < capacity; ++i)
        used += (size_t)snprintf(out + used, capacity - used, "%s%s", i ? ", " : "",
                                 self->item[i].name);
}

static void begin(expression *one, double to, double fade_s)
{
    one->from = one->now;
    one->to = to;
    one->at_s = 0.0;
    one->fade_s = fade_s;
}

void expressions_release(expressions *self, double fade_s)
{
    for (uint32_t i = 0; i < self->count; ++i)
        if (self->item[i].to > 0.0)
            begin(&self->item[i], 0.0, fade_s);
}

mrt_result expressions_set(expressions *self, const char *name, double amount, double fade_s,
                           error *err)
{
    for (uint32_t i = 0; i < self->count; ++i)
        if (strcmp(self->item[i].name, name) == 0) {
            begin(&self->item[i], amount, fade_s);
            return MRT_OK;
        }
    char names[160];
    say_names(self, names, sizeof names);
    return self->count == 0
               ? error_set(err, MRT_ERR_UNSUPPORTED, "the face on the stage has no poses")
               : error_set(err, MRT_ERR_ARGUMENT, "the face has no pose \"%s\"; it has %s", name,
                           names);
}

uint32_t expressions_count(const expressions *self)
{
    return self->count;
}

const char *expressions_name(const expressions *self, uint32_t index)
{
    return self->item[index].name;
}
