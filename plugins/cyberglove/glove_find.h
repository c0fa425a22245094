/* cyberglove/glove_find.h - list of the serial ports, the USB port of each, and the reasons why a
 * port cannot be used. Opens no port. Linux: /sys, /dev, /proc. [main] [input]. */
#ifndef MAROTTE_CYBERGLOVE_FIND_H
#define MAROTTE_CYBERGLOVE_FIND_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { GLOVE_PORTS_MAX = 32, PATH_CAPACITY = 4096 };

typedef struct glove_found {
    char path[128];      /* "/dev/ttyUSB0" */
    char link[160];      /* "/dev/serial/by-path/...", "" if none exists */
    char usb_path[64];   /* USB interface and port: "1-1.4:1.0/0"; constant when path changes */
    char product[64];    /* "FT232R USB UART"; "" if unknown */
    uint32_t likeliness; /* 2: named as a glove, 1: a usual adapter of gloves, 0: other */
} glove_found;

/* Lists USB serial ports, likeliest first, then by usb_path. `root`: prefix of all paths, "" except
 * in tests. Returns the number written. */
uint32_t glove_find_ports(const char *root, glove_found *out, uint32_t capacity);
/* Finds the current port at this usb_path. */
bool glove_find_usb(const char *root, const char *usb_path, glove_found *out);
/* Finds the port that this path or link refers to now. */
bool glove_find_path(const char *root, const char *path, glove_found *out);

/* Names the process that has the port open: "minicom (process 123)". Returns false and "" if no
 * visible process has it. */
bool glove_find_holder(const char *path, char *out, size_t capacity);
/* The same, without our own descriptor `own`. */
bool glove_find_other_holder(const char *path, int own, char *out, size_t capacity);
bool glove_find_can_open(const char *path);
/* Writes what a user without permission can do. */
void glove_find_advice(const char *path, char *out, size_t capacity);
/* Resolves links in the path. Copies the path unchanged if that fails. */
void glove_find_real(const char *path, char *out, size_t capacity);

#endif
