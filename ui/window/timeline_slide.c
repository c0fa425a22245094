/* Another take of the slate is laid earlier or later under the chosen one, before it is comped. The
 * take does not change by it, but a person has laid it there: it is a step of undo. */
#include "window/timeline_state.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* TIMELINE_COMPS_MAX: it lies where it was recorded. */
static uint32_t find(const panel *self, int64_t of, int64_t id)
{
    uint32_t i = 0;
    while (i < TIMELINE_COMPS_MAX && (self->slid[i].of != of || self->slid[i].take != id))
        i += 1;
    return i;
}

static void lay(panel *self, const timeline_slid *so)
{
    uint32_t place = find(self, so->of, so->take);
    if (place == TIMELINE_COMPS_MAX) {
        place = self->slid_next;
        self->slid_next = (self->slid_next + 1) % TIMELINE_COMPS_MAX;
    }
    self->slid[place] = *so;
}

int64_t timeline_comp_later_ns(const panel *self, uint32_t index)
{
    const uint32_t found = find(self, self->comps->of, self->comps->take[index].id);
    return found < TIMELINE_COMPS_MAX ? self->slid[found].later_ns : 0;
}

void timeline_comp_slide(panel *self, uint32_t index, int64_t later_ns)
{
    lay(self, &(timeline_slid){self->comps->of, self->comps->take[index].id, later_ns});
}

take_layer timeline_comp_lane(const panel *self, uint32_t index)
{
    take_layer out = self->comps->take[index].layer[0];
    out.offset_ns += timeline_comp_later_ns(self, index);
    return out;
}

/* ---- undo ---- */

static void go(panel *self, uint64_t number, bool is_after)
{
    const timeline_slide *step = &self->slide[number % TIMELINE_SLIDES_MAX];
    timeline_slid wanted = step->after;
    if (!is_after)
        wanted.later_ns = step->before_ns;
    /* Where it is seen; a take that is gone has been said to be so. */
    if (studio_take_id(self->studio) != wanted.of &&
        studio_choose_take(self->studio, wanted.of) < 0)
        return;
    self->has_comps = true;
    lay(self, &wanted);
}

static void undo(void *owner, uint64_t number)
{
    go(owner, number, false);
}

static void redo(void *owner, uint64_t number)
{
    go(owner, number, true);
}

void timeline_slide_note(panel *self, uint32_t index, int64_t before_ns)
{
    const take *other = &self->comps->take[index];
    const int64_t after_ns = timeline_comp_later_ns(self, index);
    if (after_ns == before_ns)
        return;
    studio_step step = {.owner = self, .undo = undo, .redo = redo, .number = self->slide_count};
    (void)snprintf(step.words, sizeof step.words, "take %u laid at %+.2f s", other->number,
                   1e-9 * (double)after_ns);
    self->slide[self->slide_count % TIMELINE_SLIDES_MAX] =
        (timeline_slide){{self->comps->of, other->id, after_ns}, before_ns};
    self->slide_count += 1;
    studio_did(self->studio, &step);
}

/* ---- whose takes they are ---- */

/* The ids are of the takes of one show. */
void timeline_slide_follow(panel *self, const char *show_path)
{
    if (self->slid_show && strcmp(self->slid_show, show_path) == 0)
        return;
    timeline_slide_finish(self);
    self->slid_show = strdup(show_path);
    memset(self->slid, 0, sizeof self->slid);
}

void timeline_slide_finish(panel *self)
{
    studio_forget_steps(self->studio, self);
    free(self->slid_show);
    self->slid_show = NULL;
}
