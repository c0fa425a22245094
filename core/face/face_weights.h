/* face/face_weights.h - a face as weights of shapes that other programs know by name: ARKit's 52
 * with Live Link Face's 9 turns, VRM's expressions, visemes. They are found from what the face
 * shows, whoever pulls it and however: by bounded least squares over some hundred points of its
 * skin and the degrees of freedom of its bones.
 *
 * What a name means is the mesh's own shape of that name (face_shape_parts: or its expression),
 * else the rig's pose. A shape is bones at theta_k and, with these taken back, offsets d_k of the
 * points.
 * With y the offsets of the points shown, the bones taken back likewise, and t the degrees of
 * freedom: min sum_i |y_i - sum_k w_k d_ik|^2 + sum_j s_j^2 (t_j - sum_k w_k theta_jk)^2 + ridge,
 *   0 <= w_k <= 1
 * which is exact for a face that is such a mixture, however far its jaw is open or its head turned.
 * What eyes look at is read from their bones. mouthClose is at most jawOpen.
 * Expressions and visemes are each a problem of their own: of a mesh or rig that has none of that
 * name they are sums of the 52.
 *
 * Leaves out who asks for them, and the way to there. create, destroy: [main], or a worker. solve:
 * any one thread at a time; no allocation; the same calls give the same bits. */
#ifndef MAROTTE_FACE_WEIGHTS_H
#define MAROTTE_FACE_WEIGHTS_H
#include "face/face.h"
#include "mesh/arkit.h"

enum { FACE_EXPRESSIONS = 18, FACE_VISEMES = 16, FACE_WEIGHTS_POINTS = 320 };

/* VRM 1.0's: "happy", "aa", "blinkLeft", "lookUp", "neutral" ... */
extern const char *const face_expression_name[FACE_EXPRESSIONS];
/* Those of Oculus LipSync, "sil", "PP" ... "U", and its "laughter". */
extern const char *const face_viseme_name[FACE_VISEMES];

typedef struct face_channels {
    /* In the order of arkit_name: the shapes 0..1; then turns, rad, of the head to the face's own
     * left, up, and to its left shoulder, and of the eyes likewise. 0 where nothing says it. */
    double arkit[ARKIT_CHANNELS];
    double expression[FACE_EXPRESSIONS], viseme[FACE_VISEMES]; /* 0..1 */
    double residual_mm; /* root mean square over the points: of the face what the 52 do not say */
} face_channels;

typedef enum face_name_source {
    FACE_NAME_NONE = 0, /* nothing says it: always 0 */
    FACE_NAME_SHAPE,    /* the mesh's own */
    FACE_NAME_POSE,     /* of the rig */
    FACE_NAME_BONES     /* of the head and the eyes */
} face_name_source;

typedef struct face_weights face_weights;

/* Of a face of the rig's that is nobody's at the moment: it is at rest afterwards. Its rig may have
 * more poses than r (rig_poses_carry). r and m must outlive out, the face need not. */
CHECKED mrt_result face_weights_create(face_weights **out, face *f, const rig *r, const mesh *m,
                                       error *err);
void face_weights_destroy(face_weights *self); /* NULL is fine */

/* position: vertex_count by 3, mm, in the mesh file's order, as shown; dof: how its bones were
 * posed for that (face_meter.dof). The weights of the call before are where the search begins,
 * which may change the last digits (less than 1e-4). Not finite: what was said last stays. Until
 * the next call. */
const face_channels *face_weights_solve(face_weights *self, const float *position,
                                        const float *dof);
/* [any] The vertices that are read of a position, of the mesh file; as long as it lives. */
const uint32_t *face_weights_points(const face_weights *self, uint32_t *out_count);

/* Of an ARKit channel; turns are of bones. */
face_name_source face_weights_source(const face_weights *self, uint32_t channel);

#endif
