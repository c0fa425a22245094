/* window/panels/say_it.h - the exercise "Say it": goals (faces, then words), the distance of the
 * performed face from a goal, and the progress. A face is done when it stays close enough for a
 * short time, which is shorter within a word. Leaves out drawing and the stage. Pure; no
 * allocation. */
#ifndef MAROTTE_UI_WINDOW_PANELS_SAY_IT_H
#define MAROTTE_UI_WINDOW_PANELS_SAY_IT_H
#include "face/rig.h"
#include "stage/live/live_view.h"

enum { GOAL_POSES = 2, GOAL_STEPS = 6, GOAL_FACES = 12, GOAL_COUNT = 22 };
typedef struct goal_step {
    const char *name;             /* "smile" */
    const char *pose[GOAL_POSES]; /* poses of the rig that are added; NULL: end */
} goal_step;
typedef struct goal {
    const char *name;           /* "smile", "mama" */
    goal_step step[GOAL_STEPS]; /* a face has one step; a shorter list ends with name NULL */
} goal;
/* GOAL_FACES faces, followed by words. */
extern const goal goals[GOAL_COUNT];
uint32_t goal_step_count(const goal *of);
/* Returns whether the rig has all poses of the goal. */
bool goal_is_available(const goal *of, const rig *r);

/* ---- distance of a face ---- */

typedef struct goal_face {               /* in the terms of a rig pose */
    vec3 pull_mm[LIVE_CONTACTS_MAX];     /* of each contact, with the bones at neutral */
    double dof_mm[MRT_MAX_DOFS];         /* distance by which it moves lip, iris or lid */
    bool has_contact[LIVE_CONTACTS_MAX]; /* the contact is in the half of the face of this pose */
    bool has_dof[MRT_MAX_DOFS];
    uint32_t contact_count, dof_count;
} goal_face;
/* r: with complete poses. Returns false if the rig lacks a pose. */
bool goal_face_of_rig(goal_face *out, const goal_step *step, const rig *r, const mrt_face *about);
/* posed_dof: MRT_MAX_DOFS values, used for degrees of freedom that the pull does not drive. */
void goal_face_of_pull(goal_face *out, const mrt_pull *pull, const float *posed_dof,
                       const mrt_face *about);

typedef struct goal_distance {
    double off_mm;   /* root mean square over what the goal moves; other movements also count */
    double limit_mm; /* close enough: 2 mm, or 15 % of the goal's size if larger, but at most half
                        of that size */
    double closed;   /* 0: as far away as the neutral face; 1: close enough */
} goal_distance;
goal_distance goal_measure(const goal_face *wanted, const goal_face *performed);

/* ---- the exercise ---- */

typedef struct say_it {
    uint32_t at, step;         /* goal and its step; GOAL_COUNT: exercise finished */
    bool is_met[GOAL_COUNT];   /* in this run */
    double took_s[GOAL_COUNT]; /* for the goals that are done */
    double held_s,
        since_s; /* time for which the step is close enough; time since the goal appeared */
    bool is_there[GOAL_COUNT]; /* available on the current face */
} say_it;
/* Starts with the first goal. r NULL: no goal is available. */
void say_it_begin(say_it *self, const rig *r);
/* Returns the step to perform, or NULL if the exercise is finished. */
const goal_step *say_it_step(const say_it *self);
/* Advances the time. Returns true if the step was done; the next step is then current. */
bool say_it_update(say_it *self, const goal_distance *how, double dt_s);
void say_it_skip(say_it *self);
void say_it_back(say_it *self);
uint32_t say_it_progress(const say_it *self, uint32_t *out_of, double *out_s);

#endif
