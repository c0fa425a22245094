/* check/wire.h - how a case tells the parent what it found: lines "KIND NAME TEXT\n" on descriptor
 * WIRE_FD, of printable bytes. The name has no blank. */
#ifndef MAROTTE_CHECK_WIRE_H
#define MAROTTE_CHECK_WIRE_H

enum { WIRE_FD = 3, WIRE_TEXT = 960, WIRE_LINE = 1024 };
enum {
    WIRE_OK = 'O',      /* NAME: a rule */
    WIRE_FAILED = 'F',  /* a rule */
    WIRE_SKIPPED = 'S', /* a rule */
    WIRE_FACT = 'I',    /* a name that parent and case agree on */
    WIRE_END = 'E'      /* the case came to its end */
};

/* ---- the names of facts ---- */

/* "INDEX CONCERNS ID": a type of the library. */
#define WIRE_TYPE "type"
/* A sum over all pulls of a take: the same in every process. */
#define WIRE_SUM "sum"

#endif
