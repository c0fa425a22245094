/* face/rig/rig_poses.h - a rig's poses on its face: bones turned, contacts pulled, and what that
 * does to the surface. It leaves out pictures of them (rigpicture.h). [main]
 *
 * A pose is one face, whoever makes it: all contacts of the rig are held, where there are at most
 * MRT_MAX_VECTORS of them. A file names the contacts that matter; the others go where those alone
 * would bring them (rig_poses_complete). A pose of a half leaves the contacts of the other half at
 * rest, so that a mouth and an upper half add without touching each other. */
#ifndef MAROTTE_FACE_RIG_POSES_H
#define MAROTTE_FACE_RIG_POSES_H
#include "face/face.h"

typedef struct rig_poses_stage {
    rig rig; /* its own, with poses that are complete */
    const mesh *mesh;
    face *face;
    csrbf_settings solver; /* rig_poses_solver */
    float *position;       /* vertex_count by 3, mm, in the file's order: the pose shown last */
} rig_poses_stage;

typedef struct rig_poses_measure {
    double least_determinant; /* <= 0: it folds; see face_min_determinant */
    double penetration_mm;    /* below the proxies' floors, as shown */
    double furthest_mm;       /* of any vertex, from rest */
    uint32_t furthest_vertex; /* of the mesh file */
} rig_poses_measure;

/* The rig's; without a radius a quarter of the face's height; holds nothing back, so that a pose
 * that folds is seen. r may be NULL. */
csrbf_settings rig_poses_solver(const rig *r, const mesh *m);

/* The head's own shapes answer as the rig says. The mesh must outlive it. On error there is nothing
 * to finish. */
CHECKED mrt_result rig_poses_stage_init(rig_poses_stage *out, const rig *r, const mesh *m,
                                        const topology *t, error *err);
void rig_poses_stage_finish(rig_poses_stage *self); /* accepts NULL and zeroed */

/* Shows one of the rig's poses, from rest, whatever was shown before; degrees of freedom that it
 * does not name are 0. Pulls are as with all bones at rest, and ride on the bones. mouthClose is
 * shown over the rig's jawOpen. Errors name the file and the pose. */
CHECKED mrt_result rig_poses_show(rig_poses_stage *self, uint32_t pose, error *err);
/* The same, but contacts that the pose does not name are free: what complete poses come close to.
 */
CHECKED mrt_result rig_poses_show_named(rig_poses_stage *self, uint32_t pose, error *err);
/* Of the pose shown. */
rig_poses_measure rig_poses_measured(const rig_poses_stage *self);

/* Finds for the poses from `first` on where the contacts go that they do not name
 * (rig_pose.follow_count), less than 0.05 mm left out: a millisecond for ten poses. Of a pose of a
 * half only contacts of that half. A pose that cannot be performed stays as it is. f: a face of
 * that rig; r may be its rig. */
CHECKED mrt_result rig_poses_complete(rig *r, uint32_t first, const face *f,
                                      const csrbf_settings *solver, error *err);
/* Which half each contact belongs to, out: contact_count; at: where they are at rest, mm. By the
 * name ("brow...", "lid...", "forehead..." and the like are the upper half; "lip...", "cheek...",
 * "nose..." but its root, "jaw..." the mouth's), else by the height, where there are contacts of
 * both halves; POSE_WHOLE: of neither. */
void rig_poses_contact_parts(rig_pose_part *out, const rig *r, const vec3 *at);
/* Likewise, of a degree of freedom; the head's turns are of neither. */
rig_pose_part rig_poses_dof_part(const char *name);

/* The same on a face of that rig that is somebody's; the poses of r are complete. */
CHECKED mrt_result rig_poses_show_on(face *f, const rig *r, uint32_t pose,
                                     const csrbf_settings *solver, error *err);
/* The other way round: the pose that brings the rig's contacts to `at` (contact_count, mm) while
 * its bones are turned by dof (dof_count); what is where the contacts named bring it is left out.
 * The face of that rig, which has room for so many controls, is at rest afterwards. `name` is
 * copied; to be finished. */
CHECKED mrt_result rig_poses_of(rig_pose *out, const char *name, face *f, uint32_t room,
                                const rig *r, const csrbf_settings *solver, const vec3 *at,
                                const float *dof, error *err);
/* Adds the model's poses with the names of ARKit's shapes, visemes and the twelve expressions that
 * r and m's shapes lack. Copies what contacts and degrees of freedom of the same names do, and
 * scales pulls by the size of that part of the head. Leaves out pulls that only level a model's
 * smile at rest, and lids that r does not have. */
CHECKED mrt_result rig_poses_carry(rig *r, const mesh *m, const rig *model, const mesh *model_mesh,
                                   error *err);
/* Shortens the pulls of the poses from `first` on that fold the skin, or are held back by more than
 * 0.3 mm when they are performed; where that is not enough, the jaw opens less, too. */
CHECKED mrt_result rig_poses_ease(rig *r, uint32_t first, const mesh *m, const topology *t,
                                  error *err);

#endif
