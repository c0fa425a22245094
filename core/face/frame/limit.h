/* face/frame/limit.h - declarations shared by face_limit.c (pulls), face_limit_room.c (the room
 * that bones leave for pulls) and face_limit_shown.c (the seal, and the skull and teeth under the
 * skin). Private to this folder. [frame] */
#ifndef MAROTTE_FACE_LIMIT_H
#define MAROTTE_FACE_LIMIT_H
#include "base/angle.h"
#include "face/frame/frame.h"
#include "face/frame/strain.h"

enum { GROUP = STRAIN_GROUP, HALVINGS = 8 };
static const float limit_shaped_steepness = 1.6f; /* a strain below 1 over it leaves room */
static const surface_limits limit_bends = {.stretch = 2.0, .bend_deg = 117.0, .area = 0.02};

/* GROUP triangles that are near each other. */
typedef struct limit_patch {
    strain_frames origin; /* at the start of the engagement */
    strain_frames posed;  /* as posed by the bones alone */
    /* 1 over the tangent of the angle by which a triangle may turn without bending an edge too far,
     * for any turn of its neighbours: at rest, and as posed. Then the same for the angle by which
     * it may tilt, as posed, before it is seen from behind. */
    float inv_tan_turn[GROUP], inv_tan_turn_posed[GROUP], inv_tan_tilt_posed[GROUP];
    float turn_cosine[GROUP], turn_sine[GROUP]; /* of the turn angle at rest */
    float turn_cosine_posed[GROUP]; /* cosine of the turn by the bones, relative to the turn of the
                                       main bone */
    float rest_normal[3][GROUP], main_share[GROUP]; /* rest_normal: length is twice the area;
                                                       main_share: share of main_bone */
    float along[3][GROUP]; /* face_skin_along of this pose; valid if LIMIT_ALONG is known */
} limit_patch;

/* Further data of a group. */
typedef struct limit_group {
    float steepness;    /* greatest strain or turn of a triangle for a gradient of length 1 */
    float inv_tan_turn; /* the greatest of its triangles */
    float tilt_cosine;  /* cosine of the greatest turn of a triangle from rest to the origin */
    float rounding;     /* greatest turn and stretch of a triangle by rounding of the origin */

    uint32_t main_bone;                  /* the bone with the greatest share, or STILL */
    uint32_t bones_around;               /* bits: the main bones of the neighbouring groups */
    uint32_t first_carried, first_block; /* begin in limit.carried and limit.block; they end where
                                            those of the next group begin */
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
    float share[GROUP]; /* mean share of each triangle's corners */
} limit_carried;

/* Motion of a bone relative to another. rotation: the norm of R - I, or < 0 if not computed in this
 * frame. */
typedef struct limit_apart {
    rigid motion;
    double rotation;
} limit_apart;

enum { STILL = RIG_BONES_MAX, CARRIERS }; /* STILL: all bones that do not move */

static inline size_t limit_group_count(const face *f)
{
    return ((size_t)f->skin_count + GROUP - 1) / GROUP;
}

static inline size_t limit_group_size(const face *f, size_t group)
{
    size_t left = f->skin_count - group * GROUP;
    return left < GROUP ? left : GROUP;
}

static inline void limit_set_vertex(points *out, uint32_t slot, const float *row)
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

/* Starts a frame with another pose, for which nothing is computed yet. */
void limit_begin_pose(face *f);
/* Computes patch.along: the normals at rest, turned by the bones. Runs once per frame. */
void limit_turn_normals(face *f, size_t group);
/* True if the head's own shapes are used. They may strain skin until it folds. */
bool limit_is_shaped(const face *f);
/* Sums the weighted columns of a block and adds the origin (NULL: adds nothing). */
void limit_write_block(const face *f, float (*row)[4], const points *origin, uint32_t block);
/* Computes limit.posed of a block: as posed by the bones alone. Their columns must be weighted. */
void limit_pose_block(face *f, uint32_t block);
/* Returns how near a control is to a triangle: 1 at the triangle, 0 from the radius on. */
double limit_near_grip(const face *f, size_t t, uint32_t control);
/* Adds the excess strain of the group to shapes.strain of the shapes that act there. */
void limit_strain_shapes(face *f, size_t group, double strain);
/* Sets f->given to the weights of the columns for limit.g and the applied shares of the shapes. */
void limit_apply(face *f);
/* Also solves the fields for limit.g, since their slopes must belong to the shape shown. */
void limit_solve_fields(face *f);
/* Sets meter.held_back_mm to the difference of limit.g from limit.asked. */
void limit_note_held_back(face *f);

/* ---- face_limit_room.c ---- */

CHECKED mrt_result limit_rooms_create(face *f, error *err);
/* Call after an engagement, when the groups' balls, bones and origins are known. */
void limit_rooms_engage(face *f);
/* Call when the pose has changed. */
void limit_rooms_pose(face *f);
/* Returns the motion of a bone relative to another one. Computed once per pose. */
const limit_apart *limit_apart_of(face *f, uint32_t main_bone, uint32_t bone);
rigid limit_motion_of(const face *f, uint32_t bone);
/* Returns an upper bound of half the angle between the rotations of the group and a neighbouring
 * one. */
angle_sincos limit_half_apart(face *f, const limit_group *g);
/* Returns the room for pulls in this pose: a length of a gradient over the origin, times the
 * group's steepness. Below it pulls cannot strain a triangle of the group too much. */
float limit_room(face *f, size_t group);
/* Sets strain_bounds.steepness and .room of all groups. */
void limit_rooms_bounds(face *f, strain_bounds *out);
/* Returns an upper bound of 1 over the tangent of the angle by which the group's triangles may
 * still tilt. */
float limit_tilted(face *f, size_t group);

/* ---- face_limit_shown.c ---- */

/* Sets how much of the seal is applied: lips.share and lips.share_near. If lips that only touch
 * fold the skin, also reduces f->given. */
void limit_lips(face *f);

#endif
