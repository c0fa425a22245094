#include "stage/mapping/isolate_output.h"
#include "base/clock.h"
#include "stage/mapping/instance.h"
#include "stage/mapping/isolate_process.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const int64_t start_patience_ns = 5 * NS_PER_S, hang_ns = NS_PER_S;
enum { DEATH_MS = 20 };

struct mrt_plugin {
    const mrt_host *host;
    const isolate_outer *of;
    isolate_process link; /* block NULL: no process */
    isolate_names names;  /* names that the process has received */
    bool is_large_logged;
};

/* Ends the process and logs why it did not answer. */
static mrt_result give_up(mrt_plugin *self, const char *otherwise)
{
    error how = {""}, text = {""};
    bool has_ended = isolate_process_has_ended(&self->link, DEATH_MS);
    isolate_process_drain(&self->link, self->host);
    isolate_process_end(&self->link, &how);
    isolate_process_finish(&self->link);
    (void)error_set(&text, MRT_ERR_IO, "its process %s", has_ended ? how.text : otherwise);
    self->host->log(self->host, MRT_LOG_ERROR, text.text);
    return MRT_ERR_IO;
}

/* MRT_ERR_IO without a process: it crashed or hung, and is ended. */
static mrt_result call(mrt_plugin *self, uint32_t kind, int64_t patience_ns)
{
    mrt_result result = isolate_process_call(&self->link, kind, patience_ns);
    const isolate_block *block = self->link.block;
    if (result == MRT_ERR_IO && atomic_load(&block->answered) != atomic_load(&block->asked))
        return give_up(self, "hangs");
    isolate_process_drain(&self->link, self->host);
    return result;
}

static void write_params(mrt_plugin *self, const double *params)
{
    memcpy(self->link.block->params, params,
           self->of->inner->param_count * sizeof *self->link.block->params);
}

static mrt_result start(mrt_plugin *self)
{
    error err = {""};
    mrt_result result =
        isolate_process_start(&self->link, self->of->library, self->of->inner->id, &err);
    if (result < 0) {
        self->host->log(self->host, MRT_LOG_ERROR, err.text);
        return result;
    }
    result = call(self, ISOLATE_CREATE, start_patience_ns);
    if (result < 0 || isolate_is_table_of(self->link.block, self->of->inner))
        return result;
    self->host->log(
        self->host, MRT_LOG_ERROR,
        "its library has changed: the parameters are different. Open the output again.");
    return MRT_ERR_FORMAT;
}

static void end(mrt_plugin *self)
{
    isolate_process_end(&self->link, NULL);
    isolate_process_finish(&self->link);
    isolate_names_finish(&self->names);
}

/* ---- the interface ---- */

static mrt_result open(mrt_plugin *self, const char *address, const double *params,
                       mrt_face_wants *wants)
{
    end(self);
    size_t size = strlen(address) + 1;
    mrt_result result = size > ISOLATE_BYTES ? MRT_ERR_ARGUMENT : start(self);
    if (result < 0)
        return result;
    memcpy(self->link.block->bytes, address, size);
    write_params(self, params);
    result = call(self, ISOLATE_OUTPUT_OPEN, start_patience_ns);
    if (self->link.block)
        *wants = self->link.block->wants;
    return result;
}

static mrt_result begin(mrt_plugin *self, const mrt_face_names *names)
{
    if (!self->link.block)
        return MRT_ERR_IO;
    isolate_block *block = self->link.block;
    size_t size = isolate_names_write(block->bytes, ISOLATE_BYTES, names);
    isolate_names_finish(&self->names);
    if (size > ISOLATE_BYTES || isolate_names_read(&self->names, block->bytes, size) < 0) {
        self->host->log(self->host, MRT_LOG_ERROR, "the face has too many names");
        return MRT_ERR_UNSUPPORTED;
    }
    block->size = (uint32_t)size;
    return call(self, ISOLATE_OUTPUT_BEGIN, start_patience_ns);
}

static mrt_result send(mrt_plugin *self, const double *params, const mrt_face_sample *sample)
{
    if (!self->link.block)
        return MRT_ERR_IO;
    isolate_block *block = self->link.block;
    mrt_face_sample as = *sample;
    size_t size = isolate_sample_write(block->bytes, ISOLATE_BYTES, &self->names.names, &as);
    if (size > ISOLATE_BYTES) {
        if (!self->is_large_logged)
            self->host->log(self->host, MRT_LOG_WARNING,
                            "the face has too many vertices for an isolated output: they are not "
                            "sent");
        self->is_large_logged = true;
        as.vertices = NULL;
        size = isolate_sample_write(block->bytes, ISOLATE_BYTES, &self->names.names, &as);
    }
    block->size = (uint32_t)size;
    write_params(self, params);
    return call(self, ISOLATE_OUTPUT_SEND, hang_ns);
}

static void close(mrt_plugin *self)
{
    if (self->link.block && call(self, ISOLATE_OUTPUT_CLOSE, hang_ns) >= 0)
        (void)call(self, ISOLATE_DESTROY, hang_ns);
    end(self);
}

/* ---- create and destroy ---- */

mrt_plugin *isolate_output_make(const mrt_host *host)
{
    const instance *made = host->data; /* the host is always one of the program */
    mrt_plugin *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->host = host;
    self->of = (const isolate_outer *)(const void *)made->type;
    self->link.pidfd = -1;
    return self;
}

void isolate_output_unmake(mrt_plugin *self)
{
    if (!self)
        return;
    end(self);
    free(self);
}

const mrt_face_output isolate_output_functions = {open, begin, send, close};
