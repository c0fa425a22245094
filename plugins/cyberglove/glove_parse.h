/* cyberglove/glove_parse.h - parser of a CyberGlove's bytes: its records, its answers, and the
 * sensors in a record. A damaged record is lost, but its neighbours never are. Leaves out times,
 * devices and the choice of questions. Pure functions on one struct; no allocation.
 *
 * Records of bytes: HEAD sensors [flags t0 t1 t2 t3] [status] [e s] [e g] NUL. A sensor is never 0,
 * so that the NUL ends a record. Time stamps in ticks of 1/115200 s. Records of words:
 * "HH:MM:SS:ff:n" S, sensors of 2 bytes each, high byte first, CR LF NUL (CyberGlove III). Any byte
 * may be 0. */
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
    unsigned char head; /* 'S' streamed, 'G' polled */
    uint32_t sensor_count;
    bool has_time, has_status; /* only for records of bytes */
} glove_layout;

enum { /* the status byte */
       GLOVE_STATUS_IN = 1,
       GLOVE_STATUS_SWITCH = 2,
       GLOVE_STATUS_LIGHT = 4,
       GLOVE_STATUS_VALID = 128
};

typedef struct glove_record {
    uint16_t sensor[GLOVE_SENSORS_MAX]; /* as sent: 1..255, words 1..4095 */
    uint32_t lost;                      /* damaged records between the previous one and this */
    uint32_t ticks;                     /* with has_time; wraps after 10 h */
    uint8_t status;                     /* 0: none, or not marked as valid */
    bool is_too_fast, is_unplugged;     /* warnings from the glove */
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

size_t glove_layout_size(const glove_layout *layout); /* bytes of a record without warnings */

/* Limits sensor_count to GLOVE_SENSORS_MAX. */
void glove_parse_init(glove_parse *self, const glove_layout *layout);
/* Discards the buffered bytes but keeps the counts. The next bytes may begin inside a record. */
void glove_parse_restart(glove_parse *self);
/* Returns the free space in bytes. Never 0 after glove_parse_next has returned false. */
size_t glove_parse_room(const glove_parse *self);
/* Appends bytes. size: at most glove_parse_room. */
void glove_parse_append(glove_parse *self, const unsigned char *bytes, size_t size);
/* Reads the next record from the buffer. Returns false if more bytes are needed. */
bool glove_parse_next(glove_parse *self, glove_record *out);
/* Returns the number of bytes missing in the current record; 0 if no record has begun. */
size_t glove_parse_missing(const glove_parse *self);

/* Guesses the layout of a glove that does not match `layout`, from four records of one size. Tries
 * time stamp and status first, then 18 and 22 sensors. Records of bytes only. */
bool glove_layout_guess(const unsigned char *bytes, size_t count, glove_layout *layout);

/* Answers to questions and commands, searched in the received bytes. Values may be 0, so they have
 * a fixed length. */

typedef enum glove_reply {
    GLOVE_SILENT = 0, /* no answer so far */
    GLOVE_ANSWERED,
    GLOVE_REFUSED /* "e?", "en", "ey", "es" or "eg" */
} glove_reply;

/* The answer to "?LETTER": '?' LETTER value NUL. */
glove_reply glove_reply_value(const unsigned char *bytes, size_t count, char letter,
                              unsigned char *out_value, size_t value_size);
/* The answer to a command: its letter in either case, optional text, and NUL. */
glove_reply glove_reply_done(const unsigned char *bytes, size_t count, char letter);

/* Sensors of a record, in its order, from the glove's masks: bit 4 * finger + joint, thumb to
 * little finger and carpus; MCP, PIP, DIP, abduction. */

enum { GLOVE_MASK_18 = 0x7BBB3F, GLOVE_MASK_22 = 0x7FFF7F };

typedef struct glove_sensors {
    uint32_t count;
    uint32_t semantic[GLOVE_SENSORS_MAX]; /* MRT_CH_ANGLE + n, or MRT_CH_OTHER */
} glove_sensors;

/* Values reported by the glove; 0: not reported. */
typedef struct glove_reported {
    uint32_t sensor_count;  /* ?S */
    uint32_t hardware_mask; /* ?K */
    uint32_t software_mask; /* ?M */
    uint32_t sent_count;    /* ?N */
} glove_reported;

/* Returns false, with `out` unchanged, if the values do not match a glove. */
bool glove_sensors_find(const glove_reported *census, glove_sensors *out);
/* 18 or 22 sensors. */
void glove_sensors_of_count(uint32_t count, glove_sensors *out);

/* Returns "thumb.roll"; "extra" for a sensor without a meaning. */
const char *glove_sensor_name(uint32_t semantic);

#endif
