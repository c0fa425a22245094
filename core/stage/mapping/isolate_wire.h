/* stage/mapping/isolate_wire.h - memory block that the program shares with an isolated plugin: a
 * request, its answer and two futexes. Leaves out the creation of the block (isolate_process.h) and
 * the execution of requests (isolate_child.c). One request at a time. The program must check
 * everything that the child may have written, because the child may be faulty. */
#ifndef MAROTTE_STAGE_ISOLATE_WIRE_H
#define MAROTTE_STAGE_ISOLATE_WIRE_H
#include "base/error.h"

#include <stdatomic.h>

enum { ISOLATE_FD = 3, ISOLATE_VERSION = 4 };
enum { ISOLATE_PARAMS_MAX = 1024, ISOLATE_LOGS = 32, ISOLATE_LOG_TEXT = 240 };
enum { ISOLATE_NAME = 64, ISOLATE_INPUT_NAME = 96, ISOLATE_BYTES = 1 << 20 };

enum {
    ISOLATE_CREATE = 1,
    ISOLATE_DESTROY,
    ISOLATE_ACTIVATE, /* bytes: face and poses, see isolate_mapped_write */
    ISOLATE_DEACTIVATE,
    ISOLATE_RESET,
    ISOLATE_PROCESS,
    ISOLATE_STATE_SAVE, /* out: bytes, size; 0: too large, or no state */
    ISOLATE_STATE_LOAD, /* in: bytes, size */
    ISOLATE_RESUME_SAVE,
    ISOLATE_RESUME_LOAD,
    ISOLATE_OUTPUT_OPEN,  /* bytes: address, ended by 0; out: wants */
    ISOLATE_OUTPUT_BEGIN, /* bytes: the names */
    ISOLATE_OUTPUT_SEND,  /* bytes: a sample of the current face */
    ISOLATE_OUTPUT_CLOSE
};

typedef struct isolate_log {
    int32_t level;
    char text[ISOLATE_LOG_TEXT];
} isolate_log;

typedef struct isolate_input { /* an input of a frame; its pointers are valid only in the child */
    mrt_channels as;
    char name[ISOLATE_INPUT_NAME];
    mrt_channel channel[MRT_MAX_CHANNELS];
    char channel_name[MRT_MAX_CHANNELS][ISOLATE_NAME], unit[MRT_MAX_CHANNELS][ISOLATE_NAME];
    float value[MRT_MAX_CHANNELS];
} isolate_input;

typedef struct isolate_block {
    uint32_t version;
    int32_t program_pid;       /* the child ends when its parent has another pid */
    _Atomic uint32_t asked;    /* +1 with each request; futex of the child */
    _Atomic uint32_t answered; /* equal to `asked` after the answer; futex of the program */
    _Atomic uint32_t child_waits, program_waits;
    _Atomic uint32_t is_dead; /* set by the thread that detects the end of the child */

    uint32_t kind;
    mrt_result result;
    uint32_t size;        /* size of `bytes` */
    uint32_t param_count; /* of the type; in the first answer: of the child's library */
    uint32_t param_sum;   /* checksum of the parameter ids */
    uint32_t with_resume; /* request of process: save the state afterwards; answer 1: `bytes` is the
                             state */

    mrt_frame frame; /* the child sets params and inputs to its own pointers */
    double params[ISOLATE_PARAMS_MAX];
    isolate_input input[MRT_MAX_INPUTS];
    mrt_pull pull;
    mrt_face_wants wants;

    _Atomic uint32_t log_count; /* number of lines so far; the last ISOLATE_LOGS are stored */
    isolate_log log[ISOLATE_LOGS];

    unsigned char bytes[ISOLATE_BYTES];
} isolate_block;

/* Sleeps while *word equals `seen`, until time_ns of the monotonic clock at the latest. May return
 * early. */
void isolate_sleep_until_ns(const _Atomic uint32_t *word, uint32_t seen, int64_t time_ns);
void isolate_wake(const _Atomic uint32_t *word);
/* Checksum of the parameter ids in order. */
uint32_t isolate_param_sum(const mrt_plugin_type *type);
/* Returns whether the child has the same parameters as the program, that is, the same library. */
bool isolate_is_table_of(const isolate_block *block, const mrt_plugin_type *type);

/* ---- the inputs of a frame ---- */

/* Program: copies the inputs of `frame` into the block, which already contains the frame. */
void isolate_inputs_write(isolate_block *block, const mrt_frame *frame);
/* Child: sets block->frame.inputs to the inputs of the block. `out` must outlive the frame. */
void isolate_inputs_read(isolate_block *block, mrt_channels out[MRT_MAX_INPUTS]);

/* ---- a face as bytes ---- */

/* Writes at most `capacity` bytes and returns the size. */
size_t isolate_face_write(void *bytes, size_t capacity, const mrt_face *face);
/* A face that was read from bytes, with its memory. isolate_face_finish frees it. */
typedef struct isolate_face {
    mrt_face face;
    mrt_contact *contact;
    mrt_dof *dof;
    char (*name)[ISOLATE_NAME];
} isolate_face;

/* ---- a face with the poses of its rig, as bytes ---- */

/* Writes at most `capacity` bytes and returns the size. */
size_t isolate_mapped_write(void *bytes, size_t capacity, const mrt_face *face,
                            const mrt_rig_pose *poses, uint32_t pose_count);
/* Face and poses that were read from bytes, with their memory. isolate_mapped_finish frees them. */
typedef struct isolate_mapped {
    isolate_face face;
    mrt_rig_pose *pose; /* pose_count elements */
    mrt_vec3 *pull;
    float *dof;
    char (*name)[ISOLATE_NAME];
    uint32_t pose_count;
} isolate_mapped;
CHECKED mrt_result isolate_mapped_read(isolate_mapped *out, const void *bytes, size_t size);
void isolate_mapped_finish(isolate_mapped *m); /* accepts a zeroed struct */

/* ---- names and samples of a face output, as bytes ---- */

size_t isolate_names_write(void *bytes, size_t capacity, const mrt_face_names *names);
/* Names that were read from bytes, with their memory. isolate_names_finish frees them. */
typedef struct isolate_names {
    mrt_face_names names;
    isolate_face face;
    const char **text; /* names of bones, shapes and weights */
    char (*name)[ISOLATE_NAME];
    int32_t *parent;
    mrt_vec3 *pivot;
} isolate_names;
CHECKED mrt_result isolate_names_read(isolate_names *out, const void *bytes, size_t size);
void isolate_names_finish(isolate_names *n); /* accepts a zeroed struct */

/* Returns the number of values of a sample. They are stored contiguously in the order of
 * mrt_face_sample; the vertices, if requested, come last. */
size_t isolate_sample_floats(const mrt_face_names *names, bool has_vertices);
/* Sets the pointers of a sample to its values. Times and number are unchanged. */
void isolate_sample_at(mrt_face_sample *sample, const mrt_face_names *names, const float *value,
                       bool has_vertices);
/* Writes a sample with contiguous values: at most `capacity` bytes. Returns the size. */
size_t isolate_sample_write(void *bytes, size_t capacity, const mrt_face_names *names,
                            const mrt_face_sample *sample);
/* value: room for isolate_sample_floats with vertices. The pointers of `out` point to it. */
CHECKED mrt_result isolate_sample_read(mrt_face_sample *out, float *value,
                                       const mrt_face_names *names, const void *bytes, size_t size);

#endif
