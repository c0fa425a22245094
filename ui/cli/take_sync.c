/* marotte take sync: how late the mouth of a take is against its sound. */
#include "cli/take.h"
#include "base/cancel.h"
#include "stage/playback/sync.h"

static bool goes_on(void *data, double part)
{
    take_call *call = data;
    progress_show_time(&call->shown, part * 100.0, 100.0);
    return !cancel_is_requested();
}

static void report(take_call *call, const sync_curves *curves, const sync_offset *of)
{
    facts_text(call->told, "sync", "sync", sync_describe(of).text);
    if (of->is_clear) {
        const bool is_fine = of->late_ns <= SYNC_LATE_NS && of->late_ns >= -SYNC_EARLY_NS;
        facts_number(call->told, "late_ms", "late by", (double)of->late_ns / 1e6, 1, "ms");
        facts_text(call->told, "noticed", "noticed",
                   is_fine ? "no: at most 45 ms late, or 125 ms early" : "yes");
    }
    facts_number(call->told, "correlation", "correlation", of->correlation, 2, "");
    facts_number(call->told, "compared_s", "compared", (double)curves->count / SYNC_RATE, 2, "s");
}

static mrt_result measure(take_call *call, sync_curves *curves, sync_offset *of, error *err)
{
    take_stage stage;
    mrt_result result = take_stage_open(&stage, call, call->word[1], call->text[TAKE_FACE], err);
    sync_source from = {.show = call->show,
                        .plugins = &stage.plugins,
                        .log = stage.log,
                        .sequencer = stage.sequencer,
                        .take = &stage.take,
                        .to_ns = stage.take.duration_ns,
                        .goes_on = goes_on,
                        .data = call};
    if (result >= 0)
        result = take_time(call, TAKE_IN, &stage.take, &from.from_ns, err);
    if (result >= 0)
        result = take_time(call, TAKE_OUT, &stage.take, &from.to_ns, err);
    if (result >= 0) {
        progress_start(&call->shown, "comparing");
        result = sync_read(curves, &from, err);
        progress_end(&call->shown);
        take_stage_report(&stage);
    }
    if (result == MRT_END)
        result = error_set(err, MRT_ERR_IO, "stopped");
    if (result >= 0) {
        sync_find(of, curves->mouth, curves->voice, curves->count);
        report(call, curves, of);
    }
    take_stage_finish(&stage);
    return result;
}

mrt_result take_sync_edits(take_call *call, const take *t, take_change *out, error *err)
{
    out->count = sync_edits(out->edit, TAKE_CHANGE_MAX, t, call->late_ns);
    if (out->count <= TAKE_CHANGE_MAX)
        return MRT_OK;
    out->count = 0;
    return error_set(err, MRT_ERR_ARGUMENT,
                     "More than %d layers own the jaw. Move them with marotte take layer offset",
                     TAKE_CHANGE_MAX);
}

mrt_result take_sync_run(take_call *call, error *err)
{
    sync_curves curves = {0};
    sync_offset of;
    if (!call->word[1])
        call->word[1] = "last";
    mrt_result result = measure(call, &curves, &of, err);
    sync_curves_finish(&curves);
    if (result < 0 || !call->text[TAKE_MOVE])
        return result;
    if (!of.is_clear)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "Nothing was moved: there is no clear offset. Choose a range with --in "
                         "and --out in which the mouth speaks with the sound");
    call->late_ns = of.late_ns;
    return take_change_run(call, err);
}
