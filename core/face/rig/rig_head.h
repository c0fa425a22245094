/* face/rig/rig_head.h - where a head's nose, mouth and chin are, found in its profile: the measures
 * that drafting and checking a rig start from. Right for heads that look along +z with a nose and a
 * chin; a person confirms. Pure but for scratch memory; any thread. */
#ifndef MAROTTE_FACE_RIG_HEAD_H
#define MAROTTE_FACE_RIG_HEAD_H
#include "base/rigid.h"
#include "mesh/mesh.h"

enum { RIG_GROOVE = 25 };

typedef struct rig_head {    /* mm */
    double middle_x;         /* the symmetry plane */
    vec3 nose, chin;         /* the tip; the lowest point of the front that is still face */
    double nose_mm;          /* how far it comes out beyond what is beside it */
    double mouth_y, mouth_z; /* between the lips, in front */
    bool has_touching_lips;  /* the skin is there twice, in the middle of the mouth */
    double mouth_depth; /* how deep it is between the lips, of what is around: 0 no mouth is seen */
    double lip_upper_y, lip_lower_y; /* where the lips come forward again */
    double corner_x;                 /* of the mouth, from the middle; 0: not seen */
    double groove_y[RIG_GROOVE]; /* between the lips, from the middle to corner_x in equal steps */
    double top_y, back_z;        /* of what is above the chin */
    double half_width;           /* of the face's front, at the height of the nose */
} rig_head;

/* is_face: vertex_count: 0 for what is not to be looked at, hair and bodies; NULL: all is the
 * head's. Unsupported where there is no profile to read. */
CHECKED mrt_result rig_head_measure(rig_head *out, const mesh *m, const uint8_t *is_face,
                                    error *err);

/* Where a ray along -z at x, y meets the mesh first, and the corner nearest to it; false: nowhere.
 */
bool rig_head_hit(vec3 *out_point, uint32_t *out_vertex, const mesh *m, const uint8_t *is_face,
                  double x, double y);

/* ---- left and right: mirror images in a plane x = c ---- */

/* How many vertices have no other one (or themselves) within reach_mm of their mirror image;
 * out_example: one of them. is_face: of those; NULL: of all. false: no memory. */
CHECKED bool rig_mirror_count_alone(uint32_t *out_count, uint32_t *out_example, const mesh *m,
                                    const uint8_t *is_face, double middle_x, double reach_mm);

/* The vertex nearest to the mirror image of `vertex`, and how far it is from it, mm. Looks at
 * every vertex; is_face: of those. */
uint32_t rig_mirror_of(const mesh *m, const uint8_t *is_face, uint32_t vertex, double middle_x,
                       double *out_distance_mm);

#endif
