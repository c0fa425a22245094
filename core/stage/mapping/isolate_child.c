/* marotte-pluginhost LIBRARY TYPE - runs one mapping or face output in its own process. It executes
 * the requests in the shared memory at ISOLATE_FD. stage/mapping/isolate_process.c starts it; it is
 * not for direct use. It ends with the program that started it. */
#include "base/program.h"
#include "base/clock.h"
#include "stage/mapping/isolate_wire.h"
#include "stage/mapping/plugins.h"
#include "stage/mapping/services.h"

#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

static const rlim_t memory_bytes = (rlim_t)2 << 30;
enum { FILES_MAX = 64 };

typedef struct child {
    const mrt_plugin_type *type; /* must be first, see services.h */
    isolate_block *block;
    const mrt_mapping *mapping;
    const mrt_rig_poses *rig_poses;
    const mrt_state *state;
    const mrt_resume *resume;
    const mrt_face_output *output;
    mrt_plugin *self;
    mrt_host host;
    isolate_mapped mapped;
    isolate_names names; /* names of the face that the output received last */
    float *value;        /* values of a sample of that face */
    bool is_active;
} child;

/* ---- host functions for the plugin ---- */

static void log_line(isolate_block *block, int32_t level, const char *text)
{
    uint32_t at = atomic_load(&block->log_count);
    isolate_log *line = &block->log[at % ISOLATE_LOGS];
    line->level = level;
    (void)snprintf(line->text, sizeof line->text, "%s", text);
    atomic_store(&block->log_count, at + 1);
}

static void host_log(const mrt_host *host, int32_t level, const char *text)
{
    const child *self = host->data;
    log_line(self->block, level, text);
}

static int64_t host_now_ns(const mrt_host *host)
{
    (void)host;
    return clock_now_ns();
}

static int64_t host_wait_until_ns(const mrt_host *host, int64_t time_ns)
{
    (void)host;
    clock_sleep_until_ns(time_ns);
    return clock_now_ns();
}

static void host_request_restart(const mrt_host *host)
{
    host_log(host, MRT_LOG_WARNING, "requests a restart");
}

static const void *host_service(const mrt_host *host, const char *id)
{
    (void)host;
    return strcmp(id, MRT_FOLDERS) == 0 ? &services_folders : NULL;
}

/* ---- the plugin ---- */

static const void *interface_of(const mrt_plugin_type *type, const char *id)
{
    for (const mrt_interface *i = type->interfaces; i && i->id; ++i)
        if (strcmp(i->id, id) == 0)
            return i->functions;
    return NULL;
}

static bool find_type(child *self, const char *path, const char *id)
{
    error err = {""};
    const mrt_plugin_type *const *types = plugin_library_open(path, &err);
    for (; types && *types && (*types)->abi == MRT_ABI; ++types)
        if (strcmp((*types)->id, id) == 0 &&
            (interface_of(*types, MRT_MAPPING) || interface_of(*types, MRT_FACE_OUTPUT)))
            self->type = *types;
    if (!self->type)
        log_line(self->block, MRT_LOG_ERROR,
                 err.text[0] ? err.text : "the library has changed: the type no longer exists");
    return self->type != NULL;
}

static mrt_result create(child *self)
{
    self->mapping = interface_of(self->type, MRT_MAPPING);
    self->rig_poses = interface_of(self->type, MRT_RIG_POSES);
    self->state = interface_of(self->type, MRT_STATE);
    self->resume = interface_of(self->type, MRT_RESUME);
    self->output = interface_of(self->type, MRT_FACE_OUTPUT);
    self->host = (mrt_host){
        self, host_log, host_now_ns, host_wait_until_ns, host_request_restart, host_service};
    self->block->param_count = self->type->param_count;
    self->block->param_sum = isolate_param_sum(self->type);
    self->self = self->type->create(&self->host);
    return self->self ? MRT_OK : MRT_ERR_UNSUPPORTED;
}

static void deactivate(child *self)
{
    if (self->is_active)
        self->mapping->deactivate(self->self);
    self->is_active = false;
    isolate_mapped_finish(&self->mapped);
}

static mrt_result activate(child *self)
{
    deactivate(self);
    isolate_mapped *mapped = &self->mapped;
    mrt_result result = isolate_mapped_read(mapped, self->block->bytes, self->block->size);
    const mrt_face *face = &mapped->face.face;
    if (result >= 0 && self->rig_poses)
        self->rig_poses->set(self->self, face, mapped->pose, mapped->pose_count);
    if (result >= 0)
        result = self->mapping->activate(self->self, face);
    self->is_active = result >= 0;
    return result;
}

static uint32_t save(child *self, size_t (*save_bytes)(mrt_plugin *, void *, size_t))
{
    size_t size = save_bytes(self->self, self->block->bytes, ISOLATE_BYTES);
    return size <= ISOLATE_BYTES ? (uint32_t)size : 0;
}

static mrt_result process(child *self)
{
    isolate_block *block = self->block;
    if (!self->is_active)
        return MRT_ERR_ARGUMENT;
    mrt_channels inputs[MRT_MAX_INPUTS];
    block->frame.params = block->params;
    isolate_inputs_read(block, inputs);
    mrt_result result = self->mapping->process(self->self, &block->frame, &block->pull);
    if (block->with_resume && self->resume)
        block->size = save(self, self->resume->save);
    else
        block->with_resume = 0;
    return result;
}

/* ---- a face output ---- */

static void forget_names(child *self)
{
    isolate_names_finish(&self->names);
    free(self->value);
    self->value = NULL;
}

static mrt_result begin(child *self)
{
    isolate_names old = self->names; /* the plugin uses them until it receives the new ones */
    mrt_result result = isolate_names_read(&self->names, self->block->bytes, self->block->size);
    float *value = result < 0
                       ? NULL
                       : calloc(isolate_sample_floats(&self->names.names, true) + 1, sizeof *value);
    if (result >= 0 && !value)
        result = MRT_ERR_MEMORY;
    if (result >= 0)
        result = self->output->begin(self->self, &self->names.names);
    isolate_names_finish(&old);
    free(self->value);
    self->value = value;
    return result;
}

static mrt_result send_sample(child *self)
{
    const isolate_block *block = self->block;
    mrt_face_sample sample = {0};
    if (!self->value)
        return MRT_ERR_ARGUMENT;
    mrt_result result =
        isolate_sample_read(&sample, self->value, &self->names.names, block->bytes, block->size);
    return result < 0 ? result : self->output->send(self->self, block->params, &sample);
}

static mrt_result answer_output(child *self)
{
    isolate_block *block = self->block;
    switch (block->kind) {
    case ISOLATE_OUTPUT_OPEN:
        block->wants = (mrt_face_wants){0};
        block->bytes[ISOLATE_BYTES - 1] = '\0';
        return self->output->open(self->self, (const char *)block->bytes, block->params,
                                  &block->wants);
    case ISOLATE_OUTPUT_BEGIN:
        return begin(self);
    case ISOLATE_OUTPUT_SEND:
        return send_sample(self);
    default:
        self->output->close(self->self);
        forget_names(self);
        return MRT_OK;
    }
}

static mrt_result answer(child *self)
{
    isolate_block *block = self->block;
    if (!self->self && block->kind != ISOLATE_CREATE)
        return MRT_ERR_ARGUMENT;
    if (block->kind >= ISOLATE_OUTPUT_OPEN && block->kind <= ISOLATE_OUTPUT_CLOSE)
        return self->output ? answer_output(self) : MRT_ERR_UNSUPPORTED;
    if (!self->mapping && block->kind != ISOLATE_CREATE && block->kind != ISOLATE_DESTROY)
        return MRT_ERR_UNSUPPORTED;
    switch (block->kind) {
    case ISOLATE_CREATE:
        return create(self);
    case ISOLATE_DESTROY:
        deactivate(self);
        self->type->destroy(self->self);
        return MRT_OK;
    case ISOLATE_ACTIVATE:
        return activate(self);
    case ISOLATE_DEACTIVATE:
        deactivate(self);
        return MRT_OK;
    case ISOLATE_RESET:
        self->mapping->reset(self->self);
        return MRT_OK;
    case ISOLATE_PROCESS:
        return process(self);
    case ISOLATE_STATE_SAVE:
        block->size = self->state ? save(self, self->state->save) : 0;
        return MRT_OK;
    case ISOLATE_STATE_LOAD:
        return self->state ? self->state->load(self->self, block->bytes, block->size)
                           : MRT_ERR_UNSUPPORTED;
    case ISOLATE_RESUME_SAVE:
        block->size = self->resume ? save(self, self->resume->save) : 0;
        return MRT_OK;
    case ISOLATE_RESUME_LOAD:
        return self->resume ? self->resume->load(self->self, block->bytes, block->size)
                            : MRT_ERR_UNSUPPORTED;
    default:
        return MRT_ERR_ARGUMENT;
    }
}

/* ---- the process ---- */

/* The process dies with the thread that started it. It inherits only the block and stderr. */
static void confine(void)
{
    (void)prctl(PR_SET_PDEATHSIG, SIGKILL);
    program_limit(RLIMIT_CORE, 0, 0);
    program_limit(RLIMIT_NOFILE, FILES_MAX, FILES_MAX);
    program_limit(RLIMIT_DATA, memory_bytes, memory_bytes);
    (void)syscall(__NR_close_range, (unsigned)ISOLATE_FD + 1, ~0u, 0u);
}

static isolate_block *map_block(void)
{
    struct stat status;
    if (fstat(ISOLATE_FD, &status) != 0 || (size_t)status.st_size < sizeof(isolate_block))
        return NULL;
    void *at = mmap(NULL, sizeof(isolate_block), PROT_READ | PROT_WRITE, MAP_SHARED, ISOLATE_FD, 0);
    (void)close(ISOLATE_FD);
    return at == MAP_FAILED ? NULL : at;
}

static void serve(child *self)
{
    isolate_block *block = self->block;
    uint32_t done = 0;
    for (;;) {
        uint32_t asked = atomic_load(&block->asked);
        if (asked == done) {
            atomic_store(&block->child_waits, 1);
            isolate_sleep_until_ns(&block->asked, done, INT64_MAX);
            atomic_store(&block->child_waits, 0);
            continue;
        }
        done = asked;
        block->result = answer(self);
        bool is_last = block->kind == ISOLATE_DESTROY;
        atomic_store(&block->answered, done);
        if (atomic_load(&block->program_waits))
            isolate_wake(&block->answered);
        if (is_last)
            return;
    }
}

int main(int argument_count, char **arguments)
{
    confine();
    child self = {.block = map_block()};
    if (argument_count != 3 || !self.block || self.block->version != ISOLATE_VERSION) {
        (void)fprintf(stderr, "marotte-pluginhost is started by marotte: see marotte help\n");
        return 2;
    }
    if (getppid() != self.block->program_pid)
        return 1; /* the program ended before PR_SET_PDEATHSIG took effect */
    if (!find_type(&self, arguments[1], arguments[2]))
        return 1;
    serve(&self);
    return 0;
}
