#include "take/edit_store.h"

#include <stdlib.h>
#include <string.h>

struct edit_store {
    show *show;
    int64_t take_id;
    int64_t (*utc_ms)(void);
    take bare;
    show_edits edits; /* as in the show */
};

/* ---- the list ---- */

static int32_t first_of(const show_edits *edits)
{
    return edits->count > 0 && edits->edit[0].n < 1 ? edits->edit[0].n : 1;
}

static int32_t last_of(const show_edits *edits)
{
    int32_t last = edits->count > 0 ? edits->edit[edits->count - 1].n : 0;
    return last > 0 ? last : 0;
}

static mrt_result list_extent(void *self, history_extent *out, error *err)
{
    const show_edits *edits = &((const edit_store *)self)->edits;
    (void)err;
    *out = (history_extent){first_of(edits), edits->head, last_of(edits)};
    return MRT_OK;
}

static mrt_result list_read(void *self, int64_t n, const char **out_text, size_t *out_size,
                            error *err)
{
    const show_edits *edits = &((const edit_store *)self)->edits;
    if (n < first_of(edits) || n > last_of(edits))
        return error_set(err, MRT_ERR_FORMAT, "edit %lld: the show has edits %d .. %d of the take",
                         (long long)n, first_of(edits), last_of(edits));
    *out_text = edits->edit[n - edits->edit[0].n].json;
    *out_size = strlen(*out_text);
    return MRT_OK;
}

/* Room for one more edit, and a copy of it: what could fail after the show has it. */
static mrt_result prepare(show_edits *edits, const char *text, show_edit *out, error *err)
{
    show_edit *larger = realloc(edits->edit, (edits->count + 1) * sizeof *larger);
    if (larger)
        edits->edit = larger;
    *out = (show_edit){.json = larger ? strdup(text) : NULL};
    return out->json ? MRT_OK : error_set(err, MRT_ERR_MEMORY, "no memory for an edit");
}

static mrt_result list_append(void *self, const char *text, const edit_reference *shows, error *err)
{
    edit_store *store = self;
    show_edits *edits = &store->edits;
    show_edit made;
    mrt_result result = prepare(edits, text, &made, err);
    if (result < 0)
        return result;
    show_span span = {0};
    if (shows)
        span = (show_span){shows->performance, shows->from_ns, shows->to_ns, false};
    made.utc_ms = store->utc_ms();
    made.n = edits->head + 1;
    result =
        show_edit_append(store->show, store->take_id, text, made.utc_ms, &span, shows ? 1 : 0, err);
    if (result < 0) {
        free(made.json);
        return result;
    }
    while (last_of(edits) > edits->head)
        free(edits->edit[--edits->count].json);
    edits->edit[edits->count++] = made;
    edits->head = made.n;
    return MRT_OK;
}

static mrt_result list_set_head(void *self, int64_t head, error *err)
{
    edit_store *store = self;
    mrt_result result = show_edit_head(store->show, store->take_id, (int32_t)head, err);
    if (result >= 0)
        store->edits.head = (int32_t)head;
    return result;
}

/* ---- open, close ---- */

mrt_result edit_store_open(edit_store **out, show *s, int64_t take_id, int64_t (*utc_ms)(void),
                           error *err)
{
    *out = NULL;
    edit_store *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the edits of a take");
    self->show = s;
    self->take_id = take_id;
    self->utc_ms = utc_ms;
    mrt_result result = show_take_base(s, take_id, &self->bare, err);
    if (result >= 0)
        result = show_edits_read(s, take_id, &self->edits, err);
    if (result < 0) {
        edit_store_close(self);
        return result;
    }
    *out = self;
    return MRT_OK;
}

void edit_store_close(edit_store *self)
{
    if (!self)
        return;
    take_finish(&self->bare);
    show_edits_finish(&self->edits);
    free(self);
}

history_store edit_store_list(edit_store *self)
{
    return (history_store){self, list_extent, list_read, list_append, list_set_head};
}

const take *edit_store_bare(const edit_store *self)
{
    return &self->bare;
}

mrt_result edit_store_take(take *out, show *s, int64_t take_id, error *err)
{
    edit_store *self;
    *out = (take){0};
    mrt_result result = edit_store_open(&self, s, take_id, NULL, err);
    if (result < 0)
        return result;
    history_store list = edit_store_list(self);
    result = history_fold(out, &self->bare, &list, self->edits.head, NULL, err);
    edit_store_close(self);
    return result;
}

mrt_result edit_store_attach_audio(show *s, int64_t take_id, const show_audio *audio,
                                   int64_t (*utc_ms)(void), error *err)
{
    edit_store *self = NULL;
    history *h = NULL;
    edit e;
    mrt_result result = edit_store_open(&self, s, take_id, utc_ms, err);
    if (result < 0)
        return result;
    history_store list = edit_store_list(self);
    result = history_open(&h, &self->bare, &list, err);
    edit_init(&e, EDIT_AUDIO_ATTACH);
    e.audio = audio->id;
    e.offset_ns = audio->start_ns - self->bare.start_ns;
    if (result >= 0)
        result = history_do(h, &e, err);
    history_close(h);
    edit_store_close(self);
    return result;
}
