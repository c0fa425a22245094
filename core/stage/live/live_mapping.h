/* live/live_mapping.h - a mapping that performs: its instance, in a process of its own where it did
 * not come with the program, and watched for being rebuilt. And the one that maps nothing. [main]
 */
#ifndef MAROTTE_STAGE_LIVE_MAPPING_H
#define MAROTTE_STAGE_LIVE_MAPPING_H
#include "stage/mapping/plugins.h"
#include "stage/perform/reload.h"

typedef struct live_mapping_role {
    char *text;          /* "one_hand,smile=8"; "" none */
    const char *library; /* NULL: none */
    instance instance;
    isolate_settings isolation;
    isolate *isolate;
    reload *reload;
} live_mapping_role;

/* text: "PLUGIN[,key=value]"; NULL or "": nothing. It does not move afterwards. */
CHECKED mrt_result live_mapping_create(live_mapping_role **out, const char *text,
                                       const plugin_list *plugins, log_queue *log, error *err);
/* It is active on `about`. */
CHECKED mrt_result live_mapping_watch(live_mapping_role *self, const mrt_face *about,
                                      log_queue *log, error *err);
/* What pulls now; until the next call. */
instance *live_mapping_now(live_mapping_role *self);
bool live_mapping_is_nothing(const live_mapping_role *self);
isolate_counts live_mapping_isolated(live_mapping_role *self);
void live_mapping_deactivate(instance *pulled);
void live_mapping_destroy(live_mapping_role *self); /* deactivated before; NULL is fine */

#endif
