/* face/frame/limit.h - what face_limit.c (pulls), face_limit_room.c (what bones leave of the room
 * for pulls) and face_limit_shown.c (the seal, and what lies under the skin) share. Inside the
 * room. [frame] */
#ifndef MAROTTE_FACE_LIMIT_H
#define MAROTTE_FACE_LIMIT_H
#include "base/angle.h"
#include "face/frame/frame.h"
#include "face/frame/strain.h"

enum { GROUP = STRAIN_GROUP, HALVINGS = 8 };
static const float limit_shaped_steepness = 1.6f; /* less than 1 over it leaves room */
static const surface_limits limit_bends = {.stretch = 2.0, .bend_deg = 117.0, .area = 0.02};

/* GROUP triangles near each other. */
typedef struct limit_patch {
    strain_frames origin; /* of the engagement */
    strain_frames posed;  /* as the bones alone pose it */
    /* 1 over the tangent of the angle by which a triangle may turn without bending an edge too far,
     * whatever its neighbours do: at rest, and as posed. And of the angle by which it may tilt, as
     * posed, before it is seen from behind. */
    float inv_tan_turn[GROUP], inv_tan_turn_posed[GROUP], inv_tan_tilt_posed[GROUP];
    float turn_cosine[GROUP], turn_sine[GROUP]; /* of that angle at rest */
    float turn_cosine_posed[GROUP]; /* of how far bones have turned it from its main bone's turn */
    float rest_normal[3][GROUP],
        main_share[GROUP]; /* twice the area long; the share that main_bone has */
    float along[3][GROUP]; /* face_skin_along of this pose, where LIMIT_ALONG is known */
} limit_patch;

/* What is known of them beside. */
typedef struct limit_group {
    float steepness;    /* the most that a gradient of length 1 strains and turns one of them */
    float inv_tan_turn; /* the greatest of its triangles' */
    float tilt_cosine;  /* cosine of the largest turn of one of them from rest to the origin */
    float rounding;     /* by how much rounding of the origin may turn and stretch a triangle */

    uint32_t main_bone;                  /* or STILL */
    uint32_t bones_around;               /* bits: the main bones of the groups beside it */
    uint32_t first_carried, first_block; /* in limit.carried and limit.block, to the next one's */
    float centre[3], radius;
} limit_group;

/* Bits of limit.known: the parts of the group's patch that are up to date in this pose. */
enum { LIMIT_FRAME = 1, LIMIT_TILTS = 2, LIMIT_ALONG = 4 };

/* A bone other than the main one that carries triangles of a group: its largest share, the mean
 * gradient of its share, and the largest difference of a triangle's gradient from the mean. */
typedef struct limit_carried {
    uint32_t bone;
    float weight, gradient[3], apart;
    float spread;       /* the largest difference of its share between two corners of a triangle */
    float share[GROUP]; /* of each triangle: the mean of its corners */
} limit_carried;

/* How a bone moves relative to another; rotation: the length of R - I; < 0: not known in this
 * frame. */
typedef struct limit_apart {
    rigid motion;
    double rotation;
} limit_apart;

enum { STILL = RIG_BONES_MAX, CARRIERS }; /* what no bone moves is carried by that */

static inline size_t limit_group_count(const face *f)
{
    return ((size_t)f->skin_count + GROUP - 1) / GROUP;
}

static inline size_t limit_group_size(const face *f, size_t group)
{
    size_t left = f->skin_count - group * GROUP;
    return left < GROUP ? left : GROUP;
}

static inline void limit_put_vertex(points *out, uint32_t slot, const float *row)
{
    out->x[slot] = row[0];
    out->y[slot] = row[1];
    out->z[slot] = row[2];
}

static inline strain_corners limit_corners(const face *f, size_t group, float (*row)[4])
{
    return (strain_corners){.row = (const float(*)[4])row,
                            .vertex = f->skin + 3 * GROUP * group,
                            .count = limit_group_size(f, group)};
}

/* ---- face_limit.c ---- */

/* Starts a frame with another pose: nothing that follows from it has been computed yet. */
void limit_begin_pose(face *f);
/* patch.along: the normals at rest, turned by the bones. Once in a frame. */
void limit_turn_normals(face *f, size_t group);
/* The head uses shapes of its own: they may strain skin until it folds. */
bool limit_is_shaped(const face *f);
/* Adds up the weighed columns of a block over the origin (NULL: over nothing). */
void limit_write_block(const face *f, float (*row)[4], const points *origin, uint32_t block);
/* limit.posed of a block: as the bones alone pose it. Their columns must be weighed. */
void limit_pose_block(face *f, uint32_t block);
/* How near a control is to a triangle: 1 there, 0 from the radius on. */
double limit_near_grip(const face *f, size_t t, uint32_t control);
/* shapes.strain: charges the excess strain of the group to the shapes that act there. */
void limit_strain_shapes(face *f, size_t group, double strain);
/* f->given := the weights of the columns for limit.g and the applied shares of the shapes. */
void limit_give(face *f);
/* Sets the weights in the fields, too: their slopes belong to the shape shown. */
void limit_give_fields(face *f);
/* meter.held_back_mm: what limit.g has less than limit.asked. */
void limit_note_held_back(face *f);

/* ---- face_limit_room.c ---- */

CHECKED mrt_result limit_rooms_create(face *f, error *err);
/* Called when the groups' balls, bones and origins are known, after an engagement. */
void limit_rooms_engage(face *f);
/* Called when the pose is another one. */
void limit_rooms_pose(face *f);
/* How a bone moves, seen from another one; once in a pose. */
const limit_apart *limit_apart_of(face *f, uint32_t main_bone, uint32_t bone);
rigid limit_motion_of(const face *f, uint32_t bone);
/* Upper bound of half the angle between the rotations of the group and of a neighbouring one. */
angle_sincos limit_half_apart(face *f, const limit_group *g);
/* The length of a gradient in the origin, times the group's steepness, below which pulls strain no
 * triangle of the group too much in this pose. */
float limit_room(face *f, size_t group);
/* Of all groups: strain_bounds.steepness and .room. */
void limit_rooms_bounds(face *f, strain_bounds *out);
/* Upper bound of 1 over the tangent of how far the group's triangles may still tilt. */
float limit_tilted(face *f, size_t group);

/* ---- face_limit_shown.c ---- */

/* How much of the seal is applied: lips.share, lips.share_near and, where lips that only touch do
 * harm, f->given. */
void limit_lips(face *f);

#endif
