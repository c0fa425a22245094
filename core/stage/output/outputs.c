#include "stage/output/outputs.h"
#include "base/clock.h"
#include "base/percentile.h"
#include "base/trace.h"
#include "stage/input/wake.h"
#include "stage/mapping/plugins.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const int64_t retry_ns = NS_PER_S, repeat_default_ns = NS_PER_S;
static const int64_t watch_ns = NS_PER_S / 2; /* interval between checks of a library */
enum { LATENCIES = 4096 };

typedef struct latest { /* copy of a face of a board */
    int64_t time_ns, take_ns;
    uint64_t number;
    bool has_vertices;
    float *value;
    size_t capacity; /* number of floats */
} latest;

typedef struct output { /* owned by its thread, except the marked members */
    outputs *of;
    instance plugin;
    isolate *isolated; /* NULL: it runs in this process */
    const mrt_face_output *functions;
    plugin_spec spec;
    char *text;
    const char *library;
    plugin_library_stamp built;
    pthread_t thread;
    wake signal;
    _Atomic bool stop;

    bool is_open;
    int64_t retry_at_ns;
    face_board *begun; /* board whose names the plugin has; a reference */
    mrt_face_wants wants;
    latest now;
    uint64_t sent_number;
    bool has_face, is_fresh;
    int64_t sent_ns, due_ns, watched_ns;

    _Atomic bool wants_vertices; /* [any] */
    pthread_mutex_t mutex;       /* guards the following members */
    output_state state;
    char trouble[200];
    uint64_t sent, replaced;
    int64_t second_ns; /* start of counting in `in_second` */
    uint32_t in_second;
    double rate_hz;
    float latency_ms[LATENCIES]; /* a ring */
    uint64_t latency_count;
} output;

struct outputs {
    outputs_settings settings;
    output *one[OUTPUTS_MAX]; /* [main], and guarded by mutex */
    uint32_t count;
    _Atomic bool are_wanted, want_vertices; /* read by [frame] */
    _Atomic bool ask_again;                 /* reset by [frame] */
    wake signal;                            /* of the thread that reads the board */
    _Atomic bool stop;
    pthread_t thread;
    bool has_thread;
    /* held while a face is read, because its file is needed; lock before mutex */
    pthread_mutex_t taking;
    pthread_mutex_t mutex; /* guards one, count, board and newest; never held by [frame] */
    double residual_mm;    /* guarded by mutex: of `newest` */
    face_board *board;     /* a reference; NULL: none */
    latest newest;         /* of that board; number 0: none */
    latest taken;          /* owned by the thread that reads the board */
};

/* ---- copies of faces ---- */

static bool make_room(latest *self, size_t floats)
{
    if (floats <= self->capacity)
        return true;
    float *larger = realloc(self->value, floats * sizeof *larger);
    if (!larger)
        return false;
    self->value = larger;
    self->capacity = floats;
    return true;
}

static bool copy_face(latest *out, const mrt_face_names *names, const latest *from)
{
    size_t floats = isolate_sample_floats(names, from->has_vertices);
    if (!make_room(out, floats))
        return false;
    if (floats > 0)
        memcpy(out->value, from->value, floats * sizeof *out->value);
    out->time_ns = from->time_ns;
    out->take_ns = from->take_ns;
    out->number = from->number;
    out->has_vertices = from->has_vertices;
    return true;
}

/* ---- the thread that reads the board ---- */

/* Copies the newest face of the board to `newest`, by a swap of the buffers under the mutex. */
static bool read_face(outputs *self, face_board *board)
{
    const board_face *from = face_board_read(board);
    if (!from)
        return false;
    const latest as = {.time_ns = from->time_ns,
                       .take_ns = from->take_ns,
                       .number = from->number,
                       .has_vertices = from->has_vertices && atomic_load(&self->want_vertices),
                       .value = from->value};
    if (!copy_face(&self->taken, &board->of.names, &as))
        return false;
    pthread_mutex_lock(&self->mutex);
    latest before = self->newest;
    self->newest = self->taken;
    self->taken = before;
    self->residual_mm = board->residual_mm;
    for (uint32_t i = 0; i < self->count; ++i)
        wake_signal(&self->one[i]->signal);
    pthread_mutex_unlock(&self->mutex);
    return true;
}

static void *run_reader(void *data)
{
    outputs *self = data;
    while (!atomic_load(&self->stop)) {
        uint32_t seen = wake_seen(&self->signal);
        pthread_mutex_lock(&self->taking);
        bool has_taken = self->board && read_face(self, self->board);
        pthread_mutex_unlock(&self->taking);
        if (!has_taken)
            wake_wait_until_ns(&self->signal, seen, clock_now_ns() + NS_PER_S);
    }
    return NULL;
}

/* ---- thread of an output: state ---- */

static void set_state(output *self, output_state state, const char *trouble)
{
    static const char *const names[] = {[OUTPUT_OPENS] = "opens",
                                        [OUTPUT_SENDS] = "sends",
                                        [OUTPUT_NO_RECEIVER] = "has no receiver",
                                        [OUTPUT_FAILED] = "failed"};
    bool is_news = false;
    pthread_mutex_lock(&self->mutex);
    output_state before = self->state;
    if (state != before)
        TRACE(TRACE_OUTPUT, "%s: %s%s%s", self->text, names[state], trouble[0] ? ": " : "",
              trouble);
    self->state = state;
    if (state == OUTPUT_FAILED)
        is_news = strcmp(self->trouble, trouble) != 0;
    (void)snprintf(self->trouble, sizeof self->trouble, "%s", trouble);
    pthread_mutex_unlock(&self->mutex);
    if (is_news)
        log_pushf(self->of->settings.log, MRT_LOG_WARNING, self->text,
                  "%s. Trying again every second.", trouble);
    else if (before == OUTPUT_FAILED && state == OUTPUT_SENDS)
        log_push(self->of->settings.log, MRT_LOG_INFO, self->text, "sends again");
}

static void count_sent(output *self, bool is_new, int64_t now_ns)
{
    pthread_mutex_lock(&self->mutex);
    self->sent += 1;
    self->in_second += 1;
    if (now_ns - self->second_ns >= NS_PER_S) {
        self->rate_hz = (double)self->in_second * 1e9 / (double)(now_ns - self->second_ns);
        self->second_ns = now_ns;
        self->in_second = 0;
    }
    if (is_new)
        self->latency_ms[self->latency_count++ % LATENCIES] =
            (float)((double)(now_ns - self->now.time_ns) / 1e6);
    pthread_mutex_unlock(&self->mutex);
}

/* ---- open, close, open again ---- */

static bool is_rebuilt(output *self, int64_t now_ns)
{
    if (!self->isolated || now_ns - self->watched_ns < watch_ns)
        return false;
    self->watched_ns = now_ns;
    const plugin_library_stamp now = plugin_library_stamp_of(self->library);
    return now.size > 0 && !plugin_library_is_same(&now, &self->built);
}

static void close_output(output *self)
{
    self->functions->close(self->plugin.self);
    self->is_open = false;
    face_board_release(self->begun);
    self->begun = NULL;
}

static void fail(output *self, const char *why)
{
    close_output(self);
    self->retry_at_ns = clock_now_ns() + retry_ns;
    set_state(self, OUTPUT_FAILED, why[0] ? why : "the plugin failed without an error text");
}

static double within(double value, double most)
{
    return value > 0.0 && value < most ? value : 0.0;
}

static void open_output(output *self)
{
    error why = {""};
    self->wants = (mrt_face_wants){0};
    self->built = plugin_library_stamp_of(self->library);
    instance_latch(&self->plugin);
    instance_listen(&self->plugin, &why, NULL);
    mrt_result result = self->functions->open(self->plugin.self, self->spec.address,
                                              self->plugin.params, &self->wants);
    instance_listen_end(&self->plugin);
    self->wants.rate_hz = within(self->wants.rate_hz, 10000.0);
    self->wants.repeat_s = within(self->wants.repeat_s, 3600.0);
    atomic_store(&self->wants_vertices, self->wants.vertices != 0);
    if (self->wants.vertices) {
        atomic_store(&self->of->want_vertices, true);
        atomic_store(&self->of->ask_again, true);
    }
    self->is_open = true;
    if (result < 0)
        fail(self, why.text);
}

/* Calls begin with the names of this face, unless the plugin already has them. False: the plugin
 * refused them. */
static bool begin(output *self, face_board *board)
{
    error why = {""};
    if (board == self->begun)
        return true;
    instance_listen(&self->plugin, &why, NULL);
    mrt_result result = self->functions->begin(self->plugin.self, &board->of.names);
    instance_listen_end(&self->plugin);
    if (result < 0) {
        fail(self, why.text);
        return false;
    }
    face_board_release(self->begun);
    self->begun = face_board_retain(board);
    return true;
}

static void send_face(output *self)
{
    error why = {""};
    bool is_new = self->is_fresh && self->now.number != self->sent_number;
    mrt_face_sample sample = {
        .time_ns = self->now.time_ns, .take_ns = self->now.take_ns, .number = self->now.number};
    isolate_sample_at(&sample, &self->begun->of.names, self->now.value, self->now.has_vertices);
    instance_latch(&self->plugin);
    instance_listen(&self->plugin, &why, NULL);
    mrt_result result = self->functions->send(self->plugin.self, self->plugin.params, &sample);
    instance_listen_end(&self->plugin);
    int64_t now_ns = clock_now_ns();
    self->is_fresh = false;
    self->sent_number = self->now.number;
    self->sent_ns = now_ns;
    if (result < 0) {
        fail(self, why.text);
        return;
    }
    count_sent(self, is_new, now_ns);
    set_state(self, result == MRT_TIMEOUT ? OUTPUT_NO_RECEIVER : OUTPUT_SENDS, "");
}

/* ---- timing ---- */

/* Copies the newest face if it is a new one. Returns its board as a new reference. */
static face_board *copy_newest(output *self)
{
    outputs *of = self->of;
    pthread_mutex_lock(&of->mutex);
    face_board *board = of->board && of->newest.number > 0 ? face_board_retain(of->board) : NULL;
    bool is_other = board && (board != self->begun || of->newest.number != self->now.number);
    if (is_other && !copy_face(&self->now, &board->of.names, &of->newest)) {
        face_board_release(board);
        board = NULL;
    } else if (is_other) {
        pthread_mutex_lock(&self->mutex);
        self->replaced += self->is_fresh;
        pthread_mutex_unlock(&self->mutex);
        self->is_fresh = true;
    }
    pthread_mutex_unlock(&of->mutex);
    return board;
}

/* Returns when the current face must be sent. */
static int64_t due_at(const output *self)
{
    int64_t repeat_ns =
        self->wants.repeat_s > 0.0 ? (int64_t)(self->wants.repeat_s * 1e9) : repeat_default_ns;
    return self->is_fresh ? self->due_ns : self->sent_ns + repeat_ns;
}

/* Plans the next face. At a fixed rate the time grid stays, unless the output is late. */
static void plan_next(output *self, int64_t now_ns)
{
    int64_t period_ns = self->wants.rate_hz > 0.0 ? (int64_t)(1e9 / self->wants.rate_hz) : 0;
    self->due_ns =
        now_ns - self->due_ns > period_ns ? now_ns + period_ns : self->due_ns + period_ns;
}

/* Does one round. Returns the time of the next one. */
static int64_t run_once(output *self)
{
    int64_t now_ns = clock_now_ns();
    if (self->is_open && is_rebuilt(self, now_ns)) {
        log_push(self->of->settings.log, MRT_LOG_INFO, self->text,
                 "the library was rebuilt: the output is opened again");
        close_output(self);
        self->retry_at_ns = now_ns;
    }
    if (!self->is_open && now_ns < self->retry_at_ns)
        return self->retry_at_ns;
    if (!self->is_open)
        open_output(self);
    if (!self->is_open)
        return self->retry_at_ns;
    face_board *board = copy_newest(self);
    bool has_face = board && begin(self, board);
    face_board_release(board);
    if (!has_face)
        return self->is_open ? now_ns + watch_ns : self->retry_at_ns;
    int64_t due_ns = due_at(self);
    now_ns = clock_now_ns();
    if (now_ns >= due_ns) {
        bool was_fresh = self->is_fresh;
        send_face(self);
        if (was_fresh)
            plan_next(self, now_ns);
        return now_ns; /* a newer face may be available */
    }
    return due_ns < now_ns + watch_ns ? due_ns : now_ns + watch_ns;
}

static void *run(void *data)
{
    output *self = data;
    while (!atomic_load(&self->stop)) {
        uint32_t seen = wake_seen(&self->signal);
        int64_t until_ns = run_once(self);
        if (!atomic_load(&self->stop) && until_ns > clock_now_ns())
            wake_wait_until_ns(&self->signal, seen, until_ns);
    }
    if (self->is_open)
        close_output(self);
    return NULL;
}

/* ---- [main] ---- */

static void free_output(output *self)
{
    instance_destroy(&self->plugin);
    isolate_destroy(self->isolated);
    face_board_release(self->begun);
    plugin_spec_finish(&self->spec);
    pthread_mutex_destroy(&self->mutex);
    free(self->now.value);
    free(self->text);
    free(self);
}

static mrt_result prepare(output *self, error *err)
{
    const outputs *of = self->of;
    const mrt_plugin_type *type;
    mrt_result result =
        plugin_list_find(of->settings.plugins, self->spec.plugin, MRT_FACE_OUTPUT, &type, err);
    if (result < 0)
        return result;
    self->library = plugin_list_path_of(of->settings.plugins, type);
    if (isolate_is_wanted(of->settings.isolation, self->library)) {
        result = isolate_create_output(&self->isolated, type, self->library, err);
        if (result < 0)
            return result;
        type = isolate_type(self->isolated);
    }
    self->functions = plugin_interface(type, MRT_FACE_OUTPUT);
    result = instance_create(&self->plugin, type, CLOCK_REAL, of->settings.log, err);
    return result < 0 ? result : instance_set_list(&self->plugin, self->spec.params, err);
}

static void note_wants(outputs *self)
{
    bool want_vertices = false;
    for (uint32_t i = 0; i < self->count; ++i)
        want_vertices |= atomic_load(&self->one[i]->wants_vertices);
    atomic_store(&self->want_vertices, want_vertices);
    atomic_store(&self->are_wanted, self->count > 0);
}

mrt_result outputs_add(outputs *self, const char *text, error *err)
{
    if (self->count == OUTPUTS_MAX)
        return error_set(err, MRT_ERR_ARGUMENT, "at most %d outputs are possible", OUTPUTS_MAX);
    output *made = calloc(1, sizeof *made);
    if (!made)
        return error_set(err, MRT_ERR_MEMORY, "no memory for an output");
    made->of = self;
    pthread_mutex_init(&made->mutex, NULL);
    wake_init(&made->signal);
    made->text = strdup(text);
    mrt_result result = MRT_OK;
    if (!made->text || !plugin_spec_read(&made->spec, text))
        result = error_set(err, MRT_ERR_ARGUMENT,
                           "output \"%s\" is not PLUGIN[:ADDRESS][,key=value]", text);
    if (result >= 0)
        result = prepare(made, err);
    if (result >= 0 && pthread_create(&made->thread, NULL, run, made) != 0)
        result = error_set(err, MRT_ERR_MEMORY, "cannot create the thread of an output");
    if (result < 0) {
        free_output(made);
        return result;
    }
    pthread_mutex_lock(&self->mutex);
    self->one[self->count++] = made;
    note_wants(self);
    pthread_mutex_unlock(&self->mutex);
    atomic_store(&self->ask_again, true);
    return MRT_OK;
}

void outputs_remove(outputs *self, uint32_t index)
{
    if (index >= self->count)
        return;
    output *gone = self->one[index];
    pthread_mutex_lock(&self->mutex);
    self->count -= 1;
    for (uint32_t i = index; i < self->count; ++i)
        self->one[i] = self->one[i + 1];
    note_wants(self);
    pthread_mutex_unlock(&self->mutex);
    atomic_store(&gone->stop, true);
    instance_stop_waiting(&gone->plugin);
    wake_signal(&gone->signal);
    pthread_join(gone->thread, NULL);
    free_output(gone);
}

uint32_t outputs_count(const outputs *self)
{
    return self->count;
}

void outputs_show(outputs *self, face_board *board)
{
    pthread_mutex_lock(&self->taking);
    pthread_mutex_lock(&self->mutex);
    face_board *before = self->board;
    self->board = board ? face_board_retain(board) : NULL;
    self->newest.number = 0;
    pthread_mutex_unlock(&self->mutex);
    pthread_mutex_unlock(&self->taking);
    face_board_release(before);
}

double outputs_residual_mm(outputs *self)
{
    pthread_mutex_lock(&self->mutex);
    double residual_mm = self->newest.number > 0 ? self->residual_mm : 0.0;
    pthread_mutex_unlock(&self->mutex);
    return residual_mm;
}

void outputs_status(outputs *self, uint32_t index, output_status *out)
{
    double latency_ms[LATENCIES];
    output *of = self->one[index];
    pthread_mutex_lock(&of->mutex);
    uint32_t count = of->latency_count < LATENCIES ? (uint32_t)of->latency_count : LATENCIES;
    *out = (output_status){.state = of->state,
                           .text = of->text,
                           .name = of->plugin.type->name,
                           .is_isolated = of->isolated != NULL,
                           .sent = of->sent,
                           .replaced = of->replaced,
                           .rate_hz =
                               clock_now_ns() - of->second_ns < 3 * NS_PER_S ? of->rate_hz : 0.0};
    memcpy(out->trouble, of->trouble, sizeof out->trouble);
    for (uint32_t i = 0; i < count; ++i)
        latency_ms[i] = (double)of->latency_ms[i];
    pthread_mutex_unlock(&of->mutex);
    out->p50_ms = percentile(latency_ms, count, 0.5);
    out->p99_ms = percentile(latency_ms, count, 0.99);
}

mrt_result outputs_create(outputs **out, const outputs_settings *settings, error *err)
{
    *out = NULL;
    outputs *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for outputs");
    self->settings = *settings;
    wake_init(&self->signal);
    pthread_mutex_init(&self->mutex, NULL);
    pthread_mutex_init(&self->taking, NULL);
    if (pthread_create(&self->thread, NULL, run_reader, self) != 0) {
        outputs_destroy(self);
        return error_set(err, MRT_ERR_MEMORY, "cannot create the thread for outputs");
    }
    self->has_thread = true;
    *out = self;
    return MRT_OK;
}

void outputs_destroy(outputs *self)
{
    if (!self)
        return;
    while (self->count > 0)
        outputs_remove(self, self->count - 1);
    atomic_store(&self->stop, true);
    wake_signal(&self->signal);
    if (self->has_thread)
        pthread_join(self->thread, NULL);
    face_board_release(self->board);
    pthread_mutex_destroy(&self->mutex);
    pthread_mutex_destroy(&self->taking);
    free(self->newest.value);
    free(self->taken.value);
    free(self);
}

/* ---- [frame] ---- */

bool outputs_are_wanted(const outputs *self)
{
    return self && atomic_load(&self->are_wanted);
}

bool outputs_pop_request(outputs *self)
{
    return self && atomic_exchange(&self->ask_again, false);
}

void outputs_publish(outputs *self, face_board *board, composer *of, int64_t time_ns,
                     int64_t take_ns)
{
    face_board_fill(board, of, time_ns, take_ns, atomic_load(&self->want_vertices));
    wake_signal(&self->signal);
}
