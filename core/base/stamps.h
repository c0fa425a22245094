/* base/stamps.h - dirty tracking by version numbers: which parts of an object have changed since a
 * reader last read it. Each part stores the number of the last change that wrote it. A reader
 * stores the last number that it has read, and the source. So any number of readers is possible,
 * and none must be notified. A reader that is late, or that comes from another source, finds
 * everything that it has missed. One thread, or copies. */
#ifndef MAROTTE_BASE_STAMPS_H
#define MAROTTE_BASE_STAMPS_H
#include "base/error.h"

typedef struct stamps_source { /* unique: a later object at the same address has a later time */
    const void *address;
    int64_t born_ns;
} stamps_source;

typedef struct stamps {
    uint64_t *at; /* count numbers: last change that wrote each part */
    uint32_t count;
    uint64_t now; /* number of the last change */
    stamps_source source;
} stamps;

/* Creates stamps with all parts marked. */
CHECKED mrt_result stamps_create(stamps *out, uint32_t count, error *err);
void stamps_destroy(stamps *s); /* accepts NULL and a zeroed struct */
/* Copies numbers and source; both must have the same count. */
void stamps_copy(stamps *out, const stamps *from);

/* Begins a change: parts that are marked later are new to all readers. */
void stamps_begin(stamps *s);
void stamps_mark(stamps *s, uint32_t part);
void stamps_mark_all(stamps *s);

typedef struct stamps_reader { /* zeroed: has read nothing */
    stamps_source source;
    uint64_t seen;
} stamps_reader;

bool stamps_is_new(const stamps_reader *r, const stamps *s, uint32_t part);
/* Returns whether there may be new parts: a change has begun since, or the source is another
 * one. */
bool stamps_may_have_changes(const stamps_reader *r, const stamps *s);
/* Marks everything as read. */
void stamps_read(stamps_reader *r, const stamps *s);

#endif
