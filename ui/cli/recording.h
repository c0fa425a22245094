/* ui/cli/recording.h - what a headless performance leaves behind: its frames as a clip for the
 * exporters that need one, how long each took, how far the face moved, and whether it folded. Fed
 * with drawn frames; nothing here counts as frame time. [main] */
#ifndef MAROTTE_UI_RECORDING_H
#define MAROTTE_UI_RECORDING_H
#include "cli/exports.h"
#include "io/clip.h"
#include "stage/perform/performer.h"

typedef enum recording_use {
    RECORDING_KEEPS = 0,
    RECORDING_SAYS,    /* and what its frames are in ARKit's names */
    RECORDING_TABLES,  /* numbers alone: no shapes of curves, columns or responses of pulls */
    RECORDING_MEASURES /* no clip is needed: memory does not grow with what the frames show */
} recording_use;

/* Of a control that moves nothing: where it holds the face, all is rigid. */
#define RECORDING_NO_COLUMN UINT32_MAX

typedef struct recording {
    clip *clip; /* NULL: it only measures */
    const mesh *mesh;
    recording_use use;
    uint32_t engagement; /* of the face's columns at the last segment begun */
    bool has_segment;
    float *rows;    /* scratch: vertex_count by 3 */
    float *column;  /* scratch: column_capacity by vertex_count */
    double *scale;  /* column_capacity: a power of two that brings a column near 1 */
    double *vector; /* scratch: column_capacity by 3 */
    char (*name)[FACE_COLUMN_NAME]; /* column_capacity */
    const char **names;
    uint32_t column_capacity;
    clip_pull pull[MRT_MAX_VECTORS]; /* of each control of the segment */
    uint32_t main[MRT_MAX_VECTORS];  /* its column of the greatest share; RECORDING_NO_COLUMN */
    uint32_t pull_count;             /* of the segment */
    bool has_curves;                 /* the face has been asked for them */
    uint32_t bone[RIG_BONES_MAX], bone_count; /* of the rig's, those that turn */
    uint32_t first_shape;                     /* of the curves: those of the head\'s own shapes */
    struct face_weights *weights;             /* NULL: nothing is said in names */
    double residual_mm;                       /* of these, in the worst frame */
    double *value;                            /* scratch: one for each curve of the clip */
    double *work_ms;                          /* per frame */
    uint32_t frame_count, frame_capacity;
    double furthest_mm;     /* of any vertex from rest, in any frame */
    uint32_t folded_frames; /* anchored frames that fold: face_min_determinant <= 0 */
    double min_determinant; /* of the anchored frames; 1 when the bound says that none folds */
    uint64_t folded_steps;  /* unanchored ones that fold, and their least determinant */
    double min_step_determinant;
    surface_state worst;     /* of all frames, each figure by itself */
    double held_back_mm;     /* the most in any frame */
    uint32_t held_frames;    /* in which something was held back */
    double penetration_mm;   /* of skin into the skull, as shown */
    uint32_t inexact_frames; /* anchored, but kept as vertices: the projection was at work */
} recording;

/* What these files need of one. */
recording_use recording_use_of(const exports_file *file, uint32_t count);

/* The face's file must outlive it. */
CHECKED mrt_result recording_create(recording *out, const face_file *of, double fps,
                                    recording_use use, error *err);
void recording_destroy(recording *self);

/* Takes the face shown as the next frame, and the hands that perform it: of each side the uppermost
 * that is seen. */
CHECKED mrt_result recording_add(recording *self, performer *performed, int64_t work_ns,
                                 error *err);
/* The same of a face that no hands perform. */
CHECKED mrt_result recording_add_face(recording *self, composer *from, int64_t work_ns, error *err);

/* How far the face moved, whether it folded or tore, and what was held back so that it did not. */
void recording_tell_surface(const recording *self, facts *told);

/* Frame times, ms; 0 without frames. Sorts what recording_add kept. */
double recording_median_ms(recording *self);
double recording_worst_ms(recording *self);

#endif
