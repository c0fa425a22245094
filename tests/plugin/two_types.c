/* A library of two mappings that do nothing, and that ask the host for their folders. */
#include <marotte/plugin.h>

#include <stdlib.h>
#include <string.h>

struct mrt_plugin {
    char settings[4096], cache[4096];
};

static mrt_plugin *create(const mrt_host *host)
{
    mrt_plugin *self = calloc(1, sizeof *self);
    const mrt_folders *folders = host->service(host, MRT_FOLDERS);
    if (self && folders &&
        (folders->settings(host, self->settings, sizeof self->settings) < 0 ||
         folders->cache(host, self->cache, sizeof self->cache) < 0)) {
        free(self);
        return NULL;
    }
    if (self && folders)
        host->log(host, MRT_LOG_INFO, self->settings);
    return self;
}

static void destroy(mrt_plugin *self)
{
    free(self);
}

static mrt_result activate(mrt_plugin *self, const mrt_face *face)
{
    (void)self, (void)face;
    return MRT_OK;
}

static void nothing(mrt_plugin *self)
{
    (void)self;
}

static mrt_result process(mrt_plugin *self, const mrt_frame *frame, mrt_pull *pull)
{
    (void)self, (void)frame, (void)pull;
    return MRT_HOLD;
}

static const mrt_mapping mapping = {activate, nothing, nothing, process};
static const mrt_interface interfaces[] = {{MRT_MAPPING, &mapping}, {NULL, NULL}};
static const mrt_plugin_type first = {.abi = MRT_ABI,
                                      .interfaces = interfaces,
                                      .id = "org.example.first",
                                      .name = "First",
                                      .version = "1.0",
                                      .about = "Does nothing.",
                                      .create = create,
                                      .destroy = destroy};
static const mrt_plugin_type second = {.abi = MRT_ABI,
                                       .interfaces = interfaces,
                                       .id = "org.example.second",
                                       .name = "Second",
                                       .version = "1.0",
                                       .about = "Does nothing either.",
                                       .create = create,
                                       .destroy = destroy};
const mrt_plugin_type *const marotte_plugins[] = {&first, &second, NULL};
