/* rigs/puppet/sheet.h - quads on shared points, for the half of a face at x >= 0, and the nets that
 * surfaces of quads are laid in: rings, strips between rings, and the grid that closes a ring; and
 * how its free points are spread over a surface. Leaves out shape. Pure; any thread. */
#ifndef MAROTTE_RIGS_PUPPET_SHEET_H
#define MAROTTE_RIGS_PUPPET_SHEET_H
#include "base/error.h"
#include "base/rigid.h"
#include "mirror.h"

enum { SHEET_RING_CAP = 128 };

/* What a point keeps when the sheet is relaxed. */
enum { SHEET_FREE = 0, SHEET_MIDDLE = MIRROR_MIDDLE, SHEET_FIXED = 2 };

/* The bone that a point moves with and nothing else, 0: neither is certain. */
typedef enum sheet_bone { SHEET_UNSURE = 0, SHEET_SKULL, SHEET_JAW } sheet_bone;

typedef struct sheet_quad {
    int32_t corner[4]; /* counter-clockwise from outside; a triangle has its last corner twice */
    int32_t part;
} sheet_quad;

typedef struct sheet {
    vec3 *point; /* mm */
    uint8_t *hold;
    uint8_t *bone; /* sheet_bone */
    sheet_quad *quad;
    int32_t point_count, quad_count, capacity;
    int is_full; /* something did not fit: the sheet is of no use */
} sheet;

/* Points along a closed curve, or along its half from one point at x = 0 to another; seen from
 * outside it runs counter-clockwise, half rings from below upwards. */
typedef struct ring {
    int32_t at[SHEET_RING_CAP];
    int32_t count;
    int is_half;
} ring;

CHECKED mrt_result sheet_create(sheet *out, int32_t capacity, error *err);
void sheet_destroy(sheet *s); /* accepts NULL and zeroed */

int32_t sheet_add_point(sheet *s, vec3 point, int hold);
void sheet_add_quad(sheet *s, int32_t a, int32_t b, int32_t c, int32_t d, int32_t part);

/* A ring of new points; the ends of a half ring are put on the middle. */
ring sheet_ring(sheet *s, const vec3 *point, int32_t count, int is_half, int hold);
/* The quads between a ring and the next one further in; triangles where one of them has a point
 * twice in a row. */
void sheet_strip(sheet *s, const ring *outer, const ring *inner, int32_t part);
/* Closes a ring with a grid of column_count by row_count cells: the ring begins at its lower corner
 * of small x and has 2 (column_count + row_count) edges; a half ring begins at the middle and has
 * 2 column_count + row_count. Returns the first new point; they are laid out evenly. */
int32_t sheet_close(sheet *s, const ring *outer, int32_t column_count, int32_t row_count,
                    int32_t part, int hold);
/* The same for the ring where a surface begins, seen from inside it: its grid faces the other way.
 */
int32_t sheet_close_back(sheet *s, const ring *first, int32_t column_count, int32_t row_count,
                         int32_t part, int hold);
void sheet_mark(sheet *s, int32_t first_point, sheet_bone bone);

/* ---- spreading the free points over a surface ---- */

typedef vec3 (*sheet_projection)(vec3);

/* EVEN settles far and fast, but folds over sharp bends of fixed lines; AREA has each point drawn
 * by the quads around it, the more the larger they are: it undoes folds, step by step. */
typedef enum sheet_pull { SHEET_EVEN = 0, SHEET_AREA } sheet_pull;

/* Every free point from `first_point` on goes towards the mean of the middles of its quads, those
 * of the mirrored half too, then is projected (NULL: stays there), `round_count` times in the order
 * of the points. */
CHECKED mrt_result sheet_relax(sheet *s, int32_t first_point, int32_t round_count, sheet_pull pull,
                               sheet_projection project, error *err);

#endif
