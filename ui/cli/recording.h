/* ui/cli/recording.h - the result of a performance without a window: its frames as a clip for the
 * exporters that need one, the duration of each frame, how far the face moved, and whether it
 * folded. It receives drawn frames; its own work does not count as frame time. [main] */
#ifndef MAROTTE_UI_RECORDING_H
#define MAROTTE_UI_RECORDING_H
#include "cli/exports.h"
#include "io/clip.h"
#include "stage/perform/performer.h"

typedef enum recording_use {
    RECORDING_KEEPS = 0,
    RECORDING_WEIGHTS, /* keep the frames, and their weights of ARKit shapes */
    RECORDING_TABLES,  /* numbers only: no shapes of curves, columns or responses of pulls */
    RECORDING_MEASURES /* no clip: memory does not grow with the contents of the frames */
} recording_use;

/* Marks a control that moves nothing, because all vertices around it are rigid. */
#define RECORDING_NO_COLUMN UINT32_MAX

typedef struct recording {
    clip *clip; /* NULL: only measure */
    const mesh *mesh;
    recording_use use;
    uint32_t engagement; /* of the face's columns when the last segment began */
    bool has_segment;
    float *rows;                    /* scratch: vertex_count by 3 */
    float *column;                  /* scratch: column_capacity by vertex_count */
    double *scale;                  /* column_capacity powers of two that bring a column near 1 */
    double *vector;                 /* scratch: column_capacity by 3 */
    char (*name)[FACE_COLUMN_NAME]; /* column_capacity names */
    const char **names;
    uint32_t column_capacity;
    clip_pull pull[MRT_MAX_VECTORS]; /* for each control of the segment */
    uint32_t main[MRT_MAX_VECTORS]; /* its column with the greatest share, or RECORDING_NO_COLUMN */
    uint32_t pull_count;            /* in the segment */
    bool has_curves;                /* the curves were added to the clip */
    uint32_t bone[RIG_BONES_MAX], bone_count; /* those bones of the rig that turn */
    uint32_t first_shape;         /* index of the first curve of a shape of the mesh file */
    struct face_weights *weights; /* NULL: no weights of ARKit shapes */
    double residual_mm;           /* of these weights, in the worst frame */
    double *value;                /* scratch: one for each curve of the clip */
    double *work_ms;              /* per frame */
    uint32_t frame_count, frame_capacity;
    double furthest_mm;     /* greatest distance of any vertex from rest, in any frame */
    uint32_t folded_frames; /* anchored frames that fold: face_min_determinant <= 0 */
    double min_determinant; /* of the anchored frames; 1 if the bound proves that none folds */
    uint64_t folded_steps;  /* unanchored steps that fold; then their least determinant */
    double min_step_determinant;
    surface_state worst;     /* worst value of each figure, over all frames */
    double held_back_mm;     /* maximum in any frame */
    uint32_t held_frames;    /* frames in which something was held back */
    double penetration_mm;   /* of skin into the skull, in the shown mesh */
    uint32_t inexact_frames; /* anchored frames that are stored as vertices, because the projection
                                moved them */
} recording;

/* Returns the recording_use that these files need. */
recording_use recording_use_of(const exports_file *file, uint32_t count);

/* The face file must outlive the recording. */
CHECKED mrt_result recording_create(recording *out, const face_file *of, double fps,
                                    recording_use use, error *err);
void recording_destroy(recording *self);

/* Adds the shown face as the next frame, with the hands that perform it: for each side the topmost
 * visible one. */
CHECKED mrt_result recording_add(recording *self, performer *performed, int64_t work_ns,
                                 error *err);
/* The same for a face without hands. */
CHECKED mrt_result recording_add_face(recording *self, composer *from, int64_t work_ns, error *err);

/* Reports how far the face moved, whether it folded or tore, and how much was held back to prevent
 * that. */
void recording_report_surface(const recording *self, facts *told);

/* Frame times in ms; 0 if there are no frames. Sorts the times of recording_add. */
double recording_median_ms(recording *self);
double recording_worst_ms(recording *self);

#endif
