/* stage/mapping/isolate_wire.h - what a mapping in a process of its own and the program share: one
 * block of memory with a request, its answer and two futexes. Leaves out who makes the block
 * (isolate_process.h) and what a request does (isolate_child.c). One request at a time. Whoever
 * reads what the child may have written checks it: the child may be writing nonsense. */
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
    ISOLATE_ACTIVATE, /* bytes: the face and its poses, isolate_mapped_put */
    ISOLATE_DEACTIVATE,
    ISOLATE_RESET,
    ISOLATE_PROCESS,
    ISOLATE_STATE_SAVE, /* out: bytes, size; 0: it does not fit or cannot be said */
    ISOLATE_STATE_LOAD, /* in: bytes, size */
    ISOLATE_RESUME_SAVE,
    ISOLATE_RESUME_LOAD,
    ISOLATE_OUTPUT_OPEN,  /* bytes: the address, 0-ended; out: wants */
    ISOLATE_OUTPUT_BEGIN, /* bytes: the names */
    ISOLATE_OUTPUT_SEND,  /* bytes: a sample of the face begun */
    ISOLATE_OUTPUT_CLOSE
};

typedef struct isolate_log {
    int32_t level;
    char text[ISOLATE_LOG_TEXT];
} isolate_log;

typedef struct isolate_input { /* of a frame; its pointers are the child's own */
    mrt_channels as;
    char name[ISOLATE_INPUT_NAME];
    mrt_channel channel[MRT_MAX_CHANNELS];
    char channel_name[MRT_MAX_CHANNELS][ISOLATE_NAME], unit[MRT_MAX_CHANNELS][ISOLATE_NAME];
    float value[MRT_MAX_CHANNELS];
} isolate_input;

typedef struct isolate_block {
    uint32_t version;
    int32_t program_pid;       /* the child ends when this is no longer its parent */
    _Atomic uint32_t asked;    /* +1 with each request: the child's futex */
    _Atomic uint32_t answered; /* = asked once it is done: the program's futex */
    _Atomic uint32_t child_waits, program_waits;
    _Atomic uint32_t is_dead; /* told by whoever has seen the child end */

    uint32_t kind;
    mrt_result result;
    uint32_t size;        /* of bytes */
    uint32_t param_count; /* of the type; to the first answer: as the child found it */
    uint32_t param_sum;   /* of their ids */
    uint32_t with_resume; /* process: save afterwards; answer: 1, `size` bytes are the state */

    mrt_frame frame; /* params and inputs: the child's own pointers */
    double params[ISOLATE_PARAMS_MAX];
    isolate_input input[MRT_MAX_INPUTS];
    mrt_pull pull;
    mrt_face_wants wants;

    _Atomic uint32_t log_count; /* ever said; the newest ISOLATE_LOGS are there */
    isolate_log log[ISOLATE_LOGS];

    unsigned char bytes[ISOLATE_BYTES];
} isolate_block;

/* Sleeps while *word is `seen`, at most until the monotonic clock's time_ns; may return early. */
void isolate_sleep_until_ns(const _Atomic uint32_t *word, uint32_t seen, int64_t time_ns);
void isolate_wake(const _Atomic uint32_t *word);
/* Of the ids in their order. */
uint32_t isolate_param_sum(const mrt_plugin_type *type);
/* The child has the parameters that the program knows: its library is the same. */
bool isolate_is_table_of(const isolate_block *block, const mrt_plugin_type *type);

/* ---- the inputs of a frame ---- */

/* Of the program: into the block, whose frame is `frame` already. */
void isolate_inputs_put(isolate_block *block, const mrt_frame *frame);
/* Of the child: block->frame.inputs are those of the block; `out` must outlive the frame. */
void isolate_inputs_take(isolate_block *block, mrt_channels out[MRT_MAX_INPUTS]);

/* ---- a face as bytes ---- */

/* Returns the size; at most `capacity` are written. */
size_t isolate_face_put(void *bytes, size_t capacity, const mrt_face *face);
/* What a face from bytes points to; isolate_face_finish frees it. */
typedef struct isolate_face {
    mrt_face face;
    mrt_contact *contact;
    mrt_dof *dof;
    char (*name)[ISOLATE_NAME];
} isolate_face;
CHECKED mrt_result isolate_face_take(isolate_face *out, const void *bytes, size_t size);
void isolate_face_finish(isolate_face *f); /* zeroed is fine */

/* ---- a face with the poses of its rig, as bytes ---- */

/* Returns the size; at most `capacity` are written. */
size_t isolate_mapped_put(void *bytes, size_t capacity, const mrt_face *face,
                          const mrt_rig_pose *poses, uint32_t pose_count);
/* What both point to; isolate_mapped_finish frees it. */
typedef struct isolate_mapped {
    isolate_face face;
    mrt_rig_pose *pose; /* pose_count of them */
    mrt_vec3 *pull;
    float *dof;
    char (*name)[ISOLATE_NAME];
    uint32_t pose_count;
} isolate_mapped;
CHECKED mrt_result isolate_mapped_take(isolate_mapped *out, const void *bytes, size_t size);
void isolate_mapped_finish(isolate_mapped *m); /* zeroed is fine */

/* ---- what a face output is told, as bytes ---- */

size_t isolate_names_put(void *bytes, size_t capacity, const mrt_face_names *names);
/* What names from bytes point to; isolate_names_finish frees it. */
typedef struct isolate_names {
    mrt_face_names names;
    isolate_face face;
    const char **text; /* of bones, shapes, weights */
    char (*name)[ISOLATE_NAME];
    int32_t *parent;
    mrt_vec3 *pivot;
} isolate_names;
CHECKED mrt_result isolate_names_take(isolate_names *out, const void *bytes, size_t size);
void isolate_names_finish(isolate_names *n); /* zeroed is fine */

/* A sample's values lie one behind the other, in the order of mrt_face_sample. So many; the
 * vertices, which come last, if they are asked for. */
size_t isolate_sample_floats(const mrt_face_names *names, bool has_vertices);
/* Points a sample at its values; its times and its number stay. */
void isolate_sample_at(mrt_face_sample *sample, const mrt_face_names *names, const float *value,
                       bool has_vertices);
/* Of a sample whose values lie so. Returns the size; at most `capacity` are written. */
size_t isolate_sample_put(void *bytes, size_t capacity, const mrt_face_names *names,
                          const mrt_face_sample *sample);
/* value: isolate_sample_floats with vertices; `out` points there. */
CHECKED mrt_result isolate_sample_take(mrt_face_sample *out, float *value,
                                       const mrt_face_names *names, const void *bytes, size_t size);

#endif
