/* face/rig/rig_poses.h - poses of a rig performed on its face: turned bones, pulled contacts, and
 * the resulting surface. Leaves out pictures of poses (rigpicture.h). [main]
 *
 * A pose determines one face: it holds all contacts of the rig, if there are at most
 * MRT_MAX_VECTORS. A file names only the contacts that matter. The others go where the named ones
 * alone would bring them (rig_poses_complete). A pose of one half leaves the contacts of the other
 * half at rest. So a mouth and an upper half can be added without influencing each other. */
#ifndef MAROTTE_FACE_RIG_POSES_H
#define MAROTTE_FACE_RIG_POSES_H
#include "face/face.h"

typedef struct rig_poses_stage {
    rig rig; /* own copy with complete poses */
    const mesh *mesh;
    face *face;
    csrbf_settings solver; /* rig_poses_solver */
    float *position;       /* vertex_count by 3, mm, in the file's order: the last pose shown */
} rig_poses_stage;

typedef struct rig_poses_measure {
    double least_determinant; /* <= 0 if it folds; see face_min_determinant */
    double penetration_mm;    /* below the proxies' floors, as shown */
    double furthest_mm;       /* greatest distance of a vertex from rest */
    uint32_t furthest_vertex; /* index in the mesh file */
} rig_poses_measure;

/* Returns the rig's settings, with a quarter of the face's height as default radius. The limit is
 * off, so that a pose that folds can be seen. r may be NULL. */
csrbf_settings rig_poses_solver(const rig *r, const mesh *m);

/* The head's own shapes answer as the rig sets. The mesh must outlive the stage. On error there is
 * nothing to finish. */
CHECKED mrt_result rig_poses_stage_init(rig_poses_stage *out, const rig *r, const mesh *m,
                                        const topology *t, error *err);
void rig_poses_stage_finish(rig_poses_stage *self); /* accepts NULL and zeroed */

/* Shows a pose of the rig, starting from rest. Degrees of freedom that it does not name are 0.
 * Pulls are given with all bones at rest, and move with the bones. mouthClose is shown over the
 * rig's jawOpen. Error messages name the file and the pose. */
CHECKED mrt_result rig_poses_show(rig_poses_stage *self, uint32_t pose, error *err);
/* The same, but contacts that the pose does not name are free. Complete poses come close to
 * this. */
CHECKED mrt_result rig_poses_show_named(rig_poses_stage *self, uint32_t pose, error *err);
/* Measures the pose shown. */
rig_poses_measure rig_poses_measured(const rig_poses_stage *self);

/* Finds where the unnamed contacts go in the poses from `first` on (rig_pose.follow_count). Motions
 * below 0.05 mm are left out. A pose of one half gets only contacts of that half. A pose that
 * cannot be performed is unchanged. Takes a millisecond for ten poses. f: a face of that rig; r may
 * be its rig. */
CHECKED mrt_result rig_poses_complete(rig *r, uint32_t first, const face *f,
                                      const csrbf_settings *solver, error *err);
/* Writes the half that each contact belongs to, or POSE_WHOLE for neither. out: contact_count; at:
 * positions at rest, mm. The name decides first: "brow...", "lid...", "forehead..." and the like
 * are the upper half; "lip...", "cheek...", "nose..." except its root, "jaw..." the mouth.
 * Otherwise the height decides, if there are contacts of both halves. */
void rig_poses_contact_parts(rig_pose_part *out, const rig *r, const vec3 *at);
/* The same for a degree of freedom. The head's turns belong to neither half. */
rig_pose_part rig_poses_dof_part(const char *name);

/* As rig_poses_show, on an existing face of that rig. The poses of r must be complete. */
CHECKED mrt_result rig_poses_show_on(face *f, const rig *r, uint32_t pose,
                                     const csrbf_settings *solver, error *err);
/* The inverse: the pose that brings the rig's contacts to `at` (contact_count, mm) while its bones
 * are turned by dof (dof_count). Contacts that the other pulled contacts already bring to their
 * place are left out. f: a face of that rig with room for `room` controls; it is at rest
 * afterwards. `name` is copied. Finish with rig_pose_finish. */
CHECKED mrt_result rig_poses_of(rig_pose *out, const char *name, face *f, uint32_t room,
                                const rig *r, const csrbf_settings *solver, const vec3 *at,
                                const float *dof, error *err);
/* Adds the model's poses named after ARKit's shapes, visemes and the twelve expressions, if r and
 * m's shapes lack them. Copies the values of contacts and degrees of freedom with the same names,
 * and scales pulls by the size of that part of the head. Also names contacts that the other pulls
 * would bring elsewhere than the model's pose does. Leaves out pulls that only correct a model's
 * smile at rest, and lids that r does not have. f: a face of r, whose mesh is m. */
CHECKED mrt_result rig_poses_transfer(rig *r, const mesh *m, const face *f, const rig *model,
                                      const mesh *model_mesh, const topology *model_topology,
                                      error *err);
/* Shortens pulls of the poses from `first` on that fold the skin, or that the limit holds back by
 * more than 0.3 mm. If that is not enough, also opens the jaw less. stage: of r; its poses are
 * replaced. */
CHECKED mrt_result rig_poses_reduce(rig *r, uint32_t first, rig_poses_stage *stage, error *err);

#endif
