/* Takes: their list, the selected take, its edits with undo and redo, the transport, recording. */
#include "window/app/app_shared.h"

#include "base/clock.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- the list ---- */

static mrt_result make_room(app *self, size_t count, error *err)
{
    if (count <= self->takes.line_room)
        return MRT_OK;
    const size_t room = count + 32;
    app_take_line *line = realloc(self->takes.line, room * sizeof *line);
    if (line)
        self->takes.line = line;
    app_take_key *key = realloc(self->takes.key, room * sizeof *key);
    if (key)
        self->takes.key = key;
    if (!line || !key)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the list of takes");
    self->takes.line_room = (uint32_t)room;
    return MRT_OK;
}

static void fill_line(app_take_line *out, const take *t)
{
    *out = (app_take_line){.id = t->id,
                           .rating = t->rating,
                           .duration_ns = t->duration_ns,
                           .created_ns = t->created_ns,
                           .is_recording = t->is_recording,
                           .is_deleted = t->is_deleted};
    (void)snprintf(out->title, sizeof out->title, "%s%s%s%s%u%s%s", t->scene,
                   t->scene[0] ? "/" : "", t->shot, t->shot[0] ? "/" : "", t->number,
                   t->name[0] ? " " : "", t->name);
    (void)snprintf(out->note, sizeof out->note, "%s", t->note);
    (void)snprintf(out->scene, sizeof out->scene, "%s", t->scene);
    (void)snprintf(out->shot, sizeof out->shot, "%s", t->shot);
    (void)snprintf(out->name, sizeof out->name, "%s", t->name);
    out->number = t->number;
}

/* Shows a take with unknown edits as far as possible. Returns whether all edits could be read;
 * reports a failure once. */
static bool fold_line(app *self, app_take_line *out, const show_take *row, bool was_told)
{
    take t = {0};
    error err = {0};
    const bool is_read = edit_store_take(&t, self->show, row->id, &err) >= 0;
    if (!is_read && !was_told)
        log_pushf(self->log, MRT_LOG_WARNING, "takes", "take %lld: %s", (long long)row->id,
                  err.text);
    if (t.id == row->id)
        fill_line(out, &t);
    else
        *out = (app_take_line){.id = row->id, .title = "damaged"};
    out->over = row->over;
    out->over_at_ns = row->over_at_ns;
    take_finish(&t);
    return is_read;
}

static bool is_as_before(const app *self, uint32_t index, const show_take *row)
{
    const app_take_key *key = &self->takes.key[index];
    return index < self->takes.line_count && self->takes.line[index].id == row->id &&
           !key->is_stale && key->edit_head == row->edit_head &&
           key->edit_count == row->edit_count && key->is_recording == row->is_recording &&
           !row->is_recording;
}

static void read_list(app *self)
{
    show_take *rows = NULL;
    size_t count = 0;
    error err = {0};
    mrt_result result = show_takes(self->show, &rows, &count, &err);
    if (result >= 0)
        result = make_room(self, count, &err);
    if (result < 0 && !self->takes.has_failed)
        (void)app_report(self, result, &err);
    self->takes.has_failed = result < 0;
    if (result < 0) {
        free(rows);
        return;
    }
    for (uint32_t i = 0; i < (uint32_t)count; ++i) {
        if (is_as_before(self, i, &rows[i]))
            continue;
        const bool was_told = i < self->takes.line_count && self->takes.line[i].id == rows[i].id &&
                              self->takes.key[i].is_told;
        const bool is_read = fold_line(self, &self->takes.line[i], &rows[i], was_told);
        self->takes.key[i] = (app_take_key){.edit_head = rows[i].edit_head,
                                            .edit_count = rows[i].edit_count,
                                            .is_recording = rows[i].is_recording,
                                            .is_told = !is_read};
    }
    self->takes.line_count = (uint32_t)count;
    free(rows);
}

static const app_take_line *line_of(const app *self, int64_t id)
{
    for (uint32_t i = 0; i < self->takes.line_count; ++i)
        if (self->takes.line[i].id == id)
            return &self->takes.line[i];
    return NULL;
}

uint32_t app_takes(const app *self, const app_take_line **out)
{
    *out = self->takes.line;
    return self->takes.line_count;
}

static void line_is_stale(app *self, int64_t id)
{
    for (uint32_t i = 0; i < self->takes.line_count; ++i)
        if (self->takes.line[i].id == id)
            self->takes.key[i].is_stale = true;
    self->takes.are_stale = true;
}

/* ---- the one that is chosen ---- */

static void end_preview(app *self)
{
    take_finish(&self->takes.preview);
    self->takes.has_pending_preview = self->takes.is_previewed = false;
}

void app_drop_take(app *self)
{
    history_close(self->takes.history);
    edit_store_close(self->takes.store);
    self->takes.history = NULL;
    self->takes.store = NULL;
    self->takes.chosen = 0;
    self->takes.choice = (app_choice){.marker = -1};
    self->takes.edition += 1;
    end_preview(self);
}

mrt_result app_pick_take(app *self, int64_t id)
{
    error err = {0};
    if (id == self->takes.chosen)
        return MRT_OK;
    app_drop_take(self);
    if (id == 0)
        return MRT_OK;
    if (!self->show)
        return app_report(self, error_set(&err, MRT_ERR_ARGUMENT, "no show is open"), &err);
    mrt_result result = edit_store_open(&self->takes.store, self->show, id, clock_utc_ms, &err);
    if (result >= 0) {
        const history_store list = edit_store_list(self->takes.store);
        result =
            history_open(&self->takes.history, edit_store_bare(self->takes.store), &list, &err);
    }
    if (result < 0) {
        app_drop_take(self);
        return app_report(self, result, &err);
    }
    self->takes.chosen = id;
    return MRT_OK;
}

void app_keep_range(app *self)
{
    const int64_t shown = live_shown_take(self->live);
    const transport *t = live_transport(self->live);
    if (!shown || !self->show)
        return;
    settings_set_text(self->settings, "range.show", show_path(self->show));
    settings_set_number(self->settings, "range.take", (double)shown);
    settings_set_number(self->settings, "range.in_ns", t->is_looping ? (double)t->loop_in_ns : 0.0);
    settings_set_number(self->settings, "range.out_ns",
                        t->is_looping ? (double)t->loop_out_ns : 0.0);
}

/* Restores the loop range that the previous run saved, if its take is the chosen one. */
static void recall_range(app *self)
{
    const int64_t of = (int64_t)settings_number(self->settings, "range.take", 0.0);
    if (self->takes.ranged || of != self->takes.chosen ||
        strcmp(settings_text(self->settings, "range.show", ""), show_path(self->show)) != 0)
        return;
    self->takes.ranged = of;
    const int64_t in_ns = (int64_t)settings_number(self->settings, "range.in_ns", 0.0);
    const int64_t out_ns = (int64_t)settings_number(self->settings, "range.out_ns", 0.0);
    if (in_ns >= 0 && in_ns < out_ns && out_ns <= history_take(self->takes.history)->duration_ns)
        live_set_loop(self->live, in_ns, out_ns);
}

static mrt_result show_chosen(app *self)
{
    error err = {0};
    end_preview(self);
    if (!self->takes.history)
        return MRT_OK;
    mrt_result result = live_show_take(self->live, history_take(self->takes.history), &err);
    if (result >= 0)
        recall_range(self);
    return app_report(self, result, &err);
}

/* ---- the version of an edit that is dragged ---- */

/* Tries again in the next frame if the stage is still on its way to the last version. */
static void show_preview(app *self)
{
    error err = {0};
    const take *t = self->takes.preview.id ? &self->takes.preview : app_take(self);
    if (!self->takes.has_pending_preview)
        return;
    if (!app_is_take_shown(self) || self->status.is_recording) {
        end_preview(self);
        return;
    }
    const mrt_result result = live_preview_take(self->live, t, &err);
    self->takes.has_pending_preview = result == MRT_HOLD;
    if (result == MRT_HOLD)
        app_want_frame(self, 0.0);
    else
        self->takes.is_previewed = self->takes.preview.id != 0;
    (void)app_report(self, result, &err);
}

void app_preview_take(app *self, const take *t)
{
    error err = {0};
    take copy = {0};
    if (!t && !self->takes.is_previewed && !self->takes.has_pending_preview)
        return;
    if (t && take_copy(&copy, t, &err) < 0) {
        (void)app_report(self, MRT_ERR_MEMORY, &err);
        return;
    }
    take_finish(&self->takes.preview);
    self->takes.preview = copy;
    self->takes.has_pending_preview = true;
    show_preview(self);
}

mrt_result app_choose_take(app *self, int64_t id)
{
    mrt_result result = app_pick_take(self, id);
    if (result < 0)
        return result;
    if (id == 0) {
        live_show_hands(self->live);
        return MRT_OK;
    }
    if (live_shown_take(self->live) == id)
        return MRT_OK;
    self->recording.played_from_ns = 0;
    return show_chosen(self);
}

bool app_is_take_shown(const app *self)
{
    return self->takes.chosen && live_shown_take(self->live) == self->takes.chosen;
}

mrt_result app_select_take(app *self, int64_t id)
{
    return app_is_take_shown(self) ? app_choose_take(self, id) : app_pick_take(self, id);
}

/* Of the chosen take. */
static int64_t head_ns(const app *self)
{
    return app_is_take_shown(self) ? live_position(self->live).at_ns : 0;
}

int64_t app_take_id(const app *self)
{
    return self->takes.chosen;
}

const take *app_take(const app *self)
{
    return self->takes.history ? history_take(self->takes.history) : NULL;
}

uint64_t app_take_edition(const app *self)
{
    return self->takes.edition;
}

const history *app_history(const app *self)
{
    return self->takes.history;
}

/* What is chosen in it may be gone. */
static void check_choice(app *self)
{
    const take *t = app_take(self);
    bool has_layer = false, has_clip = false, has_armed = false;
    for (uint32_t i = 0; t && i < t->layer_count; ++i) {
        has_layer |= t->layer[i].id == self->takes.choice.layer;
        has_armed |= t->layer[i].id == self->takes.choice.armed;
        for (uint32_t k = 0; k < t->layer[i].clip_count; ++k)
            has_clip |= t->layer[i].clip[k].id == self->takes.choice.clip;
    }
    if (!has_layer)
        self->takes.choice.layer = 0;
    if (!has_clip)
        self->takes.choice.clip = 0;
    if (!has_armed)
        self->takes.choice.armed = 0;
    if (!t || self->takes.choice.marker >= (int32_t)t->marker_count)
        self->takes.choice.marker = -1;
}

/* After each change of the chosen take: the list and the stage follow. */
static void take_changed(app *self)
{
    self->takes.edition += 1;
    check_choice(self);
    line_is_stale(self, self->takes.chosen);
    if (live_shown_take(self->live) == self->takes.chosen)
        app_reported(show_chosen(self));
}

/* ---- in each frame: results of the recorder and the stage ---- */

#define AWAITED_S 10.0

/* Updates the line of the take that is being recorded. For some frames after an overdub has begun
 * the status still names the take before it, which is whole and keeps its length. */
static void follow_recording(app *self)
{
    for (uint32_t i = self->takes.line_count; i > 0; --i)
        if (self->takes.line[i - 1].id == self->status.take &&
            self->takes.key[i - 1].is_recording) {
            self->takes.line[i - 1].is_recording = self->status.is_recording;
            if (self->status.is_recording)
                self->takes.line[i - 1].duration_ns = self->status.recorded_ns;
            break;
        }
}

/* A take has begun that is not in the list yet: the writer has still to store it. */
static bool lacks_recording(const app *self)
{
    return self->status.is_recording && self->status.take && !line_of(self, self->status.take);
}

/* Chooses the take in the list as soon as all of it is stored. */
static void await_take(app *self, int64_t id, bool is_kept)
{
    self->awaited.take = id;
    self->awaited.is_kept = is_kept;
    self->awaited.age_s = 0.0;
}

static bool is_whole(const app *self, int64_t id)
{
    for (uint32_t i = 0; i < self->takes.line_count; ++i)
        if (self->takes.line[i].id == id)
            return !self->takes.key[i].is_recording;
    return false;
}

static void tell_kept(app *self, int64_t id)
{
    const app_take_line *line = line_of(self, id);
    if (line)
        app_say(self, MRT_LOG_INFO, "kept %.1f s as take %s", 1e-9 * (double)line->duration_ns,
                line->title);
}

/* Adds the marks that were set during the take as its markers, in one undo step. */
static void add_marks(app *self, int64_t id)
{
    error err = {0};
    edit *mark = NULL;
    uint32_t count = 0;
    const int64_t before = self->takes.chosen;
    if (app_pick_take(self, id) < 0)
        return;
    if (app_report(self, edit_store_marks(self->show, app_take(self), &mark, &count, &err), &err) >=
            0 &&
        count > 0) {
        const edit **list = calloc(count, sizeof *list);
        for (uint32_t i = 0; list && i < count; ++i)
            list[i] = &mark[i];
        if (list)
            app_reported(app_edit_all(self, list, count));
        free(list);
    }
    free(mark);
    if (self->view->mode != LIVE_PERFORMS) /* another take is on the stage */
        app_reported(app_pick_take(self, before));
}

/* If the disk is full, the take is stored when there is space, and appears in the list then. */
static void follow_awaited(app *self, double dt_s)
{
    const int64_t id = self->awaited.take;
    self->awaited.age_s += dt_s;
    if (is_whole(self, id)) {
        self->awaited.take = 0;
        add_marks(self, id);
        if (self->awaited.is_kept)
            tell_kept(self, id);
    } else if (self->awaited.age_s > AWAITED_S) {
        self->awaited.take = 0;
        app_say(self, MRT_LOG_WARNING, "the take is not in the show yet, because the disk is slow");
    }
}

/* The stage has edited a take itself: it attached the sound that was recorded with it. */
static void follow_stage_edit(app *self)
{
    const int64_t id = live_take_edited(self->live);
    const app_choice choice = self->takes.choice;
    if (id == 0)
        return;
    line_is_stale(self, id);
    if (id != self->takes.chosen)
        return;
    app_drop_take(self); /* it is read anew */
    if (app_pick_take(self, id) < 0)
        return;
    self->takes.choice = choice;
    if (live_shown_take(self->live) == id)
        app_reported(show_chosen(self));
}

/* Tells once, for each take that is put on the stage, how it differs from what was recorded. */
static void tell_note(app *self)
{
    const int64_t shown = live_shown_take(self->live);
    if (shown == self->takes.noted)
        return;
    self->takes.noted = shown;
    for (const char *line = live_take_note(self->live); shown && *line;) {
        const size_t length = strcspn(line, "\n");
        app_say(self, MRT_LOG_WARNING, "%.*s", (int)length, line);
        line += length + (line[length] == '\n');
    }
}

void app_takes_update(app *self, double dt_s)
{
    self->recording.over_ended_s -= dt_s;
    follow_stage_edit(self);
    show_preview(self);
    tell_note(self);
    if (self->takes.are_stale || self->awaited.take || lacks_recording(self)) {
        self->takes.are_stale = false;
        if (self->show)
            read_list(self);
        else
            self->takes.line_count = 0;
    }
    if (self->awaited.take)
        follow_awaited(self, dt_s);
    if (self->status.take)
        follow_recording(self);
}

/* ---- undo: edits of takes, which are stored in the show, and the changes of panels ---- */

/* The value of a change of a take. */
typedef struct take_value {
    int64_t take;
    int64_t head;        /* position in its history */
    int64_t selected;    /* the selected take when it was edited */
    int64_t copied_from; /* the change created the take as a copy of this one; 0: it did not */
} take_value;

static mrt_result set_take(void *owner, const void *value);

/* Returns the value if the change is one of a take, else NULL. Both values differ in `head` only.
 */
static const take_value *take_of(const undo_change *of)
{
    return of && of->set == set_take ? of->after : NULL;
}

size_t app_undo_bytes(const app *self)
{
    return undo_list_bytes(self->undo.list);
}

static bool is_of_take(const undo_change *of, const void *data)
{
    (void)data;
    return of->set == set_take;
}

void app_forget_takes(app *self)
{
    undo_list_forget_if(self->undo.list, self, is_of_take, NULL);
}

static bool is_pull(const undo_change *of, const void *data)
{
    (void)data;
    return of->set != set_take;
}

void app_forget_pulled(app *self)
{
    undo_list_forget_if(self->undo.list, self, is_pull, NULL);
}

void app_add_change(app *self, const undo_change *change)
{
    undo_list_add(self->undo.list, change);
}

void app_forget_changes(app *self, const void *owner)
{
    undo_list_forget(self->undo.list, owner);
}

/* ---- changes of takes ---- */

/* An edit after an undo discards the edits that were undone. */
static bool is_abandoned(const undo_change *of, const void *data)
{
    const take_value *head = data, *before = of->before, *after = take_of(of);
    return after && after->take == head->take &&
           (before->head > head->head || after->head > head->head);
}

/* Describes the change of the selected take from one position in its history to another. Returns
 * false without memory: it cannot be undone by this list, only by the history of the take. */
static bool change_of(const app *self, int64_t before, int64_t after, int64_t copied_from,
                      const char *words, undo_change *out)
{
    const take_value value[2] = {{self->takes.chosen, before, self->takes.chosen, copied_from},
                                 {self->takes.chosen, after, self->takes.chosen, copied_from}};
    *out = (undo_change){.owner = (void *)(uintptr_t)self, .set = set_take};
    (void)snprintf(out->words, sizeof out->words, "%s", words);
    return undo_change_copy(out, &value[0], &value[1], sizeof value[0]);
}

static const char *words_between(const app *self, int64_t before, int64_t after)
{
    return history_words(self->takes.history, after > before ? after : before);
}

/* `words` NULL: those of the last edit. */
static void note_edits(app *self, int64_t head_before, const char *words)
{
    const int64_t head = history_head(self->takes.history);
    const take_value abandoned = {.take = self->takes.chosen, .head = head_before};
    undo_change made;
    if (head > head_before)
        undo_list_forget_if(self->undo.list, self, is_abandoned, &abandoned);
    if (change_of(self, head_before, head, 0,
                  words ? words : words_between(self, head_before, head), &made))
        undo_list_add(self->undo.list, &made);
}

/* The change belongs to a take that is not the selected one: the user would not see its effect. */
static bool is_elsewhere(const app *self, const undo_change *of)
{
    const take_value *value = take_of(of);
    return value && self->takes.chosen && value->take != self->takes.chosen &&
           value->selected != self->takes.chosen && value->copied_from != self->takes.chosen;
}

/* Shows the take of a change that is elsewhere, and changes nothing: the next undo or redo does. */
static mrt_result show_take_of(app *self, const undo_change *of, const char *what)
{
    char words[EDIT_TEXT];
    const int64_t id = take_of(of)->take;
    (void)snprintf(words, sizeof words, "%s", of->words);
    mrt_result result = app_choose_take(self, id);
    const app_take_line *line = line_of(self, id);
    if (result >= 0)
        app_say(self, MRT_LOG_INFO, "take %s is shown again. Press once more to %s %s",
                line ? line->title : "", what, words);
    return result;
}

/* Selects the take and sets the position in its history. The copy that a change created has no
 * edits when the change is undone: its original is selected then. */
static mrt_result set_take(void *owner, const void *of)
{
    app *self = owner;
    const take_value value = *(const take_value *)of;
    error err = {0};
    mrt_result result = MRT_OK;
    if (value.take != self->takes.chosen)
        result = app_choose_take(self, value.take);
    if (result < 0)
        return result;
    result = history_go(self->takes.history, value.head, &err);
    take_changed(self);
    if (result >= 0 && value.copied_from && value.head == 0)
        result = app_select_take(self, value.copied_from);
    return app_report(self, result, &err);
}

/* ---- undo and redo ---- */

/* The selected take has edits that were made before this run. */
static bool has_older(const app *self)
{
    return !undo_list_next(self->undo.list) && self->takes.history &&
           history_head(self->takes.history) > 0 && show_is_writable(self->show);
}

static bool has_newer(const app *self)
{
    return !undo_list_next_redo(self->undo.list) && self->takes.history &&
           history_head(self->takes.history) < history_last(self->takes.history) &&
           show_is_writable(self->show);
}

void app_undo_update(app *self)
{
    const bool is_shown = self->looks.layouts.now.current == APP_RIG;
    const undo_change *newest = undo_list_next(self->undo.list);
    if (is_shown && !self->undo.is_rig_shown)
        self->undo.rig_number = newest ? newest->number : 0;
    self->undo.is_rig_shown = is_shown;
}

/* While the rig panel is open, undo stops at edits of takes that were made before it was opened:
 * the user works on the rig and does not see takes. */
static bool is_behind_rig(const app *self)
{
    const undo_change *newest = undo_list_next(self->undo.list);
    return self->looks.layouts.now.current == APP_RIG && (!newest || take_of(newest)) &&
           (!self->undo.is_rig_shown || !newest || newest->number <= self->undo.rig_number);
}

/* Why a pull of the live face cannot be undone now: a take is shown, or one is being recorded. */
static const char *why_not_pulled(const app *self, const undo_change *of)
{
    if (!of || of->owner != self || take_of(of))
        return NULL;
    if (self->notes.is_rig_pending)
        return "the next step is a pull. Wait until the rig is ready";
    if (self->status.is_recording)
        return "the next step is a pull. Stop the recording first";
    return live_shown_take(self->live)
               ? "the next step is a pull of the live face. Press L to go back to it"
               : NULL;
}

const char *app_undo_why_not(const app *self)
{
    const undo_change *next = undo_list_next(self->undo.list);
    if (!next && !has_older(self))
        return "nothing to undo";
    const char *why = why_not_pulled(self, next);
    if (why)
        return why;
    return is_behind_rig(self)
               ? "the next step is an edit of a take. Leave the panel Rig to continue"
               : NULL;
}

bool app_can_redo(const app *self)
{
    const undo_change *next = undo_list_next_redo(self->undo.list);
    return next ? !why_not_pulled(self, next) : has_newer(self);
}

/* Sets a position in the history of the selected take, one edit before or after the current one,
 * as a change that this run did not make. */
static mrt_result go_in_history(app *self, int64_t before, int64_t after, int64_t to,
                                void add(undo_list *self, const undo_change *change))
{
    undo_change made;
    error err = {0};
    if (!change_of(self, before, after, 0, words_between(self, before, after), &made))
        return app_report(self, error_set(&err, MRT_ERR_MEMORY, "no memory for undo"), &err);
    mrt_result result = set_take(self, to == before ? made.before : made.after);
    if (result >= 0) {
        add(self->undo.list, &made);
    } else {
        free(made.before);
        free(made.after);
    }
    return result;
}

mrt_result app_undo(app *self)
{
    char words[EDIT_TEXT];
    undo_change *next = undo_list_next(self->undo.list);
    if (app_undo_why_not(self))
        return MRT_END;
    if (is_elsewhere(self, next))
        return show_take_of(self, next, "undo");
    (void)snprintf(words, sizeof words, "%s", app_undo_words(self));
    const int64_t head = self->takes.history ? history_head(self->takes.history) : 0;
    if (next && !next->after)
        app_save_pulled(self, next);
    const mrt_result result =
        next ? undo_list_undo(self->undo.list)
             : go_in_history(self, head - 1, head, head - 1, undo_list_add_undone);
    if (result >= 0)
        app_say(self, MRT_LOG_INFO, "undone: %s", words);
    return result;
}

mrt_result app_redo(app *self)
{
    char words[EDIT_TEXT];
    const undo_change *next = undo_list_next_redo(self->undo.list);
    if (!next && !has_newer(self))
        return MRT_END;
    if (is_elsewhere(self, next))
        return show_take_of(self, next, "redo");
    (void)snprintf(words, sizeof words, "%s", app_redo_words(self));
    const int64_t head = self->takes.history ? history_head(self->takes.history) : 0;
    const mrt_result result = next ? undo_list_redo(self->undo.list)
                                   : go_in_history(self, head, head + 1, head + 1, undo_list_add);
    if (result >= 0)
        app_say(self, MRT_LOG_INFO, "redone: %s", words);
    return result;
}

const char *app_undo_words(const app *self)
{
    const undo_change *next = undo_list_next(self->undo.list);
    if (next)
        return next->words;
    return has_older(self) ? history_words(self->takes.history, history_head(self->takes.history))
                           : "";
}

const char *app_redo_words(const app *self)
{
    const undo_change *next = undo_list_next_redo(self->undo.list);
    if (next)
        return next->words;
    return has_newer(self)
               ? history_words(self->takes.history, history_head(self->takes.history) + 1)
               : "";
}

/* ---- its edits ---- */

static mrt_result check_editable(const app *self, error *err)
{
    if (!self->takes.history)
        return error_set(err, MRT_ERR_ARGUMENT, "select the take to change");
    if (!show_is_writable(self->show))
        return error_set(err, MRT_ERR_UNSUPPORTED, "%s",
                         show_notice(self->show)[0] ? show_notice(self->show)
                                                    : "the show is read-only");
    if (self->status.is_recording && self->status.take == self->takes.chosen)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "the take is still being recorded: change it when it has ended");
    return MRT_OK;
}

/* Makes all edits or none. */
mrt_result app_edit_all_as(app *self, const edit *const *e, uint32_t count, const char *words)
{
    error err = {0}, ignored = {0};
    mrt_result result = check_editable(self, &err);
    if (result < 0 || count == 0)
        return app_report(self, result, &err);
    const int64_t before = history_head(self->takes.history);
    for (uint32_t i = 0; i < count && result >= 0; ++i)
        result = history_do(self->takes.history, e[i], &err);
    if (result < 0 && history_go(self->takes.history, before, &ignored) < 0)
        app_say(self, MRT_LOG_ERROR, "%s", ignored.text);
    if (result >= 0)
        note_edits(self, before, words);
    take_changed(self);
    return app_report(self, result, &err);
}

mrt_result app_edit_all(app *self, const edit *const *e, uint32_t count)
{
    return app_edit_all_as(self, e, count, NULL);
}

mrt_result app_edit(app *self, const edit *e)
{
    return app_edit_all(self, &e, 1);
}

mrt_result app_history_go(app *self, int64_t head)
{
    error err = {0};
    mrt_result result = check_editable(self, &err);
    if (result < 0)
        return app_report(self, result, &err);
    const int64_t before = history_head(self->takes.history);
    result = history_go(self->takes.history, head, &err);
    if (result >= 0 && head != before)
        note_edits(self, before, NULL);
    take_changed(self);
    return app_report(self, result, &err);
}

mrt_result app_edit_take(app *self, int64_t id, const edit *e)
{
    const int64_t before = self->takes.chosen;
    const app_choice choice = self->takes.choice;
    if (id == before)
        return app_edit(self, e);
    mrt_result result = app_pick_take(self, id);
    if (result >= 0)
        result = app_edit(self, e);
    const undo_change *made = undo_list_next(self->undo.list);
    if (result >= 0 && take_of(made))
        ((take_value *)made->before)->selected = ((take_value *)made->after)->selected = before;
    if (app_pick_take(self, before) >= 0)
        self->takes.choice = choice;
    return result;
}

mrt_result app_duplicate_take(app *self, int64_t id)
{
    error err = {0};
    int64_t copy = 0;
    char words[EDIT_TEXT];
    const app_take_line *line = line_of(self, id);
    if (!self->show || !line)
        return app_report(self, error_set(&err, MRT_ERR_ARGUMENT, "there is no such take"), &err);
    (void)snprintf(words, sizeof words, "duplicate take %.120s", line->title);
    mrt_result result = edit_store_duplicate(self->show, id, clock_utc_ms, &copy, &err);
    if (result < 0)
        return app_report(self, result, &err);
    self->takes.are_stale = true;
    result = app_select_take(self, copy);
    undo_change made;
    if (result >= 0 && change_of(self, 0, 1, id, words, &made))
        undo_list_add(self->undo.list, &made);
    return result;
}

/* ---- recording, and what becomes of what was performed over a take ---- */

#define OVER_FADE_NS 100000000LL

/* ---- what comes before ---- */

static const double lead_in_most_s = 60.0;
static const char count_in_key[] = "record.count_in_s", preroll_key[] = "record.preroll_s";

static double lead_of(const app *self, const char *key)
{
    return fmin(fmax(settings_number(self->settings, key, 0.0), 0.0), lead_in_most_s);
}

app_lead_in app_lead_in_of(const app *self)
{
    return (app_lead_in){lead_of(self, count_in_key), lead_of(self, preroll_key)};
}

void app_set_lead_in(app *self, app_lead_in to)
{
    settings_set_number(self->settings, count_in_key, to.count_in_s);
    settings_set_number(self->settings, preroll_key, to.preroll_s);
}

live_click app_click(const app *self)
{
    const settings *from = self->settings;
    const double when = settings_number(from, "click.when", 0.0),
                 bar = settings_number(from, "click.bar", 0.0),
                 bpm = settings_number(from, "click.bpm", 0.0);
    return (live_click){.when = when >= 0.0 && when <= LIVE_CLICK_ALWAYS ? (live_click_when)when
                                                                         : LIVE_CLICK_OFF,
                        .bpm = bpm >= LIVE_CLICK_BPM_MIN && bpm <= LIVE_CLICK_BPM_MAX ? bpm : 120.0,
                        .bar = bar >= 1.0 && bar <= LIVE_CLICK_BAR_MAX ? (uint32_t)bar : 4};
}

void app_set_click(app *self, const live_click *to)
{
    error err = {0};
    settings_set_number(self->settings, "click.when", (double)to->when);
    settings_set_number(self->settings, "click.bpm", to->bpm);
    settings_set_number(self->settings, "click.bar", (double)to->bar);
    (void)app_report(self, live_set_click(self->live, to, &err), &err);
}

double app_leads_in_s(const app *self)
{
    const int64_t left_ns =
        self->recording.leads_in_until_ns ? self->recording.leads_in_until_ns - clock_now_ns() : 0;
    return left_ns > 0 ? 1e-9 * (double)left_ns : 0.0;
}

/* Starts the wait before a recording; 0 s ends it. counts_in: a take of the live hands begins after
 * it; false: a recording over a take has begun already, and plays its pre-roll. */
static void lead_in(app *self, double s, bool counts_in)
{
    const bool counted_in = self->recording.counts_in;
    self->recording.leads_in_until_ns = s > 0.0 ? clock_now_ns() + (int64_t)(s * 1e9) : 0;
    self->recording.counts_in = counts_in && self->recording.leads_in_until_ns;
    if (counted_in || self->recording.counts_in)
        live_count_in(self->live,
                      self->recording.counts_in ? self->recording.leads_in_until_ns : 0);
}

/* ---- begin and end ---- */

static void begin_live(app *self)
{
    error err = {0};
    const app_take_line *line = line_of(self, self->takes.chosen);
    if (app_report(self, live_record(self->live, NULL, &err), &err) >= 0 && line)
        app_say(self, MRT_LOG_INFO,
                "recorded as a new take. To perform over take %.120s, double-click it first",
                line->title);
}

/* Records over the take on the stage, between the ends of the range or from the play head to the
 * end: into the armed layer, or into a new one. */
static void begin_over(app *self)
{
    error err = {0};
    if (self->takes.is_previewed && show_chosen(self) < 0)
        return;
    const transport *t = live_transport(self->live);
    const take *chosen = app_take(self);
    overdub_plan over = {
        .in_ns = live_position(self->live).at_ns, .passes = 1, .fade_ns = OVER_FADE_NS};
    if (t->is_looping) {
        over.in_ns = t->loop_in_ns;
        over.out_ns = t->loop_out_ns;
        over.passes = self->takes.choice.armed ? 1 : 0;
    }
    /* At the end of the take, start over from its start, as playback does. */
    if (over.out_ns == 0 && chosen && over.in_ns + OVER_FADE_NS >= chosen->duration_ns)
        over.in_ns = 0;
    over.into_layer = self->takes.choice.armed;
    if (over.into_layer && over.out_ns == 0 && chosen)
        over.out_ns = chosen->duration_ns;
    if (over.out_ns > 0 && 2 * over.fade_ns > over.out_ns - over.in_ns)
        over.fade_ns = (over.out_ns - over.in_ns) / 2;
    const app_lead_in lead = app_lead_in_of(self);
    over.count_in_ns = (int64_t)(lead.count_in_s * 1e9);
    over.preroll_ns = (int64_t)(lead.preroll_s * 1e9);
    self->recording.over_take = live_shown_take(self->live);
    self->recording.over_is_ended = false;
    if (app_report(self, live_overdub_start(self->live, &over, &err), &err) < 0)
        self->recording.over_take = 0;
    else
        lead_in(self, lead.count_in_s + fmin(lead.preroll_s, 1e-9 * (double)over.in_ns), false);
}

#define OVER_ENDED_S 1.5

void app_record_toggle(app *self)
{
    error err = {0};
    live_status_of(self->live, &self->status);
    if (self->recording.counts_in) {
        lead_in(self, 0.0, false);
    } else if (self->status.is_recording) {
        lead_in(self, 0.0, false);
        self->recording.over_is_ended = true;
        (void)app_report(self, live_record_end(self->live, &err), &err);
    } else if (self->recording.over_take || self->recording.over_ended_s > 0.0) {
        /* The user pressed R to end a recording that has just ended by itself. Do not start
         * another. */
        self->recording.over_ended_s = 0.0;
        app_say(self, MRT_LOG_INFO, "the overdub has ended. Press R to start another");
    } else if (live_shown_take(self->live)) { /* the view may be of a frame before */
        begin_over(self);
    } else {
        lead_in(self, app_lead_in_of(self).count_in_s, true);
        if (!self->recording.counts_in)
            begin_live(self);
    }
    self->takes.are_stale = true;
}

void app_keep(app *self, int64_t from_ns, int64_t to_ns)
{
    error err = {0};
    int64_t kept = 0;
    if (app_report(self, live_keep(self->live, from_ns, to_ns, NULL, &kept, &err), &err) >= 0)
        await_take(self, kept, true);
}

void app_mark(app *self)
{
    error err = {0};
    if (!live_shown_take(self->live)) {
        if (app_report(self, live_mark(self->live, "", &err), &err) < 0)
            return;
        app_marks *m = &self->marks;
        if (m->count == APP_MARKS_MAX)
            memmove(m->at_ns, m->at_ns + 1, --m->count * sizeof *m->at_ns);
        m->at_ns[m->count++] = clock_now_ns();
        app_say(self, MRT_LOG_INFO, "marker added to the live recording");
        return;
    }
    edit e;
    edit_init(&e, EDIT_MARKER_ADD);
    e.at_ns = head_ns(self);
    app_reported(app_edit(self, &e));
    edit_finish(&e);
}

uint32_t app_marks_of(const app *self, const int64_t **out_at_ns)
{
    *out_at_ns = self->marks.at_ns;
    return self->marks.count;
}

/* ---- what has ended ---- */

/* The edits that make it a part of the take are one step of undo. */
static void take_over(app *self)
{
    const int64_t over = self->recording.over_take;
    edit *edits = NULL;
    uint32_t count = 0;
    error err = {0};
    const bool is_there = live_overdub_edits(self->live, &edits, &count, &err);
    if (!is_there && !err.text[0])
        return; /* it goes on */
    self->recording.over_take = 0;
    self->recording.over_ended_s = self->recording.over_is_ended ? 0.0 : OVER_ENDED_S;
    self->takes.are_stale = true;
    if (!is_there) {
        (void)app_report(self, MRT_ERR_IO, &err);
        return;
    }
    const edit **list = calloc(count ? count : 1, sizeof *list);
    for (uint32_t i = 0; list && i < count; ++i)
        list[i] = &edits[i];
    if (!list)
        app_say(self, MRT_LOG_ERROR, "no memory: the performance was saved as a separate take");
    else if (app_pick_take(self, over) >= 0)
        app_reported(app_edit_all_as(self, list, count, "record over the take"));
    for (uint32_t i = 0; i < count; ++i)
        edit_finish(&edits[i]);
    free(edits);
    free(list);
}

void app_record_finish_over(app *self)
{
    error err = {0};
    if (!self->recording.over_take)
        return;
    live_status_of(self->live, &self->status);
    if (self->status.is_recording)
        (void)app_report(self, live_record_end(self->live, &err), &err);
    live_status_of(self->live, &self->status);
    take_over(self);
    self->recording.over_take = 0;
}

/* The bar has room for its first words only. */
static void say_problem(app *self)
{
    const bool has_problem = self->status.problem[0] != '\0';
    if (has_problem && !self->recording.had_problem)
        app_say(self, MRT_LOG_ERROR, "%s", self->status.problem);
    else if (!has_problem && self->recording.had_problem)
        app_say(self, MRT_LOG_INFO, "everything is recorded again");
    self->recording.had_problem = has_problem;
}

/* Messages also go to stderr, because the window may be closed. */
mrt_result app_close_show(app *self, show *of)
{
    error sentence = {""};
    const show_rescue_state state = of ? show_rescue_missing(of, &sentence) : SHOW_RESCUE_NONE;
    const bool is_well = state == SHOW_RESCUE_NONE || state == SHOW_RESCUE_BESIDE;
    if (state != SHOW_RESCUE_NONE) {
        app_say(self, is_well ? MRT_LOG_WARNING : MRT_LOG_ERROR, "%s", sentence.text);
        fprintf(stderr, "marotte: %s\n", sentence.text);
    }
    show_close(of);
    return is_well ? MRT_OK : MRT_ERR_IO;
}

/* Runs the count-in. Showing a take cancels it. */
static void count_in(app *self)
{
    if (live_shown_take(self->live)) {
        lead_in(self, 0.0, false);
    } else if (app_leads_in_s(self) <= 0.0) {
        self->recording.counts_in = false;
        self->recording.leads_in_until_ns = 0;
        begin_live(self);
        self->takes.are_stale = true;
    }
}

void app_record_update(app *self)
{
    say_problem(self);
    if (self->recording.counts_in)
        count_in(self);
    const bool has_ended = self->recording.was_recording && !self->status.is_recording;
    if (self->recording.was_recording != self->status.is_recording)
        self->takes.are_stale = true;
    self->recording.was_recording = self->status.is_recording;
    if (self->recording.over_take)
        take_over(self);
    else if (has_ended && self->status.take)
        await_take(self, self->status.take, false);
}

/* ---- the transport ---- */

static const double speeds[] = {0.1, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 4.0};
enum { SPEEDS = sizeof speeds / sizeof speeds[0] };

/* The chosen take on the stage; false: it could not be. */
static bool show_it(app *self)
{
    if (live_shown_take(self->live) == self->takes.chosen && self->view->mode != LIVE_PERFORMS)
        return true;
    return show_chosen(self) >= 0;
}

/* ---- time code from outside ---- */

static const char chase_key[] = "timecode.chase";
static const int64_t chase_off_ns = 40 * NS_PER_MS, chase_again_ns = NS_PER_S / 2;

bool app_outside_code(const app *self, timecode_rate *out_rate, int64_t *out_frame)
{
    const recorder_code *code = &self->status.code;
    const double frame = recorder_code_at(code, clock_now_ns());
    error ignored = {""};
    if (frame < 0.0 || timecode_rate_of(out_rate, code->fps, &ignored) < 0)
        return false;
    out_rate->is_drop = code->is_drop && timecode_can_drop(*out_rate);
    *out_frame = (int64_t)frame;
    return true;
}

bool app_chases(const app *self)
{
    return settings_number(self->settings, chase_key, 0.0) > 0.5;
}

void app_set_chases(app *self, bool chases)
{
    settings_set_number(self->settings, chase_key, chases ? 1.0 : 0.0);
}

/* Time in the selected take at the external time code; < 0: outside. */
static int64_t chased_at_ns(const app *self, int64_t now_ns)
{
    const recorder_code *code = &self->status.code;
    const double frame = recorder_code_at(code, now_ns);
    const take *t = app_take(self);
    if (!t || t->fps <= 0.0 || frame < 0.0 || self->status.is_recording ||
        self->recording.over_take)
        return -1;
    const double at_s = frame / code->fps - (double)t->timecode_frame / t->fps;
    const int64_t at_ns = (int64_t)(at_s * 1e9);
    return at_ns < t->duration_ns ? at_ns : -1;
}

void app_chase(app *self)
{
    if (!app_chases(self) || chased_at_ns(self, clock_now_ns()) < 0 || !show_it(self)) {
        if (self->chase.is_on && !self->status.is_recording)
            live_pause(self->live);
        self->chase.is_on = false;
        return;
    }
    const bool plays = live_transport(self->live)->is_playing;
    const int64_t now_ns = clock_now_ns(), at_ns = chased_at_ns(self, now_ns);
    const int64_t off_ns = live_position(self->live).at_ns - at_ns;
    if (plays &&
        (llabs(off_ns) < chase_off_ns || now_ns - self->chase.synchronised_ns < chase_again_ns))
        return;
    live_set_speed(self->live, 1.0);
    live_set_loop(self->live, 0, 0);
    live_seek(self->live, at_ns);
    if (!plays)
        live_play(self->live);
    self->chase.is_on = true;
    self->chase.synchronised_ns = now_ns;
}

void app_seek(app *self, int64_t at_ns)
{
    if (self->takes.history && !self->status.is_recording && show_it(self))
        live_seek(self->live, at_ns);
}

void app_set_range(app *self, int64_t in_ns, int64_t out_ns)
{
    if (self->takes.history && !self->status.is_recording && show_it(self))
        live_set_loop(self->live, in_ns, out_ns);
}

static void play_or_pause(app *self)
{
    if (!show_it(self))
        return;
    const transport_position position = live_position(self->live);
    if (live_transport(self->live)->is_playing && !position.has_stopped) {
        live_pause(self->live);
        return;
    }
    self->recording.played_from_ns = position.has_stopped ? 0 : position.at_ns;
    live_play(self->live);
}

static void stop(app *self)
{
    live_pause(self->live);
    live_seek(self->live, self->recording.played_from_ns);
}

static int64_t end_of(const app *self)
{
    const take *t = app_take(self);
    return t ? t->duration_ns : 0;
}

static void seek_by(app *self, int64_t by_ns)
{
    int64_t to_ns = live_position(self->live).at_ns + by_ns;
    const int64_t end_ns = end_of(self);
    if (to_ns < 0)
        to_ns = 0;
    live_seek(self->live, to_ns < end_ns ? to_ns : end_ns);
}

static void toggle_loop(app *self)
{
    const transport *t = live_transport(self->live);
    if (t->is_looping)
        live_set_loop(self->live, 0, 0);
    else if (t->loop_in_ns < t->loop_out_ns)
        live_set_loop(self->live, t->loop_in_ns, t->loop_out_ns);
    else
        live_set_loop(self->live, 0, end_of(self));
}

static void set_range(app *self, bool is_end)
{
    const transport *t = live_transport(self->live);
    const int64_t at_ns = live_position(self->live).at_ns, end_ns = end_of(self);
    int64_t in_ns = t->loop_in_ns < t->loop_out_ns ? t->loop_in_ns : 0;
    int64_t out_ns = t->loop_in_ns < t->loop_out_ns ? t->loop_out_ns : end_ns;
    if (is_end) {
        out_ns = at_ns;
        in_ns = in_ns < out_ns ? in_ns : 0;
    } else {
        in_ns = at_ns;
        out_ns = in_ns < out_ns ? out_ns : end_ns;
    }
    if (in_ns < out_ns)
        live_set_loop(self->live, in_ns, out_ns);
    else
        app_say(self, MRT_LOG_INFO, "the range is empty: set its end after its start");
}

static void change_speed(app *self, bool is_faster)
{
    const double now = live_transport(self->live)->speed;
    double next = now;
    for (uint32_t i = 0; i < SPEEDS; ++i) {
        const double one = speeds[is_faster ? i : SPEEDS - 1 - i];
        if (is_faster ? one > now + 1e-6 : one < now - 1e-6) {
            next = one;
            break;
        }
    }
    live_set_speed(self->live, next);
}

/* The one before or after the chosen one that is not deleted. */
static void choose_beside(app *self, bool is_next)
{
    const uint32_t count = self->takes.line_count;
    uint32_t at = count;
    for (uint32_t i = 0; i < count; ++i)
        if (self->takes.line[i].id == self->takes.chosen)
            at = i;
    for (uint32_t step = 1; step <= count; ++step) {
        if (!is_next && step > at)
            return;
        const uint32_t i = !is_next ? at - step : at == count ? count - step : at + step;
        if (i >= count)
            return;
        if (self->takes.line[i].is_deleted || self->takes.line[i].is_recording)
            continue;
        app_reported(app_choose_take(self, self->takes.line[i].id));
        return;
    }
}

void app_play_do(app *self, action of)
{
    switch (of) {
    case ACTION_TAKE_BEFORE:
        choose_beside(self, false);
        return;
    case ACTION_TAKE_NEXT:
        choose_beside(self, true);
        return;
    case ACTION_PLAY:
        play_or_pause(self);
        return;
    case ACTION_STOP:
        stop(self);
        return;
    default:
        break;
    }
    if (!show_it(self))
        return;
    switch (of) {
    case ACTION_TO_START:
        live_seek(self->live, 0);
        break;
    case ACTION_TO_END:
        live_seek(self->live, end_of(self));
        break;
    case ACTION_FRAME_BACK:
    case ACTION_FRAME_FORWARD:
        live_step_frames(self->live, of == ACTION_FRAME_BACK ? -1 : 1);
        break;
    case ACTION_SECOND_BACK:
    case ACTION_SECOND_FORWARD:
        seek_by(self, of == ACTION_SECOND_BACK ? -NS_PER_S : NS_PER_S);
        break;
    case ACTION_LOOP:
        toggle_loop(self);
        break;
    case ACTION_LOOP_IN:
    case ACTION_LOOP_OUT:
        set_range(self, of == ACTION_LOOP_OUT);
        break;
    case ACTION_SLOWER:
    case ACTION_FASTER:
        change_speed(self, of == ACTION_FASTER);
        break;
    default:
        break;
    }
}

/* ---- what the edit actions do to the clip, layer or marker that is chosen, or to the take ---- */

static const take_layer *layer_of(const take *t, uint32_t id)
{
    for (uint32_t i = 0; t && i < t->layer_count; ++i)
        if (t->layer[i].id == id)
            return &t->layer[i];
    return NULL;
}

static const take_clip *clip_of(const take *t, uint32_t id, const take_layer **out_layer)
{
    for (uint32_t i = 0; t && i < t->layer_count; ++i)
        for (uint32_t k = 0; k < t->layer[i].clip_count; ++k)
            if (t->layer[i].clip[k].id == id) {
                *out_layer = &t->layer[i];
                return &t->layer[i].clip[k];
            }
    return NULL;
}

static bool is_within(const take_clip *clip, const take_layer *lane, int64_t at_ns)
{
    return at_ns > clip->start_ns + lane->offset_ns && at_ns < clip->end_ns + lane->offset_ns;
}

/* The clip that is chosen, or the only one that is under the play head. */
static const take_clip *clip_at(const app *self, int64_t at_ns, const take_layer **out_layer)
{
    const take *t = app_take(self);
    const take_clip *found = NULL;
    uint32_t count = 0;
    if (self->takes.choice.clip)
        return clip_of(t, self->takes.choice.clip, out_layer);
    for (uint32_t i = 0; t && i < t->layer_count; ++i)
        for (uint32_t k = 0; k < t->layer[i].clip_count; ++k) {
            const take_layer *lane = &t->layer[i];
            if (!is_within(&lane->clip[k], lane, at_ns))
                continue;
            *out_layer = lane;
            found = &lane->clip[k];
            count += 1;
        }
    return count == 1 ? found : NULL;
}

/* ---- why not ---- */

static const char *why_no_split(const app *self)
{
    const take_layer *lane = NULL;
    const int64_t at_ns = head_ns(self);
    const take_clip *clip = clip_at(self, at_ns, &lane);
    if (!clip)
        return "select a clip on the timeline";
    return is_within(clip, lane, at_ns) ? NULL : "the playhead is outside the clip";
}

static const char *why_no_trim(const app *self)
{
    const take_layer *lane = NULL;
    const take *t = app_take(self);
    const int64_t at_ns = head_ns(self);
    if (self->takes.choice.clip) {
        const take_clip *clip = clip_of(t, self->takes.choice.clip, &lane);
        return clip && is_within(clip, lane, at_ns) ? NULL : "the playhead is outside the clip";
    }
    return at_ns > 0 && at_ns < t->duration_ns ? NULL : "the playhead is outside the take";
}

const char *app_edit_why_not(app *self, action of)
{
    const app_choice *choice = &self->takes.choice;
    if (!self->takes.history)
        return "no take is selected";
    if (!show_is_writable(self->show))
        return "the show is read-only";
    if (self->status.is_recording && self->status.take == self->takes.chosen)
        return "the take is being recorded";
    switch (of) {
    case ACTION_SPLIT:
        return why_no_split(self);
    case ACTION_TRIM_START:
    case ACTION_TRIM_END:
        return why_no_trim(self);
    case ACTION_REMOVE:
        return choice->clip || choice->layer || choice->marker >= 0 || choice->is_take
                   ? NULL
                   : "select a take in the list, or a clip, a layer or a marker on the timeline";
    case ACTION_MUTE:
        return choice->clip || choice->layer ? NULL : "select a clip or a layer on the timeline";
    case ACTION_SOLO:
        return choice->layer || choice->clip ? NULL : "select a layer on the timeline";
    default:
        return NULL;
    }
}

/* ---- doing it ---- */

static bool make_split(const app *self, edit *out)
{
    const take_layer *lane = NULL;
    const int64_t at_ns = head_ns(self);
    const take_clip *clip = clip_at(self, at_ns, &lane);
    if (!clip)
        return false;
    edit_init(out, EDIT_CLIP_SPLIT);
    out->clip = clip->id;
    out->at_ns = at_ns;
    return true;
}

static bool make_trim(const app *self, edit *out, bool is_end)
{
    const int64_t at_ns = head_ns(self);
    const take *t = app_take(self);
    if (self->takes.choice.clip) {
        edit_init(out, EDIT_CLIP_TRIM);
        out->clip = self->takes.choice.clip;
        out->is_ripple = self->looks.is_rippling;
        *(is_end ? &out->end_ns : &out->start_ns) = at_ns;
        return true;
    }
    edit_init(out, EDIT_RANGE_KEEP);
    out->in_ns = is_end ? 0 : at_ns;
    out->out_ns = is_end ? at_ns : t->duration_ns;
    return true;
}

static bool make_remove(const app *self, edit *out)
{
    const app_choice *choice = &self->takes.choice;
    edit_init(out, choice->is_take       ? EDIT_TAKE_DELETE
                   : choice->marker >= 0 ? EDIT_MARKER_REMOVE
                   : choice->clip        ? EDIT_CLIP_REMOVE
                                         : EDIT_LAYER_REMOVE);
    if (choice->is_take)
        return true;
    if (choice->marker >= 0)
        out->marker = (uint32_t)choice->marker;
    else if (choice->clip) {
        out->clip = choice->clip;
        out->is_ripple = self->looks.is_rippling;
    } else
        out->layer = choice->layer;
    return true;
}

static bool make_mute(const app *self, edit *out)
{
    const take_layer *lane = NULL;
    const take_clip *clip = clip_of(app_take(self), self->takes.choice.clip, &lane);
    if (clip) {
        edit_init(out, EDIT_CLIP_MUTE);
        out->clip = clip->id;
        out->is_muted = !clip->is_muted;
        return true;
    }
    lane = layer_of(app_take(self), self->takes.choice.layer);
    if (!lane)
        return false;
    edit_init(out, EDIT_LAYER_MUTE);
    out->layer = lane->id;
    out->is_muted = !lane->is_muted;
    return true;
}

static bool make_solo(const app *self, edit *out)
{
    const take_layer *lane = layer_of(app_take(self), self->takes.choice.layer);
    if (!lane)
        (void)clip_of(app_take(self), self->takes.choice.clip, &lane);
    if (!lane)
        return false;
    edit_init(out, EDIT_LAYER_SOLO);
    out->layer = lane->id;
    out->is_solo = !lane->is_solo;
    return true;
}

static bool make(const app *self, action of, edit *out)
{
    switch (of) {
    case ACTION_SPLIT:
        return make_split(self, out);
    case ACTION_TRIM_START:
    case ACTION_TRIM_END:
        return make_trim(self, out, of == ACTION_TRIM_END);
    case ACTION_REMOVE:
        return make_remove(self, out);
    case ACTION_MUTE:
        return make_mute(self, out);
    case ACTION_SOLO:
        return make_solo(self, out);
    default:
        edit_init(out, EDIT_TAKE_RATE);
        out->rating = (uint32_t)(of - ACTION_RATE_0);
        return true;
    }
}

void app_edit_do(app *self, action of)
{
    edit e = {0};
    if (make(self, of, &e) && app_edit(self, &e) >= 0 && e.kind == EDIT_TAKE_DELETE)
        app_say(self, MRT_LOG_INFO, "the take is deleted: undo restores it");
    edit_finish(&e);
}
