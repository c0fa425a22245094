/* face/fit.h - fit of a rig to given shapes. The shapes are morph targets of a mesh with the same
 * vertices. For each of them a least-squares fit finds the closest bone poses and control vectors
 * of the rig's contacts. [main] */
#ifndef MAROTTE_FACE_FIT_H
#define MAROTTE_FACE_FIT_H
#include "face/face.h"

typedef struct fit_options {
    const uint32_t *contact; /* indices of the contacts that may be pulled */
    uint32_t contact_count;
    csrbf_settings settings; /* radius 0: the rig's */
} fit_options;

typedef struct fit_result {
    const char *name;         /* name of the target */
    double relative_residual; /* RMS of the error over RMS of the target, over skin vertices
                                 (mobility > 0, not rigid) */
    double worst_mm;          /* greatest error of a vertex */
    double rigid_motion_mm;   /* greatest motion of a vertex that is rigid on a fixed bone */
    double penetration_mm;    /* below the skull proxies' floor, after projection */
    double min_determinant;
    double paper_residual; /* the same for the paper's unconstrained warp with the same contacts */
    double paper_rigid_motion_mm;
    float dof[MRT_MAX_DOFS];
    vec3 *pull; /* contact_count: control vectors with the bones at rest, mm; they move with the
                   bones */
    float *position; /* vertex_count by 3, file order: the fitted shape */
} fit_result;

/* out: one result per target, targets->target_count in all. */
CHECKED mrt_result fit_targets(fit_result *out, const rig *r, const mesh *m, const topology *t,
                               const mesh *targets, const fit_options *options, error *err);
void fit_results_destroy(fit_result *results, uint32_t count);

/* Chooses `count` contacts that fit the targets best, in mirrored pairs or on the midline (greedy).
 * Writes their vertex indices and their number. */
CHECKED mrt_result fit_suggest(uint32_t *out_vertex, uint32_t *out_count, uint32_t count,
                               const rig *r, const mesh *m, const topology *t, const mesh *targets,
                               const csrbf_settings *settings, error *err);

#endif
