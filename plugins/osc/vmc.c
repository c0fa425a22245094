/* vmc.c - the plugin "org.marotte.vmc": the face over the VMC protocol (protocol.vmc.info), for
 * avatars and other receivers. As an assistant it sends head, eyes and blend shapes to a performer,
 * which has the body. As a performer it sends a whole person who stands still, directly to a
 * marionette. Unity's axes: left-handed, y up, the face looks to +z. */
#include "osc_wire.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ASSISTANT_PORT = 39540, PERFORMER_PORT = 39539, ARKIT = 52, ARKIT_AND_TURNS = 61 };
enum { ROLE, NAMES, CASE, OWN, JAW, RATE, PARAM_COUNT };
enum { NAMES_ALL, NAMES_ARKIT, NAMES_PRESETS };
enum { CASE_PASCAL, CASE_CAMEL };
enum { NO_BONE = 64, NAME_BYTES = 80 };

/* Unity's HumanBodyBones. */
static const char *const body_bone[] = {
    "Hips",
    "LeftUpperLeg",
    "RightUpperLeg",
    "LeftLowerLeg",
    "RightLowerLeg",
    "LeftFoot",
    "RightFoot",
    "Spine",
    "Chest",
    "UpperChest",
    "Neck",
    "Head",
    "LeftShoulder",
    "RightShoulder",
    "LeftUpperArm",
    "RightUpperArm",
    "LeftLowerArm",
    "RightLowerArm",
    "LeftHand",
    "RightHand",
    "LeftToes",
    "RightToes",
    "LeftEye",
    "RightEye",
    "Jaw",
    "LeftThumbProximal",
    "LeftThumbIntermediate",
    "LeftThumbDistal",
    "LeftIndexProximal",
    "LeftIndexIntermediate",
    "LeftIndexDistal",
    "LeftMiddleProximal",
    "LeftMiddleIntermediate",
    "LeftMiddleDistal",
    "LeftRingProximal",
    "LeftRingIntermediate",
    "LeftRingDistal",
    "LeftLittleProximal",
    "LeftLittleIntermediate",
    "LeftLittleDistal",
    "RightThumbProximal",
    "RightThumbIntermediate",
    "RightThumbDistal",
    "RightIndexProximal",
    "RightIndexIntermediate",
    "RightIndexDistal",
    "RightMiddleProximal",
    "RightMiddleIntermediate",
    "RightMiddleDistal",
    "RightRingProximal",
    "RightRingIntermediate",
    "RightRingDistal",
    "RightLittleProximal",
    "RightLittleIntermediate",
    "RightLittleDistal",
};
enum { BODY_BONES = sizeof body_bone / sizeof *body_bone };

/* VMC bones of the face's bones. With several names, the first one that the face has. */
static const struct {
    const char *vmc, *face[3];
} head_bone[] = {{"Neck", {"neck", NULL}},
                 {"Head", {"head", "skull", NULL}},
                 {"LeftEye", {"eye.l", "eye_l", NULL}},
                 {"RightEye", {"eye.r", "eye_r", NULL}},
                 {"Jaw", {"jaw", NULL}}};
enum { HEAD_BONES = sizeof head_bone / sizeof *head_bone, JAW_BONE = HEAD_BONES - 1 };

/* Expressions of VRM 1.0 with their preset names in VRM 0. */
static const char *const preset_name[][2] = {{"aa", "A"},
                                             {"ih", "I"},
                                             {"ou", "U"},
                                             {"ee", "E"},
                                             {"oh", "O"},
                                             {"blink", "Blink"},
                                             {"blinkLeft", "Blink_L"},
                                             {"blinkRight", "Blink_R"},
                                             {"happy", "Joy"},
                                             {"angry", "Angry"},
                                             {"sad", "Sorrow"},
                                             {"relaxed", "Fun"},
                                             {"surprised", "Surprised"}};
enum { PRESETS = sizeof preset_name / sizeof *preset_name };

struct mrt_plugin {
    const mrt_host *host;
    osc_sender sender;
    const mrt_face_names *names;
    uint32_t bone[HEAD_BONES]; /* index in the face, or NO_BONE */
    uint32_t preset[PRESETS];  /* index of the weight; UINT32_MAX: none */
    int64_t begun_ns;          /* time 0 of the sent times; live */
};

static mrt_plugin *create(const mrt_host *host)
{
    mrt_plugin *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->host = host;
    udp_sender_init(&self->sender.to, host);
    return self;
}

static void destroy(mrt_plugin *self)
{
    if (self)
        udp_sender_close(&self->sender.to);
    free(self);
}

static mrt_result open(mrt_plugin *self, const char *address, const double *params,
                       mrt_face_wants *wants)
{
    wants->rate_hz = params[RATE];
    wants->repeat_s = 0.25; /* repeats show the receivers that the sender is running */
    self->begun_ns = self->host->now_ns(self->host);
    return udp_sender_open(&self->sender.to, address,
                           params[ROLE] > 0.5 ? PERFORMER_PORT : ASSISTANT_PORT, "vmc");
}

static uint32_t bone_named(const mrt_face_names *n, const char *const *name)
{
    for (; *name; ++name)
        for (uint32_t i = 0; i < n->bone_count; ++i)
            if (strcmp(n->bones[i], *name) == 0)
                return i;
    return NO_BONE;
}

static mrt_result begin(mrt_plugin *self, const mrt_face_names *names)
{
    self->names = names;
    for (int i = 0; i < HEAD_BONES; ++i)
        self->bone[i] = bone_named(names, head_bone[i].face);
    for (int i = 0; i < PRESETS; ++i) {
        self->preset[i] = UINT32_MAX;
        for (uint32_t w = ARKIT_AND_TURNS; w < names->weight_count; ++w)
            if (strcmp(names->weights[w], preset_name[i][0]) == 0 && self->preset[i] == UINT32_MAX)
                self->preset[i] = w;
    }
    return MRT_OK;
}

/* ---- bones ---- */

static void multiply(float out[4], const float a[4], const float b[4])
{
    out[0] = a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1];
    out[1] = a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0];
    out[2] = a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3];
    out[3] = a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2];
}

/* Rotation of a bone relative to its parent, in Unity's axes: the face's axes mirrored in x. */
static void local_rotation(float out[4], const mrt_face_names *n, const mrt_face_sample *sample,
                           uint32_t bone)
{
    const float *own = sample->bones[bone].turn;
    float rotation[4] = {own[0], own[1], own[2], own[3]};
    if (n->parents[bone] >= 0) {
        const float *of = sample->bones[n->parents[bone]].turn;
        const float back[4] = {-of[0], -of[1], -of[2], of[3]};
        multiply(rotation, back, own);
    }
    out[0] = rotation[0];
    out[1] = -rotation[1];
    out[2] = -rotation[2];
    out[3] = rotation[3];
}

static void send_bone(mrt_plugin *self, const char *address, const char *name,
                      const float rotation[4])
{
    osc_builder message = osc_builder_start();
    osc_builder_text(&message, name);
    for (int i = 0; i < 3; ++i)
        osc_builder_float(&message, 0.0f);
    for (int i = 0; i < 4; ++i)
        osc_builder_float(&message, rotation[i]);
    osc_sender_add(&self->sender, &message, address);
}

static const float no_rotation[4] = {0, 0, 0, 1};

static int head_bone_of(const mrt_plugin *self, const char *name, bool with_jaw)
{
    for (int i = 0; i < HEAD_BONES; ++i)
        if (strcmp(head_bone[i].vmc, name) == 0 && self->bone[i] != NO_BONE &&
            (i != JAW_BONE || with_jaw))
            return i;
    return -1;
}

/* A performer sends all bones, an assistant only the face's bones. */
static void send_bones(mrt_plugin *self, const double *params, const mrt_face_sample *sample)
{
    for (int i = 0; i < BODY_BONES; ++i) {
        int of = head_bone_of(self, body_bone[i], params[JAW] > 0.5);
        float rotation[4] = {0, 0, 0, 1};
        if (of >= 0)
            local_rotation(rotation, self->names, sample, self->bone[of]);
        if (of >= 0 || params[ROLE] > 0.5)
            send_bone(self, "/VMC/Ext/Bone/Pos", body_bone[i], rotation);
    }
}

/* ---- blend shapes ---- */

static void send_blend(mrt_plugin *self, const char *name, float value)
{
    osc_builder message = osc_builder_start();
    osc_builder_text(&message, name);
    osc_builder_float(&message, value);
    osc_sender_add(&self->sender, &message, "/VMC/Ext/Blend/Val");
}

static void send_blends(mrt_plugin *self, const double *params, const mrt_face_sample *sample)
{
    const mrt_face_names *n = self->names;
    bool has_arkit = n->weight_count >= ARKIT;
    for (uint32_t i = 0; has_arkit && (int)params[NAMES] != NAMES_PRESETS && i < ARKIT; ++i) {
        char name[NAME_BYTES];
        (void)snprintf(name, sizeof name, "%.64s", n->weights[i]);
        if ((int)params[CASE] == CASE_CAMEL && name[0] >= 'A' && name[0] <= 'Z')
            name[0] = (char)(name[0] - 'A' + 'a');
        send_blend(self, name, sample->weights[i]);
    }
    for (int i = 0; (int)params[NAMES] != NAMES_ARKIT && i < PRESETS; ++i)
        if (self->preset[i] != UINT32_MAX)
            send_blend(self, preset_name[i][1], sample->weights[self->preset[i]]);
    for (uint32_t i = 0; (params[OWN] > 0.5 || !has_arkit) && i < n->shape_count; ++i)
        send_blend(self, n->shapes[i], sample->shapes[i]);
    osc_builder message = osc_builder_start();
    osc_sender_add(&self->sender, &message, "/VMC/Ext/Blend/Apply");
}

static mrt_result send(mrt_plugin *self, const double *params, const mrt_face_sample *sample)
{
    int64_t at_ns = sample->take_ns >= 0 ? sample->take_ns : sample->time_ns - self->begun_ns;
    osc_sender_begin(&self->sender, OSC_NO_TIME);
    osc_builder message = osc_builder_start();
    osc_builder_int32(&message, 1); /* the model is loaded */
    osc_sender_add(&self->sender, &message, "/VMC/Ext/OK");
    message = osc_builder_start();
    osc_builder_float(&message, (float)((double)at_ns * 1e-9));
    osc_sender_add(&self->sender, &message, "/VMC/Ext/T");
    if (params[ROLE] > 0.5)
        send_bone(self, "/VMC/Ext/Root/Pos", "root", no_rotation);
    send_bones(self, params, sample);
    send_blends(self, params, sample);
    return osc_sender_end(&self->sender);
}

static void close(mrt_plugin *self)
{
    udp_sender_close(&self->sender.to);
}

static const char *const roles[] = {"assistant", "performer", NULL};
static const char *const names_label[] = {"all", "arkit", "presets", NULL};
static const char *const case_label[] = {"pascal", "camel", NULL};
static const char *const off_on[] = {"off", "on", NULL};
static const mrt_param params[PARAM_COUNT] = {
    [ROLE] = {1, MRT_PARAM_STEPPED, "Role", "Network", "",
              "Assistant: send to a performer with a body, port 39540. Performer: send a whole "
              "person to a marionette, port 39539. Used when the output is opened again",
              0, 1, 0, roles},
    [NAMES] = {2, MRT_PARAM_STEPPED, "Names", "Blend shapes", "",
               "ARKit's 52, VRM's presets (A, Blink, Joy), or both", 0, 2, NAMES_ALL, names_label},
    [CASE] = {3, MRT_PARAM_STEPPED, "Case", "Blend shapes", "",
              "EyeBlinkLeft, as in the protocol, or eyeBlinkLeft", 0, 1, CASE_PASCAL, case_label},
    [OWN] = {4, MRT_PARAM_STEPPED, "Own shapes", "Blend shapes", "",
             "Also send the mesh's own shapes with their names", 0, 1, 0, off_on},
    [JAW] = {5, MRT_PARAM_STEPPED, "Jaw", "Bones", "",
             "Also send the jaw as a bone, for avatars without a blend shape that opens the mouth",
             0, 1, 0, off_on},
    [RATE] = {6, 0, "Rate", "Network", "Hz",
              "Largest number of faces per second; 0: every new face. Used when the output is "
              "opened again",
              0, 1000, 0, NULL},
};
static const mrt_face_output output = {open, begin, send, close};
static const mrt_interface interfaces[] = {{MRT_FACE_OUTPUT, &output}, {NULL, NULL}};
static const mrt_plugin_type type = {
    MRT_ABI,
    PARAM_COUNT,
    params,
    interfaces,
    "org.marotte.vmc",
    "VMC",
    MAROTTE_VERSION,
    "The face over the VMC protocol: head, eyes, blend presets and ARKit's 52, to avatars",
    create,
    destroy,
};

MRT_EXPORT const mrt_plugin_type *const marotte_plugins[] = {&type, NULL};
