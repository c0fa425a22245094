/* face_osc.c - the plugin "org.marotte.face_osc": the face as named numbers over OSC, for a user's
 * own patches (TouchDesigner, Max, Pure Data, Blender with marotte's add-on). Sends messages
 * /marotte/1/face NAME VALUE NAME VALUE ..., in bundles whose time tags are the times of the
 * faces. */
#include "osc_wire.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { FACE_OSC_PORT = 9106, NAME_MAX_BYTES = 80, MESSAGE_BYTES = 1200 };
enum { RATE, WEIGHTS, SHAPES, MOTIONS, CONTACTS, PARAM_COUNT };

struct mrt_plugin {
    const mrt_host *host;
    osc_sender sender;
    const mrt_face_names *names;
    osc_builder message;
    size_t bytes; /* size of the current message; 0: none */
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
    wants->repeat_s = 0.25;
    return udp_sender_open(&self->sender.to, address, FACE_OSC_PORT, "face_osc");
}

static mrt_result begin(mrt_plugin *self, const mrt_face_names *names)
{
    self->names = names;
    return MRT_OK;
}

static void end_message(mrt_plugin *self)
{
    if (self->bytes > 0)
        osc_sender_add(&self->sender, &self->message, "/marotte/1/face");
    self->bytes = 0;
}

static void say(mrt_plugin *self, const char *name, float value)
{
    size_t bytes = strlen(name) + 4 + 4 + 2; /* with its padding, its value and the type tags */
    if (self->bytes + bytes > MESSAGE_BYTES)
        end_message(self);
    if (self->bytes == 0)
        self->message = osc_builder_start();
    osc_builder_text(&self->message, name);
    osc_builder_float(&self->message, value);
    self->bytes += bytes;
}

static void send_contacts(mrt_plugin *self, const mrt_vec3 *offset)
{
    const mrt_face *face = self->names->face;
    for (uint32_t i = 0; i < face->contact_count; ++i) {
        const float way[3] = {offset[i].x, offset[i].y, offset[i].z};
        for (int k = 0; k < 3; ++k) {
            char name[NAME_MAX_BYTES];
            (void)snprintf(name, sizeof name, "%.64s.%c", face->contacts[i].name, "xyz"[k]);
            say(self, name, way[k]);
        }
    }
}

/* Converts the host's time to ns since 1970. */
static int64_t utc_of(const mrt_plugin *self, int64_t time_ns)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_REALTIME, &now);
    return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec - self->host->now_ns(self->host) +
           time_ns;
}

static mrt_result send(mrt_plugin *self, const double *params, const mrt_face_sample *sample)
{
    const mrt_face_names *n = self->names;
    osc_sender_begin(&self->sender, utc_of(self, sample->time_ns));
    for (uint32_t i = 0; params[WEIGHTS] > 0.5 && i < n->weight_count; ++i)
        say(self, n->weights[i], sample->weights[i]);
    for (uint32_t i = 0; params[SHAPES] > 0.5 && i < n->shape_count; ++i)
        say(self, n->shapes[i], sample->shapes[i]);
    for (uint32_t i = 0; params[MOTIONS] > 0.5 && i < n->face->dof_count; ++i)
        say(self, n->face->dofs[i].name, sample->dofs[i]);
    if (params[CONTACTS] > 0.5)
        send_contacts(self, sample->contacts);
    end_message(self);
    return osc_sender_end(&self->sender);
}

static void close(mrt_plugin *self)
{
    udp_sender_close(&self->sender.to);
}

static const char *const off_on[] = {"off", "on", NULL};
static const mrt_param params[PARAM_COUNT] = {
    [RATE] = {1, 0, "Rate", "Network", "Hz",
              "Largest number of faces per second; 0: every new face. Used when the output is "
              "opened again",
              0, 1000, 0, NULL},
    [WEIGHTS] = {2, MRT_PARAM_STEPPED, "Weights", "Content", "",
                 "ARKit's 52 weights and the other common weights, 0 to 1", 0, 1, 1, off_on},
    [SHAPES] = {3, MRT_PARAM_STEPPED, "Shapes", "Content", "", "The mesh's own shapes, 0 to 1", 0,
                1, 1, off_on},
    [MOTIONS] = {4, MRT_PARAM_STEPPED, "Motions", "Content", "",
                 "Degrees of freedom of the bones (jaw.open), rad or mm", 0, 1, 1, off_on},
    [CONTACTS] = {5, MRT_PARAM_STEPPED, "Contacts", "Content", "",
                  "Movement of each contact (mouth.corner.l.x), mm", 0, 1, 1, off_on},
};
static const mrt_face_output output = {open, begin, send, close};
static const mrt_interface interfaces[] = {{MRT_FACE_OUTPUT, &output}, {NULL, NULL}};
static const mrt_plugin_type type = {
    MRT_ABI,
    PARAM_COUNT,
    params,
    interfaces,
    "org.marotte.face_osc",
    "Named numbers (OSC)",
    MAROTTE_VERSION,
    "The face as named numbers over OSC: weights, shapes, bone motions and contacts",
    create,
    destroy,
};

MRT_EXPORT const mrt_plugin_type *const marotte_plugins[] = {&type, NULL};
