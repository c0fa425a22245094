/* Around the guide's blocks "in: read": the body of an input's read(). */
#include <marotte/plugin.h>

#include <errno.h>
#include <poll.h>
#include <string.h>
#include <unistd.h>

struct mrt_plugin {
    const mrt_host *host;
    int fd;
    uint32_t sequence;
};

mrt_result read_device(mrt_plugin *self, const double *params, int64_t deadline_ns,
                       mrt_sample *out_sample);

mrt_result read_device(mrt_plugin *self, const double *params, int64_t deadline_ns,
                       mrt_sample *out_sample)
{
    (void)params;
#include "block.h"
}
