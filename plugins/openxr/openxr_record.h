/* plugins/openxr/openxr_record.h - records that marotte-openxr-hands writes to its pipe and the
 * plugin (openxr_helper.c) reads. All have one size, and each is written in one write (less than
 * PIPE_BUF). The reader validates everything, because vendors' libraries run in the writer.
 * Pure. */
#ifndef MAROTTE_OPENXR_RECORD_H
#define MAROTTE_OPENXR_RECORD_H
#include <stdbool.h>
#include <stdint.h>

enum { OPENXR_FD = 3, OPENXR_JOINTS = 26, OPENXR_TEXT = 256 };
enum { OPENXR_MAGIC = 0x3152584d };
enum {
    OPENXR_FRAME = 1, /* also sent without a hand, to show that the writer runs */
    OPENXR_NAME = 2,  /* text: the runtime's name */
    OPENXR_END = 3    /* text: reason for the end, and advice for the user */
};

typedef struct openxr_hand {
    uint32_t active;
    uint32_t valid, tracked;    /* bit i: of joint i */
    float at[OPENXR_JOINTS][3]; /* m; palm, wrist, 4 of the thumb, 5 of each finger, tip last */
} openxr_hand;

typedef struct openxr_record {
    uint32_t magic, kind;
    int64_t time_ns;     /* time of the hands in a frame; CLOCK_MONOTONIC, or the runtime's clock */
    openxr_hand hand[2]; /* left, right */
    char text[OPENXR_TEXT];
} openxr_record;

/* Validates a record in place. In a frame, every coordinate marked as valid is a finite number of
 * plausible size, and hands that are not active are all 0. Texts end with 0 and have no control
 * characters. Returns false if it is not a record. */
bool openxr_record_validate(openxr_record *record);

#endif
