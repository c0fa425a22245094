/* The list of takes, and the one that is chosen with its edits. */
#include "window/studio_state.h"

#include "base/clock.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define AWAITED_S 10.0

/* ---- the list ---- */

static mrt_result make_room(studio *self, size_t count, error *err)
{
    if (count <= self->line_room)
        return MRT_OK;
    const size_t room = count + 32;
    studio_take_line *line = realloc(self->line, room * sizeof *line);
    if (line)
        self->line = line;
    studio_take_key *key = realloc(self->key, room * sizeof *key);
    if (key)
        self->key = key;
    if (!line || !key)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the list of takes");
    self->line_room = (uint32_t)room;
    return MRT_OK;
}

static void fill_line(studio_take_line *out, const take *t)
{
    *out = (studio_take_line){.id = t->id,
                              .rating = t->rating,
                              .duration_ns = t->duration_ns,
                              .created_ns = t->created_ns,
                              .is_recording = t->is_recording,
                              .is_deleted = t->is_deleted};
    (void)snprintf(out->title, sizeof out->title, "%s%s%s%s%u%s%s", t->scene,
                   t->scene[0] ? "/" : "", t->shot, t->shot[0] ? "/" : "", t->number,
                   t->name[0] ? " " : "", t->name);
    (void)snprintf(out->note, sizeof out->note, "%s", t->note);
}

/* A take with edits that this version does not know is shown as far as it goes. Returns whether it
 * could be read, which is said once. */
static bool fold_line(studio *self, studio_take_line *out, const show_take *row, bool was_told)
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
        *out = (studio_take_line){.id = row->id, .title = "damaged"};
    take_finish(&t);
    return is_read;
}

static bool is_as_before(const studio *self, uint32_t index, const show_take *row)
{
    const studio_take_key *key = &self->key[index];
    return index < self->line_count && self->line[index].id == row->id && !key->is_stale &&
           key->edit_head == row->edit_head && key->edit_count == row->edit_count &&
           key->is_recording == row->is_recording && !row->is_recording;
}

static void read_list(studio *self)
{
    show_take *rows = NULL;
    size_t count = 0;
    error err = {0};
    mrt_result result = show_takes(self->show, &rows, &count, &err);
    if (result >= 0)
        result = make_room(self, count, &err);
    if (result < 0 && !self->takes_failed)
        (void)studio_said(self, result, &err);
    self->takes_failed = result < 0;
    if (result < 0) {
        free(rows);
        return;
    }
    for (uint32_t i = 0; i < (uint32_t)count; ++i) {
        if (is_as_before(self, i, &rows[i]))
            continue;
        const bool was_told =
            i < self->line_count && self->line[i].id == rows[i].id && self->key[i].is_told;
        const bool is_read = fold_line(self, &self->line[i], &rows[i], was_told);
        self->key[i] = (studio_take_key){.edit_head = rows[i].edit_head,
                                         .edit_count = rows[i].edit_count,
                                         .is_recording = rows[i].is_recording,
                                         .is_told = !is_read};
    }
    self->line_count = (uint32_t)count;
    free(rows);
}

const studio_take_line *studio_line_of(const studio *self, int64_t id)
{
    for (uint32_t i = 0; i < self->line_count; ++i)
        if (self->line[i].id == id)
            return &self->line[i];
    return NULL;
}

/* The one that is being recorded grows. What begins over a take is not said yet for some frames:
 * the one before it is whole, and stays as it is. */
static void follow_recording(studio *self)
{
    for (uint32_t i = self->line_count; i > 0; --i)
        if (self->line[i - 1].id == self->status.take && self->key[i - 1].is_recording) {
            self->line[i - 1].is_recording = self->status.is_recording;
            if (self->status.is_recording)
                self->line[i - 1].duration_ns = self->status.recorded_ns;
            break;
        }
}

/* It is in the show as soon as the writer has got to it. */
static bool lacks_recording(const studio *self)
{
    return self->status.is_recording && self->status.take &&
           !studio_line_of(self, self->status.take);
}

void studio_await_take(studio *self, int64_t id, bool is_kept)
{
    self->awaited = id;
    self->awaited_is_kept = is_kept;
    self->awaited_s = 0.0;
}

static bool is_whole(const studio *self, int64_t id)
{
    for (uint32_t i = 0; i < self->line_count; ++i)
        if (self->line[i].id == id)
            return !self->key[i].is_recording;
    return false;
}

/* A disk that is full lets it wait; it is in the list when it is there. */
static void follow_awaited(studio *self, double dt_s)
{
    const int64_t id = self->awaited;
    self->awaited_s += dt_s;
    if (is_whole(self, id)) {
        self->awaited = 0;
        if (self->view->mode == LIVE_PERFORMS)
            studio_heard(studio_pick_take(self, id));
        if (self->awaited_is_kept)
            studio_tell_kept(self, id);
    } else if (self->awaited_s > AWAITED_S) {
        self->awaited = 0;
        studio_say(self, MRT_LOG_WARNING, "the take is not in the show yet: the disk is slow");
    }
}

static void line_is_stale(studio *self, int64_t id)
{
    for (uint32_t i = 0; i < self->line_count; ++i)
        if (self->line[i].id == id)
            self->key[i].is_stale = true;
    self->takes_are_stale = true;
}

/* The stage itself has changed it: its sound was written, and is in it. */
static void follow_stage_edit(studio *self)
{
    const int64_t id = live_take_edited(self->live);
    const studio_choice choice = self->choice;
    if (id == 0)
        return;
    line_is_stale(self, id);
    if (id != self->chosen)
        return;
    studio_drop_take(self); /* it is read anew */
    if (studio_pick_take(self, id) < 0)
        return;
    self->choice = choice;
    if (live_shown_take(self->live) == id)
        studio_heard(studio_show_chosen(self));
}

/* What is not as it was recorded, once for each take that comes on the stage. */
static void tell_note(studio *self)
{
    const int64_t shown = live_shown_take(self->live);
    if (shown == self->noted)
        return;
    self->noted = shown;
    for (const char *line = live_take_note(self->live); shown && *line;) {
        const size_t length = strcspn(line, "\n");
        studio_say(self, MRT_LOG_WARNING, "%.*s", (int)length, line);
        line += length + (line[length] == '\n');
    }
}

void studio_takes_update(studio *self, double dt_s)
{
    follow_stage_edit(self);
    tell_note(self);
    if (self->takes_are_stale || self->awaited || lacks_recording(self)) {
        self->takes_are_stale = false;
        if (self->show)
            read_list(self);
        else
            self->line_count = 0;
    }
    if (self->awaited)
        follow_awaited(self, dt_s);
    if (self->status.take)
        follow_recording(self);
}

uint32_t studio_takes(const studio *self, const studio_take_line **out)
{
    *out = self->line;
    return self->line_count;
}

/* ---- the one that is chosen ---- */

void studio_drop_take(studio *self)
{
    history_close(self->history);
    edit_store_close(self->store);
    self->history = NULL;
    self->store = NULL;
    self->chosen = 0;
    self->choice = (studio_choice){.marker = -1};
    self->edition += 1;
}

mrt_result studio_pick_take(studio *self, int64_t id)
{
    error err = {0};
    if (id == self->chosen)
        return MRT_OK;
    studio_drop_take(self);
    if (id == 0)
        return MRT_OK;
    if (!self->show)
        return studio_said(self, error_set(&err, MRT_ERR_ARGUMENT, "no show is open"), &err);
    mrt_result result = edit_store_open(&self->store, self->show, id, clock_utc_ms, &err);
    if (result >= 0) {
        const history_store list = edit_store_list(self->store);
        result = history_open(&self->history, edit_store_bare(self->store), &list, &err);
    }
    if (result < 0) {
        studio_drop_take(self);
        return studio_said(self, result, &err);
    }
    self->chosen = id;
    return MRT_OK;
}

mrt_result studio_show_chosen(studio *self)
{
    error err = {0};
    if (!self->history)
        return MRT_OK;
    return studio_said(self, live_show_take(self->live, history_take(self->history), &err), &err);
}

mrt_result studio_choose_take(studio *self, int64_t id)
{
    mrt_result result = studio_pick_take(self, id);
    if (result < 0)
        return result;
    if (id == 0) {
        live_show_hands(self->live);
        return MRT_OK;
    }
    if (live_shown_take(self->live) == id)
        return MRT_OK;
    self->played_from_ns = 0;
    return studio_show_chosen(self);
}

mrt_result studio_choose_instead(studio *self, int64_t id)
{
    const int64_t shown = live_shown_take(self->live);
    return shown && shown == self->chosen ? studio_choose_take(self, id)
                                          : studio_pick_take(self, id);
}

mrt_result studio_duplicate_take(studio *self, int64_t id)
{
    error err = {0};
    int64_t copy = 0;
    char words[EDIT_TEXT];
    const studio_take_line *line = studio_line_of(self, id);
    if (!self->show || !line)
        return studio_said(self, error_set(&err, MRT_ERR_ARGUMENT, "there is no such take"), &err);
    (void)snprintf(words, sizeof words, "duplicate take %.120s", line->title);
    mrt_result result = edit_store_duplicate(self->show, id, clock_utc_ms, &copy, &err);
    if (result < 0)
        return studio_said(self, result, &err);
    self->takes_are_stale = true;
    result = studio_choose_instead(self, copy);
    if (result >= 0)
        studio_undo_note_copy(self, id, words);
    return result;
}

int64_t studio_take_id(const studio *self)
{
    return self->chosen;
}

const take *studio_take(const studio *self)
{
    return self->history ? history_take(self->history) : NULL;
}

uint64_t studio_take_edition(const studio *self)
{
    return self->edition;
}

const history *studio_history(const studio *self)
{
    return self->history;
}

/* ---- its edits ---- */

/* What is chosen in it may be gone. */
static void check_choice(studio *self)
{
    const take *t = studio_take(self);
    bool has_layer = false, has_clip = false, has_armed = false;
    for (uint32_t i = 0; t && i < t->layer_count; ++i) {
        has_layer |= t->layer[i].id == self->choice.layer;
        has_armed |= t->layer[i].id == self->choice.armed;
        for (uint32_t k = 0; k < t->layer[i].clip_count; ++k)
            has_clip |= t->layer[i].clip[k].id == self->choice.clip;
    }
    if (!has_layer)
        self->choice.layer = 0;
    if (!has_clip)
        self->choice.clip = 0;
    if (!has_armed)
        self->choice.armed = 0;
    if (!t || self->choice.marker >= (int32_t)t->marker_count)
        self->choice.marker = -1;
}

void studio_take_changed(studio *self)
{
    self->edition += 1;
    check_choice(self);
    line_is_stale(self, self->chosen);
    if (live_shown_take(self->live) == self->chosen)
        studio_heard(studio_show_chosen(self));
}

static mrt_result check_editable(const studio *self, error *err)
{
    if (!self->history)
        return error_set(err, MRT_ERR_ARGUMENT, "choose the take that is to be changed");
    if (!show_is_writable(self->show))
        return error_set(err, MRT_ERR_UNSUPPORTED, "%s",
                         show_notice(self->show)[0] ? show_notice(self->show)
                                                    : "the show can only be read");
    if (self->status.is_recording && self->status.take == self->chosen)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "the take is being recorded: it can be changed when it has ended");
    return MRT_OK;
}

/* All or none. */
mrt_result studio_edit_all(studio *self, const edit *const *e, uint32_t count)
{
    error err = {0}, ignored = {0};
    mrt_result result = check_editable(self, &err);
    if (result < 0 || count == 0)
        return studio_said(self, result, &err);
    const int64_t before = history_head(self->history);
    for (uint32_t i = 0; i < count && result >= 0; ++i)
        result = history_do(self->history, e[i], &err);
    if (result < 0 && history_go(self->history, before, &ignored) < 0)
        studio_say(self, MRT_LOG_ERROR, "%s", ignored.text);
    if (result >= 0)
        studio_undo_note_take(self, before);
    studio_take_changed(self);
    return studio_said(self, result, &err);
}

mrt_result studio_edit(studio *self, const edit *e)
{
    return studio_edit_all(self, &e, 1);
}

mrt_result studio_history_go(studio *self, int64_t head)
{
    error err = {0};
    mrt_result result = check_editable(self, &err);
    if (result < 0)
        return studio_said(self, result, &err);
    const int64_t before = history_head(self->history);
    result = history_go(self->history, head, &err);
    if (result >= 0 && head != before)
        studio_undo_note_take(self, before);
    studio_take_changed(self);
    return studio_said(self, result, &err);
}

mrt_result studio_edit_take(studio *self, int64_t id, const edit *e)
{
    const int64_t before = self->chosen;
    const studio_choice choice = self->choice;
    if (id == before)
        return studio_edit(self, e);
    mrt_result result = studio_pick_take(self, id);
    if (result >= 0)
        result = studio_edit(self, e);
    if (studio_pick_take(self, before) >= 0)
        self->choice = choice;
    return result;
}
