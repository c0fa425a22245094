/* device/glove_emulator.h - a CyberGlove on a pseudo terminal: a box (glove_box.h) with a hand in
 * it (glove_motion.h) at the end of a cable (glove_line.h), and everything that can be wrong with
 * them. It can write down what it truly measured and when, to be compared with what arrives
 * (glove_truth.h). Each setting has an option (glove_options.h). It is a program that tests run
 * (glove_child.h), or lives within the test, by the virtual clock (glove_session.h). One thread,
 * which never spins. */
#ifndef MAROTTE_TESTS_DEVICE_GLOVE_EMULATOR_H
#define MAROTTE_TESTS_DEVICE_GLOVE_EMULATOR_H
#include "glove_box.h"
#include "glove_line.h"

/* What is at the other end of the cable. */
typedef enum glove_nature {
    GLOVE_IS_GLOVE = 0,
    GLOVE_IS_MODEM, /* echoes, and answers ERROR to each line */
    GLOVE_IS_ECHO,  /* a plug that connects both wires */
    GLOVE_IS_NOISE, /* sends bytes without end, and answers nothing */
    GLOVE_IS_MUTE   /* nothing at all */
} glove_nature;

/* How a record is spoiled: always so that a reader can see it. */
typedef enum glove_spoil {
    GLOVE_SPOIL_NONE = 0,
    GLOVE_SPOIL_ZERO,  /* a sensor byte becomes 0 */
    GLOVE_SPOIL_HEAD,  /* the head becomes another letter */
    GLOVE_SPOIL_END,   /* the 0 at the end becomes another byte */
    GLOVE_SPOIL_LOST,  /* a byte before the end is missing */
    GLOVE_SPOIL_TWICE, /* a sensor byte comes twice */
    GLOVE_SPOIL_COUNT
} glove_spoil;

typedef struct glove_settings {
    glove_model model;
    glove_nature nature;
    glove_line_settings line;
    const char *motion; /* glove_motion_open */
    bool is_numbered;   /* glove_motion_number in every record */
    const char *truth;  /* path of the file to write; NULL: none */
    bool is_controlled; /* obeys lines on stdin, ends when it closes */
    uint32_t seed;

    double uptime_s, drift_ppm; /* of the glove's clock: when it starts; how much it is fast */
    int64_t restart_ns;         /* for how long Ctrl-R takes */
    int64_t switch_ns;          /* the wrist switch is turned every so often; 0: never */
    bool is_streaming;          /* at the start: a program that crashed has left it so */

    uint32_t spoil_every; /* of so many streamed records one is spoiled; 0: none */
    unsigned spoil_kinds; /* bit 1 << GLOVE_SPOIL_*; in turn */
    uint32_t fast_every;  /* of so many one is marked "es"; 0: none */
    uint32_t unplugged_every, unplugged_run; /* of so many so many are marked "eg" */

    /* What happens in each life, counted from its start; 0: never. */
    uint32_t mute_from_command, die_at_command; /* before it is answered */
    /* After so many streamed records: stops after one, or within one, and answers nothing; sends
     * nonsense; dies; forgets what it was told and stops, as after a loose contact. */
    uint32_t silent_after, cut_after, noise_after, die_after, reset_after;
    uint32_t fault_lives; /* only in so many lives; 0: in all */
    int64_t return_ns;    /* from a death to the next life; < 0: dead for good */
} glove_settings;

glove_settings glove_settings_default(void);

/* Runs until the control pipe closes, a signal asks, or the glove is dead for good. `on_ready`
 * learns the terminal's path at the start of each life. */
CHECKED mrt_result glove_emulator_run(const glove_settings *settings,
                                      void (*on_ready)(const char *path), error *err);

/* Or step by step, by whoever has the time: settings outlive it, and are not controlled. */
typedef struct glove_emulator glove_emulator;
CHECKED mrt_result glove_emulator_create(glove_emulator **out, const glove_settings *settings,
                                         error *err);
/* The ground truth is complete then. */
CHECKED mrt_result glove_emulator_destroy(glove_emulator *self, error *err); /* accepts NULL */
/* When glove_emulator_live has to be called next; INT64_MAX: only after a word or a byte. */
int64_t glove_emulator_due_ns(const glove_emulator *self);
CHECKED mrt_result glove_emulator_live(glove_emulator *self, int64_t now_ns, error *err);
/* The program has written so many bytes to this file: waits for them, if it is the terminal. */
void glove_emulator_written(glove_emulator *self, int64_t now_ns, int file, size_t size);
/* "unplug", "plug", "silent", "speak". */
void glove_emulator_obey(glove_emulator *self, const char *word, int64_t now_ns);

#endif
