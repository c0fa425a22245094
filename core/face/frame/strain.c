#include "face/frame/strain.h"

#include "base/isa.h"

#define STRAIN_TABLE(variant)                                                                      \
    STRAIN_DECLARE(variant);                                                                       \
    static const strain_loops loops_##variant = {.add = STRAIN_OF(add, variant),                   \
                                                 .frames = STRAIN_OF(frames, variant),             \
                                                 .turned = STRAIN_OF(turned, variant),             \
                                                 .turns = STRAIN_OF(turns, variant),               \
                                                 .steepest = STRAIN_OF(steepest, variant),         \
                                                 .strains = STRAIN_OF(strains, variant)}

STRAIN_TABLE(generic);
#ifdef MAROTTE_LANES_X86
STRAIN_TABLE(v2);
STRAIN_TABLE(v3);
STRAIN_TABLE(v4);
static const strain_loops *const tables[ISA_COUNT] = {&loops_generic, &loops_v2, &loops_v3,
                                                      &loops_v4};
#else
static const strain_loops *const tables[ISA_COUNT] = {&loops_generic};
#endif

const strain_loops *strain_loops_now(void)
{
    const strain_loops *found = tables[isa_now()];
    return found ? found : &loops_generic;
}
