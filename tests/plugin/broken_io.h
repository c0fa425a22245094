/* broken_io.h - the input, the outputs and the list of devices of broken.c, which includes it. The
 * input is a record of 200 samples, 10 ms apart. */
#ifndef TESTS_PLUGIN_BROKEN_IO_H
#define TESTS_PLUGIN_BROKEN_IO_H

enum { RECORD_SAMPLES = 200, RECORD_STEP_NS = 10000000 };

/* ---- the input ---- */

static mrt_result open_input(mrt_plugin *self, const char *address, const double *values)
{
    (void)values;
    if (address[0] == '/')
        return refuse(self, MRT_ERR_IO,
                      BREAKS(INPUT_ABSENT) ? "error 5" : "there is no such record: name another");
    self->open_count += 1;
    if (BREAKS(INPUT_REOPEN) && self->open_count > 1)
        return refuse(self, MRT_ERR_IO, "it was open once, that is enough");
    if (BREAKS(INPUT_GROWTH))
        kept = malloc(400);
    self->sequence = 0;
    self->start_ns = self->next_ns = self->host->now_ns(self->host);
    self->is_open = true;
    return MRT_OK;
}

static const mrt_channel *channels(mrt_plugin *self, uint32_t *out_count)
{
    (void)self;
    static const mrt_channel channel[] = {
        {"thumb", "rad", BREAKS(INPUT_CHANNELS) ? 999 : MRT_CH_ANGLE, MRT_RIGHT, -3, 3}};
    *out_count = 1;
    return channel;
}

static void wait_until(const mrt_plugin *self, int64_t time_ns)
{
    const mrt_host *host = self->host;
    while (BREAKS(INPUT_SPIN) && host->now_ns(host) < time_ns)
        burn(10);
    do
        host->wait_until_ns(host, time_ns);
    while (BREAKS(INPUT_STOP) && host->now_ns(host) < time_ns);
}

static void fill(mrt_plugin *self, mrt_sample *out)
{
    uint32_t number = self->sequence++;
    *out = (mrt_sample){.time_ns = self->next_ns,
                        .sequence = BREAKS(INPUT_ORDER) && number == 50 ? 7 : number,
                        .count = BREAKS(INPUT_COUNT) ? 2 : 1,
                        .value = {0.001f * (float)number}};
    if (BREAKS(INPUT_FINITE) && number == 50)
        out->value[0] = NAN;
    if (BREAKS(INPUT_FUTURE))
        out->time_ns += RECORD_STEP_NS;
    if (BREAKS(INPUT_RECORDED))
        out->value[0] = (float)(self->host->now_ns(self->host) - self->start_ns);
    self->next_ns += RECORD_STEP_NS;
}

static mrt_result read_input(mrt_plugin *self, const double *values, int64_t deadline_ns,
                             mrt_sample *out)
{
    (void)values;
    if (self->sequence == RECORD_SAMPLES)
        return MRT_END;
    if (BREAKS(INPUT_RESULT) && self->sequence == 50)
        return 7;
    if (BREAKS(INPUT_TIMEOUT) && self->next_ns > deadline_ns)
        return MRT_TIMEOUT;
    bool is_due = BREAKS(INPUT_DEADLINE) || (self->next_ns <= deadline_ns && !BREAKS(INPUT_SPIN));
    wait_until(self, is_due ? self->next_ns : deadline_ns);
    if (!is_due)
        return MRT_TIMEOUT;
    fill(self, out);
    return MRT_OK;
}

static void close_input(mrt_plugin *self)
{
    self->is_open = false;
}

static const mrt_input input = {open_input, channels, read_input, close_input,
                                BREAKS(INPUT_SPIN) ? 0 : MRT_INPUT_RECORDED};

/* ---- devices ---- */

static uint32_t list(mrt_plugin *self, mrt_device *out, uint32_t capacity)
{
    (void)self;
    if (capacity > 0 || BREAKS(DEVICES_LIST))
        out[0] = (mrt_device){.address = "record", .name = "A record", .state = MRT_DEVICE_READY};
    return 1;
}

static bool current(mrt_plugin *self, mrt_device *out)
{
    *out = (mrt_device){.address = "record", .name = "A record", .state = MRT_DEVICE_READY};
    return self->is_open || BREAKS(DEVICES_CURRENT);
}

static const mrt_devices devices = {list, current};

/* ---- the output ---- */

static mrt_result open_output(mrt_plugin *self, const char *address, const double *values)
{
    (void)values;
    if (strchr(address, ' '))
        return refuse(self, MRT_ERR_ARGUMENT,
                      BREAKS(OUTPUT_ABSENT) ? "no" : "an address has no blanks: write HOST:PORT");
    self->open_count += 1;
    if (BREAKS(OUTPUT_REOPEN) && self->open_count > 1)
        return refuse(self, MRT_ERR_IO, "it was open once, that is enough");
    return MRT_OK;
}

static mrt_result write_output(mrt_plugin *self, const char *source, const mrt_channel *of,
                               const mrt_sample *sample)
{
    struct timespec span = {0, 1000};
    (void)source;
    (void)of;
    if (BREAKS(OUTPUT_WAIT))
        nanosleep(&span, NULL);
    if (BREAKS(OUTPUT_WRITE) && sample->sequence == 50)
        return refuse(self, MRT_ERR_IO, "nobody listens");
    return MRT_OK;
}

static void close_output(mrt_plugin *self)
{
    (void)self;
}

static const mrt_output output = {open_output, write_output, close_output};

/* ---- the face output ---- */

static mrt_result open_face(mrt_plugin *self, const char *address, const double *values,
                            mrt_face_wants *wants)
{
    (void)values;
    wants->vertices = 1;
    if (strchr(address, ' '))
        return refuse(self, MRT_ERR_ARGUMENT,
                      BREAKS(FACE_OUTPUT_ABSENT) ? "no"
                                                 : "an address has no blanks: write HOST:PORT");
    self->open_count += 1;
    if (BREAKS(FACE_OUTPUT_REOPEN) && self->open_count > 1)
        return refuse(self, MRT_ERR_IO, "it was open once, that is enough");
    return MRT_OK;
}

static mrt_result begin_face(mrt_plugin *self, const mrt_face_names *names)
{
    if (BREAKS(FACE_OUTPUT_FACES) && names->bone_count == 0)
        return refuse(self, MRT_ERR_UNSUPPORTED, "a face without bones is none");
    return MRT_OK;
}

static mrt_result send_face(mrt_plugin *self, const double *values, const mrt_face_sample *sample)
{
    struct timespec span = {0, 30000000};
    (void)values;
    if (BREAKS(FACE_OUTPUT_TIME))
        nanosleep(&span, NULL);
    if (BREAKS(FACE_OUTPUT_SEND) && sample->number == 50)
        return refuse(self, MRT_ERR_IO, "nobody listens");
    return MRT_OK;
}

static void close_face(mrt_plugin *self)
{
    (void)self;
}

static const mrt_face_output face_output = {open_face, begin_face, send_face, close_face};

#endif
