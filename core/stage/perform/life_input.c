#include "stage/perform/life_input.h"
#include "base/clock.h"
#include "stage/perform/life.h"

#include <stdlib.h>
#include <string.h>

static const int64_t period_ns = (int64_t)((double)NS_PER_S / LIFE_RATE_HZ);
static const int64_t late_most_ns = NS_PER_S / 4; /* after a longer pause the ticks begin anew */
static const int64_t ease_ns = NS_PER_S;          /* ticks go on after the strengths became 0 */
static const int64_t look_span_ns = 20 * NS_PER_MS;

struct mrt_plugin {
    const mrt_host *host;
    int64_t begin_ns, due_ns, rests_at_ns; /* rests_at_ns INT64_MAX: it lives */
    uint32_t sequence;
    bool has_begun, rests;
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

static mrt_result open_life(mrt_plugin *self, const char *address, const double *params)
{
    (void)params;
    if (address && address[0]) {
        self->host->log(self->host, MRT_LOG_ERROR, "life has no address: write life");
        return MRT_ERR_ARGUMENT;
    }
    self->has_begun = self->rests = false;
    return MRT_OK;
}

static void close_life(mrt_plugin *self)
{
    (void)self;
}

static const mrt_channel *channels(mrt_plugin *self, uint32_t *out_count)
{
    (void)self;
    *out_count = LIFE_CHANNELS;
    return life_channels();
}

static bool is_alive(const double *params)
{
    bool is_any = false;
    for (int i = 0; i < LIFE_KINDS; ++i)
        is_any |= params[i] > 0.0;
    return is_any;
}

/* Plans the next tick. Returns false while there is none. */
static bool plan(mrt_plugin *self, const double *params, int64_t now_ns)
{
    const bool lives = is_alive(params);
    if (!self->has_begun) { /* its first tick tells that it rests */
        self->begin_ns = self->due_ns = self->rests_at_ns = now_ns;
        self->has_begun = true;
    }
    if (self->rests && !lives)
        return false;
    if (self->rests || now_ns - self->due_ns > late_most_ns)
        self->due_ns = now_ns;
    self->rests = false;
    if (lives)
        self->rests_at_ns = INT64_MAX;
    else if (self->rests_at_ns == INT64_MAX)
        self->rests_at_ns = now_ns + ease_ns;
    return true;
}

static mrt_result read_life(mrt_plugin *self, const double *params, int64_t deadline_ns,
                            mrt_sample *out)
{
    const mrt_host *host = self->host;
    const int64_t now_ns = host->now_ns(host);
    if (!plan(self, params, now_ns)) {
        const int64_t until_ns =
            deadline_ns - now_ns > look_span_ns ? now_ns + look_span_ns : deadline_ns;
        host->wait_until_ns(host, until_ns);
        return MRT_TIMEOUT;
    }
    if (params[LIFE_PARAM_SECONDS] > 0.0 &&
        (double)(self->due_ns - self->begin_ns) > 1e9 * params[LIFE_PARAM_SECONDS])
        return MRT_END;
    if (self->due_ns > deadline_ns) {
        host->wait_until_ns(host, deadline_ns);
        return MRT_TIMEOUT;
    }
    if (host->wait_until_ns(host, self->due_ns) < self->due_ns)
        return MRT_TIMEOUT; /* the host is stopping */
    memset(out, 0, sizeof *out);
    out->time_ns = self->due_ns;
    out->sequence = self->sequence++;
    out->count = LIFE_CHANNELS;
    for (int i = 0; i <= LIFE_SEED; ++i)
        out->value[i] = (float)params[i];
    self->rests = self->due_ns >= self->rests_at_ns;
    self->due_ns += period_ns;
    return MRT_OK;
}

static int64_t get_ns(mrt_plugin *self, const double *params)
{
    (void)self;
    return params[LIFE_PARAM_SECONDS] > 0.0 ? (int64_t)(1e9 * params[LIFE_PARAM_SECONDS]) : -1;
}

static const mrt_param params[LIFE_PARAMS] = {
    [LIFE_BLINK] = {1, 0, "Blink", "Life", "",
                    "How often the face blinks: 11 to 19 times a minute.", 0, 1, 0.5, NULL},
    [LIFE_GAZE] = {2, 0, "Gaze", "Life", "",
                   "How far the eyes dart. They mostly look at the camera.", 0, 1, 0.5, NULL},
    [LIFE_BREATH] = {3, 0, "Breath", "Life", "", "How much the head moves as the face breathes.", 0,
                     1, 0.5, NULL},
    [LIFE_LEAN] = {4, 0, "Lean", "Life", "", "How much eyes and head lean into a turn of the head.",
                   0, 1, 0.5, NULL},
    [LIFE_SEED] = {5, MRT_PARAM_STEPPED, "Seed", "Life", "",
                   "Another number gives other moments of blinks and looks.", 0, LIFE_SEED_MOST, 1,
                   NULL},
    [LIFE_PARAM_SECONDS] = {6, MRT_PARAM_HIDDEN, "Seconds", "Life", "s",
                            "Length of this life. 0: endless.", 0, 1e6, 0, NULL}};
static const mrt_input functions = {open_life, channels, read_life, close_life, MRT_INPUT_RECORDED};
static const mrt_duration duration = {get_ns};
static const mrt_interface interfaces[] = {
    {MRT_INPUT, &functions}, {MRT_DURATION, &duration}, {NULL, NULL}};
const mrt_plugin_type life_input_type = {
    .abi = MRT_ABI,
    .param_count = LIFE_PARAMS,
    .params = params,
    .interfaces = interfaces,
    .id = LIFE_ID,
    .name = "Life",
    .version = "1.0",
    .about = "Blinks, looks around, breathes, and leans into turns.",
    .create = create,
    .destroy = destroy,
};
