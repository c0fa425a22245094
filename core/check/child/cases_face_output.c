/* Face outputs. */
#include "check/child/cases.h"
#include "check/child/fixture.h"
#include "check/child/tell.h"
#include "check/child/trap.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { BONES = 4, SHAPES = 3, WEIGHTS = 95, VERTICES = 12, CONTACTS_MAX = 64, SAMPLES = 200 };
enum { ROUNDS = 20, HEAP_BYTES_MAX = 64 };
static const char no_receiver[] = "no place to send to";
static const int64_t usual_ns = 20000000; /* of send(), on a quiet machine at most */

static double params[TYPES_PARAMS_MAX];
static host with;

typedef struct output {
    const mrt_face_output *functions;
    mrt_plugin *self;
    mrt_face_wants wants;
} output;

/* ---- what it is told ---- */

static const char *const bone_name[BONES] = {"skull", "jaw", "eye.l", "eye.r"};
static const int32_t parent[BONES] = {-1, 0, 0, 0};
static const mrt_vec3 pivot[BONES] = {{0, -100, 0}, {0, -20, 0}, {30, 60, 60}, {-30, 60, 60}};
static const char *const shape_name[SHAPES] = {"jawOpen", "a shape with blanks", "\xc3\xa4"};
static char weight_text[WEIGHTS][16];
static const char *weight_name[WEIGHTS];

static mrt_face_names names_of(face_kind kind)
{
    bool is_bare = kind == FACE_BARE;
    for (int i = 0; i < WEIGHTS; ++i) {
        memcpy(weight_text[i], "Weight00", 9);
        weight_text[i][6] = (char)('0' + i / 10);
        weight_text[i][7] = (char)('0' + i % 10);
        weight_name[i] = weight_text[i];
    }
    return (mrt_face_names){.face = faces_of(kind),
                            .bones = bone_name,
                            .parents = parent,
                            .pivots = pivot,
                            .shapes = shape_name,
                            .weights = weight_name,
                            .bone_count = is_bare ? 0 : BONES,
                            .shape_count = is_bare ? 0 : SHAPES,
                            .weight_count = is_bare ? 0 : WEIGHTS,
                            .vertex_count = VERTICES};
}

static mrt_face_sample sample_of(uint32_t index, const mrt_face_wants *wants)
{
    static mrt_bone_pose bone[BONES];
    static float dof[MRT_MAX_DOFS], shape[SHAPES], weight[WEIGHTS];
    static mrt_vec3 contact[CONTACTS_MAX], vertex[VERTICES];
    float part = (float)(index % 100) / 99.0f;
    for (int i = 0; i < BONES; ++i)
        bone[i] = (mrt_bone_pose){{0.6f * part, 0, 0, 0.8f}, {part, 0, 0}};
    for (int i = 0; i < MRT_MAX_DOFS; ++i)
        dof[i] = 0.2f * part;
    for (int i = 0; i < SHAPES; ++i)
        shape[i] = part;
    for (int i = 0; i < WEIGHTS; ++i)
        weight[i] = part;
    for (int i = 0; i < CONTACTS_MAX; ++i)
        contact[i] = (mrt_vec3){part, -part, 0};
    return (mrt_face_sample){.time_ns = host_now_ns(&with),
                             .take_ns = index % 2 ? -1 : (int64_t)index * 10000000,
                             .number = index / 2 + 1, /* each of them is said twice */
                             .bones = bone,
                             .dofs = dof,
                             .contacts = contact,
                             .shapes = shape,
                             .weights = weight,
                             .vertices = wants->vertices ? vertex : NULL};
}

/* ---- its calls ---- */

static mrt_result open_at(output *self, const char *address)
{
    tell_doing(RULE_COUNT, "open(\"%s\")", address);
    uint32_t before = with.error_count;
    self->wants = (mrt_face_wants){0};
    watch_next();
    mrt_result result = self->functions->open(self->self, address, params, &self->wants);
    if (result < 0 && with.error_count == before)
        tell_failed(RULE_RUN_EXPLAINED, "open(\"%s\") returned %d, and logged no error", address,
                    result);
    return result;
}

static void close_it(output *self)
{
    tell_doing(RULE_COUNT, "close()");
    watch_next();
    self->functions->close(self->self);
}

static void judge_absent(output *self)
{
    if (open_at(self, no_receiver) >= 0)
        tell_skipped(RULE_FACE_OUTPUT_ABSENT, "it opens any address, \"%s\" too", no_receiver);
    else if (strlen(with.last_log) < 12 || !strchr(with.last_log, ' '))
        tell_failed(RULE_FACE_OUTPUT_ABSENT, "open(\"%s\") says \"%s\": no sentence that helps",
                    no_receiver, with.last_log);
    else
        tell_ok(RULE_FACE_OUTPUT_ABSENT, "\"%s\"", with.last_log);
    close_it(self);
}

static int by_size(const void *a, const void *b)
{
    int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
    return (x > y) - (x < y);
}

static void send_samples(output *self, face_kind kind)
{
    static mrt_face_names names;
    int64_t took_ns[SAMPLES];
    names = names_of(kind);
    tell_doing(RULE_FACE_OUTPUT_FACES, "begin() of %s", faces_name(kind));
    watch_next();
    mrt_result result = self->functions->begin(self->self, &names);
    if (result < 0)
        tell_failed(RULE_FACE_OUTPUT_FACES, "begin() of %s returned %d: %s", faces_name(kind),
                    result, with.last_log);
    tell_doing(RULE_COUNT, "send() of %s", faces_name(kind));
    for (uint32_t i = 0; i < SAMPLES; ++i) {
        const mrt_face_sample sample = sample_of(i, &self->wants);
        int64_t before_ns = host_now_ns(&with);
        watch_next();
        result = self->functions->send(self->self, params, &sample);
        took_ns[i] = host_now_ns(&with) - before_ns;
        if (result != MRT_OK && result != MRT_TIMEOUT)
            tell_failed(RULE_FACE_OUTPUT_SEND, "send() returned %d for sample %u: %s", result, i,
                        with.last_log);
    }
    qsort(took_ns, SAMPLES, sizeof *took_ns, by_size);
    if (took_ns[SAMPLES / 2] > usual_ns)
        tell_failed(RULE_FACE_OUTPUT_TIME, "send() takes %.1f ms, half of the time or more often",
                    (double)took_ns[SAMPLES / 2] / 1e6);
}

static void judge_reopening(output *self, const char *address)
{
    size_t before = 0;
    for (int i = 0; i < ROUNDS; ++i) {
        close_it(self);
        if (open_at(self, address) < 0) {
            tell_failed(RULE_FACE_OUTPUT_REOPEN, "closed and opened again it says: %s",
                        with.last_log);
            return;
        }
        if (i == 1)
            before = trap_heap_bytes();
    }
    long heap = (long)trap_heap_bytes() - (long)before;
    if (heap > HEAP_BYTES_MAX * ROUNDS)
        tell_failed(RULE_FACE_OUTPUT_REOPEN, "each open() and close() leaves %ld bytes",
                    heap / (ROUNDS - 2));
    tell_ok(RULE_FACE_OUTPUT_REOPEN, "%d times", ROUNDS);
}

void cases_face_output(const examination *e)
{
    static const check_rule rules[] = {RULE_FACE_OUTPUT_FACES, RULE_FACE_OUTPUT_SEND,
                                       RULE_FACE_OUTPUT_TIME, RULE_FACE_OUTPUT_REOPEN};
    const char *address = e->output_address ? e->output_address : "";
    output self = {.functions = types_interface(e->type, MRT_FACE_OUTPUT)};
    for (uint32_t i = 0; i < e->type->param_count; ++i)
        params[i] = e->type->params[i].initial;
    host_init(&with, HOST_REAL, 0);
    tell_doing(RULE_COUNT, "create()");
    watch_next();
    self.self = e->type->create(&with.plugin);
    if (!self.self)
        return;
    judge_absent(&self);
    bool is_open = open_at(&self, address) >= 0;
    for (size_t i = 0; i < sizeof rules / sizeof *rules && !is_open; ++i)
        tell_skipped(rules[i],
                     "nothing could be opened (%.300s): name a place with --output "
                     "ADDRESS",
                     with.last_log);
    for (int kind = 0; kind < FACE_KINDS && is_open && !tell_has_failed_any(); ++kind)
        send_samples(&self, (face_kind)kind);
    if (is_open) {
        judge_reopening(&self, address);
        tell_ok(RULE_FACE_OUTPUT_FACES, "%d faces", FACE_KINDS);
        tell_ok(RULE_FACE_OUTPUT_SEND, "%d samples", SAMPLES * FACE_KINDS);
        tell_ok(RULE_FACE_OUTPUT_TIME, "%d samples", SAMPLES * FACE_KINDS);
    }
    close_it(&self);
    tell_doing(RULE_COUNT, "destroy()");
    e->type->destroy(self.self);
}
