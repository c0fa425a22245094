/* openxr.c - the plugin "org.marotte.openxr": the bare or gloved hand that an OpenXR runtime tracks
 * (a headset, a Leap, a glove driver). The runtime is loaded into another process
 * (openxr_helper.h). marotte converts the positions of its joints to angles (MRT_LANDMARKS).
 * Orientations are not used, because their meaning differs between runtimes. */
#include "bare_hand.h"
#include "device_io.h"
#include "openxr_helper.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct mrt_plugin {
    const mrt_host *host;
    bool is_open;
    openxr_listener listener; /* joined while open */
    bare_hand hand;
    openxr_hand last[2]; /* a frame has both hands, even if only one changed */
};

/* ---- opening ---- */

static void input_close(mrt_plugin *self)
{
    if (self->is_open)
        openxr_helper_leave();
    self->is_open = false;
}

static mrt_result input_open(mrt_plugin *self, const char *address, const double *params)
{
    char reason[OPENXR_REASON];
    input_close(self);
    if (address[0] != '\0') {
        device_log(self->host, MRT_LOG_ERROR,
                   "\"%.40s\": openxr takes no address: the system has one active runtime",
                   address);
        return MRT_ERR_ARGUMENT;
    }
    if (!bare_hand_has_reader(&self->hand))
        return MRT_ERR_UNSUPPORTED;
    if (!openxr_helper_join(&self->listener, reason)) {
        device_log(self->host, MRT_LOG_ERROR, "%s", reason);
        return MRT_ERR_IO;
    }
    self->is_open = true;
    bare_hand_begin(&self->hand, params);
    memset(self->last, 0, sizeof self->last);
    return MRT_OK;
}

static const mrt_channel *input_channels(mrt_plugin *self, uint32_t *out_count)
{
    *out_count = self->is_open ? MRT_ANGLES : 0;
    return self->hand.channel;
}

/* ---- reading ---- */

/* OpenXR's 26 joints without the palm and the metacarpals of index to little. Joints that are not
 * tracked are only guesses for a hidden hand. */
static void to_landmarks(const openxr_hand *hand, uint32_t side, mrt_landmarks *out)
{
    static const uint8_t joint[MRT_JOINTS] = {1,  2,  3,  4,  5,  7,  8,  9,  10, 12, 13,
                                              14, 15, 17, 18, 19, 20, 22, 23, 24, 25};
    const uint32_t seen = hand->valid & hand->tracked;
    *out = (mrt_landmarks){.side = side};
    for (uint32_t i = 0; i < MRT_JOINTS; ++i) {
        const float *at = hand->at[joint[i]];
        out->at[i] = (mrt_vec3){at[0], at[1], at[2]};
        out->doubtful |= (seen >> joint[i] & 1u) ? 0 : UINT32_C(1) << i;
    }
}

/* Chooses the hand that performs; MRT_NO_HAND: none. */
static uint32_t choose(const bare_hand *shown, const openxr_frame *frame)
{
    const bool is_there[2] = {frame->hand[MRT_LEFT].active == 1,
                              frame->hand[MRT_RIGHT].active == 1};
    if (shown->wanted != BARE_HAND_EITHER)
        return is_there[shown->wanted] ? shown->wanted : MRT_NO_HAND;
    if (shown->has_shown && is_there[shown->shown_side])
        return shown->shown_side;
    if (shown->has_shown && frame->time_ns - shown->shown_ns < BARE_HAND_CHANGE_NS)
        return MRT_NO_HAND;
    return is_there[MRT_RIGHT] ? MRT_RIGHT : is_there[MRT_LEFT] ? MRT_LEFT : MRT_NO_HAND;
}

/* Returns false if the frame moves nothing. Then the pose is held, and the face eases back when the
 * hand returns. */
static bool take_frame(mrt_plugin *self, const openxr_frame *frame)
{
    mrt_landmarks seen;
    mrt_hand_reading now = self->hand.reading;
    self->hand.lost += frame->lost;
    uint32_t side = choose(&self->hand, frame);
    if (side == MRT_NO_HAND)
        return false;
    const openxr_hand *hand = &frame->hand[side];
    if (memcmp(&self->last[side], hand, sizeof *hand) == 0)
        return false; /* only the other hand moved */
    self->last[side] = *hand;
    to_landmarks(hand, side, &seen);
    self->hand.reader->read(self->host, &seen, &now);
    if (now.confidence < BARE_HAND_SURE)
        return false;
    bare_hand_turn(&self->hand, side, &now);
    self->hand.reading = now;
    bare_hand_show(&self->hand, side, frame->time_ns);
    return true;
}

static mrt_result input_read(mrt_plugin *self, const double *params, int64_t deadline_ns,
                             mrt_sample *out_sample)
{
    if (!self->is_open)
        return MRT_ERR_IO;
    bare_hand_follow(&self->hand, params);
    int64_t until_ns = device_deadline_ns(self->host, deadline_ns);
    for (;;) {
        openxr_frame frame;
        char text[OPENXR_REASON];
        int heard = openxr_helper_wait(&self->listener, &frame, text, until_ns);
        if (heard == OPENXR_HEARD_NOTHING)
            return MRT_TIMEOUT;
        if (heard == OPENXR_HEARD_FRAME && take_frame(self, &frame)) {
            const int64_t seen_ns = frame.time_ns + self->hand.host_offset_ns;
            bare_hand_write_sample(&self->hand,
                                   device_sample_ns(self->host, seen_ns, &self->hand.last_ns),
                                   out_sample);
            return MRT_OK;
        }
        if (heard != OPENXR_HEARD_FRAME)
            device_log(self->host, heard == OPENXR_HEARD_NEWS ? MRT_LOG_INFO : MRT_LOG_WARNING,
                       "%s", text);
    }
}

/* ---- devices ---- */

/* Looks for an active runtime where the loader does. */
static bool has_runtime(void)
{
    static const char name[] = "openxr/1/active_runtime.json";
    const char *own = getenv("XR_RUNTIME_JSON"), *config = getenv("XDG_CONFIG_HOME");
    const char *home = getenv("HOME");
    char path[PATH_MAX];
    if (own && own[0])
        return access(own, R_OK) == 0;
    if (config && config[0])
        (void)snprintf(path, sizeof path, "%s/%s", config, name);
    else
        (void)snprintf(path, sizeof path, "%s/.config/%s", home ? home : "", name);
    return access(path, R_OK) == 0 || access("/etc/xdg/openxr/1/active_runtime.json", R_OK) == 0 ||
           access("/etc/openxr/1/active_runtime.json", R_OK) == 0 ||
           access("/usr/share/openxr/1/active_runtime.json", R_OK) == 0;
}

static void fill_device(mrt_device *out)
{
    char path[PATH_MAX], reason[OPENXR_REASON];
    memset(out, 0, sizeof *out);
    (void)snprintf(out->name, sizeof out->name, "OpenXR: hands of a headset, a Leap or a glove");
    /* Only opening shows whether the headset is connected, and opening may start it. */
    out->state = MRT_DEVICE_UNSURE;
    (void)snprintf(out->advice, sizeof out->advice, "%s",
                   openxr_helper_find(path, sizeof path, reason)
                       ? "connect the headset and open the input: it reports what is missing"
                       : reason);
}

static uint32_t list_devices(mrt_plugin *self, mrt_device *out, uint32_t capacity)
{
    (void)self;
    if (!has_runtime())
        return 0;
    if (capacity > 0)
        fill_device(out);
    return 1;
}

static bool current_device(mrt_plugin *self, mrt_device *out)
{
    if (self->is_open)
        fill_device(out);
    return self->is_open;
}

/* ---- the type ---- */

static mrt_plugin *create(const mrt_host *host)
{
    mrt_plugin *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->host = host;
    bare_hand_init(&self->hand, host);
    return self;
}

static void destroy(mrt_plugin *self)
{
    if (!self)
        return;
    input_close(self);
    free(self);
}

static const mrt_input input = {input_open, input_channels, input_read, input_close, 0};
static const mrt_devices devices = {list_devices, current_device};
static const mrt_interface interfaces[] = {
    {MRT_INPUT, &input}, {MRT_DEVICES, &devices}, {NULL, NULL}};

static const mrt_plugin_type type = {
    MRT_ABI,
    BARE_HAND_PARAMS,
    bare_hand_params,
    interfaces,
    "org.marotte.openxr",
    "OpenXR",
    MAROTTE_VERSION,
    "A hand tracked by a headset, a Leap or a glove driver, through any OpenXR runtime",
    create,
    destroy,
};

MRT_EXPORT const mrt_plugin_type *const marotte_plugins[] = {&type, NULL};
