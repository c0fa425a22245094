/* ui/cli/deform_case.h - a case of control vectors that are applied to points, in the format of
 * tests/golden: reads it strictly from JSON, and runs it through the engine in float64 or float32.
 * [any] */
#ifndef MAROTTE_UI_DEFORM_CASE_H
#define MAROTTE_UI_DEFORM_CASE_H
#include "base/error.h"
#include "base/rigid.h"
#include "csrbf/csrbf.h"

enum {
    DEFORM_CENTRE_CAP = 8192,   /* tips, skull and jaw together: a limit on the time of one solve */
    DEFORM_NUMBER_CAP = 1 << 26 /* limit for coordinates, input and output together */
};

typedef enum deform_mode { DEFORM_ANCHORED = 0, DEFORM_UNANCHORED } deform_mode;
typedef enum deform_precision { DEFORM_F64 = 0, DEFORM_F32 } deform_precision;

typedef struct deform_case {
    csrbf_settings settings;
    deform_mode mode;
    uint32_t tip_count, skull_count, jaw_count, frame_count, point_count;
    double *start;     /* tip_count by 3, at time 0 */
    double *tip;       /* frame_count by tip_count by 3, at times 1 .. frame_count */
    double *skull;     /* skull_count by 3 */
    double *jaw;       /* jaw_count by 3, at rest */
    rigid *pose;       /* frame_count poses from rest, if there is a jaw */
    double *point;     /* point_count by 3 */
    char unknown[256]; /* unknown keys, as "$.a, $.b", for a warning */
} deform_case;

/* Reads a case. Errors name the file and the place in it: "NAME: $.frames[2][0]: ...". */
CHECKED mrt_result deform_case_read(deform_case *out, const void *bytes, size_t size,
                                    const char *name, error *err);
void deform_case_destroy(deform_case *c);

/* Runs the case. out: frame_count by point_count by 3, positions. */
CHECKED mrt_result deform_case_run(const deform_case *c, deform_precision precision, double *out,
                                   error *err);

#endif
