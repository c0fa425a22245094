/* base/log.h - log messages for the user, from any thread, without waiting. Threads push one-line
 * records into a bounded queue; the main thread pops and shows them. If the queue is full, the
 * record is dropped and counted. */
#ifndef MAROTTE_BASE_LOG_H
#define MAROTTE_BASE_LOG_H
#include "base/error.h"

enum { LOG_TEXT = 240, LOG_SOURCE = 40 };

typedef struct log_record {
    int32_t level;           /* MRT_LOG_* */
    char source[LOG_SOURCE]; /* source of the message: "log", "org.marotte.anchored" */
    char text[LOG_TEXT];
} log_record;

typedef struct log_queue log_queue;

log_queue *log_queue_create(void); /* NULL: no memory */
void log_queue_destroy(log_queue *queue);

/* [any] Wait-free except for a bounded number of retries. Cuts the texts to fit and makes them
 * printable, because plugins pass on texts of devices and the network. */
void log_push(log_queue *queue, int32_t level, const char *source, const char *text);
__attribute__((format(printf, 4, 5))) void log_pushf(log_queue *queue, int32_t level,
                                                     const char *source, const char *format, ...);

/* [main] Pops the oldest record. Returns false if there is none. */
bool log_pop(log_queue *queue, log_record *out);
/* [main] Returns the number of records lost since the last call. */
uint32_t log_pop_lost(log_queue *queue);

/* Remembers logged texts, so that a repeated text is logged only once. Stores at most LOG_ONCE_MAX
 * texts, and then treats every other text as repeated, so that memory is bounded. One thread at a
 * time. */
enum { LOG_ONCE_MAX = 16 };
typedef struct log_once {
    uint64_t hash[LOG_ONCE_MAX];
    uint32_t count;
} log_once;

void log_once_reset(log_once *self);
/* Remembers the text. Returns true if it is known, or if the limit is reached. */
bool log_once_repeats(log_once *self, const char *text);

#endif
