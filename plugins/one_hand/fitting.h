/* one_hand/fitting.h - a pose laid on the face there is: which contacts and degrees of freedom it
 * has, how large it is, and what stands in for what it lacks. [main] fitting_find and
 * fitting_report, [frame] fitting_write. */
#ifndef MAROTTE_PLUGINS_ONE_HAND_FITTING_H
#define MAROTTE_PLUGINS_ONE_HAND_FITTING_H
#include "maps.h"

#define FITTING_NONE UINT32_MAX

typedef struct fitting {
    uint32_t contact[LANDMARK_COUNT]; /* of the face, or FITTING_NONE */
    uint32_t dof[DOF_COUNT];
    mrt_vec3 start[LANDMARK_COUNT];
    double low[DOF_COUNT], high[DOF_COUNT]; /* of a pose's values: what the face can show */
    double lowest[DOF_COUNT];               /* low, but lids may open wide */
    double closed[DOF_COUNT];               /* lids: the dof's value when closed */
    double scale;                           /* mm of this face per mm of a pose */
    uint32_t contact_count, dof_count;      /* found */
} fitting;

/* False: nothing that a hand could move. */
bool fitting_find(fitting *out, const mrt_face *face);
/* What was found and what is missing, as a few lines. */
void fitting_report(const fitting *self, const mrt_host *host);
/* closure: of a blink, 0 .. 1, over the lids of the pose. Changes pull->anchor only when the
 * vectors of `pull` were not these contacts' before. */
void fitting_write(const fitting *self, const pose *shown, double closure, const double *params,
                   mrt_pull *pull);
/* As the classic modes write it. */
void fitting_write_classic(const fitting *self, const pose *shown, double closure,
                           const double *params, mrt_pull *pull);
/* Adds a share of a rig's pose: of the contacts and degrees of freedom found. */
void fitting_add(pose *out, const fitting *self, const mrt_rig_pose *from, double share);

#endif
