/* Recording: what begins and ends it, and what becomes of what was performed over a take. */
#include "window/studio_state.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#define OVER_FADE_NS 100000000LL
#define KEEP_S       30.0

/* ---- begin and end ---- */

static void begin_live(studio *self)
{
    error err = {0};
    (void)studio_said(self, live_record(self->live, NULL, &err), &err);
}

/* A layer that is armed gets what was performed between the ends of the range, or from the play
 * head to the take's end; else a layer of its own does. */
static void begin_over(studio *self)
{
    error err = {0};
    const transport *t = live_transport(self->live);
    const take *chosen = studio_take(self);
    live_over over = {.in_ns = live_place(self->live).at_ns, .passes = 1, .fade_ns = OVER_FADE_NS};
    if (t->is_looping) {
        over.in_ns = t->loop_in_ns;
        over.out_ns = t->loop_out_ns;
        over.passes = self->choice.armed ? 1 : 0;
    }
    over.into_layer = self->choice.armed;
    if (over.into_layer && over.out_ns == 0 && chosen)
        over.out_ns = chosen->duration_ns;
    if (over.out_ns > 0 && 2 * over.fade_ns > over.out_ns - over.in_ns)
        over.fade_ns = (over.out_ns - over.in_ns) / 2;
    self->over_take = live_shown_take(self->live);
    if (studio_said(self, live_record_over(self->live, &over, &err), &err) < 0)
        self->over_take = 0;
}

void studio_record_toggle(studio *self)
{
    error err = {0};
    live_status_of(self->live, &self->status);
    if (self->status.is_recording)
        (void)studio_said(self, live_record_end(self->live, &err), &err);
    else if (self->view->mode == LIVE_PERFORMS || !live_shown_take(self->live))
        begin_live(self);
    else
        begin_over(self);
    self->takes_are_stale = true;
}

void studio_keep(studio *self)
{
    error err = {0};
    int64_t kept = 0;
    if (studio_said(self, live_keep(self->live, KEEP_S, NULL, &kept, &err), &err) >= 0)
        studio_await_take(self, kept, true);
}

void studio_tell_kept(studio *self, int64_t id)
{
    const studio_take_line *line = studio_line_of(self, id);
    if (line)
        studio_say(self, MRT_LOG_INFO, "kept the last %.1f s as take %s",
                   1e-9 * (double)line->duration_ns, line->title);
}

void studio_mark(studio *self)
{
    error err = {0};
    if (self->view->mode == LIVE_PERFORMS) {
        if (studio_said(self, live_mark(self->live, "", &err), &err) >= 0)
            studio_say(self, MRT_LOG_INFO, "marked this instant");
        return;
    }
    edit e;
    edit_init(&e, EDIT_MARKER_ADD);
    e.at_ns = live_place(self->live).at_ns;
    studio_heard(studio_edit(self, &e));
    edit_finish(&e);
}

/* ---- what has ended ---- */

/* The edits that make it a part of the take are one step of undo. */
static void take_over(studio *self)
{
    edit *edits = NULL;
    uint32_t count = 0;
    error err = {0};
    if (!live_take_over(self->live, &edits, &count, &err)) {
        if (!err.text[0])
            return; /* it goes on */
        self->over_take = 0;
        self->takes_are_stale = true;
        (void)studio_said(self, MRT_ERR_IO, &err);
        return;
    }
    const edit **list = calloc(count ? count : 1, sizeof *list);
    for (uint32_t i = 0; list && i < count; ++i)
        list[i] = &edits[i];
    if (list && studio_pick_take(self, self->over_take) >= 0)
        studio_heard(studio_edit_all(self, list, count));
    else if (!list)
        studio_say(self, MRT_LOG_ERROR, "no memory: what was performed is a take of its own");
    for (uint32_t i = 0; i < count; ++i)
        edit_finish(&edits[i]);
    free(edits);
    free(list);
    self->over_take = 0;
    self->takes_are_stale = true;
}

void studio_record_finish_over(studio *self)
{
    error err = {0};
    if (!self->over_take)
        return;
    live_status_of(self->live, &self->status);
    if (self->status.is_recording)
        (void)studio_said(self, live_record_end(self->live, &err), &err);
    live_status_of(self->live, &self->status);
    take_over(self);
    self->over_take = 0;
}

/* The bar has room for its first words only. */
static void say_problem(studio *self)
{
    const bool has_problem = self->status.problem[0] != '\0';
    if (has_problem && !self->had_problem)
        studio_say(self, MRT_LOG_ERROR, "%s", self->status.problem);
    else if (!has_problem && self->had_problem)
        studio_say(self, MRT_LOG_INFO, "all that is performed is recorded again");
    self->had_problem = has_problem;
}

/* Said in a terminal too: the window may be gone. */
void studio_close_show(studio *self, show *of)
{
    char path[4096];
    error err = {0};
    const mrt_result result = of ? show_rescue_beside(of, path, sizeof path, &err) : MRT_END;
    if (result < 0)
        studio_say(self, MRT_LOG_ERROR, "%s was deleted, moved or replaced, and is lost: %s",
                   show_path(of), err.text);
    else if (result != MRT_END)
        studio_say(self, MRT_LOG_WARNING, "%s was deleted, moved or replaced: all of it is in %s",
                   show_path(of), path);
    if (result != MRT_END)
        fprintf(stderr, "marotte: %s\n",
                news_list_at(self->news, news_list_count(self->news) - 1)->text);
    show_close(of);
}

void studio_record_update(studio *self)
{
    say_problem(self);
    const bool has_ended = self->was_recording && !self->status.is_recording;
    if (self->was_recording != self->status.is_recording)
        self->takes_are_stale = true;
    self->was_recording = self->status.is_recording;
    if (self->over_take)
        take_over(self);
    else if (has_ended && self->status.take)
        studio_await_take(self, self->status.take, false);
}
