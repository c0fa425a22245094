/* [main] Which mappings take the face that is on the stage. */
#include "stage/live/live_state.h"

#include <stdio.h>
#include <string.h>

mrt_result live_check_mapping(const live_settings *settings, const char *text, error *err)
{
    live_mapping_role *made;
    mrt_result result = live_mapping_create(&made, text, settings->plugins, settings->log, err);
    live_mapping_destroy(made);
    return result;
}

/* A process of its own for one that did not come with the program, as on the stage. */
static bool takes(live *self, const char *id, const mrt_face *about)
{
    error heard = {""}, ignored = {""};
    live_mapping_role *role;
    if (live_mapping_create(&role, id, self->settings.plugins, NULL, &ignored) < 0)
        return false;
    const mrt_mapping *functions = plugin_interface(role->instance.type, MRT_MAPPING);
    instance_listen(&role->instance, &heard, NULL);
    bool is_taken = functions->activate(role->instance.self, about) >= 0;
    instance_listen_end(&role->instance);
    if (is_taken)
        live_mapping_deactivate(&role->instance);
    live_mapping_destroy(role);
    return is_taken;
}

void live_list_fitting(live *self, char *out, size_t capacity)
{
    const plugin_list *plugins = self->settings.plugins;
    const mrt_face *about = composer_about(performer_composer(self->scene->performer));
    size_t used = 0;
    out[0] = '\0';
    for (uint32_t i = 0; i < plugins->entry_count; ++i) {
        const char *id = plugins->entry[i].type->id, *dot = strrchr(id, '.');
        const char *name = dot ? dot + 1 : id;
        if (!plugin_interface(plugins->entry[i].type, MRT_MAPPING) ||
            used + strlen(name) + 3 > capacity || !takes(self, id, about))
            continue;
        used += (size_t)snprintf(out + used, capacity - used, "%s%s", used ? ", " : "", name);
    }
}
