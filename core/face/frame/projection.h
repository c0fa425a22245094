/* face/frame/projection.h - skin slides over the skull but never enters it (research, theory 4.3):
 * a one-sided, smooth projection out of ellipsoids that move with bones. In the ellipsoid's scaled
 * space q = (x - centre) / radii a vertex has the height h = |q| - 1; h0 is its height at rest. Its
 * floor is c = 0.4 h0, but at most 2 mm. Within e = 0.6 h0, but at most 3 mm, of the floor the
 * height is eased onto it:
 *   h >= c + e: h;   h <= c - e: c;   between: c + (h - c + e)^2 / (4 e),
 * along q. Where ellipsoids overlap, a vertex that one pushes into another is put onto the floor of
 * the other. So nothing moves at rest, and no vertex moves that is further out than at rest.
 * Vertices that are inside at rest, or further from the ellipsoid than PROJECTION_REACH_MM, are
 * never moved.
 *
 * A row of teeth is an ellipse seen from above with level edges. Its core is a level plate, and
 * skin is pushed away from the nearest point of the core (rig_teeth_core, as a share k of the
 * radii). The size of q is
 *   (B^8 + |q_y|^8)^(1/8),  B = max(R - k, 0) / w,  R^2 = q_x^2 + q_z^2,
 * so that skin meets the edge from below and the front from before. Each vertex has its own w,
 * which depends on R at rest, R0. In front of the row w is 1 - k + 0.3 (R0 - 1). So the layers of a
 * lip pressed against the teeth keep their order, and the lip still touches the edge from below.
 * Lips that touch their teeth at rest get a row that is 0.5 mm further in, and go no deeper. Deep
 * in the row, and behind the middle of the arch, w fades to 0. The floor is c = 0 and its band is
 * at most 4 mm. A whole row is one shape, because ellipsoids along the arch would leave dents and
 * lips would catch at the last one.
 * Private to this folder. All functions except create and destroy are [frame]. */
#ifndef MAROTTE_FACE_PROJECTION_H
#define MAROTTE_FACE_PROJECTION_H
#include "csrbf/points.h"
#include "face/rig.h"

#define PROJECTION_REACH_MM       60.0
#define PROJECTION_TEETH_REACH_MM 20.0
enum { PROJECTION_PROXIES_MAX = 32 };

/* Maps from the face to the scaled space of a proxy on its bone: q = row x. The direction along q
 * corresponds in the face to the direction from the centre. */
typedef struct proxy_frame {
    double row[3][4];
    vec3 centre; /* in the face's frame */
    rig_proxy_kind kind;
    double core; /* for teeth, else 0 */
    float narrow_row[3][4], narrow_centre[3], narrow_up[3], narrow_height_mm;
} proxy_frame;

typedef struct projection_block { /* a block of vertices with some in reach of one proxy */
    uint32_t proxy, block;
    float floor[POINTS_BLOCK];      /* c */
    float band[POINTS_BLOCK];       /* e; 0 if the vertex is never moved */
    float inside[POINTS_BLOCK];     /* below this |q|^2 a vertex is within the band */
    float level[POINTS_BLOCK];      /* for teeth: 1 / w */
    float least_level, most_inside; /* of the vertices in reach */
} projection_block;

/* Result of the last projection of such a block. */
typedef struct projection_done {
    uint32_t moved_count;
    double depth_mm;
} projection_done;

typedef struct projection {
    const rig_proxy *proxy;
    uint32_t proxy_count, block_count;
    projection_block *block; /* sorted by block, then by proxy */
    uint64_t *pushed;        /* see projection_pushed */
    uint32_t pushed_count;   /* number of blocks of vertices */
    projection_done *done;   /* block_count: from the last frame that wrote the block */
    uint32_t *first; /* for each block of vertices, and the end: its first entry in `block` */
    rigid posed[PROJECTION_PROXIES_MAX]; /* pose of each proxy's bone; `frame` is derived from it */
    proxy_frame frame[PROJECTION_PROXIES_MAX];
    proxy_frame still[PROJECTION_PROXIES_MAX]; /* with the bones at rest */
} projection;

typedef struct projection_report {
    double depth_mm;      /* greatest depth below the floor, before the projection */
    uint32_t moved_count; /* vertices moved, counted once per proxy */
} projection_report;

/* mobility: padded_count; vertices with mobility 0 are never moved. r may be NULL. */
CHECKED mrt_result projection_create(projection *out, const rig *r, const points *rest,
                                     const float *mobility, error *err);
void projection_destroy(projection *p);

/* Begins a frame with the pose of each bone. Marks the blocks in reach of a proxy that has moved:
 * their shown vertices must be written and projected again. */
void projection_pose(projection *p, const rigid *pose, uint8_t *is_stale);
/* Projects one block of vertices that was just written. Keeps the bounds of shown. Returns true if
 * it has moved vertices. */
bool projection_apply(projection *p, points *shown, uint32_t block);
/* Returns where a vertex at `at` is projected to, ignoring how two proxies affect each other. */
vec3 projection_at(const projection *p, uint32_t slot, vec3 at);
/* Returns bits for each block of vertices: those that were moved far enough to fold skin when the
 * block was last written. NULL if the rig has no skull proxies. */
const uint64_t *projection_pushed(const projection *p);
/* Projects a block with the bones at rest, in any frame. Does not change the report. */
void projection_apply_still(const projection *p, points *at, uint32_t block);
/* Resets all results, for a shape shown at rest. */
void projection_rest(projection *p);
/* Sums the results of all blocks, as last written. */
projection_report projection_reported(const projection *p);
/* Returns the greatest depth of a vertex below its floor, mm. */
double projection_depth_mm(const projection *p, const points *shown, const rigid *pose);

#endif
