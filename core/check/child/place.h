/* check/child/place.h - where in the plugin something happened, for people: "hold+0x1c
 * (broken.so+0x11a4)". Reads the plugin's own symbols, hidden ones too. Linux, ELF. One thread. */
#ifndef MAROTTE_CHECK_CHILD_PLACE_H
#define MAROTTE_CHECK_CHILD_PLACE_H
#include <stdbool.h>
#include <stddef.h>

/* After dlopen: finds where the library lies in memory. Without it every place is unknown. */
void place_learn(const char *library_path);

enum { PLACE_FRAMES = 32 };
typedef struct place {
    void *frame[PLACE_FRAMES]; /* return addresses, the innermost first */
    int count;
} place;

/* The stack of the caller. No allocation after place_learn. */
void place_take(place *out);
/* The innermost function of the plugin; false, and "an unknown place": none is on the stack. */
bool place_name(const place *where, char *out, size_t capacity);
/* Whether the address lies in the plugin. */
bool place_is_inside(const void *address);

#endif
