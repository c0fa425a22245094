/* cyberglove/glove_drive.h - a glove by its address: finds its port, even if the port's name
 * changes, or the first port at which a glove answers. Then reads its records with their times, and
 * handles silence, garbage and a pulled cable. [main] [input]; only [input] while open. */
#ifndef MAROTTE_CYBERGLOVE_DRIVE_H
#define MAROTTE_CYBERGLOVE_DRIVE_H
#include "glove_clock.h"
#include "glove_find.h"
#include "glove_start.h"

enum { /* bits of `told`: messages logged once per instance, however often it is opened */
       GLOVE_LOGGED_TOO_FAST = 1,
       GLOVE_LOGGED_UNPLUGGED = 2,
       GLOVE_LOGGED_STAMPS = 4,
       GLOVE_LOGGED_LATENCY = 8,
       GLOVE_LOGGED_REFUSED = 16,
       GLOVE_LOGGED_READINESS = 32,
       GLOVE_LOGGED_HAND = 64,
       GLOVE_LOGGED_LINE = 128
};

typedef struct glove_drive {
    const mrt_host *host;
    trace trace; /* opened and closed by the caller */
    glove_settings settings;
    glove_unit unit;
    glove_port port;
    glove_parse parse;
    glove_clock clock;
    uint32_t told;
    bool has_read, has_restarted, is_lost;
    glove_error loss;   /* reason while is_lost; the caller logs it */
    bool has_asked;     /* polled: a record was requested and has not arrived */
    uint32_t skipped;   /* records dropped since the last one returned */
    uint32_t unplugged; /* consecutive records with the flag "not plugged into the box" */
    int64_t arrival_ns; /* host's clock */
    int64_t good_ns, restarted_ns, resume_ns, asked_ns; /* device_clock_ns */
    size_t bytes_since_good;
    uint8_t status, doubtful_status; /* confirmed status; status seen once */
} glove_drive;

/* The last glove of the instance, to find it again. */
typedef struct glove_memory {
    bool has_had;
    char address[192]; /* as passed to open */
    glove_found port;  /* path, and USB port if known */
} glove_memory;

/* Opens the glove and starts reading. root: prefix of all paths, "" except in tests. */
mrt_result glove_drive_open(glove_drive *drive, const char *address, const char *root,
                            glove_memory *memory, glove_error *why);

/* Writes an address that stays valid if the port's name changes. */
void glove_drive_address(const glove_found *port, char *out, size_t capacity);

/* Returns MRT_OK, MRT_TIMEOUT, or MRT_ERR_IO, which is permanent, with the reason in `loss`.
 * out_record->lost counts all records missing before it. */
mrt_result glove_drive_read(glove_drive *self, int64_t deadline_ns, glove_record *out_record,
                            int64_t *out_time_ns);
/* Stops the glove and closes the port. */
void glove_drive_end(glove_drive *self);
bool glove_drive_switch(const glove_drive *self); /* state of the switch at the wrist */

__attribute__((format(printf, 4, 5))) void
glove_drive_log_once(glove_drive *self, uint32_t once, int32_t level, const char *format, ...);

#endif
