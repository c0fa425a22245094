#include "base/log.h"
#include "base/hash.h"
#include "base/text.h"

#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SLOTS = 256 };

/* A bounded queue with a sequence counter per slot (D. Vyukov's MPMC queue, one consumer): a slot
 * whose sequence equals the ticket is free for the producer that draws that ticket. */
typedef struct slot {
    _Atomic uint32_t sequence;
    log_record record;
} slot;

struct log_queue {
    _Atomic uint32_t next_ticket;
    _Atomic uint32_t lost;
    uint32_t read;
    slot slots[SLOTS];
};

log_queue *log_queue_create(void)
{
    log_queue *queue = calloc(1, sizeof *queue);
    if (!queue)
        return NULL;
    for (uint32_t i = 0; i < SLOTS; ++i)
        atomic_init(&queue->slots[i].sequence, i);
    return queue;
}

void log_queue_destroy(log_queue *queue)
{
    free(queue);
}

static void copy_text(char *out, size_t capacity, const char *text)
{
    size_t length = strnlen(text, capacity - 1);
    memcpy(out, text, length);
    out[length] = '\0';
    text_make_printable(out);
}

void log_push(log_queue *queue, int32_t level, const char *source, const char *text)
{
    if (!queue)
        return;
    uint32_t ticket = atomic_load_explicit(&queue->next_ticket, memory_order_relaxed);
    for (int attempt = 0; attempt < SLOTS; ++attempt) {
        slot *s = &queue->slots[ticket % SLOTS];
        uint32_t sequence = atomic_load_explicit(&s->sequence, memory_order_acquire);
        if (sequence == ticket) {
            if (!atomic_compare_exchange_weak_explicit(&queue->next_ticket, &ticket, ticket + 1,
                                                       memory_order_relaxed, memory_order_relaxed))
                continue;
            s->record.level = level;
            copy_text(s->record.source, sizeof s->record.source, source ? source : "");
            copy_text(s->record.text, sizeof s->record.text, text ? text : "");
            atomic_store_explicit(&s->sequence, ticket + 1, memory_order_release);
            return;
        }
        if ((int32_t)(sequence - ticket) < 0)
            break; /* the queue is full */
        ticket = atomic_load_explicit(&queue->next_ticket, memory_order_relaxed);
    }
    atomic_fetch_add_explicit(&queue->lost, 1, memory_order_relaxed);
}

void log_pushf(log_queue *queue, int32_t level, const char *source, const char *format, ...)
{
    char text[LOG_TEXT];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    log_push(queue, level, source, text);
}

bool log_pop(log_queue *queue, log_record *out)
{
    slot *s = &queue->slots[queue->read % SLOTS];
    if (atomic_load_explicit(&s->sequence, memory_order_acquire) != queue->read + 1)
        return false;
    *out = s->record;
    atomic_store_explicit(&s->sequence, queue->read + SLOTS, memory_order_release);
    queue->read += 1;
    return true;
}

uint32_t log_pop_lost(log_queue *queue)
{
    return atomic_exchange_explicit(&queue->lost, 0, memory_order_relaxed);
}

void log_once_reset(log_once *self)
{
    self->count = 0;
}

bool log_once_repeats(log_once *self, const char *text)
{
    uint64_t hash = hash_bytes(HASH_START, text, strlen(text));
    for (uint32_t i = 0; i < self->count; ++i)
        if (self->hash[i] == hash)
            return true;
    if (self->count == LOG_ONCE_MAX)
        return true;
    self->hash[self->count++] = hash;
    return false;
}
