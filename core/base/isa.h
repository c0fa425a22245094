/* base/isa.h - the instruction sets of the inner loops, and the choice between them: the best that
 * the machine and its system support, or that of MAROTTE_ISA. Results do not depend on it. Leaves
 * out the loops (csrbf/lanes.h). [any] */
#ifndef MAROTTE_BASE_ISA_H
#define MAROTTE_BASE_ISA_H
#include "base/error.h"

/* v2 to v4: the levels of x86-64 (psABI): SSE4.2, AVX2, AVX-512. Other machines have only
 * generic. */
typedef enum isa { ISA_GENERIC = 0, ISA_V2, ISA_V3, ISA_V4, ISA_COUNT } isa;

const char *isa_name(isa which); /* "generic", "v2" ... */
bool isa_is_here(isa which);
isa isa_best(void);

/* word: as in MAROTTE_ISA; NULL and "": the best. Rejects unknown words, and levels that the
 * machine lacks. */
CHECKED mrt_result isa_choose(isa *out, const char *word, error *err);
/* Returns the choice of MAROTTE_ISA, or the best if it is invalid; isa_check reports that at
 * start. */
isa isa_now(void);
CHECKED mrt_result isa_check(error *err);

#endif
