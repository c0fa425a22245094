/* io/clip.h - a performance as the exporters need it: a mesh and its motion at a fixed frame rate.
 * Frames are either anchored (a segment's base and columns, and one vector per column: exact and
 * small) or free (vertex positions). Free frames are kept in an unlinked
 * temporary file, not in memory. Beside its shape a frame may have what a person would edit: the
 * values of curves that the whole clip has, and the pulls of its segment's controls. What these
 * show together is close to its shape; the difference is its remainder. Vertices
 * are in the mesh's (file) order, mm. What is not finite is refused. One thread at a time. */
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

typedef struct clip_pull { /* what a control of the segment moves */
    char *name;            /* "mouth.corner.l" */
    double place_mm[3];    /* where it takes hold of the face */
    float *response;       /* vertex_count: of how far it is pulled; NULL: not kept */
} clip_pull;

typedef struct clip_bone { /* that turns; its parent comes before it */
    char *name;
    uint32_t parent; /* CLIP_NO_BONE: none */
    double centre_mm[3];
} clip_bone;
#define CLIP_NO_BONE UINT32_MAX

typedef struct clip_curve { /* a number in each frame */
    char *name;             /* "jaw.open" */
    char *unit;             /* "rad", "mm"; "": none */
    double min, max;        /* min <= 0 <= max */
    float *at_min, *at_max; /* vertex_count by 3: what it moves, mm from rest, at min and at max; in
                               between so much of it; NULL: nothing */
    bool is_own;            /* at_max is what the mesh's own target of that name is, in its file */
} clip_curve;

typedef struct clip clip;

typedef struct clip_start { /* when the first frame is, for the exporters; all zero: not said */
    char timecode[32];      /* "01:00:00:00" */
    int64_t frame;          /* counted from 00:00:00:00 */
    uint32_t rate_num, rate_den; /* frames a second, exactly */
    int64_t take;                /* of a show; 0: of none */
    char show[128], slate[128];  /* the show's file, "scene/shot/2" */
} clip_start;

/* `m` must outlive the clip. `directory`: where the temporary file may be (NULL or "": the
 * system's). */
clip *clip_create(const mesh *m, double fps, const char *directory, error *err);
void clip_destroy(clip *c);

/* Copies; frames added by clip_add_anchored belong to the newest segment. name: column_count, or
 * NULL: "control1" and so on. */
CHECKED mrt_result clip_begin_segment(clip *c, const float *base, const float *column,
                                      const char *const *name, uint32_t column_count, error *err);
/* Of the newest segment; copies. count may be 0. */
CHECKED mrt_result clip_set_pulls(clip *c, const clip_pull *pull, uint32_t count, error *err);
/* Before the first frame; copies. */
CHECKED mrt_result clip_add_curve(clip *c, const clip_curve *what, error *err);
CHECKED mrt_result clip_add_bone(clip *c, const clip_bone *what, error *err);
/* vector: column_count by 3 of the newest segment, mm. The shape is
 * base + sum_k column_k * (float)vector_k, summed in k order in float32. */
CHECKED mrt_result clip_add_anchored(clip *c, const double *vector, error *err);
CHECKED mrt_result clip_add_free(clip *c, const float *position, error *err);
/* The free points that pull the frame that was added last, for the table: count by 6, mm: start and
 * end. */
CHECKED mrt_result clip_add_controls(clip *c, const double *start_end, uint32_t count, error *err);
/* A hand of the frame that was added last. joint: MRT_JOINTS by 3, mm, as mrt_hand's. */
CHECKED mrt_result clip_add_hand(clip *c, uint32_t side, const double *joint, error *err);

/* Of the frame that was added last. value: one for each curve, NaN: it says nothing, as 0. pulled:
 * pull_count by 3 of the newest segment, mm; NULL: nothing is pulled. */
CHECKED mrt_result clip_add_named(clip *c, const double *value, const double *pulled, error *err);

/* Likewise: 7 for each bone, in the face's frame: the quaternion x y z w of its rotation from rest,
 * and where its centre is, mm. */
CHECKED mrt_result clip_add_pose(clip *c, const double *pose, error *err);

/* What the frames say in ARKit's names (mesh/arkit.h): before the first frame, which of the
 * channels anything says; of the frame that was added last, all of them: shapes 0..1, turns rad. */
typedef struct clip_arkit {
    bool is_said[ARKIT_CHANNELS];
    uint32_t shape_count, turn_count; /* that are */
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
/* Segment of a frame, or -1 for a free one. */
int32_t clip_frame_segment(const clip *c, uint32_t frame);
/* The vectors of an anchored frame, NULL for a free one; until the clip changes. */
const double *clip_vector(const clip *c, uint32_t frame);
/* The control vectors of a frame (count by 6), NULL and 0 without any; until the clip changes. */
const double *clip_controls(const clip *c, uint32_t frame, uint32_t *out_count);
/* The joints of a hand in a frame (MRT_JOINTS by 3), NULL where it was not there; likewise. */
const double *clip_hand(const clip *c, uint32_t frame, uint32_t side);
/* Positions of any frame, vertex_count by 3. */
CHECKED mrt_result clip_read(const clip *c, uint32_t frame, float *out_position, error *err);

/* Frames are close to what their named part shows: a curve moves something, or controls pull. */
bool clip_is_named(const clip *c);
uint32_t clip_curve_count(const clip *c);
const clip_curve *clip_curve_at(const clip *c, uint32_t curve);
/* clip_curve_count values, NULL: the frame has no named part; until the clip changes. */
const double *clip_values(const clip *c, uint32_t frame);
uint32_t clip_bone_count(const clip *c);
const clip_bone *clip_bone_at(const clip *c, uint32_t bone);
/* 7 for each bone, NULL: the frame has none; until the clip changes. */
const double *clip_pose(const clip *c, uint32_t frame);
const clip_arkit *clip_arkit_of(const clip *c);
/* ARKIT_CHANNELS values, NULL: the frame has none; until the clip changes. */
const double *clip_arkit_values(const clip *c, uint32_t frame);
/* How much of at_max (> 0) or at_min (< 0) a value shows: -1..1. */
double clip_curve_part(const clip_curve *curve, double value);
/* The pulls of a frame (pull_count of the segment, by 3), NULL without any; until the clip changes.
 */
const double *clip_pulled(const clip *c, uint32_t frame, uint32_t *out_segment);

typedef struct clip_remainder {  /* of frames that have a named part */
    double furthest_mm, mean_mm; /* of the vertex furthest from its position, in the worst frame;
                                    over the frames */
    double loose_mm;             /* likewise, in free frames in which nothing is pulled: clay */
} clip_remainder;
/* A clip of the rest shape moved by what the named part of each frame leaves; anchored frames
 * without one stand still. Destroy it before c. */
clip *clip_split(const clip *c, clip_remainder *out, error *err);

#endif
