#include "window/app/presets.h"
#include "base/text.h"
#include "stage/input/device_list.h"
#include "stage/mapping/isolate.h"
#include "stage/mapping/taught.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool presets_clean_name(char out[PRESET_NAME], const char *name)
{
    text_view trimmed = text_trim(text_view_of(name, strlen(name)));
    size_t length = (size_t)(trimmed.end - trimmed.at);
    if (length == 0 || length >= PRESET_NAME)
        return false;
    for (size_t i = 0; i < length; ++i) {
        char c = trimmed.at[i];
        if ((unsigned char)c < 0x20 || c == 0x7f)
            return false;
        out[i] = c == '.' ? '-' : c;
    }
    out[length] = '\0';
    return true;
}

static void key_of_list(char out[PRESET_KEY], const mrt_plugin_type *type)
{
    (void)snprintf(out, PRESET_KEY, "mapping.%.100s.preset", plugin_short_name(type));
}

void presets_key(char out[PRESET_KEY], const mrt_plugin_type *type, const char *name)
{
    char list[PRESET_KEY];
    key_of_list(list, type);
    (void)snprintf(out, PRESET_KEY, "%.180s.%.50s", list, name);
}

uint32_t presets_list(const settings *of, const mrt_plugin_type *type, char ***out)
{
    char key[PRESET_KEY];
    key_of_list(key, type);
    return settings_keys(of, key, out);
}

const char *presets_kept(const settings *of, const mrt_plugin_type *type, const char *name)
{
    char key[PRESET_KEY];
    presets_key(key, type, name);
    return settings_text(of, key, NULL);
}

void presets_text(const instance *mapping, char *out, size_t capacity)
{
    size_t used = 0;
    out[0] = '\0';
    for (uint32_t i = 0; i < mapping->type->param_count; ++i) {
        const mrt_param *p = &mapping->type->params[i];
        double value = instance_value(mapping, i);
        if (p->flags & MRT_PARAM_TRIGGER || (value >= p->initial && value <= p->initial))
            continue;
        char key[128], one[192];
        instance_key(mapping->type, i, key, sizeof key);
        int length = snprintf(one, sizeof one, "%s%s=%.9g", used ? "," : "", key, value);
        if (length < 0 || (size_t)length >= sizeof one || used + (size_t)length >= capacity)
            return;
        memcpy(out + used, one, (size_t)length + 1);
        used += (size_t)length;
    }
}

void presets_mapping_text(const instance *mapping, char *out, size_t capacity)
{
    char values[PRESET_TEXT];
    out[0] = '\0';
    if (!mapping)
        return;
    presets_text(mapping, values, sizeof values);
    (void)snprintf(out, capacity, "%s%s%s", isolate_inner(mapping->type)->id, values[0] ? "," : "",
                   values);
}

/* ---- what was taught: the last field, which no parameter's key can begin ---- */

static const char taught_word[] = "taught:";

/* Behind the word; NULL: it was taught nothing. */
static const char *find_taught(const char *text)
{
    const char *at = strstr(text, taught_word);
    return at && (at == text || at[-1] == ',') ? at + sizeof taught_word - 1 : NULL;
}

char *presets_make(const instance *mapping, const void *taught, size_t size)
{
    char values[PRESET_TEXT];
    presets_text(mapping, values, sizeof values);
    char *bytes = size > 0 ? taught_text(taught, size) : NULL;
    if (size > 0 && !bytes)
        return NULL;
    size_t capacity = strlen(values) + sizeof taught_word + 2 * size + 2;
    char *out = malloc(capacity);
    if (out)
        (void)snprintf(out, capacity, "%s%s%s%s", values, values[0] && bytes ? "," : "",
                       bytes ? taught_word : "", bytes ? bytes : "");
    free(bytes);
    return out;
}

bool presets_has_values(const char *text, const char *values)
{
    const char *taught = find_taught(text);
    size_t length = taught ? (size_t)(taught - text) - (sizeof taught_word - 1) : strlen(text);
    if (length > 0 && taught)
        length -= 1; /* the ',' before it */
    return strlen(values) == length && strncmp(values, text, length) == 0;
}

mrt_result presets_taught(const char *text, unsigned char **out, size_t *out_size, error *err)
{
    const char *taught = find_taught(text);
    *out = NULL;
    *out_size = 0;
    if (!taught)
        return MRT_OK;
    char *bytes = strlen(taught) <= 2 * PRESET_TAUGHT_MAX ? strdup(taught) : NULL;
    size_t size = bytes ? taught_parse_text(bytes) : 0;
    if (size == 0) {
        free(bytes);
        return error_set(err, MRT_ERR_FORMAT, "the learned data of the preset is damaged");
    }
    *out = (unsigned char *)bytes;
    *out_size = size;
    return MRT_OK;
}

static bool is_button(const mrt_param *p)
{
    return (p->flags & MRT_PARAM_TRIGGER) != 0;
}

static bool find(const mrt_plugin_type *type, const char *key, uint32_t *out)
{
    char own[128];
    for (*out = 0; *out < type->param_count; ++*out) {
        instance_key(type, *out, own, sizeof own);
        if (!is_button(&type->params[*out]) && strcmp(own, key) == 0)
            return true;
    }
    return false;
}

/* "key=value" */
static void read_one(const mrt_plugin_type *type, char *text, double *out_values, error *out_note)
{
    char *equals = strchr(text, '=');
    double value;
    uint32_t index;
    if (equals)
        *equals = '\0';
    bool is_known = equals && find(type, text, &index);
    if (is_known && text_double(text_view_of(equals + 1, strlen(equals + 1)), &value) &&
        value >= type->params[index].min && value <= type->params[index].max)
        out_values[index] = value;
    else if (!out_note->text[0])
        (void)error_set(out_note, MRT_ERR_FORMAT, "%s: \"%s\" of the preset is %s", type->name,
                        text,
                        is_known ? "out of range: the default is used"
                                 : "not a parameter any more: it is skipped");
}

void presets_values(const mrt_plugin_type *type, const char *text, double *out_values,
                    error *out_note)
{
    out_note->text[0] = '\0';
    for (uint32_t i = 0; i < type->param_count; ++i)
        out_values[i] = type->params[i].initial;
    text_view rest = text_view_of(text, strlen(text)), field;
    const char *taught = find_taught(text);
    if (taught)
        rest.end = taught - (sizeof taught_word - 1);
    while (rest.at != rest.end && text_next_field(&rest, ',', &field)) {
        char one[256];
        if (field.at == field.end)
            break; /* before what was taught */
        text_copy(one, sizeof one, field);
        read_one(type, one, out_values, out_note);
        if (!rest.at)
            break;
    }
}
