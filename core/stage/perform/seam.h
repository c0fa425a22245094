/* stage/perform/seam.h - an interface of types that the program itself makes: behind one instance
 * several take turns in filling the pull, and the layer has to know when, so that the face goes
 * over from one to the next without a jump. No plugin answers it. */
#ifndef MAROTTE_STAGE_SEAM_H
#define MAROTTE_STAGE_SEAM_H
#include <marotte/plugin.h>

#define STAGE_SEAM "marotte.stage.seam/1"
typedef struct stage_seam {
    /* [frame] Before process, while the layer is not between two pulls already: whether another one
     * fills the pull from this call on. `pull` is what process will be given; it may be changed to
     * what the other one held last. */
    bool (*take_turn)(mrt_plugin *self, mrt_pull *pull);
    /* Of the mapping that was wrapped; what it is known by elsewhere. */
    const mrt_plugin_type *(*inner)(const mrt_plugin_type *outer);
} stage_seam;

#endif
