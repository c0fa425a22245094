/* io/clip.h - a performance for the exporters: a mesh and its motion at a fixed frame rate.
 * Anchored frames store a vector per column of a segment, with the segment's base and columns: this
 * is exact and small. Free frames store vertex positions, in an unlinked temporary file instead of
 * memory. A frame may also have a named part that users can edit: the values of the clip's curves,
 * and the pulls of its segment's controls. The shape of the named part is close to the shape of the
 * frame; the difference is the remainder. Does not cover the file formats (export.h). Vertices are
 * in the order of the mesh file, in mm. Values that are not finite are refused. One thread at a
 * time.
 * */
#ifndef MAROTTE_IO_CLIP_H
#define MAROTTE_IO_CLIP_H
#include "mesh/arkit.h"
#include "mesh/mesh.h"

typedef struct clip_segment { /* an anchored engagement */
    float *base;              /* vertex_count by 3 */
    float *column;            /* column_count by vertex_count: unit responses, weights of bones */
    char **name;              /* column_count: "control1", "jaw.x" */
    uint32_t column_count;
    uint32_t frame_count; /* frames that use it */
    struct clip_pull *pull;
    uint32_t pull_count;
} clip_segment;

typedef struct clip_pull { /* effect of one control of the segment */
    char *name;            /* "mouth.corner.l" */
    double place_mm[3];    /* gripped point of the face */
    float *response;       /* vertex_count: share of the pull that moves each vertex; NULL: none */
} clip_pull;

typedef struct clip_bone { /* a bone that rotates; its parent comes before it */
    char *name;
    uint32_t parent; /* CLIP_NO_BONE: none */
    double centre_mm[3];
} clip_bone;
#define CLIP_NO_BONE UINT32_MAX

typedef struct clip_curve { /* a number in each frame */
    char *name;             /* "jaw.open" */
    char *unit;             /* "rad", "mm"; "": none */
    double min, max;        /* min <= 0 <= max */
    float *at_min, *at_max; /* vertex_count by 3: offsets from rest at min and at max, mm; scaled
                               linearly in between; NULL: none */
    bool is_own;            /* at_max equals the target of that name in the mesh's own file */
} clip_curve;

typedef struct clip clip;

typedef struct clip_start { /* start of the first frame, for the exporters; all zero: unknown */
    char timecode[32];      /* "01:00:00:00" */
    int64_t frame;          /* counted from 00:00:00:00 */
    uint32_t rate_num, rate_den; /* frames a second, exactly */
    int64_t take;                /* take of a show; 0: none */
    char show[128], slate[128];  /* the show's file, "scene/shot/2" */
} clip_start;

/* Creates a clip. `m` must outlive it. `directory`: folder of the temporary file (NULL or "": the
 * system's). */
clip *clip_create(const mesh *m, double fps, const char *directory, error *err);
void clip_destroy(clip *c);

/* Begins a segment and copies its arguments. Frames of clip_add_anchored belong to the newest
 * segment. name: column_count names; NULL: "control1" and so on. */
CHECKED mrt_result clip_begin_segment(clip *c, const float *base, const float *column,
                                      const char *const *name, uint32_t column_count, error *err);
/* Sets the pulls of the newest segment; copies them. count may be 0. */
CHECKED mrt_result clip_set_pulls(clip *c, const clip_pull *pull, uint32_t count, error *err);
/* Add a curve or a bone before the first frame; both are copied. */
CHECKED mrt_result clip_add_curve(clip *c, const clip_curve *what, error *err);
CHECKED mrt_result clip_add_bone(clip *c, const clip_bone *what, error *err);
/* Adds an anchored frame. vector: column_count by 3 of the newest segment, mm. The shape is base +
 * sum_k column_k * (float)vector_k, summed in k order in float32. */
CHECKED mrt_result clip_add_anchored(clip *c, const double *vector, error *err);
CHECKED mrt_result clip_add_free(clip *c, const float *position, error *err);
/* Adds the free points that pull the newest frame, for the table. count by 6, mm: start and end. */
CHECKED mrt_result clip_add_controls(clip *c, const double *start_end, uint32_t count, error *err);
/* Adds a hand to the newest frame. joint: MRT_JOINTS by 3, mm, as in mrt_hand. */
CHECKED mrt_result clip_add_hand(clip *c, uint32_t side, const double *joint, error *err);

/* Adds the named part of the newest frame. value: one for each curve; NaN: not set, counts as 0.
 * pulled: pull_count by 3 of the newest segment, mm; NULL: no pulls. */
CHECKED mrt_result clip_add_named(clip *c, const double *value, const double *pulled, error *err);

/* Adds the pose of the newest frame: 7 values for each bone, in the frame of the face. They are the
 * quaternion x y z w of its rotation from rest, then the position of its centre, mm. */
CHECKED mrt_result clip_add_pose(clip *c, const double *pose, error *err);

/* The frames as values of ARKit's names (mesh/arkit.h). Before the first frame, clip_set_arkit sets
 * which channels are used. clip_add_arkit then adds the values of all channels to the newest frame:
 * shapes 0..1, rotations in rad. */
typedef struct clip_arkit {
    bool is_said[ARKIT_CHANNELS];
    uint32_t shape_count, turn_count; /* numbers of used shapes and rotations */
} clip_arkit;
void clip_set_arkit(clip *c, const bool is_said[ARKIT_CHANNELS]);
CHECKED mrt_result clip_add_arkit(clip *c, const double value[ARKIT_CHANNELS], error *err);

const mesh *clip_mesh(const clip *c);
double clip_fps(const clip *c);
void clip_set_start(clip *c, const clip_start *start);
const clip_start *clip_start_of(const clip *c);
uint32_t clip_frame_count(const clip *c);
uint32_t clip_segment_count(const clip *c);
const clip_segment *clip_segment_at(const clip *c, uint32_t segment);
/* Returns the segment of a frame, or -1 for a free frame. */
int32_t clip_frame_segment(const clip *c, uint32_t frame);
/* Returns the vectors of an anchored frame, NULL for a free one. Valid until the clip changes. */
const double *clip_vector(const clip *c, uint32_t frame);
/* Returns the control vectors of a frame (count by 6), NULL and 0 if it has none. Valid until the
 * clip changes. */
const double *clip_controls(const clip *c, uint32_t frame, uint32_t *out_count);
/* Returns the joints of a hand in a frame (MRT_JOINTS by 3), NULL if the hand is missing. Valid
 * until the clip changes. */
const double *clip_hand(const clip *c, uint32_t frame, uint32_t side);
/* Reads the positions of any frame, vertex_count by 3. */
CHECKED mrt_result clip_read(const clip *c, uint32_t frame, float *out_position, error *err);

/* Returns true if frames have a named part that moves vertices: a curve or a pull. */
bool clip_is_named(const clip *c);
uint32_t clip_curve_count(const clip *c);
const clip_curve *clip_curve_at(const clip *c, uint32_t curve);
/* Returns clip_curve_count values, NULL if the frame has no named part. Valid until the clip
 * changes. */
const double *clip_values(const clip *c, uint32_t frame);
uint32_t clip_bone_count(const clip *c);
const clip_bone *clip_bone_at(const clip *c, uint32_t bone);
/* Returns 7 values for each bone, NULL if the frame has no pose. Valid until the clip changes. */
const double *clip_pose(const clip *c, uint32_t frame);
const clip_arkit *clip_arkit_of(const clip *c);
/* Returns ARKIT_CHANNELS values, NULL if the frame has none. Valid until the clip changes. */
const double *clip_arkit_values(const clip *c, uint32_t frame);
/* Returns the weight of at_max (> 0) or at_min (< 0) for a value: -1..1. */
double clip_curve_part(const clip_curve *curve, double value);
/* Returns the pulls of a frame (pull_count of the segment, by 3), NULL if it has none. Valid until
 * the clip changes. */
const double *clip_pulled(const clip *c, uint32_t frame, uint32_t *out_segment);

typedef struct clip_remainder {  /* the remainder of frames with a named part */
    double furthest_mm, mean_mm; /* largest error of a vertex in any frame; mean over the frames of
                                    the largest error */
    double loose_mm;             /* furthest_mm of the free frames without pulls: clay */
} clip_remainder;
/* Returns a clip of the remainders: the rest shape, moved by the difference between each frame and
 * its named part. Anchored frames without a named part stand still. Destroy it before c. */
clip *clip_split(const clip *c, clip_remainder *out, error *err);

#endif
