/* cyberglove/glove_drive.h - a glove by its address: which port it is, also when it comes back as
 * another, or the first port at which a glove answers; then its records one by one, with their
 * times, and what becomes of silence, garbage and a cable that is pulled. [main] [input]; [input]
 * once it is open. */
#ifndef MAROTTE_CYBERGLOVE_DRIVE_H
#define MAROTTE_CYBERGLOVE_DRIVE_H
#include "glove_clock.h"
#include "glove_find.h"
#include "glove_start.h"

enum { /* said once in the life of an instance, however often it is opened */
       GLOVE_TOLD_TOO_FAST = 1,
       GLOVE_TOLD_UNPLUGGED = 2,
       GLOVE_TOLD_STAMPS = 4,
       GLOVE_TOLD_LATENCY = 8,
       GLOVE_TOLD_REFUSED = 16,
       GLOVE_TOLD_READINESS = 32,
       GLOVE_TOLD_HAND = 64,
       GLOVE_TOLD_LINE = 128
};

typedef struct glove_drive {
    const mrt_host *host;
    trace trace; /* the caller opens and closes it */
    glove_settings settings;
    glove_unit unit;
    glove_port port;
    glove_parse parse;
    glove_clock clock;
    uint32_t told;
    bool has_read, has_restarted, is_lost;
    glove_why loss;     /* is_lost: the caller says it */
    bool has_asked;     /* polled: a record is on its way */
    uint32_t skipped;   /* records not worth giving, since the last one given */
    uint32_t unplugged; /* records in a row that say: not plugged into the box */
    int64_t arrival_ns; /* host's clock */
    int64_t good_ns, restarted_ns, resume_ns, asked_ns; /* device_clock_ns */
    size_t bytes_since_good;
    uint8_t status, doubtful_status; /* as believed; as seen once */
} glove_drive;

/* The glove that the instance had, to find it again. */
typedef struct glove_memory {
    bool has_had;
    char address[192]; /* as it was opened */
    glove_found port;  /* path and, if it is known, place */
} glove_memory;

/* root: "" but in tests. On success the drive has begun. */
mrt_result glove_drive_open(glove_drive *drive, const char *address, const char *root,
                            glove_memory *memory, glove_why *why);

/* The address by which it is found wherever its port turns up. */
void glove_drive_address(const glove_found *port, char *out, size_t capacity);

/* MRT_OK, MRT_TIMEOUT, or MRT_ERR_IO: for ever, and why is in `loss`. out_record->lost counts
 * all that are missing before it. */
mrt_result glove_drive_read(glove_drive *self, int64_t deadline_ns, glove_record *out_record,
                            int64_t *out_time_ns);
/* Stops the glove and closes the port. */
void glove_drive_end(glove_drive *self);
bool glove_drive_switch(const glove_drive *self); /* whether it is on */

__attribute__((format(printf, 4, 5))) void glove_drive_tell(glove_drive *self, uint32_t once,
                                                            int32_t level, const char *format, ...);

#endif
