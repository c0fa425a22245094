/* stage/perform/composer_state.h - what a composer is made of. Inside composer*.c. */
#ifndef MAROTTE_STAGE_COMPOSER_STATE_H
#define MAROTTE_STAGE_COMPOSER_STATE_H
#include "stage/composer.h"

/* One who speaks: what it wants now, and what of it is in the shape. */
typedef struct voice {
    bool is_present;  /* in this step */
    bool was_present; /* in the step before */
    composer_part part;
    bool has_said; /* `said` is its last anchored pull */
    mrt_pull said;
    uint32_t commit; /* of the step before */
    /* in the engagement: the pull that it holds the face with */
    bool is_joined;
    mrt_pull joined;
    double share; /* weight and gain */
    double weight;
    uint32_t control[MRT_MAX_VECTORS]; /* of each vector; COMPOSER_NO_CONTROL: none */
    /* unanchored */
    bool was_near, is_dragging;
    double tip[MRT_MAX_VECTORS * 3]; /* where the tips really are */
    uint32_t tip_count;
} voice;

enum { COMPOSER_NO_CONTROL = UINT32_MAX };

/* A control of the engagement: a contact, which several may pull, or a free point of one. */
typedef struct joined_control {
    uint32_t contact;      /* 1 + index; 0: a free point */
    uint32_t slot, vector; /* of the free point */
    vec3 start;            /* mm, where it took hold */
    vec3 rest;             /* of a finger's free point: as it says */
    bool is_finger;        /* only fingers speak of it */
    vec3 held; /* mm, bones at rest: where the others had it, from `start`, when a finger came */
} joined_control;

struct composer {
    face *face;
    mrt_face about;
    mrt_dof dof[MRT_MAX_DOFS];
    csrbf_settings solver;
    double reach_mm;
    vec3 centre;
    shading *shading;

    voice voice[COMPOSER_PARTS_MAX];
    uint32_t order[COMPOSER_PARTS_MAX]; /* slots of the parts of this step, bottom first */
    uint32_t order_count;
    uint32_t joined_order[COMPOSER_PARTS_MAX]; /* slots of those in the engagement, bottom first */
    uint32_t joined_count;

    bool is_mixed; /* in this step some knead and some are anchored */
    bool engaged;  /* anchored: the face is engaged at `control` */
    bool stale;    /* anchored: what is shown is older than the last step */
    joined_control control[MRT_MAX_VECTORS];
    uint32_t control_count;
    float engaged_radius_mm;
    mrt_pull pulled; /* of the last step */
    composer_counts counts;
};

void composer_note_problem(composer *self, const char *text);
void composer_show(composer *self); /* if stale */
/* how: the pull that says how it is solved; NULL: nobody does. */
csrbf_settings composer_settings(const composer *self, float radius_mm, const mrt_pull *how);

/* ---- composer_join.c: the anchored voices ---- */

void composer_join(composer *self);
/* The face as if the voices pulled nothing but what `keep` has added; bones as they are. */
void composer_let_go_but(composer *self, bool (*keep)(const voice *v));
/* Bakes what a voice that has committed has added; true: one has, and the others join anew. */
bool composer_commit(composer *self);
bool composer_is_anybody_joined(const composer *self);

/* ---- composer_blend.c: what they add up to ---- */

vec3 composer_vec3(mrt_vec3 p);
/* Its weight and its gain. */
double composer_share(const voice *v);
/* Whether one of those that hold the face is counted; NULL: all are. */
bool composer_counts_anybody(const composer *self, bool (*counts)(const voice *v));
/* Where each control of the engagement is to land, 3 * control_count, mm: a way from its start for
 * what rides[k] with the bones, else a place (face_ride). `counts`: whose pull is taken, NULL: all.
 */
void composer_blend_ends(const composer *self, bool (*counts)(const voice *v), double *end,
                         uint8_t *rides);
/* The degrees of freedom as all voices together want them. */
void composer_blend_dofs(const composer *self, float *out);

#endif
