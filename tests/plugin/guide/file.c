/* Around the guide's blocks "in: file": what a plugin's file has above them. */
#include <marotte/plugin.h>

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct mrt_plugin {
    const mrt_face *face;
    float neutral;
};

#include "block.h"
