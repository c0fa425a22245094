#include "window/mapping_panel_steps.h"

#include "stage/device_list.h"
#include "window/presets.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TEXT = PRESET_TEXT + 256 };

typedef struct change {
    uint32_t id; /* of the parameter: stays when the plugin is reloaded */
    double value[2];
} change;

typedef struct step {
    char *type_id; /* values: of this mapping */
    change *changes;
    uint32_t change_count;
    char *text[2]; /* another mapping: before and after; NULL: values */
    char *preset;  /* a key of the settings: text is its value there, NULL none; NULL: no preset */
} step;

struct mapping_steps {
    studio *studio;
    step *steps;
    uint32_t count, capacity, preset_edition;
};

enum { BEFORE = 0, AFTER = 1 };

static bool same(double a, double b)
{
    return a >= b && a <= b;
}

/* ---- a mapping in words ---- */

static bool is_short_name_free(const plugin_list *plugins, const mrt_plugin_type *type)
{
    const char *name = device_list_plugin_name(type);
    for (uint32_t i = 0; i < plugins->entry_count; ++i) {
        const mrt_plugin_type *other = plugins->entry[i].type;
        if (strcmp(other->id, type->id) != 0 && plugin_interface(other, MRT_MAPPING) &&
            strcmp(device_list_plugin_name(other), name) == 0)
            return false;
    }
    return true;
}

void mapping_steps_text(studio *of, char *out, size_t capacity)
{
    instance *mapping = live_mapping(studio_live(of));
    char values[PRESET_TEXT];
    out[0] = '\0';
    if (!mapping)
        return;
    presets_text(mapping, values, sizeof values);
    bool is_short = is_short_name_free(studio_plugins(of), mapping->type);
    (void)snprintf(out, capacity, "%s%s%s",
                   is_short ? device_list_plugin_name(mapping->type) : mapping->type->id,
                   values[0] ? "," : "", values);
}

/* ---- doing it ---- */

static void say(mapping_steps *self, int32_t level, const char *text)
{
    news_list_add(studio_news(self->studio), level, "mapping", text);
}

static void set_preset(mapping_steps *self, const char *key, const char *text)
{
    settings_set_text(studio_settings(self->studio), key, text);
    self->preset_edition += 1;
}

static void go_to(mapping_steps *self, const step *of, int side)
{
    error err = {""};
    instance *mapping = live_mapping(studio_live(self->studio));
    if (of->preset) {
        set_preset(self, of->preset, of->text[side]);
        return;
    }
    if (of->text[side]) {
        if (live_set_mapping(studio_live(self->studio), of->text[side], &err) < 0)
            say(self, MRT_LOG_ERROR, err.text);
        return;
    }
    if (!mapping || strcmp(mapping->type->id, of->type_id) != 0) {
        say(self, MRT_LOG_WARNING, "that parameter is of another mapping: nothing has changed");
        return;
    }
    for (uint32_t i = 0; i < of->change_count; ++i)
        for (uint32_t k = 0; k < mapping->type->param_count; ++k)
            if (mapping->type->params[k].id == of->changes[i].id)
                instance_set_value(mapping, k, of->changes[i].value[side]);
}

static void undo(void *owner, uint64_t number)
{
    mapping_steps *self = owner;
    if (number < self->count)
        go_to(self, &self->steps[number], BEFORE);
}

static void redo(void *owner, uint64_t number)
{
    mapping_steps *self = owner;
    if (number < self->count)
        go_to(self, &self->steps[number], AFTER);
}

/* ---- keeping it ---- */

static void finish(step *of)
{
    free(of->type_id);
    free(of->changes);
    free(of->preset);
    free(of->text[BEFORE]);
    free(of->text[AFTER]);
}

/* Takes the step over. Without memory it is done, but cannot be undone. */
static void keep(mapping_steps *self, step *made, const char *words)
{
    if (self->count == self->capacity) {
        uint32_t capacity = self->capacity ? 2 * self->capacity : 64;
        step *grown = realloc(self->steps, capacity * sizeof *grown);
        if (!grown) {
            finish(made);
            return;
        }
        self->steps = grown;
        self->capacity = capacity;
    }
    self->steps[self->count] = *made;
    studio_step told = {.owner = self, .undo = undo, .redo = redo, .number = self->count};
    (void)snprintf(told.words, sizeof told.words, "%s", words);
    self->count += 1;
    studio_did(self->studio, &told);
}

void mapping_steps_set(mapping_steps *self, const double *values, const char *words)
{
    instance *mapping = live_mapping(studio_live(self->studio));
    if (!mapping)
        return;
    uint32_t count = mapping->type->param_count;
    step made = {.type_id = strdup(mapping->type->id),
                 .changes = calloc((size_t)count + 1, sizeof(change))};
    for (uint32_t i = 0; i < count; ++i) {
        const mrt_param *p = &mapping->type->params[i];
        double before = instance_value(mapping, i);
        if (p->flags & MRT_PARAM_TRIGGER || same(before, values[i]))
            continue;
        instance_set_value(mapping, i, values[i]);
        if (made.changes)
            made.changes[made.change_count++] =
                (change){p->id, {before, instance_value(mapping, i)}};
    }
    if (made.type_id && made.changes && made.change_count > 0)
        keep(self, &made, words);
    else
        finish(&made);
}

void mapping_steps_note(mapping_steps *self, uint32_t index, double before)
{
    instance *mapping = live_mapping(studio_live(self->studio));
    if (!mapping || index >= mapping->type->param_count)
        return;
    const mrt_param *p = &mapping->type->params[index];
    double after = instance_value(mapping, index);
    char words[EDIT_TEXT];
    if (same(before, after))
        return;
    (void)snprintf(words, sizeof words, "%.60s: %.60s %g%s%.20s", mapping->type->name, p->name,
                   after, p->unit[0] ? " " : "", p->unit);
    step made = {
        .type_id = strdup(mapping->type->id), .changes = malloc(sizeof(change)), .change_count = 1};
    if (made.type_id && made.changes) {
        made.changes[0] = (change){p->id, {before, after}};
        keep(self, &made, words);
    } else {
        finish(&made);
    }
}

void mapping_steps_choose(mapping_steps *self, const char *name)
{
    char before[TEXT], after[TEXT], words[EDIT_TEXT];
    error err = {""};
    mapping_steps_text(self->studio, before, sizeof before);
    if (live_set_mapping(studio_live(self->studio), name, &err) < 0) {
        say(self, MRT_LOG_ERROR, err.text);
        return;
    }
    mapping_steps_text(self->studio, after, sizeof after);
    (void)snprintf(words, sizeof words, "mapping %.100s", name[0] ? name : "none");
    step made = {.text = {strdup(before), strdup(after)}};
    if (made.text[BEFORE] && made.text[AFTER] && strcmp(before, after) != 0)
        keep(self, &made, words);
    else
        finish(&made);
}

/* text: of the preset from now on; NULL: none. Without memory it is done, but cannot be undone. */
static void change_preset(mapping_steps *self, const mrt_plugin_type *type, const char *name,
                          const char *text)
{
    char key[PRESET_KEY], words[EDIT_TEXT];
    presets_key(key, type, name);
    const char *before = presets_kept(studio_settings(self->studio), type, name);
    if (before == text || (before && text && strcmp(before, text) == 0))
        return;
    step made = {.preset = strdup(key),
                 .text = {before ? strdup(before) : NULL, text ? strdup(text) : NULL}};
    const bool is_whole =
        made.preset && !before == !made.text[BEFORE] && !text == !made.text[AFTER];
    set_preset(self, key, text);
    (void)snprintf(words, sizeof words, "preset '%s' %s", name, text ? "saved" : "deleted");
    if (is_whole)
        keep(self, &made, words);
    else
        finish(&made);
}

void mapping_steps_save_preset(mapping_steps *self, const char *name)
{
    char text[PRESET_TEXT];
    const instance *mapping = live_mapping(studio_live(self->studio));
    if (!mapping)
        return;
    presets_text(mapping, text, sizeof text);
    change_preset(self, mapping->type, name, text);
}

void mapping_steps_delete_preset(mapping_steps *self, const char *name)
{
    const instance *mapping = live_mapping(studio_live(self->studio));
    if (mapping)
        change_preset(self, mapping->type, name, NULL);
}

uint32_t mapping_steps_preset_edition(const mapping_steps *self)
{
    return self->preset_edition;
}

mapping_steps *mapping_steps_create(studio *of)
{
    mapping_steps *self = calloc(1, sizeof *self);
    if (self)
        self->studio = of;
    return self;
}

void mapping_steps_destroy(mapping_steps *self)
{
    if (!self)
        return;
    studio_forget_steps(self->studio, self);
    for (uint32_t i = 0; i < self->count; ++i)
        finish(&self->steps[i]);
    free(self->steps);
    free(self);
}
