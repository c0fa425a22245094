/* template_name: a hand that opens and closes for ten seconds. An input for marotte: README.md
 * explains how to build and try it, marotte/plugin.h is the whole contract. */
#include <marotte/plugin.h>

#include <stdlib.h>
#include <string.h>

enum { SECONDS, HAND, PARAM_COUNT }; /* the order of the table of parameters below */
enum { CHANNELS = 8, PERIOD_NS = 10000000 };
static const int64_t CYCLE_NS = 2000000000; /* open, closed and open again */

struct mrt_plugin { /* one instance: its whole state */
    const mrt_host *host;
    mrt_channel channel[CHANNELS];
    int64_t start_ns;
    uint32_t sequence; /* of the next sample */
};

static mrt_plugin *create(const mrt_host *host) /* [main] */
{
    mrt_plugin *self = (mrt_plugin *)calloc(1, sizeof(mrt_plugin));
    if (self)
        self->host = host;
    return self;
}

static void destroy(mrt_plugin *self) /* [main] */
{
    free(self);
}

/* [main], and [input] after a device was lost. The address is what follows the colon. */
static mrt_result open_hand(mrt_plugin *self, const char *address, const double *params)
{
    static const uint32_t sensor[CHANNELS] = {4, 5, 7, 8, 11, 12, 15, 16};
    static const char *const name[CHANNELS] = {"index.mpj",  "index.pij", "middle.mpj",
                                               "middle.pij", "ring.mpj",  "ring.pij",
                                               "little.mpj", "little.pij"};
    if (address && address[0]) {
        self->host->log(self->host, MRT_LOG_ERROR,
                        "this input takes no address: write --input template_name");
        return MRT_ERR_ARGUMENT; /* open_hand has logged the reason, as for every error */
    }
    uint32_t hand = params[HAND] < 0.5 ? (uint32_t)MRT_LEFT : (uint32_t)MRT_RIGHT;
    for (uint32_t i = 0; i < CHANNELS; ++i) {
        mrt_channel channel = {name[i], "rad", MRT_CH_ANGLE + sensor[i], hand, 0.0f, 1.6f};
        self->channel[i] = channel;
    }
    self->sequence = 0;
    return MRT_OK;
}

static const mrt_channel *channels(mrt_plugin *self, uint32_t *out_count) /* [main] */
{
    *out_count = CHANNELS;
    return self->channel;
}

/* [input] Returns the next sample at its time, or an event. Waits through the host, never past the
 * deadline. */
static mrt_result read_hand(mrt_plugin *self, const double *params, int64_t deadline_ns,
                            mrt_sample *out)
{
    const mrt_host *host = self->host;
    if (self->sequence == 0)
        self->start_ns = host->now_ns(host);
    int64_t since_ns = (int64_t)self->sequence * PERIOD_NS;
    int64_t due_ns = self->start_ns + since_ns;
    if ((double)since_ns > 1e9 * params[SECONDS])
        return MRT_END;
    if (due_ns > deadline_ns) {
        host->wait_until_ns(host, deadline_ns);
        return MRT_TIMEOUT;
    }
    if (host->wait_until_ns(host, due_ns) < due_ns)
        return MRT_TIMEOUT; /* woken early: the host is stopping */
    double phase = (double)(since_ns % CYCLE_NS) / (double)CYCLE_NS;
    double way = phase < 0.5 ? 2.0 * phase : 2.0 - 2.0 * phase;
    float bend = (float)(way * way * (3.0 - 2.0 * way)); /* starts and stops softly */
    memset(out, 0, sizeof *out);
    out->time_ns = due_ns;
    out->sequence = self->sequence++;
    out->count = CHANNELS;
    for (uint32_t i = 0; i < CHANNELS; ++i)
        out->value[i] = (i % 2 == 0 ? 1.2f : 1.5f) * bend;
    return MRT_OK;
}

static void close_hand(mrt_plugin *self) /* as open */
{
    self->sequence = 0;
}

/* ---- what the host reads ---- */

/* clang-format off */
static const char *const hand_labels[] = {"Left", "Right", NULL};
static const mrt_param params[PARAM_COUNT] = {
    /* id (for ever), flags, name, group, unit, help, min, max, initial, labels */
    {1, 0, "Seconds", "Hand", "s", "Duration of the movement.", 0, 3600, 10, NULL},
    {2, MRT_PARAM_STEPPED, "Hand", "Hand", "",
     "Hand that is played. Read when the input is opened.",
     MRT_LEFT, MRT_RIGHT, MRT_RIGHT, hand_labels},
};
/* MRT_INPUT_RECORDED: it waits only through the host, so it can run faster than real time. The
 * input of a device uses 0 here. */
static const mrt_input input = {open_hand, channels, read_hand, close_hand, MRT_INPUT_RECORDED};
static const mrt_interface interfaces[] = {{MRT_INPUT, &input}, {NULL, NULL}};
static const mrt_plugin_type type = {
    MRT_ABI, PARAM_COUNT, params, interfaces,
    "org.example.template_name", "template_name", "1.0",
    "A hand that opens and closes.", create, destroy};
/* clang-format on */

const mrt_plugin_type *const marotte_plugins[] = {&type, NULL}; /* the only exported symbol */
