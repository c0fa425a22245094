/* bench/bench.h - what the measurements of `marotte bench` share: a clock that is asked
 * alternately, the machine's roofs, and rows of results. A time is the least of many rounds in
 * which everything that is compared takes its turn: what else the machine does only adds to it, and
 * ratios hold within the run. Leaves out what is measured. [main] */
#ifndef MAROTTE_UI_BENCH_BENCH_H
#define MAROTTE_UI_BENCH_BENCH_H
#include "base/error.h"
#include "csrbf/shape.h"
#include "cli/facts.h"
#include "stage/mapping/plugins.h"
#include "stage/perform/face_file.h"
#include "cli/terminal.h"

/* Something that is timed: called again and again, it does the same work each time. */
typedef struct bench_work {
    void (*run)(void *data);
    void *data;
    void (*before)(void *data); /* untimed, before each run: as for cold caches; NULL: run, for
                                   hot ones */
    double least_ns;            /* out */
    double *took_ns;            /* out: each round's, in order; NULL, or room for all rounds */
} bench_work;

/* Runs all of them alternately for `rounds` rounds, after one that does not count; stops after
 * `seconds`, but not before three rounds. Returns the rounds. */
uint32_t bench_measure(bench_work *work, uint32_t count, uint32_t rounds, double seconds);

/* What the machine can do, measured beside a row with as many bytes as it moves. */
typedef struct bench_roof {
    float *from, *to, *other;
    size_t bytes; /* of each of the three: room for the largest */
    size_t used;  /* bytes of one run, read and written */
} bench_roof;
CHECKED mrt_result bench_roof_create(bench_roof *out, size_t bytes, error *err);
void bench_roof_destroy(bench_roof *self);
/* Reads and writes half of `used` each. */
void bench_roof_copy(void *roof);
/* The same, from two streams into one (so a third each), around the caches where the machine can.
 */
void bench_roof_triad(void *roof);
/* Square roots of BENCH_ROOTS floats that stay in the first cache. */
enum { BENCH_ROOTS = 4096 };
/* Reads more than the second-level cache holds: what was in it is gone. */
void bench_roof_flush(void *roof);

typedef struct bench_promise {
    const char *what, *unit; /* static */
    double measured, promised;
    bool is_most; /* promised: at most; else at least */
    bool is_gated;
} bench_promise;
enum { BENCH_PROMISES = 48 };

/* One cell of Table 1, as whoever looks on gets it. */
typedef struct bench_cell {
    bool is_anchored;
    uint32_t vertex_count, triangle_count;
    const float *rest;        /* vertex_count by 3, mm, in the file's order */
    const uint32_t *triangle; /* triangle_count by 3 */
    double radius_mm, frame_ns;
    uint64_t pairs, paper_pairs;
    double paper_fps; /* 0: not in our notes */
    /* One more frame, into shape->shown. */
    void (*run)(void *data);
    void *data;
    const shape *shape;
} bench_cell;

typedef struct bench {
    facts *told;
    progress shown;
    bool is_quick, is_json;
    const char *face;    /* that performs the frames; NULL: the puppet */
    bool is_paper_alone; /* of the grid the paper's models, and no cold caches */
    CHECKED mrt_result (*on_cell)(void *data, const bench_cell *cell, error *err); /* NULL: none */
    void *on_cell_data;
    double seconds; /* for one comparison */
    uint32_t rounds;
    bench_roof roof;
    double off_naive;   /* of the paper's grid: the furthest that a frame was off the naive one */
    double others_busy; /* processors that other programs use */
    double root_ns;     /* of one square root: the best of the run */
    bench_promise promise[BENCH_PROMISES];
    uint32_t promise_count, broken_count; /* broken: not even half kept */
} bench;

/* What this machine calls its processor; "unknown". */
void bench_processor(char *out, size_t capacity);
/* A title over rows, for a person. */
void bench_title(const bench *self, const char *title);

/* ---- promises: told by the parts, printed together at the end ---- */

/* Ratios of this run. `what` is static, and fits on half a line. */
void bench_at_least(bench *self, const char *what, double measured, double promised);
void bench_at_most(bench *self, const char *what, double measured, double promised);
/* A time: it is said how it came out, but no gate asks for it. */
void bench_at_most_ms(bench *self, const char *what, double measured_ms, double promised_ms);

/* ---- the planar models of the paper's Table 1 and larger ones, with ten controls laid out such
 * that the pairs of vertex and control within reach match the paper's counts within 2 % (research:
 * performance.md A; the paper gives no layout). And the deformation as anybody would write it
 * first, to compare with. ---- */

enum { BENCH_CONTROLS = 10, BENCH_RADII = 5 };
extern const double bench_radius_mm[BENCH_RADII];
extern const double bench_control[BENCH_CONTROLS * 3]; /* mm */
extern const double bench_pull[BENCH_CONTROLS * 3];    /* mm: displacements */

typedef struct bench_plane {
    float *xyz, *moved; /* vertex_count by 3 */
    uint32_t *triangle; /* triangle_count by 3 */
    uint32_t vertex_count, triangle_count;
} bench_plane;
/* quads a side; has_centres: each quad with a vertex in its middle. */
CHECKED mrt_result bench_plane_create(bench_plane *out, uint32_t quads, bool has_centres,
                                      error *err);
void bench_plane_destroy(bench_plane *self);

uint64_t bench_plane_pairs(const bench_plane *self, double radius_mm);

typedef struct bench_naive { /* one vertex after the other, one control after the other */
    const bench_plane *plane;
    float centre[BENCH_CONTROLS * 3], alpha[BENCH_CONTROLS * 3], radius_mm;
} bench_naive;
void bench_naive_init(bench_naive *out, const bench_plane *plane, double radius_mm); /* solves */
void bench_naive_run(void *naive); /* into plane->moved */

/* Centre i of so many, spread evenly over an ellipsoid of a skull's size, mm; scale: that much
 * further out. */
void bench_skull_centre(double out[3], uint32_t i, uint32_t count, double scale);

/* ---- a face with what performs it ---- */

typedef struct bench_face {
    char *path;
    face_file file;
    log_queue *log;
    plugin_list plugins;
} bench_face;
/* path NULL: the puppet. To be closed whatever the result. */
CHECKED mrt_result bench_face_open(bench_face *out, const char *path, error *err);
void bench_face_close(bench_face *self);

/* ---- the parts, in the order in which they are printed ---- */
CHECKED mrt_result bench_grid(bench *self, error *err);    /* the paper's Table 1, and larger */
CHECKED mrt_result bench_bones(bench *self, error *err);   /* fields with constraint centres */
CHECKED mrt_result bench_factor(bench *self, error *err);  /* factorisation, up to 3 000 centres */
CHECKED mrt_result bench_threads(bench *self, error *err); /* one and several */
CHECKED mrt_result bench_frame(bench *self, error *err);   /* the whole frame, by phases */
CHECKED mrt_result bench_stage(bench *self, error *err);   /* from a sample to the face published */

#endif
