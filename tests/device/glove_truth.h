/* device/glove_truth.h - what the emulated glove truly measured and sent, read back from the file
 * that it wrote, to be compared with the samples that arrived. Pure but for the reading. */
#ifndef MAROTTE_TESTS_DEVICE_GLOVE_TRUTH_H
#define MAROTTE_TESTS_DEVICE_GLOVE_TRUTH_H
#include "base/error.h"

#include "glove_box.h"

typedef struct glove_truth_row {
    uint32_t number; /* +1 each; glove_motion_number */
    int64_t sample_ns, written_ns;
    bool is_spoiled;
    uint8_t record[GLOVE_RECORD_MAX];
    uint32_t size;
} glove_truth_row;

typedef struct glove_truth {
    glove_truth_row *row;
    size_t count;
} glove_truth;

CHECKED mrt_result glove_truth_read(glove_truth *out, const char *path, error *err);
void glove_truth_finish(glove_truth *truth); /* accepts zeroed */
/* NULL: it was not sent. */
const glove_truth_row *glove_truth_find(const glove_truth *truth, uint32_t number);

/* Of `count` values, which are sorted: mean, standard deviation, quantiles; zeros for none. */
typedef struct glove_spread {
    double mean, deviation, median, p99, least, greatest;
} glove_spread;
glove_spread glove_spread_of(double *value, size_t count);

#endif
