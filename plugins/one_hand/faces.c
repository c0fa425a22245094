#include "faces.h"

#include <string.h>

#define ONE(pose)                                                                                  \
    {                                                                                              \
        {                                                                                          \
            pose, 1.0                                                                              \
        }                                                                                          \
    }
#define TWO(a, b)                                                                                  \
    {                                                                                              \
        {a, 1.0},                                                                                  \
        {                                                                                          \
            b, 1.0                                                                                 \
        }                                                                                          \
    }
#define VISEME(name)                                                                               \
    {                                                                                              \
        name, HALF_MOUTH, ONE("viseme_" name)                                                      \
    }
#define EXPRESSION(pose, name)                                                                     \
    {name, HALF_MOUTH, ONE(pose)},                                                                 \
    {                                                                                              \
        name, HALF_UPPER, ONE(pose)                                                                \
    }

/* clang-format off */
const face_recipe face_recipes[FACE_COUNT] = {
    VISEME("PP"), VISEME("FF"), VISEME("TH"), VISEME("DD"), VISEME("kk"), VISEME("CH"),
    VISEME("SS"), VISEME("nn"), VISEME("RR"), VISEME("aa"), VISEME("E"), VISEME("I"),
    VISEME("O"), VISEME("U"), VISEME("laughter"),
    {"jaw open", HALF_MOUTH, ONE("jawOpen")},
    {"lips closed over an open jaw", HALF_MOUTH, {{"mouthClose", 1.0}, {"jawOpen", 0.25}}},
    {"lips closed", HALF_MOUTH, ONE("mouthClose")},
    {"tongue", HALF_MOUTH, ONE("tongueOut")},
    {"smile left", HALF_MOUTH, ONE("mouthSmileLeft")},
    {"smile right", HALF_MOUTH, ONE("mouthSmileRight")},
    {"smile", HALF_MOUTH, TWO("mouthSmileLeft", "mouthSmileRight")},
    {"frown left", HALF_MOUTH, ONE("mouthFrownLeft")},
    {"frown right", HALF_MOUTH, ONE("mouthFrownRight")},
    {"frown", HALF_MOUTH, TWO("mouthFrownLeft", "mouthFrownRight")},
    {"wide", HALF_MOUTH, TWO("mouthStretchLeft", "mouthStretchRight")},
    {"sneer", HALF_MOUTH, TWO("noseSneerLeft", "noseSneerRight")},
    {"cheeks puffed", HALF_MOUTH, ONE("cheekPuff")},
    EXPRESSION("joy", "joy"), EXPRESSION("sadness", "sadness"), EXPRESSION("anger", "anger"),
    EXPRESSION("surprise", "surprise"), EXPRESSION("fear", "fear"),
    EXPRESSION("disgust", "disgust"), EXPRESSION("contempt", "contempt"),
    EXPRESSION("sleepy", "sleepy"), EXPRESSION("smug", "smug"),
    EXPRESSION("wink_left", "wink left"), EXPRESSION("wink_right", "wink right"),
    EXPRESSION("brow_up", "one brow up"),
    {"eyes closed", HALF_UPPER, TWO("eyeBlinkLeft", "eyeBlinkRight")},
    {"left eye closed", HALF_UPPER, ONE("eyeBlinkLeft")},
    {"right eye closed", HALF_UPPER, ONE("eyeBlinkRight")},
    {"eyes wide", HALF_UPPER, TWO("eyeWideLeft", "eyeWideRight")},
    {"look left", HALF_UPPER, TWO("eyeLookOutLeft", "eyeLookInRight")},
    {"look right", HALF_UPPER, TWO("eyeLookInLeft", "eyeLookOutRight")},
    {"look up", HALF_UPPER, TWO("eyeLookUpLeft", "eyeLookUpRight")},
    {"look down", HALF_UPPER, TWO("eyeLookDownLeft", "eyeLookDownRight")},
    {"brows up", HALF_UPPER, {{"browInnerUp", 1.0}, {"browOuterUpLeft", 1.0},
                              {"browOuterUpRight", 1.0}}},
    {"inner brows up", HALF_UPPER, ONE("browInnerUp")},
    {"brows down", HALF_UPPER, TWO("browDownLeft", "browDownRight")},
    {"left brow up", HALF_UPPER, ONE("browOuterUpLeft")},
    {"right brow up", HALF_UPPER, ONE("browOuterUpRight")},
};
/* clang-format on */

static const double least_change = 1e-3;

int face_name_of(int face)
{
    int name = 0;
    while (face_names[name] && strcmp(face_names[name], face_recipes[face].name) != 0)
        name += 1;
    return name;
}

static const mrt_rig_pose *pose_named(const char *name, const mrt_rig_pose *poses, uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i)
        if (strcmp(poses[i].name, name) == 0)
            return &poses[i];
    return NULL;
}

bool face_find(pose *out, const face_recipe *recipe, const fitting *fit, const mrt_rig_pose *poses,
               uint32_t pose_count)
{
    bool is_there = false;
    memset(out, 0, sizeof *out);
    for (int k = 0; k < FACE_PARTS_MAX && recipe->part[k].pose; ++k) {
        const mrt_rig_pose *from = pose_named(recipe->part[k].pose, poses, pose_count);
        if (from)
            fitting_add(out, fit, from, recipe->part[k].share);
    }
    for (int v = 0; v < POSE_COUNT; ++v) {
        if (half_of_value(v) != recipe->half)
            out->value[v] = 0.0;
        is_there = is_there || out->value[v] > least_change || out->value[v] < -least_change;
    }
    return is_there;
}
