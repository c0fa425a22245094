#include "take_change.h"
#include "base/clock.h"

#include "base/text.h"
#include "take/own.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

edit *take_change_add(take_change *change, edit_kind kind)
{
    edit *out = &change->edit[change->count++];
    edit_init(out, kind);
    return out;
}

/* ---- names in a list ---- */

static mrt_result next_name(take_call *call, text_view *rest, char out[TAKE_NAME], error *err)
{
    text_view field;
    if (!text_next_field(rest, ',', &field))
        return MRT_END;
    size_t length = (size_t)(field.end - field.at);
    if (length == 0 || length >= TAKE_NAME)
        return take_misused(call, err, "a name in a list has no or more than %d letters",
                            TAKE_NAME - 1);
    text_copy(out, TAKE_NAME, field);
    return MRT_OK;
}

mrt_result take_read_own(take_call *call, const char *text, edit *out, error *err)
{
    text_view rest = text_view_of(text, strlen(text));
    out->own = calloc(EDIT_OWN_MAX, sizeof *out->own);
    if (!out->own)
        return error_set(err, MRT_ERR_MEMORY, "no memory for an edit");
    for (;;) {
        char name[TAKE_NAME];
        mrt_result result = next_name(call, &rest, name, err);
        if (result != MRT_OK)
            return result == MRT_END ? MRT_OK : result;
        own_region region;
        bool is_region = own_region_named(name, &region);
        const own_part *part = is_region ? own_part_of(region) : NULL;
        for (uint32_t i = 0; i < (part ? part->pattern_count : 1); ++i) {
            if (out->own_count == EDIT_OWN_MAX)
                return take_misused(call, err, "at most %d patterns are possible", EDIT_OWN_MAX);
            (void)snprintf(out->own[out->own_count++], TAKE_NAME, "%s",
                           part ? part->pattern[i] : name);
        }
    }
}

mrt_result take_read_regions(take_call *call, const char *text, uint32_t *out, error *err)
{
    text_view rest = text_view_of(text, strlen(text));
    *out = 0;
    for (;;) {
        char name[TAKE_NAME];
        own_region region;
        mrt_result result = next_name(call, &rest, name, err);
        if (result != MRT_OK)
            return result == MRT_END ? MRT_OK : result;
        if (!own_region_named(name, &region))
            return take_misused(call, err,
                                "\"%s\" is no region: mouth, jaw, brows, lids, eyes, cheeks, nose, "
                                "head are",
                                name);
        *out |= 1u << region;
    }
}

/* ---- done ---- */

static mrt_result do_all(take_call *call, history *of, const take_change *change, error *err)
{
    for (uint32_t i = 0; i < change->count; ++i) {
        mrt_result result = history_do(of, &change->edit[i], err);
        if (result < 0)
            return result;
        facts_list(call->told, "edits", "edit", history_words(of, history_head(of)));
    }
    const take *now = history_take(of);
    facts_text(call->told, "take", "take",
               take_slate_text(now->scene, now->shot, now->number).text);
    facts_number(call->told, "take_id", "take id", (double)now->id, 0, "");
    facts_number(call->told, "duration_s", "duration", (double)now->duration_ns / 1e9, 3, "s");
    facts_number(call->told, "edits_in_force", "edits in force", (double)history_head(of), 0, "");
    return MRT_OK;
}

mrt_result take_change_run(take_call *call,
                           mrt_result (*ask)(take_call *call, const take *t, take_change *out,
                                             error *err),
                           error *err)
{
    int64_t id;
    edit_store *store;
    history *of;
    mrt_result result = take_find(call, call->word[1], &id, err);
    if (result >= 0)
        result = edit_store_open(&store, call->show, id, clock_utc_ms, err);
    if (result < 0)
        return result;
    history_store list = edit_store_list(store);
    result = history_open(&of, edit_store_bare(store), &list, err);
    if (result >= 0) {
        take_change change = {.count = 0};
        result = ask(call, history_take(of), &change, err);
        if (result >= 0)
            result = do_all(call, of, &change, err);
        for (uint32_t i = 0; i < change.count; ++i)
            edit_finish(&change.edit[i]);
        history_close(of);
    }
    edit_store_close(store);
    return result;
}
