/* A device that misbehaves on command, for tests of what the host makes of it: it goes away and
 * comes back, comes back as another, takes long to open, holds a pedal down when it goes, lies
 * about time, gives nonsense or nothing. Its parameters say what. What it does and when goes by its
 * own time, that of its samples: it gives as many, however late they are read. It never allocates
 * after create, and holds one file open while it is open. */
#include <marotte/plugin.h>

#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum {
    PARAM_RATE = 0,
    PARAM_RUN,
    PARAM_AWAY,
    PARAM_LOSSES,
    PARAM_AFTER,
    PARAM_BACK,
    PARAM_PEDAL,
    PARAM_OPEN,
    PARAM_FAIL,
    PARAM_LIE,
    PARAM_LEAP,
    PARAM_RESTART,
    PARAM_LEARN,
    PARAM_FIRST,
    PARAM_TRIES,
    PARAM_COUNT
};
enum { BACK_SAME = 0, BACK_FEWER, BACK_LEFT };
enum { LIE_NONE = 0, LIE_NAN, LIE_FUTURE, LIE_SILENT, LIE_HASTY, LIE_DEAD };
enum { CHANNELS_MAX = 3 };

struct mrt_plugin {
    const mrt_host *host;
    char address[64];
    int file;
    uint32_t hand, channel_count, sequence;
    mrt_channel channel[CHANNELS_MAX];
    int64_t opened_ns, next_ns, back_ns; /* back_ns: away until then */
    uint32_t open_count, losses, tries;  /* tries: since the last loss */
    uint64_t sample_count;               /* of all times that it was open */
    bool has_asked, is_learning;
};

static void say(const mrt_plugin *self, int32_t level, const char *text)
{
    self->host->log(self->host, level, text);
}

static int64_t ns_of(double seconds)
{
    return (int64_t)(seconds * 1e9);
}

static mrt_result refuse(const mrt_plugin *self, const char *reason)
{
    char text[160];
    snprintf(text, sizeof text, "flaky %s: %s", self->address, reason);
    say(self, MRT_LOG_ERROR, text);
    return MRT_ERR_IO;
}

static void describe(mrt_plugin *self, const double *params)
{
    bool is_back = self->losses > 0;
    bool is_left = (is_back && (int)params[PARAM_BACK] == BACK_LEFT) || self->has_asked;
    self->hand = is_left ? MRT_LEFT : MRT_RIGHT;
    self->channel[0] = (mrt_channel){"thumb MPJ", "rad", MRT_CH_ANGLE + 1, self->hand, -3.0f, 3.0f};
    self->channel[1] = (mrt_channel){"index MPJ", "rad", MRT_CH_ANGLE + 4, self->hand, -3.0f, 3.0f};
    self->channel[2] = (mrt_channel){"switch", "", MRT_CH_PEDAL, MRT_NO_HAND, 0.0f, 1.0f};
    self->channel_count = params[PARAM_PEDAL] > 0.5 ? 3 : 2;
    if (is_back && (int)params[PARAM_BACK] == BACK_FEWER)
        self->channel_count = 1;
}

static mrt_result flaky_open(mrt_plugin *self, const char *address, const double *params)
{
    snprintf(self->address, sizeof self->address, "%s", address[0] ? address : "first");
    self->open_count += 1;
    say(self, MRT_LOG_DEBUG, "looking");
    double takes_s = params[self->open_count > 1 ? PARAM_OPEN : PARAM_FIRST];
    int64_t until_ns = self->host->now_ns(self->host) + ns_of(takes_s);
    if (takes_s > 0 && self->host->wait_until_ns(self->host, until_ns) < until_ns)
        return refuse(self, "given up: the host is stopping");
    if (self->open_count == 1 && params[PARAM_FAIL] > 0.5)
        return refuse(self, "no such device: plug it in");
    bool is_away = self->losses > 0 && self->tries++ < (uint32_t)params[PARAM_TRIES];
    if (is_away || self->host->now_ns(self->host) < self->back_ns)
        return refuse(self, "no such device");
    self->file = open("/dev/null", O_RDONLY | O_CLOEXEC);
    if (self->file < 0)
        return refuse(self, "cannot be opened");
    self->opened_ns = self->next_ns = self->host->now_ns(self->host);
    self->sequence = 0;
    describe(self, params);
    return MRT_OK;
}

static const mrt_channel *flaky_channels(mrt_plugin *self, uint32_t *out_count)
{
    *out_count = self->channel_count;
    return self->channel;
}

static void flaky_close(mrt_plugin *self)
{
    if (self->file >= 0)
        close(self->file);
    self->file = -1;
}

static void fill(mrt_plugin *self, const double *params, mrt_sample *out)
{
    /* 0.004 rad a sample up and down, wherever the device was when it went away. */
    uint64_t phase = self->sample_count++ % 400;
    float angle = 0.004f * (float)(phase < 200 ? phase : 400 - phase);
    if (self->losses > 0)
        angle += (float)params[PARAM_LEAP];
    bool is_down = 2 * (self->next_ns - self->opened_ns) > ns_of(params[PARAM_RUN]);
    *out = (mrt_sample){.time_ns = self->next_ns,
                        .sequence = self->sequence++,
                        .count = self->channel_count,
                        .value = {angle, 0.5f * angle, is_down ? 1.0f : 0.0f}};
    if ((int)params[PARAM_LIE] == LIE_NAN)
        out->value[0] = NAN;
    if ((int)params[PARAM_LIE] == LIE_FUTURE)
        out->time_ns += ns_of(1e6);
}

static mrt_result go_away(mrt_plugin *self, const double *params, int64_t now_ns)
{
    self->losses += 1;
    self->tries = 0;
    self->back_ns = now_ns + ns_of(params[PARAM_AWAY]);
    return refuse(self, "the cable was pulled");
}

static void learn(mrt_plugin *self, const double *params)
{
    if (params[PARAM_LEARN] > 0.5) {
        self->is_learning = true;
        say(self, MRT_LOG_INFO, "learn: press switch 1");
    } else if (self->is_learning && self->sequence == 10) {
        self->is_learning = false;
        say(self, MRT_LOG_INFO, "learn: done: 1 switch was stored");
    }
}

static mrt_result flaky_read(mrt_plugin *self, const double *params, int64_t deadline_ns,
                             mrt_sample *out)
{
    int64_t now_ns = self->host->now_ns(self->host);
    int64_t age_ns = self->next_ns - self->opened_ns;
    bool may_go = params[PARAM_LOSSES] < 0.5 || self->losses < (uint32_t)params[PARAM_LOSSES];
    int lie = (int)params[PARAM_LIE];
    learn(self, params);
    if (params[PARAM_RUN] > 0 && may_go && age_ns >= ns_of(params[PARAM_RUN]))
        return go_away(self, params, now_ns);
    if (lie == LIE_DEAD && self->losses > 0)
        return refuse(self, "does not answer");
    if (params[PARAM_AFTER] > 0 && !may_go && age_ns >= ns_of(params[PARAM_AFTER]))
        return MRT_END;
    if (params[PARAM_RESTART] > 0 && !self->has_asked && age_ns >= ns_of(params[PARAM_RESTART])) {
        self->has_asked = true;
        self->host->request_restart(self->host);
    }
    if (lie == LIE_HASTY)
        return MRT_TIMEOUT;
    if (lie == LIE_SILENT || self->next_ns > deadline_ns) {
        self->host->wait_until_ns(self->host, deadline_ns);
        return MRT_TIMEOUT;
    }
    self->host->wait_until_ns(self->host, self->next_ns);
    fill(self, params, out);
    self->next_ns += ns_of(1.0 / params[PARAM_RATE]);
    return MRT_OK;
}

/* ---- devices ---- */

static const mrt_device plugged_in[] = {
    {"port:1-2", "Flaky glove", "", MRT_DEVICE_READY},
    {"port:1-3", "Flaky pedal", "add yourself to the group dialout: sudo usermod -aG dialout $USER",
     MRT_DEVICE_DENIED},
};
enum { PLUGGED_IN = sizeof plugged_in / sizeof plugged_in[0] };

/* MAROTTE_FLAKY=PATH: plugged in while there is such a file. */
static uint32_t flaky_list(mrt_plugin *self, mrt_device *out, uint32_t capacity)
{
    (void)self;
    const char *wish = getenv("MAROTTE_FLAKY");
    if (wish && access(wish, F_OK) != 0)
        return 0;
    for (uint32_t i = 0; i < PLUGGED_IN && i < capacity; ++i)
        out[i] = plugged_in[i];
    return PLUGGED_IN;
}

static bool flaky_current(mrt_plugin *self, mrt_device *out)
{
    *out = plugged_in[0];
    return self->file >= 0;
}

/* ---- the type ---- */

static mrt_plugin *flaky_create(const mrt_host *host)
{
    mrt_plugin *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->host = host;
    self->file = -1;
    return self;
}

static void flaky_destroy(mrt_plugin *self)
{
    if (self)
        flaky_close(self);
    free(self);
}

static const char *const back_label[] = {"same", "fewer", "left", NULL};
static const char *const lie_label[] = {"none", "nan", "future", "silent", "hasty", "dead", NULL};

static const mrt_param params[PARAM_COUNT] = {
    [PARAM_RATE] = {1, 0, "rate", "Device", "Hz", "Samples a second", 1, 2000, 200, NULL},
    [PARAM_RUN] = {2, 0, "run", "Loss", "s", "Goes away after samples of so long; 0: never", 0, 1e4,
                   0, NULL},
    [PARAM_AWAY] = {3, 0, "away", "Loss", "s", "How long", 0, 1e4, 0, NULL},
    [PARAM_LOSSES] = {4, MRT_PARAM_STEPPED, "losses", "Loss", "", "How often; 0: always", 0, 1e6, 0,
                      NULL},
    [PARAM_AFTER] = {5, 0, "after", "Loss", "s", "The end, after the last loss; 0: none", 0, 1e4, 0,
                     NULL},
    [PARAM_BACK] = {6, MRT_PARAM_STEPPED, "back", "Loss", "", "What comes back", 0, 2, 0,
                    back_label},
    [PARAM_PEDAL] = {7, MRT_PARAM_STEPPED, "pedal", "Device", "", "Has one, down when it goes", 0,
                     1, 0, NULL},
    [PARAM_OPEN] = {8, 0, "open", "Device", "s", "How long a later open takes", 0, 100, 0, NULL},
    [PARAM_FAIL] = {9, MRT_PARAM_STEPPED, "fail", "Device", "", "The first open fails", 0, 1, 0,
                    NULL},
    [PARAM_LIE] = {10, MRT_PARAM_STEPPED, "lie", "Device", "", "What is wrong with samples", 0, 5,
                   0, lie_label},
    [PARAM_LEAP] = {11, 0, "leap", "Loss", "rad", "How far the hand moved while away", -3, 3, 0,
                    NULL},
    [PARAM_RESTART] = {12, 0, "restart", "Device", "s", "Asks to be restarted, then is left", 0,
                       1e4, 0, NULL},
    [PARAM_LEARN] = {13, MRT_PARAM_TRIGGER, "learn", "Device", "", "Learns a switch", 0, 1, 0,
                     NULL},
    [PARAM_FIRST] = {14, 0, "first", "Device", "s", "How long the first open takes", 0, 100, 0,
                     NULL},
    [PARAM_TRIES] = {15, MRT_PARAM_STEPPED, "tries", "Loss", "",
                     "So many attempts find nothing first", 0, 1e6, 0, NULL},
};

static const mrt_input input = {flaky_open, flaky_channels, flaky_read, flaky_close, 0};
static const mrt_devices devices = {flaky_list, flaky_current};
static const mrt_interface interfaces[] = {
    {MRT_INPUT, &input}, {MRT_DEVICES, &devices}, {NULL, NULL}};

static const mrt_plugin_type type = {MRT_ABI,
                                     PARAM_COUNT,
                                     params,
                                     interfaces,
                                     "org.example.flaky",
                                     "Flaky",
                                     "1",
                                     "A device that goes away and comes back",
                                     flaky_create,
                                     flaky_destroy};

MRT_EXPORT const mrt_plugin_type *const marotte_plugins[] = {&type, NULL};
