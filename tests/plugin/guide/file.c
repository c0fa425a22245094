/* Around the guide's blocks "in: file": what a plugin's file has above them. */
#include <marotte/plugin.h>

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct mrt_plugin {
    const mrt_host *host;
    const mrt_face *face;
    const mrt_rig_pose *joy;
    float bend, neutral, loaded;
};

#include "block.h"
