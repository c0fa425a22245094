/* io/decode/decode.h - jobs for the decoders of other libraries, on untrusted bytes: Draco,
 * meshopt, PNG, JPEG and WebP. They run only in marotte-meshload (started by decode_run), one job
 * after the other. This file defines the jobs and their answers. Threads: see decode_run. */
#ifndef MAROTTE_IO_DECODE_H
#define MAROTTE_IO_DECODE_H
#include "base/error.h"

#include <stdio.h>

typedef enum decode_kind {
    DECODE_NONE = 0,
    DECODE_DRACO,   /* a mesh; the answer: index_count uint32, then each attribute's values */
    DECODE_MESHOPT, /* a buffer; the answer: count by stride bytes */
    DECODE_IMAGE,   /* PNG, JPEG, WebP; the answer: decode_image_size, then RGBA, from the top */
    DECODE_KINDS
} decode_kind;

enum { DECODE_ATTRIBUTES_MAX = 16 };

typedef struct decode_attribute { /* of a Draco mesh */
    uint32_t id;
    uint32_t component_type; /* number of the type in glTF */
    uint32_t component_count;
} decode_attribute;

/* The parameters of a job. Values from a file are unverified. */
typedef struct decode_order {
    decode_kind kind;
    uint32_t count;  /* of vertices (Draco), of elements (meshopt) */
    uint32_t stride; /* meshopt: bytes of an element */
    uint32_t mode;   /* meshopt: a decode_mode */
    uint32_t filter; /* meshopt: a decode_filter */
    uint32_t index_count, attribute_count;
    decode_attribute attribute[DECODE_ATTRIBUTES_MAX];
    uint32_t side_max; /* an image is reduced until no side is longer than this, px */
} decode_order;

typedef enum decode_mode {
    DECODE_MODE_NONE = 0,
    DECODE_MODE_ATTRIBUTES,
    DECODE_MODE_TRIANGLES,
    DECODE_MODE_INDICES
} decode_mode;

typedef enum decode_filter {
    DECODE_FILTER_NONE = 0,
    DECODE_FILTER_OCTAHEDRAL,
    DECODE_FILTER_QUATERNION,
    DECODE_FILTER_EXPONENTIAL
} decode_filter;

typedef struct decode_image_size {
    uint32_t width, height; /* px */
} decode_image_size;

typedef struct decode_job {
    decode_order order;
    const void *data; /* size bytes */
    size_t size;
    /* The answer, freed by decode_job_finish. NULL: decoding failed, and `failed` has the reason.
     */
    void *out;
    size_t out_size;
    error failed;
} decode_job;

/* Runs the jobs in order in the child process. A job that crashes it fails alone. The call itself
 * fails only if the process cannot be started. [main], waits up to 20 s. */
CHECKED mrt_result decode_run(decode_job *job, uint32_t count, error *err);
void decode_job_finish(decode_job *job); /* accepts zeroed */

/* Returns the size of the answer to a Draco or meshopt job; 0: the order is invalid. */
size_t decode_answer_size(const decode_order *order);

/* ---- in the child ---- */

/* Reads jobs from a stream and answers each one when it is done. False: the request is truncated.
 * */
bool decode_serve(FILE *request, FILE *answer);

/* The adapters. out_data is malloc'ed. Their input is untrusted. */
CHECKED mrt_result draco_decode(void **out_data, size_t *out_size, const decode_order *order,
                                const void *data, size_t size, error *err);
CHECKED mrt_result meshopt_decode(void **out_data, size_t *out_size, const decode_order *order,
                                  const void *data, size_t size, error *err);
CHECKED mrt_result image_decode(void **out_data, size_t *out_size, const decode_order *order,
                                const void *data, size_t size, error *err);

#endif
