/* face/bind.h - a rig applied to its mesh: the weights of the bones and the mobility per vertex,
 * and the places of the contacts. Arrays are in the file's order. Created on [main], read-only
 * afterwards. */
#ifndef MAROTTE_FACE_BIND_H
#define MAROTTE_FACE_BIND_H
#include "face/rig.h"
#include "mesh/mesh.h"
#include "mesh/topology.h"

/* The values that the rig's regions set, before the fill. */
typedef struct bind_marks {
    uint32_t *rigid_bone; /* vertex_count: the bone that a vertex is rigid on, or RIG_NONE */
    float *weight;        /* bone_count by vertex_count: 0..1 where marked, NaN where free */
    float *mobility;      /* vertex_count: 0..1 where marked, NaN where free */
} bind_marks;
CHECKED mrt_result bind_marks_create(bind_marks *out, const rig *r, const mesh *m,
                                     const topology *t, error *err);
/* The same without painted regions (rig_region_is_paint). A bone may have no vertex. */
CHECKED mrt_result bind_marks_create_bare(bind_marks *out, const rig *r, const mesh *m,
                                          const topology *t, error *err);
void bind_marks_destroy(bind_marks *marks);

/* Sets the mesh's focus (mesh_focus): the vertices that no region gives to a body. A body is a bone
 * that the skull turns on. Without a body the mesh has no focus. Hair that hangs far below the face
 * is cut off. */
void bind_focus(mesh *m, const rig *r, const topology *t);

/* Evaluates a selector: out (vertex_count) 0..1. A budget limits the work, as for the marks. */
CHECKED mrt_result bind_select(float *out, const rig_select *select, const mesh *m,
                               const topology *t, error *err);

typedef struct bind_start { /* a vertex to start from, and its initial distance, mm */
    uint32_t vertex;
    double distance_mm;
} bind_start;
/* Computes the distance of each vertex from the nearest start, along the edges of the surface.
 * out_distance: vertex_count, mm; infinite beyond reach_mm and where no edges lead. Returns false
 * without memory. [any] */
CHECKED bool bind_distances(double *out_distance, const bind_start *start, uint32_t start_count,
                            double reach_mm, const mesh *m, const topology *t);

/* A place on a rim, between two of its vertices. */
typedef struct bind_station {
    uint32_t vertex[2];
    double along; /* 0..1, from the first to the second */
} bind_station;

enum { BIND_FAULT = 256 };

/* The slit between the lips (rig_mouth), as stations from the subject's right corner to the left.
 * Each station is a point of the upper rim and the opposite point of the lower rim. */
typedef struct bind_lips {
    bind_station *upper, *lower; /* station_count each */
    uint32_t station_count;      /* 0 if the lips cannot be sealed */
    vec3 across, up;             /* unit: towards the left corner, and perpendicular to it */
    double width_mm;             /* from corner to corner */
    float *of_upper, *of_lower;  /* vertex_count: how far a vertex moves with that rim, 0..1; based
                                    on distances along the surface, so never across the slit */
    char why_not[BIND_FAULT];    /* message: why a declared mouth cannot be sealed */
} bind_lips;

/* Position of a station at rest, mm. */
vec3 bind_station_position(const bind_station *station, const mesh *m);

typedef struct binding {
    uint32_t vertex_count, bone_count;
    float *weight;                           /* bone_count by vertex_count; sums to 1 within 1e-6 */
    float *mobility;                         /* vertex_count, 0..1 */
    vec3 *contact_position, *contact_normal; /* per contact: mm, unit outward */
    bind_lips lips;
} binding;

/* Evaluates the marks, then fills the weights over the surface. A contact that names its bone moves
 * wholly with it. rig NULL: one bone, everything free (t may be NULL then). */
CHECKED mrt_result binding_create(binding *out, const rig *r, const mesh *m, const topology *t,
                                  error *err);
/* Writes why a declared mouth cannot be sealed. Writes "" if it can be, or if the rig declares
 * none. */
CHECKED mrt_result bind_lips_fault(char out[BIND_FAULT], const rig *r, const mesh *m,
                                   const topology *t, error *err);
/* contact_count: of the rig that b was made for; 0 if it has none. */
CHECKED mrt_result binding_copy(binding *out, const binding *b, uint32_t contact_count, error *err);
void binding_destroy(binding *b);

#endif
