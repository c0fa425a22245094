/* window/panels/engine.h - what the engine's counters mean, and how near to a fold the face
 * is, in words. Pure. */
#ifndef MAROTTE_UI_WINDOW_PANELS_ENGINE_H
#define MAROTTE_UI_WINDOW_PANELS_ENGINE_H
#include "stage/live/live.h"
#include "window/gui/ui.h"

/* "0.35 ms", "12.1 ms", "405 ms": as wide as three digits. */
enum { ENGINE_MS = 24 };
void engine_ms(char out[ENGINE_MS], double ms);

enum { ENGINE_COUNTERS_MAX = 16 };
typedef struct engine_counter {
    const char *label; /* "Held pulls" */
    const char *help;  /* what it means, one sentence */
    uint64_t value;
    bool is_odd; /* something went wrong; else only news */
} engine_counter;
/* Those that are not zero. Returns how many. */
uint32_t engine_counters(const live_status *status, engine_counter out[ENGINE_COUNTERS_MAX]);

#endif
