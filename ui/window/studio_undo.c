/* Undo over everything that is done in the window: edits of takes, which are kept in the show, and
 * the steps of panels. When those of this run are used up it goes on with the chosen take's own. */
#include "window/studio_state.h"

#include <stdio.h>
#include <string.h>

static void drop(studio *self, uint32_t index)
{
    memmove(&self->done[index], &self->done[index + 1],
            (self->all_count - index - 1) * sizeof self->done[0]);
    self->all_count -= 1;
    if (index < self->done_count)
        self->done_count -= 1;
}

static void put(studio *self, const studio_done *step)
{
    self->all_count = self->done_count;
    if (self->done_count == STUDIO_UNDO_MAX)
        drop(self, 0);
    self->done[self->done_count++] = *step;
    self->all_count = self->done_count;
}

/* ---- steps of takes ---- */

/* An edit that is made after an undo abandons the edits behind it: no step leads there any more. */
static void forget_abandoned(studio *self, int64_t id, int64_t head)
{
    for (uint32_t i = self->all_count; i > 0; --i) {
        const studio_done *step = &self->done[i - 1];
        if (step->take == id && (step->head_before > head || step->head_after > head))
            drop(self, i - 1);
    }
}

static studio_done step_of(const studio *self, int64_t before, int64_t after)
{
    studio_done out = {.take = self->chosen, .head_before = before, .head_after = after};
    const int64_t told = after > before ? after : before;
    (void)snprintf(out.words, sizeof out.words, "%s", history_words(self->history, told));
    return out;
}

void studio_undo_note_take(studio *self, int64_t head_before)
{
    const int64_t head = history_head(self->history);
    const studio_done step = step_of(self, head_before, head);
    if (head > head_before)
        forget_abandoned(self, self->chosen, head_before);
    put(self, &step);
}

void studio_undo_note_copy(studio *self, int64_t of, const char *words)
{
    studio_done step = {.take = self->chosen, .head_after = 1, .copied_from = of};
    (void)snprintf(step.words, sizeof step.words, "%s", words);
    put(self, &step);
}

/* Brings the step's take to an edit; it is chosen then. */
static mrt_result go(studio *self, const studio_done *step, int64_t head)
{
    error err = {0};
    mrt_result result = MRT_OK;
    if (step->take != self->chosen)
        result = studio_choose_take(self, step->take);
    if (result < 0)
        return result;
    result = history_go(self->history, head, &err);
    studio_take_changed(self);
    if (result >= 0 && step->copied_from && head == step->head_before)
        result = studio_choose_instead(self, step->copied_from);
    return studio_said(self, result, &err);
}

/* ---- steps of others ---- */

void studio_did(studio *self, const studio_step *step)
{
    studio_done one = {.step = *step};
    (void)snprintf(one.words, sizeof one.words, "%s", step->words);
    put(self, &one);
}

void studio_forget_steps(studio *self, const void *owner)
{
    for (uint32_t i = self->all_count; i > 0; --i) {
        const studio_done *step = &self->done[i - 1];
        if (owner ? step->take == 0 && step->step.owner == owner : step->take != 0)
            drop(self, i - 1);
    }
}

/* ---- back and forth ---- */

/* Of the chosen take, made before this run. */
static bool has_older(const studio *self)
{
    return self->done_count == 0 && self->history && history_head(self->history) > 0 &&
           show_is_writable(self->show);
}

static bool has_newer(const studio *self)
{
    return self->done_count == self->all_count && self->history &&
           history_head(self->history) < history_last(self->history) &&
           show_is_writable(self->show);
}

bool studio_can_undo(const studio *self)
{
    return self->done_count > 0 || has_older(self);
}

bool studio_can_redo(const studio *self)
{
    return self->done_count < self->all_count || has_newer(self);
}

/* As if it had been done in this run. */
static mrt_result undo_older(studio *self)
{
    const int64_t head = history_head(self->history);
    const studio_done step = step_of(self, head - 1, head);
    mrt_result result = go(self, &step, head - 1);
    if (result < 0)
        return result;
    if (self->all_count == STUDIO_UNDO_MAX)
        self->all_count -= 1;
    memmove(&self->done[1], &self->done[0], self->all_count * sizeof self->done[0]);
    self->done[0] = step;
    self->all_count += 1;
    return MRT_OK;
}

mrt_result studio_undo(studio *self)
{
    if (has_older(self))
        return undo_older(self);
    if (self->done_count == 0)
        return MRT_END;
    const studio_done step = self->done[self->done_count - 1];
    self->done_count -= 1;
    if (step.take)
        return go(self, &step, step.head_before);
    step.step.undo(step.step.owner, step.step.number);
    return MRT_OK;
}

mrt_result studio_redo(studio *self)
{
    if (has_newer(self)) {
        const int64_t head = history_head(self->history);
        const studio_done step = step_of(self, head, head + 1);
        mrt_result result = go(self, &step, head + 1);
        if (result >= 0)
            put(self, &step);
        return result;
    }
    if (self->done_count == self->all_count)
        return MRT_END;
    const studio_done step = self->done[self->done_count];
    self->done_count += 1;
    if (step.take)
        return go(self, &step, step.head_after);
    step.step.redo(step.step.owner, step.step.number);
    return MRT_OK;
}

const char *studio_undo_words(const studio *self)
{
    if (self->done_count > 0)
        return self->done[self->done_count - 1].words;
    return has_older(self) ? history_words(self->history, history_head(self->history)) : "";
}

const char *studio_redo_words(const studio *self)
{
    if (self->done_count < self->all_count)
        return self->done[self->done_count].words;
    return has_newer(self) ? history_words(self->history, history_head(self->history) + 1) : "";
}
