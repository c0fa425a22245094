/* A mapping that follows five fingertips, keeps all rules, and goes wrong when its parameter
 * Trouble says so. Built once more with TROUBLED_LATER as a later version of itself. */
#include <marotte/plugin.h>

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { GAIN, TROUBLE, EXTRA, PARAM_COUNT };
enum { NONE, CRASH, HANG, SLOW, SLEEP, NONSENSE, LEAVE, REFUSE, STUCK };
enum { TIPS = 5, SLOW_MS = 30 }; /* less than a turn that a hang is told by, isolate.c */

struct mrt_plugin {
    const mrt_host *host;
    mrt_vec3 anchor[TIPS];
    bool is_anchored;
    float taught; /* MRT_STATE */
};

static mrt_plugin *create(const mrt_host *host)
{
#ifdef TROUBLED_REFUSES
    host->log(host, MRT_LOG_ERROR, "no licence for this machine");
    return NULL;
#else
    mrt_plugin *self = calloc(1, sizeof *self);
    if (self)
        self->host = host;
    return self;
#endif
}

static void destroy(mrt_plugin *self)
{
    free(self);
}

static mrt_result activate(mrt_plugin *self, const mrt_face *face)
{
    char text[128];
    (void)snprintf(text, sizeof text, "active on %u contacts, the first on \"%s\"",
                   face->contact_count, face->contact_count ? face->contacts[0].bone : "");
    self->host->log(self->host, MRT_LOG_DEBUG, text);
    return MRT_OK;
}

static void deactivate(mrt_plugin *self)
{
    (void)self;
}

static void reset(mrt_plugin *self)
{
    self->is_anchored = false;
}

static void spin(double ms)
{
    clock_t end = clock() + (clock_t)(ms * 1e-3 * CLOCKS_PER_SEC);
    while (clock() < end)
        ;
}

static void be_trouble(int kind)
{
    static volatile int turning = 1;
    if (kind == CRASH)
        (void)raise(SIGSEGV);
    while (kind == HANG && turning)
        ;
    if (kind == SLOW)
        spin(SLOW_MS);
    if (kind == SLEEP)
        (void)usleep(SLOW_MS * 1000);
    while (kind == STUCK)
        (void)pause();
    if (kind == LEAVE)
        _exit(3);
}

static mrt_result process(mrt_plugin *self, const mrt_frame *frame, mrt_pull *pull)
{
    const mrt_hand *hand = &frame->hand[MRT_RIGHT];
    int trouble = (int)frame->params[TROUBLE];
#ifdef TROUBLED_ALWAYS
    trouble = NONSENSE;
#endif
    be_trouble(trouble);
    if (trouble == REFUSE)
        return MRT_ERR_IO;
    if (!hand->present)
        return MRT_HOLD;
    float gain = (float)frame->params[GAIN];
    if (!self->is_anchored)
        pull->anchor += 1;
    pull->mode = MRT_ANCHORED;
    pull->radius_mm = 60.0f;
    pull->count = TIPS;
    for (int i = 0; i < TIPS; ++i) {
        mrt_vec3 tip = hand->joint[4 * (i + 1)];
        if (!self->is_anchored)
            self->anchor[i] = tip;
        mrt_vec3 start = {(float)(i - 2) * 28.0f, 60.0f + (float)(i % 2) * 40.0f, 50.0f};
        pull->vector[i] = (mrt_vector){start,
                                       {start.x + gain * (tip.x - self->anchor[i].x),
                                        start.y + gain * (tip.y - self->anchor[i].y),
                                        start.z + gain * (tip.z - self->anchor[i].z)},
                                       0};
    }
    self->is_anchored = true;
    if (trouble == NONSENSE)
        pull->vector[2].end.y = NAN;
    return MRT_OK;
}

static size_t save_anchor(mrt_plugin *self, void *out, size_t capacity)
{
    unsigned char bytes[sizeof self->anchor + 1];
    memcpy(bytes, self->anchor, sizeof self->anchor);
    bytes[sizeof bytes - 1] = self->is_anchored;
    if (out)
        memcpy(out, bytes, capacity < sizeof bytes ? capacity : sizeof bytes);
    return sizeof bytes;
}

static mrt_result load_anchor(mrt_plugin *self, const void *bytes, size_t size)
{
    const unsigned char *from = bytes;
    if (size != sizeof self->anchor + 1 || from[size - 1] > 1)
        return MRT_ERR_FORMAT;
    memcpy(self->anchor, from, sizeof self->anchor);
    self->is_anchored = from[size - 1] == 1;
    return MRT_OK;
}

static size_t save_taught(mrt_plugin *self, void *out, size_t capacity)
{
    if (out && capacity >= sizeof self->taught)
        memcpy(out, &self->taught, sizeof self->taught);
    return sizeof self->taught;
}

static mrt_result load_taught(mrt_plugin *self, const void *bytes, size_t size)
{
    if (size != sizeof self->taught)
        return MRT_ERR_FORMAT;
    memcpy(&self->taught, bytes, size);
    return MRT_OK;
}

static const char *const troubles[] = {"None",     "Crash", "Hang",   "Slow",  "Sleep",
                                       "Nonsense", "Leave", "Refuse", "Stuck", NULL};
static const mrt_param params[PARAM_COUNT] = {
    {1, 0, "Gain", "Pull", "", "How far the points move when a fingertip moves by 1.", 0, 4, 0.4,
     NULL},
    {2, MRT_PARAM_STEPPED, "Trouble", "Test", "", "What goes wrong from the next frame on.", 0, 8,
     0, troubles},
#ifdef TROUBLED_LATER
    {4, 0, "Later", "Pull", "", "What only the later version has.", 0, 1, 0.5, NULL},
#else
    {3, 0, "Early", "Pull", "", "What the later version has no more.", 0, 1, 0.5, NULL},
#endif
};
static const mrt_mapping mapping = {activate, deactivate, reset, process};
static const mrt_resume resume = {save_anchor, load_anchor};
static const mrt_state state = {save_taught, load_taught};
static const mrt_interface interfaces[] = {
    {MRT_MAPPING, &mapping}, {MRT_RESUME, &resume}, {MRT_STATE, &state}, {NULL, NULL}};

static const mrt_plugin_type troubled = {MRT_ABI,
                                         PARAM_COUNT,
                                         params,
                                         interfaces,
                                         "org.example.troubled",
                                         "Troubled",
#ifdef TROUBLED_LATER
                                         "2",
#else
                                         "1",
#endif
                                         "Follows five fingertips, until it is told otherwise.",
                                         create,
                                         destroy};
MRT_EXPORT const mrt_plugin_type *const marotte_plugins[] = {&troubled, NULL};
