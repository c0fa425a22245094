/* hands/mapping.h - common part of this program's mappings: destroying an instance, its anchored
 * pull, the clutch (when hands engage and release a face), the pose of a hand for mappings by joint
 * angles, and saving an instance as bytes. Leaves out the placement of hands (placement.h). [frame]
 * unless noted. */
#ifndef MAROTTE_PLUGINS_HANDS_MAPPING_H
#define MAROTTE_PLUGINS_HANDS_MAPPING_H
#include <marotte/plugin.h>

#include <float.h>

/* For mrt_plugin_type and mrt_mapping. [main] */
void mapping_destroy(mrt_plugin *self);    /* for an instance that is one calloc */
void mapping_deactivate(mrt_plugin *self); /* for a mapping that allocates nothing per face */

/* Writes an anchored pull with these vectors. Changes its anchor only if a vector starts elsewhere,
 * or pulls another contact, than before. radius_mm: 0: the rig's value. */
void mapping_pull(mrt_pull *pull, const mrt_vector *vector, uint32_t count, float radius_mm);

/* ---- vectors ---- */

static inline mrt_vec3 vec_difference(mrt_vec3 a, mrt_vec3 b)
{
    return (mrt_vec3){a.x - b.x, a.y - b.y, a.z - b.z};
}

static inline mrt_vec3 vec_scaled(float times, mrt_vec3 v)
{
    return (mrt_vec3){times * v.x, times * v.y, times * v.z};
}

/* a + times b */
static inline mrt_vec3 vec_sum(mrt_vec3 a, float times, mrt_vec3 b)
{
    return (mrt_vec3){a.x + times * b.x, a.y + times * b.y, a.z + times * b.z};
}

/* ---- saved state, for MRT_RESUME: a list of variables with their allowed values, used for saving
 * and loading. The bytes contain the plugin type and a checksum; any other bytes are rejected
 * without a change. Leaves out conditions on several variables together. Little-endian. ---- */

typedef enum memory_kind {
    MEMORY_BOOL = 0, /* bool */
    MEMORY_WHOLE,    /* int, unsigned or an enum: 0 to `most` */
    MEMORY_FLOAT,    /* float, -most to most */
    MEMORY_DOUBLE    /* double, -most to most */
} memory_kind;

typedef struct memory_part {
    memory_kind kind;
    void *at; /* NULL: end of the list */
    size_t size;
    double most;
} memory_part;

/* A variable, an array, or a struct of one type (mrt_vec3: three floats). Numbers must be
 * finite. */
/* clang-format off */
#define MEMORY_BOOLS(variable)        {MEMORY_BOOL, &(variable), sizeof(variable), 1.0}
#define MEMORY_WHOLES(variable, most) {MEMORY_WHOLE, &(variable), sizeof(variable), (double)(most)}
#define MEMORY_FLOATS(variable)       {MEMORY_FLOAT, &(variable), sizeof(variable), (double)FLT_MAX}
#define MEMORY_DOUBLES(variable)      {MEMORY_DOUBLE, &(variable), sizeof(variable), DBL_MAX}
/* clang-format on */

enum { MEMORY_PARTS_MAX = 64 };
typedef struct memory_list {
    const char *type; /* the plugin's id */
    uint32_t version; /* of the list */
    memory_part parts[MEMORY_PARTS_MAX];
} memory_list;

/* Returns the size; out may be NULL. Writes nothing if capacity is smaller. Returns 0 if a variable
 * has a value that is not allowed, such as NaN. */
size_t memory_save(const memory_list *list, void *out, size_t capacity);
/* Returns false, without a change, if the bytes are not of such a list or have a value that is not
 * allowed. */
bool memory_load(const memory_list *list, const void *bytes, size_t size);

/* Continues an FNV-1a hash; begin with MEMORY_SUM_START. */
#define MEMORY_SUM_START UINT64_C(0xcbf29ce484222325)
uint64_t memory_sum(uint64_t sum, const void *bytes, size_t size);

/* Defines `resume`, the MRT_RESUME of a mapping. `list_of(self)` lists its saved variables. */
#define MEMORY_RESUME(list_of)                                                                     \
    static size_t resume_save(mrt_plugin *self, void *out, size_t capacity)                        \
    {                                                                                              \
        const memory_list list = list_of(self);                                                    \
        return memory_save(&list, out, capacity);                                                  \
    }                                                                                              \
    static mrt_result resume_load(mrt_plugin *self, const void *bytes, size_t size)                \
    {                                                                                              \
        const memory_list list = list_of(self);                                                    \
        return memory_load(&list, bytes, size) ? MRT_OK : MRT_ERR_FORMAT;                          \
    }                                                                                              \
    static const mrt_resume resume = {resume_save, resume_load}

/* ---- the clutch: engages and releases the hands and commits the shape, by the triggers and pedals
 * of mappings ---- */

/* The parameters in this order, after those of the placement; ids 20 to 28. */
enum {
    CLUTCH_START = 0, /* engage immediately, or wait for the trigger */
    CLUTCH_ENGAGE,
    CLUTCH_RELEASE,
    CLUTCH_COMMIT,
    CLUTCH_ENGAGE_PEDAL, /* 0: none */
    CLUTCH_RELEASE_PEDAL,
    CLUTCH_COMMIT_PEDAL,
    CLUTCH_ON_RELEASE, /* hold or spring back */
    CLUTCH_RELEASE_TIME,
    CLUTCH_COUNT
};
extern const char *const clutch_start_labels[];
extern const char *const clutch_pedal_labels[];
extern const char *const clutch_release_labels[];
/* CLUTCH_PARAMS with another initial value of "On release". */
/* clang-format off */
#define CLUTCH_PARAMS CLUTCH_PARAMS_WITH(0)
#define CLUTCH_PARAMS_WITH(on_release) \
    {20, MRT_PARAM_STEPPED, "Start", "Clutch", "", "When the hands first engage the face.", \
     0, 1, 0, clutch_start_labels}, \
    {21, MRT_PARAM_TRIGGER, "Engage", "Clutch", "", \
     "Engage the hands where they are now. The face does not jump.", 0, 1, 0, NULL}, \
    {22, MRT_PARAM_TRIGGER, "Release", "Clutch", "", "Release the face.", 0, 1, 0, NULL}, \
    {23, MRT_PARAM_TRIGGER, "Commit", "Clutch", "", \
     "Keep the current shape as the new base and engage again.", 0, 1, 0, NULL}, \
    {24, MRT_PARAM_STEPPED, "Engage pedal", "Clutch", "", "Pedal that engages.", \
     0, 4, 0, clutch_pedal_labels}, \
    {25, MRT_PARAM_STEPPED, "Release pedal", "Clutch", "", "Pedal that releases.", \
     0, 4, 0, clutch_pedal_labels}, \
    {26, MRT_PARAM_STEPPED, "Commit pedal", "Clutch", "", "Pedal that commits.", \
     0, 4, 0, clutch_pedal_labels}, \
    {27, MRT_PARAM_STEPPED, "On release", "Clutch", "", \
     "Hold: the face keeps its shape. Spring back: it eases back to its base.", \
     0, 1, on_release, clutch_release_labels}, \
    {28, 0, "Release time", "Clutch", "s", "Duration of springing back.", 0.02, 5, 0.25, NULL}
/* clang-format on */

typedef struct clutch {
    bool has_started;
    bool was_down[MRT_MAX_PEDALS];
} clutch;

/* For a memory_list. */
#define CLUTCH_MEMORY(clutch) MEMORY_BOOLS((clutch).has_started), MEMORY_BOOLS((clutch).was_down)

typedef struct clutch_events {
    bool engage, release, commit; /* requested in this frame */
} clutch_events;

void clutch_reset(clutch *self);
/* Returns the events of this frame. params: the clutch's part of the parameter values. */
clutch_events clutch_step(clutch *self, const mrt_frame *frame, const double *params);

bool clutch_springs_back(const double *params);
/* Returns the rate of springing back, 1/s: after the release time e^-3 = 5 % of the way are
 * left. */
float clutch_release_rate(const double *params);

/* ---- the pose of a hand, and the easing curves of mappings by joint angles: only + - * / and
 * sqrt, so the same bits everywhere ---- */

/* Labels of a stepped parameter. "Either" prefers the right hand if both are present. */
extern const char *const performing_hand_labels[];
#define PERFORMING_HAND_PARAM(id)                                                                  \
    {                                                                                              \
        id, MRT_PARAM_STEPPED, "Hand", "Hand", "", "Hand that performs.", 0, 2, 0,                 \
            performing_hand_labels                                                                 \
    }

/* Returns the hand that performs; NULL if it is not present or has an angle that is not finite. */
const mrt_hand *performing_hand(const mrt_frame *frame, double choice);

/* Returns the mean of the knuckles and middle joints of the four fingers, rad: 0 flat, about 1.5 a
 * fist. */
double finger_bend(const mrt_hand *hand);

/* Returns the share of the way covered in dt_s with the time constant time_s: 0 .. 1. */
double smoothing_share(double dt_s, double time_s);
/* Minimum jerk from 0 to 1; 0 before, 1 after. */
double minimum_jerk(double t);
/* x made no larger than most, smoothly, and nearly x while small. */
double soft_limit(double x, double most);
double clamp(double x, double low, double high);

#endif
