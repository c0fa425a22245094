#include "stage/mapping/instance.h"
#include "base/clock.h"
#include "base/condition.h"
#include "base/suggest.h"
#include "base/text.h"
#include "stage/mapping/plugins.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { KEY_LENGTH = 128 };

/* longest wait before the caller's `stop` is checked */
static const int64_t look_span_ns = 50 * NS_PER_MS;

static bool is_listening(const instance *self)
{
    return atomic_load(&self->listener) == (uintptr_t)pthread_self();
}

static void host_log(const mrt_host *host, int32_t level, const char *text)
{
    instance *self = host->data;
    bool listens = is_listening(self); /* a plugin may also log from its own threads */
    if (listens && self->heard && level == MRT_LOG_ERROR)
        (void)error_set(self->heard, MRT_ERR_IO, "%s", text);
    else if (!listens || !self->already_logged || !log_once_repeats(self->already_logged, text))
        log_push(self->log, level, self->type->id, text);
}

static int64_t host_now_ns(const mrt_host *host)
{
    const instance *self = host->data;
    return self->clock == CLOCK_VIRTUAL ? self->virtual_ns : clock_now_ns();
}

static bool is_to_stop(const instance *self)
{
    return self->stopping || (self->stop && atomic_load(self->stop));
}

int64_t instance_wait_until_ns(instance *self, int64_t time_ns)
{
    if (self->clock == CLOCK_VIRTUAL) {
        if (time_ns > self->virtual_ns)
            self->virtual_ns = time_ns;
        return self->virtual_ns;
    }
    int64_t now_ns;
    pthread_mutex_lock(&self->mutex);
    while ((now_ns = clock_now_ns()) < time_ns && !is_to_stop(self)) {
        const int64_t until_ns =
            self->stop && time_ns - now_ns > look_span_ns ? now_ns + look_span_ns : time_ns;
        (void)condition_wait(&self->wake, &self->mutex, until_ns);
    }
    pthread_mutex_unlock(&self->mutex);
    return now_ns;
}

static int64_t host_wait_until_ns(const mrt_host *host, int64_t time_ns)
{
    return instance_wait_until_ns(host->data, time_ns);
}

static void host_request_restart(const mrt_host *host)
{
    instance *self = host->data;
    if (self->can_restart)
        atomic_store(&self->restart_asked, true);
    else
        log_push(self->log, MRT_LOG_WARNING, self->type->id, "requests a restart");
}

static void read_landmarks(const mrt_host *host, const mrt_landmarks *seen,
                           mrt_hand_reading *reading)
{
    instance *self = host->data;
    services_read_landmarks(&self->reader, seen, reading);
    pthread_mutex_lock(&self->mutex);
    self->sight = (hand_sight){*seen, reading->confidence, clock_now_ns()};
    pthread_mutex_unlock(&self->mutex);
}

bool instance_sight(instance *self, hand_sight *out)
{
    pthread_mutex_lock(&self->mutex);
    *out = self->sight;
    pthread_mutex_unlock(&self->mutex);
    return out->time_ns > 0;
}

static const void *host_service(const mrt_host *host, const char *id)
{
    static const mrt_landmark_reader landmarks = {read_landmarks};
    instance *self = host->data;
    if (strcmp(id, MRT_LANDMARKS) == 0 && services_reader_init(&self->reader))
        return &landmarks;
    return strcmp(id, MRT_FOLDERS) == 0 ? &services_folders : NULL;
}

static mrt_result allocate(instance *self, error *err)
{
    uint32_t count = self->type->param_count;
    self->wanted = calloc((size_t)count + 1, sizeof *self->wanted);
    self->params = calloc((size_t)count + 1, sizeof *self->params);
    if (!self->wanted || !self->params)
        return error_set(err, MRT_ERR_MEMORY, "no memory for plugin %s", self->type->id);
    for (uint32_t i = 0; i < count; ++i) {
        atomic_init(&self->wanted[i], self->type->params[i].initial);
        self->params[i] = self->type->params[i].initial;
    }
    return MRT_OK;
}

mrt_result instance_create(instance *out, const mrt_plugin_type *type, instance_clock clock,
                           log_queue *log, error *err)
{
    *out = (instance){.type = type, .clock = clock, .log = log};
    out->host = (mrt_host){
        out, host_log, host_now_ns, host_wait_until_ns, host_request_restart, host_service};
    pthread_mutex_init(&out->mutex, NULL);
    condition_init(&out->wake);
    mrt_result result = allocate(out, err);
    if (result < 0)
        goto fail;
    error why = {""};
    instance_listen(out, &why, NULL);
    out->self = type->create(&out->host);
    instance_listen_end(out);
    if (!out->self) {
        result = error_set(err, MRT_ERR_UNSUPPORTED, "cannot create plugin %s%s%s", type->id,
                           why.text[0] ? ": " : "", why.text);
        goto fail;
    }
    return MRT_OK;
fail:
    instance_destroy(out);
    return result;
}

void instance_destroy(instance *self)
{
    if (!self || !self->type)
        return;
    if (self->self)
        self->type->destroy(self->self);
    pthread_mutex_destroy(&self->mutex);
    pthread_cond_destroy(&self->wake);
    free(self->wanted);
    free(self->params);
    services_reader_finish(&self->reader);
    *self = (instance){0};
}

/* "Hand length" -> "hand_length"; group "Placement/Left" -> "placement/left". */
static void key_of(char *out, size_t capacity, const char *group, const char *name)
{
    int length =
        group ? snprintf(out, capacity, "%s.%s", group, name) : snprintf(out, capacity, "%s", name);
    (void)length;
    for (char *c = out; *c; ++c)
        *c = isspace((unsigned char)*c) ? '_' : (char)tolower((unsigned char)*c);
}

static bool find_param(const instance *self, const char *key, uint32_t *out_index, error *err)
{
    uint32_t found = 0;
    suggest near;
    suggest_begin(&near, key);
    for (uint32_t i = 0; i < self->type->param_count; ++i) {
        const mrt_param *p = &self->type->params[i];
        char short_key[KEY_LENGTH], long_key[KEY_LENGTH];
        key_of(short_key, sizeof short_key, NULL, p->name);
        key_of(long_key, sizeof long_key, p->group, p->name);
        if (strcmp(key, long_key) == 0) {
            *out_index = i;
            return true;
        }
        if (strcmp(key, short_key) == 0) {
            *out_index = i;
            found += 1;
        }
        suggest_consider(&near, short_key);
        suggest_consider(&near, long_key);
    }
    if (found == 1)
        return true;
    if (found > 1)
        error_set(err, MRT_ERR_ARGUMENT, "%s: parameter \"%s\" is ambiguous: write group.name",
                  self->type->id, key);
    else
        error_set(err, MRT_ERR_ARGUMENT, "%s: has no parameter \"%s\"%s%s", self->type->id, key,
                  suggest_question(&near).text,
                  near.best[0] ? "" : ". Its parameters: marotte plugin list --params");
    return false;
}

static bool label_value(const mrt_param *p, const char *text, double *out)
{
    if ((p->flags & MRT_PARAM_POSE) && !isdigit((unsigned char)text[0])) {
        *out = text[0] && strcmp(text, "none") != 0 ? (double)mrt_pose_value(text) : 0.0;
        return true;
    }
    for (size_t i = 0; p->labels && p->labels[i]; ++i) {
        char key[KEY_LENGTH];
        key_of(key, sizeof key, NULL, p->labels[i]);
        if (strcmp(p->labels[i], text) == 0 || strcmp(key, text) == 0) {
            *out = p->min + (double)i;
            return true;
        }
    }
    return false;
}

static mrt_result refuse_choice(const instance *self, const mrt_param *p, const char *key,
                                const char *value, error *err)
{
    char choices[256] = "";
    size_t used = 0;
    suggest near;
    suggest_begin(&near, value);
    for (size_t i = 0; p->labels[i] && used < sizeof choices; ++i) {
        char choice[KEY_LENGTH];
        key_of(choice, sizeof choice, NULL, p->labels[i]);
        suggest_consider(&near, choice);
        int length =
            snprintf(choices + used, sizeof choices - used, "%s%s", i > 0 ? ", " : "", choice);
        used += length > 0 ? (size_t)length : 0;
    }
    return error_set(err, MRT_ERR_ARGUMENT, "%s: %s=\"%s\" is not one of its choices: %s%s",
                     self->type->id, key, value, choices, suggest_question(&near).text);
}

mrt_result instance_set_text(instance *self, const char *key, const char *value, error *err)
{
    uint32_t index;
    double number;
    if (!find_param(self, key, &index, err))
        return MRT_ERR_ARGUMENT;
    const mrt_param *p = &self->type->params[index];
    if ((p->flags & MRT_PARAM_TRIGGER) && plugin_interface(self->type, MRT_MAPPING))
        return error_set(
            err, MRT_ERR_ARGUMENT,
            "%s: %s is a button: bind it to a pedal or a key (a patch), or press it on "
            "the stage",
            self->type->id, key);
    bool is_number =
        label_value(p, value, &number) || text_double(text_view_of(value, strlen(value)), &number);
    bool is_within = is_number && number >= p->min && number <= p->max;
    if (!is_within && p->labels)
        return refuse_choice(self, p, key, value, err);
    if (!is_number)
        return error_set(err, MRT_ERR_ARGUMENT, "%s: %s=\"%s\" is not a number", self->type->id,
                         key, value);
    if (!is_within)
        return error_set(err, MRT_ERR_ARGUMENT, "%s: %s=%s is outside %g .. %g%s%s", self->type->id,
                         key, value, p->min, p->max, p->unit[0] ? " " : "", p->unit);
    if ((p->flags & MRT_PARAM_STEPPED) && floor(number) < number)
        return error_set(err, MRT_ERR_ARGUMENT, "%s: %s=%s is not a whole number", self->type->id,
                         key, value);
    atomic_store(&self->wanted[index], number);
    return MRT_OK;
}

mrt_result instance_set_list(instance *self, const char *list, error *err)
{
    text_view rest = text_view_of(list, strlen(list));
    text_view field;
    while (rest.at != rest.end && text_next_field(&rest, ',', &field)) {
        char text[256];
        text_copy(text, sizeof text, field);
        char *equals = strchr(text, '=');
        if (!equals)
            return error_set(err, MRT_ERR_ARGUMENT, "%s: \"%s\" is not key=value", self->type->id,
                             text);
        *equals = '\0';
        mrt_result result = instance_set_text(self, text, equals + 1, err);
        if (result < 0)
            return result;
        if (!rest.at)
            break;
    }
    return MRT_OK;
}

void instance_set_value(instance *self, uint32_t index, double value)
{
    const mrt_param *p = &self->type->params[index];
    if (isnan(value))
        return;
    double within = fmin(fmax(value, p->min), p->max);
    if (p->flags & MRT_PARAM_STEPPED)
        within = fmin(fmax(round(within), p->min), p->max);
    atomic_store(&self->wanted[index], within);
}

void instance_copy_values(instance *to, const instance *from)
{
    for (uint32_t i = 0; i < to->type->param_count; ++i) {
        const mrt_param *p = &to->type->params[i];
        for (uint32_t j = 0; j < from->type->param_count; ++j) {
            if (from->type->params[j].id != p->id || (p->flags & MRT_PARAM_TRIGGER))
                continue;
            double value = fmin(fmax(atomic_load(&from->wanted[j]), p->min), p->max);
            atomic_store(&to->wanted[i], p->flags & MRT_PARAM_STEPPED ? floor(value) : value);
        }
    }
}

double instance_value(const instance *self, uint32_t index)
{
    return atomic_load(&self->wanted[index]);
}

void instance_key(const mrt_plugin_type *type, uint32_t index, char *out, size_t capacity)
{
    const mrt_param *p = &type->params[index];
    char key[KEY_LENGTH], other[KEY_LENGTH];
    key_of(key, sizeof key, NULL, p->name);
    bool is_alone = true;
    for (uint32_t i = 0; i < type->param_count; ++i) {
        key_of(other, sizeof other, NULL, type->params[i].name);
        if (i != index && strcmp(key, other) == 0)
            is_alone = false;
    }
    if (!is_alone)
        key_of(key, sizeof key, p->group, p->name);
    (void)snprintf(out, capacity, "%s", key);
}

void instance_trigger(instance *self, uint32_t index)
{
    atomic_store(&self->wanted[index], 1.0);
}

void instance_latch(instance *self)
{
    for (uint32_t i = 0; i < self->type->param_count; ++i) {
        if (self->type->params[i].flags & MRT_PARAM_TRIGGER)
            self->params[i] = atomic_exchange(&self->wanted[i], self->type->params[i].initial);
        else
            self->params[i] = atomic_load_explicit(&self->wanted[i], memory_order_relaxed);
    }
}

void instance_listen(instance *self, error *out_heard, log_once *already_logged)
{
    self->heard = out_heard;
    self->already_logged = already_logged;
    atomic_store(&self->listener, (uintptr_t)pthread_self());
}

void instance_listen_end(instance *self)
{
    atomic_store(&self->listener, 0);
    self->heard = NULL;
    self->already_logged = NULL;
}

mrt_result instance_activate(instance *self, const mapped_face *mapped, error *err)
{
    const mrt_mapping *functions = plugin_interface(self->type, MRT_MAPPING);
    const mrt_rig_poses *poses = plugin_interface(self->type, MRT_RIG_POSES);
    error why = {""};
    instance_listen(self, &why, NULL);
    if (poses)
        poses->set(self->self, &mapped->about, mapped->pose, mapped->pose_count);
    mrt_result result = functions->activate(self->self, &mapped->about);
    instance_listen_end(self);
    if (result < 0)
        return error_set(err, result, "mapping %s cannot be used on this face%s%s", self->type->id,
                         why.text[0] ? ": " : "", why.text);
    return result;
}

void instance_deactivate(instance *self)
{
    const mrt_mapping *functions = plugin_interface(self->type, MRT_MAPPING);
    functions->deactivate(self->self);
}

bool instance_pop_restart(instance *self)
{
    return atomic_exchange(&self->restart_asked, false);
}

bool instance_is_stopping(instance *self)
{
    pthread_mutex_lock(&self->mutex);
    bool stopping = self->stopping;
    pthread_mutex_unlock(&self->mutex);
    return stopping;
}

void instance_stop_waiting(instance *self)
{
    pthread_mutex_lock(&self->mutex);
    self->stopping = true;
    pthread_cond_broadcast(&self->wake);
    pthread_mutex_unlock(&self->mutex);
}
