/* base/isa.h - the instruction sets that inner loops are compiled for, and which of them is used:
 * the best that the machine and its system can run, or the one that MAROTTE_ISA names. Results do
 * not depend on it. Leaves out the loops (csrbf/lanes.h). [any] */
#ifndef MAROTTE_BASE_ISA_H
#define MAROTTE_BASE_ISA_H
#include "base/error.h"

/* v2 to v4: the levels of x86-64 (psABI): SSE4.2, AVX2, AVX-512. Elsewhere there is generic alone.
 */
typedef enum isa { ISA_GENERIC = 0, ISA_V2, ISA_V3, ISA_V4, ISA_COUNT } isa;

const char *isa_name(isa which); /* "generic", "v2" ... */
bool isa_is_here(isa which);
isa isa_best(void);

/* word: as in MAROTTE_ISA; NULL and "": the best. Refuses unknown words, and what is not here. */
CHECKED mrt_result isa_choose(isa *out, const char *word, error *err);
/* What MAROTTE_ISA asks for; the best where it asks for nothing that can be had, which isa_check
 * refuses at start. */
isa isa_now(void);
CHECKED mrt_result isa_check(error *err);

#endif
