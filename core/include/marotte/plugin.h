/* marotte/plugin.h - the whole contract between marotte and its plugins.
 *
 * A plugin is a shared library that exports one symbol, `marotte_plugins`: an array of types, ended
 * by NULL. A type is constant data: its name, its parameters and its interfaces. A plugin includes
 * only this header of marotte. C11; also valid C++17.
 *
 * THREADS  Each function is marked with the thread that calls it:
 *            [main]  a thread that may wait; not always the same one. It may allocate, open files
 *                    and take a few milliseconds;
 *            [input] a thread that the host makes for one input: may block until its deadline;
 *            [frame] the real-time thread: no allocation, lock, I/O, clock or unbounded loop;
 *            [output] a thread that the host makes for one face output;
 *            [any]   all of these, even at the same time (host services only).
 *          Two calls into one instance never overlap, and each sees the effects of the previous
 *          one. So plugins need no locks, and must not use thread-local data.
 * UNITS    mm, rad, ns (int64_t) or s (double); right-handed: +x the subject's left, +y up,
 *          +z out of the face. Faces and pulls are in the face frame. Hands are in the hand frame:
 *          origin at the wrist, +z along the fingers, +y out of the back of the hand, so a right
 *          thumb is at +x: the frame of a hand inside the head of a puppet. A tracked wrist moves
 *          the hand in it. The placement parameters of a mapping place the hand in the face.
 * MEMORY   Arguments may be read until the call returns. What a type points to must live as long as
 *          the process (libraries are never unloaded). Neither side frees memory of the other.
 * ERRORS   < 0: an error, already explained through host->log. > 0: not an error.
 * REPLAY   The output of a mapping depends only on its state and arguments: same take, same bits.
 * VERSION  The host refuses a type with another abi, and logs it. Structs never change within an
 *          abi or an interface id. New structs get a new id, "domain.name/revision". */
#ifndef MAROTTE_PLUGIN_H
#define MAROTTE_PLUGIN_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#ifdef _WIN32
#define MRT_EXPORT __declspec(dllexport)
#else
#define MRT_EXPORT __attribute__((visibility("default")))
#endif
#ifdef __cplusplus
extern "C" {
#endif

#define MRT_ABI 1u

typedef struct mrt_plugin mrt_plugin; /* one instance: the plugin defines this struct */
typedef struct mrt_vec3 {
    float x, y, z;
} mrt_vec3;

typedef int32_t mrt_result;
enum {
    MRT_OK = 0,
    MRT_TIMEOUT = 1, /* read: no sample before the deadline */
    MRT_END = 2,     /* read: the take is over */
    MRT_HOLD = 3,    /* process: keep the last pull */
    MRT_ERR_MEMORY = -1,
    MRT_ERR_IO = -2,          /* device gone, file unreadable */
    MRT_ERR_FORMAT = -3,      /* invalid data */
    MRT_ERR_UNSUPPORTED = -4, /* this rig, this device, this request */
    MRT_ERR_ARGUMENT = -5     /* a value outside its range */
};

/* ---- host services: valid from create() until destroy() returns ---- */
enum { MRT_LOG_DEBUG, MRT_LOG_INFO, MRT_LOG_WARNING, MRT_LOG_ERROR };
typedef struct mrt_host {
    void *data; /* for the host only */
    void (*log)(const struct mrt_host *host, int32_t level, const char *text); /* [any] wait-free */
    int64_t (*now_ns)(const struct mrt_host *host); /* [main] [input] [output] monotonic */
    /* [input] Waits until the clock of the host reaches time_ns, and returns the time. A host that
     * replays faster than real time moves its clock instead of waiting. So an input that waits only
     * with this function can be replayed at any speed. */
    int64_t (*wait_until_ns)(const struct mrt_host *host, int64_t time_ns);
    void (*request_restart)(
        const struct mrt_host *host); /* [any] asks the host to close and reopen this instance */
    /* [main] Returns the functions of a service such as MRT_FOLDERS or MRT_LANDMARKS, valid until
     * destroy() returns. NULL: the host does not have it. */
    const void *(*service)(const struct mrt_host *host, const char *id);
} mrt_host;

/* ---- service: the folders that a plugin may write to. It must not write anywhere else ---- */
#define MRT_FOLDERS "marotte.folders/1"
typedef struct mrt_folders {
    /* [main] Writes an absolute path to `out`. All instances of this type share the folder. The
     * host creates it. After an error, which the host logs, `out` is "". */
    mrt_result (*settings)(const struct mrt_host *host, char *out,
                           size_t capacity); /* kept permanently */
    mrt_result (*cache)(const struct mrt_host *host, char *out,
                        size_t capacity); /* may be deleted at any time */
} mrt_folders;

/* ---- parameters: the host owns the values. Sliders, presets and takes use them ---- */
enum {
    MRT_PARAM_STEPPED = 1, /* whole numbers only */
    MRT_PARAM_TRIGGER = 2, /* a button, or a pedal connected to it: 1 during exactly one call */
    MRT_PARAM_HIDDEN = 4,
    /* With MRT_PARAM_STEPPED, of a mapping: chooses one of the poses of MRT_RIG_POSES. Values 0:
     * none, to MRT_POSE_VALUES. The host shows the names of the poses. */
    MRT_PARAM_POSE = 8
};
#define MRT_POSE_VALUES 4294967295.0
/* Returns the parameter value of the pose with that name: never 0, and the same on every face. */
static inline uint32_t mrt_pose_value(const char *name)
{
    uint32_t value = UINT32_C(2166136261); /* FNV-1a */
    for (; *name; ++name)
        value = (value ^ (unsigned char)*name) * UINT32_C(16777619);
    return value ? value : 1;
}
typedef struct mrt_param {
    uint32_t id;    /* never changes and is never reused: presets and takes store it */
    uint32_t flags; /* MRT_PARAM_* */
    const char *name, *group, *unit, *help; /* "Gain", "Smoothing/Thumb", "mm", one sentence */
    double min, max, initial; /* finite, min < max, min <= initial <= max; a linear slider */
    const char *const
        *labels; /* stepped: a name for each value, from min, ended by NULL; or NULL */
} mrt_param;

/* ---- the type, and the library's one symbol ---- */
typedef struct mrt_interface {
    const char *id;
    const void *functions;
} mrt_interface;
typedef struct mrt_plugin_type {
    uint32_t abi; /* MRT_ABI; always the first field */
    uint32_t param_count;
    const mrt_param *params;
    const mrt_interface *interfaces; /* MRT_INPUT, MRT_MAPPING, MRT_STATE ...; ends with id NULL */
    const char *id, *name, *version, *about;     /* id "org.marotte.anchored": never changes */
    mrt_plugin *(*create)(const mrt_host *host); /* [main] NULL: failed */
    void (*destroy)(
        mrt_plugin *self); /* [main] the instance is closed or deactivated; accepts NULL */
} mrt_plugin_type;
extern MRT_EXPORT const mrt_plugin_type *const marotte_plugins[];

/* ---- input: named channels, sampled in time ---- */
#define MRT_INPUT "marotte.input/1"
enum { MRT_MAX_CHANNELS = 64, MRT_MAX_PEDALS = 4, MRT_ANGLES = 22, MRT_JOINTS = 21, MRT_PALM = 8 };
enum {
    /* Any number of channels, identified by name: a fader from 0 to 1, a stick from -1 to 1, a
       shape of a tracked face. The neutral value is 0 where min < 0 < max, otherwise min. */
    MRT_CH_OTHER = 0,
    MRT_CH_ANGLE = 1,    /* + 0..21, in sensor order: thumb roll ... wrist yaw */
    MRT_CH_WRIST = 32,   /* + 0..6: position x y z in mm, orientation quaternion x y z w */
    MRT_CH_PEDAL = 64,   /* + 0..3 */
    MRT_CH_BUTTON = 72,  /* 0 up, 1 down; identified by name */
    MRT_CH_TIMECODE = 80 /* + 0: number of frames from 00:00:00:00 to the time of the sample, with
                            fractions (a count, not the displayed numbers); + 1: frames per second,
                            negative for drop-frame. The host uses 96 and above */
};
enum { MRT_LEFT = 0, MRT_RIGHT = 1, MRT_NO_HAND = 2 };
#define MRT_UNIT_LANDMARKS "rad landmarks" /* noisier than a glove, so the host filters it more */
typedef struct mrt_channel {
    const char *name, *unit; /* "index MCP flexion". Unit of an angle: "count" needs calibration,
                                "rad" does not, MRT_UNIT_LANDMARKS is rad computed from landmarks */
    uint32_t semantic, hand; /* MRT_CH_* + n; MRT_LEFT, MRT_RIGHT or MRT_NO_HAND */
    float min, max;          /* of the raw value */
} mrt_channel;
typedef struct mrt_sample {
    int64_t time_ns;   /* host clock when it was measured: the clock of the device mapped to the
                          host's, or else the arrival of the last byte; never before the previous
                          sample, never in the future */
    uint32_t sequence; /* +1 for each sample; a gap means that samples were lost */
    uint32_t count;    /* number of values, as in channels() */
    float value[MRT_MAX_CHANNELS]; /* raw, finite */
} mrt_sample;
enum {
    /* Samples come from a recording, and read() waits only with host->wait_until_ns, so the host
       may run it faster than real time. Without this flag the input is a device. */
    MRT_INPUT_RECORDED = 1,
    MRT_INPUT_FILES = 2 /* MRT_INPUT_RECORDED applies while the address is that of a regular file */
};
typedef struct mrt_input {
    /* [main] Opens the device at `address`; "" is the first device found. After read() returned
     * MRT_ERR_IO, the host closes the instance and opens it again [input] with the same address
     * until it succeeds. An instance opened with "" must then find the same device, at the same
     * port. If host->wait_until_ns returns early, the host is stopping: return. */
    mrt_result (*open)(mrt_plugin *self, const char *address, const double *params);
    const mrt_channel *(*channels)(mrt_plugin *self, uint32_t *out_count); /* [main] until close */
    /* When an input with pedals loses its device, it first returns a sample with all pedals up. */
    mrt_result (*read)(mrt_plugin *self, const double *params, int64_t deadline_ns,
                       mrt_sample *out_sample); /* [input] blocks until the deadline at most */
    void (*close)(mrt_plugin *self);            /* [main] [input] as for open */
    uint32_t flags;                             /* MRT_INPUT_* */
} mrt_input;

/* ---- duration of a recorded input, to show progress ---- */
#define MRT_DURATION "marotte.duration/1"
typedef struct mrt_duration {
    /* [main] Returns the ns from the first to the last sample of an open instance, with these
     * parameters; below 0: endless. */
    int64_t (*get_ns)(mrt_plugin *self, const double *params);
} mrt_duration;

/* ---- service: converts landmarks of a hand, from a camera or a headset, to joint angles ---- */
#define MRT_LANDMARKS "marotte.landmarks/1"
typedef struct mrt_landmarks {
    /* In any right-handed frame and any unit. Order: wrist; base, MCP, IP and tip of the thumb;
     * MCP, PIP, DIP and tip of index to little finger. This is the order of MediaPipe, and of
     * OpenXR without the palm and the metacarpals of the fingers. */
    mrt_vec3 at[MRT_JOINTS];
    uint32_t doubtful; /* bit i: joint i is hidden or guessed, and is ignored like a value that is
                          not finite */
    uint32_t side;     /* MRT_LEFT, MRT_RIGHT */
} mrt_landmarks;
typedef struct mrt_hand_reading {
    float angle[MRT_ANGLES]; /* channels of MRT_CH_ANGLE in MRT_UNIT_LANDMARKS; the two of the wrist
                                are 0 */
    float wrist[7];   /* from the hand frame to the frame of the landmarks: position in their unit,
                         orientation quaternion x y z w */
    float size;       /* length of the palm in their unit, divided by that of a hand of 190 mm */
    float confidence; /* 0..1; do not perform with a hand below 0.5 */
} mrt_hand_reading;
typedef struct mrt_landmark_reader {
    /* [main] [input] `reading` contains the previous reading of this hand, or zeros. Values that
     * cannot be measured now are left unchanged. Several hands may be read at the same time. */
    void (*read)(const struct mrt_host *host, const mrt_landmarks *seen, mrt_hand_reading *reading);
} mrt_landmark_reader;

/* ---- devices that an input can open, and advice for those that it cannot ---- */
#define MRT_DEVICES "marotte.devices/1"
enum {
    MRT_DEVICE_READY = 0,  /* open() would succeed */
    MRT_DEVICE_BUSY = 1,   /* in use by another program */
    MRT_DEVICE_DENIED = 2, /* this user has no permission */
    MRT_DEVICE_UNSURE = 3  /* a port that may have the device: only open() can find out */
};
typedef struct mrt_device {
    char address[192]; /* for open(): identifies this device by its port, also after it was
                          disconnected */
    char name[64];     /* "VEC USB Footpedal" */
    char advice[384];  /* one sentence: what the user can do; "" when ready */
    int32_t state;     /* MRT_DEVICE_* */
} mrt_device;
typedef struct mrt_devices {
    /* [main] Writes at most `capacity` connected devices, and returns their total number. The
     * instance need not be open. It must not send anything to a device. */
    uint32_t (*list)(mrt_plugin *self, mrt_device *out, uint32_t capacity);
    /* [main] [input] Writes the open device; false: none. */
    bool (*current)(mrt_plugin *self, mrt_device *out);
} mrt_devices;

/* ---- output: passes samples of inputs on ---- */
#define MRT_OUTPUT "marotte.output/1"
typedef struct mrt_output {
    mrt_result (*open)(mrt_plugin *self, const char *address, const double *params); /* [main] */
    /* [one thread] Passes on one sample of the input named `source`. Must not block. */
    mrt_result (*write)(mrt_plugin *self, const char *source, const mrt_channel *channels,
                        const mrt_sample *sample);
    void (*close)(mrt_plugin *self); /* [main] */
} mrt_output;

/* ---- mapping: hands in, control vectors out ---- */
#define MRT_MAPPING "marotte.mapping/1"
enum { MRT_MAX_VECTORS = 64, MRT_MAX_DOFS = 32 };
typedef struct mrt_hand {
    bool present;    /* false: the other fields are the last known ones, or zero */
    int64_t time_ns; /* time of its sample; the age of the hand is frame.time_ns - time_ns */
    float angle[MRT_ANGLES];    /* rad, calibrated and filtered, in sensor order */
    mrt_vec3 joint[MRT_JOINTS]; /* mm, hand frame; wrist, then thumb to little, 4 each, tip last */
    mrt_vec3 palm[MRT_PALM];    /* mm, hand frame; contact points of the palm */
} mrt_hand;
enum { MRT_MAX_INPUTS = 8 };
typedef struct mrt_channels {   /* the newest sample of one input */
    const char *name;           /* name that the host gives it, unique: "gamepad 2" */
    const mrt_channel *channel; /* count of them */
    const float *value;         /* count of them, raw: neither calibrated nor filtered */
    int64_t time_ns;            /* of that sample */
    uint32_t count;
} mrt_channels;
typedef struct mrt_frame {
    int64_t time_ns;  /* of this frame: the time of the sample that caused it */
    double dt_s;      /* since the previous frame; 0 in the first one after reset; at most 0.1 */
    mrt_hand hand[2]; /* left, right */
    float pedal[MRT_MAX_PEDALS]; /* 0 up .. 1 down */
    bool near; /* an end point of the last pull is within its radius of the shape; false if
                  mrt_pull.gate was 0 */
    const double *params; /* values, in table order */
    const mrt_channels
        *inputs; /* all inputs that have delivered a sample, in the order of their first ones */
    uint32_t input_count; /* at most MRT_MAX_INPUTS */
} mrt_frame;
typedef struct mrt_contact { /* a named point of the face that a mapping may pull */
    const char *name, *bone; /* "mouth.corner.l"; the bone that carries it: "skull", "jaw" */
    mrt_vec3 rest, normal;   /* mm, face frame; unit, outward */
} mrt_contact;
typedef struct mrt_dof {     /* one way in which a bone can move */
    const char *name, *unit; /* "jaw.open", "rad" */
    float min, max;          /* 0 is the neutral pose; the host limits it softly */
} mrt_dof;
typedef struct mrt_face { /* valid from activate until deactivate */
    const mrt_contact *contacts;
    const mrt_dof *dofs;
    uint32_t contact_count, dof_count;
    mrt_vec3 low, high; /* mm, bounds of the neutral face */
} mrt_face;
typedef struct mrt_vector { /* one control vector */
    mrt_vec3 start, end;    /* mm, face frame */
    uint32_t contact; /* 1 + index of the contact that it pulls: end - start is its displacement
                         while the bones are neutral, and the motion of the bones is added. 0: a
                         free point, whose final position is `end` whatever the bones do */
} mrt_vector;
enum {
    MRT_IDLE = 0,      /* the shape does not change; vectors are ignored (but see gate) */
    MRT_ANCHORED = 1,  /* moves the base shape by end - start; the starts must not change while
                          `anchor` does not */
    MRT_UNANCHORED = 2 /* moves the current shape from start to end: every sample is an edit */
};
enum {                       /* how the field is solved, to override the rig */
       MRT_SOLVE_LINEAR = 1, /* with a linear polynomial: all of space follows */
       MRT_SOLVE_ONCE = 2    /* unanchored: one step for each sample, even if it folds */
};
typedef struct mrt_pull { /* written by process(); on entry it contains the last pull */
    uint32_t mode;        /* MRT_IDLE, MRT_ANCHORED or MRT_UNANCHORED */
    uint32_t anchor;      /* changed by the mapping when the starts of anchored vectors change */
    uint32_t commit; /* changed by the mapping when the current shape must become the base shape */
    uint32_t gate; /* 1: report mrt_frame.near; unanchored vectors have no effect while no end point
                      is within the radius of the shape */
    uint32_t count;     /* number of entries of vector[] */
    float radius_mm;    /* support radius of the field; 0: from the rig */
    float leak_per_s;   /* unanchored: rate at which the shape eases back to the base shape;
                           0: never */
    uint32_t solve;     /* MRT_SOLVE_*; 0: from the rig, in steps that do not fold */
    float stretch_most; /* > 1: largest stretch of an edge of the skin. The host reduces the pull
                           before an edge stretches further or a triangle folds. 0: the default (8).
                           Below 0: no limit */
    mrt_vector vector[MRT_MAX_VECTORS];
    float dof[MRT_MAX_DOFS]; /* NaN: not driven; the host then derives the jaw from the vectors */
} mrt_pull;
typedef struct mrt_mapping {
    mrt_result (*activate)(mrt_plugin *self,
                           const mrt_face *face); /* [main] allocates what process() needs */
    void (*deactivate)(mrt_plugin *self);         /* [main] */
    void (*reset)(mrt_plugin *self);              /* [frame] clears filters, anchors and clutch */
    mrt_result (*process)(mrt_plugin *self, const mrt_frame *frame, mrt_pull *pull); /* [frame] */
} mrt_mapping;

/* ---- poses of the rig ("viseme_PP", "joy"), and poses with the names of ARKit and of visemes that
 * the shapes of the head make, for a mapping that performs them ---- */
#define MRT_RIG_POSES "marotte.rig_poses/1"
enum { MRT_POSE_WHOLE = 0, MRT_POSE_MOUTH = 1, MRT_POSE_UPPER = 2 };
typedef struct mrt_rig_pose {
    const char *name;
    const mrt_vec3 *pulls; /* mm, one per contact: end - start of its vector */
    const float *dofs;     /* one per degree of freedom, in its unit */
    uint32_t part;         /* MRT_POSE_*: a pose of one half leaves the other half neutral */
} mrt_rig_pose;
typedef struct mrt_rig_poses {
    /* [main] Called before each activate, with the poses of that face. The poses stay valid until
     * deactivate. A mesh without a rig has none. */
    void (*set)(mrt_plugin *self, const mrt_face *face, const mrt_rig_pose *poses, uint32_t count);
} mrt_rig_poses;

/* ---- hand card: describes what each part of the hand does, for users who learn a mapping ---- */
#define MRT_HAND_CARD "marotte.hand_card/1"
typedef struct mrt_card_line {
    const char *hand, *face;   /* "Thumb down", "jaw opens" */
    uint32_t joint;            /* index below MRT_JOINTS: the joint that the line points to */
    float per_rad[MRT_ANGLES]; /* share of the effect for a change of 1 rad of each angle; 1: all of
                                  it */
} mrt_card_line;
typedef struct mrt_hand_card {
    /* [any] Returns the lines for a hand measured by this input; NULL: any input. They are valid as
     * long as the process. */
    const mrt_card_line *(*lines)(const double *params, const mrt_channels *input, uint32_t side,
                                  uint32_t *out_count);
} mrt_hand_card;

/* ---- face output: sends the face to other programs while it is performed or played ---- */
#define MRT_FACE_OUTPUT "marotte.face_output/1"
typedef struct mrt_face_names { /* valid from begin until the next begin, or close */
    const mrt_face *face;       /* contacts, degrees of freedom, bounds */
    const char *const *bones;   /* "skull", "jaw", "eye.l" */
    const int32_t *parents;     /* index of the parent of each bone; -1: none */
    const mrt_vec3 *pivots;     /* mm, neutral: the centre of rotation of each bone */
    const char *const *shapes;  /* names of the morph targets in the file of the head */
    /* Weights that describe any face: the 61 channels of Live Link Face in their order (ARKit's 52
     * shapes, "EyeBlinkLeft" first, and 9 rotations such as "HeadYaw"), then others by name:
     * expressions of VRM ("aa", "happy") and visemes. May be empty. */
    const char *const *weights;
    uint32_t bone_count, shape_count, weight_count, vertex_count;
} mrt_face_names;
typedef struct mrt_bone_pose { /* from neutral to now, in the face frame: p becomes turn p + shift
                                */
    float turn[4];             /* quaternion x y z w */
    mrt_vec3 shift;            /* mm */
} mrt_bone_pose;
typedef struct mrt_face_sample {
    int64_t time_ns; /* host clock when the sample behind the face was measured; while a take plays:
                        when this time of the take is due */
    int64_t take_ns; /* time from the start of the take; below 0: no take plays */
    uint64_t number; /* increases with each new face; unchanged: the same face is repeated */
    const mrt_bone_pose *bones; /* counts and order as in mrt_face_names */
    const float *dofs;          /* rad or mm, as applied, including derived and limited ones */
    const mrt_vec3 *contacts;   /* mm: displacement of each contact from neutral */
    const float *shapes;        /* 0..1 */
    const float *weights; /* 0..1; rotations in rad: to the left of the face, up, towards its left
                             shoulder */
    const mrt_vec3 *vertices; /* mm, in the order of the mesh file; NULL: not requested */
} mrt_face_sample;
typedef struct mrt_face_wants { /* what an output requests; zeros on entry */
    double rate_hz;             /* largest number of faces per second; 0: one for each sample */
    double repeat_s;            /* interval after which an unchanged face is repeated; 0: 1 s */
    uint32_t vertices;          /* 1: send the vertices too */
} mrt_face_wants;
typedef struct mrt_face_output {
    /* [output] is a separate thread or process. It may take some milliseconds and does not delay
     * frames: a newer face replaces the waiting one. After an error of open or send, the host
     * closes the instance and opens it again after a second. */
    mrt_result (*open)(mrt_plugin *self, const char *address, const double *params,
                       mrt_face_wants *wants); /* [output] "": the default address */
    mrt_result (*begin)(mrt_plugin *self,
                        const mrt_face_names *names); /* [output] again for each other face */
    /* [output] Sends a face, and reads what the receiver has sent. MRT_OK: sent; MRT_TIMEOUT: no
     * receiver. */
    mrt_result (*send)(mrt_plugin *self, const double *params, const mrt_face_sample *sample);
    void (*close)(mrt_plugin *self); /* [output] called also after open failed */
} mrt_face_output;

/* ---- state: learned data that parameters cannot hold, such as poses or a calibration. It is saved
 * with takes, shows and presets. reset() returns to the state that was loaded last ---- */
#define MRT_STATE "marotte.state/1"
typedef struct mrt_state {
    /* [frame] Writes at most `capacity` bytes (out may be NULL), and returns the needed size. */
    size_t (*save)(mrt_plugin *self, void *out, size_t capacity);
    /* [frame] Loads everything or nothing. It logs an error if it refuses the bytes, because the
     * user loses them. */
    mrt_result (*load)(mrt_plugin *self, const void *bytes, size_t size);
} mrt_state;

/* ---- taught poses: the hand pose that a trigger parameter stands for, to draw it ---- */
#define MRT_TAUGHT_POSES "marotte.taught_poses/1"
typedef struct mrt_taught_poses {
    /* [main] Reads the pose from bytes that save() of MRT_STATE wrote. param: id of the trigger.
     * out_rad: MRT_ANGLES values in sensor order. MRT_END: no pose was taught; MRT_ERR_FORMAT:
     * invalid bytes. */
    mrt_result (*pose)(const void *bytes, size_t size, uint32_t param, float *out_rad);
} mrt_taught_poses;

/* ---- resume: all that process() depends on except parameters, so that a take can continue from
 * any time without performing it from its start ---- */
#define MRT_RESUME "marotte.resume/1"
typedef struct mrt_resume {
    /* [frame] Writes at most `capacity` bytes (out may be NULL), and returns the needed size. */
    size_t (*save)(mrt_plugin *self, void *out, size_t capacity);
    /* [frame] Loads everything or nothing. On the same face, the same frames then give the same
     * pulls as after save, bit for bit. It refuses foreign and damaged bytes. */
    mrt_result (*load)(mrt_plugin *self, const void *bytes, size_t size);
} mrt_resume;

/* ---- layout on machines with 64-bit pointers: if you change it, change MRT_ABI ---- */
#if UINTPTR_MAX == UINT64_MAX
#ifdef __cplusplus
#define MRT_LAYOUT(type, size, last, offset)                                                       \
    static_assert(sizeof(type) == size && offsetof(type, last) == offset, #type)
#else
#define MRT_LAYOUT(type, size, last, offset)                                                       \
    _Static_assert(sizeof(type) == size && offsetof(type, last) == offset, #type)
#endif
MRT_LAYOUT(mrt_vec3, 12, z, 8);
MRT_LAYOUT(mrt_host, 48, service, 40);
MRT_LAYOUT(mrt_folders, 16, cache, 8);
MRT_LAYOUT(mrt_landmarks, 260, side, 256);
MRT_LAYOUT(mrt_hand_reading, 124, confidence, 120);
MRT_LAYOUT(mrt_landmark_reader, 8, read, 0);
MRT_LAYOUT(mrt_param, 72, labels, 64);
MRT_LAYOUT(mrt_interface, 16, functions, 8);
MRT_LAYOUT(mrt_plugin_type, 72, destroy, 64);
MRT_LAYOUT(mrt_channel, 32, max, 28);
MRT_LAYOUT(mrt_sample, 272, value, 16);
MRT_LAYOUT(mrt_input, 40, flags, 32);
MRT_LAYOUT(mrt_duration, 8, get_ns, 0);
MRT_LAYOUT(mrt_device, 644, state, 640);
MRT_LAYOUT(mrt_devices, 16, current, 8);
MRT_LAYOUT(mrt_output, 24, close, 16);
MRT_LAYOUT(mrt_hand, 456, palm, 356);
MRT_LAYOUT(mrt_channels, 40, count, 32);
MRT_LAYOUT(mrt_frame, 976, input_count, 968);
MRT_LAYOUT(mrt_contact, 40, normal, 28);
MRT_LAYOUT(mrt_dof, 24, max, 20);
MRT_LAYOUT(mrt_face, 48, high, 36);
MRT_LAYOUT(mrt_vector, 28, contact, 24);
MRT_LAYOUT(mrt_pull, 1956, dof, 1828);
MRT_LAYOUT(mrt_mapping, 32, process, 24);
MRT_LAYOUT(mrt_rig_pose, 32, part, 24);
MRT_LAYOUT(mrt_rig_poses, 8, set, 0);
MRT_LAYOUT(mrt_card_line, 112, per_rad, 20);
MRT_LAYOUT(mrt_hand_card, 8, lines, 0);
MRT_LAYOUT(mrt_face_names, 64, vertex_count, 60);
MRT_LAYOUT(mrt_bone_pose, 28, shift, 16);
MRT_LAYOUT(mrt_face_sample, 72, vertices, 64);
MRT_LAYOUT(mrt_face_wants, 24, vertices, 16);
MRT_LAYOUT(mrt_face_output, 32, close, 24);
MRT_LAYOUT(mrt_state, 16, load, 8);
MRT_LAYOUT(mrt_taught_poses, 8, pose, 0);
MRT_LAYOUT(mrt_resume, 16, load, 8);
#undef MRT_LAYOUT
#endif

#ifdef __cplusplus
}
#endif
#endif
