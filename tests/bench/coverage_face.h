/* coverage_face.h - a face and a mapping at work, for coverage.c: the points of the face by which
 * it is judged, faces as the engine shows them, pulls of hands that are held, and a linear model of
 * the face. Errors end the program. One thread. */
#ifndef MAROTTE_TESTS_BENCH_COVERAGE_FACE_H
#define MAROTTE_TESTS_BENCH_COVERAGE_FACE_H
#include "coverage_device.h"
#include "stage/mapping/plugins.h"
#include "stage/perform/performer.h"

#include <string.h>

enum { PARAMS_MAX = 3 * MRT_MAX_VECTORS + MRT_MAX_DOFS };

void must(mrt_result result, const error *err);
void *allocate(size_t count, size_t size); /* zeroed */
static inline double to_double(float v)
{
    return (double)v;
}
static inline bool starts(const char *name, const char *with)
{
    return strncmp(name, with, strlen(with)) == 0;
}
static inline void set_row(double *rows, uint32_t i, vec3 at)
{
    rows[3 * (size_t)i] = at.x;
    rows[3 * (size_t)i + 1] = at.y;
    rows[3 * (size_t)i + 2] = at.z;
}

/* Skin within 12 mm of the lips' rims and of the contacts of brows, the lids, the iris as a point
 * 12 mm before the eye's centre, the tongue: in the skull's frame. The head: how it is turned, as a
 * point 12 mm from the middle of the turn. BROWS, LIDS and IRIS are the upper half. */
typedef enum region { LIPS = 0, BROWS, LIDS, IRIS, TONGUE, HEAD, REGIONS } region;

typedef struct scene {
    face_file file;
    plugin_list plugins;
    log_queue *log;
    instance mapping, live_mapping;
    performer *still, *live; /* still: only its face and its active mapping are used */
    const mrt_mapping *functions;
    const mrt_resume *resume; /* NULL: the mapping has none */
    float neutral_rad[MRT_ANGLES];

    uint32_t *vertex;            /* of the file, region by region */
    uint32_t first[REGIONS + 1]; /* points of each region, iris and head without vertices */
    uint32_t skull, eye[2], eye_count;
    uint32_t contact_count, dof_count, param_count;
    const mrt_contact *contact;

    /* of the mapping at rest, on the device of now */
    device device;
    mrt_frame frame;
    mrt_channels input;
    float value[MRT_ANGLES];
    mrt_pull neutral_pull;
    int64_t neutral_ns;
    unsigned char *state;
    size_t state_size;
    mrt_pull last_performed;
    uint64_t evaluations, performances;
} scene;

/* On that face with a mapping "NAME[,key=value...]" of the build. */
void scene_init(scene *out, const char *face_path, const char *map, const float *neutral_rad);
void scene_finish(scene *self); /* prints what the mapping has warned of */

/* ---- points ---- */

size_t point_numbers(const scene *s); /* 3 for each point */
/* out: points by 3, mm, of the face shown. */
void measure_points(const scene *s, const face *f, double *out);
/* Root mean square and greatest distance of the points of a region, mm; 0 of a region without. */
double region_rms(const scene *s, region of, const double *a, const double *b);
double region_most(const scene *s, region of, const double *a, const double *b);
double upper_most(const scene *s, const double *a, const double *b);

/* ---- faces ---- */

/* By the engine, with its fold guard; out: points by 3, or NULL. The face is shown until the next
 * one. */
face *perform(scene *s, const mrt_pull *pull, double *out);
/* Parameters: how far each contact is pulled (contact_count by 3, mm), then the degrees of freedom,
 * those not driven as 0. */
void read_params(const scene *s, const mrt_pull *pull, double *out);
/* All contacts held. */
mrt_pull pull_of_params(const scene *s, const double *param);

/* ---- hands that are held ---- */

/* The device performs from now on. Its neutral hand comes first. */
void use_device(scene *s, device_kind kind);
/* From the neutral hand at once to this one, which is held until the pull settles. */
void map_hand(scene *s, const float *angle_rad, mrt_pull *out);
/* The same from the hand of before. */
void map_on(scene *s, const float *angle_rad, mrt_pull *pull);
/* Mean time of the mapping's process() while the hand is held, microseconds. */
double process_us(scene *s, const float *angle_rad);

/* ---- the linear model of the face ---- */

/* Features of a region: numbers whose sum of squared differences is the mean squared distance of
 * the region's points, mm^2, as far as the face is linear. */
typedef struct features {
    uint32_t count, pivot[PARAMS_MAX];
    double *of;            /* count by param_count: features of parameters */
    double *triangle;      /* count by count, lower: of the pivots */
    double *direction;     /* count by (3 * points): responses of the pivots */
    size_t first, numbers; /* of the points' numbers */
} features;

typedef struct model {
    features region[REGIONS];
    uint32_t first[REGIONS + 1]; /* in a row of all features */
    double *rest;                /* points by 3 */
} model;

void model_init(model *out, scene *s);
void model_finish(model *m);
/* All features (first[REGIONS]): of parameters; and of points that the engine has shown, as far as
 * the model explains them. */
void model_of_params(const model *m, const scene *s, const double *param, float *out);
void model_of_points(const model *m, const double *point, float *out);

#endif
