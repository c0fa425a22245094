#include "show/edit_store.h"

#include <stdio.h>
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

/* Reserves space for one more edit and copies it, so that nothing can fail after the show has
 * stored it. */
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

static mrt_result list_pay(void *self, uint64_t steps, error *err)
{
    return show_spend(((edit_store *)self)->show, steps, err);
}

/* ---- open, close ---- */

static mrt_result open_row(edit_store **out, show *s, const show_take *row, int64_t (*utc_ms)(void),
                           error *err)
{
    *out = NULL;
    edit_store *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the edits of a take");
    self->show = s;
    self->take_id = row->id;
    self->utc_ms = utc_ms;
    mrt_result result = show_take_base_of(s, row, &self->bare, err);
    if (result >= 0)
        result = show_edits_of(s, row, &self->edits, err);
    if (result < 0) {
        edit_store_close(self);
        return result;
    }
    *out = self;
    return MRT_OK;
}

mrt_result edit_store_open(edit_store **out, show *s, int64_t take_id, int64_t (*utc_ms)(void),
                           error *err)
{
    show_take row;
    *out = NULL;
    mrt_result result = show_take_read(s, take_id, &row, err);
    return result < 0 ? result : open_row(out, s, &row, utc_ms, err);
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
    return (history_store){self, list_extent, list_read, list_append, list_set_head, list_pay};
}

const take *edit_store_bare(const edit_store *self)
{
    return &self->bare;
}

mrt_result edit_store_take(take *out, show *s, int64_t take_id, error *err)
{
    show_take row;
    *out = (take){0};
    mrt_result result = show_take_read(s, take_id, &row, err);
    return result < 0 ? result : edit_store_take_of(out, s, &row, err);
}

mrt_result edit_store_take_of(take *out, show *s, const show_take *row, error *err)
{
    edit_store *self;
    *out = (take){0};
    mrt_result result = open_row(&self, s, row, NULL, err);
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

/* ---- marks of a recording ---- */

mrt_result edit_store_marks(show *s, const take *t, edit **out, uint32_t *out_count, error *err)
{
    take_event *event = NULL;
    size_t count = 0;
    *out = NULL;
    *out_count = 0;
    mrt_result result =
        show_events(s, t->start_ns, t->start_ns + t->duration_ns, &event, &count, err);
    if (result >= 0) {
        *out = calloc(count + 1, sizeof **out);
        if (!*out)
            result = error_set(err, MRT_ERR_MEMORY, "no memory for the marks of a take");
    }
    for (size_t i = 0; *out && i < count && *out_count < EDIT_MARKERS_MAX; ++i)
        if (event[i].kind == TAKE_EVENT_MARK) {
            edit *e = &(*out)[(*out_count)++];
            edit_init(e, EDIT_MARKER_ADD);
            e->at_ns = event[i].time_ns - t->start_ns;
            (void)snprintf(e->text, sizeof e->text, "%s", event[i].text);
        }
    free(event);
    return result;
}

mrt_result edit_store_add_marks(show *s, int64_t take_id, int64_t (*utc_ms)(void), error *err)
{
    edit_store *self = NULL;
    history *h = NULL;
    edit *mark = NULL;
    uint32_t count = 0;
    mrt_result result = edit_store_open(&self, s, take_id, utc_ms, err);
    if (result < 0)
        return result;
    history_store list = edit_store_list(self);
    result = edit_store_marks(s, &self->bare, &mark, &count, err);
    if (result >= 0 && count > 0)
        result = history_open(&h, &self->bare, &list, err);
    for (uint32_t i = 0; i < count && result >= 0; ++i)
        result = history_do(h, &mark[i], err);
    free(mark);
    history_close(h);
    edit_store_close(self);
    return result;
}

mrt_result edit_store_add_recovered_marks(show *s, int64_t (*utc_ms)(void), error *err)
{
    show_take *row = NULL;
    size_t count = 0;
    mrt_result result = show_takes(s, &row, &count, err);
    for (size_t i = 0; i < count && result >= 0; ++i)
        if (row[i].is_recovered && row[i].edit_count == 0)
            result = edit_store_add_marks(s, row[i].id, utc_ms, err);
    free(row);
    return result;
}

/* ---- a copy ---- */

typedef struct texts { /* edits as JSON */
    char **at;
    size_t count;
} texts;

static void finish_texts(texts *list)
{
    for (size_t i = 0; i < list->count; ++i)
        free(list->at[i]);
    free(list->at);
}

/* Lists the effective edits without the slate, because the copy has its own number. */
static mrt_result list_in_force(texts *out, const show_edits *edits, error *err)
{
    mrt_result result = MRT_OK;
    for (size_t i = 0; i < edits->count && edits->edit[i].n <= edits->head && result >= 0; ++i) {
        const char *json = edits->edit[i].json;
        edit e;
        result = edit_parse(&e, json, strlen(json), err);
        const bool is_slate = e.kind == EDIT_TAKE_SLATE;
        edit_finish(&e);
        if (result < 0 || is_slate)
            continue;
        out->at[out->count] = strdup(json);
        if (!out->at[out->count++])
            result = error_set(err, MRT_ERR_MEMORY, "no memory for the edits of a take");
    }
    return result;
}

static void name_copy(char out[TAKE_NAME], const take *of)
{
    static const char ending[] = " copy";
    const size_t most = TAKE_NAME - sizeof ending;
    size_t length = strlen(of->name);
    if (length == 0) {
        (void)snprintf(out, TAKE_NAME, "copy of %u", of->number);
        return;
    }
    if (length > most)
        for (length = most; length > 0 && ((unsigned char)of->name[length] & 0xc0u) == 0x80u;)
            length -= 1;
    (void)snprintf(out, TAKE_NAME, "%.*s%s", (int)length, of->name, ending);
}

static mrt_result list_own(texts *out, const take *of, error *err)
{
    static const edit_kind own[] = {EDIT_TAKE_RENAME, EDIT_TAKE_DELETE};
    mrt_result result = MRT_OK;
    for (size_t i = 0; i < sizeof own / sizeof own[0] && result >= 0; ++i) {
        edit e;
        edit_init(&e, own[i]);
        if (own[i] == EDIT_TAKE_RENAME)
            name_copy(e.name, of);
        result = edit_write(&out->at[out->count], &e, err);
        out->count += result >= 0;
    }
    return result;
}

static mrt_result create_copy(show *s, const take *of, const texts *edits, int64_t (*utc_ms)(void),
                              int64_t *out_id, error *err)
{
    show_span *spans = NULL;
    size_t count = 0;
    char origin[96];
    mrt_result result = show_take_spans(s, of->id, &spans, &count, err);
    (void)snprintf(origin, sizeof origin, "a copy of take %lld", (long long)of->id);
    const show_new_take made = {.created_ns = utc_ms() * 1000000,
                                .start_ns = of->start_ns,
                                .end_ns = of->start_ns + of->duration_ns,
                                .scene = of->scene,
                                .shot = of->shot,
                                .origin = origin,
                                .spans = spans,
                                .span_count = count,
                                .base_edits = (const char *const *)edits->at,
                                .base_edit_count = edits->count,
                                .utc_ms = utc_ms()};
    if (result >= 0)
        result = show_take_create(s, &made, out_id, err);
    free(spans);
    return result;
}

static mrt_result bring_in(show *s, int64_t id, int64_t (*utc_ms)(void), error *err)
{
    edit e;
    char *json = NULL;
    edit_init(&e, EDIT_TAKE_RESTORE);
    mrt_result result = edit_write(&json, &e, err);
    if (result >= 0)
        result = show_edit_append(s, id, json, utc_ms(), NULL, 0, err);
    free(json);
    return result;
}

mrt_result edit_store_duplicate(show *s, int64_t take_id, int64_t (*utc_ms)(void), int64_t *out_id,
                                error *err)
{
    edit_store *self = NULL;
    take of = {0};
    texts edits = {0};
    *out_id = 0;
    mrt_result result = edit_store_open(&self, s, take_id, utc_ms, err);
    if (result < 0)
        return result;
    history_store list = edit_store_list(self);
    if (self->bare.is_recording)
        result = error_set(err, MRT_ERR_UNSUPPORTED,
                           "the take is being recorded: it can be duplicated when it has ended");
    if (result >= 0)
        result = history_fold(&of, &self->bare, &list, self->edits.head, NULL, err);
    edits.at = calloc(self->edits.count + 2, sizeof *edits.at);
    if (result >= 0 && !edits.at)
        result = error_set(err, MRT_ERR_MEMORY, "no memory for the edits of a take");
    if (result >= 0)
        result = list_in_force(&edits, &self->edits, err);
    if (result >= 0)
        result = list_own(&edits, &of, err);
    if (result >= 0) { /* recorded times; the edits then compute the shown times */
        of.start_ns = self->bare.start_ns;
        of.duration_ns = self->bare.duration_ns;
        result = create_copy(s, &of, &edits, utc_ms, out_id, err);
    }
    if (result >= 0)
        result = bring_in(s, *out_id, utc_ms, err);
    finish_texts(&edits);
    take_finish(&of);
    edit_store_close(self);
    return result;
}
