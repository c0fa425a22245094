#include "window/app/input_opener.h"

#include "base/ring.h"
#include "stage/input/device_list.h"
#include "stage/mapping/plugins.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const uint32_t nothing = UINT32_MAX;

typedef struct opened { /* from the thread to [main] */
    input_opened what;
    uint32_t index; /* of the requests */
} opened;

typedef struct input_request {
    char text[INPUT_OPENER_TEXT];
    plugin_spec spec;
    const mrt_plugin_type *type; /* NULL: none; err has the reason */
    error err;
} input_request;

typedef struct opening_job { /* some inputs, one after the other, on a thread of their own */
    const plugin_list *plugins;
    log_queue *log;
    uint64_t number;
    input_request request[INPUT_OPENER_MAX]; /* entries that were reported do not change */
    uint32_t asked;
    uint32_t count; /* the thread's: with those that it found */
    bool looks_further;
    device_list found;
    ring *opened;
    _Atomic bool given_up[INPUT_OPENER_MAX], is_stopping, is_over;
    _Atomic uint32_t at; /* the request that is, or will be, opened next; or nothing */
    pthread_t thread;
} opening_job;

struct input_opener {
    const plugin_list *plugins;
    log_queue *log;
    uint64_t number; /* of the newest job */
    opening_job *job[INPUT_OPENINGS_MAX];
};

/* ---- the thread ---- */

static bool open_one(opening_job *self, uint32_t index)
{
    const input_request *of = &self->request[index];
    opened one = {.index = index, .what.err = of->err};
    memcpy(one.what.text, of->text, sizeof one.what.text);
    atomic_store(&self->at, index);
    if (of->type &&
        input_create_stoppable(&one.what.input, of->type, of->spec.address, of->spec.params,
                               CLOCK_REAL, self->log, &self->given_up[index], &one.what.err) < 0)
        one.what.input = NULL;
    if (!ring_push(self->opened, &one))
        input_destroy(one.what.input);
    atomic_store(&self->at, index + 1 < self->asked ? index + 1 : nothing);
    return one.what.input != NULL;
}

static void request_for(input_request *out, const device_found *found)
{
    (void)snprintf(out->text, sizeof out->text, "%.48s:%s", plugin_short_name(found->type),
                   found->device.address);
    if (plugin_spec_read(&out->spec, out->text))
        out->type = found->type;
    else
        (void)error_set(&out->err, MRT_ERR_MEMORY, "no memory for input %.200s", out->text);
}

static void open_what_is_ready(opening_job *self)
{
    error err = {0};
    if (device_list_scan(&self->found, self->plugins, self->log, NULL, &err) < 0) {
        log_push(self->log, MRT_LOG_WARNING, "devices", err.text);
        return;
    }
    for (uint32_t i = 0; i < self->found.count && !self->is_stopping; ++i) {
        const device_found *one = &self->found.one[i];
        if (one->device.state != MRT_DEVICE_READY || self->count == INPUT_OPENER_MAX)
            continue;
        request_for(&self->request[self->count], one);
        (void)open_one(self, self->count++);
    }
}

static void *run(void *data)
{
    opening_job *self = data;
    uint32_t open_count = 0;
    for (uint32_t i = 0; i < self->asked && !self->is_stopping; ++i)
        open_count += open_one(self, i);
    if (open_count == 0 && self->looks_further && !self->is_stopping)
        open_what_is_ready(self);
    atomic_store(&self->is_over, true);
    return NULL;
}

/* ---- a job ---- */

static void free_job(opening_job *job)
{
    opened left;
    while (job->opened && ring_pop(job->opened, &left))
        input_destroy(left.what.input);
    ring_destroy(job->opened);
    for (uint32_t i = 0; i < INPUT_OPENER_MAX; ++i)
        plugin_spec_finish(&job->request[i].spec);
    free(job);
}

static void read_request(input_request *out, const plugin_list *plugins, const char *text)
{
    mrt_result result = MRT_OK;
    (void)snprintf(out->text, sizeof out->text, "%s", text);
    if (!plugin_spec_read(&out->spec, text))
        result = error_set(&out->err, MRT_ERR_ARGUMENT,
                           "\"%.200s\" is not PLUGIN[:ADDRESS][,key=value]", text);
    if (result >= 0)
        result = plugin_list_find(plugins, out->spec.plugin, MRT_INPUT, &out->type, &out->err);
    if (result < 0)
        out->type = NULL;
}

static opening_job *start_job(input_opener *self, const char *const *texts, uint32_t count,
                              bool looks_further)
{
    opening_job *job = calloc(1, sizeof *job);
    if (!job)
        return NULL;
    job->plugins = self->plugins;
    job->log = self->log;
    job->number = ++self->number;
    atomic_init(&job->at, count ? 0 : nothing);
    job->asked = job->count = count < INPUT_OPENER_MAX ? count : INPUT_OPENER_MAX;
    for (uint32_t i = 0; i < job->asked; ++i)
        read_request(&job->request[i], self->plugins, texts[i]);
    job->looks_further = looks_further;
    job->opened = ring_create(sizeof(opened), INPUT_OPENER_MAX);
    if (job->opened && pthread_create(&job->thread, NULL, run, job) == 0)
        return job;
    free_job(job);
    return NULL;
}

static void stop_job(opening_job *job)
{
    atomic_store(&job->is_stopping, true);
    for (uint32_t i = 0; i < INPUT_OPENER_MAX; ++i)
        atomic_store(&job->given_up[i], true);
}

static void end_job(opening_job *job)
{
    (void)pthread_join(job->thread, NULL);
    free_job(job);
}

/* The next opened input. Closes cancelled ones. */
static bool peek(opening_job *job, opened *out)
{
    while (ring_peek(job->opened, out)) {
        if (!job->given_up[out->index])
            return true;
        (void)ring_pop(job->opened, out);
        input_destroy(out->what.input);
    }
    return false;
}

/* Whether all that is still wanted of the job has been taken. One that was given up may still hang.
 */
static bool is_done(opening_job *job)
{
    opened next;
    const bool is_over = job->is_over; /* before the last look */
    const uint32_t at = job->at;
    if (peek(job, &next))
        return false;
    return is_over || (!job->looks_further && at + 1 == job->asked && job->given_up[at]);
}

/* ---- all of them ---- */

static const uint64_t job_stride = 2 * INPUT_OPENER_MAX; /* more than a job has texts */

input_opener *input_opener_create(const plugin_list *plugins, log_queue *log)
{
    input_opener *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->plugins = plugins;
    self->log = log;
    return self;
}

void input_opener_destroy(input_opener *self)
{
    if (!self)
        return;
    for (uint32_t i = 0; i < INPUT_OPENINGS_MAX; ++i)
        if (self->job[i])
            stop_job(self->job[i]);
    for (uint32_t i = 0; i < INPUT_OPENINGS_MAX; ++i)
        if (self->job[i])
            end_job(self->job[i]);
    free(self);
}

mrt_result input_opener_open(input_opener *self, const char *const *texts, uint32_t count,
                             bool looks_further, error *err)
{
    for (uint32_t i = 0; i < INPUT_OPENINGS_MAX; ++i) {
        if (self->job[i])
            continue;
        self->job[i] = start_job(self, texts, count, looks_further);
        return self->job[i] ? MRT_OK : error_set(err, MRT_ERR_MEMORY, "no memory for an input");
    }
    return error_set(err, MRT_ERR_UNSUPPORTED,
                     "%d inputs are being opened: wait for one of them, or cancel it",
                     INPUT_OPENINGS_MAX);
}

bool input_opener_take(input_opener *self, input_opened *out)
{
    opened one;
    for (uint32_t i = 0; i < INPUT_OPENINGS_MAX; ++i) {
        opening_job *job = self->job[i];
        if (!job)
            continue;
        const bool is_over = job->is_over; /* before the last look */
        if (peek(job, &one)) {
            (void)ring_pop(job->opened, &one);
            *out = one.what;
            return true;
        }
        if (!is_over)
            continue;
        end_job(job);
        self->job[i] = NULL;
    }
    return false;
}

bool input_opener_are_done(input_opener *self)
{
    bool are_done = true;
    for (uint32_t i = 0; i < INPUT_OPENINGS_MAX; ++i)
        are_done = are_done && (!self->job[i] || is_done(self->job[i]));
    return are_done;
}

static void name_opening(input_opening *out, const input_request *of)
{
    memcpy(out->text, of->text, sizeof out->text);
    if (of->type)
        input_name_of(out->name, of->type, of->spec.address);
    else
        (void)snprintf(out->name, sizeof out->name, "%.*s", INPUT_NAME - 1, of->text);
}

static uint32_t list(opening_job *job, input_opening out[2])
{
    opened next;
    uint32_t count = 0;
    if (peek(job, &next)) {
        out[count] = (input_opening){.id = job->number * job_stride + next.index, .is_open = true};
        name_opening(&out[count++], &job->request[next.index]);
    }
    const uint32_t at = job->at;
    if (at == nothing || job->given_up[at])
        return count;
    out[count] = (input_opening){.id = job->number * job_stride + at};
    name_opening(&out[count++], &job->request[at]);
    return count;
}

uint32_t input_opener_going(input_opener *self, input_opening out[INPUT_OPENINGS_MAX])
{
    input_opening of_job[2];
    uint32_t count = 0;
    for (uint32_t i = 0; i < INPUT_OPENINGS_MAX; ++i) {
        const uint32_t found = self->job[i] ? list(self->job[i], of_job) : 0;
        for (uint32_t k = 0; k < found && count < INPUT_OPENINGS_MAX; ++k)
            out[count++] = of_job[k];
    }
    return count;
}

void input_opener_give_up(input_opener *self, uint64_t id)
{
    const uint64_t index = id % job_stride;
    for (uint32_t i = 0; i < INPUT_OPENINGS_MAX; ++i)
        if (self->job[i] && self->job[i]->number == id / job_stride && index < INPUT_OPENER_MAX)
            atomic_store(&self->job[i]->given_up[index], true);
}
