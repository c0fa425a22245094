/* base/arrays.h - many arrays at a time, with one question at the end whether there was memory for
 * all of them: arrays that are made and freed together, and copies of what owns many. An owner's
 * thread. */
#ifndef MAROTTE_BASE_ARRAYS_H
#define MAROTTE_BASE_ARRAYS_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* ---- made and freed together; zeroed: none yet ---- */

typedef struct arrays {
    void **item;
    uint32_t count;
    bool failed; /* there was no memory for some */
} arrays;

/* Zeroed, and one more than `count`, so that an empty one is there too. NULL: no memory. */
void *arrays_add(arrays *a, size_t count, size_t item_size);
void arrays_free(arrays *a); /* all of them; `a` is zeroed */

/* ---- copies, each to be freed by whom it is for ---- */

typedef struct copying {
    bool failed;  /* there was no memory: what is copied from then on may be NULL */
    size_t bytes; /* that were asked for */
} copying;

void *copy_array(copying *c, const void *from, size_t count, size_t item_size); /* NULL of NULL */
char *copy_text(copying *c, const char *text);                                  /* likewise */

#endif
