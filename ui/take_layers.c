/* Subcommands that edit the layers of a take, and what they take from other takes. */
#include "take/own.h"
#include "base/clock.h"
#include "take_change.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- one layer: SHOW TAKE LAYER [VALUE] ---- */

static mrt_result named_layer(take_call *call, const take *t, take_change *out, edit_kind kind,
                              edit **out_edit, error *err)
{
    *out_edit = take_change_add(out, kind);
    call->text[TAKE_LAYER] = call->word[2];
    return take_find_layer(call, t, &(*out_edit)->layer, err);
}

static mrt_result put_name(take_call *call, char out[TAKE_NAME], const char *text, error *err)
{
    if (strlen(text) >= TAKE_NAME)
        return take_misused(call, err, "a name has at most %d bytes", TAKE_NAME - 1);
    (void)snprintf(out, TAKE_NAME, "%s", text);
    return MRT_OK;
}

static mrt_result ask_add(take_call *call, const take *t, take_change *out, error *err)
{
    (void)t;
    edit *e = take_change_add(out, EDIT_LAYER_ADD);
    double place = -1.0;
    mrt_result result = put_name(call, e->name, call->word[2], err);
    if (result >= 0 && call->text[TAKE_OWN])
        result = take_read_own(call, call->text[TAKE_OWN], e, err);
    if (result >= 0)
        result = take_number(call, TAKE_PLACE, 0, EDIT_LAYERS_MAX - 1, &place, err);
    if (place >= 0.0)
        e->place = (uint32_t)place;
    return result;
}

static mrt_result ask_remove(take_call *call, const take *t, take_change *out, error *err)
{
    edit *e = NULL;
    return named_layer(call, t, out, EDIT_LAYER_REMOVE, &e, err);
}

static mrt_result ask_name(take_call *call, const take *t, take_change *out, error *err)
{
    edit *e = NULL;
    mrt_result result = named_layer(call, t, out, EDIT_LAYER_RENAME, &e, err);
    return result < 0 ? result : put_name(call, e->name, call->word[3], err);
}

static mrt_result ask_own(take_call *call, const take *t, take_change *out, error *err)
{
    edit *e = NULL;
    mrt_result result = named_layer(call, t, out, EDIT_LAYER_OWN, &e, err);
    bool owns_all = strcmp(call->word[3], "all") == 0;
    return result < 0 || owns_all ? result : take_read_own(call, call->word[3], e, err);
}

static mrt_result ask_mute(take_call *call, const take *t, take_change *out, error *err)
{
    edit *e = NULL;
    mrt_result result = named_layer(call, t, out, EDIT_LAYER_MUTE, &e, err);
    e->is_muted = call->text[TAKE_OFF] == NULL;
    return result;
}

static mrt_result ask_solo(take_call *call, const take *t, take_change *out, error *err)
{
    edit *e = NULL;
    mrt_result result = named_layer(call, t, out, EDIT_LAYER_SOLO, &e, err);
    e->is_solo = call->text[TAKE_OFF] == NULL;
    return result;
}

static mrt_result ask_additive(take_call *call, const take *t, take_change *out, error *err)
{
    edit *e = NULL;
    mrt_result result = named_layer(call, t, out, EDIT_LAYER_ADDITIVE, &e, err);
    e->is_additive = call->text[TAKE_OFF] == NULL;
    return result;
}

static mrt_result ask_gain(take_call *call, const take *t, take_change *out, error *err)
{
    edit *e = NULL;
    mrt_result result = named_layer(call, t, out, EDIT_LAYER_GAIN, &e, err);
    return result < 0 ? result
                      : take_number_of(call, "GAIN", call->word[3], 0.0, 10.0, &e->gain, err);
}

static mrt_result ask_offset(take_call *call, const take *t, take_change *out, error *err)
{
    edit *e = NULL;
    double offset_s = 0.0;
    mrt_result result = named_layer(call, t, out, EDIT_LAYER_OFFSET, &e, err);
    if (result >= 0)
        result = take_number_of(call, "SECONDS", call->word[3], -1e6, 1e6, &offset_s, err);
    e->offset_ns = llround(offset_s * 1e9);
    return result;
}

static mrt_result ask_order(take_call *call, const take *t, take_change *out, error *err)
{
    edit *e = NULL;
    double place = 0.0;
    mrt_result result = named_layer(call, t, out, EDIT_LAYER_ORDER, &e, err);
    if (result >= 0)
        result = take_number_of(call, "PLACE", call->word[3], 0, EDIT_LAYERS_MAX - 1, &place, err);
    e->place = (uint32_t)place;
    return result;
}

/* ---- what another take shows ---- */

static bool can_speak_of(const take_layer *layer, const edit *e)
{
    bool is_any = layer->own_count == 0 || (e->regions == 0 && e->own_count == 0);
    for (uint32_t i = 0; i < layer->own_count && !is_any; ++i) {
        for (uint32_t k = 0; k < e->own_count; ++k)
            is_any |= own_patterns_meet(layer->own[i], e->own[k]);
        for (uint32_t region = 0; region < OWN_REGION_COUNT; ++region) {
            const own_part *part = own_part_of((own_region)region);
            for (uint32_t k = 0; e->regions & 1u << region && k < part->pattern_count; ++k)
                is_any |= own_patterns_meet(layer->own[i], part->pattern[k]);
        }
    }
    return is_any;
}

/* The topmost clip that speaks of what is wanted at that instant. */
static const take_clip *find_material(const take *of, const edit *e, int64_t at_ns,
                                      int64_t *out_at_ns)
{
    for (uint32_t i = of->layer_count; i-- > 0;) {
        take_voice voice[2];
        if (!own_layer_is_heard(of, i) || !can_speak_of(&of->layer[i], e))
            continue;
        if (take_at(voice, &of->layer[i], at_ns) > 0) {
            *out_at_ns = at_ns - of->layer[i].offset_ns;
            return voice[0].clip;
        }
    }
    return NULL;
}

/* At its speed there, be it a curve. later_ns: from the clip's time to that of the edit. */
static mrt_result put_material(edit *e, const take_clip *c, int64_t at_ns, int64_t later_ns,
                               error *err)
{
    e->performance = c->performance;
    e->from_ns = c->from_ns;
    e->to_ns = c->to_ns;
    if (c->warp_count == 1) {
        e->source_ns = take_warp_to_source(c, at_ns);
        return MRT_OK;
    }
    e->warp = calloc(c->warp_count, sizeof *e->warp);
    if (!e->warp)
        return error_set(err, MRT_ERR_MEMORY, "no memory for an edit");
    e->warp_count = c->warp_count;
    for (uint32_t i = 0; i < c->warp_count; ++i)
        e->warp[i] = (take_warp_point){c->warp[i].at_ns + later_ns, c->warp[i].source_ns};
    return MRT_OK;
}

static mrt_result read_material(take_call *call, edit *e, error *err)
{
    take of;
    int64_t at_ns = e->in_ns, clip_at_ns = 0;
    mrt_result result = take_need(call, TAKE_FROM, err);
    if (result >= 0)
        result = take_read(call, call->text[TAKE_FROM], &of, err);
    if (result < 0)
        return result;
    result = take_time(call, TAKE_SOURCE, &of, &at_ns, err);
    const take_clip *c = result < 0 ? NULL : find_material(&of, e, at_ns, &clip_at_ns);
    if (c)
        result = put_material(e, c, clip_at_ns, e->in_ns - clip_at_ns, err);
    else if (result >= 0)
        result = error_set(err, MRT_ERR_ARGUMENT, "take %lld shows nothing of that at %.9g s",
                           (long long)of.id, (double)at_ns / 1e9);
    take_finish(&of);
    return result;
}

static mrt_result read_span(take_call *call, const take *t, edit *e, error *err)
{
    double fade_s = 0.1;
    mrt_result result = take_need(call, TAKE_IN, err);
    if (result >= 0)
        result = take_need(call, TAKE_OUT, err);
    if (result >= 0)
        result = take_time(call, TAKE_IN, t, &e->in_ns, err);
    if (result >= 0)
        result = take_time(call, TAKE_OUT, t, &e->out_ns, err);
    if (result >= 0)
        result = take_number(call, TAKE_FADE, 0.0, 1e6, &fade_s, err);
    e->fade_ns = llround(fade_s * 1e9);
    return result;
}

static mrt_result ask_comp(take_call *call, const take *t, take_change *out, error *err)
{
    edit *e = take_change_add(out, EDIT_COMP);
    if ((call->text[TAKE_REGION] == NULL) == (call->text[TAKE_OWN] == NULL))
        return take_misused(call, err, "either --region or --own is wanted");
    mrt_result result = read_span(call, t, e, err);
    if (result >= 0)
        result = call->text[TAKE_REGION]
                     ? take_read_regions(call, call->text[TAKE_REGION], &e->regions, err)
                     : take_read_own(call, call->text[TAKE_OWN], e, err);
    return result < 0 ? result : read_material(call, e, err);
}

static mrt_result ask_punch(take_call *call, const take *t, take_change *out, error *err)
{
    edit *e = take_change_add(out, EDIT_PUNCH);
    mrt_result result = read_span(call, t, e, err);
    if (result >= 0)
        result = take_find_layer(call, t, &e->layer, err);
    return result < 0 ? result : read_material(call, e, err);
}

/* ---- back and forth ---- */

static mrt_result step(take_call *call, history *of, bool is_undo, error *err)
{
    double wanted = 1.0;
    mrt_result result = take_number(call, TAKE_STEPS, 1, 1e6, &wanted, err);
    for (double i = 0.0; i < wanted && result >= 0; i += 1.0) {
        int64_t n = history_head(of) + (is_undo ? 0 : 1);
        char words[EDIT_TEXT];
        (void)snprintf(words, sizeof words, "%s", history_words(of, n));
        result = is_undo ? history_undo(of, err) : history_redo(of, err);
        if (result == MRT_END && i < 0.5)
            return error_set(err, MRT_ERR_ARGUMENT, "there is nothing to %s",
                             is_undo ? "undo" : "redo");
        if (result == MRT_END)
            return MRT_OK;
        if (result >= 0)
            facts_list(call->told, "edits", is_undo ? "undone" : "done again", words);
    }
    return result;
}

static void tell_history(take_call *call, const history *of)
{
    for (int64_t n = 1; n <= history_last(of); ++n) {
        char label[32];
        bool is_undone = n > history_head(of);
        (void)snprintf(label, sizeof label, "%lld%s", (long long)n, is_undone ? " (undone)" : "");
        facts_list(call->told, is_undone ? "undone" : "edits", label, history_words(of, n));
    }
}

static mrt_result with_history(take_call *call, int what, error *err)
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
        if (what == 0)
            tell_history(call, of);
        else
            result = step(call, of, what < 0, err);
        if (result >= 0) {
            facts_number(call->told, "edits_in_force", "edits in force", (double)history_head(of),
                         0, "");
            facts_number(call->told, "edit_count", "of", (double)history_last(of), 0, "");
        }
        history_close(of);
    }
    edit_store_close(store);
    return result;
}

static mrt_result run_undo(take_call *call, error *err)
{
    return with_history(call, -1, err);
}

static mrt_result run_redo(take_call *call, error *err)
{
    return with_history(call, 1, err);
}

static mrt_result run_history(take_call *call, error *err)
{
    return with_history(call, 0, err);
}

#define RUN(name)                                                                                  \
    static mrt_result run_##name(take_call *call, error *err)                                      \
    {                                                                                              \
        return take_change_run(call, ask_##name, err);                                             \
    }
RUN(add)
RUN(remove)
RUN(name)
RUN(own)
RUN(mute)
RUN(solo)
RUN(additive)
RUN(gain)
RUN(offset)
RUN(order)
RUN(comp)
RUN(punch)

#define OFF_HELP "  --off        no longer\n"
#define OWN_HELP                                                                                   \
    "  mouth, jaw, brows, lids, eyes, cheeks, nose, head, or patterns of names of contacts and\n"  \
    "  degrees of freedom (\"mouth.*,jaw.open\")\n"
#define SPAN_HELP                                                                                  \
    "  --from TAKE  the other take\n  --in T --out T   the span\n"                                 \
    "  --source T   what of the other take is shown at --in (the same time)\n"                     \
    "  --fade S     cross-fades at both ends (0.1)\n"                                              \
    "  --fps RATE   of time code, where a take has no frame rate\n"
#define SPAN_BITS                                                                                  \
    (TAKE_BIT(TAKE_FROM) | TAKE_BIT(TAKE_IN) | TAKE_BIT(TAKE_OUT) | TAKE_BIT(TAKE_SOURCE) |        \
     TAKE_BIT(TAKE_FADE) | TAKE_BIT(TAKE_FPS))

static const take_verb layer_verbs[] = {
    {"layer add", "SHOW TAKE NAME",
     "  --own NAMES  what it moves (all):\n" OWN_HELP
     "  --place N    from the bottom, 0 (on top)\n",
     "adds a layer", TAKE_BIT(TAKE_OWN) | TAKE_BIT(TAKE_PLACE), TAKE_WRITES, run_add},
    {"layer remove", "SHOW TAKE LAYER", "", "removes a layer", 0, TAKE_WRITES, run_remove},
    {"layer rename", "SHOW TAKE LAYER NAME", "", "names a layer", 0, TAKE_WRITES, run_name},
    {"layer own", "SHOW TAKE LAYER NAMES", "  NAMES: all, or\n" OWN_HELP, "what a layer moves", 0,
     TAKE_WRITES, run_own},
    {"layer mute", "SHOW TAKE LAYER", OFF_HELP, "mutes a layer", TAKE_BIT(TAKE_OFF), TAKE_WRITES,
     run_mute},
    {"layer solo", "SHOW TAKE LAYER", OFF_HELP, "only solo layers are heard", TAKE_BIT(TAKE_OFF),
     TAKE_WRITES, run_solo},
    {"layer additive", "SHOW TAKE LAYER", OFF_HELP, "adds to the layers below", TAKE_BIT(TAKE_OFF),
     TAKE_WRITES, run_additive},
    {"layer gain", "SHOW TAKE LAYER GAIN", "", "how much of a layer: 0 to 10", 0, TAKE_WRITES,
     run_gain},
    {"layer offset", "SHOW TAKE LAYER SECONDS", "", "shows a layer later, or earlier", 0,
     TAKE_WRITES, run_offset},
    {"layer order", "SHOW TAKE LAYER PLACE", "", "moves a layer to a place from the bottom, 0", 0,
     TAKE_WRITES, run_order},
    {"comp", "SHOW TAKE",
     "  --region R,R or --own NAMES   which parts of the face:\n" OWN_HELP SPAN_HELP,
     "takes parts of the face from another take",
     SPAN_BITS | TAKE_BIT(TAKE_REGION) | TAKE_BIT(TAKE_OWN), TAKE_WRITES, run_comp},
    {"punch", "SHOW TAKE", "  --layer L    which layer, by its number or name\n" SPAN_HELP,
     "a layer shows a span of another take", SPAN_BITS | TAKE_BIT(TAKE_LAYER), TAKE_WRITES,
     run_punch},
    {"undo", "SHOW TAKE", "  --steps N    so many edits (1)\n", "undoes the last edit",
     TAKE_BIT(TAKE_STEPS), TAKE_WRITES, run_undo},
    {"redo", "SHOW TAKE", "  --steps N    so many edits (1)\n", "does again what was undone",
     TAKE_BIT(TAKE_STEPS), TAKE_WRITES, run_redo},
    {"history", "SHOW TAKE", "", "all edits in words", 0, TAKE_READS, run_history},
};
const take_verbs take_layer_verbs = {"Layers, other takes, undo", layer_verbs,
                                     sizeof layer_verbs / sizeof layer_verbs[0]};
