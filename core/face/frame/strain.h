/* face/frame/strain.h - strain of triangles under a displacement, in groups of STRAIN_GROUP: its
 * steepness, and how it squeezes, tilts and turns each triangle. strain_loops.c is compiled once
 * for each instruction set (base/isa.h); all give the same bits. Leaves out the reaction to strain
 * (face_limit.c). Private to this folder. Pure. [any] */
#ifndef MAROTTE_FACE_STRAIN_H
#define MAROTTE_FACE_STRAIN_H
#include <stddef.h>
#include <stdint.h>

enum { STRAIN_GROUP = 16 };

/* Greatest tilt of skin by pulls, from where the bones turn it: below 87 degrees, so that no
 * triangle is seen from behind. */
#define STRAIN_SEEN_RAD 1.51843645f

/* M and T. A gradient G squeezes a triangle by the negated least eigenvalue of the symmetric part
 * of G in its plane, over M. It tilts the triangle by its steepness along the normal, over T at
 * most. */
#define STRAIN_SQUEEZE_MOST 0.85f
#define STRAIN_TILT_MOST    2.7f /* the tangent of 70 degrees */

/* Corners of triangles: `count` by 3 rows of `row`, count at most STRAIN_GROUP. */
typedef struct strain_corners {
    const float (*row)[4]; /* x, y, z of each vertex */
    const uint32_t *vertex;
    size_t count;
} strain_corners;

/* 1 over the length of the first edge, the component of the second edge along it, 1 over the
 * height. All 0 for a triangle of no area, which cannot be strained. */
typedef struct strain_shapes {
    float inv_first[STRAIN_GROUP], along[STRAIN_GROUP], inv_height[STRAIN_GROUP];
} strain_shapes;

/* The same with axes: the direction of the first edge, the direction across it in the triangle's
 * plane, and the normal. */
typedef struct strain_frames {
    strain_shapes shape;
    float first[3][STRAIN_GROUP], second[3][STRAIN_GROUP], normal[3][STRAIN_GROUP];
} strain_frames;

typedef struct strain_found {
    float strain[STRAIN_GROUP]; /* squeeze over M plus tilt times inv_tan_tilt */
    float alone[STRAIN_GROUP];  /* the same without the tilt by bones */
    float flip[STRAIN_GROUP];   /* squeeze plus tilt times inv_tan_turn */
    float size[STRAIN_GROUP];   /* Frobenius norm of the gradient */
    float steepest;             /* greatest size of a gradient over the origin */
} strain_found;

/* Bounds by group: input of may_strain. */
typedef struct strain_bounds {
    const float *pull, *change;    /* greatest length of a gradient of the pulls, and its greatest
                                      growth since `strain` and `flip` were measured */
    const float *steepness, *room; /* see strain_rooms */
    float shaped;                  /* used instead of a finite steepness, unless 0 */
    float *strain, *flip; /* upper bounds from the last measurement; set to INFINITY if the pulls
                             have changed and the group is not measured */
} strain_bounds;

typedef struct strain_folds {
    float fold[STRAIN_GROUP];  /* strain_fold */
    float drawn[STRAIN_GROUP]; /* above 0 if some edge is more than doubled */
} strain_folds;

typedef struct strain_seen {
    float area[STRAIN_GROUP];   /* area projected along a normal, over the area at rest; 1 for a
                                   degenerate triangle */
    float turned[STRAIN_GROUP]; /* above 0 if turned from that normal by more than the limit */
} strain_seen;

/* Motion of a bone relative to another one, for groups of triangles that both carry. One entry per
 * group; the entries of a pair of bones are contiguous. */
typedef struct strain_blends {
    float *centre[3], *radius;   /* ball around the group, mm */
    float *gradient[3], *length; /* mean gradient of the bone's share, 1/mm */
    float *off;                  /* largest difference of a triangle's gradient from the mean */
    float *along, *steep; /* output about u g^T, with u the motion of a point of the group and g the
                             gradient: the least u . g, and the greatest |u| |g| */
} strain_blends;

/* Arrays by group. See face_limit_room.c. Angles in radians. */
typedef struct strain_rooms {
    float *blended,
        *unlike; /* greatest turn of the group by all bones, relative to its main bone: sum w d; and
                    1 - the square of the least length that a unit vector keeps under such a turn */
    float *along, *steep;    /* of the steepest blend */
    float *lost;             /* greatest length that all other effects take from a unit vector */
    float *apart;            /* half the angle between its main bone and a neighbour's */
    float *rounding, *tilt;  /* limit_group.rounding; greatest turn from rest to the origin */
    float *turn, *steepness; /* angle by which it may turn; limit_group.steepness */
    float *tilted; /* output: bound of 1 over the tangent of the angle by which it may still tilt */
} strain_rooms;

/* Angles by which triangles may turn, minus the angle by which their neighbours may have turned the
 * other way. */
typedef struct strain_turns {
    const float *cosine, *sine;
    float less_cosine, less_sine;
} strain_turns;

typedef struct strain_loops {
    /* out[i] += by * row[i] */
    void (*add)(float *out, const float *row, float by, size_t count);
    void (*frames)(strain_frames *out, const strain_corners *at);
    /* Writes the cosine of the angle by which the bones have turned each triangle: from `rest`,
     * turned by the rows of `rotation`, to `posed`. */
    void (*turned)(float *out, const strain_frames *rest, const strain_frames *posed,
                   const float rotation[9]);
    /* Subtracts the turn already made from the turn that each triangle may make. Input and output
     * are 1 over the tangent. */
    void (*turns)(float *out, const float *inv_tan_turn, const float *turn_cosine);
    /* Returns the greatest size of the gradient of a displacement of these corners. */
    float (*steepest)(const strain_shapes *s, const strain_corners *displacement);
    void (*strains)(strain_found *out, const strain_frames *f, const strain_shapes *origin,
                    const float *inv_tan_tilt, const float *inv_tan_turn,
                    const strain_corners *displacement);
    /* Writes for each triangle the largest share of the stretch left to an edge that `added` uses.
     * longest: greatest lengths of the edges, 3 per triangle. */
    void (*stretches)(float *out, const strain_corners *posed, const strain_corners *added,
                      const float (*longest)[3], float room_least);
    /* out: 1 if the bounds of a group allow too much strain. */
    void (*may_strain)(uint8_t *out, const strain_bounds *of, size_t count);
    /* out += share times (rotation applied to rest), for each triangle. rotation: R - I */
    void (*turn_normals)(float (*out)[STRAIN_GROUP], const float (*rest)[STRAIN_GROUP],
                         const float *share, const float rotation[9]);
    void (*seen)(strain_seen *out, const strain_corners *at, const float (*normal)[STRAIN_GROUP],
                 const strain_turns *may_turn);
    /* motion: a row of R - I and the translation for each axis; turn: the norm of R - I. */
    void (*blends)(const strain_blends *of, const float motion[12], float turn, size_t first,
                   size_t end);
    /* out: room of each group, see limit_room */
    void (*rooms)(float *out, const strain_rooms *of, size_t count);
    /* Measures the effect of `added` on `posed`, projected along `normal`. */
    void (*folds)(strain_folds *out, const strain_corners *posed, const strain_corners *added,
                  const float (*normal)[STRAIN_GROUP]);
} strain_loops;

/* Measures how near a triangle is to a fold on a straight path. e: its edges from one corner; d:
 * what is added to them; n: the normal of the projection, with the length of twice its area at
 * rest. The area left, relative to that, is (e1 + s d1) x (e2 + s d2) . n / n.n.
 * Returns 0 if its minimum for s in 0..1 is its value for e alone. Returns 1 if the minimum is
 * STRAIN_FOLD_ROOM (or half the value for e, if that is less), and is proportional in between and
 * beyond. Returns 0 for a triangle that e has already turned over. */
#define STRAIN_FOLD_ROOM 0.05f
float strain_fold(const float e[2][3], const float d[2][3], const float n[3]);

/* Returns 1 over the part of the path on which the same triangle surely keeps STRAIN_FOLD_ROOM. It
 * is proportional to d and continuous. To achieve this, the area that d alone spans counts only if
 * it brings the fold nearer. */
float strain_flip(const float e[2][3], const float d[2][3], const float n[3]);

/* Returns the loops for the instruction set in use. */
const strain_loops *strain_loops_now(void);

#define STRAIN_JOIN(name, variant) strain_##name##_##variant
#define STRAIN_OF(name, variant)   STRAIN_JOIN(name, variant)

#define STRAIN_DECLARE(variant)                                                                    \
    void STRAIN_OF(add, variant)(float *out, const float *row, float by, size_t count);            \
    void STRAIN_OF(frames, variant)(strain_frames * out, const strain_corners *at);                \
    void STRAIN_OF(turned, variant)(float *out, const strain_frames *rest,                         \
                                    const strain_frames *posed, const float rotation[9]);          \
    void STRAIN_OF(turns, variant)(float *out, const float *inv_tan_turn,                          \
                                   const float *turn_cosine);                                      \
    float STRAIN_OF(steepest, variant)(const strain_shapes *s,                                     \
                                       const strain_corners *displacement);                        \
    void STRAIN_OF(strains, variant)(                                                              \
        strain_found * out, const strain_frames *f, const strain_shapes *origin,                   \
        const float *inv_tan_tilt, const float *inv_tan_turn, const strain_corners *displacement); \
    void STRAIN_OF(stretches, variant)(float *out, const strain_corners *posed,                    \
                                       const strain_corners *added, const float(*longest)[3],      \
                                       float room_least);                                          \
    void STRAIN_OF(may_strain, variant)(uint8_t * out, const strain_bounds *of, size_t count);     \
    void STRAIN_OF(turn_normals, variant)(float(*out)[STRAIN_GROUP],                               \
                                          const float(*rest)[STRAIN_GROUP], const float *share,    \
                                          const float rotation[9]);                                \
    void STRAIN_OF(seen, variant)(strain_seen * out, const strain_corners *at,                     \
                                  const float(*normal)[STRAIN_GROUP],                              \
                                  const strain_turns *may_turn);                                   \
    void STRAIN_OF(blends, variant)(const strain_blends *of, const float motion[12], float turn,   \
                                    size_t first, size_t end);                                     \
    void STRAIN_OF(rooms, variant)(float *out, const strain_rooms *of, size_t count);              \
    void STRAIN_OF(folds, variant)(strain_folds * out, const strain_corners *posed,                \
                                   const strain_corners *added,                                    \
                                   const float(*normal)[STRAIN_GROUP])

#endif
