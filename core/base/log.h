/* base/log.h - news for the person in front of the program, from any thread, without waiting.
 * Threads push one-line records into a bounded queue; the main thread drains it to wherever it
 * shows news. When the queue is full the record is counted as lost, never waited for. */
#ifndef MAROTTE_BASE_LOG_H
#define MAROTTE_BASE_LOG_H
#include "base/error.h"

enum { LOG_TEXT = 240, LOG_SOURCE = 40 };

typedef struct log_record {
    int32_t level;           /* MRT_LOG_* */
    char source[LOG_SOURCE]; /* who says it: "log", "org.marotte.anchored" */
    char text[LOG_TEXT];
} log_record;

typedef struct log_queue log_queue;

log_queue *log_queue_create(void); /* NULL: no memory */
void log_queue_destroy(log_queue *queue);

/* [any] wait-free but for a bounded number of retries; texts are cut to fit, and made printable:
 * plugins say what devices and the network have told them. */
void log_push(log_queue *queue, int32_t level, const char *source, const char *text);
__attribute__((format(printf, 4, 5))) void log_pushf(log_queue *queue, int32_t level,
                                                     const char *source, const char *format, ...);

/* [main] Takes the oldest record; false when there is none. */
bool log_pop(log_queue *queue, log_record *out);
/* [main] Records lost since the last call. */
uint32_t log_take_lost(log_queue *queue);

/* Remembers which texts were logged, so that what repeats is logged once. Holds so many texts and
 * then takes every further one for a repetition: bounded, whatever it is given. One thread at a
 * time. */
enum { LOG_ONCE_MAX = 16 };
typedef struct log_once {
    uint64_t hash[LOG_ONCE_MAX];
    uint32_t count;
} log_once;

void log_once_reset(log_once *self);
/* Remembers the text; true: it was there before, or there have been too many. */
bool log_once_repeats(log_once *self, const char *text);

#endif
