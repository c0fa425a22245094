#include "perform_mapping.h"

static mrt_result isolate_mapping(perform_mapping *self, const mrt_plugin_type **type, error *err)
{
    mrt_result result = isolate_create(&self->isolate, *type, self->library, &self->settings, err);
    if (result >= 0)
        *type = isolate_type(self->isolate);
    return result;
}

static bool is_to_be_isolated(const perform_mapping *self, perform_isolation how)
{
    if (how == PERFORM_ISOLATE_AUTO)
        return !plugin_is_shipped(self->library);
    return how == PERFORM_ISOLATE_ON;
}

mrt_result perform_mapping_open(perform_mapping *out, const plugin_spec *spec,
                                const perform_mapping_settings *with, error *err)
{
    const mrt_plugin_type *type;
    *out = (perform_mapping){.settings = {.clock = with->clock, .writes_reports = true}};
    mrt_result result = plugin_list_choose(with->plugins, spec->plugin, MRT_MAPPING, &type, err);
    if (result < 0)
        return result;
    out->library = plugin_list_path_of(with->plugins, type);
    if (is_to_be_isolated(out, with->isolation))
        result = isolate_mapping(out, &type, err);
    if (result >= 0)
        result = instance_create(&out->instance, type, with->clock, with->log, err);
    if (result >= 0)
        result = instance_set_list(&out->instance, spec->params, err);
    return result;
}

mrt_result perform_mapping_watch(perform_mapping *self, const perform_options *options,
                                 performer *of, log_queue *log, error *err)
{
    const reload_settings settings = {.library = self->library,
                                      .mapping = &self->instance,
                                      .about = composer_about(performer_composer(of)),
                                      .log = log,
                                      .clock = self->settings.clock,
                                      .isolate = self->isolate ? &self->settings : NULL};
    if (!options->watches_plugins)
        return MRT_OK;
    return reload_start(&self->reload, &settings, err);
}

void perform_mapping_step(perform_mapping *self, performer *of, recorder *into)
{
    if (!self->reload || !reload_step(self->reload, performer_layer(of)))
        return;
    self->current = layer_mapping(performer_layer(of));
    if (into)
        recorder_change_mapping(into, reload_identity(self->reload));
}

/* Of the first and of the one that performs now; those between are gone. */
static isolate_counts counts_of(const perform_mapping *self)
{
    isolate_counts sum = {0};
    const instance *const both[2] = {&self->instance, self->current};
    for (int i = 0; i < 2; ++i) {
        if (!self->isolate || !both[i] || !both[i]->self || (i > 0 && both[i] == both[0]))
            continue;
        isolate_counts one = isolate_counted(both[i]->self);
        sum.failed += one.failed;
        sum.restarted += one.restarted;
        sum.late += one.late;
        sum.is_away |= one.is_away;
    }
    return sum;
}

mrt_result perform_mapping_check(const perform_mapping *self, error *err)
{
    if (self->settings.clock == CLOCK_REAL)
        return MRT_OK;
    mrt_result result = isolate_check(&self->instance, err);
    return result >= 0 && self->current ? isolate_check(self->current, err) : result;
}

void perform_mapping_report(const perform_mapping *self, facts *told)
{
    isolate_counts counts = counts_of(self);
    if (self->isolate)
        facts_text(told, "isolated", "isolated", "in a process of its own");
    if (counts.failed) {
        facts_number(told, "mapping_failed", "mapping failed", counts.failed, 0, "times");
        facts_number(told, "mapping_restarted", "  restarted", counts.restarted, 0, "times");
    }
    if (counts.late)
        facts_number(told, "mapping_late", "mapping late", counts.late, 0,
                     "samples in which the face was held");
    if (self->reload) {
        reload_counts reloads = reload_counted(self->reload);
        facts_number(told, "reloads", "reloads", reloads.taken, 0, "");
        facts_number(told, "reloads_refused", "  refused", reloads.refused, 0, "");
    }
}

void perform_mapping_close(perform_mapping *self)
{
    reload_stop(self->reload);
    instance_destroy(&self->instance);
    isolate_destroy(self->isolate);
    *self = (perform_mapping){.library = NULL};
}
