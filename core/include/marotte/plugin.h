/* marotte/plugin.h - the whole contract between marotte and its plugins.
 *
 * A plugin is a shared library exporting one symbol, `marotte_plugins`: a NULL-ended array of
 * types. A type is const data: what it is called, which parameters it has, which interfaces it
 * answers. A plugin includes this header and nothing else of marotte. C11; also valid C++17.
 *
 * THREADS  Each function is marked with where it runs:
 *            [main]  a thread that may wait, not always the same: the UI's, one that loads, one
 *                    that plays a take: may allocate, open files, take a few milliseconds;
 *            [input] a thread the host makes for one input: may block, until its deadline;
 *            [frame] the real-time thread: no allocation, lock, I/O, clock or unbounded loop;
 *            [output] a thread the host makes for one face output;
 *            [any]   all of these, even at the same time (host services only).
 *          Two calls into one instance never overlap, whatever their marks and threads, and each
 *          sees what the one before did: plugins need no lock, and keep nothing by thread.
 * UNITS    mm, rad, ns (int64_t) or s (double); right-handed: +x the subject's left, +y up,
 *          +z out of the face. Faces and pulls are in the face frame. Hands are in the hand frame:
 *          origin at the wrist, fingers along +z, back of the hand along +y, so a right thumb is
 *          at +x: the frame of a hand inside a puppet's head. A tracked wrist moves the hand in it.
 *          Where that hand stands in the face is the mapping's to say: its placement parameters.
 * MEMORY   An argument may be read until the call returns. What a type points to lives as long as
 *          the process (libraries are never unloaded). Nobody frees the other side's memory.
 * ERRORS   < 0: an error, already explained through host->log. > 0: news, not an error.
 * REPLAY   A mapping's output depends on its state and arguments alone: same take, same bits.
 * VERSION  A type of another abi is refused, and the log says so. Structs never change within an
 *          abi, nor behind an interface id: what is new gets a new id, "domain.name/revision". */
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
    MRT_TIMEOUT = 1, /* read: nothing before the deadline */
    MRT_END = 2,     /* read: the take is over */
    MRT_HOLD = 3,    /* process: nothing to say, keep the last offsets */
    MRT_ERR_MEMORY = -1,
    MRT_ERR_IO = -2,          /* device gone, file unreadable */
    MRT_ERR_FORMAT = -3,      /* bytes that make no sense */
    MRT_ERR_UNSUPPORTED = -4, /* this rig, this device, this request */
    MRT_ERR_ARGUMENT = -5     /* a value outside its range */
};

/* ---- host services: valid from create() until destroy() returns ---- */
enum { MRT_LOG_DEBUG, MRT_LOG_INFO, MRT_LOG_WARNING, MRT_LOG_ERROR };
typedef struct mrt_host {
    void *data;                                                                /* the host's own */
    void (*log)(const struct mrt_host *host, int32_t level, const char *text); /* [any] wait-free */
    int64_t (*now_ns)(const struct mrt_host *host); /* [main] [input] [output] monotonic */
    /* [input] Waits until the host's clock reaches time_ns; returns the time then. A host that
     * replays faster than life moves its clock instead of waiting: an input that paces itself with
     * this, and with nothing else, can be replayed at any speed. */
    int64_t (*wait_until_ns)(const struct mrt_host *host, int64_t time_ns);
    void (*request_restart)(const struct mrt_host *host); /* [any] stop and start me soon */
    /* [main] The functions of MRT_FOLDERS, MRT_LANDMARKS ..., until destroy() returns; NULL: this
     * host has none. */
    const void *(*service)(const struct mrt_host *host, const char *id);
} mrt_host;

/* ---- a service: folders that a plugin may write into; nothing else on the disk is its own ---- */
#define MRT_FOLDERS "marotte.folders/1"
typedef struct mrt_folders {
    /* [main] An absolute path, of all instances of this type and of nobody else. The folder is made
     * if need be. `out` is "" after an error, which is logged. */
    mrt_result (*settings)(const struct mrt_host *host, char *out,
                           size_t capacity);                                      /* to be kept */
    mrt_result (*cache)(const struct mrt_host *host, char *out, size_t capacity); /* may vanish */
} mrt_folders;

/* ---- parameters: the host owns the values; sliders, presets and takes follow from this ---- */
enum {
    MRT_PARAM_STEPPED = 1, /* whole numbers only */
    MRT_PARAM_TRIGGER = 2, /* a button, or a pedal bound to it: 1 for exactly one call */
    MRT_PARAM_HIDDEN = 4
};
typedef struct mrt_param {
    uint32_t id;    /* stable for ever, never reused: presets and takes store it */
    uint32_t flags; /* MRT_PARAM_* */
    const char *name, *group, *unit, *help; /* "Gain", "Smoothing/Thumb", "mm", one sentence */
    double min, max, initial;  /* finite, min < max, min <= initial <= max; a linear slider */
    const char *const *labels; /* stepped: a name per value from min up, NULL-ended; or NULL */
} mrt_param;

/* ---- the type, and the library's one symbol ---- */
typedef struct mrt_interface {
    const char *id;
    const void *functions;
} mrt_interface;
typedef struct mrt_plugin_type {
    uint32_t abi; /* MRT_ABI; stays first for ever */
    uint32_t param_count;
    const mrt_param *params;
    const mrt_interface *interfaces; /* MRT_INPUT, MRT_MAPPING, MRT_STATE ...; ends with id NULL */
    const char *id, *name, *version, *about;     /* id "org.marotte.anchored": stable for ever */
    mrt_plugin *(*create)(const mrt_host *host); /* [main] NULL: failed */
    void (*destroy)(mrt_plugin *self);           /* [main] closed or deactivated; NULL is fine */
} mrt_plugin_type;
extern MRT_EXPORT const mrt_plugin_type *const marotte_plugins[];

/* ---- input: named channels, sampled in time ---- */
#define MRT_INPUT "marotte.input/1"
enum { MRT_MAX_CHANNELS = 64, MRT_MAX_PEDALS = 4, MRT_ANGLES = 22, MRT_JOINTS = 21, MRT_PALM = 8 };
enum {
    /* Told apart by name, any number of them: a fader from 0 to 1, a stick from -1 to 1, a shape of
     * a tracked face. Where min < 0 < max it rests at 0, else at min. */
    MRT_CH_OTHER = 0,
    MRT_CH_ANGLE = 1,    /* + 0..21, in sensor order: thumb roll ... wrist yaw */
    MRT_CH_WRIST = 32,   /* + 0..6: position x y z in mm, orientation quaternion x y z w */
    MRT_CH_PEDAL = 64,   /* + 0..3 */
    MRT_CH_BUTTON = 72,  /* 0 up, 1 down; told apart by name */
    MRT_CH_TIMECODE = 80 /* + 0: frames of time code from 00:00:00:00 to the sample's time, counted
                            and not read off, parts of one too; + 1: how many a second, such as 25,
                            negative for drop-frame. 96 and above are the host's own */
};
enum { MRT_LEFT = 0, MRT_RIGHT = 1, MRT_NO_HAND = 2 };
#define MRT_UNIT_LANDMARKS "rad landmarks" /* noisier than a glove: the host filters it harder */
typedef struct mrt_channel {
    const char *name, *unit; /* "index MCP flexion"; of angles: "count" wants calibration, "rad" has
                                it, MRT_UNIT_LANDMARKS is rad that was read from landmarks */
    uint32_t semantic, hand; /* MRT_CH_* + n; MRT_LEFT, MRT_RIGHT or MRT_NO_HAND */
    float min, max;          /* of the raw value */
} mrt_channel;
typedef struct mrt_sample {
    int64_t time_ns;   /* host clock at which it was measured, as well as the device can tell: its
                          own clock mapped to the host's, else when the last byte arrived; never
                          before the last sample's, never in the future */
    uint32_t sequence; /* +1 each time; a gap says samples were lost */
    uint32_t count;    /* as channels() said */
    float value[MRT_MAX_CHANNELS]; /* raw, finite */
} mrt_sample;
enum {
    /* Samples come from a record and read() waits with host->wait_until_ns alone, so the host may
     * run it faster than life. Without it the input is a device and runs in real time. */
    MRT_INPUT_RECORDED = 1
};
typedef struct mrt_input {
    /* [main] "": the first found. When read() has failed with MRT_ERR_IO the host closes and opens
     * again, with the same address, until the device is back; then [input]. An instance that was
     * opened with "" finds the very device that it had, by where it is plugged in. Should
     * host->wait_until_ns return early, the host is stopping: give up. */
    mrt_result (*open)(mrt_plugin *self, const char *address, const double *params);
    const mrt_channel *(*channels)(mrt_plugin *self, uint32_t *out_count); /* [main] until close */
    /* An input with pedals that loses its device first gives a sample in which they are up. */
    mrt_result (*read)(mrt_plugin *self, const double *params, int64_t deadline_ns,
                       mrt_sample *out_sample); /* [input] waits, never past the deadline */
    void (*close)(mrt_plugin *self);            /* [main] [input] as open */
    uint32_t flags;                             /* MRT_INPUT_* */
} mrt_input;

/* ---- how long a recorded input plays, for whoever shows the progress ---- */
#define MRT_DURATION "marotte.duration/1"
typedef struct mrt_duration {
    /* [main] On an open instance: nanoseconds from its first sample to its last, with these
     * parameters; below 0: it does not end. */
    int64_t (*get_ns)(mrt_plugin *self, const double *params);
} mrt_duration;

/* ---- a service: landmarks of a hand, as cameras and headsets see them, back to its angles ---- */
#define MRT_LANDMARKS "marotte.landmarks/1"
typedef struct mrt_landmarks {
    /* In any right-handed frame and unit: wrist, then base, MCP, IP, tip of the thumb and MCP, PIP,
     * DIP, tip of index .. little finger: MediaPipe's order; OpenXR's without palm and metacarpals
     * of the fingers. */
    mrt_vec3 at[MRT_JOINTS];
    uint32_t doubtful; /* bit i: joint i is hidden or guessed: not used; as if not finite */
    uint32_t side;     /* MRT_LEFT, MRT_RIGHT */
} mrt_landmarks;
typedef struct mrt_hand_reading {
    float angle[MRT_ANGLES]; /* as channels of MRT_CH_ANGLE in MRT_UNIT_LANDMARKS; the wrist's two
                                are 0 */
    float wrist[7];          /* from the hand frame to the landmarks': position in their unit,
                                orientation as a quaternion x y z w */
    float size;              /* of the palm in their unit, over that of a hand of 190 mm */
    float confidence;        /* 0..1; below 0.5 it should move no face */
} mrt_hand_reading;
typedef struct mrt_landmark_reader {
    /* [main] [input] `reading` holds what was read last of this hand, or zeros: what cannot be told
     * now is kept. Any number of hands may be read at the same time. */
    void (*read)(const struct mrt_host *host, const mrt_landmarks *seen, mrt_hand_reading *reading);
} mrt_landmark_reader;

/* ---- devices: what an input could open, and what to do about what it cannot ---- */
#define MRT_DEVICES "marotte.devices/1"
enum {
    MRT_DEVICE_READY = 0,  /* open() would do */
    MRT_DEVICE_BUSY = 1,   /* another program holds it */
    MRT_DEVICE_DENIED = 2, /* this user may not open it */
    MRT_DEVICE_UNSURE = 3  /* a port at which it may be: only open() can tell */
};
typedef struct mrt_device {
    char address[192]; /* for open(): this very device, also after it was away: its port path */
    char name[64];     /* "VEC USB Footpedal" */
    char advice[384];  /* what the person can do, in one sentence; "" when ready */
    int32_t state;     /* MRT_DEVICE_* */
} mrt_device;
typedef struct mrt_devices {
    /* [main] Writes up to `capacity` devices that are plugged in; returns how many there are. On an
     * instance that need not be open. Looks, and disturbs nobody: sends nothing to a device. */
    uint32_t (*list)(mrt_plugin *self, mrt_device *out, uint32_t capacity);
    /* [main] [input] Which one is open; false: none. */
    bool (*current)(mrt_plugin *self, mrt_device *out);
} mrt_devices;

/* ---- output: what the inputs measure, passed on ---- */
#define MRT_OUTPUT "marotte.output/1"
typedef struct mrt_output {
    mrt_result (*open)(mrt_plugin *self, const char *address, const double *params); /* [main] */
    /* [one thread] Passes one sample of the input called `source` on. Never waits. */
    mrt_result (*write)(mrt_plugin *self, const char *source, const mrt_channel *channels,
                        const mrt_sample *sample);
    void (*close)(mrt_plugin *self); /* [main] */
} mrt_output;

/* ---- mapping: hands in, control vectors out ---- */
#define MRT_MAPPING "marotte.mapping/1"
enum { MRT_MAX_VECTORS = 64, MRT_MAX_DOFS = 32 };
typedef struct mrt_hand {
    bool present;               /* false: the rest is the last known, or zero */
    int64_t time_ns;            /* of the sample behind it; its age is frame.time_ns - this */
    float angle[MRT_ANGLES];    /* rad, calibrated and filtered, in sensor order */
    mrt_vec3 joint[MRT_JOINTS]; /* mm, hand frame; wrist, then thumb to little, 4 each, tip last */
    mrt_vec3 palm[MRT_PALM];    /* mm, hand frame; contact points of the palm */
} mrt_hand;
enum { MRT_MAX_INPUTS = 8 };
typedef struct mrt_channels {   /* one input, as its newest sample says */
    const char *name;           /* as the host calls it: "gamepad 2"; another input is another */
    const mrt_channel *channel; /* count of them */
    const float *value;         /* count of them, raw: neither calibrated nor filtered */
    int64_t time_ns;            /* of that sample */
    uint32_t count;
} mrt_channels;
typedef struct mrt_frame {
    int64_t time_ns;             /* of this frame: the time of the sample that caused it */
    double dt_s;                 /* since the last one; 0 on the first after reset, at most 0.1 */
    mrt_hand hand[2];            /* left, right */
    float pedal[MRT_MAX_PEDALS]; /* 0 up .. 1 down */
    bool near;                   /* an end point of the last pull lies within its radius of the
                                    shape; false if that pull did not ask (mrt_pull.gate) */
    const double *params;        /* values, in table order */
    const mrt_channels *inputs;  /* all that have given a sample, in the order of their first */
    uint32_t input_count;        /* at most MRT_MAX_INPUTS */
} mrt_frame;
typedef struct mrt_contact { /* a named place on the face that a mapping may pull */
    const char *name, *bone; /* "mouth.corner.l"; the bone that it rides on: "skull", "jaw" */
    mrt_vec3 rest, normal;   /* mm, face frame; unit, outward */
} mrt_contact;
typedef struct mrt_dof {     /* a degree of freedom of a bone that a mapping may drive */
    const char *name, *unit; /* "jaw.open", "rad" */
    float min, max;          /* 0 is the rest pose; the host clamps softly */
} mrt_dof;
typedef struct mrt_face { /* valid from activate until deactivate */
    const mrt_contact *contacts;
    const mrt_dof *dofs;
    uint32_t contact_count, dof_count;
    mrt_vec3 low, high; /* mm, bounds of the rest face */
} mrt_face;
typedef struct mrt_vector { /* one control vector */
    mrt_vec3 start, end;    /* mm, face frame */
    uint32_t contact; /* 1 + index of the contact that it pulls: end - start is its way with the
                         bones at rest, and it rides on the bones that dof drives;
                         0: a free point, which lands on its end whatever the bones do */
} mrt_vector;
enum {
    MRT_IDLE = 0,      /* the shape stays as it is; vectors move nothing (but see gate) */
    MRT_ANCHORED = 1,  /* the base shape, moved by end - start; starts stay while anchor stays */
    MRT_UNANCHORED = 2 /* the shape shown, moved on from start to end: every sample is an edit */
};
enum {                       /* how the field is solved, where it is not to be as the rig says */
       MRT_SOLVE_LINEAR = 1, /* with a linear polynomial: the whole of space follows */
       MRT_SOLVE_ONCE = 2    /* unanchored: each sample is one step, even where it folds */
};
typedef struct mrt_pull { /* what process() fills; on entry: what it held last */
    uint32_t mode;        /* MRT_IDLE, MRT_ANCHORED or MRT_UNANCHORED */
    uint32_t anchor;      /* changes when the starts of anchored vectors change */
    uint32_t commit;      /* changes when the shape shown is to become the new base shape */
    uint32_t gate;        /* 1: report mrt_frame.near; unanchored vectors move nothing while
                             no end point is within the radius of the shape */
    uint32_t count;       /* of vector[] in use */
    float radius_mm;      /* support radius of the field; 0: what the rig says */
    float leak_per_s;     /* unanchored: rate at which the shape eases back to the base shape;
                             0: never */
    uint32_t solve;       /* MRT_SOLVE_*; 0: as the rig says, in steps that do not fold */
    float stretch_most; /* > 1: no edge of the skin is stretched further and nothing folds: near it
                           less is given; 0: as the host says (8); below 0: all of it is given */
    mrt_vector vector[MRT_MAX_VECTORS];
    float dof[MRT_MAX_DOFS]; /* NaN: not driven; the host derives the jaw from the vectors */
} mrt_pull;
typedef struct mrt_mapping {
    mrt_result (*activate)(mrt_plugin *self, const mrt_face *face); /* [main] allocate now */
    void (*deactivate)(mrt_plugin *self);                           /* [main] */
    void (*reset)(mrt_plugin *self); /* [frame] forget the past: filters, anchors, clutch */
    mrt_result (*process)(mrt_plugin *self, const mrt_frame *frame, mrt_pull *pull); /* [frame] */
} mrt_mapping;

/* ---- the poses that a rig names ("viseme_PP", "joy"), and those of ARKit's and the visemes' names
 * that the head's own shapes make, for a mapping that performs them ---- */
#define MRT_RIG_POSES "marotte.rig_poses/1"
enum { MRT_POSE_WHOLE = 0, MRT_POSE_MOUTH = 1, MRT_POSE_UPPER = 2 };
typedef struct mrt_rig_pose {
    const char *name;
    const mrt_vec3 *pulls; /* mm, one per contact: end - start of its vector */
    const float *dofs;     /* one per degree of freedom, in its unit */
    uint32_t part;         /* MRT_POSE_*: a pose of one half leaves the other half at rest */
} mrt_rig_pose;
typedef struct mrt_rig_poses {
    /* [main] Called before each activate, with the poses of that face. The poses stay valid until
     * deactivate. A mesh without a rig has none. */
    void (*set)(mrt_plugin *self, const mrt_face *face, const mrt_rig_pose *poses, uint32_t count);
} mrt_rig_poses;

/* ---- the card of a mapping: what each part of the hand does, for a person who learns it ---- */
#define MRT_HAND_CARD "marotte.hand_card/1"
typedef struct mrt_card_line {
    const char *hand, *face;   /* "Thumb down", "jaw opens" */
    uint32_t joint;            /* of MRT_JOINTS: the place on the hand */
    float per_rad[MRT_ANGLES]; /* how much of it a change of each angle does; 1: all of it */
} mrt_card_line;
typedef struct mrt_hand_card {
    /* [any] The lines for a hand that this input measures; input NULL: any input. The lines live as
     * long as the process. */
    const mrt_card_line *(*lines)(const double *params, const mrt_channels *input, uint32_t side,
                                  uint32_t *out_count);
} mrt_hand_card;

/* ---- face output: the face itself, for other programs, while it is performed or played ---- */
#define MRT_FACE_OUTPUT "marotte.face_output/1"
typedef struct mrt_face_names { /* valid from begin until the next begin, or close */
    const mrt_face *face;       /* contacts, degrees of freedom, bounds */
    const char *const *bones;   /* "skull", "jaw", "eye.l" */
    const int32_t *parents;     /* of each bone: an index; -1: it rides on nothing */
    const mrt_vec3 *pivots;     /* of each bone, mm: what it turns about, at rest */
    const char *const *shapes;  /* the head's own morph targets, as its file calls them */
    /* What any face can be said in, whatever shapes it has: the 61 channels of Live Link Face in
     * its order, which are ARKit's 52 ("EyeBlinkLeft" first) and 9 turns ("HeadYaw"); then others,
     * told apart by name: VRM's expressions ("aa", "happy"), visemes. May be none. */
    const char *const *weights;
    uint32_t bone_count, shape_count, weight_count, vertex_count;
} mrt_face_names;
typedef struct mrt_bone_pose { /* from rest to now in the face frame: p becomes turn p + shift */
    float turn[4];             /* quaternion x y z w */
    mrt_vec3 shift;            /* mm */
} mrt_bone_pose;
typedef struct mrt_face_sample {
    int64_t time_ns;            /* host clock: when what moved the face was measured; of a take that
                                   plays: when this instant of it is due */
    int64_t take_ns;            /* of a take: from its start; below 0: no take plays */
    uint64_t number;            /* of the face: larger with each; the same: it is said once more */
    const mrt_bone_pose *bones; /* counts and order as in mrt_face_names */
    const float *dofs;          /* rad or mm, as posed: derived and limited ones too */
    const mrt_vec3 *contacts;   /* mm: how far each is from where it rests */
    const float *shapes;        /* 0..1 */
    const float *weights;     /* 0..1; of turns rad: to the face's left, up, to its left shoulder */
    const mrt_vec3 *vertices; /* mm, the mesh file's order; NULL: not asked for */
} mrt_face_sample;
typedef struct mrt_face_wants { /* what an output asks for; on entry: zeros */
    double rate_hz;             /* at most so many faces a second, the newest; 0: each sample's */
    double repeat_s;            /* a face that nothing moves is said again after so long; 0: 1 s */
    uint32_t vertices;          /* 1: vertices too */
} mrt_face_wants;
typedef struct mrt_face_output {
    /* [output] is a thread of its own, or the plugin's own process: it may take some milliseconds,
     * and makes no frame wait: a face that comes meanwhile replaces the one before it. After an
     * error of open or send the host closes, and opens again a second later. */
    mrt_result (*open)(mrt_plugin *self, const char *address, const double *params,
                       mrt_face_wants *wants); /* [output] "": the usual place */
    mrt_result (*begin)(mrt_plugin *self, const mrt_face_names *names); /* [output] and for each
                                                                           other face */
    /* [output] Also looks for what the other side has sent. MRT_OK: it was sent; MRT_TIMEOUT:
     * nobody is there who takes it. */
    mrt_result (*send)(mrt_plugin *self, const double *params, const mrt_face_sample *sample);
    void (*close)(mrt_plugin *self); /* [output] also when open has failed */
} mrt_face_output;

/* ---- state: what a person taught it and parameters cannot hold, such as poses or a calibration.
 * Kept with takes, shows and presets; reset() returns to what was loaded last ---- */
#define MRT_STATE "marotte.state/1"
typedef struct mrt_state {
    /* [frame] Writes at most `capacity` bytes (out may be NULL); returns the size it takes. */
    size_t (*save)(mrt_plugin *self, void *out, size_t capacity);
    /* [frame] All or none; what it refuses, it logs as an error: the person loses it. */
    mrt_result (*load)(mrt_plugin *self, const void *bytes, size_t size);
} mrt_state;

/* ---- taught poses: how the hand is held that a trigger stands for, so that it can be drawn ----
 */
#define MRT_TAUGHT_POSES "marotte.taught_poses/1"
typedef struct mrt_taught_poses {
    /* [main] Of its bytes alone, which save() of MRT_STATE wrote. param: the trigger's id. out_rad:
     * MRT_ANGLES, in sensor order. MRT_END: it teaches no pose; MRT_ERR_FORMAT: bytes that make no
     * sense. */
    mrt_result (*pose)(const void *bytes, size_t size, uint32_t param, float *out_rad);
} mrt_taught_poses;

/* ---- resume: all that process() depends on but its parameters, so that a take can be taken up at
 * any instant without performing it from its start ---- */
#define MRT_RESUME "marotte.resume/1"
typedef struct mrt_resume {
    /* [frame] Writes at most `capacity` bytes (out may be NULL); returns the size it takes. */
    size_t (*save)(mrt_plugin *self, void *out, size_t capacity);
    /* [frame] All or none. Afterwards, on the same face, the same frames give the same pulls, bit
     * for bit, as they did after save. Bytes from elsewhere, and damaged ones, are refused. */
    mrt_result (*load)(mrt_plugin *self, const void *bytes, size_t size);
} mrt_resume;

/* ---- the layout, on every machine with pointers of 64 bits: who changes it changes MRT_ABI ----
 */
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
