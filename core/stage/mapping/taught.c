#include "stage/mapping/taught.h"
#include "stage/mapping/plugins.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

size_t taught_save(const instance *mapping, void *bytes, size_t capacity)
{
    const mrt_state *state = plugin_interface(mapping->type, MRT_STATE);
    size_t size = state ? state->save(mapping->self, bytes, capacity) : 0;
    return size <= TAUGHT_BYTES_MAX ? size : 0;
}

mrt_result taught_load(const instance *mapping, const void *bytes, size_t size, error *err)
{
    const mrt_state *state = plugin_interface(mapping->type, MRT_STATE);
    if (state && state->load(mapping->self, bytes, size) >= 0)
        return MRT_OK;
    return error_set(err, MRT_ERR_FORMAT, "mapping %s cannot read its saved taught values",
                     mapping->type->id);
}

/* ---- as text ---- */

char *taught_text(const void *bytes, size_t size)
{
    static const char digit[] = "0123456789abcdef";
    const unsigned char *from = bytes;
    char *out = malloc(2 * size + 1);
    if (!out)
        return NULL;
    for (size_t i = 0; i < size; ++i) {
        out[2 * i] = digit[from[i] >> 4];
        out[2 * i + 1] = digit[from[i] & 15];
    }
    out[2 * size] = '\0';
    return out;
}

static int value_of(char c)
{
    return c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

size_t taught_parse_text(char *text)
{
    unsigned char *out = (unsigned char *)text;
    size_t length = strlen(text);
    for (size_t i = 0; i + 1 < length; i += 2) {
        int high = value_of(text[i]), low = value_of(text[i + 1]);
        if (high < 0 || low < 0)
            return 0;
        out[i / 2] = (unsigned char)(16 * high + low);
    }
    return length % 2 == 0 ? length / 2 : 0;
}

/* ---- a note of the show ---- */

static void key_of(char out[160], const mrt_plugin_type *type)
{
    (void)snprintf(out, 160, "taught.%.140s", type->id);
}

mrt_result taught_keep(show *into, const mrt_plugin_type *type, const void *bytes, size_t size,
                       error *err)
{
    char key[160];
    if (!into || !show_is_writable(into) || size == 0)
        return MRT_OK;
    char *text = taught_text(bytes, size);
    if (!text)
        return error_set(err, MRT_ERR_MEMORY, "no memory to save the taught values of a mapping");
    key_of(key, type);
    mrt_result result = show_note_write(into, key, text, err);
    free(text);
    return result;
}

void taught_keep_now(show *into, const instance *mapping, log_queue *log)
{
    error err = {""};
    size_t size = taught_save(mapping, NULL, 0);
    unsigned char *bytes = size > 0 ? malloc(size) : NULL;
    if (!bytes)
        return;
    size = taught_save(mapping, bytes, size);
    if (taught_keep(into, mapping->type, bytes, size, &err) < 0)
        log_push(log, MRT_LOG_WARNING, "show", err.text);
    free(bytes);
}

void taught_restore(show *of, const instance *mapping, log_queue *log)
{
    enum { TEXT = 2 * TAUGHT_BYTES_MAX + 1 };
    char key[160];
    error err = {""};
    if (!of || !plugin_interface(mapping->type, MRT_STATE))
        return;
    char *text = calloc(TEXT, 1);
    if (!text)
        return;
    key_of(key, mapping->type);
    mrt_result result = show_note_read(of, key, text, TEXT, &err);
    size_t size = result >= 0 && text[0] ? taught_parse_text(text) : 0;
    if (size > 0)
        result = taught_load(mapping, text, size, &err);
    else if (result >= 0 && text[0])
        result = error_set(&err, MRT_ERR_FORMAT, "the taught values of %s in this show are damaged",
                           mapping->type->id);
    if (result < 0)
        log_push(log, MRT_LOG_WARNING, "show", err.text);
    free(text);
}
