/* plugins/openxr/openxr_record.h - what marotte-openxr-hands writes to its pipe and the plugin
 * (openxr_helper.c) reads: records of one size, each in one write (less than PIPE_BUF). The reader
 * believes nothing: libraries of vendors are loaded into the writer. Pure. */
#ifndef MAROTTE_OPENXR_RECORD_H
#define MAROTTE_OPENXR_RECORD_H
#include <stdbool.h>
#include <stdint.h>

enum { OPENXR_FD = 3, OPENXR_JOINTS = 26, OPENXR_TEXT = 256 };
enum { OPENXR_MAGIC = 0x3152584d };
enum {
    OPENXR_FRAME = 1, /* also while no hand is there: it says that the writer lives */
    OPENXR_NAME = 2,  /* text: the runtime's name */
    OPENXR_END = 3    /* text: why it ends now, and what the person can do */
};

typedef struct openxr_hand {
    uint32_t active;
    uint32_t valid, tracked;    /* bit i: of joint i */
    float at[OPENXR_JOINTS][3]; /* m; palm, wrist, 4 of the thumb, 5 of each finger, tip last */
} openxr_hand;

typedef struct openxr_record {
    uint32_t magic, kind;
    int64_t time_ns; /* of a frame: when the hands were there; CLOCK_MONOTONIC, or the runtime's */
    openxr_hand hand[2]; /* left, right */
    char text[OPENXR_TEXT];
} openxr_record;

/* What the reader makes of one, in place. A frame's hands that are there are sound: what is said to
 * be known of them is a number, and on this planet; the others are all 0. Texts end, and do nothing
 * to a terminal. False: it is no record. */
bool openxr_record_take(openxr_record *record);

#endif
