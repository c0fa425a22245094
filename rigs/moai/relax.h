/* rigs/moai/relax.h - moves the vertices of a skin, without changing its edges: onto the form, into
 * its creases, and evenly spread. Pure; any thread. */
#ifndef MAROTTE_RIGS_MOAI_RELAX_H
#define MAROTTE_RIGS_MOAI_RELAX_H
#include "form.h"
#include "skin.h"

typedef struct relax_plane { /* a tangent plane of the form, and how much skin it stands for */
    vec3 point, normal;
    double area;
} relax_plane;

/* How far an edit may turn a triangle: the least cosine between its old and new normal. */
#define RELAX_TURN_COSINE 0.2

/* One round. planes: room for three per triangle of the skin, the dead included. */
void relax_round(skin *s, const form *shape, relax_plane *planes);

#endif
