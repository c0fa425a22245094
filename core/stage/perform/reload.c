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

/* How often the file is looked at; it is complete when it has not changed in between. */
static const int64_t look_span_ns = 20 * NS_PER_MS;
/* How often the loader looks whether the frame thread has done its part. */
static const int64_t part_span_ns = 2 * NS_PER_MS;
static const int64_t answer_patience_ns = 100 * NS_PER_MS;
static const size_t state_capacity = (size_t)1 << 20;

/* ---- a library file that is watched, and copies of it that are loaded: a rebuilt file of the same
 * name would not be loaded again, and would change under the program ---- */

static const size_t library_bytes_max = (size_t)256 << 20;

/* A folder for copies, which nobody else may enter. */
static mrt_result make_folder(char out[PATH_MAX], error *err)
{
    const char *chosen = getenv("TMPDIR");
    int length =
        snprintf(out, PATH_MAX, "%s/marotte-XXXXXX", chosen && chosen[0] == '/' ? chosen : "/tmp");
    if (length > 0 && length < PATH_MAX && mkdtemp(out))
        return MRT_OK;
    return error_set(err, MRT_ERR_IO, "no folder for rebuilt plugins: %s", strerror(errno));
}

/* Copies the file as number `n`; its SHA-256 goes to out_hash. */
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
        result = error_set(err, MRT_ERR_IO, "%s: too long a name", library);
    FILE *copy = result >= 0 ? fopen(out_path, "wbx") : NULL;
    if (copy) { /* not file_write: it need not survive a power cut */
        bool is_written = fwrite(bytes.data, bytes.size, 1, copy) == 1;
        is_written &= fclose(copy) == 0;
        if (!is_written)
            result =
                error_set(err, MRT_ERR_IO, "%s cannot be written: %s", out_path, strerror(errno));
    } else if (result >= 0) {
        result = error_set(err, MRT_ERR_IO, "%s cannot be made: %s", out_path, strerror(errno));
    }
    file_bytes_finish(&bytes);
    return result;
}

/* The mapping of that id in a library, loaded and its tables checked. */
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
    return error_set(err, MRT_ERR_FORMAT, "has no mapping %s any more", type_id);
}

/* ---- the whole ---- */

/* One version of the mapping; does not move. */
typedef struct version {
    instance instance;
    isolate *isolate;
    bool is_active;
    char path[PATH_MAX];          /* of its copy; "" */
    char identity[TAKE_IDENTITY]; /* as recorder_plugin_identity */
} version;

/* Which thread acts next, and on what. */
enum {
    STEP_NOTHING = 0, /* the loader's */
    STEP_SAVE,        /* the frame thread's: MRT_STATE of the old one */
    STEP_SAVED,       /* the loader's */
    STEP_TAKE,        /* the frame thread's: the new one may pull */
    STEP_TAKEN        /* the loader's: the old one may go */
};

struct reload {
    reload_settings settings;
    char *library;
    char folder[PATH_MAX];
    const mrt_plugin_type *first; /* of the caller's instance, not isolated */
    pthread_t loader;
    _Atomic bool is_stopping;
    _Atomic uint32_t step;
    _Atomic uint32_t taken_count, refused_count;
    _Atomic int64_t last_ns;
    _Atomic uintptr_t pulling; /* the instance that pulls, for [main] */
    _Atomic uintptr_t known;   /* the one that [main] knows */

    instance *current;           /* that pulls */
    version *version;            /* of `current`; NULL: it is the caller's */
    version *next;               /* while it is loaded */
    layer_room *room;            /* for it; then the one that the layer had */
    unsigned char *state;        /* state_capacity */
    size_t state_size;           /* what STEP_SAVE has found; 0: nothing */
    bool is_state_lost;          /* the new one did not take it */
    plugin_library_stamp loaded; /* of the file when it began */
    uint32_t number;
    int64_t seen_ns;
    const char *identity;
};

static void say(reload *self, int32_t level, const char *text)
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

/* Its library loaded, the plugin created. */
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

/* ---- the loader ---- */

static bool is_stopping(const reload *self)
{
    return atomic_load(&self->is_stopping);
}

/* Until the frame thread has done its part; false: it will not. */
static bool wait_for(const reload *self, uint32_t step)
{
    while (!is_stopping(self) && atomic_load(&self->step) != step)
        clock_sleep_until_ns(clock_now_ns() + part_span_ns);
    return !is_stopping(self);
}

static mrt_result take_state(reload *self, version *v)
{
    const mrt_state *from = plugin_interface(self->current->type, MRT_STATE);
    const mrt_state *to = plugin_interface(v->instance.type, MRT_STATE);
    if (!from || !to)
        return MRT_OK;
    atomic_store(&self->step, STEP_SAVE);
    if (!wait_for(self, STEP_SAVED))
        return MRT_HOLD;
    if (self->state_size > 0 && to->load(v->instance.self, self->state, self->state_size) < 0)
        say(self, MRT_LOG_WARNING, "the rebuilt version does not take what it was taught");
    return MRT_OK;
}

/* The new one answers a frame in which no hand is seen, on the face that it will pull. */
static mrt_result hear_answer(reload *self, version *v, error *err)
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
        return error_set(err, result, "its first frame gave an error");
    if (fault)
        return error_set(err, MRT_ERR_FORMAT, "its first frame gave %s", fault);
    if (clock_now_ns() - start_ns > answer_patience_ns)
        return error_set(err, MRT_ERR_FORMAT, "its first frame took too long");
    mapping->reset(v->instance.self);
    return MRT_OK;
}

/* MRT_HOLD: the program ends meanwhile. */
static mrt_result prepare(reload *self, version *v, error *err)
{
    mrt_result result = version_make(self, v, err);
    if (result < 0)
        return result;
    instance_copy_values(&v->instance, self->current);
    result = take_state(self, v);
    if (result != MRT_OK)
        return result;
    const mrt_mapping *mapping = plugin_interface(v->instance.type, MRT_MAPPING);
    result = instance_activate(&v->instance, self->settings.mapped, err);
    if (result < 0)
        return result;
    v->is_active = true;
    mapping->reset(v->instance.self);
    return hear_answer(self, v, err);
}

static void refuse(reload *self, const char *reason)
{
    error text;
    atomic_store(&self->step, STEP_NOTHING);
    (void)error_set(&text, MRT_OK, "the rebuilt version is refused: %s; the old one goes on",
                    reason);
    say(self, MRT_LOG_WARNING, text.text);
    atomic_fetch_add(&self->refused_count, 1);
}

/* [main] may look at the old one until it has asked again. */
static void wait_for_main(const reload *self)
{
    while (self->settings.is_asked && !is_stopping(self) &&
           atomic_load(&self->known) != atomic_load(&self->pulling))
        clock_sleep_until_ns(clock_now_ns() + part_span_ns);
}

/* The old one is of no use any more. */
static void retire(reload *self, instance *old, version *old_version)
{
    if (old_version)
        version_destroy(old_version);
    else /* the caller's: it destroys it */
        instance_deactivate(old);
    if (self->is_state_lost)
        say(self, MRT_LOG_WARNING, "the rebuilt version does not go on from the old one's state");
    error text;
    (void)error_set(&text, MRT_OK, "version %s has taken over",
                    isolate_inner(self->current->type)->version);
    say(self, MRT_LOG_INFO, text.text);
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
    atomic_store(&self->step, STEP_TAKE);
    if (!wait_for(self, STEP_TAKEN) && atomic_load(&self->step) != STEP_TAKEN)
        return; /* reload_stop clears up */
    atomic_store(&self->step, STEP_NOTHING);
    layer_room_destroy(self->room);
    self->room = NULL;
    wait_for_main(self);
    retire(self, old, old_version);
    /* Last: who counts on it may change the file again. */
    atomic_store(&self->last_ns, clock_now_ns() - self->seen_ns);
    atomic_fetch_add(&self->taken_count, 1);
}

static void *loader_main(void *data)
{
    reload *self = data;
    plugin_library_stamp loaded = self->loaded, last = loaded;
    while (!is_stopping(self)) {
        clock_sleep_until_ns(clock_now_ns() + look_span_ns);
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

/* Where the old one is; the new one goes on from there, if both can. */
static bool hand_over(reload *self, version *v)
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
    if (step != STEP_TAKE || layer_is_fading(of))
        return false;
    version *v = self->next;
    self->is_state_lost = !hand_over(self, v);
    instance_copy_values(&v->instance, self->current);
    (void)layer_switch(of, &v->instance, &self->room);
    self->current = &v->instance;
    atomic_store(&self->pulling, (uintptr_t)self->current);
    self->version = v;
    self->identity = v->identity;
    self->next = NULL;
    atomic_store(&self->step, STEP_TAKEN);
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

reload_counts reload_counted(const reload *self)
{
    return (reload_counts){.taken = atomic_load(&self->taken_count),
                           .refused = atomic_load(&self->refused_count),
                           .last_ns = atomic_load(&self->last_ns)};
}

/* ---- made and unmade ---- */

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
        result = error_set(err, MRT_ERR_IO, "no thread to watch %s", settings->library);
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
