/* hand/calibration_json.h - reading JSON strictly, with the place of every value in the file for
 * messages: "anna.json: $.sensors["index.mpj"].points[1]: expected ...". Inside the room. [main] */
#ifndef MAROTTE_HAND_CALIBRATION_JSON_H
#define MAROTTE_HAND_CALIBRATION_JSON_H
#include "base/error.h"

#include <jansson.h>

enum { CALIBRATION_PLACE = 320 };

typedef struct json_place {
    const json_t *value; /* NULL: there is none here */
    char text[CALIBRATION_PLACE];
} json_place;

/* The root; `name` is the file's. */
json_place json_place_root(const json_t *value, const char *name);
json_place json_place_member(const json_place *of, const char *key);
json_place json_place_item(const json_place *of, size_t index);

/* "PLACE: expected EXPECTED, found ..."; always MRT_ERR_FORMAT. */
mrt_result json_place_unexpected(error *err, const json_place *at, const char *expected);

CHECKED mrt_result json_place_object(const json_place *at, const char *expected, error *err);
CHECKED mrt_result json_place_number(double *out, const json_place *at, double low, double high,
                                     error *err);
/* Two numbers. */
CHECKED mrt_result json_place_pair(double out[2], const json_place *at, double low, double high,
                                   error *err);
/* At most capacity - 1 bytes, no control characters. */
CHECKED mrt_result json_place_text(char *out, size_t capacity, const json_place *at, error *err);
/* One of `count` words; out: which. */
CHECKED mrt_result json_place_choice(uint32_t *out, const json_place *at, const char *const *words,
                                     uint32_t count, error *err);

#endif
