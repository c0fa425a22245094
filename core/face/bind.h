/* face/bind.h - a rig laid on its mesh: per vertex the bones that move it, how freely it can be
 * pulled, and where the contacts are. Arrays in the file's order. [main] makes it; read-only then.
 */
#ifndef MAROTTE_FACE_BIND_H
#define MAROTTE_FACE_BIND_H
#include "face/rig.h"
#include "mesh/mesh.h"
#include "mesh/topology.h"

/* What the rig's regions say, before anything is filled in. */
typedef struct bind_marks {
    uint32_t *rigid_bone; /* vertex_count: the bone that a vertex is rigid on, or RIG_NONE */
    float *weight;        /* bone_count by vertex_count: 0..1 where marked, NaN where free */
    float *mobility;      /* vertex_count: 0..1 where marked, NaN where free */
} bind_marks;
CHECKED mrt_result bind_marks_create(bind_marks *out, const rig *r, const mesh *m,
                                     const topology *t, error *err);
/* The same without what is painted (rig_region_is_paint). A bone may have no vertex. */
CHECKED mrt_result bind_marks_create_bare(bind_marks *out, const rig *r, const mesh *m,
                                          const topology *t, error *err);
void bind_marks_destroy(bind_marks *marks);

/* The mesh's focus (mesh_focus): around what no region gives to a body, a bone that the skull turns
 * on; none where there is no body. */
void bind_focus(mesh *m, const rig *r, const topology *t);

/* Evaluates a selector: out (vertex_count) 0..1. Out of a budget, as the marks. */
CHECKED mrt_result bind_select(float *out, const rig_select *select, const mesh *m,
                               const topology *t, error *err);

typedef struct bind_start { /* a vertex, and how far it is already, mm */
    uint32_t vertex;
    double distance_mm;
} bind_start;
/* How far vertices are along the edges of the surface from the nearest of several. out_distance:
 * vertex_count, mm; infinite beyond reach_mm and where no edges lead. false: no memory. Any
 * thread. */
CHECKED bool bind_distances(double *out_distance, const bind_start *start, uint32_t start_count,
                            double reach_mm, const mesh *m, const topology *t);

/* A place on a rim: between two of its vertices. */
typedef struct bind_station {
    uint32_t vertex[2];
    double along; /* 0..1, from the first to the second */
} bind_station;

enum { BIND_FAULT = 256 };

/* The slit between the lips (rig_mouth) in stations from the subject's right corner to the left:
 * each is a point of the upper rim, and the point of the lower rim that it faces. */
typedef struct bind_lips {
    bind_station *upper, *lower; /* station_count each */
    uint32_t station_count;      /* 0: the lips cannot be sealed */
    vec3 across, up;             /* unit: to the left corner, and square to it */
    double width_mm;             /* from corner to corner */
    float *of_upper, *of_lower;  /* vertex_count: how far a vertex goes with that rim, 0..1; by
                                    distances along the surface, so never across the slit */
    char why_not[BIND_FAULT]; /* one sentence: why a mouth that the rig declares cannot be sealed */
} bind_lips;

/* Where a station is at rest, mm. */
vec3 bind_station_position(const bind_station *station, const mesh *m);

typedef struct binding {
    uint32_t vertex_count, bone_count;
    float *weight;                           /* bone_count by vertex_count; sums to 1 within 1e-6 */
    float *mobility;                         /* vertex_count, 0..1 */
    vec3 *contact_position, *contact_normal; /* per contact: mm, unit outward */
    bind_lips lips;
} binding;

/* Marks, then the fill over the surface. A contact that names its bone rides on it wholly. A NULL
 * rig: one bone, everything free (t may be NULL then). */
CHECKED mrt_result binding_create(binding *out, const rig *r, const mesh *m, const topology *t,
                                  error *err);
/* One sentence: why the mouth that the rig declares cannot be sealed; "": it can, or it declares
 * none. */
CHECKED mrt_result bind_lips_fault(char out[BIND_FAULT], const rig *r, const mesh *m,
                                   const topology *t, error *err);
/* contact_count: of the rig it was made for; 0: of none. */
CHECKED mrt_result binding_copy(binding *out, const binding *b, uint32_t contact_count, error *err);
void binding_destroy(binding *b);

#endif
