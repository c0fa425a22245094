/* face/face_weights.h - a face as weights of shapes that other programs know by name: ARKit's 52
 * with Live Link Face's 9 turns, VRM's expressions, and visemes. They are computed from the face
 * shown, so they do not depend on the mapping. The method is bounded least squares over some
 * hundred points of the skin and the bones' degrees of freedom.
 *
 * A name stands for the mesh's own shape of that name (face_shape_parts: or its expression), else
 * for the rig's pose. A shape consists of bones at theta_k and of offsets d_k of the points,
 * measured with the bones back at rest. y are the offsets of the points shown, measured likewise,
 * and t are the degrees of freedom:
 *   min sum_i |y_i - sum_k w_k d_ik|^2 + sum_j s_j^2 (t_j - sum_k w_k theta_jk)^2 + ridge,
 *   0 <= w_k <= 1
 * This is exact for a face that is such a mixture, however far its jaw is open or its head is
 * turned. The gaze is read from the bones of the eyes. mouthClose is at most jawOpen. Expressions
 * and visemes are separate problems. If a mesh or rig has none of that name, they are sums of the
 * 52.
 *
 * Leaves out the programs that receive the weights, and the transport to them. create, destroy:
 * [main], or a worker. solve: one thread at a time; no allocation; the same calls give the same
 * bits. */
#ifndef MAROTTE_FACE_WEIGHTS_H
#define MAROTTE_FACE_WEIGHTS_H
#include "face/face.h"
#include "mesh/arkit.h"

enum { FACE_EXPRESSIONS = 18, FACE_VISEMES = 16, FACE_WEIGHTS_POINTS = 320 };

/* Names of VRM 1.0: "happy", "aa", "blinkLeft", "lookUp", "neutral" ... */
extern const char *const face_expression_name[FACE_EXPRESSIONS];
/* Names of Oculus LipSync, "sil", "PP" ... "U", and its "laughter". */
extern const char *const face_viseme_name[FACE_VISEMES];

typedef struct face_channels {
    /* In the order of arkit_name: the shapes 0..1, then turns in rad: the head's to the face's
     * own left, up, and to its left shoulder, then the eyes' likewise. 0 for channels without a
     * source. */
    double arkit[ARKIT_CHANNELS];
    double expression[FACE_EXPRESSIONS], viseme[FACE_VISEMES]; /* 0..1 */
    double residual_mm; /* RMS over the points of the motion that the 52 cannot express */
} face_channels;

typedef enum face_name_source {
    FACE_NAME_NONE = 0, /* no source: always 0 */
    FACE_NAME_SHAPE,    /* the mesh's own shape */
    FACE_NAME_POSE,     /* a pose of the rig */
    FACE_NAME_BONES     /* the bones of the head and the eyes */
} face_name_source;

typedef struct face_weights face_weights;

/* f: a face of the rig that nothing else uses during the call; it is at rest afterwards. Its rig
 * may have more poses than r (rig_poses_transfer). r and m must outlive out; the face need not. */
CHECKED mrt_result face_weights_create(face_weights **out, face *f, const rig *r, const mesh *m,
                                       error *err);
void face_weights_destroy(face_weights *self); /* NULL is fine */

/* Computes the weights. position: vertex_count by 3, mm, in the mesh file's order, as shown. dof:
 * the pose of the bones for it (face_meter.dof). The search begins at the weights of the last call,
 * which can change the last digits (less than 1e-4). If a value is not finite, the last result
 * stays. The result is valid until the next call. */
const face_channels *face_weights_solve(face_weights *self, const float *position,
                                        const float *dof);
/* Vertices of the mesh file that solve reads from a position; valid as long as self. [any] */
const uint32_t *face_weights_points(const face_weights *self, uint32_t *out_count);

/* Source of an ARKit channel. The source of turns is the bones. */
face_name_source face_weights_source(const face_weights *self, uint32_t channel);

#endif
