/* face/rig/rig_head.h - the nose, mouth and chin of a head, found in its profile. Drafts and checks
 * of a rig start from these measures. They are right for heads that look along +z and have a nose
 * and a chin; a person confirms them. Pure except for scratch memory. [any] */
#ifndef MAROTTE_FACE_RIG_HEAD_H
#define MAROTTE_FACE_RIG_HEAD_H
#include "base/rigid.h"
#include "mesh/mesh.h"

enum { RIG_GROOVE = 25 };

typedef enum head_doubt { /* why a person must look where the face is */
                          HEAD_NO_DOUBT = 0,
                          HEAD_PLAIN,   /* its shape shows no nose and no mouth: they are placed by
                                           proportions */
                          HEAD_UNEVEN,  /* the left side of the face is no mirror image of the right
                                           one */
                          HEAD_UNUSUAL, /* the chin lies too near to the nose, or too far below it
                                         */
} head_doubt;

typedef struct rig_head { /* mm */
    double middle_x;      /* x of the symmetry plane */
    vec3 nose, chin;      /* tip of the nose; lowest point of the front that belongs to the face */
    double nose_mm;       /* how far the nose stands out from the skin beside it */
    double mouth_y, mouth_z; /* between the lips, in front */
    bool has_touching_lips;  /* two layers of skin coincide in the middle of the mouth */
    double mouth_depth;      /* depth of the groove between the lips below its surroundings; 0 if no
                                mouth is found */
    double lip_upper_y, lip_lower_y; /* heights where the lips stand out again */
    double corner_x; /* distance of the corner of the mouth from the middle; 0 if not found */
    double groove_y[RIG_GROOVE]; /* of the groove, in equal steps from the middle to corner_x */
    double top_y, back_z;        /* of the part above the chin */
    double half_width;           /* of the face's front at the height of the nose */
    head_doubt doubt;
} rig_head;

/* Measures the head. is_face has vertex_count values: 0 for vertices to ignore, such as those of
 * hair and bodies. NULL: all belong to the head. Returns MRT_ERR_UNSUPPORTED if the middle plane
 * cuts no profile of a face. */
CHECKED mrt_result rig_head_measure(rig_head *out, const mesh *m, const uint8_t *is_face,
                                    error *err);

/* Finds where a ray along -z at x, y first meets the mesh, and the nearest corner of that triangle.
 * Returns false if it misses. */
bool rig_head_hit(vec3 *out_point, uint32_t *out_vertex, const mesh *m, const uint8_t *is_face,
                  double x, double y);

/* ---- left and right: mirror images in a plane x = c ---- */

/* Counts the vertices without a partner (another vertex, or itself) within reach_mm of their mirror
 * image; out_example: one of them. is_face: the vertices to include; NULL: all. Returns false
 * without memory. */
CHECKED bool rig_mirror_count_alone(uint32_t *out_count, uint32_t *out_example, const mesh *m,
                                    const uint8_t *is_face, double middle_x, double reach_mm);

/* Returns the vertex nearest to the mirror image of `vertex`, and their distance in mm. Searches
 * all vertices of is_face. */
uint32_t rig_mirror_of(const mesh *m, const uint8_t *is_face, uint32_t vertex, double middle_x,
                       double *out_distance_mm);

#endif
