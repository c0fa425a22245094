#include "window/engine_panel_words.h"

#include <stdio.h>

static const double nearly = 0.15;

const char *engine_fold_words(double min_determinant, ui_style *out_style)
{
    if (!(min_determinant > 0.0)) {
        *out_style = UI_STYLE_BAD;
        return "folds";
    }
    *out_style = min_determinant < nearly ? UI_STYLE_WARNING : UI_STYLE_GOOD;
    return min_determinant < nearly ? "nearly folds" : "nothing folds";
}

void engine_ms(char out[ENGINE_MS], double ms)
{
    int digits = ms < 9.995 ? 2 : ms < 99.95 ? 1 : 0;
    if (ms < 99999.0)
        (void)snprintf(out, ENGINE_MS, "%.*f ms", digits, ms);
    else
        (void)snprintf(out, ENGINE_MS, "minutes");
}

static uint32_t add(engine_counter *out, uint32_t count, uint64_t value, bool is_odd,
                    const char *label, const char *help)
{
    if (value > 0)
        out[count] = (engine_counter){label, help, value, is_odd};
    return count + (value > 0);
}

uint32_t engine_counters(const live_status *status, engine_counter out[ENGINE_COUNTERS_MAX])
{
    const performer_counts *of = &status->counts;
    uint32_t n = 0;
    n = add(out, n, of->bad_pulls, true, "Bad pulls",
            "The mapping gave nonsense: its last good pull was held.");
    n = add(out, n, of->held_pulls, true, "Held pulls",
            "The engine could not use a pull: the shape was held.");
    n = add(out, n, of->folded_steps, true, "Folded steps",
            "Clay: a step in which the shape folded.");
    n = add(out, n, of->limited_steps, false, "Limited steps",
            "Clay: the tips were faster than the substeps allow.");
    n = add(out, n, status->isolated.failed, true, "Mapping failed",
            "The mapping's process crashed, hung or gave nonsense.");
    n = add(out, n, status->isolated.late, true, "Mapping late",
            "Samples in which the face was held because the mapping's process was late.");
    n = add(out, n, status->reload_refused, true, "Refused versions",
            "New versions of the mapping that could not be used: the log says why.");
    n = add(out, n, of->engagements, false, "Took hold",
            "How often a pull took hold of the face anew.");
    n = add(out, n, of->commits, false, "Commits", "How often the shape shown became the base.");
    n = add(out, n, of->substeps, false, "Substeps", "Clay: parts in which steps were made.");
    return n;
}
