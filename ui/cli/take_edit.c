#include "cli/take.h"

#include "base/clock.h"
#include "base/text.h"
#include "show/edit_store.h"
#include "show/own.h"
#include "show/sound_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- a list of edits, applied to a take through its history ---- */

/* Returns the next free edit of the list. */
static edit *take_change_add(take_change *change, edit_kind kind)
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
        return take_misused(call, err, "a name in the list is empty or longer than %d letters",
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
            return take_misused(
                call, err,
                "\"%s\" is not a region: mouth, jaw, brows, lids, eyes, cheeks, nose or head",
                name);
        *out |= 1u << region;
    }
}

/* ---- applying edits ---- */

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

static mrt_result change(take_call *call, history *of, error *err)
{
    take_change wanted = {.count = 0};
    mrt_result result = call->verb->ask(call, history_take(of), &wanted, err);
    if (result >= 0)
        result = do_all(call, of, &wanted, err);
    for (uint32_t i = 0; i < wanted.count; ++i)
        edit_finish(&wanted.edit[i]);
    return result;
}

/* Opens the take on the command line, and calls `work` with its history. */
static mrt_result with_history(take_call *call,
                               mrt_result (*work)(take_call *call, history *of, error *err),
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
        result = work(call, of, err);
        history_close(of);
    }
    edit_store_close(store);
    return result;
}

mrt_result take_change_run(take_call *call, error *err)
{
    return with_history(call, change, err);
}

/* Reads --in and --out; both are required. */
static mrt_result read_in_out(take_call *call, const take *t, edit *e, error *err)
{
    mrt_result result = take_need(call, TAKE_IN, err);
    if (result >= 0)
        result = take_need(call, TAKE_OUT, err);
    if (result >= 0)
        result = take_time(call, TAKE_IN, t, &e->in_ns, err);
    return result < 0 ? result : take_time(call, TAKE_OUT, t, &e->out_ns, err);
}

/* ---- clips ---- */

static mrt_result make_trim(take_call *call, const take *t, take_change *out, error *err)
{
    if (!call->text[TAKE_IN] && !call->text[TAKE_OUT])
        return take_misused(call, err, "--in or --out is missing");
    bool is_clip = call->text[TAKE_CLIP] != NULL;
    edit *e = take_change_add(out, is_clip ? EDIT_CLIP_TRIM : EDIT_RANGE_KEEP);
    int64_t *from = is_clip ? &e->start_ns : &e->in_ns, *until = is_clip ? &e->end_ns : &e->out_ns;
    if (!is_clip) {
        *from = 0;
        *until = t->duration_ns;
    }
    mrt_result result = take_time(call, TAKE_IN, t, from, err);
    if (result >= 0)
        result = take_time(call, TAKE_OUT, t, until, err);
    return result < 0 || !is_clip ? result : take_find_clip(call, t, EDIT_UNSAID, &e->clip, err);
}

static mrt_result make_split(take_call *call, const take *t, take_change *out, error *err)
{
    edit *e = take_change_add(out, EDIT_CLIP_SPLIT);
    mrt_result result = take_need(call, TAKE_AT, err);
    if (result >= 0)
        result = take_time(call, TAKE_AT, t, &e->at_ns, err);
    return result < 0 ? result : take_find_clip(call, t, e->at_ns, &e->clip, err);
}

static mrt_result make_move(take_call *call, const take *t, take_change *out, error *err)
{
    edit *e = take_change_add(out, EDIT_CLIP_MOVE);
    if (!call->text[TAKE_TO] && !call->text[TAKE_LAYER])
        return take_misused(call, err, "--to or --layer is missing");
    mrt_result result = take_find_clip(call, t, EDIT_UNSAID, &e->clip, err);
    if (result >= 0)
        result = take_time(call, TAKE_TO, t, &e->start_ns, err);
    if (result >= 0 && call->text[TAKE_LAYER])
        result = take_find_layer(call, t, &e->layer, err);
    return result;
}

/* Reads "0:0,2:1.5": pairs of timeline and source, in seconds. */
static mrt_result read_points(take_call *call, const char *text, edit *out, error *err)
{
    text_view rest = text_view_of(text, strlen(text)), field, half;
    out->warp = calloc(EDIT_WARP_MAX, sizeof *out->warp);
    if (!out->warp)
        return error_set(err, MRT_ERR_MEMORY, "no memory for an edit");
    while (text_next_field(&rest, ',', &field)) {
        double at_s, source_s;
        bool good = out->warp_count < EDIT_WARP_MAX && text_next_field(&field, ':', &half) &&
                    text_double(half, &at_s) && text_next_field(&field, ':', &half) &&
                    text_double(half, &source_s) && fabs(at_s) <= 1e6 && fabs(source_s) <= 1e6;
        if (!good)
            return take_misused(call, err,
                                "--points \"%.80s\" is not AT:SOURCE,AT:SOURCE... in seconds, at "
                                "most %d",
                                text, EDIT_WARP_MAX);
        out->warp[out->warp_count++] =
            (take_warp_point){llround(at_s * 1e9), llround(source_s * 1e9)};
    }
    return MRT_OK;
}

static mrt_result make_retime(take_call *call, const take *t, take_change *out, error *err)
{
    bool is_curve = call->text[TAKE_POINTS] != NULL;
    if (is_curve == (call->text[TAKE_SPEED] != NULL))
        return take_misused(call, err, "give either --speed or --points");
    edit *e = take_change_add(out, is_curve ? EDIT_CLIP_CURVE : EDIT_CLIP_SPEED);
    mrt_result result = take_find_clip(call, t, EDIT_UNSAID, &e->clip, err);
    if (result < 0)
        return result;
    if (is_curve)
        return read_points(call, call->text[TAKE_POINTS], e, err);
    result = take_number(call, TAKE_SPEED, 0.01, 100.0, &e->speed, err);
    return result < 0 ? result : take_time(call, TAKE_AT, t, &e->at_ns, err);
}

static mrt_result make_smooth(take_call *call, const take *t, take_change *out, error *err)
{
    edit *e = take_change_add(out, EDIT_CLIP_SMOOTH);
    mrt_result result = take_find_clip(call, t, EDIT_UNSAID, &e->clip, err);
    return result < 0
               ? result
               : take_number_of(call, "SECONDS", call->word[2], 0.0, 10.0, &e->smooth_s, err);
}

/* Targets the layer if --layer is given, else a clip. */
static mrt_result make_target(take_call *call, const take *t, take_change *out, edit_kind of_layer,
                              edit_kind of_clip, edit **out_edit, error *err)
{
    bool is_layer = call->text[TAKE_LAYER] != NULL;
    if (is_layer && call->text[TAKE_CLIP])
        return take_misused(call, err, "give either --clip or --layer");
    edit *e = *out_edit = take_change_add(out, is_layer ? of_layer : of_clip);
    return is_layer ? take_find_layer(call, t, &e->layer, err)
                    : take_find_clip(call, t, EDIT_UNSAID, &e->clip, err);
}

static mrt_result make_mute(take_call *call, const take *t, take_change *out, error *err)
{
    edit *e = NULL;
    mrt_result result = make_target(call, t, out, EDIT_LAYER_MUTE, EDIT_CLIP_MUTE, &e, err);
    if (result >= 0)
        e->is_muted = call->text[TAKE_OFF] == NULL;
    return result;
}

static mrt_result make_gain(take_call *call, const take *t, take_change *out, error *err)
{
    edit *e = NULL;
    mrt_result result = make_target(call, t, out, EDIT_LAYER_GAIN, EDIT_CLIP_GAIN, &e, err);
    return result < 0 ? result
                      : take_number_of(call, "GAIN", call->word[2], 0.0, 10.0, &e->gain, err);
}

static mrt_result make_fade(take_call *call, const take *t, take_change *out, error *err)
{
    edit *e = take_change_add(out, EDIT_CLIP_FADE);
    if (!call->text[TAKE_FADE_IN] && !call->text[TAKE_FADE_OUT])
        return take_misused(call, err, "--fade-in or --fade-out is missing");
    mrt_result result = take_find_clip(call, t, EDIT_UNSAID, &e->clip, err);
    double in_s = 0.0, out_s = 0.0;
    if (result >= 0)
        result = take_number(call, TAKE_FADE_IN, 0.0, 1e6, &in_s, err);
    if (result >= 0)
        result = take_number(call, TAKE_FADE_OUT, 0.0, 1e6, &out_s, err);
    if (call->text[TAKE_FADE_IN])
        e->fade_in_ns = llround(in_s * 1e9);
    if (call->text[TAKE_FADE_OUT])
        e->fade_out_ns = llround(out_s * 1e9);
    return result;
}

static mrt_result make_cut(take_call *call, const take *t, take_change *out, error *err)
{
    edit *e = take_change_add(out, EDIT_RANGE_CUT);
    mrt_result result = read_in_out(call, t, e, err);
    e->is_ripple = call->text[TAKE_RIPPLE] != NULL;
    if (result >= 0 && call->text[TAKE_LAYER]) {
        e->layer_count = 1;
        result = take_find_layer(call, t, &e->layers[0], err);
    }
    return result;
}

static mrt_result make_insert(take_call *call, const take *t, take_change *out, error *err)
{
    edit *e = take_change_add(out, EDIT_RANGE_INSERT);
    mrt_result result = take_need(call, TAKE_AT, err);
    if (result >= 0)
        result = take_need(call, TAKE_LENGTH, err);
    if (result >= 0)
        result = take_time(call, TAKE_AT, t, &e->at_ns, err);
    double length_s = 0.0;
    if (result >= 0)
        result = take_number(call, TAKE_LENGTH, 1e-9, 1e6, &length_s, err);
    e->length_ns = llround(length_s * 1e9);
    return result;
}

static mrt_result make_delete(take_call *call, const take *t, take_change *out, error *err)
{
    bool is_clip = call->text[TAKE_CLIP] != NULL;
    edit *e = take_change_add(out, is_clip ? EDIT_CLIP_REMOVE : EDIT_TAKE_DELETE);
    return is_clip ? take_find_clip(call, t, EDIT_UNSAID, &e->clip, err) : MRT_OK;
}

/* ---- name, note, slate, markers and time code ---- */

static mrt_result copy_text(take_call *call, char *out, size_t size, const char *text, error *err)
{
    if (strlen(text) >= size)
        return take_misused(call, err, "\"%.40s...\" is too long: at most %zu bytes", text,
                            size - 1);
    memcpy(out, text, strlen(text) + 1);
    return MRT_OK;
}

static mrt_result make_slate(take_call *call, const take *t, take_change *out, error *err)
{
    edit *e = take_change_add(out, EDIT_TAKE_SLATE);
    double number = (double)t->number;
    const char *scene = call->text[TAKE_SCENE], *shot = call->text[TAKE_SHOT];
    if (!scene && !shot && !call->text[TAKE_NUMBER])
        return take_misused(call, err, "--scene, --shot or --number is missing");
    mrt_result result = copy_text(call, e->scene, sizeof e->scene, scene ? scene : t->scene, err);
    if (result >= 0)
        result = copy_text(call, e->shot, sizeof e->shot, shot ? shot : t->shot, err);
    if (result >= 0)
        result = take_number(call, TAKE_NUMBER, 1, 99999, &number, err);
    e->number = (uint32_t)number;
    return result;
}

/* SHOW TAKE [VALUE]: returns the edit of the verb's kind with that text or number. */
static mrt_result make_value(take_call *call, const take *t, take_change *out, error *err)
{
    const char *value = call->word[2];
    double number = 0.0;
    mrt_result result = MRT_OK;
    edit *e = take_change_add(out, call->verb->kind);
    (void)t;
    switch (e->kind) {
    case EDIT_TAKE_RENAME:
        return copy_text(call, e->name, sizeof e->name, value, err);
    case EDIT_TAKE_NOTE:
        return copy_text(call, e->note, sizeof e->note, value, err);
    case EDIT_TAKE_RATE:
        result = take_number_of(call, "STARS", value, 0, 5, &number, err);
        e->rating = (uint32_t)number;
        break;
    case EDIT_AUDIO_OFFSET:
        result = take_number_of(call, "SECONDS", value, -1e6, 1e6, &number, err);
        e->offset_ns = llround(number * 1e9);
        break;
    case EDIT_AUDIO_GAIN:
        return take_number_of(call, "GAIN", value, 0.0, 10.0, &e->gain, err);
    default: /* edits without a value */
        break;
    }
    return result;
}

static mrt_result make_mark(take_call *call, const take *t, take_change *out, error *err)
{
    edit *e = take_change_add(out, EDIT_MARKER_ADD);
    mrt_result result = take_need(call, TAKE_AT, err);
    if (result >= 0)
        result = take_time(call, TAKE_AT, t, &e->at_ns, err);
    return result < 0 ? result : copy_text(call, e->text, sizeof e->text, call->word[2], err);
}

static mrt_result make_timecode(take_call *call, const take *t, take_change *out, error *err)
{
    timecode_rate rate;
    if (!call->text[TAKE_FPS] && !call->text[TAKE_START])
        return take_misused(call, err, "--fps or --start is missing");
    mrt_result result = take_rate(call, t, &rate, err);
    if (result < 0)
        return result;
    if (call->text[TAKE_FPS])
        take_change_add(out, EDIT_TAKE_FPS)->fps = timecode_fps(rate);
    if (!call->text[TAKE_START])
        return MRT_OK;
    edit *e = take_change_add(out, EDIT_TAKE_TIMECODE);
    rate.is_drop = strchr(call->text[TAKE_START], ';') != NULL && timecode_can_drop(rate);
    e->is_drop = rate.is_drop;
    result = timecode_parse(&e->frame, rate, call->text[TAKE_START], err);
    call->is_usage = result < 0;
    return result;
}

static mrt_result make_edit(take_call *call, const take *t, take_change *out, error *err)
{
    (void)t;
    edit parsed;
    mrt_result result = edit_parse(&parsed, call->word[2], strlen(call->word[2]), err);
    if (result >= 0)
        out->edit[out->count++] = parsed;
    return result;
}

#define CLIP_HELP  "  --clip N     the clip's number (marotte take show); optional if there is one\n"
#define LAYER_HELP "  --layer L    the whole layer instead, by its number or name\n"
#define FPS_HELP   "  --fps RATE   frame rate for time code, if the take has none\n"

static const take_verb edit_verbs[] = {
    {"trim", "SHOW TAKE",
     "  --in T       start of the range (0)\n  --out T      end of the range\n"
     "  --clip N     trim this clip, not the take\n" FPS_HELP,
     "keep a range of a take", "in out clip fps", TAKE_WRITES, .ask = make_trim,
     .examples = "take trim show.marotte last --in 1 --out 3\n"
                 "take trim show.marotte 2 --in 01:00:00:12 --fps 25\n"},
    {"cut", "SHOW TAKE",
     "  --in T --out T   the range\n  --ripple     close the gap: later clips move up\n" LAYER_HELP
         FPS_HELP,
     "remove a range from a take", "in out ripple layer fps", TAKE_WRITES, .ask = make_cut,
     .examples = "take cut show.marotte last --in 1 --out 2\n"
                 "take cut show.marotte last --in 1 --out 2 --ripple\n"},
    {"insert", "SHOW TAKE",
     "  --at T       where the gap begins\n  --length S   its length in seconds\n" FPS_HELP,
     "insert a gap into a take", "at length fps", TAKE_WRITES, .ask = make_insert,
     .examples = "take insert show.marotte last --at 1 --length 0.5\n"
                 "take insert show.marotte 1 --at 01:00:01:00 --length 2\n"},
    {"split", "SHOW TAKE", "  --at T       where\n" CLIP_HELP FPS_HELP, "split a clip in two",
     "at clip fps", TAKE_WRITES, .ask = make_split,
     .examples = "take split show.marotte 2 --at 1.5\n"
                 "take split show.marotte 2 --at 01:00:01:12 --clip 2\n"},
    {"move", "SHOW TAKE",
     "  --to T       its new start\n  --layer L    move it to this layer\n" CLIP_HELP FPS_HELP,
     "move a clip", "to layer clip fps", TAKE_WRITES, .ask = make_move,
     .examples = "take move show.marotte 2 --to 0.5\n"
                 "take move show.marotte last --clip 4 --layer performance --to 5\n"},
    {"retime", "SHOW TAKE",
     "  --speed F    play it F times as fast\n  --at T       the instant that stays in place (its "
     "start)\n"
     "  --points A:S,A:S...   a curve: at A s of the timeline play the clip's second S\n" CLIP_HELP
         FPS_HELP,
     "play a clip faster, slower or along a curve", "speed at points clip fps", TAKE_WRITES,
     .ask = make_retime,
     .examples = "take retime show.marotte 2 --speed 0.5\n"
                 "take retime show.marotte 2 --points 0:0,1:0.5,4:4\n"},
    {"smooth", "SHOW TAKE SECONDS", CLIP_HELP, "smooth a clip; 0 ends the smoothing", "clip",
     TAKE_WRITES, .ask = make_smooth,
     .examples = "take smooth show.marotte 2 0.1\ntake smooth show.marotte 2 0\n"},
    {"mute", "SHOW TAKE", "  --off        unmute\n" CLIP_HELP LAYER_HELP, "mute a clip or a layer",
     "off clip layer", TAKE_WRITES, .ask = make_mute,
     .examples = "take mute show.marotte last --layer brows\n"
                 "take mute show.marotte last --layer brows --off\n"},
    {"gain", "SHOW TAKE GAIN", CLIP_HELP LAYER_HELP, "scale a clip or a layer, 0 to 10",
     "clip layer", TAKE_WRITES, .ask = make_gain,
     .examples = "take gain show.marotte 2 0.8\n"
                 "take gain show.marotte last 1.5 --layer brows\n"},
    {"fade", "SHOW TAKE", "  --fade-in S, --fade-out S   seconds\n" CLIP_HELP,
     "fade a clip in or out", "fade-in fade-out clip", TAKE_WRITES, .ask = make_fade,
     .examples = "take fade show.marotte 2 --fade-in 0.3\n"
                 "take fade show.marotte 2 --fade-in 0.3 --fade-out 0.5\n"},
    {"delete", "SHOW TAKE", "  --clip N     delete this clip, not the take\n",
     "delete a take; take restore brings it back", "clip", TAKE_WRITES, .ask = make_delete,
     .examples = "take delete show.marotte last\ntake delete show.marotte 2 --clip 2\n"},
    {"restore", "SHOW TAKE", "", "restore a deleted take", "", TAKE_WRITES, .ask = make_value,
     .kind = EDIT_TAKE_RESTORE,
     .examples = "take restore show.marotte 1\ntake restore show.marotte last\n"},
    {"rename", "SHOW TAKE NAME", "", "name a take", "", TAKE_WRITES, .ask = make_value,
     .kind = EDIT_TAKE_RENAME,
     .examples = "take rename show.marotte last best\n"
                 "take rename show.marotte 2 \"the laugh\"\n"},
    {"slate", "SHOW TAKE", "  --scene S, --shot S, --number N   the new values; the others stay\n",
     "change the slate of a take", "scene shot number", TAKE_WRITES, .ask = make_slate,
     .examples = "take slate show.marotte last --scene 12 --shot a\n"
                 "take slate show.marotte 2 --number 7\n"},
    {"note", "SHOW TAKE TEXT", "", "write a note on a take", "", TAKE_WRITES, .ask = make_value,
     .kind = EDIT_TAKE_NOTE,
     .examples = "take note show.marotte last \"good until the sneeze\"\n"
                 "take note show.marotte 2 safety\n"},
    {"rate", "SHOW TAKE STARS", "", "rate a take, 0 to 5 stars", "", TAKE_WRITES, .ask = make_value,
     .kind = EDIT_TAKE_RATE,
     .examples = "take rate show.marotte last 5\ntake rate show.marotte 2 0\n"},
    {"mark", "SHOW TAKE TEXT", "  --at T       where\n" FPS_HELP, "add a marker to a take",
     "at fps", TAKE_WRITES, .ask = make_mark,
     .examples = "take mark show.marotte last blink --at 1.2\n"
                 "take mark show.marotte 2 \"door slams\" --at 01:00:01:00\n"},
    {"timecode", "SHOW TAKE",
     "  --fps RATE   24, 25, 29.97, 30000/1001 ...\n"
     "  --start TC   time code of its first frame: 01:00:00:00, drop-frame 01:00:00;00\n",
     "set the frame rate and time code of a take", "fps start", TAKE_WRITES, .ask = make_timecode,
     .examples = "take timecode show.marotte last --fps 25 --start 01:00:00:00\n"
                 "take timecode show.marotte 1 --fps 29.97 --start \"01:00:00;00\"\n"},
    {"edit", "SHOW TAKE JSON",
     "  JSON: an edit as the show stores it: {\"op\":\"clip.trim\",\"clip\":2,\"start_ns\":0}\n",
     "apply any edit", "", TAKE_WRITES, .ask = make_edit,
     .examples = "take edit show.marotte last '{\"op\":\"take.rate\",\"rating\":4}'\n"
                 "take edit show.marotte 2 '{\"op\":\"take.note\",\"note\":\"again\"}'\n"},
};
const take_verbs take_edit_verbs = {"Edit", edit_verbs, sizeof edit_verbs / sizeof edit_verbs[0]};

/* ---- layers, and parts of other takes ---- */

/* ---- one layer: SHOW TAKE LAYER [VALUE] ---- */

static mrt_result copy_name(take_call *call, char out[TAKE_NAME], const char *text, error *err)
{
    if (strlen(text) >= TAKE_NAME)
        return take_misused(call, err, "a name has at most %d bytes", TAKE_NAME - 1);
    (void)snprintf(out, TAKE_NAME, "%s", text);
    return MRT_OK;
}

static mrt_result make_layer_add(take_call *call, const take *t, take_change *out, error *err)
{
    (void)t;
    edit *e = take_change_add(out, EDIT_LAYER_ADD);
    double position = -1.0;
    mrt_result result = copy_name(call, e->name, call->word[2], err);
    if (result >= 0 && call->text[TAKE_OWN])
        result = take_read_own(call, call->text[TAKE_OWN], e, err);
    if (result >= 0)
        result = take_number(call, TAKE_PLACE, 0, EDIT_LAYERS_MAX - 1, &position, err);
    if (position >= 0.0)
        e->place = (uint32_t)position;
    return result;
}

/* SHOW TAKE LAYER [VALUE]: returns the edit of the verb's kind with that value, or with --off. */
static mrt_result make_layer(take_call *call, const take *t, take_change *out, error *err)
{
    const char *value = call->word[3];
    const bool is_on = call->text[TAKE_OFF] == NULL;
    double number = 0.0;
    edit *e = take_change_add(out, call->verb->kind);
    call->text[TAKE_LAYER] = call->word[2];
    mrt_result result = take_find_layer(call, t, &e->layer, err);
    if (result < 0)
        return result;
    switch (e->kind) {
    case EDIT_LAYER_RENAME:
        return copy_name(call, e->name, value, err);
    case EDIT_LAYER_OWN:
        return strcmp(value, "all") == 0 ? MRT_OK : take_read_own(call, value, e, err);
    case EDIT_LAYER_MUTE:
        e->is_muted = is_on;
        break;
    case EDIT_LAYER_SOLO:
        e->is_solo = is_on;
        break;
    case EDIT_LAYER_ADDITIVE:
        e->is_additive = is_on;
        break;
    case EDIT_LAYER_GAIN:
        return take_number_of(call, "GAIN", value, 0.0, 10.0, &e->gain, err);
    case EDIT_LAYER_OFFSET:
        result = take_number_of(call, "SECONDS", value, -1e6, 1e6, &number, err);
        e->offset_ns = llround(number * 1e9);
        break;
    case EDIT_LAYER_ORDER:
        result = take_number_of(call, "PLACE", value, 0, EDIT_LAYERS_MAX - 1, &number, err);
        e->place = (uint32_t)number;
        break;
    default: /* EDIT_LAYER_REMOVE has no value */
        break;
    }
    return result;
}

/* ---- material from another take ---- */

static bool can_speak_of(const take_layer *on, const edit *e)
{
    bool is_any = on->own_count == 0 || (e->regions == 0 && e->own_count == 0);
    for (uint32_t i = 0; i < on->own_count && !is_any; ++i) {
        for (uint32_t k = 0; k < e->own_count; ++k)
            is_any |= own_patterns_overlap(on->own[i], e->own[k]);
        for (uint32_t region = 0; region < OWN_REGION_COUNT; ++region) {
            const own_part *part = own_part_of((own_region)region);
            for (uint32_t k = 0; e->regions & 1u << region && k < part->pattern_count; ++k)
                is_any |= own_patterns_overlap(on->own[i], part->pattern[k]);
        }
    }
    return is_any;
}

/* Finds the topmost clip at that instant that moves the wanted parts. */
static const take_clip *find_material(const take *of, const edit *e, int64_t at_ns,
                                      int64_t *out_at_ns)
{
    for (uint32_t i = of->layer_count; i-- > 0;) {
        take_voice voice[2];
        if (!own_layer_is_active(of, i) || !can_speak_of(&of->layer[i], e))
            continue;
        if (take_at(voice, &of->layer[i], at_ns) > 0) {
            *out_at_ns = at_ns - of->layer[i].offset_ns;
            return voice[0].clip;
        }
    }
    return NULL;
}

/* Copies the clip's speed or curve into the edit. later_ns: from the clip's time to that of the
 * edit. */
static mrt_result copy_material(edit *e, const take_clip *c, int64_t at_ns, int64_t later_ns,
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
        result = copy_material(e, c, clip_at_ns, e->in_ns - clip_at_ns, err);
    else if (result >= 0)
        result = error_set(err, MRT_ERR_ARGUMENT, "take %lld does not move these parts at %.9g s",
                           (long long)of.id, (double)at_ns / 1e9);
    take_finish(&of);
    return result;
}

static mrt_result read_span(take_call *call, const take *t, edit *e, error *err)
{
    double fade_s = 0.1;
    mrt_result result = read_in_out(call, t, e, err);
    if (result >= 0)
        result = take_number(call, TAKE_FADE, 0.0, 1e6, &fade_s, err);
    e->fade_ns = llround(fade_s * 1e9);
    return result;
}

static mrt_result make_layer_comp(take_call *call, const take *t, take_change *out, error *err)
{
    edit *e = take_change_add(out, EDIT_COMP);
    if ((call->text[TAKE_REGION] == NULL) == (call->text[TAKE_OWN] == NULL))
        return take_misused(call, err, "give either --region or --own");
    mrt_result result = read_span(call, t, e, err);
    if (result >= 0)
        result = call->text[TAKE_REGION]
                     ? take_read_regions(call, call->text[TAKE_REGION], &e->regions, err)
                     : take_read_own(call, call->text[TAKE_OWN], e, err);
    return result < 0 ? result : read_material(call, e, err);
}

static mrt_result make_layer_punch(take_call *call, const take *t, take_change *out, error *err)
{
    edit *e = take_change_add(out, EDIT_PUNCH);
    mrt_result result = read_span(call, t, e, err);
    if (result >= 0)
        result = take_find_layer(call, t, &e->layer, err);
    return result < 0 ? result : read_material(call, e, err);
}

/* ---- undo and redo ---- */

static mrt_result report_count(take_call *call, const history *of)
{
    facts_number(call->told, "edits_in_force", "edits in force", (double)history_head(of), 0, "");
    facts_number(call->told, "edit_count", "of", (double)history_last(of), 0, "");
    return MRT_OK;
}

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
            break;
        if (result >= 0)
            facts_list(call->told, "edits", is_undo ? "undone" : "redone", words);
    }
    return result < 0 ? result : report_count(call, of);
}

static mrt_result undo(take_call *call, history *of, error *err)
{
    return step(call, of, true, err);
}

static mrt_result redo(take_call *call, history *of, error *err)
{
    return step(call, of, false, err);
}

static mrt_result report_history(take_call *call, history *of, error *err)
{
    (void)err;
    for (int64_t n = 1; n <= history_last(of); ++n) {
        char label[32];
        bool is_undone = n > history_head(of);
        (void)snprintf(label, sizeof label, "%lld%s", (long long)n, is_undone ? " (undone)" : "");
        facts_list(call->told, is_undone ? "undone" : "edits", label, history_words(of, n));
    }
    return report_count(call, of);
}

static mrt_result run_undo(take_call *call, error *err)
{
    return with_history(call, undo, err);
}

static mrt_result run_redo(take_call *call, error *err)
{
    return with_history(call, redo, err);
}

static mrt_result run_history(take_call *call, error *err)
{
    return with_history(call, report_history, err);
}

#define OFF_HELP "  --off        switch it off again\n"
#define OWN_HELP                                                                                   \
    "               mouth, jaw, brows, lids, eyes, cheeks, nose, head, or patterns of contacts\n"  \
    "               and degrees of freedom (\"mouth.*,jaw.open\")\n"
#define SPAN_HELP                                                                                  \
    "  --from TAKE  the other take\n  --in T --out T   the span\n"                                 \
    "  --source T   the time in the other take that is shown at --in (the same time)\n"            \
    "  --fade S     cross-fade at both ends, seconds (0.1)\n"                                      \
    "  --fps RATE   frame rate for time code, if the take has none\n"
#define SPAN_OPTIONS "from in out source fade fps"

static const take_verb layer_verbs[] = {
    {"layer add", "SHOW TAKE NAME",
     "  --own NAMES  the parts of the face that it moves (all):\n" OWN_HELP
     "  --place N    its place, counted from the bottom, 0 (on top)\n",
     "add a layer", "own place", TAKE_WRITES, .ask = make_layer_add,
     .examples = "take layer add show.marotte last lids\n"
                 "take layer add show.marotte last lips --own mouth,jaw --place 0\n"},
    {"layer remove", "SHOW TAKE LAYER", "", "remove a layer", "", TAKE_WRITES, .ask = make_layer,
     .kind = EDIT_LAYER_REMOVE,
     .examples = "take layer remove show.marotte last brows\n"
                 "take layer remove show.marotte last brows --json\n"},
    {"layer rename", "SHOW TAKE LAYER NAME", "", "rename a layer", "", TAKE_WRITES,
     .ask = make_layer, .kind = EDIT_LAYER_RENAME,
     .examples = "take layer rename show.marotte last brows \"both brows\"\n"
                 "take layer rename show.marotte last 1 hand\n"},
    {"layer own", "SHOW TAKE LAYER NAMES", "  NAMES:       all, or\n" OWN_HELP,
     "choose the parts of the face that a layer moves", "", TAKE_WRITES, .ask = make_layer,
     .kind = EDIT_LAYER_OWN,
     .examples = "take layer own show.marotte last brows brows,lids\n"
                 "take layer own show.marotte last brows \"mouth.*,jaw.open\"\n"
                 "take layer own show.marotte last brows all\n"},
    {"layer mute", "SHOW TAKE LAYER", OFF_HELP, "mute a layer", "off", TAKE_WRITES,
     .ask = make_layer, .kind = EDIT_LAYER_MUTE,
     .examples = "take layer mute show.marotte last brows\n"
                 "take layer mute show.marotte last brows --off\n"},
    {"layer solo", "SHOW TAKE LAYER", OFF_HELP, "play only layers that are solo", "off",
     TAKE_WRITES, .ask = make_layer, .kind = EDIT_LAYER_SOLO,
     .examples = "take layer solo show.marotte last brows\n"
                 "take layer solo show.marotte last brows --off\n"},
    {"layer additive", "SHOW TAKE LAYER", OFF_HELP, "add a layer to the layers below", "off",
     TAKE_WRITES, .ask = make_layer, .kind = EDIT_LAYER_ADDITIVE,
     .examples = "take layer additive show.marotte last brows\n"
                 "take layer additive show.marotte last brows --off\n"},
    {"layer gain", "SHOW TAKE LAYER GAIN", "", "scale a layer, 0 to 10", "", TAKE_WRITES,
     .ask = make_layer, .kind = EDIT_LAYER_GAIN,
     .examples = "take layer gain show.marotte last brows 0.5\n"
                 "take layer gain show.marotte last brows 1\n"},
    {"layer offset", "SHOW TAKE LAYER SECONDS", "", "play a layer later, or earlier", "",
     TAKE_WRITES, .ask = make_layer, .kind = EDIT_LAYER_OFFSET,
     .examples = "take layer offset show.marotte last brows 0.08\n"
                 "take layer offset show.marotte last brows 0\n"},
    {"layer order", "SHOW TAKE LAYER PLACE", "", "move a layer; place 0 is the bottom", "",
     TAKE_WRITES, .ask = make_layer, .kind = EDIT_LAYER_ORDER,
     .examples = "take layer order show.marotte last brows 0\n"
                 "take layer order show.marotte last 1 1\n"},
    {"comp", "SHOW TAKE",
     "  --region R,R or --own NAMES   the parts of the face:\n" OWN_HELP SPAN_HELP,
     "take parts of the face from another take", SPAN_OPTIONS " region own", TAKE_WRITES,
     .ask = make_layer_comp,
     .examples = "take comp show.marotte last --from 1 --region mouth --in 1 --out 2\n"
                 "take comp show.marotte last --from 1 --own jaw.open --in 1 --out 2 --fade 0.2\n"},
    {"punch", "SHOW TAKE", "  --layer L    the layer, by its number or name\n" SPAN_HELP,
     "show a span of another take in a layer", SPAN_OPTIONS " layer", TAKE_WRITES,
     .ask = make_layer_punch,
     .examples =
         "take punch show.marotte 2 --from 1 --in 1 --out 2\n"
         "take punch show.marotte last --layer brows --from 1 --in 1 --out 2 --source 0.5\n"},
    {"undo", "SHOW TAKE", "  --steps N    the number of edits (1)\n", "undo the last edit", "steps",
     TAKE_WRITES, .run = run_undo,
     .examples = "take undo show.marotte last\ntake undo show.marotte last --steps 2\n"},
    {"redo", "SHOW TAKE", "  --steps N    the number of edits (1)\n", "redo what was undone",
     "steps", TAKE_WRITES, .run = run_redo,
     .examples = "take redo show.marotte last\ntake redo show.marotte last --steps 2\n"},
    {"history", "SHOW TAKE", "", "list all edits of a take", "", TAKE_READS, .run = run_history,
     .examples = "take history show.marotte last\ntake history show.marotte last --json\n"},
};
const take_verbs take_layer_verbs = {"Layers, other takes, undo", layer_verbs,
                                     sizeof layer_verbs / sizeof layer_verbs[0]};

/* ---- the sound ---- */

static mrt_result make_sound_attach(take_call *call, const take *t, take_change *out, error *err)
{
    (void)t;
    double offset_s = 0.0, gain = 1.0;
    mrt_result result = take_number(call, TAKE_OFFSET, -1e6, 1e6, &offset_s, err);
    if (result >= 0)
        result = take_number(call, TAKE_GAIN, 0.0, 10.0, &gain, err);
    if (result < 0)
        return result;
    const sound_file_watch watch = {progress_part, &call->shown};
    edit *e = take_change_add(out, EDIT_AUDIO_ATTACH);
    e->offset_ns = llround(offset_s * 1e9);
    e->gain = gain;
    progress_start(&call->shown, "sound");
    result = sound_file_import(&e->audio, call->show, call->word[2], &watch, err);
    progress_end(&call->shown);
    return result;
}

static mrt_result make_sound_trim(take_call *call, const take *t, take_change *out, error *err)
{
    if (!call->text[TAKE_IN] && !call->text[TAKE_OUT])
        return take_misused(call, err, "--in or --out is missing");
    edit *e = take_change_add(out, EDIT_AUDIO_TRIM);
    mrt_result result = take_time(call, TAKE_IN, t, &e->start_ns, err);
    return result < 0 ? result : take_time(call, TAKE_OUT, t, &e->end_ns, err);
}

static const take_verb audio_verbs[] = {
    {"audio attach", "SHOW TAKE FILE",
     "  --offset S   its start on the take's timeline, seconds (0)\n"
     "  --gain G     0 to 10 (1)\n"
     "Reads WAV, FLAC, Ogg, AIFF and others. The show stores every sample.\n",
     "add a sound file to a take", "offset gain", TAKE_WRITES, .ask = make_sound_attach,
     .examples = "take audio attach show.marotte last voice.wav\n"
                 "take audio attach show.marotte last voice.wav --offset 0.25 --gain 0.8\n"},
    {"audio offset", "SHOW TAKE SECONDS", "", "move the sound of a take", "", TAKE_WRITES,
     .ask = make_value, .kind = EDIT_AUDIO_OFFSET,
     .examples = "take audio offset show.marotte 2 0.5\ntake audio offset show.marotte 2 0\n"},
    {"audio trim", "SHOW TAKE",
     "  --in T, --out T   the audible range, on the take's timeline\n" FPS_HELP,
     "trim the sound of a take", "in out fps", TAKE_WRITES, .ask = make_sound_trim,
     .examples = "take audio trim show.marotte 2 --in 0.2 --out 0.8\n"
                 "take audio trim show.marotte 2 --out 0.5\n"},
    {"audio gain", "SHOW TAKE GAIN", "", "set the volume of the sound, 0 to 10", "", TAKE_WRITES,
     .ask = make_value, .kind = EDIT_AUDIO_GAIN,
     .examples = "take audio gain show.marotte 2 0.7\ntake audio gain show.marotte 2 1\n"},
    {"audio detach", "SHOW TAKE", "", "remove the sound from a take", "", TAKE_WRITES,
     .ask = make_value, .kind = EDIT_AUDIO_DETACH,
     .examples = "take audio detach show.marotte 2\ntake audio detach show.marotte 2 --json\n"},
};
const take_verbs take_audio_verbs = {"Sound", audio_verbs,
                                     sizeof audio_verbs / sizeof audio_verbs[0]};
