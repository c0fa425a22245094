/* The show that a subcommand works on, and what in it is meant. */
#include "base/text.h"
#include "take.h"
#include "take/edit_store.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

take_name take_slate_text(const char *scene, const char *shot, uint32_t number)
{
    take_name out;
    (void)snprintf(out.text, sizeof out.text, "%s%s%s%s%u", scene, scene[0] ? "/" : "", shot,
                   shot[0] ? "/" : "", number);
    return out;
}

mrt_result take_open_show(take_call *call, error *err)
{
    static const show_mode modes[] = {
        [TAKE_READS] = SHOW_READ, [TAKE_WRITES] = SHOW_WRITE, [TAKE_RECORDS] = SHOW_RECORD};
    const show_mode mode = modes[call->verb->use];
    const bool writes = mode != SHOW_READ;
    mrt_result result = show_open(&call->show, call->word[0], mode, err);
    if (result < 0)
        return result;
    if (mode != SHOW_RECORD)
        show_limit_work(call->show);
    const char *notice = show_notice(call->show);
    if (writes && !show_is_writable(call->show))
        return error_set(err, MRT_ERR_IO, "%s", notice);
    if (notice[0])
        fprintf(stderr, "note: %s\n", notice);
    return MRT_OK;
}

/* ---- which take ---- */

static void list_ids(char *out, size_t capacity, const show_take *takes, size_t count)
{
    size_t used = 0;
    out[0] = '\0';
    for (size_t i = 0; i < count && used + 24 < capacity; ++i)
        used += (size_t)snprintf(out + used, capacity - used, "%s%lld", i ? ", " : "",
                                 (long long)takes[i].id);
}

/* The slate is an edit away from how the take was made. */
static bool has_slate(take_call *call, const show_take *of, const char *text)
{
    take t;
    error ignored = {""};
    mrt_result result = edit_store_take_of(&t, call->show, of, &ignored);
    bool is_named =
        result >= 0 && strcmp(take_slate_text(t.scene, t.shot, t.number).text, text) == 0;
    take_finish(&t);
    return is_named;
}

static int64_t find_among(take_call *call, const char *text, const show_take *takes, size_t count)
{
    int64_t id;
    if (count > 0 && strcmp(text, "last") == 0)
        return takes[count - 1].id;
    if (text_int(text_view_of(text, strlen(text)), &id)) {
        for (size_t i = 0; i < count; ++i)
            if (takes[i].id == id)
                return id;
        return 0;
    }
    for (size_t i = count; strchr(text, '/') && i-- > 0;)
        if (has_slate(call, &takes[i], text))
            return takes[i].id;
    return 0;
}

mrt_result take_find(take_call *call, const char *text, int64_t *out_id, error *err)
{
    show_take *takes;
    size_t count;
    mrt_result result = show_takes(call->show, &takes, &count, err);
    if (result < 0)
        return result;
    *out_id = find_among(call, text, takes, count);
    char ids[200];
    list_ids(ids, sizeof ids, takes, count);
    free(takes);
    if (*out_id)
        return MRT_OK;
    if (count == 0)
        return error_set(err, MRT_ERR_ARGUMENT, "%s: has no takes yet: marotte perform --record %s",
                         call->word[0], call->word[0]);
    return error_set(err, MRT_ERR_ARGUMENT,
                     "%s: has no take \"%.80s\": there are %s; \"last\" or SCENE/SHOT/NUMBER are "
                     "possible too",
                     call->word[0], text, ids);
}

mrt_result take_read(take_call *call, const char *text, take *out, error *err)
{
    int64_t id;
    *out = (take){0};
    mrt_result result = take_find(call, text, &id, err);
    if (result < 0)
        return result;
    error why = {""};
    result = edit_store_take(out, call->show, id, &why);
    if (result >= 0)
        return MRT_OK;
    if (out->id == 0)
        return error_set(err, result, "%s", why.text);
    fprintf(stderr, "warning: take %lld: %s; what was before that edit is used\n", (long long)id,
            why.text);
    return MRT_OK;
}

/* ---- which clip, which layer ---- */

static mrt_result id_of(take_call *call, take_option option, uint32_t *out, error *err)
{
    double number = 0.0;
    mrt_result result = take_number(call, option, 1, 4e9, &number, err);
    *out = (uint32_t)number;
    return result;
}

static bool is_at(const take_layer *layer, const take_clip *c, int64_t at_ns)
{
    return at_ns == EDIT_UNSAID ||
           (c->start_ns + layer->offset_ns <= at_ns && at_ns < c->end_ns + layer->offset_ns);
}

mrt_result take_find_clip(take_call *call, const take *t, int64_t at_ns, uint32_t *out, error *err)
{
    uint32_t count = 0;
    if (call->text[TAKE_CLIP])
        return id_of(call, TAKE_CLIP, out, err);
    for (uint32_t i = 0; i < t->layer_count; ++i)
        for (uint32_t k = 0; k < t->layer[i].clip_count; ++k)
            if (is_at(&t->layer[i], &t->layer[i].clip[k], at_ns)) {
                *out = t->layer[i].clip[k].id;
                count += 1;
            }
    if (count == 1)
        return MRT_OK;
    if (count == 0)
        return error_set(err, MRT_ERR_ARGUMENT, "take %lld shows no clip%s", (long long)t->id,
                         at_ns == EDIT_UNSAID ? "" : " at that instant");
    return take_misused(call, err,
                        "take %lld shows %u clips%s: --clip N says which (marotte take show)",
                        (long long)t->id, count, at_ns == EDIT_UNSAID ? "" : " at that instant");
}

mrt_result take_find_layer(take_call *call, const take *t, uint32_t *out, error *err)
{
    const char *text = call->text[TAKE_LAYER];
    if (!text && t->layer_count == 1) {
        *out = t->layer[0].id;
        return MRT_OK;
    }
    if (!text)
        return take_misused(call, err, "take %lld has %u layers: --layer N or its name says which",
                            (long long)t->id, t->layer_count);
    for (uint32_t i = 0; i < t->layer_count; ++i)
        if (strcmp(t->layer[i].name, text) == 0) {
            *out = t->layer[i].id;
            return MRT_OK;
        }
    int64_t id;
    if (!text_int(text_view_of(text, strlen(text)), &id) || id < 1 || id > UINT32_MAX - 1)
        return error_set(err, MRT_ERR_ARGUMENT, "take %lld has no layer \"%.80s\"",
                         (long long)t->id, text);
    *out = (uint32_t)id;
    return MRT_OK;
}
