/* one_hand/fitting.h - applies a pose to the current face: which contacts and degrees of freedom
 * the face has, its size, and substitutes for missing ones. [main] fitting_find and fitting_report,
 * [frame] fitting_write. */
#ifndef MAROTTE_PLUGINS_ONE_HAND_FITTING_H
#define MAROTTE_PLUGINS_ONE_HAND_FITTING_H
#include "maps.h"

#define FITTING_NONE UINT32_MAX

typedef struct fitting {
    uint32_t contact[LANDMARK_COUNT]; /* index in the face, or FITTING_NONE */
    uint32_t dof[DOF_COUNT];
    mrt_vec3 start[LANDMARK_COUNT];
    double low[DOF_COUNT], high[DOF_COUNT]; /* range of a pose's values that the face can show */
    double lowest[DOF_COUNT];               /* like low, but lids may open wider */
    double closed[DOF_COUNT];               /* lids: the dof's value when closed */
    double scale;                           /* mm of this face per mm of a pose */
    uint32_t contact_count, dof_count;      /* found */
} fitting;

/* Returns false if the face has nothing that a hand can move. */
bool fitting_find(fitting *out, const mrt_face *face);
/* Logs the parts found and missing, in a few lines. */
void fitting_report(const fitting *self, const mrt_host *host);
/* Writes the pull. closure: of a blink, 0 .. 1, on top of the lids of the pose. Changes
 * pull->anchor only if the previous vectors of `pull` were not these contacts'. */
void fitting_write(const fitting *self, const pose *shown, double closure, const double *params,
                   mrt_pull *pull);
/* Writes the pull of the classic modes. */
void fitting_write_classic(const fitting *self, const pose *shown, double closure,
                           const double *params, mrt_pull *pull);
/* Adds a share of a rig's pose, for the contacts and degrees of freedom found. */
void fitting_add(pose *out, const fitting *self, const mrt_rig_pose *from, double share);

#endif
