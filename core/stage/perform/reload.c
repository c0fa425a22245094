#include "stage/perform/reload.h"
#include "base/clock.h"
#include "base/file.h"
#include "check/check.h"
#include "stage/mapping/plugins.h"
#include "stage/mapping/guard.h"
#include "show/hash.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Interval between two checks of the file. The file is complete if it did not change in between. */
static const int64_t poll_span_ns = 20 * NS_PER_MS;
/* Interval at which the loader thread polls the frame thread. */
static const int64_t wait_span_ns = 2 * NS_PER_MS;
static const int64_t answer_patience_ns = 100 * NS_PER_MS;
static const size_t state_capacity = (size_t)1 << 20;

/* ---- copies of the watched library: a rebuilt file of the same name would not be loaded again,
 * and would change while it is in use ---- */

static const size_t library_bytes_max = (size_t)256 << 20;

/* Creates a private folder for copies. */
static mrt_result make_folder(char out[PATH_MAX], error *err)
{
    const char *chosen = getenv("TMPDIR");
    int length =
        snprintf(out, PATH_MAX, "%s/marotte-XXXXXX", chosen && chosen[0] == '/' ? chosen : "/tmp");
    if (length > 0 && length < PATH_MAX && mkdtemp(out))
        return MRT_OK;
    return error_set(err, MRT_ERR_IO, "cannot create a folder for rebuilt plugins: %s",
                     strerror(errno));
}

/* Copies the library as number `n` and writes its SHA-256 to out_hash. */
static mrt_result copy_library(const char *library, const char *folder, uint32_t n,
                               char out_path[PATH_MAX], char out_hash[TAKE_HASH], error *err)
{
    file_bytes bytes;
    const char *slash = strrchr(library, '/');
    mrt_result result = plugin_library_check(library, err);
    if (result >= 0)
        result = file_read(&bytes, library, library_bytes_max, err);
    if (result < 0)
        return result;
    int length =
        snprintf(out_path, PATH_MAX, "%s/%u-%.200s", folder, n, slash ? slash + 1 : library);
    hash_bytes(out_hash, bytes.data, bytes.size);
    if (length <= 0 || length >= PATH_MAX)
        result = error_set(err, MRT_ERR_IO, "%s: the path is too long", library);
    FILE *copy = result >= 0 ? fopen(out_path, "wbx") : NULL;
    if (copy) { /* not file_write: it need not survive a power cut */
        bool is_written = fwrite(bytes.data, bytes.size, 1, copy) == 1;
        is_written &= fclose(copy) == 0;
        if (!is_written)
            result = error_set(err, MRT_ERR_IO, "cannot write %s: %s", out_path, strerror(errno));
    } else if (result >= 0) {
        result = error_set(err, MRT_ERR_IO, "cannot create %s: %s", out_path, strerror(errno));
    }
    file_bytes_finish(&bytes);
    return result;
}

/* Loads a library, checks its tables and finds the mapping with that id. */
static mrt_result open_version(const char *path, const char *type_id,
                               const mrt_plugin_type **out_type, error *err)
{
    *out_type = NULL;
    const mrt_plugin_type *const *types = plugin_library_open(path, err);
    if (!types)
        return MRT_ERR_FORMAT;
    for (; *types; ++types) {
        mrt_result result = plugin_type_check(*types, err);
        if (result < 0)
            return result;
        if (strcmp((*types)->id, type_id) != 0 || !plugin_interface(*types, MRT_MAPPING))
            continue;
        *out_type = *types;
        return MRT_OK;
    }
    return error_set(err, MRT_ERR_FORMAT, "the library no longer has mapping %s", type_id);
}

/* ---- data ---- */

/* One version of the mapping. Must not move in memory. */
typedef struct version {
    instance instance;
    isolate *isolate;
    bool is_active;
    char path[PATH_MAX];          /* of its copy; "": none */
    char identity[TAKE_IDENTITY]; /* as recorder_plugin_identity */
} version;

/* State of the hand-over between loader and frame thread. Names the thread that acts next. */
enum {
    STEP_NOTHING = 0, /* loader: no switch is pending */
    STEP_SAVE,        /* frame thread: save MRT_STATE of the old version */
    STEP_SAVED,       /* loader: give the saved state to the new version */
    STEP_SWITCH,      /* frame thread: switch to the new version */
    STEP_SWITCHED     /* loader: destroy the old version */
};

struct reload {
    reload_settings settings;
    char *library;
    char folder[PATH_MAX];
    const mrt_plugin_type *first; /* type of the caller's instance, without isolation */
    pthread_t loader;
    _Atomic bool is_stopping;
    _Atomic uint32_t step;
    _Atomic uint32_t taken_count, refused_count;
    _Atomic int64_t last_ns;
    _Atomic uintptr_t pulling; /* the current instance, for [main] */
    _Atomic uintptr_t known;   /* last instance that reload_current returned */

    instance *current;           /* performs now */
    version *version;            /* version of `current`; NULL: the caller's instance */
    version *next;               /* while it waits for the switch */
    layer_room *room;            /* for `next`; after the switch the layer's old one */
    unsigned char *state;        /* state_capacity */
    size_t state_size;           /* bytes saved in STEP_SAVE; 0: none */
    bool is_state_lost;          /* the new version refused the state */
    plugin_library_stamp loaded; /* of the file at the start */
    uint32_t number;
    int64_t seen_ns;
    const char *identity;
};

static void log_line(reload *self, int32_t level, const char *text)
{
    log_push(self->settings.log, level, self->first->id, text);
}

/* ---- versions ---- */

static void version_destroy(version *v)
{
    if (!v)
        return;
    if (v->is_active)
        instance_deactivate(&v->instance);
    instance_destroy(&v->instance);
    isolate_destroy(v->isolate);
    if (v->path[0])
        (void)unlink(v->path);
    free(v);
}

/* Copies and loads the library, and creates the instance. */
static mrt_result version_make(reload *self, version *v, error *err)
{
    char hash[TAKE_HASH];
    const mrt_plugin_type *type;
    mrt_result result =
        copy_library(self->library, self->folder, self->number++, v->path, hash, err);
    if (result >= 0)
        result = check_quick(v->path, err);
    if (result >= 0)
        result = open_version(v->path, self->first->id, &type, err);
    if (result < 0)
        return result;
    (void)snprintf(v->identity, sizeof v->identity, "%.159s %.63s %s", type->id, type->version,
                   hash);
    if (self->settings.isolate) {
        result = isolate_create_mapping(&v->isolate, type, v->path, self->settings.isolate, err);
        if (result < 0)
            return result;
        type = isolate_type(v->isolate);
    }
    return instance_create(&v->instance, type, self->settings.clock, self->settings.log, err);
}

/* ---- the loader thread ---- */

static bool is_stopping(const reload *self)
{
    return atomic_load(&self->is_stopping);
}

/* Waits until the frame thread has reached `step`. Returns false if the program is ending. */
static bool wait_for(const reload *self, uint32_t step)
{
    while (!is_stopping(self) && atomic_load(&self->step) != step)
        clock_sleep_until_ns(clock_now_ns() + wait_span_ns);
    return !is_stopping(self);
}

static mrt_result copy_state(reload *self, version *v)
{
    const mrt_state *from = plugin_interface(self->current->type, MRT_STATE);
    const mrt_state *to = plugin_interface(v->instance.type, MRT_STATE);
    if (!from || !to)
        return MRT_OK;
    atomic_store(&self->step, STEP_SAVE);
    if (!wait_for(self, STEP_SAVED))
        return MRT_HOLD;
    if (self->state_size > 0 && to->load(v->instance.self, self->state, self->state_size) < 0)
        log_line(self, MRT_LOG_WARNING,
                 "the rebuilt version refused the learned data of the old one");
    return MRT_OK;
}

/* Runs the new version on one frame without hands, on the face that it will move, and checks its
 * pull. */
static mrt_result check_first_frame(reload *self, version *v, error *err)
{
    const mrt_mapping *mapping = plugin_interface(v->instance.type, MRT_MAPPING);
    const mrt_face *about = &self->settings.mapped->about;
    vec3 low = {(double)about->low.x, (double)about->low.y, (double)about->low.z};
    vec3 high = {(double)about->high.x, (double)about->high.y, (double)about->high.z};
    const guard g = {.contact_count = about->contact_count,
                     .centre = vec3_scale(vec3_add(low, high), 0.5),
                     .reach_mm = 10.0 * fmax(vec3_length(vec3_sub(high, low)), 1.0)};
    mrt_pull pull = guard_idle();
    instance_latch(&v->instance);
    const mrt_frame frame = {.params = v->instance.params};
    int64_t start_ns = clock_now_ns();
    mrt_result result = mapping->process(v->instance.self, &frame, &pull);
    const char *fault = result == MRT_OK ? guard_fault(&g, &pull) : NULL;
    if (result < 0)
        return error_set(err, result, "its first frame returned an error");
    if (fault)
        return error_set(err, MRT_ERR_FORMAT, "its first frame gave %s", fault);
    if (clock_now_ns() - start_ns > answer_patience_ns)
        return error_set(err, MRT_ERR_FORMAT, "its first frame took too long");
    mapping->reset(v->instance.self);
    return MRT_OK;
}

/* Returns MRT_HOLD if the program is ending. */
static mrt_result prepare(reload *self, version *v, error *err)
{
    mrt_result result = version_make(self, v, err);
    if (result < 0)
        return result;
    instance_copy_values(&v->instance, self->current);
    result = copy_state(self, v);
    if (result != MRT_OK)
        return result;
    const mrt_mapping *mapping = plugin_interface(v->instance.type, MRT_MAPPING);
    result = instance_activate(&v->instance, self->settings.mapped, err);
    if (result < 0)
        return result;
    v->is_active = true;
    mapping->reset(v->instance.self);
    return check_first_frame(self, v, err);
}

static void refuse(reload *self, const char *reason)
{
    error text;
    atomic_store(&self->step, STEP_NOTHING);
    (void)error_set(&text, MRT_OK, "the rebuilt version is refused: %s. The old version continues",
                    reason);
    log_line(self, MRT_LOG_WARNING, text.text);
    atomic_fetch_add(&self->refused_count, 1);
}

/* Waits until [main] has called reload_current again, because it may use the old instance until
 * then. */
static void wait_for_main(const reload *self)
{
    while (self->settings.is_asked && !is_stopping(self) &&
           atomic_load(&self->known) != atomic_load(&self->pulling))
        clock_sleep_until_ns(clock_now_ns() + wait_span_ns);
}

/* Deactivates the old version and reports the switch. */
static void retire(reload *self, instance *old, version *old_version)
{
    if (old_version)
        version_destroy(old_version);
    else /* the caller destroys its own instance */
        instance_deactivate(old);
    if (self->is_state_lost)
        log_line(self, MRT_LOG_WARNING,
                 "the rebuilt version could not load the state of the old one and was reset");
    error text;
    (void)error_set(&text, MRT_OK, "version %s has taken over",
                    isolate_inner(self->current->type)->version);
    log_line(self, MRT_LOG_INFO, text.text);
}

static void load_version(reload *self)
{
    error err = {""};
    instance *old = self->current;
    version *old_version = self->version;
    version *v = calloc(1, sizeof *v);
    mrt_result result = v ? prepare(self, v, &err) : error_set(&err, MRT_ERR_MEMORY, "no memory");
    layer_room *room = result == MRT_OK ? layer_room_create(&v->instance) : NULL;
    if (result == MRT_OK && !room)
        result = error_set(&err, MRT_ERR_MEMORY, "no memory");
    if (result != MRT_OK) {
        version_destroy(v);
        if (result < 0)
            refuse(self, err.text);
        return;
    }
    self->next = v;
    self->room = room;
    atomic_store(&self->step, STEP_SWITCH);
    if (!wait_for(self, STEP_SWITCHED) && atomic_load(&self->step) != STEP_SWITCHED)
        return; /* reload_stop frees `next` and `room` */
    atomic_store(&self->step, STEP_NOTHING);
    layer_room_destroy(self->room);
    self->room = NULL;
    wait_for_main(self);
    retire(self, old, old_version);
    /* Last, because a caller that waits for this count may then change the file again. */
    atomic_store(&self->last_ns, clock_now_ns() - self->seen_ns);
    atomic_fetch_add(&self->taken_count, 1);
}

static void *loader_main(void *data)
{
    reload *self = data;
    plugin_library_stamp loaded = self->loaded, last = loaded;
    while (!is_stopping(self)) {
        clock_sleep_until_ns(clock_now_ns() + poll_span_ns);
        plugin_library_stamp now = plugin_library_stamp_of(self->library);
        bool is_settled = plugin_library_is_same(&now, &last);
        if (!is_settled)
            self->seen_ns = clock_now_ns();
        last = now;
        error ignored;
        bool is_complete = is_settled && now.size > 0 && !plugin_library_is_same(&now, &loaded) &&
                           plugin_library_check(self->library, &ignored) >= 0;
        if (!is_complete)
            continue;
        loaded = now;
        load_version(self);
    }
    return NULL;
}

/* ---- [frame] ---- */

static void save_state(reload *self)
{
    const mrt_state *from = plugin_interface(self->current->type, MRT_STATE);
    self->state_size = from->save(self->current->self, self->state, state_capacity);
    if (self->state_size > state_capacity)
        self->state_size = 0;
    atomic_store(&self->step, STEP_SAVED);
}

/* Gives the new version the state of the old one, if both support it. Returns false if the new
 * version refused it. */
static bool transfer_state(reload *self, version *v)
{
    const mrt_resume *from = plugin_interface(self->current->type, MRT_RESUME);
    const mrt_resume *to = plugin_interface(v->instance.type, MRT_RESUME);
    const mrt_mapping *mapping = plugin_interface(v->instance.type, MRT_MAPPING);
    if (!from || !to)
        return true;
    size_t size = from->save(self->current->self, self->state, state_capacity);
    if (size > 0 && size <= state_capacity && to->load(v->instance.self, self->state, size) >= 0)
        return true;
    mapping->reset(v->instance.self);
    return false;
}

bool reload_step(reload *self, layer *of)
{
    uint32_t step = atomic_load(&self->step);
    if (step == STEP_SAVE)
        save_state(self);
    if (step != STEP_SWITCH || layer_is_fading(of))
        return false;
    version *v = self->next;
    self->is_state_lost = !transfer_state(self, v);
    instance_copy_values(&v->instance, self->current);
    (void)layer_switch(of, &v->instance, &self->room);
    self->current = &v->instance;
    atomic_store(&self->pulling, (uintptr_t)self->current);
    self->version = v;
    self->identity = v->identity;
    self->next = NULL;
    atomic_store(&self->step, STEP_SWITCHED);
    return true;
}

instance *reload_current(reload *self)
{
    uintptr_t now = atomic_load(&self->pulling);
    atomic_store(&self->known, now);
    return (instance *)now;
}

const char *reload_identity(const reload *self)
{
    return self->identity;
}

reload_counts reload_get_counts(const reload *self)
{
    return (reload_counts){.taken = atomic_load(&self->taken_count),
                           .refused = atomic_load(&self->refused_count),
                           .last_ns = atomic_load(&self->last_ns)};
}

/* ---- create and destroy ---- */

mrt_result reload_start(reload **out, const reload_settings *settings, error *err)
{
    *out = NULL;
    reload *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory to watch %s", settings->library);
    self->settings = *settings;
    self->first = isolate_inner(settings->mapping->type);
    self->current = settings->mapping;
    atomic_init(&self->pulling, (uintptr_t)settings->mapping);
    atomic_init(&self->known, (uintptr_t)settings->mapping);
    self->identity = "";
    self->library = strdup(settings->library);
    self->state = malloc(state_capacity);
    if (self->library)
        self->loaded = plugin_library_stamp_of(self->library);
    mrt_result result = MRT_OK;
    if (!self->library || !self->state)
        result = error_set(err, MRT_ERR_MEMORY, "no memory to watch %s", settings->library);
    if (result >= 0)
        result = make_folder(self->folder, err);
    if (result >= 0 && pthread_create(&self->loader, NULL, loader_main, self) != 0) {
        (void)rmdir(self->folder);
        result = error_set(err, MRT_ERR_IO, "cannot start a thread to watch %s", settings->library);
    }
    if (result >= 0) {
        *out = self;
        return MRT_OK;
    }
    free(self->library);
    free(self->state);
    free(self);
    return result;
}

void reload_stop(reload *self)
{
    if (!self)
        return;
    atomic_store(&self->is_stopping, true);
    pthread_join(self->loader, NULL);
    layer_room_destroy(self->room);
    version_destroy(self->next);
    if (self->version) {
        self->version->is_active = false; /* the layer has deactivated it */
        version_destroy(self->version);
    }
    (void)rmdir(self->folder);
    free(self->library);
    free(self->state);
    free(self);
}
