/* tests/unit/slit.h - how far the lips of a face are apart, or inside each other, in columns along
 * the slit, whatever the rims are read from; and what tests of lips ask of a face. */
#ifndef MAROTTE_TESTS_SLIT_H
#define MAROTTE_TESTS_SLIT_H
#include "face/face.h"

#include <math.h>
#include <string.h>

enum { SLIT_COLUMNS = 25 };

typedef struct slit { /* mm, the greatest of all columns; 0 where the lips touch */
    double gap, overlap;
} slit;

/* Where a vertex is shown, with the head upright. */
typedef vec3 slit_place(const void *of, uint32_t vertex);

static inline bool slit_rim_at(vec3 *out, const uint32_t *rim, uint32_t count, double x,
                               slit_place *place, const void *of)
{
    for (uint32_t i = 1; i < count; ++i) {
        const vec3 p = place(of, rim[i - 1]), q = place(of, rim[i]);
        if (!(p.x <= x && x <= q.x && q.x > p.x))
            continue;
        *out = vec3_add(p, vec3_scale(vec3_sub(q, p), (x - p.x) / (q.x - p.x)));
        return true;
    }
    return false;
}

/* Column k, 1 to SLIT_COLUMNS. */
static inline bool slit_column(vec3 *upper, vec3 *lower, const rig_mouth *mouth, int k,
                               slit_place *place, const void *of)
{
    const double right = place(of, mouth->upper[0]).x;
    const double left = place(of, mouth->upper[mouth->upper_count - 1]).x;
    const double x = right + (left - right) * k / (SLIT_COLUMNS + 1);
    return slit_rim_at(upper, mouth->upper, mouth->upper_count, x, place, of) &&
           slit_rim_at(lower, mouth->lower, mouth->lower_count, x, place, of);
}

/* False: a rim does not reach a column. */
static inline bool slit_measure(slit *out, const rig_mouth *mouth, slit_place *place,
                                const void *of)
{
    *out = (slit){0.0, 0.0};
    for (int k = 1; k <= SLIT_COLUMNS; ++k) {
        vec3 upper, lower;
        if (!slit_column(&upper, &lower, mouth, k, place, of))
            return false;
        out->gap = fmax(out->gap, upper.y - lower.y);
        out->overlap = fmax(out->overlap, lower.y - upper.y);
    }
    return true;
}

/* Where a vertex of the file is shown. */
static inline vec3 slit_shown(const face *f, uint32_t vertex)
{
    return points_position(face_shown(f), face_order(f)->slot_of_file[vertex]);
}

/* RIG_NONE: there is none of that name. */
static inline uint32_t slit_dof(const face *f, const char *name)
{
    const bones *b = face_bones(f);
    for (uint32_t i = 0; i < b->dof_count; ++i)
        if (strcmp(b->dof[i].name, name) == 0)
            return i;
    return RIG_NONE;
}

#endif
