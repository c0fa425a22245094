#include "base/arrays.h"

#include <stdlib.h>
#include <string.h>

void *arrays_add(arrays *a, size_t count, size_t item_size)
{
    void **grown = realloc(a->item, (a->count + (size_t)1) * sizeof *grown);
    if (grown)
        a->item = grown;
    void *made = grown ? calloc(count + 1, item_size) : NULL;
    a->failed = a->failed || !made;
    if (made)
        a->item[a->count++] = made;
    return made;
}

void arrays_free(arrays *a)
{
    for (uint32_t i = 0; i < a->count; ++i)
        free(a->item[i]);
    free(a->item);
    *a = (arrays){0};
}

void *copy_array(copying *c, const void *from, size_t count, size_t item_size)
{
    if (!from)
        return NULL;
    void *out = malloc(count * item_size + 1);
    c->failed = c->failed || !out;
    c->bytes += count * item_size;
    if (out)
        memcpy(out, from, count * item_size);
    return out;
}

char *copy_text(copying *c, const char *text)
{
    return copy_array(c, text, text ? strlen(text) + 1 : 0, 1);
}
