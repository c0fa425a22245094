/* Subcommands that edit what a take shows and when, and what is written on it. */
#include "base/text.h"
#include "take_change.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- clips ---- */

static mrt_result ask_trim(take_call *call, const take *t, take_change *out, error *err)
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

static mrt_result ask_split(take_call *call, const take *t, take_change *out, error *err)
{
    edit *e = take_change_add(out, EDIT_CLIP_SPLIT);
    mrt_result result = take_need(call, TAKE_AT, err);
    if (result >= 0)
        result = take_time(call, TAKE_AT, t, &e->at_ns, err);
    return result < 0 ? result : take_find_clip(call, t, e->at_ns, &e->clip, err);
}

static mrt_result ask_move(take_call *call, const take *t, take_change *out, error *err)
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

/* "0:0,2:1.5": timeline to source, seconds. */
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

static mrt_result ask_retime(take_call *call, const take *t, take_change *out, error *err)
{
    bool is_curve = call->text[TAKE_POINTS] != NULL;
    if (is_curve == (call->text[TAKE_SPEED] != NULL))
        return take_misused(call, err, "either --speed or --points is wanted");
    edit *e = take_change_add(out, is_curve ? EDIT_CLIP_CURVE : EDIT_CLIP_SPEED);
    mrt_result result = take_find_clip(call, t, EDIT_UNSAID, &e->clip, err);
    if (result < 0)
        return result;
    if (is_curve)
        return read_points(call, call->text[TAKE_POINTS], e, err);
    result = take_number(call, TAKE_SPEED, 0.01, 100.0, &e->speed, err);
    return result < 0 ? result : take_time(call, TAKE_AT, t, &e->at_ns, err);
}

static mrt_result ask_smooth(take_call *call, const take *t, take_change *out, error *err)
{
    edit *e = take_change_add(out, EDIT_CLIP_SMOOTH);
    mrt_result result = take_find_clip(call, t, EDIT_UNSAID, &e->clip, err);
    return result < 0
               ? result
               : take_number_of(call, "SECONDS", call->word[2], 0.0, 10.0, &e->smooth_s, err);
}

/* A layer where one is named, else a clip. */
static mrt_result ask_target(take_call *call, const take *t, take_change *out, edit_kind of_layer,
                             edit_kind of_clip, edit **out_edit, error *err)
{
    bool is_layer = call->text[TAKE_LAYER] != NULL;
    if (is_layer && call->text[TAKE_CLIP])
        return take_misused(call, err, "either --clip or --layer is wanted");
    edit *e = *out_edit = take_change_add(out, is_layer ? of_layer : of_clip);
    return is_layer ? take_find_layer(call, t, &e->layer, err)
                    : take_find_clip(call, t, EDIT_UNSAID, &e->clip, err);
}

static mrt_result ask_mute(take_call *call, const take *t, take_change *out, error *err)
{
    edit *e = NULL;
    mrt_result result = ask_target(call, t, out, EDIT_LAYER_MUTE, EDIT_CLIP_MUTE, &e, err);
    if (result >= 0)
        e->is_muted = call->text[TAKE_OFF] == NULL;
    return result;
}

static mrt_result ask_gain(take_call *call, const take *t, take_change *out, error *err)
{
    edit *e = NULL;
    mrt_result result = ask_target(call, t, out, EDIT_LAYER_GAIN, EDIT_CLIP_GAIN, &e, err);
    return result < 0 ? result
                      : take_number_of(call, "GAIN", call->word[2], 0.0, 10.0, &e->gain, err);
}

static mrt_result ask_fade(take_call *call, const take *t, take_change *out, error *err)
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

static mrt_result ask_cut(take_call *call, const take *t, take_change *out, error *err)
{
    edit *e = take_change_add(out, EDIT_RANGE_CUT);
    mrt_result result = take_need(call, TAKE_IN, err);
    if (result >= 0)
        result = take_need(call, TAKE_OUT, err);
    if (result >= 0)
        result = take_time(call, TAKE_IN, t, &e->in_ns, err);
    if (result >= 0)
        result = take_time(call, TAKE_OUT, t, &e->out_ns, err);
    e->is_ripple = call->text[TAKE_RIPPLE] != NULL;
    if (result >= 0 && call->text[TAKE_LAYER]) {
        e->layer_count = 1;
        result = take_find_layer(call, t, &e->layers[0], err);
    }
    return result;
}

static mrt_result ask_insert(take_call *call, const take *t, take_change *out, error *err)
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

static mrt_result ask_delete(take_call *call, const take *t, take_change *out, error *err)
{
    bool is_clip = call->text[TAKE_CLIP] != NULL;
    edit *e = take_change_add(out, is_clip ? EDIT_CLIP_REMOVE : EDIT_TAKE_DELETE);
    return is_clip ? take_find_clip(call, t, EDIT_UNSAID, &e->clip, err) : MRT_OK;
}

static mrt_result ask_restore(take_call *call, const take *t, take_change *out, error *err)
{
    (void)call, (void)t, (void)err;
    take_change_add(out, EDIT_TAKE_RESTORE);
    return MRT_OK;
}

/* ---- what is written on it ---- */

static mrt_result put_text(take_call *call, char *out, size_t size, const char *text, error *err)
{
    if (strlen(text) >= size)
        return take_misused(call, err, "\"%.40s...\" is too long: at most %zu bytes", text,
                            size - 1);
    memcpy(out, text, strlen(text) + 1);
    return MRT_OK;
}

static mrt_result ask_rename(take_call *call, const take *t, take_change *out, error *err)
{
    (void)t;
    edit *e = take_change_add(out, EDIT_TAKE_RENAME);
    return put_text(call, e->name, sizeof e->name, call->word[2], err);
}

static mrt_result ask_slate(take_call *call, const take *t, take_change *out, error *err)
{
    edit *e = take_change_add(out, EDIT_TAKE_SLATE);
    double number = (double)t->number;
    const char *scene = call->text[TAKE_SCENE], *shot = call->text[TAKE_SHOT];
    if (!scene && !shot && !call->text[TAKE_NUMBER])
        return take_misused(call, err, "--scene, --shot or --number is missing");
    mrt_result result = put_text(call, e->scene, sizeof e->scene, scene ? scene : t->scene, err);
    if (result >= 0)
        result = put_text(call, e->shot, sizeof e->shot, shot ? shot : t->shot, err);
    if (result >= 0)
        result = take_number(call, TAKE_NUMBER, 1, 99999, &number, err);
    e->number = (uint32_t)number;
    return result;
}

static mrt_result ask_note(take_call *call, const take *t, take_change *out, error *err)
{
    (void)t;
    edit *e = take_change_add(out, EDIT_TAKE_NOTE);
    return put_text(call, e->note, sizeof e->note, call->word[2], err);
}

static mrt_result ask_rate(take_call *call, const take *t, take_change *out, error *err)
{
    (void)t;
    double stars = 0.0;
    edit *e = take_change_add(out, EDIT_TAKE_RATE);
    mrt_result result = take_number_of(call, "STARS", call->word[2], 0, 5, &stars, err);
    e->rating = (uint32_t)stars;
    return result;
}

static mrt_result ask_mark(take_call *call, const take *t, take_change *out, error *err)
{
    edit *e = take_change_add(out, EDIT_MARKER_ADD);
    mrt_result result = take_need(call, TAKE_AT, err);
    if (result >= 0)
        result = take_time(call, TAKE_AT, t, &e->at_ns, err);
    return result < 0 ? result : put_text(call, e->text, sizeof e->text, call->word[2], err);
}

static mrt_result ask_timecode(take_call *call, const take *t, take_change *out, error *err)
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

static mrt_result ask_edit(take_call *call, const take *t, take_change *out, error *err)
{
    (void)t;
    edit parsed;
    mrt_result result = edit_parse(&parsed, call->word[2], strlen(call->word[2]), err);
    if (result >= 0)
        out->edit[out->count++] = parsed;
    return result;
}

#define RUN(name)                                                                                  \
    static mrt_result run_##name(take_call *call, error *err)                                      \
    {                                                                                              \
        return take_change_run(call, ask_##name, err);                                             \
    }
RUN(trim)
RUN(split)
RUN(move)
RUN(retime)
RUN(smooth)
RUN(mute)
RUN(gain)
RUN(fade)
RUN(cut)
RUN(insert)
RUN(delete)
RUN(restore)
RUN(rename)
RUN(slate)
RUN(note)
RUN(rate)
RUN(mark)
RUN(timecode)
RUN(edit)

#define CLIP_HELP  "  --clip N     which clip (marotte take show); not needed where there is one\n"
#define LAYER_HELP "  --layer L    of a whole layer, by its number or name\n"
#define FPS_HELP   "  --fps RATE   of time code, where the take has no frame rate\n"

static const take_verb edit_verbs[] = {
    {"trim", "SHOW TAKE",
     "  --in T       its first instant (0)\n  --out T      its end\n"
     "  --clip N     trims that clip, not the take\n" FPS_HELP,
     "keeps a range of a take",
     TAKE_BIT(TAKE_IN) | TAKE_BIT(TAKE_OUT) | TAKE_BIT(TAKE_CLIP) | TAKE_BIT(TAKE_FPS), TAKE_WRITES,
     run_trim},
    {"cut", "SHOW TAKE",
     "  --in T --out T   the range\n  --ripple     what is later moves up\n" LAYER_HELP FPS_HELP,
     "takes a range out",
     TAKE_BIT(TAKE_IN) | TAKE_BIT(TAKE_OUT) | TAKE_BIT(TAKE_RIPPLE) | TAKE_BIT(TAKE_LAYER) |
         TAKE_BIT(TAKE_FPS),
     TAKE_WRITES, run_cut},
    {"insert", "SHOW TAKE", "  --at T       where\n  --length S   seconds\n" FPS_HELP,
     "opens a gap", TAKE_BIT(TAKE_AT) | TAKE_BIT(TAKE_LENGTH) | TAKE_BIT(TAKE_FPS), TAKE_WRITES,
     run_insert},
    {"split", "SHOW TAKE", "  --at T       where\n" CLIP_HELP FPS_HELP, "splits a clip",
     TAKE_BIT(TAKE_AT) | TAKE_BIT(TAKE_CLIP) | TAKE_BIT(TAKE_FPS), TAKE_WRITES, run_split},
    {"move", "SHOW TAKE",
     "  --to T       its new start\n  --layer L    another layer\n" CLIP_HELP FPS_HELP,
     "moves a clip",
     TAKE_BIT(TAKE_TO) | TAKE_BIT(TAKE_LAYER) | TAKE_BIT(TAKE_CLIP) | TAKE_BIT(TAKE_FPS),
     TAKE_WRITES, run_move},
    {"retime", "SHOW TAKE",
     "  --speed F    so many times as fast\n  --at T       about this instant (its start)\n"
     "  --points A:S,A:S...   or a curve: at A s of the timeline it shows its own S s\n" CLIP_HELP
         FPS_HELP,
     "plays a clip faster, slower, or along a curve",
     TAKE_BIT(TAKE_SPEED) | TAKE_BIT(TAKE_AT) | TAKE_BIT(TAKE_POINTS) | TAKE_BIT(TAKE_CLIP) |
         TAKE_BIT(TAKE_FPS),
     TAKE_WRITES, run_retime},
    {"smooth", "SHOW TAKE SECONDS", CLIP_HELP, "smooths a clip; 0 ends it", TAKE_BIT(TAKE_CLIP),
     TAKE_WRITES, run_smooth},
    {"mute", "SHOW TAKE", "  --off        is heard again\n" CLIP_HELP LAYER_HELP,
     "mutes a clip or a layer", TAKE_BIT(TAKE_OFF) | TAKE_BIT(TAKE_CLIP) | TAKE_BIT(TAKE_LAYER),
     TAKE_WRITES, run_mute},
    {"gain", "SHOW TAKE GAIN", CLIP_HELP LAYER_HELP, "how much of a clip or a layer: 0 to 10",
     TAKE_BIT(TAKE_CLIP) | TAKE_BIT(TAKE_LAYER), TAKE_WRITES, run_gain},
    {"fade", "SHOW TAKE", "  --fade-in S, --fade-out S   seconds\n" CLIP_HELP,
     "fades a clip in or out",
     TAKE_BIT(TAKE_FADE_IN) | TAKE_BIT(TAKE_FADE_OUT) | TAKE_BIT(TAKE_CLIP), TAKE_WRITES, run_fade},
    {"delete", "SHOW TAKE", "  --clip N     that clip, not the take\n",
     "puts a take away: restore brings it back", TAKE_BIT(TAKE_CLIP), TAKE_WRITES, run_delete},
    {"restore", "SHOW TAKE", "", "brings a deleted take back", 0, TAKE_WRITES, run_restore},
    {"rename", "SHOW TAKE NAME", "", "names a take", 0, TAKE_WRITES, run_rename},
    {"slate", "SHOW TAKE", "  --scene S, --shot S, --number N   what is left out stays\n",
     "changes a take's slate", TAKE_BIT(TAKE_SCENE) | TAKE_BIT(TAKE_SHOT) | TAKE_BIT(TAKE_NUMBER),
     TAKE_WRITES, run_slate},
    {"note", "SHOW TAKE TEXT", "", "writes a note on a take", 0, TAKE_WRITES, run_note},
    {"rate", "SHOW TAKE STARS", "", "0 to 5 stars", 0, TAKE_WRITES, run_rate},
    {"mark", "SHOW TAKE TEXT", "  --at T       where\n" FPS_HELP, "marks an instant",
     TAKE_BIT(TAKE_AT) | TAKE_BIT(TAKE_FPS), TAKE_WRITES, run_mark},
    {"timecode", "SHOW TAKE",
     "  --fps RATE   24, 25, 29.97, 30000/1001 ...\n"
     "  --start TC   time code of its first frame: 01:00:00:00, drop-frame 01:00:00;00\n",
     "gives a take a frame rate and time code", TAKE_BIT(TAKE_FPS) | TAKE_BIT(TAKE_START),
     TAKE_WRITES, run_timecode},
    {"edit", "SHOW TAKE JSON",
     "  JSON: any edit as it is stored: {\"op\":\"clip.trim\",\"clip\":2,\"start_ns\":0}\n",
     "does any edit", 0, TAKE_WRITES, run_edit},
};
const take_verbs take_edit_verbs = {"Edit", edit_verbs, sizeof edit_verbs / sizeof edit_verbs[0]};
