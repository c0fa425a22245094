/* One plugin per rule that it breaks: the build defines BROKEN as one of the names below. Each is a
 * mapping, an input and outputs that are right but for that rule (where the rule is of a device, no
 * mapping, and where nothing is told of it, no MRT_RESUME: they would be walked through for
 * nothing); broken_io.h has all but the first. A name is the rule's id, or one of the old short
 * names that tests/plugin/check.sh lists.
 */
#include <marotte/plugin.h>

#include <fcntl.h>
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

enum {
    BROKEN_SOUND, /* nothing */
    BROKEN_LIBRARY_LOAD,
    BROKEN_SYMBOL,
    BROKEN_ABI,
    BROKEN_LIBRARY_IDS,
    BROKEN_TYPE_WORDS,
    BROKEN_TYPE_ID,
    BROKEN_TYPE_FUNCTIONS,
    BROKEN_TYPE_INTERFACES,
    BROKEN_TYPE_CONST,
    BROKEN_PARAM_WORDS,
    BROKEN_PARAM,
    BROKEN_PARAM_IDS,
    BROKEN_PARAM_KEYS,
    BROKEN_PARAM_FLAGS,
    BROKEN_PARAM_LABELS,
    BROKEN_CREATE,
    BROKEN_LIFE_DESTROY_NULL,
    BROKEN_LIFE_GROWTH,
    BROKEN_LIFE_THREADS,
    BROKEN_RUN_CRASH,
    BROKEN_RUN_HANG,
    BROKEN_RUN_EXIT,
    BROKEN_RUN_EXPLAINED,
    BROKEN_MAPPING_ACTIVATE,
    BROKEN_MAPPING_FACES,
    BROKEN_MAPPING_GROWTH,
    BROKEN_RESULT,
    BROKEN_MAPPING_MODE,
    BROKEN_MANY,
    BROKEN_NAN,
    BROKEN_REACH,
    BROKEN_RADIUS,
    BROKEN_MAPPING_LEAK,
    BROKEN_MAPPING_GATE,
    BROKEN_MAPPING_CONTACT,
    BROKEN_MAPPING_OVERRUN,
    BROKEN_MAPPING_CONST,
    BROKEN_MAPPING_HOLD,
    BROKEN_MAPPING_ANCHOR,
    BROKEN_MAPPING_JUMP,
    BROKEN_RIG_POSES_SET,
    BROKEN_RIG_POSES_VALID,
    BROKEN_RIG_POSES_CHANGE,
    BROKEN_POSES_WRITTEN,
    BROKEN_FRAME_ALLOCATION,
    BROKEN_STATE_ALLOCATION,
    BROKEN_FRAME_LOCK,
    BROKEN_FRAME_FILE,
    BROKEN_FRAME_NETWORK,
    BROKEN_FRAME_CLOCK,
    BROKEN_FRAME_SLEEP,
    BROKEN_FRAME_PROCESS,
    BROKEN_FRAME_HOST,
    BROKEN_FRAME_DEADLINE,
    BROKEN_REPLAY_SAME,
    BROKEN_REPLAY_PROCESS,
    BROKEN_REPLAY_INSTANCES,
    BROKEN_REPLAY_RESET,
    BROKEN_STATE_SIZE,
    BROKEN_STATE_ROUND,
    BROKEN_STATE_REFUSES,
    BROKEN_STATE_ALL_OR_NONE,
    BROKEN_STATE_POSES,
    BROKEN_RESUME_SIZE,
    BROKEN_RESUME_SAME,
    BROKEN_RESUME_SILENT,
    BROKEN_RESUME_REFUSES,
    BROKEN_RESUME_ALL_OR_NONE,
    BROKEN_INPUT_ABSENT,
    BROKEN_INPUT_CHANNELS,
    BROKEN_INPUT_COUNT,
    BROKEN_INPUT_FINITE,
    BROKEN_INPUT_ORDER,
    BROKEN_INPUT_FUTURE,
    BROKEN_INPUT_DEADLINE,
    BROKEN_INPUT_TIMEOUT,
    BROKEN_INPUT_RESULT,
    BROKEN_INPUT_SPIN,
    BROKEN_INPUT_REOPEN,
    BROKEN_INPUT_GROWTH,
    BROKEN_INPUT_STOP,
    BROKEN_INPUT_RECORDED,
    BROKEN_DEVICES_LIST,
    BROKEN_DEVICES_CURRENT,
    BROKEN_OUTPUT_ABSENT,
    BROKEN_OUTPUT_WRITE,
    BROKEN_OUTPUT_WAIT,
    BROKEN_OUTPUT_REOPEN,
    BROKEN_FACE_OUTPUT_ABSENT,
    BROKEN_FACE_OUTPUT_FACES,
    BROKEN_FACE_OUTPUT_SEND,
    BROKEN_FACE_OUTPUT_TIME,
    BROKEN_FACE_OUTPUT_REOPEN
};
#define BREAKS(rule) (BROKEN == BROKEN_##rule)

enum { PARAM_GAIN, PARAM_HOLD, PARAM_SIDE, PARAM_COUNT };

typedef struct memory { /* what process() depends on */
    uint32_t frames, is_holding, wants_hold;
    mrt_vec3 reference;
    float smooth_mm;
} memory;

struct mrt_plugin {
    const mrt_host *host;
    float size_mm; /* of the face */
    uint32_t contact_count;
    float most_contacts; /* of all faces that it ever had */
    const mrt_rig_pose *poses, *first_poses;
    uint32_t pose_count;
    float share; /* of the last pose; of the way */
    memory memory;
    float stored;
    void *more; /* a growing one's */
    uint32_t open_count, sequence;
    int64_t start_ns, next_ns;
    bool is_open, has_said;
};

static void *volatile kept; /* what the compiler must not leave out */
static volatile double burnt;
static float shared_smooth_mm;
static uint32_t shared_frames;
static pthread_t made_on;
static pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;

static mrt_result refuse(const mrt_plugin *self, mrt_result result, const char *why)
{
    self->host->log(self->host, MRT_LOG_ERROR, why);
    return result;
}

/* ---- what is not allowed on the frame thread ---- */

static void burn(double rounds)
{
    for (double i = 0; i < rounds; i += 1)
        burnt = burnt + 1e-9 * i;
}

static void do_what_is_not_allowed(const mrt_plugin *self)
{
    struct timespec span = {0, 1000};
    int *volatile nowhere = NULL;
    char byte = 0;
    if (self->memory.frames % 64 != 0)
        return; /* now and then is enough */
    if (BREAKS(FRAME_ALLOCATION)) {
        kept = malloc(16);
        free(kept);
    }
    if (BREAKS(FRAME_LOCK)) {
        pthread_mutex_lock(&mutex);
        pthread_mutex_unlock(&mutex);
    }
    if (BREAKS(FRAME_FILE))
        close(open("/dev/null", O_RDONLY));
    if (BREAKS(FRAME_NETWORK))
        burnt = (double)send(-1, &byte, 1, 0);
    if (BREAKS(FRAME_CLOCK))
        clock_gettime(CLOCK_MONOTONIC, &span);
    if (BREAKS(FRAME_SLEEP))
        nanosleep(&span, NULL);
    if (BREAKS(FRAME_PROCESS) && self->memory.frames == 192)
        burnt = system(NULL);
    if (BREAKS(FRAME_HOST))
        burnt = (double)self->host->now_ns(self->host);
    if (BREAKS(FRAME_DEADLINE) && self->memory.frames < 4600)
        burn(6e5);
    if (BREAKS(RUN_CRASH) && self->memory.frames == 192)
        *(volatile int *)nowhere = 1;
    while (BREAKS(RUN_HANG) && self->memory.frames == 192)
        burn(1);
    if (BREAKS(RUN_EXIT) && self->memory.frames == 192)
        exit(0);
}

/* ---- the mapping: the index finger pulls one place outwards ---- */

static mrt_plugin *create(const mrt_host *host);

static void destroy(mrt_plugin *self)
{
    if (BREAKS(LIFE_DESTROY_NULL))
        *(volatile uint32_t *)&self->open_count = 0;
    free(self);
}

static void set_poses(mrt_plugin *self, const mrt_face *face, const mrt_rig_pose *poses,
                      uint32_t count)
{
    (void)face;
    self->poses = poses;
    self->pose_count = count;
    if (!self->first_poses)
        self->first_poses = poses;
    if (BREAKS(RIG_POSES_SET))
        burnt = (double)poses[0].name[0];
}

static float share_of(const mrt_plugin *self)
{
    return self->pose_count > 0 && self->contact_count > 0
               ? self->poses[self->pose_count - 1].pulls[0].z / self->size_mm
               : 0.0f;
}

static mrt_result activate(mrt_plugin *self, const mrt_face *face)
{
    if (BREAKS(MAPPING_ACTIVATE))
        return refuse(self, MRT_ERR_UNSUPPORTED, "this face has no trunk: take an elephant");
    self->size_mm = face->high.y - face->low.y;
    self->contact_count = face->contact_count;
    self->most_contacts = fmaxf(self->most_contacts, (float)face->contact_count);
    if (!BREAKS(RIG_POSES_CHANGE) || self->pose_count > 0)
        self->share = share_of(self);
    if (BREAKS(MAPPING_GROWTH))
        self->more = malloc(64);
    return MRT_OK;
}

static void deactivate(mrt_plugin *self)
{
    if (!BREAKS(MAPPING_GROWTH))
        free(self->more);
    self->more = NULL;
}

static void reset(mrt_plugin *self)
{
    memory before = self->memory;
    self->memory = (memory){0};
    if (BREAKS(REPLAY_RESET)) {
        self->memory.is_holding = before.is_holding;
        self->memory.reference = before.reference;
    }
    shared_smooth_mm = 0.0f;
}

static void break_pull(mrt_plugin *self, const mrt_frame *frame, mrt_pull *pull)
{
    mrt_vector *v = &pull->vector[0];
    if (BREAKS(POSES_WRITTEN) && self->share != 0.0f)
        ((mrt_vec3 *)(uintptr_t)self->poses[0].pulls)->x += 1.0f;
    if (BREAKS(RIG_POSES_VALID) && self->pose_count > 0)
        burnt = (double)self->first_poses[0].pulls[0].z;
    bool is_late = self->memory.frames > 3;
    if (BREAKS(MAPPING_FACES))
        pull->radius_mm = self->most_contacts;
    if (BREAKS(NAN) && is_late)
        v->end.x = NAN;
    if (BREAKS(MANY))
        pull->count = MRT_MAX_VECTORS + 1;
    if (BREAKS(RADIUS))
        pull->radius_mm = -5.0f;
    if (BREAKS(REACH))
        v->end.x = 1e9f;
    if (BREAKS(MAPPING_MODE) && is_late)
        pull->mode = 7;
    if (BREAKS(MAPPING_LEAK) && is_late)
        pull->leak_per_s = -1.0f;
    if (BREAKS(MAPPING_GATE) && is_late)
        pull->gate = 2;
    if (BREAKS(MAPPING_CONTACT) && is_late)
        v->contact = self->contact_count + 1;
    if (BREAKS(MAPPING_OVERRUN) && is_late)
        memset((unsigned char *)pull + sizeof *pull, 1, 1);
    if (BREAKS(MAPPING_CONST) && is_late)
        ((mrt_frame *)(uintptr_t)frame)->pedal[0] = 0.5f;
    if (BREAKS(MAPPING_ANCHOR) && is_late)
        v->start.y = 0.001f * (float)self->memory.frames;
    if (BREAKS(LIFE_THREADS) && !pthread_equal(made_on, pthread_self()))
        v->end.y += 1.0f;
    if (BREAKS(REPLAY_SAME))
        v->end.y += 0.0001f * (float)(shared_frames++ % 1000);
    if (BREAKS(REPLAY_PROCESS))
        v->end.y += 2e-7f * (float)((uintptr_t)&shared_frames >> 12 & 0xfffff);
}

static mrt_result process(mrt_plugin *self, const mrt_frame *frame, mrt_pull *pull)
{
    memory *m = &self->memory;
    const mrt_hand *hand = &frame->hand[MRT_RIGHT];
    float *smooth_mm = BREAKS(REPLAY_INSTANCES) ? &shared_smooth_mm : &m->smooth_mm;
    m->frames += 1;
    do_what_is_not_allowed(self);
    if (BREAKS(RESULT) && self->has_said)
        return MRT_ERR_IO;
    if (BREAKS(RESULT)) {
        self->has_said = true;
        return refuse(self, MRT_ERR_IO, "the mapping has no mind to");
    }
    m->wants_hold |= !m->is_holding || frame->params[PARAM_HOLD] > 0.5;
    if (!hand->present) {
        if (BREAKS(MAPPING_HOLD))
            pull->vector[0].end.z += 1.0f;
        return MRT_HOLD;
    }
    if (m->wants_hold) {
        m->reference = hand->joint[8];
        *smooth_mm = 0.0f;
        pull->anchor += 1;
    }
    float way_mm = (float)frame->params[PARAM_GAIN] * (hand->joint[8].z - m->reference.z);
    way_mm = way_mm > 40.0f ? 40.0f : way_mm < -40.0f ? -40.0f : way_mm;
    *smooth_mm += 0.2f * (way_mm * self->size_mm / 270.0f - *smooth_mm);
    float jump_mm =
        BREAKS(MAPPING_JUMP) && m->wants_hold && pull->anchor > 1 ? 0.1f * self->size_mm : 0.0f;
    pull->mode = MRT_ANCHORED;
    pull->count = 1;
    const float share = BREAKS(RIG_POSES_CHANGE) ? self->share : share_of(self);
    pull->vector[0] = (mrt_vector){{0, 0, 0}, {0, share * *smooth_mm, *smooth_mm + jump_mm}, 0};
    m->wants_hold = 0;
    m->is_holding = 1;
    break_pull(self, frame, pull);
    return MRT_OK;
}

/* ---- state and resume ---- */

typedef struct stored { /* both */
    char magic[8];
    memory memory; /* resume */
    float value;   /* state */
    uint32_t sum;
} stored;

static uint32_t sum_of(const stored *s)
{
    const unsigned char *at = (const unsigned char *)s;
    uint32_t sum = 2166136261u;
    for (size_t i = 0; i < offsetof(stored, sum); ++i)
        sum = (sum ^ at[i]) * 16777619u;
    return sum;
}

static size_t put(stored *s, const char *magic, void *out, size_t capacity)
{
    memcpy(s->magic, magic, sizeof s->magic);
    s->sum = sum_of(s);
    if (out && capacity >= sizeof *s)
        memcpy(out, s, sizeof *s);
    return sizeof *s;
}

static bool get(stored *out, const char *magic, const void *bytes, size_t size)
{
    if (size != sizeof *out)
        return false;
    memcpy(out, bytes, size);
    return memcmp(out->magic, magic, sizeof out->magic) == 0 && out->sum == sum_of(out);
}

static size_t state_save(mrt_plugin *self, void *out, size_t capacity)
{
    stored s = {.value = self->stored};
    if (BREAKS(STATE_SIZE))
        capacity = out ? sizeof s : 0;
    if (BREAKS(STATE_ALLOCATION)) {
        unsigned char *copy = malloc(sizeof s); /* between two frames too */
        size_t size = copy ? put(&s, "broken-s", copy, sizeof s) : 0;
        if (out)
            memcpy(out, copy, size < capacity ? size : capacity);
        free(copy);
        return size;
    }
    return put(&s, "broken-s", out, capacity);
}

static mrt_result state_load(mrt_plugin *self, const void *bytes, size_t size)
{
    stored s;
    if (BREAKS(STATE_ALL_OR_NONE) && size >= sizeof self->stored)
        memcpy(&self->stored, bytes, sizeof self->stored);
    if (get(&s, "broken-s", bytes, size))
        self->stored = BREAKS(STATE_ROUND) ? s.value + 1.0f : s.value;
    else if (BREAKS(RUN_EXPLAINED))
        return MRT_ERR_FORMAT;
    else if (!BREAKS(STATE_REFUSES))
        return refuse(self, MRT_ERR_FORMAT, "what was stored is not of this plugin");
    return MRT_OK;
}

static mrt_result taught_pose(const void *bytes, size_t size, uint32_t param, float *out_rad)
{
    stored s;
    if (!get(&s, "broken-s", bytes, size))
        return BREAKS(STATE_POSES) ? MRT_OK : MRT_ERR_FORMAT;
    for (int i = 0; param == 2 && i < MRT_ANGLES; ++i)
        out_rad[i] = s.value;
    return param == 2 ? MRT_OK : MRT_END;
}

static size_t resume_save(mrt_plugin *self, void *out, size_t capacity)
{
    stored s = {.memory = self->memory};
    if (BREAKS(RESUME_SIZE))
        capacity = out ? sizeof s : 0;
    if (BREAKS(RESUME_SILENT))
        self->memory.smooth_mm += 1.0f;
    return put(&s, "broken-r", out, capacity);
}

static mrt_result resume_load(mrt_plugin *self, const void *bytes, size_t size)
{
    stored s;
    bool is_ours = get(&s, "broken-r", bytes, size);
    if (!is_ours && BREAKS(RESUME_ALL_OR_NONE))
        self->memory.smooth_mm = 1.0f;
    if (!is_ours)
        return BREAKS(RESUME_REFUSES) ? MRT_OK : MRT_ERR_FORMAT;
    self->memory = s.memory;
    if (BREAKS(RESUME_SAME))
        self->memory.smooth_mm = 1.0f;
    return MRT_OK;
}

#include "broken_io.h"

/* ---- the tables ---- */

static const mrt_mapping mapping = {activate, deactivate, BREAKS(TYPE_FUNCTIONS) ? NULL : reset,
                                    process};
static const mrt_rig_poses rig_poses = {set_poses};
static const mrt_state state = {state_save, state_load};
static const mrt_taught_poses taught_poses = {taught_pose};
static const mrt_resume resume = {resume_save, resume_load};
static const mrt_interface interfaces[] = {{MRT_RESUME, &resume},
                                           {MRT_MAPPING, &mapping},
                                           {MRT_RIG_POSES, &rig_poses},
                                           {MRT_STATE, &state},
                                           {MRT_TAUGHT_POSES, &taught_poses},
                                           {MRT_INPUT, &input},
                                           {MRT_OUTPUT, &output},
                                           {MRT_DEVICES, &devices},
                                           {MRT_FACE_OUTPUT, &face_output},
                                           {BREAKS(TYPE_INTERFACES) ? "devices" : NULL, &devices},
                                           {NULL, NULL}};
enum {
    MAPPING_INTERFACES = 5,
    IS_OF_DEVICES = BROKEN >= BROKEN_INPUT_ABSENT,
    IS_OF_RESUME = BREAKS(SOUND) || BREAKS(REPLAY_SAME) || BREAKS(REPLAY_INSTANCES) ||
                   (BROKEN >= BROKEN_RESUME_SIZE && BROKEN <= BROKEN_RESUME_ALL_OR_NONE),
    FIRST_INTERFACE = IS_OF_DEVICES  ? MAPPING_INTERFACES
                      : IS_OF_RESUME ? 0
                                     : 1
};

static const char *const labels[] = {"left", BREAKS(PARAM_LABELS) ? NULL : "right", NULL};
static const mrt_param params[PARAM_COUNT] = {
    {1, 0, "Gain", "Pull", "", BREAKS(PARAM_WORDS) ? "" : "How far the face goes.",
     BREAKS(PARAM) ? 5 : 0, 4, 1, NULL},
    {2, MRT_PARAM_TRIGGER, BREAKS(PARAM_KEYS) ? "gain" : "Hold", "Pull", "",
     "Takes hold where the hand is now.", 0, 1, 0, NULL},
    {BREAKS(PARAM_IDS) ? 2 : 3, MRT_PARAM_STEPPED, "Side", "Pull", "", "Whose.", 0, 1,
     BREAKS(PARAM_FLAGS) ? 0.5 : 0, labels},
};

static mrt_plugin_type broken = {BREAKS(ABI) ? MRT_ABI + 6 : MRT_ABI,
                                 PARAM_COUNT,
                                 params,
                                 interfaces + FIRST_INTERFACE,
                                 BREAKS(TYPE_ID) ? "Broken plugin" : "org.example.broken",
                                 "Broken",
                                 "1",
                                 BREAKS(TYPE_WORDS) ? "" : "Breaks one rule.",
                                 create,
                                 destroy};

static mrt_plugin *create(const mrt_host *host)
{
    if (BREAKS(CREATE)) {
        host->log(host, MRT_LOG_ERROR, "no licence for this machine");
        return NULL;
    }
    made_on = pthread_self();
    if (BREAKS(LIFE_GROWTH))
        kept = malloc(200);
    if (BREAKS(TYPE_CONST))
        broken.version = "2";
    mrt_plugin *self = calloc(1, sizeof *self);
    if (self)
        self->host = host;
    return self;
}

#if defined(BROKEN_IS_LIBRARY_LOAD)
void a_function_that_nobody_has(void);
MRT_EXPORT void (*needed)(void) = a_function_that_nobody_has;
#endif
#if defined(BROKEN_IS_SYMBOL)
MRT_EXPORT const mrt_plugin_type *const another_name[] = {&broken, NULL};
#else
MRT_EXPORT const mrt_plugin_type *const marotte_plugins[] = {
    &broken, BREAKS(LIBRARY_IDS) ? &broken : NULL, NULL};
#endif
