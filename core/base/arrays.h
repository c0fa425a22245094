/* base/arrays.h - allocates or copies many arrays with one check for memory at the end: arrays that
 * are created and freed together, and copies of structs with many arrays. [thread of the owner] */
#ifndef MAROTTE_BASE_ARRAYS_H
#define MAROTTE_BASE_ARRAYS_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* ---- created and freed together; zeroed: none yet ---- */

typedef struct arrays {
    void **item;
    uint32_t count;
    bool failed; /* at least one allocation failed */
} arrays;

/* Adds a zeroed array of `count` elements. It allocates one more, so that an empty array is not
 * NULL. NULL: no memory. */
void *arrays_add(arrays *a, size_t count, size_t item_size);
void arrays_free(arrays *a); /* frees all arrays and zeroes `a` */

/* ---- copies; the caller frees each ---- */

typedef struct copying {
    bool failed;  /* an allocation failed: later copies may be NULL */
    size_t bytes; /* requested so far */
} copying;

/* Return a copy, or NULL for NULL. */
void *copy_array(copying *c, const void *from, size_t count, size_t item_size);
char *copy_text(copying *c, const char *text);

#endif
