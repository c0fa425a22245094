/* device/glove_box.h - what a CyberGlove's box says: a command's bytes in, replies and records out,
 * as the serial protocol has it (sources: research on hardware, section 1). Two flavours: the old
 * interface unit, and CyberGlove II/III, which refuse some commands. Leaves out time, the line and
 * its faults (glove_line.h, glove_emulator.h). Pure functions on one struct. */
#ifndef MAROTTE_TESTS_DEVICE_GLOVE_BOX_H
#define MAROTTE_TESTS_DEVICE_GLOVE_BOX_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    GLOVE_SENSORS = 22,
    GLOVE_TICKS_PER_S = 115200,
    GLOVE_RECORD_MAX = 160, /* an ASCII record is the longest */
    GLOVE_REPLY_MAX = 160
};

typedef enum glove_flavour {
    GLOVE_CG1 = 0, /* CyberGlove Interface Unit: every command */
    GLOVE_CG2      /* CyberGlove II and III: no D, N, T, B, Q; "?T" says zeros */
} glove_flavour;

/* What the sources leave open is chosen here. */
typedef struct glove_model {
    glove_flavour flavour;
    uint32_t sensor_count; /* 18 or 22 */
    bool is_right;
    uint32_t native_hz; /* rate of "t N 0", and of flavours without T */
    uint32_t baud;
    bool has_bare_stamp_flags; /* bit 7 clear, as ViSTA saw it; the manual says that it is set */
    bool refuses_each_byte;    /* a refused command's parameters are commands of their own */
    bool has_little_end_words; /* in the binary T */
} glove_model;

typedef struct glove_box {
    glove_model model;
    bool stamp, status, filter, switch_lights, light, wrist_switch, quantised;
    bool is_unplugged;
    uint32_t hardware_mask, software_mask, sent_count;
    uint32_t period_word[2]; /* the sample period is their product in ticks */
    uint32_t baud;
    uint8_t baud_byte;
    uint8_t pending[40]; /* a command that is not complete yet */
    size_t pending_size;
} glove_box;

void glove_box_init(glove_box *box, const glove_model *model);

typedef enum glove_action {
    GLOVE_WAIT = 0, /* the command is not complete, or was no command */
    GLOVE_ANSWER,   /* the reply alone */
    GLOVE_RECORD,   /* send one record with the head `head` */
    GLOVE_STREAM,   /* send records with that head until stopped */
    GLOVE_STOP,     /* stop the stream, then the reply */
    GLOVE_RESTART   /* stop, be deaf for 1.75 s, then the reply */
} glove_action;

typedef struct glove_reply {
    glove_action action;
    uint8_t head; /* 'G' or 'S', 'g' or 's' for ASCII records */
    uint8_t bytes[GLOVE_REPLY_MAX];
    size_t size;
} glove_reply;

void glove_box_receive(glove_box *box, uint8_t byte, glove_reply *out);

enum { GLOVE_MARK_FAST = 1, GLOVE_MARK_UNPLUGGED = 2 }; /* "es", "eg" */
/* sensor: GLOVE_SENSORS raw values in the order of the 22-sensor record, 1..255. Writes at most
 * GLOVE_RECORD_MAX bytes, returns how many. */
size_t glove_box_record(const glove_box *box, uint8_t head, const uint8_t *sensor, uint32_t tick,
                        unsigned marks, uint8_t *out);
/* Which of the GLOVE_SENSORS a record holds now, in its order; returns how many. */
uint32_t glove_box_sent(const glove_box *box, uint32_t *out_sensor);

int64_t glove_box_period_ns(const glove_box *box);

#endif
