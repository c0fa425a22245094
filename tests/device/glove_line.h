/* device/glove_line.h - the cable between the emulated glove and the program: a pseudo terminal,
 * with what a serial line does to bytes. They take their time at the baud rate, wait for the
 * latency timer of a USB adapter, arrive in pieces. Leaves out what the bytes mean. */
#ifndef MAROTTE_TESTS_DEVICE_GLOVE_LINE_H
#define MAROTTE_TESTS_DEVICE_GLOVE_LINE_H
#include "base/error.h"

enum { GLOVE_LINE_BYTES = 256, GLOVE_LINE_QUEUE = 512, GLOVE_LINE_HELD = 4096 };

typedef struct glove_line_settings {
    const char *link;      /* a symbolic link to the terminal, made and removed; NULL: none */
    int64_t latency_ns;    /* bytes wait for the next multiple of this; 0: they do not */
    uint32_t packet_bytes; /* but so many are sent at once; 0: no such limit */
    uint32_t chunk_bytes;  /* one write has at most so many, paced; 0: a whole parcel */
    bool is_paced;         /* by the baud rate */
    bool is_cooked;        /* the terminal echoes until the program makes it raw, as a real one */
    bool is_awaited;       /* a write returns when the program can read it, as far as it is raw */
    bool minds_baud;       /* a program that has set another rate reads and writes nonsense */
} glove_line_settings;

typedef struct glove_parcel {
    uint8_t bytes[GLOVE_LINE_BYTES];
    uint32_t size;
    int64_t ready_ns; /* its last bit has left the glove */
    int64_t label;    /* the caller's; < 0: none */
} glove_parcel;

typedef struct glove_line {
    glove_line_settings settings;
    uint32_t baud;
    int master, slave; /* < 0: dead. The slave is kept, else readers find the end of the file */
    char path[64];
    int64_t free_ns; /* when the last bit queued has left */
    glove_parcel *queue;
    uint32_t first, count;
    uint8_t held[GLOVE_LINE_HELD]; /* by the latency timer */
    uint32_t held_size;
    int64_t flush_ns; /* when the timer lets go of it */
    struct glove_label {
        int64_t label;
        uint32_t end; /* of its parcel in held */
    } label[GLOVE_LINE_QUEUE];
    uint32_t label_count;
    uint64_t lost_bytes; /* nobody read, and the terminal was full */
} glove_line;

/* Opens the terminal and links it. */
CHECKED mrt_result glove_line_create(glove_line *out, const glove_line_settings *settings,
                                     uint32_t baud, error *err);
void glove_line_destroy(glove_line *line); /* accepts a zeroed one */
/* The cable is pulled: link and terminal vanish, what was on its way is lost. */
void glove_line_die(glove_line *line);
CHECKED mrt_result glove_line_revive(glove_line *line, error *err);

/* Queues bytes that the glove starts to send at start_ns or when the line is free; the label comes
 * back once the last of them was written to the terminal. A full queue loses them. */
void glove_line_send(glove_line *line, const void *bytes, uint32_t size, int64_t start_ns,
                     int64_t label);
/* When glove_line_pump has to be called next; INT64_MAX: only after another send. */
int64_t glove_line_due_ns(const glove_line *line);
/* Learns a label, and when the write began that held its last byte. */
typedef void glove_written(void *data, int64_t label, int64_t time_ns);
/* Writes what is due. */
void glove_line_pump(glove_line *line, int64_t now_ns, glove_written *on_written, void *data);
/* What the program has sent; 0: nothing, or dead. */
size_t glove_line_receive(glove_line *line, uint8_t *out, size_t capacity);
/* The same, and waits until it is so much; less: the terminal has gone. */
size_t glove_line_receive_all(glove_line *line, uint8_t *out, size_t size);
/* Whether the program's file is this terminal. */
bool glove_line_is_terminal(const glove_line *line, int file);

#endif
