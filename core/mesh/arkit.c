#include "mesh/arkit.h"

#include <ctype.h>
#include <string.h>

/* Jaw and mouth: the right shape comes before the left one, unlike in the app's datagrams. */
const char *const arkit_name[ARKIT_CHANNELS] = {"EyeBlinkLeft",
                                                "EyeLookDownLeft",
                                                "EyeLookInLeft",
                                                "EyeLookOutLeft",
                                                "EyeLookUpLeft",
                                                "EyeSquintLeft",
                                                "EyeWideLeft",
                                                "EyeBlinkRight",
                                                "EyeLookDownRight",
                                                "EyeLookInRight",
                                                "EyeLookOutRight",
                                                "EyeLookUpRight",
                                                "EyeSquintRight",
                                                "EyeWideRight",
                                                "JawForward",
                                                "JawRight",
                                                "JawLeft",
                                                "JawOpen",
                                                "MouthClose",
                                                "MouthFunnel",
                                                "MouthPucker",
                                                "MouthRight",
                                                "MouthLeft",
                                                "MouthSmileLeft",
                                                "MouthSmileRight",
                                                "MouthFrownLeft",
                                                "MouthFrownRight",
                                                "MouthDimpleLeft",
                                                "MouthDimpleRight",
                                                "MouthStretchLeft",
                                                "MouthStretchRight",
                                                "MouthRollLower",
                                                "MouthRollUpper",
                                                "MouthShrugLower",
                                                "MouthShrugUpper",
                                                "MouthPressLeft",
                                                "MouthPressRight",
                                                "MouthLowerDownLeft",
                                                "MouthLowerDownRight",
                                                "MouthUpperUpLeft",
                                                "MouthUpperUpRight",
                                                "BrowDownLeft",
                                                "BrowDownRight",
                                                "BrowInnerUp",
                                                "BrowOuterUpLeft",
                                                "BrowOuterUpRight",
                                                "CheekPuff",
                                                "CheekSquintLeft",
                                                "CheekSquintRight",
                                                "NoseSneerLeft",
                                                "NoseSneerRight",
                                                "TongueOut",
                                                "HeadYaw",
                                                "HeadPitch",
                                                "HeadRoll",
                                                "LeftEyeYaw",
                                                "LeftEyePitch",
                                                "LeftEyeRoll",
                                                "RightEyeYaw",
                                                "RightEyePitch",
                                                "RightEyeRoll"};

enum { PLAIN_NAME = 64 };

/* Keeps only letters, in lower case, and expands "_L" and "_R" at the end. */
static void plain_name(char out[PLAIN_NAME], const char *name)
{
    size_t size = strlen(name), count = 0;
    const char *side = "";
    if (size > 2 && name[size - 2] == '_' && strchr("lLrR", name[size - 1])) {
        side = tolower((unsigned char)name[size - 1]) == 'l' ? "left" : "right";
        size -= 2;
    }
    for (size_t i = 0; i < size && count + 8 < PLAIN_NAME; ++i)
        if (isalpha((unsigned char)name[i]))
            out[count++] = (char)tolower((unsigned char)name[i]);
    memcpy(out + count, side, strlen(side) + 1);
}

uint32_t arkit_find(const char *name)
{
    char wanted[PLAIN_NAME], is[PLAIN_NAME];
    plain_name(wanted, name);
    for (uint32_t i = 0; i < ARKIT_CHANNELS; ++i) {
        plain_name(is, arkit_name[i]);
        if (strcmp(wanted, is) == 0)
            return i;
    }
    return ARKIT_NONE;
}

bool arkit_is_same_name(const char *a, const char *b)
{
    if (strcmp(a, b) == 0)
        return true;
    char plain_a[PLAIN_NAME], plain_b[PLAIN_NAME];
    plain_name(plain_a, a);
    plain_name(plain_b, b);
    return strcmp(plain_a, plain_b) == 0 && arkit_find(a) < ARKIT_SHAPES;
}
