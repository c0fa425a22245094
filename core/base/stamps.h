/* base/stamps.h - dirty tracking by version numbers: which parts of something have changed since a
 * reader looked last. Each part has the number of the change that wrote it; a reader keeps the
 * number that it has seen, and of which source. So there may be any number of readers, none has to
 * be told of a change, and one that comes late, or from another source, finds all that it has
 * missed. One thread, or a copy of it. */
#ifndef MAROTTE_BASE_STAMPS_H
#define MAROTTE_BASE_STAMPS_H
#include "base/error.h"

typedef struct stamps_source { /* unique: what is made at the same address later has a later time */
    const void *address;
    int64_t born_ns;
} stamps_source;

typedef struct stamps {
    uint64_t *at; /* count: the number of the change that wrote a part last */
    uint32_t count;
    uint64_t now; /* the number of the last change */
    stamps_source source;
} stamps;

/* Everything counts as written. */
CHECKED mrt_result stamps_create(stamps *out, uint32_t count, error *err);
void stamps_destroy(stamps *s); /* accepts NULL and zeroed */
/* Same count required; out is of the same source then. */
void stamps_copy(stamps *out, const stamps *from);

/* A change begins: what is marked from now on is new to all readers. */
void stamps_begin(stamps *s);
void stamps_mark(stamps *s, uint32_t part);
void stamps_mark_all(stamps *s);

typedef struct stamps_reader { /* zeroed: has seen nothing */
    stamps_source source;
    uint64_t seen;
} stamps_reader;

bool stamps_is_new(const stamps_reader *r, const stamps *s, uint32_t part);
/* Something may be new: a change has begun since, or it is another source. */
bool stamps_has_news(const stamps_reader *r, const stamps *s);
/* All that is marked has been seen. */
void stamps_read(stamps_reader *r, const stamps *s);

#endif
