/* Around the guide's blocks "in: process": the body of a mapping's process(). */
#include <marotte/plugin.h>

#include <math.h>
#include <string.h>

struct mrt_plugin {
    const mrt_face *face;
    float neutral;
    bool was_down, has_tips;
};

uint32_t contact_named(const mrt_face *face, const char *name);
uint32_t dof_named(const mrt_face *face, const char *name);
mrt_result process(mrt_plugin *self, const mrt_frame *frame, mrt_pull *pull);

mrt_result process(mrt_plugin *self, const mrt_frame *frame, mrt_pull *pull)
{
    (void)self;
    (void)frame;
    (void)pull;
#include "block.h"
    return MRT_OK;
}
