/* cyberglove/glove_parse.h - from the bytes that a CyberGlove sends to its records and answers, and
 * which sensors they hold. A damaged record is lost, and its neighbours are not, whatever happened
 * to its bytes. Leaves out times, devices and which questions are asked. Pure functions on one
 * struct; no allocation.
 *
 * Records of bytes:  HEAD sensors [flags t0 t1 t2 t3] [status] [e s] [e g] NUL. A sensor is never
 * 0, so that the NUL ends a record. Time stamps in ticks of 1/115200 s. Records of words:
 * "HH:MM:SS:ff:n" S, sensors of 2 bytes each with the high one first, CR LF NUL (CyberGlove III).
 * Any byte may be 0. */
#ifndef MAROTTE_CYBERGLOVE_PARSE_H
#define MAROTTE_CYBERGLOVE_PARSE_H
#include <marotte/plugin.h>

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { GLOVE_SENSORS_MAX = 24, GLOVE_PARSE_BYTES = 512 };

typedef enum glove_form { GLOVE_BYTES = 0, GLOVE_WORDS = 1 } glove_form;

typedef struct glove_layout {
    glove_form form;
    unsigned char head; /* 'S' streamed, 'G' asked for */
    uint32_t sensor_count;
    bool has_time, has_status; /* of records of bytes */
} glove_layout;

enum { /* the status byte */
       GLOVE_STATUS_IN = 1,
       GLOVE_STATUS_SWITCH = 2,
       GLOVE_STATUS_LIGHT = 4,
       GLOVE_STATUS_VALID = 128
};

typedef struct glove_record {
    uint16_t sensor[GLOVE_SENSORS_MAX]; /* as sent: 1..255, words 1..4095 */
    uint32_t lost;                      /* records damaged between the last one and this */
    uint32_t ticks;                     /* with has_time; wraps after 10 h */
    uint8_t status;                     /* 0: none, or one without its mark of validity */
    bool is_too_fast, is_unplugged;     /* the glove's own complaints */
} glove_record;

typedef struct glove_parse {
    glove_layout layout;
    unsigned char bytes[GLOVE_PARSE_BYTES];
    size_t count;
    size_t torn;    /* bytes dropped since the last NUL */
    size_t garbage; /* bytes dropped since the last good record */
    bool has_record, flags_are_marked;
    uint64_t good_count, lost_count, garbage_bytes;
} glove_parse;

size_t glove_layout_size(const glove_layout *layout); /* of a record without complaints, bytes */

/* sensor_count is cut to GLOVE_SENSORS_MAX. */
void glove_parse_init(glove_parse *self, const glove_layout *layout);
/* Forgets the bytes at hand, not the counts: what follows begins anywhere. */
void glove_parse_restart(glove_parse *self);
/* How many bytes it takes now: never 0 once glove_parse_next has found nothing. */
size_t glove_parse_room(const glove_parse *self);
/* size: at most the room. */
void glove_parse_put(glove_parse *self, const unsigned char *bytes, size_t size);
/* The next record among the bytes at hand; false: more are needed. */
bool glove_parse_next(glove_parse *self, glove_record *out);
/* Bytes that the record begun still lacks; 0: none is begun. */
size_t glove_parse_missing(const glove_parse *self);

/* What glove may send these bytes, if it is not as `layout` says: looks for four records of one
 * size. Tries time stamp and status first, then 18 and 22 sensors. Records of bytes only. */
bool glove_layout_guess(const unsigned char *bytes, size_t count, glove_layout *layout);

/* Answers to questions and orders, found among the bytes that came; values may be 0, so they have a
 * fixed length. */

typedef enum glove_reply {
    GLOVE_SILENT = 0, /* nothing so far that answers it */
    GLOVE_ANSWERED,
    GLOVE_REFUSED /* "e?", "en", "ey", "es" or "eg" */
} glove_reply;

/* The answer to "?LETTER": '?' LETTER value NUL. */
glove_reply glove_reply_value(const unsigned char *bytes, size_t count, char letter,
                              unsigned char *out_value, size_t value_size);
/* The answer to an order: its letter, large or small, perhaps with text, and NUL. */
glove_reply glove_reply_done(const unsigned char *bytes, size_t count, char letter);

/* Which sensors a record holds, in its order, by the glove's masks: bit 4 * finger + joint, thumb
 * to little and carpus; MCP, PIP, DIP, abduction. */

enum { GLOVE_MASK_18 = 0x7BBB3F, GLOVE_MASK_22 = 0x7FFF7F };

typedef struct glove_sensors {
    uint32_t count;
    uint32_t semantic[GLOVE_SENSORS_MAX]; /* MRT_CH_ANGLE + n, or MRT_CH_OTHER */
} glove_sensors;

/* What the glove says of itself; 0 where it does not. */
typedef struct glove_census {
    uint32_t sensor_count;  /* ?S */
    uint32_t hardware_mask; /* ?K */
    uint32_t software_mask; /* ?M */
    uint32_t sent_count;    /* ?N */
} glove_census;

/* False: what it says names no glove (`out` is left alone). */
bool glove_sensors_find(const glove_census *census, glove_sensors *out);
/* 18 or 22 sensors. */
void glove_sensors_of_count(uint32_t count, glove_sensors *out);

/* "thumb.roll"; "extra" for one without a meaning. */
const char *glove_sensor_name(uint32_t semantic);

#endif
