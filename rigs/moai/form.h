/* rigs/moai/form.h - what a skin is fitted to: a shape given as a function, and the sizes of
 * triangles wanted on it. Pure; any thread. */
#ifndef MAROTTE_RIGS_MOAI_FORM_H
#define MAROTTE_RIGS_MOAI_FORM_H
#include "base/rigid.h"

typedef struct form {
    double (*distance)(vec3); /* mm, below 0 inside; need only be good near the surface */
    double (*edge_mm)(vec3);  /* the length of edges wanted at a point */
    double edge_scale;        /* times this */
} form;

double form_wanted_mm(const form *shape, vec3 p);
/* Of the distance, by central differences. */
vec3 form_gradient(const form *shape, vec3 p);
/* The part of a move that what a vertex holds (skin.h) allows. */
vec3 form_masked(vec3 move, int hold);
/* Newton steps of at most reach_mm from p to the surface, in the directions allowed. */
vec3 form_projected(const form *shape, vec3 p, int hold, double reach_mm);

static inline vec3 form_middle(vec3 a, vec3 b)
{
    return vec3_scale(vec3_add(a, b), 0.5);
}

#endif
