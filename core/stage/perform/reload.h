/* stage/perform/reload.h - a mapping's library that is rebuilt while it performs: the new one is
 * loaded beside the old one, checked, given the old one's parameters and state, and takes over
 * between two samples without a jump (layer_switch). One that fails is refused, and the old one
 * goes on. All but the taking over happens in a thread of its own. What ran is never unloaded. */
#ifndef MAROTTE_STAGE_RELOAD_H
#define MAROTTE_STAGE_RELOAD_H
#include "stage/mapping/isolate.h"
#include "stage/perform/layer.h"

typedef struct reload reload;

typedef struct reload_settings {
    const char *library; /* the file that is watched */
    instance *mapping;   /* what performs now; active; stays the caller's */
    const mapped_face *mapped;
    log_queue *log;
    instance_clock clock;
    const isolate_settings *isolate; /* new versions run in processes of their own; NULL: here */
    bool
        is_asked; /* [main] looks at what pulls: no version goes before reload_current was called */
} reload_settings;

/* [main] The face and the log must outlive it. */
CHECKED mrt_result reload_start(reload **out, const reload_settings *settings, error *err);
/* [main] After the layer is destroyed; NULL is fine. */
void reload_stop(reload *self);

/* [main] With is_asked: the instance that pulls now, which stays until the next call. */
instance *reload_current(reload *self);

/* [frame] Between two samples. True: another version pulls from the next sample on. */
bool reload_step(reload *self, layer *of);
/* [frame] Of the version that pulls: "id version sha256", as recorder.h. Before the first: "". */
const char *reload_identity(const reload *self);

typedef struct reload_counts {
    uint32_t taken, refused;
    int64_t last_ns; /* from seeing the file change until it pulled */
} reload_counts;
reload_counts reload_counted(const reload *self); /* [any] */

#endif
