#include "show/history.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Budget steps (base/budget.h): the whole take is checked after each edit. */
enum { STEPS_AN_EDIT = 200, STEPS_AN_ITEM = 12 };

typedef struct description {
    char text[EDIT_TEXT];
} description;

struct history {
    history_store store;
    history_extent extent;
    take bare, now;
    description *descriptions; /* edit n is at n - 1 */
    size_t description_capacity;
};

/* ---- applying the list ---- */

static mrt_result at_edit(int64_t n, mrt_result result, error *err)
{
    char prefix[40];
    (void)snprintf(prefix, sizeof prefix, "edit %lld", (long long)n);
    error_prefix(err, prefix);
    return result;
}

static mrt_result read_edit(edit *out, const history_store *store, int64_t n, error *err)
{
    const char *text = NULL;
    size_t size = 0;
    *out = (edit){0};
    mrt_result result = store->read(store->self, n, &text, &size, err);
    if (result < 0)
        return result;
    result = edit_parse(out, text, size, err);
    return result < 0 ? at_edit(n, result, err) : MRT_OK;
}

static mrt_result pay(const history_store *store, const take *t, int64_t n, error *err)
{
    uint64_t items = t->marker_count;
    for (uint32_t i = 0; i < t->layer_count; ++i)
        items += t->layer[i].clip_count;
    mrt_result result =
        store->pay ? store->pay(store->self, STEPS_AN_EDIT + items * STEPS_AN_ITEM, err) : MRT_OK;
    return result < 0 ? at_edit(n, result, err) : MRT_OK;
}

/* Applies the edits from..until to t. *out_reached: the last one that was applied. After a failure
 * t is half changed. `descriptions`: receives their descriptions, or NULL. */
static mrt_result apply_edits(take *t, const history_store *store, int64_t from, int64_t until,
                              int64_t *out_reached, description *descriptions, error *err)
{
    mrt_result result = MRT_OK;
    for (int64_t n = from; result >= 0 && n <= until; ++n) {
        edit e;
        result = pay(store, t, n, err);
        if (result >= 0)
            result = read_edit(&e, store, n, err);
        if (result < 0)
            break;
        if (descriptions && n >= 1)
            edit_describe(descriptions[n - 1].text, &e, t);
        result = edit_apply_onto(t, &e, err);
        edit_finish(&e);
        if (result < 0)
            (void)at_edit(n, result, err);
        else
            *out_reached = n;
    }
    return result;
}

static mrt_result fold_onto_copy(take *out, const take *bare, const history_store *store,
                                 int64_t first, int64_t until, int64_t *out_reached,
                                 description *descriptions, error *err)
{
    mrt_result result = take_copy(out, bare, err);
    *out_reached = first - 1;
    if (result >= 0)
        result = apply_edits(out, store, first, until, out_reached, descriptions, err);
    return result;
}

/* Applies as many edits as possible. After a failure it starts again and stops before the edit that
 * failed. */
static mrt_result fold(take *out, const take *bare, const history_store *store, int64_t first,
                       int64_t until, int64_t *out_reached, description *descriptions, error *err)
{
    *out = (take){0};
    mrt_result failed =
        fold_onto_copy(out, bare, store, first, until, out_reached, descriptions, err);
    if (failed >= 0)
        return failed;
    take_finish(out);
    int64_t again;
    if (failed == MRT_ERR_MEMORY ||
        fold_onto_copy(out, bare, store, first, *out_reached, &again, NULL, NULL) < 0)
        take_finish(out);
    return failed;
}

static mrt_result read_extent(history_extent *out, const history_store *store, error *err)
{
    mrt_result result = store->extent(store->self, out, err);
    if (result < 0)
        return result;
    if (out->first <= 1 && out->first > INT64_MIN && out->head >= 0 && out->head <= out->last &&
        out->last <= UINT32_MAX)
        return MRT_OK;
    return error_set(err, MRT_ERR_FORMAT,
                     "edits %lld .. %lld, head %lld: expected a list up to 1 or more with a head "
                     "within; the show is damaged: recover it",
                     (long long)out->first, (long long)out->last, (long long)out->head);
}

mrt_result history_fold(take *out, const take *bare, const history_store *store, int64_t until,
                        int64_t *out_reached, error *err)
{
    history_extent extent;
    int64_t reached = 0;
    *out = (take){0};
    mrt_result result = read_extent(&extent, store, err);
    if (result >= 0)
        result = fold(out, bare, store, extent.first, until < extent.last ? until : extent.last,
                      &reached, NULL, err);
    if (out_reached)
        *out_reached = reached;
    return result;
}

/* ---- an open history ---- */

static mrt_result make_room(history *self, int64_t count, error *err)
{
    if ((uint64_t)count <= self->description_capacity)
        return MRT_OK;
    size_t room = (size_t)count + (size_t)count / 2 + 16;
    description *descriptions = realloc(self->descriptions, room * sizeof *descriptions);
    if (!descriptions)
        return error_set(err, MRT_ERR_MEMORY, "no memory for %lld edits", (long long)count);
    memset(descriptions + self->description_capacity, 0,
           (room - self->description_capacity) * sizeof *descriptions);
    self->descriptions = descriptions;
    self->description_capacity = room;
    return MRT_OK;
}

/* Describes the edits that can be redone. From an unreadable edit on, the description is the error.
 * */
static void word_redoable(history *self)
{
    take later;
    error why = {""};
    int64_t reached = self->extent.head;
    if (take_copy(&later, &self->now, NULL) < 0)
        return;
    if (apply_edits(&later, &self->store, self->extent.head + 1, self->extent.last, &reached,
                    self->descriptions, &why) < 0)
        (void)snprintf(self->descriptions[reached].text, sizeof self->descriptions[reached].text,
                       "%.150s", why.text);
    take_finish(&later);
}

static mrt_result fold_now(history *self, int64_t head, error *err)
{
    take now;
    int64_t reached;
    mrt_result result = fold(&now, &self->bare, &self->store, self->extent.first, head, &reached,
                             self->descriptions, err);
    if (result < 0) {
        take_finish(&now);
        return result;
    }
    take_finish(&self->now);
    self->now = now;
    return MRT_OK;
}

mrt_result history_open(history **out, const take *bare, const history_store *store, error *err)
{
    *out = NULL;
    history *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the edits of a take");
    self->store = *store;
    mrt_result result = read_extent(&self->extent, store, err);
    if (result >= 0)
        result = take_copy(&self->bare, bare, err);
    if (result >= 0)
        result = make_room(self, self->extent.last + 1, err);
    if (result >= 0)
        result = fold_now(self, self->extent.head, err);
    if (result < 0) {
        history_close(self);
        return result;
    }
    word_redoable(self);
    *out = self;
    return MRT_OK;
}

void history_close(history *self)
{
    if (!self)
        return;
    take_finish(&self->bare);
    take_finish(&self->now);
    free(self->descriptions);
    free(self);
}

const take *history_take(const history *self)
{
    return &self->now;
}

int64_t history_head(const history *self)
{
    return self->extent.head;
}

int64_t history_last(const history *self)
{
    return self->extent.last;
}

const char *history_words(const history *self, int64_t n)
{
    return n >= 1 && n <= self->extent.last ? self->descriptions[n - 1].text : "";
}

/* ---- changes: the store first, then steps that cannot fail ---- */

static mrt_result append(history *self, const edit *e, error *err)
{
    char *text;
    mrt_result result = edit_write(&text, e, err);
    if (result < 0)
        return result;
    edit_reference shows;
    bool refers = edit_refers(&shows, e, &self->now);
    result = self->store.append(self->store.self, text, refers ? &shows : NULL, err);
    free(text);
    return result;
}

mrt_result history_do(history *self, const edit *e, error *err)
{
    take changed;
    mrt_result result = make_room(self, self->extent.head + 2, err);
    if (result >= 0)
        result = take_copy(&changed, &self->now, err);
    if (result < 0)
        return result;
    result = edit_apply_onto(&changed, e, err);
    if (result >= 0)
        result = append(self, e, err);
    if (result < 0) {
        take_finish(&changed);
        return result;
    }
    edit_describe(self->descriptions[self->extent.head].text, e, &self->now);
    take_finish(&self->now);
    self->now = changed;
    self->extent.last = ++self->extent.head;
    return MRT_OK;
}

mrt_result history_go(history *self, int64_t head, error *err)
{
    take then;
    int64_t reached;
    if (head < 0 || head > self->extent.last)
        return error_set(err, MRT_ERR_ARGUMENT, "edit %lld: the take has edits 0 .. %lld",
                         (long long)head, (long long)self->extent.last);
    mrt_result result =
        fold(&then, &self->bare, &self->store, self->extent.first, head, &reached, NULL, err);
    if (result >= 0)
        result = self->store.set_head(self->store.self, head, err);
    if (result < 0) {
        take_finish(&then);
        return result;
    }
    take_finish(&self->now);
    self->now = then;
    self->extent.head = head;
    return MRT_OK;
}

mrt_result history_undo(history *self, error *err)
{
    return self->extent.head > 0 ? history_go(self, self->extent.head - 1, err) : MRT_END;
}

mrt_result history_redo(history *self, error *err)
{
    return self->extent.head < self->extent.last ? history_go(self, self->extent.head + 1, err)
                                                 : MRT_END;
}
