/* Subcommands of a show as a whole: what is in it, what is made of what was not recorded on
 * purpose, and what can be saved of a damaged one. */
#include "take/edit_store.h"
#include "base/cancel.h"
#include "base/clock.h"
#include "take_play.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- list ---- */

static void tell_take(take_call *call, const show_take *made, const take *t, const char *problem)
{
    char label[24], line[512], stars[8] = "";
    for (uint32_t i = 0; i < t->rating && i < 5; ++i)
        stars[i] = '*';
    take_name slate = take_slate_text(t->scene, t->shot, t->number);
    (void)snprintf(label, sizeof label, "take %lld", (long long)made->id);
    (void)snprintf(line, sizeof line, "%s  %.2f s%s%s%s%s%s%s%s%s", slate.text,
                   (double)t->duration_ns / 1e9, stars[0] ? "  " : "", stars,
                   t->name[0] ? "  " : "", t->name, t->audio.audio ? "  with sound" : "",
                   t->is_deleted ? "  deleted" : "", t->is_recording ? "  being recorded" : "",
                   problem[0] ? "  damaged" : "");
    const facts_cell cells[] = {{"id", NULL, (double)made->id, 0},
                                {"slate", slate.text, 0, 0},
                                {"name", t->name, 0, 0},
                                {"duration_s", NULL, (double)t->duration_ns / 1e9, 9},
                                {"rating", NULL, t->rating, 0},
                                {"origin", t->origin, 0, 0},
                                {"layers", NULL, t->layer_count, 0},
                                {"edits", NULL, made->edit_head, 0},
                                {"deleted", NULL, t->is_deleted, -1},
                                {"recording", NULL, t->is_recording, -1},
                                {"problem", problem, 0, 0}};
    facts_row(call->told, "takes", label, line, cells, sizeof cells / sizeof cells[0]);
}

static mrt_result run_list(take_call *call, error *err)
{
    show_take *takes;
    size_t count;
    mrt_result result = show_look_begin(call->show, err);
    if (result >= 0)
        result = show_takes(call->show, &takes, &count, err);
    if (result < 0)
        return result;
    for (size_t i = 0; i < count && !cancel_is_asked(); ++i) {
        take t;
        error problem = {""};
        if (edit_store_take_of(&t, call->show, &takes[i], &problem) < 0 && !problem.text[0])
            (void)error_set(&problem, MRT_ERR_FORMAT, "damaged");
        tell_take(call, &takes[i], &t, problem.text);
        take_finish(&t);
    }
    show_look_end(call->show);
    facts_number(call->told, "take_count", "takes", (double)count, 0, "");
    free(takes);
    return cancel_check(err);
}

/* ---- keep ---- */

typedef struct keep {
    int64_t from_ns, to_ns;
    show_span *span;
    size_t count;
} keep;

/* What was performed live in that time; the first pass finds where it ends. */
static mrt_result visit(take_call *call, const int64_t *ids, size_t count, keep *out, error *err)
{
    for (size_t i = 0; i < count; ++i) {
        show_performance of;
        mrt_result result = show_performance_read(call->show, ids[i], &of, err);
        if (result < 0)
            return result;
        bool is_live = of.performance.again.of == 0;
        int64_t from_ns = of.from_ns, to_ns = of.to_ns;
        show_performance_finish(&of);
        if (!is_live)
            continue;
        if (!out->span) {
            out->to_ns = to_ns > out->to_ns ? to_ns : out->to_ns;
            continue;
        }
        from_ns = from_ns > out->from_ns ? from_ns : out->from_ns;
        if (from_ns < to_ns)
            out->span[out->count++] = (show_span){
                .performance = ids[i], .from_ns = from_ns, .to_ns = to_ns, .is_shown = true};
    }
    return MRT_OK;
}

/* One performance goes on at a time, but recordings that are performed faster than life lie over
 * each other: the newer one is kept, and of the older what came before it. */
static void keep_one_at_a_time(keep *out)
{
    size_t left = out->count;
    int64_t newer_ns = INT64_MAX;
    for (size_t i = out->count; i-- > 0;) {
        show_span span = out->span[i];
        span.to_ns = span.to_ns < newer_ns ? span.to_ns : newer_ns;
        if (span.from_ns >= span.to_ns)
            continue;
        newer_ns = span.from_ns;
        out->span[--left] = span;
    }
    out->count -= left;
    memmove(out->span, out->span + left, out->count * sizeof *out->span);
}

static mrt_result keep_newest(take_call *call, double seconds, const int64_t *ids, size_t count,
                              keep *out, error *err)
{
    mrt_result result = visit(call, ids, count, out, err);
    if (result >= 0 && out->to_ns == 0)
        return error_set(err, MRT_ERR_ARGUMENT, "%s: nothing was performed into it yet",
                         call->word[0]);
    if (result < 0)
        return result;
    out->from_ns = out->to_ns - (int64_t)(seconds * 1e9);
    out->span = calloc(count + 1, sizeof *out->span);
    if (!out->span)
        return error_set(err, MRT_ERR_MEMORY, "no memory for a take");
    result = visit(call, ids, count, out, err);
    keep_one_at_a_time(out);
    if (out->count > 0)
        out->from_ns = out->span[0].from_ns;
    return result;
}

static mrt_result run_keep(take_call *call, error *err)
{
    double seconds = 30.0;
    int64_t *ids, id;
    size_t count;
    keep kept = {0};
    mrt_result result = take_number(call, TAKE_LAST, 0.001, 1e6, &seconds, err);
    if (result >= 0)
        result = show_performance_ids(call->show, &ids, &count, err);
    if (result < 0)
        return result;
    result = keep_newest(call, seconds, ids, count, &kept, err);
    free(ids);
    const show_new_take made = {.created_ns = clock_utc_ms() * 1000000,
                                .start_ns = kept.from_ns,
                                .end_ns = kept.to_ns,
                                .scene = call->text[TAKE_SCENE] ? call->text[TAKE_SCENE] : "",
                                .shot = call->text[TAKE_SHOT] ? call->text[TAKE_SHOT] : "",
                                .origin = "kept from the journal",
                                .spans = kept.span,
                                .span_count = kept.count};
    if (result >= 0)
        result = show_take_create(call->show, &made, &id, err);
    if (result >= 0) {
        facts_number(call->told, "take_id", "take id", (double)id, 0, "");
        facts_number(call->told, "duration_s", "duration",
                     (double)(kept.to_ns - kept.from_ns) / 1e9, 3, "s");
    }
    free(kept.span);
    return result;
}

/* ---- recover ---- */

static mrt_result run_recover(take_call *call, error *err)
{
    show_recovery report;
    mrt_result result = take_need(call, TAKE_OUT, err);
    if (result >= 0)
        result = show_recover(&report, call->word[0], call->text[TAKE_OUT], err);
    if (result < 0)
        return result;
    facts_number(call->told, "rows", "rows copied", (double)report.row_count, 0, "");
    facts_number(call->told, "damaged", "damaged, left out", (double)report.damaged_count, 0, "");
    if (report.is_cut)
        fprintf(stderr, "warning: %s leads in circles: not all of it was looked at\n",
                call->word[0]);
    facts_list(call->told, "files", "wrote", call->text[TAKE_OUT]);
    return MRT_OK;
}

static const take_verb file_verbs[] = {
    {"list", "SHOW", "", "the takes of a show", 0, TAKE_READS, run_list},
    {"show", "SHOW TAKE",
     "  --hash         SHA-256 over all vertices of all frames, too\n"
     "  --fps RATE     of these frames (the take's, or 30)\n"
     "  --in T, --out T   a range of them\n"
     "  --face FILE    on this face (that which it was performed on)\n",
     "what a take is made of",
     TAKE_BIT(TAKE_HASH_OPTION) | TAKE_BIT(TAKE_FPS) | TAKE_BIT(TAKE_FACE) | TAKE_BIT(TAKE_IN) |
         TAKE_BIT(TAKE_OUT),
     TAKE_READS, take_show_run},
    {"keep", "SHOW",
     "  --last S       so many seconds (30)\n  --scene S, --shot S   of its slate\n",
     "makes a take of the newest seconds",
     TAKE_BIT(TAKE_LAST) | TAKE_BIT(TAKE_SCENE) | TAKE_BIT(TAKE_SHOT), TAKE_WRITES, run_keep},
    {"check", "SHOW", "Exit code 1 when something is damaged.\n",
     "reads everything and says what is damaged", 0, TAKE_READS, take_check_run},
    {"recover", "SHOW", "  --out NEW      must not exist; SHOW is not touched\n",
     "copies what can be read of a damaged show", TAKE_BIT(TAKE_OUT), TAKE_OPENS_ITSELF,
     run_recover},
};
const take_verbs take_file_verbs = {"The show", file_verbs,
                                    sizeof file_verbs / sizeof file_verbs[0]};
