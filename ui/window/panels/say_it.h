/* window/panels/say_it.h - the exercise "Say it": faces and then words, how near the performed face
 * is to each, and when it is met. Leaves out drawing and the stage. A face is met when it stays
 * near enough for a moment; in a word that moment is shorter. Pure; no allocation. */
#ifndef MAROTTE_UI_WINDOW_PANELS_SAY_IT_H
#define MAROTTE_UI_WINDOW_PANELS_SAY_IT_H
#include "face/rig.h"
#include "stage/live/live_view.h"

enum { GOAL_POSES = 2, GOAL_STEPS = 6, GOAL_FACES = 12, GOAL_COUNT = 22 };
typedef struct goal_step {
    const char *name;             /* "smile" */
    const char *pose[GOAL_POSES]; /* of the rig, added; NULL: no more */
} goal_step;
typedef struct goal {
    const char *name;           /* "smile", "mama" */
    goal_step step[GOAL_STEPS]; /* a face has one; ends with name NULL where it has fewer */
} goal;
/* GOAL_FACES faces, then words. */
extern const goal goals[GOAL_COUNT];
uint32_t goal_step_count(const goal *of);
/* Every pose of it is in the rig. */
bool goal_is_there(const goal *of, const rig *r);

/* ---- how near a face is ---- */

typedef struct goal_face {               /* as a rig's pose says it */
    vec3 pull_mm[LIVE_CONTACTS_MAX];     /* of each contact, with the bones at rest */
    double dof_mm[MRT_MAX_DOFS];         /* as far as it moves lip, iris or lid */
    bool has_contact[LIVE_CONTACTS_MAX]; /* it belongs to the half of the face that the pose has */
    bool has_dof[MRT_MAX_DOFS];
    uint32_t contact_count, dof_count;
} goal_face;
/* r: with complete poses. False: a pose is not in the rig. */
bool goal_face_of_rig(goal_face *out, const goal_step *step, const rig *r, const mrt_face *about);
/* posed_dof: MRT_MAX_DOFS, for those that the pull does not drive. */
void goal_face_of_pull(goal_face *out, const mrt_pull *pull, const float *posed_dof,
                       const mrt_face *about);

typedef struct goal_distance {
    double off_mm;   /* root mean square over what the goal moves; what else moves counts too */
    double limit_mm; /* near enough: 2 mm, or 15 % of the goal's own size if that is more; at most
                        half of that size */
    double closed;   /* 0: as far as a face at rest; 1: near enough */
} goal_distance;
goal_distance goal_measure(const goal_face *wanted, const goal_face *performed);

/* ---- the exercise ---- */

typedef struct say_it {
    uint32_t at, step;         /* goal and step of it; GOAL_COUNT: over */
    bool is_met[GOAL_COUNT];   /* in this run */
    double took_s[GOAL_COUNT]; /* of those that were met */
    double held_s, since_s;    /* that the step is near enough; since the goal was shown */
    bool is_there[GOAL_COUNT]; /* of the face on the stage */
} say_it;
/* From the first goal on. r NULL: none is there. */
void say_it_begin(say_it *self, const rig *r);
/* The step to be performed; NULL: the exercise is over. */
const goal_step *say_it_step(const say_it *self);
/* Time goes on. True: the step was met, and the next one is shown. */
bool say_it_look(say_it *self, const goal_distance *how, double dt_s);
void say_it_skip(say_it *self);
void say_it_back(say_it *self);
uint32_t say_it_met(const say_it *self, uint32_t *out_of, double *out_s);

#endif
