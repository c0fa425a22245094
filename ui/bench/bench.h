/* bench/bench.h - shared by the measurements of `marotte bench`: timing in turns, the limits of the
 * machine, and rows of results. A time is the minimum of many rounds. In each round everything that
 * is compared runs once. Other programs can only add to a time, and ratios are valid within a run.
 * Leaves out the measured work. [main] */
#ifndef MAROTTE_UI_BENCH_BENCH_H
#define MAROTTE_UI_BENCH_BENCH_H
#include "base/error.h"
#include "csrbf/shape.h"
#include "cli/facts.h"
#include "stage/mapping/plugins.h"
#include "stage/perform/face_file.h"
#include "cli/terminal.h"

/* Work that is timed. It is called repeatedly and does the same work each time. */
typedef struct bench_work {
    void (*run)(void *data);
    void *data;
    void (*before)(void *data); /* untimed, before each run, such as emptying the caches; NULL:
                                   calls run, for warm caches */
    double least_ns;            /* out: minimum */
    double *took_ns; /* out: time of each round, in order; NULL, or room for all rounds */
} bench_work;

/* Runs all works in turns for `rounds` rounds, after one round that is not counted. Stops after
 * `seconds`, but not before three rounds. Returns the number of rounds. */
uint32_t bench_measure(bench_work *work, uint32_t count, uint32_t rounds, double seconds);

/* Limits of the machine, measured beside a row, with the number of bytes that the row moves. */
typedef struct bench_roof {
    float *from, *to, *other;
    size_t bytes; /* size of each of the three arrays, for the largest row */
    size_t used;  /* bytes that one run reads and writes */
} bench_roof;
CHECKED mrt_result bench_roof_create(bench_roof *out, size_t bytes, error *err);
void bench_roof_destroy(bench_roof *self);
/* Copies: reads half of `used` and writes the other half. */
void bench_roof_copy(void *roof);
/* The same from two streams into one, a third each. Writes bypass the caches if the machine can do
 * that. */
void bench_roof_triad(void *roof);
/* Computes square roots of BENCH_ROOTS floats that stay in the first-level cache. */
enum { BENCH_ROOTS = 4096 };
/* Empties the second-level cache by reading more than its size. */
void bench_roof_flush(void *roof);

typedef struct bench_promise {
    const char *what, *unit; /* static text */
    double measured, promised;
    bool is_most; /* the goal is a maximum; otherwise a minimum */
    bool is_gated;
} bench_promise;
enum { BENCH_PROMISES = 48 };

/* One cell of Table 1, for the observer. */
typedef struct bench_cell {
    bool is_anchored;
    uint32_t vertex_count, triangle_count;
    const float *rest;        /* vertex_count by 3, mm, in the order of the file */
    const uint32_t *triangle; /* triangle_count by 3 */
    double radius_mm, frame_ns;
    uint64_t pairs, paper_pairs;
    double paper_fps; /* 0: not in our notes */
    /* Computes one more frame into shape->shown. */
    void (*run)(void *data);
    void *data;
    const shape *shape;
} bench_cell;

typedef struct bench {
    facts *told;
    progress shown;
    bool is_quick, is_json;
    const char *face;    /* face for the frames; NULL: the puppet */
    bool is_paper_alone; /* only the models of the paper in the grid, and no cold caches */
    CHECKED mrt_result (*on_cell)(void *data, const bench_cell *cell, error *err); /* NULL: none */
    void *on_cell_data;
    double seconds; /* limit for one comparison */
    uint32_t rounds;
    bench_roof roof;
    double off_naive;   /* paper's grid: greatest difference between a frame and the naive one */
    double others_busy; /* number of processors that other programs use */
    double root_ns;     /* time of one square root: minimum of the run */
    bench_promise promise[BENCH_PROMISES];
    uint32_t promise_count, broken_count; /* broken: less than half of the goal */
} bench;

/* Writes the name of the processor; "unknown" if there is none. */
void bench_processor(char *out, size_t capacity);
/* Prints a title above rows; only for a person. */
void bench_title(const bench *self, const char *title);

/* ---- goals: the parts report them, and they are printed together at the end ---- */

/* Report a ratio of this run. `what` is static, and short enough for half a line. */
void bench_at_least(bench *self, const char *what, double measured, double promised);
void bench_at_most(bench *self, const char *what, double measured, double promised);
/* Reports a time. It is printed, but a gate does not check it. */
void bench_at_most_ms(bench *self, const char *what, double measured_ms, double promised_ms);

/* ---- the planar models of the paper's Table 1, and larger ones, with ten controls. The controls
 * are placed so that the number of pairs of vertex and control within reach matches the paper
 * within 2 % (research: performance.md A; the paper gives no positions). And a naive deformation,
 * for comparison. ---- */

enum { BENCH_CONTROLS = 10, BENCH_RADII = 5 };
extern const double bench_radius_mm[BENCH_RADII];
extern const double bench_control[BENCH_CONTROLS * 3]; /* mm */
extern const double bench_pull[BENCH_CONTROLS * 3];    /* mm: displacements */

typedef struct bench_plane {
    float *xyz, *moved; /* vertex_count by 3 */
    uint32_t *triangle; /* triangle_count by 3 */
    uint32_t vertex_count, triangle_count;
} bench_plane;
/* quads: on each side; has_centres: each quad has a vertex in its middle. */
CHECKED mrt_result bench_plane_create(bench_plane *out, uint32_t quads, bool has_centres,
                                      error *err);
void bench_plane_destroy(bench_plane *self);

uint64_t bench_plane_pairs(const bench_plane *self, double radius_mm);

typedef struct bench_naive { /* one vertex after the other, one control after the other */
    const bench_plane *plane;
    float centre[BENCH_CONTROLS * 3], alpha[BENCH_CONTROLS * 3], radius_mm;
} bench_naive;
void bench_naive_init(bench_naive *out, const bench_plane *plane, double radius_mm); /* solves */
void bench_naive_run(void *naive); /* moves the vertices into plane->moved */

/* Computes centre i of `count`, spread evenly over an ellipsoid of the size of a skull, mm. scale:
 * factor of its distance. */
void bench_skull_centre(double out[3], uint32_t i, uint32_t count, double scale);

/* ---- a face with everything that performs it ---- */

typedef struct bench_face {
    char *path;
    face_file file;
    log_queue *log;
    plugin_list plugins;
} bench_face;
/* path NULL: the puppet. Close it, whatever the result. */
CHECKED mrt_result bench_face_open(bench_face *out, const char *path, error *err);
void bench_face_close(bench_face *self);

/* ---- the parts, in the order of printing ---- */
CHECKED mrt_result bench_grid(bench *self, error *err);    /* the paper's Table 1, and larger */
CHECKED mrt_result bench_bones(bench *self, error *err);   /* fields with constraint centres */
CHECKED mrt_result bench_factor(bench *self, error *err);  /* factorisation, up to 3 000 centres */
CHECKED mrt_result bench_threads(bench *self, error *err); /* one thread and several */
CHECKED mrt_result bench_frame(bench *self, error *err);   /* the whole frame, by phases */
CHECKED mrt_result bench_stage(bench *self, error *err);   /* from a sample to the published face */

#endif
