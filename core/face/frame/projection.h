/* face/frame/projection.h - skin slides over the skull but never enters it (research, theory 4.3):
 * a one-sided, smooth projection out of ellipsoids that ride on bones. In the ellipsoid's scaled
 * space q = (x - centre) / radii a vertex has the height h = |q| - 1; h0 is its height at rest. Its
 * floor is c = 0.4 h0, but at most 2 mm; within e = 0.6 h0, but at most 3 mm, of the floor the
 * height is eased onto it:
 *   h >= c + e: h;   h <= c - e: c;   between: c + (h - c + e)^2 / (4 e),
 * along q. Where ellipsoids overlap, what one pushed into another is put back onto that one's
 * floor. So at rest nothing moves, and neither does anything further out than at rest. Vertices
 * that are inside at rest, or further from the ellipsoid than PROJECTION_REACH_MM, are left alone.
 *
 * A row of teeth is an ellipse seen from above and has level edges. Its core is a level plate, and
 * skin is pushed away from the nearest point of that (rig_teeth_core, as a share k of the radii):
 * the size of q is
 *   (B^8 + |q_y|^8)^(1/8),  B = max(R - k, 0) / w,  R^2 = q_x^2 + q_z^2,
 * so that the edge is met from below and the front from before. Each vertex has a w of its own, by
 * R at rest, R0. Before the row w is 1 - k + 0.3 (R0 - 1): a lip that is pressed against the teeth
 * keeps the order of its layers, and yet touches their edge from below. Lips that touch their teeth
 * at rest are 0.5 mm outside of a row of their own: they go no deeper. Deep in the row
 * w fades to 0, and so it does behind the middle of the arch. The floor is c = 0, its band at most
 * 4 mm. One row is one shape: ellipsoids along the arch would leave dents
 * between them, and lips would catch at the last one.
 * Inside the room. [frame] all but create/destroy. */
#ifndef MAROTTE_FACE_PROJECTION_H
#define MAROTTE_FACE_PROJECTION_H
#include "csrbf/points.h"
#include "face/rig.h"

#define PROJECTION_REACH_MM       60.0
#define PROJECTION_TEETH_REACH_MM 20.0
enum { PROJECTION_PROXIES_MAX = 32 };

/* From the face to the scaled space of a proxy on its bone: q = row x. The way along q is, in the
 * face, the way from the centre. */
typedef struct proxy_frame {
    double row[3][4];
    vec3 centre; /* in the face */
    rig_proxy_kind kind;
    double core; /* of teeth, else 0 */
    float narrow_row[3][4], narrow_centre[3], narrow_up[3], narrow_height_mm;
} proxy_frame;

typedef struct projection_block { /* of one proxy: a block of vertices of which some are in reach */
    uint32_t proxy, block;
    float floor[POINTS_BLOCK];      /* c */
    float band[POINTS_BLOCK];       /* e; 0: left alone */
    float inside[POINTS_BLOCK];     /* below this |q|^2 a vertex is within the band */
    float level[POINTS_BLOCK];      /* of teeth: 1 / w */
    float least_level, most_inside; /* of those in reach */
} projection_block;

/* What was done to one of them. */
typedef struct projection_done {
    uint32_t moved_count;
    double depth_mm;
} projection_done;

typedef struct projection {
    const rig_proxy *proxy;
    uint32_t proxy_count, block_count;
    projection_block *block; /* by block, then by proxy */
    uint64_t *pushed;        /* see projection_pushed */
    uint32_t pushed_count;   /* blocks of vertices */
    projection_done *done;   /* block_count: in the last frame in which the block was written */
    uint32_t *first; /* of each block of vertices, and the end: where in `block` it begins */
    rigid posed[PROJECTION_PROXIES_MAX]; /* of the bone of each proxy, and what follows from it */
    proxy_frame frame[PROJECTION_PROXIES_MAX];
    proxy_frame still[PROJECTION_PROXIES_MAX]; /* with the bones at rest */
} projection;

typedef struct projection_report {
    double depth_mm;      /* greatest, below the floor, before anything was moved */
    uint32_t moved_count; /* vertices moved, once for each proxy */
} projection_report;

/* mobility: padded_count; where it is 0 a vertex is left alone. r may be NULL. */
CHECKED mrt_result projection_create(projection *out, const rig *r, const points *rest,
                                     const float *mobility, error *err);
void projection_destroy(projection *p);

/* A frame begins, pose: of each bone. Marks the blocks in reach of a proxy that has moved: the
 * vertices shown there have to be written anew, and projected. */
void projection_pose(projection *p, const rigid *pose, uint8_t *is_stale);
/* One block of vertices, just written. Keeps the bounds of shown. True: it has moved some. */
bool projection_apply(projection *p, points *shown, uint32_t block);
/* Where it brings a vertex that is at `at`, but for what two proxies do to each other. */
vec3 projection_at(const projection *p, uint32_t slot, vec3 at);
/* Of each block of vertices, as bits: those that were moved far enough to fold skin, when it was
 * written last. NULL: the rig has no skull and no teeth. */
const uint64_t *projection_pushed(const projection *p);
/* Projects a block with the bones at rest, whatever the frame is; it is not reported. */
void projection_apply_still(const projection *p, points *at, uint32_t block);
/* Nothing is projected: the shape shown is that at rest. */
void projection_rest(projection *p);
/* Of all blocks, as they were written last. */
projection_report projection_reported(const projection *p);
/* How deep the deepest vertex is below its floor, mm. */
double projection_depth_mm(const projection *p, const points *shown, const rigid *pose);

#endif
