/* stage/perform/reload.h - replaces a mapping whose library is rebuilt while it performs. The new
 * version is loaded beside the old one, checked, and given the parameters and state of the old one.
 * It replaces the old version between two samples without a jump (layer_switch). A version that
 * fails a check is refused, and the old one continues. A separate thread does everything except the
 * switch. Libraries that ran are never unloaded. */
#ifndef MAROTTE_STAGE_RELOAD_H
#define MAROTTE_STAGE_RELOAD_H
#include "stage/mapping/isolate.h"
#include "stage/perform/layer.h"

typedef struct reload reload;

typedef struct reload_settings {
    const char *library; /* path of the library file to watch */
    instance *mapping;   /* the current, active mapping; owned by the caller */
    const mapped_face *mapped;
    log_queue *log;
    instance_clock clock;
    const isolate_settings *isolate; /* new versions run in separate processes; NULL: in this one */
    bool is_asked; /* [main] reads the current instance: no version is destroyed before the next
                      reload_current */
} reload_settings;

/* [main] The face and the log must outlive the result. */
CHECKED mrt_result reload_start(reload **out, const reload_settings *settings, error *err);
/* [main] Call after the layer is destroyed. Accepts NULL. */
void reload_stop(reload *self);

/* [main] Returns the current instance. With is_asked it is valid until the next call. */
instance *reload_current(reload *self);

/* [frame] Call between two samples. Returns true if it switched to another version, which performs
 * the next sample. */
bool reload_step(reload *self, layer *of);
/* [frame] Returns the identity of the current version as in recorder.h: "id version sha256". "": no
 * version was switched yet. */
const char *reload_identity(const reload *self);

typedef struct reload_counts {
    uint32_t taken, refused;
    int64_t last_ns; /* from the change of the file until the switch was complete */
} reload_counts;
reload_counts reload_get_counts(const reload *self); /* [any] */

#endif
