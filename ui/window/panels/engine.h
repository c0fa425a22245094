/* window/panels/engine.h - labels and explanations of the engine's counters, and times as text.
 * Pure. */
#ifndef MAROTTE_UI_WINDOW_PANELS_ENGINE_H
#define MAROTTE_UI_WINDOW_PANELS_ENGINE_H
#include "stage/live/live.h"
#include "window/gui/ui.h"

/* Writes a time with three digits: "0.35 ms", "12.1 ms", "405 ms". */
enum { ENGINE_MS = 24 };
void engine_ms(char out[ENGINE_MS], double ms);

enum { ENGINE_COUNTERS_MAX = 16 };
typedef struct engine_counter {
    const char *label; /* "Held pulls" */
    const char *help;  /* explanation in one sentence */
    uint64_t value;
    bool is_odd; /* indicates a problem; otherwise only information */
} engine_counter;
/* Writes the counters that are not zero. Returns their number. */
uint32_t engine_counters(const live_status *status, engine_counter out[ENGINE_COUNTERS_MAX]);

#endif
