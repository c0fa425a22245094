/* cyberglove/glove_find.h - which serial ports there are, where each is plugged in, and what keeps
 * one from being used. Looks only: opens no port. Linux: /sys, /dev, /proc. [main] [input]. */
#ifndef MAROTTE_CYBERGLOVE_FIND_H
#define MAROTTE_CYBERGLOVE_FIND_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { GLOVE_PORTS_MAX = 32, PATH_CAPACITY = 4096 };

typedef struct glove_found {
    char path[128];      /* "/dev/ttyUSB0" */
    char link[160];      /* "/dev/serial/by-path/...", "" if there is none */
    char usb_path[64];   /* USB interface and port: "1-1.4:1.0/0"; stays when path changes */
    char product[64];    /* "FT232R USB UART"; "" if unknown */
    uint32_t likeliness; /* 2: calls itself a glove, 1: an adapter that gloves have, 0 */
} glove_found;

/* USB serial ports, likeliest first, then by usb_path. `root` goes before each path: "" but in
 * tests. Returns how many were written. */
uint32_t glove_find_ports(const char *root, glove_found *out, uint32_t capacity);
/* The port on this usb_path now. */
bool glove_find_usb(const char *root, const char *usb_path, glove_found *out);
/* The port that this path, or a link to it, names now. */
bool glove_find_path(const char *root, const char *path, glove_found *out);

/* Who has it open: "minicom (process 123)"; false, and "": nobody that may be seen. */
bool glove_find_holder(const char *path, char *out, size_t capacity);
/* The same, but for our own descriptor `own`. */
bool glove_find_other_holder(const char *path, int own, char *out, size_t capacity);
bool glove_find_may_open(const char *path);
/* What someone without permission does about it. */
void glove_find_advice(const char *path, char *out, size_t capacity);
/* The path without links; as it was if that cannot be found out. */
void glove_find_real(const char *path, char *out, size_t capacity);

#endif
