#include "stage/live/live_mapping.h"
#include "stage/mapping/null_mapping.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static mrt_result find_type(live_mapping_role *self, const plugin_list *plugins,
                            const mrt_plugin_type **out, const char **out_params, error *err)
{
    size_t length = strcspn(self->text, ",");
    *out_params = self->text[length] == ',' ? self->text + length + 1 : "";
    *out = &null_mapping_type;
    if (length == 0)
        return MRT_OK;
    char *name = strndup(self->text, length);
    if (!name)
        return error_set(err, MRT_ERR_MEMORY, "no memory for a mapping");
    mrt_result result = plugin_list_find(plugins, name, MRT_MAPPING, out, err);
    free(name);
    if (result < 0)
        return result;
    self->library = plugin_list_path_of(plugins, *out);
    if (!isolate_is_wanted(ISOLATE_FOREIGN, self->library))
        return MRT_OK;
    result = isolate_create_mapping(&self->isolate, *out, self->library, &self->isolation, err);
    if (result >= 0)
        *out = isolate_type(self->isolate);
    return result;
}

mrt_result live_mapping_create(live_mapping_role **out, const char *text,
                               const plugin_list *plugins, log_queue *log, error *err)
{
    const mrt_plugin_type *type = NULL;
    const char *params = "";
    *out = NULL;
    live_mapping_role *self = calloc(1, sizeof *self);
    if (self)
        self->text = strdup(text ? text : "");
    if (!self || !self->text) {
        free(self);
        return error_set(err, MRT_ERR_MEMORY, "no memory for a mapping");
    }
    self->isolation = (isolate_settings){.clock = CLOCK_REAL, .writes_reports = true};
    mrt_result result = find_type(self, plugins, &type, &params, err);
    if (result >= 0)
        result = instance_create(&self->instance, type, CLOCK_REAL, log, err);
    if (result >= 0)
        result = instance_set_list(&self->instance, params, err);
    if (result < 0) {
        live_mapping_destroy(self);
        return result;
    }
    *out = self;
    return MRT_OK;
}

mrt_result live_mapping_watch(live_mapping_role *self, const mrt_face *about, log_queue *log,
                              error *err)
{
    const reload_settings settings = {.library = self->library,
                                      .mapping = &self->instance,
                                      .about = about,
                                      .log = log,
                                      .clock = CLOCK_REAL,
                                      .isolate = self->isolate ? &self->isolation : NULL,
                                      .is_asked = true};
    return self->library ? reload_start(&self->reload, &settings, err) : MRT_OK;
}

instance *live_mapping_now(live_mapping_role *self)
{
    return self->reload ? reload_current(self->reload) : &self->instance;
}

bool live_mapping_is_nothing(const live_mapping_role *self)
{
    return self->instance.type == &null_mapping_type;
}

isolate_counts live_mapping_isolated(live_mapping_role *self)
{
    const instance *now = live_mapping_now(self);
    return self->isolate && now->self ? isolate_counted(now->self) : (isolate_counts){0};
}

void live_mapping_deactivate(instance *pulled)
{
    const mrt_mapping *functions = plugin_interface(pulled->type, MRT_MAPPING);
    functions->deactivate(pulled->self);
}

void live_mapping_destroy(live_mapping_role *self)
{
    if (!self)
        return;
    reload_stop(self->reload);
    instance_destroy(&self->instance);
    isolate_destroy(self->isolate);
    free(self->text);
    free(self);
}
