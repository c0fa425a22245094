/* A mapping that performs one pose of the rig, as far as the index finger is bent. It refuses a
 * face whose poses were not set before, and its radius depends on the names and parts of all. */
#include <marotte/plugin.h>

#include <stdlib.h>
#include <string.h>

struct mrt_plugin {
    const mrt_host *host;
    const mrt_face *face;
    const mrt_face *posed_face; /* of the poses */
    const mrt_rig_pose *poses;
    uint32_t pose_count;
};

static mrt_plugin *create(const mrt_host *host)
{
    mrt_plugin *self = calloc(1, sizeof *self);
    if (self)
        self->host = host;
    return self;
}

static void destroy(mrt_plugin *self)
{
    free(self);
}

static void set_poses(mrt_plugin *self, const mrt_face *face, const mrt_rig_pose *poses,
                      uint32_t count)
{
    self->posed_face = face;
    self->poses = poses;
    self->pose_count = count;
}

static mrt_result activate(mrt_plugin *self, const mrt_face *face)
{
    if (self->posed_face != face) {
        self->host->log(self->host, MRT_LOG_ERROR, "the poses of this face were not set");
        return MRT_ERR_UNSUPPORTED;
    }
    self->face = face;
    return MRT_OK;
}

static void deactivate(mrt_plugin *self)
{
    self->face = self->posed_face = NULL;
    self->poses = NULL;
    self->pose_count = 0;
}

static void reset(mrt_plugin *self)
{
    (void)self;
}

/* 40 to 41, of what all poses are called and which half they are of. */
static float radius_mm(const mrt_plugin *self)
{
    uint32_t sum = 2166136261u;
    for (uint32_t i = 0; i < self->pose_count; ++i) {
        for (const char *c = self->poses[i].name; *c; ++c)
            sum = (sum ^ (unsigned char)*c) * 16777619u;
        sum = (sum ^ self->poses[i].part) * 16777619u;
    }
    return 40.0f + (float)(sum >> 16) / 65536.0f;
}

static mrt_result process(mrt_plugin *self, const mrt_frame *frame, mrt_pull *pull)
{
    const mrt_hand *hand = &frame->hand[MRT_RIGHT];
    const uint32_t chosen = (uint32_t)frame->params[0];
    if (!hand->present || chosen >= self->pose_count)
        return MRT_HOLD;
    const mrt_rig_pose *pose = &self->poses[chosen];
    const float share = hand->angle[5];
    pull->mode = MRT_ANCHORED;
    pull->radius_mm = radius_mm(self);
    pull->count =
        self->face->contact_count < MRT_MAX_VECTORS ? self->face->contact_count : MRT_MAX_VECTORS;
    for (uint32_t i = 0; i < pull->count; ++i) {
        const mrt_vec3 rest = self->face->contacts[i].rest, way = pose->pulls[i];
        const mrt_vec3 end = {rest.x + share * way.x, rest.y + share * way.y,
                              rest.z + share * way.z};
        pull->vector[i] = (mrt_vector){rest, end, i + 1};
    }
    for (uint32_t i = 0; i < self->face->dof_count; ++i)
        pull->dof[i] = share * pose->dofs[i];
    return MRT_OK;
}

static const mrt_param params[] = {
    {1, MRT_PARAM_STEPPED, "Pose", "Poser", "", "Which pose of the rig.", 0, 255, 0, NULL}};
static const mrt_mapping mapping = {activate, deactivate, reset, process};
static const mrt_rig_poses rig_poses = {set_poses};
static const mrt_interface interfaces[] = {
    {MRT_MAPPING, &mapping}, {MRT_RIG_POSES, &rig_poses}, {NULL, NULL}};
static const mrt_plugin_type poser = {MRT_ABI,
                                      1,
                                      params,
                                      interfaces,
                                      "org.example.poser",
                                      "Poser",
                                      "1",
                                      "Performs one pose of the rig.",
                                      create,
                                      destroy};
MRT_EXPORT const mrt_plugin_type *const marotte_plugins[] = {&poser, NULL};
