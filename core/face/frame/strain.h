/* face/frame/strain.h - how a displacement strains triangles, in groups of STRAIN_GROUP: how steep
 * it is, how it squeezes, tilts and turns each. Compiled once for each instruction set (base/isa.h)
 * from strain_loops.c; all give the same bits. Leaves out what is done about it (face_limit.c).
 * Inside the room. Pure; any thread. */
#ifndef MAROTTE_FACE_STRAIN_H
#define MAROTTE_FACE_STRAIN_H
#include <stddef.h>
#include <stdint.h>

enum { STRAIN_GROUP = 16 };

/* How far pulls may tilt skin from where the bones turn it: below 87 degrees, so that no triangle
 * is seen from behind. */
#define STRAIN_SEEN_RAD 1.51843645f

/* M and T: a gradient G squeezes a triangle by the least eigenvalue of the symmetric part of G in
 * its plane, negated, over M; and tilts it by how steep it is along the normal, over T at most. */
#define STRAIN_SQUEEZE_MOST 0.85f
#define STRAIN_TILT_MOST    2.7f /* the tangent of 70 degrees */

/* The corners of triangles: `count` by 3 rows of `row`, count at most STRAIN_GROUP. */
typedef struct strain_corners {
    const float (*row)[4]; /* x, y, z of each vertex */
    const uint32_t *vertex;
    size_t count;
} strain_corners;

/* 1 over the first edge's length, how far the second one goes along it, 1 over the height. What is
 * squashed to nothing has 0, and is not strained. */
typedef struct strain_shapes {
    float inv_first[STRAIN_GROUP], along[STRAIN_GROUP], inv_height[STRAIN_GROUP];
} strain_shapes;

/* And by axis: where the first edge points, across it in the triangle's plane, its normal. */
typedef struct strain_frames {
    strain_shapes shape;
    float first[3][STRAIN_GROUP], second[3][STRAIN_GROUP], normal[3][STRAIN_GROUP];
} strain_frames;

typedef struct strain_found {
    float strain[STRAIN_GROUP]; /* squeezed over M, and tilted times inv_tan_tilt */
    float alone[STRAIN_GROUP];  /* the same, if bones had tilted nothing */
    float flip[STRAIN_GROUP];   /* squeezed, and tilted times inv_tan_turn */
    float size[STRAIN_GROUP];   /* of the gradient: the root of its sum of squares */
    float steepest;             /* of its gradients over the origin */
} strain_found;

/* Bounds of groups, by group: input of may_strain. */
typedef struct strain_bounds {
    const float *pull, *change; /* the greatest length of a gradient of the pulls; and by how much
                                   it can have grown since `strain` and `flip` */
    const float *steepness, *room; /* strain_rooms */
    float shaped;                  /* counts instead of a finite steepness; 0: does not */
    float *strain, *flip; /* upper bounds, as measured last; set to INFINITY where the pulls have
                             changed and the group is not measured */
} strain_bounds;

typedef struct strain_folds {
    float fold[STRAIN_GROUP];  /* strain_fold */
    float drawn[STRAIN_GROUP]; /* above 0: some edge is more than doubled */
} strain_folds;

typedef struct strain_seen {
    float area[STRAIN_GROUP];   /* seen along a normal, over the area at rest; 1: not a triangle */
    float turned[STRAIN_GROUP]; /* above 0: turned from that normal by more than may be */
} strain_seen;

/* How a bone moves, seen from another one that carries groups of triangles too: an entry for each
 * such group, all of one pair of bones in a row. */
typedef struct strain_blends {
    float *centre[3], *radius;   /* of a ball around the group, mm */
    float *gradient[3], *length; /* the mean gradient of the bone's share of it, 1/mm */
    float *off;                  /* the largest difference of a triangle's from that */
    float *along, *steep;        /* out: of u g^T, u being the way of a point of the group and g the
                                    gradient: the least u . g, and the greatest |u| |g| */
} strain_blends;

/* By groups. See face_limit_room.c. Angles in radians. */
typedef struct strain_rooms {
    float *blended, *unlike; /* how far all bones turn the group at most, seen from its main bone:
                                sum w d; and 1 - the square of the least length that turning by so
                                many leaves of a unit vector */
    float *along, *steep;    /* of the steepest blend */
    float *lost;             /* lengths that all else takes from a unit vector at most */
    float *apart;            /* half the angle between its main bone and one of a neighbour */
    float *rounding, *tilt;  /* limit_group.rounding; the largest turn from rest to the origin */
    float *turn, *steepness; /* by how much it may turn; limit_group.steepness */
    float *tilted;           /* out: bound of 1 over the tangent of how far it may still tilt */
} strain_rooms;

/* By how much each may turn, less what their neighbours may have turned the other way. */
typedef struct strain_turns {
    const float *cosine, *sine;
    float less_cosine, less_sine;
} strain_turns;

typedef struct strain_loops {
    /* out[i] += by * row[i] */
    void (*add)(float *out, const float *row, float by, size_t count);
    void (*frames)(strain_frames *out, const strain_corners *at);
    /* The cosine of how far the bones have turned each triangle: from `rest`, turned by the rows
     * of `rotation`, to `posed`. */
    void (*turned)(float *out, const strain_frames *rest, const strain_frames *posed,
                   const float rotation[9]);
    /* inv_tan_turn, 1 over the tangent of how far each may turn, less of what it has turned
     * already. */
    void (*turns)(float *out, const float *inv_tan_turn, const float *turn_cosine);
    /* The greatest size of the gradient of a displacement of these corners. */
    float (*steepest)(const strain_shapes *s, const strain_corners *displacement);
    void (*strains)(strain_found *out, const strain_frames *f, const strain_shapes *origin,
                    const float *inv_tan_tilt, const float *inv_tan_turn,
                    const strain_corners *displacement);
    /* Of each the largest share of the stretch left to an edge that `added` uses up; longest: how
     * long the edges may be, 3 a triangle. */
    void (*stretches)(float *out, const strain_corners *posed, const strain_corners *added,
                      const float (*longest)[3], float room_least);
    /* out: 1 where the bounds of a group allow too much. */
    void (*may_strain)(uint8_t *out, const strain_bounds *of, size_t count);
    /* out += share times (rotation applied to rest), of each; rotation: what is added to the
     * identity */
    void (*turn_normals)(float (*out)[STRAIN_GROUP], const float (*rest)[STRAIN_GROUP],
                         const float *share, const float rotation[9]);
    void (*seen)(strain_seen *out, const strain_corners *at, const float (*normal)[STRAIN_GROUP],
                 const strain_turns *may_turn);
    /* motion: a row of R - I and what is added, for each axis; turn: the length of R - I. */
    void (*blends)(const strain_blends *of, const float motion[12], float turn, size_t first,
                   size_t end);
    /* limit_group.room */
    void (*rooms)(float *out, const strain_rooms *of, size_t count);
    /* Of what `added` does to `posed`, seen along `normal`. */
    void (*folds)(strain_folds *out, const strain_corners *posed, const strain_corners *added,
                  const float (*normal)[STRAIN_GROUP]);
} strain_loops;

/* How near a triangle is to a fold on a straight way. e: its edges from one corner; d: what is
 * added to them; n: the normal that it is seen along, as long as twice its area at rest. Of that
 * area (e1 + s d1) x (e2 + s d2) . n / n.n is left; 0 where the least of it for s in 0..1 is what e
 * has, 1 where it is STRAIN_FOLD_ROOM (or half of what e has, if that is less), in between and
 * beyond in proportion. What e has turned over already says nothing. */
#define STRAIN_FOLD_ROOM 0.05f
float strain_fold(const float e[2][3], const float d[2][3], const float n[3]);

/* 1 over the way along which the same triangle surely keeps STRAIN_FOLD_ROOM: in proportion to d,
 * and continuous, for which what d alone spans counts only against it. */
float strain_flip(const float e[2][3], const float d[2][3], const float n[3]);

/* Of the instruction set that is used. */
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
